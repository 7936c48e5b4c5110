# SPDX-License-Identifier: Apache-2.0
"""Models moving textures as graphs: strokes that are born, die, split, merge, connect and come apart.

    import emberfold as ef
    clip = ef.open("clip.tif", fps=30, pixel_size=0.065)
    run = ef.analyze(clip)
    run.events

Clips are NumPy arrays, files, or what `ef.open` makes of them. Colours are red, green, blue; frames count from 0; places are
pixels, x to the right and y down. Long calls leave the interpreter free and end at Ctrl-C.
"""
from . import dytex, graph, sketch
from ._native import (
    AnalyzeOptions,
    Cancelled,
    ClipModel,
    ClipSynthesisOptions,
    CompareOptions,
    ExtractOptions,
    InputError,
    IoError,
    MatchOptions,
    MotionGraph,
    MotionModel,
    NumericalError,
    OperatorRates,
    QuiltOptions,
    SketchSequence,
    __version__,
)
from .clip import Clip, write_video
from .clip import open_clip as open  # noqa: A001, as ef.open
from .comparison import Comparison, ModelComparison, compare, compare_models
from .quilting import measure_quilt, quilt, render_quilt
from .run import Run, analyze, read_run
from .shown import show_compiled

__all__ = [
    "AnalyzeOptions", "Cancelled", "Clip", "ClipModel", "ClipSynthesisOptions", "CompareOptions",
    "Comparison", "ExtractOptions", "InputError", "IoError", "MatchOptions", "ModelComparison",
    "MotionGraph", "MotionModel", "NumericalError", "OperatorRates", "QuiltOptions", "Run", "SketchSequence", "analyze",
    "compare", "compare_models", "dytex", "graph", "measure_quilt", "open", "quilt", "read_run", "render_quilt", "sketch", "write_video",
]

show_compiled()
