"""From two paths to a `Diff`: both are checked like any other, and their models compared in worker processes."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from urdfcheck.changes.effect_wording import describe_effect
from urdfcheck.changes.finding_changes import compare_findings
from urdfcheck.changes.model_pairs import ModelPair, VersionedModel, pair_models
from urdfcheck.changes.seam_changes import compare_seams
from urdfcheck.changes.text_changes import (
    SideTexts,
    find_causes,
    find_edited_lines,
    has_edited_choices,
    list_idle_edits,
)
from urdfcheck.changes.wording import describe_change, judge_change
from urdfcheck.core import ModelInfo, Run, UrdfcheckError
from urdfcheck.core.errors import ModelTimeout
from urdfcheck.core.model_diff import UNKNOWN, Diff, MechanismDiff, ModelDiff, SeamChange
from urdfcheck.core.records import dataclass
from urdfcheck.core.seams import SeamFact
from urdfcheck.policy.limits import ResourceLimits
from urdfcheck.policy.policy import TIERS
from urdfcheck.run.jobs import Request, UnitReport
from urdfcheck.run.pipeline import IN_WORKERS, AuditedRun, Execution, run_audit
from urdfcheck.source.package.finder import format_path
from urdfcheck.system import libraries, sandbox
from urdfcheck.system.array_cache import ArrayCache
from urdfcheck.system.files import read_regular
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
    first, second = _add_unread_texts(first, second), _add_unread_texts(second, first)
    pairs = pair_models(first.models, second.models, are_named=before.only is None)
    if not pairs and before.only is None:
        raise UrdfcheckError(f"{before.paths[0]}, {after.paths[0]}: no model to compare")
    in_process = execution.audit is not None
    models = tuple(_compare_pairs(pairs, first.folder, second.folder, before, in_process=in_process))
    ids = {
        pair.before.info.id: pair.after.info.id for pair in pairs if pair.before is not None and pair.after is not None
    }
    ids |= _pair_units(first, second, ids)
    # What the file of an unread model declares is not known.
    unread = {pair.before.info.id for pair in pairs if pair.before is not None and _has_unread_side(pair)}
    names = {model.before: model.mechanism.new_names for model in models if model.mechanism is not None}
    runs = (first.audited.outcome, second.audited.outcome)
    return Diff(
        before=format_path(before.paths[0]),
        after=format_path(after.paths[0]),
        models=models,
        findings=compare_findings(*runs, ids, names),
        seams=_compare_seams(first, second, {unit: other for unit, other in ids.items() if unit not in unread}, names),
        failures=_list_failures(first, second, models),
        version=__version__,
        files=frozenset(
            name
            for side in (first, second)
            for report in side.audited.reports.values()
            if report.mechanism is not None
            for name in report.expanded_files
        ),
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


def _add_unread_texts(side: _CheckedVersion, other: _CheckedVersion) -> _CheckedVersion:
    """Add the files that a version has and does not use, and the other uses: they need not be new."""
    wanted = {_make_relative(name, other.folder) for model in other.models for name in model.texts}
    texts: dict[str, str] = {}
    for path in sorted(path for path in wanted if not path.startswith("../") and not os.path.isabs(path)):
        name = format_path(Path(side.folder) / path)
        is_inside = os.path.realpath(name).startswith(os.path.realpath(side.folder) + os.sep)
        if is_inside and any(name not in model.texts for model in side.models):
            with contextlib.suppress(OSError, ValueError):
                texts[name] = read_regular(Path(name)).decode("utf-8", "replace")
    return replace(side, models=tuple(replace(model, texts={**texts, **model.texts}) for model in side.models))


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


@dataclass(frozen=True, slots=True)
class _Measuring:
    """What is computed beside what the models say."""

    cache: Path | None
    """Folder of cached results."""
    tier: str
    """Of `TIERS`: from the second on shapes are read, in the last they are moved."""


# -- comparing ---------------------------------------------------------------------------------------------------------


def _compare_pairs(
    pairs: Sequence[ModelPair], old_folder: str, new_folder: str, request: Request, *, in_process: bool
) -> list[ModelDiff]:
    """Compare the models of each pair, in worker processes unless ``in_process``."""
    limits = request.options.limits
    measuring = _Measuring(request.cache, request.policy.tier)
    found = {
        index: same
        for index, pair in enumerate(pairs)
        if (same := _describe_same(pair, old_folder, new_folder)) is not None
    }
    jobs = {
        index: (pair, old_folder, new_folder, measuring)
        for index, pair in enumerate(pairs)
        if index not in found and _is_comparable(pair)
    }
    if in_process:
        found |= {index: _compare_models(*job) for index, job in jobs.items()}
    else:
        places = list(jobs)
        longest = limits.seconds + sandbox.PATIENCE if limits.seconds else None
        mechanisms = [model.mechanism for pair, *_ in jobs.values() for model in (pair.before, pair.after) if model]
        meshes = sorted({file for mechanism in mechanisms if mechanism is not None for file in mechanism.mesh_files})
        guarded = [(*job, meshes, limits) for job in jobs.values()]
        answers = map_in_processes(_compare_in_worker, guarded, max(1, request.jobs), timeout=longest)
        for place, answer in answers:
            pair = pairs[places[place]]
            reason = "the comparison was stopped" if isinstance(answer, WorkerDiedError) else answer
            found[places[place]] = answer if isinstance(answer, ModelDiff) else _make_unknown(pair, str(reason))
    return [found[index] if index in found else _describe_lone(pair) for index, pair in enumerate(pairs)]


def _is_comparable(pair: ModelPair) -> bool:
    return all(model is not None and model.mechanism is not None for model in (pair.before, pair.after))


def _describe_same(pair: ModelPair, old_folder: str, new_folder: str) -> ModelDiff | None:
    """Return the empty difference of two models with equal values, which need no comparison; None for others."""
    first, second = pair.before, pair.after
    before, after = (None if model is None else model.mechanism for model in (first, second))
    if first is None or second is None or before is None or after is None:
        return None
    if before.compute_digest() != after.compute_digest():
        return None
    mass = sum(link.mass or 0.0 for link in before.links)
    same = MechanismDiff(changes=(), notes=(), shifts=(), torques=(), mass=(mass, mass), com_shift=0.0, samples=0)
    return _describe_pair(pair, same, old_folder, new_folder)


def _describe_pair(pair: ModelPair, found: MechanismDiff, old_folder: str, new_folder: str) -> ModelDiff:
    """Return a difference with its causes, its verdict and in words."""
    first, second = pair.before, pair.after
    assert first is not None
    assert second is not None
    before, after = first.mechanism, second.mechanism
    assert before is not None
    assert after is not None
    texts = (
        SideTexts.of_model(before, first.texts, old_folder),
        SideTexts.of_model(after, second.texts, new_folder),
    )
    edited = find_edited_lines(*texts)
    found = replace(found, causes=find_causes(found.changes, edited, *texts))
    idle_edits = list_idle_edits(edited, (before, after), texts)
    is_equal = sorted(before.digests.values()) == sorted(after.digests.values())
    depends = bool(idle_edits) or has_edited_choices(edited, *texts)
    verdict, headline = judge_change(found, has_equal_texts=is_equal, depends_on_arguments=depends)
    return ModelDiff(
        before=first.info.id,
        after=second.info.id,
        verdict=verdict,
        headline=headline,
        mechanism=found,
        texts=tuple(map(describe_change, found.changes)),
        notes=tuple(map(describe_change, found.notes)),
        idle_edits=idle_edits,
        effects=tuple(map(describe_effect, found.effects)),
        matched_by=pair.matched_by,
    )


def _compare_in_worker(
    pair: ModelPair,
    old_folder: str,
    new_folder: str,
    measuring: _Measuring,
    meshes: Sequence[str],
    limits: ResourceLimits,
) -> ModelDiff | str:
    """Compare two models inside a worker process, which opens the meshes alone; a text says why that failed."""
    libraries.prefer_own_folders()
    folders = [] if measuring.cache is None else [str(measuring.cache)]
    sandbox.confine([*meshes, *folders], (), limits.memory)
    try:
        with sandbox.enforce_deadline(limits.seconds):
            return _compare_models(pair, old_folder, new_folder, measuring)
    except ModelTimeout:
        return f"the comparison took more than {limits.seconds:g} s (--timeout)"
    except MemoryError:
        return f"the comparison takes more than {limits.memory} MiB (--memory)"


def _compare_models(pair: ModelPair, old_folder: str, new_folder: str, measuring: _Measuring) -> ModelDiff:
    """Compare two models that were read."""
    from urdfcheck.changes.shape_geometries import ShapeGeometries  # these load numpy
    from urdfcheck.facts.comparison.compare import compare_mechanisms

    first, second = pair.before, pair.after
    assert first is not None
    assert second is not None
    before, after = first.mechanism, second.mechanism
    assert before is not None
    assert after is not None
    geometries = ShapeGeometries(ArrayCache(measuring.cache))
    read = None if measuring.tier == TIERS[0] else geometries.read
    found = compare_mechanisms(before, after, read, with_collisions=measuring.tier == TIERS[-1])
    return _describe_pair(pair, found, old_folder, new_folder)


def _describe_lone(pair: ModelPair) -> ModelDiff:
    """Return the difference of a model that only one version has, or of which one version gives no robot."""
    first, second = pair.before, pair.after
    if first is not None and second is not None:
        unread = [(name, m.problem) for name, m in (("before", first), ("after", second)) if m.mechanism is None]
        if len(unread) == 2 and first.problem == second.problem:
            unread = [("both versions", first.problem)]
        return _make_unknown(pair, "; ".join(f"{name}: {problem}" for name, problem in unread))
    if second is not None and second.mechanism is None:
        return _make_unknown(pair, f"it is new, and {second.problem}")
    return ModelDiff(
        before="" if first is None else first.info.id,
        after="" if second is None else second.info.id,
        verdict="structure",
        headline="the model is new" if first is None else "the model is gone",
        mechanism=None,
        matched_by=pair.matched_by,
    )


def _has_unread_side(pair: ModelPair) -> bool:
    """Whether one of two versions of a model gives no robot."""
    return any(side is not None and side.mechanism is None for side in (pair.before, pair.after))


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


def _compare_seams(
    first: _CheckedVersion,
    second: _CheckedVersion,
    units: Mapping[str, str],
    names: Mapping[str, Mapping[tuple[str, str], str]],
) -> tuple[SeamChange, ...]:
    """Return what differs in the files around the models; what several models share is reported once."""
    olds, news = _list_seams(first), _list_seams(second)
    every = (
        change
        for unit, other in units.items()
        if unit in olds or other in news
        for change in compare_seams(olds.get(unit, ()), news.get(other, ()), names.get(unit, {}))
    )
    return tuple(dict.fromkeys(every))


def _list_seams(side: _CheckedVersion) -> dict[str, tuple[SeamFact, ...]]:
    reports = ((unit.id, side.audited.reports.get(index)) for index, unit in enumerate(side.audited.units))
    return {unit: report.seams for unit, report in reports if report is not None and report.seams}


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
