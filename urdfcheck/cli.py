"""The command line. Only the standard library is imported before there is something to check."""

from __future__ import annotations

import argparse
import importlib
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from urdfcheck import __version__
from urdfcheck.errors import UrdfcheckError

if TYPE_CHECKING:
    from urdfcheck.core import Run

OK, FINDINGS, FAILED, NOTHING = 0, 1, 2, 3
# Words that later versions use as commands: a file of this name is written ./baseline.
RESERVED = ("baseline", "init", "diff", "lsp", "config", "engines", "drop", "audit")

_EPILOG = """\
exit codes: 0 nothing at or above --fail-on, 1 findings, 2 urdfcheck or its configuration failed, 3 nothing to check
urdfcheck rule lists the rules, urdfcheck rule CODE explains one"""


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command and return its exit code."""
    words = list(sys.argv[1:] if argv is None else argv)
    try:
        code = _command(words)
        sys.stdout.flush()
        return code
    except UrdfcheckError as error:
        print(f"urdfcheck: {error}", file=sys.stderr)
    except BrokenPipeError:  # the reader of our output has gone: head, less
        _silence_stdout()
        return OK
    except OSError as error:
        print(f"urdfcheck: cannot write the output: {error.strerror or error}", file=sys.stderr)
        _silence_stdout()
    except KeyboardInterrupt:
        print("urdfcheck: interrupted", file=sys.stderr)
    return FAILED


def _command(words: list[str]) -> int:
    commands = {"check": check, "rule": rule, "cache": cache, "srdf": srdf}
    if words and words[0] in commands:
        return commands[words[0]](words[1:])
    if words and words[0] in RESERVED:
        raise UrdfcheckError(
            f"the command {words[0]!r} does not exist yet; to check a file of this name write ./{words[0]}"
        )
    return check(words)


def _silence_stdout() -> None:
    """What is left in the buffer goes nowhere, so that the interpreter does not try to write it once more."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def parser() -> argparse.ArgumentParser:
    """The options of ``urdfcheck check``."""
    p = argparse.ArgumentParser(
        prog="urdfcheck",
        usage="urdfcheck [check] PATH... [options]\n       urdfcheck rule [CODE]\n"
        "       urdfcheck srdf MODEL [options]\n       urdfcheck cache info|clear",
        description="Audit robot models: URDF, xacro, launch files, packages and folders of them.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    p.add_argument("paths", nargs="*", metavar="PATH", help="model, launch file, mesh, package or folder")
    p.add_argument("--format", choices=("text", "json", "html"), default="text", help="what goes to standard output")
    p.add_argument(
        "-o",
        "--output",
        action="append",
        default=[],
        metavar="FORMAT=FILE",
        help="also write a report to a file (repeatable), e.g. -o html=report.html",
    )
    p.add_argument("--tier", choices=("source", "mesh", "full"), help="how much to compute (default: full)")
    p.add_argument("--select", action="append", metavar="CODES", help="only these rules: codes, prefixes, names, tags")
    p.add_argument("--ignore", action="append", metavar="CODES", help="not these rules")
    p.add_argument(
        "--fail-on", choices=("error", "warning", "info", "never"), help="exit 1 from here on (default: error)"
    )
    p.add_argument("--arg", action="append", default=[], metavar="NAME:=VALUE", help="xacro argument for all models")
    p.add_argument("--package", action="append", default=[], metavar="NAME=DIR", help="where a ROS package is")
    p.add_argument("--package-path", action="append", default=[], metavar="DIR", help="folder that holds packages")
    p.add_argument("--target", metavar="NAMES", help="who will read the model: gazebo, mujoco, drake, … (see MSH011)")
    p.add_argument("--thorough", action="store_true", help="look at 5,000 configurations of the joints instead of 200")
    p.add_argument("--no-cache", action="store_true", help="keep no measurements and use none that were kept")
    p.add_argument("--jobs", type=int, metavar="N", help="models checked at the same time (default: the cores)")
    p.add_argument("--allow-empty", action="store_true", help="exit 0 when there is nothing to check")
    p.add_argument(
        "--color", choices=("auto", "always", "never"), default="auto", help="colours (default: on a terminal)"
    )
    p.add_argument("--version", action="version", version=f"urdfcheck {__version__}")
    return p


def check(words: Sequence[str]) -> int:
    """``urdfcheck [check] PATH…``"""
    options = parser().parse_args(words)
    if not options.paths:
        raise UrdfcheckError("name at least one model, launch file, package or folder (urdfcheck . for this folder)")
    if "" in options.paths:
        raise UrdfcheckError("a path is empty (urdfcheck . for this folder)")
    from urdfcheck import workers

    # It loads what an audit needs while the job is being worked out here.
    first = workers.Worker.start(_prepare) if workers.FORKS else None
    outputs = [_output(text) for text in options.output]
    formats = {options.format, *(name for name, _ in outputs)}

    from urdfcheck import catalogue, config, libraries, output
    from urdfcheck.cache import default_folder
    from urdfcheck.engine import SAMPLES, THOROUGH, Request, run

    paths = tuple(Path(p) for p in options.paths)
    settings = config.find(paths[0] if paths[0].is_dir() else paths[0].parent)
    codes = catalogue.select(_words(options.select) or settings.select)
    codes -= catalogue.select(_words(options.ignore) or settings.ignore)
    libraries.prefer_own()
    outcome = run(
        Request(
            paths=paths,
            root=settings.root,
            codes=frozenset(codes),
            tier=options.tier or settings.tier,
            jobs=_jobs(options.jobs),
            arguments=dict(_pair(text, ":=", "--arg") for text in options.arg),
            packages={**settings.packages, **_packages(options.package)},
            package_paths=(*_folders(options.package_path, "--package-path"), *settings.package_path),
            options=settings.options,
            severities=settings.severity,
            targets=_targets(options.target, settings.target),
            scene="html" in formats,
            cache=None if options.no_cache else default_folder(),
            samples=THOROUGH if options.thorough else SAMPLES,
        ),
        first=first,
        meanwhile=lambda: [importlib.import_module(f"urdfcheck.output.{name}") for name in formats],
    )
    _show(outcome, options.format, options.color)
    for output_format, file in outputs:
        _write(output.render(outcome, output_format), file)
    return exit_code(outcome, options.fail_on or settings.fail_on, allow_empty=options.allow_empty)


def _prepare() -> None:
    """What a worker loads while the parent works its job out."""
    from urdfcheck import catalogue, libraries

    libraries.prefer_own()
    checks = [catalogue.module_of(rule) for rule in catalogue.rules().values() if catalogue.has_check(rule)]
    for module in ("numpy", "urdfcheck.worker", *checks):
        importlib.import_module(module)


def exit_code(run: Run, fail_on: str, *, allow_empty: bool = False) -> int:
    """Our own failures weigh more than findings, findings more than having had nothing to check."""
    from urdfcheck.core import Severity

    if run.failures:
        return FAILED
    if fail_on != "never" and any(f.severity >= Severity.parse(fail_on) and f.suppressed is None for f in run.findings):
        return FINDINGS
    if not run.units:
        return OK if allow_empty else NOTHING
    return OK


def rule(words: Sequence[str]) -> int:
    """``urdfcheck rule [CODE]``: the catalogue, or one page."""
    p = argparse.ArgumentParser(prog="urdfcheck rule", description="List the rules, or explain one.")
    p.add_argument("code", nargs="?", metavar="CODE", help="a code or a name")
    options = p.parse_args(words)

    from urdfcheck import catalogue

    if options.code is None:
        for known in catalogue.rules().values():
            print(f"{known.code}  {known.severity!s:7}  {known.confidence!s:9}  {known.name}")
        return OK
    print("\n\n".join(catalogue.explain(catalogue.rules()[code]) for code in sorted(catalogue.select([options.code]))))
    return OK


def srdf(words: Sequence[str]) -> int:
    """``urdfcheck srdf MODEL``: the pairs of links that MoveIt need not check."""
    from urdfcheck.srdf import SAMPLES, THOROUGH, render, unlike_ours, why_none

    p = argparse.ArgumentParser(
        prog="urdfcheck srdf",
        description="Write the disable_collisions of a robot's SRDF, as MoveIt's Setup Assistant does, with the evidence.",
    )
    p.add_argument("model", metavar="MODEL", help="a model, or whatever means exactly one")
    p.add_argument("-o", "--output", type=Path, metavar="FILE", help="write to a file instead of standard output")
    p.add_argument("--thorough", action="store_true", help=f"look at {THOROUGH:,} configurations, not at {SAMPLES:,}")
    p.add_argument("--arg", action="append", default=[], metavar="NAME:=VALUE", help="xacro argument of the model")
    p.add_argument("--package", action="append", default=[], metavar="NAME=DIR", help="where a ROS package is")
    p.add_argument("--package-path", action="append", default=[], metavar="DIR", help="folder that holds packages")
    p.add_argument("--no-cache", action="store_true", help="keep no measurements and use none that were kept")
    options = p.parse_args(words)
    path = Path(options.model)
    if options.output is not None and unlike_ours(options.output):
        raise UrdfcheckError(
            f"{options.output} was not written by urdfcheck srdf alone: what else it says would be lost"
        )

    from urdfcheck import catalogue, config, libraries
    from urdfcheck.cache import default_folder
    from urdfcheck.engine import Request, run_one

    settings = config.find(path if path.is_dir() else path.parent)
    libraries.prefer_own()
    report = run_one(
        Request(
            paths=(path,),
            root=settings.root,
            # What is wrong with the file says why there is no model.
            codes=frozenset(code for code, rule in catalogue.rules().items() if "file" in rule.scopes),
            arguments=dict(_pair(text, ":=", "--arg") for text in options.arg),
            packages={**settings.packages, **_packages(options.package)},
            package_paths=(*_folders(options.package_path, "--package-path"), *settings.package_path),
            cache=None if options.no_cache else default_folder(),
            samples=THOROUGH if options.thorough else SAMPLES,
            pairs=True,
        )
    )
    if report.pairs is None:
        raise UrdfcheckError(f"{path}: {why_none(report)}")
    if not report.pairs.pairs:
        print(f"urdfcheck: {path}: no two links have collision geometry that can be read", file=sys.stderr)
        return NOTHING
    if options.output is not None:
        _write(render(report.pairs), options.output)
        return OK
    if hasattr(sys.stdout, "reconfigure"):
        sys.stdout.reconfigure(errors="xmlcharrefreplace")
    sys.stdout.write(render(report.pairs))
    return OK


def cache(words: Sequence[str]) -> int:
    """``urdfcheck cache info|clear``: what is kept between runs."""
    p = argparse.ArgumentParser(prog="urdfcheck cache", description="The measurements that are kept between runs.")
    p.add_argument("action", choices=("info", "clear"), help="say where they are and how large, or delete them")
    options = p.parse_args(words)

    from urdfcheck.cache import LARGEST, Cache, default_folder

    kept = Cache(default_folder())
    if kept.folder is None:
        raise UrdfcheckError("this user has no cache folder; URDFCHECK_CACHE_DIR names one")
    files = [status.st_size for _, status in kept.files()]
    size = f"{len(files):,} file{'s' * (len(files) != 1)}, {sum(files) / 1e6:,.2f} MB"
    if options.action == "clear":
        kept.clear()
        print(f"deleted {size} in {kept.folder}")
    else:
        print(f"{kept.folder}\n{size}; above {LARGEST / 1e6:,.0f} MB what was not used for longest is dropped")
    return OK


def _show(run: Run, output_format: str, color: str) -> None:
    from urdfcheck import output

    if hasattr(sys.stdout, "reconfigure"):
        sys.stdout.reconfigure(errors="backslashreplace")
    if output_format != "text":
        sys.stdout.write(output.render(run, output_format))
        return
    from urdfcheck.output import text

    width, colored = text.WIDTH, color == "always"  # a CI log has no width of its own
    if sys.stdout.isatty() or os.environ.keys() & {"COLUMNS", "FORCE_COLOR", "TTY_COMPATIBLE"}:
        from rich.console import Console

        # rich knows terminals, NO_COLOR and the window's width.
        terminal = Console()
        colored = colored or (color == "auto" and terminal.is_terminal and not terminal.no_color)
        width = terminal.width if terminal.is_terminal or "COLUMNS" in os.environ else width
    sys.stdout.write(text.render(run, width=width, color=colored))


def _write(text: str, file: Path) -> None:
    """Write a file whole or not at all."""
    import tempfile

    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        handle, temporary = tempfile.mkstemp(dir=file.parent, prefix=f".{file.name}.")
        try:
            with os.fdopen(handle, "w", encoding="utf-8", newline="\n") as out:
                out.write(text)
            mask = os.umask(0)
            os.umask(mask)
            os.chmod(temporary, 0o666 & ~mask)
            os.replace(temporary, file)
        except BaseException:
            os.unlink(temporary)
            raise
    except OSError as error:
        raise UrdfcheckError(f"cannot write {file}: {error.strerror or error}") from None


def _output(text: str) -> tuple[str, Path]:
    from urdfcheck.output import FORMATS

    output_format, assigned, file = text.partition("=")
    if not assigned or not file or output_format not in FORMATS:
        raise UrdfcheckError(f"--output {text}: write FORMAT=FILE with one of the formats {', '.join(FORMATS)}")
    return output_format, Path(file)


def _words(values: Sequence[str] | None) -> tuple[str, ...]:
    return tuple(w.strip() for value in values or () for w in value.split(",") if w.strip())


def _pair(text: str, separator: str, option: str) -> tuple[str, str]:
    name, assigned, value = text.partition(separator)
    if not assigned or not name:
        raise UrdfcheckError(f"{option} {text}: write NAME{separator}VALUE")
    return name, value


def _packages(values: Sequence[str]) -> dict[str, Path]:
    found = {}
    for text in values:
        name, folder = _pair(text, "=", "--package")
        if not Path(folder).is_dir():
            raise UrdfcheckError(f"--package {text}: {folder} is no folder")
        found[name] = Path(folder).absolute()
    return found


def _folders(values: Sequence[str], option: str) -> list[Path]:
    for folder in values:
        if not Path(folder).is_dir():
            raise UrdfcheckError(f"{option} {folder}: is no folder")
    return [Path(folder) for folder in values]


def _targets(given: str | None, configured: tuple[str, ...]) -> tuple[str, ...]:
    from urdfcheck.config import TARGETS

    names = _words([given]) if given is not None else configured
    unknown = [n for n in names if n not in TARGETS]
    if unknown:
        raise UrdfcheckError(f"--target {unknown[0]}: known targets are {', '.join(TARGETS)}")
    return names


def _jobs(given: int | None) -> int:
    if given is not None and given < 1:
        raise UrdfcheckError(f"--jobs {given}: at least 1")
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return given or cores
