"""The configuration: ``urdfcheck.toml`` or ``[tool.urdfcheck]`` in pyproject.toml, found upwards from each checked file."""

from __future__ import annotations

import difflib
import math
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import tomli

from urdfcheck.core import Severity, UrdfcheckError
from urdfcheck.policy.baseline import DEFAULT_NAME, STALE_BASELINE
from urdfcheck.policy.policy import TIERS, Policy
from urdfcheck.policy.suppression import SuppressionEntry
from urdfcheck.rules import load_rules, select_rules
from urdfcheck.source.package.finder import format_path
from urdfcheck.source.reach import OUT_OF_REACH, FileReach
from urdfcheck.source.text.globs import match_any_pattern, split_relative_path
from urdfcheck.source.text.toml import Key, locate_keys
from urdfcheck.system.files import read_regular

# The largest pyproject.toml of well-known projects has 60 kB; tomli takes a second for each megabyte.
MAX_FILE_SIZE = 4 * 1024**2
# Entries of a list or table, and characters of a text: the file may be a stranger's, and each entry is tried on each model.
MAX_ENTRIES, MAX_TEXT_LENGTH = 1_000, 1_000
OWN_FILE, PROJECT_FILE = "urdfcheck.toml", "pyproject.toml"
FAIL_ON = ("error", "warning", "info", "never")
UNCHECKED = ("error", "warning")
_KINDS = {float: "a number", int: "a whole number", str: "a text", bool: "true or false", list: "a list"}
TARGETS = ("gazebo", "mujoco", "drake", "bullet", "isaac", "moveit", "rviz", "pinocchio", "ros2_control", "kdl")


@dataclass(frozen=True, slots=True, kw_only=True)
class Section:
    """Settings of the rules in the table, or in a ``[[paths]]`` section; None where nothing is set."""

    match: tuple[str, ...] = ()
    """Patterns of the files that the section is for."""
    select: frozenset[str] | None = None
    """Codes, whatever words they were typed as."""
    ignore: frozenset[str] | None = None
    severity: Mapping[str, str] = field(default_factory=dict)
    """Code → severity."""
    options: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    """Code → option → value."""
    target: tuple[str, ...] | None = None
    pedantic: bool | None = None
    """Whether nothing is lowered or left out."""
    key: Key = ()
    """Path of the section in the table."""


@dataclass(frozen=True, slots=True)
class NamedModel:
    """A ``[[models]]`` entry: the file is checked with these arguments, under this name if it has one."""

    path: Path
    name: str | None
    arguments: Mapping[str, str]


@dataclass(frozen=True, slots=True, kw_only=True)
class Config:
    """The configuration of the files below a folder, without the command line."""

    root: Path
    """The folder; ids of models are relative to it."""
    file: Path | None = None
    """The configuration file; None for the defaults."""
    sections: tuple[Section, ...] = (Section(),)
    """The table itself, then its ``[[paths]]``."""
    fail_on: str = "error"
    tier: str = "full"
    unchecked: str | tuple[str, ...] = "error"
    """How bad it is that a model cannot be checked: error | warning, or patterns of the models for which it is a warning."""
    strict_baseline: bool = False
    """Whether a baseline entry whose finding is gone is an error."""
    exclude: tuple[str, ...] = ()
    packages: Mapping[str, Path] = field(default_factory=dict)
    package_path: tuple[Path, ...] = ()
    baseline: Path | None = None
    models: tuple[NamedModel, ...] = ()
    suppress: tuple[tuple[str, SuppressionEntry], ...] = ()
    """Entries with the pattern of the models that they are for, empty for all."""

    @property
    def target(self) -> tuple[str, ...]:
        """Programs that will read the models, unless a section names others."""
        return self.sections[0].target or ()

    def excludes(self, path: Path) -> bool:
        """Whether a file that is discovered in a folder is skipped."""
        return bool(self.exclude) and match_any_pattern(self.exclude, split_relative_path(path, self.root))

    def grade_unchecked(self, path: Path) -> str:
        """Return how bad it is that this model cannot be checked: error | warning."""
        if isinstance(self.unchecked, str):
            return self.unchecked
        return "warning" if match_any_pattern(self.unchecked, split_relative_path(path, self.root)) else "error"

    def get_sections(self, path: Path) -> tuple[Section, ...]:
        """Return the table, and the sections that match a file."""
        names = split_relative_path(path, self.root)
        return tuple(s for i, s in enumerate(self.sections) if not i or match_any_pattern(s.match, names))

    def get_suppressions(self, path: Path) -> tuple[SuppressionEntry, ...]:
        """Return the suppressions for a file."""
        names = split_relative_path(path, self.root)
        return tuple(entry for pattern, entry in self.suppress if not pattern or match_any_pattern([pattern], names))


@dataclass(frozen=True, slots=True, kw_only=True)
class CliOverrides:
    """Settings of the command line, which override every configuration; None where it sets nothing."""

    select: frozenset[str] | None = None
    ignore: frozenset[str] | None = None
    fail_on: str | None = None
    tier: str | None = None
    target: tuple[str, ...] | None = None
    unchecked: str | None = None
    baseline: Path | None = None
    shows_all: bool = False
    """Whether notes on request are reported too."""
    pedantic: bool = False
    """Whether notes on request are reported too, and lowered severities are not lowered."""


@dataclass(frozen=True, slots=True, kw_only=True)
class EffectiveConfig:
    """The configuration of one file after sections and command line."""

    policy: Policy
    fail_on: str
    """Least severity of a finding that fails the run."""
    baseline: Path | None


@dataclass(slots=True)
class ConfigResolver:
    """Finds the configuration of each file: the nearest one above it, read once."""

    overrides: CliOverrides = field(default_factory=CliOverrides)
    isolated: bool = False
    """Whether configuration files are ignored."""
    paths: tuple[Path, ...] = ()
    """Paths of the command line; without a configuration file, ids below one of them are relative to the same folder."""
    _configs_by_folder: dict[Path, Config | None] = field(default_factory=dict)

    def for_path(self, path: Path) -> Config:
        """Return the configuration of a file or folder.

        :raises UrdfcheckError: as for :func:`find_config`.
        """
        folder = Path(os.path.abspath(path))
        folder = folder if os.path.isdir(folder) else folder.parent  # Path.is_dir() raises where access is denied
        found = None if self.isolated else self._find_above(folder)
        if found is not None:
            return found
        starts = (Path(os.path.abspath(start)) for start in self.paths)
        return make_default_config(next((s for s in starts if s == folder or s in folder.parents), folder))

    def _find_above(self, folder: Path) -> Config | None:
        climbed: list[Path] = []
        found: Config | None = None
        for level in (folder, *folder.parents):
            if level in self._configs_by_folder:
                found = self._configs_by_folder[level]
                break
            climbed.append(level)
            found = _read_folder_config(level)
            if found is not None:
                break
        self._configs_by_folder.update(dict.fromkeys(climbed, found))
        return found

    def resolve(self, config: Config, path: Path) -> EffectiveConfig:
        """Return the effective configuration of a file."""
        return resolve_config(
            config,
            sections=config.get_sections(path),
            suppressions=config.get_suppressions(path),
            unchecked=config.grade_unchecked(path),
            overrides=self.overrides,
        )


def resolve_config(
    config: Config,
    *,
    sections: Sequence[Section],
    suppressions: tuple[SuppressionEntry, ...],
    unchecked: str,
    overrides: CliOverrides,
) -> EffectiveConfig:
    """Merge the sections, each over those before it, and the command line over all of them.

    ``unchecked``: see `Config.grade_unchecked`.
    """
    everything = frozenset(load_rules())
    codes = everything if overrides.select is None else overrides.select
    requested = everything if overrides.shows_all else overrides.select or frozenset()
    severities = {STALE_BASELINE: "error"} if config.strict_baseline else {}
    options: dict[str, dict[str, Any]] = {}
    targets: tuple[str, ...] = ()
    pedantic = False
    for number, section in enumerate(sections):
        if overrides.select is None and section.select is not None:
            codes = codes | section.select if number else section.select
            requested |= section.select
        if overrides.ignore is None and section.ignore is not None:
            codes -= section.ignore
        severities.update(section.severity)
        requested |= section.severity.keys()
        requested |= section.options.keys()
        for code, values in section.options.items():
            options[code] = {**options.get(code, {}), **values}
        targets = targets if section.target is None else section.target
        pedantic = pedantic if section.pedantic is None else section.pedantic
    pedantic = pedantic or overrides.pedantic
    policy = Policy(
        codes=codes - (overrides.ignore or frozenset()),
        unrequested=everything - requested,
        pedantic=pedantic,
        tier=overrides.tier or config.tier,
        options=options,
        severities=severities,
        targets=targets if overrides.target is None else overrides.target,
        suppress=suppressions,
        unchecked=Severity.parse(overrides.unchecked or unchecked),
    )
    return EffectiveConfig(
        policy=policy,
        fail_on=overrides.fail_on or config.fail_on,
        baseline=config.baseline if overrides.baseline is None else overrides.baseline,
    )


def find_config(start: Path) -> Config:
    """Return the configuration of a path.

    Without one, return the defaults with the enclosing git repository (or the working directory) as root.

    :raises UrdfcheckError: for a file that is not TOML, an unknown key or a value of the wrong type.
    """
    return ConfigResolver().for_path(start)


def make_default_config(start: Path) -> Config:
    """Return the defaults, for a path without a configuration file.

    Ids of models are relative to the repository, or the folder of their baseline, or the working directory.
    """
    start = start.absolute()
    for folder in (start, *start.parents):
        if os.path.exists(folder / ".git") or os.path.isfile(folder / DEFAULT_NAME):
            return Config(root=folder)
    return Config(root=Path.cwd())


def _read_folder_config(folder: Path) -> Config | None:
    """Read the configuration in a folder."""
    own, project = folder / OWN_FILE, folder / PROJECT_FILE
    if os.path.isfile(own):
        text = _read_text(own)
        return _parse_config(own, text, table=_parse_toml(own, text), key=())
    if os.path.isfile(project):
        text = _read_text(project)
        tools = _parse_toml(project, text).get("tool", {})
        table = tools.get("urdfcheck") if isinstance(tools, dict) else None
        if table is not None:
            return _parse_config(project, text, table=table, key=("tool", "urdfcheck"))
    return None


def read_typed_table(config: Config) -> tuple[Mapping[str, Any], Mapping[Key, str]]:
    """Return the table of a configuration as typed, and the place of each of its keys as ``file:line``."""
    if config.file is None:
        return {}, {}
    text = _read_text(config.file)
    table, own = _parse_toml(config.file, text), () if config.file.name == OWN_FILE else ("tool", "urdfcheck")
    for key in own:
        table = table[key]
    name = format_path(config.file)
    found = locate_keys(text)
    return table, {key[len(own) :]: f"{name}:{line}" for key, line in found.items() if key[: len(own)] == own}


def _read_text(path: Path) -> str:
    """Read a configuration, which may be a stranger's: of bounded size, and not through a link out of reach."""
    try:
        if not FileReach.from_paths([path], []).can_open(path):
            raise UrdfcheckError(f"{format_path(path)}: {OUT_OF_REACH}")
        return read_regular(path, MAX_FILE_SIZE).decode("utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise UrdfcheckError(f"{format_path(path)}: {error}") from None


def _parse_toml(path: Path, text: str) -> dict[str, Any]:
    try:
        table: dict[str, Any] = tomli.loads(text)
        return table
    # A number with more digits than Python reads raises a plain ValueError.
    except (ValueError, RecursionError) as error:
        raise UrdfcheckError(f"{format_path(path)}: {error}") from None


_KEYS = (
    *("select", "ignore", "severity", "options", "target", "fail-on", "tier", "exclude", "packages", "package-path"),
    *("pedantic", "unchecked", "baseline", "strict-baseline", "paths", "models", "suppress"),
)
_SECTION_KEYS = ("match", "select", "ignore", "severity", "options", "target", "pedantic")
_MODEL_KEYS = ("path", "name", "arguments")
_SUPPRESS_KEYS = ("codes", "subject", "path", "reason")


def _parse_config(path: Path, text: str, *, table: Any, key: Key) -> Config:
    reader = _TableReader(path, text, table=table, key=key)
    reader.ensure_known_keys(_KEYS)
    root = path.parent
    packages, package_path = reader.read_texts("packages"), reader.read_words("package-path") or ()
    for name, folder in packages.items():
        reader.ensure_folder(("packages", name), "packages", folder)
    for number, folder in enumerate(package_path):
        reader.ensure_folder(("package-path", number), "package-path", folder)
    baseline = reader.read_text("baseline")
    if baseline is not None and not FileReach.from_paths([path], []).can_open(root / baseline):
        raise reader.make_type_error("baseline", "a file of the repository (name it on the command line)")
    return Config(
        root=root,
        file=path,
        sections=tuple(_parse_section(r, key) for r in (reader, *reader.read_tables("paths", _SECTION_KEYS))),
        fail_on=reader.read_choice("fail-on", FAIL_ON, "error"),
        tier=reader.read_choice("tier", TIERS, "full"),
        unchecked=_parse_unchecked(reader),
        strict_baseline=reader.read_flag("strict-baseline"),
        exclude=reader.read_words("exclude") or (),
        packages={name: root / folder for name, folder in packages.items()},
        package_path=tuple(root / p for p in package_path),
        baseline=None if baseline is None else root / baseline,
        models=_parse_models(reader),
        suppress=tuple(_parse_suppression(entry) for entry in reader.read_tables("suppress", _SUPPRESS_KEYS)),
    )


def _parse_unchecked(reader: _TableReader) -> str | tuple[str, ...]:
    """Read how bad it is that a model cannot be checked, or the patterns of the models for which it is accepted."""
    value = reader.table.get("unchecked", "error")
    if isinstance(value, list):
        return reader.read_words("unchecked") or ()
    if value not in UNCHECKED:
        raise reader.make_type_error("unchecked", f"one of {', '.join(UNCHECKED)}, or a list of patterns for models")
    return str(value)


def _parse_section(reader: _TableReader, table: Key) -> Section:
    of_paths = reader.key != table
    match = reader.read_words("match") or ()
    if of_paths and not match:
        raise reader.make_type_error("match", "a list of patterns for files, which every section of paths needs")
    target = reader.read_words("target")
    for number, name in enumerate(target or ()):
        if (wrong := explain_unknown_target(name)) is not None:
            raise reader.make_error(("target", number), wrong)
    return Section(
        match=match,
        select=reader.read_codes("select"),
        ignore=reader.read_codes("ignore"),
        severity=reader.read_severities(),
        options=reader.read_options(),
        target=target,
        pedantic=reader.read_flag("pedantic") if "pedantic" in reader.table else None,
        key=reader.key[len(table) :],
    )


def _parse_models(reader: _TableReader) -> tuple[NamedModel, ...]:
    found: list[NamedModel] = []
    known: dict[tuple[str, str], _TableReader] = {}
    for entry in reader.read_tables("models", _MODEL_KEYS):
        typed, name = entry.read_required_text("path"), entry.read_text("name")
        path = entry.path.parent / typed
        if not FileReach.from_paths([entry.path], []).can_open(path):
            raise entry.make_type_error("path", "a file of the repository")
        if not path.is_file():
            raise entry.make_type_error("path", f"a file that exists; {typed} does not{_suggest_file(path, typed)}")
        arguments = entry.read_arguments()
        key, same = ("name", "this name") if name is not None else ("arguments", "these arguments")
        alike = (os.path.realpath(path), name if name is not None else str(sorted(arguments.items())))
        other = known.setdefault(alike, entry)
        if other is not entry:
            raise entry.make_error((key,), f"{typed} has an entry with {same} already ({other.describe_place(())})")
        found.append(NamedModel(path, name, arguments))
    return tuple(found)


def _parse_suppression(entry: _TableReader) -> tuple[str, SuppressionEntry]:
    codes = entry.read_codes("codes")
    if not codes:
        raise entry.make_type_error("codes", "a list of codes, prefixes, names or tags")
    return entry.read_text("path") or "", SuppressionEntry(
        codes, entry.read_text("subject") or "*", entry.read_required_text("reason")
    )


def _suggest_file(path: Path, typed: str) -> str:
    """Suggest a file with a similar name beside one that does not exist."""
    try:
        known = os.listdir(path.parent)
    except OSError:
        return ""
    near = difflib.get_close_matches(path.name, known, n=1)
    return f"; did you mean {typed.removesuffix(path.name)}{near[0]}?" if near else ""


def explain_unknown_target(name: str) -> str | None:
    """Return the complaint about an unknown target; None for a known one."""
    return (
        None
        if name in TARGETS
        else f"unknown target {name!r}{_suggest_word(name, TARGETS)} (known: {', '.join(TARGETS)})"
    )


def _suggest_word(word: str, known: Iterable[str]) -> str:
    near = difflib.get_close_matches(word, known, n=1)
    return f"; did you mean {near[0]!r}?" if near else ""


class _TableReader:
    """Typed access to a table; every error names file and line."""

    def __init__(self, path: Path, text: str, table: Any, key: Key) -> None:
        self.path = path
        self.source_text = text
        self.key = key
        if not isinstance(table, dict):
            raise self.make_error((), f"{key[-1] if key else 'urdfcheck'} must be a table")
        self.table: Mapping[str, Any] = table

    def describe_place(self, key: Key) -> str:
        """Return ``file:line`` of a key of this table, or of the nearest key around it."""
        try:
            found = locate_keys(self.source_text)
        except RecursionError:
            found = {}
        whole = (*self.key, *key)
        line = next((found[whole[:n]] for n in range(len(whole), 0, -1) if whole[:n] in found), 1)
        return f"{format_path(self.path)}:{line}"

    def make_error(self, key: Key, message: str) -> UrdfcheckError:
        return UrdfcheckError(f"{self.describe_place(key)}: {message}")

    def make_type_error(self, key: str, wanted: str) -> UrdfcheckError:
        return self.make_error((key,), f"{key} must be {wanted}")

    def ensure_bounded(self, key: str, value: Any) -> None:
        """Bound the size of a list or table.

        :raises UrdfcheckError: if it has more entries, or a text in it is longer, than anyone writes.
        """
        if len(value) > MAX_ENTRIES:
            raise self.make_type_error(key, f"at most {MAX_ENTRIES:,} entries")
        if any(isinstance(v, str) and len(v) > MAX_TEXT_LENGTH for v in value):
            raise self.make_type_error(key, f"texts of at most {MAX_TEXT_LENGTH:,} characters")

    def ensure_known_keys(self, known: Sequence[str]) -> None:
        for key in self.table:
            if key not in known:
                hint = _suggest_word(key, known) or f" (known: {', '.join(known)})"
                raise self.make_error((key,), f"unknown key {key!r}{hint}")

    def read_tables(self, key: str, known: Sequence[str]) -> list[_TableReader]:
        value = self.table.get(key, [])
        if not isinstance(value, list) or not all(isinstance(entry, dict) for entry in value):
            raise self.make_type_error(key, f"tables: [[{key}]]")
        self.ensure_bounded(key, value)
        found = [
            _TableReader(self.path, self.source_text, table=entry, key=(*self.key, key, i))
            for i, entry in enumerate(value)
        ]
        for entry in found:
            entry.ensure_known_keys(known)
        return found

    def read_words(self, key: str) -> tuple[str, ...] | None:
        value = self.table.get(key)
        if value is None:
            return None
        if not isinstance(value, list) or not all(isinstance(v, str) for v in value):
            raise self.make_type_error(key, "a list of strings")
        self.ensure_bounded(key, value)
        return tuple(value)

    def read_text(self, key: str) -> str | None:
        value = self.table.get(key)
        if value is not None and not (isinstance(value, str) and value.strip()):
            raise self.make_type_error(key, "a text")
        self.ensure_bounded(key, [] if value is None else [value])
        return value

    def read_required_text(self, key: str) -> str:
        value = self.read_text(key)
        if value is None:
            raise self.make_error((), f"{key} is missing")
        return value

    def read_choice(self, key: str, choices: tuple[str, ...], default: str) -> str:
        value = self.table.get(key, default)
        if value not in choices:
            raise self.make_type_error(key, f"one of {', '.join(choices)}")
        return str(value)

    def read_flag(self, key: str) -> bool:
        value = self.table.get(key, False)
        if not isinstance(value, bool):
            raise self.make_type_error(key, "true or false")
        return value

    def read_texts(self, key: str) -> dict[str, str]:
        value = self.table.get(key, {})
        if not isinstance(value, dict):
            raise self.make_type_error(key, "a table of strings")
        for name, inner in value.items():
            if not isinstance(inner, str):
                raise self.make_error((key, name), f"{key} must be a table of strings; {name} is not a string")
        self.ensure_bounded(key, value)
        return dict(value)

    def read_arguments(self) -> dict[str, str]:
        """Read values of xacro arguments: texts, or numbers and booleans as xacro reads them."""
        value = self.table.get("arguments", {})
        if not isinstance(value, dict):
            raise self.make_type_error("arguments", "a table: { name = value }")
        self.ensure_bounded("arguments", value)
        found: dict[str, str] = {}
        for name, inner in value.items():
            if not isinstance(inner, (str, int, float)):
                raise self.make_error(("arguments", name), f"{name} must be a text, a number or a boolean")
            found[name] = str(inner).lower() if isinstance(inner, bool) else str(inner)
        return found

    def ensure_folder(self, place: Key, key: str, folder: str) -> None:
        around = FileReach.from_paths([self.path], [])
        if not around.can_open(self.path.parent / folder):  # the file may be a stranger's like all beside it
            raise self.make_error(
                place, f"{key} must name folders of the repository; {folder} is not in it (name it on the command line)"
            )
        if not (self.path.parent / folder).is_dir():
            raise self.make_error(place, f"{key} must name existing folders; {folder} does not exist")

    def select_rules(self, key: Key, word: str) -> set[str]:
        try:
            return select_rules([word])
        except UrdfcheckError as error:
            raise self.make_error(key, str(error)) from None

    def read_codes(self, key: str) -> frozenset[str] | None:
        words = self.read_words(key)
        if words is None:
            return None
        return frozenset(code for i, word in enumerate(words) for code in self.select_rules((key, i), word))

    def read_severities(self) -> dict[str, str]:
        meant: list[tuple[set[str], str]] = []
        for word, severity in self.read_texts("severity").items():
            try:
                Severity.parse(severity)
            except ValueError as error:
                raise self.make_error(("severity", word), str(error)) from None
            meant.append((self.select_rules(("severity", word), word), severity))
        # A word for fewer rules is more specific, wherever it appears.
        found: dict[str, str] = {}
        for codes, severity in sorted(meant, key=lambda m: -len(m[0])):
            found.update(dict.fromkeys(codes, severity))
        return found

    def read_options(self) -> dict[str, dict[str, Any]]:
        value = self.table.get("options", {})
        if not isinstance(value, dict):
            raise self.make_type_error("options", "a table of tables")
        self.ensure_bounded("options", value)
        meant: list[tuple[set[str], str, dict[str, Any]]] = []
        for word, options in value.items():
            if not isinstance(options, dict):
                raise self.make_error(("options", word), f"{word} must be a table")
            meant.append((self.select_rules(("options", word), word), word, options))
        found: dict[str, dict[str, Any]] = {}
        for codes, word, options in sorted(meant, key=lambda m: -len(m[0])):
            for name, given in options.items():
                for code, fitting in self.match_option(("options", word, name), codes, given).items():
                    found.setdefault(code, {})[name] = fitting
        return found

    def match_option(self, key: Key, codes: Iterable[str], given: Any) -> dict[str, Any]:
        """Return the value for each of the rules that have such an option."""
        word, name = str(key[-2]), str(key[-1])
        rules = [load_rules()[code] for code in sorted(codes)]
        found: dict[str, Any] = {}
        for rule in rules:
            option = rule.options.get(name)
            if option is None:
                continue
            wanted = type(option.default)
            value = float(given) if wanted is float and type(given) is int else given
            if type(value) is not wanted:
                raise self.make_error(key, f"{name} must be {_KINDS.get(wanted, wanted.__name__)}")
            if wanted is float and not math.isfinite(value):
                raise self.make_error(key, f"{name} must be a finite number")
            found[rule.code] = value
        if not found:
            known = sorted({option for rule in rules for option in rule.options})
            hint = _suggest_word(name, known) or f" (it has: {', '.join(known) or 'none'})"
            raise self.make_error(key, f"{word} has no option {name!r}{hint}")
        return found
