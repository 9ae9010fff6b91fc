"""The unit of a file's inertia tensors: a matter of the program that wrote the file, not of one link."""

from __future__ import annotations

from urdfcheck.core.records import dataclass
from urdfcheck.facts.inertials.materials import LIGHTEST
from urdfcheck.model.fact import fact
from urdfcheck.model.inertials.habits.measured_tensors import MeasuredTensor, measure_tensors
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.visual_solid import measure_link_geometry

# kg·m² in one unit that a tensor is written in by mistake, from programs that calculate in grams or in smaller lengths.
TENSOR_UNITS = {"kg·cm²": 1e-4, "kg·mm²": 1e-6, "g·m²": 1e-3, "g·cm²": 1e-7, "g·mm²": 1e-9}
# A motor inside a part, or a hull around it, changes a principal moment by less than this factor. Two units are ten apart.
_NEAR = 3.0
# So many links that differ have to fit a unit, and half of all.
_FEWEST, _SHARE = 4, 0.5


@dataclass(frozen=True, slots=True)
class TensorUnit:
    """A unit in which the tensors of a file fit."""

    name: str
    """One of `TENSOR_UNITS`."""
    members: int
    """Of the links, how many fit it."""
    known: int
    """How many links draw something that was measured."""

    @property
    def evidence(self) -> str:
        """What shows it, for a sentence."""
        return f"in {self.name}, {self.members} of {self.known} tensors of the file fit what their links draw"

    @property
    def remedy(self) -> str:
        """What to do, for a sentence."""
        return f"divide every tensor of the file by {1.0 / TENSOR_UNITS[self.name]:,.0f}"


@fact
def find_tensor_unit(model: Model) -> TensorUnit | None:
    """Find the unit in which most tensors of a file are those of what their links draw; None where there is none, or a link fits
    kg·m². A part that no material makes so light shows none: its mass is the wrong number, and some unit fits any mass."""
    measured = [one for one in measure_tensors(model) if not _is_air(model, one)]
    different = {one.key: one for one in measured}.values()
    if any(_fits(one, 1.0) for one in different):
        return None
    for name, factor in TENSOR_UNITS.items():
        members = sum(_fits(one, factor) for one in different)
        if members >= max(_FEWEST, _SHARE * len(different)):
            return TensorUnit(name, sum(_fits(one, factor) for one in measured), len(measured))
    return None


def is_unit_possible(model: Model, factor: float) -> bool:
    """Whether no link of a file speaks against a unit of ``factor`` kg·m²: none fits kg·m², or some other unit."""
    others = (1.0, *(value for value in TENSOR_UNITS.values() if value != factor))
    return not any(_fits(one, other) for one in measure_tensors(model) for other in others)


def _is_air(model: Model, one: MeasuredTensor) -> bool:
    drawn = measure_link_geometry(model, one.link)
    return drawn is not None and one.mass < LIGHTEST * drawn.solid.volume


def _fits(one: MeasuredTensor, factor: float) -> bool:
    ratios = factor * one.ratios
    return bool(ratios.min() > 1.0 / _NEAR and ratios.max() < _NEAR)
