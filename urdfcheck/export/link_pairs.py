"""The pairs of links that MoveIt need not check for collisions, as plain values and as a semantic description (SRDF)."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from urdfcheck.core import Finding, Severity, SkippedCheck
from urdfcheck.core.records import dataclass
from urdfcheck.source.text.xml import quote_attribute
from urdfcheck.system.files import read_regular
from urdfcheck.version import __version__

if TYPE_CHECKING:
    from urdfcheck.model import Model

# Configurations that are looked at, and with --thorough. Of 55 pairs of a seven-joint arm with a hand 30 do not collide in
# 200 of them, 22 in 5,000: an audit may miss a collision, a file that switches its check off should not.
SAMPLES, THOROUGH = 5_000, 20_000
# How a file that may be written over begins.
MARKER = "Written by urdfcheck srdf"
_COMMENT = re.compile(r"<!--.*?(?:-->|\Z)", re.DOTALL)
_TAG = re.compile(r"<([A-Za-z_][\w:.-]*)")
# Of how many trials without a hit the probability of one is below 3/N, at 95 % confidence (the rule of three).
_RULE_OF_THREE = 3.0


@dataclass(frozen=True, slots=True)
class LinkPair:
    """Two links with collision geometry, ``links`` in alphabetical order as Setup Assistant writes them. ``reason``: Adjacent
    | Default | Always | Never, None where the pair must be checked; ``proven``: that they never meet does not rest on samples;
    ``seen``: whether a sample met."""

    links: tuple[str, str]
    reason: str | None
    proven_never: bool
    seen_colliding: bool


@dataclass(frozen=True, slots=True)
class LinkPairs:
    """All pairs of a robot, in the order of their names; ``samples``: how many configurations were checked."""

    robot: str
    samples: int
    pairs: tuple[LinkPair, ...]


def compute_link_pairs(model: Model) -> LinkPairs:
    """The pairs of a model, judged as MoveIt's Setup Assistant does.

    :raises FactUnavailableError: when its collisions are not known.
    """
    from urdfcheck.model.motion.collisions.self_collisions import self_collisions  # loads numpy
    from urdfcheck.model.motion.moveit_pairs import classify_link_pairs

    pairs = [
        LinkPair(
            links=(min(j.pair.links), max(j.pair.links)),
            reason=j.reason,
            proven_never=j.pair.is_proven_apart,
            seen_colliding=not j.pair.is_never_in_collision,
        )
        for j in classify_link_pairs(model)
    ]
    samples = self_collisions(model).sample_count
    return LinkPairs(model.name, samples, tuple(sorted(pairs, key=lambda pair: pair.links)))


def explain_missing_pairs(failures: Iterable[str], skipped: Iterable[SkippedCheck], findings: Iterable[Finding]) -> str:
    """Return why the report on a model, of which these are parts, holds no pairs."""
    reasons = [*failures, *(skip.reason for skip in skipped if skip.code == "srdf")]
    for finding in findings:
        span = finding.location.span
        if finding.severity == Severity.ERROR:
            place = "" if span is None else f" ({span.file}:{span.line}:{span.col})"
            reasons.append(f"{finding.message}{place}")
    return reasons[0] if reasons else "the file holds no robot"


def has_foreign_content(file: Path) -> bool:
    """Whether a file is there that :func:`render_srdf` did not make, or to which something was added."""
    try:
        text = read_regular(file).decode("utf-8", "replace")
    except OSError:
        return False
    elements = set(_TAG.findall(_COMMENT.sub("", text)))
    return bool(text.strip()) and (MARKER not in text[:500] or not elements <= {"robot", "disable_collisions"})


def render_srdf(link_pairs: LinkPairs) -> str:
    """A semantic description that holds the ``disable_collisions`` of a robot and, in comments, what they rest on."""
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        f"<!-- {MARKER} {__version__}: the pairs of links that MoveIt need not check for collisions.",
        "     Copy the lines into the robot's SRDF, or include this file in its .srdf.xacro. -->",
        f"<robot name={quote_attribute(link_pairs.robot)}>",
        *_format_pair_groups(link_pairs),
        "</robot>",
    ]
    return "\n".join(lines) + "\n"


def _format_pair_groups(found: LinkPairs) -> Iterator[str]:
    samples = f"{found.samples:,} sampled configurations"
    never = [pair for pair in found.pairs if pair.reason == "Never"]
    groups = (
        (
            [pair for pair in found.pairs if pair.reason == "Adjacent"],
            "Adjacent: connected by a joint, or by joints with only links without collision geometry in between.",
        ),
        (
            [pair for pair in found.pairs if pair.reason == "Default"],
            "Default: collide in the default state (every joint at zero, or in the middle of a range without zero).\n"
            "MoveIt then misses their collisions in other states: correct the model where it is wrong, or begin in\n"
            "another state and delete these lines.",
        ),
        (
            [pair for pair in found.pairs if pair.reason == "Always"],
            f"Always: collide in more than 95 % of {samples}.",
        ),
        (
            [pair for pair in never if pair.proven_never],
            "Never: proven. Fixed joints hold them apart, or spheres around them, swept over the joints' ranges, do not\n"
            "reach each other.",
        ),
        (
            [pair for pair in never if not pair.proven_never],
            f"Never: not seen to collide in {samples}: at 95 % confidence they collide in less than\n"
            f"{100 * _RULE_OF_THREE / found.samples:.2g} % of them all.",
        ),
    )
    for pairs, evidence in groups:
        if pairs:
            indented = evidence.replace("\n", "\n         ")
            yield f"    <!-- {indented} -->"
            for pair in pairs:
                first, second = map(quote_attribute, pair.links)
                yield f'    <disable_collisions link1={first} link2={second} reason="{pair.reason}"/>'
    checked = [pair for pair in found.pairs if pair.reason is None]
    unknown = [pair for pair in checked if not pair.seen_colliding]
    yield f"    <!-- Still checked: {len(checked)} of {len(found.pairs)} pairs. -->"
    if unknown:
        yield f"    <!-- {len(unknown)} of these because a collision shape of one of the links could not be measured. -->"
