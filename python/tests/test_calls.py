# SPDX-License-Identifier: Apache-2.0
"""How calls behave in a process: memory, threads, signals, other processes."""
import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time
import warnings
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import emberfold as ef
from scenes import bars, ripples


def resident_kib():
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") // 1024


def test_a_thousand_calls_leave_nothing_behind(run):
    clip = ripples(12, 16, 16)
    texture = ef.dytex.learn(clip, components=3)

    def calls():
        ef.open(clip, roi=(1, 1, 8, 8)).read()
        texture.edit(speed=0.5).synthesize(2)
        run.patches(5), run.graph(5), run.model.rates.birth
        with pytest.raises(ValueError):
            ef.open(clip, fps=-1)

    for _ in range(200):
        calls()
    before = resident_kib()
    for _ in range(1000):
        calls()
    assert resident_kib() - before < 4096


def test_two_analyses_at_once():
    clips = [bars(10, seed=1), bars(10, seed=2)]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        alone = [ef.analyze(clip, quality="draft") for clip in clips]
        with ThreadPoolExecutor(2) as pool:
            together = list(pool.map(lambda clip: ef.analyze(clip, quality="draft"), clips))
    assert together == alone and alone[0] != alone[1]


def test_other_threads_run_meanwhile():
    ticks = []
    stop = threading.Event()

    def tick():
        while not stop.wait(0.002):
            ticks.append(time.perf_counter())

    thread = threading.Thread(target=tick)
    thread.start()
    began = time.perf_counter()
    ef.dytex.learn(ripples(200, 96, 96), components=40)
    seconds = time.perf_counter() - began
    stop.set()
    thread.join()
    assert len(ticks) > seconds / 0.05


def test_ctrl_c_ends_a_call_within_a_second():
    # Where the tests run in the background of a shell, the signal is ignored unless asked for.
    code = ("import signal, numpy as np, emberfold as ef\n"
            "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
            "clip = np.random.default_rng(0).integers(0, 255, (400, 240, 320), np.uint8)\n"
            "print('begun', flush=True)\n"
            "ef.analyze(clip)\n")
    process = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert process.stdout.readline() == "begun\n"
    time.sleep(1.5)
    process.send_signal(signal.SIGINT)
    began = time.monotonic()
    _, told = process.communicate(timeout=30)
    assert "KeyboardInterrupt" in told and process.returncode != 0
    # Twice what a quiet machine needs, at most: tests run beside others.
    assert time.monotonic() - began < 2


def test_a_callback_can_stop_a_call():
    seen = []

    def report(stage, share):
        seen.append((stage, share))
        if len(seen) > 3:
            raise LookupError("enough")

    with pytest.raises(LookupError, match="enough"):
        ef.analyze(bars(40), progress=report)
    assert all(0 <= share <= 1 for _, share in seen)


def test_progress_is_one_line(capsys):
    ef.dytex.learn(ripples(), components=3, progress=True)
    told = capsys.readouterr()
    assert told.out == "" and "\n" not in told.err


def count_events(clip):
    return len(ef.analyze(clip, quality="draft", bottom_up=True).all_events)


def test_clips_and_runs_go_to_other_processes():
    clip = ef.open(bars(8), fps=10)
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        assert pool.apply(count_events, (clip,)) == count_events(clip)
