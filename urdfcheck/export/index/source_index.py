"""The index of a model's source, in plain values. Standard library only."""

from __future__ import annotations

from urdfcheck.core.findings import Span
from urdfcheck.core.records import dataclass

LINK, JOINT, MATERIAL = "link", "joint", "material"
PROPERTY, PARAMETER, ARGUMENT, MACRO = "property", "parameter", "argument", "macro"
FILE = "file"
YAML_KEY = "yaml key"


@dataclass(frozen=True, slots=True)
class NamePlace:
    """A place at which a name is defined or used."""

    kind: str
    """link | joint | material | property | parameter | argument | macro | yaml key | file, which is an included one."""
    name: str
    span: Span
    is_definition: bool
    targets: tuple[Span, ...] = ()
    """Of a use, the definitions that it means, where the names alone do not say it."""
    scope: Span | None = None
    """Of a property that is known in one macro only, the start tag of the macro; of a key of yaml, its mapping."""
    is_handed: bool = False
    """Whether the text only hands on a name that is typed elsewhere: ``${parent}``. That place is one of the names too."""


@dataclass(frozen=True, slots=True)
class DoubtfulName:
    """A text outside the model that may be the name of one of its parts, or something else."""

    kind: str
    """link | joint | yaml key."""
    name: str
    span: Span
    doubt: str
    """Why that is not known, as a clause."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ExpandedElement:
    """An element of the expanded robot, as far as two expansions are compared."""

    subject: str
    """``link[arm]/inertial/mass``."""
    depth: int
    tag: str
    attributes: tuple[tuple[str, str, str], ...]
    """Name, value, and what the value is a name of: link | joint | material; empty for all others."""
    text: str
    """Without the blanks around it."""
    text_kind: str
    """What the text is a name of; empty for all others."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ValueSource:
    """A definition that a value was computed from."""

    kind: str
    """property | parameter | argument | yaml | environment."""
    name: str
    text: str
    """As typed; empty if unknown."""
    value: str
    """What that became; empty if unknown, or if it is the text."""
    span: Span | None


@dataclass(frozen=True, slots=True, kw_only=True)
class ComputedUse:
    """What a text with expressions became in one element of the robot."""

    value: str
    subject: str
    """An attribute of the robot: ``link[arm]/inertial/mass@value``; an element with text; a definition: ``property[a]``."""
    sources: tuple[ValueSource, ...]
    """Nearest first."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ComputedText:
    """The value of an attribute or the text of an element with expressions, as typed, and what it became."""

    span: Span
    text: str
    uses: tuple[ComputedUse, ...]
    """Those with different values, in the order of the robot."""


@dataclass(frozen=True, slots=True, kw_only=True)
class YamlKey:
    """A value in a yaml file that expressions read."""

    name: str
    """``joint1.limit.upper``."""
    span: Span
    """That of the value."""
    readers: tuple[Span, ...]
    """The texts whose expressions read it."""
    subjects: tuple[str, ...]
    """The attributes of the robot that were computed from it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotPart:
    """A link or joint of the kinematic tree."""

    kind: str
    """link | joint."""
    name: str
    detail: str
    """The mass of a link, the type of a joint."""
    facts: tuple[str, ...]
    """What is known of it, a line each."""
    depth: int
    """In the tree; the parts are in its order, each below its parent."""
    places: tuple[Span, ...]
    """The whole element if it was typed as such, its start tag, and the macro calls and includes that brought it in, innermost
    first."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SourceIndex:
    """What is known of one model's source."""

    model: str
    """Its id."""
    files: tuple[str, ...]
    """The files of the model, and those beside it that name its parts or arguments or hold its values."""
    names: tuple[NamePlace, ...]
    texts: tuple[ComputedText, ...]
    parts: tuple[RobotPart, ...]
    is_expanded: bool
    """Whether there is a robot; without one, names and parts are those as typed."""
    yaml_keys: tuple[YamlKey, ...] = ()
    doubtful_names: tuple[DoubtfulName, ...] = ()
    """Texts that a renaming leaves as they are, and names."""
    expansion: tuple[ExpandedElement, ...] = ()
    """The expanded robot, where it was asked for."""
