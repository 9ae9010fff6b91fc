"""Reads a configuration file: ``urdfcheck.toml``, or ``[tool.urdfcheck]`` in pyproject.toml."""

from __future__ import annotations

import difflib
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from urdfcheck.core import UrdfcheckError
from urdfcheck.policy.config import (
    OWN_FILE,
    PROJECT_FILE,
    Config,
    NamedModel,
    Section,
)
from urdfcheck.policy.config_keys import find_key, list_key_names
from urdfcheck.policy.config_table import TableReader, explain_unknown_target
from urdfcheck.policy.suppression import SuppressionEntry
from urdfcheck.source.package.finder import format_path
from urdfcheck.source.reach import OUT_OF_REACH, FileReach
from urdfcheck.source.text.toml import Key, locate_keys
from urdfcheck.system.files import read_regular

# The largest pyproject.toml of well-known projects has 60 kB; tomli takes a second for each megabyte.
MAX_FILE_SIZE = 4 * 1024**2


def read_folder_config(folder: Path) -> Config | None:
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
            return _parse_config(project, text, table=table, key=_get_table_key(project))
    return None


def read_named_config(file: Path) -> Config:
    """Read the configuration that the user names, whatever it is called; one called pyproject.toml holds ``[tool.urdfcheck]``.

    :raises UrdfcheckError: if it cannot be read, has an error or lacks the table.
    """
    path = Path(os.path.abspath(file))
    text = _read_text(path)
    table: Any = _parse_toml(path, text)
    key = _get_table_key(path)
    for part in key:
        table = table.get(part) if isinstance(table, dict) else None
    if table is None:
        raise UrdfcheckError(f"{format_path(path)}: has no table [{'.'.join(key)}]")
    return _parse_config(path, text, table=table, key=key)


def _get_table_key(file: Path) -> tuple[str, ...]:
    """Return where in a file the configuration is."""
    return ("tool", "urdfcheck") if file.name == PROJECT_FILE else ()


def read_typed_table(config: Config) -> tuple[Mapping[str, Any], Mapping[Key, str]]:
    """Return the table of a configuration as typed, and the place of each of its keys as ``file:line``."""
    if config.file is None:
        return {}, {}
    text = _read_text(config.file)
    table, own = _parse_toml(config.file, text), _get_table_key(config.file)
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
    import tomli  # most repositories have no configuration

    try:
        table: dict[str, Any] = tomli.loads(text)
        return table
    # A number with more digits than Python reads raises a plain ValueError.
    except (ValueError, RecursionError) as error:
        raise UrdfcheckError(f"{format_path(path)}: {error}") from None


def _parse_config(path: Path, text: str, *, table: Any, key: Key) -> Config:
    reader = TableReader(path, text, table=table, key=key)
    reader.ensure_known_keys(list_key_names())
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
        sections=tuple(_parse_section(r, key) for r in (reader, *reader.read_tables("paths", list_key_names("paths")))),
        fail_on=reader.read_choice(find_key("fail-on")),
        tier=reader.read_choice(find_key("tier")),
        unchecked=_parse_unchecked(reader),
        strict_baseline=reader.read_flag("strict-baseline"),
        exclude=reader.read_words("exclude") or (),
        packages={name: root / folder for name, folder in packages.items()},
        package_path=tuple(root / p for p in package_path),
        baseline=None if baseline is None else root / baseline,
        models=_parse_models(reader),
        suppress=tuple(
            _parse_suppression(entry) for entry in reader.read_tables("suppress", list_key_names("suppress"))
        ),
    )


def _parse_unchecked(reader: TableReader) -> str | tuple[str, ...]:
    """Read how bad it is that a model cannot be checked, or the patterns of the models for which it is accepted."""
    key = find_key("unchecked")
    value = reader.table.get(key.name, key.default)
    if isinstance(value, list):
        return reader.read_words(key.name) or ()
    if value not in key.choices:
        raise reader.make_type_error(key.name, f"one of {', '.join(key.choices)}, or a list of patterns for models")
    return str(value)


def _parse_section(reader: TableReader, table: Key) -> Section:
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
        kinematics_only=reader.read_flag("kinematics-only") if "kinematics-only" in reader.table else None,
        key=reader.key[len(table) :],
    )


def _parse_models(reader: TableReader) -> tuple[NamedModel, ...]:
    found: list[NamedModel] = []
    known: dict[tuple[str, str], TableReader] = {}
    for entry in reader.read_tables("models", list_key_names("models")):
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


def _parse_suppression(entry: TableReader) -> tuple[str, SuppressionEntry]:
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
