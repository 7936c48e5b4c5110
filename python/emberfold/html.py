# SPDX-License-Identifier: Apache-2.0
"""What notebooks show of a value."""
from __future__ import annotations

import base64
import html
import io
from typing import Any, Iterable, Tuple


def _rows(rows: Iterable[Tuple[str, Any]]) -> str:
    cells = "".join(f"<tr><th>{html.escape(name)}</th><td>{html.escape(str(value))}</td></tr>" for name, value in rows)
    return f"<table>{cells}</table>"


def _picture(figure: Any) -> str:
    out = io.BytesIO()
    figure.savefig(out, format="png", bbox_inches="tight", dpi=80)
    return f'<img alt="" src="data:image/png;base64,{base64.b64encode(out.getvalue()).decode()}">'


def _draw(make: Any) -> str:
    """The picture, or nothing where matplotlib is not installed."""
    try:
        from matplotlib.figure import Figure  # noqa: F401
    except ImportError:
        return ""
    return _picture(make())


def clip(shown: Any) -> str:
    rows = [("clip", shown.name), ("shape", shown.shape), ("type", shown.dtype), ("frames a second", f"{shown.fps:g}")]
    if shown.pixel_size is not None:
        rows.append(("pixel", f"{shown.pixel_size:g} µm"))
    return _rows(rows) + _draw(lambda: shown.show())


def run(shown: Any) -> str:
    counts = shown.rates()["events"]
    rows = [("frames", shown.frames), ("events", len(shown.events)), *((name, count) for name, count in counts.items())]
    return _rows(rows) + _draw(lambda: shown.show())


def texture(shown: Any) -> str:
    rows = [("linear dynamic texture", f"{shown.width}x{shown.height}"), ("components", shown.components),
            ("noise, levels", f"{shown.r:.3g}")]
    return _rows(rows) + _draw(lambda: shown.show())


def model(shown: Any) -> str:
    motion = shown.motion
    rows = [("motion model", f"{motion.width}x{motion.height}"), ("of frames", motion.frames)]
    return _rows(rows) + _draw(lambda: shown.show())
