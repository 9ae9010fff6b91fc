"""What the files around a model mention of the properties, macros and arguments that its xacro files define.

A definition that no file of the model uses may be used by another model of the package, or by a package that depends on it.
"""

from __future__ import annotations

import itertools
import os
import re
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import field, replace
from functools import lru_cache
from pathlib import Path, PureWindowsPath

from urdfcheck.core.records import dataclass
from urdfcheck.core.text import compile_names
from urdfcheck.source.load import Source, read_xacro_source
from urdfcheck.source.model_file import compile_includes, may_compute_name, names_file
from urdfcheck.source.package.finder import format_path, has_dependency_entry, is_kept_aside
from urdfcheck.source.package.package_folders import (
    TEST_FOLDERS,
    drop_comments,
    get_used_name,
    is_aside_folder,
    iter_package_texts,
    read_package_texts,
)
from urdfcheck.source.package.similar_files import find_files_elsewhere
from urdfcheck.source.project_folders import find_project_folder
from urdfcheck.source.ros.srdf import has_dependency
from urdfcheck.source.text.remembered import text_fact
from urdfcheck.source.text.xml import COMMENT, Element, SourceFile, XmlError, parse_xml
from urdfcheck.source.xacro.file_contents import can_have_name, defines_macros, has_parts
from urdfcheck.source.xacro.usage import (
    ARGUMENT,
    FORWARDED,
    find_computed_arguments,
    find_expression_names,
    iter_elements_by_tag,
    strip_namespace,
)
from urdfcheck.system.files import read_regular, read_text_or_nothing, walk

# Files that a xacro file can include. Larger ones are expanded models or data, in which expressions are not written.
_INCLUDED_SUFFIXES = frozenset({".xacro", ".urdf", ".xml", ".gazebo", ".srdf"})
_MAX_BYTES = 500_000
# Programs that do not read `model://`.
_OTHER_READERS = re.compile(r"rviz|moveit", re.IGNORECASE)
# What authors put where a script, or a person, is to write something.
_PLACEHOLDER = re.compile(r"[A-Z][A-Z0-9]{3,}(?:_[A-Z0-9]+)*|__\w+__|@\w+@|\{[^{}]+\}|%\(?\w+\)?s|<[^<>]+>")
SCRIPT_SUFFIXES = (".py", ".sh", ".bash", "Makefile", ".mk")
_SHELL_SUFFIXES = (".sh", ".bash", "Makefile", ".mk")
# The file that a command of a shell writes.
_WRITTEN = re.compile(r"(?:>|\s-o\s|\s--output[ =])\s*[\"']?[^\s\"']*")
# Files that say how an image is made.
CONTAINER_FILE = re.compile(r"Dockerfile|Containerfile|compose[\w.-]*\.ya?ml$|^devcontainer\.json$", re.IGNORECASE)
_FETCHES = re.compile(
    r"\b(?:wget|curl|unzip|git clone|gdown|rsync|cp|mv)\s|\b(?:urlretrieve|snapshot_download|requests\.get)\("
)
# Files that hand arguments to a xacro file: launch files, tests and build files.
CALLER_SUFFIXES = (".launch", ".launch.xml", ".py", ".cmake", "CMakeLists.txt", ".yaml", ".yml", ".sh", ".test")
# Beyond this many files the search stops, and it is unknown which definitions are used.
_MAX_FILES = 20_000

# The patterns below stop at the next opening bracket: none searches to the end of the text from each of many places.
_BLOCK = re.compile(r"""insert_block\s+name\s*=\s*["']([^"']+)["']""")
_CALLED = re.compile(r"""<xacro:([^\s<>/"'=]+)""")
_CALLED_BY_NAME = re.compile(r"""<xacro:call\s[^<>]{0,1000}?macro\s*=\s*["']([^"'<>]*)""")
_DECLARED = re.compile(r"""<xacro:arg\s[^<>]{0,1000}?name\s*=\s*["']([^"'<>]*)""")
# A name that a file computes may be that of any model; `replace(".xacro", "")` takes the ending from a name, and `suffix=".urdf"`
# is that of a temporary file.
_COMPUTED = re.compile(r"""(?:[)}\]]|(?<!replace\()(?<!suffix=)["']|%s)(\.(?:(?:urdf\.)?xacro|urdf(?!\.xacro)))\b""")
# What is typed of such a name behind the part that is computed: `${side}_arm.xacro`, `side + "_arm.xacro"`.
_COMPUTED_END = re.compile(r"""(?:[)}]|\+\s*f?["'])([\w.-]+\.(?:urdf|xacro))\b""")
# What xacro says of a name or a macro that is not defined, and the definitions of a file.
_LACKING = re.compile(r"name '([^']+)' is not defined|unknown macro name: (\S+)")
_DEFINED = re.compile(r"""<xacro:(?:arg|property|macro)\s[^<>]{0,1000}?name\s*=\s*["']([^"'<>]*)""")
# The names of model files, as launch files and scripts name them.
MODEL_FILE = re.compile(r"(?<![\w.-])[\w.-]*\w\.(?:urdf|xacro)\b")
# `name:=value` of a command, {"name": value} and name="…" of Python and CMake, name: of yaml.
_PASSED = re.compile(r"""(?<!\w)([A-Za-z_]\w*)["']?\s*(?::?=|:)""")


# Why no program of the robot loads a model.
OF_TESTS = "the model is one of the tests"
KEPT_ASIDE = "the model is in a folder of what is kept and not used, and no file of the package names it"


@dataclass(frozen=True, slots=True)
class XacroMentions:
    """The names that files mention."""

    names: set[str] = field(default_factory=set)
    """Names that expressions, inserted blocks and forwarding defaults read."""
    macros: set[str] = field(default_factory=set)
    """Macros that are called, with expressions as typed."""
    arguments: set[str] = field(default_factory=set)
    """Arguments that are read, declared or passed."""
    computed_arguments: set[str] = field(default_factory=set)
    """Names of arguments that are computed where they are read, as typed."""
    complete: bool = True
    """Whether all files were searched."""


@lru_cache(maxsize=1)
def collect_outside_mentions(source: Source) -> XacroMentions:
    """Collect what the files mention that the model does not reach.

    These are the files in the model's package or folder, and the files of the packages around it that name this package.
    """
    package = source.package
    mentions = XacroMentions()
    count = 0
    for folder, package_name in iter_using_folders(source):
        if package_name and not source.finder.can_open(folder):
            if has_dependency_entry(folder, package_name):
                return replace(mentions, complete=False)
            continue
        for path in _iter_caller_files(folder, deep=package is not None):
            count += 1
            if count > _MAX_FILES:
                return replace(mentions, complete=False)
            if format_path(path) in source.trees or not source.finder.can_open(path):
                continue
            try:
                text = read_regular(path, _MAX_BYTES).decode("utf-8", "replace")
            except OSError:
                continue
            if package_name in text:
                is_included = path.suffix.lower() in _INCLUDED_SUFFIXES
                found = _find_mentions(text, is_included, path.name.endswith(CALLER_SUFFIXES))
                mentions.names.update(found.names)
                mentions.macros.update(found.macros)
                mentions.arguments.update(found.arguments)
                mentions.computed_arguments.update(found.computed_arguments)
    return mentions


def find_other_includers(source: Source, name: str) -> list[str]:
    """Find the files of the model's package that include a file of the model and are not part of the model, by their names.
    Without a package, those of its project.

    ``name`` is the file's name in findings. Nothing where the file is the model's own.
    """
    if name not in source.files or name == format_path(source.path):
        return []
    including = compile_includes([source.files[name].path.name])
    texts = _read_including_texts(source)
    return sorted(
        path.name for path, text in texts.items() if format_path(path) not in source.files and including.search(text)
    )


def read_includers(source: Source) -> dict[str, str]:
    """Read the files of the model's package that include the model's own file, or one that does: their texts by name.

    Nothing without a package.
    """
    if source.package is None:
        return {}
    own = os.path.realpath(source.path)
    including_texts = _read_including_texts(source).items()
    texts = {path.name: text for path, text in including_texts if os.path.realpath(path) != own}
    found: dict[str, str] = {}
    names = {source.path.name}
    while names:
        including = compile_includes(names)
        new = {name: text for name, text in texts.items() if name not in found and including.search(text)}
        found |= new
        names = set(new)
    return found


@lru_cache(maxsize=1)  # each unknown name asks
def _read_including_texts(source: Source) -> Mapping[Path, str]:
    """Return the files of the model's package, or of its project without one, that include others, with their texts."""
    texts: dict[Path, str] = {}
    folder = find_project_folder(source.path.absolute()) if source.package is None else source.package.path
    for path in itertools.islice(_iter_caller_files(folder, deep=True), _MAX_FILES):
        if path.suffix.lower() in _INCLUDED_SUFFIXES and source.finder.can_open(path):
            text = read_text_or_nothing(path, _MAX_BYTES)
            if "include" in text:
                texts[path] = text
    return texts


def find_includer_of_namesake(source: Source, name: str) -> Path | None:
    """Find a xacro of the project that includes a file of the model's name from another folder and defines a property or an
    argument: the model is a copy of that file, a part that needs what the xacro defines."""
    include = re.compile(rf"""<xacro:include\b[^<>]*filename=["'][^"'>]*/{re.escape(source.path.name)}["']""")
    defined = re.compile(rf"""<xacro:(?:property|arg)\b[^<>]*\bname=["']{re.escape(name)}["']""")
    files = iter_project_files(source, (".xacro", ".urdf"))
    return next((path for path, text in files if include.search(text) and defined.search(text)), None)


def find_conditional_include(source: Source) -> tuple[Path, str] | None:
    """Find a file of the model's package that includes the model's own file under a condition, which is returned as typed.

    The condition is an ``<xacro:if>`` around the include, or what the include computes of the file's name.
    """
    if source.package is None:
        return None
    name = source.path.name
    ending = re.compile(rf"(?:^|/){re.escape(name)}$")
    for path in _iter_caller_files(source.package.path, deep=True):
        if path.suffix.lower() not in _INCLUDED_SUFFIXES or not source.finder.can_open(path):
            continue
        try:
            file = SourceFile.read(path, format_path(path))
            root = parse_xml(file) if "<xacro:include" in file.text and path != source.path else None
        except (OSError, XmlError):
            continue
        for include in iter_elements_by_tag({} if root is None else {file.name: root}, "xacro:include"):
            typed = include.get("filename")
            if may_compute_name(typed, name):
                return path, f'<xacro:include filename="…/{typed.rpartition("/")[2]}">'
            around = include.parent
            while around is not None and around.tag not in {"xacro:if", "xacro:unless"}:
                around = around.parent
            if around is not None and ending.search(typed):
                return path, f'<{around.tag} value="{around.get("value")}">'
    return None


def is_completed_by_includer(source: Source) -> bool:
    """Whether a file includes this one under a condition and defines what this one lacks to be expanded.

    Then it is a part of that file's variants, and is never a robot by itself.
    """
    missing = {str(problem.data["argument"]) for problem in source.find_problems("argument-missing")}
    for problem in source.find_problems("expansion-failed"):
        match = _LACKING.search(problem.message)
        if match is None:
            return False
        missing.add(match[1] or match[2].removeprefix("xacro:"))
    included = find_conditional_include(source) if missing else None
    if included is None:
        return False
    try:
        text = SourceFile.read(included[0], format_path(included[0])).text
    except OSError:
        return False
    return missing <= set(_DEFINED.findall(text))


def read_project_texts(source: Source) -> Iterator[str]:
    """Yield the texts of the model's package and of those that depend on it; without a package, those beside the model."""
    for _, text in iter_user_texts(source):
        yield text


def is_lost_to_others(own: Collection[Element], source: Source) -> bool:
    """Whether a program that does not read ``model://`` is named in the project, and finds no other shape in place of one of
    these elements (``own``), which have such paths."""
    shapes = map(_find_shape, own)
    lacking = any(
        shape is not None
        and shape.parent is not None
        and all(any(part in own for part in other.walk()) for other in shape.parent.find_children(shape.tag))
        for shape in shapes
    )
    return lacking and any(map(_OTHER_READERS.search, read_project_texts(source)))


def _find_shape(element: Element) -> Element | None:
    """Return the visual or collision that an element is in."""
    above: Element | None = element
    while above is not None and above.tag not in {"visual", "collision"}:
        above = above.parent
    return above


def iter_user_texts(source: Source) -> Iterator[tuple[Path, str]]:
    """Yield the same texts with the files that they are in."""
    finder, package = source.finder, source.package
    if package is None:
        yield from iter_package_texts(source.path.absolute().parent, finder.can_open, deep=False)
        return
    yield from iter_package_texts(package.path, finder.can_open)
    for name, folder in sorted(finder.list_workspace_packages().items()):
        if folder != package.path and has_dependency(folder, package.name):
            finder.find(name)  # then it counts as found, and its files are in reach
            yield from iter_package_texts(folder, finder.can_open)


def iter_project_texts(source: Source, file: Path | None = None) -> Iterator[tuple[Path, str]]:
    """Yield the texts of the packages of the model and of one of its files, with their paths."""
    found = (source.package, None if file is None else source.finder.find_package_of(file.absolute()))
    packages = {package.path for package in found if package is not None}
    for folder in sorted(packages):
        yield from iter_package_texts(folder, source.finder.can_open)


def is_unused(source: Source) -> bool:
    """Whether no file names the model where the others of its package name other models: it is a kept copy, or a part that is no
    longer included.

    A piece of a robot without a name may be included by a name that is computed.
    """
    may_be_piece = source.is_part and (source.main_tree is None or not can_have_name(source.main_tree))
    return not may_be_piece and is_named_nowhere(source) and is_certainly_left_aside(source)


def is_orphan(source: Source) -> bool:
    """Whether a file is a piece of a robot that no file includes: its <robot> has no name."""
    root = source.main_tree
    return not source.is_part and root is not None and root.tag == "robot" and not can_have_name(root)


def is_no_robot(source: Source) -> bool:
    """Whether a file that no other includes makes no robot, and no launch file names it: its <robot> has no name, which every
    parser requires, or it defines macros and nothing that was read makes a link or a joint."""
    is_library = defines_macros(source.main_tree) and not any(map(has_parts, source.trees.values()))
    if source.is_part or not (is_orphan(source) or (is_library and source.package is not None)):
        return False
    from urdfcheck.source.launch.loaded_files import is_named_by_launch  # only what is wrong asks for it

    return not is_named_by_launch(source.path, source.finder)


def is_certainly_left_aside(source: Source) -> bool:
    """Whether files of the model's package, or of those that depend on it, name other models and not this one. False without
    a package, where one of them computes such a name, and where xacro made a model of the package of this one."""
    if source.package is None:
        return False
    texts = list(read_project_texts(source))
    names_others = name_other_models_only(texts, source.path.name)
    is_computed = any(computes_name(text, source.path.name) for text in texts)
    return names_others and not is_computed and not is_kept_as_source(source)


@lru_cache(maxsize=1)  # several rules ask
def is_kept_as_source(source: Source) -> bool:
    """Whether xacro made another file here of the model, as the header of that file says."""
    for folder, package_name in iter_using_folders(source):
        for path in itertools.islice(_iter_caller_files(folder, deep=True), _MAX_FILES):
            if path.suffix.lower() in _INCLUDED_SUFFIXES and source.finder.can_open(path):
                text = read_text_or_nothing(path, _MAX_BYTES)
                if package_name in text and _is_made_of(source, path, text):
                    return True
    return False


def _is_made_of(source: Source, path: Path, text: str) -> bool:
    """Whether xacro made another file of the model, as the header of its text says."""
    own = source.path.absolute()
    made_of = None if path.absolute() == own else read_xacro_source(text)
    if made_of is None or PureWindowsPath(made_of).name != own.name:
        return False
    found = find_files_elsewhere(made_of, path, source.finder)
    beside = [file for file in found if file.parent == path.absolute().parent]
    return own in (beside or found)


def name_other_models_only(texts: Iterable[str], own: str) -> bool:
    """Whether texts name files of models, and not the ``own`` one outside comments; others may be in a comment of a script."""
    names_any = False
    for text in texts:
        if own in MODEL_FILE.findall(drop_comments(text)):
            return False
        names_any |= any(name != own for name in MODEL_FILE.findall(COMMENT.sub("", text)))
    return names_any


def find_deploying_script(source: Source) -> Path | None:
    """Return a script of the project that names a xacro file whose robot has no name: it puts the part into a model elsewhere.

    Only of a file in no package; no program loads a robot without a name.
    """
    tree = source.main_tree
    if source.package is not None or not source.is_xacro or tree is None or can_have_name(tree):
        return None
    own = compile_names((source.path.name,))
    return next((path for path, text in iter_project_files(source, SCRIPT_SUFFIXES) if own.search(text)), None)


@lru_cache(maxsize=1)
def find_copying_image(source: Source) -> Path | None:
    """Return the file of Docker in the project that copies the model into an image, whose packages are not all here."""
    name, folder = re.escape(source.path.name), re.escape(source.path.absolute().parent.name)
    copied = re.compile(rf"(?m)^[^#\n]*\b(?:COPY|ADD|cp)\s(?:[^\n]*[\s/])?{folder}/{name}\s")
    files = iter_project_files(source, named=CONTAINER_FILE)
    return next((path for path, text in files if copied.search(text)), None)


@lru_cache(maxsize=1)
def find_copying_build(source: Source) -> Path | None:
    """Return the CMakeLists.txt of the project that copies the model into a folder of the build, where its relative paths lead
    elsewhere. What ``install`` copies aside: it copies the meshes too."""
    name = re.escape(source.path.name)
    copied = re.compile(rf"(?im)^[^#\n]*\b(?:file\s*\(\s*COPY\b|configure_file\s*\()[^()]*(?<![\w.-]){name}(?![\w.-])")
    files = iter_project_files(source, ("CMakeLists.txt",))
    return next((path for path, text in files if copied.search(text)), None)


@lru_cache(maxsize=8)  # a model has few such words
def find_filling_script(source: Source, word: str) -> Path | None:
    """Return a script of the project that puts another text in place of a ``word`` in capitals or brackets, as in a template.

    A name in small letters may be that of a folder, which a script moves.
    """
    return None if _PLACEHOLDER.fullmatch(word) is None else find_replacing_script(source, word)


@lru_cache(maxsize=8)
def find_replacing_script(source: Source, typed: str, *, names_model: bool = False) -> Path | None:
    """Return a script of the project that puts another text in place of one; ``names_model``: and that names the model's file."""
    whole = rf"(?<!\w){re.escape(typed)}(?!\w)"
    replacing = re.compile(
        rf"""(?:\b(?:replace|sub)\(\s*|\bstrrep\([^,\n]{{1,80}},\s*)[rbf]?["'][^"'\n]{{0,40}}{whole}"""
        rf"""|\bs([/@|#,!])[^\n]{{0,40}}{whole}"""
    )
    own = compile_names((source.path.name,))
    for path, text in iter_project_files(source, (*SCRIPT_SUFFIXES, ".m")):
        if replacing.search(text) and (not names_model or own.search(text)):
            return path
    return None


@lru_cache(maxsize=8)  # a model lacks few folders
def find_fetching_script(source: Source, folder: str) -> Path | None:
    """Return a script of the project that names a folder outside comments, and downloads, unpacks or copies files."""
    named = re.compile(rf"(?m)^[^#\n]*(?<![\w-]){re.escape(folder)}(?![\w-])")
    scripts = iter_project_files(source, SCRIPT_SUFFIXES)
    return next((path for path, text in scripts if _FETCHES.search(text) and named.search(text)), None)


def find_used_copy(source: Source) -> Path | None:
    """Return the model beside one that is named as its original or an old state of it (``arm_orig.urdf``, ``arm.urdf``).

    None where a file of the project names the original.
    """
    name = get_used_name(source.path.name)
    used = source.path.absolute().with_name(name) if name else None
    if used is None or not source.finder.can_open(used) or not used.is_file():
        return None
    own = compile_names((source.path.name,))
    for count, (_, text) in enumerate(iter_project_files(source, CALLER_SUFFIXES)):
        if count >= _MAX_FILES or own.search(text):
            return None
    return used


@lru_cache(maxsize=1)  # several rules ask, some for each finding
def explain_kept_file(source: Source) -> str:
    """Say why no program of the robot loads a model: it is in a folder of tests, in one of what is kept and not used, or the
    original of another; else empty."""
    project = find_project_folder(source.path.absolute())
    folders = Path(os.path.relpath(source.path.absolute(), project)).parts[:-1]
    if not TEST_FOLDERS.isdisjoint(folder.lower() for folder in folders):
        return OF_TESTS
    if is_kept_aside(source.path, source.package) and is_named_nowhere(source):
        return KEPT_ASIDE
    used = find_used_copy(source)
    return (
        "" if used is None else f"{used.name} beside it is the copy in use, and no file of the project names this one"
    )


def iter_project_files(
    source: Source, endings: tuple[str, ...] = (), *, named: re.Pattern[str] | None = None
) -> Iterator[tuple[Path, str]]:
    """Yield the files of the project whose names end so, or in which a pattern is found, in or outside packages, each with its
    text as far as it can be read."""
    for here, names, files in walk(find_project_folder(source.path)):
        names[:] = [name for name in names if not name.startswith(".")]
        wanted = (name for name in sorted(files) if name.endswith(endings) or (named and named.search(name)))
        for path in (Path(here, name) for name in wanted):
            if source.finder.can_open(path):
                yield path, read_text_or_nothing(path, _MAX_BYTES)


def is_kept_unused(source: Source) -> bool:
    """Whether a model is in a folder for files that are kept and not used, and no file of the project names it in that folder:
    what one project keeps in `raw`, another starts. A bare name is as often that of the copy in use."""
    if source.package is None or not is_kept_aside(source.path, source.package):
        return False
    inside = Path(os.path.relpath(source.path.absolute(), source.package.path.absolute())).parts
    folder = next((level for level, name in enumerate(inside) if is_aside_folder(name)), 0)
    named = re.compile(r"[\"',\s/]+".join(map(re.escape, inside[folder:])))
    return not any(named.search(drop_comments(text)) for text in read_project_texts(source))


@lru_cache(maxsize=1)
def is_named_nowhere(source: Source) -> bool:
    """Whether no file of the model's package, or of one that names the package, names the model's file outside comments.

    The header that xacro writes is such a comment, and still names what the file was made of.
    False without a package, and where a file computes such a name.
    """
    if source.package is None:
        return False
    inside = Path(os.path.relpath(source.path.absolute(), source.package.path)).as_posix()
    built = re.compile(rf"MoveItConfigsBuilder\(\s*(?:robot_name\s*=\s*)?[\"']{re.escape(get_stem(source))}[\"']")
    for folder, package_name in iter_using_folders(source):
        if package_name and not source.finder.can_open(folder):
            if has_dependency_entry(folder, package_name):
                return False
            continue
        for path in itertools.islice(_iter_caller_files(folder, deep=True), _MAX_FILES):
            if path.absolute() == source.path.absolute() or not source.finder.can_open(path):
                continue
            if any(map(is_aside_folder, path.relative_to(folder).parts[:-1])):  # what nothing starts starts nothing
                continue
            try:
                text = read_regular(path, _MAX_BYTES).decode("utf-8", "replace")
            except OSError:
                continue
            if package_name in text and (
                names_file(drop_outputs(path, drop_comments(text)), inside, source.package.name)
                or built.search(text)
                or computes_name(text, source.path.name)
                or any(map(source.path.name.endswith, _COMPUTED_END.findall(text)))
                or (path.suffix.lower() in _INCLUDED_SUFFIXES and _is_made_of(source, path, text))
            ):
                return False
    return True


def computes_name(text: str, name: str) -> bool:
    """Whether a text computes the name of a file that ends as this one."""
    return any(map(name.lower().endswith, _COMPUTED.findall(text)))


def drop_outputs(path: Path, text: str) -> str:
    """Leave out of the text of a script the files that its commands write: these do not use them."""
    return _WRITTEN.sub("", text) if path.name.endswith(_SHELL_SUFFIXES) else text


def get_stem(source: Source) -> str:
    """Return the name of the model's file without its endings."""
    return source.path.name.removesuffix(".xacro").removesuffix(".urdf")


def is_kept_output(source: Source) -> bool:
    """Whether xacro wrote the model, and no file of its package, or of one that depends on it, names it. False without one."""
    own = compile_names((source.path.name,))
    is_kept = source.is_output_of_xacro and source.package is not None
    return is_kept and not any(map(own.search, read_project_texts(source)))


def is_left_output(source: Source) -> bool:
    """Whether the model is a kept output that no file of any package around it names."""
    return is_kept_output(source) and not is_named_around(source)


def is_named_around(source: Source) -> bool:
    """Whether a file of any package around the model names it, with or without a declared dependency."""
    own = compile_names((source.path.name,))
    folders = sorted(set(source.finder.list_workspace_packages().values()))
    texts = (text for folder in folders for text in read_package_texts(folder, source.finder.can_open))
    return any(map(own.search, texts))


def has_unseen_includes(source: Source) -> bool:
    """Whether the model has an include that was not followed and that :func:`collect_outside_mentions` may not read."""
    reached = {name.rsplit("/", 1)[-1] for name in source.trees}
    own_package = "" if source.package is None else f"$(find {source.package.name})"
    for include in iter_elements_by_tag(source.trees, "xacro:include"):
        filename = include.get("filename")
        outside = "$(find" in filename and not (own_package and own_package in filename)
        # Without a package, only the model's own folder is searched, not the folders around or below it.
        outside |= source.package is None and ("/" in filename or "$" in filename)
        if outside and filename.rsplit("/", 1)[-1] not in reached:
            return True
    return False


def iter_using_folders(source: Source) -> Iterator[tuple[Path, str]]:
    """Yield the folders whose files may use the model's definitions, each with a name that such a file contains."""
    package = source.package
    if package is None:
        yield source.path.parent, ""
        return
    yield package.path, ""
    for folder in source.finder.list_workspace_packages().values():
        if folder != package.path and package.path not in folder.parents and folder not in package.path.parents:
            yield folder, package.name


def _iter_caller_files(folder: Path, *, deep: bool) -> Iterator[Path]:
    for here, names, files in walk(folder):
        names[:] = [name for name in names if deep and not name.startswith(".")]
        for name in files:
            path = Path(here, name)
            if (path.suffix.lower() in _INCLUDED_SUFFIXES or name.endswith(CALLER_SUFFIXES)) and path.is_file():
                yield path


@text_fact
def _find_mentions(text: str, is_included: bool, is_caller: bool) -> XacroMentions:
    mentions = XacroMentions()
    if is_included:
        mentions.names.update(_BLOCK.findall(text), FORWARDED.findall(text), find_expression_names(text))
        mentions.macros.update(map(strip_namespace, _CALLED.findall(text)))
        mentions.macros.update(map(strip_namespace, _CALLED_BY_NAME.findall(text)))
        mentions.arguments.update(mentions.names, ARGUMENT.findall(text), _DECLARED.findall(text))
        mentions.computed_arguments.update(find_computed_arguments(text))
    if is_caller:
        mentions.arguments.update(_PASSED.findall(text))
    return mentions
