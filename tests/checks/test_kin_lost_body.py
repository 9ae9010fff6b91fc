"""KIN011: the links of which MuJoCo and Isaac Sim make no body."""

from __future__ import annotations

from pathlib import Path

import pytest
from builders import box, find, inertial, joint, link, robot, visual

BODY = link("base_link", inertial()), joint("base_joint", "root", "base_link")
MAST = link("mast", visual(box("0.1 0.1 1"))), joint("mast_joint", "root", "mast")


def list_messages(folder: Path, *parts: str, target: str = "isaac") -> list[str]:
    return [f.message_id for f in find(folder, robot(*parts), "KIN011", targets=(target,))]


def test_an_empty_root_with_two_bodies_is_taken_apart_unless_it_is_the_ground(tmp_path: Path) -> None:
    assert list_messages(tmp_path, link("root"), *BODY) == ["root"]
    assert list_messages(tmp_path, link("root"), *BODY, *MAST) == ["apart"]
    grounded = [part.replace('"root"', '"world"') for part in (link("root"), *BODY, *MAST)]
    assert list_messages(tmp_path, *grounded) == ["root"]
    assert list_messages(tmp_path, link("root", inertial()), *BODY, *MAST) == []
    assert list_messages(tmp_path, link("root"), *BODY, *MAST, target="mujoco") == []


def test_a_free_base_begins_at_a_fixed_joint(tmp_path: Path) -> None:
    wheel = joint("axle", "root", "wheel", kind="continuous", axis="0 1 0"), link("wheel", inertial())
    texts = [
        f.message
        for parts in (
            (*wheel, *BODY),
            (*wheel, *(part.replace("wheel", "other").replace("axle", "b") for part in wheel)),
        )
        for f in find(tmp_path, robot(link("root"), *parts), "KIN011", targets=("isaac",))
    ]
    assert "Only base_link gets a free base" in texts[0]
    assert "None of them gets a free base" in texts[1]


def test_empty_links_between_the_root_and_the_bodies(tmp_path: Path) -> None:
    between = link("frame"), joint("frame_joint", "root", "frame")
    moved = [part.replace('parent link="root"', 'parent link="frame"') for part in MAST]
    assert list_messages(tmp_path, link("root"), *between, *BODY, *moved) == ["apart"]
    assert list_messages(tmp_path, link("root"), *between, *BODY) == ["root"]


def test_mujoco_merges_links_with_a_mass_too_and_isaac_only_empty_ones(tmp_path: Path) -> None:
    camera = joint("camera_joint", "base_link", "camera_link")
    for inside, isaac in (("", ["isaac"]), (inertial(0.1, 0.001), [])):
        parts = link("base_link", inertial()), camera, link("camera_link", inside)
        assert list_messages(tmp_path, *parts) == isaac
        assert list_messages(tmp_path, *parts, target="mujoco") == ["mujoco"]
    kept = '<mujoco><compiler fusestatic="false"/></mujoco>'
    parts = link("base_link", inertial()), camera, link("camera_link")
    assert list_messages(tmp_path, kept, *parts, target="mujoco") == []


def test_mujoco_does_what_the_page_says(tmp_path: Path) -> None:
    mujoco = pytest.importorskip("mujoco")
    swing = joint("swing", "base_link", "arm", kind="continuous", axis="0 0 1")
    mount = joint("mount", "arm", "camera_link")
    text = robot(link("base_link", inertial()), swing, link("arm", inertial()), mount, link("camera_link"))
    names = {body: mujoco.MjModel.from_xml_string(text).body(body).name for body in range(2)}
    assert "camera_link" not in names.values()
    kept = text.replace("<link", '<mujoco><compiler fusestatic="false"/></mujoco><link', 1)
    model = mujoco.MjModel.from_xml_string(kept)
    assert "camera_link" in {model.body(i).name for i in range(model.nbody)}
