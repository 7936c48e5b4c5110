# SPDX-License-Identifier: Apache-2.0
"""Graphs of frames and their links in time."""
from __future__ import annotations

from typing import Any, Union

import networkx as nx

from . import _native
from ._native import (EVENT_TYPES, PATCH_DTYPE, PATCH_TYPES, MatchOptions, MotionGraph, SketchSequence, events_json,
                      stroke_events, trajectories)
from .progress import Progress, reporter

__all__ = ["EVENT_TYPES", "PATCH_DTYPE", "PATCH_TYPES", "MatchOptions", "MotionGraph", "SketchSequence", "events_json",
           "identify_curves", "match", "stroke_events", "to_networkx", "trajectories"]


def match(sketch: SketchSequence, *, progress: Progress = None, **options: Any) -> MotionGraph:
    """Links every frame to the next; arguments are the fields of MatchOptions."""
    with reporter(progress) as report:
        return _native.match(sketch, MatchOptions(**options), report)


def identify_curves(motion: MotionGraph, *, progress: Progress = None) -> MotionGraph:
    """The same graphs with the identities of their curves."""
    with reporter(progress) as report:
        return _native.identify_curves(motion, report)


match.__doc__ = f"{match.__doc__}\n\n{_native.match.__doc__}"
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
