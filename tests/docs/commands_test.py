#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks that docs/commands.md has every command, and that the help it prints is that of the program.

commands_test.py PROGRAM [--write]      --write puts the program's help in
"""
import re
import subprocess
import sys
from pathlib import Path

PAGE = Path(__file__).resolve().parents[2] / "docs/commands.md"
BLOCK = re.compile(r"(<!-- emberfold ([\w -]+) -->\n```text\n)(.*?)(^```$)", re.M | re.S)


def printed(program, arguments):
    run = subprocess.run([program, *arguments.split()], capture_output=True, text=True, check=True)
    return run.stdout.rstrip("\n") + "\n"


def main():
    program, text = Path(sys.argv[1]).resolve(), PAGE.read_text()
    fresh = BLOCK.sub(lambda m: m[1] + printed(program, m[2]) + m[4], text)
    if "--write" in sys.argv:
        PAGE.write_text(fresh)
        return 0
    commands = re.findall(r"^  ([a-z][\w-]+)  ", printed(program, "--help"), flags=re.M)
    missing = [c for c in commands if c != "help" and f"<!-- emberfold {c} --help -->" not in text]
    if fresh != text:
        print(f"docs/commands.md has another help than the program: {sys.argv[0]} {program} --write", file=sys.stderr)
    if missing or not commands:
        print(f"docs/commands.md lacks the help of {missing}", file=sys.stderr)
    return 1 if fresh != text or missing or not commands else 0


if __name__ == "__main__":
    sys.exit(main())
