"""What becomes of a model in each program, and how bad a finding is for those who will read the model."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from conftest import check

from urdfcheck.core import Confidence, Finding, Location, Severity, Verdict
from urdfcheck.policy.consumers import CONSUMERS, apply_target_severity, get_verdict, predict_outcomes
from urdfcheck.rules import load_rules

RULE = load_rules()["JNT009"]


@pytest.mark.parametrize(
    ("sentence", "verdict"),
    [
        ("refuses to compile: inertia must satisfy A + B >= C", Verdict.REFUSES),
        ("drops the link and its subtree", Verdict.DROPS),
        ("computes NaN accelerations", Verdict.NAN),
        ("computes torques as if nothing were wrong", Verdict.LOADS),
        ("swaps the two", Verdict.SWAPS),
        ("replaces, with a warning, the inertia", Verdict.REPLACES),
        ("ignores the element", Verdict.IGNORES),
        ("loads it", Verdict.LOADS),
        ("", Verdict.LOADS),
    ],
)
def test_a_sentence_begins_with_its_verdict(sentence: str, verdict: Verdict) -> None:
    assert Verdict.from_sentence(sentence) is verdict


IMPOSSIBLE = """<robot name="r"><link name="base"/><link name="arm"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="9" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="j" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/></joint></robot>"""


def test_the_worst_of_all_findings_is_what_becomes_of_the_model(tmp_path: Path) -> None:
    path = tmp_path / "r.urdf"
    path.write_text(IMPOSSIBLE)
    found = predict_outcomes(check(path, codes={"INR003"}).findings)
    assert found["mujoco"].verdict is Verdict.REFUSES
    assert found["mujoco"].codes == ("INR003",)
    assert found["kdl"].verdict is Verdict.LOADS
    assert set(found) == set(CONSUMERS)


def test_without_findings_all_load_it() -> None:
    assert {o.verdict for o in predict_outcomes(()).values()} == {Verdict.LOADS}


def warning(**consequences: str) -> Finding:
    at = Location("joint[j]", None)
    return Finding(
        code="JNT009",
        name="x",
        severity=Severity.WARNING,
        confidence=Confidence.PROOF,
        message_id="m",
        headline="h",
        message="m",
        location=at,
        subjects=("joint[j]",),
        consequences=consequences,
    )


def test_what_a_target_refuses_or_drops_is_an_error() -> None:
    assert apply_target_severity(warning(mujoco="refuses it"), RULE, ("mujoco",)).severity is Severity.ERROR
    assert (
        apply_target_severity(warning(gazebo="drops the link"), RULE, ("mujoco", "gazebo")).severity is Severity.ERROR
    )
    assert apply_target_severity(warning(mujoco="refuses it"), RULE, ("gazebo",)).severity is Severity.WARNING
    assert apply_target_severity(warning(mujoco="ignores it"), RULE, ("mujoco",)).severity is Severity.WARNING
    assert apply_target_severity(warning(mujoco="refuses it"), RULE, ()).severity is Severity.WARNING


def test_who_reads_through_urdfdom_has_no_model_where_urdfdom_has_none() -> None:
    assert apply_target_severity(warning(urdfdom="refuses the file"), RULE, ("rviz",)).severity is Severity.ERROR
    assert apply_target_severity(warning(urdfdom="refuses the file"), RULE, ("mujoco",)).severity is Severity.WARNING
    assert (
        apply_target_severity(warning(urdfdom="refuses the file", rviz="loads it"), RULE, ("rviz",)).severity
        is Severity.WARNING
    )


def test_what_concerns_others_alone_is_worth_knowing() -> None:
    rule = replace(RULE, concerns=("gazebo",))
    assert apply_target_severity(warning(), rule, ("mujoco",)).severity is Severity.INFO
    assert apply_target_severity(warning(), rule, ("mujoco", "gazebo")).severity is Severity.WARNING
    assert apply_target_severity(warning(), rule, ()).severity is Severity.WARNING


def test_what_the_parser_of_a_program_loses_it_does_not_get() -> None:
    """Isaac Sim has the importer of Newton; its own sentence counts more."""
    lost = {"newton": "drops the shape, with a warning"}
    assert get_verdict(lost, "isaac") is Verdict.DROPS
    assert get_verdict({**lost, "isaac": "loads it"}, "isaac") is Verdict.LOADS
    assert get_verdict({"newton": "replaces the name"}, "isaac") is Verdict.LOADS
    assert get_verdict({"urdfdom": "refuses the file"}, "isaac") is Verdict.LOADS
