"""The models and launch files below a folder, and which of them use a file.

Standard library only: this runs before anything heavy is loaded.
"""

from __future__ import annotations

import fnmatch
import glob
import os
import re
from collections.abc import Iterable, Iterator
from pathlib import Path

from urdfcheck.source.package.file_kinds import CONFIG_FOLDERS, is_launch, is_srdf
from urdfcheck.source.package.finder import PackageFinder, format_path
from urdfcheck.source.package.package_folders import BUILD_FOLDERS
from urdfcheck.source.text.xml import Element, SourceFile, XmlError, parse_xml
from urdfcheck.source.xacro.file_contents import can_stand_alone, has_only_macros, has_parts
from urdfcheck.system.files import read_regular

# Limits on the includes of one file that are followed, and on the file names that are compared with their patterns: beyond
# them a file counts as not included, and is checked as a model. In a hundred robots no file has more than 40 includes.
MAX_INCLUDES = 2_000
MAX_COMPARED = 500_000
_SKIPPED = BUILD_FOLDERS | {"node_modules", "__pycache__"}
_INCLUDE = re.compile(r"""<xacro:include\s[^<>]*?filename\s*=\s*["']([^"']+)["']""")
_EXPRESSION = re.compile(r"\$[({][^)}$]*[)}]")
_ROBOT = re.compile(r"<robot[\s>]")


class ModelFile:
    """What the text of a model or macro file decides. The text itself is not kept; it is read again where more is asked."""

    def __init__(self, path: Path) -> None:
        self.path = path
        text = self.text
        self.is_robot = _ROBOT.search(text) is not None
        self.is_empty = not any(tag in text for tag in ("<link", "<joint", "<xacro:"))
        # An include in a comment has been tried before: the file that it names is a part, unless it can stand alone.
        self.mentions = list(dict.fromkeys(_INCLUDE.findall(text)))[:MAX_INCLUDES]
        needs_tree = bool(self.mentions) or path.suffix == ".xacro"  # most URDF files need not be parsed here
        root = self.root if needs_tree else None
        includes = [e.get("filename") for e in root.walk() if e.tag == "xacro:include"] if root else self.mentions
        self.includes = list(dict.fromkeys(includes))[:MAX_INCLUDES]
        self.only_macros = has_only_macros(root)
        self.has_parts = has_parts(root)
        self.stands_alone = can_stand_alone(root)

    @property
    def text(self) -> str:
        """The text of the file, as far as it can be read."""
        source = self._source
        if source is not None:
            return source.text
        try:
            return read_regular(self.path).decode("utf-8", "replace")
        except OSError:
            return ""

    @property
    def root(self) -> Element | None:
        """The XML of the file; None if it cannot be parsed."""
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
        """Whether the file may mean a mesh of this name: spelled out, or with expressions for what differs."""
        if mesh in self.text:
            return True
        root = self.root
        typed = [e.get("filename") for e in root.walk() if e.tag == "mesh"] if root is not None else []
        last = [_EXPRESSION.sub("\0", name).rpartition("/")[2] for name in typed]
        patterns = ["*".join(map(glob.escape, name.split("\0"))) for name in last if "\0" in name]
        return any(fnmatch.fnmatchcase(mesh, pattern) for pattern in patterns)


class FolderIndex:
    """The files below a folder that can matter, read once."""

    def __init__(self, path: Path, finder: PackageFinder) -> None:
        self.path = path
        self.finder = finder
        self.outside: list[Path] = []
        files = sorted(_iter_files(path, finder, self.outside))
        self.packages = [f.parent for f in files if f.name == "package.xml"]
        finder.note_packages(self.packages)
        self.launches = [f for f in files if is_launch(f)]
        self.files = {f: ModelFile(f) for f in files if f.suffix in {".xacro", ".urdf"} and not is_srdf(f)}
        self.by_real = {resolve_path(f): file for f, file in self.files.items()}
        self.by_name: dict[str, set[Path]] = {}
        for f in self.files:
            self.by_name.setdefault(f.name, set()).add(resolve_path(f))
        self.compared = 0
        self.mentions = {resolve_path(f): self._resolve_includes(f, file.mentions) for f, file in self.files.items()}
        self.includes = {resolve_path(f): self._resolve_includes(f, file.includes) for f, file in self.files.items()}
        self.includers: dict[Path, set[Path]] = {}
        for by, names in self.includes.items():
            for name in names:
                self.includers.setdefault(name, set()).add(by)

    def _resolve_includes(self, path: Path, names: Iterable[str]) -> set[Path]:
        """Return the files that the includes of a file mean."""
        included: set[Path] = set()
        anywhere: set[str] = set()
        for name in names:
            tail = _EXPRESSION.sub("", name).lstrip("/")
            package = re.match(r"\$\(find ([^)\s]+)\)", name)
            folder = self.finder.find(package.group(1)) if package else path.parent
            targets = [] if folder is None else self._match_pattern(folder, tail)
            if package and folder is not None and not targets:
                targets = [str(self.finder.find_source(folder / tail))]
            if any(map(os.path.isfile, targets)):
                included |= {resolve_path(Path(target)) for target in targets}
            else:  # a path with arguments in it may mean every file of that name
                anywhere.add(Path(tail).name)
        return included.union(*(self.by_name.get(name, ()) for name in anywhere)) - {resolve_path(path)}

    def _match_pattern(self, folder: Path, pattern: str) -> list[str]:
        """Return the files that a pattern means; only folders that may be opened are searched."""
        steady = os.path.dirname(re.split(r"[*?[]", pattern, maxsplit=1)[0])
        if not self.finder.can_open(folder / steady) or ".." in Path(pattern[len(steady) :]).parts:
            return []
        places = [str(folder)]
        for part in Path(pattern).parts:
            if glob.has_magic(part):
                places = [os.path.join(place, name) for place in places for name in self._match_names(place, part)]
            else:
                places = [os.path.join(place, part) for place in places]
        return [path for path in places if os.path.lexists(path)]

    def _match_names(self, folder: str, pattern: str) -> list[str]:
        """Return the matching names in a folder; none once circular links have used up the comparisons."""
        if self.compared > MAX_COMPARED or not self.finder.can_open(Path(folder)):
            return []
        try:
            names = [name for name in os.listdir(folder) if pattern.startswith(".") or not name.startswith(".")]
        except (OSError, ValueError):
            names = []
        self.compared += 20 + len(names)
        return fnmatch.filter(names, pattern)

    def find_models(self) -> Iterator[tuple[Path, bool]]:
        """Yield each model, and whether only its expansion shows that it is one."""
        mentioned = set().union(*self.mentions.values())
        for path, file in self.files.items():
            if path.suffix == ".urdf":
                # An empty robot is a placeholder that others include; a file without a robot is reported as not a robot.
                yield path, file.is_robot and file.is_empty
            elif self._is_part(resolve_path(path)) or (resolve_path(path) in mentioned and not file.stands_alone):
                continue
            elif not file.only_macros:
                yield path, not file.has_parts

    def _is_part(self, path: Path) -> bool:
        """Whether another file includes this one without being included by it: in a circle every file is a model."""
        includers = self.includers.get(path)
        return includers is not None and bool(includers - self._collect_all_includes(path))

    def find_including_models(self, path: Path) -> list[Path]:
        """Return the models that include a file, directly or through others."""
        return [model for model, _ in self.find_models() if resolve_path(path) in self._collect_all_includes(model)]

    def find_models_by_robot_name(self, srdf: Path) -> list[Path]:
        """Return the models of the robot that a semantic description names; a name with expressions may be any."""
        root = ModelFile(srdf).root
        wanted = _EXPRESSION.sub("\0", root.get("name").strip()) if root is not None else ""
        users: list[Path] = []
        for model, _ in self.find_models():
            other = self.files[model].root
            typed = _EXPRESSION.sub("\0", other.get("name").strip()) if other is not None else ""
            if wanted and typed and (wanted == typed or "\0" in wanted + typed):
                users.append(model)
        return users

    def find_models_of_srdf_beside(self, settings: Path) -> list[Path]:
        """Return the models of the robots that the semantic descriptions beside a configuration file name."""
        inside = (Path(settings.parent, name) for name in _list_folder(str(settings.parent))[1])
        return [
            model
            for srdf in inside
            if is_srdf(srdf) and self.finder.can_open(srdf)
            for model in self.find_models_by_robot_name(srdf)
        ]

    def find_models_configured_by(self, settings: Path) -> list[Path]:
        """Return all models, if the folder is a package and the file is in one of its configuration folders."""
        config_folders = {resolve_path(self.path / name) for name in CONFIG_FOLDERS}
        if resolve_path(settings).parent not in config_folders or not (self.path / "package.xml").is_file():
            return []
        return [model for model, _ in self.find_models()]

    def find_launches_loading(self, settings: Path, package: str) -> list[Path]:
        """Return the launch files that contain the name of a configuration file and of its package."""
        texts = ((launch, ModelFile(launch).text) for launch in self.launches)
        return [launch for launch, text in texts if settings.name in text and package in text]

    def find_models_using(self, file: Path, package: str) -> list[Path]:
        """Return the models whose own or included text contains the name of a mesh or of a loaded file, and of its package."""
        users: list[Path] = []
        for model, _ in self.find_models():
            reached = (resolve_path(model), *self._collect_all_includes(model))
            parts = [self.by_real[real] for real in reached if real in self.by_real]
            if any(part.may_reference(file.name) for part in parts) and any(package in part.text for part in parts):
                users.append(model)
        return users

    def _collect_all_includes(self, path: Path) -> set[Path]:
        """Return the files that a file includes, directly or through others."""
        included: set[Path] = set()
        queue = [resolve_path(path)]
        while queue:
            for inner in self.includes.get(queue.pop(), ()):
                if inner not in included:
                    included.add(inner)
                    queue.append(inner)
        return included


def resolve_path(path: Path) -> Path:
    """Return the real path: the key under which a file counts once, however it is reached."""
    return Path(os.path.realpath(path))


def _iter_files(root: Path, finder: PackageFinder, outside: list[Path]) -> Iterator[Path]:
    """Yield the files below a folder, through links too; append links to places that may not be opened to ``outside``."""
    ignored = _list_git_ignored(root)
    visited: set[str] = set()
    below = [(str(root), os.path.realpath(root))]
    while below:  # not os.walk, which calls itself for each level
        folder, real = below.pop()
        names, files = _list_folder(folder)
        if real in visited or "COLCON_IGNORE" in files or "AMENT_IGNORE" in files or "CATKIN_IGNORE" in files:
            continue
        visited.add(real)
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
    """Return the names of a folder's subfolders, last first, and of everything else in it."""
    try:
        with os.scandir(folder) as entries:
            names = sorted((entry.name for entry in entries), reverse=True)
    except OSError:
        return [], []
    # entry.is_dir() raises for a circular link, os.path.isdir does not.
    folders = {name for name in names if os.path.isdir(os.path.join(folder, name))}
    return [name for name in names if name in folders], [name for name in names if name not in folders]


def _list_git_ignored(root: Path) -> set[str]:
    """Return the files and folders below ``root`` that git ignores; none outside of a work tree or without git."""
    import subprocess

    # The folder may be a stranger's: whatever its own git configuration would start is switched off. In a clone that lacks
    # an object, git would fetch it with any command that this configuration names.
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
    if "./" in names:  # git ignores the given folder itself, but the user asked for it
        return set()
    # A link counts by its own place, not by its target.
    places = [os.path.split(os.path.join(root, name.rstrip("/"))) for name in names]
    return {os.path.join(os.path.realpath(folder), name) for folder, name in places}
