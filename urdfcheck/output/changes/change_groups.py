"""Changes that say the same of several parts, in one line."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

from urdfcheck.core.model_diff import MechanismChange
from urdfcheck.core.text import join_names

# A change, and the line about it.
DescribedChange = tuple[MechanismChange, str]

_PART = re.compile(r"(link|joint)\[([^\]]*)\]", re.DOTALL)


def group_changes(changes: Iterable[DescribedChange]) -> list[list[DescribedChange]]:
    """Return the changes with those together that say the same of several parts, each group where its first change was."""
    groups: dict[tuple[str, ...], list[DescribedChange]] = {}
    for change, text in changes:
        kind, _, start = _split_subject(change.subject)
        said = "" if _is_plain_rename(change) else _strip_parent(change, text.removeprefix(start))
        groups.setdefault((change.category, change.id, kind, said), []).append((change, text))
    return list(groups.values())


def describe_group(group: Sequence[DescribedChange], most: int) -> str:
    """Return the line about a group, in which at most so many parts are named."""
    change, text = group[0]
    if len(group) == 1:
        return text
    kind, _, start = _split_subject(change.subject)
    names = [_split_subject(other.subject)[1] for other, _ in group]
    if _is_plain_rename(change):
        renamed = [f"{name} → {other.new_name}" for name, (other, _) in zip(names, group, strict=True)]
        least = min(other.numbers.get("confidence", 1.0) for other, _ in group)
        how = f" (matched by place and content, each at least {least:.0%})" if least < 1.0 else ""
        return f"{kind}s have other names: {join_names(renamed, most)}{how}"
    parts = f"{kind}s {join_names(names, most)}" if kind else join_names(names, most)
    said = text.removeprefix(start)
    if len({other.words.get("parent", "") for other, _ in group}) > 1:
        said = f"{_strip_parent(change, said)}, each in its parent link"
    return f"{parts}: {said.lstrip(' /')}"


def _strip_parent(change: MechanismChange, said: str) -> str:
    """Return the words about a joint that is moved, without the link that it is moved in."""
    return said.removesuffix(f" in link {change.words.get('parent', '')}") if change.id == "joint-moved" else said


def _is_plain_rename(change: MechanismChange) -> bool:
    """Whether a part has another name, and nothing uses the old one."""
    return change.id in {"link-renamed", "joint-renamed"} and not change.words.get("users")


def _split_subject(subject: str) -> tuple[str, str, str]:
    """Return the kind of a part, its name, and what its line begins with; no kind for anything outside links and joints."""
    match = _PART.match(subject)
    if match is None:
        return "", subject, subject
    return match[1], match[2], f"{match[1]} {match[2]}" if match[0] == subject else match[0]
