"""The robots of the folders that ``URDFCHECK_CORPUS`` names (see CONTRIBUTING.md), and how they are checked."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from urdfcheck.core import Run
from urdfcheck.run.pipeline import IN_THIS_PROCESS, run
from urdfcheck.run.request import RunOptions, make_request

VARIABLE = "URDFCHECK_CORPUS"


@dataclass(frozen=True, slots=True, kw_only=True)
class RealRobot:
    """A model and what it needs to be read."""

    name: str
    """The ``id`` in ``corpus.json``; of a folder without one, the name of the repository."""
    entry: Path
    """The file, or the folder of the repository."""
    arguments: Mapping[str, str] = field(default_factory=dict)
    """Values of xacro arguments."""
    package_roots: tuple[Path, ...] = ()
    """Folders that hold packages."""
    expands: bool = True
    """Whether `entry` is one file of which a robot can be made."""
    links: int = 0
    """Number of links as far as it is known: how long a check takes."""


def list_robots() -> list[RealRobot]:
    """List the robots of all folders that the variable names; none if it is not set."""
    folders = [Path(name) for name in os.environ.get(VARIABLE, "").split(os.pathsep) if name]
    return [robot for folder in folders for robot in _iter_robots(folder.absolute())]


def _iter_robots(folder: Path) -> Iterator[RealRobot]:
    listed = folder / "corpus.json"
    if not listed.is_file():
        for repository in sorted(path for path in folder.iterdir() if path.is_dir()):
            # Neither an owner's nor a repository's name begins or ends with these.
            yield RealRobot(name=re.sub(r"__|\+", "/", repository.name, count=1), entry=repository, expands=False)
        return
    for entry in json.loads(listed.read_text(encoding="utf-8")):
        yield RealRobot(
            name=entry["id"],
            entry=folder / entry["entry"],
            arguments=entry["xacro_args"],
            package_roots=tuple(root for name in entry["package_roots"] if (root := folder / name).is_dir()),
            expands=entry["expands"],
            links=entry.get("urdf_links") or 0,
        )


def check_robot(robot: RealRobot, texts: Mapping[Path, str] | None = None) -> Run:
    """Check a robot in this process as the command does by default.

    :param texts: contents of files that count instead of what is on the disk.
    """
    words = RunOptions(
        paths=(robot.entry,), arguments=dict(robot.arguments), package_paths=robot.package_roots, isolated=True, jobs=1
    )
    request, _ = make_request(words)
    if texts:
        contents = {str(path.resolve()): text.encode("utf-8") for path, text in texts.items()}
        request = replace(request, options=replace(request.options, texts=contents))
    return run(request, IN_THIS_PROCESS)
