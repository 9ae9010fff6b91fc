"""What files beside a model say about it: semantic descriptions, controllers, launch files, manifests. Standard library only."""

from __future__ import annotations

from collections.abc import Mapping

from urdfcheck.core.findings import Span
from urdfcheck.core.records import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class SeamFact:
    """One statement of a file, that can be compared with that of another version of it."""

    kind: str
    """srdf | controllers | launch | package | argument."""
    file: str
    """Name of the file without its folders."""
    start: str
    """What it is about, up to the first name of a part: ``joint`` of ``joint elbow of group arm``."""
    names: tuple[tuple[str, str], ...] = ()
    """The links and joints that it names: their kind and name."""
    end: str = ""
    """What it is about, behind the names: ``of group arm``."""
    value: str = ""
    """What it says about that."""
    are_unordered: bool = False
    """Whether the order of the names means nothing."""
    span: Span | None = None
    """Where it is typed."""

    def build_label(self, renames: Mapping[tuple[str, str], str]) -> str:
        """Return what it is about, its parts called by their new names."""
        names = [renames.get((kind, name), name) for kind, name in self.names]
        named = " and ".join(sorted(names) if self.are_unordered else names)
        return " ".join(filter(None, (self.start, named, self.end)))

    @property
    def label(self) -> str:
        """What it is about, as it is written."""
        return self.build_label({})
