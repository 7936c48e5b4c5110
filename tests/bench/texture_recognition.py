#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""How well each distance knows a moving texture elsewhere: at another place of its scene, and in another scene.

usage: texture_recognition.py FOLDER [--block 48] [--side 320] [--frames 200] [--components 20] [--moving 0.1]

FOLDER/CLASS/CLIP as `emberfold dytex classify` reads it: videos, or folders of images. Frames are made grey and at most
`--side` px long. Two questions, the nearest neighbour answers both:

  elsewhere     which clip is this block of? Clips are cut into blocks of `--block` px and two pieces in time. Blocks that
                move less than `--moving` of their clip's most are left out. What is asked for lies in one half of the
                frame (along its longer side), what is known in the other half and in the other piece of time.
                Clips smaller than twice the block are left out.
  one block out what is asked for is one block, what is known are all others, of the same piece of time.
  other scene   of which class is this clip? All other clips are known; classes of one clip are left out.
                Distances that compare pixel by pixel see the middle of each clip, as large as the smallest clip.

Shares are means over clips. Beside the distances of emberfold: windows of the models instead of the clips', local
binary patterns (LBP-TOP, 8 neighbours at distance 1), histograms of the pixels' means and deviations in time.
Needs numpy and OpenCV (python3-numpy, python3-opencv on Debian) and the built package: PYTHONPATH=build/dev/python.
"""
import argparse
import sys
import time
import warnings
from pathlib import Path

try:
    import cv2
    import emberfold as ef
    import numpy as np
except ImportError as error:
    sys.exit(f"texture_recognition: not installed: {error.name} (python3-numpy, python3-opencv; PYTHONPATH=build/dev/python)")

VIDEOS = {".avi", ".mp4", ".mkv", ".mov", ".webm", ".mpg"}
IMAGES = {".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff"}


def frames_of(path):
    if path.is_dir():
        for file in sorted(path.iterdir()):
            if file.suffix.lower() in IMAGES:
                yield cv2.imread(str(file))
        return
    video = cv2.VideoCapture(str(path))
    while True:
        there, frame = video.read()
        if not there:
            return
        yield frame


def read(path, side, most):
    """The middle `most` frames, grey, T × H × W bytes."""
    frames = []
    for frame in frames_of(path):
        scale = side / max(frame.shape[:2])
        if scale < 1:
            size = (max(1, round(frame.shape[1] * scale)), max(1, round(frame.shape[0] * scale)))
            frame = cv2.resize(frame, size, interpolation=cv2.INTER_AREA)
        frames.append(cv2.cvtColor(frame, cv2.COLOR_BGR2GRAY))
    first = max(0, (len(frames) - most) // 2)
    return np.array(frames[first:first + most])


def list_clips(folder):
    found = []
    for place in sorted(path for path in folder.iterdir() if path.is_dir()):
        for path in sorted(place.iterdir()):
            if path.suffix.lower() in VIDEOS or (path.is_dir() and any(f.suffix.lower() in IMAGES for f in path.iterdir())):
                found.append((place.name, path))
    if not found:
        sys.exit(f"texture_recognition: {folder} holds no CLASS/CLIP")
    return found


def binary_patterns(clip):
    """Shares of the patterns on the planes xy, xt, yt, one after the other."""
    levels = clip.astype(np.int16)
    inner = levels[1:-1, 1:-1, 1:-1]
    ring = [(-1, -1), (-1, 0), (-1, 1), (0, 1), (1, 1), (1, 0), (1, -1), (0, -1)]
    shares = []
    for plane in ((1, 2), (0, 2), (0, 1)):
        code = np.zeros(inner.shape, np.int32)
        for bit, steps in enumerate(ring):
            by = [0, 0, 0]
            by[plane[0]], by[plane[1]] = steps
            beside = levels[tuple(slice(1 + d, n - 1 + d) for d, n in zip(by, levels.shape))]
            code |= (beside >= inner).astype(np.int32) << bit
        seen = np.bincount(code.ravel(), minlength=256)
        shares.append(seen / seen.sum())
    return np.concatenate(shares) / 3


def histograms(clip):
    means = np.histogram(clip.mean(0), 32, (0, 256))[0]
    deviations = np.histogram(np.log2(clip.std(0) + 0.5), 32, (-1, 7))[0]
    return np.concatenate([means / means.sum(), deviations / deviations.sum()]) / 2


def chi_square(rows):
    rows = np.array(rows)
    result = np.zeros((len(rows), len(rows)))
    for i, row in enumerate(rows):
        both = rows + row
        result[i] = 0.5 * np.divide((rows - row) ** 2, both, out=np.zeros_like(both), where=both > 0).sum(1)
    return result


def apart(descriptions):
    """Windows' distances; infinite where there is no description."""
    result = np.full((len(descriptions),) * 2, np.inf)
    for i, a in enumerate(descriptions):
        for j, b in enumerate(descriptions):
            if a is not None and b is not None:
                result[i, j] = ef.dytex.window_distance(a, b)
    return result


def all_distances(samples, middles, components):
    """Square matrices by name. `middles`: the samples, all of one size."""
    began = time.process_time()
    matrices = {"windows": apart([ef.dytex.window_spectrum(sample) for sample in samples])}
    seconds = time.process_time() - began
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of fits that are not stable, one for each model
        models = [ef.dytex.learn(clip, components=min(components, len(clip) - 2)) for clip in middles]
    for name, matrix in ef.dytex.distance_matrices(models).items():
        matrices["windows of models" if name == "windows" else name] = np.nan_to_num(matrix, nan=np.inf)
    matrices["kl"] = matrices["kl"] + matrices["kl"].T
    matrices["LBP-TOP"] = chi_square([binary_patterns(sample) for sample in samples])
    matrices["mean, variance"] = chi_square([histograms(sample) for sample in samples])
    return matrices, seconds


def cut_blocks(clip, block, moving):
    """(row, column, piece, block) of those that move, and which row and column lie in the first half."""
    variance = clip.var(0)
    down, across = (n // block for n in clip.shape[1:])
    corner = ((clip.shape[1] - down * block) // 2, (clip.shape[2] - across * block) // 2)
    places = {}
    for row in range(down):
        for column in range(across):
            y, x = corner[0] + row * block, corner[1] + column * block
            places[row, column] = (slice(y, y + block), slice(x, x + block))
    strength = {place: variance[cut].mean() for place, cut in places.items()}
    kept = [place for place in places if strength[place] >= moving * max(strength.values())]
    if len(kept) < 2:
        return [], set()
    spread = [max(p[i] for p in kept) - min(p[i] for p in kept) for i in (0, 1)]
    along = 1 if spread[1] >= spread[0] else 0
    kept.sort(key=lambda place: (place[along], place[1 - along]))
    half = len(clip) // 2
    blocks = [(*place, piece, clip[half * piece:half * (piece + 1), places[place][0], places[place][1]]) for place in kept for piece in (0, 1)]
    return blocks, set(kept[:len(kept) // 2])


def share(right, of):
    """The mean over `of` of the share of hits, and the shares."""
    shares = {name: float(np.mean([hit for hit, owner in zip(right, of) if owner == name])) for name in dict.fromkeys(of)}
    return float(np.mean(list(shares.values()))), shares


def nearest(matrix, known):
    """For each sample whether any is known, and the nearest of those that are."""
    hidden = np.where(known, matrix, np.inf)
    return hidden.argmin(1), np.isfinite(hidden.min(1))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--block", type=int, default=48)
    parser.add_argument("--side", type=int, default=320)
    parser.add_argument("--frames", type=int, default=200)
    parser.add_argument("--components", type=int, default=20)
    parser.add_argument("--moving", type=float, default=0.1)
    parser.add_argument("--each", action="store_true", help="tell the share of each clip, too")
    asked = parser.parse_args()

    clips = [(label, f"{label}/{path.stem}", read(path, asked.side, asked.frames)) for label, path in list_clips(asked.folder)]
    columns, each = {}, {}

    def tell(question, name, value, shares):
        columns.setdefault(name, {})[question] = value
        each[question, name] = shares

    samples, owners, place, piece, first = [], [], [], [], []
    for label, name, clip in clips:
        if min(clip.shape[1:]) < 2 * asked.block:
            continue
        blocks, half = cut_blocks(clip, asked.block, asked.moving)
        for row, column, part, block in blocks:
            samples.append(block), owners.append(name), place.append((row, column)), piece.append(part)
            first.append((row, column) in half)
    owners, piece, first = np.array(owners), np.array(piece), np.array(first)
    same_place = np.array([[a == b and m == n for b, n in zip(place, owners)] for a, m in zip(place, owners)])
    print(f"elsewhere: {len(samples)} blocks of {len(set(owners))} clips; other scene: ", end="")
    if samples:
        length = min(len(sample) for sample in samples)
        matrices, seconds = all_distances(samples, [sample[:length] for sample in samples], asked.components)
        for name, matrix in matrices.items():
            elsewhere, there = nearest(matrix, (first[:, None] != first[None]) & (piece[:, None] != piece[None]))
            tell("elsewhere", name, *share((owners[elsewhere] == owners) & there, owners))
            others, there = nearest(matrix, ~same_place & (piece[:, None] == piece[None]))
            tell("one block out", name, *share((owners[others] == owners) & there, owners))

    labels = [label for label, _, _ in clips]
    several = [clip for clip in clips if labels.count(clip[0]) > 1]
    known = sorted({label for label, _, _ in several})
    print(f"{len(several)} clips of {len(known)} classes")
    if len(known) > 1:
        low = [min(clip.shape[axis] for _, _, clip in several) for axis in range(3)]
        middles = [clip[tuple(slice((n - m) // 2, (n - m) // 2 + m) for n, m in zip(clip.shape, low))] for _, _, clip in several]
        matrices, seconds = all_distances([clip for _, _, clip in several], middles, asked.components)
        label, names = np.array([label for label, _, _ in several]), [name for _, name, _ in several]
        for name, matrix in matrices.items():
            other, there = nearest(matrix, ~np.eye(len(several), dtype=bool))
            tell("other scene", name, *share((label[other] == label) & there, names))
        print(f"windows: {seconds:.2f} s of CPU time for {sum(clip.size for _, _, clip in several) / 1e6:.1f} million pixels")

    questions = [q for q in ("elsewhere", "one block out", "other scene") if any(q in row for row in columns.values())]
    print(" " * 20 + "".join(f"{q:>16}" for q in questions))
    for name, row in columns.items():
        print(f"{name:20}" + "".join(f"{row[q]:16.2f}" if q in row else f"{'-':>16}" for q in questions))
    if asked.each:
        for question in questions:
            print(f"{question}, windows: " + ", ".join(f"{n} {s:.2f}" for n, s in each[question, "windows"].items()))


if __name__ == "__main__":
    main()
