"""Whether a model is there for tests."""

from __future__ import annotations

from urdfcheck.model.robot import Model
from urdfcheck.source.package.package_folders import TEST_FOLDERS

# How far above a file they are, at most.
_LEVELS = 3


def is_of_tests(model: Model) -> bool:
    """Whether a file is in a folder of tests, in which it may be as it is on purpose."""
    return not TEST_FOLDERS.isdisjoint(model.source.path.absolute().parts[-1 - _LEVELS : -1])
