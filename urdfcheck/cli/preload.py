"""What a worker process loads while the parent works its job out."""

from __future__ import annotations

import contextlib
import importlib


def prepare() -> None:
    """What a worker loads while the parent works its job out."""
    from urdfcheck import catalogue, libraries

    libraries.prefer_own()
    checks = [catalogue.module_of(rule) for rule in catalogue.rules().values() if catalogue.has_check(rule)]
    for module in ("numpy", "urdfcheck.worker", *checks):
        importlib.import_module(module)
    with contextlib.suppress(ImportError):  # where there is none, it is not missed
        importlib.import_module("py_landlock")
