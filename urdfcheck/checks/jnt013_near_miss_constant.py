"""JNT013 reports fractions of π that are typed with too few digits or in several spellings."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import field, replace

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.records import dataclass
from urdfcheck.core.text import join_names
from urdfcheck.facts.likeness.typed_numbers import NearMiss, find_constant, find_near_miss
from urdfcheck.model import Joint, Model
from urdfcheck.source.text.tokens import Token, tokenize_attribute
from urdfcheck.source.text.values import parse_number
from urdfcheck.source.text.xml import Element

# So many rounded joints skew axes that planners take as parallel; one or two are within the tolerance of a good arm.
SKEWED_JOINTS = 3


@dataclass(frozen=True, slots=True, eq=False)
class _RoundedAngle:
    """A word for an angle with too few digits."""

    word: Token
    miss: NearMiss
    skews: bool
    """Whether it turns axes against others: it places a joint between moving ones, and not only a robot, a part or a picture."""

    @property
    def error(self) -> float:
        """The absolute error in rad."""
        return abs(self.miss.difference)

    def format_correction(self, *, in_xacro: bool) -> str:
        return self.miss.expression if in_xacro else repr(self.miss.exact)


@dataclass(slots=True)
class _ConstantSpellings:
    """The spellings of a constant in a file, whatever its sign."""

    rounded: dict[float, list[_RoundedAngle]] = field(default_factory=dict)
    """The words of each spelling with too few digits, by its size in rad."""
    exact: list[Token] = field(default_factory=list)
    """The words with all digits, however they are spelled."""


def check(model: Model, rule: Rule, *, negligible: float, harmful: float) -> Iterator[Finding]:
    constants: dict[tuple[str, str], _ConstantSpellings] = {}
    for word, value, skews in _collect_angles(model):
        miss = find_near_miss(word.text)
        constant = find_constant(value) if miss is None else miss.constant.lstrip("-")
        if constant is None or (miss is not None and abs(miss.difference) < negligible):
            continue
        spellings = constants.setdefault((word.span.file, constant), _ConstantSpellings())
        if miss is None:
            spellings.exact.append(word)
        else:
            spellings.rounded.setdefault(abs(value), []).append(_RoundedAngle(word, miss, skews))
    every = [
        _build_finding(model, rule, constant, spellings=spellings, harmful=harmful)
        for (_, constant), spellings in constants.items()
        if spellings.rounded
    ]
    mild = [finding for finding in every if finding.severity is Severity.INFO]
    yield from (finding for finding in every if finding.severity is not Severity.INFO)
    yield from mild if len(mild) < 2 else [_build_group_finding(rule, mild)]


def _build_group_finding(rule: Rule, findings: list[Finding]) -> Finding:
    """Report several constants, or files, of a robot together: one author or exporter wrote them."""
    counts: dict[str, int] = {}
    for finding in findings:
        spelling = "`{spelled}` for {constant} (off by {lever})".format_map(finding.data)
        counts[spelling] = counts.get(spelling, 0) + finding.data["count"]
    finding = rule.finding(
        "several",
        at=findings[0].location,
        related=[place for f in findings for place in (f.location, *f.related)][1:],
        edits=[edit for f in findings if f.fix is not None for edit in f.fix.edits],
        spellings=join_names(counts),
        forms=join_names(dict.fromkeys(f.data["spelled"] for f in findings)),
        count=sum(counts.values()),
        correct=join_names(dict.fromkeys(f.data["correct"].lstrip("-").replace("{-", "{") for f in findings)),
    )
    return replace(finding, subjects=tuple(dict.fromkeys(subject for f in findings for subject in f.subjects)))


def _build_finding(
    model: Model, rule: Rule, constant: str, *, spellings: _ConstantSpellings, harmful: float
) -> Finding:
    in_xacro = model.source.may_hold_expressions
    groups = sorted(spellings.rounded.values(), key=lambda group: -group[0].error)
    angles = sorted((angle for group in groups for angle in group), key=lambda angle: (-angle.error, not angle.skews))
    words = [angle.word for angle in angles]
    coarsest, error = groups[0], groups[0][0].error
    ways = [
        f"`{_strip_sign(group[0].word)}` ({_describe_place([angle.word for angle in group])}, "
        f"off by {_format_displacement(group[0].error)})"
        for group in groups
    ]
    if spellings.exact:
        ways.append(f"`{_strip_sign(spellings.exact[0])}` ({_describe_place(spellings.exact)}, exact)")
    finding = rule.finding(
        "rounded" if len(ways) == 1 else "mixed",
        at=words[0],
        related=[*words[1:], *spellings.exact[:1]],
        edits=[angle.word.build_edit(angle.format_correction(in_xacro=in_xacro)) for angle in angles],
        severity=Severity.WARNING
        if "moveit" in model.targets and _count_skewed(angles, harmful) >= SKEWED_JOINTS
        else None,
        spelled=_strip_sign(coarsest[0].word),
        times=_format_times(len(coarsest)),
        count=len(words),
        constant=_format_constant(constant),
        difference=error,
        lever=_format_displacement(error),
        number=len(ways),
        forms=join_names(
            dict.fromkeys(_strip_sign(word) for word in [*(g[0].word for g in groups), *spellings.exact[:1]])
        ),
        ways=", ".join(ways),
        correct=angles[0].format_correction(in_xacro=in_xacro),
    )
    return replace(finding, subjects=tuple(dict.fromkeys(word.location.subject for word in words)))


def _count_skewed(angles: Sequence[_RoundedAngle], harmful: float) -> int:
    return sum(angle.skews and angle.error > harmful for angle in angles)


def _collect_angles(model: Model) -> list[tuple[Token, float, bool]]:
    """Return the words of every origin's rpy with their angles (rad) and whether they skew axes; each place in the text once.

    A macro line skews axes where one of its calls does.
    """
    carriers = _collect_joints_between(model)
    angles: dict[tuple[str, int], tuple[Token, float, bool]] = {}
    for element in model.robot.walk():
        attribute = element.attributes.get("rpy") if element.tag == "origin" else None
        if attribute is None or (attribute.literal and not any(map(parse_number, attribute.value.split()))):
            continue  # nothing, or zeros
        words, values = tokenize_attribute(attribute, model.source.files), attribute.value.split()
        if len(words) == len(values):  # otherwise an expression made several numbers
            for word, text in zip(words, values, strict=True):
                value = parse_number(text)
                if value is not None:
                    place = (word.span.file, word.span.start)
                    first, angle, skews = angles.get(place, (word, value, False))
                    angles[place] = (first, angle, skews or element.parent in carriers)
    return list(angles.values())


def _collect_joints_between(model: Model) -> set[Element]:
    """Return the joints between two moving joints: before the first one, an angle rotates all axes alike."""
    above = {joint.child: joint for joint in model.joints}
    carriers: set[Element] = set()
    for joint in model.joints:
        link = joint.parent if joint.is_movable else ""
        while link in above and above[link].element not in carriers:
            carriers.add(above[link].element)
            link = above[link].parent
    moved = _list_moved_links(model)
    return {joint.element for joint in model.joints if joint.element in carriers and joint.parent in moved}


def _list_moved_links(model: Model) -> set[str]:
    """Return the links behind a moving joint."""
    joints: dict[str, list[Joint]] = {}
    for joint in model.joints:
        joints.setdefault(joint.parent, []).append(joint)
    waiting, moved = [joint.child for joint in model.joints if joint.is_movable], set[str]()
    while waiting:
        link = waiting.pop()
        if link not in moved:
            moved.add(link)
            waiting += [joint.child for joint in joints.get(link, ())]
    return moved


def _strip_sign(word: Token) -> str:
    return word.text.lstrip("+-")


def _format_constant(constant: str) -> str:
    return constant.replace("*pi", "π").replace("pi", "π")


def _format_times(count: int) -> str:
    return "once" if count == 1 else f"{count} times"


def _describe_place(words: list[Token]) -> str:
    """Return ``joint wheel_4`` for a single word in ``joint[wheel_4]/origin@rpy``, and the number of several."""
    subject = words[0].location.subject.split("/")[0]
    return subject.replace("[", " ").rstrip("]") if len(words) == 1 else _format_times(len(words))


def _format_displacement(radians: float) -> str:
    """Return the displacement of a point one metre away."""
    return f"{radians * 1e6:.2g} µm/m" if radians < 1e-4 else f"{radians * 1e3:.2g} mm/m"
