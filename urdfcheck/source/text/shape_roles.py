"""Whether a shape collides or is only drawn: some engines never open the file of one that is drawn."""

from __future__ import annotations

from collections.abc import Iterable

from urdfcheck.source.text.xml import Element


def collides(element: Element) -> bool:
    """Whether an element is part of a ``<collision>``."""
    inner: Element | None = element
    while inner is not None and inner.tag != "collision":
        inner = inner.parent
    return inner is not None


def compiled(parts: Iterable[Element]) -> dict[str, str]:
    """What MuJoCo does with meshes that it cannot have (checked with MuJoCo 4.0)."""
    touched = any(map(collides, parts))
    return {"mujoco": "refuses to compile" if touched else "loads it: it leaves out what is only drawn"}


def opened(parts: Iterable[Element]) -> dict[str, str]:
    """What MuJoCo and Drake do with mesh files that are there and cannot be read (checked with MuJoCo 4.0 and Drake 1.51)."""
    shapes = list(parts)
    touched = any(map(collides, shapes))
    drake = "refuses the model when contacts are looked for" if touched else "loads it, and cannot draw the shape"
    return {**compiled(shapes), "drake": drake}
