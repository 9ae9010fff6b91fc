"""Severities as shapes and words: never by colour alone, and legible without the style."""

from __future__ import annotations

from collections.abc import Mapping

from urdfcheck.core import Severity
from urdfcheck.output.shared.wording import SEVERITY_ORDER

# Drawn once; the fill is the text colour and the sign is cut out of it, so one drawing suits every background.
SYMBOLS = (
    '<svg width="0" height="0" class="symbols" aria-hidden="true" focusable="false"><defs>'
    '<symbol id="g-error" viewBox="0 0 16 16"><path fill="currentColor" fill-rule="evenodd" d="M5 .8h6L15.2 5v6L11 15.2H5'
    "L.8 11V5zM5.2 4.1 4.1 5.2 6.9 8l-2.8 2.8 1.1 1.1L8 9.1l2.8 2.8 1.1-1.1L9.1 8l2.8-2.8-1.1-1.1L8 6.9z"
    '"/></symbol>'
    '<symbol id="g-warning" viewBox="0 0 16 16"><path fill="currentColor" fill-rule="evenodd" d="M8 1q.7 0 1.1.7l6.3 11.2'
    'q.3.6 0 1.2t-1.1.6H1.7q-.8 0-1.1-.6t0-1.2L6.9 1.7Q7.3 1 8 1zM7.1 5.4v4.4h1.8V5.4zM7.1 11.2V13h1.8v-1.8z"/></symbol>'
    '<symbol id="g-info" viewBox="0 0 16 16"><path fill="currentColor" fill-rule="evenodd" d="M8 .7a7.3 7.3 0 1 0 0 14.6'
    'A7.3 7.3 0 0 0 8 .7zM7.1 6.9v4.9h1.8V6.9zM7.1 4v1.8h1.8V4z"/></symbol>'
    '<symbol id="g-ok" viewBox="0 0 16 16"><path fill="currentColor" fill-rule="evenodd" d="M8 .7a7.3 7.3 0 1 0 0 14.6'
    'A7.3 7.3 0 0 0 8 .7zM11.5 4.6 7 9.2 4.6 6.8 3.4 8 7 11.6l5.7-5.8z"/></symbol>'
    '<symbol id="g-unchecked" viewBox="0 0 16 16"><path fill="currentColor" fill-rule="evenodd" d="M8 .7a7.3 7.3 0 1 0 0 14.6'
    'A7.3 7.3 0 0 0 8 .7zM11.4 3.4 3.4 11.4l1.2 1.2 8-8z"/></symbol>'
    "</defs></svg>"
)


def render_glyph(kind: Severity | str) -> str:
    """Render the glyph of a severity, of ``ok`` or of ``unchecked``."""
    return (
        f'<svg class="glyph" width="16" height="16" aria-hidden="true" focusable="false"><use href="#g-{kind}"/></svg>'
    )


def render_badges(counts: Mapping[Severity, int], *, is_checked: bool = True, is_set_aside: bool = False) -> str:
    """Render a count for each severity that occurs, with its glyph and, for screen readers, its word.

    What was not checked has a sign of its own in front, and so has a model whose errors and warnings are not listed
    (``is_set_aside``).
    """
    badges = [_render_badge(severity, counts[severity]) for severity in SEVERITY_ORDER if counts.get(severity)]
    if not is_checked:
        badges.insert(0, _render_sign("unchecked", "not checked"))
    elif is_set_aside:
        badges.insert(0, ' <span class="badge unchecked">set aside</span>')
    return "".join(badges) or _render_sign("ok", "no findings")


def _render_sign(kind: str, words: str) -> str:
    return f' <span class="badge {kind}">{render_glyph(kind)}<span class="sr"> {words} </span></span>'


def _render_badge(severity: Severity, count: int) -> str:
    word = f'<span class="sr"> {pluralize_severity(count, severity)} </span>'
    return f' <span class="badge {severity}">{render_glyph(severity)} {count}{word}</span>'


def pluralize_severity(count: int, severity: Severity) -> str:
    """Return ``error`` or ``errors``; information is a ``note``."""
    word = "note" if severity == Severity.INFO else str(severity)
    return word if count == 1 else f"{word}s"
