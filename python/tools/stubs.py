#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the type stubs of emberfold._native, read off its signatures.

    stubs.py FOLDER OUTPUT      FOLDER holds the package emberfold
"""
import importlib
import inspect
import re
import sys
from pathlib import Path

HEAD = '''"""Types of the compiled part of emberfold, written by the build."""
from typing import Any, ClassVar, Dict, Iterable, List, Optional, Tuple, Union

import numpy

'''


def without_types(text):
    """Takes the types and shapes out of numpy.ndarray[…], which are pybind11's own notation."""
    start = text.find("numpy.ndarray[")
    if start < 0:
        return text
    at, depth = start + len("numpy.ndarray["), 1
    while depth:
        depth += {"[": 1, "]": -1}.get(text[at], 0)
        at += 1
    return text[:start] + "numpy.ndarray" + without_types(text[at:])


def plain(text):
    """A signature of pybind11 as Python: names without modules, arrays as arrays, defaults as `...`."""
    text = text.replace("emberfold._native.", "")
    text = without_types(text)
    text = re.sub(r"\bnumpy\.dtype\b", "numpy.dtype[Any]", text)
    text = re.sub(r"\b(object|handle)\b", "Any", text)
    text = re.sub(r"\*\*kwargs", "**kwargs: Any", text)
    return re.sub(r" = (?:<[^>]*>|[^,()<>\[\]]+(?:\([^()]*(?:\([^()]*\)[^()]*)*\))?)", " = ...", text)


def signature(function, name):
    found = re.match(rf"{re.escape(name)}(\(.*\)) -> (.+)", (inspect.getdoc(function) or "").splitlines()[0])
    if not found:
        return "(*args: Any, **kwargs: Any) -> Any"
    return plain(f"{found.group(1)} -> {found.group(2)}")


def properties(name, member):
    getter = inspect.getdoc(member.fget) or ""
    kind = re.search(r"-> (.+)", getter.splitlines()[0] if getter else "")
    kind = plain(kind.group(1)) if kind else "Any"
    yield f"    @property\n    def {name}(self) -> {kind}: ..."
    if member.fset:
        yield f"    @{name}.setter\n    def {name}(self, value: Any) -> None: ..."


def members(kind):
    for name, member in sorted(vars(kind).items()):
        if isinstance(member, property):
            yield from properties(name, member)
        elif isinstance(member, staticmethod):
            yield f"    @staticmethod\n    def {name}{signature(member.__func__, name)}: ..."
        elif name == "__init__" and "FIELDS" in vars(kind):
            yield "    def __init__(self, **fields: Any) -> None: ..."
        elif inspect.isroutine(member) and (name == "__init__" or not name.startswith("_")):
            yield f"    def {name}{signature(member, name)}: ..."
        elif not name.startswith("_"):
            yield f"    {name}: ClassVar[Any]"


def main():
    sys.path.insert(0, sys.argv[1])
    # The package itself needs pandas and networkx; the compiled part alone does not.
    package = type(sys)("emberfold")
    package.__path__ = [str(Path(sys.argv[1]) / "emberfold")]
    sys.modules["emberfold"] = package
    module = importlib.import_module("emberfold._native")
    lines = []
    for name, member in sorted(vars(module).items()):
        if inspect.isclass(member):
            base = member.__bases__[0].__name__
            body = list(members(member)) if not issubclass(member, BaseException) else []
            lines.append(f"class {name}{'' if base in ('object', 'pybind11_object') else f'({base})'}:")
            lines += body or ["    ..."]
        elif inspect.isroutine(member):
            lines.append(f"def {name}{signature(member, name)}: ...")
        elif not name.startswith("_"):
            lines.append(f"{name}: {type(member).__name__ if isinstance(member, (int, str)) else 'Any'}")
    Path(sys.argv[2]).write_text(HEAD + "\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
