"""Whether an edit changes what there is to check. Most do not: the search for models asks little of a file, its outline."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from urdfcheck.run.jobs import Request
from urdfcheck.source.model_file import ModelFile
from urdfcheck.source.package.file_kinds import is_launch, is_model
from urdfcheck.system import sandbox
from urdfcheck.system.files import overlay_files

# Real path → the text that a file had and the one that it has; None where it was or is that on the disk.
Changes = Mapping[str, tuple[bytes | None, bytes | None]]


def may_compare_outlines(request: Request, changes: Changes) -> bool:
    """Whether the outlines of the changed files decide what the search for models finds.

    They do where it looks for the users of models and for what launch files start. A mesh or a yaml file is searched in whole
    texts, and the values of arguments are read from them.
    """
    asks_little = all(is_model(path) or is_launch(path) for path in request.paths) and not request.all_arguments
    return asks_little and all(is_model(Path(path)) and None not in texts for path, texts in changes.items())


def have_same_outlines(changes: Changes) -> bool:
    """Whether the outline of each model is that of the text that it had."""
    for path, texts in changes.items():
        outlines = []
        for text in texts:
            with overlay_files({} if text is None else {path: text}):
                outlines.append(ModelFile(Path(path)).outline)
        if outlines[0] != outlines[1]:
            return False
    return True


def compare_outlines_bounded(memory: int, changes: Changes) -> bool:
    """Do the same as `have_same_outlines` with at most ``memory`` MiB, in a worker: the texts may be a stranger's."""
    sandbox.limit_memory(memory)
    try:
        return have_same_outlines(changes)
    except (MemoryError, RecursionError):
        return False
