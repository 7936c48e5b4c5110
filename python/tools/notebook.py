#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the code cells of a notebook, where there is no Jupyter.

    notebook.py FILE            runs them; fails where one does
    notebook.py FILE --write    and stores what they show in the notebook
"""
import ast
import base64
import contextlib
import io
import json
import sys
import warnings
from pathlib import Path


def run(source, space):
    """Runs a cell; returns the value of its last line, if that is an expression, and what was printed."""
    tree = ast.parse(source)
    last = ast.Expression(tree.body.pop().value) if tree.body and isinstance(tree.body[-1], ast.Expr) else None
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile(tree, "<cell>", "exec"), space)
        value = eval(compile(last, "<cell>", "eval"), space) if last else None
    return value, printed.getvalue()


def picture(figure):
    out = io.BytesIO()
    figure.savefig(out, format="png", dpi=70, metadata={"Software": None})
    return base64.b64encode(out.getvalue()).decode()


def outputs(value, printed, count):
    shown = [{"output_type": "stream", "name": "stdout", "text": printed.splitlines(True)}] if printed else []
    if value is None or source_is_silent(value):
        return shown
    data = {"text/plain": repr(value).splitlines(True)}
    if hasattr(value, "savefig"):
        data = {"text/plain": ["<Figure>"], "image/png": picture(value)}
    elif hasattr(value, "_repr_html_"):
        data["text/html"] = value._repr_html_().splitlines(True)
    return shown + [{"output_type": "execute_result", "execution_count": count, "metadata": {}, "data": data}]


def source_is_silent(value):
    """Drawing functions of matplotlib return lists of what they drew, which nobody wants to see."""
    return isinstance(value, list) and bool(value) and type(value[0]).__module__.startswith("matplotlib")


def main():
    path = Path(sys.argv[1])
    notebook = json.loads(path.read_text(encoding="utf-8"))
    space = {"__name__": "__main__"}
    warnings.simplefilter("ignore")
    for count, cell in enumerate((c for c in notebook["cells"] if c["cell_type"] == "code"), 1):
        value, printed = run("".join(cell["source"]), space)
        cell["execution_count"], cell["outputs"] = count, outputs(value, printed, count)
    if "--write" in sys.argv[2:]:
        path.write_text(json.dumps(notebook, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
