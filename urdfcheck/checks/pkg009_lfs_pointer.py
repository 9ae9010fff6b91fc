"""PKG009 reports mesh files that are only Git LFS pointers."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from urdfcheck.core import Finding, Rule
from urdfcheck.core.text import join_names
from urdfcheck.source.load import Source
from urdfcheck.source.package.finder import format_path
from urdfcheck.source.resources import ResourceUse, list_resource_uses
from urdfcheck.source.text.engine_reactions import describe_unreadable_mesh
from urdfcheck.system.files import read_start

POINTER = b"version https://git-lfs.github.com/spec/"
_SIZE = re.compile(rb"^size (\d+)$", re.MULTILINE)
# A pointer of the format's first version has 130 bytes; its specification allows up to 1024.
_MAX_POINTER_BYTES = 1024
# What tells git to fetch files from LFS, and how much of the file that says it is read.
_TRACKED, _MAX_ATTRIBUTE_BYTES = b"filter=lfs", 65_536


def check(source: Source, rule: Rule) -> Iterator[Finding]:
    """Report each repository once: one command repairs all of its files."""
    sizes: dict[Path, int | None] = {}
    by_repository: dict[Path | None, list[ResourceUse]] = {}
    for use in list_resource_uses(source):
        path = use.resource.path
        if use.attribute.owner.tag != "mesh" or path is None or not use.resource.exists:
            continue
        if path not in sizes:
            sizes[path] = _read_pointer_size(path)
        if sizes[path] is not None:
            by_repository.setdefault(_find_repository(path), []).append(use)
    for repository, uses in by_repository.items():
        paths = list(dict.fromkeys(use.resource.path for use in uses if use.resource.path is not None))
        is_copied = repository is not None and not any(_is_tracked(path, repository) for path in paths)
        where = "a clone of the repository" if repository is None else format_path(repository)
        yield rule.finding(
            "pointer" if len(paths) == 1 else "pointers",
            at=uses[0],
            related=uses[1:],
            cause="archive" if repository is None else "copy" if is_copied else "clone",
            path=format_path(paths[0]),
            count=len(paths),
            listed=join_names((path.name for path in paths), 4),
            files=[format_path(path) for path in paths],
            consequences=describe_unreadable_mesh(use.attribute.owner for use in uses),
            bytes=sum(sizes[path] or 0 for path in paths),
            repository=None if repository is None else format_path(repository),
            repair="copy the mesh itself from the repository that has it"
            if is_copied
            else f"run `git lfs install`, then `git lfs pull`, in {where}",
        )


def _read_pointer_size(path: Path) -> int | None:
    """Return the size in bytes of the file that a pointer replaces, or None if the file is not a pointer."""
    try:
        start = read_start(path, _MAX_POINTER_BYTES)
    except OSError:
        return None
    if not start.removeprefix(b"\xef\xbb\xbf").lstrip().startswith(POINTER):
        return None
    size = _SIZE.search(start.replace(b"\r", b""))
    return int(size[1]) if size else 0


def _is_tracked(path: Path, repository: Path) -> bool:
    """Whether a ``.gitattributes`` between a file and the root of its clone mentions LFS, or cannot be read."""
    folders = (repository, *(folder for folder in path.parents if repository in folder.parents))
    for attributes in (folder / ".gitattributes" for folder in folders):
        try:
            if attributes.exists() and _TRACKED in read_start(attributes, _MAX_ATTRIBUTE_BYTES):
                return True
        except OSError:
            return True
    return False


def _find_repository(path: Path) -> Path | None:
    """Return the clone that contains a file, or None outside a clone, e.g. in an unpacked archive."""
    return next((folder for folder in path.parents if (folder / ".git").exists()), None)
