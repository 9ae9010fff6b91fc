"""Mass and inertia against what is drawn: where the rules begin and end."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from builders import arm_on_base, box, collision, cylinder, find, inertial, joint, link, mesh, robot, visual
from castings import CASTING, DeclaredInertial, edited, format_inertial, geometry, uniform, write_stl
from numpy.typing import NDArray

from urdfcheck.core import Severity
from urdfcheck.facts.inertials.hull_bounds import measure_extent, measure_hull_distance
from urdfcheck.facts.inertials.inertia_tensor import compute_solid_inertia, make_box_solid
from urdfcheck.facts.mesh.convex_hull import compute_convex_hull
from urdfcheck.facts.mesh.diameter import measure_diameter
from urdfcheck.facts.motion.kinematics import matrix_to_rpy, rpy_to_matrix
from urdfcheck.model import Model
from urdfcheck.model.shapes.corners import collect_rigid_corners
from urdfcheck.model.shapes.visual_solid import measure_link_geometry
from urdfcheck.source.load import load_source
from urdfcheck.source.package.finder import PackageFinder

Array = NDArray[np.float64]
CODES = {"INR005", "INR006", "INR007", "INR008", "INR010"}


@dataclass(frozen=True)
class Part:
    """A link that draws a box: where it is, and what its inertial says. ``turned``: rpy of the inertial's own axes."""

    size: tuple[float, float, float] = (0.1, 0.06, 0.04)
    place: Array | tuple[float, ...] = (0.0, 0.0, 0.0)
    rotation: Array | None = None
    mass: float = 0.6
    com: Array | tuple[float, ...] | None = None
    tensor: Array | None = None
    turned: tuple[float, ...] = (0.0, 0.0, 0.0)

    @property
    def pose(self) -> Array:
        return np.eye(3) if self.rotation is None else self.rotation

    @property
    def inertia(self) -> Array:
        """In the link's axes; that of the box where none is given."""
        own = self.pose @ compute_solid_inertia(make_box_solid(self.size), self.mass) @ self.pose.T
        return own if self.tensor is None else self.tensor

    def xml(self, name: str) -> str:
        axes = rpy_to_matrix(self.turned)
        i = axes.T @ self.inertia @ axes
        com = self.place if self.com is None else self.com
        six = (
            "".join(
                f' i{"xyz"[a]}{"xyz"[b]}="{i[a, b]!r}"' for a, b in ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))
            )
            .replace("np.float64(", "")
            .replace(")", "")
        )
        return (
            f'<link name="{name}"><inertial><origin xyz="{text(com)}" rpy="{text(self.turned)}"/>'
            f'<mass value="{self.mass!r}"/><inertia{six}/></inertial><visual>'
            f'<origin xyz="{text(self.place)}" rpy="{text(matrix_to_rpy(self.pose))}"/>'
            f'<geometry><box size="{text(self.size)}"/></geometry></visual></link>'
        )


def text(numbers: object) -> str:
    return " ".join(repr(float(n)) for n in np.asarray(numbers))


def make_chain(*links: str, kind: str = "continuous", xyz: str = "0 0 0") -> str:
    """Return the links one after the other, each on the one before."""
    names = [link.split('"')[1] for link in links]
    joints = (joint(f"j{i}", a, b, kind=kind, xyz=xyz) for i, (a, b) in enumerate(pairwise(names)))
    return robot(*links, *joints)


def make_arm(part: Part) -> str:
    return make_chain('<link name="base"/>', part.xml("arm"))


def codes(folder: Path, content: str) -> list[str]:
    return sorted(f.code for f in find(folder, content, CODES))


# -- INR005 ---------------------------------------------------------------------------------------------------------


def dumbbell(part: Part, share: float) -> Part:
    """The same mass as two lumps, ``share`` of the way from the middle of the box to its ends."""
    spread = np.diag((np.array(part.size) / 2 * share) ** 2 * (1, 0.01, 0.01))
    return replace(part, tensor=part.mass * (np.trace(spread) * np.eye(3) - spread))


@pytest.mark.parametrize(("share", "exceeds"), [(0.5, False), (1.0, False), (1.09, False), (1.15, True), (3.0, True)])
def test_two_lumps_at_the_ends_are_the_greatest_inertia(tmp_path: Path, share: float, exceeds: bool) -> None:
    assert codes(tmp_path, make_arm(dumbbell(Part(), share))) == (["INR005"] if exceeds else [])


def test_the_message_tells_the_ratio_and_both_spreads(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, make_arm(replace(Part(), tensor=98.7654321 * Part().inertia)), CODES)
    # A tenth of a metre, and 2 % of its 0.1233 m from corner to corner on both sides.
    half = 0.05 + 0.02 * 0.1233
    assert finding.data["ratio"] == pytest.approx(98.7654321 * 0.1**2 / 12 / half**2, rel=0.01)
    assert finding.data["spread"] == pytest.approx(98.7654321**0.5 * 0.1 / 12**0.5, rel=0.01)
    assert finding.data["most"] == pytest.approx(half, rel=0.01)
    assert "inside the drawn geometry" in finding.message


def test_the_headline_compares_spreads_and_not_moments(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, make_arm(replace(Part(), tensor=98.7654321 * Part().inertia)), CODES)
    assert finding.data["wider"] == pytest.approx(finding.data["spread"] / finding.data["most"], rel=0.01)
    assert f"needs mass spread {finding.data['wider']:g}× wider" in finding.headline


def test_one_mistake_that_explains_the_excess_is_named_and_undone(tmp_path: Path) -> None:
    part = Part(size=(0.3, 0.2, 0.1))
    content = make_arm(replace(part, tensor=1e4 * part.inertia))
    (finding,) = find(tmp_path, content, {"INR005"})
    assert finding.message.endswith("It fits one mistake: unit of the tensor: kg·cm²")
    assert finding.fix is not None
    assert find(tmp_path, edited(content, finding.fix.edits), CODES) == []
    # The rule about causes speaks first.
    assert [f.code for f in find(tmp_path, content, {*CODES, "INR009"})] == ["INR009"]


@pytest.mark.parametrize(("digits", "exceeds"), [("1e-6", False), ("1.00e-6", True)])
def test_digits_that_were_rounded_away_are_no_excess(tmp_path: Path, digits: str, exceeds: bool) -> None:
    # 1.5 times what a cube of 20 mm can have; with one digit it may as well be half of that.
    six = f'ixx="{digits}" ixy="0" ixz="0" iyy="{digits}" iyz="0" izz="3e-7"'
    inertial = f'<inertial><mass value="0.005"/><inertia {six}/></inertial>'
    drawn = '<visual><geometry><box size="0.02 0.02 0.02"/></geometry></visual>'
    content = make_chain('<link name="base"/>', f'<link name="arm">{inertial}{drawn}</link>')
    assert bool(find(tmp_path, content, {"INR005"})) == exceeds


def test_what_a_fixed_link_draws_may_hold_the_mass(tmp_path: Path) -> None:
    heavy = replace(Part(), tensor=20 * Part().inertia)
    cover = '<link name="cover"><visual><geometry><box size="0.6 0.4 0.3"/></geometry></visual></link>'
    alone = make_arm(heavy)
    assert codes(tmp_path / "a", alone) == ["INR005"]
    fixed = '<joint name="f" type="fixed"><parent link="arm"/><child link="cover"/></joint></robot>'
    assert codes(tmp_path / "b", alone.replace("</robot>", cover + fixed)) == []
    assert codes(tmp_path / "c", alone.replace("</robot>", cover + fixed.replace("fixed", "continuous"))) == ["INR005"]


def test_a_light_link_of_a_heavy_body_decides_nothing(tmp_path: Path) -> None:
    sensor = replace(Part(size=(0.02, 0.02, 0.02), mass=0.01), tensor=np.diag((1.1e-5, 1.2e-5, 1.3e-5)))
    assert codes(tmp_path / "a", make_chain(Part(mass=3.0).xml("body"), sensor.xml("sensor"), kind="fixed")) == []
    assert codes(tmp_path / "b", make_chain(Part(mass=3.0).xml("body"), sensor.xml("sensor"))) == ["INR005"]


def test_a_light_link_whose_com_is_many_sizes_away_moves_its_body(tmp_path: Path) -> None:
    for place, expected in ((0.3, []), (9.0, ["INR006"])):
        sensor = replace(Part(size=(0.02, 0.02, 0.02), mass=0.01), com=(place, 0, 0))
        text = make_chain(Part(mass=3.0).xml("body"), sensor.xml("sensor"), kind="fixed")
        assert codes(tmp_path / f"{place}", text) == expected


# -- INR006 ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("x", "outside"), [(0.0, False), (0.05, False), (0.062, False), (0.064, True), (-0.064, True)])
def test_the_centre_of_mass_may_lie_a_tenth_of_the_size_outside(tmp_path: Path, x: float, outside: bool) -> None:
    # The box is 0.1233 m from corner to corner, and ends at 0.05 m.
    content = make_arm(replace(Part(), com=(x, 0, 0)))
    assert bool(find(tmp_path, content, {"INR006"})) == outside


@pytest.mark.parametrize(
    ("size", "digits", "cause"),
    [("0.1 0.02 0.02", "", "copied"), ("0.02 0.1 0.02", "", None), ("0.1 0.02 0.02", "1", None)],
)
def test_an_inertial_of_links_that_are_drawn_otherwise_was_copied(
    tmp_path: Path, size: str, digits: str, cause: str | None
) -> None:
    def part(name: str, edges: str, mass: str) -> str:
        return link(
            name, inertial(mass, ixx=7.04e-5, iyy=2.609e-4, izz=2.561e-4, com="0.14 0.01 0"), visual(box(edges))
        )

    one, other = part("one", "0.02 0.1 0.02", "0.2888"), part("other", size, f"0.2888{digits}")
    joints = [joint(f"j_{name}", "base", name, kind="continuous", axis="0 0 1") for name in ("one", "other")]
    text = robot(link("base", inertial(2, 0.01)), one, other, *joints)
    found = [f for f in find(tmp_path, text, {"INR006"}) if "link[one]" in f.subjects[0]]
    assert [finding.cause and finding.cause.id for finding in found] == [cause]


def test_a_mass_at_the_end_of_its_part_cannot_spread(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, make_arm(replace(Part(), com=(0.05, 0, 0))), CODES)
    assert finding.code == "INR005"


def test_a_bracket_has_its_centre_of_mass_beside_its_material(tmp_path: Path) -> None:
    def leg(x: float, y: float, a: float, b: float) -> str:
        return f'<visual><origin xyz="{x} {y} 0"/><geometry><box size="{a} {b} 0.01"/></geometry></visual>'

    inertial = (
        '<inertial><origin xyz="0.03 0.03 0"/><mass value="0.2"/>'
        '<inertia ixx="0.0001" ixy="0" ixz="0" iyy="0.0001" iyz="0" izz="0.00018"/></inertial>'
    )
    angle = f'<link name="arm">{inertial}{leg(0.05, 0, 0.1, 0.01)}{leg(0, 0.05, 0.01, 0.1)}</link>'
    assert codes(tmp_path, make_chain('<link name="base"/>', angle)) == []


@pytest.mark.parametrize(("x", "message"), [(-0.16, "sign"), (-0.19, "outside"), (0.3, "outside"), (0.0, "outside")])
def test_a_sign_is_named_when_the_other_one_is_near_the_parts_own(tmp_path: Path, x: float, message: str) -> None:
    # The box is 0.1233 m from corner to corner: the other sign may miss its middle at 0.15 m by 12 mm.
    (finding,) = find(tmp_path, make_arm(replace(Part(place=(0.15, 0, 0)), com=(x, 0.001, 0))), {"INR006"})
    assert finding.message_id == message
    end = " (sign of x?)" if message == "sign" else ""
    assert re.fullmatch(rf"arm: COM is [\d.]+ mm outside the part{re.escape(end)}", finding.headline)
    assert finding.fix is not None
    edits = [(e.expected, e.replacement) for e in finding.fix.edits]
    assert edits == ([("-0.16 0.001 0.0", "0.16 0.001 0.0")] if message == "sign" else [])


@pytest.mark.parametrize(("times", "message"), [(1.0, "sign"), (3.0, "sign"), (20.0, "outside"), (0.05, "outside")])
def test_a_tensor_of_another_body_shows_no_sign(tmp_path: Path, times: float, message: str) -> None:
    part = Part(place=(0.15, 0, 0))
    found = find(tmp_path, make_arm(replace(part, com=(-0.16, 0.001, 0), tensor=times * part.inertia)), {"INR006"})
    assert [(finding.message_id, bool(finding.fix and finding.fix.edits)) for finding in found] == [
        (message, message == "sign")
    ]


def test_a_centre_of_mass_that_was_not_given_is_told(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, make_arm(replace(Part(place=(0.15, 0, 0)), com=(0, 0, 0))), {"INR006"})
    assert finding.cause is not None
    assert finding.cause.id == "missing"


@pytest.mark.parametrize(
    ("times", "others", "message"),
    [(1.0, 0, "drawn"), (2.0, 0, "outside"), (2.0, 3, "drawn")],
    ids=["the mesh's tensor", "another tensor", "the custom of the file"],
)
def test_a_mesh_at_the_com_with_another_zero_is_drawn_in_the_wrong_place(
    tmp_path: Path, times: float, others: int, message: str
) -> None:
    blocks = [((0.05, 0.03, 0.02), (0.0, 0.017, 0.199))]
    write_stl(tmp_path / "part.stl", blocks)
    true = uniform(geometry(blocks).solid)

    def make_link(name: str, com: Sequence[float], file: str) -> str:
        shape = visual(mesh(file), xyz=" ".join(map(str, com)))
        return link(name, format_inertial(replace(true, com=np.array(com), tensor=times * true.tensor)), shape)

    parts = [make_link("arm", (0.012345678, -0.000458903, -0.0137673), "part.stl")]
    for i in range(others):
        parts.append(joint(f"j{i}", "arm", f"l{i}", kind="continuous"))
        parts.append(make_link(f"l{i}", (0.02 * i, 0.0154321, 0.0), "absent.stl"))
    parts += [joint("j", "base", "arm", kind="continuous"), link("base")]
    (finding,) = find(tmp_path, robot(*parts), {"INR006"})
    assert finding.message_id == message
    assert ("visual" in finding.location.subject) == (message == "drawn")


@pytest.mark.parametrize("count", [2, 600])
def test_the_size_that_is_told_is_the_greatest_distance(count: int) -> None:
    """The corners crowd at one end, so that their mean is not in the middle."""
    crowd = np.tile((0.0, 0.0, 0.0), (count, 1))
    points = np.concatenate((crowd, [(0.3, 0.4, 0.0)]))
    assert measure_diameter(points) == pytest.approx(0.5)
    assert measure_extent(points) > 0.5


@pytest.mark.parametrize("thickness", [0.1, 0.0])
@pytest.mark.parametrize("count", [900, 3000])
def test_the_greatest_distance_of_many_points_is_that_of_all_pairs(count: int, thickness: float) -> None:
    points = np.random.default_rng(3).normal(size=(count, 3)) * (1.0, 0.8, thickness)
    apart = np.linalg.norm(points[:, None] - points[None], axis=2)
    assert measure_diameter(points) == pytest.approx(float(apart.max()), rel=1e-12)


def test_nothing_is_said_about_a_link_whose_mesh_is_missing(tmp_path: Path) -> None:
    content = make_arm(replace(Part(), com=(9, 9, 9), tensor=1e6 * Part().inertia))
    mesh = '<visual><geometry><mesh filename="lost.stl"/></geometry></visual></link><joint'
    assert codes(tmp_path, content.replace("</link><joint", mesh)) == []


COLLADA = """<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="u" meter="{unit}"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="s"><float_array id="a" count="12">{points}</float_array>
<technique_common><accessor source="#a" count="4" stride="3">
<param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#s"/></vertices>
<triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/><p>0 2 1 0 1 3 0 3 2 1 2 3</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="c"><node><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#c"/></scene>
</COLLADA>"""


@pytest.mark.parametrize(
    ("unit", "com", "outside"),
    [
        (1.0, "0.05 0.05 0.05", False),
        (1.0, "1 1 1", True),
        (0.1, "1 1 1", False),  # inside for programs that pass over the unit: MSH008
        (0.1, "9 9 9", True),
        (10.0, "1 1 1", False),  # inside for programs that follow it
    ],
)
def test_both_readings_of_colladas_unit_must_agree(tmp_path: Path, unit: float, com: str, outside: bool) -> None:
    edge = 4 if unit == 0.1 else 0.4
    corners = f"0 0 0 {edge} 0 0 0 {edge} 0 0 0 {edge}"
    (tmp_path / "arm.dae").write_text(COLLADA.format(unit=unit, points=corners))
    inertial = (
        f'<inertial><origin xyz="{com}"/><mass value="1"/>'
        '<inertia ixx="1.1e-4" ixy="0" ixz="0" iyy="1.2e-4" iyz="0" izz="1.3e-4"/></inertial>'
    )
    drawn = '<visual><geometry><mesh filename="arm.dae"/></geometry></visual>'
    content = make_chain('<link name="base"/>', f'<link name="arm">{inertial}{drawn}</link>')
    assert codes(tmp_path, content) == (["INR006"] if outside else [])


# -- INR007 ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("moment", "told"),
    [
        (5e-05, True),
        (0.00016, True),  # 4.3 times too small
        (0.0002, True),  # 3.4 times: an estimate
        (0.0005, False),
        (0.0003, False),
        (0.001, True),
        (0.0011, True),
        (0.00113, False),
        (1.0, True),
    ],
)
def test_a_round_tensor_is_told_when_it_is_far_from_the_shape(tmp_path: Path, moment: float, told: bool) -> None:
    # 0.6 kg that fill this box have 0.00026, 0.00058 and 0.00068 kg m².
    content = make_arm(replace(Part(), tensor=moment * np.eye(3)))
    assert bool(find(tmp_path, content, {"INR007"})) == told


@pytest.mark.parametrize(
    ("moment", "gazebo", "mujoco"),
    [(5e-05, "too little inertia", "too little inertia"), (1.0, "too much inertia", "loads it")],
)
def test_effects_of_a_placeholder_are_those_of_its_direction(
    tmp_path: Path, moment: float, gazebo: str, mujoco: str
) -> None:
    (finding,) = find(tmp_path, make_arm(replace(Part(), tensor=moment * np.eye(3))), {"INR007"})
    assert finding.data["size"] == ("large" if "much" in gazebo else "small")
    assert finding.consequences["gazebo"].startswith(gazebo)
    assert finding.consequences["mujoco"].startswith(mujoco)


def test_a_cube_may_have_a_round_tensor(tmp_path: Path) -> None:
    cube = Part(size=(0.2, 0.2, 0.2), mass=1.5, tensor=0.01 * np.eye(3))
    assert codes(tmp_path, make_arm(cube)) == []


def test_all_links_with_one_placeholder_are_one_finding(tmp_path: Path) -> None:
    masses = (0.011, 0.022, 0.033)
    fingers = [Part(size=(0.02, 0.02, 0.04), mass=m, tensor=0.001 * np.eye(3)).xml(f"f{m}") for m in masses]
    (finding,) = find(tmp_path, make_chain('<link name="base"/>', *fingers), CODES)
    assert (finding.code, len(finding.subjects), len(finding.related)) == ("INR007", 3, 2)
    assert finding.headline == "3 links have a placeholder inertia (f0.011: 550× too large)"
    assert finding.fix is not None
    assert [(e.expected, float(e.replacement)) for e in finding.fix.edits] == [
        ("0.001", pytest.approx(mass * i / 12, rel=1e-3)) for mass in masses for i in (0.002, 0.002, 0.0008)
    ]


@pytest.mark.parametrize(("mass", "edits"), [(0.013, 3), (0.01, 0)])
def test_a_round_mass_decides_no_inertia(tmp_path: Path, mass: float, edits: int) -> None:
    """It is a placeholder as well."""
    finger = Part(size=(0.02, 0.02, 0.04), mass=mass, tensor=0.001 * np.eye(3))
    (finding,) = find(tmp_path, make_arm(finger), CODES)
    assert finding.fix is not None
    assert (finding.code, len(finding.fix.edits)) == ("INR007", edits)


@pytest.mark.parametrize(("axis", "message"), [("0 0 1", "placeholder"), ("0 1 3", "placeholder"), ("1 0 0", "rod")])
def test_a_rod_that_is_wrong_about_its_own_length_only_is_an_info(tmp_path: Path, axis: str, message: str) -> None:
    """Its moments are 3e-4, 3e-4 and 6e-6: 2e-4 times the identity is near the two that matter where it swings."""
    rod = Part(size=(0.01, 0.01, 0.1), mass=0.36, tensor=2e-4 * np.eye(3))
    chain = make_chain('<link name="base"/>', rod.xml("rod"))
    assert chain.count("<axis") <= 1
    turned = re.sub(r"<axis[^>]*>", "", chain).replace("</joint>", f'<axis xyz="{axis}"/></joint>')
    (finding,) = find(tmp_path, turned, {"INR007"})
    assert (finding.severity, finding.message_id) == (Severity.INFO, message)
    assert ("about its length" in finding.headline) == (message == "rod")
    both = [rod.xml("rod"), Part(size=(0.01, 0.01, 0.1), mass=0.036, tensor=2e-4 * np.eye(3)).xml("light")]
    (finding,) = find(tmp_path, make_chain('<link name="base"/>', *both), {"INR007"})
    assert finding.severity == Severity.WARNING
    assert finding.headline == "2 links have a placeholder inertia (light: 6.6× too large)"


def test_a_root_that_outweighs_the_robot_tenfold_is_ballast(tmp_path: Path) -> None:
    """Its moments are 7: 20 times the identity is a choice for what never moves, and not for what carries half the robot, nor
    for the body of a robot on wheels."""
    told = {}
    for mass, name in ((1000.0, "arm"), (50.0, "arm"), (1000.0, "wheel")):
        stand = Part(size=(0.2, 0.2, 0.2), mass=mass, tensor=200.0 * np.eye(3))
        limb = [
            f'<link name="{name}{n}"><inertial><mass value="15"/><inertia ixx="0.3" iyy="0.4" izz="0.5"/></inertial></link>'
            for n in range(2)
        ]
        told[mass, name] = find(tmp_path / f"{mass}{name}", make_chain(stand.xml("stand"), *limb), {"INR007"})
    assert not told[1000.0, "arm"]
    assert [(f.message_id, f.severity) for f in told[50.0, "arm"]] == [("bolted", Severity.INFO)]
    assert [f.message_id for f in told[1000.0, "wheel"]] == ["placeholder"]


def test_the_base_of_a_hand_moves_with_the_arm_that_carries_it(tmp_path: Path) -> None:
    palm = Part(size=(0.1, 0.1, 0.1), mass=1.0, tensor=np.eye(3)).xml("palm")
    fingers = [
        Part(size=(0.02, 0.02, 0.06), mass=0.05, tensor=np.diag((1.7e-5, 1.7e-5, 3.3e-6))).xml(f"finger{n}")
        for n in range(2)
    ]
    joints = [joint(f"j{n}", "palm", f"finger{n}", kind="continuous") for n in range(2)]
    (finding,) = find(tmp_path, robot(palm, *fingers, *joints), {"INR007"})
    assert finding.message_id == "placeholder"


@pytest.mark.parametrize(("size", "told"), [(5.0, True), (50.0, False)])
def test_the_ground_of_a_simulated_world_is_not_a_part(tmp_path: Path, size: float, told: bool) -> None:
    ground = Part(size=(size, size, 0.1), mass=5000.0, tensor=0.1 * np.eye(3)).xml("ground")
    assert bool(find(tmp_path / "alone", make_chain(ground), {"INR007"})) == told
    moving = make_chain('<link name="base"/>', ground)
    assert find(tmp_path / "moving", moving, {"INR007"})


def test_a_placeholder_is_named_where_nothing_is_drawn_if_it_fits_no_drawing(tmp_path: Path) -> None:
    """1 kg with 1 times the identity, on two boxes of 0.1 m and on a link that draws nothing."""
    boxes = [Part(mass=1.0, tensor=np.eye(3)).xml(name) for name in ("one", "two")]
    (finding,) = find(tmp_path / "a", make_chain(*boxes, bare("tip", 1, 1)), {"INR007"})
    assert {subject.split("/")[0] for subject in finding.subjects} == {"link[one]", "link[two]", "link[tip]"}
    near = Part(size=(2.4, 2.4, 2.4), mass=1.0, tensor=np.eye(3)).xml("near")
    (finding,) = find(tmp_path / "b", make_chain(*boxes, near, bare("tip", 1, 1)), {"INR007"})
    assert "link[tip]" not in {subject.split("/")[0] for subject in finding.subjects}


def test_a_placeholder_that_happens_to_be_near_is_one_as_well(tmp_path: Path) -> None:
    """5.8e-4 is what the box of `Part` has; of one twice as large the number is nothing."""
    moment = 5e-4 * np.eye(3)
    near, far = Part(tensor=moment), Part(size=(0.2, 0.12, 0.08), mass=4.8, tensor=moment)
    assert not find(tmp_path / "a", make_chain('<link name="base"/>', near.xml("near")), {"INR007"})
    (finding,) = find(tmp_path / "b", make_chain('<link name="base"/>', near.xml("near"), far.xml("far")), {"INR007"})
    assert {subject.split("/")[0] for subject in finding.subjects} == {"link[near]", "link[far]"}


def bare(name: str, mass: float, moment: float) -> str:
    six = f'ixx="{moment}" ixy="0" ixz="0" iyy="{moment}" iyz="0" izz="{moment}"'
    return f'<link name="{name}"><inertial><mass value="{mass}"/><inertia {six}/></inertial></link>'


@pytest.mark.parametrize(("masses", "told"), [((1, 2), False), ((1, 1, 1), False), ((1, 2, 3), True)])
def test_links_that_draw_nothing_are_told_by_their_masses(tmp_path: Path, masses: tuple[int, ...], told: bool) -> None:
    content = make_chain(*(bare(f"l{i}", mass, 0.1) for i, mass in enumerate(masses)))
    assert codes(tmp_path, content) == (["INR007"] if told else [])


@pytest.mark.parametrize(("mass", "sizes", "told"), [
    (1.0, (1, 1.2, 1.5, 2), True),
    (1.0, (1, 1.2, 1.5, 1.6), False),  # volumes differ less than five times
    (1.3, (1, 1.2, 1.5, 2), False),  # no round number
    (1.0, (1, 1.2, 2), False),  # too few
])  # fmt: skip
def test_one_round_mass_for_links_of_all_sizes(
    tmp_path: Path, mass: float, sizes: tuple[float, ...], told: bool
) -> None:
    parts = [Part(size=(0.1 * s, 0.06 * s, 0.04 * s), mass=mass).xml(f"l{i}") for i, s in enumerate(sizes)]
    assert [f.message_id for f in find(tmp_path, make_chain(*parts), CODES)] == (["mass"] if told else [])


# -- INR008 ---------------------------------------------------------------------------------------------------------


def test_the_part_that_the_tensor_fits_is_the_original(tmp_path: Path) -> None:
    fork, wheel = Part(), Part(size=(0.2, 0.06, 0.04), tensor=Part().inertia)
    (finding,) = find(tmp_path, make_chain(wheel.xml("wheel"), fork.xml("fork")), CODES)
    assert (finding.code, finding.message_id) == ("INR008", "copied")
    assert finding.subjects == ("link[wheel]/inertial/inertia",)
    assert [r.subject for r in finding.related] == ["link[fork]/inertial/inertia"]


def make_frame(name: str, edges: str, *places: str) -> str:
    """A link that draws the same box at some places, with a tensor that others have."""
    shapes = "".join(visual(box(edges), xyz=place) for place in places)
    return link(name, inertial(0.5, ixx=0.0018, iyy=0.0019, izz=0.000025), shapes)


def test_different_shapes_are_told_by_their_drawn_sizes(tmp_path: Path) -> None:
    """Four legs far apart are spread like a solid box that is larger than what is drawn; a block is not."""
    places = ("0.2 0.05 0", "0.2 -0.05 0", "-0.2 0.05 0", "-0.2 -0.05 0")
    tall, low = make_frame("tall", "0.04 0.04 0.4", *places), make_frame("low", "0.04 0.04 0.1", *places)
    (finding,) = find(tmp_path, make_chain(tall, low), "INR008")
    assert "0.44 × 0.14 × 0.1 m" in finding.message
    assert "0.44 × 0.14 × 0.4 m" in finding.message
    block = make_frame("block", "0.44 0.14 0.4", "0 0 0")
    (finding,) = find(tmp_path, make_chain(tall, block), "INR008")
    assert "of a solid box of" in finding.message
    assert "0.44 × 0.4 × 0.14 m" in finding.message
    assert "measures" not in finding.message


@pytest.mark.parametrize(
    ("mass", "com", "shared"),
    [
        (0.4321, (0.01, 0.0, 0.005), "mass, COM and inertia tensor are those"),
        (0.4321, (0.0, 0.0, 0.0), "mass and inertia tensor are those"),
        (0.5, (0.01, 0.0, 0.005), "the inertia tensor is that"),
    ],
)
def test_what_else_was_copied_with_a_tensor_is_told(
    tmp_path: Path, mass: float, com: tuple[float, ...], shared: str
) -> None:
    fork = Part(mass=0.4321, com=com)
    wheel = Part(size=(0.2, 0.06, 0.04), mass=mass, com=com, tensor=fork.inertia)
    (finding,) = find(tmp_path, make_chain(wheel.xml("wheel"), fork.xml("fork")), "INR008")
    assert f"wheel: {shared}" in finding.message
    assert finding.fix is not None
    assert ("at the link's mass" in finding.fix.title) == ("is that" in shared)


def test_a_tensor_of_two_parts_is_in_no_other_unit(tmp_path: Path) -> None:
    """Near what one of them has in kg·cm², and far from what the other has."""
    tensor = 1.1e4 * Part().inertia * [[1.0, 1, 1], [1, 1.2, 1], [1, 1, 0.9]]
    parts = (Part(tensor=tensor).xml("cap"), Part(size=(0.3, 0.06, 0.04), mass=4.0, tensor=tensor).xml("wheel"))
    (finding,) = find(tmp_path, make_chain(*parts), {"INR005", "INR008", "INR009"})
    assert (finding.code, finding.message_id, finding.severity) == ("INR008", "shared", Severity.ERROR)
    assert finding.message.endswith("For the mass of cap it is more than 1,000 times too large")


def test_a_com_that_alone_is_off_is_marked(tmp_path: Path) -> None:
    rod = Part(size=(0.2, 0.05, 0.05), com=(0.1, 0.0, 0.0))
    (finding,) = find(tmp_path, make_chain(rod.xml("rod")), "INR009")
    assert finding.message_id == "disagrees"
    assert finding.location.subject == "link[rod]/inertial/origin"
    assert "Only the COM's x is off, by half of what is drawn along x" in finding.message
    assert finding.fix is not None
    assert finding.fix.title.startswith("compute the COM again")


def test_where_no_part_fits_all_are_reported(tmp_path: Path) -> None:
    tensor = np.diag((1.1e-4, 1.9e-4, 2.3e-4))
    one, other = Part(tensor=tensor), Part(size=(0.2, 0.06, 0.04), tensor=tensor)
    (finding,) = find(tmp_path, make_chain(one.xml("one"), other.xml("other")), CODES)
    assert (finding.message_id, len(finding.subjects)) == ("shared", 2)


def test_equal_mirrored_and_turned_parts_share_a_tensor_by_right(tmp_path: Path) -> None:
    turn = rpy_to_matrix((0.0, 0.0, 0.6))
    tensor = Part(rotation=turn).inertia
    mirrored = tensor * [[1, -1, -1], [-1, 1, 1], [-1, 1, 1]]
    parts = [Part(rotation=turn), Part(rotation=turn, place=(0.1, 0, 0)), Part(rotation=turn.T, tensor=mirrored)]
    assert codes(tmp_path, make_chain(*(p.xml(f"p{i}") for i, p in enumerate(parts)))) == []


def test_tensors_that_only_look_alike_are_not_copies(tmp_path: Path) -> None:
    other = Part(size=(0.2, 0.06, 0.04), tensor=1.000001 * Part().inertia)
    assert codes(tmp_path, make_chain(Part().xml("one"), other.xml("other"))) == []


LONG, SHORT = box("0.32 0.054 0.044"), box("0.25 0.04 0.028")
THIGH = inertial(3.0, ixx="0.0211", ixy="-0.00017", iyy="0.0223", iyz="0.00031", izz="0.0049")


def make_thighs(*parts: tuple[str, str]) -> str:
    """Return a robot of links with one tensor: name and shapes."""
    limbs = (link(name, THIGH, shapes) + joint(f"j_{name}", "base", name, "continuous") for name, shapes in parts)
    return robot(link("base"), *limbs)


@pytest.mark.parametrize(
    ("one", "other", "found"),
    [
        (("thigh", visual(LONG)), ("calf", visual(SHORT)), True),
        (("FL_thigh", visual(LONG)), ("FR_thigh", visual(SHORT)), False),
        (("front_left_thigh", visual(LONG)), ("hind_right_thigh", visual(SHORT)), False),
        (("LeftThigh", visual(LONG)), ("RightThigh", visual(SHORT)), False),
        (("FL_thigh", visual(LONG)), ("FR_calf", visual(SHORT)), True),
        # The drawing of one and the collision shape of the other say nothing of each other.
        (("thigh", visual(LONG)), ("calf", collision(SHORT)), False),
        (("thigh", visual(LONG) + collision(LONG)), ("calf", visual(LONG) + collision(SHORT)), False),
        (("thigh", collision(LONG)), ("calf", collision(SHORT)), True),
        # Its mesh is missing, so what it draws is not known, whatever collides.
        (("thigh", visual('<mesh filename="no.stl"/>') + collision(LONG)), ("calf", collision(SHORT)), False),
    ],
)
def test_drawings_of_different_parts_are_compared(
    tmp_path: Path, one: tuple[str, str], other: tuple[str, str], found: bool
) -> None:
    findings = find(tmp_path, make_thighs(one, other), "INR008")
    assert bool(findings) == found
    for finding in findings:
        assert ("visual" in finding.message) == ("visual" in one[1])
        assert ("collision" in finding.message) == ("visual" not in one[1])


@pytest.mark.parametrize(
    ("six", "masses", "found"),
    [
        (("0.0151", "0.0313", "0.0459"), (3.0, 3.0), False),  # two plates of one outline, 4 and 8 mm thick
        (("0.0151", "0.0313", "0.0459"), (3.0, 9.0), True),
        (("0.0015", "0.0015", "0.0015"), (3.0, 9.0), False),
        (("1e-5", "2e-5", "2e-5"), (3.0, 9.0), False),
    ],
)
def test_what_two_parts_share_by_right_was_not_copied(
    tmp_path: Path, six: tuple[str, str, str], masses: tuple[float, float], found: bool
) -> None:
    moments = dict(zip(("ixx", "iyy", "izz"), six, strict=True))
    parts = zip(("lower", "upper"), masses, ("0.4 0.25 0.004", "0.4 0.25 0.008"), strict=True)
    links = (link(name, inertial(mass, **moments), visual(box(size))) for name, mass, size in parts)
    joints = (joint(f"j_{name}", "base", name, "continuous") for name in ("lower", "upper"))
    assert bool(find(tmp_path, robot(link("base"), *links, *joints), "INR008")) == found


def test_six_equal_numbers_were_not_copied(tmp_path: Path) -> None:
    text = make_thighs(("thigh", visual(LONG)), ("calf", visual(SHORT)))
    six = inertial(3.0, **dict.fromkeys(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), "1e-6"))
    assert find(tmp_path, text, "INR008")
    assert not find(tmp_path, text.replace(THIGH, six), "INR008")


# -- INR010 ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("density", "dense"), [(2, False), (2700, False), (22000, False), (33000, True), (2.7e6, True)]
)
def test_nothing_is_denser_than_osmium(tmp_path: Path, density: float, dense: bool) -> None:
    part = Part(mass=density * 0.1 * 0.06 * 0.04)
    assert codes(tmp_path, make_arm(part)) == (["INR010"] if dense else [])


def test_a_mass_alone_is_wrong_where_tensor_and_com_are_the_drawn_parts(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, make_arm(Part(mass=50000 * 0.1 * 0.06 * 0.04)), "INR010")
    assert finding.fix is not None
    assert finding.fix.title.startswith("correct the mass, and scale the inertia tensor with it")


def test_the_unit_of_the_mass_is_named(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, make_arm(Part(mass=2.7e6 * 0.1 * 0.06 * 0.04)), CODES)
    assert finding.cause is not None
    assert finding.cause.text == "If the number is in grams, the 240 cm³ that are drawn have 2,700 kg/m³: aluminium."


def test_a_typed_mass_has_no_unit(tmp_path: Path) -> None:
    part = Part(size=(0.01, 0.01, 0.01), mass=1.0)
    (finding,) = find(tmp_path, make_arm(part), CODES)
    assert (finding.code, finding.cause) == ("INR010", None)


@pytest.mark.parametrize(
    ("mass", "limb", "reported"),
    [
        (400.0, "arm", False),
        (412.5, "arm", True),  # computed, not chosen
        (400.0, "wheel", True),  # a robot on wheels moves all of its mass
        (100.0, "arm", True),  # too little for ballast
        (2700.0, "arm", True),  # aluminium in grams
    ],
)
def test_ballast_of_a_bolted_arm_may_be_denser_than_any_material(
    tmp_path: Path, mass: float, limb: str, reported: bool
) -> None:
    size = (0.1, 0.1, 0.1) if mass > 1000.0 else (0.2, 0.2, 0.1) if mass > 200.0 else (0.1, 0.1, 0.04)
    stand = Part(size=size, mass=mass)
    part = Part(size=(0.2, 0.2, 0.2), mass=15.0)
    found = find(tmp_path, make_chain(stand.xml("stand"), part.xml(f"{limb}0"), part.xml(f"{limb}1")), {"INR010"})
    assert [f.message_id for f in found] == ["dense"] * reported
    assert [f.cause is not None for f in found] == [mass == 2700.0] * reported


@pytest.mark.parametrize(
    ("mass", "moments", "dense"),
    [
        (125.0, (1.391, 6.853, 6.125), False),  # a car of 0.75 × 0.18 × 0.32 m
        (125.0, (0.2, 0.2, 0.2), True),  # a body of the drawn size
        (125000.0, (1.391, 6.853, 6.125), True),  # a mass in grams
    ],
)
def test_a_small_box_may_stand_for_a_car(
    tmp_path: Path, mass: float, moments: tuple[float, float, float], dense: bool
) -> None:
    body = Part(size=(0.1, 0.1, 0.1), mass=mass, tensor=np.diag(moments)).xml("body")
    wheel = Part(size=(0.2, 0.2, 0.2), mass=15.0).xml("wheel")
    text = make_chain(body, wheel)
    assert [f.message_id for f in find(tmp_path, text, {"INR010"})] == ["dense"] * dense


@pytest.mark.parametrize(("mass", "light"), [(0.00024, False), (0.00023, True)])
def test_nothing_is_lighter_than_air(tmp_path: Path, mass: float, light: bool) -> None:
    # 240 cm³ at 1 kg/m³; over the surface of 0.0248 m² that is 9.7 g/m².
    assert codes(tmp_path, make_arm(Part(mass=mass))) == (["INR010"] if light else [])


@pytest.mark.parametrize(("other", "severity"), [(0.01, Severity.INFO), (0.02, Severity.WARNING)])
def test_one_round_mass_of_all_links_is_told_once(tmp_path: Path, other: float, severity: Severity) -> None:
    """Nothing of 0.1 m³ weighs 10 g, and what its inertia should be depends on its mass."""
    parts = [
        Part(size=(0.5, 0.5, 0.4), mass=mass, tensor=0.001 * np.eye(3)).xml(n)
        for n, mass in (("a", 0.01), ("b", other))
    ]
    found = find(tmp_path, make_chain(*parts), {"INR007", "INR010"})
    assert {(f.code, f.severity) for f in found} == {("INR010", severity)}


def test_a_balloon_is_as_light_as_it_likes(tmp_path: Path) -> None:
    assert codes(tmp_path, make_arm(Part(size=(10.0, 10.0, 10.0), mass=900.0))) == []


# -- all of them: what a robot is written in changes nothing --------------------------------------------------------

DEFECTS = {
    "sound": Part(),
    "exceeds": replace(Part(), tensor=np.diag((0.011, 0.012, 0.013))),
    "outside": replace(Part(), com=(0.08, 0.02, 0.01)),
    "dense": Part(mass=700.0),
    "light": Part(mass=0.0002),
}


def test_a_part_of_a_body_with_a_malformed_tensor_is_not_judged(tmp_path: Path) -> None:
    body = inertial(2, 0.01).replace('ixx="0.01"', 'ixx="1.1*0.01"')
    text = robot(
        link("base", body, visual(box("0.3 0.3 0.1"))),
        link("sensor", inertial(1e-5, 1e-6), visual(box("0.01 0.01 0.01"))),
        joint("glue", "base", "sensor", xyz="0.1 0 0.1"),
    )
    assert not find(tmp_path, text, {"INR005", "INR007"})


@pytest.mark.parametrize(("mass", "light"), [(1, False), (0.001, True)])
def test_a_floor_that_never_moves_has_a_token_mass(tmp_path: Path, mass: float, light: bool) -> None:
    """A box of 20 × 20 × 2 m: 1 g would be that of a plate of 20 × 20 × 2 mm, drawn in millimetres."""
    text = robot(link("floor", inertial(mass, 1), visual(box("20 20 2"))))
    assert [f.message_id for f in find(tmp_path, text, {"INR010"})] == ["light"] * light


EXPECTED = {"sound": [], "exceeds": ["INR005"], "outside": ["INR006"], "dense": ["INR010"], "light": ["INR010"]}
TURN = rpy_to_matrix((0.4, -0.7, 1.1))


def moved(part: Part, turn: Array, shift: tuple[float, ...]) -> Part:
    """The same part, seen from another link frame."""
    com = np.asarray(part.place if part.com is None else part.com, dtype=float)
    return replace(
        part,
        place=turn @ np.asarray(part.place, dtype=float) + shift,
        rotation=turn @ part.pose,
        com=turn @ com + shift,
        tensor=turn @ part.inertia @ turn.T,
    )


@pytest.mark.parametrize("name", DEFECTS)
def test_turning_frames_scaling_and_rerooting_change_no_verdict(tmp_path: Path, name: str) -> None:
    part = DEFECTS[name]
    k = 3.0  # longer, and so much heavier that the density stays
    scaled = replace(
        part,
        size=tuple(k * s for s in part.size),  # type: ignore[arg-type]
        com=None if part.com is None else tuple(k * c for c in part.com),
        mass=k**3 * part.mass,
        tensor=k**5 * part.inertia,
    )
    base = '<link name="base"/>'
    variants = {
        "as it is": make_arm(part),
        "link frame": make_arm(moved(part, TURN, (0.3, -0.2, 0.1))),
        "inertial frame": make_arm(replace(part, turned=(0.3, 0.2, -0.5))),
        "root": make_chain(part.xml("arm"), base, xyz="0.2 0 0"),
        "renamed": make_chain('<link name="torso"/>', part.xml("Link_7")),
    }
    if name != "light":  # a skin does not scale with the volume
        variants["scaled"] = make_arm(scaled)
    for variant, content in variants.items():
        assert codes(tmp_path / variant, content) == EXPECTED[name], variant


# -- what is drawn --------------------------------------------------------------------------------------------------


def model_of(folder: Path, content: str) -> Model:
    folder.mkdir(exist_ok=True)
    path = folder / "drawn.urdf"
    path.write_text(content, encoding="utf-8")
    source = load_source(path, {}, PackageFinder(path))
    assert source.root is not None
    return Model(source=source, robot=source.root)


def drawing(shape: str, rpy: str = "0.3 -0.4 0.5", xyz: str = "0.1 0.2 0.3") -> str:
    visual = f'<visual><origin xyz="{xyz}" rpy="{rpy}"/><geometry>{shape}</geometry></visual>'
    return f'<robot name="r" version="1.2"><link name="a">{visual}</link></robot>'


def inside(kind: str, random: np.random.Generator) -> Array:
    """Points all over the surface of a shape of radius 0.2 and length 0.6, or a box of 0.4 × 0.2 × 0.6."""
    if kind == "box":
        return random.choice((-0.5, 0.5), (200, 3)) * (0.4, 0.2, 0.6)
    ball = random.normal(size=(400, 3))
    ball *= 0.2 / np.linalg.norm(ball, axis=1)[:, None]
    if kind == "capsule":
        return ball + np.sign(ball) * (0, 0, 0.3)
    if kind == "cylinder":
        ball *= 0.2 / np.linalg.norm(ball[:, :2], axis=1)[:, None]
        ball[:, 2] = random.choice((-0.3, 0.3), 400)
    return ball


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "shape"),
    [
        ("box", '<box size="0.4 0.2 0.6"/>'),
        ("sphere", '<sphere radius="0.2"/>'),
        ("cylinder", '<cylinder radius="0.2" length="0.6"/>'),
        ("capsule", '<capsule radius="0.2" length="0.6"/>'),
    ],
)
def test_the_corners_of_a_shape_hold_all_of_it_and_little_more(tmp_path: Path, kind: str, shape: str) -> None:
    model = model_of(tmp_path, drawing(shape))
    link = model.links[0]
    points, drawn = collect_rigid_corners(model, link), measure_link_geometry(model, link)
    assert points is not None
    assert drawn is not None
    turn, place = rpy_to_matrix((0.3, -0.4, 0.5)), np.array((0.1, 0.2, 0.3))
    for surface in inside(kind, np.random.default_rng(1)) @ turn.T + place:
        assert measure_hull_distance(points, surface) < 1e-6
    assert 1.0 <= compute_convex_hull(points).volume / drawn.solid.volume + 1e-9 <= 1.02
    assert drawn.closed


OBJ = "v 0 0 0\nv 0.4 0 0\nv 0 0.3 0\nv 0 0 0.2\n" + "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"


def test_solid_hull_and_shell_of_a_stretched_mesh_are_those_of_the_stretched_corners(tmp_path: Path) -> None:
    (tmp_path / "a.obj").write_text(OBJ)
    (tmp_path / "b.obj").write_text("v 0 0 0\nv 0.8 0 0\nv 0 -0.3 0\nv 0 0 0.1\nf 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n")
    stretched = model_of(tmp_path, drawing('<mesh filename="a.obj" scale="2 -1 0.5"/>'))
    plain = model_of(tmp_path, drawing('<mesh filename="b.obj"/>'))
    one, other = measure_link_geometry(stretched, stretched.links[0]), measure_link_geometry(plain, plain.links[0])
    assert one is not None
    assert other is not None
    for part in ("solid", "hull", "shell", "box"):
        got, wanted = getattr(one, part), getattr(other, part)
        np.testing.assert_allclose(got.volume, wanted.volume, err_msg=part)
        np.testing.assert_allclose(got.com, wanted.com, err_msg=part)
        np.testing.assert_allclose(got.covariance, wanted.covariance, atol=1e-12, err_msg=part)


def test_an_open_mesh_gives_way_to_a_closed_collision_shape(tmp_path: Path) -> None:
    (tmp_path / "open.obj").write_text(OBJ.replace("f 2 3 4\n", ""))
    content = drawing('<mesh filename="open.obj"/>')
    box = '<collision><geometry><box size="0.4 0.3 0.2"/></geometry></collision>'
    opened = model_of(tmp_path / "a", content.replace("open.obj", "../open.obj"))
    both = model_of(tmp_path / "b", content.replace("open.obj", "../open.obj").replace("</visual>", "</visual>" + box))
    first, second = measure_link_geometry(opened, opened.links[0]), measure_link_geometry(both, both.links[0])
    assert first is not None
    assert second is not None
    assert (first.closed, second.closed) == (False, True)
    np.testing.assert_allclose(first.solid.volume, 0.4 * 0.3 * 0.2 / 6)
    np.testing.assert_allclose(second.solid.volume, 0.4 * 0.3 * 0.2)


# -- ten times the density ----------------------------------------------------------------------------------------------


def make_hand(folder: Path, densities: Sequence[float], sizes: Sequence[float] = (1.0, 0.5, 0.4, 0.3, 0.2)) -> str:
    """Cast parts of several sizes and densities, drawn by one mesh."""
    write_stl(folder / "part.stl", CASTING)
    links = []
    for i, (density, k) in enumerate(zip(densities, sizes, strict=False)):
        whole = uniform(geometry(CASTING).solid)
        mass = density * geometry(CASTING).solid.volume * k**3
        numbers = DeclaredInertial(mass, whole.com * k, whole.tensor * (mass * k * k / whole.mass))
        drawn = f'<visual><geometry><mesh filename="part.stl" scale="{k} {k} {k}"/></geometry></visual>'
        links.append(link(f"l{i}", format_inertial(numbers), drawn))
    joints = (joint(f"j{i}", "l0", f"l{i}", kind="continuous", xyz=f"0 {i} 0") for i in range(1, len(links)))
    return robot(*links, *joints)


@pytest.mark.parametrize(
    ("densities", "tenfold"),
    [
        ((1004, 1004, 1004, 10020), True),
        ((1004, 10020, 10020, 10020), True),
        ((270, 270, 2700, 2700), True),
        ((1000, 1000, 10000), False),  # too few parts
        ((1000, 1000, 1000, 9000), False),
        ((1000, 1100, 1200, 10500), False),
        ((1000, 2700, 7850, 1000), False),
        ((1000, 1000, 1000, 1000), False),
    ],
)
def test_links_ten_times_as_dense_as_others_are_found(
    tmp_path: Path, densities: tuple[float, ...], tenfold: bool
) -> None:
    found = find(tmp_path, make_hand(tmp_path, densities), "INR016")
    found = [finding for finding in found if finding.message_id == "tenfold"]
    assert len(found) == tenfold
    if tenfold:
        assert len(found[0].subjects) == sum(density > 5 * min(densities) for density in densities)


def test_equal_copies_are_one_piece_of_evidence(tmp_path: Path) -> None:
    text = make_hand(tmp_path, (1000, 1000, 10000, 10000, 10000), sizes=(1.0, 0.5, 0.4, 0.4, 0.4))
    assert "tenfold" not in {finding.message_id for finding in find(tmp_path, text, "INR016")}


def test_a_moment_that_is_too_small_is_not_called_too_large(tmp_path: Path) -> None:
    wheel = robot(
        link("base"),
        joint("axle", "base", "wheel", kind="continuous", axis="0 0 1"),
        link("wheel", inertial(0.1, "1.6458e-5"), collision(cylinder(0.025, 0.01))),
    )
    (finding,) = find(tmp_path, wheel, "INR005")
    assert finding.message_id == "uneven"
    assert "About this COM, 0.1 kg inside" in finding.message
    assert finding.fix is not None
    assert finding.fix.title.startswith('write izz="3.125e-05", as the shape has')


@pytest.mark.parametrize(("spread", "severity"), [(0.22, Severity.INFO), (0.3, Severity.WARNING)])
def test_possible_moments_that_barely_fit_together_are_a_note(
    tmp_path: Path, spread: float, severity: Severity
) -> None:
    # Nearly all variance along one axis: each moment is possible while the others have none of it.
    largest = spread**2 + 1e-4
    part = link("p", inertial(1, ixx=2e-4, iyy=largest, izz=largest), visual(box("0.3 0.3 0.3")))
    (finding,) = find(tmp_path, robot(part), "INR005")
    assert (finding.message_id == "uneven", finding.severity) == (spread < 0.25, severity)


@pytest.mark.parametrize("rpy", ["0 1.5708 0", "0 0 0"])
def test_a_moment_beyond_a_disc_is_too_large_however_the_disc_is_turned(tmp_path: Path, rpy: str) -> None:
    # About a diameter, no mass in the disc has ixx: rounded angles mix its two equal variances.
    disc = robot(
        link("base"),
        joint("axle", "base", "disc", kind="continuous", xyz="0.3 0 0", axis="1 0 0"),
        link("disc", inertial(0.2, "0.00021792", ixx="0.0004225", rpy=rpy), visual(cylinder(0.04, 0.01), rpy=rpy)),
    )
    (finding,) = find(tmp_path, disc, "INR005")
    assert finding.message_id == "exceeds"
    assert "0.00662 m at most about this COM" in finding.message


def test_a_tensor_of_zero_does_not_hide_a_com_outside_the_part(tmp_path: Path) -> None:
    """INR004 reports the tensors of all cleats at the first of them."""
    drawn = visual(box("0.1 0.05 0.005"))
    feet = [
        link(name, inertial(0.02, moment, com="0 0 0.05") + drawn) + joint(f"{name}_joint", "leg", name, kind="fixed")
        for name, moment in (("foot", 1e-5), ("cleat_0", 0), ("cleat_1", 0))
    ]
    text = robot(link("base"), link("leg"), joint("knee", "base", "leg", kind="continuous"), *feet)
    found = find(tmp_path, text, {"INR004", "INR006"})
    assert [finding.code for finding in found].count("INR004") == 1
    outside = [finding.location.subject.partition("/")[0] for finding in found if finding.code == "INR006"]
    assert outside == ["link[foot]", "link[cleat_0]", "link[cleat_1]"]


def test_a_dummy_visual_is_not_the_part(tmp_path: Path) -> None:
    shapes = visual(box("0.001 0.001 0.001")) + collision('<sphere radius="0.011"/>')
    moments = dict.fromkeys(("ixx", "iyy", "izz"), "5e-7")
    assert find(tmp_path, arm_on_base(inertial("0.01", **moments), shapes), CODES) == []
