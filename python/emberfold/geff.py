# SPDX-License-Identifier: Apache-2.0
"""Strokes or curves as a GEFF, the exchange format of tracking tools: a folder in the format zarr 2, written without zarr."""
from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any, Dict, List, Tuple

import numpy as np

VERSION = "1.1.0"


def _group(folder: Path) -> None:
    folder.mkdir(parents=True)
    (folder / ".zgroup").write_text('{"zarr_format": 2}')


def _array(folder: Path, values: np.ndarray) -> None:
    """One chunk, not compressed."""
    values = np.ascontiguousarray(values, values.dtype.newbyteorder("<"))
    folder.mkdir(parents=True)
    about = {"zarr_format": 2, "shape": values.shape, "chunks": [max(1, n) for n in values.shape], "dtype": values.dtype.str,
             "compressor": None, "fill_value": 0, "order": "C", "filters": None}
    (folder / ".zarray").write_text(json.dumps(about))
    if values.size:
        (folder / ".".join("0" * values.ndim)).write_bytes(values.tobytes())


def _items(folder: Path, ids: np.ndarray, props: Dict[str, np.ndarray]) -> Dict[str, Any]:
    """Writes nodes or edges; returns what the metadata say of their properties."""
    _group(folder)
    _array(folder / "ids", ids)
    _group(folder / "props")
    for name, values in props.items():
        _group(folder / "props" / name)
        _array(folder / "props" / name / "values", values)
    return {name: {"identifier": name, "dtype": values.dtype.name, "varlength": False} for name, values in props.items()}


def _edges(run: Any, rows: Dict[Tuple[int, int], int]) -> Tuple[np.ndarray, np.ndarray]:
    """Pairs of nodes, and the probability of the event between them: 1 where a stroke goes on."""
    pairs: List[Tuple[int, int]] = []
    probability: List[float] = []
    for (stroke, frame), node in rows.items():
        if (stroke, frame + 1) in rows:
            pairs.append((node, rows[stroke, frame + 1]))
            probability.append(1.0)
    tree = run.genealogy()
    for a, b, edge in tree.edges(data=True):
        ends = (a, tree.nodes[a].get("last")), (b, tree.nodes[b].get("first"))
        if ends[0] in rows and ends[1] in rows and ends[0][1] < ends[1][1]:
            pairs.append((rows[ends[0]], rows[ends[1]]))
            probability.append(edge["probability"])
    return np.array(pairs, np.uint64).reshape(-1, 2), np.array(probability, float)


def _axis(name: str, kind: str, unit: str, values: np.ndarray) -> Dict[str, Any]:
    axis: Dict[str, Any] = {"name": name, "type": kind, "unit": unit}
    if len(values):
        axis.update(min=float(values.min()), max=float(values.max()))
    return axis


def _curve_edges(rows: Dict[Tuple[int, int], int]) -> Tuple[np.ndarray, np.ndarray]:
    """Pairs of nodes: each curve from one frame in which it is seen to the next."""
    keys = list(rows)
    pairs = [(rows[a], rows[b]) for a, b in zip(keys, keys[1:]) if a[0] == b[0]]
    return np.array(pairs, np.uint64).reshape(-1, 2), np.ones(len(pairs))


def write(run: Any, path: Path, of: str = "strokes") -> None:
    """A node is a stroke (a curve) in a frame; edges lead to the next frame and, at events of strokes, from stroke to stroke."""
    if of not in ("strokes", "curves"):
        raise ValueError(f"of is {of!r}; allowed is strokes or curves")
    if path.exists() and not (path / ".zattrs").exists():
        raise FileExistsError(f"{path} is there and no GEFF; it is left alone")
    name = of[:-1]
    table = run.strokes if of == "strokes" else run.curves
    table = table[table[name] > 0].sort_values([name, "frame"])
    rows = {key: node for node, key in enumerate(zip(table[name].tolist(), table["frame"].tolist()))}
    scale, unit = (1.0, "pixel") if run.pixel_size is None else (run.pixel_size, "micrometer")
    nodes = {"t": table["frame"].to_numpy(float) / run.fps, "y": table["y"].to_numpy(float) * scale,
             "x": table["x"].to_numpy(float) * scale, "frame": table["frame"].to_numpy(np.int64),
             name: table[name].to_numpy(np.int64), "length": table["length"].to_numpy(float) * scale}
    pairs, probability = _edges(run, rows) if of == "strokes" else _curve_edges(rows)
    part = path.with_name(path.name + ".part")
    shutil.rmtree(part, ignore_errors=True)
    _group(part)
    about = {"geff_version": VERSION, "directed": True,
             "axes": [_axis("t", "time", "second", nodes["t"]), _axis("y", "space", unit, nodes["y"]),
                      _axis("x", "space", unit, nodes["x"])],
             "display_hints": {"display_horizontal": "x", "display_vertical": "y", "display_time": "t"},
             "node_props_metadata": _items(part / "nodes", np.arange(len(table), dtype=np.uint64), nodes),
             "edge_props_metadata": _items(part / "edges", pairs, {"probability": probability})}
    (part / ".zattrs").write_text(json.dumps({"geff": about}, indent=1))
    shutil.rmtree(path, ignore_errors=True)
    part.rename(path)
