# SPDX-License-Identifier: Apache-2.0
"""The same bytes as the command."""
import json
import os
import re
import subprocess
import warnings

import numpy as np
import pandas as pd
import pytest

import emberfold as ef
from emberfold import _native
from scenes import bars, ripples

COMMAND = os.environ.get("EMBERFOLD_COMMAND")
pytestmark = pytest.mark.skipif(not COMMAND, reason="EMBERFOLD_COMMAND names no command")


def command(*words):
    subprocess.run([COMMAND, *map(str, words)], check=True, capture_output=True)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("command")
    ef.write_video(folder / "clip.avi", bars(colour=True), fps=30)
    return folder


def test_analyze(folder):
    command("analyze", folder / "clip.avi", "-o", folder / "run")
    for clip in (folder / "clip.avi", ef.open(bars(colour=True), fps=30)):
        run = ef.analyze(clip)
        for name, made in (("events.json", ef.graph.events_json(run._events)),
                           ("events_all.json", ef.graph.events_json(run._all_events)),
                           ("motion.jsonl", run.motion.to_jsonl()), ("strokes.csv", run.motion.strokes_csv(1 / 30))):
            assert (folder / "run" / name).read_bytes() == made, name
        run.model.write(str(folder / "model"))
        files = sorted(path.name for path in (folder / "run/model").iterdir())
        assert files == sorted(path.name for path in (folder / "model").iterdir())
        for name in files:
            assert (folder / "run/model" / name).read_bytes() == (folder / "model" / name).read_bytes(), name


def test_analyze_draft(folder):
    command("analyze", folder / "clip.avi", "-o", folder / "draft", "--quality", "draft")
    run = ef.analyze(folder / "clip.avi", quality="draft")
    assert (folder / "draft/events.json").read_bytes() == ef.graph.events_json(run._events)


def test_tables(folder):
    run = ef.read_run(folder / "run", folder / "clip.avi")
    for name, made in (("joints.csv", run.motion.joints_csv(1 / 30)), ("contacts.csv", _native.contacts_csv(run.motion, 1 / 30)),
                       ("lives.csv", _native.lives_csv(run.motion, 1 / 30)), ("curves.csv", run.motion.curves_csv(1 / 30))):
        assert (folder / "run" / name).read_bytes() == made, name
    assert run.named_events["contact"].tolist() == [
        "" if value == "" else value for value in np.loadtxt(folder / "run/named_events.csv", str, delimiter=",", skiprows=1, usecols=4, ndmin=1)]
    again = ef.analyze(folder / "clip.avi")
    assert run == again and run.events.equals(again.events)


def tree_of(folder):
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_exports(folder):
    command("export", folder / "run", "--geff", "--trackmate", "--graphml", "-o", folder / "other", "--overwrite")
    run = ef.read_run(folder / "run", folder / "clip.avi")
    run.to_geff(folder / "mine.geff")
    assert tree_of(folder / "mine.geff") == tree_of(folder / "other/run.geff")
    run.to_graphml(folder / "mine.graphml"), run.to_trackmate(folder / "mine.xml")
    assert len((folder / "mine.graphml").read_text()) and re.sub("filename=.*? ", "", (folder / "mine.xml").read_text()) == re.sub(
        "filename=.*? ", "", (folder / "other/trackmate.xml").read_text())


def test_compare(folder):
    ef.write_video(folder / "other.avi", bars(colour=True, seed=5)[:, ::-1], fps=30)
    command("compare", folder / "clip.avi", folder / "other.avi", "-o", folder / "compared")
    told = json.loads((folder / "compared/measures.json").read_text())["distances"]["other"]
    found = ef.compare(folder / "clip.avi", folder / "other.avi")
    for key, value in found.visible["value"].items():
        assert told["visible"][key] == pytest.approx(value, rel=1e-3, abs=1e-3), key
    for key, value in told.items():
        if isinstance(value, float) and key in found.distances:
            assert value == pytest.approx(found.distances[key], rel=1e-3, abs=1e-3), key


def test_quilt(folder):
    command("quilt", folder / "clip.avi", "-o", folder / "quilt", "--size", "180x120", "--block", "32x32", "--set", "quilt.overlap=8")
    _, places = ef.quilt(folder / "clip.avi", size=(180, 120), block=(32, 32), overlap=8, apart=16, return_map=True)
    assert np.array_equal(np.load(folder / "quilt/map.npy"), places)


def test_sketch(folder):
    command("sketch", folder / "clip.avi", "-o", folder / "sketched", "--range", "0:4")
    sketch = ef.sketch.sketch_clip(ef.open(folder / "clip.avi", frames=slice(0, 4)), sensitivity=0.5, outlines=True)
    lines = (folder / "sketched/sketch.jsonl").read_bytes().split(b"\n")
    assert [line.rstrip() for line in lines] == sketch.to_jsonl().split(b"\n")  # the command keeps place for any number of frames


def test_reading(folder):
    """What `ef.open` has of the command's options of reading."""
    mask = np.zeros((96, 128), np.uint8)
    mask[:48] = 255
    image = pytest.importorskip("PIL.Image")
    image.fromarray(mask).save(folder / "mask.png")
    command("analyze", folder / "clip.avi", "-o", folder / "masked", "--quality", "draft", "--mask", folder / "mask.png", "--grey",
            "--every", "2", "--pixel-size", "0.5um", "--stabilize", "translation")
    clip = ef.open(folder / "clip.avi", frames=slice(None, None, 2), mask=folder / "mask.png", grey=True, pixel_size=0.5,
                   stabilize="translation")
    run = ef.analyze(clip, quality="draft", out=folder / "mine")
    assert (folder / "masked/motion.jsonl").read_bytes() == run.motion.to_jsonl()
    assert (folder / "masked/strokes.csv").read_bytes() == run.motion.strokes_csv(1 / 15, 0.5)
    with pytest.raises(ValueError, match="no argument 'brightness'"):
        ef.open(folder / "clip.avi", brightness=2)
    with pytest.raises(ValueError, match="grey is for files"):
        ef.open(bars(4), grey=True)


def test_a_part_of_an_uneven_clip_counts_from_the_source(folder):
    """Times of frames and positions, of the command and of Python, also of runs that are read."""
    image = pytest.importorskip("PIL.Image")
    frames = [image.fromarray(frame) for frame in bars()]
    frames[0].save(folder / "uneven.gif", save_all=True, append_images=frames[1:], duration=[40] * 12 + [100] * 12)
    command("analyze", folder / "uneven.gif", "-o", folder / "part", "--quality", "draft", "--range", "4:", "--roi", "10,20,110,70",
            "--pixel-size", "2um", "--grey")
    where = {"frames": slice(4, None), "roi": (10, 20, 110, 70), "pixel_size": 2, "grey": True}
    clip = ef.open(folder / "uneven.gif", **where)
    run = ef.analyze(clip, quality="draft", out=folder / "part_here")
    table, events = pd.read_csv(folder / "part/events.csv"), run.events
    assert len(events) > 0 and (events["counted_from"] == "source").all()
    for theirs, mine in (("frame", "frame"), ("time_s", "t_s"), ("x", "x"), ("y_um", "y_um")):
        assert np.allclose(table[theirs], events[mine])
    split = events[events["type"].isin(["split", "disconnect"])].iloc[0]
    frame = split["frame"] + 4  # of the file
    assert abs(frame - 12) <= 1 and split["t_s"] == pytest.approx(0.04 * min(frame, 12) + 0.1 * max(0, frame - 12))
    assert abs(split["x"] - 65) < 8 and abs(split["y"] - 30) < 8
    assert (folder / "part/events.json").read_bytes() == (folder / "part_here/events.json").read_bytes()
    for kept in (folder / "part", folder / "part_here"):
        again = ef.read_run(kept)
        assert again.events.equals(events) and again.lives.equals(run.lives) and again.tips.equals(run.tips)
    own = ef.analyze(ef.open(folder / "uneven.gif", origin="part", **where), quality="draft")
    assert np.allclose(own.events["t_s"] + 0.16, events["t_s"]) and np.allclose(own.events["x"] + 10, events["x"])
    assert np.allclose(own.lives["life_s"], run.lives["life_s"])
    inner = ef.open(clip, frames=slice(8, None), roi=(1, 2, 50, 40))
    assert inner._data.origin == (11, 22, pytest.approx(0.48), "source") and inner.fps == pytest.approx(10)
    answers = events.assign(answer=False)
    assert len(ef.analyze(clip, quality="draft", review=answers).events) == 0


def test_export_geff(folder):
    """A GEFF as zarr reads it, held against what the format asks for."""
    import zarr

    command("export", folder / "run", "--geff", "-o", folder / "exported", "--overwrite")
    root = zarr.open_group(str(folder / "exported/run.geff"), mode="r")
    about = root.attrs["geff"]
    assert re.fullmatch(r"\d+\.\d+(\.\d+)?", about["geff_version"]) and about["directed"] is True
    nodes, edges = root["nodes/ids"][:], root["edges/ids"][:]
    assert nodes.ndim == 1 and edges.ndim == 2 and edges.shape[1] == 2
    assert nodes.dtype == edges.dtype and np.issubdtype(nodes.dtype, np.unsignedinteger)
    assert len(np.unique(nodes)) == len(nodes) and np.isin(edges, nodes).all()
    assert len(np.unique(edges, axis=0)) == len(edges) and (edges[:, 0] != edges[:, 1]).all()
    for part, ids in (("node", nodes), ("edge", edges)):
        told = about[part + "_props_metadata"]
        assert set(told) == set(root[part + "s/props"].group_keys())
        for name, prop in told.items():
            values = root[f"{part}s/props/{name}/values"][:]
            assert prop["identifier"] == name and values.dtype.name == prop["dtype"] and len(values) == len(ids)
    for axis in about["axes"]:
        values = root[f"nodes/props/{axis['name']}/values"][:]
        assert axis["type"] in ("time", "space", "channel") and isinstance(axis["unit"], str)
        assert axis["min"] == values.min() and axis["max"] == values.max()
    frame, stroke = root["nodes/props/frame/values"][:], root["nodes/props/stroke/values"][:]
    assert (frame[edges[:, 0]] < frame[edges[:, 1]]).all()
    run = ef.analyze(folder / "clip.avi")
    rows = run.strokes[run.strokes["stroke"] > 0]
    assert sorted(zip(frame, stroke)) == sorted(zip(rows["frame"], rows["stroke"]))


def test_synth(folder):
    if not (folder / "run").exists():
        pytest.skip("analyze failed")
    command("synth", folder / "run/model", "-o", folder / "new", "--frames", 20, "--seed", 7)
    new = ef.ClipModel.read(str(folder / "run/model")).synthesize(frames=20, seed=7)
    assert np.array_equal(np.asarray(ef.open(folder / "new")), new)


def test_edit(folder):
    command("synth", folder / "run/model", "-o", folder / "drawn", "--method", "diffusion", "--frames", 8, "--seed", 4,
            "--speed", "1.5", "--set", "synth.splits=3", "--wind", "1,0", "--contrast", "0.8")
    model = ef.read_run(folder / "run").model
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        edited = model.edit(speed=1.5, splits=3, wind=(1, 0), contrast=0.8, seed=4)
    drawn = np.asarray(ef.open(folder / "drawn"))
    assert np.array_equal(drawn, edited.synthesize(frames=8, seed=4))
    assert edited != model and edited.edit() == edited
    left = np.zeros((96, 128), bool)
    left[:, :40] = True
    assert (model.edit(birth_map=left, births=2).rates.birth[:, 4:] == 0).all()
    with pytest.raises(ValueError, match="no argument 'gusts'"):
        model.edit(gusts=2)
    with pytest.raises(ef.InputError, match="speed is 0"):
        model.edit(speed=0)


def test_dytex(folder):
    ef.write_video(folder / "ripples.avi", ripples(), fps=25)
    command("dytex", "learn", folder / "ripples.avi", "-o", folder / "texture", "--components", 6)
    command("dytex", "synth", folder / "texture", "-o", folder / "ripples_new", "--frames", 12, "--seed", 3)
    new = ef.dytex.learn(folder / "ripples.avi", components=6).synthesize(12, seed=3)
    assert np.array_equal(np.asarray(ef.open(folder / "ripples_new")), new)
