"""XML rules: boundaries that a page cannot show."""

from __future__ import annotations

import re
from functools import partial
from pathlib import Path

import pytest
from builders import box, find, link, robot, visual
from conftest import check, check_text

from urdfcheck.core import Applicability, Finding, Severity
from urdfcheck.core.merging import join_occurrences
from urdfcheck.model.motion.pinocchio_model import capture_stderr
from urdfcheck.rules import load_rules

ROBOT = '<robot name="r"><link name="a"/><link name="b">{link}</link>{joint}</robot>'
JOINT = (
    '<joint name="j" type="revolute"><parent link="a"/><child link="b"/>'
    '<limit lower="0" upper="1" effort="{effort}" velocity="1"/>{more}</joint>'
)


def findings(folder: Path, text: str, code: str, name: str = "robot.urdf") -> list[Finding]:
    run = check_text(folder, text, name, codes={code})
    assert not run.failures
    return [f for f in run.findings if f.code == code]


def with_effort(value: str) -> str:
    return ROBOT.format(link="", joint=JOINT.format(effort=value, more=""))


class TestXML001:
    @pytest.mark.parametrize(
        ("text", "message", "cause"),
        [
            ("version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1\n", "other", "git_lfs"),
            ("<html><body><p>not found</body></html>", "other", "web_page"),
            ("<!DOCTYPE html><html/>", "other", "web_page"),
            ("there.urdf", "other", "git_link"),
            ("absent.urdf", "malformed", None),
            ('<robot name="r">\n<<<<<<< HEAD\n<link name="a"/>\n=======\n', "malformed", "merge_conflict"),
            ('\n<?xml version="1.0"?><robot name="r"><link name="a"/></robot>', "forgiven", None),
            ('<robot name="r"><link name="a></robot>', "malformed", None),
            ("", "empty", None),
            ("\x1f\0\0", "binary", None),
        ],
    )
    def test_names_what_the_file_really_is(self, tmp_path: Path, text: str, message: str, cause: str | None) -> None:
        (tmp_path / "there.urdf").touch()
        (finding,) = findings(tmp_path, text, "XML001")
        assert (finding.message_id, finding.cause.id if finding.cause else None) == (message, cause)

    def test_an_address_with_a_line_break_is_named_and_not_the_file(self, tmp_path: Path) -> None:
        address = 'xmlns:xacro="http://www.ros.org/wiki/xacro" xmlns:ctl="http://a.b/\n#ctl"'
        (finding,) = findings(tmp_path, f'<robot name="r" {address}><link name="a"/></robot>', "XML001", "r.xacro")
        assert finding.message_id == "address"
        assert "the prefix 'ctl'" in finding.message
        assert finding.fix is not None
        assert "permission" not in finding.fix.title
        assert set(finding.consequences) == {"xacro"}

    def test_a_prefix_without_an_address_is_no_fault_of_the_file_name(self, tmp_path: Path) -> None:
        address = 'xmlns:xacro="http://www.ros.org/wiki/xacro" xmlns:ctl=""'
        (finding,) = findings(tmp_path, f'<robot name="r" {address}><link name="a"/></robot>', "XML001", "r.xacro")
        assert finding.fix is not None
        assert finding.fix.title.startswith("correct the declaration of the prefix")

    @pytest.mark.parametrize(
        ("text", "repair"),
        [
            ("<robot><-- limit a='1'/ --></robot>", "write `<!--` in place of `<--`"),
            ("<robot><group><arg></group></robot>", "delete that <arg>, or write its attributes and `/>`"),
            ("</robot>", "write `<robot>` and its content before it, or delete the file"),
        ],
    )
    def test_the_repair_does_not_lead_to_the_next_mistake(self, tmp_path: Path, text: str, repair: str) -> None:
        (finding,) = findings(tmp_path, text, "XML001")
        assert finding.fix is not None
        assert finding.fix.title == repair

    def test_the_repair_of_a_launch_file_in_latin_1_is_its_encoding(self, tmp_path: Path) -> None:
        path = tmp_path / "a.launch"
        path.write_bytes(b'<launch><arg name="a" default="\xf3"/></launch>')
        (finding,) = check(path, codes={"XML001"}).findings
        assert finding.fix is not None
        assert finding.fix.title == "save the file as UTF-8"

    @pytest.mark.parametrize("text", ["", "\x1f\0\0"])
    def test_of_a_file_without_xml_nothing_is_said_to_pass(self, tmp_path: Path, text: str) -> None:
        (finding,) = findings(tmp_path, text, "XML001")
        assert "lenient" not in finding.consequences.get("urdfdom", "")

    @pytest.mark.parametrize(
        ("text", "message"),
        [
            ("", "launch"),
            ("<launch>\n<node/>", "launch"),
            ("<!DOCTYPE html><html/>", "launch"),
            ("<!DOCTYPE launch []><launch/>", "unread"),  # ROS reads it
            ('<!DOCTYPE launch SYSTEM "launch.dtd"><launch/>', None),
            ("<launch/>", None),
        ],
    )
    @pytest.mark.parametrize("folder", [True, False])
    def test_launch_file(self, tmp_path: Path, text: str, message: str | None, folder: bool) -> None:
        (tmp_path / "car.launch").write_text(text)
        (tmp_path / "car.urdf").write_text('<robot name="r"><link name="a"/></robot>')
        run = check(tmp_path if folder else tmp_path / "car.launch", codes={"XML001", "XML002"})
        assert [f.message_id for f in run.findings] == ([message] if message else [])
        if message == "launch":
            assert run.findings[0].severity == (Severity.ERROR if text else Severity.WARNING)
            assert run.findings[0].consequences.keys() == {"roslaunch", "ros2_launch"}

    @pytest.mark.parametrize("text", ["#!/bin/sh\nexec 3<in\n", "#!/usr/bin/env python3\nimport os\n", "import os\n"])
    def test_a_script_is_no_launch_file(self, tmp_path: Path, text: str) -> None:
        (tmp_path / "case_py.launch").write_text(text)
        (tmp_path / "car.urdf").write_text('<robot name="r"><link name="a"/></robot>')
        assert not check(tmp_path, codes={"XML001", "XML002"}).findings
        (named,) = check(tmp_path / "case_py.launch", codes={"XML001", "XML002"}).findings
        assert named.fix is not None
        assert (named.message_id, named.fix.title.partition(" if ")[0]) == ("launch", "name it `.launch.py`")

    @pytest.mark.parametrize(
        ("text", "codes"),
        [
            ("", ["XML001"]),
            ("<package><name>p</package>", ["XML001"]),
            ("<manifest><name>p</name></manifest>", ["XML002"]),
            ("<package/>", ["PKG006"]),
            ("<package><name>pkg</name></package>", []),
        ],
    )
    def test_manifest(self, tmp_path: Path, text: str, codes: list[str]) -> None:
        (tmp_path / "package.xml").write_text(text)
        (tmp_path / "r.urdf").write_text('<robot name="r"><link name="a"/></robot>')
        run = check(tmp_path / "r.urdf", codes={"XML001", "XML002", "PKG006"})
        assert [f.code for f in run.findings] == codes
        for finding in run.findings:
            assert finding.severity == Severity.ERROR
            assert finding.location.span is not None
            assert finding.location.span.file.endswith("package.xml")
            assert "urdfdom" not in finding.consequences

    def test_an_empty_manifest_is_written_or_deleted(self, tmp_path: Path) -> None:
        (tmp_path / "package.xml").touch()
        (tmp_path / "r.urdf").write_text('<robot name="r"><link name="a"/></robot>')
        (finding,) = check(tmp_path / "r.urdf", codes={"XML001"}).findings
        assert finding.fix is not None
        assert finding.fix.title == "write its content, or delete the file"

    def test_bytes_that_are_no_text(self, tmp_path: Path) -> None:
        path = tmp_path / "r.urdf"
        path.write_bytes(b'<robot name="r">\n<link name="caf\xe9"/></robot>')
        (finding,) = check(path, codes={"XML001"}).findings
        assert finding.message_id == "encoding"
        assert finding.location.span is not None
        assert (finding.location.span.line, finding.location.span.col) == (2, 16)

    def test_undeclared_prefix_stops_xacro_and_not_urdf(self, tmp_path: Path) -> None:
        text = '<robot name="r"><link name="a"/><foo:bar/></robot>'
        (plain,) = findings(tmp_path, text, "XML001")
        (xacro,) = findings(tmp_path, text, "XML001", "robot.urdf.xacro")
        assert (plain.severity, xacro.severity) == (Severity.WARNING, Severity.ERROR)

    @pytest.mark.parametrize(
        ("tag", "address", "more"),
        [
            ("sensor:camera", "http://playerstage.sourceforge.net/gazebo/xmlschema/#sensor", "delete the elements"),
            ("drake:bushing", "http://drake.mit.edu", "declare it"),
            ("foo:bar", "…", "declare it"),
        ],
    )
    def test_the_prefix_that_is_used_is_to_be_declared(self, tmp_path: Path, tag: str, address: str, more: str) -> None:
        (found,) = findings(tmp_path, f'<robot name="r"><link name="a"/><{tag}/></robot>', "XML001")
        assert found.fix is not None
        assert f'`xmlns:{tag.partition(":")[0]}="{address}"`' in found.fix.title
        assert found.fix.title.startswith(more)

    def test_an_undeclared_xacro_prefix_in_a_urdf_is_the_defect(self, tmp_path: Path) -> None:
        text = '<robot name="r"><xacro:arm/><link name="${l}"/></robot>'
        (found,) = check_text(tmp_path, text, codes={"XML001", "XML009"}).findings
        assert (found.code, found.message_id, found.severity.name) == ("XML001", "xacro-prefix", "ERROR")
        assert "xmlns:xacro" in found.message


class TestXML009:
    @pytest.mark.parametrize(
        ("body", "held"),
        [
            ('<link name="${l}"/>', "1 substitution of"),
            ('<link name="${l}"/><joint name="$(arg j)"/>', "2 substitutions of"),
        ],
    )
    def test_what_is_left_is_counted(self, tmp_path: Path, body: str, held: str) -> None:
        (found,) = check_text(tmp_path, f'<robot name="r">{body}</robot>', codes={"XML009"}).findings
        assert f"contains {held} xacro" in found.message

    @pytest.mark.parametrize(
        ("body", "repair"),
        [
            ('<mesh filename="file://$(find p)/a.stl"/>', "write `package://p/…` for `file://$(find p)/…`, or load"),
            ('<mesh filename="$(find p)/$(arg a).stl"/>', "load what xacro makes of it"),
        ],
    )
    def test_a_path_in_a_package_needs_no_xacro(self, tmp_path: Path, body: str, repair: str) -> None:
        visual = f"<visual><geometry>{body}</geometry></visual>"
        text = f'<robot name="r"><link name="a">{visual}</link></robot>'
        (found,) = check_text(tmp_path, text, codes={"XML009"}).findings
        assert found.fix is not None
        assert found.fix.title.startswith(repair)

    @pytest.mark.parametrize("given", ["robot", "link", "nothing", "more"])
    @pytest.mark.parametrize("xacro", [False, True])
    def test_a_name_of_a_material_may_be_any_text(self, tmp_path: Path, given: str, xacro: bool) -> None:
        """Without a definition of this name parsers refuse the file, and any other text that is left is as wrong as ever."""
        name = '"$${n}_black"' if xacro else '"${n}_black"'
        black = f'<material name={name}><color rgba="0 0 0 1"/></material>'
        shape = visual(box("1 1 1")).replace("</visual>", f"<material name={name}/></visual>")
        drawn = visual(box("1 1 1")).replace("</visual>", f"{black}</visual>")
        more = link(name.strip('"')) if given == "more" else ""
        parts = [black] if given in {"robot", "more"} else []
        text = robot(*parts, link("a", drawn if given == "link" else shape), more, xacro=xacro)
        found = check_text(
            tmp_path, text, "r.urdf.xacro" if xacro else "r.urdf", codes={"XML009"}, unrequested=frozenset()
        ).findings
        is_harmless = given in {"robot", "link"}
        assert found
        assert all(f.severity is Severity.INFO for f in found) == is_harmless
        assert all((f.message_id == "material") == (f.severity is Severity.INFO) for f in found)

    @pytest.mark.parametrize("text", ["<launch/>", '<param name="robot_description" textfile="$(find p)/arm.urdf"/>'])
    def test_a_urdf_that_a_xacro_includes_is_expanded_there(self, tmp_path: Path, text: str) -> None:
        ns = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
        (tmp_path / "package.xml").write_text("<package format='2'><name>p</name></package>")
        (tmp_path / "show.launch").write_text(text if text == "<launch/>" else f"<launch>{text}</launch>")
        (tmp_path / "arm.urdf").write_text('<robot name="arm"><link name="${side}"/></robot>')
        including = '<xacro:property name="side" value="a"/><xacro:include filename="arm.urdf"/>'
        (tmp_path / "r.urdf.xacro").write_text(f'<robot name="r" {ns}>{including}</robot>')
        (found,) = check(tmp_path, codes={"XML009"}).findings
        assert (found.message_id, found.severity) == (
            ("included", Severity.INFO) if text == "<launch/>" else ("not_expanded", Severity.ERROR)
        )

    @pytest.mark.parametrize(
        ("launch", "name", "severity"),
        [
            ("<launch/>", "$(find p)", Severity.INFO),
            (
                '<launch><param name="robot_description" textfile="$(find p)/r.urdf"/></launch>',
                "$(find p)",
                Severity.WARNING,
            ),
            ("<launch/>", "${size}", Severity.WARNING),  # xacro would not know it
        ],
    )
    def test_xacro_in_a_block_for_gazebo_matters_where_nothing_expands_it(
        self, tmp_path: Path, launch: str, name: str, severity: Severity
    ) -> None:
        (tmp_path / "package.xml").write_text("<package format='2'><name>p</name></package>")
        (tmp_path / "show.launch").write_text(launch)
        block = f'<gazebo><plugin name="a" filename="a.so"><yaml>{name}/a.yaml</yaml></plugin></gazebo>'
        (found,) = check_text(
            tmp_path, f'<robot name="r"><link name="a"/>{block}</robot>', "r.urdf", codes={"XML009"}
        ).findings
        assert (found.message_id, found.severity) == ("gazebo", severity)

    @pytest.mark.parametrize(
        ("body", "message", "severity"),
        [
            ('<xacro:property name="side" value="1"/>', "leftover", Severity.INFO),
            ('<!-- <xacro:macro name="arm"> --><xacro:arm/>', "leftover", Severity.INFO),
            ('<xacro:property name="side" value="1"/><xacro:arm/>', "not_expanded", Severity.ERROR),
            ('<xacro:arm/><link name="${side}"/>', "not_expanded", Severity.ERROR),
        ],
    )
    def test_what_xacro_left_in_its_result_is_no_loss(
        self, tmp_path: Path, body: str, message: str, severity: Severity
    ) -> None:
        ns = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
        text = f'<!-- autogenerated by xacro --><robot name="r" {ns}><link name="a"/>{body}</robot>'
        (found,) = check_text(tmp_path, text, codes={"XML009"}).findings
        assert (found.message_id, found.severity) == (message, severity)
        assert found.fix is not None
        assert ("include the file that defines <xacro:arm>" in found.fix.title) == (
            "<xacro:property name" in body and severity is Severity.ERROR
        )


@pytest.mark.parametrize(
    ("comment", "rest"),
    [
        ("<!-- a <!-- b -->", ""),
        ("<!-- a <!-- b --> <!-- c -->", ""),
        ("<!-- a <!-- b --> c -->", ", or, if all up to line 2 is to be left out, delete this `<!--` and the first"),
        (
            "<!-- a <!-- b --> <!-- c --> -->",
            ", or, if all up to the last `-->` of line 2 is to be left out, delete each `<!--` and `-->` in between",
        ),
    ],
)
def test_a_comment_in_a_comment_ends_it_unless_an_end_is_left_over(tmp_path: Path, comment: str, rest: str) -> None:
    text = f'<robot name="r">\n{comment}<link name="a"/></robot>'
    (finding,) = findings(tmp_path, text, "XML001")
    assert finding.fix is not None
    start = "end the comment of line 2 before this `<!--`"
    assert finding.fix.title.startswith(start + rest)
    assert bool(rest) == (finding.fix.title != start)


class TestXML002:
    def test_included_file_needs_no_name(self, tmp_path: Path) -> None:
        ns = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
        (tmp_path / "part.xacro").write_text(f'<robot {ns}><link name="a"/></robot>')
        text = f'<robot name="r" {ns}><xacro:include filename="part.xacro"/></robot>'
        assert not findings(tmp_path, text, "XML002", "robot.urdf.xacro")

    def test_block_for_gazebo_alone_is_no_old_sdf_model(self, tmp_path: Path) -> None:
        block = '<gazebo {}><plugin name="p" filename="libp.so"/></gazebo>'
        (part,) = findings(
            tmp_path, block.format('xmlns:xacro="http://www.ros.org/wiki/xacro"'), "XML002", "sensors.xacro"
        )
        (old,) = findings(tmp_path, block.format('version="1.0"'), "XML002")
        (plain,) = findings(tmp_path, block.format(""), "XML002")
        assert (part.message_id, old.message_id, plain.message_id) == ("root", "format", "root")
        assert (part.severity, old.severity, plain.severity) == (Severity.ERROR, Severity.ERROR, Severity.WARNING)

    @pytest.mark.parametrize(
        ("inside", "message"),
        [('<model path="a.urdf"/>', "format"), ('<model name="a"/>', "root"), ('<link name="a"/>', "root")],
    )
    def test_a_world_that_names_the_files_of_its_robots_is_none_of_urdf(
        self, tmp_path: Path, inside: str, message: str
    ) -> None:
        text = f'<world name="w"><robot name="r">{inside}</robot></world>'
        (finding,) = findings(tmp_path, text, "XML002")
        severity = Severity.INFO if message == "format" else Severity.ERROR
        assert (finding.message_id, finding.severity) == (message, severity)

    @pytest.mark.parametrize(("name", "count"), [("bay.scn.xacro", 0), ("bay.urdf.xacro", 1)])
    def test_xacro_may_make_another_format_unless_the_name_says_urdf(
        self, tmp_path: Path, name: str, count: int
    ) -> None:
        ns = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
        text = f'<scenario {ns}><xacro:macro name="m" params=""><robot/></xacro:macro><xacro:m/></scenario>'
        (tmp_path / name).write_text(text)
        assert len(check(tmp_path, codes={"XML002"}).findings) == count

    @pytest.mark.parametrize(
        ("name", "is_robot", "count"),
        [
            ("room.sdf.xacro", False, 0),
            ("room.world.xacro", False, 0),
            ("room.xacro", False, 1),
            ("room.urdf.xacro", False, 1),
            ("room.sdf.xacro", True, 1),
        ],
    )
    def test_a_xacro_of_sdf_that_says_so_is_no_robot_unless_it_is_loaded_as_one(
        self, tmp_path: Path, name: str, is_robot: bool, count: int
    ) -> None:
        ns = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
        (tmp_path / "package.xml").write_text('<package format="2"><name>p</name></package>')
        (tmp_path / name).write_text(f'<sdf version="1.7" {ns}><world name="room"/></sdf>')
        if is_robot:
            param = f'<param name="robot_description" command="xacro $(find p)/{name}"/>'
            (tmp_path / "a.launch").write_text(f"<launch>{param}</launch>")
        else:
            path = f"os.path.join(get_package_share_directory('p'), '{name}')"
            (tmp_path / "a.launch.py").write_text(f"text = Command(['xacro ', {path}])\n")
        assert len(check(tmp_path, codes={"XML002"}).findings) == count

    def test_sdf_that_gazebo_finds_by_its_settings_is_an_info(self, tmp_path: Path) -> None:
        text = '<sdf version="1.7"><model name="car"><link name="base"/></model></sdf>'
        (alone,) = findings(tmp_path, text, "XML002", "model.urdf")
        (tmp_path / "model.config").write_text('<model><name>car</name><sdf version="1.6">model.urdf</sdf></model>')
        (named,) = findings(tmp_path, text, "XML002", "model.urdf")
        assert (alone.severity, named.severity) == (Severity.ERROR, Severity.INFO)
        assert alone.fix is not None
        assert "let its name end in `.sdf`" in alone.fix.title

    @pytest.mark.parametrize(
        ("inside", "severity"), [("library_kinematics_models", Severity.INFO), ("asset", Severity.ERROR)]
    )
    def test_collada_with_a_mechanism_is_a_robot_of_ros_1(
        self, tmp_path: Path, inside: str, severity: Severity
    ) -> None:
        (finding,) = findings(tmp_path, f"<COLLADA><{inside}/></COLLADA>", "XML002")
        assert finding.severity is severity

    @pytest.mark.parametrize(
        ("text", "repair"),
        [
            ('<urdf><robot name="r"><link name="a"/></robot></urdf>', "delete the <urdf> around <robot>"),
            ('<sdf><ros2_control name="c" type="system"/></sdf>', "in place of `<sdf>`, also in the end tag"),
            ('<machine><part name="a"/></machine>', "wrap what is in the file"),
        ],
    )
    def test_the_repair_of_a_wrong_root_keeps_one_robot(self, tmp_path: Path, text: str, repair: str) -> None:
        (finding,) = findings(tmp_path, text, "XML002")
        assert finding.message_id == "root"
        assert finding.fix is not None
        assert repair in finding.fix.title

    @pytest.mark.parametrize(("named", "severity"), [("car.xacro", Severity.WARNING), ("other.xacro", Severity.INFO)])
    def test_a_nameless_xacro_that_its_package_does_not_name_is_a_part_for_others(
        self, tmp_path: Path, named: str, severity: Severity
    ) -> None:
        files = {
            "package.xml": '<package format="2"><name>p</name></package>',
            "car.xacro": '<robot xmlns:xacro="http://www.ros.org/wiki/xacro"><link name="a"/></robot>',
            "a.launch": f'<launch><param name="p" value="$(find p)/{named}"/></launch>',
        }
        for name, text in files.items():
            (tmp_path / name).write_text(text)
        (finding,) = check(tmp_path, codes={"XML002"}).findings
        assert finding.severity is severity

    def test_nameless_xacro_is_a_warning_however_it_is_found(self, tmp_path: Path) -> None:
        text = '<robot xmlns:xacro="http://www.ros.org/wiki/xacro"><link name="a"/></robot>'
        (named,) = findings(tmp_path, text, "XML002", "robot.urdf.xacro")
        (found,) = check(tmp_path, codes={"XML002"}).findings
        assert named.severity is found.severity is Severity.WARNING

    def test_a_part_that_hangs_on_a_link_elsewhere_is_told_as_that(self, tmp_path: Path) -> None:
        joint = '<joint name="j" type="fixed"><parent link="hand"/><child link="a"/></joint>'
        text = f'<robot xmlns:xacro="http://www.ros.org/wiki/xacro"><link name="a"/>{joint}</robot>'
        run = check_text(tmp_path, text, "camera.xacro", codes={"XML002", "KIN002"})
        assert [f.code for f in run.findings] == ["KIN002"]

    def test_empty_robot_in_a_folder_is_a_placeholder(self, tmp_path: Path) -> None:
        (tmp_path / "empty.urdf").write_text("<robot></robot>")
        assert not check(tmp_path, codes={"XML002", "KIN007"}).findings


class TestXML003:
    def test_an_element_of_several_shapes_is_moved_into_what_is_around_it(self, tmp_path: Path) -> None:
        box = '<geometry><box size="1 1 1"/><origin xyz="0 0 1"/></geometry>'
        shapes = f"<visual>{box}</visual><collision>{box}</collision>"
        (finding,) = findings(tmp_path, f'<robot name="r"><link name="a">{shapes}</link></robot>', "XML003")
        assert finding.fix is not None
        assert finding.fix.title.startswith("move it into the <visual> or <collision> around it")

    @pytest.mark.parametrize(("beside", "repaired"), [("", True), ('<dynamics damping="1"/>', False)])
    def test_is_not_renamed_to_an_element_that_exists_beside_it(
        self, tmp_path: Path, beside: str, repaired: bool
    ) -> None:
        joint = f'<joint name="j" type="continuous"><parent link="a"/><child link="b"/>{beside}'
        text = (
            f'<robot name="r"><link name="a"/><link name="b"/>{joint}<joint_properties damping="0.2"/></joint></robot>'
        )
        (finding,) = findings(tmp_path, text, "XML003")
        assert finding.fix is not None
        assert bool(finding.fix.edits) == repaired
        assert ("<dynamics>`" in finding.fix.title) == repaired
        assert ("delete it: <joint> already has a <dynamics>" in finding.fix.title) != repaired

    def test_a_second_visual_is_renamed_beside_the_first(self, tmp_path: Path) -> None:
        shape = "<geometry><sphere radius='1'/></geometry>"
        text = f'<robot name="r"><link name="a"><visual>{shape}</visual><visuals>{shape}</visuals></link></robot>'
        (finding,) = findings(tmp_path, text, "XML003")
        assert finding.fix is not None
        assert finding.fix.edits

    @pytest.mark.parametrize(
        ("inside", "repair"),
        [
            (
                '<collision><mass value="1"/><geometry><sphere radius="1"/></geometry></collision>',
                "delete it: the <inertial>",
            ),
            (
                '<visual><inertial><mass value="1"/></inertial><geometry><sphere radius="1"/></geometry></visual>',
                "delete it: the <link>",
            ),
            (
                '<plugin name="p" filename="libp.so"><rate>1</rate></plugin>',
                "move it into a `<gazebo>` without reference",
            ),
            ("<static>true</static>", "move it into a `<gazebo>` without reference"),
        ],
    )
    def test_repair_neither_doubles_an_element_nor_gives_that_of_a_model_to_a_link(
        self, tmp_path: Path, inside: str, repair: str
    ) -> None:
        inertial = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
        text = f'<robot name="r"><link name="a">{inertial}{inside}</link></robot>'
        (finding,) = check_text(tmp_path, text, codes={"XML003"}).findings
        assert finding.fix is not None
        assert finding.fix.title.startswith(repair)

    def test_gazebo_misses_an_sdf_element_outside_its_block(self, tmp_path: Path) -> None:
        text = '<robot name="r"><link name="a"><self_collide>1</self_collide><toy/></link></robot>'
        by_message = {finding.message_id: finding.consequences for finding in findings(tmp_path, text, "XML003")}
        assert by_message["sdf"]["gazebo"].startswith("ignores")
        assert "gazebo" not in by_message["ignored"]

    @pytest.mark.parametrize(
        ("origin", "verb"),
        [('xyz="0 0 1" rpy="0 0 0"', "delete"), ('xyz="0 0 1.0"', "delete"), ('xyz="0 0 2"', "move")],
    )
    def test_an_origin_that_the_joint_above_has_too_is_to_be_deleted(
        self, tmp_path: Path, origin: str, verb: str
    ) -> None:
        joint = '<joint name="j" type="fixed"><parent link="a"/><child link="b"/><origin xyz="0 0 1"/></joint>'
        text = f'<robot name="r"><link name="a"/><link name="b"><origin {origin}/></link>{joint}</robot>'
        (finding,) = findings(tmp_path, text, "XML003")
        assert finding.fix is not None
        assert finding.fix.title.split()[0] == verb

    @pytest.mark.parametrize(
        ("parent", "repair"), [("a", "has the same"), ("j", "has its own <parent>")], ids=["same", "the joint itself"]
    )
    def test_a_parent_that_names_another_one_than_the_joint_is_not_the_same(
        self, tmp_path: Path, parent: str, repair: str
    ) -> None:
        joint = '<joint name="j" type="fixed"><parent link="a"/><child link="b"/></joint>'
        text = f'<robot name="r"><link name="a"/><link name="b"><parent link="{parent}"/></link>{joint}</robot>'
        (finding,) = findings(tmp_path, text, "XML003")
        assert finding.fix is not None
        assert finding.fix.title == f"delete it: the joint that places the link {repair}"

    def test_repairs_of_several_kinds_are_all_told(self, tmp_path: Path) -> None:
        inertial = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
        text = f'<robot name="r"><link name="a"><limit effort="1"/><mass value="1"/>{inertial}</link></robot>'
        joint = join_occurrences(findings(tmp_path, text, "XML003"), load_rules())
        assert joint.fix is not None
        assert (
            joint.fix.title
            == "move it into <joint>, or delete it; elsewhere delete it: <inertial> beside it has its own"
        )

    @pytest.mark.parametrize(
        ("mass", "end"),
        [("2", "own; where the two differ (a: 2 and 1), write the right one there"), ("1.01", "own")],
    )
    def test_a_number_typed_twice_is_one_of_the_two(self, tmp_path: Path, mass: str, end: str) -> None:
        inertial = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
        text = f'<robot name="r"><link name="a"><mass>{mass}</mass>{inertial}</link></robot>'
        (finding,) = findings(tmp_path, text, "XML003")
        assert finding.fix is not None
        assert finding.fix.title.endswith(end)

    @pytest.mark.parametrize(
        ("before", "element", "repair"),
        [
            ('<link name="a"/>', "inertial", "move it into link a, which ends just before it"),
            (
                '<link name="a"><inertial><mass value="2"/></inertial></link>',
                "inertial",
                "keep one: link a before it has its own <inertial>, with other values (<mass> value 2 there and 1 here);",
            ),
            (
                '<link name="a"><inertial><mass value="1.0"/></inertial></link>',
                "inertial",
                "delete it: link a before it has the same <inertial>",
            ),
            (
                '<link name="a"><visual><geometry><sphere radius="1"/></geometry></visual></link><link name="tip"/>',
                "inertial",
                "move it into link a: link tip between them is an empty frame",
            ),
            ("<gazebo/>", "inertial", "move it into <link>, or delete it where that has one already"),
            ('<joint name="j"/>', "origin", "move it into joint j, which ends just before it"),
        ],
    )
    def test_an_element_of_the_robot_belongs_in_the_one_before_it(
        self, tmp_path: Path, before: str, element: str, repair: str
    ) -> None:
        inside = f'{before}<{element}><mass value="1"/></{element}><link name="b"/>'
        found = [
            f for f in findings(tmp_path, f'<robot name="r">{inside}</robot>', "XML003") if f.data["tag"] == element
        ]
        assert found[0].fix is not None
        assert found[0].fix.title.startswith(repair)

    @pytest.mark.parametrize("before", ["", '<link name="a"/>', '<joint name="j"><origin xyz="1 0 0"/></joint>'])
    def test_an_origin_of_the_robot_is_read_by_gazebo(self, tmp_path: Path, before: str) -> None:
        text = f'<robot name="r">{before}<origin xyz="0 0 1"/><link name="b"/></robot>'
        assert not findings(tmp_path, text, "XML003")

    def test_an_element_before_its_twin_is_left_over(self, tmp_path: Path) -> None:
        joint = '<joint name="j" type="fixed"><origin xyz="0.0 0 1"/><parent link="a"/><child link="b"/></joint>'
        text = f'<robot name="r"><link name="a"/><link name="b"/><origin rpy="0 0 0" xyz="0 0 1"/>{joint}</robot>'
        (found,) = findings(tmp_path, text, "XML003")
        assert found.fix is not None
        assert found.fix.title == "delete it: joint j after it has the same"

    def test_the_element_of_another_repair_is_named(self, tmp_path: Path) -> None:
        inertial = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
        joints = '<joint name="j" type="fixed"><parent link="a"/><child link="b"/></joint>'
        links = f'<link name="a"><limit effort="1"/>{inertial}</link><link name="b"><mass value="1"/>{inertial}</link>'
        text = f'<robot name="r">{links}{joints}</robot>'
        joint = join_occurrences(findings(tmp_path, text, "XML003"), load_rules())
        assert joint.fix is not None
        assert joint.fix.title == "move it into <joint>, or delete it; b: delete it: <inertial> beside it has its own"

    @pytest.mark.parametrize(("angle", "is_lost"), [("6.283185307", False), ("-6.2832", False), ("3.1416", True)])
    def test_a_misplaced_whole_turn_loses_nothing(self, tmp_path: Path, angle: str, is_lost: bool) -> None:
        text = f'''<robot name="r"><link name="a"><visual><geometry><box size="1 1 1" rpy="{angle} 0 0"/></geometry></visual>
            </link></robot>'''
        assert bool(findings(tmp_path, text, "XML004")) == is_lost

    def test_inertia_in_a_link_is_misplaced_and_not_misspelt(self, tmp_path: Path) -> None:
        (finding,) = findings(tmp_path, '<robot name="r"><link name="a"><inertia ixx="1"/></link></robot>', "XML003")
        assert finding.message_id == "misplaced"

    def test_inertia_that_holds_a_mass_is_a_misspelt_inertial(self, tmp_path: Path) -> None:
        text = '<robot name="r"><link name="a"><inertia><mass value="1"/></inertia></link></robot>'
        (finding,) = findings(tmp_path, text, "XML003")
        assert (finding.message_id, finding.data["near"]) == ("misspelt", "inertial")

    def test_one_mistake_in_many_places_is_one_finding(self, tmp_path: Path) -> None:
        links = "".join(f'<link name="l{i}"><colision/></link>' for i in range(3))
        (finding,) = findings(tmp_path, f'<robot name="r">{links}</robot>', "XML003")
        assert len(finding.subjects) == 3
        assert "(3 times)" in finding.message

    @pytest.mark.parametrize(
        ("inside", "repair"),
        [
            ("<visual>{}</visual><collision>{}</collision>{}", "delete it: <visual> and <collision> beside it have"),
            ("<collision>{}</collision>{}", "move it into <visual> or <collision>"),
            ("<visual/><collision>{}</collision>{}", "move it into <visual> or <collision>"),
            ("{}", "move it into <visual> or <collision>"),
            ("<gravity>0</gravity>", 'write `<gazebo reference="a"><turnGravityOff>true</turnGravityOff></gazebo>` at'),
            ("<kinematic>1</kinematic>", 'move it into `<gazebo reference="a">…</gazebo>` at the end of the robot'),
            (
                '<collision name="skin"><surface><mu>1</mu></surface></collision>',
                'move <mu> as <mu1> directly into `<gazebo reference="a">…</gazebo>` at the end of the robot, and delete the ',
            ),
        ],
    )
    def test_where_an_element_belongs(self, tmp_path: Path, inside: str, repair: str) -> None:
        text = inside.replace("{}", "<geometry><sphere radius='1'/></geometry>")
        (finding,) = findings(tmp_path, f'<robot name="r"><link name="a">{text}</link></robot>', "XML003")
        assert finding.fix is not None
        assert finding.fix.title.startswith(repair)

    @pytest.mark.parametrize("name", ["", ' name="a_skin"'])
    def test_a_name_that_begins_with_the_links_stays(self, tmp_path: Path, name: str) -> None:
        inside = f"<collision{name}><surface><mu>1</mu></surface></collision>"
        (finding,) = findings(tmp_path, f'<robot name="r"><link name="a">{inside}</link></robot>', "XML003")
        assert finding.fix is not None
        assert "delete the name" not in finding.fix.title

    @pytest.mark.parametrize(("torque", "repaired"), [("0.1", False), ("5", True)])
    def test_is_not_renamed_where_the_drive_then_turns_no_wheel(
        self, tmp_path: Path, torque: str, repaired: bool
    ) -> None:
        joint = '<joint name="j" type="continuous"><parent link="a"/><child link="b"/><joint_properties damping="1"/></joint>'
        plugin = (
            f'<plugin filename="libgazebo_ros_diff_drive.so"><leftJoint>j</leftJoint><torque>{torque}</torque></plugin>'
        )
        text = f'<robot name="r"><link name="a"/><link name="b"/>{joint}<gazebo>{plugin}</gazebo></robot>'
        (finding,) = findings(tmp_path, text, "XML003")
        assert finding.fix is not None
        assert bool(finding.fix.edits) == repaired
        assert ("less damping than the 0.1 N·m with which the drive" in finding.fix.title) != repaired

    def test_does_not_look_into_extensions(self, tmp_path: Path) -> None:
        text = '<robot name="r"><link name="a"/><gazebo><visul/></gazebo><transmission><jont/></transmission></robot>'
        assert not findings(tmp_path, text, "XML003")


def declare(encoding: str, name: str = "a") -> str:
    robot = f'<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><link name="{name}"/></robot>'
    return f'<?xml version="1.0" encoding="{encoding}"?>{robot}'


class TestEncodings:
    """What is read is what urdfdom and xacro read; both are asked."""

    @pytest.mark.parametrize("encoding", ["utf-16", "utf-16-le", "utf-16-be"])
    def test_urdfdom_reads_no_utf_16(self, tmp_path: Path, encoding: str) -> None:
        pinocchio = pytest.importorskip("pinocchio")
        path = tmp_path / "robot.urdf"
        path.write_bytes('<robot name="r"><link name="a"/></robot>'.encode(encoding))
        with capture_stderr(), pytest.raises(ValueError, match="valid URDF"):
            pinocchio.buildModelFromUrdf(str(path))
        (finding,) = check(path, codes={"XML001"}).findings
        assert (finding.message_id, finding.severity) == ("utf-16", Severity.ERROR)

    @pytest.mark.parametrize(
        ("data", "message"),
        [
            (declare("utf-8", "ä").encode(), None),
            (declare("utf-8", "ä").encode("utf-8-sig"), None),
            (declare("ISO-8859-1", "ä").encode(), None),
            (declare("gb2312").encode(), None),
            ('<robot name="r"><link name="a"/></robot>'.encode("utf-16-le"), None),
            (declare("utf-16").encode("utf-16"), "xacro-encoding"),
            ('<robot name="r"><link name="中"/></robot>'.encode("utf-16-le"), None),
            (declare("ISO-8859-1", "ä").encode("latin-1"), "xacro-encoding"),
            (declare("utf-8", "ä").encode("latin-1"), "encoding"),
        ],
    )
    @pytest.mark.parametrize("place", ["robot.urdf.xacro", "part.xacro", "values.yaml"])
    def test_xacro_reads_utf_8_alone(
        self, tmp_path: Path, data: bytes, message: str | None, place: str, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        import xacro

        monkeypatch.setattr(
            xacro, "open", partial(open, encoding="utf-8"), raising=False
        )  # as in every locale of today
        start = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><link name="l"/>'
        uses = '<xacro:include filename="part.xacro"/></robot>'
        if place == "values.yaml":
            data = data.replace(declare("utf-8")[:10].encode(), b"")
            uses = (
                "<xacro:property name='v' value=\"${xacro.load_yaml('values.yaml')}\"/><link name='${len(v)}'/></robot>"
            )
        (tmp_path / "robot.urdf.xacro").write_text(start + uses)
        (tmp_path / place).write_bytes(data)
        refused = False
        try:
            xacro.process_file(str(tmp_path / "robot.urdf.xacro"))
        except UnicodeDecodeError:
            refused = True
        except Exception:
            assert place == "values.yaml"  # which is no yaml at all
            return
        found = check(tmp_path / "robot.urdf.xacro", codes={"XML001", "XAC001"}).findings
        assert refused == (message is not None)
        if place == "values.yaml":
            assert [f.message_id for f in found] == ["yaml"] * refused
        else:
            assert [f.message_id for f in found] == [message] * refused

    @pytest.mark.parametrize("encoding", ["utf-16-le", "utf-16-be"])
    @pytest.mark.parametrize(
        ("name", "read"),
        [
            ("名", "吊"),
            ("a\r\nb", "a  b"),
            ("a\rb", None),
            ("a\nb", None),
            ("a\n\rb", None),
            ("a'='\r\n'", "a'='  '"),
            ("\U00013480\x80", "\U00012880\x80"),
        ],
    )
    def test_line_breaks_that_only_xacro_sees_in_utf_16(
        self, tmp_path: Path, encoding: str, name: str, read: str | None, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        import xacro

        monkeypatch.setattr(xacro, "open", partial(open, encoding="utf-8"), raising=False)
        path = tmp_path / "robot.urdf.xacro"
        path.write_bytes(f'<robot name="r">\r\n<link name="{name}"/></robot>'.encode(encoding))
        (finding, *_) = check(path, codes={"XML001"}).findings or [None]
        try:
            found = xacro.process_file(str(path)).getElementsByTagName("link")[0].getAttribute("name")
        except UnicodeDecodeError:
            assert finding is not None
            assert finding.message_id == "xacro-encoding"
            return
        plain = re.sub("\r\n|[\r\n]", " ", name)
        assert found in {read, plain}
        assert (finding is not None) == (found != plain)
        if finding is not None:
            assert (finding.message_id, finding.severity) == ("xacro-line-break", Severity.ERROR)

    @pytest.mark.parametrize(
        ("encoding", "hidden"),
        [("utf-7", "+ADwAIQAtAC0-{}+AC0ALQA+-"), ("hz", "<!--~\n{}-->"), ("iso2022_jp", "\x1b$B!!\x1b(B{}")],
    )
    @pytest.mark.parametrize("name", ["robot.urdf", "robot.urdf.xacro"])
    def test_a_declaration_hides_nothing(self, tmp_path: Path, encoding: str, hidden: str, name: str) -> None:
        evil = '<link name="evil"/><joint name="j" type="fixed"><parent link="a"/><child link="evil"/></joint>'
        text = declare(encoding).replace("</robot>", hidden.format(evil) + "</robot>")
        (finding,) = findings(tmp_path, text, "XML001", name)
        assert (finding.message_id, finding.severity) == ("declared-encoding", Severity.ERROR)
        assert finding.location.span is not None
        assert (finding.location.span.line, finding.location.span.col) == (1, 31)

    @pytest.mark.parametrize("name", ["start.launch", "package.xml", "config/r.srdf"])
    def test_it_hides_nothing_in_companions_either(self, tmp_path: Path, name: str) -> None:
        (tmp_path / "config").mkdir()
        (tmp_path / "package.xml").write_text("<package><name>p</name></package>")
        (tmp_path / "r.urdf").write_text('<robot name="r"><link name="a"/></robot>')
        root = {"start.launch": "launch", "package.xml": "package"}.get(name, "robot")
        (tmp_path / name).write_text(f'<?xml version="1.0" encoding="utf-7"?><{root} name="r">+ADw-</{root}>')
        (finding,) = check(tmp_path, codes={"XML001"}).findings
        assert "utf-7" in finding.message
        assert finding.severity == Severity.ERROR

    @pytest.mark.parametrize(
        ("data", "message", "other"),
        [
            (declare("ISO-8859-1", "ä").encode("latin-1"), "undecoded", "\\xe4"),
            (declare("ISO-8859-1", "ä").encode(), "misdeclared", "Ã¤"),
        ],
    )
    def test_a_name_that_is_another_for_the_reference_parser_is_named(
        self, tmp_path: Path, data: bytes, message: str, other: str
    ) -> None:
        (tmp_path / "robot.urdf").write_bytes(data)
        (finding,) = check(tmp_path / "robot.urdf", codes={"XML001"}).findings
        assert (finding.message_id, finding.severity) == (message, Severity.WARNING)
        assert other in finding.message
        assert "ä" in finding.message

    @pytest.mark.parametrize("encoding", ["ISO-8859-1", "utf-8"])
    def test_letters_in_comments_matter_to_nobody(self, tmp_path: Path, encoding: str) -> None:
        text = declare(encoding).replace("</robot>", "<!-- ä --></robot>")
        (tmp_path / "robot.urdf").write_bytes(text.encode(encoding))
        assert not check(tmp_path / "robot.urdf", codes={"XML001"}).findings


class TestXML005:
    @pytest.mark.parametrize(
        ("shapes", "severity"),
        [
            ("{box}<collision>{origin}</collision>", Severity.WARNING),
            ("<visual>{origin}</visual>{wall}", Severity.ERROR),
            ("<collision>{origin}</collision>{wall}", Severity.ERROR),
            ("{box}<collision><box size='1 1 1'/></collision>", Severity.ERROR),
        ],
    )
    def test_a_part_without_a_shape_is_a_warning_where_no_shape_is_lost(
        self, tmp_path: Path, shapes: str, severity: Severity
    ) -> None:
        geometry = '<geometry><box size="1 1 1"/></geometry>'
        box, wall = f"<visual>{geometry}</visual>", f"<collision>{geometry}</collision>"
        inside = shapes.format(box=box, wall=wall, origin='<origin xyz="0 0 1"/>')
        (finding,) = findings(tmp_path, f'<robot name="r"><link name="a">{inside}</link></robot>', "XML005")
        assert finding.severity == severity

    def test_missing_products_are_zero_about_principal_axes(self, tmp_path: Path) -> None:
        inertial = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1"/></inertial>'
        (finding,) = findings(tmp_path, f'<robot name="r"><link name="a">{inertial}</link></robot>', "XML005")
        assert finding.fix is not None
        assert finding.fix.title.startswith('write ixy="0" ixz="0" iyz="0" if')
        assert "delete" not in finding.fix.title  # an inertial needs its inertia

    @pytest.mark.parametrize(
        ("shape", "wanted"),
        [
            ("<box><size>1 2  3</size></box>", '`size="1 2 3"`: the number is typed in child elements, as in SDF'),
            (
                "<cylinder><radius>1</radius><length>2</length></cylinder>",
                '`radius="1" length="2"`: the numbers are typed in child elements, as in SDF',
            ),
            ("<cylinder><radius>1</radius></cylinder>", "the attributes radius, length"),
            ("<box><size>1 2</size></box>", "the attribute size"),
        ],
    )
    def test_numbers_of_child_elements_are_those_of_the_attributes(
        self, tmp_path: Path, shape: str, wanted: str
    ) -> None:
        visual = f"<visual><geometry>{shape}</geometry></visual>"
        (finding,) = findings(tmp_path, f'<robot name="r"><link name="a">{visual}</link></robot>', "XML005")
        assert finding.fix is not None
        assert finding.fix.title == f"write {wanted}"

    @pytest.mark.parametrize(
        ("mass", "repair"),
        [
            ("<mass> 7.0 </mass>", 'write `value="7.0"`: the number is typed between the tags'),
            ("<mass/>", "write the attribute value"),
            (
                "<mass><value>7.0</value></mass>",
                'write `value="7.0"`: the number is typed in child elements, as in SDF',
            ),
        ],
    )
    def test_a_number_between_the_tags_is_the_missing_one(self, tmp_path: Path, mass: str, repair: str) -> None:
        inertial = f'<inertial>{mass}<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
        (finding,) = findings(tmp_path, f'<robot name="r"><link name="a">{inertial}</link></robot>', "XML005")
        assert finding.fix is not None
        assert finding.fix.title == repair

    @pytest.mark.parametrize(("axis", "repair"), [('xzy="0 0 1"', "`xyz` for `xzy`"), ("", "its xyz")])
    def test_an_idle_axis_may_be_misspelt(self, tmp_path: Path, axis: str, repair: str) -> None:
        joint = f'<joint name="j" type="fixed"><parent link="a"/><child link="b"/><axis {axis}/></joint>'
        (finding,) = findings(tmp_path, ROBOT.format(link="", joint=joint), "XML005")
        assert finding.fix is not None
        assert finding.fix.title == f"delete the <axis>, or write {repair}"

    @pytest.mark.parametrize(
        ("link", "loss"),
        [
            ("<inertial/>", "drops the inertial, and with it every visual and collision of the link"),
            ("<visual/>", "drops every visual and collision of the link"),
            ("<collision/>", "drops every collision of the link"),
        ],
    )
    def test_says_what_urdfdom_gives_up(self, tmp_path: Path, link: str, loss: str) -> None:
        text = ROBOT.format(link=link, joint=JOINT.format(effort="1", more=""))
        (finding,) = findings(tmp_path, text, "XML005")
        assert finding.consequences["urdfdom"] == loss

    def test_missing_parent_is_not_told_again_as_unknown_link_or_root(self, tmp_path: Path) -> None:
        text = '<robot name="r"><link name="a"/><link name="b"/><joint name="j" type="fixed"><child link="b"/></joint></robot>'
        run = check_text(tmp_path, text, codes={"XML005", "KIN002", "KIN005"})
        assert [f.code for f in run.findings] == ["XML005"]

    def test_mesh_without_a_file_name(self, tmp_path: Path) -> None:
        shape = '<visual><geometry><mesh filename=" "/></geometry></visual>'
        (finding,) = findings(tmp_path, f'<robot name="r"><link name="a">{shape}</link></robot>', "XML005")
        assert (finding.message_id, finding.consequences["urdfdom"]) == ("file", "loads it")

    def test_an_axis_without_xyz_is_zero_to_the_reference_parser(self, tmp_path: Path) -> None:
        pinocchio = pytest.importorskip("pinocchio")
        inertial = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
        text = ROBOT.format(link=inertial, joint=JOINT.format(effort="1", more="<axis/>"))
        model = pinocchio.buildModelFromXML(text)
        assert not pinocchio.crba(model, model.createData(), pinocchio.neutral(model)).any()
        run = check_text(tmp_path, text)
        assert not run.failures
        assert [f.message_id for f in run.findings if f.severity is Severity.ERROR] == ["axis"]
        (idle,) = findings(tmp_path, text.replace("revolute", "fixed"), "XML005")
        assert (idle.message_id, idle.severity) == ("idle-axis", Severity.INFO)


class TestXML007:
    @pytest.mark.parametrize("good", ["1", "+1", "-1.5", ".5", "1.", "1e-3", "1E+2", " 1", "-0"])
    def test_numbers(self, tmp_path: Path, good: str) -> None:
        assert not findings(tmp_path, with_effort(good), "XML007")

    @pytest.mark.parametrize(
        ("bad", "kind", "repair"),
        [
            ("nan", "nan", None),
            ("-INF", "infinite", None),
            ("", "empty", None),
            ("0,5", "comma", "0.5"),
            ("1,000", "comma", None),
            ("10kg", "unit", "10"),
            ("10 mm", "unit", None),
            ("90°", "unit", None),
            ("1_000", "underscore", "1000"),
            ("0x10", "hexadecimal", None),
            ("\u22121", "character", "-1"),
            ("\u0661", "character", None),
            ("1e400", "overflow", None),
            ("-.1e400", "overflow", None),
            ("9" * 400, "overflow", None),
            ("pi/2", "expression", None),
            ("1d3", "other", None),
            ("1 ", "blank", "1"),
        ],
    )
    def test_kinds(self, tmp_path: Path, bad: str, kind: str, repair: str | None) -> None:
        (finding,) = findings(tmp_path, with_effort(bad), "XML007")
        assert finding.message_id == kind
        assert finding.fix is not None
        assert [e.replacement for e in finding.fix.edits] == ([] if repair is None else [repair])

    @pytest.mark.parametrize(
        ("typed", "message", "repair"),
        [
            ("0 pi/2 0", "expression", "write `${pi/2}`: xacro computes only what is inside"),
            ("0 {pi/2} 0", "expression", "write `${pi/2}`: xacro computes only what is inside"),
            ("0 pi / 2 0", "expression", "write `${…}`: xacro computes only what is inside"),
            ("${quarter} 0 0", "expression", "write `${pi/2}`: xacro computes only what is inside"),
            ("0 ${two}/2 0", "outside", "put the whole expression into one pair of braces: `0 ${two/2} 0`"),
            ("0 ${two} * 2 0", "outside", "put the whole expression into one pair of braces"),
        ],
    )
    def test_xacro_lacks_only_the_braces(self, tmp_path: Path, typed: str, message: str, repair: str) -> None:
        text = (
            '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:property name="quarter" value="pi/2"/>'
            f'<xacro:property name="two" value="2"/><link name="a"><visual><origin rpy="{typed}"/>'
            '<geometry><sphere radius="1"/></geometry></visual></link></robot>'
        )
        (finding,) = check_text(tmp_path, text, codes={"XML007"}, name="r.urdf.xacro").findings
        assert finding.fix is not None
        assert (finding.message_id, finding.fix.title) == (message, repair)

    def test_an_operator_outside_the_braces(self, tmp_path: Path) -> None:
        xacro = with_effort("${r + 1} * (${r}*2)").replace(
            "<robot ", '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" ', 1
        )
        text = xacro.replace("<link", '<xacro:property name="r" value="2"/><link', 1)
        (finding,) = [f for f in check_text(tmp_path, text, "robot.urdf.xacro").findings if f.code == "XML007"]
        assert finding.fix is not None
        assert (finding.message_id, finding.data["value"]) == ("outside", "3 * (2*2)")
        assert "`${(r + 1) * (r*2)}`" in finding.fix.title

    def test_number_that_only_a_limit_may_have(self, tmp_path: Path) -> None:
        assert not findings(tmp_path, with_effort("1e308"), "XML007")
        small = ROBOT.format(link="", joint=JOINT.format(effort="1", more='<origin xyz="0 1e-308 0"/>'))
        assert not findings(tmp_path, small, "XML007")
        text = ROBOT.format(link="", joint=JOINT.format(effort="1", more='<origin xyz="0 1e308 0"/>'))
        (finding,) = findings(tmp_path, text, "XML007")
        assert (finding.message_id, finding.severity, finding.data["word"]) == ("extreme", Severity.WARNING, "1e308")

    def test_only_white_space_is_repaired_without_asking(self, tmp_path: Path) -> None:
        (blank,) = findings(tmp_path, with_effort("1 "), "XML007")
        (comma,) = findings(tmp_path, with_effort("0,5"), "XML007")
        assert blank.fix is not None
        assert comma.fix is not None
        assert (blank.fix.applicability, comma.fix.applicability) == (Applicability.SAFE, Applicability.UNSAFE)

    @pytest.mark.parametrize("xyz", ["0 0 0 ", "0  0 0", "0 0 \n0", " 0 0 0"])
    def test_white_space_that_urdfdom_skips(self, tmp_path: Path, xyz: str) -> None:
        text = ROBOT.format(link="", joint=JOINT.format(effort="1", more=f'<origin xyz="{xyz}"/>'))
        assert not findings(tmp_path, text, "XML007")

    @pytest.mark.parametrize("xyz", ["0\t0 0", "0 0\n0", "0 0 0\n"])
    def test_white_space_that_it_does_not_skip(self, tmp_path: Path, xyz: str) -> None:
        text = ROBOT.format(link="", joint=JOINT.format(effort="1", more=f'<origin xyz="{xyz}"/>'))
        assert [f.message_id for f in findings(tmp_path, text, "XML007")] == ["blank"]
        # xacro writes every tab and line break as a space.
        assert not findings(tmp_path, text, "XML007", "robot.urdf.xacro")

    @pytest.mark.parametrize("xyz", ["0,0,1", "0, 0, 1", "0;0;1", "(0 0 1)"])
    def test_separators(self, tmp_path: Path, xyz: str) -> None:
        text = ROBOT.format(link="", joint=JOINT.format(effort="1", more=f'<axis xyz="{xyz}"/>'))
        (finding,) = findings(tmp_path, text, "XML007")
        assert finding.fix is not None
        repaired = [e.replacement for e in finding.fix.edits]
        assert repaired == (["0 0 1"] if finding.message_id == "separator" else [])

    def test_names_the_property_that_a_value_came_from(self, tmp_path: Path) -> None:
        text = (
            '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">\n'
            '<xacro:property name="force" value="1,5"/>\n' + with_effort("${force}").removeprefix('<robot name="r">')
        )
        (finding,) = findings(tmp_path, text, "XML007", "robot.urdf.xacro")
        assert [r.subject for r in finding.related] == ["property[force]"]
        assert finding.fix is not None
        assert not finding.fix.edits

    def test_numbers_of_extensions_are_their_own(self, tmp_path: Path) -> None:
        text = '<robot name="r"><link name="a"/><gazebo><origin xyz="x"/></gazebo></robot>'
        assert not findings(tmp_path, text, "XML007")


class TestXML008:
    def test_no_number_at_all_is_xml007(self, tmp_path: Path) -> None:
        text = ROBOT.format(link="", joint=JOINT.format(effort="1", more='<axis xyz=""/>'))
        assert not findings(tmp_path, text, "XML008")
        assert findings(tmp_path, text, "XML007")

    def test_single_number_given_twice(self, tmp_path: Path) -> None:
        (finding,) = findings(tmp_path, with_effort("1 2"), "XML008")
        assert (finding.data["found"], finding.data["expected"]) == (2, 1)


class TestXML012:
    def test_difference_that_no_screen_shows(self, tmp_path: Path) -> None:
        text = (
            '<robot name="r"><material name="m"><color rgba="0.5 0.5 0.5 1"/></material><link name="a"><visual>'
            '<geometry><sphere radius="1"/></geometry><material name="m"><color rgba="{} 0.5 0.5 1"/></material>'
            "</visual></link></robot>"
        )
        assert not findings(tmp_path, text.format("0.5019"), "XML012")
        assert findings(tmp_path, text.format("0.5021"), "XML012")

    def test_empty_names_are_one_finding(self, tmp_path: Path) -> None:
        visual = '<visual><geometry><sphere radius="1"/></geometry><material name=""/></visual>'
        (finding,) = findings(tmp_path, f'<robot name="r"><link name="a">{visual}{visual}</link></robot>', "XML012")
        assert len(finding.subjects) == 2


class TestXML014:
    @pytest.fixture(autouse=True)
    def _pinocchio(self) -> None:
        pytest.importorskip("pinocchio")

    def robot(self, joint: str, kind: str = "revolute", name: str = ' name="r"') -> str:
        ends = '<parent link="a"/><child link="b"/><axis xyz="0 0 1"/>'
        return (
            f'<robot{name}><link name="a"/><link name="b"/><joint name="j" type="{kind}">{ends}{joint}</joint></robot>'
        )

    def test_refusal_of_urdfdom_is_told_apart_from_pinocchios(self, tmp_path: Path) -> None:
        limit = '<limit lower="0" upper="1" effort="1" velocity="1"/>'
        newer = self.robot(limit.replace("/>", ' jerk="-1"/>'), name=' name="r" version="1.2"')
        (urdfdom,) = findings(tmp_path, newer, "XML014")
        assert (urdfdom.message_id, urdfdom.severity) == ("refused", Severity.ERROR)
        assert urdfdom.location.subject == "joint[j]"
        assert "joint [j]: jerk value" in urdfdom.headline
        assert "valid URDF model" not in urdfdom.message
        follower = limit.replace('effort="1"', 'effort="-1"') + '<mimic joint="j"/>'
        (pinocchio,) = findings(tmp_path, self.robot(follower), "XML014")
        assert (pinocchio.message_id, pinocchio.severity) == ("pinocchio", Severity.WARNING)
        assert pinocchio.consequences.keys() == {"pinocchio"}

    @pytest.mark.parametrize(
        ("joint", "kind", "name", "code"),
        [
            ("", "fixed", "", "XML002"),
            ("", "prismatic", ' name="r"', "JNT004"),
            ('<limit lower="0" upper="1" velocity="1"/>', "revolute", ' name="r"', "JNT007"),
            ('<limit lower="0" upper="1" effort="-1" velocity="1"/>', "revolute", ' name="r"', "JNT007"),
            ('<limit lower="0" upper="1" effort="1" velocity="-1"/>', "revolute", ' name="r"', "JNT007"),
            ('<limit effort="1" velocity="1 "/>', "continuous", ' name="r"', "XML007"),
            ('<origin xyz="0 0"/>', "fixed", ' name="r"', "XML008"),
            ('<origin xyz="0 \n 0 0"/>', "fixed", ' name="r"', "XML007"),
            ('<origin xyz="0 0\t0"/>', "fixed", ' name="r"', "XML007"),
            ('<calibration rising="a"/>', "fixed", ' name="r"', "XML007"),
            ("<dynamics/>", "continuous", ' name="r"', "XML005"),
            ("<mimic/>", "continuous", ' name="r"', "XML005"),
            ("<safety_controller/>", "continuous", ' name="r"', "JNT010"),
            ('<dynamics friction="-1"/>', "continuous", ' name="r"', "JNT011"),
            ("", "hinge", ' name="r"', "KIN009"),
            ("", "continuous", ' name="r" version="2.0"', "XML010"),
            ('<origin rpy="0 0 0" quat_xyzw="0 0 0 1"/>', "continuous", ' name="r" version="1.1"', "XML010"),
        ],
    )
    def test_what_another_rule_explains_is_not_told_again(
        self, tmp_path: Path, joint: str, kind: str, name: str, code: str
    ) -> None:
        run = check_text(tmp_path, self.robot(joint, kind, name), codes={code, "XML014"})
        assert {f.code for f in run.findings} == {code}
        (skip,) = run.skipped
        assert code in skip.reason


LINK = '<robot name="r">{robot}<link name="a">{link}</link></robot>'
SHAPE = '<visual><geometry><sphere radius="1"/></geometry>{}</visual>'


class TestXML004:
    @pytest.mark.parametrize(
        ("element", "message", "near"),
        [
            ('<origin xzy="0 0 1"/>', "misspelt", "xyz"),
            ('<origin XYZ="0 0 1"/>', "misspelt", "xyz"),
            ('<origin rotation="0 0 1"/>', "ignored", None),
            ('<limit lowr="-1" upper="1" effort="1" velocity="1"/>', "misspelt", "lower"),
            ('<limit min="-1" max="1" effort="1" velocity="1"/>', "misspelt", "lower and upper"),
            ('<limit upper="1" Upper="2" effort="1" velocity="1"/>', "ignored", None),
            ('<limit upper="1" efort="1" velocity="1"/>', "required", "effort"),
            ('<dynamics damping="1" radius="2"/>', "misplaced", None),
            ('<safety_controller k_velocty="1"/>', "required", "k_velocity"),
        ],
    )
    def test_tells_what_was_meant(self, tmp_path: Path, element: str, message: str, near: str | None) -> None:
        found = findings(tmp_path, ROBOT.format(link="", joint=JOINT.format(effort="1", more=element)), "XML004")
        assert found[0].message_id == message
        assert found[0].data.get("near") == near

    @pytest.mark.parametrize(
        "element",
        [
            '<origin xyz="0 0 1" name="up" id="3"/>',
            '<axis xyz="0 0 1" rpy="0 0 0"/>',
            '<axis xyz="0 0 1" scale="1 1 1"/>',
            '<dynamics damping="1" drake:acceleration="3"/>',
            '<gazebo mu="3"/>',
        ],
    )
    def test_leaves_labels_extensions_and_zeros_alone(self, tmp_path: Path, element: str) -> None:
        text = ROBOT.format(link="", joint=JOINT.format(effort="1", more=element))
        assert not findings(tmp_path, text.replace("<robot", '<robot xmlns:drake="d"'), "XML004")

    def test_what_a_misspelt_element_holds_is_looked_at(self, tmp_path: Path) -> None:
        inner = '<mass values="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>'
        (slip,) = findings(tmp_path, ROBOT.format(link=f"<intertial>{inner}</intertial>", joint=""), "XML004")
        assert (slip.message_id, slip.data["near"], slip.data["around"]) == ("inside", "value", "intertial")
        assert not findings(tmp_path, ROBOT.format(link=f"<mine>{inner}</mine>", joint=""), "XML004")

    def test_the_axis_of_a_fixed_joint_is_read_by_nobody(self, tmp_path: Path) -> None:
        text = ROBOT.format(link="", joint=JOINT.format(effort="1", more='<axis xzy="1 0 0"/>'))
        assert findings(tmp_path, text, "XML004")
        assert not findings(tmp_path, text.replace("revolute", "fixed"), "XML004")

    def test_a_misspelt_attribute_is_not_told_again_as_a_missing_one(self, tmp_path: Path) -> None:
        inertial = '<inertial><mass values="1"/><inertia Ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
        joint = JOINT.format(effort="1", more='<axis xzy="0 0 1"/>').replace("link=", "lnk=", 1)
        run = check_text(tmp_path, ROBOT.format(link=inertial, joint=joint), codes={"XML004", "XML005"})
        assert [(f.code, f.severity) for f in run.findings] == [("XML004", Severity.ERROR)] * 4
        assert run.findings[0].consequences["urdfdom"].startswith("drops the inertial")

    def test_renames_the_attribute_where_it_is_typed(self, tmp_path: Path) -> None:
        (finding,) = findings(
            tmp_path, LINK.format(robot="", link='<inertial>\n<mass\n values = "2"/></inertial>'), "XML004"
        )
        assert finding.location.span is not None
        assert (finding.location.span.line, finding.location.span.col) == (3, 2)
        assert finding.fix is not None
        assert [(e.expected, e.replacement) for e in finding.fix.edits] == [("values", "value")]

    def test_one_slip_in_many_places_is_one_finding(self, tmp_path: Path) -> None:
        links = "".join(f'<link name="l{i}" colour="red" weight="{i}"/>' for i in range(3))
        (finding,) = findings(tmp_path, f'<robot name="r">{links}</robot>', "XML004")
        assert "(3 times)" in finding.message
        assert "`colour`, `weight`" in finding.message


@pytest.mark.parametrize(("typed", "severity"), [("<density value='567'/>", Severity.INFO), ("", Severity.ERROR)])
def test_an_inertial_for_isaac_gym_is_not_to_be_deleted(tmp_path: Path, typed: str, severity: Severity) -> None:
    shape = '<collision><geometry><box size="1 1 1"/></geometry></collision>'
    text = f'<robot name="r"><link name="a">{shape}<inertial>{typed}</inertial></link></robot>'
    (finding,) = findings(tmp_path, text, "XML005")
    assert finding.severity is severity
    assert finding.fix is not None
    assert ("delete" in finding.fix.title) == (not typed)


def test_the_block_that_a_call_must_hand_over_is_not_to_be_deleted(tmp_path: Path) -> None:
    shape = '<collision><geometry><box size="1 1 1"/></geometry></collision>'
    macro = (
        f'<xacro:macro name="m" params="*v"><link name="a"><xacro:insert_block name="v"/>{shape}</link></xacro:macro>'
    )
    ns = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
    text = f'<robot name="r" {ns}>{macro}<xacro:m><visual/></xacro:m></robot>'
    (finding,) = findings(tmp_path, text, "XML005", "r.xacro")
    assert finding.fix is not None
    assert finding.fix.title == "add <geometry> to the block that the call hands over"


@pytest.mark.parametrize(
    ("first", "second", "is_equal"),
    [("${s == 1}", "${s == 1}", True), ("${s == 1}", "${s != 2}", False)],
)
def test_of_two_shapes_under_equal_conditions_none_is_left_over(
    tmp_path: Path, first: str, second: str, is_equal: bool
) -> None:
    shapes = f'<xacro:if value="{first}"><box size="1 1 1"/></xacro:if><xacro:if value="{second}"><sphere radius="1"/></xacro:if>'
    ns = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
    visual = f'<xacro:property name="s" value="1"/><link name="a"><visual><geometry>{shapes}</geometry></visual></link>'
    (finding,) = findings(tmp_path, f'<robot name="r" {ns}>{visual}</robot>', "XML006", "r.xacro")
    assert finding.fix is not None
    assert ("correct the conditions" in finding.fix.title) == is_equal
    assert ("delete" in finding.fix.title) != is_equal


class TestXML006:
    @pytest.mark.parametrize(("tag", "severity"), [("visual", Severity.WARNING), ("collision", Severity.ERROR)])
    def test_what_is_only_drawn_is_a_warning(self, tmp_path: Path, tag: str, severity: Severity) -> None:
        inside = '<origin xyz="0 0 0"/><geometry><sphere radius="1"/></geometry><origin xyz="0 0 1"/>'
        (finding,) = findings(
            tmp_path, f'<robot name="r"><link name="a"><{tag}>{inside}</{tag}></link></robot>', "XML006"
        )
        assert finding.severity == severity

    def test_elements_of_a_macro_that_differ_in_one_call_are_one_finding(self, tmp_path: Path) -> None:
        text = (
            '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:macro name="m" params="n ixy"><link name="${n}">'
            '<inertial><mass value="1"/><inertia ixx="1" ixy="0.1" ixz="0" iyy="1" iyz="0" izz="1"/>'
            '<inertia ixx="1" ixy="${ixy}" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link></xacro:macro>'
            '<xacro:m n="a" ixy="0.1"/><xacro:m n="b" ixy="-0.1"/>'
            '<joint name="j" type="fixed"><parent link="a"/><child link="b"/></joint></robot>'
        )
        (finding,) = findings(tmp_path, text, "XML006", "r.xacro")
        assert finding.message_id == "repeated"
        assert not finding.fix or not finding.fix.edits
        (finding,) = findings(tmp_path, text.replace('"-0.1"', '"0.1"'), "XML006", "r.xacro")
        assert finding.message_id == "identical"

    @pytest.mark.parametrize(
        ("first", "second", "line"),
        [
            ("block", "own", 4),
            ("own", "block", 4),
            ("block", "call", 1),
            ("call", "block", 4),
            ("own", "call", 1),
            ("call", "own", 4),
            ("own", "if", 4),
            ("block", "if", 4),
        ],
    )
    def test_what_is_ignored_is_reported_where_it_comes_from(
        self, tmp_path: Path, first: str, second: str, line: int
    ) -> None:
        """Lines: 1 the origin of a macro, 3 and 4 what the joint has, 6 the block of the call."""
        kinds = {
            "block": '<xacro:insert_block name="block"/>',
            "own": '<origin xyz="0 0 1"/>',
            "call": "<xacro:place/>",
            "if": '<xacro:if value="1"><origin xyz="0 0 4"/></xacro:if>',
        }
        heights = {"block": 3, "own": 1, "call": 2, "if": 4}
        text = (
            '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><link name="a"/><link name="b"/>'
            '<xacro:macro name="place"><origin xyz="0 0 2"/></xacro:macro>'
            '\n<xacro:macro name="m" params="*block"><joint name="j" type="fixed"><parent link="a"/><child link="b"/>'
            f"\n{kinds[first]}\n{kinds[second]}\n</joint></xacro:macro>"
            '<xacro:m>\n<origin xyz="0 0 3"/></xacro:m></robot>'
        )
        (finding,) = findings(tmp_path, text, "XML006", name="r.urdf.xacro")
        assert finding.location.span is not None
        assert finding.location.span.line == line
        assert f'reads the first (xyz="0 0 {heights[first]}"' in finding.message
        assert ("a block that a call hands over" in finding.message) == (first == "block")
        where = {"block": 3, "own": 3, "call": 1, "if": 3}[first]
        assert finding.related[0].span.line == where

    @pytest.mark.parametrize("inside", ["{own}{block}", "{block}{own}", "{block}{block}", "{call}{call}"])
    def test_the_block_of_a_call_and_what_is_typed_once_are_not_deleted(self, tmp_path: Path, inside: str) -> None:
        mass = '<mass value="1"/>'
        block, call = '<xacro:insert_block name="block"/>', "<xacro:mass/>"
        inertia = '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>'
        text = (
            f'<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:macro name="mass">{mass}</xacro:macro>'
            f'<xacro:macro name="m" params="*block"><link name="a"><inertial>'
            f"{inside.format(own=mass, block=block, call=call)}{inertia}</inertial></link></xacro:macro>"
            f"<xacro:m>{mass}</xacro:m></robot>"
        )
        (finding,) = findings(tmp_path, text, "XML006", name="r.urdf.xacro")
        assert finding.message_id == "identical"
        assert finding.fix is not None
        assert finding.fix.edits == ()

    def test_of_two_equal_elements_the_macro_s_is_kept(self, tmp_path: Path) -> None:
        macro = '<xacro:macro name="i" params="m">\n<mass value="${m}"/></xacro:macro>'
        inside = (
            '<inertial>\n<mass value="1"/>\n<xacro:i m="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>'
        )
        link = f'<link name="a">{inside}</inertial></link>'
        text = f'<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">{macro}{link}</robot>'
        (finding,) = findings(tmp_path, text, "XML006", name="r.urdf.xacro")
        assert finding.fix is not None
        assert [(edit.span.line, edit.expected) for edit in finding.fix.edits] == [(3, '<mass value="1"/>\n')]

    @pytest.mark.parametrize(
        ("link", "messages"),
        [
            (SHAPE.format("") * 2, []),
            (SHAPE.format('<origin xyz="0 0 1"/><origin xyz="0 0 2"/>'), ["repeated"]),
            (SHAPE.format('<origin xyz="0 0 1"/><origin  xyz="0  0 1" />'), ["identical"]),
            ('<visual><geometry><sphere radius="1"/><box size="1 1 1"/></geometry></visual>', ["shapes"]),
            (SHAPE.format('<material name="x"/><material name="y"/>'), ["repeated"]),
            (SHAPE.format("<verbose/><verbose/>"), []),
            ("<inertial/>" * 3, ["identical"]),
            (SHAPE.format('<material name="x"/><material/><material></material>'), ["empty"]),
            (SHAPE.format('<material/><material name="x"/>'), ["repeated"]),
        ],
    )
    def test_what_there_may_be_one_of(self, tmp_path: Path, link: str, messages: list[str]) -> None:
        found = findings(tmp_path, LINK.format(robot="", link=link), "XML006")
        assert [f.message_id for f in found] == messages
        is_drawn = link.startswith("<visual>")
        mild = {"identical", "empty", *(["repeated"] if is_drawn else [])}
        assert all((f.severity == Severity.WARNING) == (f.message_id in mild) for f in found)

    def test_the_empty_one_is_deleted(self, tmp_path: Path) -> None:
        (found,) = findings(
            tmp_path, LINK.format(robot="", link=SHAPE.format('<material name="x"/><material/>')), "XML006"
        )
        assert found.fix is not None
        assert [(edit.expected, edit.replacement) for edit in found.fix.edits] == [("<material/>", "")]

    @pytest.mark.parametrize(
        ("shape", "codes"),
        [
            ('<material name="x"/><material/>', {"XML006"}),
            ('<material name="x"/><material name="y"><color/></material>', {"XML006"}),
            ('<material/><material name="x"/>', {"XML005", "XML006"}),
            ('<origin xyz="0 0 1"/><origin xyz="0 nan"/>', {"XML006"}),
            ('<origin xyz="0 nan"/><origin xyz="0 0 1"/>', {"XML006", "XML007"}),
        ],
    )
    def test_what_is_not_read_has_no_other_defect(self, tmp_path: Path, shape: str, codes: set[str]) -> None:
        text = LINK.format(robot="", link=SHAPE.format(shape))
        run = check_text(tmp_path, text, codes={"XML005", "XML006", "XML007", "XML008"})
        assert {f.code for f in run.findings} == codes

    def test_mujoco_looks_at_some_of_them_only(self, tmp_path: Path) -> None:
        twice = '<calibration rising="1"/><calibration rising="2"/><axis xyz="1 0 0"/><axis xyz="0 1 0"/>'
        found = findings(tmp_path, ROBOT.format(link="", joint=JOINT.format(effort="1", more=twice)), "XML006")
        assert {f.data["tag"]: f.consequences["mujoco"].split()[0] for f in found} == {
            "calibration": "ignores",
            "axis": "refuses",
        }

    def test_the_first_is_taken_as_everything_else_here_takes_it(self, tmp_path: Path) -> None:
        pinocchio = pytest.importorskip("pinocchio")
        inertial = '<inertial><mass value="{}"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
        text = ROBOT.format(link=inertial.format(2) + inertial.format(3), joint=JOINT.format(effort="1", more=""))
        assert pinocchio.buildModelFromXML(text).inertias[1].mass == 2
        assert check_text(tmp_path, text, codes={"XML006"}).models[0].mass == 2

    @pytest.mark.parametrize(
        ("second", "repair"),
        [
            ('friction="1"', "merge them, for each has what the others lack, or delete what is left over"),
            ('damping="2"', "delete the wrong <dynamics>"),
        ],
    )
    def test_two_that_complete_each_other_are_merged(self, tmp_path: Path, second: str, repair: str) -> None:
        more = f'<dynamics damping="1"/><dynamics {second}/>'
        (found,) = findings(tmp_path, ROBOT.format(link="", joint=JOINT.format(effort="1", more=more)), "XML006")
        assert found.fix is not None
        assert found.fix.title == repair


class TestXML010:
    CAPSULE = '<collision><geometry><capsule radius="0.1" length="1"/></geometry></collision>'

    @pytest.mark.parametrize(
        ("version", "messages"),
        [
            ("", ["capsule", "quaternion", "limit"]),
            ("1.0", ["capsule", "quaternion", "limit"]),
            ("1.1", ["limit", "newer"]),
            ("1.2", ["newer"]),
            ("1", ["version"]),
            ("1.3", ["version"]),
            ("one", ["version"]),
            ("01.00", ["capsule", "quaternion", "limit"]),
            ("1.0 ", ["version"]),
        ],
    )
    def test_features_by_version(self, tmp_path: Path, version: str, messages: list[str]) -> None:
        more = '<origin quat_xyzw="0 0 0 1"/>'
        text = ROBOT.format(link=self.CAPSULE, joint=JOINT.format(effort="1", more=more)).replace(
            'velocity="1"', 'velocity="1" jerk="1"'
        )
        text = text.replace('name="r"', f'name="r" version="{version}"' if version else 'name="r"')
        assert sorted(f.message_id for f in findings(tmp_path, text, "XML010")) == sorted(messages)

    @pytest.mark.parametrize(
        ("origin", "message"),
        [
            ('quat_xyzw="0 0 0 1" rpy="0 0 0"', "both"),
            ('quat_xyzw="0 0 0 0"', "zero"),
            ('quat_xyzw="0 0 1 1"', "length"),
            ('quat_xyzw="0 0 0.7071 0.7071"', None),
            ('quat_xyzw="0 0 1"', None),  # XML008
        ],
    )
    def test_orientations(self, tmp_path: Path, origin: str, message: str | None) -> None:
        text = LINK.format(robot="", link=SHAPE.format(f"<origin {origin}/>")).replace('"r"', '"r" version="1.1"')
        found = [f.message_id for f in findings(tmp_path, text, "XML010") if f.message_id != "newer"]
        assert found == ([message] if message else [])

    @pytest.mark.parametrize(("version", "counts"), [("1.0", False), ("1.1", True), ("1.2", True)])
    def test_urdfdom_reads_a_quaternion_from_1_1_on(self, version: str, counts: bool) -> None:
        pinocchio = pytest.importorskip("pinocchio")
        text = ROBOT.format(link="", joint=JOINT.format(effort="1", more='<origin quat_xyzw="0 0 1 0"/>'))
        model = pinocchio.buildModelFromXML(text.replace('name="r"', f'name="r" version="{version}"'))
        assert (model.jointPlacements[1].rotation[0, 0] < 0) == counts


class TestXML011:
    def test_a_definition_elsewhere_gives_the_colour(self, tmp_path: Path) -> None:
        other = '<material name="paint"><color rgba="0.1 0.2  0.3 1"/></material>'
        (tmp_path / "other.urdf").write_text(f'<robot name="o">{other}<link name="a"/></robot>')
        shape = '<visual><geometry><sphere radius="1"/></geometry><material name="paint"/></visual>'
        (finding,) = findings(tmp_path, f'<robot name="r"><link name="a">{shape}</link></robot>', "XML011")
        assert 'rgba="0.1 0.2 0.3 1"/></material>` (its colour in ' in finding.fix.title
        (tmp_path / "other.urdf").write_text(f'<robot name="o"><!-- {other} --><link name="a"/></robot>')
        (finding,) = findings(tmp_path, f'<robot name="r"><link name="a">{shape}</link></robot>', "XML011")
        assert 'rgba="…"' in finding.fix.title

    @pytest.mark.parametrize(
        ("settings", "launched", "severity"),
        [
            ("<mujoco><compiler/></mujoco>", "other", Severity.INFO),
            ("<mujoco><compiler/></mujoco>", "arm", Severity.WARNING),
            ("", "other", Severity.WARNING),
        ],
    )
    def test_a_file_for_mujoco_needs_no_material(
        self, tmp_path: Path, settings: str, launched: str, severity: Severity
    ) -> None:
        (tmp_path / "package.xml").write_text("<package><name>p</name></package>")
        text = f'<launch><param name="robot_description" textfile="$(find p)/{launched}.urdf"/></launch>'
        (tmp_path / "start.launch").write_text(text)
        shape = SHAPE.format('<material name="paint"/>')
        (tmp_path / "arm.urdf").write_text(f'<robot name="r">{settings}<link name="a">{shape}</link></robot>')
        (finding,) = check(tmp_path / "arm.urdf", codes={"XML011"}).findings
        assert finding.severity is severity

    GREY = '<material name="grey"><color rgba="0.5 0.5 0.5 1"/></material>'
    REFERENCE = SHAPE.format('<material name="grey"/>')

    @pytest.mark.parametrize(
        ("robot", "link", "message"),
        [
            (GREY, REFERENCE, None),
            ("", SHAPE.format(GREY) + REFERENCE, None),
            ("", REFERENCE + SHAPE.format(GREY), "later"),
            ("", REFERENCE, "undefined"),
            ('<material name="grey"/>', REFERENCE, "undefined"),
            (GREY.replace("grey", "gray"), REFERENCE, "undefined"),
            ("", SHAPE.format('<material name=""/>'), None),
        ],
    )
    def test_order_counts_inside_of_links_only(
        self, tmp_path: Path, robot: str, link: str, message: str | None
    ) -> None:
        found = findings(tmp_path, LINK.format(robot=robot, link=link), "XML011")
        assert [f.message_id for f in found] == ([message] if message else [])

    def test_all_shapes_of_one_name_are_one_finding_with_the_nearest(self, tmp_path: Path) -> None:
        text = LINK.format(
            robot=self.GREY.replace("grey", "light_grey"), link=self.REFERENCE.replace("grey", "lite_grey") * 2
        )
        (finding,) = findings(tmp_path, text, "XML011")
        assert len(finding.subjects) == 2
        assert "did you mean 'light_grey'?" in finding.message
        assert finding.fix is not None
        assert finding.fix.title.startswith(
            "write `light_grey` if that is meant; else define it as a child of <robot>: "
        )

    @pytest.mark.parametrize(
        ("geometry", "drake", "severity"),
        [
            ('<box size="0.001 0.001 0.001"/>', "", Severity.INFO),
            ('<sphere radius="0.002"/>', "", Severity.INFO),
            ('<sphere radius="0.003"/>', "", Severity.WARNING),
            ('<cylinder radius="0.001" length="0.1"/>', "", Severity.WARNING),
            ('<mesh filename="a.stl" scale="0.001 0.001 0.001"/>', "", Severity.WARNING),
            ('<box size="0.001 0.001 0.001"/>', "import pydrake", Severity.WARNING),
        ],
    )
    def test_the_colour_of_a_speck_is_a_note(
        self, tmp_path: Path, geometry: str, drake: str, severity: Severity
    ) -> None:
        (tmp_path / "run.py").write_text(drake)
        shape = f'<visual><geometry>{geometry}</geometry><material name="red"/></visual>'
        (finding,) = findings(tmp_path, f'<robot name="r"><link name="a">{shape}</link></robot>', "XML011")
        assert finding.severity == severity

    @pytest.mark.parametrize(
        ("block", "launch", "severity"),
        [
            ("<material>Gazebo/White</material>", "gazebo_ros spawn_model", Severity.INFO),
            ("<visual><material><diffuse>1 0 0 1</diffuse></material></visual>", "gazebo_ros", Severity.INFO),
            ("<mu1>1</mu1>", "gazebo_ros spawn_model", Severity.WARNING),
            ("<material>Gazebo/White</material>", "gazebo_ros spawn_model -param robot_description", Severity.WARNING),
            ("<material>Gazebo/White</material>", "", Severity.WARNING),
        ],
    )
    def test_a_colour_that_gazebo_alone_would_draw_and_has_is_a_note(
        self, tmp_path: Path, block: str, launch: str, severity: Severity
    ) -> None:
        (tmp_path / "package.xml").write_text("<package><name>p</name><run_depend>rviz</run_depend></package>")
        (tmp_path / "go.launch").write_text(f"<launch><!-- --><arg name='a' default='{launch}'/></launch>")
        gazebo = f'<gazebo reference="a">{block}</gazebo>'
        text = f'<robot name="r"><link name="a">{self.REFERENCE}</link>{gazebo}</robot>'
        (finding,) = findings(tmp_path, text, "XML011")
        assert finding.severity == severity

    def test_a_texture_that_is_there(self, tmp_path: Path) -> None:
        text = LINK.format(
            robot="", link=SHAPE.format('<material name="wood"><texture filename="wood.png"/></material>')
        )
        (finding,) = findings(tmp_path, text, "XML011")
        assert finding.message_id == "texture"
        (tmp_path / "wood.png").write_bytes(b"")
        assert not findings(tmp_path, text, "XML011")


class TestXML013:
    @pytest.mark.parametrize("is_of_robot", [True, False])
    def test_a_material_of_the_robot_stays_and_is_black(self, tmp_path: Path, is_of_robot: bool) -> None:
        material = '<material name="m"><color rgba="0 0 1.5 1"/></material>'
        inner = '<material name="m"/>' if is_of_robot else material
        shape = f"<visual><geometry><sphere radius='1'/></geometry>{inner}</visual>"
        text = f'<robot name="r">{material if is_of_robot else ""}<link name="a">{shape}</link></robot>'
        (finding,) = findings(tmp_path, text, "XML013")
        assert ("black" in finding.consequences["rviz"]) == is_of_robot

    @pytest.mark.parametrize(
        ("rgba", "written"),
        [
            ("255 128 0 1", "1 0.502 0 1"),
            ("255 128 0 255", "1 0.502 0 1"),
            ("1.001 1 0 1", "1 1 0 1"),
            ("1.4 0 0 1", None),
            ("-0.2 0 0 1", None),
            ("256 0 0 1", None),
            ("2 2 2 1", None),
            ("255 128 0 100", None),
            ("0 0 0 2", None),
        ],
    )
    def test_what_was_meant(self, tmp_path: Path, rgba: str, written: str | None) -> None:
        text = LINK.format(robot=f'<material name="m"><color rgba="{rgba}"/></material>', link="")
        (finding,) = findings(tmp_path, text, "XML013")
        assert finding.fix is not None
        assert [edit.replacement for edit in finding.fix.edits] == ([written] if written else [])

    def test_a_number_may_have_lost_its_point(self, tmp_path: Path) -> None:
        text = LINK.format(robot='<material name="m"><color rgba="0.0 0.0 0.0 05"/></material>', link="")
        (finding,) = findings(tmp_path, text, "XML013")
        assert "0.0 0.0 0.0 05" in finding.message
        assert finding.fix is not None
        assert finding.fix.title == "write each component between 0 and 1, perhaps 0.5 for 05"

    @pytest.mark.parametrize("rgba", ["0 0 0 0", "1 1 1 1", "1 1 1", "a 0 0 1"])
    def test_within_the_range(self, tmp_path: Path, rgba: str) -> None:
        assert not findings(
            tmp_path, LINK.format(robot=f'<material name="m"><color rgba="{rgba}"/></material>', link=""), "XML013"
        )


def test_a_comment_of_a_semantic_description_ends_where_moveit_ends_it(tmp_path: Path) -> None:
    """tinyxml2 reads on to the next ``-->``: what is between is lost for MoveIt too, and all the rest is read."""
    package = tmp_path / "arm"
    (package / "config").mkdir(parents=True)
    (package / "package.xml").write_text("<package format='2'><name>arm</name></package>")
    (package / "arm.urdf").write_text('<robot name="arm"><link name="l"/></robot>')
    lost, read = (f'<disable_collisions link1="l" link2="{name}"/>' for name in ("lost", "read"))
    text = f'<robot name="arm">\n<!-- old --!>\n{lost}\n<!-- new -->\n{read}</robot>'
    (package / "config" / "arm.srdf").write_text(text)
    (finding,) = check(package, codes={"XML001"}).findings
    assert (finding.message_id, finding.severity) == ("srdf-forgiven", Severity.WARNING)
    assert (finding.consequences["moveit"], finding.consequences["xacro"]) == ("loads it", "refuses the file")
    (unknown,) = check(package, codes={"COL003"}).findings
    assert "read" in unknown.message
    assert unknown.location.span is not None
    assert unknown.location.span.line == 5


def test_a_semantic_description_that_is_broken_is_told_with_its_package(tmp_path: Path) -> None:
    package = tmp_path / "arm"
    (package / "config").mkdir(parents=True)
    (package / "package.xml").write_text("<package format='2'><name>arm</name></package>")
    (package / "arm.urdf").write_text('<robot name="arm"><link name="l"/></robot>')
    (package / "config" / "arm.srdf").write_text('<robot name="arm">\n  <disable_collisions link1="a"\n</robot>')
    found = [f for f in check(package, codes={"XML001"}).findings if f.location.span]
    assert [(f.message_id, Path(f.location.span.file).name) for f in found if f.location.span] == [("srdf", "arm.srdf")]
    run = check(package / "config" / "arm.srdf", codes={"XML001"})
    assert "is not readable XML" in run.failures[0]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('<?xml version="1.0"?>\n<?xml-model href="x"?>\n<robot name="r"><link name="l"/></robot>', []),
        ('<?x?><robot name="r"><link name="l"/></robot>', []),
        ('<?xml version="1.0"?>\n<!-- c -->\n<?x?>\n<robot name="r"><link name="l"/></robot>', [3]),
        ('<robot name="r">\n<?x y?><link name="l"/></robot>', [2]),
        ('<robot name="r"><link name="l"/></robot>\n<?x?>', [2]),
    ],
)
def test_a_processing_instruction_stands_first_as_the_reference_parser_has_it(
    tmp_path: Path, text: str, said: list[int]
) -> None:
    found = check_text(tmp_path, text, codes={"XML001"}).findings
    assert [f.location.span.line for f in found if f.location.span and f.message_id == "instruction"] == said
    pinocchio = pytest.importorskip("pinocchio")
    try:
        pinocchio.buildModelFromXML(text)
    except ValueError:
        assert said
    else:
        assert not said


def test_an_attribute_for_isaac_gym_is_known(tmp_path: Path) -> None:
    joint = '<joint name="j" type="fixed" dont_collapse="true"><parent link="a"/><child link="b"/></joint>'
    assert not check_text(
        tmp_path, f'<robot name="r"><link name="a"/><link name="b"/>{joint}</robot>', codes={"XML004"}
    ).findings


@pytest.mark.parametrize(
    ("place", "message", "severity"),
    [
        ('<gazebo><plugin name="p" filename="p.so"><ns>$(arg ns)</ns></plugin></gazebo>', "gazebo", Severity.INFO),
        ('<gazebo reference="$(arg ns)"/>', "gazebo", Severity.INFO),
        ('<link name="${ns}"/><gazebo reference="$(arg ns)"/>', "not_expanded", Severity.ERROR),
        ('<link name="$(arg ns)"/><gazebo reference="$(arg ns)"/>', "part", Severity.WARNING),
    ],
)
def test_substitutions_that_only_gazebo_reads_are_a_note(
    tmp_path: Path, place: str, message: str, severity: Severity
) -> None:
    (finding,) = check_text(tmp_path, f'<robot name="r"><link name="a"/>{place}</robot>', codes={"XML009"}).findings
    assert (finding.message_id, finding.severity) == (message, severity)


@pytest.mark.parametrize(
    ("typed", "repair"),
    [
        ("${size/2} 0 0", "write the value in its place; the file does not define size"),
        ("${1/2} 0 0", "load what xacro makes of it"),
        ("${pi/2} ${sin(0.1)} 1e-3", "load what xacro makes of it"),
        ("$(arg size) 0 0", "load what xacro makes of it"),
        ("${'size'} 0 0", "load what xacro makes of it"),
    ],
)
@pytest.mark.parametrize("tag", ["sensor", "plugin"])
def test_xacro_would_stop_at_a_name_that_the_file_does_not_define(
    tmp_path: Path, typed: str, repair: str, tag: str
) -> None:
    body = f'<gazebo reference="a"><{tag} name="s"><pose>{typed}</pose></{tag}></gazebo>'
    (finding,) = check_text(tmp_path, f'<robot name="r"><link name="a"/>{body}</robot>', codes={"XML009"}).findings
    assert finding.fix is not None
    assert repair in finding.fix.title
    # What Gazebo makes of it is known where the text is handed to a plugin.
    assert ("gazebo" in finding.consequences) == (tag == "plugin")


@pytest.mark.parametrize(
    ("name", "repair"),
    [
        ("size", "write `<xacro:property` for the `<property` of line 2 and the others like it, declare `xmlns:xacro`"),
        ("other", "write the value in its place; the file does not define size"),
    ],
)
def test_a_property_without_the_prefix_is_what_defines_a_name(tmp_path: Path, name: str, repair: str) -> None:
    shape = '<visual><geometry><sphere radius="${size}"/></geometry></visual>'
    text = f'<robot name="r">\n<property name="{name}" value="1"/><link name="a">{shape}</link></robot>'
    (finding,) = check_text(tmp_path, text, codes={"XML009"}).findings
    assert finding.fix is not None
    assert finding.fix.title.startswith(repair)


@pytest.mark.parametrize(
    ("manifest", "more", "severity"),
    [
        ("", "", Severity.INFO),
        ("<package><name>p</name></package>", "", Severity.WARNING),
        (
            "",
            '<link name="b"/><joint name="j" type="fixed"><parent link="a"/><child link="b"/></joint>',
            Severity.WARNING,
        ),
    ],
)
def test_an_object_for_isaac_gym_needs_no_mass(tmp_path: Path, manifest: str, more: str, severity: Severity) -> None:
    if manifest:
        (tmp_path / "package.xml").write_text(manifest)
    text = f'<robot name="r"><link name="a"><inertial><density value="400"/></inertial></link>{more}</robot>'
    (finding,) = check_text(tmp_path, text, codes={"XML005"}).findings
    assert finding.severity is severity


@pytest.mark.parametrize(
    ("typed", "severity", "repair"),
    [
        ("<origin/>", Severity.INFO, "delete it: it is empty"),
        (
            '<origin xyz="0 0 1"/>',
            Severity.WARNING,
            "move it into <inertial> or <visual> or <collision>, or delete it",
        ),
    ],
)
def test_an_empty_element_in_the_wrong_place_is_deleted(
    tmp_path: Path, typed: str, severity: Severity, repair: str
) -> None:
    text = f'<robot name="r"><link name="a">{typed}</link></robot>'
    (finding,) = check_text(tmp_path, text, codes={"XML003"}).findings
    assert finding.fix is not None
    assert (finding.severity, finding.fix.title) == (severity, repair)


@pytest.mark.parametrize(
    ("geometry", "severity", "urdfdom"),
    [
        ('<material name="m"/><box size="1 1 1"/>', "error", "drops the shape"),
        ('<origin/><box size="1 1 1"/>', "error", "drops the shape"),
        ('<box size="1 1 1"/><material name="m"/>', "warning", "ignores it"),
        ('<bx size="1 1 1"/>', "error", "drops the shape"),
        ('<box size="1 1 1"/><surface><mu>1</mu></surface>', "warning", "ignores it"),
        ('<box size="1 1 1"/><bx size="1 1 1"/>', "warning", "ignores it"),
    ],
)
def test_only_the_first_element_of_a_geometry_is_its_shape(
    tmp_path: Path, geometry: str, severity: str, urdfdom: str
) -> None:
    text = f'<robot name="r"><link name="l"><visual><geometry>{geometry}</geometry></visual></link></robot>'
    (finding,) = check_text(tmp_path, text, codes={"XML003"}).findings
    assert str(finding.severity) == severity
    assert finding.consequences["urdfdom"].startswith(urdfdom)


def test_friction_in_a_geometry_is_moved_to_the_link(tmp_path: Path) -> None:
    geometry = '<box size="1 1 1"/><friction><ode><mu>0.1</mu><mu2>0.2</mu2></ode></friction>'
    text = f'<robot name="r"><link name="l"><collision><geometry>{geometry}</geometry></collision></link></robot>'
    (finding,) = check_text(tmp_path, text, codes={"XML003"}).findings
    assert finding.fix is not None
    assert '`<gazebo reference="l"><mu1>0.1</mu1><mu2>0.2</mu2></gazebo>` at the end of the robot' in finding.fix.title


@pytest.mark.parametrize(
    ("element", "severity", "repair"),
    [
        ("<surface><friction><ode><mu>10</mu></ode></friction></surface>", "warning", "<collision>…</collision>"),
        (
            "<collision><surface><friction><ode><mu1>1</mu1><mu2>1</mu2></ode></friction></surface></collision>",
            "warning",
            'move <mu1> and <mu2> directly into `<gazebo reference="l">…</gazebo>` at the end of the robot',
        ),
        (
            "<collision><surface><contact><ode><kp>1</kp><minDepth>1</minDepth><soft_erp>1</soft_erp></ode></contact></surface></collision>",
            "warning",
            ">…</gazebo>` at the end of the robot, and <soft_erp> into <collision><surface><contact><ode> in it",
        ),
        (
            "<collision><surface><friction><mu>9</mu><mu2>9</mu2><slip1>1</slip1></friction></surface></collision>",
            "warning",
            'move <mu> as <mu1> and <mu2> directly into `<gazebo reference="l">…</gazebo>` at the end of the robot, and <slip1> '
            "into <collision><surface><friction><ode> in it",
        ),
        (
            "<collision><surface><friction><ode><mu>9</mu><minDepth>1</minDepth></ode></friction></surface></collision>",
            "warning",
            "move <mu> as <mu1> and <minDepth> directly into",
        ),
        (
            "<collision><surface><contact><bullet><kp>1</kp></bullet></contact></surface></collision>",
            "warning",
            'move it into `<gazebo reference="l"><collision>…</collision></gazebo>`',
        ),
        ("<surface><friction/></surface>", "info", ""),
        ("<gravity>1</gravity>", "info", ""),
        ("<pose>0 0 0 0 0 0</pose>", "info", ""),
        ("<pose>0 0 1 0 0 0</pose>", "warning", "delete it"),
        ("<gravity>0</gravity>", "warning", '"l"><turnGravityOff>true<'),
    ],
)
def test_sdf_in_a_link_says_where_gazebo_reads_it(tmp_path: Path, element: str, severity: str, repair: str) -> None:
    (finding,) = check_text(
        tmp_path, f'<robot name="r"><link name="l">{element}</link></robot>', codes={"XML003"}
    ).findings
    assert str(finding.severity) == severity
    assert finding.fix is not None
    assert repair in finding.fix.title


def test_the_block_for_sdf_in_a_macro_names_the_link_as_it_is_typed(tmp_path: Path) -> None:
    text = """<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:macro name="leg" params="side">
    <link name="${side}_knee"><collision><surface><friction><ode><mu>1</mu></ode></friction></surface></collision></link>
    </xacro:macro><xacro:leg side="left"/><xacro:leg side="right"/></robot>"""
    (finding,) = check_text(tmp_path, text, name="r.urdf.xacro", codes={"XML003"}).findings
    assert finding.fix is not None
    block = '`<gazebo reference="${side}_knee"><collision>…</collision></gazebo>` after the link'
    assert finding.fix.title == f"move it into {block}, or delete it"


@pytest.mark.parametrize(
    ("name", "colour"), [("Black", "0 0 0 1"), ("gray", "0.5 0.5 0.5 1"), ("red", "1 0 0 1"), ("m1", "…")]
)
def test_an_undefined_colour_is_proposed_by_its_name(tmp_path: Path, name: str, colour: str) -> None:
    shape = f'<visual><geometry><sphere radius="1"/></geometry><material name="{name}"/></visual>'
    text = f'<robot name="r"><link name="l">{shape}</link></robot>'
    (finding,) = check_text(tmp_path, text, codes={"XML011"}).findings
    assert finding.fix is not None
    assert f'<material name="{name}"><color rgba="{colour}"/></material>' in finding.fix.title


@pytest.mark.parametrize(
    ("element", "found"),
    [
        ('<box_inertia m="0.1" x="0.05" y="0.05" z="0.05"/>', "ignored"),
        ('<box_inertia ixx="0.1" y="0.05"/>', "misspelt"),
        ('<box_inertia IXX="0.1"/>', "misspelt"),
        ('<box_inertia name="a"/>', "misspelt"),
    ],
)
def test_an_element_with_attributes_of_its_own_is_not_misspelt(tmp_path: Path, element: str, found: str) -> None:
    """A macro's call without the macro has the arguments of the macro."""
    text = f'<robot name="r"><link name="a"><inertial><mass value="1"/>{element}</inertial></link></robot>'
    (finding,) = findings(tmp_path, text, "XML003", "robot.urdf.xacro")
    assert finding.message_id == found
    assert finding.fix is not None
    assert ("calls a macro" in finding.fix.title) is (found == "ignored")


@pytest.mark.parametrize(
    ("before", "message"), [("\n", "forgiven"), (" ", "forgiven"), ("\r\n", "forgiven"), ("<!-- -->\n", "malformed")]
)
def test_a_blank_before_the_declaration_stops_strict_parsers_only(tmp_path: Path, before: str, message: str) -> None:
    (tmp_path / "r.urdf").write_text(f'{before}<?xml version="1.0"?><robot name="r"><link name="l"/></robot>')
    (finding,) = check(tmp_path / "r.urdf", codes={"XML001"}).findings
    assert finding.message_id == message
    assert finding.consequences["mujoco"] == ("loads it" if message == "forgiven" else "refuses the file")


@pytest.mark.parametrize(
    ("start", "is_read"), [('textfile="{}"', True), ('command="cat {}"', True), ('command="xacro {}"', False)]
)
@pytest.mark.parametrize("text", ['\n<?xml version="1.0"?>\n{}', '<?xml version="1.0"?><!-- -- -->\n{}'])
def test_what_urdfdom_forgives_is_checked_unless_xacro_reads_it(
    tmp_path: Path, text: str, start: str, is_read: bool
) -> None:
    folder = tmp_path / "arm"
    (folder / "launch").mkdir(parents=True)
    (folder / "package.xml").write_text("<package format='2'><name>arm</name></package>")
    (folder / "arm.urdf").write_text(text.format('<robot name="arm"><link name="a"/><link name="a"/></robot>'))
    param = f'<param name="robot_description" {start.format("$(find arm)/arm.urdf")}/>'
    (folder / "launch" / "arm.launch").write_text(f"<launch>{param}</launch>")
    found = {f.code: f for f in check(folder, codes={"XML001", "KIN001"}).findings}
    refused = found["XML001"]
    assert (refused.severity, refused.message_id) == (
        (Severity.WARNING, "forgiven") if is_read else (Severity.ERROR, "malformed")
    )
    assert ("KIN001" in found) == is_read
    if is_read:
        assert found["KIN001"].location.span is not None
        assert found["KIN001"].location.span.line == (3 if text.startswith("\n") else 2)


def test_a_semantic_description_with_a_blank_before_the_declaration_is_read(tmp_path: Path) -> None:
    package = tmp_path / "arm"
    package.mkdir()
    (package / "package.xml").write_text("<package format='2'><name>arm</name></package>")
    (package / "arm.urdf").write_text('<robot name="arm"><link name="l"/></robot>')
    text = '\n<?xml version="1.0"?>\n<robot name="arm">\n<disable_collisions link1="l" link2="none"/></robot>'
    (package / "arm.srdf").write_text(text)
    (finding,) = check(package, codes={"XML001"}).findings
    assert finding.message_id == "srdf-forgiven"
    (unknown,) = check(package, codes={"COL003"}).findings
    assert unknown.location.span is not None
    assert unknown.location.span.line == 4


@pytest.mark.parametrize(
    ("typed", "repair"),
    [
        ("width", "write `${width}`"),
        ("{width}", "write `${width}`"),
        ("length", "write `$(arg length)`"),
        ("wide", "write a number such as 0.5 or 1e-3"),
    ],
)
def test_a_name_in_place_of_a_number_is_read_as_the_xacro_defines_it(tmp_path: Path, typed: str, repair: str) -> None:
    defined = '<xacro:property name="width" value="1"/><xacro:arg name="length" default="2"/>'
    shape = f'<visual><geometry><sphere radius="{typed}"/></geometry></visual>'
    text = f'<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">{defined}<link name="a">{shape}</link></robot>'
    (finding,) = check_text(tmp_path, text, codes={"XML007"}, name="r.urdf.xacro").findings
    assert finding.fix is not None
    assert (finding.message_id, finding.fix.title) == ("other", repair)


@pytest.mark.parametrize(("own", "found"), [("", []), ('<link name="chassis"/>', ["XML011"])], ids=["part", "robot"])
def test_the_material_of_a_part_of_another_robot_is_defined_there(tmp_path: Path, own: str, found: list[str]) -> None:
    visual = '<visual><geometry><sphere radius="1"/></geometry><material name="brass"/></visual>'
    joint = '<joint name="j" type="fixed"><parent link="base_link"/><child link="eye"/></joint>'
    text = f'<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">{own}<link name="eye">{visual}</link>{joint}</robot>'
    assert [f.code for f in check_text(tmp_path, text, codes={"XML011"}, name="r.urdf.xacro").findings] == found


def test_a_material_of_an_included_file_is_not_to_be_deleted(tmp_path: Path) -> None:
    steel = '<material name="steel"><color rgba="0.5 0.5 0.5 1"/></material>'
    (tmp_path / "colours.xacro").write_text(f"<robot>{steel}</robot>")
    include = '<xacro:include filename="colours.xacro"/>'
    text = f'<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">{include}{steel}<link name="a"/></robot>'
    (finding,) = check_text(tmp_path, text, codes={"XML012"}, name="r.urdf.xacro").findings
    assert finding.fix is not None
    assert finding.fix.title == "delete the definition in r.urdf.xacro"


def test_two_geometries_may_be_two_shapes(tmp_path: Path) -> None:
    shapes = '<geometry><sphere radius="1"/></geometry><geometry><box size="1 1 1"/></geometry>'
    text = f'<robot name="r"><link name="a"><collision>{shapes}</collision></link></robot>'
    (finding,) = check_text(tmp_path, text, codes={"XML006"}).findings
    assert finding.fix is not None
    assert finding.fix.title == "delete what is left over; if both are meant, give each its own collision"


@pytest.mark.parametrize(
    ("beside", "repair"),
    [
        ("", "move it into the <collision> around it, or delete it"),
        ('<origin xyz="0 0 1"/>', "delete it: the element around it has its own <origin>"),
    ],
)
def test_an_origin_in_a_geometry_belongs_to_the_shape_around_it(tmp_path: Path, beside: str, repair: str) -> None:
    shape = f'<collision>{beside}<geometry><origin xyz="0 0 2"/><sphere radius="1"/></geometry></collision>'
    (finding,) = check_text(
        tmp_path, f'<robot name="r"><link name="a">{shape}</link></robot>', codes={"XML003"}
    ).findings
    assert finding.fix is not None
    assert (finding.severity, finding.fix.title) == (Severity.ERROR, repair)


@pytest.mark.parametrize(("named", "severity"), [("arm.urdf", Severity.INFO), ("links.xacro", Severity.WARNING)])
def test_a_xacro_without_a_name_beside_a_named_model_is_a_kept_part(
    tmp_path: Path, named: str, severity: Severity
) -> None:
    files = {
        "package.xml": "<package format='2'><name>arm</name></package>",
        "launch/show.launch": f"<launch><param name='m' textfile='$(find arm)/urdf/{named}'/></launch>",
        "urdf/links.xacro": '<robot xmlns:xacro="http://www.ros.org/wiki/xacro"><link name="a"/></robot>',
    }
    for name, text in files.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text, encoding="utf-8")
    (finding,) = check(tmp_path / "urdf/links.xacro", codes={"XML002"}).findings
    assert finding.severity == severity


@pytest.mark.parametrize(
    ("first", "second", "message"),
    [
        ('<origin xyz="0.0 -0.0 -0.0" rpy="0 0 0"/>', '<origin xyz="0 0 0" rpy="0 0 0"/>', "identical"),
        ('<origin xyz=".1 0 0"/>', '<origin rpy="0 0 0" xyz="1e-1 0 0"/>', "identical"),
        ("<origin/>", '<origin xyz="0 0 0"/>', "identical"),
        ('<origin xyz="0.1 0 0"/>', '<origin xyz="0.1 0 0.001"/>', "repeated"),
        ('<origin xyz="0.1 0"/>', '<origin xyz="0.1 0 0"/>', "repeated"),
    ],
)
def test_numbers_of_repeated_elements_are_compared_and_not_their_digits(
    tmp_path: Path, first: str, second: str, message: str
) -> None:
    shape = "<geometry><sphere radius='1'/></geometry>"
    text = ROBOT.format(link=f"<collision>{first}{second}{shape}</collision>", joint="")
    assert [f.message_id for f in findings(tmp_path, text, "XML006")] == [message]


def test_of_two_inertials_neither_is_called_wrong(tmp_path: Path) -> None:
    inertia = '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
    two = "".join(f'<inertial><mass value="1"/><origin xyz="{x} 0 0"/>{inertia}</inertial>' for x in (0, 1))
    (finding,) = findings(tmp_path, ROBOT.format(link=two, joint=""), "XML006")
    assert finding.fix is not None
    assert "wrong" not in finding.fix.title
    assert "all of them" in finding.fix.title


@pytest.mark.parametrize(
    ("inside", "repair"),
    [
        (
            "<gravity>9.8</gravity>",
            "delete it: that is so without it",
        ),
        (
            "<collision><surface><contact><ode><kp>3e4</kp></ode></contact></surface></collision>",
            'delete it: `<gazebo reference="a">` has its own <surface>, which Gazebo uses; correct the numbers there if these',
        ),
    ],
)
def test_sdf_is_not_moved_where_it_would_say_something_else(tmp_path: Path, inside: str, repair: str) -> None:
    block = '<gazebo reference="a"><collision><surface><friction><ode><mu>1</mu></ode></friction></surface></collision></gazebo>'
    (finding,) = findings(tmp_path, f'<robot name="r"><link name="a">{inside}</link>{block}</robot>', "XML003")
    assert finding.fix is not None
    assert finding.fix.title.startswith(repair)
    assert (finding.severity is Severity.INFO) == ("gravity" in inside)


@pytest.mark.parametrize(
    ("folder", "severity"), [("LEGACY_LAUNCHERS", Severity.WARNING), ("horizon_legacy", Severity.ERROR)]
)
def test_a_broken_launch_file_that_is_kept_aside_starts_nothing(
    tmp_path: Path, folder: str, severity: Severity
) -> None:
    for name, text in (
        ("package.xml", "<package><name>p</name></package>"),
        (f"{folder}/a.launch", "<launch><b></launch>"),
    ):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    (finding,) = check(tmp_path / folder / "a.launch", codes={"XML001"}).findings
    assert finding.severity is severity


@pytest.mark.parametrize(("own", "severity"), [("1 0 0", Severity.INFO), ("2 0 0", Severity.WARNING)])
def test_an_origin_in_a_link_that_its_joint_has_too_loses_nothing(tmp_path: Path, own: str, severity: Severity) -> None:
    text = (
        '<robot name="r"><link name="base"/><link name="arm"><origin xyz="1.0 0 0" rpy="0 0 0"/></link>'
        f'<joint name="j" type="fixed"><parent link="base"/><child link="arm"/><origin xyz="{own}"/></joint></robot>'
    )
    (finding,) = findings(tmp_path, text, "XML003")
    assert (finding.message_id, finding.severity) == ("misplaced", severity)


@pytest.mark.parametrize(
    ("definition", "place", "repair"),
    [
        (
            '<xacro:macro name="m">{}</xacro:macro>',
            "in the macro m, which is not called here",
            "write `<xacro:m/>` in place",
        ),
        (
            '<xacro:macro name="m"><link name="x">{}</link></xacro:macro>',
            "in the macro m",
            "define it as a child of <robot>",
        ),
        (
            '<xacro:if value="0">{}</xacro:if>',
            "under a condition that is false here",
            "define it as a child of <robot>",
        ),
    ],
)
def test_a_material_that_xacro_leaves_out_is_defined(tmp_path: Path, definition: str, place: str, repair: str) -> None:
    text = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">{}<link name="a">{}</link></robot>'
    visual = '<visual><geometry><sphere radius="1"/></geometry><material name="steel"/></visual>'
    written = text.format(definition.format('<material name="steel"><color rgba="1 1 1 1"/></material>'), visual)
    (finding,) = findings(tmp_path, written, "XML011", name="robot.urdf.xacro")
    assert f"which robot.urdf.xacro defines only {place}" in finding.message
    assert finding.fix is not None
    assert finding.fix.title.startswith(repair)


def test_a_copy_of_a_part_that_a_xacro_includes_from_elsewhere_is_a_note(tmp_path: Path) -> None:
    part = '<robot name="cam"><link name="a"><visual><origin rpy="${-M_PI/2} 0 ${-M_PI/2}"/></visual></link></robot>'
    include = '<xacro:include filename="$(find other)/urdf/cam.urdf"/>'
    for name, text in (
        ("package.xml", "<package><name>p</name></package>"),
        ("cam.urdf", part),
        ("bot.xacro", f'<robot name="b" xmlns:xacro="x"><xacro:property name="M_PI" value="3.14"/>{include}</robot>'),
    ):
        (tmp_path / name).write_text(text)
    (finding,) = check(tmp_path / "cam.urdf", codes={"XML009"}).findings
    assert (finding.message_id, finding.severity) == ("twin", Severity.INFO)
    assert "2 substitutions of xacro" in finding.message
    (tmp_path / "bot.xacro").unlink()
    (finding,) = check(tmp_path / "cam.urdf", codes={"XML009"}).findings
    assert (finding.message_id, finding.severity) == ("not_expanded", Severity.ERROR)
    assert finding.fix is not None
    assert "only in a file that defines that and includes this one" in finding.fix.title


@pytest.mark.parametrize(
    ("beside", "severity", "repair"),
    [
        (
            "<visual><geometry><sphere radius='1'/></geometry></visual>",
            Severity.INFO,
            "delete it: the link has other shapes",
        ),
        ("", Severity.WARNING, "move it into <visual> or <collision>"),
    ],
)
def test_a_geometry_in_an_inertial_is_a_remark_beside_other_shapes(
    tmp_path: Path, beside: str, severity: Severity, repair: str
) -> None:
    inertial = "<inertial><mass value='1'/><geometry><box size='1 1 1'/></geometry></inertial>"
    text = f"<robot name='r'><link name='l'>{beside}{inertial}</link></robot>"
    (finding,) = check_text(tmp_path, text, codes={"XML003"}).findings
    assert finding.severity == severity
    assert finding.fix is not None
    assert finding.fix.title.startswith(repair)


@pytest.mark.parametrize(
    ("name", "declared", "value", "message", "severity"),
    [
        ("r.urdf", 'SYSTEM "robot.dtd"', "&a;", "doctype", Severity.ERROR),
        ("r.urdf", '[<!ENTITY a "r">]', "&a;", "doctype", Severity.ERROR),
        ("r.urdf.xacro", '[<!ENTITY a "r">]', "&a;", "doctype-xacro", Severity.WARNING),
        ("r.urdf.xacro", '[<!ENTITY a "r"><!ENTITY b "&a;&a;">]', "&b;", "doctype", Severity.ERROR),
        ("r.urdf.xacro", '[<!ENTITY a SYSTEM "/etc/passwd">]', "&a;", "doctype", Severity.ERROR),
    ],
)
def test_a_document_type_is_an_error_where_a_program_lacks_or_fears_its_entities(
    tmp_path: Path, name: str, declared: str, value: str, message: str, severity: Severity
) -> None:
    robot_tag = f'<robot name="{value}" xmlns:xacro="http://www.ros.org/wiki/xacro">'
    text = f'<!DOCTYPE robot {declared}>{robot_tag}<link name="a"/></robot>'
    (finding,) = findings(tmp_path, text, "XML001", name)
    assert (finding.message_id, finding.severity, finding.blocks_check) == (message, severity, True)
    assert finding.fix is not None


@pytest.mark.parametrize(
    ("shapes", "severities", "repair"),
    [
        ("<visual/><visual/>", {Severity.WARNING}, "add <geometry>, or delete"),
        (
            '<visual/><collision><geometry><sphere radius="1"/></geometry></collision>',
            {Severity.ERROR},
            "add <geometry>, or",
        ),
        ('<visual><box size="1 1 1"/></visual>', {Severity.ERROR}, "add <geometry> around the <box>, or delete"),
    ],
)
def test_a_shape_without_geometry_is_an_error_where_something_is_lost(
    tmp_path: Path, shapes: str, severities: set[Severity], repair: str
) -> None:
    text = f'<robot name="r"><link name="a">{shapes}</link></robot>'
    findings = check_text(tmp_path, text, codes={"XML005"}).findings
    assert {finding.severity for finding in findings} == severities
    assert all(finding.fix is not None and finding.fix.title.startswith(repair) for finding in findings)


@pytest.mark.parametrize(
    ("launch", "manifest", "severity"),
    [
        ('<node pkg="gazebo_ros" type="spawn_model" args="-sdf -param robot_description"/>', "", Severity.INFO),
        ('<node pkg="gazebo_ros" type="spawn_model" args="-urdf -param robot_description"/>', "", Severity.ERROR),
        ("<!-- spawn_model -sdf -->", "", Severity.ERROR),
        ("", "<exec_depend>sdformat_urdf</exec_depend>", Severity.INFO),
    ],
)
def test_an_sdf_model_that_is_loaded_as_such_is_not_checked_and_not_wrong(
    tmp_path: Path, launch: str, manifest: str, severity: Severity
) -> None:
    loads = '<param name="robot_description" textfile="$(find car)/sdf/car.sdf"/>'
    files = {
        "package.xml": f"<package format='2'><name>car</name>{manifest}</package>",
        "launch/car.launch": f"<launch>{loads}{launch}</launch>",
        "sdf/car.sdf": "<sdf version='1.6'><model name='car'><link name='l'/></model></sdf>",
    }
    (finding,) = find(tmp_path, files, "XML002", name="launch/car.launch")
    assert (finding.message_id, finding.severity) == ("format", severity)
    assert finding.blocks_check


@pytest.mark.parametrize(
    ("spawned", "severity"),
    [
        ("$(find car)/models/car_4wd/model.sdf", Severity.INFO),
        ("model://car_4wd/model.sdf", Severity.INFO),
        ("$(find car)/models/$(arg robot)/model.sdf", Severity.INFO),
        ("$(find world)/models/table/model.sdf", Severity.ERROR),
        ("model://table/model.sdf", Severity.ERROR),
        ("$(find world)/models/$(arg thing)/model.sdf", Severity.ERROR),
        ("$(find car)/models/car_4wd/model.sdf.xacro", Severity.ERROR),
    ],
)
def test_a_launch_file_that_spawns_another_sdf_model_of_this_name_does_not_read_it(
    tmp_path: Path, spawned: str, severity: Severity
) -> None:
    files = {
        ".git/HEAD": "",
        "world/launch/world.launch": f'<launch><node args="-sdf -file {spawned}"/></launch>',
        "car/package.xml": "<package format='2'><name>car</name></package>",
        "car/models/car_4wd/model.sdf": "<sdf version='1.6'><model name='car'><link name='l'/></model></sdf>",
        "car/launch/car.launch": '<launch><param name="robot_description" '
        'textfile="$(find car)/models/car_4wd/model.sdf"/></launch>',
    }
    (finding,) = find(tmp_path, files, "XML002", name="car/launch/car.launch")
    assert (finding.message_id, finding.severity) == ("format", severity)


@pytest.mark.parametrize(
    "numbers", ["0 0 0", "\n0 0 0", "0\n0 0", "0 \n 0 0", "0 0 0 \n", "\n 0 0 0", "0 \t0 0", "0\t 0 0", " 0  0 0 "]
)
def test_white_space_between_numbers_is_reported_where_urdfdom_stops_at_it(tmp_path: Path, numbers: str) -> None:
    pinocchio = pytest.importorskip("pinocchio")
    text = ROBOT.format(link="", joint=JOINT.format(effort="1", more=f'<origin xyz="{numbers}"/>'))
    found = findings(tmp_path, text, "XML007")
    try:
        with capture_stderr():
            pinocchio.buildModelFromXML(text)
    except ValueError:
        assert [finding.message_id for finding in found] == ["blank"]
    else:
        assert not found
