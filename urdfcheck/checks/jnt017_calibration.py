"""JNT017 reports calibration positions outside the joint's limits."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule
from urdfcheck.model import Model
from urdfcheck.source.text.values import read_attribute_number


def check(model: Model, rule: Rule, *, slack: float) -> Iterator[Finding]:
    for joint in model.joints:
        calibration = joint.element.find_child("calibration")
        if calibration is None or joint.position_range is None:
            continue  # without a range: JNT004, JNT005
        lower, upper = joint.position_range
        for edge in ("rising", "falling"):
            value = read_attribute_number(calibration, edge)
            if value is not None and not lower - slack <= value <= upper + slack:
                yield rule.finding(
                    "outside",
                    at=calibration.attributes[edge],
                    related=[] if joint.limit is None else [joint.limit],
                    joint=joint.name,
                    edge=edge,
                    value=value,
                    lower=lower,
                    upper=upper,
                    unit=joint.position_unit,
                )
