"""The JSON Schema of ``urdfcheck.toml``, for editors: draft 7, which those for TOML understand."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

from urdfcheck.core import Rule, Severity
from urdfcheck.policy.config_keys import CONFIG_KEYS, ConfigKey, KeyKind
from urdfcheck.policy.config_table import MAX_ENTRIES, MAX_TEXT_LENGTH
from urdfcheck.rules import load_rules

Schema = dict[str, Any]

_WORD, _SEVERITY, _LINE = "word", "severity", "line"
_TEXT: Schema = {"type": "string", "maxLength": MAX_TEXT_LENGTH}
# Codes and prefixes in small letters, names and tags with capitals.
_ANOTHER_CASE = "^(?:[a-z]{1,3}[0-9]{0,3}|[A-Z][A-Za-z]*[a-z-][A-Za-z-]*)$"
_NUMBERS: dict[type, str] = {float: "number", int: "integer"}


def render_config_schema() -> Schema:
    """Return the schema. What it refuses, urdfcheck refuses; paths, and the sum of some settings, only urdfcheck can judge."""
    return {
        "$schema": "http://json-schema.org/draft-07/schema#",
        "title": "urdfcheck.toml",
        "description": "The configuration of urdfcheck: what holds for the models below its folder.",
        **_describe_table(CONFIG_KEYS),
        "definitions": {
            _LINE: {**_TEXT, "pattern": r"\S"},
            _WORD: _describe_words(),
            _SEVERITY: _describe_severities(),
            **{code: _describe_rule(rule) for code, rule in load_rules().items()},
        },
    }


def _describe_table(keys: Iterable[ConfigKey]) -> Schema:
    keys = tuple(keys)
    required = [key.name for key in keys if key.is_required]
    return {
        "type": "object",
        "properties": {key.name: _describe_key(key) for key in keys},
        "additionalProperties": False,
        **({"required": required} if required else {}),
    }


def _describe_key(key: ConfigKey) -> Schema:
    described = _DESCRIPTIONS[key.kind](key)
    if key.is_required and described.get("type") == "array":
        described = {**described, "minItems": 1}
    default = {} if key.default is None else {"default": key.default}
    return {"description": key.doc, **described, **default}


def _describe_words() -> Schema:
    """What can be written where a list of rules is expected. Another case is accepted and not offered."""
    rules = load_rules()
    words = [
        "ALL",
        *dict.fromkeys(code[:3] for code in rules),
        *rules,
        *(rule.name for rule in rules.values()),
        *sorted({tag for rule in rules.values() for tag in rule.tags}),
        *dict.fromkeys(code[:length] for code in rules for length in (1, 2, 4, 5)),
    ]
    return {"anyOf": [{"enum": [*dict.fromkeys(words)]}, {"type": "string", "pattern": _ANOTHER_CASE}]}


def _describe_severities() -> Schema:
    names = [str(severity) for severity in Severity]
    in_any_case = "|".join("".join(f"[{letter.upper()}{letter}]" for letter in name) for name in names)
    return {"anyOf": [{"enum": names}, {"type": "string", "pattern": f"^(?:{in_any_case})$"}]}


def _describe_rule(rule: Rule) -> Schema:
    """The options of a rule."""
    return {
        "type": "object",
        "description": f"{rule.code} {rule.name}",
        "properties": {
            option.name: {
                "type": _NUMBERS[type(option.default)],
                "default": option.default,
                "description": f"{option.doc} ({option.unit})" if option.unit not in ("", "1") else option.doc,
            }
            for option in rule.options.values()
        },
        "additionalProperties": False,
    }


def _describe_options(_: ConfigKey) -> Schema:
    """Options by code or name; those of a prefix or a tag are numbers of any name."""
    rules = {
        word: {"$ref": f"#/definitions/{code}"}
        for code, rule in load_rules().items()
        if rule.options
        for word in (code, rule.name)
    }
    return {
        "type": "object",
        "maxProperties": MAX_ENTRIES,
        "propertyNames": {"$ref": f"#/definitions/{_WORD}"},
        "properties": rules,
        "additionalProperties": {"type": "object", "additionalProperties": {"type": "number"}},
    }


def _describe_list(items: Schema) -> Schema:
    return {"type": "array", "maxItems": MAX_ENTRIES, "items": items}


def _describe_texts(values: Schema) -> Schema:
    return {"type": "object", "maxProperties": MAX_ENTRIES, "additionalProperties": values}


_DESCRIPTIONS: dict[KeyKind, Callable[[ConfigKey], Schema]] = {
    KeyKind.TEXT: lambda _: {"allOf": [{"$ref": f"#/definitions/{_LINE}"}]},  # draft 7 reads nothing beside a $ref
    KeyKind.CHOICE: lambda key: {"enum": [*key.choices]},
    KeyKind.FLAG: lambda _: {"type": "boolean"},
    KeyKind.WORDS: lambda _: _describe_list(_TEXT),
    KeyKind.CHOICES: lambda key: _describe_list({"enum": [*key.choices]}),
    KeyKind.CHOICE_OR_WORDS: lambda key: {"anyOf": [{"enum": [*key.choices]}, _describe_list(_TEXT)]},
    KeyKind.CODES: lambda _: _describe_list({"$ref": f"#/definitions/{_WORD}"}),
    KeyKind.TEXTS: lambda _: _describe_texts({"type": "string"}),
    KeyKind.ARGUMENTS: lambda _: _describe_texts({"type": ["string", "number", "boolean"]}),
    KeyKind.SEVERITIES: lambda _: {
        **_describe_texts({"$ref": f"#/definitions/{_SEVERITY}"}),
        "propertyNames": {"$ref": f"#/definitions/{_WORD}"},
    },
    KeyKind.OPTIONS: _describe_options,
    KeyKind.TABLES: lambda key: _describe_list(_describe_table(key.keys)),
}
