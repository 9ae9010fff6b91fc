"""XAC002: every property that a model's own files define is read."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule
from urdfcheck.source.load import Source
from urdfcheck.source.usage import (
    elements,
    names_read,
    names_read_elsewhere,
    own_trees,
    properties,
)
from urdfcheck.source.words import removal


def check(source: Source, rule: Rule) -> Iterator[Finding]:
    if not source.is_xacro or source.root is None or _reads_unseen_files(source):
        return
    read = set().union(*(names_read(tree) for tree in source.trees.values()))
    unread = {name: at for name, at in properties(own_trees(source)).items() if name not in read}
    if not unread:
        return
    elsewhere = names_read_elsewhere(source)
    for name, definitions in unread.items():
        if name in elsewhere:
            continue
        first, *others = definitions
        value = first.owner.get("value") or first.owner.get("default")
        yield rule.finding(
            "unused",
            at=first,
            related=others,
            edits=[] if others or first.owner.children else removal(first.owner, source.files),
            name=name,
            value=f" = {value}" if value else "",
        )


def _reads_unseen_files(source: Source) -> bool:
    """Whether an include outside of the model's package was not followed here: what it reads is not known."""
    reached = {name.rsplit("/", 1)[-1] for name in source.trees}
    own = "" if source.package is None else f"$(find {source.package.name})"
    for include in elements(source.trees, "xacro:include"):
        filename = include.get("filename")
        outside = "$(find" in filename and not (own and own in filename)
        if outside and filename.rsplit("/", 1)[-1] not in reached:
            return True
    return False
