"""What several formats say in the same words."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from urdfcheck.core import Finding, Run, Severity, Span

SEVERITY_ORDER = (Severity.ERROR, Severity.WARNING, Severity.INFO)
GLYPHS = {Severity.ERROR: "✖", Severity.WARNING: "▲", Severity.INFO: "i"}
# How the programs write themselves.
PROGRAM_NAMES = {
    "bullet": "Bullet",
    "drake": "Drake",
    "gazebo": "Gazebo",
    "isaac": "Isaac Sim",
    "kdl": "KDL",
    "moveit": "MoveIt",
    "mujoco": "MuJoCo",
    "pinocchio": "Pinocchio",
    "ros": "ROS",
    "rviz": "RViz",
    "sdf": "SDFormat",
    "sdformat": "SDFormat",
}


def format_count(count: int, word: str) -> str:
    """``2 links``; information has no plural."""
    return f"{count} {word}" + ("" if count == 1 or word == "info" else "s")


def describe_checked_units(run: Run) -> str:
    """``2 models``; ``1 file`` where all were launch files and packages."""
    return format_count(run.units, "file") if run.units and not run.models else format_count(len(run.models), "model")


def format_place(span: Span) -> str:
    """``file:line:column``, as terminals and editors take it."""
    return f"{span.file}:{span.line}:{span.col}"


def sort_worst_first(findings: Iterable[Finding]) -> list[Finding]:
    """Those of one severity stay in their order."""
    return sorted(findings, key=lambda finding: -finding.severity)


def group_by_effect(consequences: Mapping[str, str]) -> dict[str, list[str]]:
    """The programs by what they do: those that do the same thing share a line."""
    effects: dict[str, list[str]] = {}
    for program, effect in consequences.items():
        effects.setdefault(effect, []).append(program)
    return effects


def summarize_verdict(run: Run) -> tuple[str, str]:
    """How a run came out: error | warning | ok, and a sentence without its full stop."""
    errors, warnings = run.count_findings(Severity.ERROR), run.count_findings(Severity.WARNING)
    unread = sum(info.status != "checked" for info in run.models)
    if run.failures:
        return "error", "Not finished: a part of urdfcheck itself failed, so this verdict is incomplete"
    if not run.models and not run.units and not run.findings:
        return "warning", "Nothing was checked"
    if errors:
        return "error", f"{format_count(errors, 'error')} to repair"
    if unread:
        return "warning", f"{format_count(unread, 'model')} of {len(run.models)} could not be checked"
    if warnings:
        return "warning", f"No errors, {format_count(warnings, 'warning')} to look at"
    if not set(run.rules) - {"URC900"}:  # that one tells of crashes, whatever is selected
        return "warning", "Nothing was looked for: no rule is selected"
    return "ok", "No errors and no warnings"


def iter_details(run: Run, finding: Finding) -> Iterator[tuple[str, str]]:
    """What is said of a finding beyond its message: a label and a sentence."""
    if given := run.find_variant_arguments(finding):
        yield "With", " ".join(f"{name}:={value}" for name, value in sorted(given.items()))
    if finding.cause_text is not None:
        yield "Why", finding.cause_text
    for effect, programs in group_by_effect(finding.consequences).items():
        yield f"Then {', '.join(PROGRAM_NAMES.get(program, program) for program in programs)}", effect
    if finding.fix is not None:
        yield "Fix", finding.fix.title


def find_finding_file(run: Run, finding: Finding) -> str:
    """The file to name for a finding without a place: its model's, or what its id says of a package or a launch file."""
    return next((info.path for info in run.models if info.id == finding.model), finding.model)


def get_base_name(path: str) -> str:
    return path.replace("\\", "/").rsplit("/", 1)[-1]


def join_first(words: list[str], most: int) -> str:
    """The first ``most`` words, and how many more there are."""
    rest = len(words) - most
    return ", ".join(words[:most]) + (f" and {rest} more" if rest > 0 else "")
