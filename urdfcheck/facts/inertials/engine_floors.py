"""The values below which an engine takes an inertia for none."""

from __future__ import annotations

from collections.abc import Sequence

from urdfcheck.facts.small_matrices import compute_moments, make_tensor

# kg m². MuJoCo refuses a link's tensor with a smaller eigenvalue (mjEPS), unless all six numbers are zero; it checks each link
# before it merges those that fixed joints connect, the root too. Measured with MuJoCo 4.0.
MUJOCO_LEAST_MOMENT = 1e-14
# What it then does, as pages say it.
MUJOCO_REFUSAL = "refuses to compile: inertia must have positive eigenvalues"
# What sdformat does with an impossible tensor of a link that fixed joints make part of a possible body.
GAZEBO_MERGES = "loads it (it merges links joined by fixed joints and checks the sum)"
# What it does with one of a link that is a body by itself.
GAZEBO_REFUSES = "refuses the model: the link has an invalid inertia (sdformat error 18)"


def is_refused_by_mujoco(components: Sequence[float]) -> bool:
    """Whether MuJoCo refuses a tensor (URDF's ``ixx ixy ixz iyy iyz izz`` in kg m²) for its smallest principal moment."""
    return any(components) and compute_moments(make_tensor(components))[0] < MUJOCO_LEAST_MOMENT
