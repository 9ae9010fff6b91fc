"""XAC012 reports declarations on the root element of an included file that the include loses."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import replace

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.model import Model
from urdfcheck.source.text.grammar import iter_urdf_elements, parse_urdf_version
from urdfcheck.source.text.xml import Attribute, Element

# Features of later URDF versions by tag: the version, the name, and the attributes that make the feature (none: the tag).
_NEWER_FEATURES: Mapping[str, tuple[tuple[int, int], str, frozenset[str]]] = {
    "origin": ((1, 1), "quat_xyzw", frozenset({"quat_xyzw"})),
    "capsule": ((1, 1), "<capsule>", frozenset()),
    "limit": ((1, 2), "acceleration, deceleration or jerk limits", frozenset({"acceleration", "deceleration", "jerk"})),
}
_REDEFINED = re.compile(r"inconsistent namespace redefinitions for (\S+): old: (\S*) new: (\S*) \(")


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    yield from _check_versions(model, rule)
    yield from _check_prefixes(model, rule)


def _check_versions(model: Model, rule: Rule) -> Iterator[Finding]:
    """Report included files that use a newer version of URDF than the robot declares."""
    source, main = model.source, model.source.main_tree
    main_version = None if main is None else parse_urdf_version(main)
    if not source.is_xacro or main is None or main_version is None:
        return
    for name, tree in source.trees.items():
        declared, version = tree.attributes.get("version"), parse_urdf_version(tree)
        if declared is None or version is None or version <= main_version or tree is main:
            continue
        lost = [
            element
            for element in _find_elements_in_file(name, model.robot)
            if main_version < (_get_required_version(element) or main_version) <= version
        ]
        if lost:
            finding = rule.finding(
                "version",
                at=declared,
                related=[main, *lost[:5]],
                severity=Severity.INFO if all(e.tag == "limit" for e in lost) else None,
                version=declared.value,
                own=main.get("version") or "1.0, the default",
                what=" and ".join(sorted({_NEWER_FEATURES[e.tag][1] for e in lost})),
                file=name,
                main=source.name,
            )
            # This finding supersedes those about the elements, which have no other defect.
            yield replace(finding, subjects=tuple(dict.fromkeys((*finding.subjects, *(e.subject for e in lost)))))


def _find_elements_in_file(file: str, robot: Element) -> list[Element]:
    return [e for e in iter_urdf_elements(robot) if e.span is not None and e.span.file == file]


def _get_required_version(element: Element) -> tuple[int, int] | None:
    """Return the first version of URDF that reads all of an element, or None for an element of the first version."""
    since, _, names = _NEWER_FEATURES.get(element.tag, (None, "", frozenset()))
    return since if not names or names & element.attributes.keys() else None


def _check_prefixes(model: Model, rule: Rule) -> Iterator[Finding]:
    """Report prefixes that an included file binds to another address than the including file: xacro keeps the first."""
    source = model.source
    warnings = [m for p in source.find_problems("xacro-warning") if (m := _REDEFINED.match(p.message)) is not None]
    declared = _collect_namespace_prefixes(source.trees) if warnings else {}
    for name, old, new in dict.fromkeys(match.groups() for match in warnings):
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
    """Return the first declaration of each prefix with each address."""
    declarations: dict[tuple[str, str], Attribute] = {}
    for tree in trees.values():
        for element in tree.walk():
            for name, attribute in element.attributes.items():
                if name.startswith("xmlns:"):
                    declarations.setdefault((name, attribute.value), attribute)
    return declarations
