"""Shapes: sizes, what collides, where it stands, and which meshes are too dense for it."""

from __future__ import annotations

from itertools import product
from math import cos, pi, sin
from pathlib import Path

import numpy as np
import pytest
from builders import find, inertial, joint, limit, link, robot

from urdfcheck.core import Finding, Severity, Verdict
from urdfcheck.facts.motion.kinematics import build_origin_transform


def cylinder(sides: int, radius: float = 0.03, length: float = 0.01) -> str:
    """A cylinder about z as OBJ: 4 sides - 4 triangles."""
    rim = [(radius * cos(2 * pi * i / sides), radius * sin(2 * pi * i / sides)) for i in range(sides)]
    corners = [f"v {x} {y} {z}" for z in (-length / 2, length / 2) for x, y in rim]
    around = [f"f {i + 1} {(i + 1) % sides + 1} {(i + 1) % sides + sides + 1} {i + sides + 1}" for i in range(sides)]
    caps = [
        "f " + " ".join(str(i) for i in range(sides, 0, -1)),
        "f " + " ".join(str(i + sides + 1) for i in range(sides)),
    ]
    return "\n".join((*corners, *around, *caps)) + "\n"


def shape(role: str, name: str, scale: str = "1 1 1") -> str:
    return f'<{role}><geometry><mesh filename="{name}" scale="{scale}"/></geometry></{role}>'


def find_dense_collision(folder: Path, content: str, parts: str) -> list[Finding]:
    """Return the findings on a link of these parts, beside two meshes with this content."""
    files = {"part.obj": content, "copy.obj": content, "robot.urdf": robot(link("a", parts))}
    return find(folder, files, "GEO004")


def geometry(role: str, inside: str, origin: str = "") -> str:
    return f"<{role}>{origin}<geometry>{inside}</geometry></{role}>"


def make_joint(parent: str, child: str, kind: str = "revolute", xyz: str = "0 0 0") -> str:
    return joint(f"{parent}_{child}", parent, child, limit(-1, 1), kind=kind, xyz=xyz, axis="0 1 0")


def box(role: str, size: str = "0.1 0.1 0.1", xyz: str = "0 0 0", rpy: str = "0 0 0") -> str:
    return geometry(role, f'<box size="{size}"/>', f'<origin xyz="{xyz}" rpy="{rpy}"/>')


# -- GEO001 ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "shape",
    [
        '<box size="0.1 -0.1 0.1"/>',
        '<box size="0 0.1 0.1"/>',
        '<sphere radius="-0.1"/>',
        '<cylinder radius="0" length="0.1"/>',
        '<cylinder radius="0.1" length="-0.1"/>',
        '<mesh filename="a.stl" scale="1 1 0"/>',
    ],
)
def test_a_shape_without_volume_is_an_error_where_it_collides(tmp_path: Path, shape: str) -> None:
    (finding,) = find(tmp_path, robot(link("a", geometry("collision", shape))), "GEO001")
    assert finding.severity is Severity.ERROR


@pytest.mark.parametrize(
    ("radius", "repair"),
    [
        ("-0.1", "write radius without the minus sign; to flip"),
        ("${0.1 - 0.2}", "make ${0.1 - 0.2} positive, or what it computes with; to flip"),
    ],
)
def test_a_negative_size_that_is_computed_has_no_minus_sign_to_delete(tmp_path: Path, radius: str, repair: str) -> None:
    text = robot(link("a", geometry("collision", f'<sphere radius="{radius}"/>')))
    text = text.replace("<robot ", '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" ')
    (finding,) = find(tmp_path, text, "GEO001", name="r.urdf.xacro")
    assert finding.fix is not None
    assert finding.fix.title.startswith(repair)


@pytest.mark.parametrize(
    ("targets", "severity"),
    [
        ((), Severity.WARNING),
        (("drake",), Severity.INFO),
        (("drake", "gazebo"), Severity.WARNING),
        (("drake", "mujoco"), Severity.ERROR),
    ],
)
@pytest.mark.parametrize("radius", ["0", "-0", "0.0"])
def test_a_sphere_without_radius_is_a_point_which_drake_means_and_mujoco_refuses(
    tmp_path: Path, radius: str, targets: tuple[str, ...], severity: Severity
) -> None:
    text = robot(link("a", geometry("collision", f'<sphere radius="{radius}"/>')))
    (finding,) = find(tmp_path, text, "GEO001", targets=targets)
    assert (finding.message_id, finding.severity) == ("point", severity)
    assert Verdict.from_sentence(finding.consequences["drake"]) == Verdict.LOADS
    assert not any("box" in sentence for sentence in finding.consequences.values())


def test_the_points_of_a_robot_are_one_finding(tmp_path: Path) -> None:
    point = geometry("collision", '<sphere radius="0"/>')
    text = robot(link("a", point, point), link("b", point), joint("j", "a", "b"))
    (finding,) = find(tmp_path, text, "GEO001")
    assert finding.message.startswith("3 collision spheres have radius 0 (a, b):")
    assert (len(finding.subjects), len(finding.related)) == (3, 2)


@pytest.mark.parametrize(
    ("shape", "severity"),
    [
        ('<sphere radius="0"/>', Severity.INFO),
        ('<sphere radius="-0.1"/>', Severity.ERROR),
        ('<mesh filename="a.stl" scale="1 1 0"/>', Severity.WARNING),
    ],
)
def test_what_is_only_drawn_may_be_nothing_but_not_negative(tmp_path: Path, shape: str, severity: Severity) -> None:
    (finding,) = find(tmp_path, robot(link("a", geometry("visual", shape))), "GEO001")
    assert finding.severity is severity


@pytest.mark.parametrize(
    "shape",
    [
        '<sphere radius="1e-9"/>',
        '<capsule radius="0.1" length="0"/>',
        '<mesh filename="a.stl" scale="-1 1 1"/>',
        '<mesh filename="a.stl"/>',
        '<box size="0.1 0.1"/>',
        "<box/>",
    ],
)
def test_what_is_small_round_mirrored_or_malformed_is_no_bad_dimension(tmp_path: Path, shape: str) -> None:
    assert not find(tmp_path, robot(link("a", geometry("collision", shape))), "GEO001")


def test_the_repair_takes_the_minus_signs_away(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, robot(link("a", geometry("collision", '<box size="0.1 -0.20 -3e-1"/>'))), "GEO001")
    assert finding.fix is not None
    assert [edit.replacement for edit in finding.fix.edits] == ["0.1 0.20 3e-1"]


# -- GEO002 ---------------------------------------------------------------------------------------------------------

BOTH = box("visual") + box("collision")
MASS = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'


def make_arm_with_hands(*hands: str) -> str:
    """A base, an arm that collides, and links that the arm moves, 1 m away."""
    found = link("base", BOTH) + link("arm", BOTH) + make_joint("base", "arm", xyz="0 0 1")
    for i, inside in enumerate(hands):
        found += link(f"hand{i}", inside) + make_joint("arm", f"hand{i}", xyz=f"0 {i} 1")
    return found


def test_a_moving_link_that_is_drawn_and_not_touched(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, robot(make_arm_with_hands(box("visual"), BOTH)), "GEO002")
    assert (finding.severity, finding.subjects) == (Severity.WARNING, ("link[hand0]",))


@pytest.mark.parametrize(
    ("name", "mass", "effort", "message"),
    [
        ("antenna", 0.001, 0, "light"),
        ("bumper", 0.001, 0, "missing"),
        ("antenna", 0.001, 2, "missing"),
        ("antenna", 0.1, 0, "missing"),
        ("finger", 0.001, 0, "missing"),
        ("front_wheel", 0.001, 0, "missing"),
    ],
)
def test_a_light_part_without_effort_is_an_info(
    tmp_path: Path, name: str, mass: float, effort: float, message: str
) -> None:
    parts = link("base", BOTH + MASS) + link("arm", BOTH + MASS) + make_joint("base", "arm", xyz="0 0 1")
    parts += link(name, box("visual") + MASS.replace('value="1"', f'value="{mass}"'))
    bounds = f'<limit lower="-1" upper="1" effort="{effort}" velocity="0"/>'
    parts += joint("j", "arm", name, bounds, kind="revolute", xyz="0 0 1", axis="0 1 0")
    (finding,) = find(tmp_path, robot(parts), "GEO002")
    assert (finding.message_id, finding.severity is Severity.INFO) == (message, message == "light")


@pytest.mark.parametrize(
    ("size", "hand", "message"),
    [(0.1, BOTH, "between"), (0.5, BOTH, "missing"), (0.1, "", "missing"), (0.1, box("visual"), "missing")],
    ids=["small", "large", "nothing behind", "bare behind"],
)
def test_a_small_piece_between_two_that_collide_is_an_info(
    tmp_path: Path, size: float, hand: str, message: str
) -> None:
    piece = geometry("visual", f'<box size="{size} {size} {size}"/>')
    parts = make_arm_with_hands(BOTH, BOTH, piece)
    if hand:
        parts += link("tip", hand) + make_joint("hand2", "tip", xyz="0 0 1")
    messages = {f.message_id: f.severity for f in find(tmp_path, robot(parts), "GEO002")}
    assert messages == {message: Severity.INFO if message == "between" else Severity.WARNING}


def test_a_small_piece_that_a_joint_of_gazebo_pins_to_a_part_is_between_the_two(tmp_path: Path) -> None:
    parts = make_arm_with_hands(BOTH, BOTH, geometry("visual", '<box size="0.1 0.1 0.1"/>'))
    loop = '<gazebo><joint name="loop" type="revolute"><parent>arm</parent><child>hand2</child></joint></gazebo>'
    (finding,) = find(tmp_path, robot(parts + loop), "GEO002")
    assert finding.message_id == "between"


def test_small_pieces_one_after_the_other_are_an_info(tmp_path: Path) -> None:
    """The yaw and the pitch of a waist or a wrist."""
    piece = geometry("visual", '<box size="0.1 0.1 0.1"/>')
    parts = make_arm_with_hands(BOTH, BOTH, piece)
    parts += link("pitch", piece) + make_joint("hand2", "pitch", xyz="0 0 0.1")
    assert {f.message_id for f in find(tmp_path / "end", robot(parts), "GEO002")} == {"missing"}
    parts += link("tip", BOTH) + make_joint("pitch", "tip", xyz="0 0 1")
    (finding,) = find(tmp_path, robot(parts), "GEO002")
    assert (finding.message_id, finding.data["links"]) == ("between", "hand2, pitch")


@pytest.mark.parametrize(("loaded", "message"), [("arm", "none"), ("simulated_arm", "aside")])
def test_a_drawing_beside_the_model_that_is_loaded_needs_no_collision(
    tmp_path: Path, loaded: str, message: str
) -> None:
    arm = link("base", box("visual")) + link("arm", box("visual") + MASS) + make_joint("base", "arm", xyz="0 0 1")
    files = {
        "package.xml": "<package><name>arm</name></package>",
        "launch/show.launch.py": f"load('{loaded}.urdf', 'gz_sim')",
        "arm.urdf": robot(arm),
    }
    assert [finding.message_id for finding in find(tmp_path, files, "GEO002", name="arm.urdf")] == [message]


@pytest.mark.parametrize(
    ("folder", "name", "message"),
    [("urdf", "arm", "none"), ("test", "arm", "drawing"), ("urdf", "bluerov", "drawing")],
)
def test_a_model_of_tests_and_one_that_swims_may_touch_nothing(
    tmp_path: Path, folder: str, name: str, message: str
) -> None:
    (tmp_path / folder).mkdir()
    arm = link("tool", box("visual")) + joint("j", "base", "tool", kind="continuous")
    (tmp_path / folder / "arm.srdf").write_text(
        f'<robot name="{name}"><group name="g"><joint name="j"/></group></robot>'
    )
    text = robot(link("base", box("visual")), arm, name=name)
    (finding,) = find(tmp_path / folder, text, "GEO002", name="arm.urdf")
    assert finding.message_id == message


@pytest.mark.parametrize(("bare", "messages"), [(("left", "right"), {"between"}), (("left",), {"missing"})])
def test_a_small_piece_that_only_one_side_lacks_was_forgotten(
    tmp_path: Path, bare: tuple[str, ...], messages: set[str]
) -> None:
    parts = link("base", BOTH) + link("head", BOTH) + make_joint("base", "head", xyz="0 0 2")
    for name, y in (("left", 1), ("right", -1)):
        shape = '<box size="0.1 0.1 0.1"/>'
        collision = "" if name in bare else geometry("collision", shape)
        parts += link(f"{name}_hip", geometry("visual", shape) + collision)
        parts += make_joint("base", f"{name}_hip", xyz=f"0 {y} 0")
        parts += link(f"{name}_leg", BOTH) + make_joint(f"{name}_hip", f"{name}_leg", xyz="0 0 -1")
    assert {f.message_id for f in find(tmp_path, robot(parts), "GEO002")} == messages


@pytest.mark.parametrize(
    ("sides", "hand", "messages"),
    [
        (("left", "right"), BOTH, {"pairs"}),
        (("left",), BOTH, {"missing"}),
        (("left", "right"), "", {"missing"}),  # the ends of the limbs
    ],
)
def test_what_is_left_out_on_both_sides_is_meant_unless_it_is_the_end(
    tmp_path: Path, sides: tuple[str, ...], hand: str, messages: set[str]
) -> None:
    parts = link("base", BOTH) + link("head", BOTH) + make_joint("base", "head", xyz="0 0 2")
    for name, y in (("left", 1), ("right", -1)):
        parts += link(f"{name}_arm", box("visual", "1 1 1") if name in sides else BOTH)
        parts += make_joint("base", f"{name}_arm", xyz=f"0 {y} 0")
        if hand:
            parts += link(f"{name}_hand", hand) + make_joint(f"{name}_arm", f"{name}_hand", xyz=f"0 {y} 0")
    if not hand:
        parts += link("tail", BOTH) + make_joint("base", "tail", xyz="-2 0 0")
    found = find(tmp_path, robot(parts), "GEO002")
    assert {f.message_id for f in found} == messages
    assert all((f.severity is Severity.INFO) == (f.message_id == "pairs") for f in found)


@pytest.mark.parametrize(
    "inside",
    ["", BOTH, box("collision"), geometry("visual", '<box size="0.005 0.001 0.001"/>')],
    ids=["frame", "both", "not drawn", "token"],
)
def test_nothing_is_missing(tmp_path: Path, inside: str) -> None:
    assert not find(tmp_path, robot(make_arm_with_hands(inside, BOTH)), "GEO002")


def test_collision_on_what_is_fixed_to_it_counts_in_both_directions(tmp_path: Path) -> None:
    pad = link("pad", box("collision")) + make_joint("hand0", "pad", "fixed")
    camera = link("camera", box("visual")) + make_joint("arm", "camera", "fixed")
    assert not find(tmp_path, robot(make_arm_with_hands(box("visual"), BOTH) + pad + camera), "GEO002")


def test_the_base_may_be_a_drawing(tmp_path: Path) -> None:
    parts = link("base", box("visual")) + link("arm", BOTH) + make_joint("base", "arm")
    assert not find(tmp_path, robot(parts), "GEO002")


@pytest.mark.parametrize(
    ("mass", "control", "message"),
    [
        ("", "", "drawing"),
        (MASS, "", "drawing"),  # by hand in another program: nothing shows a use of it
        (MASS, "<gazebo/>", "none"),
        ("", '<ros2_control name="a" type="system"/>', "drawing"),
        ("", "<gazebo/>", "drawing"),
    ],
)
def test_a_model_without_any_collision_is_one_info(tmp_path: Path, mass: str, control: str, message: str) -> None:
    parts = "".join(link(name, box("visual") + mass) for name in "abc") + make_joint("a", "b") + make_joint("b", "c")
    (finding,) = find(tmp_path, robot(parts + control), "GEO002")
    assert (finding.message_id, finding.severity, finding.data["bodies"]) == (message, Severity.INFO, 2)


def test_where_most_bodies_lack_it_the_author_chose(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, robot(make_arm_with_hands(box("visual"), box("visual"))), "GEO002")
    assert (finding.message_id, finding.severity) == ("most", Severity.INFO)
    (half,) = find(tmp_path / "half", robot(make_arm_with_hands(box("visual"))), "GEO002")
    assert half.message_id == "missing"


def test_a_marker_without_mass_needs_no_collision(tmp_path: Path) -> None:
    assert find(tmp_path / "a", robot(make_arm_with_hands(box("visual") + MASS, BOTH + MASS)), "GEO002")
    assert not find(tmp_path / "b", robot(make_arm_with_hands(box("visual"), BOTH + MASS)), "GEO002")


@pytest.mark.parametrize(("kind", "found"), [("continuous", False), ("revolute", True)])
def test_a_fork_that_carries_a_wheel_needs_no_collision(tmp_path: Path, kind: str, found: bool) -> None:
    wheel = link("wheel", BOTH) + make_joint("hand0", "wheel", kind, "0 0 1")
    assert bool(find(tmp_path, robot(make_arm_with_hands(box("visual"), BOTH) + wheel), "GEO002")) == found


@pytest.mark.parametrize(("size", "found"), [("0.09 0.09 0.11", False), ("0.09 0.09 0.15", True)])
@pytest.mark.parametrize("rpy", ["0 0 0", "0.3 -1 2"])
def test_a_rotor_inside_its_housing_needs_no_collision(tmp_path: Path, size: str, found: bool, rpy: str) -> None:
    """However the root is turned."""
    parts = (
        link("root") + link("base", BOTH) + link("rotor", box("visual", size)) + link("arm", BOTH)
        + f'<joint name="f" type="fixed"><parent link="root"/><child link="base"/><origin rpy="{rpy}"/></joint>'
        + make_joint("base", "rotor", "continuous") + make_joint("base", "arm", xyz="0 0 1")
    )  # fmt: skip
    assert bool(find(tmp_path, robot(parts), "GEO002")) == found


@pytest.mark.parametrize(("depth", "found"), [("0.1", False), ("0.13", True)])
def test_an_eye_inside_its_head_needs_no_collision(tmp_path: Path, depth: str, found: bool) -> None:
    """Also beyond the bare frame between its two axes."""
    parts = (
        link("root", BOTH) + link("head", BOTH) + link("frame") + link("eye", box("visual", "0.09 0.09 " + depth))
        + make_joint("root", "head", xyz="0 0 1") + make_joint("head", "frame") + make_joint("frame", "eye")
    )  # fmt: skip
    assert bool(find(tmp_path, robot(parts), "GEO002")) == found


# -- GEO003 ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("collision", "message"),
    [
        (box("collision", xyz="0.09 0 0"), None),
        (box("collision", xyz="0.11 0 0"), "apart"),
        (box("collision", "0.49 0.49 0.49"), None),
        (box("collision", "0.51 0.51 0.51"), "size"),
        (box("collision", "0.021 0.021 0.021"), None),
        (box("collision", "0.019 0.019 0.019"), "size"),
        (box("collision", "0.2 0.2 0.2", "0.1 0.1 0.1"), None),
        (box("collision", "0.1 0.1 0.001", "0 0 0.05"), None),
        (geometry("collision", '<sphere radius="0.05"/>', '<origin xyz="0.2 0 0"/>'), "apart"),
        (geometry("collision", '<cylinder radius="0.4" length="0.1"/>'), "size"),
        (geometry("collision", '<capsule radius="0.05" length="0.1"/>'), None),
    ],
)
def test_how_far_and_how_large(tmp_path: Path, collision: str, message: str | None) -> None:
    found = find(tmp_path, robot(link("a", box("visual") + collision)), "GEO003")
    assert [f.message_id for f in found] == ([message] if message else [])


@pytest.mark.parametrize(
    ("at", "found"),
    [("0 0.12 0", []), ("0 0.15 0", []), ("0 0.12 0.04", ["apart"]), ("0 0.2 0", ["apart"]), ("0 -0.12 0", ["apart"])],
)
def test_a_shape_about_the_next_joint_holds_what_the_next_link_draws(tmp_path: Path, at: str, found: list[str]) -> None:
    """The hips of some quadrupeds collide with a cylinder about the axis of the thigh."""
    hip = box("visual", "0.14 0.1 0.12") + geometry(
        "collision", '<cylinder radius="0.07" length="0.05"/>', f'<origin xyz="{at}" rpy="1.5708 0 0"/>'
    )
    thigh = box("visual", "0.15 0.08 0.3", "0 0 -0.08")
    turns = joint("thigh_joint", "hip", "thigh", limit(-1, 1), kind="revolute", xyz="0 0.12 0", axis="0 1 0")
    text = robot(link("hip", hip), link("thigh", thigh), turns)
    assert [f.message_id for f in find(tmp_path, text, "GEO003")] == found


def test_a_shape_that_strayed_along_its_own_axis_into_the_link_before_is_apart(tmp_path: Path) -> None:
    wheel = box("visual", "0.2 0.05 0.2", "0 0.1 0") + box("collision", "0.2 0.05 0.25", "0 -0.1 0")
    turns = joint("j", "base", "wheel", kind="continuous", xyz="0 0.3 0", axis="0 1 0")
    text = robot(
        link("base", box("visual", "0.5 0.5 0.3") + box("collision", "0.5 0.5 0.3")), link("wheel", wheel), turns
    )
    (finding,) = find(tmp_path, text, "GEO003")
    assert finding.message_id == "apart"
    assert "middle of the collision is 0.2 m from that of the visual" in finding.message


def test_a_shape_of_the_size_of_its_drawing_that_strayed_along_the_next_axis_is_apart(tmp_path: Path) -> None:
    column = box("visual", "0.1 0.1 0.2", "0 0 0.1") + box("collision", "0.1 0.1 0.22", "0 0 0.35")
    top = box("visual", "0.2 0.2 0.5", "0 0 0.25") + box("collision", "0.2 0.2 0.5", "0 0 0.25")
    turns = joint("j", "column", "top", kind="continuous", xyz="0 0 0.2", axis="0 0 1")
    (finding,) = find(tmp_path, robot(link("column", column), link("top", top), turns), "GEO003")
    assert finding.message_id == "apart"


def test_which_of_the_two_is_out_of_place_is_left_open(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, robot(link("a", box("visual", xyz="0.3 0 0") + box("collision"))), "GEO003")
    assert finding.fix is not None
    assert finding.fix.title.endswith("or the reverse if the visual is out of place")


@pytest.mark.parametrize(("size", "said"), [("0.6 0.6 0.6", "its scale"), ("0.8 0.1 0.8", "one edge agrees")])
def test_a_scale_is_no_explanation_where_one_dimension_agrees(tmp_path: Path, size: str, said: str) -> None:
    (finding,) = find(tmp_path, robot(link("a", box("visual") + box("collision", size))), "GEO003")
    assert finding.fix is not None
    assert said in finding.fix.title


@pytest.mark.parametrize(("at", "severity"), [("0 0 0", Severity.INFO), ("0.7 0 0", Severity.WARNING)])
def test_several_primitives_around_a_part_may_keep_others_away(tmp_path: Path, at: str, severity: Severity) -> None:
    disc = geometry("collision", '<cylinder radius="0.7" length="0.12"/>', f'<origin xyz="{at}"/>')
    lone = robot(link("a", box("visual") + disc))
    assert [f.severity for f in find(tmp_path / "lone", lone, "GEO003")] == [Severity.WARNING]
    post = box("collision", "0.1 0.1 0.1", at)
    (finding,) = find(tmp_path / "several", robot(link("a", box("visual") + disc + post)), "GEO003")
    assert finding.severity is severity
    assert finding.fix is not None
    assert finding.fix.title.startswith("nothing if more room") == (severity is Severity.INFO)


@pytest.mark.parametrize(
    ("scale", "units"),
    [
        ("1 1 1", "millimetres and metres"),
        ("0.0254 0.0254 0.0254", "inches and millimetres"),
        ("0.00001 0.00001 0.00001", "centimetres and metres"),
        ("0.007 0.007 0.007", None),
    ],
)
def test_the_factor_of_a_forgotten_scale_is_named(tmp_path: Path, scale: str, units: str | None) -> None:
    (tmp_path / "part.obj").write_text(cylinder(16, 30, 10))
    inside = geometry("visual", '<cylinder radius="0.03" length="0.01"/>') + shape("collision", "part.obj", scale)
    (finding,) = find(tmp_path, robot(link("a", inside)), "GEO003")
    assert (finding.cause and finding.data["units"]) == units


@pytest.mark.parametrize(("left", "named"), [("sole", True), ("ankle", False), ("", False)])
def test_a_shape_on_the_wrong_link_is_moved_to_the_one_that_its_counterpart_shows(
    tmp_path: Path, left: str, named: bool
) -> None:
    """The frame of the sole is 30 mm below that of the ankle; both feet draw the same."""
    parts = [link("pelvis", "")]
    for side, y, owner in (("left", 0.1, left), ("right", -0.1, "ankle")):
        for part, xyz, parent in (("ankle", f"0 {y} -0.8", "pelvis"), ("sole", "0 0 -0.03", f"{side}_ankle")):
            z = -0.055 if part == "ankle" else -0.025
            drawn = (
                box("visual", "0.02 0.03 0.03") if part == "ankle" else box("visual", "0.24 0.09 0.05", "0.03 0 -0.02")
            )
            solid = box("collision", "0.24 0.08 0.04", f"0.03 0 {z}") if owner == part else ""
            parts += [link(f"{side}_{part}", drawn + solid), make_joint(parent, f"{side}_{part}", "revolute", xyz)]
    found = [f for f in find(tmp_path, robot("".join(parts)), "GEO003") if "right" in f.location.subject]
    (finding,) = found
    assert (finding.cause is not None and finding.cause.id == "neighbour") is named
    assert finding.fix is not None
    assert ("move the <collision> to right_sole" in finding.fix.title) is named


@pytest.mark.parametrize(("size", "is_scale"), [("0.02 0.02 0.02", True), ("1.5 0.1 9", False)])
def test_a_scale_changes_all_edges(tmp_path: Path, size: str, is_scale: bool) -> None:
    (finding,) = find(tmp_path, robot(link("a", box("visual", size) + box("collision", "0.3 0.1 0.15"))), "GEO003")
    assert finding.fix is not None
    assert ("check its scale first" in finding.fix.title) is is_scale


@pytest.mark.parametrize("rpy", ["0 0 0", "0.4 0 0", "1 -0.7 2.5"])
def test_the_verdict_does_not_change_with_the_frame(tmp_path: Path, rpy: str) -> None:
    """Two cubes 0.5 m apart stay apart, and one inside the other stays inside, however their link's frame is turned."""
    turn = build_origin_transform((0, 0, 0), [float(w) for w in rpy.split()])[:3, :3]
    for distance, found in ((0.5, True), (0.02, False)):
        xyz = " ".join(f"{v:.9f}" for v in turn @ np.array([distance, 0, 0]))
        inside = box("visual", rpy=rpy) + box("collision", xyz=xyz, rpy=rpy)
        assert bool(find(tmp_path, robot(link("a", inside)), "GEO003")) == found


def test_what_one_link_draws_another_that_is_fixed_to_it_may_collide_with(tmp_path: Path) -> None:
    """The footprint of a mobile base: its own collision is the base's, a metre above it."""
    foot = link("foot", box("visual", "0.02 0.02 0.02") + box("collision", "1 1 1", "0 0 1"))
    base = link("base", box("visual", "1 1 1"))
    assert find(tmp_path / "a", robot(foot + base + make_joint("foot", "base", "revolute", "0 0 1")), "GEO003")
    assert not find(tmp_path / "b", robot(foot + base + make_joint("foot", "base", "fixed", "0 0 1")), "GEO003")


@pytest.mark.parametrize(
    ("drawn", "message"),
    [
        (("0.28 0.25 0.1", "0.3 0.2 0.1", "0.2 0.2 0.2"), "token"),
        (("0.28 0.25 0.1", "0.28 0.25 0.1", "0.28 0.25 0.1"), "size"),  # of one macro
        (("0.28 0.25 0.1", "0.3 0.2 0.1"), "size"),
    ],
)
def test_a_small_box_in_several_different_parts_is_a_token(
    tmp_path: Path, drawn: tuple[str, ...], message: str
) -> None:
    links = [
        link(
            str(i), geometry("visual", f'<box size="{size}"/>') + geometry("collision", '<box size="0.01 0.01 0.01"/>')
        )
        for i, size in enumerate(drawn)
    ]
    joints = [joint(f"j{i}", "0", str(i), kind="continuous", xyz=f"{i} 0 0") for i in range(1, len(drawn))]
    findings = find(tmp_path, robot(*links, *joints), "GEO003")
    assert {f.message_id for f in findings} == {message}
    assert all(f.fix is not None and f.fix.title.startswith("nothing if so little of it") for f in findings)


@pytest.mark.parametrize("role", ["visual", "collision"])
def test_a_token_stands_for_nothing(tmp_path: Path, role: str) -> None:
    other = {"visual": "collision", "collision": "visual"}[role]
    token = geometry(role, '<box size="0.001 0.001 0.001"/>')
    assert not find(tmp_path, robot(link("a", box(other) + token)), "GEO003")


def collada(size: float, unit: float, up: str) -> str:
    """A slab of 2 x 1 x 4 times ``size``."""
    corners = " ".join(f"{x * size} {y * size} {z * size}" for x, y, z in product((0, 2), (0, 1), (0, 4)))
    faces = "0 1 3 0 3 2 4 6 7 4 7 5 0 4 5 0 5 1 2 3 7 2 7 6 0 2 6 0 6 4 1 5 7 1 7 3"
    return f"""<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit meter="{unit}"/><up_axis>{up}</up_axis></asset>
<library_geometries><geometry id="g"><mesh><source id="s"><float_array id="a" count="24">{corners}</float_array>
<technique_common><accessor source="#a" count="8" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#s"/></vertices>
<triangles count="12"><input semantic="VERTEX" source="#v" offset="0"/><p>{faces}</p></triangles></mesh></geometry>
</library_geometries><library_visual_scenes><visual_scene id="scene"><node><instance_geometry url="#g"/></node></visual_scene>
</library_visual_scenes><scene><instance_visual_scene url="#scene"/></scene></COLLADA>"""


@pytest.mark.parametrize(
    ("size", "unit", "up", "found"),
    [
        (0.1, 1, "Z_UP", False),
        (100, 0.001, "Z_UP", False),
        (0.1, 0.001, "Z_UP", False),
        (100, 1, "Z_UP", True),
        (0.1, 1, "Y_UP", False),
    ],
)
def test_a_unit_that_programs_treat_differently_is_another_rules_business(
    tmp_path: Path, size: float, unit: float, up: str, found: bool
) -> None:
    (tmp_path / "slab.dae").write_text(collada(size, unit, up))
    inside = shape("visual", "slab.dae") + box("collision", "0.2 0.1 0.4", "0.1 0.05 0.2")
    assert bool(find(tmp_path, robot(link("a", inside)), "GEO003")) == found


def test_a_mesh_that_lies_down_when_y_is_taken_for_up(tmp_path: Path) -> None:
    (tmp_path / "slab.dae").write_text(collada(0.1, 1, "Y_UP"))
    upright = shape("visual", "slab.dae") + box("collision", "0.2 0.4 0.1", "0.1 -0.2 0.05")
    elsewhere = shape("visual", "slab.dae") + box("collision", "0.2 0.4 0.1", "0.1 -0.9 0.05")
    assert not find(tmp_path, robot(link("a", upright)), "GEO003")
    assert find(tmp_path, robot(link("a", elsewhere)), "GEO003")


def test_a_mesh_that_cannot_be_read_decides_nothing(tmp_path: Path) -> None:
    assert not find(tmp_path, robot(link("a", box("visual") + shape("collision", "missing.stl"))), "GEO003")


# -- GEO005 ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("place", "gap"), [("0 0 0", ""), ("0 0.2 0", "0.2 m")])
def test_an_angle_in_degrees_is_neither_measured_nor_copied(tmp_path: Path, place: str, gap: str) -> None:
    shape = '<geometry><box size="0.1 0.2 0.3"/></geometry>'
    drawn = f'<visual><origin xyz="0 0 0" rpy="0 0 200"/>{shape}</visual>'
    inside = f'{drawn}<collision><origin xyz="{place}" rpy="0 0 0"/>{shape}</collision>'
    found = find(tmp_path, robot(link("a", inside)), "GEO005")
    assert [finding.data["gap"] for finding in found] == [gap] * bool(gap)
    assert not any(finding.fix is not None and finding.fix.edits for finding in found)


def placed(role: str, origin: str = "", name: str = "part.stl", scale: str = "1 1 1") -> str:
    return geometry(role, f'<mesh filename="{name}" scale="{scale}"/>', origin)


@pytest.mark.parametrize(
    ("visual", "collision", "found"),
    [
        ("", '<origin xyz="0 0 0"/>', False),
        ("", '<origin xyz="0 0 9e-5"/>', False),
        ("", '<origin xyz="0 0 1.1e-4"/>', True),
        ('<origin rpy="1.5708 0 0"/>', '<origin rpy="1.57 0 0"/>', False),
        ('<origin rpy="1.5708 0 0"/>', '<origin rpy="1.568 0 0"/>', True),
        ('<origin rpy="3.14159265 0 0"/>', '<origin rpy="-3.14159265 0 0"/>', False),
        ('<origin rpy="0 0 3.14159265"/>', "", True),
    ],
)
def test_how_far_origins_may_differ(tmp_path: Path, visual: str, collision: str, found: bool) -> None:
    inside = placed("visual", visual) + placed("collision", collision)
    assert bool(find(tmp_path, robot(link("a", inside)), "GEO005")) == found


def test_how_far_origins_are_apart_orders_the_findings(tmp_path: Path) -> None:
    places = {"a": "0.02 0 0", "b": "0.05 0 0"}
    parts = [link(name, box("visual") + box("collision", xyz=xyz)) for name, xyz in places.items()]
    found = find(tmp_path, robot(*parts, joint("j", "a", "b")), "GEO005")
    assert sorted(finding.excess for finding in found) == [0.02, 0.05]


@pytest.mark.parametrize(
    ("solid", "origin", "found"),
    [
        ('<cylinder radius="0.01" length="0.06"/>', 'xyz="0 0 0.001"', False),
        ('<cylinder radius="0.01" length="0.06"/>', 'xyz="0 0 0.0011"', True),
        ('<cylinder radius="0.01" length="0.06"/>', 'xyz="0 0 0.001" rpy="0.1 0 0"', True),
        ('<mesh filename="part.stl"/>', 'xyz="0 0 0.001"', True),
    ],
)
def test_a_millimetre_between_primitives_changes_nothing(tmp_path: Path, solid: str, origin: str, found: bool) -> None:
    inside = geometry("visual", solid, f"<origin {origin}/>") + geometry("collision", solid, "")
    assert bool(find(tmp_path, robot(link("a", inside)), "GEO005")) == found


@pytest.mark.parametrize(("moved", "severity"), [("0.0099", Severity.INFO), ("0.0101", Severity.WARNING)])
def test_more_than_a_centimetre_is_a_warning(tmp_path: Path, moved: str, severity: Severity) -> None:
    inside = placed("visual") + placed("collision", f'<origin xyz="{moved} 0 0"/>')
    (finding,) = find(tmp_path, robot(link("a", inside)), "GEO005")
    assert finding.severity == severity


@pytest.mark.parametrize(("rpy", "severity"), [("0.099 0 0", Severity.INFO), ("2.0944 0 0", Severity.WARNING)])
def test_a_part_that_is_turned_is_a_warning(tmp_path: Path, rpy: str, severity: Severity) -> None:
    inside = placed("visual") + placed("collision", f'<origin rpy="{rpy}"/>')
    (finding,) = find(tmp_path, robot(link("a", inside)), "GEO005")
    assert finding.severity == severity


def test_a_shape_where_a_neighbour_is_drawn_may_be_meant_for_it(tmp_path: Path) -> None:
    far = box("collision", "0.1 0.1 0.3", "0 0 0.5")
    parts = [
        link("base", box("visual", "0.1 0.1 0.1") + far),
        link("arm", box("visual", "0.1 0.1 0.3") + box("collision", "0.1 0.1 0.3")),
        make_joint("base", "arm", "revolute", "0.3 0 0.5"),
    ]
    (alone,) = find(tmp_path / "alone", robot("".join(parts)), "GEO003")
    assert alone.severity is Severity.WARNING
    parts[-1] = make_joint("base", "arm", "revolute", "0 0.05 0.5")
    (finding,) = find(tmp_path / "there", robot("".join(parts)), "GEO003")
    assert (finding.message_id, finding.severity) == ("apart", Severity.INFO)
    assert finding.fix is not None
    assert finding.fix.title.startswith("nothing if it is meant for arm, which is drawn there; otherwise give")


@pytest.mark.parametrize(("radius", "height", "found"), [(0.06, 0.15, False), (0.06, 0.6, True), (0.5, 0.15, True)])
def test_a_neighbour_that_stands_for_a_part_covers_it(
    tmp_path: Path, radius: float, height: float, found: bool
) -> None:
    """Only where it is about as large, and where the part is drawn."""
    stand_in = geometry("collision", f'<cylinder radius="{radius}" length="0.27"/>', f'<origin xyz="0 0 {height}"/>')
    arm = geometry("visual", '<cylinder radius="0.07" length="0.25"/>', '<origin xyz="0 0 0.15"/>')
    own = geometry("collision", '<cylinder radius="0.06" length="0.1"/>', '<origin xyz="0 0 -0.2"/>')
    text = robot(
        link("shoulder"),
        link("shape", stand_in),
        link("arm", arm + own),
        joint("mount", "shoulder", "shape"),
        joint("roll", "shoulder", "arm", kind="continuous"),
    )
    assert bool(find(tmp_path, text, "GEO003")) == found


@pytest.mark.parametrize(
    ("inside", "rpy", "found"),
    [
        ('<sphere radius="0.1"/>', "1 2 3", False),
        ('<cylinder radius="0.1" length="0.3"/>', "0 0 1", False),
        ('<cylinder radius="0.1" length="0.3"/>', "3.141592653589793 0 1", False),
        ('<cylinder radius="0.1" length="0.3"/>', "0.1 0 1", True),
        ('<box size="0.1 0.1 0.3"/>', "0 0 1.5707963267948966", False),
        ('<box size="0.1 0.2 0.3"/>', "0 0 1.5707963267948966", True),
        ('<box size="0.1 0.2 0.3"/>', "0 0 3.141592653589793", False),
        ('<box size="0.1 0.1 0.1"/>', "1.5707963267948966 0 1.5707963267948966", False),
        ('<box size="0.1 0.1 0.1"/>', "0 0 0.7", True),
        ('<box size="0.004 0.004 0.004"/>', "0 0 0.7", False),
    ],
)
def test_a_rotation_that_leaves_a_primitive_as_it_is_does_not_count(
    tmp_path: Path, inside: str, rpy: str, found: bool
) -> None:
    one = link("a", geometry("visual", inside), geometry("collision", inside, f'<origin rpy="{rpy}"/>'))
    assert bool(find(tmp_path, robot(one), "GEO005")) == found


@pytest.mark.parametrize(
    ("xyz", "rpy", "cause"),
    [
        ("0 1.57 0", "0 0 0", "rpy_in_xyz"),
        ("0 1.57 0", "0 1.57 0", None),  # copied, not mistaken
        ("0 1.5 0", "0 0 0", None),
    ],
)
def test_angles_in_the_place_of_the_position_are_named(tmp_path: Path, xyz: str, rpy: str, cause: str | None) -> None:
    part = '<box size="0.1 0.2 0.3"/>'
    drawn = geometry("visual", part, '<origin xyz="0 0 0" rpy="0 1.57 0"/>')
    text = robot(link("a", drawn, geometry("collision", part, f'<origin xyz="{xyz}" rpy="{rpy}"/>')))
    (finding,) = find(tmp_path, text, {"GEO003", "GEO005"})
    assert finding.code == "GEO005"
    assert finding.data["hides"] == ["GEO003"]
    assert (finding.cause.id if finding.cause else None) == cause


def test_another_file_or_scale_has_a_place_of_its_own(tmp_path: Path) -> None:
    moved = '<origin xyz="1 0 0"/>'
    assert not find(tmp_path, robot(link("a", placed("visual") + placed("collision", moved, "other.stl"))), "GEO005")
    assert not find(
        tmp_path, robot(link("a", placed("visual") + placed("collision", moved, scale="1.1 1.1 1.1"))), "GEO005"
    )


def test_only_the_foot_that_has_no_drawing_is_reported(tmp_path: Path) -> None:
    feet = ['<origin xyz="0 0 0"/>', '<origin xyz="1 0 0"/>', '<origin xyz="2 0 0"/>']
    drawn = "".join(placed("visual", foot) for foot in feet)
    moved = [feet[2], '<origin xyz="1 0 0.01"/>', feet[0]]
    (finding,) = find(
        tmp_path, robot(link("a", drawn + "".join(placed("collision", foot) for foot in moved))), "GEO005"
    )
    assert finding.data["moved"] == 0.01
    assert finding.fix is not None
    assert [(e.expected, e.replacement) for e in finding.fix.edits] == [("1 0 0.01", "1 0 0")]


# -- GEO004 ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("sides", "dense"), [(126, False), (127, True)])
def test_dense_begins_above_500_triangles(tmp_path: Path, sides: int, dense: bool) -> None:
    link = shape("visual", "part.obj") + shape("collision", "part.obj")
    assert bool(find_dense_collision(tmp_path, cylinder(sides), link)) == dense


def test_a_collision_mesh_of_its_own_is_no_copy_of_the_drawing(tmp_path: Path) -> None:
    assert not find_dense_collision(
        tmp_path, cylinder(200), shape("visual", "part.obj") + shape("collision", "copy.obj")
    )


def test_a_cylinder_is_recognised_with_its_size_in_metres(tmp_path: Path) -> None:
    scale = "0.001 0.001 0.001"
    link = shape("visual", "part.obj", scale) + shape("collision", "part.obj", scale)
    (finding,) = find_dense_collision(tmp_path, cylinder(200, 30, 10), link)
    assert finding.fix is not None
    assert '<cylinder radius="0.030" length="0.010"/> along z' in finding.fix.title


def test_a_surface_that_is_stored_from_both_sides_is_dense_and_fits_nothing(tmp_path: Path) -> None:
    sheet = "".join(f"v {x} {y} {0.01 * sin(7 * x * y)}\n" for x, y in product(range(20), range(20)))
    corners = [(20 * x + y + 1, 20 * x + y + 21, 20 * x + y + 22) for x, y in product(range(19), range(19))]
    both = "".join(f"f {a} {b} {c}\nf {c} {b} {a}\n" for a, b, c in corners)
    link = shape("visual", "part.obj") + shape("collision", "part.obj")
    assert [finding.message_id for finding in find_dense_collision(tmp_path, sheet + both, link)] == ["dense"]


def test_a_cylinder_that_the_scale_flattens_is_none(tmp_path: Path) -> None:
    link = shape("visual", "part.obj", "1 2 1") + shape("collision", "part.obj", "1 2 1")
    (finding,) = find_dense_collision(tmp_path, cylinder(200), link)
    assert finding.message_id == "dense"


def test_a_robot_without_a_name_is_the_robot(tmp_path: Path) -> None:
    parts = [
        link("base", inertial()),
        link("arm", inertial(), box("visual")),
        joint("j", "base", "arm", kind="continuous"),
    ]
    (finding,) = find(tmp_path, robot(*parts, name=""), "GEO002")
    assert finding.headline == "the robot: no moving body has a <collision>"


@pytest.mark.parametrize("kind", ["fixed", "continuous"])
@pytest.mark.parametrize(("tyre", "found"), [(0.086, False), (0.066, True)])
def test_a_rim_and_its_tyre_are_one_wheel(tmp_path: Path, kind: str, tyre: float, found: bool) -> None:
    """The rim's link collides as the tyre, which another link about the same axle draws, with a token for a collision."""

    def disc(role: str, radius: float) -> str:
        return geometry(role, f'<cylinder radius="{radius}" length="0.04"/>', '<origin rpy="1.5708 0 0"/>')

    parts = [link("base", geometry("visual", '<box size="0.4 0.2 0.1"/>', '<origin xyz="0 0 0.05"/>'))]
    for side, y in (("left", 0.15), ("right", -0.15)):
        rim, outside = f"{side}_wheel", f"{side}_wheel_tyre"
        parts += [
            link(rim, disc("visual", 0.065) + disc("collision", 0.085)),
            link(outside, disc("visual", tyre) + geometry("collision", '<sphere radius="0.001"/>')),
            f'<joint name="{rim}_joint" type="continuous"><parent link="base"/><child link="{rim}"/>'
            f'<origin xyz="0 {y} 0"/><axis xyz="0 1 0"/></joint>',
            f'<joint name="{outside}_joint" type="{kind}"><parent link="{rim}"/><child link="{outside}"/>'
            '<axis xyz="0 1 0"/></joint>',
        ]
    assert bool(find(tmp_path, robot("".join(parts)), "GEO003")) == found


# -- GEO005 ---------------------------------------------------------------------------------------------------------

SLAB = "\n".join(
    (
        *(f"v {x} {y} {z}" for x, y, z in product((0, 0.1), (0, 0.05), (0, 0.3))),
        *[
            "f 1 2 4",
            "f 1 4 3",
            "f 5 7 8",
            "f 5 8 6",
            "f 1 5 6",
            "f 1 6 2",
            "f 3 4 8",
            "f 3 8 7",
            "f 1 3 7",
            "f 1 7 5",
            "f 2 6 8",
            "f 2 8 4",
        ],
    )
)


@pytest.mark.parametrize(
    ("turns", "com", "severity"),
    [
        (("-1.5708 0 0",) * 3, "0.05 0.025 0.15", Severity.INFO),
        # Then what collides and weighs is not known to be right.
        (("-1.5708 0 0",) * 3, "0 0 0", Severity.WARNING),
        # One part was moved, and its collision left behind.
        (("-1.5708 0 0", "0 0 0", "0 0 0"), "0.05 0.025 0.15", Severity.WARNING),
    ],
)
def test_visuals_that_are_all_rotated_for_a_viewer(
    tmp_path: Path, turns: tuple[str, ...], com: str, severity: Severity
) -> None:
    (tmp_path / "slab.obj").write_text(SLAB)
    mesh = '<mesh filename="slab.obj"/>'
    parts = [
        link(
            name,
            inertial(1, 0.01, com=com),
            geometry("visual", mesh, f'<origin rpy="{turn}"/>'),
            geometry("collision", mesh, '<origin rpy="0 0 0"/>'),
        )
        for name, turn in zip("abc", turns, strict=True)
    ]
    found = find(tmp_path, robot(*parts, make_joint("a", "b"), make_joint("b", "c")), "GEO005")
    assert found
    assert {finding.severity for finding in found} == {severity}
    assert bool(found[0].fix and found[0].fix.edits) == (com == "0 0 0")


@pytest.mark.parametrize(("sensor", "severity"), [("camera", Severity.INFO), ("", Severity.WARNING)])
def test_what_only_carries_a_sensor_may_collide_elsewhere(tmp_path: Path, sensor: str, severity: Severity) -> None:
    shapes = box("visual", "0.02 0.03 0.07") + box("collision", "0.02 0.03 0.07", "0 0 0.05")
    block = f"<gazebo reference='lens'><sensor name='s' type='{sensor}'/></gazebo>" if sensor else ""
    text = robot(link("world"), link("lens", shapes), joint("j", "world", "lens", kind="fixed"), block)
    (finding,) = find(tmp_path, text, "GEO005")
    assert finding.severity == severity
