"""The baseline: findings of today that count no more, until they are gone."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from conftest import check

from urdfcheck.cli import FAILED, FINDINGS, NOTHING, OK, main
from urdfcheck.core import Severity, UrdfcheckError
from urdfcheck.policy import baseline
from urdfcheck.policy.config_resolver import CliOverrides, ConfigResolver

pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("one_process")]

ROBOT = """<robot name="r">
  <link name="base"/>
  <link name="arm"/>
  <joint name="j" type="revolute">
    <parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>
    <limit lower="1.2" upper="-0.5" effort="10" velocity="1"/>
  </joint>
</robot>
"""
SECOND = """  <link name="hand"/>
  <joint name="k" type="revolute">
    <parent link="arm"/><child link="hand"/><axis xyz="0 0 1"/>
    <limit lower="1" upper="0" effort="10" velocity="1"/>
  </joint>
</robot>
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A repository with one robot of one error, which its baseline knows."""
    (tmp_path / ".git").mkdir()
    (tmp_path / "urdfcheck.toml").write_text('tier = "source"\n')  # it is quicker
    (tmp_path / "urdf").mkdir()
    (tmp_path / "urdf/r.urdf").write_text(ROBOT)
    monkeypatch.chdir(tmp_path)
    assert main(["."]) == FINDINGS
    assert main(["baseline", "write"]) == OK
    return tmp_path


def test_what_is_known_counts_no_more_and_what_is_new_does(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["."]) == OK
    (folder / "urdf/r.urdf").write_text(ROBOT.replace("</robot>\n", SECOND))
    capsys.readouterr()
    assert main([".", "--select", "JNT005"]) == FINDINGS
    shown = " ".join(capsys.readouterr().out.split())
    assert "JNT005 k: " in shown
    assert "joint j" not in shown
    assert "1 in the baseline" in shown


FLAT = """<robot name="r"><link name="base"/><link name="arm"><inertial><mass value="1"/>
<inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="{izz}"/></inertial></link>
<joint name="j" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/></joint></robot>"""


def test_what_has_become_much_worse_is_reported_again(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    robot, known = folder / "urdf/r.urdf", folder / "urdfcheck-baseline.json"
    robot.write_text(FLAT.format(izz="0.03"))
    assert main(["baseline", "write"]) == OK
    (row,) = [row for row in json.loads(known.read_text())["models"]["urdf/r.urdf"] if row["code"] == "INR003"]
    assert row["excess"] == pytest.approx(1 / 3, abs=1e-3)
    for izz, is_worse in (("0.031", False), ("0.09", True), ("0.025", False)):
        robot.write_text(FLAT.format(izz=izz))
        capsys.readouterr()
        assert main([".", "-v", "--select", "INR003"]) == (FINDINGS if is_worse else OK), izz
        shown = " ".join(capsys.readouterr().out.split())
        assert ("become worse since the baseline accepted it" in shown) is is_worse
    # A file that was written without the numbers accepts whatever comes.
    known.write_text(known.read_text().replace('"excess"', '"note"'))
    robot.write_text(FLAT.format(izz="0.09"))
    assert main([".", "--select", "INR003"]) == OK
    plain = known.read_text()
    for wrong in ('"much"', "true", "NaN", "1e999", "1" + "0" * 400):
        known.write_text(plain.replace('"note": ', f'"excess": {wrong}, "note": '))
        capsys.readouterr()
        assert main([".", "--select", "INR003"]) == FAILED, wrong
        assert "not a baseline" in "".join(capsys.readouterr()), wrong


def test_it_survives_moved_lines_and_other_folders(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (folder / "urdf/r.urdf").write_text(ROBOT.replace("<link", "\n\n<!-- moved --> <link"))
    assert main(["."]) == OK
    monkeypatch.chdir(folder / "urdf")
    assert main(["r.urdf"]) == OK
    monkeypatch.chdir("/")
    assert main([str(folder)]) == OK


def test_a_finding_of_another_value_at_the_same_place_is_the_same(folder: Path) -> None:
    (folder / "urdf/r.urdf").write_text(ROBOT.replace('lower="1.2"', 'lower="2.4"'))
    assert main(["."]) == OK


def test_entries_whose_finding_is_gone_are_a_warning_until_they_are_pruned(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A repair fails no build: only who asks for it is strict."""
    (folder / "urdf/r.urdf").write_text(ROBOT.replace('lower="1.2"', 'lower="-1.2"'))
    assert main([".", "--fail-on", "warning"]) == FINDINGS
    capsys.readouterr()
    assert main(["."]) == OK
    assert main(["baseline", "check"]) == OK
    shown = " ".join(capsys.readouterr().out.split())
    assert "URC904" in shown
    assert '{"code": "JNT005", "subject": "joint[j]/limit"' in shown
    assert "urdfcheck-baseline.json:" in shown
    for told in ("removed 1 stale entry, ", "no entry is stale, "):
        assert main(["baseline", "prune"]) == OK
        assert told in capsys.readouterr().out
    assert main(["baseline", "check"]) == OK
    assert "JNT005" not in (folder / baseline.DEFAULT_NAME).read_text()


def test_entries_of_files_that_are_gone_are_stale(folder: Path) -> None:
    (folder / "urdf/r.urdf").rename(folder / "urdf/s.urdf")
    run = check(folder, baseline=baseline.read_baseline(folder / baseline.DEFAULT_NAME, folder))
    assert [f.model for f in run.findings if f.code == "URC904"] == ["urdf/r.urdf"]


def test_what_was_not_looked_for_is_not_gone(folder: Path) -> None:
    (folder / "urdf/r.urdf").write_text(ROBOT.replace('lower="1.2"', 'lower="-1.2"'))
    assert main([".", "--ignore", "JNT005"]) == OK
    (folder / "other.urdf").write_text('<robot name="o"><link name="l"/></robot>')
    assert main(["other.urdf", "--select", "JNT005,URC904"]) == OK
    (folder / "urdf/r.urdf").write_text(ROBOT.replace("</robot>", "</rob>"))
    run = check(folder, baseline=baseline.read_baseline(folder / baseline.DEFAULT_NAME, folder))
    assert not [f for f in run.findings if f.code == "URC904"]


MESH = (
    "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 -1\nvertex 1 0 -1\nvertex 0 1 -1\nendloop\nendfacet\nendsolid\n"
)
MANY = ROBOT.replace(
    "</robot>\n",
    "".join(
        f'  <link name="l{i}"/>\n  <joint name="j{i}" type="fixed"><parent link="arm"/><child link="l{i}"/></joint>\n'
        for i in range(6)
    )
    + "</robot>\n",
)
LAUNCHED = {
    "package.xml": '<package format="2"><name>r</name><version>1.0.0</version><description>r</description>'
    '<maintainer email="a@b.c">a</maintainer><license>MIT</license></package>',
    "r.launch": '<launch><param name="robot_description" textfile="$(dirname)/urdf/r.urdf"/>'
    '<node name="s" pkg="robot_state_publisher" type="state_publisher"/></launch>',
    "urdf/r.urdf": MANY,
    "r.urdf.xacro": MANY.replace("1.2", "1.4"),
}


def test_a_part_of_the_folder_shows_nothing_to_be_gone(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """pre-commit names the files that were changed: not the launch file and the copy that some findings rest on."""
    (folder / "urdfcheck.toml").write_text('tier = "source"\nseverity = { PKG006 = "info", XAC015 = "warning" }\n')
    for name, text in LAUNCHED.items():
        (folder / name).write_text(text)
    assert main(["baseline", "write"]) == OK
    text = (folder / baseline.DEFAULT_NAME).read_text()
    assert all(code in text for code in ("LCH003", "PKG006", "XAC015"))
    assert main(["urdf/r.urdf", "--fail-on", "info"]) == OK
    monkeypatch.chdir(folder / "urdf")
    assert main([".", "--fail-on", "info"]) == OK
    assert main(["baseline", "write", "r.urdf"]) == OK
    assert main(["baseline", "prune"]) == OK
    assert (folder / baseline.DEFAULT_NAME).read_text() == text
    monkeypatch.chdir(folder)
    (folder / "r.launch").write_text(LAUNCHED["r.launch"].replace('type="state', 'type="robot_state'))
    assert main(["urdf", "--fail-on", "warning"]) == OK
    assert main([".", "--fail-on", "warning"]) == FINDINGS


def test_a_lower_tier_that_has_less_to_say_shows_nothing_to_be_gone(folder: Path) -> None:
    """LCH005 knows the height of the ground only where it has read the meshes."""
    (folder / "package.xml").write_text(LAUNCHED["package.xml"])
    (folder / "r.launch").write_text(
        '<launch><param name="robot_description" textfile="$(dirname)/urdf/r.urdf"/>'
        '<node name="f" pkg="tf" type="static_transform_publisher" args="0 0 0 0 0 0 base base_footprint 40"/></launch>'
    )
    (folder / "urdf/m.stl").write_text(MESH)
    shape = '<collision><geometry><mesh filename="m.stl"/></geometry></collision>'
    (folder / "urdf/r.urdf").write_text(ROBOT.replace('<link name="base"/>', f'<link name="base">{shape}</link>'))
    assert main(["baseline", "write", "--pedantic"]) == OK
    assert "LCH005" in (folder / baseline.DEFAULT_NAME).read_text()
    assert main([".", "--tier", "source", "--pedantic"]) == OK


def test_what_a_section_of_the_configuration_ignores_is_not_gone(folder: Path) -> None:
    (folder / "urdfcheck.toml").write_text('[[paths]]\nmatch = ["urdf/**"]\nignore = ["JNT005"]\n')
    assert main(["."]) == OK


def test_another_target_makes_nothing_known_be_gone(folder: Path) -> None:
    """What Drake cannot load is not told to who asks about MuJoCo only."""
    (folder / "urdf/m.stl").write_text(MESH)
    shape = '<collision><geometry><mesh filename="m.stl"/></geometry></collision>'
    (folder / "urdf/r.urdf").write_text(f'<robot name="r"><link name="base">{shape}</link></robot>')
    assert main(["baseline", "write", "--tier", "full", "--target", "drake"]) == OK
    assert "MSH011" in (folder / baseline.DEFAULT_NAME).read_text()
    shown = check(
        folder,
        baseline=baseline.read_baseline(folder / baseline.DEFAULT_NAME, folder),
        targets=("kdl",),
        config_resolver=ConfigResolver(CliOverrides(target=("kdl",))),
    )
    assert not [f for f in shown.findings if f.code in {"MSH011", "URC904"}]


def test_write_keeps_what_it_did_not_look_at(folder: Path) -> None:
    (folder / "other.urdf").write_text(ROBOT)
    assert main(["baseline", "write", "other.urdf"]) == OK
    known = baseline.read_baseline(folder / baseline.DEFAULT_NAME, folder)
    assert set(known.models) >= {"urdf/r.urdf", "other.urdf"}


def test_write_twice_writes_the_same_bytes(folder: Path) -> None:
    before = (folder / baseline.DEFAULT_NAME).read_bytes()
    assert main(["baseline", "write"]) == OK
    assert (folder / baseline.DEFAULT_NAME).read_bytes() == before


def test_known_findings_stay_in_the_json_report(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    capsys.readouterr()
    assert main([".", "--format", "json"]) == OK
    report = json.loads(capsys.readouterr().out)
    (found,) = [f for f in report["findings"] if f["code"] == "JNT005"]
    assert found["suppressed"] == {"kind": "baseline", "reason": "in the baseline"}
    assert report["summary"]["error"] == 0
    assert report["summary"]["suppressed"] > 0


def test_it_knows_each_finding_as_often_as_it_was_there(folder: Path) -> None:
    """Two findings of one subject and message are two: one more of them is new."""
    known = {("XML003", "robot/a", "unknown"): 1}
    again = baseline.Baseline(path=folder / "b.json", root=folder, models={"m": known})
    text = baseline.render_baseline(again.models, {})
    (folder / "b.json").write_text(text)
    assert baseline.read_baseline(folder / "b.json", folder).models == {"m": known}
    (folder / "b.json").write_text(baseline.render_baseline({"m": {("XML003", "robot/a", "unknown"): 2}}, {}))
    assert baseline.read_baseline(folder / "b.json", folder).size == 2


def test_isolated_runs_know_no_baseline_unless_it_is_named(folder: Path) -> None:
    assert main([".", "--isolated"]) == FINDINGS
    assert main([".", "--isolated", "--baseline", baseline.DEFAULT_NAME]) == OK


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "not a baseline"),
        ("[]", "its schema is not"),
        ('{"schema": "urdfcheck-baseline/1"}', "write it again"),
        ('{"schema": "urdfcheck-baseline/1", "models": {"m": [{"code": "A"}]}}', "write it again"),
        (
            '{"schema": "urdfcheck-baseline/1", "models": {"m": [{"code": "A", "subject": "", "message": "", "count": 0}]}}',
            "write it again",
        ),
        ("[" * 100_000, "not a baseline"),
    ],
)
def test_a_broken_file_is_told_in_one_sentence(folder: Path, text: str, said: str) -> None:
    (folder / baseline.DEFAULT_NAME).write_text(text)
    assert main(["."]) == FAILED
    with pytest.raises(UrdfcheckError, match=said):
        baseline.read_baseline(folder / baseline.DEFAULT_NAME, folder)


def test_without_a_baseline_there_is_nothing_to_prune(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["baseline", "prune"]) == FAILED
    assert main(["baseline", "write"]) == NOTHING
    assert main([".", "--baseline", "none.json"]) == FAILED


def test_a_macro_that_is_called_twice_is_known_at_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The same text of the same element is one finding in the end, however often it was found; variants change nothing of it."""
    (tmp_path / ".git").mkdir()
    monkeypatch.chdir(tmp_path)
    (tmp_path / "r.urdf.xacro").write_text(
        '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:arg name="a" default="true"/>'
        '<xacro:macro name="m" params="n"><xacro:property name="y" value="0"/><xacro:property name="y" value="1"/>'
        '<link name="l${n}_${y}"/></xacro:macro><xacro:m n="1"/><xacro:m n="2"/></robot>'
    )
    words = [".", "--tier", "source", "--select", "XAC008", "--fail-on", "info"]
    for more in ([], ["--all-args"]):
        assert main([*words, *more]) == FINDINGS
        assert main(["baseline", "write", *words, *more]) == OK
        assert main([*words, *more]) == OK
        assert main(words) == OK
        (tmp_path / baseline.DEFAULT_NAME).unlink()


def test_a_file_outside_is_not_looked_for(folder: Path) -> None:
    """The baseline may be a stranger's, and whether an entry of it is stale must not tell what exists."""
    rows = [{"code": "INR003", "subject": "link[a]", "message": "violated"}]
    names = ["../there.urdf", "../not.urdf", "/etc/passwd", "/etc/not", "link.urdf", "x" * 5000, "\0", "gone.urdf"]
    (folder.parent / "there.urdf").write_text(ROBOT)
    (folder / "link.urdf").symlink_to("../not.urdf")
    file = folder / "urdfcheck-baseline.json"
    file.write_text(json.dumps({"schema": baseline.SCHEMA, "models": dict.fromkeys(names, rows)}))
    known = baseline.read_baseline(file, folder)
    empty = baseline.BaselineView(findings=(), models=(), complete_rules={}, skipped=())
    assert set(baseline.find_stale_entries(known, empty)) == {"x" * 5000, "gone.urdf"}


def test_each_stale_entry_is_told_at_its_line(folder: Path) -> None:
    keys = [("INR003", f"link[{name}]", "violated") for name in ("\u2028", "b")]
    text = baseline.render_baseline({f"{n}.urdf": dict.fromkeys(keys, 1) for n in (1, 2)}, {})
    file = folder / "urdfcheck-baseline.json"
    file.write_bytes(text.encode())
    known = baseline.read_baseline(file, folder)
    for finding in baseline.report_stale_entries(known, {model: {keys[1]: 1} for model in known.models}):
        span = finding.location.span
        assert span is not None
        assert json.loads(text[span.start : span.end])["subject"] == "link[b]"
        line = text.split("\n")[span.line - 1]
        assert line[span.col - 1 : span.end_col - 1] == text[span.start : span.end]


def test_the_configuration_decides_how_bad_a_stale_entry_is(folder: Path) -> None:
    (folder / "urdf/r.urdf").write_text(ROBOT.replace('"1.2"', '"-1.2"'))
    strict = 'tier = "source"\nstrict-baseline = true\n'
    for text, code in (
        ('tier = "source"\nstrict-baseline = false\n', OK),
        (strict, FINDINGS),
        (f'{strict}[severity]\nURC904 = "info"\n', OK),
        (f'{strict}[severity]\nURC = "warning"\n', OK),
    ):
        (folder / "urdfcheck.toml").write_text(text)
        assert main(["."]) == code, text
        assert main(["baseline", "check"]) == code, text
    (folder / "urdfcheck.toml").write_text(strict)
    assert main([".", "--isolated", "--baseline", baseline.DEFAULT_NAME]) == OK, "a gate heeds no configuration"


def test_a_gate_believes_no_baseline_that_was_not_named(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["baseline", "check", "--isolated"]) == FAILED
    assert "name one with --baseline" in capsys.readouterr().err
    assert main(["baseline", "check", "--isolated", "--baseline", baseline.DEFAULT_NAME]) == OK


def test_the_file_that_is_named_is_made(folder: Path) -> None:
    assert main(["baseline", "write", "--baseline", "known.json"]) == OK
    assert (folder / "known.json").read_text() == (folder / baseline.DEFAULT_NAME).read_text()
    assert main([".", "--isolated", "--baseline", "known.json"]) == OK


def test_models_of_two_configurations_that_are_called_the_same_are_known(folder: Path) -> None:
    for name in ("a", "b"):
        (folder / name / "urdf").mkdir(parents=True)
        (folder / name / "urdfcheck.toml").write_text("")
        (folder / name / "urdf/r.urdf").write_text(ROBOT)
    assert main(["baseline", "write", "--baseline", "known.json"]) == OK
    assert main([".", "--baseline", "known.json"]) == OK


def test_each_configuration_has_its_own_baseline_from_wherever_it_is_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for folder in (tmp_path, tmp_path / "sub"):
        folder.mkdir(exist_ok=True)
        (folder / "urdfcheck.toml").write_text('tier = "source"\n')
        (folder / "r.urdf").write_text(ROBOT)
    monkeypatch.chdir(tmp_path)
    assert main(["baseline", "write"]) == OK
    assert (tmp_path / "sub" / baseline.DEFAULT_NAME).is_file()
    assert main(["."]) == OK
    monkeypatch.chdir(tmp_path / "sub")
    assert main(["."]) == OK
    (tmp_path / "sub/r.urdf").write_text(ROBOT.replace('lower="1.2"', 'lower="-1.2"'))
    assert main([".", "--fail-on", "warning"]) == FINDINGS
    monkeypatch.chdir(tmp_path)
    capsys.readouterr()
    assert main([".", "--fail-on", "warning"]) == FINDINGS
    assert "sub/urdfcheck-baseline.json:" in capsys.readouterr().out
    assert main(["baseline", "prune"]) == OK
    assert main([".", "--fail-on", "warning"]) == OK


def test_without_git_and_configuration_models_are_named_from_the_baseline(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    package = tmp_path / "package"
    package.mkdir()
    (package / "r.urdf").write_text(ROBOT)
    monkeypatch.chdir(package)
    assert main(["baseline", "write"]) == OK
    monkeypatch.chdir(tmp_path)
    assert main(["package"]) == OK


NEEDY = '<robot name="n" xmlns:xacro="http://www.ros.org/wiki/xacro"><link name="$(arg side)"/></robot>'


@pytest.mark.parametrize("action", ["write", "prune"])
def test_why_a_model_was_not_checked_never_goes_into_a_baseline(
    action: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "needy.urdf.xacro").write_text(NEEDY)
    before = (folder / baseline.DEFAULT_NAME).read_text()
    capsys.readouterr()
    assert main(["baseline", action]) == FINDINGS
    assert "1 of 2 models was not checked: the baseline has no entries for it" in capsys.readouterr().err
    assert (folder / baseline.DEFAULT_NAME).read_text() == before
    assert main(["."]) == FINDINGS
    assert main(["baseline", action, "--unchecked", "warning"]) == OK
    assert (folder / baseline.DEFAULT_NAME).read_text() == before


def test_an_old_entry_of_the_cause_hides_nothing_and_is_not_stale(folder: Path) -> None:
    (folder / "needy.urdf.xacro").write_text(NEEDY)
    entry = {"code": "XAC010", "subject": "link@name", "message": "missing"}
    known = json.loads((folder / baseline.DEFAULT_NAME).read_text())
    known["models"]["needy.urdf.xacro"] = [entry]
    (folder / baseline.DEFAULT_NAME).write_text(json.dumps(known))
    run = check(folder, baseline=baseline.read_baseline(folder / baseline.DEFAULT_NAME, folder))
    assert [f.code for f in run.active_findings if f.severity > Severity.INFO] == ["XAC010"]
    assert [m.id for m in run.unchecked_models] == ["needy.urdf.xacro"]


def test_a_hook_that_names_a_file_knows_what_was_accepted_with_the_arguments_of_its_launch_file(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A folder is checked with its launch files, which give the xacro arguments; pre-commit names the xacro alone."""
    xacro = ROBOT.replace("<robot", '<robot xmlns:xacro="http://www.ros.org/wiki/xacro"').replace(
        '<link name="base"/>', '<xacro:arg name="tall" default="false"/><link name="base"/>'
    )
    (folder / "urdf/r.urdf").unlink()
    (folder / "urdf/r.urdf.xacro").write_text(xacro)
    (folder / "package.xml").write_text('<package format="3"><name>p</name><version>1.0.0</version></package>')
    (folder / "launch").mkdir()
    (folder / "launch/show.launch.xml").write_text(
        '<launch><node pkg="robot_state_publisher" exec="robot_state_publisher"><param name="robot_description" '
        "value=\"$(command 'xacro $(find-pkg-share p)/urdf/r.urdf.xacro tall:=true')\"/></node></launch>"
    )
    only = ["--select", "JNT005"]
    for written, checked in ((".", "urdf/r.urdf.xacro"), ("urdf/r.urdf.xacro", ".")):
        (folder / baseline.DEFAULT_NAME).unlink()
        assert main(["baseline", "write", written, *only]) == OK
        known = baseline.read_baseline(folder / baseline.DEFAULT_NAME, folder)
        assert list(known.models) == ["urdf/r.urdf.xacro" + (" tall:=true" if written == "." else "")]
        assert main([written, *only]) == OK
        assert main([checked, *only]) == OK
        capsys.readouterr()
    (folder / "urdf/r.urdf.xacro").write_text(xacro.replace("</robot>\n", SECOND))
    assert main(["urdf/r.urdf.xacro", *only]) == FINDINGS
