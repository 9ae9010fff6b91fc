"""The joints of a model, as a table."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

from urdfcheck.core.records import dataclass
from urdfcheck.core.scene import Scene, SceneJoint
from urdfcheck.output.html.element_names import render_element_name
from urdfcheck.output.html.html_text import NO_VALUE, escape_html, format_millimetres, format_number
from urdfcheck.output.html.tables.html_table import render_name_cell, render_table
from urdfcheck.output.shared.anchors import ElementKey, SeverityMark


def render_joints_table(scene: Scene, marks: Mapping[ElementKey, SeverityMark]) -> str:
    """Render a row for each joint, with a column for each optional property that at least one of them has; above them the
    joints that are not drawn at zero."""
    extra = [
        column for column in _OPTIONAL_COLUMNS if any(column.format_cell(joint) != NO_VALUE for joint in scene.joints)
    ]
    units = {column.head: _list_units(column, scene) for column in extra}
    head = (
        '<tr><th scope="col">Joint</th><th scope="col">Type</th><th scope="col">Parent</th><th scope="col">Child</th>'
        '<th scope="col">Axis<br><small>joint frame</small></th><th scope="col">Limits</th>'
        + "".join(f'<th scope="col" class="{c.css_class}">{_render_head(c, units[c.head])}</th>' for c in extra)
        + "</tr>"
    )
    rows = (_render_joint_row(joint, marks.get(("joint", joint.name)), extra, units) for joint in scene.joints)
    table = render_table("Axes as typed, of length one, in the frame of their joint", head, rows, is_sortable=True)
    return _render_clamped(scene) + table


def list_clamped_joints(scene: Scene) -> list[SceneJoint]:
    """List the joints whose limits exclude zero: they are drawn at the limit next to it."""
    return [joint for joint in scene.joints if joint.start != 0.0 and joint.mimic is None]


def _render_clamped(scene: Scene) -> str:
    names = [render_element_name(("joint", joint.name)) for joint in list_clamped_joints(scene)]
    if not names:
        return ""
    more = f" and {len(names) - _MOST_NAMED} more" if len(names) > _MOST_NAMED else ""
    listed = f"{', '.join(names[:_MOST_NAMED])}{more}"
    return f"<p>Zero is outside the limits of {listed}: drawn at the limit next to it.</p>"


@dataclass(frozen=True, slots=True)
class _JointColumn:
    head: str
    format_cell: Callable[[SceneJoint], str]
    css_class: str = "num"
    unit: str = ""
    linear_unit: str = ""
    """Of a prismatic joint."""


def _format_mimic(joint: SceneJoint) -> str:
    if joint.mimic is None:
        return NO_VALUE
    master, multiplier, offset = joint.mimic
    times = "" if multiplier == 1 else f"{format_number(multiplier)} × "
    plus = "" if offset == 0 else f" {'−' if offset < 0 else '+'} {format_number(abs(offset))}"
    return f"{times}{render_element_name(('joint', master))}{plus}"


_OPTIONAL_COLUMNS = (
    _JointColumn("Mimics", _format_mimic, "vector"),
    _JointColumn("Effort", lambda joint: format_number(joint.effort), unit="N·m", linear_unit="N"),
    _JointColumn("Velocity", lambda joint: format_number(joint.velocity), unit="rad/s", linear_unit="m/s"),
    _JointColumn("Damping", lambda joint: format_number(joint.damping), unit="N·m·s/rad", linear_unit="N·s/m"),
    _JointColumn("Friction", lambda joint: format_number(joint.friction), unit="N·m", linear_unit="N"),
)
_LINEAR = "prismatic"
# Joints that are named before the rest is counted.
_MOST_NAMED = 8


def _render_head(column: _JointColumn, units: Sequence[str]) -> str:
    """Render a head with the unit of its numbers; where they have two units, each number has its own."""
    return f"{column.head}<br><small>{units[0]}</small>" if len(units) == 1 else column.head


def _list_units(column: _JointColumn, scene: Scene) -> list[str]:
    known = [joint for joint in scene.joints if column.format_cell(joint) != NO_VALUE]
    return sorted({unit for joint in known if (unit := _get_unit(column, joint))})


def _get_unit(column: _JointColumn, joint: SceneJoint) -> str:
    return column.linear_unit if joint.type == _LINEAR else column.unit


def _render_cell(column: _JointColumn, joint: SceneJoint, units: Sequence[str]) -> str:
    text = column.format_cell(joint)
    if text == NO_VALUE or len(units) < 2:
        return text
    return f"{text} <small>{_get_unit(column, joint)}</small>"


def _render_joint_row(
    joint: SceneJoint,
    mark: SeverityMark | None,
    extra: Sequence[_JointColumn],
    units: Mapping[str, Sequence[str]],
) -> str:
    axis = NO_VALUE if joint.turn is None else ", ".join(format_number(round(a, 4) + 0.0) for a in joint.turn)
    more = "".join(
        f'<td class="{column.css_class}">{_render_cell(column, joint, units[column.head])}</td>' for column in extra
    )
    parent, child = (render_element_name(("link", name)) for name in (joint.parent, joint.child))
    return (
        f"<tr>{render_name_cell(('joint', joint.name), mark)}<td>{escape_html(joint.type)}</td>"
        f'<td>{parent}</td><td>{child}</td><td class="vector">{axis}</td>'
        f'<td class="vector">{_format_limits(joint)}</td>{more}</tr>'
    )


def _format_limits(joint: SceneJoint) -> str:
    if joint.lower is None and joint.upper is None:
        return NO_VALUE
    if joint.type == _LINEAR:
        ends = [NO_VALUE if v is None else format_millimetres(v) for v in (joint.lower, joint.upper)]
        return f"{ends[0]} … {ends[1]} mm"
    ends = [format_number(v) for v in (joint.lower, joint.upper)]
    degrees = [
        NO_VALUE if v is None else format_number(round(math.degrees(v), 1) + 0.0) for v in (joint.lower, joint.upper)
    ]
    return f"{ends[0]} … {ends[1]} rad <small>({degrees[0]}° … {degrees[1]}°)</small>"
