"""Files as text that edits change: which files may be changed, what edits make of their bytes, and how they are written."""

from __future__ import annotations

import contextlib
import difflib
import os
import re
import stat
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

from urdfcheck.core import NEWLINE, Edit, UrdfcheckError
from urdfcheck.core.records import dataclass
from urdfcheck.source.package.finder import format_path
from urdfcheck.source.project_folders import find_project_folder
from urdfcheck.source.reach import is_below, resolve_real_path
from urdfcheck.source.text.xml import SourceFile, XmlError
from urdfcheck.system.files import overlay_files, read_regular
from urdfcheck.system.process_pool import block_ending_signals

# What lies beside `share` in a prefix of ROS, an installed workspace or the devel space of catkin.
_INSTALLED = ("local_setup.sh", "local_setup.bash", "_setup_util.py")
_MARKUP = re.compile("[<>&\"']")


class EditRefusedError(Exception):
    """An edit is refused; the text is a sentence about the file."""


class EditableFiles:
    """The files that may be changed: those below the given paths, and in the repository or package around each of them.

    Not changed are installed files, files in other named package folders (``folders``), and files that a symbolic link leads
    to outside all this; nor, unless they are not ``are_written``, those that the user may not write.
    """

    def __init__(self, paths: Iterable[Path], folders: Iterable[Path], *, are_written: bool = True) -> None:
        self.are_written = are_written
        paths = list(paths)
        # Where a link leads may be a stranger's choice: what counts is the repository or package that the link lies in.
        self.given_paths = {os.path.realpath(path) for path in paths if not os.path.islink(path)}
        self.project_folders = {os.path.realpath(find_project_folder(path)) for path in paths}
        named = {os.path.realpath(folder) for folder in folders}
        # A folder of packages around the given paths says nothing about them.
        self.foreign_folders = {
            f for f in named if not any(is_below(place, f) for place in (*self.project_folders, *self.given_paths))
        }

    def ensure_editable(self, path: Path) -> str:
        """Return the real path of a file that may be changed.

        :raises EditRefusedError: for any other file.
        """
        real = resolve_real_path(path)
        if real is None or not self._is_own(real):
            raise EditRefusedError("it is outside the given paths and their repository or package")
        if any((folder / name).exists() for folder in Path(real).parents for name in _INSTALLED):
            raise EditRefusedError("it is an installed file: its source is elsewhere")
        try:
            status = os.stat(real)
        except OSError as error:
            raise EditRefusedError(error.strerror or str(error)) from None
        if not stat.S_ISREG(status.st_mode):
            raise EditRefusedError("it is not a regular file")
        if status.st_nlink > 1:
            raise EditRefusedError("it has more than one name (hard links), and only one of them would be changed")
        if not self.are_written:
            return real
        if not status.st_mode & stat.S_IWUSR or not os.access(real, os.W_OK):
            raise EditRefusedError("it is read-only")
        if hasattr(os, "geteuid") and os.geteuid() not in {0, status.st_uid}:
            raise EditRefusedError("it belongs to another user")
        if not os.access(os.path.dirname(real), os.W_OK):
            raise EditRefusedError("its folder is read-only")
        return real

    def _is_own(self, real: str) -> bool:
        if any(is_below(real, given) for given in self.given_paths):
            return True
        home = os.path.realpath(find_project_folder(Path(real)))
        return (
            home in self.project_folders
            and is_below(real, home)
            and not any(is_below(real, f) for f in self.foreign_folders)
        )


@dataclass(frozen=True, slots=True, eq=False)
class EditableText:
    """A file that may be changed, and its content. ``path`` is the real path."""

    name: str
    path: str
    data: bytes
    file: SourceFile

    @classmethod
    def read(cls, name: str, editable: EditableFiles, texts: Mapping[str, bytes]) -> EditableText:
        """Read the file that findings call ``name``, or the content that ``texts`` replaces it by.

        :raises EditRefusedError: if it may not be changed, or encoding its text again gives other bytes.
        """
        path = editable.ensure_editable(Path(name))
        try:
            with overlay_files(texts):
                data = read_regular(Path(path))
                file = SourceFile.read(Path(path), name)
        except (OSError, XmlError) as error:
            raise EditRefusedError(f"it cannot be read: {error}") from None
        try:
            same = file.text.encode(file.encoding) == data
        except UnicodeEncodeError:
            same = False
        if not same:
            raise EditRefusedError(f"writing it as {file.encoding} would change more than the edit")
        return cls(name=name, path=path, data=data, file=file)

    def ensure_applicable(self, edit: Edit) -> None:
        """Refuse an edit of other text than it expects, or one that would change the markup.

        :raises EditRefusedError: with the reason.
        """
        text, span = self.file.text, edit.span
        if not 0 <= span.start <= span.end <= len(text) or text[span.start : span.end] != edit.expected:
            raise EditRefusedError("the text is not the one that the finding was about")
        # A name that a stranger chose for a file or a link must not become an attribute.
        if edit.expected and not _MARKUP.search(edit.expected) and _MARKUP.search(edit.replacement):
            raise EditRefusedError("the new text would have to be quoted")
        try:
            edit.replacement.encode(self.file.encoding)
        except UnicodeEncodeError:
            raise EditRefusedError(f"the new text cannot be written as {self.file.encoding}") from None

    def apply_edits(self, edits: Iterable[Edit]) -> bytes:
        """Return the content after edits that do not overlap. Their line breaks become those of the file."""
        text = self.file.text
        first = NEWLINE.search(text)
        newline = "\n" if first is None else first.group()
        pieces: list[str] = []
        at = 0
        for edit in sorted(edits, key=lambda e: (e.span.start, e.span.end)):
            pieces += (text[at : edit.span.start], NEWLINE.sub(newline, edit.replacement))
            at = edit.span.end
        return "".join((*pieces, text[at:])).encode(self.file.encoding)


def iter_diff_lines(path: str, before: bytes, after: bytes) -> Iterator[str]:
    """Yield the lines of a unified diff of one file."""
    name = format_path(Path(path))
    old, new = (_split_lines(path, data) for data in (before, after))
    for number, line in enumerate(difflib.unified_diff(old, new, name, name, lineterm="")):
        yield line.removesuffix("\n")
        if number > 1 and line[0] in " +-" and not line.endswith("\n"):
            yield "\\ No newline at end of file"


def _split_lines(path: str, data: bytes) -> list[str]:
    """Return the lines of a file, each with its newline; the last may lack it."""
    with overlay_files({path: data}):
        text = SourceFile.read(Path(path), path).text
    return re.findall("[^\n]*\n|[^\n]+", NEWLINE.sub("\n", text))


def write_files(changes: Mapping[str, tuple[bytes, bytes]]) -> None:
    """Replace the first content by the second, by real path; each file is written whole or not at all.

    :raises UrdfcheckError: if a file has changed meanwhile or cannot be written, or on an interrupt. Then no file is changed,
        unless the system fails in the middle of renaming; the message says which are.
    """
    waiting: dict[str, str] = {}
    path = ""
    try:
        for path, (_, after) in changes.items():
            waiting[path] = _write_beside(path, after)
        for path, (before, _) in changes.items():
            if read_regular(Path(path)) != before:
                raise UrdfcheckError(
                    f"{_format_paths([path])} was changed by others while it was checked; {_describe_written(waiting)}"
                )
        with block_ending_signals():
            for path, place in waiting.items():
                os.replace(place, path)
    except OSError as error:
        raise UrdfcheckError(
            f"cannot write {_format_paths([path])}: {error.strerror or error}; {_describe_written(waiting)}"
        ) from None
    except KeyboardInterrupt:
        raise UrdfcheckError(f"interrupted; {_describe_written(waiting)}") from None
    finally:
        for place in waiting.values():
            with contextlib.suppress(FileNotFoundError):  # it has replaced the old file
                os.unlink(place)


def _write_beside(path: str, data: bytes) -> str:
    """Write a new file in the same folder, with the rights of the file at ``path``; return its path."""
    status = os.stat(path)
    handle, place = tempfile.mkstemp(dir=os.path.dirname(path), prefix=f".{os.path.basename(path)}.")
    try:
        with os.fdopen(handle, "wb") as out:
            out.write(data)
            out.flush()
            os.fsync(out.fileno())
        own = os.stat(place)
        if (own.st_uid, own.st_gid) != (status.st_uid, status.st_gid):
            with contextlib.suppress(OSError):  # a group that we are not in
                os.chown(place, status.st_uid, status.st_gid)
        os.chmod(place, stat.S_IMODE(status.st_mode))
    except BaseException:
        os.unlink(place)
        raise
    return place


def _describe_written(waiting: Mapping[str, str]) -> str:
    """Say which files were fixed: those whose new file is not where it waited."""
    done = [path for path, place in waiting.items() if not os.path.lexists(place)]
    return f"these files were fixed: {_format_paths(done)}" if done else "no file was changed"


def _format_paths(paths: Iterable[str]) -> str:
    return ", ".join(format_path(Path(path)) for path in paths)
