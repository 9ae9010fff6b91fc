"""What a check reports: findings with their place, cause, consequences and repair. Standard library only."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import field
from enum import Enum, IntEnum
from typing import Any, ClassVar, Protocol, runtime_checkable

from urdfcheck.core.records import dataclass

# What ends a line for every span: str.splitlines() would also break at form feeds and Unicode separators.
NEWLINE = re.compile(r"\r\n|\n|\r")

# The family of rules about urdfcheck itself, its configuration and its comments.
OWN_FAMILY = "URC"


class Severity(IntEnum):
    """How bad a finding is. ``error``: a reference parser rejects or drops something, or the value is impossible."""

    INFO = 1
    WARNING = 2
    ERROR = 3

    def __str__(self) -> str:
        return self.name.lower()

    @classmethod
    def parse(cls, text: str) -> Severity:
        """Return the severity of this name.

        :raises ValueError: if there is none.
        """
        try:
            return cls[text.upper()]
        except KeyError:
            raise ValueError(f"{text!r} is not a severity: error, warning or info") from None


class Confidence(str, Enum):
    """How sure a finding is. ``proof``: follows from the file whatever the author meant."""

    PROOF = "proof"
    STRONG = "strong"
    HEURISTIC = "heuristic"

    __str__ = str.__str__


class Applicability(str, Enum):
    """Whether a fix may be applied without asking (``safe``), on request (``unsafe``) or only shown (``display``)."""

    SAFE = "safe"
    UNSAFE = "unsafe"
    DISPLAY = "display"

    __str__ = str.__str__


class Verdict(IntEnum):
    """What a program does with a defect, the worst last, as the sentences of the pages' ``[consumers]`` begin.

    ``loads``: takes the model as typed; ``ignores``, ``replaces``, ``swaps``: simulates or plans with other values;
    ``computes NaN``: loads it without usable numbers; ``drops``: a link, a joint or a shape is missing, with all below it;
    ``refuses``: there is no model.
    """

    LOADS = 0
    IGNORES = 1
    REPLACES = 2
    SWAPS = 3
    NAN = 4
    DROPS = 5
    REFUSES = 6

    def __str__(self) -> str:
        return "computes NaN" if self is Verdict.NAN else self.name.lower()

    @classmethod
    def from_sentence(cls, sentence: str) -> Verdict:
        """Return the verdict that a sentence begins with."""
        first = sentence.partition(" ")[0].rstrip(",:;")
        return cls.NAN if sentence.startswith("computes NaN") else _VERDICTS.get(first, cls.LOADS)


_VERDICTS = {
    "ignores": Verdict.IGNORES,
    "replaces": Verdict.REPLACES,
    "swaps": Verdict.SWAPS,
    "drops": Verdict.DROPS,
    "refuses": Verdict.REFUSES,
    # A program that was asked.
    "refused": Verdict.REFUSES,
}


# Not kw_only, because a run makes millions of them: constructing one by keywords takes longer.
@dataclass(frozen=True, slots=True, order=True)
class Span:
    """A piece of source text. Lines and columns are 1-based code points, ends exclusive; offsets count code points."""

    file: str
    line: int
    col: int
    end_line: int
    end_col: int
    start: int
    end: int

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the fields for the constructor: a run sends and keeps thousands, and dataclasses restores fields one by one."""
        return Span, (self.file, self.line, self.col, self.end_line, self.end_col, self.start, self.end)


@dataclass(frozen=True, slots=True)
class Location:
    """The place of a finding: its subject in the model, its text, and the calls that brought the text there.

    ``subject`` reads like ``link[wheel_1]/inertial/inertia@izz``; ``via`` holds macro calls and includes, outermost first.
    """

    subject: str
    span: Span | None
    via: tuple[Span, ...] = ()

    def __reduce__(self) -> tuple[Any, ...]:
        """Do the same as that of `Span`."""
        return Location, (self.subject, self.span, self.via)

    @property
    def file(self) -> str:
        """The file of the text, or empty."""
        return "" if self.span is None else self.span.file


class Located(Protocol):
    """Anything with a place in the source: an element, an attribute, a link, a joint."""

    @property
    def location(self) -> Location: ...


@runtime_checkable
class Computed(Located, Protocol):
    """Anything located whose text was computed from definitions elsewhere."""

    def collect_definitions(self) -> Iterable[Located]: ...


@dataclass(frozen=True, slots=True)
class Edit:
    """Replace the text at ``span``, which must still read ``expected``."""

    span: Span
    expected: str
    replacement: str


@dataclass(frozen=True, slots=True)
class Fix:
    """What repairs a finding. Without edits it is advice (``display``)."""

    title: str
    applicability: Applicability = Applicability.DISPLAY
    edits: tuple[Edit, ...] = ()


@dataclass(frozen=True, slots=True)
class Cause:
    """Why it happened: a stable id and a sentence."""

    id: str
    text: str


@dataclass(frozen=True, slots=True)
class Suppression:
    """Why a finding does not count. ``kind``: source (a comment), configuration or baseline."""

    kind: str
    reason: str

    def __str__(self) -> str:
        return "in the baseline" if self.kind == "baseline" else f"suppressed in the {self.kind}: {self.reason}"


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """One defect at its cause."""

    code: str
    name: str
    severity: Severity
    confidence: Confidence
    message_id: str
    headline: str
    """What is wrong, in at most 70 characters: the title of the finding wherever it is shown."""
    message: str
    """The evidence, in whole sentences."""
    location: Location
    subjects: tuple[str, ...]
    """More than one where one source text made several elements."""
    related: tuple[Location, ...] = ()
    cause: Cause | None = None
    consequences: Mapping[str, str] = field(default_factory=dict)
    """What each program does with the defect."""
    data: Mapping[str, Any] = field(default_factory=dict)
    """The values of the message and further measured ones, for programs."""
    excess: float = -math.inf
    """How bad it is among the findings of its rule, for their order: see `Rule.excess`."""
    fix: Fix | None = None
    model: str = ""
    """Id of the model; of several the one with the fewest arguments."""
    suppressed: Suppression | None = None
    variants: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    """Where several models of a run show it, or a xacro was expanded with several sets of arguments: the ids of the models
    with this finding, each with its subjects there."""
    blocks_check: bool = False
    """Whether its model could not be checked because of it. Nothing suppresses such a finding: see `Policy.unchecked`."""
    message_ids: Mapping[str, str] = field(default_factory=dict)
    """Subjects of which a check says the same in other words, with the ids of their messages."""
    blames_text: bool = False
    """Whether its text is typed as it is, or computes a value and all elements that it makes have the defect."""
    occurrences: tuple[Finding, ...] = ()
    """Where one kind of mistake is at several places of a file: the finding of each place, with its own numbers and repair, in
    the order of the text. Empty for a finding of one place."""

    def list_occurrences(self) -> tuple[Finding, ...]:
        """Return the finding of each place; for a finding of one place that is the finding itself."""
        return self.occurrences or (self,)

    @property
    def subjects_by_model(self) -> Mapping[str, tuple[str, ...]]:
        """The ids of all models with this finding, each with its subjects there."""
        return self.variants or {self.model: self.subjects}

    @property
    def is_about_urdfcheck(self) -> bool:
        """Whether it is about urdfcheck, its configuration or its comments, not about a model."""
        return self.code.startswith(OWN_FAMILY)

    @property
    def cause_text(self) -> str | None:
        """Text of its cause, unless the message contains it."""
        # Inside a message it begins with a lower-case letter.
        return None if self.cause is None or self.cause.text[1:] in self.message else self.cause.text

    @property
    def fingerprints(self) -> tuple[str, ...]:
        """One per subject, independent of lines and of the working directory."""
        import hashlib  # loads OpenSSL: only outputs that show fingerprints pay for it

        return tuple(
            hashlib.sha256(
                # A file name may not be valid text in any encoding.
                "\0".join((self.code, self.model, subject, self.message_ids.get(subject, self.message_id))).encode(
                    errors="surrogatepass"
                )
            ).hexdigest()[:32]
            for subject in self.subjects
        )


def iter_occurrences(findings: Iterable[Finding]) -> Iterator[Finding]:
    """Yield the finding of each place."""
    for finding in findings:
        yield from finding.list_occurrences()


@dataclass(frozen=True, slots=True)
class SkippedCheck:
    """A check that could not run on a model, and why."""

    TIER_REASON: ClassVar[str] = "needs --tier "
    """What the reason of a check begins with that takes more than was to be computed."""
    LAUNCHED_MODEL: ClassVar[str] = "model"
    """What takes the place of a rule's code where a launch file was checked without the model that it loads."""
    WARNINGS: ClassVar[str] = "the list of warnings"
    """What takes that place where only the errors of a model are reported."""
    FINDINGS: ClassVar[str] = "the list of errors and warnings"
    """What takes that place where nothing is reported of a model but why it cannot be checked."""
    PROBLEMS: ClassVar[frozenset[str]] = frozenset({WARNINGS, FINDINGS})
    """What takes that place where problems of a model are set aside: without findings it is not clean."""
    DEFAULTS: ClassVar[str] = "the list of what defaults cause"
    """What takes that place where the findings about defaults of arguments are notes."""
    NO_RULES: ClassVar[frozenset[str]] = frozenset({"ALL", LAUNCHED_MODEL, WARNINGS, FINDINGS, DEFAULTS})
    """What takes that place where something was not checked by any rule."""

    code: str
    model: str
    reason: str
    is_partial: bool = False
    """Whether the check ran, and something of what it looked at or found is left out."""
