"""Which launch files of a package load a file, with which model and which argument."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path

from urdfcheck.core.text import compile_names
from urdfcheck.source.launch.passed_arguments import (
    MOST_FOLDERS,
    MOST_LAUNCHES,
    iter_launch_files,
    may_pass_argument,
    passes_to_any_model,
)
from urdfcheck.source.launch.python_launch_file import MAX_PYTHON
from urdfcheck.source.package.finder import PackageFinder, format_path, has_dependency_entry
from urdfcheck.source.package.package_folders import drop_comments
from urdfcheck.source.project_folders import find_project_folder
from urdfcheck.system.files import read_text_or_nothing, walk

# The name of a model's file, as far as it is typed: `.urdf.xacro` alone ends a computed name.
_MODEL_NAME = re.compile(r"(?<![\w.-])[\w.-]*\.(?:urdf|xacro)\b")

# The name of a file of which a variable is one part: `f"arm_{dof}dof.urdf"`.
_NAME_WITH_VARIABLE = re.compile(r"(?<![\w.-])([\w.-]*)\{(\w+)\}([\w.-]*\.(?:ya?ml|urdf|xacro))\b")

# What is typed of a computed name before the part that is computed: `"arm_" + kind`, `urdf/arm_$(arg kind)`, `f"arm_{kind}"`.
_BEGIN_OF_NAME = re.compile(r"""(?<![\w.-])([\w.-]+)(?:["']\s*[+,]|\$\(|\{)""")

# The parts of a command of xacro on the model that an argument names, and what ends such a command.
_XACRO, _ANY_MODEL, _BORDERS = (
    re.compile(r"xacro\b"),
    re.compile(r"""\s['"]?\$\(arg [^()]*\)['"]?\s"""),
    re.compile(r"[<>\n]"),
)
# An include of a file that an argument names as a whole.
_INCLUDED = re.compile(r"""<xacro:include\s[^<>]*?filename=["']\$\(arg\s+([\w.-]+)\s*\)["']""")


def is_started_with_another(path: Path, model: Path, finder: PackageFinder) -> bool:
    """Whether launch files of the package of a file load it, and all of these name other models' files, not this model's."""
    is_loaded, named = False, compile_names((path.name,))
    for _, text in _iter_package_launches(path, finder):
        is_named = named.search(text) is not None
        names = set(_MODEL_NAME.findall(text)) if is_named else _list_models_of_variant(path, text)
        if not is_named and not names:
            continue
        if not names or model.name in names or any(name.startswith(".") for name in names):
            return False
        is_loaded = True
    return is_loaded


def _list_models_of_variant(path: Path, text: str) -> set[str]:
    """Return the models that a launch file loads when a variable has the value with which it loads a file:
    ``f"arm_{dof}dof.urdf"`` beside ``f"controllers_{dof}dof.yaml"``."""
    computed = [match.groups() for match in _NAME_WITH_VARIABLE.finditer(text)]
    values = {
        (variable, path.name[len(begin) : -len(end)])
        for begin, variable, end in computed
        if path.name.startswith(begin) and path.name.endswith(end) and len(path.name) > len(begin) + len(end)
    }
    models = [parts for parts in computed if parts[2].endswith((".urdf", ".xacro"))]
    return {begin + value + end for name, value in values for begin, variable, end in models if variable == name}


def is_named_by_launch(path: Path, finder: PackageFinder) -> bool:
    """Whether a launch file of the package of a model's file, or of one that depends on it, names the file, or computes a name
    that may be its own."""
    named = compile_names((path.name,))
    texts = (text for _, text in _iter_package_launches(path, finder, with_dependents=True))
    return any(named.search(text) is not None or _may_compute_name(path, text) for text in texts)


def find_naming_launch(path: Path, finder: PackageFinder) -> Path | None:
    """Return a launch file of the package of a model's file that names the file."""
    return next((launch for launch, _ in _iter_launch_texts(path, finder)), None)


def find_passing_launch(path: Path, name: str, finder: PackageFinder) -> Path | None:
    """Return a launch file of the package of a model's file, or of one that depends on it, that names it and passes an argument
    of this name.

    One that computes the name counts too: ``"arm_" + kind + ".urdf.xacro"`` may be the name of any file that ends so. So does one
    of the project that starts whichever model it is given, and passes the argument to each.
    """
    launches = list(_iter_package_launches(path, finder, with_dependents=True))
    named = compile_names((path.name,))
    naming = (item for item in launches if named.search(item[1]) is not None)
    found = itertools.chain(naming, (item for item in launches if _may_compute_name(path, item[1])))
    own = next((launch for launch, _ in found if may_pass_argument(launch, name)), None)
    return own or next(_iter_starting_launches(path, name, finder), None)


def find_handing_launch(path: Path, finder: PackageFinder) -> tuple[Path, str] | None:
    """Return a launch file that names a xacro file beside an argument whose value a model of the project includes, and that
    argument: ``extra_xacro:=…/gazebo.xacro`` of ``<xacro:include filename="$(arg extra_xacro)"/>``. The file is a part there."""
    named = compile_names((path.name,))
    naming = [
        (launch, text)
        for launch, text in _iter_package_launches(path, finder, with_dependents=True)
        if named.search(text)
    ]
    included = _collect_included_arguments(find_project_folder(path.absolute()), finder) if naming else ()
    return next(
        ((launch, name) for launch, _ in naming for name in included if may_pass_argument(launch, name)),
        None,
    )


def describe_handing(launch: Path, argument: str) -> str:
    """Say when nothing is to be done about a file that a launch file hands to a model which includes it."""
    return f"nothing if {format_path(launch)} only hands the file to a model that includes it ($(arg {argument}))"


@lru_cache(maxsize=1)  # a run asks for each model of a project that fails
def _collect_included_arguments(project: Path, finder: PackageFinder) -> tuple[str, ...]:
    """Return the arguments of which the xacro files of a project include the value, whatever file that is."""
    found: set[str] = set()
    for place, names, files in itertools.islice(walk(project), MOST_FOLDERS):
        names[:] = [name for name in names if not name.startswith(".")]
        for file in (Path(place, name) for name in files if name.endswith((".xacro", ".urdf"))):
            found.update(_INCLUDED.findall(read_text_or_nothing(file, MAX_PYTHON)) if finder.can_open(file) else ())
    return tuple(sorted(found))


def _iter_starting_launches(path: Path, name: str, finder: PackageFinder) -> Iterator[Path]:
    """Yield the launch files of the project around a file that start a model of any name with an argument of this name."""
    package = finder.find_package_of(path.absolute())
    folder = path.absolute().parent if package is None else package.path
    project = finder.find_project_above(folder) or folder
    if not finder.can_open(project):
        return
    for launch in itertools.islice(iter_launch_files(project, finder), MOST_LAUNCHES):
        is_python = launch.suffix == ".py"
        if passes_to_any_model(launch, name, finder) if is_python else _starts_any_model(_read_text(launch), name):
            yield launch


def _starts_any_model(text: str, name: str) -> bool:
    """Whether a text has a command of xacro, in one line or tag, with an argument as the model and a value for another one."""
    assigned = re.compile(rf"(?<![\w.-]){re.escape(name)}:=")
    for line in _BORDERS.split(text):
        # One search after the other: a pattern of all of them would search to the end of the line from each word.
        command = _XACRO.search(line)
        model = None if command is None else _ANY_MODEL.search(line, command.end())
        if model is not None and assigned.search(line, model.end()):
            return True
    return False


def _iter_launch_texts(path: Path, finder: PackageFinder) -> Iterator[tuple[Path, str]]:
    """Yield the launch files of the package of a file that name it, each with its text."""
    named = compile_names((path.name,))
    return ((launch, text) for launch, text in _iter_package_launches(path, finder) if named.search(text))


def _may_compute_name(path: Path, text: str) -> bool:
    """Whether a launch file types the begin and the end of a file's name, and may compute what is between them."""
    ends = {name for name in _MODEL_NAME.findall(text) if name.startswith((".", "_"))}
    begins = _BEGIN_OF_NAME.findall(text)
    return any(path.name.endswith(end) for end in ends) and any(map(path.name.startswith, begins))


def _iter_package_launches(
    path: Path, finder: PackageFinder, *, with_dependents: bool = False
) -> Iterator[tuple[Path, str]]:
    """Yield the launch files of the package of a file, and of those that depend on it if asked, each with its text."""
    package = finder.find_package_of(path.absolute())
    if package is None or not finder.can_open(package.path):
        return
    others = finder.list_workspace_packages().values() if with_dependents else ()
    dependents = [
        f for f in others if f != package.path and has_dependency_entry(f, package.name) and finder.can_open(f)
    ]
    launches = (launch for folder in (package.path, *dependents) for launch in iter_launch_files(folder, finder))
    for launch in itertools.islice(launches, MOST_LAUNCHES):
        text = _read_text(launch)
        yield launch, text


def _read_text(launch: Path) -> str:
    """Return the text of a launch file without its comments; empty if it cannot be read."""
    return drop_comments(read_text_or_nothing(launch, MAX_PYTHON))
