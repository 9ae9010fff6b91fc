"""MSH007 reports mesh corners with a coordinate that is NaN or infinite."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule
from urdfcheck.core.text import format_large_count
from urdfcheck.model import Model

# MuJoCo's reaction to such a mesh that collides, and to one that is only drawn.
MUJOCO_REFUSES = "refuses to compile: vertex coordinate is not finite"
MUJOCO_SKIPS = "loads it without shapes that are only drawn"
# Bullet's reaction to a binary STL that collides.
BULLET_CRASHES = "refuses the file by crashing"


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    for uses, facts in model.meshes.list_measured():
        if facts.non_finite_vertices:
            collides = uses[0].shape.role == "collision"
            crashes = collides and facts.format == "stl-binary"
            yield rule.finding(
                "non_finite",
                at=uses[0].filename,
                related=[use.filename for use in uses[1:]],
                consequences={
                    "mujoco": MUJOCO_REFUSES if collides else MUJOCO_SKIPS,
                    "bullet": BULLET_CRASHES if crashes else "loads it",
                },
                mesh=uses[0].filename.value,
                count=facts.non_finite_vertices,
                corners=format_large_count(facts.non_finite_vertices, "corner"),
            )
