"""``--watch``: the same verdicts as a check after each save, whatever happens to the files meanwhile."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from conftest import command, make_request

from urdfcheck import cli
from urdfcheck.cli import watch

pytestmark = [pytest.mark.slow, pytest.mark.long]

SOUND = '<robot name="r"><link name="base"/></robot>'
BROKEN = (
    '<robot name="r"><link name="a"><inertial><mass value="1"/>'
    '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="9"/></inertial></link></robot>'
)
MAIN = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:include filename="part.xacro"/></robot>'


class Watching:
    """A watch that runs, and what it prints."""

    def __init__(self, process: subprocess.Popen[str]) -> None:
        self.process = process

    def told(self) -> str:
        """Everything up to the end of the next check."""
        assert self.process.stdout is not None
        lines: list[str] = []
        for line in self.process.stdout:
            lines.append(line)
            if line.startswith("watching "):
                break
        return "".join(lines)

    def interrupted(self) -> int:
        self.process.send_signal(signal.SIGINT)
        return self.process.wait(timeout=20)


@contextmanager
def watching(folder: Path, *words: str) -> Iterator[Watching]:
    process = subprocess.Popen(
        [sys.executable, "-m", "urdfcheck", ".", "--watch", "--tier", "source", *words],
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        encoding="utf-8",
    )
    try:
        yield Watching(process)
    finally:
        process.kill()
        process.wait()
        assert process.stdout is not None
        process.stdout.close()


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no SIGINT for one process")
def test_each_save_is_checked_until_the_user_interrupts(tmp_path: Path) -> None:
    """What happens to a file, what the head says of it, and what the check finds."""
    main, part, config = tmp_path / "main.xacro", tmp_path / "part.xacro", tmp_path / "urdfcheck.toml"
    main.write_text(MAIN)
    with watching(tmp_path, "--select", "INR003,XML,XAC001", "-o", "json=report.json") as seen:
        assert "XAC001" in (first := seen.told())
        assert "\x1b" not in first, "no screen is cleared where there is none"
        part.write_text(BROKEN.replace("<robot", '<robot xmlns:xacro="http://www.ros.org/wiki/xacro"'))
        assert "changed: part.xacro\n" in (told := seen.told()), "a file that was missed appears"
        assert "part.xacro:1:" in told
        assert "INR003" in told
        part.write_text(BROKEN[:90])
        assert "⊘ 1 of 1 model was not checked" in seen.told(), "half a file"
        part.unlink()
        main.write_text(SOUND.replace("<robot", '<robot xmlns:xacro="http://www.ros.org/wiki/xacro"'))
        assert "✔ no errors, no warnings · 1 model" in seen.told()
        (tmp_path / "new.urdf").write_text(BROKEN)
        assert "INR003" in seen.told(), "a new file"
        config.write_text('selct = ["INR"]')
        assert "urdfcheck.toml:1: unknown key 'selct'" in seen.told()
        config.write_text('ignore = ["INR003"]')
        assert "✔ no errors, no warnings · 2 models" in seen.told()
        config.unlink()
        assert "INR003" in seen.told()
        assert seen.interrupted() == cli.FINDINGS, "the exit code of the last check"
    assert (tmp_path / "report.json").is_file()


def test_only_reports_that_rest_on_files_that_changed_are_made_anew(tmp_path: Path) -> None:
    from urdfcheck.run.pipeline import IN_THIS_PROCESS, Execution, keep_valid_reports, run_audit
    from urdfcheck.run.unit_audit import audit_unit

    for name in ("a", "b"):
        (tmp_path / f"{name}.urdf").write_text(SOUND)
    request = make_request(tmp_path, tier="source")
    before = run_audit(request, IN_THIS_PROCESS)
    (tmp_path / "a.urdf").write_text(BROKEN)
    kept = keep_valid_reports(before, request)
    assert kept is not None
    checked: list[str] = []
    execution = Execution(audit=lambda unit, settings: checked.append(unit.id) or audit_unit(unit, settings))
    run_audit(request, execution, previous=kept)
    assert checked == ["a.urdf"]


def test_a_report_that_is_written_among_the_models_is_no_change(tmp_path: Path) -> None:
    model, report = tmp_path / "r.urdf", tmp_path / "r.json"
    model.write_text(SOUND)
    seen = watch._read_stamps([str(model), str(tmp_path), str(report)])
    report.write_text("{}")
    os.utime(tmp_path, (1, 1))
    known = watch._exclude_written(seen, [report])
    assert not watch._list_differing(known, watch._read_stamps(known))
    model.write_text(BROKEN)
    assert watch._list_differing(known, watch._read_stamps(known)) == [str(model)]


def test_there_must_be_something_to_watch(tmp_path: Path) -> None:
    done = command("--watch", str(tmp_path / "nope"))
    assert (done.returncode, done.stderr) == (
        2,
        f"urdfcheck: {tmp_path / 'nope'}: does not exist, so there is nothing to watch\n",
    )
