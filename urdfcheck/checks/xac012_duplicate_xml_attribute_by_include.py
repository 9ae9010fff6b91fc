"""XAC012 reports declarations on the root element of an included file that the include loses."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import replace

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.model import Model
from urdfcheck.source.text.grammar import iter_urdf_elements, parse_urdf_version
from urdfcheck.source.text.xml import Attribute, Element

# What a later version of URDF brought: since when, how it is called, and the attributes by which it is known.
_NEWER_FEATURES: Mapping[str, tuple[tuple[int, int], str, frozenset[str]]] = {
    "origin": ((1, 1), "quat_xyzw", frozenset({"quat_xyzw"})),
    "capsule": ((1, 1), "<capsule>", frozenset()),
    "limit": ((1, 2), "acceleration, deceleration or jerk", frozenset({"acceleration", "deceleration", "jerk"})),
}
_REDEFINED = re.compile(r"inconsistent namespace redefinitions for (\S+): old: (\S*) new: (\S*) \(")


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    yield from _check_versions(model, rule)
    yield from _check_prefixes(model, rule)


def _check_versions(model: Model, rule: Rule) -> Iterator[Finding]:
    """An included file that is written in a newer URDF than the robot says to be."""
    source, main = model.source, model.source.main_tree
    own = None if main is None else parse_urdf_version(main)
    if not source.is_xacro or main is None or own is None:
        return
    for name, tree in source.trees.items():
        declared, version = tree.attributes.get("version"), parse_urdf_version(tree)
        if declared is None or version is None or version <= own or tree is main:
            continue
        lost = [
            e for e in _find_elements_in_file(name, model.robot) if own < (_get_required_version(e) or own) <= version
        ]
        if lost:
            finding = rule.finding(
                "version",
                at=declared,
                related=[main, *lost[:5]],
                version=declared.value,
                own=main.get("version") or "1.0, which counts where none is given",
                what=" and ".join(sorted({_NEWER_FEATURES[e.tag][1] for e in lost})),
                file=name,
                main=source.name,
            )
            # What is used in vain is no defect of its own: these elements give way.
            yield replace(finding, subjects=tuple(dict.fromkeys((*finding.subjects, *(e.subject for e in lost)))))


def _find_elements_in_file(file: str, robot: Element) -> list[Element]:
    return [e for e in iter_urdf_elements(robot) if e.span is not None and e.span.file == file]


def _get_required_version(element: Element) -> tuple[int, int] | None:
    """The version of URDF from which on all of an element is read, None for what has always been."""
    since, _, names = _NEWER_FEATURES.get(element.tag, (None, "", frozenset()))
    return since if not names or names & element.attributes.keys() else None


def _check_prefixes(model: Model, rule: Rule) -> Iterator[Finding]:
    """A prefix that an included file binds to another address than the file that includes it: xacro keeps the first."""
    source = model.source
    said = [m for p in source.find_problems("xacro-warning") if (m := _REDEFINED.match(p.message)) is not None]
    declared = _collect_namespace_prefixes(source.trees) if said else {}
    for name, old, new in dict.fromkeys(match.groups() for match in said):
        if name != "xmlns:xacro" and (name, new) in declared:
            yield rule.finding(
                "prefix",
                at=declared[name, new],
                related=[declared[name, old]] if (name, old) in declared else [],
                severity=Severity.INFO,
                prefix=name.removeprefix("xmlns:"),
                new=new,
                old=old,
            )


def _collect_namespace_prefixes(trees: Mapping[str, Element]) -> dict[tuple[str, str], Attribute]:
    """The first declaration of each prefix with each address."""
    found: dict[tuple[str, str], Attribute] = {}
    for tree in trees.values():
        for element in tree.walk():
            for name, attribute in element.attributes.items():
                if name.startswith("xmlns:"):
                    found.setdefault((name, attribute.value), attribute)
    return found
