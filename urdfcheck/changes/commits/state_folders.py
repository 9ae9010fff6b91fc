"""Writes a state of a repository into a folder: its files as git has them, without filters, hooks or links that lead out."""

from __future__ import annotations

import hashlib
import os
import re
from collections.abc import Iterable, Mapping
from dataclasses import field
from pathlib import Path

from urdfcheck.changes.commits.large_files import find_content, find_pointer_digest
from urdfcheck.changes.commits.repository import Repository, Revision, TreeEntry
from urdfcheck.core.errors import UrdfcheckError
from urdfcheck.core.records import dataclass
from urdfcheck.core.text import join_names
from urdfcheck.system.files import MAX_MESH, FileTooLargeError, read_regular
from urdfcheck.system.git import GitError

# Files and bytes of one state.
MOST_FILES = 200_000
MOST_BYTES = 8 * 1024**3
_LONGEST_LINK = 4096
# Git's own folder, also as case-insensitive disks spell it, and characters that some systems do not allow in names.
_OWN_FOLDER = re.compile(r"(\.git|git~\d)[. ]*", re.IGNORECASE)
_ODD = re.compile(r"[\x00-\x1f\x7f\\]|:" if os.name == "nt" else r"[\x00-\x1f\x7f]")


@dataclass(slots=True)
class StateFolder:
    """A state of a repository on the disk."""

    folder: Path
    twin: StateFolder | None = None
    """The other state, if it is written already: equal files are the same on the disk."""
    digests: dict[str, str] = field(default_factory=dict)
    """What identifies each file and link, by path from the top."""
    submodules: dict[str, str] = field(default_factory=dict)
    """Id of the commit of each submodule, by path; empty in the work tree."""
    skipped: dict[str, list[str]] = field(default_factory=dict)
    """The paths that were not written, by reason."""
    left: int = MOST_BYTES
    links: dict[str, str] = field(default_factory=dict)

    def skip(self, path: str, reason: str) -> None:
        """Note that a path is not written."""
        self.skipped.setdefault(reason, []).append(path)

    def write_file(self, path: str, data: bytes) -> None:
        """Write a file.

        :raises UrdfcheckError: if the state becomes too large, or the disk does not take it.
        """
        self.left -= len(data)
        if self.left < 0 or len(self.digests) >= MOST_FILES:
            raise UrdfcheckError(f"the repository has more than {MOST_FILES:,} files or {MOST_BYTES:,} bytes")
        place, digest = self.folder / path, hashlib.sha256(data).hexdigest()
        try:
            place.parent.mkdir(parents=True, exist_ok=True)
            if not self._link_twin(path, digest):
                with place.open("xb") as file:
                    file.write(data)
        except (FileExistsError, NotADirectoryError):
            self.skip(path, "another path has the same name here")
        except OSError as error:
            if not place.parent.is_dir() or len(os.fsencode(place.name)) > 255:  # a name too long for this disk
                self.skip(path, "this disk does not take the name")
                return
            raise UrdfcheckError(f"the files of the repository cannot be written: {error.strerror}") from None
        else:
            self.digests[path] = digest

    def _link_twin(self, path: str, digest: str) -> bool:
        """Use the file of the other state, if it is equal; the answer says whether that was possible."""
        if self.twin is None or self.twin.digests.get(path) != digest:
            return False
        try:
            os.link(self.twin.folder / path, self.folder / path)
        except FileExistsError:
            raise
        except OSError:  # a disk without hard links
            return False
        return True

    def copy_twin(self, path: str) -> None:
        """Take a file that a sparse checkout leaves out from the other state."""
        if self.twin is not None and path in self.twin.digests and path not in self.twin.links:
            self.write_file(path, (self.twin.folder / path).read_bytes())
            self.skip(path, "the sparse checkout leaves it out; taken from the other version")

    def write_links(self) -> None:
        """Write the links, after all files, and only those that lead to something inside."""
        root = os.path.realpath(self.folder)
        written = []
        for path, target in self.links.items():
            place = self.folder / path
            try:
                place.parent.mkdir(parents=True, exist_ok=True)
                if os.path.realpath(place.parent) != os.path.join(root, os.path.dirname(path)).rstrip(os.sep):
                    self.skip(path, "it is in a folder that is a link")
                    continue
                place.symlink_to(target)
            except (OSError, ValueError):
                self.skip(path, "the link cannot be made here")
                continue
            written.append((path, place, target))
        for path, place, target in written:
            if os.path.isabs(target) or not _is_inside(os.path.realpath(place), root):
                place.unlink()
                self.skip(path, "the link leads out of the repository")
            else:
                self.digests[path] = f"link {target}"


def _is_inside(place: str, root: str) -> bool:
    return place.startswith(root + os.sep) and not place.startswith(os.path.join(root, ".git"))


def make_state_folder(folder: Path, twin: StateFolder | None = None) -> StateFolder:
    """Make the empty folder of a state. Like a repository it has a ``.git``, so that its packages are found like there."""
    (folder / ".git").mkdir(parents=True)
    return StateFolder(folder, twin)


def is_hostile_name(path: str) -> bool:
    """Whether a path could leave its folder, or act on git or a disk."""
    parts = path.split("/")
    return any(part in {"", ".", ".."} or _OWN_FOLDER.fullmatch(part) is not None for part in parts) or (
        _ODD.search(path) is not None
    )


def write_revision(repository: Repository, revision: Revision, state: StateFolder) -> None:
    """Write the files of a revision.

    :raises UrdfcheckError: if git fails, or the state is too large.
    """
    entries = repository.list_tree(revision)
    if len(entries) > MOST_FILES:
        raise UrdfcheckError(f"{revision.name}: more than {MOST_FILES:,} files")
    try:
        with repository.git.open_objects() as objects:
            for path, entry in entries.items():
                if entry.kind == "submodule":
                    state.submodules[path] = entry.oid
                elif is_hostile_name(path):
                    state.skip(path, "its name is not one of a file of a robot")
                elif (
                    data := objects.read_blob(entry.oid, _LONGEST_LINK if entry.kind == "link" else MAX_MESH)
                ) is None:
                    state.skip(path, "it is too large, or this clone does not have it")
                elif entry.kind == "link":
                    state.links[path] = os.fsdecode(data)
                else:
                    state.write_file(path, _replace_pointer(repository, state, path, data))
    except GitError:
        raise UrdfcheckError(f"{revision.name}: git cannot read its files") from None
    state.write_links()


def _replace_pointer(repository: Repository, state: StateFolder, path: str, data: bytes) -> bytes:
    """Return the content that a pointer of Git LFS stands for, where it is here; any other file as it is."""
    digest = find_pointer_digest(data)
    if digest is None:
        return data
    place = repository.top / path
    others = [place] if _is_inside(os.path.realpath(place), str(repository.top)) else []
    content = find_content(digest, repository.large_files, others)
    if content is None:
        state.skipped.setdefault("only a Git LFS pointer is here (git lfs fetch)", []).append(path)
        return data
    return content


def write_work_tree(repository: Repository, state: StateFolder, known: Mapping[str, TreeEntry]) -> None:
    """Write the files of the work tree that git does not ignore.

    :param known: what a revision has at the same paths: a file that differs from it in line ends only is that of the revision,
        because git may have changed them when it checked the file out.
    :raises UrdfcheckError: if git fails, or the state is too large.
    """
    top = str(repository.top)
    for path, is_left_out in repository.list_work_tree().items():
        place = repository.top / path
        if path.endswith("/") or (place.is_dir() and not place.is_symlink()):
            state.submodules[path.rstrip("/")] = ""
        elif not os.path.lexists(place):
            if is_left_out:
                state.copy_twin(path)
            # Else it was deleted, and is still in the index.
        elif is_hostile_name(path):
            state.skip(path, "its name is not one of a file of a robot")
        elif os.path.realpath(place.parent) != os.path.join(top, os.path.dirname(path)).rstrip(os.sep):
            state.skip(path, "it is in a folder that is a link")
        elif place.is_symlink():
            state.links[path] = os.readlink(place)
        else:
            _copy_file(repository, state, path, known.get(path))
    state.write_links()


def _copy_file(repository: Repository, state: StateFolder, path: str, known: TreeEntry | None) -> None:
    try:
        data = read_regular(repository.top / path, MAX_MESH)
    except FileTooLargeError:
        state.skip(path, "it is too large, or this clone does not have it")
        return
    except OSError:
        state.skip(path, "it cannot be read")
        return
    if known is not None and b"\r\n" in data:
        unix = data.replace(b"\r\n", b"\n")
        data = unix if _compute_oid(unix, known.oid) == known.oid else data
    state.write_file(path, _replace_pointer(repository, state, path, data))


def _compute_oid(data: bytes, like: str) -> str:
    """Return the id of a file as git computes it, with the algorithm of another id."""
    algorithm = hashlib.sha1 if len(like) == 40 else hashlib.sha256
    return algorithm(b"blob %d\0" % len(data) + data, usedforsecurity=False).hexdigest()


def list_changed_paths(before: StateFolder, after: StateFolder) -> set[str]:
    """Return the paths whose files differ, or that only one state has."""
    return {
        path
        for path in before.digests.keys() | after.digests.keys()
        if before.digests.get(path) != after.digests.get(path)
    }


def describe_left_out(sides: Iterable[tuple[str, StateFolder]], most: int = 3) -> tuple[str, ...]:
    """Return what was not compared, a line for each reason and the states that it holds for."""
    names: dict[tuple[str, tuple[str, ...]], list[str]] = {}
    for name, state in sides:
        for reason, paths in state.skipped.items():
            names.setdefault((reason, tuple(paths)), []).append(name)
    return tuple(
        f"{'' if len(of) > 1 else of[0]}{join_names(paths, most)}: {reason}{', in both versions' if len(of) > 1 else ''}"
        for (reason, paths), of in names.items()
    )
