"""XAC015 reports a URDF and a xacro of one robot that differ."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

from urdfcheck.core import Finding, Rule
from urdfcheck.core.text import join_names
from urdfcheck.export.outline import ModelOutline

# Of the name of a part, in characters, of which none that was typed has so many.
_MAX_NAME_LENGTH = 1_000


@dataclass(frozen=True, slots=True)
class _ModelDifference:
    """What differs between two outlines. ``values``: parts that both have with other values."""

    names: bool
    values: tuple[str, ...]
    only_urdf: tuple[str, ...]
    only_xacro: tuple[str, ...]
    extensions: tuple[str, ...]

    @property
    def weight(self) -> int:
        return len(self.values) + len(self.only_urdf) + len(self.only_xacro)

    def __bool__(self) -> bool:
        return bool(self.names or self.weight or self.extensions)


def check(outlines: list[ModelOutline], rule: Rule, *, overlap: float, links: int) -> Iterator[Finding]:
    for urdf in outlines:
        if urdf.is_xacro or urdf.package is None or len(urdf.links) < links:
            continue
        copies = [
            o for o in outlines if o.is_xacro and o.package == urdf.package and _compute_overlap(urdf, o) >= overlap
        ]
        if not copies:
            continue
        # Of several variants of the xacro, the one that the URDF was made from is the nearest.
        xacro = min(copies, key=lambda o: (_compare_outlines(urdf, o).weight, o.model))
        difference = _compare_outlines(urdf, xacro)
        if difference:
            yield replace(_build_finding(urdf, xacro, difference, rule), model=urdf.model)


def _build_finding(urdf: ModelOutline, xacro: ModelOutline, difference: _ModelDifference, rule: Rule) -> Finding:
    return rule.finding(
        "diverged" if difference.weight else "equal-bodies",
        at=urdf.location,
        related=[xacro.location],
        urdf=urdf.path,
        xacro=xacro.path,
        names=[urdf.robot, xacro.robot],
        values=list(difference.values),
        only_urdf=list(difference.only_urdf),
        only_xacro=list(difference.only_xacro),
        differ="; ".join(_describe_differences(urdf, xacro, difference)),
    )


def _describe_differences(urdf: ModelOutline, xacro: ModelOutline, difference: _ModelDifference) -> Iterator[str]:
    if difference.names:
        yield f"the robot's name ({urdf.robot!r} and {xacro.robot!r})"
    if difference.values:
        told = [f"{part}: {_format_part(urdf, part)} and {_format_part(xacro, part)}" for part in difference.values]
        yield f"{_format_count(difference.values, 'value')} ({join_names(told, 3)})"
    for only, where in ((difference.only_urdf, "URDF"), (difference.only_xacro, "xacro")):
        if only:
            yield f"{_format_count(only, 'part')} only in the {where} ({join_names(only, 3)})"
    if difference.extensions:
        yield f"extensions ({', '.join(difference.extensions)})"


def _format_part(outline: ModelOutline, part: str) -> str:
    return " ".join(outline.parts[part]) or "nothing"


def _format_count(things: Sequence[str], what: str) -> str:
    return f"{len(things)} {what}{'' if len(things) == 1 else 's'}"


def _compare_outlines(urdf: ModelOutline, xacro: ModelOutline) -> _ModelDifference:
    both = urdf.parts.keys() & xacro.parts.keys()
    tags = sorted({*urdf.extensions, *xacro.extensions})
    return _ModelDifference(
        urdf.robot != xacro.robot,
        tuple(sorted(p for p in both if urdf.parts[p] != xacro.parts[p])),
        _reduce_to_top_parts(urdf.parts.keys() - both, xacro.parts),
        _reduce_to_top_parts(xacro.parts.keys() - both, urdf.parts),
        tuple(
            f"{urdf.extensions.get(t, 0)} and {xacro.extensions.get(t, 0)} <{t}>"
            for t in tags
            if urdf.extensions.get(t, 0) != xacro.extensions.get(t, 0)
        ),
    )


def _reduce_to_top_parts(parts: Iterable[str], other: Iterable[str]) -> tuple[str, ...]:
    """Parts that only one has: what the other lacks altogether (a link, a collision) counts once, by its name."""
    known = {prefix for part in other for prefix in _list_prefixes(part)}
    return tuple(sorted({next((p for p in _list_prefixes(part) if p not in known), part) for part in parts}))


def _list_prefixes(part: str) -> list[str]:
    """``link[a]``, ``link[a]/inertial``, ``link[a]/inertial/mass``, ``link[a]/inertial/mass@value``."""
    if len(part) > _MAX_NAME_LENGTH:  # its prefixes would have more characters than there is memory for
        return [part]
    return [part[: m.start()] for m in re.finditer(r"[/@](?![^\[]*\])", part)] + [part]


def _compute_overlap(one: ModelOutline, other: ModelOutline) -> float:
    """Jaccard index of the names of links and joints."""
    a = {*(("link", n) for n in one.links), *(("joint", n) for n in one.joints)}
    b = {*(("link", n) for n in other.links), *(("joint", n) for n in other.joints)}
    return len(a & b) / len(a | b) if a | b else 0.0
