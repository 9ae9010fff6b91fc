"""Other programs count UTF-16 code units or bytes where a span counts code points."""

from __future__ import annotations

from dataclasses import replace

import pytest
from output.runs import span_of

from urdfcheck.core import Span
from urdfcheck.output.shared.positions import Region, to_utf8_region, to_utf16_region

FILE = "arm.urdf"
# An é of one code point, one of a letter and a mark, and a robot beyond the first plane, before the word and in it.
LINE = '  <link name="é e\u0301 🤖 grip🤖per"/>'


def lines_of(newline: str) -> dict[str, str]:
    return {FILE: newline.join(("<robot>", LINE, "</robot>"))}


@pytest.mark.parametrize("newline", ["\n", "\r\n", "\r"])
def test_columns_are_the_units_before_them(newline: str) -> None:
    sources = lines_of(newline)
    start = sources[FILE].index("grip")
    column = LINE.index("grip") + 1
    span = Span(FILE, 2, column, 2, column + 8, start, start + 8)
    before, through = LINE[: column - 1], LINE[: column + 7]
    assert to_utf8_region(span, sources) == Region(2, len(before.encode()) + 1, 2, len(through.encode()) + 1)
    assert to_utf16_region(span, sources) == Region(2, column + 1, 2, column + 8 + 2)
    assert (column, to_utf16_region(span, sources).column, to_utf8_region(span, sources).column) == (22, 23, 27)


def test_the_end_is_counted_on_its_own_line() -> None:
    sources = {FILE: "a\n🤖🤖b"}
    span = span_of("a\n🤖🤖", sources[FILE], FILE)
    assert to_utf16_region(span, sources) == Region(1, 1, 2, 5)
    assert to_utf8_region(span, sources) == Region(1, 1, 2, 9)


def test_ascii_needs_no_conversion() -> None:
    sources = {FILE: "<robot>\n  <link/>\n</robot>\n"}
    span = span_of("<link/>", sources[FILE], FILE)
    assert to_utf16_region(span, sources) == to_utf8_region(span, sources) == Region(2, 3, 2, 10)


def test_without_its_text_a_span_is_passed_on() -> None:
    span = Span(FILE, 7, 3, 8, 5, 100, 120)
    for sources in ({}, {FILE: ""}, {FILE: "<robot/>"}):
        assert to_utf16_region(span, sources) == to_utf8_region(span, sources) == Region(7, 3, 8, 5)


def test_a_span_past_the_end_counts_what_is_there() -> None:
    sources = {FILE: "🤖"}
    span = Span(FILE, 1, 1, 1, 9, 0, 8)
    assert to_utf16_region(span, sources) == Region(1, 1, 1, 10)
    assert to_utf16_region(replace(span, col=5, start=1), sources).column == 6


def test_half_a_pair_counts_as_one_unit() -> None:
    sources = {FILE: "\ud83e<a/>"}
    assert to_utf16_region(span_of("<a/>", sources[FILE], FILE), sources).column == 2
