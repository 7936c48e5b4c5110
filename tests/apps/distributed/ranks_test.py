#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs `dytex learn` on 1, 2 and 4 ranks of one machine: ranks_test.py EMBERFOLD with|without MPIRUN
`without`: of a build without MPI, which has to say so."""

import array
import ast
import json
import os
import pathlib
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time

PROGRAM, MODE, MPIRUN = sys.argv[1], sys.argv[2], sys.argv[3:]
ENVIRONMENT = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
               "OMPI_MCA_rmaps_base_oversubscribe": "1", "OMPI_MCA_hwloc_base_binding_policy": "none",
               "OMPI_MCA_mpi_yield_when_idle": "1"}


def fail(text):
    sys.exit("ranks_test.py: " + text)


def check(condition, text):
    if not condition:
        fail(text)


def command(ranks, *words):
    launcher = [*MPIRUN, "-n", str(ranks)] if ranks else []
    return [*launcher, PROGRAM, "dytex", "learn", *map(str, words)]


def run(ranks, *words, exit=0, environment=ENVIRONMENT):
    done = subprocess.run(command(ranks, *words), env=environment, capture_output=True, text=True, timeout=120)
    check(done.returncode == exit, f"{ranks} ranks: exit {done.returncode}, expected {exit}:\n{done.stderr}")
    return done


def lines_of(done):
    return [line for line in done.stderr.splitlines() if line.startswith("emberfold: ")]


def files_of(model):
    return {p.name: p.read_bytes() for p in pathlib.Path(model).iterdir()
            if p.is_file() and p.name != "summary.json"}


def figures_of(model):
    return json.loads((model / "summary.json").read_text())["learning"]["distributed"]


def check_same(a, b, what):
    one, two = files_of(a), files_of(b)
    check(one.keys() == two.keys(), f"{what}: other files, {sorted(one)} and {sorted(two)}")
    for name in one:
        check(one[name] == two[name], f"{what}: {name} has other bytes")


def columns_of(model, name):
    """The columns of a matrix, or one of a vector."""
    data = (model / (name + ".npy")).read_bytes()
    begin = 10 + struct.unpack("<H", data[8:10])[0]
    header = ast.literal_eval(data[10:begin].decode())
    values = array.array("f" if header["descr"] == "<f4" else "d", data[begin:])
    rows = header["shape"][0]
    return [values[i:i + rows] for i in range(0, len(values), rows)]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def combined(columns, weights):
    return [dot(row, weights) for row in zip(*columns)]


def forecast(model):
    """The expected frames behind the clip's last one."""
    A, C, mean, x = columns_of(model, "A"), columns_of(model, "C"), columns_of(model, "mean")[0], columns_of(model, "states")[-1]
    frames = []
    for _ in range(4):
        x = combined(A, x)
        frames.append([a + b for a, b in zip(mean, combined(C, x))])
    return frames


def check_alike(a, b):
    """Subspaces and forecast frames agree within 1e-6."""
    C, apart = columns_of(a, "C"), 0
    for column in columns_of(b, "C"):
        seen = combined(C, [dot(other, column) for other in C])
        apart += sum((x - y) ** 2 for x, y in zip(column, seen))
    check(apart ** 0.5 < 1e-6, f"the subspaces lie {apart ** 0.5} apart")
    left, right = forecast(a), forecast(b)
    most = max(abs(x - y) for f, g in zip(left, right) for x, y in zip(f, g))
    check(most < 1e-6 * max(map(max, left)), f"the forecast frames lie {most} apart")


def draw_frames(work):
    """A folder of 60 pictures of 80 by 60 pixels."""
    run(0, "builtin:fire", "--scale", "0.25", "-n", "12", "-o", work / "fire", "-q")
    subprocess.run([PROGRAM, "dytex", "synth", work / "fire", "-o", work / "frames", "--frames", "60", "-q"], check=True)
    return work / "frames"


def test_same_model(work, frames):
    clip = [frames, "--range", "0:40", "-n", "8"]
    run(0, *clip, "-o", work / "one")
    for ranks in (1, 2, 4):
        run(ranks, *clip, "-o", work / f"ranks{ranks}")
        run(ranks, *clip, "-o", work / f"blocks{ranks}", "--set", "learn.block=16")
        figures = figures_of(work / f"ranks{ranks}")
        check(figures["ranks"] == ranks and sum(figures["frames_decoded"]) == 40,
              f"each frame is to be decoded once: {figures}")
        check((min(figures["bytes_sent"]) > 0) == (ranks > 1), f"bytes were not counted: {figures}")
    check_alike(work / "one", work / "ranks2")
    for kind in ("ranks", "blocks"):
        for ranks in (2, 4):
            check_same(work / f"{kind}1", work / f"{kind}{ranks}", f"{kind}, {ranks}")
    check(not list(work.glob("*.learning")), "what was kept is still there")
    info = subprocess.run([PROGRAM, "dytex", "info", work / "blocks2"], capture_output=True, text=True)
    check(info.returncode == 0, info.stderr)


def test_damaged_frame(work, frames):
    broken = work / "broken_frames"
    shutil.copytree(frames, broken)
    pictures = sorted(broken.glob("*.png"))
    check(len(pictures) == 60, f"{len(pictures)} pictures were drawn")
    pictures[20].write_bytes(pictures[20].read_bytes()[:200])
    for extra in ([], ["--set", "learn.block=8"]):
        done = run(4, broken, "-o", work / "broken", "-n", "4", "-q", *extra, exit=1)
        told = [line for line in lines_of(done) if "warning" not in line]
        check(len(told) == 1 and pictures[20].name in told[0], f"not one clear line:\n{done.stderr}")
        check(not (work / "broken").exists(), "a part of a model was left")
        shutil.rmtree(work / "broken.learning", ignore_errors=True)


def ranks_below(launcher):
    """The processes that a launcher has started, by rank."""
    found = {}
    for process in pathlib.Path("/proc").iterdir():
        if not process.name.isdigit():
            continue
        try:
            if int((process / "stat").read_text().rsplit(")", 1)[1].split()[1]) != launcher:
                continue
            for entry in (process / "environ").read_bytes().split(b"\0"):
                if entry.startswith(b"OMPI_COMM_WORLD_RANK="):
                    found[int(entry.split(b"=")[1])] = int(process.name)
        except (OSError, ValueError):
            continue
    return found


def kept(folder):
    """Frames and blocks that are done."""
    try:
        return struct.unpack("<2q", (folder / "progress").read_bytes()[:16])
    except (OSError, struct.error):
        return [0, 0]


def test_killed_rank(work, frames):
    clip = [frames, "-n", "6", "--set", "learn.block=4"]
    run(2, *clip, "-o", work / "undisturbed")
    launched = subprocess.Popen(command(2, *clip, "-o", work / "killed"), env=ENVIRONMENT,
                                stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    folder, victim, end = work / "killed.learning", None, time.time() + 60
    while launched.poll() is None and time.time() < end:
        if kept(folder)[1] >= 3:
            victim = ranks_below(launched.pid).get(1)
            check(victim, "rank 1 was not found")
            os.kill(victim, signal.SIGKILL)
            break
        time.sleep(0.002)
    told = launched.communicate(timeout=60)[1]
    check(victim, f"the job was over before a rank could be killed:\n{told}")
    check(launched.returncode != 0, "a job with a dead rank ended well")
    check("rank 1" in told and "signal 9" in told, f"no word of the dead rank:\n{told}")
    check(not (work / "killed" / "model.json").exists(), "a part of a model was left")
    done = kept(folder)[0]
    run(4, *clip, "-o", work / "killed")
    check(figures_of(work / "killed")["resumed_frames"] == done > 0, "the rerun began anew")
    check_same(work / "undisturbed", work / "killed", "after a rank had died")


def test_without():
    def told(rank, exit):
        return run(0, "builtin:fire", "-o", "nowhere", exit=exit, environment={
            **os.environ, "OMPI_COMM_WORLD_SIZE": "2", "OMPI_COMM_WORLD_RANK": str(rank)}).stderr

    check(told(0, 2).count("\n") == 1 and "this build has no MPI" in told(0, 2), told(0, 2))
    check(told(1, 0) == "", "more than one rank tells that there is no MPI")


def main():
    if MODE == "without":
        return test_without()
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder)
        frames = draw_frames(work)
        test_same_model(work, frames)
        test_damaged_frame(work, frames)
        test_killed_rank(work, frames)


main()
