"""PKG006 reports package names that some ROS tools refuse."""

from __future__ import annotations

import re
from collections.abc import Iterator

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.source.package.finder import Package, format_path
from urdfcheck.source.package.released_packages import read_released_packages

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
        taken = _explain_taken(good, package)
        repair = f"add `<name>{good}</name>`{f', or another name: {taken}' if taken else ''}"
        yield rule.finding("missing", at=root, severity=Severity.ERROR, good=good, repair=repair)
        return
    name = package.name
    good = _suggest_name(name)
    if not _REP144.fullmatch(name):
        hyphen = bool(_CATKIN.fullmatch(name)) and len(name) > 1
        kind = "hyphen" if hyphen else "short" if len(name) < 2 else "illegal"
        yield rule.finding(
            kind,
            at=element,
            name=name,
            good=good,
            why=_explain_illegal_name(name),
            debian=name.replace("_", "-"),
            repair=_describe_repair(good, package),
        )
    elif "__" in name:
        yield rule.finding("double", at=element, name=name, good=good, repair=_describe_repair(good, package))


def _describe_repair(good: str, package: Package) -> str:
    """Say what name to give the package, unless another package has it."""
    taken = _explain_taken(good, package)
    new = f"rename the package, but not to `{good}` ({taken})" if taken else f"rename the package to `{good}`"
    return f"{new}, also in its `package://` paths and `$(find …)`"


def _explain_taken(good: str, package: Package) -> str:
    """Say which other package has a name that is proposed; empty if none is known."""
    workspace = {} if package.finder is None else package.finder.list_workspace_packages()
    if workspace.get(good, package.path) != package.path:
        return f"{format_path(workspace[good])} has that name"
    return "ROS has released a package of that name" if good in read_released_packages() else ""


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
