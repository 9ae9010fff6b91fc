"""What follows from another defect, or is one of another kind: the finding says so, or is left to the rule that has the cause."""

from __future__ import annotations

from pathlib import Path

import pytest
import trimesh
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

from urdfcheck.core import Finding, Severity


def one(folder: Path, text: str, codes: str | set[str], name: str = "robot.urdf") -> Finding:
    (finding,) = find(folder, text, codes, name=name)
    return finding


PAIRS = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))


def title(finding: Finding) -> str:
    assert finding.fix is not None
    return finding.fix.title


def test_a_call_without_its_prefix_is_no_misspelt_element(tmp_path: Path) -> None:
    text = robot(
        '<xacro:macro name="m_link" params="name"><link name="${name}"/></xacro:macro>',
        link("base"),
        '<m_link name="a"/>',
        xacro=True,
    )
    assert one(tmp_path, text, {"XML003", "XAC007"}, "robot.urdf.xacro").code == "XAC007"


def test_numbers_in_elements_of_their_own_are_not_moved(tmp_path: Path) -> None:
    axis = "<axis><xyz>1 0 0</xyz><dynamics><friction>10</friction></dynamics></axis>"
    text = robot(link("base"), link("arm"), joint("j", "base", "arm", axis, kind="continuous"))
    (finding,) = [f for f in find(tmp_path, text, "XML003") if f.data["tag"] == "dynamics"]
    assert title(finding).startswith("delete it, or write its numbers as attributes")


@pytest.mark.parametrize(
    ("numbers", "cause"),
    [
        ("0.01 0.01 0 0.01 0.01 0.01", None),
        ("0.01 0.01 0.01 0.01 0.01 0.01", None),
        ("0.03 0.01 0 0.01 0.02 0.03", "rows"),
    ],
)
def test_rows_that_make_no_body_are_no_cause(tmp_path: Path, numbers: str, cause: str | None) -> None:
    names = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    terms = dict(zip(names, numbers.split(), strict=True))
    for finding in find(tmp_path, arm_on_base(inertial(1, **terms)), "INR004"):
        assert (finding.cause is not None and finding.cause.id == "rows") == (cause == "rows")


@pytest.mark.parametrize(
    ("name", "advice"),
    [
        ("arm ", "delete each space at the beginning or end, here"),
        ("an arm", "replace each space by an underscore, here"),
        (" an arm", "delete each space at the beginning or end and replace each space by an underscore, here"),
    ],
)
def test_a_space_at_the_end_of_a_name_is_a_slip(tmp_path: Path, name: str, advice: str) -> None:
    text = robot(link("base"), joint("j", "base", name, kind="continuous"), link(name))
    assert title(one(tmp_path, text, "NAM001")).startswith(advice)


def test_what_publishes_the_joints_drives_none(tmp_path: Path) -> None:
    def extend(library: str) -> str:
        plugin = f'<plugin name="p" filename="{library}"><jointName>a, b, c</jointName></plugin>'
        return robot(
            link("base"),
            *(link(name) + joint(name, "base", name, limit(-1, 1), kind="revolute") for name in "abc"),
            f"<gazebo>{plugin}</gazebo>",
            *("<transmission name='t'><joint name='a'/></transmission>",),
        )

    assert not find(tmp_path, extend("libgazebo_ros_joint_pose_trajectory.so"), "CTL002", pedantic=True)
    (finding,) = find(tmp_path, extend("libgazebo_ros_joint_state_publisher.so"), "CTL002", pedantic=True)
    assert finding.data["joints"] == "b, c"
    assert "<ros2_control>" not in title(finding)


def test_the_com_of_a_motor_is_not_that_of_its_shaft(tmp_path: Path) -> None:
    shaft = visual(cylinder(0.003, 0.06), xyz="0 0 0.03")
    assert not find(tmp_path, arm_on_base(inertial(0.5, 1e-4, com="0 0 -0.02"), shaft), "INR006")
    assert find(tmp_path, arm_on_base(inertial(0.01, 1e-6, com="0 0 -0.02"), shaft), "INR006")


def test_numbers_that_were_made_up_have_no_decimal_point(tmp_path: Path) -> None:
    ball = visual(cylinder(0.05, 0.1))

    def pair(other: float) -> str:
        return robot(
            link("base"),
            link("a", inertial(0.1, 0.001), ball),
            joint("ja", "base", "a", kind="continuous"),
            link("b", inertial(0.2, other), visual(box("0.1 0.2 0.3"))),
            joint("jb", "base", "b", kind="continuous"),
        )

    assert not [
        f for f in find(tmp_path, pair(0.01), "INR009") if f.cause is not None and f.cause.id == "decimal_point"
    ]


def test_a_wheel_with_an_empty_range_is_to_turn(tmp_path: Path) -> None:
    text = robot(
        link("base"), link("left_wheel"), joint("left_wheel_joint", "base", "left_wheel", limit(0, 0), kind="revolute")
    )
    assert title(one(tmp_path, text, "JNT005")).startswith('write type="continuous"')


@pytest.mark.parametrize(("part", "says"), [("", "drops the link"), (inertial(1, 0.01), "aborts at the first step")])
def test_a_link_that_gazebo_drops_does_not_stop_it(tmp_path: Path, part: str, says: str) -> None:
    finding = one(tmp_path, arm_on_base(part, collision(box("0.1 0.1 0"))), "GEO001")
    assert finding.consequences["gazebo"].startswith(says)


@pytest.mark.parametrize(
    ("element", "severity"), [("<gazebo/>", Severity.WARNING), ("<mujoco/>", Severity.ERROR), ("", Severity.ERROR)]
)
def test_below_world_gazebo_merges_nothing_and_drops_a_ground_without_mass(
    tmp_path: Path, element: str, severity: Severity
) -> None:
    text = robot(
        link("world"),
        link("ground", collision(box("5 5 0"))),
        joint("g", "world", "ground", kind="fixed"),
        link("arm", inertial(1, 0.01)),
        joint("a", "world", "arm", kind="fixed"),
        element,
    )
    finding = one(tmp_path, text, "GEO001")
    assert finding.severity is severity
    assert finding.consequences["gazebo"].startswith("drops the link")


def test_an_element_of_a_macro_is_at_fault_where_the_macro_has_it(tmp_path: Path) -> None:
    macro = """<xacro:macro name="m" params="name *origin place">
<link name="${name}"><origin xyz="${place}"/></link>
<joint name="${name}_j" type="fixed"><parent link="base"/><child link="${name}"/><origin xyz="0 0 1"/>
<xacro:insert_block name="origin"/>
</joint></xacro:macro>
"""
    call = '<xacro:m name="a" place="0 0 0.3">\n<origin xyz="0 1 0"/></xacro:m>'
    text = robot(link("base"), "\n" + macro, call, xacro=True)
    places = {f.code: f.location.span.line for f in find(tmp_path, text, {"XML003", "XML006"}, name="robot.urdf.xacro")}
    first = text.splitlines().index(macro.splitlines()[0]) + 1
    assert places == {"XML003": first + 1, "XML006": first + 3}


@pytest.mark.parametrize(("height", "found"), [("0.1", True), ("0.106", False)])
def test_boxes_around_two_drawings_that_differ_are_right(tmp_path: Path, height: str, found: bool) -> None:
    """A part that stands elsewhere on the right makes its box higher by 6 mm, as its collision box is."""
    for name, top in (("left", 0.1), ("right", float(height))):
        write_boxes(
            tmp_path / f"{name}_arm.stl", [((0.1, 0.1, 0.09), (0, 0, 0.045)), ((0.02, 0.02, 0.02), (0, 0, top - 0.01))]
        )

    def bar(height: float) -> str:
        return collision(box(f"0.1 0.1 {height}"), xyz=f"0 0 {height / 2}")

    text = robot(
        link("base"),
        *(
            link(
                f"{side}_arm",
                inertial(1, 0.01),
                visual(mesh(f"{side}_arm.stl")),
                stand_in,
            )
            + joint(side, "base", f"{side}_arm", kind="continuous", xyz=f"0 {y} 0")
            for side, stand_in, y in (("left", bar(0.1), 0.3), ("right", bar(0.106), -0.3))
        ),
    )
    assert bool(find(tmp_path, text, "SYM007", pedantic=True)) == found


def write_boxes(path: Path, boxes: list[tuple[tuple[float, float, float], tuple[float, float, float]]]) -> None:
    parts = [trimesh.creation.box(size, trimesh.transformations.translation_matrix(place)) for size, place in boxes]
    trimesh.util.concatenate(parts).export(path)


@pytest.mark.parametrize(("axis", "wanted"), [("0 0 1", ""), ("", " and an <axis> (without one it is x)")])
def test_a_bracket_that_carries_a_wheel_is_not_to_turn_and_a_pose_goes_into_the_origin(
    tmp_path: Path, axis: str, wanted: str
) -> None:
    bracket = robot(
        link("base"),
        link("wheel_bracket"),
        joint("wheel_joint", "base", "wheel_bracket", limit(0.4, 0.4), kind="revolute", axis=axis),
        link("tyre"),
        joint("wheel_joint_2", "wheel_bracket", "tyre", kind="continuous"),
    )
    advice = title(one(tmp_path, bracket, "JNT005"))
    assert advice == f"give the real range{wanted}, or make the joint fixed, with 0.4 rad in its <origin>"


def test_a_robot_on_wheels_that_lean_by_a_rounded_pi_stands(tmp_path: Path) -> None:
    wheels = [
        link(name, inertial(0.2, 1e-4), collision(cylinder(0.03, 0.02), rpy="1.5708 0 0"))
        + joint(name, "base", name, kind="continuous", xyz=f"{x} {y} 0", axis="0 1 0")
        for name, x, y in (("a", 0.1, 0.148), ("b", 0.1, -0.148), ("c", -0.1, 0.148), ("d", -0.1, -0.148))
    ]
    text = robot(link("base", inertial(1, 0.01, com="-0.01 0.039 0")), *wheels)
    assert not find(tmp_path, text, "DYN004")


def test_a_ball_caster_rolls_about_any_axis(tmp_path: Path) -> None:
    def caster(shape: str) -> str:
        disc = visual(cylinder(0.03, 0.01), rpy="1.5708 0 0")
        part = link("caster_wheel", inertial(0.1, 1e-4), disc, shape)
        return robot(link("base"), part, joint("j", "base", "caster_wheel", kind="continuous"))

    assert find(tmp_path, caster(collision(cylinder(0.03, 0.01), rpy="1.5708 0 0")), "JNT015")
    assert not find(tmp_path, caster(collision(sphere(0.03))), "JNT015")


@pytest.mark.parametrize(
    ("axis", "radius", "found"),
    [("0 1 0", 0.03, False), ("1 0 0", 0.03, True), ("0 0 1", 0.03, True), ("1 0 0", 0.02, False)],
)
def test_a_wheel_that_collides_as_a_ball_of_its_size_has_its_own_axis(
    tmp_path: Path, axis: str, radius: float, found: bool
) -> None:
    disc = visual(cylinder(0.03, 0.01), rpy="1.5708 0 0")
    part = link("wheel", inertial(0.1, 1e-4), disc, collision(sphere(radius)))
    text = robot(link("base"), part, joint("j", "base", "wheel", kind="continuous", axis=axis))
    assert bool(find(tmp_path, text, "JNT015")) == found


@pytest.mark.parametrize(("right", "found"), [("0.05 0 0", False), ("0.05 0.03 0", True)])
def test_equal_inertials_of_drawings_that_are_shifted_are_not_compared(tmp_path: Path, right: str, found: bool) -> None:
    """The right part is drawn 20 mm aside. Where its COM is its own as well, the two differ."""
    write_boxes(tmp_path / "part.stl", [((0.1, 0.06, 0.03), (0, 0, 0)), ((0.03, 0.02, 0.02), (0.03, 0.02, 0.025))])
    moments = {"ixx": 4e-4, "iyy": 9e-4, "izz": 1.1e-3}
    text = robot(
        link("base"),
        *(
            link(f"{side}_part", inertial(1, com=com, **moments), visual(mesh("part.stl"), xyz=xyz))
            + joint(f"{side}_joint", "base", f"{side}_part", kind="continuous", xyz=f"0 {y} 0")
            for side, com, xyz, y in (("left", "0.05 0 0", "0.05 0 0", 0.2), ("right", right, "0.05 0.02 0", -0.2))
        ),
    )
    assert bool(find(tmp_path, text, "SYM004", pedantic=True)) == found


@pytest.mark.parametrize(("mass", "found"), [(0.02, False), (2, True)])
def test_the_com_of_a_light_part_of_a_body_moves_nothing(tmp_path: Path, mass: float, found: bool) -> None:
    """Of 20 g on 5 kg, a COM that is 50 mm off moves that of the body by 0.2 mm."""
    part = inertial(mass, ixx=mass * 1e-3, iyy=mass * 2e-3, izz=mass * 2.5e-3)
    text = robot(
        link("base"),
        link("chassis", inertial(5, ixx=0.02, iyy=0.03, izz=0.04), visual(box("0.2 0.1 0.1"))),
        joint("j0", "base", "chassis", kind="floating"),
        link("sensor", part, visual(box("0.15 0.1 0.05"), xyz="0.05 0 0")),
        joint("j1", "chassis", "sensor", kind="fixed"),
    )
    assert bool([f for f in find(tmp_path, text, "INR009", pedantic=True) if "sensor" in f.message]) == found


@pytest.mark.parametrize(
    ("sign", "words"), [("", "digit for digit, but"), ("-", "digit for digit, apart from the signs")]
)
def test_tensors_with_other_signs_are_not_equal(tmp_path: Path, sign: str, words: str) -> None:
    terms = {"ixx": 0.012345, "iyy": 0.023456, "izz": 0.030123, "ixy": 0.001234}
    shapes = {"a": box("0.3 0.2 0.1"), "b": box("0.9 0.02 0.02")}
    text = robot(
        link("base"),
        *(
            link(name, inertial(1, **terms | ({} if name == "a" else {"ixy": f"{sign}0.001234"})), visual(shape))
            + joint(f"j{name}", "base", name, kind="continuous")
            for name, shape in shapes.items()
        ),
    )
    assert words in one(tmp_path, text, "INR008").message


def test_a_path_that_is_only_a_package_is_listed_as_it_is_typed(tmp_path: Path) -> None:
    (tmp_path / "part.stl").write_text("solid p\nendsolid p\n")
    finding = one(tmp_path, robot(link("a", visual(mesh("package://part.stl")))), "PKG001")
    assert "(package://part.stl)" in finding.message


def test_a_joint_that_keeps_a_link_for_a_plugin_is_a_note(tmp_path: Path) -> None:
    plugin = '<gazebo><plugin name="p" filename="libvacuum.so"><bodyName>{}</bodyName></plugin></gazebo>'
    locked = joint("j", "base", "cup", limit(0, 0), kind="revolute")
    severities = [
        one(tmp_path, robot(link("base"), link("cup"), locked, *plugins), "JNT005").severity
        for plugins in ([plugin.format("cup")], [plugin.format("other")], [])
    ]
    # The code of another plugin may look for the link too.
    assert severities == [Severity.INFO, Severity.INFO, Severity.WARNING]


def test_a_turn_about_z_is_not_another_upward_axis(tmp_path: Path) -> None:
    """A part whose numbers are turned by a quarter about z, or about x."""
    drawn = [((0.1, 0.06, 0.03), (0.05, 0.0, 0.0)), ((0.03, 0.02, 0.02), (0.08, 0.02, 0.025))]
    write_boxes(tmp_path / "part.stl", drawn)
    solid = trimesh.load(tmp_path / "part.stl")
    for axis, is_upward in (((0, 0, 1), False), ((1, 0, 0), True)):
        turned = solid.copy()
        turned.apply_transform(trimesh.transformations.rotation_matrix(1.5707963267948966, axis))
        turned.density = 1.0 / turned.volume
        tensor = turned.moment_inertia
        terms = {
            name: f"{tensor[i]:.6g}" for name, i in zip(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), PAIRS, strict=True)
        }
        com = " ".join(f"{value:.6g}" for value in turned.center_mass)
        text = arm_on_base(inertial(1, com=com, **terms), visual(mesh("part.stl")))
        causes = [
            f.cause.text for f in find(tmp_path, text, "INR009") if f.cause is not None and f.cause.id == "quarter_turn"
        ]
        assert [("upward axis" in text) for text in causes] == [is_upward]


@pytest.mark.parametrize(("kind", "found"), [("universal", False), ("revolute", True)])
def test_a_wheel_that_an_sdf_steers_and_rolls_has_two_axes(tmp_path: Path, kind: str, found: bool) -> None:
    """The URDF has one joint for both, about which it shows how the wheel is steered."""
    wheel = link("front_wheel", inertial(0.1, 1e-4), visual(cylinder(0.1, 0.02), rpy="1.5708 0 0"))
    turns = joint("front_joint", "base", "front_wheel", kind="continuous", axis="0 0 1")
    files = {
        "package.xml": "<package><name>car</name></package>",
        "car.urdf": robot(link("base"), wheel, turns),
        "model.sdf": f"<sdf><model><joint name='front_joint' type='{kind}'/></model></sdf>",
    }
    assert bool(find(tmp_path, files, "JNT015", name="car.urdf")) == found


@pytest.mark.parametrize(
    ("kind", "part", "severity", "repair"),
    [
        (
            "continuous",
            "<limit><lower>-1e308</lower><upper>1e308</upper></limit>",
            "info",
            "delete it: a continuous joint",
        ),
        ("continuous", '<limit lower="-1" upper="1"/>', "info", "delete it: a continuous joint"),
        (
            "continuous",
            "<limit><lower>-1</lower><effort>5</effort></limit>",
            "warning",
            "delete it, or write its numbers",
        ),
        ("revolute", "<limit><lower>-1</lower><upper>1</upper></limit>", "warning", "delete it, or write its numbers"),
        ("fixed", '<dynamics friction="1"/>', "info", "delete it: the joint is fixed"),
        ("continuous", '<dynamics friction="1"/>', "warning", "move it into the <joint> around it"),
    ],
)
def test_what_a_joint_would_not_use_is_not_lost(
    tmp_path: Path, kind: str, part: str, severity: str, repair: str
) -> None:
    text = arm_on_base(kind=kind).replace("</joint>", f'<axis xyz="0 0 1">{part}</axis></joint>')
    (finding,) = find(tmp_path, text, "XML003", unrequested=frozenset())
    assert (finding.severity.name.lower(), title(finding)[: len(repair)]) == (severity, repair)


@pytest.mark.parametrize("used", [False, True])
def test_what_one_joint_loses_comes_before_what_another_would_not_use(tmp_path: Path, used: bool) -> None:
    axis = '<axis xyz="0 0 1"><limit lower="-1" upper="1"/></axis>'
    kind = "revolute" if used else "continuous"
    joints = joint("j", "a", "b", axis, kind="continuous"), joint("k", "b", "c", axis, kind=kind)
    (finding,) = find(tmp_path, robot(link("a"), link("b"), link("c"), *joints), "XML003", unrequested=frozenset())
    assert finding.subjects[0].startswith("joint[k]" if used else "joint[j]")
    assert (finding.severity.name == "WARNING") == used


def test_a_block_for_gazebo_has_a_name_that_is_defined_where_the_element_is_typed(tmp_path: Path) -> None:
    """The macro that makes the link has a name for it, and makes other links: the block of one call names its link."""
    surface = "<surface><friction><ode><mu>5</mu></ode></friction></surface>"
    hit = collision(box("1 1 1")).replace("</collision>", f"{surface}</collision>")
    made = '<link name="${name}"><xacro:insert_block name="more"/></link>'
    macro = f'<xacro:macro name="m" params="name **more">{made}</xacro:macro>'
    calls = [
        f'<xacro:m name="{name}"><b>{inside}</b></xacro:m>' for name, inside in (("a", ""), ("b", hit), ("c", hit))
    ]
    joints = joint("j", "a", "b"), joint("k", "b", "c")
    found = find(tmp_path, robot(macro, *calls, *joints, xacro=True), "XML003", name="robot.urdf.xacro")
    assert [title(f) for f in found] == [
        'move it into `<gazebo reference="b"><collision>…</collision></gazebo>` at the end of the robot, and the same for c, '
        "or delete it"
    ]


@pytest.mark.parametrize("inside", ["{hit}", "<xacro:hit/>"])
def test_a_block_for_gazebo_in_the_macro_of_the_link_has_the_name_of_that(tmp_path: Path, inside: str) -> None:
    surface = "<surface><friction><ode><mu>5</mu></ode></friction></surface>"
    hit = collision(box("1 1 1")).replace("</collision>", f"{surface}</collision>")
    macros = (
        f'<xacro:macro name="hit">{hit}</xacro:macro>'
        f'<xacro:macro name="m" params="name"><link name="${{name}}">{inside.format(hit=hit)}</link></xacro:macro>'
    )
    calls = '<xacro:m name="a"/><xacro:m name="b"/>'
    text = robot(macros, calls, joint("j", "a", "b"), xacro=True)
    (finding,) = find(tmp_path, text, "XML003", name="robot.urdf.xacro")
    assert title(finding).startswith(
        'move it into `<gazebo reference="${name}"><collision>…</collision></gazebo>` after the link'
    )
