# SPDX-License-Identifier: Apache-2.0
"""Frames to graphs, and graphs to frames. Levels are float32, white = 255, (H, W) or (H, W, 3)."""
from __future__ import annotations

from typing import Any, Sequence, Tuple

import numpy as np

from . import _native
from ._native import (ExtractOptions, NonsketchableFillOptions, SketchSequence, add_anchors, draw_patches,
                      estimate_noise)
from .clip import ClipLike, data_of
from .progress import Progress, reporter

__all__ = ["ExtractOptions", "NonsketchableFillOptions", "SketchSequence", "add_anchors", "draw_morph", "draw_patches",
           "estimate_noise", "extract", "fill", "fill_nonsketchable", "make_heat_film", "reconstruct", "sketch_clip"]


def _bytes(mask: Any) -> Any:
    return mask.astype(np.uint8) if isinstance(mask, np.ndarray) and mask.dtype == bool else mask


def extract(levels: np.ndarray, **options: Any) -> SketchSequence:
    """Extracts the sketch of a frame; arguments are the fields of ExtractOptions."""
    return _native.extract(levels, ExtractOptions(**options))


def fill(levels: np.ndarray, mask: np.ndarray) -> np.ndarray:
    """Fills the pixels where `mask` is 0 by diffusion."""
    return _native.fill(levels, _bytes(mask))


def fill_nonsketchable(observed: np.ndarray, drawn: Tuple[np.ndarray, np.ndarray], *, progress: Progress = None,
                       **options: Any) -> np.ndarray:
    """Fills what lies between the patches: by diffusion, or kind="julesz" or "efros_leung" with texture. drawn: what
    draw_patches() made. Arguments are the fields of NonsketchableFillOptions."""
    with reporter(progress) as report:
        return _native.fill_nonsketchable(observed, *drawn, NonsketchableFillOptions(**options), report)


def make_heat_film(levels: np.ndarray, mask: np.ndarray, steps: Sequence[int], *, progress: Progress = None) -> np.ndarray:
    """Heat that diffuses from the pixels where `mask` is not 0: the levels after each of `steps`."""
    with reporter(progress) as report:
        return _native.make_heat_film(levels, _bytes(mask), list(steps), report)


def draw_morph(morph: _native.Morph, *, channels: int = 3, empty: Tuple[float, float] = (0, 0),
               progress: Progress = None) -> np.ndarray:
    """Draws the frames of a morph, uint8; a first and last frame without strokes have the levels `empty`."""
    with reporter(progress) as report:
        return _native.draw_morph(morph, channels, empty, report)


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


for _made in (draw_morph, extract, fill, fill_nonsketchable, make_heat_film, reconstruct, sketch_clip):
    _made.__doc__ = f"{_made.__doc__}\n\n{getattr(_native, _made.__name__).__doc__}"
