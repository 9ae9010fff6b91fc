"""What an SRDF and its joint_limits.yaml say of a robot."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import pytest
from builders import find, joint, limit, link, robot
from conftest import check

from urdfcheck.core import Finding, Severity

CONTROL = '<ros2_control name="c" type="system"><joint name="elbow"><command_interface name="position"/></joint></ros2_control>'


def hinge(
    name: str, parent: str, child: str, limit: str = 'lower="-1.5" upper="2" velocity="2"', more: str = ""
) -> str:
    return (
        f'<joint name="{name}" type="revolute"><parent link="{parent}"/><child link="{child}"/><axis xyz="0 1 0"/>'
        f'<limit {limit} effort="1"/>{more}</joint>'
    )


ARM = (
    '<link name="base"/><link name="upper"/><link name="fore"/><link name="tool"/>'
    + hinge("shoulder", "base", "upper")
    + hinge("elbow", "upper", "fore")
    + '<joint name="mount" type="fixed"><parent link="fore"/><child link="tool"/></joint>'
)
GROUP = '<group name="arm"><chain base_link="base" tip_link="tool"/></group>'


def find_with_srdf(folder: Path, srdf: str, code: str = "SRD001", arm: str = ARM, limits: str = "") -> list[Finding]:
    """Return the findings on an arm with a semantic description, and with a ``joint_limits.yaml`` where ``limits`` has text."""
    (folder / ".git").mkdir(parents=True, exist_ok=True)  # no other test's package is in its workspace
    files = {"arm.urdf": robot(arm, name="arm"), "arm.srdf": robot(srdf, name="arm")}
    return find(folder, files | ({"joint_limits.yaml": limits} if limits else {}), code, name="arm.urdf")


def ids(findings: Iterable[Finding]) -> list[str]:
    return [f.message_id for f in findings]


@pytest.mark.parametrize(
    ("groups", "joint", "expected"),
    [
        ("", "world_joint", {"joint": Severity.INFO, "no-groups": Severity.INFO}),
        ("", "elbw", {"joint": Severity.ERROR, "no-groups": Severity.INFO}),
        (GROUP, "world_joint", {"joint": Severity.ERROR, "group": Severity.ERROR}),
    ],
)
def test_states_without_any_group_are_for_pinocchio(
    tmp_path: Path, groups: str, joint: str, expected: dict[str, Severity]
) -> None:
    values = "".join(f'<joint name="{name}" value="0"/>' for name in ("shoulder", joint))
    found = find_with_srdf(tmp_path, f'{groups}<group_state name="home" group="legs">{values}</group_state>')
    assert {f.message_id: f.severity for f in found} == expected


@pytest.mark.parametrize(
    ("depends", "severity"), [("moveit_ros_move_group", Severity.ERROR), ("pinocchio", Severity.WARNING)]
)
def test_groups_are_for_moveit(tmp_path: Path, depends: str, severity: Severity) -> None:
    manifest = f'<package format="3"><name>arm</name><depend>{depends}</depend></package>'
    (tmp_path / "package.xml").write_text(manifest)
    (finding,) = find_with_srdf(tmp_path, f'{GROUP}<group_state name="home" group="legs"/>')
    assert (finding.message_id, finding.severity) == ("group", severity)


XACRO = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
# A robot whose hand an argument chooses: the name of its joint is nowhere as it is.
WITH_HAND = (
    '<xacro:arg name="hand" default=""/><xacro:property name="hand" value="$(arg hand)"/>'
    '<xacro:unless value="${hand == \'\'}"><xacro:include filename="${hand}.xml"/></xacro:unless>'
)
HAND = f'<robot {XACRO}><link name="finger"/>' + hinge("grip", "tool", "finger") + "</robot>"
OF_HAND = '<group name="hand"><joint name="grip"/></group>'


@pytest.mark.parametrize(
    ("setting", "builder", "reported"),
    [
        ("", ".to_moveit_configs()", ["joint"]),
        ("hand:=two_fingers", ".to_moveit_configs()", []),
        ("--inorder hand:=two_fingers", ".to_moveit_configs()", []),
        ("hand:=three_fingers", ".to_moveit_configs()", []),  # it is not here
        ("hand:=other", ".to_moveit_configs()", ["joint"]),
        ("", '.robot_description(mappings={"hand": "two_fingers"})', []),
        ("", '.robot_description("config/arm.urdf.xacro", {"hand": "two_fingers"})', []),
        ("", '.robot_description(mappings={"hand": ""})', ["joint"]),
    ],
)
def test_names_that_the_robot_has_with_the_arguments_of_moveit_are_known(
    tmp_path: Path, setting: str, builder: str, reported: list[str]
) -> None:
    settings = (
        "moveit_setup_assistant_config:\n  urdf:\n    package: arm_description\n    relative_path: urdf/arm.xacro\n"
        f"    xacro_args: {setting}\n  srdf:\n    relative_path: config/arm.srdf\n"
    )
    files = {
        "arm_moveit_config/package.xml": "<package><name>arm_moveit_config</name></package>",
        "arm_moveit_config/.setup_assistant": settings,
        "arm_moveit_config/config/arm.srdf": robot(GROUP + OF_HAND, name="arm"),
        "arm_moveit_config/config/arm.urdf.xacro": f'<robot name="arm" {XACRO}>{ARM}{WITH_HAND}</robot>',
        "arm_moveit_config/config/two_fingers.xml": HAND,
        "arm_moveit_config/config/other.xml": f"<robot {XACRO}/>",
        "arm_moveit_config/launch/move_group.launch.py": f'config = MoveItConfigsBuilder("arm"){builder}\n',
    }
    found = find(tmp_path, files, "SRD001", name="arm_moveit_config/config/arm.urdf.xacro")
    assert ids(found) == reported


# -- names -------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("line", "subject"),
    [
        ('<group name="g"><link name="tol"/></group>', "group[g]/link[tol]@name"),
        ('<group name="g"><joint name="elbw"/></group>', "group[g]/joint[elbw]@name"),
        ('<group name="g"><chain base_link="bas" tip_link="fore"/></group>', "group[g]/chain@base_link"),
        ('<end_effector name="e" parent_link="tol" group="arm"/>', "end_effector[e]@parent_link"),
        ('<passive_joint name="elbw"/>', "passive_joint[elbw]@name"),
        ('<virtual_joint name="v" type="fixed" parent_frame="world" child_link="bse"/>', "virtual_joint[v]@child_link"),
        (
            '<group_state name="s" group="arm"><joint name="elbw" value="0"/></group_state>',
            "group_state[s]/joint[elbw]@name",
        ),
        ('<group_state name="s" group="rm"/>', "group_state[s]@group"),
        ('<end_effector name="e" parent_link="fore" group="am"/>', "end_effector[e]@group"),
        ('<group name="g"><group name="amr"/></group>', "group[g]/group[amr]@name"),
    ],
)
def test_each_name_is_looked_up(tmp_path: Path, line: str, subject: str) -> None:
    (finding,) = find_with_srdf(tmp_path, GROUP.replace("tool", "upper") + line)
    assert (finding.location.subject, finding.severity) == (subject, Severity.ERROR)
    if finding.message_id != "group":
        assert "did you mean" in finding.message
        assert finding.fix is not None
        assert finding.fix.edits


def test_a_name_that_the_group_has_already_is_not_meant(tmp_path: Path) -> None:
    (finding,) = find_with_srdf(tmp_path, GROUP + '<group name="g"><joint name="elbow"/><joint name="elbw"/></group>')
    assert "elbow" not in finding.message
    assert finding.fix is not None
    assert finding.fix.edits == ()


def test_virtual_joints_are_joints(tmp_path: Path) -> None:
    srdf = '<virtual_joint name="v" type="planar" parent_frame="map" child_link="base"/><group name="g"><joint name="v"/></group>'
    state = '<group_state name="s" group="g"><joint name="v" value="0 0 0"/></group_state>'
    assert not find_with_srdf(tmp_path, srdf + state)


def test_one_name_is_one_finding(tmp_path: Path) -> None:
    state = '<group_state name="{}" group="arm"><joint name="elbw" value="0"/><joint name="shoulder" value="0"/></group_state>'
    (finding,) = find_with_srdf(tmp_path, GROUP + state.format("a") + state.format("b"))
    assert len(finding.related) == 1


def test_names_are_trimmed_as_by_moveit(tmp_path: Path) -> None:
    assert not find_with_srdf(tmp_path, GROUP.replace('"base"', '" base "'))


def test_a_name_of_another_variant_is_known(tmp_path: Path) -> None:
    (tmp_path / "wide.urdf").write_text('<robot name="arm"><link name="gripper_base"/></robot>')
    grip = '<group name="grip"><link name="gripper_base"/></group>'
    assert not find_with_srdf(tmp_path, GROUP + grip)
    (tmp_path / "wide.urdf").unlink()
    assert ids(find_with_srdf(tmp_path, GROUP + grip)) == ["link"]


def test_a_description_of_another_robot_of_this_name_is_not_compared(tmp_path: Path) -> None:
    fingers = "".join(f'<group name="g{n}"><link name="finger_{n}"/></group>' for n in range(9))
    assert not find_with_srdf(tmp_path, GROUP + fingers)


def workspace(folder: Path, depends: str, model: str = "") -> list[str]:
    """A description, and a MoveIt configuration that names one link of a gripper and misspells a joint."""
    source = folder / "workspace" / "src"  # too deep to be in the workspace of another test
    for package, needs in (("arm_description", ""), ("arm_moveit_config", depends)):
        (source / package / "config").mkdir(parents=True)
        (source / package / "package.xml").write_text(f'<package format="3"><name>{package}</name>{needs}</package>')
    (source / "arm_description" / "arm.urdf").write_text(f'<robot name="arm">{ARM}</robot>')
    gripper = '<group name="grip"><link name="robotiq_85_base"/></group>'
    srdf = f'<robot name="arm">{GROUP}{gripper}<passive_joint name="shouldr"/></robot>'
    (source / "arm_moveit_config" / "config" / "arm.srdf").write_text(srdf)
    if model:
        (source / "arm_moveit_config" / "config" / model).write_text('<robot name="arm"/>')
    return ids(check(source / "arm_description" / "arm.urdf", codes={"SRD001"}).findings)


def test_a_configuration_that_depends_on_the_description_is_its_own(tmp_path: Path) -> None:
    assert workspace(tmp_path, "<depend>arm_description</depend>") == ["link", "joint"]


def test_of_a_configuration_with_a_model_of_its_own_only_misspelt_names_count(tmp_path: Path) -> None:
    assert workspace(tmp_path, "<depend>arm_description</depend>", model="arm.urdf.xacro") == ["joint"]


def test_a_configuration_beside_the_description_may_be_for_another_robot(tmp_path: Path) -> None:
    assert workspace(tmp_path, "") == []


def write_setup(config: Path, model: str, *, is_moveit_2: bool = False) -> None:
    """Note in a MoveIt configuration that it was made for a model, PACKAGE/PATH."""
    urdf, srdf = ("urdf", "srdf") if is_moveit_2 else ("URDF", "SRDF")
    (config / ".setup_assistant").write_text(
        f"moveit_setup_assistant_config:\n  {srdf}:\n    relative_path: config/arm.srdf\n"
        f"  {urdf}:\n    package: {model.partition('/')[0]}\n    relative_path: {model.partition('/')[2]}\n"
    )


def two_robots_of_one_name(folder: Path, setup: str = "", beside: str = "") -> dict[str, list[str]]:
    """A robot, and a MoveIt configuration for two of them under the same name, which names a group that does not exist."""
    source = folder / "workspace" / "src"
    for package, needs in (("arm_description", ""), ("dual_moveit_config", "<depend>arm_description</depend>")):
        (source / package / "config").mkdir(parents=True)
        (source / package / "package.xml").write_text(f'<package format="3"><name>{package}</name>{needs}</package>')
    links = "".join(f'<link name="{side}_{n}"/>' for side in ("left", "right") for n in ("base", "tool"))
    fixed = '<joint name="{0}_{1}" type="fixed"><parent link="{0}"/><child link="{1}"/></joint>'
    ends = (("left_base", "left_tool"), ("left_base", "right_base"), ("right_base", "right_tool"))
    dual = f'<robot name="arm">{links}{"".join(fixed.format(*pair) for pair in ends)}</robot>'
    chains = "".join(
        f'<group name="{s}"><chain base_link="{s}_base" tip_link="{s}_tool"/></group>' for s in ("left", "right")
    )
    (source / "arm_description" / "arm.urdf").write_text(f'<robot name="arm">{ARM}</robot>')
    config = source / "dual_moveit_config"
    (config / "config" / "arm.srdf").write_text(
        f'<robot name="arm">{chains}<group_state name="s" group="both"/></robot>'
    )
    if beside:
        (source / beside).write_text(dual)
    if setup:
        write_setup(config, setup)
    run = check(source, codes={"SRD001"})
    return {Path(m.path).parent.name: ids(f for f in run.findings if f.model == m.id) for m in run.models}


def test_a_description_is_told_of_the_robot_beside_it_and_not_of_another_of_its_name(tmp_path: Path) -> None:
    beside = "dual_moveit_config/config/dual.urdf"
    assert two_robots_of_one_name(tmp_path, beside=beside) == {"arm_description": [], "config": ["group"]}


def test_a_description_is_told_of_the_robot_that_it_was_set_up_for(tmp_path: Path) -> None:
    found = two_robots_of_one_name(tmp_path, setup="dual_description/urdf/dual.urdf.xacro")
    assert found == {"arm_description": []}
    found = two_robots_of_one_name(tmp_path / "other", setup="arm_description/arm.urdf")
    assert found == {"arm_description": ["group"]}


def test_a_description_is_told_of_the_robot_of_the_package_that_it_fits(tmp_path: Path) -> None:
    found = two_robots_of_one_name(tmp_path, beside="arm_description/config/dual.urdf")
    assert found == {"arm_description": [], "config": ["group"]}


# -- groups ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("pairs", "path"),
    [(["ab", "ba"], "a → b → a"), (["aa"], "a → a"), (["ab", "bc", "cb"], "b → c → b"), (["ab", "ac", "bc"], None)],
)
def test_groups_in_a_circle(tmp_path: Path, pairs: list[str], path: str | None) -> None:
    inside = {name: [p[1] for p in pairs if p[0] == name] for name in "abc"}
    groups = "".join(
        f'<group name="{name}"><joint name="elbow"/>{"".join(f"<group name={chr(34)}{i}{chr(34)}/>" for i in inner)}</group>'
        for name, inner in inside.items()
    )
    findings = find_with_srdf(tmp_path, groups)
    assert [f.data["path"] for f in findings] == ([] if path is None else [path])


@pytest.mark.parametrize(
    ("base", "tip", "message"),
    [
        ("tool", "base", "chain-reversed"),
        ("base", "base", "chain-empty"),
        ("base", "fore", None),
        ("upper", "fore", None),
    ],
)
def test_a_chain_leads_down(tmp_path: Path, base: str, tip: str, message: str | None) -> None:
    findings = find_with_srdf(tmp_path, f'<group name="g"><chain base_link="{base}" tip_link="{tip}"/></group>')
    assert ids(findings) == ([] if message is None else [message])
    if message == "chain-reversed":
        assert findings[0].fix is not None
        assert [e.replacement for e in findings[0].fix.edits] == ["base", "tool"]


@pytest.mark.parametrize(("kind", "reported"), [("floating", True), ("planar", True), ("fixed", False)])
def test_a_virtual_joint_moves_the_root(tmp_path: Path, kind: str, reported: bool) -> None:
    joint = f'<virtual_joint name="v" type="{kind}" parent_frame="odom" child_link="upper"/>'
    assert ids(find_with_srdf(tmp_path, GROUP + joint)) == (["virtual-not-root"] if reported else [])


@pytest.mark.parametrize(
    ("frame", "kind", "repair", "effect"),
    [
        ("odom", "fixed", 'write child_link="base", or delete', "does not move in the world"),
        ("odom", "revolute", "if the robot is to move by slide; otherwise write", "cart moves by slide only"),
        ("base", "revolute", "delete the virtual joint, and its name in groups", "cart moves by slide only"),
    ],
)
def test_a_virtual_joint_is_needless_where_the_robot_has_joints_that_move_it(
    tmp_path: Path, frame: str, kind: str, repair: str, effect: str
) -> None:
    cart = link("base") + link("cart") + joint("slide", "base", "cart", limit(-1, 1), kind=kind)
    srdf = f'<virtual_joint name="v" type="planar" parent_frame="{frame}" child_link="cart"/>'
    (finding,) = find_with_srdf(tmp_path, srdf, arm=cart)
    assert finding.fix is not None
    assert repair in finding.fix.title
    assert bool(finding.fix.edits) == (kind == "fixed")
    assert effect in finding.consequences["moveit"]


@pytest.mark.parametrize(
    ("group", "reported"),
    [
        ('<chain base_link="base" tip_link="upper"/>', True),
        ('<chain base_link="base" tip_link="fore"/>', False),
        ('<link name="fore"/>', False),
        ('<joint name="elbow"/>', False),
        ('<group name="arm"/>', False),
    ],
)
def test_a_state_is_of_its_group(tmp_path: Path, group: str, reported: bool) -> None:
    state = '<group_state name="s" group="g"><joint name="elbow" value="0"/></group_state>'
    findings = find_with_srdf(tmp_path, f'{GROUP}<group name="g">{group}</group>{state}')
    assert ids(findings) == (["state-foreign"] if reported else [])


@pytest.mark.parametrize("group", ["h", "g"])
def test_a_state_of_a_group_with_an_unknown_part_may_be_of_that_part(tmp_path: Path, group: str) -> None:
    groups = (
        '<group name="h"><chain base_link="base" tip_link="gone"/></group><group name="g"><group name="h"/></group>'
    )
    state = f'<group_state name="s" group="{group}"><joint name="elbow" value="0"/></group_state>'
    assert ids(find_with_srdf(tmp_path, f"{GROUP}{groups}{state}")) == ["link"]


# -- states ------------------------------------------------------------------------------------------------------------


def state(**values: object) -> str:
    joints = "".join(f'<joint name="{name}" value="{value}"/>' for name, value in values.items())
    return f'{GROUP}<group_state name="s" group="arm">{joints}</group_state>'


@pytest.mark.parametrize(
    ("value", "reported"),
    [
        (2, False),
        (2.0001, False),
        (2.0002, True),
        (-1.5, False),
        (-1.6, True),
        ("2 3", False),
        ("nan", False),
        ("", False),
    ],
)
def test_a_state_is_within_the_limits(tmp_path: Path, value: object, reported: bool) -> None:
    assert ids(find_with_srdf(tmp_path, state(elbow=value), "SRD002")) == (["outside"] if reported else [])


def test_soft_limits_narrow(tmp_path: Path) -> None:
    soft = '<safety_controller soft_lower_limit="-1" soft_upper_limit="1" k_velocity="1"/>'
    arm = ARM.replace(hinge("elbow", "upper", "fore"), hinge("elbow", "upper", "fore", more=soft))
    (finding,) = find_with_srdf(tmp_path, state(elbow=1.2), "SRD002", arm)
    assert "safety_controller" in finding.message


@pytest.mark.parametrize(("limit", "reported"), [(1.0, True), (1.5, False)])
def test_joint_limits_replace_those_of_the_model(tmp_path: Path, limit: float, reported: bool) -> None:
    limits = f"joint_limits: {{elbow: {{max_position: {limit}}}}}"
    assert bool(find_with_srdf(tmp_path, state(elbow=1.2), "SRD002", limits=limits)) == reported


def test_a_state_in_degrees_is_one_finding(tmp_path: Path) -> None:
    (finding,) = find_with_srdf(tmp_path, state(elbow=90, shoulder=-45), "SRD002")
    assert finding.message_id == "degrees"
    assert finding.fix is not None
    assert [e.replacement for e in finding.fix.edits] == ["1.5708", "-0.7854"]


def test_a_turn_too_much_is_not_degrees(tmp_path: Path) -> None:
    (finding,) = find_with_srdf(tmp_path, state(elbow=6.29183), "SRD002")
    assert finding.message_id == "outside"


def test_a_follower_goes_where_its_leader_says(tmp_path: Path) -> None:
    arm = ARM.replace(
        hinge("elbow", "upper", "fore"), hinge("elbow", "upper", "fore", more='<mimic joint="shoulder"/>')
    )
    assert not find_with_srdf(tmp_path, state(elbow=9), "SRD002", arm)


@pytest.mark.parametrize(
    ("name", "value", "messages"),
    [
        ("root_joint", "0 0 1 0 0 0 1", []),
        ("root_joint", "0", ["joint"]),
        ("root_link", "0 0 1 0 0 0 1", ["joint-of-base"]),
        ("root_link", "0", ["joint"]),
    ],
)
def test_a_state_may_give_the_pose_of_the_base(tmp_path: Path, name: str, value: str, messages: list[str]) -> None:
    joints = f'<joint name="{name}" value="{value}"/><joint name="elbow" value="0"/>'
    state = f'<group_state name="s" group="arm">{joints}</group_state>'
    assert ids(find_with_srdf(tmp_path, GROUP + state)) == messages


def test_the_repair_of_a_velocity_is_no_integer(tmp_path: Path) -> None:
    (finding,) = find_with_srdf(tmp_path, GROUP, "SRD003", limits="joint_limits:\n  elbow: {max_velocity: 9.0}\n")
    assert finding.fix is not None
    assert finding.fix.title == "write at most 2.0, or correct the model"


# -- joint_limits.yaml -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("entry", "messages"),
    [
        ("max_velocity: 2.0", []),
        ("max_velocity: 2.02", []),
        ("max_velocity: 2.03", ["velocity"]),
        ("max_velocity: 9.0, has_velocity_limits: false", []),
        ("max_velocity: 0.0", ["zero"]),
        ("max_velocity: 0.0, has_velocity_limits: no", []),
        ("max_position: 2.03", []),
        ("max_position: 2.04", ["position"]),
        ("min_position: -2.0, max_position: 1.0", ["position"]),
        ("min_position: 1.0, max_position: -1.0", ["inverted"]),
        ("max_velocity: fast", []),
        ("max_velocity: [1]", []),
    ],
)
def test_joint_limits_are_not_looser_than_the_model(tmp_path: Path, entry: str, messages: list[str]) -> None:
    limits = f"default_velocity_scaling_factor: 0.1\njoint_limits:\n  elbow: {{{entry}}}\n"
    assert ids(find_with_srdf(tmp_path, GROUP, "SRD003", limits=limits)) == messages


@pytest.mark.parametrize(("model", "is_moveit_2"), [("", False), ("arm.urdf", False), ("bare.urdf.xacro", True)])
def test_joint_limits_are_those_of_the_model_that_they_were_set_up_for(
    tmp_path: Path, model: str, is_moveit_2: bool
) -> None:
    """Another file of this robot may have other limits, and so less than MoveIt plans with; one that includes that file is it."""
    source = tmp_path / "workspace" / "src"  # too deep to be in the workspace of another test
    config, description = source / "arm_moveit_config", source / "arm_description"
    for folder, needs in ((description, ""), (config, "<depend>arm_description</depend>")):
        (folder / "config").mkdir(parents=True)
        (folder / "package.xml").write_text(f'<package format="3"><name>{folder.name}</name>{needs}</package>')
    (config / "config" / "arm.srdf").write_text(robot(GROUP, name="arm"))
    (config / "config" / "joint_limits.yaml").write_text("joint_limits: {elbow: {max_velocity: 3.0}}")
    (description / "arm.urdf").write_text(robot(ARM, name="arm"))
    (description / "bare.urdf.xacro").write_text(robot(ARM, name="arm", xacro=True))
    around = robot('<xacro:include filename="bare.urdf.xacro"/>', name="arm", xacro=True)
    (description / "scene.urdf.xacro").write_text(around)
    if model:
        write_setup(config, f"arm_description/{model}", is_moveit_2=is_moveit_2)
    names = ("arm.urdf", "bare.urdf.xacro", "scene.urdf.xacro")
    found = {name for name in names if check(description / name, codes={"SRD003"}).findings}
    assert found == {"": set(names), "arm.urdf": {"arm.urdf"}, "bare.urdf.xacro": set(names[1:])}[model]


@pytest.mark.parametrize(
    ("build_type", "flag", "messages"),
    [
        ("ament_cmake", "", []),
        ("ament_cmake", ", has_velocity_limits: true", ["velocity"]),
        ("catkin", "", ["velocity"]),
    ],
)
def test_moveit_2_reads_a_velocity_only_beside_its_flag(
    tmp_path: Path, build_type: str, flag: str, messages: list[str]
) -> None:
    (tmp_path / "package.xml").write_text(
        f"<package><name>arm</name><buildtool_depend>{build_type}</buildtool_depend></package>"
    )
    limits = f"joint_limits:\n  elbow: {{max_velocity: 9.0{flag}}}\n"
    assert ids(find_with_srdf(tmp_path, GROUP, "SRD003", limits=limits)) == messages


@pytest.mark.parametrize(
    "limits",
    [
        "robot_description_planning:\n  joint_limits:\n    elbw: {max_velocity: 1.0}\n    shoulder: {max_velocity: 1.0}\n",
        "/**:\n  ros__parameters:\n    robot_description_planning:\n"
        "      joint_limits:\n        elbw: {max_velocity: 1.0}\n        shoulder: {max_velocity: 1.0}\n",
    ],
)
def test_joint_limits_name_joints(tmp_path: Path, limits: str) -> None:
    (finding,) = find_with_srdf(tmp_path, GROUP, "SRD003", limits=limits)
    assert finding.message_id == "unknown"
    assert finding.fix is not None
    assert [e.replacement for e in finding.fix.edits] == ["elbow"]


@pytest.mark.parametrize(
    "limits",
    [
        "joint_limits: {a: {max_velocity: 1.0}, elbow: 3}",
        "elbow: {limit: {lower: 1}}",
        "[1, 2]",
        # MoveIt looks below robot_description_planning.
        "/**:\n  ros__parameters:\n    joint_limits:\n      elbow: {has_velocity_limits: true, max_velocity: 9.0}\n",
    ],
)
def test_other_files_of_this_name_are_left_alone(tmp_path: Path, limits: str) -> None:
    assert not find_with_srdf(tmp_path, GROUP, "SRD003", limits=limits)


def test_a_continuous_joint_takes_no_position_limit(tmp_path: Path) -> None:
    arm = ARM.replace('name="elbow" type="revolute"', 'name="elbow" type="continuous"')
    limits = "joint_limits: {elbow: {max_position: 1.0}}"
    assert ids(find_with_srdf(tmp_path, GROUP, "SRD003", arm, limits)) == ["continuous"]


@pytest.mark.parametrize("kind", ["revolute", "continuous"])
def test_a_copy_in_which_a_joint_lost_its_range_is_to_blame(tmp_path: Path, kind: str) -> None:
    """MoveIt's Setup Assistant writes a copy of the model for Gazebo beside the limits."""
    turning = ARM.replace('name="elbow" type="revolute"', 'name="elbow" type="continuous"')
    files = {
        "package.xml": "<package><name>arm</name></package>",
        "urdf/arm.urdf": robot(ARM if kind == "revolute" else turning, name="arm"),
        "config/gazebo_arm.urdf": robot(turning, name="arm"),
        "config/arm.srdf": robot(GROUP, name="arm"),
        "config/joint_limits.yaml": "joint_limits: {elbow: {max_position: 1.0}}",
    }
    (tmp_path / "arm").mkdir()
    write_setup(tmp_path / "arm", "arm/urdf/arm.urdf")
    (finding,) = find(tmp_path / "arm", files, "SRD003", name="config/gazebo_arm.urdf")
    assert finding.message_id == ("continuous-copy" if kind == "revolute" else "continuous")
    assert finding.location.span is not None
    file = finding.location.span.file
    assert Path(file).name == ("gazebo_arm.urdf" if kind == "revolute" else "joint_limits.yaml")


def test_ros_2_reads_no_limits_of_joints_that_the_robot_lacks(tmp_path: Path) -> None:
    tool = "<buildtool_depend>ament_cmake</buildtool_depend>"
    (tmp_path / "package.xml").write_text(f"<package><name>arm</name>{tool}</package>")
    limits = "joint_limits:\n  claw: {max_velocity: 1, has_velocity_limits: true}\n"
    assert not find_with_srdf(tmp_path, GROUP, "SRD003", limits=limits)


@pytest.mark.parametrize(
    ("tool", "flag", "reported"),
    [
        ("ament_cmake", "true", True),
        ("catkin", "true", False),
        ("ament_cmake", "false", False),  # then MoveIt does not read the number beside it
    ],
)
def test_ros_2_reads_no_integers(tmp_path: Path, tool: str, flag: str, reported: bool) -> None:
    (tmp_path / "package.xml").write_text(
        f"<package><name>arm</name><buildtool_depend>{tool}</buildtool_depend></package>"
    )
    limits = (
        f"joint_limits:\n  elbow: {{max_velocity: 1, has_velocity_limits: {flag}, max_acceleration: 0}}\n"
        "  shoulder: {max_velocity: 1.0, has_velocity_limits: true}\n"
    )
    findings = find_with_srdf(tmp_path, GROUP, "SRD003", limits=limits)
    assert ids(findings) == (["integer"] if reported else [])
    if reported:
        assert findings[0].severity == Severity.ERROR
        assert findings[0].fix is not None
        assert [e.replacement for e in findings[0].fix.edits] == ["1.0"]


def test_broken_joint_limits_are_an_error_at_their_line(tmp_path: Path) -> None:
    (finding,) = find_with_srdf(tmp_path, GROUP, "SRD003", limits="joint_limits:\n  elbow: [1\n")
    assert (finding.message_id, finding.severity) == ("broken", Severity.ERROR)


# -- passive joints ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("srdf", "arm", "message"),
    [
        ('<passive_joint name="elbow"/>', ARM + CONTROL, "interface"),
        ('<passive_joint name="shoulder"/>', ARM + CONTROL, None),
        ('<passive_joint name="elbow"/>', ARM + CONTROL.replace("command", "state"), None),
    ],
)
def test_a_passive_joint_takes_no_commands(tmp_path: Path, srdf: str, arm: str, message: str | None) -> None:
    assert ids(find_with_srdf(tmp_path, srdf, "SRD004", arm)) == ([] if message is None else [message])


def test_a_passive_joint_is_in_no_controller(tmp_path: Path) -> None:
    tmp_path.joinpath("moveit_controllers.yaml").write_text(
        "moveit_simple_controller_manager:\n  c: {type: FollowJointTrajectory, joints: [shoulder, elbow]}\n"
    )
    (finding,) = find_with_srdf(tmp_path, '<passive_joint name="elbow"/>', "SRD004")
    assert finding.message_id == "controller"
    assert finding.related[0].subject == "yaml[moveit_simple_controller_manager.c.joints[1]]"
