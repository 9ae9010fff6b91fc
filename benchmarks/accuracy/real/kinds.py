"""Kinds of defects that are made in real robots, and what a finding that names them says."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass

from injections import Rng

from real.changes import Change, Part

Make = Callable[[Part, Rng], "Broken | list[Change] | None"]


@dataclass(frozen=True, slots=True)
class Broken:
    """The changes that make a defect, and what names it where that depends on what was drawn (a unit)."""

    changes: list[Change]
    says: str = ""
    """Pattern of the words that name it."""


@dataclass(frozen=True, slots=True, eq=False)
class Kind:
    """A kind of defect. ``make`` returns None where it has no effect or the text has no literal values."""

    make: Make
    family: str
    """inertial | joint | limits | shape | name."""
    says: str = ""
    """Pattern of the words of headline, message, cause or repair that name it; empty if the rules in `codes` do."""
    codes: frozenset[str] = frozenset()
    """Rules whose finding is the name itself."""
    is_nameless: bool = False
    """Whether it is none of the common mistakes: every cause that is named is wrong."""
    is_lossy: bool = False
    """Whether the true numbers are lost, so that no repair can bring them back."""
    shows_itself: bool = False
    """Whether its numbers show by themselves which mistake it is, whatever the part: six equal ones, a moment below zero."""
    needs_twin: bool = False
    """Whether only a twin shows which mistake in a joint it is: a part in the air is there by any of several."""
    habit: bool = False
    """Whether it is made in all links of the file."""

    @property
    def name(self) -> str:
        name = self.make.__name__
        return f"all: {name}" if self.habit else name

    def names(self, text: str, says: str) -> bool:
        """Whether a text names the defect. ``says``: the pattern of the case, if it has one."""
        pattern = says or self.says
        return bool(pattern) and re.search(pattern, text, re.IGNORECASE) is not None
