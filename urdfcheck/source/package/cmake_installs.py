"""What a CMakeLists.txt and the files that it includes install into its package's share folder.

They are read as text and never run.
"""

from __future__ import annotations

import posixpath
import re
from collections.abc import Callable, Iterator, Mapping, Sequence

from urdfcheck.core.records import dataclass
from urdfcheck.source.package.installed_files import (
    MOST_ENTRIES,
    InstalledEntry,
    InstalledFiles,
    find_part_of_share,
    find_share_place,
    has_magic,
    normalize_source,
)

# A text without an end reaches to the end of the file, so that each character is matched once.
_TOKEN = re.compile(r'#[^\n]*|"(?:[^"\\]|\\.)*(?:"|\Z)|[()]|(?:\\.|[^\s()"#\\])+', re.DOTALL)
_VARIABLE = re.compile(r"\$\{(\w+)\}")
# Stands in values for the folder of the package.
_PACKAGE_DIR = "\1"
_CURRENT_DIR_VARIABLES = ("CMAKE_CURRENT_SOURCE_DIR", "CMAKE_CURRENT_LIST_DIR")
_SOURCE_DIR_VARIABLES = (*_CURRENT_DIR_VARIABLES, "CMAKE_SOURCE_DIR", "PROJECT_SOURCE_DIR")
# The most values of one variable and of one word that contains several variables, the most characters of these values and of all
# that were computed, the most commands with those repeated by loops, the most loops or files inside of each other, and the most
# files. What goes beyond counts as unknown.
_MOST_VALUES = 1_000
_MOST_CHARACTERS, _MOST_IN_ALL = 100_000, 10_000_000
_MOST_COMMANDS = 20_000
_MOST_NESTED = 20
_MOST_FILES = 100
# Commands that install nothing and read no folder of the package.
_QUIET = frozenset({
    "message", "find_package", "cmake_minimum_required", "if", "elseif", "else", "endif", "endforeach", "ament_package",
    "catkin_package", "unset", "option", "set_property", "target_link_libraries", "target_include_directories",
    "include_directories", "add_executable", "add_library", "ament_target_dependencies", "ament_export_dependencies",
    "ament_export_include_directories", "ament_export_libraries", "ament_export_targets", "add_compile_options",
})  # fmt: skip
# Other commands of CMake and ROS: they take the names of targets and variables, and install no folder by its name alone.
_OWN_COMMANDS = frozenset({
    "cmake_parse_arguments", "cmake_policy", "configure_file", "define_property", "enable_testing", "endfunction", "endmacro",
    "execute_process", "export", "file", "function", "include_guard", "install", "link_directories", "list", "macro",
    "mark_as_advanced", "math", "return", "separate_arguments", "set", "string", "try_compile", "try_run", "while", "endwhile",
})  # fmt: skip
_OWN_PREFIXES = ("add_", "ament_", "catkin_", "find_", "get_", "rosidl_", "set_", "target_")
# What ends the list of folders or files of an install command.
_KEYWORDS = frozenset({
    "DESTINATION", "TYPE", "RENAME", "PATTERN", "REGEX", "EXCLUDE", "PERMISSIONS", "CONFIGURATIONS", "COMPONENT", "OPTIONAL",
    "FILES_MATCHING", "USE_SOURCE_PERMISSIONS", "FILE_PERMISSIONS", "DIRECTORY_PERMISSIONS", "MESSAGE_NEVER",
    "EXCLUDE_FROM_ALL",
})  # fmt: skip
_EXPANSION_KEYWORDS = frozenset({"REMAP", "DEPENDS", "OUTPUT", "TARGET", "INSTALL", "DESTINATION"})


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class CmakeCommand:
    """A command of CMake."""

    name: str
    start: int
    end: int
    words: tuple[str, ...]
    """The arguments as typed."""
    ends: tuple[int, ...]
    """The offset at which each argument ends."""


def parse_commands(text: str) -> Iterator[CmakeCommand]:
    """Yield the commands of a file in order."""
    words: list[str] = []
    ends: list[int] = []
    name, start, depth = "", 0, 0
    for match in _TOKEN.finditer(text):
        token = match.group(0)
        if token.startswith("#"):
            continue
        if token == "(":
            depth += 1
        elif token == ")":
            depth = max(depth - 1, 0)
            if depth == 0 and name:
                yield CmakeCommand(name=name, start=start, end=match.end(), words=tuple(words), ends=tuple(ends))
                name, words, ends = "", [], []
        elif depth == 0:
            name, start, words, ends = token.lower(), match.start(), [], []
        else:
            words.append(token)
            ends.append(match.end())


def read_cmake_installs(
    commands: Sequence[CmakeCommand], package: str, read_text: Callable[[str], str | None]
) -> InstalledFiles:
    """Return what the commands install for a package of this name. Both branches of a condition count.

    ``read_text``: returns the text of another file of the package, or None.
    """
    reader = _CmakeReader(package, read_text)
    reader.run_commands(commands)
    return InstalledFiles(
        entries=tuple(reader.entries),
        is_complete=reader.is_complete,
        other_names=frozenset(reader.other_names),
        function_words=frozenset(reader.function_words),
        expanded_words=frozenset(reader.expanded_words),
    )


class _CmakeReader:
    """Follows variables, lists, loops, and the files that are included."""

    def __init__(self, package: str, read_text: Callable[[str], str | None]) -> None:
        self.package = package
        self.read_text = read_text
        # The folder whose CMakeLists.txt is read; the commands of the other files; how many are read inside of each other.
        self.folder = ""
        self.files: dict[str, list[CmakeCommand] | None] = {}
        self.open_files = 0
        self.values: dict[str, list[str]] = {
            "PROJECT_NAME": [package],
            "CMAKE_PROJECT_NAME": [package],
            "CATKIN_PACKAGE_SHARE_DESTINATION": [f"share/{package}"],
            "CATKIN_GLOBAL_SHARE_DESTINATION": ["share"],
            "CMAKE_INSTALL_DATADIR": ["share"],
            "CMAKE_INSTALL_DATAROOTDIR": ["share"],
            "CMAKE_INSTALL_PREFIX": [""],
            **{name: [_PACKAGE_DIR] for name in _SOURCE_DIR_VARIABLES},
        }
        self.entries: list[InstalledEntry] = []
        self.is_complete = True
        self.other_names: set[str] = set()
        self.function_words: set[str] = set()
        self.expanded_words: set[str] = set()
        self.count = 0
        self.characters = 0

    def run_commands(self, commands: Sequence[CmakeCommand]) -> None:
        """Run commands in order, the bodies of loops once for each value."""
        self.run_block(commands, _pair_loops(commands), 0, len(commands), depth=0)

    def run_block(
        self, commands: Sequence[CmakeCommand], loops: Mapping[int, int], start: int, end: int, *, depth: int
    ) -> None:
        """Run the commands from ``start`` to ``end``, which are in so many loops. ``loops``: see `_pair_loops`."""
        at = start
        while at < end:
            self.count += 1
            if self.count > _MOST_COMMANDS or self.characters > _MOST_IN_ALL or len(self.entries) > MOST_ENTRIES:
                self.is_complete = False
                return
            command = commands[at]
            if command.name == "foreach":
                last = min(loops.get(at, end), end)
                if depth == _MOST_NESTED:
                    self.is_complete = False
                    return
                for name, value in self.list_loop_values(command):
                    self.values[name] = [value]
                    self.run_block(commands, loops, at + 1, last, depth=depth + 1)
                at = last + 1
                continue
            self.run_command(command)
            at += 1

    def list_loop_values(self, loop: CmakeCommand) -> list[tuple[str, str]]:
        """Return the variable of a loop with each of its values."""
        name, *words = loop.words or ("",)
        plain = [word for word in words if word not in {"IN", "ITEMS", "LISTS", "RANGE"}]
        named = [f"${{{word}}}" for word in plain] if "LISTS" in words else plain
        return [(name, value) for value in self.expand_words(named)]

    def run_command(self, command: CmakeCommand) -> None:
        name, *words = command.words or ("",)
        if "xacro" in command.name:
            self.expanded_words.update(self.expand_words(command.words))
        if command.name == "set" and words[-1:] != ["PARENT_SCOPE"]:
            self.values[name] = self.expand_words(words)
        elif command.name == "list" and name == "APPEND" and words:
            appended = self.expand_words(words[1:])
            self.values[words[0]] = [*self.values.get(words[0], []), *appended][:_MOST_VALUES]
        elif command.name == "project":
            self.values["PROJECT_NAME"] = [name] if name else [self.package]
            self.values["PROJECT_SOURCE_DIR"] = [posixpath.join(_PACKAGE_DIR, self.folder)]
        elif command.name == "file" and name in {"GLOB", "GLOB_RECURSE"} and words:
            self.read_glob(words, recursive=name == "GLOB_RECURSE")
        elif command.name == "install":
            self.read_install(self.expand_words(command.words))
        elif command.name == "ament_auto_package" and "INSTALL_TO_SHARE" in command.words:
            rest = command.words[command.words.index("INSTALL_TO_SHARE") + 1 :]
            folders = self.expand_words(rest[: next((i for i, w in enumerate(rest) if w.isupper()), len(rest))])
            self.add_folders(folders, f"share/{self.package}")
        elif command.name == "add_subdirectory":
            self.add_subdirectory(command.words)
        elif command.name == "include":
            self.include_file(command.words)
        elif command.name == "xacro_add_files":
            self.read_expansions(self.expand_words(command.words))
        elif command.name not in _QUIET and command.name != "list":
            words = self.expand_words(command.words)
            self.other_names.update(part for word in words for part in word.split("/"))
            if command.name not in _OWN_COMMANDS and not command.name.startswith(_OWN_PREFIXES):
                self.function_words.update(words)

    def add_subdirectory(self, words: Sequence[str]) -> None:
        """Run the CMakeLists.txt of a folder, whose variables are its own."""
        folder = self.find_source_place(words)
        commands = None if folder is None else self.read_commands(posixpath.join(folder, "CMakeLists.txt"))
        if folder is None or commands is None or "EXCLUDE_FROM_ALL" in words:
            self.is_complete = False
            return
        values, outer = self.values, self.folder
        here = [posixpath.join(_PACKAGE_DIR, folder)]
        self.values = {**values, **dict.fromkeys(_CURRENT_DIR_VARIABLES, here)}
        self.folder = folder
        self.run_file(commands)
        self.values, self.folder = values, outer

    def include_file(self, words: Sequence[str]) -> None:
        """Run the commands of another file as if they stood here."""
        place = self.find_source_place(words)
        commands = None if place is None else self.read_commands(place)
        if place is None or commands is None:  # a module of CMake or of another package
            self.is_complete &= not words
            return
        before = self.values["CMAKE_CURRENT_LIST_DIR"]
        self.values["CMAKE_CURRENT_LIST_DIR"] = [posixpath.join(_PACKAGE_DIR, posixpath.dirname(place))]
        self.run_file(commands)
        self.values["CMAKE_CURRENT_LIST_DIR"] = before

    def run_file(self, commands: Sequence[CmakeCommand]) -> None:
        """Run the commands of a file that another one names."""
        if self.open_files == _MOST_NESTED:
            self.is_complete = False
            return
        self.open_files += 1
        self.run_commands(commands)
        self.open_files -= 1

    def read_commands(self, place: str) -> list[CmakeCommand] | None:
        """Return the commands of a file of the package; None if it cannot be read."""
        if place not in self.files and len(self.files) < _MOST_FILES:
            text = self.read_text(place)
            self.files[place] = None if text is None else list(parse_commands(text))
        return self.files.get(place)

    def find_source_place(self, words: Sequence[str]) -> str | None:
        """Return the path in the package that the first of some words means; None for an unknown one and one outside."""
        named = self.expand_words(words[:1])
        return self.normalize_path(named[0]) if len(named) == 1 and "$" not in named[0] else None

    def normalize_path(self, path: str) -> str | None:
        """Return a path without needless parts, from the folder of the package on; None for one that leads out of it."""
        if path.startswith(_PACKAGE_DIR):
            return normalize_source(path[len(_PACKAGE_DIR) :].lstrip("/"))
        return None if path.startswith("/") else normalize_source(posixpath.join(self.folder, path))

    def read_glob(self, words: Sequence[str], *, recursive: bool) -> None:
        """Note the patterns of ``file(GLOB …)`` as the values of its variable."""
        rest = [word for word in words[1:] if word != "CONFIGURE_DEPENDS"]
        if rest[:1] == ["RELATIVE"]:
            patterns = self.expand_words(rest[2:])
        else:  # whole paths, which a file in another folder may use
            whole, here = (_PACKAGE_DIR, "/", "$"), posixpath.join(_PACKAGE_DIR, self.folder)
            patterns = [p if p.startswith(whole) else posixpath.join(here, p) for p in self.expand_words(rest)]
        self.values[words[0]] = ["${recursive}"] if recursive else patterns

    def read_install(self, words: list[str]) -> None:
        """Note what ``install(DIRECTORY | FILES | PROGRAMS …)`` installs into the share folder."""
        kind = words[0] if words else ""
        if kind not in {"DIRECTORY", "FILES", "PROGRAMS"}:
            if kind not in {"TARGETS", "EXPORT"}:  # scripts and code may install anything
                self.is_complete = False
            return
        count = next((i for i, word in enumerate(words[1:]) if word in _KEYWORDS), len(words) - 1)
        named, rest = words[1 : count + 1], words[count + 1 :]
        if "DESTINATION" not in rest[:-1]:
            self.is_complete = False
            return
        destination = rest[rest.index("DESTINATION") + 1]
        if kind == "DIRECTORY":
            self.add_folders(named, destination, rest)
        else:
            renamed = rest[rest.index("RENAME") + 1] if "RENAME" in rest[:-1] else ""
            self.add_files(named, destination, renamed)

    def read_expansions(self, words: list[str]) -> None:
        """Note what ``xacro_add_files(FILE … INSTALL DESTINATION …)`` makes out of xacro files: the same names without .xacro."""
        count = next((i for i, word in enumerate(words) if word in _EXPANSION_KEYWORDS), len(words))
        if "INSTALL" not in words:
            return
        folder = words[words.index("DESTINATION") + 1] if "DESTINATION" in words[:-1] else ""
        target = self.find_target(f"share/{self.package}/{folder}")
        for file in words[:count] if target is not None else ():
            source = self.normalize_path(file)
            if source is None or "${" in file or has_magic(file):
                self.is_complete = False
            else:
                place = posixpath.join(target or "", posixpath.basename(source).removesuffix(".xacro"))
                self.entries.append(InstalledEntry(source=source, target=place, kind="made"))

    def find_target(self, destination: str) -> str | None:
        """Return the place in the share folder that a destination means; None for another one or an unknown one."""
        if "${" in destination or "$<" in destination or "$ENV" in destination:
            self.is_complete = False
            return None
        return find_share_place(destination, self.package)

    def add_folders(self, folders: Sequence[str], destination: str, options: Sequence[str] = ()) -> None:
        target = self.find_target(destination)
        if target is None and "$" in destination:
            return
        wanted, excluded = _read_patterns(options)
        for folder in folders:
            source = self.normalize_path(folder)
            if source is None or "${" in folder or has_magic(folder):
                self.is_complete &= target is None
                continue
            whole = folder.endswith(("/", "/.")) or folder == "." or not source
            name = "" if whole else posixpath.basename(source)
            if target is not None:
                place = posixpath.join(target, name) if name else target
            else:
                # The tree may be as it is in the install prefix: share/ with a folder of the package's name in it.
                inside = find_part_of_share(posixpath.join(destination, name), self.package)
                if inside is None:
                    continue
                source, place = posixpath.join(source, inside) if inside else source, ""
            entry = InstalledEntry(source=source, target=place, kind="folder", wanted=wanted, excluded=excluded)
            self.entries.append(entry)

    def add_files(self, files: Sequence[str], destination: str, renamed: str) -> None:
        target = self.find_target(destination)
        if target is None:
            return
        for file in files:
            source = self.normalize_path(file)
            if source is None or "${" in file:
                self.is_complete = False
            elif has_magic(source):
                self.is_complete &= not has_magic(posixpath.dirname(source))
                self.entries.append(InstalledEntry(source=source, target=target, kind="pattern"))
            else:
                place = posixpath.join(target, renamed or posixpath.basename(source))
                self.entries.append(InstalledEntry(source=source, target=place, kind="file"))

    def expand_words(self, words: Sequence[str]) -> list[str]:
        """Return the texts that words mean; an unknown variable stays as it is."""
        texts: list[str] = []
        for word in words:
            expanded = _expand_variables(word, self.values)
            texts += expanded
            self.characters += sum(map(len, expanded))
            if len(texts) > _MOST_VALUES or self.characters > _MOST_IN_ALL:
                self.is_complete = False
                break
        return texts[:_MOST_VALUES]


def _pair_loops(commands: Sequence[CmakeCommand]) -> dict[int, int]:
    """Return the index of the command that ends a loop by that of the one that begins it; without those that nothing ends."""
    ends: dict[int, int] = {}
    open_loops: list[int] = []
    for index, command in enumerate(commands):
        if command.name == "foreach":
            open_loops.append(index)
        elif command.name == "endforeach" and open_loops:
            ends[open_loops.pop()] = index
    return ends


def _expand_variables(word: str, values: Mapping[str, list[str]]) -> list[str]:
    texts = [word.strip('"')]
    for variable in dict.fromkeys(_VARIABLE.findall(word)):
        typed, known = f"${{{variable}}}", values.get(variable, ())
        times = sum(text.count(typed) for text in texts)
        size = len(known) * sum(map(len, texts)) + times * sum(map(len, known))
        if variable in values and size <= _MOST_CHARACTERS:
            texts = [t.replace(typed, value) for t in texts for value in known][:_MOST_VALUES]
    return [part for text in texts for part in text.split(";")]


def _read_patterns(options: Sequence[str]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the wanted and the excluded patterns of ``install(DIRECTORY …)``.

    ``REGEX`` is left out: a stranger's regular expression can take hours.
    """
    wanted: list[str] = []
    excluded: list[str] = []
    for index, word in enumerate(options[:-1]):
        if word == "PATTERN" and options[index + 2 : index + 3] == ["EXCLUDE"]:
            excluded.append(options[index + 1])
        elif word == "PATTERN" and "FILES_MATCHING" in options:
            wanted.append(options[index + 1])
    return (() if "REGEX" in options else tuple(wanted)), tuple(excluded)
