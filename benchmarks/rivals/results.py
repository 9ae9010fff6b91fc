"""What the programs found, as data: ``answers.json``, of which ``tools/make_truth_page.py`` makes tables."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Mapping, Sequence
from datetime import date
from typing import Any

from judging import judge
from programs import PROGRAMS, URDFCHECK, Program
from sample import SOUND, Answer, Answers, Task

import urdfcheck

# urdfcheck reports the absolute paths of simcheck's copies, which the published robots do not have.
OF_THE_COPY = "PKG004"
# What a program finds of a planted file, as letters of a word.
LETTERS = {"found": "f", "located": "l", "named": "n"}


def build_results(tasks: Sequence[Task], answers: Answers, day: date) -> dict[str, Any]:
    """Return the judged answers of every program that was asked about all files.

    ``files`` has a row for each planted file, with a word by program: ``fln`` is found, located and named, an empty one missed.
    """
    asked = [program for program in _list_programs() if all(_key(program, task) in answers for task in tasks)]
    sound = {task.robot: task for task in tasks if task.operator == SOUND}
    planted = [task for task in tasks if task.operator != SOUND]
    own = sum(answers[URDFCHECK, task.robot, task.operator].seconds for task in tasks)
    return {
        "date": day.isoformat(),
        "files": [
            {
                "robot": task.robot,
                "operator": task.operator,
                **{
                    program.name: "".join(LETTERS[word] for word in _judge(program, task, sound[task.robot], answers))
                    for program in asked
                },
            }
            for task in planted
        ],
        "programs": [
            {
                "name": program.name,
                "kind": program.kind,
                "version": program.version,
                "asked": program.asked,
                **_describe_sound(program, list(sound.values()), answers),
                "problems": dict(Counter(found.problem for found in _list(program, tasks, answers) if found.problem)),
                "times": round(sum(found.seconds for found in _list(program, tasks, answers)) / own, 3),
            }
            for program in asked
        ],
        "seconds": round(own / len(tasks), 2),
    }


def format_results(results: Mapping[str, Any]) -> str:
    """Return JSON with one line for each file and program, so that a change of one is a change of one line."""
    keys = []
    for key, value in results.items():
        rows = ",\n".join(json.dumps(row, ensure_ascii=False) for row in value) if isinstance(value, list) else ""
        keys.append(f"{json.dumps(key)}: " + (f"[\n{rows}\n]" if rows else json.dumps(value)))
    return "{\n" + ",\n".join(keys) + "\n}\n"


def _list_programs() -> list[Program]:
    own = Program(
        name=URDFCHECK,
        kind="checker",
        requirement=f"{URDFCHECK}=={urdfcheck.__version__}",
        adapter="",
        asked="its default, nothing kept between two files",
    )
    return [own, *PROGRAMS]


def _key(program: Program, task: Task) -> tuple[str, str, str]:
    return program.name, task.robot, task.operator


def _list(program: Program, tasks: Sequence[Task], answers: Answers) -> list[Answer]:
    return [answers[_key(program, task)] for task in tasks]


def _judge(program: Program, task: Task, sound: Task, answers: Answers) -> tuple[str, ...]:
    before, after = answers[_key(program, sound)], answers[_key(program, task)]
    return judge(before.said, after.said, task.change, task.operator)


def _describe_sound(program: Program, sound: Sequence[Task], answers: Answers) -> dict[str, int]:
    """Count the sound robots with a warning or an error, those with an error, and both findings, each kind and part once."""
    loud = [
        {(said.severity, said.same) for said in answer.said if said.severity != "info" and said.check != OF_THE_COPY}
        for answer in _list(program, sound, answers)
    ]
    return {
        "loud": sum(map(bool, loud)),
        "with_error": sum(any(severity == "error" for severity, _ in one) for one in loud),
        "warnings": sum(severity == "warning" for one in loud for severity, _ in one),
        "errors": sum(severity == "error" for one in loud for severity, _ in one),
    }
