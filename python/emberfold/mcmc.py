# SPDX-License-Identifier: Apache-2.0
"""How strokes move and how often they change: the motion model, learned of graphs, and what it says of frames to come."""
from __future__ import annotations

from typing import Any

import pandas as pd

from . import _native
from ._native import (EVENT_TYPES, Autoregression, MotionGraph, MotionModel, OperatorRates, predict, rate_interval,
                      spectral_radius, stationary_deviation)
from .progress import Progress, reporter

__all__ = ["Autoregression", "MotionModel", "OperatorRates", "fit", "predict", "rate_interval", "spectral_radius",
           "stationary_deviation", "synthesize", "transition_likelihoods"]


def fit(motion: MotionGraph, *, progress: Progress = None, **options: Any) -> MotionModel:
    """Learns a motion model; arguments are the fields of FitOptions: seed, calibrate."""
    with reporter(progress) as report:
        return _native.fit(motion, progress=report, **options)


def synthesize(model: MotionModel, frames: int, *, seed: int = 1, stationary: bool = False, progress: Progress = None) -> MotionGraph:
    """Draws graphs and their links; they begin as the clip does, or as the model usually is."""
    with reporter(progress) as report:
        return _native.synthesize(model, frames, seed, stationary, report)


def transition_likelihoods(model: MotionModel, motion: MotionGraph, *, progress: Progress = None) -> pd.DataFrame:
    """Tells how likely each frame's graph and links are, given those before: a row for every frame but the first, nats. Columns:
    displacement, contrast, the six classes of events, total, places (numbers that displacement and contrast are of)."""
    with reporter(progress) as report:
        rows = _native.transition_likelihoods(model, motion, report)
    table = [(frame, moved, flicker, *events, total, places) for frame, (moved, flicker, events, total, places, _) in enumerate(rows, 1)]
    return pd.DataFrame(table, columns=["frame", "displacement", "contrast", *EVENT_TYPES, "total", "places"]).set_index("frame")


for _made in (fit, synthesize, transition_likelihoods):
    _made.__doc__ = f"{_made.__doc__}\n\n{getattr(_native, _made.__name__).__doc__}"
