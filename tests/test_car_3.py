"""The robot that the project grew from: everything that is wrong with its four files is said, where it was typed.

``fixtures/car-3`` holds the files as their author left them, ``fixtures/car-3-fixed`` what should have been written.
"""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest
from conftest import FIXTURES, check

from urdfcheck.core import Applicability, Finding, Run, Severity
from urdfcheck.core.headlines import LONGEST_HEADLINE
from urdfcheck.output.html.sections.launch_section import render_launch_files
from urdfcheck.output.shared.anchors import build_finding_cards

XACRO = "robot_description/urdf/car_body.urdf.xacro"
GAZEBO = "robot_description/urdf/gazebo.urdf.xacro"
URDF = "urdf/car-3.urdf"
LAUNCH = "launch/car.launch"

# code, file, line of the typed text, words that the message, the cause or the repair must contain
SAID: list[tuple[str, str, int, tuple[str, ...]]] = [
    ("SYM001", XACRO, 91, ("wheel_1_to_base_link", "43.11", "own axis", "20.9", "`0 0 0`", "CAD")),
    ("SYM001", URDF, 88, ("wheel_1_to_base_link", "43.11", "own axis", "20.9", "`0 0 0`", "CAD")),
    ("JNT013", XACRO, 197, ("3.1416", "7.3", "wheel_4", "${pi}")),
    ("JNT013", URDF, 194, ("3.1416", "7.3", "wheel_4", "3.141592653589793")),
    ("INR016", XACRO, 13, ("1000",)),
    ("INR016", URDF, 10, ("1000",)),
    ("KIN008", XACRO, 8, ("base_link",)),
    ("KIN008", URDF, 5, ("base_link",)),
    ("XAC002", XACRO, 5, ("base_x", "0.180")),
    ("XAC002", XACRO, 6, ("base_y", "0.094")),
    ("XAC005", XACRO, 3, ("M_PI", "3.14159", "6 digits")),
    ("XAC006", XACRO, 2, ("http://ros.org/wiki/xacro in 2 files", "http://www.ros.org/wiki/xacro")),
    (
        "XAC009",
        XACRO,
        46,
        ("only wheel_1 has pitch -0.75239", 'params="name x y"', "this drops pitch -0.75239 of wheel_1"),
    ),
    ("NAM003", XACRO, 2, ("car_body",)),
    ("PKG006", "package.xml", 3, ("car-3",)),
    ("CTL002", XACRO, 2, ("wheel_1_to_base_link",)),
    ("GZB002", GAZEBO, 5, ("Gazebo/Blue",)),
    ("LCH002", LAUNCH, 19, ("-unpause",)),
    ("LCH003", LAUNCH, 16, ("state_publisher",)),
    ("XAC014", LAUNCH, 13, ("--inorder",)),
    ("LCH004", LAUNCH, 11, ("model",)),
    ("LCH005", LAUNCH, 18, ("base_footprint", "0.03")),
    ("LCH007", LAUNCH, 21, ("calibrat",)),
    ("LCH007", LAUNCH, 14, ("use_gui",)),
    ("LCH007", LAUNCH, 8, ("headless",)),
    ("XAC015", URDF, 2, ("car-3", "car_body")),
]


@pytest.fixture(scope="module")
def run() -> Run:
    return check(FIXTURES / "car-3", scene=True)


def place(finding: Finding) -> tuple[str, int]:
    span = finding.location.span
    assert span is not None
    return Path(span.file).resolve().relative_to(FIXTURES / "car-3").as_posix(), span.line


def words(finding: Finding) -> str:
    parts = [finding.message, *finding.consequences.values()]
    parts += [finding.cause.text] if finding.cause else []
    if finding.fix:
        parts += [finding.fix.title, *(e.replacement for e in finding.fix.edits)]
    return "\n".join(parts)


@pytest.mark.parametrize(
    ("code", "file", "line", "said"), SAID, ids=lambda v: str(v) if not isinstance(v, tuple) else ""
)
def test_it_says(run: Run, code: str, file: str, line: int, said: tuple[str, ...]) -> None:
    everywhere = [own for f in run.findings for own in f.list_occurrences()]
    found = [f for f in everywhere if f.code == code and place(f) == (file, line)]
    assert found, [place(f) for f in run.findings if f.code == code]
    text = "\n".join(words(f) for f in found)
    for word in said:
        assert word in text


def test_every_finding_has_its_headline_its_consequence_and_its_repair(run: Run) -> None:
    for finding in run.findings:
        assert 0 < len(finding.headline) <= LONGEST_HEADLINE
        assert finding.consequences, finding.code
        assert finding.fix is not None, finding.code
        assert finding.fix.title, finding.code


def test_noise_is_one_finding_per_link_at_most(run: Run) -> None:
    for code in ("JNT014", "INR014"):
        found = [(f.model, s.split("/")[0]) for f in run.findings if f.code == code for s in f.subjects]
        assert found, code
        assert len(found) == len(set(found)), code


def test_five_unnamed_materials(run: Run) -> None:
    for file in (XACRO, URDF):
        found = [f for f in run.findings if f.code == "XML012" and place(f)[0] == file]
        places = {place(f)[1] for f in found} | {r.span.line for f in found for r in f.related if r.span is not None}
        assert len(places) == 5


def test_meshes_as_collision(run: Run) -> None:
    assert {place(f)[0] for f in run.findings if f.code == "GEO004"} == {XACRO, URDF}


def test_axes_that_are_right_are_not_flagged(run: Run) -> None:
    """Axis 0 -1 0 with yaw π: all four wheels turn about +y in base coordinates."""
    assert not [f for f in run.findings if f.code in {"SYM005", "JNT002", "JNT016"}]


def test_nothing_is_an_error_but_what_stops_the_robot_from_spawning(run: Run) -> None:
    assert {f.code for f in run.findings if f.severity is Severity.ERROR} == {"LCH002"}


def test_nothing_failed_and_nothing_was_checked_twice(run: Run) -> None:
    assert not run.failures
    assert [m.path.split("/")[-1] for m in run.models] == ["car_body.urdf.xacro", "car-3.urdf"]
    assert len({(f.code, f.message_id, f.model, f.location) for f in run.findings}) == len(run.findings)


@pytest.mark.parametrize("file", [XACRO, URDF])
def test_the_edit_of_SYM001_repairs_it(run: Run, file: str, tmp_path: Path) -> None:
    folder = tmp_path / "car-3"
    shutil.copytree(FIXTURES / "car-3", folder)
    finding = next(f for f in run.findings if f.code == "SYM001" and place(f)[0] == file)
    assert finding.fix is not None
    assert finding.fix.applicability is Applicability.UNSAFE
    (edit,) = finding.fix.edits
    text = (folder / file).read_text()
    assert text[edit.span.start : edit.span.end] == edit.expected == "0 -0.75239 0"
    (folder / file).write_text(text[: edit.span.start] + edit.replacement + text[edit.span.end :])
    assert "SYM001" not in {f.code for f in check(folder / file).findings}


def test_the_gazebo_file_is_reached_through_the_include_and_the_macro_call(run: Run) -> None:
    finding = next(f for f in run.findings if f.code == "GZB002")
    assert [v.line for v in finding.location.via] == [258]


def test_the_launch_file_is_drawn_with_what_is_wrong_in_it(run: Run) -> None:
    scene = next(scene for scene in run.scenes if scene.launches)
    drawn = render_launch_files(scene, build_finding_cards(f for f in run.findings if f.model == scene.model))
    boxes = re.findall(r'<g class="node ([^"]*)"><title>.*?<text[^>]*>([^<]*)<', drawn)
    assert {name: kind for kind, name in boxes if " " in kind} == {
        "empty_world.launch": "launch-file info",
        "/robot_state_publisher": "node warning",
        "/tf_footprint_base": "node warning",
        "/spawn_model": "node error",
        "/fake_joint_calibration": "node info",
        "/robot_description": "parameter info",
    }
    assert {"/joint_state_publisher", "/rviz"} <= {name for kind, name in boxes if kind == "node"}


def test_the_fixed_car_has_no_error_and_no_warning() -> None:
    outcome = check(FIXTURES / "car-3-fixed")
    assert not outcome.failures
    assert [m.status for m in outcome.models] == ["checked"]
    assert [(f.code, f.message) for f in outcome.findings if f.severity >= Severity.WARNING] == []
