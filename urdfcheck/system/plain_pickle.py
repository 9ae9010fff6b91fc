"""Pickled values of which only plain data is read back, wherever they come from.

Workers send their answers in this form, and results are kept between runs in it.
"""

from __future__ import annotations

import io
import pickle
import struct
from collections.abc import Mapping
from dataclasses import is_dataclass
from enum import Enum
from typing import Any


# msgspec 0.22 was measured as a replacement of the unpickler below and of the decoders of the findings cache (30 interleaved
# runs on two busy cores, medians). It refuses foreign types by construction and returns equal reports, and it is faster: the
# report on the longest URDF of the corpus (Tiago dual, 35 findings with their scene, 1.7 MB) decodes in 12 ms instead of 62 ms,
# that on car-3 in 0.4 ms instead of 1.1 ms. Not adopted, because it slows the start: its import and the decoder for a report,
# whose annotations it evaluates, take 22 ms in the parent (the least: 17 ms) and as much in the worker; ``urdfcheck check`` on an
# unchanged car-3 needs 730 ms of processor time instead of 650 ms (the least of 30). It also cannot encode names of files that
# are not UTF-8 (surrogates) or an exception, decodes tuples below `Any` as lists, and needs hooks for numpy's numbers and the
# paths of a plan: about 105 lines of decoders would become about 50. The JSON report has other fields and would stay as it is.
class _DtypeStandIn:
    """Replaces numpy's dtype, whose ``__setstate__`` accepts any state and then reads memory out of bounds."""

    def __init__(self, code: str, *_: object) -> None:
        self.format = _FORMATS[code]

    def __setstate__(self, _: object) -> None:
        """Ignore the state: numbers arrive in this machine's byte order."""


# The format characters of struct by numpy's type codes.
_FORMATS = {"b1": "?", "f4": "f", "f8": "d"}
_FORMATS |= {f"i{1 << n}": "bhiq"[n] for n in range(4)} | {f"u{1 << n}": "BHIQ"[n] for n in range(4)}


def _unpack_number(dtype: _DtypeStandIn, data: bytes) -> float:
    """Convert a numpy scalar to a Python number."""
    (number,) = struct.unpack("=" + dtype.format, data)
    value: float = number
    return value


def _get_enum_member(kind: object, name: object) -> Enum:
    """Return a member of an enumeration, which Python 3.11.0 to 3.11.2 pickle as ``getattr`` of its class.

    :raises pickle.UnpicklingError: for any other use of getattr.
    """
    if isinstance(kind, type) and issubclass(kind, Enum) and name in kind.__members__:
        return kind.__members__[str(name)]
    raise pickle.UnpicklingError("a worker sent builtins.getattr, which is not data")


class PlainUnpickler(pickle.Unpickler):
    """Read the answer of a worker, which must be plain data: a worker that a hostile file has taken over cannot send more.

    Of urdfcheck's own classes only dataclasses and enumerations of the modules that reports and plans consist of are allowed,
    under their own name: the constructors of others open files.
    """

    _BUILTINS = frozenset(
        {("builtins", name) for name in ("set", "frozenset", "complex", "slice", "MemoryError")}
        | {("collections", "OrderedDict")}
        | {(module, f"{kind}Path") for module in ("pathlib", "pathlib._local") for kind in ("Posix", "Windows")}
    )
    _NUMBERS: Mapping[tuple[str, str], Any] = {
        ("numpy", "dtype"): _DtypeStandIn,
        **{(f"numpy.{core}.multiarray", "scalar"): _unpack_number for core in ("core", "_core")},
    }
    _OWN_MODULES = frozenset(
        f"urdfcheck.{module}"
        for module in (
            "core.drive_test",
            "core.drop_test",
            "core.findings",
            "core.mechanism",
            "core.model_diff",
            "core.rule",
            "core.run",
            "core.scene",
            "core.seams",
            "export.index.source_index",
            "export.link_pairs",
            "fix.repair.steps",
            "export.outline",
            "source.model_role",
            "policy.config",
            "policy.config_resolver",
            "policy.limits",
            "policy.suppression",
            "run.jobs",
            "server.check_messages",
            "simulators.outcome",
            "source.plan",
            "source.reach",
            "source.text.suppression_comments",
            "system.observing.observations",
        )
    )

    def find_class(self, module: str, name: str) -> Any:
        if (module, name) in self._NUMBERS:
            return self._NUMBERS[module, name]
        if (module, name) in self._BUILTINS:
            return super().find_class(module, name)
        if (module, name) == ("builtins", "getattr"):
            return _get_enum_member
        value = super().find_class(module, name) if module in self._OWN_MODULES and "." not in name else None
        if (
            not isinstance(value, type)
            or value.__module__ != module
            or not (is_dataclass(value) or issubclass(value, Enum))
        ):
            raise pickle.UnpicklingError(f"a worker sent {module}.{name}, which is not data")
        return value


def load_plain(stream: io.BytesIO) -> Any:
    """Return the next answer of a stream, plain data.

    :raises Exception: of any kind, when it is malformed or anything else; EOFError at the end.
    """
    return PlainUnpickler(stream).load()
