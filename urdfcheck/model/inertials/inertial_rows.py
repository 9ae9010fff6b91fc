"""Links of one row (``wheel_1``, ``wheel_2``, ``wheel_3``) of which one has the numbers of the others with one mistake."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.core.text import split_name_words
from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
from urdfcheck.facts.inertials.mistakes.mistake import Mistake
from urdfcheck.facts.inertials.twin_slips import find_twin_slip
from urdfcheck.model.inertials.mirrored_inertials import get_comparable_inertial
from urdfcheck.model.likeness.side_names import pair_by_name
from urdfcheck.model.parts import Link
from urdfcheck.model.robot import Model

# So many links of a row have to agree, in mass and principal moments to within what three typed digits leave.
_FEWEST, _SAME = 2, 0.005


@dataclass(frozen=True, slots=True, eq=False)
class RowSlip:
    """A link whose numbers are those of its row with one mistake."""

    link: Link
    row: tuple[Link, ...]
    """The others, which agree."""
    mistake: Mistake


def find_row_slips(model: Model) -> Iterator[RowSlip]:
    """Find the one link of a row that differs from all others, where these agree and one mistake explains the difference.

    The names of a row differ in numbers only, and joints of one type move its links. What is drawn is not compared: the mistake
    has to lead to mass and principal moments of the others to within half a percent. Links with a counterpart on the other side
    are left to those that compare the sides.

    :raises FactUnavailableError: when the tree is broken.
    """
    with_side = {name for pair in pair_by_name(link.name for link in model.links) for name in pair}
    rows: dict[tuple[object, ...], list[Link]] = {}
    for link in model.links:
        words = tuple(word.lower() for word in split_name_words(link.name))
        kind = tuple(word for word in words if not word.isdigit())
        joint = model.tree.parent_joint.get(link.name)
        if kind and kind != words and link.name not in with_side and joint is not None:
            rows.setdefault((kind, joint.type), []).append(link)
    for row in rows.values():
        if len(row) > _FEWEST:
            known = [(link, numbers) for link in row if (numbers := get_comparable_inertial(link)) is not None]
            if len(known) > _FEWEST:
                yield from _find_odd_one(known)


def _find_odd_one(row: list[tuple[Link, DeclaredInertial]]) -> Iterator[RowSlip]:
    if all(_is_same(other, row[0][1]) for _, other in row[1:]):  # as nearly always
        return
    for i, (link, numbers) in enumerate(row):
        others = row[:i] + row[i + 1 :]
        first = others[0][1]
        if not all(_is_same(other, first) for _, other in others[1:]) or _is_same(numbers, first):
            continue
        mistake = find_twin_slip(numbers, first)
        if mistake is not None:
            yield RowSlip(link, tuple(other for other, _ in others), mistake)


def _is_same(one: DeclaredInertial, other: DeclaredInertial) -> bool:
    first, second = ((numbers.mass, *np.linalg.eigvalsh(numbers.tensor).tolist()) for numbers in (one, other))
    return all(abs(a - b) <= _SAME * abs(b) for a, b in zip(first, second, strict=True))
