"""Where reports go: the files of ``--output``, and the links and pipes that nothing is written through."""

from __future__ import annotations

import os
import stat
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from urdfcheck.core.errors import UrdfcheckError
from urdfcheck.core.records import dataclass
from urdfcheck.system.files import is_inside

if TYPE_CHECKING:
    from urdfcheck.core import Run

# Suffixes that no report has.
MODELS = frozenset({".urdf", ".xacro", ".srdf", ".sdf", ".launch"})
# Characters of an HTML document above which browsers become slow.
LARGEST = 8_000_000


def parse_output(text: str, formats: Sequence[str], option: str = "--output") -> tuple[str, Path]:
    """Split an ``--output``, or what another option says so, into one of some formats and a file."""
    output_format, assigned, file = text.partition("=")
    if not assigned or not file or output_format not in formats:
        raise UrdfcheckError(f"{option} {text}: write FORMAT=FILE with one of the formats {', '.join(formats)}")
    return output_format, Path(file)


def is_folder_output(text: str) -> bool:
    """Whether an ``--output`` means a folder of pages: an existing one, or a name that ends with a slash or has no suffix."""
    output_format, _, file = text.partition("=")
    if output_format != "html":
        return False
    path = Path(file)
    return file.endswith(("/", os.sep)) or path.is_dir() or not (path.suffix or path.exists())


def parse_run_outputs(texts: Sequence[str], paths: Sequence[str]) -> list[tuple[str, Path]]:
    """Split each ``--output`` of a command that checks ``paths`` into format and file.

    :raises UrdfcheckError: see `parse_outputs`; or if several models are to be in one picture.
    """
    from urdfcheck.output import FORMATS, PICTURE_FORMAT

    outputs = parse_outputs(texts, paths, (*FORMATS, PICTURE_FORMAT))
    models = {os.path.realpath(path) for path in paths if path.lower().endswith(".urdf")}
    if len(models) > 1 and PICTURE_FORMAT in {name for name, _ in outputs}:  # else known when all are checked
        raise UrdfcheckError(f"a png shows one model, and {len(models)} are named")
    return outputs


def parse_comparison_outputs(
    texts: Sequence[str], paths: Sequence[str], formats: Sequence[str], option: str = "--output"
) -> list[tuple[str, Path]]:
    """Split each ``--output`` of a command that compares two versions, whose page is always one file.

    :raises UrdfcheckError: see `parse_outputs`; or if one names a folder.
    """
    folder = next(filter(is_folder_output, texts), None)
    if folder is not None:
        raise UrdfcheckError(f"{option} {folder}: a comparison is one page; name a file, such as diff.html")
    return parse_outputs(texts, paths, formats, option)


def parse_outputs(
    texts: Sequence[str], paths: Sequence[str], formats: Sequence[str], option: str = "--output"
) -> list[tuple[str, Path]]:
    """Split each ``--output`` into one of some formats and a file.

    :raises UrdfcheckError: if two reports would share a file, one would replace a model, or one would be written through a link
        of what is checked.
    """
    outputs = [parse_output(text, formats, option) for text in texts]
    text_by_path: dict[str, str] = {}
    inputs = {os.path.realpath(path) for path in paths}
    checked = CheckedFolders.around(paths)
    for text, (_, file) in zip(texts, outputs, strict=True):
        checked.ensure_own(file / "index.html" if is_folder_output(text) else file)
        real = os.path.realpath(file)
        if os.path.exists(real) and not os.path.isfile(real) and not os.path.isdir(real):
            continue  # /dev/null takes any number of reports
        if real in text_by_path:
            raise UrdfcheckError(f"{option} {text}: {text_by_path[real]} goes into the same file")
        if (real in inputs and os.path.isfile(real)) or file.suffix.lower() in MODELS:
            raise UrdfcheckError(f"{option} {text}: that is the file of a model, and a report would replace it")
        text_by_path[real] = text
    return outputs


@dataclass(frozen=True, slots=True)
class CheckedFolders:
    """The folders of what is checked, as real paths: their links, pipes and devices may be a stranger's."""

    roots: tuple[str, ...] = ()

    @classmethod
    def around(cls, paths: Iterable[str | os.PathLike[str]]) -> CheckedFolders:
        """Return the folders that some checked paths belong to."""
        from urdfcheck.source.reach import FileReach

        return cls(FileReach.from_paths(map(Path, paths), ()).roots)

    def ensure_own(self, file: Path) -> None:
        """Refuse a place to write that a link of the checked folders leads out of them, and a pipe or device in them.

        A link that has the name of the file itself is replaced.

        :raises UrdfcheckError: for such a place.
        """
        here = os.path.realpath(file.anchor or os.curdir)
        *folders, name = file.parts[1:] if file.anchor else file.parts or (os.curdir,)
        for part in folders:
            step = os.path.join(here, part)
            real = os.path.realpath(step)
            if _is_link(step) and any(is_inside(here, root) and not is_inside(real, root) for root in self.roots):
                raise UrdfcheckError(
                    f"cannot write {file}: {part} is a link that leads out of the folders that are checked; name another place"
                )
            here = real
        if any(is_inside(here, root) for root in self.roots) and _is_special(os.path.join(here, name)):
            raise UrdfcheckError(
                f"cannot write {file}: it is a pipe or a device in the folders that are checked; name another place"
            )


def _is_link(path: str) -> bool:
    is_junction = getattr(os.path, "isjunction", None)  # Windows; Python 3.12 and later
    return os.path.islink(path) or (is_junction is not None and is_junction(path))


def _is_special(path: str) -> bool:
    """Whether something is there that is neither a file nor a folder, or a link to such a thing."""
    try:
        mode = os.stat(path).st_mode
    except OSError:
        return False
    return not (stat.S_ISREG(mode) or stat.S_ISDIR(mode))


def write_file(content: str | bytes, file: Path, checked: CheckedFolders) -> None:
    """Write a file atomically; a device or pipe (``/dev/null``) is written to instead of replaced.

    ``checked``: see `CheckedFolders.ensure_own`.

    :raises UrdfcheckError: when it cannot or must not be written.
    """
    import tempfile

    checked.ensure_own(file)
    data = content if isinstance(content, bytes) else content.encode()
    try:
        if file.exists() and not file.is_file() and not file.is_dir():
            with open(file, "wb") as out:
                out.write(data)
            return
        file.parent.mkdir(parents=True, exist_ok=True)
        handle, temporary = tempfile.mkstemp(dir=file.parent, prefix=f".{file.name}.")
        try:
            with os.fdopen(handle, "wb") as out:
                out.write(data)
            mask = os.umask(0)
            os.umask(mask)
            os.chmod(temporary, 0o666 & ~mask)
            os.replace(temporary, file)
        except BaseException:
            os.unlink(temporary)
            raise
    except OSError as error:
        raise UrdfcheckError(f"cannot write {file}: {error.strerror or error}") from None


def write_report(run: Run, output_format: str, file: Path, *, checked: CheckedFolders, as_pages: bool = False) -> None:
    """Write a run in a format; ``as_pages``: as a folder of HTML pages, one per model.

    ``checked``: see `CheckedFolders.ensure_own`.
    """
    from urdfcheck import output

    if output_format == output.PICTURE_FORMAT:
        write_file(output.render_picture(run), file, checked)
        return
    documents: Iterable[tuple[str, Path]]
    many = not as_pages and len(run.models) > 1
    advice = "-o html=FOLDER/ gives each model a page" if many else "fewer rules (--select) make it smaller"
    if as_pages:
        from urdfcheck.output import html

        documents = ((text, file / name) for name, text in html.iter_report_pages(run))
    else:
        documents = [(output.render(run, output_format), file)]
    for text, path in documents:
        write_file(text, path, checked)
        if output_format == "html":
            warn_of_size(text, path, advice)


def warn_of_size(text: str, path: Path, advice: str) -> None:
    """Say on standard error if a page is large, and what makes it smaller."""
    import sys

    from urdfcheck.cli.terminal import say

    # The large parts of a document are ASCII, so characters count its bytes.
    if len(text) > LARGEST:
        say(f"{path}: {len(text) / 1e6:.1f} MB, browsers will open it slowly; {advice}", sys.stderr)
