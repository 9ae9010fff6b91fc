"""INR018 reports COMs and radii of gyration far beyond the robot, on links whose geometry is not known."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from urdfcheck.core import Confidence, Finding, Rule, Severity
from urdfcheck.core.merging import build_group_finding
from urdfcheck.core.records import dataclass
from urdfcheck.core.text import format_length, join_names
from urdfcheck.model import CompleteInertial, Model
from urdfcheck.model.inertials.reach import (
    has_placed_frame,
    is_all_known,
    measure_own_size,
    measure_reach,
)
from urdfcheck.model.inertials.typed_tensors import describe_typed_tensor
from urdfcheck.model.parts import Link, has_drawn_shape

# What a length is multiplied by when the COM is typed in another unit than metres, and the radius of gyration when the tensor is
# in another than kg·m²: the square root of the unit's factor.
LENGTHS = {"mm": 1e3, "cm": 1e2, "inches": 1 / 0.0254}
RADII = {"g·m²": 1e3**0.5, "kg·cm²": 1e2, "kg·mm²": 1e3, "g·cm²": 1e7**0.5, "g·mm²": 1e9**0.5}
# The radius of gyration shows the tensor for the mass: with the mass in g, a tensor in g·mm² is one in kg·mm² for a mass in kg.
_WITH_GRAMS = {"kg·cm²": "g·cm²", "kg·mm²": "g·mm²"}
# The shares of the robot's length between which 95 % of the COMs, and of the radii of gyration, of published robots are.
_USUAL = {"com": (0.001, 0.19), "spread": (0.003, 0.27)}
# Another unit that leaves all links within so many times these shares is not ruled out.
_POSSIBLE = 1.5
# Nobody types a larger one (kg·m²) to make a program accept the file: it may be a smaller one in another unit.
_MOST_TYPED = 1.0
# Fewer links fit several units, or one by chance: the usual shares span more than two powers of ten.
_LEAST_LINKS = 3
_ROBOT = "the robot, stretched out, is {} long"
# Of meshes that were not read only the origins are known.
_JOINTS = "the robot's joints and shapes, as far as they are known, span {} stretched out"
_NEAR = {
    "com": "Nothing that the file places on the link is farther than {} from it",
    "spread": "all that is placed on the link is within {}",
}
_UNREAD = {
    "com": "A mesh of {} was not read. All else that the file places there is within {}",
    "spread": "a mesh of {} was not read, and all else that is placed there is within {}",
}


# No two units of length are nearer than this, apart from inches and centimetres.
_UNIT = 10.0
_OTHERWISE = "; if these are right, the origins of the joints are wrong, which are in metres too"


@dataclass(frozen=True, slots=True)
class _FarLink:
    """A link whose mass is too far away, all lengths in m."""

    link: Link
    distance: float
    total: float
    """The distance, or the spread along all three axes together, which is at most 0.61 of a body's length."""
    own: float
    """How far what the file places on the link reaches."""


def check(model: Model, rule: Rule, *, own: float, share: float, whole: float, impossible: float) -> Iterator[Finding]:
    least = measure_reach(model, with_shapes=False)
    if least is None:
        return
    lengths = {
        whole.link.name: pair
        for whole in model.inertials
        if model.link_by_name[whole.link.name] is whole.link and (pair := _measure_lengths(whole)) is not None
    }
    if all(max(pair[:2]) <= share * least for pair in lengths.values()):
        return
    # What is drawn at some place has its COM near that; the shares of spreads were measured without meshes.
    reaches = {
        "com": measure_reach(model, with_shapes=True),
        "spread": measure_reach(model, with_shapes=True, with_unread=False),
    }
    # Few models come so far.
    from urdfcheck.model.motion.fixed_base import list_bolted_links

    bolted = list_bolted_links(model)
    for message, index, units in (("com", 0, LENGTHS), ("spread", 1, RADII)):
        reach = reaches[message]
        if reach is None:
            continue
        grave: list[_FarLink] = []
        odd: list[_FarLink] = []
        for name, pair in lengths.items():
            if pair[index] <= share * reach or not _is_unknown(model, name, index, pair[index] / reach):
                continue
            total = pair[2] if index else pair[0]
            far = _FarLink(model.link_by_name[name], pair[index], total, measure_own_size(model, name))
            # A link whose joints are next to its frame may be a large part all the same.
            is_beyond_own = far.own > 0.05 * reach and far.distance > own * far.own
            if far.distance > impossible * reach:
                grave.append(far)
            elif index == 0 and not has_placed_frame(model, name):
                continue  # nothing says where the part is
            elif far.distance > whole * reach or is_beyond_own or (far.total > whole * reach and name not in bolted):
                odd.append(far)
        unit = _find_unit(message, [*grave, *odd], units, reach)
        # If most links reach beyond the robot, it may be the robot's lengths that are wrong.
        is_most = 2 * (len(grave) + len(odd)) > len(lengths) >= _LEAST_LINKS
        # The robot that includes a part may be longer than it.
        for links, severity in ((grave, Severity.ERROR), ([] if model.source.is_part else odd, None)):
            if links:
                finding = _build_finding(
                    model, rule, message, links, unit=unit, reach=reach, severity=severity, is_most=is_most
                )
                is_chosen = message == "spread" and severity is None and _are_chosen(model, links)
                yield replace(finding, severity=Severity.INFO) if is_chosen else finding


def _are_chosen(model: Model, links: Sequence[_FarLink]) -> bool:
    """Whether a comment beside the numbers of each link gives a reason for them, such as a model that would be unstable."""
    from urdfcheck.model.inertials.habits.stated_purposes import has_stated_purpose

    return all(has_stated_purpose(model, far.link) for far in links)


def _measure_lengths(declared: CompleteInertial) -> tuple[float, float, float] | None:
    """Measure the distance of the COM from the link's frame, the largest spread along an axis, and that along all three (m)."""
    if not declared.mass > 0:
        return None
    # A second moment is half the sum of the moments of inertia, less the one about its own axis.
    total = sum(declared.moments) / 2.0
    spread = max(0.0, (total - declared.moments[0]) / declared.mass) ** 0.5
    return math.hypot(*declared.placement.place), spread, max(0.0, total / declared.mass) ** 0.5


def _describe_typed(message: str, far: _FarLink) -> str | None:
    """Describe the tensor of a link where it was typed rather than computed (INR007); None for any other."""
    declared = None if far.link.inertial is None else far.link.inertial.inertia_components
    is_small = declared is not None and max(map(abs, declared)) <= _MOST_TYPED
    return describe_typed_tensor(far.link) if message == "spread" and is_small else None


def _is_unknown(model: Model, name: str, index: int, distance: float) -> bool:
    """Whether it is not known how large the link's body is, and the link matters to how it moves; otherwise INR005 and INR006
    compare it with its geometry.

    A mass that is ``distance`` lengths of the robot away matters as much more, and with the square of its lever for the moments
    of its body. INR006 does not check the COMs of links that draw nothing.
    """
    # Few models have a link that is so far away: the others do without the geometry of inertials.
    from urdfcheck.model.inertials.inertial_effects import is_at_long_lever
    from urdfcheck.model.inertials.inertial_hull import NEGLIGIBLE_SHARE, compute_body_shares, is_massless_frame
    from urdfcheck.model.shapes.corners import collect_body_corners

    if is_massless_frame(model.link_by_name[name]):
        return False
    body = model.tree.list_body_links(name)
    shares = compute_body_shares(model, body).get(name)
    is_checked = collect_body_corners(model, body) is not None and (index or has_drawn_shape(model.link_by_name[name]))
    if is_checked or shares is None:
        return False
    if index == 0 and is_at_long_lever(model, model.link_by_name[name]):
        return True
    return shares[index] * (1.0 if index else max(1.0, distance)) >= NEGLIGIBLE_SHARE


def _find_unit(message: str, links: Sequence[_FarLink], units: Mapping[str, float], reach: float) -> str:
    """Find the one unit that brings all links to where most published robots have theirs, and no other near; empty without."""
    low, high = _USUAL[message]
    if any(_describe_typed(message, far) is not None for far in links):
        return ""

    def fits(factor: float, slack: float) -> bool:
        return all(low / slack <= far.distance / factor / reach <= high * slack for far in links)

    possible = [unit for unit, factor in units.items() if fits(factor, _POSSIBLE)]
    if len(possible) != 1 or len(links) < _LEAST_LINKS or not fits(units[possible[0]], 1.0):
        return ""
    (unit,) = possible
    return f"{unit}, or in {_WITH_GRAMS[unit]} with masses in g" if unit in _WITH_GRAMS else unit


def _build_finding(
    model: Model,
    rule: Rule,
    message: str,
    links: list[_FarLink],
    *,
    unit: str,
    reach: float,
    severity: Severity | None,
    is_most: bool,
) -> Finding:
    farthest = max(links, key=lambda far: far.distance)
    typed = {_describe_typed(message, far) for far in links}
    placeholder = typed.pop() if len(typed) == 1 else None
    places = [far.link.inertial.element for far in links if far.link.inertial is not None]
    length = format_length(reach)
    is_known = is_all_known(model)
    return build_group_finding(
        rule,
        message,
        places,
        cause="unit" if unit else "placeholder" if placeholder else None,
        severity=severity,
        confidence=Confidence.PROOF if severity is not None and is_known else None,
        link=farthest.link.name if len(links) == 1 else f"{len(links)} links",
        links=join_names(far.link.name for far in links),
        farthest="" if len(links) == 1 else f" ({farthest.link.name})",
        length=format_length(farthest.distance),
        distance=farthest.distance,
        span=format_length(2.0 * farthest.distance),  # no shorter body has such a spread
        reach=length,
        robot=f"the robot is {length}" if is_known else f"its known parts span {length}",
        stretched=_ROBOT.format(length) if is_known else _JOINTS.format(length),
        near=_describe_near(model, message, farthest),
        times=float(f"{farthest.distance / reach:.2g}"),
        own=_format_own(farthest),
        unit=unit,
        what=placeholder or "",
        otherwise=_OTHERWISE if is_most and not placeholder and farthest.distance >= _UNIT * reach else "",
    )


def _describe_near(model: Model, message: str, far: _FarLink) -> str:
    """Say how far what the file places on a link reaches, as a sentence about its COM or a clause about its tensor."""
    from urdfcheck.model.shapes.corners import has_known_shapes

    body = model.tree.list_body_links(far.link.name)
    unread = [name for name in body if not has_known_shapes(model, model.link_by_name[name])]
    if unread:
        whose = "the link" if far.link.name in unread else f"{unread[0]}, which is fixed to it,"
        return _UNREAD[message].format(whose, _format_own(far))
    return _NEAR[message].format(_format_own(far))


def _format_own(far: _FarLink) -> str:
    return format_length(far.own) if far.own > 0 else "0 mm"
