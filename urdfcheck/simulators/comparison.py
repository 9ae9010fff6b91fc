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
from urdfcheck.simulators.judgement import EngineJudgement, judge_outcome, matches_prediction
from urdfcheck.simulators.outcome import EngineInput, LoadOutcome
from urdfcheck.simulators.processes import ENGINES, get_install_hint, iter_outcomes, list_versions
from urdfcheck.system import libraries, sandbox
from urdfcheck.system.process_pool import map_in_processes


@dataclass(frozen=True, slots=True)
class EngineRow:
    """An engine: its version, what became of the model, what that is, and what was said about it before. ``because``: the
    findings that say the worst."""

    engine: str
    version: str
    outcome: LoadOutcome
    judgement: EngineJudgement
    predicted: Verdict
    codes: tuple[str, ...]

    @property
    def is_surprise(self) -> bool:
        """Whether the engine did what no finding says, or did not what one says."""
        return not matches_prediction(self.predicted, self.judgement)


@dataclass(frozen=True, slots=True)
class EngineComparison:
    """``info`` of the model, the engines that are installed, and how to get the others."""

    info: ModelInfo
    rows: tuple[EngineRow, ...]
    missing: Mapping[str, str]


def compare_engines(request: Request) -> EngineComparison:
    """Load the one model that the request's paths mean in all engines.

    :raises UrdfcheckError: when they mean none, or several, or the model cannot be read at all.
    """
    versions = list_versions()
    names = [name for name in ENGINES if versions[name] is not None]
    # What only some read is told to those for whom it is.
    request = replace(request, policy=replace(request.policy, targets=tuple(name for name in names if name in TARGETS)))
    report = engine.audit_single_model(request)
    found, units = engine.plan_units(request)
    unit = next(unit for unit in units if unit.kind == "model")
    with engine.audit_session(request, [unit], found.reach or request.reach) as settings:
        ((_, robot),) = map_in_processes(_read_input, [(unit, settings)], 1)
        if not isinstance(robot, EngineInput) or report.info is None:
            raise UrdfcheckError(f"{unit.id}: no engine can be given what cannot be read (urdfcheck check says why)")
        at_once = max(1, request.jobs)
        done = dict(
            iter_outcomes([(name, robot) for name in names], settings.visible_folders, request.options.limits, at_once)
        )
    rows = [_make_row(name, versions[name] or "", done[i], robot, report.findings) for i, name in enumerate(names)]
    missing = {name: get_install_hint(name) for name in ENGINES if versions[name] is None}
    return EngineComparison(report.info, tuple(rows), missing)


def predict_verdict(engine: str, findings: Sequence[Finding]) -> tuple[Verdict, tuple[str, ...]]:
    """The worst that findings say an engine does, and the codes of those that say it."""
    told = outcomes_of(findings)[engine]
    return told.verdict, told.codes


def _make_row(
    name: str, version: str, outcome: LoadOutcome, robot: EngineInput, findings: Sequence[Finding]
) -> EngineRow:
    return EngineRow(name, version, outcome, judge_outcome(robot, outcome), *predict_verdict(name, findings))


def _read_input(unit: Unit, settings: AuditSettings) -> EngineInput | None:
    """What a worker process does with a unit."""
    libraries.prefer_own_folders()
    sandbox.confine(settings.visible_folders, (), settings.options.limits.memory)
    from urdfcheck.model import Model
    from urdfcheck.simulators.engine_input import build_input
    from urdfcheck.source.load import load_source
    from urdfcheck.source.package.finder import PackageFinder
    from urdfcheck.source.reach import FileReach

    path = Path(unit.path)
    packages = settings.packages
    reach = None if settings.reach is None else FileReach(settings.reach)
    finder = PackageFinder(path.absolute(), packages.by_name, packages.search_path, reach=reach)
    with sandbox.enforce_deadline(settings.options.limits.seconds):
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
        return build_input(source, model)
