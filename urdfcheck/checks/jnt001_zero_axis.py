"""JNT001 reports joint axes of length zero."""

from __future__ import annotations

import math
from collections.abc import Iterator

from urdfcheck.core import Finding, Rule
from urdfcheck.model import Model


def check(model: Model, rule: Rule, *, min_norm: float) -> Iterator[Finding]:
    for joint in model.joints:
        axis, element = joint.axis, joint.axis_element
        if joint.has_axis and axis is not None and element is not None and math.hypot(*axis) < min_norm:
            at = element.attributes.get("xyz", element)
            yield rule.finding("zero", at=at, joint=joint.name, axis=element.get("xyz"))
