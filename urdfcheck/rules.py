"""The rule pages of ``rules/`` as :class:`Rule` objects, and the check that belongs to each page.

A page ``INR003-triangle-inequality.md`` belongs to ``urdfcheck/checks/inr003_triangle_inequality.py``: the stem is the
only link, there is no registry.
"""

from __future__ import annotations

import importlib
import io
import os
import pickle
import sys
from collections.abc import Callable, Iterable, Mapping
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import Any

from urdfcheck import rule_pages
from urdfcheck.core import Applicability, Confidence, Rule, RuleFamily, RuleOption, Severity, UrdfcheckError
from urdfcheck.rule_pages import TITLE, list_pages, split_page
from urdfcheck.rule_pages import find_page as find_page
from urdfcheck.rule_pages import find_pages_folder as find_pages_folder
from urdfcheck.system.cache_folder import read_checked, write_checked
from urdfcheck.system.installation import compute_installation_stamp
from urdfcheck.system.plain_pickle import load_plain

Check = Callable[..., Iterable[Any]]

SCOPES = ("file", "model", "launch", "package", "run")
NEEDS = ("source", "mesh", "dynamics", "collision", "simulator", "package")
_KEYS = {
    "severity",
    "confidence",
    "status",
    "since",
    "scope",
    "needs",
    "tags",
    "hidden_by",
    "never_hidden",
    "concerns",
    "layers",
    "depends_on_targets",
    "fix",
    "excess",
    "on_request",
    "pedantic",
    "dynamics",
    "explained_by",
    "repeats",
    "options",
    "messages",
    "headlines",
    "fixes",
    "causes",
    "consumers",
}
# What the report shows of a robot for a finding whose family and page ask for nothing else.
_PLAIN = ("visual",)


@cache
def load_families() -> Mapping[str, RuleFamily]:
    """The families of rules by the first three letters of their codes, in the order of the index.

    :raises UrdfcheckError: when ``rules/families.toml`` is malformed.
    """
    import tomli

    path = find_pages_folder() / "families.toml"
    try:
        families = tomli.loads(path.read_text(encoding="utf-8"))
        return MappingProxyType(
            {code: RuleFamily(code, f["title"], tuple(f.get("layers", _PLAIN))) for code, f in families.items()}
        )
    except (KeyError, ValueError, TypeError) as error:
        raise UrdfcheckError(f"{path}: {type(error).__name__}: {error}") from error


# What was recalled, for `load_rules`.
_recalled: list[tuple[Rule, ...]] = []


@cache
def load_rules() -> Mapping[str, Rule]:
    """Return all rules by code, in the order of their codes."""
    loaded = _recalled.pop() if _recalled else tuple(map(load_page, list_pages()))
    return MappingProxyType({rule.code: rule for rule in loaded})


def recall_rules(folder: Path) -> Mapping[str, Rule]:
    """Do what :func:`load_rules` does, from a copy of what an earlier process read there.

    To parse the pages takes as long as half of the other modules that a run loads. ``folder``: that of the cache. A page that
    changes makes another copy.
    """
    if load_rules.cache_info().currsize:
        return load_rules()
    path = folder / "rules" / compute_installation_stamp()
    data = read_checked(path)
    if data is not None:
        _recalled.append(load_plain(io.BytesIO(data)))
        return load_rules()
    rules = load_rules()
    write_checked(path, pickle.dumps(tuple(rules.values()), pickle.HIGHEST_PROTOCOL))
    return rules


def load_page(path: Path) -> Rule:
    """Read one page.

    :raises UrdfcheckError: if the file is not a rule page; the message names the page and what is missing.
    """
    import tomli  # not where a copy of the pages was read

    text = path.read_text(encoding="utf-8")
    title, header = TITLE.match(text), split_page(text)[0]
    if not title or not header:
        raise UrdfcheckError(f"{path}: a rule page begins with '# CODE name' and a toml block")
    code, name = title.groups()
    if path.stem != f"{code}-{name}":
        raise UrdfcheckError(f"{path}: the file of rule {code} {name} must be called {code}-{name}.md")
    try:
        meta = tomli.loads(header)
        unknown = sorted(set(meta) - _KEYS)
        if unknown:
            raise ValueError(f"unknown key {unknown[0]!r}")
        scope = meta.get("scope", "model")
        family = load_families().get(code[:3])
        if family is None:
            raise ValueError(f"the family {code[:3]} is missing in families.toml")
        for message in meta["messages"]:
            if message not in meta["headlines"]:
                raise ValueError(f"[headlines] has no {message!r}: every message needs one")
        consumers = meta["consumers"]
        if consumers == "none":
            consumers = {}
        elif not isinstance(consumers, dict):
            raise ValueError('consumers is a table [consumers] or "none"')
        return Rule(
            code=code,
            name=name,
            severity=Severity.parse(meta["severity"]),
            confidence=Confidence(meta["confidence"]),
            status=meta["status"],
            since=meta["since"],
            scopes=tuple([scope] if isinstance(scope, str) else scope),
            needs=tuple(meta["needs"]),
            tags=tuple(meta["tags"]),
            hidden_by=tuple(meta.get("hidden_by", ())),
            concerns=tuple(meta.get("concerns", ())),
            depends_on_targets=bool(meta.get("depends_on_targets", False)),
            fix=Applicability(meta.get("fix", "display")),
            options={
                key: RuleOption(key, default=o["default"], unit=o["unit"], doc=o["doc"])
                for key, o in meta.get("options", {}).items()
            },
            messages=meta["messages"],
            headlines=meta["headlines"],
            fixes=meta["fixes"],
            causes=meta.get("causes", {}),
            consumers=consumers,
            stem=path.stem.lower().replace("-", "_"),
            page=text,
            excess=str(meta.get("excess", "")),
            on_request=_parse_messages("on_request", meta.get("on_request", ()), meta["messages"]),
            pedantic=_parse_words("pedantic", meta.get("pedantic", {}), meta["messages"]),
            dynamics=_parse_messages("dynamics", meta.get("dynamics", ()), meta["messages"]),
            explained_by=_parse_words("explained_by", meta.get("explained_by", {}), meta["messages"]),
            never_hidden=_parse_messages("never_hidden", meta.get("never_hidden", ()), meta["messages"]),
            repeats=_parse_words("repeats", meta.get("repeats", {}), meta["messages"]),
            layers=tuple(meta.get("layers", family.layers)),
        )
    except (KeyError, ValueError, TypeError) as error:
        raise UrdfcheckError(f"{path}: {type(error).__name__}: {error}") from error


def _parse_messages(key: str, value: Any, messages: Iterable[str]) -> frozenset[str]:
    """Read a key that means messages: true for all of them, or a list of ids.

    :raises ValueError: for an id of no message.
    """
    ids = frozenset(messages if value is True else value)
    if unknown := sorted(ids - set(messages)):
        raise ValueError(f"{key}: there is no message {unknown[0]!r}")
    return ids


def _parse_words(key: str, value: Mapping[str, Any], messages: Iterable[str]) -> Mapping[str, tuple[str, ...]]:
    """Read a table with words for each message: targets or codes.

    :raises ValueError: for an id of no message.
    """
    _parse_messages(key, value, messages)
    return {message: tuple(words) for message, words in value.items()}


def describe_on_request(rule: Rule) -> str:
    """Say which notes of a rule are reported on request only; empty if all are always reported."""
    return rule_pages.describe_on_request(rule.messages, rule.on_request)


def describe_pedantic(rule: Rule) -> str:
    """Say which notes of a rule are warnings with ``--pedantic``, and for which targets they are; empty if none is."""
    return rule_pages.describe_pedantic(rule.messages, rule.pedantic)


def describe_dynamics(rule: Rule) -> str:
    """Say which messages of a rule are left out where the configuration says ``kinematics-only``; empty if none is."""
    return rule_pages.describe_dynamics(rule.messages, rule.dynamics)


def has_check(rule: Rule) -> bool:
    """Whether the rule has a check module; most rules about urdfcheck itself (URC) have none."""
    return rule.stem in _list_check_modules()


@cache
def _list_check_modules() -> frozenset[str]:
    """Return the names of all check modules: to look for each by itself takes a hundred times as long."""
    folders = importlib.import_module("urdfcheck.checks").__path__
    return frozenset(name.partition(".")[0] for folder in folders for name in os.listdir(folder))


def get_check_module(rule: Rule) -> str:
    """Return the name of the rule's check module."""
    return f"urdfcheck.checks.{rule.stem}"


def load_check(rule: Rule) -> Check:
    """Return the ``check`` function of the module with the page's stem."""
    name = get_check_module(rule)
    module = sys.modules.get(name)  # not the import system's search, for each rule and each unit
    check: Check = (importlib.import_module(name) if module is None else module).check
    return check


def select_rules(names: Iterable[str]) -> set[str]:
    """Return the codes that codes, prefixes (``INR``, ``JNT0``), rule names, tags or ``ALL`` mean.

    :raises UrdfcheckError: for a word that means no rule; the message suggests the nearest.
    """
    found: set[str] = set()
    for word in names:
        upper = word.upper()
        codes = {
            code
            for code, rule in load_rules().items()
            # Each code begins with an empty word, and `ignore = [""]` would leave nothing.
            if upper == "ALL" or (upper and code.startswith(upper)) or word.lower() in {rule.name, *rule.tags}
        }
        if not codes:
            import difflib

            known = sorted(
                {
                    *load_rules(),
                    *(r.name for r in load_rules().values()),
                    *(t for r in load_rules().values() for t in r.tags),
                }
            )
            near = difflib.get_close_matches(word, known, n=1, cutoff=0.5) or difflib.get_close_matches(
                upper, known, n=1
            )
            hint = f"; did you mean {near[0]}?" if near else ""
            raise UrdfcheckError(f"{word!r} names no rule{hint} (urdfcheck rule lists codes, names and tags)")
        found |= codes
    return found
