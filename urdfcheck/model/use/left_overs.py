"""Models that are left in a package and no longer used."""

from __future__ import annotations

import itertools
import os
import re
from collections.abc import Iterable, Iterator
from pathlib import Path

from urdfcheck.core.text import compile_names
from urdfcheck.source.load import Source, read_xacro_source
from urdfcheck.source.model_file import names_file
from urdfcheck.source.package.file_kinds import is_launch, is_srdf
from urdfcheck.source.package.installed_folders import read_install_rules
from urdfcheck.source.package.package_folders import drop_comments, iter_package_texts
from urdfcheck.source.package.similar_files import find_files_elsewhere
from urdfcheck.source.project_folders import find_project_folder
from urdfcheck.source.ros.gazebo_paths import read_model_config
from urdfcheck.source.uses_elsewhere import (
    CALLER_SUFFIXES,
    MODEL_FILE,
    SCRIPT_SUFFIXES,
    computes_name,
    drop_outputs,
    get_stem,
    is_kept_as_source,
    is_named_nowhere,
    iter_project_files,
    iter_user_texts,
    iter_using_folders,
)
from urdfcheck.source.xacro.file_contents import can_have_name
from urdfcheck.system.files import read_text_or_nothing, walk

_LARGEST = 500_000
# The endings of programs that may load a model, beside those of scripts; of all files that may name one outside packages, of
# which so many are read.
_PROGRAMS = (
    *(".ipynb", ".m", ".c", ".cc", ".cpp", ".cxx", ".h", ".hpp", ".cs", ".rs"),
    *(".js", ".jsx", ".ts", ".tsx", ".vue", ".html"),
)
_NAMING = (*CALLER_SUFFIXES, *_PROGRAMS, ".sdf", ".world")
# Also what lists models without using them: configurations and baselines of checkers.
_LISTS = (".json", ".toml")
_MOST_FILES = 1_000
# What is in a file has a name of its own, and so has a model of SDF; that a link of a robot has the name loads no file.
_NAME_OF_CONTENT = re.compile(r"""<(?:robot|model|(?:xacro:)?macro)\s+name\s*=\s*(?:"[^"]*"|'[^']*')""")
_ROBOT = re.compile(r"<link\s")
# A program that loads whatever models are in a folder.
_ALL_MODELS = re.compile(r"\*\.(?:urdf|xacro)\b")


def is_left_over(source: Source) -> bool:
    """Whether no file of the project names the model, and one names another model of its package (of the project without one),
    xacro made it of a file that is here or into the folder of a model of Gazebo, or the build of its package installs other files
    and not this one.

    False for a piece of a robot, for one that is called as its package is and was not made of a file here, and where one of the
    files that could name the model computes such a name, or has its name without the ending in quotes. Outside the packages that
    name the model's, only programs and READMEs are searched.
    """
    if _may_be_piece(source) or (_has_name_of_package(source) and not _is_made_of_file_here(source)):
        return False
    texts = _read_project_texts(source) if source.package is None else _read_package_texts(source)
    if not texts or _is_stem_named(source, texts):
        return False
    top = find_project_folder(source.path.absolute()) if source.package is None else source.package.path
    others = _list_other_models(top, source.path)
    names_another = any(others.intersection(MODEL_FILE.findall(text)) for text in texts)
    is_unused = (
        names_another
        or _is_made_of_file_here(source)
        or _is_not_installed(source)
        or _is_beside_model_of_gazebo(source)
    )
    # Last what reads most files.
    return is_unused and not is_kept_as_source(source) and not _is_named_outside_packages(source)


def _is_stem_named(source: Source, texts: Iterable[str]) -> bool:
    """Whether one of the texts without links has the model's name without the ending in quotes, or as that of a package, and none
    here is called so. A condition that compares with the name loads nothing."""
    if get_stem(source) in source.finder.list_workspace_packages():
        return False
    name = re.escape(get_stem(source))
    stem = re.compile(rf"(?<![=!]=)(?<![=!]= )[\"']{name}[\"']|\(find {name}\)|package://{name}/")
    return any(stem.search(_NAME_OF_CONTENT.sub("", text)) for text in texts if not _ROBOT.search(text))


def _read_package_texts(source: Source) -> list[str]:
    """Read the texts that could name a model of a package; none where one names it, or computes such a name."""
    if not is_named_nowhere(source):
        return []
    texts = [drop_comments(text) for _, text in iter_user_texts(source)]
    is_computed = any(computes_name(text, source.path.name) for text in texts)
    return [] if is_computed else [*texts, *_read_texts_about_package(source)]


def _read_project_texts(source: Source) -> list[str]:
    """Read the texts that could start a model outside packages; none where one names it or computes such a name, where there are
    too many, and where another model includes it."""
    own = compile_names((source.path.name,))
    texts = []
    for _, text in () if source.is_part else itertools.islice(iter_project_files(source, _NAMING), _MOST_FILES):
        plain = drop_comments(text)
        if own.search(plain) or computes_name(plain, source.path.name) or _ALL_MODELS.search(plain):
            return []
        texts.append(plain)
    return [] if len(texts) == _MOST_FILES else texts


def _is_made_of_file_here(source: Source) -> bool:
    """Whether xacro wrote the model, and the file that it was made of is in the project."""
    written = read_xacro_source(source.files[source.name].text) if source.is_output_of_xacro else None
    return written is not None and bool(find_files_elsewhere(written, source.path, source.finder))


def _is_not_installed(source: Source) -> bool:
    """Whether the build of a ROS 2 package that starts something installs files, and certainly not this one."""
    package = source.package
    rules = None if package is None else read_install_rules(package)
    installed = None if rules is None else rules.installed
    if package is None or installed is None or not installed.entries:
        return False
    if not any(is_launch(path) for path, _ in iter_user_texts(source)):  # the package may not be finished
        return False
    inside = source.path.absolute().relative_to(package.path.absolute())
    return installed.function_words.isdisjoint(inside.parts) and not installed.may_install(inside.as_posix())


def _is_beside_model_of_gazebo(source: Source) -> bool:
    """Whether xacro wrote the model into the folder of a model of Gazebo, which loads the SDF that model.config names."""
    if not source.is_output_of_xacro:
        return False
    project = find_project_folder(source.path.absolute())
    around = [folder for folder in source.path.absolute().parents if project in folder.parents]
    loaded = [name for folder in around for name in read_model_config(folder, source.finder.can_open)]
    return bool(loaded) and all(name.endswith(".sdf") for name in loaded)


def _has_name_of_package(source: Source) -> bool:
    """Whether the model is called as its package is, which says that it is the robot."""
    name = "" if source.package is None else source.package.name
    return get_stem(source) in {name, name.removesuffix("_description"), name.removesuffix("_urdf")}


def _may_be_piece(source: Source) -> bool:
    """Whether the model may be included by a name that is computed: its <robot> has none. So may one that is called a semantic
    description."""
    is_nameless = source.main_tree is None or not can_have_name(source.main_tree)
    return (source.is_part and is_nameless) or is_srdf(source.path)


def _read_texts_about_package(source: Source) -> Iterator[str]:
    """Yield the texts of other packages that name the model's package."""
    for folder, package_name in iter_using_folders(source):
        for _, text in iter_package_texts(folder, source.finder.can_open) if package_name else ():
            if package_name in text:
                yield drop_comments(text)


def _list_other_models(folder: Path, own: Path) -> set[str]:
    """List the names of the other files below a folder that end as those of models do: one elsewhere may have the same."""
    names: set[str] = set()
    for here, inner, files in walk(folder):
        inner[:] = [name for name in inner if not name.startswith(".")]
        found = (name for name in files if name.endswith((".urdf", ".xacro")))
        names.update(name for name in found if Path(here, name).absolute() != own.absolute())
    return names


def _is_named_outside_packages(source: Source) -> bool:
    """Whether a program of the project, or a README in a folder around the model, names the model's file."""
    own, path = compile_names((source.path.name,)), source.path.absolute()
    project = find_project_folder(path)
    # A program that names the file of this name in another package does not name this one.
    inside, package = path.name, ""
    if source.package is not None:
        inside, package = Path(os.path.relpath(path, source.package.path)).as_posix(), source.package.name
    around = [folder for folder in path.parents if folder == project or project in folder.parents]
    readmes = itertools.chain.from_iterable(map(_list_readmes, around))
    texts = (read_text_or_nothing(path, _LARGEST) for path in readmes if source.finder.can_open(path))
    programs = iter_project_files(source, (*SCRIPT_SUFFIXES, *_PROGRAMS, *_LISTS))
    scripts = (drop_outputs(path, drop_comments(text)) for path, text in programs)
    found = (text for text in itertools.chain(texts, scripts) if own.search(text))
    return any(names_file(text, inside, package) for text in found)


def _list_readmes(folder: Path) -> list[Path]:
    """List the READMEs in a folder, without those below it."""
    _, inner, files = next(iter(walk(folder)), ("", [], []))
    inner.clear()
    return [folder / name for name in sorted(files) if name.lower().startswith("readme")]
