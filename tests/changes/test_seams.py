"""What files around a model say differently is reported with its line, and nothing else is."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import pytest
from conftest import make_request
from versions import ARM

from urdfcheck.changes.compare_versions import compare_versions
from urdfcheck.changes.gate import make_gate
from urdfcheck.core.model_diff import Diff
from urdfcheck.output.changes.text import describe_seam
from urdfcheck.run.pipeline import IN_THIS_PROCESS

FILES = {
    "urdf/arm.urdf.xacro": ARM.replace(
        '<robot name="arm">',
        '<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">\n  <xacro:arg name="side" default="left"/>',
    ),
    "package.xml": """<package format="3">
  <name>arm_description</name>
  <version>0.0.1</version>
  <exec_depend>xacro</exec_depend>
  <exec_depend>rviz2</exec_depend>
</package>
""",
    "config/arm.srdf": """<robot name="arm">
  <group name="arm">
    <joint name="pan"/>
    <joint name="elbow"/>
  </group>
  <group_state name="home" group="arm">
    <joint name="elbow" value="0.5"/>
  </group_state>
  <disable_collisions link1="base" link2="upper" reason="Adjacent"/>
  <disable_collisions link1="hand" link2="left" reason="Adjacent"/>
</robot>
""",
    "config/controllers.yaml": """controller_manager:
  ros__parameters:
    arm_controller:
      type: joint_trajectory_controller/JointTrajectoryController
arm_controller:
  ros__parameters:
    joints:
      - pan
      - elbow
""",
    "launch/arm.launch": """<launch>
  <arg name="gui" default="true"/>
  <param name="robot_description" command="$(find xacro)/xacro $(find arm_description)/urdf/arm.urdf.xacro side:=right"/>
</launch>
""",
}


@dataclass(frozen=True, kw_only=True)
class Planted:
    """An edit of one file, and the only thing that must be reported."""

    file: str
    old: str
    new: str
    text: str
    """With the line."""
    back: str
    """What is said about the way back."""


CHANGES = {
    "a disabled pair": Planted(
        file="config/arm.srdf",
        old='  <disable_collisions link1="hand" link2="left" reason="Adjacent"/>\n',
        new="",
        text="srdf: disabled pair hand and left is gone (old/config/arm.srdf:10:3)",
        back="disabled pair hand and left is new",
    ),
    "a joint of a group": Planted(
        file="config/arm.srdf",
        old='    <joint name="elbow"/>\n',
        new="",
        text="srdf: joint elbow of group arm is gone (old/config/arm.srdf:4:5)",
        back="joint elbow of group arm is new",
    ),
    "a state": Planted(
        file="config/arm.srdf",
        old='value="0.5"',
        new='value="0.7"',
        text="srdf: joint elbow in state home of group arm changes: 0.5 → 0.7 (new/config/arm.srdf:7:5)",
        back="joint elbow in state home of group arm changes: 0.7 → 0.5",
    ),
    "a controller's joint": Planted(
        file="config/controllers.yaml",
        old="      - elbow\n",
        new="      - wrist\n",
        text="controllers: joint elbow of controller arm_controller is gone (old/config/controllers.yaml:9:9)",
        back="joint elbow of controller arm_controller is new",
    ),
    "a dependency": Planted(
        file="package.xml",
        old="  <exec_depend>rviz2</exec_depend>\n",
        new="",
        text="package: exec_depend rviz2 is gone (old/package.xml:5:3)",
        back="exec_depend rviz2 is new",
    ),
    "a default of a model": Planted(
        file="urdf/arm.urdf.xacro",
        old='default="left"',
        new='default="right"',
        text="argument: argument side changes: default 'left' → default 'right' (new/urdf/arm.urdf.xacro:2:3)",
        back="argument side changes: default 'right' → default 'left'",
    ),
    "a default of a launch file": Planted(
        file="launch/arm.launch",
        old='default="true"',
        new='default="false"',
        text="launch: argument gui changes: default 'true' → default 'false' (new/launch/arm.launch:2:3)",
        back="argument gui changes: default 'false' → default 'true'",
    ),
    "an argument that is passed": Planted(
        file="launch/arm.launch",
        old="side:=right",
        new="side:=left",
        text="launch: model arm.urdf.xacro changes: side:=right → side:=left (new/launch/arm.launch:3:44)",
        back="model arm.urdf.xacro changes: side:=left → side:=right",
    ),
}


def write_package(folder: Path, **changed: str) -> Path:
    for name, text in (FILES | changed).items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    return folder


def compare_packages(before: Path, after: Path, *, scene: bool = False) -> Diff:
    first, second = (make_request(path, codes={"INR003"}, scene=scene) for path in (before, after))
    return compare_versions(first, second, IN_THIS_PROCESS)


@pytest.mark.parametrize("planted", CHANGES.values(), ids=CHANGES)
def test_a_change_around_a_model_is_reported_with_its_line(
    tmp_path: Path, planted: Planted, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    text = FILES[planted.file]
    assert planted.old in text
    old = write_package(tmp_path / "old")
    new = write_package(tmp_path / "new", **{planted.file: text.replace(planted.old, planted.new)})
    there, back = compare_packages(old, new), compare_packages(new, old)
    assert there.failures == ()
    said = [f"{change.kind}: {describe_seam(change)}" for change in there.seams]
    assert said[:1] == [planted.text]
    assert len(said) == (2 if "wrist" in planted.new else 1)  # one joint goes, the other comes
    assert planted.back in {change.text for change in back.seams}
    assert there.verdict == "seams"


def test_order_and_notation_around_a_model_mean_nothing(tmp_path: Path) -> None:
    srdf = FILES["config/arm.srdf"].replace('link1="base" link2="upper"', 'link2="base"  link1="upper"')
    lines = srdf.splitlines(keepends=True)
    lines[8], lines[9] = lines[9], lines[8]
    old, new = write_package(tmp_path / "old"), write_package(tmp_path / "new", **{"config/arm.srdf": "".join(lines)})
    found = compare_packages(old, new)
    assert (found.seams, found.verdict) == ((), "identical")


def test_a_rename_tells_who_still_uses_the_old_name(tmp_path: Path) -> None:
    """The controllers follow, the groups do not."""
    renamed = {
        "urdf/arm.urdf.xacro": FILES["urdf/arm.urdf.xacro"].replace('"elbow"', '"elbow_joint"'),
        "config/controllers.yaml": FILES["config/controllers.yaml"].replace("- elbow", "- elbow_joint"),
    }
    found = compare_packages(write_package(tmp_path / "old"), write_package(tmp_path / "new", **renamed))
    assert [change.text for change in found.seams] == [
        "joint elbow of group arm: joint elbow is called elbow_joint now",
        "joint elbow in state home of group arm: joint elbow is called elbow_joint now",
    ]


def test_variants_are_compared_one_by_one(tmp_path: Path) -> None:
    """The forearm is longer for one value of an argument: its variant changes alone."""
    texts = [
        FILES["urdf/arm.urdf.xacro"].replace(
            '<origin xyz="0.3 0 0" rpy="0 0 0"/>',
            f"<origin xyz=\"${{0.3 if '$(arg side)' == 'left' else {reach}}} 0 0\"/>",
        )
        for reach in ("0.4", "0.5")
    ]
    launch = FILES["launch/arm.launch"]
    second = launch[launch.index("  <param") : launch.index("</launch>")].replace("right", "left")
    both = launch.replace("</launch>", f"{second}</launch>")
    paths = [
        write_package(tmp_path / side, **{"urdf/arm.urdf.xacro": text, "launch/arm.launch": both})
        for side, text in zip(("old", "new"), texts, strict=True)
    ]
    first, last = (make_request(path, codes={"INR003"}, all_arguments=True) for path in paths)
    found = compare_versions(first, last, IN_THIS_PROCESS)
    verdicts = {model.after.rpartition("/")[2]: model.verdict for model in found.models}
    assert verdicts == {"arm.urdf.xacro side:=left": "cosmetic", "arm.urdf.xacro side:=right": "kinematic"}


def test_files_around_models_can_fail_a_run(tmp_path: Path) -> None:
    planted = CHANGES["a dependency"]
    new = write_package(tmp_path / "new", **{planted.file: FILES[planted.file].replace(planted.old, planted.new)})
    found = compare_packages(write_package(tmp_path / "old"), new)
    reasons = {kind: make_gate([kind], None, None).list_reasons(found) for kind in ("seams", "any", "collision")}
    changed = ["files around the models change"]
    assert reasons == {"seams": changed, "any": changed, "collision": []}
