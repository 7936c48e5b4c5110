#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Sketches a picture in one piece and in tiles, and tells how much of either's curves the other has within 1 px.

    tiles_against_whole.py PROGRAM PICTURE [--tile 1024]

PROGRAM is emberfold. Tells time and peak memory of the whole command, too. Needs python3-numpy and python3-scipy.
"""
import argparse
import json
import os
import subprocess
import tempfile

import numpy as np
from scipy.spatial import cKDTree


def sketch(program, picture, tile, folder):
    out = os.path.join(folder, str(tile))
    subprocess.run([program, "sketch", picture, "-o", out, "--grey", "-q", "--set", f"sketch.tile={tile}"], check=True,
                   stdout=subprocess.DEVNULL)
    with open(os.path.join(out, "summary.json")) as text:
        summary = json.load(text)
    with open(os.path.join(out, "sketch.jsonl")) as lines:
        frame = json.loads(lines.read().splitlines()[1])
    at = {v["id"]: (v["x"], v["y"]) for v in frame["vertices"]}
    ends = np.array([at[a] + at[b] for a, b in frame["edges"]])
    print(f"tile {tile:6d}: {summary['seconds']['total']:.1f} s, {summary['peak_memory_mb']:.0f} MB, {len(at)} patches")
    return ends


def places(ends):
    """Places every half pixel along the edges, and the length that each stands for."""
    length = np.hypot(ends[:, 2] - ends[:, 0], ends[:, 3] - ends[:, 1])
    count = np.maximum(1, np.ceil(2 * length)).astype(int)
    edge = np.repeat(np.arange(len(ends)), count)
    share = np.concatenate([(np.arange(n) + 0.5) / n for n in count])[:, None]
    return ends[edge, :2] * (1 - share) + ends[edge, 2:] * share, np.repeat(length / count, count)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("picture")
    parser.add_argument("--tile", type=int, default=1024)
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        whole, tiled = (places(sketch(given.program, given.picture, tile, folder)) for tile in (16384, given.tile))
    for name, (a, length), (b, _) in (("of the whole's", whole, tiled), ("of the tiles'", tiled, whole)):
        distance, _ = cKDTree(b).query(a)
        print(f"{name} curves the other has within 1 px: {length[distance <= 1].sum() / length.sum():.4f}")


if __name__ == "__main__":
    main()
