"""Predicted behaviour of each program that reads a model, and the severity override for the declared targets."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

from urdfcheck.core import Finding, Rule, Severity, Verdict
from urdfcheck.core.records import dataclass

# In the order of the tables. Pages name other programs where only these are concerned (xacro, roslaunch, colcon).
CONSUMERS = ("urdfdom", "pinocchio", "mujoco", "drake", "bullet", "gazebo", "isaac", "kdl", "moveit", "rviz")
OTHERS = (
    *(
        "bloom",
        "catkin",
        "colcon",
        "ros_control",
        "ros2_control",
        "ros2_launch",
        "ros_gz_bridge",
        "rosdep",
        "roslaunch",
        "trimesh",
        "xacro",
    ),
    "yourdfpy",
    "newton",
)
# Those of the targets that compute with masses.
SIMULATORS = frozenset({"gazebo", "mujoco", "drake", "bullet", "isaac"})
# Those that are asked what they do with a model if they are targets and installed: the ones that answer in a second.
ASKED_ENGINES = ("mujoco", "drake", "bullet")
# The one of them in which models are also dropped and driven.
SIMULATOR = "mujoco"
# They read the file through another program: what it rejects or drops, they do not get.
PARSERS = {**dict.fromkeys(("pinocchio", "gazebo", "kdl", "moveit", "rviz"), "urdfdom"), "isaac": "newton"}


@dataclass(frozen=True, slots=True)
class ConsumerOutcome:
    """What one program does with a model: the worst verdict of its findings, and the rules that report it."""

    verdict: Verdict
    codes: tuple[str, ...]
    unproven: tuple[str, ...] = ()
    """The rules that report something of which it is not known what the program does with it; where it does nothing else."""


def predict_outcomes(findings: Iterable[Finding], names: Sequence[str] = CONSUMERS) -> dict[str, ConsumerOutcome]:
    """Predict what each of these programs does with the model of these findings, suppressed ones included."""
    codes_by_verdict: dict[str, dict[Verdict, dict[str, None]]] = {name: {} for name in names}
    unproven: dict[str, set[str]] = {name: set() for name in names}
    for finding in findings:
        for name in _list_unproven(finding, names):
            unproven[name].add(finding.code)
        for name in names:
            codes_by_verdict[name].setdefault(get_verdict(finding.consequences, name), {})[finding.code] = None
    predicted = {}
    for name, verdicts in codes_by_verdict.items():
        worst = max(verdicts, default=Verdict.LOADS)
        codes = tuple(sorted(verdicts[worst])) if worst > Verdict.LOADS else ()
        predicted[name] = ConsumerOutcome(worst, codes, () if codes else tuple(sorted(unproven[name])))
    return predicted


def _list_unproven(finding: Finding, names: Sequence[str]) -> list[str]:
    """List the programs of which a finding says that it is not known what they do."""
    unproven = {program for own in finding.list_occurrences() for program in own.data.get("unproven", ())}
    return [name for name in names if name in unproven or PARSERS.get(name) in unproven] if unproven else []


def get_verdict(consequences: Mapping[str, str], consumer: str) -> Verdict:
    """Return what one program does with one defect."""
    sentence = consequences.get(consumer)
    if sentence is None and consumer in PARSERS:
        through = Verdict.from_sentence(consequences.get(PARSERS[consumer], ""))
        return through if through >= Verdict.DROPS else Verdict.LOADS
    return Verdict.from_sentence(sentence or "")


def is_news(sentence: str) -> bool:
    """Whether a sentence about a program says more than that it loads what was typed, which is the default."""
    return not sentence.startswith("loads")


def apply_severity_policy(
    finding: Finding, rule: Rule, *, targets: Sequence[str], severities: Mapping[str, str], is_pedantic: bool = False
) -> Finding:
    """Give a finding the severity of the configuration (``severities``, by code), or else that for the targets.

    ``is_pedantic``: whether notes that the page lists under ``pedantic`` are warnings, as they are for the targets listed there.
    """
    wanted = severities.get(finding.code)
    if wanted is not None:
        return replace(finding, severity=Severity.parse(wanted))
    raising = rule.pedantic.get(finding.message_id)
    if (
        raising is not None
        and finding.severity is Severity.INFO
        and (is_pedantic or not set(raising).isdisjoint(targets))
    ):
        finding = replace(finding, severity=Severity.WARNING)
    return apply_target_severity(finding, rule, targets)


def apply_target_severity(finding: Finding, rule: Rule, targets: Sequence[str]) -> Finding:
    """Raise a finding to an error if a target rejects or drops something, and lower it to an info if it concerns no target.

    Without targets it keeps the severity of its page.
    """
    if not targets:
        return finding
    worst = max(get_verdict(finding.consequences, target) for target in targets)
    if worst >= Verdict.DROPS:
        return replace(finding, severity=Severity.ERROR)
    if rule.concerns and not set(rule.concerns) & set(targets):
        return replace(finding, severity=Severity.INFO)
    return finding
