"""Edits of published robots, compared with the robots as they are: ``python benchmarks/diff/edits.py``.

The robots are those of the folders that ``URDFCHECK_CORPUS`` names, expanded and without their meshes. The edits of
``tests/versions.py`` leave a robot what it is: a change is a false one. Those of `PLANTED` change one part: anything but the one
change, there and back, is wrong. Prints Markdown tables, and each wrong comparison.
"""

from __future__ import annotations

import argparse
import copy
import os
import random
import re
import sys
import tempfile
import xml.etree.ElementTree as ET
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

sys.path.append(str(Path(__file__).parents[2] / "tests"))
sys.path.append(str(Path(__file__).parents[2] / "tests" / "changes"))

from conftest import make_request
from real_robots import list_robots
from test_real_versions import expand, read_mechanism
from transforms import Robot
from versions import PRESERVING, write_robot

from urdfcheck.changes.wording import describe_change
from urdfcheck.core.mechanism import RobotMechanism
from urdfcheck.core.model_diff import MechanismDiff
from urdfcheck.facts.comparison.compare import compare_mechanisms
from urdfcheck.run.jobs import Request

# What an edit of one part did: the ids of the changes, of which one must be reported alone, and the part.
Planted = tuple[Robot, frozenset[str], str]
ROTATING, MOVING = {"revolute", "continuous"}, {"revolute", "continuous", "prismatic"}


def main() -> None:
    """Edit every robot, and print how often the comparison was right."""
    parser = argparse.ArgumentParser(prog="python benchmarks/diff/edits.py", description=__doc__.partition(":")[0])
    parser.add_argument("--most-links", type=int, default=60, help="leave out larger robots (default: 60)")
    parser.add_argument(
        "--robots", default="", metavar="PATTERN", help="only those whose name has this regular expression"
    )
    parser.add_argument("--keep", type=Path, help="write the pairs of texts into this folder")
    options = parser.parse_args()
    right: Counter[str] = Counter()
    tried: Counter[str] = Counter()
    robots = 0
    with tempfile.TemporaryDirectory() as folder:
        for name, robot, request in _iter_robots(options.robots):
            if not 1 < len(robot.findall("link")) <= options.most_links:
                continue
            robots += 1
            for kind, changed, wrong in _judge_edits(name, robot, request, Path(folder)):
                tried[kind] += 1
                right[kind] += not wrong
                if wrong:
                    print(f"wrong: {name}: {kind}: {wrong}", flush=True)
                if options.keep is not None:
                    _keep_pair(options.keep / f"{robots:03}-{kind.replace(' ', '_')}", robot, changed)
    print(f"{robots} robots\n\n| edit | robots | right |\n|---|---:|---:|")
    for kind, count in tried.items():
        print(f"| {kind} | {count} | {right[kind]} |")


def _iter_robots(pattern: str) -> Iterator[tuple[str, Robot, Request]]:
    """Yield the expanded robots with names that have a pattern, each structure once."""
    known: set[str] = set()
    for folder in map(Path, filter(None, os.environ.get("URDFCHECK_CORPUS", "").split(os.pathsep))):
        for entry in list_robots(folder):
            if not entry["expands"] or not re.search(pattern, entry["id"]):
                continue
            path = folder / entry["entry"]
            request = make_request(
                path,
                arguments=entry["xacro_args"],
                package_paths=tuple(folder / root for root in entry["package_roots"]),
            )
            robot = expand(path, request)
            text = "" if robot is None else write_robot(robot)
            if robot is not None and text not in known:
                known.add(text)
                yield entry["id"], robot, request


def _judge_edits(name: str, robot: Robot, request: Request, folder: Path) -> Iterator[tuple[str, Robot, str]]:
    """Yield each edit that this robot allows, the edited robot, and what is wrong about the comparison; empty if nothing."""
    before = _read(robot, request, folder)
    if before is None:
        return
    for kind, change in PRESERVING.items():
        try:
            changed = change(robot)
            after = _read(changed, request, folder)
        except (ValueError, KeyError, AssertionError, StopIteration):
            continue  # a number that the edit would have to read is malformed
        yield kind, changed, "the edited robot is not read" if after is None else _list_changes(before, after)
    for kind, plant in PLANTED.items():
        try:
            planted = plant(copy.deepcopy(robot), random.Random(f"{name} {kind}"))
        except (ValueError, KeyError):
            continue
        after = None if planted is None else _read(planted[0], request, folder)
        if planted is None or after is None:
            continue
        changed, ids, subject = planted
        found = [compare_mechanisms(before, after), compare_mechanisms(after, before)]
        is_right = all(len(f.changes) == 1 and f.changes[0].id in ids for f in found)
        is_right &= not found[0].changes or found[0].changes[0].subject == subject
        yield kind, changed, "" if is_right else f"{subject}: {'; '.join(map(_describe, found))}"


def _read(robot: Robot, request: Request, folder: Path) -> RobotMechanism | None:
    file = folder / "robot.urdf.xacro"
    file.write_text(write_robot(robot), encoding="utf-8")
    return read_mechanism(file, request)


def _list_changes(before: RobotMechanism, after: RobotMechanism) -> str:
    found = compare_mechanisms(before, after), compare_mechanisms(after, before)
    return "; ".join(_describe(each) for each in found if each.changes)


def _describe(found: MechanismDiff) -> str:
    return ", ".join(map(describe_change, found.changes[:3])) or "nothing"


def _keep_pair(folder: Path, before: Robot, after: Robot) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    for name, robot in (("old", before), ("new", after)):
        (folder / f"{name}.urdf").write_text(write_robot(robot), encoding="utf-8")


# -- edits that change one part ----------------------------------------------------------------------------------------


def _choose_joint(robot: Robot, chance: random.Random, types: set[str], needed: str = "parent") -> ET.Element | None:
    found = [j for j in robot.findall("joint") if j.get("type") in types and j.find(needed) is not None]
    return chance.choice(found) if found else None


def _add_numbers(element: ET.Element, name: str, added: tuple[float, ...], default: str = "0 0 0") -> None:
    values = map(float, element.get(name, default).split())
    element.set(name, " ".join(repr(value + more) for value, more in zip(values, added, strict=True)))


def _subject(part: ET.Element) -> str:
    return f"{part.tag}[{part.get('name')}]"


def _move_joint(types: set[str], name: str, added: tuple[float, ...], *ids: str) -> Callable[..., Planted | None]:
    def plant(robot: Robot, chance: random.Random) -> Planted | None:
        joint = _choose_joint(robot, chance, types, "origin")
        if joint is None:
            return None
        origin = joint.find("origin")
        assert origin is not None
        _add_numbers(origin, name, added)
        return robot, frozenset(ids), _subject(joint)

    return plant


def _reverse_axis(robot: Robot, chance: random.Random) -> Planted | None:
    joint = _choose_joint(robot, chance, MOVING, "axis")
    if joint is None:
        return None
    axis = joint.find("axis")
    assert axis is not None
    axis.set("xyz", " ".join(repr(-float(word)) for word in axis.attrib["xyz"].split()))
    return robot, frozenset({"axis-reversed"}), _subject(joint)


def _tilt_axis(robot: Robot, chance: random.Random) -> Planted | None:
    joint = _choose_joint(robot, chance, MOVING, "axis")
    if joint is None:
        return None
    axis = joint.find("axis")
    assert axis is not None
    x, y, z = map(float, axis.attrib["xyz"].split())
    axis.set("xyz", f"{x - 0.1 * y!r} {y + 0.1 * x - 0.1 * z!r} {z + 0.1 * y!r}")
    return robot, frozenset({"axis-tilted"}), _subject(joint)


def _fix_joint(robot: Robot, chance: random.Random) -> Planted | None:
    joint = _choose_joint(robot, chance, MOVING)
    if joint is None:
        return None
    joint.set("type", "fixed")
    return robot, frozenset({"type"}), _subject(joint)


def _scale_value(
    types: set[str], child: str, name: str, factor: float, change: str | None = None
) -> Callable[..., Planted | None]:
    def plant(robot: Robot, chance: random.Random) -> Planted | None:
        found = [
            (joint, element)
            for joint in robot.findall("joint")
            if joint.get("type") in types
            and (element := joint.find(child)) is not None
            and float(element.get(name, "0"))
        ]
        if not found:
            return None
        joint, element = chance.choice(found)
        element.set(name, repr(float(element.attrib[name]) * factor))
        return robot, frozenset({change or name}), _subject(joint)

    return plant


def _edit_inertial(child: str, edit: Callable[[ET.Element], None], what: str) -> Callable[..., Planted | None]:
    def plant(robot: Robot, chance: random.Random) -> Planted | None:
        found = [
            (link, inertial)
            for link in robot.findall("link")
            if (inertial := link.find("inertial")) is not None
            and inertial.find(child) is not None
            and (mass := inertial.find("mass")) is not None
            and float(mass.get("value", "0")) > 1e-6
            and (tensor := inertial.find("inertia")) is not None
            and float(tensor.get("ixx", "0")) > 0.0
        ]
        if not found:
            return None
        link, inertial = chance.choice(found)
        element = inertial.find(child)
        assert element is not None
        edit(element)
        return robot, frozenset({what}), _subject(link)

    return plant


def _scale_attribute(name: str, factor: float) -> Callable[[ET.Element], None]:
    return lambda element: element.set(name, repr(float(element.attrib[name]) * factor))


def _edit_shape(role: str, path: str, edit: Callable[[ET.Element], None], what: str) -> Callable[..., Planted | None]:
    def plant(robot: Robot, chance: random.Random) -> Planted | None:
        found = [
            (link, element)
            for link in robot.findall("link")
            for shape in link.findall(role)
            if (element := shape.find(path)) is not None and float(element.get("radius", "1")) > 0.0
        ]
        if not found:
            return None
        link, element = chance.choice(found)
        edit(element)
        return robot, frozenset({what}), _subject(link)

    return plant


def _rename_robot(robot: Robot, _chance: random.Random) -> Planted:
    robot.set("name", robot.get("name", "") + "_2")
    return robot, frozenset({"robot-renamed"}), "robot"


def _add_plugin(robot: Robot, _chance: random.Random) -> Planted:
    robot.append(ET.fromstring('<gazebo reference="planted"><mu1>0.8</mu1></gazebo>'))
    return robot, frozenset({"extra-added", "extra-removed"}), "gazebo[planted]"


PLANTED: Mapping[str, Callable[..., Planted | None]] = {
    "a joint moved": _move_joint(MOVING, "xyz", (0.013, 0.011, 0.017), "joint-moved", "zero-offset"),
    "a joint turned": _move_joint(MOVING, "rpy", (0.11, 0.07, 0.13), "joint-moved", "zero-offset"),
    "a fixed joint moved": _move_joint({"fixed"}, "xyz", (0.0, 0.0, 0.02), "joint-moved"),
    "an axis reversed": _reverse_axis,
    "an axis tilted": _tilt_axis,
    "a type": _fix_joint,
    "an upper limit": _scale_value({"revolute", "prismatic"}, "limit", "upper", 1.1),
    "a lower limit": _scale_value({"revolute", "prismatic"}, "limit", "lower", 1.1),
    "an effort": _scale_value(MOVING, "limit", "effort", 1.2),
    "a velocity": _scale_value(MOVING, "limit", "velocity", 1.2),
    "damping": _scale_value(MOVING, "dynamics", "damping", 1.5),
    "friction": _scale_value(MOVING, "dynamics", "friction", 1.5),
    "a mimic": _scale_value(MOVING, "mimic", "multiplier", 0.5, "mimic"),
    "a mass": _edit_inertial("mass", _scale_attribute("value", 1.5), "mass"),
    "a COM": _edit_inertial("origin", lambda origin: _add_numbers(origin, "xyz", (0.0, 0.0, 0.01)), "com"),
    "a tensor": _edit_inertial("inertia", _scale_attribute("ixx", 1.2), "tensor"),
    "a sphere resized": _edit_shape("collision", "geometry/sphere", _scale_attribute("radius", 1.3), "shape-resized"),
    "a cylinder resized": _edit_shape(
        "collision", "geometry/cylinder", _scale_attribute("radius", 1.3), "shape-resized"
    ),
    "a visual moved": _edit_shape(
        "visual", "origin", lambda origin: _add_numbers(origin, "xyz", (0.0, 0.01, 0.0)), "shape-moved"
    ),
    "a collision moved": _edit_shape(
        "collision", "origin", lambda origin: _add_numbers(origin, "xyz", (0.0, 0.01, 0.0)), "shape-moved"
    ),
    "the name of the robot": _rename_robot,
    "a plugin": _add_plugin,
}


if __name__ == "__main__":
    main()
