"""LCH009 reports encodings declared in a model that a launch file passes to a program as text."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from urdfcheck.core import Applicability, Edit, Finding, Location, Rule, Severity, Span
from urdfcheck.model import Model
from urdfcheck.model.launch_context import LaunchContext
from urdfcheck.source.load import Source
from urdfcheck.source.text.xml import SourceFile
from urdfcheck.system.encodings import is_utf_8

if TYPE_CHECKING:
    from urdfcheck.source.launch.launch_file import Launch
    from urdfcheck.source.launch.nodes_xml import LaunchAction

_DECLARATION = re.compile(r"<\?xml\s[^>]*?(?P<whole>\s+encoding\s*=\s*(?P<quote>[\"'])(?P<name>[^\"'>]*)(?P=quote))")
_SPAWNER = "spawn_entity.py"


def check(subject: Model | LaunchContext, rule: Rule) -> Iterator[Finding]:
    if isinstance(subject, Model):
        yield from _check_source(subject.source, rule, [])
    elif subject.model is not None:
        source = subject.model.source
        spawners = _find_spawners(subject.launch, source) if _find_declaration(source) else []
        if spawners:
            yield from _check_source(source, rule, spawners)


def _check_source(source: Source, rule: Rule, spawners: Sequence[Span]) -> Iterator[Finding]:
    """Report the encoding that the file of a model declares; only a note unless a launch file spawns it as text."""
    found = _find_declaration(source)
    if found is None:
        return
    file, match = found
    subject = source.file_location.subject
    whole = file.make_span(*match.span("whole"))
    is_readable_without = is_utf_8(file.encoding) or file.text.isascii()  # without a declaration XML is UTF-8
    yield rule.finding(
        "spawned" if spawners else "declared",
        at=Location("launch" if spawners else subject, whole),
        related=[Location("launch", span) for span in spawners],
        severity=None if spawners else Severity.INFO,
        edits=[Edit(whole, match["whole"], "")] if is_readable_without else [],
        applicability=Applicability.SAFE,
        encoding=match["name"],
        repair="delete the encoding" if is_readable_without else "save the file in UTF-8 and delete the encoding",
        explains=[f"{rule.code} {subject}"] if spawners else [],
    )


def _find_declaration(source: Source) -> tuple[SourceFile, re.Match[str]] | None:
    """Return the declaration of a plain URDF; xacro writes one without an encoding."""
    file = source.files.get(source.name)
    match = None if file is None or source.is_xacro else _DECLARATION.match(file.text)
    return None if file is None or match is None else (file, match)


def _find_spawners(launch: Launch, source: Source) -> list[Span]:
    """Return the nodes of a launch file that spawn the text of the model's file."""
    from urdfcheck.source.launch.nodes_python import read_python_actions
    from urdfcheck.source.launch.nodes_xml import read_launch_actions

    contents = read_launch_actions(launch) if launch.python is None else read_python_actions(launch)
    is_expanded = any(description.uses_xacro for description in launch.descriptions)
    is_expanded |= launch.python is not None and launch.python.runs_xacro
    return [
        node.spans[0]
        for node in contents.nodes
        if node.program == _SPAWNER and node.spans and not node.off and _spawns(node, source, is_expanded=is_expanded)
    ]


def _spawns(node: LaunchAction, source: Source, *, is_expanded: bool) -> bool:
    """Whether a spawner gets the text of the model's file: from the file, or from the topic that a node publishes it on."""
    options = dict(zip(node.words, node.words[1:], strict=False))
    file, topic = options.get("-file"), options.get("-topic", "")
    if file is not None:
        return os.path.basename(file) == source.path.name
    return topic.rpartition("/")[2] == "robot_description" and not is_expanded
