"""``urdfcheck diff -o html=FILE``: one page with the claim, both versions of the robot, the changes and their causes."""

from __future__ import annotations

import base64
import hashlib
import json
import re
import zlib
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from changes.test_seams import FILES, compare_packages, write_package
from output.documents import Document, read
from versions import ARM, compare

from urdfcheck.changes.effect_wording import describe_effect
from urdfcheck.core.model_diff import Diff, MechanismEffect
from urdfcheck.output.changes import html, render_picture

LONGER = ARM.replace('<origin xyz="0.3 0 0" rpy="0 0 0"/>', '<origin xyz="0.341 0 0" rpy="0 0 0"/>')
# The camera and its joint.
BARE = (
    ARM[: ARM.index('\n  <link name="camera">')]
    + ARM[ARM.index('\n  <link name="hand">') : ARM.index('\n  <joint name="camera_mount"')]
    + ARM[ARM.index('\n  <joint name="wrist"') :]
)


def compare_texts(folder: Path, before: str, after: str) -> Diff:
    for side, text in (("old", before), ("new", after)):
        (folder / side).mkdir()
        (folder / side / "arm.urdf").write_text(text, encoding="utf-8")
    return compare(folder / "old/arm.urdf", folder / "new/arm.urdf", scene=True)


def read_page(diff: Diff) -> Document:
    """The page, checked for what must hold of every page."""
    found = read(html.render(diff))
    assert len(found.ids) == len(set(found.ids)), "ids repeat"
    links = [a["href"] for _, a in found.tags if "href" in a]
    assert [h for h in links if not h.startswith("#") or h[1:] not in {*found.ids, "g-info"}] == []
    assert [t for t, _ in found.tags if t in {"iframe", "link", "object", "form", "base"}] == []
    assert [(t, n) for t, a in found.tags for n in a if n in {"style", "srcset", "action"} or n.startswith("on")] == []
    assert all(image["src"].startswith("data:image/png;base64,") for image in found.all("img"))
    return found


def read_data(found: Document) -> dict[str, Any]:
    """What the page hands over to its 3D view."""
    data = next(t for t, a in zip(found.scripts, found.all("script"), strict=True) if a.get("id") == "uc-data")
    values: dict[str, Any] = json.loads(data)
    return values


def test_the_claim_is_first_and_each_change_leads_to_its_lines(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    text = html.render(compare_texts(tmp_path, ARM, LONGER.replace('ixx="0.0006"', 'ixx="0.006"')))
    found = read(text)
    assert "tool0 moves by 41 mm in every configuration" in found.text.split("What changes")[0]
    assert "findings: 1 new, 0 gone, 0 unchanged" in found.text
    assert "joint wrist moves by 41 mm (x +41 mm) in link fore" in found.text
    number = ARM.splitlines().index('    <origin xyz="0.3 0 0" rpy="0 0 0"/>') + 1
    # Only the number that differs is marked, in both versions, with lines around it.
    for side, value in (("old", "0.3"), ("new", "0.341")):
        figures = (figure.split("</figure>")[0] for figure in text.split("<figure")[1:])
        figure = next(figure for figure in figures if f'title="{side}/arm.urdf:{number}"' in figure)
        assert [read(mark).text for mark in re.findall("<mark>.*?</mark>", figure)] == [value]
        assert figure.count('class="l') == 5
    assert [card["data-code"] for card in found.classes("card")] == ["INR003"]


def test_rows_of_the_page_are_what_the_view_can_show(tmp_path: Path) -> None:
    """A removed link is one of the first version only, and a link that moves is shown where that is worst."""
    turned = BARE.replace('xyz="0 0 0.4" rpy="0 0 0.2"', 'xyz="0 0 0.45" rpy="0 0.1 0.2"')
    found = read_page(compare_texts(tmp_path, ARM, turned))
    (model,) = read_data(found)["models"]
    entries = {entry["id"]: entry for entry in model["findings"]}
    rows = {row["id"] for row in found.classes("entry")}
    assert rows == set(entries)
    gone = next(entry for entry in entries.values() if entry["before"] == ["camera"])
    assert gone["links"] == [""]
    worst = entries["m1-s0"]
    assert worst["before"] == ["tool0"]
    assert worst["links"] == ["tool0"]
    assert set(worst["pose"]) <= {joint["name"] for joint in model["joints"]}
    assert {link["name"] for link in model["before"]["links"]} - {link["name"] for link in model["links"]} == {"camera"}
    # Both versions share the meshes and stand in one list.
    assert model["before"]["findings"] == []


def test_a_collision_leads_to_the_pair_where_it_is_deepest(tmp_path: Path) -> None:
    """The fingers overlap now where the hand is closed; the way back, they no longer do, which only the first version shows."""
    wide = ARM.replace('lower="-0.03" upper="0.01"', 'lower="-0.036" upper="0.01"')
    for name, texts, is_gone in (("there", (ARM, wide), False), ("back", (wide, ARM), True)):
        (tmp_path / name).mkdir()
        found = read_page(compare_texts(tmp_path / name, *texts))
        (model,) = read_data(found)["models"]
        (entry,) = [entry for entry in model["findings"] if entry["code"] == "collision"]
        assert sorted(entry["links"]) == sorted(entry["before"]) == ["left", "right"]
        assert entry["pose"] == pytest.approx({"grip": -0.036, "grip_mirror": 0.036})
        assert (entry["layers"], entry["inside"], entry.get("gone", False)) == (["collision"], True, is_gone)
        assert entry["id"] in {row["id"] for row in found.classes("entry")}
        verb = "no longer collide (before in" if is_gone else "collide now (in"
        assert f"link left and link right {verb}" in found.text


def test_an_inertia_and_a_stance_are_rows_too(tmp_path: Path) -> None:
    heavier = compare_texts(tmp_path, ARM, ARM.replace('ixx="0.0006"', 'ixx="0.0012"'))
    (model,) = heavier.models
    assert model.mechanism is not None
    fall = MechanismEffect(
        kind="stability", id="falls", subject="link[base]", numbers={"margin_before": 0.1, "margin_after": -0.02}
    )
    fallen = replace(model.mechanism, effects=(*model.mechanism.effects, fall))
    texts = (*model.effects, describe_effect(fall))
    found = read_page(replace(heavier, models=(replace(model, mechanism=fallen, effects=texts),)))
    (drawn,) = read_data(found)["models"]
    entries = {entry["id"]: entry for entry in drawn["findings"]}
    assert {row["id"] for row in found.classes("entry")} == set(entries)
    assert (entries["m1-e0"]["code"], entries["m1-e0"]["joints"]) == ("inertia", ["wrist"])
    stance = entries[f"m1-e{len(texts) - 1}"]
    assert (stance["links"], stance["layers"]) == ([], ["ground", "com"])
    assert "joint wrist accelerates" in found.text
    assert "the robot falls over now: its COM is 20 mm outside its supports" in found.text


def test_what_changes_around_the_robot_has_its_places_in_both_versions(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    state, default = ('value="0.5"', 'value="0.7"'), ('default="true"', 'default="false"')
    old = write_package(Path("old"))
    new = write_package(
        Path("new"),
        **{
            "config/arm.srdf": "\n" + FILES["config/arm.srdf"].replace(*state),
            "launch/arm.launch": FILES["launch/arm.launch"].replace(*default),
        },
    )
    found = read_page(compare_packages(old, new, scene=True))
    around = found.text.split("Around the robot")[-1]
    assert "joint elbow in state home of group arm changes: 0.5 → 0.7arm.srdf:7 → arm.srdf:8" in around
    assert "argument gui changes: default 'true' → default 'false'" in around
    assert [a["title"] for t, a in found.tags if t == "code" and "srdf" in a.get("title", "")] == [
        "old/config/arm.srdf:7:5",
        "new/config/arm.srdf:8:5",
    ]
    assert {"href": "#around"} in found.all("a")
    assert "2 changes around the robot" in found.text


def test_edits_that_make_no_part_of_the_robot_are_listed(tmp_path: Path) -> None:
    choice = """<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:if value="0">
    <link name="lamp"/>
  </xacro:if>"""
    before = ARM.replace('<robot name="arm">', choice)
    for side, text in (("old", before), ("new", before.replace('"lamp"', '"light"'))):
        (tmp_path / side).mkdir()
        (tmp_path / side / "arm.urdf.xacro").write_text(text, encoding="utf-8")
    found = read_page(compare(tmp_path / "old", tmp_path / "new", scene=True))
    assert "Edited lines that make no part of this robot 2arm.urdf.xacro:3 " in found.text
    assert '<link name="light"/>' in found.text
    assert {"href": "#m1-idle"} in found.all("a")


def test_a_renamed_part_keeps_its_place_in_the_view(tmp_path: Path) -> None:
    renamed = LONGER.replace('"hand"', '"palm"').replace('"wrist"', '"roll"')
    (model,) = read_data(read_page(compare_texts(tmp_path, ARM, renamed)))["models"]
    assert model["renamed"] == {"links": {"palm": "hand"}, "joints": {"roll": "wrist"}}
    moved = next(entry for entry in model["findings"] if entry["code"] == "motion")
    assert (moved["before"], moved["links"], moved["joints"]) == (["hand"], ["palm"], ["roll"])


def test_versions_with_other_roots_lie_where_they_were_compared(tmp_path: Path) -> None:
    """A new root half a metre below is no motion of everything."""
    raised = ARM.replace(
        "</robot>",
        '<link name="floor"/><joint name="stand" type="fixed"><parent link="floor"/><child link="base"/>'
        '<origin xyz="0 0 0.5"/></joint></robot>',
    )
    (model,) = read_data(read_page(compare_texts(tmp_path, ARM, raised)))["models"]
    assert model["beforeAt"] == [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0.5, 0, 0, 0, 1]


def test_equal_robots_and_lone_ones_have_a_page_too(tmp_path: Path) -> None:
    found = read_page(compare_texts(tmp_path, ARM, ARM))
    assert "Both versions are equal." in found.text
    for side, name in (("old", "one"), ("new", "two")):
        (tmp_path / side / f"{name}.urdf").write_text(f'<robot name="{name}"><link name="{name}"/></robot>')
    several = read_page(compare(tmp_path / "old", tmp_path / "new", scene=True))
    assert "the model is gone" in several.text
    assert "the model is new" in several.text
    assert "1 robot is identical" in several.text
    (tmp_path / "new/arm.urdf").write_text("<robot")
    lost = read_page(compare(tmp_path / "old", tmp_path / "new", scene=True))
    assert "cannot be compared" in lost.text
    assert [model.get("before") for model in read_data(lost)["models"]] == [None, None, None]


def test_the_policy_allows_its_own_style_and_scripts_only(tmp_path: Path) -> None:
    def hash_text(text: str) -> str:
        return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"

    found = read_page(compare_texts(tmp_path, ARM, LONGER))
    policy = next(a["content"] for a in found.all("meta") if a.get("http-equiv") == "Content-Security-Policy")
    by_id = {a.get("id", ""): t for t, a in zip(found.scripts, found.all("script"), strict=True)}
    app = zlib.decompress(base64.b64decode(by_id["uc-app"]), -zlib.MAX_WBITS).decode()
    bootstrap, own = (t for t, a in zip(found.scripts, found.all("script"), strict=True) if not a)
    scripts = " ".join(map(hash_text, (bootstrap, app, own)))
    assert policy == (
        f"default-src 'none'; style-src {hash_text(found.style)}; script-src {scripts}; img-src data:; "
        "base-uri 'none'; form-action 'none'"
    )


def test_names_and_texts_of_strangers_add_no_markup(tmp_path: Path) -> None:
    name = "</script><img src=x onerror=alert(1)>\u202e##[error]x"
    hostile = ARM.replace('"wrist"', f'"{name.replace("<", "&lt;")}"').replace(
        '<origin xyz="0.3 0 0" rpy="0 0 0"/>', '<origin xyz="0.3 0 0" rpy="0 0 0"/><!-- </pre><script> -->'
    )
    diff = compare_texts(tmp_path, hostile, hostile.replace('xyz="0.3 0 0"', 'xyz="0.4 0 0"'))
    text = html.render(diff)
    found = read_page(diff)
    assert [image for image in found.all("img") if "alt" not in image] == []
    assert len(found.all("script")) == 5
    assert "\u202e" not in text
    assert "##[error]" not in text
    assert any(joint["name"] == name for joint in read_data(found)["models"][0]["joints"])


def test_a_comparison_that_nobody_draws_holds_no_scenes(tmp_path: Path) -> None:
    for side in ("old", "new"):
        (tmp_path / side).mkdir()
        (tmp_path / side / "arm.urdf").write_text(ARM)
    diff = compare(tmp_path / "old/arm.urdf", tmp_path / "new/arm.urdf")
    assert diff.runs is None
    assert render_picture(diff) == b""
