#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Scores the events of clips of random shapes: level sets of smooth random fields, which move, merge and part.

    random_shapes.py EMBERFOLD FOLDER [--seed N]

Makes five clips of 100 frames of 320×240 in FOLDER (shapes with sharp and with soft edges, dark ones on uneven ground,
bright and dark ones on half of the frame each, faint ones), runs `EMBERFOLD analyze` and prints for each how many of the
sure events are among the reported ones (one to one, 4 frames, 20 px), how many are reported, and how many of these are
near no change at all. Changes are those of the field without noise at nine levels; sure are those that three levels
have. Needs numpy, scipy and OpenCV."""
import argparse
import json
import pathlib
import subprocess

import cv2
import numpy as np
from scipy import ndimage
from scipy.optimize import linear_sum_assignment

WIDTH, HEIGHT, FRAMES = 320, 240, 100
LEVELS = [-0.6, -0.45, -0.3, -0.15, 0, 0.15, 0.3, 0.45, 0.6]
LEAST_AREA = 12
FAMILY = {"split": "separate", "disconnect": "separate", "merge": "unite", "connect": "unite"}
# name: size in px, time in frames, width of an edge in px, uneven ground, contrast, share that is bright, polarity
SCENES = {
    "sharp": (12, 20, 2, 0, 120, 0.25, 1),
    "soft": (14, 22, 8, 0, 120, 0.35, 1),
    "dark": (12, 20, 2, 25, 80, 0.25, -1),
    "half": (12, 20, 3, 0, 120, 0.5, 1),
    "faint": (13, 20, 3, 20, 30, 0.3, 1),
}


def contact(whole, part, others):
    """Returns the pixel of `whole` from which it is least far to `part` and to the `others` together."""
    apart = ndimage.distance_transform_edt(~part) + ndimage.distance_transform_edt(~others)
    apart[~whole] = np.inf
    y, x = np.unravel_index(apart.argmin(), apart.shape)
    return x, y


def on_border(shape):
    return shape[[0, -1]].any() or shape[:, [0, -1]].any()


def changes_between(before, after, frame, level, backwards):
    """Yields the shapes of `before` that end or part on the way to `after`."""
    (labels, count), (there, count_there) = before, after
    area = np.bincount(there.ravel(), minlength=count_there + 1)
    for i in range(1, count + 1):
        shape = labels == i
        if shape.sum() < LEAST_AREA:
            continue
        touched = [j for j in np.unique(there[shape]) if j > 0]
        if not touched and not on_border(shape):
            y, x = ndimage.center_of_mass(shape)
            yield frame, "birth" if backwards else "death", x, y, level
        parts = sorted((j for j in touched if area[j] >= LEAST_AREA), key=lambda j: area[j])
        for j in parts[:-1]:
            x, y = contact(shape, there == j, np.isin(there, [k for k in parts if k != j]))
            yield frame, "unite" if backwards else "separate", x, y, level


def changes_of(field):
    found = []
    for level in LEVELS:
        labels = [ndimage.label(frame > level, np.ones((3, 3))) for frame in field]
        for t in range(1, FRAMES):
            found += changes_between(labels[t - 1], labels[t], t, level, False)
            found += changes_between(labels[t], labels[t - 1], t, level, True)
    return sorted(found)


def sure(changes):
    """Returns the changes that three levels have, each once."""
    left, events = list(changes), []
    while left:
        first, near = left[0], {}
        for c in left:
            if c[1] == first[1] and c[0] - first[0] <= 6 and np.hypot(c[2] - first[2], c[3] - first[3]) <= 15:
                near.setdefault(c[4], c)
        left = [c for c in left if c not in near.values()]
        if len(near) >= 3:
            t, x, y = np.median([(c[0], c[2], c[3]) for c in near.values()], axis=0)
            events.append((t, first[1], x, y))
    return events


def make(folder, scene, seed):
    size, time, edge, uneven, contrast, share, polarity = scene
    rng = np.random.default_rng(seed)
    noise = rng.standard_normal((FRAMES, HEIGHT, WIDTH)).astype(np.float32)
    field = ndimage.gaussian_filter(noise, (time, size, size), mode="wrap")
    slope = np.mean(np.hypot(*np.gradient(field[FRAMES // 2])))
    field = np.tanh((field - np.quantile(field, 1 - share)) / (slope * edge))
    y, x = np.mgrid[0:HEIGHT, 0:WIDTH]
    ground = 128 + uneven * (np.sin(x / 90 + 1) + np.cos(y / 70))
    frames = ground + polarity * contrast / 2 * field + rng.normal(0, 2, field.shape)
    folder.mkdir(parents=True, exist_ok=True)
    clip = folder / "clip.avi"
    writer = cv2.VideoWriter(str(clip), cv2.VideoWriter_fourcc(*"FFV1"), 25, (WIDTH, HEIGHT), False)
    for frame in np.clip(frames, 0, 255).astype(np.uint8):
        writer.write(frame)
    writer.release()
    return clip, changes_of(field)


def near(event, change, frames):
    return (FAMILY.get(event["type"], event["type"]) == change[1] and abs(event["frame"] - change[0]) <= frames
            and np.hypot(event["x"] - change[2], event["y"] - change[3]) <= 20)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("emberfold")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    print("shapes  found, of  reported  nothing there")
    for number, (name, scene) in enumerate(SCENES.items()):
        clip, changes = make(asked.folder / name, scene, asked.seed + number)
        subprocess.run([asked.emberfold, "analyze", clip, "-o", asked.folder / name / "run", "-q"], check=True)
        reported = json.loads((asked.folder / name / "run" / "events.json").read_text())["events"]
        events = sure(changes)
        match = np.array([[near(e, c, 4) for e in reported] for c in events]).reshape(len(events), len(reported))
        found = match[linear_sum_assignment(~match)].sum()
        nothing = sum(not any(near(e, c, 6) for c in changes) for e in reported)
        print(f"{name:6}  {found:5}, {len(events):3}  {len(reported):8}  {nothing:13}")


if __name__ == "__main__":
    main()
