"""The repair of a model: a copy, the safe edits, then one stage after the other.

After each stage the copy is checked again; what makes anything worse is withdrawn.
"""

from __future__ import annotations

import os
import re
import shutil
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from urdfcheck.core import Applicability, Finding, ModelInfo, Run, Severity, UrdfcheckError
from urdfcheck.core.errors import ModelNotCheckedError, ModelTimeout
from urdfcheck.core.findings import iter_occurrences
from urdfcheck.core.records import dataclass
from urdfcheck.fix.fixer import compute_fixes, iter_fixable, select_disjoint
from urdfcheck.fix.patch import EditableFiles, EditableText, EditRefusedError, write_files
from urdfcheck.fix.repair.copy_sources import CopiedModel, copy_model, ensure_target
from urdfcheck.fix.repair.steps import STAGES, RepairOptions, RepairStep
from urdfcheck.run import pipeline
from urdfcheck.run.jobs import AuditSettings, PackageFolders, Request, Unit
from urdfcheck.source.reach import is_below
from urdfcheck.system import installation, libraries, sandbox
from urdfcheck.system.process_pool import WorkerDiedError, WorkerTimeoutError, map_in_processes

# How often the elements that a stage makes worse are left out before it is left out whole.
_ATTEMPTS = 4
# Findings that an inertial from geometry repairs: those about mass alone, or about a choice of frame, it does not.
_REPAIRED_INERTIALS = frozenset(f"INR{number:03}" for number in (1, 2, 3, 4, 5, 6, 7, 8, 9, 12, 18))
# The rule about the scale of whole meshes.
_WRONG_SCALE = "MSH008"
_UNCERTAIN_SIZES = frozenset({(_WRONG_SCALE, "large"), (_WRONG_SCALE, "small")})
_LINK = re.compile(r"^link\[(.*?)\](?:/|$)")


@dataclass(frozen=True, slots=True, kw_only=True)
class RepairResult:
    """What a repair did."""

    model: Path
    """The repaired copy."""
    info: ModelInfo
    requests: tuple[Request, Request]
    """For the model itself, and for its copy."""
    before: Run
    """The check of the copy before anything was repaired."""
    after: Run
    """The check of the repaired copy."""
    steps: tuple[RepairStep, ...]
    """Everything that was done or left, in order."""
    fixed: tuple[Finding, ...]
    """Findings whose safe edit was made."""
    files: int
    """Number of copied files."""


def repair_model(
    request: Request, folder: Path, options: RepairOptions, *, include_unsafe: bool = False
) -> RepairResult:
    """Write a repaired copy of the one model that the request leads to into a new or empty folder.

    The folder is emptied again when that fails.

    :raises UrdfcheckError: if there is no such model, or it cannot be copied; `ModelNotCheckedError` if it cannot be read.
    """
    request, unit = _focus_request(request)
    ensure_target(folder, Path(unit.path))
    audited = pipeline.run_audit(request)
    if audited.outcome.partial:
        raise KeyboardInterrupt
    if not audited.outcome.models or audited.outcome.models[0].status != "checked":
        raise ModelNotCheckedError(
            f"{unit.id}: it cannot be read, so nothing is repaired (urdfcheck check reports why)"
        )
    reads = [path for report in audited.reports.values() for path in report.reads]
    existed = os.path.isdir(folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        copied = copy_model(Path(unit.path), reads, folder, request.packages)
        return _repair_copy(request, copied, options, include_unsafe)
    except OSError as error:
        _empty_folder(folder, keep=existed)
        raise UrdfcheckError(f"cannot write to {folder}: {error.strerror or error}") from None
    except BaseException:
        _empty_folder(folder, keep=existed)
        raise


def _repair_copy(original: Request, copied: CopiedModel, options: RepairOptions, include_unsafe: bool) -> RepairResult:
    request = _move_request(original, copied)
    before = pipeline.run(request)  # not of the model itself: rules that look around it may see more there
    fixes = compute_fixes(request, include_unsafe=include_unsafe)
    write_files(fixes.changes)
    steps: list[RepairStep] = []
    current = pipeline.run(request) if fixes.changes else fixes.outcome
    if not current.models or current.models[0].status != "checked":
        raise UrdfcheckError(f"the copy cannot be read: {_explain_unread(current)}")
    tried: frozenset[str] = frozenset()
    for stage in (*STAGES, STAGES[-1]):  # links of which only their twins were reported come in the second round
        bad_links = _list_bad_links(current) - tried
        if stage in {step.stage for step in steps} and (options.inertia == "all" or not bad_links):
            continue
        tried |= bad_links if stage == "inertia" else frozenset()
        planned = _plan_stage(request, stage, options, bad_links)
        if stage == "meshes" and options.meshes != "none":
            planned = (*planned, *_iter_scale_steps(current))
        planned = tuple(_spare_wrong_scale(step, current) for step in planned)
        done, current = _apply_stage(request, copied, planned, current)
        steps += done
    return RepairResult(
        model=copied.model,
        info=current.models[0],
        requests=(original, request),
        before=before,
        after=current,
        steps=tuple(steps),
        fixed=fixes.fixed,
        files=copied.files,
    )


def _explain_unread(run: Run) -> str:
    worst = max(run.active_findings, key=lambda finding: finding.severity, default=None)
    return "; ".join(run.failures) or ("no model was found" if worst is None else worst.message)


def _focus_request(request: Request) -> tuple[Request, Unit]:
    """Return the request for the one model alone, with its own settings.

    :raises UrdfcheckError: if there is not exactly one.
    """
    plan, units = pipeline.plan_units(request)
    unit = pipeline.select_single_model(request, plan, units)
    alone = replace(
        request,
        paths=(Path(unit.path),),
        arguments=unit.arguments,
        policy=unit.policy or request.policy,
        packages=unit.packages or request.packages,
        config_resolver=None,
        baseline=None,
    )
    return alone, unit


def _move_request(request: Request, copied: CopiedModel) -> Request:
    """Return the request for the copy: packages that were copied are found there."""
    named = {**request.packages.by_name, **copied.packages}
    return replace(
        request,
        paths=(copied.model,),
        root=copied.folder,
        packages=PackageFolders(named, (copied.folder, *request.packages.search_path)),
        allowed=(*request.allowed, copied.folder),
    )


def _list_bad_links(run: Run) -> frozenset[str]:
    """Return the links with a finding about their inertial that is more than a note."""
    return frozenset(
        name
        for finding in iter_occurrences(run.findings)
        if finding.code in _REPAIRED_INERTIALS and finding.severity > Severity.INFO and finding.suppressed is None
        for name in _iter_links(finding)
    )


def _iter_links(finding: Finding) -> Iterator[str]:
    return (match[1] for subject in finding.subjects if (match := _LINK.match(subject)))


def _iter_scale_steps(run: Run) -> Iterator[RepairStep]:
    """Yield the edits of the scale of meshes that were never converted to metres, or were converted twice."""
    for finding, fix in iter_fixable(run, {Applicability.UNSAFE, Applicability.SAFE}):
        if finding.code == _WRONG_SCALE and finding.severity > Severity.INFO:
            yield RepairStep(
                stage="meshes",
                subject=next(_iter_links(finding), finding.subjects[0]),
                text=finding.headline or finding.message,
                edits=fix.edits,
            )


def _spare_wrong_scale(step: RepairStep, run: Run) -> RepairStep:
    """Leave out a link whose mesh has a scale that nobody has corrected: a box of 300 m would hide that."""
    wrong = (f for f in iter_occurrences(run.findings) if (f.code, f.message_id) in _UNCERTAIN_SIZES)
    if step.stage == "meshes" or not any(step.subject in _iter_links(finding) for finding in wrong):
        return step
    text = f"kept: the scale of its mesh is wrong ({_WRONG_SCALE})"
    return replace(step, is_done=False, text=text, edits=(), files={}, after={})


# -- one stage --------------------------------------------------------------------------------------------------------


def _plan_stage(
    request: Request, stage: str, options: RepairOptions, bad_links: frozenset[str]
) -> tuple[RepairStep, ...]:
    """Plan a stage in a worker process, which writes nothing.

    :raises UrdfcheckError: if it fails.
    """
    plan, units = pipeline.plan_units(request)
    unit = next(unit for unit in units if unit.kind == "model")
    limits = request.options.limits
    timeout = limits.seconds + sandbox.PATIENCE if limits.seconds else None
    with pipeline.audit_session(request, [unit], plan) as settings:
        ((_, steps),) = map_in_processes(
            _plan_in_worker, [(unit, settings, stage, options, bad_links)], 1, timeout=timeout
        )
    if isinstance(steps, WorkerTimeoutError):
        raise UrdfcheckError(f"planning the stage {stage} took more than {limits.seconds:g} s (--timeout)")
    if isinstance(steps, WorkerDiedError):
        raise UrdfcheckError(f"the process that plans the stage {stage} ended without an answer (--memory)")
    if isinstance(steps, str):
        raise UrdfcheckError(steps)
    return tuple(steps)


def _plan_in_worker(
    unit: Unit, settings: AuditSettings, stage: str, options: RepairOptions, bad_links: frozenset[str]
) -> tuple[RepairStep, ...] | str:
    """Read the model and plan a stage; a text says why that is impossible."""
    libraries.prefer_own_folders()
    _import_libraries(stage, options)
    cache = settings.cache
    limits = settings.options.limits
    sandbox.confine(settings.visible_folders, [cache] if cache else [], limits.memory)
    from urdfcheck.fix.repair.plan_collisions import plan_collisions
    from urdfcheck.fix.repair.plan_inertials import plan_inertials
    from urdfcheck.fix.repair.plan_meshes import plan_meshes

    try:
        with sandbox.enforce_deadline(limits.seconds):
            model = _load_model(unit, settings)
            if model is None:
                return f"{unit.id}: the copy cannot be read"
            if stage == "meshes":
                return tuple(plan_meshes(model, options))
            if stage == "collision":
                return tuple(plan_collisions(model, options, seconds=limits.seconds))
            return tuple(plan_inertials(model, options, bad_links))
    except ModelTimeout:
        return f"planning the stage {stage} took more than {limits.seconds:g} s (--timeout)"
    except UrdfcheckError as error:
        return str(error)
    except ImportError as error:
        missing = installation.describe_left_out(error)
        if missing is None:
            raise
        return f"the stage {stage} cannot be planned: {missing}"
    except MemoryError:
        return f"planning the stage {stage} takes more than {limits.memory} MiB (--memory)"


def _import_libraries(stage: str, options: RepairOptions) -> None:
    """Import what a stage needs before the process is confined: native libraries open files."""
    import contextlib
    import importlib

    wanted = {"convex": ("coacd", "fast_simplification"), "decimate": ("fast_simplification",)}
    for name in ("trimesh", "scipy.spatial", *(wanted.get(options.collision, ()) if stage == "collision" else ())):
        with contextlib.suppress(ImportError):  # whoever uses it says what to install
            importlib.import_module(name)


def _load_model(unit: Unit, settings: AuditSettings) -> Any:
    from urdfcheck.model import Model
    from urdfcheck.source.load import load_source
    from urdfcheck.source.package.finder import PackageFinder
    from urdfcheck.source.reach import FileReach
    from urdfcheck.system.array_cache import ArrayCache

    path = Path(unit.path)
    reach = None if settings.reach is None else FileReach(settings.reach)
    known = {name: list(folders) for name, folders in settings.known_packages.items()}
    packages = settings.packages
    finder = PackageFinder(path.absolute(), packages.by_name, packages.search_path, reach=reach, known=known)
    environment = frozenset(settings.options.environment)
    source = load_source(path, unit.arguments, finder, xacro=unit.is_xacro, environment=environment)
    if source.root is None or source.root.tag != "robot":
        return None
    cache = ArrayCache(Path(settings.cache) if settings.cache else None)
    return Model(source=source, robot=source.root, tier="mesh", cache=cache)


def _apply_stage(
    request: Request, copied: CopiedModel, planned: Sequence[RepairStep], before: Run
) -> tuple[list[RepairStep], Run]:
    """Make the steps of a stage and check again; steps about links with new findings are left out."""
    steps = [step for step in planned if step.is_done]
    left = [step for step in planned if not step.is_done]
    current = before
    for attempt in range(_ATTEMPTS + 1):
        if not steps:
            break
        written = _write_steps(request, copied, steps)
        current = pipeline.run(request)
        if current.partial:
            raise KeyboardInterrupt
        worse = list(_iter_new_findings(before, current, steps)) or list(_iter_remaining(before, current, steps))
        if not worse:
            break
        _restore_files(written)
        current = before
        blamed = {name for finding in worse for name in _iter_links(finding)}
        # A text that makes several links is one edit: its steps stay or go together.
        groups = _group_steps(steps)
        kept = [group for group in groups if not blamed & {step.subject for step in group}]
        if attempt == _ATTEMPTS or len(kept) == len(groups):
            kept = []
        stay = {id(step) for group in kept for step in group}
        left += [_withdraw_step(step, worse) for step in steps if id(step) not in stay]
        steps = [step for group in kept for step in group]
    return [*steps, *left], current


def _iter_remaining(before: Run, after: Run, steps: Sequence[RepairStep]) -> Iterator[Finding]:
    """Yield findings about inertials that remain although the inertials are new: then these repair nothing."""
    renewed = {step.subject for step in steps if step.stage == "inertia"} & _list_bad_links(before)
    if renewed & _list_bad_links(after):
        about = (f for f in iter_occurrences(after.findings) if f.code in _REPAIRED_INERTIALS)
        yield from (f for f in about if f.severity > Severity.INFO and renewed.intersection(_iter_links(f)))


def _withdraw_step(step: RepairStep, worse: Sequence[Finding]) -> RepairStep:
    """Return the step undone, with the finding about its link that it leaves or brings, or else the first."""
    finding = next((finding for finding in worse if step.subject in _iter_links(finding)), worse[0])
    reason = f"withdrawn: with it the model has {finding.code} ({finding.headline or finding.message})"
    text = f"{step.text}; {reason}"
    return replace(step, is_done=False, is_withdrawn=True, text=text, edits=(), files={}, after={})


def _group_steps(steps: Sequence[RepairStep]) -> list[list[RepairStep]]:
    """Group each step that has no edit of its own with the one before, whose edit makes it."""
    groups: list[list[RepairStep]] = []
    for step in steps:
        if groups and not step.edits and step.stage != "meshes":
            groups[-1].append(step)
        else:
            groups.append([step])
    return groups


def _iter_new_findings(before: Run, after: Run, steps: Sequence[RepairStep]) -> Iterator[Finding]:
    """Yield findings, notes aside, that were not there before.

    An inertial that no step has changed had its finding before too, which that of a twin may have hidden.
    """
    known = Counter(_iter_keys(before.findings))
    changed = {step.subject for step in steps}
    is_about_inertials = any(step.stage == "inertia" for step in steps)
    for finding in iter_occurrences(after.findings):
        if is_about_inertials and finding.code in _REPAIRED_INERTIALS and changed.isdisjoint(_iter_links(finding)):
            continue
        if finding.suppressed is None and finding.severity > Severity.INFO:
            keys = Counter(_iter_keys([finding]))
            if any(count > known[key] for key, count in keys.items()):
                yield finding


def _iter_keys(findings: Iterable[Finding]) -> Iterator[tuple[str, str]]:
    """Yield code and link (or other subject) of each finding: one that is shared by fewer links may have another message."""
    for finding in iter_occurrences(findings):
        if finding.suppressed is None and finding.severity > Severity.INFO:
            for subject in finding.subjects:
                link = _LINK.match(subject)
                yield finding.code, subject if link is None else link[1]


def _write_steps(request: Request, copied: CopiedModel, steps: Sequence[RepairStep]) -> dict[str, bytes | None]:
    """Write the files and edits of steps; return the former content of each file, None for a new one.

    :raises UrdfcheckError: if a step names a file outside the copy, or an edit is refused.
    """
    former: dict[str, bytes | None] = {}
    root = os.path.realpath(copied.folder)
    try:
        for step in steps:
            for name, content in step.files.items():
                real = os.path.realpath(name)
                if not is_below(real, root):
                    raise UrdfcheckError(f"{name} is outside the copy: it is not written")
                former.setdefault(real, Path(real).read_bytes() if os.path.isfile(real) else None)
                Path(real).write_bytes(content)
        for path, (old, new) in _apply_edits(request, copied, steps).items():
            former.setdefault(path, old)
            write_files({path: (old, new)})
    except BaseException:
        _restore_files(former)
        raise
    return former


def _apply_edits(
    request: Request, copied: CopiedModel, steps: Sequence[RepairStep]
) -> Mapping[str, tuple[bytes, bytes]]:
    editable = EditableFiles((copied.folder,), request.packages.all_folders)
    texts: dict[str, EditableText] = {}
    edits: dict[str, list[Any]] = {}
    for step in select_disjoint([step for step in steps if step.edits]):
        for edit in step.edits:
            try:
                text = texts.get(edit.span.file) or EditableText.read(edit.span.file, editable, {})
                text.ensure_applicable(edit)
            except EditRefusedError as reason:
                raise UrdfcheckError(f"{edit.span.file}: {reason}") from None
            texts[edit.span.file] = text
            edits.setdefault(edit.span.file, []).append(edit)
    return {texts[name].path: (texts[name].data, texts[name].apply_edits(some)) for name, some in edits.items()}


def _restore_files(former: Mapping[str, bytes | None]) -> None:
    for path, content in former.items():
        if content is None:
            os.unlink(path)
        else:
            Path(path).write_bytes(content)


def _empty_folder(folder: Path, *, keep: bool) -> None:
    """Remove a folder that was written, or only what is in it."""
    for entry in list(folder.iterdir()) if folder.is_dir() else ():
        if entry.is_dir() and not entry.is_symlink():
            shutil.rmtree(entry, ignore_errors=True)
        else:
            entry.unlink(missing_ok=True)
    if not keep and folder.is_dir():
        folder.rmdir()
