# SPDX-License-Identifier: Apache-2.0
"""The same bytes as the command."""
import os
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
