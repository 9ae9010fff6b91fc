"""The options that several commands share, and what they and the configuration ask for."""

from __future__ import annotations

import argparse
import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

from urdfcheck.core.errors import UrdfcheckError

if TYPE_CHECKING:
    from urdfcheck.policy.baseline import Baseline
    from urdfcheck.policy.config import CliOverrides, Config, ConfigResolver
    from urdfcheck.policy.limits import ResourceLimits
    from urdfcheck.run.jobs import Request

# MiB: an audit of an empty robot takes about half of it.
LEAST_MEMORY = 512
# No report has such a name.
MODELS = frozenset({".urdf", ".xacro", ".srdf", ".sdf", ".launch"})
EPILOG = """\
exit codes: 0 nothing at or above --fail-on, 1 findings, 2 urdfcheck or its configuration failed, 3 nothing to check
urdfcheck rule lists the rules, urdfcheck rule CODE explains one"""


class CommandParser(argparse.ArgumentParser):
    """A word of the command line may be a stranger's file name: what is wrong with it is told like everything else."""

    def error(self, message: str) -> NoReturn:
        from urdfcheck.output.shared.inert import escape_for_log

        super().error(escape_for_log(message))


def add_options(p: argparse.ArgumentParser) -> None:
    """The options that decide about what is checked, and how."""
    p.add_argument("--tier", choices=("source", "mesh", "full"), help="how much to compute (default: full)")
    p.add_argument("--select", action="append", metavar="CODES", help="only these rules: codes, prefixes, names, tags")
    p.add_argument("--ignore", action="append", metavar="CODES", help="not these rules")
    p.add_argument(
        "--fail-on", choices=("error", "warning", "info", "never"), help="exit 1 from here on (default: error)"
    )
    add_access_options(p)
    p.add_argument(
        "--all-args", action="store_true", help="each xacro with all values that its text has for its arguments"
    )
    p.add_argument(
        "--target",
        metavar="NAMES",
        help="who will read the model: gazebo, mujoco, drake, …; what one of them refuses is an error",
    )
    p.add_argument("--baseline", type=Path, metavar="FILE", help="findings that are known (see urdfcheck baseline)")
    p.add_argument("--thorough", action="store_true", help="look at 5,000 configurations of the joints instead of 200")
    p.add_argument("--jobs", type=int, metavar="N", help="models checked at the same time (default: the cores)")
    p.add_argument("--allow-empty", action="store_true", help="exit 0 when there is nothing to check")


def add_access_options(p: argparse.ArgumentParser) -> None:
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
        "--isolated",
        action="store_true",
        help="heed no configuration, comment or baseline of the repository (for gates: they may be a stranger's)",
    )
    p.add_argument("--no-cache", action="store_true", help="keep no measurements and use none that were kept")
    p.add_argument("--timeout", type=float, metavar="SECONDS", help="for one model (default: 300; 0: none)")
    p.add_argument("--memory", type=int, metavar="MIB", help="for one model (default: 4096)")


def ensure_paths(options: argparse.Namespace) -> None:
    if not options.paths:
        raise UrdfcheckError("name at least one model, launch file, package or folder (urdfcheck . for this folder)")
    if "" in options.paths:
        raise UrdfcheckError("a path is empty (urdfcheck . for this folder)")


def parse_output(text: str) -> tuple[str, Path]:
    """The format and the file of an ``--output``."""
    from urdfcheck.output import FORMATS, PICTURE_FORMAT

    output_format, assigned, file = text.partition("=")
    if not assigned or not file or output_format not in (*FORMATS, PICTURE_FORMAT):
        formats = ", ".join((*FORMATS, PICTURE_FORMAT))
        raise UrdfcheckError(f"--output {text}: write FORMAT=FILE with one of the formats {formats}")
    return output_format, Path(file)


def is_folder_output(text: str) -> bool:
    """Whether an ``--output`` asks for a folder of pages: it is there, or its name ends with a slash or without a suffix."""
    output_format, _, file = text.partition("=")
    if output_format != "html":
        return False
    path = Path(file)
    return file.endswith(("/", os.sep)) or path.is_dir() or not (path.suffix or path.exists())


def parse_outputs(texts: Sequence[str], paths: Sequence[str]) -> list[tuple[str, Path]]:
    """The formats and files of all ``--output``; two reports do not go into one file, and none into the place of a model.

    :raises UrdfcheckError: when that is asked for.
    """
    found = [parse_output(text) for text in texts]
    taken: dict[str, str] = {}
    inputs = {os.path.realpath(path) for path in paths}
    for text, (_, file) in zip(texts, found, strict=True):
        real = os.path.realpath(file)
        if os.path.exists(real) and not os.path.isfile(real) and not os.path.isdir(real):
            continue  # /dev/null takes any number
        if real in taken:
            raise UrdfcheckError(f"--output {text}: {taken[real]} goes into the same file")
        if (real in inputs and os.path.isfile(real)) or file.suffix.lower() in MODELS:
            raise UrdfcheckError(
                f"--output {text}: that is the file of a model, and a report would be put in its place"
            )
        taken[real] = text
    return found


def load_config(path: Path, options: argparse.Namespace) -> Config:
    """The configuration that holds for a path."""
    from urdfcheck.policy.config import ConfigResolver

    return ConfigResolver(isolated=options.isolated).for_path(path)


def build_access_request(
    options: argparse.Namespace, settings: Config, paths: tuple[Path, ...], codes: frozenset[str]
) -> Request:
    """What the options of `add_access_options` and the configuration ask for."""
    from urdfcheck.policy.policy import Policy
    from urdfcheck.run.jobs import AuditOptions, PackageFolders, Request
    from urdfcheck.system.array_cache import find_default_folder

    return Request(
        paths=paths,
        root=settings.root,
        policy=Policy(codes=codes),
        options=AuditOptions(environment=tuple(options.env), limits=_parse_limits(options.timeout, options.memory)),
        packages=PackageFolders(
            {**settings.packages, **_parse_packages(options.package)},
            (*_parse_folders(options.package_path, "--package-path"), *settings.package_path),
        ),
        arguments=dict(_split_pair(text, ":=", "--arg") for text in options.arg),
        cache=None if options.no_cache else find_default_folder(),
        allowed=tuple(_parse_folders(options.allow_read, "--allow-read")),
    )


def build_request(options: argparse.Namespace, *, scene: bool = False) -> tuple[Request, Config]:
    """What the options of `add_options` and the configurations ask for, and the configuration for the first path: it holds for
    what belongs to no file."""
    from dataclasses import replace

    from urdfcheck.run.jobs import SAMPLES, THOROUGH, PackageFolders

    paths = tuple(Path(p) for p in options.paths)
    configured = make_config_resolver(options, paths)
    configs = [configured.for_path(path) for path in paths]
    settings = configs[0]
    holds = configured.resolve(settings, settings.root)
    request = build_access_request(options, settings, paths, holds.policy.codes)
    request = replace(
        request,
        policy=holds.policy,
        options=replace(
            request.options,
            samples=THOROUGH if options.thorough else SAMPLES,
            scene=scene,
            heed_comments=not options.isolated,
        ),
        packages=PackageFolders(
            _parse_packages(options.package), tuple(_parse_folders(options.package_path, "--package-path"))
        ),
        # The folders that the configurations for the given paths name are in reach, and not those of files found below.
        allowed=(
            *_parse_folders(options.allow_read, "--allow-read"),
            *(folder for config in configs for folder in (*config.packages.values(), *config.package_path)),
        ),
        jobs=_count_jobs(options.jobs),
        baseline=read_baseline(options, settings),
        config_resolver=configured,
        all_arguments=options.all_args,
    )
    return request, settings


def make_config_resolver(options: argparse.Namespace, paths: tuple[Path, ...]) -> ConfigResolver:
    """The configurations of a run, and what the options of `add_options` say that wins over them."""
    from urdfcheck.policy.config import ConfigResolver

    return ConfigResolver(parse_overrides(options), options.isolated, paths)


def parse_overrides(options: argparse.Namespace) -> CliOverrides:
    """What the options of `add_options` say about the rules."""
    from urdfcheck import rules as catalogue
    from urdfcheck.policy.config import CliOverrides

    def select_codes(values: Sequence[str] | None) -> frozenset[str] | None:
        words = _split_words(values)
        return frozenset(catalogue.select_rules(words)) if words else None

    return CliOverrides(
        select_codes(options.select),
        select_codes(options.ignore),
        options.fail_on,
        options.tier,
        None if options.target is None else _parse_targets(options.target),
        options.baseline,
    )


def read_baseline(options: argparse.Namespace, settings: Config) -> Baseline | None:
    """The baseline that was named, or else the one that stands beside the configuration."""
    from urdfcheck.policy import baseline

    file = find_baseline_file(options, settings)
    to_be_made = getattr(options, "action", "") == "write"  # urdfcheck baseline write --baseline FILE
    if not file.is_file() and (options.baseline is None or to_be_made):
        return None
    if options.baseline is None and options.isolated:
        return None
    return baseline.read_baseline(file, settings.root)


def find_baseline_file(options: argparse.Namespace, settings: Config) -> Path:
    """Where the baseline is, or will be."""
    from urdfcheck.policy.baseline import DEFAULT_NAME

    named: Path | None = options.baseline or settings.baseline
    return settings.root / DEFAULT_NAME if named is None else named


def _split_words(values: Sequence[str] | None) -> tuple[str, ...]:
    return tuple(w.strip() for value in values or () for w in value.split(",") if w.strip())


def _split_pair(text: str, separator: str, option: str, meant: str = "VALUE") -> tuple[str, str]:
    name, assigned, value = text.partition(separator)
    if not assigned or not name:
        raise UrdfcheckError(f"{option} {text}: write NAME{separator}{meant}")
    return name, value


def _parse_packages(values: Sequence[str]) -> dict[str, Path]:
    found = {}
    for text in values:
        name, folder = _split_pair(text, "=", "--package", "DIR")
        if not Path(folder).is_dir():
            raise UrdfcheckError(f"--package {text}: {folder} is no folder")
        found[name] = Path(folder).absolute()
    return found


def _parse_folders(values: Sequence[str], option: str) -> list[Path]:
    for folder in values:
        if not Path(folder).is_dir():
            raise UrdfcheckError(f"{option} {folder}: is no folder")
    return [Path(folder) for folder in values]


def _parse_targets(text: str) -> tuple[str, ...]:
    from urdfcheck.policy.config import explain_unknown_target

    names = _split_words([text])
    for name in names:
        if (wrong := explain_unknown_target(name)) is not None:
            raise UrdfcheckError(f"--target: {wrong}")
    return names


def _parse_limits(seconds: float | None, memory: int | None) -> ResourceLimits:
    from urdfcheck.policy.limits import ResourceLimits

    if seconds is not None and not 0 <= seconds < 1e9:
        raise UrdfcheckError(f"--timeout {seconds:g}: a number of seconds, 0 for no limit")
    if memory is not None and memory < LEAST_MEMORY:
        raise UrdfcheckError(f"--memory {memory}: at least {LEAST_MEMORY} MiB, which the libraries take")
    default = ResourceLimits()
    return ResourceLimits(default.seconds if seconds is None else seconds, default.memory if memory is None else memory)


def _count_jobs(given: int | None) -> int:
    if given is not None and given < 1:
        raise UrdfcheckError(f"--jobs {given}: at least 1")
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return given or cores
