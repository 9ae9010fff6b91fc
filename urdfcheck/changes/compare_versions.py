"""From two paths to a `Diff`: both are checked like any other, and their models compared in worker processes."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from urdfcheck.changes.finding_changes import compare_findings
from urdfcheck.changes.model_pairs import ModelPair, VersionedModel, pair_models
from urdfcheck.changes.text_changes import SideTexts, find_causes
from urdfcheck.changes.wording import describe_change, judge_change
from urdfcheck.core import ModelInfo, Run, UrdfcheckError
from urdfcheck.core.errors import ModelTimeout
from urdfcheck.core.model_diff import UNKNOWN, Diff, ModelDiff
from urdfcheck.policy.limits import ResourceLimits
from urdfcheck.run.jobs import Request, UnitReport
from urdfcheck.run.pipeline import IN_WORKERS, AuditedRun, Execution, run_audit
from urdfcheck.source.package.finder import format_path
from urdfcheck.system import libraries, sandbox
from urdfcheck.system.process_pool import WorkerDiedError, map_in_processes
from urdfcheck.version import __version__


@dataclass(frozen=True, slots=True)
class _CheckedVersion:
    """A version that was checked."""

    audited: AuditedRun
    folder: str
    """As spans name it."""
    models: Sequence[VersionedModel]


def compare_versions(before: Request, after: Request, execution: Execution = IN_WORKERS) -> Diff:
    """Check two versions and compare their models; each request has one path.

    Requests that name what they want of it may find no model.

    :raises UrdfcheckError: if a path does not exist, or no model is found in either version.
    :raises KeyboardInterrupt: if the user interrupts.
    """
    first = _read_side(before, execution)
    second = _read_side(after, execution.without_start())
    pairs = pair_models(first.models, second.models, are_named=before.only is None)
    if not pairs and before.only is None:
        raise UrdfcheckError(f"{before.paths[0]}, {after.paths[0]}: no model to compare")
    in_process = execution.audit is not None
    models = tuple(_compare_pairs(pairs, first.folder, second.folder, before, in_process=in_process))
    ids = {
        pair.before.info.id: pair.after.info.id for pair in pairs if pair.before is not None and pair.after is not None
    }
    ids |= _pair_units(first, second, ids)
    names = {model.before: model.mechanism.new_names for model in models if model.mechanism is not None}
    runs = (first.audited.outcome, second.audited.outcome)
    return Diff(
        before=format_path(before.paths[0]),
        after=format_path(after.paths[0]),
        models=models,
        findings=compare_findings(*runs, ids, names),
        failures=_list_failures(first, second, models),
        version=__version__,
        runs=runs if after.options.scene else None,
    )


# -- reading -----------------------------------------------------------------------------------------------------------


def _read_side(request: Request, execution: Execution) -> _CheckedVersion:
    """Check one version; its models are read by the workers that check them.

    :raises UrdfcheckError: if its path does not exist.
    :raises KeyboardInterrupt: if the user interrupts.
    """
    (path,) = request.paths
    if not os.path.lexists(path):
        raise UrdfcheckError(f"{path}: there is no such file or folder")
    wanted = replace(request, options=replace(request.options, mechanism=True))
    audited = run_audit(wanted, execution)
    if audited.outcome.partial:
        raise KeyboardInterrupt
    folder = format_path(path if path.is_dir() else path.parent)
    return _CheckedVersion(audited, folder, tuple(_list_models(audited, folder)))


def _list_models(audited: AuditedRun, folder: str) -> list[VersionedModel]:
    """Return the models of a run with what its workers made of them."""
    infos = {info.id: info for info in audited.outcome.models}
    models = []
    for index, unit in enumerate(audited.units):
        report, info = audited.reports.get(index), infos.get(unit.id)
        if report is None or info is None or unit.kind != "model" or report.info is None:
            continue
        models.append(
            VersionedModel(
                info=info,
                path=_make_relative(info.path, folder),
                mechanism=report.mechanism,
                texts=report.sources,
                problem="" if report.mechanism is not None else _explain_missing(report, info, audited.outcome),
            )
        )
    return models


def _make_relative(path: str, folder: str) -> str:
    try:
        return Path(os.path.relpath(path, folder)).as_posix()
    except ValueError:  # another drive
        return path


def _explain_missing(report: UnitReport, info: ModelInfo, outcome: Run) -> str:
    """Return why a model could not be compared."""
    if info.not_checked is not None:
        return info.not_checked.reason
    reasons = [skip.reason for skip in report.skipped if skip.code in {"diff", "URC905"}]
    return next(iter((*reasons, *report.failures, *outcome.failures)), "there is no robot in it")


# -- comparing ---------------------------------------------------------------------------------------------------------


def _compare_pairs(
    pairs: Sequence[ModelPair], old_folder: str, new_folder: str, request: Request, *, in_process: bool
) -> list[ModelDiff]:
    """Compare the models of each pair, in worker processes unless ``in_process``."""
    limits = request.options.limits
    jobs = {index: (pair, old_folder, new_folder, limits) for index, pair in enumerate(pairs) if _is_comparable(pair)}
    found: dict[int, ModelDiff] = {}
    if in_process:
        found = {index: _compare_models(pair, old, new) for index, (pair, old, new, _) in jobs.items()}
    else:
        places = list(jobs)
        longest = limits.seconds + sandbox.PATIENCE if limits.seconds else None
        answers = map_in_processes(_compare_in_worker, list(jobs.values()), max(1, request.jobs), timeout=longest)
        for place, answer in answers:
            pair = pairs[places[place]]
            reason = "the comparison was stopped" if isinstance(answer, WorkerDiedError) else answer
            found[places[place]] = answer if isinstance(answer, ModelDiff) else _make_unknown(pair, str(reason))
    return [found[index] if index in found else _describe_lone(pair) for index, pair in enumerate(pairs)]


def _is_comparable(pair: ModelPair) -> bool:
    return all(model is not None and model.mechanism is not None for model in (pair.before, pair.after))


def _compare_in_worker(pair: ModelPair, old_folder: str, new_folder: str, limits: ResourceLimits) -> ModelDiff | str:
    """Compare two models inside a worker process, which opens no file; a text says why that failed."""
    libraries.prefer_own_folders()
    sandbox.confine((), (), limits.memory)
    try:
        with sandbox.enforce_deadline(limits.seconds):
            return _compare_models(pair, old_folder, new_folder)
    except ModelTimeout:
        return f"the comparison took more than {limits.seconds:g} s (--timeout)"
    except MemoryError:
        return f"the comparison takes more than {limits.memory} MiB (--memory)"


def _compare_models(pair: ModelPair, old_folder: str, new_folder: str) -> ModelDiff:
    """Compare two models that were read."""
    from urdfcheck.facts.comparison.compare import compare_mechanisms  # loads numpy

    first, second = pair.before, pair.after
    assert first is not None
    assert second is not None
    before, after = first.mechanism, second.mechanism
    assert before is not None
    assert after is not None
    found = compare_mechanisms(before, after)
    texts = (
        SideTexts.of_model(before, first.texts, old_folder),
        SideTexts.of_model(after, second.texts, new_folder),
    )
    found = replace(found, causes=find_causes(found.changes, *texts))
    is_equal = sorted(before.digests.values()) == sorted(after.digests.values())
    verdict, headline = judge_change(found, has_equal_texts=is_equal)
    return ModelDiff(
        before=first.info.id,
        after=second.info.id,
        verdict=verdict,
        headline=headline,
        mechanism=found,
        texts=tuple(map(describe_change, found.changes)),
        notes=tuple(map(describe_change, found.notes)),
        matched_by=pair.matched_by,
    )


def _describe_lone(pair: ModelPair) -> ModelDiff:
    """Return the difference of a model that only one version has, or of which one version gives no robot."""
    first, second = pair.before, pair.after
    if first is not None and second is not None:
        unread = [(name, m.problem) for name, m in (("before", first), ("after", second)) if m.mechanism is None]
        if len(unread) == 2 and first.problem == second.problem:
            unread = [("both versions", first.problem)]
        return _make_unknown(pair, "; ".join(f"{name}: {problem}" for name, problem in unread))
    return ModelDiff(
        before="" if first is None else first.info.id,
        after="" if second is None else second.info.id,
        verdict="structure",
        headline="the model is new" if first is None else "the model is gone",
        mechanism=None,
        matched_by=pair.matched_by,
    )


def _make_unknown(pair: ModelPair, problem: str) -> ModelDiff:
    return ModelDiff(
        before="" if pair.before is None else pair.before.info.id,
        after="" if pair.after is None else pair.after.info.id,
        verdict=UNKNOWN,
        headline=f"cannot be compared: {problem}",
        mechanism=None,
        problem=problem,
        matched_by=pair.matched_by,
    )


def _list_failures(first: _CheckedVersion, second: _CheckedVersion, models: Sequence[ModelDiff]) -> tuple[str, ...]:
    """Return why a part of a version is unknown."""
    failures = (
        f"{name}: {text}"
        for name, side in (("before", first), ("after", second))
        for text in side.audited.outcome.failures
    )
    unknown = (f"{model.after or model.before}: {model.headline}" for model in models if model.verdict == UNKNOWN)
    return tuple(dict.fromkeys((*failures, *unknown)))


def _pair_units(first: _CheckedVersion, second: _CheckedVersion, models: Mapping[str, str]) -> dict[str, str]:
    """Return the launch files and packages of the first version by id, with the ids of those at the same path of the second."""

    def list_units(side: _CheckedVersion) -> dict[tuple[str, str], str]:
        return {
            (unit.kind, _make_relative(format_path(Path(unit.path)), side.folder)): unit.id
            for unit in side.audited.units
            if unit.kind != "model"
        }

    news = list_units(second)
    found = {unit: news[key] for key, unit in list_units(first).items() if key in news}
    return {unit: other for unit, other in found.items() if unit not in models}
