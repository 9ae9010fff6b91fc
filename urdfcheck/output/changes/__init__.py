"""Renderers of ``urdfcheck diff``: each module has ``render(diff) -> str`` and sees a `Diff`, never a model."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from urdfcheck.core.model_diff import Diff

FORMATS = ("text", "json", "markdown", "html", "github")
# A picture can only be written to a file.
PICTURE_FORMAT = "png"
# Formats that draw something: they need the scenes of both checks.
DRAWING_FORMATS = frozenset({"html", PICTURE_FORMAT})


def render(diff: Diff, output_format: str) -> str:
    """Render a comparison in a format of :data:`FORMATS`, whose module is imported only now."""
    rendered: str = importlib.import_module(f"urdfcheck.output.changes.{output_format}").render(diff)
    return rendered


def render_picture(diff: Diff) -> bytes:
    """Render both versions of one model as a :data:`PICTURE_FORMAT`; empty where there is nothing to draw."""
    from urdfcheck.output.changes.png import render as draw

    return draw(diff)
