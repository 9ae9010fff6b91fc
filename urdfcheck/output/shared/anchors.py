"""Link targets of findings, and the worst finding of each link, joint and static transform."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

from urdfcheck.core import Finding, Severity, Span
from urdfcheck.core.records import dataclass
from urdfcheck.core.scene import SceneFrame

_ELEMENT = re.compile(r"(link|joint)\[(.*?)\](?=[/@]|$)", re.DOTALL)

ElementKey = tuple[str, ...]


@dataclass(frozen=True, slots=True)
class FindingCard:
    """A finding with its anchors: ``anchors[i]`` belongs to subject ``i``; the first one is the card's own."""

    finding: Finding
    anchors: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class SeverityMark:
    """The worst finding of an element: its severity, the anchor of its card, and the number of findings."""

    severity: Severity
    anchor: str
    count: int


def build_finding_cards(findings: Iterable[Finding]) -> list[FindingCard]:
    """Give each finding its anchors: its fingerprints, numbered from the second use on, so that ids are unique."""
    counts: dict[str, int] = {}
    cards = []
    for finding in findings:
        anchors = []
        for fingerprint in finding.fingerprints or (finding.code,):
            number = counts[fingerprint] = counts.get(fingerprint, 0) + 1
            anchors.append(f"f-{fingerprint}" if number == 1 else f"f-{fingerprint}-{number}")
        cards.append(FindingCard(finding, tuple(anchors)))
    return cards


def parse_element_key(subject: str) -> ElementKey | None:
    """Return ``("link", "wheel_1")`` for ``link[wheel_1]/inertial@…``; None if the subject is in neither a link nor a joint."""
    match = _ELEMENT.match(subject)
    return (match[1], match[2]) if match else None


def make_frame_key(parent: str, child: str) -> ElementKey:
    """Return the key of a launch file's static transform, which findings match by its span: no subject names it."""
    return ("frame", parent, child)


def compute_severity_marks(
    model_cards: Iterable[FindingCard],
    frames: Iterable[SceneFrame] = (),
    element_spans: Iterable[tuple[ElementKey, Span]] = (),
) -> Mapping[ElementKey, SeverityMark]:
    """Find the worst finding of each link, joint, static transform and span that has one; suppressed findings do not count."""
    spans = [(make_frame_key(f.parent, f.child), f.span) for f in frames if f.span is not None]
    spans += element_spans
    marks: dict[ElementKey, SeverityMark] = {}
    for card in model_cards:
        if card.finding.suppressed is not None:
            continue
        places = [own.location.span for own in card.finding.list_occurrences()]
        keys = [key for subject in card.finding.subjects if (key := parse_element_key(subject)) is not None]
        keys += [key for key, span in spans if any(p is not None and _is_overlapping(p, span) for p in places)]
        for key in dict.fromkeys(keys):
            mark = marks.get(key)
            if mark is None or card.finding.severity > mark.severity:
                marks[key] = SeverityMark(card.finding.severity, card.anchors[0], 1 + (mark.count if mark else 0))
            else:
                marks[key] = SeverityMark(mark.severity, mark.anchor, mark.count + 1)
    return marks


def _is_overlapping(a: Span, b: Span) -> bool:
    return a.file == b.file and a.start < b.end and b.start < a.end
