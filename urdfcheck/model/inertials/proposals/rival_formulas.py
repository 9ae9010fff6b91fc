"""Whether other formulas than the one that a diagnosis names give the numbers of an inertial."""

from __future__ import annotations

from urdfcheck.facts.inertials.formulas.simple_solids import name_simple_solids
from urdfcheck.model import DeclaredTensor, Model
from urdfcheck.model.inertials.inertia_diagnosis import DiagnosedInertial, inertial_diagnoses

# Causes that name a formula, and what the solid is called that it is for: a box around a part is one.
_OF_FORMULAS = frozenset({"wrong_formula", "bounding_box", "convex_hull"})
_BOXES = frozenset({"box", "cube"})
_OWN = {"a box": _BOXES, "a cylinder": frozenset({"cylinder"}), "a sphere": frozenset({"sphere"})}
# Products of inertia below this share of the largest moment are zero (chosen).
_NO_PRODUCT = 1e-6


def has_rival_formula(model: Model, tensor: DeclaredTensor, judged: DiagnosedInertial) -> bool:
    """Whether a tensor whose cause is a formula is also that of another simple solid of round size, or of another link that draws
    a part which it fits."""
    diagnosis = judged.diagnosis
    if diagnosis.cause not in _OF_FORMULAS:
        return False
    if any(_is_right_elsewhere(model, tensor, other) for other in model.tensors):
        return True
    own = next((kinds for name, kinds in _OWN.items() if diagnosis.detail.startswith(name)), frozenset[str]())
    if diagnosis.cause == "bounding_box":
        own = _BOXES
    return bool(_name_solids(tensor, judged.declared.mass) - own)


def has_round_solid(tensor: DeclaredTensor, mass: float) -> bool:
    """Whether a tensor is that of a box or a cylinder of this ``mass`` (kg) and of round size, to the digits typed: a
    formula made it."""
    return bool(_name_solids(tensor, mass) & {"box", "cylinder"})


def _name_solids(tensor: DeclaredTensor, mass: float) -> frozenset[str]:
    ixx, ixy, ixz, iyy, iyz, izz = tensor.components
    if max(map(abs, (ixy, ixz, iyz))) > _NO_PRODUCT * max(ixx, iyy, izz):
        return frozenset()
    return name_simple_solids(mass, (ixx, iyy, izz))


def _is_right_elsewhere(model: Model, tensor: DeclaredTensor, other: DeclaredTensor) -> bool:
    verdict = inertial_diagnoses(model).get(other.link.name)
    return other.components == tensor.components and verdict is not None and verdict.diagnosis.sound
