"""The units of the numbers of URDF."""

from __future__ import annotations

import pytest

from urdfcheck.export.index.units import find_unit


@pytest.mark.parametrize(
    ("subject", "joint_type", "unit"),
    [
        ("link[arm]/inertial/mass@value", "", "kg"),
        ("link[a/b]/inertial/inertia@ixy", "", "kg·m²"),
        ("link[arm]/visual[2]/origin@rpy", "", "rad"),
        ("joint[j]/origin@xyz", "fixed", "m"),
        ("joint[j]/limit@upper", "revolute", "rad"),
        ("joint[j]/limit@upper", "prismatic", "m"),
        ("joint[j]/limit@upper", "floating", ""),
        ("joint[j]/limit@effort", "continuous", "N·m"),
        ("joint[j]/dynamics@damping", "prismatic", "N·s/m"),
        ("link[arm]@name", "", ""),
        ("property[arm_mass]", "", ""),
    ],
)
def test_a_number_has_the_unit_that_urdf_gives_it(subject: str, joint_type: str, unit: str) -> None:
    assert find_unit(subject, joint_type) == unit
