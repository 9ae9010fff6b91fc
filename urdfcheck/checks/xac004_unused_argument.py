"""XAC004 reports arguments in a model's own files that are never read."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from urdfcheck.core import Edit, Finding, Rule, Severity
from urdfcheck.core.text import join_names
from urdfcheck.model import Model
from urdfcheck.source.arguments.argument_slips import ArgumentSlip, find_argument_slip
from urdfcheck.source.load import Source, select_own_trees
from urdfcheck.source.text.tokens import build_removal_edits, locate_text
from urdfcheck.source.text.xml import Attribute
from urdfcheck.source.uses_elsewhere import collect_outside_mentions, has_unseen_includes
from urdfcheck.source.xacro.usage import (
    collect_computed_arguments,
    collect_read_arguments,
    iter_elements_by_tag,
    may_be_name,
)

# One fix deletes the first line and at most so many others.
_MAX_EDITED = 100


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    source = model.source
    if not source.is_xacro or has_unseen_includes(source):
        return
    by_file: dict[str, list[Attribute]] = {}
    unread = _find_unread_arguments(source)
    declared = {e.get("name") for e in iter_elements_by_tag(source.trees, "xacro:arg")} if unread else set[str]()
    for name in unread:
        slip = find_argument_slip(name.value, declared, select_own_trees(source))
        if slip is None:
            by_file.setdefault(name.location.file, []).append(name)
        else:
            yield _build_slip_finding(name, slip, source, rule)
    for file, (first, *others) in by_file.items():
        names = [name.value for name in (first, *others)]
        yield rule.finding(
            "several" if others else "unused",
            at=first,
            related=others,
            edits=[
                edit
                for name in (first, *others[:_MAX_EDITED])
                for edit in build_removal_edits(name.owner, source.files)
            ],
            names=names,
            name=first.value,
            listed=join_names(names),
            count=len(names),
            file=file,
        )


def _build_slip_finding(name: Attribute, slip: ArgumentSlip, source: Source, rule: Rule) -> Finding:
    """Report an argument for which a sibling was typed, at the place that reads that one."""
    wrong, wanted = f"$(arg {slip.read})", f"$(arg {name.value})"
    at = locate_text(slip.attribute, wrong, source.files)
    return rule.finding(
        "sibling",
        at=at,
        related=[name],
        severity=Severity.WARNING,
        edits=[Edit(at.span, wrong, wanted)] if at.span is not None and wrong in slip.attribute.typed else (),
        name=name.value,
        read=slip.read,
        beside=slip.beside,
    )


def _find_unread_arguments(source: Source) -> list[Attribute]:
    """Return the names of the arguments that nothing reads and no command line gives.

    An argument that several files declare is not one of them: the outer file passes it to the inner one.
    """
    declared = [e.attributes["name"] for e in iter_elements_by_tag(source.trees, "xacro:arg") if "name" in e.attributes]
    times = Counter(name.value for name in declared)
    used = collect_read_arguments(source.trees) | source.arguments_read | source.arguments.keys()
    own_trees = select_own_trees(source)
    unread = [
        name
        for name in declared
        if name.value not in used and times[name.value] == 1 and name.span is not None and name.span.file in own_trees
    ]
    elsewhere = collect_outside_mentions(source) if unread else None
    if elsewhere is None or not elsewhere.complete:
        return []
    computed = collect_computed_arguments(source.trees) | elsewhere.computed_arguments
    return [
        name
        for name in unread
        if name.value not in elsewhere.arguments and not any(may_be_name(typed, name.value) for typed in computed)
    ]
