"""Inertials: which of two numbers is wrong is said only where it is known, and one defect is said once."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from builders import (
    arm_on_base,
    box,
    collision,
    cylinder,
    find,
    inertial,
    joint,
    limit,
    link,
    mesh,
    robot,
    sphere,
    visual,
)
from castings import write_stl

from urdfcheck.core import Finding, Severity
from urdfcheck.facts.inertials.hull_bounds import is_possible_elsewhere

# -- INR003, INR004 -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("drawn", "cause"), [(visual(cylinder(0.0325, 0.03)), None), ("", "digits")])
def test_digits_are_no_cause_where_the_drawn_part_is_another(tmp_path: Path, drawn: str, cause: str | None) -> None:
    """The wheel has 8.5e-5, 8.5e-5 and 1.32e-4, which does not round to 3e-4."""
    text = arm_on_base(inertial(0.25, ixx=0.0001, iyy=0.0001, izz=0.0003), drawn)
    (finding,) = find(tmp_path, text, {"INR003"})
    assert (finding.cause and finding.cause.id) == cause
    assert finding.fix is not None
    assert ('izz="0.000132"' in finding.fix.title) == bool(drawn)


@pytest.mark.parametrize(("value", "words"), [("0.5", "lost decimal point"), ("${m*0.5}", "correct the formula")])
def test_what_a_file_computes_was_not_copied(tmp_path: Path, value: str, words: str) -> None:
    tensor = f'<inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="{value}"/>'
    arm = f'<inertial><mass value="1"/>{tensor}</inertial>'
    text = robot('<xacro:property name="m" value="1"/>', link("base"), link("arm", arm), xacro=True)
    text = text.replace("</robot>", joint("j", "base", "arm", kind="continuous") + "</robot>")
    (finding,) = find(tmp_path, text, {"INR003"}, name="robot.urdf.xacro")
    assert finding.fix is not None
    assert words in finding.fix.title


@pytest.mark.parametrize("side", ["-1", "1"])
def test_one_line_of_a_macro_gets_no_numbers_that_are_right_for_one_side(tmp_path: Path, side: str) -> None:
    """All links of the line are named together."""
    tensor = '<inertia ixx="${m*0.1}" ixy="0" ixz="0" iyy="${m*0.1}" iyz="0" izz="${m*0.5}"/>'
    boxes = visual(box("0.1 0.2 0.1"), xyz="0 ${0.1*side} 0.1") + visual(box("0.1 0.1 0.1"))
    arm = link("${name}", f'<inertial><mass value="${{m}}"/>{tensor}</inertial>', boxes)
    turning = joint("j_${name}", "base", "${name}", kind="continuous")
    macro = f'<xacro:macro name="arm" params="name side">{arm}{turning}</xacro:macro>'
    calls = f'<xacro:arm name="left" side="1"/><xacro:arm name="right" side="{side}"/>'
    text = robot('<xacro:property name="m" value="1"/>', link("base"), macro, calls, xacro=True)
    (finding,) = find(tmp_path, text, {"INR003"}, name="robot.urdf.xacro")
    assert finding.message.startswith("left, right: principal moments")
    assert finding.headline.startswith("left, right: ")
    assert finding.fix is not None
    assert ('izz="' in finding.fix.title) == (side == "1")
    assert finding.fix.title.endswith("correct the formula that computes it")


def test_links_of_one_line_that_are_fixed_to_two_bodies_are_named_together(tmp_path: Path) -> None:
    tensor = '<inertia ixx="1e-4" ixy="0" ixz="0" iyy="1e-4" iyz="0" izz="3e-4"/>'
    camera = link("${on}_cam", f'<inertial><mass value="0.1"/>{tensor}</inertial>', visual(box("0.1 0.1 0.1")))
    macro = f'<xacro:macro name="cam" params="on">{camera}{joint("${on}_fix", "${on}", "${on}_cam")}</xacro:macro>'
    bodies = link("base", inertial(5)), link("head", inertial(3)), joint("neck", "base", "head", kind="continuous")
    text = robot(macro, *bodies, '<xacro:cam on="base"/><xacro:cam on="head"/>', xacro=True)
    (finding,) = find(tmp_path, text, {"INR003"}, name="robot.urdf.xacro")
    assert finding.message_id == "fused"
    assert finding.message.startswith("base_cam, head_cam: principal moments")


FORMULAS = ("${m*(y*y+z*z)/12}", "${m*(x*x+z*z)/12}", "${m*(x*x+z*z)/12}")
POWERS = ("${m/12*(d**2 + h**2)}", "${m/12*(w**2 + h**2)}", "${ m/12*(w**2+h**2) }")
ROUND = ("${m*(3*x*x+z*z)/12}", "${m*(3*x*x+z*z)/12}", "${m*x*x*4*2}")


@pytest.mark.parametrize(
    ("moments", "repair"),
    [
        (FORMULAS, "correct the formula of izz: it repeats that of iyy, but that of a box squares x and y"),
        (POWERS, "correct the formula of iyy or izz: they are the same, but one of a box squares d and w"),
        (ROUND, None),
    ],
)
def test_a_moment_of_a_box_that_repeats_another_is_named(
    tmp_path: Path, moments: tuple[str, str, str], repair: str | None
) -> None:
    xx, yy, zz = moments
    tensor = f'<inertia ixx="{xx}" ixy="0" ixz="0" iyy="{yy}" iyz="0" izz="{zz}"/>'
    lengths = {"x": 0.01, "y": 0.3, "z": 0.01, "w": 0.01, "d": 0.3, "h": 0.01, "m": 1}
    properties = "".join(f'<xacro:property name="{name}" value="{value}"/>' for name, value in lengths.items())
    arm = f'<inertial><mass value="1"/>{tensor}</inertial>'
    turning = joint("j", "base", "arm", kind="continuous")
    text = robot(properties, link("base"), link("arm", arm), turning, xacro=True)
    (finding,) = find(tmp_path, text, {"INR003"}, name="robot.urdf.xacro")
    assert finding.fix is not None
    assert finding.fix.title.startswith(repair or "compute the inertia tensor again")
    assert not finding.fix.edits


@pytest.mark.parametrize(("com", "has_com"), [("0.01 0 0", False), ("0 0.5 0", True)])
def test_a_tensor_that_is_replaced_brings_its_com(tmp_path: Path, com: str, has_com: bool) -> None:
    text = arm_on_base(inertial(1, 0.01, com=com, iyz=0.03), visual(box("0.2 0.1 0.1")))
    (finding,) = find(tmp_path, text, {"INR004"})
    assert finding.fix is not None
    assert ('xyz="0 0 0"' in finding.fix.title) == has_com


def test_a_point_that_draws_a_part_is_no_ball(tmp_path: Path) -> None:
    """A mesh of 0.1 kg and many cubic metres is no part of any material, so that no numbers are given."""
    write_stl(tmp_path / "part.stl", [((10.0, 10.0, 10.0), (0.0, 0.0, 0.0))])
    (finding,) = find(tmp_path, arm_on_base(inertial(0.1, 0), visual(mesh("part.stl"))), {"INR004"})
    assert finding.fix is not None
    assert finding.fix.title == "compute the tensor from the shape of the part and its mass"


def test_bullet_takes_inertias_from_the_shapes_unless_asked(tmp_path: Path) -> None:
    for number, text in enumerate((inertial(1, 0), inertial(1, ixx=0.1, iyy=0.1, izz=0.5), inertial(1, 1.0))):
        robot_text = arm_on_base(text, visual(box("0.1 0.2 0.3")))
        for finding in find(tmp_path / str(number), robot_text, {"INR003", "INR004", "INR005", "INR007"}):
            assert "URDF_USE_INERTIA_FROM_FILE" in dict(finding.consequences)["bullet"]


# -- INR005 -----------------------------------------------------------------------------------------------------------

ROD = visual(box("0.02 0.02 0.2"))  # along z, and uniform 0.0577 m of spread


@pytest.mark.parametrize(
    ("com", "moment", "message"),
    [("0 0 -0.1", 0.0016, "com"), ("0 0 -0.1", 0.01, "exceeds"), ("", 0.01, "exceeds")],
)
def test_a_tensor_may_be_right_about_another_com(tmp_path: Path, com: str, moment: float, message: str) -> None:
    text = arm_on_base(inertial(0.5, ixx=moment, iyy=moment * 1.01, izz=0.000033, com=com), ROD)
    (finding,) = find(tmp_path, text, {"INR005"})
    assert finding.message_id == message
    assert ("COM or tensor may be wrong" in finding.message) == (message == "com")


def test_a_variance_fits_about_the_middle_of_the_hull() -> None:
    points = [(x, y, z) for x in (0, 1) for y in (0, 2) for z in (0, 4)]
    assert is_possible_elsewhere(points, np.diag((0.25, 1.0, 4.0)))
    assert not is_possible_elsewhere(points, np.diag((0.25, 1.0, 4.01)))
    assert is_possible_elsewhere(points, np.diag((0.25, 1.0, 4.2)), ratio=1.1)
    assert is_possible_elsewhere(points, np.diag((0.25, 1.0, 4.2)), margin=0.1)
    # Of equal variances, rounding chooses the axes: those of the hull decide.
    noise = 1e-18 * np.array([[0.0, 1.0, -2.0], [1.0, 0.0, 3.0], [-2.0, 3.0, 0.0]])
    assert not is_possible_elsewhere(points, 0.5 * np.eye(3) + noise)


@pytest.mark.parametrize(("reach", "moment", "found"), [(0.2, 0.001, False), (0.02, 0.001, True), (0.2, 0.1, True)])
def test_a_collision_shape_alone_may_be_that_of_a_knee(
    tmp_path: Path, reach: float, moment: float, found: bool
) -> None:
    """A leg from its joint to the knee, of which only the knee collides: no numbers are those of the knee."""
    knee = collision(sphere(0.02), xyz=f"0 0 -{reach}")
    foot = link("foot", inertial(0.05, 1e-5), collision(sphere(0.01)))
    text = arm_on_base(
        inertial(0.2, ixx=moment, iyy=moment * 1.01, izz=3e-5, com=f"0 0 -{reach / 2}"),
        knee,
        more=foot + joint("knee", "arm", "foot", kind="continuous", xyz=f"0 0 -{reach}"),
    )
    findings = find(tmp_path, text, {"INR005"})
    assert [one.message_id for one in findings] == ["exceeds"] * found
    for finding in findings:
        assert finding.fix is not None
        assert "for comparison" not in finding.fix.title
        assert "collision shapes and joints" in finding.message


def test_a_frame_that_draws_nothing_has_no_mesh_to_compute_from(tmp_path: Path) -> None:
    text = arm_on_base(
        inertial(1, ixx=0.002, iyy=0.0021, izz=0.0015),
        visual(box("0.1 0.1 0.1")),
        more=link("mark", inertial(0.01, ixx=0.01, iyy=0.011, izz=0.012)) + joint("m", "arm", "mark"),
    )
    (finding,) = find(tmp_path, text, {"INR005"})
    assert finding.fix is not None
    assert "of a small part if the link is only a frame" in finding.fix.title
    assert "mesh" not in finding.fix.title


def test_a_wheel_whose_moments_are_about_the_wrong_axis_is_one_finding(tmp_path: Path) -> None:
    """A hoop of 0.15 m about z, for a wheel about y: turned, it is inside."""
    turned = visual(cylinder(0.15, 0.05), rpy="1.5707963267948966 0 0")
    for number, moment in enumerate((0.0225, 0.2)):
        wheel = inertial(2, ixx=moment, iyy=moment, izz=2 * moment), turned
        parts = [link("base", inertial(10, ixx=0.083, iyy=0.142, izz=0.208), visual(box("0.4 0.3 0.1")))]
        for side, place in (("left", "0 0.2 0"), ("right", "0 -0.2 0")):
            parts += [
                link(f"{side}_wheel", *wheel),
                joint(f"{side}_wheel_joint", "base", f"{side}_wheel", kind="continuous", xyz=place, axis="0 1 0"),
            ]
        found = {one.code for one in find(tmp_path / str(number), robot(*parts), {"INR005", "JNT015"})}
        assert found == ({"JNT015"} if moment < 0.1 else {"JNT015", "INR005"})


@pytest.mark.parametrize(("kind", "severity"), [("prismatic", Severity.INFO), ("continuous", Severity.WARNING)])
def test_what_only_slides_on_a_fixed_base_may_have_any_inertia(tmp_path: Path, kind: str, severity: Severity) -> None:
    text = robot(
        link("world"),
        link("cart", inertial(1, 0.1), visual(box("0.3 0.1 0.1"))),
        link("pole", inertial(0.3, ixx=0.004, iyy=0.0041, izz=0.0001), visual(box("0.02 0.02 0.4"))),
        joint("slide", "world", "cart", kind=kind, axis="0 1 0"),
        joint("swing", "cart", "pole", kind="continuous", axis="1 0 0"),
    )
    assert [found.severity for found in find(tmp_path, text, {"INR005"})] == [severity]


HEAVY_SLIDE = robot(
    link("rail", inertial(13, ixx=1.5, iyy=1.5, izz=0.03), visual(box("0.1 0.1 1"))),
    link("cart", inertial(0.3, ixx=1.5, iyy=1.5, izz=0.3), visual(box("0.1 0.1 0.05"))),
    joint("slide", "rail", "cart", limit(0, 0.8), kind="prismatic", axis="0 0 1"),
)


@pytest.mark.parametrize(
    ("above", "severity"),
    [
        ("", Severity.ERROR),
        (f"{link('world')}{joint('weld', 'world', 'rail')}", Severity.WARNING),
        (f"{link('world')}{joint('turn', 'world', 'rail', kind='continuous', axis='1 0 0')}", Severity.ERROR),
    ],
)
def test_a_vast_tensor_is_no_error_where_nothing_turns_it(tmp_path: Path, above: str, severity: Severity) -> None:
    (finding,) = find(tmp_path, HEAVY_SLIDE.replace("</robot>", f"{above}</robot>"), {"INR005"})
    assert (finding.message_id, finding.severity) == ("exceeds", severity)


def test_what_carries_a_slide_of_a_file_that_another_includes_may_stand_still(tmp_path: Path) -> None:
    whole = robot('<xacro:include filename="slide.xacro"/>', link("world"), joint("w", "world", "rail"), xacro=True)
    package = "<package><name>p</name><version>1.0.0</version></package>"
    files = {"slide.xacro": HEAVY_SLIDE, "robot.urdf.xacro": whole, "package.xml": package}
    (finding,) = find(tmp_path, files, {"INR005"}, name="slide.xacro")
    assert finding.severity is Severity.WARNING


@pytest.mark.parametrize(("moment", "severity"), [(1e-5, Severity.INFO), (1e-2, Severity.ERROR)])
def test_a_finger_of_small_inertia_is_carried_by_its_arm(tmp_path: Path, moment: float, severity: Severity) -> None:
    arm = inertial(1, ixx=0.0015, iyy=0.02, izz=0.02)
    parts = [
        link("base"),
        link("arm", arm, visual(box("0.5 0.1 0.1"))),
        joint("swing", "base", "arm", kind="continuous", axis="0 0 1"),
    ]
    for side in (1, -1):
        parts += [
            link(f"finger_{side}", inertial(1e-5, moment), visual(box("0.02 0.01 0.02"))),
            joint(f"grip_{side}", "arm", f"finger_{side}", limit(0, 0.02), kind="prismatic", axis=f"0 {side} 0"),
        ]
    (finding,) = find(tmp_path, robot(*parts), {"INR005"})
    assert (finding.message_id, finding.severity) == ("exceeds", severity)


@pytest.mark.parametrize(("moment", "code"), [(1e-5, "INR010"), (3.0, "INR005")])
def test_a_body_lighter_than_air_has_the_wrong_mass_where_its_tensor_is_possible(
    tmp_path: Path, moment: float, code: str
) -> None:
    """A cylinder that weighs 50 g in plastic, and has 1e-5 kg·m²."""
    text = arm_on_base(inertial(1e-5, moment), visual(cylinder(0.02, 0.04)), base=inertial(1, 0.01))
    assert [finding.code for finding in find(tmp_path, text, {"INR005", "INR010"})] == [code]


def test_one_light_mass_is_reported_once(tmp_path: Path) -> None:
    text = robot(link("block", inertial(1e-5, 1e-5), visual(cylinder(0.02, 0.04)), collision(cylinder(0.02, 0.04))))
    assert [one.code for one in find(tmp_path, text, {"INR005", "INR010", "INR015"})] == ["INR015"]


# -- INR007 -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("world", [[link("world")], []])
@pytest.mark.parametrize(("kind", "message"), [("prismatic", "bolted"), ("continuous", "placeholder")])
def test_what_only_slides_on_a_fixed_base_needs_no_inertia(
    tmp_path: Path, kind: str, message: str, world: list[str]
) -> None:
    drawn = visual(box("0.3 0.1 0.1"))
    pole = link("pole", inertial(0.3, ixx=0.004, iyy=0.0041, izz=0.0001), visual(box("0.02 0.02 0.4")))
    text = robot(
        *world,
        link("rail", inertial(5, ixx=0.1, iyy=0.2, izz=0.21), visual(box("0.1 0.7 0.1"))),
        link("cart", inertial(1, 0.1), drawn),
        pole,
        joint("weld", "world", "rail"),
        joint("slide", "rail", "cart", kind=kind, axis="0 1 0"),
        joint("swing", "cart", "pole", kind="continuous", axis="1 0 0"),
    )
    (finding,) = find(tmp_path, text, {"INR007"})
    assert finding.message_id == message


@pytest.mark.parametrize(("root", "message"), [("world", "bolted"), ("flange", "placeholder")])
def test_the_palm_of_a_gripper_needs_no_inertia_only_where_the_file_fixes_it_to_the_world(
    tmp_path: Path, root: str, message: str
) -> None:
    finger = inertial(0.5, ixx=1e-4, iyy=1.1e-4, izz=2e-5), visual(box("0.01 0.01 0.05"))
    text = robot(
        link(root),
        link("palm", inertial(1.5, 0.1), visual(box("0.1 0.1 0.1"))),
        link("left_finger", *finger),
        link("right_finger", *finger),
        joint("weld", root, "palm"),
        joint("left", "palm", "left_finger", kind="prismatic", xyz="0 0.02 0.07", axis="0 1 0"),
        joint("right", "palm", "right_finger", kind="prismatic", xyz="0 -0.02 0.07", axis="0 -1 0"),
    )
    (finding,) = find(tmp_path, text, {"INR007"})
    assert finding.message_id == message


@pytest.mark.parametrize(
    ("mass", "tensor", "found"), [(1e-4, 2e-5, False), (1e-4, 1e-4, True), (1e-3, 2e-5, False), (2e-3, 2e-5, True)]
)
def test_a_mark_of_a_gram_needs_no_inertia_of_its_own(tmp_path: Path, mass: float, tensor: float, found: bool) -> None:
    leg = link("leg", inertial(0.05, ixx=1.8e-4, iyy=1.8e-4, izz=2e-5), visual(box("0.02 0.02 0.2")))
    toe = link("toe", inertial(mass, tensor), visual(box("0.01 0.01 0.01")))
    joints = joint("hip", "base", "leg", kind="continuous"), joint("glue", "leg", "toe", xyz="0 0 -0.1")
    text = robot(link("base", inertial(1, 1)), leg, toe, *joints)
    assert ["toe" in f.message for f in find(tmp_path, text, {"INR007"})] == [True] * found


@pytest.mark.parametrize(("size", "found"), [("0.1 0.1 0.1", True), ("0.4 0.4 0.4", False)])
def test_a_tensor_is_not_too_small_for_a_drawing_that_no_material_is_light_enough_for(
    tmp_path: Path, size: str, found: bool
) -> None:
    text = arm_on_base(inertial(0.1, 1e-6), visual(box(size)))
    assert bool(find(tmp_path, text, {"INR007"})) == found


# -- INR008 -----------------------------------------------------------------------------------------------------------


def test_all_links_that_share_a_tensor_are_named_where_it_fits_none(tmp_path: Path) -> None:
    tensor = {"ixx": 0.0123456, "iyy": 0.0234567, "izz": 0.0198765}
    sizes = {"boom": "0.05 0.05 0.05", "cap": "0.4 0.02 0.02", "lid": "0.4 0.02 0.02"}
    parts = [link("base", inertial(5, 1))]
    for name, size in sizes.items():
        parts += [link(name, inertial(1, **tensor), visual(box(size)))]
        parts += [joint(f"j_{name}", "base", name, kind="continuous")]
    (finding,) = find(tmp_path, robot(*parts), {"INR008"})
    assert finding.message_id == "shared"
    assert [subject.split("/")[0] for subject in finding.subjects] == [f"link[{name}]" for name in sizes]
    assert all(name in finding.message for name in sizes)
    assert "at least one of the links" in dict(finding.consequences)["gazebo"]


# -- INR009 -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("size", "mass"), [(0.5, "0.05"), (2.0, "0.8")])
def test_another_size_and_another_mass_make_the_same_numbers(tmp_path: Path, size: float, mass: str) -> None:
    radius, length = 0.06 * size, 0.02 * size
    xx, zz = 0.2 * (3 * radius**2 + length**2) / 12, 0.2 * radius**2 / 2
    (finding,) = find(
        tmp_path, arm_on_base(inertial(0.2, ixx=xx, iyy=xx, izz=zz), visual(cylinder(0.06, 0.02))), {"INR009"}
    )
    assert finding.message_id == "size"
    assert f"those of the drawn part at {mass} kg" in finding.message
    assert finding.fix is not None
    assert not finding.fix.edits


# -- INR011, INR015 ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("palm", "messages"), [(1, []), (5000, ["light"])])
def test_a_stand_does_not_make_fingers_light(tmp_path: Path, palm: float, messages: list[str]) -> None:
    text = robot(
        link("stand", inertial(5000, 100)),
        link("palm", inertial(palm, 0.01)),
        link("finger", inertial(0.004, 1e-5)),
        joint("weld", "stand", "palm"),
        joint("knuckle", "palm", "finger", kind="continuous"),
    )
    found = find(tmp_path, text, {"INR011"})
    assert [one.message_id for one in found] == messages
    assert all("palm and what is fixed to it (10,000 kg)" in one.message for one in found)


def test_a_light_link_between_two_heavy_ones_is_one_finding(tmp_path: Path) -> None:
    text = robot(
        link("torso", inertial(30, 1)),
        link("cross", inertial(0.001, 1e-6)),
        link("arm", inertial(3, 0.1)),
        joint("a", "torso", "cross", kind="continuous"),
        joint("b", "cross", "arm", kind="continuous"),
    )
    assert [one.message_id for one in find(tmp_path, text, {"INR011"})] == ["heavy"]


@pytest.mark.parametrize(
    ("arm", "tip", "cause"),
    [("", inertial(0.0001, 1e-9), "none"), (inertial(0.00001, 1e-9), inertial(0.0001, 1e-9), None)],
)
def test_the_mass_of_a_marker_is_not_that_of_a_robot(tmp_path: Path, arm: str, tip: str, cause: str | None) -> None:
    """One of three bodies that move has a mass; with two of them the sum is reported, and no unit of round numbers."""
    text = arm_on_base(
        arm,
        visual(box("0.1 0.1 0.1")),
        more=link("hand", visual(box("0.1 0.1 0.1")))
        + link("tip", tip)
        + joint("k", "arm", "hand", kind="continuous")
        + joint("m", "hand", "tip", kind="continuous"),
    )
    found = find(tmp_path, text, {"INR015"})
    assert [one.message_id for one in found] == ([] if cause else ["light"])
    assert all(one.cause is None and one.severity == Severity.WARNING for one in found)


# -- INR002, DYN001, DYN006 -------------------------------------------------------------------------------------------


def test_mujoco_holds_every_root_still(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, arm_on_base(inertial(1, 0.1), base=inertial(0, 0.1)), {"INR002"})
    assert dict(finding.consequences)["mujoco"].startswith("loads it")


def test_the_inertia_that_is_enough_is_enough(tmp_path: Path) -> None:
    def chain(moment: float) -> str:
        return robot(
            link("base", inertial(1, 1)),
            link("dummy", inertial(0.001, moment)),
            link("load", inertial(1, 0.1)),
            joint("one", "base", "dummy", kind="continuous", axis="0 0 1"),
            joint("two", "dummy", "load", kind="continuous", axis="0 0 1"),
        )

    (finding,) = find(tmp_path, chain(1e-6), {"DYN001"})
    assert finding.fix is not None
    assert "kg·m² about every axis would make the number ten times smaller" in finding.fix.title
    assert not find(tmp_path, chain(float(finding.data["enough"])), {"DYN001"})


@pytest.mark.parametrize(("kind", "found"), [("fixed", ["touches"]), ("continuous", [])])
def test_a_wheel_stands_on_its_rollers(tmp_path: Path, kind: str, found: list[str]) -> None:
    """A part that turns on the wheel, below its rim, carries the robot."""
    rim = visual(cylinder(0.05, 0.02), rpy="1.5707963267948966 0 0") + collision(
        cylinder(0.05, 0.02), rpy="1.5707963267948966 0 0"
    )
    parts = [link("base_link", inertial(3, 0.03, com="0 0 0.1"), collision(box("0.3 0.2 0.08"), xyz="0 0 0.12"))]
    for name, place in (("left", "0 0.15 0.05"), ("right", "0 -0.15 0.05")):
        parts += [
            link(f"{name}_wheel", rim),
            joint(f"{name}_wheel_joint", "base_link", f"{name}_wheel", kind="continuous", xyz=place, axis="0 1 0"),
        ]
    for i, place in enumerate(("0.12 0 0.01", "-0.12 0 0.01")):
        parts += [
            link(f"caster_{i}", collision(sphere(0.01))),
            joint(f"caster_{i}_joint", "base_link", f"caster_{i}", xyz=place),
        ]
    parts += [
        link("peg", inertial(0.01, 1e-5), collision(sphere(0.01))),
        joint("peg_joint", "left_wheel", "peg", kind=kind, xyz="0 0 -0.045", axis="1 0 0"),
    ]
    assert [one.message_id for one in find(tmp_path, robot(*parts), {"DYN006"})] == found


def test_moments_that_are_all_below_the_drawn_part_s_are_not_too_large(tmp_path: Path) -> None:
    """A plate of 0.5 x 0.4 x 0.05 m has 0.68, 1.05 and 1.71 kg m² at 50 kg, and is too thin for one moment about all axes."""
    placeholder = inertial(50, 0.35, com="0 0 -0.02")
    (finding,) = find(tmp_path, arm_on_base(placeholder, visual(box("0.5 0.4 0.05"))), {"INR005"})
    assert finding.message_id == "uneven"
    assert "mm beyond the drawing" in finding.message


def find_light_hand(folder: Path, mass: float, *, size: float = 1.0) -> list[Finding]:
    numbers = inertial(mass, ixx=size * 8.76e-5, iyy=size * 5.4e-5, izz=size * 1.2e-4)
    return find(folder, arm_on_base(numbers, visual(box("0.06 0.08 0.03"))), {"INR005"})


def test_a_mass_of_milligrams_is_wrong_where_the_tensor_is_the_drawn_part_of_a_usual_density(tmp_path: Path) -> None:
    (finding,) = find_light_hand(tmp_path, 1.02e-6)
    assert (finding.message_id, finding.severity) == ("mass", Severity.ERROR)
    assert "at 0.144 kg" in finding.message


def test_no_part_is_missing_from_a_tensor_that_is_a_thousand_times_too_large(tmp_path: Path) -> None:
    (finding,) = find_light_hand(tmp_path, 1.02e-6, size=1e3)
    assert finding.message_id == "exceeds"
    assert finding.fix is not None
    assert "draw the parts" not in finding.fix.title
