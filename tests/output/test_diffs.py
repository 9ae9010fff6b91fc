"""What a repair changes: whole lines, with the attributes that change where a line is too long."""

from __future__ import annotations

from dataclasses import replace

import pytest
from output.runs import a_run, finding

from urdfcheck.core import Applicability, Edit, Fix, Location, Run, Span
from urdfcheck.output import junit, markdown
from urdfcheck.output.shared.diffs import fit_change, iter_diff_lines, list_line_changes
from urdfcheck.output.text import DetailLevel, render

NAME = "a.urdf"
INERTIA = '      <inertia ixx="7.95654166667e-05" ixy="1.7199e-05" ixz="8.75875e-06" iyy="0.0001" iyz="0" izz="1"/>'


def make_edit(text: str, old: str, new: str, at: int = 0) -> Edit:
    """An edit of the occurrence of ``old`` from ``at`` on."""
    start = text.index(old, at)

    def locate(offset: int) -> tuple[int, int]:
        return text.count("\n", 0, offset) + 1, offset - (text.rfind("\n", 0, offset) + 1) + 1

    end = start + len(old)
    return Edit(Span(NAME, *locate(start), *locate(end), start, end), old, new)


def show(text: str, *edits: Edit, width: int = 200) -> list[tuple[int, str, str]]:
    """The number of each line that changes, before and after."""
    changes = list_line_changes({NAME: text}, edits)
    sides = [fit_change(change, width) for change in changes]
    return [
        (change.line, *("".join(piece for piece, _ in side) for side in both))  # type: ignore[misc]
        for change, both in zip(changes, sides, strict=True)
    ]


def test_edits_of_a_line_are_one_change() -> None:
    text = f"<robot>\n{INERTIA}\n</robot>\n"
    edits = (make_edit(text, "7.95654166667e-05", "2.8e-05"), make_edit(text, "1.7199e-05", "0"))
    old = INERTIA.strip()
    assert show(text, *edits) == [(2, old, old.replace("7.95654166667e-05", "2.8e-05").replace("1.7199e-05", "0"))]


def test_a_long_line_keeps_its_tag_and_what_changes() -> None:
    text = f"<robot>\n{INERTIA}\n</robot>\n"
    edits = (make_edit(text, "1.7199e-05", "0"), make_edit(text, "0.0001", "2"))
    ((_, old, new),) = show(text, *edits, width=72)
    assert old == '<inertia … ixy="1.7199e-05" … iyy="0.0001" … />'
    assert new == '<inertia … ixy="0" … iyy="2" … />'


@pytest.mark.parametrize(
    ("line", "value", "shown"),
    [
        ('<inertia ixx="0.1" ixy = "0.2"/>', "0.2", '<inertia … ixy = "0.2"/>'),
        ("<inertia ixx='0.1'/>", "0.1", "<inertia ixx='0.1'/>"),
        ('<origin rpy="0 1.57 2"/>', "1.57", '<origin rpy="0 1.57 2"/>'),
        ('<type x="1">ball</type>', "ball", "<type … ball … >"),
        ('iyy="1" izz="2"', "2", '… izz="2"'),
        ('iyy="1 2', "2", 'iyy="1 2'),
    ],
)
def test_a_change_is_a_whole_attribute(line: str, value: str, shown: str) -> None:
    edit = make_edit(line, value, "new")
    ((_, old, new),) = show(line, edit, width=5)
    assert old == shown
    assert new == shown.replace(value, "new")


def test_lines_that_go_and_come() -> None:
    text = "<a>\n  <b/>\n  <c/>\n</a>\n"
    assert show(text, make_edit(text, "  <b/>\n", "")) == [(2, "<b/>", "")]
    assert show(text, make_edit(text, "<b/>", "<b/>\n  <d/>")) == [(3, "", "<d/>")]
    assert show(text, make_edit(text, "<b/>\n  <c/>", "<d/>")) == [(2, "<b/>", "<d/>"), (3, "<c/>", "")]


def test_a_changed_or_unknown_source_shows_the_text_of_the_edit() -> None:
    edit = make_edit("<a x='1'/>", "1", "2")
    assert show("<a x='3'/>", edit) == [(1, "1", "2")]
    assert [c.line for c in list_line_changes({}, [edit])] == [1]


def test_a_line_that_nobody_typed_is_not_searched() -> None:
    text = f'<a x="1" y="{"9" * 30_000}"/>'
    assert show(text, make_edit(text, "1", "2")) == [(1, "1", "2")]
    lines = [line for _, line in iter_diff_lines({NAME: text}, [make_edit(text, "1", "2")])]
    assert lines == [f"{NAME}:1", "-1", "+2"]


def test_the_diff_of_a_long_line_names_the_attributes() -> None:
    text = f'<a x="1" y="{"9" * 500}"/>'
    lines = [line for _, line in iter_diff_lines({NAME: text}, [make_edit(text, "1", "2")])]
    assert lines == [f"{NAME}:1", '-<a x="1" … />', '+<a x="2" … />']


def run_of(text: str, *edits: Edit, applicability: Applicability = Applicability.UNSAFE) -> Run:
    at = Location("link[a]", edits[0].span)
    run = a_run(finding(fix=Fix("write it", applicability, edits), location=at, consequences={}, related=()))
    return replace(run, sources={NAME: text})


def test_the_terminal_shows_two_lines_with_the_numbers_of_others() -> None:
    text = f'<robot>\n  <origin xyz="1 0 0"/>\n{INERTIA}\n</robot>\n'
    edits = (make_edit(text, "1.7199e-05", "0"), make_edit(text, "1 0 0", "0 0 0"))
    lines = render(run_of(text, *edits), width=80, detail=DetailLevel.BRIEF).splitlines()
    assert '         2 - <origin xyz="1 0 0"/>' in lines
    assert '         2 + <origin xyz="0 0 0"/>' in lines
    number = text[: text.index("1.7199e-05")].count("\n") + 1
    assert f'         {number} - <inertia … ixy="1.7199e-05" … />' in lines
    assert f'         {number} + <inertia … ixy="0" … />' in lines


def test_the_terminal_counts_more_lines_and_says_what_shows_them() -> None:
    text = "".join(f'<origin xyz="{i} 0 0"/>\n' for i in range(5))
    edits = [make_edit(text, f'"{i} 0 0"', f'"{i} 1 0"') for i in range(5)]
    brief = render(run_of(text, *edits), detail=DetailLevel.BRIEF)
    assert "[5 lines: --diff --unsafe-fixes]\n" in brief
    assert "- <origin" not in brief
    safe = render(run_of(text, *edits, applicability=Applicability.SAFE), detail=DetailLevel.BRIEF)
    assert "[5 lines: --diff]\n" in safe
    full = render(run_of(text, *edits))
    assert full.count("- <origin") == 4
    assert "… and 1 more changed line" in full


def test_other_files_are_named() -> None:
    text = '<robot>\n  <origin xyz="1 0 0"/>\n</robot>\n'
    edit = make_edit(text, "1 0 0", "0 0 0")
    run = run_of(text, edit)
    there = replace(run.findings[0], location=Location("x", replace(edit.span, file="b.urdf")))
    page = render(replace(run, findings=(there,)), detail=DetailLevel.BRIEF)
    assert "\n           a.urdf:2\n           - <origin" in page


def test_no_line_of_a_brief_finding_is_wider_than_the_terminal() -> None:
    text = f'<robot>\n  <origin xyz="{"1" * 70} 0 0"/>\n{INERTIA}\n</robot>\n'
    edits = (make_edit(text, "1.7199e-05", "0"), make_edit(text, "1" * 70, "0"))
    for width in (40, 60, 80):
        lines = render(run_of(text, *edits), width=width, detail=DetailLevel.BRIEF).splitlines()
        assert max(len(line) for line in lines) <= width


@pytest.mark.parametrize("output", [markdown, junit])
def test_the_other_formats_show_whole_lines(output: object) -> None:
    text = f"<robot>\n{INERTIA}\n</robot>\n"
    page = output.render(run_of(text, make_edit(text, "1.7199e-05", "0")))  # type: ignore[attr-defined]
    changed = INERTIA.replace("1.7199e-05", "0")
    if output is junit:
        changed = changed.replace("<", "&lt;").replace(">", "&gt;")
    assert f"+{changed}" in page


def test_what_changes_is_never_left_out() -> None:
    text = '<inertia ixx="0.00100001" ixy="0.00200001" iyy="0.00300001" izz="0.00400001"/>'
    edits = [
        make_edit(text, "0.00100001", "0.00100002"),
        make_edit(text, "0.00300001", "0.09"),
        make_edit(text, "0.00400001", "0.00500001"),
    ]
    (change,) = list_line_changes({NAME: text}, edits)
    for width in (10, 40, 55):
        old, new = ("".join(piece for piece, _ in side) for side in fit_change(change, width))
        assert old == '<inertia ixx="0.00100001" … iyy="0.00300001" izz="0.00400001"/>'
        assert new == '<inertia ixx="0.00100002" … iyy="0.09" izz="0.00500001"/>'
    brief = render(run_of(text, *edits), width=60, detail=DetailLevel.BRIEF)
    assert all(edit.replacement in brief for edit in edits)
