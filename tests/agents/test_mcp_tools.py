"""The tools for language models: check, mend by id, check again, compare; paths stay in the folder."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest
from builders import inertial, link, robot
from conftest import FIXTURES

from urdfcheck.core import UrdfcheckError
from urdfcheck.mcp.tools import Workspace
from urdfcheck.output.agent import MOST_CHARACTERS

pytestmark = pytest.mark.slow

PITCH = 'rpy="0 -0.75239 0"'
ID = re.compile(r"^\[(\w+)\] warning SYM001 car-3/urdf", re.MULTILINE)


@pytest.fixture
def workspace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Workspace:
    shutil.copytree(FIXTURES / "car-3", tmp_path / "car-3")
    monkeypatch.chdir(tmp_path)
    return Workspace(Path())


def test_a_defect_is_found_mended_by_its_id_and_gone(workspace: Workspace, tmp_path: Path) -> None:
    file = tmp_path / "car-3/urdf/car-3.urdf"
    (found,) = ID.findall(workspace.check(["car-3"], select="SYM001"))
    shown = workspace.fix(["car-3/urdf"], [found])
    assert f'-      {PITCH} />\n+      rpy="0 0 0" />' in shown
    assert "not written: give write=true to write it" in shown
    assert PITCH in file.read_text(encoding="utf-8")

    written = workspace.fix(["car-3/urdf"], [found], write=True)
    assert "\nwritten\n" in written
    assert "SYM001" not in written.partition("after it:")[2]
    assert PITCH not in file.read_text(encoding="utf-8")
    # Only what was asked for: the same mistake in the other file stays.
    assert PITCH in (tmp_path / "car-3/robot_description/urdf/car_body.urdf.xacro").read_text(encoding="utf-8")


def test_what_has_no_edit_or_is_not_there_is_named(workspace: Workspace) -> None:
    with pytest.raises(UrdfcheckError, match=r"^no finding has the id 'deadbeef'\. Those with an edit: \w{8}"):
        workspace.fix(["car-3/urdf"], ["deadbeef"])
    (advice,) = re.findall(r"^\[(\w+)\] warning INR016", workspace.check(["car-3/urdf"], select="INR016"), re.MULTILINE)
    with pytest.raises(UrdfcheckError, match=rf"^{advice} INR016 has no edit: "):
        workspace.fix(["car-3/urdf"], [advice])


@pytest.mark.parametrize("path", ["..", "../other.urdf", "/etc/passwd", "link.urdf"])
def test_no_path_leads_out_of_the_folder(workspace: Workspace, tmp_path: Path, path: str) -> None:
    outside = tmp_path.parent / f"{tmp_path.name}_other.urdf"
    outside.write_text(robot(link("secret", inertial(1))), encoding="utf-8")
    (tmp_path / "link.urdf").symlink_to(outside)
    with pytest.raises(UrdfcheckError, match=r"is outside .*: start urdfcheck mcp in the folder that is meant$"):
        workspace.check([path])
    outside.unlink()


def test_nothing_is_written_outside_the_folder(
    workspace: Workspace, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Though a model of the folder may include it."""
    (tmp_path / "package.xml").write_text("<package format='3'><name>robot</name></package>")
    shared, model = tmp_path / "shared.xacro", tmp_path / "inside/r.urdf.xacro"
    model.parent.mkdir()
    head = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">'
    shared.write_text(f'{head}<link name="a"><inertial><mass value="1 "/></inertial></link></robot>')
    model.write_text(f'{head}<xacro:include filename="../shared.xacro"/></robot>')
    monkeypatch.chdir(model.parent)
    inside = Workspace(Path())
    (found,) = re.findall(r"^\[(\w+)\] error XML007 \.\./shared", inside.check([model.name]), re.MULTILINE)
    with pytest.raises(UrdfcheckError, match=r"shared\.xacro is outside .*: start urdfcheck mcp in the folder"):
        inside.fix([model.name], [found], write=True)
    assert 'value="1 "' in shared.read_text()
    Workspace(tmp_path).fix(["inside"], [found], write=True)
    assert 'value="1"' in shared.read_text()


def test_a_long_answer_comes_in_pages(workspace: Workspace, tmp_path: Path) -> None:
    for number in range(60):
        parts = (link(f"link_{number}_{part}_of_a_robot_with_long_names", inertial(1)) for part in range(9))
        (tmp_path / f"r{number}.urdf").write_text(robot(*parts), encoding="utf-8")
    first = workspace.describe(".")
    end = re.search(r"\n… page 1 of (\d+): page=2 has the next$", first)
    assert end is not None
    pages = [first, *(workspace.describe(".", page) for page in range(2, int(end[1]) + 1))]
    assert max(map(len, pages)) < 1.1 * MOST_CHARACTERS
    told = "".join(pages)
    assert all(told.count(f"link_{number}_8_of_a_robot") == 1 for number in range(60))
    with pytest.raises(UrdfcheckError, match=r"there is no page 99: the answer has \d+"):
        workspace.describe(".", 99)


def test_a_robot_is_told_on_a_page(workspace: Workspace) -> None:
    page = workspace.describe("car-3/urdf/car-3.urdf").splitlines()
    assert page[0] == "car-3/urdf/car-3.urdf: 5 links, 4 moving joints (0 mimic), 0.6105 kg in 5 links"
    assert page[1] == "base_link (0.4973 kg, 1000 kg/m³, 1 visual, 1 collision)"
    assert page[2].startswith("  wheel_1_to_base_link: continuous, axis 0 1 0 → wheel_1 (")


def test_a_robot_tells_how_far_its_chains_reach(workspace: Workspace, tmp_path: Path) -> None:
    """The elbow is a right angle at least, the slide is half a metre long, and the finger follows it."""
    parts = [
        ("shoulder", "continuous", "base", "upper", "0 0 5", "", ""),
        (
            "elbow",
            "revolute",
            "upper",
            "lower",
            "1 0 0",
            '<limit lower="1.5707963" upper="2" effort="1" velocity="1"/>',
            "",
        ),
        (
            "slide",
            "prismatic",
            "lower",
            "tool",
            "1 0 0",
            '<limit lower="-0.1" upper="0.5" effort="1" velocity="1"/>',
            "",
        ),
        ("wrist", "fixed", "tool", "tip", "0 0 0", "", ""),
        ("claw", "prismatic", "lower", "finger", "1 0 0", "", '<mimic joint="slide" multiplier="2" offset="-1"/>'),
        ("loose", "revolute", "base", "flap", "0 0 0", "", ""),
    ]
    joints = "".join(
        f'<link name="{child}"/><joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{xyz}"/><axis xyz="{"0 0 1" if kind[0] in "cr" else "1 0 0"}"/>{limit}{mimic}</joint>'
        for name, kind, parent, child, xyz, limit, mimic in parts
    )
    (tmp_path / "arm.urdf").write_text(f'<robot name="r"><link name="base"/>{joints}</robot>')
    reaches = [line for line in workspace.describe("arm.urdf").splitlines() if line.startswith("reach")]
    assert reaches == [
        "reach: tip comes 1.8 m away from shoulder, and never more than 2.5 m",
        "reach: finger comes 1.41 m away from shoulder, and never more than 3.2 m",
    ]


XACRO = """<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">
<xacro:property name="heavy" value="2.5"/>
<xacro:macro name="part" params="name mass">
<link name="${name}"><inertial><mass value="${mass * 2}"/></inertial></link>
</xacro:macro>
<xacro:part name="arm" mass="${heavy}"/>
</robot>"""


def test_a_number_is_led_back_to_where_it_was_typed(workspace: Workspace, tmp_path: Path) -> None:
    (tmp_path / "arm.xacro").write_text(XACRO, encoding="utf-8")
    lines = [line.strip() for line in workspace.expand("arm.xacro", "link[arm]/inertial/mass").splitlines()]
    assert lines[:2] == ["arm.xacro:4 ${mass * 2}", "= 5.0 in link[arm]/inertial/mass@value"]
    assert "parameter mass: ${heavy} = 2.5 at arm.xacro:6" in lines
    assert "property heavy: 2.5 at arm.xacro:2" in lines
    assert workspace.expand("arm.xacro", "nothing like it") == "no expression of arm.xacro matches 'nothing like it'"
    assert workspace.expand("car-3/urdf/car-3.urdf") == "car-3/urdf/car-3.urdf has no expressions"


def test_a_model_that_is_not_one_is_explained_instead_of_described(workspace: Workspace, tmp_path: Path) -> None:
    (tmp_path / "broken.urdf").write_text("<robot", encoding="utf-8")
    assert "error XML001 broken.urdf" in workspace.describe("broken.urdf")


def test_two_versions_are_compared(workspace: Workspace, tmp_path: Path) -> None:
    text = (tmp_path / "car-3/urdf/car-3.urdf").read_text(encoding="utf-8")
    (tmp_path / "car-3/urdf/new.urdf").write_text(text.replace(PITCH, 'rpy="0 0 0"'), encoding="utf-8")
    said = workspace.compare("car-3/urdf/car-3.urdf", "car-3/urdf/new.urdf")
    assert said.startswith("wheel_1 rotates by up to 43.1° and stays at its place")


def test_a_rule_is_explained_and_a_robot_drawn(workspace: Workspace) -> None:
    assert workspace.explain("INR003").startswith("# INR003 triangle-inequality")
    with pytest.raises(UrdfcheckError, match="XYZ999"):
        workspace.explain("XYZ999")
    assert workspace.draw("car-3/urdf/car-3.urdf").startswith(b"\x89PNG")
