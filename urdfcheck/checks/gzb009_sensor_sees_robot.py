"""GZB009 reports range sensors whose rays end at their own robot."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.text import format_length, join_names
from urdfcheck.model import Model
from urdfcheck.model.gazebo import list_sensors
from urdfcheck.model.parts import locate_geometry
from urdfcheck.model.use.gazebo_starts import is_unread
from urdfcheck.model.use.other_programs import names_scan_filter

if TYPE_CHECKING:
    from urdfcheck.model.shapes.sensor_rays import SelfScan

# Of the rays: with more of them left out, the sensor is of no use (chosen).
_MOST_LEFT_OUT = 0.5
# m: a sensor that sees nothing so near is no worse for it (chosen); farther, obstacles are lost too.
_MOST_BLIND = 0.3

_UNREAD = "computes a scan that no plugin of the robot reads"
_AS_FLOOR = "publishes the robot in place of the floor: no cliff is seen"


def check(model: Model, rule: Rule, *, least: float) -> Iterator[Finding]:
    if not list_sensors(model):
        return
    from urdfcheck.model.shapes.sensor_rays import scan_robot

    for scan in scan_robot(model):
        if scan.share > least:
            yield _build_finding(model, rule, scan, least=least)


def _build_finding(model: Model, rule: Rule, scan: SelfScan, *, least: float) -> Finding:
    if scan.turned is not None and scan.turned.straight_share <= least:
        return rule.finding(
            "turned",
            at=scan.sensor.element.find_child("pose") or scan.sensor.element,
            related=[locate_geometry(seen.shape) for seen in scan.seen],
            sensor=scan.sensor.name,
            share=scan.share,
            links=join_names(dict.fromkeys(seen.link for seen in scan.seen)),
            straight=scan.turned.straight_share,
            frame=scan.turned.frame,
            angle=math.degrees(scan.turned.angle),
        )
    is_filtered = names_scan_filter(model)
    within = join_names(dict.fromkeys(seen.link for seen in scan.seen if seen.holds_sensor))
    beyond = scan.farthest + 0.005
    unread = is_unread(model, scan.sensor)
    return rule.finding(
        "cloud" if scan.layers > 1 else "filtered" if is_filtered else "inside" if within else "sees",
        at=scan.sensor.element,
        related=[locate_geometry(seen.shape) for seen in scan.seen],
        severity=Severity.INFO if scan.layers > 1 or is_filtered or unread else None,
        consequences={"gazebo": _UNREAD if unread else _AS_FLOOR} if unread or scan.looks_down else None,
        sensor=scan.sensor.name,
        share=scan.share,
        links=join_names(dict.fromkeys(seen.link for seen in scan.seen)),
        within=within,
        sectors=join_names(scan.describe_sectors()),
        nearest=format_length(scan.nearest),
        farthest=format_length(scan.farthest),
        rays="all its rays end" if scan.share == 1.0 else f"{scan.share:.1%} of its rays end",
        distance=" to ".join(dict.fromkeys(map(format_length, (scan.nearest, scan.farthest)))),
        range=format_length(scan.least),
        angles="; if both are right, leave out these angles (min_angle, max_angle)"
        if scan.share < _MOST_LEFT_OUT
        else "",
        farther=f", or write {beyond:.2f} in <min> of its <range>" if beyond <= _MOST_BLIND else "",
    )
