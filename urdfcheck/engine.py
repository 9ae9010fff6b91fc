"""One run: plan the units, audit them in worker processes, put the reports together.

The parent process imports the standard library only.
"""

from __future__ import annotations

import contextlib
import os
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from urdfcheck import __version__, catalogue, libraries
from urdfcheck.core import Finding, Location, Run, Skip, UrdfcheckError
from urdfcheck.source.discover import ModelTarget, Plan, plan
from urdfcheck.source.packages import display_name
from urdfcheck.workers import Died, Worker, in_workers

if TYPE_CHECKING:
    from urdfcheck.worker import Report, Settings, Unit

# Configurations of the joints that are looked at, and with --thorough.
SAMPLES, THOROUGH = 200, 5_000
DISTRIBUTIONS = ("xacro", "numpy", "pin", "coal", "trimesh")


@dataclass(frozen=True, slots=True)
class Request:
    """What a run is asked to do. ``root`` is the configuration's folder: models are named relative to it. ``cache``: the
    folder of results that are kept, None to keep nothing; ``samples``: in how many configurations motion is looked at;
    ``pairs``: whether the reports judge all pairs of links for an SRDF."""

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


def run(
    request: Request,
    audit: Callable[[Unit, Settings], Report] | None = None,
    first: Worker | None = None,
    meanwhile: Callable[[], object] | None = None,
) -> Run:
    """Check everything that the request's paths mean.

    ``audit`` replaces the worker processes by a function in this one (for tests and for embedding). ``first``: a worker
    that waits already; ``meanwhile`` is called once while the first workers are busy.
    """
    began = time.perf_counter()
    found = plan(request.paths, request.arguments, request.packages, request.package_paths)
    units = _units(found, request.root)
    reports = _reports(request, units, audit, first, meanwhile)
    kept = [(u, r) for u, r in zip(units, reports, strict=True) if not _is_nothing(u, r, found)]
    outcome = _assemble(request, found, kept, time.perf_counter() - began)
    return reproducible(outcome) if "SOURCE_DATE_EPOCH" in os.environ else outcome


def run_one(request: Request, audit: Callable[[Unit, Settings], Report] | None = None) -> Report:
    """The report on the one model that the request's paths mean; ``audit`` as for :func:`run`.

    :raises UrdfcheckError: when they mean none, or several.
    """
    found = plan(request.paths, request.arguments, request.packages, request.package_paths)
    for path, reason in (*found.missing, *found.unused):
        raise UrdfcheckError(f"{path}: {reason}")
    models = [unit for unit in _units(found, request.root) if unit.kind == "model"]
    if len(models) != 1:
        named = f"{len(models)} models, name one of them: {', '.join(m.id for m in models)}" if models else "no model"
        raise UrdfcheckError(f"{', '.join(map(str, request.paths))}: {named}")
    (report,) = _reports(request, models, audit)
    return report


def _reports(
    request: Request,
    units: Sequence[Unit],
    audit: Callable[[Unit, Settings], Report] | None,
    first: Worker | None = None,
    meanwhile: Callable[[], object] | None = None,
) -> list[Report]:
    """The report on each unit, in their order."""
    from urdfcheck.worker import Settings

    with _cache_for(request, units) as folder:
        settings = Settings(
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
        )
        if audit is not None:
            return [audit(unit, settings) for unit in units]
        return _in_workers(units, settings, request.jobs, first, meanwhile)


@contextlib.contextmanager
def _cache_for(request: Request, units: Sequence[Unit]) -> Iterator[str | None]:
    """The folder of kept results; where nothing is kept and there are several units, one that lasts as long as the run, so
    that a mesh of two models is read once all the same."""
    from urdfcheck.cache import Cache

    if request.cache is not None:
        yield str(request.cache)
        Cache(request.cache).tidy()
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


def model_id(path: Path, arguments: Mapping[str, str], root: Path) -> str:
    """A model's name in reports and fingerprints: its path from the configuration's folder, and its arguments."""
    try:
        relative = Path(os.path.relpath(os.path.realpath(path), os.path.realpath(root))).as_posix()
    except ValueError:  # another drive
        relative = path.as_posix()
    words = [f"{name}:={value}" for name, value in sorted(arguments.items())]
    return " ".join((relative, *words))


def _units(found: Plan, root: Path) -> list[Unit]:
    from urdfcheck.worker import Unit

    units = [
        Unit(
            "model",
            str(t.path),
            model_id(t.path, t.arguments, root),
            dict(t.arguments),
            tuple(map(str, t.launches)),
            t.explicit,
            t.xacro,
        )
        for t in found.models
    ]
    units += [Unit("launch", str(p), model_id(p, {}, root)) for p in found.launches]
    units += [Unit("package", str(p), model_id(p / "package.xml", {}, root)) for p in found.packages]
    return units


def _is_nothing(unit: Unit, report: Report, found: Plan) -> bool:
    """A file that only its expansion shows to be no model: it makes neither link nor joint."""
    tentative = {str(t.path): t for t in found.models if t.tentative}
    target: ModelTarget | None = tentative.get(unit.path) if unit.kind == "model" else None
    if target is None or report.info is None or report.info.status != "checked":
        return False
    return report.info.links == 0 and report.info.joints == 0


def _assemble(request: Request, found: Plan, kept: Sequence[tuple[Unit, Report]], seconds: float) -> Run:
    from urdfcheck.worker import merge, order

    findings: list[Finding] = [f for _, r in kept for f in r.findings]
    skipped: list[Skip] = [s for _, r in kept for s in r.skipped]
    skipped += [Skip("ALL", path, reason) for path, reason in found.unused]
    failures = [f"{path}: {reason}" for path, reason in found.missing]
    failures += [f for _, r in kept for f in r.failures]
    outlines = [replace(r.outline, model=u.id) for u, r in kept if r.outline is not None]
    rules = catalogue.rules()
    for rule in rules.values():
        if "run" in rule.scopes and rule.code in request.codes and catalogue.has_check(rule):
            options = {name: o.default for name, o in rule.options.items()}
            options.update(request.options.get(rule.code, {}))
            try:
                findings += catalogue.check_of(rule)(outlines, rule, **options)
            except Exception as error:
                failures.append(f"{rule.code} crashed: {type(error).__name__}: {error}")
    if "URC907" in request.codes:
        for library, path in sorted(libraries.foreign().items()):
            nowhere = Location(f"library[{library}]", None)
            findings.append(rules["URC907"].finding("shadowed", at=nowhere, library=library, path=path))
    sources: dict[str, str] = {}
    for _, report in kept:
        sources.update(report.sources)
    return Run(
        models=tuple(r.info for _, r in kept if r.info is not None),
        findings=tuple(sorted(merge(findings), key=order)),
        skipped=tuple(skipped),
        rules={code: rule for code, rule in rules.items() if code in request.codes or code == "URC900"},
        versions=_versions(full=request.scene),
        sources=sources,
        scenes=tuple(r.scene for _, r in kept if r.scene is not None),
        seconds=seconds,
        failures=tuple(failures),
        units=len(kept),
        tier=request.tier,
        targets=request.targets,
    )


def _versions(*, full: bool) -> dict[str, str]:
    """Our own version and Python's; those of the libraries, which take a while to look up, only for a report that shows them."""
    found = {"urdfcheck": __version__, "python": ".".join(map(str, sys.version_info[:3]))}
    if not full:
        return found
    from importlib.metadata import PackageNotFoundError, version

    for name in DISTRIBUTIONS:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            found[name] = "not installed"
    return found


# -- worker processes ------------------------------------------------------------------------------------------------


def _in_workers(
    units: Sequence[Unit],
    settings: Settings,
    jobs: int,
    first: Worker | None,
    meanwhile: Callable[[], object] | None,
) -> list[Report]:
    """Audit each unit in a worker process, at most ``jobs`` at once; the order of the result is that of the units."""
    from urdfcheck.worker import Report

    # A package or a launch file takes less time than a process for it.
    at_once = max(1, min(jobs, sum(unit.kind == "model" for unit in units)))
    # The large ones first, so that none of them is left alone at the end.
    order = sorted(range(len(units)), key=lambda index: -_size(units[index].path))
    work = [(units[index], settings) for index in order]
    reports: dict[int, Report] = {}
    for place, result in in_workers(_audit, work, at_once, first, meanwhile):
        unit = units[order[place]]
        if isinstance(result, Died):
            text = f"the worker for {unit.id} died (exit code {result.exit_code})"
            result = Report(info=_dead(unit), failures=(text,))
        reports[order[place]] = result
    return [reports[index] for index in range(len(units))]


def _size(path: str) -> int:
    try:
        return os.stat(path).st_size
    except OSError:
        return 0


def _audit(unit: Unit, settings: Settings) -> Report:
    libraries.prefer_own()
    try:
        from urdfcheck.worker import audit

        return audit(unit, settings)
    except Exception as error:  # ours, not the model's: reading and checking turn what is wrong there into findings
        from urdfcheck.worker import Report

        text = f"the audit of {unit.id} crashed: {type(error).__name__}: {error}"
        return Report(info=_dead(unit), failures=(text,))


def _dead(unit: Unit) -> Any:
    from urdfcheck.core import ModelInfo

    if unit.kind != "model":
        return None
    return ModelInfo(display_name(Path(unit.path)), "", dict(unit.arguments), 0, 0, None, "failed", unit.id)
