"""``urdfcheck diff --format markdown``: the comment on a pull request."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from conftest import command
from versions import ARM, compare

from urdfcheck.cli import OK
from urdfcheck.core.model_diff import Diff, SeamChange
from urdfcheck.output.changes import html, markdown
from urdfcheck.output.changes.text import render as render_text

LONGER = ARM.replace('<origin xyz="0.3 0 0" rpy="0 0 0"/>', '<origin xyz="0.341 0 0" rpy="0 0 0"/>')


def compare_texts(folder: Path, before: str, after: str) -> Diff:
    for side, text in (("old", before), ("new", after)):
        (folder / side).mkdir(parents=True)
        (folder / side / "arm.urdf").write_text(text, encoding="utf-8")
    return compare(folder / "old/arm.urdf", folder / "new/arm.urdf")


def list_unfolded(text: str) -> list[str]:
    """The lines outside of folds."""
    lines, depth = [], 0
    for line in text.splitlines():
        depth += line == "<details>"
        lines += [] if depth else [line]
        depth -= line == "</details>"
    assert depth == 0
    return lines


def test_the_verdict_and_the_table_are_seen_and_the_rest_is_folded(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    worse = LONGER.replace('ixx="0.0006"', 'ixx="0.006"')
    text = markdown.render(compare_texts(tmp_path, ARM, worse))
    lines = list_unfolded(text)
    assert lines[0] == markdown.MARKER
    assert lines[1] == "### 🔀 `arm.urdf`: tool0 moves by 41 mm in every configuration"
    assert lines[3] == "`old/arm.urdf` → `new/arm.urdf` · findings: 1 new, 0 gone, 0 unchanged"
    assert "|  | motion | joint wrist moves by 41 mm (x +41 mm) in link fore |" in lines
    assert not any("<origin" in line for line in lines)
    number = ARM.splitlines().index('    <origin xyz="0.3 0 0" rpy="0 0 0"/>') + 1
    assert f'- old/arm.urdf:{number}  <origin xyz="0.3 0 0" rpy="0 0 0"/>\n' in text
    assert f'+ new/arm.urdf:{number}  <origin xyz="0.341 0 0" rpy="0 0 0"/>\n' in text
    assert "INR003" in text.replace("\n".join(lines), "")


@pytest.mark.parametrize("render", [markdown.render, render_text, html.render])
def test_links_whose_collisions_are_unknown_are_named(tmp_path: Path, render: Callable[[Diff], str]) -> None:
    diff = compare_texts(tmp_path, ARM, LONGER)
    (model,) = diff.models
    assert model.mechanism is not None
    assert model.mechanism.collisions is not None
    collisions = replace(model.mechanism.collisions, unread=("left", "right", "hand"))
    unread = replace(model, mechanism=replace(model.mechanism, collisions=collisions))
    assert "of which a shape could not be measured" not in render(diff)
    shown = "not compared: link left, link right and 1 more, of which a shape could not be measured"
    assert shown in render(replace(diff, models=(unread,)))


def test_what_no_one_wants_is_in_the_second_line_once(tmp_path: Path) -> None:
    """Of models that change alike, it is counted once."""
    diff = compare_texts(tmp_path, ARM, ARM.replace('lower="-0.03" upper="0.01"', 'lower="-0.036" upper="0.01"'))
    (model,) = diff.models
    stale = SeamChange(kind="srdf", id="old-name", subject="group arm", text="group arm: link a is called b now")
    text = markdown.render(replace(diff, models=(model, model), seams=(stale, stale)))
    assert text.splitlines()[3].endswith(
        " · **1 pair of links collides now** · **2 statements use old names** · findings: 0 new, 0 gone, 0 unchanged"
    )
    (back,) = compare_texts(tmp_path / "back", ARM, LONGER).models
    assert back.effects
    assert "**" not in markdown.render(replace(diff, models=(back,))).splitlines()[3]


def test_an_equal_robot_is_two_lines(tmp_path: Path) -> None:
    lines = markdown.render(compare_texts(tmp_path, ARM, ARM)).splitlines()
    assert lines[1].startswith("### ✅ `arm.urdf`: ")
    assert [line for line in lines[2:] if line] == [lines[3]]


def test_one_cause_of_several_models_is_listed_once(tmp_path: Path) -> None:
    for side, reach in (("old", "0.3"), ("new", "0.4")):
        folder = tmp_path / side
        folder.mkdir()
        (folder / "part.xacro").write_text(
            '<robot xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:macro name="arm"><link name="a"/><link name="b"/>\n'
            '<joint name="j" type="fixed"><parent link="a"/><child link="b"/>\n'
            f'<origin xyz="{reach} 0 0"/>\n</joint></xacro:macro></robot>'
        )
        for name in ("one", "two"):
            (folder / f"{name}.urdf.xacro").write_text(
                f'<robot name="{name}" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:include filename="part.xacro"/>'
                "<xacro:arm/></robot>"
            )
    text = markdown.render(compare(tmp_path / "old", tmp_path / "new"))
    assert text.splitlines()[1] == "### 🔀 2 robots change, of 2"
    assert text.count('<origin xyz="0.3 0 0"/>') == 1
    assert text.count("**kinematic**") == 1
    assert "one.urdf.xacro, " in text  # and the other one, which changes alike
    assert "2 changes by" in text
    lines = render_text(compare(tmp_path / "old", tmp_path / "new")).splitlines()
    assert [line.partition(": ")[2] for line in lines if "moves by" in line and line[0] != " "] == [
        "b moves by 100 mm in every configuration"
    ]
    (tmp_path / "new/two.urdf.xacro").write_text("<robot")
    lost = markdown.render(compare(tmp_path / "old", tmp_path / "new")).splitlines()[1]
    assert lost == "### ❓ 1 robot changes, of 2; 1 cannot be compared"


def test_names_of_strangers_add_no_markup(tmp_path: Path) -> None:
    name = "@team|<img/src=x>`![a](b)--&gt;##[error]x"
    hostile = ARM.replace('"wrist"', f'"{name.replace("<", "&lt;")}"').replace(
        '<origin xyz="0.3 0 0" rpy="0 0 0"/>', '<origin xyz="0.3 0 0" rpy="0 0 0"/><!-- ``` </details> -->'
    )
    moved = hostile.replace('xyz="0.3 0 0"', 'xyz="0.4 0 0"')
    text = markdown.render(compare_texts(tmp_path, hostile, moved))
    rows = [line for line in list_unfolded(text) if line.startswith("|")]
    assert len(rows) >= 3
    for row in rows:
        bare = "".join(row.replace("\\|", "").split("`")[::2]) if row.count("`") % 2 == 0 else row
        assert "<img" not in bare
        assert "![a]" not in bare
    assert "##[error]" not in text
    inside = text.split("````diff", 1)  # the fence is longer than that in the line
    assert len(inside) == 2


def test_a_comment_has_a_limit(tmp_path: Path) -> None:
    def build(offset: float) -> str:
        joints = "".join(
            f'<link name="l{n}_{"x" * 60}"/><joint name="j{n}_{"y" * 60}" type="fixed"><parent link="base"/>'
            f'<child link="l{n}_{"x" * 60}"/>\n<origin xyz="{n + offset * (n + 1)} 0 0"/></joint>\n'
            for n in range(400)
        )
        return f'<robot name="r"><link name="base"/>{joints}</robot>'

    text = markdown.render(compare_texts(tmp_path, build(0.0), build(0.1)))
    assert len(text.encode()) <= 65_536
    assert "Left out to keep this short" in text
    list_unfolded(text)


@pytest.mark.usefixtures("one_process")
def test_the_command_prints_it(tmp_path: Path) -> None:
    (tmp_path / "a.urdf").write_text(ARM)
    (tmp_path / "b.urdf").write_text(LONGER)
    quick = ("--tier", "source", "--select", "INR003", "--no-cache")
    done = command("diff", "a.urdf", "b.urdf", "--format", "markdown", *quick, cwd=tmp_path)
    assert (done.returncode, done.stderr) == (OK, "")
    assert done.stdout.startswith(f"{markdown.MARKER}\n### 🔀 ")
