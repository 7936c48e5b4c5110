#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Counts the events that a program finds where nothing happens: pictures that sway smoothly, in noise.

    still_pictures.py EMBERFOLD PICTURE... [--sway PX] [--frames N] [--noise SD] [--keep FOLDER]

Each picture is warped by a smooth field of motion that changes slowly (0 px: it stands still), white noise is
added, and the clip is analysed by the match alone (--bottom-up) and as by default. Every event is false."""
import argparse
import json
import pathlib
import subprocess
import tempfile

import cv2
import numpy as np

LARGEST = 320  # px, of a picture's width


def smooth_field(shape, rng):
    """A random field of unit RMS that varies over about a fifth of the picture."""
    field = cv2.GaussianBlur(rng.standard_normal(shape).astype(np.float32), (0, 0), max(shape) / 5)
    return field / np.sqrt(np.mean(field**2))


def write_clip(picture, path, frames, sway, noise, rng):
    height, width = picture.shape[:2]
    x, y = np.meshgrid(np.arange(width, dtype=np.float32), np.arange(height, dtype=np.float32))
    fields = [smooth_field((height, width), rng) for _ in range(4)]
    path.mkdir(parents=True)
    for t in range(frames):
        slow, fast = np.sin(2 * np.pi * t / 37), np.sin(2 * np.pi * t / 23 + 1)
        dx, dy = (sway * (slow * fields[i] + fast * fields[i + 1]) / 2 for i in (0, 2))
        warped = cv2.remap(picture, x + dx, y + dy, cv2.INTER_CUBIC, borderMode=cv2.BORDER_REFLECT)
        noisy = warped + noise * rng.standard_normal(warped.shape)
        cv2.imwrite(str(path / f"{t:04}.png"), np.clip(np.round(noisy), 0, 255).astype(np.uint8))


def count_events(program, clip, out, options):
    command = [program, "analyze", str(clip), "-o", str(out), "-q", *options]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    events = json.loads((out / "events.json").read_text())["events"]
    return len(events), sum(e["probability"] >= 0.9 for e in events)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("pictures", nargs="+")
    parser.add_argument("--sway", type=float, default=3)
    parser.add_argument("--frames", type=int, default=60)
    parser.add_argument("--noise", type=float, default=2)
    parser.add_argument("--keep", help="folder that clips and results are left in")
    asked = parser.parse_args()
    print(f"{'picture':24s} {'sway':>5s} {'bottom-up':>10s} {'p >= .5':>8s} {'p >= .9':>8s}")
    with tempfile.TemporaryDirectory() as folder:
        for i, name in enumerate(asked.pictures):
            picture = cv2.imread(name)
            if picture is None:
                raise SystemExit(f"{name} is no picture that OpenCV reads")
            scale = min(1, LARGEST / picture.shape[1])
            picture = cv2.resize(picture, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
            for sway in sorted({0.0, asked.sway}):
                work = pathlib.Path(asked.keep or folder) / f"{i}_{sway:g}"
                write_clip(picture, work / "clip", asked.frames, sway, asked.noise, np.random.default_rng(i))
                matched, _ = count_events(asked.program, work / "clip", work / "matched", ["--bottom-up"])
                likely, sure = count_events(asked.program, work / "clip", work / "default", [])
                print(f"{pathlib.Path(name).name:24s} {sway:5g} {matched:10d} {likely:8d} {sure:8d}", flush=True)


if __name__ == "__main__":
    main()
