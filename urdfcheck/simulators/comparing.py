"""One model in every engine that is installed, beside what the findings say that these do with it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from urdfcheck.core import Finding, ModelInfo, UrdfcheckError, Verdict
from urdfcheck.policy.config import TARGETS
from urdfcheck.policy.consumers import predict_outcomes as outcomes_of
from urdfcheck.run import pipeline as engine
from urdfcheck.run.jobs import AuditSettings, Request, Unit
from urdfcheck.simulators.judging import Judgement, agree, judge
from urdfcheck.simulators.outcome import Outcome, Robot
from urdfcheck.simulators.running import ENGINES, how_to_install, installed, outcomes
from urdfcheck.system import libraries, sandbox
from urdfcheck.system.process_pool import in_workers


@dataclass(frozen=True, slots=True)
class Row:
    """An engine: its version, what became of the model, what that is, and what was said about it before. ``because``: the
    findings that say the worst."""

    engine: str
    version: str
    outcome: Outcome
    judgement: Judgement
    predicted: Verdict
    because: tuple[str, ...]

    @property
    def surprise(self) -> bool:
        """Whether the engine did what no finding says, or did not what one says."""
        return not agree(self.predicted, self.judgement)


@dataclass(frozen=True, slots=True)
class Comparison:
    """``info`` of the model, the engines that are installed, and how to get the others."""

    info: ModelInfo
    rows: tuple[Row, ...]
    missing: Mapping[str, str]


def compare(request: Request) -> Comparison:
    """Load the one model that the request's paths mean in all engines.

    :raises UrdfcheckError: when they mean none, or several, or the model cannot be read at all.
    """
    versions = installed()
    names = [name for name in ENGINES if versions[name] is not None]
    # What only some read is told to those for whom it is.
    request = replace(request, policy=replace(request.policy, targets=tuple(name for name in names if name in TARGETS)))
    report = engine.audit_single_model(request)
    found, units = engine.plan_units(request)
    unit = next(unit for unit in units if unit.kind == "model")
    with engine.audit_session(request, [unit], found.reach or request.reach) as settings:
        ((_, robot),) = in_workers(_read, [(unit, settings)], 1)
        if not isinstance(robot, Robot) or report.info is None:
            raise UrdfcheckError(f"{unit.id}: no engine can be given what cannot be read (urdfcheck check says why)")
        at_once = max(1, request.jobs)
        done = dict(
            outcomes([(name, robot) for name in names], settings.visible_folders, request.options.limits, at_once)
        )
    rows = [_row(name, versions[name] or "", done[i], robot, report.findings) for i, name in enumerate(names)]
    missing = {name: how_to_install(name) for name in ENGINES if versions[name] is None}
    return Comparison(report.info, tuple(rows), missing)


def predicted(engine: str, findings: Sequence[Finding]) -> tuple[Verdict, tuple[str, ...]]:
    """The worst that findings say an engine does, and the codes of those that say it."""
    told = outcomes_of(findings)[engine]
    return told.verdict, told.codes


def _row(name: str, version: str, outcome: Outcome, robot: Robot, findings: Sequence[Finding]) -> Row:
    return Row(name, version, outcome, judge(robot, outcome), *predicted(name, findings))


def _read(unit: Unit, settings: AuditSettings) -> Robot | None:
    """What a worker process does with a unit."""
    libraries.prefer_own_folders()
    sandbox.confine(settings.visible_folders, (), settings.options.limits.memory)
    from urdfcheck.model import Model
    from urdfcheck.simulators.reading import robot_of
    from urdfcheck.source.load import load_source
    from urdfcheck.source.package.finder import PackageFinder
    from urdfcheck.source.reach import FileReach

    path = Path(unit.path)
    packages = settings.packages
    reach = None if settings.reach is None else FileReach(settings.reach)
    finder = PackageFinder(path.absolute(), packages.by_name, packages.search_path, reach=reach)
    with sandbox.deadline(settings.options.limits.seconds):
        source = load_source(
            path,
            unit.arguments,
            finder,
            explicit=unit.is_explicit,
            xacro=unit.is_xacro,
            environment=frozenset(settings.options.environment),
        )
        model = None
        if source.root is not None and source.root.tag == "robot":
            model = Model(source, source.root, "source")
        return robot_of(source, model)
