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
    """Render a row for each joint, with a column for each optional property that at least one of them has."""
    extra = [
        column for column in _OPTIONAL_COLUMNS if any(column.format_cell(joint) != NO_VALUE for joint in scene.joints)
    ]
    head = (
        '<tr><th scope="col">Joint</th><th scope="col">Type</th><th scope="col">Parent</th><th scope="col">Child</th>'
        '<th scope="col">Axis</th><th scope="col">Limits</th>'
        + "".join(f'<th scope="col" class="{c.css_class}">{c.head}</th>' for c in extra)
        + "</tr>"
    )
    rows = (_render_joint_row(joint, marks.get(("joint", joint.name)), extra) for joint in scene.joints)
    linear = ". Of a prismatic joint: N, m/s, N·s/m" if any(column.css_class == "num" for column in extra) else ""
    return render_table(f"Axes in the base frame, all joints at zero{linear}", head, rows, is_sortable=True)


@dataclass(frozen=True, slots=True)
class _JointColumn:
    head: str
    format_cell: Callable[[SceneJoint], str]
    css_class: str = "num"


def _format_mimic(joint: SceneJoint) -> str:
    if joint.mimic is None:
        return NO_VALUE
    master, multiplier, offset = joint.mimic
    times = "" if multiplier == 1 else f"{format_number(multiplier)} × "
    plus = "" if offset == 0 else f" {'−' if offset < 0 else '+'} {format_number(abs(offset))}"
    return f"{times}{render_element_name(('joint', master))}{plus}"


_OPTIONAL_COLUMNS = (
    _JointColumn("Mimics", _format_mimic, "vector"),
    _JointColumn("Effort<br><small>N·m</small>", lambda joint: format_number(joint.effort)),
    _JointColumn("Velocity<br><small>rad/s</small>", lambda joint: format_number(joint.velocity)),
    _JointColumn("Damping<br><small>N·m·s/rad</small>", lambda joint: format_number(joint.damping)),
    _JointColumn("Friction<br><small>N·m</small>", lambda joint: format_number(joint.friction)),
)


def _render_joint_row(joint: SceneJoint, mark: SeverityMark | None, extra: Sequence[_JointColumn]) -> str:
    axis = NO_VALUE if joint.axis is None else ", ".join(format_number(round(a, 4) + 0.0) for a in joint.axis)
    more = "".join(f'<td class="{column.css_class}">{column.format_cell(joint)}</td>' for column in extra)
    parent, child = (render_element_name(("link", name)) for name in (joint.parent, joint.child))
    return (
        f"<tr>{render_name_cell(('joint', joint.name), mark)}<td>{escape_html(joint.type)}</td>"
        f'<td>{parent}</td><td>{child}</td><td class="vector">{axis}</td>'
        f'<td class="vector">{_format_limits(joint)}</td>{more}</tr>'
    )


def _format_limits(joint: SceneJoint) -> str:
    if joint.lower is None and joint.upper is None:
        return NO_VALUE
    if joint.type == "prismatic":
        ends = [NO_VALUE if v is None else format_millimetres(v) for v in (joint.lower, joint.upper)]
        return f"{ends[0]} … {ends[1]} mm"
    ends = [format_number(v) for v in (joint.lower, joint.upper)]
    degrees = [
        NO_VALUE if v is None else format_number(round(math.degrees(v), 1) + 0.0) for v in (joint.lower, joint.upper)
    ]
    return f"{ends[0]} … {ends[1]} rad <small>({degrees[0]}° … {degrees[1]}°)</small>"
