# SPDX-License-Identifier: Apache-2.0
"""Frames to graphs, and graphs to frames. Levels are float32, white = 255, (H, W) or (H, W, 3)."""
from __future__ import annotations

from typing import Any

import numpy as np

from . import _native
from ._native import ExtractOptions, SketchSequence
from .clip import ClipLike, data_of
from .progress import Progress, reporter

__all__ = ["ExtractOptions", "SketchSequence", "extract", "reconstruct", "sketch_clip"]


def extract(levels: np.ndarray, **options: Any) -> SketchSequence:
    """Extracts the sketch of a frame; arguments are the fields of ExtractOptions."""
    return _native.extract(levels, ExtractOptions(**options))


def reconstruct(levels: np.ndarray, sketch: SketchSequence) -> np.ndarray:
    """Draws a frame again from its sketch, the rest by diffusion."""
    return _native.reconstruct(levels, sketch)


def sketch_clip(clip: ClipLike, *, progress: Progress = None, **options: Any) -> SketchSequence:
    """Sketches a clip; arguments are the fields of ExtractOptions."""
    own = _native.AnalyzeOptions().sketch  # what is followed in time is drawn with its defaults
    for name, value in options.items():
        if name not in ExtractOptions.FIELDS:
            raise ValueError(f"ExtractOptions has no field '{name}'")
        setattr(own, name, value)
    with reporter(progress) as report:
        return _native.sketch_clip(data_of(clip), own, report)


for _made in (extract, reconstruct, sketch_clip):
    _made.__doc__ = f"{_made.__doc__}\n\n{getattr(_native, _made.__name__).__doc__}"
