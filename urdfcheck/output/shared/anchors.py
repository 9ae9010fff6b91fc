"""Where each finding can be linked to, and which finding is the worst of each link, joint and static transform."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from urdfcheck.core import Finding, Severity, Span
from urdfcheck.core.scene import SceneFrame

_ELEMENT = re.compile(r"(link|joint)\[(.*?)\](?=[/@]|$)", re.DOTALL)

ElementKey = tuple[str, ...]


@dataclass(frozen=True, slots=True)
class FindingCard:
    """A finding with its anchors: ``ids[i]`` belongs to subject ``i``; the first one is the card's own."""

    finding: Finding
    anchors: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class SeverityMark:
    """The worst finding of an element: its severity, where its card is, and how many findings there are."""

    severity: Severity
    anchor: str
    count: int


def build_finding_cards(findings: Iterable[Finding]) -> list[FindingCard]:
    """Anchors are fingerprints; the second finding of one fingerprint gets a number, so that ids stay unique."""
    seen: dict[str, int] = {}
    found = []
    for finding in findings:
        ids = []
        for print_ in finding.fingerprints or (finding.code,):
            seen[print_] = seen.get(print_, 0) + 1
            ids.append(f"f-{print_}" if seen[print_] == 1 else f"f-{print_}-{seen[print_]}")
        found.append(FindingCard(finding, tuple(ids)))
    return found


def parse_element_key(subject: str) -> ElementKey | None:
    """``("link", "wheel_1")`` of ``link[wheel_1]/inertial@…``; None when the subject lies in neither link nor joint."""
    match = _ELEMENT.match(subject)
    return (match[1], match[2]) if match else None


def make_frame_key(parent: str, child: str) -> ElementKey:
    """A launch file's static transform. No finding's subject names it: its place in the file does."""
    return ("frame", parent, child)


def compute_severity_marks(
    model_cards: Iterable[FindingCard],
    frames: Iterable[SceneFrame] = (),
    element_spans: Iterable[tuple[ElementKey, Span]] = (),
) -> Mapping[ElementKey, SeverityMark]:
    """The worst finding of each link, joint, static transform and place in a file that has one; suppressed findings do not
    count."""
    spans = [(make_frame_key(f.parent, f.child), f.span) for f in frames if f.span is not None]
    spans += element_spans
    found: dict[ElementKey, SeverityMark] = {}
    for card in model_cards:
        if card.finding.suppressed is not None:
            continue
        at = card.finding.location.span
        touched = [e for s in card.finding.subjects if (e := parse_element_key(s)) is not None]
        touched += [of for of, span in spans if at is not None and _is_overlapping(at, span)]
        for of in dict.fromkeys(touched):
            known = found.get(of)
            if known is None or card.finding.severity > known.severity:
                found[of] = SeverityMark(card.finding.severity, card.anchors[0], 1 + (known.count if known else 0))
            else:
                found[of] = SeverityMark(known.severity, known.anchor, known.count + 1)
    return found


def _is_overlapping(a: Span, b: Span) -> bool:
    return a.file == b.file and a.start < b.end and b.start < a.end
