# SPDX-License-Identifier: Apache-2.0
import copy
import pickle

import networkx as nx
import numpy as np
import pytest

import emberfold as ef
from scenes import bars


def test_events_have_units(run):
    events = run.events
    assert list(events) == ["t_s", "x_um", "y_um", "frame", "x", "y", "type", "probability", "before", "after"]
    split = events.query("probability > .9 and type in ('split', 'merge')").iloc[0]
    assert split["type"] == "split" and abs(split["frame"] - 12) <= 1 and abs(split["x"] - 65) < 5
    assert split["t_s"] == split["frame"] / 30 and split["x_um"] == split["x"] * 0.065
    assert len(split["before"]) == 1 and len(split["after"]) == 2


def test_rates_are_the_librarys(run):
    rates = run.rates(by="type", interval=0.9)
    assert np.allclose(rates[["per_frame", "per_frame_low", "per_frame_high"]], run._rates)
    assert np.allclose(rates["per_s"], rates["per_frame"] * 30)
    wide = run.rates(interval=0.99)
    assert (wide["per_frame_high"] > rates["per_frame_high"]).all()
    assert run.rates(by=None)["events"].sum() == len(run.events)
    with pytest.raises(ValueError, match="interval is 2"):
        run.rates(interval=2)


def test_graphs(run):
    graph, patches = run.graph(10), run.patches(10)
    assert isinstance(graph, nx.Graph) and len(graph) == len(patches) and graph.number_of_edges() == len(run.edges(10))
    node = graph.nodes[int(patches["id"][0])]
    assert node["x"] == patches["x"][0] and node["type"] in ef.graph.PATCH_TYPES
    strokes = {frozenset(graph.nodes[n]["stroke"] for n in part) for part in nx.connected_components(graph)}
    assert all(len(part) == 1 for part in strokes)


def test_patches_are_a_view(run):
    patches = run.patches(10)
    assert not patches.flags.owndata and not patches.flags.writeable
    assert patches.__array_interface__["data"] == run.patches(10).__array_interface__["data"]
    held = copy.copy(patches)
    assert np.array_equal(held["x"], patches["x"]) and np.isfinite(patches["theta"]).all()
    with pytest.raises(IndexError, match="frame is 99"):
        run.patches(99)


def test_views_outlive_their_run():
    patches = ef.analyze(bars(10), quality="draft", bottom_up=True).patches(3)
    before = patches.copy()
    assert np.array_equal(patches, before) and len(patches)


def test_genealogy(run):
    tree = run.genealogy()
    assert isinstance(tree, nx.DiGraph) and nx.is_directed_acyclic_graph(tree)
    for before, after, edge in tree.edges(data=True):
        assert tree.nodes[before]["last"] < tree.nodes[after]["first"] + 1 and edge["type"] in ef.graph.EVENT_TYPES
    split = run.events.iloc[0]
    assert set(tree.successors(split["before"][0])) == set(split["after"])


def test_links_lead_from_frame_to_frame(run):
    links = run.links(5)
    assert set(links[:, 0]) <= set(run.patches(4)["id"]) and set(links[:, 1]) <= set(run.patches(5)["id"])
    assert len(run.links(0)) == 0


def test_rates_of_the_model_can_be_changed(run, tmp_path):
    model = copy.copy(run.model)
    before = model.rates.split
    model.rates.split *= 2
    assert model.rates.split == 2 * before and run.model.rates.split == before
    model.rates.birth *= 3
    assert np.allclose(model.rates.birth, 3 * run.model.rates.birth)
    with pytest.raises(ValueError, match="rates.split is -1"):
        model.rates.split = -1
    with pytest.raises(ValueError, match="rates.birth has the shape"):
        model.rates.birth = np.zeros((2, 2))
    new = model.synthesize(frames=10, seed=7)
    assert np.array_equal(new, model.synthesize(frames=10, seed=7, method="diffusion"))
    assert np.array_equal(new, pickle.loads(pickle.dumps(model)).synthesize(frames=10, seed=7))
    model.write(str(tmp_path / "model"))
    assert np.array_equal(new, ef.ClipModel.read(str(tmp_path / "model")).synthesize(frames=10, seed=7))
    played = copy.copy(run.model).synthesize(frames=10, seed=7)
    assert np.array_equal(played, run.model.synthesize(frames=10, seed=7, method="footage")) and not np.array_equal(played, new)
    assert run.model.synthesize(frames=10, method="texture").shape == new.shape
    assert new.shape == (10, 96, 128) and np.array_equal(new, model.synthesize(frames=10, seed=7))


def test_runs_are_values(run):
    again = pickle.loads(pickle.dumps(run))
    assert again == run and again.events.equals(run.events) and again.model == run.model
    assert np.array_equal(again.patches(7)["x"], run.patches(7)["x"])
    assert again.motion.to_jsonl() == run.motion.to_jsonl()
    rates = pickle.loads(pickle.dumps(run.model.rates))
    assert rates == run.model.rates == copy.deepcopy(rates)
    assert ef.MotionGraph.from_jsonl(run.motion.to_jsonl().decode()) == run.motion


def test_steps_give_what_analyze_gives():
    clip = bars(12)
    sketch = ef.sketch.sketch_clip(clip)
    motion = ef.graph.identify_curves(ef.graph.match(sketch))
    run = ef.analyze(clip, quality="draft", bottom_up=True)
    assert motion.to_jsonl() == run.motion.to_jsonl()
    assert ef.graph.events_json(ef.graph.stroke_events(motion)) == ef.graph.events_json(run._events)


def test_sketch_of_a_frame_draws_it_again():
    frame = bars(1)[0].astype(np.float32)
    sketch = ef.sketch.extract(frame, sensitivity=0.5)
    again = ef.sketch.reconstruct(frame, sketch)
    assert again.dtype == np.uint8 and np.corrcoef(again.ravel(), frame.ravel())[0, 1] > 0.8


def test_pictures(run):
    pytest.importorskip("matplotlib")
    assert "<table>" in run._repr_html_() and "image/png" in run._repr_html_() and "µm" in run.clip._repr_html_()
    for kind in ("events", "rates", "tracks"):
        assert run.plot(kind).axes
    assert run.show(3).axes and run.clip.show().axes
    with pytest.raises(ValueError, match="kind is 'pie'"):
        run.plot("pie")
