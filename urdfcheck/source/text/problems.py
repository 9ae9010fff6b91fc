"""What went wrong while a model was read, as plain records that the checks of the same kind turn into findings."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import field
from typing import Any

from urdfcheck.core import Location, Span
from urdfcheck.core.records import dataclass
from urdfcheck.source.text.xml import XmlError

# The message of "expansion-failed" is xacro's own: what follows in it on the reason, and the reason for a file that xacro
# cannot open.
IN_EXPRESSION = " when evaluating expression '"
MISSING_FILE = re.compile(r"No such file or directory: '?([^'\n]+?)'?(?: \[Errno.*)?$")
# What xacro says of a property, a macro and a block that are not defined.
_LACKING = re.compile(
    r"name '(?P<property>[^']+)' is not defined|unknown macro name: (?:xacro:)?(?P<macro>\S+)"
    r'|Undefined block "(?P<block>[^"]*)"'
)


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Problem:
    """A defect that was found while reading."""

    kind: str
    """What happened; the check that reports it picks it by this name."""
    message: str
    location: Location
    data: Mapping[str, Any] = field(default_factory=dict)
    related: tuple[Location, ...] = ()
    """The definitions that led there, nearest first."""

    @classmethod
    def from_read_error(cls, error: OSError | XmlError, subject: str, file: str) -> Problem:
        """Return the problem of a file that cannot be opened or is not XML. ``file``: its name in findings."""
        if isinstance(error, XmlError):
            return cls(kind=error.reason, message=str(error), location=Location(subject, error.span), data=error.data)
        return cls(kind="unreadable", message=error.strerror or str(error), location=locate_start(subject, file))


def locate_start(subject: str, file: str) -> Location:
    """Return the first character of a file that was not read."""
    return Location(subject, Span(file, line=1, col=1, end_line=1, end_col=1, start=0, end=0))


def find_lacking(problem: Problem) -> tuple[str, str] | None:
    """Return what an expansion did not find, and its name: a ``property``, ``macro`` or ``block``."""
    lacking = _LACKING.search(problem.message.split(IN_EXPRESSION)[0])
    return None if lacking is None else (str(lacking.lastgroup), lacking[lacking.lastgroup or 0])
