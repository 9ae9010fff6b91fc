"""Which of the defects that simcheck plants a language server shows: the sample of ``benchmarks/rivals``, and its rule."""

from __future__ import annotations

import asyncio
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path

from lsprotocol import types

sys.path.append(str(Path(__file__).parents[1] / "rivals"))

from judging import Said, judge, list_said
from planting import list_plain_robots, plant
from results import LETTERS
from sample import SOUND, Task, draw_sample
from servers import OTHER, OWN, Server, make_other_server, make_own_server
from session import start_session

# What the sample of ``benchmarks/rivals`` is drawn with.
ROBOTS, ROUNDS, SEED = 20, 3, 1
# Information and hints do not count.
SEVERITIES = {types.DiagnosticSeverity.Error: "error", types.DiagnosticSeverity.Warning: "warning"}


def ask_about_planted(environments: Path, simcheck: Path, folder: Path) -> list[dict[str, str]]:
    """Return a row for each planted file, with a word by server: ``fln`` is found, located and named, an empty one missed.

    :param environments: where the other server is installed.
    :param simcheck: the Python that plants.
    :param folder: where the files are written.
    """
    robots = {robot.name: robot for robot in list_plain_robots(ROBOTS)}
    tasks = [task for i, robot in enumerate(robots.values()) for task in plant(robot, folder / str(i), simcheck)]
    drawn = draw_sample([task for task in tasks if task.operator != SOUND], ROUNDS, SEED)
    sound = {task.robot: task for task in tasks if task.operator == SOUND}
    before: dict[tuple[str, str], list[Said]] = {}

    def ask(name: str, task: Task) -> list[Said]:
        robot, file = robots[task.robot], Path(task.file)
        if name == OWN:
            server = make_own_server({}, robot.package_roots or (robot.entry.parent.parent,))
        else:
            server = make_other_server(environments, file, {})
        return list_said_by_diagnostics(asyncio.run(show(server, file)), task.file)

    rows = []
    for task in drawn:
        row = {"robot": task.robot, "operator": task.operator}
        for name in (OWN, OTHER):
            if (name, task.robot) not in before:
                before[name, task.robot] = ask(name, sound[task.robot])
            words = judge(before[name, task.robot], ask(name, task), task.change, task.operator)
            row[name] = "".join(LETTERS[word] for word in words)
        rows.append(row)
        print(*row.values(), sep="\t", flush=True)
    return rows


async def show(server: Server, file: Path) -> Sequence[types.Diagnostic]:
    """Return what a server shows of a file when nothing is left to check."""
    async with start_session(server, file.parent) as session:
        session.open(file, file.read_text(encoding="utf-8"))
        await session.rest(file)
        return session.diagnostics.get(file.as_uri(), [])


def list_said_by_diagnostics(diagnostics: Iterable[types.Diagnostic], file: str) -> list[Said]:
    """List what errors and warnings say, each with its line; one at the very beginning of a file has no place."""
    rows = []
    for diagnostic in diagnostics:
        severity = SEVERITIES.get(diagnostic.severity or types.DiagnosticSeverity.Error)
        if severity is not None:
            start = diagnostic.range.start
            place = f"{file}:{start.line + 1}: " if start.line or start.character else ""
            rows.append((severity, str(diagnostic.code), "", place + diagnostic.message))
    return list_said(rows, file)
