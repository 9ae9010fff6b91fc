"""One run: plan the units, audit them in worker processes, put the reports together.

The parent process imports the standard library only.
"""

from __future__ import annotations

import contextlib
import functools
import gc
import itertools
import os
import signal
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from urdfcheck.core import NotChecked, Run, SkippedCheck, UrdfcheckError
from urdfcheck.core.errors import ModelTimeout
from urdfcheck.core.records import dataclass
from urdfcheck.policy import baseline
from urdfcheck.policy.baseline import Baseline
from urdfcheck.policy.config import Config
from urdfcheck.policy.policy import Policy, keep_aside
from urdfcheck.rules import find_pages_folder
from urdfcheck.run.assemble_run import build_run
from urdfcheck.run.jobs import AuditSettings, PackageFolders, Request, Unit, UnitReport
from urdfcheck.run.replay.reports import KnownReports, enable_replay
from urdfcheck.run.report_sizes import ReportSizes
from urdfcheck.run.source_texts import SourceTexts
from urdfcheck.run.unit_audit import audit_unit, choose_simulation, list_simulated_rules
from urdfcheck.run.units.included_parts import (
    assign_parts,
    find_read_spares,
    leave_out_blamed_parts,
    list_next_units,
)
from urdfcheck.run.units.outlines import compare_outlines_bounded, have_same_outlines, may_compare_outlines
from urdfcheck.run.units.unchecked import build_stopped_report
from urdfcheck.run.units.variants import (
    format_arguments,
    leave_out_unknown_calls,
    propose_other_environments,
    propose_smaller_variants,
)
from urdfcheck.source.discover import discover_targets
from urdfcheck.source.package.finder import PackageFinder
from urdfcheck.source.plan import Plan
from urdfcheck.source.planning_budget import PlanningBudget
from urdfcheck.source.reach import FileReach
from urdfcheck.system import libraries, sandbox
from urdfcheck.system.array_cache import ArrayCache
from urdfcheck.system.files import overlay_files, read_stamp
from urdfcheck.system.installation import list_own_files
from urdfcheck.system.observing.observations import Observations, observe
from urdfcheck.system.observing.questions import add_observations, is_observing, read_folders, read_variable
from urdfcheck.system.process_pool import SpareWorkers, Worker, WorkerDiedError, WorkerTimeoutError, map_in_processes

# The search for all models may take so many times longer than the check of one, and at least so many seconds: a model takes
# about a millisecond.
PLANNING_TIME_RATIO, MIN_PLANNING_SECONDS = 10, 600.0
# With more paths a process for the search costs little beside it.
_FEW_FILES = 4


@dataclass(frozen=True, slots=True, kw_only=True)
class Execution:
    """How the units of a run are audited, and who follows it."""

    audit: Callable[[Unit, AuditSettings], UnitReport] | None = None
    """Function that audits units in this process, for tests and for embedding; None: worker processes do."""
    warm_worker: Worker | None = None
    """Worker that waits for its first job."""
    spare_workers: SpareWorkers | None = None
    """Workers of earlier runs: for a process that runs many."""
    on_idle: Callable[[], object] | None = None
    """Called once while the first workers are busy."""
    on_progress: Callable[[int, int], object] | None = None
    """Called with the number of finished units and of all, whenever a unit is finished."""

    def without_start(self) -> Execution:
        """Return the execution of what comes after the first units: its worker and its call are used."""
        return replace(self, warm_worker=None, on_idle=None)


@dataclass(frozen=True, slots=True, kw_only=True)
class AuditedRun:
    """A run with what it was made of."""

    request: Request
    plan: Plan
    search: Plan
    """The plan as the search for models returned it."""
    units: Sequence[Unit]
    reports: Mapping[int, UnitReport]
    """By index of the unit."""
    outcome: Run
    disk_state: str
    """Names the files on the disk, as the search for models found them."""


# Numbers the searches for models of this process.
_searches = itertools.count(1)
# What most runs use.
IN_WORKERS = Execution()
# For tests and for embedding: no processes, no limits.
IN_THIS_PROCESS = Execution(audit=audit_unit)


def run(request: Request, execution: Execution = IN_WORKERS) -> Run:
    """Check everything that the request's paths lead to. An interrupt ends the run with what was finished until then."""
    return run_audit(request, execution).outcome


def run_audit(
    request: Request,
    execution: Execution = IN_WORKERS,
    *,
    previous: AuditedRun | None = None,
    only_texts_differ: bool = False,
) -> AuditedRun:
    """Do the same as :func:`run`, for callers that go on with the units and reports.

    ``previous``: a run of the same request apart from its ``texts``; its reports are reused where no text that they depend on
    differs. ``only_texts_differ``: whether the files on the disk are those of that run, as far as is known; then models are not
    searched again where the search would read nothing new.
    """
    start = time.perf_counter()
    if previous is not None and only_texts_differ and _leads_to_same_models(previous, request, execution):
        search, units = previous.search, _build_units(previous.search, request)
        disk_state = previous.disk_state
    else:
        disk_state = f"{os.getpid()} {next(_searches)}"
        search, units = plan_units(
            request,
            in_process=execution.audit is not None,
            spare_workers=execution.spare_workers,
            warm_worker=execution.warm_worker,
        )
    plan = search
    reports = {} if previous is None else _reuse_reports(previous, units, request.options.texts)
    texts, sizes = SourceTexts(), ReportSizes()

    def bound(report: UnitReport, unit: Unit) -> UnitReport:
        add_observations(report.observations)
        return sizes.limit_report(texts.share(replace(report, observations=None), unit.id), unit.id)

    reports = {index: bound(report, units[index]) for index, report in reports.items()}
    with audit_session(request, units, plan, in_process=execution.audit is not None) as session:
        settings = session if request.cache is None else enable_replay(session)
        if previous is not None and request.options.texts:  # others will follow, and what this one observes is not kept
            settings = replace(settings, disk_state=disk_state)
        known = KnownReports(settings)
        while missing := list_next_units(units, reports):
            recalled = {index: report for index in missing if (report := known.recall(units[index])) is not None}
            reports.update((index, bound(report, units[index])) for index, report in recalled.items())
            missing = [index for index in missing if index not in recalled]
            total = len(reports) + len(missing)
            stream = stream_reports(
                [units[index] for index in missing], settings, jobs=request.jobs, execution=execution
            )
            with contextlib.suppress(KeyboardInterrupt), contextlib.closing(stream):
                for place, report in stream:
                    reports[missing[place]] = bound(report, units[missing[place]])
                    if execution.on_progress is not None:
                        execution.on_progress(len(reports), total)
            if any(index not in reports for index in missing):
                break
            execution = execution.without_start()
            if request.all_arguments and not list_next_units(units, reports):
                units += propose_smaller_variants(units, reports)
            elif not request.all_arguments:
                units += propose_other_environments(units, reports)
    spared = find_read_spares(units, reports)
    audited_units = [(u, reports[i]) for i, u in enumerate(units) if i in reports]
    audited_units, unused = assign_parts(audited_units)
    plan = replace(plan, unused=(*plan.unused, *unused))
    audited_units = leave_out_unknown_calls(leave_out_blamed_parts(audited_units))
    outcome = build_run(request, plan, audited_units=audited_units, seconds=time.perf_counter() - start)
    if len(reports) + len(spared) < len(units):
        if execution.on_progress is not None:
            execution.on_progress(len(units), len(units))  # nothing else will be finished
        count = len(units) - len(spared)
        reason = f"interrupted after {len(reports)} of {count} models and files: the rest was not checked"
        outcome = replace(outcome, partial=True, failures=(*outcome.failures, reason))
    outcome = strip_volatile_values(outcome) if read_variable("SOURCE_DATE_EPOCH") is not None else outcome
    return AuditedRun(
        request=request, plan=plan, search=search, units=units, reports=reports, outcome=outcome, disk_state=disk_state
    )


def keep_valid_reports(last: AuditedRun | None, request: Request) -> AuditedRun | None:
    """Return the last run with only the reports whose files on the disk are unchanged, for :func:`run_audit`.

    None where the request differs in more than its texts, and where a file has appeared or disappeared that may matter to any
    unit that looked for it.
    """
    if last is None or _without_texts(last.request) != _without_texts(request):
        return None
    now = functools.cache(read_stamp)
    reports = {
        place: report
        for place, report in last.reports.items()
        if not report.failures and all(now(path) == stamp for path, stamp in report.reads.items())
    }
    stamps = [(stamp, now(path)) for report in last.reports.values() for path, stamp in report.reads.items()]
    if any((before is None) != (after is None) for before, after in stamps):
        return None
    return replace(last, reports=reports)


def _without_texts(request: Request) -> Request:
    return replace(request, options=replace(request.options, texts={}))


def _reuse_reports(previous: AuditedRun, units: Sequence[Unit], texts: Mapping[str, bytes]) -> dict[int, UnitReport]:
    """Return the reports of the units that have not changed, nor any file that was read for them, by index."""
    changed = _list_changed_texts(previous, texts)
    known = {(unit.kind, unit.id): (unit, previous.reports.get(index)) for index, unit in enumerate(previous.units)}
    resolve = functools.cache(os.path.realpath)  # most units read the same files
    reused = {}
    for index, unit in enumerate(units):
        same, report = known.get((unit.kind, unit.id), (None, None))
        if same == unit and report is not None and report.reads and not changed & set(map(resolve, report.reads)):
            reused[index] = report
    return reused


def _list_changed_texts(previous: AuditedRun, texts: Mapping[str, bytes]) -> set[str]:
    """Return the real paths of the texts that differ from those of a run."""
    old_texts = previous.request.options.texts
    return {path for path in (*old_texts, *texts) if old_texts.get(path) != texts.get(path)}


def _leads_to_same_models(previous: AuditedRun, request: Request, execution: Execution) -> bool:
    """Whether the search for models would find what it found for a run of which only texts differ."""
    changes = {
        path: (previous.request.options.texts.get(path), request.options.texts.get(path))
        for path in _list_changed_texts(previous, request.options.texts)
    }
    limits, spare_workers = request.options.limits, execution.spare_workers
    if is_observing() or not may_compare_outlines(request, changes):
        return False
    if execution.audit is not None:
        return have_same_outlines(changes)
    spare = None if spare_workers is None else spare_workers.get_list(limits.memory)
    work = limits.memory, changes
    ((_, answer),) = map_in_processes(
        compare_outlines_bounded, [work], 1, timeout=limits.seconds or None, spare_workers=spare
    )
    return answer is True


def select_single_model(request: Request, plan: Plan, units: Sequence[Unit]) -> Unit:
    """Return the one model that the request's paths lead to.

    :raises UrdfcheckError: if they lead to none, or to several.
    """
    for path, reason in (*plan.missing, *plan.unused):
        raise UrdfcheckError(f"{path}: {reason}")
    models = [unit for unit in units if unit.kind == "model" and not unit.is_part]
    models = models or [unit for unit in units if unit.kind == "model" and unit.is_explicit]
    if len(models) != 1:
        names = f"{len(models)} models; name one of them: {', '.join(m.id for m in models)}" if models else "no model"
        raise UrdfcheckError(f"{', '.join(map(str, request.paths))}: {names}")
    return models[0]


def audit_single_model(request: Request, execution: Execution = IN_WORKERS) -> UnitReport:
    """Return the report on the one model that the request's paths lead to.

    :raises UrdfcheckError: if they lead to none, or to several.
    """
    plan, units = plan_units(request, in_process=execution.audit is not None)
    models = [select_single_model(request, plan, units)]
    with audit_session(request, models, plan) as settings:
        ((_, report),) = stream_reports(models, settings, jobs=1, execution=execution)
    return report


def plan_units(
    request: Request,
    *,
    in_process: bool = False,
    spare_workers: SpareWorkers | None = None,
    warm_worker: Worker | None = None,
) -> tuple[Plan, list[Unit]]:
    """Return what the request's paths lead to, and the units of work in a stable order.

    Files of strangers are read, so it takes place in another process unless ``in_process``: its own, or for a few files, around
    which little is read, that of ``warm_worker``. What the search leaves in memory counts for the audits of a process.

    :raises UrdfcheckError: if that process died or did not end.
    """
    resolver = request.config_resolver
    search: dict[str, Any] = {
        "paths": request.paths,
        "arguments": request.arguments,
        "packages": request.packages.by_name,
        "package_paths": request.packages.search_path,
        "reach": request.reach,
        "find_config": None if resolver is None else resolver.for_path,
        "all_arguments": request.all_arguments,
    }
    texts, limits = request.options.texts, request.options.limits
    if in_process:
        with overlay_files(texts):
            plan = discover_targets(**search)
        return plan, _build_units(plan, request)
    longest = max(PLANNING_TIME_RATIO * limits.seconds, MIN_PLANNING_SECONDS) if limits.seconds else None
    # The search ends by itself in time; it is killed where it hangs.
    killed = longest and longest + limits.seconds + sandbox.PATIENCE
    work = (limits.memory, longest or 0.0, limits.seconds, texts, search)
    spare = None if spare_workers is None else spare_workers.get_list(limits.memory)
    if spare is None and warm_worker is not None and _are_few_files(request.paths):
        spare = [warm_worker]
    ((_, answer),) = map_in_processes(_discover_bounded, [work], 1, timeout=killed, spare_workers=spare)
    if isinstance(answer, WorkerTimeoutError):
        raise UrdfcheckError(f"looking for models took more than {longest:g} s (--timeout)")
    if isinstance(answer, WorkerDiedError):
        raise UrdfcheckError(f"the process that looks for models {_describe_exit(answer.exit_code)}")
    if isinstance(answer, MemoryError):
        raise UrdfcheckError(f"looking for models takes more than {limits.memory} MiB (--memory)")
    plan, observations = answer
    add_observations(observations)
    return plan, _build_units(plan, request)


def _are_few_files(paths: Sequence[Path]) -> bool:
    return len(paths) <= _FEW_FILES and all(map(os.path.isfile, paths))


def _discover_bounded(
    memory: int, seconds: float, seconds_per_file: float, texts: Mapping[str, bytes], search: Mapping[str, Any]
) -> tuple[Plan, Observations] | MemoryError:
    """Do the search of `plan_units` with at most ``memory`` MiB; also return what it depends on.

    ``search``: arguments of `discover_targets`.
    """
    sandbox.limit_memory(memory)
    # A xacro that was expanded is garbage with cycles: ten thousand of them take 3.6 GB if nothing collects it, as in a worker.
    gc.enable()
    try:
        with overlay_files(texts), observe(apart=list_own_files()) as observations:
            plan = discover_targets(**search, budget=PlanningBudget(seconds, seconds_per_file))
    except MemoryError as error:
        return error.with_traceback(None)
    finally:
        gc.disable()
    return plan, observations


@contextlib.contextmanager
def audit_session(
    request: Request, units: Sequence[Unit], plan: Plan, *, in_process: bool = False
) -> Iterator[AuditSettings]:
    """Yield the settings for the audit of these units of a plan; they hold as long as the context.

    ``in_process``: this process audits them; it sees all folders.
    """
    reach = plan.reach or request.reach
    with _open_cache_folder(request, units) as folder:
        yield AuditSettings(
            policy=request.policy,
            options=request.options,
            packages=request.packages,
            cache=folder,
            reach=reach.roots,
            known_packages=plan.known_packages,
            visible_folders=() if in_process else _list_visible_folders(reach, units),
        )


def _list_visible_folders(reach: FileReach, units: Sequence[Unit]) -> tuple[str, ...]:
    """Return the folders that a worker must see: those in reach, those in which packages are searched, and the rules."""
    folders = dict.fromkeys((*reach.roots, str(find_pages_folder())))
    # A launch file may name a model anywhere: what is out of reach makes nothing around it visible.
    files = (Path(path) for u in units if u.kind != "package" for path in (u.path, *u.launches))
    inside = [path.absolute().parent for path in dict.fromkeys(files) if reach.can_open(path)]
    for start in dict.fromkeys((*inside, *(Path(u.path).absolute() for u in units if u.kind == "package"))):
        if not any(os.path.realpath(start).startswith(root + os.sep) for root in folders):
            folders.update(
                dict.fromkeys(os.path.realpath(level) for level in PackageFinder(start).list_parent_folders()[-1:])
            )
    for variable in ("ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH"):
        folders.update(dict.fromkeys(read_folders(variable)))
    return tuple(folders)


@contextlib.contextmanager
def _open_cache_folder(request: Request, units: Sequence[Unit]) -> Iterator[str | None]:
    """Yield the folder of cached results.

    Without a cache, several units share a folder that lasts as long as the run, so that a mesh of two models is read once.
    """
    if request.cache is not None:
        with contextlib.suppress(OSError):  # a worker may write in it, but not create it
            request.cache.mkdir(parents=True, exist_ok=True)
        yield str(request.cache)
        ArrayCache(request.cache).tidy()
    elif len(units) > 1:
        with tempfile.TemporaryDirectory(prefix="urdfcheck-", ignore_cleanup_errors=True) as folder:
            yield folder
    else:
        yield None


def strip_volatile_values(outcome: Run) -> Run:
    """Drop what depends on the machine and the moment (reproducible-builds.org: SOURCE_DATE_EPOCH is set)."""
    return replace(
        outcome,
        models=tuple(replace(model, seconds=0.0) for model in outcome.models),
        seconds=0.0,
        versions={"urdfcheck": outcome.versions["urdfcheck"]},
    )


def make_file_id(path: Path, root: Path) -> str:
    """Return what a file is called in reports and fingerprints: its path from the configuration's folder."""
    try:
        return Path(os.path.relpath(os.path.realpath(path), os.path.realpath(root))).as_posix()
    except ValueError:  # another drive
        return path.as_posix()


def _build_units(plan: Plan, request: Request) -> list[Unit]:
    """Return the units of work of a plan: models, then launch files, then packages.

    Most files have many variants: what holds for all of a file is asked once.
    """

    def find_root(path: Path) -> Path:
        config = plan.configs.get(str(path))
        return request.root if config is None else config.root

    @functools.cache
    def name_file(path: Path) -> str:
        return make_file_id(path, find_root(path))

    given = [path.absolute() for path in request.paths if os.path.isdir(path)]

    @functools.cache
    def is_of_given_whole(folder: Path) -> bool:
        top = _find_whole(folder)
        return top is not None and any(path == top or path in top.parents for path in given)

    units = [
        Unit(
            kind="model",
            path=str(target.path),
            # By the name that the configuration gives to the arguments, or else by these.
            id=name_file(target.path) + format_arguments({"named": target.name} if target.name else target.arguments),
            arguments=dict(target.arguments),
            launches=tuple(map(str, target.launches)),
            is_explicit=target.explicit,
            is_tentative=target.tentative,
            is_part=target.is_part,
            is_spare=target.is_spare,
            is_xacro=target.xacro,
            unknown_arguments=target.unknown,
            varied_arguments=target.varied,
            is_of_given_whole=not target.explicit and is_of_given_whole(target.path.absolute().parent),
        )
        for target in (*plan.models, *plan.candidates)
    ]
    units += [
        Unit(
            kind="launch",
            path=str(path),
            id=name_file(path),
            # Without a model, nothing of the folder is checked whatever the launch file loads.
            is_explicit=not plan.models or path not in plan.swept_launches,
        )
        for path in plan.launches
    ]
    units += [
        Unit(
            kind="package",
            path=str(path),
            id=make_file_id(path / "package.xml", find_root(path)),
            is_explicit=path in plan.whole_packages,
        )
        for path in plan.packages
    ]
    wants = functools.cache(request.wants)
    units = [unit for unit in units if wants(unit.path)]
    find_baseline = _make_baseline_lookup(request)
    resolve = functools.cache(lambda path: _resolve_settings(path, plan.configs.get(path), request))
    counts = Counter(unit.id for unit in units)
    targets = (*plan.models, *plan.candidates)
    aside = {str(target.path): target.is_kept_aside for target in targets if target.is_test_data}
    aside |= dict.fromkeys(map(str, plan.kept_aside), True)
    configured = [
        _apply_config(
            unit,
            plan.configs.get(unit.path),
            request=request,
            find_baseline=find_baseline,
            resolve=resolve,
            is_ambiguous=counts[unit.id] > 1,
        )
        for unit in units
    ]
    return [
        replace(unit, policy=_set_aside(unit.policy or request.policy, is_unused=aside[unit.path]))
        if unit.path in aside
        else unit
        for unit in configured
    ]


def _find_whole(folder: Path) -> Path | None:
    """Return the package around a folder, or else its repository."""
    for mark in ("package.xml", ".git"):
        for around in (folder, *folder.parents):
            if os.path.exists(around / mark):  # pathlib raises where a folder may not be looked into
                return around
    return None


def _set_aside(policy: Policy, *, is_unused: bool) -> Policy:
    """Return the settings for data of tests, or for what is kept and not used."""
    return keep_aside(policy) if is_unused else replace(policy, is_for_tests=True)


# Returns the file and root folder of a baseline that is not the run's own, and the baseline.
_BaselineLookup = Callable[[Config | None], tuple[tuple[str, str] | None, Baseline | None]]


def _make_baseline_lookup(request: Request) -> _BaselineLookup:
    """Return a function that finds the baseline for a configuration: the one that was named, or else its own."""

    @functools.cache
    def read(file: Path, root: Path) -> Baseline | None:
        return baseline.read_found_baseline(file, root)

    def find_baseline(config: Config | None) -> tuple[tuple[str, str] | None, Baseline | None]:
        resolver = request.config_resolver
        if config is None or resolver is None or resolver.overrides.baseline is not None or config.root == request.root:
            return None, request.baseline
        file = config.baseline or config.root / baseline.DEFAULT_NAME
        return (str(file), str(config.root)), None if resolver.isolated else read(file, config.root)

    return find_baseline


def _apply_config(
    unit: Unit,
    config: Config | None,
    *,
    request: Request,
    find_baseline: _BaselineLookup,
    resolve: Callable[[str], Mapping[str, Any]],
    is_ambiguous: bool,
) -> Unit:
    """Return the unit with what its configuration says.

    ``resolve``: returns the settings of a file, see `_resolve_settings`; ``is_ambiguous``: several units have its id.
    """
    name = unit.id
    if is_ambiguous and config is not None and config.root != request.root:
        # Two folders with a configuration each call a model the same.
        name = (Path(os.path.relpath(config.root, request.root)) / name).as_posix()
    home, own_baseline = find_baseline(config)
    # The baseline of the run has the names of a run, and that of a folder those of the folder.
    baseline_name = name if home is None else unit.id
    entries = {} if own_baseline is None else own_baseline.get_entries(baseline_name)
    excesses = {} if own_baseline is None else own_baseline.get_excesses(baseline_name)
    return replace(
        unit,
        id=name,
        baseline_entries=entries,
        baseline_excesses=excesses,
        baseline_home=home,
        baseline_name=baseline_name,
        **resolve(unit.path),
    )


def _resolve_settings(path: str, config: Config | None, request: Request) -> dict[str, Any]:
    """Return what the configuration of a file says, as fields of its units, where that is not what holds for the run."""
    if config is None or request.config_resolver is None:
        return {}
    effective = request.config_resolver.resolve(config, Path(path))
    packages = PackageFolders(
        {**config.packages, **request.packages.by_name}, (*request.packages.search_path, *config.package_path)
    )
    return {
        "policy": None if effective.policy == request.policy else effective.policy,
        "packages": None if packages == request.packages else packages,
        "fail_on": effective.fail_on,
    }


# -- worker processes ------------------------------------------------------------------------------------------------


def stream_reports(
    units: Sequence[Unit], settings: AuditSettings, *, jobs: int, execution: Execution = IN_WORKERS
) -> Generator[tuple[int, UnitReport], None, None]:
    """Audit each unit in a worker process, at most ``jobs`` at a time; yield its index and its report as they come."""
    if execution.audit is not None:
        yield from ((index, execution.audit(unit, settings)) for index, unit in enumerate(units))
        return
    # A package or a launch file takes less time than a process for it.
    at_once = max(1, min(jobs, sum(unit.kind == "model" for unit in units)))
    # The large ones first, so that none of them is left alone at the end.
    order = sorted(range(len(units)), key=lambda index: -_get_file_size(units[index].path))
    work = [(units[index], settings) for index in order]
    limits = settings.options.limits
    longest = limits.seconds + sandbox.PATIENCE if limits.seconds else None
    rights = settings.visible_folders, settings.cache, limits.memory
    spare = None if execution.spare_workers is None else execution.spare_workers.get_list(rights)
    died: dict[int, WorkerDiedError] = {}
    for place, answer in map_in_processes(
        _audit_in_worker,
        work,
        at_once,
        warm_worker=execution.warm_worker,
        spare_workers=spare,
        on_idle=execution.on_idle,
        timeout=longest,
        is_spent=_is_stopped,
    ):
        index = order[place]
        if _may_be_due_to_simulator(units[index], answer, settings):
            died[index] = answer
        else:
            yield index, _report_answer(units[index], answer, settings)
    if died:
        yield from _audit_without_simulator({index: units[index] for index in died}, died, settings, jobs=jobs)


def _may_be_due_to_simulator(unit: Unit, answer: UnitReport | WorkerDiedError, settings: AuditSettings) -> bool:
    """Whether a worker died, in which native code of the simulator ran for a target of the model."""
    is_dead = isinstance(answer, WorkerDiedError) and not isinstance(answer, WorkerTimeoutError)
    return is_dead and choose_simulation(unit.policy or settings.policy, settings.options) == "brief"


def _audit_without_simulator(
    units: Mapping[int, Unit], died: Mapping[int, WorkerDiedError], settings: AuditSettings, *, jobs: int
) -> Iterator[tuple[int, UnitReport]]:
    """Audit units again whose workers died; yield the index of each and its report, which says that it was not dropped.

    Such reports are not kept: the next run tries again.
    """
    settings = replace(settings, options=replace(settings.options, simulate=False), replay_key="")
    for place, report in stream_reports(list(units.values()), settings, jobs=jobs):
        index = list(units)[place]
        unit = units[index]
        reason = f"the process in which MuJoCo simulated the model {_describe_exit(died[index].exit_code)}"
        codes = [code for code in list_simulated_rules() if code in (unit.policy or settings.policy).codes]
        kept = [skip for skip in report.skipped if skip.code not in codes]
        yield index, replace(report, skipped=(*kept, *(SkippedCheck(code, unit.id, reason) for code in codes)))


def _report_answer(unit: Unit, answer: UnitReport | WorkerDiedError, settings: AuditSettings) -> UnitReport:
    """Return the report of a worker, or one about its end."""
    if isinstance(answer, WorkerTimeoutError):
        return build_stopped_report(unit, settings, "killed")
    if isinstance(answer, WorkerDiedError):
        return _build_failed_report(unit, f"the worker for {unit.id} {_describe_exit(answer.exit_code)}")
    return answer


def _build_failed_report(unit: Unit, failure: str) -> UnitReport:
    """Return the report on a unit of which nothing is known, because urdfcheck itself failed."""
    return UnitReport(info=unit.describe_unread(NotChecked(failure)), failures=(failure,))


def _is_stopped(report: UnitReport) -> bool:
    """Whether time or memory ended in the middle of something, an import perhaps, that is half done now."""
    return any(finding.code == "URC906" for finding in report.findings)


def _describe_exit(exit_code: int | None) -> str:
    """Return how a process ended, in words."""
    if exit_code is None:
        return "sent something that is not a report"
    if exit_code >= 0:
        return f"died (exit code {exit_code})"
    try:
        name = signal.Signals(-exit_code).name
    except ValueError:
        name = f"signal {-exit_code}"
    hint = "; the system may have been out of memory" if name == "SIGKILL" else ""
    return f"was killed ({name}{hint})"


def _get_file_size(path: str) -> int:
    try:
        return os.stat(path).st_size
    except OSError:
        return 0


def _audit_in_worker(unit: Unit, settings: AuditSettings) -> UnitReport:
    """Audit a unit inside a worker process, with its rights and limits."""
    limits = settings.options.limits
    libraries.prefer_own_folders()
    sandbox.confine(settings.visible_folders, [settings.cache] if settings.cache else [], limits.memory)
    try:
        with sandbox.enforce_deadline(limits.seconds):
            return audit_unit(unit, settings)
    except ModelTimeout:  # for the second time: while the first was being handled
        return build_stopped_report(unit, settings, "time")
    except Exception as error:  # ours, not the model's: reading and checking turn what is wrong there into findings
        return _build_failed_report(unit, f"the audit of {unit.id} crashed: {type(error).__name__}: {error}")
