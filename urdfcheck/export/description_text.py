"""The text of a model as a launch file gets it: what xacro prints, or the file as it is."""

from __future__ import annotations

from dataclasses import replace

from urdfcheck.core import Location
from urdfcheck.source.load import Source

# How xacro's command line indents.
_INDENT = "  "


def render_output(source: Source, *, by_xacro: bool) -> str | None:
    """Return what ``xacro FILE`` prints, or ``cat FILE``; None if xacro fails."""
    if not by_xacro:
        file = source.files.get(source.name)
        return None if file is None else file.text
    document = source.document
    if document is None:
        from urdfcheck.source.xacro.expand import expand_xacro  # what was expanded in this run is there

        document = expand_xacro(
            source.path, source.arguments, source.finder, extra_environment=source.environment
        ).document
    return None if document is None else document.toprettyxml(indent=_INDENT)


def locate_output(source: Source, text: str, offset: int) -> Location | None:
    """Return where the line of xacro's output around an offset was typed; None where it was computed, or typed nowhere.

    ``text``: what `render_output` returned.
    """
    begin = text.rfind("\n", 0, offset) + 1
    end = text.find("\n", offset)
    line = text[begin : len(text) if end < 0 else end]
    wanted = line.strip()
    inside = offset - begin - (len(line) - len(line.lstrip()))
    for file in source.files.values():
        if file.text == text:
            return replace(source.file_location, span=file.make_span(offset, offset + 1))
        place = file.text.find(wanted)
        if place >= 0:
            at = place + max(inside, 0)
            return replace(source.file_location, span=file.make_span(at, min(at + 1, len(file.text))))
    return None
