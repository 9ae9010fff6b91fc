"""XAC015 reports a URDF and a xacro of one robot that differ."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator
from dataclasses import replace

from urdfcheck.core import Finding, Rule
from urdfcheck.core.records import dataclass
from urdfcheck.core.text import format_count, join_names
from urdfcheck.export.outline import ModelOutline, Value
from urdfcheck.source.text.values import parse_number

# No typed name of a part has more characters.
_MAX_NAME_LENGTH = 1_000
# Python 2 prints 12 significant digits.
_PRINTED = 1e-11


@dataclass(frozen=True, slots=True, kw_only=True)
class _ModelDifference:
    """The differences between the outlines of a URDF and a xacro."""

    names: bool
    """Whether the robots have different names."""
    values: tuple[str, ...]
    """Parts of both with different values."""
    only_urdf: tuple[str, ...]
    """Parts that the xacro lacks."""
    only_xacro: tuple[str, ...]
    """Parts that the URDF lacks."""
    extensions: tuple[str, ...]
    """Extension elements whose numbers differ, in words."""
    hardware: bool
    """Whether ros2_control loads other hardware."""

    @property
    def weight(self) -> int:
        """The number of parts that differ."""
        return len(self.values) + len(self.only_urdf) + len(self.only_xacro)

    def __bool__(self) -> bool:
        return bool(self.names or self.weight or self.extensions or self.hardware)


def check(outlines: list[ModelOutline], rule: Rule, *, overlap: float, links: int) -> Iterator[Finding]:
    outlines = [outline for outline in outlines if outline.is_complete]
    for urdf in outlines:
        if urdf.is_xacro or urdf.package is None or len(urdf.links) < links:
            continue
        copies = [o for o in outlines if _is_second_description(o, urdf) and _compute_overlap(urdf, o) >= overlap]
        if not copies:
            continue
        # The URDF was made from the most similar variant of the xacro.
        xacro = min(copies, key=lambda o: (_compare_outlines(urdf, o).weight, o.model))
        difference = _compare_outlines(urdf, xacro)
        if difference:
            yield replace(_build_finding(rule, urdf, xacro, difference=difference), model=urdf.model)


def _is_second_description(xacro: ModelOutline, urdf: ModelOutline) -> bool:
    """Whether an outline is that of a xacro in the URDF's package that has its own description, and does not include the URDF."""
    return xacro.is_xacro and xacro.package == urdf.package and urdf.path not in xacro.files


def _build_finding(rule: Rule, urdf: ModelOutline, xacro: ModelOutline, *, difference: _ModelDifference) -> Finding:
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
        repair=_describe_repair(urdf, xacro, difference),
    )


def _describe_repair(urdf: ModelOutline, xacro: ModelOutline, difference: _ModelDifference) -> str:
    """Return the repair: the source is the file that xacro did not make, and variants may have one source."""
    if xacro.is_output_of_xacro and not urdf.is_output_of_xacro:
        return f"delete {xacro.path}, which says that xacro made it from another file, or make it again"
    reason = "each is for its own hardware" if difference.hardware else "they are meant to differ"
    step = f"delete the one that nothing loads, or once {xacro.path} has all,"
    if difference.weight:
        step = f"bring into {xacro.path} what is right in the URDF only, and"
    return f"nothing if {reason}; otherwise {step} generate {urdf.path}: `xacro {xacro.path} > {urdf.path}`"


def _describe_differences(urdf: ModelOutline, xacro: ModelOutline, difference: _ModelDifference) -> Iterator[str]:
    if difference.names:
        yield f"the robot's name ({urdf.robot!r} and {xacro.robot!r})"
    if difference.values:
        values = (f"{part}: {_format_part(urdf, part)} and {_format_part(xacro, part)}" for part in difference.values)
        yield f"{format_count(len(difference.values), 'value')} ({join_names(values, 3)})"
    for only, where in ((difference.only_urdf, "URDF"), (difference.only_xacro, "xacro")):
        if only:
            yield f"{format_count(len(only), 'part')} only in the {where} ({join_names(only, 3)})"
    if difference.hardware:
        yield f"the hardware ({join_names(urdf.hardware)} and {join_names(xacro.hardware)})"
    if difference.extensions:
        yield f"extensions ({', '.join(difference.extensions)})"


def _format_part(outline: ModelOutline, part: str) -> str:
    return " ".join(outline.parts[part]) or "nothing"


def _compare_outlines(urdf: ModelOutline, xacro: ModelOutline) -> _ModelDifference:
    both = urdf.parts.keys() & xacro.parts.keys()
    tags = sorted({*urdf.extensions, *xacro.extensions})
    return _ModelDifference(
        names=urdf.robot != xacro.robot,
        hardware=bool(urdf.hardware and xacro.hardware) and sorted(urdf.hardware) != sorted(xacro.hardware),
        values=tuple(sorted(p for p in both if not _are_equal(urdf.parts[p], xacro.parts[p]))),
        only_urdf=_reduce_to_top_parts(urdf.parts.keys() - both, xacro.parts),
        only_xacro=_reduce_to_top_parts(xacro.parts.keys() - both, urdf.parts),
        extensions=tuple(
            f"{urdf.extensions.get(t, 0)} and {xacro.extensions.get(t, 0)} <{t}>"
            for t in tags
            if urdf.extensions.get(t, 0) != xacro.extensions.get(t, 0)
        ),
    )


def _are_equal(one: Value, other: Value) -> bool:
    """Whether two values are the same words and numbers, except for the last digits that two versions of Python print."""
    return len(one) == len(other) and all(a == b or _are_same_number(a, b) for a, b in zip(one, other, strict=True))


def _are_same_number(one: str, other: str) -> bool:
    a, b = parse_number(one), parse_number(other)
    return a is not None and b is not None and math.isclose(a, b, rel_tol=_PRINTED)


def _reduce_to_top_parts(parts: Iterable[str], other: Iterable[str]) -> tuple[str, ...]:
    """Reduce parts that only one model has to their outermost elements: a link or collision that the other lacks counts once."""
    known = {prefix for part in other for prefix in _list_prefixes(part)}
    return tuple(sorted({next((p for p in _list_prefixes(part) if p not in known), part) for part in parts}))


def _list_prefixes(part: str) -> list[str]:
    """Return ``link[a]``, ``link[a]/inertial``, ``link[a]/inertial/mass``, ``link[a]/inertial/mass@value``."""
    if len(part) > _MAX_NAME_LENGTH:  # its prefixes would have more characters than there is memory for
        return [part]
    return [part[: m.start()] for m in re.finditer(r"[/@](?![^\[]*\])", part)] + [part]


def _compute_overlap(one: ModelOutline, other: ModelOutline) -> float:
    """Return the Jaccard index of the names of links and joints."""
    a = {*(("link", n) for n in one.links), *(("joint", n) for n in one.joints)}
    b = {*(("link", n) for n in other.links), *(("joint", n) for n in other.joints)}
    return len(a & b) / len(a | b) if a | b else 0.0
