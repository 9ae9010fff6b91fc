"""What happens to a finding between the check that reports it and the report, step by step and without a process."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from urdfcheck.core import Applicability, Edit, Finding, Location, Severity, Span
from urdfcheck.policy import report_limits
from urdfcheck.policy.policy import Policy
from urdfcheck.policy.report_limits import MAX_EDIT_LENGTH, MAX_TEXT_LENGTH
from urdfcheck.policy.suppression import SuppressionEntry, assess_comment
from urdfcheck.rules import load_rules
from urdfcheck.run.findings import (
    FinalFindings,
    admit_finding,
    finalize_run_findings,
    finalize_unit_findings,
    get_sort_key,
)
from urdfcheck.run.jobs import Unit, UnitReport
from urdfcheck.source.text.suppression_comments import IgnoreComment
from urdfcheck.source.text.xml import Element, SourceFile, parse_xml

RULES = load_rules()
EVERYTHING = Policy(codes=frozenset(RULES))
UNIT = Unit(kind="model", path="r.urdf", id="r.urdf")


def place(start: int, end: int | None = None, file: str = "r.urdf") -> Span:
    """A piece of the first line."""
    end = start + 1 if end is None else end
    return Span(file, 1, start + 1, 1, end + 1, start, end)


def inertia(
    link: str, code: str = "INR003", *, at: int = 0, model: str = UNIT.id, edits: Sequence[Edit] = (), **changes: Any
) -> Finding:
    """A finding about the inertia of a link."""
    location = Location(f"link[{link}]/inertial/inertia", changes.pop("span", place(at)))
    found = RULES[code].finding("helper", at=location, links=link, edits=edits, applicability=Applicability.SAFE)
    return replace(found, model=model, **changes)


def comment(start: int, end: int, selector: str = "INR003") -> IgnoreComment:
    return IgnoreComment(span=place(start, start), selectors=(selector,), reason="a reason", start=start, end=end)


def settle(
    *findings: Finding,
    unit: Unit = UNIT,
    policy: Policy = EVERYTHING,
    comments: Iterable[IgnoreComment] = (),
    root: Element | None = None,
) -> FinalFindings:
    return finalize_unit_findings(findings, unit=unit, policy=policy, rules=RULES, comments=comments, root=root)


class TestAdmission:
    def test_the_configuration_decides_about_the_severity(self) -> None:
        policy = replace(EVERYTHING, severities={"INR003": "info"})
        assert admit_finding(inertia("a"), RULES["INR003"], policy).severity is Severity.INFO

    def test_what_a_target_refuses_is_an_error(self) -> None:
        mild = inertia("a", severity=Severity.INFO)
        for target, severity in (("mujoco", Severity.ERROR), ("pinocchio", Severity.INFO)):
            policy = replace(EVERYTHING, targets=(target,))
            assert admit_finding(mild, RULES["INR003"], policy).severity is severity

    def test_long_texts_lose_their_middle_wherever_they_are(self) -> None:
        name = "A" * 10 * MAX_TEXT_LENGTH
        finding = admit_finding(inertia(name), RULES["INR003"], EVERYTHING)
        texts = (finding.message, finding.location.subject, *finding.subjects, finding.data["links"])
        assert all("…" in text and len(text) <= MAX_TEXT_LENGTH + 1 for text in texts)

    def test_a_fix_that_is_too_long_is_shown_only(self) -> None:
        edit = Edit(place(0), "x", "y" * MAX_EDIT_LENGTH)
        fix = admit_finding(inertia("a", edits=[edit]), RULES["INR003"], EVERYTHING).fix
        assert fix is not None
        assert (fix.applicability, fix.edits) == (Applicability.DISPLAY, ())


class TestUnit:
    def test_a_comment_suppresses_the_findings_that_it_covers(self) -> None:
        settled = settle(inertia("a", at=3), inertia("b", at=30), comments=[comment(0, 10)])
        assert [f.suppressed is not None for f in settled.findings] == [True, False]
        assert settled.needed_comments == {place(0, 0)}

    def test_an_entry_of_the_configuration_suppresses_by_subject(self) -> None:
        entry = SuppressionEntry(frozenset({"INR003"}), "link[b]", "known")
        settled = settle(inertia("a"), inertia("b", at=9), policy=replace(EVERYTHING, suppress=(entry,)))
        assert [f.suppressed and f.suppressed.kind for f in settled.findings] == [None, "configuration"]

    def test_the_baseline_knows_each_finding_as_often_as_it_has_it(self) -> None:
        subject = "link[a]/inertial/inertia"
        unit = replace(UNIT, baseline_entries={("INR003", subject, "helper"): 1})
        settled = settle(inertia("a"), inertia("a", at=9), unit=unit)
        assert [f.suppressed and f.suppressed.kind for f in settled.findings] == ["baseline", None]

    def test_one_text_is_one_finding_with_all_its_subjects(self) -> None:
        (merged,) = settle(inertia("a"), inertia("b")).findings
        assert merged.subjects == ("link[a]/inertial/inertia", "link[b]/inertial/inertia")

    def test_what_is_suppressed_is_not_merged_with_what_is_not(self) -> None:
        """Of the links that one macro line makes a single one may be known."""
        entry = SuppressionEntry(frozenset({"INR003"}), "link[b]", "known")
        settled = settle(inertia("a"), inertia("b"), policy=replace(EVERYTHING, suppress=(entry,)))
        assert [len(f.subjects) for f in settled.findings] == [1, 1]

    def test_a_stronger_finding_on_the_element_supersedes_and_says_so(self) -> None:
        (kept,) = settle(inertia("a"), inertia("a", "INR004")).findings
        assert (kept.code, kept.data["hides"]) == ("INR004", ["INR003"])

    def test_merging_comes_before_superseding(self) -> None:
        """A finding about two links yields only where the stronger rule fired on both."""
        settled = settle(inertia("a"), inertia("b"), inertia("a", "INR004"))
        assert sorted(f.code for f in settled.findings) == ["INR003", "INR004"]

    @pytest.mark.parametrize(("copies", "safe"), [(1, True), (2, False)])
    def test_a_fix_of_text_that_makes_several_elements_is_unsafe(self, copies: int, safe: bool) -> None:
        root = parse_xml(SourceFile(Path("r.urdf"), "r.urdf", text='<robot><link name="a"/></robot>'))
        (link,) = root.children
        root.children[:] = [link] * copies
        assert link.span is not None
        edit = Edit(place(link.span.start + 1, link.span.start + 5), "link", "knil")
        (finding,) = settle(inertia("a", edits=[edit]), root=root).findings
        assert finding.fix is not None
        assert finding.fix.applicability is (Applicability.SAFE if safe else Applicability.UNSAFE)

    def test_the_worst_of_a_rule_are_listed_and_the_others_counted(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(report_limits, "MAX_FINDINGS", 2)
        settled = settle(*(inertia(str(n), at=n) for n in range(5)), inertia("x", at=9, severity=Severity.INFO))
        assert [f.location.span.start for f in settled.findings if f.location.span] == [0, 1, 9]
        (skip,) = settled.unlisted
        assert (skip.code, skip.model, skip.reason) == ("INR003", UNIT.id, "errors not listed: 3")

    def test_findings_are_in_the_order_of_the_text_the_worst_first(self) -> None:
        mild = inertia("m", at=5, severity=Severity.INFO)
        settled = settle(mild, inertia("c", at=9), inertia("w", "INR004", at=5), inertia("a", at=1))
        assert [f.subjects[0][5] for f in settled.findings] == ["a", "w", "m", "c"]
        assert list(settled.findings) == sorted(settled.findings, key=get_sort_key)


class TestRun:
    def settle(
        self,
        *audited: tuple[Unit, UnitReport],
        across: Iterable[Finding] = (),
        reviews: Iterable[Finding] = (),
        policy: Policy = EVERYTHING,
    ) -> tuple[Finding, ...]:
        def review(findings: Sequence[Finding], needed: AbstractSet[Span]) -> Iterator[Finding]:
            self.reviewed = [f.code for f in findings]
            self.needed = needed
            yield from reviews

        return finalize_run_findings(audited, policy, across_models=across, review=review)[0]

    def test_findings_of_all_units_are_in_one_order(self) -> None:
        two = replace(UNIT, id="a.urdf", path="a.urdf")
        first, second = inertia("x", model=UNIT.id), inertia("y", span=place(5, file="a.urdf"), model="a.urdf")
        run = self.settle((UNIT, UnitReport(findings=(first,))), (two, UnitReport(findings=(second,))))
        assert run == (second, first)

    def test_a_finding_about_several_models_follows_the_policy_of_its_own(self) -> None:
        strict = replace(UNIT, policy=replace(EVERYTHING, severities={"INR003": "info"}))
        blind = replace(UNIT, id="b.urdf", policy=replace(EVERYTHING, codes=frozenset()))
        units = [(unit, UnitReport()) for unit in (strict, blind)]
        (kept,) = self.settle(*units, across=[inertia("a"), inertia("a", model="b.urdf")])
        assert (kept.model, kept.severity) == (strict.id, Severity.INFO)

    def test_comments_suppress_findings_about_several_models_and_are_needed(self) -> None:
        usage = assess_comment(
            comment(0, 10), "", is_used=False, checked_codes=EVERYTHING.codes, skipped_codes=(), doubt=""
        )
        (finding,) = self.settle((UNIT, UnitReport(comments=(usage,))), across=[inertia("a", at=3)])
        assert finding.suppressed is not None
        assert self.needed == {place(0, 0)}

    def test_equal_findings_about_several_models_are_merged(self) -> None:
        (merged,) = self.settle((UNIT, UnitReport()), across=[inertia("a"), inertia("b")])
        assert len(merged.subjects) == 2

    def test_the_review_sees_all_findings_and_its_own_follow_the_policy_of_the_run(self) -> None:
        rule = RULES["URC907"]
        foreign = rule.finding("shadowed", at=Location("library[x]", None), library="x", path="y")
        report = UnitReport(findings=(inertia("a"),))
        across = [inertia("b", "INR004")]
        run = self.settle((UNIT, report), across=across, reviews=[foreign])
        assert self.reviewed == ["INR003", "INR004"]
        assert [f.code for f in run] == ["URC907", "INR003", "INR004"]
        silent = replace(EVERYTHING, codes=EVERYTHING.codes - {"URC907"})
        assert "URC907" not in [f.code for f in self.settle((UNIT, report), reviews=[foreign], policy=silent)]

    def test_a_fix_is_unsafe_where_another_model_needs_the_text_as_it_is(self) -> None:
        other = replace(UNIT, id="other.urdf", path="other.urdf")
        finding = inertia("a", edits=[Edit(place(0), "x", "y")])
        alone = (UNIT, UnitReport(findings=(finding,), files=("r.urdf",)))
        applicabilities = []
        for files in ((), ("r.urdf",)):
            (settled,) = self.settle(alone, (other, UnitReport(files=files)))
            assert settled.fix is not None
            applicabilities.append(settled.fix.applicability)
        assert applicabilities == [Applicability.SAFE, Applicability.UNSAFE]

    def test_variants_of_one_file_share_a_finding_with_the_fewest_arguments(self) -> None:
        plain = Unit(kind="model", path="r.xacro", id="r.xacro")
        varied = replace(plain, id="r.xacro a:=1", arguments={"a": "1"})
        units = [(unit, UnitReport(findings=(inertia("a", model=unit.id),))) for unit in (varied, plain)]
        (finding,) = self.settle(*units)
        assert (finding.model, set(finding.variants)) == ("r.xacro", {"r.xacro", "r.xacro a:=1"})
