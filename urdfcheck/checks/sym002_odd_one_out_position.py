"""SYM002 reports a joint that is displaced from the layout of matching joints."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.core import Edit, Finding, Rule
from urdfcheck.core.records import dataclass
from urdfcheck.core.text import join_names
from urdfcheck.facts.likeness.layout import MisplacedPosition, find_misplaced_position, restore_position
from urdfcheck.model import Joint, Model
from urdfcheck.model.ground.wheel_plane import find_uneven_wheels
from urdfcheck.model.likeness.sibling_joints import find_common_base, sibling_joints, trace_fixed_chain
from urdfcheck.model.repairs.origin_edits import describe_definitions, list_definitions, locate_origin_attribute
from urdfcheck.model.shapes.drawn_seats import has_drawn_seat
from urdfcheck.model.shapes.visual_solid import measure_link_geometry
from urdfcheck.model.wheel_names import WHEEL_NAME
from urdfcheck.source.text.tokens import tokenize_attribute
from urdfcheck.source.text.values import parse_number

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array


# Two displacements, or two positions of joints on their parents, agree within this share of the deviation.
SIMILAR_SHARE = 0.25
# A number is right if it misses the layout by less than this share of the deviation, or less than twice as far as the siblings.
EXACT_SHARE = 1e-3
# SYM006 reports a wheel that is too high or too low by this share of its radius and this distance (m).
WHEEL_SPREAD, MIN_WHEEL_GAP = 0.01, 1e-4
# The direction is within 8° of the vertical.
MIN_VERTICAL_COSINE = 0.99
NUMBER_WORDS = {3: "three", 4: "four", 5: "five", 6: "six", 7: "seven"}


@dataclass(frozen=True, slots=True, eq=False)
class _PositionCorrection:
    """A joint whose xyz has to change."""

    joint: Joint
    needed: Array
    """The xyz that its origin needs, (3,) in m."""
    counterparts: tuple[Joint, ...]
    """The joints at its place in the chains of the siblings."""


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    outliers: dict[str, tuple[tuple[Joint, ...], MisplacedPosition]] = {}
    rises = _compute_wheel_offsets(model)
    for group in sibling_joints(model):
        base = model.frames[find_common_base(model, group)]
        places = [
            _transform_to_frame(base, model.frames[joint.child][:3, 3] - rises.get(joint.name, 0.0)) for joint in group
        ]
        misplaced = find_misplaced_position(places)
        if misplaced is None:
            continue
        off = places[misplaced.index] - misplaced.expected
        if _is_body_displaced(model, group, misplaced.index, base=base, rises=rises, off=off):
            outliers[group[misplaced.index].name] = group, misplaced
    for name, (group, misplaced) in outliers.items():
        before = {joint.name for joint in model.tree.find_path_to(model.joint_by_name[name].child)} - {name}
        finding = None if before & outliers.keys() else _build_finding(model, rule, group=group, misplaced=misplaced)
        if finding is not None:
            yield finding


def _compute_wheel_offsets(model: Model) -> dict[str, Array]:
    """Return how far (3,) in m the joint of a wheel is too high that SYM006 reports, or nothing.

    The height of that wheel is not reported again, and it does not count in the layout.
    """
    footing = find_uneven_wheels(model, rel_tol=WHEEL_SPREAD, abs_tol=MIN_WHEEL_GAP)
    if footing is None or footing.odd_wheel is None or footing.odd_wheel.is_caused_by_radius:
        return {}
    return {footing.odd_wheel.wheel.joint.name: np.array((0.0, 0.0, footing.odd_wheel.rise))}


def _is_body_displaced(
    model: Model, group: Sequence[Joint], index: int, *, base: Array, rises: Mapping[str, Array], off: Array
) -> bool:
    """Whether the COM behind a joint is displaced like its frame, and what is drawn is not in its place: otherwise only the frame
    was chosen differently, or the drawing was placed to fit.

    ``base``: (4, 4), the frame of the common base; ``off``: (3,) in m, in that frame.
    """
    coms, drawn = (
        [
            _transform_to_frame(base, centre - rises.get(joint.name, 0.0))
            for joint in group
            if (centre := compute(model, joint)) is not None
        ]
        for compute in (_compute_com, _compute_drawn_centre)
    )
    if len(coms) < len(group) or not _is_displaced(coms, index, off):
        return False
    # What is in its place would be displaced if it were moved.
    moved = [centre + off * (i == index) for i, centre in enumerate(drawn)]
    return len(drawn) < len(group) or not _is_displaced(moved, index, off)


def _is_displaced(centres: Sequence[Array], index: int, off: Array) -> bool:
    """Whether one of some ``centres`` (3,) is off the layout of the others by ``off`` (3,)."""
    restored = restore_position(index, centres)
    if restored is None:
        return False
    return bool(np.linalg.norm(centres[index] - restored.expected - off) < SIMILAR_SHARE * np.linalg.norm(off))


def _transform_to_frame(base: Array, place: Array) -> Array:
    """Transform a position (3,) from root coordinates to a frame (4, 4)."""
    local: Array = base[:3, :3].T @ (place - base[:3, 3])
    return local


def _compute_com(model: Model, joint: Joint) -> Array | None:
    """Return the COM of the child of a joint, declared or else drawn, (3,) in root coordinates."""
    link = model.link_by_name[joint.child]
    drawn = measure_link_geometry(model, link) if link.inertial is None else None
    local = drawn.solid.com if drawn is not None else None
    if link.inertial is not None and link.inertial.origin.xyz is not None:
        local = np.array(link.inertial.origin.xyz)
    return None if local is None else _transform_to_root(model, joint, local)


def _compute_drawn_centre(model: Model, joint: Joint) -> Array | None:
    """Return the centre of what the child of a joint draws, (3,) in root coordinates."""
    drawn = measure_link_geometry(model, model.link_by_name[joint.child])
    return None if drawn is None else _transform_to_root(model, joint, drawn.solid.com)


def _transform_to_root(model: Model, joint: Joint, place: Array) -> Array:
    """Transform a position (3,) from the frame of a joint's child to root coordinates."""
    frame = model.frames[joint.child]
    moved: Array = frame[:3, :3] @ place + frame[:3, 3]
    return moved


def _build_finding(model: Model, rule: Rule, *, group: Sequence[Joint], misplaced: MisplacedPosition) -> Finding | None:
    joint = group[misplaced.index]
    others = [other for other in group if other is not joint]
    base = model.frames[find_common_base(model, group)]
    off = model.frames[joint.child][:3, 3] - (base[:3, :3] @ misplaced.expected + base[:3, 3])
    corrections = _find_position_corrections(model, joint, others, off=off)
    if not corrections:
        return None  # the joint is correct on its parent, which is rotated
    correction = corrections[0]
    delta = model.frames[correction.joint.parent][:3, :3].T @ off
    data: dict[str, Any] = {
        "joint": joint.name,
        "siblings": ", ".join(other.name for other in others),
        "count": NUMBER_WORDS.get(len(others), str(len(others))),
        "layout": misplaced.layout,
        "off": float(np.linalg.norm(off)) * 1e3,
        "where": _describe_offset(joint, off),
        "along": _format_displacement(delta),
        "frame": correction.joint.parent,
    }
    if len(corrections) > 1:
        chain = trace_fixed_chain(model, joint, find_common_base(model, group))
        return rule.finding(
            "chain",
            at=locate_origin_attribute(joint, "xyz"),
            related=[locate_origin_attribute(other, "xyz") for other in (*reversed(chain[:-1]), *others)],
            chain=join_names(link.name for link in chain),
            **data,
        )
    words = _format_xyz(correction, max(EXACT_SHARE * float(np.linalg.norm(off)), 2 * misplaced.residual))
    data["expected"] = " ".join(words)
    attribute, definitions = correction.joint.origin.get_attribute("xyz"), list_definitions(correction.joint, "xyz")
    if correction.joint is joint and has_drawn_seat(model, joint, others, off):
        return rule.finding(
            "drawn",
            at=locate_origin_attribute(joint, "xyz"),
            related=[locate_origin_attribute(other, "xyz") for other in others],
            **data,
        )
    message = "misplaced" if correction.joint is joint else "mount"
    if attribute is not None and definitions:
        message = "computed"
        data |= {"typed": attribute.typed, "definitions": join_names(describe_definitions(definitions))}
    at = locate_origin_attribute(correction.joint, "xyz")
    around = [locate_origin_attribute(other, "xyz") for other in correction.counterparts]
    return rule.finding(
        message,
        at=at,
        edits=_propose_edits(model, correction, words),
        related=[*definitions, *(other for other in around if other.span != at.span)],
        origin=correction.joint.name,
        **data,
    )


def _find_position_corrections(
    model: Model, joint: Joint, others: Sequence[Joint], *, off: Array
) -> list[_PositionCorrection]:
    """Return the joints of a chain whose xyz no counterpart has, and one would have with the layout restored.

    ``off``: (3,) in m, the deviation from the layout in root coordinates. A chain of one joint needs no such counterpart.
    """
    base = find_common_base(model, [joint, *others])
    chain = trace_fixed_chain(model, joint, base)
    chains = [trace_fixed_chain(model, other, base)[-len(chain) :] for other in others]
    near = SIMILAR_SHARE * float(np.linalg.norm(off))
    corrections = []
    for place, one in enumerate(chain):
        like = tuple(other[place] for other in chains if len(other) == len(chain))
        sizes = [np.abs(xyz) for other in like if (xyz := other.origin.xyz) is not None]
        if one.origin.xyz is None:
            continue
        now = np.array(one.origin.xyz)
        needed = now - model.frames[one.parent][:3, :3].T @ off
        fits = [any((np.abs(np.abs(xyz) - size) < near).all() for size in sizes) for xyz in (now, needed)]
        if not fits[0] and (len(chain) == 1 or fits[1]):
            corrections.append(_PositionCorrection(one, needed, like))
    return corrections


def _describe_offset(joint: Joint, off: Array) -> str:
    """Return ``3 mm too high`` for a wheel that is displaced along z, else ``3 mm off``."""
    distance = float(np.linalg.norm(off))
    upright = (
        bool(WHEEL_NAME.search(f"{joint.name} {joint.child}")) and abs(float(off[2])) > MIN_VERTICAL_COSINE * distance
    )
    side = ("too high" if off[2] > 0 else "too low") if upright else "off"
    return f"{distance * 1e3:.4g} mm {side}"


def _format_displacement(delta: Array) -> str:
    """Return ``2 mm along +x and 1 mm along -z``: the main components of a displacement (3,) in m."""
    least = 0.1 * float(np.abs(delta).max())
    parts = [
        f"{abs(d) * 1e3:.4g} mm along {'+' if d > 0 else '-'}{letter}"
        for d, letter in zip(delta.tolist(), "xyz", strict=True)
        if abs(d) > least
    ]
    return " and ".join(parts)


def _format_xyz(correction: _PositionCorrection, near: float) -> list[str]:
    """Return the three numbers of the needed xyz: as typed if right within ``near`` (m), else as a sibling has them."""
    attribute = correction.joint.origin.get_attribute("xyz")
    typed = attribute.value.split() if attribute is not None else ["0", "0", "0"]
    like = [joint.origin.get_attribute("xyz") for joint in correction.counterparts]
    others = [other.value.split() for other in like if other is not None]
    words = []
    for i, (value, word) in enumerate(zip(correction.needed.tolist(), typed, strict=True)):
        spelled = [w[i] for w in others if len(w) == 3 and abs(abs(parse_number(w[i]) or 0.0) - abs(value)) < near]
        if abs(value - float(word)) < near:
            words.append(word)
        elif spelled and abs(value) > near:
            words.append(("-" if value < 0 else "") + spelled[0].lstrip("+-"))
        elif spelled and all(parse_number(other) == 0.0 for other in spelled):
            words.append("0")
        else:
            decimals = max([len(w[i].partition(".")[2]) for w in (typed, *others) if len(w) == 3], default=6)
            text = f"{value:.{min(max(decimals, 3), 6)}f}"
            words.append(text.rstrip("0").rstrip(".") if float(text) else "0")
    return words


def _propose_edits(model: Model, correction: _PositionCorrection, words: Sequence[str]) -> list[Edit]:
    attribute = correction.joint.origin.get_attribute("xyz")
    tokens = tokenize_attribute(attribute, model.source.files)
    if attribute is None or not attribute.literal or len(tokens) != 3:
        return []
    return [token.build_edit(word) for token, word in zip(tokens, words, strict=True) if token.text != word]
