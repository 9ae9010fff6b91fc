"""What looks wrong and is meant, as the file says: a reason in a comment, a pin that nothing commands, limbs on one pin."""

from __future__ import annotations

from pathlib import Path

import pytest
from builders import box, cylinder, find, inertial, joint, limit, link, robot, sphere, visual

from urdfcheck.core import Severity
from urdfcheck.facts.inertials.formulas.simple_solids import name_simple_solids

WORKAROUND = "<!-- a prismatic joint does not work here, this is a workaround -->"
PLUGIN = '<gazebo><plugin name="own" filename="libown.so"/></gazebo>'


def command(*names: str) -> str:
    joints = "".join(f'<joint name="{name}"><command_interface name="position"/></joint>' for name in names)
    return (
        f'<ros2_control name="s" type="system"><hardware><plugin>own/System</plugin></hardware>{joints}</ros2_control>'
    )


# -- JNT005, JNT007, JNT008 ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("comment", "found"), [("", 1), (WORKAROUND, 0), ("<!-- the left lift -->", 1)])
def test_a_continuous_joint_with_limits_may_have_a_reason(tmp_path: Path, comment: str, found: int) -> None:
    lifts = [
        joint(f"{side}_lift", "base", side, limit(-0.01, 1), kind="continuous", axis="0 1 0")
        for side in ("left", "right")
    ]
    text = robot(link("base"), link("left"), link("right"), comment, *lifts)
    assert len(find(tmp_path, text, "JNT008")) == found


@pytest.mark.parametrize(
    ("more", "effort", "severity"),
    [
        ("", 10, Severity.WARNING),
        (PLUGIN, 10, Severity.INFO),
        (PLUGIN, 0, Severity.WARNING),
        (PLUGIN + command("mount"), 10, Severity.WARNING),
    ],
)
def test_a_joint_is_held_for_a_plugin(tmp_path: Path, more: str, effort: int, severity: Severity) -> None:
    held = joint("mount", "base", "motor", limit(0, 0, effort, 0), kind="revolute", axis="0 0 1")
    (finding,) = find(tmp_path, robot(link("base"), link("motor"), held, more), "JNT005")
    assert finding.severity is severity


SENSOR = '<gazebo reference="motor"><sensor name="imu" type="imu"/></gazebo>'


@pytest.mark.parametrize(
    ("mass", "more", "severity"),
    [
        (0.0005, PLUGIN, Severity.INFO),
        (0.0005, "", Severity.WARNING),
        (0.005, PLUGIN, Severity.WARNING),
        (0.005, SENSOR, Severity.INFO),
    ],
)
def test_a_link_that_weighs_nothing_is_kept_from_being_merged(
    tmp_path: Path, mass: float, more: str, severity: Severity
) -> None:
    held = joint("mount", "base", "motor", limit(0, 0, 0, 0), kind="revolute", axis="0 0 1")
    (finding,) = find(tmp_path, robot(link("base"), link("motor", inertial(mass)), held, more), "JNT005")
    assert finding.severity is severity
    assert next(iter(finding.consequences.values())) == "locks the joint at 0"


def test_joints_that_are_meant_and_others_are_two_findings(tmp_path: Path) -> None:
    joints = [
        joint(f"{name}_j", "base", name, limit(0, 0, 0, 0), kind="revolute", axis="0 0 1") for name in ("motor", "arm")
    ]
    text = robot(link("base"), link("motor"), link("arm"), *joints, SENSOR)
    assert {f.data["joints"]: f.severity for f in find(tmp_path, text, "JNT005")} == {
        "arm_j": Severity.WARNING,
        "motor_j": Severity.INFO,
    }


@pytest.mark.parametrize(
    ("more", "message"), [("", "effort-odd"), (command("joint_1", "joint_2", "joint_3"), "effort-unused")]
)
def test_a_pin_that_nothing_commands_has_no_motor(tmp_path: Path, more: str, message: str) -> None:
    names = ["joint_1", "joint_2", "joint_3", "closure"]
    joints = [
        joint(name, f"l{i}", f"l{i + 1}", limit(-1, 1, 0 if name == "closure" else 5), kind="revolute", axis="0 0 1")
        for i, name in enumerate(names)
    ]
    found = find(tmp_path, robot(*(link(f"l{i}") for i in range(5)), *joints, more), "JNT007")
    assert [one.message_id for one in found] == [message]


# -- SYM004 --------------------------------------------------------------------------------------------------------------


def make_arms(*, shift: str, axis: str = "1 0 0") -> str:
    """Return two arms of three links each in planes across x, the right one ``shift`` higher along x."""
    parts = [link("base", visual(box("0.1 0.6 0.1")))]
    for side, sign, x in (("left", "", "0.2"), ("right", "-", shift)):
        rod = visual(box("0.02 0.04 0.3"), xyz="0 0 0.15")
        parent, place = "base", f"{x} {sign}0.2 0"
        for name in ("upper", "lower", "tip"):
            parts.append(link(f"{side}_{name}", inertial(1, 0.01), rod))
            turns = axis if name == "lower" else "1 0 0"
            parts.append(
                joint(
                    f"{side}_{name}_j", parent, f"{side}_{name}", limit(-1, 1), kind="revolute", xyz=place, axis=turns
                )
            )
            parent, place = f"{side}_{name}", "0 0 0.3"
        for name, height in (("ear", 0.3), ("eye", 0.4)):
            parts.append(link(f"{side}_{name}", rod))
            hinge = joint(
                f"{side}_{name}_h", "base", f"{side}_{name}", limit(-1, 1), kind="revolute", xyz=f"0 {sign}0.1 {height}"
            )
            parts.append(hinge)
    return robot(*parts)


@pytest.mark.parametrize(
    ("shift", "axis", "messages"),
    [("0.2", "1 0 0", []), ("0.204", "1 0 0", ["stacked"]), ("0.204", "0 1 0", ["origin"])],
)
def test_limbs_in_two_planes_may_lie_one_over_the_other(
    tmp_path: Path, shift: str, axis: str, messages: list[str]
) -> None:
    found = [f for f in find(tmp_path, make_arms(shift=shift, axis=axis), "SYM004") if "_j is" in f.headline]
    assert [one.message_id for one in found] == messages
    assert all("write" not in f.fix.title for f in found if f.message_id == "stacked" and f.fix is not None)


# -- INR008, INR009, INR010 ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("turned", "message"), [(False, "copied"), (True, "shared")])
def test_a_tensor_fits_a_part_about_its_axes_only(tmp_path: Path, turned: bool, message: str) -> None:
    along, across = 0.000123, 0.0123
    rod = inertial(1.234, ixx=across if turned else along, iyy=across, izz=along if turned else across)
    parts = [link("base")]
    for name, length in (("short", 0.12), ("long", 0.346)):
        parts.append(link(name, rod, visual(box(f"{length} 0.0245 0.0245"))))
        parts.append(joint(f"{name}_j", "base", name, kind="continuous", axis="0 0 1"))
    (finding,) = find(tmp_path, robot(*parts), "INR008")
    assert finding.message_id == message
    assert ("tensor fits" in finding.message) == (message == "copied")


@pytest.mark.parametrize(
    ("mass", "moments", "names"),
    [
        (0.1, (1.66667e-4, 1.66667e-4, 1.66667e-4), {"box", "cube"}),
        (0.31, (2.511e-4, 2.511e-4, 2.511e-4), {"sphere"}),
        (2.0, (0.0125 / 3 + 0.006667 / 2, 1.0, 2.0), set()),
        (1.0, (1.0, 1.0, 1.0), set()),
    ],
)
def test_a_solid_of_round_size_has_the_moments(mass: float, moments: tuple[float, ...], names: set[str]) -> None:
    assert name_simple_solids(mass, moments) == names


@pytest.mark.parametrize(
    ("mass", "moment", "message"),
    [(0.1, "0.000166667", "unnamed"), (0.1372, "0.0001372", "exact")],
    ids=["hollow sphere or cube", "sphere"],
)
def test_a_formula_is_named_where_no_other_gives_the_numbers(
    tmp_path: Path, mass: float, moment: str, message: str
) -> None:
    lidar = link("lidar", inertial(mass, moment), visual(cylinder(0.05, 0.1)))
    text = robot(link("base", inertial(1, 0.01)), lidar, joint("j", "base", "lidar", kind="continuous"))
    (finding,) = find(tmp_path, text, "INR009")
    assert finding.message_id == message
    assert (finding.cause is None) == (message == "unnamed")


@pytest.mark.parametrize(
    ("mass", "base", "message"), [("20", "58", "wheel"), ("20.137", "58", "dense"), ("20", "5", "dense")]
)
def test_wheels_may_have_been_made_heavy(tmp_path: Path, mass: str, base: str, message: str) -> None:
    parts = [link("base", inertial(base, 2), visual(box("0.6 0.4 0.3")))]
    for side, y in (("left", 0.2), ("right", -0.2)):
        parts.append(link(f"{side}_wheel", inertial(mass, 0.02), visual(sphere(0.04))))
        parts.append(joint(f"{side}_j", "base", f"{side}_wheel", kind="continuous", xyz=f"0 {y} 0", axis="0 1 0"))
    found = find(tmp_path, robot(*parts), "INR010")
    assert {one.message_id for one in found} == {message}
    assert all((one.severity is Severity.INFO) == (message == "wheel") for one in found)


# -- INR001 --------------------------------------------------------------------------------------------------------------

VIRTUAL = "<!-- virtual joint that shows in RViz where the car is steering -->"


@pytest.mark.parametrize(
    ("comment", "more", "severities"),
    [
        (VIRTUAL, "", {Severity.INFO}),
        ("", "", {Severity.WARNING}),
        ("<!-- the steering -->", "", {Severity.WARNING}),
        ("<!-- not really a virtual joint -->", "", {Severity.WARNING}),
        ("<!-- no virtual joint: it steers -->", "", {Severity.WARNING}),
        ("<!-- it isn't for visualization -->", "", {Severity.WARNING}),
        ("<!-- not steered, virtual -->", "", {Severity.INFO}),
        (VIRTUAL, command("steering", "turning"), {Severity.WARNING}),
        (VIRTUAL, link("tip", inertial(1.0)) + joint("tilting", "roll", "tip", kind="continuous"), {Severity.WARNING}),
        (VIRTUAL, visual(box("0.1 0.1 0.1")), {Severity.WARNING}),
        (VIRTUAL, '<gazebo reference="roll"><sensor name="s" type="imu"/></gazebo>', {Severity.WARNING, Severity.INFO}),
    ],
    ids=[
        *("virtual", "no comment", "another comment", "denied", "denied whole", "denied purpose", "denied otherwise"),
        *("driven", "mass behind", "drawn", "sensor"),
    ],
)
def test_frames_without_mass_that_are_called_virtual_are_an_info(
    tmp_path: Path, comment: str, more: str, severities: set[Severity]
) -> None:
    """A steered axle and a wheel on it, of which only the first has the comment."""
    drawn, more = (more, "") if more.startswith("<visual") else ("", more)
    text = robot(
        link("base", inertial(1.0)), link("wheel", inertial(1.0)), joint("rolling", "base", "wheel", kind="continuous"),
        comment, link("lead", drawn), joint("steering", "base", "lead", kind="continuous"),
        link("roll", drawn), joint("turning", "lead", "roll", kind="continuous"), more,
    )  # fmt: skip
    assert {finding.severity for finding in find(tmp_path, text, "INR001")} == severities
