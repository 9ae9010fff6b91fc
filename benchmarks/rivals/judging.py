"""When a program has found a planted defect: one rule for every program."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

from urdfcheck.core import Run

SEVERITIES = ("info", "warning", "error")
# Operators that change the whole robot: any new finding is about it.
WHOLE = ("scale_mm", "scale_small")
# Names in quotes, and numbers, which differ in another file although the finding is the same.
_NUMBER = re.compile(r"('[^']*')|[-+]?\d[\d.]*(?:e[-+]?\d+)?")


@dataclass(frozen=True, slots=True, kw_only=True)
class Said:
    """One thing that a program reports."""

    severity: str
    check: str
    same: str
    """What it has in common with the same finding in another file: its kind and its parts, without measured numbers."""
    parts: tuple[str, ...]
    message: str


def list_said_by_urdfcheck(report: Run) -> list[Said]:
    """List what a run of urdfcheck reports, one for each subject."""
    found = []
    for finding in report.active_findings:
        for place in finding.list_occurrences():
            cause = "" if place.cause is None else place.cause.id
            for subject in place.subjects or ("",):
                same = f"{place.code} {place.message_ids.get(subject, place.message_id)} {cause} {subject}"
                part = subject.partition("[")[2].partition("]")[0]
                found.append(
                    Said(
                        severity=str(finding.severity),
                        check=place.code,
                        same=same,
                        parts=(part,),
                        message=place.message,
                    )
                )
    return found


def list_said_by_simcheck(answer: Iterable[Sequence[str]]) -> list[Said]:
    """List what simcheck reports, from severity, check, engine, target and message of each finding."""
    return [
        Said(
            severity=severity,
            check=check,
            same=f"{check} {engine} {target} {_NUMBER.sub(lambda m: m[1] or '#', message)}",
            parts=tuple(target.split("|")),
            message=message,
        )
        for severity, check, engine, target, message in answer
    ]


def find_new(before: Iterable[Said], after: Iterable[Said]) -> list[Said]:
    """Return what is reported of a file and not of the sound one, or not as severely."""
    known: dict[str, int] = {}
    for said in before:
        known[said.same] = max(known.get(said.same, -1), SEVERITIES.index(said.severity))
    return [said for said in after if known.get(said.same, -1) < SEVERITIES.index(said.severity)]


def is_about(said: Said, parts: Sequence[str], operator: str) -> bool:
    """Say whether a finding is about one of the changed parts: it is its subject, or named in quotes or backticks."""
    if operator in WHOLE or any(part in said.parts for part in parts if part):
        return True
    return any(f"{mark}{part}{mark}" in said.message for part in parts if part for mark in "'`\"")


def find_changed(clean: Path, planted: Path) -> list[str]:
    """Name the links and joints that differ, and the children of these joints."""
    old, new = ET.parse(clean).getroot(), ET.parse(planted).getroot()
    names: list[str] = []
    for before, after in zip(old, new, strict=True):
        if ET.tostring(before) == ET.tostring(after):
            continue
        names.append(after.get("name", ""))
        child = after.find("child")
        names += [child.get("link", "")] if child is not None else []
    return list(dict.fromkeys(names))


def read_said(line: Mapping[str, Any]) -> Said:
    """Read what was kept as JSON."""
    return Said(**{**line, "parts": tuple(line["parts"])})
