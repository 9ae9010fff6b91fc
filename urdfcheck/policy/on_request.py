"""What the pages let a reader leave out: notes that are reported only on request, and what matters to dynamics alone."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import replace

from urdfcheck.core import Finding, Rule, Severity, Verdict
from urdfcheck.policy.consumers import get_verdict, is_news

# Rules about paths that lead nowhere on another machine, or where a package is not installed, and about files that xacro expands
# before they are used.
_OF_ANOTHER_PLACE = frozenset({"PKG001", "PKG004", "XML009"})
# The parser of ROS, through which most tests read a model.
_PARSER = "urdfdom"
# What the subject of an argument of xacro begins with.
_ARGUMENT = "argument["


def split_unrequested(
    findings: Iterable[Finding], rules: Mapping[str, Rule], *, unrequested: frozenset[str], targets: Sequence[str]
) -> tuple[list[Finding], list[Finding]]:
    """Split findings into those of the report and the notes that were not asked for.

    A note of a message that its page lists under ``on_request`` is reported if its rule is not among the ``unrequested`` codes,
    or if it matters to a target. Errors and warnings are always reported. A suppressed note stays, because its suppression is
    in use.
    """
    reported: list[Finding] = []
    left_out: list[Finding] = []
    for finding in findings:
        is_wanted = (
            finding.severity > Severity.INFO
            or finding.suppressed is not None
            or finding.code not in unrequested
            or finding.message_id not in rules[finding.code].on_request
            or any(_matters_to(target, finding, rules[finding.code]) for target in targets)
        )
        (reported if is_wanted else left_out).append(finding)
    return reported, left_out


def split_for_tests(
    findings: Iterable[Finding],
    *,
    unrequested: frozenset[str],
    graded: AbstractSet[str],
    targets: Sequence[str],
    keeps_errors: bool = True,
) -> tuple[list[Finding], list[Finding]]:
    """Do the same for the findings of a model that is data of tests, of which all but errors are notes on request.

    So are errors of what a test does not need: it runs where the file is, and reads of it what it asks for. Its errors are those
    for which the parser or a target does not load what is typed. So are all errors of a model that is kept and not used
    (``keeps_errors``). What stops the check of a model stays. ``graded``: codes whose severity is given.
    """
    readers = (_PARSER, *targets)
    reported: list[Finding] = []
    left_out: list[Finding] = []
    for finding in findings:
        is_misread = any(get_verdict(finding.consequences, reader) > Verdict.LOADS for reader in readers)
        is_error = finding.severity == Severity.ERROR and is_misread and finding.code not in _OF_ANOTHER_PLACE
        if (
            (is_error and keeps_errors)
            or finding.suppressed is not None
            or finding.blocks_check
            or finding.code in graded
        ):
            reported.append(finding)
        else:
            note = replace(finding, severity=min(finding.severity, Severity.INFO))
            (left_out if finding.code in unrequested else reported).append(note)
    return reported, left_out


def list_argument_names(finding: Finding) -> list[str]:
    """List the arguments of the model whose values a finding is about, by the places that it names."""
    subjects = (place.subject for place in (finding.location, *finding.related))
    return [subject[len(_ARGUMENT) : -1] for subject in subjects if subject.startswith(_ARGUMENT)]


def split_replaced_defaults(
    findings: Iterable[Finding],
    rules: Mapping[str, Rule],
    *,
    replaced: AbstractSet[str],
    kinds: AbstractSet[tuple[str, str]],
    unrequested: frozenset[str],
    graded: AbstractSet[str],
) -> tuple[list[Finding], list[Finding]]:
    """Split off the errors and warnings that defaults of arguments cause which no file that starts the model leaves as they are:
    these are notes on request. ``replaced``: these arguments; ``kinds``: codes and messages that the model does not have as it is
    started; ``graded``: codes whose severity is given.

    If one of them is about a mass or an inertia, so is what the masses of the whole robot lead to, for it starts with others.
    """
    listed = list(findings)
    caused = [finding for finding in listed if not replaced.isdisjoint(list_argument_names(finding))]
    if any(_is_of_dynamics(finding, rules) for finding in caused):
        caused += [f for f in listed if f.location.subject.startswith("robot[") and _is_of_dynamics(f, rules)]
    caused += [finding for finding in listed if (finding.code, finding.message_id) in kinds]
    aside = {id(finding) for finding in caused}
    reported: list[Finding] = []
    left_out: list[Finding] = []
    for finding in listed:
        is_kept = finding.severity == Severity.INFO or finding.suppressed is not None or finding.blocks_check
        if is_kept or id(finding) not in aside or finding.code in graded:
            reported.append(finding)
        else:
            note = replace(finding, severity=Severity.INFO)
            (left_out if finding.code in unrequested else reported).append(note)
    return reported, left_out


def _is_of_dynamics(finding: Finding, rules: Mapping[str, Rule]) -> bool:
    return finding.message_id in rules[finding.code].dynamics


def find_postponed(rules: Mapping[str, Rule], *, unrequested: Iterable[str], targets: Sequence[str]) -> frozenset[str]:
    """Return the codes of the rules that take long to find what is not reported: collisions that are notes on request, of rules
    that are not asked for (``unrequested``) and that matter to no target.

    The notes of other rules cost little beside what is computed anyway, and are counted.
    """
    return frozenset(
        code
        for code in unrequested
        if "collision" in rules[code].needs
        and rules[code].severity is Severity.INFO
        and rules[code].on_request == rules[code].messages.keys()
        and not any(_may_matter_to(target, rules[code]) for target in targets)
    )


def leave_out_dynamics(findings: Iterable[Finding], rules: Mapping[str, Rule]) -> list[Finding]:
    """Leave out what the pages list under ``dynamics``: the models are for display and motion planning alone."""
    return [finding for finding in findings if not _is_of_dynamics(finding, rules)]


def leave_out_unfelt_dynamics(findings: Iterable[Finding], rules: Mapping[str, Rule]) -> list[Finding]:
    """Leave out the same of a model that no force moves in Gazebo, unless Gazebo loses a part of it."""
    return [
        finding
        for finding in findings
        if not _is_of_dynamics(finding, rules) or get_verdict(finding.consequences, "gazebo") >= Verdict.DROPS
    ]


def _matters_to(target: str, finding: Finding, rule: Rule) -> bool:
    """Whether a target does more with the defect than loading it, or is among the programs that the rule concerns."""
    return target in rule.concerns or is_news(finding.consequences.get(target, "loads it"))


def _may_matter_to(target: str, rule: Rule) -> bool:
    """Whether a finding of a rule may matter to a target, whatever its message."""
    tables = [rule.consumers, *(table for table in rule.consumers.values() if not isinstance(table, str))]
    return target in rule.concerns or any(is_news(table[target]) for table in tables if target in table)
