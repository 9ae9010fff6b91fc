"""The sections of a report: one for each model, launch file or package with findings."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass

from urdfcheck.core import ModelInfo, Run, Severity
from urdfcheck.core.drop_test import DropTest
from urdfcheck.core.scene import Scene
from urdfcheck.output.shared.anchors import FindingCard, build_finding_cards
from urdfcheck.output.shared.wording import get_base_name

MOST_VARIANTS = 6


@dataclass(frozen=True, slots=True)
class ReportPart:
    """A section of the report: a model, or the findings of a launch file or a package that belong to no model."""

    id: str
    title: str
    path: str
    info: ModelInfo | None
    cards: tuple[FindingCard, ...]
    scene: Scene | None
    counts: Mapping[Severity, int]
    drop: DropTest | None = None

    @property
    def file_label(self) -> str:
        """What tells it from another part of the same title."""
        if self.info is None:
            return self.path
        given = [f"{name}:={value}" for name, value in sorted(self.info.args.items())]
        return " ".join((get_base_name(self.path), *given))

    @property
    def sections(self) -> list[tuple[str, str]]:
        """Anchor and name of each section inside; none where there are only findings."""
        if self.scene is None:
            return []
        found = [(f"{self.id}-findings", "Findings"), (f"{self.id}-tree", "Tree")]
        found += [(f"{self.id}-drop", "Drop test")] if self.drop is not None else []
        found += [(f"{self.id}-consumers", "Programs"), (f"{self.id}-physics", "Physics")]
        found += [(f"{self.id}-meshes", "Meshes")]
        found += [(f"{self.id}-joints", "Joints")] if self.scene.joints else []
        found += [(f"{self.id}-launch", "Launch")] if self.scene.launches else []
        found += [(f"{self.id}-info", "Information")] if self.counts.get(Severity.INFO) else []
        return found


def collect_report_parts(run: Run) -> list[ReportPart]:
    """The models in the run's order, then whatever else has findings; of many variants of a model the first, and those of which
    there is something to tell."""
    first = {info.path: info.id for info in reversed(run.models)}
    variants = Counter(info.path for info in run.models)
    told = {finding.model for finding in run.findings}
    models = [i for i in run.models if variants[i.path] <= MOST_VARIANTS or i.id in told or first[i.path] == i.id]
    groups: dict[str, list[FindingCard]] = {info.id: [] for info in models}
    for card in build_finding_cards(run.findings):
        groups.setdefault(card.finding.model, []).append(card)
    infos = {info.id: info for info in run.models}
    scenes = {scene.model: scene for scene in run.scenes}
    drops = {drop.model: drop for drop in run.drops}
    parts = []
    for number_, (name, group) in enumerate(groups.items(), 1):
        info = infos.get(name)
        path = info.path if info else name
        title = (info.robot if info else "") or get_base_name(path) or "This run"
        counts: dict[Severity, int] = {}
        for card in group:
            if card.finding.suppressed is None:
                counts[card.finding.severity] = counts.get(card.finding.severity, 0) + 1
        parts.append(
            ReportPart(f"m{number_}", title, path, info, tuple(group), scenes.get(name), counts, drops.get(name))
        )
    return parts
