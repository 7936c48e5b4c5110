#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the commands of docs/tutorial.md, its fenced `sh` blocks, one after another in an empty folder, and checks that the
files it speaks of are there.   tutorial_test.py PROGRAM
"""
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

PAGE = Path(__file__).resolve().parents[2] / "docs/tutorial.md"


def main():
    program = Path(sys.argv[1]).resolve()
    text = PAGE.read_text()
    blocks = re.findall(r"^```sh\n(.*?)^```$", text, flags=re.M | re.S)
    if not blocks:
        print("docs/tutorial.md has no sh blocks", file=sys.stderr)
        return 1
    environment = dict(os.environ, PATH=f"{program.parent}:{os.environ['PATH']}")
    with tempfile.TemporaryDirectory() as folder:
        for block in blocks:
            print(block, end="", flush=True)
            run = subprocess.run(["bash", "-euo", "pipefail", "-c", block], cwd=folder, env=environment)
            if run.returncode:
                print(f"docs/tutorial.md: failed with {run.returncode}:\n{block}", file=sys.stderr)
                return 1
        named = set(re.findall(r"`(out/[\w./]+)`", re.sub(r"^```.*?^```$", "", text, flags=re.M | re.S)))
        missing = sorted(name for name in named if not (Path(folder) / name).exists())
        if missing or not named:
            print(f"docs/tutorial.md names what no command wrote: {missing}", file=sys.stderr)
            return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
