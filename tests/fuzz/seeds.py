"""Small sound documents of every kind, which the mutations start from. All were written for this."""

from __future__ import annotations

from pathlib import Path

FIXTURES = Path(__file__).parents[2] / "fixtures"

ARM = """<?xml version="1.0"?>
<robot name="arm">
  <material name="grey"><color rgba="0.5 0.5 0.5 1"/></material>
  <link name="base_link">
    <visual><geometry><cylinder radius="0.05" length="0.1"/></geometry><material name="grey"/></visual>
    <collision><geometry><cylinder radius="0.05" length="0.1"/></geometry></collision>
  </link>
  <link name="upper">
    <inertial><origin xyz="0 0 0.1"/><mass value="1.2"/>
      <inertia ixx="0.0045" ixy="0" ixz="0" iyy="0.0045" iyz="0" izz="0.001"/></inertial>
    <visual><origin xyz="0 0 0.1"/><geometry><box size="0.08 0.08 0.2"/></geometry><material name="grey"/></visual>
    <collision><origin xyz="0 0 0.1"/><geometry><box size="0.08 0.08 0.2"/></geometry></collision>
  </link>
  <link name="finger_l">
    <inertial><origin xyz="0 0 0.02" rpy="0 0 0"/><mass value="0.05"/>
      <inertia ixx="0.00001" ixy="0" ixz="0" iyy="0.00001" iyz="0" izz="0.000005"/></inertial>
    <visual><geometry><mesh filename="meshes/part.stl" scale="0.001 0.001 0.001"/></geometry></visual>
    <collision><geometry><sphere radius="0.015"/></geometry></collision>
  </link>
  <link name="finger_r">
    <inertial><origin xyz="0 0 0.02" rpy="0 0 0"/><mass value="0.05"/>
      <inertia ixx="0.00001" ixy="0" ixz="0" iyy="0.00001" iyz="0" izz="0.000005"/></inertial>
    <visual><geometry><mesh filename="package://robot/meshes/part.stl" scale="0.001 0.001 0.001"/></geometry></visual>
    <collision><geometry><sphere radius="0.015"/></geometry></collision>
  </link>
  <joint name="shoulder" type="revolute">
    <origin xyz="0 0 0.06" rpy="0 0 0"/><parent link="base_link"/><child link="upper"/><axis xyz="0 1 0"/>
    <limit lower="-1.5" upper="1.5" effort="40" velocity="2"/><dynamics damping="0.1" friction="0.05"/>
    <safety_controller k_velocity="10" k_position="10" soft_lower_limit="-1.4" soft_upper_limit="1.4"/>
  </joint>
  <joint name="grip_l" type="prismatic">
    <origin xyz="0 0.03 0.22"/><parent link="upper"/><child link="finger_l"/><axis xyz="0 1 0"/>
    <limit lower="0" upper="0.03" effort="20" velocity="0.1"/>
  </joint>
  <joint name="grip_r" type="prismatic">
    <origin xyz="0 -0.03 0.22"/><parent link="upper"/><child link="finger_r"/><axis xyz="0 -1 0"/>
    <limit lower="0" upper="0.03" effort="20" velocity="0.1"/><mimic joint="grip_l" multiplier="1" offset="0"/>
  </joint>
  <transmission name="t1"><type>transmission_interface/SimpleTransmission</type>
    <joint name="shoulder"><hardwareInterface>hardware_interface/EffortJointInterface</hardwareInterface></joint>
    <actuator name="m1"><mechanicalReduction>50</mechanicalReduction></actuator></transmission>
  <ros2_control name="system" type="system">
    <hardware><plugin>gazebo_ros2_control/GazeboSystem</plugin></hardware>
    <joint name="shoulder"><command_interface name="position"><param name="min">-1.5</param></command_interface>
      <state_interface name="position"/><state_interface name="velocity"/></joint>
  </ros2_control>
  <gazebo reference="upper"><mu1>0.8</mu1><mu2>0.8</mu2><material>Gazebo/Grey</material></gazebo>
  <gazebo><plugin name="control" filename="libgazebo_ros_control.so"/></gazebo>
</robot>
"""

_WHEEL = """  <link name="wheel_{n}">
    <inertial><mass value="0.5"/><inertia ixx="0.0009" ixy="0" ixz="0" iyy="0.0016" iyz="0" izz="0.0009"/></inertial>
    <visual><origin rpy="1.5707963267948966 0 0"/><geometry><cylinder radius="0.08" length="0.04"/></geometry></visual>
    <collision><origin rpy="1.5707963267948966 0 0"/><geometry><cylinder radius="0.08" length="0.04"/></geometry></collision>
  </link>
  <joint name="wheel_{n}_joint" type="continuous">
    <origin xyz="{x} {y} 0"/><parent link="chassis"/><child link="wheel_{n}"/><axis xyz="0 1 0"/>
    <limit effort="10" velocity="20"/>
  </joint>
"""
CAR = (
    """<?xml version="1.0" encoding="utf-8"?>
<!-- a car with four wheels -->
<robot name="car">
  <link name="base_footprint"/>
  <link name="chassis">
    <inertial><origin xyz="0 0 0.1"/><mass value="8"/>
      <inertia ixx="0.08" ixy="0" ixz="0" iyy="0.2" iyz="0" izz="0.25"/></inertial>
    <visual><origin xyz="0 0 0.1"/><geometry><box size="0.5 0.3 0.1"/></geometry></visual>
    <collision><origin xyz="0 0 0.1"/><geometry><box size="0.5 0.3 0.1"/></geometry></collision>
  </link>
  <joint name="base_joint" type="fixed"><origin xyz="0 0 0.08"/><parent link="base_footprint"/><child link="chassis"/></joint>
"""
    + "".join(
        _WHEEL.format(n=n, x=x, y=y)
        for n, x, y in ((1, "0.2", "0.2"), (2, "0.2", "-0.2"), (3, "-0.2", "0.2"), (4, "-0.2", "-0.2"))
    )
    + "</robot>\n"
)

SMALL = """<robot name="small">
  <link name="a"><inertial><mass value="1"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
  <link name="b"/>
  <joint name="ab" type="floating"><parent link="a"/><child link="b"/></joint>
</robot>
"""

MESHED = """<robot name="meshed">
  <link name="base"/>
  <link name="part">
    <inertial><mass value="1"/><inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial>
    <visual><geometry><mesh filename="meshes/{name}"/></geometry></visual>
    <collision><geometry><mesh filename="package://robot/meshes/{name}" scale="1 1 1"/></geometry></collision>
  </link>
  <joint name="j" type="revolute"><parent link="base"/><child link="part"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" effort="5" velocity="1"/></joint>
</robot>
"""

XACRO = """<?xml version="1.0"?>
<robot name="made" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:arg name="size" default="0.2"/>
  <xacro:arg name="with_tool" default="true"/>
  <xacro:property name="size" value="$(arg size)"/>
  <xacro:property name="mass" value="${size * 4 + 0.5}"/>
  <xacro:property name="data" value="${load_yaml('values.yaml')}"/>
  <xacro:property name="pose"><origin xyz="0 0 ${size / 2}" rpy="0 0 ${radians(90)}"/></xacro:property>
  <xacro:include filename="parts.xacro"/>
  <xacro:macro name="cube" params="name side:=0.1 parent:=^|base *pose **extra">
    <link name="${name}">
      <inertial><xacro:insert_block name="pose"/><mass value="${mass}"/>
        <inertia ixx="${mass / 6 * side ** 2}" ixy="0" ixz="0" iyy="${mass / 6 * side ** 2}" iyz="0"
          izz="${mass / 6 * side ** 2}"/></inertial>
      <visual><xacro:insert_block name="pose"/><geometry><box size="${side} ${side} ${side}"/></geometry></visual>
      <xacro:insert_block name="extra"/>
    </link>
  </xacro:macro>
  <link name="base"/>
  <xacro:cube name="one" side="${data['side']}"><xacro:insert_block name="pose"/><extra/></xacro:cube>
  <xacro:if value="$(arg with_tool)"><xacro:tool name="tool" parent="one"/></xacro:if>
  <xacro:unless value="${size &gt; 1 or not data.flag}"><link name="small"/></xacro:unless>
  <joint name="j1" type="fixed"><parent link="base"/><child link="one"/></joint>
  <xacro:if value="${data.flag}"><joint name="j2" type="fixed"><parent link="base"/><child link="small"/></joint></xacro:if>
</robot>
"""
PARTS = """<?xml version="1.0"?>
<robot xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:property name="tool_length" value="${2 * pi / 10}"/>
  <xacro:macro name="tool" params="name parent">
    <link name="${name}"><visual><geometry><cylinder radius="0.01" length="${tool_length}"/></geometry></visual></link>
    <joint name="${parent}_${name}" type="continuous">
      <origin xyz="0 0 ${tool_length * cos(0)}"/><parent link="${parent}"/><child link="${name}"/><axis xyz="0 0 1"/>
    </joint>
  </xacro:macro>
</robot>
"""
LOOP = """<?xml version="1.0"?>
<robot name="chain" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:property name="names" value="${['a', 'b', 'c']}"/>
  <xacro:macro name="chain" params="n parent">
    <link name="l${n}"/>
    <joint name="j${n}" type="fixed"><parent link="${parent}"/><child link="l${n}"/></joint>
    <xacro:if value="${n &lt; 4}"><xacro:chain n="${n + 1}" parent="l${n}"/></xacro:if>
  </xacro:macro>
  <xacro:macro name="each" params="rest">
    <xacro:if value="${rest}">
      <link name="${rest[0]}"/>
      <joint name="${rest[0]}_joint" type="fixed"><parent link="root"/><child link="${rest[0]}"/></joint>
      <xacro:each rest="${rest[1:]}"/>
    </xacro:if>
  </xacro:macro>
  <link name="root"/>
  <xacro:chain n="1" parent="root"/>
  <xacro:each rest="${names}"/>
</robot>
"""
READER = """<?xml version="1.0"?>
<robot name="reader" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:property name="data" value="${xacro.load_yaml('values.yaml')}"/>
  <link name="base">
    <inertial><mass value="${data['mass']}"/><inertia ixx="${data.inertia.ixx}" ixy="0" ixz="0"
      iyy="${data['inertia']['iyy']}" iyz="0" izz="${data.inertia['izz']}"/></inertial>
    <visual><geometry><box size="${data.list[0]} ${data.list[1]} ${data.list[2]}"/></geometry></visual>
  </link>
  <xacro:macro name="each" params="names">
    <xacro:if value="${names}"><link name="${names[0]}"/>
      <joint name="j_${names[0]}" type="fixed"><origin rpy="0 0 ${data.turn}"/><parent link="base"/>
        <child link="${names[0]}"/></joint>
      <xacro:each names="${names[1:]}"/></xacro:if>
  </xacro:macro>
  <xacro:each names="${list(data.names)}"/>
  <xacro:if value="${data.flag}"><gazebo><static>${data.get('static', False)}</static></gazebo></xacro:if>
</robot>
"""
YAML = """# values of the robot
defaults: &defaults {side: 0.1, flag: true}
<<: *defaults
side: 0.2
mass: 1.5
inertia: &inertia
  ixx: 1.0e-2
  iyy: 0.01
  izz: .01
other: {<<: *inertia, izz: 0.02}
list: [0.1, 0.2, 0.3]
names:
  - left
  - "right"
  - 'tool 0'
turn: !degrees 90
angle: !radians pi/2
text: |
  two
  lines
static: false
nothing: ~
"""

LAUNCH_1 = """<?xml version="1.0"?>
<launch>
  <arg name="model" default="$(find robot)/model.urdf"/>
  <arg name="gui" default="true"/>
  <arg name="x" default="0.5"/>
  <param name="robot_description" command="$(find xacro)/xacro '$(arg model)' size:=0.2"/>
  <include file="$(find robot)/other.launch"><arg name="x" value="$(arg x)"/></include>
  <group if="$(arg gui)"><node name="rviz" pkg="rviz" type="rviz" args="-d $(find robot)/robot.rviz"/></group>
  <node name="rsp" pkg="robot_state_publisher" type="robot_state_publisher"/>
  <node name="tf" pkg="tf" type="static_transform_publisher" args="$(arg x) 0 0 0 0 0 base_link tool 40"/>
  <node name="spawn" pkg="gazebo_ros" type="spawn_model" args="-urdf -model arm -param robot_description -z 0.1"/>
</launch>
"""
OTHER_LAUNCH = """<launch>
  <arg name="x" default="0"/>
  <param name="robot_description" textfile="$(dirname)/model.urdf"/>
  <node name="tf2" pkg="tf2_ros" type="static_transform_publisher" args="$(arg x) 0 0 0 0 0 1 upper camera"/>
</launch>
"""
LAUNCH_2 = """<?xml version="1.0"?>
<launch>
  <arg name="model" default="$(find-pkg-share robot)/model.urdf"/>
  <arg name="use_sim" default="false"/>
  <let name="desc" value="$(command 'xacro $(var model) size:=0.3')"/>
  <include file="$(find-pkg-share robot)/other.launch"><arg name="x" value="1"/></include>
  <node pkg="robot_state_publisher" exec="robot_state_publisher" name="rsp">
    <param name="robot_description" value="$(command 'xacro $(var model)')"/>
    <param name="use_sim_time" value="$(var use_sim)"/>
  </node>
  <node pkg="tf2_ros" exec="static_transform_publisher" args="--x 0.1 --yaw 1.57 --frame-id base_link --child-frame-id cam"/>
  <group unless="$(var use_sim)"><node pkg="rviz2" exec="rviz2" args="-d $(find-pkg-share robot)/robot.rviz"/></group>
  <node pkg="gazebo_ros" exec="spawn_entity.py" args="-topic robot_description -entity arm"/>
</launch>
"""
LAUNCH_PY = """import os
from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription
from launch.substitutions import Command, LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackageShare

import xacro

URDF = "model.urdf"


def generate_launch_description():
    share = get_package_share_directory("robot")
    path = os.path.join(share, URDF)
    with open(path) as file:
        text = file.read()
    model = PathJoinSubstitution([FindPackageShare("robot"), "model.urdf"])
    description = {"robot_description": ParameterValue(Command(["xacro ", model, " size:=", "0.3"]), value_type=str)}
    other = xacro.process_file(os.path.join(share, "urdf", "made.urdf.xacro"), mappings={"size": "0.1"}).toxml()
    return LaunchDescription([
        DeclareLaunchArgument("model", default_value=path, description="the model"),
        Node(package="robot_state_publisher", executable="robot_state_publisher", parameters=[description]),
        Node(package="tf2_ros", executable="static_transform_publisher",
             arguments=["0", "0", "0.1", "0", "0", "0", "base_link", "camera"]),
        Node(package="gazebo_ros", executable="spawn_entity.py", arguments=["-entity", "arm", "-file", path]),
    ])
"""

SRDF = """<?xml version="1.0"?>
<robot name="arm">
  <group name="arm"><chain base_link="base_link" tip_link="upper"/></group>
  <group name="hand"><link name="finger_l"/><link name="finger_r"/><joint name="grip_l"/></group>
  <group_state name="home" group="arm"><joint name="shoulder" value="0.5"/></group_state>
  <end_effector name="hand" parent_link="upper" group="hand"/>
  <virtual_joint name="world_joint" type="fixed" parent_frame="world" child_link="base_link"/>
  <passive_joint name="grip_r"/>
  <disable_default_collisions link="finger_r"/>
  <enable_collisions link1="finger_l" link2="finger_r" reason="User"/>
  <disable_collisions link1="base_link" link2="upper" reason="Adjacent"/>
  <disable_collisions link1="finger_l" link2="upper" reason="Adjacent"/>
  <disable_collisions link1="finger_r" link2="upper" reason="Adjacent"/>
  <disable_collisions link1="base_link" link2="finger_l" reason="Never"/>
</robot>
"""

PACKAGE = """<?xml version="1.0"?>
<package format="3">
  <name>robot</name>
  <version>0.1.0</version>
  <description>A robot</description>
  <maintainer email="a@example.org">A</maintainer>
  <license>Apache-2.0</license>
  <buildtool_depend>ament_cmake</buildtool_depend>
  <exec_depend>xacro</exec_depend>
  <depend>robot_state_publisher</depend>
  <export><build_type>ament_cmake</build_type><gazebo_ros gazebo_model_path="${prefix}/.."/></export>
</package>
"""

CAR_3 = (FIXTURES / "car-3/urdf/car-3.urdf").read_text(encoding="utf-8")
CAR_3_XACRO = (FIXTURES / "car-3/robot_description/urdf/car_body.urdf.xacro").read_text(encoding="utf-8")
CAR_3_LAUNCH = (FIXTURES / "car-3/launch/car.launch").read_text(encoding="utf-8")
