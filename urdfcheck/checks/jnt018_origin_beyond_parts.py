"""JNT018 reports joints whose origins put their child away from the rest of the robot."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from urdfcheck.core import Edit, Finding, Rule
from urdfcheck.core.merging import build_group_finding
from urdfcheck.core.text import format_length, join_names
from urdfcheck.model import Joint, Model
from urdfcheck.model.likeness.side_names import remove_places
from urdfcheck.model.motion.far_origins import FarOrigin, FarThresholds, find_far_origins
from urdfcheck.model.repairs.edits import edit_values, read_typed_text
from urdfcheck.model.repairs.number_text import write_numbers
from urdfcheck.model.repairs.origin_edits import locate_origin_attribute
from urdfcheck.model.shapes.primitive_boxes import has_only_touching_primitives
from urdfcheck.model.use.display import judge_as_drawing

if TYPE_CHECKING:
    from urdfcheck.model.motion.loose_parts import LoosePart, OriginChange


# What a length is multiplied by when it is typed in another unit than metres.
UNITS = {"mm": 1e3, "cm": 1e2, "inches": 1 / 0.0254}
TENFOLD = 10.0
SLIPS = (10.0, 100.0, 1000.0)
# A joint as long as this many of the longest other ones is not unusual: of 2,957 joints the longest reaches 3.6.
USUAL = 3.6
# Parts that move on each other are apart by at most this share of their sizes; those of published robots mostly touch.
TOUCHING = 0.05
# Two origins are the same within this share of their length: three typed digits.
SAME = 0.005


def check(
    model: Model,
    rule: Rule,
    *,
    drawn: float,
    undrawn: float,
    least: float,
    least_fixed: float,
    apart: float,
    loose: float,
    unexplained: float,
) -> Iterator[Finding]:
    limits = FarThresholds(drawn=drawn, undrawn=undrawn, least=least, least_fixed=least_fixed, apart=apart)
    found = find_far_origins(model, limits)
    if not found:
        part = _find_loose_part(model, loose)
        if part is not None and (part.change is not None or part.share >= unexplained):
            yield judge_as_drawing(model, _report_loose(rule, part))
        return
    farthest = max(found, key=lambda far: far.length)
    restored = _restore_by_twins(model, found)
    if restored is not None:
        cause, place = "twin", {"twin": restored[0].name}
        places: list[Sequence[float]] | None = [restored[1]]
    else:
        units = [unit for unit, factor in UNITS.items() if all(_fits(far, factor) for far in found)]
        tenfold = all(_fits(far, TENFOLD) for far in found)
        words = [f"in {' or '.join(units)}"] if units else []
        words += ["with the decimal point one place too far right (ten times the length)"] if tenfold else []
        cause, place = ("unit" if words else ""), {"ways": ", or ".join(words)}
        decided = len(units) == 1 and not tenfold and all(far.gap is not None for far in found)
        places = [[part / UNITS[units[0]] for part in far.joint.origin.xyz or ()] for far in found] if decided else None
    edits = [] if places is None else _propose_edits([far.joint for far in found], places)
    yield build_group_finding(
        rule,
        "parts" if farthest.others is None else "origin",
        [_Place(far.joint) for far in found],
        cause=cause or None,
        edits=edits,
        joint=farthest.joint.name if len(found) == 1 else f"{len(found)} joints",
        joints=join_names(far.joint.name for far in found),
        farthest="" if len(found) == 1 else f" of {farthest.joint.name}",
        length=format_length(farthest.length),
        distance=farthest.length,
        parent=farthest.joint.parent,
        child=farthest.joint.child,
        others="" if farthest.others is None else format_length(farthest.others),
        space="" if farthest.gap is None else _describe_space(farthest),
        gap="" if farthest.gap is None else format_length(farthest.gap),
        sizes=format_length(farthest.sizes),
        **{"ways": "", "twin": "", **place},
    )


def _find_loose_part(model: Model, least: float) -> LoosePart | None:
    has_unread_mesh = any(model.meshes.get_facts(use.shape) is None for use in model.meshes.uses)
    if has_unread_mesh or has_only_touching_primitives(model):
        return None  # not known, or none is loose
    from urdfcheck.model.motion.loose_parts import find_loose_part  # loads numpy

    return find_loose_part(model, least)


def _report_loose(rule: Rule, part: LoosePart) -> Finding:
    change = part.change
    joint = part.joint if change is None else change.joint
    return rule.finding(
        "loose",
        at=_Place(joint),
        cause=None if change is None else "slip",
        joint=joint.name,
        child=joint.child,
        parent=joint.parent,
        length=format_length(part.gap),
        gap=format_length(part.gap),
        distance=part.gap,
        size=format_length(part.size),
        others=part.others,
        change="" if change is None else _describe_change(change),
    )


def _describe_change(change: OriginChange) -> str:
    typed = read_typed_text(attribute) if (attribute := change.joint.origin.get_attribute("xyz")) is not None else ""
    name = " and ".join("xyz"[axis] for axis in change.axes)
    xyz = write_numbers(typed, change.xyz)
    what = {
        "sign": f"{name} has the other sign",
        "swap": f"{name} are swapped",
    }
    places = {"left": "one place", "left2": "two places", "left3": "three places"}
    slip = what.get(change.kind) or f"the decimal point of {name} is {places[change.kind]} further left"
    return f"{slip}: {xyz}"


class _Place:
    """Where the xyz of a joint's origin is typed."""

    def __init__(self, joint: Joint) -> None:
        self.location = locate_origin_attribute(joint, "xyz")


def _fits(far: FarOrigin, factor: float) -> bool:
    """Whether a joint so many times nearer is where joints are: no farther than others, and its parts touch."""
    if far.others is not None and far.length / factor > USUAL * far.others:
        return False
    gap = far.measure_gap([part / factor for part in far.joint.origin.xyz or ()])
    return gap is None or gap <= TOUCHING * far.sizes


def _restore_by_twins(model: Model, found: Sequence[FarOrigin]) -> tuple[Joint, Sequence[float]] | None:
    """Return a joint like the only far one, and the xyz in m that has its numbers except for a unit or a decimal point."""
    if len(found) != 1 or found[0].others is None:
        return None
    joint = found[0].joint
    now = joint.origin.xyz or ()
    candidates = [[part / factor for part in now] for factor in (*UNITS.values(), TENFOLD)]
    candidates += [
        [part / slip if i == axis else part for i, part in enumerate(now)]
        for axis in range(len(now))
        if now[axis]
        for slip in SLIPS
    ]
    name = remove_places(joint.name)
    for other in model.joints:
        if other is joint or other.type != joint.type or remove_places(other.name) != name or other.origin.xyz is None:
            continue
        like = [abs(part) for part in other.origin.xyz]
        for place in candidates:
            off = max(abs(abs(part) - wanted) for part, wanted in zip(place, like, strict=True))
            if off <= SAME * math.hypot(*like):
                return other, place
    return None


def _describe_space(far: FarOrigin) -> str:
    gap, sizes = format_length(far.gap or 0.0), format_length(far.sizes)
    return f"; what is drawn on both sides measures {sizes} together, and {gap} lie between"


def _propose_edits(joints: Sequence[Joint], places: Sequence[Sequence[float]]) -> list[Edit]:
    changes = []
    for joint, place in zip(joints, places, strict=True):
        attribute = joint.origin.get_attribute("xyz")
        if attribute is None:
            return []
        changes.append((attribute, write_numbers(read_typed_text(attribute), place)))
    return edit_values(changes)
