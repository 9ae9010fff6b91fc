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
from urdfcheck.output.shared.code_frames import frame
from urdfcheck.output.shared.diffs import rows
from urdfcheck.output.shared.inert import for_xml, one_line, visible
from urdfcheck.output.shared.wording import details, place

BESIDE = "launch files and packages"
STATUS = {
    "needs-arguments": "not checked: the model cannot be expanded without arguments",
    "failed": "not checked: the model could not be expanded; the findings say why",
}
LONGEST_LINE = 200
# XML has no way to say these; other controls are spelled out already.
_NO_XML = re.compile("[\ufffe\uffff]")


@dataclass(frozen=True, slots=True)
class Case:
    """A test. ``outcome``: passed | failure | error | skipped, with a type, a line and a text."""

    name: str
    outcome: str = "passed"
    kind: str = ""
    message: str = ""
    text: str = ""


def render(run: Run) -> str:
    """An XML document. Only ``time`` differs between equal runs."""
    root = ElementTree.Element("testsuites", name="urdfcheck")
    for info in run.models:
        _add(root, info.id, _model_cases(run, info), seconds=info.seconds, file=info.path)
    _add(root, BESIDE, _other_cases(run))
    _add(root, "urdfcheck", _own_cases(run))
    for name in ("tests", "failures", "errors"):
        root.set(name, str(sum(int(suite.get(name, "0")) for suite in root)))
    root.set("time", f"{run.seconds:.3f}")
    ElementTree.indent(root)
    return for_xml(f'<?xml version="1.0" encoding="UTF-8"?>\n{ElementTree.tostring(root, encoding="unicode")}\n')


# -- what is a test ----------------------------------------------------------------------------------------------------


def _model_cases(run: Run, info: ModelInfo) -> Iterator[Case]:
    found = [finding for finding in run.findings if finding.model == info.id]
    yield from _found(run, found)
    if info.status == "checked":
        yield from _passed(run, info.id, {finding.code for finding in found}, {"file", "model"})
    else:
        yield Case("the model is checked", "skipped", info.status, STATUS.get(info.status, info.status))
    yield from _skipped(run, {info.id})


def _other_cases(run: Run) -> Iterator[Case]:
    """Of launch files and packages, and of whatever else belongs to no model."""
    models = {info.id for info in run.models}
    found = [finding for finding in run.findings if finding.model not in models]
    yield from _found(run, found)
    for name in sorted(run.ids - models):
        scopes = {"package"} if name.rsplit("/", 1)[-1] == "package.xml" else {"launch"}
        yield from _passed(run, name, {f.code for f in found if f.model == name}, scopes, of=f" {name}")
    yield from _skipped(run, {skip.model for skip in run.skipped} - models)


def _own_cases(run: Run) -> Iterator[Case]:
    for number, failure in enumerate(run.failures, 1):
        yield Case(f"urdfcheck itself ({number})", "error", "urdfcheck", _first_line(failure), failure)
    if not run.units and not run.failures:
        yield Case("there is something to check", "skipped", "nothing", "no model, launch file or package was found")


def _found(run: Run, findings: Iterable[Finding]) -> Iterator[Case]:
    for finding in findings:
        text = "\n".join(_told(run, finding))
        for subject in finding.subjects or ("",):
            name = f"{finding.code} {finding.name} {subject}".strip()
            if finding.suppressed is not None:
                yield Case(name, "skipped", "known", f"known, {finding.suppressed}: {_first_line(finding.message)}")
            elif _fails(run, finding):
                yield Case(name, "failure", finding.code, _first_line(finding.message), text)
            else:
                yield Case(name, text=text)


def _passed(run: Run, unit: str, fired: set[str], scopes: set[str], of: str = "") -> Iterator[Case]:
    """The rules that ran on a unit and found nothing there."""
    skipped = {skip.code for skip in run.skipped if skip.model == unit}
    ran = set() if "ALL" in skipped else run.judged.get(unit, frozenset()) - skipped - fired
    for code in sorted(ran & run.rules.keys()):
        if scopes & set(run.rules[code].scopes):
            yield Case(f"{code} {run.rules[code].name}{of}")


def _skipped(run: Run, units: set[str]) -> Iterator[Case]:
    for skip in run.skipped:
        if skip.model in units:
            rule = run.rules.get(skip.code)
            name = "all rules" if skip.code == "ALL" else skip.code if rule is None else f"{rule.code} {rule.name}"
            yield Case(name, "skipped", "skipped", skip.reason)


def _fails(run: Run, finding: Finding) -> bool:
    """Whether it fails the run, as the exit code does."""
    levels = set(run.fail_on.values())
    # What belongs to no unit fails from where all of them do.
    fail_on = run.fail_on.get(finding.model, next(iter(levels)) if len(levels) == 1 else "error")
    return fail_on != "never" and finding.severity >= Severity.parse(fail_on)


# -- what is said of it ------------------------------------------------------------------------------------------------


def _told(run: Run, finding: Finding) -> Iterator[str]:
    """The place, the message, the lines of the source, why and what to do."""
    span = finding.location.span
    where = "" if span is None else f"{place(span)}: "
    yield f"{where}{finding.severity} {finding.code} {finding.name}"
    yield finding.message
    if span is not None:
        for line in frame(run.sources.get(span.file, ""), span):
            yield f"{'>' if line.marked else ' '} {line.number:>5} | {line.text[:LONGEST_LINE]}"
        yield from (f"from {place(call)}" for call in reversed(finding.location.via))
    for label, text in details(run, finding):
        yield f"{label}: {text}"
    if finding.fix is not None:
        yield from (line[:LONGEST_LINE] for _, line in rows(run.sources, finding.fix.edits))


def _first_line(text: str) -> str:
    return text.partition("\n")[0]


# -- XML ---------------------------------------------------------------------------------------------------------------


def _add(root: ElementTree.Element, name: str, cases: Iterable[Case], *, seconds: float = 0.0, file: str = "") -> None:
    """A suite with these cases; none without any."""
    tests = list(cases)
    if not tests:
        return
    outcomes = Counter(case.outcome for case in tests)
    suite = ElementTree.SubElement(root, "testsuite", name=_attribute(name), tests=str(len(tests)))
    for key, outcome in (("failures", "failure"), ("errors", "error"), ("skipped", "skipped")):
        suite.set(key, str(outcomes[outcome]))
    suite.set("time", f"{seconds:.3f}")
    if file:
        suite.set("file", _attribute(file))
    # Jenkins takes what stands before the last dot for a package, and two tests of one name for one.
    group = f"urdfcheck.{_attribute(name).replace('.', '_')}"
    seen: dict[str, int] = {}
    for case in tests:
        seen[case.name] = seen.get(case.name, 0) + 1
        numbered = case.name if seen[case.name] == 1 else f"{case.name} ({seen[case.name]})"
        test = ElementTree.SubElement(suite, "testcase", classname=group, name=_attribute(numbered))
        if case.outcome == "passed":
            if case.text:
                ElementTree.SubElement(test, "system-out").text = _text(case.text)
            continue
        said = ElementTree.SubElement(test, case.outcome, type=_attribute(case.kind), message=_attribute(case.message))
        said.text = _text(case.text) or None


def _attribute(text: str) -> str:
    return _NO_XML.sub("\ufffd", one_line(text))


def _text(text: str) -> str:
    return _NO_XML.sub("\ufffd", visible(text))
