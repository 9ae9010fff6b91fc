"""Findings as tests for a build server: JUnit's XML, as the strict schema of Jenkins' xUnit plugin takes it.

A suite for each model and one for launch files and packages; a case for each element that a rule found something wrong with,
and one that passes for each rule that ran and found nothing. What fails the run is a failure; the rest passes, and says so.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from xml.etree import ElementTree

from urdfcheck.core import Finding, ModelInfo, Run, Severity
from urdfcheck.output.shared.code_frames import extract_code_frame
from urdfcheck.output.shared.diffs import iter_diff_lines
from urdfcheck.output.shared.inert import escape_for_xml, escape_invisible, escape_one_line
from urdfcheck.output.shared.wording import format_place, iter_details

OTHER_SUITE = "launch files and packages"
STATUS_TEXTS = {
    "needs-arguments": "not checked: the model cannot be expanded without arguments",
    "failed": "not checked: the model could not be expanded; the findings say why",
}
LONGEST_LINE = 200
# XML has no way to say these; other controls are spelled out already.
_NO_XML = re.compile("[\ufffe\uffff]")


@dataclass(frozen=True, slots=True)
class JUnitCase:
    """A test. ``outcome``: passed | failure | error | skipped, with a type, a line and a text."""

    name: str
    outcome: str = "passed"
    failure_type: str = ""
    message: str = ""
    text: str = ""


def render(run: Run) -> str:
    """An XML document. Only ``time`` differs between equal runs."""
    root = ElementTree.Element("testsuites", name="urdfcheck")
    for info in run.models:
        _add_suite(root, info.id, _iter_model_cases(run, info), seconds=info.seconds, file=info.path)
    _add_suite(root, OTHER_SUITE, _iter_other_cases(run))
    _add_suite(root, "urdfcheck", _iter_urdfcheck_cases(run))
    for name in ("tests", "failures", "errors"):
        root.set(name, str(sum(int(suite.get(name, "0")) for suite in root)))
    root.set("time", f"{run.seconds:.3f}")
    ElementTree.indent(root)
    return escape_for_xml(f'<?xml version="1.0" encoding="UTF-8"?>\n{ElementTree.tostring(root, encoding="unicode")}\n')


# -- what is a test ----------------------------------------------------------------------------------------------------


def _iter_model_cases(run: Run, info: ModelInfo) -> Iterator[JUnitCase]:
    found = [finding for finding in run.findings if finding.model == info.id]
    yield from _iter_finding_cases(run, found)
    if info.status == "checked":
        yield from _iter_passed_cases(run, info.id, {finding.code for finding in found}, {"file", "model"})
    else:
        yield JUnitCase("the model is checked", "skipped", info.status, STATUS_TEXTS.get(info.status, info.status))
    yield from _iter_skipped_cases(run, {info.id})


def _iter_other_cases(run: Run) -> Iterator[JUnitCase]:
    """Of launch files and packages, and of whatever else belongs to no model."""
    models = {info.id for info in run.models}
    found = [finding for finding in run.findings if finding.model not in models]
    yield from _iter_finding_cases(run, found)
    for name in sorted(run.unit_ids - models):
        scopes = {"package"} if name.rsplit("/", 1)[-1] == "package.xml" else {"launch"}
        yield from _iter_passed_cases(run, name, {f.code for f in found if f.model == name}, scopes, suffix=f" {name}")
    yield from _iter_skipped_cases(run, {skip.model for skip in run.skipped} - models)


def _iter_urdfcheck_cases(run: Run) -> Iterator[JUnitCase]:
    for number, failure in enumerate(run.failures, 1):
        yield JUnitCase(f"urdfcheck itself ({number})", "error", "urdfcheck", _get_first_line(failure), failure)
    if not run.units and not run.failures:
        yield JUnitCase(
            "there is something to check", "skipped", "nothing", "no model, launch file or package was found"
        )


def _iter_finding_cases(run: Run, findings: Iterable[Finding]) -> Iterator[JUnitCase]:
    for finding in findings:
        text = "\n".join(_iter_detail_lines(run, finding))
        for subject in finding.subjects or ("",):
            name = f"{finding.code} {finding.name} {subject}".strip()
            if finding.suppressed is not None:
                yield JUnitCase(
                    name, "skipped", "known", f"known, {finding.suppressed}: {_get_first_line(finding.message)}"
                )
            elif _is_failing(run, finding):
                yield JUnitCase(name, "failure", finding.code, _get_first_line(finding.message), text)
            else:
                yield JUnitCase(name, text=text)


def _iter_passed_cases(run: Run, unit: str, fired: set[str], scopes: set[str], suffix: str = "") -> Iterator[JUnitCase]:
    """The rules that ran on a unit and found nothing there."""
    skipped = {skip.code for skip in run.skipped if skip.model == unit}
    ran = set() if "ALL" in skipped else run.complete_rules.get(unit, frozenset()) - skipped - fired
    for code in sorted(ran & run.rules.keys()):
        if scopes & set(run.rules[code].scopes):
            yield JUnitCase(f"{code} {run.rules[code].name}{suffix}")


def _iter_skipped_cases(run: Run, units: set[str]) -> Iterator[JUnitCase]:
    for skip in run.skipped:
        if skip.model in units:
            rule = run.rules.get(skip.code)
            name = "all rules" if skip.code == "ALL" else skip.code if rule is None else f"{rule.code} {rule.name}"
            yield JUnitCase(name, "skipped", "skipped", skip.reason)


def _is_failing(run: Run, finding: Finding) -> bool:
    """Whether it fails the run, as the exit code does."""
    levels = set(run.fail_on.values())
    # What belongs to no unit fails from where all of them do.
    fail_on = run.fail_on.get(finding.model, next(iter(levels)) if len(levels) == 1 else "error")
    return fail_on != "never" and finding.severity >= Severity.parse(fail_on)


# -- what is said of it ------------------------------------------------------------------------------------------------


def _iter_detail_lines(run: Run, finding: Finding) -> Iterator[str]:
    """The place, the message, the lines of the source, why and what to do."""
    span = finding.location.span
    where = "" if span is None else f"{format_place(span)}: "
    yield f"{where}{finding.severity} {finding.code} {finding.name}"
    yield finding.message
    if span is not None:
        for line in extract_code_frame(run.sources.get(span.file, ""), span):
            yield f"{'>' if line.marked else ' '} {line.number:>5} | {line.text[:LONGEST_LINE]}"
        yield from (f"from {format_place(call)}" for call in reversed(finding.location.via))
    for label, text in iter_details(run, finding):
        yield f"{label}: {text}"
    if finding.fix is not None:
        yield from (line[:LONGEST_LINE] for _, line in iter_diff_lines(run.sources, finding.fix.edits))


def _get_first_line(text: str) -> str:
    return text.partition("\n")[0]


# -- XML ---------------------------------------------------------------------------------------------------------------


def _add_suite(
    root: ElementTree.Element, name: str, cases: Iterable[JUnitCase], *, seconds: float = 0.0, file: str = ""
) -> None:
    """A suite with these cases; none without any."""
    tests = list(cases)
    if not tests:
        return
    outcomes = Counter(case.outcome for case in tests)
    suite = ElementTree.SubElement(root, "testsuite", name=_escape_attribute(name), tests=str(len(tests)))
    for key, outcome in (("failures", "failure"), ("errors", "error"), ("skipped", "skipped")):
        suite.set(key, str(outcomes[outcome]))
    suite.set("time", f"{seconds:.3f}")
    if file:
        suite.set("file", _escape_attribute(file))
    # Jenkins takes what stands before the last dot for a package, and two tests of one name for one.
    group = f"urdfcheck.{_escape_attribute(name).replace('.', '_')}"
    seen: dict[str, int] = {}
    for case in tests:
        seen[case.name] = seen.get(case.name, 0) + 1
        numbered = case.name if seen[case.name] == 1 else f"{case.name} ({seen[case.name]})"
        test = ElementTree.SubElement(suite, "testcase", classname=group, name=_escape_attribute(numbered))
        if case.outcome == "passed":
            if case.text:
                ElementTree.SubElement(test, "system-out").text = _escape_text(case.text)
            continue
        said = ElementTree.SubElement(
            test, case.outcome, type=_escape_attribute(case.failure_type), message=_escape_attribute(case.message)
        )
        said.text = _escape_text(case.text) or None


def _escape_attribute(text: str) -> str:
    return _NO_XML.sub("\ufffd", escape_one_line(text))


def _escape_text(text: str) -> str:
    return _NO_XML.sub("\ufffd", escape_invisible(text))
