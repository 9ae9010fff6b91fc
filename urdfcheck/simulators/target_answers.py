"""Ask the engines that are targets, and installed, what they do with the models of a run."""

from __future__ import annotations

import importlib
import re
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from urdfcheck.core import EngineAnswer, Finding, Location, Run, Span, Verdict
from urdfcheck.output.shared.wording import PROGRAM_NAMES
from urdfcheck.policy.consumers import ASKED_ENGINES, apply_severity_policy, get_verdict
from urdfcheck.rules import load_rules
from urdfcheck.run.jobs import Unit
from urdfcheck.run.pipeline import AuditedRun, audit_session
from urdfcheck.run.replay.answers import KnownAnswers
from urdfcheck.run.replay.reports import enable_replay
from urdfcheck.simulators.comparison import read_engine_input
from urdfcheck.simulators.judgement import judge_outcome
from urdfcheck.simulators.processes import get_install_hint, iter_outcomes
from urdfcheck.system.observing.observations import Observations, pause_observing
from urdfcheck.system.observing.questions import add_observations
from urdfcheck.system.process_pool import map_in_processes

RULE = "XML015"
# What an engine names, and what a finding is about.
_NAME = re.compile(r"'([^']+)'")
# The folders of an absolute path; one in quotes may have blanks.
_QUOTED_PATH = re.compile(r"(?<=['\"])(?:[A-Za-z]:)?[/\\][^'\"]*[/\\]([^'\"/\\]+)(?=['\"])")
_FOLDERS = re.compile(r"(?<![\w.])(?:[A-Za-z]:)?[/\\](?:[^\s'\"/\\]+[/\\])+")
_SUBJECT = re.compile(r"(?:link|joint)\[([^\]]+)\]")


def ask_targets(audited: AuditedRun) -> Run:
    """Return the outcome of a run with what each engine among its targets did here with each model that was checked.

    Where an engine refused a model and one finding predicts that, or is about what the engine names, the finding says so; where
    none predicts it, a finding XML015 reports it. An engine that is not installed was not asked, and its answer says that.
    """
    start = time.perf_counter()
    outcome = audited.outcome
    checked = {info.id for info in outcome.models if info.status == "checked"}
    units = [unit for unit in audited.units if unit.kind == "model" and unit.id in checked]
    wanted = [(unit, engine) for unit in units for engine in ASKED_ENGINES if engine in outcome.get_targets(unit.id)]
    with pause_observing():
        versions = {engine: _find_version(engine) for engine in dict.fromkeys(engine for _, engine in wanted)}
    answers = [
        EngineAnswer(model=unit.id, engine=engine, version="", verdict=None, reasons=(get_install_hint(engine),))
        for unit, engine in wanted
        if versions[engine] is None
    ]
    asked = [(unit, engine) for unit, engine in wanted if versions[engine] is not None]
    with pause_observing():
        given = list(_iter_answers(audited, asked, versions))
    for answer, observations in given:
        answers.append(answer)
        add_observations(observations)
    order = {(unit.id, engine): place for place, (unit, engine) in enumerate(wanted)}
    answers.sort(key=lambda answer: order[answer.model, answer.engine])
    took = time.perf_counter() - start if outcome.seconds else 0.0  # a reproducible report has no duration
    return _state_answers(replace(outcome, answers=tuple(answers), seconds=outcome.seconds + took), audited)


def _find_version(engine: str) -> str | None:
    version: str | None = importlib.import_module(f"urdfcheck.simulators.{engine}").get_version()
    return version


def _iter_answers(
    audited: AuditedRun, asked: Sequence[tuple[Unit, str]], versions: Mapping[str, str | None]
) -> Iterator[tuple[EngineAnswer, Observations | None]]:
    """Yield the answers of installed engines, in the order in which they come, and what each depends on if that is known."""
    request = audited.request
    if not asked:
        return
    at_once = max(1, request.jobs)
    with audit_session(request, list({unit.id: unit for unit, _ in asked}.values()), audited.plan) as session:
        settings = enable_replay(session) if request.cache is not None else session
        known = KnownAnswers(settings)
        missing = []
        for unit, engine in asked:
            recalled = known.recall(unit, engine, versions[engine] or "")
            if recalled is None:
                missing.append((unit, engine))
            else:
                yield recalled
        if not missing:
            return
        units = list({unit.id: unit for unit, _ in missing}.values())
        read = map_in_processes(read_engine_input, [(unit, settings) for unit in units], at_once)
        robots = {
            units[place].id: result for place, result in read if isinstance(result, tuple) and result[0] is not None
        }
        for unit, engine in missing:
            if unit.id not in robots:
                reason = ("the model cannot be handed over",)
                version = versions[engine] or ""
                kept = EngineAnswer(
                    model=unit.id, engine=engine, version=version, verdict=None, reasons=reason, stopped=True
                )
                yield kept, None
        jobs = [(unit, engine, *robots[unit.id]) for unit, engine in missing if unit.id in robots]
        for place, outcome in iter_outcomes(
            [(engine, robot) for _, engine, robot, _ in jobs],
            around=settings.visible_folders,
            limits=request.options.limits,
            at_once=at_once,
        ):
            unit, engine, robot, observations = jobs[place]
            judgement = judge_outcome(robot, outcome)
            answer = EngineAnswer(
                model=unit.id,
                engine=engine,
                version=versions[engine] or "",
                verdict=judgement.verdict,
                reasons=tuple(map(_cut_folders, judgement.reasons)),
                stopped=outcome.stopped,
            )
            observations = observations if settings.policy.tier != "source" else None  # which reads no mesh
            if observations is not None:
                known.keep(unit, answer, observations)
            yield answer, observations


def _cut_folders(reason: str) -> str:
    """Cut the folders of this machine from what an engine says."""
    return _FOLDERS.sub("", _QUOTED_PATH.sub(r"\1", reason))


def _state_answers(run: Run, audited: AuditedRun) -> Run:
    """Return the run with findings that say what was refused here."""
    findings = list(run.findings)
    for answer in run.answers:
        if answer.verdict is not Verdict.REFUSES:
            continue
        places = [
            place
            for place, finding in enumerate(findings)
            if answer.model in finding.subjects_by_model
            and get_verdict(finding.consequences, answer.engine) is Verdict.REFUSES
        ]
        is_predicted = bool(places)
        if len(places) > 1:
            named = set(_NAME.findall("; ".join(answer.reasons)))
            places = [p for p in places if named & {*_SUBJECT.findall(" ".join(_list_subjects(findings[p], answer)))}]
        notes = [f for f in run.unrequested if answer.model in f.subjects_by_model]
        if len(places) == 1:
            told = findings[places[0]]
            sentence = f"refused it here (version {answer.version}): {'; '.join(answer.reasons)}"
            findings[places[0]] = replace(told, consequences={**told.consequences, answer.engine: sentence})
        elif not is_predicted and not any(get_verdict(f.consequences, answer.engine) is Verdict.REFUSES for f in notes):
            findings += _report_refusal(run, answer, audited)
    return replace(run, findings=tuple(findings))


def _list_subjects(finding: Finding, answer: EngineAnswer) -> Sequence[str]:
    return finding.subjects_by_model[answer.model]


def _report_refusal(run: Run, answer: EngineAnswer, audited: AuditedRun) -> list[Finding]:
    """Return the finding about a refusal that no other finding predicts; none if the rule is not selected."""
    policy = next((unit.policy for unit in audited.units if unit.id == answer.model), None) or audited.request.policy
    if RULE not in policy.codes:
        return []
    rule = load_rules()[RULE]
    path = next(info.path for info in run.models if info.id == answer.model)
    finding = rule.finding(
        "refused",
        at=Location("robot", Span(path, 1, 1, 1, 1, 0, 0)),
        engine=answer.engine,
        program=f"{PROGRAM_NAMES[answer.engine]} {answer.version}",
        reason="; ".join(answer.reasons),
        consequences={answer.engine: f"refused it here (version {answer.version}): {'; '.join(answer.reasons)}"},
    )
    located = replace(finding, model=answer.model)
    return [apply_severity_policy(located, rule, targets=policy.targets, severities=policy.severities)]
