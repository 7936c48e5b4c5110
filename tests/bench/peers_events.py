#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Events by segmentation and overlap, for `emberfold runs bench-events --entry`.   peers_events.py BENCH OUT [ridge|threshold]

BENCH is the folder of `emberfold runs bench-events`; OUT gets SCENE.json for each of its scenes. Lines are segmented frame by frame (ridge:
the larger eigenvalue of the Hessian at 2 px, bright and dark, with hysteresis; threshold: Otsu's, on the frame less its median over
41 px), components below 30 px dropped, and components of neighbouring frames that overlap, once grown by 3 px, are linked. What is
linked to nothing was born or died; where links fork, components split or merged. Needs NumPy, SciPy and OpenCV."""
import json, sys
from pathlib import Path
import cv2
import numpy as np
from scipy import ndimage
from scipy.spatial import cKDTree

LEAST, GROWN = 30, 3  # px² of a component, px that it may move


def ridges(frame):
    grey = frame.astype(np.float32)
    xx, yy, xy = (4 * ndimage.gaussian_filter(grey, 2, order=order) for order in ((0, 2), (2, 0), (1, 1)))
    middle, spread = (xx + yy) / 2, np.hypot((xx - yy) / 2, xy)
    masks = []
    for strength in (-(middle - spread), middle + spread):
        noise = 1.4826 * np.median(np.abs(strength - np.median(strength)))
        high, low = strength > 8 * noise, strength > 4 * noise
        labels, _ = ndimage.label(low, np.ones((3, 3)))
        masks.append(np.isin(labels, np.unique(labels[high])) & low)
    return masks


def bright(frame):
    grey = frame.astype(np.int16) - cv2.medianBlur(frame, 41)
    level = np.clip(grey + 128, 0, 255).astype(np.uint8)
    _, mask = cv2.threshold(cv2.GaussianBlur(level, (0, 0), 1), 0, 255, cv2.THRESH_BINARY + cv2.THRESH_OTSU)
    return [mask > 0]


def parts(mask):
    labels, count = ndimage.label(mask, np.ones((3, 3)))
    sizes = np.bincount(labels.ravel(), minlength=count + 1)
    keep = np.flatnonzero(sizes >= LEAST)
    keep = keep[keep > 0]
    number = np.zeros(count + 1, int)
    number[keep] = np.arange(1, len(keep) + 1)
    return number[labels]


def places(labels):
    return [np.argwhere(labels == k)[:, ::-1].astype(float) for k in range(1, labels.max() + 1)]


def between(parts_of, numbers):
    """Half way between the nearest points of the two largest of these components."""
    a, b = sorted((parts_of[k - 1] for k in numbers), key=len)[-2:]
    apart, at = cKDTree(a).query(b)
    k = int(apart.argmin())
    return (b[k] + a[at[k]]) / 2


def events_of(frame_events, t, before, now):
    shape = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * GROWN + 1, 2 * GROWN + 1))
    grown = cv2.dilate(now.astype(np.uint16), shape)
    both = (before > 0) & (grown > 0)
    pairs = {tuple(pair) for pair in np.unique(np.column_stack([before[both], grown[both]]), axis=0)}
    of_before, of_now = places(before), places(now)
    def tell(kind, place):
        frame_events.append({"frame": t, "type": kind, "x": float(place[0]), "y": float(place[1])})
    for k in range(1, len(of_before) + 1):
        after = [b for a, b in pairs if a == k]
        if not after: tell("death", of_before[k - 1].mean(0))
        if len(after) > 1: tell("split", between(of_now, after))
    for k in range(1, len(of_now) + 1):
        from_ = [a for a, b in pairs if b == k]
        if not from_: tell("birth", of_now[k - 1].mean(0))
        if len(from_) > 1: tell("merge", between(of_before, from_))


def main():
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    segment = bright if sys.argv[3:] == ["threshold"] else ridges
    out = Path(sys.argv[2])
    out.mkdir(parents=True, exist_ok=True)
    for scene in sorted(Path(sys.argv[1], "scenes").iterdir()):
        clip, events, before, t = cv2.VideoCapture(str(scene / "clip.avi")), [], None, 0
        while True:
            ok, frame = clip.read()
            if not ok: break
            now = [parts(mask) for mask in segment(cv2.cvtColor(frame, cv2.COLOR_BGR2GRAY))]
            for a, b in zip(before or [], now): events_of(events, t, a, b)
            before, t = now, t + 1
        (out / f"{scene.name}.json").write_text(json.dumps({"events": events}))


main()
