#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Sketches a picture in one piece and in tiles, and tells how much of either's curves the other has within 1 px.

    tiles_against_whole.py PICTURE [--tile 1024]

Tells time and peak memory of sketching, too. Needs emberfold's Python package, python3-numpy and python3-scipy.
"""
import argparse
import json
import subprocess
import sys

import numpy as np
from scipy.spatial import cKDTree

SKETCH = """
import resource, sys, time
import emberfold as ef
frame = next(iter(ef.open(sys.argv[1], grey=True))).astype("float32")
begun = time.monotonic()
made = ef.sketch.extract(frame, tile=int(sys.argv[2]))
peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
print(f"{time.monotonic() - begun:.1f} s, {peak:.0f} MB", file=sys.stderr, end="", flush=True)
sys.stdout.buffer.write(made.to_jsonl())
"""


def sketch(picture, tile):
    print(f"tile {tile:6d}: ", end="", flush=True)
    made = subprocess.run([sys.executable, "-c", SKETCH, picture, str(tile)], check=True, stdout=subprocess.PIPE)
    frame = json.loads(made.stdout.splitlines()[1])
    at = {v["id"]: (v["x"], v["y"]) for v in frame["vertices"]}
    print(f", {len(at)} patches")
    return np.array([at[a] + at[b] for a, b in frame["edges"]])


def places(ends):
    """Places every half pixel along the edges, and the length that each stands for."""
    length = np.hypot(ends[:, 2] - ends[:, 0], ends[:, 3] - ends[:, 1])
    count = np.maximum(1, np.ceil(2 * length)).astype(int)
    edge = np.repeat(np.arange(len(ends)), count)
    share = np.concatenate([(np.arange(n) + 0.5) / n for n in count])[:, None]
    return ends[edge, :2] * (1 - share) + ends[edge, 2:] * share, np.repeat(length / count, count)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("picture")
    parser.add_argument("--tile", type=int, default=1024)
    given = parser.parse_args()
    whole, tiled = (places(sketch(given.picture, tile)) for tile in (16384, given.tile))
    for name, (a, length), (b, _) in (("of the whole's", whole, tiled), ("of the tiles'", tiled, whole)):
        distance, _ = cKDTree(b).query(a)
        print(f"{name} curves the other has within 1 px: {length[distance <= 1].sum() / length.sum():.4f}")


if __name__ == "__main__":
    main()
