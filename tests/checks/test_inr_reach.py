"""INR018: units lost by a thousand or a million show where no mesh does, and large links of small files stay quiet."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

import pytest
from builders import find, joint, link, robot

from urdfcheck.core import Cause, Confidence, Finding, Severity

LENGTH = 0.3
MESH = '<visual><geometry><mesh filename="missing.stl"/></geometry></visual>'
BOX = '<visual><geometry><box size="0.3 0.05 0.05"/></geometry></visual>'


def make_arm(
    *, com: float = 1.0, tensor: float = 1.0, wrong: Sequence[int] = (1,), drawn: str = MESH, links: int = 4
) -> str:
    """A chain of rods of 0.3 m; COM and tensor of some are multiplied."""
    parts = []
    for i in range(links):
        lever, moment = (com, tensor) if i in wrong else (1.0, 1.0)
        inertial = (
            f'<inertial><origin xyz="{0.12 * lever} {0.004 * lever} 0"/><mass value="1.3"/><inertia ixx="{0.00052 * moment}" '
            f'ixy="0" ixz="0" iyy="{0.0098 * moment}" iyz="0" izz="{0.0099 * moment}"/></inertial>'
        )
        parts.append(link(f"l{i}", inertial, drawn))
    joints = (joint(f"j{i}", f"l{i}", f"l{i + 1}", kind="continuous", xyz=f"{LENGTH} 0 0") for i in range(links - 1))
    return robot(*parts, *joints)


def find_far(folder: Path, text: str) -> list[Finding]:
    return find(folder, text, {"INR018", "INR005", "INR006", "INR007", "INR009"})


def test_sound_links_without_a_mesh_are_quiet(tmp_path: Path) -> None:
    assert find_far(tmp_path, make_arm()) == []
    assert find_far(tmp_path, make_arm(com=2.0, tensor=6.0)) == []


def test_the_length_is_named_for_what_it_is(tmp_path: Path) -> None:
    # A tensor of 9 kg·m² at 1 kg has a radius of gyration of 3 m about every axis; its mass spreads 3/√2 m along one.
    text = make_arm().replace(
        '<mass value="1.3"/><inertia ixx="0.00052" ixy="0" ixz="0" iyy="0.0098" iyz="0" izz="0.0099"/>',
        '<mass value="1"/><inertia ixx="9" ixy="0" ixz="0" iyy="9" iyz="0" izz="9"/>',
        1,
    )
    (found,) = [finding for finding in find(tmp_path, text, "INR018") if finding.message_id == "spread"]
    assert "an RMS spread of 2.12 m along one axis" in found.message


@pytest.mark.parametrize(("factor", "unit"), [(1e3, "mm"), (1e2, ""), (150.0, "")])
def test_a_unit_is_named_if_no_other_is_possible(tmp_path: Path, factor: float, unit: str) -> None:
    """With 150 the COMs in cm are just longer than those of most robots, and in mm they are among the shortest."""
    (found,) = find_far(tmp_path, make_arm(com=factor, wrong=range(4)))
    assert found.cause == (None if not unit else Cause("unit", f"It fits if the numbers were written in {unit}."))


def test_a_radius_of_gyration_shows_the_tensor_for_the_mass(tmp_path: Path) -> None:
    text = make_arm(tensor=1e6, wrong=range(4))
    small = re.sub(
        r"<inertia [^>]*>", '<inertia ixx="1.3" ixy="0" ixz="0" iyy="24.5" iyz="0" izz="24.7"/>', text, count=1
    )
    found = find_far(tmp_path, small)
    assert {one.cause.text for one in found if one.cause is not None} == {
        "It fits if the numbers were written in kg·mm², or in g·mm² with masses in g."
    }


@pytest.mark.parametrize(
    ("factors", "message", "severity"),
    [
        ({"com": 1e3}, "com", Severity.ERROR),
        ({"com": 1e2}, "com", Severity.ERROR),
        ({"com": 1 / 0.0254}, "com", Severity.WARNING),
        ({"tensor": 1e9}, "spread", Severity.ERROR),
        ({"tensor": 1e6}, "spread", Severity.ERROR),
        ({"tensor": 1e4}, "spread", Severity.WARNING),
    ],
)
def test_a_lost_unit_is_found(tmp_path: Path, factors: dict[str, float], message: str, severity: Severity) -> None:
    (found,) = find_far(tmp_path, make_arm(**factors))  # type: ignore[arg-type]
    assert (found.code, found.message_id, found.severity) == ("INR018", message, severity)
    assert found.confidence is Confidence.STRONG, "the mesh may reach anywhere"
    (drawn,) = find_far(tmp_path, make_arm(**factors, drawn=""))  # type: ignore[arg-type]
    assert (drawn.confidence is Confidence.PROOF) == (severity is Severity.ERROR)
    assert found.cause is None, "a single link fits several units"
    assert found.location.subject.startswith("link[l1]")


@pytest.mark.parametrize(
    ("factors", "unit"),
    [
        ({"com": 1e3}, "mm"),
        ({"com": 1e2}, ""),  # in mm it is a COM as near the frame as others are
        ({"tensor": 1e9}, "g·mm²"),
        ({"tensor": 1e6}, ""),
    ],
)
def test_the_only_unit_that_fits_all_links_is_named(tmp_path: Path, factors: dict[str, float], unit: str) -> None:
    (found,) = find_far(tmp_path, make_arm(**factors, wrong=(0, 1, 2)))  # type: ignore[arg-type]
    named = "" if found.cause is None else found.cause.text
    assert named == (f"It fits if the numbers were written in {unit}." if unit else "")


def test_all_links_of_a_file_are_one_finding(tmp_path: Path) -> None:
    (found,) = find_far(tmp_path, make_arm(com=1e3, wrong=(0, 1, 2)))
    assert len(found.subjects) == 3
    assert "l0, l1, l2" in found.message


def test_a_link_whose_geometry_is_known_is_left_to_the_rules_about_it(tmp_path: Path) -> None:
    found = find_far(tmp_path, make_arm(com=1e3, drawn=BOX))
    assert found
    assert "INR018" not in {finding.code for finding in found}


def add_fixed(text: str, mass: float, com: float, *, drawn: str = "") -> str:
    """Fix a link to the arm's second one."""
    inertial = (
        f'<inertial><origin xyz="{com} 0 0"/><mass value="{mass}"/>'
        '<inertia ixx="1e-6" ixy="0" ixz="0" iyy="1.1e-6" iyz="0" izz="1.2e-6"/></inertial>'
    )
    return text.replace("</robot>", link("added", inertial, drawn) + joint("to_added", "l1", "added") + "</robot>")


@pytest.mark.parametrize(
    ("mass", "com", "found"),
    [(0.01, 0.1, False), (0.01, 90.0, True), (0.01, 3.0, True), (0.2, 3.0, True)],
)
def test_a_light_link_counts_by_how_far_it_moves_its_body(tmp_path: Path, mass: float, com: float, found: bool) -> None:
    far = find_far(tmp_path, add_fixed(make_arm(), mass, com))
    assert [finding.code for finding in far] == ["INR018"] * found


def test_the_com_of_a_link_that_draws_nothing_is_checked_on_a_drawn_body(tmp_path: Path) -> None:
    (found,) = find_far(tmp_path, add_fixed(make_arm(drawn=BOX), 0.5, 10.0))
    assert (found.code, found.message_id) == ("INR018", "com")


def test_a_typed_tensor_is_one_and_has_no_unit(tmp_path: Path) -> None:
    typed = 'ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"'
    computed = 'ixx="0.00052" ixy="0" ixz="0" iyy="0.0098" iyz="0" izz="0.0099"'
    (found,) = find_far(tmp_path, make_arm().replace(computed, typed, 1).replace('value="1.3"', 'value="0.4"', 1))
    assert found.cause is not None
    assert found.cause.text == "The inertia is 1 × identity kg·m², typed rather than computed."


def test_two_joints_do_not_say_how_large_a_robot_is(tmp_path: Path) -> None:
    assert find_far(tmp_path, make_arm(com=1e3, links=3)) == []
    assert find_far(tmp_path, make_arm(com=1e3, links=4)) != []


def test_a_shape_elsewhere_makes_the_robot_larger(tmp_path: Path) -> None:
    far = make_arm(com=20.0)
    assert [f.severity for f in find_far(tmp_path, far)] == [Severity.WARNING]
    mast = link("mast", '<visual><geometry><box size="30 30 30"/></geometry></visual>')
    larger = far.replace("</robot>", mast + joint("to_mast", "l3", "mast") + "</robot>")
    assert find_far(tmp_path, larger) == []


@pytest.mark.parametrize("value", ["nan", "1e308", "inf", "x"])
def test_numbers_that_are_none_are_left_to_other_rules(tmp_path: Path, value: str) -> None:
    text = make_arm().replace('<origin xyz="0.12 0.004 0"/>', f'<origin xyz="{value} 0 0"/>', 1)
    find_far(tmp_path, text)
    find_far(tmp_path, make_arm().replace('ixx="0.00052"', f'ixx="{value}"', 1))


def test_the_spread_along_three_axes_together_is_that_of_a_longer_body(tmp_path: Path) -> None:
    """A robot of 1.2 m: 0.9 m along each axis is 1.56 m in all, and no body has more than 0.61 of its length."""
    text = make_arm(links=5).replace(
        '<mass value="1.3"/><inertia ixx="0.00052" ixy="0" ixz="0" iyy="0.0098" iyz="0" izz="0.0099"/>',
        '<mass value="1"/><inertia ixx="1.62" ixy="0" ixz="0" iyy="1.62" iyz="0" izz="1.63"/>',
    )
    (found,) = [finding for finding in find(tmp_path, text, "INR018") if finding.message_id == "spread"]
    assert found.severity == Severity.WARNING


def test_a_mesh_that_was_not_read_is_not_said_to_be_nothing(tmp_path: Path) -> None:
    (unread,) = find_far(tmp_path, make_arm(com=1e3))
    assert "A mesh of the link was not read" in unread.message
    assert "the robot's joints and shapes, as far as they are known, span" in unread.message
    assert "its known parts span" in unread.headline
    (undrawn,) = find_far(tmp_path, make_arm(com=1e3, drawn=""))
    assert "Nothing that the file places on the link is farther" in undrawn.message
    assert "the robot is" in undrawn.headline


def test_the_mesh_that_was_not_read_may_be_that_of_a_link_fixed_to_it(tmp_path: Path) -> None:
    text = make_arm(com=1e3, drawn=BOX).replace("</robot>", f"{link('cover', MESH)}{joint('k', 'l1', 'cover')}</robot>")
    found = next(one for one in find(tmp_path, text, {"INR018"}))
    assert "A mesh of cover, which is fixed to it, was not read" in found.message


def test_an_unread_mesh_reaches_to_its_origin_at_least(tmp_path: Path) -> None:
    placed = MESH.replace("<geometry>", '<origin xyz="1.8 0 0"/><geometry>')
    assert find_far(tmp_path, make_arm(com=15.0, drawn=MESH)) != []
    assert find_far(tmp_path, make_arm(com=15.0, drawn=placed)) == []


@pytest.mark.parametrize(("wrong", "said"), [(range(4), True), ((1,), False)])
def test_the_origins_of_the_joints_may_be_wrong_where_most_coms_are_beyond_them(
    tmp_path: Path, wrong: Sequence[int], said: bool
) -> None:
    (found,) = find_far(tmp_path, make_arm(com=150.0, wrong=wrong))
    assert found.fix is not None
    assert ("the origins of the joints are wrong" in found.fix.title) == said
