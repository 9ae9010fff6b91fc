"""What accompanies the message of a finding, as labels and sentences."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Run
from urdfcheck.output.shared.verdict.effects import ToldEffects, list_new_effects
from urdfcheck.output.shared.verdict.not_checked import explain_block
from urdfcheck.output.shared.wording import describe_models, format_count, get_base_name

# The label of what a finding for which a model could not be checked means.
BLOCK_LABEL = "Not checked"
# The places of a finding that are told one by one.
MOST_OCCURRENCES = 20


def iter_details(run: Run, finding: Finding, told: ToldEffects) -> Iterator[tuple[str, str]]:
    """Yield models, arguments, what is not checked for it, other places, cause, consequences and fix of a finding.

    ``told``: the consequences that the report told already; more is added.
    """
    if models := describe_models(run, finding):
        yield "In", models
    if arguments := run.find_variant_arguments(finding):
        yield "With", " ".join(f"{name}:={value}" for name, value in sorted(arguments.items()))
    if block := explain_block(run, finding):
        yield BLOCK_LABEL, block
    for other in describe_other_places(finding):
        yield "Also", other
    if finding.cause_text is not None:
        yield "Why", finding.cause_text
    for programs, effect in list_new_effects(run, finding, told):
        yield f"Then {programs}", effect
    if finding.fix is not None:
        yield "Fix", finding.fix.title


def describe_other_places(finding: Finding) -> list[str]:
    """Return a line for each place of a finding beside its own, with the claim there: ``arm.urdf:12 arm_2: … (2 % short)``.

    Where its repair is another one, it follows: `` → write izz="0.02"``.
    """
    others = finding.occurrences[1:]
    lines = [
        f"{_describe_place(own, finding)}{own.headline}{describe_own_repair(own, finding)}"
        for own in others[:MOST_OCCURRENCES]
    ]
    rest = len(others) - len(lines)
    return [*lines, f"{format_count(rest, 'more place')}"] if rest else lines


def describe_own_repair(occurrence: Finding, finding: Finding) -> str:
    """Return `` → write izz="0.02"`` where the repair of a place is another one than that of the first place."""
    first = finding.occurrences[0].fix
    if occurrence.fix is None or (first is not None and occurrence.fix.title == first.title):
        return ""
    return f" → {occurrence.fix.title}"


def _describe_place(occurrence: Finding, finding: Finding) -> str:
    """Return ``arm.urdf:12 ``; where a macro makes both, the place of the call."""
    here, via = occurrence.location.span, occurrence.location.via
    span = via[-1] if here == finding.location.span and via else here
    return "" if span is None else f"{get_base_name(span.file)}:{span.line} "
