"""The process that checks for the language server: it runs one job after the other until its standard input ends.

It has no threads, so that its workers can be forked; it has loaded what an audit needs, so that they need not; and it keeps the
last run of each project, so that only what a change concerns is audited again. An interrupt (SIGINT) ends the job.
"""

from __future__ import annotations

import contextlib
import gc
import importlib
import multiprocessing
import os
import pickle
import pkgutil
import select
import signal
import sys
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from types import FrameType
from typing import BinaryIO

from urdfcheck.api import ask_engines
from urdfcheck.core import Run
from urdfcheck.core.errors import UrdfcheckError
from urdfcheck.fix.fixer import compute_fixes
from urdfcheck.output import html
from urdfcheck.policy.policy import TIERS
from urdfcheck.rules import load_rules
from urdfcheck.run.jobs import Request
from urdfcheck.run.pipeline import AuditedRun, Execution, keep_valid_reports, run_audit
from urdfcheck.run.preload import preload_modules
from urdfcheck.run.request import RunOptions, find_baseline_file, make_request
from urdfcheck.server.check_messages import HEADER, BaselinePlace, CheckAnswer, CheckJob, ProjectAnswer, RenameWish
from urdfcheck.server.names.checked_rename import compute_rename
from urdfcheck.server.names.rename_plan import RenameRefusedError
from urdfcheck.source.project_folders import find_project_folder
from urdfcheck.system import libraries
from urdfcheck.system.files import overlay_files
from urdfcheck.system.process_pool import SpareWorkers, end_with_parent, limit_threads

# What workers import when they first need it; here once, for all of them.
_PACKAGES = ("checks", "export", "facts", "model", "source")
_LIBRARIES = ("xacro", "yaml", "urdfcheck.source.xacro.expand", "trimesh", "scipy.spatial", "pinocchio", "coal")
# What the rules of the source tier need.
_SOURCE_NEEDS = frozenset({"source", "package"})
# Jobs after which the workers are replaced, as nobody knows how their memory grows, and the most kinds of them.
_MOST_JOBS, _MOST_WORKERS = 100, 6
# Runs of projects that are kept to reuse their reports.
_MOST_KEPT = 8


def serve_checks(options: RunOptions, parent: int) -> None:
    """Answer jobs until standard input ends. ``options``: those of the command; ``parent``: the process id of the server."""
    end_with_parent(parent)
    os.chdir(os.sep)  # it was started in the folder of Python's modules, which stay in the path
    # Nothing else may write to the channel.
    channel = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    process = _CheckProcess(options)
    signal.signal(signal.SIGINT, process.interrupt)
    channel.write(HEADER.pack(0))  # it can be interrupted now
    channel.flush()
    limit_threads()  # before numpy is loaded, which starts threads
    libraries.prefer_own_folders()
    preload_modules()
    for job in _iter_jobs(sys.stdin.buffer):
        data = pickle.dumps(process.run_job(job))
        channel.write(HEADER.pack(len(data)) + data)
        channel.flush()


def _iter_jobs(stream: BinaryIO) -> Iterator[CheckJob]:
    """Yield the jobs. Before each, as long as there is none, load what the audits of most models need."""
    modules = _iter_modules()
    while True:
        for name in modules:
            with contextlib.suppress(ImportError):  # some libraries are not everywhere
                importlib.import_module(name)
            if _has_data(stream):
                break
        else:
            gc.collect()
            gc.freeze()
        header = stream.read(HEADER.size)
        if len(header) < HEADER.size:
            return
        job: CheckJob = pickle.loads(stream.read(HEADER.unpack(header)[0]))
        yield job


def _iter_modules() -> Iterator[str]:
    yield from _LIBRARIES
    for package in _PACKAGES:
        folder = importlib.import_module(f"urdfcheck.{package}")
        yield from (module.name for module in pkgutil.walk_packages(folder.__path__, f"{folder.__name__}."))


def _has_data(stream: BinaryIO) -> bool:
    if sys.platform == "win32":  # where it is not known, the rest is loaded at once
        return False
    return bool(select.select([stream], [], [], 0)[0])


class _CheckProcess:
    """Runs jobs, and remembers the last run of each project and tier."""

    def __init__(self, options: RunOptions) -> None:
        self.options = options
        self.kept: dict[tuple[str, str | None], AuditedRun] = {}
        self.is_busy = False
        self.jobs = 0
        self.spare_workers = SpareWorkers()

    def interrupt(self, _signal: int, _frame: FrameType | None) -> None:
        """End the current job; between jobs, an interrupt comes too late."""
        if self.is_busy:
            self.is_busy = False  # one is enough
            raise KeyboardInterrupt

    def run_job(self, job: CheckJob) -> CheckAnswer:
        """Return the outcome of a job."""
        try:
            self.is_busy = True
            os.chdir(job.folder)
            if job.forgets:
                self.kept.clear()
            self.jobs += 1
            if self.jobs % _MOST_JOBS == 0 or len(self.spare_workers) > _MOST_WORKERS:
                self.spare_workers.end()
            answer = self._answer(job)
            self.is_busy = False
            return answer
        except KeyboardInterrupt:
            self.spare_workers.end()
            for child in multiprocessing.active_children():
                child.kill()
            return CheckAnswer(number=job.number, is_cancelled=True)

    def _answer(self, job: CheckJob) -> CheckAnswer:
        if job.rename is not None:
            return self._rename(job, job.rename)
        if job.fixes:
            return self._find_fixes(job)
        return self._render_report(job) if job.report else self._check_projects(job)

    def _check_projects(self, job: CheckJob) -> CheckAnswer:
        projects = []
        for folder, paths in _group_by_project(job.paths).items():
            try:
                projects.append(self._check_project(folder, paths, job))
            except UrdfcheckError as error:  # of its configuration
                projects.append(ProjectAnswer(folder=folder, failures=(str(error),)))
        deep = frozenset(code for code, rule in load_rules().items() if not _SOURCE_NEEDS.issuperset(rule.needs))
        return CheckAnswer(number=job.number, projects=tuple(projects), deep_codes=deep)

    def _check_project(self, folder: str, paths: tuple[str, ...], job: CheckJob) -> ProjectAnswer:
        with overlay_files(job.texts):  # a baseline may be open too
            request = self._make_request(paths, job, tier=job.tier)
            last = keep_valid_reports(self.kept.pop((folder, job.tier), None), request)
            execution = Execution(spare_workers=self.spare_workers)
            audited = run_audit(request, execution, previous=last, only_texts_differ=job.only_texts_differ)
        outcome = audited.outcome
        if outcome.partial:
            raise KeyboardInterrupt
        if job.tier is None:
            outcome = ask_engines(audited)
        self.kept[folder, job.tier] = audited
        for oldest in list(self.kept)[:-_MOST_KEPT]:
            del self.kept[oldest]
        return ProjectAnswer(
            folder=folder,
            findings=tuple(outcome.active_findings),
            sources=outcome.sources,
            failures=outcome.failures,
            model_paths={model.id: model.path for model in outcome.models},
            baselines=dict(self._iter_baselines(request, outcome)),
            indexes=tuple(report.index for report in audited.reports.values() if report.index is not None),
        )

    def _iter_baselines(self, request: Request, outcome: Run) -> Iterator[tuple[str, BaselinePlace]]:
        """Yield for each model the baseline that accepts its findings; none where baselines are ignored."""
        if request.config_resolver is None or (self.options.isolated and self.options.baseline is None):
            return
        settings = request.config_resolver.for_path(request.paths[0])
        own = str(find_baseline_file(self.options, settings)), str(settings.root)
        for home, names in outcome.baseline_unit_names.items():
            file, root = own if home is None else home
            for unit, name in names.items():
                yield unit, BaselinePlace(file=os.path.abspath(file), root=os.path.abspath(root), model=name)

    def _find_fixes(self, job: CheckJob) -> CheckAnswer:
        changes: dict[str, tuple[bytes, bytes]] = {}
        fixed = 0
        for paths in _group_by_project(job.paths).values():
            with contextlib.suppress(UrdfcheckError):  # of its configuration, which every check reports
                # The editor writes the files, or not: they may be read-only on the disk.
                found = compute_fixes(self._make_request(paths, job, tier=None), are_only_shown=True)
                if found.outcome.partial:
                    raise KeyboardInterrupt
                # What counts as "before" is the text of the editor.
                changes.update(found.changes)
                fixed += len(found.fixed)
        return CheckAnswer(number=job.number, changes=changes, fixed=fixed)

    def _rename(self, job: CheckJob, wish: RenameWish) -> CheckAnswer:
        def audit(paths: tuple[str, ...], texts: Mapping[str, bytes], previous: AuditedRun | None) -> AuditedRun:
            request = self._make_request(paths, job, tier=TIERS[0])
            options = replace(request.options, texts=texts, index=True, expansion=True)
            request = replace(request, options=options)
            audited = run_audit(request, Execution(spare_workers=self.spare_workers), previous=previous)
            if audited.outcome.partial:
                raise KeyboardInterrupt
            return audited

        try:
            plan = compute_rename(wish, job.texts, audit)
            return CheckAnswer(number=job.number, edits=plan.edits, doubtful=plan.doubtful, untried=plan.untried)
        except RenameRefusedError as refusal:
            return CheckAnswer(number=job.number, refusal=str(refusal))
        except UrdfcheckError as error:  # of the configuration
            return CheckAnswer(number=job.number, refusal=f"The name is not changed: {error}.")

    def _render_report(self, job: CheckJob) -> CheckAnswer:
        try:
            request = self._make_request(job.paths, job, tier=None, scene=True)
        except UrdfcheckError as error:  # of its configuration
            return CheckAnswer(number=job.number, failure=str(error))
        audited = run_audit(request, Execution(spare_workers=self.spare_workers))
        if audited.outcome.partial:
            raise KeyboardInterrupt
        return CheckAnswer(number=job.number, report=html.render(ask_engines(audited)).encode())

    def _make_request(self, paths: tuple[str, ...], job: CheckJob, *, tier: str | None, scene: bool = False) -> Request:
        request, _ = make_request(replace(self.options, paths=paths, tier=tier or self.options.tier), scene=scene)
        return replace(request, options=replace(request.options, texts=job.texts, index=job.index))


def _group_by_project(paths: tuple[str, ...]) -> Mapping[str, tuple[str, ...]]:
    """Return the paths by the folder that each belongs to: one project's configuration and reach say nothing about another."""
    groups: dict[str, tuple[str, ...]] = {}
    for path in paths:
        folder = str(find_project_folder(Path(path)))
        groups[folder] = (*groups.get(folder, ()), path)
    return groups
