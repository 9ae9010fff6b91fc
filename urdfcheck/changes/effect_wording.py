"""What follows from changes, in words: the parts first, then what happens to them, with the number that matters."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from urdfcheck.changes.wording import (
    format_pair,
    format_size,
    name_part,
)
from urdfcheck.core.model_diff import MechanismEffect
from urdfcheck.core.text import format_angle, format_configuration, format_share


def describe_effect(effect: MechanismEffect) -> str:
    """Return one line about an effect."""
    return _WORDS[effect.id](effect)


# -- collisions --------------------------------------------------------------------------------------------------------


def _describe_pair(verb: str, *, is_new: bool) -> Callable[[MechanismEffect], str]:
    """Return what describes a pair that collides in one version; ``is_new``: in the second."""

    def describe(effect: MechanismEffect) -> str:
        numbers, words = effect.numbers, effect.words
        kind = "the neighbours " if words["relation"] == "neighbours" else ""
        details = []
        if effect.id.startswith("pair"):
            hits, samples = int(numbers["hits"]), int(numbers["samples"])
            share = f"{hits} of {samples} configurations" if hits < samples else f"all {samples} configurations"
            details.append(f"{'' if is_new else 'before '}in {'the only configuration' if samples == 1 else share}")
        if "depth" in numbers:
            where = f" at {format_configuration(effect.configuration)}" if effect.configuration else ""
            details.append(f"by {format_size(numbers['depth'])}{where}")
        if "gap" in numbers:
            details.append(f"{format_size(numbers['gap'])} apart {'before' if is_new else 'now'}")
        text = f"{kind}{name_part(effect.subject)} and {name_part(effect.other)} {verb}"
        return f"{text} ({', '.join(details)})" if details else text

    return describe


# -- inertias ----------------------------------------------------------------------------------------------------------


def _describe_inertia(effect: MechanismEffect) -> str:
    before, after, unit = effect.numbers["before"], effect.numbers["after"], effect.words["unit"]
    where = f" at {format_configuration(effect.configuration)}" if effect.configuration else ""
    share, link = format_share(before, after), effect.words["main_link"]
    cause = f", mostly because of link {link}" if link else ""
    return f"{name_part(effect.subject)} accelerates {format_pair(before, after)} {unit}{share}{where}{cause}"


# -- stability ---------------------------------------------------------------------------------------------------------


def _describe_fall(effect: MechanismEffect) -> str:
    margin = abs(effect.numbers["margin_after"])
    return f"the robot falls over now: its COM is {format_size(margin)} outside its supports"


def _describe_stand(effect: MechanismEffect) -> str:
    return f"the robot no longer falls over: its COM is {_describe_margin(effect.numbers['margin_after'])} its supports"


def _describe_margin(margin: float) -> str:
    return f"{format_size(abs(margin))} {'within' if margin >= 0.0 else 'outside'}"


def _describe_support_margin(effect: MechanismEffect) -> str:
    numbers = effect.numbers
    before, after = (_describe_margin(numbers[f"margin_{side}"]) for side in ("before", "after"))
    angles = " → ".join(format_angle(numbers[f"tip_{side}"]) for side in ("before", "after"))
    return f"the COM is {before} → {after} the supports; the robot tips over at {angles}"


def _describe_lean(effect: MechanismEffect) -> str:
    return (
        f"the robot leans by {' → '.join(format_angle(effect.numbers[side]) for side in ('before', 'after'))} at rest"
    )


_WORDS: Mapping[str, Callable[[MechanismEffect], str]] = {
    "pair-collides": _describe_pair("collide now", is_new=True),
    "pair-clears": _describe_pair("no longer collide", is_new=False),
    "rest-collides": _describe_pair("collide at rest now", is_new=True),
    "rest-clears": _describe_pair("no longer collide at rest", is_new=False),
    "joint-inertia": _describe_inertia,
    "falls": _describe_fall,
    "stands": _describe_stand,
    "support-margin": _describe_support_margin,
    "lean": _describe_lean,
}
