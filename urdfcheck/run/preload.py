"""The warm worker: a process that loads the libraries of an audit while its parent prepares the run.

The commands import this module before they read their options, so it imports nothing else of urdfcheck itself.
"""

from __future__ import annotations

import contextlib
import importlib
from functools import partial
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

    from urdfcheck.system.process_pool import Worker


# What the process of the command and the worker both need.
PARENT_MODULES = ("urdfcheck.run.pipeline", "urdfcheck.run.unit_audit", "urdfcheck.policy.config_resolver")
# Scopes of the checks that run on every model.
_CHECKED_ALWAYS = frozenset({"file", "model"})


def start_warm_worker(tier: str | None = None, cache: Path | None = None) -> Worker | None:
    """Start a worker that loads what an audit needs; None where processes cannot be forked.

    ``tier``: how much is computed, where the command says it; ``cache``: the folder of cached results, where it is known.

    :raises UrdfcheckError: if a rule page is malformed.
    """
    from urdfcheck.rules import load_rules, recall_rules
    from urdfcheck.system import libraries, process_pool
    from urdfcheck.system.installation import recall_digests

    if not process_pool.FORKS:
        return None
    libraries.prefer_own_folders()
    # The worker inherits what both of them need, so that it is loaded once.
    for module in PARENT_MODULES:
        importlib.import_module(module)
    if cache is None:
        load_rules()
    else:
        recall_rules(cache)
        recall_digests(cache)
    return process_pool.Worker.start(partial(preload_modules, tier))


def preload_modules(tier: str | None = None) -> None:
    """Import what the audit of most models needs: no checks whose findings may be kept, nor of launch files or packages."""
    from urdfcheck.policy.policy import TIERS
    from urdfcheck.rules import get_check_module, has_check, load_rules
    from urdfcheck.run.findings_cache import is_cacheable
    from urdfcheck.run.unit_audit import find_missing_tier
    from urdfcheck.system import libraries

    libraries.prefer_own_folders()
    tier = tier or TIERS[-1]
    if tier != TIERS[0]:  # the text alone needs no arrays
        importlib.import_module("numpy")
    for rule in load_rules().values():
        runs = _CHECKED_ALWAYS.intersection(rule.scopes) and not find_missing_tier(rule.needs, tier)
        if runs and has_check(rule) and not is_cacheable(rule):
            importlib.import_module(get_check_module(rule))
    with contextlib.suppress(ImportError):  # it is optional
        importlib.import_module("py_landlock")
