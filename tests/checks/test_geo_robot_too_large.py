"""GEO006: lengths that are not in metres."""

from __future__ import annotations

from pathlib import Path

import pytest
from builders import inertial, joint, limit, link, robot
from conftest import check_text

from urdfcheck.core import Finding


def find(folder: Path, *origins: str, kind: str = "revolute", **request: object) -> list[Finding]:
    """Check a chain of links, of which the first origin is that of a joint of ``kind``."""
    names = ["base", *(f"link_{i}" for i in range(len(origins)))]
    joints = [
        joint(f"joint_{i}", parent, child, limit(-1, 1), kind="revolute" if i else kind, xyz=xyz)
        for i, (parent, child, xyz) in enumerate(zip(names, names[1:], origins, strict=False))
    ]
    text = robot(*(link(name, inertial(1, 0.1)) for name in names), *joints, name="chain")
    return list(check_text(folder, text, codes={"GEO006"}, **request).findings)


@pytest.mark.parametrize(("factor", "found"), [(1.0, False), (1000.0, True), (1 / 0.0254, True)])
def test_an_arm_that_is_not_in_metres_is_found(tmp_path: Path, factor: float, found: bool) -> None:
    origins = [f"0 0 {factor * 0.3}", f"{factor * 0.5} 0 0", f"{factor * 0.4} 0 0"]
    findings = find(tmp_path, *origins)
    assert [finding.message_id for finding in findings] == ["far"] * found
    if found:
        assert findings[0].location.subject == "joint[joint_1]/origin@xyz"
        size = {1000.0: "0.95 m in millimetres", 1 / 0.0254: "0.95 m in inches"}[factor]
        assert size in findings[0].message


def test_one_origin_in_millimetres_is_that_origins_mistake(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, "0 0 0.3", "500 0 0", "0.4 0 0")
    assert (finding.message_id, finding.location.subject) == ("one", "joint[joint_1]/origin@xyz")
    assert not finding.data["explains"]


def test_a_robot_far_from_the_origin_of_its_world_is_no_larger(tmp_path: Path) -> None:
    assert not find(tmp_path, "5000 300 0", "0.3 0 0", kind="fixed")
    assert not find(tmp_path, "5000 300 0", "0.3 0 0", kind="floating")


def test_a_crane_has_its_own_size(tmp_path: Path) -> None:
    assert find(tmp_path, "0 0 20", "40 0 0")
    assert not find(tmp_path, "0 0 20", "40 0 0", options={"GEO006": {"largest": 100.0}})
