"""Which findings a part of the report lists, the worst first, and the relation of each file to the model."""

from __future__ import annotations

import re
from collections.abc import Iterable

from urdfcheck.core import Severity
from urdfcheck.output.shared.anchors import FindingCard
from urdfcheck.output.shared.wording import sort_worst_first

MODEL, LAUNCH_FILE = "model file", "launch file"
_LAUNCH = re.compile(r"\.launch(?:\.\w+)?$|[._]launch\.(?:py|xml|ya?ml)$", re.IGNORECASE)


def select_active_cards(cards: Iterable[FindingCard], *severities: Severity) -> list[FindingCard]:
    """Select the cards of some severities that are not suppressed: why a model was not checked, then the worst first."""
    active = [c for c in cards if c.finding.suppressed is None and c.finding.severity in severities]
    waiting: dict[int, list[FindingCard]] = {}
    for card in active:
        waiting.setdefault(id(card.finding), []).append(card)
    ordered = [waiting[id(finding)].pop(0) for finding in sort_worst_first(card.finding for card in active)]
    return sorted(ordered, key=lambda card: not card.finding.blocks_check)


def classify_file(file: str, model_file: str) -> str:
    """Return what a file is to the model, in words; empty for no file."""
    if not file:
        return ""
    if _LAUNCH.search(file):
        return LAUNCH_FILE
    if file.replace("\\", "/").rsplit("/", 1)[-1] == "package.xml":
        return "package manifest"
    if file == model_file:
        return MODEL
    return "included file" if file.lower().endswith((".xacro", ".urdf")) else "file"
