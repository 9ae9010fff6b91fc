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
from urdfcheck.source.launch.python_launch_file import read_python
from urdfcheck.source.package.finder import BUILT, PackageFinder, display_name
from urdfcheck.source.reach import OUT_OF_REACH, Reach
from urdfcheck.source.text.xml import Element, SourceFile, XmlError, parse, unbound_prefix
from urdfcheck.system.files import read_regular

MESH_SUFFIXES = frozenset({".stl", ".dae", ".obj", ".ply", ".off", ".glb", ".gltf"})
# Where a package keeps its configurations.
FOLDERS = ("config", "params", "controllers", "control", "launch")
# Includes of one file that are looked for, and names of files that are compared with their patterns: beyond that a file counts
# as included by none, and is checked as a model of its own. Of a hundred robots no file has more than 40 includes.
MAX_INCLUDES = 2_000
MAX_COMPARED = 500_000
_SKIPPED = BUILT | {"node_modules", "__pycache__"}
_INCLUDE = re.compile(r"""<xacro:include\s[^<>]*?filename\s*=\s*["']([^"']+)["']""")
_EXPRESSION = re.compile(r"\$[({][^)}$]*[)}]")
_ROBOT = re.compile(r"<robot[\s>]")
_BUILTINS = frozenset(
    f"xacro:{name}" for name in ("macro", "property", "include", "arg", "if", "unless", "insert_block", "attribute")
)


class Named(Protocol):
    """A model that a configuration names, with its arguments."""

    @property
    def path(self) -> Path: ...
    @property
    def name(self) -> str | None: ...
    @property
    def arguments(self) -> Mapping[str, str]: ...


class Configured(Protocol):
    """What a configuration says about where things are."""

    @property
    def packages(self) -> Mapping[str, Path]: ...
    @property
    def package_path(self) -> Sequence[Path]: ...
    @property
    def models(self) -> Sequence[Named]: ...
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
    def launched(self) -> bool:
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
    reach: Reach | None = None
    configured: Mapping[str, Any] = field(default_factory=dict)
    whole: frozenset[Path] = frozenset()
    wrong: tuple[str, ...] = ()


def plan(
    paths: Sequence[Path],
    arguments: Mapping[str, str],
    packages: Mapping[str, Path],
    package_paths: Sequence[Path],
    reach: Reach | None = None,
    configured: Callable[[Path], Configured] | None = None,
    all_arguments: bool = False,
) -> Plan:
    """Everything that the given paths mean, each model once, in a stable order. ``reach``: which files may be opened;
    ``configured`` finds the configuration for a path, which the other arguments win over; ``all_arguments``: each xacro with all
    values of its arguments that are known (:mod:`urdfcheck.source.xacro.argument_values`)."""
    planner = _Planner(arguments, packages, package_paths, reach, configured, all_arguments)
    for path in paths:
        planner.add(path)
    return planner.plan()


class _Planner:
    def __init__(
        self,
        arguments: Mapping[str, str],
        packages: Mapping[str, Path],
        package_paths: Sequence[Path],
        reach: Reach | None,
        configured: Callable[[Path], Configured] | None,
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
        self.folders: dict[Path, _Folder] = {}
        self.given: list[Path] = []

    def finder(self, start: Path) -> PackageFinder:
        local = self.local(start)
        packages = {**local.packages, **self.packages} if local else self.packages
        paths = (*self.package_paths, *local.package_path) if local else self.package_paths
        return PackageFinder(start.absolute(), packages, paths, reach=self.reach)

    def local(self, path: Path) -> Configured | None:
        """The configuration for a path; none is looked for around a file that may not be opened.

        :raises UrdfcheckError: when it is wrong.
        """
        if self.configured is None or (self.reach is not None and not self.reach.allows(path)):
            return None
        return self.configured(path)

    def usable(self, path: Path, *, named: bool = True) -> bool:
        """Whether the configuration for a path is right, and wants it to be checked unless the user ``named`` it."""
        try:
            local = self.local(path)
        except UrdfcheckError as error:
            if str(error) not in self.wrong:
                self.wrong[str(error)] = None
                self.missing.append((display_name(path), f"is not checked, its configuration is wrong: {error}"))
            return False
        return named or local is None or not local.excludes(path)

    def add(self, path: Path) -> None:
        try:
            if self.reach is not None and not self.reach.allows(path):
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
        folder = self.folder(path)
        self.given.append(_real(path))
        for model, tentative in folder.models():
            if self.usable(model, named=False):
                self.add_model(ModelTarget(model, self.arguments, tentative=tentative))
        for launch in folder.launches:
            if self.usable(launch, named=False):
                self.add_launch(launch)
        for named in self.named_in(folder):
            if _real(named) not in self.models:
                self.add_model(ModelTarget(named, self.arguments))
        self.unused += [(display_name(link), OUT_OF_REACH) for link in sorted(folder.outside)]

    def add_file(self, path: Path) -> None:
        if is_launch(path):
            self.add_launch(path)
        elif path.suffix.lower() in MESH_SUFFIXES:
            users = self.users(path, lambda folder, package: folder.users_of(path, package))
            self.add_users(path, users, "no model of its package or repository names this mesh")
        elif path.name == "package.xml":
            self.add_folder(path.parent)
        elif path.suffix.lower() in {".yaml", ".yml"}:
            self.add_settings(path)
        elif is_srdf(path) and _File(path).root is None:
            self.missing.append((str(path), "is no XML that can be read, so that nobody knows whose it is"))
        elif is_srdf(path):
            users = self.users(path, lambda folder, _: folder.called(path))
            self.add_users(path, users, "no model of its package or repository has the name of its robot")
        elif path.suffix == ".xacro" and not (file := _File(path)).stands_alone:
            users = self.users(path, lambda folder, _: folder.including(path))
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

    def add_settings(self, path: Path) -> None:
        """A yaml file (controllers, joint limits, what a xacro loads): who names it, and the models that a semantic description
        beside it is about; else the models of its package, with which its controllers are compared."""
        users = [
            *self.users(path, lambda folder, _: folder.described_beside(path)),
            *self.users(
                path, lambda folder, package: [*folder.users_of(path, package), *folder.loading(path, package)]
            ),
        ] or self.users(path, lambda folder, _: folder.configured_by(path))
        for launch in filter(is_launch, users):
            self.add_launch(launch)
        models = [user for user in users if not is_launch(user)]
        if models or not users:
            self.add_users(path, models, "no model and no launch file of its package or repository reads this file")

    def named_in(self, folder: _Folder) -> list[Path]:
        """The files in a folder that the configurations for its files call models."""
        locals_ = {id(c): c for f in folder.files if self.usable(f) and (c := self.local(f)) is not None}
        mine = {_real(f): f for f in folder.files}
        return [mine[real] for c in locals_.values() for m in c.models if (real := _real(m.path)) in mine]

    def add_users(self, path: Path, users: Sequence[Path], otherwise: str) -> None:
        for user in users:
            if self.usable(user, named=False):
                self.add_model(ModelTarget(user, self.arguments))
        if not users:
            self.unused.append((display_name(path), otherwise))

    def add_model(self, target: ModelTarget) -> None:
        """A model; for one that the configuration names, with the arguments that this says."""
        if not self.usable(target.path):
            return
        local = self.local(target.path)
        real = _real(target.path)
        entries = [m for m in local.models if _real(m.path) == real] if local and not target.launched else []
        for entry in entries:
            name = "" if self.arguments else entry.name or ""  # with other arguments it is another model
            self.add_target(replace(target, arguments={**entry.arguments, **self.arguments}, name=name))
        if not entries:
            self.add_target(target)

    def add_target(self, target: ModelTarget) -> None:
        known = self.models.setdefault(_real(target.path), [])
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
        if _real(path) in self.launches or not self.usable(path):
            return
        self.launches[_real(path)] = path
        finder = self.finder(path)
        if path.suffix == ".py":
            models = read_python(path, finder).models
            for model in models:
                self.reach_for(model, finder)
                # Which of several it starts, nobody knows before it is launched.
                self.add_model(ModelTarget(model, self.arguments, (path,) if len(models) == 1 else ()))
            return
        launch: Launch = load_launch(path, finder)
        for description in launch.descriptions:
            if description.path is not None:
                model = Path(os.path.relpath(description.path)) if not path.is_absolute() else description.path
                self.reach_for(model, finder)
                self.add_model(
                    ModelTarget(model, {**description.arguments, **self.arguments}, (path,), xacro=description.by_xacro)
                )

    def reach_for(self, model: Path, finder: PackageFinder) -> None:
        """A model of a package that a launch file has found is checked like any other: its package is in reach."""
        found = None if self.reach is None or self.reach.allows(model) else finder.found_around(model)
        if self.reach is not None and found is not None:
            self.reach = Reach((*self.reach.roots, str(found)))

    def folder(self, path: Path) -> _Folder:
        key = _real(path)
        if key not in self.folders:
            self.folders[key] = _Folder(path, self.finder(path))
        return self.folders[key]

    def users(self, path: Path, find: Callable[[_Folder, str], list[Path]]) -> list[Path]:
        """The models that use a file: those of its package (or folder), else those of the repository around it.

        ``find`` is also told the package by whose name the other packages reach the file.
        """
        own = self.finder(path).package_of(path.absolute())
        inner = path.absolute().parent if own is None else own.path
        outer = next((f for f in inner.parents if (f / ".git").exists()), None)
        for folder, package in ((inner, ""), (outer, "" if own is None else own.name)):
            if folder is None:
                continue
            found = find(self.folder(folder if path.is_absolute() else Path(os.path.relpath(folder))), package)
            if found:
                return found
        return []

    def variants(self, targets: Sequence[ModelTarget]) -> list[ModelTarget]:
        """A file with the sets of arguments that nobody gives to it yet."""
        first = targets[0]
        if not self.all_arguments or not (first.path.suffix == ".xacro" or any(t.xacro for t in targets)):
            return []
        from urdfcheck.source.xacro.argument_values import MOST_ARGUMENTS, choices, sets

        free = [c for c in choices(first.path, self.finder(first.path)) if c.name not in self.arguments]
        if len(free) > MOST_ARGUMENTS:
            reason = f"has {len(free)} arguments to vary: the first {MOST_ARGUMENTS} of them are"
            self.unused.append((display_name(first.path), reason))
        varied = {c.name for c in free if c.default is not None}
        # What the configuration gives and the text has no other value for: a model may need it to be one.
        configured = next((t.arguments for t in targets if not t.launched), {})
        given_anyway = {name: value for name, value in configured.items() if name not in {c.name for c in free}}
        found = [
            replace(
                first,
                arguments={**given_anyway, **self.arguments, **given},
                launches=(),
                name=None,
                varied=tuple(name for name in given if name in varied),
            )
            for given in sets(free[:MOST_ARGUMENTS])
        ]
        defaults = {c.name: c.default for c in free}
        known = [{name: value for name, value in t.arguments.items() if value != defaults.get(name)} for t in targets]
        return [target for target in found if target.arguments not in known]

    def plan(self) -> Plan:
        models: list[ModelTarget] = []
        for targets in self.models.values():
            # A launch file says with which arguments the model is used: the bare one adds nothing.
            launched = [t for t in targets if t.launched]
            bare = [t for t in targets if not t.launched and (t.explicit or t.name is not None or not launched)]
            models += [*bare, *launched, *self.variants(targets)]
        models.sort(key=lambda t: (display_name(t.path), sorted(t.arguments.items())))
        reached: set[Path] = set()
        for index, target in enumerate(models):
            # A launch file that loads two robots is checked once, with the first of them.
            own = tuple(x for x in target.launches if _real(x) not in reached)
            models[index] = replace(target, launches=own)
            reached |= {_real(x) for x in own}
        alone = [path for real, path in self.launches.items() if real not in reached]
        packages: dict[Path, None] = {}
        for path in [*(t.path for t in models), *self.launches.values()]:
            package = self.finder(path).package_of(path.absolute())
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
                if (local := self.local(path)) is not None
            },
            frozenset(p for p in packages if any(given in (real := _real(p), *real.parents) for given in self.given)),
            tuple(self.wrong),
        )


class _File:
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
        self.only_macros = only_macros(root)
        self.has_parts = has_parts(root)
        self.stands_alone = stands_alone(root)

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
            return None if source is None else parse(source)
        except XmlError:
            return None

    @property
    def _source(self) -> SourceFile | None:
        try:
            return SourceFile.read(self.path, display_name(self.path))
        except (OSError, XmlError):
            return None

    def names(self, mesh: str) -> bool:
        """Whether a mesh of this name may be meant: spelled out, or with expressions in place of what differs."""
        if mesh in self.text:
            return True
        root = self.root
        typed = [e.get("filename") for e in root.walk() if e.tag == "mesh"] if root is not None else []
        last = [_EXPRESSION.sub("\0", name).rpartition("/")[2] for name in typed]
        patterns = ["*".join(map(glob.escape, name.split("\0"))) for name in last if "\0" in name]
        return any(fnmatch.fnmatchcase(mesh, pattern) for pattern in patterns)


class _Folder:
    """The files below a folder that can matter, read once."""

    def __init__(self, path: Path, finder: PackageFinder) -> None:
        self.path = path
        self.finder = finder
        self.outside: list[Path] = []
        files = sorted(_walk(path, finder, self.outside))
        self.launches = [f for f in files if is_launch(f)]
        self.files = {f: _File(f) for f in files if f.suffix in {".xacro", ".urdf"} and not is_srdf(f)}
        self.by_real = {_real(f): file for f, file in self.files.items()}
        self.by_name: dict[str, set[Path]] = {}
        for f in self.files:
            self.by_name.setdefault(f.name, set()).add(_real(f))
        self.compared = 0
        self.mentions = {_real(f): self._files_named(f, file.mentions) for f, file in self.files.items()}
        self.includes = {_real(f): self._files_named(f, file.includes) for f, file in self.files.items()}
        self.includers: dict[Path, set[Path]] = {}
        for by, names in self.includes.items():
            for name in names:
                self.includers.setdefault(name, set()).add(by)

    def _files_named(self, path: Path, names: Iterable[str]) -> set[Path]:
        """The files that the includes of a file mean."""
        found: set[Path] = set()
        anywhere: set[str] = set()
        for name in names:
            tail = _EXPRESSION.sub("", name).lstrip("/")
            package = re.match(r"\$\(find ([^)\s]+)\)", name)
            folder = self.finder.find(package.group(1)) if package else path.parent
            targets = [] if folder is None else self._matching(folder, tail)
            if any(map(os.path.isfile, targets)):
                found |= {_real(Path(target)) for target in targets}
            else:  # a path with arguments in it: every file of that name may be meant
                anywhere.add(Path(tail).name)
        return found.union(*(self.by_name.get(name, ()) for name in anywhere)) - {_real(path)}

    def _matching(self, folder: Path, pattern: str) -> list[str]:
        """The files that a pattern means, looked for only where files may be opened."""
        steady = os.path.dirname(re.split(r"[*?[]", pattern, maxsplit=1)[0])
        if not self.finder.allows(folder / steady) or ".." in Path(pattern[len(steady) :]).parts:
            return []
        found = [str(folder)]
        for part in Path(pattern).parts:
            if glob.has_magic(part):
                found = [os.path.join(place, name) for place in found for name in self._named(place, part)]
            else:
                found = [os.path.join(place, part) for place in found]
        return [path for path in found if os.path.lexists(path)]

    def _named(self, folder: str, pattern: str) -> list[str]:
        """What in a folder has a name like this; nothing any more when links in a circle would make that endless."""
        if self.compared > MAX_COMPARED or not self.finder.allows(Path(folder)):
            return []
        try:
            names = [name for name in os.listdir(folder) if pattern.startswith(".") or not name.startswith(".")]
        except (OSError, ValueError):
            names = []
        self.compared += 20 + len(names)
        return fnmatch.filter(names, pattern)

    def models(self) -> Iterator[tuple[Path, bool]]:
        """Each model, and whether only its expansion tells that it is one."""
        mentioned = set().union(*self.mentions.values())
        for path, file in self.files.items():
            if path.suffix == ".urdf":
                # An empty robot is a placeholder that others include; what is no robot at all is called one.
                yield path, file.is_robot and file.is_empty
            elif self._is_part(_real(path)) or (_real(path) in mentioned and not file.stands_alone):
                continue
            elif not file.only_macros:
                yield path, not file.has_parts

    def _is_part(self, path: Path) -> bool:
        """Whether a file includes this one that it does not include itself: of a circle every file is a model."""
        includers = self.includers.get(path)
        return includers is not None and bool(includers - self._closure(path))

    def including(self, path: Path) -> list[Path]:
        """The models that include a file, directly or through others."""
        return [model for model, _ in self.models() if _real(path) in self._closure(model)]

    def called(self, srdf: Path) -> list[Path]:
        """The models whose robot has the name of a semantic description's; a name with expressions may be any."""
        root = _File(srdf).root
        named = _EXPRESSION.sub("\0", root.get("name").strip()) if root is not None else ""
        users: list[Path] = []
        for model, _ in self.models():
            other = self.files[model].root
            typed = _EXPRESSION.sub("\0", other.get("name").strip()) if other is not None else ""
            if named and typed and (named == typed or "\0" in named + typed):
                users.append(model)
        return users

    def described_beside(self, settings: Path) -> list[Path]:
        """The models whose robot has the name of a semantic description's in the folder of a configuration."""
        inside = (Path(settings.parent, name) for name in _listed(str(settings.parent))[1])
        return [model for srdf in inside if is_srdf(srdf) and self.finder.allows(srdf) for model in self.called(srdf)]

    def configured_by(self, settings: Path) -> list[Path]:
        """All models, where the folder is a package and the file lies where this keeps its configurations."""
        kept = {_real(self.path / name) for name in FOLDERS}
        if _real(settings).parent not in kept or not (self.path / "package.xml").is_file():
            return []
        return [model for model, _ in self.models()]

    def loading(self, settings: Path, package: str) -> list[Path]:
        """The launch files in which a configuration's file name stands, and the name of its package."""
        texts = ((launch, _File(launch).text) for launch in self.launches)
        return [launch for launch, text in texts if settings.name in text and package in text]

    def users_of(self, named: Path, package: str) -> list[Path]:
        """The models in whose own or included text a file's name stands (a mesh, what is loaded), and the name of its package as
        well."""
        users: list[Path] = []
        for model, _ in self.models():
            files = [self.by_real[f] for f in (_real(model), *self._closure(model)) if f in self.by_real]
            if any(file.names(named.name) for file in files) and any(package in file.text for file in files):
                users.append(model)
        return users

    def _closure(self, path: Path) -> set[Path]:
        seen: set[Path] = set()
        queue = [_real(path)]
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


def only_macros(root: Element | None) -> bool:
    """Whether a xacro file defines macros and properties and makes nothing itself. What xacro cannot read defines nothing."""
    if root is None or has_parts(root) or unbound_prefix(root) is not None:
        return False
    return not any(e.tag == "xacro:include" for e in root.walk())


def has_parts(root: Element | None) -> bool:
    """Whether a xacro file makes links or joints, or calls a macro, outside of its macro definitions."""
    return root is None or any(_makes_something(child) for child in root.children)


def stands_alone(root: Element | None) -> bool:
    """Whether a xacro file that others include may be a model as well: it makes something, and its robot has a name."""
    return root is None or (has_parts(root) and bool(root.get("name")))


def _makes_something(element: Element) -> bool:
    if element.tag in {"xacro:if", "xacro:unless"}:
        return any(_makes_something(child) for child in element.children)
    if element.tag in {"link", "joint"}:
        return True
    return element.tag.startswith("xacro:") and element.tag not in _BUILTINS


def _real(path: Path) -> Path:
    return Path(os.path.realpath(path))


def _walk(root: Path, finder: PackageFinder, outside: list[Path]) -> Iterable[Path]:
    """The files below a folder, through links as well; ``outside`` gets what leads to where nothing may be opened."""
    ignored = _ignored_by_git(root)
    seen: set[str] = set()
    below = [(str(root), os.path.realpath(root))]
    while below:  # os.walk calls itself for each level
        folder, real = below.pop()
        names, files = _listed(folder)
        if real in seen or "COLCON_IGNORE" in files or "AMENT_IGNORE" in files or "CATKIN_IGNORE" in files:
            continue
        seen.add(real)
        if os.path.islink(folder) and not finder.allows(Path(folder)):
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
            if os.path.islink(path) and not finder.allows(path):
                outside.append(path)
            elif os.path.isfile(path):
                yield path


def _listed(folder: str) -> tuple[list[str], list[str]]:
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


def _ignored_by_git(root: Path) -> set[str]:
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
