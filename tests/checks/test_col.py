"""COL001, COL002, COL005 and the collisions they stand on: what counts as an overlap at rest, by design, on the way."""

from __future__ import annotations

import math
import re
from itertools import combinations, product
from pathlib import Path

import numpy as np
import pytest
import trimesh
from builders import box, collision, cylinder, find, joint, link, mesh, robot, sphere, visual
from conftest import FIXTURES, check_text

from urdfcheck.core import Severity
from urdfcheck.model import Model, Shape
from urdfcheck.model.motion import poses
from urdfcheck.model.motion.collisions import setup as collision_setup
from urdfcheck.model.motion.collisions.self_collisions import CollisionPair, SelfCollisions, self_collisions
from urdfcheck.model.motion.collisions.single_joint import find_joint_collisions
from urdfcheck.model.shapes.solids import compute_drawn_scale
from urdfcheck.source.load import load_source
from urdfcheck.source.package.finder import PackageFinder
from urdfcheck.system.array_cache import ArrayCache

coal = pytest.importorskip("coal")


def make_link(name: str, *shapes: str) -> str:
    """Return a link that collides with shapes: a primitive, or a place and a primitive (``0 0 1|<box …/>``)."""
    pieces = [shape.rpartition("|") for shape in shapes]
    return link(name, *(collision(geometry, xyz=place or "0 0 0") for place, _, geometry in pieces))


def make_joint(parent: str, child: str, xyz: str, kind: str = "revolute", **more: str) -> str:
    """Return a joint; ``limit`` are the attributes of its limits, ``mimic`` is an element."""
    span = more.get("limit", 'lower="-2" upper="2"')
    limits = "" if kind in {"fixed", "continuous"} else f'<limit {span} effort="1" velocity="1"/>'
    place = {"xyz": xyz, "rpy": more.get("rpy", "0 0 0"), "axis": more.get("axis", "0 0 1")}
    return joint(f"{parent}_{child}", parent, child, limits, more.get("mimic", ""), kind=kind, **place)


def model_of(folder: Path, text: str, cache: ArrayCache | None = None, samples: int = 200) -> Model:
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "robot.urdf"
    path.write_text(text)
    return model_at(path, cache, samples)


def model_at(path: Path, cache: ArrayCache | None = None, samples: int = 200) -> Model:
    source = load_source(path, {}, PackageFinder(path), xacro=False)
    assert source.root is not None
    return Model(source=source, robot=source.root, tier="full", cache=cache or ArrayCache(), samples=samples)


def pair(found: SelfCollisions, one: str, other: str) -> CollisionPair:
    return next(p for p in found.pairs if set(p.links) == {one, other})


# Three plates on two hinges, the last one folded back over the first and into it by 2 mm.
def folded(scale: float = 1.0, rpy: str = "0 0 0", gap: float = -0.002) -> str:
    def text(*numbers: float) -> str:
        return " ".join(repr(n * scale) for n in numbers)

    return robot(
        make_link("floor"),
        make_joint("floor", "a", text(0.3, 0.1, 0.2), "fixed", rpy=rpy),
        make_link("a", box(text(0.2, 0.1, 0.02))),
        make_joint("a", "b", text(0.15, 0, 0.05)),
        make_link("b", box(text(0.05, 0.05, 0.05))),
        make_joint("b", "c", text(0, 0, 0)),
        make_link("c", f"{text(-0.15, 0, -0.03 + gap)}|{box(text(0.2, 0.1, 0.02))}"),
    )


# -- COL001 --------------------------------------------------------------------------------------------------------------


def test_the_overlap_is_told_with_its_depth_and_its_place(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, folded(), "COL001")
    assert finding.severity == Severity.WARNING
    assert "c and a overlap by 2 mm in the rest pose (all joints at zero)" in finding.message
    assert finding.location.subject == "link[c]/collision/geometry/box"
    assert finding.data["depth"] == pytest.approx(0.002, rel=1e-4)
    assert finding.data["point"] == pytest.approx([0.3, 0.1, 0.21], abs=0.05)


@pytest.mark.parametrize(("gap", "bad"), [(-0.002, True), (0.0, False), (0.001, False)])
@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("rpy", ["0 0 0", "0.3 -1.2 2"])
def test_size_and_place_of_the_robot_do_not_decide(
    tmp_path: Path, gap: float, bad: bool, scale: float, rpy: str
) -> None:
    assert bool(find(tmp_path, folded(scale, rpy, gap), "COL001")) == bad


def test_the_root_does_not_decide(tmp_path: Path) -> None:
    """The same plates, hung up at the other end."""
    upside = robot(
        make_link("c", "-0.15 0 -0.032|" + box("0.2 0.1 0.02")),
        make_joint("c", "b", "0 0 0", axis="0 0 -1"),
        make_link("b", box("0.05 0.05 0.05")),
        make_joint("b", "a", "0 0 0", axis="0 0 -1"),
        make_link("a", "-0.15 0 -0.05|" + box("0.2 0.1 0.02")),
    )
    (finding,) = find(tmp_path, upside, "COL001")
    assert "a and c overlap by 2 mm" in finding.message


@pytest.mark.parametrize(("press", "bad"), [(0.0, False), (0.0001, False), (0.002, True)])
def test_closed_fingers_may_press_against_each_other(tmp_path: Path, press: float, bad: bool) -> None:
    """Fingers of 35 mm, closed at rest: 0.1 mm is 0.3 % of one, 2 mm are 6 %."""
    finger = box("0.01 0.01 0.03")
    text = robot(
        make_link("hand", box("0.05 0.1 0.01")),
        make_joint(
            "hand", "left", f"0 {0.005 - press / 2} 0.03", "prismatic", axis="0 1 0", limit="lower='0' upper='0.04'"
        ),
        make_joint(
            "hand", "right", f"0 {press / 2 - 0.005} 0.03", "prismatic", axis="0 -1 0", limit="lower='0' upper='0.04'"
        ),
        make_link("left", finger),
        make_link("right", finger),
    )
    assert bool(find(tmp_path, text, "COL001")) == bad


def test_the_pose_is_told_where_zero_is_out_of_range(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, jaws(half_gap=-0.005, lower=0.012), "COL001")
    assert "in the rest pose (l at 0.012, r at 0.012: the limits nearest to zero)" in finding.message


def jaws(half_gap: float = 0.005, lower: float = 0, length: float = 0.1) -> str:
    """Two fingers that slide towards each other and overlap at rest."""
    finger = f"<collision><geometry><box size='{length} 0.02 0.02'/></geometry></collision>"
    slide = f"<axis xyz='0 {{}} 0'/><limit lower='{lower}' upper='0.1' effort='1' velocity='1'/>"
    return robot(
        *(link("palm"), link("left", finger), link("right", finger)),
        joint("l", "palm", "left", slide.format(1), kind="prismatic", xyz=f"0 {half_gap} 0"),
        joint("r", "palm", "right", slide.format(-1), kind="prismatic", xyz=f"0 {-half_gap} 0"),
    )


def telescope(axis: str = "0 0 1", kind: str = "prismatic") -> str:
    """Three tubes in each other, drawn as solid cylinders, and a plate that the last one carries."""
    tube = "<collision><geometry><cylinder radius='{}' length='1'/></geometry></collision>"
    slide = "<axis xyz='{}'/><limit lower='0' upper='1.5' effort='1' velocity='1'/>"
    return robot(
        *(link(name, tube.format(radius)) for name, radius in (("outer", 0.06), ("middle", 0.05), ("inner", 0.04))),
        joint("m", "outer", "middle", slide.format("0 0 1"), kind="prismatic"),
        joint("i", "middle", "inner", slide.format(axis), kind=kind),
    )


@pytest.mark.parametrize(
    ("text", "message", "severity"),
    [
        (telescope(), "nested", Severity.INFO),
        (telescope("0 0 -1"), "nested", Severity.INFO),
        (telescope("1 0 0"), "overlap", Severity.WARNING),
        (telescope(kind="revolute"), "overlap", Severity.WARNING),
        (jaws(), "overlap", Severity.WARNING),
        (jaws(0.0096, length=0.01), "slight", Severity.INFO),  # 0.8 mm of pads of 30 mm
        (jaws(0.0092, length=0.01), "slight", Severity.INFO),  # 1.6 mm, as in PR2
        (jaws(0.0089, length=0.01), "overlap", Severity.WARNING),  # 2.2 mm
        (jaws(0.0096, lower=-0.01, length=0.01), "overlap", Severity.WARNING),  # not closed yet
        (folded(gap=-0.0009), "slight", Severity.INFO),
        (folded(gap=-0.0011), "overlap", Severity.WARNING),
        (folded(scale=0.01, gap=-0.01), "overlap", Severity.WARNING),  # 0.1 mm, and much of the shape
    ],
)
def test_what_hardly_matters_is_an_info(tmp_path: Path, text: str, message: str, severity: Severity) -> None:
    found = find(tmp_path, text, "COL001")
    assert [(f.message_id, f.severity) for f in found if f.message_id != "always"] == [(message, severity)]


def linkage(tube_leader: str = "lift", bar_leader: str = "lift") -> str:
    """A body that is lifted off a post, and a bar on it that ends 1 cm in the post; a tube around both slides along the bar
    as the body is lifted."""
    tube = f'<mimic joint="{tube_leader}" multiplier="-1"/>' if tube_leader else ""
    bar = f'<mimic joint="{bar_leader}" multiplier="0.05"/>' if bar_leader else ""
    span = {"limit": 'lower="0" upper="0.2"', "axis": "0 0 1"}
    return robot(
        make_link("post", f"0 0 0.2|{box('0.03 0.03 0.4')}"),
        make_joint("post", "lift", "0 0 0.89", "prismatic", **span).replace('name="post_lift"', 'name="lift"'),
        make_link("lift", f"0 0 0.3|{sphere('0.05')}"),
        make_joint("lift", "bar", "0 0 0", axis="0 1 0", limit='lower="0" upper="0.1"', mimic=bar),
        make_link("bar", f"0 0 -0.25|{box('0.03 0.03 0.5')}"),
        make_joint("bar", "tube", "0 0 -0.5", "prismatic", axis="0 0 1", limit='lower="-1" upper="1"', mimic=tube),
        make_link("tube", box("0.05 0.05 0.3")),
    )  # fmt: skip


@pytest.mark.parametrize(
    ("tube_leader", "bar_leader", "message"),
    [("lift", "lift", "bar"), ("", "lift", "several"), ("lift", "", "several")],
)
def test_a_bar_that_ends_in_the_part_it_slides_into_is_an_info(
    tmp_path: Path, tube_leader: str, bar_leader: str, message: str
) -> None:
    severity = Severity.INFO if message == "bar" else Severity.WARNING
    found = find(tmp_path, linkage(tube_leader, bar_leader), "COL001")
    (finding,) = [f for f in found if f.message_id != "always"]
    assert (finding.message_id, finding.severity) == (message, severity)


@pytest.mark.parametrize(("lower", "severity"), [(0.5, Severity.INFO), (-0.5, Severity.WARNING)])
def test_an_overlap_in_a_pose_that_the_robot_is_never_in(tmp_path: Path, lower: float, severity: Severity) -> None:
    stand = make_joint("stand", "floor", "0 0 0", limit=f"lower='{lower}' upper='2'")
    hinged = folded().replace('axis xyz="0 0 1"', 'axis xyz="0 1 0"')
    (finding,) = find(tmp_path, hinged.replace("</robot>", make_link("stand") + stand + "</robot>"), "COL001")
    assert (finding.message_id, finding.severity) == ("overlap", severity)


def test_rest_is_the_limit_nearest_to_zero(tmp_path: Path) -> None:
    """At zero the fingers would be one in the other; their range begins where they are apart."""
    ball = sphere("0.01")
    slide = {"axis": "0 1 0", "limit": "lower='0.02' upper='0.04'"}
    text = robot(
        make_link("hand"), make_joint("hand", "left", "0 0 0", "prismatic", **slide), make_link("left", ball),
        make_joint("hand", "right", "0 0 0", "prismatic", **{**slide, "axis": "0 -1 0"}), make_link("right", ball),
    )  # fmt: skip
    assert not find(tmp_path, text, "COL001")


@pytest.mark.parametrize(
    ("kind", "drawn", "gap", "message"),
    [
        ("prismatic", None, 0.02, "overlap"),
        ("prismatic", "0.06", 0.02, "overlap"),
        # The parts themselves come apart, the overlap is slight, or nothing says that the two should come apart.
        ("prismatic", "0.004", 0.02, "always"),
        ("prismatic", None, 0.056, "always"),
        ("revolute", None, 0.02, "always"),
    ],
)
def test_fingers_come_apart(kind: str, drawn: str | None, gap: float, message: str, tmp_path: Path) -> None:
    """Two boxes of 60 mm, each on a slide of 1 mm, that are ``gap`` apart at their middles."""
    shapes = [collision(box("0.02 0.06 0.05")), *([] if drawn is None else [visual(box(f"0.02 {drawn} 0.05"))])]
    slide = {"kind": kind, "limit": "lower='0' upper='0.001'"}
    text = robot(
        make_link("palm"),
        *(
            part
            for name, side in (("left", 1), ("right", -1))
            for part in (
                make_joint("palm", name, f"0 {side * gap / 2} 0", axis=f"0 {side} 0", **slide),
                link(name, *shapes),
            )
        ),
    )
    (finding,) = find(tmp_path, text, "COL001")
    assert (finding.message_id, finding.severity) == (
        message,
        Severity.WARNING if message == "overlap" else Severity.INFO,
    )


def test_links_that_always_overlap_are_one_info(tmp_path: Path) -> None:
    """A cover of the first link that encloses the third: no angle frees it."""
    text = robot(
        make_link("a", sphere("0.2")),
        make_joint("a", "b", "0.1 0 0"),
        make_link("b", sphere("0.01")),
        make_joint("b", "c", "0.02 0 0"),
        make_link("c", sphere("0.03")),
    )
    (finding,) = find(tmp_path, text, "COL001")
    assert (finding.severity, finding.message_id) == (Severity.INFO, "always")
    assert re.fullmatch(r"\S+ and \S+ overlap by [\d.]+ mm nearly always( \(\+\d+\))?", finding.headline)


def displaced(drawn: str, collides: str, more: str = "") -> str:
    """Return the plates of `folded`, where the last one is drawn at one place and collides at another."""
    plate = box("0.2 0.1 0.02")
    before = folded().partition('<link name="c">')[0]
    return f"{before}{link('c', visual(plate, xyz=drawn), collision(plate, xyz=collides))}{more}</robot>"


def test_an_origin_that_causes_an_overlap_is_one_finding_with_it(tmp_path: Path) -> None:
    text = displaced("-0.15 0 0.1", "-0.15 0 -0.032")
    for codes in ({"COL001", "GEO003", "GEO005"}, {"COL001"}):
        (finding,) = find(tmp_path, text, codes)
        assert (finding.code, finding.message_id, finding.severity) == ("COL001", "displaced", Severity.WARNING)
        assert finding.location.subject == "link[c]/collision/origin"
        assert finding.headline == "c overlaps a: collision 0.132 m off (2 mm deep)"
        assert "with the visual's <origin> it is free of them" in finding.message
        assert finding.fix is not None
        assert [(e.expected, e.replacement) for e in finding.fix.edits] == [("-0.15 0 -0.032", "-0.15 0 0.1")]
        assert finding.data.get("hides", []) == (["GEO003", "GEO005"] if len(codes) > 1 else [])
    mended = text.replace("-0.15 0 -0.032", "-0.15 0 0.1")
    assert not find(tmp_path, mended, {"COL001", "GEO003", "GEO005"})


@pytest.mark.parametrize(
    ("drawn", "more"),
    [
        ("-0.14 0 -0.031", ""),  # the overlap is still there
        (  # another overlap comes instead
            "-0.15 0 0.1",
            make_joint("a", "d", "-0.1 0 0.15", "fixed") + make_link("d", box("0.05 0.05 0.05")),
        ),
    ],
)
def test_an_origin_is_the_cause_only_where_the_visuals_frees_the_links(tmp_path: Path, drawn: str, more: str) -> None:
    found = find(tmp_path, displaced(drawn, "-0.15 0 -0.032", more=more), {"COL001", "GEO005"})
    assert sorted((f.code, f.message_id) for f in found) == [("COL001", "overlap"), ("GEO005", "differs")]


def test_a_shape_that_overlaps_several_links_is_one_finding(tmp_path: Path) -> None:
    """Two arms of two links each reach, straight at rest, into a box on the base."""
    parts = [make_link("base", "0.5 0 0|" + box("0.1 1 0.1"))]
    for name, y in (("l", 0.2), ("r", -0.2)):
        parts += [
            make_joint("base", f"{name}1", f"0 {y} 0", limit="lower='-3' upper='3'"),
            make_link(f"{name}1", "0.1 0 0|" + box("0.2 0.02 0.02")),
            make_joint(f"{name}1", f"{name}2", "0.25 0 0", limit="lower='-3' upper='3'"),
            make_link(f"{name}2", "0.1 0 0|" + box("0.2 0.02 0.02"), "0.2 0 0|" + sphere("0.02")),
        ]
    (finding,) = find(tmp_path, robot(*parts), "COL001")
    assert finding.message_id == "several"
    assert finding.location.subject == "link[base]/collision/geometry/box"
    assert re.fullmatch(r"base overlaps [lr]2 by \d+(\.\d+)? mm, and 1 more", finding.headline)
    assert "l2 (" in finding.message
    assert "r2 (" in finding.message
    # The middle of the contacts is not the deepest point.
    assert re.search(r"; the surfaces of base and [lr]2 meet around \(.*\) m in base$", finding.message)
    assert "deepest" not in finding.message


def test_links_of_one_body_never_collide(tmp_path: Path) -> None:
    text = robot(
        make_link("a", sphere("0.1")), make_joint("a", "b", "0.1 0 0", "fixed"), make_link("b", sphere("0.1"))
    )  # fmt: skip
    found = pair(self_collisions(model_of(tmp_path, text)), "a", "b")
    assert found.relation == "fixed"
    assert found.is_always_in_collision
    assert found.contact is None
    assert not find(tmp_path, text, "COL001")


def test_a_ball_joint_of_three_hinges_connects_neighbours(tmp_path: Path) -> None:
    text = robot(
        make_link("body", sphere("0.1")),
        make_joint("body", "h1", "0.1 0 0"), make_link("h1"),
        make_joint("h1", "h2", "0 0 0", axis="0 1 0"), make_link("h2"),
        make_joint("h2", "arm", "0 0 0", axis="1 0 0"), make_link("arm", sphere("0.05")),
    )  # fmt: skip
    found = pair(self_collisions(model_of(tmp_path, text)), "body", "arm")
    assert (found.relation, found.joint) == ("adjacent", "h2_arm")
    assert not find(tmp_path, text, "COL001")


@pytest.mark.parametrize(("width", "is_overlap"), [(0.02, False), (0.020002, False), (0.022, True)])
def test_meshes_that_interlock_and_only_touch_share_no_volume(tmp_path: Path, width: float, is_overlap: bool) -> None:
    """A slider in a tube of 20 by 20 mm that touches all four walls: each way out but that along the tube is blocked."""
    for name, boxes in {
        "tube": [((0.04, 0.1, 0.01), (0, 0, z)) for z in (-0.015, 0.015)]
        + [((0.01, 0.1, 0.02), (x, 0, 0)) for x in (-0.015, 0.015)],
        "slider": [((width, 0.02, 0.02), (0, y, 0)) for y in (-0.015, 0.015)],
    }.items():
        parts = [
            trimesh.creation.box(size, np.array(trimesh.transformations.translation_matrix(at))) for size, at in boxes
        ]
        trimesh.util.concatenate(parts).export(tmp_path / f"{name}.stl")
    text = robot(
        make_link("base", mesh("tube.stl")),
        make_link("carrier", "0 0 1|" + box("0.1 0.1 0.1")),
        make_link("slider", "0 0 -1|" + mesh("slider.stl")),
        make_joint("base", "carrier", "0 0 0", "prismatic", axis="0 1 0"),
        make_joint("carrier", "slider", "0 0 1", "prismatic", axis="0 1 0"),
    )
    found = pair(self_collisions(model_of(tmp_path, text)), "base", "slider")
    assert found.contact is not None
    assert found.contact.touching != is_overlap


def test_a_mesh_that_cannot_be_read_is_left_out_and_the_rule_says_so(tmp_path: Path) -> None:
    text = folded().replace(
        "</robot>",
        make_joint("c", "d", "0 0 1") + make_link("d", '<mesh filename="gone.stl"/>') + "</robot>",
    )
    run = check_text(tmp_path, text, codes={"COL001"})
    assert [f.code for f in run.findings] == ["COL001"]
    assert [(s.code, s.reason) for s in run.skipped] == [
        ("COL001", "collision shapes could not be measured and were left out: link[d]")
    ]


def test_links_beyond_a_mesh_that_cannot_be_read_are_no_neighbours(tmp_path: Path) -> None:
    text = robot(
        make_link("a", sphere("0.1")),
        make_joint("a", "b", "0.1 0 0"), make_link("b", '<mesh filename="gone.stl"/>'),
        make_joint("b", "c", "0.1 0 0"), make_link("c", sphere("0.1")),
    )  # fmt: skip
    assert pair(self_collisions(model_of(tmp_path, text)), "a", "c").relation == "far"


def test_without_coal_the_rule_is_skipped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "coal", None)
    run = check_text(tmp_path, folded(), codes={"COL001"})
    assert [s.code for s in run.skipped] == ["COL001"]
    assert "coal is not installed" in run.skipped[0].reason


def test_one_link_that_collides_needs_no_coal(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "coal", None)
    run = check_text(tmp_path, robot(make_link("base", box("1 1 1"), box("2 1 1"))), codes={"COL001"})
    assert not (*run.findings, *run.skipped)


def legs(folder: Path, up: str) -> str:
    """A leg on the left and one on the right, bars that lie along y as drawn and run into each other; with their y axes up
    they hang down, side by side."""
    (folder / "leg.dae").write_text(bar(-0.4, up))
    parts = [make_link("base", "0 0 0.4|" + box("0.1 0.6 0.1"))]
    for side, y in (("left", 0.15), ("right", -0.15)):
        parts += [
            make_joint("base", f"{side}_hip", f"0 {y} 0.2"),
            make_link(f"{side}_hip", sphere("0.01")),
            make_joint(f"{side}_hip", f"{side}_leg", "0 0 -0.1"),
            make_link(f"{side}_leg", '<mesh filename="leg.dae"/>'),
        ]
    return robot(*parts)


def bar(low: float, up: str) -> str:
    """A bar of 0.1 x 0.4 x 0.1, from ``low`` along y, in a file that declares which axis is up."""
    corners = " ".join(f"{x} {y} {z}" for x, y, z in product((-0.05, 0.05), (low, low + 0.4), (-0.05, 0.05)))
    faces = "0 1 3 0 3 2 4 6 7 4 7 5 0 4 5 0 5 1 2 3 7 2 7 6 0 2 6 0 6 4 1 5 7 1 7 3"
    return f"""<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset>{f"<up_axis>{up}</up_axis>" if up else ""}</asset>
<library_geometries><geometry id="g"><mesh><source id="s"><float_array id="a" count="24">{corners}</float_array>
<technique_common><accessor source="#a" count="8" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#s"/></vertices>
<triangles count="12"><input semantic="VERTEX" source="#v" offset="0"/><p>{faces}</p></triangles></mesh></geometry>
</library_geometries><library_visual_scenes><visual_scene id="scene"><node><instance_geometry url="#g"/></node></visual_scene>
</library_visual_scenes><scene><instance_visual_scene url="#scene"/></scene></COLLADA>"""


@pytest.mark.parametrize(("up", "cause"), [("Y_UP", "up_axis"), ("", "up_axis"), ("Z_UP", None)])
def test_meshes_that_lie_on_their_sides_are_one_finding_with_the_cause(
    tmp_path: Path, up: str, cause: str | None
) -> None:
    """COLLADA's default is y."""
    (finding,) = find(tmp_path, legs(tmp_path, up), "COL001")
    assert (finding.cause and finding.cause.id) == cause
    assert finding.message_id == ("lying" if cause else "overlap")
    assert finding.location.subject.endswith("mesh@filename")


def test_a_declared_axis_is_no_cause_where_the_robot_is_alike_on_both_sides_as_drawn(tmp_path: Path) -> None:
    """One bar along y in the middle that runs into a post beside it: upright it would miss the post."""
    (tmp_path / "bar.dae").write_text(bar(-0.2, "Y_UP"))
    text = robot(
        make_link("base", "0 0.2 0|" + box("0.05 0.05 0.05"), "0 -0.2 0|" + box("0.05 0.05 0.05")),
        make_joint("base", "hip", "0 0 0"),
        make_link("hip", sphere("0.001")),
        make_joint("hip", "arm", "0 0 0"),
        make_link("arm", '<mesh filename="bar.dae"/>'),
    )
    (finding,) = find(tmp_path, text, "COL001")
    assert (finding.message_id, finding.cause) == ("overlap", None)


# -- COL002 --------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("gap", "overlap"), [(-0.001, True), (0.0, False), (0.001, False)])
def test_a_wheel_may_touch_its_hub(tmp_path: Path, gap: float, overlap: bool) -> None:
    text = robot(
        make_link("base", box("0.2 0.1 0.05")),
        make_joint("base", "wheel", f"0 {0.06 + gap} 0", "continuous", axis="0 1 0"),
        make_link("wheel", cylinder("0.03", "0.02")).replace('xyz="0 0 0"/>', f'rpy="{math.pi / 2!r} 0 0"/>'),
    )
    assert bool(find(tmp_path, text, "COL002")) == overlap


@pytest.mark.parametrize(
    ("far", "begin"),
    [
        ([], "at 1 joint adjacent links"),
        ([False], "at all 2 joints adjacent"),
        ([False, True], "at 2 of 3 joints adjacent"),
    ],
)
def test_it_says_at_how_many_joints_neighbours_overlap(tmp_path: Path, far: list[bool], begin: str) -> None:
    wheels = [
        make_joint("base", f"wheel{i}", f"0 {1.0 if away else 0.05} {0.1 * i}", "continuous", axis="0 1 0")
        + make_link(f"wheel{i}", sphere("0.03"))
        for i, away in enumerate([False, *far])
    ]
    (finding,) = find(tmp_path, robot(make_link("base", box("0.2 0.1 0.5")), *wheels), "COL002")
    assert finding.message.startswith(begin)


@pytest.mark.parametrize(("reach", "overlap"), [("1.5", True), ("2", False)])
def test_neighbours_count_that_overlap_over_nearly_all_of_the_range(tmp_path: Path, reach: str, overlap: bool) -> None:
    """A ball on an arm in a trough that ends at 1.6 rad to either side: all of 3 rad, or 80 % of 4 rad."""
    trough = [f"{math.cos(a)} {math.sin(a)} 0|" + sphere("0.1") for a in np.linspace(-1.5, 1.5, 20).tolist()]
    text = robot(
        make_link("base", *trough),
        make_joint("base", "arm", "0 0 0", limit=f"lower='-{reach}' upper='{reach}'"),
        make_link("arm", "1 0 0|" + sphere("0.05")),
    )
    assert bool(find(tmp_path, text, "COL002")) == overlap
    found = pair(self_collisions(model_of(tmp_path, text)), "base", "arm")
    assert found.range_share == pytest.approx(min(1.0, 1.65 / float(reach)), abs=1 / 20)


def test_positions_are_spread_evenly_over_every_range(tmp_path: Path) -> None:
    positions = self_collisions(model_of(tmp_path, make_folded_chain())).spread_poses
    assert len(positions.values) == 40
    for values in positions.values.T:
        assert sorted(values) == pytest.approx([-2.5 + (i + 0.5) / 40 * 5 for i in range(40)])


# -- COL005 --------------------------------------------------------------------------------------------------------------


def swinging(limit: str = "lower='-1' upper='2'", kind: str = "revolute", follower: bool = False) -> str:
    """A ball of 0.1 on an arm of 1 that swings about z and meets a wall at x = -0.2: its face at 1.6708 rad from x."""
    parts = [
        make_link("base", "-0.7 0 0|" + box("1 4 1")),
        make_joint("base", "arm", "0 0 0", kind, limit=limit),
        make_link("arm", "1 0 0|" + sphere("0.1")),
    ]
    if follower:
        parts += [
            make_joint("base", "lever", "0 0 5", limit="lower='0' upper='1'"),
            make_link("lever"),
        ]
        parts[1] = make_joint("base", "arm", "0 0 0", limit=limit, mimic='<mimic joint="base_lever" multiplier="2"/>')
    return robot(*parts)


MEETS = math.pi / 2 + math.asin(0.1)


def test_the_value_where_the_collision_begins(tmp_path: Path) -> None:
    (reach,) = find_joint_collisions(model_of(tmp_path, swinging()))
    assert reach.links == ("base", "arm")
    assert reach.limit == 2
    assert reach.value == pytest.approx(MEETS, abs=3e-3)


def test_a_follower_is_moved_with_its_leader(tmp_path: Path) -> None:
    (reach,) = find_joint_collisions(model_of(tmp_path, swinging(follower=True)))
    assert reach.joint.name == "base_lever"
    assert reach.value == pytest.approx(MEETS / 2, abs=3e-3)


def test_a_range_that_ends_before_is_free(tmp_path: Path) -> None:
    assert not find(tmp_path, swinging("lower='-1' upper='1.66'"), "COL005")


def test_a_joint_without_limits_is_looked_at_over_a_turn(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, swinging(kind="continuous"), "COL005")
    assert "continuous" in finding.message
    assert {reach["limit"] for reach in finding.data["collisions"]} == {None}


@pytest.mark.parametrize(("limit", "where"), [("lower='-1' upper='2'", "1.67"), ("lower='-2' upper='2'", "±1.67")])
def test_the_headline_says_where_a_joint_collides(tmp_path: Path, limit: str, where: str) -> None:
    (finding,) = find(tmp_path, swinging(limit), "COL005")
    assert finding.headline == f"base_arm self-collides at {where} rad, inside its range"


@pytest.mark.parametrize(
    ("limit", "kind", "message"),
    [
        ("lower='-1' upper='2'", "revolute", "reached"),
        ("lower='-1' upper='1.7'", "revolute", "pose"),  # as near to the limit as shapes are inexact
        ("", "continuous", "pose"),
    ],
)
def test_collisions_that_no_limit_should_prevent_are_on_request(
    tmp_path: Path, limit: str, kind: str, message: str
) -> None:
    (finding,) = find(tmp_path, swinging(limit, kind), "COL005")
    assert finding.message_id == message


@pytest.mark.parametrize(("between", "message"), [("fixed", "reached"), ("revolute", "pose")])
def test_a_collision_that_another_joint_avoids_is_on_request(tmp_path: Path, between: str, message: str) -> None:
    parts = [
        make_link("base", "-0.7 0 0|" + box("1 4 1")),
        make_joint("base", "arm", "0 0 0", limit="lower='-1' upper='2'"),
        make_link("arm"),
        make_joint("arm", "hand", "0.5 0 0", between, axis="0 1 0", limit="lower='-0.1' upper='0.1'"),
        make_link("hand", "0.5 0 0|" + sphere("0.1")),
    ]
    (finding,) = [f for f in find(tmp_path, robot(*parts), "COL005") if "base_arm" in f.headline]
    assert finding.message_id == message


def test_the_message_names_three_collisions_and_the_data_all(tmp_path: Path) -> None:
    """Five arms far apart, each with a wall."""
    parts = [make_link("base", *(f"-0.7 {10 * i} 0|" + box("1 4 1") for i in range(5)))]
    for i in range(5):
        parts.append(make_joint("base", f"arm{i}", f"0 {10 * i} 0", limit="lower='-1' upper='2'"))
        parts.append(make_link(f"arm{i}", "1 0 0|" + sphere("0.1")))
    (finding,) = find(tmp_path, robot(*parts), "COL005")
    assert finding.headline == "base_arm0 self-collides at 1.67 rad, inside its range (+4 joints)"
    assert "and 2 more" in finding.message
    assert "arm3" not in finding.message
    assert [reach["links"] for reach in finding.data["collisions"]] == [["base", f"arm{i}"] for i in range(5)]


def test_neighbours_that_part_again_on_the_way_do_not_count(tmp_path: Path) -> None:
    """The ball passes through a post of the base and is free at the limit: for neighbours, a bearing that grazes."""
    text = swinging("lower='-1' upper='3'").replace("-0.7 0 0", "0 1 0").replace("1 4 1", "0.1 0.1 0.1")
    assert not find(tmp_path, text, "COL005")


@pytest.mark.parametrize(("gap", "reached"), [(0.0, 0), (0.05, 1)])
def test_neighbours_that_touch_at_rest_do_not_count(tmp_path: Path, gap: float, reached: int) -> None:
    """A box that stands on a box, as the fingers of Allegro hands are drawn: whichever way it tips, an edge goes in."""
    cube = box("0.2 0.2 0.2")
    tips = make_joint("foot", "leg", f"0 0 {0.1 + gap}", axis="0 1 0", limit="lower='-1' upper='1'")
    text = f'<robot name="r">{make_link("foot", cube)}{tips}{make_link("leg", "0 0 0.1|" + cube)}</robot>'
    assert len(find(tmp_path, text, "COL005")) == reached


# -- the collisions themselves -------------------------------------------------------------------------------------------


def make_folded_chain(links: int = 5) -> str:
    """A chain of plates and balls about crossed axes, folded enough to meet itself now and then."""
    parts = [make_link("l0", box("0.3 0.3 0.1"))]
    for i in range(1, links):
        axis = ("0 1 0", "1 0 0", "0 0 1")[i % 3]
        parts.append(make_joint(f"l{i - 1}", f"l{i}", "0 0 0.15", axis=axis, limit="lower='-2.5' upper='2.5'"))
        parts.append(make_link(f"l{i}", "0 0 0.07|" + box("0.06 0.05 0.1"), "0.02 0 0.1|" + sphere("0.03")))
    return robot(*parts)


@pytest.mark.slow
@pytest.mark.parametrize("source", ["arm", "car-3"])
def test_every_pair_and_configuration_is_as_coal_sees_it_alone(tmp_path: Path, source: str) -> None:
    """No bounding volume, no proof: each pair of shapes in each configuration, asked one by one.

    The car's wheels touch their hubs, the gap being 0 or 2 nm: coal sees them meet, and here they do not."""
    car = FIXTURES / "car-3/urdf/car-3.urdf"
    model = model_of(tmp_path, make_folded_chain(), samples=60) if source == "arm" else model_at(car, samples=20)
    touching = set() if source == "arm" else {("base_link", f"wheel_{i}") for i in range(1, 5)}
    found = self_collisions(model)
    frames = poses.compute_frames(model, found.poses)
    assert found.pairs
    assert not found.skipped_shapes
    for p in found.pairs:
        shapes = [[(s, alone(model, s)) for s in model.link_by_name[name].collisions] for name in p.links]
        for n in range(len(found.poses.values)):
            expected = False
            for (one, a), (other, b) in product(*shapes):
                places = [frames[name][n] @ s.origin.matrix for name, s in zip(p.links, (one, other), strict=True)]
                transforms = [coal.Transform3s(m[:3, :3], m[:3, 3]) for m in places]
                result = coal.CollisionResult()
                expected |= bool(coal.collide(a, transforms[0], b, transforms[1], coal.CollisionRequest(), result))
            assert p.hits[n] == (expected and p.links not in touching)


def alone(model: Model, shape: Shape) -> object:
    """A shape for coal, every mesh as its triangles."""
    if shape.kind != "mesh":
        assert shape.size is not None
        return {"box": coal.Box, "sphere": coal.Sphere, "cylinder": coal.Cylinder}[shape.kind or ""](*shape.size)
    facts, tree = model.meshes.get_facts(shape), coal.BVHModelOBBRSS()
    assert facts is not None
    tree.beginModel(len(facts.faces), len(facts.vertices))
    tree.addVertices(facts.vertices * np.array(compute_drawn_scale(model, shape)))
    tree.addTriangles(np.array(facts.faces))
    tree.endModel()
    return tree


def test_the_arm_shows_all_kinds_of_pairs(tmp_path: Path) -> None:
    """What the other tests rest on: pairs that are proven apart, that meet now and then, and always."""
    far = [p for p in self_collisions(model_of(tmp_path, make_folded_chain())).pairs if p.relation == "far"]
    assert any(0 < p.hit_count < 200 for p in far)
    assert len(far) == sum(1 for a, b in combinations(range(5), 2) if b - a > 1)


def test_what_is_proven_apart_never_meets(tmp_path: Path) -> None:
    """Two arms at some distance: the proof holds in every configuration, and does not reach pairs that do meet."""
    parts = [make_link("base", box("0.1 2 0.1"))]
    for name, y in (("l", 0.6), ("r", -0.6)):
        for i, (parent, reach) in enumerate((("base", 0.0), (f"{name}1", 0.3), (f"{name}2", 0.3)), 1):
            parts.append(make_joint(parent, f"{name}{i}", f"{reach} {y if i == 1 else 0} 0.2", axis="0 0 1"))
            parts.append(make_link(f"{name}{i}", "0.1 0 0|" + box("0.2 0.05 0.05")))
    model = model_of(tmp_path, robot(*parts), samples=2000)
    apart = {p.links for p in self_collisions(model).pairs if p.is_proven_apart}
    assert ("l1", "r1") in apart
    assert ("l3", "r3") not in apart
    bench = self_collisions(model).setup
    proven = np.array([p.is_proven_apart for p in self_collisions(model).pairs])
    assert not bench.colliders.detect_collisions(
        bench.compute_placements(self_collisions(model).poses), bench.pairs[proven]
    ).any()
    assert not any(p.is_proven_apart and p.hit_count for p in self_collisions(model).pairs)


def test_a_slide_without_end_proves_nothing(tmp_path: Path) -> None:
    slide = {"kind": "prismatic", "axis": "1 0 0"}
    for limit, proven in (("lower='0' upper='0.1'", True), ("lower='-1e6' upper='1e6'", False)):
        text = robot(
            make_link("a", sphere("0.1")),
            make_joint("a", "b", "1 0 0", **slide, limit=limit),
            make_link("b", sphere("0.1")),
        )
        assert self_collisions(model_of(tmp_path, text)).pairs[0].is_proven_apart == proven


def test_what_is_not_asked_for_is_not_computed(tmp_path: Path) -> None:
    """An audit without a semantic description looks at what overlaps at rest, and not at other pairs in many poses."""
    cache = ArrayCache(tmp_path / "cache")
    found = self_collisions(model_of(tmp_path, make_folded_chain(), cache))
    assert set(found.cache_entry) == {"rest"}
    assert [p.hit_count for p in found.pairs if p.relation == "far"]
    assert set(found.cache_entry) == {"rest", "never", "others-200"}


def test_each_joint_runs_into_what_a_search_without_bounds_finds(tmp_path: Path) -> None:
    """Every pair at every step, in the order of the steps: the first that meets, and where."""
    model = model_of(tmp_path, make_folded_chain(7))
    setup, rest = self_collisions(model).setup, poses.make_neutral_configuration(model)
    expected = []
    for i, hinge in enumerate(rest.joints):
        for limit in (-2.5, 2.5):
            values = np.repeat(rest.values, 33, axis=0)
            values[:, i] = np.linspace(0.0, limit, 33)
            hits = setup.colliders.detect_collisions(
                setup.compute_placements(poses.JointConfigurations(rest.joints, values)), setup.pairs
            )
            for k, (relation, _) in enumerate(setup.relations):
                if relation == "adjacent":
                    hits[k] = np.logical_and.accumulate(hits[k, ::-1])[::-1]
            hits[hits[:, 0]] = False
            if hits.any():
                n = int(hits.any(axis=0).argmax())
                first = self_collisions(model).pairs[int(hits[:, n].argmax())]
                expected.append((hinge.name, first.links, values[n, i]))
    found = find_joint_collisions(model)
    assert expected
    assert [(r.joint.name, r.links) for r in found] == [(name, links) for name, links, _ in expected]
    assert all(abs(r.value - value) <= 5 / 64 for r, (_, _, value) in zip(found, expected, strict=True))


def test_a_second_run_gives_the_same_and_computes_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    cache, text = ArrayCache(tmp_path / "cache"), make_folded_chain()
    first = model_of(tmp_path, text, cache)
    expected, reached = self_collisions(first), find_joint_collisions(first)
    assert [vars_of(p) for p in self_collisions(model_of(tmp_path, text)).pairs] == [vars_of(p) for p in expected.pairs]
    monkeypatch.setattr(collision_setup, "Colliders", None)
    again = model_of(tmp_path, text, cache)
    assert [vars_of(p) for p in self_collisions(again).pairs] == [vars_of(p) for p in expected.pairs]
    assert [(r.value, r.links) for r in find_joint_collisions(again)] == [(r.value, r.links) for r in reached]


@pytest.mark.parametrize("change", [("0.06 0.05 0.1", "0.07 0.05 0.1"), ("-2.5", "-2.4"), ("0 0 0.15", "0 0 0.16")])
def test_what_decides_about_collisions_is_in_the_key(tmp_path: Path, change: tuple[str, str]) -> None:
    one, other = (
        model_of(tmp_path / name, text)
        for name, text in (("a", make_folded_chain()), ("b", make_folded_chain().replace(*change)))
    )
    same = model_of(tmp_path / "c", make_folded_chain().replace("<box", "<!-- x --><box"))
    assert self_collisions(one).setup.compute_key() != self_collisions(other).setup.compute_key()
    assert self_collisions(one).setup.compute_key() == self_collisions(same).setup.compute_key()


def vars_of(found: CollisionPair) -> tuple[object, ...]:
    contact = found.contact
    place = None if contact is None else (contact.depth, contact.point, contact.normal, contact.size)
    return found.links, found.relation, found.hits.tobytes(), found.is_proven_apart, found.is_complete, place


# -- arms that cross -----------------------------------------------------------------------------------------------------


def make_crossing_arms(joints: int, limb: str, drawn: str = "") -> str:
    """Two limbs beside each other, whose last links reach over to the other side at rest alone; ``drawn``: what each draws."""
    parts = [make_link("base")]
    for side, y in (("left", 0.3), ("right", -0.3)):
        parent = "base"
        for index in range(joints):
            name = f"{side}_{limb}_{index}"
            last = index == joints - 1
            parts.append(
                make_joint(parent, name, f"0 {y} 0" if index == 0 else "0 0 0.1", axis="1 0 0" if last else "0 0 1")
            )
            hand = collision(box("0.03 0.36 0.03"), xyz=f"0 {-0.5 * y:g} 0"), visual(drawn) if drawn else ""
            parts.append(link(name, *hand) if last else make_link(name))
            parent = name
    return robot(*parts)


@pytest.mark.parametrize(
    ("joints", "limb", "drawn", "severity"),
    [
        (4, "arm", "", Severity.INFO),
        (2, "arm", "", Severity.WARNING),
        (4, "leg", "", Severity.WARNING),
        (4, "arm", box("0.03 0.1 0.03"), Severity.WARNING),
    ],
)
def test_arms_that_cross_at_rest_alone_have_no_wrong_shape(
    tmp_path: Path, joints: int, limb: str, drawn: str, severity: Severity
) -> None:
    """Those that are drawn apart at rest have one."""
    (finding,) = find(tmp_path, make_crossing_arms(joints, limb, drawn), "COL001")
    assert (finding.message_id, finding.severity) == ("overlap", severity)
