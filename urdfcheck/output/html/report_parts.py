"""The sections of a report: one for each model, launch file or package with findings."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import replace

from urdfcheck.core import ModelInfo, Run, Severity
from urdfcheck.core.drop_test import DropTest
from urdfcheck.core.records import dataclass
from urdfcheck.core.scene import Scene
from urdfcheck.output.shared.anchors import FindingCard, build_finding_cards
from urdfcheck.output.shared.wording import get_base_name

# Of a model with more variants, those that were checked and have no findings are left out.
MOST_VARIANTS = 6


@dataclass(frozen=True, slots=True, kw_only=True)
class ReportPart:
    """A part of the report: a model, or the findings of a launch file or a package that belong to no model."""

    id: str
    """Id of its section, and prefix of the ids inside."""
    title: str
    """Name of the robot, else of the file."""
    path: str
    info: ModelInfo | None
    """None for a launch file or a package."""
    cards: tuple[FindingCard, ...]
    scene: Scene | None
    counts: Mapping[Severity, int]
    """Number of findings that are not suppressed."""
    drop: DropTest | None = None
    shared: tuple[FindingCard, ...] = ()
    """Findings whose cards are in another part, with the elements that they are about here."""
    set_aside: str = ""
    """Why errors and warnings of the model are not listed; empty if they are."""

    @property
    def all_cards(self) -> tuple[FindingCard, ...]:
        """The cards of this part, and of others that are about it too."""
        return (*self.cards, *self.shared)

    @property
    def is_checked(self) -> bool:
        """Whether the model was checked; whatever is no model was."""
        return self.info is None or self.info.status == "checked"

    @property
    def file_label(self) -> str:
        """The file and the arguments, which distinguish parts of the same title."""
        if self.info is None:
            return self.path
        arguments = [f"{name}:={value}" for name, value in sorted(self.info.args.items())]
        return " ".join((get_base_name(self.path), *arguments))

    @property
    def sections(self) -> list[tuple[str, str]]:
        """Anchor and name of each section inside; none if there are only findings."""
        if self.scene is None:
            return []
        names = {
            "findings": "Findings",
            **({"info": "Notes"} if any(self._is_note(card) for card in self.cards) else {}),
            "consumers": "Programs",
            "tree": "Tree",
            "physics": "Physics",
            "meshes": "Meshes",
            **({"joints": "Joints"} if self.scene.joints else {}),
            **({"drop": "Drop test"} if self.drop is not None else {}),
            **({"launch": "Launch"} if self.scene.launches else {}),
        }
        return [(f"{self.id}-{anchor}", name) for anchor, name in names.items()]

    @staticmethod
    def _is_note(card: FindingCard) -> bool:
        return card.finding.suppressed is None and card.finding.severity == Severity.INFO


def collect_report_parts(run: Run) -> list[ReportPart]:
    """Collect the models in the run's order, then everything else with findings.

    Of a model with many variants, these are the first, those with findings and those that were not checked."""
    first = {info.path: info.id for info in reversed(run.models)}
    variants = Counter(info.path for info in run.models)
    with_findings = {model for finding in run.findings for model in finding.subjects_by_model}
    models = [
        info
        for info in run.models
        if variants[info.path] <= MOST_VARIANTS
        or info.id in with_findings
        or info.status != "checked"
        or first[info.path] == info.id
    ]
    groups: dict[str, list[FindingCard]] = {info.id: [] for info in models}
    shared: dict[str, list[FindingCard]] = {}
    for card in build_finding_cards(run.findings):
        groups.setdefault(card.finding.model, []).append(card)
        for model, subjects in card.finding.subjects_by_model.items():
            if model != card.finding.model:
                own = replace(card.finding, model=model, subjects=subjects)
                shared.setdefault(model, []).append(FindingCard(own, card.anchors[:1] * max(len(subjects), 1)))
    infos = {info.id: info for info in run.models}
    scenes = {scene.model: scene for scene in run.scenes}
    drops = {drop.model: drop for drop in run.drops}
    parts = []
    for number, (name, group) in enumerate(groups.items(), 1):
        info = infos.get(name)
        path = info.path if info else name
        title = (info.robot if info else "") or get_base_name(path) or "This run"
        counts: dict[Severity, int] = {}
        for card in (*group, *shared.get(name, ())):
            if card.finding.suppressed is None:
                counts[card.finding.severity] = counts.get(card.finding.severity, 0) + 1
        parts.append(
            ReportPart(
                id=f"m{number}",
                title=title,
                path=path,
                info=info,
                cards=tuple(group),
                scene=scenes.get(name),
                counts=counts,
                drop=drops.get(name),
                shared=tuple(shared.get(name, ())),
                set_aside=run.set_aside.get(name, ""),
            )
        )
    return parts
