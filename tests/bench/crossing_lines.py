#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Do lines keep their names where they touch and cross?   crossing_lines.py EMBERFOLD OUT [SEED …]

Draws fourteen lines that drift, turn and cross in noise, 40 frames of 480 × 360 px a seed (default 1 2 3), analyses them
bottom-up, and tells for strokes and curves how often the name that most patches within 4 px of a line have is that of the
frame before, and in how many lines that of the last frame is that of the first. Needs NumPy, SciPy and OpenCV."""
import collections, json, subprocess, sys
from pathlib import Path
import cv2
import numpy as np
from scipy.spatial import cKDTree

WIDTH, HEIGHT, FRAMES, LINES = 480, 360, 40, 14


def scene(seed, folder):
    """Draws the frames; returns the points of each line in each of them."""
    folder.mkdir(parents=True, exist_ok=True)
    rng = np.random.default_rng(seed)
    lines = [(rng.uniform(70, 150), rng.uniform(0, np.pi), np.array([rng.uniform(80, WIDTH - 80), rng.uniform(80, HEIGHT - 80)]),
              rng.uniform(-2, 2, 2), rng.uniform(-.01, .01), rng.uniform(-.004, .004), rng.uniform(60, 120)) for _ in range(LINES)]
    truth = []
    for t in range(FRAMES):
        image, row = np.full((HEIGHT, WIDTH), 60.0), []
        for length, angle, middle, velocity, spin, bend, contrast in lines:
            s = np.arange(-length / 2, length / 2 + .1)[:, None]
            along = np.array([np.cos(angle + spin * t), np.sin(angle + spin * t)])
            points = middle + velocity * (t - FRAMES / 2) + s * along + bend * s ** 2 * np.array([-along[1], along[0]])
            drawn = np.zeros((HEIGHT * 4, WIDTH * 4), np.uint8)
            cv2.polylines(drawn, [np.round((points + .5) * 4 - .5).astype(np.int32)], False, 255, 12)
            small = cv2.resize(drawn, (WIDTH, HEIGHT), interpolation=cv2.INTER_AREA) / 255.0
            image = np.maximum(image, 60 + contrast * cv2.GaussianBlur(small, (0, 0), 1.0))
            row.append(points)
        image += rng.normal(0, 3, image.shape)
        cv2.imwrite(str(folder / f"{t:03d}.png"), np.clip(image, 0, 255).astype(np.uint8))
        truth.append(row)
    return truth


def kept(truth, motion, key):
    names = []
    for row, text in zip(truth, motion.read_text().splitlines()[1:]):
        vertices = json.loads(text)["vertices"]
        near = cKDTree([[v["x"], v["y"]] for v in vertices])
        names.append([])
        for points in row:
            apart, index = near.query(points)
            seen = collections.Counter(vertices[i][key] for i, d in zip(index, apart) if d <= 4)
            names[-1].append(seen.most_common(1)[0][0] if seen else -1)
    names = np.array(names)
    there = names[1:] >= 0
    return np.mean((names[1:] == names[:-1]) & there), np.mean((names[0] == names[-1]) & (names[0] >= 0))


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    program, out, seeds = sys.argv[1], Path(sys.argv[2]), [int(s) for s in sys.argv[3:]] or [1, 2, 3]
    figures = {"subgraph": [], "curve": []}
    for seed in seeds:
        truth = scene(seed, out / f"frames_{seed}")
        run = out / f"run_{seed}"
        subprocess.run([program, "analyze", out / f"frames_{seed}", "-o", run, "--bottom-up", "--no-edges", "--fps", "25",
                        "--overwrite", "-q"], check=True)
        for key, rows in figures.items():
            rows.append(kept(truth, run / "motion.jsonl", key))
    for key, rows in figures.items():
        frame, clip = np.mean(rows, axis=0)
        print(f"{'strokes' if key == 'subgraph' else 'curves':8} frame to frame {frame:.3f}, first to last {clip:.3f}")


main()
