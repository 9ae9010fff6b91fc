"""Load a model in every installed engine and compare the results with the predictions of the findings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from urdfcheck.core import Finding, ModelInfo, Verdict
from urdfcheck.core.errors import ModelNotCheckedError
from urdfcheck.core.records import dataclass
from urdfcheck.policy.config import TARGETS
from urdfcheck.policy.consumers import predict_outcomes as outcomes_of
from urdfcheck.run import pipeline as engine
from urdfcheck.run.jobs import AuditSettings, Request, Unit
from urdfcheck.simulators.judgement import EngineJudgement, judge_outcome, matches_prediction
from urdfcheck.simulators.outcome import EngineInput, LoadOutcome
from urdfcheck.simulators.processes import ENGINES, get_install_hint, iter_outcomes, list_versions
from urdfcheck.system import libraries, sandbox
from urdfcheck.system.array_cache import ArrayCache
from urdfcheck.system.installation import list_own_files
from urdfcheck.system.observing.observations import Observations, observe
from urdfcheck.system.process_pool import map_in_processes


@dataclass(frozen=True, slots=True, kw_only=True)
class EngineRow:
    """The result of one engine."""

    engine: str
    version: str
    outcome: LoadOutcome
    judgement: EngineJudgement
    predicted: Verdict
    """The worst that findings predict for the engine."""
    codes: tuple[str, ...]
    """Codes of the findings that predict it."""

    @property
    def is_surprise(self) -> bool:
        """Whether the engine did not do what the findings predict."""
        return not matches_prediction(self.predicted, self.judgement)


@dataclass(frozen=True, slots=True)
class EngineComparison:
    """A model in all installed engines; ``missing``: how to install the others."""

    info: ModelInfo
    rows: tuple[EngineRow, ...]
    missing: Mapping[str, str]


def compare_engines(request: Request) -> EngineComparison:
    """Load the one model that the request's paths lead to in all engines.

    :raises UrdfcheckError: if they lead to none, or to several; `ModelNotCheckedError` if the model cannot be read at all.
    """
    versions = list_versions()
    names = [name for name in ENGINES if versions[name] is not None]
    # Findings that depend on the targets are predictions for the installed engines.
    request = replace(request, policy=replace(request.policy, targets=tuple(name for name in names if name in TARGETS)))
    report = engine.audit_single_model(request)
    found, units = engine.plan_units(request)
    unit = next(unit for unit in units if unit.kind == "model")
    with engine.audit_session(request, [unit], found) as settings:
        ((_, read),) = map_in_processes(read_engine_input, [(unit, settings)], 1)
        robot = read[0] if isinstance(read, tuple) else None
        if not isinstance(robot, EngineInput) or report.info is None:
            raise ModelNotCheckedError(
                f"{unit.id}: only readable files with a <robot> are given to engines (urdfcheck check says what is wrong)"
            )
        at_once = max(1, request.jobs)
        done = dict(
            iter_outcomes(
                [(name, robot) for name in names],
                around=settings.visible_folders,
                limits=request.options.limits,
                at_once=at_once,
            )
        )
    rows = [
        _make_row(name, versions[name] or "", outcome=done[i], robot=robot, findings=report.findings)
        for i, name in enumerate(names)
    ]
    missing = {name: get_install_hint(name) for name in ENGINES if versions[name] is None}
    return EngineComparison(report.info, tuple(rows), missing)


def predict_verdict(engine: str, findings: Sequence[Finding]) -> tuple[Verdict, tuple[str, ...]]:
    """Return the worst that findings predict for an engine, and their codes."""
    outcome = outcomes_of(findings, (engine,))[engine]
    return outcome.verdict, outcome.codes


def _make_row(
    name: str, version: str, *, outcome: LoadOutcome, robot: EngineInput, findings: Sequence[Finding]
) -> EngineRow:
    predicted, codes = predict_verdict(name, findings)
    return EngineRow(
        engine=name,
        version=version,
        outcome=outcome,
        judgement=judge_outcome(robot, outcome),
        predicted=predicted,
        codes=codes,
    )


def read_engine_input(unit: Unit, settings: AuditSettings) -> tuple[EngineInput | None, Observations]:
    """Read the model of a unit, in a worker process; None for a model that is not given to engines.

    Also return all that it depends on, the content of the meshes included, which only the engines read.
    """
    libraries.prefer_own_folders()
    cache = settings.cache  # holds what the check has just measured
    sandbox.confine(settings.visible_folders, [cache] if cache else [], settings.options.limits.memory)
    with observe(apart=(*([cache] if cache else []), *list_own_files())) as observations:
        robot = _read_observed(unit, settings)
    return robot, observations


def _read_observed(unit: Unit, settings: AuditSettings) -> EngineInput | None:
    from urdfcheck.model import Model
    from urdfcheck.simulators.engine_input import build_input
    from urdfcheck.source.load import load_source
    from urdfcheck.source.package.finder import PackageFinder
    from urdfcheck.source.reach import FileReach

    path = Path(unit.path)
    packages, cache = settings.packages, settings.cache
    reach = None if settings.reach is None else FileReach(settings.reach)
    known = {name: list(folders) for name, folders in settings.known_packages.items()}
    finder = PackageFinder(path.absolute(), packages.by_name, packages.search_path, reach=reach, known=known)
    with sandbox.enforce_deadline(settings.options.limits.seconds):
        source = load_source(
            path,
            unit.arguments,
            finder,
            xacro=unit.is_xacro,
            environment=frozenset(settings.options.environment),
        )
        model = None
        if source.root is not None and source.root.tag == "robot":
            model = Model(
                source=source,
                robot=source.root,
                tier="source" if settings.policy.tier == "source" else "mesh",
                cache=ArrayCache(Path(cache) if cache else None),
            )
            if model.tier != "source":
                _ = model.meshes  # observed here; engines read them later
        return build_input(source, model)
