#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Fits the weights with which the evidence for an event is combined into its probability.

    fit_event_weights.py EVENT_EVIDENCE FOLDER... [--family A,B ...] [--keep DIR]

FOLDERs hold a clip.avi and a truth.json each: scenes with known events, real pictures that stand still or sway (without
an event, or with painted ones). EVENT_EVIDENCE is the program of that name in tests/bench. Printed are, for each folder,
F1 in four classes (2 frames, 20 px) of the events of probability 0.5 or more, found by weights that were fitted to all
folders of other families (--family A,B: these two are of one), then the calibration of all, then the weights fitted to
all folders, as mcmc/inference/change_posterior.cpp has them. --keep leaves the evidence in DIR and takes what is there.
Needs numpy and scipy."""
import argparse
import csv
import json
import pathlib
import subprocess

import numpy as np
from scipy.optimize import linear_sum_assignment

FAMILY = {"birth": 0, "death": 1, "split": 2, "disconnect": 2, "merge": 3, "connect": 3}
NAMES = ["kIntercept", "kStrokeFactor", "kJointFactor", "kShortSide"]
LONG_ENOUGH = 12
REACH = 400  # px


def read_evidence(program, folder, keep):
    stored = keep / (folder.name + ".csv") if keep else None
    if stored and stored.exists():
        text = stored.read_text()
    else:
        text = subprocess.run([program, str(folder / "clip.avi")], check=True, stdout=subprocess.PIPE, text=True).stdout
        if stored:
            keep.mkdir(parents=True, exist_ok=True)
            stored.write_text(text)
    rows = list(csv.DictReader(text.splitlines()))
    truth = json.loads((folder / "truth.json").read_text())["events"]
    return rows, truth


def features(rows):
    table = []
    for row in rows:
        factor, stroke = float(row["log_factor"]), int(row["of_stroke"])
        side = np.log(np.clip(min(float(row["since"]), float(row["until"])), 1, LONG_ENOUGH))
        table.append([1, factor * stroke, factor * (not stroke), side])
    return np.array(table).reshape(-1, len(NAMES))


def pair(rows, truth, take=None):
    """Pairs events and true ones, as many as can be and the nearest of them; returns which rows are true."""
    true = np.zeros(len(rows), bool)
    kept = [i for i in range(len(rows)) if take is None or take[i]]
    if not kept or not truth:
        return true
    cost = np.full((len(kept), len(truth)), 1e6)
    for a, i in enumerate(kept):
        row = rows[i]
        for b, event in enumerate(truth):
            late = abs(event["frame"] - int(row["frame"]))
            apart = np.hypot(event["x"] - float(row["x"]), event["y"] - float(row["y"]))
            if FAMILY[event["type"]] == FAMILY[row["type"]] and late <= 2 and apart <= 20:
                cost[a, b] = 10 * late + apart
    for a, b in zip(*linear_sum_assignment(cost)):
        true[kept[a]] |= cost[a, b] < 1e6
    return true


def logistic(x):
    return 1 / (1 + np.exp(-x))


def fit(tables, labels, penalty=0.3, of_clip=1.0):
    """Ridge logistic regression; each clip has an intercept of its own beside the common one."""
    x, y = np.vstack(tables), np.concatenate(labels).astype(float)
    clip = np.repeat(np.arange(len(tables)), [len(t) for t in tables])
    design = np.hstack([x, np.eye(len(tables))[clip]])
    ridge = np.array([0.01] + [penalty] * (x.shape[1] - 1) + [of_clip] * len(tables))
    weights = np.zeros(design.shape[1])
    for _ in range(100):
        p = logistic(design @ weights)
        hessian = (design * (p * (1 - p))[:, None]).T @ design + np.diag(ridge)
        step = np.linalg.solve(hessian, design.T @ (y - p) - ridge * weights)
        weights += step
        if np.abs(step).max() < 1e-9:
            break
    return weights[: x.shape[1]]


def estimate(table, rows, weights, usual):
    """Corrects the odds for the share of true events near each (Saerens, Latinne & Decaestecker 2002)."""
    odds = table @ weights
    place = np.array([complex(float(row["x"]), float(row["y"])) for row in rows])
    near = np.clip(1 - np.abs(place[:, None] - place) ** 2 / REACH**2, 0, None) ** 2
    low, high = np.zeros(len(odds)), np.ones(len(odds))
    for _ in range(50):
        share = (low + high) / 2
        shift = np.log(share / (1 - share)) - np.log(usual / (1 - usual))
        more = (near * logistic(odds + shift[:, None])).sum(1) + 0.5 > share * (near.sum(1) + 1)
        low, high = np.where(more, share, low), np.where(more, high, share)
    return logistic(odds + shift)


def report_calibration(p, y):
    error = 0
    for k in range(10):
        some = (p >= k / 10) & (p < (k + 1) / 10 + (k == 9))
        if some.any():
            print(f"{k / 10:.1f}-{k / 10 + 0.1:.1f}: {some.sum():5d} events, said {p[some].mean():.3f}, true {y[some].mean():.3f}")
            error += some.mean() * abs(p[some].mean() - y[some].mean())
    print(f"Brier score {np.mean((p - y) ** 2):.4f} (constant {y.mean() * (1 - y.mean()):.4f}), calibration error {error:.3f}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("folders", nargs="+", type=pathlib.Path)
    parser.add_argument("--family", action="append", default=[])
    parser.add_argument("--keep", type=pathlib.Path)
    parser.add_argument("--usual", type=float, default=0.4, help="usual share of true events")
    asked = parser.parse_args()
    data = {f.name: read_evidence(asked.program, f, asked.keep) for f in asked.folders}
    tables = {n: features(rows) for n, (rows, _) in data.items()}
    labels = {n: pair(rows, truth) for n, (rows, truth) in data.items()}
    families = {n: n for n in data}
    for together in asked.family:
        families.update({n: together for n in together.split(",") if n in data})
    said, true, scores = [], [], []
    for name, (rows, truth) in data.items():
        others = [n for n in data if families[n] != families[name]]
        weights = fit([tables[n] for n in others], [labels[n] for n in others])
        p = estimate(tables[name], rows, weights, asked.usual)
        believed = p >= 0.5
        hits = pair(rows, truth, believed).sum()
        f1 = 2 * hits / (believed.sum() + len(truth)) if truth else float("nan")
        scores.append(f1)
        print(f"{name:18s} {len(truth):4d} true, {len(rows):5d} read, {labels[name].sum():4d} of them true; believed "
              f"{believed.sum():4d}, right {hits:4d}, F1 {f1:.3f}")
        listed = p >= 0.05
        said.append(p[listed])
        true.append(pair(rows, truth)[listed])
    print(f"mean F1 {np.nanmean(scores):.4f}")
    report_calibration(np.concatenate(said), np.concatenate(true).astype(float))
    for name, weight in zip(NAMES, fit(list(tables.values()), list(labels.values()))):
        print(f"{name} = {weight:.2f}")


if __name__ == "__main__":
    main()
