"""One run: plan the units, audit them in worker processes, put the reports together.

The parent process imports the standard library only.
"""

from __future__ import annotations

import contextlib
import functools
import os
import signal
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from urdfcheck import rules as catalogue
from urdfcheck.core import Run, UrdfcheckError
from urdfcheck.core.errors import ModelTimeout
from urdfcheck.policy.limits import ResourceLimits
from urdfcheck.run.variants import smaller, words
from urdfcheck.source.discover import Plan, discover_targets
from urdfcheck.source.package.finder import PackageFinder, format_path
from urdfcheck.source.reach import FileReach
from urdfcheck.system import libraries, sandbox
from urdfcheck.system.files import overlay_files
from urdfcheck.system.process_pool import Worker, WorkerDiedError, WorkerTimeoutError, map_in_processes

if TYPE_CHECKING:
    from urdfcheck.policy.baseline import Baseline
    from urdfcheck.policy.config import Config, Configurations
    from urdfcheck.policy.suppression import Entry
    from urdfcheck.run.audit import Report, Settings, Unit

# Configurations of the joints that are looked at, and with --thorough.
SAMPLES, THOROUGH = 200, 5_000
# How many times longer than the check of one model the search for all of them may take, and how many seconds at least: a
# model takes about a millisecond.
PLANNING, LEAST_PLANNING = 10, 600.0


@dataclass(frozen=True, slots=True)
class Request:
    """What a run is asked to do. ``root`` is the configuration's folder: models are named relative to it. ``cache``: the
    folder of results that are kept, None to keep nothing; ``samples``: in how many configurations motion is looked at;
    ``pairs``: whether the reports judge all pairs of links for an SRDF; ``drop``: whether the models are let go on a plane.
    ``allowed``: folders below which files may be opened beside those that the paths and packages are in; ``environment``: the
    variables that a xacro may read beside those of ROS.
    ``baseline``, ``suppress``: what is known; ``comments``: whether comments in the source may say so as well. ``texts``: see
    :func:`urdfcheck.system.files.overlay_files`. ``configured`` finds the configuration for each file, which decides about the rules and
    where packages are; ``packages`` and ``package_paths`` are then the command line's. Without it what stands here holds for all.
    ``all_arguments``: see :func:`urdfcheck.source.discover.discover_targets`."""

    paths: tuple[Path, ...]
    root: Path
    codes: frozenset[str]
    tier: str = "full"
    jobs: int = 1
    arguments: Mapping[str, str] = field(default_factory=dict)
    packages: Mapping[str, Path] = field(default_factory=dict)
    package_paths: tuple[Path, ...] = ()
    options: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    severities: Mapping[str, str] = field(default_factory=dict)
    targets: tuple[str, ...] = ()
    scene: bool = False
    cache: Path | None = None
    samples: int = SAMPLES
    pairs: bool = False
    drop: bool = False
    allowed: tuple[Path, ...] = ()
    environment: tuple[str, ...] = ()
    limits: ResourceLimits = field(default_factory=ResourceLimits)
    baseline: Baseline | None = None
    suppress: tuple[Entry, ...] = ()
    comments: bool = True
    texts: Mapping[str, bytes] = field(default_factory=dict)
    configured: Configurations | None = None
    all_arguments: bool = False

    @property
    def reach(self) -> FileReach:
        """What may be opened."""
        return FileReach.from_paths(self.paths, (*self.packages.values(), *self.package_paths, *self.allowed))


@dataclass(frozen=True, slots=True)
class Audited:
    """A run with what it was made of. ``reports``: by the places of their units."""

    request: Request
    units: Sequence[Unit]
    reports: Mapping[int, Report]
    outcome: Run


def run(
    request: Request,
    audit: Callable[[Unit, Settings], Report] | None = None,
    first: Worker | None = None,
    meanwhile: Callable[[], object] | None = None,
    progress: Callable[[int, int], object] | None = None,
) -> Run:
    """Check everything that the request's paths mean.

    ``audit`` replaces the worker processes by a function in this one (for tests and for embedding). ``first``: a worker
    that waits already; ``meanwhile`` is called once while the first workers are busy, ``progress`` whenever a model or file
    has been checked, with their number and how many there are. An interrupt ends the run with what was finished until then.
    """
    return audited(request, audit, first, meanwhile, progress).outcome


def audited(
    request: Request,
    audit: Callable[[Unit, Settings], Report] | None = None,
    first: Worker | None = None,
    meanwhile: Callable[[], object] | None = None,
    progress: Callable[[int, int], object] | None = None,
    before: Audited | None = None,
) -> Audited:
    """As :func:`run`, for who goes on with it. ``before``: a run of the same request but for its ``texts``, whose reports hold
    where they rest on no text that differs."""
    began = time.perf_counter()
    found, units = planned(request, here=audit is not None)
    reports = {} if before is None else _still_true(before, units, request.texts)
    with auditing(request, units, found.reach or request.reach) as settings:
        while left := [index for index in range(len(units)) if index not in reports]:
            done = stream([units[index] for index in left], settings, request.jobs, audit, first, meanwhile)
            with contextlib.suppress(KeyboardInterrupt), contextlib.closing(done):
                for place, report in done:
                    reports[left[place]] = report
                    if progress is not None:
                        progress(len(reports), len(units))
            if len(reports) < len(units) or not request.all_arguments:
                break
            units += smaller(units, reports)
            first = meanwhile = None
    kept = [(u, reports[i]) for i, u in enumerate(units) if i in reports and not is_nothing(u, reports[i], found)]
    from urdfcheck.run.summary import assemble  # loads what a worker has loaded meanwhile

    outcome = assemble(request, found, kept, time.perf_counter() - began)
    if len(reports) < len(units):
        if progress is not None:
            progress(len(units), len(units))  # nothing is on its way any more
        reason = f"interrupted: {len(reports)} of {len(units)} models and files were checked, and nothing is known of the others"
        outcome = replace(outcome, partial=True, failures=(*outcome.failures, reason))
    outcome = reproducible(outcome) if "SOURCE_DATE_EPOCH" in os.environ else outcome
    return Audited(request, units, reports, outcome)


def _still_true(before: Audited, units: Sequence[Unit], texts: Mapping[str, bytes]) -> dict[int, Report]:
    """The reports on units that have not changed, nor any file that was read for them."""
    old = before.request.texts
    changed = {path for path in (*old, *texts) if old.get(path) != texts.get(path)}
    known = {(unit.kind, unit.id): (unit, before.reports.get(place)) for place, unit in enumerate(before.units)}
    real = functools.cache(os.path.realpath)  # most units read the same files
    kept = {}
    for place, unit in enumerate(units):
        same, report = known.get((unit.kind, unit.id), (None, None))
        if same == unit and report is not None and report.reads and not changed & set(map(real, report.reads)):
            kept[place] = report
    return kept


def run_one(request: Request, audit: Callable[[Unit, Settings], Report] | None = None) -> Report:
    """The report on the one model that the request's paths mean; ``audit`` as for :func:`run`.

    :raises UrdfcheckError: when they mean none, or several.
    """
    found, units = planned(request, here=audit is not None)
    for path, reason in (*found.missing, *found.unused):
        raise UrdfcheckError(f"{path}: {reason}")
    models = [unit for unit in units if unit.kind == "model"]
    if len(models) != 1:
        named = f"{len(models)} models, name one of them: {', '.join(m.id for m in models)}" if models else "no model"
        raise UrdfcheckError(f"{', '.join(map(str, request.paths))}: {named}")
    with auditing(request, models, found.reach or request.reach) as settings:
        ((_, report),) = stream(models, settings, 1, audit)
    return report


def planned(request: Request, *, here: bool = False) -> tuple[Plan, list[Unit]]:
    """What the request's paths mean, and as units of work in a stable order; worked out in a process of its own, for it reads
    the files of strangers, or ``here``.

    :raises UrdfcheckError: when that process died or did not end.
    """
    configured = None if request.configured is None else request.configured.of
    packages = (request.packages, request.package_paths)
    asked = (request.paths, request.arguments, *packages, request.reach, configured, request.all_arguments)
    if here:
        with overlay_files(request.texts):
            found = discover_targets(*asked)
    else:
        seconds = request.limits.seconds
        longest = max(PLANNING * seconds, LEAST_PLANNING) if seconds else None
        ((_, found),) = map_in_processes(_plan, [(request.limits.memory, request.texts, *asked)], 1, timeout=longest)
        if isinstance(found, WorkerTimeoutError):
            raise UrdfcheckError(f"looking for models took more than {longest:g} s (--timeout)")
        if isinstance(found, WorkerDiedError):
            raise UrdfcheckError(f"the process that looks for models {_ending(found.exit_code)}")
        if isinstance(found, MemoryError):
            raise UrdfcheckError(f"looking for models takes more than {request.limits.memory} MiB (--memory)")
    return found, _units(found, request)


def _plan(memory: int, texts: Mapping[str, bytes], *words: Any) -> Plan | MemoryError:
    sandbox.limit_memory(memory)
    try:
        with overlay_files(texts):
            return discover_targets(*words)
    except MemoryError as error:
        return error.with_traceback(None)


@contextlib.contextmanager
def auditing(request: Request, units: Sequence[Unit], reach: FileReach) -> Iterator[Settings]:
    """What holds for the audit of these units, as long as the context lasts. ``reach``: what may be opened."""
    from urdfcheck.run.audit import Settings

    with _cache_for(request, units) as folder:
        yield Settings(
            codes=request.codes,
            tier=request.tier,
            options=request.options,
            severities=request.severities,
            packages={name: str(path) for name, path in request.packages.items()},
            package_paths=tuple(str(p) for p in request.package_paths),
            targets=request.targets,
            scene=request.scene,
            cache=folder,
            samples=request.samples,
            pairs=request.pairs,
            drop=request.drop,
            reach=reach.roots,
            around=_around(request, reach, units),
            environment=request.environment,
            limits=request.limits,
            suppress=request.suppress,
            comments=request.comments,
            texts=request.texts,
        )


def _around(request: Request, reach: FileReach, units: Sequence[Unit]) -> tuple[str, ...]:
    """The folders that a worker must see: those in reach, those in which packages are looked for, and the rules."""
    folders = dict.fromkeys((*reach.roots, str(catalogue.find_pages_folder())))
    # A launch file may name a model anywhere: what is out of reach makes nothing around it visible.
    files = (Path(path) for u in units if u.kind != "package" for path in (u.path, *u.launches))
    inside = [path.absolute().parent for path in dict.fromkeys(files) if reach.can_open(path)]
    for start in dict.fromkeys((*inside, *(Path(u.path).absolute() for u in units if u.kind == "package"))):
        if not any(os.path.realpath(start).startswith(root + os.sep) for root in folders):
            folders.update(
                dict.fromkeys(os.path.realpath(level) for level in PackageFinder(start).list_parent_folders()[-1:])
            )
    for variable in ("ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH"):
        folders.update(dict.fromkeys(filter(None, os.environ.get(variable, "").split(os.pathsep))))
    return tuple(folders)


@contextlib.contextmanager
def _cache_for(request: Request, units: Sequence[Unit]) -> Iterator[str | None]:
    """The folder of kept results; where nothing is kept and there are several units, one that lasts as long as the run, so
    that a mesh of two models is read once all the same."""
    from urdfcheck.system.array_cache import ArrayCache

    if request.cache is not None:
        with contextlib.suppress(OSError):  # a worker may write in it, and not make it
            request.cache.mkdir(parents=True, exist_ok=True)
        yield str(request.cache)
        ArrayCache(request.cache).tidy()
    elif len(units) > 1:
        with tempfile.TemporaryDirectory(prefix="urdfcheck-", ignore_cleanup_errors=True) as folder:
            yield folder
    else:
        yield None


def reproducible(outcome: Run) -> Run:
    """Without what depends on the machine and the moment (reproducible-builds.org: SOURCE_DATE_EPOCH is set)."""
    return replace(
        outcome,
        models=tuple(replace(model, seconds=0.0) for model in outcome.models),
        seconds=0.0,
        versions={"urdfcheck": outcome.versions["urdfcheck"]},
    )


def model_id(path: Path, arguments: Mapping[str, str], root: Path, name: str | None = None) -> str:
    """A model's name in reports and fingerprints: its path from the configuration's folder, and its arguments, or what the
    configuration calls these."""
    try:
        relative = Path(os.path.relpath(os.path.realpath(path), os.path.realpath(root))).as_posix()
    except ValueError:  # another drive
        relative = path.as_posix()
    return relative + words({"named": name} if name else arguments)


def _units(found: Plan, request: Request) -> list[Unit]:
    from urdfcheck.run.audit import Unit

    def root(path: Path) -> Path:
        config = found.configs.get(str(path))
        return request.root if config is None else config.root

    units = [
        Unit(
            "model",
            str(t.path),
            model_id(t.path, t.arguments, root(t.path), t.name),
            dict(t.arguments),
            tuple(map(str, t.launches)),
            t.explicit,
            t.xacro,
            varied=t.varied,
        )
        for t in found.models
    ]
    units += [Unit("launch", str(p), model_id(p, {}, root(p))) for p in found.launches]
    units += [
        Unit("package", str(p), model_id(p / "package.xml", {}, root(p)), explicit=p in found.whole_packages)
        for p in found.packages
    ]
    baseline = _baselines(request)
    number = Counter(unit.id for unit in units)
    configured = []
    for unit in units:
        config = found.configs.get(unit.path)
        name = unit.id
        if number[name] > 1 and config is not None and config.root != request.root:
            # Two folders with a configuration each call a model the same.
            name = (Path(os.path.relpath(config.root, request.root)) / name).as_posix()
        # The baseline of the run has the names of a run, and that of a folder those of the folder.
        home, known = baseline(config)
        entry = name if home is None else unit.id
        entries = {} if known is None else known.known(entry)
        unit = _configured(unit, config, request)
        configured.append(replace(unit, id=name, known=entries, home=home, entry=entry))
    return configured


def _baselines(request: Request) -> Callable[[Config | None], tuple[tuple[str, str] | None, Baseline | None]]:
    """The baseline for a configuration: the one that was named, or else its own, with the file and folder of the latter."""
    from urdfcheck.policy import baseline

    @functools.cache
    def read(file: Path, root: Path) -> Baseline | None:
        return baseline.read(file, root) if file.is_file() else None

    def find(config: Config | None) -> tuple[tuple[str, str] | None, Baseline | None]:
        configured = request.configured
        if config is None or configured is None or configured.given.baseline is not None or config.root == request.root:
            return None, request.baseline
        file = config.baseline or config.root / baseline.DEFAULT
        return (str(file), str(config.root)), None if configured.isolated else read(file, config.root)

    return find


def _configured(unit: Unit, config: Config | None, request: Request) -> Unit:
    """The unit with the settings that its configuration makes different from those of the request."""
    if config is None or request.configured is None:
        return unit
    holds = request.configured.holds(config, Path(unit.path))
    settings = {
        "codes": holds.codes,
        "tier": holds.tier,
        "options": holds.options,
        "severities": holds.severities,
        "targets": holds.targets,
        "suppress": holds.suppress,
    }
    own = {name: value for name, value in settings.items() if value != getattr(request, name)}
    if config.packages:
        own["packages"] = {n: str(p) for n, p in {**config.packages, **request.packages}.items()}
    if config.package_path:
        own["package_paths"] = tuple(map(str, (*request.package_paths, *config.package_path)))
    return replace(unit, own=own, fail_on=holds.fail_on)


def is_nothing(unit: Unit, report: Report, found: Plan) -> bool:
    """A file that only its expansion shows to be no model: it makes neither link nor joint."""
    info = report.info
    if info is None or info.status != "checked" or info.links or info.joints:
        return False
    return any(target.tentative and str(target.path) == unit.path for target in found.models)


# -- worker processes ------------------------------------------------------------------------------------------------


def stream(
    units: Sequence[Unit],
    settings: Settings,
    jobs: int,
    audit: Callable[[Unit, Settings], Report] | None = None,
    first: Worker | None = None,
    meanwhile: Callable[[], object] | None = None,
) -> Generator[tuple[int, Report], None, None]:
    """Audit each unit in a worker process, at most ``jobs`` at once: the places of the units and their reports as they come.
    ``audit``, ``first`` and ``meanwhile`` as for :func:`run`."""
    from urdfcheck.run.audit import Report, stopped

    if audit is not None:
        yield from ((index, audit(unit, settings)) for index, unit in enumerate(units))
        return
    # A package or a launch file takes less time than a process for it.
    at_once = max(1, min(jobs, sum(unit.kind == "model" for unit in units)))
    # The large ones first, so that none of them is left alone at the end.
    order = sorted(range(len(units)), key=lambda index: -_size(units[index].path))
    work = [(units[index], settings) for index in order]
    seconds = settings.limits.seconds
    longest = seconds + sandbox.PATIENCE if seconds else None
    for place, result in map_in_processes(
        _audit, work, at_once, warm_worker=first, on_idle=meanwhile, timeout=longest, is_spent=_was_stopped
    ):
        unit = units[order[place]]
        if isinstance(result, WorkerTimeoutError):
            result = Report(info=_dead(unit), findings=(stopped(unit, settings.limits, "killed"),))
        elif isinstance(result, WorkerDiedError):
            result = Report(info=_dead(unit), failures=(f"the worker for {unit.id} {_ending(result.exit_code)}",))
        yield order[place], result


def _was_stopped(report: Report) -> bool:
    """Whether the time or the memory was over in the middle of something, an import perhaps, that is half done now."""
    return any(finding.code == "URC906" for finding in report.findings)


def _ending(exit_code: int | None) -> str:
    """How a process ended, in words."""
    if exit_code is None:
        return "sent something that is no report"
    if exit_code >= 0:
        return f"died (exit code {exit_code})"
    try:
        name = signal.Signals(-exit_code).name
    except ValueError:
        name = f"signal {-exit_code}"
    hint = "; the system may have been out of memory" if name == "SIGKILL" else ""
    return f"was killed ({name}{hint})"


def _size(path: str) -> int:
    try:
        return os.stat(path).st_size
    except OSError:
        return 0


def _audit(unit: Unit, settings: Settings) -> Report:
    """What a worker process does with a unit."""
    from urdfcheck.run.audit import Report, audit, stopped

    libraries.prefer_own_folders()
    sandbox.confine(settings.around, [settings.cache] if settings.cache else [], settings.limits.memory)
    try:
        with sandbox.enforce_deadline(settings.limits.seconds):
            return audit(unit, settings)
    except ModelTimeout:  # for the second time: while the first was being handled
        return Report(info=_dead(unit), findings=(stopped(unit, settings.limits, "time"),))
    except Exception as error:  # ours, not the model's: reading and checking turn what is wrong there into findings
        text = f"the audit of {unit.id} crashed: {type(error).__name__}: {error}"
        return Report(info=_dead(unit), failures=(text,))


def _dead(unit: Unit) -> Any:
    from urdfcheck.core import ModelInfo

    if unit.kind != "model":
        return None
    return ModelInfo(format_path(Path(unit.path)), "", dict(unit.arguments), 0, 0, None, "failed", unit.id)
