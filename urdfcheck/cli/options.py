"""The options that several commands share, and what they and the configuration ask for."""

from __future__ import annotations

import argparse
import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

from urdfcheck.errors import UrdfcheckError

if TYPE_CHECKING:
    from urdfcheck.config import Config
    from urdfcheck.engine import Request
    from urdfcheck.limits import Limits

# MiB: an audit of an empty robot takes about half of it.
LEAST_MEMORY = 512
EPILOG = """\
exit codes: 0 nothing at or above --fail-on, 1 findings, 2 urdfcheck or its configuration failed, 3 nothing to check
urdfcheck rule lists the rules, urdfcheck rule CODE explains one"""


class Parser(argparse.ArgumentParser):
    """A word of the command line may be a stranger's file name: what is wrong with it is told like everything else."""

    def error(self, message: str) -> NoReturn:
        from urdfcheck.output.inert import for_log

        super().error(for_log(message))


def add_options(p: argparse.ArgumentParser) -> None:
    """The options that decide about what is checked, and how."""
    p.add_argument("--tier", choices=("source", "mesh", "full"), help="how much to compute (default: full)")
    p.add_argument("--select", action="append", metavar="CODES", help="only these rules: codes, prefixes, names, tags")
    p.add_argument("--ignore", action="append", metavar="CODES", help="not these rules")
    p.add_argument(
        "--fail-on", choices=("error", "warning", "info", "never"), help="exit 1 from here on (default: error)"
    )
    add_access(p)
    p.add_argument("--target", metavar="NAMES", help="who will read the model: gazebo, mujoco, drake, … (see MSH011)")
    p.add_argument("--thorough", action="store_true", help="look at 5,000 configurations of the joints instead of 200")
    p.add_argument("--jobs", type=int, metavar="N", help="models checked at the same time (default: the cores)")
    p.add_argument("--allow-empty", action="store_true", help="exit 0 when there is nothing to check")


def add_access(p: argparse.ArgumentParser) -> None:
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


def ensure_paths(options: argparse.Namespace) -> None:
    if not options.paths:
        raise UrdfcheckError("name at least one model, launch file, package or folder (urdfcheck . for this folder)")
    if "" in options.paths:
        raise UrdfcheckError("a path is empty (urdfcheck . for this folder)")


def configuration(path: Path, options: argparse.Namespace) -> Config:
    """The configuration that holds for a path."""
    from urdfcheck import config

    folder = path if path.is_dir() else path.parent
    return config.without_file(folder) if options.isolated else config.find(folder)


def reading(options: argparse.Namespace, settings: Config, paths: tuple[Path, ...], codes: frozenset[str]) -> Request:
    """What the options of `add_access` and the configuration ask for."""
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


def requested(options: argparse.Namespace, *, scene: bool = False) -> tuple[Request, Config]:
    """What the options of `add_options` and the configuration ask for, and the configuration."""
    from dataclasses import replace

    from urdfcheck import catalogue
    from urdfcheck.engine import SAMPLES, THOROUGH

    paths = tuple(Path(p) for p in options.paths)
    settings = configuration(paths[0], options)
    codes = catalogue.select(_words(options.select) or settings.select)
    codes -= catalogue.select(_words(options.ignore) or settings.ignore)
    request = replace(
        reading(options, settings, paths, frozenset(codes)),
        tier=options.tier or settings.tier,
        jobs=_jobs(options.jobs),
        options=settings.options,
        severities=settings.severity,
        targets=_targets(options.target, settings.target),
        scene=scene,
        samples=THOROUGH if options.thorough else SAMPLES,
    )
    return request, settings


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


def _jobs(given: int | None) -> int:
    if given is not None and given < 1:
        raise UrdfcheckError(f"--jobs {given}: at least 1")
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return given or cores
