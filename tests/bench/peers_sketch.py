#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""What others make of the frames that sketch_figures works on: quality and time beside ours.

usage: peers_sketch.py PROGRAM --clips DIR --scenes DIR

PROGRAM is the built sketch_figures. Centre lines: the Sato ridge filter and skeletonize (scikit-image), Canny's
edges, scored by the rule of sketch_figures, which this file states a second time. Reconstruction: the pixels
that our sketch holds, filled by OpenCV's two inpainters and by a sparse direct solve (scipy) of Laplace's
equation; and Canny bands and random pixels of the same share. Needs numpy, scipy, OpenCV and scikit-image.
Times are CPU time on one thread, milliseconds for a frame.
"""
import os

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[variable] = "1"

import argparse
import collections
import csv
import importlib
import json
import pathlib
import subprocess
import sys
import tempfile
import time

NEEDED = dict(numpy="numpy", scipy="scipy", cv2="OpenCV", skimage="scikit-image")


def check_modules():
    missing = []
    for module, name in NEEDED.items():
        try:
            importlib.import_module(module)
        except ImportError:
            missing.append(name)
    if missing:
        names = "python3-numpy, -scipy, -opencv, -skimage"
        sys.exit(f"peers_sketch: not installed: {', '.join(missing)} (on Debian: {names})")


check_modules()
import cv2
import numpy as np
import scipy.sparse
import scipy.sparse.linalg
from scipy.spatial import cKDTree
from skimage.filters import sato
from skimage.morphology import remove_small_objects, skeletonize

ACROSS = 1.5  # px, within which length counts as found
JUNCTION = 3.0  # px, likewise junctions
SHORTEST = 12  # px: smaller skeletons are left out, as ours are


def timed(work, *arguments):
    """The result, and CPU milliseconds."""
    begin = time.process_time()
    result = work(*arguments)
    return result, 1000 * (time.process_time() - begin)


# Scoring of centre lines: segments are arrays (n, 4) of ax, ay, bx, by.


def samples(segments, step=0.5):
    """Middles of equal parts of at most `step` px, (n, 2), and the length that each stands for."""
    a, b = segments[:, :2], segments[:, 2:]
    length = np.hypot(*(b - a).T)
    parts = np.maximum(1, np.ceil(length / step).astype(int))
    which = np.repeat(np.arange(len(segments)), parts)
    first = np.repeat(np.cumsum(parts) - parts, parts)
    t = (np.arange(len(which)) - first + 0.5) / parts[which]
    return a[which] + (b - a)[which] * t[:, None], (length / parts)[which]


def near(points, segments, reach):
    """Whether each point has one of the segments within `reach`, to 0.001 px."""
    if not len(segments):
        return np.zeros(len(points), bool)
    dense = np.vstack([samples(segments, 0.1)[0], segments[:, :2], segments[:, 2:]])
    return np.isfinite(cKDTree(dense).query(points, distance_upper_bound=reach)[0])


def behind_ends(points, ends, reach):
    """Whether each point lies up to 2 sigma behind one of the ends: rows x, y, direction outwards, sigma."""
    off = points[:, None] - ends[None, :, :2]
    along = (off * ends[None, :, 2:4]).sum(2)
    across = off[..., 1] * ends[None, :, 2] - off[..., 0] * ends[None, :, 3]
    return ((along >= 0) & (along <= 2 * ends[None, :, 4]) & (np.abs(across) <= reach)).any(1)


def paired(found, truth):
    """How many pair off one to one within JUNCTION, nearest first."""
    if not len(found) or not len(truth):
        return 0
    gaps = np.hypot(*(found[:, None] - truth[None]).transpose(2, 0, 1))
    taken_found, taken_truth = set(), set()
    for i, j in zip(*np.unravel_index(np.argsort(gaps, axis=None), gaps.shape)):
        if gaps[i, j] > JUNCTION:
            break
        if i not in taken_found and j not in taken_truth:
            taken_found.add(i)
            taken_truth.add(j)
    return len(taken_found)


class Score:
    """Length and junctions, summed over frames."""

    def __init__(self):
        self.sums = np.zeros(8)
        self.milliseconds = []

    def add(self, frame, segments, junctions):
        points, length = samples(frame.truth)
        inside = ((points >= 0) & (points <= np.array(frame.pixels.shape[::-1]) - 1)).all(1)
        points, length = points[inside], length[inside]
        self.sums[0] += length[near(points, segments, ACROSS)].sum()
        self.sums[1] += length.sum()
        if len(segments):
            points, length = samples(segments)
            hit = near(points, frame.truth, ACROSS)
            counts = hit | ~behind_ends(points, frame.ends, ACROSS)
            self.sums[2] += length[hit].sum()
            self.sums[3] += length[counts].sum()
        pairs = paired(junctions, frame.junctions)
        self.sums[4:] += pairs, len(frame.junctions), pairs, len(junctions)

    def figures(self):
        """Curve recall and precision, junction recall and precision."""
        return self.sums[0::2] / np.maximum(self.sums[1::2], 1e-9)


SceneFrame = collections.namedtuple("SceneFrame", "scene number pixels truth ends junctions")


def read_scene(folder):
    """The frames 0, 5, 10 … that sketch_figures takes."""
    truth = json.loads((folder / "truth.json").read_text())
    video = cv2.VideoCapture(str(folder / "clip.avi"))
    frames = []
    for number in range(truth["frames"]):
        pixels = video.read()[1]
        if number % 5:
            continue
        segments, ends = [], []
        for stroke in truth["strokes"][number]:
            p = np.array(stroke["points"])
            segments.append(np.hstack([p[:-1], p[1:]]))
            for end, before in ((p[0], p[1]), (p[-1], p[-2])):
                out = (end - before) / max(np.hypot(*(end - before)), 1e-9)
                ends.append([*end, *out, stroke["sigma"]])
        junctions = np.array(truth["junctions"][number]).reshape(-1, 2)
        grey = cv2.cvtColor(pixels, cv2.COLOR_BGR2GRAY)
        frames.append(SceneFrame(folder.name, number, grey, np.vstack(segments), np.array(ends), junctions))
    return frames


# Peers that find curves.


def skeleton_graph(skeleton):
    """Links between 8-neighbours as segments, no diagonal where a corner joins them; and where three or more meet."""
    s = np.pad(skeleton, 1)
    segments = []
    for dx, dy in ((1, 0), (0, 1), (1, 1), (-1, 1)):
        linked = s & np.roll(s, (-dy, -dx), (0, 1))
        if dx and dy:
            linked &= ~(np.roll(s, -dx, 1) | np.roll(s, -dy, 0))
        y, x = np.nonzero(linked)
        segments.append(np.stack([x - 1, y - 1, x - 1 + dx, y - 1 + dy], 1))
    neighbours = cv2.filter2D(s.astype(np.uint8), -1, np.ones((3, 3), np.uint8), borderType=cv2.BORDER_CONSTANT) - s
    _, _, _, centres = cv2.connectedComponentsWithStats(((neighbours >= 3) & s).astype(np.uint8))
    return np.vstack(segments).astype(float), centres[1:] - 1


def sato_response(pixels):
    """Of ridges and of valleys."""
    levels = pixels.astype(np.float32)
    return [sato(levels, sigmas=(1, 2, 3), black_ridges=dark, mode="reflect") for dark in (False, True)]


def sato_skeleton(responses, threshold):
    parts = [skeletonize(response > threshold) for response in responses]
    kept = [remove_small_objects(part, SHORTEST, connectivity=2) for part in parts]
    graphs = [skeleton_graph(part) for part in kept]
    return np.vstack([g[0] for g in graphs]), np.vstack([g[1] for g in graphs])


def canny_lines(pixels, threshold):
    edges = cv2.Canny(cv2.GaussianBlur(pixels, None, 1), 0.4 * threshold, threshold, L2gradient=True) > 0
    return skeleton_graph(remove_small_objects(skeletonize(edges), SHORTEST, connectivity=2))


def f1(score):
    recall, precision = score.figures()[:2]
    return 2 * recall * precision / max(recall + precision, 1e-9)


def best_of(frames, thresholds, first, second):
    """The score at the threshold that serves these frames best; `first` does not depend on it."""
    scores = {t: Score() for t in thresholds}
    for frame in frames:
        prepared, milliseconds = timed(first, frame.pixels)
        for threshold, score in scores.items():
            (segments, junctions), more = timed(second, prepared, threshold)
            score.add(frame, segments, junctions)
            score.milliseconds.append(milliseconds + more)
    return max(scores.items(), key=lambda item: f1(item[1]))


def read_table(path):
    with open(path) as file:
        return list(csv.DictReader(file))


def our_score(frames, folder):
    curves, junctions = collections.defaultdict(list), collections.defaultdict(list)
    for row in read_table(folder / "scene_curves.csv"):
        curves[row["scene"], int(row["frame"])].append([float(row[k]) for k in ("ax", "ay", "bx", "by")])
    for row in read_table(folder / "scene_junctions.csv"):
        junctions[row["scene"], int(row["frame"])].append([float(row[k]) for k in ("x", "y")])
    score = Score()
    for frame in frames:
        key = frame.scene, frame.number
        score.add(frame, np.array(curves[key]).reshape(-1, 4), np.array(junctions[key]).reshape(-1, 2))
    return score


def print_scenes(frames, folder):
    print(f"\nCentre lines of {len(frames)} scene frames; thresholds are those that serve these frames best")
    print(f"{'method':44s} recall precision | junctions: recall precision |    ms")

    def line(name, score):
        r, p, jr, jp = score.figures()
        spent = f"{np.mean(score.milliseconds):5.1f}" if score.milliseconds else "    -"
        print(f"{name:44s} {r:6.3f} {p:9.3f} | {jr:17.3f} {jp:9.3f} | {spent}", flush=True)

    line("emberfold sketch (time: sketch_figures)", our_score(frames, folder))
    threshold, score = best_of(frames, (3, 4, 6, 8, 11, 15), sato_response, sato_skeleton)
    line(f"sato 1 2 3 px > {threshold} + skeletonize", score)
    threshold, score = best_of(frames, (60, 100, 150, 200, 300), lambda pixels: pixels, canny_lines)
    line(f"Canny {0.4 * threshold:.0f} {threshold} (edges, not centres)", score)


# Peers that fill.


def psnr(frame, levels):
    return 20 * np.log10(255 / np.sqrt(np.mean((frame.astype(float) - levels) ** 2)))


def solve_directly(frame, mask):
    """Laplace's equation, 5-point stencil, insulated border, the mask's pixels held."""
    height, width = frame.shape
    unknown = mask == 0
    number = np.full(frame.shape, -1)
    number[unknown] = np.arange(unknown.sum())
    rows, columns, entries = [], [], []
    right = np.zeros(unknown.sum())
    degree = np.zeros(unknown.sum())
    for dy, dx in ((0, 1), (0, -1), (1, 0), (-1, 0)):
        y, x = np.nonzero(unknown)
        inside = (y + dy >= 0) & (y + dy < height) & (x + dx >= 0) & (x + dx < width)
        y, x = y[inside], x[inside]
        here, there = number[y, x], number[y + dy, x + dx]
        degree[here] += 1
        free = there >= 0
        rows.append(here[free])
        columns.append(there[free])
        entries.append(np.full(free.sum(), -1.0))
        np.add.at(right, here[~free], frame[y + dy, x + dx][~free].astype(float))
    diagonal = np.arange(len(degree))
    matrix = scipy.sparse.csc_matrix(
        (np.concatenate([*entries, degree]), (np.concatenate([*rows, diagonal]), np.concatenate([*columns, diagonal])))
    )
    result = frame.astype(float)
    result[unknown] = scipy.sparse.linalg.spsolve(matrix, right)
    return result


def canny_band(frame, share):
    """Three pixels thick, thresholds such that it covers as nearly this share as can be."""
    smooth = cv2.GaussianBlur(frame, None, 1)
    low, high, best = 0.0, 2000.0, None
    for _ in range(30):
        threshold = (low + high) / 2
        band = cv2.dilate(cv2.Canny(smooth, 0.4 * threshold, threshold, L2gradient=True), np.ones((3, 3)))
        covered = np.mean(band > 0)
        if best is None or abs(covered - share) < abs(np.mean(best > 0) - share):
            best = band
        if covered > share:
            low = threshold
        else:
            high = threshold
    return best


def random_mask(frame, share):
    mask = np.zeros(frame.size, np.uint8)
    mask[np.random.default_rng(1).permutation(frame.size)[: round(share * frame.size)]] = 255
    return mask.reshape(frame.shape)


def print_fills(folder):
    rows = read_table(folder / "frames.csv")
    results = collections.defaultdict(list)
    for row in rows:
        frame = cv2.imread(str(folder / f"{row['frame']}.png"), cv2.IMREAD_GRAYSCALE)
        mask = cv2.imread(str(folder / f"{row['frame']}_mask.png"), cv2.IMREAD_GRAYSCALE)
        share = float(row["share"])
        results["emberfold: pixels, sketch::fill"].append((float(row["pixels_db"]), float(row["fill_ms"])))
        results["emberfold: fitted, sketch::fill"].append((float(row["fitted_db"]), float(row["fill_ms"])))
        filled, spent = timed(solve_directly, frame, mask)
        results["the same pixels, scipy spsolve"].append((psnr(frame, filled), spent))
        for name, method in (("Telea", cv2.INPAINT_TELEA), ("Navier-Stokes", cv2.INPAINT_NS)):
            filled, spent = timed(cv2.inpaint, frame, np.uint8(mask == 0), 3, method)
            results[f"the same pixels, cv2.inpaint {name}"].append((psnr(frame, filled), spent))
        for name, other in (("Canny band", canny_band(frame, share)), ("random pixels", random_mask(frame, share))):
            filled, spent = timed(solve_directly, frame, other)
            results[f"{name} of the same share, spsolve"].append((psnr(frame, filled), spent))
    mean_share = np.mean([float(row["share"]) for row in rows])
    sketching = np.mean([float(row["sketch_ms"]) for row in rows])
    print(f"\n{len(rows)} frames of clips from {100 * mean_share:.1f} % of their pixels")
    print(f"(finding the sketch: {sketching:.1f} ms)")
    print(f"{'method':44s}     dB | fill, ms")
    for name, figures in results.items():
        decibels, milliseconds = np.mean(figures, axis=0)
        print(f"{name:44s} {decibels:6.2f} | {milliseconds:8.1f}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--clips", default=os.environ.get("EMBERFOLD_CLIPS"))
    parser.add_argument("--scenes", default=os.environ.get("EMBERFOLD_SCENES"))
    options = parser.parse_args()
    if not options.clips or not options.scenes:
        sys.exit("peers_sketch: needs --clips and --scenes (or EMBERFOLD_CLIPS, EMBERFOLD_SCENES)")
    cv2.setNumThreads(1)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        command = [options.program, "--only", "scenes", "--only", "reconstruction", "--dump", name]
        command += ["--clips", options.clips, "--scenes", options.scenes]
        done = subprocess.run(command, capture_output=True, text=True)
        skipped = [line for line in done.stdout.splitlines() if "skipped" in line]
        if done.returncode or skipped:
            sys.exit("peers_sketch: " + (skipped[0] if skipped else done.stderr.strip()))
        folders = sorted(path.parent for path in pathlib.Path(options.scenes).glob("*/truth.json"))
        print_scenes([frame for scene in folders for frame in read_scene(scene)], folder)
        print_fills(folder)


if __name__ == "__main__":
    main()
