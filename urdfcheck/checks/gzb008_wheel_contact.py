"""GZB008 reports driven wheels without friction in Gazebo, and fixed casters that drag with it."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import TYPE_CHECKING

from urdfcheck.core import Finding, Rule
from urdfcheck.core.text import join_names
from urdfcheck.model.ground.drive_plugins import read_friction
from urdfcheck.model.wheel_names import CASTER_NAME, WHEEL_NAME

if TYPE_CHECKING:
    from urdfcheck.model import Model
    from urdfcheck.source.text.xml import Element

_KEYS = ("mu1", "mu2")
# Plugins that turn wheels, and those that push the whole robot, with wheels that only follow.
_TURNS = re.compile(r"diff[-_]?drive|skid[-_]?steer|ros2?_control", re.IGNORECASE)
_PUSHES = re.compile(r"move|velocity[-_]control|mecanum|omni", re.IGNORECASE)


def check(model: Model, rule: Rule, *, slippery: float, rough: float) -> Iterator[Finding]:
    blocks = [block for block in model.robot.find_children("gazebo") if block.get("reference") in model.link_by_name]
    frictions = [(block, friction) for block in blocks if (friction := read_friction(block)) is not None]
    if not frictions:
        return
    smooth = [block for block, friction in frictions if max(friction) <= slippery]
    if smooth and _turns_wheels(model):
        from urdfcheck.model.ground.wheels import find_driven_wheels

        driven = {wheel.joint.child for wheel in find_driven_wheels(model)}
        bare = [b for b in smooth if b.get("reference") in driven and WHEEL_NAME.search(b.get("reference"))]
        slides = {block.get("reference") for block in smooth}
        stands_on_parts = any(_has_gripping_part(model, block.get("reference"), slides) for block in bare)
        # Of mecanum and omni wheels some slide on purpose; all of them do not.
        if bare and not stands_on_parts and len(bare) == sum(bool(WHEEL_NAME.search(name)) for name in driven):
            yield _build_finding(rule, "slides", bare)
    # What pushes the whole robot moves it whatever drags.
    dragging = [
        b
        for b, friction in frictions
        if min(friction) >= rough and _is_fixed_caster(model, b) and not _has_plugin(model, _PUSHES)
    ]
    if dragging:
        yield _build_finding(rule, "drags", dragging)


def _build_finding(rule: Rule, message: str, blocks: list[Element]) -> Finding:
    first = next(element for element in blocks[0].children if element.tag in _KEYS)
    friction = read_friction(blocks[0])
    return rule.finding(
        message,
        at=first,
        related=blocks[1:],
        links=join_names(block.get("reference") for block in blocks),
        friction=max(friction or (0.0,)),
    )


def _turns_wheels(model: Model) -> bool:
    return _has_plugin(model, _TURNS) and not _has_plugin(model, _PUSHES)


def _has_plugin(model: Model, pattern: re.Pattern[str]) -> bool:
    plugins = (p for block in model.robot.find_children("gazebo") for p in block.find_children("plugin"))
    return any(pattern.search(plugin.get("filename")) for plugin in plugins)


def _has_gripping_part(model: Model, wheel: str, slides: set[str]) -> bool:
    """Whether a link below a wheel touches and does not slide: rollers or a tyre, for which the hub slides on purpose."""
    waiting = [wheel]
    while waiting:
        for joint in model.tree.child_joints.get(waiting.pop(), ()):
            if (
                joint.child not in slides
                and model.link_by_name[joint.child].element.find_child("collision") is not None
            ):
                return True
            waiting.append(joint.child)
    return False


def _is_fixed_caster(model: Model, block: Element) -> bool:
    """Whether a caster touches and cannot roll: the bracket of one that rolls has its wheel below it."""
    name = block.get("reference")
    joint = model.tree.parent_joint.get(name)
    if not CASTER_NAME.search(name) or joint is None or joint.type != "fixed":
        return False
    return bool(model.link_by_name[name].collisions) and not any(
        below.is_movable for below in model.tree.child_joints.get(name, ())
    )
