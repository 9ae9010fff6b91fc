"""Expanding xacro without ROS, with a record of where everything was typed.

The PyPI package ``xacro`` does the expansion; its functions are wrapped while one file is expanded, so that each
element of the result carries its :class:`~urdfcheck.source.xacro.origins.Origin` and each property, argument and macro
parameter its :class:`~urdfcheck.source.text.xml.Definition`. The expanded document equals plain xacro's to the byte.

xacro keeps its state in module globals: one expansion at a time in a process.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from xml.dom import minidom

from urdfcheck.core import Span
from urdfcheck.core.errors import ModelTimeout
from urdfcheck.core.records import dataclass
from urdfcheck.source.package.finder import PackageFinder
from urdfcheck.source.text.problems import Problem
from urdfcheck.source.text.xml import Element, SourceFile
from urdfcheck.source.text.yaml.values import YamlKeyRead
from urdfcheck.source.xacro.expansion_state import ExpansionTrace
from urdfcheck.source.xacro.origins import InvalidOutputError, OutputDefect, convert_document
from urdfcheck.source.xacro.outside_access import FileAccess
from urdfcheck.source.xacro.patches import TracedArguments
from urdfcheck.source.xacro.ros_variables import VARIABLE
from urdfcheck.source.xacro.tracer import Tracer


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Expansion:
    """The outcome of an expansion."""

    root: Element | None
    """The expanded model; None if the expansion failed, for which ``problems`` holds the reason."""
    document: minidom.Document | None
    """The same as xacro's own document."""
    files: Mapping[str, SourceFile]
    """Each file that was read, by its name in findings."""
    trees: Mapping[str, Element]
    """The trees of these files as typed."""
    problems: tuple[Problem, ...]
    arguments_read: frozenset[str]
    loose_reads: frozenset[Span]
    """The places of definitions that conditions, texts and names of files read."""
    key_reads: tuple[YamlKeyRead, ...]
    """The keys of yaml files that texts with expressions read."""
    may_vary_with_order: bool
    """Whether another order of the items of sets may make another robot: False where that was ruled out."""


def expand_xacro(
    path: Path,
    arguments: Mapping[str, str],
    finder: PackageFinder,
    *,
    extra_environment: frozenset[str] = frozenset(),
) -> Expansion:
    """Expand a xacro file with the given arguments. Never raises because of the file's content.

    ``extra_environment``: variables that the file may read besides those of ROS. An argument whose name begins with
    :data:`~urdfcheck.source.xacro.ros_variables.VARIABLE` is the value of a variable of the environment instead.
    """
    trace = ExpansionTrace()
    variables = {name.removeprefix(VARIABLE): value for name, value in arguments.items() if name.startswith(VARIABLE)}
    arguments = {name: value for name, value in arguments.items() if not name.startswith(VARIABLE)}
    access = FileAccess(path, finder, extra_environment=extra_environment, trace=trace, variables=variables)
    document: minidom.Document | None = None
    root: Element | None = None
    tracer = Tracer(trace, access)
    with tracer.install_wrappers():
        import xacro

        try:
            document = xacro.process_file(str(path), mappings=TracedArguments(arguments, trace.record_argument_read))
            assert document is not None  # the reference implementation raises for a text that is not a document
            tracer.orders.note_other_use()
            defects: list[OutputDefect] = []
            root = convert_document(document, defects)
            for defect in defects:
                trace.report_problem(defect.kind, defect.message, access.locate_defect(defect), **defect.data)
        except ModelTimeout:
            trace.report_limit("time-limit")
        except InvalidOutputError as error:
            trace.report_problem("expansion-failed", str(error), error.location, macros=(), argument=None, evaluated="")
        except Exception as error:  # whatever a stranger's expression raises is a finding, not a crash
            trace.report_failure(error)
    return Expansion(
        root=root,
        document=document if root is not None else None,
        files=access.files,
        trees=access.trees,
        problems=tuple(trace.problems),
        arguments_read=frozenset(trace.arguments_read),
        loose_reads=frozenset(trace.loose_reads),
        key_reads=tuple(trace.key_reads.values()),
        may_vary_with_order=root is None or tracer.orders.is_undecided,
    )
