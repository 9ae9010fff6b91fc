"""What there is to check: the models with their arguments, launch files and packages that the given paths lead to."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field, replace
from pathlib import Path
from typing import Any, Protocol

from urdfcheck.core.records import dataclass
from urdfcheck.source.reach import FileReach


class ConfiguredModel(Protocol):
    """A model that a configuration names, with its arguments."""

    @property
    def path(self) -> Path: ...
    @property
    def name(self) -> str | None: ...
    @property
    def arguments(self) -> Mapping[str, str]: ...


class DiscoveryConfig(Protocol):
    """The part of a configuration that discovery needs: where packages and models are, and what to leave out."""

    @property
    def packages(self) -> Mapping[str, Path]: ...
    @property
    def package_path(self) -> Sequence[Path]: ...
    @property
    def models(self) -> Sequence[ConfiguredModel]: ...
    def excludes(self, path: Path) -> bool: ...


@dataclass(frozen=True, slots=True, kw_only=True)
class ModelTarget:
    """A model to check, with the arguments to expand it with."""

    path: Path
    arguments: Mapping[str, str] = field(default_factory=dict)
    launches: tuple[Path, ...] = ()
    """Launch files that start the model, to be checked with it."""
    explicit: bool = False
    """Whether the user named the file."""
    tentative: bool = False
    """Whether only its expansion shows that the file is a model: it makes a link or a joint."""
    is_part: bool = False
    """Whether another file includes it, or may: then only its expansion shows whether it is a model by itself."""
    is_spare: bool = False
    """Whether it is expanded only if no model turns out to be made of it."""
    is_test_data: bool = False
    """Whether it was found in a folder of tests, and nothing outside such folders starts it, includes it or names it. A launch
    file of the tests may start it."""
    is_kept_aside: bool = False
    """Whether the same is true of it because it is kept and not used."""
    xacro: bool | None = None
    """Whether a launch file hands the file to xacro (True) or to a parser as it is (False); None where none says so."""
    name: str | None = None
    """The configuration's name for the model with these arguments; empty if it names the arguments only."""
    unknown: frozenset[str] = frozenset()
    """Further arguments that the launch files set, to values that are only known at launch."""
    varied: tuple[str, ...] = ()
    """Arguments that are given only to see what they change, and that may be left out."""

    def merge(self, other: ModelTarget) -> ModelTarget:
        """Return what two targets with the same path and arguments are together."""
        return replace(
            self,
            launches=(*self.launches, *(launch for launch in other.launches if launch not in self.launches)),
            explicit=self.explicit or other.explicit,
            tentative=self.tentative and other.tentative,
            is_part=self.is_part and other.is_part,
            is_spare=self.is_spare and other.is_spare,
            is_test_data=self.is_test_data and other.is_test_data,
            is_kept_aside=self.is_kept_aside and other.is_kept_aside,
            # A launch file that hands the file to xacro wins over one that does not, and both over none.
            xacro=True if self.xacro or other.xacro else self.xacro if other.xacro is None else other.xacro,
            name=self.name or other.name,
            unknown=self.unknown & other.unknown,
        )

    @property
    def has_launch_arguments(self) -> bool:
        """Whether a launch file sets the arguments; the arguments of a Python launch file are unknown."""
        return any(launch.suffix != ".py" for launch in self.launches)


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
    """What there is to check."""

    models: tuple[ModelTarget, ...]
    launches: tuple[Path, ...]
    """Launch files that are not checked with a model."""
    packages: tuple[Path, ...]
    candidates: tuple[ModelTarget, ...] = ()
    """Files that other files include: models only if their expansion shows that they are."""
    missing: tuple[tuple[str, str], ...]
    """Paths that do not exist or cannot be checked, each with the reason."""
    unused: tuple[tuple[str, str], ...] = ()
    """Macro files and meshes that the user named and no model uses, each with the reason."""
    left_out: tuple[tuple[str, str], ...] = ()
    """Packages with models in the given folders that build tools are told to leave out, each with the reason."""
    reach: FileReach | None = None
    """Which files may be opened, including the packages of models that launch files lead to."""
    configs: Mapping[str, Any] = field(default_factory=dict)
    """The configuration of each model, launch file and package that has one, by path."""
    swept_launches: frozenset[Path] = frozenset()
    """Launch files in a folder that was given: its models are checked in any case."""
    whole_packages: frozenset[Path] = frozenset()
    """Packages in a folder that was given, which are checked with all their files."""
    kept_aside: frozenset[Path] = frozenset()
    """Those launch files and packages in a folder that was given that are kept and not used."""
    config_errors: tuple[str, ...] = ()
    """Errors in configurations, each text beginning with its place."""
    known_packages: Mapping[str, Sequence[Path]] = field(default_factory=dict)
    """The folders of each package below the given folders, and in the repositories of the given files, by its name."""
    macro_files: tuple[Path, ...] = ()
    """Files in the given folders that define macros."""
