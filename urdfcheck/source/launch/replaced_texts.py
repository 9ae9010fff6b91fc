"""Texts of a robot description that Python launch files replace before any program reads it. Nothing is executed."""

from __future__ import annotations

import ast
import itertools
import warnings
from collections.abc import Iterator
from pathlib import Path

from urdfcheck.core import Location
from urdfcheck.source.launch.passed_arguments import MOST_LAUNCHES, iter_launch_files
from urdfcheck.source.launch.python_launch_file import MAX_PYTHON, PythonLaunchReader
from urdfcheck.source.package.finder import PackageFinder, format_path
from urdfcheck.source.text.xml import SourceFile
from urdfcheck.system.files import read_regular


def find_replaced_texts(model: Path, finder: PackageFinder) -> dict[str, Location]:
    """Return the texts with a ``$`` that launch files of a model's package replace in it, with the first place of each.

    They are the first arguments of ``.replace(…)`` in the launch files that contain the model's name.
    """
    package = finder.find_package_of(model.absolute())
    found: dict[str, Location] = {}
    if package is None or not finder.can_open(package.path):
        return found
    for launch in itertools.islice(iter_launch_files(package.path, finder), MOST_LAUNCHES):
        for text, location in _read_replacements(launch, model.name, finder) if launch.suffix == ".py" else ():
            found.setdefault(text, location)
    return found


def _read_replacements(launch: Path, name: str, finder: PackageFinder) -> Iterator[tuple[str, Location]]:
    try:
        text = read_regular(launch, MAX_PYTHON).decode("utf-8-sig", "replace")
        if name not in text or ".replace(" not in text:
            return
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            tree = ast.parse(text)
        reader = PythonLaunchReader(
            tree, SourceFile(launch, format_path(launch), text=text), path=launch, finder=finder
        )
    except (OSError, SyntaxError, ValueError, RecursionError, MemoryError):
        return
    for node in reader.nodes:
        if not (isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr == "replace"):
            continue
        first = node.args[0] if node.args else None
        if isinstance(first, ast.Constant) and isinstance(first.value, str) and "$" in first.value:
            yield first.value, reader.locate_node(first)
