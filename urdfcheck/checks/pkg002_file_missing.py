"""PKG002 reports mesh files that a model names and that do not exist."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

from urdfcheck.core import Finding, Rule
from urdfcheck.core.text import find_nearest_name, join_names
from urdfcheck.source.load import Source
from urdfcheck.source.package.finder import format_path
from urdfcheck.source.resources import ResourceUse, find_machine_path, is_misspelt, list_resource_uses
from urdfcheck.source.text.shape_roles import describe_missing_mesh
from urdfcheck.system.files import walk

# Files beyond this many are not looked through for one of the same name: a suggestion is not worth seconds.
_MAX_FILES = 20_000


@dataclass(slots=True, eq=False)
class _MissingFiles:
    """What is missing for one cause: one file, or all files below a folder that does not exist."""

    folder: Path | None
    files: dict[Path, str] = field(default_factory=dict)
    uses: list[ResourceUse] = field(default_factory=list)


def check(source: Source, rule: Rule) -> Iterator[Finding]:
    meshes = [
        use for use in list_resource_uses(source) if use.attribute.owner.tag == "mesh" and _is_missing(use, source)
    ]
    there = [use for use in meshes if _has_existing_path(use)]
    for path, uses in _group_by_path(there).items():
        what = "a folder" if path.is_dir() else "no regular file (a pipe, a socket or a device)"
        told = describe_missing_mesh(use.attribute.owner for use in uses)
        yield rule.finding("kind", at=uses[0], related=uses[1:], consequences=told, path=format_path(path), what=what)
    missing = [use for use in meshes if use not in there]
    if not missing:
        return
    index = _index_files({_find_search_root(use, source) for use in missing})
    for gap in _group_missing_files(missing):
        yield _build_finding(gap, index, source, rule)


def _is_missing(use: ResourceUse, source: Source) -> bool:
    resource = use.resource
    if resource.path is None or resource.exists or resource.actual_spelling is not None or not resource.allowed:
        return False
    return find_machine_path(use, source) is None and not is_misspelt(use)


def _has_existing_path(use: ResourceUse) -> bool:
    return use.resource.path is not None and use.resource.path.exists()


def _group_by_path(uses: list[ResourceUse]) -> dict[Path, list[ResourceUse]]:
    found: dict[Path, list[ResourceUse]] = {}
    for use in uses:
        found.setdefault(_normalise_path(use), []).append(use)
    return found


def _normalise_path(use: ResourceUse) -> Path:
    """Two spellings of one file are one cause."""
    assert use.resource.path is not None
    return Path(os.path.normpath(use.resource.path))


def _group_missing_files(missing: list[ResourceUse]) -> list[_MissingFiles]:
    """One gap for each missing folder or file; files that one text names through a macro belong together."""
    by_cause: dict[Path, _MissingFiles] = {}
    by_span: dict[object, _MissingFiles] = {}
    gaps: list[_MissingFiles] = []
    for use in missing:
        path = _normalise_path(use)
        folder = _find_missing_folder(path)
        cause, span = folder or path, use.attribute.span
        gap = by_cause.get(cause) or (by_span.get(span) if span is not None else None)
        if gap is None:
            gap = _MissingFiles(folder)
            gaps.append(gap)
        by_cause[cause] = by_span[span] = gap
        gap.files.setdefault(path, use.resource.text)
        gap.uses.append(use)
    return gaps


def _find_missing_folder(path: Path) -> Path | None:
    """The outermost folder of a path that does not exist."""
    return next((folder for folder in reversed(path.parents) if not folder.is_dir()), None)


def _build_finding(gap: _MissingFiles, index: dict[str, list[Path]], source: Source, rule: Rule) -> Finding:
    first = gap.uses[0]
    path = first.resource.path
    assert path is not None
    related = {u.attribute.span: u for u in gap.uses if u.attribute.span != first.attribute.span}
    near = _find_similar_files(path, index)
    data = {
        "files": list(gap.files.values()),
        "amount": "1 mesh file" if len(gap.files) == 1 else f"{len(gap.files)} mesh files",
        "path": format_path(path),
        "name": path.name,
        "listed": join_names([p.name for p in gap.files], 4),
        "links": list(dict.fromkeys(_find_link_name(u) for u in gap.uses)),
        "near": [format_path(p) for p in near],
        "hint": f" (did you mean {join_names([format_path(p) for p in near], 2)}?)" if near else "",
        "folder": format_path(gap.folder or path.parent),
    }
    message = "folder" if gap.folder is not None else "file" if len(gap.files) == 1 else "several"
    return rule.finding(
        message,
        at=first,
        related=list(related.values()),
        consequences=describe_missing_mesh(use.attribute.owner for use in gap.uses),
        **data,  # type: ignore[arg-type]
    )


def _find_similar_files(path: Path, index: dict[str, list[Path]]) -> list[Path]:
    """A file of the same name elsewhere in the package, else one of a similar name beside the missing one."""
    same = [p for p in index.get(path.name.lower(), []) if p != path]
    if same:
        return same[:2]
    try:
        beside = os.listdir(path.parent)
    except OSError:
        return []
    close = find_nearest_name(path.name, beside)
    return [path.parent / close] if close else []


def _find_link_name(use: ResourceUse) -> str:
    element = use.attribute.owner
    while element.parent is not None and element.tag != "link":
        element = element.parent
    return element.get("name")


def _find_search_root(use: ResourceUse, source: Source) -> Path:
    """Where files of the same name are looked for: the package that the path names, or the model's own."""
    package = use.resource.package
    folder = source.finder.find(package) if package else None
    if folder is not None:
        return folder
    return source.path.parent if source.package is None else source.package.path


def _index_files(roots: Iterable[Path]) -> dict[str, list[Path]]:
    found: dict[str, list[Path]] = {}
    count = 0
    for root in sorted(roots):
        for folder, folders, files in walk(root):
            folders[:] = [f for f in folders if not f.startswith(".")]
            count += len(files)
            if count > _MAX_FILES:
                return found
            for name in files:
                found.setdefault(name.lower(), []).append(Path(folder, name))
    return found
