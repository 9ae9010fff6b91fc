"""The engine's promises: nothing is lost, a crash is never green, one defect is one finding."""

from __future__ import annotations

import gc
import os
import signal
import weakref
from collections.abc import Iterator
from pathlib import Path

import pytest
from conftest import check, check_text, make_request

from urdfcheck.cli import FAILED, compute_exit_code
from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.findings import iter_occurrences
from urdfcheck.output.json import render
from urdfcheck.policy.superseding import drop_superseded
from urdfcheck.rules import load_check, load_rules
from urdfcheck.run import pipeline
from urdfcheck.run.jobs import AuditSettings, Unit, UnitReport
from urdfcheck.run.pipeline import run
from urdfcheck.system import process_pool, sandbox

INERTIA = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="9"/></inertial>'


def crash(*_: object, **__: object) -> Iterator[Finding]:
    raise ZeroDivisionError("boom")


def test_a_check_that_crashes_is_URC900_and_exit_2_and_the_others_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    real = load_check
    monkeypatch.setattr(
        "urdfcheck.run.unit_audit.load_check", lambda rule: crash if rule.code == "INR004" else real(rule)
    )
    outcome = check_text(tmp_path, f'<robot name="r"><link name="a">{INERTIA}</link></robot>')
    codes = {f.code for f in outcome.findings}
    assert {"URC900", "INR003"} <= codes
    assert "INR004 crashed" in outcome.failures[0]
    assert compute_exit_code(outcome, "never") == FAILED


@pytest.mark.parametrize(("library", "is_skipped"), [("scipy.optimize", True), ("numpy", False)])
def test_a_library_that_urdfcheck_core_leaves_out_skips_a_check_and_any_other_is_a_crash(
    library: str, is_skipped: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def lack(*_: object, **__: object) -> Iterator[Finding]:
        raise ModuleNotFoundError(f"No module named {library!r}", name=library)

    monkeypatch.setattr("urdfcheck.run.unit_audit.load_check", lambda rule: lack)
    outcome = check_text(tmp_path, f'<robot name="r"><link name="a">{INERTIA}</link></robot>', codes={"INR004"})
    reasons = [skip.reason for skip in outcome.skipped]
    assert reasons == (["scipy is not installed (it comes with urdfcheck, not with urdfcheck-core)"] * is_skipped)
    assert bool(outcome.failures) != is_skipped


def test_planning_frees_the_files_that_it_has_expanded(monkeypatch: pytest.MonkeyPatch) -> None:
    class Node:
        def __init__(self) -> None:
            self.parent = self

    nodes: list[weakref.ref[Node]] = []

    def leave_garbage(**_: object) -> None:
        nodes.extend(weakref.ref(Node()) for _ in range(400_000))

    monkeypatch.setattr(pipeline, "discover_targets", leave_garbage)
    monkeypatch.setattr(sandbox, "limit_memory", lambda megabytes: None)
    gc.disable()  # as a worker does
    try:
        pipeline._discover_bounded(0, 0.0, 0.0, {}, {})
        assert sum(node() is not None for node in nodes) < 300_000
        assert not gc.isenabled()
    finally:
        gc.enable()


AUDIT = pipeline._audit_in_worker


def die_on_a(unit: Unit, settings: AuditSettings) -> UnitReport:
    if unit.path.endswith("a.urdf"):
        os.kill(os.getpid(), signal.SIGKILL)
    return AUDIT(unit, settings)


def test_a_worker_that_dies_is_a_failure_of_its_model_only(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("a.urdf", "b.urdf"):
        (tmp_path / name).write_text('<robot name="r"><link name="base"/></robot>')
    monkeypatch.setattr(pipeline, "_audit_in_worker", die_on_a)
    outcome = run(make_request(tmp_path, jobs=2))
    assert [m.status for m in outcome.models] == ["failed", "checked"]
    assert "was killed (SIGKILL" in outcome.failures[0]


def test_six_links_made_by_one_macro_line_are_one_finding(tmp_path: Path) -> None:
    text = f"""<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">
      <xacro:macro name="part" params="n"><link name="part_${{n}}">{INERTIA}</link></xacro:macro>
      <link name="base"/>
      <xacro:part n="1"/><xacro:part n="2"/><xacro:part n="3"/>
    </robot>"""
    found = check_text(tmp_path, text, "r.urdf.xacro", codes={"INR003"}).findings
    assert len(found) == 1
    assert [s.split("/")[0] for s in found[0].subjects] == ["link[part_1]", "link[part_2]", "link[part_3]"]
    assert len(set(found[0].fingerprints)) == 3
    assert found[0].location.span is not None
    assert found[0].location.span.line == 2


def test_the_weaker_rule_yields_and_the_stronger_says_so(tmp_path: Path) -> None:
    """A tensor that is not positive definite also breaks the triangle inequality: one cause, one finding."""
    text = '<robot name="r"><link name="a">' + INERTIA.replace('izz="9"', 'izz="-9"') + "</link></robot>"
    found = check_text(tmp_path, text, codes={"INR003", "INR004"}).findings
    assert [f.code for f in found] == ["INR004"]


def test_hidden_findings_are_named_by_what_hides_them() -> None:
    rules = load_rules()
    stronger: Rule = rules["INR004"]
    weaker: Rule = rules["INR003"]
    from urdfcheck.core import Location

    at = Location("link[a]/inertial/inertia", None)
    elsewhere = Location("link[b]/inertial/inertia", None)

    def finding(rule: Rule, location: Location) -> Finding:
        return Finding(
            code=rule.code,
            name=rule.name,
            severity=rule.severity,
            confidence=rule.confidence,
            message_id="m",
            headline="h",
            message="m",
            location=location,
            subjects=(location.subject,),
        )

    kept = drop_superseded([finding(weaker, at), finding(stronger, at), finding(weaker, elsewhere)], rules)
    assert [(f.code, f.location.subject) for f in kept] == [("INR004", at.subject), ("INR003", elsewhere.subject)]
    assert kept[0].data["hides"] == ["INR003"]


def test_a_tensor_says_nothing_about_a_shape_of_its_link() -> None:
    from urdfcheck.core import Location

    rules, at = load_rules(), Location("link[wheel]/inertial", None)

    def finding(code: str, message: str) -> Finding:
        rule = rules[code]
        return Finding(
            code=code,
            name=rule.name,
            severity=rule.severity,
            confidence=rule.confidence,
            message_id=message,
            headline="h",
            message="m",
            location=at,
            subjects=(at.subject,),
        )

    found = [finding("INR009", "disagrees"), finding("JNT015", "drawn"), finding("JNT015", "inertia")]
    assert [f.message_id for f in drop_superseded(found, rules)] == ["disagrees", "drawn"]


def test_a_note_on_request_does_not_hide_what_counterparts_show() -> None:
    from dataclasses import replace

    from urdfcheck.core import Location

    rules = load_rules()

    def finding(code: str, message: str, severity: Severity) -> Finding:
        rule, at = rules[code], Location("link[a]/inertial/inertia", None)
        return Finding(
            code=code,
            name=rule.name,
            severity=severity,
            confidence=rule.confidence,
            message_id=message,
            headline="h",
            message="m",
            location=at,
            subjects=(at.subject,),
        )

    note, odd = finding("INR007", "estimate", Severity.INFO), finding("SYM003", "odd", Severity.WARNING)
    assert drop_superseded([note, odd], rules) == [note, odd]
    for stronger, weaker in (
        (replace(note, severity=Severity.WARNING), odd),
        (replace(note, message_id="placeholder"), odd),
        (note, replace(odd, severity=Severity.INFO)),
        (note, finding("INR005", "exceeds", Severity.WARNING)),
    ):
        (kept,) = drop_superseded([stronger, weaker], rules)
        assert kept.code == "INR007"


def test_a_finding_drops_what_it_explains() -> None:
    from dataclasses import replace

    from urdfcheck.core import Location

    rule = load_rules()["JNT007"]

    def finding(*joints: str) -> Finding:
        subjects = tuple(f"joint[{joint}]/limit@effort" for joint in joints)
        return Finding(
            code=rule.code,
            name=rule.name,
            severity=rule.severity,
            confidence=rule.confidence,
            message_id="m",
            headline="h",
            message="m",
            location=Location(subjects[0], None),
            subjects=subjects,
        )

    cause = replace(finding("a"), code="JNT005", data={"explains": ["JNT007 joint[a]"]})
    kept = drop_superseded([finding("a"), finding("a", "b"), finding("b"), cause], load_rules())
    assert [(f.code, f.subjects) for f in kept[:2]] == [
        (rule.code, finding("a", "b").subjects),
        (rule.code, finding("b").subjects),
    ]
    assert [(f.code, f.data["hides"]) for f in kept[2:]] == [("JNT005", ["JNT007"])]


def test_a_finding_about_several_is_hidden_where_all_of_them_are() -> None:
    from urdfcheck.core import Location

    rules = load_rules()

    def finding(code: str, *links: str) -> Finding:
        rule, subjects = rules[code], tuple(f"link[{link}]/inertial/inertia" for link in links)
        at = Location(subjects[0], None)
        return Finding(
            code=rule.code,
            name=rule.name,
            severity=rule.severity,
            confidence=rule.confidence,
            message_id="m",
            headline="h",
            message="m",
            location=at,
            subjects=subjects,
        )

    some = drop_superseded([finding("INR003", "a", "b"), finding("INR004", "a")], rules)
    assert [f.code for f in some] == ["INR003", "INR004"]
    every = drop_superseded([finding("INR003", "a", "b"), finding("INR004", "a"), finding("INR004", "b")], rules)
    assert [f.code for f in every] == ["INR004", "INR004"]


def test_a_worker_sees_nothing_around_what_is_checked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Neither where a launch file says that a model is, nor beside the package at the top of the repository."""
    for name in ("outside", "repo/.git"):
        (tmp_path / name).mkdir(parents=True)
    (tmp_path / "repo/package.xml").write_text("<package><name>p</name></package>")
    monkeypatch.chdir(tmp_path / "repo")
    Path("r.launch").write_text('<launch><param name="robot_description" textfile="../outside/r.urdf"/></launch>')
    Path("a.launch").write_text('<launch><param name="robot_description" textfile="/etc/r.urdf"/></launch>')
    request = make_request(Path(), codes=())
    plan, units = pipeline.plan_units(request)
    with pipeline.audit_session(request, units, plan) as settings:
        seen = {folder for folder in settings.visible_folders if not folder.endswith("rules")}
    assert {unit.kind for unit in units} >= {"launch", "package"}
    assert seen == {str(tmp_path / "repo")}


@pytest.mark.slow
@pytest.mark.skipif(not process_pool.FORKS, reason="there is no warm worker where processes cannot be forked")
def test_a_single_file_is_looked_for_in_the_process_that_audits_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    model = tmp_path / "r.urdf"
    model.write_text('<robot name="r"><link name="base"/></robot>')
    worker = process_pool.Worker.start()
    monkeypatch.setattr(process_pool.Worker, "start", lambda *_: pytest.fail("another process was started"))
    try:
        _, units = pipeline.plan_units(make_request(model), warm_worker=worker)
        assert [unit.id for unit in units] == ["r.urdf"]
        outcome = run(make_request(model), pipeline.Execution(warm_worker=worker))
        assert [m.status for m in outcome.models] == ["checked"]
    finally:
        worker.end()


@pytest.mark.slow
def test_a_folder_is_searched_in_a_process_of_its_own(tmp_path: Path) -> None:
    """What the search leaves in memory must not count for an audit."""
    (tmp_path / "r.urdf").write_text('<robot name="r"><link name="base"/></robot>')
    worker = process_pool.Worker.start()
    worker.end()
    assert pipeline.plan_units(make_request(tmp_path), warm_worker=worker)[1]


@pytest.mark.slow
def test_a_thousand_warnings_hide_no_error(tmp_path: Path) -> None:
    links = "".join(f'<link name="l{i}"><inertial><mass value="1e300"/></inertial></link>\n' for i in range(1_010))
    wrong = '<link name="z"><inertial><mass value="abc"/></inertial></link>'
    (tmp_path / "r.urdf").write_text(f'<robot name="r">{links}{wrong}</robot>')
    run = check(tmp_path / "r.urdf", codes=frozenset({"XML007"}), tier="source")
    assert [str(f.severity) for f in iter_occurrences(run.findings)].count("warning") == 1_000
    assert [f.data["word"] for f in run.findings if f.severity == Severity.ERROR] == ["abc"]
    assert [(s.code, s.reason) for s in run.skipped] == [("XML007", "warnings not listed: 10")]


def test_a_name_with_slashes_hides_nothing_of_another_element(tmp_path: Path) -> None:
    inertia = '<inertia ixx="{}" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
    body = f'<link name="{{}}"><inertial><mass value="1"/>{inertia}</inertial></link>'
    (tmp_path / "r.urdf").write_text(f'<robot name="r">{body.format("x/1", 5)}\n{body.format("x/2", -1)}</robot>')
    run = check(tmp_path / "r.urdf", codes=frozenset({"INR003", "INR004"}), tier="source")
    assert {f.code for f in run.findings} == {"INR003", "INR004"}


@pytest.mark.slow
def test_a_name_without_end_is_not_repeated_in_each_finding(tmp_path: Path) -> None:
    parts = '<visual><geometry><box size="1 x 1"/></geometry></visual>\n' * 50
    (tmp_path / "r.urdf").write_text(f'<robot name="r"><link name="{"A" * 100_000}">{parts}</link></robot>')
    run = check(tmp_path / "r.urdf", codes=frozenset({"XML007"}), tier="source")
    assert [len(f.occurrences) for f in run.findings] == [50]
    assert len(render(run)) < 3_000_000
    assert all(s.endswith("/geometry/box@size") for f in run.findings for s in f.subjects)


def test_a_difference_of_two_elements_yields_to_what_explains_either() -> None:
    from urdfcheck.core import Location

    rules = load_rules()

    def finding(code: str, joint: str, **data: object) -> Finding:
        rule, at = rules[code], Location(f"joint[{joint}]/origin@xyz", None)
        return Finding(
            code=code,
            name=rule.name,
            severity=rule.severity,
            confidence=rule.confidence,
            message_id="m",
            headline="h",
            message="m",
            location=at,
            subjects=(at.subject,),
            data=data,
        )

    difference = finding("SYM004", "right", between=["joint[left]", "joint[right]"])
    for named in ("left", "right"):
        kept = drop_superseded([difference, finding("SYM002", named)], rules)
        assert [(f.code, f.data["hides"]) for f in kept] == [("SYM002", ["SYM004"])]
    assert len(drop_superseded([difference, finding("SYM002", "other")], rules)) == 2


def test_a_severity_of_the_configuration_holds(tmp_path: Path) -> None:
    text = f'<robot name="r"><link name="a">{INERTIA}</link></robot>'
    found = check_text(tmp_path, text, codes={"INR003"}, severities={"INR003": "info"}).findings
    assert [f.severity for f in found] == [Severity.INFO]


def test_a_check_beyond_the_tier_is_skipped_with_the_tier_that_runs_it(tmp_path: Path) -> None:
    outcome = check_text(tmp_path, '<robot name="r"><link name="a"/></robot>', tier="source")
    reasons = {s.code: s.reason for s in outcome.skipped}
    assert reasons["MSH001"] == "needs --tier mesh"
    assert reasons["XML014"] == "needs --tier full"


def test_without_pinocchio_the_rules_that_need_it_are_skipped_visibly(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As on Windows, where pin and coal have no wheels."""
    import sys

    for name in ("pinocchio", "coal"):
        monkeypatch.setitem(sys.modules, name, None)
    outcome = check_text(tmp_path, '<robot name="r"><link name="a"/></robot>')
    assert not outcome.failures
    assert "Pinocchio is not installed" in {s.code: s.reason for s in outcome.skipped}["XML014"]


def test_every_model_of_a_folder_is_reported_even_when_one_is_broken(tmp_path: Path) -> None:
    (tmp_path / "a.urdf").write_text("<robot name='r'><link")
    (tmp_path / "b.urdf").write_text('<robot name="r"><link name="base"/></robot>')
    outcome = check(tmp_path)
    assert [(m.path.split("/")[-1], m.status) for m in outcome.models] == [("a.urdf", "failed"), ("b.urdf", "checked")]
    assert "XML001" in {f.code for f in outcome.findings}


def test_model_ids_name_the_arguments(tmp_path: Path) -> None:
    path = tmp_path / "r.urdf.xacro"
    path.write_text(
        '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:arg name="n" default="1"/>'
        '<link name="a$(arg n)"/></robot>'
    )
    outcome = check(path, arguments={"n": "2"})
    assert outcome.models[0].id == "r.urdf.xacro n:=2"
    assert outcome.models[0].args == {"n": "2"}


def test_a_urdf_that_the_launch_file_hands_to_xacro_is_expanded(tmp_path: Path) -> None:
    (tmp_path / "r.urdf").write_text(
        '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:property name="n" value="7"/>'
        '<link name="a${n}"/></robot>'
    )
    launch = tmp_path / "r.launch"
    launch.write_text('<launch><param name="robot_description" command="xacro $(dirname)/r.urdf"/></launch>')
    outcome = check(launch)
    assert [(m.status, m.links) for m in outcome.models] == [("checked", 1)]
    assert "XML009" not in {f.code for f in outcome.findings}
    assert "XML009" not in {f.code for f in check(tmp_path / "r.urdf").findings}  # it declares the prefix
    for command, is_read_as_it_is in (
        ('textfile="$(dirname)/r.urdf"', True),
        ('command="cat $(dirname)/r.urdf"', True),
        ('command="rosrun xacro xacro $(dirname)/r.urdf"', False),
    ):
        launch.write_text(f'<launch><param name="robot_description" {command}/></launch>')
        assert ("XML009" in {f.code for f in check(launch).findings}) is is_read_as_it_is


@pytest.mark.parametrize(
    ("dof", "other", "statuses", "codes"),
    [
        ("$(eval 6)", True, {"checked"}, set()),
        ("$(eval 6)", False, {"failed"}, {"XAC001"}),  # of the only call it is told
        ("7", True, {"checked", "failed"}, {"XAC001"}),
        ("6", True, {"checked"}, set()),
    ],
)
def test_a_call_with_an_argument_that_only_the_launch_knows_is_none_with_its_default(
    tmp_path: Path, dof: str, other: bool, statuses: set[str], codes: set[str]
) -> None:
    """An arm of six axes, which a launch file starts with a count of axes that is computed, and another of seven."""
    (tmp_path / "arm.urdf.xacro").write_text(
        '<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">'
        '<xacro:arg name="kind" default="seven"/><xacro:arg name="dof" default="7"/>'
        "<xacro:property name=\"ends\" value=\"${dict(seven='a7', six='a6')['$(arg kind)']}\"/>"
        "<link name=\"${dict(a7='tool', a6='tool')[ends if ends == 'a$(arg dof)' else 'none']}\"/></robot>"
    )
    load = '<launch><param name="robot_description" command="xacro $(dirname)/arm.urdf.xacro {}"/></launch>'
    (tmp_path / "six.launch").write_text(load.format(f"kind:=six dof:={dof}"))
    if other:
        (tmp_path / "seven.launch").write_text(load.format("kind:=seven dof:=7"))
    outcome = check(tmp_path, codes={"XAC001"})
    assert {model.status for model in outcome.models} == statuses
    assert {finding.code for finding in outcome.findings} == codes
    is_left_out = statuses == {"checked"} and dof != "6"
    assert any("the default of dof" in skip.reason for skip in outcome.skipped) is is_left_out


def test_a_macro_line_with_another_value_for_each_link_is_told_for_each_call(tmp_path: Path) -> None:
    text = """<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">
      <xacro:macro name="leg" params="n m:=-1"><link name="leg_${n}"><inertial><mass value="${m}"/>
        <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link></xacro:macro>
      <xacro:leg n="1"/>
      <xacro:leg n="2"/>
      <xacro:leg n="3" m="-7"/>
    </robot>"""
    (joint,) = check_text(tmp_path, text, "r.urdf.xacro", codes={"INR002"}).findings
    found = joint.occurrences
    assert [len(f.subjects) for f in found] == [2, 1]
    assert ["-1" in found[0].message, "-7" in found[1].message] == [True, True]
    assert [f.location.span.line for f in found if f.location.span] == [2, 6]
    assert [v.line for v in found[1].location.via] == [6, 2]


def test_a_computed_value_names_where_its_parts_are_defined(tmp_path: Path) -> None:
    text = """<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">
      <xacro:property name="weight" value="-2"/>
      <link name="a"><inertial><mass value="${weight}"/>
        <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
    </robot>"""
    (found,) = check_text(tmp_path, text, "r.urdf.xacro", codes={"INR002"}).findings
    assert [(r.subject, r.span.line if r.span else 0) for r in found.related] == [("property[weight]", 2)]
