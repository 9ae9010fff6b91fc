"""Changes and verdicts in words: the part first, then what happened to it, with the number that matters."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence

from urdfcheck.core.model_diff import CATEGORIES, COSMETIC, IDENTICAL, LinkShift, MechanismChange, MechanismDiff
from urdfcheck.core.text import (
    format_angle,
    format_configuration,
    format_count,
    format_length,
    format_percent,
    format_share,
    join_names,
)

# Shares and directions below these are rounding.
_LEAST_COMPONENT = 0.02
# Links that move less (m) are in the same place.
_SAME_PLACE = 2e-5
# Links that move alike and are named.
_MOST_ALIKE = 3
# Surfaces that are nearer (m) are one in other digits.
_SAME_SURFACE = 2e-5
_PART = re.compile(r"(link|joint)\[([^\]]*)\]", re.DOTALL)


def describe_change(change: MechanismChange) -> str:
    """Return one line about a change."""
    return f"{name_part(change.subject)} {_WORDS[change.id](change)}"


def name_part(subject: str) -> str:
    """Return ``link hand`` for ``link[hand]``."""
    match = _PART.fullmatch(subject)
    return subject if match is None else f"{match[1]} {match[2]}"


def format_size(metres: float) -> str:
    """Return a length that may be small."""
    return format_length(metres, micrometres=True)


# -- sentences of the changes ------------------------------------------------------------------------------------------


def _describe_move(change: MechanismChange) -> str:
    numbers, parts = change.numbers, []
    if numbers["distance"] > 1e-6:
        shift = [numbers[f"shift_{axis}"] for axis in "xyz"]
        parts.append(f"moves by {format_size(numbers['distance'])} ({_format_vector(shift)})")
    if numbers["angle"] > 1e-6:
        axis = _format_axis([numbers[f"axis_{name}"] for name in "xyz"])
        parts.append(f"rotates by {format_angle(numbers['angle'])} about {axis}")
    return f"{' and '.join(parts)} in link {change.words['parent']}"


def _format_vector(vector: Iterable[float]) -> str:
    values = list(vector)
    least = _LEAST_COMPONENT * max(map(abs, values))
    shown = (
        f"{axis} {'+' if value > 0 else '−'}{format_size(abs(value))}"
        for axis, value in zip("xyz", values, strict=True)
        if abs(value) > least
    )
    return ", ".join(shown)


def _format_axis(axis: Iterable[float]) -> str:
    values = list(axis)
    for name, value in zip("xyz", values, strict=True):
        if abs(value) > 1.0 - 1e-6:
            return name if value > 0 else f"−{name}"
    return f"({' '.join(f'{value:.3g}' for value in values)})"


def _describe_offset(change: MechanismChange) -> str:
    offset, unit = change.numbers["offset"], change.words["unit"]
    amount = format_angle(offset) if unit == "rad" else format_size(abs(offset))
    sign = "" if unit == "rad" or offset > 0 else "−"
    return f"has its zero shifted by {sign}{amount}"


def _describe_value(name: str) -> Callable[[MechanismChange], str]:
    def describe(change: MechanismChange) -> str:
        old, new, unit = change.numbers.get("before"), change.numbers.get("after"), change.words.get("unit", "")
        if old is None:
            return f"{name} is now {_format_number(new)} {unit}"
        if new is None:
            return f"{name} {_format_number(old)} {unit} is gone"
        share = format_share(old, new) if unit not in {"rad", "m"} else ""
        digits = _choose_digits(old, new)
        return f"{name} {_format_number(old, digits)} → {_format_number(new, digits)} {unit}{share}"

    return describe


def _choose_digits(first: float, second: float) -> int:
    """Return the fewest significant digits, at least 4, in which two numbers differ."""
    return next((digits for digits in range(4, 12) if f"{first:.{digits}g}" != f"{second:.{digits}g}"), 12)


def _format_number(value: float | None, digits: int = 4) -> str:
    return "unknown" if value is None else f"{value:.{digits}g}"


def _describe_mass(change: MechanismChange) -> str:
    old, new = change.numbers["before"], change.numbers["after"]
    digits = _choose_digits(old, new)
    return f"mass {_format_number(old, digits)} → {_format_number(new, digits)} kg{format_share(old, new)}"


def _describe_com(change: MechanismChange) -> str:
    shift = [change.numbers[f"shift_{axis}"] for axis in "xyz"]
    return f"COM moves by {format_size(change.numbers['distance'])} ({_format_vector(shift)})"


def _describe_tensor(change: MechanismChange) -> str:
    numbers = change.numbers
    if not numbers:
        return "inertia tensor came or went"
    olds, news = ([numbers[f"{name}_{place}"] for place in "123"] for name in ("before", "after"))
    if all(abs(a - b) <= 1e-5 * max(map(abs, (*olds, *news))) for a, b in zip(olds, news, strict=True)):
        return "inertia tensor is rotated; its principal moments are the same"
    return f"principal moments {_join_moments(olds)} → {_join_moments(news)} kg m²"


def _join_moments(moments: Iterable[float]) -> str:
    return ", ".join(f"{moment:.3g}" for moment in moments)


def _describe_rename(change: MechanismChange) -> str:
    text = f"is now called {change.new_name}"
    if change.numbers.get("confidence", 1.0) < 1.0:
        text += f" (matched by place and content, {change.numbers['confidence']:.0%})"
    return f"{text}; the old name is still used by {change.words['users']}" if change.words.get("users") else text


def _describe_lone(verb: str) -> Callable[[MechanismChange], str]:
    def describe(change: MechanismChange) -> str:
        words, numbers = change.words, change.numbers
        mass = f", {numbers['mass']:.4g} kg" if numbers["mass"] else ""
        others = words["links"].split(", ")[1:]
        more = f" with {join_names(others, 3)}" if others else ""
        return f"{verb}{more} ({words['type']} joint {words['joint']} on {words['parent']}{mass})"

    return describe


def _describe_shape(verb: str) -> Callable[[MechanismChange], str]:
    def describe(change: MechanismChange) -> str:
        words, numbers = change.words, change.numbers
        text = f"{words['role']} {verb}"
        if "before" in words:
            text += f": {words['before']} → {words['after']}"
        elif "shape" in words:
            text += f" ({words['shape']})"
        if "distance" in numbers:
            moved = [f"by {format_size(numbers['distance'])}"] if numbers["distance"] > 1e-6 else []
            moved += (
                [f"{'and ' if moved else ''}rotated by {format_angle(numbers['angle'])}"]
                if numbers["angle"] > 1e-6
                else []
            )
            text += f" {' '.join(moved)}"
        if "volume_before" in numbers:
            old, new = numbers["volume_before"], numbers["volume_after"]
            digits = _choose_digits(old, new)
            text += f", volume {old:.{digits}g} → {new:.{digits}g} m³{format_share(old, new)}"
        if "bounds" in numbers:
            text += f", bounds differ by up to {format_size(numbers['bounds'])}"
        text += _READABLE[words["read"]] if "read" in words else ""
        if "surface_gone" in numbers:
            text += f", {_describe_surface(numbers)}"
        return text + (f", now {words['closed']}" if "closed" in words else "")

    return describe


_READABLE = {
    "only now": ", which can be read; the file before cannot",
    "no longer": ", which cannot be read; the file before can",
    "neither": "; neither file can be read",
}


def _describe_surface(numbers: Mapping[str, float]) -> str:
    """Return how far the surfaces of two meshes are from each other, with what may lie between the points examined."""
    gone, come, error = (numbers[f"surface_{name}"] for name in ("gone", "come", "error"))
    if max(gone, come) <= _SAME_SURFACE:
        return f"the same surface (at points {format_size(error)} apart)"
    if abs(come - gone) <= error:
        return f"surfaces up to {format_size(max(gone, come))} apart (± {format_size(error)})"
    sides = (
        f"the {one} surface up to {format_size(distance)} from the {other} one"
        for one, other, distance in (("new", "old", come), ("old", "new", gone))
        if distance > _SAME_SURFACE
    )
    return f"{' and '.join(sides)} (± {format_size(error)})"


def _describe_base(change: MechanismChange) -> str:
    if change.words["held"] == "yes":
        return f"is held to the ground now: the root is {change.words['after']}"
    return f"no longer holds the robot to the ground: the root is {change.words['after']}"


def _describe_axis_tilt(change: MechanismChange) -> str:
    return f"axis is tilted by {format_angle(change.numbers['angle'])}"


def _describe_axis_shift(change: MechanismChange) -> str:
    return f"axis is {format_size(change.numbers['distance'])} beside its old line"


def _describe_pair(text: str) -> Callable[[MechanismChange], str]:
    return lambda change: text.format(**change.words, new_name=change.new_name)


_WORDS: Mapping[str, Callable[[MechanismChange], str]] = {
    "base": _describe_base,
    "root": _describe_pair("is no longer the root: that is {after}"),
    "link-renamed": _describe_rename,
    "joint-renamed": _describe_rename,
    "link-added": _describe_lone("is new"),
    "link-removed": _describe_lone("is gone"),
    "link-split": _describe_lone("is a new part of the same body"),
    "link-merged": _describe_lone("is merged into its body"),
    "reparented": _describe_pair("is attached to {after} instead of {before}"),
    "joint-replaced": _describe_pair("({before}) is replaced by {new_name} ({after})"),
    "joint-moved": _describe_move,
    "zero-offset": _describe_offset,
    "type": _describe_pair("type {before} → {after}"),
    "joint-frame": _describe_pair("({type}) has another frame, in which its position is given"),
    "axis-reversed": _describe_pair("axis is reversed"),
    "axis-tilted": _describe_axis_tilt,
    "axis-shifted": _describe_axis_shift,
    "mimic": _describe_pair("follows {after} instead of {before}"),
    **{name: _describe_value(f"{name} limit") for name in ("lower", "upper", "effort", "velocity")},
    **{name: _describe_value(name) for name in ("damping", "friction")},
    "mass": _describe_mass,
    "com": _describe_com,
    "tensor": _describe_tensor,
    "shape-added": _describe_shape("is new"),
    "shape-removed": _describe_shape("is gone"),
    "shape-moved": _describe_shape("is moved"),
    "shape-pose": _describe_shape("has an origin that came or went malformed"),
    "shape-resized": _describe_shape("has another size"),
    "shape-replaced": _describe_shape("is replaced"),
    "mesh-changed": _describe_shape("has another content"),
    "material": _describe_pair("{role} has another colour or texture"),
    "frame-moved": _describe_pair("has its frame elsewhere; its mass, shapes and children stay"),
    "robot-renamed": _describe_pair("name {before} → {after}"),
    "extra-added": _describe_pair("is new"),
    "extra-removed": _describe_pair("is gone"),
    "extra-changed": _describe_pair("changes"),
}


# -- verdicts ----------------------------------------------------------------------------------------------------------


def judge_change(found: MechanismDiff, *, has_equal_texts: bool, depends_on_arguments: bool) -> tuple[str, str]:
    """Return the verdict on a comparison, one of `VERDICTS`, and its line.

    ``depends_on_arguments``: whether the versions may differ with other arguments.
    """
    categories = {change.category for change in found.changes}
    verdict = next((category for category in CATEGORIES if category in categories), None)
    if verdict is None:
        if has_equal_texts and not found.notes:
            return IDENTICAL, "identical"
        notes = f" ({format_count(len(found.notes), 'note')})" if found.notes else ""
        condition = " with these arguments" if depends_on_arguments else ""
        return COSMETIC, f"cosmetic: the robot is the same{condition}{notes}"
    if verdict == "structure":
        return verdict, _join([_count_structure(found), _describe_motion(found.shifts, found)])
    if verdict == "kinematic":
        first = next(change for change in found.changes if change.category == "kinematic")
        return verdict, _describe_motion(found.shifts, found) or f"kinematics change: {describe_change(first)}"
    same = "kinematically identical"
    if verdict == "dynamic":
        return verdict, f"{same}; {_describe_dynamics(found)}"
    own = [change for change in found.changes if change.category == verdict]
    if verdict == "limits":
        return verdict, f"{same}; {_describe_first(own)}"
    if verdict == "extension":
        return verdict, f"links, joints and shapes are identical; {_describe_first(own)}"
    return verdict, f"kinematically and dynamically identical; {_describe_first(own)}"


def _describe_first(changes: list[MechanismChange]) -> str:
    more = f" (and {format_count(len(changes) - 1, 'more change')})" if len(changes) > 1 else ""
    return f"{describe_change(changes[0])}{more}"


def _join(parts: Iterable[str]) -> str:
    return "; ".join(filter(None, parts))


def _count_structure(found: MechanismDiff) -> str:
    own = [change for change in found.changes if change.category == "structure"]
    if len(own) == 1:
        return f"structure changes: {describe_change(own[0])}"
    names = {
        "base": "the base is held differently",
        "root": "another root",
        "link-renamed": "link renamed",
        "joint-renamed": "joint renamed",
        "link-added": "link added",
        "link-removed": "link removed",
        "reparented": "link on another parent",
        "joint-replaced": "joint replaced",
    }
    counts = {name: sum(change.id == name for change in own) for name in names}
    parts = [
        text if name in {"base", "root"} else f"{counts[name]} {_pluralize(text, counts[name])}"
        for name, text in names.items()
        if counts[name]
    ]
    return f"structure changes: {', '.join(parts)}"


def _pluralize(text: str, count: int) -> str:
    noun, _, rest = text.partition(" ")
    return text if count == 1 else f"{noun}s {rest}"


def _describe_motion(shifts: tuple[LinkShift, ...], found: MechanismDiff) -> str:
    if not shifts:
        return ""
    worst = shifts[0]
    if alike := _describe_alike(shifts):
        return alike
    if worst.distance <= _SAME_PLACE:
        return f"{worst.link} rotates by up to {format_angle(worst.angle)} and stays at its place"
    if not worst.configuration:
        return f"{worst.link} moves by {format_size(worst.distance)} in every configuration"
    positions = format_configuration(worst.configuration)
    return (
        f"{worst.link} moves by up to {format_size(worst.distance)} "
        f"(worst of {found.samples} configurations at {positions})"
    )


def _describe_alike(shifts: Sequence[LinkShift]) -> str:
    """Return that several branches move as far as the one that moves farthest; empty where they do not.

    Of each branch the link is named that would be alone.
    """
    size, is_constant = format_size(shifts[0].distance), not shifts[0].configuration
    alike = [s for s in shifts if format_size(s.distance) == size and bool(s.configuration) != is_constant]
    ends: dict[str, str] = {}
    for shift in alike:
        ends.setdefault(shift.branch, shift.link)
    if shifts[0].distance <= _SAME_PLACE or len(ends) == 1:
        return ""
    names = sorted(ends.values())[:_MOST_ALIKE]
    named = ", ".join([*names, "…"] if len(alike) > len(names) else names)
    how = f"by {size} in every configuration" if is_constant else f"by up to {size}"
    return f"{len(alike)} links move {how} ({named})"


def _describe_dynamics(found: MechanismDiff) -> str:
    parts = []
    if found.torques:
        worst = found.torques[0]
        share = abs(worst.after - worst.before) / max(worst.before, 1e-12)
        amount = f" by {format_percent(share)}" if worst.before > 1e-9 else ""
        parts.append(
            f"dynamics change{amount} (worst gravity torque of {worst.joint} "
            f"{format_pair(worst.before, worst.after)} {worst.unit})"
        )
    before, after = found.mass
    if abs(after - before) > 1e-5 * max(before, after):
        parts.append(f"mass {format_pair(before, after)} kg{format_share(before, after)}")
    if not parts:
        own = [change for change in found.changes if change.category == "dynamic"]
        parts.append(_describe_first(own))
    return _join(parts)


def format_pair(before: float, after: float) -> str:
    """Return ``4.74 → 5.02``, with as many digits as the numbers need to differ."""
    digits = min(_choose_digits(before, after), 6)
    digits = next((d for d in range(2, 7) if abs(after - before) > 10.0 ** -(d - 1) * max(before, after) / 2), digits)
    return f"{before:.{digits}g} → {after:.{digits}g}"
