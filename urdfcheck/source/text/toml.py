"""The lines of the keys of a TOML text: tomli reads values, but not their places."""

from __future__ import annotations

import re
from collections.abc import Mapping

Key = tuple[str | int, ...]

# Parts of a dotted key that get a line each; real keys have fewer.
_MAX_KEY_PARTS = 16
_BLANK = re.compile(r"(?:[ \t\r\n]|#[^\n]*)*")
_KEY = re.compile(r"""[ \t]*("(?:\\.|[^"\\])*"|'[^']*'|[A-Za-z0-9_-]+)[ \t]*(\.?)""")
_TEXT = re.compile(
    r'"""(?:\\[\s\S]|[^\\])*?"{3,5}' + r"|'''[\s\S]*?'{3,5}" + r'|"(?:\\.|[^"\\])*"' + r"|'[^']*'|[^,\]}#\r\n]*"
)


def locate_keys(text: str) -> Mapping[Key, int]:
    """Return the line of each key, by the keys and indexes that lead to it: ``("models", 0, "path")``. Lines count from 1.

    tomli must have read the text without an error: its syntax is not checked again.
    """
    return _KeyScanner(text).lines


class _KeyScanner:
    """Reads the keys of a text from its begin to its end."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.at = 0
        self.line = 1
        self.counted = 0
        self.lines: dict[Key, int] = {}
        self.lengths: dict[Key, int] = {}
        table: Key = ()
        while self.skip():
            if text.startswith("[[", self.at):
                self.at += 2
                line, keys = self.read_keys()
                name = self.resolve_header(keys[:-1]) + keys[-1:]
                index = self.lengths.get(name, 0)
                self.lengths[name] = index + 1
                table = (*name, index)
                self.lines.setdefault(name, line)
                self.lines[table] = line
                self.at += 2
            elif text.startswith("[", self.at):
                self.at += 1
                line, keys = self.read_keys()
                table = self.resolve_header(keys)
                self.lines.setdefault(table, line)
                self.at += 1
            else:
                self.read_pair(table)

    def skip(self, pattern: re.Pattern[str] = _BLANK) -> bool:
        match = pattern.match(self.text, self.at)
        self.at = match.end() if match else self.at
        return self.at < len(self.text)

    def count_lines(self) -> int:
        self.line += self.text.count("\n", self.counted, self.at)
        self.counted = self.at
        return self.line

    def resolve_header(self, keys: Key) -> Key:
        """Return the keys of a header, with the index of the last table of each array of tables on the way."""
        path: Key = ()
        for key in keys:
            path = (*path, key)
            if path in self.lengths:
                path = (*path, self.lengths[path] - 1)
        return path

    def read_keys(self) -> tuple[int, Key]:
        line = self.count_lines()
        keys: Key = ()
        while match := _KEY.match(self.text, self.at):
            self.at = match.end()
            typed = match[1]
            keys = (*keys, _unquote(typed) if typed[0] in "\"'" else typed)
            if not match[2]:
                break
        return line, keys

    def read_pair(self, table: Key) -> None:
        line, keys = self.read_keys()
        for end in {*range(1, min(len(keys), _MAX_KEY_PARTS)), len(keys)}:
            self.lines.setdefault((*table, *keys[:end]), line)
        self.at += 1  # the equals sign
        self.read_value((*table, *keys))

    def read_value(self, key: Key) -> None:
        self.skip()
        opening = self.text[self.at : self.at + 1]
        if opening not in {"[", "{"}:
            self.skip(_TEXT)
            return
        self.at += 1
        index = 0
        while self.skip() and self.text[self.at] not in "]}":
            if self.text[self.at] == ",":
                self.at += 1
            elif opening == "[":
                place = (*key, index)
                self.lines[place] = self.count_lines()
                self.read_value(place)
                index += 1
            else:
                self.read_pair(key)
        self.at += 1


def _unquote(key: str) -> str:
    """Return what a quoted key means."""
    import tomli

    name: str = next(iter(tomli.loads(f"{key}=0")))
    return name
