"""The configuration: ``urdfcheck.toml`` or ``[tool.urdfcheck]`` in pyproject.toml, found upwards from what is checked."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import tomli

from urdfcheck import catalogue
from urdfcheck.core import Severity, UrdfcheckError
from urdfcheck.files import read_regular
from urdfcheck.source.packages import display_name
from urdfcheck.source.reach import OUT_OF_REACH, Reach

# The largest pyproject.toml of well-known projects has 60 kB; tomli takes a second for each megabyte.
MAX_TEXT = 4 * 1024**2
FAIL_ON = ("error", "warning", "info", "never")
TIERS = ("source", "mesh", "full")
TARGETS = ("gazebo", "mujoco", "drake", "bullet", "isaac", "moveit", "rviz", "pinocchio", "ros2_control", "kdl")


@dataclass(frozen=True, slots=True)
class Config:
    """What holds for a run before the command line has its say. ``root`` is the folder that models are named from."""

    root: Path
    select: tuple[str, ...] = ("ALL",)
    ignore: tuple[str, ...] = ()
    fail_on: str = "error"
    tier: str = "full"
    target: tuple[str, ...] = ()
    packages: Mapping[str, Path] = field(default_factory=dict)
    package_path: tuple[Path, ...] = ()
    severity: Mapping[str, str] = field(default_factory=dict)
    options: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)


_KEYS = ("select", "ignore", "fail-on", "tier", "target", "packages", "package-path", "severity", "options")


def find(start: Path) -> Config:
    """The configuration for a path; without one, the defaults with the enclosing git repository (or the working
    directory) as root.

    :raises UrdfcheckError: for a file that is not TOML, an unknown key or a value of the wrong type.
    """
    start = start.absolute()
    for folder in (start, *start.parents):
        own, project = folder / "urdfcheck.toml", folder / "pyproject.toml"
        if own.is_file():
            text = _text(own)
            return _read(own, text, _parsed(own, text))
        if project.is_file():
            text = _text(project)
            tools = _parsed(project, text).get("tool", {})
            table = tools.get("urdfcheck") if isinstance(tools, dict) else None
            if table is not None:
                return _read(project, text, table)
    return without_file(start)


def without_file(start: Path) -> Config:
    """What holds for a path where no file is to say anything."""
    start = start.absolute()
    for folder in (start, *start.parents):
        if (folder / ".git").exists():
            return Config(folder)
    return Config(Path.cwd())


def _text(path: Path) -> str:
    """The text of a configuration, which may be a stranger's: of bounded size, and where its name says."""
    try:
        if not Reach.around([path], []).allows(path):
            raise UrdfcheckError(f"{display_name(path)}: {OUT_OF_REACH}")
        return read_regular(path, MAX_TEXT).decode("utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise UrdfcheckError(f"{display_name(path)}: {error}") from None


def _parsed(path: Path, text: str) -> dict[str, Any]:
    try:
        table: dict[str, Any] = tomli.loads(text)
        return table
    except (
        ValueError,
        RecursionError,
    ) as error:  # a number of more digits than Python reads is a ValueError of its own
        raise UrdfcheckError(f"{display_name(path)}: {error}") from None


def _read(path: Path, text: str, table: Any) -> Config:
    reader = _Reader(path, text)
    if not isinstance(table, dict):
        raise reader.wrong("urdfcheck", "a table")
    for key in table:
        if key not in _KEYS:
            import difflib

            near = difflib.get_close_matches(key, _KEYS, n=1)
            hint = f"; did you mean {near[0]!r}?" if near else f" (known: {', '.join(_KEYS)})"
            raise UrdfcheckError(f"{reader.at(key)}: unknown key {key!r}{hint}")
    root = path.parent
    for key, folders in (
        ("packages", reader.texts(table, "packages").values()),
        ("package-path", reader.words(table, "package-path", ())),
    ):
        for folder in folders:
            if not (root / folder).is_dir():
                raise reader.wrong(key, f"folders that exist; {folder} is none")
            if not Reach.around([path], []).allows(root / folder):  # the file may be a stranger's like all beside it
                raise reader.wrong(key, f"folders of the repository; {folder} is none (name it on the command line)")
    for key in ("select", "ignore"):
        try:
            catalogue.select(reader.words(table, key, ()))
        except UrdfcheckError as error:
            raise UrdfcheckError(f"{reader.at(key)}: {error}") from None
    unknown = [name for name in reader.words(table, "target", ()) if name not in TARGETS]
    if unknown:
        raise UrdfcheckError(f"{reader.at('target')}: unknown target {unknown[0]!r} (known: {', '.join(TARGETS)})")
    return Config(
        root,
        select=reader.words(table, "select", ("ALL",)),
        ignore=reader.words(table, "ignore", ()),
        fail_on=reader.choice(table, "fail-on", FAIL_ON, "error"),
        tier=reader.choice(table, "tier", TIERS, "full"),
        target=reader.words(table, "target", ()),
        packages={name: root / folder for name, folder in reader.texts(table, "packages").items()},
        package_path=tuple(root / p for p in reader.words(table, "package-path", ())),
        severity=reader.severities(table),
        options=reader.options(table),
    )


class _Reader:
    """Typed access to a table; every complaint names the file and the line."""

    def __init__(self, path: Path, text: str) -> None:
        self.path = path
        self.lines = text.splitlines()

    def at(self, key: str) -> str:
        number = next((i for i, line in enumerate(self.lines, 1) if line.lstrip().lstrip("[").startswith(key)), 1)
        return f"{display_name(self.path)}:{number}"

    def wrong(self, key: str, wanted: str) -> UrdfcheckError:
        return UrdfcheckError(f"{self.at(key)}: {key} must be {wanted}")

    def words(self, table: Mapping[str, Any], key: str, default: tuple[str, ...]) -> tuple[str, ...]:
        value = table.get(key, list(default))
        if not isinstance(value, list) or not all(isinstance(v, str) for v in value):
            raise self.wrong(key, "a list of strings")
        return tuple(value)

    def choice(self, table: Mapping[str, Any], key: str, choices: tuple[str, ...], default: str) -> str:
        value = table.get(key, default)
        if value not in choices:
            raise self.wrong(key, f"one of {', '.join(choices)}")
        return str(value)

    def texts(self, table: Mapping[str, Any], key: str) -> dict[str, str]:
        value = table.get(key, {})
        if not isinstance(value, dict) or not all(isinstance(v, str) for v in value.values()):
            raise self.wrong(key, "a table of strings")
        return dict(value)

    def severities(self, table: Mapping[str, Any]) -> dict[str, str]:
        found: dict[str, str] = {}
        for word, severity in self.texts(table, "severity").items():
            try:
                Severity.parse(severity)
            except ValueError as error:
                raise UrdfcheckError(f"{self.at(word)}: {error}") from None
            found.update(dict.fromkeys(catalogue.select([word]), severity))
        return found

    def options(self, table: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
        found: dict[str, dict[str, Any]] = {}
        value = table.get("options", {})
        if not isinstance(value, dict):
            raise self.wrong("options", "a table of tables")
        for code, options in value.items():
            rule = catalogue.rules().get(code)
            if rule is None:
                raise UrdfcheckError(f"{self.at('options')}: options of an unknown rule {code!r}")
            if not isinstance(options, dict):
                raise self.wrong(code, "a table")
            found[code] = {}
            for name, given in options.items():
                option = rule.options.get(name)
                if option is None:
                    known = ", ".join(rule.options) or "none"
                    raise UrdfcheckError(f"{self.at(name)}: {code} has no option {name!r} (it has: {known})")
                wanted = type(option.default)
                if wanted is float and isinstance(given, int) and not isinstance(given, bool):
                    given = float(given)
                if type(given) is not wanted:
                    raise self.wrong(name, f"of type {wanted.__name__}")
                found[code][name] = given
        return found
