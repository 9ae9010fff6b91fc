"""URC905: what is larger than anything that is made for a robot is named, and the rest is checked."""

from __future__ import annotations

from pathlib import Path

import pytest
from conftest import check, check_text

from urdfcheck.core import Finding, Severity
from urdfcheck.facts.mesh import decode_limits
from urdfcheck.model import link_graph, tree
from urdfcheck.model.motion import poses
from urdfcheck.source.launch import python_launch_file
from urdfcheck.source.text import xml

CODES = {"URC905", "XML001", "MSH001"}
DEEP = "<a>" * xml.MAX_DEPTH + "</a>" * xml.MAX_DEPTH
TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"


def only(folder: Path, *names: str, codes: set[str] = CODES) -> Finding:
    (finding,) = check(*(folder / name for name in names or ("",)), codes=codes).findings
    assert (finding.code, finding.severity) == ("URC905", Severity.ERROR)
    return finding


@pytest.mark.parametrize("suffix", ["", ".xacro"])
def test_a_model_that_is_nested_too_deeply(tmp_path: Path, suffix: str) -> None:
    (tmp_path / f"r.urdf{suffix}").write_text(f'<robot name="r"><link name="a"/>{DEEP}</robot>')
    finding = only(tmp_path, f"r.urdf{suffix}")
    assert finding.message_id == "model"
    assert finding.data == {
        "error": "elements are nested more than 256 deep",
        "what": "depth",
        "limit": 256,
        "found": 257,
    }


def test_a_file_that_is_included(tmp_path: Path) -> None:
    (tmp_path / "part.xacro").write_text(f"<robot>{DEEP}</robot>")
    ns = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
    (tmp_path / "r.urdf.xacro").write_text(f'<robot name="r" {ns}>\n<xacro:include filename="part.xacro"/></robot>')
    finding = only(tmp_path, "r.urdf.xacro")
    assert finding.location.span is not None
    assert finding.location.span.file.endswith("part.xacro")
    assert [(via.line, via.file[-12:]) for via in finding.location.via] == [(2, "r.urdf.xacro")]


@pytest.mark.parametrize(
    ("name", "root", "message"), [("package.xml", "package", "manifest"), ("a.launch", "launch", "launch")]
)
def test_a_file_beside_the_model(tmp_path: Path, name: str, root: str, message: str) -> None:
    (tmp_path / name).write_text(f"<{root}>{DEEP}</{root}>")
    (tmp_path / "r.urdf").write_text('<robot name="r"><link name="a"/></robot>')
    assert only(tmp_path).message_id == message


def test_a_launch_file_in_python(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(python_launch_file, "MAX_PYTHON", 10)
    path = tmp_path / "a.launch.py"
    path.write_text("x = 12345\n")
    assert not check(path, codes=CODES).findings
    path.write_text("x = 123456\n")
    finding = only(tmp_path, path.name)
    assert (finding.message_id, finding.data["found"]) == ("launch", 11)


def test_a_mesh_with_too_many_triangles(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    shape = '<visual><geometry><mesh filename="arm.obj"/></geometry></visual>'
    (tmp_path / "r.urdf").write_text(f'<robot name="r">\n<link name="a">{shape}{shape}</link></robot>')
    (tmp_path / "arm.obj").write_text(TRIANGLE)
    monkeypatch.setattr(decode_limits, "MOST_TRIANGLES", 1)
    assert not check(tmp_path / "r.urdf", codes=CODES).findings
    (tmp_path / "arm.obj").write_text(TRIANGLE + "f 1 2 3\n")
    finding = only(tmp_path, "r.urdf")
    assert (finding.message_id, len(finding.related)) == ("mesh", 1)
    assert "arm.obj has 2 triangles, more than 1" in finding.message
    assert finding.location.subject == "link[a]/visual[1]/geometry/mesh@filename"


def test_a_mesh_file_with_too_many_bytes(tmp_path: Path) -> None:
    shape = '<visual><geometry><mesh filename="arm.stl"/></geometry></visual>'
    (tmp_path / "r.urdf").write_text(f'<robot name="r"><link name="a">{shape}</link></robot>')
    with (tmp_path / "arm.stl").open("wb") as file:
        file.truncate(2**40)  # a hole: it takes no place
    finding = only(tmp_path, "r.urdf")
    assert "mesh arm.stl has 1,099,511,627,776 bytes, more than" in finding.message


def chain(n: int) -> str:
    inertial = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
    links = "".join(f'<link name="l{i}">{inertial}</link>' for i in range(n))
    joints = "".join(
        f'<joint name="j{i}" type="continuous"><parent link="l{i - 1}"/><child link="l{i}"/><axis xyz="0 0 1"/></joint>'
        for i in range(1, n)
    )
    return f'<robot name="r">{links}{joints}</robot>'


def test_a_chain_of_links_ends_at_a_limit_and_is_named_at_its_last_link(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tree, "MOST_LEVELS", 3)
    assert not check_text(tmp_path, chain(3), codes={"URC905"}).findings
    run = check_text(tmp_path, chain(4), codes={"URC905", "XML014"})
    (finding,) = run.findings
    assert (finding.message_id, finding.location.subject) == ("chain", "link[l3]")
    assert "a chain of 4 links exceeds 3" in finding.message
    assert [skip.code for skip in run.skipped] == ["XML014"]


@pytest.mark.slow
def test_a_chain_of_five_thousand_links_is_named_and_ends_nothing(tmp_path: Path) -> None:
    run = check_text(tmp_path, chain(5_000), codes={"URC905", "KIN004", "XML014"})
    assert [f.code for f in run.findings] == ["URC905"]
    assert not run.failures


def test_motion_of_more_joints_than_it_is_computed_for_is_skipped(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(poses, "MOST_MOVING", 2)
    assert not check_text(tmp_path, chain(3), codes={"DYN001"}).skipped
    (skip,) = check_text(tmp_path, chain(4), codes={"DYN001"}).skipped
    assert skip.reason == "3 joints move, and motion is computed for 2 at most"


def test_names_are_not_compared_letter_by_letter_where_there_are_too_many(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = chain(2).replace('child link="l1"', 'child link="L1"')
    (named,) = check_text(tmp_path, text, codes={"KIN002"}).findings
    monkeypatch.setattr(link_graph, "_MOST_COMPARED", 1)
    (unnamed,) = check_text(tmp_path, text, codes={"KIN002"}).findings
    assert "l1" in str(named.fix)
    assert "l1" not in str(unnamed.fix)
