"""A seeded sample of the planted files, each checked by urdfcheck and by other programs.

Some programs need minutes: what was asked is kept as JSON lines, and a second run continues.
"""

from __future__ import annotations

import json
import os
import random
import subprocess
from collections import Counter, defaultdict
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

from judging import Change, Said, list_said
from programs import URDFCHECK, Program, find_python

SERVER = Path(__file__).parent / "adapters" / "serve.py"
# Operators of which every file is taken, because few programs find them; of the others one in each round.
ALWAYS = ("flip_axis", "joint_into_parent")
SOUND = "sound"


@dataclass(frozen=True, slots=True, kw_only=True)
class Task:
    """A file of the sample."""

    robot: str
    operator: str
    """Or `SOUND`."""
    file: str
    what: str = ""
    change: Change = field(default_factory=Change)
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


# By program, robot and operator.
Answers = dict[tuple[str, str, str], Answer]


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


class Peer:
    """A process of another program that checks files one after the other."""

    def __init__(self, python: Path, adapter: str, limit: int) -> None:
        """Start it.

        :param limit: seconds for one file.
        """
        self._process = subprocess.Popen(
            [python, str(SERVER), adapter, str(limit)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
            env={**os.environ, "PYTHONDONTWRITEBYTECODE": "1"},
        )

    def ask(self, file: str) -> Answer:
        """Return its answer."""
        to, back = self._process.stdin, self._process.stdout
        assert to is not None
        assert back is not None
        to.write(f"{file}\n")
        to.flush()
        line = json.loads(back.readline())
        return Answer(said=list_said(line["said"], file), problem=line["problem"], seconds=line["seconds"])

    def close(self) -> None:
        """Let it end."""
        self._process.communicate()


def ask_all(
    tasks: Sequence[Task],
    ask_urdfcheck: Callable[[Task], Answer],
    programs: Sequence[Program],
    *,
    environments: Path,
    limit: int,
    keep: Path,
) -> None:
    """Ask each program about each file that is not yet in the file ``keep``, and append the answers to it.

    The programs take turns at each file: their times are ratios, and the load of a machine changes.

    :param environments: the folder that `programs` fills; a program that it lacks is not asked.
    :param limit: seconds that another program may take for one file.
    """
    known = read_answers(keep)
    pythons = {program: find_python(program, environments) for program in programs}
    peers = {program.name: Peer(python, program.adapter, limit) for program, python in pythons.items() if python}
    with keep.open("a", encoding="utf-8") as file:
        for task in tasks:
            for name in (URDFCHECK, *peers):
                key = (name, task.robot, task.operator)
                if key not in known:
                    answer = ask_urdfcheck(task) if name == URDFCHECK else peers[name].ask(task.file)
                    file.write(json.dumps([*key, asdict(answer)]) + "\n")
                    file.flush()
    for peer in peers.values():
        peer.close()


def read_answers(keep: Path) -> Answers:
    """Read the answers of earlier runs."""
    lines = keep.read_text(encoding="utf-8").splitlines() if keep.exists() else []
    found = {}
    for name, robot, operator, answer in map(json.loads, lines):
        found[name, robot, operator] = _read_answer(answer)
    return found


def _read_answer(kept: dict[str, Any]) -> Answer:
    said = [Said(**{**one, "parts": tuple(one["parts"])}) for one in kept["said"]]
    return Answer(said=said, problem=kept["problem"], seconds=kept["seconds"])
