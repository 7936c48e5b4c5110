# SPDX-License-Identifier: Apache-2.0
"""The interpreter that the build chooses, and what it says of one that lacks something."""
import os
import shutil
import subprocess
import sys
import venv
from pathlib import Path

import pytest

pytestmark = pytest.mark.skipif(shutil.which("cmake") is None, reason="cmake is not installed")
MODULE = Path(__file__).parents[2] / "cmake/python_interpreter.cmake"


@pytest.fixture(scope="module")
def bare(tmp_path_factory):
    """An interpreter without any package."""
    folder = tmp_path_factory.mktemp("bare")
    venv.create(folder, with_pip=False, symlinks=True)
    return folder / "bin"


def choose(tmp_path, path, *, build="numpy", tests="pytest", given=None):
    """The interpreter that is chosen, and all that cmake says."""
    script = tmp_path / "choose.cmake"
    script.write_text(f'include("{MODULE}")\nemberfold_choose_python("{build}" "{tests}" chosen)\nmessage("chosen: ${{chosen}}")\n')
    words = ["cmake"] + ([f"-DPython3_EXECUTABLE={given}"] if given else []) + ["-P", str(script)]
    environment = {**os.environ, "PATH": os.pathsep.join([*map(str, path), os.environ["PATH"]])}
    told = subprocess.run(words, env=environment, capture_output=True, text=True)
    text = " ".join(told.stderr.split())
    return (text.split("chosen: ")[1].split()[0] if told.returncode == 0 else None), text


def test_an_interpreter_that_lacks_numpy_is_passed_over(tmp_path, bare):
    chosen, told = choose(tmp_path, [bare])
    assert chosen and Path(chosen).parent != bare and "lacks" not in told
    found = subprocess.run([chosen, "-c", "import numpy, pytest"], check=False)
    assert found.returncode == 0


def test_a_given_interpreter_that_lacks_numpy_is_refused_before_anything_is_built(tmp_path, bare):
    chosen, told = choose(tmp_path, [], given=bare / "python3")
    assert chosen is None
    assert f"the interpreter {bare / 'python3'} lacks numpy" in told
    better = told.split("-DPython3_EXECUTABLE=")[1].split()[0]
    assert subprocess.run([better, "-c", "import numpy"], check=False).returncode == 0


def test_what_the_tests_alone_need_is_a_warning(tmp_path):
    chosen, told = choose(tmp_path, [], tests="no_such_package", given=sys.executable)
    assert chosen and "lacks no_such_package" in told and "python: package" in told


def test_an_interpreter_that_does_not_run_is_named(tmp_path):
    chosen, told = choose(tmp_path, [], given=tmp_path / "none")
    assert chosen is None and f"{tmp_path / 'none'} does not run" in told
