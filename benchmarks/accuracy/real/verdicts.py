"""What urdfcheck says about a defect: what is new in its findings, and whether that is the defect that was made."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np

from real.changes import ReadRobot, Texts, change_edits, read_robot
from real.kinds import Kind
from urdfcheck.core import Confidence, Finding, Run, Severity

# Values of a repaired robot agree with those of the sound one within this share of the largest of an attribute.
_AGREE = 0.01
_NUMERIC = (
    "value",
    "xyz",
    "rpy",
    "scale",
    "size",
    "radius",
    "length",
    "lower",
    "upper",
    "effort",
    "velocity",
    "multiplier",
)
_DEFAULTS: dict[str, list[float] | str] = {"scale": [1.0, 1.0, 1.0], "xyz": [0.0, 0.0, 0.0], "rpy": [0.0, 0.0, 0.0]}
_TENSOR = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")

# Rule, message, cause and subject.
Key = tuple[str, str, str, str]


@dataclass(slots=True, kw_only=True)
class Verdict:
    """What is new at warning or above."""

    found: bool = False
    """Whether a finding concerns the broken part."""
    named: bool = False
    """Whether one of these says what was done, or repairs it."""
    wrong: bool = False
    """Whether one of these names a cause that is another one, at strong or proof."""
    other: bool = False
    """Whether a finding concerns other parts only."""
    edit: str = ""
    """``right`` or ``wrong``: what the offered edits make of the robot; empty without edits."""
    lines: list[str] = field(default_factory=list)
    """The findings as text."""


def list_keys(run: Run) -> dict[Key, Severity]:
    """List what a run says, each with the highest severity."""
    keys: dict[Key, Severity] = {}
    for _, key, severity in _iter_keys(run):
        keys[key] = max(severity, keys.get(key, severity))
    return keys


def find_new(before: Mapping[Key, Severity], after: Run) -> list[tuple[Finding, set[str]]]:
    """Find what is reported at warning or above and was not before, or not as severely, with the subjects.

    A cause that was named before is not new, in another message or less severely: the robot had that mistake.
    """
    causes = {(code, cause, subject) for code, _, cause, subject in before if cause}
    new: dict[int, tuple[Finding, set[str]]] = {}
    for finding, key, severity in _iter_keys(after):
        code, _, cause, subject = key
        is_known = (code, cause, subject) in causes or before.get(key, Severity.INFO) >= severity
        if severity >= Severity.WARNING and not is_known:
            new.setdefault(id(finding), (finding, set()))[1].add(key[3])
    return list(new.values())


def _iter_keys(run: Run) -> Iterator[tuple[Finding, Key, Severity]]:
    for finding in run.active_findings:
        for place in finding.list_occurrences():
            cause = "" if place.cause is None else place.cause.id
            for subject in place.subjects:
                message = place.message_ids.get(subject, place.message_id)
                yield place, (place.code, message, cause, subject), finding.severity


def judge(
    kind: Kind, says: str, broken: set[str], sound: ReadRobot, texts: Texts, new: Iterable[tuple[Finding, set[str]]]
) -> Verdict:
    """Judge what is new.

    :param says: pattern of the words that name the case; empty: that of the kind.
    :param broken: labels of the broken links and joints (``link[a]``).
    :param texts: of the broken robot.
    """
    verdict = Verdict()
    names = {label[label.index("[") + 1 : -1] for label in broken}
    for finding, subjects in new:
        if not _concerns(finding, subjects, broken, names):
            verdict.other = True
            verdict.lines.append(f"elsewhere: {describe(finding)}")
            continue
        verdict.found = True
        text = "\n".join(list_texts(finding))
        repaired = _is_repaired(sound, texts, finding)
        if repaired is not None and not (kind.is_lossy and not repaired):
            verdict.edit = "wrong" if not repaired or verdict.edit == "wrong" else "right"
        right = not kind.is_nameless and (finding.code in kind.codes or kind.names(text, says) or repaired is True)
        verdict.named |= right
        claims = finding.cause is not None and finding.confidence is not Confidence.HEURISTIC
        claims &= not (kind.family == "inertial" and _is_true_of_sound(sound, finding, subjects))
        verdict.wrong |= claims and not right
        state = "named" if right else "WRONG" if claims else "found"
        verdict.lines.append(
            f"{state}{'' if repaired is None else ', repaired' if repaired else ', NOT REPAIRED'}: {describe(finding)}"
        )
    return verdict


def _is_true_of_sound(sound: ReadRobot, finding: Finding, subjects: Iterable[str]) -> bool:
    """Whether the named cause is a COM of 0 0 0, or a typed multiple of the identity, that the robot had before: the defect only
    made it show."""
    if finding.cause is None or finding.cause.id not in {"com_missing", "placeholder"}:
        return False
    known = {f"link[{part.link.name}]": part.numbers for part in sound.parts if part.numbers is not None}
    named = [numbers for subject in subjects for label, numbers in known.items() if subject.startswith(label)]
    if finding.cause.id == "com_missing":
        return bool(named) and not any(numbers.com.any() for numbers in named)
    return bool(named) and all(np.array_equal(n.six, n.six[0] * np.array((1, 0, 0, 1, 0, 1))) for n in named)


def describe(finding: Finding) -> str:
    """Return a finding as one line."""
    cause = "" if finding.cause is None else f" [{finding.cause.id}: {finding.cause.text}]"
    return f"{finding.code} {finding.message_id} {finding.severity} {finding.confidence}: {finding.headline}{cause}"


def list_texts(finding: Finding) -> Iterator[str]:
    """Yield what a finding says to its reader."""
    yield finding.headline
    yield finding.message
    if finding.cause is not None:
        yield finding.cause.text
    if finding.fix is not None:
        yield finding.fix.title


def _concerns(finding: Finding, subjects: Iterable[str], broken: set[str], names: set[str]) -> bool:
    """Whether a finding is at a broken part, or names one."""
    if any(subject.startswith(label) for subject in subjects for label in broken):
        return True
    words = finding.message + "\n" + finding.headline
    return any(_has_word(words, name) for name in names)


def _has_word(text: str, name: str) -> bool:
    at = text.find(name)
    while at >= 0:
        before, after = text[at - 1 : at], text[at + len(name) : at + len(name) + 1]
        if not (before.isalnum() or before == "_" or after.isalnum() or after == "_"):
            return True
        at = text.find(name, at + 1)
    return False


def _is_repaired(sound: ReadRobot, texts: Texts, finding: Finding) -> bool | None:
    """Whether the edits that a finding offers make the sound robot of the broken one; None if it offers none."""
    if finding.fix is None or not finding.fix.edits:
        return None
    broken = read_robot(sound.robot, texts)
    if broken is None:
        return None
    edited = dict(texts)
    edited.update(broken.apply(change_edits(finding.fix.edits)))
    repaired = read_robot(sound.robot, edited)
    if repaired is None:
        return False
    labels = set().union(*(broken.list_subjects(edit.span) for edit in finding.fix.edits))
    old, new = (list_values(read) for read in (sound, repaired))
    keys = {key for key in old | new if any(f"{key[0]}/".startswith(f"{label}/") for label in labels)}
    defaults = {key: _DEFAULTS[key[1]] for key in keys if key[1] in _DEFAULTS}
    old, new = defaults | old, defaults | new
    return bool(keys) and all(key in old and key in new and _agree(old[key], new[key]) for key in keys)


def list_values(read: ReadRobot) -> dict[tuple[str, str], list[float] | str]:
    """List the values of all links and joints by subject and attribute; a tensor counts as one."""
    values: dict[tuple[str, str], list[float] | str] = {}
    for part in read.model.named_elements:
        for element in part.element.walk():
            if element.tag == "inertia":
                six = [_to_numbers(element.get(name, "0")) for name in _TENSOR]
                values[element.subject, "six"] = [number for one in six for number in one or [np.nan]]
                continue
            for name, attribute in element.attributes.items():
                numbers = _to_numbers(attribute.value) if name in _NUMERIC else None
                values[element.subject, name] = attribute.value if numbers is None else numbers
    return values


def _to_numbers(text: str) -> list[float] | None:
    try:
        return [float(word) for word in text.split()]
    except ValueError:
        return None


def _agree(old: list[float] | str, new: list[float] | str) -> bool:
    if isinstance(old, str) or isinstance(new, str):
        return old == new
    if len(old) != len(new):
        return False
    largest = max((abs(value) for value in old), default=0.0)
    return bool(np.allclose(old, new, rtol=0, atol=_AGREE * largest + 1e-9))
