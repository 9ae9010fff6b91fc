"""PKG004 reports paths of meshes and textures that only one machine can open."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from urdfcheck.core import Edit, Finding, Location, Rule
from urdfcheck.core.text import join_names
from urdfcheck.source.load import Source
from urdfcheck.source.resources import ResourceUse, find_machine_path, list_resource_uses
from urdfcheck.source.text.engine_reactions import describe_missing_mesh
from urdfcheck.source.text.tokens import build_replacement_edits


@dataclass(slots=True, eq=False)
class _MachinePath:
    """A text with the path of one machine, and the files that are named by it."""

    location: Location
    uses: list[ResourceUse] = field(default_factory=list)


_KINDS = {"absolute": "an absolute path", "file": "a file:// path", "home": "a path in somebody's home folder"}


def check(source: Source, rule: Rule) -> Iterator[Finding]:
    places: dict[object, _MachinePath] = {}
    for use in list_resource_uses(source):
        typed = find_machine_path(use, source)
        if typed is None:
            continue
        at = Location(use.location.subject, typed.span, use.location.via)
        # Paths from one definition are one cause, and so are the texts that name one file.
        key = use.resource.path if typed is use.attribute else typed.span
        places.setdefault(key, _MachinePath(at)).uses.append(use)
    for place in places.values():
        yield _build_finding(place, source, rule)


def _build_finding(place: _MachinePath, source: Source, rule: Rule) -> Finding:
    first = place.uses[0]
    portable = _build_portable_path(first, source)
    files = list(dict.fromkeys(u.resource.text for u in place.uses))
    message = "unread" if not first.resource.allowed else "here-only" if first.resource.exists else "nowhere"
    return rule.finding(
        message,
        at=place.location,
        related={u.attribute.span: u for u in place.uses if u.attribute.span != place.location.span}.values(),
        edits=_propose_edits(place, source) if portable else [],
        consequences=describe_missing_mesh(use.attribute.owner for use in place.uses) if message == "nowhere" else None,
        file=first.resource.text,
        files=files,
        listed=join_names(files, 2),
        kind=_KINDS[first.resource.kind],
        portable=portable or "package://PACKAGE/meshes/FILE",
    )


def _build_portable_path(use: ResourceUse, source: Source) -> str | None:
    """Return the package path of a file in the model's own package, or None for another file."""
    package, path = source.package, use.resource.path
    if package is None or path is None or not use.resource.exists:
        return None
    try:
        return f"package://{package.name}/{path.resolve().relative_to(package.path.resolve()).as_posix()}"
    except ValueError:
        return None


def _propose_edits(place: _MachinePath, source: Source) -> list[Edit]:
    edits: dict[Edit, None] = {}
    for use in place.uses:
        portable = _build_portable_path(use, source)
        if portable is not None:
            edits |= dict.fromkeys(build_replacement_edits([use.attribute], portable))
    return list(edits)
