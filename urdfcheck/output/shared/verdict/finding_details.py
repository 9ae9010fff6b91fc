"""What accompanies the message of a finding, as labels and sentences."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Run
from urdfcheck.output.shared.verdict.not_checked import explain_block
from urdfcheck.output.shared.wording import PROGRAM_NAMES, describe_models, group_by_effect

# The label of what a finding for which a model could not be checked means.
BLOCK_LABEL = "Not checked"


def iter_details(run: Run, finding: Finding) -> Iterator[tuple[str, str]]:
    """Yield models, arguments, what is not checked for it, cause, consequences and fix of a finding."""
    if models := describe_models(run, finding):
        yield "In", models
    if arguments := run.find_variant_arguments(finding):
        yield "With", " ".join(f"{name}:={value}" for name, value in sorted(arguments.items()))
    if block := explain_block(run, finding):
        yield BLOCK_LABEL, block
    if finding.cause_text is not None:
        yield "Why", finding.cause_text
    for effect, programs in group_by_effect(finding.consequences).items():
        yield f"Then {', '.join(PROGRAM_NAMES.get(program, program) for program in programs)}", effect
    if finding.fix is not None:
        yield "Fix", finding.fix.title
