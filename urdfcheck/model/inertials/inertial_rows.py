"""Links of one row (``wheel_1``, ``wheel_2``, ``wheel_3``) of which one has the numbers of the others with one mistake."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.core.text import split_name_words
from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
from urdfcheck.facts.inertials.twin_slips import find_principal_rounding, find_twin_slip
from urdfcheck.facts.median import compute_median
from urdfcheck.model.inertials.mirrored_inertials import (
    find_same_numbers,
    get_possible_inertial,
)
from urdfcheck.model.inertials.proposals.mistake_names import describe_mistake
from urdfcheck.model.inertials.typed_tensors import describe_typed_tensor
from urdfcheck.model.likeness.shape_comparison import get_outline, is_alike
from urdfcheck.model.likeness.side_names import pair_by_name
from urdfcheck.model.parts import Link
from urdfcheck.model.robot import Model

# So many links of a row have to agree, in mass and principal moments to within what three typed digits leave.
_FEWEST, _SAME = 2, 0.005
# Masses that are the same number in one unit, and moments that nobody takes for rounded ones.
_EQUAL, _UNLIKE = 1e-6, 1.2
# COMs of a row are as far from their frames to within this share, and one that was not filled in matters where the others are
# farther than this share of their radius of gyration.
_SAME_COM, _FAR_COM = 0.05, 0.1


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class RowSlip:
    """A link whose numbers are those of its row with one mistake."""

    link: Link
    row: tuple[Link, ...]
    """The others, which agree."""
    kind: str
    """``row``: a mistake that can be undone; ``typed``: a tensor that was typed; ``copied``: the numbers of another link."""
    mistake: str
    """The mistake in words, the tensor, or the name of the other link."""


def find_row_slips(model: Model) -> Iterator[RowSlip]:
    """Find the links of a row that differ from most, where these agree and one mistake explains the difference.

    The names of a row differ in numbers only, in one where there is nothing else, joints of one type move its links, and they
    draw parts of one shape, or nothing. The mistake has to lead to mass and principal moments of the others to within half a
    percent. Links with a counterpart on the other side are left to those that compare the sides.

    :raises FactUnavailableError: when the tree is broken.
    """
    with_side = {name for pair in pair_by_name(link.name for link in model.links) for name in pair}
    rows: dict[tuple[object, ...], list[Link]] = {}
    for link in model.links:
        joint = model.tree.parent_joint.get(link.name)
        if link.name not in with_side and joint is not None:
            for kind in _list_row_names(link.name):
                rows.setdefault((kind, joint.type), []).append(link)
    found: set[str] = set()
    for row in rows.values():
        if len(row) > _FEWEST:
            for slip in _find_odd_ones(model, row):
                if slip.link.name not in found:
                    found.add(slip.link.name)
                    yield slip


def _list_row_names(name: str) -> list[tuple[str, ...]]:
    """List what the names of the rows that a link may be in have in common: words, or all numbers but one."""
    words = tuple(word.lower() for word in split_name_words(name))
    kind = tuple(word for word in words if not word.isdigit())
    if kind:
        return [kind] if kind != words else []
    return [(*words[:i], "#", *words[i + 1 :]) for i in range(len(words))]


def _find_odd_ones(model: Model, row: list[Link]) -> Iterator[RowSlip]:
    known = [(link, numbers) for link in row if (numbers := get_possible_inertial(link)) is not None]
    for part in _group_by_drawing(model, known):
        if len(part) > _FEWEST:
            yield from _find_odd_ones_of_part(model, part, row)


def _group_by_drawing(
    model: Model, known: list[tuple[Link, DeclaredInertial]]
) -> list[list[tuple[Link, DeclaredInertial]]]:
    """Group links that draw one part: other parts of a row, such as the brackets of an arm, have other numbers."""
    groups: list[list[tuple[Link, DeclaredInertial]]] = []
    for one in known:
        group = next((group for group in groups if _do_draw_one_part(model, group[0][0], one[0])), None)
        if group is None:
            groups.append([one])
        else:
            group.append(one)
    return groups


def _do_draw_one_part(model: Model, one: Link, other: Link) -> bool:
    """Whether two links draw parts of one shape, or nothing. Meshes that cannot be read have one name, apart from the link's."""
    alike = is_alike(model, one.name, other.name)
    return _name_meshes(one) == _name_meshes(other) if alike is None else alike


def _name_meshes(link: Link) -> list[str]:
    shapes = link.visuals or link.collisions
    names = (shape.mesh_filename for shape in shapes)
    return ["" if name is None else name.value.replace(link.name, "{link}") for name in names]


def _find_odd_ones_of_part(
    model: Model, known: list[tuple[Link, DeclaredInertial]], row: list[Link]
) -> Iterator[RowSlip]:
    computed = [(link, numbers) for link, numbers in known if describe_typed_tensor(link) is None]
    most: list[tuple[Link, DeclaredInertial]] = []
    for _, first in computed:
        if 2 * len(most) <= len(known):  # else it is the majority already, as nearly always
            most = max(most, [(link, n) for link, n in computed if _is_same(n, first)], key=len)
    if len(most) < _FEWEST or 2 * len(most) <= len(known):
        return
    yield from _find_odd_com(model, most)
    if len(most) == len(known):
        return
    others = tuple(link for link, _ in most)
    for link, numbers in known:
        if link not in others and (why := _explain(model, link, numbers, right=most[0][1], row=row)) is not None:
            kind, mistake = why
            yield RowSlip(link=link, row=others, kind=kind, mistake=mistake)


def _find_odd_com(model: Model, most: list[tuple[Link, DeclaredInertial]]) -> Iterator[RowSlip]:
    """Find the only link of some that agree in mass and moments whose COM is at another distance than those of the others, by one
    mistake: from the frame, and from the middle of what is drawn, where that is known."""
    distances = np.array([float(np.linalg.norm(numbers.com)) for _, numbers in most])
    usual = float(compute_median(distances.tolist()))
    odd = np.flatnonzero(np.abs(distances - usual) > _SAME_COM * usual).tolist()
    if len(odd) != 1 or len(most) <= _FEWEST:
        return
    (index,) = odd
    link, numbers = most[index]
    others = [one for one in most if one[0] is not link]
    right = others[0][1]
    radius = math.sqrt(float(np.trace(right.inertia)) / (2.0 * right.mass))
    own, other = (get_outline(model, one.name) for one, _ in (most[index], others[0]))
    if own is not None and other is not None:
        away, usual_away = (
            float(np.linalg.norm(com - middle))
            for com, middle in ((numbers.com, own.centroid), (right.com, other.centroid))
        )
        if abs(away - usual_away) <= _FAR_COM * radius:
            return  # the frame is at another point of the part
    if not numbers.com.any():
        mistake = "COM at the link's origin" if usual > _FAR_COM * radius else ""
    else:
        slip = find_twin_slip(numbers, right)
        mistake = "" if slip is None else describe_mistake(slip.id, slip.detail)
    if mistake:
        yield RowSlip(link=link, row=tuple(one for one, _ in others), kind="row", mistake=mistake)


def _explain(
    model: Model, link: Link, numbers: DeclaredInertial, *, right: DeclaredInertial, row: list[Link]
) -> tuple[str, str] | None:
    """Find what makes the numbers of a link of those that its ``row`` has; None where nothing does."""
    mistake = find_twin_slip(numbers, right) or find_principal_rounding(numbers, right)
    if mistake is not None:
        return "row", describe_mistake(mistake.id, mistake.detail)
    typed = describe_typed_tensor(link)
    if typed is None:
        source = find_same_numbers(model, link, [other for other in model.links if other not in row])
        if source is None or (_list_meshes(link) & _list_meshes(source) and not _draws_as_row(link, row)):
            return None  # it draws the part whose numbers it has
        return "copied", source.name
    if not math.isclose(numbers.mass, right.mass, rel_tol=_EQUAL):
        return None
    ratios = np.linalg.eigvalsh(numbers.tensor) / np.linalg.eigvalsh(right.tensor)
    return ("typed", typed) if max(ratios.max(), 1.0 / ratios.min()) > _UNLIKE else None


def _draws_as_row(link: Link, row: list[Link]) -> bool:
    """Whether a link draws a mesh of another link of its row."""
    return any(_list_meshes(link) & _list_meshes(other) for other in row if other is not link)


def _list_meshes(link: Link) -> set[str]:
    return {shape.mesh_filename.value for shape in link.visuals if shape.mesh_filename is not None}


def _is_same(one: DeclaredInertial, other: DeclaredInertial) -> bool:
    first, second = ((numbers.mass, *np.linalg.eigvalsh(numbers.tensor).tolist()) for numbers in (one, other))
    return all(abs(a - b) <= _SAME * abs(b) for a, b in zip(first, second, strict=True))
