# SPDX-License-Identifier: Apache-2.0
"""Pictures with matplotlib, which is needed for nothing else. Figures belong to no window: notebooks show what is returned."""
from __future__ import annotations

from typing import Any

import numpy as np

from ._native import EVENT_TYPES

COLOURS = dict(zip(EVENT_TYPES, ("#2ca02c", "#d62728", "#ff7f0e", "#1f77b4", "#17becf", "#9467bd")))
NEAR = 2  # frames before and after, whose events are drawn


def _axes(width: float = 7, height: float = 4) -> Any:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure, figure.subplots()


def _image(axes: Any, clip: Any, t: int) -> None:
    picture = np.clip(clip[t].astype(np.float32) / clip.white, 0, 1)
    axes.imshow(picture, cmap="gray", vmin=0, vmax=1)


def frame(clip: Any, t: int) -> Any:
    figure, axes = _axes(5, 5 * clip.height / clip.width)
    _image(axes, clip, t)
    axes.set_axis_off()
    return figure


def graph(run: Any, t: int) -> Any:
    from matplotlib.collections import LineCollection

    figure, axes = _axes(6, 6 * run.motion.height / run.motion.width)
    if run.clip is not None:
        _image(axes, run.clip, t)
    patches, edges = run.patches(t), run.edges(t)
    places = np.column_stack([patches["x"], patches["y"]])
    ends = np.searchsorted(patches["id"], edges)
    axes.add_collection(LineCollection(places[ends], colors="#ffcc00", linewidths=1))
    events = run.events[(run.events["frame"] - t).abs() <= NEAR]
    for kind, rows in events.groupby("type", observed=True):
        axes.plot(rows["x"] - run._origin[0], rows["y"] - run._origin[1], "o", fillstyle="none", color=COLOURS[kind], label=kind)
    if len(events):
        axes.legend(loc="upper right", fontsize="small")
    axes.set(xlim=(-0.5, run.motion.width - 0.5), ylim=(run.motion.height - 0.5, -0.5), title=f"frame {t}", aspect="equal")
    axes.set_axis_off()
    return figure


def texture(shown: Any) -> Any:
    """The mean image and the components of most variance."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    images = [("mean", shown.mean)]
    images += [(f"component {k + 1}", shown.C[:, k]) for k in range(min(3, shown.components))]
    figure = Figure(figsize=(2.5 * len(images), 2.5 * shown.height / shown.width + 0.4), layout="constrained")
    FigureCanvasAgg(figure)
    for axes, (name, values) in zip(np.atleast_1d(figure.subplots(1, len(images))), images):
        image = np.asarray(values, float).reshape(shown.height, shown.width, shown.channels).mean(axis=2)
        axes.imshow(image, cmap="gray")
        axes.set(title=name)
        axes.set_axis_off()
    return figure


def model(shown: Any) -> Any:
    """Where strokes are born and die, by the model's maps."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    motion = shown.motion
    figure = Figure(figsize=(8, 4 * motion.height / motion.width + 0.4), layout="constrained")
    FigureCanvasAgg(figure)
    maps = ("births, a frame and px²", motion.rates.birth), ("deaths, beside the mean", motion.rates.death)
    for axes, (name, values) in zip(figure.subplots(1, 2), maps):
        drawn = axes.imshow(values, extent=(0, motion.width, motion.height, 0))
        axes.set(title=name)
        figure.colorbar(drawn, ax=axes)
    return figure


def _events(run: Any, axes: Any) -> None:
    bins = np.linspace(0, run.frames / run.fps, min(run.frames, 40) + 1) + run._origin[2]
    times = [run.events.loc[run.events["type"] == kind, "t_s"] for kind in EVENT_TYPES]
    axes.hist(times, bins=bins, stacked=True, label=EVENT_TYPES, color=[COLOURS[kind] for kind in EVENT_TYPES])
    axes.set(xlabel="s", ylabel="events")
    axes.legend(fontsize="small")


def _rates(run: Any, axes: Any) -> None:
    rates = run.rates()
    spread = [rates["per_s"] - rates["per_s_low"], rates["per_s_high"] - rates["per_s"]]
    axes.bar(rates.index, rates["per_s"], yerr=spread, capsize=3, color=[COLOURS[kind] for kind in rates.index])
    axes.set(ylabel="events a second, with 90 % intervals")


def _tracks(run: Any, axes: Any) -> None:
    for _, rows in run.strokes.groupby("stroke"):
        axes.plot(rows["x"], rows["y"], linewidth=0.8)
    axes.set(xlabel="x, px", ylabel="y, px", xlim=(0, run.motion.width), ylim=(run.motion.height, 0), aspect="equal")


def _network(run: Any) -> Any:
    """Length, tips, junctions, loops and components of each frame, one below the other."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    table = run.network
    unit = "um" if "length_um" in table else "px"
    junctions = table["junctions_3"] + table["junctions_4"] + table["junctions_more"]
    parts = {f"length, {unit}": table["length_um" if unit == "um" else "length"], "tips": table["tips"], "junctions": junctions,
             "loops": table["loops"], "components": table["components"]}
    figure = Figure(figsize=(7, 1.4 * len(parts)), layout="constrained")
    FigureCanvasAgg(figure)
    for axes, (name, values) in zip(figure.subplots(len(parts), 1, sharex=True), parts.items()):
        axes.plot(table["time_s"], values, linewidth=1)
        axes.set(ylabel=name, ylim=(0, None))
    axes.set(xlabel="s")
    return figure


def of_run(run: Any, kind: str) -> Any:
    if kind == "network":
        return _network(run)
    kinds = {"events": _events, "rates": _rates, "tracks": _tracks}
    if kind not in kinds:
        raise ValueError(f"kind is {kind!r}; allowed is one of {', '.join(kinds)}, network")
    figure, axes = _axes()
    kinds[kind](run, axes)
    return figure
