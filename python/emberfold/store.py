# SPDX-License-Identifier: Apache-2.0
"""Runs in folders: what each stage made (`stages`, `model`), and the command's files of events and graphs."""
from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any, Dict, List, Tuple

import numpy as np

from . import _native
from .clip import Clip

FORMAT = "emberfold.python_run"
NO_ORIGIN = {"x": 0., "y": 0., "time_s": 0., "origin": ""}
STAGES = {"sketch": ("sketch",),
          "motion": ("seed", "match", "bottom_up", "curve_events", "figures"),
          "model": ("least_probability",)}  # what each depends on, in addition to the stages before it


def _hash(*parts: Any) -> str:
    return hashlib.sha256(repr(parts).encode()).hexdigest()


def _seen_beside(clip: Clip) -> Tuple[Any, ...]:
    """What beside its frames tells of a clip: its mask, and how it was stabilised."""
    if clip._state[0] != "file":
        return ()
    options = clip._state[4]
    mask = options.get("mask")
    content = hashlib.sha256(Path(mask).read_bytes()).hexdigest() if mask and Path(mask).is_file() else mask
    return content, options.get("stabilize")


def keys_of(clip: Clip, options: _native.AnalyzeOptions) -> Tuple[str, ...]:
    """A key a stage, of the clip's frames and of the options: equal keys, equal results."""
    frames = hashlib.sha256()
    for frame in clip:
        frames.update(np.ascontiguousarray(frame).data)
    about = clip.shape[1:], str(clip.dtype), clip.fps, clip.white, _seen_beside(clip)
    key, keys = _hash(_native.__version__, about, frames.hexdigest()), []
    for names in STAGES.values():
        key = _hash(key, [(name, getattr(options, name)) for name in names])
        keys.append(key)
    return tuple(keys)


def prepare(folder: Path) -> None:
    """Marks a folder as that of a run; another one is left alone."""
    about = folder / "python_run.json"
    if folder.exists() and any(folder.iterdir()) and not about.exists():
        raise FileExistsError(f"{folder} holds other things than a run of emberfold in Python; it is left alone")
    folder.mkdir(parents=True, exist_ok=True)
    _replace(about, json.dumps({"format": FORMAT, "version": 2, "done": False}).encode())


def _replace(path: Path, content: bytes) -> None:
    part = path.with_name(path.name + ".part")
    part.write_bytes(content)
    part.rename(path)


def save(found: Dict[str, Any], clip: Clip, folder: Path) -> None:
    """Writes what other programs read; stages and model are there already."""
    _replace(folder / "motion.jsonl", found["motion"].to_jsonl())
    times, origin = found["place"]
    _replace(folder / "events.json", _native.events_json(found["events"], origin))
    _replace(folder / "events_all.json", _native.events_json(found["all_events"], origin))
    about = {"format": FORMAT, "version": 2, "done": True, "clip": clip.name, "pixel_size": clip.pixel_size}
    if times:
        about["times_s"] = times
    if origin[3]:
        about["counted_from"] = dict(zip(NO_ORIGIN, origin))
    _replace(folder / "python_run.json", json.dumps(about).encode())


def moved(events: List[Tuple[Any, ...]], origin: Tuple[Any, ...], sign: int = 1) -> List[Tuple[Any, ...]]:
    """Events, or answers of a review, whose positions count from elsewhere; sign -1: back."""
    return [(frame, kind, x + sign * origin[0], y + sign * origin[1], *rest) for frame, kind, x, y, *rest in events]


def _events(path: Path, origin: Tuple[Any, ...]) -> List[Tuple[Any, ...]]:
    events = [(e["frame"], e["type"], float(e["x"]), float(e["y"]), float(e["probability"]), tuple(e["before"]), tuple(e["after"]))
              for e in json.loads(path.read_text())["events"]]
    return moved(events, origin, -1)


def load(folder: Path) -> Dict[str, Any]:
    """A run of Python or of the command, read from its files."""
    try:
        if (folder / "python_run.json").exists():
            about = json.loads((folder / "python_run.json").read_text())
            done, pixel_size = about.get("done", True), about.get("pixel_size")
        else:
            about = json.loads((folder / "summary.json").read_text())["clip"]
            done, pixel_size = True, about["pixel_um"]
        if not done:
            raise _native.IoError(f"{folder} is a run that was broken off; analyze() goes on with it")
        motion = (folder / "motion.jsonl").read_text()
        origin = tuple(about.get("counted_from", NO_ORIGIN)[key] for key in NO_ORIGIN)
        return {"motion": _native.MotionGraph.from_jsonl(motion, str(folder / "motion.jsonl")),
                "events": _events(folder / "events.json", origin), "all_events": _events(folder / "events_all.json", origin),
                "model": _native.ClipModel.read(str(folder / "model")), "pixel_size": pixel_size,
                "place": (about.get("times_s", []), origin)}
    except (FileNotFoundError, KeyError, ValueError) as error:
        raise _native.IoError(f"{folder} is no finished run: {error}") from error
