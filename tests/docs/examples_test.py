#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the commands that README.md and docs/commands.md show with what they print, and checks that they print it: the
lines that are shown, in this order.   examples_test.py PROGRAM

Words must be the same; numbers may be off by 15 %, whole ones at least by 2, others by .15, as other processors round differently.
"""
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
EXAMPLE = re.compile(r"^    \$ (emberfold [^\n]*)\n((?:    (?!\$ )[^\n]*\n|\n(?=    (?!\$ )))+)", re.M)
NUMBER = re.compile(r"-?\d+(?:\.\d+)?")
TIME = re.compile(r"about [\d.]+ (?:s|min)")  # of the machine, not of the program


def near(shown, printed):
    a, b = float(shown), float(printed)
    return abs(a - b) <= max(0.15 * abs(a), 0.15 if "." in shown else 2)


def same(shown, printed):
    shown, printed = TIME.sub("", shown), TIME.sub("", printed)
    words = [NUMBER.sub("#", line).split() for line in (shown, printed)]
    return words[0] == words[1] and all(map(near, NUMBER.findall(shown), NUMBER.findall(printed)))


def not_printed(shown, printed):
    """Gives the first shown line that the printed lines lack after those before it."""
    rest = iter(printed.split("\n"))
    return next((line for line in shown.split("\n") if line.strip(" …") and not any(same(line, other) for other in rest)), None)


def main():
    program = Path(sys.argv[1]).resolve()
    examples = [(page, *found) for page in ("README.md", "docs/commands.md")
                for found in EXAMPLE.findall((ROOT / page).read_text())]
    examples.sort(key=lambda example: example[1] != "emberfold demo")  # others read what it makes
    runs, wrong = {}, 0 if examples else 1
    with tempfile.TemporaryDirectory() as folder:
        for page, command, shown in examples:
            if command not in runs:
                print(command, flush=True)
                runs[command] = subprocess.run([program, *command.split()[1:]], cwd=folder, stdout=subprocess.PIPE,
                                               stderr=subprocess.STDOUT, text=True)
            run = runs[command]
            line = not_printed(shown, run.stdout)
            if run.returncode or line:
                wrong += 1
                print(f"{page}: {command}: exit {run.returncode}; not printed: {line}\nprinted:\n{run.stdout}", file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
