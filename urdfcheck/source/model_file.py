"""One URDF or xacro file as planning sees it: what its text decides, without any expansion."""

from __future__ import annotations

import fnmatch
import glob
import re
from collections.abc import Iterable
from functools import lru_cache
from pathlib import Path

from urdfcheck.core.records import dataclass
from urdfcheck.source.package.file_kinds import is_srdf, is_xacro
from urdfcheck.source.package.finder import format_path
from urdfcheck.source.text.root_attributes import read_root_attributes
from urdfcheck.source.text.xml import COMMENT, Element, SourceFile, XmlError, parse_xml
from urdfcheck.source.xacro.file_contents import (
    can_stand_alone,
    defines_macros,
    has_links,
    has_only_macros,
    has_parts,
    is_include,
)
from urdfcheck.system.files import read_regular

# Limit on the includes of one file that are followed: beyond it a file counts as not included, and is checked as a model. In a
# hundred robots no file has more than 40.
MAX_INCLUDES = 2_000
# Characters of a file of which is kept what its tree decides.
_LONGEST_KEPT = 100_000
EXPRESSION = re.compile(r"\$[({][^)}$]*[)}]")
# What is typed of a computed name besides its ending, as in `arm_*.urdf.xacro`: `*.xacro` alone means any file.
_TYPED = re.compile(r"\w(?=.*\*)|(?<=\*)\w")
_INCLUDE = re.compile(r"""<xacro:include\s[^<>]*?filename\s*=\s*["']([^"']+)["']""")
_LINK = re.compile(r"""<link\s[^<>]*?name\s*=\s*["']([^"']*)["']""")
_JOINT_END = re.compile(r"""<(?:parent|child)\s[^<>]*?link\s*=\s*["']([^"']*)["']""")
_ROBOT = re.compile(r"<robot[\s>]")
# A file name in any text: what stands between separators and has a suffix.
_FILE_NAME = re.compile(r"""(?<![^\s"'<>/\\=,;()\[\]{}$:*?|])[^\s"'<>/\\=,;()\[\]{}$:*?|]+\.[A-Za-z][A-Za-z0-9_]*""")
# The package in which a path is, and its folders, as they precede the name of a file. A path that names no package is read from
# its begin only: from each of its letters it would take a second for 60 kB.
_FOLDERS = (
    r"""(?:\$\(find(?:-pkg-share)?\s+([\w.$()-]+?)\s*\)/|package://([\w.-]+)/|model://([\w.-]+)/|(?<![\w./-])/*)"""
    r"((?:[\w.-]+/)*)"
)
# How Python names a file by its package and the parts of its path.
_JOINED = re.compile(
    r"""(?:FindPackageShare|get_package_share_directory)\(\s*["']([\w-]+)["']\s*\)((?:\s*,\s*f?["'][\w./-]+["'])+)"""
)
_PART = re.compile(r"""["']/?([\w./-]+?)/?["']""")
# The root of a file of settings, and the elements that a launch file of ROS, or a model that is called one, has.
_SETTINGS = re.compile(r"(?:\s|<!--(?:[^-]|-(?!->))*-->)*<launchConfiguration[\s>/]")
_OF_ROS = re.compile(r"<(?:launch|node|include|param|rosparam|arg|group|robot)[\s>/]")
_FIRST_TAG = re.compile(r"<([A-Za-z_][\w:.-]*)")
# What xacro makes besides robots, by its root.
_FOREIGN_ROOTS = frozenset({"sdf", "world", "mujoco", "launch"})
_DECLARATION = re.compile(r"^\s*<\?xml[^>]*\?>")
# What a generator fills in, each form with the characters that it cannot lack: {{ name }}, {% if %}, <%= name %>, $NAME$, @NAME@,
# [URDF_ATTRIBUTE] in place of an attribute and the package [NAME], as MoveIt's setup assistant has them, "<your-package>" in a
# value, and the value "__robot_name__", but not of what xacro reads: there `__not_set__` says that none is given.
_PLACEHOLDERS = (
    ("{{", re.compile(r"(?<!\$)(\{\{\s*[A-Za-z_][\w.]*\s*\}\})")),
    ("{%", re.compile(r"(\{%-?\s*\w+[^%\n]*%\})")),
    ("<%", re.compile(r"(<%=?[^%\n]*%>)")),
    ("$", re.compile(r"(\$(?=\w*[A-Z])[A-Za-z_]\w{3,}\$)")),
    ("@", re.compile(r"(@[A-Z][A-Z0-9_]+@)")),
    ("[", re.compile(r"(\[[A-Z][A-Z0-9]*_[A-Z0-9_]*\])(?=\s*/?>)")),
    ("$(find", re.compile(r"\$\(find(?:-pkg-share)? +(\[[A-Z][A-Z0-9_]*\])\)")),
    ('="', re.compile(r"=\"[^\"<>\n]*(<[A-Za-z]\w*(?:[ _.-]\w+)*>)[^\"<>\n]*\"")),
    ('="__', re.compile(r"<(?!xacro:)\w[^<>]*?\s(?:value|default)=\"(__[a-z0-9]+(?:_[a-z0-9]+)+__)\"")),
)


@dataclass(frozen=True, slots=True)
class _TreeSummary:
    """What the tree of a file decides."""

    is_readable: bool
    includes: tuple[str, ...]
    only_macros: bool
    defines_macros: bool
    has_parts: bool
    stands_alone: bool
    has_links: bool
    robot_name: str


class ModelFile:
    """What the text of a model or macro file decides. The text itself is not kept; it is read again where more is asked."""

    def __init__(self, path: Path) -> None:
        self.path = path
        source = self._source
        text = self.text if source is None else source.text
        self.is_robot = _ROBOT.search(text) is not None
        self.placeholder = find_placeholder(text)
        self.is_blank = is_blank(text)
        self.is_empty = not any(tag in text for tag in ("<link", "<joint", "<xacro:"))
        # An include in a comment has been tried before: the file that it names may be a part.
        self.mentions = list(dict.fromkeys(_INCLUDE.findall(text)))[:MAX_INCLUDES]
        # Most URDF files need not be parsed here.
        self.is_xacro = is_xacro(path) or "xmlns:xacro" in text
        needs_tree = bool(self.mentions) or self.is_xacro or is_srdf(path)
        examine = _examine_known_text if len(text) <= _LONGEST_KEPT else _examine_text
        contents = examine(text) if needs_tree and source is not None else _examine_tree(None)
        self.is_foreign = self.is_xacro and not self.is_robot and _is_foreign(text)
        self.includes = list(contents.includes if contents.is_readable else self.mentions)[:MAX_INCLUDES]
        self.only_macros = self.is_xacro and contents.only_macros
        self.defines_macros = contents.defines_macros
        self.has_parts = contents.has_parts
        self.stands_alone = contents.stands_alone
        self.makes_robot = is_srdf(path) and contents.has_links
        self._robot_name: str | None = contents.robot_name if needs_tree else None

    @property
    def robot_name(self) -> str:
        """The name of the robot, with a NUL for each expression; empty if it has none."""
        if self._robot_name is None:
            self._robot_name = _clean_robot_name(_read_root_attributes(self._source).get("name", ""))
        return self._robot_name

    @property
    def has_name(self) -> bool:
        """Whether the robot has a name, or may get one."""
        return self.stands_alone if self.is_xacro else bool(self.robot_name)

    @property
    def names_links_elsewhere(self) -> bool:
        """Whether a joint of a plain URDF names a link that the file has not."""
        text = "" if self.is_xacro else self.text
        return not set(_JOINT_END.findall(text)) <= set(_LINK.findall(text))

    @property
    def outline(self) -> tuple[object, ...]:
        """All that the search for models asks of a file that is a model or a part of one: it decides what is checked."""
        return (
            *(
                self.is_robot,
                self.is_blank,
                self.is_empty,
                self.is_xacro,
                self.is_foreign,
                tuple(self.mentions),
                tuple(self.includes),
            ),
            *(self.only_macros, self.defines_macros, self.has_parts, self.stands_alone),
            *(self.robot_name, self.names_links_elsewhere, self.placeholder),
        )

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
        return _parse(self._source)

    @property
    def _source(self) -> SourceFile | None:
        try:
            return SourceFile.read(self.path, format_path(self.path))
        except (OSError, XmlError):
            return None

    def collect_file_names(self) -> set[str]:
        """Return the names of files that the text spells out."""
        return set(find_file_names(self.text))

    def compile_mesh_patterns(self) -> set[re.Pattern[str]]:
        """Return patterns for the names of meshes that hold expressions."""
        root = self.root if "<mesh" in self.text and "$" in self.text else None
        typed = [e.get("filename") for e in root.walk() if e.tag == "mesh"] if root is not None else []
        last = {EXPRESSION.sub("\0", name).rpartition("/")[2] for name in typed}
        names = ("*".join(map(glob.escape, name.split("\0"))) for name in last if "\0" in name)
        return {re.compile(fnmatch.translate(name)) for name in names}


def _examine_tree(root: Element | None) -> _TreeSummary:
    names = () if root is None else (e.get("filename") for e in root.walk() if is_include(e))
    return _TreeSummary(
        is_readable=root is not None,
        includes=tuple(dict.fromkeys(names)),
        only_macros=has_only_macros(root),
        defines_macros=defines_macros(root),
        has_parts=has_parts(root),
        stands_alone=can_stand_alone(root),
        has_links=has_links(root),
        robot_name=_clean_robot_name("" if root is None else root.get("name")),
    )


def _examine_text(text: str) -> _TreeSummary:
    """Return what the tree of a text decides; of one that cannot be parsed, what that of no tree does."""
    return _examine_tree(_parse(SourceFile(Path(), "", text)))


# An editor plans anew after each key, and nearly all files are as they were.
_examine_known_text = lru_cache(maxsize=256)(_examine_text)


def _is_foreign(text: str) -> bool:
    """Whether a xacro file without a robot makes something for another program: a world for Gazebo, or what has a grammar."""
    match = _FIRST_TAG.search(COMMENT.sub("", text))
    return "<!DOCTYPE" in text or (match is not None and match[1] in _FOREIGN_ROOTS)


def find_placeholder(text: str) -> str:
    """Return the first text in a file that a generator fills in before any program reads it; empty if it is not a template."""
    patterns = [pattern for mark, pattern in _PLACEHOLDERS if mark in text and pattern.search(text)]
    bare = COMMENT.sub("", text) if patterns else ""
    return next((match[1] for pattern in patterns if (match := pattern.search(bare))), "")


def is_blank(text: str) -> bool:
    """Whether a text in XML holds nothing, or nothing but comments."""
    body = _DECLARATION.sub("", text.lstrip("\ufeff"), count=1).strip()
    return not body or (body.startswith("<!--") and body.endswith("-->") and not COMMENT.sub("", body).strip())


def is_foreign_launch(text: str) -> bool:
    """Whether the text of a launch file in XML is another tool's: Eclipse, and what is built on it, keep their settings so."""
    return _SETTINGS.match(_DECLARATION.sub("", text.lstrip("\ufeff"), count=1)) is not None and not _OF_ROS.search(
        text
    )


def find_file_names(text: str) -> list[str]:
    """Return what looks like the name of a file in a text; of a name with blanks, its last word."""
    return _FILE_NAME.findall(text)


def names_file(text: str, inside: str, package: str) -> bool:
    """Whether a text names a file of a package, given by its path in it, outside comments in XML.

    ``$(find other)/urdf/camera.xacro`` names a file of another package, and ``$(find own)/urdf/camera.xacro`` that of this folder
    alone. So do ``FindPackageShare("other"), "urdf", "camera.xacro"`` and the like in Python.
    """
    name = inside.rpartition("/")[2]
    if name not in text:
        return False
    joined = _JOINED.sub(lambda m: f" $(find {m[1]})/{'/'.join(_PART.findall(m[2]))} ", COMMENT.sub("", text))
    for match in re.finditer(rf"{_FOLDERS}(?<![\w.-]){re.escape(name)}(?![\w.-])", joined):
        owner = match[1] or match[2] or match[3]
        if not owner or not package or "$" in owner:
            return True
        if owner == package and match[4] + name == inside:
            return True
    return False


def compile_includes(names: Iterable[str]) -> re.Pattern[str]:
    """Return the pattern of an include of a file with one of these names, also without the prefix."""
    listed = "|".join(map(re.escape, sorted(names)))
    return re.compile(rf"<(?:xacro:)?include\s[^<>]*(?<![\w.-])(?:{listed})[\"']")


def may_compute_name(typed: str, name: str) -> bool:
    """Whether the path of an include, as typed, computes a part of the file's name and may mean the file of this name."""
    last = typed.rpartition("/")[2]
    pattern = EXPRESSION.sub("*", last)
    return pattern != last and _TYPED.search(pattern) is not None and fnmatch.fnmatchcase(name, pattern)


def _parse(source: SourceFile | None) -> Element | None:
    try:
        return None if source is None else parse_xml(source)
    except XmlError:
        return None


def _read_root_attributes(source: SourceFile | None) -> dict[str, str]:
    try:
        return {} if source is None else read_root_attributes(source)
    except XmlError:
        return {}


def _clean_robot_name(name: str) -> str:
    return EXPRESSION.sub("\0", name.strip())
