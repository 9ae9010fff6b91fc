"""What an SRDF disables, against what the model does."""

from __future__ import annotations

from pathlib import Path

import pytest
from builders import box, collision, cylinder, joint, limit, link, mesh, robot, visual
from conftest import check

from urdfcheck.core import Finding, Severity
from urdfcheck.model import Model
from urdfcheck.model.motion.moveit_pairs import (
    classify_link_pairs,
    compute_default_state,
    find_adjacent_links,
    find_moved_links,
)
from urdfcheck.source.load import load_source
from urdfcheck.source.package.finder import PackageFinder
from urdfcheck.source.ros.srdf import load_srdf

GROUP = '<group name="all"><chain base_link="base" tip_link="fore"/></group>'
NEIGHBOURS = (
    '<disable_collisions link1="base" link2="upper" reason="Adjacent"/>\n'
    '<disable_collisions link1="fore" link2="upper" reason="Adjacent"/>\n'
)


def make_box(name: str, size: str, at: str = "0 0 0") -> str:
    return link(name, collision(box(size), xyz=at) if size else "")


def make_hinge(parent: str, child: str, at: str, lower: float = 0.0, upper: float = 0.0) -> str:
    """Return a hinge about y, fixed where its range is empty."""
    if lower == upper:
        return joint(f"to_{child}", parent, child, xyz=at)
    return joint(f"to_{child}", parent, child, limit(lower, upper), kind="revolute", xyz=at, axis="0 1 0")


def make_two_bars(elbow: float = 2.9, more: str = "", fore: str = "0.3 0.05 0.05") -> str:
    """Two bars that fold in a plane; with an elbow of 2.9 rad the second can be turned into the base."""
    links = (
        make_box("base", "0.2 0.2 0.2")
        + make_box("upper", "0.3 0.05 0.05", "0.2 0 0")
        + make_box("fore", fore, "0.2 0 0")
    )
    joints = make_hinge("base", "upper", "0 0 0.2", -1.5, 1.5) + make_hinge("upper", "fore", "0.4 0 0", -elbow, elbow)
    return robot(links, joints, more, name="arm")


def find_with_srdf(folder: Path, code: str, srdf: str, urdf: str | None = None, **request: object) -> list[Finding]:
    (folder / "arm.srdf").write_text(f'<robot name="arm">\n{GROUP}\n{srdf}</robot>')
    (folder / "arm.urdf").write_text(urdf or make_two_bars())
    run = check(folder / "arm.urdf", codes={code}, **request)
    assert not run.failures
    assert not run.skipped
    return list(run.findings)


def pair(one: str, other: str, reason: str = "Never") -> str:
    return f'<disable_collisions link1="{one}" link2="{other}" reason="{reason}"/>\n'


# -- COL003: names -----------------------------------------------------------------------------------------------------


def test_a_link_that_got_another_name_is_one_finding_with_all_its_lines(tmp_path: Path) -> None:
    (finding,) = find_with_srdf(tmp_path, "COL003", NEIGHBOURS, make_two_bars().replace('"upper"', '"upper_l"'))
    assert finding.location.subject == "disable_collisions[1]@link2"
    assert "did you mean 'upper_l'" in finding.message
    assert "2 pairs" in finding.message
    assert len(finding.related) == 1


@pytest.mark.parametrize(("beside", "is_found"), [("upper_l", False), ("upper", True)])
def test_a_description_of_a_namesake_is_not_stale(tmp_path: Path, beside: str, is_found: bool) -> None:
    """Beside the one that fits the model is that of another robot of its name; one that does not fit shows nothing."""
    fitting = f'<robot name="arm">{GROUP}{NEIGHBOURS}</robot>'.replace('"upper"', f'"{beside}"')
    (tmp_path / "fitting.srdf").write_text(fitting)
    found = find_with_srdf(tmp_path, "COL003", NEIGHBOURS, make_two_bars().replace('"upper"', '"upper_l"'))
    assert bool(found) == is_found


@pytest.mark.parametrize(("package", "is_found"), [("arm", True), ("arm_description", False)])
def test_links_of_the_robot_that_a_description_was_set_up_for_are_not_missed(
    tmp_path: Path, package: str, is_found: bool
) -> None:
    """It is in another package, which is not there: the model beside the configuration is one that a controller reads."""
    source = tmp_path / "workspace" / "src"  # too deep to be in the workspace of another test
    for name in ("arm", "arm_moveit_config"):
        (source / name / "config").mkdir(parents=True)
        (source / name / "package.xml").write_text(f'<package format="3"><name>{name}</name></package>')
    (source / "arm" / "arm.urdf").write_text(make_two_bars())
    disabled = f'<robot name="arm">{GROUP}{NEIGHBOURS}{pair("palm", "upper")}{pair("base", "fore")}</robot>'
    (source / "arm_moveit_config" / "config" / "arm.srdf").write_text(disabled)
    (source / "arm_moveit_config" / ".setup_assistant").write_text(
        "moveit_setup_assistant_config:\n  SRDF: {relative_path: config/arm.srdf}\n"
        f"  URDF: {{package: {package}, relative_path: arm.urdf}}\n"
    )
    findings = check(source / "arm" / "arm.urdf", codes={"COL003"}).findings
    assert {finding.message_id for finding in findings} == ({"unknown", "never"} if is_found else set())


LOADING = """<param name="$(arg robot_description)" command="$(find xacro)/xacro '$(find arm)/"""
DESCRIPTION = (
    """<param name="$(arg robot_description)_semantic" textfile="$(find arm_moveit_config)/config/arm.srdf"/>"""
)


@pytest.mark.parametrize(
    ("loaded", "is_found"),
    [
        ("arm.urdf", True),
        ("arm.urdf.xacro", False),
        ("gone.urdf", True),
        ("$(arg robot).urdf", True),
        (f'arm.urdf.xacro\'"/>{DESCRIPTION}</group><group unless="$(arg cart)">{LOADING}arm.urdf', False),
    ],
    ids=["model", "other", "missing", "computed", "group"],
)
def test_a_description_belongs_to_the_model_that_is_loaded_with_it(tmp_path: Path, loaded: str, is_found: bool) -> None:
    """The other file is what xacro once wrote; Setup Assistant was started with the model."""
    source = tmp_path / "workspace" / "src"
    for name in ("arm", "arm_moveit_config"):
        (source / name / "config").mkdir(parents=True)
        (source / name / "package.xml").write_text(f'<package format="3"><name>{name}</name></package>')
    (source / "arm" / "arm.urdf").write_text(make_two_bars())
    (source / "arm" / "arm.urdf.xacro").write_text(make_two_bars())
    disabled = f'<robot name="arm">{GROUP}{NEIGHBOURS}{pair("palm", "upper")}{pair("base", "fore")}</robot>'
    (source / "arm_moveit_config" / "config" / "arm.srdf").write_text(disabled)
    (source / "arm_moveit_config" / "launch").mkdir()
    (source / "arm_moveit_config" / "launch" / "planning_context.launch").write_text(
        f"""<launch><arg name="robot_description" default="robot_description"/><group if="$(arg cart)">
{LOADING}{loaded}'"/>{"" if "group" in loaded else DESCRIPTION}</group></launch>"""
    )
    (source / "arm_moveit_config" / ".setup_assistant").write_text(
        "moveit_setup_assistant_config:\n  SRDF: {relative_path: config/arm.srdf}\n"
        "  URDF: {package: arm, relative_path: arm.urdf}\n"
    )
    findings = check(source / "arm" / "arm.urdf", codes={"COL003"}).findings
    assert {finding.message_id for finding in findings} == ({"unknown", "never"} if is_found else set())


def test_links_of_a_larger_variant_are_not_missed(tmp_path: Path) -> None:
    """The groups of the description name the gripper as well: this model is the arm without it."""
    hand = '<group name="hand"><link name="palm"/></group>'
    assert not find_with_srdf(tmp_path, "COL003", hand + NEIGHBOURS + pair("palm", "upper"))
    assert [f.message_id for f in find_with_srdf(tmp_path, "COL003", NEIGHBOURS + pair("palm", "upper"))] == ["unknown"]


def test_links_of_the_file_that_includes_the_model_are_not_missed(tmp_path: Path) -> None:
    """The robot of the semantic description is the arm with the camera that another file adds."""
    disabled = NEIGHBOURS + pair("camera", "upper")
    space = 'name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro"'
    (tmp_path / "arm.xacro").write_text(make_two_bars().replace('name="arm"', space, 1))
    (tmp_path / "arm.srdf").write_text(f'<robot name="arm">{GROUP}{disabled}</robot>')
    assert check(tmp_path, codes={"COL003"}).findings
    (tmp_path / "robot.urdf.xacro").write_text(
        f'<robot {space}><xacro:include filename="arm.xacro"/><link name="camera"/>{joint("eye", "fore", "camera")}</robot>'
    )
    run = check(tmp_path, codes={"COL003"})
    assert len(run.models) == 2
    assert not run.findings


def test_pairs_of_another_file_or_variant_are_not_missed(tmp_path: Path) -> None:
    """A description lacks a pair of links that it names; others may stand in the place of those that are gone."""
    urdf = make_two_bars(fore="0.6 0.05 0.05")
    for srdf, is_found in (
        (pair("base", "upper"), True),
        (pair("base", "palm"), False),
        (pair("base", "upper") + pair("base", "palm"), True),
    ):
        assert bool(find_with_srdf(tmp_path, "COL004", srdf, urdf)) == is_found


def test_a_pair_in_the_other_order_is_the_same_and_its_line_can_go(tmp_path: Path) -> None:
    (finding,) = find_with_srdf(tmp_path, "COL003", NEIGHBOURS + pair("upper", "base", "User"))
    assert (finding.message_id, finding.severity) == ("duplicate", Severity.INFO)
    assert finding.fix is not None
    (edit,) = finding.fix.edits
    assert edit.expected == pair("upper", "base", "User")
    assert edit.replacement == ""


# -- COL003: reasons ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("reason", "message", "severity"),
    [
        ("Never", "never", Severity.WARNING),
        ("Default", "default", Severity.INFO),
        ("Always", "always", Severity.INFO),
        ("Adjacent", "adjacent", Severity.INFO),
        ("User", None, None),
        ("checked by hand", None, None),
        ("", None, None),
    ],
)
def test_a_reason_that_the_model_contradicts(
    tmp_path: Path, reason: str, message: str | None, severity: Severity | None
) -> None:
    findings = find_with_srdf(tmp_path, "COL003", NEIGHBOURS + pair("base", "fore", reason))
    assert [(f.message_id, f.severity) for f in findings] == ([(message, severity)] if message else [])


@pytest.mark.parametrize(
    ("drawn", "message", "severity"),
    [("0.3 0.05 0.05", "never", Severity.WARNING), ("0.05 0.05 0.05", "enclosed", Severity.INFO)],
)
def test_a_collision_of_shapes_larger_than_what_is_drawn_is_an_info(
    tmp_path: Path, drawn: str, message: str, severity: Severity
) -> None:
    at = {"base": "0 0 0", "upper": "0.2 0 0", "fore": f"{0.05 + float(drawn.split()[0]) / 2} 0 0"}
    sizes = {"base": "0.2 0.2 0.2", "upper": "0.3 0.05 0.05", "fore": drawn}
    text = make_two_bars()
    for name, size in sizes.items():
        text = text.replace(f'<link name="{name}">', f'<link name="{name}">{visual(box(size), xyz=at[name])}', 1)
    (finding,) = find_with_srdf(tmp_path, "COL003", GROUP + NEIGHBOURS + pair("base", "fore"), text)
    assert (finding.message_id, finding.severity) == (message, severity)
    assert finding.fix is not None
    assert ("delete the line" in finding.fix.title) is (message == "never")


@pytest.mark.parametrize(
    ("fore", "words"), [("0.6 0.5 0.5", "delete the line"), ("0.9 0.6 0.6", 'write reason="User"')]
)
def test_a_pair_that_mostly_collides_may_be_disabled_on_purpose(tmp_path: Path, fore: str, words: str) -> None:
    (finding,) = find_with_srdf(tmp_path, "COL003", NEIGHBOURS + pair("base", "fore"), make_two_bars(fore=fore))
    assert finding.fix is not None
    assert finding.fix.title.startswith(words)


def test_never_is_believed_where_no_sample_collides(tmp_path: Path) -> None:
    assert not find_with_srdf(tmp_path, "COL003", NEIGHBOURS + pair("base", "fore"), make_two_bars(elbow=0.5))


@pytest.mark.parametrize(
    ("groups", "severity"),
    [
        ('<group name="hand"><joint name="to_upper"/><joint name="to_fore"/></group>', Severity.INFO),
        ('<group name="hand"><joint name="to_upper"/></group>', Severity.WARNING),
    ],
)
def test_parts_of_an_end_effector_meet_where_it_closes(tmp_path: Path, groups: str, severity: Severity) -> None:
    """The group ``all`` has both joints too: what the end effector has is of the hand."""
    hand = '<end_effector name="hand" parent_link="base" group="hand"/>'
    (finding,) = find_with_srdf(tmp_path, "COL003", groups + hand + pair("base", "fore"))
    assert (finding.message_id, finding.severity) == ("never", severity)


def test_a_collision_is_shown_with_the_joints_that_lead_to_it(tmp_path: Path) -> None:
    (finding,) = find_with_srdf(tmp_path, "COL003", NEIGHBOURS + pair("base", "fore"))
    assert finding.location.subject.startswith("disable_collisions")
    assert "to_upper = " in finding.message
    assert "to_fore = " in finding.message


def test_rarer_collisions_need_more_samples(tmp_path: Path) -> None:
    rare = make_two_bars(elbow=2.15)
    assert not find_with_srdf(tmp_path, "COL003", NEIGHBOURS + pair("base", "fore"), rare)
    assert find_with_srdf(tmp_path, "COL003", NEIGHBOURS + pair("base", "fore"), rare, samples=5000)


def test_what_is_disabled_twice_over_is_no_finding_of_its_own(tmp_path: Path) -> None:
    """A pair that collides by default would be disabled by Setup Assistant too, for another reason."""
    long = make_two_bars(elbow=0.5, fore="1.2 0.05 0.5")
    assert not find_with_srdf(tmp_path, "COL003", NEIGHBOURS + pair("base", "fore"), long)


# -- COL004 ------------------------------------------------------------------------------------------------------------

CAMERA = make_box("camera", "0.06 0.06 0.06") + make_hinge("fore", "camera", "0.3 0 0.04")


def test_an_overlap_on_one_body_is_in_every_state(tmp_path: Path) -> None:
    (finding,) = find_with_srdf(tmp_path, "COL004", NEIGHBOURS, make_two_bars(elbow=0.5, more=CAMERA))
    assert (finding.message_id, finding.severity) == ("always", Severity.WARNING)
    assert "fore and camera (15 mm)" in finding.message
    assert finding.fix is not None
    assert '<disable_collisions link1="camera" link2="fore" reason="Adjacent"/>' in finding.fix.title


@pytest.mark.parametrize(
    ("launch", "severity"),
    [
        ("", Severity.WARNING),  # the project of a planner may be elsewhere
        ('<node pkg="gait" exec="engine" args="$(find-pkg-share arm)/arm.srdf"/>', Severity.INFO),
        ('<node pkg="moveit_ros_move_group" exec="move_group" args="arm.srdf"/>', Severity.WARNING),
        ('<node pkg="gait" exec="engine" args="$(find-pkg-share arm)/arm.urdf"/>', Severity.WARNING),
        ('<param name="robot_description_semantic" textfile="$(find arm)/arm.srdf"/>', Severity.WARNING),
    ],
)
def test_pairs_of_a_description_that_no_planner_reads_are_an_info(
    tmp_path: Path, launch: str, severity: Severity
) -> None:
    (tmp_path / "package.xml").write_text('<package format="3"><name>arm</name></package>')
    (tmp_path / "launch").mkdir()
    (tmp_path / "launch" / "show.launch.xml").write_text(f"<launch>{launch}</launch>")
    (finding,) = find_with_srdf(tmp_path, "COL004", NEIGHBOURS, make_two_bars(elbow=0.5, more=CAMERA))
    assert (finding.message_id, finding.severity) == ("always", severity)


@pytest.mark.parametrize(
    "line",
    [
        pair("fore", "camera", "User"),
        '<disable_default_collisions link="camera"/>',
    ],
)
def test_disabled_in_whatever_way_is_disabled(tmp_path: Path, line: str) -> None:
    assert not find_with_srdf(tmp_path, "COL004", NEIGHBOURS + line, make_two_bars(elbow=0.5, more=CAMERA))


@pytest.mark.parametrize(("own", "is_missing"), [("true", False), ("false", True)])
def test_a_description_has_the_arguments_of_the_model(tmp_path: Path, own: str, is_missing: bool) -> None:
    """A launch file hands both one value: the default of the model counts, and not that of the description."""
    argument, ns = '<xacro:arg name="camera" default="{}"/>', ' xmlns:xacro="http://www.ros.org/wiki/xacro"'
    when = '<xacro:if value="$(arg camera)">{}</xacro:if>'
    inner = argument.format("false") + GROUP + NEIGHBOURS + when.format(pair("fore", "camera", "Always"))
    (tmp_path / "arm.srdf.xacro").write_text(f'<robot name="arm"{ns}>\n{inner}</robot>')
    model = make_two_bars(elbow=0.5, more=argument.format(own) + CAMERA).replace('name="arm"', f'name="arm"{ns}', 1)
    (tmp_path / "arm.urdf.xacro").write_text(model)
    run = check(tmp_path / "arm.urdf.xacro", codes={"COL004"})
    assert not run.failures
    assert bool(run.findings) == is_missing


def test_one_that_was_enabled_again_is_missing(tmp_path: Path) -> None:
    line = '<disable_default_collisions link="camera"/><enable_collisions link1="camera" link2="fore"/>'
    assert find_with_srdf(tmp_path, "COL004", NEIGHBOURS + line, make_two_bars(elbow=0.5, more=CAMERA))


@pytest.mark.parametrize(
    ("height", "reported"), [("0.0549", True), ("0.05499999999999", False), ("0.055", False), ("0.056", False)]
)
def test_faces_that_only_touch_are_left_alone(tmp_path: Path, height: str, reported: bool) -> None:
    camera = CAMERA.replace("0.3 0 0.04", f"0.3 0 {height}")
    assert bool(find_with_srdf(tmp_path, "COL004", NEIGHBOURS, make_two_bars(elbow=0.5, more=camera))) == reported


@pytest.mark.parametrize(("away", "found"), [("0.045", {}), ("0.044", {"COL004": "always"})])
def test_a_side_along_which_another_turns_only_touches_it(tmp_path: Path, away: str, found: dict[str, str]) -> None:
    """A cylinder turns beside a box, whose face is in its side: coal finds contact in nearly all states."""
    bodies = [make_box("base", "0.1 0.1 0.1"), make_box("upper", "0.02 0.02 0.02", "0 0 0.2")]
    bodies += [link("fore", collision(cylinder(0.03, 0.03))), make_box("camera", "0.01 0.03 0.03")]
    turning = joint("to_fore", "upper", "fore", limit(-3, 3), kind="revolute", xyz="0 0 -0.065", axis="0 0 1")
    beside = joint("to_camera", "upper", "camera", xyz=f"{away} 0 -0.065", rpy="0 1.5707963267948966 0")
    urdf = robot(*bodies, make_hinge("base", "upper", "0 0 0.3", -3, 3), turning, beside, name="arm")
    for code, line in (("COL004", ""), ("COL003", pair("fore", "camera"))):
        findings = find_with_srdf(tmp_path, code, NEIGHBOURS + pair("upper", "camera", "Adjacent") + line, urdf)
        assert [f.message_id for f in findings] == ([found[code]] if code in found else [])


def test_what_no_group_moves_is_not_checked_by_moveit(tmp_path: Path) -> None:
    battery = make_box("battery", "0.1 0.1 0.3") + make_hinge("base", "battery", "0 0 -0.2")
    assert not find_with_srdf(tmp_path, "COL004", NEIGHBOURS, make_two_bars(elbow=0.5, more=battery))


CUBE = "".join(f"v {x} {y} {z}\n" for x in (-0.1, 0.1) for y in (-0.1, 0.1) for z in (-0.1, 0.1)) + (
    "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n"
)


@pytest.mark.parametrize(("height", "is_found"), [("0", False), ("0.06", False), ("0.08", True)])
def test_what_lies_wholly_inside_a_mesh_does_not_meet_its_triangles(
    tmp_path: Path, height: str, is_found: bool
) -> None:
    (tmp_path / "cube.obj").write_text(CUBE)
    hood = link("hood", collision(mesh("cube.obj"), xyz="0.3 0 0")) + make_hinge("fore", "hood", "0 0 0")
    camera = make_box("camera", "0.06 0.06 0.06") + make_hinge("fore", "camera", f"0.3 0 {height}")
    srdf = NEIGHBOURS + '<disable_default_collisions link="fore"/>'
    assert bool(find_with_srdf(tmp_path, "COL004", srdf, make_two_bars(elbow=0.5, more=hood + camera))) == is_found


def test_a_collision_in_the_default_state_alone_is_an_info(tmp_path: Path) -> None:
    """At zero the end of the second bar is in the post; elsewhere mostly not. COL001 warns of a deep overlap."""
    deep = make_box("post", "0.05 0.05 0.05", "0.75 0 0.2") + make_hinge("base", "post", "0 0 0")
    assert not find_with_srdf(tmp_path, "COL004", NEIGHBOURS + pair("base", "fore", "User"), make_two_bars(more=deep))
    (told,) = find_with_srdf(tmp_path, "COL001", NEIGHBOURS + pair("base", "fore", "User"), make_two_bars(more=deep))
    assert told.severity is Severity.WARNING
    post = deep.replace("0.75 0 0.2", "0.774 0 0.2")
    (finding,) = find_with_srdf(tmp_path, "COL004", NEIGHBOURS + pair("base", "fore", "User"), make_two_bars(more=post))
    assert (finding.message_id, finding.severity) == ("default", Severity.INFO)
    assert "post and fore (1 mm)" in finding.message
    also = post + deep.replace('"post"', '"beam"').replace("to_post", "to_beam").replace("0.75 0 0.2", "0.7 0 0.2")
    (beside,) = find_with_srdf(tmp_path, "COL004", NEIGHBOURS + pair("base", "fore", "User"), make_two_bars(more=also))
    assert "of arm, beside 1 that COL001 reports, but" in beside.message


def test_of_two_descriptions_it_is_enough_that_one_disables_a_pair(tmp_path: Path) -> None:
    (tmp_path / "other.srdf").write_text(f'<robot name="arm">{pair("camera", "fore", "Adjacent")}</robot>')
    assert not find_with_srdf(tmp_path, "COL004", NEIGHBOURS, make_two_bars(elbow=0.5, more=CAMERA))


@pytest.mark.parametrize("code", ["COL003", "COL004"])
def test_a_robot_without_description_needs_none(tmp_path: Path, code: str) -> None:
    (tmp_path / "arm.urdf").write_text(make_two_bars(more=CAMERA))
    run = check(tmp_path / "arm.urdf", codes={code})
    assert not run.findings
    assert not run.skipped


# -- how MoveIt looks at pairs -----------------------------------------------------------------------------------------


def model(folder: Path, text: str) -> Model:
    path = folder / "arm.urdf"
    path.write_text(text)
    source = load_source(path, {}, PackageFinder(path, environment={}))
    assert source.root is not None
    return Model(source=source, robot=source.root)


def test_links_are_adjacent_across_links_without_geometry(tmp_path: Path) -> None:
    """base - flange - (tool, sensor): the flange and the adapter behind it have no collision geometry."""
    links = (
        make_box("base", "1 1 1")
        + make_box("flange", "")
        + make_box("adapter", "")
        + make_box("tool", "1 1 1")
        + make_box("sensor", "1 1 1")
    )
    joints = make_hinge("base", "flange", "0 0 0", -1, 1) + make_hinge("flange", "adapter", "0 0 0")
    joints += (
        make_hinge("adapter", "tool", "2 0 0")
        + make_hinge("flange", "sensor", "0 2 0")
        + make_hinge("tool", "tip", "2 0 0")
    )
    tree = f'<robot name="arm">{links}{make_box("tip", "1 1 1")}{joints}</robot>'
    assert {tuple(sorted(p)) for p in find_adjacent_links(model(tmp_path, tree))} == {
        ("base", "tool"),
        ("base", "sensor"),
        ("sensor", "tool"),
        ("tip", "tool"),
    }


@pytest.mark.parametrize(("lower", "upper", "value"), [(-1, 1, 0.0), (0, 2, 0.0), (-3, -1, -2.0), (1, 2, 1.5)])
def test_the_default_state_is_zero_or_the_middle_of_the_range(
    tmp_path: Path, lower: float, upper: float, value: float
) -> None:
    two = make_box("base", "1 1 1") + make_box("tip", "1 1 1") + make_hinge("base", "tip", "2 0 0", lower, upper)
    state = compute_default_state(model(tmp_path, f'<robot name="arm">{two}</robot>'))
    assert state.values.tolist() == [[value]]


def test_a_default_state_that_is_not_the_neutral_pose_is_looked_at(tmp_path: Path) -> None:
    """The bar stands up where its range begins, and lies in the post in the middle of it."""
    post = make_box("base", "0.1 0.1 0.1", "0 0 -0.3") + make_box("tip", "0.4 0.05 0.05", "0.2 0 0")
    loose = (
        make_box("root", "") + make_hinge("root", "base", "0 0 0") + make_hinge("root", "tip", "0 0 0", 0.2, 2.94159)
    )
    (found,) = classify_link_pairs(model(tmp_path, f'<robot name="arm">{loose}{post}</robot>'))
    assert found.meets_at_default
    assert not found.pair.meets_at_neutral


@pytest.mark.parametrize(
    ("group", "moved"),
    [
        ('<chain base_link="base" tip_link="fore"/>', {"upper", "fore", "camera"}),
        ('<chain base_link="upper" tip_link="fore"/>', {"fore", "camera"}),
        ('<joint name="to_fore"/>', {"fore", "camera"}),
        ('<link name="upper"/>', {"upper", "fore", "camera"}),
        ('<link name="camera"/><joint name="to_camera"/>', set()),
    ],
)
def test_a_group_moves_what_hangs_on_its_joints(tmp_path: Path, group: str, moved: set[str]) -> None:
    robot = model(tmp_path, make_two_bars(more=CAMERA))
    (tmp_path / "arm.srdf").write_text(f'<robot name="arm"><group name="g">{group}</group></robot>')
    srdf = load_srdf(tmp_path / "arm.srdf", {}, robot.source.finder, robot="arm")
    assert srdf is not None
    assert find_moved_links(robot, srdf) == moved


def test_an_overlap_that_the_srdf_disables_is_known_to_its_author(tmp_path: Path) -> None:
    disabled = '<disable_collisions link1="base" link2="fore" reason="Default"/>\n'
    for srdf, severity in ((NEIGHBOURS, Severity.WARNING), (NEIGHBOURS + disabled, Severity.INFO)):
        folder = tmp_path / severity.name
        folder.mkdir()
        urdf = make_two_bars(fore="1.2 0.3 0.3")
        (finding,) = find_with_srdf(folder, "COL001", srdf, urdf)
        assert finding.severity == severity
        assert finding.fix is not None
        assert ("add <disable_collisions>" in finding.fix.title) == (severity is Severity.WARNING)
        assert finding.consequences["moveit"].startswith("ignores") == (severity is Severity.INFO)


def test_arms_that_meet_in_some_poses_only_stay_checked(tmp_path: Path) -> None:
    arms = []
    for side, y in (("left", 0.3), ("right", -0.3)):
        bar = f'<origin xyz="0.5 {-y * 2 / 3} 0"/><geometry><box size="0.4 0.3 0.1"/></geometry>'
        arms += [
            f'<link name="{side}"><collision>{bar}</collision></link>',
            f'<joint name="{side}" type="revolute"><origin xyz="0 {y} 0"/><parent link="base"/><child link="{side}"/>',
            '<axis xyz="0 0 1"/><limit lower="-3" upper="3" effort="1" velocity="1"/></joint>',
        ]
    urdf = f'<robot name="arm"><link name="base"/>{"".join(arms)}</robot>'
    (finding,) = find_with_srdf(tmp_path, "COL001", NEIGHBOURS, urdf)
    assert finding.fix is not None
    assert finding.fix.title.startswith("start in another pose if this one is not needed (the links meet in ")


def test_the_srdf_of_the_xacro_knows_the_overlaps_of_the_urdf_made_from_it(tmp_path: Path) -> None:
    source = tmp_path / "workspace" / "src"
    config, description = source / "arm_moveit_config", source / "arm_description"
    for folder, needs in ((description, ""), (config, "<depend>arm_description</depend>")):
        (folder / "config").mkdir(parents=True)
        (folder / "package.xml").write_text(f'<package format="3"><name>{folder.name}</name>{needs}</package>')
    disabled = '<disable_collisions link1="base" link2="fore" reason="Default"/>\n'
    (config / "config" / "arm.srdf").write_text(f'<robot name="arm">\n{GROUP}\n{NEIGHBOURS}{disabled}</robot>')
    (config / ".setup_assistant").write_text(
        "moveit_setup_assistant_config:\n  srdf:\n    relative_path: config/arm.srdf\n"
        "  urdf:\n    package: arm_description\n    relative_path: arm.urdf.xacro\n"
    )
    urdf = make_two_bars(fore="1.2 0.3 0.3")
    (description / "arm.urdf").write_text(urdf)
    (description / "arm.urdf.xacro").write_text(urdf)
    (finding,) = check(description / "arm.urdf", codes={"COL001"}).findings
    assert finding.severity is Severity.INFO


def test_a_build_that_installs_a_description_gives_it_to_no_program(tmp_path: Path) -> None:
    (tmp_path / "package.xml").write_text('<package format="3"><name>arm</name></package>')
    (tmp_path / "CMakeLists.txt").write_text("install(FILES arm.srdf DESTINATION share)")
    (finding,) = find_with_srdf(tmp_path, "COL004", NEIGHBOURS, make_two_bars(elbow=0.5, more=CAMERA))
    assert finding.severity is Severity.WARNING


@pytest.mark.parametrize(("robot_name", "severity"), [("arm", Severity.INFO), ("leg", Severity.WARNING)])
def test_the_srdf_of_a_robot_knows_the_overlaps_of_a_variant_that_includes_it(
    tmp_path: Path, robot_name: str, severity: Severity
) -> None:
    source = tmp_path / "workspace" / "src"
    needs = {"arm_description": "", "arm_gazebo": "", "arm_moveit": "<depend>arm_description</depend>"}
    for name, manifest in needs.items():
        (source / name / "config").mkdir(parents=True)
        (source / name / "package.xml").write_text(f'<package format="3"><name>{name}</name>{manifest}</package>')
    disabled = '<disable_collisions link1="base" link2="fore" reason="Default"/>\n'
    srdf = f'<robot name="{robot_name}">\n{GROUP}\n{NEIGHBOURS}{disabled}</robot>'
    (source / "arm_moveit" / "config" / "arm.srdf").write_text(srdf)
    (source / "arm_description" / "arm.urdf").write_text(make_two_bars(fore="1.2 0.3 0.3"))
    variant = source / "arm_gazebo" / "arm.urdf.xacro"
    variant.write_text(
        '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="arm">'
        '<xacro:include filename="$(find arm_description)/arm.urdf"/></robot>'
    )
    (finding,) = check(variant, codes={"COL001"}).findings
    assert finding.severity is severity


@pytest.mark.parametrize("left_out", [True, False])
def test_links_that_are_disabled_with_all_others_are_left_out(tmp_path: Path, left_out: bool) -> None:
    more = "".join(make_box(f"n{i}", "0.1 0.1 0.1") + make_hinge("base", f"n{i}", f"0 {i + 2} 0") for i in range(20))
    others = ("base", "fore") if left_out else ("base",)
    pairs = "".join(pair(one, f"n{i}") for one in others for i in range(20)) + NEIGHBOURS + pair("base", "fore")
    (finding,) = find_with_srdf(tmp_path, "COL003", pairs, make_two_bars(more=more))
    assert finding.message_id == ("left-out" if left_out else "never")
