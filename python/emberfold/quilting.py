# SPDX-License-Identifier: Apache-2.0
"""Larger clips from small ones."""
from __future__ import annotations

from typing import Any, Dict, Optional, Tuple, Union

import numpy as np

from . import _native
from .clip import ClipLike, data_of
from .progress import Progress, reporter


def quilt(clip: ClipLike, *, forbidden: Optional[np.ndarray] = None, guide: Optional[np.ndarray] = None,
          output_guide: Optional[np.ndarray] = None, return_map: bool = False, progress: Progress = None, **options: Any) -> Union[np.ndarray, Tuple[np.ndarray, np.ndarray]]:
    """Enlarges a clip in space; returns its frames, of the clip's type, and with `return_map` the source coordinates too.

    forbidden: (H, W), pixels that are not 0 are not copied. guide, (H, W), and output_guide, of the output's size: what
    is alike in them is copied to where it is alike. Other arguments are the fields of QuiltOptions: size=(512, 512).
    The coordinates are (height, width, 3), int32: source, x, y at all times; of seams that move they are rows of six:
    t, y, x, and from then on the source, x, y that are copied there (docs/formats.md). render_quilt() takes both.
    """
    if forbidden is not None and forbidden.dtype == bool:
        forbidden = forbidden.astype(np.uint8)
    with reporter(progress) as report:
        frames, places = _native.quilt(data_of(clip), _native.QuiltOptions(**options), forbidden, guide, output_guide, report)
    return (frames, places) if return_map else frames


def render_quilt(map: np.ndarray, clip: ClipLike, *, progress: Progress = None) -> np.ndarray:  # noqa: A002
    """Renders a map of quilt() from a clip, the same or another of that size."""
    with reporter(progress) as report:
        return _native.render_quilt(map, data_of(clip), report)


def measure_quilt(map: np.ndarray, clip: ClipLike, *, progress: Progress = None) -> Dict[str, float]:  # noqa: A002
    """How much a map of quilt() copies, and how visible its seams are."""
    with reporter(progress) as report:
        return _native.measure_quilt(map, data_of(clip), report)


measure_quilt.__doc__ = f"{measure_quilt.__doc__}\n\n{_native.measure_quilt.__doc__}"
quilt.__doc__ = f"{quilt.__doc__}\n\n{_native.quilt.__doc__}"
