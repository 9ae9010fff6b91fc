"""Finds the configuration of each checked file, upwards from it, and merges its sections and the command line."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import field, replace
from pathlib import Path
from typing import Any

from urdfcheck.core import Severity
from urdfcheck.core.records import dataclass
from urdfcheck.policy.baseline import DEFAULT_NAME, STALE_BASELINE
from urdfcheck.policy.config import Config, Section
from urdfcheck.policy.config_file import read_folder_config
from urdfcheck.policy.consumers import SIMULATORS
from urdfcheck.policy.on_request import find_postponed
from urdfcheck.policy.policy import TIERS, Policy
from urdfcheck.policy.suppression import SuppressionEntry
from urdfcheck.rules import load_rules


@dataclass(frozen=True, slots=True, kw_only=True)
class CliOverrides:
    """Settings of the command line, which override every configuration; None where it sets nothing."""

    select: frozenset[str] | None = None
    ignore: frozenset[str] | None = None
    fail_on: str | None = None
    tier: str | None = None
    target: tuple[str, ...] | None = None
    unchecked: str | None = None
    baseline: Path | None = None
    exclude: tuple[str, ...] = ()
    """Patterns that are excluded besides those of the configuration, relative to the working directory."""
    shows_all: bool = False
    """Whether notes on request are reported too."""
    pedantic: bool = False
    """Whether notes on request are reported too, and lowered severities are not lowered."""


@dataclass(frozen=True, slots=True, kw_only=True)
class EffectiveConfig:
    """The configuration of one file after sections and command line."""

    policy: Policy
    fail_on: str
    """Least severity of a finding that fails the run."""
    baseline: Path | None


@dataclass(slots=True)
class ConfigResolver:
    """Finds the configuration of each file: the nearest one above it, read once."""

    overrides: CliOverrides = field(default_factory=CliOverrides)
    isolated: bool = False
    """Whether configuration files are ignored."""
    paths: tuple[Path, ...] = ()
    """Paths of the command line; without a configuration file, ids below one of them are relative to the same folder."""
    named: Config | None = None
    """The configuration of all files, whatever files there are."""
    _configs_by_folder: dict[Path, Config | None] = field(default_factory=dict)
    _defaults_by_folder: dict[Path, Config] = field(default_factory=dict)
    _starts: dict[Path, int] = field(init=False)
    """The paths of the command line, absolute, with their places among them."""

    def __post_init__(self) -> None:
        starts = (Path(os.path.abspath(path)) for path in self.paths)
        self._starts = {start: place for place, start in reversed(list(enumerate(starts)))}

    def for_path(self, path: Path) -> Config:
        """Return the configuration of a file or folder, with what the command line excludes.

        Elsewhere, a named configuration has the root that there would be without a configuration: ids and patterns
        are relative to what is checked, and only the folders that it names are relative to it.

        :raises UrdfcheckError: as for :func:`find_config`.
        """
        folder = Path(os.path.abspath(path))
        folder = folder if os.path.isdir(folder) else folder.parent  # Path.is_dir() raises where access is denied
        found = self.named
        if found is None and not self.isolated:
            found = self._find_above(folder)
        if found is None or not folder.is_relative_to(found.root):
            root = self._make_default(folder).root
            found = Config(root=root) if found is None else replace(found, root=root)
        given = self.overrides.exclude
        return replace(found, exclude_here=given) if given else found

    def _make_default(self, folder: Path) -> Config:
        if folder not in self._defaults_by_folder:
            above = [level for level in (folder, *folder.parents) if level in self._starts]
            start = min(above, key=self._starts.__getitem__, default=folder)
            self._defaults_by_folder[folder] = make_default_config(start)
        return self._defaults_by_folder[folder]

    def _find_above(self, folder: Path) -> Config | None:
        climbed: list[Path] = []
        found: Config | None = None
        for level in (folder, *folder.parents):
            if level in self._configs_by_folder:
                found = self._configs_by_folder[level]
                break
            climbed.append(level)
            found = read_folder_config(level)
            if found is not None:
                break
        self._configs_by_folder.update(dict.fromkeys(climbed, found))
        return found

    def resolve(self, config: Config, path: Path) -> EffectiveConfig:
        """Return the effective configuration of a file."""
        return resolve_config(
            config,
            sections=config.get_sections(path),
            suppressions=config.get_suppressions(path),
            unchecked=config.grade_unchecked(path),
            overrides=self.overrides,
        )


def resolve_config(
    config: Config,
    *,
    sections: Sequence[Section],
    suppressions: tuple[SuppressionEntry, ...],
    unchecked: str,
    overrides: CliOverrides,
) -> EffectiveConfig:
    """Merge the sections, each over those before it, and the command line over all of them.

    ``unchecked``: see `Config.grade_unchecked`.
    """
    everything = frozenset(load_rules())
    codes = everything if overrides.select is None else overrides.select
    requested = everything if overrides.shows_all else overrides.select or frozenset()
    severities = {STALE_BASELINE: "error"} if config.strict_baseline else {}
    options: dict[str, dict[str, Any]] = {}
    targets: tuple[str, ...] = ()
    pedantic = kinematics_only = False
    for number, section in enumerate(sections):
        if overrides.select is None and section.select is not None:
            codes = codes | section.select if number else section.select
            requested |= section.select
        if overrides.ignore is None and section.ignore is not None:
            codes -= section.ignore
        severities.update(section.severity)
        requested |= section.severity.keys()
        requested |= section.options.keys()
        for code, values in section.options.items():
            options[code] = {**options.get(code, {}), **values}
        targets = targets if section.target is None else section.target
        pedantic = pedantic if section.pedantic is None else section.pedantic
        kinematics_only = kinematics_only if section.kinematics_only is None else section.kinematics_only
    pedantic = pedantic or overrides.pedantic
    targets = targets if overrides.target is None else overrides.target
    kinematics_only = kinematics_only and overrides.select is None and SIMULATORS.isdisjoint(targets)
    if kinematics_only:
        codes -= {code for code, rule in load_rules().items() if rule.dynamics == rule.messages.keys()}
    codes -= overrides.ignore or frozenset()
    unrequested = everything - requested
    tier = overrides.tier or config.tier
    postponed = frozenset[str]()
    if tier == TIERS[-1] and not pedantic:  # a lower tier skips these rules anyway, and says so
        postponed = codes & find_postponed(load_rules(), unrequested=unrequested, targets=targets)
    policy = Policy(
        codes=codes - postponed,
        unrequested=unrequested,
        postponed=postponed,
        pedantic=pedantic,
        kinematics_only=kinematics_only,
        tier=tier,
        options=options,
        severities=severities,
        targets=targets,
        suppress=suppressions,
        unchecked=Severity.parse(overrides.unchecked or unchecked),
    )
    return EffectiveConfig(
        policy=policy,
        fail_on=overrides.fail_on or config.fail_on,
        baseline=config.baseline if overrides.baseline is None else overrides.baseline,
    )


def find_config(start: Path) -> Config:
    """Return the configuration of a path.

    Without one, return the defaults with the enclosing git repository (or the working directory) as root.

    :raises UrdfcheckError: for a file that is not TOML, an unknown key or a value of the wrong type.
    """
    return ConfigResolver().for_path(start)


def make_default_config(start: Path) -> Config:
    """Return the defaults, for a path without a configuration file.

    Ids of models are relative to the repository, or the folder of their baseline, or the working directory.
    """
    start = start.absolute()
    for folder in (start, *start.parents):
        if os.path.exists(folder / ".git") or os.path.isfile(folder / DEFAULT_NAME):
            return Config(root=folder)
    return Config(root=Path.cwd())
