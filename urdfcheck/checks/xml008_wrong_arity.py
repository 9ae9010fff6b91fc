"""XML008 reports attributes with too few or too many numbers."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Edit, Finding, Rule
from urdfcheck.core.text import format_count
from urdfcheck.model import Model
from urdfcheck.model.repairs.edits import edit_literal
from urdfcheck.source.text.engine_reactions import describe_loss
from urdfcheck.source.text.grammar import NUMERIC_ATTRIBUTES, iter_first_elements
from urdfcheck.source.text.values import parse_number
from urdfcheck.source.text.xml import Attribute

# The probable meaning of fewer numbers: one scale for all axes, a colour without alpha.
_ONE_SCALE = ("mesh", "scale", 1)
_COMPLETED = {_ONE_SCALE: "{0} {0} {0}", ("color", "rgba", 3): "{0} {1} {2} 1"}


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    for element in iter_first_elements(model.robot):
        for name, count in NUMERIC_ATTRIBUTES.get(element.tag, {}).items():
            attribute = element.attributes.get(name)
            words = attribute.value.split() if attribute is not None else []
            if attribute is None or not words or len(words) == count or any(parse_number(w) is None for w in words):
                continue
            # urdfdom reads a colour of the wrong length as black, without a message.
            message = "colour" if element.tag == "color" else "count"
            yield rule.finding(
                message,
                at=attribute,
                edits=_propose_edits(attribute, words),
                related=attribute.collect_definitions(),
                consequences=_describe_effects(attribute, words) if message == "count" else None,
                where=f"{element.subject}@{name}",
                value=" ".join(words) if len(words) <= 8 else " ".join(words[:8]) + " …",
                found=len(words),
                expected=count,
                needed=format_count(count, "number"),
            )


def _describe_effects(attribute: Attribute, words: list[str]) -> dict[str, str]:
    effects = {"urdfdom": describe_loss(attribute.owner)}
    is_one_scale = (attribute.owner.tag, attribute.name, len(words)) == _ONE_SCALE
    return effects | {"drake": "loads it: one number scales all axes"} if is_one_scale else effects


def _propose_edits(attribute: Attribute, words: list[str]) -> list[Edit]:
    template = _COMPLETED.get((attribute.owner.tag, attribute.name, len(words)))
    return [] if template is None else edit_literal(attribute, template.format(*words))
