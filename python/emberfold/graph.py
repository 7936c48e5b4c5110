# SPDX-License-Identifier: Apache-2.0
"""Graphs of frames and their links in time."""
from __future__ import annotations

import os
from pathlib import Path
from typing import Any, List, Tuple, Union

import networkx as nx
import numpy as np
import pandas as pd

from . import _native
from ._native import (EVENT_TYPES, PATCH_DTYPE, PATCH_TYPES, MatchOptions, MotionGraph, ScoreOptions, SketchSequence, event_contacts,
                      events_json, stroke_events, trajectories)
from .progress import Progress, reporter

__all__ = ["EVENT_TYPES", "PATCH_DTYPE", "PATCH_TYPES", "MatchOptions", "MotionGraph", "ScoreOptions", "SketchSequence", "event_contacts",
           "events_json", "identify_curves", "match", "score_events", "stroke_events", "to_networkx", "trajectories"]

Events = Union[str, "os.PathLike[str]", pd.DataFrame, List[Tuple[Any, ...]]]


def _rows(table: pd.DataFrame, name: str) -> List[Tuple[Any, ...]]:
    for needed in ("frame", "type", "x", "y"):
        if needed not in table:
            raise ValueError(f"{name} has no column '{needed}'")
    probability = table["probability"] if "probability" in table else np.ones(len(table))
    none = [()] * len(table)
    before, after = (table[side] if side in table else none for side in ("before", "after"))
    return [(int(frame), str(kind), float(x), float(y), float(p), tuple(b), tuple(a)) for frame, kind, x, y, p, b, a in
            zip(table["frame"], table["type"], table["x"], table["y"], probability, before, after)]


def _answer(value: Any) -> Any:
    if isinstance(value, (bool, np.bool_)):
        return "yes" if value else "no"
    return None if value is None or pd.isna(value) or value == "" else str(value)


def tuples_of_review(review: Any) -> List[Tuple[Any, ...]]:
    """A review, from its file or a table, as the compiled part takes it."""
    if isinstance(review, (str, os.PathLike)):
        return _native.read_review(_text(review), os.fspath(review))
    if not isinstance(review, pd.DataFrame):
        return list(review)
    if "answer" not in review:
        raise ValueError("review has no column 'answer'")
    return [(*row, _answer(answer)) for row, answer in zip(_rows(review, "review"), review["answer"])]


def _text(path: Any) -> str:
    try:
        return Path(path).read_text(encoding="utf-8")
    except OSError as error:
        raise _native.IoError(f"{os.fspath(path)} cannot be read: {error.strerror}") from None


def _events(events: Events, name: str) -> List[Tuple[Any, ...]]:
    if isinstance(events, (str, os.PathLike)):
        return _native.told_events(_native.read_truth(_text(events), os.fspath(events)))
    return _rows(events, name) if isinstance(events, pd.DataFrame) else list(events)


def score_events(truth: Events, found: Events, **options: Any) -> pd.DataFrame:
    """Scores found events against the true ones, by class: of four and of six classes. Events are a table as `run.events`, a
    file (events.json, truth.json or review.json), or what stroke_events() returns. Arguments are the fields of ScoreOptions."""
    rows = _native.score_events(_events(truth, "truth"), _events(found, "found"), ScoreOptions(**options))
    names = ["classes", "type", "in_truth", "found", "hit", "precision", "recall", "f1"]
    return pd.DataFrame(rows, columns=names).set_index(["classes", "type"])


def match(sketch: SketchSequence, *, progress: Progress = None, **options: Any) -> MotionGraph:
    """Links every frame to the next; arguments are the fields of MatchOptions."""
    with reporter(progress) as report:
        return _native.match(sketch, MatchOptions(**options), report)


def identify_curves(motion: MotionGraph, *, progress: Progress = None) -> MotionGraph:
    """The same graphs with the identities of their curves."""
    with reporter(progress) as report:
        return _native.identify_curves(motion, report)


match.__doc__ = f"{match.__doc__}\n\n{_native.match.__doc__}"
score_events.__doc__ = f"{score_events.__doc__}\n\n{_native.score_events.__doc__}"
identify_curves.__doc__ = f"{identify_curves.__doc__}\n\n{_native.identify_curves.__doc__}"


def to_networkx(graphs: Union[MotionGraph, SketchSequence], frame: int) -> nx.Graph:
    """The graph of a frame; nodes are ids of patches and carry their numbers."""
    patches = graphs.patches(frame)
    names = [name for name in patches.dtype.names if name not in ("id", "left", "middle", "right")]
    columns = {name: patches[name].tolist() for name in names}
    columns["type"] = [PATCH_TYPES[kind] for kind in columns["type"]]
    made = nx.Graph(frame=frame)
    ids = patches["id"].tolist()
    made.add_nodes_from((key, dict(zip(names, row))) for key, row in zip(ids, zip(*(columns[name] for name in names))))
    made.add_edges_from(graphs.edges(frame).tolist())
    return made
