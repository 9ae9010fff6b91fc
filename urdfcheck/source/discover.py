"""From the paths on the command line to the models, launch files and packages to check.

Standard library only: this runs before anything heavy is loaded.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Protocol

from urdfcheck.core.errors import UrdfcheckError
from urdfcheck.source.folder_index import FolderIndex, ModelFile, resolve_path
from urdfcheck.source.launch.launch_file import load_launch
from urdfcheck.source.launch.python_launch_file import read_python_launch
from urdfcheck.source.package.file_kinds import MESH_SUFFIXES, is_launch, is_srdf
from urdfcheck.source.package.finder import PackageFinder, format_path
from urdfcheck.source.reach import OUT_OF_REACH, FileReach
from urdfcheck.system.files import is_known_file


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
    """Whether only its expansion shows that the file is a model."""
    xacro: bool = False
    """Whether a launch file hands the file to xacro, whatever its suffix."""
    name: str | None = None
    """The configuration's name for the model with these arguments; empty if it names the arguments only."""
    varied: tuple[str, ...] = ()
    """Arguments that are given only to see what they change, and that may be left out."""

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
    missing: tuple[tuple[str, str], ...]
    """Paths that do not exist or cannot be checked, each with the reason."""
    unused: tuple[tuple[str, str], ...] = ()
    """Macro files and meshes that the user named and no model uses, each with the reason."""
    reach: FileReach | None = None
    """Which files may be opened, including the packages of models that launch files lead to."""
    configs: Mapping[str, Any] = field(default_factory=dict)
    """The configuration of each model, launch file and package that has one, by path."""
    whole_packages: frozenset[Path] = frozenset()
    """Packages in a folder that was given, which are checked with all their files."""
    config_errors: tuple[str, ...] = ()
    """Errors in configurations, each text beginning with its place."""


def discover_targets(
    paths: Sequence[Path],
    arguments: Mapping[str, str],
    *,
    packages: Mapping[str, Path],
    package_paths: Sequence[Path],
    reach: FileReach | None = None,
    find_config: Callable[[Path], DiscoveryConfig] | None = None,
    all_arguments: bool = False,
) -> Plan:
    """Return everything that the given paths mean, each model once, in a stable order.

    ``reach``: which files may be opened; ``find_config``: returns the configuration for a path, over which the other
    arguments take precedence; ``all_arguments``: expand each xacro with all known values of its arguments
    (:mod:`urdfcheck.source.xacro.argument_values`).
    """
    planner = _Planner(
        arguments=arguments,
        packages=packages,
        package_paths=package_paths,
        reach=reach,
        find_config=find_config,
        all_arguments=all_arguments,
    )
    for path in paths:
        planner.add_path(path)
    return planner.build_plan()


class _Planner:
    """Collects models, launch files and packages from the given paths."""

    def __init__(
        self,
        *,
        arguments: Mapping[str, str],
        packages: Mapping[str, Path],
        package_paths: Sequence[Path],
        reach: FileReach | None,
        find_config: Callable[[Path], DiscoveryConfig] | None,
        all_arguments: bool,
    ) -> None:
        self.reach = reach
        self.find_config = find_config
        self.all_arguments = all_arguments
        self.arguments = dict(arguments)
        self.packages = packages
        self.package_paths = package_paths
        self.models: dict[Path, list[ModelTarget]] = {}
        self.launches: dict[Path, Path] = {}
        self.missing: list[tuple[str, str]] = []
        self.config_errors: dict[str, None] = {}
        self.unused: list[tuple[str, str]] = []
        self.folders: dict[Path, FolderIndex] = {}
        self.given_folders: list[Path] = []

    def make_finder(self, start: Path) -> PackageFinder:
        config = self.get_config(start)
        packages = {**config.packages, **self.packages} if config else self.packages
        paths = (*self.package_paths, *config.package_path) if config else self.package_paths
        return PackageFinder(start.absolute(), packages, paths, reach=self.reach)

    def get_config(self, path: Path) -> DiscoveryConfig | None:
        """Return the configuration for a path; None around a file that may not be opened.

        :raises UrdfcheckError: if the configuration is invalid.
        """
        if self.find_config is None or (self.reach is not None and not self.reach.can_open(path)):
            return None
        return self.find_config(path)

    def is_usable(self, path: Path, *, named: bool = True) -> bool:
        """Whether the configuration for a path is valid and does not exclude it, which it cannot do if the user ``named`` it."""
        try:
            config = self.get_config(path)
        except UrdfcheckError as error:
            if str(error) not in self.config_errors:
                self.config_errors[str(error)] = None
                self.missing.append((format_path(path), f"is not checked, its configuration is wrong: {error}"))
            return False
        return named or config is None or not config.excludes(path)

    def add_path(self, path: Path) -> None:
        try:
            if self.reach is not None and not self.reach.can_open(path):
                self.missing.append((str(path), OUT_OF_REACH))
            elif path.is_dir():
                self.add_folder(path)
            elif is_known_file(path):
                self.add_file(path)
            elif path.exists():
                self.missing.append((str(path), "is neither a file nor a folder"))
            else:
                self.missing.append((str(path), "does not exist"))
        except OSError as error:
            self.missing.append((str(path), error.strerror or str(error)))
        except UrdfcheckError as error:
            self.config_errors[str(error)] = None
            self.missing.append((str(path), f"is not checked, its configuration is wrong: {error}"))

    def add_folder(self, path: Path) -> None:
        folder = self.get_folder(path)
        self.given_folders.append(resolve_path(path))
        for model, tentative in folder.find_models():
            if self.is_usable(model, named=False):
                self.add_model(ModelTarget(path=model, arguments=self.arguments, tentative=tentative))
        for launch in folder.launches:
            if self.is_usable(launch, named=False):
                self.add_launch(launch)
        for model in self.list_configured_models(folder):
            if resolve_path(model) not in self.models:
                self.add_model(ModelTarget(path=model, arguments=self.arguments))
        self.unused += [(format_path(link), OUT_OF_REACH) for link in sorted(folder.outside)]

    def add_file(self, path: Path) -> None:
        if is_launch(path):
            self.add_launch(path)
        elif path.suffix.lower() in MESH_SUFFIXES:
            users = self.find_users(path, lambda folder, package: folder.find_models_using(path, package))
            self.add_users(path, users, "no model of its package or repository names this mesh")
        elif path.name == "package.xml":
            self.add_folder(path.parent)
        elif path.suffix.lower() in {".yaml", ".yml"}:
            self.add_yaml(path)
        elif is_srdf(path) and ModelFile(path).root is None:
            self.missing.append((str(path), "is no XML that can be read, so that nobody knows whose it is"))
        elif is_srdf(path):
            users = self.find_users(path, lambda folder, _: folder.find_models_by_robot_name(path))
            self.add_users(path, users, "no model of its package or repository has the name of its robot")
        elif path.suffix == ".xacro" and not (file := ModelFile(path)).stands_alone:
            users = self.find_users(path, lambda folder, _: folder.find_including_models(path))
            if users or file.only_macros:
                self.add_users(
                    path, users, "only defines macros, and no model of its package or repository includes it"
                )
            else:
                self.add_model(ModelTarget(path=path, arguments=self.arguments, explicit=True))
        elif path.suffix in {".urdf", ".xacro", ".xml", ""}:
            self.add_model(ModelTarget(path=path, arguments=self.arguments, explicit=True))
        else:
            self.missing.append((str(path), "is no model, launch file, mesh, yaml file or folder"))

    def add_yaml(self, path: Path) -> None:
        """Add the users of a yaml file (controllers, joint limits, a file that a xacro loads).

        These are the models and launch files that name it, and the models of a semantic description beside it; if there are
        none, the models of its package, with which its controllers are compared.
        """
        users = [
            *self.find_users(path, lambda folder, _: folder.find_models_of_srdf_beside(path)),
            *self.find_users(
                path,
                lambda folder, package: [
                    *folder.find_models_using(path, package),
                    *folder.find_launches_loading(path, package),
                ],
            ),
        ] or self.find_users(path, lambda folder, _: folder.find_models_configured_by(path))
        for launch in filter(is_launch, users):
            self.add_launch(launch)
        models = [user for user in users if not is_launch(user)]
        if models or not users:
            self.add_users(path, models, "no model and no launch file of its package or repository reads this file")

    def list_configured_models(self, folder: FolderIndex) -> list[Path]:
        """Return the files of a folder that the configurations in it name as models."""
        configs = {id(c): c for f in folder.files if self.is_usable(f) and (c := self.get_config(f)) is not None}
        by_real = {resolve_path(f): f for f in folder.files}
        named = (resolve_path(model.path) for config in configs.values() for model in config.models)
        return [by_real[real] for real in named if real in by_real]

    def add_users(self, path: Path, users: Sequence[Path], otherwise: str) -> None:
        for user in users:
            if self.is_usable(user, named=False):
                self.add_model(ModelTarget(path=user, arguments=self.arguments))
        if not users:
            self.unused.append((format_path(path), otherwise))

    def add_model(self, target: ModelTarget) -> None:
        """Add a model; if the configuration names it, once for each of the configured sets of arguments."""
        if not self.is_usable(target.path):
            return
        config = self.get_config(target.path)
        real = resolve_path(target.path)
        configured = () if config is None or target.has_launch_arguments else config.models
        entries = [model for model in configured if resolve_path(model.path) == real]
        for entry in entries:
            name = "" if self.arguments else entry.name or ""  # with other arguments it is another model
            self.add_target(replace(target, arguments={**entry.arguments, **self.arguments}, name=name))
        if not entries:
            self.add_target(target)

    def add_target(self, target: ModelTarget) -> None:
        targets = self.models.setdefault(resolve_path(target.path), [])
        for index, other in enumerate(targets):
            if dict(other.arguments) == dict(target.arguments):
                targets[index] = replace(
                    other,
                    launches=(*other.launches, *(x for x in target.launches if x not in other.launches)),
                    explicit=other.explicit or target.explicit,
                    tentative=other.tentative and target.tentative,
                    xacro=other.xacro or target.xacro,
                    name=other.name or target.name,
                )
                return
        targets.append(target)

    def add_launch(self, path: Path) -> None:
        if resolve_path(path) in self.launches or not self.is_usable(path):
            return
        self.launches[resolve_path(path)] = path
        finder = self.make_finder(path)
        if path.suffix == ".py":
            models = read_python_launch(path, finder).models
            for model in models:
                self.extend_reach(model, finder)
                # Only at launch is it known which of several models starts.
                self.add_model(
                    ModelTarget(path=model, arguments=self.arguments, launches=(path,) if len(models) == 1 else ())
                )
            return
        for description in load_launch(path, finder).descriptions:
            if description.path is not None:
                model = Path(os.path.relpath(description.path)) if not path.is_absolute() else description.path
                self.extend_reach(model, finder)
                self.add_model(
                    ModelTarget(
                        path=model,
                        arguments={**description.arguments, **self.arguments},
                        launches=(path,),
                        xacro=description.uses_xacro,
                    )
                )

    def extend_reach(self, model: Path, finder: PackageFinder) -> None:
        """Bring the package of a model that a launch file leads to into reach: it is checked like any other."""
        if self.reach is None or self.reach.can_open(model):
            return
        folder = finder.find_known_folder(model)
        if folder is not None:
            self.reach = FileReach((*self.reach.roots, str(folder)))

    def get_folder(self, path: Path) -> FolderIndex:
        key = resolve_path(path)
        if key not in self.folders:
            self.folders[key] = FolderIndex(path, self.make_finder(path))
        return self.folders[key]

    def find_users(self, path: Path, find: Callable[[FolderIndex, str], list[Path]]) -> list[Path]:
        """Return the models that use a file: those of its package (or folder), else those of the repository around it.

        ``find`` also gets the name by which other packages reach the file's package; empty within the package.
        """
        own_package = self.make_finder(path).find_package_of(path.absolute())
        inner = path.absolute().parent if own_package is None else own_package.path
        outer = next((f for f in inner.parents if (f / ".git").exists()), None)
        for folder, package in ((inner, ""), (outer, "" if own_package is None else own_package.name)):
            if folder is None:
                continue
            users = find(self.get_folder(folder if path.is_absolute() else Path(os.path.relpath(folder))), package)
            if users:
                return users
        return []

    def build_variants(self, targets: Sequence[ModelTarget]) -> list[ModelTarget]:
        """Return a file with the sets of arguments that none of its targets has yet."""
        first = targets[0]
        if not self.all_arguments or not (first.path.suffix == ".xacro" or any(t.xacro for t in targets)):
            return []
        from urdfcheck.source.xacro.argument_values import MOST_ARGUMENTS, build_argument_sets, find_argument_choices

        free = [
            c for c in find_argument_choices(first.path, self.make_finder(first.path)) if c.name not in self.arguments
        ]
        if len(free) > MOST_ARGUMENTS:
            reason = f"has {len(free)} arguments to vary: the first {MOST_ARGUMENTS} of them are"
            self.unused.append((format_path(first.path), reason))
        varied = {c.name for c in free if c.default is not None}
        # Arguments from the configuration that do not vary: the file may not be a model without them.
        configured = next((t.arguments for t in targets if not t.has_launch_arguments), {})
        given_anyway = {name: value for name, value in configured.items() if name not in {c.name for c in free}}
        variants = [
            replace(
                first,
                arguments={**given_anyway, **self.arguments, **given},
                launches=(),
                name=None,
                varied=tuple(name for name in given if name in varied),
            )
            for given in build_argument_sets(free[:MOST_ARGUMENTS])
        ]
        defaults = {c.name: c.default for c in free}
        checked = [{name: value for name, value in t.arguments.items() if value != defaults.get(name)} for t in targets]
        return [target for target in variants if target.arguments not in checked]

    def build_plan(self) -> Plan:
        """Return what was added, in a stable order."""
        models = _assign_launches(self.list_targets())
        launched = {resolve_path(launch) for target in models for launch in target.launches}
        launches = [path for real, path in self.launches.items() if real not in launched]
        packages = self.list_packages([*(target.path for target in models), *self.launches.values()])
        checked = (*(target.path for target in models), *launches, *packages)
        return Plan(
            models=tuple(models),
            launches=tuple(sorted(launches)),
            packages=tuple(sorted(packages)),
            missing=tuple(self.missing),
            unused=tuple(self.unused),
            reach=self.reach,
            configs={str(path): config for path in checked if (config := self.get_config(path)) is not None},
            whole_packages=frozenset(filter(self.is_in_given_folder, packages)),
            config_errors=tuple(self.config_errors),
        )

    def list_targets(self) -> list[ModelTarget]:
        """Return each model with every set of arguments that it is checked with."""
        models: list[ModelTarget] = []
        for targets in self.models.values():
            # A launch file sets the arguments that the model is used with: the bare model adds nothing.
            launched = [t for t in targets if t.has_launch_arguments]
            bare = [
                t for t in targets if not t.has_launch_arguments and (t.explicit or t.name is not None or not launched)
            ]
            models += [*bare, *launched, *self.build_variants(targets)]
        return sorted(models, key=lambda t: (format_path(t.path), sorted(t.arguments.items())))

    def list_packages(self, paths: Sequence[Path]) -> list[Path]:
        """Return the folders of the packages that these files belong to, each once."""
        packages: dict[Path, None] = {}
        for path in paths:
            package = self.make_finder(path).find_package_of(path.absolute())
            if package is not None:
                packages[package.path] = None
        return list(packages)

    def is_in_given_folder(self, path: Path) -> bool:
        """Whether a path is one of the given folders, or below one."""
        real = resolve_path(path)
        return any(folder in (real, *real.parents) for folder in self.given_folders)


def _assign_launches(targets: Sequence[ModelTarget]) -> list[ModelTarget]:
    """Return the targets with each launch file at one of them: one that loads two robots is checked with the first."""
    assigned: set[Path] = set()
    models: list[ModelTarget] = []
    for target in targets:
        launches = tuple(launch for launch in target.launches if resolve_path(launch) not in assigned)
        models.append(replace(target, launches=launches))
        assigned |= {resolve_path(launch) for launch in launches}
    return models
