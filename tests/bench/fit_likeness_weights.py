#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Fits the weights that tell from how alike places are whether what frames show can be followed.

    fit_likeness_weights.py EVENT_EVIDENCE CLIP... [--unfollowed CLIP ...] [--keep DIR]

EVENT_EVIDENCE is the program of that name in tests/bench. Each CLIP, a video whose motion can be followed, is read as it
is and with its frames in random order; --unfollowed are clips whose frames are known not to follow each other. Printed is
the mean log-linear likeness of each clip by weights that were fitted to the others, then the weights fitted to all: those of
mcmc/inference/change_posterior.cpp, but that there 0 lies half way between the most unlike clip and the most alike random
order. --keep leaves the evidence in DIR and takes what is there. Needs numpy and OpenCV."""
import argparse
import csv
import pathlib
import subprocess
import tempfile

import cv2
import numpy as np

MOST_FRAMES = 60


def read_frames(path):
    clip, frames = cv2.VideoCapture(str(path)), []
    while True:
        there, frame = clip.read()
        if not there:
            return frames
        frames.append(frame)


def write_shuffled(path, out):
    frames = read_frames(path)
    order = np.random.default_rng(5).permutation(len(frames))[:MOST_FRAMES]
    height, width = frames[0].shape[:2]
    video = cv2.VideoWriter(str(out), cv2.VideoWriter_fourcc(*"FFV1"), 25, (width, height))
    for k in order:
        video.write(frames[k])
    video.release()


def likeness(program, clip, stored):
    if not stored.exists():
        run = subprocess.run([program, str(clip)], check=True, stdout=subprocess.PIPE, text=True)
        stored.write_text(run.stdout)
    pairs = [[float(row["next"]), float(row["apart"])] for row in csv.DictReader(stored.read_text().splitlines()) if row["next"]]
    fisher = np.arctanh(np.clip(np.array(pairs).reshape(-1, 2), -0.9, 0.99))
    return np.column_stack([np.ones(len(fisher)), fisher[:, 0], fisher[:, 0] - fisher[:, 1]])


def fit(tables, labels, penalty=0.3):
    """Ridge logistic regression in which clips count alike, and both kinds."""
    tables, labels = zip(*[(t, y) for t, y in zip(tables, labels) if len(t)])
    x, y = np.vstack(tables), np.repeat(labels, [len(t) for t in tables]).astype(float)
    shares = [1000 / len(t) / labels.count(label) for t, label in zip(tables, labels)]
    weight = np.repeat(shares, [len(t) for t in tables])
    ridge, w = np.array([0.01, penalty, penalty]), np.zeros(3)
    for _ in range(60):
        p = 1 / (1 + np.exp(-x @ w))
        w += np.linalg.solve((x * (weight * p * (1 - p))[:, None]).T @ x + np.diag(ridge), x.T @ (weight * (y - p)) - ridge * w)
    return w


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("clips", nargs="+", type=pathlib.Path)
    parser.add_argument("--unfollowed", nargs="*", default=[], type=pathlib.Path)
    parser.add_argument("--keep", type=pathlib.Path)
    asked = parser.parse_args()
    names, tables, labels, sources = [], [], [], []
    with tempfile.TemporaryDirectory() as folder:
        kept = asked.keep or pathlib.Path(folder)
        kept.mkdir(parents=True, exist_ok=True)
        for clip in asked.clips + asked.unfollowed:
            name = clip.stem if clip.stem != "clip" else clip.parent.parent.name + "_" + clip.parent.name
            for shuffled in (False, True) if clip in asked.clips else (False,):
                source = clip
                if shuffled:
                    source = pathlib.Path(folder) / "shuffled.avi"
                    write_shuffled(clip, source)
                names.append(name + (", random order" if shuffled else ""))
                tables.append(likeness(asked.program, source, kept / (names[-1].replace(", ", "_").replace(" ", "_") + ".csv")))
                labels.append(clip in asked.clips and not shuffled)
                sources.append(clip)
    for name, table, source in zip(names, tables, sources):
        others = [k for k in range(len(names)) if sources[k] != source]
        weights = fit([tables[k] for k in others], [labels[k] for k in others])
        print(f"{name:40s} {len(table):5d} changes, mean {np.clip(table @ weights, -4, 4).mean() if len(table) else np.nan:6.2f}")
    print("weights", ", ".join(f"{w:.2f}" for w in fit(tables, labels)))


if __name__ == "__main__":
    main()
