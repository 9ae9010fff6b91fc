"""A rule as its page declares it, and the findings that it makes. Standard library only."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
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


@dataclass(frozen=True, slots=True)
class Rule:
    """A rule as its page in ``rules/`` declares it. ``concerns``: the only programs that mind such a defect, empty where it is
    one whoever reads the model. ``fix``: the best that its findings offer; ``display`` is advice."""

    code: str
    name: str
    severity: Severity
    confidence: Confidence
    status: str
    since: str
    scopes: tuple[str, ...]
    needs: tuple[str, ...]
    tags: tuple[str, ...]
    hidden_by: tuple[str, ...]
    concerns: tuple[str, ...]
    depends_on_targets: bool
    fix: Applicability
    options: Mapping[str, RuleOption]
    messages: Mapping[str, str]
    fixes: Mapping[str, str]
    causes: Mapping[str, str]
    consumers: Mapping[str, Any]
    stem: str
    page: str
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
        """A finding of this rule: ``message`` is an id of the page's ``[messages]``, ``data`` fills its templates.

        The repair is the page's ``[fixes]`` template of the same id; ``edits`` make it applicable. ``consequences``: what single
        programs do where that depends on the case; the others do what the page says.

        :raises KeyError: when the page lacks the message, the cause or a value that a template names.
        """
        location = at if isinstance(at, Location) else at.location
        edits = tuple(edits)
        # Where the properties, arguments and yaml keys stand that a computed value was made of.
        definitions: Iterable[Located] = at.collect_definitions() if isinstance(at, Computed) else ()
        places = [r if isinstance(r, Location) else r.location for r in (*related, *definitions)]
        consumers = {k: v for k, v in self.consumers.items() if isinstance(v, str)}
        consumers.update(self.consumers.get(message, {}))
        return Finding(
            code=self.code,
            name=self.name,
            severity=self.severity if severity is None else severity,
            confidence=self.confidence if confidence is None else confidence,
            message_id=message,
            message=self.messages[message].format_map(data),
            location=location,
            subjects=(location.subject,),
            related=tuple({(p.subject, p.span): p for p in places}.values()),
            cause=None if cause is None else Cause(cause, self.causes[cause].format_map(data)),
            consequences={**{k: v.format_map(data) for k, v in consumers.items()}, **(consequences or {})},
            data=data,
            fix=Fix(self.fixes[message].format_map(data), applicability if edits else Applicability.DISPLAY, edits),
        )
