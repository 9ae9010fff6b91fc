"""The errors that both language servers show in published robots."""

from __future__ import annotations

import asyncio
from collections import Counter, defaultdict
from collections.abc import Iterable
from pathlib import Path

from lsprotocol import types
from pygls import uris
from repositories import RealRobot, find_repository
from servers import OTHER, OWN, Server, make_other_server, make_own_server
from session import LIMIT, start_session
from shown_errors import ShownError


def ask_about_published(environments: Path, robots: Iterable[RealRobot]) -> list[ShownError]:
    """Return all errors of both servers in robots, each opened in the folder of its repository.

    :param environments: where the other server is installed.
    """
    errors = []
    for robot in robots:
        servers = make_own_server(robot.arguments), make_other_server(environments, robot.entry, robot.arguments)
        for server in servers:
            found = asyncio.run(list_errors(server, robot))
            errors += found
            print(robot.name, server.name, len(found), sep="\t", flush=True)
    return errors


async def list_errors(server: Server, robot: RealRobot) -> list[ShownError]:
    """Return the errors that a server shows in a robot and in the files that it includes."""
    folder = find_repository(robot)
    async with start_session(server, folder) as session:
        session.open(robot.entry, robot.entry.read_bytes().decode())
        try:
            await session.rest(robot.entry)
        except asyncio.TimeoutError:
            print(f"{robot.name}: {server.name} did not end in {LIMIT:.0f} s; what it has sent counts")
        return [
            ShownError(
                server=server.name,
                robot=robot.name,
                file=str(Path(uris.to_fs_path(uri) or uri).relative_to(folder)),
                line=found.range.start.line + 1,
                code=str(found.code),
                message=found.message,
            )
            for uri, shown in session.diagnostics.items()
            for found in shown
            if found.severity == types.DiagnosticSeverity.Error
        ]


def count_by_robot(robots: Iterable[RealRobot], errors: Iterable[ShownError]) -> list[dict[str, object]]:
    """Return a row for each robot: how many errors of each code a server shows in it."""
    counts: dict[tuple[str, str], Counter[str]] = defaultdict(Counter)
    for error in errors:
        counts[error.robot, error.server][error.code] += 1
    return [
        {
            "robot": robot.name,
            "format": robot.entry.suffix.removeprefix("."),
            **{name: dict(sorted(counts[robot.name, name].items())) for name in (OWN, OTHER)},
        }
        for robot in robots
    ]
