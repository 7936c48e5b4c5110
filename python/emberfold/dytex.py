# SPDX-License-Identifier: Apache-2.0
"""Linear dynamic textures: learn(clip).edit(speed=0.5).synthesize(200)."""
from __future__ import annotations

from typing import Any, Dict, List, Optional, Tuple, Union

import numpy as np
import pandas as pd

from . import _native
from ._native import (PRESETS, CurveOptions, EmOptions, LearnOptions, LinearDynamicTexture, SynthesisOptions,
                      window_distance)
from .clip import ClipLike, data_of
from .progress import Progress, reporter

__all__ = ["PRESETS", "CurveOptions", "EmOptions", "LearnOptions", "LinearDynamicTexture", "SynthesisOptions",
           "distance_matrices", "forecast", "learn", "learn_missing", "learn_region", "learning_curve", "maximise_likelihood",
           "window_distance", "window_spectrum"]


def learn(clip: ClipLike, *, progress: Progress = None, **options: Any) -> LinearDynamicTexture:
    """Learns a texture; arguments are the fields of LearnOptions. What was not taken as asked is a warning."""
    with reporter(progress) as report:
        return _native.learn(data_of(clip), report, **options)


def learn_region(clip: ClipLike, mask: np.ndarray, *, progress: Progress = None, **options: Any) -> LinearDynamicTexture:
    """Learns a texture of the pixels where `mask` (H, W) is not 0, all else held still."""
    with reporter(progress) as report:
        return _native.learn_region(data_of(clip), _bytes(mask), LearnOptions(**options), report)


def maximise_likelihood(clip: ClipLike, start: LinearDynamicTexture, *, missing: Optional[ClipLike] = None, progress: Progress = None,
                        **options: Any) -> Dict[str, Any]:
    """Finds the most likely texture from `start`: a dict of texture, log_likelihood, converged and notes. missing: a mask of as
    many frames, bright where pixels are hidden. Arguments are the fields of EmOptions."""
    hidden = None if missing is None else data_of(_mask(missing), "missing")
    with reporter(progress) as report:
        return _native.maximise_likelihood(data_of(clip), start, EmOptions(**options), hidden, report)


def learn_missing(clip: ClipLike, missing: ClipLike, *, em: Optional[EmOptions] = None, progress: Progress = None,
                  **options: Any) -> Dict[str, Any]:
    """Learns a texture of a clip that is partly hidden, where the mask `missing` is bright: a dict as maximise_likelihood()'s.
    Arguments are the fields of LearnOptions."""
    with reporter(progress) as report:
        return _native.learn_missing(data_of(clip), data_of(_mask(missing), "missing"), LearnOptions(**options), em or EmOptions(), report)


def forecast(texture: LinearDynamicTexture, steps: int, clip: Optional[ClipLike] = None, *,
             progress: Progress = None) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Predicts the frames after those that the texture was learned from, or after those of `clip`: the frames (float32,
    steps × H × W[ × 3]), their states (N × steps) and the expected RMS error of each, levels."""
    with reporter(progress) as report:
        return _native.forecast(texture, steps, None if clip is None else data_of(clip), report)


def learning_curve(clip: ClipLike, *, progress: Progress = None, **options: Any) -> Tuple[pd.DataFrame, Dict[str, Any]]:
    """How the error of predicting the next frame falls with the length of the clip: a table, and the plateau, the critical
    length and the error of showing the frame before. Arguments are the fields of CurveOptions."""
    with reporter(progress) as report:
        found = _native.learning_curve(data_of(clip), CurveOptions(**options), report)
    return pd.DataFrame(found.pop("points"), columns=["length", "error", "spread", "left_out"]).set_index("length"), found


def distance_matrices(textures: List[LinearDynamicTexture], *, progress: Progress = None) -> Dict[str, np.ndarray]:
    """Distances of all pairs by measure: kl, martin, angles, windows; nan where a pair has none (KL without noise r)."""
    with reporter(progress) as report:
        return _native.distance_matrices(list(textures), report)


def window_spectrum(of: Union[ClipLike, LinearDynamicTexture], *, progress: Progress = None) -> Optional[np.ndarray]:
    """Describes a clip, or a texture, wherever in the frame it lies: None where no window moves. window_distance() compares two."""
    if isinstance(of, LinearDynamicTexture):
        return _native.window_spectrum_of_model(of)
    with reporter(progress) as report:
        return _native.window_spectrum(data_of(of), report)


def _bytes(mask: Any) -> Any:
    return mask.astype(np.uint8) if isinstance(mask, np.ndarray) and mask.dtype == bool else mask


def _mask(mask: Any) -> Any:
    return mask.astype(np.uint8) * 255 if isinstance(mask, np.ndarray) and mask.dtype == bool else mask


for _made in (learn, learn_region, maximise_likelihood, learn_missing, forecast, learning_curve, distance_matrices, window_spectrum):
    _made.__doc__ = f"{_made.__doc__}\n\n{getattr(_native, _made.__name__).__doc__}"
