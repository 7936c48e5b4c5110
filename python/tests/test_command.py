# SPDX-License-Identifier: Apache-2.0
"""The same bytes as the command."""
import os
import re
import subprocess

import numpy as np
import pytest

import emberfold as ef
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


def test_dytex(folder):
    ef.write_video(folder / "ripples.avi", ripples(), fps=25)
    command("dytex", "learn", folder / "ripples.avi", "-o", folder / "texture", "--components", 6)
    command("dytex", "synth", folder / "texture", "-o", folder / "ripples_new", "--frames", 12, "--seed", 3)
    new = ef.dytex.learn(folder / "ripples.avi", components=6).synthesize(12, seed=3)
    assert np.array_equal(np.asarray(ef.open(folder / "ripples_new")), new)
