"""PKG001 reports packages that a model uses and that are not found."""

from __future__ import annotations

import shlex
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path, PurePosixPath

from urdfcheck.core import Edit, Finding, Located, Location, Rule, Severity
from urdfcheck.core.text import format_count, join_names
from urdfcheck.source.load import Source
from urdfcheck.source.package.similar_files import index_files
from urdfcheck.source.path_arguments import list_path_arguments
from urdfcheck.source.resources import ResourceUse, is_misspelt, list_resource_uses
from urdfcheck.source.text.engine_reactions import describe_missing_mesh
from urdfcheck.source.text.tokens import locate_text
from urdfcheck.source.text.xml import flatten_definitions

# So many files are looked up in other packages to find the one that is meant.
_MAX_FILES = 50


def check(source: Source, rule: Rule) -> Iterator[Finding]:
    for problem in source.find_problems("package-not-found"):
        package = str(problem.data["package"])
        yield _build_finding(source, rule, package, at=problem.location, related=problem.related)
    missing: dict[str, list[ResourceUse]] = {}
    for use in list_resource_uses(source):
        if use.resource.package is not None and use.resource.path is None and not is_misspelt(use):
            missing.setdefault(use.resource.package, []).append(use)
    for package, uses in missing.items():
        at = locate_text(uses[0].attribute, package, source.files)
        others = {u.attribute.span: u for u in uses if u.attribute.span != uses[0].attribute.span}
        yield _build_finding(source, rule, package, at=at, related=others.values(), uses=uses)


def _build_finding(
    source: Source,
    rule: Rule,
    package: str,
    *,
    at: Location,
    related: Iterable[Located | Location],
    uses: Sequence[ResourceUse] = (),
) -> Finding:
    declared = source.package is not None and package in source.package.dependencies
    owners = _find_package_with_files(uses, source)
    near = [] if declared else owners or source.finder.suggest_names(package)
    files = list(dict.fromkeys(u.resource.text for u in uses))
    kind = "files" if uses else "expansion"
    evidence = f", which has {'this file' if len(files) == 1 else 'these files'}" if owners and package else ""
    message = "nameless" if not package else f"{kind}-declared" if declared else kind
    # The meshes of a declared package are missing only until it is installed.
    lost = message in {"files", "nameless"}
    related = list(related)
    named_by, places = _explain_by_argument(source, package, uses, related)
    return rule.finding(
        message,
        at=at,
        related=[*related, *places],
        edits=_propose_edits(uses, package, near),
        severity=Severity.INFO if declared and uses else None,
        consequences=describe_missing_mesh(use.attribute.owner for use in uses) if lost else None,
        package=package,
        remedy=f"--package {shlex.quote(package)}=FOLDER" if package and kind == "expansion" else "",
        files=files,
        amount=format_count(len(files), "file"),
        listed=join_names([_get_path_in_package(f, package) for f in files], 3),
        looked=source.finder.describe_search_places(),
        places="; ".join(source.finder.describe_search_places()),
        near=near,
        hint=(
            f" (did you mean {join_names(near)}{evidence}?)"
            if near
            else ""
            if declared
            else _describe_own_files(source, files)
        )
        + named_by,
    )


def _explain_by_argument(
    source: Source, package: str, uses: Sequence[ResourceUse], related: Sequence[Located | Location]
) -> tuple[str, list[Location]]:
    """Name the argument whose value is the package, and its place."""
    read = (definition.location for use in uses for definition in flatten_definitions(use.attribute.reads))
    places = (place for place in related if isinstance(place, Location))
    arguments = list_path_arguments(source, read if uses else places)
    named = [argument for argument in arguments if package and argument.value == package]
    return (f", named by argument {named[0]}", [named[0].location]) if len(named) == 1 else ("", [])


def _get_path_in_package(text: str, package: str) -> str:
    """Return the part of a path that follows the name of the package."""
    return text.partition("://")[2].removeprefix(package).lstrip("/")


def _find_package_with_files(uses: Sequence[ResourceUse], source: Source) -> list[str]:
    """Return the only known package that has all these files, or nothing.

    A path that names no package may name it behind too many slashes.
    """
    inside = list(dict.fromkeys(_get_path_in_package(use.resource.text, use.resource.package or "") for use in uses))[
        :_MAX_FILES
    ]
    if not inside:
        return []
    if not uses[0].resource.package:
        names = {path.partition("/")[0] for path in inside}
        return sorted(names) if len(names) == 1 and all(map(source.finder.find, names)) else []
    owners = [name for name, folder in source.finder.list_packages().items() if _has_all_files(folder, inside, source)]
    return owners if len(owners) == 1 else []


def _has_all_files(folder: Path, files: list[str], source: Source) -> bool:
    return all(source.finder.can_open(folder / name) and (folder / name).is_file() for name in files)


def _describe_own_files(source: Source, files: Sequence[str]) -> str:
    """Say where the model's own package has a file of the same name as each of these, if each is there once."""
    if not files or source.package is None:
        return ""
    index = index_files([source.package.path])
    found = [
        [p for p in index.get(PurePosixPath(f).name.lower(), []) if p.name == PurePosixPath(f).name] for f in files
    ]
    if any(len(paths) != 1 for paths in found):
        return ""
    places = [paths[0].relative_to(source.package.path).as_posix() for paths in found]
    return f" ({source.package.name} has {'the file' if len(files) == 1 else 'the files'} as {join_names(places, 3)})"


def _propose_edits(uses: Sequence[ResourceUse], package: str, near: Sequence[str]) -> list[Edit]:
    """Return edits of the package's name if it can only mean one other name."""
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
