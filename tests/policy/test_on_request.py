"""Notes on request: left out unless -v, a selection, a severity, an option or a target asks for them."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import pytest
from builders import arm_on_base, box, collision, inertial, joint, link, robot, sphere, visual
from conftest import check, command

from urdfcheck.core import Severity, SkippedCheck, Verdict
from urdfcheck.core.errors import UrdfcheckError
from urdfcheck.policy.consumers import CONSUMERS, get_verdict
from urdfcheck.policy.on_request import find_postponed, split_unrequested
from urdfcheck.rules import describe_on_request, load_page, load_rules

pytestmark = pytest.mark.usefixtures("one_process")

# KIN008: KDL ignores the inertia of a root; it says so at every start. JNT014: rounding noise in an origin.
ROBOT = robot(
    link("base", inertial(2, 0.1)),
    link("arm", inertial(1, 0.1)),
    joint("j", "base", "arm", xyz="0.1 1e-17 0"),
)
HIDDEN = {"KIN008", "JNT014"}
CORNERS = ("0 0 0", "1 0 0", "0 1 0", "0 0 1")
# A tetrahedron.
MESH = "\n".join(
    [
        "solid m",
        *(
            f"facet normal 0 0 0\nouter loop\n{''.join(f'vertex {CORNERS[i]}{chr(10)}' for i in face)}endloop\nendfacet"
            for face in ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2))
        ),
        "endsolid m",
        "",
    ]
)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "r.urdf").write_text(ROBOT)
    return tmp_path


def list_codes(folder: Path, *options: str) -> set[str]:
    """The rules of :data:`HIDDEN` that the JSON report has findings of."""
    done = command("r.urdf", "--tier", "source", "--format", "json", *options, cwd=folder)
    return {finding["code"] for finding in json.loads(done.stdout)["findings"]} & HIDDEN


def test_nobody_asked(folder: Path) -> None:
    assert list_codes(folder) == set()


@pytest.mark.parametrize(
    ("options", "codes"),
    [
        (["-v"], HIDDEN),
        (["--select", "ALL"], HIDDEN),
        (["--select", "KIN"], {"KIN008"}),
        (["--select", "cad-noise"], {"JNT014"}),
        (["--target", "kdl"], {"KIN008"}),
        (["--target", "gazebo"], set()),  # it loads it
    ],
)
def test_the_command_line_asks(folder: Path, options: list[str], codes: set[str]) -> None:
    assert list_codes(folder, *options) == codes


@pytest.mark.parametrize(
    ("text", "codes"),
    [
        ('select = ["ALL"]', HIDDEN),
        ('select = ["JNT014", "INR"]', {"JNT014"}),
        ('target = ["kdl"]', {"KIN008"}),
        ('severity = { JNT014 = "info" }', {"JNT014"}),
        ('severity = { JNT014 = "warning" }', {"JNT014"}),
        ('[[paths]]\nmatch = ["r.urdf"]\nselect = ["JNT014"]', {"JNT014"}),
    ],
)
def test_the_configuration_asks(folder: Path, text: str, codes: set[str]) -> None:
    (folder / "urdfcheck.toml").write_text(text)
    assert list_codes(folder) == codes


def test_fixes_are_made_only_where_the_rule_is_asked_for(folder: Path) -> None:
    assert command("r.urdf", "--tier", "source", "--diff", cwd=folder).stdout == ""
    for asked in (["-v"], ["--select", "JNT014"]):
        assert "1e-17" in command("r.urdf", "--tier", "source", "--diff", *asked, cwd=folder).stdout


def test_the_last_line_counts_what_verbose_adds(folder: Path) -> None:
    (folder / "r.urdf").write_text(ROBOT.replace("0.1 1e-17 0", "0.1 0 0"))
    selected = command("r.urdf", "--tier", "source", "--select", "KIN", cwd=folder).stdout
    brief, whole = (command("r.urdf", "--tier", "source", *more, cwd=folder).stdout for more in ([], ["-v"]))
    assert "KIN008" in selected
    assert "KIN008" not in brief
    assert brief.splitlines()[-1].startswith("✔ no errors, no warnings (")
    assert "-v)" in brief.splitlines()[-1]
    assert "KIN008" in whole


def test_what_a_target_refuses_is_an_error_and_never_left_out(tmp_path: Path) -> None:
    (tmp_path / "m.stl").write_text(MESH)
    shape = '<collision><geometry><mesh filename="m.stl"/></geometry></collision>'
    (tmp_path / "r.urdf").write_text(robot(link("base", inertial(), shape)))
    out = command("r.urdf", "--format", "concise", cwd=tmp_path).stdout
    assert "MSH011" not in out
    asked = command("r.urdf", "--format", "concise", "--target", "drake", cwd=tmp_path).stdout
    assert "error MSH011 Drake cannot load m.stl" in asked


def test_what_programs_do_is_known_without_the_note(tmp_path: Path) -> None:
    """No program is said to load a model because a note about it was left out."""
    (tmp_path / "m.stl").write_text(MESH)
    shape = '<collision><geometry><mesh filename="m.stl"/></geometry></collision>'
    (tmp_path / "r.urdf").write_text(robot(link("base", inertial(), shape)))
    report = json.loads(command("r.urdf", "--format", "json", cwd=tmp_path).stdout)
    assert "MSH011" not in {finding["code"] for finding in report["findings"]}
    assert report["consumers"]["r.urdf"]["drake"] == {"verdict": "refuses", "codes": ["MSH011"]}


def test_a_suppression_of_a_note_on_request_is_needed(folder: Path) -> None:
    comment = "<!-- urdfcheck: ignore[KIN008] KDL is not used -->"
    (folder / "r.urdf").write_text(ROBOT.replace("<link", f"{comment}<link", 1))
    done = command("r.urdf", "--tier", "source", "--format", "json", cwd=folder)
    assert "URC901" not in done.stdout
    assert "KIN008" in done.stdout  # as suppressed


def test_errors_and_warnings_are_never_left_out(folder: Path) -> None:
    (finding,) = check(folder / "r.urdf", codes={"KIN008"}).findings
    rules = load_rules()
    for severity, is_reported in ((Severity.ERROR, True), (Severity.WARNING, True), (Severity.INFO, False)):
        found, left_out = split_unrequested(
            [replace(finding, severity=severity)], rules, unrequested=frozenset({"KIN008"}), targets=()
        )
        assert bool(found) is is_reported
        assert bool(left_out) is not is_reported


BALLS = [link(f"{side}_wheel", inertial(1, 0.01), visual(sphere(0.1))) for side in ("left", "right")]


@pytest.mark.parametrize(
    ("code", "text"),
    [
        ("INR001", arm_on_base()),
        (
            "INR001",
            arm_on_base(
                inertial(1, 0.1), more=link("pad", collision(box("1 1 1"))) + joint("k", "arm", "pad", kind="fixed")
            ),
        ),
        (
            "SYM005",
            robot(
                link("base", inertial(1, 0.1)),
                *BALLS,
                joint("l", "base", "left_wheel", kind="continuous", xyz="0 0.2 0", axis="0 1 0"),
                joint("r", "base", "right_wheel", kind="continuous", xyz="0 -0.2 0", axis="0 -1 0"),
            ),
        ),
    ],
    ids=["drawing", "mass that MuJoCo adds", "wheels of an own program"],
)
def test_what_an_author_may_have_chosen_is_told_on_request(tmp_path: Path, code: str, text: str) -> None:
    (tmp_path / "r.urdf").write_text(text)
    for options, is_told in (((), False), (("-v",), True)):
        report = json.loads(command("r.urdf", "--format", "json", *options, cwd=tmp_path).stdout)
        assert (code in {finding["code"] for finding in report["findings"]}) is is_told


# A shaft in its bearing: COL002.
SHAFT = robot(
    link("base", collision(box("0.1 0.1 0.1"))),
    link("shaft", collision(sphere(0.02))),
    joint("turn", "base", "shaft", kind="continuous", axis="0 0 1"),
)


def list_neighbours(folder: Path, *options: str) -> list[object]:
    """Whether each finding of COL002 is suppressed; the cache is kept."""
    report = json.loads(command("r.urdf", "--format", "json", *options, cwd=folder).stdout)
    return [finding["suppressed"] for finding in report["findings"] if finding["code"] == "COL002"]


def test_what_takes_long_is_not_looked_for_where_nobody_asks(tmp_path: Path) -> None:
    (tmp_path / "r.urdf").write_text(SHAFT)
    looked = {finding.code for finding in check(tmp_path / "r.urdf").findings}
    assert "COL002" in looked
    assert list_neighbours(tmp_path) == []
    last = command("r.urdf", cwd=tmp_path).stdout.splitlines()[-1]
    assert "+ notes" in last
    assert "COL002, COL005 with -v" in command("config", "r.urdf", cwd=tmp_path).stdout
    for options in (["-v"], ["--pedantic"], ["--select", "COL"], ["--target", "moveit"]):
        assert list_neighbours(tmp_path, *options) == [None], options
        assert "+ notes" not in command("r.urdf", *options, cwd=tmp_path).stdout
    assert list_neighbours(tmp_path, "--target", "gazebo") == []  # adjacent links do not collide there
    (tmp_path / "urdfcheck.toml").write_text('severity = { COL002 = "warning" }')
    assert list_neighbours(tmp_path) == [None]


def test_notes_are_counted_as_they_are_listed(tmp_path: Path) -> None:
    """Those of one kind are one, and what is not looked for is not counted."""
    (tmp_path / "r.urdf").write_text(
        robot(link("base"), *(link(n) for n in "abc"), *(joint(f"to_{n}", "base", n, kind="continuous") for n in "abc"))
    )
    counts = [command("r.urdf", *options, cwd=tmp_path).stdout.splitlines()[-1] for options in ((), ("-v",))]
    before, after = (int(found[1]) if (found := re.search(r"(\d+)\+? notes?", line)) else 0 for line in counts)
    assert before == after > 1


def test_the_cache_of_a_run_without_a_rule_does_not_hide_it(tmp_path: Path) -> None:
    (tmp_path / "r.urdf").write_text(SHAFT)
    answers = [list_neighbours(tmp_path, *options) for options in ([], ["-v"], [], ["-v"], ["--pedantic"])]
    assert answers == [[], [None], [], [None], [None]]


def test_what_is_not_looked_for_is_not_gone(tmp_path: Path) -> None:
    """No comment and no entry of a baseline is called needless."""
    comment = "<!-- urdfcheck: ignore[COL] a shaft in its bearing -->"
    (tmp_path / "r.urdf").write_text(SHAFT.replace("<link", f"{comment}<link"))
    assert "URC902" not in command("r.urdf", "--format", "concise", cwd=tmp_path).stdout
    assert [bool(reason) for reason in list_neighbours(tmp_path, "-v")] == [True]
    (tmp_path / "r.urdf").write_text(SHAFT)
    command("baseline", "write", "r.urdf", "--select", "ALL", cwd=tmp_path)
    assert [bool(reason) for reason in list_neighbours(tmp_path, "-v")] == [True]
    assert "URC904" not in command("r.urdf", "--format", "concise", cwd=tmp_path).stdout
    command("baseline", "prune", "r.urdf", cwd=tmp_path)
    assert [bool(reason) for reason in list_neighbours(tmp_path, "-v")] == [True]


def test_nothing_depends_on_rules_that_are_not_looked_for() -> None:
    rules = load_rules()
    postponed = find_postponed(rules, unrequested=rules, targets=())
    assert postponed == {"COL002", "COL005"}
    for rule in (rules[code] for code in postponed):
        for table in (rule.consumers, *(t for t in rule.consumers.values() if not isinstance(t, str))):
            assert all(get_verdict(table, name) is Verdict.LOADS for name in CONSUMERS), rule.code
    for rule in rules.values():
        others = (*rule.explained_by.values(), *rule.repeats.values(), rule.hidden_by)
        assert not any(postponed.intersection(codes) for codes in others), rule.code


def test_a_page_says_that_its_notes_are_on_request() -> None:
    assert "notes only on request" in describe_on_request(load_rules()["COL002"])
    assert "notes floating, planar only on request" in describe_on_request(load_rules()["KIN009"])
    assert describe_on_request(load_rules()["INR003"]) == ""
    assert "notes only on request" in command("rule", "COL002", "--full").stdout


def test_a_page_names_messages_that_exist(tmp_path: Path) -> None:
    page = load_rules()["MSH002"].page.replace('on_request = ["', 'on_request = ["drawm", "')
    (tmp_path / "MSH002-not-watertight.md").write_text(page)
    with pytest.raises(UrdfcheckError, match="no message 'drawm'"):
        load_page(tmp_path / "MSH002-not-watertight.md")


@pytest.mark.parametrize(
    ("options", "config", "severity"),
    [
        ([], "", None),
        (["-v"], "", "info"),
        (["--select", "PKG004"], "", "info"),
        ([], 'severity = { PKG004 = "warning" }', "warning"),
        (["--pedantic"], "", "error"),
    ],
)
def test_of_test_data_only_what_misleads_the_parser_is_reported(
    tmp_path: Path, options: list[str], config: str, severity: str | None
) -> None:
    mesh = '<visual><geometry><mesh filename="/home/ann/a.stl"/></geometry></visual>'
    text = robot(
        link("base", inertial(1, 0.1)), link("arm", inertial(-1, 0.1), mesh), joint("j", "base", "arm", kind="revolute")
    )
    (tmp_path / "tests").mkdir()
    (tmp_path / "tests/r.urdf").write_text(text, encoding="utf-8")
    (tmp_path / "urdfcheck.toml").write_text(config, encoding="utf-8")
    common = ("--format", "json", "--tier", "source", *options)
    run = json.loads(command(".", *common, cwd=tmp_path).stdout)
    found = {f["code"]: f["severity"] for f in run["findings"]}
    assert ("JNT004" in found) == ("--select" not in options)
    # urdfdom loads a negative mass.
    assert found.get("INR002") == {"-v": "info", "--pedantic": "error"}.get("".join(options))
    assert found.get("PKG004") == severity
    notes = [skip["reason"] for skip in run["skipped"] if skip["code"] == SkippedCheck.WARNINGS]
    assert bool(notes) == (not options)
    named = json.loads(command("tests/r.urdf", *common, cwd=tmp_path).stdout)["findings"]
    assert {f["severity"] for f in named if f["code"] == "PKG004"} == {"warning" if config else "error"}


def test_a_package_that_is_kept_aside_is_not_reported(tmp_path: Path) -> None:
    folder = tmp_path / "deprecated" / "p"
    (folder / "launch").mkdir(parents=True)
    (folder / "package.xml").write_text("<package><name>p</name></package>", encoding="utf-8")
    node = '<node pkg="robot_state_publisher" type="state_publisher" name="n"/>'
    text = f'<launch>{node}<include file="$(find gazebo_ros)/launch/a.launch"/></launch>'
    (folder / "launch" / "a.launch").write_text(text, encoding="utf-8")
    common = ("--format", "json", "--tier", "source")
    run = json.loads(command(".", *common, cwd=tmp_path).stdout)
    assert [f for f in run["findings"] if f["severity"] != "info"] == []
    assert {skip["model"] for skip in run["skipped"] if skip["code"] == SkippedCheck.FINDINGS} == {
        "deprecated/p/launch/a.launch",
        "deprecated/p/package.xml",
    }
    named = json.loads(command("deprecated/p", *common, cwd=tmp_path).stdout)["findings"]
    assert {f["code"] for f in named if f["severity"] == "warning"} == {"LCH003", "PKG007"}


@pytest.mark.parametrize("place", ["old/r.urdf", "r_old.urdf"])
@pytest.mark.parametrize("text", [None, "<robot name='r'><link></robot>"], ids=["an error", "not XML"])
def test_of_a_model_that_is_kept_aside_only_what_stops_its_check_is_reported(
    tmp_path: Path, place: str, text: str | None
) -> None:
    broken = robot(link("base", inertial(1, 0.1)), link("arm", inertial(-1, 0.1)), joint("j", "base", "arm"))
    (tmp_path / place).parent.mkdir(exist_ok=True)
    (tmp_path / place).write_text(text or broken, encoding="utf-8")
    (tmp_path / "used.urdf").write_text('<robot name="r"><link name="l"/></robot>', encoding="utf-8")
    common = ("--format", "json", "--tier", "source")
    given = ([".", *common], [".", *common, "-v"], [place, *common])
    plain, asked, named = (command(*arguments, cwd=tmp_path) for arguments in given)
    run = json.loads(plain.stdout)
    assert {f["code"]: f["severity"] for f in run["findings"]} == ({} if text is None else {"XML001": "warning"})
    left_out = [skip["model"] for skip in run["skipped"] if skip["code"] == SkippedCheck.FINDINGS]
    assert left_out == [place] * (text is None)
    assert (plain.returncode, named.returncode) == (0, 1)
    if text is None:
        found = [f["severity"] for f in json.loads(asked.stdout)["findings"] if f["code"] == "INR002"]
        assert found == ["info"]


BROKEN = robot(
    link("base", inertial(1, 0.1)), link("arm", inertial(1, 0.1)), joint("j", "base", "arm", kind="revolute")
)
STARTED = "<launch><param name='robot_description' textfile='$(find car)/urdf/car.urdf'/></launch>"


@pytest.mark.parametrize(
    ("path", "text", "is_left_over"),
    [
        ("p/launch/car.launch", STARTED, True),
        ("p/launch/car.launch", STARTED.replace("car.urdf", "arm.urdf"), False),
        ("p/launch/old/car.launch", STARTED.replace("car.urdf", "arm.urdf"), True),
        ("p/launch/car.launch", STARTED.replace("car.urdf", "$(arg name).urdf"), False),
        ("p/launch/car.launch.py", "names = ['car.urdf', 'arm']", False),
        ("p/launch/car.launch.py", "if name == 'arm': print(name)", True),
        ("p/launch/car.launch.py", "if name!='arm': print(name)", True),
        ("p/launch/arm.launch", STARTED.replace("car.urdf", "arm.urdf"), False),
        ("p/README.md", "check_urdf urdf/arm.urdf", False),
        ("README.md", "check_urdf urdf/arm.urdf", False),
        ("p/urdf/README", "arm.urdf", False),
        ("tools/show.py", "show('p/urdf/arm.urdf')", False),
        ("p/src/load.cpp", 'load(folder + "/urdf/arm.urdf");', False),
        ("docs/log.txt", "arm.urdf", True),
        ("p/launch/car.launch.py", "write(path.replace('.xacro', ''))", True),
        ("p/launch/car.launch.py", "read(name + '.urdf')", False),
        ("p/launch/car.launch.py", "NamedTemporaryFile(suffix='.urdf')", True),
        ("p/worlds/car.world", "<sdf><world name='w'><model name='arm'/></world></sdf>", True),
        ("p/make.sh", "xacro urdf/car.urdf -o urdf/arm.urdf", True),
        ("p/make.sh", "xacro urdf/car.urdf -o urdf/arm.urdf\ncheck_urdf urdf/arm.urdf", False),
        ("tools/show.py", "# show('p/urdf/arm.urdf')", True),
        ("p/config/start.xml", '<robot name="arm"/>', True),
        ("p/config/start.xml", '<robot file="arm"/>', False),
        ("p/urdf/hand.urdf", '<robot name="hand"><link name="arm"/></robot>', True),
        ("other/package.xml", "<package><name>other</name></package>", True),
        ("other/launch/o.launch", "<launch><param name='d' textfile='$(find car)/urdf/arm.urdf'/></launch>", False),
    ],
)
def test_of_a_model_that_nothing_names_beside_one_that_is_started_errors_are_on_request(
    tmp_path: Path, path: str, text: str, is_left_over: bool
) -> None:
    files = {
        ".git/HEAD": "",
        "p/package.xml": "<package><name>car</name></package>",
        "p/launch/start.launch": STARTED,
        "p/urdf/car.urdf": '<robot name="r"><link name="l"/></robot>',
        "p/urdf/arm.urdf": BROKEN,
        "other/package.xml": "<package><name>other</name></package>",
        "other/launch/car.launch": STARTED,
        path: text,
    }
    for place, content in files.items():
        (tmp_path / place).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / place).write_text(content, encoding="utf-8")
    common = ("--format", "json", "--tier", "source")
    run = json.loads(command(".", *common, cwd=tmp_path).stdout)
    assert ("JNT004" in {f["code"] for f in run["findings"]}) != is_left_over
    reasons = [skip["reason"] for skip in run["skipped"] if skip["code"] == SkippedCheck.FINDINGS]
    assert [reason.partition(":")[0] for reason in reasons] == ["left over"] * is_left_over
    for options in (["-v"], ["--pedantic"]):
        assert "JNT004" in command(".", *common, *options, cwd=tmp_path).stdout
    assert '"JNT004"' in command("p/urdf", *common, cwd=tmp_path).stdout, "what uses the other model was not given"
    assert "JNT004" in {
        f["code"] for f in json.loads(command("p/urdf/arm.urdf", *common, cwd=tmp_path).stdout)["findings"]
    }


def check_left_over(folder: Path, files: dict[str, str], place: str) -> bool:
    """Whether the errors of one model were left out as those of a left-over."""
    for name, content in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(content, encoding="utf-8")
    run = json.loads(command(".", "--format", "json", "--tier", "source", cwd=folder).stdout)
    left_out = [skip["model"] for skip in run["skipped"] if skip["code"] == SkippedCheck.FINDINGS]
    assert ("JNT004" in {f["code"] for f in run["findings"] if f["model"].startswith(place)}) != bool(left_out)
    return place in left_out


@pytest.mark.parametrize("named", ["robots", "urdf"])
def test_of_two_models_of_one_name_the_one_in_the_other_folder_is_left_over(tmp_path: Path, named: str) -> None:
    files = {
        "package.xml": "<package><name>car</name></package>",
        "launch/start.launch": STARTED.replace("urdf/car", f"{named}/arm"),
        "robots/arm.urdf": '<robot name="r"><link name="l"/></robot>',
        "urdf/arm.urdf": BROKEN,
    }
    assert check_left_over(tmp_path, files, "urdf/arm.urdf") == (named == "robots")


@pytest.mark.parametrize(
    ("installed", "is_left_over"), [("launch", True), ("launch urdf", False), ("${FOLDERS}", False), ("", False)]
)
def test_a_model_that_is_neither_named_nor_installed_is_left_over(
    tmp_path: Path, installed: str, is_left_over: bool
) -> None:
    install = f"install(DIRECTORY {installed} DESTINATION share/${{PROJECT_NAME}})\n" if installed else ""
    files = {
        "package.xml": "<package><name>car</name><export><build_type>ament_cmake</build_type></export></package>",
        "CMakeLists.txt": f"project(car)\n{install}ament_package()\n",
        "launch/start.launch.py": "",
        "urdf/arm.urdf": BROKEN,
    }
    assert check_left_over(tmp_path, files, "urdf/arm.urdf") == is_left_over


@pytest.mark.parametrize("made_of", ["car.urdf.xacro", "gone.urdf.xacro"])
def test_a_model_called_as_its_package_is_left_over_only_as_output_of_a_xacro_that_is_used(
    tmp_path: Path, made_of: str
) -> None:
    files = {
        "package.xml": "<package><name>car_description</name></package>",
        "launch/start.launch": STARTED.replace("find car)", "find car_description)").replace(
            "car.urdf", "car.urdf.xacro"
        ),
        "urdf/car.urdf.xacro": '<robot name="r"><link name="l"/></robot>',
        "urdf/car.urdf": f"<!-- This document was autogenerated by xacro from {made_of} -->\n{BROKEN}",
    }
    assert check_left_over(tmp_path, files, "urdf/car.urdf") == (made_of == "car.urdf.xacro")


@pytest.mark.parametrize(
    "config",
    [
        "<model><sdf version='1.6'>model.sdf</sdf></model>",
        "<model><sdf>meshes/arm.urdf</sdf></model>",
        "<model><!-- <sdf>model.sdf</sdf> --></model>",
        "",
    ],
)
@pytest.mark.parametrize("header", ["<!-- This document was autogenerated by xacro from gone.urdf.xacro -->", ""])
def test_what_xacro_wrote_into_the_folder_of_a_model_of_gazebo_is_left_over(
    tmp_path: Path, config: str, header: str
) -> None:
    files = {
        ".git/HEAD": "",
        "show.py": "show('boat')",
        "models/boat/model.config": config,
        "models/boat/meshes/arm.urdf": f"{header}\n{BROKEN}".strip(),
    }
    assert check_left_over(tmp_path, files, "models/boat/meshes/arm.urdf") == bool("'1.6'" in config and header)


@pytest.mark.parametrize(("inner", "is_left_over"), [("$(arg hand).xacro", True), ("$(arg hand).urdf", False)])
def test_a_computed_name_that_ends_otherwise_is_not_that_of_the_model(
    tmp_path: Path, inner: str, is_left_over: bool
) -> None:
    include = f"<xacro:arg name='hand' default='h'/><xacro:include filename='{inner}'/><link name='l'/>"
    files = {
        "package.xml": "<package><name>car</name></package>",
        "launch/start.launch": STARTED.replace("car.urdf", "car.urdf.xacro"),
        "urdf/car.urdf.xacro": f'<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">{include}</robot>',
        "urdf/h.xacro": "<robot/>",
        "urdf/h.urdf": "<robot/>",
        "urdf/arm.urdf": BROKEN,
    }
    assert check_left_over(tmp_path, files, "urdf/arm.urdf") == is_left_over


@pytest.mark.parametrize("named", ["urdf/arm.urdf", "backup/arm.urdf", "arm.urdf"])
def test_a_backup_is_kept_aside_although_the_model_of_its_name_is_used(tmp_path: Path, named: str) -> None:
    files = {
        "package.xml": "<package><name>car</name></package>",
        "launch/start.launch": STARTED.replace("urdf/car.urdf", named),
        "urdf/arm.urdf": '<robot name="r"><link name="l"/></robot>',
        "backup/arm.urdf": BROKEN,
    }
    assert check_left_over(tmp_path, files, "backup/arm.urdf") == (named != "backup/arm.urdf")


@pytest.mark.parametrize(("name", "is_meant_to_fail"), [("fail_two_roots.urdf", True), ("two_roots.urdf", False)])
def test_a_robot_that_the_tests_of_a_parser_call_broken_is_kept_aside(
    tmp_path: Path, name: str, is_meant_to_fail: bool
) -> None:
    assert check_left_over(tmp_path, {f"test/{name}": BROKEN}, f"test/{name}") == is_meant_to_fail


def test_what_catkin_installs_by_itself_is_not_checked(tmp_path: Path) -> None:
    (tmp_path / "install_isolated/share").mkdir(parents=True)
    (tmp_path / "install_isolated/share/r.urdf").write_text(BROKEN, encoding="utf-8")
    (tmp_path / "car.urdf").write_text('<robot name="r"><link name="l"/></robot>', encoding="utf-8")
    run = json.loads(command(".", "--format", "json", "--tier", "source", cwd=tmp_path).stdout)
    assert [model["path"] for model in run["models"]] == ["car.urdf"]


@pytest.mark.parametrize("header", ["<!-- This document was autogenerated by xacro from car.urdf.xacro -->", ""])
def test_what_xacro_wrote_for_a_look_beside_tests_is_left_over(tmp_path: Path, header: str) -> None:
    files = {
        "package.xml": "<package><name>car</name></package>",
        "launch/start.launch": STARTED,
        "urdf/car.urdf": '<robot name="r"><link name="l"/></robot>',
        "test/out.urdf": f"{header}\n{BROKEN}".strip(),
    }
    assert check_left_over(tmp_path, files, "test/out.urdf") == bool(header)


@pytest.mark.parametrize("made_of", ["", "urdf/arm.urdf.xacro", "urdf/gone.urdf.xacro"])
def test_where_no_model_is_named_only_output_of_a_xacro_that_is_here_is_left_over(tmp_path: Path, made_of: str) -> None:
    header = (
        f"<!-- |    This document was autogenerated by xacro from /home/ann/ws/src/car/{made_of}    | -->"
        if made_of
        else ""
    )
    files = {
        "package.xml": "<package><name>car</name></package>",
        "urdf/arm.urdf": f"{header}\n{BROKEN}",
        "urdf/arm.urdf.xacro": '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><link name="l"/></robot>',
    }
    (tmp_path / "urdf").mkdir()
    for place, content in files.items():
        (tmp_path / place).write_text(content, encoding="utf-8")
    found = json.loads(command(".", "--format", "json", "--tier", "source", cwd=tmp_path).stdout)["findings"]
    assert ("JNT004" in {f["code"] for f in found}) == (made_of != "urdf/arm.urdf.xacro")


@pytest.mark.parametrize(
    ("script", "is_left_over"),
    [
        ("load('car.urdf')", True),
        ("load('car.urdf', 'arm.urdf')", False),
        ("load('car.urdf'); load(name + '.urdf')", False),
        ("load('part.xacro')", False),
        ("load('car.urdf'); glob('*.urdf')", False),
        ("load('car.urdf', robot='arm')", False),
        ("", False),
    ],
)
def test_outside_packages_a_model_is_left_over_where_the_project_names_another_one(
    tmp_path: Path, script: str, is_left_over: bool
) -> None:
    (tmp_path / ".git").mkdir()
    (tmp_path / "robots").mkdir()
    (tmp_path / "main.py").write_text(script)
    (tmp_path / "robots/car.urdf").write_text('<robot name="r"><link name="l"/></robot>')
    (tmp_path / "robots/arm.urdf").write_text(BROKEN)
    include = (
        '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:include filename="hand.xacro"/></robot>'
    )
    (tmp_path / "robots/bus.urdf.xacro").write_text(include)
    (tmp_path / "robots/hand.xacro").write_text('<robot><link name="l"/></robot>')
    found = json.loads(command(".", "--format", "json", "--tier", "source", cwd=tmp_path).stdout)["findings"]
    assert ("JNT004" in {f["code"] for f in found}) != is_left_over
