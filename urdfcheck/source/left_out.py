"""The packages with models that build tools are told to leave out."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

from urdfcheck.source.package.file_kinds import is_model
from urdfcheck.source.package.finder import PackageFinder
from urdfcheck.source.package.package_folders import IGNORE_MARKS, MAX_SIBLINGS, list_subfolders, walk_packages

# Packages are searched for so many levels below the marked folder.
_LEVELS = 4


def list_left_out_packages(folder: Path, finder: PackageFinder) -> Iterator[tuple[Path, str]]:
    """Yield the packages with models in a marked folder, or the folder if it has models and no package; each with the name of
    the mark.
    """
    if os.path.islink(folder) and not finder.can_open(folder):
        return
    mark = min((name for name in IGNORE_MARKS if os.path.lexists(folder / name)), default="")
    packages = [path for _, path in walk_packages(folder, _LEVELS, finder.can_open, most=MAX_SIBLINGS)]
    for place in packages or [folder]:
        if _has_models(place):
            yield place, mark


def _has_models(folder: Path) -> bool:
    """Whether a file in a folder or below is named like a model; links are not followed."""
    below, left = [folder], MAX_SIBLINGS
    while below and left:
        here, left = below.pop(), left - 1
        try:
            if any(is_model(Path(name)) for name in os.listdir(here)):
                return True
        except OSError:
            continue
        below += [inner for inner in list_subfolders(here) if not inner.is_symlink()]
    return False
