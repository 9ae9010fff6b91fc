"""XAC015: a URDF and a xacro that describe one robot agree."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

from urdfcheck.core import Finding, Rule
from urdfcheck.core.text import listed
from urdfcheck.export.outline import Outline

# Of the name of a part, in characters, of which none that was typed has so many.
_LONGEST = 1_000


@dataclass(frozen=True, slots=True)
class _Difference:
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


def check(outlines: list[Outline], rule: Rule, *, overlap: float, links: int) -> Iterator[Finding]:
    for urdf in outlines:
        if urdf.is_xacro or urdf.package is None or len(urdf.links) < links:
            continue
        copies = [o for o in outlines if o.is_xacro and o.package == urdf.package and _overlap(urdf, o) >= overlap]
        if not copies:
            continue
        # Of several variants of the xacro, the one that the URDF was made from is the nearest.
        xacro = min(copies, key=lambda o: (_difference(urdf, o).weight, o.model))
        difference = _difference(urdf, xacro)
        if difference:
            yield replace(_finding(urdf, xacro, difference, rule), model=urdf.model)


def _finding(urdf: Outline, xacro: Outline, difference: _Difference, rule: Rule) -> Finding:
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
        differ="; ".join(_sentences(urdf, xacro, difference)),
    )


def _sentences(urdf: Outline, xacro: Outline, difference: _Difference) -> Iterator[str]:
    if difference.names:
        yield f"the robot's name ({urdf.robot!r} and {xacro.robot!r})"
    if difference.values:
        told = [f"{part}: {_text(urdf, part)} and {_text(xacro, part)}" for part in difference.values]
        yield f"{_counted(difference.values, 'value')} ({listed(told, 3)})"
    for only, where in ((difference.only_urdf, "URDF"), (difference.only_xacro, "xacro")):
        if only:
            yield f"{_counted(only, 'part')} only in the {where} ({listed(only, 3)})"
    if difference.extensions:
        yield f"extensions ({', '.join(difference.extensions)})"


def _text(outline: Outline, part: str) -> str:
    return " ".join(outline.parts[part]) or "nothing"


def _counted(things: Sequence[str], what: str) -> str:
    return f"{len(things)} {what}{'' if len(things) == 1 else 's'}"


def _difference(urdf: Outline, xacro: Outline) -> _Difference:
    both = urdf.parts.keys() & xacro.parts.keys()
    tags = sorted({*urdf.extensions, *xacro.extensions})
    return _Difference(
        urdf.robot != xacro.robot,
        tuple(sorted(p for p in both if urdf.parts[p] != xacro.parts[p])),
        _tops(urdf.parts.keys() - both, xacro.parts),
        _tops(xacro.parts.keys() - both, urdf.parts),
        tuple(
            f"{urdf.extensions.get(t, 0)} and {xacro.extensions.get(t, 0)} <{t}>"
            for t in tags
            if urdf.extensions.get(t, 0) != xacro.extensions.get(t, 0)
        ),
    )


def _tops(parts: Iterable[str], other: Iterable[str]) -> tuple[str, ...]:
    """Parts that only one has: what the other lacks altogether (a link, a collision) counts once, by its name."""
    known = {prefix for part in other for prefix in _prefixes(part)}
    return tuple(sorted({next((p for p in _prefixes(part) if p not in known), part) for part in parts}))


def _prefixes(part: str) -> list[str]:
    """``link[a]``, ``link[a]/inertial``, ``link[a]/inertial/mass``, ``link[a]/inertial/mass@value``."""
    if len(part) > _LONGEST:  # its prefixes would have more characters than there is memory for
        return [part]
    return [part[: m.start()] for m in re.finditer(r"[/@](?![^\[]*\])", part)] + [part]


def _overlap(one: Outline, other: Outline) -> float:
    """Jaccard index of the names of links and joints."""
    a = {*(("link", n) for n in one.links), *(("joint", n) for n in one.joints)}
    b = {*(("link", n) for n in other.links), *(("joint", n) for n in other.joints)}
    return len(a & b) / len(a | b) if a | b else 0.0
