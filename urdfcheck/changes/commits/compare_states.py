"""Compares two states of a git repository: only the models that the files that differ can touch."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from urdfcheck.changes.commits.repository import Repository, Revision
from urdfcheck.changes.commits.shown_names import rename_folders
from urdfcheck.changes.commits.state_folders import (
    StateFolder,
    describe_left_out,
    list_changed_paths,
    make_state_folder,
    write_revision,
    write_work_tree,
)
from urdfcheck.changes.compare_versions import compare_versions
from urdfcheck.core.errors import UrdfcheckError
from urdfcheck.core.model_diff import Diff
from urdfcheck.core.records import dataclass
from urdfcheck.core.text import join_names
from urdfcheck.run.jobs import Request
from urdfcheck.run.pipeline import IN_WORKERS, Execution, plan_units
from urdfcheck.source.package.file_kinds import is_buffer, is_launch, is_mesh, is_model, is_srdf, is_yaml
from urdfcheck.source.package.finder import format_path
from urdfcheck.version import __version__

WORK_TREE = "work tree"
# Files on which all models of their package may depend, by name and by suffix: they are not named where they are used.
_OF_PACKAGE = frozenset({"package.xml", "cmakelists.txt", "setup.py", "setup.cfg", "colcon_ignore", "catkin_ignore"})
_OF_SURFACES = (".mtl", ".material", ".png", ".jpg", ".jpeg", ".tga", ".bmp", ".tif", ".tiff", ".dds")
_CONFIGURATION = "urdfcheck.toml"

# Makes the request for the folder of a state; the function that it gets leads from a path in the work tree to that of the state.
RequestMaker = Callable[[Path, Callable[[str], str]], Request]


@dataclass(frozen=True, slots=True)
class _ReadableState:
    """A state, where it was written, and how it is read."""

    revision: Revision
    state: StateFolder
    request: Request

    @property
    def root(self) -> str:
        return os.path.realpath(self.state.folder)


def compare_states(
    revisions: str,
    paths: Sequence[str],
    make_request: RequestMaker,
    *,
    around: Path | None = None,
    allowed: Sequence[str] = (),
    execution: Execution = IN_WORKERS,
) -> Diff:
    """Compare two states of the repository around a folder, or else around the first path or the working directory.

    :param revisions: ``REV``, ``REV..REV`` or ``REV...REV``; empty for HEAD. Without dots the second state is the work tree.
    :param paths: the models, and what they use, to which the comparison is limited; none for everything.
    :param allowed: folders that may hold objects that the repository borrows.
    :raises UrdfcheckError: if there is no repository or revision, it cannot be read, or neither state has one of the paths.
    :raises KeyboardInterrupt: if the user interrupts.
    """
    if around is None:
        around = Path(paths[0]) if paths and os.path.lexists(paths[0]) else Path()
    repository = Repository.find(around, list(map(Path, allowed)))
    old, new = repository.resolve_range(revisions)
    wanted = [_find_place(path, repository.top) for path in paths]
    with _make_folder() as folder:
        first = make_state_folder(folder / "before" / repository.top.name)
        second = make_state_folder(folder / "after" / repository.top.name, first)
        write_revision(repository, old, first)
        if new.tree:
            write_revision(repository, new, second)
        else:
            write_work_tree(repository, second, repository.list_tree(old))
        sides = [
            _ReadableState(revision, state, _make_request(repository.top, state, make_request))
            for revision, state in ((old, first), (new, second))
        ]
        for path, place in zip(paths, wanted, strict=True):
            if not any(_has_path(state, place) for state in (first, second)):
                raise UrdfcheckError(f"{path}: neither version has it (what git ignores is in none)")
        changed = list_changed_paths(first, second)
        touched = _find_touched(sides, changed, wanted, execution)
        found = _compare(sides, touched, execution.without_start())
        notes = (
            *_describe_unused(sides, (path for path in changed if _is_below(path, wanted)), found.files),
            *_describe_submodules(first, second),
            *describe_left_out((_prefix(s.revision), s.state) for s in sides),
        )
        found = replace(found, before=old.name, after=new.name or WORK_TREE, notes=notes)
        return rename_folders(found, {side.state.folder: _name_folder(side.revision, repository.top) for side in sides})


@contextmanager
def _make_folder() -> Iterator[Path]:
    """Yield a temporary folder that only this user can read."""
    with tempfile.TemporaryDirectory(prefix="urdfcheck-", ignore_cleanup_errors=True) as folder:
        yield Path(os.path.realpath(folder))


def _find_place(path: str, top: Path) -> str:
    """Return the path from the top of the repository; it need not exist, because a state may have it.

    :raises UrdfcheckError: if it is outside.
    """
    absolute = os.path.abspath(path)
    real = os.path.join(os.path.realpath(os.path.dirname(absolute)), os.path.basename(absolute))
    relative = Path(os.path.relpath(str(top) if absolute == str(top) else real, top)).as_posix()
    if relative.split("/")[0] == ".." or os.path.isabs(relative):
        raise UrdfcheckError(f"{path}: it is outside the repository")
    return "" if relative == "." else relative


def _has_path(state: StateFolder, place: str) -> bool:
    """Whether a state has a file or folder, also one that was not written."""
    known = (*state.digests, *state.submodules, *(path for paths in state.skipped.values() for path in paths))
    return not place or any(_is_below(path, [place]) or _is_below(place, [path]) for path in known)


def _make_request(top: Path, state: StateFolder, make_request: RequestMaker) -> Request:
    def translate(path: str) -> str:
        """Return where a state has a path of the work tree; any other as it is."""
        real = Path(os.path.realpath(path))
        return str(state.folder / real.relative_to(top)) if real.is_relative_to(top) else path

    return make_request(state.folder, translate)


# -- which models ------------------------------------------------------------------------------------------------------


def _find_touched(
    sides: Sequence[_ReadableState], changed: Iterable[str], wanted: Sequence[str], execution: Execution
) -> frozenset[str]:
    """Return the files and folders, from the top, with the models that some changed files can touch in either state."""
    files = sorted(changed)
    direct = [path for path in files if _is_below(path, wanted)]
    touched = _find_users(sides, direct, execution)
    if wanted and len(direct) < len(files):
        others = _find_users(sides, [path for path in files if path not in set(direct)], execution)
        touched |= {path for path in others if _is_below(path, wanted)}
        # Of a whole package, only what was named.
        touched |= {place for place in wanted if any(_is_below(place, [folder]) for folder in others)}
    return frozenset(touched)


def _is_below(path: str, folders: Sequence[str]) -> bool:
    return not folders or any(folder in {"", path} or path.startswith(f"{folder}/") for folder in folders)


def _find_users(sides: Sequence[_ReadableState], paths: Sequence[str], execution: Execution) -> set[str]:
    """Return the models and launch files that use some files in either state, and the folders in which all may."""
    users: set[str] = set()
    for side in sides:
        here = [path for path in paths if path in side.state.digests]
        users |= {folder for path in here if (folder := _find_dependent_folder(path, side.state.digests)) is not None}
        named = [path for path in here if _is_asked_about(Path(path))]
        if named:
            request = replace(side.request, paths=tuple(side.state.folder / path for path in named))
            plan, units = plan_units(request, in_process=execution.audit is not None)
            users |= {_name_in_state(side, Path(unit.path)) for unit in units if unit.kind in {"model", "launch"}}
            # Macros that no file is known to include: one may that computes the name, or that cannot be expanded.
            users |= {
                _find_package(_name_in_state(side, target.path), side.state.digests)
                for target in (*plan.models, *plan.candidates)
                if target.tentative and not target.is_part
            }
    return users


def _name_in_state(side: _ReadableState, path: Path) -> str:
    """Return the path from the top of the repository of a file in the folder of a state."""
    return Path(os.path.relpath(os.path.realpath(path), side.root)).as_posix()


def _is_asked_about(path: Path) -> bool:
    return any(is_kind(path) for is_kind in (is_model, is_mesh, is_buffer, is_srdf, is_yaml, is_launch))


def _find_dependent_folder(path: str, files: Mapping[str, str]) -> str | None:
    """Return the folder whose models may all depend on a file: its package, or else the repository; None if none does."""
    folder, _, name = path.rpartition("/")
    if name.lower() == _CONFIGURATION:
        return folder
    if (
        name.lower() not in _OF_PACKAGE
        and not name.lower().endswith(_OF_SURFACES)
        and not files[path].startswith("link ")
    ):
        return None
    return _find_package(path, files)


def _find_package(path: str, files: Mapping[str, str]) -> str:
    """Return the folder of the package that a file belongs to; that of the repository for a file of none."""
    folder = path.rpartition("/")[0]
    while folder and f"{folder}/package.xml" not in files:
        folder = folder.rpartition("/")[0]
    return folder


# -- comparing ---------------------------------------------------------------------------------------------------------


def _compare(sides: Sequence[_ReadableState], touched: frozenset[str], execution: Execution) -> Diff:
    if not touched:
        return Diff(before="", after="", models=(), version=__version__)
    before, after = (
        replace(side.request, only=frozenset(os.path.normpath(os.path.join(side.root, path)) for path in touched))
        for side in sides
    )
    return compare_versions(before, after, execution)


def _describe_unused(sides: Sequence[_ReadableState], changed: Iterable[str], used: frozenset[str]) -> Iterator[str]:
    """Yield a line about the descriptions that differ and of which no model that was compared is made."""
    unused = [
        path
        for path in sorted(changed)
        if is_model(Path(path))
        if not any(path in s.state.digests and format_path(s.state.folder / path) in used for s in sides)
    ]
    if unused:
        yield f"{join_names(unused, 3)}: no model that was compared is made of {'it' if len(unused) == 1 else 'them'}"


def _describe_submodules(before: StateFolder, after: StateFolder) -> Iterator[str]:
    still = []
    for path in sorted(before.submodules.keys() | after.submodules.keys()):
        old, new = before.submodules.get(path), after.submodules.get(path)
        if old and new and old != new:
            yield f"{path}: it is a submodule, which moves from {old[:12]} to {new[:12]}"
        else:
            still.append(path)
    if still:
        yield f"{join_names(still, 3)}: {'it is a submodule' if len(still) == 1 else 'they are submodules'}"


def _prefix(revision: Revision) -> str:
    return f"{revision.name}:" if revision.tree else ""


def _name_folder(revision: Revision, top: Path) -> tuple[str, str]:
    """Return what stands for the folder of a state before a path in it, and what stands for the folder itself."""
    if revision.tree:
        return f"{revision.name}:", f"{revision.name}:"
    shown = format_path(top)
    return ("" if shown == "." else f"{shown}/"), shown
