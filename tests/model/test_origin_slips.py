"""Joints whose origins differ in two signs, and what explains them."""

from __future__ import annotations

from pathlib import Path

import pytest
from builders import box, joint, limit, link, robot, visual

from urdfcheck.model import Model
from urdfcheck.model.likeness.origin_slips import iter_diagonal_twins
from urdfcheck.source.load import load_source
from urdfcheck.source.package.finder import PackageFinder


@pytest.mark.parametrize(
    ("left", "right", "is_slip"),
    [("1 0 0", "1 0 0", False), ("1 0 0", "0.5 0 0", False), ("1 0 0", "1 1 0", True), ("0 0 1", "0 0 1", True)],
)
def test_two_slides_pass_each_other_along_one_coordinate(tmp_path: Path, left: str, right: str, is_slip: bool) -> None:
    carriage = visual(box("0.07 0.015 0.013"))
    parts = [
        part
        for side, xyz, axis in (("left", "-0.01 0.02 0", left), ("right", "0.01 -0.02 0", right))
        for part in (
            joint(
                f"{side}_slide", "base", f"{side}_carriage", limit(-0.01, 0.01), kind="prismatic", xyz=xyz, axis=axis
            ),
            link(f"{side}_carriage", carriage),
        )
    ]
    path = tmp_path / "robot.urdf"
    path.write_text(robot(link("base", visual(box("0.1 0.05 0.1"))), *parts))
    source = load_source(path, {}, PackageFinder(path))
    assert source.root is not None
    assert bool(list(iter_diagonal_twins(Model(source=source, robot=source.root)))) is is_slip
