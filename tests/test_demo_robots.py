"""The demo robots: every planted defect is found where it was planted, and nothing else; the sound robots are clean."""

from __future__ import annotations

import subprocess
import sys
from collections import Counter
from pathlib import Path

import pytest
import tomli
from conftest import REPOSITORY, check

from urdfcheck.cli import FAILED, OK, main
from urdfcheck.cli.demo_robots import (
    ANSWERS,
    DemoRobot,
    PlantedDefect,
    copy_demo_robot,
    load_demo_robots,
    plant_defect,
    read_demo_robot,
)
from urdfcheck.core import Finding, Severity, UrdfcheckError

ROBOTS = load_demo_robots()

pytestmark = pytest.mark.slow


def list_places(finding: Finding, folder: Path) -> set[tuple[str, int]]:
    """Files relative to a folder, and lines: of a finding, of the calls that lead to it, and of what it depends on."""
    located = [*finding.related, *([] if finding.location is None else [finding.location])]
    spans = [span for place in located for span in (place.span, *place.via) if span is not None]
    return {
        (Path(span.file).resolve().relative_to(folder).as_posix(), line)
        for span in spans
        for line in range(span.line, span.end_line + 1)
    }


def list_names(finding: Finding) -> str:
    """What a finding is about, in one text."""
    file = finding.location.span.file if finding.location and finding.location.span else ""
    return " ".join((finding.headline, finding.message, *finding.subjects, str(file)))


def find_planted_lines(defect: PlantedDefect, folder: Path) -> set[tuple[str, int]]:
    """The lines of a defect that the sound robot does not have; none for lines that are missing."""
    text = (folder / defect.file).read_text(encoding="utf-8")
    first = text[: text.index(defect.planted)].count("\n") + 1
    sound = Counter(defect.sound.splitlines())
    return {
        (defect.file, number) for number, line in enumerate(defect.planted.splitlines(), first) if line not in sound
    }


@pytest.mark.parametrize("robot", ROBOTS.values(), ids=ROBOTS)
def test_every_planted_defect_is_one_finding_and_there_is_no_other(robot: DemoRobot, tmp_path: Path) -> None:
    copy_demo_robot(robot, tmp_path)
    run = check(tmp_path)
    assert not run.failures
    assert not run.unchecked_models
    found = [f for f in run.active_findings if f.severity > Severity.INFO]
    assert Counter(f.code for f in found) == Counter(d.code for d in robot.defects)
    for defect in robot.defects:
        named = [f for f in found if f.code == defect.code and defect.subject in list_names(f)]
        assert len(named) == 1, defect
        planted = find_planted_lines(defect, tmp_path)
        assert not planted or planted & list_places(named[0], tmp_path), defect


def test_the_sound_robots_are_clean(tmp_path: Path) -> None:
    for robot in ROBOTS.values():
        copy_demo_robot(robot, tmp_path / robot.name, is_sound=True)
    run = check(tmp_path)
    assert len(run.models) >= len(ROBOTS)
    assert [f"{f.code} {f.headline}" for f in run.active_findings] == []
    assert not run.failures
    assert not run.unchecked_models


def test_the_command_copies_checks_and_writes_the_report(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    opened: list[str] = []
    monkeypatch.setattr("webbrowser.open", opened.append)
    assert main(["demo", "quadruped", "--open"]) == OK
    out = capsys.readouterr().out
    assert "INR003 4 links: inertia breaks the triangle inequality" in out
    assert f"{len(ROBOTS['quadruped'].defects)} defects are planted in it: demo-quadruped/{ANSWERS} says which" in out
    assert "data-ready" in (tmp_path / "demo-quadruped" / "report.html").read_text(encoding="utf-8")
    assert opened == [(tmp_path / "demo-quadruped" / "report.html").as_uri()]
    assert (tmp_path / "demo-quadruped" / ANSWERS).is_file()

    assert main(["demo", "quadruped"]) == FAILED
    assert "demo-quadruped: it is not empty; name a new or an empty folder" in capsys.readouterr().err


def test_a_sound_copy_has_no_answers(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["demo", "quadruped", "--sound", "-o", str(tmp_path / "there")]) == OK
    out = capsys.readouterr().out
    assert "no errors, no warnings" in out
    assert "planted" not in out
    assert not (tmp_path / "there" / ANSWERS).exists()


def test_a_page_without_an_edit_and_an_edit_that_does_not_fit_are_refused(tmp_path: Path) -> None:
    page = tmp_path / "cart.md"
    page.write_text("# cart: a cart\n\n## INR003 base: no edit\n", encoding="utf-8")
    with pytest.raises(UrdfcheckError, match="give each heading its edit"):
        read_demo_robot(page)
    page.write_text("# cart: a cart\n\n## INR003 base: one\n\n```diff file=a.urdf\n-a\n+b\n```\n", encoding="utf-8")
    (defect,) = read_demo_robot(page).defects
    (tmp_path / "a.urdf").write_text("a\na\n", encoding="utf-8")
    with pytest.raises(UrdfcheckError, match="not there exactly once"):
        plant_defect(defect, tmp_path)


def test_the_meshes_are_those_of_the_script() -> None:
    script = REPOSITORY / "fixtures" / "make_demo_meshes.py"
    done = subprocess.run([sys.executable, str(script), "--check"], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_robots_are_part_of_the_package() -> None:
    project = tomli.loads((REPOSITORY / "pyproject.toml").read_text(encoding="utf-8"))
    included = project["tool"]["hatch"]["build"]["targets"]["wheel"]["force-include"]
    assert included["fixtures/demos"] == "urdfcheck/_demos"
