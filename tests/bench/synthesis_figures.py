#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Whether clips drawn from motion models live as their sources do: event rates and stroke lifetimes.

    synthesis_figures.py build/release/apps/emberfold OUT flag.avi:0:120 smoke.mp4:60:180 ...

Each clip (CLIP[:FIRST:END]) is reduced to 320 px, learned by `analyze --bottom-up`, drawn anew by `synth` and, as the
yardstick, by `dytex learn` and `dytex synth`; all are analysed in the same way, and what that finds is
set side by side. Needs ffmpeg and numpy. What is there already in OUT is used again.

Rates are events a frame, with the 95 % interval of the source's: of a Gamma law of shape (n + 1/2)/phi for n events, phi
the events' variance over their mean between blocks of 10 frames (at least 1). Lifetimes are means of the first
60 frames of the lives of strokes born in the clip (Kaplan & Meier 1958), with their bootstrap interval.
`apart`: the root of the mean square of the logarithms of (synthesized + 1/2T)/(source + 1/2T) over the seven rows.
"""
import argparse
import csv
import json
import subprocess
from pathlib import Path

import numpy as np
from scipy import stats

KINDS = ["birth", "death", "split", "merge", "connect", "disconnect"]
HORIZON = 60


def run(*command):
    subprocess.run([str(part) for part in command], check=True)


def prepare(spec, out):
    path, *part = spec.split(":")
    target = out / (Path(path).stem + ".avi")
    if not target.exists():
        choose = [f"trim=start_frame={part[0]}:end_frame={part[1]}", "setpts=PTS-STARTPTS"] if part else []
        scale = "scale='if(gt(iw,ih),320,-2)':'if(gt(iw,ih),-2,320)'"
        run("ffmpeg", "-v", "error", "-i", path, "-vf", ",".join(choose + [scale]), "-c:v", "ffv1", target)
    return target


def analysed(binary, clip, folder):
    if not (folder / "summary.json").exists():
        run(binary, "analyze", clip, "-o", folder, "--bottom-up", "-q")
    return folder


def events(folder):
    frames = json.loads((folder / "summary.json").read_text())["clip"]["frames"]
    counts = {kind: np.zeros(frames - 1) for kind in KINDS}
    with open(folder / "events.csv") as file:
        for row in csv.DictReader(file):
            counts[row["type"]][int(row["frame"]) - 1] += 1
    return counts


def rate_interval(counts):
    blocks = counts[: len(counts) // 10 * 10].reshape(-1, 10).sum(1)
    phi = max(1.0, blocks.var(ddof=1) / blocks.mean()) if blocks.sum() > 0 else 1.0
    shape = (counts.sum() + 0.5) / phi
    low, high = stats.gamma.ppf([0.025, 0.975], shape, scale=phi / len(counts))
    return (low if counts.sum() > 0 else 0.0), high


def lives(folder):
    """Lengths of the lives of strokes born in the clip, and whether they ended in it."""
    frames = json.loads((folder / "summary.json").read_text())["clip"]["frames"]
    first, last = {}, {}
    with open(folder / "strokes.csv") as file:
        for row in csv.DictReader(file):
            first.setdefault(row["stroke"], int(row["frame"]))
            last[row["stroke"]] = int(row["frame"])
    born = [s for s in first if first[s] > 0]
    return np.array([[last[s] - first[s] + 1, last[s] < frames - 1] for s in born]).reshape(-1, 2)


def lifetime(all_lives):
    if len(all_lives) == 0:
        return 0.0
    length, ended = all_lives[:, 0], all_lives[:, 1]
    ends = np.bincount(length[ended > 0].clip(max=HORIZON + 1), minlength=HORIZON + 2)[1 : HORIZON + 1]
    there = len(length) - np.searchsorted(np.sort(length), np.arange(1, HORIZON + 1))
    alive = np.cumprod(1 - ends / np.maximum(1, there))
    return 1 + alive[:-1].sum()


def lifetime_interval(all_lives):
    rng = np.random.default_rng(1)
    means = [lifetime(all_lives[rng.integers(0, len(all_lives), len(all_lives))]) for _ in range(1000)]
    return tuple(np.percentile(means, [2.5, 97.5]))


def figures(folder):
    """Of each row: value and interval."""
    counts = events(folder)
    rows = {kind: (counts[kind].mean(), rate_interval(counts[kind])) for kind in KINDS}
    found = lives(folder)
    rows["lifetime"] = (lifetime(found), lifetime_interval(found) if len(found) else (0.0, 0.0))
    return rows, len(counts["birth"])


def apart(source, other, gaps):
    half = 0.5 / gaps
    logs = [np.log((other[row][0] + half) / (source[row][0] + half)) for row in source]
    return float(np.sqrt(np.mean(np.square(logs))))


def synthesized(binary, clip, out, frames, with_texture):
    stem = clip.stem
    model, ours = out / f"{stem}.learned", out / f"{stem}.new.avi"
    analysed(binary, clip, model)
    if not ours.exists():
        run(binary, "synth", model / "model", "-o", ours, "--frames", frames, "--start", "stationary", "-q")
    texture, theirs = out / f"{stem}.dytex", out / f"{stem}.dytex.avi"
    if not with_texture:
        return ours, None
    if not texture.exists():
        run(binary, "dytex", "learn", clip, "-o", texture, "-q")
    if not theirs.exists():
        run(binary, "dytex", "synth", texture, "-o", theirs, "--frames", frames, "-q")
    return ours, theirs


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("emberfold")
    parser.add_argument("out", type=Path)
    parser.add_argument("clips", nargs="+", metavar="CLIP[:FIRST:END]")
    parser.add_argument("--frames", type=int, default=1000)
    parser.add_argument("--no-dytex", action="store_true")
    asked = parser.parse_args()
    asked.out.mkdir(parents=True, exist_ok=True)
    inside = rows_in_all = nearer = 0
    for spec in asked.clips:
        clip = prepare(spec, asked.out)
        ours, theirs = synthesized(asked.emberfold, clip, asked.out, asked.frames, not asked.no_dytex)
        source, gaps = figures(analysed(asked.emberfold, clip, asked.out / f"{clip.stem}.source"))
        new, _ = figures(analysed(asked.emberfold, ours, asked.out / f"{clip.stem}.new"))
        linear = None
        if not asked.no_dytex:
            linear, _ = figures(analysed(asked.emberfold, theirs, asked.out / f"{clip.stem}.dytex.new"))
        print(f"\n{clip.stem:<12}{'source':>9}  {'95 % interval':<18}{'synth':>9}      {'dytex':>9}")
        for row, (value, (low, high)) in source.items():
            found = new[row][0]
            fits = low <= found <= high
            inside, rows_in_all = inside + fits, rows_in_all + 1
            text = f"{row:<12}{value:9.3f}  {low:7.3f} … {high:7.3f} {found:9.3f} {'in ' if fits else 'OUT'}"
            print(text + (f" {linear[row][0]:10.3f}" if linear else ""))
        distance = apart(source, new, gaps)
        text = f"{'apart':<12}{'':>29}{distance:9.3f}    "
        if linear:
            other = apart(source, linear, gaps)
            nearer += distance < other
            text += f" {other:10.3f}"
        print(text, flush=True)
    print(f"\n{inside} of {rows_in_all} inside" + ("" if asked.no_dytex else f"; nearer than the linear texture on {nearer} of {len(asked.clips)}"))


if __name__ == "__main__":
    main()
