"""From the paths on the command line to the models, launch files and packages to check.

Standard library only: this runs before anything heavy is loaded.
"""

from __future__ import annotations

import contextlib
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from urdfcheck.core.errors import UrdfcheckError
from urdfcheck.core.text import truncate_text
from urdfcheck.source.arguments.missing_paths import explain_missing_path
from urdfcheck.source.folder_index import FolderIndex, FoundModel, explain_unreadable, resolve_path
from urdfcheck.source.model_file import find_placeholder, is_blank, is_foreign_launch
from urdfcheck.source.package.file_kinds import (
    FORMATS_BY_ROOT,
    find_other_format,
    is_buffer,
    is_launch,
    is_mesh,
    is_model,
    is_srdf,
    is_xacro,
    is_yaml,
)
from urdfcheck.source.package.finder import PackageFinder, format_path
from urdfcheck.source.package.gltf_users import find_buffer_users
from urdfcheck.source.package.package_folders import list_left_out_packages
from urdfcheck.source.plan import DiscoveryConfig, ModelTarget, Plan
from urdfcheck.source.planning_budget import PlanningBudget
from urdfcheck.source.reach import OUT_OF_REACH, FileReach, explain_unreachable
from urdfcheck.source.text.xml import Element
from urdfcheck.system.files import is_known_file, read_text_or_nothing

# How much of a placeholder is shown.
_LONGEST_SHOWN = 40


def discover_targets(
    paths: Sequence[Path],
    arguments: Mapping[str, str],
    *,
    packages: Mapping[str, Path],
    package_paths: Sequence[Path],
    reach: FileReach | None = None,
    find_config: Callable[[Path], DiscoveryConfig] | None = None,
    all_arguments: bool = False,
    budget: PlanningBudget | None = None,
) -> Plan:
    """Return everything that the given paths mean, each model once, in a stable order.

    ``reach``: which files may be opened; ``find_config``: returns the configuration for a path, over which the other
    arguments take precedence; ``all_arguments``: expand each xacro with all known values of its arguments
    (:mod:`urdfcheck.source.xacro.argument_values`); ``budget``: the time that it may take. What cannot be looked at in that time
    is listed as missing.
    """
    planner = _Planner(
        arguments=arguments,
        packages=packages,
        package_paths=package_paths,
        reach=reach,
        find_config=find_config,
        all_arguments=all_arguments,
        budget=PlanningBudget() if budget is None else budget,
    )
    planner.index_packages(paths)
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
        budget: PlanningBudget,
    ) -> None:
        self.reach = reach
        self.find_config = find_config
        self.all_arguments = all_arguments
        self.budget = budget
        self.arguments = dict(arguments)
        self.packages = packages
        self.package_paths = package_paths
        self.models: dict[Path, list[ModelTarget]] = {}
        self.launches: dict[Path, Path] = {}
        self.missing: list[tuple[str, str]] = []
        self.config_errors: dict[str, None] = {}
        self.unused: list[tuple[str, str]] = []
        self.left_out: list[tuple[str, str]] = []
        self.folders: dict[Path, FolderIndex] = {}
        self.found: dict[Path, FoundModel] = {}
        self.users: set[Path] = set()
        self.finders: dict[Path, PackageFinder] = {}
        self.given_folders: list[Path] = []
        self.known_packages: dict[str, list[Path]] = {}
        self.macro_files: dict[Path, None] = {}
        self.included_trees: dict[str, Element | None] = {}

    def get_finder(self, start: Path) -> PackageFinder:
        """Return the finder of packages around a file or folder: one for all files of a folder, which searches once."""
        place = start.absolute()
        folder = place if os.path.isdir(place) else place.parent
        finder = self.finders.get(folder)
        if finder is None or finder.reach != self.reach:
            config = self.get_config(start)
            packages = {**config.packages, **self.packages} if config else self.packages
            paths = (*self.package_paths, *config.package_path) if config else self.package_paths
            finder = PackageFinder(folder, packages, paths, reach=self.reach, known=self.known_packages)
            self.finders[folder] = finder
        return finder

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

    def index_packages(self, paths: Sequence[Path]) -> None:
        """Note the packages below the given folders, and in the repositories around all given paths, before one is needed."""
        roots: set[Path] = set()
        for path in sorted(paths, key=lambda path: not os.path.isdir(path)):
            if self.budget.is_used_up():
                break
            # What is wrong with a path is told when it is added.
            with contextlib.suppress(OSError, UrdfcheckError):
                if self.reach is not None and not self.reach.can_open(path):
                    continue
                if path.is_dir():
                    roots.add(self.get_folder(path).path.absolute())  # it notes the packages that it comes across
                finder = self.get_finder(path)
                root = finder.find_repository()
                if root is not None and not roots & {root, *root.parents}:
                    roots.add(root)
                    finder.note_packages(folder for _, folder in finder.walk_repository(root))

    def add_path(self, path: Path) -> None:
        try:
            if self.budget.is_used_up() and resolve_path(path) not in self.folders:
                self.missing.append((format_path(path), self.budget.explain()))
            elif self.reach is not None and not self.reach.can_open(path):
                self.missing.append((str(path), explain_unreachable(path)))
            elif reason := explain_unreadable(path):
                self.missing.append((str(path), reason))
            elif path.is_dir():
                self.add_folder(path)
            elif is_known_file(path):
                self.add_file(path)
            elif path.exists():
                self.missing.append((str(path), "is neither a file nor a folder"))
            else:
                self.missing.append((str(path), explain_missing_path(path)))
        except OSError as error:
            self.missing.append((str(path), error.strerror or str(error)))
        except UrdfcheckError as error:
            self.config_errors[str(error)] = None
            self.missing.append((str(path), f"is not checked, its configuration is wrong: {error}"))

    def is_excluded(self, folder: Path) -> bool:
        """Whether the configuration excludes a folder with all that may be in it."""
        config = self.get_config(folder.parent)
        return config is not None and (config.excludes(folder) or config.excludes(folder / "_"))

    def add_folder(self, path: Path) -> None:
        folder = self.get_folder(path)
        self.given_folders.append(resolve_path(path))
        launches = {launch: read_text_or_nothing(launch) for launch in folder.launches if launch.suffix != ".py"}
        passed_over = {**_find_dead_files(folder, launches), **_find_templates(folder, launches)}
        for found in folder.found_models:
            if found.path not in passed_over:
                is_test_data = folder.is_test_data(found.path)
                is_kept_aside = is_test_data and folder.is_kept_aside(found.path)
                self.add_found_model(found, is_test_data=is_test_data, is_kept_aside=is_kept_aside)
        for candidate in folder.candidates:
            if candidate.path not in passed_over:
                self.add_found_model(candidate, is_spare=True)
        foreign = {launch for launch, text in launches.items() if is_foreign_launch(text)}
        for launch in folder.launches:
            if launch not in passed_over and launch not in foreign and self.is_usable(launch, named=False):
                self.add_launch(launch)
        for model in self.list_configured_models(folder):
            if resolve_path(model) not in self.models:
                self.add_model(ModelTarget(path=model, arguments=self.arguments))
        self.pass_over(passed_over)
        self.unused += [(format_path(link), OUT_OF_REACH) for link in sorted(folder.outside)]
        for marked in sorted(folder.marked):
            for place, mark in list_left_out_packages(marked, folder.finder.can_open):
                if not self.is_excluded(place):
                    self.left_out.append((format_path(place), f"left out because of its {mark}; name it to check it"))
        for place, reason in sorted(folder.unreadable):
            if not self.is_excluded(place):
                self.missing.append((format_path(place), reason))
        macro_files = (path for path, file in folder.files.items() if file.defines_macros)
        self.macro_files.update(dict.fromkeys(path for path in macro_files if self.is_usable(path, named=False)))

    def pass_over(self, files: Mapping[Path, str]) -> None:
        """Say why files of a folder are left out, except for those that a launch file or the configuration names."""
        for path, reason in files.items():
            if resolve_path(path) not in self.models and self.is_usable(path, named=False):
                self.left_out.append((format_path(path), f"left out{reason}; name it to check it"))

    def add_found_model(
        self,
        found: FoundModel,
        *,
        is_spare: bool = False,
        is_test_data: bool = False,
        is_kept_aside: bool = False,
    ) -> None:
        """Add a file that was found in a folder."""
        if self.is_usable(found.path, named=False):
            self.add_model(
                ModelTarget(
                    path=found.path,
                    arguments=self.arguments,
                    tentative=found.is_tentative,
                    is_part=found.is_part,
                    is_spare=is_spare,
                    is_test_data=is_test_data,
                    is_kept_aside=is_kept_aside,
                )
            )

    def add_file(self, path: Path) -> None:
        other = find_other_format(path)
        if is_launch(path) and path.suffix != ".py" and is_foreign_launch(read_text_or_nothing(path)):
            reason = "this is a launch configuration of Eclipse; urdfcheck reads launch files of ROS"
            self.missing.append((format_path(path), reason))
        elif is_launch(path):
            self.add_launch(path)
        elif is_mesh(path):
            self.add_users(path, self.find_mesh_users(path), "no model of its package or repository names this mesh")
        elif is_buffer(path):
            self.add_buffer(path)
        elif path.name == "package.xml":
            self.add_folder(path.parent)
        elif is_yaml(path):
            self.add_yaml(path)
        elif is_srdf(path):
            self.add_srdf(path)
        elif other is not None:
            self.missing.append((format_path(path), f"this is {other}; urdfcheck reads URDF and xacro"))
        elif is_model(path) or path.suffix.lower() in {".xml", ""}:
            self.add_named_model(path)
        else:
            self.add_unknown_file(path)

    def find_mesh_users(self, path: Path) -> list[Path]:
        """Return the models that use a mesh."""
        return self.find_users(path, lambda folder, package: folder.find_models_using(path, package))

    def add_buffer(self, path: Path) -> None:
        """Add the models of the glTF meshes that keep their geometry in a file."""
        finder = self.get_finder(path)
        package = finder.find_package_of(path.absolute())
        top = path.absolute().parent if package is None else package.path
        found = find_buffer_users(path, top, finder)
        meshes = found if path.is_absolute() else [Path(os.path.relpath(mesh)) for mesh in found]
        users = [user for mesh in meshes for user in self.find_mesh_users(mesh)]
        otherwise = "no model of its package or repository names a glTF mesh that keeps its geometry in this file"
        self.add_users(path, users, otherwise)

    def add_unknown_file(self, path: Path) -> None:
        """Add a file whose name says nothing, if it is a robot."""
        file = self.budget.read_file(path)
        root = None if file is None else file.root
        if root is not None and root.tag == "robot":
            self.add_model(ModelTarget(path=path, arguments=self.arguments, explicit=True))
        elif root is not None and root.tag in FORMATS_BY_ROOT:
            known = FORMATS_BY_ROOT[root.tag]
            self.missing.append((format_path(path), f"this is {known}; urdfcheck reads URDF and xacro"))
        else:
            self.missing.append((format_path(path), "is not a model, launch file, mesh, yaml file or folder"))

    def add_srdf(self, path: Path) -> None:
        """Add the models of a semantic description, and the file itself where it is a robot that is called so."""
        file = self.budget.read_file(path)
        if file is None or file.root is None:
            self.missing.append((format_path(path), "is not readable XML, so its robot is not known"))
            return
        users = self.find_users(path, lambda folder, _: folder.find_models_of_srdf(path))
        if file.makes_robot:
            self.add_model(ModelTarget(path=path, arguments=self.arguments, explicit=True))
        elif is_xacro(path) and file.has_parts:
            self.add_model(ModelTarget(path=path, arguments=self.arguments, tentative=True, is_part=True))
        if users or not file.makes_robot:
            self.add_users(path, users, "no model of its package or repository has the name of its robot")

    def add_named_model(self, path: Path) -> None:
        """Add a model or macro file that the user named: the file itself, and the models that include it."""
        file = self.budget.read_file(path)
        if file is None:
            return
        users: list[Path] = []
        is_part = False
        is_whole = file.has_name and file.has_parts and not file.names_links_elsewhere
        if not is_whole or (file.is_xacro and self.has_project_around(path)):
            users = self.find_users(path, lambda folder, _: folder.find_including_models(path))
            is_part = bool(users) or any(folder.may_be_part(path) for folder, _ in self.iter_folders_around(path))
            if not users and file.only_macros:
                users = self.find_users(path, lambda folder, _: folder.find_models_of_srdf(path))
        self.add_each_user(users)
        self.add_model(
            ModelTarget(path=path, arguments=self.arguments, explicit=True, tentative=file.only_macros, is_part=is_part)
        )

    def has_project_around(self, path: Path) -> bool:
        """Whether a file belongs to a package or a repository: then its users are known, and few enough to check."""
        is_packaged = self.get_finder(path).find_package_of(path.absolute()) is not None
        return is_packaged or any((folder / ".git").exists() for folder in path.absolute().parents)

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
        self.add_each_user(users)
        if not users:
            self.unused.append((format_path(path), otherwise))

    def add_each_user(self, users: Sequence[Path]) -> None:
        """Add the models that use a file; most are those of the file before."""
        for user in users:
            if user not in self.users:
                self.users.add(user)
                self.add_found_model(self.found.get(user, FoundModel(path=user)))

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
            arguments = {**entry.arguments, **self.arguments}
            self.add_target(replace(target, arguments=arguments, name=name, is_test_data=False, is_kept_aside=False))
        if not entries:
            self.add_target(target)

    def add_target(self, target: ModelTarget) -> None:
        targets = self.models.setdefault(resolve_path(target.path), [])
        for index, other in enumerate(targets):
            if dict(other.arguments) == dict(target.arguments):
                targets[index] = other.merge(target)
                return
        targets.append(target)

    def add_launch(self, path: Path) -> None:
        if resolve_path(path) in self.launches or not self.is_usable(path):
            return
        self.launches[resolve_path(path)] = path
        # Most runs meet none, and each start would pay for these modules.
        from urdfcheck.source.launch.launch_file import load_launch
        from urdfcheck.source.launch.python_launch_file import read_python_launch

        finder = self.get_finder(path)
        if path.suffix == ".py":
            launch = self.budget.look_at(path, lambda: read_python_launch(path, finder))
            if launch is None:
                return
            # Only at launch is it known which of several models starts.
            is_only = len(launch.models) == 1
            for model in filter(self.may_be_robot, launch.models):
                self.extend_reach(model, finder)
                self.add_model(
                    ModelTarget(
                        path=model,
                        arguments=self.arguments,
                        launches=(path,) if is_only else (),
                        is_part=self.is_nameless_part(model),
                        is_test_data=self.is_data_of_test(model, path),
                        is_kept_aside=self.is_started_unused(model, path),
                        xacro=True if is_only and launch.runs_xacro else None,
                    )
                )
            return
        loaded = self.budget.look_at(path, lambda: load_launch(path, finder))
        for description in () if loaded is None else loaded.descriptions:
            if description.path is not None:
                model = Path(os.path.relpath(description.path)) if not path.is_absolute() else description.path
                self.extend_reach(model, finder)
                self.add_model(
                    ModelTarget(
                        path=model,
                        arguments={**description.arguments, **self.arguments},
                        launches=(path,),
                        is_test_data=self.is_data_of_test(model, path),
                        is_kept_aside=self.is_started_unused(model, path),
                        unknown=description.unknown_arguments - self.arguments.keys(),
                        xacro=description.uses_xacro,
                    )
                )

    def is_data_of_test(self, path: Path, launch: Path) -> bool:
        """Whether a launch file of tests starts a model which only tests read, in one of the given folders; or neither the launch
        file nor the model is used."""
        is_of_test = any(folder.is_data_of_test(path, launch) for folder in self.iter_given_folders())
        return is_of_test or self.is_started_unused(path, launch)

    def is_started_unused(self, path: Path, launch: Path) -> bool:
        """Whether a model and the launch file that starts it are kept and not used, in a folder for such or in such a package."""
        is_aside = any(folder.is_started_aside(path, launch) for folder in self.iter_given_folders())
        return is_aside or self.is_in_unused_package(path, launch)

    def is_in_unused_package(self, *paths: Path) -> bool:
        """Whether files are in packages that are kept and not used. One that is given by its own path is used."""
        folders = list(self.iter_given_folders())
        around = ([f for f in folders if f.path.absolute() in path.absolute().parents] for path in paths)
        return all(
            given and all(folder.is_in_unused_package(path) for folder in given)
            for path, given in zip(paths, around, strict=True)
        )

    def iter_given_folders(self) -> Iterator[FolderIndex]:
        return (self.folders[folder] for folder in self.given_folders if folder in self.folders)

    def may_be_robot(self, path: Path) -> bool:
        """Whether what a launch file names as a model is not a semantic description, which xacro may also make."""
        file = self.budget.read_file(path) if is_srdf(path) else None
        return file is None or file.makes_robot

    def is_nameless_part(self, path: Path) -> bool:
        """Whether what a launch file names has no robot's name, and another file includes it, or may: it may be the default of
        an argument by which a robot includes more."""
        file = self.budget.read_file(path)
        if file is None or file.has_name:
            return False
        return any(folder.may_be_part(path) for folder, _ in self.iter_folders_around(path))

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
            folder = self.folders[key] = FolderIndex(path, self.get_finder(path), self.budget.read_file)
            self.found.update((found.path, found) for found in folder.found_models)
        return self.folders[key]

    def iter_folders_around(self, path: Path) -> Iterator[tuple[FolderIndex, str]]:
        """Yield a file's package (or folder), then the repository around it.

        With each comes the name by which other packages reach the file's package; empty within the package.
        """
        own_package = self.get_finder(path).find_package_of(path.absolute())
        inner = path.absolute().parent if own_package is None else own_package.path
        outer = next((f for f in inner.parents if (f / ".git").exists()), None)
        for folder, package in ((inner, ""), (outer, "" if own_package is None else own_package.name)):
            if folder is not None:
                yield self.get_folder(folder if path.is_absolute() else Path(os.path.relpath(folder))), package

    def find_users(self, path: Path, find: Callable[[FolderIndex, str], list[Path]]) -> list[Path]:
        """Return the models that use a file: those of its package (or folder), else those of the repository around it."""
        return next(
            (users for folder, package in self.iter_folders_around(path) if (users := find(folder, package))), []
        )

    def build_variants(self, targets: Sequence[ModelTarget]) -> list[ModelTarget]:
        """Return a file with the sets of arguments that none of its targets has yet."""
        first = targets[0]
        if not self.all_arguments or not (is_xacro(first.path) or any(t.xacro for t in targets)):
            return []
        from urdfcheck.source.xacro.argument_values import MOST_ARGUMENTS, build_argument_sets, find_argument_choices

        finder = self.get_finder(first.path)
        choices = (
            self.budget.look_at(first.path, lambda: find_argument_choices(first.path, finder, self.included_trees))
            or ()
        )
        free = [choice for choice in choices if choice.name not in self.arguments]
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
                unknown=frozenset(),
                varied=tuple(name for name in given if name in varied),
            )
            for given in build_argument_sets(free[:MOST_ARGUMENTS])
        ]
        defaults = {c.name: c.default for c in free}
        checked = [{name: value for name, value in t.arguments.items() if value != defaults.get(name)} for t in targets]
        return [target for target in variants if target.arguments not in checked]

    def build_plan(self) -> Plan:
        """Return what was added, in a stable order."""
        targets = _assign_launches(self.list_targets())
        # What only defines macros where it was named is expanded all the same: the text does not decide what it is.
        candidates = [target for target in targets if target.is_part or (target.tentative and target.explicit)]
        models = [target for target in targets if target not in candidates]
        launched = {resolve_path(launch) for target in targets for launch in target.launches}
        launches = [path for real, path in self.launches.items() if real not in launched]
        packages = self.list_packages([*(target.path for target in models), *self.launches.values()])
        checked = (*(target.path for target in targets), *launches, *packages)
        return Plan(
            models=tuple(models),
            candidates=tuple(candidates),
            launches=tuple(sorted(launches)),
            packages=tuple(sorted(packages)),
            missing=(*self.missing, *self.budget.unread),
            unused=tuple(self.unused),
            left_out=tuple(self.left_out),
            reach=self.reach,
            configs={str(path): config for path in checked if (config := self.get_config(path)) is not None},
            swept_launches=frozenset(filter(self.is_in_given_folder, launches)),
            whole_packages=frozenset(filter(self.is_in_given_folder, packages)),
            kept_aside=frozenset(
                [launch for launch in launches if self.is_in_unused_package(launch)]
                + [package for package in packages if self.is_in_unused_package(package / "package.xml")]
            ),
            config_errors=tuple(self.config_errors),
            known_packages=self.sort_known_packages(packages),
            macro_files=tuple(self.macro_files),
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
            package = self.get_finder(path).find_package_of(path.absolute())
            if package is not None:
                packages[package.path] = None
        return list(packages)

    def sort_known_packages(self, checked: Sequence[Path]) -> dict[str, list[Path]]:
        """Return the known packages by name, of each name those first that are checked."""
        return {
            name: sorted(folders, key=lambda folder: (folder not in checked, folder))
            for name, folders in sorted(self.known_packages.items())
        }

    def is_in_given_folder(self, path: Path) -> bool:
        """Whether a path is one of the given folders, or below one."""
        real = resolve_path(path)
        return any(folder in (real, *real.parents) for folder in self.given_folders)


def _find_dead_files(folder: FolderIndex, launches: Mapping[Path, str]) -> dict[Path, str]:
    """Return the models and the launch files (``launches``: texts by path) of packages in a folder that hold nothing and that no
    file there names, each with the reason to leave it out."""
    blank = [path for path, file in folder.files.items() if file.is_blank]
    blank += [path for path, text in launches.items() if is_blank(text)]
    return {
        path: f", because {'all of it is in a comment' if text.strip() else 'it is empty'} and no file names it"
        for path, text in ((path, read_text_or_nothing(path)) for path in blank)
        if folder.finder.find_package_of(path.absolute()) is not None and not folder.is_named(path)
    }


def _find_templates(folder: FolderIndex, launches: Mapping[Path, str]) -> dict[Path, str]:
    """Return the models and the launch files (``launches``) of a folder that a generator fills in.

    Each comes with the reason to leave it out, which shows its first placeholder.
    """
    templates = {path: file.placeholder for path, file in folder.files.items() if file.placeholder}
    templates |= {path: placeholder for path, text in launches.items() if (placeholder := find_placeholder(text))}
    return {
        path: f" as a template, in which {truncate_text(placeholder, _LONGEST_SHOWN)} is filled in"
        for path, placeholder in templates.items()
    }


def _assign_launches(targets: Sequence[ModelTarget]) -> list[ModelTarget]:
    """Return the targets with each launch file at one of them: one that loads two robots is checked with the first."""
    assigned: set[Path] = set()
    models: list[ModelTarget] = []
    for target in targets:
        launches = tuple(launch for launch in target.launches if resolve_path(launch) not in assigned)
        models.append(replace(target, launches=launches))
        assigned |= {resolve_path(launch) for launch in launches}
    return models
