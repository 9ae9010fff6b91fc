"""What a configuration says: its settings, sections, named models and suppressions."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from pathlib import Path
from typing import Any

from urdfcheck.core.records import dataclass
from urdfcheck.policy.suppression import SuppressionEntry
from urdfcheck.source.text.globs import match_any_pattern, split_relative_path
from urdfcheck.source.text.toml import Key

OWN_FILE, PROJECT_FILE = "urdfcheck.toml", "pyproject.toml"
FAIL_ON = ("error", "warning", "info", "never")
UNCHECKED = ("error", "warning")
TARGETS = ("gazebo", "mujoco", "drake", "bullet", "isaac", "moveit", "rviz", "pinocchio", "ros2_control", "kdl")


@dataclass(frozen=True, slots=True, kw_only=True)
class Section:
    """Settings of the rules in the table, or in a ``[[paths]]`` section; None where nothing is set."""

    match: tuple[str, ...] = ()
    """Patterns of the files that the section is for."""
    select: frozenset[str] | None = None
    """Codes, whatever words they were typed as."""
    ignore: frozenset[str] | None = None
    severity: Mapping[str, str] = field(default_factory=dict)
    """Code → severity."""
    options: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    """Code → option → value."""
    target: tuple[str, ...] | None = None
    pedantic: bool | None = None
    """Whether nothing is lowered or left out."""
    kinematics_only: bool | None = None
    """Whether the models are for display and motion planning alone."""
    key: Key = ()
    """Path of the section in the table."""


@dataclass(frozen=True, slots=True)
class NamedModel:
    """A ``[[models]]`` entry: the file is checked with these arguments, under this name if it has one."""

    path: Path
    name: str | None
    arguments: Mapping[str, str]


@dataclass(frozen=True, slots=True, kw_only=True)
class Config:
    """The configuration of the files below a folder, without the command line."""

    root: Path
    """The folder; ids of models are relative to it."""
    file: Path | None = None
    """The configuration file; None for the defaults."""
    sections: tuple[Section, ...] = (Section(),)
    """The table itself, then its ``[[paths]]``."""
    fail_on: str = "error"
    tier: str = "full"
    unchecked: str | tuple[str, ...] = "error"
    """How bad it is that a model cannot be checked: error | warning, or patterns of the models for which it is a warning."""
    strict_baseline: bool = False
    """Whether a baseline entry whose finding is gone is an error."""
    exclude: tuple[str, ...] = ()
    """Patterns of files and folders below the root that are skipped when a folder is checked."""
    exclude_here: tuple[str, ...] = ()
    """Those of the command line, relative to the working directory."""
    packages: Mapping[str, Path] = field(default_factory=dict)
    package_path: tuple[Path, ...] = ()
    baseline: Path | None = None
    models: tuple[NamedModel, ...] = ()
    suppress: tuple[tuple[str, SuppressionEntry], ...] = ()
    """Entries with the pattern of the models that they are for, empty for all."""

    @property
    def target(self) -> tuple[str, ...]:
        """Programs that will read the models, unless a section names others."""
        return self.sections[0].target or ()

    def excludes(self, path: Path) -> bool:
        """Whether a file that is discovered in a folder is skipped."""
        patterns = ((self.exclude, self.root), (self.exclude_here, Path.cwd()))
        return any(p and match_any_pattern(p, split_relative_path(path, root)) for p, root in patterns)

    def grade_unchecked(self, path: Path) -> str:
        """Return how bad it is that this model cannot be checked: error | warning."""
        if isinstance(self.unchecked, str):
            return self.unchecked
        return "warning" if match_any_pattern(self.unchecked, split_relative_path(path, self.root)) else "error"

    def get_sections(self, path: Path) -> tuple[Section, ...]:
        """Return the table, and the sections that match a file."""
        names = split_relative_path(path, self.root)
        return tuple(s for i, s in enumerate(self.sections) if not i or match_any_pattern(s.match, names))

    def get_suppressions(self, path: Path) -> tuple[SuppressionEntry, ...]:
        """Return the suppressions for a file."""
        names = split_relative_path(path, self.root)
        return tuple(entry for pattern, entry in self.suppress if not pattern or match_any_pattern([pattern], names))
