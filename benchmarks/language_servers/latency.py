"""How soon a language server shows what is wrong: after a document was opened, and after a key."""

from __future__ import annotations

import asyncio
import re
import sys
import time
from collections.abc import Callable, Iterable
from pathlib import Path
from statistics import median

sys.path.append(str(Path(__file__).parents[1]))

from editor import sum_processor_time
from repositories import RealRobot, copy_repository
from servers import OTHER, OWN, Server, make_other_server, make_own_server
from session import Session, start_session

# Robots of the corpus, and a link to which the joint is attached.
MODELS = {
    "TheRobotStudio/SO-ARM100:so100": "base",
    "Gepetto/example-robot-data:allegro_right_hand": "palm_link",
    "ridgeback/ridgeback:ridgeback": "base_link",
    "shadow-robot/sr_common:sr_hand": "world",
}
# A defect that both servers report as an error, and that keeps neither from checking the rest: limits the wrong way round.
JOINT = (
    '<link name="late"/><joint name="late_joint" type="revolute"><parent link="{parent}"/><child link="late"/>'
    '<origin xyz="0 0 3"/><axis xyz="0 0 1"/><limit lower="{lower}" upper="0" effort="1" velocity="1"/></joint>\n</robot>'
)
LIMITS = re.compile(r"late_joint.* lower .*above")
# Seconds after which a server that was started has loaded what it loads without being asked.
REST = 4.0
EDITS = 3


class Stopwatch:
    """Wall time and processor time since something was sent."""

    def __init__(self, process: int) -> None:
        self._process = process
        self._used, self._began = sum_processor_time(process), time.perf_counter()

    def read(self) -> tuple[float, float]:
        """Return both times in s."""
        return time.perf_counter() - self._began, sum_processor_time(self._process) - self._used


async def measure_turn(
    server: Server, folder: Path, model: Path, sound: str, broken: str
) -> dict[str, tuple[float, float]]:
    """Return the wall time and the processor time of each step of one session.

    :param sound: another text for the model, which has the text ``broken``.

    ``open``: from opening a document to the error in it; ``all``: to everything that is checked; ``edit``: from the change that
    takes the error away or brings it back to the diagnostics that say so.
    """
    times = {}
    async with start_session(server, folder) as session:
        await asyncio.sleep(REST)
        watch = Stopwatch(session.process)
        session.open(model, broken)
        await session.wait_until(lambda: shows_error(session, model))
        times["open"] = watch.read()
        await session.rest(model)
        times["all"] = watch.read()
        edits = []
        for is_broken in (False, True) * EDITS:
            watch = Stopwatch(session.process)
            session.change(model, broken if is_broken else sound)
            await session.wait_until(_make_condition(session, model, is_broken))
            edits.append(watch.read())
            await session.rest(model)
        times["edit"] = median(one[0] for one in edits), median(one[1] for one in edits)
    return times


def add_joint(text: str, parent: str, lower: int) -> str:
    """Return the text of a robot with one joint more, whose upper limit is 0."""
    head, _, tail = text.rpartition("</robot>")
    return head + JOINT.format(parent=parent, lower=lower) + tail


def shows_error(session: Session, model: Path) -> bool:
    """Say whether the limits the wrong way round are shown."""
    return any(LIMITS.search(found.message) for found in session.diagnostics.get(model.as_uri(), ()))


def _make_condition(session: Session, model: Path, is_broken: bool) -> Callable[[], bool]:
    return lambda: shows_error(session, model) is is_broken


def measure(environments: Path, robots: Iterable[RealRobot], turns: int, place: Path) -> list[dict[str, object]]:
    """Return a row for each model and step: the median times of both servers in s, asked in turns.

    :param place: a folder for copies of the repositories, with the defect saved: torques are computed of saved files only.
    """
    rows: list[dict[str, object]] = []
    for robot in robots:
        folder, model = copy_repository(robot, place)
        text = model.read_text(encoding="utf-8")
        sound, broken = (add_joint(text, MODELS[robot.name], lower) for lower in (-1, 1))
        model.write_text(broken, encoding="utf-8")
        servers = (make_own_server(robot.arguments), make_other_server(environments, model, robot.arguments))
        seen: dict[str, list[dict[str, tuple[float, float]]]] = {OWN: [], OTHER: []}
        for _ in range(turns + 1):
            for server in servers:
                seen[server.name].append(asyncio.run(measure_turn(server, folder, model, sound, broken)))
        for step in ("open", "all", "edit"):
            row: dict[str, object] = {"robot": robot.name, "links": robot.links, "step": step}
            for name, turns_of_one in seen.items():
                # In the first turn meshes are new.
                wall, used = (median(times[step][part] for times in turns_of_one[1:]) for part in (0, 1))
                row[name] = {"wall": round(wall, 4), "processor": round(used, 2)}
            rows.append(row)
            print(row, flush=True)
    return rows
