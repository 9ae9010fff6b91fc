"""What the language server and its check process exchange: plain values, a length before each.

The answers of the check process hold what its workers found in untrusted files. They are read as those of the workers are.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping
from dataclasses import field

from urdfcheck.core import Edit, Finding
from urdfcheck.core.records import dataclass
from urdfcheck.export.index.source_index import DoubtfulName, SourceIndex

HEADER = struct.Struct("<Q")


@dataclass(frozen=True, slots=True, kw_only=True)
class RenameWish:
    """What is to be renamed."""

    path: str
    """The file in which the name is."""
    offset: int
    text: str
    """The new text of the name, or of the literal part at the offset where the name is built from a substitution."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CheckJob:
    """A run over the open documents, the search for their safe fixes or the edits of a renaming, or the report on one of them."""

    number: int
    """Increases with each job."""
    folder: str
    """The working directory: names of files in findings are relative to it."""
    paths: tuple[str, ...]
    """Absolute paths of the models and launch files that are open."""
    texts: Mapping[str, bytes]
    """Real path → content of each open document."""
    tier: str | None = None
    """How much is computed; None: the configuration decides."""
    index: bool = False
    """Whether the indexes of the models are wanted, which takes a fifth of the time of the source tier."""
    forgets: bool = False
    """Whether files appeared or disappeared, so that nothing of earlier runs may be reused."""
    only_texts_differ: bool = False
    """Whether the editor has reported nothing but edits since the last job of this tier that looked for the models."""
    fixes: bool = False
    """Whether the safe fixes are wanted instead of the findings."""
    rename: RenameWish | None = None
    """The renaming that is wanted instead of the findings."""
    report: bool = False
    """Whether the report is wanted instead of the findings."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BaselinePlace:
    """Where a baseline accepts the findings of a model. The file may not exist."""

    file: str
    root: str
    """Folder that its names are relative to."""
    model: str
    """What it calls the model."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ProjectAnswer:
    """The findings about the open documents of one project: a repository, a package or a folder."""

    folder: str
    findings: tuple[Finding, ...] = ()
    sources: Mapping[str, str] = field(default_factory=dict)
    """Text of the files with findings, by name."""
    failures: tuple[str, ...] = ()
    """What could not be checked: a wrong configuration, a path that does not exist, a crash."""
    model_paths: Mapping[str, str] = field(default_factory=dict)
    """Id of each model → path of its file."""
    indexes: tuple[SourceIndex, ...] = ()
    baselines: Mapping[str, BaselinePlace] = field(default_factory=dict)
    """Id of each model → the baseline that accepts its findings."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CheckAnswer:
    """The outcome of a job."""

    number: int
    projects: tuple[ProjectAnswer, ...] = ()
    deep_codes: frozenset[str] = frozenset()
    """The rules that need more than the source tier."""
    changes: Mapping[str, tuple[bytes, bytes]] = field(default_factory=dict)
    """Real path → content before and after the safe fixes."""
    fixed: int = 0
    """Number of findings that these repair."""
    edits: tuple[Edit, ...] = ()
    """Those of the renaming."""
    doubtful: tuple[DoubtfulName, ...] = ()
    """Texts that the renaming leaves as they are, because they may be something else."""
    untried: tuple[str, ...] = ()
    """Models in which it could not be tried."""
    refusal: str = ""
    """Why there are none, in a sentence."""
    report: bytes = b""
    """The report as an HTML document."""
    failure: str = ""
    """Why there is none."""
    is_cancelled: bool = False
