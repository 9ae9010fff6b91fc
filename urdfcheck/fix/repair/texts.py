"""Places in the text of a model that a repair rewrites."""

from __future__ import annotations

from collections.abc import Sequence

from urdfcheck.core import Edit, Span
from urdfcheck.facts.arrays import Array
from urdfcheck.facts.motion.kinematics import matrix_to_rpy
from urdfcheck.model import Model
from urdfcheck.source.text.tokens import find_element_span
from urdfcheck.source.text.xml import Attribute, Element

_DIGITS = 6
# Metres or radians that a product of transforms leaves of a zero.
_ROUNDING = 1e-9


def write_numbers(values: Sequence[float], digits: int = _DIGITS, *, noise: float = 0.0) -> str:
    """Write numbers for an attribute; up to ``noise`` they are zero."""
    return " ".join(f"{0.0 if abs(value) <= noise else value:.{digits}g}" for value in values)


def write_origin(pose: Array) -> str:
    """Write an ``<origin>`` for a (4, 4) pose; empty for the identity."""
    xyz = write_numbers(pose[:3, 3].tolist(), noise=_ROUNDING)
    rpy = write_numbers(matrix_to_rpy(pose[:3, :3]), 9, noise=_ROUNDING)
    place = "" if xyz == "0 0 0" else f' xyz="{xyz}"'
    turn = "" if rpy == "0 0 0" else f' rpy="{rpy}"'
    return f"<origin{place}{turn}/>" if place or turn else ""


class ElementText:
    """The text of one element, and replacements of what is typed inside it."""

    def __init__(self, model: Model, element: Element) -> None:
        self.files = model.source.files
        self.element = element
        self.span: Span | None = find_element_span(element, self.files)
        self.changes: list[tuple[int, int, str]] = []

    @property
    def text(self) -> str:
        """The text with the replacements."""
        if self.span is None:
            return ""
        whole, at, pieces = self.files[self.span.file].text, self.span.start, []
        for start, end, new in sorted(self.changes):
            pieces += [whole[at:start], new]
            at = end
        return "".join((*pieces, whole[at : self.span.end]))

    def replace_element(self, element: Element, text: str) -> bool:
        """Replace an element inside this one; False if it was typed elsewhere."""
        return self._replace(find_element_span(element, self.files), text)

    def replace_value(self, attribute: Attribute, text: str) -> bool:
        """Replace the value of an attribute inside this element; False if it was typed elsewhere."""
        return self._replace(attribute.span, text)

    def insert_before(self, element: Element, text: str) -> bool:
        """Insert text before an element inside this one; False if it was typed elsewhere."""
        span = find_element_span(element, self.files)
        if span is None or not self._contains(span):
            return False
        self.changes.append((span.start, span.start, text))
        return True

    def build_edit(self, text: str) -> Edit | None:
        """Return the edit that replaces the whole element by ``text``."""
        if self.span is None:
            return None
        whole = self.files[self.span.file].text
        return Edit(self.span, whole[self.span.start : self.span.end], text)

    def _replace(self, span: Span | None, text: str) -> bool:
        if span is None or not self._contains(span):
            return False
        self.changes.append((span.start, span.end, text))
        return True

    def _contains(self, span: Span) -> bool:
        own = self.span
        return own is not None and own.file == span.file and own.start <= span.start and span.end <= own.end
