"""XAC009 reports repeated blocks that one macro could replace."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from pathlib import Path

from urdfcheck.core import Finding, Rule
from urdfcheck.core.records import dataclass
from urdfcheck.core.text import join_names
from urdfcheck.model.likeness.repeated_blocks import NumberColumn, classify_columns
from urdfcheck.source.load import Source, select_own_trees
from urdfcheck.source.package.file_kinds import is_xacro
from urdfcheck.source.text.remembered import tree_fact
from urdfcheck.source.text.values import parse_number
from urdfcheck.source.text.xml import Attribute, Element
from urdfcheck.source.xacro.usage import iter_elements_by_tag

# CAD exports of one part differ by this much, through rounding.
_TOLERANCES = {"rel_tol": 1e-6, "abs_tol": 1e-12}


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class _LinkBlock:
    """A link and the joint above it."""

    link: Element
    name: str
    columns: tuple[Attribute, ...]
    """All attributes, in the order of the structure."""
    structure: tuple[tuple[str, ...], ...]
    """The tag, level and attribute names of each element."""

    def get_value(self, column: int) -> str:
        """Return a value without the name of the block, so that values derived from the name are equal."""
        return self.columns[column].value.replace(self.name, "\0")

    def find_differing_columns(self, other: _LinkBlock) -> list[int]:
        """Return the columns in which two blocks of one structure differ."""
        return [i for i in range(len(self.columns)) if not _is_equal_value(self.get_value(i), other.get_value(i))]


def check(source: Source, rule: Rule, *, blocks: int, attributes: int, share: float) -> Iterator[Finding]:
    if not source.is_xacro:
        return
    for name, tree in select_own_trees(source).items():
        if not is_xacro(Path(name)):
            continue  # written by a program, and included unchanged
        for siblings in _collect_all_blocks(tree):
            candidates = [b for b in siblings if len(b.columns) >= attributes]
            for group in _group_blocks(candidates, share):
                if len(group) >= blocks:
                    yield _build_finding(group, rule)


def _build_finding(group: Sequence[_LinkBlock], rule: Rule) -> Finding:
    first = group[0]
    columns = sorted({i for other in group[1:] for i in first.find_differing_columns(other)})
    macro = _suggest_macro_name([b.name for b in group])
    differing = [_describe_attribute(first.columns[i]) for i in columns if first.columns[i].name != "name"]
    whole, split = _split_columns(group, columns)
    varies = classify_columns(split)
    parameters = [*(c.name for c in varies.parameters), *_name_parameters([first.columns[i] for i in whole])]
    given = {c.name: c.words[0] for c in varies.parameters}
    with_joint = any(labels[0] == "joint" for labels in first.structure)
    return rule.finding(
        "repeated",
        at=first.link,
        related=[b.link for b in group[1:]],
        count=len(group),
        links=[b.name for b in group],
        listed=join_names((b.name for b in group), 4),
        what="links with their joints" if with_joint else "links",
        differences=differing,
        differ=join_names(dict.fromkeys(differing)) or "nothing",
        macro=macro,
        parameters=" ".join(["name", *parameters]),
        call="".join(f' {p}="{given.get(p, "…")}"' for p in parameters),
        first=first.name,
        lone="".join(
            f"; only {group[i].name} has {c.name} {c.words[i]}, the others {rest}" for c, i, rest in varies.outliers
        ),
        derived=", with " * bool(varies.derived) + " and ".join(f"{name} `{e}`" for name, e in varies.derived),
        refused="".join(
            f"; this drops {c.name} {c.words[i]} of {group[i].name}: if it is meant, add `{c.name}:={rest}` to the params"
            for c, i, rest in varies.outliers
        ),
    )


def _split_columns(group: Sequence[_LinkBlock], columns: Sequence[int]) -> tuple[list[int], list[NumberColumn]]:
    """Split the differing columns into those that are one parameter each, and the numbers of all others."""
    whole, split = [], []
    for i in columns:
        attribute = group[0].columns[i]
        rows = [block.columns[i].value.split() for block in group]
        if any(len(row) != len(rows[0]) for row in rows) or any(
            parse_number(word) is None for row in rows for word in row
        ):
            whole.append(i)
            continue
        names = _name_numbers(attribute, len(rows[0]))
        for name, words in zip(names, zip(*rows, strict=True), strict=True):
            split.append(_make_number_column(attribute, name, words))
    names = [c.name for c in split]
    # The x of two origins would be one name: then whole attributes are the parameters.
    if len(set(names)) < len(names):
        return list(columns), []
    return whole, split


def _make_number_column(attribute: Attribute, name: str, words: tuple[str, ...]) -> NumberColumn:
    is_coordinate = _describe_attribute(attribute) == "joint origin xyz"
    return NumberColumn(name, words, is_coordinate=is_coordinate, is_angle=attribute.name == "rpy")


def _name_numbers(attribute: Attribute, count: int) -> list[str]:
    """Name each number of an attribute: x y z and roll pitch yaw for the joint's origin, else after the attribute."""
    place = _describe_attribute(attribute)
    if place in {"joint origin xyz", "joint origin rpy"} and count == 3:
        return ["x", "y", "z"] if attribute.name == "xyz" else ["roll", "pitch", "yaw"]
    if count == 1:
        return [f"{attribute.owner.tag}" if attribute.name == "value" else attribute.name]
    letters = "xyz" if count == 3 else "123456789"[:count] if count < 10 else [str(i) for i in range(count)]
    return [f"{attribute.owner.tag}_{letter}" for letter in letters]


@tree_fact
def _collect_all_blocks(tree: Element) -> list[list[_LinkBlock]]:
    """Return the blocks of a file, those of one parent together."""
    parents = dict.fromkeys(link.parent for link in iter_elements_by_tag({"": tree}, "link"))
    return [_collect_blocks(parent) for parent in parents if parent is not None]


def _collect_blocks(parent: Element) -> list[_LinkBlock]:
    carried: dict[str, Element] = {}
    for joint in parent.find_children("joint"):
        child = joint.find_child("child")
        carried.setdefault("" if child is None else child.get("link"), joint)
    return [
        _build_block(link, carried.get(link.get("name"))) for link in parent.find_children("link") if link.get("name")
    ]


def _build_block(link: Element, joint: Element | None) -> _LinkBlock:
    elements = [*link.walk(), *(joint.walk() if joint is not None else ())]
    columns = [e.attributes[n] for e in elements for n in sorted(e.attributes)]
    depth = {id(link): 0, id(joint): 0}
    structure = []
    for element in elements:
        level = depth.setdefault(id(element), depth.get(id(element.parent), 0) + 1)
        structure.append((element.tag, str(level), *sorted(element.attributes)))
    return _LinkBlock(link=link, name=link.get("name"), columns=tuple(columns), structure=tuple(structure))


def _group_blocks(blocks: Sequence[_LinkBlock], share: float) -> Iterator[list[_LinkBlock]]:
    """Group blocks of one structure that differ from the first in at most this share of the columns."""
    left = list(blocks)
    while left:
        first = left[0]
        allowed = share * len(first.columns)
        group = [b for b in left if b.structure == first.structure and len(first.find_differing_columns(b)) <= allowed]
        yield group
        left = [b for b in left if b not in group]


def _is_equal_value(one: str, other: str) -> bool:
    if one == other:
        return True
    pairs = list(zip(one.split(), other.split(), strict=False))
    return len(one.split()) == len(other.split()) and all(_is_equal_word(a, b) for a, b in pairs)


def _is_equal_word(one: str, other: str) -> bool:
    a, b = parse_number(one), parse_number(other)
    return one == other if a is None or b is None else math.isclose(a, b, **_TOLERANCES)


def _describe_attribute(attribute: Attribute) -> str:
    """Return ``joint origin rpy``."""
    subject = attribute.owner
    while subject.parent is not None and subject.tag not in {"link", "joint"}:
        subject = subject.parent
    names = [subject.tag] if subject is attribute.owner else [subject.tag, attribute.owner.tag]
    return " ".join([*names, attribute.name])


def _name_parameters(columns: Sequence[Attribute]) -> list[str]:
    """Name each column after its attribute if that is unique, else after element and attribute."""
    short = [c.name for c in columns]
    long = [f"{c.owner.tag}_{c.name}" for c in columns]
    is_clear = [name != "name" and short.count(name) == 1 for name in short]
    return list(dict.fromkeys(s if clear else n for s, n, clear in zip(short, long, is_clear, strict=True)))


def _find_common_prefix(names: Sequence[str]) -> str:
    shortest = min(names, key=len)
    return next((shortest[:i] for i, c in enumerate(shortest) if any(n[i] != c for n in names)), shortest)


def _suggest_macro_name(names: Sequence[str]) -> str:
    """Return what the names have in common: ``wheel`` for wheel_1 and wheel_2, or for left_wheel and right_wheel."""
    names = [re.sub(r"\$\{[^$}]*\}", "", n) for n in names]
    prefix = _find_common_prefix(names)
    suffix = _find_common_prefix([n[::-1] for n in names])[::-1]
    longest = re.sub(r"\W", "", max(prefix, suffix, key=len).strip("_0123456789"))
    return longest if longest.isidentifier() and longest not in {"link", "joint"} else "part"
