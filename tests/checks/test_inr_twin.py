"""INR003 and INR004: points about an origin, and what the link on the other side shows of an impossible tensor."""

from __future__ import annotations

from pathlib import Path

import pytest
from builders import arm_on_base, box, find, inertial, joint, link, robot, visual


def make_head(mass: float, com: str, **six: float) -> str:
    return arm_on_base(inertial(mass, com=com, **six), base=inertial(2, 0.01))


@pytest.mark.parametrize(
    ("com", "six", "slip"),
    [
        ("0.06 0 0.012", {"ixx": 5.378e-05, "ixz": -0.00026892, "iyy": 0.00139838, "izz": 0.0013446}, ""),
        ("0.06 0 0.012", {"ixx": 5.378e-05, "ixz": 0.00026892, "iyy": 0.00139838, "izz": 0.0013446}, ""),
        ("0.06 0 0.012", {"ixx": 5.379e-05, "ixz": -0.00026892, "iyy": 0.00139838, "izz": 0.0013446}, ""),
        ("0.021 0 0", {"ixx": 0, "iyy": 0.00016471, "izz": 0.00016471}, ""),
        (
            "0.009 0 0.012",
            {"ixx": 5.378e-05, "ixz": -0.00040338, "iyy": 0.00307913, "izz": 0.00302535},
            "arm: the point has x = 0.09, not 0.009 as the COM has",
        ),
    ],
)
def test_a_point_about_the_origin_is_told_by_its_mass_and_com(
    tmp_path: Path, com: str, six: dict[str, float], slip: str
) -> None:
    """On either side of possible, with either sign of the products, on an axis, and with a slip in the COM."""
    (finding,) = find(tmp_path, make_head(0.3735, com, **six), {"INR003", "INR004", "INR005", "INR012"})
    assert finding.message_id == "term"
    assert finding.message.endswith(f". {slip}" if slip else "nothing is left of it")


def test_a_rod_beside_its_joint_is_no_point(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, make_head(0.3, "0.1 0 0", ixx=0, iyy=0.001, izz=0.001), "INR004")
    assert finding.message_id == "line"


def test_points_about_the_origin_are_one_finding(tmp_path: Path) -> None:
    heads = [
        (0.06, 5.378e-05, -0.00026892, 0.00139838, 0.0013446),
        (0.108, 5.3784e-05, -0.000484056, 0.004410288, 0.004356504),
    ]
    parts = [link("base", inertial(2, 0.01))]
    for i, (x, ixx, ixz, iyy, izz) in enumerate(heads):
        numbers = inertial(0.3735, com=f"{x} 0 0.012", ixx=ixx, ixz=ixz, iyy=iyy, izz=izz)
        parts += [link(f"head_{i}", numbers), joint(f"j{i}", "base", f"head_{i}", kind="continuous")]
    (finding,) = find(tmp_path, robot(*parts), "INR004")
    assert finding.headline == "head_0, head_1: inertia of a point at the COM, about the link's origin"
    assert len(finding.subjects) == len(heads)


def test_a_product_and_its_limit_are_told_apart(tmp_path: Path) -> None:
    arm = inertial(0.37, ixx=5.378e-05, ixz=-0.00040338, iyy=0.0031, izz=0.00302535)
    (finding,) = find(tmp_path, arm_on_base(arm, base=inertial(2, 0.01)), "INR004")
    assert finding.message_id == "product"
    assert finding.headline == "arm: ixz = -0.00040338 is impossible (limit 0.00040336)"
    assert finding.fix is not None
    assert "in the order" not in finding.fix.title


@pytest.mark.parametrize(("izz", "words"), [(4e-8, "again, as the known ones are up to"), (6.4e-7, "as in right_foot")])
def test_a_zero_tensor_is_compared_with_that_of_the_other_side(tmp_path: Path, izz: float, words: str) -> None:
    shape = visual(box("0.025 0.025 0.025"))
    text = robot(
        link("base", inertial(2, 0.01)),
        joint("left", "base", "left_foot", kind="continuous", xyz="0 0.1 0"),
        joint("right", "base", "right_foot", kind="continuous", xyz="0 -0.1 0"),
        link("left_foot", inertial(0.007, 0), shape),
        link("right_foot", inertial(0.007, ixx=7.6e-7, iyy=7.6e-7, izz=izz), shape),
    )
    (finding,) = find(tmp_path, text, "INR004")
    assert finding.message_id == "point"
    assert finding.fix is not None
    assert words in finding.fix.title
    assert f'izz="{izz:g}"' in finding.fix.title


def make_hips(izz: str, *, com: str = "0.002 {} -0.03") -> str:
    """Return two hips that are mirror images, but for one number of the left one; the drawing has its COM elsewhere."""
    parts = [link("base", inertial(20, 0.3))]
    for side, sign, own in (("left", 1, izz), ("right", -1, "0.0121")):
        numbers = inertial(
            4.7, com=com.format(0.037 * sign), ixx=0.0422, ixz=-0.002, iyy=0.0469, iyz=0.0055 * sign, izz=own
        )
        shapes = (
            visual(box("0.1 0.1 0.3"), xyz=f"0.01 {0.02 * sign} -0.16"),
            visual(box("0.06 0.06 0.06"), xyz=f"0.05 {0.08 * sign} -0.02"),
        )
        parts += [
            joint(f"{side}_joint", "base", f"{side}_hip", kind="continuous", xyz=f"0 {0.1 * sign} 0", axis="0 1 0"),
            link(f"{side}_hip", numbers, *shapes),
        ]
    return robot(*parts)


def test_the_number_of_the_twin_comes_before_the_drawn_part(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, make_hips("0.0055"), "INR003")
    assert finding.fix is not None
    assert finding.fix.title == 'write izz="0.0121", the number of right_hip, or compute the inertia tensor again'
    assert "xyz=" not in finding.fix.title


def test_a_com_that_both_sides_have_stays(tmp_path: Path) -> None:
    """Two numbers differ from the twin's: nothing but the drawn part shows the tensor, and its COM is another one."""
    text = make_hips("0.0005").replace('iyy="0.0469"', 'iyy="0.0669"', 1)
    (finding,) = find(tmp_path, text, {"INR003", "INR004"})
    assert finding.fix is not None
    assert "xyz=" not in finding.fix.title
