"""KIN rules: one broken tree, one finding, at its cause."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import pytest
from builders import box, find, inertial, joint, link, robot, visual
from conftest import check, check_text

from urdfcheck.core import FactUnavailableError, Run, Severity
from urdfcheck.model.parts import Joint, Link
from urdfcheck.model.tree import Tree
from urdfcheck.source.text.xml import SourceFile, parse_xml

TREE = {"KIN001", "KIN002", "KIN003", "KIN004", "KIN005", "KIN006", "KIN007", "KIN008", "XML005"}


def make_tree(links: str, *joints: str) -> str:
    """Return the links a, b, c and joints from a to b and from b to c for ``make_tree("a b c", "a b", "b c")``."""
    return robot(
        *map(link, links.split()),
        *(joint(f"j{number}", *pair.split()) + "\n" for number, pair in enumerate(joints)),
    )


MOUNT = '<joint name="mount" type="fixed"><parent link="base"/><child link="arm"/></joint>'


def codes(run: Run) -> list[str]:
    assert not run.failures
    return [f.code for f in run.findings]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (make_tree("a"), []),
        (make_tree("a b c", "a b", "a c"), []),
        (make_tree("base_link arm tool", "base_lnk arm", "arm tool"), ["KIN002"]),
        (make_tree("base arm tool", "base arm", "arm tol"), ["KIN002"]),
        (make_tree("a b camera", "a b", "b zzz"), ["KIN002"]),
        (make_tree("a b camera lidar", "a b", "b zzz"), ["KIN002", "KIN005"]),
        (make_tree("a b c", "a b", "c c"), ["KIN006"]),
        (make_tree("a b c", "a c", "b c"), ["KIN003"]),
        (make_tree("a b", "a b", "b a"), ["KIN004"]),
        (make_tree("w a b c", "w a", "a b", "b c", "c a"), ["KIN004"]),
        (make_tree("w a b", "a b", "b a"), ["KIN004"]),
        (make_tree("a b c d", "a b", "c d"), ["KIN005"]),
        (make_tree(""), ["KIN007"]),
    ],
)
def test_one_cause_one_finding(tmp_path: Path, text: str, expected: list[str]) -> None:
    assert sorted(codes(check_text(tmp_path, text, codes=TREE))) == expected


def test_joints_of_a_robot_without_links_are_not_reported_one_by_one(tmp_path: Path) -> None:
    """A list of thrusters for a plugin: that nothing can be loaded says it all."""
    text = '<robot name="thrusters"><joint name="left"><limit lower="-30" upper="30"/></joint></robot>'
    run = check_text(tmp_path, text, codes={"KIN007", "KIN009", "XML005", "JNT007"})
    assert codes(run) == ["KIN007"]
    assert run.findings[0].data["hides"] == ["JNT007", "KIN009", "XML005"]


@pytest.mark.parametrize(
    ("text", "urdfdom"),
    [
        (make_tree("a b c", "a b", "c c"), "drops the link without a message"),
        (make_tree("a b", "a b", "b b"), "loads it with the link as its own child"),
        (make_tree("w a b", "a b", "b a"), "drops the loop without a message"),
        (make_tree("w a b", "w a", "a b", "b a"), "loads it with links that are their own ancestors"),
        (make_tree("a b", "a b", "b a"), "refuses the file: no root link found"),
    ],
)
def test_a_loop_is_lost_only_if_the_tree_does_not_lead_into_it(tmp_path: Path, text: str, urdfdom: str) -> None:
    (finding,) = check_text(tmp_path, text, codes={"KIN004", "KIN006"}).findings
    assert finding.consequences["urdfdom"] == urdfdom
    assert ("pinocchio" in finding.consequences) == urdfdom.startswith("loads")


@pytest.mark.parametrize(
    ("root", "links", "named", "repair"),
    [
        ('<robot name="r"', "camera", "base", "include camera.xacro from the robot that has base;"),
        (
            '<robot name="r"',
            "camera",
            "trunk",
            "no other robot file here names base: hand the file to a robot that has base,",
        ),
        (
            '<robot name="r"',
            "camera table",
            "base",
            "car.urdf, which has base, completes this one, include both from one robot; otherwise name an existing link,",
        ),
        (
            '<robot name="r"',
            "camera table",
            "table",
            'name an existing link, or add `<link name="base"/>` and the joint',
        ),
        ("<robot", "camera table", "base", "include camera.xacro from the robot that has base;"),
    ],
)
def test_a_part_is_to_be_included_and_a_robot_keeps_one_root(
    tmp_path: Path, root: str, links: str, named: str, repair: str
) -> None:
    (tmp_path / "car.urdf").write_text(f'<robot name="car"><link name="{named}"/></robot>')
    text = make_tree(links, "base camera").replace(
        '<robot name="r"', f'{root} xmlns:xacro="http://www.ros.org/wiki/xacro"'
    )
    (finding,) = check_text(tmp_path, text, codes={"KIN002"}, name="camera.xacro").findings
    assert finding.fix is not None
    assert repair in finding.fix.title


@pytest.mark.parametrize(
    ("package", "given", "repair"),
    [
        ("lidar", "all", "which includes this file and has base; to load this one alone, include it from a xacro file"),
        ("lidar", "lidar", "no other robot file here names base:"),  # the car is out of reach
        # The car includes another file of the same name.
        ("sonar", "all", "include lidar.urdf from the robot that has base;"),
    ],
)
def test_a_file_that_a_robot_with_the_link_includes_is_not_to_have_it_too(
    tmp_path: Path, package: str, given: str, repair: str
) -> None:
    xacro = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
    sensors = f'<robot {xacro}><xacro:include filename="$(find {package})/urdf/lidar.urdf"/></robot>'
    files = {
        "car/package.xml": "<package><name>car</name></package>",
        "car/urdf/car.urdf.xacro": f'<robot name="car" {xacro}><xacro:include filename="base.xacro"/>'
        '<xacro:include filename="sensors.xacro"/></robot>',
        "car/urdf/base.xacro": '<robot><link name="base"/></robot>',
        "car/urdf/sensors.xacro": sensors,
    }
    for name in ("lidar", "sonar"):
        files[f"{name}/package.xml"] = f"<package><name>{name}</name></package>"
        files[f"{name}/display.launch"] = (
            f'<launch><param name="robot_description" textfile="$(find {name})/urdf/lidar.urdf"/></launch>'
        )
        files[f"{name}/urdf/lidar.urdf"] = make_tree("eye", "base eye").replace('name="r"', f'name="{name}"')
    for name, text in files.items():
        path = tmp_path / "all" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    start = tmp_path / "all" / ("lidar/urdf/lidar.urdf" if given == "lidar" else "")
    run = check(start, codes={"KIN002"})
    found = [f for f in run.findings if f.location.span and f.location.span.file.endswith("lidar/urdf/lidar.urdf")]
    assert [repair in f.fix.title for f in found if f.fix is not None] == [True]


@pytest.mark.parametrize(
    ("parent", "package", "drake", "severity"),
    [
        ("world", "", "loads it", Severity.WARNING),  # it may be for Drake alone
        ("world", "<package><name>p</name></package>", "loads it", Severity.ERROR),
        ("wrld", "", "refuses the file", Severity.ERROR),
    ],
)
def test_drake_needs_no_link_for_its_world_body(
    tmp_path: Path, parent: str, package: str, drake: str, severity: Severity
) -> None:
    if package:
        (tmp_path / "package.xml").write_text(package, encoding="utf-8")
    (finding,) = check_text(tmp_path, make_tree("pallet", f"{parent} pallet"), codes={"KIN002"}).findings
    assert finding.severity is severity
    assert finding.consequences["drake"].startswith(drake)
    assert finding.consequences["mujoco"] == "refuses the file"


def test_a_robot_whose_world_is_in_the_file_that_includes_it_gets_no_second_one(tmp_path: Path) -> None:
    arm = tmp_path / "arm.urdf.xacro"
    arm.write_text(robot(link("a"), joint("j", "world", "a", kind="fixed"), xacro=True), encoding="utf-8")
    cell = robot(link("world"), '<xacro:include filename="arm.urdf.xacro"/>', xacro=True)
    (tmp_path / "cell.urdf.xacro").write_text(cell, encoding="utf-8")
    (finding,) = check(arm, codes={"KIN002"}).findings
    assert finding.severity is Severity.ERROR
    assert finding.fix is not None
    assert "cell.urdf.xacro, which includes this file and has world" in finding.fix.title


@pytest.mark.parametrize(
    ("joints", "repair"),
    [
        (("a shin",), "rename one of them, or delete it if it is a copy"),
        (
            ("a shin", "b shin"),
            "rename one of them, and the child of the joint that holds it: j0 or j1; a copy, delete with its joint",
        ),
    ],
)
def test_another_name_for_a_link_is_written_in_its_joint_too(
    tmp_path: Path, joints: tuple[str, ...], repair: str
) -> None:
    (finding,) = check_text(tmp_path, make_tree("a b shin shin", *joints), codes={"KIN001"}).findings
    assert finding.fix is not None
    assert finding.fix.title == repair


def test_a_copied_joint_is_a_duplicate_and_not_a_second_parent(tmp_path: Path) -> None:
    joint = '<joint name="j" type="fixed"><parent link="a"/><child link="b"/></joint>'
    text = f'<robot name="r"><link name="a"/><link name="b"/>{joint}\n{joint}</robot>'
    assert codes(check_text(tmp_path, text, codes=TREE)) == ["KIN001"]


def test_a_copied_joint_names_the_link_that_it_was_meant_for(tmp_path: Path) -> None:
    joint = '<joint name="j" type="fixed"><parent link="a"/><child link="b"/></joint>'
    text = f'<robot name="r"><link name="a"/><link name="b"/>{joint}<link name="c"/>{joint}</robot>'
    (finding,) = check_text(tmp_path, text, codes=TREE).findings
    assert (finding.code, finding.message_id) == ("KIN001", "copied")
    assert finding.fix is not None
    assert finding.fix.title.endswith("(perhaps c, which has no joint)")
    twice = text.replace('<link name="c"/>', '<link name="b"/>')
    assert {f.message_id for f in check_text(tmp_path, twice, codes={"KIN001"}).findings} == {"repeated"}


def test_a_fixed_joint_may_share_the_name_of_a_link(tmp_path: Path) -> None:
    text = (
        '<robot name="r"><link name="a"/><link name="b"/>'
        '<joint name="b" type="{}"><parent link="a"/><child link="b"/></joint></robot>'
    )
    assert codes(check_text(tmp_path, text.format("fixed"), codes=TREE)) == []
    assert codes(check_text(tmp_path, text.format("continuous"), codes=TREE)) == ["KIN001"]


@pytest.mark.parametrize(
    ("unknown", "near"),
    [
        ("base_lnk", "base_link"),
        ("base", "base_link"),
        ("baselink", "base_link"),
        ("weel_4", "wheel_4"),
        ("wheel_5", None),
        ("right_arm", None),
        ("lower_leg", None),
        ("camera", None),
    ],
)
def test_proposes_a_name_only_where_it_is_a_misspelling(tmp_path: Path, unknown: str, near: str | None) -> None:
    links = "base_link wheel_1 wheel_4 left_arm upper_leg"
    joints = [f"base_link {link}" for link in links.split()[1:]]
    text = make_tree(f"{links} horn", f"{unknown} horn", *joints)
    finding = next(f for f in check_text(tmp_path, text, codes={"KIN002"}).findings)
    assert finding.data.get("near") == near
    assert finding.fix is not None
    assert [e.replacement for e in finding.fix.edits] == ([near] if near else [])


@pytest.mark.parametrize("joint", ["base_lnk base", "tool base_lnk"])
def test_proposes_no_name_with_which_the_joint_closes_a_loop(tmp_path: Path, joint: str) -> None:
    text = make_tree("world base base_link tool", joint, "base base_link", "base_link tool")
    finding = next(f for f in check_text(tmp_path, text, codes={"KIN002"}).findings)
    assert finding.message_id == "unknown"


def test_a_name_that_a_call_hands_over_may_make_other_names_too(tmp_path: Path) -> None:
    macro = """<xacro:macro name="arm" params="name"><link name="${name}_link"/><joint name="j" type="fixed">
<parent link="${name}"/><child link="hand"/></joint></xacro:macro><xacro:arm name="base"/><link name="hand"/>"""
    text = f'<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">{macro}</robot>'
    (finding,) = check_text(tmp_path, text, codes={"KIN002"}, name="r.urdf.xacro").findings
    assert (finding.message_id, finding.fix is not None and finding.fix.edits) == ("near", ())


def test_a_child_means_first_a_link_that_still_has_no_parent(tmp_path: Path) -> None:
    text = make_tree("base wheel_left weel_left_2 a", "base wheel_left", "base weel_left_3x", "base a")
    assert not check_text(tmp_path, text, codes={"KIN002"}).failures
    (finding,) = check_text(tmp_path, make_tree("b arm arms", "b arm", "arm armz"), codes={"KIN002"}).findings
    assert finding.data["near"] == "arms"


def test_a_name_whose_correction_renames_the_link_too_is_not_proposed(tmp_path: Path) -> None:
    text = """<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:property name="body" value="base"/>
<link name="${body}_link"/><link name="arm"/>
<joint name="mount" type="fixed"><parent link="${body}"/><child link="arm"/></joint></robot>"""
    (finding,) = check_text(tmp_path, text, "robot.urdf.xacro", codes={"KIN002"}).findings
    assert finding.message_id == "unknown"
    assert finding.fix is not None
    assert "base_link" not in finding.fix.title


def test_a_missing_link_is_one_finding_however_many_joints_name_it(tmp_path: Path) -> None:
    text = make_tree("a b c", "torso a", "torso b", "torso c")
    (finding,) = check_text(tmp_path, text, codes=TREE).findings
    assert (finding.code, len(finding.subjects)) == ("KIN002", 3)


def test_the_loop_is_told_link_by_link(tmp_path: Path) -> None:
    (finding,) = check_text(tmp_path, make_tree("w a b c", "w a", "a b", "b c", "c a"), codes=TREE).findings
    assert finding.data["loop"] == "a → b → c → a"
    assert finding.location.subject == "joint[j3]/child@link"


def test_pieces_are_listed_the_largest_first(tmp_path: Path) -> None:
    (finding,) = check_text(tmp_path, make_tree("x a b c d", "a b", "b c"), codes=TREE).findings
    assert finding.data["roots"] == ["a", "x", "d"]
    assert finding.data["main"] == "a (3 links)"


@pytest.mark.slow
def test_a_chain_of_two_thousand_links(tmp_path: Path) -> None:
    count = 2000
    joints = [f"l{i} l{i + 1}" for i in range(count - 1)]
    text = make_tree(" ".join(f"l{i}" for i in range(count)), *joints, f"l{count - 1} l0")
    assert codes(check_text(tmp_path, text, codes={"KIN003", "KIN004", "KIN005"})) == ["KIN004"]


@pytest.mark.parametrize(
    ("links", "joints", "repair"),
    [
        ("base arm world", ["base arm"], "from world to base, or delete unused links"),
        ("base_footprint base arm", ["base arm"], "from base_footprint to base, or delete unused links"),
        ("base arm camera", ["base arm"], "add the joints that are missing, often fixed ones, or delete unused links"),
    ],
)
def test_a_link_for_the_ground_is_the_parent_of_the_missing_joint(
    tmp_path: Path, links: str, joints: list[str], repair: str
) -> None:
    (finding,) = check_text(tmp_path, make_tree(links, *joints), codes={"KIN005"}).findings
    assert finding.fix is not None
    assert finding.fix.title.endswith(repair)


def test_a_link_of_an_included_file_is_not_to_be_deleted(tmp_path: Path) -> None:
    head = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">'
    (tmp_path / "parts.xacro").write_text(f'{head}<link name="world"/></robot>', encoding="utf-8")
    text = f'{head}<xacro:include filename="parts.xacro"/><link name="base"/></robot>'
    (finding,) = check_text(tmp_path, text, codes={"KIN005"}).findings
    assert finding.fix is not None
    assert finding.fix.title == "add a joint, often a fixed one, from world to base, in the model's own file"
    assert f" in {Path(finding.model).name}; a URDF has" in finding.message


def test_xacro_that_nothing_expanded_says_nothing_about_the_tree(tmp_path: Path) -> None:
    text = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:arm/><link name="a"/><link name="b"/></robot>'
    run = check_text(tmp_path, text, codes=TREE)
    assert codes(run) == ["XAC001"]  # why there is no tree, whatever is selected
    assert {s.code for s in run.skipped} >= {"KIN002", "KIN005", "KIN007"}


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ('<robot name="r"><link name=""/><link name="b"/></robot>', "NAM001"),
        ('<robot name="r"><link/><link name="b"/></robot>', "XML005"),
        ('<robot name="r"><link name="b"/><joint name="j" type="fixed"><child link="b"/></joint></robot>', "XML005"),
        (make_tree("a b", "zzz b"), "KIN002"),
        (make_tree("a b", "a b", "b b"), "KIN006"),
        (make_tree("a b c", "a c", "b c"), "KIN003"),
        (make_tree("w a b c", "w a", "a b", "b c", "c a"), "KIN004"),
        (make_tree("w v a b", "w a", "v a", "a b", "b a"), "KIN003"),
        (make_tree("a b", "a b", "b a"), "KIN004"),
        (make_tree("a b"), "KIN005"),
        (make_tree(""), "KIN007"),
    ],
)
def test_a_check_that_needs_the_tree_names_the_finding_that_was_made(tmp_path: Path, text: str, code: str) -> None:
    assert code in codes(check_text(tmp_path, text, codes={*TREE, "NAM001"}))
    root = parse_xml(SourceFile(tmp_path, "robot.urdf", text=text))
    with pytest.raises(FactUnavailableError, match=code):
        Tree.build([Link(e) for e in root.find_children("link")], [Joint(e) for e in root.find_children("joint")])


@pytest.mark.parametrize(
    ("joints", "where"),
    [
        (["zzz a"], "the parent of joint j0"),
        (["zzz a", "zzz b"], "the parent of joints j0 and j1"),
        (["zzz a", "zzz b", "zzz c"], "the parent of joints j0, j1 and j2"),
        (["zzz a", "zzz b", "zzz c", "zzz d", "zzz e"], "the parent of joints j0, j1, j2 and 2 more"),
        (["a zzz", "zzz b"], "the child of joint j0 and the parent of joint j1"),
    ],
)
def test_joints_of_a_missing_link_are_counted_up(tmp_path: Path, joints: list[str], where: str) -> None:
    (finding,) = check_text(tmp_path, make_tree("a b c d e", *joints), codes={"KIN002"}).findings
    assert finding.data["where"] == where


def test_one_shared_name_is_told_in_the_singular(tmp_path: Path) -> None:
    joint = '<joint name="b" type="continuous"><parent link="a"/><child link="b"/></joint>'
    (finding,) = check_text(
        tmp_path, f'<robot name="r"><link name="a"/><link name="b"/>{joint}</robot>', codes=TREE
    ).findings
    assert finding.message.startswith("a link and a joint share the name b;")


class TestKIN008:
    INERTIAL = '<inertial><mass value="{}"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'

    def model(self, mass: str) -> str:
        return (
            f'<robot name="r"><link name="a">{self.INERTIAL.format(mass)}</link><link name="b"/>'
            '<joint name="j" type="fixed"><parent link="a"/><child link="b"/></joint></robot>'
        )

    def test_root_with_mass(self, tmp_path: Path) -> None:
        assert codes(check_text(tmp_path, self.model("1"), codes={"KIN008"})) == ["KIN008"]

    def test_what_is_fixed_to_the_root_is_lost_with_it(self, tmp_path: Path) -> None:
        """As Pinocchio and MuJoCo count."""
        text = robot(
            link("base", inertial(5, 0.1)),
            link("mount", inertial(2, 0.1)),
            link("arm", inertial(1, 0.1)),
            joint("f", "base", "mount", kind="fixed", xyz="0 0 1"),
            joint("j", "mount", "arm", kind="continuous"),
        )
        (finding,) = check_text(tmp_path, text, codes={"KIN008"}).findings
        assert finding.message.endswith("count 1 kg: mount, fixed to it, is lost too")
        pinocchio = pytest.importorskip("pinocchio")
        model = pinocchio.buildModelFromUrdf(str(tmp_path / "robot.urdf"))
        assert pinocchio.computeTotalMass(model) == pytest.approx(finding.data["moving"])
        mujoco = pytest.importorskip("mujoco")
        assert mujoco.MjModel.from_xml_path(str(tmp_path / "robot.urdf")).body_mass.sum() == pytest.approx(1)

    def test_massless_or_malformed_root(self, tmp_path: Path) -> None:
        assert codes(check_text(tmp_path, self.model("0"), codes={"KIN008"})) == []
        assert codes(check_text(tmp_path, self.model("x"), codes={"KIN008"})) == []

    def test_says_no_sum_that_counts_a_wrong_mass(self, tmp_path: Path) -> None:
        assert codes(check_text(tmp_path, self.model("-1"), codes={"KIN008"})) == []
        wrong = self.model("1").replace('<link name="b"/>', f'<link name="b">{self.INERTIAL.format("-3")}</link>')
        assert codes(check_text(tmp_path, wrong, codes={"KIN008"})) == []

    def test_abstains_without_a_tree(self, tmp_path: Path) -> None:
        run = check_text(tmp_path, make_tree("a b"), codes={"KIN008"})
        assert codes(run) == []
        run = check_text(tmp_path, make_tree("a b c", "a b"), codes={"KIN008"})
        assert [s.code for s in run.skipped] == ["KIN008"]


MASS = '<inertial><mass value="{}"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'


def typed(attribute: str) -> str:
    joint = f'<joint name="j" {attribute}><parent link="a"/><child link="b"/></joint>'
    return f'<robot name="r"><link name="a"/><link name="b"/>{joint}</robot>'


@pytest.mark.parametrize(
    ("attribute", "message", "written"),
    [
        ('type="Revolute"', "misspelt", "revolute"),
        ('type="contineous"', "misspelt", "continuous"),
        ('type="hinge"', "misspelt", "revolute"),
        ('type="fixed "', "misspelt", "fixed"),
        ('type="ball"', "sdf", None),
        ('type="spherical"', "spherical", None),
        ('type="wobbly"', "unknown", None),
        ('type=""', "unknown", None),
        ("", "missing", None),
    ],
)
def test_a_type_that_there_is_not(tmp_path: Path, attribute: str, message: str, written: str | None) -> None:
    (finding,) = check_text(tmp_path, typed(attribute), codes={"KIN009"}).findings
    assert (finding.message_id, finding.severity) == (message, Severity.ERROR)
    assert finding.fix is not None
    assert [edit.replacement for edit in finding.fix.edits] == ([written] if written else [])


@pytest.mark.parametrize(
    ("script", "severity"),
    [
        ("pybullet.loadURDF('robot.urdf')", Severity.WARNING),
        ("pybullet.loadURDF('robot.urdf'); import mujoco", Severity.ERROR),
        ("pybullet.loadURDF('other.urdf')", Severity.ERROR),
    ],
)
def test_bullet_has_one_more_type(tmp_path: Path, script: str, severity: Severity) -> None:
    (tmp_path / "run.py").write_text(script)
    (finding,) = check_text(tmp_path, typed('type="spherical"'), codes={"KIN009"}).findings
    assert (finding.message_id, finding.severity) == ("spherical", severity)
    assert finding.consequences["bullet"] == "loads it"


def test_a_misspelt_attribute_is_not_a_missing_type(tmp_path: Path) -> None:
    run = check_text(tmp_path, typed('tpye="fixed"'), codes={"KIN009", "XML004", "XML005"})
    assert codes(run) == ["XML004"]
    assert run.findings[0].severity == Severity.ERROR


@pytest.mark.parametrize(
    ("target", "kind", "severity"),
    [
        ((), "floating", Severity.INFO),
        (("mujoco",), "floating", Severity.INFO),
        (("gazebo",), "floating", Severity.ERROR),
        (("bullet",), "floating", Severity.WARNING),
        (("bullet",), "planar", Severity.INFO),
        (("kdl",), "planar", Severity.WARNING),
    ],
)
def test_a_joint_that_a_target_loses(tmp_path: Path, target: tuple[str, ...], kind: str, severity: Severity) -> None:
    (finding,) = check_text(tmp_path, typed(f'type="{kind}"'), codes={"KIN009"}, targets=target).findings
    assert (finding.message_id, finding.severity) == (kind, severity)


def moving(root: str, base: str, extra: str = "", kind: str = "continuous") -> str:
    """A root link with this inertial, and ``base`` on a joint of this kind."""
    joint = f'<joint name="j" type="{kind}"><parent link="{root}"/><child link="arm"/></joint>'
    return f'<robot name="r"><link name="{root}">{base}</link><link name="arm">{MASS.format(1)}</link>{joint}{extra}</robot>'


PRESERVED = '<gazebo reference="j"><{}>{}</{}></gazebo>'


@pytest.mark.parametrize(
    ("text", "vanishes"),
    [
        (moving("base", ""), True),
        (moving("base", MASS.format("0").replace('="1"', '="0"')), True),
        (moving("base", MASS.format("0")), False),  # INR002
        (moving("base", MASS.format("-1")), False),  # INR002
        (moving("base", MASS.format("1e-9")), True),
        (moving("base", MASS.format("1e-3")), False),
        (moving("base", MASS.format("a")), False),
        (moving("base", "", kind="fixed"), False),
        (moving("base", "", PRESERVED.format(*["preserveFixedJoint", "true", "preserveFixedJoint"]), "fixed"), True),
        (moving("base", "", PRESERVED.format(*["preserveFixedJoint", "false", "preserveFixedJoint"]), "fixed"), False),
        (moving("world", ""), False),
    ],
)
def test_a_root_without_mass_takes_the_whole_model_with_it(tmp_path: Path, text: str, vanishes: bool) -> None:
    assert codes(check_text(tmp_path, text, codes={"KIN010"})) == (["KIN010"] if vanishes else [])


@pytest.mark.parametrize(
    ("launch", "severity"),
    [
        ("<launch>gazebo_ros $(find p)/urdf/other.urdf</launch>", Severity.INFO),
        ("<launch>gazebo_ros $(find p)/urdf/r.urdf.xacro $(find p)/urdf/other.urdf</launch>", Severity.WARNING),
        (
            "<launch>gazebo_ros other.urdf <param name='robot_description' textfile='r.urdf'/></launch>",
            Severity.WARNING,
        ),
        ("<launch>gazebo_ros r.urdf robot_description -entity r -file model.sdf</launch>", Severity.INFO),
        ("<launch>gazebo_ros r.urdf -file box.sdf; -topic robot_description</launch>", Severity.WARNING),
        ("<launch>gazebo_ros</launch>", Severity.WARNING),
        ("<launch>rviz other.urdf</launch>", Severity.INFO),
        ("<launch>rviz r.urdf</launch>", Severity.INFO),
        ("use_gazebo: false", Severity.INFO),  # a setting of MoveIt Servo
    ],
)
def test_a_robot_that_nothing_gives_to_gazebo_may_vanish_there(tmp_path: Path, launch: str, severity: Severity) -> None:
    for name, text in (("package.xml", "<package><name>p</name></package>"), ("sim.launch", launch)):
        (tmp_path / name).write_text(text)
    (finding,) = check_text(tmp_path, moving("base", ""), codes={"KIN010"}, name="r.urdf").findings
    assert finding.severity is severity


def test_a_model_that_is_only_drawn_is_reported_once(tmp_path: Path) -> None:
    """Every mass is 0: the error about the drawn link that moves says that Gazebo drops it."""
    nothing, shape = inertial(0, 0), visual(box("1 1 1"))
    frame = link("frame", nothing) + joint("k", "arm", "frame", kind="continuous")
    arm = joint("j", "base", "arm", kind="continuous")
    parts = [link("base", nothing, shape), link("arm", nothing, shape), arm, frame]
    rules = {"GEO002", "INR002", "KIN010"}
    found = check_text(tmp_path, robot(*parts), codes=rules).findings
    assert [(f.code, f.message_id, f.severity) for f in found if f.severity > Severity.INFO] == [
        ("INR002", "zero", Severity.ERROR)
    ]
    (error,) = (f for f in found if f.message_id == "zero")
    assert "drops the link" in error.consequences["gazebo"]
    parts[1] = link("arm", nothing)
    assert "KIN010" in codes(check_text(tmp_path, robot(*parts), codes=rules))
    parts[1] = link("arm", inertial(1, 1), shape)
    assert set(codes(check_text(tmp_path, robot(*parts), codes=rules))) >= {"GEO002", "INR002", "KIN010"}


@pytest.mark.parametrize(("heavy", "message"), [(1, "drawing"), (2, "vanishes")])
def test_a_root_and_most_bodies_without_inertial_are_a_drawing(tmp_path: Path, heavy: int, message: str) -> None:
    """INR001 reports the links; the missing mass of the root is not another defect."""
    names = ["base", *"abcde"]
    parts = [link(name, inertial(1, 1) if 0 < i <= heavy else "", visual(box("1 1 1"))) for i, name in enumerate(names)]
    parts += [joint(f"j{i}", one, two, kind="continuous") for i, (one, two) in enumerate(pairwise(names))]
    (finding,) = check_text(tmp_path, robot(*parts), codes={"KIN010"}).findings
    assert (finding.message_id, finding.severity > Severity.INFO) == (message, message == "vanishes")


def test_a_model_of_one_link_has_no_joint_to_move(tmp_path: Path) -> None:
    one = '<robot name="plane"><link name="plane"><inertial><mass value="0"/></inertial></link></robot>'
    (finding,) = check_text(tmp_path, one, codes={"KIN010"}).findings
    assert finding.fix is not None
    assert "to a link that has one; nothing if the model is for Bullet only" in finding.fix.title
    assert finding.severity is Severity.INFO, "Bullet's own ground is such a file"
    assert "fixed to the world" in finding.consequences["bullet"]
    (tiny,) = check_text(tmp_path, one.replace('value="0"', 'value="1e-9"'), codes={"KIN010"}).findings
    assert (tiny.message_id, tiny.severity) == ("tiny", Severity.WARNING)
    assert "fixed to the world" not in tiny.consequences.get("bullet", "")


@pytest.mark.parametrize(
    ("kind", "severity"), [("fixed", Severity.INFO), ("continuous", Severity.WARNING)], ids=["pillars", "robot"]
)
def test_what_stands_on_the_ground_of_bullet_has_the_mass_0_too(tmp_path: Path, kind: str, severity: Severity) -> None:
    still = inertial(0, 0)
    top = link("top", still if kind == "fixed" else inertial(1, 0.1))
    text = robot(link("pillar", still), top, joint("j", "pillar", "top", kind=kind))
    (finding,) = check_text(tmp_path, text, codes={"KIN010"}).findings
    assert (finding.message_id, finding.severity) == ("vanishes", severity)


def test_massless_links_that_would_be_dropped_next_need_a_mass_too(tmp_path: Path) -> None:
    names = ["map", "x", "yaw", "pelvis", "eye"]
    parts = [link(name, inertial(*((9, 1) if name == "pelvis" else (0, 0)))) for name in names]
    parts += [joint(f"j{i}", one, two, kind="continuous") for i, (one, two) in enumerate(pairwise(names))]
    (finding,) = check_text(tmp_path, robot(*parts), codes={"KIN010"}).findings
    assert finding.fix is not None
    start = "give map (and x, yaw below it, which would be dropped next) a mass and moments of inertia, or"
    assert finding.fix.title.startswith(start)


def test_an_empty_model_is_an_error_where_gazebo_is_the_target(tmp_path: Path) -> None:
    (finding,) = check_text(tmp_path, moving("base", ""), codes={"KIN010"}, targets=("gazebo",)).findings
    assert finding.severity == Severity.ERROR


def test_a_description_without_any_inertial_is_told_once(tmp_path: Path) -> None:
    moving_parts = make_tree("a b", "a b").replace("fixed", "continuous")
    assert codes(check_text(tmp_path, moving_parts, codes={"KIN010", "INR001"})) == ["INR001"]
    (finding,) = check_text(tmp_path, make_tree("a b", "a b"), codes={"KIN010", "INR001"}).findings
    assert (finding.code, finding.severity) == ("KIN010", Severity.INFO)


def test_a_loop_through_a_name_that_two_links_share_is_left_to_that_mistake(tmp_path: Path) -> None:
    ring = make_tree("a b", "a b", "b a")
    twice = make_tree("a b a", "a b", "b a")
    assert codes(check_text(tmp_path, ring, codes={"KIN001", "KIN004"})) == ["KIN004"]
    assert codes(check_text(tmp_path, twice, codes={"KIN001", "KIN004"})) == ["KIN001"]
    assert codes(check_text(tmp_path, twice, codes={"KIN004"})) == ["KIN004"]


def test_a_child_named_after_a_part_means_the_link_below_it_that_has_no_parent(tmp_path: Path) -> None:
    parts = (link("base"), link("wheel/body"), link("wheel/hub"), joint("mount", "base", "wheel"))
    one = robot(*parts, joint("turn", "wheel/body", "wheel/hub", kind="continuous"))
    (finding,) = check_text(tmp_path, one, codes={"KIN002"}).findings
    assert (finding.message_id, finding.data["near"]) == ("near", "wheel/body")
    (open_question,) = check_text(tmp_path, robot(*parts), codes={"KIN002"}).findings
    assert open_question.message_id == "unknown"


@pytest.mark.parametrize(
    ("first", "second", "meant"),
    [
        ("imu_joint", "camera_joint", "imu_link"),
        ("camera_joint", "imu_joint", "imu_link"),
        ("top_to_imu", "camera_joint", None),
        ("imu_joint", "imu", None),  # both have its name
    ],
)
def test_joint_with_the_child_of_another_is_one_slip(
    tmp_path: Path, first: str, second: str, meant: str | None
) -> None:
    text = robot(
        *map(link, ("top", "imu_link", "camera_link")),
        joint(first, "top", "camera_link"),
        joint(second, "top", "camera_link"),
    )
    run = check_text(tmp_path, text, codes=TREE)
    if meant is None:
        assert sorted(codes(run)) == ["KIN003", "KIN005"]
        return
    assert codes(run) == ["KIN003"]
    (finding,) = run.findings
    assert finding.message_id == "slip"
    assert finding.fix is not None
    (edit,) = finding.fix.edits
    fixed = text[: edit.span.start] + edit.replacement + text[edit.span.end :]
    assert not check_text(tmp_path, fixed, codes=TREE).findings


@pytest.mark.parametrize(
    ("text", "message", "repair"),
    [
        (
            make_tree("tile table base arm world", "tile table", "table base", "base arm", "world base"),
            "roots",
            "`tile`",
        ),
        (make_tree("world tile table base", "world base", "tile table", "table base"), "roots", "`tile`"),
        (make_tree("a b c", "a c", "b c"), "roots", "keep one"),  # either root may be the robot's
        (make_tree("a b c d e", "a b", "b c", "d e", "e c"), "roots", "keep one"),
        (make_tree("base crank rod", "base crank", "crank rod", "base rod"), "several", "real loop"),
        (
            make_tree("base arm", "base arm").replace("</robot>", MOUNT + "</robot>"),
            "repeated",
            "delete all of these joints but one",
        ),
    ],
)
def test_a_link_below_two_roots_is_told_from_a_linkage(tmp_path: Path, text: str, message: str, repair: str) -> None:
    (finding,) = check_text(tmp_path, text, codes=TREE).findings
    assert (finding.code, finding.message_id) == ("KIN003", message)
    assert finding.fix is not None
    assert repair in finding.fix.title
    assert finding.consequences["urdfdom"].startswith("refuses" if message == "roots" else "places")


def test_slip_in_a_robot_of_more_pieces_leaves_them_to_be_told(tmp_path: Path) -> None:
    text = robot(
        *map(link, ("top", "imu_link", "camera_link", "lost")),
        joint("imu_joint", "top", "camera_link"),
        joint("camera_joint", "top", "camera_link"),
    )
    assert sorted(codes(check_text(tmp_path, text, codes=TREE))) == ["KIN003", "KIN005"]


LOCAL = {"INR004", "INR005", "INR006", "INR007", "INR010", "INR012"}
BOX = visual(box("0.1 0.1 0.3"))
DEFECTS = (
    link("rod", inertial(mass=1, ixx=0.01, iyy=0.01, izz=0), BOX),
    link("spread", inertial(mass=1.37, ixx=0.0913, iyy=0.0874, izz=0.0415), BOX),
    link("outside", inertial(com="0 0 0.4", mass=1, ixx=0.008, iyy=0.008, izz=0.0017), BOX),
    link("ones", inertial(mass=1, ixx=1e-9, iyy=1e-9, izz=1e-9), BOX),
    link("dense", inertial(mass=200, ixx=1.6, iyy=1.6, izz=0.34), BOX),
    link("light", inertial(mass=1e-6, ixx=1e-9, iyy=1e-9, izz=1e-9), BOX),
)
NAMES = ("rod", "spread", "outside", "ones", "dense", "light")


def hang(parent: str, kind: str = "continuous") -> list[str]:
    """Return the joint that carries each faulty link."""
    return [joint(f"to_{name}", parent, name, kind=kind, axis="0 1 0") for name in NAMES]


@pytest.mark.parametrize("parent", ["base", "lost"])
def test_an_unknown_parent_does_not_hide_what_is_wrong_in_links(tmp_path: Path, parent: str) -> None:
    heavy = link("base", inertial(mass=5, ixx=0.1, iyy=0.1, izz=0.1), visual(box("0.4 0.4 0.4")))
    lost = joint("mount", "lost", "lamp")
    sound = check_text(tmp_path, robot(heavy, *DEFECTS, *hang("base")), codes=LOCAL)
    broken = check_text(tmp_path, robot(heavy, link("lamp"), *DEFECTS, *hang(parent), lost), codes={*LOCAL, "KIN002"})
    assert {f.code for f in sound.findings} == LOCAL
    assert [(f.code, f.message) for f in broken.findings if f.code != "KIN002"] == [
        (f.code, f.message) for f in sound.findings
    ]
    assert "KIN002" in codes(broken)
    assert not [skip for skip in broken.skipped if skip.code in LOCAL]


def test_a_body_to_which_a_missing_link_is_fixed_is_not_judged(tmp_path: Path) -> None:
    text = robot(link("base"), *DEFECTS, *hang("lost", "fixed"))
    assert not [code for code in codes(check_text(tmp_path, text, codes=LOCAL | {"KIN002"})) if code in LOCAL]


@pytest.mark.parametrize(
    ("whole", "parent", "message"),
    [
        (robot(link("base"), link("arm"), name="car"), "base", "fragment"),
        (robot(link("base"), name="car"), "base", "unknown"),  # a copy that still has the link
        (robot(link("other"), link("arm"), name="car"), "base", "unknown"),
        (robot(link("base"), link("arm"), name="truck"), "base", "unknown"),
        (robot(link("lazer"), link("arm"), name="car"), "lazer", "fragment"),  # on itself it would not hang
        ('<robot name="car"', "base", "unknown"),
        (None, "base", "unknown"),
    ],
)
def test_a_part_of_another_model_of_the_robot_is_no_error(
    tmp_path: Path, whole: str | None, parent: str, message: str
) -> None:
    (tmp_path / "package.xml").write_text('<package format="3"><name>car</name></package>', encoding="utf-8")
    if whole is not None:
        (tmp_path / "car.urdf").write_text(whole, encoding="utf-8")
    joint = f'<joint name="j" type="fixed"><parent link="{parent}"/><child link="laser"/></joint>'
    text = f'<robot name="car"><link name="laser"/>{joint}</robot>'
    (tmp_path / "laser.urdf").write_text(text, encoding="utf-8")
    (finding,) = check(tmp_path / "laser.urdf", codes={"KIN002"}).findings
    assert finding.message_id == message
    is_unused = message == "unknown" and f'name="{parent}"' in (
        whole or ""
    )  # nothing starts it, and a robot has the link
    known = Severity.WARNING if is_unused else Severity.ERROR
    assert finding.severity == (Severity.INFO if message == "fragment" else known)
    for other in (
        text.replace('<child link="laser"/>', '<child link="arm"/>'),
        text.replace("<joint", '<link name="root"/><joint'),
    ):
        (tmp_path / "laser.urdf").write_text(other, encoding="utf-8")
        assert "fragment" not in {f.message_id for f in check(tmp_path / "laser.urdf", codes={"KIN002"}).findings}


@pytest.mark.parametrize(
    ("program", "words", "message"),
    [
        ("send_urdf_fragment.py", "-l hand -j gripper", "attached"),
        ("send_urdf_fragment.py", "-l other", "unknown"),
        ("spawn_model", "-l hand", "unknown"),
    ],
)
@pytest.mark.parametrize("name", ["gripper.urdf", "gripper.urdf.xacro"])
def test_a_file_that_a_program_attaches_to_a_robot_is_a_part(
    tmp_path: Path, name: str, program: str, words: str, message: str
) -> None:
    node = f'<node name="n" pkg="q" type="{program}" args="-f $(find car)/{name} {words}"/>'
    joint = '<joint name="j" type="fixed"><parent link="hand"/><child link="gripper"/></joint>'
    for path, text in {
        "package.xml": '<package format="3"><name>car</name></package>',
        "a.launch": f"<launch>{node}</launch>",
        name: f'<robot name="g"><link name="gripper"/>{joint}</robot>',
    }.items():
        (tmp_path / path).write_text(text, encoding="utf-8")
    (finding,) = check(tmp_path / name, codes={"KIN002"}).findings
    assert finding.message_id == message
    assert finding.fix is not None
    assert "delete" not in finding.fix.title
    assert finding.severity == (Severity.INFO if message == "attached" else Severity.ERROR)


_GRIPPER = (
    '<robot name="g"{ns}>{comment}<link name="gripper"/>'
    '<joint name="j" type="fixed"><parent link="hand"/><child link="gripper"/></joint></robot>'
)


@pytest.mark.parametrize(
    ("comment", "variable"),
    [("<!-- set as the JACKAL_URDF_EXTRAS environment variable -->", True), ("<!-- URDF_EXTRAS -->", False)],
)
def test_a_file_for_the_variable_of_a_robot_is_a_part(tmp_path: Path, comment: str, variable: bool) -> None:
    (tmp_path / "package.xml").write_text('<package format="3"><name>car</name></package>', encoding="utf-8")
    (tmp_path / "arm.urdf").write_text(_GRIPPER.format(ns="", comment=comment), encoding="utf-8")
    (finding,) = check(tmp_path / "arm.urdf", codes={"KIN002"}).findings
    assert (finding.message_id, "JACKAL_URDF_EXTRAS" in finding.message) == (
        ("attached", True) if variable else ("unknown", False)
    )


@pytest.mark.parametrize(("href", "message"), [("arm.in.urdf", "xincluded"), ("my_arm.in.urdf", "unknown")])
def test_a_file_that_another_includes_by_xinclude_is_a_part(tmp_path: Path, href: str, message: str) -> None:
    whole = f'<robot name="r" xmlns:xi="http://www.w3.org/2001/XInclude"><xi:include href="{href}"/></robot>'
    for path, text in {"r.in.urdf": whole, "arm.in.urdf": _GRIPPER.format(ns="", comment="")}.items():
        (tmp_path / path).write_text(text, encoding="utf-8")
    (finding,) = check(tmp_path / "arm.in.urdf", codes={"KIN002"}).findings
    assert finding.message_id == message


@pytest.mark.parametrize(
    ("launch", "severity"),
    [
        ('<include file="$(find q)/q.launch"><arg name="extras" value="$(arg e)"/></include>', Severity.WARNING),
        ('<param name="robot_description" command="xacro $(arg e)"/>', Severity.ERROR),
        (
            '<include file="$(find car)/b.launch"><arg name="model" value="$(arg e)"/></include>',
            Severity.ERROR,
        ),
    ],
)
def test_a_part_that_is_handed_to_another_package_may_have_its_robot_there(
    tmp_path: Path, launch: str, severity: Severity
) -> None:
    argument = '<arg name="e" default="$(find car)/extras.xacro"/>'
    load = '<arg name="model"/><param name="robot_description" command="xacro $(arg model)"/>'
    for path, text in {
        "package.xml": '<package format="2"><name>car</name></package>',
        "a.launch": f"<launch>{argument}{launch}</launch>",
        "b.launch": f"<launch>{load}</launch>",
        "extras.xacro": _GRIPPER.format(ns=' xmlns:xacro="http://www.ros.org/wiki/xacro"', comment=""),
    }.items():
        (tmp_path / path).write_text(text, encoding="utf-8")
    (finding,) = check(tmp_path / "extras.xacro", codes={"KIN002"}).findings
    assert finding.severity is severity
    assert finding.fix is not None
    assert ("gets this file as extras" in finding.fix.title) == (severity is Severity.WARNING)


@pytest.mark.parametrize(
    ("params", "name", "calls", "line", "message"),
    [
        ("", "tool", ("", ""), 2, "two links are called tool, so references to the name are ambiguous"),
        (
            "prefix:=l_",
            "${prefix}tool",
            ("", ""),
            4,
            "two links are called l_tool, because both calls leave prefix at the default",
        ),
        (
            "p q",
            "${p}${q}",
            ('p="a" q="b"',) * 2,
            4,
            "two links are called ab, because both calls pass the same p and q",
        ),
    ],
)
def test_one_name_of_two_calls_is_told_where_it_can_be_mended(
    tmp_path: Path, params: str, name: str, calls: tuple[str, str], line: int, message: str
) -> None:
    macro = f'<xacro:macro name="arm" params="{params}">\n<link name="{name}"/></xacro:macro>'
    lines = (
        f'<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">{macro}',
        *(f"<xacro:arm {c}/>" for c in calls),
    )
    (finding,) = check_text(tmp_path, "\n".join([*lines, "</robot>"]), codes={"KIN001"}, name="arm.xacro").findings
    assert finding.location.span is not None
    assert (finding.location.span.line, finding.message) == (line, message)


@pytest.mark.parametrize(("name", "severity"), [("", Severity.INFO), (' name="r"', Severity.ERROR)])
def test_a_part_without_a_name_that_nothing_includes_is_a_note(tmp_path: Path, name: str, severity: Severity) -> None:
    joint_to_base = '<joint name="j" type="fixed"><parent link="base"/><child link="camera"/></joint>'
    text = f'<robot{name} xmlns:xacro="http://www.ros.org/wiki/xacro"><link name="camera"/>{joint_to_base}</robot>'
    (finding,) = find(tmp_path, text, "KIN002", name="camera.xacro")
    assert finding.severity is severity


@pytest.mark.parametrize(
    ("started", "severity"), [("r.urdf.xacro", Severity.ERROR), ("car.urdf", Severity.WARNING), ("", Severity.WARNING)]
)
def test_a_part_that_its_package_does_not_start_is_a_warning(tmp_path: Path, started: str, severity: Severity) -> None:
    launch = f"<launch>rviz {started}</launch>"
    for name, text in (("package.xml", "<package><name>p</name></package>"), ("view.launch", launch)):
        (tmp_path / name).write_text(text)
    text = robot(link("laser"), joint("j", "base_link", "laser"))
    (finding,) = check_text(tmp_path, text, codes={"KIN002"}, name="r.urdf.xacro").findings
    assert (finding.message_id, finding.severity) == ("unknown", severity)


@pytest.mark.parametrize(
    ("typed", "call", "repair"),
    [
        ("${up}", 'up="bse"', "pass an existing link as up, or add"),
        ("${up}_link", 'up="bse"', "name an existing link, or add"),
    ],
)
def test_a_link_is_named_where_it_is_handed_over(tmp_path: Path, typed: str, call: str, repair: str) -> None:
    camera = f'<link name="eye"/><joint name="j" type="fixed"><parent link="{typed}"/><child link="eye"/></joint>'
    macro = f'<xacro:macro name="camera" params="up">{camera}</xacro:macro><xacro:camera {call}/>'
    text = f'<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><link name="chassis"/>{macro}</robot>'
    (finding,) = check_text(tmp_path, text, codes={"KIN002"}, name="r.urdf.xacro").findings
    assert finding.fix is not None
    assert finding.fix.title.startswith(repair)


def test_a_macro_joins_the_pieces_if_its_call_says_to_what(tmp_path: Path) -> None:
    held = '<joint name="k" type="fixed"><parent link="${up}"/><child link="base"/></joint>'
    parts = f'<link name="world"/><xacro:unless value="${{not up}}">{held}</xacro:unless><link name="base"/>'
    macro = f'<robot><xacro:macro name="arm" params="up:=\'\'">{parts}</xacro:macro></robot>'
    (tmp_path / "arm.xacro").write_text(macro.replace("<robot>", '<robot xmlns:xacro="http://www.ros.org/wiki/xacro">'))
    text = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:include filename="arm.xacro"/><xacro:arm/></robot>'
    (finding,) = check_text(tmp_path, text, codes={"KIN005"}, name="r.urdf.xacro").findings
    assert finding.fix is not None
    assert finding.fix.title.endswith("or pass up to macro arm, which then makes one")


@pytest.mark.parametrize(
    ("launch", "severity"),
    [("gazebo_ros r.urdf", Severity.WARNING), ("gazebo_ros", Severity.INFO), ("rviz", Severity.INFO)],
)
def test_a_name_that_only_sdf_refuses_matters_where_gazebo_is_used(
    tmp_path: Path, launch: str, severity: Severity
) -> None:
    files = {"package.xml": "<package><name>p</name></package>", "a.launch": f"<launch>{launch}</launch>"}
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    text = robot(link("a"), link("b"), joint("b", "a", "b", kind="continuous"))
    (finding,) = check_text(tmp_path, text, codes={"KIN001"}, name="r.urdf").findings
    assert (finding.message_id, finding.severity) == ("shared", severity)


def test_a_link_and_its_joint_that_are_there_twice_are_a_copy(tmp_path: Path) -> None:
    part = '<link name="a"/><joint name="j" type="fixed"><parent link="base"/><child link="a"/></joint>'
    run = check_text(tmp_path, f'<robot name="r"><link name="base"/>{part}{part}</robot>', codes={"KIN001"})
    assert [f.fix.title for f in run.findings if f.fix and f.location.subject.startswith("link")] == [
        "delete one with its joint j if it is a copy, or rename both"
    ]


@pytest.mark.parametrize(
    ("passed", "expected"),
    [
        ({"a": '{"frame": "true"}'}, "default"),
        ({"a": '{"frame": "true", "speed": "2"}', "b": '{"frame": "true"}'}, "default"),
        ({"a": '{"frame": "true"}', "b": "{}"}, "unknown"),  # this one fails
        ({"a": '{"frame": "true"}', "b": '{"speed": "2"}'}, "unknown"),
        ({"a": '{"speed": "2"}'}, "unknown"),
        ({}, "unknown"),
    ],
)
def test_a_link_that_all_launch_files_make_lacks_in_the_defaults_only(
    tmp_path: Path, passed: dict[str, str], expected: str
) -> None:
    body = (
        '<xacro:arg name="frame" default="false"/><xacro:arg name="speed" default="1"/><link name="base"/>'
        '<xacro:if value="$(arg frame)"><link name="frame"/>' + joint("to_frame", "base", "frame") + "</xacro:if>"
        '<link name="tool"/>' + joint("to_tool", "frame", "tool")
    )
    launches = {
        f"launch/{name}.launch.py": "share = get_package_share_directory('arm')\n"
        f"text = xacro.process_file(os.path.join(share, 'urdf', 'arm.urdf.xacro'), mappings={mappings})\n"
        for name, mappings in passed.items()
    }
    files = {
        "package.xml": "<package><name>arm</name></package>",
        "urdf/arm.urdf.xacro": f'<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">{body}</robot>',
        **launches,
    }
    (finding,) = find(tmp_path, files, "KIN002", name="urdf/arm.urdf.xacro")
    assert finding.message_id == expected
    if expected == "default":
        assert "give frame the default `true`" in finding.fix.title


def test_a_part_on_the_world_is_not_called_the_root(tmp_path: Path) -> None:
    body = link("world") + link("base") + joint("weld", "world", "base") + link("arm", inertial(1, 1))
    (finding,) = check_text(
        tmp_path, robot(body + joint("j", "base", "arm", kind="continuous")), codes={"KIN010"}
    ).findings
    assert finding.headline == "Gazebo gets an empty model: on world, base has no mass"


@pytest.mark.parametrize(("axis", "says"), [("0 1 0", True), ("1 0 0", False)])
def test_two_motions_between_two_links_need_a_link_in_between(tmp_path: Path, axis: str, says: bool) -> None:
    body = link("base") + link("table")
    for name, direction in (("x", "1 0 0"), ("y", axis)):
        body += joint(name, "base", "table", f'<axis xyz="{direction}"/>', kind="continuous")
    (finding,) = check_text(tmp_path, robot(body), codes={"KIN003"}).findings
    assert finding.fix is not None
    assert finding.fix.title.endswith("put a link between one joint and the next") == says


def test_misspelt_limits_may_be_deleted_where_none_is_needed(tmp_path: Path) -> None:
    for kind, says in (("continuous", True), ("revolute", False)):
        text = robot(link("a") + link("b") + joint("j", "a", "b", '<limits effort="1" velocity="1"/>', kind=kind))
        (finding,) = check_text(tmp_path, text, codes={"XML003"}).findings
        assert finding.fix is not None
        assert finding.fix.title.endswith("; delete it if the robot moves as it should") == says


@pytest.mark.parametrize(
    ("script", "severity"),
    [
        ("model = pinocchio.buildModelFromUrdf('data/r.urdf')", Severity.INFO),
        ("spawn('data/r.urdf')  # in gazebo_ros", Severity.WARNING),
        ("model = pinocchio.buildModelFromUrdf('data/other.urdf')", Severity.WARNING),
    ],
)
def test_a_model_of_no_package_is_for_the_programs_that_name_it(
    tmp_path: Path, script: str, severity: Severity
) -> None:
    for name, text in ((".git/HEAD", ""), ("src/run.py", script), ("data/r.urdf", moving("base", ""))):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    (finding,) = check(tmp_path / "data/r.urdf", codes={"KIN010"}).findings
    assert finding.severity is severity


@pytest.mark.parametrize(
    ("code", "passed", "expected"),
    [
        ("KIN001", {"a": '{"l": "l_", "r": "r_"}'}, {"default"}),
        ("KIN001", {"a": '{"l": "l_", "r": "r_"}', "b": "{}"}, {"passed"}),  # this one fails
        ("KIN001", {"a": '{"l": "x_", "r": "x_"}'}, {"passed"}),
        ("KIN001", {}, {"passed"}),
        ("KIN005", {"a": '{"world": "true"}'}, {"default"}),
        ("KIN005", {"a": '{"world": "true"}', "b": "{}"}, {"pieces"}),
        ("KIN005", {}, {"pieces"}),
    ],
)
def test_what_only_the_defaults_make_wrong_is_a_warning(
    tmp_path: Path, code: str, passed: dict[str, str], expected: set[str]
) -> None:
    held = {
        "KIN001": '<xacro:arg name="l" default=""/><xacro:arg name="r" default=""/><link name="base"/>'
        '<xacro:macro name="arm" params="prefix"><link name="${prefix}a"/>'
        + joint("${prefix}j", "base", "${prefix}a")
        + '</xacro:macro><xacro:arm prefix="$(arg l)"/><xacro:arm prefix="$(arg r)"/>',
        "KIN005": '<xacro:arg name="world" default="false"/><link name="world"/><link name="base"/>'
        '<xacro:if value="$(arg world)">' + joint("weld", "world", "base") + "</xacro:if>",
    }
    launches = {
        f"launch/{name}.launch.py": "share = get_package_share_directory('arm')\n"
        f"text = xacro.process_file(os.path.join(share, 'urdf', 'arm.urdf.xacro'), mappings={mappings})\n"
        for name, mappings in passed.items()
    }
    files = {
        "package.xml": "<package><name>arm</name></package>",
        "urdf/arm.urdf.xacro": robot(held[code], name="arm", xacro=True),
        **launches,
    }
    findings = find(tmp_path, files, code, name="urdf/arm.urdf.xacro")
    assert {finding.message_id for finding in findings} == expected
    severity = Severity.WARNING if expected == {"default"} else Severity.ERROR
    assert {finding.severity for finding in findings} == {severity}


def test_joints_without_parent_and_child_are_a_list_for_joint_state_publisher(tmp_path: Path) -> None:
    thruster = '<joint name="thruster"><limit lower="-30" upper="30"/></joint>'
    (finding,) = check_text(tmp_path, f'<robot name="r">{thruster}</robot>', codes={"KIN007"}).findings
    assert (finding.message_id, finding.severity) == ("joints", Severity.WARNING)
    tied = '<joint name="j" type="fixed"><parent link="a"/><child link="b"/></joint>'
    (finding,) = check_text(tmp_path, f'<robot name="r">{tied}</robot>', codes={"KIN007"}).findings
    assert (finding.message_id, finding.severity) == ("none", Severity.ERROR)


@pytest.mark.parametrize(
    ("started", "other", "severity"),
    [
        ("", "base_link", Severity.WARNING),
        ("tray.urdf", "base_link", Severity.ERROR),
        ("", "chassis", Severity.ERROR),  # nothing shows that the file is a part of another robot
    ],
)
def test_a_part_in_plain_urdf_that_its_package_does_not_start_is_a_warning(
    tmp_path: Path, started: str, other: str, severity: Severity
) -> None:
    files = {
        "package.xml": "<package><name>p</name></package>",
        "view.launch": f"<launch>rviz {started}</launch>",
        "urdf/car.urdf": robot(link(other), name="car"),
        "urdf/tray.urdf": robot(link("tray"), joint("j", "base_link", "tray"), name="tray"),
    }
    (finding,) = find(tmp_path, files, "KIN002", name="urdf/tray.urdf")
    assert (finding.message_id, finding.severity) == ("unknown", severity)


def test_the_nearest_file_with_the_missing_link_is_said_to_complete_a_robot(tmp_path: Path) -> None:
    files = {
        ".git/HEAD": "",
        "_deps/sensor/example.urdf": robot(link("stand"), link("sensor"), name="example"),
        "cell/corner.urdf": robot(link("wall"), link("arm"), joint("j", "stand", "arm"), name="corner"),
        "cell/setup.urdf": robot(link("stand"), link("table"), name="setup"),
    }
    (finding,) = find(tmp_path, files, "KIN002", name="cell/corner.urdf")
    assert finding.fix is not None
    assert "setup.urdf, which has stand, completes this one" in finding.fix.title


@pytest.mark.parametrize(
    ("name", "repair"),
    [
        ("cell", "take what is missing from whole/cell.urdf, which has the same robot name and stand; "),
        ("cube", "name an"),
    ],
)
def test_another_folder_completes_only_a_robot_of_the_same_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, repair: str
) -> None:
    monkeypatch.chdir(tmp_path)
    files = {
        ".git/HEAD": "",
        "cell/corner.urdf": robot(link("wall"), link("arm"), joint("j", "stand", "arm"), name="cell"),
        "whole/cell.urdf": robot(link("stand"), link("table"), name=name),
    }
    (finding,) = find(tmp_path, files, "KIN002", name="cell/corner.urdf")
    assert finding.fix is not None
    assert finding.fix.title.startswith(repair)


@pytest.mark.parametrize(("mass", "severity"), [("0", Severity.INFO), ("2", Severity.WARNING)])
def test_a_model_without_any_mass_has_none_to_lose(tmp_path: Path, mass: str, severity: Severity) -> None:
    zeros = '<inertia ixx="{0}" ixy="0" ixz="0" iyy="{0}" iyz="0" izz="{0}"/>'
    links = "".join(
        f'<link name="{name}"><inertial><mass value="{value}"/>{zeros.format(value)}</inertial></link>'
        for name, value in (("base", "0"), ("x", mass))
    )
    joint = '<joint name="j" type="continuous"><parent link="base"/><child link="x"/><axis xyz="1 0 0"/></joint>'
    (finding,) = check_text(tmp_path, f'<robot name="r">{links}{joint}</robot>', codes={"KIN010"}).findings
    assert (finding.message_id, finding.severity) == ("vanishes", severity)


@pytest.mark.parametrize("is_joined", [True, False])
def test_links_that_an_including_file_joins_are_loaded_with_it(tmp_path: Path, is_joined: bool) -> None:
    text = robot(link("base"), link("arm"))
    joined = '<joint name="j" type="fixed"><parent link="base"/><child link="${of}"/></joint>'
    call = '<xacro:m of="arm"/>' if is_joined else ""
    whole = (
        '<robot name="whole" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:include filename="r.urdf"/>'
        f'<xacro:macro name="m" params="of">{joined}</xacro:macro>{call}</robot>'
    )
    (tmp_path / "whole.urdf.xacro").write_text(whole)
    (finding,) = check_text(tmp_path, text, codes={"KIN005"}, name="r.urdf").findings
    assert finding.severity is Severity.ERROR
    assert finding.fix is not None
    assert ("whole.urdf.xacro: it includes this file" in finding.fix.title) == is_joined
    assert ("add the joints" in finding.fix.title) != is_joined
