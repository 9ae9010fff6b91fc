"""Renderers: each module has ``render(run) -> str`` and sees a Run, never a Model."""

from __future__ import annotations

import importlib

from urdfcheck.core import Run

FORMATS = ("text", "json", "html")


def render(run: Run, output_format: str) -> str:
    """The run in a format of :data:`FORMATS`; the module is imported when it is asked for."""
    rendered: str = importlib.import_module(f"urdfcheck.output.{output_format}").render(run)
    return rendered
