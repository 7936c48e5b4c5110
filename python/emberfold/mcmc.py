# SPDX-License-Identifier: Apache-2.0
"""How strokes move and how often they change: the motion model, learned of graphs, and what it says of frames to come."""
from __future__ import annotations

from typing import Any

from . import _native
from ._native import (Autoregression, InferOptions, MotionGraph, MotionModel, OperatorRates, predict, rate_interval,
                      spectral_radius, stationary_deviation)
from .progress import Progress, reporter

__all__ = ["Autoregression", "InferOptions", "MotionModel", "OperatorRates", "fit", "predict", "rate_interval", "spectral_radius",
           "stationary_deviation", "synthesize"]


def fit(motion: MotionGraph, *, progress: Progress = None, **options: Any) -> MotionModel:
    """Learns a motion model; arguments are the fields of FitOptions: seed, calibrate."""
    with reporter(progress) as report:
        return _native.fit(motion, progress=report, **options)


def synthesize(model: MotionModel, frames: int, *, seed: int = 1, stationary: bool = False, progress: Progress = None) -> MotionGraph:
    """Draws graphs and their links; they begin as the clip does, or as the model usually is."""
    with reporter(progress) as report:
        return _native.synthesize(model, frames, seed, stationary, report)


for _made in (fit, synthesize):
    _made.__doc__ = f"{_made.__doc__}\n\n{getattr(_native, _made.__name__).__doc__}"
