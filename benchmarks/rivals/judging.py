"""When a program has found a planted defect: one rule for every program, urdfcheck included."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree as ET
from xml.parsers import expat

from urdfcheck.core import Run

SEVERITIES = ("info", "warning", "error")
# Operators that change the whole robot: any new finding is about it.
WHOLE = ("scale_mm", "scale_small")
# Words of which one says what an operator does, or the direct effect of it. They are wide on purpose: every finding that located
# a defect was read, of each program, and a word was added where one said the defect in other words.
NAMING = {
    "scale_mm": r"scale|unit|too (large|small|big|long)|dens|implausibl|millimet|\bmm\b|metres?\b|mjminval",
    "scale_small": r"scale|unit|too (large|small|big|long)|dens|implausibl|millimet|\bmm\b|metres?\b|mjminval",
    "flip_axis": r"\baxis|\baxes|opposite|revers|other way|mirror|turns?\b|same side|drive|through|overlap|collide",
    "zero_axis": r"\baxis|xyz vector",
    "swap_limits": r"lower.*upper|low.*high|(limits|bounds).*(swap|invert|revers|switch)",
    "degrees": r"degree|radian|\bdeg\b|°",
    "zero_inertia": r"inertia|moment|eigenvalue|tensor",
    "triangle": r"triang|principal moments|a \+ b|invalid inertia|rotational inertia|no body",
    "negative_inertia": r"positive|negative|below 0|below zero|invalid inertia|rotational inertia",
    "mass_grams": r"mass|dens|heav|kg\b|gram|unit",
    "zero_mass": r"\bmass",
    "no_inertial": r"inertia|\bmass",
    "no_collision": r"collision|collide",
    "collision_offset": r"collision|offset|overlap|apart|away|beside",
    "com_outside": r"\bcom\b|cent(er|re) of (mass|gravity)|inertial origin",
    "missing_mesh": r"mesh|file|not found|missing",
    "joint_into_parent": r"inside|overlap|penetrat|collide|intersect|through|embedded|sink|origin|frame|apart|away|beside|hover"
    r"|gap|twin|symmetr|mirror",
}  # fmt: skip
# Names in quotes, and numbers, which differ in another file although the finding is the same. A digit in a name is none.
_NUMBER = re.compile(r"('[^']*')|(?<![\w.])[-+]?\d[\d.]*(?:e[-+]?\d+)?")
_LINE = re.compile(r"FILE:(\d+)")


@dataclass(frozen=True, slots=True, kw_only=True)
class Change:
    """What an operator changed in a file."""

    parts: tuple[str, ...] = ()
    """Names of the links and joints whose text differs, and of the children of these joints."""
    lines: tuple[tuple[int, int], ...] = ()
    """First and last line of each of these elements in the planted file."""
    names: frozenset[str] = frozenset()
    """Names of all links and joints of the robot."""


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
                        parts=(part,) if part else (),
                        message=f"{place.headline}: {place.message}",
                    )
                )
    return found


def list_said(rows: Iterable[Sequence[str]], file: str) -> list[Said]:
    """List what another program reports of a file, from severity, kind, subject and text of each finding."""
    found = []
    for severity, check, subject, text in rows:
        message = text.replace(file, "FILE").replace(Path(file).name, "FILE")
        kind = _NUMBER.sub(lambda match: match[1] or "#", message)
        parts = tuple(part for part in subject.split("|") if part)
        found.append(
            Said(severity=severity, check=check, same=f"{check} {subject} {kind}", parts=parts, message=message)
        )
    return found


def find_new(before: Iterable[Said], after: Iterable[Said]) -> list[Said]:
    """Return what is reported of a file and not of the sound one, or not as severely."""
    known: dict[str, int] = {}
    for said in before:
        known[said.same] = max(known.get(said.same, -1), SEVERITIES.index(said.severity))
    return [said for said in after if known.get(said.same, -1) < SEVERITIES.index(said.severity)]


def is_located(said: Said, change: Change, operator: str) -> bool:
    """Say whether a finding is about a changed part: by its subject, a name in its text, or the line that it gives."""
    if operator in WHOLE or any(names_part(said, part) for part in change.parts if part):
        return True
    lines = [int(line) for line in _LINE.findall(said.message)]
    return any(first <= line <= last for line in lines for first, last in change.lines)


def is_about_nothing(said: Said, names: Collection[str]) -> bool:
    """Say whether a warning or an error gives no part of the robot at all: a refusal of the file, or a verdict on the whole."""
    placed = _LINE.search(said.message) or any(names_part(said, name) for name in names if name)
    return said.severity != "info" and not placed


def names_part(said: Said, name: str) -> bool:
    """Say whether a finding names a part: as its subject, between marks, after its kind, or as a word that is no plain word."""
    if name in said.parts:
        return True
    word = re.escape(name)
    marked = rf"""['"`\[(<]{word}['"`\])>]|\b(?:link|joint|body|named|name)\s+{word}(?![\w-])"""
    plain = rf"(?<![\w/.-]){word}(?![\w/-]|\.\w)" if re.search(r"[\d_A-Z-]", name) else None
    return bool(re.search(marked, said.message) or (plain and re.search(plain, said.message)))


def judge(before: Iterable[Said], after: Iterable[Said], change: Change, operator: str) -> tuple[str, ...]:
    """Return which of ``found``, ``located`` and ``named`` hold for what a program reports of a planted file."""
    new = find_new(before, after)
    located = [said for said in new if is_located(said, change, operator)]
    counted = located + [said for said in new if said not in located and is_about_nothing(said, change.names)]
    if not counted:
        return ()
    named = any(re.search(NAMING[operator], f"{said.check} {said.message}".lower()) for said in counted)
    return ("found", *(["located"] if located else []), *(["named"] if named else []))


def find_change(clean: Path, planted: Path) -> Change:
    """Find the links and joints that differ."""
    old, new = ET.parse(clean).getroot(), ET.parse(planted).getroot()
    places = _list_places(planted)
    parts: list[str] = []
    lines: list[tuple[int, int]] = []
    for before, after, place in zip(old, new, places, strict=True):
        if ET.tostring(before) == ET.tostring(after):
            continue
        parts.append(after.get("name", ""))
        child = after.find("child")
        parts += [child.get("link", "")] if child is not None else []
        lines.append(place)
    names = frozenset(part.get("name", "") for tag in ("link", "joint") for part in new.findall(tag))
    return Change(parts=tuple(dict.fromkeys(parts)), lines=tuple(lines), names=names)


def _list_places(file: Path) -> list[tuple[int, int]]:
    """List the first and the last line of each child of the root."""
    parser = expat.ParserCreate()
    open_at: list[int] = []
    places: list[tuple[int, int]] = []

    def begin(*_: object) -> None:
        open_at.append(parser.CurrentLineNumber)

    def end(*_: object) -> None:
        first = open_at.pop()
        if len(open_at) == 1:
            places.append((first, parser.CurrentLineNumber))

    parser.StartElementHandler, parser.EndElementHandler = begin, end
    parser.Parse(file.read_bytes(), True)
    return places
