# SPDX-License-Identifier: Apache-2.0
"""Linear dynamic textures: learn(clip).edit(speed=0.5).synthesize(200)."""
from __future__ import annotations

from typing import Any

from . import _native
from ._native import (PRESETS, LearnOptions, LearnResult, LinearDynamicTexture, SynthesisOptions, grassmann_distance, kl_rate,
                      martin_distance, stationary_covariance, subspace_angles)
from .clip import ClipLike, data_of
from .progress import Progress, reporter

__all__ = ["PRESETS", "LearnOptions", "LearnResult", "LinearDynamicTexture", "SynthesisOptions", "grassmann_distance", "kl_rate",
           "learn", "learn_result", "martin_distance", "stationary_covariance", "subspace_angles"]


def learn(clip: ClipLike, *, progress: Progress = None, **options: Any) -> LinearDynamicTexture:
    """Learns a texture; arguments are the fields of LearnOptions. What was not taken as asked is a warning."""
    with reporter(progress) as report:
        return _native.learn(data_of(clip), report, **options)


def learn_result(clip: ClipLike, *, progress: Progress = None, **options: Any) -> LearnResult:
    """Learns a texture as learn() does; returns it with what was found on the way."""
    with reporter(progress) as report:
        return _native.learn_result(data_of(clip), report, **options)


for _made in (learn, learn_result):
    _made.__doc__ = f"{_made.__doc__}\n\n{_native.learn.__doc__}"
