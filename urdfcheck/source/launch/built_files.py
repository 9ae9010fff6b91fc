"""Files that a launch file or a model names and that no checkout has, because a build or a program makes them, or the
launch file itself."""

from __future__ import annotations

import ast
import fnmatch
import glob
import itertools
import os
import posixpath
import re
from collections.abc import Collection, Iterable, Iterator, Sequence
from pathlib import Path

from urdfcheck.core.text import compile_names
from urdfcheck.source.launch.python_texts import PythonTexts, find_call_argument, get_function_name
from urdfcheck.source.package.cmake_installs import parse_commands, read_cmake_installs
from urdfcheck.source.package.file_kinds import MODEL_SUFFIXES
from urdfcheck.source.package.package_folders import iter_package_texts
from urdfcheck.source.reach import FileReach
from urdfcheck.source.text.globs import match_any_pattern, split_relative_path
from urdfcheck.source.text.xml import Element
from urdfcheck.system.files import read_text_or_nothing, walk

# Limit on the patterns of one .gitignore that are read.
MAX_PATTERNS = 1_000
# What a build calls that makes a file out of another.
_MAKES_FILES = re.compile(
    r"xacro_add_|add_custom_|execute_process|configure_file|subprocess|os\.system|process_file"
    r"|\b[Ff][Ii][Ll][Ee][ (]\s*(?:DOWNLOAD|WRITE|GENERATE|CONFIGURE)\b"
)

# What a script or a build writes with xacro: `xacro ${robot}.urdf.xacro > ${robot}.urdf`, `OUTPUT ${CMAKE_BINARY_DIR}/arm.urdf`.
_WRITTEN = re.compile(
    r"""xacro\b[^\n]{0,300}?(?:>|\s-o|--output)[\s=]*["']?(?P<written>[^\s"'|;&()<>]+)|\bOUTPUT\s+["']?(?P<output>[^\s"'()]+)"""
)
_XACRO_ADDED = re.compile(r"xacro_add_\w+\s*\(([^()]*)\)")
# What the names of templates end with: those of CMake, and those of empy, which catkin expands.
_TEMPLATES = (".in", ".em")
_ARCHIVES = (".tar", ".tar.bz2", ".tar.gz", ".tar.xz", ".tgz", ".txz", ".zip", ".7z")
# How a build unpacks them: `cmake -E tar xzf`, `unzip`, file(ARCHIVE_EXTRACT …), Python's modules.
_UNPACKS = re.compile(r"\btar\s+-?x|\bunzip\b|ARCHIVE_EXTRACT|\b(?:tarfile|unpack_archive|ZipFile)\b")
_CMAKE = "CMakeLists.txt"
_XACRO = ".xacro"
# What the shell, CMake or Python puts into a name.
_FILLED_IN = re.compile(r"\$?\{[^{}]*\}|\$\w+|%s")
# What stands before the file that a command writes, and such words alone.
_BEFORE_OUTPUT = re.compile(r"(?:>|\s-o|--output)[\s=]*[\"']?$")
_OUTPUT_WORDS = frozenset({"-o", "--output", ">"})
_PLACE = re.compile(r"%[rs]|\{[^{}]*\}")
_WRITING_METHODS = frozenset({"write_bytes", "write_text"})


def find_maker(path: Path, package: Path, reach: FileReach) -> Path | None:
    """Return the script or build file of a package that writes a missing model with xacro, under its name or a computed one.

    A name that is computed whole may be any: then the package has a xacro file of the missing one's name, or the text types that
    name as a word and computes names of its kind. So the package has where its build hands that file to a function.
    """
    stem, _, suffix = path.name.partition(".")
    word, computed = compile_names((stem,)), f"}}.{suffix}"
    sources = [
        name
        for _, _, files in walk(package)
        for name in files
        if name.endswith(_XACRO) and name.partition(".")[0] == stem
    ]
    for file, text in iter_package_texts(package, reach.can_open):
        if file.name != _CMAKE and file.suffix not in {".cmake", ".sh", ".py"}:
            continue
        names = {Path(name).name for match in _WRITTEN.finditer(text) for name in match.groups() if name}
        # A regular expression takes exponential time for many computed parts.
        patterns = {name: "*".join(map(glob.escape, _FILLED_IN.split(name))) for name in names if name}
        written = [name for name, pattern in patterns.items() if fnmatch.fnmatchcase(path.name, pattern)]
        is_added = any(f"{path.name}{_XACRO}" in added for added in _XACRO_ADDED.findall(text))
        if is_added or any(_FILLED_IN.sub("", name).partition(".")[0] for name in written):
            return file
        if written and computed in text and word.search(text):
            return file
        if sources and (written or (file == package / _CMAKE and _is_handed_on(sources, text, package, reach))):
            return file
    return None


def _is_handed_on(sources: Sequence[str], build: str, package: Path, reach: FileReach) -> bool:
    """Whether a build hands a xacro file to a function that may expand it: one named after xacro, or any that CMake has not.

    A name that is computed may be that of any file.
    """

    def read_text(place: str) -> str | None:
        file = package / place
        return read_text_or_nothing(file) or None if reach.can_open(file) else None

    installed = read_cmake_installs(list(parse_commands(build)), package.name, read_text)
    stems = {name.partition(".")[0] for name in sources}
    words = [posixpath.basename(word) for word in (*installed.function_words, *installed.expanded_words)]
    computed = [posixpath.basename(word) for word in installed.expanded_words if _FILLED_IN.search(word)]
    patterns = [_FILLED_IN.sub("*", word) for word in (*(w for w in words if w.endswith(_XACRO)), *computed)]
    is_named = any(posixpath.basename(word) in stems for word in installed.expanded_words)
    return is_named or any(match_any_pattern(patterns, (name,)) for name in sources)


def may_be_built(path: Path, package: Path, suffixes: tuple[str, ...]) -> bool:
    """Whether a package's build or a program of its own may make or install a missing file.

    It may if the build mentions the name, if git ignores it, or if the package has a template of it, or a file of that name with
    other suffixes and a build that makes files.
    """
    reach = FileReach.from_paths([package], [])
    places = [package / name for name in (_CMAKE, "setup.py")]
    builds = [read_text_or_nothing(place) for place in places if reach.can_open(place)]
    if any(map(_compile_made_name(path).search, builds)) or is_git_ignored(path, reach):
        return True
    maker = find_maker(path, package, reach) if path.name.lower().endswith(MODEL_SUFFIXES) else None
    if maker is not None and (maker.name == _CMAKE or maker.suffix == ".cmake"):
        return True
    makes_files = any(map(_MAKES_FILES.search, builds))
    stem = path.name.partition(".")[0]
    for _, names, files in walk(package):
        names[:] = [n for n in names if not n.startswith(".")]
        alike = [file for file in files if any(suffix in file.lower() for suffix in suffixes)]
        if f"{path.name}.in" in alike or (makes_files and any(file.partition(".")[0] == stem for file in alike)):
            return True
    return False


def describe_making_build(paths: Collection[Path], package: Path) -> str:
    """Say how the build file of a package may make files which git ignores: it names each, not only to install it, and calls what
    makes files; or it unpacks archives, and one is in the folder of each. Empty if there is none."""
    reach = FileReach.from_paths([package], [])
    if not all(is_git_ignored(path, reach) for path in paths):
        return ""
    for name in (_CMAKE, "setup.py"):
        text = _read_build(package / name, reach)
        what = "the file" if len(paths) == 1 else "the files"
        if _may_make(paths, text):
            return f"its {name} names {what} and may make {'it' if len(paths) == 1 else 'them'}"
        archives = [_find_archive(path.parent, reach) for path in paths] if _UNPACKS.search(text) else []
        if archives and all(archives):
            return f"its {name} unpacks archives, and {archives[0]} is where {what} should be"
    return ""


def find_origin(path: Path, package: Path) -> Path | None:
    """Return what a package makes a missing file of: its template, or the CMakeLists.txt that names it, not only to install it,
    and calls what makes files."""
    build = package / _CMAKE
    is_made = _may_make([path], _read_build(build, FileReach.from_paths([package], [])))
    return find_template(path, package) or (build if is_made else None)


def _read_build(build: Path, reach: FileReach) -> str:
    """Read a build file without what it only installs; empty if there is none."""
    text = read_text_or_nothing(build) if reach.can_open(build) else ""
    if build.name == _CMAKE:
        text = "\n".join(c.name + " " + " ".join(c.words) for c in parse_commands(text) if c.name != "install")
    return text


def _may_make(paths: Collection[Path], build: str) -> bool:
    """Whether the text of a build file names all of these files and calls what makes files."""
    return _MAKES_FILES.search(build) is not None and all(_compile_made_name(path).search(build) for path in paths)


def _find_archive(folder: Path, reach: FileReach) -> str:
    """Return the name of an archive in a folder; empty if there is none."""
    _, _, files = next(walk(folder), ("", [], [])) if reach.can_open(folder) else ("", [], [])
    return next((name for name in sorted(files) if name.lower().endswith(_ARCHIVES)), "")


def _compile_made_name(path: Path) -> re.Pattern[str]:
    """Compile a pattern of the name of a file, and of what it is made of: ``car.launch.in``, ``arm.stl.gz``, but not the end of a
    longer name."""
    return re.compile(rf"(?<![\w.-]){re.escape(path.name)}(?![\w-])")


def find_template(path: Path, package: Path) -> Path | None:
    """Return the file of a package of which a build makes a missing one: ``car.launch.in`` of ``car.launch``."""
    for here, names, files in walk(package):
        names[:] = [n for n in names if not n.startswith(".")]
        for ending in _TEMPLATES:
            if path.name + ending in files:
                return Path(here, path.name + ending)
    return None


def is_git_ignored(path: Path, reach: FileReach) -> bool:
    """Whether a ``.gitignore`` around a file names it: then it is made, and no checkout has it."""
    ignored = False
    # A hidden file is never in reach; this one is, unless it is a link to elsewhere.
    folders = [f for f in path.parents if reach.can_open(f) and not os.path.islink(f / ".gitignore")]
    for folder in reversed(folders):  # the last pattern that fits decides, in the innermost file
        names = split_relative_path(path, folder)
        for line in read_text_or_nothing(folder / ".gitignore").splitlines()[:MAX_PATTERNS]:
            pattern = line.strip().removeprefix("!")
            if pattern and not pattern.startswith("#") and match_any_pattern([pattern], names):
                ignored = not line.strip().startswith("!")
    return ignored


def list_written_expressions(nodes: Iterable[ast.AST], texts: PythonTexts) -> list[ast.expr]:
    """Return the paths that a Python launch file writes: ``f"xacro {model} > {path}"``, ``["xacro", model, "-o", path]``,
    ``open(path, "w")``."""
    found: list[ast.expr] = []
    for node in nodes:
        if isinstance(node, ast.Call):
            found += _list_opened(node, texts)
        if isinstance(node, (ast.List, ast.Tuple)):
            pairs = itertools.pairwise(node.elts)
            found += [path for word, path in pairs if (texts.evaluate(word) or "").strip() in _OUTPUT_WORDS]
        parts = _split_text(node)
        before = itertools.pairwise(parts)
        found += [
            path
            for text, path in before
            if isinstance(text, str) and isinstance(path, ast.expr) and _BEFORE_OUTPUT.search(text)
        ]
    return [followed for path in found if (followed := texts.follow_name(path)) is not None]


def _list_opened(call: ast.Call, texts: PythonTexts) -> Iterator[ast.expr]:
    name, owner = get_function_name(call), call.func
    if name == "open":
        mode = find_call_argument(call, 1, "mode")
        if mode is not None and set(texts.evaluate(mode) or "") & set("wxa"):
            yield from call.args[:1]
    elif name in _WRITING_METHODS and isinstance(owner, ast.Attribute):
        yield owner.value


def _split_text(node: ast.AST) -> Sequence[str | ast.expr]:
    """Return the literal texts and the expressions between them of which a text is made."""
    if isinstance(node, ast.JoinedStr):
        return [part.value if isinstance(part, ast.FormattedValue) else _get_text(part) for part in node.values]
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add):
        sides = [_split_text(side) or [_get_text(side)] for side in (node.left, node.right)]
        return [part for side in sides for part in side]
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mod):
        given = node.right.elts if isinstance(node.right, ast.Tuple) else [node.right]
        return _fill_in(_get_text(node.left), given)
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr == "format":
        return _fill_in(_get_text(node.func.value), node.args)
    return []


def _fill_in(text: str | ast.expr, given: Sequence[ast.expr]) -> Sequence[str | ast.expr]:
    """Return a text with what is put in its places; nothing where their numbers differ."""
    literals = _PLACE.split(text) if isinstance(text, str) else []
    if len(literals) != len(given) + 1:
        return []
    return [part for pair in zip(literals, given, strict=False) for part in pair]


def _get_text(node: ast.expr) -> str | ast.expr:
    return node.value if isinstance(node, ast.Constant) and isinstance(node.value, str) else node


def writes_file(roots: Iterable[Element], name: str) -> bool:
    """Whether a command in the attributes of an XML launch file writes a file of this name: ``xacro … -o path``."""
    # A substitution is read as a whole only: read in two ways, thirty of them would take minutes.
    written = re.compile(
        r"(?:>|\s-o|(?<![\w-])--output)[\s=]*[\"']?"
        rf"(?:\$\([^()]*\)|(?!\$\([^()]*\))[^\s\"'<>|;&])*/{re.escape(name)}(?=$|[\s\"'|;&])"
    )
    values = (attribute.value for root in roots for element in root.walk() for attribute in element.attributes.values())
    return any(name in value and written.search(f" {value}") is not None for value in values)
