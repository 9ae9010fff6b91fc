"""The keys of a configuration: what the reader accepts, the schema for editors allows, and the reference lists."""

from __future__ import annotations

from enum import Enum

from urdfcheck.core.records import dataclass
from urdfcheck.policy.config import FAIL_ON, TARGETS, UNCHECKED
from urdfcheck.policy.policy import TIERS


class KeyKind(Enum):
    """What the value of a key is, in words for the reader of an error or of the reference."""

    TEXT = "a text"
    CHOICE = "one of"
    FLAG = "true or false"
    WORDS = "a list of texts"
    CHOICES = "a list of"
    CHOICE_OR_WORDS = "a list of texts, or one of"
    CODES = "a list of codes, prefixes, names or tags of rules"
    TEXTS = "a table of texts"
    ARGUMENTS = "a table of texts, numbers and booleans"
    SEVERITIES = "a table of severities, by codes, prefixes, names or tags"
    OPTIONS = "a table of options for each code, prefix, name or tag"
    TABLES = "tables"


@dataclass(frozen=True, slots=True, kw_only=True)
class ConfigKey:
    """A key of the configuration, or of one of its tables."""

    name: str
    kind: KeyKind
    doc: str
    default: str | bool | None = None
    """What holds without the key; None: nothing is set."""
    choices: tuple[str, ...] = ()
    is_required: bool = False
    keys: tuple[ConfigKey, ...] = ()
    """Of `KeyKind.TABLES`: the keys of each table."""


_RULE_KEYS = (
    ConfigKey(
        name="select",
        kind=KeyKind.CODES,
        doc="only these rules; `ALL` brings the notes that are reported on request too",
    ),
    ConfigKey(name="ignore", kind=KeyKind.CODES, doc="all but these rules"),
    ConfigKey(
        name="severity", kind=KeyKind.SEVERITIES, doc="the severity of these rules, instead of that of their page"
    ),
    ConfigKey(
        name="options",
        kind=KeyKind.OPTIONS,
        doc="thresholds of rules, which their pages list; of several words the one for fewer rules wins",
    ),
    ConfigKey(
        name="target",
        kind=KeyKind.CHOICES,
        choices=TARGETS,
        doc="programs that will read the models: what one of them rejects or drops is an error",
    ),
    ConfigKey(
        name="pedantic",
        kind=KeyKind.FLAG,
        default=False,
        doc="report every note, and as warnings those that most maintainers would switch off",
    ),
    ConfigKey(
        name="kinematics-only",
        kind=KeyKind.FLAG,
        default=False,
        doc="the models are for display and motion planning alone: nothing is reported about masses, inertias and forces, unless "
        "a target simulates or the command line selects it",
    ),
)

CONFIG_KEYS = (
    *_RULE_KEYS,
    ConfigKey(
        name="fail-on",
        kind=KeyKind.CHOICE,
        choices=FAIL_ON,
        default="error",
        doc="exit 1 for findings at or above this severity",
    ),
    ConfigKey(name="tier", kind=KeyKind.CHOICE, choices=TIERS, default="full", doc="how much is computed"),
    ConfigKey(
        name="unchecked",
        kind=KeyKind.CHOICE_OR_WORDS,
        choices=UNCHECKED,
        default="error",
        doc="how bad it is that a model cannot be checked, or the patterns of the models for which it is a warning",
    ),
    ConfigKey(
        name="exclude",
        kind=KeyKind.WORDS,
        doc="patterns of files and folders that are skipped when a folder is checked",
    ),
    ConfigKey(name="packages", kind=KeyKind.TEXTS, doc="folders of ROS packages by name"),
    ConfigKey(name="package-path", kind=KeyKind.WORDS, doc="folders that hold packages"),
    ConfigKey(
        name="baseline",
        kind=KeyKind.TEXT,
        doc="the file of accepted findings; without it, urdfcheck-baseline.json beside the configuration",
    ),
    ConfigKey(
        name="strict-baseline",
        kind=KeyKind.FLAG,
        default=False,
        doc="an entry of the baseline whose finding is gone is an error",
    ),
    ConfigKey(
        name="paths",
        kind=KeyKind.TABLES,
        doc="settings for some files only; the last section that matches wins",
        keys=(
            ConfigKey(
                name="match", kind=KeyKind.WORDS, is_required=True, doc="patterns of the files that the section is for"
            ),
            *_RULE_KEYS,
        ),
    ),
    ConfigKey(
        name="models",
        kind=KeyKind.TABLES,
        doc="a xacro with the arguments of one robot; each entry is checked",
        keys=(
            ConfigKey(name="path", kind=KeyKind.TEXT, is_required=True, doc="the file"),
            ConfigKey(name="name", kind=KeyKind.TEXT, doc="what reports call the robot"),
            ConfigKey(name="arguments", kind=KeyKind.ARGUMENTS, doc="values of the xacro's arguments"),
        ),
    ),
    ConfigKey(
        name="suppress",
        kind=KeyKind.TABLES,
        doc="findings that are accepted, in files that are not yours to edit",
        keys=(
            ConfigKey(name="codes", kind=KeyKind.CODES, is_required=True, doc="of these rules"),
            ConfigKey(
                name="subject",
                kind=KeyKind.TEXT,
                default="*",
                doc="a pattern of the elements, such as `link[gripper_*]`",
            ),
            ConfigKey(name="path", kind=KeyKind.TEXT, doc="a pattern of the models; without it, all"),
            ConfigKey(name="reason", kind=KeyKind.TEXT, is_required=True, doc="why they are right"),
        ),
    ),
)


def list_key_names(table: str = "") -> tuple[str, ...]:
    """Return the names of the keys that the configuration may have, or one of its tables."""
    return tuple(key.name for key in (find_key(table).keys if table else CONFIG_KEYS))


def find_key(name: str) -> ConfigKey:
    """Return a key of the configuration itself.

    :raises KeyError: if it has no such key.
    """
    return {key.name: key for key in CONFIG_KEYS}[name]
