"""The first worker, and what it loads while the parent works its job out."""

from __future__ import annotations

import contextlib
import importlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from urdfcheck.system.process_pool import Worker


def start_warm_worker() -> Worker | None:
    """A worker that loads what an audit needs while its job is being worked out here; None where processes cannot be forked.

    :raises UrdfcheckError: when a page of a rule is none.
    """
    from urdfcheck import rules as catalogue
    from urdfcheck.system import libraries
    from urdfcheck.system import process_pool as workers

    if not workers.FORKS:
        return None
    libraries.prefer_own_folders()
    # What both of them need is loaded before they part: once instead of twice.
    for module in ("urdfcheck.run.pipeline", "urdfcheck.run.audit"):
        importlib.import_module(module)
    catalogue.load_rules()
    return workers.Worker.start(preload_modules)


def preload_modules() -> None:
    """What a worker loads while the parent works its job out: all but the checks whose findings may be recalled."""
    from urdfcheck import rules as catalogue
    from urdfcheck.system import libraries

    libraries.prefer_own_folders()
    importlib.import_module("numpy")
    from urdfcheck.run.findings_cache import is_cacheable

    for rule in catalogue.load_rules().values():
        if catalogue.has_check(rule) and not is_cacheable(rule):
            importlib.import_module(catalogue.get_check_module(rule))
    with contextlib.suppress(ImportError):  # where there is none, it is not missed
        importlib.import_module("py_landlock")
