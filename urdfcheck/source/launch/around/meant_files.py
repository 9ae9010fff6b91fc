"""The files that a launch file may mean where it names one that does not exist. Each is tried before it is
named."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

from urdfcheck.core.text import find_nearest_name, join_names
from urdfcheck.source.launch.launch_file import BrokenInclude, list_declared_arguments, load_launch
from urdfcheck.source.launch.substitutions import may_become
from urdfcheck.source.model_file import compile_includes
from urdfcheck.source.package.file_kinds import LAUNCH_SUFFIXES, MODEL_SUFFIXES, SRDF_SUFFIXES
from urdfcheck.source.package.finder import PackageFinder, format_path
from urdfcheck.source.package.similar_files import find_slashed_file, index_files, normalise_path
from urdfcheck.source.project_folders import find_project_folder
from urdfcheck.source.text.xml import Element, SourceFile, XmlError, parse_xml
from urdfcheck.source.xacro.file_contents import can_have_name, defines_macros, has_parts, is_include
from urdfcheck.system.files import read_text_or_nothing

_XACRO, _PYTHON = ".xacro", ".py"
# What tells the names of the packages of a series apart.
_VERSIONS = (re.compile(r"[_-]?v?\d+[a-z]{0,2}$"), re.compile(r"\d+[a-z]{0,2}(?=[_-])"))
# So many xacro files are searched for one that includes another.
_MOST_INCLUDERS = 1_000
# Whether a file would do in the place of the missing one.
Trial = Callable[[Path], bool]


def describe_meant_file(path: str, finder: PackageFinder, is_right: Trial, *, is_expanded: bool = True) -> str:
    """Return the end of a message about a missing file that names the one which is probably meant; empty without one.

    It has a similar name in the same folder, or is the only one of its name in the repository. Many packages have a
    ``gazebo.launch``: of launch files it is in the same package.

    :param is_expanded: whether xacro expands the file.
    """
    if find_slashed_file(Path(path), finder) is not None:
        return "; with `/` in place of each backslash it exists"
    folder, wanted = Path(path).parent, Path(path).name
    if not finder.can_open(folder / "any"):  # the report must not reveal files out of reach
        return ""
    try:
        names = sorted(entry.name for entry in folder.iterdir() if entry.is_file())
    except OSError:
        return (
            _describe_only_file(path, finder, is_right) or f"; the folder {format_path(folder)} does not exist either"
        )
    stem = wanted.partition(".")[0]
    namesakes = [name for name in names if name.partition(".")[0] == stem and is_right(folder / name)]
    namesakes = [name for name in namesakes if name == wanted + _XACRO] or namesakes
    if len(namesakes) == 1 and namesakes[0].endswith(_XACRO) and not (wanted.endswith(_XACRO) or is_expanded):
        return f" (there is {namesakes[0]!r}, which xacro must expand)"
    others = [name for name in names if _get_kind(name) == _get_kind(wanted)]
    near = namesakes[0] if len(namesakes) == 1 else find_nearest_name(wanted, namesakes or others)
    if near is not None and is_right(folder / near):
        return f" (did you mean {near!r}?)"
    return _describe_only_file(path, finder, is_right)


def _get_kind(name: str) -> str:
    kinds = (SRDF_SUFFIXES, MODEL_SUFFIXES, LAUNCH_SUFFIXES)
    return next((suffixes[0] for suffixes in kinds if name.lower().endswith(suffixes)), Path(name).suffix.lower())


def _describe_only_file(path: str, finder: PackageFinder, is_right: Trial) -> str:
    """Name the file that a path may have meant, if the repository has one of this name elsewhere."""
    only = _find_only_file(Path(path), finder)
    if only is None:
        return ""
    if is_right(only):
        return f" (the only file of this name here is {format_path(only)})"
    if not (only.name.endswith(_XACRO) and _is_of_macros(only, finder)):
        return ""
    # Its macros make no robot until a file calls them.
    callers = _find_includers(only, finder)
    callers = list(filter(is_right, callers)) or callers
    wanted = normalise_path(Path(path).absolute()).parent
    callers = [caller for caller in callers if normalise_path(caller.absolute()).parent == wanted] or callers
    listed = join_names(map(format_path, callers), 2)
    shown = (
        f"{listed} {'includes' if len(callers) == 1 else 'include'} it" if callers else "name a file that calls them"
    )
    return f" ({format_path(only)} only defines macros; {shown})"


def _find_only_file(path: Path, finder: PackageFinder) -> Path | None:
    """Return the file with the name of a missing one, if there is one in the repository; of launch files, in the package."""
    folder = find_project_folder(finder.start)
    if _get_kind(path.name) == LAUNCH_SUFFIXES[0]:
        package = finder.find_package_of(normalise_path(path.absolute()))
        if package is None:
            return None
        folder = package.path
    found = [other for other in index_files([folder]).get(path.name.lower(), ()) if other.name == path.name]
    found = [other for other in found if not _is_of_another_version(path, other, finder)]
    return found[0] if len(found) == 1 and finder.can_open(found[0]) else None


def _is_of_another_version(path: Path, other: Path, finder: PackageFinder) -> bool:
    """Whether two files are in packages of two robots of a series, and so of both: ``arm`` and ``arm_2``, or ``arm5_model`` and
    ``arm10_model``."""
    packages = [finder.find_package_of(normalise_path(place.absolute())) for place in (path, other)]
    one, two = ("" if package is None else package.name for package in packages)
    return one != two and any(version.sub("", one) == version.sub("", two) for version in _VERSIONS)


def _find_includers(part: Path, finder: PackageFinder) -> list[Path]:
    """Return the xacro files of the repository that include a file of this name."""
    index = index_files([find_project_folder(finder.start)])
    files = sorted({path for paths in index.values() for path in paths if path.name.endswith(_XACRO)})
    including = compile_includes([part.name])
    readable = (path for path in files[:_MOST_INCLUDERS] if path != part and finder.can_open(path))
    return [path for path in readable if including.search(read_text_or_nothing(path))]


def _read_tree(path: Path, finder: PackageFinder) -> Element | None:
    """Return the root of a file in XML; None if it is not, or may not be opened."""
    try:
        return parse_xml(SourceFile.read(path, path.name)) if finder.can_open(path) else None
    except (OSError, XmlError):
        return None


def _is_of_macros(path: Path, finder: PackageFinder) -> bool:
    """Whether a xacro file defines macros and makes no link and no joint."""
    root = _read_tree(path, finder)
    return root is not None and defines_macros(root) and not has_parts(root)


def makes_robot(path: Path, finder: PackageFinder) -> bool:
    """Whether a file is a robot by itself: it has a name, and links or what makes them.

    A file of macros makes an empty one, and a part takes the file that includes it.
    """
    root = None if path.name.lower().endswith(SRDF_SUFFIXES) else _read_tree(path, finder)
    if root is None or root.tag != "robot" or not can_have_name(root):
        return False
    return has_parts(root) or (not defines_macros(root) and any(map(is_include, root.walk())))


def is_semantic(path: Path, finder: PackageFinder) -> bool:
    """Whether a file is a semantic description."""
    root = _read_tree(path, finder) if path.name.lower().endswith(SRDF_SUFFIXES) else None
    return root is not None and root.tag == "robot"


def can_be_included(path: Path, wanted: str, including: Sequence[Path], finder: PackageFinder) -> bool:
    """Whether a launch file can take the place of a missing one: it is in the same language, and does not include those that
    would include it.

    :param including: the launch files that lead to the include.
    """
    if not path.name.lower().endswith((*LAUNCH_SUFFIXES, Path(wanted).suffix.lower())) or not finder.can_open(path):
        return False
    if (path.suffix == _PYTHON) != wanted.endswith(_PYTHON):
        return False
    around = {os.path.realpath(file) for file in including}
    if os.path.realpath(path) in around:
        return False
    if path.suffix == _PYTHON:
        text = read_text_or_nothing(path)
        return "LaunchDescription" in text and not any(file.name in text for file in including)
    root = _read_tree(path, finder)
    if root is None or root.tag != "launch":
        return False
    return all(os.path.realpath(file.path) not in around for file in load_launch(path, finder).files.values())


def takes_arguments(path: Path, include: BrokenInclude, finder: PackageFinder, *, is_ros2: bool) -> bool:
    """Whether a launch file in XML takes what an include passes, and needs nothing else. ROS 2 passes on what is not declared."""
    root = _read_tree(path, finder)
    if root is None:
        return False
    arguments = list_declared_arguments(root)
    names = [argument.get("name") for argument in arguments]
    needed = {a.get("name") for a in arguments if not {"default", "value"} & a.attributes.keys()}
    passes_all = is_ros2 or include.at.owner.get("pass_all_args") in {"true", "1"}
    takes_all = is_ros2 or all(may_be_declared(name, names) for name in include.passed_names)
    return takes_all and (passes_all or needed <= {*include.passed_names})


def may_be_declared(name: str, declared: Iterable[str]) -> bool:
    """Whether an argument has one of these names, of which launch files may compute a part: ``$(arg robot)_ip``."""
    return any(may_become(typed, name) for typed in declared)


def describe_handing(handed: str, file: Path | None, finder: PackageFinder) -> tuple[str, bool]:
    """Say what to do about a line of an include that passes an unknown argument on as ``handed``, and whether declaring the
    unknown one is a repair too. Empty where the included file cannot be read as XML."""
    root = None if file is None or not handed else _read_tree(file, finder)
    if root is None or file is None:
        return "", True
    line, names = f'delete `<arg name="{handed}" …/>` from the include', list_declared_arguments(root)
    found = [argument for argument in names if may_be_declared(handed, [argument.get("name")])]
    if not found:
        return f"{line}: {file.name} declares no {handed}, so roslaunch refuses it", False
    if all("value" in argument.attributes for argument in found):
        return f"{line}: {file.name} gives {handed} a fixed value, which roslaunch does not replace", False
    if all("default" in argument.attributes for argument in found):
        return f"{line}: {file.name} has a default for it", True
    return "", True
