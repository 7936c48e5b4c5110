# SPDX-License-Identifier: Apache-2.0
"""Measures of frames and clips. Levels are float32, white = 255."""
from __future__ import annotations

import numpy as np

from . import _native
from ._native import (crease_sharpness, log_spectral_distance, mean_square_error, optical_flow, psnr, spatial_information,
                      structural_similarity, temporal_information)
from .clip import ClipLike, data_of

__all__ = ["autocorrelation", "crease_sharpness", "log_spectral_distance", "mean_square_error", "optical_flow", "psnr",
           "radial_spectrum", "spatial_information", "structural_similarity", "temporal_information", "temporal_spectrum"]


def temporal_spectrum(clip: ClipLike, segment: int) -> np.ndarray:
    """The power spectrum of a clip in time."""
    return _native.temporal_spectrum(data_of(clip), segment)


def radial_spectrum(clip: ClipLike, rings: int) -> np.ndarray:
    """The mean power spectrum of a clip's frames in space."""
    return _native.radial_spectrum(data_of(clip), rings)


def autocorrelation(clip: ClipLike, lags: int) -> np.ndarray:
    """The autocorrelation of a clip's pixels in time, at lags of 1 … `lags` frames."""
    return _native.autocorrelation(data_of(clip), lags)


for _made in (temporal_spectrum, radial_spectrum, autocorrelation):
    _made.__doc__ = f"{_made.__doc__}\n\n{getattr(_native, _made.__name__).__doc__}"
