"""SYM004: joints that are off the mirror image of another, while what they carry is not."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from builders import box, cylinder, find, inertial, joint, limit, link, robot, visual

from urdfcheck.core import Finding
from urdfcheck.model import Model
from urdfcheck.model.likeness.mirror_pairs import mirror_pairs
from urdfcheck.model.likeness.sides.settled_places import is_settled
from urdfcheck.source.load import load_source
from urdfcheck.source.package.finder import PackageFinder

LIMIT = limit(-1, 1)
PULLS = "gravity and mass matrix differ between the two sides"


def find_places(folder: Path, *parts: str) -> list[Finding]:
    return find(folder, robot(*parts), "SYM004")


def make_castors(drawn: str, odd: str = "-0.35 0.19 0.07") -> list[str]:
    """Four castors and two wheels; the one at the rear left at ``odd``, with its shape at ``drawn``."""
    parts = [link("base", visual(box("0.8 0.3 0.05"), xyz="0 0 0.1"))]
    for front, x in (("f", 0.35), ("b", -0.35)):
        for side, y in (("r", -0.19), ("l", 0.19)):
            name = f"{side}{front}_castor"
            is_odd = name == "lb_castor"
            parts.append(link(name, visual(box("0.13 0.07 0.12"), xyz=drawn if is_odd else "-0.02 0 0.02")))
            place = odd if is_odd else f"{x} {y} 0.07"
            parts.append(joint(f"{name}_joint", "base", name, kind="continuous", xyz=place, axis="0 0 1"))
    for side, y in (("right", -0.25), ("left", 0.25)):
        parts.append(link(f"{side}_wheel", visual(box("0.2 0.06 0.2"))))
        parts.append(joint(f"{side}_joint", "base", f"{side}_wheel", kind="continuous", xyz=f"0 {y} 0.1", axis="0 1 0"))
    return parts


def test_a_frame_at_another_point_of_a_part_that_is_drawn_in_its_place_is_silent(tmp_path: Path) -> None:
    assert not find_places(tmp_path, *make_castors("-0.014 0 0.066", odd="-0.356 0.19 0.024"))


def test_a_castor_that_is_drawn_out_of_its_place_is_reported(tmp_path: Path) -> None:
    (finding,) = find_places(tmp_path, *make_castors("-0.02 0 0.02", odd="-0.356 0.19 0.024"))
    assert finding.data["joint"] in {"lb_castor_joint", "lf_castor_joint", "rb_castor_joint"}


@pytest.mark.parametrize(("kind", "found"), [("continuous", False), ("revolute", True)])
def test_the_zero_of_a_swivel_that_turns_freely_tilts_no_axle(tmp_path: Path, kind: str, found: bool) -> None:
    parts = [link("base", visual(box("0.8 0.3 0.05"), xyz="0 0 0.1"))]
    for front, x in (("f", 0.35), ("b", -0.35)):
        for side, y in (("r", -0.19), ("l", 0.19)):
            name = f"{front}{side}"
            bracket, wheel = f"{name}_bracket", f"{name}_wheel"
            yaw = {"fl": 0.0147, "br": 0.03}.get(name, 0.0)
            parts += [link(bracket, visual(box("0.07 0.07 0.05"))), link(wheel, visual(cylinder(0.05, 0.02)))]
            place = f"{x} {y} 0.1"
            parts.append(
                joint(f"{bracket}_joint", "base", bracket, LIMIT, kind=kind, xyz=place, rpy=f"0 0 {yaw}", axis="0 0 1")
            )
            # The axles are beside the swivels by little: only their directions differ.
            parts.append(
                joint(
                    f"{wheel}_joint",
                    bracket,
                    wheel,
                    kind="continuous",
                    xyz=f"0 {y / 100} -0.05",
                    rpy="1.570796 0 0",
                    axis="0 0 1",
                )
            )
    assert ("axis" in {f.message_id for f in find_places(tmp_path, *parts)}) is found


def make_legs(hip: float) -> list[str]:
    """Two pairs of legs without drawings; the frames of the left hips are ``hip`` farther along their axes, and the knees take it
    back. The plane is y = 0.083."""
    parts = [link("trunk")]
    for front, x in (("F", 0.2), ("B", 0.0)):
        for side, sign in (("R", -1), ("L", 1)):
            more = hip if side == "L" else 0.0
            name = f"{side}{front}"
            y = 0.083 + sign * 0.077 - more
            parts += [link(f"{name}_hip"), link(f"{name}_roll"), link(f"{name}_knee")]
            parts.append(
                joint(f"{name}_1", "trunk", f"{name}_hip", LIMIT, kind="revolute", xyz=f"{x} {y:.5f} 0", axis="0 1 0")
            )
            parts.append(
                joint(
                    f"{name}_2",
                    f"{name}_hip",
                    f"{name}_roll",
                    LIMIT,
                    kind="revolute",
                    xyz=f"0 {more} 0",
                    axis="1 0 0",
                )
            )
            # The front knees have their frames along the axis, as the hips have: as many pairs are for either plane.
            slid = more if front == "F" else 0.0
            parts.append(
                joint(
                    f"{name}_3",
                    f"{name}_roll",
                    f"{name}_knee",
                    LIMIT,
                    kind="revolute",
                    xyz=f"0.06 {-slid} -0.06",
                    axis="0 1 0",
                )
            )
    return parts


def test_the_frames_of_hinges_along_the_normal_do_not_place_the_mirror(tmp_path: Path) -> None:
    assert not find_places(tmp_path, *make_legs(0.0239))


def make_gripper(rpy: str, xs: tuple[float, float]) -> list[str]:
    """Two arms with two fingers each; those of the right one hang at ``xs`` (m), on a wrist that is turned by ``rpy``."""
    parts = [link("torso")]
    for side, sign in (("left", 1), ("right", -1)):
        for name, parent, xyz in (("shoulder", "torso", f"0 {0.2 * sign} 0.3"), ("elbow", "shoulder", "0.3 0 0")):
            above = parent if parent == "torso" else f"{side}_{parent}"
            parts.append(link(f"{side}_{name}"))
            parts.append(
                joint(f"{side}_{name}_joint", above, f"{side}_{name}", LIMIT, kind="revolute", xyz=xyz, axis="1 0 0")
            )
        turn = "0 0 0" if side == "left" else rpy
        places = (0.011, -0.011) if side == "left" else xs
        parts.append(link(f"{side}_wrist"))
        parts.append(joint(f"{side}_wrist_joint", f"{side}_elbow", f"{side}_wrist", xyz="0 0 -0.2", rpy=turn))
        for finger, along in zip(("", "2"), places, strict=True):
            name = f"{side}_ee{finger}"
            tip = visual(box("0.04 0.01 0.01"), xyz=f"{0.03 * sign} 0 0.07")
            parts.append(link(name, visual(box("0.01 0.01 0.06"), xyz=f"{0.01 * sign} 0 0.03"), tip))
            parts.append(
                joint(
                    f"{name}_joint",
                    f"{side}_wrist",
                    name,
                    limit(0, 0.02),
                    kind="prismatic",
                    xyz=f"0 {along} 0.02",
                    axis="0 1 0",
                )
            )
    return parts


def test_fingers_that_mirror_those_with_the_other_names_are_silent(tmp_path: Path) -> None:
    slips = [
        f
        for f in find_places(tmp_path, *make_gripper("0 0 3.14159265", (-0.011, 0.011)))
        if f.message_id in {"slip", "origin"}
    ]
    assert not slips


def test_a_finger_that_mirrors_none_is_reported(tmp_path: Path) -> None:
    slips = [
        f
        for f in find_places(tmp_path, *make_gripper("0 0 3.14159265", (-0.011, 0.031)))
        if f.message_id in {"slip", "origin"}
    ]
    assert slips


def make_wheels(left: str, right: str) -> list[str]:
    parts = [link("base", visual(box("0.3 0.3 0.05"), xyz="0 0 0.1"))]
    disk = visual(cylinder(0.075, 0.04), rpy="1.5707963 0 0")
    for side, y, numbers in (("left", 0.2, left), ("right", -0.2, right)):
        parts.append(link(f"{side}_wheel", numbers, disk))
        parts.append(
            joint(f"{side}_joint", "base", f"{side}_wheel", kind="continuous", xyz=f"0 {y} 0.075", axis="0 1 0")
        )
    return parts


@pytest.mark.parametrize(
    ("kind", "turn", "com", "told"),
    [
        ("continuous", 0.45, "0 0.01 0", []),
        ("continuous", 0.45, "0.02 0.01 0", [PULLS]),
        ("revolute", 0.45, "0 0.01 0", ["the mass matrix differs between the two sides"]),
        ("fixed", 0.45, "0 0.01 0", ["the tensor of the body that holds both is not that of two equal sides"]),
        ("fixed", 0.0, "0.02 0.01 0", ["the COM of the body that holds both is shifted to one side"]),
    ],
)
def test_what_an_unlike_inertial_does_depends_on_what_differs_and_on_the_joint(
    tmp_path: Path, kind: str, turn: float, com: str, told: list[str]
) -> None:
    """A propeller whose tensor was exported at another angle spins alike; the angle of a fixed part is another tensor."""
    parts = [link("base", visual(box("0.3 0.3 0.05"), xyz="0 0 0.1"))]
    blade = visual(box("0.3 0.01 0.02"), xyz="0 0.01 0")
    for side, y, angle, place in (("left", 0.2, 0.0, "0 0.01 0"), ("right", -0.2, turn, com)):
        mean, half = (1.54e-4 + 1.61e-3) / 2, (1.61e-3 - 1.54e-4) / 2
        numbers = inertial(
            0.2,
            com=place,
            ixx=mean - half * math.cos(2 * angle),
            izz=mean + half * math.cos(2 * angle),
            ixz=half * math.sin(2 * angle),
            iyy=1.75e-3,
        )
        parts.append(link(f"{side}_prop", numbers, blade))
        more = LIMIT if kind == "revolute" else ""
        axis = "" if kind == "fixed" else "0 1 0"
        parts.append(joint(f"{side}_joint", "base", f"{side}_prop", more, kind=kind, xyz=f"0 {y} 0.075", axis=axis))
    assert [f.consequences["pinocchio"] for f in find_places(tmp_path, *parts)] == told


def test_of_two_impossible_inertials_neither_repairs_the_other(tmp_path: Path) -> None:
    left, right = inertial(1, ixx=0.25, iyy=0.45, izz=0.55), inertial(1, ixx=0.008, iyy=0.016, izz=0.008)
    (finding,) = find_places(tmp_path, *make_wheels(left, right))
    assert finding.message_id == "both"
    assert finding.fix is not None
    assert finding.fix.title == "compute both inertials from the parts: neither is near that of what is drawn"
    (finding,) = find_places(tmp_path, *make_wheels(inertial(1, ixx=0.0014, iyy=0.0028, izz=0.0016), right))
    assert finding.message_id != "both"


@pytest.mark.parametrize(("size", "found"), [(1.0, True), (8.0, False)])
def test_a_few_millimetres_of_a_robot_of_many_metres_are_no_displacement(
    tmp_path: Path, size: float, found: bool
) -> None:
    parts = [link("base")]
    for i, name in enumerate(("hip", "arm", "ear")):
        for side, y in (("left", 0.5 * size), ("right", -0.5 * size)):
            x = (i - 1) * size + (0.004 if (side, name) == ("right", "ear") else 0.0)
            parts.append(link(f"{side}_{name}"))
            parts.append(
                joint(
                    f"{side}_{name}_joint",
                    "base",
                    f"{side}_{name}",
                    LIMIT,
                    kind="revolute",
                    xyz=f"{x} {y} 0",
                    axis="0 0 1",
                )
            )
    assert [f.message_id for f in find_places(tmp_path, *parts)] == ["origin"] * found


@pytest.mark.parametrize(("off", "found"), [(0.0, False), (0.0015, True)])
def test_an_angle_of_the_parents_explains_a_distance_at_the_end_of_a_lever(
    tmp_path: Path, off: float, found: bool
) -> None:
    """3.14 for π leaves both thighs 1.6 mrad short, in one sense: 1.3 mm at the knees, which are typed mirrored."""
    parts = [link("trunk", visual(box("0.3 0.1 0.05")))]
    for end, x, rpy in (("front", 0.11, "0 0 0"), ("back", -0.11, "0 0 3.14")):
        for side, y in (("left", 0.05), ("right", -0.05)):
            name = f"{end}_{side}"
            sign = y * x / 0.0055
            more = off if name == "back_right" else 0.0
            for part, parent, place, turned in (
                ("thigh", "trunk", f"{x} {y} 0", rpy),
                ("shin", f"{name}_thigh", f"{0.4 + more} {0.005 * sign:.6f} 0", "0 0 0"),
            ):
                parts.append(link(f"{name}_{part}", visual(box("0.6 0.01 0.02"), xyz="0.3 0 0")))
                parts.append(
                    joint(
                        f"{name}_{part}_joint",
                        parent,
                        f"{name}_{part}",
                        LIMIT,
                        kind="revolute",
                        xyz=place,
                        rpy=turned,
                        axis="0 1 0",
                    )
                )
    assert ("origin" in {f.message_id for f in find_places(tmp_path, *parts)}) is found


@pytest.mark.parametrize(
    ("odd", "drawn", "kinds"),
    [
        ("-0.25 -0.125 0", "0 -0.07 0", []),  # 5 mm beside its place
        ("-0.25 -0.125 0", "0 0 0", ["origin"]),
    ],
)
def test_wheels_that_are_drawn_about_mirrored_places_stay_there(
    tmp_path: Path, odd: str, drawn: str, kinds: list[str]
) -> None:
    """A frame may be at another point of its axle: a new origin would move the wheel."""
    parts = [link("base", visual(box("0.8 0.3 0.05"), xyz="0 0 0.1"))]
    for name, x in (("front", 0.25), ("middle", 0.0), ("rear", -0.25)):
        for side, y in (("left", 0.2), ("right", -0.2)):
            is_odd = (name, side) == ("rear", "right")
            wheel, place = f"{name}_{side}_wheel", odd if is_odd else f"{x} {y} 0"
            shape = visual(cylinder(0.05, 0.03), xyz=drawn if is_odd else "", rpy="1.570796 0 0")
            parts += [link(wheel, shape), joint(wheel, "base", wheel, kind="continuous", xyz=place, axis="0 1 0")]
    assert [finding.message_id for finding in find_places(tmp_path, *parts)] == kinds


@pytest.mark.parametrize(("eyes", "kinds"), [(False, []), (True, ["lone_place"])])
def test_a_body_whose_frame_is_beside_its_middle_has_hips_at_other_distances(
    tmp_path: Path, eyes: bool, kinds: list[str]
) -> None:
    """Another pair on the body shows where the middle is."""
    parts = [link("body", visual(box("0.1 0.1 0.1")))]
    for side, y in (("left", 0.047), ("right", -0.0094)):
        parent = "body"
        for part, xyz, axis in (
            ("hip", f"0.01 {y} -0.05", "1 0 0"),
            ("thigh", "0 0 -0.05", "0 1 0"),
            ("shank", "0 0 -0.1", "0 1 0"),
            ("ankle", "0 0 -0.1", "0 1 0"),
            ("foot", "0 0 -0.02", "1 0 0"),
        ):
            name = f"{side}_{part}"
            parts.append(link(name, visual(box("0.02 0.02 0.02"))))
            parts.append(joint(f"{name}_joint", parent, name, LIMIT, kind="revolute", xyz=xyz, axis=axis))
            parent = name
        if eyes:
            place = f"0.05 {math.copysign(0.024, y)} 0.05"
            parts.append(link(f"{side}_eye", visual(box("0.01 0.01 0.01"))))
            parts.append(
                joint(f"{side}_eye_joint", "body", f"{side}_eye", LIMIT, kind="revolute", xyz=place, axis="0 0 1")
            )
    assert [finding.message_id for finding in find_places(tmp_path, *parts)] == kinds


@pytest.mark.parametrize(("name", "kinds"), [("mount", ["turned_pair"]), ("calibration", [])])
def test_a_calibrated_mount_mirrors_nothing(tmp_path: Path, name: str, kinds: list[str]) -> None:
    parts = [link("base", visual(box("0.4 0.2 0.1")))]
    for side, y in (("left", 0.2), ("right", -0.2)):
        for part, x in (("arm", 0.1), ("leg", -0.1), ("ear", 0.2)):
            limb, sign = f"{side}_{part}", math.copysign(1.0, y)
            turn = f"0 0 {0.0712 if side == 'left' else 0.0123}" if part == "arm" else "0 0 0"
            kind = "fixed" if part == "arm" else "continuous"
            parts.append(link(limb, visual(box("0.1 0.04 0.02"), xyz=f"0.03 {0.01 * sign} 0.02")))
            parts.append(
                joint(f"{side}_{part}_{name}", "base", limb, kind=kind, xyz=f"{x} {y} 0", rpy=turn, axis="0 0 1")
            )
    assert [finding.message_id for finding in find_places(tmp_path, *parts)] == kinds


@pytest.mark.parametrize(
    ("angles", "kind", "kinds"),
    [
        (("-0.0152290274 0.510627488 0.3", "0.0323779520 0.531011188 -0.3"), "fixed", []),
        (("-0.0152290274 0.510627488 0.3", "0.0323779520 0.531011188 -0.3"), "continuous", ["axis"]),
        (("-0.0152 0.5106 0.3", "0.0324 0.5310 -0.3"), "fixed", ["turned_pair"]),
        (("-0.0152290274 0.510627488 0.3", "0.0152290274 0.531011188 -0.3"), "fixed", ["turned_pair"]),
    ],
)
def test_extrinsics_of_many_digits_were_measured(
    tmp_path: Path, angles: tuple[str, str], kind: str, kinds: list[str]
) -> None:
    """Two angles of each camera are its own; not where joints move, where few digits were typed, or where one angle differs."""
    parts = [link("base", visual(box("0.4 0.2 0.1")))]
    for side, y, turn in (("left", 0.2, angles[0]), ("right", -0.2, angles[1])):
        for part, x in (("camera", 0.1), ("leg", -0.1), ("ear", 0.2)):
            limb, sign = f"{side}_{part}", math.copysign(1.0, y)
            rpy, moves = (turn, kind) if part == "camera" else ("0 0 0", "continuous")
            parts.append(link(limb, visual(box("0.1 0.04 0.02"), xyz=f"0.03 {0.01 * sign} 0.02")))
            parts.append(
                joint(f"{side}_{part}_joint", "base", limb, kind=moves, xyz=f"{x} {y} 0", rpy=rpy, axis="0 1 0")
            )
    assert [finding.message_id for finding in find_places(tmp_path, *parts)] == kinds


@pytest.mark.parametrize(("x", "y", "kinds"), [(0.1, 0.2, ["slip"]), (0.1034, 0.2021, [])])
def test_places_that_differ_in_signs_alone_were_not_measured(
    tmp_path: Path, x: float, y: float, kinds: list[str]
) -> None:
    """Both cameras are at the left; the angles are their own."""
    parts = [link("base", visual(box("0.4 0.2 0.1")))]
    angles = {"left": "-0.0152290274 0.510627488 0.3", "right": "0.0323779520 0.531011188 -0.3"}
    for side, sign in (("left", 1), ("right", -1)):
        for part, along in (("leg", -0.1), ("ear", 0.2)):
            parts.append(link(f"{side}_{part}", visual(box("0.1 0.04 0.02"), xyz=f"0.03 {0.01 * sign} 0.02")))
            at = f"{along} {0.2 * sign} 0"
            parts.append(
                joint(f"{side}_{part}_joint", "base", f"{side}_{part}", kind="continuous", xyz=at, axis="0 1 0")
            )
        parts.append(link(f"{side}_camera", visual(box("0.1 0.04 0.02"), xyz=f"0.03 {0.01 * sign} 0.02")))
        place = "0.1 0.2 0" if sign > 0 else f"{x} {y} 0"
        parts.append(joint(f"{side}_camera_joint", "base", f"{side}_camera", kind="fixed", xyz=place, rpy=angles[side]))
    assert [finding.message_id for finding in find_places(tmp_path, *parts)] == kinds


@pytest.mark.parametrize(
    ("mount", "own", "places", "kind", "found"),
    [
        # A stereo camera on its side has its lenses one above the other.
        ("-1.5707963 0 0", "0 0 0", ("0 0.0375 0", "0 -0.0375 0"), "fixed", False),
        ("-1.5707963 0 0", "0 0 0", ("0 0.0375 0", "0 -0.0375 0"), "continuous", False),
        # One that looks to the left, in a frame of its own or of its lenses.
        ("0 0 1.5707963", "0 0 0", ("0 0.0375 0.01", "0 -0.0375 0.01"), "fixed", False),
        ("0 0 0", "0 0 1.5707963", ("0.0375 0 0.01", "-0.0375 0 0.01"), "fixed", False),
        # Along another coordinate of a part that is rotated.
        ("0 1.5707963 0", "0 0 0", ("0.1 0 0", "-0.1 0 0"), "fixed", False),
        # The sign of the sides is in the wrong coordinate.
        ("0 0 0", "0 0 0", ("0.1 0 0.01", "-0.1 0 0.01"), "fixed", True),
        ("0 0 0", "0 0 0", ("0.1 0 0.01", "-0.1 0 0.01"), "continuous", True),
    ],
)
def test_a_part_that_is_mounted_on_its_side_has_its_own_left(
    tmp_path: Path, mount: str, own: str, places: tuple[str, str], kind: str, found: bool
) -> None:
    parts = [link("base", visual(box("0.4 0.2 0.1"))), link("head", visual(box("0.1 0.1 0.02")))]
    parts.append(joint("neck", "base", "head", kind="fixed", xyz="0.1 0 0.2", rpy=mount))
    for side, place, y in (("left", places[0], 0.2), ("right", places[1], -0.2)):
        parts.append(link(f"{side}_eye", visual(box("0.02 0.02 0.02"))))
        parts.append(joint(f"{side}_eye_joint", "head", f"{side}_eye", kind=kind, xyz=place, rpy=own, axis="1 0 0"))
        for limb, x in (("arm", 0.1), ("leg", -0.1), ("ear", 0.2)):
            parts.append(link(f"{side}_{limb}", visual(box("0.1 0.04 0.02"))))
            parts.append(
                joint(
                    f"{side}_{limb}_joint", "base", f"{side}_{limb}", kind="continuous", xyz=f"{x} {y} 0", axis="0 1 0"
                )
            )
    assert bool(find_places(tmp_path, *parts)) == found


@pytest.mark.parametrize(("off", "settled"), [(0.0201, True), (0.022, True), (0.025, False)])
def test_rods_that_are_numbered_from_one_side_to_the_other_are_in_place(
    tmp_path: Path, off: float, settled: bool
) -> None:
    """Each foot has a rod on either side, and the first of one foot is the mirror image of the second of the other. The case of a
    letter hides that one pair."""
    parts = [link("base", visual(box("0.2 0.2 0.1"), xyz="0 0 0.1"))]
    for side, y in (("Left", 0.12), ("Right", -0.12)):
        for part, parent, z in (
            ("thigh", "base", 0.0),
            ("shin", f"{side}_thigh", -0.3),
            ("foot", f"{side}_shin", -0.3),
        ):
            name, place = f"{side}_{part}", f"0 {y if part == 'thigh' else 0} {z}"
            parts.append(link(name, visual(box("0.08 0.06 0.2"), xyz="0 0 -0.1")))
            parts.append(joint(f"{name}_joint", parent, name, LIMIT, xyz=place, axis="0 1 0"))
        rods = {
            f"{'left' if side == 'Left' else side}_rod_a": -0.02,
            f"{side}_rod_b": 0.02 if side == "Left" else off,
        }
        for name, y in rods.items():
            parts.append(link(name, visual(box("0.02 0.01 0.1"), xyz="0 0 0.05")))
            parts.append(joint(f"{name}_joint", f"{side}_foot", name, LIMIT, xyz=f"-0.05 {y} 0", axis="1 0 0"))
    (tmp_path / "robot.urdf").write_text(robot(*parts), encoding="utf-8")
    source = load_source(tmp_path / "robot.urdf", {}, PackageFinder(tmp_path, {}, []))
    assert source.root is not None
    model = Model(source=source, robot=source.root)
    assert is_settled(model, ["Left_rod_b", "Right_rod_b"], mirror_pairs(model)) == settled
