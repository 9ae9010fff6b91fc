"""A git repository: what its revisions and its work tree hold. It may be a stranger's."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from pathlib import Path

from urdfcheck.core.errors import UrdfcheckError
from urdfcheck.core.records import dataclass
from urdfcheck.source.package.finder import format_path
from urdfcheck.source.project_folders import find_project_folder
from urdfcheck.system.files import read_regular
from urdfcheck.system.git import Git, GitError

_OID = re.compile(r"[0-9a-f]{40}|[0-9a-f]{64}")
_RANGE = re.compile(r"(.*?)(\.\.\.?)(.*)", re.DOTALL)
# How many repositories may borrow objects from the next.
_MOST_ALTERNATES = 8
_LARGEST_ALTERNATES = 64 * 1024


@dataclass(frozen=True, slots=True)
class TreeEntry:
    """What a revision has at a path. ``kind``: file | link | submodule."""

    kind: str
    oid: str


@dataclass(frozen=True, slots=True)
class Revision:
    """A state of the repository. ``name``: as the user calls it; ``tree``: id of its files, empty for the work tree."""

    name: str
    tree: str


def _explain_missing(name: str) -> str:
    """Return why a revision may be missing, and what makes it."""
    remote, slash, last = name.rpartition("/")
    if last != "HEAD":
        return "a shallow clone lacks older ones"
    return f"git remote set-head {remote} --auto makes it" if slash else "the repository has no commit yet"


@dataclass(frozen=True, slots=True)
class Repository:
    """A repository with a work tree."""

    git: Git
    top: Path
    """Folder of the work tree."""
    store: Path
    """Folder of the objects, as a real path."""

    @classmethod
    def find(cls, start: Path, allowed: Sequence[Path]) -> Repository:
        """Return the repository around a path.

        ``allowed``: folders outside it that may hold objects that it borrows.

        :raises UrdfcheckError: if there is none, git is missing, or its objects are elsewhere.
        """
        folder = start if start.is_dir() else start.parent
        shown = format_path(folder)
        git = Git.find(folder, outside=find_project_folder(folder))
        if git is None:
            raise UrdfcheckError("git is not installed; two folders are compared without it (urdfcheck diff A B)")
        top_text = _read_line(git, "rev-parse", "--show-toplevel")
        if not top_text:
            raise UrdfcheckError(
                f"{shown} is not in the work tree of a git repository; name two versions (urdfcheck diff A B)"
            )
        top = Path(os.path.realpath(top_text))
        git = Git(git.program, str(top))
        common = _read_line(git, "rev-parse", "--path-format=absolute", "--git-common-dir")
        store = Path(os.path.realpath(_read_line(git, "rev-parse", "--path-format=absolute", "--git-path", "objects")))
        if not common or not _belongs_to(git, top, Path(os.path.realpath(common))):
            raise UrdfcheckError(f"{shown}: its .git leads to another repository, which does not know this folder")
        if not store.is_relative_to(os.path.realpath(common)):
            raise UrdfcheckError(f"{shown}: the objects of the repository are outside it")
        _refuse_borrowed_objects(store, [*(Path(os.path.realpath(f)) for f in allowed), top])
        return cls(git, top, store)

    @property
    def large_files(self) -> Path:
        """The folder in which Git LFS keeps contents by their digests."""
        return self.store.parent / "lfs" / "objects"

    def resolve_range(self, text: str) -> tuple[Revision, Revision]:
        """Return the states that ``REV``, ``REV..REV`` or ``REV...REV`` means; a missing end is HEAD, and without dots the
        second state is the work tree.

        :raises UrdfcheckError: if there is no such revision.
        """
        match = _RANGE.fullmatch(text)
        if match is None:
            return self.resolve(text or "HEAD"), Revision("", "")
        first, dots, second = match[1] or "HEAD", match[2], match[3] or "HEAD"
        after = self.resolve(second)
        if dots == "..":
            return self.resolve(first), after
        self.resolve(first)
        base = _read_line(self.git, "merge-base", f"{first}^{{commit}}", f"{second}^{{commit}}")
        if not _OID.fullmatch(base):
            raise UrdfcheckError(f"{text}: the two have no common ancestor here; a shallow clone lacks it")
        return Revision(base[:12], self.resolve(base).tree), after

    def resolve(self, name: str) -> Revision:
        """Return the state of a revision.

        :raises UrdfcheckError: if there is none.
        """
        tree = "" if name.startswith("-") else self._find_tree(name)
        if not tree:
            raise UrdfcheckError(f"{name}: there is no such revision ({_explain_missing(name)})")
        return Revision(name, tree)

    def is_revision(self, name: str) -> bool:
        """Whether a word names a revision."""
        return not name.startswith("-") and bool(self._find_tree(name))

    def _find_tree(self, name: str) -> str:
        found = _read_line(self.git, "rev-parse", "--verify", "--quiet", f"{name}^{{tree}}")
        return found if _OID.fullmatch(found) else ""

    def list_tree(self, revision: Revision) -> dict[str, TreeEntry]:
        """Return what a revision has, by path from the top.

        :raises UrdfcheckError: if the clone lacks a part of it, or it holds too much.
        """
        try:
            listed = self.git.read("ls-tree", "-r", "-z", "--full-tree", revision.tree)
        except GitError:
            raise UrdfcheckError(
                f"{revision.name}: its files cannot be listed; the clone may lack some of them"
            ) from None
        entries = {}
        for line in listed.split(b"\0"):
            head, _, name = line.partition(b"\t")
            words = head.decode("ascii", errors="replace").split()
            if len(words) == 3 and name:
                kind = {"120000": "link", "160000": "submodule"}.get(words[0], "file")
                entries[os.fsdecode(name)] = TreeEntry(kind, words[2])
        return entries

    def list_work_tree(self) -> dict[str, bool]:
        """Return the paths from the top that git follows, or would: not what it ignores.

        With each comes whether a sparse checkout leaves it out.

        :raises UrdfcheckError: if git cannot list them.
        """
        try:
            listed = self.git.read("ls-files", "-z", "-t", "--full-name", "--cached", "--others", "--exclude-standard")
        except GitError:
            raise UrdfcheckError("git cannot list the files of the work tree") from None
        return {os.fsdecode(line[2:]): line[:1] == b"S" for line in sorted(listed.split(b"\0")) if line}


def _read_line(git: Git, *words: str) -> str:
    """Return the line that a command prints; nothing where it fails."""
    try:
        return os.fsdecode(git.read(*words)).removesuffix("\n")
    except (GitError, OSError, ValueError):  # a NUL in a name
        return ""


def _belongs_to(git: Git, top: Path, common: Path) -> bool:
    """Whether a repository's own folder knows the work tree: a stranger's ``.git`` may name any repository."""
    marker = top / ".git"
    if common == Path(marker) and not marker.is_symlink():
        return True
    own = _read_line(git, "rev-parse", "--absolute-git-dir")
    if own and os.path.realpath(own) != str(common):  # a linked work tree
        return (
            _names_marker(Path(os.path.realpath(own)), marker) and Path(os.path.realpath(own)).parent.parent == common
        )
    # That of a submodule names its folder. It is asked from outside, because the marker itself would answer for it.
    named = _read_line(
        Git(git.program, str(common)), "config", "--file", str(common / "config"), "--get", "core.worktree"
    )
    return bool(named) and os.path.realpath(common / named) == str(top)


def _names_marker(folder: Path, marker: Path) -> bool:
    try:
        named = os.fsdecode(read_regular(folder / "gitdir", _LARGEST_ALTERNATES)).strip()
    except (OSError, ValueError):
        return False
    return os.path.realpath(folder / named) == str(marker) and not marker.is_symlink()


def _refuse_borrowed_objects(store: Path, allowed: Sequence[Path]) -> None:
    """Refuse objects that a repository borrows from a folder that was not named: it may be a private one.

    :raises UrdfcheckError: with the option that allows it.
    """
    stores, seen = [store], {store}
    while stores:
        folder = stores.pop()
        for name in _read_alternates(folder):
            other = Path(os.path.realpath(folder / name))
            if len(seen) > _MOST_ALTERNATES or not any(other.is_relative_to(root) for root in allowed):
                raise UrdfcheckError(
                    "the repository borrows objects from a folder outside it (objects/info/alternates); "
                    "--allow-read with that folder allows it"
                )
            if other not in seen:
                seen.add(other)
                stores.append(other)


def _read_alternates(store: Path) -> list[str]:
    place = store / "info" / "alternates"
    if not os.path.lexists(place):
        return []
    try:
        text = os.fsdecode(read_regular(place, _LARGEST_ALTERNATES))
    except OSError:
        return ["/"]  # what cannot be read leads anywhere
    return [line for line in text.splitlines() if line and not line.startswith("#")]
