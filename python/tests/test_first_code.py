# SPDX-License-Identifier: Apache-2.0
"""The first code of docs/python.md runs as it is written, and so does the notebook."""
import re
import subprocess
import sys
import warnings
from pathlib import Path

import networkx as nx
import numpy as np
import pandas as pd
import pytest

from scenes import bars

ROOT = Path(__file__).parents[2]


def write_stack(path, frames):
    """A TIFF of several pages, 16 bits, as microscopes write them."""
    image = pytest.importorskip("PIL.Image")
    pages = [image.fromarray(frame) for frame in frames]
    pages[0].save(path, save_all=True, append_images=pages[1:])


def section():
    text = (ROOT / "docs/python.md").read_text()
    return re.search(r"```python\n(.*?)```", text, flags=re.S).group(1)


@pytest.fixture
def names(tmp_path, monkeypatch):
    """What the section leaves behind. Its clip is small to the eye but as large as the section's roi asks."""
    monkeypatch.chdir(tmp_path)
    frames = np.zeros((54, 290, 450), np.uint16)
    frames[:, 60:252, 150:406] = np.kron(bars(54), np.ones((1, 2, 2), np.uint8)).astype(np.uint16) << 4
    frames += np.random.default_rng(0).integers(0, 40, frames.shape, dtype=np.uint16)
    write_stack("clip.tif", frames)
    space = {}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        exec(section(), space)
    return space


def test_the_section_runs_as_written(names, tmp_path):
    run, ef = names["run"], names["ef"]
    assert names["clip"].shape == (54, 240, 320) and names["clip"].dtype == np.uint16
    assert isinstance(run.events, pd.DataFrame) and isinstance(run.genealogy(), nx.DiGraph)
    split = run.events.query("type == 'split'").iloc[0]  # the clip's one event, half way through it
    assert abs(split["frame"] - 27) <= 2 and split["t_s"] == split["frame"] / 30
    assert names["new"].shape == (300, 240, 320)
    assert (tmp_path / "run.geff/.zattrs").exists() and (tmp_path / "runs/a/events.json").exists()
    assert ef.ClipModel.read("runs/a/model").rates.split * 2 == run.model.rates.split


def test_the_notebook_runs(tmp_path):
    runner = ROOT / "python/tools/notebook.py"
    subprocess.run([sys.executable, runner, ROOT / "docs/tutorial.ipynb"], check=True, cwd=tmp_path)
