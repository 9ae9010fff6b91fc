"""``urdfcheck diff --format github``: annotations at the lines that caused a change, and the summary of the job."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
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
    first, second, third, last = render(
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
    # What no robot feels is a notice.
    assert third.startswith("::notice file=new/arm.urdf,")
    assert "gazebo[hand]" in third
    assert last.startswith("tool0 moves by 41 mm in every configuration; findings: ")


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
    assert all(line.startswith("::warning file=") and "%250A" in line for line in lines[:-1])


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
