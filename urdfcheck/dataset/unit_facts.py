"""What an audit keeps of each model beside its line: what the file is, and which files it is made of.

Only with those of all models it is known which parts belong to a model, and which macro files are read by none.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence

from urdfcheck.core import ModelInfo, NotChecked, Severity
from urdfcheck.run.assemble_run import list_unused_macro_files
from urdfcheck.run.jobs import Unit, UnitReport
from urdfcheck.run.units.included_parts import assign_parts, find_read_spares
from urdfcheck.source.model_role import ModelRole
from urdfcheck.source.plan import Plan

_SEPARATOR = b"\n"
_FILES = ("files", "srdf_files", "expanded_files", "robot_files")


def add_unit_facts(line: bytes, report: UnitReport) -> bytes:
    """Return the line of a unit with the facts about it: the text that the journal keeps."""
    facts = {
        "role": [report.role.kind, report.role.reason, report.role.is_doubtful, report.role.has_whole_links],
        "status": None if report.info is None else report.info.status,
        "accepted": report.info is not None and report.info.unchecked_severity == Severity.WARNING,
        **{name: sorted(getattr(report, name)) for name in _FILES},
    }
    return line + _SEPARATOR + json.dumps(facts).encode()


def get_unit_line(text: bytes) -> bytes:
    """Return the line of a unit without the facts."""
    return text.partition(_SEPARATOR)[0]


class AuditedParts:
    """Which units of an audit are models, and what else was not checked."""

    def __init__(self, units: Sequence[Unit], texts: Iterable[bytes], plan: Plan) -> None:
        """``texts``: what the journal keeps of the units, in their order."""
        names: dict[str, str] = {}  # models share most of their files
        reports = {place: _read_report(units[place], text, names) for place, text in enumerate(texts)}
        audited = {place: report for place, report in reports.items() if not units[place].is_spare}
        spared = find_read_spares(units, audited)
        kept, unused = assign_parts([(units[i], report) for i, report in reports.items() if i not in spared])
        self.models = frozenset(unit.id for unit, _ in kept)
        """The ids of what is a model, a launch file or a package."""
        self.unused = unused
        """Files that are not one of these and belong to no model, with the reasons."""
        self.unused_macro_files = list_unused_macro_files(plan, kept)
        """Files that define macros and that no checked model has read."""


def _read_report(unit: Unit, text: bytes, names: dict[str, str]) -> UnitReport:
    """Return a report that holds the facts only."""
    facts = json.loads(text.partition(_SEPARATOR)[2])
    kind, reason, is_doubtful, has_whole_links = facts["role"]
    status = facts["status"]
    why = NotChecked("", accepted=facts["accepted"])
    info = None
    if status is not None:
        info = ModelInfo.unread(path=unit.path, model_id=unit.id, arguments={}, status=status, not_checked=why)
    files = {name: [names.setdefault(file, file) for file in facts[name]] for name in _FILES}
    return UnitReport(
        info=info,
        role=ModelRole(kind, reason, is_doubtful=is_doubtful, has_whole_links=has_whole_links),
        files=tuple(files["files"]),
        srdf_files=frozenset(files["srdf_files"]),
        expanded_files=frozenset(files["expanded_files"]),
        robot_files=frozenset(files["robot_files"]),
    )
