"""Findings that yield to a stronger finding on the same element."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping
from dataclasses import replace

from urdfcheck.core import Finding, Rule, Severity, Verdict
from urdfcheck.policy.consumers import SIMULATOR, get_verdict

# `link[wheel]` of `link[wheel]/inertial/inertia@izz`, whatever the name contains.
_ELEMENT = re.compile(r"[^/@\[]*\[.*?\](?=[/@]|$)", re.DOTALL)

# The message of other rules for what a counterpart shows.
_OF_TWIN = "twin"
# Stands for all elements in what a finding explains.
WHOLE_RULE = "*"


def drop_superseded(findings: Iterable[Finding], rules: Mapping[str, Rule]) -> list[Finding]:
    """Drop findings whose rule page yields (``hidden_by``) to another rule that fired on the same element.

    The stronger finding lists the dropped codes in its data (``hides``). A finding is dropped if all elements of its subjects
    belong to stronger findings. A finding about a difference, which names one element in its subjects and all in its data
    (``between``), is dropped if one of these does. What counterparts show (a rule with the tag ``symmetry``, a message ``twin``)
    is not dropped for a note on request that is less severe: most reports leave that out. A finding that is the cause of others
    names them in its data (``explains``: ``JNT007 joint[knee]``, or ``JNT007 *`` for all of a rule), whatever their pages say;
    these are dropped too. A finding that takes the place of the one for which the model could not be checked is the cause in
    its stead.
    """
    findings = list(findings)
    index_by_element: dict[tuple[str, str], int] = {}
    for index, finding in enumerate(findings):
        for subject in finding.subjects:
            index_by_element.setdefault((finding.code, _get_element(subject)), index)
    explained = {
        (code, element): index
        for index, finding in reversed([*enumerate(findings)])  # the first one wins
        for code, _, element in (claim.partition(" ") for claim in finding.data.get("explains", ()))
    }
    dropped: set[int] = set()
    hides: dict[int, set[str]] = {}
    inherited: dict[int, Severity] = {}
    for index, finding in enumerate(findings):
        rule = rules.get(finding.code)
        stronger = rule.hidden_by if rule is not None and finding.message_id not in rule.never_hidden else ()
        is_compared = rule is not None and ("symmetry" in rule.tags or finding.message_id == _OF_TWIN)
        elements = set(map(_get_element, finding.subjects))
        between = set(map(_get_element, finding.data.get("between", ())))
        superseding = {
            element: other
            for element in elements | between
            for code in reversed(stronger)  # the first code of the page wins
            if (other := index_by_element.get((code, element))) is not None
            and not (
                is_compared and findings[other].severity < finding.severity and _is_on_request(findings[other], rules)
            )
        }
        superseding |= {
            element: explained[finding.code, place]
            for element in elements
            for place in (WHOLE_RULE, element)
            if (finding.code, place) in explained
        }
        if elements <= superseding.keys() or between & superseding.keys():
            dropped.add(index)
            for other in superseding.values():
                hides.setdefault(other, set()).add(finding.code)
                if finding.blocks_check:
                    inherited[other] = max(finding.severity, findings[other].severity)
    return [_take_place(f, hides.get(i), inherited.get(i)) for i, f in enumerate(findings) if i not in dropped]


def join_explained(findings: Iterable[Finding], rules: Mapping[str, Rule]) -> list[Finding]:
    """Join what a simulation shows to the finding that explains it, so that it is not reported twice.

    That is the first of the rules under ``repeats`` and ``explained_by`` on the page which fired on an element of the finding's
    subjects, or of those in its data (``between``); of its findings, rather one with a message of the same id. One that explains
    must be as severe. It says what happened in the simulator, and lists the joined code in its data (``hides``). What is
    suppressed joins nothing.
    """
    findings = list(findings)
    joined: dict[int, int] = {}
    for index, finding in enumerate(findings):
        rule = rules.get(finding.code)
        repeated = () if rule is None else rule.repeats.get(finding.message_id, ())
        codes = () if rule is None else (*repeated, *rule.explained_by.get(finding.message_id, ()))
        if not codes or finding.suppressed is not None:
            continue
        elements = {*map(_get_element, (*finding.subjects, *finding.data.get("between", ())))}
        reasons = [
            (codes.index(other.code), other.message_id != finding.message_id, place)
            for place, other in enumerate(findings)
            if other.code in codes
            and (other.code in repeated or other.severity >= finding.severity)
            and not elements.isdisjoint(map(_get_element, other.subjects))
        ]
        if reasons:
            joined[index] = min(reasons)[-1]
    for index, place in joined.items():
        findings[place] = _tell_simulated(findings[place], findings[index])
    return [finding for index, finding in enumerate(findings) if index not in joined]


def _tell_simulated(finding: Finding, simulated: Finding) -> Finding:
    """Return a finding that also says what the simulator did here, unless that does not load the model as typed."""
    hidden = {*finding.data.get("hides", ()), simulated.code}
    finding = replace(finding, data={**finding.data, "hides": sorted(hidden)})
    if get_verdict(finding.consequences, SIMULATOR) is not Verdict.LOADS:
        return finding
    sentence = f"simulated it here: {simulated.headline}"
    return replace(finding, consequences={**finding.consequences, SIMULATOR: sentence})


def list_held_back(finding: Finding) -> list[str]:
    """List the rules of which a finding dropped whatever they reported, because it explains all of it."""
    explained = finding.data.get("explains", ())
    return [code for code in finding.data.get("hides", ()) if f"{code} {WHOLE_RULE}" in explained]


def _is_on_request(finding: Finding, rules: Mapping[str, Rule]) -> bool:
    rule = rules.get(finding.code)
    return rule is not None and finding.severity is Severity.INFO and finding.message_id in rule.on_request


def _take_place(finding: Finding, hidden: Collection[str] | None, severity: Severity | None) -> Finding:
    """Return a finding with the codes that it hides; ``severity``: that of a cause in whose place it stands."""
    if hidden is not None:
        finding = replace(finding, data={**finding.data, "hides": sorted(hidden)})
    return finding if severity is None else replace(finding, severity=severity, blocks_check=True)


def _get_element(subject: str) -> str:
    """Return the element that a subject belongs to."""
    element = _ELEMENT.match(subject)
    return element[0] if element else subject.split("/")[0].split("@")[0]
