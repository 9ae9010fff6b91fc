"""The audit of one unit (a model with the launch files that lead to it, or a package), done whole in one process.

Only plain data leaves: findings, skips, the model's line in the report and, when an output draws, its scene.
"""

from __future__ import annotations

import re
import time
import traceback
from bisect import bisect_left
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from urdfcheck import rules as catalogue
from urdfcheck.core import (
    Applicability,
    FactUnavailableError,
    Finding,
    Location,
    ModelInfo,
    Rule,
    Severity,
    SkippedCheck,
    Span,
)
from urdfcheck.core.drop_test import DropTest
from urdfcheck.core.errors import ModelTimeout
from urdfcheck.core.scene import Scene
from urdfcheck.export.link_pairs import LinkPairs, compute_link_pairs
from urdfcheck.export.outline import ModelOutline, build_outline
from urdfcheck.model import Model
from urdfcheck.policy.consumers import weighed
from urdfcheck.policy.fix_safety import within
from urdfcheck.policy.limits import ResourceLimits
from urdfcheck.policy.suppression import Entry, Judged, Known, judged, suppressed
from urdfcheck.run.findings_cache import Recall, applies
from urdfcheck.source.launch.launch_file import Launch, load_launch
from urdfcheck.source.load import Source, load_source
from urdfcheck.source.package.finder import PackageFinder, load_package
from urdfcheck.source.reach import FileReach
from urdfcheck.source.resources import find_uninstalled_files
from urdfcheck.source.text.problems import Problem
from urdfcheck.source.text.suppression_comments import IgnoreComment, find_ignore_comments
from urdfcheck.source.text.xml import SourceFile
from urdfcheck.system.array_cache import ArrayCache
from urdfcheck.system.files import Stamp, overlay_files, read_regular, record_reads

# Of one rule in one model. The noisiest of 110 robots has 14.
MOST_FINDINGS = 1_000
# Characters of a name or a message, and of the edits of a repair. Of a hundred real robots none has half of it.
LONGEST, MOST_EDITED = 2_000, 100_000
TIERS = ("source", "mesh", "full")
_TIER_OF_NEED = {
    **dict.fromkeys(("source", "package"), "source"),
    "mesh": "mesh",
    **dict.fromkeys(("dynamics", "collision", "simulator"), "full"),
}


@dataclass(frozen=True, slots=True)
class Unit:
    """What one worker audits. ``kind``: model | launch | package. ``id`` names it in the report; ``xacro``: see :func:`load_source`;
    ``known``: what its baseline knows of it, ``home``: the file and folder of this baseline where it is not the run's, ``entry``:
    what it is called there; ``own``: the settings that hold for it instead of those of the run, by name;
    ``fail_on``: from which severity on its findings count for the exit code, None where the run decides;
    ``varied``: see :class:`~urdfcheck.source.discover.ModelTarget`; ``reduced``: it was made to find out which arguments a
    finding takes."""

    kind: str
    path: str
    id: str
    arguments: Mapping[str, str] = field(default_factory=dict)
    launches: tuple[str, ...] = ()
    explicit: bool = True
    xacro: bool = False
    known: Known = field(default_factory=dict)
    home: tuple[str, str] | None = None
    entry: str = ""
    own: Mapping[str, Any] = field(default_factory=dict)
    fail_on: str | None = None
    varied: tuple[str, ...] = ()
    reduced: bool = False


@dataclass(frozen=True, slots=True)
class Settings:
    """What holds for every unit of a run: plain values, because they cross into the worker. ``cache``: the folder of results
    that are kept, None to keep nothing; ``samples``: in how many configurations motion is looked at. ``reach``: the folders
    below which files may be opened, None for all; ``around``: those that a worker process must see at all; ``environment``:
    the variables that a xacro may read beside those of ROS. ``suppress``: what the configuration says to be known;
    ``comments``: whether comments in the source may say so. ``texts``: see :func:`urdfcheck.system.files.overlay_files`."""

    codes: frozenset[str]
    tier: str = "full"
    options: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    severities: Mapping[str, str] = field(default_factory=dict)
    packages: Mapping[str, str] = field(default_factory=dict)
    package_paths: tuple[str, ...] = ()
    targets: tuple[str, ...] = ()
    scene: bool = False
    cache: str | None = None
    samples: int = 200
    pairs: bool = False
    drop: bool = False
    reach: tuple[str, ...] | None = None
    around: tuple[str, ...] = ()
    environment: tuple[str, ...] = ()
    limits: ResourceLimits = field(default_factory=ResourceLimits)
    suppress: tuple[Entry, ...] = ()
    comments: bool = True
    texts: Mapping[str, bytes] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Report:
    """What a worker sends back. ``failures`` are urdfcheck's own: they make the exit code 2. ``scene`` and ``pairs`` are there
    where the settings ask for them. ``reads``: the files that the findings rest on, as they were. ``comments``: those that
    suppress findings, or would; ``files``: what a model is made of, as findings call them."""

    findings: tuple[Finding, ...] = ()
    skipped: tuple[SkippedCheck, ...] = ()
    info: ModelInfo | None = None
    scene: Scene | None = None
    pairs: LinkPairs | None = None
    drop: DropTest | None = None
    outline: ModelOutline | None = None
    sources: Mapping[str, str] = field(default_factory=dict)
    failures: tuple[str, ...] = ()
    reads: Mapping[str, Stamp] = field(default_factory=dict)
    comments: tuple[Judged, ...] = ()
    files: tuple[str, ...] = ()


def audit(unit: Unit, settings: Settings) -> Report:
    """Audit one unit. A check that crashes is reported as a failure and as finding URC900; the others still run."""
    import numpy as np

    began = time.perf_counter()
    run = _Audit(unit, replace(settings, **unit.own))
    with record_reads() as reads, overlay_files(settings.texts), np.errstate(all="ignore"):  # such numbers are findings
        try:
            if unit.kind == "package":
                run.package()
            elif unit.kind == "launch":
                run.launches(None)
            else:
                run.model()
        except ModelTimeout:
            run.stop("time")
        except MemoryError:
            run.stop("memory")
    return replace(run.report(time.perf_counter() - began), reads=reads)


def stopped(unit: Unit, limits: ResourceLimits, message: str, problem: Problem | None = None) -> Finding:
    """That the check of a unit was stopped (``message``: time | memory | killed), or its expansion at a problem."""
    at = Location("robot", Span(_display(unit.path), 1, 1, 1, 1, 0, 0)) if problem is None else problem.location
    related, reason = ((), "") if problem is None else (problem.related, problem.message)
    rule = catalogue.load_rules()["URC906"]
    finding = rule.finding(message, at=at, related=related, seconds=limits.seconds, memory=limits.memory, reason=reason)
    return replace(finding, model=unit.id)


class _Audit:
    """Collects what the checks of one unit find."""

    def __init__(self, unit: Unit, settings: Settings) -> None:
        self.unit = unit
        self.settings = settings
        self.findings: list[Finding] = []
        self.skipped: list[SkippedCheck] = []
        self.failures: list[str] = []
        self.texts: dict[str, str] = {}
        self.info: ModelInfo | None = None
        self.scene: Scene | None = None
        self.pairs: LinkPairs | None = None
        self.drop: DropTest | None = None
        self.outline: ModelOutline | None = None
        self.recall: Recall | None = None
        self.source: Source | None = None
        self.rules = {c: r for c, r in catalogue.load_rules().items() if c in settings.codes and catalogue.has_check(r)}

    def finder(self, start: Path) -> PackageFinder:
        return PackageFinder(
            start.absolute(),
            {name: Path(folder) for name, folder in self.settings.packages.items()},
            [Path(p) for p in self.settings.package_paths],
            reach=None if self.settings.reach is None else FileReach(self.settings.reach),
        )

    # -- kinds of units ----------------------------------------------------------------------------------------

    def model(self) -> None:
        path = Path(self.unit.path)
        unit = self.unit
        source = load_source(
            path,
            unit.arguments,
            self.finder(path),
            explicit=unit.explicit,
            xacro=unit.xacro,
            environment=frozenset(self.settings.environment),
        )
        self.source = source
        self.texts.update({name: file.text for name, file in source.files.items()})
        for problem in source.find_problems("time-limit", "memory-limit"):
            message = f"expansion-{problem.kind.partition('-')[0]}"
            self.findings.append(stopped(unit, self.settings.limits, message, problem))
        self.run("file", source)
        model: Model | None = None
        if source.root is not None and source.root.tag == "robot":
            folder = None if self.settings.cache is None else Path(self.settings.cache)
            tier, targets, samples = self.settings.tier, self.settings.targets, self.settings.samples
            model = Model(
                source,
                source.root,
                tier,
                ArrayCache(folder),
                samples=samples,
                targets=targets,
                may_simulate=self.settings.drop,
            )
            if folder is not None and tier != TIERS[0]:
                self.recall = Recall(model)
            self.run("model", model)
            self.skip_meshes(source)
            if self.recall is not None:
                self.recall.keep()
            self.outline = build_outline(model)
        else:
            # Everything else is about a robot that could not be had: the findings so far say why.
            self.skip_scope("model", "the model could not be expanded")
        self.launches(model)
        self.info = _info(self.unit, source, model)
        if self.settings.scene and model is not None:
            from urdfcheck.export.scene_builder import build_scene

            self.scene = self.guard(
                "scene", lambda: build_scene(model, self.unit.id, self.loaded_launches, self.findings)
            )
        if self.settings.pairs and model is not None:
            self.pairs = self.guard("srdf", lambda: compute_link_pairs(model))
        if self.settings.drop and model is not None:
            self.drop = self.guard("drop", lambda: self.dropped(model))

    def dropped(self, model: Model) -> DropTest | None:
        from urdfcheck.model.motion.simulated_drop import run_drop_test  # loads numpy

        try:
            return replace(run_drop_test(model), model=self.unit.id)
        except FactUnavailableError:  # DYN005 tells why
            return None

    def launches(self, model: Model | None) -> None:
        paths = (self.unit.path,) if self.unit.kind == "launch" else self.unit.launches
        self.loaded_launches: list[Launch] = []
        for text in paths:
            path = Path(text)
            launch = replace(load_launch(path, self.finder(path)), model=model)
            self.loaded_launches.append(launch)
            self.texts.update({name: file.text for name, file in launch.files.items()})
            self.run("launch", launch)

    def package(self) -> None:
        folder = Path(self.unit.path)
        package = load_package(folder)
        if package is None:
            return
        if package.file is not None:
            self.texts[package.file.name] = package.file.text
        self.run("package", replace(package, finder=self.finder(folder), is_fully_checked=self.unit.explicit))

    # -- running checks ----------------------------------------------------------------------------------------

    def run(self, scope: str, subject: Any) -> None:
        for rule in self.rules.values():
            if scope not in rule.scopes:
                continue
            missing = _missing_tier(rule, self.settings.tier)
            if missing:
                self.skip(rule.code, f"needs --tier {missing}")
                continue
            options = {name: o.default for name, o in rule.options.items()}
            options.update(self.settings.options.get(rule.code, {}))
            self.guard(rule.code, lambda rule=rule, options=options: self.collect(rule, subject, options))  # type: ignore[misc]

    def collect(self, rule: Rule, subject: Any, options: Mapping[str, Any]) -> None:
        def find() -> Iterable[Finding]:
            return catalogue.load_check(rule)(subject, rule, **options)

        recall = self.recall if applies(rule) else None
        for finding in find() if recall is None else recall.findings(rule, options, find):
            found = weighed(finding, rule, self.settings.targets, self.settings.severities)
            self.findings.append(clipped(replace(found, model=self.unit.id)))

    def guard(self, what: str, work: Callable[[], Any]) -> Any:
        """Run a check; a fact that cannot be had is a skip, any other exception is our own failure."""
        try:
            return work()
        except FactUnavailableError as reason:
            self.skip(what, str(reason))
        except MemoryError:
            raise  # the model is too large, and no check at fault
        except Exception as error:
            where = traceback.extract_tb(error.__traceback__)[-1]
            text = f"{type(error).__name__}: {error} ({Path(where.filename).name}:{where.lineno})"
            self.failures.append(f"{what} crashed on {self.unit.id}: {text}")
            crash = catalogue.load_rules()["URC900"]
            start = Location("robot", Span(_display(self.unit.path), 1, 1, 1, 1, 0, 0))
            self.findings.append(
                replace(crash.finding("crashed", at=start, check=what, error=text), model=self.unit.id)
            )
        return None

    def stop(self, message: str) -> None:
        """Give up: what was found stays, and everything else is unknown."""
        self.findings.append(stopped(self.unit, self.settings.limits, message))
        self.skip("ALL", "the check was stopped (URC906)")
        if self.unit.kind == "model":
            path, arguments = _display(self.unit.path), dict(self.unit.arguments)
            self.info = ModelInfo(path, "", arguments, 0, 0, None, "failed", self.unit.id)

    def skip(self, code: str, reason: str) -> None:
        self.skipped.append(SkippedCheck(code, self.unit.id, reason))

    def skip_meshes(self, source: Source) -> None:
        """Meshes of a package that is declared and only not installed here are nothing to complain of, and nothing is known
        of them."""
        for package, files in find_uninstalled_files(source).items():
            number = "a mesh" if len(files) == 1 else f"{len(files)} meshes"
            for rule in self.rules.values():
                if "mesh" in rule.needs and not _missing_tier(rule, self.settings.tier):
                    self.skip(
                        rule.code, f"nothing is known of {number} in package {package}, which is not installed here"
                    )

    def skip_scope(self, scope: str, reason: str) -> None:
        for rule in self.rules.values():
            if scope in rule.scopes:
                self.skip(rule.code, reason)

    def read_text(self, path: Path) -> str | None:
        """The text of a file that a finding points into and that was not kept; None where it cannot or must not be read."""
        if not self.finder(Path(self.unit.path)).can_open(path):
            return None
        try:
            return read_regular(path).decode("utf-8", "replace")
        except OSError:
            return None

    def first_of_each(self, findings: Iterable[Finding]) -> Iterator[Finding]:
        """All findings but those that nobody would read any more; how many these are is said."""
        number: Counter[tuple[str, Severity]] = Counter()
        for finding in findings:
            kind = finding.code, finding.severity  # a thousand warnings hide no error
            number[kind] += 1
            if number[kind] <= MOST_FINDINGS:
                yield finding
        for (code, severity), count in sorted(number.items()):
            if count > MOST_FINDINGS:
                self.skip(code, f"{count - MOST_FINDINGS:,} more findings ({severity}) are not listed")

    def report(self, seconds: float) -> Report:
        named = {f.location.span.file for f in self.findings if f.location.span is not None}
        named |= {s.file for f in self.findings for s in f.location.via}
        named |= {r.span.file for f in self.findings for r in f.related if r.span is not None}
        for name in sorted(named - set(self.texts)):
            text = self.read_text(Path(name))
            if text is not None:
                self.texts[name] = text
        found, comments = self.suppressed()
        told = within(hide(merge(found), self.rules), None if self.source is None else self.source.root)
        findings = tuple(self.first_of_each(sorted(told, key=order)))
        info = None if self.info is None else replace(self.info, seconds=round(seconds, 3))
        named |= {judgement.comment.span.file for judgement in comments}
        return Report(
            findings,
            tuple(self.skipped),
            info,
            self.scene,
            self.pairs,
            self.drop,
            self.outline,
            {name: text for name, text in self.texts.items() if name in named},
            tuple(self.failures),
            comments=comments,
            files=() if self.source is None else tuple(self.source.files),
        )

    def suppressed(self) -> tuple[list[Finding], tuple[Judged, ...]]:
        """The findings, those marked that somebody knows, and what is known of the comments that say so."""
        comments = [
            c for name, text in self.texts.items() for c in find_ignore_comments(SourceFile(Path(name), name, text))
        ]
        heeded = comments if self.settings.comments else []
        found, used = suppressed(self.findings, heeded, self.settings.suppress, self.unit.known)
        skipped = {skip.code for skip in self.skipped}
        judgements = [
            judged(c, self.texts[c.span.file], c.span in used, self.settings.codes, skipped, self.doubt(c))
            for c in heeded
        ]
        return found, tuple(judgements)

    def doubt(self, comment: IgnoreComment) -> str:
        """Why a comment that this unit does not need may be needed all the same; empty where there is no reason to think so."""
        source = self.source
        if source is None or comment.span.file not in source.files:
            return ""
        if self.unit.explicit and comment.span.file != source.name:
            return "other models may use the file"
        if not source.is_xacro or any(word.upper().startswith("XAC") for word in comment.selectors):
            return ""
        places = self.reached.get(comment.span.file, [])
        first = bisect_left(places, comment.start)
        return "" if first < len(places) and places[first] < comment.end else "these arguments do not reach it"

    @cached_property
    def reached(self) -> Mapping[str, Sequence[int]]:
        """By file the offsets of what the elements of the model were made from, in their order."""
        elements = () if self.source is None or self.source.root is None else self.source.root.walk()
        places: dict[str, set[int]] = {}
        for span in (span for e in elements for span in (e.span, *e.via) if span is not None):
            places.setdefault(span.file, set()).add(span.start)
        return {file: sorted(starts) for file, starts in places.items()}


def clipped(finding: Finding) -> Finding:
    """A finding without the middle of a name that is longer than anybody reads: a thousand findings about one link, each of
    which says its name of a million letters ten times, would be more than a report can hold."""
    fix = finding.fix
    if fix is not None and sum(len(e.expected) + len(e.replacement) for e in fix.edits) > MOST_EDITED:
        fix = replace(fix, applicability=Applicability.DISPLAY, edits=())
    return replace(
        finding,
        message=_short(finding.message),
        location=replace(finding.location, subject=_short(finding.location.subject)),
        subjects=tuple(map(_short, finding.subjects)),
        related=tuple(replace(r, subject=_short(r.subject)) for r in finding.related),
        cause=None if finding.cause is None else replace(finding.cause, text=_short(finding.cause.text)),
        consequences=_short(finding.consequences),
        data=_short(finding.data),
        fix=None if fix is None else replace(fix, title=_short(fix.title)),
    )


def _short(value: Any) -> Any:
    if isinstance(value, str) and len(value) > LONGEST:
        return f"{value[: LONGEST // 2]}…{value[-LONGEST // 2 :]}"
    if isinstance(value, dict):
        return {_short(key): _short(inner) for key, inner in value.items()}
    return type(value)(map(_short, value)) if type(value) in {list, tuple} else value


def merge(findings: Iterable[Finding]) -> list[Finding]:
    """Findings of one code, source text, message and measured values become one with several subjects: one typo, one
    finding. Where a macro line gives another value to each link that it makes, each value is told with its own call."""
    alike: dict[tuple[Any, ...], list[Finding]] = {}
    for finding in findings:
        span = finding.location.span
        numbers = tuple(sorted((k, v) for k, v in finding.data.items() if isinstance(v, (int, float))))
        where = span or finding.location.subject
        known = finding.suppressed
        alike.setdefault((finding.code, finding.message_id, finding.model, where, numbers, known), []).append(finding)
    return [
        replace(
            group[0],
            subjects=tuple(dict.fromkeys(subject for finding in group for subject in finding.subjects)),
            severity=max(finding.severity for finding in group),
        )
        for group in alike.values()
    ]


def hide(findings: Iterable[Finding], rules: Mapping[str, Rule]) -> list[Finding]:
    """Drop findings whose page yields to another rule that fired on the same element; the other one says so.

    The elements of a finding are those of its subjects, of which all have to be the other's, and for a difference of two of
    which it names one, those that its ``data`` lists as ``between``, of which one is enough.
    """
    findings = list(findings)
    fired: dict[tuple[str, str], int] = {}
    for index, finding in enumerate(findings):
        for subject in finding.subjects:
            fired.setdefault((finding.code, _element(subject)), index)
    hidden: set[int] = set()
    hides: dict[int, set[str]] = {}
    for index, finding in enumerate(findings):
        rule = rules.get(finding.code)
        elements = set(map(_element, finding.subjects))
        between = set(map(_element, finding.data.get("between", ())))
        stronger = rule.hidden_by if rule is not None else ()
        by = {e: fired[code, e] for e in elements | between for code in reversed(stronger) if (code, e) in fired}
        if elements <= by.keys() or between & by.keys():
            hidden.add(index)
            for other in by.values():
                hides.setdefault(other, set()).add(finding.code)
    return [
        replace(f, data={**f.data, "hides": sorted(hides[i])}) if i in hides else f
        for i, f in enumerate(findings)
        if i not in hidden
    ]


def _element(subject: str) -> str:
    """``link[wheel]`` of ``link[wheel]/inertial/inertia@izz``, whatever stands in the name."""
    named = re.match(r"[^/@\[]*\[.*?\](?=[/@]|$)", subject, re.DOTALL)
    return named[0] if named else subject.split("/")[0].split("@")[0]


def order(finding: Finding) -> tuple[Any, ...]:
    """By file and position, the worse first on one place, so that output never depends on chance."""
    span = finding.location.span
    place = ("", 0, 0) if span is None else (span.file, span.line, span.col)
    return (finding.model, *place, -finding.severity, finding.code, finding.message_id, finding.subjects)


def _missing_tier(rule: Rule, tier: str) -> str | None:
    wanted = max((TIERS.index(_TIER_OF_NEED[need]) for need in rule.needs), default=0)
    return TIERS[wanted] if wanted > TIERS.index(tier) else None


def _info(unit: Unit, source: Source, model: Model | None) -> ModelInfo:
    if model is None:
        waiting = bool(source.find_problems("argument-missing"))
        status = "needs-arguments" if waiting else "failed"
        return ModelInfo(_display(unit.path), "", dict(unit.arguments), 0, 0, None, status, unit.id)
    masses = [link.inertial.mass for link in model.links if link.inertial is not None]
    known = [m for m in masses if m is not None]
    return ModelInfo(
        _display(unit.path),
        model.name,
        dict(unit.arguments),
        len(model.links),
        len(model.joints),
        round(sum(known), 9) if known else None,
        "checked",
        unit.id,
    )


def _display(path: str) -> str:
    from urdfcheck.source.package.finder import format_path

    return format_path(Path(path))
