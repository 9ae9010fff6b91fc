"""The order of findings in all formats."""

from __future__ import annotations

import json
import random
from dataclasses import replace
from pathlib import Path

from builders import inertial, joint, link, robot
from conftest import check_text
from output.runs import a_run, finding, span_of

from urdfcheck.core import Confidence, Location, Severity
from urdfcheck.output import gitlab
from urdfcheck.output.shared.wording import sort_worst_first


def test_severity_then_refusals_then_losses_then_confidence() -> None:
    refused, dropped = {"mujoco": "refuses", "drake": "refuses"}, {"mujoco": "drops the link"}
    order = [
        finding(code="A", consequences=refused),
        finding(code="B", consequences={"mujoco": "refuses"}),
        finding(code="C", consequences=dropped),
        finding(code="D", consequences={}),
        finding(code="E", consequences={}, confidence=Confidence.STRONG),
        finding(code="F", severity=Severity.WARNING, consequences=refused),
    ]
    for seed in range(5):
        mixed = random.Random(seed).sample(order, len(order))
        assert [f.code for f in sort_worst_first(mixed)] == list("ABCDEF")


def test_of_a_rule_the_largest_excess_is_first_and_rules_are_not_compared() -> None:
    plain = finding(consequences={})
    found = [
        replace(plain, code="A", message="5 mm", excess=0.005),
        replace(plain, code="B", message="80 %", excess=80),
        replace(plain, code="A", message="30 mm", excess=0.03),
        replace(plain, code="B", message="unknown"),
        replace(plain, code="C", message="no number"),
        replace(plain, code="B", message="90 %", excess=90),
    ]
    assert [f.message for f in sort_worst_first(found)] == ["30 mm", "5 mm", "90 %", "80 %", "unknown", "no number"]


def test_a_check_gives_the_number(tmp_path: Path) -> None:
    parts = [
        link("base", inertial()),
        link("near", inertial(izz=2.1)),
        joint("a", "base", "near"),
        link("far", inertial(izz=9)),
        joint("b", "base", "far"),
    ]
    found = check_text(tmp_path, robot(*parts), codes={"INR003"}).findings
    assert [f.subjects[0].partition("]")[0] for f in found] == ["link[near", "link[far"], "in the file"
    assert [f.subjects[0].partition("]")[0] for f in sort_worst_first(found)] == ["link[far", "link[near"]


def test_formats_follow_it() -> None:
    plain = finding(consequences={})
    elsewhere = Location("link[other]", span_of("-1"))
    large = replace(plain, headline="large", excess=2.0, location=elsewhere, subjects=("link[other]",))
    run = a_run(replace(plain, headline="small", excess=1.0), large)
    first, second = json.loads(gitlab.render(run))
    assert first["description"].startswith("large")
    assert second["description"].startswith("small")
