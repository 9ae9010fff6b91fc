"""What accompanies the message of a finding, as labels and sentences."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Run
from urdfcheck.output.shared.verdict.effects import ToldEffects, list_new_effects
from urdfcheck.output.shared.verdict.not_checked import explain_block
from urdfcheck.output.shared.wording import describe_models

# The label of what a finding for which a model could not be checked means.
BLOCK_LABEL = "Not checked"


def iter_details(run: Run, finding: Finding, told: ToldEffects) -> Iterator[tuple[str, str]]:
    """Yield models, arguments, what is not checked for it, cause, consequences and fix of a finding.

    ``told``: the consequences that the report told already; more is added.
    """
    if models := describe_models(run, finding):
        yield "In", models
    if arguments := run.find_variant_arguments(finding):
        yield "With", " ".join(f"{name}:={value}" for name, value in sorted(arguments.items()))
    if block := explain_block(run, finding):
        yield BLOCK_LABEL, block
    if finding.cause_text is not None:
        yield "Why", finding.cause_text
    for programs, effect in list_new_effects(run, finding, told):
        yield f"Then {programs}", effect
    if finding.fix is not None:
        yield "Fix", finding.fix.title
