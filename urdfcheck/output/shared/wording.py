"""Words and small phrases that several formats share."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from urdfcheck.core import Confidence, Finding, ModelInfo, Run, Severity, Span, Verdict
from urdfcheck.core.text import join_names
from urdfcheck.output.shared.escaping import escape_one_line
from urdfcheck.policy.consumers import is_news

SEVERITY_ORDER = (Severity.ERROR, Severity.WARNING, Severity.INFO)
GLYPHS = {Severity.ERROR: "✖", Severity.WARNING: "▲", Severity.INFO: "i"}
# The models that a shared finding names.
MOST_MODELS = 3
# The programs by the spelling of their own projects.
PROGRAM_NAMES = {
    "bullet": "Bullet",
    "drake": "Drake",
    "gazebo": "Gazebo",
    "isaac": "Isaac Sim",
    "kdl": "KDL",
    "moveit": "MoveIt",
    "mujoco": "MuJoCo",
    "newton": "Newton",
    "pinocchio": "Pinocchio",
    "ros": "ROS",
    "rviz": "RViz",
    "sdf": "SDFormat",
    "sdformat": "SDFormat",
}


def format_count(count: int, word: str) -> str:
    """Return ``2 links``; ``info`` has no plural."""
    return f"{count} {word}" + ("" if count == 1 or word == "info" else "s")


def describe_suppressed(counts: Mapping[str, int]) -> str:
    """Say how many findings are not shown, and why, as the end of a line; empty if there are none.

    :param counts: number of suppressed findings by source, configuration and baseline.
    """
    where = {
        "source": "suppressed in the source",
        "configuration": "by the configuration",
        "baseline": "in the baseline",
    }
    counted = [f"{counts[kind]:,} {words}" for kind, words in where.items() if counts.get(kind)]
    return f"; not shown: {', '.join(counted)}" if counted else ""


def format_place(span: Span) -> str:
    """Return ``file:line:column``, the notation of terminals and editors."""
    return f"{span.file}:{span.line}:{span.col}"


def sort_worst_first(findings: Iterable[Finding]) -> list[Finding]:
    """Sort findings by weight: severity, how many programs refuse the model or drop a part of it, confidence, and how many
    programs do anything else than load what was typed.

    Of one weight those of a rule stand together, the largest excess first: millimetres of one rule and percents of another
    cannot be compared. The rules, and findings without a difference, keep their order.
    """
    confidences = list(Confidence)
    findings = list(findings)

    def weigh(finding: Finding) -> tuple[int, ...]:
        verdicts = [Verdict.from_sentence(effect) for effect in finding.consequences.values()]
        return (
            -finding.severity,
            -verdicts.count(Verdict.REFUSES),
            -verdicts.count(Verdict.DROPS),
            confidences.index(finding.confidence),
            -sum(map(is_news, finding.consequences.values())),
        )

    weights = [weigh(finding) for finding in findings]
    places: dict[tuple[object, ...], int] = {}
    for place, (weight, finding) in enumerate(zip(weights, findings, strict=True)):
        places.setdefault((weight, finding.code), place)
    keys = [(weight, places[weight, f.code], -f.excess) for weight, f in zip(weights, findings, strict=True)]
    return [findings[i] for i in sorted(range(len(findings)), key=keys.__getitem__)]


def format_concise(run: Run, finding: Finding) -> str:
    """Return ``file:line:column: severity CODE headline``, which editors and scripts read; without a place the file alone."""
    span = finding.location.span
    place = find_finding_file(run, finding) if span is None else format_place(span)
    return escape_one_line(f"{place}: {finding.severity} {finding.code} {finding.headline}")


def describe_found_arguments(info: ModelInfo) -> str:
    """Say with which arguments a model was expanded that nobody gave, and who passes them; empty without any."""
    found = [f"{name}:={info.args.get(name, '')} ({place})" for name, place in sorted(info.found_args.items())]
    return f"expanded with {', '.join(found)}" if found else ""


def describe_models(run: Run, finding: Finding) -> str:
    """Name the models that share a finding, ``fer, fp3, fr3 and 3 more``; empty if all are made of one file."""
    paths = {info.id: info.path for info in run.models}
    ids = (finding.model, *(model for model in finding.subjects_by_model if model != finding.model))
    files = list(dict.fromkeys(paths.get(model, model) for model in ids))
    if len(files) < 2:
        return ""
    names = [get_base_name(file).partition(".")[0] for file in files]
    return join_names(files if len(set(names)) < len(names) else names, MOST_MODELS)


def find_finding_file(run: Run, finding: Finding) -> str:
    """Return the file of a finding without a span: its model's, or the package or launch file that its id names."""
    return next((info.path for info in run.models if info.id == finding.model), finding.model)


def get_base_name(path: str) -> str:
    """Return the last part of a path with slashes or backslashes."""
    return path.replace("\\", "/").rsplit("/", 1)[-1]


def join_with_and(names: Sequence[str], most: int = 100) -> str:
    """Join names, ``a, b and c``; of more than ``most`` and one the first ``most``, and how many more there are."""
    if len(names) > most + 1:
        return join_names(names, most)
    return " and ".join(filter(None, (", ".join(names[:-1]), *names[-1:])))
