"""How the files that simcheck plants are drawn, and when a program has found one."""

from __future__ import annotations

import importlib
import json
import os
import signal
import sys
import time
from datetime import date
from pathlib import Path

import pytest

sys.path.append(str(Path(__file__).parent.parent / "benchmarks" / "rivals"))
sys.path.append(str(Path(__file__).parent.parent / "benchmarks" / "rivals" / "adapters"))

from judging import Change, Said, find_change, find_new, is_located, judge, list_said
from programs import PROGRAMS, URDFCHECK
from results import build_results, format_results
from sample import SOUND, Answer, Task, ask_all, draw_sample, read_answers
from serve import ask_apart

RIVALS = Path(__file__).parent.parent / "benchmarks" / "rivals"
CHANGE = Change(parts=("arm",), lines=((4, 9),), names=frozenset({"arm", "base", "link_2"}))
PLANTED = [
    Task(robot=robot, operator=operator, file=f"{robot}-{operator}", change=CHANGE)
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


def say(message: str, severity: str = "warning", target: str = "", file: str = "/tmp/robot.urdf") -> Said:
    return list_said([(severity, "check", target, message)], file)[0]


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


def test_the_name_of_the_file_and_its_lines_are_no_difference_and_a_digit_of_a_name_is_one() -> None:
    before = [say("/a/clean.urdf:7: link1 is bad", file="/a/clean.urdf")]
    assert not find_new(before, [say("/a/zero.urdf:9: link1 is bad", file="/a/zero.urdf")])
    assert find_new(before, [say("/a/zero.urdf:9: link2 is bad", file="/a/zero.urdf")])


@pytest.mark.parametrize(
    ("said", "operator", "counts"),
    [
        (say("it is heavy", target="base|arm"), "zero_mass", True),
        (say("'arm' is heavy"), "zero_mass", True),
        (say("the mass of link arm is 0"), "zero_mass", True),
        (say("/tmp/robot.urdf:5: no mass"), "zero_mass", True),
        (say("/tmp/robot.urdf:10: no mass"), "zero_mass", False),
        (say("'forearm' is heavy, its arm is not"), "zero_mass", False),
        (say("the asset is 1e3 m"), "scale_mm", True),
    ],
)
def test_a_finding_is_located_by_a_subject_a_name_or_a_line(said: Said, operator: str, counts: bool) -> None:
    assert is_located(said, CHANGE, operator) is counts


@pytest.mark.parametrize(
    ("said", "operator", "expected"),
    [
        (say("'arm' has no mass"), "zero_mass", ("found", "located", "named")),
        (say("look at 'arm'"), "zero_mass", ("found", "located")),
        (say("mass 0", "error"), "zero_mass", ("found", "named")),
        (say("refused", "error"), "zero_mass", ("found",)),
        (say("mass 0", "info"), "zero_mass", ()),
        (say("'base' has no mass"), "zero_mass", ()),
        (say("link_2 has no mass", "error"), "zero_mass", ()),
        (say("/tmp/robot.urdf:99: no mass", "error"), "zero_mass", ()),
    ],
)
def test_a_refusal_without_a_place_is_found_and_a_finding_elsewhere_is_not(
    said: Said, operator: str, expected: tuple[str, ...]
) -> None:
    assert judge([], [said], CHANGE, operator) == expected
    assert judge([said], [said], CHANGE, operator) == ()


def test_the_changed_elements_are_found_with_their_lines(tmp_path: Path) -> None:
    clean, planted = tmp_path / "clean.urdf", tmp_path / "planted.urdf"
    joint = '<joint name="j">\n<parent link="base"/><child link="arm"/>\n<axis xyz="0 0 {}"/>\n</joint>'
    text = f'<robot name="r">\n<link name="base"/>\n{joint}\n<link name="arm"/></robot>'
    clean.write_text(text.format(1))
    planted.write_text(text.format(0))
    assert find_change(clean, planted) == Change(
        parts=("j", "arm"), lines=((3, 6),), names=frozenset({"base", "arm", "j"})
    )


# Answers as the server of an adapter does: no mass for any file whose name has `zero`.
SERVER = """import json, sys
for line in sys.stdin:
    said = [["error", "mass", "arm", "no mass"]] if "zero" in line else []
    print(json.dumps({"said": said, "problem": "", "seconds": 2.0}), flush=True)
"""


def test_answers_are_kept_and_judged(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    server, keep = tmp_path / "serve.py", tmp_path / "answers.jsonl"
    server.write_text(SERVER)
    monkeypatch.setattr("sample.SERVER", server)
    # sdformat runs in any Python; the environment of the other one does not exist.
    programs = [program for program in PROGRAMS if program.name in {"sdformat", "Drake"}]
    asked: list[str] = []

    def ask_urdfcheck(task: Task) -> Answer:
        asked.append(task.operator)
        return Answer(seconds=1.0)

    tasks = [
        Task(robot="a", operator=SOUND, file="clean"),
        *(task for task in PLANTED if task.robot == "a" and task.operator != "flip_axis"),
    ]
    for _ in range(2):  # the second time nothing is left to ask
        ask_all(tasks, ask_urdfcheck, programs, environments=tmp_path, limit=9, keep=keep)
    assert asked == [SOUND, "zero_mass", "degrees"]
    results = build_results(tasks, read_answers(keep), date(2026, 1, 2))
    assert [program["name"] for program in results["programs"]] == [URDFCHECK, "sdformat"]
    assert [program["times"] for program in results["programs"]] == [1.0, 2.0]
    assert json.loads(format_results(results)) == results
    assert results["files"] == [
        {"robot": "a", "operator": "zero_mass", URDFCHECK: "", "sdformat": "fln"},
        {"robot": "a", "operator": "degrees", URDFCHECK: "", "sdformat": ""},
    ]


def test_a_warning_about_a_sound_robot_is_counted_once_and_not_what_the_copy_adds() -> None:
    said = [say("'arm' is light"), say("'arm' is light"), say("'arm' is odd", "info")]
    copy = Said(severity="error", check="PKG004", same="x", parts=(), message="absolute path")
    answers = {(URDFCHECK, "a", SOUND): Answer(said=[*said, copy], seconds=1.0)}
    (program,) = build_results([Task(robot="a", operator=SOUND, file="f")], answers, date(2026, 1, 2))["programs"]
    assert (program["loud"], program["with_error"], program["warnings"], program["errors"]) == (1, 0, 1, 0)


def test_every_program_has_an_adapter_and_a_version() -> None:
    for program in PROGRAMS:
        assert (RIVALS / "adapters" / f"{program.adapter}.py").is_file()
        assert program.version
    assert len({program.name for program in PROGRAMS}) == len(PROGRAMS)


def end_by_a_signal(_file: str) -> list[tuple[str, str, str, str]]:
    os.kill(os.getpid(), signal.SIGTERM)
    return []


def wait_too_long(_file: str) -> list[tuple[str, str, str, str]]:
    time.sleep(60)
    return []


def raise_an_error(_file: str) -> list[tuple[str, str, str, str]]:
    raise ValueError("no mass")


@pytest.mark.skipif(sys.platform == "win32", reason="forks")
@pytest.mark.parametrize(
    ("ask", "said", "problem"),
    [
        (lambda file: [("info", "kind", "arm", file)], [["info", "kind", "arm", "f"]], ""),
        (end_by_a_signal, [("error", "crash", "", "ends with SIGTERM")], "crash: SIGTERM"),
        (wait_too_long, [], "timeout"),
        (raise_an_error, [["error", "crash", "", "ValueError: no mass"]], "ValueError"),
    ],
)
def test_a_crash_and_a_timeout_are_answers_too(ask: object, said: list[object], problem: str) -> None:
    answer = ask_apart("f", 1, ask)  # type: ignore[arg-type]
    assert (answer["said"], answer["problem"]) == (said, problem)


def test_mujoco_speaks_through_its_adapter(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    adapter = importlib.import_module("ask_mujoco")
    file = tmp_path / "robot.urdf"
    file.write_text(
        '<robot name="r"><link name="a"/><link name="b"/>'
        '<joint name="j" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint></robot>'
    )
    ((severity, kind, _, text),) = adapter.ask(str(file))
    assert (severity, kind) == ("error", "refused")
    assert "'b'" in text


def test_check_urdf_speaks_through_its_adapter(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    adapter = importlib.import_module("ask_check_urdf")
    if not adapter.PROGRAM.exists():
        pytest.skip("cmeel-urdfdom is not installed")
    file = tmp_path / "robot.urdf"
    file.write_text('<robot name="r"><link name="a"/><link name="a"/></robot>')
    rows = list(adapter.ask(str(file)))
    assert ("error", "refused") in [row[:2] for row in rows]
    assert any("'a' is not unique" in row[3] for row in rows), rows
