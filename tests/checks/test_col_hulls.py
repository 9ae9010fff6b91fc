"""COL006: what MuJoCo finds in collision at rest, compared with MuJoCo itself where it is installed."""

from __future__ import annotations

import itertools
from pathlib import Path

import pytest
from builders import inertial, joint, limit, robot
from conftest import check_text

from urdfcheck.core import Finding

SOLID = inertial(1, 1e-2)


def make_box(x: float, z: float = 0.0) -> str:
    """A box of 0.1 m at this place."""
    return f'<collision><origin xyz="{x} 0 {z}"/><geometry><box size="0.1 0.1 0.1"/></geometry></collision>'


def make_chain(*shapes: str, kind: str = "revolute", root: str = "base") -> str:
    """Links one after the other, 0.08 m apart."""
    names = [root, *(f"link_{k}" for k in range(1, len(shapes)))]
    links = [f'<link name="{name}">{SOLID}{shape}</link>' for name, shape in zip(names, shapes, strict=True)]
    joints = [
        joint(f"j_{child}", parent, child, limit(-1, 1, 1, 1), kind=kind, xyz="0.08 0 0")
        for parent, child in itertools.pairwise(names)
    ]
    return robot(*links, *joints)


def find(folder: Path, model: str, *targets: str) -> list[Finding]:
    run = check_text(folder, model, codes={"COL006"}, targets=targets)
    assert not run.failures, run.failures
    return list(run.active_findings)


def ask_mujoco(model: str) -> set[frozenset[str]]:
    """The pairs of bodies that MuJoCo finds in contact at rest; the root is world."""
    mujoco = pytest.importorskip("mujoco")
    loaded = mujoco.MjModel.from_xml_string(model)
    data = mujoco.MjData(loaded)
    mujoco.mj_forward(loaded, data)
    deep = [pair for pair, distance in zip(data.contact.geom, data.contact.dist, strict=True) if distance < -1e-4]
    return {frozenset(loaded.body(int(loaded.geom_bodyid[geom])).name for geom in pair) for pair in deep}


def test_the_root_and_its_neighbour_are_compared_and_other_neighbours_are_not(tmp_path: Path) -> None:
    model = make_chain(make_box(0), make_box(0), make_box(0))
    (finding,) = find(tmp_path, model, "mujoco")
    assert (finding.message_id, finding.severity.name) == ("root", "WARNING")
    assert finding.message.endswith("at rest: base and link_1 by 20 mm")
    assert ask_mujoco(model) == {frozenset({"world", "link_1"})}


def test_what_ends_before_the_joint_is_not_reported(tmp_path: Path) -> None:
    model = make_chain(make_box(-0.03), make_box(0), make_box(0))
    assert not find(tmp_path, model, "mujoco")
    assert not ask_mujoco(model)


def test_what_is_fixed_to_the_root_is_part_of_the_world(tmp_path: Path) -> None:
    model = make_chain("", make_box(0), make_box(0)).replace('"revolute"', '"fixed"', 1)
    (finding,) = find(tmp_path, model, "mujoco")
    assert "link_1 and link_2 by 20 mm" in finding.message
    assert ask_mujoco(model) == {frozenset({"world", "link_2"})}


def test_a_robot_on_wheels_gets_a_free_joint(tmp_path: Path) -> None:
    model = make_chain(make_box(0), make_box(0)).replace("link_1", "wheel")
    (finding,) = find(tmp_path, model, "mujoco")
    assert (finding.message_id, finding.severity.name) == ("root", "INFO")


def test_links_that_overlap_as_typed_are_for_another_rule(tmp_path: Path) -> None:
    model = make_chain("", make_box(0), make_box(0), make_box(-0.08))
    assert not find(tmp_path, model, "mujoco")
    assert frozenset({"link_1", "link_3"}) in ask_mujoco(model)


@pytest.mark.parametrize("targets", [(), ("rviz", "drake")])
def test_only_for_mujoco(targets: tuple[str, ...], tmp_path: Path) -> None:
    assert not find(tmp_path, make_chain(make_box(0), make_box(0)), *targets)
