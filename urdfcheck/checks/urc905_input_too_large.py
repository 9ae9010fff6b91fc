"""URC905: files and meshes that are larger than anything that is made for a robot."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from urdfcheck.core import FactUnavailableError, Finding, Rule
from urdfcheck.model import Model
from urdfcheck.model.launch_context import LaunchContext
from urdfcheck.model.tree import TreeTooDeepError
from urdfcheck.source.load import Source
from urdfcheck.source.package.finder import Package


def check(subject: Source | LaunchContext | Package | Model, rule: Rule) -> Iterator[Finding]:
    if isinstance(subject, Model):
        yield from _check_mesh_sizes(subject, rule)
        yield from _check_tree_depth(subject, rule)
        return
    if isinstance(subject, LaunchContext):
        message, problems = "launch", subject.launch.problems
    else:
        message, problems = ("model" if isinstance(subject, Source) else "manifest"), subject.problems
    for problem in problems:
        if problem.kind == "too-large":
            at = replace(problem.location, subject=problem.location.subject or "robot")
            yield rule.finding(message, at=at, related=problem.related, error=problem.message, **problem.data)


def _check_mesh_sizes(model: Model, rule: Rule) -> Iterator[Finding]:
    for path, uses in model.meshes.group_by_file().items():
        error = model.meshes.errors.get(path)
        if error is not None and error.reason_id == "too-large":
            first, *others = (use.filename for use in uses)
            yield rule.finding("mesh", at=first, related=others, mesh=first.value, error=str(error))


def _check_tree_depth(model: Model, rule: Rule) -> Iterator[Finding]:
    try:
        _ = model.tree
    except TreeTooDeepError as deep:
        last = model.link_by_name[deep.link].element
        yield rule.finding("chain", at=last, what="levels", limit=deep.limit, found=deep.levels)
    except FactUnavailableError:
        pass  # the KIN rules say why there is no tree
