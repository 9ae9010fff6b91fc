"""URC905: files and meshes that are larger than anything that is made for a robot."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from urdfcheck.core import Finding, Rule, Unavailable
from urdfcheck.model import Model
from urdfcheck.model.tree import TooDeep
from urdfcheck.source.launch.launch_file import Launch
from urdfcheck.source.load import Source
from urdfcheck.source.package.finder import Package


def check(subject: Source | Launch | Package | Model, rule: Rule) -> Iterator[Finding]:
    if isinstance(subject, Model):
        yield from _meshes(subject, rule)
        yield from _chain(subject, rule)
        return
    message = "model" if isinstance(subject, Source) else "launch" if isinstance(subject, Launch) else "manifest"
    for problem in subject.problems:
        if problem.kind == "too-large":
            at = replace(problem.location, subject=problem.location.subject or "robot")
            yield rule.finding(message, at=at, related=problem.related, error=problem.message, **problem.data)


def _meshes(model: Model, rule: Rule) -> Iterator[Finding]:
    for path, uses in model.meshes.by_file().items():
        error = model.meshes.errors.get(path)
        if error is not None and error.reason_id == "too-large":
            first, *others = (use.filename for use in uses)
            yield rule.finding("mesh", at=first, related=others, mesh=first.value, error=str(error))


def _chain(model: Model, rule: Rule) -> Iterator[Finding]:
    try:
        _ = model.tree
    except TooDeep as deep:
        last = model.link_by_name[deep.link].element
        yield rule.finding("chain", at=last, what="levels", limit=deep.limit, found=deep.levels)
    except Unavailable:
        pass  # the KIN rules say why there is no tree
