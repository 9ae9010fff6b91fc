"""``urdfcheck diff`` as a command and from Python: formats, exit codes, folders, and what cannot be read."""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import replace
from importlib.resources import files
from pathlib import Path

import pytest
from conftest import command
from jsonschema import Draft202012Validator
from referencing import Registry, Resource
from versions import ARM, compare

import urdfcheck
from urdfcheck.cli import FAILED, FINDINGS, OK
from urdfcheck.core.model_diff import SeamChange
from urdfcheck.output.changes import json as json_output
from urdfcheck.output.changes import text as text_output

pytestmark = pytest.mark.slow

QUICK = ("--tier", "source", "--select", "INR003", "--no-cache")
LONGER = ARM.replace('<origin xyz="0.3 0 0" rpy="0 0 0"/>', '<origin xyz="0.341 0 0" rpy="0 0 0"/>')
HEAVIER = ARM.replace('<mass value="0.6"/>', '<mass value="0.65"/>')
STRONGER = ARM.replace('effort="40"', 'effort="50"')
TURNED = ARM.replace(
    '<origin xyz="0.1 0 0" rpy="0 0 0"/>', '<origin xyz="0.1 0 0" rpy="1.57 0 0"/>'
)  # stays at its place
SHUFFLED = ARM.replace('"2.0"', '"2.5"').replace('"1.5"', '"1.0"')  # as heavy
IMPOSSIBLE = ARM.replace('ixx="0.0006"', 'ixx="0.006"')


def write(path: Path, text: str) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
    return path


def validate(document: str) -> dict[str, object]:
    """Check a document against the schema and return it."""
    report, schema = (
        json.loads((files("urdfcheck.output") / f"{name}.schema.json").read_text(encoding="utf-8"))
        for name in ("report", "diff")
    )
    registry = Registry().with_resource("report.schema.json", Resource.from_contents(report))
    found: dict[str, object] = json.loads(document)
    Draft202012Validator(schema, registry=registry).validate(found)
    return found


@pytest.fixture(name="folder")
def make_folder(tmp_path: Path) -> Path:
    write(tmp_path / "a.urdf", ARM)
    write(tmp_path / "longer.urdf", LONGER)
    write(tmp_path / "heavier.urdf", HEAVIER)
    write(tmp_path / "stronger.urdf", STRONGER)
    write(tmp_path / "turned.urdf", TURNED)
    write(tmp_path / "shuffled.urdf", SHUFFLED)
    return tmp_path


# -- the command -------------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_the_text_begins_with_the_verdict_and_names_the_lines(folder: Path) -> None:
    done = command("diff", "a.urdf", "longer.urdf", *QUICK, cwd=folder)
    lines = done.stdout.splitlines()
    assert (done.returncode, done.stderr) == (OK, "")
    assert lines[0] == "tool0 moves by 41 mm in every configuration"
    number = ARM.splitlines().index('    <origin xyz="0.3 0 0" rpy="0 0 0"/>') + 1
    assert f'    - a.urdf:{number}  <origin xyz="0.3 0 0" rpy="0 0 0"/>' in lines
    assert f'    + longer.urdf:{number}  <origin xyz="0.341 0 0" rpy="0 0 0"/>' in lines
    assert len(lines) <= 10


@pytest.mark.usefixtures("one_process")
@pytest.mark.parametrize(
    ("after", "options", "code"),
    [
        ("longer", (), OK),
        ("longer", ("--fail-on", "kinematic"), FINDINGS),
        ("longer", ("--fail-on", "dynamic,limits"), OK),
        ("longer", ("--fail-on", "any"), FINDINGS),
        ("longer", ("--max-tool-shift", "40mm"), FINDINGS),
        ("longer", ("--max-tool-shift", "0.05m"), OK),
        ("longer", ("--max-tool-shift", "5cm", "--fail-on", "any"), OK),
        ("heavier", ("--fail-on", "dynamic"), FINDINGS),
        ("heavier", ("--fail-on", "dynamic", "--max-mass", "1%"), OK),
        ("heavier", ("--max-mass", "0.1%"), FINDINGS),
        ("heavier", ("--max-mass", "100g"), OK),
        ("heavier", ("--max-mass", "0.01kg"), FINDINGS),
        ("stronger", ("--fail-on", "limits"), FINDINGS),
        ("stronger", ("--fail-on", "kinematic", "--fail-on", "collision"), OK),
        ("stronger", ("--fail-on", "any,never"), FINDINGS),
        ("a", ("--fail-on", "any"), OK),
        ("turned", ("--max-tool-shift", "1mm", "--fail-on", "kinematic"), FINDINGS),
        ("shuffled", ("--max-mass", "1%", "--fail-on", "dynamic"), FINDINGS),
    ],
)
def test_the_exit_code_follows_what_fails(folder: Path, after: str, options: tuple[str, ...], code: int) -> None:
    assert command("diff", "a.urdf", f"{after}.urdf", *options, *QUICK, cwd=folder).returncode == code


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--fail-on", "warning"), "--fail-on warning: one or more of kinematic"),
        (("--max-tool-shift", "1"), "--max-tool-shift 1: write a number with one of the units m, cm"),
        (("--max-tool-shift", "1.2.3mm"), "--max-tool-shift 1.2.3mm: write a number"),
        (("--max-mass", "1e999kg"), "--max-mass 1e999kg: write a number"),
        (("--max-mass", "1lb"), "--max-mass 1lb: write a number with one of the units kg, g, %"),
    ],
)
def test_a_wrong_option_is_refused(folder: Path, options: tuple[str, ...], said: str) -> None:
    done = command("diff", "a.urdf", "a.urdf", *options, cwd=folder)
    assert done.returncode == FAILED
    assert said in done.stderr


@pytest.mark.usefixtures("one_process")
def test_json_follows_its_schema(folder: Path) -> None:
    done = command("diff", "a.urdf", "heavier.urdf", "--format", "json", *QUICK, cwd=folder)
    found = validate(done.stdout)
    assert (found["schema"], found["verdict"], found["failures"]) == ("urdfcheck-diff/1", "dynamic", [])


def test_effects_and_files_around_models_follow_the_schema(folder: Path) -> None:
    seam = SeamChange(kind="srdf", id="removed", subject="joint a of group g", text="joint a of group g is gone")
    found = replace(compare(folder / "a.urdf", folder / "longer.urdf"), seams=(seam,))
    document = validate(json_output.render(found))
    (model,) = document["models"]  # type: ignore[misc]
    assert [effect["id"] for effect in model["effects"]] == ["pair-clears"]  # type: ignore[index]
    assert model["collisions"]["pairs"] == 12  # type: ignore[index]
    assert [one["text"] for one in document["seams"]] == [seam.text]  # type: ignore[attr-defined]


@pytest.mark.slow
def test_python_does_what_the_command_does(folder: Path) -> None:
    found = urdfcheck.diff(folder / "a.urdf", folder / "longer.urdf", select="INR003", tier="source", cache=False)
    assert isinstance(found, urdfcheck.Diff)
    assert (found.verdict, found.failures) == ("kinematic", ())
    assert [model.headline for model in found.models] == ["tool0 moves by 41 mm in every configuration"]
    with pytest.raises(urdfcheck.UrdfcheckError, match="no such file"):
        urdfcheck.diff(folder / "a.urdf", folder / "absent.urdf")


# -- what cannot be read -----------------------------------------------------------------------------------------------


@pytest.mark.usefixtures("one_process")
@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("<robot name='r'><link name='a'/>", "closed"),
        ("", "empty"),
        ("<robot name='r'><link name='a'/><link name='b'/></robot>", "2 roots"),
        (ARM.replace('xyz="0.3 0 0"', 'xyz="0.3 zero 0"'), "the origin of joint 'wrist' is malformed"),
        (ARM.replace('<axis xyz="1 0 0"/>', '<axis xyz="0 0 0"/>'), "the axis of joint 'wrist' is malformed or zero"),
    ],
)
@pytest.mark.parametrize("is_first", [False, True], ids=["after", "before"])
def test_a_version_that_gives_no_robot_fails(folder: Path, text: str, said: str, is_first: bool) -> None:
    write(folder / "broken.urdf", text)
    names = ["broken.urdf", "a.urdf"] if is_first else ["a.urdf", "broken.urdf"]
    done = command("diff", *names, *QUICK, cwd=folder)
    assert done.returncode == FAILED
    assert done.stdout.startswith(f"cannot be compared: {'before' if is_first else 'after'}: ")
    assert said in done.stdout
    assert "Traceback" not in done.stdout + done.stderr
    validate(command("diff", *names, "--format", "json", *QUICK, cwd=folder).stdout)


@pytest.mark.usefixtures("one_process")
def test_what_a_broken_version_had_is_not_gone(folder: Path) -> None:
    names = '<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">\n  <xacro:arg name="side" default="left"/>'
    before = ARM.replace('<robot name="arm">', names).replace('ixx="0.0006"', 'ixx="0.006"')
    write(folder / "old/arm.urdf.xacro", before)
    write(folder / "new/arm.urdf.xacro", before.replace("</robot>", "<xacro:absent/></robot>"))
    found = validate(command("diff", "old", "new", "--format", "json", *QUICK, cwd=folder).stdout)
    assert found["seams"] == []
    assert isinstance(counts := found["findings"], dict)
    assert [finding["code"] for finding in counts["new"]] == ["XAC001"]
    assert (counts["gone"], counts["unchanged"], counts["unchecked"]) == ([], 0, 1)
    text = command("diff", "old", "new", *QUICK, cwd=folder).stdout
    assert "findings: 1 new, 0 gone, 0 unchanged, 1 unknown (the model is not checked now)\n" in text


@pytest.mark.usefixtures("one_process")
def test_a_path_that_does_not_exist_fails(folder: Path) -> None:
    done = command("diff", "a.urdf", "absent.urdf", cwd=folder)
    assert (done.returncode, done.stdout) == (FAILED, "")
    assert "absent.urdf: there is no such file or folder" in done.stderr
    (folder / "empty").mkdir()
    done = command("diff", "empty", "empty", cwd=folder)
    assert (done.returncode, done.stdout) == (FAILED, "")
    assert "no model to compare" in done.stderr


# -- folders -----------------------------------------------------------------------------------------------------------


def test_models_of_folders_are_matched_by_path_then_name_then_structure(tmp_path: Path) -> None:
    other = '<robot name="cart"><link name="chassis"/></robot>'
    write(tmp_path / "old/urdf/arm.urdf", ARM)
    write(tmp_path / "old/urdf/cart.urdf", other)
    write(tmp_path / "old/urdf/left.urdf", LONGER.replace('robot name="arm"', 'robot name="left"'))
    write(tmp_path / "old/urdf/same.urdf", other.replace("cart", "same"))
    write(tmp_path / "new/urdf/arm.urdf", HEAVIER)
    write(tmp_path / "new/robots/cart.urdf", other)
    write(tmp_path / "new/urdf/right.urdf", LONGER.replace('robot name="arm"', 'robot name="right"'))
    write(tmp_path / "new/urdf/extra.urdf", '<robot name="extra"><link name="new"/></robot>')
    diff = compare(tmp_path / "old", tmp_path / "new")
    names = [
        (Path(m.before).name if m.before else "", Path(m.after).name if m.after else "", m.matched_by, m.verdict)
        for m in diff.models
    ]
    assert names == [
        ("arm.urdf", "arm.urdf", "path", "dynamic"),
        ("cart.urdf", "cart.urdf", "name", "identical"),
        ("left.urdf", "right.urdf", "structure", "extension"),
        ("same.urdf", "", "path", "structure"),
        ("", "extra.urdf", "path", "structure"),
    ]
    shown = text_output.render(diff)
    assert "1 model is identical" in shown
    assert "the model is gone" in shown
    assert "the model is new" in shown
    validate(json_output.render(diff))


def test_findings_are_new_gone_and_unchanged_under_new_names(tmp_path: Path) -> None:
    """A finding about a link that is renamed is the same finding."""
    broken = ARM.replace('ixx="1e-05"', 'ixx="1e-03"', 1)
    renamed = broken.replace('"left"', '"finger_1"').replace('ixx="0.0006"', 'ixx="0.006"')
    write(tmp_path / "a/arm.urdf", broken)
    write(tmp_path / "b/arm.urdf", renamed)
    there = compare(tmp_path / "a/arm.urdf", tmp_path / "b/arm.urdf").findings
    back = compare(tmp_path / "b/arm.urdf", tmp_path / "a/arm.urdf").findings
    assert [finding.subjects for finding in there.new] == [("link[hand]/inertial/inertia",)]
    assert [finding.subjects for finding in back.gone] == [("link[hand]/inertial/inertia",)]
    assert (there.gone, back.new) == ((), ())
    assert (there.unchanged, back.unchanged) == (1, 1)


def test_no_path_of_the_machine_is_shown(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    write(tmp_path / "a/arm.urdf", ARM)
    write(tmp_path / "b/arm.urdf", LONGER)
    diff = compare(Path("a/arm.urdf"), Path("b/arm.urdf"))
    assert str(tmp_path) not in text_output.render(diff, show_all=True) + json_output.render(diff)


def test_names_of_files_cannot_act_on_a_terminal(tmp_path: Path) -> None:
    hostile = ARM.replace('"hand"', '"ha\x7fnd::error::x"')
    write(tmp_path / "a/arm.urdf", hostile)
    write(tmp_path / "b/arm.urdf", hostile.replace('<mass value="0.6"/>', '<mass value="0.7"/>'))
    shown = text_output.render(compare(tmp_path / "a/arm.urdf", tmp_path / "b/arm.urdf"), show_all=True)
    assert "\x7f" not in shown
    assert "\\x7f" in shown


# -- the start ---------------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_the_process_of_the_command_loads_nothing_heavy(folder: Path) -> None:
    """Models are read and compared in workers."""
    words = ["diff", "a.urdf", "longer.urdf", *QUICK]
    script = f"import sys\nfrom urdfcheck.cli import main\nmain({words!r})\nprint(' '.join(sys.modules))"
    done = subprocess.run([sys.executable, "-c", script], cwd=folder, capture_output=True, text=True, check=True)
    loaded = {name.split(".")[0] for name in done.stdout.splitlines()[-1].split()}
    assert not loaded & {"numpy", "scipy", "pinocchio", "coal", "trimesh", "rich", "yaml", "xacro"}
