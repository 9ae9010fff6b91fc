"""PKG001 reports packages that a model names and that are not found."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from urdfcheck.core import Edit, Finding, Located, Location, Rule, Severity
from urdfcheck.core.text import join_names
from urdfcheck.source.load import Source
from urdfcheck.source.resources import ResourceUse, is_misspelt, list_resource_uses
from urdfcheck.source.text.shape_roles import describe_missing_mesh
from urdfcheck.source.text.tokens import locate_text

# Files that are looked for in other packages, to see which one is meant.
_MAX_FILES = 50


def check(source: Source, rule: Rule) -> Iterator[Finding]:
    for problem in source.find_problems("package-not-found"):
        yield _build_finding(source, rule, str(problem.data["package"]), problem.location, problem.related, [])
    missing: dict[str, list[ResourceUse]] = {}
    for use in list_resource_uses(source):
        if use.resource.package is not None and use.resource.path is None and not is_misspelt(use):
            missing.setdefault(use.resource.package, []).append(use)
    for package, uses in missing.items():
        first = locate_text(uses[0].attribute, package, source.files)
        others = {u.attribute.span: u for u in uses if u.attribute.span != uses[0].attribute.span}
        yield _build_finding(source, rule, package, first, list(others.values()), uses)


def _build_finding(
    source: Source,
    rule: Rule,
    package: str,
    at: Location,
    related: list[ResourceUse] | tuple[Location, ...],
    uses: list[ResourceUse],
) -> Finding:
    own = source.package
    declared = own is not None and package in own.dependencies
    holding = _find_package_with_files(uses, source)
    near = [] if declared else holding or source.finder.suggest_names(package)
    files = list(dict.fromkeys(u.resource.text for u in uses))
    others: list[Located | Location] = [*related]
    kind = "files" if uses else "expansion"
    amount = "1 file" if len(files) == 1 else f"{len(files)} files"
    evidence = f", which has {'this file' if len(files) == 1 else 'these files'}" if holding and package else ""
    message = "nameless" if not package else f"{kind}-declared" if declared else kind
    # Where the package is declared, the meshes are missing only as long as it is not installed.
    lost = message in {"files", "nameless"}
    return rule.finding(
        message,
        at=at,
        related=others,
        edits=_propose_edits(uses, package, near),
        severity=Severity.INFO if declared and (uses or not source.explicit) else None,
        consequences=describe_missing_mesh(use.attribute.owner for use in uses) if lost else None,
        package=package,
        files=files,
        amount=amount,
        listed=join_names([_get_path_in_package(f, package) for f in files], 3),
        looked=source.finder.describe_search_places(),
        places="; ".join(source.finder.describe_search_places()),
        near=near,
        hint=f" (did you mean {join_names(near)}{evidence}?)" if near else "",
    )


def _get_path_in_package(text: str, package: str) -> str:
    """What follows the package's name in a path."""
    return text.partition("://")[2].removeprefix(package).lstrip("/")


def _find_package_with_files(uses: list[ResourceUse], source: Source) -> list[str]:
    """The package in reach that has all these files, if only one has: then its name was meant. Where the path names none, it
    may stand behind the slashes that are too many."""
    inside = list(dict.fromkeys(_get_path_in_package(use.resource.text, use.resource.package or "") for use in uses))[
        :_MAX_FILES
    ]
    if not inside:
        return []
    if not uses[0].resource.package:
        names = {path.partition("/")[0] for path in inside}
        return sorted(names) if len(names) == 1 and all(map(source.finder.find, names)) else []
    found = [name for name, folder in source.finder.list_packages().items() if _has_all_files(folder, inside, source)]
    return found if len(found) == 1 else []


def _has_all_files(folder: Path, files: list[str], source: Source) -> bool:
    return all(source.finder.can_open(folder / name) and (folder / name).is_file() for name in files)


def _propose_edits(uses: list[ResourceUse], package: str, near: list[str]) -> list[Edit]:
    """The package's name wherever it is typed, when it can only be one other name."""
    if len(near) != 1 or not all(u.attribute.literal for u in uses):
        return []
    edits = {}
    for use in uses:
        span, typed = use.attribute.span, use.attribute.typed
        if span is not None:
            scheme = typed.partition("://")[0]
            old = f"{scheme}://{package}" if package else f"{scheme}:///{near[0]}"
            edits[span] = Edit(span, typed, typed.replace(old, f"{scheme}://{near[0]}", 1))
    return list(edits.values())
