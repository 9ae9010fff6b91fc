"""Values that are wrong for some programs only, in models that are not for them, and the repair that spoils least."""

from __future__ import annotations

from pathlib import Path

import pytest
from builders import arm_on_base, box, collision, cylinder, find, inertial, joint, limit, link, robot, visual
from conftest import check_text

from urdfcheck.core import Severity

ZERO = inertial(0, 0)
HEAVY = inertial(1, 0.01)
FAKE = "<!-- for Gazebo replace the null masses of the fake links -->"


def make_ball_joint(more: str = "", *, first: str = ZERO, last: str = HEAVY) -> str:
    """Return two joints with a frame between them, that carries a link."""
    return robot(
        more,
        link("base", HEAVY),
        link("frame", first),
        link("arm", last),
        joint("roll", "base", "frame", kind="continuous", axis="1 0 0"),
        joint("pitch", "frame", "arm", kind="continuous", axis="0 1 0"),
    )


@pytest.mark.parametrize(
    ("text", "script", "severity"),
    [
        (make_ball_joint(), "", Severity.WARNING),
        (make_ball_joint(), "spawn in gazebo_ros", Severity.ERROR),
        (make_ball_joint(FAKE), "spawn in gazebo_ros", Severity.WARNING),
        (make_ball_joint("<!-- it has no fake links -->"), "spawn in gazebo_ros", Severity.ERROR),
        (make_ball_joint("<gazebo><static>false</static></gazebo>"), "", Severity.ERROR),
        (make_ball_joint(first=ZERO + visual(box("1 1 1"))), "", Severity.ERROR),
        (make_ball_joint(FAKE, first=ZERO + visual(box("1 1 1"))), "", Severity.WARNING),
        (make_ball_joint(last=ZERO), "", Severity.ERROR),
    ],
)
def test_frames_without_mass_between_two_axes_matter_to_those_that_drop_them(
    tmp_path: Path, text: str, script: str, severity: Severity
) -> None:
    (tmp_path / "start.py").write_text(script)
    found = find(tmp_path, text, "INR002")
    assert {f.severity for f in found if f.message_id == "zero"} == {severity}


@pytest.mark.parametrize(
    ("moment", "drawing", "targets", "severity", "repair"),
    [
        (1e-6, "", (), Severity.WARNING, "remove its <inertial>"),
        (1e-6, visual(box("1 1 1")), (), Severity.WARNING, "write the mass, unless that of arm includes it"),
        (1e-6, "", ("drake",), Severity.ERROR, "remove its <inertial>"),
        (1e-3, "", (), Severity.ERROR, "remove its <inertial>"),
    ],
)
def test_an_inertia_without_mass_is_lost_in_the_body_it_is_fixed_to(
    tmp_path: Path, moment: float, drawing: str, targets: tuple[str, ...], severity: Severity, repair: str
) -> None:
    more = link("tcp", inertial(0, moment), drawing) + joint("tcp_joint", "arm", "tcp")
    text = arm_on_base(HEAVY, base=HEAVY, axis="0 0 1", more=more)
    (finding,) = find(tmp_path, text, "INR002", targets=targets)
    assert finding.severity is severity
    assert finding.fix is not None
    assert finding.fix.title.startswith(repair)


@pytest.mark.parametrize(
    ("shape", "repair"),
    [
        (box("0 0 0"), "remove this <collision>"),
        (cylinder(0, 0), "remove this <collision>"),
        (cylinder(0.1, 0), "write the real length"),
        (box("1 1 0"), "write the real size"),
    ],
)
def test_a_shape_without_any_size_is_removed(tmp_path: Path, shape: str, repair: str) -> None:
    for finding in (found := find(tmp_path, robot(link("a", HEAVY, collision(shape))), "GEO001")):
        assert finding.fix is not None
        assert finding.fix.title.startswith(repair)
    assert found


@pytest.mark.parametrize(
    ("other", "repair"), [("1", "give parameter k another value than 0, or"), ("0", "remove this")]
)
def test_the_line_of_a_macro_that_makes_sound_shapes_is_not_removed(tmp_path: Path, other: str, repair: str) -> None:
    wheel = link("${name}", HEAVY, collision(cylinder("${0.1*k}", "${0.2*k}")))
    calls = "".join(f'<xacro:wheel name="{name}" k="{k}"/>' for name, k in (("a", "0"), ("b", other)))
    text = robot(f'<xacro:macro name="wheel" params="name k">{wheel}</xacro:macro>', calls, xacro=True)
    found = find(tmp_path, text, "GEO001", name="robot.urdf.xacro")
    assert found
    for finding in found:
        assert finding.fix is not None
        assert finding.fix.title.startswith(repair)
        assert finding.fix.title.endswith("makes that of b") == (other == "1")


@pytest.mark.parametrize(
    ("launch", "shape", "severity", "consequence"),
    [
        ("gazebo_ros launch/empty_world.launch", box("0 0 0"), Severity.WARNING, "loads it in Classic"),
        ("gazebo_ros launch/empty_world.launch", cylinder(0.1, 0), Severity.WARNING, "loads it in Classic"),
        ("gazebo_ros launch/empty_world.launch", cylinder(-0.1, 1), Severity.ERROR, ""),
        ("gazebo_ros launch/empty_world.launch; ros_gz_sim", box("0 0 0"), Severity.ERROR, "aborts"),
        ("", box("0 0 0"), Severity.ERROR, "aborts"),
    ],
)
def test_classic_alone_accepts_a_shape_without_size(
    tmp_path: Path, launch: str, shape: str, severity: Severity, consequence: str
) -> None:
    (tmp_path / "start.launch").write_text(launch)
    (finding,) = find(tmp_path, robot(link("a", HEAVY, collision(shape))), "GEO001")
    assert finding.severity is severity
    assert finding.consequences.get("gazebo", "").startswith(consequence)


@pytest.mark.parametrize(
    ("launch", "severity"),
    [
        ("gazebo_ros launch/empty_world.launch", Severity.WARNING),
        ("gazebo_ros launch/empty_world.launch; ros_gz_sim", Severity.ERROR),
        ("", Severity.ERROR),
    ],
)
def test_classic_alone_reads_no_colour(tmp_path: Path, launch: str, severity: Severity) -> None:
    (tmp_path / "start.launch").write_text(launch)
    drawn = visual(box("1 1 1")).replace("</visual>", '<material name="m"><color/></material></visual>')
    (finding,) = find(tmp_path, robot(link("a", HEAVY, drawn)), "XML005")
    assert finding.severity is severity


FREE = 'write type="continuous" if the joint turns without limits, as Bullet reads it; otherwise swap the two'


@pytest.mark.parametrize(
    ("ends", "kind", "script", "more", "severity", "repair"),
    [
        ((0, -1), "revolute", "import pybullet", "", Severity.WARNING, FREE),
        ((1, -1), "prismatic", "import pybullet", "", Severity.WARNING, "write limits that it does not reach"),
        ((1, -1), "revolute", "import pybullet", "<gazebo/>", Severity.ERROR, FREE),
        ((1, -1), "revolute", "", "", Severity.ERROR, FREE),
        ((2, -1), "revolute", "import pybullet", "", Severity.ERROR, "swap the two: lower -1, upper 2"),
    ],
)
def test_bullet_reads_lower_above_upper_as_no_limit(
    tmp_path: Path,
    ends: tuple[float, float],
    kind: str,
    script: str,
    more: str,
    severity: Severity,
    repair: str,
) -> None:
    (tmp_path / "simulate.py").write_text(script)
    arm = joint("j", "a", "b", limit(*ends, 1, 1), kind=kind, axis="0 0 1")
    (finding,) = find(tmp_path, robot(link("a"), link("b"), arm, more), "JNT005")
    assert (finding.severity, finding.message_id) == (severity, "inverted")
    assert finding.fix is not None
    assert finding.fix.title.startswith(repair)
    assert bool(finding.fix.edits) == (ends == (2, -1))


@pytest.mark.parametrize(
    ("script", "severity"),
    [
        ("import pybullet as p\np.loadURDF('ball.urdf')", Severity.WARNING),
        ("import pybullet as p\np.loadURDF('ball.urdf', flags=p.URDF_USE_INERTIA_FROM_FILE)", Severity.ERROR),
        ("import pybullet as p\np.loadURDF('other.urdf')", Severity.ERROR),
        ("import mujoco, pybullet\nload('ball.urdf')", Severity.ERROR),
        ("", Severity.ERROR),
    ],
)
def test_bullet_computes_the_inertia_of_what_collides_itself(tmp_path: Path, script: str, severity: Severity) -> None:
    (tmp_path / "run.py").write_text(script)
    shape = box("0.01 0.01 0.01")
    text = robot(link("ball", inertial(0.0013, 1), visual(shape), collision(shape)))
    (finding,) = find(tmp_path, text, "INR007", name="ball.urdf")
    assert finding.severity is severity


@pytest.mark.parametrize(
    ("spawned", "severity"),
    [("-file ball.sdf", Severity.WARNING), ("-topic robot_description", Severity.ERROR)],
)
def test_gazebo_does_not_compute_with_a_model_beside_its_own(tmp_path: Path, spawned: str, severity: Severity) -> None:
    (tmp_path / "package.xml").write_text("<package><name>p</name></package>")
    (tmp_path / "a.launch").write_text(f"<launch>gazebo_ros spawn_entity.py {spawned}; xacro ball.urdf</launch>")
    shape = box("0.01 0.01 0.01")
    text = robot(link("ball", inertial(0.0013, 1), visual(shape), collision(shape)))
    (finding,) = find(tmp_path, text, "INR007", name="ball.urdf")
    assert finding.severity is severity


@pytest.mark.parametrize("includes", [True, False])
def test_what_a_template_writes_for_other_models_too_is_not_edited(tmp_path: Path, includes: bool) -> None:
    part = link("${name}", inertial("0.013", "0.1"), visual(box("0.01 0.02 0.03")))
    macro = f'<xacro:macro name="part" params="name">{part}</xacro:macro>'
    (tmp_path / "template.xacro").write_text(robot(macro, xacro=True))
    call = '<xacro:include filename="template.xacro"/>'
    if includes:
        (tmp_path / "nut.xacro").write_text(robot(call, '<xacro:part name="nut"/>', xacro=True))
    (finding,) = find(tmp_path, robot(call, '<xacro:part name="bolt"/>', xacro=True), "INR007", name="bolt.xacro")
    assert finding.fix is not None
    assert bool(finding.fix.edits) is not includes


@pytest.mark.parametrize(
    ("script", "is_only"),
    [
        ("import pybullet as p\np.loadURDF('ball.urdf')", True),
        ("import pybullet as p\np.loadURDF('ball.urdf')\nimport pinocchio", False),
        ("import pybullet as p\np.loadURDF('other.urdf')", False),
        ("import mujoco, pybullet\nload('ball.urdf')", False),
        ("", False),
    ],
)
def test_what_only_other_programs_do_is_a_note_where_bullet_alone_loads_a_model(
    tmp_path: Path, script: str, is_only: bool
) -> None:
    (tmp_path / "run.py").write_text(script)
    shape = box("0.1 0.1 0.1")
    red = '<material name="red"><color rgba="255 0 0 1"/></material>'
    drawn = visual(shape).replace("</visual>", f"{red}</visual>")
    bodies = [link(name, inertial(1e-5, 1e-26), collision(shape)) for name in "bc"]
    idle = limit(-1, 1, 0, 0)
    joints = [joint(f"j{name}", "a", name, idle, kind="revolute", axis="0 0 1") for name in "bc"]
    text = robot(link("a", drawn), *bodies, *joints)
    found = check_text(tmp_path, text, name="ball.urdf", codes={"INR012", "JNT007", "XML013"}).findings
    expected = {
        "INR012": ("unread", Severity.INFO) if is_only else ("point", Severity.WARNING),
        "JNT007": ("effort-unused" if is_only else "both-zero", Severity.INFO),
        "XML013": ("scaled", Severity.INFO if is_only else Severity.WARNING),
    }
    assert {finding.code: (finding.message_id, finding.severity) for finding in found} == expected


@pytest.mark.parametrize(
    ("other", "severity"),
    [
        ("PATH = folder + '/ball.urdf'", Severity.INFO),
        ("from pybullet_utils import gazebo_world_parser\np.loadURDF('ball.urdf')", Severity.INFO),
        ("import mujoco\nload('cup.urdf')", Severity.INFO),
        ("import mujoco\nload('ball.urdf')", Severity.WARNING),
    ],
)
def test_only_a_file_that_names_the_model_gives_it_to_another_program(
    tmp_path: Path, other: str, severity: Severity
) -> None:
    (tmp_path / "run.py").write_text("import pybullet as p\np.loadURDF('ball.urdf')")
    (tmp_path / "other.py").write_text(other)
    text = robot('<material name="red"><color rgba="255 0 0 1"/></material>', link("a"))
    (finding,) = find(tmp_path, text, "XML013", name="ball.urdf")
    assert finding.severity is severity


TASK = "from legged_gym.envs import LeggedRobotCfg\nfile = '{LEGGED_GYM_ROOT_DIR}/robots/dog/urdf/%s'"


@pytest.mark.parametrize(
    ("files", "more", "severity"),
    [
        ({"task.py": TASK % "dog.urdf"}, "", Severity.WARNING),
        ({"task.py": TASK % "cat.urdf"}, "", Severity.WARNING),
        ({"run.py": "mujoco.load('dog.urdf')", "start.launch": "rviz cat.urdf"}, "", Severity.WARNING),
        ({"task.py": TASK % "dog.urdf"}, "<gazebo/>", Severity.ERROR),
        ({"task.py": TASK % "dog.urdf", "start.launch": "gazebo_ros dog.urdf"}, "", Severity.ERROR),
        (
            {"task.py": TASK % "dog.urdf", "robots/dog/package.xml": "<package><name>dog</name></package>"},
            "",
            Severity.ERROR,
        ),
        ({"task.py": "import isaacgym\nload('cat/urdf/cat.urdf')"}, "", Severity.ERROR),
        ({"run.py": "open('dog.urdf')"}, "", Severity.ERROR),
    ],
)
def test_simulators_with_parsers_of_their_own_move_joints_without_complete_limits(
    tmp_path: Path, files: dict[str, str], more: str, severity: Severity
) -> None:
    for name, text in ({".git/HEAD": "", "robots/dog/urdf/dog.urdf": ""} | files).items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    legs = [
        joint("hip", "trunk", "thigh", '<limit effort="9" velocity="9"/>', kind="revolute", axis="0 0 1"),
        joint("knee", "thigh", "shank", '<limit lower="-1" upper="1"/>', kind="revolute", axis="0 0 1"),
    ]
    dog = robot(*map(link, ("trunk", "thigh", "shank")), *legs, more)
    found = check_text(tmp_path, dog, name="robots/dog/urdf/dog.urdf", codes={"JNT004", "JNT007"}).findings
    assert [(finding.code, finding.severity) for finding in found] == [("JNT004", severity), ("JNT007", severity)]
