"""Real robots against edited copies of themselves, two of each kind; all with ``URDFCHECK_CORPUS_FULL=1``."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path

import pytest
from conftest import make_request
from real_robots import IS_FULL, list_robots, select_by_trait
from transforms import Robot, with_defaults
from versions import PRESERVING, list_origins, write_robot

from urdfcheck.changes.wording import describe_change
from urdfcheck.core import FactUnavailableError
from urdfcheck.core.mechanism import RobotMechanism
from urdfcheck.export.mechanism_builder import build_mechanism
from urdfcheck.facts.comparison.compare import compare_mechanisms
from urdfcheck.model import Model
from urdfcheck.run.jobs import Request
from urdfcheck.simulators.engine_input import build_input
from urdfcheck.source.load import Source, load_source
from urdfcheck.source.package.finder import PackageFinder

pytestmark = [pytest.mark.slow, pytest.mark.long]

# Links of the robots that are taken unless all are: each edit of a robot copies it for each link.
MOST_LINKS = 25


def read_source(path: Path, request: Request) -> Source:
    finder = PackageFinder(path.absolute(), request.packages.by_name, request.packages.search_path)
    return load_source(path, request.arguments, finder)


def read_mechanism(path: Path, request: Request) -> RobotMechanism | None:
    """Read a robot without its meshes; None for one that is not a tree of links."""
    source = read_source(path, request)
    if source.root is None or source.root.tag != "robot":
        return None
    try:
        return build_mechanism(Model(source=source, robot=source.root, tier="source"), path.name)
    except FactUnavailableError:
        return None


def expand(path: Path, request: Request) -> Robot | None:
    """Return the expanded robot with the origins that its file leaves out; None where it cannot be edited."""
    found = build_input(read_source(path, request), None)
    if found is None:
        return None
    try:
        robot = with_defaults(ET.fromstring(found.document))
    except (ET.ParseError, ValueError):
        return None
    placed = {id(origin) for _, origin in list_origins(robot)}
    # The edits rewrite every origin in a link, whatever it means there.
    return (
        robot if all(id(origin) in placed for link in robot.findall("link") for origin in link.iter("origin")) else None
    )


def test_what_leaves_real_robots_as_they_are_is_no_change(corpus: Path, tmp_path: Path) -> None:
    if not (corpus / "corpus.json").is_file():
        pytest.skip("a folder of repositories")
    robots = select_by_trait(
        [
            robot
            for robot in list_robots(corpus)
            if robot["expands"] and (IS_FULL or robot.get("urdf_links", 0) <= MOST_LINKS)
        ],
        lambda robot: [robot.get("kind")],
        times=2,
    )
    wrong: dict[str, list[str]] = {}
    compared = 0
    for entry in robots:
        path = corpus / entry["entry"]
        request = make_request(
            path, arguments=entry["xacro_args"], package_paths=tuple(corpus / root for root in entry["package_roots"])
        )
        robot = expand(path, request)
        file = tmp_path / "robot.urdf.xacro"
        if robot is None:
            continue
        file.write_text(write_robot(robot))
        first = read_mechanism(file, request)
        if first is None:
            continue
        for name, change in PRESERVING.items():
            try:
                file.write_text(write_robot(change(robot)))
            except (ValueError, KeyError, AssertionError, StopIteration):
                continue  # a number that the edit would have to read is malformed
            second = read_mechanism(file, request)
            assert second is not None, f"{entry['id']}: {name}"
            there, back = compare_mechanisms(first, second), compare_mechanisms(second, first)
            compared += 1
            if there.changes or back.changes:
                wrong[f"{entry['id']}: {name}"] = [describe_change(c) for c in (*there.changes, *back.changes)][:3]
    assert wrong == {}
    assert compared > len(robots) * len(PRESERVING) / 2
