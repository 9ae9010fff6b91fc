"""KIN002: joints that name a link which does not exist."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Edit, Finding, Rule
from urdfcheck.model import Model
from urdfcheck.model.graph import Graph
from urdfcheck.model.names import listed
from urdfcheck.source.xml import Attribute


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    graph = Graph.of(model)
    for joint in graph.broken:
        for role, name in (("parent", joint.parent), ("child", joint.child)):
            element = joint.element.child(role)
            attribute = element.attributes.get("link") if element is not None else None
            if not name or name in graph.links or attribute is None:
                continue  # XML005 reports a name that is missing
            data = {"joint": joint.name, "role": role, "called": name, "links": listed(graph.links)}
            near = graph.meant(role, name)
            if near is None:
                yield rule.finding("unknown", at=attribute, related=attribute.related(), **data)
            else:
                yield rule.finding("near", at=attribute, edits=_edit(attribute, near), near=near, **data)


def _edit(attribute: Attribute, near: str) -> tuple[Edit, ...]:
    if not attribute.literal or attribute.span is None:
        return ()
    return (Edit(attribute.span, attribute.typed, near),)
