# SPDX-License-Identifier: Apache-2.0
"""The analysis of a clip."""
from __future__ import annotations

import io
import os
import shutil
from pathlib import Path
from typing import Any, Dict, List, Optional, Tuple, Union

import networkx as nx
import numpy as np
import pandas as pd

from . import _native, store
from .clip import Clip, ClipLike, open_clip
from .graph import to_networkx, tuples_of_review
from .progress import Progress, reporter


class Run:
    """What was found in a clip: events, rates, graphs and the model that new clips are drawn from.

    A value that can be pickled; of its clip it then keeps the file's name, but no array. Times are in s where the clip's fps
    is right, places in µm where its pixel_size is known.
    """

    def __init__(self, clip: Optional[Clip], found: Dict[str, Any], options: Optional[_native.AnalyzeOptions]):
        self.clip, self.options = clip, options
        self.motion: _native.MotionGraph = found["motion"]
        self.model: _native.ClipModel = found["model"]
        self.stages: Dict[str, float] = dict(found.get("stages", ()))
        self.pixel_size: Optional[float] = found["pixel_size"]
        self._times, self._origin = found["place"]
        self._events, self._all_events = found["events"], found["all_events"]
        self._rates, self._reviewed = found.get("rates"), found.get("reviewed")

    fps = property(lambda self: self.motion.fps)
    frames = property(lambda self: len(self.motion), doc="Number of frames.")

    @property
    def events(self) -> pd.DataFrame:
        """Events of probability 0.5 or more: t_s, x_um, y_um, frame, x, y, type, probability, before, after."""
        return self._table(self._events)

    @property
    def all_events(self) -> pd.DataFrame:
        """Events of any probability, else as `events`."""
        return self._table(self._all_events)

    def _table(self, events: List[Tuple[Any, ...]]) -> pd.DataFrame:
        names = ["frame", "type", "x", "y", "probability", "before", "after"]
        table = self._with_units(pd.DataFrame(events, columns=names))
        table["type"] = pd.Categorical(table["type"], categories=_native.EVENT_TYPES)
        return table[["t_s", "x_um", "y_um", "frame", "x", "y", "type", "probability", "before", "after", *table.columns[10:]]]

    def _with_units(self, table: pd.DataFrame) -> pd.DataFrame:
        """Adds times, and positions in micrometres, and lets positions count as the clip's `origin` says."""
        size = np.nan if self.pixel_size is None else self.pixel_size
        x, y, seconds, counted_from = self._origin
        table["t_s"] = np.asarray(self._times)[table["frame"].astype(int)] if self._times else table["frame"] / self.fps + seconds
        table["x"], table["y"] = table["x"] + x, table["y"] + y
        table["x_um"], table["y_um"] = table["x"] * size, table["y"] * size
        if counted_from:
            table["counted_from"] = counted_from
        return table

    def rates(self, by: Optional[str] = "type", interval: float = 0.9) -> pd.DataFrame:
        """Rates of the events, a frame and a second, with credible intervals of probability `interval`.

        by: "type", a row each; None: all events in one row.
        """
        if by not in ("type", None):
            raise ValueError(f"by is {by!r}; allowed is 'type' or None")
        if not 0 < interval < 1:
            raise ValueError(f"interval is {interval}; allowed is a number between 0 and 1")
        types = [e[1] for e in self._events]
        counts = {t: types.count(t) for t in _native.EVENT_TYPES} if by else {"all": len(types)}
        rows = []
        for kind, count in counts.items():
            gaps = max(1, self.frames - 1)
            _, low, high = _native.rate_interval(count, gaps, probability=interval)
            # Of what was never seen nothing says that it happens at all.
            found = np.array([count / gaps, low if count else 0, high])
            rows.append((kind, count, *found, *(found * self.fps)))
        names = ["type", "events", "per_frame", "per_frame_low", "per_frame_high", "per_s", "per_s_low", "per_s_high"]
        return pd.DataFrame(rows, columns=names).set_index("type")

    @property
    def reviewed(self) -> Optional[pd.DataFrame]:
        """How many events of each class there were by the review, and their rates a frame, with 90 % intervals that also hold
        what is not known of the events without an answer; None without a review."""
        if self._reviewed is None:
            return None
        rows = [(*count, *rate) for count, rate in zip(self._reviewed["counts"], self._reviewed["rates"])]
        names = ["events", "events_low", "events_high", "per_frame", "per_frame_low", "per_frame_high"]
        return pd.DataFrame(rows, columns=names, index=pd.Index([*_native.EVENT_TYPES, "all"], name="type"))

    def patches(self, frame: int) -> np.ndarray:
        """The patches of a frame: a structured array, a view of the graph's own memory. `type` indexes PATCH_TYPES."""
        return self.motion.patches(frame)

    def edges(self, frame: int) -> np.ndarray:
        """The edges of a frame, pairs of ids: a view, too."""
        return self.motion.edges(frame)

    def links(self, frame: int) -> np.ndarray:
        """The links of a frame's patches to those of the frame before, pairs of ids (before, after): a view, too."""
        return self.motion.links(frame)

    def graph(self, frame: int) -> nx.Graph:
        """The graph of a frame; nodes are ids of patches and carry their numbers."""
        return to_networkx(self.motion, frame)

    def genealogy(self) -> nx.DiGraph:
        """Which strokes became which. Nodes are strokes, with their first and last frame, and the events of their birth and
        death; edges lead from the strokes before an event to those after it and carry it."""
        tree = nx.DiGraph()
        for t in range(self.frames):
            for stroke in np.unique(self.patches(t)["stroke"]).tolist():
                node = tree.nodes.get(stroke)
                if node is None:
                    tree.add_node(stroke, first=t, last=t)
                else:
                    node["last"] = t
        for frame, kind, x, y, probability, before, after in store.moved(self._all_events, self._origin):
            event = {"frame": frame, "type": kind, "x": x, "y": y, "probability": probability}
            if kind in ("birth", "death"):
                for stroke in before + after:
                    tree.add_node(stroke, **{kind: event})
            for a in before:
                for b in after:
                    if tree.has_edge(a, b):
                        tree.edges[a, b]["events"].append(event)
                    else:
                        tree.add_edge(a, b, events=[event], **event)
        return tree

    @property
    def strokes(self) -> pd.DataFrame:
        """Every stroke in every frame: its middle, length, patches, width, contrast, ends and junctions."""
        return self._with_units(pd.read_csv(io.BytesIO(self.motion.strokes_csv())))

    @property
    def _units(self) -> Tuple[Any, ...]:
        """Units as the compiled part takes them."""
        return 1 / self.fps, self.pixel_size, self._times, self._origin

    def _read_table(self, write: Any) -> pd.DataFrame:
        """A table of the motion graph, in seconds and micrometres where these are known."""
        return pd.read_csv(io.BytesIO(write(*self._units)))

    @property
    def curves(self) -> pd.DataFrame:
        """Every curve in every frame: a path through junctions and crossings, whose name stays where curves touch."""
        return self._read_table(self.motion.curves_csv)

    @property
    def network(self) -> pd.DataFrame:
        """What each frame is as a network: length, tips, junctions, loops, meshes, components, tortuosity."""
        return self._read_table(self.motion.network_csv)

    @property
    def topology(self) -> pd.DataFrame:
        """Each change of topology and what it adds to tips, branches, components and loops: the sums over a frame are what
        the network's figures change by."""
        return self._read_table(self.motion.topology_csv)

    @property
    def tips(self) -> pd.DataFrame:
        """When each tip grows, retracts and pauses, and how fast."""
        return self._read_table(self.motion.tips_csv)

    @property
    def joints(self) -> pd.DataFrame:
        """Where curves go on or touch, and how likely they go on."""
        return self._read_table(self.motion.joints_csv)

    @property
    def contacts(self) -> pd.DataFrame:
        """Where two curves touch or cross, and how long."""
        return self._read_table(lambda *units: _native.contacts_csv(self.motion, *units))

    @property
    def lives(self) -> pd.DataFrame:
        """How long each stroke lives, how it grows and moves."""
        return self._read_table(lambda *units: _native.lives_csv(self.motion, *units))

    @property
    def named_events(self) -> pd.DataFrame:
        """`events` and how parts meet or part in each: tip_tip, tip_side, side_side, or nothing."""
        return self.events.assign(contact=_native.event_contacts(self.motion, self._events))

    @property
    def trajectories(self) -> pd.DataFrame:
        """Every patch through time."""
        return self._with_units(pd.read_csv(io.BytesIO(self.motion.trajectories_csv())))

    def tracks(self) -> Tuple[np.ndarray, Dict[int, List[int]]]:
        """Strokes as napari's layer Tracks takes them: rows of stroke, frame, y, x (px of the frames that were read), and the
        parents of strokes."""
        strokes = pd.read_csv(io.BytesIO(self.motion.strokes_csv()))
        strokes = strokes[strokes["stroke"] > 0].sort_values(["stroke", "frame"])
        data = strokes[["stroke", "frame", "y", "x"]].to_numpy(dtype=float)
        known = set(strokes["stroke"])
        parents: Dict[int, List[int]] = {}
        for before, after in self.genealogy().edges:
            if before in known and after in known:
                parents.setdefault(after, []).append(before)
        return data, parents

    def to_geff(self, path: Union[str, "os.PathLike[str]"], of: str = "strokes") -> None:
        """Writes strokes and their events, or `of` "curves", as a GEFF, a folder; one that is there is replaced, other things
        are not. Curves go on through touches and crossings; their edges join a curve's frames, also over gaps."""
        path = Path(path)
        if path.exists() and not (path / ".zattrs").exists():
            raise FileExistsError(f"{path} is there and no GEFF; it is left alone")
        files = _native.geff_files(self.motion, self._events, of, *self._units)
        part = path.with_name(path.name + ".part")
        shutil.rmtree(part, ignore_errors=True)
        for name, content in files.items():
            (part / name).parent.mkdir(parents=True, exist_ok=True)
            (part / name).write_bytes(content)
        shutil.rmtree(path, ignore_errors=True)
        part.rename(path)

    def to_trackmate(self, path: Union[str, "os.PathLike[str]"], of: str = "strokes") -> None:
        """Writes strokes, or `of` "curves", as TrackMate of Fiji reads them."""
        self._write_text(path, _native.trackmate_xml, of)

    def to_graphml(self, path: Union[str, "os.PathLike[str]"]) -> None:
        """Writes the strokes' genealogy as GraphML."""
        self._write_text(path, _native.genealogy_graphml, "strokes")

    def _write_text(self, path: Union[str, "os.PathLike[str]"], make: Any, of: str) -> None:
        name = "" if self.clip is None else self.clip.name
        Path(path).write_bytes(make(self.motion, self._events, of, name, *self._units))

    def __getstate__(self) -> Dict[str, Any]:
        state = dict(self.__dict__)
        if self.clip is not None and self.clip._state[0] == "array":
            state["clip"] = None
        return state

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Run):
            return NotImplemented
        return (self._all_events, self.motion, self.model) == (other._all_events, other.motion, other.model)

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return f"Run({self.frames} frames, {len(self._events)} events)"

    def _repr_html_(self) -> str:
        from . import html
        return html.run(self)

    def show(self, frame: Optional[int] = None) -> Any:
        """Draws a frame with its graph and the events around it; returns the figure."""
        from . import plot
        return plot.graph(self, self.frames // 2 if frame is None else frame)

    def plot(self, kind: str = "events") -> Any:
        """Plots "events" over time, "rates", "tracks" or "network" with matplotlib; returns the figure."""
        from . import plot
        return plot.of_run(self, kind)


def _options(quality: str, given: Dict[str, Any], clip: Clip) -> _native.AnalyzeOptions:
    review = given.pop("review", None)
    options = _native.AnalyzeOptions(**given)
    if review is not None:
        options.review = store.moved(tuples_of_review(review), clip._data.origin, -1)
    _native.set_quality(options, quality)
    return options


def analyze(clip: ClipLike, *, quality: str = "normal", progress: Progress = None,
            out: Union[None, str, "os.PathLike[str]"] = None, **options: Any) -> Run:
    """Finds strokes, their events and their model in a clip.

    quality: "draft" keeps every event of the match, with probability 1; "normal"
    weighs events by what the images show. Other arguments are the fields of AnalyzeOptions; groups of them are dicts: sketch={"sensitivity": 0.5}. review: a review.json, or a table with the columns of
    `events` and `answer` (True, False, another type, "added" or nothing): answers are taken as facts.
    progress: True for a line on standard error, or a function of stage and share. out: a folder that keeps what each stage
    made; asked again, also with other options or after it was broken off, only what is missing is made.
    """
    opened = open_clip(clip)
    asked = _options(quality, options, opened)
    folder = None if out is None else Path(out)
    if folder is not None:
        store.prepare(folder)
    with reporter(progress) as report:
        found = _native.analyze(opened._data, asked, report, *(() if folder is None else (str(folder), store.keys_of(opened, asked))))
    found["pixel_size"], found["place"] = opened.pixel_size, (opened._data.times, opened._data.origin)
    if folder is not None:
        store.save(found, opened, folder)
    return Run(opened, found, asked)


def read_run(folder: Union[str, "os.PathLike[str]"], clip: Optional[ClipLike] = None) -> Run:
    """Reads a run from its folder, of analyze(out=) or of the command. clip: its clip, if pictures of it are to be drawn."""
    return Run(None if clip is None else open_clip(clip), store.load(Path(folder)), None)


analyze.__doc__ = f"{analyze.__doc__}\n\n{_native.analyze.__doc__}"
