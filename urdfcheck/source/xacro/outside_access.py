"""What an expansion reads from outside: files in reach, packages that are found, and some environment variables."""

from __future__ import annotations

import fnmatch
import os
from collections.abc import Callable, Mapping
from glob import has_magic
from pathlib import Path
from typing import Any
from xml.dom import minidom

from urdfcheck.core import Location
from urdfcheck.source.package.finder import PackageFinder, format_path
from urdfcheck.source.text.xml import Definition, Element, SourceFile, XmlError
from urdfcheck.source.xacro.expansion_state import (
    ENVIRONMENT,
    NODES_OF_FILE,
    ExpansionStoppedError,
    ExpansionTrace,
    UnknownPackageError,
    YamlFileError,
)
from urdfcheck.source.xacro.expressions.compile_expression import ExpressionRefusedError
from urdfcheck.source.xacro.origins import OutputDefect
from urdfcheck.source.xacro.parsed_files import parse_shared
from urdfcheck.system.observing.questions import read_variable

# Stands for the order in which sets are gone through, which is random unless this variable is set.
HASH_SEED = "PYTHONHASHSEED"
# The variables that any file may read: they are the same for all who build it for one distribution of ROS.
READABLE_ENVIRONMENT = frozenset({"ROS_DISTRO", "ROS_PYTHON_VERSION", "ROS_VERSION"})


class FileAccess:
    """Replacements for xacro's own access to files, packages and the environment."""

    def __init__(
        self,
        path: Path,
        finder: PackageFinder,
        *,
        extra_environment: frozenset[str],
        trace: ExpansionTrace,
        variables: Mapping[str, str],
    ) -> None:
        """``variables``: those of the environment that have another value than here."""
        self.path = path
        self.finder = finder
        self.environment = READABLE_ENVIRONMENT | extra_environment
        self.variables = variables
        self.set_order = variables.get(HASH_SEED, "")
        self.trace = trace
        self.files: dict[str, SourceFile] = {}
        self.trees: dict[str, Element] = {}
        # The folders that expressions were told.
        self.places: set[str] = set()

    def get_current_file(self) -> str:
        """Return the file that is being read."""
        import xacro

        return str(xacro.filestack[-1] if xacro.filestack else self.path)

    def get_current_folder(self) -> str:
        """Return the folder of the file that is being read: ``$(dirname)``."""
        return self._note_place(os.path.dirname(os.path.abspath(self.get_current_file())))

    def _note_place(self, path: str) -> str:
        """Remember a folder that the file gets to know: no expression should depend on it."""
        if len(path) > 1:
            self.places.add(path)
        return path

    def wrap_abs_filename(self, original: Callable[[str], str]) -> Callable[[str], str]:
        """Wrap xacro's ``abs_filename_spec``, which completes a path."""

        def complete_path(spec: str) -> str:
            path = original(spec)
            self._note_place(os.path.dirname(path) if path != spec else "")
            return path

        return complete_path

    def ensure_reach(self, path: Path) -> None:
        """Stop the expansion if a file may not be opened.

        :raises ExpansionStoppedError: if it lies out of reach.
        """
        if not self.finder.can_open(path) and not self._is_missing_name(path):
            name = format_path(path)
            raise ExpansionStoppedError("out-of-reach", f"{name} is outside the folders that may be read", path=name)

    def _is_missing_name(self, path: Path) -> bool:
        """Whether a path is out of reach only by its hidden name, and no file has it: an argument in it may be empty."""
        return path.name.startswith(".") and self.finder.can_open(path.parent) and not os.path.lexists(path)

    def wrap_parse(self, original: Callable[..., Any]) -> Callable[..., Any]:
        """Wrap ``xacro.parse``, which reads the model and its includes."""

        def parse_located(inp: Any, filename: str | None = None) -> Any:
            return original(inp, filename) if inp is not None or filename is None else self._parse_file(Path(filename))

        return parse_located

    def _parse_file(self, path: Path) -> minidom.Document:
        import xacro

        self.trace.count_nodes(NODES_OF_FILE)
        self.ensure_reach(path)
        path = self.finder.find_source(path)
        name = format_path(path)
        try:
            source = SourceFile.read(path, name)
        except OSError as error:
            xacro.filestack.pop()
            raise xacro.XacroException(f"{error.strerror}: {error.filename}", exc=error) from error
        source.ensure_utf_8("xacro")
        parsed = parse_shared(source)
        self.files[name] = parsed.source
        self.trees[name] = parsed.tree
        return parsed.copy_document()

    def locate_defect(self, defect: OutputDefect) -> Location:
        """Return the place of what xacro writes wrongly; of a processing instruction, its text in the file that it is from."""
        at, target = defect.location, defect.data.get("target")
        if target is None or at.span is None:
            return at
        file = self.files[at.span.file]
        start = file.text.find(f"<?{target}")
        end = file.text.find("?>", start)
        return at if start < 0 or end < 0 else Location(at.subject, file.make_span(start, end + 2))

    def find_matching_files(self, pattern: str) -> list[str]:
        """Return the files that a pattern matches, like glob, without listing a folder out of reach."""
        places = [""]
        for part in Path(pattern).parts:
            if has_magic(part):
                places = [str(self.finder.find_source(Path(folder))) for folder in places]
                places = [os.path.join(folder, name) for folder in places for name in self._match_names(folder, part)]
            else:
                places = [os.path.join(folder, part) for folder in places]
        for path in places:
            self.ensure_reach(Path(path))  # before its existence is probed
        return [path for path in places if os.path.lexists(path)]

    def _match_names(self, folder: str, pattern: str) -> list[str]:
        folder = folder or os.curdir
        self.ensure_reach(Path(folder))
        names = [n for n in _list_file_names(folder) if pattern.startswith(".") or not n.startswith(".")]
        self.trace.count_nodes(len(names))
        return fnmatch.filter(names, pattern)

    def load_yaml(self, filename: str, evaluate_number: Callable[[str], float]) -> Any:
        """Return a yaml file's content in xacro's wrappers, which record each value that is read."""
        import xacro

        from urdfcheck.source.text.yaml.values import YamlReadError
        from urdfcheck.source.xacro.expressions.yaml_values import read_yaml

        path = Path(xacro.abs_filename_spec(filename))
        self.trace.count_nodes(NODES_OF_FILE)
        self.ensure_reach(path)
        path = self.finder.find_source(path)
        name = format_path(path)
        xacro.filestack.append(filename)
        try:
            source = SourceFile.read(path, name, declares=False)
            source.ensure_utf_8("xacro")
            return read_yaml(source, self.trace.record_read, evaluate_number, self.trace.record_key)
        except YamlReadError as error:
            raise YamlFileError(name, str(error), error.span, tag=error.tag) from error
        except XmlError as error:
            if error.reason == "too-large":
                raise
            raise YamlFileError(name, str(error), error.span) from error
        except (xacro.XacroException, ExpressionRefusedError):
            raise
        except Exception as error:
            # yaml's message names line and column, and spans several lines.
            text = " ".join(str(error).split())
            raise xacro.XacroException(f"yaml file {filename}: {text}") from error
        finally:
            xacro.filestack.pop()

    def find_package(self, package: str) -> str:
        """Return the folder of a package: ``$(find p)``.

        :raises UnknownPackageError: if it is not found.
        """
        folder = self.finder.find(package)
        if folder is None:
            raise UnknownPackageError(package)
        return self._note_place(str(folder))

    def read_environment(self, name: str) -> str:
        """Return a variable's value: ``$(env NAME)``. A variable that a file must not read counts as not set."""
        import xacro.substitution_args as substitution

        if name not in self.environment:
            raise substitution.SubstitutionException(f"environment variable {name!r} is not read")
        self._note_environment(name)
        value = self._read_variable(name)
        if value is None:
            raise substitution.SubstitutionException(f"environment variable {name!r} is not set")
        return value

    def read_optional_environment(self, name: str, default: Any = "") -> Any:
        """Return a variable's value or the default: ``$(optenv NAME default)``."""
        if name in self.environment:
            self._note_environment(name)
            value = self._read_variable(name)
            return default if value is None else value
        self.trace.report_once("environment-ignored", f"{name} is not read", self.trace.locate_cause(), variable=name)
        return default

    def _read_variable(self, name: str) -> str | None:
        return self.variables[name] if name in self.variables else read_variable(name)

    def _note_environment(self, name: str) -> None:
        """Note that a value is computed from a variable of ROS: it is the same for all who use one distribution only."""
        if name in READABLE_ENVIRONMENT:
            self.trace.record_read(Definition(ENVIRONMENT, name, None))


def _list_file_names(folder: str) -> list[str]:
    try:
        return sorted(os.listdir(folder))
    except OSError:
        return []
