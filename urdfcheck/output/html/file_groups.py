"""The order of the findings in a report, by severity and then by file, and the relation of each file to the model."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from urdfcheck.core import Severity
from urdfcheck.output.shared.anchors import FindingCard

MODEL, LAUNCH_FILE = "model file", "launch file"
_LAUNCH = re.compile(r"\.launch(?:\.\w+)?$|[._]launch\.(?:py|xml|ya?ml)$", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class FileGroup:
    """The cards of one file; ``file`` is empty for findings without a span."""

    file: str
    kind: str
    cards: tuple[FindingCard, ...]


def select_active_cards(cards: Iterable[FindingCard], severity: Severity) -> list[FindingCard]:
    """Select the cards of a severity that are not suppressed."""
    return [c for c in cards if c.finding.suppressed is None and c.finding.severity == severity]


def group_cards_by_file(cards: Sequence[FindingCard], model_file: str) -> list[FileGroup]:
    """Group cards by file: the model's own file first, because readers begin with the robot, and launch files last."""
    files: dict[str, list[FindingCard]] = {}
    for card in cards:
        span = card.finding.location.span
        files.setdefault("" if span is None else span.file, []).append(card)
    groups = [FileGroup(file, classify_file(file, model_file), tuple(group)) for file, group in files.items()]
    return sorted(groups, key=lambda g: (g.kind != MODEL) + (g.kind == LAUNCH_FILE))


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
