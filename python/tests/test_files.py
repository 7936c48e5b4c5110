# SPDX-License-Identifier: Apache-2.0
"""Runs in folders, and graphs for other programs."""
import json
from pathlib import Path

import numpy as np
import pytest

import emberfold as ef
from emberfold import _native
from scenes import bars


def read_zarr(folder):
    """Reads an array as the zarr 2 specification says, apart from the code that writes it."""
    about = json.loads((folder / ".zarray").read_text())
    assert about["zarr_format"] == 2 and about["compressor"] is None and about["order"] == "C"
    assert json.loads((folder.parent / ".zgroup").read_text()) == {"zarr_format": 2}
    chunk = folder / ".".join("0" for _ in about["shape"])
    data = chunk.read_bytes() if chunk.exists() else b""
    return np.frombuffer(data, about["dtype"]).reshape(about["shape"])


def test_a_run_is_not_done_again(tmp_path, monkeypatch):
    clip = bars(10)
    first = ef.analyze(clip, quality="draft", out=tmp_path / "a")
    calls = []
    native = _native.analyze
    monkeypatch.setattr(_native, "analyze", lambda *given: calls.append(1) or native(*given))
    again = ef.analyze(clip, quality="draft", out=tmp_path / "a")
    assert not calls and again == first and again.events.equals(first.events)
    ef.analyze(clip, quality="draft", bottom_up=True, out=tmp_path / "a")
    assert calls == [1]


def test_other_peoples_folders_are_left_alone(tmp_path):
    (tmp_path / "notes.txt").write_text("mine")
    with pytest.raises(FileExistsError):
        ef.analyze(bars(6), quality="draft", bottom_up=True, out=tmp_path)
    with pytest.raises(FileExistsError):
        ef.analyze(bars(6), quality="draft", bottom_up=True).to_geff(tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["notes.txt"]


def test_geff_holds_strokes_and_events(run, tmp_path):
    path = tmp_path / "run.geff"
    run.to_geff(path)
    run.to_geff(path)
    about = json.loads((path / ".zattrs").read_text())["geff"]
    assert about["directed"] is True and [axis["name"] for axis in about["axes"]] == ["t", "y", "x"]
    ids, edges = read_zarr(path / "nodes/ids"), read_zarr(path / "edges/ids")
    assert len(set(ids)) == len(ids) and set(edges.ravel()) <= set(ids) and edges.dtype == ids.dtype
    assert len({tuple(edge) for edge in edges}) == len(edges)
    props = {name: read_zarr(path / "nodes/props" / name / "values") for name in about["node_props_metadata"]}
    assert all(len(values) == len(ids) for values in props.values())
    assert (props["frame"][edges[:, 0]] < props["frame"][edges[:, 1]]).all()
    assert np.allclose(props["t"], props["frame"] / 30)
    split = run.events.iloc[0]
    heads = edges[props["stroke"][edges[:, 0]] == split["before"][0]][:, 1]
    assert set(split["after"]) <= set(props["stroke"][heads])


def test_geff_of_curves_follows_them(run, tmp_path):
    run.to_geff(tmp_path / "curves.geff", of="curves")
    ids, edges = read_zarr(tmp_path / "curves.geff/nodes/ids"), read_zarr(tmp_path / "curves.geff/edges/ids")
    about = json.loads((tmp_path / "curves.geff/.zattrs").read_text())["geff"]
    props = {name: read_zarr(tmp_path / "curves.geff/nodes/props" / name / "values") for name in about["node_props_metadata"]}
    curve, frame = props["curve"], props["frame"]
    assert len(ids) == len(run.curves) > 0
    assert (curve[edges[:, 0]] == curve[edges[:, 1]]).all() and (frame[edges[:, 0]] < frame[edges[:, 1]]).all()
    assert len(edges) == len(ids) - len(set(curve))  # one track for each curve
    with pytest.raises(ValueError, match="strokes or curves"):
        run.to_geff(tmp_path / "x.geff", of="patches")


def test_tables_of_the_network_balance(run):
    network, topology = run.network.set_index("frame"), run.topology
    said = topology.groupby("frame")[["tips", "branches", "components", "loops"]].sum()
    said = said.reindex(network.index[1:], fill_value=0)
    network["tips"] += 2 * network["points"]
    assert (network[said.columns].diff().iloc[1:] == said).all().all()
    assert {"branch_extruded", "branch_retracted", "ring_closed", "ring_opened", "t1", "birth", "death", "split", "merge",
            "connect", "disconnect"} >= set(topology["change"])
    tips = run.tips
    assert (tips["first"] < tips["last"]).all() and set(tips["phase"]) <= {"growth", "retraction", "pause"}
    assert np.allclose(tips["rate_px_s"], tips["rate"] * run.fps)
    assert len(run.plot("network").axes) == 5


def test_tracks_mean_what_naparis_layer_takes(run):
    data, parents = run.tracks()
    assert data.shape[1] == 4 and np.issubdtype(data.dtype, np.floating)
    order = np.lexsort((data[:, 1], data[:, 0]))
    assert (order == np.arange(len(data))).all()  # by track, then by time
    assert len({tuple(row[:2]) for row in data}) == len(data)  # a track is in one place at a time
    tracks = set(data[:, 0])
    begins = {track: data[data[:, 0] == track, 1].min() for track in tracks}
    ends = {track: data[data[:, 0] == track, 1].max() for track in tracks}
    assert parents
    for child, of in parents.items():
        assert child in tracks and of and set(of) <= tracks
        assert all(ends[parent] < begins[child] for parent in of)


def snippet():
    page = Path(__file__).parents[2] / "docs/python.md"
    return page.read_text().split("```python\n# napari reader\n", 1)[1].split("```", 1)[0]


def test_the_napari_reader_of_the_docs(tmp_path):
    ef.write_video(tmp_path / "clip.avi", bars(14), fps=30)
    space = {}
    exec(snippet(), space)
    assert space["napari_get_reader"]("notes.txt") is None
    layers = space["napari_get_reader"](str(tmp_path / "clip.avi"))(str(tmp_path / "clip.avi"))
    assert [kind for _, _, kind in layers] == ["image", "tracks", "points"]
    image, tracks, points = layers
    assert image[0].shape == (14, 96, 128) and tracks[0].shape[1] == 4
    assert set(tracks[1]["graph"]) <= set(tracks[0][:, 0]) and len(points[0]) == len(points[1]["features"])
