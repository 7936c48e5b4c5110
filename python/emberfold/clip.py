# SPDX-License-Identifier: Apache-2.0
"""Clips: arrays and files that are read frame by frame."""
from __future__ import annotations

import os
from typing import Any, Dict, Iterator, Optional, Sequence, Tuple, Union

import numpy as np

from . import _native
from .progress import Progress, reporter

ClipLike = Union["Clip", np.ndarray, str, "os.PathLike[str]"]
Roi = Tuple[int, int, int, int]
Origin = Tuple[float, float, float, str]  # x, y, px; s; what positions and times count from
GUESSED_FPS = 25


class Clip:
    """A clip: a value that is never changed. An array is not copied; a file is read anew by every call.

    fps: frames a second; pixel_size: µm, or None. np.asarray(clip) is its frames, T × H × W or T × H × W × 3.
    """

    def __init__(self, data: _native.ClipData, state: Tuple[Any, ...], name: str):
        self._data, self._state, self._name = data, state, name

    fps = property(lambda self: self._data.fps)
    white = property(lambda self: self._data.white, doc="The value of white.")
    width = property(lambda self: self._data.width)
    height = property(lambda self: self._data.height)
    dtype = property(lambda self: self._data.dtype)
    name = property(lambda self: self._name)
    fps_is_known = property(lambda self: self._data.fps_is_known, doc="False where fps is a guess.")
    pixel_size = property(lambda self: self._data.pixel_size, doc="Micrometres; None where it is not known.")

    @property
    def shape(self) -> Tuple[Optional[int], ...]:
        """(T, H, W) or (T, H, W, 3); T is None where only reading would tell it."""
        size = (self._data.frames, self.height, self.width)
        return size if self._data.channels == 1 else size + (3,)

    def __len__(self) -> int:
        frames = self._data.frames
        return len(self.read()) if frames is None else frames

    def read(self, first: int = 0, count: Optional[int] = None) -> np.ndarray:
        """Reads frames from `first` on, at most `count` of them. An array in memory is not copied."""
        if self._data.array is not None:
            return self._data.array[first:None if count is None else first + count]
        return self._data.read(first, -1 if count is None else count)

    def __array__(self, dtype: Any = None, copy: Optional[bool] = None) -> np.ndarray:
        frames = self.read()
        return frames if dtype is None and not copy else frames.astype(dtype or frames.dtype, copy=bool(copy))

    def __iter__(self) -> Iterator[np.ndarray]:
        return iter(self.read())

    def __getitem__(self, index: Any) -> np.ndarray:
        if isinstance(index, (int, np.integer)) and index >= 0 and self._data.array is None:
            return self.read(int(index), 1)[0]
        return self.read()[index]

    def __reduce__(self) -> Tuple[Any, ...]:
        return _restore, (self._state, self._name)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Clip):
            return NotImplemented
        return (self.fps, self.pixel_size, self.shape) == (other.fps, other.pixel_size, other.shape) and bool(
            np.array_equal(self.read(), other.read()))

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        size = "" if self.pixel_size is None else f", pixel_size={self.pixel_size:g}"
        return f"Clip({self.name}, shape={self.shape}, dtype={self.dtype}, fps={self.fps:g}{size})"

    def _repr_html_(self) -> str:
        from . import html
        return html.clip(self)

    def show(self, frame: int = 0) -> Any:
        """Draws a frame with matplotlib and returns the figure."""
        from . import plot
        return plot.frame(self, frame)


def _restore(state: Tuple[Any, ...], name: str) -> Clip:
    data = _native.ClipData(*state[1:]) if state[0] == "array" else _native.ClipData.open(*state[1:])
    return Clip(data, state, name)


def _of_array(array: np.ndarray, frames: slice, fps: Optional[float], pixel_size: Optional[float], roi: Optional[Roi],
              white: Optional[float], origin: Optional[str], times: Sequence[float], corner: Origin) -> Tuple[Any, ...]:
    """What ClipData takes of a part of an array, whose own frames have these times and begin at this corner."""
    if origin not in (None, "source", "part"):
        raise ValueError(f"origin is {origin!r}; allowed is 'source' or 'part'")
    first = frames.indices(len(array))[0]
    times = times[frames]
    if array.ndim not in (3, 4):
        raise ValueError(f"clip has the shape {array.shape}; allowed are (T, H, W) and (T, H, W, 3), none 0")
    array = array[frames]
    if roi is not None:
        x, y, width, height = roi
        inside = x >= 0 and y >= 0 and width > 0 and height > 0
        if not (inside and x + width <= array.shape[2] and y + height <= array.shape[1]):
            raise ValueError(f"roi is {roi}; frames are {array.shape[2]}x{array.shape[1]}")
        array = array[:, y:y + height, x:x + width]
    if not array.dtype.isnative:
        array = array.astype(array.dtype.newbyteorder("="))
    step = abs(frames.step or 1)
    part = origin == "part" or corner[3] == "part" and origin is None
    if roi is not None or first > 0:
        x, y = (0, 0) if roi is None else roi[:2]
        corner = (corner[0] + x, corner[1] + y, times[0] if times else corner[2] + first / (fps or GUESSED_FPS), "source")
    if part and corner[3]:
        corner, times = (0., 0., 0., "part"), [time - times[0] for time in times]
    if len(times) > 1 and times[-1] > times[0]:
        fps, step = (len(times) - 1) / (times[-1] - times[0]), 1
    return "array", array, None if fps is None else fps / step, white, pixel_size, list(times), corner


def _of_file(path: str, frames: slice, options: Dict[str, Any]) -> Tuple[Any, ...]:
    first, last, step = frames.start or 0, frames.stop, frames.step or 1
    if first < 0 or (last is not None and last <= first) or step < 1:
        raise ValueError(f"frames is {frames}; of a file allowed are slices from 0 on, not empty, with a step from 1 on")
    return "file", path, first, last, {"step": step, **options}


def _reopen(clip: Clip, frames: Optional[slice], options: Dict[str, Any], roi: Optional[Roi], white: Optional[float]) -> Clip:
    """A clip with other options, or a part of it."""
    given = {name: value for name, value in options.items() if value is not None}
    if frames is None and roi is None and white is None:
        if not given:
            return clip
        if clip._state[0] == "file":
            return _restore((*clip._state[:4], {**clip._state[4], **given}), clip.name)
    if clip._state[0] == "file" and clip._state[4].get("mask") is not None:
        raise ValueError("frames, roi and white of a clip with a mask are told when its file is opened")
    known = {"fps": clip.fps if clip.fps_is_known else None, "pixel_size": clip.pixel_size, **given}
    origin, times = known.pop("origin", None), [] if "fps" in given else clip._data.times
    for name in set(known) - {"fps", "pixel_size"}:
        raise ValueError(f"{name} is for files; arrays are read as they are")
    return _restore(_of_array(clip.read(), slice(None) if frames is None else frames, known["fps"], known["pixel_size"], roi,
                              clip.white if white is None else white, origin, times, clip._data.origin), "array")


def open_clip(clip: ClipLike, *, frames: Optional[slice] = None, fps: Optional[float] = None,
              pixel_size: Optional[float] = None, roi: Optional[Roi] = None, white: Optional[float] = None,
              origin: Optional[str] = None, **reading: Any) -> Clip:
    """Opens a clip: a video, a folder or pattern of images, a TIFF, or an array (T, H, W[, 3]) of uint8, uint16 or float32.

    frames: which of them; roi: x, y, width, height, px. Positions and times in tables count from the corner and first frame of the
    whole clip; with origin="part" from those of the part that is read. fps (of the frames
    as they were taken) and pixel_size (µm) give results seconds and micrometres; of a file they are its own unless given. white: of an array, the value of white;
    unless given 255, and of 16 bits the largest of the bits that the values need, of floats up to 1 it is 1.

    reading, of files alone, as the command's options: channel=0, slice=0 or "max", levels="auto", "full" or "LOW:HIGH",
    grey=True, scale=.5, mask="file" (structure counts where it is not 0), stabilize="translation" or "similarity".
    """
    if isinstance(clip, Clip):
        return _reopen(clip, frames, {"fps": fps, "pixel_size": pixel_size, "origin": origin, **reading}, roi, white)
    frames = slice(None) if frames is None else frames
    if not isinstance(frames, slice):
        raise ValueError(f"frames is {frames!r}; allowed is a slice")
    if isinstance(clip, (str, os.PathLike)):
        if white is not None:
            raise ValueError("white is for arrays; files tell their own")
        options = {"fps": fps, "pixel_size": pixel_size, "roi": None if roi is None else tuple(roi),
                   "origin": origin, **reading}
        if options.get("mask") is not None:
            options["mask"] = os.fspath(options["mask"])
        return _restore(_of_file(os.fspath(clip), frames, options), os.fspath(clip))
    for name in reading:
        raise ValueError(f"{name} is for files; arrays are read as they are")
    if not isinstance(clip, np.ndarray):
        raise ValueError(f"clip is a {type(clip).__name__}; allowed are an array, a path and a Clip")
    return _restore(_of_array(clip, frames, fps, pixel_size, roi, white, origin, [], (0., 0., 0., "")), "array")


def data_of(clip: ClipLike, name: str = "clip", fps: Optional[float] = None) -> _native.ClipData:
    """What the library reads; errors name the argument."""
    try:
        return open_clip(clip, fps=fps if isinstance(clip, np.ndarray) else None)._data
    except ValueError as error:
        if str(error).startswith("clip ") and name != "clip":
            raise type(error)(name + str(error)[4:]) from None
        raise


def write_video(path: Union[str, "os.PathLike[str]"], clip: ClipLike, frames: Optional[int] = None, *,
                fps: Optional[float] = None, progress: Progress = None) -> None:
    """Writes a clip of uint8: .mp4 (H.264), .avi (lossless), a folder of PNG, or a pattern such as
    frames/%05d.exr (OpenEXR, linear light)."""
    with reporter(progress) as report:
        _native.write_video(os.fspath(path), data_of(clip, fps=fps), frames, report)
