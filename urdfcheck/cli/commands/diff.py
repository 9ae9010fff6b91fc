"""``urdfcheck diff A B`` and ``urdfcheck diff [REV[..REV]] [-- PATH...]``: what a change does to the robot."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from urdfcheck.cli.job_summary import append_comparison, find_summary_file
from urdfcheck.cli.options import CommandParser, add_options, build_request
from urdfcheck.cli.output_files import CheckedFolders, parse_comparison_outputs, warn_of_size, write_file
from urdfcheck.cli.terminal import FAILED, FINDINGS, OK, make_progress_printer, print_document, say, silence_stdout
from urdfcheck.core.errors import UrdfcheckError
from urdfcheck.output.changes import DRAWING_FORMATS, FORMATS, PICTURE_FORMAT, render, render_picture
from urdfcheck.run.preload import start_warm_worker

if TYPE_CHECKING:
    from urdfcheck.core.model_diff import Diff
    from urdfcheck.run.jobs import Request
    from urdfcheck.run.pipeline import Execution

USAGE = """\
urdfcheck diff A B [options]
       urdfcheck diff [REV[..REV]] [options] [-- PATH...]"""

EPILOG = """\
exit codes: 0 nothing that --fail-on or a tolerance names, 1 such a change, 2 a version could not be read
"""


def build_parser() -> argparse.ArgumentParser:
    """Build the parser of ``urdfcheck diff``."""
    p = CommandParser(
        prog="urdfcheck diff",
        usage=USAGE,
        description="Compare two versions of a robot: structure, motion, limits, mass, shapes and findings, each with the lines "
        "that caused it. Without two paths: two states of a git repository, by default HEAD and the work tree.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    p.add_argument(
        "versions",
        metavar="A B|REV[..REV]",
        nargs="*",
        help="two models, packages or folders: models are matched by path, name, then structure; or REV (default: HEAD) to "
        "compare a revision with the work tree, REV..REV to compare two, REV...REV to begin at their common ancestor",
    )
    p.add_argument(
        "paths",
        metavar="-- PATH",
        nargs="*",
        help="with revisions: only these models, and those that use these files",
    )
    p.add_argument("--format", choices=FORMATS, default="text", help="what goes to standard output (default: text)")
    p.add_argument(
        "-o",
        "--output",
        action="append",
        default=[],
        metavar="FORMAT=FILE",
        help="also write a report to a file (repeatable), e.g. -o html=diff.html; png=FILE is a picture of both versions",
    )
    p.add_argument(
        "--fail-on",
        action="append",
        default=[],
        metavar="KINDS",
        help="exit 1 for these changes: kinematic, dynamic, limits, collision, seams (SRDF, controllers, launch "
        "files, manifests, arguments), findings (new ones), any (whatever is not "
        "cosmetic), never (default)",
    )
    p.add_argument(
        "--max-tool-shift", metavar="LENGTH", help="exit 1 if a link moves farther, such as 1mm; less is tolerated"
    )
    p.add_argument(
        "--max-mass", metavar="MASS", help="exit 1 if the mass changes by more, such as 1%% or 50g; less is tolerated"
    )
    p.add_argument("-v", "--verbose", action="store_true", help="list all changes, causes and findings")
    add_options(p, "diff")
    return p


def main(words: Sequence[str]) -> int:
    """Run the command."""
    given, paths = _split_words(words)
    options = build_parser().parse_args(given)
    from urdfcheck.changes.gate import make_gate
    from urdfcheck.run.request import split_words

    gate = make_gate(split_words(options.fail_on), options.max_tool_shift, options.max_mass)
    if "" in (*options.versions, *(paths or ())):
        raise UrdfcheckError("a path is empty (urdfcheck diff A B)")
    # In a repository all of it may be a stranger's.
    versions = options.versions if len(options.versions) == 2 else ["."]
    files = parse_comparison_outputs(options.output, versions, (*FORMATS, PICTURE_FORMAT))
    checked = CheckedFolders.around(versions)
    options.draws = bool({options.format, *(name for name, _ in files)} & DRAWING_FORMATS)
    warm_worker = start_warm_worker()

    from urdfcheck.run.pipeline import Execution

    execution = Execution(warm_worker=warm_worker, on_progress=make_progress_printer())
    diff = _compare(options, paths, execution)
    _report(diff, options, files, checked)
    if diff.failures:
        return FAILED
    return FINDINGS if gate.list_reasons(diff) else OK


def _report(
    diff: Diff, options: argparse.Namespace, files: Sequence[tuple[str, Path]], checked: CheckedFolders
) -> None:
    """Print the comparison, and write all reports.

    :raises UrdfcheckError: when reports cannot be written; the others are still written.
    """
    try:
        if options.format == "text":
            from urdfcheck.output.changes import text

            sys.stdout.write(text.render(diff, show_all=options.verbose))
        else:
            print_document(render(diff, options.format))
        sys.stdout.flush()
    except BrokenPipeError:  # the reader has exited: the verdict holds, and so do the other reports
        silence_stdout()
    errors = []
    for output_format, file in files:
        try:
            _write_report(diff, output_format, file, checked)
        except UrdfcheckError as error:
            errors.append(str(error))
    summary = find_summary_file() if "github" in {options.format, *(name for name, _ in files)} else None
    if summary is not None:
        append_comparison(diff, summary)
    if errors:
        raise UrdfcheckError("; ".join(errors))


def _write_report(diff: Diff, output_format: str, file: Path, checked: CheckedFolders) -> None:
    if output_format == PICTURE_FORMAT:
        if picture := render_picture(diff):
            write_file(picture, file, checked)
        else:  # a change may touch no robot: that is no failure
            say(f"{file}: not written, there is no robot to draw", sys.stderr)
        return
    document = render(diff, output_format)
    write_file(document, file, checked)
    if output_format == "html":
        warn_of_size(document, file, "paths after -- limit it to some models")


def _split_words(words: Sequence[str]) -> tuple[list[str], list[str] | None]:
    """Return the words before ``--`` and those after it; None where there is no ``--``."""
    place = words.index("--") if "--" in words else len(words)
    return list(words[:place]), None if place == len(words) else list(words[place + 1 :])


def _compare(options: argparse.Namespace, paths: Sequence[str] | None, execution: Execution) -> Diff:
    """Compare what the words name: two paths, or two states of a repository.

    :raises UrdfcheckError: if the words mean neither.
    """
    from urdfcheck.system import libraries

    versions: list[str] = options.versions
    if len(versions) == 2 and not paths:
        from urdfcheck.changes.compare_versions import compare_versions

        if not any(map(os.path.lexists, versions)):
            raise UrdfcheckError(
                f"{versions[0]}, {versions[1]}: there is no such file or folder; two revisions are written "
                f"{versions[0]}..{versions[1]}"
            )
        first, second = (_build_request(options, path) for path in versions)
        libraries.prefer_own_folders()
        return compare_versions(first, second, execution)
    if len(versions) > 1:
        raise UrdfcheckError("name two paths (urdfcheck diff A B), or one REV[..REV], with its paths after --")
    from urdfcheck.changes.commits.compare_states import compare_states

    if paths is None and versions and os.path.lexists(versions[0]):
        name = versions[0]
        raise UrdfcheckError(
            f"{name} is the name of a file or folder: write -- {name} to compare its state in HEAD with the work tree, or "
            f"{name} -- for a revision of this name"
        )
    libraries.prefer_own_folders()
    return compare_states(
        versions[0] if versions else "",
        paths or [],
        lambda folder, translate: _build_request(options, str(folder), translate),
        allowed=options.allow_read,
        execution=execution,
    )


def _build_request(options: argparse.Namespace, path: str, translate: Callable[[str], str] = str) -> Request:
    """Return the request for one version: the options hold for both, the configuration is that of the path.

    ``translate``: leads from a path that an option names to that of the version.
    """

    def translate_package(text: str) -> str:
        name, assigned, folder = text.partition("=")
        return f"{name}{assigned}{translate(folder)}" if folder and Path(folder).is_dir() else text

    # `fail_on` has other values here than the severities of a check.
    changes = {
        "paths": [path],
        "fail_on": None,
        "verbose": False,
        "package": list(map(translate_package, options.package)),
        "package_path": list(map(translate, options.package_path)),
        "allow_read": list(map(translate, options.allow_read)),
    }
    request, _ = build_request(argparse.Namespace(**{**vars(options), **changes}), scene=options.draws)
    return request
