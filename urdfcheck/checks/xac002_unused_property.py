"""XAC002 reports properties in a model's own files that are never read."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from urdfcheck.core import Finding, Rule
from urdfcheck.core.text import join_names
from urdfcheck.model import Model
from urdfcheck.model.shapes.extent import measure_link_size
from urdfcheck.source.load import Source, select_own_trees
from urdfcheck.source.text.tokens import build_removal_edits
from urdfcheck.source.text.values import parse_number
from urdfcheck.source.text.xml import Attribute
from urdfcheck.source.uses_elsewhere import collect_outside_mentions, has_unseen_includes
from urdfcheck.source.xacro.usage import collect_properties, collect_read_names

# The name of such a property means a side of a link: base_x is one of base or base_link.
_SIDE = re.compile(r"^(\w+?)_(?:size_|dim_)?([xyz])$")


def check(model: Model, rule: Rule, *, each: int, near: float) -> Iterator[Finding]:
    source = model.source
    if not source.is_xacro or has_unseen_includes(source):
        return
    by_file: dict[str, list[list[Attribute]]] = {}
    for definitions in _find_unread_properties(source):
        by_file.setdefault(definitions[0].location.file, []).append(definitions)
    for file, unread in by_file.items():
        if len(unread) > each:
            yield _build_summary_finding(file, unread, rule)
            continue
        for definitions in unread:
            yield _build_property_finding(model, rule, definitions, near=near)


def _find_unread_properties(source: Source) -> list[list[Attribute]]:
    """Return the definitions of each property that nothing reads; those with a scope are for other files."""
    read = set().union(*(collect_read_names(tree) for tree in source.trees.values()))
    unread = {
        name: definitions
        for name, definitions in collect_properties(select_own_trees(source)).items()
        if name not in read and not any("scope" in d.owner.attributes for d in definitions)
    }
    elsewhere = collect_outside_mentions(source) if unread else None
    if elsewhere is None or not elsewhere.complete:
        return []
    return [definitions for name, definitions in unread.items() if name not in elsewhere.names]


def _build_property_finding(model: Model, rule: Rule, definitions: Sequence[Attribute], *, near: float) -> Finding:
    first, *others = definitions
    value = first.owner.get("value") or first.owner.get("default")
    wrong = _find_mismatched_side(model, first.value, value, near=near)
    return rule.finding(
        "unused" if wrong is None else "wrong",
        at=first,
        related=others,
        edits=[] if others or first.owner.children else build_removal_edits(first.owner, model.source.files),
        name=first.value,
        value=f" = {value}" if value else "",
        link="" if wrong is None else wrong[0],
        sides="" if wrong is None else " × ".join(f"{side:.3f}" for side in wrong[1]),
    )


def _find_mismatched_side(model: Model, name: str, value: str, *, near: float) -> tuple[str, tuple[float, ...]] | None:
    """Return the link that a property names and its sides (m), if neither the named side nor half of it has this value."""
    named, typed = _SIDE.match(name), parse_number(value)
    if named is None or typed is None:
        return None
    link = model.link_by_name.get(named.group(1)) or model.link_by_name.get(f"{named.group(1)}_link")
    sides = None if link is None else measure_link_size(model, link)
    if link is None or sides is None:
        return None
    side = sides["xyz".index(named.group(2))]
    agrees = any(abs(abs(typed) - length) <= near * length for length in (side, side / 2))
    return None if agrees else (link.name, sides)


def _build_summary_finding(file: str, unread: Sequence[Sequence[Attribute]], rule: Rule) -> Finding:
    names = [definitions[0].value for definitions in unread]
    places = [d for definitions in unread for d in definitions]
    return rule.finding(
        "several", at=places[0], related=places[1:], names=names, listed=join_names(names), count=len(names), file=file
    )
