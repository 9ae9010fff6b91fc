"""Boxes around primitives, which hold them as their corners do."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from urdfcheck.facts.small_matrices import UNMOVED
from urdfcheck.model import Model
from urdfcheck.model.motion.loose_parts import find_loose_part
from urdfcheck.model.shapes.corners import compute_shape_corners
from urdfcheck.model.shapes.primitive_boxes import compute_primitive_box, has_only_touching_primitives
from urdfcheck.source.load import load_source
from urdfcheck.source.package.finder import PackageFinder

ROD, BRICK = '<cylinder radius="0.02" length="0.3"/>', '<box size="0.15 0.2 0.3"/>'


def build_chain(folder: Path, shape: str, away: float = 0.0) -> Model:
    """A chain of eight links, the last of which is ``away`` (m) from the others."""
    drawn = f'<visual><origin xyz="0 0 0.15" rpy="0.3 0.2 0.1"/><geometry>{shape}</geometry></visual>'
    links = "".join(f'<link name="l{i}">{drawn}</link>' for i in range(8)) + '<link name="tip"/>'
    joints = "".join(
        f'<joint name="j{i}" type="continuous"><origin xyz="0 0 {0.25 + away * (i == 7)}" rpy="0.5 0 0.2"/>'
        f'<parent link="l{i - 1}"/><child link="l{i}"/></joint>'
        for i in range(1, 8)
    )
    tip = '<joint name="t" type="fixed"><origin xyz="0 0 9"/><parent link="l7"/><child link="tip"/></joint>'
    path = folder / "chain.urdf"
    path.write_text(f'<robot name="chain">{links}{joints}{tip}</robot>')
    source = load_source(path, {}, PackageFinder(path))
    assert source.root is not None
    return Model(source=source, robot=source.root)


@pytest.mark.parametrize(
    "shape", [ROD, '<box size="0.1 0.2 0.3"/>', '<sphere radius="0.1"/>', '<capsule radius="0.1" length="0.3"/>']
)
def test_a_box_is_that_of_the_corners(tmp_path: Path, shape: str) -> None:
    model = build_chain(tmp_path, shape)
    drawn = model.links[0].visuals[0]
    box, corners = compute_primitive_box(drawn, UNMOVED), compute_shape_corners(model, drawn)
    assert box is not None
    assert corners is not None
    # Corners of round shapes are around them.
    assert_allclose(box.low, corners.min(axis=0), rtol=0.02, atol=1e-3)
    assert_allclose(box.high, corners.max(axis=0), rtol=0.02, atol=1e-3)
    assert (np.array(box.low) >= corners.min(axis=0) - 1e-12).all()
    assert (np.array(box.high) <= corners.max(axis=0) + 1e-12).all()


def test_a_part_that_is_away_does_not_touch(tmp_path: Path) -> None:
    together, apart = build_chain(tmp_path, BRICK), build_chain(tmp_path, BRICK, away=2.0)
    assert has_only_touching_primitives(together)
    assert find_loose_part(together, 0.5) is None
    assert not has_only_touching_primitives(apart)
    assert find_loose_part(apart, 0.5) is not None


def test_a_mesh_has_no_box(tmp_path: Path) -> None:
    model = build_chain(tmp_path, '<mesh filename="rod.stl"/>')
    assert compute_primitive_box(model.links[0].visuals[0], UNMOVED) is None
    assert not has_only_touching_primitives(model)
