"""A seeded sample of the planted files, each checked by urdfcheck and by simcheck.

simcheck needs minutes for some files: what was asked is kept as JSON lines, and a second run continues.
"""

from __future__ import annotations

import json
import random
import subprocess
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from statistics import median
from typing import Any

from judging import Said, find_new, is_about, list_said_by_simcheck, read_said

SIDE = Path(__file__).with_name("simcheck_side.py")
# Operators of which every file is taken, because few programs find them; of the others one in each round.
ALWAYS = ("flip_axis", "joint_into_parent")
SOUND = "sound"
# simcheck without and with an engine, and how the engine is called.
RIVALS = {"simcheck, static": "none", "simcheck": "mujoco"}
PROGRAMS = ("urdfcheck", *RIVALS)
# It reports the absolute paths of simcheck's copies, which the published robots do not have.
OF_THE_COPY = "PKG004"


@dataclass(frozen=True, slots=True, kw_only=True)
class Task:
    """A file of the sample."""

    robot: str
    operator: str
    """Or `SOUND`."""
    file: str
    what: str = ""
    parts: tuple[str, ...] = ()
    """Names of what was changed, and the children of changed joints."""
    turn: int = 0
    """The round in which it was drawn; 0: always taken."""


@dataclass(slots=True, kw_only=True)
class Answer:
    """What one program reports of a file."""

    said: list[Said] = field(default_factory=list)
    problem: str = ""
    """Why there is no answer, or not all of it."""
    seconds: float = 0.0
    """Of processor time."""


def draw_sample(planted: Sequence[Task], rounds: int, seed: int) -> list[Task]:
    """Draw all files of the operators `ALWAYS`, and of each other one a file in each round, of the robot drawn least so far."""
    chance = random.Random(seed)
    drawn = [task for task in planted if task.operator in ALWAYS]
    used = Counter(task.robot for task in drawn)
    left: dict[str, list[Task]] = defaultdict(list)
    for task in planted:
        if task.operator not in ALWAYS:
            left[task.operator].append(task)
    for turn in range(1, rounds + 1):
        for operator in sorted(left):
            some = left[operator]
            if some:
                chance.shuffle(some)
                some.sort(key=lambda task: -used[task.robot])  # stable: equals stay shuffled
                task = some.pop()
                used[task.robot] += 1
                drawn.append(replace(task, turn=turn))
    return drawn


class Rival:
    """A process of simcheck that checks files one after the other."""

    def __init__(self, python: str, engine: str, limit: int) -> None:
        """Start it.

        :param limit: seconds for one file.
        """
        self._process = subprocess.Popen(
            [python, str(SIDE), "check", str(limit), engine],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
        )

    def ask(self, file: str) -> Answer:
        """Return its answer."""
        to, back = self._process.stdin, self._process.stdout
        assert to is not None
        assert back is not None
        to.write(f"{file}\n")
        to.flush()
        line = next(json.loads(line) for line in back if line.startswith("{"))
        return Answer(said=list_said_by_simcheck(line["said"]), problem=line["problem"], seconds=line["seconds"])

    def close(self) -> None:
        """Let it end."""
        self._process.communicate()


def ask_all(
    tasks: Sequence[Task], ask_urdfcheck: Callable[[Task], Answer], python: str, limit: int, keep: Path
) -> None:
    """Ask all programs about each file that is not yet in the file ``keep``, and append the answers to it.

    :param limit: seconds that simcheck may take for one file.
    """
    known = {(task.robot, task.operator) for task, _ in read_answers(keep)}
    rivals = {name: Rival(python, engine, limit) for name, engine in RIVALS.items()}
    with keep.open("a", encoding="utf-8") as file:
        for task in tasks:
            if (task.robot, task.operator) in known:
                continue
            answers = {"urdfcheck": ask_urdfcheck(task), **{name: rivals[name].ask(task.file) for name in rivals}}
            file.write(json.dumps([asdict(task), {name: asdict(answer) for name, answer in answers.items()}]) + "\n")
            file.flush()
    for rival in rivals.values():
        rival.close()


def read_answers(keep: Path) -> list[tuple[Task, dict[str, Answer]]]:
    """Read the answers of earlier runs."""
    if not keep.exists():
        return []
    found = []
    for line in keep.read_text(encoding="utf-8").splitlines():
        task, answers = json.loads(line)
        read = {
            name: Answer(
                said=[read_said(one) for one in kept["said"]], problem=kept["problem"], seconds=kept["seconds"]
            )
            for name, kept in answers.items()
        }
        found.append((Task(**{**task, "parts": tuple(task["parts"])}), read))
    return found


def build_sample_tables(asked: Sequence[tuple[Task, dict[str, Answer]]]) -> str:
    """Count by operator and program what was found, and at warning or above; and what is reported of the sound robots."""
    sound = {task.robot: answers for task, answers in asked if task.operator == SOUND}
    planted = [(task, answers) for task, answers in asked if task.operator != SOUND and task.robot in sound]
    head = "".join(f" {name} | at warning | seconds |" for name in PROGRAMS)
    lines = [f"| operator | files |{head}", "|---|---:|" + "---:|" * 3 * len(PROGRAMS)]
    for operator in (*dict.fromkeys(sorted(task.operator for task, _ in planted)), "all"):
        some = [(task, answers) for task, answers in planted if operator in {task.operator, "all"}]
        cells = "".join(_describe_share(some, sound, name) for name in PROGRAMS)
        lines.append(f"| {operator} | {len(some)} |{cells}")
    lines += [
        "",
        "| of the sound robots | with a warning or an error | warnings | errors | seconds |",
        "|---|---:|---:|---:|---:|",
    ]
    for name in PROGRAMS:
        loud = [_list_loud(answers[name]) for answers in sound.values()]
        total = Counter(severity for one in loud for severity, _ in one)
        seconds = median(answers[name].seconds for answers in sound.values())
        lines.append(
            f"| {name} | {sum(map(bool, loud))} of {len(loud)} | {total['warning']} | {total['error']} | {seconds:.1f} |"
        )
    broken = [(task, name, a[name].problem) for task, a in asked for name in PROGRAMS if a[name].problem]
    lines.append(f"\n{len(broken)} answers with a problem: {Counter(problem for *_, problem in broken)}")
    return "\n".join(lines)


def list_found(task: Task, sound: Answer, answer: Answer) -> list[Said]:
    """Return what a program reports that counts as found."""
    return [said for said in find_new(sound.said, answer.said) if is_about(said, task.parts, task.operator)]


def _list_loud(answer: Answer) -> set[tuple[str, str]]:
    """Return the warnings and errors, each as severity and kind with its parts."""
    return {(said.severity, said.same) for said in answer.said if said.severity != "info" and said.check != OF_THE_COPY}


def _describe_share(some: Iterable[tuple[Task, dict[str, Answer]]], sound: dict[str, Any], name: str) -> str:
    """Return three cells: how many of the files were found, how many at warning, and the median of the seconds."""
    listed = list(some)
    found = [list_found(task, sound[task.robot][name], answers[name]) for task, answers in listed]
    loud = sum(any(said.severity != "info" for said in one) for one in found)
    seconds = median(answers[name].seconds for _, answers in listed)
    return f" {sum(map(bool, found))} | {loud} | {seconds:.1f} |"
