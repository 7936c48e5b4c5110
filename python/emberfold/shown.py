# SPDX-License-Identifier: Apache-2.0
"""Pictures and tables in notebooks of the classes of the compiled part."""
from __future__ import annotations

from typing import Any

from . import _native


def _show_model(self: Any) -> Any:
    """Draws where strokes are born and die; returns the figure."""
    from . import plot
    return plot.model(self)


def _show_texture(self: Any) -> Any:
    """Draws the mean image and the components of most variance; returns the figure."""
    from . import plot
    return plot.texture(self)


def _html_model(self: Any) -> str:
    from . import html
    return html.model(self)


def _html_texture(self: Any) -> str:
    from . import html
    return html.texture(self)


def show_compiled() -> None:
    """Gives the classes show() and what notebooks display."""
    _native.ClipModel.show, _native.ClipModel._repr_html_ = _show_model, _html_model
    _native.LinearDynamicTexture.show, _native.LinearDynamicTexture._repr_html_ = _show_texture, _html_texture
