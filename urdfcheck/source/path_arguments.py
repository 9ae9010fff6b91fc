"""The arguments of a xacro that lead to a path which does not exist."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable
from pathlib import Path

from urdfcheck.core import Location
from urdfcheck.core.records import dataclass
from urdfcheck.source.load import Source
from urdfcheck.source.package.finder import format_path
from urdfcheck.source.xacro.usage import iter_elements_by_tag

_SUBJECT = "argument["


@dataclass(frozen=True, slots=True)
class PathArgument:
    """An argument that a path was made of."""

    name: str
    value: str
    location: Location
    """Where its value comes from: the file that it was found in, else its declaration."""
    origin: str
    """default | given | launch: found in a launch file, or in another one that says what the model is started with."""

    def __str__(self) -> str:
        value = format_path(Path(self.value)) if os.path.isabs(self.value) else self.value
        shown = {"default": f"default {value!r}", "given": f"{value!r} is given"}
        span = self.location.span
        file = "another file" if span is None else Path(span.file).name
        return f"{self.name} ({shown.get(self.origin, f'{value!r} in {file}')})"


def list_path_arguments(source: Source, made_of: Iterable[Location]) -> list[PathArgument]:
    """Return the arguments among the definitions that a path was made of, without those that are made of others.

    They are in the order of their places.
    """
    found: dict[str, PathArgument] = {}
    for place in made_of:
        if not place.subject.startswith(_SUBJECT):
            continue
        name = place.subject.removeprefix(_SUBJECT).removesuffix("]")
        defaults = (e.get("default") for e in iter_elements_by_tag(source.trees, "xacro:arg") if e.get("name") == name)
        value = source.arguments.get(name, next(defaults, ""))
        span = source.found_arguments[name].span if name in source.found_arguments else None
        is_own = span is not None and span.file in source.files  # a default that `<robot>` reads before it is declared
        is_found = name in source.found_arguments and not is_own
        origin = "launch" if is_found else "given" if name in source.arguments and not is_own else "default"
        if "$(" not in value:
            found[name] = PathArgument(name, value, source.found_arguments.get(name, place), origin)
    return sorted(found.values(), key=_get_place)


def _get_place(argument: PathArgument) -> tuple[str, int]:
    span = argument.location.span
    return ("", 0) if span is None else (span.file, span.start)


def find_missing_part(source: Source, path: Path) -> Path:
    """Return the outermost part of a path that does not exist; the whole path if none may be read."""
    parts = (*reversed(path.parents), path)
    return next((part for part in parts if source.finder.can_open(part) and not part.exists()), path)


def select_guilty(arguments: Iterable[PathArgument], missing: Path) -> list[PathArgument]:
    """Return the arguments whose value is the name of the missing part, else those whose value is in it."""
    arguments = [argument for argument in arguments if argument.value]
    exact = [a for a in arguments if missing.name in {a.value, *Path(a.value).parts}]
    return exact or [a for a in arguments if a.value in missing.name]


def list_other_values(source: Source, argument: PathArgument, missing: Path) -> list[str]:
    """Return the other values that the files of the model know and that lead to a folder in place of the missing part, or to a
    file of its kind."""
    from urdfcheck.source.xacro.argument_values import find_argument_choices  # only what is missing asks for it

    known = {choice.name: choice.values for choice in find_argument_choices(source.path, source.finder)}
    values = (value for value in known.get(argument.name, ()) if value != argument.value)
    places = {value: missing.parent / missing.name.replace(argument.value, value) for value in values}
    return [
        value
        for value, place in places.items()
        if place.is_dir() or (place.suffix == missing.suffix and place.exists())
    ]


def list_named_values(source: Source, argument: PathArgument) -> list[str]:
    """Return the values of an argument that the files of the model know, without the one that it has."""
    from urdfcheck.source.xacro.argument_values import find_argument_choices  # only what is missing asks for it

    choices = (c for c in find_argument_choices(source.path, source.finder) if c.name == argument.name)
    return [value for choice in choices for value in choice.existing_values if value not in ("", argument.value)]


def is_name_cut_off(path: Path) -> bool:
    """Whether the name of a file begins with what separates its parts: ``.urdf.xacro``, ``_macro.xacro``."""
    return path.name.startswith((".", "_", "-"))


def list_full_names(source: Source, path: Path) -> list[str]:
    """Return what the names of the files beside a missing one have before its name, without the files that were read."""
    return list_names_between(source, path, "", path.name) if is_name_cut_off(path) else []


def list_names_between(source: Source, path: Path, before: str, after: str) -> list[str]:
    """Return what the names of the files beside a missing one have between their begin and their end, without the files that
    were read."""
    if not source.finder.can_open(path.parent):
        return []
    try:
        beside = sorted(os.listdir(path.parent))
    except OSError:
        return []
    read = {os.path.realpath(file.path) for file in source.files.values()}
    named = re.compile(rf"{re.escape(before)}([^\W_].*){re.escape(after)}")
    found = {match[1]: path.parent / name for name in beside if (match := named.fullmatch(name))}
    return [value for value, file in found.items() if os.path.realpath(file) not in read]
