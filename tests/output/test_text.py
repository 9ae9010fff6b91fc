"""The terminal report: readable at 80 columns and in a CI log, and nothing in a name can act on it."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest
from output.runs import FILE, MODEL, SOURCE, a_run, finding, span_of
from rich.cells import cell_len

from urdfcheck.core import Applicability, Cause, Edit, Fix, Location, Severity, SkippedCheck, Span
from urdfcheck.output.text import DetailLevel, render, render_statistics


def test_a_finding_begins_with_its_headline_and_then_its_place() -> None:
    lines = render(a_run(finding())).splitlines()
    title = lines.index("✖ error INR003 wheel: no body can have this inertia (12 % short)")
    assert re.match(rf"  {re.escape(FILE)}:\d+:\d+  triangle-inequality$", lines[title + 1])
    assert lines[title + 2] == "  link wheel: principal moments break the triangle inequality"


def test_prose_wraps_at_the_width_and_only_source_lines_may_be_longer() -> None:
    long = finding(message="a word " * 60, fix=Fix("do it " * 40))
    for line in render(a_run(long), width=80).splitlines():
        assert len(line) <= 80 or "│" in line or line.startswith(f"  {FILE}")


@pytest.mark.parametrize("width", [40, 60, 200])
def test_wide_characters_take_two_columns_and_a_word_longer_than_a_line_is_folded(width: int) -> None:
    word = "車輪ホイール" * 30
    why = word[::-1]
    text = render(a_run(finding(message=word, cause=Cause("x", why))), width=width)
    folded = [line for line in text.splitlines() if line.endswith(tuple(word))]
    assert max(cell_len(line) for line in folded) == width
    assert "".join(line.split()[-1] for line in folded) == word + why, "nothing is lost at a fold"


def test_a_cause_that_the_message_tells_is_not_told_again() -> None:
    text = render(a_run(finding(message="link a: the mass is in g.", cause=Cause("x", "The mass is in g."))))
    assert "why" not in text


def test_programs_are_called_as_in_every_report() -> None:
    text = render(
        a_run(finding(consequences={"rviz": "draws it", "mujoco": "refuses it", "ros2_control": "refuses it"}))
    )
    assert "  then  RViz: draws it\n  then  MuJoCo, ros2_control: refuses it\n" in text


def test_further_lines_stand_below_the_first() -> None:
    lines = render(a_run(finding(fix=Fix("straighten it " * 20))), width=60).splitlines()
    first = next(i for i, line in enumerate(lines) if line.startswith("  fix   straighten"))
    assert re.match(r" {8}(it|straighten) ", lines[first + 1])


def test_a_path_longer_than_a_line_is_not_broken() -> None:
    file = "a/rather/long/path/to/" * 10 + "robot.urdf"
    at = replace(span_of("0.09"), file=file)
    lines = render(a_run(finding(location=Location("link[wheel]", at))), width=40).splitlines()
    place = lines.index(f"  {file}:{at.line}:{at.col}")
    assert lines[place + 1] == "  triangle-inequality"


def test_a_heading_tells_no_fact_by_half() -> None:
    headings = [render(a_run(), width=width).splitlines()[0] for width in range(30, 80)]
    assert [cell_len(heading) for heading in headings] == list(range(30, 80))
    told = dict.fromkeys(heading.strip("─ ").removeprefix(MODEL).strip() for heading in headings)
    facts = ["robot rover", "2 links", "1 joint", "0.5283 kg"]
    assert list(told) == [" · ".join(facts[:number]) for number in range(5)]


def test_the_span_is_underlined() -> None:
    lines = render(a_run()).splitlines()
    marked = next(i for i, line in enumerate(lines) if "^" in line)
    start, end = lines[marked].index("^"), lines[marked].rindex("^") + 1
    assert lines[marked - 1][start:end].strip(), "the marks stand below the text that is meant"


def test_an_edit_that_deletes_a_line_shows_only_what_goes() -> None:
    fix = Fix("delete the line", Applicability.SAFE, (Edit(span_of("<robot"), "    <x/>\n", ""),))
    text = render(a_run(finding(fix=fix)))
    assert re.search(r"\d+ - <x/>$", text, re.MULTILINE)
    assert not re.search(r"\d+ \+", text)


@pytest.mark.parametrize(
    ("line", "value", "shown"),
    [
        ('<inertia ixx="0.1" ixy = "0.2"/>', "0.2", 'ixy="0.2"'),
        ("<inertia ixx='0.1'/>", "0.1", 'ixx="0.1"'),
        ('<origin rpy="0 1.57 2"/>', "1.57", 'rpy="…1.57…"'),
        ('<origin rpy="1.57 0 2"/>', "1.57", 'rpy="1.57…"'),
        ('<type x="1">ball</type>', "ball", "ball"),
        ('<a x="1" /><b/>', "/><b", "/><b"),
    ],
)
def test_an_edit_names_the_attribute(line: str, value: str, shown: str) -> None:
    start = line.index(value)
    place = Span("a.urdf", 1, start + 1, 1, start + 1 + len(value), start, start + len(value))
    fix = Fix("write it", Applicability.SAFE, (Edit(place, value, "new"),))
    text = render(replace(a_run(finding(fix=fix)), sources={"a.urdf": f"{line}\n"}))
    assert f"a.urdf:1 - {shown}\n" in text
    assert f"a.urdf:1 + {shown.replace(value, 'new')}\n" in text


def test_no_colour_unless_asked_for() -> None:
    assert "\x1b[" not in render(a_run())
    assert "\x1b[" in render(a_run(), color=True)


@pytest.mark.parametrize("width", [40, 100])
def test_colour_changes_nothing_but_the_colour(width: int) -> None:
    colored = render(a_run(), width=width, color=True)
    assert "\x1b[1;31m✖ error" in colored
    plain = re.sub(r"\x1b\[[0-9;]*m", "", colored)
    assert [line.rstrip() for line in plain.splitlines()] == render(a_run(), width=width).splitlines()


def test_control_characters_are_spelled_out() -> None:
    text = render(a_run(finding(message="\x1b[31mred\x07 \u202eevil")))
    assert "\\x1b[31mred\\x07 \\u202eevil" in text


def test_square_brackets_are_text_and_not_markup() -> None:
    text = render(a_run(finding(message="link [bold]a[/bold] [link=x]")))
    assert "link [bold]a[/bold] [link=x]" in text


def test_many_related_places_are_counted() -> None:
    related = tuple(Location(f"link[{i}]", span_of(word)) for i, word in enumerate(SOURCE.split()[:9]))
    assert "… and 5 more places" in render(a_run(finding(related=related)))


def test_the_last_line_counts() -> None:
    assert re.fullmatch(r"✖ 1 error {2}▲ 1 warning {2}i 1 info {2}in 1 model, 0\.2 s", render(a_run()).splitlines()[-1])


def test_no_line_ends_in_blanks() -> None:
    assert not [line for line in render(a_run()).splitlines() if line != line.rstrip()]


def test_a_run_without_rules_is_not_called_clean() -> None:
    text = render(replace(a_run(), findings=(), rules={}))
    assert "✔" not in text
    assert "no rule is selected" in text


def test_in_brief_an_info_is_its_headline_its_place_and_a_line_of_its_message() -> None:
    info = finding(severity=Severity.INFO, message="a word " * 60)
    lines = render(a_run(info), width=60, detail=DetailLevel.BRIEF).splitlines()
    at = next(i for i, line in enumerate(lines) if line.startswith(f"  {FILE}:"))
    assert lines[at - 2].startswith("i info INR003 wheel: no body can have")
    assert lines[at + 1].startswith("  a word")
    assert lines[at + 1].endswith(" …")
    assert len(lines[at + 1]) <= 60
    assert lines[at + 2] == ""
    assert "1 info in brief, in full with --verbose" in render(a_run(info), width=200, detail=DetailLevel.BRIEF)
    assert "put the point back" in render(a_run(info))


def test_what_was_skipped_for_some_models_names_them() -> None:
    skips = (SkippedCheck("MSH002", MODEL, "no meshes here"), SkippedCheck("COL001", MODEL, "no meshes here"))
    one = a_run(skipped=skips)
    assert "skipped COL001, MSH002: no meshes here\n" in render(one)
    two = replace(one, models=(*one.models, replace(one.models[0], id="other.urdf")))
    assert f"skipped COL001, MSH002: no meshes here ({MODEL})\n" in render(two)


def test_in_brief_what_matters_stands_before_the_infos_of_its_model() -> None:
    first = finding(severity=Severity.INFO, code="AAA001")
    text = render(a_run(first, finding(code="ZZZ001")), detail=DetailLevel.BRIEF)
    assert text.index("ZZZ001") < text.index("AAA001")


def test_quiet_is_errors_warnings_what_failed_and_one_line() -> None:
    text = render(replace(a_run(), failures=("it broke",)), detail=DetailLevel.QUIET)
    assert "error INR003" in text
    assert "warning INR001" in text
    assert "i info" not in text.replace("i 1 info", "")
    assert "skipped" not in text
    assert "fixable" not in text
    assert text.splitlines()[-2:] == [
        "not checked: it broke",
        "⊘ not finished: 1 failure  ✖ 1 error  ▲ 1 warning  i 1 info  in 1 model, 0.2 s",
    ]


@pytest.mark.parametrize("detail", [DetailLevel.BRIEF, DetailLevel.QUIET])
def test_an_info_that_fails_the_run_is_told_in_full(detail: DetailLevel) -> None:
    run = a_run(finding(severity=Severity.INFO))
    assert "put the point back" not in render(run, detail=detail)
    assert "put the point back" in render(run, detail=detail, fail_on="info")
    assert "put the point back" in render(replace(run, fail_on={MODEL: "info"}), detail=detail)


def test_statistics_are_a_line_for_each_rule_the_worst_first() -> None:
    often = [finding(severity=Severity.WARNING, code="INR001", name="mass", fix=None, model=f"m{i}") for i in range(3)]
    lines = render_statistics(a_run(*often, finding(), often[0])).splitlines()
    assert [line.split() for line in lines[:3]] == [
        ["rule", "severity", "findings", "models", "fixable"],
        ["INR003", "triangle-inequality", "error", "1", "1", "1"],
        ["INR001", "mass", "warning", "4", "3", "0"],
    ]
    assert "\x1b[" in render_statistics(a_run(), color=True)


def test_statistics_add_up_to_the_last_line() -> None:
    """A rule whose findings are of two severities has a line for each."""
    lines = render_statistics(
        a_run(finding(), finding(severity=Severity.INFO), finding(severity=Severity.INFO))
    ).splitlines()
    assert [line.split()[2:4] for line in lines[1:3]] == [["error", "1"], ["info", "2"]]
    assert "1 error" in lines[-1]
    assert "2 info" in lines[-1]
