#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Learning a linear dynamic texture of 50 components with numpy and scipy, beside bench_emberfold, in turns.

usage: peers_dytex.py PROGRAM [--rounds 3] [--cases grey_100,colour_300]

PROGRAM is the built bench_emberfold. All of them learn from 8-bit frames of 320 x 220 on one thread of one core (the
process and its children are pinned): from bytes to the mean, C, the states, A and B. The peers:

  numpy svd       np.linalg.svd of the centred frames in float32
  numpy gram      the Gram matrix in float32 blocks of 2048 values, summed in double; eigh; C by one product
  scipy svds      scipy.sparse.linalg.svds (ARPACK), 50 components

Times are CPU time, milliseconds, the least over rounds; ratios are to ours. Says which BLAS numpy has: with the
reference BLAS the ratios say little. Needs numpy and scipy (python3-numpy, python3-scipy on Debian).
"""
import os

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[variable] = "1"

import argparse
import json
import subprocess
import sys
import time

try:
    import numpy as np
    import scipy.sparse.linalg
except ImportError as error:
    sys.exit(f"peers_dytex: not installed: {error.name} (on Debian: python3-numpy, python3-scipy)")

N = 50
CASES = dict(grey_100=(1, 100), grey_300=(1, 300), colour_100=(3, 100), colour_300=(3, 300))


def blas():
    with open("/proc/self/maps", encoding="utf-8") as maps:
        files = {line.split()[-1] for line in maps if "blas" in line}
    files = {os.path.realpath(file) for file in files}
    return ", ".join(sorted(os.path.basename(file) for file in files)) or "inside numpy"


def make_frames(channels, count):
    """Waves that travel, and grain: a column of bytes for each frame."""
    rng = np.random.default_rng(1)
    m, t = 320 * 220 * channels, np.arange(count)
    place = np.arange(m) // channels
    levels = np.full((m, count), 128, np.float32, order="F")
    for i in range(40):
        phase = (rng.uniform(-0.3, 0.3) * (place % 320) + rng.uniform(-0.3, 0.3) * (place // 320)).astype(np.float32)
        course = rng.uniform(0, 0.5) * t + np.cumsum(0.05 * rng.normal(size=count))
        strength = 30 / (1 + 0.2 * i)
        levels += strength * np.outer(np.cos(phase), np.cos(course)).astype(np.float32)
        levels -= strength * np.outer(np.sin(phase), np.sin(course)).astype(np.float32)
    levels += rng.integers(0, 16, size=levels.shape, dtype=np.uint8) / np.float32(2)
    return np.asfortranarray(np.clip(np.rint(levels), 0, 255).astype(np.uint8))


def dynamics(X):
    A = np.linalg.lstsq(X[:, :-1].T, X[:, 1:].T, rcond=None)[0].T
    E = (X[:, 1:] - A @ X[:, :-1]) / np.sqrt(X.shape[1] - 1)
    U, s, _ = np.linalg.svd(E, full_matrices=False)
    return A, U * s


def centred(frames):
    Y = frames.astype(np.float32)
    mean = Y.mean(axis=1, keepdims=True)
    Y -= mean
    return Y, mean


def by_svd(frames):
    Y, mean = centred(frames)
    U, s, Vt = np.linalg.svd(Y, full_matrices=False)
    C, X = U[:, :N].copy(), (s[:N, None] * Vt[:N]).astype(np.float64)
    return mean, C, X, *dynamics(X)


def by_gram(frames):
    Y, mean = centred(frames)
    gram = np.zeros((Y.shape[1],) * 2)
    for begin in range(0, len(Y), 2048):
        block = Y[begin : begin + 2048]
        gram += block.T @ block
    values, vectors = np.linalg.eigh(gram)
    s, V = np.sqrt(values[::-1][:N]), vectors[:, ::-1][:, :N]
    C = Y @ (V / s).astype(np.float32)
    X = s[:, None] * V.T
    return mean, C, X, *dynamics(X)


def by_svds(frames):
    Y, mean = centred(frames)
    U, s, Vt = scipy.sparse.linalg.svds(Y, k=N)
    X = (s[::-1, None] * Vt[::-1]).astype(np.float64)
    return mean, U[:, ::-1].copy(), X, *dynamics(X)


PEERS = {"numpy svd": by_svd, "numpy gram": by_gram, "scipy svds": by_svds}


def ours(program, case):
    text = subprocess.run(
        [program, f"--benchmark_filter=^learn_texture/{case}/real_time$", "--benchmark_format=json", "--benchmark_min_time=0.5"],
        check=True, capture_output=True, text=True).stdout
    (row,) = json.loads(text)["benchmarks"]
    return row["cpu_time"]


def timed(work, frames):
    begin = time.process_time()
    result = work(frames)
    return 1000 * (time.process_time() - begin), result


def from_orthonormal(result):
    C = result[1].astype(np.float64)
    return np.abs(C.T @ C - np.eye(N)).max()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--cases", default="grey_100,colour_300")
    asked = parser.parse_args()
    os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    print(f"numpy {np.__version__}, scipy {scipy.__version__}, BLAS: {blas()}; CPU ms, least of {asked.rounds} rounds")
    print(f"{'case':12}{'who':14}{'ms':>9}{'ratio':>8}   |CtC - I|")
    for case in asked.cases.split(","):
        if case not in CASES:
            sys.exit(f"peers_dytex: no case {case}; there are {', '.join(CASES)}")
        frames = make_frames(*CASES[case])
        least, off = {}, {}
        for _ in range(asked.rounds):
            for who in ("ours", *PEERS):
                if who == "ours":
                    spent = ours(asked.program, case)
                else:
                    spent, result = timed(PEERS[who], frames)
                    off[who] = from_orthonormal(result)
                least[who] = min(spent, least.get(who, np.inf))
        for who, spent in least.items():
            error = f"{off[who]:.1e}" if who in off else ""
            print(f"{case:12}{who:14}{spent:9.1f}{spent / least['ours']:8.1f}   {error}")


if __name__ == "__main__":
    main()
