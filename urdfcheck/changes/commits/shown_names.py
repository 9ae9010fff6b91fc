"""Names files by their revision: they were read in temporary folders, which mean nothing to a reader."""

from __future__ import annotations

import dataclasses
import os
import re
from collections.abc import Callable, Mapping
from enum import Enum
from pathlib import Path
from typing import Any, TypeVar

from urdfcheck.source.package.finder import format_path

_Value = TypeVar("_Value")
# What may follow the path of a folder, where it is not the start of a longer name.
_END = r"(?P<inside>/(?=[^\s/])|/?(?![\w.-]))"


def rename_folders(value: _Value, names: Mapping[Path, tuple[str, str]]) -> _Value:
    """Return a value in which every text names some folders differently.

    :param names: by folder: what replaces its path and the slash before a path in it, and what replaces its path alone.
    """
    spellings = {
        spelling: name
        for folder, name in names.items()
        for spelling in (folder.as_posix(), format_path(folder), str(folder), os.path.realpath(folder))
    }
    listed = "|".join(map(re.escape, sorted(spellings, key=len, reverse=True)))
    pattern = re.compile(rf"(?:file://)?(?P<folder>{listed}){_END}")

    def rename_text(text: str) -> str:
        return pattern.sub(lambda m: spellings[m["folder"]][0 if m["inside"] else 1], text)

    def rename(inner: Any) -> Any:
        return _map_texts(inner, rename_text, rename)

    renamed: _Value = rename(value)
    return renamed


def _map_texts(value: Any, rename_text: Callable[[str], str], rename: Callable[[Any], Any]) -> Any:
    """Return a value of the result with each text in it renamed; what holds none stays the same object."""
    if isinstance(value, Enum):
        return value
    if isinstance(value, str):
        return rename_text(value)
    if isinstance(value, Mapping):
        return {rename(key): rename(inner) for key, inner in value.items()}
    if isinstance(value, tuple):
        parts = [rename(inner) for inner in value]
        return type(value)(*parts) if hasattr(value, "_fields") else tuple(parts)
    if isinstance(value, (list, frozenset)):
        return type(value)(map(rename, value))
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        changes = {
            field.name: new
            for field in dataclasses.fields(value)
            if field.init and (new := rename(old := getattr(value, field.name))) is not old and new != old
        }
        return dataclasses.replace(value, **changes) if changes else value
    return value
