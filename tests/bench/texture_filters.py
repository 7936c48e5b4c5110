#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Compares filters C of a linear dynamic texture at equal order: principal components, cosines, Haar wavelets, pixels.

    texture_filters.py [--order 20] CLIP...

The first 120 frames are read in grey, 96 px wide. Of the cosines, wavelets and pixels those with the most variance in
the first 60 frames are kept; A is fitted to these frames by least squares. Printed for the other 60 frames, as shares of
their energy about the mean of the first: what the filters do not keep, and the error of the forecast of the next frame.
Needs numpy and OpenCV."""
import argparse

import cv2
import numpy as np

FRAMES, WIDTH = 120, 96


def read_grey(path):
    clip, frames = cv2.VideoCapture(path), []
    while len(frames) < FRAMES:
        there, image = clip.read()
        if not there:
            break
        grey = cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)
        height = round(WIDTH * grey.shape[0] / grey.shape[1] / 8) * 8
        frames.append(cv2.resize(grey, (WIDTH, height), interpolation=cv2.INTER_AREA).astype(float))
    return np.array(frames)


def haar(image, levels=3):
    result = image.copy()
    height, width = result.shape
    for _ in range(levels):
        for axis in (0, 1):
            part = np.moveaxis(result[:height, :width], axis, 0)
            part[:] = np.vstack([part[0::2] + part[1::2], part[0::2] - part[1::2]]) / np.sqrt(2)
        height, width = height // 2, width // 2
    return result


def states(kind, first, second, order):
    """The order states of both halves, frames × order; all bases are orthonormal."""
    shape = first.shape[1:]
    if kind == "principal components":
        basis = np.linalg.svd(first.reshape(len(first), -1), full_matrices=False)[2][:order].T
        return [half.reshape(len(half), -1) @ basis for half in (first, second)]
    change = {"cosines": cv2.dct, "Haar wavelets": haar, "pixels": lambda image: image}[kind]
    both = [np.array([change(image).ravel() for image in half]) for half in (first, second)]
    kept = np.argsort(-(both[0] ** 2).sum(0))[:order]
    return [half[:, kept] for half in both]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("clips", nargs="+")
    parser.add_argument("--order", type=int, default=20)
    asked = parser.parse_args()
    kinds = ["principal components", "cosines", "Haar wavelets", "pixels"]
    print("| clip | " + " | ".join(kinds) + " |\n|---|" + "---|" * len(kinds))
    for path in asked.clips:
        frames = read_grey(path)
        half = len(frames) // 2
        first, second = frames[:half] - frames[:half].mean(0), frames[half:] - frames[:half].mean(0)
        energy, cells = (second[1:] ** 2).sum(), []
        for kind in kinds:
            x, y = states(kind, first, second, asked.order)
            A = np.linalg.lstsq(x[:-1], x[1:], rcond=None)[0]
            lost = energy - (y[1:] ** 2).sum()
            cells.append(f"{lost / energy:.2f}, {(lost + ((y[1:] - y[:-1] @ A) ** 2).sum()) / energy:.2f}")
        print(f"| {path.rsplit('/', 1)[-1]} | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main()
