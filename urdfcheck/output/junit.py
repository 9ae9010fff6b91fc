"""Findings as tests for a build server: JUnit's XML, valid under the strict schema of Jenkins' xUnit plugin.

There is a suite for each model and one for launch files and packages; a case for each element with a finding, and a passing
case for each rule that ran and found nothing. A finding that fails the run is a failure; any other passes, with its text.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator
from xml.etree import ElementTree

from urdfcheck.core import Finding, ModelInfo, Run, Severity
from urdfcheck.core.findings import iter_occurrences
from urdfcheck.core.records import dataclass
from urdfcheck.output.shared.code_frames import extract_code_frame
from urdfcheck.output.shared.diffs import iter_diff_lines
from urdfcheck.output.shared.escaping import escape_for_xml, escape_invisible, escape_one_line
from urdfcheck.output.shared.verdict.effects import ToldEffects
from urdfcheck.output.shared.verdict.finding_details import iter_details
from urdfcheck.output.shared.verdict.not_checked import (
    build_command,
    describe_unused_macros,
    explain_unchecked,
    is_accepted,
)
from urdfcheck.output.shared.wording import format_place

OTHER_SUITE = "launch files and packages"
LONGEST_LINE = 200
# XML cannot hold these, not even as references; other controls are escaped already.
_NO_XML = re.compile("[\ufffe\uffff]")


@dataclass(frozen=True, slots=True, kw_only=True)
class JUnitCase:
    """A test case."""

    name: str
    outcome: str = "passed"
    """passed | failure | error | skipped"""
    failure_type: str = ""
    """The ``type`` attribute of an outcome other than passed."""
    message: str = ""
    """One line."""
    text: str = ""
    """Many lines; the output of a case that passed."""


def render(run: Run) -> str:
    """Render an XML document. Only ``time`` differs between equal runs."""
    root = ElementTree.Element("testsuites", name="urdfcheck")
    told: ToldEffects = set()
    for info in run.models:
        _add_suite(root, info.id, _iter_model_cases(run, info, told), seconds=info.seconds, file=info.path)
    _add_suite(root, OTHER_SUITE, _iter_other_cases(run, told))
    _add_suite(root, "urdfcheck", _iter_urdfcheck_cases(run))
    for name in ("tests", "failures", "errors"):
        root.set(name, str(sum(int(suite.get(name, "0")) for suite in root)))
    root.set("time", f"{run.seconds:.3f}")
    ElementTree.indent(root)
    return escape_for_xml(f'<?xml version="1.0" encoding="UTF-8"?>\n{ElementTree.tostring(root, encoding="unicode")}\n')


# -- cases -------------------------------------------------------------------------------------------------------------


def _iter_model_cases(run: Run, info: ModelInfo, told: ToldEffects) -> Iterator[JUnitCase]:
    findings = [finding for finding in run.findings if info.id in finding.subjects_by_model]
    yield from _iter_finding_cases(run, findings, told, info.id)
    if info.status == "checked":
        fired = {finding.code for finding in findings}
        yield from _iter_passed_cases(run, info.id, fired=fired, scopes={"file", "model"})
    else:
        # Accepting it is no failure, and no success either.
        yield JUnitCase(
            name="the model is checked",
            outcome="skipped" if is_accepted(info) else "error",
            failure_type=info.status,
            message=f"not checked: {_get_first_line(explain_unchecked(info))}",
            text=build_command(info),
        )
    yield from _iter_skipped_cases(run, {info.id})


def _iter_other_cases(run: Run, told: ToldEffects) -> Iterator[JUnitCase]:
    """Yield the cases of launch files and packages, and of everything else that belongs to no model."""
    models = {info.id for info in run.models}
    findings = [finding for finding in run.findings if not models.intersection(finding.subjects_by_model)]
    yield from _iter_finding_cases(run, findings, told)
    for name in sorted(run.unit_ids - models):
        scopes = {"package"} if name.rsplit("/", 1)[-1] == "package.xml" else {"launch"}
        fired = {finding.code for finding in findings if name in finding.subjects_by_model}
        yield from _iter_passed_cases(run, name, fired=fired, scopes=scopes, suffix=f" {name}")
    yield from _iter_skipped_cases(run, {skip.model for skip in run.skipped} - models)


def _iter_urdfcheck_cases(run: Run) -> Iterator[JUnitCase]:
    for number, failure in enumerate(run.failures, 1):
        yield JUnitCase(
            name=f"urdfcheck itself ({number})",
            outcome="error",
            failure_type="urdfcheck",
            message=_get_first_line(failure),
            text=failure,
        )
    if run.unused_macro_files:
        yield JUnitCase(
            name="macro files are used by a model",
            outcome="skipped",
            failure_type="unused",
            message=describe_unused_macros(run),
            text="\n".join(run.unused_macro_files),
        )
    if not run.units and not run.failures:
        yield JUnitCase(
            name="there is something to check",
            outcome="skipped",
            failure_type="nothing",
            message="no model, launch file or package was found",
        )


def _iter_finding_cases(
    run: Run, findings: Iterable[Finding], told: ToldEffects, model: str = ""
) -> Iterator[JUnitCase]:
    """Yield a case for each subject of findings, for those of one ``model`` its own, with the numbers of its place."""
    for finding in iter_occurrences(findings):
        if model and model not in finding.subjects_by_model:
            continue
        text = "\n".join(_iter_detail_lines(run, finding, told))
        for subject in finding.subjects_by_model.get(model, finding.subjects) or ("",):
            name = f"{finding.code} {finding.headline}"
            if len(finding.subjects) > 1:
                name += f": {subject}"
            if finding.suppressed is not None:
                message = f"known, {finding.suppressed}: {_get_first_line(finding.message)}"
                yield JUnitCase(name=name, outcome="skipped", failure_type="known", message=message)
            elif _is_failing(run, finding):
                message = _get_first_line(finding.message)
                yield JUnitCase(name=name, outcome="failure", failure_type=finding.code, message=message, text=text)
            else:
                yield JUnitCase(name=name, text=text)


def _iter_passed_cases(
    run: Run, unit: str, *, fired: set[str], scopes: set[str], suffix: str = ""
) -> Iterator[JUnitCase]:
    """Yield a case for each rule that ran on a unit and found nothing there."""
    skipped = {skip.code for skip in run.skipped if skip.model == unit}
    ran = set() if "ALL" in skipped else run.complete_rules.get(unit, frozenset()) - skipped - fired
    for code in sorted(ran & run.rules.keys()):
        if scopes & set(run.rules[code].scopes):
            yield JUnitCase(name=f"{code} {run.rules[code].name}{suffix}")


def _iter_skipped_cases(run: Run, units: set[str]) -> Iterator[JUnitCase]:
    for skip in run.skipped:
        if skip.model in units:
            rule = run.rules.get(skip.code)
            name = "all rules" if skip.code == "ALL" else skip.code if rule is None else f"{rule.code} {rule.name}"
            yield JUnitCase(name=name, outcome="skipped", failure_type="skipped", message=skip.reason)


def _is_failing(run: Run, finding: Finding) -> bool:
    """Whether a finding fails the run, by the same limit as the exit code."""
    levels = set(run.fail_on.values())
    # A finding that belongs to no unit has the limit that all units share.
    fail_on = run.fail_on.get(finding.model, next(iter(levels)) if len(levels) == 1 else "error")
    return fail_on != "never" and finding.severity >= Severity.parse(fail_on)


# -- text of a case ----------------------------------------------------------------------------------------------------


def _iter_detail_lines(run: Run, finding: Finding, told: ToldEffects) -> Iterator[str]:
    """Yield the place, the headline, the message, the lines of the source, the cause, the consequences and the fix."""
    span = finding.location.span
    where = "" if span is None else f"{format_place(span)}: "
    yield f"{where}{finding.severity} {finding.code} {finding.name}"
    yield finding.headline
    yield finding.message
    if span is not None:
        for line in extract_code_frame(run.sources.get(span.file, ""), span):
            yield f"{'>' if line.marked else ' '} {line.number:>5} | {line.text[:LONGEST_LINE]}"
        yield from (f"from {format_place(call)}" for call in reversed(finding.location.via))
    for label, text in iter_details(run, finding, told):
        yield f"{label}: {text}"
    if finding.fix is not None:
        yield from (line[:LONGEST_LINE] for _, line in iter_diff_lines(run.sources, finding.fix.edits))


def _get_first_line(text: str) -> str:
    return text.partition("\n")[0]


# -- XML ---------------------------------------------------------------------------------------------------------------


def _add_suite(
    root: ElementTree.Element, name: str, cases: Iterable[JUnitCase], *, seconds: float = 0.0, file: str = ""
) -> None:
    """Add a suite with these cases, unless there are none."""
    tests = list(cases)
    if not tests:
        return
    outcomes = Counter(case.outcome for case in tests)
    suite = ElementTree.SubElement(root, "testsuite", name=_escape_attribute(name), tests=str(len(tests)))
    for attribute, counted in (("failures", "failure"), ("errors", "error"), ("skipped", "skipped")):
        suite.set(attribute, str(outcomes[counted]))
    suite.set("time", f"{seconds:.3f}")
    if file:
        suite.set("file", _escape_attribute(file))
    # Jenkins reads the part before the last dot as a package, and merges two tests of one name.
    group = f"urdfcheck.{_escape_attribute(name).replace('.', '_')}"
    counts: dict[str, int] = {}
    for case in tests:
        number = counts[case.name] = counts.get(case.name, 0) + 1
        numbered = case.name if number == 1 else f"{case.name} ({number})"
        test = ElementTree.SubElement(suite, "testcase", classname=group, name=_escape_attribute(numbered))
        if case.outcome == "passed":
            if case.text:
                ElementTree.SubElement(test, "system-out").text = _escape_text(case.text)
            continue
        outcome = ElementTree.SubElement(
            test, case.outcome, type=_escape_attribute(case.failure_type), message=_escape_attribute(case.message)
        )
        outcome.text = _escape_text(case.text) or None


def _escape_attribute(text: str) -> str:
    return _NO_XML.sub("\ufffd", escape_one_line(text))


def _escape_text(text: str) -> str:
    return _NO_XML.sub("\ufffd", escape_invisible(text))
