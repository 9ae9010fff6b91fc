"""From the paths on the command line to the models, launch files and packages that are to be checked.

Standard library only: this runs before anything heavy is loaded.
"""

from __future__ import annotations

import fnmatch
import glob
import os
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Protocol

from urdfcheck.core.errors import UrdfcheckError
from urdfcheck.source.launch.launch_file import Launch, load_launch
from urdfcheck.source.launch.python_launch_file import read_python_launch
from urdfcheck.source.package.finder import BUILD_FOLDERS, PackageFinder, format_path
from urdfcheck.source.reach import OUT_OF_REACH, FileReach
from urdfcheck.source.text.xml import Element, SourceFile, XmlError, find_unbound_prefix, parse_xml
from urdfcheck.system.files import read_regular

MESH_SUFFIXES = frozenset({".stl", ".dae", ".obj", ".ply", ".off", ".glb", ".gltf"})
# Where a package keeps its configurations.
CONFIG_FOLDERS = ("config", "params", "controllers", "control", "launch")
# Includes of one file that are looked for, and names of files that are compared with their patterns: beyond that a file counts
# as included by none, and is checked as a model of its own. Of a hundred robots no file has more than 40 includes.
MAX_INCLUDES = 2_000
MAX_COMPARED = 500_000
_SKIPPED = BUILD_FOLDERS | {"node_modules", "__pycache__"}
_INCLUDE = re.compile(r"""<xacro:include\s[^<>]*?filename\s*=\s*["']([^"']+)["']""")
_EXPRESSION = re.compile(r"\$[({][^)}$]*[)}]")
_ROBOT = re.compile(r"<robot[\s>]")
_BUILTINS = frozenset(
    f"xacro:{name}" for name in ("macro", "property", "include", "arg", "if", "unless", "insert_block", "attribute")
)


class ConfiguredModel(Protocol):
    """A model that a configuration names, with its arguments."""

    @property
    def path(self) -> Path: ...
    @property
    def name(self) -> str | None: ...
    @property
    def arguments(self) -> Mapping[str, str]: ...


class DiscoveryConfig(Protocol):
    """What a configuration says about where things are."""

    @property
    def packages(self) -> Mapping[str, Path]: ...
    @property
    def package_path(self) -> Sequence[Path]: ...
    @property
    def models(self) -> Sequence[ConfiguredModel]: ...
    def excludes(self, path: Path) -> bool: ...


@dataclass(frozen=True, slots=True)
class ModelTarget:
    """A model to check. ``explicit``: the user named the file; ``tentative``: only its expansion shows whether it is one;
    ``xacro``: a launch file hands it to xacro, whatever its name; ``name``: what the configuration calls it with these
    arguments, empty where it names the arguments only; ``varied``: the arguments that are given to see what they change, and that
    may be left out."""

    path: Path
    arguments: Mapping[str, str] = field(default_factory=dict)
    launches: tuple[Path, ...] = ()
    explicit: bool = False
    tentative: bool = False
    xacro: bool = False
    name: str | None = None
    varied: tuple[str, ...] = ()

    @property
    def has_launch_arguments(self) -> bool:
        """Whether a launch file says with which arguments; one in Python does not."""
        return any(launch.suffix != ".py" for launch in self.launches)


@dataclass(frozen=True, slots=True)
class Plan:
    """What there is to check. ``missing``: paths that do not exist or are nothing that can be checked, with the reason;
    ``unused``: macro files and meshes that were named but that no model uses; ``reach``: what may be opened, the packages of
    the models that launch files lead to included; ``configured``: the configuration of each model, launch file and package that
    has one, by its path; ``whole``: the packages that lie in a folder that was given, with all their files; ``wrong``: what is
    wrong with configurations, each text beginning with its place."""

    models: tuple[ModelTarget, ...]
    launches: tuple[Path, ...]
    packages: tuple[Path, ...]
    missing: tuple[tuple[str, str], ...]
    unused: tuple[tuple[str, str], ...] = ()
    reach: FileReach | None = None
    configs: Mapping[str, Any] = field(default_factory=dict)
    whole_packages: frozenset[Path] = frozenset()
    config_errors: tuple[str, ...] = ()


def discover_targets(
    paths: Sequence[Path],
    arguments: Mapping[str, str],
    packages: Mapping[str, Path],
    package_paths: Sequence[Path],
    reach: FileReach | None = None,
    find_config: Callable[[Path], DiscoveryConfig] | None = None,
    all_arguments: bool = False,
) -> Plan:
    """Everything that the given paths mean, each model once, in a stable order. ``reach``: which files may be opened;
    ``configured`` finds the configuration for a path, which the other arguments win over; ``all_arguments``: each xacro with all
    values of its arguments that are known (:mod:`urdfcheck.source.xacro.argument_values`)."""
    planner = _Planner(arguments, packages, package_paths, reach, find_config, all_arguments)
    for path in paths:
        planner.add_path(path)
    return planner.build_plan()


class _Planner:
    def __init__(
        self,
        arguments: Mapping[str, str],
        packages: Mapping[str, Path],
        package_paths: Sequence[Path],
        reach: FileReach | None,
        configured: Callable[[Path], DiscoveryConfig] | None,
        all_arguments: bool,
    ) -> None:
        self.reach = reach
        self.configured = configured
        self.all_arguments = all_arguments
        self.arguments = dict(arguments)
        self.packages = packages
        self.package_paths = package_paths
        self.models: dict[Path, list[ModelTarget]] = {}
        self.launches: dict[Path, Path] = {}
        self.missing: list[tuple[str, str]] = []
        self.wrong: dict[str, None] = {}
        self.unused: list[tuple[str, str]] = []
        self.folders: dict[Path, _FolderIndex] = {}
        self.given: list[Path] = []

    def make_finder(self, start: Path) -> PackageFinder:
        local = self.get_config(start)
        packages = {**local.packages, **self.packages} if local else self.packages
        paths = (*self.package_paths, *local.package_path) if local else self.package_paths
        return PackageFinder(start.absolute(), packages, paths, reach=self.reach)

    def get_config(self, path: Path) -> DiscoveryConfig | None:
        """The configuration for a path; none is looked for around a file that may not be opened.

        :raises UrdfcheckError: when it is wrong.
        """
        if self.configured is None or (self.reach is not None and not self.reach.can_open(path)):
            return None
        return self.configured(path)

    def is_usable(self, path: Path, *, named: bool = True) -> bool:
        """Whether the configuration for a path is right, and wants it to be checked unless the user ``named`` it."""
        try:
            local = self.get_config(path)
        except UrdfcheckError as error:
            if str(error) not in self.wrong:
                self.wrong[str(error)] = None
                self.missing.append((format_path(path), f"is not checked, its configuration is wrong: {error}"))
            return False
        return named or local is None or not local.excludes(path)

    def add_path(self, path: Path) -> None:
        try:
            if self.reach is not None and not self.reach.can_open(path):
                self.missing.append((str(path), OUT_OF_REACH))
            elif path.is_dir():
                self.add_folder(path)
            elif path.is_file():
                self.add_file(path)
            elif path.exists():
                self.missing.append((str(path), "is neither a file nor a folder"))
            else:
                self.missing.append((str(path), "does not exist"))
        except OSError as error:
            self.missing.append((str(path), error.strerror or str(error)))
        except UrdfcheckError as error:
            self.wrong[str(error)] = None
            self.missing.append((str(path), f"is not checked, its configuration is wrong: {error}"))

    def add_folder(self, path: Path) -> None:
        folder = self.get_folder(path)
        self.given.append(_resolve_path(path))
        for model, tentative in folder.find_models():
            if self.is_usable(model, named=False):
                self.add_model(ModelTarget(model, self.arguments, tentative=tentative))
        for launch in folder.launches:
            if self.is_usable(launch, named=False):
                self.add_launch(launch)
        for named in self.list_configured_models(folder):
            if _resolve_path(named) not in self.models:
                self.add_model(ModelTarget(named, self.arguments))
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
        elif is_srdf(path) and _ModelFile(path).root is None:
            self.missing.append((str(path), "is no XML that can be read, so that nobody knows whose it is"))
        elif is_srdf(path):
            users = self.find_users(path, lambda folder, _: folder.find_models_by_robot_name(path))
            self.add_users(path, users, "no model of its package or repository has the name of its robot")
        elif path.suffix == ".xacro" and not (file := _ModelFile(path)).stands_alone:
            users = self.find_users(path, lambda folder, _: folder.find_including_models(path))
            if users or file.only_macros:
                self.add_users(
                    path, users, "only defines macros, and no model of its package or repository includes it"
                )
            else:
                self.add_model(ModelTarget(path, self.arguments, explicit=True))
        elif path.suffix in {".urdf", ".xacro", ".xml", ""}:
            self.add_model(ModelTarget(path, self.arguments, explicit=True))
        else:
            self.missing.append((str(path), "is no model, launch file, mesh, yaml file or folder"))

    def add_yaml(self, path: Path) -> None:
        """A yaml file (controllers, joint limits, what a xacro loads): who names it, and the models that a semantic description
        beside it is about; else the models of its package, with which its controllers are compared."""
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

    def list_configured_models(self, folder: _FolderIndex) -> list[Path]:
        """The files in a folder that the configurations for its files call models."""
        locals_ = {id(c): c for f in folder.files if self.is_usable(f) and (c := self.get_config(f)) is not None}
        mine = {_resolve_path(f): f for f in folder.files}
        return [mine[real] for c in locals_.values() for m in c.models if (real := _resolve_path(m.path)) in mine]

    def add_users(self, path: Path, users: Sequence[Path], otherwise: str) -> None:
        for user in users:
            if self.is_usable(user, named=False):
                self.add_model(ModelTarget(user, self.arguments))
        if not users:
            self.unused.append((format_path(path), otherwise))

    def add_model(self, target: ModelTarget) -> None:
        """A model; for one that the configuration names, with the arguments that this says."""
        if not self.is_usable(target.path):
            return
        local = self.get_config(target.path)
        real = _resolve_path(target.path)
        entries = (
            [m for m in local.models if _resolve_path(m.path) == real]
            if local and not target.has_launch_arguments
            else []
        )
        for entry in entries:
            name = "" if self.arguments else entry.name or ""  # with other arguments it is another model
            self.add_target(replace(target, arguments={**entry.arguments, **self.arguments}, name=name))
        if not entries:
            self.add_target(target)

    def add_target(self, target: ModelTarget) -> None:
        known = self.models.setdefault(_resolve_path(target.path), [])
        for index, other in enumerate(known):
            if dict(other.arguments) == dict(target.arguments):
                known[index] = replace(
                    other,
                    launches=(*other.launches, *(x for x in target.launches if x not in other.launches)),
                    explicit=other.explicit or target.explicit,
                    tentative=other.tentative and target.tentative,
                    xacro=other.xacro or target.xacro,
                    name=other.name or target.name,
                )
                return
        known.append(target)

    def add_launch(self, path: Path) -> None:
        if _resolve_path(path) in self.launches or not self.is_usable(path):
            return
        self.launches[_resolve_path(path)] = path
        finder = self.make_finder(path)
        if path.suffix == ".py":
            models = read_python_launch(path, finder).models
            for model in models:
                self.extend_reach(model, finder)
                # Which of several it starts, nobody knows before it is launched.
                self.add_model(ModelTarget(model, self.arguments, (path,) if len(models) == 1 else ()))
            return
        launch: Launch = load_launch(path, finder)
        for description in launch.descriptions:
            if description.path is not None:
                model = Path(os.path.relpath(description.path)) if not path.is_absolute() else description.path
                self.extend_reach(model, finder)
                self.add_model(
                    ModelTarget(
                        model, {**description.arguments, **self.arguments}, (path,), xacro=description.uses_xacro
                    )
                )

    def extend_reach(self, model: Path, finder: PackageFinder) -> None:
        """A model of a package that a launch file has found is checked like any other: its package is in reach."""
        found = None if self.reach is None or self.reach.can_open(model) else finder.find_known_folder(model)
        if self.reach is not None and found is not None:
            self.reach = FileReach((*self.reach.roots, str(found)))

    def get_folder(self, path: Path) -> _FolderIndex:
        key = _resolve_path(path)
        if key not in self.folders:
            self.folders[key] = _FolderIndex(path, self.make_finder(path))
        return self.folders[key]

    def find_users(self, path: Path, find: Callable[[_FolderIndex, str], list[Path]]) -> list[Path]:
        """The models that use a file: those of its package (or folder), else those of the repository around it.

        ``find`` is also told the package by whose name the other packages reach the file.
        """
        own = self.make_finder(path).find_package_of(path.absolute())
        inner = path.absolute().parent if own is None else own.path
        outer = next((f for f in inner.parents if (f / ".git").exists()), None)
        for folder, package in ((inner, ""), (outer, "" if own is None else own.name)):
            if folder is None:
                continue
            found = find(self.get_folder(folder if path.is_absolute() else Path(os.path.relpath(folder))), package)
            if found:
                return found
        return []

    def build_variants(self, targets: Sequence[ModelTarget]) -> list[ModelTarget]:
        """A file with the sets of arguments that nobody gives to it yet."""
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
        # What the configuration gives and the text has no other value for: a model may need it to be one.
        configured = next((t.arguments for t in targets if not t.has_launch_arguments), {})
        given_anyway = {name: value for name, value in configured.items() if name not in {c.name for c in free}}
        found = [
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
        known = [{name: value for name, value in t.arguments.items() if value != defaults.get(name)} for t in targets]
        return [target for target in found if target.arguments not in known]

    def build_plan(self) -> Plan:
        models: list[ModelTarget] = []
        for targets in self.models.values():
            # A launch file says with which arguments the model is used: the bare one adds nothing.
            launched = [t for t in targets if t.has_launch_arguments]
            bare = [
                t for t in targets if not t.has_launch_arguments and (t.explicit or t.name is not None or not launched)
            ]
            models += [*bare, *launched, *self.build_variants(targets)]
        models.sort(key=lambda t: (format_path(t.path), sorted(t.arguments.items())))
        reached: set[Path] = set()
        for index, target in enumerate(models):
            # A launch file that loads two robots is checked once, with the first of them.
            own = tuple(x for x in target.launches if _resolve_path(x) not in reached)
            models[index] = replace(target, launches=own)
            reached |= {_resolve_path(x) for x in own}
        alone = [path for real, path in self.launches.items() if real not in reached]
        packages: dict[Path, None] = {}
        for path in [*(t.path for t in models), *self.launches.values()]:
            package = self.make_finder(path).find_package_of(path.absolute())
            if package is not None:
                packages[package.path] = None
        return Plan(
            tuple(models),
            tuple(sorted(alone)),
            tuple(sorted(packages)),
            tuple(self.missing),
            tuple(self.unused),
            self.reach,
            {
                str(path): local
                for path in (*(t.path for t in models), *alone, *packages)
                if (local := self.get_config(path)) is not None
            },
            frozenset(
                p for p in packages if any(given in (real := _resolve_path(p), *real.parents) for given in self.given)
            ),
            tuple(self.wrong),
        )


class _ModelFile:
    """What the text of a model or of macros decides. The text itself is not kept, and read again where more is asked."""

    def __init__(self, path: Path) -> None:
        self.path = path
        text = self.text
        self.is_robot = _ROBOT.search(text) is not None
        self.is_empty = not any(tag in text for tag in ("<link", "<joint", "<xacro:"))
        # An include in a comment is one that was tried: what it names is a part, unless it can stand alone.
        self.mentions = list(dict.fromkeys(_INCLUDE.findall(text)))[:MAX_INCLUDES]
        root = (
            self.root if self.mentions or path.suffix == ".xacro" else None
        )  # most URDF files need not be parsed here
        includes = [e.get("filename") for e in root.walk() if e.tag == "xacro:include"] if root else self.mentions
        self.includes = list(dict.fromkeys(includes))[:MAX_INCLUDES]
        self.only_macros = has_only_macros(root)
        self.has_parts = has_parts(root)
        self.stands_alone = can_stand_alone(root)

    @property
    def text(self) -> str:
        """Its text, as far as it can be read."""
        source = self._source
        if source is not None:
            return source.text
        try:
            return read_regular(self.path).decode("utf-8", "replace")
        except OSError:
            return ""

    @property
    def root(self) -> Element | None:
        """Its XML, None where it cannot be parsed."""
        source = self._source
        try:
            return None if source is None else parse_xml(source)
        except XmlError:
            return None

    @property
    def _source(self) -> SourceFile | None:
        try:
            return SourceFile.read(self.path, format_path(self.path))
        except (OSError, XmlError):
            return None

    def may_reference(self, mesh: str) -> bool:
        """Whether a mesh of this name may be meant: spelled out, or with expressions in place of what differs."""
        if mesh in self.text:
            return True
        root = self.root
        typed = [e.get("filename") for e in root.walk() if e.tag == "mesh"] if root is not None else []
        last = [_EXPRESSION.sub("\0", name).rpartition("/")[2] for name in typed]
        patterns = ["*".join(map(glob.escape, name.split("\0"))) for name in last if "\0" in name]
        return any(fnmatch.fnmatchcase(mesh, pattern) for pattern in patterns)


class _FolderIndex:
    """The files below a folder that can matter, read once."""

    def __init__(self, path: Path, finder: PackageFinder) -> None:
        self.path = path
        self.finder = finder
        self.outside: list[Path] = []
        files = sorted(_walk_files(path, finder, self.outside))
        self.launches = [f for f in files if is_launch(f)]
        self.files = {f: _ModelFile(f) for f in files if f.suffix in {".xacro", ".urdf"} and not is_srdf(f)}
        self.by_real = {_resolve_path(f): file for f, file in self.files.items()}
        self.by_name: dict[str, set[Path]] = {}
        for f in self.files:
            self.by_name.setdefault(f.name, set()).add(_resolve_path(f))
        self.compared = 0
        self.mentions = {_resolve_path(f): self._resolve_includes(f, file.mentions) for f, file in self.files.items()}
        self.includes = {_resolve_path(f): self._resolve_includes(f, file.includes) for f, file in self.files.items()}
        self.includers: dict[Path, set[Path]] = {}
        for by, names in self.includes.items():
            for name in names:
                self.includers.setdefault(name, set()).add(by)

    def _resolve_includes(self, path: Path, names: Iterable[str]) -> set[Path]:
        """The files that the includes of a file mean."""
        found: set[Path] = set()
        anywhere: set[str] = set()
        for name in names:
            tail = _EXPRESSION.sub("", name).lstrip("/")
            package = re.match(r"\$\(find ([^)\s]+)\)", name)
            folder = self.finder.find(package.group(1)) if package else path.parent
            targets = [] if folder is None else self._match_pattern(folder, tail)
            if any(map(os.path.isfile, targets)):
                found |= {_resolve_path(Path(target)) for target in targets}
            else:  # a path with arguments in it: every file of that name may be meant
                anywhere.add(Path(tail).name)
        return found.union(*(self.by_name.get(name, ()) for name in anywhere)) - {_resolve_path(path)}

    def _match_pattern(self, folder: Path, pattern: str) -> list[str]:
        """The files that a pattern means, looked for only where files may be opened."""
        steady = os.path.dirname(re.split(r"[*?[]", pattern, maxsplit=1)[0])
        if not self.finder.can_open(folder / steady) or ".." in Path(pattern[len(steady) :]).parts:
            return []
        found = [str(folder)]
        for part in Path(pattern).parts:
            if glob.has_magic(part):
                found = [os.path.join(place, name) for place in found for name in self._match_names(place, part)]
            else:
                found = [os.path.join(place, part) for place in found]
        return [path for path in found if os.path.lexists(path)]

    def _match_names(self, folder: str, pattern: str) -> list[str]:
        """What in a folder has a name like this; nothing any more when links in a circle would make that endless."""
        if self.compared > MAX_COMPARED or not self.finder.can_open(Path(folder)):
            return []
        try:
            names = [name for name in os.listdir(folder) if pattern.startswith(".") or not name.startswith(".")]
        except (OSError, ValueError):
            names = []
        self.compared += 20 + len(names)
        return fnmatch.filter(names, pattern)

    def find_models(self) -> Iterator[tuple[Path, bool]]:
        """Each model, and whether only its expansion tells that it is one."""
        mentioned = set().union(*self.mentions.values())
        for path, file in self.files.items():
            if path.suffix == ".urdf":
                # An empty robot is a placeholder that others include; what is no robot at all is called one.
                yield path, file.is_robot and file.is_empty
            elif self._is_part(_resolve_path(path)) or (_resolve_path(path) in mentioned and not file.stands_alone):
                continue
            elif not file.only_macros:
                yield path, not file.has_parts

    def _is_part(self, path: Path) -> bool:
        """Whether a file includes this one that it does not include itself: of a circle every file is a model."""
        includers = self.includers.get(path)
        return includers is not None and bool(includers - self._collect_all_includes(path))

    def find_including_models(self, path: Path) -> list[Path]:
        """The models that include a file, directly or through others."""
        return [model for model, _ in self.find_models() if _resolve_path(path) in self._collect_all_includes(model)]

    def find_models_by_robot_name(self, srdf: Path) -> list[Path]:
        """The models whose robot has the name of a semantic description's; a name with expressions may be any."""
        root = _ModelFile(srdf).root
        named = _EXPRESSION.sub("\0", root.get("name").strip()) if root is not None else ""
        users: list[Path] = []
        for model, _ in self.find_models():
            other = self.files[model].root
            typed = _EXPRESSION.sub("\0", other.get("name").strip()) if other is not None else ""
            if named and typed and (named == typed or "\0" in named + typed):
                users.append(model)
        return users

    def find_models_of_srdf_beside(self, settings: Path) -> list[Path]:
        """The models whose robot has the name of a semantic description's in the folder of a configuration."""
        inside = (Path(settings.parent, name) for name in _list_folder(str(settings.parent))[1])
        return [
            model
            for srdf in inside
            if is_srdf(srdf) and self.finder.can_open(srdf)
            for model in self.find_models_by_robot_name(srdf)
        ]

    def find_models_configured_by(self, settings: Path) -> list[Path]:
        """All models, where the folder is a package and the file lies where this keeps its configurations."""
        kept = {_resolve_path(self.path / name) for name in CONFIG_FOLDERS}
        if _resolve_path(settings).parent not in kept or not (self.path / "package.xml").is_file():
            return []
        return [model for model, _ in self.find_models()]

    def find_launches_loading(self, settings: Path, package: str) -> list[Path]:
        """The launch files in which a configuration's file name stands, and the name of its package."""
        texts = ((launch, _ModelFile(launch).text) for launch in self.launches)
        return [launch for launch, text in texts if settings.name in text and package in text]

    def find_models_using(self, named: Path, package: str) -> list[Path]:
        """The models in whose own or included text a file's name stands (a mesh, what is loaded), and the name of its package as
        well."""
        users: list[Path] = []
        for model, _ in self.find_models():
            files = [
                self.by_real[f] for f in (_resolve_path(model), *self._collect_all_includes(model)) if f in self.by_real
            ]
            if any(file.may_reference(named.name) for file in files) and any(package in file.text for file in files):
                users.append(model)
        return users

    def _collect_all_includes(self, path: Path) -> set[Path]:
        seen: set[Path] = set()
        queue = [_resolve_path(path)]
        while queue:
            for inner in self.includes.get(queue.pop(), ()):
                if inner not in seen:
                    seen.add(inner)
                    queue.append(inner)
        return seen


def is_srdf(path: Path) -> bool:
    """Whether a file's name says that it is a semantic description."""
    return path.name.endswith((".srdf", ".srdf.xacro"))


def is_launch(path: Path) -> bool:
    """Whether a file's name says that it is a launch file."""
    return path.name.endswith((".launch", ".launch.xml", ".launch.py", "_launch.py", "_launch.xml"))


def has_only_macros(root: Element | None) -> bool:
    """Whether a xacro file defines macros and properties and makes nothing itself. What xacro cannot read defines nothing."""
    if root is None or has_parts(root) or find_unbound_prefix(root) is not None:
        return False
    return not any(e.tag == "xacro:include" for e in root.walk())


def has_parts(root: Element | None) -> bool:
    """Whether a xacro file makes links or joints, or calls a macro, outside of its macro definitions."""
    return root is None or any(_is_robot_content(child) for child in root.children)


def can_stand_alone(root: Element | None) -> bool:
    """Whether a xacro file that others include may be a model as well: it makes something, and its robot has a name."""
    return root is None or (has_parts(root) and bool(root.get("name")))


def _is_robot_content(element: Element) -> bool:
    if element.tag in {"xacro:if", "xacro:unless"}:
        return any(_is_robot_content(child) for child in element.children)
    if element.tag in {"link", "joint"}:
        return True
    return element.tag.startswith("xacro:") and element.tag not in _BUILTINS


def _resolve_path(path: Path) -> Path:
    return Path(os.path.realpath(path))


def _walk_files(root: Path, finder: PackageFinder, outside: list[Path]) -> Iterable[Path]:
    """The files below a folder, through links as well; ``outside`` gets what leads to where nothing may be opened."""
    ignored = _list_git_ignored(root)
    seen: set[str] = set()
    below = [(str(root), os.path.realpath(root))]
    while below:  # os.walk calls itself for each level
        folder, real = below.pop()
        names, files = _list_folder(folder)
        if real in seen or "COLCON_IGNORE" in files or "AMENT_IGNORE" in files or "CATKIN_IGNORE" in files:
            continue
        seen.add(real)
        if os.path.islink(folder) and not finder.can_open(Path(folder)):
            outside.append(Path(folder))
            continue
        for name in names:
            place = os.path.join(real, name)
            if not name.startswith(".") and name not in _SKIPPED and place not in ignored:
                inner = os.path.join(folder, name)
                below.append((inner, os.path.realpath(inner) if os.path.islink(inner) else place))
        for name in files:
            path = Path(folder, name)
            if name.startswith(".") or os.path.join(real, name) in ignored:
                continue
            if os.path.islink(path) and not finder.can_open(path):
                outside.append(path)
            elif os.path.isfile(path):
                yield path


def _list_folder(folder: str) -> tuple[list[str], list[str]]:
    """The names of the folders in a folder, from the last to the first, and of everything else in it."""
    try:
        with os.scandir(folder) as found:
            names = sorted((entry.name for entry in found), reverse=True)
    except OSError:
        return [], []
    folders = {
        name for name in names if os.path.isdir(os.path.join(folder, name))
    }  # of a link in a circle scandir raises
    return [name for name in names if name in folders], [name for name in names if name not in folders]


def _list_git_ignored(root: Path) -> set[str]:
    """Files and folders below ``root`` that git ignores; empty outside of a work tree or without git."""
    import subprocess

    # The folder may be a stranger's: what its own git configuration would have git start is switched off. Of a clone that
    # lacks an object git would fetch it, by whatever command that configuration names.
    safe = ["-c", "core.fsmonitor=false", "-c", "safe.bareRepository=explicit", "-c", "fetch.bundleURI="]
    alone = {**os.environ, "GIT_ALLOW_PROTOCOL": "", "GIT_NO_LAZY_FETCH": "1", "GIT_TERMINAL_PROMPT": "0"}
    listing = ["ls-files", "-z", "--others", "--ignored", "--exclude-standard", "--directory"]
    try:
        done = subprocess.run(
            ["git", *safe, "-C", str(root), *listing], capture_output=True, timeout=20, check=True, env=alone
        )
    except (OSError, subprocess.SubprocessError):
        return set()
    names = [os.fsdecode(n) for n in done.stdout.split(b"\0") if n]
    if "./" in names:  # the given folder is ignored itself: the user means it all the same
        return set()
    # Of a link its own place counts, not the place that it leads to.
    places = [os.path.split(os.path.join(root, name.rstrip("/"))) for name in names]
    return {os.path.join(os.path.realpath(folder), name) for folder, name in places}
