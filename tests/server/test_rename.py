"""Renaming in an editor: in all files that know a name, tried before it is offered, refused with a sentence."""

from __future__ import annotations

from pathlib import Path

import pytest
from lsprotocol import types
from pygls.exceptions import JsonRpcException

from urdfcheck.server.names.rename_plan import NOTHING_HERE

from .editor import Editor
from .test_actions import apply
from .test_questions import MACROS as SIMPLE_MACROS

pytestmark = [pytest.mark.slow, pytest.mark.long]

MACROS = SIMPLE_MACROS.replace("length:=0.4", "length:=0.4 *origin").replace(
    "<axis", '<xacro:insert_block name="origin"/>\n      <axis'
)
ROBOT = """<?xml version="1.0"?>
<robot name="two_arms" xmlns:xacro="http://www.ros.org/wiki/xacro"> <!-- 🤖 é -->
  <xacro:arg name="reach" default="0.5"/>
  <xacro:include filename="arm.xacro"/>
  <xacro:property name="mass" value="3"/>
  <material name="blue"><color rgba="0 0 1 1"/></material>
  <link name="base"><visual><geometry><box size="${mass} 1 1"/></geometry><material name="blue"/></visual></link>
  <xacro:arm prefix="left" parent="base" length="$(arg reach)"><origin xyz="0 1 0"/></xacro:arm>
  <xacro:arm prefix="right" parent="left_arm"><origin xyz="0 -1 0"/></xacro:arm>
  <xacro:if value="$(eval reach &gt; 9)"><gazebo reference="base"/></xacro:if>
  <gazebo><plugin name="p" filename="libgazebo_ros_p3d.so"><bodyName>base</bodyName></plugin></gazebo>
</robot>
"""
OTHER = """<robot name="other" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:include filename="arm.xacro"/>
  <link name="base"/>
  <xacro:arm prefix="left" parent="base"><origin/></xacro:arm>
</robot>
"""
SRDF = """<robot name="two_arms">
  <group name="arms"><joint name="left_joint"/><chain base_link="base" tip_link="left_arm"/></group>
  <disable_collisions link1="base" link2="left_arm" reason="Adjacent"/>
</robot>
"""
CONTROLLERS = """arm_controller:
  type: position_controllers/JointTrajectoryController
  joints: [left_joint, right_joint]
  constraints:
    left_joint: {trajectory: 0.1}
  frames: [{base_frame_id: base, odom_frame_id: odom, title: base}]
"""
COSTMAP = """local_costmap:
  ros__parameters: {robot_base_frame: base, global_frame: odom, plugin: base}
"""
LAUNCH = """<launch>
  <param name="robot_description" command="xacro $(find robot)/urdf/two_arms.urdf.xacro reach:=0.6"/>
  <node pkg="tf2_ros" type="static_transform_publisher" name="tf" args="0 0 0 0 0 0 /map /base"/>
  <node pkg="amcl" type="amcl" name="base"><param name="base_frame_id" value="base"/><param name="title" value="base"/></node>
</launch>
"""
PYTHON_LAUNCH = """import os
import xacro
from ament_index_python.packages import get_package_share_directory

def generate_launch_description():
    path = os.path.join(get_package_share_directory("robot"), "urdf", "two_arms.urdf.xacro")
    return xacro.process_file(path, mappings={"reach": "0.7"})
"""
START = """from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue

MODEL = "urdf/two_arms.urdf.xacro"
FRAME = "base"
NAME = "base"
BODY = 'base'

def generate_launch_description():
    \"""Start the base.\"""
    return LaunchDescription([
        DeclareLaunchArgument("frame", default_value="base"),
        Node(package="tf2_ros", executable="static_transform_publisher", name="base",
             arguments=["0", "0", "0", "0", "0", "0", "map", "base"]),
        Node(package="tf2_ros", executable="static_transform_publisher",
             arguments=["--x", "1", "--frame-id", FRAME, "--child-frame-id", "left_arm"]),
        Node(package="tf2_ros", executable="static_transform_publisher", arguments="0 0 0 0 0 0 /base é".split()),
        ExecuteProcess(cmd=["ros2", "run", "tf2_ros", "static_transform_publisher", *[], "--frame-id", 'base',
                            "--child-frame-id", "cam"]),
        Node(package="base", executable="base", parameters=[{
            "robot_base_frame": ParameterValue("base", value_type=str), "frame_id": NAME, "title": "base",
            "costmap": {"frames.base_frame": FRAME, "joints": ["left_joint", "right_joint"], "map_frame": "ba" "se"},
            "tool_frame": LaunchConfiguration("frame"), "frame_name": f"{BODY}", "note": "the base"}]),
        Node(package="gazebo_ros", executable="spawn_entity.py", name=NAME,
             arguments=["-entity", "left_joint", "-J", "left_joint", "0.5"]),
    ])
"""
OTHER_START = """from launch_ros.actions import Node

NODE = Node(package="nav2_amcl", executable="amcl", name="base", parameters=[{"base_frame_id": "base"}])
"""


@pytest.fixture
def files(editor: Editor, project: Path, request: pytest.FixtureRequest) -> dict[str, Path]:
    """The robot and all that names its parts, by the beginning of their names; the first two are open."""
    texts = {
        "urdf/two_arms.urdf.xacro": ROBOT,
        "urdf/arm.xacro": MACROS,
        "urdf/other.urdf.xacro": OTHER,
        "config/two_arms.srdf": SRDF,
        "config/controllers.yaml": CONTROLLERS,
        "launch/show.launch": LAUNCH,
        "launch/show.launch.py": PYTHON_LAUNCH,
        **getattr(request, "param", {}),
    }
    for name, text in texts.items():
        (project / name).parent.mkdir(exist_ok=True)
        (project / name).write_text(text, encoding="utf-8")
        if len(editor.texts) < 2:
            editor.open(project / name)
    return {Path(name).name: project / name for name in texts}


def rename(editor: Editor, path: Path, at: types.Position, name: str) -> dict[str, list[str]]:
    """Rename what is at a position; return the changed lines by file, as they are then."""
    params = types.RenameParams(editor.identify(path), at, name)
    edit = editor.wait(editor.client.text_document_rename_async(params))
    assert edit is not None
    uris = [
        change.text_document.uri for change in edit.document_changes or () if isinstance(change, types.TextDocumentEdit)
    ]
    paths = [Path(uri.removeprefix("file://")) for uri in uris]
    before = {}
    for changed in paths:
        if changed not in editor.texts:
            editor.open(changed)
            edit = _with_version(edit, changed)
        before[changed] = editor.texts[changed].split("\n")
    apply(editor, edit)
    return {
        changed.name: [
            new.strip() for old, new in zip(lines, editor.texts[changed].split("\n"), strict=True) if old != new
        ]
        for changed, lines in before.items()
    }


def _with_version(edit: types.WorkspaceEdit, path: Path) -> types.WorkspaceEdit:
    for change in edit.document_changes or ():
        if isinstance(change, types.TextDocumentEdit) and change.text_document.uri == path.as_uri():
            change.text_document.version = 1
    return edit


def refuse(editor: Editor, path: Path, at: types.Position, name: str) -> str:
    """The sentence with which a renaming is refused."""
    params = types.RenameParams(editor.identify(path), at, name)
    with pytest.raises(JsonRpcException) as refused:
        editor.wait(editor.client.text_document_rename_async(params))
    return str(refused.value.message)


def prepare(editor: Editor, path: Path, at: types.Position) -> str:
    params = types.PrepareRenameParams(editor.identify(path), at)
    found = editor.wait(editor.client.text_document_prepare_rename_async(params))
    assert isinstance(found, types.PrepareRenamePlaceholder)
    assert editor.read(path, found.range) == found.placeholder
    return found.placeholder


@pytest.mark.smoke
def test_a_link_gets_another_name_wherever_it_is_named(editor: Editor, files: dict[str, Path]) -> None:
    robot = files["two_arms.urdf.xacro"]
    at = editor.find(robot, 'link name="base"', part="base")
    assert prepare(editor, robot, at) == "base"
    assert rename(editor, robot, at, "chassis") == {
        "two_arms.urdf.xacro": [
            '<link name="chassis"><visual><geometry><box size="${mass} 1 1"/></geometry><material name="blue"/></visual></link>',
            '<xacro:arm prefix="left" parent="chassis" length="$(arg reach)"><origin xyz="0 1 0"/></xacro:arm>',
            '<xacro:if value="$(eval reach &gt; 9)"><gazebo reference="chassis"/></xacro:if>',
            '<gazebo><plugin name="p" filename="libgazebo_ros_p3d.so"><bodyName>chassis</bodyName></plugin></gazebo>',
        ],
        "two_arms.srdf": [
            '<group name="arms"><joint name="left_joint"/><chain base_link="chassis" tip_link="left_arm"/></group>',
            '<disable_collisions link1="chassis" link2="left_arm" reason="Adjacent"/>',
        ],
        "show.launch": [
            '<node pkg="tf2_ros" type="static_transform_publisher" name="tf" args="0 0 0 0 0 0 /map /chassis"/>',
            '<node pkg="amcl" type="amcl" name="base"><param name="base_frame_id" value="chassis"/>'
            '<param name="title" value="base"/></node>',
        ],
        "controllers.yaml": ["frames: [{base_frame_id: chassis, odom_frame_id: odom, title: base}]"],
    }


OTHERS = {
    "config/costmap.yaml": COSTMAP,
    "config/a_comment.yaml": "a: 1  # base\n",
    "config/database.yaml": "database: /base/x\nbase-2: base.link\n",
    "two_arms/view.rviz": "Global Options:\n  Fixed Frame: base\n",
}


@pytest.mark.parametrize("files", [OTHERS], indirect=True, ids=["others"])
def test_files_that_may_be_about_another_robot_are_told(editor: Editor, files: dict[str, Path]) -> None:
    robot, told = files["two_arms.urdf.xacro"], editor.client.messages
    told.clear()
    changed = rename(editor, robot, editor.find(robot, 'link name="base"', part="base"), "chassis")
    assert changed.keys() == {"two_arms.urdf.xacro", "two_arms.srdf", "show.launch", "controllers.yaml"}
    editor.rest()
    (message,) = [message.message for message in told]
    doubt = "(the file may be about another robot)"
    assert message == f"Not renamed: `base` in view.rviz:2 {doubt}, `base` in costmap.yaml:2 {doubt}."


HANDED = """<robot name="grip" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:arg name="root" default="palm"/>
  <link name="palm"/>
  <joint name="j" type="fixed"><parent link="$(arg root)"/><child link="l_tip"/></joint>
  <xacro:include filename="parts.xacro"/>
  <xacro:finger prefix="l_"/>
  <xacro:nail/>
</robot>
"""
PARTS = """<robot xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:macro name="soft" params="reference"><gazebo reference="${reference}"><mu1>1</mu1></gazebo></xacro:macro>
  <xacro:macro name="finger" params="prefix">
    <link name="${prefix}tip"/>
    <xacro:soft reference="${prefix}tip"/>
  </xacro:macro>
  <xacro:macro name="nail" params="name:=nail
                                   on:='palm'">
    <link name="${name}"/>
    <joint name="${name}_joint" type="fixed"><parent link="${on}"/><child link="${name}"/></joint>
  </xacro:macro>
</robot>
"""
NAMESAKE = """<robot name="namesake" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:include filename="parts.xacro"/>
  <link name="l_tip"/>
</robot>
"""
HANDED_FILES = {"urdf/parts.xacro": PARTS, "urdf/grip.urdf.xacro": HANDED, "urdf/namesake.urdf.xacro": NAMESAKE}


@pytest.mark.parametrize("files", [HANDED_FILES], indirect=True, ids=["handed"])
def test_a_name_that_a_call_makes_and_hands_on(editor: Editor, files: dict[str, Path]) -> None:
    """Another robot that includes the file may have a link of the same name, which stays."""
    parts = files["parts.xacro"]
    editor.open(parts)
    editor.rest()
    assert rename(editor, parts, editor.find(parts, 'link name="${prefix}tip', part="tip"), "pad") == {
        "parts.xacro": ['<link name="${prefix}pad"/>', '<xacro:soft reference="${prefix}pad"/>'],
        "grip.urdf.xacro": ['<joint name="j" type="fixed"><parent link="$(arg root)"/><child link="l_pad"/></joint>'],
    }


BROKEN = HANDED.replace('name="grip"', 'name="broken"').replace('prefix="l_"', 'prefix="${side}"')


@pytest.mark.parametrize(
    "files", [HANDED_FILES | {"urdf/broken.urdf.xacro": BROKEN}], indirect=True, ids=["with_a_broken_one"]
)
def test_a_robot_that_does_not_expand_is_told(editor: Editor, files: dict[str, Path]) -> None:
    """What it shares with another is tried there; what only it has is not changed."""
    parts, broken, told = files["parts.xacro"], files["broken.urdf.xacro"], editor.client.messages
    for path in (parts, broken):
        editor.open(path)
    editor.rest()
    told.clear()
    changed = rename(editor, parts, editor.find(parts, 'name="soft"', part="soft"), "rubber")
    assert changed.keys() == {"parts.xacro"}
    (message,) = [message.message for message in told]
    assert message == f"Not tried, as it cannot be expanded now: {broken.relative_to(editor.folder)}."
    editor.rest()
    at = editor.find(broken, "xacro:finger", part="finger")
    assert "broken.urdf.xacro cannot be expanded as it is now" in refuse(editor, broken, at, "thumb")


def test_a_property_that_gives_a_parameter_another_value(editor: Editor, files: dict[str, Path]) -> None:
    """Also where it does so in another robot only, so that no run shows it."""
    macros = files["arm.xacro"]
    given = '<xacro:if value="${length > 9}"><xacro:property name="parent" value="base"/></xacro:if>\n    <link'
    editor.type(macros, editor.texts[macros].replace("<link", given, 1))
    editor.rest()
    changed = rename(editor, macros, editor.find(macros, 'property name="parent"', part="parent"), "mount")
    assert changed.keys() == {"arm.xacro", "two_arms.urdf.xacro", "other.urdf.xacro"}
    assert '<xacro:macro name="arm" params="prefix mount length:=0.4 *origin">' in changed["arm.xacro"]
    assert '<parent link="${mount}"/>' in changed["arm.xacro"]


@pytest.mark.parametrize("files", [HANDED_FILES], indirect=True, ids=["handed"])
def test_a_name_that_is_the_default_of_a_parameter_or_an_argument(editor: Editor, files: dict[str, Path]) -> None:
    grip, parts = files["grip.urdf.xacro"], files["parts.xacro"]
    editor.open(grip)
    editor.rest()
    assert rename(editor, grip, editor.find(grip, 'link name="palm"', part="palm"), "hand") == {
        "parts.xacro": ["on:='hand'\">"],
        "grip.urdf.xacro": ['<xacro:arg name="root" default="hand"/>', '<link name="hand"/>'],
    }
    editor.rest()
    sentence = "The name is not changed: joint[nail_joint]@name would become `claw_joint` instead of `nail_joint`."
    assert refuse(editor, parts, editor.find(parts, "name:=nail", part="nail"), "claw") == sentence


def test_the_literal_part_of_names_that_a_macro_makes(editor: Editor, files: dict[str, Path]) -> None:
    """In all robots that call it; where only one of its names is asked for, the other is not changed along."""
    robot, macros = files["two_arms.urdf.xacro"], files["arm.xacro"]
    at = editor.find(macros, 'joint name="${prefix}_joint"', part="_joint")
    assert prepare(editor, macros, at) == "_joint"
    assert rename(editor, macros, at, "_elbow") == {
        "arm.xacro": ['<joint name="${prefix}_elbow" type="revolute">'],
        "two_arms.srdf": [
            '<group name="arms"><joint name="left_elbow"/><chain base_link="base" tip_link="left_arm"/></group>'
        ],
        "controllers.yaml": ["joints: [left_elbow, right_elbow]", "left_elbow: {trajectory: 0.1}"],
    }
    at = editor.find(robot, 'parent="left_arm"', part="left_arm")
    sentence = (
        "`left_arm` is made by `${prefix}_arm` (arm.xacro:5), which also makes `right_arm`: rename the text there."
    )
    assert refuse(editor, robot, at, "left_hand") == sentence
    sentence = "`left_arm` is computed by `${prefix}_arm` (arm.xacro:5), which cannot become `l_arm`."
    assert refuse(editor, robot, at, "l_arm") == sentence


def test_a_macro_with_its_end_tags_and_in_robots_that_are_not_open(editor: Editor, files: dict[str, Path]) -> None:
    macros = files["arm.xacro"]
    changed = rename(editor, macros, editor.find(macros, 'name="arm"', part="arm"), "limb")
    assert changed == {
        "arm.xacro": ['<xacro:macro name="limb" params="prefix parent length:=0.4 *origin">'],
        "two_arms.urdf.xacro": [
            '<xacro:limb prefix="left" parent="base" length="$(arg reach)"><origin xyz="0 1 0"/></xacro:limb>',
            '<xacro:limb prefix="right" parent="left_arm"><origin xyz="0 -1 0"/></xacro:limb>',
        ],
        "other.urdf.xacro": ['<xacro:limb prefix="left" parent="base"><origin/></xacro:limb>'],
    }


def test_an_argument_also_where_launch_files_pass_it(editor: Editor, files: dict[str, Path]) -> None:
    robot = files["two_arms.urdf.xacro"]
    changed = rename(editor, robot, editor.find(robot, "$(arg reach)", part="reach"), "span")
    assert changed == {
        "two_arms.urdf.xacro": [
            '<xacro:arg name="span" default="0.5"/>',
            '<xacro:arm prefix="left" parent="base" length="$(arg span)"><origin xyz="0 1 0"/></xacro:arm>',
            '<xacro:if value="$(eval span &gt; 9)"><gazebo reference="base"/></xacro:if>',
        ],
        "show.launch": [
            '<param name="robot_description" command="xacro $(find robot)/urdf/two_arms.urdf.xacro span:=0.6"/>'
        ],
        "show.launch.py": ['return xacro.process_file(path, mappings={"span": "0.7"})'],
    }


def test_a_property_in_its_scope_and_a_parameter_in_its_calls(editor: Editor, files: dict[str, Path]) -> None:
    macros, robot = files["arm.xacro"], files["two_arms.urdf.xacro"]
    changed = rename(editor, macros, editor.find(macros, "${mass}", part="mass"), "own_mass")
    assert changed == {
        "arm.xacro": [
            '<xacro:property name="own_mass" value="${density * length * 0.01}"/>',
            '<mass value="${own_mass}"/>',
        ]
    }, "the property of the same name outside the macro is another one"
    changed = rename(editor, macros, editor.find(macros, "length:=0.4", part="length"), "size")
    assert changed["two_arms.urdf.xacro"] == [
        '<xacro:arm prefix="left" parent="base" size="$(arg reach)"><origin xyz="0 1 0"/></xacro:arm>'
    ]
    changed = rename(editor, robot, editor.find(robot, 'material name="blue"/', part="blue"), "navy")
    assert len(changed["two_arms.urdf.xacro"]) == 2


def test_what_cannot_be_a_name_is_refused(editor: Editor, files: dict[str, Path]) -> None:
    robot, macros = files["two_arms.urdf.xacro"], files["arm.xacro"]
    base = editor.find(robot, 'link name="base"', part="base")
    taken = refuse(editor, robot, base, "left_arm")
    assert taken.startswith("A link is already called `left_arm` (")
    assert refuse(editor, robot, base, "my base").startswith("`my base` cannot be the name of a link: blanks, ")
    density = editor.find(macros, '"density"', part="density")
    assert refuse(editor, macros, density, "2d").startswith("`2d` cannot be the name of a property: ")
    assert refuse(editor, macros, density, "pi").endswith("expressions already know `pi`.")
    assert "already called `length`" in refuse(editor, macros, density, "length")
    arm = editor.find(macros, 'name="arm"', part="arm")
    assert refuse(editor, macros, arm, "property").endswith("`xacro:property` is xacro's own.")
    with pytest.raises(JsonRpcException, match="no name here"):
        prepare(editor, robot, editor.find(robot, "rgba"))


def test_a_refusal_is_no_error_of_the_server(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "r.urdf"
    path.write_text('<robot name="r"><link name="base"/></robot>')
    editor = Editor(tmp_path, "--tier", "source")
    editor.open(path)
    assert refuse(editor, path, editor.find(path, "robot name"), "other") == NOTHING_HERE
    assert editor.end().returncode == 0
    assert capfd.readouterr().err == ""


def test_what_would_change_more_than_the_name_is_refused(editor: Editor, files: dict[str, Path]) -> None:
    """A text of which a macro makes a link and a joint; nothing is renamed in a robot that does not expand."""
    robot, macros = files["two_arms.urdf.xacro"], files["arm.xacro"]
    editor.type(macros, editor.texts[macros].replace("${prefix}_arm", "${prefix}"))
    editor.type(robot, editor.texts[robot].replace('parent="left_arm"', 'parent="left"'))
    at = editor.find(robot, 'prefix="left"', part="left")
    sentence = refuse(editor, robot, at, "front")
    assert sentence.startswith(
        "The name is not changed: joint[left_joint]@name would become `front_joint` instead of `left_joint`"
    )
    editor.type(robot, editor.texts[robot].replace("$(arg reach)", "$(arg raech)"))
    assert "cannot be expanded" in refuse(editor, robot, at, "front")


@pytest.mark.parametrize(
    "files", [{"launch/start.launch.py": START, "launch/nav.launch.py": OTHER_START}], indirect=True, ids=["python"]
)
def test_names_in_python_launch_files_where_the_call_says_that_they_are_names(
    editor: Editor, files: dict[str, Path]
) -> None:
    """What may be something else is left as it is, and told; one finds the names from there, too."""
    robot, start = files["two_arms.urdf.xacro"], files["start.launch.py"]
    told = editor.client.messages
    told.clear()
    changed = rename(editor, robot, editor.find(robot, 'link name="base"', part="base"), "chassis")
    assert changed["start.launch.py"] == [
        'FRAME = "chassis"',
        'arguments=["0", "0", "0", "0", "0", "0", "map", "chassis"]),',
        'Node(package="tf2_ros", executable="static_transform_publisher", arguments="0 0 0 0 0 0 /chassis é".split()),',
        """ExecuteProcess(cmd=["ros2", "run", "tf2_ros", "static_transform_publisher", *[], "--frame-id", 'chassis',""",
        '"robot_base_frame": ParameterValue("chassis", value_type=str), "frame_id": NAME, "title": "base",',
    ]
    assert "nav.launch.py" not in changed
    editor.rest()
    (message,) = [message.message for message in told]
    assert message == (
        "Not renamed: `base` in nav.launch.py:3 (the launch file does not load the robot), "
        "`base` in start.launch.py:9 (the variable may be used for something else), "
        "`base` in start.launch.py:15 (it is the default of a launch argument, which other files may read), "
        "`base` in start.launch.py:10 (nothing says that it names a part of the robot), "
        "`base` in start.launch.py:16 (nothing says that it names a part of the robot), "
        "`base` in start.launch.py:23 (nothing says that it names a part of the robot) and 2 more."
    )
    at = editor.find(start, '["left_joint"', part="left_joint")
    client, document = editor.client, editor.identify(start)
    found = editor.wait(client.text_document_definition_async(types.DefinitionParams(document, at)))
    assert isinstance(found, list)
    assert [place.uri for place in found] == [files["arm.xacro"].as_uri()]
    params = types.ReferenceParams(types.ReferenceContext(include_declaration=False), document, at)
    uses = editor.wait(client.text_document_references_async(params)) or []
    assert [place.range.start.line for place in uses if place.uri == start.as_uri()] == [24, 27]
    at = editor.find(start, 'FRAME = "chassis"', part="chassis")
    assert prepare(editor, start, at) == "chassis"
    assert sorted(rename(editor, start, at, "trunk")) == [
        *("controllers.yaml", "show.launch", "start.launch.py", "two_arms.srdf", robot.name)
    ]


SIZED = """<robot name="sized" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:arg name="tall" default="false"/>
  <xacro:property name="sizes" value="${xacro.load_yaml('sizes.yaml')}"/>
  <xacro:property name="base" value="${sizes['base']}" scope="global"/>
  <xacro:property name="hand" value="${sizes.get('hand')}"/>
  <xacro:macro name="box" params="name size"><link name="${name}"><visual><geometry>
    <box size="${size['width']} ${size.depth} ${base['width'] + hand.width}"/>
  </geometry></visual></link></xacro:macro>
  <xacro:box name="base" size="${base}"/>
  <xacro:if value="$(arg tall)"><link name="${base['width']}"/></xacro:if>
  <link name="${hand['width']}_${sizes['feet'][0]['width']}"/>
  <link name="${sizes['base']['de' + 'pth']}"/>
</robot>
"""
SIZES = "base: &base {width: 2, 'depth': 3}\nhand:\n  <<: *base\n  # width\n  'width': 5\nfeet: [{width: 7}]\n"
SIZED_FILES = {"urdf/sized.urdf.xacro": SIZED, "urdf/sizes.yaml": SIZES, "urdf/small/small.yaml": "width: 1\n"}


@pytest.fixture
def sized(editor: Editor, files: dict[str, Path]) -> tuple[Path, Path]:
    """A robot and the yaml file that it loads, both open."""
    robot, sizes = files["sized.urdf.xacro"], files["sizes.yaml"]
    editor.open(robot)
    editor.open(sizes)
    editor.rest()
    return robot, sizes


@pytest.mark.parametrize("files", [SIZED_FILES], indirect=True, ids=["sized"])
def test_a_yaml_key_gets_another_name_where_expressions_read_it(editor: Editor, sized: tuple[Path, Path]) -> None:
    robot, sizes = sized
    told = editor.client.messages
    told.clear()
    assert prepare(editor, robot, editor.find(robot, "size['width']", part="width")) == "width"
    # One text reads the keys of two mappings, which get the name together; that of the third is another.
    assert rename(editor, sizes, editor.find(sizes, "width: 2", part="width"), "breadth") == {
        "sized.urdf.xacro": [
            "<box size=\"${size['breadth']} ${size.depth} ${base['breadth'] + hand.breadth}\"/>",
            "<link name=\"${hand['breadth']}_${sizes['feet'][0]['width']}\"/>",
        ],
        "sizes.yaml": ["base: &base {breadth: 2, 'depth': 3}", "'breadth': 5"],
    }
    editor.rest()
    (message,) = [message.message for message in told]
    assert message == (
        "Not renamed: `width` in sized.urdf.xacro:10 (nothing that is read there now has it), "
        "`width` in small.yaml:1 (the file may be about another robot)."
    )


@pytest.mark.parametrize("files", [SIZED_FILES], indirect=True, ids=["sized"])
def test_a_yaml_key_that_is_computed_or_taken_keeps_its_name(editor: Editor, sized: tuple[Path, Path]) -> None:
    _, sizes = sized
    width, depth = (editor.find(sizes, f"{name}", part=name) for name in ("width", "depth"))
    assert refuse(editor, sizes, width, "depth").startswith("A yaml key is already called `depth` (")
    assert "could no longer be expanded" in refuse(editor, sizes, depth, "length")
    assert "no digit first" in refuse(editor, sizes, width, "2")
