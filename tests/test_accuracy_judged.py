"""Findings that people judged are found again, or known to say something else, or to be gone."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
from builders import joint, link, robot
from conftest import check_text

sys.path.append(str(Path(__file__).parent.parent / "benchmarks" / "accuracy"))

from judged import (
    CHANGED,
    COLUMNS,
    GONE,
    KEPT,
    ROUNDS,
    build_tables,
    find_models,
    find_outcomes,
    match_labels,
    read_models,
    read_round,
)
from real.robots import RealRobot

ROW = ("some/robot:arm", "robot.urdf:1", "KIN002", "unknown", "error", "TU", "-", "read", "-", "no such link")


def write_round(folder: Path, *rows: tuple[str, ...], columns: tuple[str, ...] = COLUMNS) -> Path:
    path = folder / "round.tsv"
    path.write_text("# build 1\n" + "".join("\t".join(row) + "\n" for row in (columns, *rows)), encoding="utf-8")
    return path


def changed(**cells: str) -> tuple[str, ...]:
    return tuple(cells.get(column, cell) for column, cell in zip(COLUMNS, ROW, strict=True))


def test_rounds_that_are_kept_follow_the_format() -> None:
    for path in ROUNDS.glob("*.tsv"):
        labels = read_round(path)
        assert labels, path.name
        places = [(x.robot, x.file, x.line, x.code, x.message, x.reason) for x in labels]
        assert len(set(places)) == len(places), f"{path.name}: a finding is labelled twice"


@pytest.mark.parametrize(
    "cells",
    [{"label": "X"}, {"sure": "guessed"}, {"code": "INR"}, {"severity": "bad"}, {"place": "/root/robot.urdf:1"}],
    ids=lambda cells: next(iter(cells)),
)
def test_a_line_that_does_not_follow_the_format_is_an_error(tmp_path: Path, cells: dict[str, str]) -> None:
    with pytest.raises(ValueError, match=next(iter(cells.values()))):
        read_round(write_round(tmp_path, changed(**cells)))


def test_a_missing_cell_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="cells"):
        read_round(write_round(tmp_path, ROW[:-1]))


@pytest.mark.parametrize("left_out", [{"says"}, {"bad"}, {"says", "bad"}])
def test_the_words_and_how_bad_they_are_may_be_left_out(tmp_path: Path, left_out: set[str]) -> None:
    columns = tuple(c for c in COLUMNS if c not in left_out)
    row = tuple(cell for column, cell in zip(COLUMNS, ROW, strict=True) if column not in left_out)
    (label,) = read_round(write_round(tmp_path, row, columns=columns))
    assert (label.line, label.says, label.bad, label.reason) == (1, None, None, "no such link")


def test_a_misleading_finding_does_harm_or_is_a_slip(tmp_path: Path) -> None:
    (label,) = read_round(write_round(tmp_path, changed(label="M", bad="slip", says="no such joint")))
    assert (label.label, label.bad) == ("M", "slip")
    with pytest.raises(ValueError, match="bitter is none of harm, slip"):
        read_round(write_round(tmp_path, changed(label="M", bad="bitter")))


def test_what_became_of_a_finding(tmp_path: Path) -> None:
    text = robot(link("base"), link("arm"), joint("j", "base", "leg"))
    run = check_text(tmp_path / "now", text)
    finding = next(f for f in run.findings if f.code == "KIN002")
    assert finding.location.span is not None
    row = changed(place=f"robot.urdf:{finding.location.span.line}", message=finding.message_id)

    def state(**cells: str) -> str:
        own = tuple(cells.get(c, cell) for c, cell in zip(COLUMNS, row, strict=True))
        (label,) = read_round(write_round(tmp_path, own))
        (outcome,) = match_labels([label], run)
        return outcome.state

    assert state() == KEPT
    assert state(message="-", place="-") == KEPT
    assert state(says="does not exist") == KEPT
    assert state(says="is in inches") == CHANGED
    assert state(message="other") == CHANGED
    assert state(place="robot.urdf:999") == GONE
    assert state(place="other.urdf") == GONE
    assert state(code="KIN004") == GONE


def test_precision_counts_what_is_still_said(tmp_path: Path) -> None:
    text = robot(link("base"), link("arm"), joint("j", "base", "leg"))
    run = check_text(tmp_path / "now", text)
    rows = [changed(place="-", message="-", label=x, reason=x) for x in ("TU", "TU", "TU", "M")]
    rows.append(changed(place="-", message="-", label="F", says="is in inches"))
    outcomes = list(match_labels(read_round(write_round(tmp_path, *rows)), run))
    tables = build_tables(outcomes)
    assert "| error | 4 | 3 | 0 | 0 | 1 | 0 | 75% (<  97%) | 25.0% (>  1.5%) |" in tables
    assert "| KIN002 | 5 | 60% | 4 | 75% | 1 | 0 | 0 | 0 |" in tables


def test_models_of_other_repositories_are_found_in_their_clones(tmp_path: Path) -> None:
    path = write_round(tmp_path, ROW)
    line = "# repo some/robot commit 4e23c97 my files/arm.urdf.xacro side:=left empty:=\n"
    path.write_text(line + path.read_text(encoding="utf-8"), encoding="utf-8")
    models = read_models(path)
    assert list(models) == ["some/robot:arm", "some/robot:arm.urdf.xacro", "some/robot:my files/arm.urdf.xacro"]
    robot, *_ = find_models(models, [RealRobot(name="some/robot", entry=tmp_path)])
    assert (robot.name, robot.entry) == ("some/robot:arm", tmp_path / "my files" / "arm.urdf.xacro")
    assert robot.arguments == {"side": "left", "empty": ""}
    assert find_models(models, []) == []
    assert len(read_round(path)) == 1


def test_a_robot_that_is_not_at_hand_has_no_state(tmp_path: Path) -> None:
    (outcome,) = find_outcomes(read_round(write_round(tmp_path, ROW)), [])
    assert (outcome.state, outcome.finding) == ("robot not at hand", None)
