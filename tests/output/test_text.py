"""The terminal report: readable at 80 columns and in a CI log, and nothing in a name can act on it."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest
from output.runs import FILE, SOURCE, a_run, finding, span_of
from rich.cells import cell_len

from urdfcheck.core import Applicability, Cause, Edit, Fix, Location
from urdfcheck.output.text import render


def test_a_finding_reads_place_severity_code_and_name_on_one_line() -> None:
    first = next(line for line in render(a_run()).splitlines() if line.startswith(FILE + ":"))
    assert re.match(rf"{re.escape(FILE)}:\d+:\d+ [✖▲i] (error|warning|info) [A-Z]{{3}}\d{{3}} [a-z-]+$", first)


def test_prose_wraps_at_the_width_and_only_source_lines_may_be_longer() -> None:
    long = finding(message="a word " * 60, fix=Fix("do it " * 40))
    for line in render(a_run(long), width=80).splitlines():
        assert len(line) <= 80 or "│" in line or line.startswith(FILE)


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


def test_further_lines_stand_below_the_first() -> None:
    lines = render(a_run(finding(fix=Fix("straighten it " * 20))), width=60).splitlines()
    first = next(i for i, line in enumerate(lines) if line.startswith("  fix   straighten"))
    assert re.match(r" {8}(it|straighten) ", lines[first + 1])


def test_a_path_longer_than_a_line_is_not_broken() -> None:
    file = "a/rather/long/path/to/" * 10 + "robot.urdf"
    at = replace(span_of("0.09"), file=file)
    lines = render(a_run(finding(location=Location("link[wheel]", at))), width=40).splitlines()
    place = lines.index(f"{file}:{at.line}:{at.col}")
    assert lines[place + 1] == "  ✖ error INR003 triangle-inequality"


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
