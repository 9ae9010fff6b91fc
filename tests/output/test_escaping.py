"""Whatever a file holds, no terminal, browser or CI system obeys it, and a program still reads it as it is."""

from __future__ import annotations

import html
import json
import re
from dataclasses import replace
from xml.etree import ElementTree

import pytest
from hypothesis import given
from hypothesis import strategies as st
from output.runs import SOURCE, a_run, finding, info, span_of

from urdfcheck.core import Location
from urdfcheck.export.link_pairs import LinkPair, LinkPairs, render_srdf
from urdfcheck.output import FORMATS, render
from urdfcheck.output.shared import escaping as inert
from urdfcheck.output.text import render as render_text
from urdfcheck.source.text.xml import quote_attribute

pytestmark = pytest.mark.slow

COMMAND = re.compile(r"^\s*::|##\w*\[", re.MULTILINE)
ACTING = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\xad\u061c\u200b-\u200f\u2028-\u202e\u2060-\u206f\ufeff\ud800-\udfff]")
# Text that is made of what acts, more often than chance would have it.
PIECES = [
    "::",
    ":",
    "##",
    "#",
    "[",
    "error",
    "vso",
    "\n",
    "\r",
    "\t",
    " ",
    "\x85",
    "\u2028",
    "\x1b[31m",
    "\u202e",
    "\xa0",
]
hostile = st.lists(st.sampled_from(PIECES) | st.text(max_size=3), max_size=12).map("".join)
ATTACKS = [
    "\n::error::x",
    "\n \t\xa0::add-mask::x",
    "a\r::error::x",
    "\x85::error::x",
    "\u2028::error::x",
    "##[error]x",
    "###[group]x",
    "##vso[task.setvariable variable=a]b",
    "##teamcity[x]",
    "section_start:0:x\r\x1b[0K",
    "\x1b]8;;http://example.org\x07x",
    "\x9b31m",
    "\b\b\b",
    "\u2066\u202e",
    "\u3164\u115f\U000e0041",
    "\udcff",
]


@given(hostile)
def test_text_for_a_log_neither_acts_nor_commands(text: str) -> None:
    shown = inert.escape_for_log(text)
    assert not ACTING.search(shown)
    assert not COMMAND.search(shown)


@given(hostile)
def test_json_says_the_same(text: str) -> None:
    document = inert.escape_for_json(json.dumps({text: [text]}, indent=2, ensure_ascii=False))
    assert json.loads(document) == {text: [text]}
    assert not ACTING.search(document)
    assert not COMMAND.search(document)


@given(hostile)
def test_html_shows_the_same_or_spells_it(text: str) -> None:
    document = inert.escape_for_html(f"<p>\n{html.escape(text)}</p>")
    assert not ACTING.search(document)
    assert not COMMAND.search(document)
    assert html.unescape(document) == f"<p>\n{inert.escape_invisible(text)}</p>"


@given(hostile.filter(lambda text: not re.search("[^\t\n\r -\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]", text)))
def test_xml_says_the_same(text: str) -> None:
    document = inert.escape_for_xml(f"<a>\n<b c={quote_attribute(text)}/></a>")
    inner = ElementTree.fromstring(document).find("b")
    assert inner is not None
    assert inner.get("c") == text
    assert not ACTING.search(document)
    assert not COMMAND.search(document)


def test_plain_text_stays_as_it_is() -> None:
    for text in (
        "wheel_1::left: 3 µm ± 1°",
        "a\n\tb",
        "# [1] ## title",
        "\u8eca\u8f2a",
        "C:\\robot\\a.urdf",
        "\u202f1",
    ):
        assert (
            inert.escape_for_log(text)
            == inert.escape_for_json(text)
            == inert.escape_for_html(text)
            == inert.escape_for_xml(text)
            == text
        )


def test_a_name_is_one_line() -> None:
    assert inert.escape_one_line("a\nb\tc") == "a\\nb\\tc"


@pytest.mark.parametrize("attack", ATTACKS, ids=ascii)
# The commands of github are its own: tests/output/test_formats.py reads them as a runner does.
@pytest.mark.parametrize("output_format", [name for name in FORMATS if name != "github"])
def test_no_part_of_a_report_acts(attack: str, output_format: str) -> None:
    """Every text of a finding, a model and a failure, and the source as well."""
    file = f"{attack}.urdf"
    at = replace(span_of("0.09"), file=file)
    bad = finding(message=attack, subjects=(f"link[{attack}]",), location=Location(attack, at, (at,)), model=attack)
    model = info(path=file, robot=attack, args={attack: attack}, id=attack)
    run = a_run(bad, models=(model,), sources={file: SOURCE.replace("rover", attack)}, failures=(attack,), scenes=())
    document = render(run, output_format)
    assert not ACTING.search(document)
    assert not COMMAND.search(document)


@pytest.mark.parametrize("width", range(12, 60))
def test_no_wrapped_line_begins_with_a_command(width: int) -> None:
    message = "a name ::error::of many ::add-mask::words ##[error]and more " * 3
    for color in (False, True):
        lines = render_text(a_run(finding(message=message)), width=width, color=color)
        assert not COMMAND.search(re.sub(r"\x1b\[[0-9;]*m", "", lines))


def test_a_code_frame_begins_with_the_number_of_its_line() -> None:
    source = SOURCE.replace('  <link name="base"/>', "::error::x")
    text = render_text(
        a_run(finding(location=Location("link", span_of("::error::x", source))), sources={span_of("0.09").file: source})
    )
    assert re.search(r"^  +\d+ │ ::error::x$", text, re.MULTILINE)


def test_names_in_a_semantic_description() -> None:
    name = 'a\x9b31m ##[error] \u202e"<'
    pairs = LinkPairs(name, 10, (LinkPair(links=(name, "b"), reason="Never", proven_never=True, seen_colliding=False),))
    document = inert.escape_for_xml(render_srdf(pairs))
    assert not ACTING.search(document)
    assert not COMMAND.search(document)
    root = ElementTree.fromstring(document)
    assert root.get("name") == root[0].get("link1") == name
