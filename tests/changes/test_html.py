"""``urdfcheck diff -o html=FILE``: one page with the claim, both versions of the robot, the changes and their causes."""

from __future__ import annotations

import base64
import hashlib
import json
import re
import zlib
from pathlib import Path
from typing import Any

import pytest
from output.documents import Document, read
from versions import ARM, compare

from urdfcheck.core.model_diff import Diff
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
