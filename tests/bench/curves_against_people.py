#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Scores sketches and their peers against curves that people drew.

    curves_against_people.py PROGRAM FOLDER [--bright] [--edges] [--boundaries [--colour]] [--sensitivity S ...]

FOLDER holds N.png and N_truth.png (white curves; thinned), and if there are N_second.png (a second person) and N_where.png
(where curves count). Such sets are DRIVE (vessels of the retina, two people), CrackForest (cracks in roads) and BSDS500
(boundaries; --edges, --boundaries). PROGRAM is emberfold. Peers, in the same run: scikit-image's sato + skeletonize, with --edges
OpenCV's Canny, each at its best threshold. All pictures are pooled:
P = drawn pixels within 2 px of the truth / drawn, R = truth within 2 px of what is drawn / truth.
Needs python3-numpy, python3-scipy, python3-skimage and python3-opencv.
"""
import argparse
import glob
import json
import os
import subprocess
import sys
import tempfile

import cv2
import numpy as np
from scipy.ndimage import distance_transform_edt
from skimage.filters import sato
from skimage.morphology import remove_small_objects, skeletonize


def read_pictures(folder):
    for name in sorted(glob.glob(os.path.join(folder, "*_truth.png"))):
        base = name[: -len("_truth.png")]
        image = cv2.imread(base + ".png", cv2.IMREAD_GRAYSCALE)
        read = lambda kind: cv2.imread(base + kind, cv2.IMREAD_GRAYSCALE) if os.path.exists(base + kind) else None
        where, second = read("_where.png"), read("_second.png")
        yield {"base": base, "image": image, "truth": skeletonize(read("_truth.png") > 127),
               "where": np.ones(image.shape, bool) if where is None else where > 127,
               "second": None if second is None else skeletonize(second > 127)}


def sketch(program, picture, sensitivity, given, folder):
    out = os.path.join(folder, os.path.basename(picture["base"]))
    command = [program, "sketch", picture["base"] + ".png", "-o", out, "-q", "--sensitivity", str(sensitivity)]
    command += ["--set", "sketch.colour=true"] if given.colour else ["--grey"]
    command += ["--set", "sketch.boundaries=true"] if given.boundaries else []
    subprocess.run(command + ([] if given.edges else ["--no-edges"]), check=True, stdout=subprocess.DEVNULL)
    with open(os.path.join(out, "sketch.jsonl")) as lines:
        frame = json.loads(lines.read().splitlines()[1])
    at = {v["id"]: v for v in frame["vertices"]}
    drawn = np.zeros(picture["image"].shape, np.uint8)
    for ids in frame["edges"]:
        ends = [at[i] for i in ids]
        is_step = any(v["width"] == 0 for v in ends)
        if not is_step and not any((v["contrast"] > 0) == given.bright for v in ends):
            continue
        cv2.line(drawn, *[(round(v["x"]), round(v["y"])) for v in ends], 1, 1)
    return drawn > 0


def count(drawn, picture, tolerance=2):
    drawn, truth = drawn & picture["where"], picture["truth"] & picture["where"]
    near = lambda a, b: int((b & (distance_transform_edt(~a) <= tolerance)).sum()) if a.any() else 0
    return np.array([near(truth, drawn), drawn.sum(), near(drawn, truth), truth.sum()])


def score(name, counts):
    found, drawn, recalled, true = np.sum(counts, axis=0)
    p, r = found / max(drawn, 1), recalled / max(true, 1)
    return 2 * p * r / max(p + r, 1e-9), f"{name:32} P {p:.3f}  R {r:.3f}  F {2 * p * r / max(p + r, 1e-9):.3f}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("folder")
    parser.add_argument("--bright", action="store_true", help="the curves are brighter than their ground")
    parser.add_argument("--edges", action="store_true", help="steps count too")
    parser.add_argument("--boundaries", action="store_true", help="boundaries of things in photographs are sketched")
    parser.add_argument("--colour", action="store_true", help="colour is looked at, too")
    parser.add_argument("--sensitivity", type=float, nargs="+", default=[0, 0.25, 0.5, 0.6, 0.75, 1])
    given = parser.parse_args()
    pictures = list(read_pictures(given.folder))
    if not pictures:
        sys.exit(f"{given.folder}: no N_truth.png")
    print(f"{len(pictures)} pictures")
    for sensitivity in given.sensitivity:
        with tempfile.TemporaryDirectory() as folder:
            drawn = [sketch(given.program, p, sensitivity, given, folder) for p in pictures]
        print(score(f"emberfold --sensitivity {sensitivity:g}", [count(d, p) for d, p in zip(drawn, pictures)])[1])
    if all(p["second"] is not None for p in pictures):
        print(score("a second person", [count(p["second"], p) for p in pictures])[1])
    ridges = [sato(p["image"].astype(float), sigmas=[1.2, 1.7, 2.4, 3.4], black_ridges=not given.bright) for p in pictures]
    print(max(score(f"sato + skeletonize, best ({t:g})",
                    [count(skeletonize(remove_small_objects(r >= t, 50)), p) for r, p in zip(ridges, pictures)])
              for t in (1, 1.5, 2, 2.5, 3, 4, 5, 6, 8, 10, 12, 15))[1])
    if given.edges:
        blurred = [cv2.GaussianBlur(p["image"], (0, 0), 1.4) for p in pictures]
        print(max(score(f"Canny, best ({t:g})", [count(cv2.Canny(b, 0.4 * t, t) > 0, p) for b, p in zip(blurred, pictures)])
                  for t in (30, 50, 80, 120, 160, 200, 250, 300))[1])


if __name__ == "__main__":
    main()
