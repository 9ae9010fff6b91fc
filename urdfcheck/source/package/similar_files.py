"""Files of a package that a path which leads nowhere may mean."""

from __future__ import annotations

import difflib
import os
import re
import shlex
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import islice, takewhile
from pathlib import Path, PurePosixPath, PureWindowsPath

from urdfcheck.core.text import SLIP_LIKENESS, join_names, split_name_words
from urdfcheck.source.package.build_files import LARGEST_BUILD_FILE, read_build_type
from urdfcheck.source.package.finder import Package, PackageFinder, format_path
from urdfcheck.source.package.package_folders import BUILD_FOLDERS, list_folders_called
from urdfcheck.source.package.released_packages import read_released_packages
from urdfcheck.source.package.setup_py_installs import read_package_data
from urdfcheck.source.project_folders import find_project_folder
from urdfcheck.source.text.python import parse_python
from urdfcheck.system.files import read_regular, read_text_or_nothing, walk

# Beyond this many files the search stops: a suggestion is not worth seconds.
_MAX_FILES = 20_000
# A shorter word with another letter is another word: `arm` and `art`.
_SHORTEST_SLIP = 4

# So many missing files of one folder that are in one other folder are those that are meant.
MOVED = 3

# The files below some folders, by their names in lower case.
FilesByName = Mapping[str, list[Path]]

# A macro's definition as typed, also without the prefix; so many files of a folder are read, and so much of each.
_MACRO = re.compile(r"<(?:xacro:)?macro\s[^<>]*?\bname\s*=\s*[\"'](?:xacro:)?(\w+)[\"']")
_PROPERTY = re.compile(r"<(?:xacro:)?property\s[^<>]*?\bname\s*=\s*[\"'](\w+)[\"']")
_MOST_MACRO_FILES, _MOST_MACRO_BYTES = 200, 1_000_000
# The folder of a submodule in .gitmodules, of which so much is read.
_SUBMODULE, _MOST_GIT_BYTES = re.compile(r"(?m)^[ \t]*path[ \t]*=[ \t]*(\S.*?)[ \t\r]*$"), 1_000_000
_ADDRESS = re.compile(r"(?m)^[ \t]*url[ \t]*=[ \t]*(\S.*?)[ \t\r]*$")
# The files of vcstool, of which so many are read in a folder, and a repository in one with its address.
_REPOSITORIES, _MOST_REPOSITORY_FILES = re.compile(r"[^.].*(?:\.repos|[._-]repos\.ya?ml|\.rosinstall)"), 10
_REPOSITORY = re.compile(r"(?m)^[ \t]+([\w./-]+):[ \t]*\n(?:[ \t]+(?!url:)\w+:.*\n)*[ \t]+url:[ \t]*(\S+)")
# The address of a repository in the format of rosinstall, which vcstool reads too.
_ROSINSTALL = re.compile(r"\buri:[ \t]*[\"']?([^\s\"',}]+)")
# A text that says how to install, to readers or to Docker, and the address of a repository in it that is cloned.
_INSTALLING = re.compile(
    r"(?i)(?:readme|install|installation|setup)[\w.-]*\.(?:md|rst|txt)|readme|dockerfile(?:[._-][\w.-]+)?"
)
_CLONED = re.compile(r"\bgit clone (?:-{1,2}[\w-]+(?:[ =](?!-)[\w./-]+)? ){0,5}((?:https?://|git@)[\w./:~@-]+\w)")
# The name of one robot of a series: its word and its number, which may end with letters.
_VARIANT = re.compile(r"([a-z_-]+)(\d+[a-z]{0,2})$")
# The package of a file that is installed.
_INSTALLED_IN = re.compile(r"/share/([^/]+)/")
# Words of names; those that packages of all robots have.
_WORD = re.compile(r"[a-z]{3,}")
_WORDS_OF_MANY = frozenset({
    "bringup", "cmake", "common", "config", "control", "demo", "description", "gazebo", "interface", "launch", "model", "models",
    "moveit", "msgs", "package", "packages", "pkg", "robot", "robots", "ros", "simulation", "src", "support", "tools",
})  # fmt: skip
# What folders of meshes are called, whatever the robot is.
_FOLDER_WORDS = frozenset({
    *("3d", "assets", "backup", "bin", "binary", "cad", "col", "collada", "collision", "collisions", "coarse", "convex", "dae"),
    *("description", "fine", "full", "glb", "high", "hull", "low", "lowpoly", "media", "mesh", "meshes", "model", "models"),
    *("new", "obj", "old", "original", "ply", "poly", "res", "resources", "robot", "robots", "share", "simple", "simplified"),
    *("src", "step", "stl", "stls", "textures", "urdf", "vis", "visual", "visuals"),
})  # fmt: skip


def index_files(roots: Iterable[Path]) -> FilesByName:
    """Return the files below some folders by their names in lower case, without hidden and built ones."""
    by_name: dict[str, list[Path]] = {}
    count = 0
    for root in sorted(roots):
        for folder, folders, files in walk(root):
            folders[:] = [f for f in folders if not f.startswith(".") and f not in BUILD_FOLDERS]
            count += len(files)
            if count > _MAX_FILES:
                return by_name
            for name in files:
                by_name.setdefault(name.lower(), []).append(Path(folder, name))
    return by_name


def normalise_path(path: Path) -> Path:
    """Return a path without `..`: two spellings of one file are one cause."""
    return Path(os.path.normpath(path))


def find_slashed_file(path: Path, finder: PackageFinder) -> Path | None:
    """Return the file that a path names with `/` in place of each backslash, which only Windows reads as a separator."""
    meant = Path(str(path).replace("\\", "/"))
    return meant if meant != path and finder.can_open(meant) and meant.is_file() else None


def find_moved_files(missing: Iterable[Path], index: FilesByName) -> dict[Path, Path]:
    """Find the missing files of one folder that are together in another: each with its place there.

    One file of the same name may be another robot's, several are the robot's own.
    """
    by_folder: dict[Path, dict[Path, dict[Path, Path]]] = {}
    for path in sorted(missing):
        for other in index.get(path.name.lower(), []):
            if other.name == path.name and other != path and not is_of_variant(path, other):
                by_folder.setdefault(path.parent, {}).setdefault(other.parent, {}).setdefault(path, other)
    found: dict[Path, Path] = {}
    for folders in by_folder.values():
        most, *others = sorted(folders.values(), key=len, reverse=True)
        # As many in a second folder leave open which one is meant.
        if len(most) >= MOVED and not (others and len(others[0]) == len(most)):
            found |= most
    return found


def find_uninstalled_file(path: Path, package: Package | None, files: FilesByName) -> Path | None:
    """Return the only file of a ROS 2 package that is deeper than a missing path says, with the same last parts.

    The package's build has to install it under that path.
    """
    if package is None or not read_build_type(package.root).startswith("ament_"):
        return None
    plain = Path(os.path.normpath(path.absolute()))
    if not plain.is_relative_to(package.path):
        return None
    tail = plain.relative_to(package.path).parts
    found = [f for f in files.get(path.name.lower(), []) if f.parts[-len(tail) :] == tail and len(tail) > 1]
    return found[0] if len(found) == 1 else None


def select_python_data(
    paths: Iterable[Path], package: Package | None, files: FilesByName, finder: PackageFinder
) -> set[Path]:
    """Return the missing files that setup.py installs at their paths in the Python package with the name of a ROS package.

    Programs that look packages up by ROS do not find them there; those that get the folder of the Python packages do.
    """
    found = {path: find_uninstalled_file(path, package, files) for path in paths}
    if package is None or not any(found.values()) or not finder.can_open(package.path / "setup.py"):
        return set()
    try:
        tree = parse_python(read_regular(package.path / "setup.py", LARGEST_BUILD_FILE).decode("utf-8-sig", "replace"))
    except OSError:
        return set()
    data = None if tree is None else read_package_data(tree, package.name)

    def locate(path: Path) -> str:
        return Path(os.path.relpath(path, package.path)).as_posix()

    return {
        path
        for path, elsewhere in found.items()
        if data is not None and elsewhere is not None and data.has_file(locate(elsewhere), locate(path))
    }


def read_defined_macros(files: Iterable[Path], finder: PackageFinder) -> dict[str, set[str]]:
    """Return the names of the macros that xacro files define, by the name of the file, as far as they may be opened."""
    return _read_defined(_MACRO, files, finder)


def read_defined_properties(files: Iterable[Path], finder: PackageFinder) -> dict[str, set[str]]:
    """Return the names of the properties that xacro files define in the same way."""
    return _read_defined(_PROPERTY, files, finder)


def _read_defined(pattern: re.Pattern[str], files: Iterable[Path], finder: PackageFinder) -> dict[str, set[str]]:
    defined: dict[str, set[str]] = {}
    for path in islice((p for p in files if p.suffix == ".xacro" and finder.can_open(p)), _MOST_MACRO_FILES):
        try:
            text = read_regular(path, _MOST_MACRO_BYTES).decode("utf-8", "replace")
        except OSError:
            continue
        defined[path.name] = set(pattern.findall(text))
    return defined


def find_files_elsewhere(written: str, user: Path, finder: PackageFinder) -> list[Path]:
    """Return the files that a path of another machine may mean: those of its name in the package of the file that has the path.

    Of several those count whose folders are the most like. Without one it is the only file of the project that is in a folder
    of that name, too; where there is no package, the folder's name does not matter. An installed file (share/NAME/…) is in no
    package of another name.

    :param user: the file that has the path.
    """
    there, own = PureWindowsPath(written), user.absolute()
    package = finder.find_package_of(own)
    project = find_project_folder(user)
    for root in [project] if package is None else [package.path, project]:
        named = [path for path in index_files([root]).get(there.name.lower(), []) if path.name == there.name]
        named = [path for path in named if root != project or not _is_of_other_package(path, there, finder)]
        likeness = {p: _count_like_parts(p.parts, there.parts) for p in named if p != own and finder.can_open(p)}
        best = [path for path, number in likeness.items() if number == max(likeness.values())]
        if best and package is not None and root == package.path:
            return best
        if len(best) == 1 and (package is None or likeness[best[0]] > 1):
            return best
    return []


def _is_of_other_package(path: Path, written: PureWindowsPath, finder: PackageFinder) -> bool:
    """Whether a path of another machine names a package that is installed there, and a file is in one of another name."""
    installed, package = _INSTALLED_IN.search(written.as_posix()), finder.find_package_of(path)
    return installed is not None and package is not None and package.name != installed[1]


def _count_like_parts(one: Sequence[str], other: Sequence[str]) -> int:
    """Count the last parts that two paths share."""
    pairs = zip(reversed(one), reversed(other), strict=False)
    return sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], pairs))


def propose_checkout(package: str, finder: PackageFinder) -> str:
    """Return how the submodule of git is checked out that is this package and has no files; empty if there is none."""
    own = next((path for path in list_missing_submodules(finder) if PurePosixPath(path).name == package), None)
    return "" if own is None else f"check out its submodule: `git submodule update --init {shlex.quote(own)}`"


def propose_checkout_around(file: Path, finder: PackageFinder) -> str:
    """Return how the submodule is checked out in whose empty folder a missing file would be; empty if there is none."""
    proposals = (propose_checkout(folder.name, finder) for folder in file.parents if _is_empty(folder))
    return next(filter(None, proposals), "")


def add_checkout(repair: str, package: str, finder: PackageFinder) -> str:
    """Add to a repair that a package may be in a submodule of git which is not checked out: first if a name suggests it."""
    missing = list_missing_submodules(finder)
    alike = select_similar_submodules(missing, [package])
    if alike:
        first = f"if it is in a submodule ({join_names(alike, 3)}), check that out: `git submodule update --init`"
        return f"{first}; otherwise {repair}"
    clone = propose_clone(package, finder)
    if clone:
        return f"{clone}; otherwise {repair}"
    for file, repositories in _list_repositories(finder):
        listed = select_similar_submodules(repositories, [package])
        if listed:
            place = shlex.quote(format_path(file))
            return f"if it is in {join_names(listed, 2)} of {file.name}, import that: `vcs import < {place}`; otherwise {repair}"
    unlike = [] if package in read_released_packages() else _list_outer_submodules(missing, finder)
    if unlike:
        unread = join_names(unlike, 3)
        return f"{repair}; if a submodule that is not checked out has it ({unread}), `git submodule update --init`"
    return repair


def propose_clone(package: str, finder: PackageFinder) -> str:
    """Return how the repository that has the name of a package is obtained, as a file of the project says; empty if none does."""
    for file, repositories in _list_repositories(finder):
        if any(package in {_cut_path(name), _cut_path(url)} for name, url in repositories.items()):
            return f"import its repository, which {file.name} lists: `vcs import < {shlex.quote(format_path(file))}`"
    documented = _find_documented_clone(package, finder)
    if documented is None:
        return ""
    file, address = documented
    return f"clone its repository, as {file.name} says: `git clone {address}`"


def propose_download(folder: str, finder: PackageFinder) -> str:
    """Return where it is said that a folder is downloaded, as a repair: a line of a text around the start that says how to
    install; empty if none does."""
    said = re.compile(
        rf"(?mi)^(?=.*\bdownload)(?=.*\b(?:folder|director(?:y|ies))\b).*(?<![\w./-]){re.escape(folder)}(?![\w./-])"
    )
    file = next((file for file, text in _iter_texts_around(_INSTALLING, finder) if said.search(text)), None)
    return "" if file is None else f"download {folder}, as {file.name} says; else correct the path"


def find_naming_text(package: str, finder: PackageFinder) -> Path | None:
    """Return a text around the start that says how to install, and names a package of several words as one that is needed.

    A heading may name the project itself, and a command that starts a program may have the old name of a package.
    """
    if "_" not in package:
        return None
    named = re.compile(
        rf"(?m)^(?![ \t]*#).*(?<![\w-])(?<!launch )(?<!run ){re.escape(package)}(?![\w-])", re.IGNORECASE
    )
    return next((file for file, text in _iter_texts_around(_INSTALLING, finder) if named.search(text)), None)


def find_empty_folder(package: str, top: Path, finder: PackageFinder) -> Path | None:
    """Return the folder of a package's name in a repository, ``top``, that is empty although its clone has it."""
    submodules = list_missing_submodules(finder)
    empty = (folder for folder in list_folders_called(package, top) if finder.can_open(folder) and _is_empty(folder))
    return next((folder for folder in empty if folder.relative_to(top).as_posix() not in submodules), None)


def _list_outer_submodules(submodules: Iterable[str], finder: PackageFinder) -> list[str]:
    """Return the submodules that are in no package of the repository: build tools look for packages in no other package, and what
    is there are its libraries."""
    top = next((level for level in finder.list_parent_folders() if (level / ".gitmodules").is_file()), None)
    return [
        path
        for path in submodules
        if top is not None and not any((outer / "package.xml").is_file() for outer in _list_folders_around(top, path))
    ]


def _list_folders_around(top: Path, path: str) -> list[Path]:
    return [top / outer for outer in PurePosixPath(path).parents if ".." not in outer.parts]


def select_similar_submodules(submodules: Mapping[str, str], packages: Iterable[str]) -> list[str]:
    """Return those submodules whose folder or address shares a word with the name of a package."""
    words = {word for package in packages for word in _list_words(package)}
    return [path for path, url in submodules.items() if words & {*_list_words(path), *_list_words(url)}]


def _list_words(name: str) -> set[str]:
    """Return the words of the last part of a path or an address, without those that say nothing about whose it is."""
    return {*_WORD.findall(_cut_path(name).lower())} - _WORDS_OF_MANY


def _cut_path(name: str) -> str:
    """Return the name of a repository: the last part of its path or its address."""
    return PurePosixPath(name).name.removesuffix(".git")


def list_missing_submodules(finder: PackageFinder) -> dict[str, str]:
    """Return the submodules of the repository around the start whose folders are missing or empty, with their addresses."""
    for folder in finder.list_parent_folders():
        names = folder / ".gitmodules"
        if not finder.can_open(folder / "package.xml") or names.is_symlink():  # a hidden file itself is never in reach
            continue
        try:
            sections = read_regular(names, _MOST_GIT_BYTES).decode("utf-8", "replace").split("[submodule")
        except OSError:
            continue
        pairs = [(_SUBMODULE.search(section), _ADDRESS.search(section)) for section in sections]
        known = {path[1]: "" if url is None else url[1] for path, url in pairs if path is not None}
        return {path: url for path, url in known.items() if finder.can_open(folder / path) and _is_empty(folder / path)}
    return {}


def _list_repositories(finder: PackageFinder) -> list[tuple[Path, dict[str, str]]]:
    """Return the files of vcstool around the start that list repositories to import: by the name of each its address."""
    return [
        (file, dict(_REPOSITORY.findall(text)) | {url: url for url in _ROSINSTALL.findall(text)})
        for file, text in _iter_texts_around(_REPOSITORIES, finder)
    ]


def _find_documented_clone(package: str, finder: PackageFinder) -> tuple[Path, str] | None:
    """Return a text around the start that says how to clone the repository of this name, and its address."""
    for file, text in _iter_texts_around(_INSTALLING, finder):
        address = next((found for found in _CLONED.findall(text) if _cut_path(found) == package), None)
        if address is not None:
            return file, address
    return None


def _iter_texts_around(names: re.Pattern[str], finder: PackageFinder) -> Iterator[tuple[Path, str]]:
    """Yield the files of such ``names`` in the folders around the start and in the packages there, each with its text."""
    for folder in dict.fromkeys([*finder.list_parent_folders(), *finder.list_workspace_packages().values()]):
        try:
            found = sorted(filter(names.fullmatch, os.listdir(folder)))
        except OSError:
            continue
        for file in (folder / name for name in found[:_MOST_REPOSITORY_FILES]):
            if finder.can_open(file):
                yield file, read_text_or_nothing(file, _MOST_GIT_BYTES)


def _is_empty(folder: Path) -> bool:
    try:
        return not os.listdir(folder)
    except FileNotFoundError:
        return True
    except OSError:
        return False


def describe_uninstalled_file(file: Path) -> str:
    """Return the end of a message about a path for which :func:`find_uninstalled_file` has found this file."""
    return f" (found in {format_path(file.parent)}; is that installed?)"


def find_similar_name(name: str, others: Iterable[str]) -> str | None:
    """Return the name of a file with the same words as ``name`` in its stem, or with a slip in one of them.

    A name with another word (``base_link.stl`` for ``arm_link.stl``) or another number is that of another part.
    """
    alike = [other for other in others if other != name and _have_same_words(Path(name).stem, Path(other).stem)]
    return max(sorted(alike), key=lambda other: difflib.SequenceMatcher(None, name, other).ratio(), default=None)


def is_of_variant(path: Path, other: Path) -> bool:
    """Whether two paths part at folders of two robots of one series: `ur5e` and `ur10`."""
    parts = next(((a, b) for a, b in zip(path.parts, other.parts, strict=False) if a != b), ("", ""))
    one, two = (_VARIANT.match(part.lower()) for part in parts)
    return one is not None and two is not None and one[1] == two[1] and one[2] != two[2]


def _have_same_words(first: str, second: str) -> bool:
    words, others = ([word.lower() for word in split_name_words(stem)] for stem in (first, second))
    if "".join(words) == "".join(others):
        return True
    return len(words) == len(others) and all(map(_is_same_word, words, others))


def _is_same_word(word: str, other: str) -> bool:
    if word == other:
        return True
    is_long = min(len(word), len(other)) >= _SHORTEST_SLIP and not (word + other).isdigit()
    is_swapped = sorted(word) == sorted(other) and sum(a != b for a, b in zip(word, other, strict=True)) == 2
    return is_long and (is_swapped or difflib.SequenceMatcher(None, word, other).ratio() >= SLIP_LIKENESS)


def is_in_folder_of_another(path: Path, other: Path) -> bool:
    """Whether a file is in a folder that is neither on the way to a missing one nor named after what it holds.

    ``gripper/base.stl`` is not the ``base.stl`` of an arm; ``visual/base.stl`` may be.
    """
    path, other = path.absolute(), other.absolute()
    common = Path(os.path.commonpath([path, other]))
    names = {word for part in path.parts for word in split_folder_words(part)}
    return any(not split_folder_words(part) <= names | _FOLDER_WORDS for part in other.parent.relative_to(common).parts)


def is_called_as_any(folder: str) -> bool:
    """Whether a folder has a name that folders of meshes of any robot have (``visual``, ``meshes``)."""
    return split_folder_words(folder) <= _FOLDER_WORDS


def split_folder_words(name: str) -> set[str]:
    """Return the words of a folder's name in lower case."""
    return {word for word in re.split(r"[^a-z0-9]+", name.lower()) if word}
