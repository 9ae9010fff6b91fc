"""What is known already: comments in the source with a reason, and what becomes of those that are needless."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from conftest import check

from urdfcheck.core import Applicability, Finding, Run
from urdfcheck.source.text.suppression_comments import find_ignore_comments
from urdfcheck.source.text.xml import SourceFile

ROBOT = """<robot name="r">
  <link name="base"/>
  {before}
  <joint name="j" type="revolute">
    <parent link="base"/>
    <child link="arm"/>
    <axis xyz="0 0 1"/>
    {inside}
    <limit lower="1.2" upper="-0.5" effort="10" velocity="1"/>
  </joint>
  {after}
  <link name="arm"/>
</robot>
"""


def write_robot(folder: Path, before: str = "", inside: str = "", after: str = "") -> Path:
    path = folder / "r.urdf"
    path.write_text(ROBOT.format(before=before, inside=inside, after=after))
    return path


def of(run: Run, code: str) -> list[Finding]:
    return [f for f in run.findings if f.code == code]


@pytest.mark.parametrize("word", ["JNT005", "limit-inverted", "JNT", "joint", "INR003, JNT005"])
@pytest.mark.parametrize("place", ["before", "inside"])
def test_a_comment_covers_the_next_element_and_what_is_in_it(tmp_path: Path, word: str, place: str) -> None:
    run = check(write_robot(tmp_path, **{place: f"<!-- urdfcheck: ignore[{word}] turned on purpose -->"}))
    (found,) = of(run, "JNT005")
    assert found.suppressed is not None
    assert (found.suppressed.kind, found.suppressed.reason) == ("source", "turned on purpose")
    assert not of(run, "URC902")
    assert found not in run.active_findings


def test_it_covers_nothing_before_or_beside_it(tmp_path: Path) -> None:
    run = check(write_robot(tmp_path, after="<!-- urdfcheck: ignore[JNT005] too late -->"))
    (found,) = of(run, "JNT005")
    assert found.suppressed is None
    (needless,) = of(run, "URC902")
    assert needless.message_id == "unused"
    assert needless.location.span is not None
    assert needless.location.span.line == 11
    assert needless.fix is not None
    assert needless.fix.applicability == Applicability.SAFE
    ((edit),) = needless.fix.edits
    assert edit.expected == "  <!-- urdfcheck: ignore[JNT005] too late -->\n"


@pytest.mark.parametrize(
    ("comment", "code", "message"),
    [
        ("ignore[JNT005]", "URC903", "no-reason"),
        ("ignore[JNT055] a reason", "URC902", "unknown"),
        ("ignore[URC900] a reason", "URC902", "unknown"),
        ("ignore JNT005 a reason", "URC902", "malformed"),
        ("ignore[] a reason", "URC902", "malformed"),
    ],
)
def test_a_comment_that_suppresses_nothing_is_a_finding(tmp_path: Path, comment: str, code: str, message: str) -> None:
    run = check(write_robot(tmp_path, before=f"<!-- urdfcheck: {comment} -->"))
    (complaint,) = [f for f in run.findings if f.code in {"URC902", "URC903"}]
    assert (complaint.code, complaint.message_id) == (code, message)
    (found,) = of(run, "JNT005")
    assert found.suppressed is None


def test_an_unknown_code_gets_the_nearest(tmp_path: Path) -> None:
    (complaint,) = of(check(write_robot(tmp_path, before="<!-- urdfcheck: ignore[limit-invrted] why -->")), "URC902")
    assert "did you mean limit-inverted?" in complaint.message


MACROS = """<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:macro name="arm" params="side">
    {definition}
    <link name="${{side}}_arm"/>
    <joint name="${{side}}_j" type="revolute">
      <parent link="base"/><child link="${{side}}_arm"/><axis xyz="0 0 1"/>
      <limit lower="1.2" upper="-0.5" effort="10" velocity="1"/>
    </joint>
  </xacro:macro>
  <link name="base"/>
  {call}
  <xacro:arm side="left"/>
  <xacro:arm side="right"/>
</robot>
"""


def test_xacro_deletes_comments_before_macros_and_they_count_all_the_same(tmp_path: Path) -> None:
    """Before a call the comment covers what this call makes, and of one line with two joints the other still counts."""
    path = tmp_path / "r.urdf.xacro"
    path.write_text(MACROS.format(definition="", call="<!-- urdfcheck: ignore[JNT005] the left one is meant -->"))
    known, new = sorted(of(check(path), "JNT005"), key=lambda f: f.subjects)
    assert known.subjects == ("joint[left_j]/limit",)
    assert known.suppressed is not None
    assert new.subjects == ("joint[right_j]/limit",)
    assert new.suppressed is None


def test_inside_a_macro_it_covers_what_all_calls_make(tmp_path: Path) -> None:
    path = tmp_path / "r.urdf.xacro"
    path.write_text(
        MACROS.format(definition="<!-- urdfcheck: ignore[JNT005] mirrored later -->", call="")
        .replace('<link name="${side}_arm"/>\n', "")
        .replace('<link name="base"/>', '<link name="base"/><link name="left_arm"/><link name="right_arm"/>')
    )
    (known,) = of(check(path), "JNT005")
    assert known.subjects == ("joint[left_j]/limit", "joint[right_j]/limit")
    assert known.suppressed is not None


def test_what_was_not_looked_for_is_not_called_needless(tmp_path: Path) -> None:
    path = write_robot(tmp_path, after="<!-- urdfcheck: ignore[MSH002] the mesh is a shell -->")
    assert not of(check(path, codes={"JNT005", "URC902"}), "URC902")
    assert not of(check(path, tier="source"), "URC902")
    assert of(check(path), "URC902")


def test_a_file_that_others_may_include_is_judged_with_all_of_them(tmp_path: Path) -> None:
    (tmp_path / "base.xacro").write_text(
        '<robot xmlns:xacro="http://www.ros.org/wiki/xacro">\n'
        "  <!-- urdfcheck: ignore[INR001] drawn elsewhere -->\n"
        '  <link name="base"/>\n</robot>\n'
    )
    model = tmp_path / "r.urdf.xacro"
    model.write_text(
        '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">\n  <xacro:include filename="base.xacro"/>\n</robot>\n'
    )
    assert not of(check(model), "URC902")
    assert of(check(tmp_path), "URC902")


def test_comments_of_yaml_and_python_cover_their_line_or_the_next(tmp_path: Path) -> None:
    text = "a: 1  # urdfcheck: ignore[CTL004] one\n# urdfcheck: ignore[CTL004] two\nb: 2\n"
    first, second = find_ignore_comments(SourceFile(tmp_path / "c.yaml", "c.yaml", text=text))
    assert text[first.start : first.end] == text.splitlines(keepends=True)[0]
    assert text[second.start : second.end] == "b: 2\n"
    assert (first.reason, second.reason) == ("one", "two")


def test_isolated_runs_heed_no_comment(tmp_path: Path) -> None:
    """A gate for strangers: the comment is a stranger's as well."""
    path = write_robot(tmp_path, before="<!-- urdfcheck: ignore[JNT005] trust me -->")
    (found,) = of(check(path, heed_comments=False), "JNT005")
    assert found.suppressed is None


def test_a_comment_alone_in_its_line_goes_with_the_line_and_another_alone(tmp_path: Path) -> None:
    path = write_robot(tmp_path, after='<link name="x"/> <!-- urdfcheck: ignore[JNT005] no -->')
    (needless,) = of(check(path), "URC902")
    assert needless.fix is not None
    assert needless.fix.edits[0].expected == "<!-- urdfcheck: ignore[JNT005] no -->"


def test_findings_differ_by_who_knows_them(tmp_path: Path) -> None:
    run = check(write_robot(tmp_path, before="<!-- urdfcheck: ignore[JNT005] known -->"))
    assert dict(run.suppressed_counts) == {"source": 1, "configuration": 0, "baseline": 0}
    assert replace(run, findings=run.active_findings).suppressed_counts == {
        "source": 0,
        "configuration": 0,
        "baseline": 0,
    }


IMPOSSIBLE = (
    '<link name="{}"><inertial><mass value="1"/>'
    '<inertia ixx="1" iyy="1" izz="5" ixy="0" ixz="0" iyz="0"/></inertial></link>'
)


@pytest.mark.parametrize(("covered", "known"), [("", False), ("a", False), ("b", False), ("bc", False), ("abc", True)])
def test_of_a_finding_about_several_elements_all_must_be_covered(tmp_path: Path, covered: str, known: bool) -> None:
    """A copy that nobody has looked at must not hide behind the one that was."""
    comment = "<!-- urdfcheck: ignore[INR003] measured -->"
    links = [f"{comment if name in covered else ''}{IMPOSSIBLE.format(name)}" for name in "abc"]
    joints = [f'<joint name="{name}" type="fixed"><parent link="a"/><child link="{name}"/></joint>' for name in "bc"]
    path = tmp_path / "r.urdf"
    path.write_text(f'<robot name="r">{"".join(links + joints)}</robot>')
    run = check(path)
    (finding,) = of(run, "INR003")
    assert (finding.suppressed is not None) is known
    assert not of(run, "URC902")


def test_of_comments_on_one_element_each_that_covers_is_needed(tmp_path: Path) -> None:
    comments = "<!-- urdfcheck: ignore[JNT005] {} -->"
    run = check(write_robot(tmp_path, before=comments.format("outer") * 2, inside=comments.format("inner")))
    (finding,) = of(run, "JNT005")
    assert finding.suppressed is not None
    assert finding.suppressed.reason == "inner"  # the nearest
    assert not of(run, "URC902")


def test_the_configuration_decides_how_bad_a_needless_comment_is(tmp_path: Path) -> None:
    path = write_robot(tmp_path, after="<!-- urdfcheck: ignore[JNT005] no -->")
    (needless,) = of(check(path, severities={"URC902": "error"}), "URC902")
    assert str(needless.severity) == "error"
