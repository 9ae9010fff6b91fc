"""What happens to a finding between the check that reports it and the report.

Each finding that a check reports is admitted (`admit_finding`). When all checks of a unit ran, `finalize_unit_findings` makes
its findings ready to leave the worker process. When all units are done, `finalize_run_findings` does the same for the whole run.
The steps themselves are functions of the policy room; their order is decided here only. Two things pass a step: findings about
urdfcheck itself (a check that crashed, an audit that was stopped) have no policy and are not admitted, and ``urdfcheck audit``,
which keeps each of its models apart, leaves out the stage of the whole run.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from collections.abc import Set as AbstractSet
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING, Any

from urdfcheck.core import Finding, Rule, Severity, SkippedCheck, Span
from urdfcheck.core.merging import merge_same_text
from urdfcheck.core.records import dataclass
from urdfcheck.core.text import format_argument_option, format_count, join_names
from urdfcheck.model.gazebo import is_posed
from urdfcheck.policy.consumers import SIMULATORS, apply_severity_policy
from urdfcheck.policy.fix_safety import lead_to_xacro, mark_unsafe_across_models, mark_unsafe_in_model
from urdfcheck.policy.on_request import (
    leave_out_dynamics,
    leave_out_unfelt_dynamics,
    list_argument_names,
    split_for_tests,
    split_replaced_defaults,
    split_unrequested,
)
from urdfcheck.policy.policy import Policy
from urdfcheck.policy.report_limits import MAX_FINDINGS_SIZE, limit_number, limit_size, truncate_texts
from urdfcheck.policy.superseding import drop_superseded, join_explained, list_held_back
from urdfcheck.policy.suppression import mark_suppressed
from urdfcheck.rules import load_rules
from urdfcheck.run.jobs import Unit, UnitReport
from urdfcheck.run.shared_findings import merge_across_models, merge_copies, merge_kinds, merge_macro_lines
from urdfcheck.run.typed_places import locate_typed_values
from urdfcheck.source.text.suppression_comments import IgnoreComment
from urdfcheck.source.text.xml import Element

if TYPE_CHECKING:
    from urdfcheck.model.use.started_variants import StartedVariant


def admit_finding(finding: Finding, rule: Rule, policy: Policy) -> Finding:
    """Give a finding the severity that the configuration wants, and bound its length.

    Called as soon as a check reports it: a thousand findings about a name of a million letters must not pile up.
    """
    finding = apply_severity_policy(
        finding, rule, targets=policy.targets, severities=policy.severities, is_pedantic=policy.pedantic
    )
    return truncate_texts(finding)


@dataclass(frozen=True, slots=True)
class FinalFindings:
    """The findings of a unit as its report holds them."""

    findings: tuple[Finding, ...]
    unrequested: tuple[Finding, ...]
    """Notes on request only: they are not reported, but what they say about programs counts."""
    needed_comments: frozenset[Span]
    """Comments in the source that suppress some of them."""
    size: int
    """Bytes that they take."""
    unlisted: tuple[SkippedCheck, ...]
    """Rules of which more findings were reported than the report lists."""


# The code and the message of findings.
Kind = tuple[str, str]
KindsFinder = Callable[[AbstractSet[Kind]], "tuple[AbstractSet[Kind], Sequence[StartedVariant]]"]
# How many of the options with which to check a model are written out.
_MOST_OPTIONS = 3
# What a report says of models that are data of tests, and of those that are kept and not used.
_FOR_TESTS = (
    "of test data only what urdfdom or a target rejects or reads otherwise is reported; name the file to see all"
)
_KEPT_ASIDE = (
    "of old copies and files in folders such as `old` or `third_party` only what stops the check is reported; name the file to "
    "see all"
)
_LEFT_OVER = "left over: no file of the project names it; give the path to urdfcheck to see all"


def finalize_unit_findings(
    findings: Iterable[Finding],
    *,
    unit: Unit,
    policy: Policy,
    rules: Mapping[str, Rule],
    comments: Iterable[IgnoreComment],
    root: Element | None,
    texts: Mapping[str, str] | None = None,
    joins_simulated: bool = True,
    find_replaced_defaults: Callable[[AbstractSet[str]], Mapping[str, Path]] | None = None,
    find_kinds_of_defaults: KindsFinder | None = None,
) -> FinalFindings:
    """Turn the admitted findings of one unit into those of its report.

    ``rules``: the rules that ran; ``comments``: suppression comments of its files; ``root``: the expanded model, if any;
    ``texts``: its files by name; ``joins_simulated``: whether what a simulation shows is joined to the finding that explains it;
    ``find_replaced_defaults``: returns those of the model's arguments whose defaults no file that starts it leaves as they are,
    each with such a file. ``find_kinds_of_defaults``: returns those of the kinds of findings that the model has with its defaults
    and not as it is started, and how it is started then.
    """
    located = locate_typed_values(list(findings), root, texts or {})
    # Before merging: of six links that one macro line makes, a single one may be suppressed.
    marked, needed = mark_suppressed(
        located,
        comments=comments,
        entries=policy.suppress,
        baseline_entries=unit.baseline_entries,
        baseline_excesses=unit.baseline_excesses,
    )
    if policy.kinematics_only:
        marked = leave_out_dynamics(marked, rules)
    elif root is not None and is_posed(root) and (SIMULATORS - {"gazebo"}).isdisjoint(policy.targets):
        marked = leave_out_unfelt_dynamics(marked, rules)
    replaced = _find_replaced_defaults(marked, find_replaced_defaults)
    kinds, variants = _find_kinds_of_defaults(marked, find_kinds_of_defaults)
    marked, of_defaults = split_replaced_defaults(
        marked,
        rules,
        replaced=replaced.keys(),
        kinds=kinds,
        unrequested=frozenset() if policy.pedantic else policy.unrequested,
        graded=policy.severities.keys(),
    )
    merged = merge_macro_lines(merge_same_text(marked), root, texts or {})
    remaining = drop_superseded(merged, rules)
    if joins_simulated:
        remaining = join_explained(remaining, rules)
    wanted, unrequested = _split_unrequested(remaining, rules, policy)
    unrequested += of_defaults
    safe = mark_unsafe_in_model(wanted, root)
    listed, unlisted = limit_number(sorted(safe, key=get_sort_key))
    skips = [
        SkippedCheck(
            code,
            unit.id,
            f"{severity}s not listed: {count:,}",
            is_partial=True,
        )
        for (code, severity), count in unlisted.items()
    ]
    skips += [
        SkippedCheck(code, unit.id, f"what it reports waits for the repair of {finding.code}", is_partial=True)
        for finding in remaining
        for code in list_held_back(finding)
    ]
    if of_defaults:
        skips.append(
            SkippedCheck(SkippedCheck.DEFAULTS, unit.id, _describe_defaults(replaced, variants), is_partial=True)
        )
    if policy.is_for_tests and _hides_problems(remaining, rules, policy):
        code = SkippedCheck.FINDINGS if policy.is_kept_aside else SkippedCheck.WARNINGS
        reason = _LEFT_OVER if policy.is_left_over else _KEPT_ASIDE if policy.is_kept_aside else _FOR_TESTS
        skips.append(SkippedCheck(code, unit.id, reason, is_partial=True))
    small, size = limit_size(listed, MAX_FINDINGS_SIZE)
    skips += explain_left_out(
        unit.id, listed, small, f"those of one model take more than {MAX_FINDINGS_SIZE // 1024**2} MiB"
    )
    return FinalFindings(
        findings=tuple(small),
        unrequested=tuple(limit_number(sorted(unrequested, key=get_sort_key))[0]),
        needed_comments=frozenset(needed),
        size=size,
        unlisted=tuple(skips),
    )


def _find_replaced_defaults(
    findings: Iterable[Finding], find: Callable[[AbstractSet[str]], Mapping[str, Path]] | None
) -> Mapping[str, Path]:
    """Return the arguments that errors and warnings are about and whose defaults no file that starts the model leaves."""
    names = {name for f in findings if f.severity > Severity.INFO for name in list_argument_names(f)}
    return {} if find is None or not names else find(names)


def _find_kinds_of_defaults(
    findings: Iterable[Finding], find: KindsFinder | None
) -> tuple[AbstractSet[Kind], Sequence[StartedVariant]]:
    """Return the kinds of errors and warnings that a model has with its defaults alone, and how it is started. A finding that
    names the declaration of an argument is about the default itself."""
    kinds = {
        (finding.code, finding.message_id)
        for finding in findings
        if finding.severity > Severity.INFO and not finding.blocks_check
        if not any(place.subject.startswith("xacro:arg[") for place in finding.related)
    }
    return (frozenset(), ()) if find is None or not kinds else find(kinds)


def _describe_defaults(replaced: Mapping[str, Path], variants: Sequence[StartedVariant]) -> str:
    """Say why what defaults cause is not listed, and how to check the model with what it is started with."""
    # One start at a time: the values of several need not go together.
    values = variants[0].arguments if variants else {}
    starters = [*(variant.starter for variant in variants), *replaced.values()]
    names = sorted({*values, *replaced})
    defaults, others = ("default", "another value") if len(names) == 1 else ("defaults", "other values")
    options = " ".join(format_argument_option(name, values.get(name)) for name in names[:_MOST_OPTIONS])
    return (
        f"what comes from the {defaults} of {join_names(names, 4)}; {starters[0].name} passes {others}: "
        f"check with these, {options}"
    )


def explain_left_out(
    unit_id: str, findings: Sequence[Finding], kept: Sequence[Finding], why: str
) -> list[SkippedCheck]:
    """Return a line for each rule of which a report leaves out findings because of their size."""
    counts = Counter(finding.code for finding in findings)
    counts.subtract(finding.code for finding in kept)
    return [
        SkippedCheck(code, unit_id, f"{format_count(count, 'more finding')} not listed: {why}", is_partial=True)
        for code, count in sorted(counts.items())
        if count
    ]


def finalize_run_findings(
    audited_units: Sequence[tuple[Unit, UnitReport]],
    policy: Policy,
    *,
    across_models: Iterable[Finding],
    review: Callable[[Sequence[Finding], AbstractSet[Span]], Iterable[Finding]],
) -> tuple[tuple[Finding, ...], tuple[Finding, ...]]:
    """Turn the findings of all units, and those about several of them, into those of the run.

    ``policy``: settings of the run, for units without their own; ``across_models``: what rules of scope ``run`` report.
    ``review`` gets all findings so far and the suppression comments that the former need; it returns the findings about
    comments, baselines and configurations. Also returned are the notes about several models that are left out.
    """
    policies = {unit.id: unit.policy or policy for unit, _ in audited_units}
    rules = load_rules()

    def admit_wanted(findings: Iterable[Finding]) -> list[Finding]:
        owners = ((finding, policies.get(finding.model, policy)) for finding in findings)
        return [admit_finding(f, rules[f.code], owner) for f, owner in owners if f.code in owner.codes]

    wanted = admit_wanted(across_models)
    marked, needed = _suppress_by_model(wanted, audited_units, policies)
    asked, unrequested = _split_by_model(merge_same_text(marked), policies)
    findings = [*(finding for _, report in audited_units for finding in report.findings), *asked]
    findings += admit_wanted(review(findings, needed))
    findings = mark_unsafe_across_models(findings, _list_users(audited_units))
    units = [unit for unit, _ in audited_units]
    # Last: all before is about single texts, and each occurrence stays what it was.
    digests = {name: digest for _, report in audited_units for name, digest in report.digests.items()}
    findings = merge_kinds(merge_copies(merge_across_models(findings, units), units, digests), units)
    sources = {name: source for _, report in audited_units for name, source in report.xacro_sources.items()}
    # Those about several models know which of two files is the source.
    findings = [f if "run" in rules[f.code].scopes else lead_to_xacro(f, sources) for f in findings]
    return tuple(sorted(findings, key=get_sort_key)), tuple(unrequested)


def _suppress_by_model(
    findings: Iterable[Finding], audited_units: Iterable[tuple[Unit, UnitReport]], policies: Mapping[str, Policy]
) -> tuple[list[Finding], set[Span]]:
    """Mark the findings about several models that comments, configuration or baseline of their model suppress.

    Also return the comments that are needed for it.
    """
    audited = {unit.id: (unit, report) for unit, report in audited_units}
    marked: list[Finding] = []
    needed: set[Span] = set()
    for model, group in groupby(sorted(findings, key=lambda f: f.model), key=lambda f: f.model):
        unit, report = audited[model]
        comments = [usage.comment for usage in report.comments]
        marked_group, needed_here = mark_suppressed(
            list(group),
            comments=comments,
            entries=policies[model].suppress,
            baseline_entries=unit.baseline_entries,
            baseline_excesses=unit.baseline_excesses,
        )
        marked += marked_group
        needed |= needed_here
    return marked, needed


def _split_by_model(findings: Iterable[Finding], policies: Mapping[str, Policy]) -> tuple[list[Finding], list[Finding]]:
    """Do the same as `split_unrequested` for findings about several models, with the settings of the model of each."""
    rules = load_rules()
    reported: list[Finding] = []
    left_out: list[Finding] = []
    for finding in findings:
        asked, unasked = _split_unrequested([finding], rules, policies[finding.model])
        reported += asked
        left_out += unasked
    return reported, left_out


def _split_unrequested(
    findings: Iterable[Finding], rules: Mapping[str, Rule], policy: Policy
) -> tuple[list[Finding], list[Finding]]:
    unasked = frozenset() if policy.pedantic else policy.unrequested
    if policy.is_for_tests and not policy.pedantic:
        graded = policy.severities.keys()
        return split_for_tests(
            findings,
            unrequested=unasked,
            graded=graded,
            targets=policy.targets,
            keeps_errors=not policy.is_kept_aside,
        )
    return split_unrequested(findings, rules, unrequested=unasked, targets=policy.targets)


def _hides_problems(findings: Iterable[Finding], rules: Mapping[str, Rule], policy: Policy) -> bool:
    """Whether errors or warnings are among the notes on request."""
    problems = (finding for finding in findings if finding.severity > Severity.INFO)
    return bool(_split_unrequested(problems, rules, policy)[1])


def _list_users(audited_units: Iterable[tuple[Unit, UnitReport]]) -> dict[str, set[str]]:
    """Return for each file the ids of the models that it is part of."""
    users: dict[str, set[str]] = {}
    for unit, report in audited_units:
        for name in report.files:
            users.setdefault(name, set()).add(unit.id)
    return users


def get_sort_key(finding: Finding) -> tuple[Any, ...]:
    """Return the sort key of reports: model, file and position, the most severe first, then code, message and subjects."""
    span = finding.location.span
    place = ("", 0, 0) if span is None else (span.file, span.line, span.col)
    return (finding.model, *place, -finding.severity, finding.code, finding.message_id, finding.subjects)
