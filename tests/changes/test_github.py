"""``urdfcheck diff --format github``: annotations at the lines that caused a change, and the summary of the job."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from changes.test_seams import FILES, compare_packages, write_package
from conftest import command
from versions import ARM, compare

from urdfcheck.cli import OK
from urdfcheck.output.changes import github

LONGER = ARM.replace('<origin xyz="0.3 0 0" rpy="0 0 0"/>', '<origin xyz="0.341 0 0" rpy="0 0 0"/>')
LINE = ARM.splitlines().index('    <origin xyz="0.3 0 0" rpy="0 0 0"/>') + 1


def render(folder: Path, before: str, after: str) -> list[str]:
    for side, text in (("old", before), ("new", after)):
        (folder / side).mkdir()
        (folder / side / "arm.urdf").write_text(text, encoding="utf-8")
    return github.render(compare(folder / "old/arm.urdf", folder / "new/arm.urdf")).splitlines()


def test_each_cause_is_annotated_at_its_new_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    first, second, third, fourth, last = render(
        tmp_path,
        ARM,
        LONGER.replace('effort="40"', 'effort="50"').replace("<mu1>0.8</mu1>", "<mu1>0.9</mu1>"),
    )
    assert first == (
        f"::warning file=new/arm.urdf,line={LINE},endLine={LINE},title=changes the robot%3A motion::"
        "joint wrist moves by 41 mm (x +41 mm) in link fore"
    )
    assert second.startswith("::warning file=new/arm.urdf,")
    assert "effort limit 40 → 50 N·m" in second
    # Only the joint that moved can have parted the hand from what it hangs on.
    assert third.startswith(
        f"::notice file=new/arm.urdf,line={LINE},endLine={LINE},title=what follows for the robot%3A "
    )
    assert "::the neighbours link fore and link hand no longer collide (" in third
    # What no robot feels is a notice.
    assert fourth.startswith("::notice file=new/arm.urdf,")
    assert "gazebo[hand]" in fourth
    assert last.startswith("tool0 moves by 41 mm in every configuration; findings: ")


def test_links_that_collide_now_are_a_warning_at_what_brings_them_together(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    wide = ARM.replace('lower="-0.03" upper="0.01"', 'lower="-0.036" upper="0.01"')
    number = next(n for n, line in enumerate(wide.splitlines(), 1) if 'lower="-0.036"' in line)
    first, *_ = render(tmp_path, ARM, wide)
    assert first.startswith(
        f"::warning file=new/arm.urdf,line={number},endLine={number},title=links collide now::"
        "link left and link right collide now (in "
    )


def test_neighbours_that_overlap_now_are_a_notice(tmp_path: Path) -> None:
    """The hand has 30 mm of its box in the forearm, as in many a robot."""
    lines = render(tmp_path, LONGER, ARM)
    (line,) = (line for line in lines if "collide now" in line)
    assert line.startswith("::notice ")
    assert "the neighbours link fore and link hand collide now" in line
    assert "pair" not in lines[-1]


def test_of_two_possible_causes_none_is_accused(tmp_path: Path) -> None:
    wide = LONGER.replace('lower="-0.03" upper="0.01"', 'lower="-0.036" upper="0.01"')
    first, *_ = render(tmp_path, ARM, wide)
    assert first.startswith("::warning title=links collide now::link left and link right collide now (in ")


def test_a_statement_with_an_old_name_is_a_warning_and_any_other_a_notice(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    model = "urdf/arm.urdf.xacro"
    renamed = FILES[model].replace('"left"', '"finger"').replace('default="finger"', 'default="left"')
    default = FILES["launch/arm.launch"].replace('default="true"', 'default="false"')
    new = write_package(Path("new"), **{model: renamed, "launch/arm.launch": default})
    lines = github.render(compare_packages(write_package(Path("old")), new)).splitlines()
    assert (
        "::warning file=new/config/arm.srdf,line=10,endLine=10,title=still uses the old name::"
        "disabled pair hand and left: link left is called finger now"
    ) in lines
    assert (
        "::notice file=new/launch/arm.launch,line=2,endLine=2,title=changes around the robot%3A launch::"
        "argument gui changes: default 'true' → default 'false'"
    ) in lines


def test_what_was_removed_has_no_line_to_stand_at(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    first, _ = render(
        tmp_path, ARM, ARM.replace("\n    <mu1>0.8</mu1>", "").replace('<gazebo reference="hand">\n  </gazebo>', "")
    )
    assert first.startswith("::notice title=changes the robot%3A other::")
    assert "removed: old/arm.urdf:" in first


def test_a_version_that_gives_no_robot_is_an_error(tmp_path: Path) -> None:
    first, *_ = render(tmp_path, ARM, "<robot")
    assert first.startswith("::error title=not compared::")
    assert "cannot be compared: after: " in first


def test_a_name_cannot_begin_a_command(tmp_path: Path) -> None:
    name = "w%0A::error::x,y:z"
    lines = render(tmp_path, ARM.replace('"wrist"', f'"{name}"'), LONGER.replace('"wrist"', f'"{name}"'))
    assert [line for line in lines if line.startswith("::")] == lines[:-1]
    warned, noticed = lines[0], lines[1:-1]
    assert warned.startswith("::warning file=")
    assert "%250A" in warned
    assert all(line.startswith("::notice file=") for line in noticed)


@pytest.mark.slow
def test_files_of_a_revision_are_named_as_in_a_checkout_and_the_summary_has_the_verdict(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def git(*words: str) -> None:
        subprocess.run(["git", "-c", "user.name=a", "-c", "user.email=a@b", *words], cwd=tmp_path, check=True)

    git("init", "-q", "-b", "main")
    for text in (ARM, LONGER):
        (tmp_path / "robots").mkdir(exist_ok=True)
        (tmp_path / "robots/arm.urdf").write_text(text, encoding="utf-8")
        git("add", "-A")
        git("commit", "-q", "-m", "x")
    summary = tmp_path / "summary.md"
    summary.write_text("before\n")
    monkeypatch.setenv("GITHUB_STEP_SUMMARY", str(summary))
    quick = ("--tier", "source", "--select", "INR003", "--no-cache")
    page, picture = tmp_path / "out/diff.html", tmp_path / "out/diff.png"
    words = ("diff", "HEAD~..HEAD", "--format", "github", "-o", f"html={page}", "-o", f"png={picture}", *quick)
    done = command(*words, cwd=tmp_path)
    assert (done.returncode, done.stderr) == (OK, "")
    assert done.stdout.startswith(f"::warning file=robots/arm.urdf,line={LINE},")
    assert summary.read_text(encoding="utf-8").startswith("before\n### 🔀 `robots/arm.urdf`: tool0 moves by 41 mm")
    assert "<!-- urdfcheck diff -->" not in summary.read_text(encoding="utf-8")
    assert f"HEAD:robots/arm.urdf:{LINE}" in page.read_text(encoding="utf-8")
    assert picture.read_bytes().startswith(b"\x89PNG")
    # Nothing to draw is no failure.
    git("commit", "-q", "--allow-empty", "-m", "x")
    done = command("diff", "HEAD~..HEAD", "-o", f"png={tmp_path / 'none.png'}", *quick, cwd=tmp_path)
    assert (done.returncode, done.stdout) == (OK, "identical: no robot uses a file that differs\n")
    assert "none.png: not written, there is no robot to draw" in done.stderr


def test_a_report_replaces_no_model(tmp_path: Path) -> None:
    (tmp_path / "a.urdf").write_text(ARM)
    done = command("diff", "a.urdf", "a.urdf", "-o", "html=b.urdf", cwd=tmp_path)
    assert "that is the file of a model" in done.stderr
    done = command("diff", "a.urdf", "a.urdf", "-o", "html=pages/", cwd=tmp_path)
    assert "a comparison is one page" in done.stderr
    done = command("diff", "a.urdf", "a.urdf", "-o", "sarif=b.sarif", cwd=tmp_path)
    assert "write FORMAT=FILE with one of the formats text, json, markdown, html, github, png" in done.stderr
