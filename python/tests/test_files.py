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


def stages_of(clip, folder, **options):
    """The stages that report progress, and the run."""
    seen = {}
    run = ef.analyze(clip, out=folder, progress=lambda stage, share: seen.setdefault(stage, share), **options)
    return set(seen), run


def test_a_stage_is_not_done_again(tmp_path):
    clip = bars(10)
    begun, first = stages_of(clip, tmp_path / "a", quality="draft")
    assert "sketch" in begun
    again, second = stages_of(clip, tmp_path / "a", quality="draft")
    assert not again and second == first and second.events.equals(first.events) and second.model == first.model
    other, third = stages_of(clip, tmp_path / "a")  # other events, of the same sketches
    assert other and "sketch" not in other
    assert third == ef.analyze(clip)
    assert "sketch" in stages_of(bars(10, seed=3), tmp_path / "a", quality="draft")[0]


def test_a_run_that_was_broken_off_goes_on(tmp_path):
    clip = bars(10)
    done = []

    def stop(stage, share):
        if stage != "sketch":
            done.append(stage)
            raise LookupError("enough")

    with pytest.raises(LookupError):
        ef.analyze(clip, out=tmp_path / "a", progress=stop)
    with pytest.raises(ef.IoError, match="broken off"):
        ef.read_run(tmp_path / "a")
    stages, run = stages_of(clip, tmp_path / "a")
    assert done and "sketch" not in stages and run == ef.analyze(clip)


def test_a_run_is_read_from_its_folder(tmp_path):
    clip = ef.open(bars(10), fps=20, pixel_size=0.5)
    run = ef.analyze(clip, quality="draft", out=tmp_path / "a")
    again = ef.read_run(tmp_path / "a", clip)
    assert again.events.equals(run.events) and again.rates().equals(run.rates()) and again.strokes.equals(run.strokes)
    assert again.model == run.model and again.show(3).axes and repr(again) == repr(run)
    with pytest.raises(ef.IoError, match="no finished run"):
        ef.read_run(tmp_path)


def test_answers_of_a_review_are_facts(run, tmp_path):
    clip = ef.open(bars(), fps=30, pixel_size=0.065)
    assert run.reviewed is None
    asked = run.all_events.copy()
    asked["answer"] = [False] + [None] * (len(asked) - 1)
    asked.loc[len(asked)] = {**asked.iloc[0].to_dict(), "frame": 5, "x": 100.0, "y": 80.0, "type": "birth", "answer": "added",
                             "before": (), "after": ()}
    told = ef.analyze(clip, review=asked)
    first = run.all_events.iloc[0]
    same = told.all_events.query("frame == @first.frame and x == @first.x and y == @first.y")
    assert list(same["probability"]) == [0]
    assert len(told.events.query("frame == 5 and x == 100 and probability == 1")) == 1
    assert told.reviewed.loc["birth", "events"] >= 1 and (told.reviewed["events_low"] <= told.reviewed["events_high"]).all()
    path = tmp_path / "review.json"
    entries = json.loads(ef.graph.events_json(run._all_events))
    for entry in entries["events"]:
        entry["answer"] = "yes"
    entries["format"] = "emberfold.review"
    path.write_text(json.dumps(entries))
    sure = ef.analyze(clip, review=path)
    assert (sure.all_events["probability"] == 1).all() and len(sure.all_events) == len(run.all_events)
    assert len(ef.graph.score_events(path, sure.events)) and (ef.graph.score_events(path, sure.events)["f1"] == 1).all()
    with pytest.raises(ValueError, match="review has no column 'answer'"):
        ef.analyze(clip, review=run.events)
    with pytest.raises(ValueError, match="'perhaps'"):
        ef.analyze(clip, review=run.events.assign(answer="perhaps"))


def test_scores_pair_events_within_their_tolerances(run):
    found = run.events
    moved = found.assign(frame=found["frame"] + 1, x=found["x"] + 5)
    assert (ef.graph.score_events(found, moved)["f1"] == 1).all()
    scores = ef.graph.score_events(found, moved, radius=1)
    assert (scores["hit"] == 0).all() and scores.loc[(4, "all"), "in_truth"] == len(found)
    with pytest.raises(ValueError, match="found has no column 'x'"):
        ef.graph.score_events(found, found.drop(columns="x"))


def test_other_programs_read_strokes(run, tmp_path):
    import networkx as nx
    from xml.etree import ElementTree

    run.to_graphml(tmp_path / "tree.graphml")
    tree = nx.read_graphml(tmp_path / "tree.graphml")
    believed = {(a, b) for _, e in run.events.iterrows() for a in e["before"] for b in e["after"]}
    assert {(int(a[1:]), int(b[1:])) for a, b in tree.edges} == believed
    run.to_trackmate(tmp_path / "tracks.xml")
    spots = ElementTree.parse(tmp_path / "tracks.xml").getroot().findall(".//Spot")
    assert len(spots) == len(run.strokes[run.strokes["stroke"] > 0])


def test_tables_of_curves_and_lives(run):
    assert set(run.contacts) >= {"curve_a", "curve_b", "crosses", "first", "last"}
    assert ((run.joints["probability"] >= 0) & (run.joints["probability"] <= 1)).all()
    lives = run.lives
    assert (lives["last"] >= lives["first"]).all() and len(lives) == run.strokes["stroke"].nunique()
    named = run.named_events
    assert len(named) == len(run.events) and set(named["contact"]) <= {"", "tip_tip", "tip_side", "side_side"}


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
    time = about["axes"][0]
    assert np.array_equal(props["t"], props["frame"]) and props["t"].dtype.kind == "i"
    assert (time["unit"], time["scaled_unit"]) == ("frame", "second") and time["scale"] == pytest.approx(1 / 30)
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
