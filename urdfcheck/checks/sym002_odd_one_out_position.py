"""SYM002: the places of like joints follow one layout."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.core import Edit, Finding, Rule
from urdfcheck.core.text import listed
from urdfcheck.facts.likeness.layout import Misplaced, misplaced, restored
from urdfcheck.model import Joint, Model
from urdfcheck.model.ground.wheel_plane import uneven
from urdfcheck.model.ground.wheels import NAMED
from urdfcheck.model.likeness.sibling_joints import base_of, chain_of
from urdfcheck.model.repairs.origin_edits import definitions_of, place_of, told
from urdfcheck.model.shapes.visual_solid import geometry
from urdfcheck.source.text.tokens import words_of
from urdfcheck.source.text.values import number

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

# A displacement, or a joint's place on what carries it, is like another within this share of the deviation.
SAME = 0.25
# A number is right when it misses the layout by less than this share of the deviation, or twice as much as the siblings do.
RIGHT = 1e-3
# From here on SYM006 tells that a wheel is too high or too low, in parts of its radius and in m.
SPREAD, LEAST = 0.01, 1e-4
# Within 8° of the vertical.
UPRIGHT = 0.99
WORDS = {3: "three", 4: "four", 5: "five", 6: "six", 7: "seven"}


@dataclass(frozen=True, slots=True, eq=False)
class _Suspect:
    """A joint whose xyz has to change, to ``needed`` (3,) in m, and the joints in its siblings' place."""

    joint: Joint
    needed: Array
    like: tuple[Joint, ...]


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    odd: dict[str, tuple[tuple[Joint, ...], Misplaced]] = {}
    rises = _rises(model)
    for group in model.siblings:
        base = model.frames[base_of(model, group)]
        places = [_seen_from(base, model.frames[joint.child][:3, 3] - rises.get(joint.name, 0.0)) for joint in group]
        found = misplaced(places)
        if found is not None and _body_too(model, group, rises, found, base, places[found.index] - found.expected):
            odd[group[found.index].name] = group, found
    for name, (group, one) in odd.items():
        before = {joint.name for joint in model.tree.path(model.joint_by_name[name].child)} - {name}
        finding = None if before & odd.keys() else _finding(model, rule, group, one)
        if finding is not None:
            yield finding


def _rises(model: Model) -> dict[str, Array]:
    """By how much (3,) the joint of the one wheel is too high that SYM006 names: the others do not follow its height, and if
    it stands where they put it otherwise, nothing else is to be said."""
    footing = uneven(model, spread=SPREAD, least=LEAST)
    if footing is None or footing.odd is None or footing.odd.by_radius:
        return {}
    return {footing.odd.wheel.joint.name: np.array((0.0, 0.0, footing.odd.rise))}


def _body_too(
    model: Model,
    group: Sequence[Joint],
    rises: Mapping[str, Array],
    found: Misplaced,
    base: Array,
    off: Array,
) -> bool:
    """Whether what the joint carries is off by as much: a frame moved along the joint's axis is a choice of frame."""
    centres = [_centre(model, joint) for joint in group]
    known = [
        _seen_from(base, centre - rises.get(joint.name, 0.0))
        for joint, centre in zip(group, centres, strict=True)
        if centre is not None
    ]
    own = restored(found.index, known) if len(known) == len(centres) else None
    if own is None:
        return False
    return bool(np.linalg.norm(known[found.index] - own.expected - off) < SAME * np.linalg.norm(off))


def _seen_from(base: Array, place: Array) -> Array:
    """A place (3,) in root coordinates as one in those of a frame (4, 4)."""
    local: Array = base[:3, :3].T @ (place - base[:3, 3])
    return local


def _centre(model: Model, joint: Joint) -> Array | None:
    """The COM of what a joint carries, declared or else drawn, in root coordinates."""
    link = model.link_by_name[joint.child]
    drawn = geometry(model, link) if link.inertial is None else None
    local = drawn.solid.com if drawn is not None else None
    if link.inertial is not None and link.inertial.origin.xyz is not None:
        local = np.array(link.inertial.origin.xyz)
    frame = model.frames[link.name]
    return None if local is None else frame[:3, :3] @ local + frame[:3, 3]


def _finding(model: Model, rule: Rule, group: Sequence[Joint], found: Misplaced) -> Finding | None:
    joint = group[found.index]
    others = [other for other in group if other is not joint]
    base = model.frames[base_of(model, group)]
    off = model.frames[joint.child][:3, 3] - (base[:3, :3] @ found.expected + base[:3, 3])
    suspects = _suspects(model, joint, others, off)
    if not suspects:
        return None  # it stands where its siblings do, on something that stands askew
    one = suspects[0]
    delta = model.frames[one.joint.parent][:3, :3].T @ off
    data: dict[str, Any] = {
        "joint": joint.name,
        "siblings": ", ".join(other.name for other in others),
        "count": WORDS.get(len(others), str(len(others))),
        "layout": found.layout,
        "off": float(np.linalg.norm(off)) * 1e3,
        "where": _where(joint, off),
        "along": _along(delta),
        "frame": one.joint.parent,
    }
    if len(suspects) > 1:
        chain = chain_of(model, joint, base_of(model, group))
        return rule.finding(
            "chain",
            at=place_of(joint, "xyz"),
            related=[place_of(other, "xyz") for other in (*reversed(chain[:-1]), *others)],
            chain=listed([j.name for j in chain]),
            **data,
        )
    words = _words(one, max(RIGHT * float(np.linalg.norm(off)), 2 * found.residual))
    data["expected"] = " ".join(words)
    attribute, definitions = one.joint.origin.attribute("xyz"), definitions_of(one.joint, "xyz")
    message = "misplaced" if one.joint is joint else "mount"
    if attribute is not None and definitions:
        message = "computed"
        data |= {"typed": attribute.typed, "definitions": listed(told(definitions))}
    place = place_of(one.joint, "xyz")
    around = [place_of(other, "xyz") for other in one.like]
    return rule.finding(
        message,
        at=place,
        edits=_edits(model, one, words),
        related=[*definitions, *(other for other in around if other.span != place.span)],
        origin=one.joint.name,
        **data,
    )


def _suspects(model: Model, joint: Joint, others: Sequence[Joint], off: Array) -> list[_Suspect]:
    """The joints of a chain whose xyz is not that of a sibling in their place, and would be with the layout kept."""
    base = base_of(model, [joint, *others])
    chain = chain_of(model, joint, base)
    chains = [chain_of(model, other, base)[-len(chain) :] for other in others]
    near = SAME * float(np.linalg.norm(off))
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
            found.append(_Suspect(one, needed, like))
    return found


def _where(joint: Joint, off: Array) -> str:
    """``3 mm too high`` of a wheel, for which z is up, else ``3 mm beside it``."""
    distance = float(np.linalg.norm(off))
    upright = bool(NAMED.search(f"{joint.name} {joint.child}")) and abs(float(off[2])) > UPRIGHT * distance
    side = ("too high" if off[2] > 0 else "too low") if upright else "beside it"
    return f"{distance * 1e3:.4g} mm {side}"


def _along(delta: Array) -> str:
    """``2 mm along +x and 1 mm along -z``: what counts of a displacement."""
    least = 0.1 * float(np.abs(delta).max())
    parts = [
        f"{abs(d) * 1e3:.4g} mm along {'+' if d > 0 else '-'}{letter}"
        for d, letter in zip(delta.tolist(), "xyz", strict=True)
        if abs(d) > least
    ]
    return " and ".join(parts)


def _words(one: _Suspect, near: float) -> list[str]:
    """The three numbers of the xyz that is needed: as typed where they are right, to within ``near`` (m), else as a sibling
    spells them."""
    own = one.joint.origin.attribute("xyz")
    typed = own.value.split() if own is not None else ["0", "0", "0"]
    others = [a.value.split() for joint in one.like if (a := joint.origin.attribute("xyz")) is not None]
    found = []
    for i, (value, word) in enumerate(zip(one.needed.tolist(), typed, strict=True)):
        spelled = [w[i] for w in others if len(w) == 3 and abs(abs(number(w[i]) or 0.0) - abs(value)) < near]
        if abs(value - float(word)) < near:
            found.append(word)
        elif spelled and abs(value) > near:
            found.append(("-" if value < 0 else "") + spelled[0].lstrip("+-"))
        else:
            decimals = max([len(w[i].partition(".")[2]) for w in (typed, *others) if len(w) == 3], default=6)
            text = f"{value:.{min(max(decimals, 3), 6)}f}"
            found.append(text.rstrip("0").rstrip(".") if float(text) else "0")
    return found


def _edits(model: Model, one: _Suspect, wanted: Sequence[str]) -> list[Edit]:
    attribute = one.joint.origin.attribute("xyz")
    words = words_of(attribute, model.source.files)
    if attribute is None or not attribute.literal or len(words) != 3:
        return []
    return [word.replaced(text) for word, text in zip(words, wanted, strict=True) if word.text != text]
