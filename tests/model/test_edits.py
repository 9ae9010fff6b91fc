"""What checks read of the model as typed numbers, and the edits of literal attributes."""

from __future__ import annotations

from pathlib import Path

import pytest

from urdfcheck.model import Model
from urdfcheck.model.repairs.edits import edit_content, edit_literal, edit_literals, locate_content, swap_values
from urdfcheck.source.load import load_source
from urdfcheck.source.package.finder import PackageFinder

TENSOR = '<inertia ixx="1" ixy="0" ixz="0" iyy="2" iyz="0" izz="2.5"/>'
ROBOT = f"""<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:property name="top" value="2"/>
  <link name="whole"><inertial><origin xyz="0 0 1" rpy="0 0 1"/><mass value="3"/>{TENSOR}</inertial></link>
  <link name="unplaced"><inertial><origin xyz="0 0"/><mass value="3"/>{TENSOR}</inertial></link>
  <link name="light"><inertial><mass value="-1"/></inertial></link>
  <link name="weightless"><inertial><mass value="heavy"/>{TENSOR}</inertial></link>
  <link name="partial"><inertial><mass value="1"/><inertia ixx="1"/></inertial></link>
  <link name="frame"/>
  <joint name="turn" type="revolute"><parent link="whole"/><child link="light"/><limit lower="-1" upper="${{top}}"/></joint>
  <joint name="slide" type="prismatic"><limit lower="1" upper="1"/></joint>
  <joint name="spin" type="continuous"><limit lower="-1" upper="1"/></joint>
  <note>old</note>
</robot>
"""


@pytest.fixture
def model(tmp_path: Path) -> Model:
    path = tmp_path / "arm.urdf.xacro"
    path.write_text(ROBOT)
    source = load_source(path, {}, PackageFinder(path))
    assert source.root is not None
    return Model(source=source, robot=source.root)


def test_masses_are_those_that_are_typed_as_numbers(model: Model) -> None:
    assert {declared.link.name: declared.mass for declared in model.masses} == {
        "whole": 3.0,
        "unplaced": 3.0,
        "light": -1.0,
        "partial": 1.0,
    }
    assert model.mass_by_name["light"].attribute.value == "-1"


def test_tensors_have_all_six_components(model: Model) -> None:
    assert list(model.tensor_by_name) == ["whole", "unplaced", "weightless"]
    whole = model.tensors[0]
    assert whole.texts == ["1", "0", "0", "2", "0", "2.5"]
    assert whole.get_attribute(5).value == "2.5"
    assert whole.tensor.tolist() == [[1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.5]]


def test_inertials_have_mass_pose_and_tensor(model: Model) -> None:
    (whole,) = model.inertials
    assert (whole.link.name, whole.mass, whole.pose[:3, 3].tolist()) == ("whole", 3.0, [0.0, 0.0, 1.0])
    assert whole.tensor_in_link is whole.inertial.tensor_in_link


def test_a_range_has_a_lower_end_below_the_upper_one(model: Model) -> None:
    ranges = {joint.name: (joint.position_range, joint.position_unit) for joint in model.joints}
    assert ranges == {"turn": ((-1.0, 2.0), "rad"), "slide": (None, "m"), "spin": (None, "rad")}


def test_a_joint_without_a_child_is_located_itself(model: Model) -> None:
    turn, slide = model.joint_by_name["turn"], model.joint_by_name["slide"]
    assert turn.child_location.subject == "joint[turn]/child@link"
    assert (slide.child_attribute, slide.child_location) == (None, slide.location)


def test_only_literal_values_are_edited(model: Model) -> None:
    limits = [joint.limit for joint in model.joints if joint.limit is not None]
    lower, computed = limits[0].attributes["lower"], limits[0].attributes["upper"]
    upper = limits[2].attributes["upper"]
    assert [(edit.expected, edit.replacement) for edit in edit_literal(lower, "0")] == [("-1", "0")]
    assert edit_literal(computed, "0") == edit_literal(None, "0") == []
    assert [edit.replacement for edit in edit_literals([(lower, "0"), (upper, "9")])] == ["0", "9"]
    assert edit_literals([(lower, "0"), (computed, "9")]) == []
    assert [edit.replacement for edit in swap_values(lower, upper)] == ["1", "-1"]
    assert [edit.expected for edit in swap_values(lower, computed)] == ["-1", "2"]  # the property's
    assert swap_values(None, lower) == []


def test_the_content_of_an_element_is_edited_where_it_is_typed(model: Model) -> None:
    note, files = model.robot.find_children("note")[0], model.source.files
    (edit,) = edit_content(note, "new", files)
    assert (edit.expected, edit.replacement) == ("old", "new")
    assert locate_content(note, files).span == edit.span
    assert edit_content(model.robot, "new", files) == []
    assert locate_content(model.robot, files) == model.robot.location
