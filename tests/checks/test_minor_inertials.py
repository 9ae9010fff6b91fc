"""Inertials that change nothing, or whose numbers a comment explains, are notes on request; those that are felt are not."""

from __future__ import annotations

from pathlib import Path

import pytest
from builders import box, collision, cylinder, find, inertial, joint, limit, link, origin, robot, visual

from urdfcheck.core import Severity

HULL = link("hull", inertial(30, ixx=1.2, iyy=2.6, izz=3.1), visual(box("1 0.5 0.4")))
SHUT = '<axis xyz="1 0 0"/>' + limit(lower=0, upper=0, effort=0, velocity=0)
OPEN = '<axis xyz="1 0 0"/>' + limit(lower=-1, upper=1, effort=1, velocity=1)
NAMESPACE = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'


def make_carrier(mass: float, *, moment: float = 1e-6, com: str = "", kind: str = "fixed", more: str = "") -> str:
    """Return a hull of 30 kg with a cube of 5 cm on it."""
    part = link("part", inertial(mass, moment, com=com), visual(box("0.05 0.05 0.05")))
    return robot(HULL, joint("mount", "hull", "part", origin(xyz="0 0 0.2"), more, kind=kind), part)


@pytest.mark.parametrize(
    ("kind", "more", "severity"),
    [("fixed", "", None), ("revolute", SHUT, Severity.INFO), ("revolute", OPEN, Severity.WARNING)],
)
def test_a_light_part_is_felt_by_a_joint_that_moves_it(
    tmp_path: Path, kind: str, more: str, severity: Severity | None
) -> None:
    # Too large, but nothing beside the hull's moments. What is fixed to a heavier part is not checked at all.
    found = find(tmp_path, make_carrier(0.01, moment=0.01, kind=kind, more=more), "INR005")
    found += find(tmp_path, make_carrier(0.01, moment=0.01, kind=kind, more=more), "INR007")
    assert {min(finding.severity, Severity.WARNING) for finding in found} == ({severity} if severity else set())
    assert all((finding.message_id == "lost") == (severity is Severity.INFO) for finding in found)


@pytest.mark.parametrize(
    ("mass", "moment", "note"), [(0.01, 0.01, "lost"), (0.03, 0.01, "absorbed"), (0.01, 0.2, ""), (0.03, 0.05, "")]
)
def test_a_mass_that_is_no_rounding_or_a_tensor_that_rules_its_body_is_felt(
    tmp_path: Path, mass: float, moment: float, note: str
) -> None:
    found = find(tmp_path, make_carrier(mass, moment=moment, kind="revolute", more=SHUT), {"INR005", "INR007"})
    assert found
    assert {finding.message_id in {"lost", "absorbed"} for finding in found} == {bool(note)}
    assert {finding.severity is Severity.INFO for finding in found} == {bool(note)}
    assert not note or note in {finding.message_id for finding in found}


@pytest.mark.parametrize(
    ("axis", "moment", "distance", "message"),
    [
        ("0 1 0", 2e-5, 0.22, "absorbed"),
        ("0 1 0", 2e-4, 0.22, "little"),  # a tenth of the leg's moment
        ("0 1 0", 1e-3, 0.22, "placeholder"),
        ("0 1 0", 2e-5, 0.0, "little"),  # at the knee itself
        ("0 0 1", 2e-5, 0.22, "placeholder"),  # the leg turns about its own length
    ],
)
def test_a_toe_adds_its_mass_to_a_leg_and_its_tensor_does_not_count(
    tmp_path: Path, axis: str, moment: float, distance: float, message: str
) -> None:
    """The rod of a leg has next to no moment about its length, about which no joint turns it."""
    shin = inertial(0.05, com="0 0 0.1", ixx=1.67e-4, iyy=1.67e-4, izz=2e-6)
    text = robot(
        HULL,
        link("shin", shin, visual(box("0.017 0.009 0.2"), xyz="0 0 0.1")),
        link("toe", inertial(0.01, moment), visual(box("0.03 0.03 0.03"))),
        joint("knee", "hull", "shin", kind="continuous", axis=axis),
        joint("end", "shin", "toe", xyz=f"0 0 {distance}"),
    )
    (finding,) = find(tmp_path, text, "INR007")
    assert finding.message_id == message
    assert (finding.severity is Severity.INFO) == (message != "placeholder")
    assert ("sluggish" in finding.consequences["gazebo"]) == (message == "placeholder")


@pytest.mark.parametrize(("moment", "message"), [(0.001, "little"), (0.1, "placeholder")])
def test_a_joint_that_turns_a_wheel_too_does_not_feel_the_knuckle(tmp_path: Path, moment: float, message: str) -> None:
    text = robot(
        HULL,
        link("knuckle", inertial(0.5, moment), visual(box("0.04 0.03 0.03"))),
        link("wheel", inertial(1, ixx=0.0036, iyy=0.0054, izz=0.0036), visual(box("0.2 0.05 0.2"))),
        joint("steer", "hull", "knuckle", limit(lower=-1, upper=1), kind="revolute", axis="0 0 1"),
        joint("spin", "knuckle", "wheel", kind="continuous", axis="0 1 0"),
    )
    found = find(tmp_path, text, "INR007")
    assert [finding.message_id for finding in found] == [message]


def test_what_slides_is_no_body_that_a_placeholder_rules(tmp_path: Path) -> None:
    finger = link("finger", inertial(0.001, 0.01), visual(box("0.02 0.02 0.02")), collision(box("0.02 0.02 0.02")))
    severities = [
        finding.severity
        for kind in ("revolute", "prismatic")
        for finding in find(tmp_path, robot(HULL, finger, joint("j", "hull", "finger", OPEN, kind=kind)), "INR007")
    ]
    assert severities == [Severity.ERROR, Severity.WARNING]


@pytest.mark.parametrize(("kind", "severity"), [("revolute", Severity.ERROR), ("prismatic", Severity.WARNING)])
def test_two_placeholders_of_one_body_rule_it_together(tmp_path: Path, kind: str, severity: Severity) -> None:
    def make_part(name: str) -> str:
        return link(name, inertial(0.001, 0.01), visual(box("0.02 0.02 0.02")), collision(box("0.02 0.02 0.02")))

    text = robot(
        HULL,
        make_part("finger"),
        make_part("tip"),
        joint("j", "hull", "finger", OPEN, kind=kind),
        joint("k", "finger", "tip", xyz="0.02 0 0"),
    )
    (finding,) = find(tmp_path, text, "INR007")
    assert finding.severity is severity


@pytest.mark.parametrize(("mass", "severity"), [("0.001", Severity.INFO), ("0.1", Severity.WARNING)])
def test_the_com_of_a_mark_makes_no_difference(tmp_path: Path, mass: str, severity: Severity) -> None:
    text = make_carrier(float(mass), moment=float(mass) * 4e-4, com="0.2 0 0", kind="revolute", more=OPEN)
    (finding,) = find(tmp_path, text, "INR006")
    assert finding.severity is severity
    assert (finding.message_id == "lost") == (severity is Severity.INFO)


@pytest.mark.parametrize(
    ("comment", "is_chosen"),
    [
        ("Makes a blank inertia", True),
        ("I tweaked these values, the simulation did not work with real ones", True),
        ("a light dummy, to be replaced", False),
        ("avoids a name that is used twice", False),
    ],
)
@pytest.mark.parametrize("place", ["macro", "property", "block", "apart"])
def test_a_reason_may_stand_where_the_number_was_typed(
    tmp_path: Path, comment: str, is_chosen: bool, place: str
) -> None:
    told = f"<!-- {comment} -->\n"
    block = '<inertial><mass value="0.02"/><inertia ixx="{0}" ixy="0" ixz="0" iyy="{0}" iyz="0" izz="{0}"/></inertial>'
    values = '<xacro:property name="other" value="1"/>\n<xacro:property name="own" value="0.003"/>\n'
    if place == "macro":
        values, own = "", "<xacro:dummy_inertia/>"
        macro = f'{told}<xacro:macro name="dummy_inertia">{block.format("0.003")}</xacro:macro>\n'
    else:
        macro, own = "", block.format("${own}")
        values = {
            "property": values.replace("\n", f"\n{told}", 1),
            "block": told + values,
            "apart": told + "\n" + values,
        }[place]
    text = (
        f'<robot name="r" {NAMESPACE}>\n{values}{macro}{HULL}'
        f'<link name="part">{own}{visual(box("0.05 0.04 0.03"))}</link>'
        f"{joint('mount', 'hull', 'part', OPEN, kind='revolute')}</robot>"
    )
    found = find(tmp_path, text, {"INR005", "INR007"}, name="r.urdf.xacro")
    assert found
    assert {f.message_id == "chosen" for f in found} == {is_chosen and place != "apart"}


def test_a_reason_for_moments_is_none_for_a_com(tmp_path: Path) -> None:
    told = "<!-- increased to make the simulator happy --><inertia"
    text = make_carrier(0.1, moment=4e-5, com="0.2 0 0", kind="revolute", more=OPEN).replace("<inertia ", told + " ")
    (finding,) = find(tmp_path, text, "INR006")
    assert finding.severity is Severity.WARNING


@pytest.mark.parametrize("is_kept", [True, False])
def test_a_copied_tensor_may_replace_one_that_a_comment_keeps(tmp_path: Path, is_kept: bool) -> None:
    kept = '<!--inertia ixx="7.86e-05" ixy="0" ixz="0" iyy="9.69e-05" iyz="0" izz="9.99e-05"/-->' if is_kept else ""
    own = inertial(0.1, ixx="8.5833e-04", iyy="7.5833e-04", izz="5.123e-04").replace("<inertia ", kept + "<inertia ")
    arms = [
        link(f"{name}_arm", own, visual(box(size)))
        for name, size in (("upper", "0.3 0.1 0.1"), ("lower", "0.1 0.05 0.04"))
    ]
    text = robot(
        HULL,
        *arms,
        joint("a", "hull", "upper_arm", OPEN, kind="revolute"),
        joint("b", "upper_arm", "lower_arm", OPEN, kind="revolute"),
    )
    (finding,) = find(tmp_path, text, "INR008")
    assert (finding.message_id == "chosen") == is_kept


def test_the_numbers_of_a_links_own_hull_are_not_outvoted(tmp_path: Path) -> None:
    """Four tips of one drawing; one has its numbers, the others those of a longer part."""
    own = {"ixx": 0.05 * (0.04**2 + 0.06**2) / 12, "iyy": 0.05 * (0.02**2 + 0.06**2) / 12}
    own |= {"izz": 0.05 * (0.02**2 + 0.04**2) / 12}
    others = {name: 2.1 * value for name, value in own.items()} | {"izz": 1.2 * own["izz"]}
    fingers = []
    for i in range(4):
        numbers, com = (own, "0 0 0.03") if i == 0 else (others, "0 0 0.045")
        part = link(f"tip_{i}", inertial(0.05, com=com, **numbers), visual(box("0.02 0.04 0.06"), xyz="0 0 0.03"))
        fingers += [part, joint(f"j{i}", "hull", f"tip_{i}", origin(xyz=f"0 {0.1 * i} 0.3"), OPEN, kind="revolute")]
    (finding,) = find(tmp_path, robot(HULL, *fingers), "SYM003")
    assert (finding.message_id, finding.fix is not None and finding.fix.edits) == ("others", ())


@pytest.mark.parametrize("is_drawn_in_place", [True, False])
def test_a_wheel_that_is_drawn_in_its_place_is_not_off(tmp_path: Path, is_drawn_in_place: bool) -> None:
    """The frames of the right wheels are on their inner faces, those of the left ones on their outer faces."""
    parts = []
    for name in ("arm", "lamp", "horn"):
        for side, y in (("left", 0.2), ("right", -0.2)):
            part = link(f"{side}_{name}", inertial(0.1, 1e-4), visual(box("0.05 0.05 0.05")))
            place = origin(xyz=f"0 {y} 0.{len(name)}") + '<axis xyz="0 0 1"/>'
            parts += [part, joint(f"{side}_{name}_joint", "hull", f"{side}_{name}", place, kind="continuous")]
    for end, x in (("front", 0.2), ("rear", -0.2)):
        for side, y in (("left", 0.16), ("right", -0.1)):
            name, shift = f"{end}_{side}_wheel", -0.03 if is_drawn_in_place or side == "left" else 0.03
            own = inertial(0.5, ixx=0.0008, iyy=0.0014, izz=0.0008, com=f"0 {shift} 0")
            drawn = visual(cylinder(0.07, 0.06), xyz=f"0 {shift} 0", rpy="1.5707963267948966 0 0")
            drawn += visual(box("0.03 0.006 0.05"), xyz=f"0 {shift - 0.03} 0.01")  # the hub of one side on both
            turns = origin(xyz=f"{x} {y} 0") + '<axis xyz="0 1 0"/>'
            parts += [link(name, own, drawn), joint(f"{name}_joint", "hull", name, turns, kind="continuous")]
    found = find(tmp_path, robot(HULL, *parts), "SYM004")
    assert ("origin" in {finding.message_id for finding in found}) != is_drawn_in_place


def test_a_light_part_without_a_tensor_is_no_crash_beside_another(tmp_path: Path) -> None:
    """It counts as infinitely large, and such a tensor has no eigenvalues."""
    bare = '<link name="bare"><inertial><mass value="0.01"/></inertial></link>'
    text = make_carrier(0.01, moment=0.01, kind="revolute", more=SHUT)
    text = text.replace("</robot>", bare + joint("hold", "hull", "bare", SHUT, kind="revolute") + "</robot>")
    assert {finding.message_id for finding in find(tmp_path, text, {"INR005", "INR007"})} == {"lost"}


def test_a_light_part_whose_tensor_rules_its_body_is_felt(tmp_path: Path) -> None:
    """A bumper of 100 g in g·mm² makes a mobile base that nothing can turn."""
    ixx, iyy, izz = 1.35e6, 2.6e5, 1.5e6
    part = link("bumper", inertial(0.1, ixx=ixx, iyy=iyy, izz=izz), visual(box("0.15 0.4 0.06")))
    base = link("base", inertial(30, ixx=1.2, iyy=2.6, izz=3.1), visual(box("1 0.5 0.4")))
    wheel = link("wheel", inertial(1, 1e-2), visual(cylinder(0.1, 0.05)))
    turn = joint("axle", "base", "wheel", axis="0 0 1", kind="continuous")
    text = robot(base, joint("mount", "base", "bumper"), part, turn, wheel)
    (finding,) = (f for f in find(tmp_path, text, {"INR009"}) if "bumper" in f.subjects[0])
    assert (finding.severity, finding.cause and finding.cause.id) == (Severity.ERROR, "inertia_unit")
