"""PKG006 reports package names that some ROS tools refuse."""

from __future__ import annotations

import re
from collections.abc import Iterator

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.source.package.finder import Package

# REP 144: lower case letters, digits and underscores, beginning with a letter, at least two characters.
_REP144 = re.compile(r"[a-z][a-z0-9_]+")
# catkin_pkg accepts these, some with a warning.
_CATKIN = re.compile(r"[a-z][a-z0-9_-]*")


def check(package: Package, rule: Rule) -> Iterator[Finding]:
    root = package.root
    if root is None or root.tag != "package":
        return
    element = root.find_child("name")
    if element is None:
        good = _suggest_name(package.path.absolute().name)
        yield rule.finding("missing", at=root, severity=Severity.ERROR, good=good)
        return
    name = package.name
    good = _suggest_name(name)
    if not _REP144.fullmatch(name):
        hyphen = bool(_CATKIN.fullmatch(name)) and len(name) > 1
        kind = "hyphen" if hyphen else "short" if len(name) < 2 else "illegal"
        yield rule.finding(
            kind, at=element, name=name, good=good, why=_explain_illegal_name(name), debian=name.replace("_", "-")
        )
    elif "__" in name:
        yield rule.finding("double", at=element, name=name, good=good)


def _explain_illegal_name(name: str) -> str:
    if not name:
        return "is empty"
    if not name[0].isalpha() or not name[0].isascii():
        return f"begins with {name[0]!r}"
    if name != name.lower():
        return "has capital letters"
    odd = sorted(set(re.findall(r"[^a-z0-9_-]", name)))
    return "contains " + ", ".join(repr(c) for c in odd)


def _suggest_name(name: str) -> str:
    """Replace what is not allowed: ``Car-3`` becomes ``car_3``."""
    words = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).lower()
    cleaned = re.sub(r"_+", "_", re.sub(r"[^a-z0-9]", "_", words)).strip("_")
    return cleaned if re.match(r"[a-z]", cleaned) else f"robot_{cleaned}".rstrip("_")
