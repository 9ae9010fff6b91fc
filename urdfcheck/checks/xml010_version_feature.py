"""XML010 reports features of newer URDF versions in a robot that does not declare them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import replace

from urdfcheck.core import Finding, Located, Rule, Severity
from urdfcheck.core.text import format_repetition
from urdfcheck.model import Model
from urdfcheck.source.text.engine_reactions import describe_loss
from urdfcheck.source.text.grammar import is_unexpanded, iter_urdf_elements, parse_urdf_version
from urdfcheck.source.text.values import parse_numbers
from urdfcheck.source.text.xml import Element

_LIMITS = ("acceleration", "deceleration", "jerk")


def check(model: Model, rule: Rule, *, tol: float) -> Iterator[Finding]:
    version = parse_urdf_version(model.robot)
    declared = model.robot.attributes.get("version")
    if version is None:
        if declared is not None and not is_unexpanded(declared.value):
            yield rule.finding("version", at=declared, severity=Severity.ERROR, version=declared.value)
        return
    if version > (1, 0) and declared is not None:
        yield rule.finding("newer", at=declared, severity=Severity.INFO, version=declared.value)
    elements = list(iter_urdf_elements(model.robot))
    turned = [e for e in elements if e.tag == "origin" and "quat_xyzw" in e.attributes]
    said = "no version" if declared is None else declared.value
    if version < (1, 1):
        yield from _build_findings(rule, "capsule", [e for e in elements if e.tag == "capsule"], said)
        yield from _build_findings(rule, "quaternion", [e.attributes["quat_xyzw"] for e in turned], said)
    else:
        for origin in turned:
            yield from _check_quaternion(rule, origin, tol)
    if version < (1, 2):
        limits = [e.attributes[name] for e in elements if e.tag == "limit" for name in _LIMITS if name in e.attributes]
        yield from _build_findings(rule, "limit", limits, said, severity=Severity.INFO)


def _check_quaternion(rule: Rule, origin: Element, tol: float) -> Iterator[Finding]:
    quaternion = parse_numbers(origin.get("quat_xyzw"), 4)
    at = origin.attributes["quat_xyzw"]
    length = None if quaternion is None else math.hypot(*quaternion)
    if "rpy" in origin.attributes:
        yield rule.finding(
            "both",
            at=at,
            severity=Severity.ERROR,
            related=[origin.attributes["rpy"]],
            consequences={"urdfdom": describe_loss(origin)},
        )
    elif length == 0:
        yield rule.finding("zero", at=at)
    elif length is not None and abs(length - 1) > tol:
        yield rule.finding("length", at=at, severity=Severity.INFO, length=length)


def _build_findings(
    rule: Rule, message: str, places: Iterable[Located], declared: str, *, severity: Severity | None = None
) -> Iterator[Finding]:
    """Report all uses of a feature together: the declared version is the cause."""
    locations = list(dict.fromkeys(place.location for place in places))
    if locations:
        spans = {location.span: location for location in locations[1:] if location.span != locations[0].span}
        finding = rule.finding(
            message,
            at=locations[0],
            severity=severity,
            related=spans.values(),
            times=format_repetition(len(locations)),
            declared=declared,
        )
        yield replace(finding, subjects=tuple(location.subject for location in locations))
