"""A renaming that was tried before it is offered: the robots must be the same apart from the new name, and no finding new."""

from __future__ import annotations

import itertools
import os
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from urdfcheck.core import Edit
from urdfcheck.export.index.source_index import SourceIndex
from urdfcheck.fix.patch import EditableFiles, EditableText, EditRefusedError
from urdfcheck.fix.regression import find_regression
from urdfcheck.run.pipeline import AuditedRun
from urdfcheck.server.check_messages import RenameWish
from urdfcheck.server.names.other_texts import list_other_texts
from urdfcheck.server.names.rename_plan import NOTHING_HERE, RenamePlan, RenameRefusedError, plan_rename
from urdfcheck.source.package.file_kinds import is_launch, is_model
from urdfcheck.source.text.xml import SourceFile, XmlError
from urdfcheck.system.files import overlay_files

# Checks of files (real paths) with replaced contents, and an earlier run of the same files whose reports may be reused.
Audit = Callable[[tuple[str, ...], Mapping[str, bytes], AuditedRun | None], AuditedRun]
# Each round brings in the robots that use a file which the renaming touches.
_MOST_ROUNDS = 4


def compute_rename(wish: RenameWish, texts: Mapping[str, bytes], audit: Audit) -> RenamePlan:
    """Return what renames in all files that know the name. ``texts``: real path → unsaved content.

    :raises RenameRefusedError: if it would do anything else but change the name.
    :raises KeyboardInterrupt: if a check was interrupted.
    """
    paths: tuple[str, ...] = (wish.path,)
    for _ in range(_MOST_ROUNDS):
        before = audit(paths, texts, None)
        plan = _plan_edits(wish, before, texts)
        touched = {os.path.realpath(edit.span.file) for edit in plan.edits}
        further = sorted(path for path in touched - {*paths} if is_model(Path(path)) or is_launch(Path(path)))
        if not further:
            break
        paths += tuple(further)
    after = audit(paths, _apply_edits(plan.edits, paths, texts), before)
    _ensure_same_robots(before, after, plan)
    objection = find_regression(before.outcome, after.outcome, [])
    if objection:
        raise RenameRefusedError(f"The name is not changed: {objection}.")
    known = {os.path.realpath(name) for index in _list_indexes(before).values() for name in index.files}
    others = list_other_texts(plan.names, Path(wish.path), known)
    return replace(plan, doubtful=(*plan.doubtful, *others))


def _plan_edits(wish: RenameWish, audited: AuditedRun, texts: Mapping[str, bytes]) -> RenamePlan:
    indexes = list(_list_indexes(audited).values())
    files = {}
    for name in {place.span.file for index in indexes for place in index.names}:
        try:
            with overlay_files(texts):
                files[name] = SourceFile.read(Path(name), name)
        except (OSError, XmlError):
            raise RenameRefusedError(f"The name is not changed: {name} cannot be read.") from None
    untried = tuple(model.id for model in audited.outcome.models if model.status != "checked")
    try:
        plan = plan_rename(wish, indexes, files)
    except RenameRefusedError as refusal:
        if untried and str(refusal) == NOTHING_HERE:
            raise RenameRefusedError(_explain_untried(untried)) from None
        raise
    tried = {name for index in indexes if index.is_expanded for name in index.files}
    if untried and not {edit.span.file for edit in plan.edits} <= tried:
        raise RenameRefusedError(_explain_untried(untried))
    return replace(plan, untried=untried)


def _explain_untried(models: Sequence[str]) -> str:
    return f"The name is not changed: {models[0]} cannot be expanded as it is now."


def _list_indexes(audited: AuditedRun) -> dict[str, SourceIndex]:
    """Return the index of each model."""
    found = (report.index for _, report in sorted(audited.reports.items()))
    return {index.model: index for index in found if index is not None}


def _apply_edits(edits: Iterable[Edit], paths: Iterable[str], texts: Mapping[str, bytes]) -> dict[str, bytes]:
    """Return the contents with the edits, by real path, beside those that no edit touches."""
    editable = EditableFiles(map(Path, paths), [], are_written=False)
    edited = dict(texts)
    for name, some in itertools.groupby(
        sorted(edits, key=lambda e: (e.span.file, e.span.start)), lambda e: e.span.file
    ):
        own = list(some)
        try:
            text = EditableText.read(name, editable, texts)
            for edit in own:
                text.ensure_applicable(edit)
            edited[text.path] = text.apply_edits(own)
        except EditRefusedError as reason:
            raise RenameRefusedError(f"{name} has the name too, and is not changed: {reason}.") from None
    return edited


def _ensure_same_robots(before: AuditedRun, after: AuditedRun, plan: RenamePlan) -> None:
    now = _list_indexes(after)
    for model, old in _list_indexes(before).items():
        new = now.get(_rename_arguments(model, plan.arguments))
        if new is None:
            difference = f"{model} would not be found"
        elif old.is_expanded and not new.is_expanded:
            difference = f"{model} could no longer be expanded{_explain_failure(after, new.model)}"
        else:
            difference = _describe_difference(old, new, plan.names if model in plan.models else {})
        if difference:
            raise RenameRefusedError(f"The name is not changed: {difference}.")


def _explain_failure(audited: AuditedRun, model: str) -> str:
    """Return why there is no robot: ``: mass is not defined …``; empty where no finding says it."""
    causes = (f.headline for f in audited.outcome.findings if f.blocks_check and model in f.subjects_by_model)
    return next((f": {cause}" for cause in causes), "")


def _rename_arguments(model: str, names: Mapping[str, str]) -> str:
    """Return the id of a model with the new names of its arguments: ``arm.urdf.xacro reach:=0.6``."""
    for old, new in names.items():
        model = re.sub(rf"(?<= ){re.escape(old)}(?=:=)", new, model)
    return model


def _describe_difference(old: SourceIndex, new: SourceIndex, names: Mapping[tuple[str, str], str]) -> str:
    """Return what differs between two expansions besides the names; empty if nothing does."""
    for one, other in itertools.zip_longest(old.expansion, new.expansion):
        if one is None or other is None or (one.depth, one.tag) != (other.depth, other.tag):
            return f"{old.model} would have other elements than now at {(one or other).subject}"
        expected = {key: (names.get((kind, value), value), kind) for key, value, kind in one.attributes}
        found = {key: (value, kind) for key, value, kind in other.attributes}
        for key in {**expected, **found}:
            wanted, made = expected.get(key), found.get(key)
            if wanted is None or made is None or wanted[0] != made[0]:
                return _describe_value(f"{one.subject}@{key}", wanted and wanted[0], made and made[0])
        text = names.get((one.text_kind, one.text), one.text)
        if text != other.text:
            return _describe_value(f"the text of {one.subject}", text, other.text)
    return ""


def _describe_value(what: str, wanted: str | None, made: str | None) -> str:
    return f"{what} would become `{made or ''}` instead of `{wanted or ''}`"
