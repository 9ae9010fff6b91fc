"""The packages, and the folders in them, that a package's files name, as typed, without expanding or running anything."""

from __future__ import annotations

import ast
import os
import re
from collections import Counter
from collections.abc import Iterator
from functools import lru_cache
from itertools import islice
from pathlib import Path

from urdfcheck.core import Location
from urdfcheck.core.records import dataclass
from urdfcheck.source.package.file_kinds import MESH_SUFFIXES
from urdfcheck.source.package.finder import Package, format_path, has_dependency_entry
from urdfcheck.source.package.package_folders import BUILD_FOLDERS
from urdfcheck.source.text.python import parse_python
from urdfcheck.source.text.remembered import text_fact
from urdfcheck.source.text.xml import SourceFile
from urdfcheck.system.files import read_text_or_nothing, walk

# Files that contain paths of meshes, besides build files.
_TEXT_SUFFIXES = frozenset({
    ".xacro", ".urdf", ".xml", ".srdf", ".sdf", ".gazebo", ".launch", ".world", ".yaml", ".yml", ".json", ".rviz", ".py", ".cpp",
    ".hpp", ".h", ".cc", ".js", ".ts", ".lua", ".m", ".toml", ".cfg", ".material", ".scene", ".wbt", ".proto", ".cmake", ".txt",
    ".in", ".jinja", ".template", ".erb", ".env", ".sh", ".test",
})  # fmt: skip
# Files in which the name of a package in these forms is a dependency.
_NAMING_SUFFIXES = frozenset({".xacro", ".urdf", ".srdf", ".sdf", ".gazebo", ".launch", ".xml", ".py", ".yaml", ".yml"})
_MAX_BYTES = 1_000_000
_MOST_FILES = 20_000
# Limit on the names of folders in a Python file for which the file is searched again.
_MOST_NAMES = 50
_LONGEST_LINE = 500

_PACKAGE = r"([A-Za-z][A-Za-z0-9_.-]*)"
_INSIDE = r"((?:/[^\s\"'<>()|;,\\]*)?)"
# In XML a backslash is part of a path, which does not exist then on Linux; elsewhere it ends a text or quotes a character. A
# substitution, like `$(arg name)`, is part of it too.
_INSIDE_XML = r"((?:/(?:\$\([^()\"'<>\n]*\)|[^\s\"'<>()|;,])*)?)"
_MENTION = re.compile(
    rf"package://{_PACKAGE}(?![$\w.-]){_INSIDE}"
    rf"|\$\(find(?:-pkg-share)?\s+['\"]?{_PACKAGE}['\"]?\s*\){_INSIDE_XML}"
    rf"|(?:FindPackageShare|get_package_share_directory|get_package_share_path)\(\s*(?:package\s*=\s*)?"
    rf"(?:['\"]{_PACKAGE}['\"]|([A-Za-z_]\w*)(?=\s*[,)]))"
)
# xacro as a module and as a command: its package is used without a word for packages.
_XACRO = re.compile(
    r"(?m)^[ \t]*(?:import|from)[ \t]+(xacro)\b"
    r"|\bFindExecutable\(\s*(?:name\s*=\s*)?['\"](xacro)['\"]"
    r"|\bCommand\(\s*\[?\s*f?['\"]\s*(xacro)\s"
    r"|\$\(command\s+['\"]?(xacro)\s"
    r"|\bcommand\s*=\s*['\"](xacro)\s"
)
_XACRO_SUFFIXES = frozenset({".py", ".launch", ".xml"})
# The package of a program that a launch file starts.
_STARTED = re.compile(
    rf"<node\b[^<>]*?\bpkg\s*=\s*['\"]{_PACKAGE}['\"]|\bNode\([^()]*?\bpackage\s*=\s*['\"]{_PACKAGE}['\"]"
    rf"|\bpackage\s*=\s*['\"]{_PACKAGE}['\"]\s*,\s*executable\s*="
)
_LAUNCH_SUFFIXES = (".launch", ".launch.xml", ".launch.py", "_launch.py")
# What Python may print.
_TOLD = re.compile(r"package://|\$\(find")
# Arguments of functions whose text is for the reader, as of launch's DeclareLaunchArgument and argparse.
_EXPLAINING = frozenset({"description", "help"})
# The paths that Python joins to a package's folder in a row, and the name that it assigns the folder to before.
_TEXT = r"""f?['"][^'"{}]*['"]"""
# Texts side by side without a comma are one text.
_QUOTED = rf"{_TEXT}(?:\s*{_TEXT})*"
_QUOTED_TEXTS = re.compile(_QUOTED)
_JOINED = rf"(?P<joined>\s*(?P<by>,|/|\+)\s*{_QUOTED}(?:\s*(?P=by)\s*{_QUOTED})*)(?P<more>\s*(?P=by)\s*[\w('\"])?"
_TYPED = re.compile(r"""['"]([^'"]*)['"]""")
_AT_ONCE = re.compile(rf"\s*\)(?:\.find\([^()]*\))?{_JOINED}")
_ASSIGNED = re.compile(r"(?m)^[ \t]*(\w+)[ \t]*=[ \t]*(?:[\w.]+\([ \t]*)?$")
_IMPORT = re.compile(r"(?m)^(?:from|import)[ \t][^\n]*")


@dataclass(frozen=True, slots=True, eq=False)
class PackageMention:
    """A package that a file names, and the path after its name (``/meshes/base.stl``) or an empty text."""

    package: str
    subpath: str
    location: Location
    optional: bool = False
    """Whether Python goes on without the package: the mention is in a ``try`` whose ``except`` does not raise again."""

    @property
    def folder(self) -> str:
        """The outermost folder of the package that the path leads into; empty if there is none, or it is computed."""
        first, slash, _ = self.subpath.lstrip("/").partition("/")
        return first if slash and "$" not in first and first not in {"", ".", ".."} else ""


@dataclass(frozen=True, slots=True, eq=False)
class PackageContents:
    """What the files of a package contain."""

    mentions: tuple[PackageMention, ...]
    """Mentions of packages in the package's own files."""
    meshes: tuple[Path, ...]
    """The package's meshes, by path from its folder."""
    complete: bool
    """Whether all files were searched."""


@lru_cache(maxsize=1)
def read_package_contents(package: Package) -> PackageContents:
    """Return the contents of a package, without folders of other packages in it."""
    mentions: list[PackageMention] = []
    meshes: list[Path] = []
    complete = True
    for count, path in enumerate(iter_package_files(package, package.path)):
        if count > _MOST_FILES:
            complete = False
            break
        suffix = path.suffix.lower()
        if suffix in MESH_SUFFIXES:
            meshes.append(path.relative_to(package.path))
        elif suffix in _NAMING_SUFFIXES and path.name not in {"package.xml", "setup.py"}:
            mentions += _list_mentions(path)
    return PackageContents(tuple(mentions), tuple(meshes), complete)


def iter_started_packages(package: Package) -> Iterator[PackageMention]:
    """Yield the packages of the programs that a package's launch files start, without its own."""
    for path in islice(iter_package_files(package, package.path), _MOST_FILES):
        is_launch = path.name.endswith(_LAUNCH_SUFFIXES)
        text = read_text_or_nothing(path, _MAX_BYTES) if is_launch or path.suffix == ".py" else ""
        if is_launch or "def generate_launch_description" in text:
            file = SourceFile(path, format_path(path), text=text)
            for match in _STARTED.finditer(_remove_comments(text, path.suffix)):
                group = match.lastindex or 0
                name = match[group]
                if name != package.name:
                    span = file.make_span(*match.span(group))
                    yield PackageMention(name, "", Location(f"package[{name}]", span))


def mentions_package(package: Package, name: str) -> bool:
    """Whether a file of a package names another package."""
    return any(mention.package == name for mention in _iter_own_mentions(package))


def list_mentioned_packages(package: Package) -> set[str]:
    """Return the packages that the files of a package name, and do not only try."""
    return {mention.package for mention in _iter_own_mentions(package) if not mention.optional}


def _iter_own_mentions(package: Package) -> Iterator[PackageMention]:
    files = islice(iter_package_files(package, package.path), _MOST_FILES)
    naming = (p for p in files if p.suffix.lower() in _NAMING_SUFFIXES and p.name not in {"package.xml", "setup.py"})
    return (mention for path in naming for mention in _list_mentions(path))


def iter_package_mentions(package: Package) -> Iterator[PackageMention]:
    """Yield the mentions of this package: in its own files, and in those of the packages around it that depend on it."""
    yield from (m for m in read_package_contents(package).mentions if m.package == package.name)
    for folder in list_other_folders(package):
        if not has_dependency_entry(folder, package.name):
            continue
        for count, path in enumerate(iter_package_files(package, folder)):
            if count > _MOST_FILES:
                break
            if path.suffix.lower() in _NAMING_SUFFIXES and path.name not in {"package.xml", "setup.py"}:
                yield from (m for m in _list_mentions(path) if m.package == package.name)


def list_other_folders(package: Package) -> list[Path]:
    """Return the folders of the packages around this one that may be opened, without those inside it."""
    finder = package.finder
    return (
        [] if finder is None else [folder for folder in _list_surrounding_folders(package) if finder.can_open(folder)]
    )


def has_unreachable_users(package: Package) -> bool:
    """Whether a package around this one depends on it and may not be opened."""
    finder = package.finder
    return finder is not None and any(
        not finder.can_open(folder) and has_dependency_entry(folder, package.name)
        for folder in _list_surrounding_folders(package)
    )


def _list_surrounding_folders(package: Package) -> list[Path]:
    around = [] if package.finder is None else package.finder.list_workspace_packages().values()
    return [folder for folder in around if folder != package.path and package.path not in folder.parents]


def iter_file_texts(package: Package, folder: Path) -> Iterator[str]:
    """Yield the text of every file in a folder that may name a mesh of the package; of another package's, those that name it.

    :raises LookupError: if there are too many files to search.
    """
    for count, path in enumerate(iter_package_files(package, folder)):
        if count > _MOST_FILES:
            raise LookupError("too many files")
        text = read_text_or_nothing(path, _MAX_BYTES) if path.suffix.lower() in _TEXT_SUFFIXES else ""
        if folder == package.path or package.name in text:
            yield text


def iter_package_files(package: Package, folder: Path) -> Iterator[Path]:
    """Yield the files at and below a folder that may be opened, without built and hidden ones, and without inner packages."""
    for here, names, files in walk(folder):
        if here != str(folder) and "package.xml" in files:
            names.clear()
            continue
        names[:] = [n for n in names if not n.startswith(".") and n not in BUILD_FOLDERS]
        for name in files:
            path = Path(here, name)
            if not name.startswith(".") and (not os.path.islink(path) or _is_allowed(package, path)):
                yield path


def _is_allowed(package: Package, path: Path) -> bool:
    return package.finder is None or package.finder.can_open(path)


def _list_mentions(path: Path) -> tuple[PackageMention, ...]:
    return _find_mentions(read_text_or_nothing(path, _MAX_BYTES), path, format_path(path))


@text_fact
def _find_mentions(text: str, path: Path, file_name: str) -> tuple[PackageMention, ...]:
    return tuple(_iter_mentions(text, path, file_name))


def _iter_mentions(text: str, path: Path, file_name: str) -> Iterator[PackageMention]:
    runs_xacro = path.suffix in _XACRO_SUFFIXES and "xacro" in text
    if not runs_xacro and not any(word in text for word in ("package://", "find", "package_share", "FindPackage")):
        return
    file: SourceFile | None = None
    searched = 0
    bare = _remove_comments(text, path.suffix)
    is_python = path.suffix == ".py"
    optional = _find_optional_lines(text) if is_python and "except" in text else frozenset()
    told = _find_told_lines(text) if is_python and _TOLD.search(bare) else frozenset()
    unused = _find_unused_lines(text, bare) if is_python and "generate_launch_description" in text else frozenset()
    for match in _MENTION.finditer(bare):
        file = file or SourceFile(path, file_name, text=text)
        group = next(i for i in (1, 3, 5, 6) if match.group(i))
        name = match.group(group)
        searched += group >= 5  # in Python
        if group == 6:
            value = _find_assigned_name(bare, name) if searched <= _MOST_NAMES else None
            if value is None:
                continue
            name = value
        at = Location(f"package[{name}]", file.make_span(*match.span(group)))
        if group < 5 and at.span is not None and at.span.line in told:
            continue
        found = [match.group(group + 1)] if group < 5 else _find_joined_paths(bare, match, searched, unused)
        for inside in found:
            yield PackageMention(name, inside, at, at.span is not None and at.span.line in optional)
    for match in _XACRO.finditer(bare) if runs_xacro else ():
        file = file or SourceFile(path, file_name, text=text)
        at = Location("package[xacro]", file.make_span(*match.span(match.lastindex or 0)))
        yield PackageMention("xacro", "", at, at.span is not None and at.span.line in optional)


def _find_assigned_name(text: str, variable: str) -> str | None:
    """Return the name of a package that a Python file assigns to a variable; None unless the only value is one."""
    values = re.findall(rf"(?<![\w.]){variable}[ \t]*(?::[ \t]*str[ \t]*)?=(?!=)[ \t]*([^\n]*)", text)
    match = re.fullmatch(rf"['\"]{_PACKAGE}['\"][ \t\r]*(?:#.*)?", values[0]) if len(values) == 1 else None
    return None if match is None else match[1]


def _find_optional_lines(text: str) -> frozenset[int]:
    """Return the numbers of the lines that a Python file can do without: those in a ``try`` that catches the failure."""
    tree = parse_python(text)
    if tree is None:
        return frozenset()
    caught = (node for node in ast.walk(tree) if isinstance(node, ast.Try) and node.handlers)
    harmless = (node for node in caught if not any(_raises(handler) for handler in node.handlers))
    return frozenset(line for node in harmless for part in node.body for line in _list_lines(part))


def _find_told_lines(text: str) -> frozenset[int]:
    """Return the numbers of the lines of a Python file with texts that it prints, or that explain it or an argument."""
    nodes = [*ast.walk(parse_python(text) or ast.Module([], []))]
    statements = (node for node in nodes if isinstance(node, ast.Expr))
    printed = (node for node in statements if isinstance(node.value, ast.Constant) or _is_print(node.value))
    explained = (node.value for node in nodes if isinstance(node, ast.keyword) and node.arg in _EXPLAINING)
    told = {line for node in printed for line in _list_lines(node)}
    return frozenset(told | {line for node in explained if _has_all_names(node, text) for line in _list_lines(node)})


def _has_all_names(node: ast.expr, text: str) -> bool:
    """Whether a text has all the names of packages on its lines: another argument may follow on the last."""
    lines = text.splitlines()[node.lineno - 1 : node.end_lineno]
    typed = (part.value for part in ast.walk(node) if isinstance(part, ast.Constant) and isinstance(part.value, str))
    return sum(len(_TOLD.findall(part)) for part in typed) == len(_TOLD.findall("\n".join(lines)))


def _find_unused_lines(text: str, bare: str) -> frozenset[int]:
    """Return the numbers of the lines of a launch file in Python that assign a name which nothing there reads.

    ``bare``: the text without the lines that are comments.
    """
    tree = parse_python(text)
    assigned = (node for node in ast.walk(tree or ast.Module([], [])) if isinstance(node, ast.Assign))
    named = ((node.targets[0].id, node) for node in assigned if isinstance(node.targets[0], ast.Name))
    # A name that stands in a text may be read from there; a module of that name is another thing.
    words = Counter(re.findall(r"\w+", _IMPORT.sub("", bare)))
    once = ((name, node) for name, node in named if len(node.targets) == 1 and words[name] == 1)
    return frozenset(line for _, node in once for line in _list_lines(node))


def _is_print(node: ast.expr) -> bool:
    return isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "print"


def _raises(handler: ast.ExceptHandler) -> bool:
    return any(isinstance(node, ast.Raise) for node in ast.walk(handler))


def _list_lines(node: ast.stmt | ast.expr) -> range:
    return range(node.lineno, (node.end_lineno or node.lineno) + 1)


def _find_joined_paths(text: str, match: re.Match[str], searched: int, unused: frozenset[int]) -> list[str]:
    """Return the paths that Python joins to a package's folder: in the same call, or where it uses the name of the folder.

    ``searched``: how many times the text was searched for such a name; ``unused``: the lines whose paths nothing reads.
    """
    joined = _AT_ONCE.match(text, match.end())
    line = text.rfind("\n", 0, match.start()) + 1
    assigned = _ASSIGNED.match(text[line : match.start()]) if match.start() - line < _LONGEST_LINE else None
    joins = [] if joined is None else [joined]
    if assigned is not None and searched <= _MOST_NAMES:
        joins += re.finditer(rf"\b{assigned.group(1)}{_JOINED}", text)
    if unused:
        joins = [join for join in joins if text.count("\n", 0, join.start("joined")) + 1 not in unused]
    return [_join_typed(join["joined"], is_part=join["more"] is not None) for join in joins] or [""]


def _join_typed(joined: str, *, is_part: bool) -> str:
    """Return the path of texts that are joined; with a slash at its end where more may follow, or it is a single name."""
    typed = ["".join(_TYPED.findall(texts)) for texts in _QUOTED_TEXTS.findall(joined)]
    inside = "/".join(filter(None, (part.strip("/") for part in typed)))
    is_open = typed[-1].endswith("/") or "/" not in inside or (is_part and "." not in typed[-1])
    return f"/{inside}/" if is_open and inside else f"/{inside}"


def _remove_comments(text: str, suffix: str) -> str:
    """Return the text with its comments replaced by blanks."""
    if suffix in {".py", ".yaml", ".yml"}:
        return re.sub(r"(?m)^[ \t]*#.*$", lambda m: " " * len(m.group(0)), text)
    parts: list[str] = []
    at = 0
    while (begin := text.find("<!--", at)) >= 0:
        end = text.find("-->", begin)
        end = len(text) if end < 0 else end + 3
        parts += [text[at:begin], " " * (end - begin)]
        at = end
    return "".join((*parts, text[at:]))
