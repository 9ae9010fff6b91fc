"""How the files that simcheck plants are drawn, and when a program has found one."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

sys.path.append(str(Path(__file__).parent.parent / "benchmarks" / "rivals"))

from judging import Said, find_new, is_about, list_said_by_simcheck
from sample import SOUND, Answer, Task, ask_all, build_sample_tables, draw_sample, read_answers

PLANTED = [
    Task(robot=robot, operator=operator, file=f"{robot}-{operator}", parts=("arm",))
    for robot in "abcd"
    for operator in ("flip_axis", "zero_mass", "degrees")
]


def test_a_sample_has_all_moved_joints_and_a_longer_one_begins_with_it() -> None:
    two, three = (draw_sample(PLANTED, rounds, seed=1) for rounds in (2, 3))
    assert two == three[: len(two)]
    assert [task.operator for task in two].count("flip_axis") == 4
    assert [task.operator for task in three].count("degrees") == 3
    # Every robot is drawn once before one is drawn again.
    assert {task.robot for task in two if task.turn} == set("abcd")


def say(message: str, severity: str = "warning", target: str = "") -> Said:
    return list_said_by_simcheck([(severity, "inertia.mass", "", target, message)])[0]


@pytest.mark.parametrize(
    ("after", "is_new"),
    [
        (say("'arm_2' weighs 2.5 kg"), False),
        (say("'arm_2' weighs 2.5 kg", "error"), True),
        (say("'arm_3' weighs 1 kg"), True),
        (say("'arm_2' weighs 1 kg", target="arm_2"), True),
    ],
)
def test_another_number_alone_is_no_new_finding(after: Said, is_new: bool) -> None:
    assert bool(find_new([say("'arm_2' weighs 1 kg")], [after])) is is_new


@pytest.mark.parametrize(
    ("said", "operator", "counts"),
    [
        (say("it is heavy", target="base|arm"), "zero_mass", True),
        (say("'arm' is heavy"), "zero_mass", True),
        (say("'forearm' is heavy, its arm is not"), "zero_mass", False),
        (say("the asset is 1e3 m"), "scale_mm", True),
    ],
)
def test_a_finding_counts_that_names_what_was_changed(said: Said, operator: str, counts: bool) -> None:
    assert is_about(said, ("arm",), operator) is counts


# Answers as simcheck's side does: a heavy arm for any file whose name has `zero`.
SIDE = """import json, sys
for line in sys.stdin:
    said = [["error", "inertia.mass", "", "arm", "heavy"]] if "zero" in line else []
    print(json.dumps({"said": said, "problem": "", "seconds": 2.0}), flush=True)
"""


def test_answers_are_kept_and_counted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    side, keep = tmp_path / "side.py", tmp_path / "answers.jsonl"
    side.write_text(SIDE)
    monkeypatch.setattr("sample.SIDE", side)
    asked: list[str] = []

    def ask_urdfcheck(task: Task) -> Answer:
        asked.append(task.operator)
        return Answer(seconds=1.0)

    tasks = [
        Task(robot="a", operator=SOUND, file="clean"),
        *(task for task in PLANTED if task.robot == "a" and task.operator != "flip_axis"),
    ]
    for _ in range(2):  # the second time nothing is left to ask
        ask_all(tasks, ask_urdfcheck, sys.executable, limit=9, keep=keep)
    assert asked == [SOUND, "zero_mass", "degrees"]
    table = build_sample_tables(read_answers(keep))
    assert "| zero_mass | 1 | 0 | 0 | 1.0 | 1 | 1 | 2.0 | 1 | 1 | 2.0 |" in table
    assert "| all | 2 | 0 | 0 | 1.0 | 1 | 1 | 2.0 | 1 | 1 | 2.0 |" in table
    assert "| urdfcheck | 0 of 1 | 0 | 0 | 1.0 |" in table
