"""Where the build of a package installs its files: one map for both directions.

Places are relative to the package's folder before the build and to its share folder after it, with forward slashes.
"""

from __future__ import annotations

import fnmatch
import posixpath
import re
from collections.abc import Iterator

from urdfcheck.core.records import dataclass

# The most folders and files of one build file that are looked at: each path of a model is compared with all of them.
MOST_ENTRIES = 500
_MAGIC = re.compile(r"[*?\[]")


@dataclass(frozen=True, slots=True, kw_only=True)
class InstalledEntry:
    """One folder or file, or the files that a pattern matches, and where it is installed."""

    source: str
    """The folder, the file or the pattern before the build; empty for the package's own folder."""
    target: str
    """The place of the folder or file, or the folder of the pattern's files; empty for the share folder itself."""
    kind: str
    """folder (with all below it) | file | pattern | made (a file that the build makes out of the source)"""
    wanted: tuple[str, ...] = ()
    """Patterns of which one must match a file's name in the folder; empty for all files."""
    excluded: tuple[str, ...] = ()
    """Patterns of which none may match a file's name or that of a folder around it."""

    def find_source(self, place: str) -> str | None:
        """Return what is installed at a place, or None; it need not exist."""
        if self.kind in {"file", "made"}:
            return self.source if place == self.target else None
        if self.kind == "pattern":
            folder, name = posixpath.split(place)
            fits = folder == self.target and fnmatch.fnmatchcase(name, posixpath.basename(self.source))
            return posixpath.join(posixpath.dirname(self.source), name) if fits else None
        inside = _strip_folder(place, self.target)
        if inside is None or not self._takes(inside):
            return None
        return _normalize_place(posixpath.join(self.source, inside))

    def find_place(self, folder: str) -> str | None:
        """Return where the files of a folder are installed, or None."""
        if self.kind == "made":
            return None
        if self.kind == "folder":
            inside = _strip_folder(folder, self.source)
            taken = inside is not None and self._takes(inside)
            return _normalize_place(posixpath.join(self.target, inside or "")) if taken else None
        if posixpath.dirname(self.source) != folder:
            return None
        return self.target if self.kind == "pattern" else posixpath.dirname(self.target)

    def takes_file(self, file: str) -> bool:
        """Whether a file before the build is installed."""
        if self.kind in {"file", "made"}:
            return self.kind == "file" and file == self.source
        if self.kind == "pattern":
            return posixpath.dirname(file) == posixpath.dirname(self.source) and fnmatch.fnmatchcase(file, self.source)
        inside = _strip_folder(file, self.source)
        return inside is not None and self._takes(inside)

    def _takes(self, inside: str) -> bool:
        """Whether a path in the folder is installed with it."""
        parts = inside.split("/")
        above = ["/".join(parts[: n + 1]) for n in range(len(parts))]
        if any(_ends_like(path, pattern) for pattern in self.excluded for path in above):
            return False
        # The wanted names are those of files: a folder is installed anyway.
        return not self.wanted or "." not in parts[-1] or any(_ends_like(inside, pattern) for pattern in self.wanted)


@dataclass(frozen=True, slots=True, kw_only=True)
class InstalledFiles:
    """What a package's build installs into its share folder, as far as the build file shows."""

    entries: tuple[InstalledEntry, ...]
    is_complete: bool
    """Whether nothing else can be installed: every command and every value in it was understood."""
    other_names: frozenset[str] = frozenset()
    """Parts of paths in commands that are not understood and that may install what they name."""
    function_words: frozenset[str] = frozenset()
    """The arguments of functions that neither CMake nor ament has: such a function may install a folder of that name in any that
    it knows, as ``cogen_dcf(car)`` of lely_core_libraries installs ``config/car``."""
    expanded_words: frozenset[str] = frozenset()
    """The arguments of functions that are named after xacro: it makes other files out of what they name."""

    def find_sources(self, place: str) -> Iterator[str]:
        """Yield what may be installed at a place."""
        for entry in self.entries:
            source = entry.find_source(place)
            if source is not None:
                yield source

    def find_places(self, folder: str) -> Iterator[str]:
        """Yield where the files of a folder are installed."""
        for entry in self.entries:
            place = entry.find_place(folder)
            if place is not None:
                yield place

    def may_fill(self, folder: str) -> bool:
        """Whether anything may be installed at or below a folder of the share folder."""
        if not self.is_complete or folder in self.other_names:
            return True
        return any(_has_part_in(entry, folder) for entry in self.entries)

    def may_install(self, file: str) -> bool:
        """Whether a file before the build may be installed anywhere."""
        if not self.is_complete or not self.other_names.isdisjoint(file.split("/")):
            return True
        return any(entry.takes_file(file) for entry in self.entries)

    def resolve_path(self, path: str) -> Iterator[str]:
        """Yield the files before the build that a path means after it.

        A path that leaves a folder through ``..`` begins where the folder's files are installed.
        """
        parts = path.split("/")
        ups = parts.index("..") if ".." in parts else len(parts)
        begin, rest = "/".join(parts[:ups]), parts[ups:]
        is_place = not rest or any(True for _ in self.find_sources(begin))
        starts = [begin] * is_place + (list(dict.fromkeys(self.find_places(begin))) if rest else [])
        for start in starts:
            place = _normalize_place(posixpath.join(start, *rest))
            if place != ".." and not place.startswith("../"):
                yield from self.find_sources(place)


def _ends_like(path: str, pattern: str) -> bool:
    """Whether the last parts of a path match a pattern of as many parts, as ``PATTERN`` of CMake compares them."""
    parts = path.split("/")[-pattern.count("/") - 1 :]
    return fnmatch.fnmatchcase("/".join(parts), pattern)


def has_magic(text: str) -> bool:
    """Whether a text is a pattern of file names."""
    return _MAGIC.search(text) is not None


def normalize_source(text: str) -> str | None:
    """Return a path of the package without needless parts; None for one that leads out of it."""
    place = _normalize_place(text)
    return None if place == ".." or place.startswith(("../", "/")) else place


def find_share_place(destination: str, package: str) -> str | None:
    """Return the place in the package's share folder that a destination means; None for another destination."""
    return _strip_folder(_normalize_place(destination).lstrip("/"), f"share/{package}")


def find_part_of_share(destination: str, package: str) -> str | None:
    """Return the part of a folder that is the share folder of a package once the folder is installed at a destination around it.

    None for another destination.
    """
    share, around = f"share/{package}", _normalize_place(destination).lstrip("/")
    return _strip_folder(share, around)


def _normalize_place(text: str) -> str:
    place = posixpath.normpath(text.replace("\\", "/"))
    return "" if place == "." else place


def _strip_folder(path: str, folder: str) -> str | None:
    """Return the path relative to a folder, or None if it is outside."""
    if not folder or path == folder:
        return "" if path == folder else path
    return path[len(folder) + 1 :] if path.startswith(f"{folder}/") else None


def _has_part_in(entry: InstalledEntry, folder: str) -> bool:
    if entry.kind == "folder" and _strip_folder(folder, entry.target) is not None:
        return entry.find_source(folder) is not None
    return _strip_folder(entry.target, folder) is not None
