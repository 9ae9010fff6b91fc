"""XAC003 reports macros in a model's own files that are never called."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule
from urdfcheck.core.text import join_names
from urdfcheck.model import Model
from urdfcheck.source.load import Source, select_own_trees
from urdfcheck.source.uses_elsewhere import collect_outside_mentions, has_unseen_includes
from urdfcheck.source.xacro.usage import Macro, collect_called_macros, collect_macros, find_unprefixed_tags


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    source = model.source
    if not source.is_xacro or has_unseen_includes(source):
        return
    by_file: dict[str, list[Macro]] = {}
    for macro in _find_uncalled_macros(source):
        by_file.setdefault(macro.element.location.file, []).append(macro)
    for file, (first, *others) in by_file.items():
        names = [macro.name for macro in (first, *others)]
        yield rule.finding(
            "several" if others else "unused",
            at=first.element.attributes["name"],
            related=[macro.element.attributes["name"] for macro in others],
            names=names,
            name=first.name,
            listed=join_names(names),
            count=len(names),
            file=file,
        )


def _find_uncalled_macros(source: Source) -> list[Macro]:
    """Return the macros that no file calls; nothing if a file computes the name of the macro that it calls."""
    # A call that only lacks its prefix is meant as one (XAC007).
    unprefixed = {call.tag for call in find_unprefixed_tags(source.trees, only_calls=True)}
    called = collect_called_macros(source.trees) | unprefixed
    uncalled = [m for name, m in collect_macros(select_own_trees(source)).items() if name and name not in called]
    if not uncalled or any("$" in name for name in called):
        return []
    elsewhere = collect_outside_mentions(source)
    if not elsewhere.complete or any("$" in name for name in elsewhere.macros):
        return []
    return [macro for macro in uncalled if macro.name not in elsewhere.macros]
