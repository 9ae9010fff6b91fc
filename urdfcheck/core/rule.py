"""A rule as its page declares it, and the findings that it reports. Standard library only."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import field
from typing import Any

from urdfcheck.core.findings import (
    Applicability,
    Cause,
    Computed,
    Confidence,
    Edit,
    Finding,
    Fix,
    Located,
    Location,
    Severity,
)
from urdfcheck.core.headlines import fill_headline
from urdfcheck.core.records import dataclass


@dataclass(frozen=True, slots=True)
class RuleOption:
    """A threshold of a rule as its page declares it."""

    name: str
    default: Any
    unit: str
    doc: str


@dataclass(frozen=True, slots=True)
class RuleFamily:
    """A family of rules: those whose codes begin with the same three letters."""

    code: str
    title: str
    layers: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Rule:
    """A rule as its page in ``rules/`` declares it."""

    code: str
    name: str
    severity: Severity
    confidence: Confidence
    status: str
    """preview | stable | deprecated."""
    since: str
    """Version of urdfcheck."""
    scopes: tuple[str, ...]
    """What its check gets: file | model | launch | package | run."""
    needs: tuple[str, ...]
    """What its check computes: source | mesh | dynamics | collision | simulator | package."""
    tags: tuple[str, ...]
    hidden_by: tuple[str, ...]
    """Codes of rules that supersede it on the same element."""
    concerns: tuple[str, ...]
    """The only programs that mind such a defect; empty if it is one for every program."""
    depends_on_targets: bool
    """Whether it reports other findings for other targets."""
    fix: Applicability
    """The best that its findings offer; ``display`` is advice."""
    options: Mapping[str, RuleOption]
    messages: Mapping[str, str]
    """Message id → template."""
    headlines: Mapping[str, str]
    """Message id → template of the headline."""
    fixes: Mapping[str, str]
    """Message id → template of the repair."""
    causes: Mapping[str, str]
    """Cause id → template."""
    consumers: Mapping[str, Any]
    """Program → what it does with the defect; or message id → such a mapping."""
    stem: str
    """Name of its check module."""
    page: str
    """Text of its page."""
    excess: str = ""
    """Name of the number in a finding's data by which those of this rule are ordered, the largest first; with a minus before it
    the smallest first."""
    on_request: frozenset[str] = frozenset()
    """Ids of the messages whose notes (infos) are reported only on request."""
    pedantic: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    """Ids of the messages whose notes (infos) are warnings for a pedantic reader, each with the targets for which they are
    warnings too."""
    dynamics: frozenset[str] = frozenset()
    """Ids of the messages about masses, inertias and forces alone: nothing for a program that only displays and plans."""
    explained_by: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    """Message id → codes of the rules that may be the cause of what a simulation shows, the likeliest first."""
    repeats: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    """Message id → codes of the rules that derive from the file what a simulation shows: how bad it is is theirs to say."""
    never_hidden: frozenset[str] = frozenset()
    """Ids of the messages that the rules in ``hidden_by`` do not supersede: they are about another part of the element."""
    layers: tuple[str, ...] = ("visual",)
    """What the 3D view of the report shows for a finding: layers of its viewer."""

    @property
    def summary(self) -> str:
        """The first paragraph under *What it checks*."""
        _, _, rest = self.page.partition("## What it checks")
        return " ".join(rest.strip().split("\n\n")[0].split())

    def finding(
        self,
        message: str,
        *,
        at: Located | Location,
        cause: str | None = None,
        edits: Iterable[Edit] = (),
        applicability: Applicability = Applicability.UNSAFE,
        related: Iterable[Located | Location] = (),
        severity: Severity | None = None,
        confidence: Confidence | None = None,
        consequences: Mapping[str, str] | None = None,
        **data: Any,
    ) -> Finding:
        """Return a finding of this rule: ``message`` is an id of the page's ``[messages]``, ``data`` fills its templates.

        The headline and the repair are the page's ``[headlines]`` and ``[fixes]`` templates of the same id; ``edits`` make the
        repair applicable, unless the finding is heuristic: then it is advice. ``consequences``: what single programs do, where
        that depends on the case; for the others the page says it.

        :raises KeyError: if the page lacks the message or the cause, or ``data`` lacks a value of a template.
        """
        location = at if isinstance(at, Location) else at.location
        confidence = self.confidence if confidence is None else confidence
        edits = () if confidence is Confidence.HEURISTIC else tuple(edits)
        # The properties, arguments and yaml keys that a computed value was made from.
        definitions: Iterable[Located] = at.collect_definitions() if isinstance(at, Computed) else ()
        places = [r if isinstance(r, Location) else r.location for r in (*related, *definitions)]
        consumers = {k: v for k, v in self.consumers.items() if isinstance(v, str)}
        consumers.update(self.consumers.get(message, {}))
        return Finding(
            code=self.code,
            name=self.name,
            severity=self.severity if severity is None else severity,
            confidence=confidence,
            message_id=message,
            headline=_fill_template(
                self.headlines, message, data, where=f"[headlines] of {self.code}", fill=fill_headline
            ),
            message=_fill_template(self.messages, message, data, where=f"[messages] of {self.code}"),
            location=location,
            subjects=(location.subject,),
            related=tuple({(p.subject, p.span): p for p in places}.values()),
            cause=None
            if cause is None
            else Cause(cause, _fill_template(self.causes, cause, data, where=f"[causes] of {self.code}")),
            consequences={**{k: v.format_map(data) for k, v in consumers.items()}, **(consequences or {})},
            data=data,
            excess=self._measure_excess(data),
            fix=Fix(
                _fill_template(self.fixes, message, data, where=f"[fixes] of {self.code}"),
                applicability if edits else Applicability.DISPLAY,
                edits,
            ),
        )

    def _measure_excess(self, data: Mapping[str, Any]) -> float:
        """Return how bad a finding is among those of this rule; -inf where the page names no number, or it is not known."""
        value = data.get(self.excess.removeprefix("-"))
        if not isinstance(value, (int, float)) or math.isnan(value):
            return -math.inf
        return -abs(value) if self.excess.startswith("-") else abs(value)


def _fill_template(
    templates: Mapping[str, str],
    name: str,
    data: Mapping[str, Any],
    *,
    where: str,
    fill: Callable[[str, Mapping[str, Any]], str] = str.format_map,
) -> str:
    """Fill a template of a page; ``where`` names its table and rule.

    :raises KeyError: when there is no such template, or ``data`` lacks a value; the message says which.
    """
    if name not in templates:
        raise KeyError(f"{where} has no {name!r}; it has: {', '.join(templates)}")
    try:
        return fill(templates[name], data)
    except KeyError as missing:
        raise KeyError(f"{where} {name!r} needs {missing}, which rule.finding() did not get") from None
