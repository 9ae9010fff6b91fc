"""The tensors of a file beside those of what its links draw: what the mistakes of a whole file are counted in."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.facts.inertials.inertia_tensor import compute_solid_inertia
from urdfcheck.facts.inertials.placeholders import describe_placeholder
from urdfcheck.model.fact import fact
from urdfcheck.model.parts import Link, has_drawn_shape
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.visual_solid import has_unit_ambiguity, measure_link_geometry

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Mat3, Vec3

# Copies and mirror images are one piece of evidence: mass and principal moments agree in so many digits.
_DIGITS = 3


@dataclass(frozen=True, slots=True, eq=False)
class MeasuredTensor:
    """A tensor, and that of the drawn part at the same mass and uniform density, both in kg m² in the link's axes."""

    link: Link
    mass: float
    com: Vec3
    """As typed, in m in the link's frame."""
    inertia: Mat3
    uniform: Mat3

    @property
    def ratios(self) -> Vec3:
        """How many times as large the principal moments (3,) are as those of the drawn part, each in order of size."""
        ratios: Vec3 = np.linalg.eigvalsh(self.inertia) / np.linalg.eigvalsh(self.uniform)
        return ratios

    @property
    def key(self) -> tuple[str, ...]:
        """What copies and mirror images have in common."""
        return tuple(f"{v:.{_DIGITS}g}" for v in (self.mass, *np.linalg.eigvalsh(self.inertia)))


@fact
def measure_tensors(model: Model) -> Sequence[MeasuredTensor]:
    """Measure the tensors of all links that draw a solid about whose size programs agree; placeholders aside."""
    measured = []
    for declared in model.tensors:
        link, mass, matrix = declared.link, declared.inertial.mass, declared.inertial.origin.matrix
        if mass is None or not mass > 0.0 or matrix is None or not has_drawn_shape(link):
            continue
        if describe_placeholder(mass, declared.components) is not None or has_unit_ambiguity(model, (link.name,)):
            continue
        drawn = measure_link_geometry(model, link)
        uniform = None if drawn is None else compute_solid_inertia(drawn.solid, mass)
        if uniform is None or not np.linalg.eigvalsh(uniform)[0] > 0.0:
            continue
        rotation = matrix[:3, :3]
        inertia = rotation @ declared.tensor @ rotation.T
        if np.isfinite(inertia).all():
            measured.append(MeasuredTensor(link, mass, matrix[:3, 3], inertia, uniform))
    return tuple(measured)
