"""Defaults of arguments that every file which starts a model replaces: what they alone cause is not listed."""

from __future__ import annotations

from pathlib import Path

import pytest
from conftest import check

from urdfcheck.core import Run, SkippedCheck
from urdfcheck.output.shared.verdict.losses import list_refusing_notes
from urdfcheck.policy.on_request import list_argument_names

ARM = """<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">
<xacro:arg name="mass" default="0.0"/><xacro:arg name="length" default="0.0"/>
<link name="base"/>
<joint name="j" type="continuous"><parent link="base"/><child link="rod"/><axis xyz="0 0 1"/></joint>
<link name="rod"><inertial><mass value="$(arg mass)"/><inertia ixx="1e-6" ixy="0" ixz="0" iyy="1e-6" iyz="0" izz="{}"/></inertial>
<collision><geometry><cylinder radius="0.01" length="$(arg length)"/></geometry></collision></link></robot>"""
PACKAGE = "<package><name>arm</name></package>"
XACRO = "PathJoinSubstitution([FindPackageShare('arm'), 'urdf', 'arm.urdf.xacro'])"
# What a program knows at launch only.
COMPUTED = f"Command(['xacro ', {XACRO}, ' mass:=', str(values['m']), ' length:=', str(values['l'])])"

HEAVY = """<inertial><mass value="9e6"/><inertia ixx="1e5" ixy="0" ixz="0" iyy="1e5" iyz="0" izz="1e5"/></inertial>"""
OWN_DEFAULTS = """<launch><arg name="m" default="0"/><arg name="l" default="0.0"/><param name="robot_description"
command="$(find xacro)/xacro $(find arm)/urdf/arm.urdf.xacro mass:=$(arg m) length:=$(arg l)"/></launch>"""

PATH = "os.path.join(get_package_share_directory('arm'), 'urdf', 'arm.urdf.xacro')"
FILLED = "given = {}\ngiven |= {'mass': m, 'length': n}\n"
CONDITION = """<launch><arg name="heavy" default="false"/><param if="$(arg heavy)" name="robot_description"
command="$(find xacro)/xacro $(find arm)/urdf/arm.urdf.xacro mass:=2 length:=1"/><param unless="$(arg heavy)"
name="robot_description" command="$(find xacro)/xacro $(find arm)/urdf/arm.urdf.xacro"/></launch>"""

INNER = """<launch><arg name="mass"/><arg name="length"/><param name="robot_description"
command="$(find xacro)/xacro $(find arm)/urdf/arm.urdf.xacro mass:=$(arg mass) length:=$(arg length)"/></launch>"""
OUTER = """<launch><include file="$(find arm)/launch/arm.launch"><arg name="mass" value="{0}"/><arg name="length" value="{0}"/>
</include></launch>"""
DECLARED = "".join(
    f"DeclareLaunchArgument(\n  '{name}',\n  default_value=TextSubstitution(text='{{0}}'))\n"
    for name in ("mass", "length")
)
CONFIGURED = (
    f"Command(['xacro ', {XACRO}, ' mass:=', LaunchConfiguration('mass'), ' length:=', LaunchConfiguration('length')])"
)


def find(folder: Path, launches: dict[str, str], *, largest: str = "1e-6", **settings: object) -> Run:
    files = {"package.xml": PACKAGE, "urdf/arm.urdf.xacro": ARM.format(largest), **launches}
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")
    return check(folder / "urdf/arm.urdf.xacro", codes={"INR002", "INR003", "GEO001"}, **settings)


def list_codes(run: Run) -> list[str]:
    return sorted(finding.code for finding in run.findings)


def test_they_are_not_listed_and_the_run_says_so(tmp_path: Path) -> None:
    run = find(tmp_path, {"launch/arm.launch.py": COMPUTED}, unrequested=frozenset({"INR002", "GEO001"}))
    assert list_codes(run) == []
    assert sorted(note.code for note in run.unrequested) == ["GEO001", "INR002"]
    (skip,) = (skip for skip in run.skipped if skip.code == SkippedCheck.DEFAULTS)
    assert skip.is_partial
    assert "the defaults of length, mass; arm.launch.py passes other values" in skip.reason


@pytest.mark.parametrize(
    "launches",
    [
        {},
        {"launch/arm.launch.py": COMPUTED, "launch/view.launch.py": f"Command(['xacro ', {XACRO}])"},
        {"launch/arm.launch.py": f"Command(['xacro ', {XACRO}, ' mass:=0 length:=0.0'])"},
        {"launch/arm.launch.py": f"Command(['xacro ', {XACRO}, ' colour:=', colour])"},
        {"launch/arm.launch.py": f"# xacro arm.urdf.xacro mass:=1 length:=2\nCommand(['xacro ', {XACRO}])"},
        {"launch/arm.launch.py": f"Command(['xacro ', {XACRO}, ' mass:=false length:=false'])"},
        {"launch/arm.launch": OWN_DEFAULTS},
        {"launch/arm.launch.py": f"Command(['xacro ', {XACRO}])\nNode(parameters=[{{'mass': 3.0, 'length': 1.0}}])"},
        {"launch/arm.launch.py": f"{COMPUTED}\nCommand(['xacro ', {XACRO}, ' colour:=', colour])"},
        {"launch/arm.launch.py": f"{COMPUTED}\nxacro.process_file({PATH}, mappings={{'colour': colour}})"},
        {"launch/arm.launch.py": f"{COMPUTED}\nxacro.process_file({PATH})"},
        {"launch/arm.launch": CONDITION},
    ],
    ids=[
        *("no launch file", "one leaves them", "the same numbers", "another argument", "in a comment", "false for 0"),
        *(
            "own arguments",
            "to a node",
            "one command leaves them",
            "another in a call",
            "none in a call",
            "by a condition",
        ),
    ],
)
def test_defaults_that_a_start_may_leave_are_reported(tmp_path: Path, launches: dict[str, str]) -> None:
    run = find(tmp_path, launches, unrequested=frozenset({"INR002", "GEO001"}))
    assert list_codes(run) == ["GEO001", "INR002"]


@pytest.mark.parametrize(
    "launches",
    [
        {"launch/arm.launch.py": f"Command(['xacro ', {XACRO}, ' ', *more])\n# \n'mass:= length:='"},
        {"launch/arm.launch.py": f"{FILLED}xacro.process_file({PATH}, mappings=given)"},
        {"launch/arm.launch": CONDITION.replace('"false"', '"true"')},
    ],
    ids=["unknown words", "filled later", "where a plain launch passes them"],
)
def test_what_may_pass_them_does(tmp_path: Path, launches: dict[str, str]) -> None:
    assert list_codes(find(tmp_path, launches, unrequested=frozenset({"INR002", "GEO001"}))) == []


def test_what_is_typed_in_the_model_is_still_reported(tmp_path: Path) -> None:
    run = find(tmp_path, {"launch/arm.launch.py": COMPUTED}, largest="1", unrequested=frozenset({"INR002", "GEO001"}))
    (finding,) = run.findings
    assert (finding.code, list_argument_names(finding)) == ("INR003", [])


def test_another_known_number_is_not_the_default_either(tmp_path: Path) -> None:
    passed = {"launch/arm.launch.py": f"Command(['xacro ', {XACRO}, ' mass:=0.2 length:=0.3'])"}
    assert list_codes(find(tmp_path, passed, unrequested=frozenset({"INR002", "GEO001"}))) == []


def test_a_given_argument_is_no_default(tmp_path: Path) -> None:
    run = find(tmp_path, {"launch/arm.launch.py": COMPUTED}, arguments={"mass": "0"}, unrequested=frozenset({"INR002"}))
    assert "INR002" in list_codes(run)


@pytest.mark.parametrize(
    ("passed", "codes"),
    [(" length:=', str(values['l'])", ["INR002", "INR015"]), (" length:=1 mass:=', str(values['m'])", [])],
    ids=["a size", "a mass"],
)
def test_what_the_masses_of_the_whole_lead_to_is_not_of_a_size(tmp_path: Path, passed: str, codes: list[str]) -> None:
    launches = {"launch/arm.launch.py": f"Command(['xacro ', {XACRO}, '{passed}])"}
    # Where nothing weighs the robot, its mass is an info anyway.
    find(tmp_path, {**launches, "launch/gazebo.launch.py": "Node(package='gazebo_ros', executable='spawn_entity.py')"})
    text = (tmp_path / "urdf/arm.urdf.xacro").read_text(encoding="utf-8")
    heavy = text.replace("</robot>", f'<link name="b">{HEAVY}</link></robot>')
    (tmp_path / "urdf/arm.urdf.xacro").write_text(heavy, encoding="utf-8")
    every = {"INR002", "INR015", "GEO001"}
    run = check(tmp_path / "urdf/arm.urdf.xacro", codes=every, unrequested=frozenset(every))
    assert list_codes(run) == codes


def test_a_severity_that_is_given_stays(tmp_path: Path) -> None:
    launches = {"launch/arm.launch.py": COMPUTED}
    run = find(tmp_path, launches, unrequested=frozenset({"INR002", "GEO001"}), severities={"INR002": "error"})
    assert list_codes(run) == ["INR002"]


@pytest.mark.parametrize(("number", "is_listed"), [("0.0", True), ("0.4", False)])
@pytest.mark.parametrize(
    "launches",
    [
        {"launch/arm.launch": INNER, "launch/all.launch": OUTER},
        {"launch/arm.launch.py": DECLARED + CONFIGURED},
    ],
    ids=["an outer file passes it", "a computed text is the default"],
)
def test_a_number_that_comes_from_elsewhere_may_be_the_default(
    tmp_path: Path, launches: dict[str, str], number: str, is_listed: bool
) -> None:
    filled = {name: text.replace("{0}", number) for name, text in launches.items()}
    run = find(tmp_path, filled, unrequested=frozenset({"INR002", "GEO001"}))
    assert list_codes(run) == ["GEO001", "INR002"] * is_listed


@pytest.mark.parametrize(("given", "is_listed"), [("", True), (" mass:=$M length:=0.4", False)])
def test_a_command_in_the_readme_is_a_start_too(tmp_path: Path, given: str, is_listed: bool) -> None:
    files = {"launch/arm.launch.py": COMPUTED, "README.md": f"    xacro urdf/arm.urdf.xacro{given} > arm.urdf\n"}
    run = find(tmp_path, files, unrequested=frozenset({"INR002", "GEO001"}))
    assert list_codes(run) == ["GEO001", "INR002"] * is_listed


def test_the_html_report_shows_what_the_defaults_alone_would_cause(tmp_path: Path) -> None:
    run = find(tmp_path, {"launch/arm.launch.py": COMPUTED}, unrequested=frozenset({"INR002", "GEO001"}))
    shown = list_refusing_notes(run)
    assert sorted(finding.code for finding in shown.findings) == ["GEO001", "INR002"]


TOOL = """<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:arg name="prefix" default=""/>
<link name="base"/><link name="$(arg prefix)base"/>
<joint name="mount" type="fixed"><parent link="base"/><child link="$(arg prefix)base"/></joint>
<link name="tool"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="{}"/></inertial></link>
<joint name="j" type="fixed"><parent link="base"/><child link="tool"/></joint></robot>"""
PREFIXED = f"Command(['xacro ', {XACRO}, ' prefix:=', 'left_'])"


def find_in_tool(folder: Path, launches: dict[str, str], *, largest: str = "1") -> Run:
    files = {"package.xml": PACKAGE, "urdf/arm.urdf.xacro": TOOL.format(largest), **launches}
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")
    codes = {"KIN001", "KIN006", "INR003"}
    return check(folder / "urdf/arm.urdf.xacro", codes=codes, unrequested=frozenset({"KIN006", "INR003"}))


def test_what_a_model_lacks_as_it_is_started_is_not_listed(tmp_path: Path) -> None:
    run = find_in_tool(tmp_path, {"launch/a.launch.py": PREFIXED}, largest="9")
    assert list_codes(run) == ["INR003", "KIN001"], "the tensor is impossible however it is started"
    assert {f.code: f.message_id for f in run.findings}["KIN001"] == "default"
    (line,) = [skip for skip in run.skipped if skip.code == SkippedCheck.DEFAULTS]
    assert line.reason == (
        "what comes from the default of prefix; a.launch.py passes another value: check with these, --arg prefix:=left_"
    )


@pytest.mark.parametrize(
    "other",
    [
        {"launch/b.launch.py": f"Command(['xacro ', {XACRO}])"},
        {"launch/b.launch.py": f"Command(['xacro ', {XACRO}, ' prefix:=', ''])"},
        {"README.md": "    xacro urdf/arm.urdf.xacro > arm.urdf"},
        # The value is another program's, or is given in another command of the same file.
        {"launch/b.launch.py": f"Command(['xacro ', {XACRO}]); Node(parameters=[{{'prefix': 'left_'}}])"},
        {"launch/b.launch.py": f"{PREFIXED}; Command(['xacro ', {XACRO}])"},
        # Of so many starts, not all are tried.
        {f"launch/{i}.launch.py": PREFIXED.replace("left_", f"arm{i}_") for i in range(6)},
    ],
)
def test_it_is_listed_where_one_start_leaves_the_defaults(tmp_path: Path, other: dict[str, str]) -> None:
    run = find_in_tool(tmp_path, {"launch/a.launch.py": PREFIXED, **other})
    assert "KIN006" in list_codes(run)


def test_a_launch_file_may_hand_the_value_to_another(tmp_path: Path) -> None:
    handed = "launch_arguments={'description_file': 'arm.urdf.xacro', 'prefix': 'left_'}.items()"
    run = find_in_tool(tmp_path, {"launch/a.launch.py": PREFIXED, "launch/b.launch.py": handed})
    assert list_codes(run) == ["KIN001"]


def test_it_is_listed_where_the_same_rule_finds_something_else_as_it_is_started(tmp_path: Path) -> None:
    """By default the tag without a prefix is under a condition that is not met; each start lacks the arm."""
    arm = """<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:arg name="with_arm" default="false"/>
<link name="base"/><xacro:macro name="arm" params="n"><link name="${n}"/></xacro:macro>
<xacro:if value="$(arg with_arm)"><arm n="x"/></xacro:if></robot>"""
    launch = f"Command(['xacro ', {XACRO}, ' with_arm:=', 'true'])"
    for name, text in {"package.xml": PACKAGE, "urdf/arm.urdf.xacro": arm, "launch/a.launch.py": launch}.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text, encoding="utf-8")
    run = check(tmp_path / "urdf/arm.urdf.xacro", codes={"XAC007"}, unrequested=frozenset({"XAC007"}))
    assert list_codes(run) == ["XAC007"]
