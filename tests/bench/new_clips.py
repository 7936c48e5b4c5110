#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How near new clips come to what a person sees in their source: python3 tests/bench/new_clips.py BINARY [--whole] CLIP …

Models are learned from the first half of each clip, of at most 100 frames and 320 px across, and draw as many frames as the
clip has. Against the clip, where it moves (SD over time above 8 levels), at half size:
complete    patches of 3 frames and 7×7 px of the second half: mean distance to the nearest one of the new clip over that to
            the nearest of the first half, in 16 principal components; 1 as the first half itself
flow        95th percentile of optical flow, share of the clip's; difference: mean |frame − next|; variance: over time
copied      share of moving pixels within 2 levels of those of one frame of the clip, mean over frames
With --whole the model learns from all frames, and only the new clip of footage is drawn.
Peers: the linear dynamic texture of the same half, and the half played in a loop from its best jump (video texture).
Needs NumPy, SciPy and OpenCV."""
import subprocess
import sys
import tempfile
from pathlib import Path

import cv2
import numpy as np
from scipy.spatial import cKDTree

MOST, WIDTH = 100, 320
DIS = cv2.DISOpticalFlow_create(cv2.DISOPTICAL_FLOW_PRESET_FAST)


def read(path, most=MOST):
    capture, frames = cv2.VideoCapture(str(path)), []
    while len(frames) < most:
        ok, frame = capture.read()
        if not ok:
            break
        height = round(frame.shape[0] * WIDTH / frame.shape[1] / 2) * 2
        if frame.shape[1] != WIDTH:
            frame = cv2.resize(frame, (WIDTH, height), interpolation=cv2.INTER_AREA)
        frames.append(frame)
    return frames, capture.get(cv2.CAP_PROP_FPS) or 25


def write(path, frames, fps):
    out = cv2.VideoWriter(str(path), cv2.VideoWriter_fourcc(*"FFV1"), fps, frames[0].shape[1::-1])
    for frame in frames:
        out.write(frame)


def small(frames):
    grey = [cv2.cvtColor(frame, cv2.COLOR_BGR2GRAY) for frame in frames]
    return np.array([cv2.resize(g, None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA) for g in grey]).astype(np.float32)


def patches(clip, where, count, seed, first, last):
    rng = np.random.default_rng(seed)
    ys, xs = np.nonzero(where[3:-4, 3:-4])
    i, t = rng.integers(0, len(ys), count), rng.integers(first + 1, last - 1, count)
    return np.stack([clip[t[k] - 1:t[k] + 2, ys[i[k]]:ys[i[k]] + 7, xs[i[k]]:xs[i[k]] + 7].ravel() for k in range(count)])


def flow(clip, where):
    speeds = [np.hypot(*np.moveaxis(DIS.calc(a.astype(np.uint8), b.astype(np.uint8), None), 2, 0))[where]
              for a, b in zip(clip, clip[1:])]
    return np.percentile(np.concatenate(speeds), 95)


def copied(clip, source, where):
    moving = source[:, where]
    return np.mean([max(np.mean(np.abs(frame[where] - one) <= 2) for one in moving) for frame in clip[::5]])


def loop(frames, count):
    """The run of frames whose end is likest to its beginning, at least a third of the clip, again and again."""
    levels = small(frames).reshape(len(frames), -1)
    apart = np.sqrt(((levels[:, None, ::7] - levels[None, :, ::7]) ** 2).mean(2))
    pairs = [(apart[a:a + 3, b:b + 3].trace(), a, b) for a in range(len(frames) - 3)
             for b in range(a + len(frames) // 3, len(frames) - 3)]
    _, a, b = min(pairs)
    return [frames[a + t % (b - a)] for t in range(count)]


def main():
    binary = str(Path(sys.argv[1]).resolve())
    print(f"{'clip':18}{'drawn':10}{'complete':>9}{'flow':>7}{'difference':>11}{'variance':>9}{'copied':>8}")
    whole = "--whole" in sys.argv
    for path in (Path(word) for word in sys.argv[2:] if word != "--whole"):
        frames, fps = read(path)
        source, half = small(frames), len(frames) // 2
        deviation = source.std(0)
        where = deviation > 8 if (deviation > 8).sum() > 300 else deviation >= np.percentile(deviation, 85)
        first = patches(source, where, 30000, 1, 0, half)
        second = patches(source, where, 1500, 2, half, len(source))
        mean = first.mean(0)
        axes = np.linalg.svd((first - mean)[::10], full_matrices=False)[2][:16].T
        base = cKDTree((first - mean) @ axes).query((second - mean) @ axes)[0].mean()
        with tempfile.TemporaryDirectory() as folder:
            def run(*words):
                subprocess.run([binary, *map(str, words), "-q"], cwd=folder, check=True, stderr=subprocess.DEVNULL)
            write(Path(folder) / "learned.avi", frames if whole else frames[:half], fps)
            run("analyze", "learned.avi", "-o", "run", "--bottom-up")
            run("synth", "run/model", "-o", "footage.avi", "--frames", len(frames))
            drawn = {"footage": read(Path(folder) / "footage.avi")[0]}
            if not whole:
                run("synth", "run/model", "-o", "strokes.avi", "--frames", len(frames), "--method", "diffusion")
                run("dytex", "learn", "learned.avi", "-o", "texture")
                run("dytex", "synth", "texture", "-o", "texture.avi", "--frames", len(frames))
                drawn |= {name: read(Path(folder) / f"{name}.avi")[0] for name in ("texture", "strokes")}
                drawn["loop"] = loop(frames[:half], len(frames))
        of_source = flow(source, where), np.abs(np.diff(source, axis=0))[:, where].mean(), source.var(0)[where].mean()
        for name, clip in drawn.items():
            clip = small(clip)
            complete = cKDTree((patches(clip, where, 30000, 4, 0, len(clip)) - mean) @ axes).query(
                (second - mean) @ axes)[0].mean() / base
            shares = np.array([flow(clip, where), np.abs(np.diff(clip, axis=0))[:, where].mean(),
                               clip.var(0)[where].mean()]) / of_source
            print(f"{path.stem:18}{name:10}{complete:9.2f}{shares[0]:7.2f}{shares[1]:11.2f}{shares[2]:9.2f}"
                  f"{copied(clip, source if whole else source[:half], where):8.2f}", flush=True)


if __name__ == "__main__":
    main()
