"""What a launch file starts, and what flows between these nodes: nothing is launched, and nothing is invented."""

from __future__ import annotations

from pathlib import Path

import pytest

from urdfcheck.core.scene import SceneLaunch, SceneNode
from urdfcheck.source.launch.launch_file import load_launch
from urdfcheck.source.launch.node_graph import build_launch_scene
from urdfcheck.source.launch.nodes_xml import MAX_ACTIONS, MOST_NAMES
from urdfcheck.source.package.finder import PackageFinder


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A package with a model, in the working directory."""
    monkeypatch.chdir(tmp_path)
    folder = tmp_path / "car"
    (folder / "urdf").mkdir(parents=True)
    (folder / "urdf/car.urdf").write_text('<robot name="car"/>')
    (folder / "package.xml").write_text("<package><name>car</name></package>")
    return folder


def scene(package: Path, text: str, name: str = "car.launch") -> SceneLaunch:
    path = package / name
    path.write_text(text if name.endswith(".py") else f"<launch>{text}</launch>")
    return build_launch_scene(load_launch(path, PackageFinder(path, environment={})))


def flow(node: SceneNode) -> str:
    """``what it reads -> what it writes``."""
    sides = (" + ".join(f"{p.kind} {p.name}" for p in ports) for ports in (node.reads, node.writes))
    return " -> ".join(sides).strip()


def flows(launch: SceneLaunch) -> dict[str, str]:
    return {node.name: flow(node) for node in launch.nodes}


ROS1 = """
  <param name="robot_description" command="$(find xacro)/xacro $(find car)/urdf/car.urdf"/>
  <node name="sliders" pkg="joint_state_publisher" type="joint_state_publisher"/>
  <node name="states" pkg="robot_state_publisher" type="robot_state_publisher"/>
  <node name="foot" pkg="tf" type="static_transform_publisher" args="0 0 0 0 0 0 base foot 40"/>
  <node name="brain" pkg="mine" type="brain"/>
"""


def test_ros_1_a_parameter_feeds_the_nodes_that_read_it(package: Path) -> None:
    launch = scene(package, ROS1)
    (parameter,) = launch.parameters
    assert (launch.file, launch.dialect) == ("car/car.launch", "ros1")
    assert (parameter.port.name, parameter.origin, parameter.problem) == ("/robot_description", "car/urdf/car.urdf", "")
    assert flows(launch) == {
        "/sliders": "parameter /robot_description -> topic /joint_states",
        "/states": "parameter /robot_description + topic /joint_states -> topic /tf + topic /tf_static",
        "/foot": "-> topic /tf",
        "/brain": "->",
    }
    assert ("transform", "base to foot") in launch.nodes[2].facts
    assert launch.nodes[3].purpose == "", "of a program that is not known nothing is said"


def test_names_follow_namespaces_and_remaps(package: Path) -> None:
    launch = scene(
        package,
        """
        <node name="before" pkg="joint_state_publisher" type="joint_state_publisher"/>
        <group ns="arm">
          <param name="robot_description" textfile="$(find car)/urdf/car.urdf"/>
          <remap from="joint_states" to="/all"/>
          <node name="after" ns="left" pkg="joint_state_publisher" type="joint_state_publisher"/>
          <node name="own" pkg="robot_state_publisher" type="robot_state_publisher">
            <remap from="/tf" to="tf"/>
          </node>
        </group>""",
    )
    assert flows(launch) == {
        "/before": "parameter /robot_description -> topic /joint_states",
        # The next parameter of that name in the namespaces around the node.
        "/arm/left/after": "parameter /arm/robot_description -> topic /all",
        "/arm/own": "parameter /arm/robot_description + topic /all -> topic /arm/tf + topic /tf_static",
    }


def test_ros_2_the_publisher_hands_its_parameter_on_as_a_topic(package: Path) -> None:
    launch = scene(
        package,
        """
        <group>
          <push-ros-namespace namespace="arm"/>
          <node pkg="robot_state_publisher" exec="robot_state_publisher">
            <param name="robot_description" value="$(command 'xacro $(find-pkg-share car)/urdf/car.urdf')"/>
            <param name="use_sim_time" value="true"/>
          </node>
        </group>
        <node pkg="joint_state_publisher" exec="joint_state_publisher"/>""",
        "car.launch.xml",
    )
    own = "/arm/robot_state_publisher robot_description"
    assert [(p.port.name, p.origin) for p in launch.parameters] == [(own, "car/urdf/car.urdf")]
    assert flows(launch) == {
        "/arm/robot_state_publisher": (
            f"parameter {own} + topic /arm/joint_states -> topic /arm/robot_description + topic /tf + topic /tf_static"
        ),
        "/joint_state_publisher": "topic /robot_description -> topic /joint_states",
    }
    assert ("use_sim_time", "true") in launch.nodes[0].facts


@pytest.mark.parametrize(
    ("node", "expected"),
    [
        (
            'pkg="gazebo_ros" type="spawn_model" args="-urdf -model -param robot_description"',
            "parameter /robot_description -> service /gazebo/spawn_urdf_model",
        ),
        (
            'pkg="gazebo_ros" type="spawn_model" args="-file $(find car)/urdf/car.urdf -sdf -model x"',
            "file car/urdf/car.urdf -> service /gazebo/spawn_sdf_model",
        ),
        ('pkg="gazebo_ros" type="spawn_model" args="-param -urdf"', "-> service /gazebo/spawn_urdf_model"),
        (
            'pkg="gazebo_ros" exec="spawn_entity.py" args="-topic robot_description -entity x"',
            "topic /robot_description -> service /spawn_entity",
        ),
        ('pkg="ros_gz_sim" exec="create" args="-topic /r"', "topic /r -> service create (Gazebo transport)"),
        (
            'pkg="ros_gz_bridge" exec="parameter_bridge" args="/clock@a[b /cmd@a]b /both@a@b"',
            "topic /cmd + topic /both -> topic /clock + topic /both",
        ),
        (
            'pkg="controller_manager" exec="spawner" args="arm -c /a/controller_manager"',
            "-> service /a/controller_manager/load_controller",
        ),
        ('pkg="rostopic" type="rostopic" args="pub /calibrated std_msgs/Bool true"', "-> topic /calibrated"),
        (
            'pkg="joint_state_publisher" exec="joint_state_publisher" args="$(find car)/urdf/car.urdf"',
            "file car/urdf/car.urdf -> topic /joint_states",
        ),
        ('pkg="tf2_ros" exec="static_transform_publisher" args="$(env A)"', "-> topic /tf_static"),
        ('pkg="spawn_model" type="spawn_model" args="-param robot_description"', "->"),
    ],
)  # fmt: skip
def test_arguments_of_well_known_programs(package: Path, node: str, expected: str) -> None:
    (found,) = scene(package, f'<node name="n" {node}/>').nodes
    assert flow(found) == expected


@pytest.mark.parametrize(
    ("config", "expected"),
    [
        ("- Class: rviz/RobotModel\n  Robot Description: /arm/robot\n", "parameter /arm/robot"),
        ("- Class: rviz/TF\n  Robot Description: /arm/robot\n", ""),
        (
            "- Class: rviz/RobotModel\n- Class: rviz/Other\n  Robot Description: /other\n",
            "parameter /robot_description",
        ),
        (None, ""),
    ],
)
def test_rviz_reads_what_its_configuration_says(package: Path, config: str | None, expected: str) -> None:
    if config is not None:
        (package / "car.rviz").write_text(config)
    node = '<node name="rviz" pkg="rviz" type="rviz" args="-d $(find car)/car.rviz"/>'
    (found,) = scene(package, node).nodes
    assert flow(found) == " + ".join(filter(None, ("topic /tf", "topic /tf_static", expected))) + " ->"
    assert ("no RobotModel display" in found.purpose) is not bool(expected)


def test_conditions_are_told_with_what_they_are_by_default(package: Path) -> None:
    launch = scene(
        package,
        """
        <arg name="gui" default="false"/>
        <node name="always" pkg="a" type="a"/>
        <group if="$(arg gui)"><node name="gui" pkg="a" type="a" unless="$(env HEADLESS)"/></group>
        <node name="plain" pkg="a" type="a" unless="$(arg gui)"/>""",
    )
    assert [(n.name, n.condition, n.off) for n in launch.nodes] == [
        ("/always", "", False),
        ("/gui", "if $(arg gui) and unless $(env HEADLESS)", True),
        ("/plain", "unless $(arg gui)", False),
    ]


def test_included_files_are_part_of_it_and_others_stand_for_themselves(package: Path) -> None:
    (package / "inner.launch").write_text('<launch><node name="deep" pkg="a" type="a"/></launch>')
    launch = scene(
        package,
        """
        <include file="$(find car)/inner.launch" ns="arm"/>
        <include file="$(find gazebo_ros)/launch/empty_world.launch"/>
        <include file="$(find other)/launch/$(env WHICH).launch"/>""",
    )
    assert [(n.kind, n.name, n.program) for n in launch.nodes] == [
        ("node", "/arm/deep", "a/a"),
        ("launch file", "", "gazebo_ros/empty_world.launch"),
        ("launch file", "", "other/$(env WHICH).launch"),
    ]
    assert [n.purpose for n in launch.nodes] == ["", "Gazebo Classic", ""]
    assert "service /gazebo/spawn_urdf_model" in flow(launch.nodes[1])


@pytest.mark.parametrize(
    ("attribute", "origin", "problem"),
    [
        ('textfile="$(find car)/urdf/no.urdf"', "$(find car)/urdf/no.urdf", "car/urdf/no.urdf does not exist"),
        ('textfile="$(find nowhere)/a.urdf"', "$(find nowhere)/a.urdf", "package nowhere is not found"),
        ('textfile="$(arg model)"', "$(arg model)", "argument model has no value"),
        ('command="my_generator --arm"', "my_generator --arm", "only known when it is launched"),
        ('value="&lt;robot/>"', "its own text", ""),
    ],
)
def test_an_origin_that_is_not_known_says_why(package: Path, attribute: str, origin: str, problem: str) -> None:
    (parameter,) = scene(package, f'<param name="robot_description" {attribute}/>').parameters
    assert (parameter.origin, parameter.problem) == (origin, problem)


def test_places_cover_a_node_with_all_that_stands_in_it(package: Path) -> None:
    launch = scene(package, '<node name="n" pkg="a" type="a">\n  <param name="x" value="1"/>\n</node>')
    (span,) = launch.nodes[0].spans
    text = (package / "car.launch").read_text()
    assert text[span.start : span.end] == '<node name="n" pkg="a" type="a">\n  <param name="x" value="1"/>'


PYTHON = """
share = get_package_share_directory("car")
description = {"robot_description": Command(["xacro ", os.path.join(share, "urdf", "car.urdf")])}
gui = LaunchConfiguration("gui")
LaunchDescription([
    DeclareLaunchArgument("gui", default_value="false"),
    Node(package="robot_state_publisher", executable="robot_state_publisher", namespace="arm",
         parameters=[description, "more.yaml", {"use_sim_time": True}], remappings=[("/tf", "tf")]),
    Node(package="joint_state_publisher_gui", executable="joint_state_publisher_gui", condition=IfCondition(gui)),
    Node(package="ros_gz_sim", executable="create", arguments=["-topic", "/arm/robot_description", "-file", share]),
    IncludeLaunchDescription(PythonLaunchDescriptionSource(
        PathJoinSubstitution([FindPackageShare("ros_gz_sim"), "launch", "gz_sim.launch.py"]))),
    ExecuteProcess(cmd=["gazebo", "--verbose"]),
])
"""


def test_python_literal_calls_say_the_same(package: Path) -> None:
    launch = scene(package, PYTHON, "car.launch.py")
    own = "/arm/robot_state_publisher robot_description"
    assert [(p.port.name, p.origin, p.problem) for p in launch.parameters] == [(own, "car/urdf/car.urdf", "")]
    assert [(n.kind, n.name, n.program, n.condition, n.off) for n in launch.nodes] == [
        ("node", "/arm/robot_state_publisher", "robot_state_publisher/robot_state_publisher", "", False),
        ("node", "/joint_state_publisher_gui", "joint_state_publisher_gui/joint_state_publisher_gui", "if $(var gui)", True),
        ("node", "/create", "ros_gz_sim/create", "", False),
        ("launch file", "", "ros_gz_sim/gz_sim.launch.py", "", False),
        ("process", "", "gazebo", "", False),
    ]  # fmt: skip
    assert flow(launch.nodes[0]) == (
        f"parameter {own} + topic /arm/joint_states -> topic /arm/robot_description + topic /arm/tf + topic /tf_static"
    )
    assert flow(launch.nodes[2]) == "topic /arm/robot_description + file car -> service create (Gazebo transport)"
    assert ("arguments", "-topic /arm/robot_description -file car") in launch.nodes[2].facts
    assert ("use_sim_time", "True") in launch.nodes[0].facts
    assert launch.notes == ()


@pytest.mark.parametrize(
    ("text", "note"),
    [
        ("GroupAction([Node(package='a', executable='b')])", "only known when it is launched"),
        ("x = (", "could not be read"),
        (f"[{'Node(package=1),' * (MAX_ACTIONS + 5)}]", f"No more than {MAX_ACTIONS}"),
    ],
)
def test_python_what_is_not_read_is_told(package: Path, text: str, note: str) -> None:
    launch = scene(package, text, "car.launch.py")
    assert note in " ".join(launch.notes)
    assert len(launch.nodes) <= MAX_ACTIONS


@pytest.mark.parametrize(
    ("text", "names"),
    [
        ("x = [x]\nNode(package=x)", [""]),
        (
            "\n".join(f"x{i} = [{', '.join([f'x{i + 1}'] * 30)}]" for i in range(30)) + "\nNode(name='a', package=x0)",
            ["/a"],
        ),
        ("Node(**options)\nNode(parameters=[{1: 2, **more}], remappings=[(1,), 2])\nNode()", ["", ""]),
    ],
)
def test_python_odd_calls_and_lists_of_themselves_end(package: Path, text: str, names: list[str]) -> None:
    assert [node.name for node in scene(package, text, "car.launch.py").nodes] == names


def test_files_that_include_each_other_too_deeply_are_told(package: Path) -> None:
    deep = '<group ns="a">' * 200
    for i in range(20):
        include = f'<include file="$(find car)/i{i + 1}.launch"/>'
        (package / f"i{i}.launch").write_text(f"<launch>{deep}{include}{'</group>' * 200}</launch>")
    (package / "i20.launch").write_text("<launch/>")
    launch = scene(package, '<include file="$(find car)/i0.launch"/>')
    assert "nested too deeply" in " ".join(launch.notes)


def test_names_and_numbers_of_names_are_bounded(package: Path) -> None:
    remaps = "".join(f'<remap from="a{i}" to="b{i}"/>' for i in range(300))
    node = f'<node name="{"n" * 5000}" pkg="{"p" * 5000}" type="t" args="{"a " * 5000}">{remaps}</node>'
    (found,) = scene(package, f'<group ns="{"g" * 5000}">{remaps}{node}</group>').nodes
    assert len(found.facts) == 1 + MOST_NAMES
    assert ("remapped", "a299 to b299") in found.facts
    assert max(map(len, (found.name, found.program, *(value for _, value in found.facts)))) < 300
    topics = " ".join(f"/t{i}@a[b" for i in range(300))
    (bridge,) = scene(package, f'<node name="b" pkg="ros_gz_bridge" exec="parameter_bridge" args="{topics}"/>').nodes
    assert len(bridge.writes) == MOST_NAMES


def test_a_broken_file_starts_nothing(package: Path) -> None:
    launch = scene(package, "<node>")
    assert (launch.nodes, launch.parameters, launch.notes) == ((), (), ("The file could not be read.",))
