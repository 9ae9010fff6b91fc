"""SYM002 reports a joint that is displaced from the layout of like joints."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.core import Edit, Finding, Rule
from urdfcheck.core.text import join_names
from urdfcheck.facts.likeness.layout import MisplacedPosition, find_misplaced_position, restore_position
from urdfcheck.model import Joint, Model
from urdfcheck.model.ground.wheel_plane import find_uneven_wheels
from urdfcheck.model.ground.wheels import WHEEL_NAME
from urdfcheck.model.likeness.sibling_joints import find_common_base, sibling_joints, trace_fixed_chain
from urdfcheck.model.repairs.origin_edits import describe_definitions, list_definitions, locate_origin_attribute
from urdfcheck.model.shapes.visual_solid import measure_link_geometry
from urdfcheck.source.text.tokens import tokenize_attribute
from urdfcheck.source.text.values import parse_number

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array


# A displacement, or a joint's place on what carries it, is like another within this share of the deviation.
SIMILAR_SHARE = 0.25
# A number is right when it misses the layout by less than this share of the deviation, or twice as much as the siblings do.
EXACT_SHARE = 1e-3
# From here on SYM006 tells that a wheel is too high or too low, in parts of its radius and in m.
WHEEL_SPREAD, MIN_WHEEL_GAP = 0.01, 1e-4
# Within 8° of the vertical.
MIN_VERTICAL_COSINE = 0.99
NUMBER_WORDS = {3: "three", 4: "four", 5: "five", 6: "six", 7: "seven"}


@dataclass(frozen=True, slots=True, eq=False)
class _PositionCorrection:
    """A joint whose xyz has to change, to ``needed`` (3,) in m, and the joints in its siblings' place."""

    joint: Joint
    needed: Array
    counterparts: tuple[Joint, ...]


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    odd: dict[str, tuple[tuple[Joint, ...], MisplacedPosition]] = {}
    rises = _compute_wheel_offsets(model)
    for group in sibling_joints(model):
        base = model.frames[find_common_base(model, group)]
        places = [
            _transform_to_frame(base, model.frames[joint.child][:3, 3] - rises.get(joint.name, 0.0)) for joint in group
        ]
        found = find_misplaced_position(places)
        if found is not None and _is_body_displaced(
            model, group, rises, found, base, places[found.index] - found.expected
        ):
            odd[group[found.index].name] = group, found
    for name, (group, one) in odd.items():
        before = {joint.name for joint in model.tree.find_path_to(model.joint_by_name[name].child)} - {name}
        finding = None if before & odd.keys() else _build_finding(model, rule, group, one)
        if finding is not None:
            yield finding


def _compute_wheel_offsets(model: Model) -> dict[str, Array]:
    """By how much (3,) the joint of the one wheel is too high that SYM006 names: the others do not follow its height, and if
    it stands where they put it otherwise, nothing else is to be said."""
    footing = find_uneven_wheels(model, rel_tol=WHEEL_SPREAD, abs_tol=MIN_WHEEL_GAP)
    if footing is None or footing.odd_wheel is None or footing.odd_wheel.is_caused_by_radius:
        return {}
    return {footing.odd_wheel.wheel.joint.name: np.array((0.0, 0.0, footing.odd_wheel.rise))}


def _is_body_displaced(
    model: Model,
    group: Sequence[Joint],
    rises: Mapping[str, Array],
    found: MisplacedPosition,
    base: Array,
    off: Array,
) -> bool:
    """Whether what the joint carries is off by as much: a frame moved along the joint's axis is a choice of frame."""
    centres = [_compute_com(model, joint) for joint in group]
    known = [
        _transform_to_frame(base, centre - rises.get(joint.name, 0.0))
        for joint, centre in zip(group, centres, strict=True)
        if centre is not None
    ]
    own = restore_position(found.index, known) if len(known) == len(centres) else None
    if own is None:
        return False
    return bool(np.linalg.norm(known[found.index] - own.expected - off) < SIMILAR_SHARE * np.linalg.norm(off))


def _transform_to_frame(base: Array, place: Array) -> Array:
    """A place (3,) in root coordinates as one in those of a frame (4, 4)."""
    local: Array = base[:3, :3].T @ (place - base[:3, 3])
    return local


def _compute_com(model: Model, joint: Joint) -> Array | None:
    """The COM of what a joint carries, declared or else drawn, in root coordinates."""
    link = model.link_by_name[joint.child]
    drawn = measure_link_geometry(model, link) if link.inertial is None else None
    local = drawn.solid.com if drawn is not None else None
    if link.inertial is not None and link.inertial.origin.xyz is not None:
        local = np.array(link.inertial.origin.xyz)
    frame = model.frames[link.name]
    return None if local is None else frame[:3, :3] @ local + frame[:3, 3]


def _build_finding(model: Model, rule: Rule, group: Sequence[Joint], found: MisplacedPosition) -> Finding | None:
    joint = group[found.index]
    others = [other for other in group if other is not joint]
    base = model.frames[find_common_base(model, group)]
    off = model.frames[joint.child][:3, 3] - (base[:3, :3] @ found.expected + base[:3, 3])
    suspects = _find_position_corrections(model, joint, others, off)
    if not suspects:
        return None  # it stands where its siblings do, on something that stands askew
    one = suspects[0]
    delta = model.frames[one.joint.parent][:3, :3].T @ off
    data: dict[str, Any] = {
        "joint": joint.name,
        "siblings": ", ".join(other.name for other in others),
        "count": NUMBER_WORDS.get(len(others), str(len(others))),
        "layout": found.layout,
        "off": float(np.linalg.norm(off)) * 1e3,
        "where": _describe_offset(joint, off),
        "along": _format_displacement(delta),
        "frame": one.joint.parent,
    }
    if len(suspects) > 1:
        chain = trace_fixed_chain(model, joint, find_common_base(model, group))
        return rule.finding(
            "chain",
            at=locate_origin_attribute(joint, "xyz"),
            related=[locate_origin_attribute(other, "xyz") for other in (*reversed(chain[:-1]), *others)],
            chain=join_names([j.name for j in chain]),
            **data,
        )
    words = _format_xyz(one, max(EXACT_SHARE * float(np.linalg.norm(off)), 2 * found.residual))
    data["expected"] = " ".join(words)
    attribute, definitions = one.joint.origin.get_attribute("xyz"), list_definitions(one.joint, "xyz")
    message = "misplaced" if one.joint is joint else "mount"
    if attribute is not None and definitions:
        message = "computed"
        data |= {"typed": attribute.typed, "definitions": join_names(describe_definitions(definitions))}
    place = locate_origin_attribute(one.joint, "xyz")
    around = [locate_origin_attribute(other, "xyz") for other in one.counterparts]
    return rule.finding(
        message,
        at=place,
        edits=_propose_edits(model, one, words),
        related=[*definitions, *(other for other in around if other.span != place.span)],
        origin=one.joint.name,
        **data,
    )


def _find_position_corrections(
    model: Model, joint: Joint, others: Sequence[Joint], off: Array
) -> list[_PositionCorrection]:
    """The joints of a chain whose xyz is not that of a sibling in their place, and would be with the layout kept."""
    base = find_common_base(model, [joint, *others])
    chain = trace_fixed_chain(model, joint, base)
    chains = [trace_fixed_chain(model, other, base)[-len(chain) :] for other in others]
    near = SIMILAR_SHARE * float(np.linalg.norm(off))
    found = []
    for place, one in enumerate(chain):
        like = tuple(other[place] for other in chains if len(other) == len(chain))
        sizes = [np.abs(xyz) for other in like if (xyz := other.origin.xyz) is not None]
        if one.origin.xyz is None:
            continue
        now = np.array(one.origin.xyz)
        needed = now - model.frames[one.parent][:3, :3].T @ off
        fits = [any((np.abs(np.abs(xyz) - size) < near).all() for size in sizes) for xyz in (now, needed)]
        if not fits[0] and (len(chain) == 1 or fits[1]):
            found.append(_PositionCorrection(one, needed, like))
    return found


def _describe_offset(joint: Joint, off: Array) -> str:
    """``3 mm too high`` of a wheel, for which z is up, else ``3 mm beside it``."""
    distance = float(np.linalg.norm(off))
    upright = (
        bool(WHEEL_NAME.search(f"{joint.name} {joint.child}")) and abs(float(off[2])) > MIN_VERTICAL_COSINE * distance
    )
    side = ("too high" if off[2] > 0 else "too low") if upright else "beside it"
    return f"{distance * 1e3:.4g} mm {side}"


def _format_displacement(delta: Array) -> str:
    """``2 mm along +x and 1 mm along -z``: what counts of a displacement."""
    least = 0.1 * float(np.abs(delta).max())
    parts = [
        f"{abs(d) * 1e3:.4g} mm along {'+' if d > 0 else '-'}{letter}"
        for d, letter in zip(delta.tolist(), "xyz", strict=True)
        if abs(d) > least
    ]
    return " and ".join(parts)


def _format_xyz(one: _PositionCorrection, near: float) -> list[str]:
    """The three numbers of the xyz that is needed: as typed where they are right, to within ``near`` (m), else as a sibling
    spells them."""
    own = one.joint.origin.get_attribute("xyz")
    typed = own.value.split() if own is not None else ["0", "0", "0"]
    others = [a.value.split() for joint in one.counterparts if (a := joint.origin.get_attribute("xyz")) is not None]
    found = []
    for i, (value, word) in enumerate(zip(one.needed.tolist(), typed, strict=True)):
        spelled = [w[i] for w in others if len(w) == 3 and abs(abs(parse_number(w[i]) or 0.0) - abs(value)) < near]
        if abs(value - float(word)) < near:
            found.append(word)
        elif spelled and abs(value) > near:
            found.append(("-" if value < 0 else "") + spelled[0].lstrip("+-"))
        else:
            decimals = max([len(w[i].partition(".")[2]) for w in (typed, *others) if len(w) == 3], default=6)
            text = f"{value:.{min(max(decimals, 3), 6)}f}"
            found.append(text.rstrip("0").rstrip(".") if float(text) else "0")
    return found


def _propose_edits(model: Model, one: _PositionCorrection, wanted: Sequence[str]) -> list[Edit]:
    attribute = one.joint.origin.get_attribute("xyz")
    words = tokenize_attribute(attribute, model.source.files)
    if attribute is None or not attribute.literal or len(words) != 3:
        return []
    return [word.build_edit(text) for word, text in zip(words, wanted, strict=True) if word.text != text]
