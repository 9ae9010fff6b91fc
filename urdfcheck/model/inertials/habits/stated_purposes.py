"""Inertials of which a comment beside them says what they are for: their numbers were chosen, and are not a slip."""

from __future__ import annotations

import re

from urdfcheck.model.parts import Link
from urdfcheck.model.robot import Model

_COMMENT = re.compile(r"<!--(.*?)-->", re.DOTALL)
# A comment that ends where the element begins.
_COMMENT_BEFORE = re.compile(r"<!--((?:(?!-->).)*)-->\s*\Z", re.DOTALL)
# How far before an element its comment begins, at most (characters).
_REACH = 600
# Words that give a reason for the numbers. That they are dummies is none, for they may still have to be replaced; nor is that an
# inertial is needed, whatever it says.
_REASON = re.compile(
    r"stabili|unstab|instab|avoid|prevent|\bhack|\bnon-?\s?zero|\bpruned|bolt(?:ed|ing) down|\bon purpose|intentional|deliberate"
    r"|\b(?:null|minimal|smallest)(?: valid)? inerti",
    re.IGNORECASE,
)


def has_stated_purpose(model: Model, link: Link) -> bool:
    """Whether a comment in the ``<inertial>`` of a link, or right before it, says why its numbers are what they are."""
    span = None if link.inertial is None else link.inertial.element.span
    file = None if span is None else model.source.files.get(span.file)
    if span is None or file is None:
        return False
    end = max(file.text.find("</inertial", span.start), span.start)
    comments = _COMMENT.findall(file.text, span.start, end)
    before = _COMMENT_BEFORE.search(file.text[max(0, span.start - _REACH) : span.start])
    return any(map(_REASON.search, comments if before is None else [*comments, before[1]]))
