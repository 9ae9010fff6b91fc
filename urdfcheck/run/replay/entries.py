"""The files in which results are kept, each under a key and with the observations that decide whether it still holds."""

from __future__ import annotations

import contextlib
import io
import os
import pickle
import zlib
from collections.abc import Iterable, Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import fields, is_dataclass
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Any

from urdfcheck.system.cache_folder import note_use, write_atomically
from urdfcheck.system.installation import compute_installation_stamp
from urdfcheck.system.observing.observations import Observations, Recheck
from urdfcheck.system.observing.questions import compute_sha256
from urdfcheck.system.plain_pickle import load_plain

if TYPE_CHECKING:
    from urdfcheck.core import Finding

# Bytes of a result as it is in memory; larger ones are not kept.
LARGEST = 256 * 1024**2
_FOLDER = "replays"
# Rules about audits that did not come to their end: the next may.
_UNFINISHED = frozenset({"URC900", "URC906"})


def is_repeatable(findings: Iterable[Finding], failures: Sequence[str]) -> bool:
    """Whether the same work would have the same outcome: nothing failed, crashed or was stopped."""
    return not failures and not any(finding.code in _UNFINISHED for finding in findings)


def make_key(*parts: object) -> str:
    """Return the key of a result that only these values, this installation and its observations decide.

    Values: dataclasses, mappings, sequences, sets, paths, texts, numbers and enumerations. Empty where there is another one,
    and in a working folder that was deleted: then nothing is kept.
    """
    try:
        described = (compute_installation_stamp(), os.getcwd(), *map(_describe, parts))
    except (OSError, TypeError):
        return ""
    return compute_sha256("\0".join(described).encode("utf-8", "surrogatepass"))


def _describe(value: object) -> str:
    """Return a text that is the same for equal values, in every process."""
    if is_dataclass(value):
        inner = (f"{f.name}={_describe(getattr(value, f.name))}" for f in fields(value) if f.compare)
        return f"{type(value).__name__}({','.join(inner)})"
    if isinstance(value, Mapping):
        return "{" + ",".join(sorted(f"{_describe(k)}:{_describe(v)}" for k, v in value.items())) + "}"
    if isinstance(value, AbstractSet):
        return "{" + ",".join(sorted(map(_describe, value))) + "}"
    if isinstance(value, (list, tuple)):
        return "[" + ",".join(map(_describe, value)) + "]"
    if value is None or isinstance(value, (str, bytes, int, float, Path, Enum)):
        return repr(value)
    raise TypeError(f"{type(value).__name__} cannot be part of a key")


def keep_result(folder: Path, key: str, result: object, observations: Observations) -> None:
    """Keep a result, unless something that it depends on is not known. ``folder``: that of the cache."""
    if key and observations.is_complete:
        data = b"".join(pickle.dumps(part, pickle.HIGHEST_PROTOCOL) for part in (observations, result))
        if len(data) <= LARGEST:
            write_atomically(_get_path(folder, key), key.encode() + zlib.compress(data, 1))


class Replays:
    """Results of earlier runs. An object holds for a moment: what has not changed when it is asked is not asked again."""

    def __init__(self, folder: Path) -> None:
        """``folder``: that of the cache."""
        self._folder = folder
        self._recheck = Recheck(self._digest_file, _list_ignored)

    def recall(self, key: str) -> tuple[Any, Observations] | None:
        """Return the result of a key, and what it depends on; None where there is none that still holds."""
        if not key:
            return None
        path = _get_path(self._folder, key)
        try:
            data = path.read_bytes()
            if data[: len(key)] != key.encode():
                return None
            reader = zlib.decompressobj()
            unpacked = reader.decompress(data[len(key) :], LARGEST)
            if not reader.eof:
                return None  # its check sum is at the end, and was not compared
            stream = io.BytesIO(unpacked)
            observations = load_plain(stream)
            if not self._recheck.is_unchanged(observations):
                return None
            result = load_plain(stream)
        except Exception:  # zlib and pickle raise many kinds for a damaged file
            return None
        with contextlib.suppress(OSError):
            note_use(path)
        return result, observations

    def _digest_file(self, path: Path) -> str:
        from urdfcheck.system.array_cache import ArrayCache  # few files have new times and the same content

        return ArrayCache(self._folder).compute_digest(path)[0]


def _get_path(folder: Path, key: str) -> Path:
    return folder / _FOLDER / key[:2] / key[2:]


def _list_ignored(root: str) -> Iterable[str]:
    from urdfcheck.source.project_folders import find_project_folder
    from urdfcheck.system.git import list_ignored  # a single file needs no git

    return list_ignored(root, outside=str(find_project_folder(Path(root))))
