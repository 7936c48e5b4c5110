# SPDX-License-Identifier: Apache-2.0
"""Runs in folders: what the command's files hold, and what they were made from."""
from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any, Dict, Optional

import numpy as np

from . import _native
from .clip import Clip

FORMAT = "emberfold.python_run"


def key_of(clip: Clip, options: _native.AnalyzeOptions) -> str:
    """A hash of the clip's frames and of all options: equal keys, equal results."""
    found = hashlib.sha256(repr((clip.shape[1:], str(clip.dtype), clip.fps, clip.white, repr(options))).encode())
    for frame in clip:
        found.update(np.ascontiguousarray(frame).data)
    return found.hexdigest()


def save(found: Dict[str, Any], key: str, folder: Path) -> None:
    """Writes a run; the file that makes the folder one comes last, so that a run that was broken off is none."""
    about = folder / "python_run.json"
    if folder.exists() and any(folder.iterdir()) and not about.exists():
        raise FileExistsError(f"{folder} holds other things than a run; it is left alone")
    folder.mkdir(parents=True, exist_ok=True)
    about.unlink(missing_ok=True)
    (folder / "motion.jsonl").write_bytes(found["motion"].to_jsonl())
    (folder / "events.json").write_bytes(_native.events_json(found["events"]))
    (folder / "events_all.json").write_bytes(_native.events_json(found["all_events"]))
    found["model"].write(str(folder / "model"))
    part = folder / "python_run.json.part"
    part.write_text(json.dumps({"format": FORMAT, "version": 1, "key": key, "rates": found["rates"], "stages": found["stages"]}))
    part.rename(about)


def _events(path: Path) -> Any:
    return [(e["frame"], e["type"], e["x"], e["y"], e["probability"], tuple(e["before"]), tuple(e["after"]))
            for e in json.loads(path.read_text())["events"]]


def load(key: str, folder: Path) -> Optional[Dict[str, Any]]:
    """The run in a folder if it was made from the same clip and options, else None."""
    try:
        about = json.loads((folder / "python_run.json").read_text())
    except FileNotFoundError:
        return None
    if about.get("format") != FORMAT or about.get("version") != 1 or about.get("key") != key:
        return None
    motion = (folder / "motion.jsonl").read_text()
    return {"motion": _native.MotionGraph.from_jsonl(motion, str(folder / "motion.jsonl")),
            "events": _events(folder / "events.json"), "all_events": _events(folder / "events_all.json"),
            "model": _native.ClipModel.read(str(folder / "model")),
            "rates": [tuple(rate) for rate in about["rates"]], "stages": about["stages"]}
