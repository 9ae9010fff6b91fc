"""INR004: a moment of zero beside good numbers is what is wrong, and a link with these numbers has it."""

from __future__ import annotations

from pathlib import Path

import pytest
from builders import box, find, inertial, joint, link, robot, visual

GOOD = {"ixx": 0.0025267, "ixy": 4.26e-06, "ixz": 2.46e-06, "iyy": 0.0027086, "iyz": 3.6e-06, "izz": 0.0028737}
WRONG = {**GOOD, "iyy": 0.0}


@pytest.mark.parametrize(
    ("others", "mass", "advice"),
    [
        ([GOOD], 1.2, 'write iyy="0.0027086" as in a0; better, as the masses differ, compute'),
        ([GOOD], 0.2, 'write iyy="0.0027086" as in a0, or compute'),
        ([GOOD, {**GOOD, "iyy": 0.002}], 1.2, ""),
        ([{**GOOD, "izz": 0.0029}], 1.2, ""),
    ],
)
def test_the_moment_of_zero_is_named(tmp_path: Path, others: list[dict[str, float]], mass: float, advice: str) -> None:
    parts = [link("base"), link("low", inertial(0.2, **WRONG), visual(box("0.1 0.2 0.1")))]
    parts.append(joint("j", "base", "low", kind="continuous"))
    for index, numbers in enumerate(others):
        parts += [
            link(f"a{index}", inertial(mass, **numbers)),
            joint(f"j{index}", "base", f"a{index}", kind="continuous"),
        ]
    (finding,) = find(tmp_path, robot(*parts), {"INR004"})
    assert finding.headline == "low: iyy = 0 is impossible with ixy = 4.26e-06"
    assert finding.location.subject.endswith("/inertia@iyy")
    assert finding.fix is not None
    assert finding.fix.title.startswith(advice)
    assert ("as in a" in finding.fix.title) == bool(advice)
    assert not finding.fix.edits or not advice


def test_a_product_beside_good_moments_is_what_is_wrong(tmp_path: Path) -> None:
    numbers = inertial(1, **{**GOOD, "ixy": 0.004})
    (finding,) = find(
        tmp_path, robot(link("base"), link("low", numbers), joint("j", "base", "low", kind="continuous")), "INR004"
    )
    assert finding.headline.startswith("low: ixy = 0.004 is impossible (limit ")
