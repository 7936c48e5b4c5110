#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the comments of C++ headers as a Python module, so that docstrings are not written twice.

    docstrings.py OUTPUT FOLDER...

OUTPUT then holds TEXTS, a dict: "sketch::ExtractOptions::spacing" to its comment. Of functions of one name the first counts.
"""
import re
import sys
from pathlib import Path

TYPE = re.compile(r"^(?:struct|class|enum class|enum)\s+(\w+)")
FORWARD = re.compile(r"^\s*(?:struct|class|enum class|enum)\s+(\w+);")
FUNCTION = re.compile(r"^[\w:<>,&*\s\[\]]*?\b(\w+)\(")
FIELD = re.compile(r"^\s+[\w:<>,\s]+?[\s>&*](\w+)(?:\{[^}]*\})?(?:\s*=[^;]*)?(?:,\s*\w+(?:\s*=[^;,]*)?)*;")


def statements(lines):
    """Pairs of a comment and the declaration it belongs to, on one line each, with its trailing comment added."""
    comment, code = [], ""
    for number, line in enumerate(lines):
        text = line.strip()
        if not text or text.startswith("#") or re.match(r"//(?!/)", text):
            comment, code = [], ""
            continue
        if text.startswith("///<"):
            comment.append(text[4:].strip())
        elif text.startswith("///"):
            comment, code = ([] if code else comment) + [text[3:].strip()], ""
        else:
            before, mark, after = line.partition("///<")
            code = f"{code} {before.strip()}" if code else before.rstrip()
            if mark:
                comment.append(after.strip())
        follows = lines[number + 1].strip() if number + 1 < len(lines) else ""
        if re.search(r"[;{},]$", code.rstrip()) and not follows.startswith("///<") and not open_bracket(code):
            yield " ".join(comment), code
            comment, code = [], ""


def open_bracket(code):
    return code.count("(") > code.count(")")


def read(path):
    """Yields the full name of each commented declaration of a header, and its comment."""
    space, owner = "", None
    for comment, code in statements(path.read_text(encoding="utf-8").splitlines()):
        if found := re.match(r"^namespace emberfold::(\w+) \{", code):
            space = found.group(1)
        elif found := FORWARD.match(code):
            if comment and not owner:
                yield f"{space}::{found.group(1)}", comment
        elif found := TYPE.match(code.strip()) if not code.startswith(" ") else None:
            owner = f"{space}::{found.group(1)}"
            if comment:
                yield owner, comment
        elif code.startswith("}"):
            owner = None
        elif comment and owner and (found := FIELD.match(code)):
            yield f"{owner}::{found.group(1)}", comment
        elif comment and not owner and (found := FUNCTION.match(code)):
            yield f"{space}::{found.group(1)}", comment


def main():
    output, folders = Path(sys.argv[1]), [Path(name) for name in sys.argv[2:]]
    texts = {}
    for folder in folders:
        for header in sorted(folder.rglob("*.hpp")):
            for name, comment in read(header):
                texts.setdefault(name, comment)
    lines = [f"    {name!r}: {text!r},\n" for name, text in sorted(texts.items())]
    content = '"""Comments of the C++ headers, written by the build."""\nTEXTS = {\n' + "".join(lines) + "}\n"
    if not output.exists() or output.read_text(encoding="utf-8") != content:
        output.write_text(content, encoding="utf-8")


if __name__ == "__main__":
    main()
