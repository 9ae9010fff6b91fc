"""PKG003 reports paths that differ from the names on disk in upper and lower case."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from urdfcheck.core import Applicability, Edit, Finding, Location, Rule, Severity
from urdfcheck.source.load import Source
from urdfcheck.source.package.finder import format_path
from urdfcheck.source.package.similar_files import find_moved_files, index_files, normalise_path
from urdfcheck.source.resources import (
    ResourceUse,
    find_machine_path,
    find_missing_path,
    find_search_root,
    list_resource_uses,
)
from urdfcheck.source.text.engine_reactions import describe_missing_mesh, describe_unread_visuals, name_lost_shapes
from urdfcheck.source.text.xml import SourceFile
from urdfcheck.source.uses_elsewhere import KEPT_ASIDE, explain_kept_file


def check(source: Source, rule: Rule) -> Iterator[Finding]:
    by_path: dict[tuple[object, str], list[ResourceUse]] = {}
    for use in list_resource_uses(source):
        resource = use.resource
        if not resource.exists and resource.actual_spelling is not None and find_machine_path(use, source) is None:
            by_path.setdefault((resource.path, resource.text), []).append(use)
    moved = _find_moved_files([uses[0] for uses in by_path.values()], source)
    right = {use.attribute.span for use in list_resource_uses(source) if use.resource.exists}
    for uses in by_path.values():
        first = uses[0]
        actual = first.resource.actual_spelling or ""
        other = None if first.resource.path is None else moved.get(normalise_path(first.resource.path))
        # A call of the same macro makes a path of it that is right.
        is_shared = any(use.attribute.span in right for use in uses)
        edits = [None if other or is_shared else _propose_edit(use, actual, source.files) for use in uses]
        parts = [use.attribute.owner for use in uses]
        yield rule.finding(
            "case",
            at=_locate(first, actual, source.files),
            related=[u for u in uses if u.attribute.span != first.attribute.span],
            edits=dict.fromkeys(edit for edit in edits if edit is not None) if all(edits) else (),
            severity=Severity.INFO if explain_kept_file(source) == KEPT_ASIDE else None,
            applicability=Applicability.SAFE if all(u.attribute.literal for u in uses) else Applicability.UNSAFE,
            written=_extract_typed_ending(first, actual),
            actual=actual,
            file=first.resource.text,
            hint=f"; {format_path(other.parent)} has `{other.name}` and other files that the model misses"
            if other
            else "",
            repair=f"name the file in {format_path(other.parent)}, or write `{actual}` if that is meant"
            if other
            else _describe_repair(uses, actual, is_shared=is_shared, is_typed=all(edits)),
            consequences=describe_missing_mesh(parts) | describe_unread_visuals(parts),
            lost=name_lost_shapes(parts),
        )


def _describe_repair(uses: Sequence[ResourceUse], actual: str, *, is_shared: bool, is_typed: bool) -> str:
    written = _extract_typed_ending(uses[0], actual)
    if is_shared:
        return f"rename `{actual}` to `{written}`, as the other files are spelled that this path names"
    if is_typed or all(use.attribute.literal for use in uses):
        return f"write `{actual}`"
    return f"make the path, which is computed, end in `{actual}`"


def _find_moved_files(different: Sequence[ResourceUse], source: Source) -> dict[Path, Path]:
    """Find those of these files that are, spelled as typed, in another folder together with more that the model misses."""
    if not different:
        return {}
    index = index_files({find_search_root(use, source) for use in different})
    uses = list_resource_uses(source)
    absent = (find_missing_path(use, source) for use in uses)
    typed = (use.resource.path for use in different)
    missing = {normalise_path(path) for path in (*absent, *typed) if path is not None}
    # A folder of which the model finds other files is the one that is meant.
    found = {normalise_path(u.resource.path).parent for u in uses if u.resource.exists and u.resource.path is not None}
    return find_moved_files({path for path in missing if path.parent not in found}, index)


def _extract_typed_ending(use: ResourceUse, actual: str) -> str:
    """Return as many last parts of the typed path as ``actual``, their spelling on disk, has."""
    return "/".join(use.resource.text.replace("\\", "/").split("/")[-len(actual.split("/")) :])


def _propose_edit(use: ResourceUse, actual: str, files: Mapping[str, SourceFile]) -> Edit | None:
    """Return the edit of the path's end, or None unless it is typed there and differs only in upper and lower case."""
    span, written = use.attribute.span, _extract_typed_ending(use, actual)
    if span is None or span.file not in files or not use.attribute.typed.endswith(written):
        return None
    if written.casefold() != actual.casefold():  # e.g. a blank that is typed as %20
        return None
    return Edit(files[span.file].make_span(span.end - len(written), span.end), written, actual)


def _locate(use: ResourceUse, actual: str, files: Mapping[str, SourceFile]) -> Location:
    edit = _propose_edit(use, actual, files)
    whole = use.location
    return whole if edit is None else Location(whole.subject, edit.span, whole.via)
