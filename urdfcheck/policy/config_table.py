"""Typed access to a table of a configuration file; every error names file and line."""

from __future__ import annotations

import difflib
import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from urdfcheck.core import Severity, UrdfcheckError
from urdfcheck.policy.config import TARGETS
from urdfcheck.policy.config_keys import ConfigKey
from urdfcheck.rules import load_rules, select_rules
from urdfcheck.source.package.finder import format_path
from urdfcheck.source.reach import FileReach
from urdfcheck.source.text.toml import Key, locate_keys

# Entries of a list or table, and characters of a text: the file may be a stranger's, and each entry is tried on each model.
MAX_ENTRIES, MAX_TEXT_LENGTH = 1_000, 1_000
_KINDS = {float: "a number", int: "a whole number", str: "a text", bool: "true or false", list: "a list"}


class TableReader:
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
                hint = suggest_word(key, known) or f" (known: {', '.join(known)})"
                raise self.make_error((key,), f"unknown key {key!r}{hint}")

    def read_tables(self, key: str, known: Sequence[str]) -> list[TableReader]:
        value = self.table.get(key, [])
        if not isinstance(value, list) or not all(isinstance(entry, dict) for entry in value):
            raise self.make_type_error(key, f"tables: [[{key}]]")
        self.ensure_bounded(key, value)
        found = [
            TableReader(self.path, self.source_text, table=entry, key=(*self.key, key, i))
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

    def read_choice(self, key: ConfigKey) -> str:
        value = self.table.get(key.name, key.default)
        if value not in key.choices:
            raise self.make_type_error(key.name, f"one of {', '.join(key.choices)}")
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
            hint = suggest_word(name, known) or f" (it has: {', '.join(known) or 'none'})"
            raise self.make_error(key, f"{word} has no option {name!r}{hint}")
        return found


def explain_unknown_target(name: str) -> str | None:
    """Return the complaint about an unknown target; None for a known one."""
    return (
        None
        if name in TARGETS
        else f"unknown target {name!r}{suggest_word(name, TARGETS)} (known: {', '.join(TARGETS)})"
    )


def suggest_word(word: str, known: Iterable[str]) -> str:
    near = difflib.get_close_matches(word, known, n=1)
    return f"; did you mean {near[0]!r}?" if near else ""
