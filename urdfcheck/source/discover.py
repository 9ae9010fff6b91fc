"""From the paths on the command line to the models, launch files and packages that are to be checked.

Standard library only: this runs before anything heavy is loaded.
"""

from __future__ import annotations

import os
import re
import subprocess
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from urdfcheck.source.launch import Launch, load_launch, models_in_python
from urdfcheck.source.packages import PackageFinder, display_name
from urdfcheck.source.xml import Element, SourceFile, XmlError, parse

MESH_SUFFIXES = frozenset({".stl", ".dae", ".obj", ".ply", ".off", ".glb", ".gltf"})
_SKIPPED = frozenset({"build", "install", "log", "node_modules", "__pycache__"})
_INCLUDE = re.compile(r"""<xacro:include\s[^>]*?filename\s*=\s*["']([^"']+)["']""")
_ROBOT = re.compile(r"<robot[\s>]")
_BUILTINS = frozenset(
    f"xacro:{name}" for name in ("macro", "property", "include", "arg", "if", "unless", "insert_block", "attribute")
)


@dataclass(frozen=True, slots=True)
class ModelTarget:
    """A model to check. ``explicit``: the user named the file; ``tentative``: only its expansion shows whether it is one."""

    path: Path
    arguments: Mapping[str, str] = field(default_factory=dict)
    launches: tuple[Path, ...] = ()
    explicit: bool = False
    tentative: bool = False


@dataclass(frozen=True, slots=True)
class Plan:
    """What there is to check. ``missing``: paths that do not exist or are nothing that can be checked, with the reason;
    ``unused``: macro files and meshes that were named but that no model uses."""

    models: tuple[ModelTarget, ...]
    launches: tuple[Path, ...]
    packages: tuple[Path, ...]
    missing: tuple[tuple[str, str], ...]
    unused: tuple[tuple[str, str], ...] = ()


def plan(
    paths: Sequence[Path],
    arguments: Mapping[str, str],
    packages: Mapping[str, Path],
    package_paths: Sequence[Path],
) -> Plan:
    """Everything that the given paths mean, each model once, in a stable order."""
    planner = _Planner(arguments, packages, package_paths)
    for path in paths:
        planner.add(path)
    return planner.plan()


class _Planner:
    def __init__(
        self, arguments: Mapping[str, str], packages: Mapping[str, Path], package_paths: Sequence[Path]
    ) -> None:
        self.arguments = dict(arguments)
        self.packages = packages
        self.package_paths = package_paths
        self.models: dict[Path, list[ModelTarget]] = {}
        self.launches: dict[Path, Path] = {}
        self.missing: list[tuple[str, str]] = []
        self.unused: list[tuple[str, str]] = []
        self.folders: dict[Path, _Folder] = {}

    def finder(self, start: Path) -> PackageFinder:
        return PackageFinder(start.absolute(), self.packages, self.package_paths)

    def add(self, path: Path) -> None:
        try:
            if path.is_dir():
                self.add_folder(path)
            elif path.is_file():
                self.add_file(path)
            elif path.exists():
                self.missing.append((str(path), "is neither a file nor a folder"))
            else:
                self.missing.append((str(path), "does not exist"))
        except OSError as error:
            self.missing.append((str(path), error.strerror or str(error)))

    def add_folder(self, path: Path) -> None:
        folder = self.folder(path)
        for model, tentative in folder.models():
            self.add_model(ModelTarget(model, self.arguments, tentative=tentative))
        for launch in folder.launches:
            self.add_launch(launch)

    def add_file(self, path: Path) -> None:
        if is_launch(path):
            self.add_launch(path)
        elif path.suffix.lower() in MESH_SUFFIXES:
            self.add_users(path, self.surroundings(path).users_of(path), "no model of its package names this mesh")
        elif path.name == "package.xml":
            self.add_folder(path.parent)
        elif path.suffix == ".xacro" and only_macros(path):
            users = self.surroundings(path).including(path)
            self.add_users(path, users, "only defines macros, and no model of its package includes it")
        elif path.suffix in {".urdf", ".xacro", ".xml", ""}:
            self.add_model(ModelTarget(path, self.arguments, explicit=True))
        else:
            self.missing.append((str(path), "is no model, launch file, mesh or folder"))

    def add_users(self, path: Path, users: Sequence[Path], otherwise: str) -> None:
        for user in users:
            self.add_model(ModelTarget(user, self.arguments))
        if not users:
            self.unused.append((display_name(path), otherwise))

    def add_model(self, target: ModelTarget) -> None:
        known = self.models.setdefault(_real(target.path), [])
        for index, other in enumerate(known):
            if dict(other.arguments) == dict(target.arguments):
                known[index] = replace(
                    other,
                    launches=(*other.launches, *(x for x in target.launches if x not in other.launches)),
                    explicit=other.explicit or target.explicit,
                    tentative=other.tentative and target.tentative,
                )
                return
        known.append(target)

    def add_launch(self, path: Path) -> None:
        if _real(path) in self.launches:
            return
        self.launches[_real(path)] = path
        finder = self.finder(path)
        if path.suffix == ".py":
            for model in models_in_python(path, finder):
                self.add_model(ModelTarget(model, self.arguments))
            return
        launch: Launch = load_launch(path, finder)
        for description in launch.descriptions:
            if description.path is not None:
                model = Path(os.path.relpath(description.path)) if not path.is_absolute() else description.path
                self.add_model(ModelTarget(model, {**description.arguments, **self.arguments}, (path,)))

    def folder(self, path: Path) -> _Folder:
        key = _real(path)
        if key not in self.folders:
            self.folders[key] = _Folder(path, self.finder(path))
        return self.folders[key]

    def surroundings(self, path: Path) -> _Folder:
        """The package around a file, or its folder: where the models that use it are looked for."""
        package = self.finder(path).package_of(path.absolute())
        folder = path.parent if package is None else package.path
        return self.folder(Path(os.path.relpath(folder)) if not path.is_absolute() else folder)

    def plan(self) -> Plan:
        models: list[ModelTarget] = []
        for targets in self.models.values():
            # A launch file says with which arguments the model is used: the bare one adds nothing.
            launched = [t for t in targets if t.launches]
            bare = [t for t in targets if not t.launches and (t.explicit or not launched)]
            models += [*bare, *launched]
        models.sort(key=lambda t: (display_name(t.path), sorted(t.arguments.items())))
        reached: set[Path] = set()
        for index, target in enumerate(models):
            # A launch file that loads two robots is checked once, with the first of them.
            own = tuple(x for x in target.launches if _real(x) not in reached)
            models[index] = replace(target, launches=own)
            reached |= {_real(x) for x in own}
        alone = [path for real, path in self.launches.items() if real not in reached and path.suffix != ".py"]
        packages: dict[Path, None] = {}
        for path in [*(t.path for t in models), *self.launches.values()]:
            package = self.finder(path).package_of(path.absolute())
            if package is not None:
                packages[package.path] = None
        return Plan(tuple(models), tuple(sorted(alone)), tuple(sorted(packages)), tuple(self.missing), tuple(self.unused))


class _Folder:
    """The files below a folder that can matter, read once."""

    def __init__(self, path: Path, finder: PackageFinder) -> None:
        self.finder = finder
        files = sorted(_walk(path))
        self.launches = [f for f in files if is_launch(f)]
        self.urdfs = [f for f in files if f.suffix == ".urdf"]
        self.texts = {f: _text(f) for f in files if f.suffix in {".xacro", ".urdf"}}
        self.includes = {f: self._included_by(f, text) for f, text in self.texts.items()}

    def _included_by(self, path: Path, text: str) -> set[Path]:
        found: set[Path] = set()
        for name in _INCLUDE.findall(text):
            tail = re.sub(r"\$[({][^)}]*[)}]", "", name).lstrip("/")
            package = re.match(r"\$\(find ([^)\s]+)\)", name)
            folder = self.finder.find(package.group(1)) if package else path.parent
            target = folder / tail if folder is not None else None
            if target is not None and target.is_file():
                found.add(_real(target))
            else:  # a path with arguments in it: every file of that name may be meant
                found |= {_real(f) for f in self.texts if tail and f.as_posix().endswith("/" + Path(tail).name)}
        return found - {_real(path)}

    def models(self) -> Iterator[tuple[Path, bool]]:
        """Each model, and whether only its expansion tells that it is one."""
        included = set().union(*self.includes.values()) if self.includes else set()
        for path, text in self.texts.items():
            if path.suffix == ".urdf":
                if _ROBOT.search(text):
                    # An empty robot is a placeholder that others include.
                    yield path, not any(tag in text for tag in ("<link", "<joint", "<xacro:"))
            elif _real(path) not in included and not only_macros(path):
                yield path, not has_parts(path)

    def including(self, path: Path) -> list[Path]:
        """The models that include a file, directly or through others."""
        models = dict(self.models())
        return [m for m in models if _real(path) in self._closure(m)]

    def users_of(self, mesh: Path) -> list[Path]:
        """The models in whose own or included text the mesh's file name stands."""
        by_real = {_real(f): text for f, text in self.texts.items()}
        return [
            model
            for model, _ in self.models()
            if any(mesh.name in by_real.get(f, "") for f in {_real(model), *self._closure(model)})
        ]

    def _closure(self, path: Path) -> set[Path]:
        by_real = {_real(f): included for f, included in self.includes.items()}
        seen: set[Path] = set()
        queue = [_real(path)]
        while queue:
            for inner in by_real.get(queue.pop(), ()):
                if inner not in seen:
                    seen.add(inner)
                    queue.append(inner)
        return seen


def is_launch(path: Path) -> bool:
    """Whether a file's name says that it is a launch file."""
    return path.name.endswith((".launch", ".launch.xml", ".launch.py", "_launch.py", "_launch.xml"))


def only_macros(path: Path) -> bool:
    """Whether a xacro file defines macros and properties and makes nothing itself."""
    root = _tree(path)
    if root is None:
        return False
    return not has_parts(path) and not any(c.tag == "xacro:include" for c in root.walk())


def has_parts(path: Path) -> bool:
    """Whether a xacro file makes links or joints, or calls a macro, outside of its macro definitions."""
    root = _tree(path)
    return root is None or any(_makes_something(child) for child in root.children)


def _makes_something(element: Element) -> bool:
    if element.tag in {"xacro:if", "xacro:unless"}:
        return any(_makes_something(child) for child in element.children)
    if element.tag in {"link", "joint"}:
        return True
    return element.tag.startswith("xacro:") and element.tag not in _BUILTINS


def _tree(path: Path) -> Element | None:
    try:
        return parse(SourceFile.read(path, display_name(path)))
    except (OSError, XmlError):
        return None


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8", errors="replace")
    except OSError:
        return ""


def _real(path: Path) -> Path:
    return Path(os.path.realpath(path))


def _walk(root: Path) -> Iterable[Path]:
    ignored = _ignored_by_git(root)
    seen: set[str] = set()
    for folder, names, files in os.walk(root, followlinks=True):
        real = os.path.realpath(folder)
        if real in seen or "COLCON_IGNORE" in files or "AMENT_IGNORE" in files or "CATKIN_IGNORE" in files:
            names.clear()
            continue
        seen.add(real)
        names[:] = sorted(
            n
            for n in names
            if not n.startswith(".") and n not in _SKIPPED and os.path.realpath(os.path.join(folder, n)) not in ignored
        )
        for name in files:
            path = Path(folder, name)
            if os.path.realpath(path) not in ignored and path.is_file():
                yield path


def _ignored_by_git(root: Path) -> set[str]:
    """Files and folders below ``root`` that git ignores; empty outside of a work tree or without git."""
    command = ["git", "-C", str(root), "ls-files", "-z", "--others", "--ignored", "--exclude-standard", "--directory"]
    try:
        listed = subprocess.run(command, capture_output=True, timeout=20, check=True).stdout
    except (OSError, subprocess.SubprocessError):
        return set()
    names = [os.fsdecode(n) for n in listed.split(b"\0") if n]
    if "./" in names:  # the given folder is ignored itself: the user means it all the same
        return set()
    return {os.path.realpath(root / n) for n in names}
