"""PKG001: every package that a model names is in reach."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Edit, Finding, Located, Location, Rule, Severity
from urdfcheck.model.names import listed
from urdfcheck.source.load import Source
from urdfcheck.source.resources import ResourceUse, resource_uses
from urdfcheck.source.words import part_of


def check(source: Source, rule: Rule) -> Iterator[Finding]:
    for problem in source.problems_of("package-not-found"):
        yield _finding(source, rule, str(problem.data["package"]), problem.location, problem.related, [])
    missing: dict[str, list[ResourceUse]] = {}
    for use in resource_uses(source):
        if use.resource.package is not None and use.resource.path is None:
            missing.setdefault(use.resource.package, []).append(use)
    for package, uses in missing.items():
        first = part_of(uses[0].attribute, package, source.files)
        others = {u.attribute.span: u for u in uses if u.attribute.span != uses[0].attribute.span}
        yield _finding(source, rule, package, first, list(others.values()), uses)


def _finding(
    source: Source,
    rule: Rule,
    package: str,
    at: Location,
    related: list[ResourceUse] | tuple[Location, ...],
    uses: list[ResourceUse],
) -> Finding:
    own = source.package
    declared = own is not None and package in own.dependencies
    near = source.finder.near(package)
    files = list(dict.fromkeys(u.resource.text for u in uses))
    others: list[Located | Location] = [*related]
    kind = "files" if uses else "expansion"
    return rule.finding(
        "nameless" if not package else f"{kind}-declared" if declared else kind,
        at=at,
        related=others,
        edits=_edits(uses, package, near),
        severity=Severity.INFO if declared and (uses or not source.explicit) else None,
        package=package,
        files=files,
        amount="1 file" if len(files) == 1 else f"{len(files)} files",
        listed=listed([f.partition(f"{package}/")[2] or f for f in files], 3),
        looked=source.finder.looked_in(),
        places="; ".join(source.finder.looked_in()),
        near=near,
        hint=f" (did you mean {listed(near)}?)" if near else "",
    )


def _edits(uses: list[ResourceUse], package: str, near: list[str]) -> list[Edit]:
    """The package's name wherever it is typed, when it can only be one other name."""
    if len(near) != 1 or not all(u.attribute.literal for u in uses):
        return []
    edits = {}
    for use in uses:
        span = use.attribute.span
        if span is not None:
            scheme = use.attribute.typed.partition("://")[0]
            old = f"{scheme}://{package}"
            edits[span] = Edit(span, use.attribute.typed, use.attribute.typed.replace(old, f"{scheme}://{near[0]}", 1))
    return list(edits.values())
