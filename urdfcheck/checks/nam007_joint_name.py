"""NAM007 reports joint names that disagree with the links that the joint connects."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from urdfcheck.core import Finding, Rule
from urdfcheck.core.text import join_names, split_name_words
from urdfcheck.model import Joint, Link, Model

# Words for the kind of a part, which do not identify it.
_KINDS = frozenset({"joint", "jnt", "link", "lnk", "frame", "fixed"})
_SIDES = frozenset({"left", "right", "l", "r", "front", "rear", "back"})


def check(model: Model, rule: Rule, *, least: int) -> Iterator[Finding]:
    yield from _build_findings("reversed", [joint for joint in model.joints if _is_reversed(joint)], rule)
    yield from _build_findings("other", list(_find_misnamed_joints(model, least)), rule)
    # `base_to_arm_link` ends in the name of a link; KIN001 reports a moving joint with the name of a link.
    joints = [j for j in model.joints if not any(j.name.endswith(link) for link in (j.parent, j.child) if link)]
    yield from _build_findings("link-as-joint", [j for j in joints if _has_kind_suffix(j.name, "link", "joint")], rule)
    yield from _build_findings(
        "joint-as-link", [link for link in model.links if _has_kind_suffix(link.name, "joint", "link")], rule
    )


def _build_findings(message: str, parts: list[Joint] | list[Link], rule: Rule) -> Iterator[Finding]:
    """Report all names with one mistake together: they come from one habit."""
    if not parts:
        return
    first, names = parts[0], [part.element.attributes["name"] for part in parts]
    parent, child = (first.parent, first.child) if isinstance(first, Joint) else ("", "")
    finding = rule.finding(
        message,
        at=names[0],
        related=names[1:10],
        names=join_names(attribute.value for attribute in names),
        parent=parent,
        child=child,
    )
    yield replace(finding, subjects=tuple(attribute.location.subject for attribute in names))


def _is_reversed(joint: Joint) -> bool:
    """Whether ``A_to_B`` goes from B to A."""
    start, to, end = joint.name.partition("_to_")
    named = _build_name_key(start), _build_name_key(end)
    if not to or not all(named) or named[0] == named[1]:
        return False
    return named == (_build_name_key(joint.child), _build_name_key(joint.parent))


def _find_misnamed_joints(model: Model, least: int) -> Iterator[Joint]:
    """Yield joints that are named after another link than their child, with another number or side.

    Nothing if fewer than ``least`` joints of the model are named after their child.
    """
    keys = [(_build_name_key(joint.name), _build_name_key(joint.child)) for joint in model.joints]
    if sum(bool(name) and name == child for name, child in keys) < least:
        return
    links = {_build_name_key(link.name) for link in model.links}
    for joint, (name, child) in zip(model.joints, keys, strict=True):
        if (
            name in links
            and name not in {child, _build_name_key(joint.parent)}
            and _replace_number_and_side(name) == _replace_number_and_side(child)
        ):
            yield joint


def _build_name_key(name: str) -> tuple[str, ...]:
    """Return the words that identify a part, in lower case."""
    return tuple(word for word in map(str.lower, split_name_words(name)) if word not in _KINDS)


def _replace_number_and_side(key: tuple[str, ...]) -> tuple[str, ...]:
    return tuple("#" if word.isdigit() else "side" if word in _SIDES else word for word in key)


def _has_kind_suffix(name: str, kind: str, other: str) -> bool:
    """Whether a name ends in the word for one kind and does not contain the word for the other."""
    parts = [word.lower() for word in split_name_words(name)]
    return len(parts) > 1 and parts[-1] == kind and other not in parts
