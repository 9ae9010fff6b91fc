"""Whether a shape collides or is only drawn: some engines never open the file of one that is drawn."""

from __future__ import annotations

from collections.abc import Iterable

from urdfcheck.source.text.xml import Element


def is_collision_part(element: Element) -> bool:
    """Whether an element is part of a ``<collision>``."""
    inner: Element | None = element
    while inner is not None and inner.tag != "collision":
        inner = inner.parent
    return inner is not None


def describe_missing_mesh(parts: Iterable[Element]) -> dict[str, str]:
    """What MuJoCo does with meshes that it cannot have (checked with MuJoCo 4.0)."""
    touched = any(map(is_collision_part, parts))
    return {"mujoco": "refuses to compile" if touched else "loads it: it leaves out what is only drawn"}


def describe_unreadable_mesh(parts: Iterable[Element]) -> dict[str, str]:
    """What MuJoCo and Drake do with mesh files that are there and cannot be read (checked with MuJoCo 4.0 and Drake 1.51)."""
    shapes = list(parts)
    touched = any(map(is_collision_part, shapes))
    drake = "refuses the model when contacts are looked for" if touched else "loads it, and cannot draw the shape"
    return {**describe_missing_mesh(shapes), "drake": drake}
