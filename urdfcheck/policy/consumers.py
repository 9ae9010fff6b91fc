"""What the programs that read a model will do with it, as the findings tell it, and how bad that is for those that will."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from urdfcheck.core import Finding, Rule, Severity, Verdict

# In the order of the tables. Other programs are named on the pages where only they are concerned (xacro, roslaunch, colcon).
CONSUMERS = ("urdfdom", "pinocchio", "mujoco", "drake", "bullet", "gazebo", "isaac", "kdl", "moveit", "rviz")
OTHERS = (
    *(
        "bloom",
        "catkin",
        "colcon",
        "ros2_control",
        "ros2_launch",
        "ros_gz_bridge",
        "rosdep",
        "roslaunch",
        "trimesh",
        "xacro",
    ),
    "yourdfpy",
)
# They let urdfdom read the file: where it has no robot, they have none.
THROUGH_URDFDOM = frozenset({"pinocchio", "gazebo", "kdl", "moveit", "rviz"})


@dataclass(frozen=True, slots=True)
class ConsumerOutcome:
    """What becomes of a model in one program: the worst of what its findings say, and the rules that say so."""

    verdict: Verdict
    codes: tuple[str, ...]


def predict_outcomes(findings: Iterable[Finding]) -> dict[str, ConsumerOutcome]:
    """What each of :data:`CONSUMERS` will do with the model that these findings are about. That a finding is known changes
    nothing about it."""
    told: dict[str, dict[Verdict, dict[str, None]]] = {name: {} for name in CONSUMERS}
    for finding in findings:
        for name in CONSUMERS:
            told[name].setdefault(get_verdict(finding.consequences, name), {})[finding.code] = None
    found = {}
    for name, verdicts in told.items():
        worst = max(verdicts, default=Verdict.LOADS)
        found[name] = ConsumerOutcome(worst, tuple(sorted(verdicts[worst])) if worst > Verdict.LOADS else ())
    return found


def get_verdict(consequences: Mapping[str, str], consumer: str) -> Verdict:
    """What one program does with one defect."""
    sentence = consequences.get(consumer)
    if sentence is None and consumer in THROUGH_URDFDOM:
        through = Verdict.from_sentence(consequences.get("urdfdom", ""))
        return through if through >= Verdict.DROPS else Verdict.LOADS
    return Verdict.from_sentence(sentence or "")


def apply_severity_policy(
    finding: Finding, rule: Rule, targets: Sequence[str], severities: Mapping[str, str]
) -> Finding:
    """The finding as bad as the configuration says (``severities``, by code), or else as :func:`apply_target_severity` does."""
    wanted = severities.get(finding.code)
    return (
        apply_target_severity(finding, rule, targets)
        if wanted is None
        else replace(finding, severity=Severity.parse(wanted))
    )


def apply_target_severity(finding: Finding, rule: Rule, targets: Sequence[str]) -> Finding:
    """The finding as bad as it is for those who will read the model: what one of them refuses or drops is an error, and what
    the rule says to concern others alone is worth knowing. Without targets it is as bad as its page says."""
    if not targets:
        return finding
    worst = max(get_verdict(finding.consequences, target) for target in targets)
    if worst >= Verdict.DROPS:
        return replace(finding, severity=Severity.ERROR)
    if rule.concerns and not set(rule.concerns) & set(targets):
        return replace(finding, severity=Severity.INFO)
    return finding
