"""LCH008 reports models that ROS 2 reads as yaml, and whose text is not the same text for yaml."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Applicability, Confidence, Finding, Rule, Severity
from urdfcheck.export.description_text import locate_output, render_output
from urdfcheck.model import Model
from urdfcheck.model.launch_context import LaunchContext
from urdfcheck.source.load import Source
from urdfcheck.source.text.yaml.parameter_text import explain_failure, find_yaml_mark

_WRAP = "wrap the value: `ParameterValue(…, value_type=str)`"
_DECLARE = 'declare the type: `type="str"`'


def check(subject: Model | LaunchContext, rule: Rule) -> Iterator[Finding]:
    if isinstance(subject, Model):
        yield from _check_model(subject.source, rule)
    elif subject.model is not None:
        yield from _check_launch(subject, subject.model.source, rule)


def _check_model(source: Source, rule: Rule) -> Iterator[Finding]:
    """Report the mark in a model that a launch file without a type would stop at."""
    text = render_output(source, by_xacro=source.is_xacro)
    mark = None if text is None else find_yaml_mark(text)
    if text is None or mark is None:
        return
    yield rule.finding(
        "text",
        at=locate_output(source, text, mark.offset) or source.file_location,
        severity=Severity.INFO,
        confidence=Confidence.STRONG,
        excerpt=mark.excerpt,
        what=mark.what,
    )


def _check_launch(context: LaunchContext, source: Source, rule: Rule) -> Iterator[Finding]:
    """Report commands whose output is the text of the model, and is not declared to be text."""
    from urdfcheck.source.launch.untyped_commands import find_untyped_commands  # most models are started by none

    for command in find_untyped_commands(context.launch, source.path):
        text = render_output(source, by_xacro=command.uses_xacro)
        mark = None if text is None else find_yaml_mark(text)
        reason = None if text is None or mark is None else explain_failure(text, mark)
        if text is None or mark is None or reason is None:
            continue
        place = locate_output(source, text, mark.offset)
        yield rule.finding(
            "passed",
            at=command.at,
            edits=command.edits,
            applicability=Applicability.SAFE,
            related=[] if place is None else [place],
            excerpt=mark.excerpt,
            what=mark.what,
            reason=f": {reason}" if reason else "",
            file=source.name,
            repair=_DECLARE if context.launch.python is None else _WRAP,
            explains=[f"{rule.code} {source.file_location.subject}"],
        )
