"""CTL006 reports interfaces of `<ros2_control>` whose name is nearly a standard one, and values that do not fit the joint."""

from __future__ import annotations

import difflib
import math
import re
from collections.abc import Iterator, Mapping
from typing import Any

from urdfcheck.core import Finding, Location, Rule, Severity
from urdfcheck.model import Joint, Model
from urdfcheck.model.repairs.edits import edit_literal, locate_content
from urdfcheck.source.text.values import parse_number
from urdfcheck.source.text.xml import Element

# hardware_interface/types/hardware_interface_type_values.hpp
STANDARD = ("position", "velocity", "effort", "acceleration")
# How alike a misspelled name is: `postion` 0.93, `positions` 0.94; `commanded_position` is 0.62.
_LIKENESS = 0.85
_LIMITS, _START = ("min", "max"), "initial_value"


def check(model: Model, rule: Rule, *, rel_tol: float) -> Iterator[Finding]:
    for block in model.robot.find_children("ros2_control"):
        for component in block.find_children("joint"):
            joint = model.joint_by_name.get(component.get("name"))
            for interface in component.children:
                if interface.tag in {"command_interface", "state_interface"}:
                    yield from _check_name(rule, component, interface)
                    yield from _check_values(model, rule, interface, joint, rel_tol=rel_tol)


def _check_name(rule: Rule, component: Element, interface: Element) -> Iterator[Finding]:
    """Report a name that is a standard one except for a letter or its case: controllers ask for the standard name."""
    name = interface.attributes.get("name")
    if name is None or name.value in STANDARD or not name.value.isalpha():
        return
    near = difflib.get_close_matches(name.value.lower(), STANDARD, n=1, cutoff=_LIKENESS)
    if near:
        edits = edit_literal(name, near[0])
        yield rule.finding("name", at=name, edits=edits, joint=component.get("name"), name=name.value, near=near[0])


def _check_values(
    model: Model, rule: Rule, interface: Element, joint: Joint | None, *, rel_tol: float
) -> Iterator[Finding]:
    """Report values that are not numbers, that contradict each other, or that do not fit the limits of the joint."""
    where = _describe(interface, joint)
    values: dict[str, tuple[float, Location]] = {}
    for param in interface.find_children("param"):
        key, text = param.get("name").strip(), param.text.strip()
        if key not in {*_LIMITS, _START} or not text:
            continue
        number, at = parse_number(text), locate_content(param, model.source.files)
        if number is not None:
            values[key] = number, at
        elif interface.get("data_type", "double") == "double":
            yield rule.finding(
                "number",
                at=at,
                key=key,
                value=text,
                where=where,
                lost="a plugin cannot read the start" if key == _START else "ros2_control ignores the limit",
                repair=_describe_number_repair(text, is_xacro=model.source.is_xacro),
            )
    low, high = values.get("min"), values.get("max")
    if low is not None and high is not None and low[0] > high[0]:
        yield rule.finding("inverted", at=low[1], related=[high[1]], low=low[0], high=high[0], where=where)
    elif joint is not None and joint.position_range is not None and interface.get("name") == "position":
        yield from _check_positions(rule, interface, joint, values, joint.position_range, rel_tol=rel_tol)


def _describe_number_repair(text: str, *, is_xacro: bool) -> str:
    """Say what to write: the expression of xacro whose dollar sign is missing, or a number."""
    expression = re.fullmatch(r"(-?)\s*\{([^{}$]+)\}", text)
    if expression is None or not is_xacro:
        return "write a number"
    sign, inside = expression[1], expression[2].strip()
    return f"write `${{{f'-({inside})' if sign else inside}}}`, with the dollar sign before the braces"


def _check_positions(
    rule: Rule,
    interface: Element,
    joint: Joint,
    values: Mapping[str, tuple[float, Location]],
    span: tuple[float, float],
    *,
    rel_tol: float,
) -> Iterator[Finding]:
    lower, upper = span
    slack = rel_tol * (upper - lower)
    data: dict[str, Any] = {"lower": lower, "upper": upper, "unit": joint.position_unit}
    data["where"] = _describe(interface, joint)
    data["related"] = [] if joint.limit is None else [joint.limit]
    if _START in values:
        start, at = values[_START]
        if not lower - slack <= start <= upper + slack:
            yield rule.finding("start", at=at, value=start, hint=_describe_degrees(start, joint), **data)
    if interface.tag != "command_interface":  # the parser takes limits from commands only
        return
    for key in (key for key in _LIMITS if key in values):
        number, at = values[key]
        if number > upper + slack if key == "min" else number < lower - slack:
            yield rule.finding("empty", at=at, key=key, value=number, **data)
        elif number < lower - slack if key == "min" else number > upper + slack:
            yield rule.finding("loose", at=at, severity=Severity.INFO, key=key, value=number, **data)


def _describe(interface: Element, joint: Joint | None) -> str:
    owner = interface.parent.get("name") if interface.parent is not None else ""
    return f"{owner or (joint.name if joint else '')}/{interface.get('name')}"


def _describe_degrees(value: float, joint: Joint) -> str:
    """Return a remark if the value is more than a turn, and fits the range as degrees."""
    span = joint.position_range
    # Any small number would fit.
    if (
        span is None
        or joint.type != "revolute"
        or abs(value) <= 2 * math.pi
        or not span[0] <= math.radians(value) <= span[1]
    ):
        return ""
    return f"; as degrees it is {math.radians(value):.3g} rad, within the limits"
