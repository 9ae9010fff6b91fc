"""From what a user asks for, on the command line or from Python, to the `Request` of a run."""

from __future__ import annotations

import os
import shlex
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import field, replace
from pathlib import Path
from typing import TYPE_CHECKING

from urdfcheck.core.errors import UrdfcheckError
from urdfcheck.core.records import dataclass
from urdfcheck.policy.limits import ResourceLimits
from urdfcheck.policy.policy import TIERS, Policy
from urdfcheck.run.jobs import SAMPLES, AuditOptions, PackageFolders, Request

if TYPE_CHECKING:
    from urdfcheck.policy.baseline import Baseline
    from urdfcheck.policy.config import Config
    from urdfcheck.policy.config_resolver import ConfigResolver

# MiB: an audit of an empty robot takes about half of it.
MIN_MEMORY = 512
AnyPath = str | os.PathLike[str]


@dataclass(frozen=True, slots=True, kw_only=True)
class RunOptions:
    """What a user asks for; it wins over the configuration. None: the configuration or the default decides."""

    paths: Sequence[AnyPath] = ()
    """Models, launch files, meshes, packages and folders."""
    select: Sequence[str] | None = None
    """Codes, prefixes, names and tags of the only rules to run."""
    ignore: Sequence[str] | None = None
    """Those of the rules not to run."""
    fail_on: str | None = None
    """Least severity of a finding that fails the run: error | warning | info | never."""
    tier: str | None = None
    """How much is computed: source | mesh | full."""
    unchecked: str | None = None
    """How bad it is that a model cannot be checked: error | warning."""
    target: Sequence[str] | None = None
    """Programs that will read the models."""
    config: AnyPath | None = None
    """The configuration of everything that is checked, instead of the nearest one above each file."""
    exclude: Sequence[str] = ()
    """Patterns of files and folders that are skipped too when a folder is checked, relative to the working directory."""
    baseline: AnyPath | None = None
    """File of accepted findings."""
    may_lack_baseline: bool = False
    """Whether `baseline` need not exist."""
    arguments: Mapping[str, str] = field(default_factory=dict)
    """Values of xacro arguments."""
    all_arguments: bool = False
    """Whether each xacro is expanded with all values that its text gives for its arguments."""
    packages: Mapping[str, AnyPath] = field(default_factory=dict)
    """Folder of each ROS package by name."""
    package_paths: Sequence[AnyPath] = ()
    """Folders that hold packages."""
    allow_read: Sequence[AnyPath] = ()
    """Additional folders whose files may be opened."""
    environment: Sequence[str] = ()
    """Environment variables that a xacro may read."""
    isolated: bool = False
    """Whether configurations, comments and baselines of the repository are ignored."""
    cache: bool = True
    """Whether results are kept between runs."""
    timeout: float | None = None
    """Seconds for one model; 0: unlimited."""
    memory: int | None = None
    """MiB for one model."""
    show_all: bool = False
    """Whether notes on request are reported too, without being selected."""
    pedantic: bool = False
    """Whether notes on request are reported too, and lowered severities are not lowered."""
    samples: int = SAMPLES
    """Number of joint configurations to sample."""
    jobs: int | None = None
    """Number of models checked at the same time; None: as many as there are cores."""
    spelling: Mapping[str, str] = field(default_factory=dict)
    """How error messages spell the fields; their names where it is silent."""

    def spell(self, name: str) -> str:
        """Return what the user calls a field."""
        return self.spelling.get(name, name)

    def list_reading_options(self) -> tuple[str, ...]:
        """Return the options of the command that say what may be read and where packages are, as they are typed in a shell."""
        given = (
            *(("--package", f"{name}={os.fspath(folder)}") for name, folder in self.packages.items()),
            *(("--package-path", os.fspath(folder)) for folder in self.package_paths),
            *(("--allow-read", os.fspath(folder)) for folder in self.allow_read),
            *(("--env", name) for name in self.environment),
        )
        return tuple(f"{option} {shlex.quote(value)}" for option, value in given)


def split_words(values: Iterable[str]) -> tuple[str, ...]:
    """Split comma-separated words."""
    return tuple(word.strip() for value in values for word in value.split(",") if word.strip())


def make_config_resolver(options: RunOptions) -> ConfigResolver:
    """Make the configurations of a run, with the options that win over them.

    :raises UrdfcheckError: for unknown rules and targets, and for a named configuration with an error.
    """
    from urdfcheck.policy.config import UNCHECKED
    from urdfcheck.policy.config_file import read_named_config
    from urdfcheck.policy.config_resolver import CliOverrides, ConfigResolver
    from urdfcheck.policy.config_table import explain_unknown_target
    from urdfcheck.rules import select_rules

    def select_codes(words: Sequence[str] | None) -> frozenset[str] | None:
        return frozenset(select_rules(words)) if words else None

    if options.tier not in {None, *TIERS}:
        raise UrdfcheckError(f"{options.spell('tier')} {options.tier}: one of {', '.join(TIERS)}")
    if options.unchecked not in {None, *UNCHECKED}:
        raise UrdfcheckError(f"{options.spell('unchecked')} {options.unchecked}: one of {', '.join(UNCHECKED)}")
    for name in options.target or ():
        if (problem := explain_unknown_target(name)) is not None:
            raise UrdfcheckError(f"{options.spell('target')}: {problem}")
    overrides = CliOverrides(
        select=select_codes(options.select),
        ignore=select_codes(options.ignore),
        fail_on=options.fail_on,
        tier=options.tier,
        target=None if options.target is None else tuple(options.target),
        unchecked=options.unchecked,
        baseline=None if options.baseline is None else Path(options.baseline),
        exclude=tuple(options.exclude),
        shows_all=options.show_all,
        pedantic=options.pedantic,
    )
    named = None if options.config is None else read_named_config(Path(options.config))
    return ConfigResolver(overrides, options.isolated, tuple(map(Path, options.paths)), named)


def make_request(options: RunOptions, *, scene: bool = False) -> tuple[Request, Config]:
    """Resolve the options and the configurations of the given paths.

    Also returns the configuration of the first path, which holds for what belongs to no file.

    :param scene: whether the run is to hold what graphical outputs draw.
    :raises UrdfcheckError: for an option or a configuration with an error.
    """
    resolver = make_config_resolver(options)
    configs = [resolver.for_path(Path(path)) for path in options.paths]
    config = configs[0]
    effective = resolver.resolve(config, config.root)
    request = make_access_request(options, config, effective.policy.codes)
    request = replace(
        request,
        policy=effective.policy,
        options=replace(
            request.options,
            samples=options.samples,
            scene=scene,
            heed_comments=not options.isolated,
            reading=options.list_reading_options(),
        ),
        packages=PackageFolders(
            _resolve_packages(options), _resolve_folders(options.package_paths, options.spell("package_paths"))
        ),
        # The folders that the configurations of the given paths name are in reach, those of files found below are not.
        allowed=(
            *_resolve_folders(options.allow_read, options.spell("allow_read")),
            *(folder for config in configs for folder in (*config.packages.values(), *config.package_path)),
        ),
        baseline=read_baseline(options, config),
        config_resolver=resolver,
        all_arguments=options.all_arguments,
    )
    return request, config


def make_access_request(options: RunOptions, config: Config, codes: frozenset[str]) -> Request:
    """Resolve only what a model is read with and what that may take, for commands that select the rules themselves.

    :raises UrdfcheckError: for an option with an error.
    """
    from urdfcheck.system.cache_folder import find_default_folder

    return Request(
        paths=tuple(map(Path, options.paths)),
        root=config.root,
        policy=Policy(codes=codes),
        options=AuditOptions(environment=tuple(options.environment), limits=_resolve_limits(options)),
        packages=PackageFolders(
            {**config.packages, **_resolve_packages(options)},
            (*_resolve_folders(options.package_paths, options.spell("package_paths")), *config.package_path),
        ),
        jobs=_count_jobs(options),
        arguments=dict(options.arguments),
        cache=find_default_folder() if options.cache else None,
        allowed=_resolve_folders(options.allow_read, options.spell("allow_read")),
    )


def find_baseline_file(options: RunOptions, config: Config) -> Path:
    """Return where the baseline is, or will be."""
    from urdfcheck.policy.baseline import DEFAULT_NAME

    file = config.baseline if options.baseline is None else Path(options.baseline)
    return config.root / DEFAULT_NAME if file is None else file


def read_baseline(options: RunOptions, config: Config) -> Baseline | None:
    """Read the baseline that was named, or else the one beside the configuration; None where there is none.

    :raises UrdfcheckError: if it cannot be read.
    """
    from urdfcheck.policy import baseline

    file = find_baseline_file(options, config)
    if not os.path.isfile(file) and (options.baseline is None or options.may_lack_baseline):
        return None
    if options.baseline is None:
        return None if options.isolated else baseline.read_found_baseline(file, config.root)
    return baseline.read_baseline(file, config.root)


def _resolve_packages(options: RunOptions) -> dict[str, Path]:
    for name, folder in options.packages.items():
        if not Path(folder).is_dir():
            text = os.fspath(folder)
            hint = f"; write the folder of package {name} in its place" if text == "FOLDER" else ""
            raise UrdfcheckError(f"{options.spell('packages')} {name}={text}: {text} is not a folder{hint}")
    return {name: Path(folder).absolute() for name, folder in options.packages.items()}


def _resolve_folders(folders: Sequence[AnyPath], option: str) -> tuple[Path, ...]:
    for folder in folders:
        if not Path(folder).is_dir():
            raise UrdfcheckError(f"{option} {os.fspath(folder)}: is not a folder")
    return tuple(map(Path, folders))


def _resolve_limits(options: RunOptions) -> ResourceLimits:
    seconds, memory, default = options.timeout, options.memory, ResourceLimits()
    if seconds is not None and not 0 <= seconds < 1e9:
        raise UrdfcheckError(f"{options.spell('timeout')} {seconds:g}: a number of seconds, 0 for no limit")
    if memory is not None and memory < MIN_MEMORY:
        raise UrdfcheckError(
            f"{options.spell('memory')} {memory}: at least {MIN_MEMORY} MiB, the footprint of the libraries"
        )
    return ResourceLimits(default.seconds if seconds is None else seconds, default.memory if memory is None else memory)


def _count_jobs(options: RunOptions) -> int:
    if options.jobs is not None and options.jobs < 1:
        raise UrdfcheckError(f"{options.spell('jobs')} {options.jobs}: at least 1")
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return options.jobs or cores
