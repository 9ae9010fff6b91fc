"""JNT019 reports joints that may not be at zero, where programs put them without further notice."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Sequence

from urdfcheck.core import Finding, Located, Rule, Severity
from urdfcheck.core.merging import build_group_finding
from urdfcheck.core.text import join_names
from urdfcheck.model import Joint, Model
from urdfcheck.model.likeness.side_names import remove_places
from urdfcheck.model.motion.semantic_descriptions import semantic_descriptions
from urdfcheck.model.use.display import has_bare_joints
from urdfcheck.model.use.gazebo_starts import is_started_elsewhere
from urdfcheck.model.use.simulators import is_simulated, is_simulated_hardware, is_started_in_simulator
from urdfcheck.policy.consumers import SIMULATORS
from urdfcheck.source.text.values import parse_number

_LEAST_LEGS = 4
# Folders above a file that are looked through for the manifest of a project.
_LEVELS = 6
# The words of joints of a leg: two of a name are enough.
_LEG_WORDS = frozenset({"knee", "tarsus", "shin", "calf", "ankle", "foot", "leg", "hip", "thigh", "kfe", "kfj"})
# What starts joints at zero: hardware of ros2_control that stands for the real one, and the plugins of Gazebo that drive joints.
_MOCK_HARDWARE = re.compile(r"mock_components|fake_components")
_CONTROL_PLUGIN = re.compile(r"ros2?_control|[Jj]oint[-_]?([Pp]osition|[Tt]rajectory)[-_]?[Cc]ontroller")


# m, and a share of the range: fingers that never quite close are drawn so near to where they start (chosen).
_NEAR_SLIDE, _MOST_NEAR = 0.005, 0.25


def check(model: Model, rule: Rule, *, rel_tol: float, notable: float, near: float) -> Iterator[Finding]:
    placed = _collect_initial_positions(model)
    outside, limiting = [], []
    for joint in model.joints:
        span = joint.position_range
        if span is None or joint.mimic is not None or joint.name in placed or joint.is_held:
            continue
        slack = rel_tol * (span[1] - span[0])
        if span[0] > slack or span[1] < -slack:
            outside.append(joint)
        elif 0 in span:
            limiting.append(joint)
    # Simulators start every joint at zero, whatever an SRDF says.
    is_asked = not SIMULATORS.isdisjoint(model.targets)
    if outside and not (is_asked or is_simulated(model) or _is_started_by_controllers(model)):
        stated = _collect_stated_starts(model)
        outside = [joint for joint in outside if joint.name not in stated]
    if outside:
        is_near = all(_is_near(joint, near, notable) for joint in outside)
        is_meant = _are_legs(outside) or has_bare_joints(model) or is_started_elsewhere(model)
        is_meant |= _is_of_python_project(model)
        # Where nothing in a package simulates the robot, its real hardware reads where the joints are.
        is_used_elsewhere = is_simulated(model) or _is_started_by_controllers(model)
        is_meant |= model.source.package is not None and not is_used_elsewhere
        message = "near" if is_near else "meant" if is_meant else "outside"
        is_far = any(_measure_share(joint) > notable for joint in outside)
        is_warning = message == "outside" and is_far and _is_started_by_controllers(model)
        yield _build_finding(rule, message, outside, None if is_warning else Severity.INFO)
    if limiting:
        yield _build_finding(rule, "on-limit", limiting, Severity.INFO)


def _is_started_by_controllers(model: Model) -> bool:
    """Whether the file itself names what starts its joints at zero: simulated or mocked hardware of ros2_control, or a plugin of
    Gazebo that drives joints, or a simulator that a file of the project starts with transmissions.

    Real hardware reads where its joints are, and the colours of Gazebo say nothing about who starts the robot.
    """
    for control in model.robot.find_children("ros2_control"):
        plugins = [element.text for element in control.walk() if element.tag == "plugin"]
        if is_simulated_hardware(control) or any(map(_MOCK_HARDWARE.search, plugins)):
            return True
    plugins = [
        plugin.get("filename")
        for block in model.robot.find_children("gazebo")
        for plugin in block.find_children("plugin")
    ]
    if any(map(_CONTROL_PLUGIN.search, plugins)) or model.robot.find_child("mujoco") is not None:
        return True
    return model.robot.find_child("transmission") is not None and is_started_in_simulator(model)


def _is_of_python_project(model: Model) -> bool:
    """Whether the file is in no package of ROS, but in a project of Python: its programs put the joints where they start, and the
    plugins of the description that it was made from do not run."""
    if model.source.package is not None:
        return False
    manifests = [
        folder / name
        for folder in model.source.path.absolute().parents[:_LEVELS]
        for name in ("setup.py", "pyproject.toml")
    ]
    return any(model.source.finder.can_open(path) and path.is_file() for path in manifests)


def _are_legs(joints: Sequence[Joint]) -> bool:
    """Whether all joints are those of legs, which bend one way only: one joint of four or more like limbs, or joints of a leg by
    their names, each on two sides at least."""
    counts = Counter(remove_places(joint.name) for joint in joints)
    if len(counts) == 1 and len(joints) >= _LEAST_LEGS:
        return True
    return min(counts.values()) > 1 and all(not _LEG_WORDS.isdisjoint(words) for words in counts)


def _is_near(joint: Joint, near: float, notable: float) -> bool:
    """Whether zero is so near the limits that the start is hardly seen; along a slide also as a share of its range."""
    lower, upper = joint.position_range or (-1.0, 1.0)
    off, share = max(lower, -upper), _measure_share(joint)
    if joint.position_unit == "rad":
        return off < near
    return share < notable or (off < _NEAR_SLIDE and share < _MOST_NEAR)


def _measure_share(joint: Joint) -> float:
    """Return how far zero is outside the limits, as a share of the range."""
    lower, upper = joint.position_range or (-1.0, 1.0)
    return max(lower, -upper, 0.0) / (upper - lower)


def _collect_initial_positions(model: Model) -> frozenset[str]:
    """Return the joints that start elsewhere by ``initial_value`` of a ros2_control interface."""
    placed: set[str] = set()
    for control in model.robot.find_children("ros2_control"):
        for joint in control.find_children("joint"):
            params = (param for param in joint.walk() if param.tag == "param" and param.get("name") == "initial_value")
            if any(parse_number(param.text) != 0 for param in params):
                placed.add(joint.get("name"))
    return frozenset(placed)


def _collect_stated_starts(model: Model) -> frozenset[str]:
    """Return the joints that a state of a semantic description puts within their limits: MoveIt's programs move them there by its
    name, and the real robot is where it is."""
    stated: set[str] = set()
    joints = {joint.name: joint for joint in model.joints}
    for srdf in semantic_descriptions(model):
        for state in srdf.root.find_children("group_state"):
            for element in state.find_children("joint"):
                joint, value = joints.get(element.get("name").strip()), parse_number(element.get("value"))
                span = None if joint is None else joint.position_range
                if joint is not None and span is not None and value is not None and span[0] <= value <= span[1]:
                    stated.add(joint.name)
    return frozenset(stated)


def _get_bound(joint: Joint, lower: float) -> Located:
    """Return the limit on whose side zero is; the element where it is left out."""
    name = "lower" if lower >= 0 else "upper"
    limit = joint.limit
    return joint if limit is None else limit.attributes.get(name, limit)


def _build_finding(rule: Rule, message: str, joints: Sequence[Joint], severity: Severity | None) -> Finding:
    """Return one finding about all joints, at the limit that zero violates or is on."""
    ranges = [(joint, *joint.position_range) for joint in joints if joint.position_range is not None]
    first, lower, upper = max(ranges, key=lambda r: max(r[1], -r[2]))
    return build_group_finding(
        rule,
        message,
        [_get_bound(joint, lower) for joint, lower, _ in ranges],
        severity=severity,
        joints=join_names(
            f"{joint.name} ({low:.3g} … {high:.3g} {joint.position_unit})" for joint, low, high in ranges
        ),
        count=len(ranges),
        which="joint cannot" if len(ranges) == 1 else "joints cannot",
        noun="joint" if len(ranges) == 1 else "joints",
        verb="is" if len(ranges) == 1 else "are",
        worst=first.name,
        off=max(lower, -upper, 0.0),
        unit=first.position_unit,
    )
