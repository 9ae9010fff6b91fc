"""The formula of a box of which one moment was copied to another and not changed."""

from __future__ import annotations

import re

from urdfcheck.model.parts import TENSOR_NAMES, DeclaredTensor
from urdfcheck.source.text.handed_values import EXPRESSION

# Where ixx, iyy and izz are in ``ixx ixy ixz iyy iyz izz``, with the axis of each.
_DIAGONAL = ((0, "x"), (3, "y"), (5, "z"))
_SQUARE = re.compile(r"\b([A-Za-z_]\w*)\s*\)?\s*(?:\*\s*\(?\s*\1\b(?!\s*\*\*)|\*\*\s*2\b)")


def describe_repeated_formula(declared: DeclaredTensor) -> str:
    """Describe the repair of a box's tensor two of whose moments are one expression; empty where the typed texts show none.

    Each moment of a box is the sum of two squared lengths, and lacks the third: ``m*(y*y+z*z)/12``. Two moments of a cylinder or
    a rod are equal by right, but not with the lengths of a box.
    """
    texts = [_normalize(declared.get_attribute(index).typed) for index, _ in _DIAGONAL]
    squares = [frozenset(_SQUARE.findall(text)) for text in texts]
    names = frozenset[str]().union(*squares)
    if len(set(texts)) != 2 or len(names) != 3 or any(len(pair) != 2 for pair in squares):
        return ""
    odd = next(i for i in range(3) if texts.count(texts[i]) == 1)
    same = [i for i in range(3) if i != odd]
    length = next(iter(squares[odd] & squares[same[0]]))
    needed = " and ".join(sorted(names - {length}))
    # The moment about an axis lacks the length along it: lengths may have the axes' names.
    wrong = [i for i in same if _DIAGONAL[i][1] in squares[i]]
    moments = [TENSOR_NAMES[_DIAGONAL[i][0]] for i in same]
    if len(wrong) == 1:
        moment = TENSOR_NAMES[_DIAGONAL[wrong[0]][0]]
        other = next(name for name in moments if name != moment)
        return f"correct the formula of {moment}: it repeats that of {other}, but that of a box squares {needed}"
    return f"correct the formula of {moments[0]} or {moments[1]}: they are the same, but one of a box squares {needed}"


def _normalize(typed: str) -> str:
    """Return the expression of a text without blanks; empty where the text is something else."""
    match = EXPRESSION.fullmatch(typed.strip())
    return "" if match is None else re.sub(r"\s+", "", match[1] or match[2])
