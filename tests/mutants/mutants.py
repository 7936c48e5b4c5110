#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Does the work of scripts/test-mutants: puts the faults of tests/mutants/faults.txt into a copy of the sources, each
behind a switch that is set at run time, builds the tests there, and looks whether the test that each fault names fails.

In the table each file is followed by its faults, a line each: BEFORE «ORIGINAL => FAULTY» AFTER | TEST. The original,
with what stands before and after it, is in the file once; white space does not count, so that the code may be laid out
anew. Original and faulty text are expressions or, where the original ends with a semicolon, statements. TEST is of the
room's program and must catch the fault."""
import argparse
import concurrent.futures
import os
import re
import shutil
import signal
import subprocess
import sys
import time
import zlib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
HERE = Path(__file__).resolve().parent
WORK = ROOT / "build" / "mutants"
COPY, BUILD = WORK / "source", WORK / "build"
SWITCH = HERE / "emberfold_fault.hpp"
CONFIGURE = ["-G", "Ninja", "-DCMAKE_BUILD_TYPE=RelWithDebInfo",
             "-DCMAKE_CXX_FLAGS_RELWITHDEBINFO=-O1 -D_GLIBCXX_ASSERTIONS", "-DCMAKE_CXX_FLAGS=-w",
             "-DEMBERFOLD_APPS=OFF", "-DEMBERFOLD_INSTALL=OFF",
             f"-DCMAKE_CXX_COMPILER={shutil.which('clang++') or 'c++'}"]
LONGEST = 60  # s, of a test with a fault; one that takes longer has caught it
QUICK = 10  # s, of a test without


class Wrong(Exception):
    """What a person has to mend: the table, the code or a test."""


def read_faults():
    faults, file = [], ""
    for number, line in enumerate((HERE / "faults.txt").read_text().splitlines(), 1):
        if not line.startswith(" "):
            file = line
            continue
        parts = re.fullmatch(r"  (.*?)«(.*) => (.*)»(.*) \| (.*)", line)
        if not parts:
            raise Wrong(f"faults.txt:{number}: no fault: {line.strip()}")
        before, original, faulty, after, test = parts.groups()
        faults.append({"name": f"{file}: {original} => {faulty}", "file": file, "before": before, "original": original,
                       "faulty": faulty, "after": after, "test": test, "program": f"test_{file.split('/')[0]}",
                       "number": zlib.crc32(f"{file}{line}".encode()) % 2**31})  # the same whatever others there are
    if len({fault["number"] for fault in faults}) < len(faults):
        raise Wrong("faults.txt: two faults have one number")
    return faults


def pattern(text):
    """What finds this code however its white space is laid out."""
    found = r"\s*".join(re.escape(token) for token in re.findall(r"\w+|\S", text))
    return re.sub(r"(?<=\w)\\s\*(?=\w)", r"\\s+", found)


def find_fault(fault, text):
    """Where the fault's original text begins and ends."""
    before, original, after = (pattern(fault[key]) for key in ("before", "original", "after"))
    found = list(re.finditer(rf"{before}\s*({original})\s*{after}", text))
    if len(found) != 1:
        raise Wrong(f"a fault is out of date, its original is in the file {len(found)} times, not once: {fault['name']}")
    return found[0].span(1)


def switched(fault, original):
    if original.endswith(";"):
        return f"if (emberfold_fault({fault['number']})) {{ {fault['faulty']} }} else {{ {original} }}"
    return f"(emberfold_fault({fault['number']}) ? ({fault['faulty']}) : ({original}))"


def with_faults(text, faults):
    """The text with all of the file's faults in it."""
    places = sorted(((*find_fault(fault, text), fault) for fault in faults), key=lambda place: place[:2])
    for (_, end, one), (begin, _, other) in zip(places, places[1:]):
        if begin < end:
            raise Wrong(f"faults overlap: {one['name']} and {other['name']}")
    for begin, end, fault in reversed(places):
        text = text[:begin] + switched(fault, text[begin:end]) + text[end:]
    # On the line of the licence, so that all others keep their numbers.
    return f'#include "tests/mutants/{SWITCH.name}"  {text}'


def texts_with_faults(faults):
    """The text of each file that has faults, with these in it."""
    of_file = {}
    for fault in faults:
        of_file.setdefault(fault["file"], []).append(fault)
    texts = {}
    for file, there in of_file.items():
        if not (ROOT / file).is_file():
            raise Wrong(f"faults.txt: there is no {file}")
        texts[file] = with_faults((ROOT / file).read_text(), there)
    return texts


def make_copy(faults):
    """Writes what differs only, so that what is built from the rest stays."""
    listed = subprocess.run(["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"], cwd=ROOT,
                            stdout=subprocess.PIPE, check=True).stdout.decode().split("\0")
    wanted = {path for path in listed if path and (ROOT / path).is_file()}
    contents = {path: (ROOT / path).read_bytes() for path in wanted}
    contents |= {file: text.encode() for file, text in texts_with_faults(faults).items()}
    for path in COPY.rglob("*"):
        if path.is_file() and str(path.relative_to(COPY)) not in wanted:
            path.unlink()
    for path, content in contents.items():
        target = COPY / path
        if not target.is_file() or target.read_bytes() != content:
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(content)
            target.chmod((ROOT / path).stat().st_mode)


def build(programs, jobs):
    print(f"== building {', '.join(programs)} with all faults, each of them off, in {BUILD}", flush=True)
    configured = subprocess.run(["cmake", "-S", COPY, "-B", BUILD, *CONFIGURE], stdout=subprocess.PIPE,
                                stderr=subprocess.STDOUT, text=True)
    if configured.returncode:
        raise Wrong(configured.stdout + "the copy with the faults cannot be configured")
    if subprocess.run(["cmake", "--build", BUILD, "--parallel", str(jobs), "--target", *programs]).returncode:
        raise Wrong("the copy with the faults cannot be built")


def program_path(program):
    return BUILD / "tests" / program.removeprefix("test_") / program


def listed_tests(program, *filters):
    command = [program_path(program), *filters, "--list-test-names-only"]
    out = subprocess.run(command, stdout=subprocess.PIPE, text=True).stdout  # it exits with their number
    return {line.strip() for line in out.splitlines()}


def check_tests(faults):
    for program in sorted({fault["program"] for fault in faults}):
        names, slow = listed_tests(program), listed_tests(program, "[slow]")
        for fault in faults:
            if fault["program"] == program and fault["test"] not in names:
                raise Wrong(f"the fault {fault['name']} needs a test that {program} does not have: {fault['test']}")
            if fault["program"] == program and fault["test"] in slow:
                raise Wrong(f"the fault {fault['name']} needs a test that is slow: {fault['test']}")


def run_test(program, test, number):
    """Runs one test with one fault, or with none (number 0). Returns what became of it, and the seconds it took."""
    command = [program_path(program), re.sub(r'([\\,\[\]"])', r"\\\1", test)]
    began = time.monotonic()
    process = subprocess.Popen(command, cwd=command[0].parent, env={**os.environ, "EMBERFOLD_FAULT": str(number)},
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
    try:
        code = process.wait(LONGEST)
        outcome = "passed" if code == 0 else "failed" if code > 0 else "crashed"
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        outcome = "took too long"
    return outcome, time.monotonic() - began


def run_sound(faults, pool):
    """Every test has to pass, and soon, where there is no fault."""
    tests = sorted({(fault["program"], fault["test"]) for fault in faults})
    print(f"== {len(tests)} tests without a fault", flush=True)
    wrong = []
    for (program, test), (outcome, seconds) in zip(tests, pool.map(lambda test: run_test(*test, 0), tests)):
        if outcome != "passed":
            wrong.append(f"{program}, {test}: {outcome}")
        elif seconds > QUICK:
            print(f"   not quick, {seconds:.0f} s: {program}, {test}", flush=True)
    if wrong:
        raise Wrong("tests that do not pass without any fault:\n" + "\n".join(wrong))


def run_faults(faults, pool):
    """Prints a line for each fault. Returns the names of those that no test noticed."""
    print(f"== {len(faults)} faults, each with its test", flush=True)
    survivors = []
    results = pool.map(lambda fault: run_test(fault["program"], fault["test"], fault["number"]), faults)
    for fault, (outcome, seconds) in zip(faults, results):
        caught = {"passed": "SURVIVED", "failed": "caught"}.get(outcome, f"caught ({outcome})")
        print(f"{caught:22s} {seconds:5.1f} s  {fault['name']}  | {fault['test']}", flush=True)
        if outcome == "passed":
            survivors.append(fault["name"])
    return survivors


def select(faults, texts):
    for text in texts:
        if not any(text in fault["name"] or text in fault["test"] for fault in faults):
            raise Wrong(f"no fault or test has the text {text}; --list shows them")
    return [f for f in faults if not texts or any(text in f["name"] or text in f["test"] for text in texts)]


def main():
    parser = argparse.ArgumentParser(prog="scripts/test-mutants", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter,
                                     epilog="Exits 0 where every fault is caught.")
    parser.add_argument("--only", metavar="TEXT", action="append", default=[],
                        help="faults whose file, code or test has this text (can be repeated)")
    parser.add_argument("--list", action="store_true",
                        help="tells the faults, their files and tests, and whether they fit the code; runs nothing")
    parser.add_argument("--jobs", metavar="N", type=int, default=os.cpu_count(),
                        help="how many sources are compiled, and tests run, at once; as many as there are processors")
    asked = parser.parse_args()
    began = time.monotonic()
    faults = read_faults()
    chosen = select(faults, asked.only)
    if asked.list:
        texts_with_faults(faults)
        for fault in chosen:
            print(f"{fault['name']}  | {fault['test']}")
        return 0
    make_copy(faults)
    build(sorted({fault["program"] for fault in chosen}), asked.jobs)
    built = time.monotonic()
    check_tests(chosen)
    with concurrent.futures.ThreadPoolExecutor(asked.jobs) as pool:
        run_sound(chosen, pool)
        survivors = run_faults(chosen, pool)
    print(f"{len(chosen) - len(survivors)} of {len(chosen)} faults caught; {(built - began) / 60:.0f} min to build, "
          f"{(time.monotonic() - built) / 60:.1f} min to run")
    for name in survivors:
        print(f"SURVIVED: {name}")
    return 1 if survivors else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except Wrong as wrong:
        sys.exit(f"scripts/test-mutants: {wrong}")
