"""The command line. Only the standard library is imported before there is something to check."""

from __future__ import annotations

import argparse
import contextlib
import importlib
import os
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn, TextIO

from urdfcheck import __version__
from urdfcheck.errors import UrdfcheckError

if TYPE_CHECKING:
    from urdfcheck.config import Config
    from urdfcheck.core import Run, Severity
    from urdfcheck.engine import Request
    from urdfcheck.limits import Limits

OK, FINDINGS, FAILED, NOTHING = 0, 1, 2, 3
# Seconds from which on, and between which, a run says how far it is.
PROGRESS_FROM, PROGRESS_EVERY = 1.0, 0.2
# MiB: an audit of an empty robot takes about half of it.
LEAST_MEMORY = 512
# Words that later versions use as commands: a file of this name is written ./baseline.
RESERVED = ("baseline", "init", "diff", "lsp", "config", "engines", "drop")

_EPILOG = """\
exit codes: 0 nothing at or above --fail-on, 1 findings, 2 urdfcheck or its configuration failed, 3 nothing to check
urdfcheck rule lists the rules, urdfcheck rule CODE explains one"""


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command and return its exit code."""
    words = list(sys.argv[1:] if argv is None else argv)
    if hasattr(sys.stdout, "reconfigure"):
        sys.stdout.reconfigure(errors="backslashreplace")
    try:
        code = _command(words)
        sys.stdout.flush()
        return code
    except UrdfcheckError as error:
        _say(f"urdfcheck: {error}", sys.stderr)
    except BrokenPipeError:  # the reader of our output has gone: head, less
        _silence_stdout()
        return OK
    except OSError as error:
        _say(f"urdfcheck: cannot write the output: {error.strerror or error}", sys.stderr)
        _silence_stdout()
    except KeyboardInterrupt:
        print("urdfcheck: interrupted", file=sys.stderr)
    return FAILED


def _command(words: list[str]) -> int:
    for word in words[: words.index("--") if "--" in words else None]:
        # A stranger's file, named by a pattern of the shell or by pre-commit: -ohtml=… would write where its name says.
        if word.startswith("-") and os.path.lexists(word):
            raise UrdfcheckError(f"{word} is a file of this name, and would be taken for an option: write ./{word}")
    commands = {"check": check, "audit": audit, "rule": rule, "cache": cache, "srdf": srdf}
    if words and words[0] in commands:
        return commands[words[0]](words[1:])
    if words and words[0] in RESERVED:
        raise UrdfcheckError(
            f"the command {words[0]!r} does not exist yet; to check a file of this name write ./{words[0]}"
        )
    return check(words)


class _Parser(argparse.ArgumentParser):
    """A word of the command line may be a stranger's file name: what is wrong with it is told like everything else."""

    def error(self, message: str) -> NoReturn:
        from urdfcheck.output.inert import for_log

        super().error(for_log(message))


def _say(text: str, stream: TextIO | None = None) -> None:
    """Print a line for a person; on standard output, if on no other stream."""
    from urdfcheck.output.inert import for_log

    print(for_log(text), file=stream)


def _silence_stdout() -> None:
    """What is left in the buffer goes nowhere, so that the interpreter does not try to write it once more."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def parser() -> argparse.ArgumentParser:
    """The options of ``urdfcheck check``."""
    p = _Parser(
        prog="urdfcheck",
        usage="urdfcheck [check] PATH... [options]\n       urdfcheck rule [CODE]\n"
        "       urdfcheck audit DATASET... [options]\n       urdfcheck srdf MODEL [options]\n"
        "       urdfcheck cache info|clear",
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
    _add_options(p)
    p.add_argument(
        "--color", choices=("auto", "always", "never"), default="auto", help="colours (default: on a terminal)"
    )
    p.add_argument("--version", action="version", version=f"urdfcheck {__version__}")
    return p


def _add_options(p: argparse.ArgumentParser) -> None:
    """The options that decide about what is checked, and how."""
    p.add_argument("--tier", choices=("source", "mesh", "full"), help="how much to compute (default: full)")
    p.add_argument("--select", action="append", metavar="CODES", help="only these rules: codes, prefixes, names, tags")
    p.add_argument("--ignore", action="append", metavar="CODES", help="not these rules")
    p.add_argument(
        "--fail-on", choices=("error", "warning", "info", "never"), help="exit 1 from here on (default: error)"
    )
    _add_access(p)
    p.add_argument("--target", metavar="NAMES", help="who will read the model: gazebo, mujoco, drake, … (see MSH011)")
    p.add_argument("--thorough", action="store_true", help="look at 5,000 configurations of the joints instead of 200")
    p.add_argument("--jobs", type=int, metavar="N", help="models checked at the same time (default: the cores)")
    p.add_argument("--allow-empty", action="store_true", help="exit 0 when there is nothing to check")


def _add_access(p: argparse.ArgumentParser) -> None:
    """The options that decide about what a model is read with, and what that may take."""
    p.add_argument("--arg", action="append", default=[], metavar="NAME:=VALUE", help="xacro argument for all models")
    p.add_argument("--package", action="append", default=[], metavar="NAME=DIR", help="where a ROS package is")
    p.add_argument("--package-path", action="append", default=[], metavar="DIR", help="folder that holds packages")
    p.add_argument(
        "--allow-read", action="append", default=[], metavar="DIR", help="folder whose files may be opened too"
    )
    p.add_argument(
        "--env", action="append", default=[], metavar="NAME", help="environment variable that xacro may read"
    )
    p.add_argument(
        "--isolated", action="store_true", help="ignore every configuration file (for gates: it may be a stranger's)"
    )
    p.add_argument("--no-cache", action="store_true", help="keep no measurements and use none that were kept")
    p.add_argument("--timeout", type=float, metavar="SECONDS", help="for one model (default: 300; 0: none)")
    p.add_argument("--memory", type=int, metavar="MIB", help="for one model (default: 4096)")


def check(words: Sequence[str]) -> int:
    """``urdfcheck [check] PATH…``"""
    options = parser().parse_args(words)
    _ensure_paths(options)
    from urdfcheck import workers

    # It loads what an audit needs while the job is being worked out here.
    first = workers.Worker.start(_prepare) if workers.FORKS else None
    outputs = [_output(text) for text in options.output]
    formats = {options.format, *(name for name, _ in outputs)}

    from urdfcheck import libraries, output
    from urdfcheck.engine import run

    request, settings = _request(options, scene="html" in formats)
    libraries.prefer_own()
    outcome = run(
        request,
        first=first,
        meanwhile=lambda: [importlib.import_module(f"urdfcheck.output.{name}") for name in formats],
        progress=_progress(),
    )
    _show(outcome, options.format, options.color)
    for output_format, file in outputs:
        _write(output.render(outcome, output_format), file)
    return exit_code(outcome, options.fail_on or settings.fail_on, allow_empty=options.allow_empty)


def audit(words: Sequence[str]) -> int:
    """``urdfcheck audit DATASET…``: thousands of models, each kept as soon as it is finished."""
    p = _Parser(
        prog="urdfcheck audit",
        description="Audit many models: a line of JSON for each, a summary, a page; what was finished is kept.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    p.add_argument("paths", nargs="*", metavar="DATASET", help="folder of models, or whatever check takes")
    p.add_argument(
        *("-o", "--output"),
        type=Path,
        default=Path("urdfcheck-audit"),
        metavar="FOLDER",
        help="where the lines and the page go, and what the next run needs (default: urdfcheck-audit)",
    )
    p.add_argument("--restart", action="store_true", help="forget what the folder holds, and check everything")
    p.add_argument(
        "--backend",
        default="local",
        metavar="local|dask=ADDRESS|ray[=ADDRESS]",
        help="where the work is done: here, or on a cluster that is there already (pip install urdfcheck[cluster])",
    )
    _add_options(p)
    options = p.parse_args(words)
    _ensure_paths(options)
    backend, _, address = options.backend.partition("=")
    if (
        backend not in {"local", "dask", "ray"}
        or (backend == "local" and address)
        or (backend == "dask" and not address)
    ):
        raise UrdfcheckError(f"--backend {options.backend}: write local, dask=ADDRESS, ray or ray=ADDRESS")
    from urdfcheck import workers

    first = workers.Worker.start(_prepare) if workers.FORKS and backend == "local" else None

    from urdfcheck import catalogue, cluster, dataset, engine, libraries
    from urdfcheck.output import summary

    request, settings = _request(options)
    libraries.prefer_own()
    done = dataset.audit(
        request,
        options.output,
        lambda units, work: (
            engine.stream(units, work, request.jobs, first=first)
            if backend == "local"
            else cluster.stream(units, work, backend, address or None)
        ),
        restart=options.restart,
        progress=_progress(),
    )
    if not done.checked and not done.unchanged:
        _say("nothing to check: no model, launch file or package was found there")
        return OK if options.allow_empty else NOTHING
    sys.stdout.write(summary.render(done.summary, catalogue.rules()))
    known = f"{done.unchanged:,} unchanged, " if done.unchanged else ""
    _say(f"{known}{done.checked:,} checked; {options.output / dataset.LINES}, {options.output / dataset.INDEX}")
    worst = max((severity for severity, number in done.summary.counts.items() if number), default=None)
    return _code(bool(done.summary.failed), worst, options.fail_on or settings.fail_on)


def _ensure_paths(options: argparse.Namespace) -> None:
    if not options.paths:
        raise UrdfcheckError("name at least one model, launch file, package or folder (urdfcheck . for this folder)")
    if "" in options.paths:
        raise UrdfcheckError("a path is empty (urdfcheck . for this folder)")


def _settings(path: Path, options: argparse.Namespace) -> Config:
    """The configuration that holds for a path."""
    from urdfcheck import config

    folder = path if path.is_dir() else path.parent
    return config.without_file(folder) if options.isolated else config.find(folder)


def _reading(options: argparse.Namespace, settings: Config, paths: tuple[Path, ...], codes: frozenset[str]) -> Request:
    """What the options of `_add_access` and the configuration ask for."""
    from urdfcheck.cache import default_folder
    from urdfcheck.engine import Request

    return Request(
        paths=paths,
        root=settings.root,
        codes=codes,
        arguments=dict(_pair(text, ":=", "--arg") for text in options.arg),
        packages={**settings.packages, **_packages(options.package)},
        package_paths=(*_folders(options.package_path, "--package-path"), *settings.package_path),
        cache=None if options.no_cache else default_folder(),
        allowed=tuple(_folders(options.allow_read, "--allow-read")),
        environment=tuple(options.env),
        limits=_limits(options.timeout, options.memory),
    )


def _request(options: argparse.Namespace, *, scene: bool = False) -> tuple[Request, Config]:
    """What the options of `_add_options` and the configuration ask for, and the configuration."""
    from dataclasses import replace

    from urdfcheck import catalogue
    from urdfcheck.engine import SAMPLES, THOROUGH

    paths = tuple(Path(p) for p in options.paths)
    settings = _settings(paths[0], options)
    codes = catalogue.select(_words(options.select) or settings.select)
    codes -= catalogue.select(_words(options.ignore) or settings.ignore)
    request = replace(
        _reading(options, settings, paths, frozenset(codes)),
        tier=options.tier or settings.tier,
        jobs=_jobs(options.jobs),
        options=settings.options,
        severities=settings.severity,
        targets=_targets(options.target, settings.target),
        scene=scene,
        samples=THOROUGH if options.thorough else SAMPLES,
    )
    return request, settings


def _prepare() -> None:
    """What a worker loads while the parent works its job out."""
    from urdfcheck import catalogue, libraries

    libraries.prefer_own()
    checks = [catalogue.module_of(rule) for rule in catalogue.rules().values() if catalogue.has_check(rule)]
    for module in ("numpy", "urdfcheck.worker", *checks):
        importlib.import_module(module)
    with contextlib.suppress(ImportError):  # where there is none, it is not missed
        importlib.import_module("py_landlock")


def exit_code(run: Run, fail_on: str, *, allow_empty: bool = False) -> int:
    """Our own failures weigh more than findings, findings more than having had nothing to check."""
    worst = max((f.severity for f in run.findings if f.suppressed is None), default=None)
    code = _code(bool(run.failures), worst, fail_on)
    return NOTHING if code == OK and not run.units and not allow_empty else code


def _code(failed: bool, worst: Severity | None, fail_on: str) -> int:
    from urdfcheck.core import Severity

    if failed:
        return FAILED
    if fail_on != "never" and worst is not None and worst >= Severity.parse(fail_on):
        return FINDINGS
    return OK


def rule(words: Sequence[str]) -> int:
    """``urdfcheck rule [CODE]``: the catalogue, or one page."""
    p = _Parser(prog="urdfcheck rule", description="List the rules, or explain one.")
    p.add_argument("code", nargs="?", metavar="CODE", help="a code or a name")
    options = p.parse_args(words)

    from urdfcheck import catalogue

    if options.code is None:
        for known in catalogue.rules().values():
            _say(f"{known.code}  {known.severity!s:7}  {known.confidence!s:9}  {known.name}")
        return OK
    _say("\n\n".join(catalogue.explain(catalogue.rules()[code]) for code in sorted(catalogue.select([options.code]))))
    return OK


def srdf(words: Sequence[str]) -> int:
    """``urdfcheck srdf MODEL``: the pairs of links that MoveIt need not check."""
    from urdfcheck.srdf import SAMPLES, THOROUGH, render, unlike_ours, why_none

    p = _Parser(
        prog="urdfcheck srdf",
        description="Write the disable_collisions of a robot's SRDF, as MoveIt's Setup Assistant does, with the evidence.",
    )
    p.add_argument("model", metavar="MODEL", help="a model, or whatever means exactly one")
    p.add_argument("-o", "--output", type=Path, metavar="FILE", help="write to a file instead of standard output")
    p.add_argument("--thorough", action="store_true", help=f"look at {THOROUGH:,} configurations, not at {SAMPLES:,}")
    _add_access(p)
    options = p.parse_args(words)
    path = Path(options.model)
    if options.output is not None and unlike_ours(options.output):
        raise UrdfcheckError(
            f"{options.output} was not written by urdfcheck srdf alone: what else it says would be lost"
        )

    from dataclasses import replace

    from urdfcheck import catalogue, libraries
    from urdfcheck.engine import run_one

    # What is wrong with the file says why there is no model.
    codes = frozenset(code for code, rule in catalogue.rules().items() if "file" in rule.scopes)
    libraries.prefer_own()
    report = run_one(
        replace(
            _reading(options, _settings(path, options), (path,), codes),
            samples=THOROUGH if options.thorough else SAMPLES,
            pairs=True,
        )
    )
    if report.pairs is None:
        raise UrdfcheckError(f"{path}: {why_none(report)}")
    if not report.pairs.pairs:
        _say(f"urdfcheck: {path}: no two links have collision geometry that can be read", sys.stderr)
        return NOTHING
    from urdfcheck.output.inert import for_xml

    document = for_xml(render(report.pairs))
    if options.output is not None:
        _write(document, options.output)
    else:
        _show_document(document)
    return OK


def cache(words: Sequence[str]) -> int:
    """``urdfcheck cache info|clear``: what is kept between runs."""
    p = _Parser(prog="urdfcheck cache", description="The measurements that are kept between runs.")
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
        _say(f"deleted {size} in {kept.folder}")
    else:
        _say(f"{kept.folder}\n{size}; above {LARGEST / 1e6:,.0f} MB what was not used for longest is dropped")
    return OK


def _show(run: Run, output_format: str, color: str) -> None:
    from urdfcheck import output

    if output_format != "text":
        _show_document(output.render(run, output_format))
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


def _show_document(text: str) -> None:
    """JSON, HTML and XML are UTF-8 wherever they go; text has the terminal's encoding."""
    if hasattr(sys.stdout, "reconfigure"):
        sys.stdout.reconfigure(encoding="utf-8")
    sys.stdout.write(text)


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


def _limits(seconds: float | None, memory: int | None) -> Limits:
    from urdfcheck.limits import Limits

    if seconds is not None and not 0 <= seconds < 1e9:
        raise UrdfcheckError(f"--timeout {seconds:g}: a number of seconds, 0 for no limit")
    if memory is not None and memory < LEAST_MEMORY:
        raise UrdfcheckError(f"--memory {memory}: at least {LEAST_MEMORY} MiB, which the libraries take")
    default = Limits()
    return Limits(default.seconds if seconds is None else seconds, default.memory if memory is None else memory)


def _progress() -> Callable[[int, int], None] | None:
    """Shows on a terminal how far a run is; nothing where no one watches."""
    if not sys.stderr.isatty():
        return None
    import time

    began = time.monotonic()
    shown = 0.0

    def show(done: int, total: int) -> None:
        nonlocal shown
        now = time.monotonic()
        if done == total:
            text = ""
        elif now - began < PROGRESS_FROM or now - shown < PROGRESS_EVERY:
            return
        else:
            left = (now - began) / done * (total - done)
            text = f"{done:,} of {total:,} checked, about {left:,.0f} s left"
        if text or shown:
            print(f"\r\x1b[K{text}", end="", file=sys.stderr, flush=True)
            shown = now

    return show


def _jobs(given: int | None) -> int:
    if given is not None and given < 1:
        raise UrdfcheckError(f"--jobs {given}: at least 1")
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return given or cores
