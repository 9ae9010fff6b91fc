"""COL006 reports links that overlap at rest for MuJoCo: as convex hulls, or the root and its neighbours."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.text import format_length, join_names
from urdfcheck.model import Model
from urdfcheck.model.parts import locate_geometry

if TYPE_CHECKING:
    from urdfcheck.model.motion.collisions.engine_hulls import HullOverlap


def check(model: Model, rule: Rule, *, least: float) -> Iterator[Finding]:
    if "mujoco" not in model.targets:
        return
    from urdfcheck.model.motion.collisions.engine_hulls import find_hull_overlaps  # heavy, and only for a target
    from urdfcheck.model.motion.fixed_base import explain_fixed_base

    overlaps = find_hull_overlaps(model, least=least)
    hulls = [overlap for overlap in overlaps if not overlap.is_at_root]
    if hulls:
        yield _build_finding(rule, "hull", hulls, None)
    at_root = [overlap for overlap in overlaps if overlap.is_at_root]
    if at_root:
        yield _build_finding(rule, "root", at_root, None if explain_fixed_base(model) else Severity.INFO)


def _build_finding(rule: Rule, message: str, overlaps: Sequence[HullOverlap], severity: Severity | None) -> Finding:
    """Build the finding about some pairs, the deepest first."""
    worst = overlaps[0]
    one, other = worst.links
    return rule.finding(
        message,
        at=locate_geometry(worst.shapes[1]),
        related=[
            locate_geometry(shape) for overlap in overlaps for shape in overlap.shapes if shape is not worst.shapes[1]
        ],
        severity=severity,
        one=one,
        other=other,
        millimetres=1e3 * worst.depth,
        more=f" (+{len(overlaps) - 1})" if len(overlaps) > 1 else "",
        pairs=join_names([f"{' and '.join(o.links)} by {format_length(o.depth)}" for o in overlaps]),
    )
