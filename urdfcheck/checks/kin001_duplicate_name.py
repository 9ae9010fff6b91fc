"""KIN001: two links, two joints, or a link and a joint of one name."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from urdfcheck.core import Finding, Location, Rule, Severity
from urdfcheck.model import Joint, Link, Model


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    yield from _repeated(model.links, "link", rule)
    yield from _repeated(model.joints, "joint", rule)
    for joint in model.joint_by_name.values():
        link = model.link_by_name.get(joint.name)
        # Converters merge the two links of a fixed joint: its name disappears before it can clash.
        if link is not None and joint.name and joint.type != "fixed":
            yield rule.finding(
                "shared", at=_name(joint), severity=Severity.WARNING, related=[_name(link)], called=joint.name
            )


def _repeated(parts: Sequence[Link] | Sequence[Joint], kind: str, rule: Rule) -> Iterator[Finding]:
    first: dict[str, Link | Joint] = {}
    for part in parts:
        if part.name and first.setdefault(part.name, part) is not part:
            related = [_name(first[part.name])]
            yield rule.finding("repeated", at=_name(part), related=related, kind=kind, called=part.name)


def _name(part: Link | Joint) -> Location:
    attribute = part.element.attributes.get("name")
    return part.location if attribute is None else attribute.location
