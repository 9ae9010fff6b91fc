"""The models of a comparison, each with its scenes, its changes and its findings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from urdfcheck.core import Run
from urdfcheck.core.model_diff import COSMETIC, IDENTICAL, VERDICTS, Diff, MechanismDiff, ModelDiff
from urdfcheck.core.records import dataclass
from urdfcheck.core.scene import Scene
from urdfcheck.output.changes.png import index_scenes
from urdfcheck.output.shared.anchors import FindingCard, build_finding_cards
from urdfcheck.output.shared.wording import get_base_name

# Models that are drawn, the most important verdict first: a page with more would take a browser long.
MOST_DRAWN = 24


@dataclass(frozen=True, slots=True, kw_only=True)
class ComparedModel:
    """A model of the page."""

    id: str
    """Id of its section, and prefix of the ids inside."""
    title: str
    """Name of the robot, else of the file."""
    difference: ModelDiff
    before: Scene | None
    """None where the first version has no such model, or it is not drawn: with nothing to compare, the second alone is."""
    after: Scene | None
    """None where the second version has no such model, or it is not drawn."""
    new: tuple[FindingCard, ...] = ()
    gone: tuple[FindingCard, ...] = ()

    @property
    def found(self) -> MechanismDiff | None:
        """What differs; None where a side gives no robot."""
        return self.difference.mechanism

    @property
    def name(self) -> str:
        """Id of the model in the newest version that has it."""
        return self.difference.after or self.difference.before

    @property
    def is_same(self) -> bool:
        """Whether both versions and their findings are equal."""
        return self.difference.verdict == IDENTICAL and not (self.new or self.gone)

    def has_parts(self, subjects: Sequence[str]) -> bool:
        """Whether a version that is drawn has one of the links or joints that subjects name."""
        scenes = [scene for scene in (self.before, self.after) if scene is not None]
        names = {f"link[{link.name}]" for scene in scenes for link in scene.links}
        names |= {f"joint[{joint.name}]" for scene in scenes for joint in scene.joints}
        return any(subject.startswith(name) for subject in subjects for name in names)

    @property
    def is_drawn(self) -> bool:
        """Whether the 3D view shows it."""
        return self.before is not None or self.after is not None


@dataclass(frozen=True, slots=True, kw_only=True)
class OtherFindings:
    """The findings of launch files and packages, which belong to no model."""

    new: tuple[FindingCard, ...] = ()
    gone: tuple[FindingCard, ...] = ()


def collect_compared_models(diff: Diff) -> tuple[list[ComparedModel], OtherFindings]:
    """Collect the models, the most important verdict first, and the findings of everything else."""
    cards = build_finding_cards((*diff.findings.new, *diff.findings.gone))
    new, gone = cards[: len(diff.findings.new)], cards[len(diff.findings.new) :]
    olds, news = index_scenes(diff)
    names = {} if diff.runs is None else _index_names(*diff.runs)
    ordered = sorted(diff.models, key=lambda model: VERDICTS.index(model.verdict))
    models = []
    for number, model in enumerate(ordered, 1):
        # Of equal models there is nothing to see, unless it is the only one.
        is_drawn = number <= MOST_DRAWN and (len(ordered) == 1 or model.verdict not in {IDENTICAL, COSMETIC})
        before, after = (olds.get(model.before), news.get(model.after)) if is_drawn else (None, None)
        if model.mechanism is None and after is not None:
            before = None  # how the two lie is unknown
        title = names.get(model.after or model.before) or get_base_name(model.after or model.before)
        models.append(
            ComparedModel(
                id=f"m{number}",
                title=title,
                difference=model,
                before=before,
                after=after,
                new=tuple(card for card in new if model.after and card.finding.model == model.after),
                gone=tuple(card for card in gone if model.before and card.finding.model == model.before),
            )
        )
    known_new = {model.after for model in diff.models}
    known_old = {model.before for model in diff.models}
    others = OtherFindings(
        new=tuple(card for card in new if card.finding.model not in known_new),
        gone=tuple(card for card in gone if card.finding.model not in known_old),
    )
    return models, others


def _index_names(before: Run, after: Run) -> Mapping[str, str]:
    """Return the name of the robot of each model, by its id."""
    return {info.id: info.robot for run in (before, after) for info in run.models}
