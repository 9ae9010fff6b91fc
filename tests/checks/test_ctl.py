"""Control blocks, and the controller configurations that belong to a robot."""

from __future__ import annotations

from pathlib import Path

import pytest
from builders import robot
from conftest import check, check_text

from urdfcheck.core import Finding, Severity


def axle(side: str, y: float) -> str:
    ends = f'<parent link="base"/><child link="{side}"/>'
    return (
        f'<link name="{side}"/><joint name="{side}_wheel" type="continuous">'
        f'<origin xyz="0 {y} 0"/>{ends}<axis xyz="0 1 0"/></joint>'
    )


AXLES = '<link name="base"/>' + axle("left", 0.1) + axle("right", -0.1)
PLUGIN = """<gazebo><plugin filename="libgz_ros2_control-system.so" name="p">
<parameters>{}</parameters></plugin></gazebo>"""
NAMED = PLUGIN.format("$(find cart)/config/c.yaml")


def control(left: str = "velocity", right: str = "velocity") -> str:
    joints = "".join(
        f'<joint name="{side}_wheel"><command_interface name="{kind}"/></joint>'
        for side, kind in (("left", left), ("right", right))
        if kind
    )
    return f'<ros2_control name="drive" type="system">{joints}</ros2_control>'


def make_cart(body: str = "", axles: str = AXLES) -> str:
    return robot(axles, body, name="cart", xacro=True)


def package(folder: Path, files: dict[str, str], name: str = "cart", depends: str = "") -> Path:
    manifest = f'<package format="3"><name>{name}</name>{depends}</package>'
    for path, text in {"package.xml": manifest, **files}.items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_text(text)
    return folder


def find_in_cart(folder: Path, yaml: str, body: str = "", code: str = "CTL004", **files: str) -> list[Finding]:
    model = {"urdf/cart.urdf.xacro": make_cart(body), "config/c.yaml": yaml}
    run = check(package(folder / "cart", {**model, **files}), codes={code})
    assert not run.failures
    return list(run.findings)


def group(*joints: str, name: str = "wheels_controller") -> str:
    return (
        f"controller_manager: {{ros__parameters: {{{name}: {{type: velocity_controllers/JointGroupVelocityController}}}}}}\n"
        f"{name}: {{ros__parameters: {{joints: [{', '.join(joints)}]}}}}\n"
    )


def drive(radius: object = 0.05, separation: object = 0.2, left: str = "left_wheel", right: str = "right_wheel") -> str:
    return (
        "drive:\n  type: diff_drive_controller/DiffDriveController\n"
        f"  left_wheel: {left}\n  right_wheel: {right}\n"
        f"  wheel_radius: {radius}\n  wheel_separation: {separation}\n"
    )


# -- names -------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "yaml",
    [
        group("left_wheel", "rigth_wheel"),
        "/**/wheels_controller:\n  ros__parameters:\n    joints:\n    - left_wheel\n    - 'rigth_wheel'\n",
        "cart:\n  a_controller:\n    ros__parameters: {left_wheel_names: [left_wheel], right_wheel_names: [rigth_wheel]}\n",
        "cart: {wheels: {type: velocity_controllers/JointGroupVelocityController, joints: [left_wheel, rigth_wheel]}}\n",
        "left: {type: effort_controllers/JointEffortController, joint: left_wheel}\n"
        "right: {type: effort_controllers/JointEffortController, joint: rigth_wheel}\n",
        "controller_list:\n- {name: c, type: FollowJointTrajectory, joints: [left_wheel, rigth_wheel]}\n",
        "moveit_simple_controller_manager:\n  controller_names: [c]\n"
        "  c: {type: FollowJointTrajectory, joints: [left_wheel, rigth_wheel]}\n",
    ],
)
def test_a_misspelt_joint_is_found_in_every_form(tmp_path: Path, yaml: str) -> None:
    (finding,) = find_in_cart(tmp_path, yaml)
    assert (finding.message_id, finding.severity) == ("unknown", Severity.ERROR)
    assert "did you mean 'right_wheel'?" in finding.message
    span = finding.location.span
    assert span is not None
    assert yaml[span.start : span.end] == "rigth_wheel"
    assert finding.fix is not None
    assert [(e.expected, e.replacement) for e in finding.fix.edits] == [("rigth_wheel", "right_wheel")]


LISTED = "controller_list:\n- {name: c, type: FollowJointTrajectory, joints: [%s]}\n"


@pytest.mark.parametrize(
    ("yaml", "message", "severity", "readers"),
    [
        (LISTED % "left_wheel, right_wheel, v_joint", "extra", Severity.INFO, {"moveit"}),
        (LISTED % "left_wheel, v_joint", "extra", Severity.INFO, {"moveit"}),
        (LISTED % "left_wheel, right_wheel, tool", "extra", Severity.INFO, {"moveit"}),
        (LISTED % "left_wheel, tool", "unknown", Severity.WARNING, {"moveit"}),
        (LISTED % "left_wheel, rigth_wheel", "unknown", Severity.ERROR, {"moveit"}),
        (
            LISTED % "left_wheel, rigth_wheel" + "d: {type: a/B, joints: [left_wheel, right_wheel]}\n",
            *("unknown", Severity.ERROR, {"moveit"}),
        ),
        (
            LISTED % "left_wheel, rigth_wheel" + "d: {type: a/B, joints: [left_wheel, rigth_wheel]}\n",
            *("unknown", Severity.ERROR, {"moveit", "ros_control", "gazebo"}),
        ),
        ("d: {type: a/B, joints: [left_wheel, tool]}\n", "unknown", Severity.ERROR, {"ros_control", "gazebo"}),
        (group("left_wheel", "v_joint"), "unknown", Severity.ERROR, {"ros2_control", "gazebo"}),
    ],
)
def test_the_effect_of_an_unknown_joint_is_that_of_what_reads_the_controller(
    tmp_path: Path, yaml: str, message: str, severity: Severity, readers: set[str]
) -> None:
    srdf = (
        '<robot name="cart"><virtual_joint name="v_joint" type="fixed" parent_frame="world" child_link="base"/></robot>'
    )
    (finding,) = find_in_cart(tmp_path, yaml, **{"config/cart.srdf": srdf})
    assert (finding.message_id, finding.severity) == (message, severity)
    assert set(finding.consequences) == readers
    assert ("executes no motion of right_wheel" in finding.consequences.get("moveit", "")) == (
        message == "unknown" and "moveit" in readers
    )


def test_moveit_moves_a_virtual_joint_that_is_not_fixed(tmp_path: Path) -> None:
    srdf = (
        '<robot name="cart"><virtual_joint name="v_joint" type="planar" parent_frame="odom" child_link="base"/></robot>'
    )
    assert not find_in_cart(tmp_path, LISTED % "left_wheel, right_wheel, v_joint", **{"config/cart.srdf": srdf})


@pytest.mark.parametrize(
    "yaml",
    [
        group("left_wheel", "$(var prefix)right_wheel"),
        group("left_wheel", "<robot_namespace>right_wheel"),
        group("left_wheel", "pid/right_wheel"),
        "a_node: {ros__parameters: {joints: [left_wheel, rigth_wheel]}}\n",
        "left_wheel: {type: revolute, joint: rigth_wheel}\n",
        "shoulder: [1, 2]\n",
        "",
        "- left_wheel\n",
        "joints: [left_wheel\n",
        "a: &a {joints: *a}\n",
        "<<: 3\n",
    ],
    ids=[
        "prefix",
        "placeholder",
        "chained",
        "another node",
        "no controller",
        "no names",
        "empty",
        "list",
        "no yaml",
        "circle",
        "merge",
    ],
)
def test_what_is_no_list_of_joints_is_left_alone(tmp_path: Path, yaml: str) -> None:
    assert not find_in_cart(tmp_path, yaml)


def test_one_name_in_several_controllers_is_one_finding(tmp_path: Path) -> None:
    (finding,) = find_in_cart(tmp_path, group("left_wheel", "rigth_wheel") + drive(right="rigth_wheel"))
    assert len(finding.related) == 1
    assert finding.fix is not None
    assert len(finding.fix.edits) == 2


def test_a_file_of_another_robot_is_nothing_to_this_one(tmp_path: Path) -> None:
    assert not find_in_cart(tmp_path, group("left_wheel", "shoulder", "elbow"))


def test_a_controller_of_a_tool_is_not_of_the_robot(tmp_path: Path) -> None:
    assert not find_in_cart(tmp_path, group("left_wheel", "right_wheel") + group("finger", name="grip_controller"))


def test_a_joint_of_another_robot_of_the_package_is_known(tmp_path: Path) -> None:
    other = make_cart(axles=AXLES.replace("right_wheel", "third_wheel"))
    assert find_in_cart(tmp_path / "a", group("left_wheel", "third_wheel"))
    assert not find_in_cart(tmp_path / "b", group("left_wheel", "third_wheel"), **{"urdf/other.urdf": other})


@pytest.mark.parametrize(("name", "reported"), [("left_wheel_j", False), ("rigt_wheel_j", True)])
def test_a_macro_makes_names_of_words_that_are_there(tmp_path: Path, name: str, reported: bool) -> None:
    """The macro is called for `right` here and could be called for `left`, a word of the files; `rigt` is none."""
    macro = (
        '<xacro:macro name="w" params="side"><link name="${side}"/><joint name="${side}_wheel_j" type="continuous">'
        '<parent link="base"/><child link="${side}"/><axis xyz="0 1 0"/></joint></xacro:macro>'
        '<link name="base"/><xacro:w side="right"/><xacro:if value="false"><xacro:w side="left"/></xacro:if>'
    )
    files = {"urdf/cart.urdf.xacro": make_cart(axles=macro), "config/c.yaml": group("right_wheel_j", name)}
    run = check(package(tmp_path, files), codes={"CTL004"})
    assert bool(run.findings) == reported


def test_the_file_that_the_robot_names_has_nothing_of_it(tmp_path: Path) -> None:
    (finding,) = find_in_cart(tmp_path, group("shoulder", "elbow"), NAMED)
    assert (finding.message_id, finding.severity) == ("none", Severity.ERROR)
    assert finding.location.subject == "yaml[wheels_controller]"


@pytest.mark.parametrize(("launched", "severity"), [(False, Severity.WARNING), (True, Severity.ERROR)])
def test_a_file_that_fits_another_robot_is_right_for_that_one(
    tmp_path: Path, launched: bool, severity: Severity
) -> None:
    arm = '<ros2_control name="arm" type="system"><joint name="shoulder"/><joint name="elbow"/></ros2_control>'
    files = {"urdf/arm.xacro": robot(arm, xacro=True), "urdf/old.xacro": robot('<joint name="elbow"/>', xacro=True)}
    files["launch/a.launch.py"] = "'cart.urdf.xacro'" if launched else ""
    yaml = group("shoulder", "elbow") + group("shoulder", name="shoulder_controller")
    (finding,) = find_in_cart(tmp_path, yaml, NAMED, **files)
    assert (finding.message_id, finding.severity) == ("fits-another", severity)
    assert finding.location.subject.endswith("/parameters")
    assert "urdf/arm.xacro (shoulder, elbow)" in finding.message


@pytest.mark.parametrize(("interfaces", "message"), [("", "ignored"), ("interfaces: [position], ", "unknown")])
def test_a_broadcaster_without_interfaces_ignores_its_joints(tmp_path: Path, interfaces: str, message: str) -> None:
    yaml = (
        "controller_manager: {ros__parameters: {states: {type: joint_state_broadcaster/JointStateBroadcaster}}}\n"
        f"states: {{ros__parameters: {{{interfaces}joints: [left_wheel, rigth_wheel]}}}}\n"
    )
    (finding,) = find_in_cart(tmp_path, yaml, NAMED)
    severity = Severity.INFO if message == "ignored" else Severity.ERROR
    assert (finding.message_id, finding.severity) == (message, severity)


def test_a_prefix_that_an_argument_gives_is_no_other_robot(tmp_path: Path) -> None:
    prefixed = AXLES.replace('name="left_wheel"', 'name="$(arg p)left_wheel"')
    files = {"urdf/cart.urdf.xacro": make_cart('<xacro:arg name="p" default="a_"/>' + prefixed + NAMED, axles="")}
    files["config/c.yaml"] = group("b_left_wheel")
    assert not check(package(tmp_path / "cart", files), codes={"CTL004"}).findings


# -- which file belongs to the robot -----------------------------------------------------------------------------------


def test_a_launch_file_names_a_file_of_another_package(tmp_path: Path) -> None:
    package(tmp_path / "cart", {"urdf/cart.urdf": make_cart()})
    launch = (
        '<launch><param name="robot_description" textfile="$(find cart)/urdf/cart.urdf"/>'
        '<rosparam command="load" file="$(find bringup)/config/c.yaml"/></launch>'
    )
    files = {"config/c.yaml": group("left_wheel", "rigth_wheel"), "launch/c.launch": launch}
    package(tmp_path / "bringup", files, "bringup")
    (finding,) = check(tmp_path, codes={"CTL004"}).findings
    assert finding.location.span is not None
    assert finding.location.span.file.endswith("bringup/config/c.yaml")


@pytest.mark.parametrize(
    ("models", "reported"),
    [
        ([], True),
        (["cart.urdf"], True),
        (["cart_new.urdf"], False),
        (["cart_new.urdf", "cart.urdf"], True),
        (["$(arg robot).urdf"], True),
        (["cart_new.urdf --> <!-- cart.urdf"], False),
    ],
)
def test_controllers_that_are_loaded_with_another_model_are_not_this_one_s(
    tmp_path: Path, models: list[str], reported: bool
) -> None:
    files = {"urdf/cart.urdf": make_cart(), "config/c.yaml": group("left_wheel", "rigth_wheel")}
    for n, model in enumerate(models):
        files[f"launch/{n}.launch"] = f"""<launch><rosparam command="load" file="$(find cart)/config/c.yaml"/>
          <!-- {model} --><param name="robot_description" textfile="$(find cart)/urdf/{model.partition(" ")[0]}"/></launch>"""
    root = package(tmp_path / "cart", files)
    assert bool(check(root / "urdf" / "cart.urdf", codes={"CTL004"}).findings) == reported


@pytest.mark.parametrize(("models", "reported"), [("cart_{n}wheels.urdf", False), ("cart.urdf", True)])
def test_controllers_of_a_variant_are_loaded_with_its_model(tmp_path: Path, models: str, reported: bool) -> None:
    launch = f"""def load(n):\n    return f'urdf/{models}', f'config/controllers_{{n}}wheels.yaml'\n"""
    files = {
        "urdf/cart.urdf": make_cart(),
        "config/controllers_3wheels.yaml": group("left_wheel", "rear_wheel"),
        "launch/a.launch.py": launch,
    }
    root = package(tmp_path / "cart", files)
    assert bool(check(root / "urdf" / "cart.urdf", codes={"CTL004"}).findings) == reported


@pytest.mark.parametrize(
    ("body", "launch", "severity"),
    [
        (NAMED, "", Severity.INFO),
        ("", "", Severity.ERROR),  # the robot does not say which file it has
        (NAMED, "config/old.yaml", Severity.ERROR),
        (NAMED, "config/$(arg which)d.yaml", Severity.ERROR),
        (NAMED, "config/c.yaml", Severity.INFO),
        (NAMED, "$(find cart_moveit_config)/demo.launch", Severity.ERROR),  # MoveIt finds its files itself
    ],
)
def test_a_file_that_nothing_loads_stops_no_controller(
    tmp_path: Path, body: str, launch: str, severity: Severity
) -> None:
    files = {
        "config/old.yaml": group("left_wheel", "rigth_wheel"),
        "launch/a.launch": f"<launch><!-- {launch} --></launch>",
    }
    (finding,) = find_in_cart(tmp_path, group("left_wheel", "right_wheel"), body, **files)
    assert finding.severity is severity
    assert ("delete the file if nothing loads it" in (finding.fix.title if finding.fix else "")) == (
        severity is Severity.INFO
    )
    assert bool(finding.consequences) == (severity is Severity.ERROR)


def test_two_unknown_names_do_not_mean_one_joint(tmp_path: Path) -> None:
    lift = '<link name="fork"/><joint name="lift" type="continuous"><parent link="base"/><child link="fork"/></joint>'
    found = find_in_cart(tmp_path, group("left_wheel", "lift", "rihgt_wheel", "right_weel"), lift)
    assert [(f.message.count("did you mean"), f.fix and f.fix.edits) for f in found] == [(0, ()), (0, ())]


@pytest.mark.parametrize(
    ("depends", "launch", "reported"),
    [
        ("<exec_depend>cart</exec_depend>", 'FindPackageShare("cart"), "c.yaml"', True),
        ("<exec_depend>cart</exec_depend>", 'FindPackageShare("cart"), "d.yaml"', False),
        ("<exec_depend>cart</exec_depend>", 'FindPackageShare("other"), "c.yaml"', False),
        ("", 'FindPackageShare("cart"), "c.yaml"', False),
    ],
)
def test_a_package_that_brings_the_robot_up_has_its_controllers(
    tmp_path: Path, depends: str, launch: str, reported: bool
) -> None:
    source = tmp_path / "workspace" / "src"  # too deep to be in the workspace of another test
    package(source / "cart", {"urdf/cart.urdf": make_cart()})
    files = {"config/c.yaml": group("left_wheel", "rigth_wheel"), "launch/up.launch.py": launch}
    package(source / "bringup", files, "bringup", depends)
    assert bool(check(source / "cart" / "urdf" / "cart.urdf", codes={"CTL004"}).findings) == reported


def test_a_launch_file_with_an_argument_in_the_path_says_nothing(tmp_path: Path) -> None:
    launch = (
        '<launch><arg name="kind" default="c"/><param name="robot_description" textfile="$(find cart)/urdf/cart.urdf.xacro"/>'
        '<rosparam command="load" file="$(find cart)/other/$(arg kind).yaml"/></launch>'
    )
    assert not find_in_cart(
        tmp_path, "", **{"launch/c.launch": launch, "other/c.yaml": group("left_wheel", "rigth_wheel")}
    )


def test_a_file_that_the_robot_names_is_there(tmp_path: Path) -> None:
    (finding,) = find_in_cart(tmp_path, "", PLUGIN.format("$(find cart)/config/d.yaml"))
    assert (finding.message_id, finding.severity) == ("missing", Severity.ERROR)
    assert "no controller manager starts" in finding.consequences["gazebo"]


def test_a_plain_urdf_may_get_its_path_as_typed(tmp_path: Path) -> None:
    body = PLUGIN.format("$(find cart)/c.yaml")
    (finding,) = find_in_cart(tmp_path / "a", "", body)
    assert finding.fix is not None
    assert finding.fix.title.endswith("/a/cart/config/c.yaml has this name), or add the file")
    launch = "from launch.substitutions import Command\nCommand(['xacro ', 'cart.urdf'])\n"
    for name, files, is_bare in (("b", {}, True), ("c", {"launch/cart.launch.py": launch}, False)):
        folder = package(tmp_path / name, {"urdf/cart.urdf": make_cart(body), **files})
        (finding,) = check(folder, codes={"CTL004"}).findings
        assert ("as it is typed" in finding.message) is is_bare


def test_a_file_that_the_robot_names_is_yaml(tmp_path: Path) -> None:
    (finding,) = find_in_cart(tmp_path, "a:\n\tb: 1\n", NAMED)
    assert finding.message_id == "broken"
    assert finding.location.span is not None
    assert (finding.location.span.line, finding.location.span.col) == (2, 1)


def test_a_path_of_the_authors_machine_is_found_in_the_package(tmp_path: Path) -> None:
    yaml = group("left_wheel", "rigth_wheel")
    findings = find_in_cart(tmp_path, yaml, PLUGIN.format("/home/me/ws/src/cart/config/c.yaml"))
    assert sorted((f.message_id, str(f.severity)) for f in findings) == [("machine", "warning"), ("unknown", "error")]
    machine = next(f.fix for f in findings if f.message_id == "machine")
    assert machine is not None
    assert machine.title.endswith("write $(find cart)/config/c.yaml")


@pytest.mark.parametrize(
    ("path", "written"),
    [
        ("/home/me/ws/install/arm_bringup/share/arm_bringup/config/c.yaml", "$(find arm_bringup)/config/c.yaml"),
        (
            "/home/me/src/cart/setup/c.yaml",
            "$(find cart)/setup/c.yaml; cart has no setup/c.yaml here, so add that file too",
        ),
        ("/home/me/c.yaml", "$(find package)/config/…"),
        ("/opt/ros/humble/share/arm_bringup/config/c.yaml", None),
    ],
)
def test_a_path_of_another_machine_names_its_package(tmp_path: Path, path: str, written: str | None) -> None:
    findings = find_in_cart(tmp_path, "", PLUGIN.format(path))
    fixes = [f.fix for f in findings if f.message_id == "machine"]
    assert [fix.title for fix in fixes if fix is not None] == ([] if written is None else [f"write {written}"])


def test_a_folder_is_no_package_to_which_a_path_of_another_machine_leads(tmp_path: Path) -> None:
    body = PLUGIN.format("/home/me/ws/src/arm_moveit/config/c.yaml")
    (tmp_path / "config").mkdir()
    package(tmp_path / "arm_moveit", {"config/c.yaml": group("left_wheel")}, name="arm_moveit")
    run = check(package(tmp_path / "cart", {"urdf/cart.urdf": make_cart(body)}), codes={"CTL004"})
    (machine,) = [f.fix for f in run.findings if f.message_id == "machine"]
    assert machine is not None
    assert machine.title == "make the model a xacro and write $(find arm_moveit)/config/c.yaml"


def test_a_path_of_the_projects_container_is_a_note(tmp_path: Path) -> None:
    body = PLUGIN.format("/ws/install/cart/share/cart/config/c.yaml")
    for workdir, severity in (("/ws", "info"), ("/other/ws", "warning"), ("/ws2", "warning")):
        files = {"urdf/cart.urdf": make_cart(body), "config/c.yaml": group("left_wheel")}
        folder = package(tmp_path / workdir.strip("/") / "cart", {**files, "docker/Dockerfile": f"WORKDIR {workdir}\n"})
        run = check(folder, codes={"CTL004"})
        assert [(f.message_id, str(f.severity)) for f in run.findings] == [("machine", severity)]


def test_a_package_inside_another_is_installed_by_that(tmp_path: Path) -> None:
    body = PLUGIN.format("/home/me/ws/install/outer/share/outer/models/cart/config/c.yaml")
    files = {"urdf/cart.urdf": make_cart(body), "config/c.yaml": group("left_wheel")}
    package(tmp_path / "outer" / "models" / "cart", files)
    run = check(package(tmp_path / "outer", {}, name="outer"), codes={"CTL004"})
    (machine,) = [f.fix for f in run.findings if f.message_id == "machine"]
    assert machine is not None
    assert machine.title == "make the model a xacro and write $(find outer)/models/cart/config/c.yaml"


def test_a_size_that_another_robot_reads_too_is_not_edited(tmp_path: Path) -> None:
    yaml = (
        "controller_manager:\n  ros__parameters:\n    drive:\n      type: diff_drive_controller/DiffDriveController\n"
        "drive:\n  ros__parameters:\n    left_wheel_names: [left_wheel]\n    right_wheel_names: [right_wheel]\n"
        "    wheel_separation: 0.9\n"
    )
    include = '<xacro:include filename="control.xacro"/>'
    plugin = robot(PLUGIN.format("$(find cart)/config/c.yaml"), xacro=True)
    files = {"urdf/cart.urdf.xacro": make_cart(include), "urdf/control.xacro": plugin, "config/c.yaml": yaml}
    other = {"urdf/large.urdf.xacro": robot(AXLES, include, xacro=True)}
    for more in ({}, other):
        folder = package(tmp_path / str(len(more)) / "cart", files | more)
        run = check(folder / "urdf/cart.urdf.xacro", codes={"CTL004"})
        (fix,) = [f.fix for f in run.findings if f.message_id == "separation"]
        assert fix is not None
        assert bool(fix.edits) != bool(more)
        assert fix.title.endswith("give each robot its own file") == bool(more)


def test_the_output_of_xacro_has_a_source_to_be_expanded(tmp_path: Path) -> None:
    body = PLUGIN.format("/home/me/ws/src/cart/config/c.yaml")
    for made_by, first in (("hand", "make the model a xacro"), ("autogenerated by xacro", "expand the xacro")):
        files = {"urdf/cart.urdf": f"<!-- {made_by} -->{make_cart(body)}", "config/c.yaml": group("left_wheel")}
        run = check(package(tmp_path / made_by / "cart", files), codes={"CTL004"})
        (machine,) = [f.fix for f in run.findings if f.message_id == "machine"]
        assert machine is not None
        assert machine.title.startswith(first)


@pytest.mark.parametrize(("named", "severity"), [(False, "info"), (True, "warning")])
def test_an_output_of_xacro_that_nothing_names_is_a_note(tmp_path: Path, named: bool, severity: str) -> None:
    """The package that starts it declares no dependency."""
    text = f"<!-- autogenerated by xacro -->{make_cart(PLUGIN.format('/home/me/ws/src/cart/config/c.yaml'))}"
    (tmp_path / ".git").mkdir()
    package(tmp_path / "cart", {"urdf/cart.urdf": text, "config/c.yaml": group("left_wheel")})
    launch = "FILE = 'cart.urdf'\n" if named else ""
    package(tmp_path / "bringup", {"launch/start.py": launch}, name="bringup")
    run = check(tmp_path, codes={"CTL004"})
    assert [str(f.severity) for f in run.findings if f.message_id == "machine"] == [severity]


@pytest.mark.parametrize(
    ("source", "first"),
    [
        ("", "add the plugin to cart.urdf.xacro, which has none"),
        ('<xacro:include filename="control.xacro"/>', "expand the xacro"),
        ("{}", "expand the xacro"),
    ],
)
def test_a_source_without_the_plugin_would_lose_it(tmp_path: Path, source: str, first: str) -> None:
    plugin = PLUGIN.format("/home/me/ws/src/cart/config/c.yaml")
    header = "<!-- | This document was autogenerated by xacro from urdf/cart.urdf.xacro | -->"
    files = {
        "urdf/cart.urdf": header + make_cart(plugin),
        "urdf/cart.urdf.xacro": make_cart(source.format(plugin)),
        "config/c.yaml": group("left_wheel"),
    }
    folder = package(tmp_path / "cart", files)
    run = check(folder / "urdf/cart.urdf", codes={"CTL004"}, root=folder)
    (machine,) = [f.fix for f in run.findings if f.message_id == "machine"]
    assert machine is not None
    assert machine.title.startswith(first)


def test_no_file_out_of_reach_is_asked_for(tmp_path: Path) -> None:
    outside = tmp_path / "outside.yaml"
    outside.write_text(group("left_wheel", "rigth_wheel"))
    (finding,) = find_in_cart(tmp_path / "ws", "", PLUGIN.format(outside))
    assert finding.message_id == "machine"


# -- commands ----------------------------------------------------------------------------------------------------------


def test_a_joint_without_command_interface_cannot_be_claimed(tmp_path: Path) -> None:
    (finding,) = find_in_cart(tmp_path, group("left_wheel", "right_wheel"), control(right="") + NAMED)
    assert (finding.message_id, finding.severity) == ("uncommanded", Severity.ERROR)
    assert "right_wheel (velocity)" in finding.message


def test_a_follower_is_not_commanded(tmp_path: Path) -> None:
    cart = make_cart(control(right="") + NAMED).replace(
        '<joint name="right_wheel" type="continuous">',
        '<joint name="right_wheel" type="continuous"><mimic joint="left_wheel"/>',
    )
    files = {"urdf/cart.urdf.xacro": cart, "config/c.yaml": group("left_wheel", "right_wheel")}
    (finding,) = check(package(tmp_path, files), codes={"CTL004"}).findings
    assert finding.fix is not None
    assert finding.fix.title == "remove right_wheel from the controller: it follows another joint by <mimic>"


SWITCH = '<xacro:arg name="sim" default="false"/><xacro:{} value="$(arg sim)">{}</xacro:{}>'


@pytest.mark.parametrize("where", ["here", "included"])
def test_a_block_for_other_arguments_may_have_the_command(tmp_path: Path, where: str) -> None:
    hardware, simulated = SWITCH.format("unless", control(right=""), "unless"), control()
    files = {"urdf/sim.xacro": robot(simulated, name="cart", xacro=True)} if where == "included" else {}
    inner = '<xacro:include filename="sim.xacro"/>' if where == "included" else simulated
    yaml, body = group("left_wheel", "right_wheel"), hardware + SWITCH.format("if", inner, "if") + NAMED
    assert not find_in_cart(tmp_path / "both", yaml, body, **files)
    files = {name: text.replace("right_wheel", "r_wheel") for name, text in files.items()}
    (finding,) = find_in_cart(tmp_path / "neither", yaml, body.replace("right_wheel", "r_wheel"), **files)
    assert finding.message_id == "uncommanded"


def test_a_macro_that_is_called_for_one_wheel_has_no_other(tmp_path: Path) -> None:
    macro = (
        '<xacro:macro name="drive" params="side"><ros2_control name="${side}" type="system">'
        '<joint name="${side}_wheel"><command_interface name="velocity"/></joint></ros2_control></xacro:macro>'
    )
    yaml, one = group("left_wheel", "right_wheel"), macro + '<xacro:drive side="left"/>' + NAMED
    (finding,) = find_in_cart(tmp_path / "one", yaml, one)
    assert finding.message_id == "uncommanded"
    assert not find_in_cart(tmp_path / "both", yaml, one + '<xacro:drive side="right"/>')


def test_another_interface_is_a_warning(tmp_path: Path) -> None:
    (finding,) = find_in_cart(tmp_path, group("left_wheel", "right_wheel"), control(right="position") + NAMED)
    assert (finding.message_id, finding.severity) == ("interface", Severity.WARNING)


@pytest.mark.parametrize(
    "body", [control() + NAMED, NAMED, control(right="")], ids=["offered", "no block", "not named"]
)
def test_commands_are_judged_where_block_and_file_belong_together(tmp_path: Path, body: str) -> None:
    assert not find_in_cart(tmp_path, group("left_wheel", "right_wheel"), body)


def test_the_interfaces_of_a_trajectory_are_those_it_lists(tmp_path: Path) -> None:
    yaml = (
        "controller_manager:\n  ros__parameters:\n    t: {type: joint_trajectory_controller/JointTrajectoryController}\n"
        "t:\n  ros__parameters:\n    joints: [left_wheel, right_wheel]\n    command_interfaces: [velocity, effort]\n"
    )
    findings = find_in_cart(tmp_path, yaml, control() + NAMED)
    assert [f.message_id for f in findings] == ["interface", "interface"]
    assert "the effort of joint left_wheel" in findings[0].message


# -- wheels ------------------------------------------------------------------------------------------------------------

CYLINDER = '<geometry><cylinder radius="0.05" length="0.02"/></geometry>'
ROUND = f'<collision><origin rpy="1.5707963267948966 0 0"/>{CYLINDER}</collision>'
WHEELS = AXLES.replace('<link name="left"/>', f'<link name="left">{ROUND}</link>')


def wheels(folder: Path, yaml: str, axles: str = WHEELS, **files: str) -> list[str]:
    model = {"urdf/cart.urdf": make_cart(axles=axles), "config/c.yaml": yaml}
    run = check(package(folder, {**model, **files}), codes={"CTL004"})
    assert not run.failures
    return [f.message_id for f in run.findings]


@pytest.mark.parametrize(
    ("yaml", "messages"),
    [
        (drive(), []),
        (drive(radius=0.0525), []),
        (drive(radius=0.053), ["radius"]),
        (drive(radius=0.1), ["radius"]),
        (drive(separation=0.189), ["separation"]),
        (drive(separation=0.191), []),
        (drive(separation=0.4), ["separation"]),
        (drive(radius="deg(3)", separation="''"), []),
        (drive(radius=0), []),
    ],
)
def test_the_drive_has_the_wheels_of_the_robot(tmp_path: Path, yaml: str, messages: list[str]) -> None:
    assert wheels(tmp_path, yaml) == messages


def test_a_tyre_may_be_a_link_of_its_own(tmp_path: Path) -> None:
    tyre = f'<link name="tyre">{ROUND}</link><joint name="t" type="fixed"><parent link="left"/><child link="tyre"/></joint>'
    shaft = ROUND.replace('radius="0.05"', 'radius="0.004"')
    axles = AXLES.replace('<link name="left"/>', f'<link name="left">{shaft}</link>') + tyre
    assert wheels(tmp_path, drive(radius=0.05), axles) == []
    assert wheels(tmp_path, drive(radius=0.1), axles) == ["radius"]


def test_a_wheel_of_unknown_shape_has_no_radius(tmp_path: Path) -> None:
    assert wheels(tmp_path, drive(radius=9), AXLES) == []


def test_the_track_of_a_skid_steer_is_tuned(tmp_path: Path) -> None:
    four = WHEELS.replace("</joint>", "</joint>", 1) + WHEELS.replace('name="', 'name="rear_').replace(
        '<link name="rear_base"/>', ""
    ).replace('link="left"', 'link="rear_left"').replace('link="right"', 'link="rear_right"')
    yaml = drive(separation=0.4, left="[left_wheel, rear_left_wheel]", right="[right_wheel, rear_right_wheel]")
    assert wheels(tmp_path, yaml, four) == []


def test_wheels_that_another_robot_has_too_may_be_its_own(tmp_path: Path) -> None:
    other = make_cart(axles=WHEELS.replace("0.1", "0.2"))
    assert wheels(tmp_path, drive(separation=0.4), **{"urdf/other.urdf": other}) == []


# -- nesting -----------------------------------------------------------------------------------------------------------


def nesting(folder: Path, body: str) -> list[tuple[str, str]]:
    run = check_text(folder, make_cart(body), codes={"CTL003"})
    assert not run.failures
    return [(f.message_id, str(f.severity)) for f in run.findings]


CLASSIC = '<gazebo><plugin name="c" filename="libgazebo_ros_control.so"/></gazebo>'


def interface(name: str) -> str:
    return f"<hardwareInterface>{name}</hardwareInterface>"


TYPE = "<type>transmission_interface/SimpleTransmission</type>"


@pytest.mark.parametrize("tag", ["gazebo", "link"])
def test_a_control_block_inside_another_element_is_not_read(tmp_path: Path, tag: str) -> None:
    body = f'<{tag} name="x">{control()}</{tag}>'
    assert nesting(tmp_path, body) == [("ros2_control", "error")]


@pytest.mark.parametrize(
    ("transmission", "message"),
    [
        (f'{TYPE}<joint name="left_wheel"/>', "interface-missing"),
        (
            '<joint name="left_wheel"><hardwareInterface>hardware_interface/EffortJointInterface</hardwareInterface></joint>',
            "type",
        ),
        (
            f'{TYPE}<joint name="left_wheel"><hardwareInterface>EffortJointInterfce</hardwareInterface></joint>',
            "interface-unknown",
        ),
        (
            f'{TYPE}<joint name="left_wheel"/><actuator name="m">{interface("EffortJointInterface")}</actuator>',
            "interface-in-actuator",
        ),
    ],
)
def test_a_transmission_is_complete(tmp_path: Path, transmission: str, message: str) -> None:
    body = f'<transmission name="t">{transmission}</transmission>'
    assert nesting(tmp_path / "a", body + CLASSIC) == [(message, "error")]
    (tmp_path / "b").mkdir()
    (tmp_path / "b" / "load.launch").write_text('<launch><node pkg="controller_manager"/></launch>')
    assert nesting(tmp_path / "b", body) == [(message, "warning")]
    assert nesting(tmp_path / "c", body) == [(message, "info")]


@pytest.mark.parametrize(
    ("second", "repair"),
    [
        ("ab", "delete one of the two: both have joint[a]"),
        ("a", "give each block its own name, and leave joint[a] in one of them only"),
        ("abc", "give each block its own name, and leave joint[a], joint[b] in one of them only"),
        ("c", "give each block its own name, for example with the prefix of its joints"),
    ],
)
def test_of_two_blocks_of_a_name_one_is_deleted_only_if_nothing_is_lost(
    tmp_path: Path, second: str, repair: str
) -> None:
    hardware = "<hardware><plugin>p/C</plugin></hardware>"
    blocks = (
        f'<ros2_control name="arm" type="system">{hardware}{"".join(f"""<joint name="{n}"/>""" for n in names)}</ros2_control>'
        for names in ("ab", second)
    )
    run = check_text(tmp_path, make_cart("".join(blocks)), codes={"CTL005"})
    assert [f.fix.title for f in run.findings if f.message_id == "duplicate" and f.fix is not None] == [repair]


def test_a_second_block_of_the_same_joints_is_deleted(tmp_path: Path) -> None:
    run = check_text(tmp_path, make_cart(f"{control()}<gazebo>{control()}</gazebo>"), codes={"CTL003"})
    (finding,) = run.findings
    assert finding.fix is not None
    assert finding.fix.title.startswith("delete it: ros2_control[")


def test_a_second_block_of_some_of_the_joints_is_moved_without_them(tmp_path: Path) -> None:
    placed = '<transmission name="t"><joint name="a"/></transmission>'
    both = '<transmission name="u"><joint name="a"/><joint name="c"/></transmission>'
    run = check_text(tmp_path, make_cart(f"{placed}<gazebo>{both}</gazebo>"), codes={"CTL003"})
    title = next(f.fix.title for f in run.findings if f.message_id == "transmission" and f.fix is not None)
    assert title.startswith(
        "move it out of gazebo, directly into <robot>, without the joints that transmission[t] has (a)"
    )


def test_a_transmission_beside_ros2_control_needs_no_type(tmp_path: Path) -> None:
    """ROS 2 reads those inside the block only."""
    joint = f'<joint name="left_wheel">{interface("hardware_interface/EffortJointInterface")}</joint>'
    run = check_text(tmp_path, make_cart(f'{control()}<transmission name="t">{joint}</transmission>'), codes={"CTL003"})
    (finding,) = run.findings
    assert (finding.message_id, finding.severity) == ("type", Severity.INFO)
    assert finding.fix is not None
    assert finding.fix.title.startswith("delete it")


@pytest.mark.parametrize("joints", ["left_wheel, right_wheel", "left_wheel right_wheel"])
def test_a_list_of_joints_is_no_name_of_one(tmp_path: Path, joints: str) -> None:
    plugin = (
        '<gazebo><plugin name="d" filename="libgazebo_ros_diff_drive.so">'
        f"<left_joint>{joints}</left_joint><right_joint>right_wheel</right_joint></plugin></gazebo>"
    )
    (finding,) = check_text(tmp_path, make_cart(plugin), codes={"CTL007"}).findings
    assert "these are 2 joints" in finding.message


def test_a_misplaced_transmission_is_no_error_where_nothing_reads_transmissions(tmp_path: Path) -> None:
    body = f'<gazebo><transmission name="t">{TYPE}</transmission></gazebo>'
    assert nesting(tmp_path / "a", body + CLASSIC) == [("transmission", "error")]
    assert nesting(tmp_path / "b", body) == [("transmission", "warning")]


@pytest.mark.parametrize("mark", ["<!-- <", "<!--"])
def test_a_joint_that_is_commented_out_is_meant_and_no_other(tmp_path: Path, mark: str) -> None:
    transmission = (
        '<transmission name="t"><type>t/S</type><joint name="rear_wheel"/><actuator name="m"/></transmission>'
    )
    comment = f'{mark}joint name="rear_wheel" type="continuous"/> -->'
    repairs = []
    for number, body in enumerate((transmission.replace("rear", "rigt"), transmission, transmission + comment)):
        (finding,) = find_in_cart(tmp_path / str(number), "", body, code="CTL001")
        assert finding.fix is not None
        repairs.append((bool(finding.fix.edits), "restore the joint" in finding.fix.title))
    assert repairs[0] == (True, False)
    assert [restored for _, restored in repairs] == [False, False, True]
    assert not repairs[2][0]


def test_the_spelling_of_indigo_is_one_info(tmp_path: Path) -> None:
    spelling = " EffortJointInterface\n"
    one = f'<transmission name="t">{TYPE}<joint name="left_wheel">{interface(spelling)}</joint></transmission>'
    run = check_text(tmp_path, make_cart(one + one.replace("left", "right")), codes={"CTL003"})
    (finding,) = run.findings
    assert (finding.message_id, finding.severity) == ("prefix", Severity.INFO)
    assert finding.fix is not None
    assert [e.replacement for e in finding.fix.edits] == ["hardware_interface/EffortJointInterface"] * 2


@pytest.mark.parametrize(
    "body",
    [
        '<transmission name="t" type="pr2_mechanism_model/SimpleTransmission"><joint name="left_wheel"/></transmission>',
        f'<transmission name="t">{TYPE}<joint name="left_wheel">{interface("own_hw/StateInterface")}</joint></transmission>',
        '<ros2_control name="c"><transmission name="t"><joint name="left_wheel" role="j"/></transmission></ros2_control>',
    ],
    ids=["PR2", "own interface", "ROS 2"],
)
def test_transmissions_of_other_readers_are_left_alone(tmp_path: Path, body: str) -> None:
    assert nesting(tmp_path, body + CLASSIC) == []


@pytest.mark.parametrize(("interface", "message"), [("speed", "device"), ("position", "strange")])
def test_an_entry_without_an_interface_of_a_joint_is_a_device(tmp_path: Path, interface: str, message: str) -> None:
    """Deleting it would stop a fan that the hardware has."""
    fan = f'<joint name="cooler"><command_interface name="{interface}"/><state_interface name="rpm"/></joint>'
    body = control().replace("</ros2_control>", f"{fan}</ros2_control>")
    (finding,) = find_in_cart(tmp_path, "", body, code="CTL001")
    assert finding.message_id == f"ros2_control-{message}"
    assert finding.fix is not None
    assert ("<gpio>" in finding.fix.title) == (message == "device")


def test_a_slip_of_a_joint_is_no_device_whatever_its_interface(tmp_path: Path) -> None:
    """Hardware may call its interface `torque`."""
    entry = '<joint name="right_whel"><command_interface name="torque"/></joint>'
    body = control(right="").replace("</ros2_control>", f"{entry}</ros2_control>")
    (finding,) = find_in_cart(tmp_path, "", body, code="CTL001")
    assert (finding.message_id, finding.severity) == ("ros2_control", Severity.ERROR)


@pytest.mark.parametrize(
    ("joint", "launch", "severity"),
    [
        ("finger", "robot.xacro", Severity.INFO),
        ("finger", "arm.xacro", Severity.ERROR),  # it is loaded alone too
        ("thumb", "robot.xacro", Severity.ERROR),  # no file of the package has it
    ],
)
def test_a_part_may_control_the_joints_of_the_robot_that_includes_it(
    tmp_path: Path, joint: str, launch: str, severity: Severity
) -> None:
    block = control().replace("</ros2_control>", '<joint name="finger"/></ros2_control>')
    hand = '<link name="tip"/><joint name="{}" type="fixed"><parent link="base"/><child link="tip"/></joint>'
    include = '<xacro:include filename="arm.xacro"/>'
    files = {
        "urdf/arm.xacro": make_cart(block),
        "urdf/robot.xacro": robot(include, hand.format(joint), name="whole", xacro=True),
        "launch/a.launch": f'<launch><param name="a" command="xacro $(find cart)/urdf/{launch}"/></launch>',
    }
    root = package(tmp_path / "cart", files)
    (finding,) = check(root / "urdf" / "arm.xacro", codes={"CTL001"}).findings
    assert finding.severity == severity


@pytest.mark.parametrize("with_manifest", [True, False])
def test_names_of_a_file_that_others_include_by_way_of_one_may_be_right_for_them(
    tmp_path: Path, with_manifest: bool
) -> None:
    include = '<xacro:include filename="{}"/>'
    block = control().replace(
        "</ros2_control>", '<joint name="finger"><param name="a">1</param></joint></ros2_control>'
    )
    macro = f'<xacro:macro name="driven" params="">{block}</xacro:macro>'
    files = {
        "control.xacro": robot(macro, xacro=True),
        "arm.xacro": robot(include.format("control.xacro"), "<xacro:driven/>", xacro=True),
        "alone.urdf.xacro": make_cart(include.format("arm.xacro")),
        "with_hand.urdf.xacro": make_cart(include.format("arm.xacro")),
    }
    (tmp_path / "cart" / ".git").mkdir(parents=True)
    root = package(tmp_path / "cart", files)
    if not with_manifest:
        (root / "package.xml").unlink()
    (finding,) = check(root / "alone.urdf.xacro", codes={"CTL001"}).findings
    assert finding.location.span is not None
    assert finding.location.span.file.endswith("alone.urdf.xacro")
    assert finding.fix is not None
    assert finding.fix.title.endswith("they may be right for with_hand.urdf.xacro")


@pytest.mark.parametrize("yaml_name", ["left_wheel_joint", "left_wheel"])
def test_a_name_that_the_controllers_share_is_not_the_odd_one(tmp_path: Path, yaml_name: str) -> None:
    """A joint that was renamed in the robot alone: the edit would take the interface from the controllers."""
    body = control().replace("left_wheel", "left_wheel_joint")
    (finding,) = find_in_cart(tmp_path, group(yaml_name, "right_wheel"), body, code="CTL001")
    assert finding.fix is not None
    is_shared = yaml_name == "left_wheel_joint"
    assert bool(finding.fix.edits) != is_shared
    assert ("c.yaml name" in finding.message) == is_shared
    assert finding.fix.title.startswith("let the names agree" if is_shared else "write a joint of the robot")


@pytest.mark.parametrize(
    ("macro", "call", "repair"),
    [
        ("${name}_wheel", "left_drive", "pass another `name` to the macro, of which `${name}_wheel` makes left_wheel"),
        ("${name}_weel", "left", "write a joint of the robot"),  # the slip is in the macro itself
    ],
)
def test_a_name_that_a_call_gives_is_corrected_in_the_call(tmp_path: Path, macro: str, call: str, repair: str) -> None:
    block = f'<transmission name="${{name}}"><joint name="{macro}"/></transmission>'
    body = f'<xacro:macro name="geared" params="name">{block}</xacro:macro><xacro:geared name="{call}"/>'
    (finding,) = find_in_cart(tmp_path, "", body, code="CTL001")
    assert finding.fix is not None
    assert finding.fix.title.startswith(repair)


@pytest.mark.parametrize(
    ("files", "severity"),
    [
        ({"config/missing.yaml.in": "a: @B@"}, Severity.INFO),
        ({".gitignore": "missing.yaml"}, Severity.INFO),
        ({"config/other.yaml.in": "a: @B@"}, Severity.ERROR),
    ],
)
def test_a_controllers_file_that_a_build_makes_is_no_error(
    tmp_path: Path, files: dict[str, str], severity: Severity
) -> None:
    body = PLUGIN.format("$(find cart)/config/missing.yaml")
    (finding,) = find_in_cart(tmp_path, "", body, **files)
    assert finding.severity is severity


LAUNCHED = """share = get_package_share_directory('cart')
path = render(share)
text = os.popen(f"xacro {share}/urdf/cart.urdf.xacro yaml:={path}").read()
Node(package='ros_gz_sim', executable='create')
"""


@pytest.mark.parametrize(
    ("launches", "severity"),
    [
        ([LAUNCHED], Severity.INFO),
        ([LAUNCHED, LAUNCHED.replace(" yaml:={path}", "").replace("ros_gz_sim", "rviz2")], Severity.INFO),
        ([LAUNCHED, LAUNCHED.replace(" yaml:={path}", "")], Severity.ERROR),  # this one starts Gazebo with the default
        ([], Severity.ERROR),
    ],
)
@pytest.mark.parametrize("typed", ["direct", "macro", "property"])
def test_a_controllers_file_that_launch_files_pass_may_lack_as_a_default(
    tmp_path: Path, launches: list[str], severity: Severity, typed: str
) -> None:
    body = {
        "direct": PLUGIN.format("$(arg yaml)"),
        "macro": '<xacro:macro name="sim" params="file">'
        + PLUGIN.format("${file}")
        + '</xacro:macro><xacro:sim file="$(arg yaml)"/>',
        "property": '<xacro:property name="file" value="$(arg yaml)"/>' + PLUGIN.format("${file}"),
    }[typed]
    declared = '<xacro:arg name="yaml" default="$(find cart)/config/missing.yaml"/>'
    files = {f"launch/{number}.launch.py": text for number, text in enumerate(launches)}
    (finding,) = find_in_cart(tmp_path, "", declared + body, **files)
    assert finding.severity is severity


@pytest.mark.parametrize("names", [("left_weel",), ("arm_roll", "arm_pitch")])
def test_a_transmission_that_is_skipped_does_not_stop_the_plugin(tmp_path: Path, names: tuple[str, ...]) -> None:
    """gazebo_ros_control reads the child ``<type>`` before the joints; the attribute is the PR2's."""
    attribute = ' type="pr2_mechanism_model/SimpleTransmission"'

    def report(kind: str, child: str) -> Finding:
        blocks = [f'<transmission name="t{n}"{kind}>{child}<joint name="{n}"/></transmission>' for n in names]
        text = make_cart("".join(blocks) + CLASSIC)
        (finding,) = check_text(tmp_path, text, codes={"CTL001"}).findings
        return finding

    skipped, read = report(attribute, ""), report("", TYPE)
    assert skipped.consequences["gazebo"] == "skips the transmission before it looks for the joint: it has no <type>"
    assert skipped.severity is Severity.WARNING
    assert skipped.fix is not None
    assert "add a <type> too" in skipped.fix.title
    assert read.consequences["gazebo"].startswith("ignores all transmissions")
    assert read.severity is Severity.ERROR
    assert read.fix is not None
    assert "<type>" not in read.fix.title


@pytest.mark.parametrize(
    ("joints", "entries", "block", "repair"),
    [
        (
            ("Revolute 3",),
            ("Revolute_3",),
            True,
            "let the names agree: rename the joints in the robot and in ros2_control m ('Revo",
        ),
        (("hip_l", "knee_l"), ("HIPL", "KNEEL"), False, "write hip_l, knee_l for HIPL, KNEEL"),
        (("hip_l", "hip-l", "knee_l"), ("HIPL", "KNEEL"), False, "write the joints of this robot"),  # of two hips
    ],
)
def test_a_name_that_differs_in_marks_and_case_only_is_that_of_the_joint(
    tmp_path: Path, joints: tuple[str, ...], entries: tuple[str, ...], block: bool, repair: str
) -> None:
    parts = '<link name="base"/>' + "".join(
        f'<link name="l{n}"/><joint name="{name}" type="continuous"><parent link="base"/><child link="l{n}"/></joint>'
        for n, name in enumerate(joints)
    )
    for name, named in {"d": entries, "m": joints if block else ()}.items():
        parts += f'<ros2_control name="{name}" type="system">{"".join(f"<joint name={one!r}/>" for one in named)}</ros2_control>'
    (finding,) = check_text(tmp_path, robot(parts), codes={"CTL001"}).findings
    assert finding.fix is not None
    assert finding.fix.title.startswith(repair)


def make_interface(name: str, sim: str) -> str:
    plugin = (
        CLASSIC.replace("/></gazebo>", f"><robotSimType>{sim}</robotSimType></plugin></gazebo>") if sim else CLASSIC
    )
    return f'<transmission name="t">{TYPE}<joint name="left_wheel">{interface(name)}</joint></transmission>{plugin}'


@pytest.mark.parametrize(
    ("sim", "name", "message", "severity", "edits"),
    [
        ("", "EffortJointInterfce", "interface-unknown", "error", ["hardware_interface/EffortJointInterface"]),
        (
            *("gazebo_ros_control/DefaultRobotHWSim", "EffortJointInterfce", "interface-unknown", "error"),
            ["hardware_interface/EffortJointInterface"],
        ),
        ("arm_gazebo/ArmHWSim", "hardware_interface/PosVelEffJointInterface", "interface-own", "info", []),
        # What the default class does not take is no repair.
        ("", "hardware_interface/PosVelEffJointInterface", "interface-unknown", "error", []),
    ],
)
def test_the_class_that_simulates_the_hardware_decides_which_interfaces_there_are(
    tmp_path: Path, sim: str, name: str, message: str, severity: str, edits: list[str]
) -> None:
    (finding,) = check_text(tmp_path, make_cart(make_interface(name, sim)), codes={"CTL003"}).findings
    assert (finding.message_id, str(finding.severity)) == (message, severity)
    assert finding.fix is not None
    assert [edit.replacement for edit in finding.fix.edits] == edits
    assert ("ArmHWSim" in finding.message) == (message == "interface-own")
    assert ("No matching" in finding.consequences["gazebo"]) == (message == "interface-unknown")
