"""The formats for places where people already look: GitHub, GitLab, build servers, reviewdog, a comment.

Each document is validated as its reader would, and each validator refuses a document that is broken.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import jsonschema
import pytest
from hypothesis import given
from hypothesis import strategies as st
from lxml import etree
from markdown_it import MarkdownIt
from markdown_it.token import Token
from output.runs import (
    ACCEPTED,
    FILE,
    MODEL,
    NOT_CHECKED,
    SOURCE,
    UNUSED_MACROS,
    a_run,
    chain,
    finding,
    info,
    rule,
    scene,
    span,
    span_of,
    star,
)

from urdfcheck.cli import job_summary
from urdfcheck.cli.output_files import parse_run_outputs
from urdfcheck.core import (
    Applicability,
    Cause,
    Edit,
    Fix,
    Location,
    NotChecked,
    Run,
    Severity,
    SkippedCheck,
    Span,
    Suppression,
    UrdfcheckError,
)
from urdfcheck.core.merging import join_occurrences
from urdfcheck.output import FORMATS, html, render, text
from urdfcheck.output.markdown import COMMENT_LIMIT, MARKER, render_job_summary
from urdfcheck.output.shared import escaping as inert
from urdfcheck.output.shared.mermaid_chart import MOST_CHARACTERS, MOST_EDGES, build_mermaid_chart, format_label

pytestmark = pytest.mark.slow

# -- validators --------------------------------------------------------------------------------------------------------

TEXT = {"type": "string", "minLength": 1}
COUNT = {"type": "integer", "minimum": 1}
# What GitLab demands of each entry, as its documentation of Code Quality says.
GITLAB = {
    "type": "array",
    "items": {
        "type": "object",
        "required": ["description", "check_name", "fingerprint", "severity", "location"],
        "properties": {
            "description": TEXT,
            "check_name": TEXT,
            "fingerprint": TEXT,
            "severity": {"enum": ["info", "minor", "major", "critical", "blocker"]},
            "location": {
                "type": "object",
                "required": ["path", "lines"],
                "properties": {
                    "path": {"type": "string", "pattern": "^[^/]"},
                    "lines": {"type": "object", "required": ["begin"], "properties": {"begin": COUNT, "end": COUNT}},
                },
            },
        },
    },
}


def closed(required: list[str], **properties: Any) -> dict[str, Any]:
    return {"type": "object", "required": required, "properties": properties, "additionalProperties": False}


POSITION = closed(["line", "column"], line=COUNT, column=COUNT)
RANGE = closed(["start", "end"], start=POSITION, end=POSITION)
LOCATION = closed(["path"], path=TEXT, range=RANGE)
SEVERITY = {"enum": ["ERROR", "WARNING", "INFO"]}
NAMED = closed(["name"], name=TEXT)
# reviewdog's DiagnosticResult as its documentation of the format has it, and nothing else.
RDJSON = closed(
    ["source", "diagnostics"],
    source=NAMED,
    severity=SEVERITY,
    diagnostics={
        "type": "array",
        "items": closed(
            ["message", "location", "severity"],
            message=TEXT,
            location=LOCATION,
            severity=SEVERITY,
            source=NAMED,
            code=closed(["value"], value=TEXT),
            suggestions={"type": "array", "items": closed(["range", "text"], range=RANGE, text={"type": "string"})},
            related_locations={
                "type": "array",
                "items": closed(["location"], message={"type": "string"}, location=LOCATION),
            },
        ),
    },
)
JUNIT = etree.XMLSchema(etree.parse(Path(__file__).parent / "junit-10.xsd"))
GFM = MarkdownIt("commonmark").enable(["table", "strikethrough"])
OURS = re.compile(r"</?details>|</?summary>|</?code>|<br>|<!-- urdfcheck report -->")


def as_gitlab(document: str) -> Any:
    found = json.loads(document)
    jsonschema.validate(found, GITLAB)
    prints = [issue["fingerprint"] for issue in found]
    assert len(prints) == len(set(prints)), "fingerprints repeat"
    return found


def as_rdjson(document: str) -> Any:
    found = json.loads(document)
    jsonschema.validate(found, RDJSON)
    return found


def as_junit(document: str) -> etree._Element:
    root = etree.fromstring(document.encode())
    JUNIT.assertValid(root)
    for suite in root:
        names = [case.get("name") for case in suite.iter("testcase")]
        assert len(names) == len(set(names)) == int(suite.get("tests"))
        for attribute, tag in (("failures", "failure"), ("errors", "error"), ("skipped", "skipped")):
            assert len(list(suite.iter(tag))) == int(suite.get(attribute))
    return root


def unescaped(text: str) -> str:
    for code, character in (("%0D", "\r"), ("%0A", "\n"), ("%3A", ":"), ("%2C", ","), ("%25", "%")):
        text = text.replace(code, character)
    return text


def as_github(document: str) -> list[tuple[str, dict[str, str], str]]:
    """The commands that a runner finds, the way it reads them; the other lines are none."""
    found = []
    for line in document.splitlines():
        match = re.match(r"^\s*::(\w+)(?: ([^:]*))?::(.*)$", line)
        if match is None:
            assert "::" not in line[:3]
            assert not re.search(r"##\w*\[", line)
            continue
        name, given, message = match.groups()
        assert name in {"error", "warning", "notice"}
        properties = dict(pair.split("=", 1) for pair in (given or "").split(",") if pair)
        assert set(properties) <= {"file", "line", "endLine", "col", "endColumn", "title"}
        decoded = unescaped(message)
        assert not re.search(r"^\s*::|##\w*\[", decoded, re.MULTILINE), "no line of a message is a command either"
        found.append((name, {key: unescaped(value) for key, value in properties.items()}, decoded))
    return found


def walk(tokens: list[Token]) -> list[Token]:
    return [inner for token in tokens for inner in (token, *walk(token.children or []))]


def as_markdown(document: str) -> list[Token]:
    """What a site makes of it: no link, picture, mention or reference, no markup but ours, and whole tables."""
    tokens = walk(GFM.parse(document))
    assert {t.type for t in tokens} <= {
        *("heading_open", "heading_close", "paragraph_open", "paragraph_close", "inline", "text", "softbreak"),
        *("table_open", "table_close", "thead_open", "thead_close", "tbody_open", "tbody_close", "tr_open", "tr_close"),
        *("th_open", "th_close", "td_open", "td_close", "strong_open", "strong_close", "em_open", "em_close"),
        *("bullet_list_open", "bullet_list_close", "list_item_open", "list_item_close"),
        *("code_inline", "fence", "html_block", "html_inline"),
    }
    for token in tokens:
        if token.type in {"html_block", "html_inline"}:
            assert "<" not in OURS.sub("", token.content), token.content
        if token.type == "text":
            assert not re.search(r"@\w|#\d|://|\bwww\.|:\w+:", token.content), token.content
    # A site drops cells beyond those of the head: nothing but what is ours may begin one.
    widths = {line.count("|") - 1 for line in document.splitlines() if line.startswith("| ")}
    assert widths <= {3, 8}
    assert {len(row) for row in rows_of(tokens)} == widths
    return tokens


def rows_of(tokens: list[Token]) -> list[list[str]]:
    found: list[list[str]] = []
    for place, token in enumerate(tokens):
        if token.type == "tr_open":
            found.append([])
        if token.type in {"th_open", "td_open"}:
            found[-1].append(tokens[place + 1].content)
    return found


# Where a comment has the text of a stranger.
PLACE = f"`{FILE}:{span_of('0.09').line}:{span_of('0.09').col}`"
READERS: dict[str, Callable[[str], Any]] = {
    "github": as_github,
    "gitlab": as_gitlab,
    "junit": as_junit,
    "rdjson": as_rdjson,
    "markdown": as_markdown,
}


@pytest.mark.parametrize(
    ("output_format", "good", "bad"),
    [
        ("github", "::error file=a", "::set-output file=a"),
        ("gitlab", '"severity": "critical"', '"severity": "error"'),
        ("gitlab", '"path": "rover', '"path": "/rover'),
        ("junit", "<testcase ", '<testcase file="a" line="1" '),
        ("junit", '<failure type="INR003"', "<failed"),
        ("junit", 'tests="4"', 'tests="5"'),
        ("rdjson", '"column": ', '"offset": '),
        ("rdjson", '"severity": "ERROR"', '"severity": "error"'),
        ("markdown", PLACE, "[rover](rover.urdf)"),
        ("markdown", "`rover.urdf:9`", "rover|rover.urdf|8"),
        ("markdown", PLACE, "@rover"),
        ("markdown", PLACE, "<img>"),
    ],
)
def test_each_reader_refuses_what_is_broken(output_format: str, good: str, bad: str) -> None:
    document = render(judged(a_run()), output_format).replace("::error file=rover", "::error file=a")
    changed = document.replace(good, bad)
    assert changed != document
    READERS[output_format](document)
    if "<failed" in bad:
        changed = changed.replace("</failure>", "</failed>")
    with pytest.raises((AssertionError, jsonschema.ValidationError, etree.DocumentInvalid)):
        READERS[output_format](changed)


# -- runs of every kind ------------------------------------------------------------------------------------------------


def judged(run: Run) -> Run:
    """The run, with what it says that ran on its model."""
    return replace(run, complete_rules={MODEL: frozenset(run.rules)}, unit_ids=frozenset({MODEL}), units=1)


KNOWN = finding(suppressed=Suppression("source", "it is a dummy"))
RUNS = {
    "plain": a_run(),
    "nothing to check": a_run(models=(), skipped=(), units=0, scenes=(), sources={}, seconds=0.0),
    "failed": a_run(failures=("a check crashed:\nZeroDivisionError", "interrupted")),
    "needs arguments": a_run(
        finding(location=Location("robot", None), subjects=("robot",), fix=None),
        models=(info(status="needs-arguments", links=0, joints=0, mass=None),),
        scenes=(),
    ),
    "not checked": NOT_CHECKED,
    "accepted": ACCEPTED,
    "unused macros": UNUSED_MACROS,
    "no place": a_run(finding(location=Location("robot[rover]", None), subjects=("robot[rover]",))),
    "no model": a_run(finding(model="rover/package.xml", location=Location("name", None), subjects=("name",))),
    "suppressed": a_run(KNOWN),
    "twice": a_run(finding(), finding()),
    "no source": a_run(sources={}),
}
RUNS["nothing to check"] = replace(RUNS["nothing to check"], findings=())


@pytest.mark.parametrize("output_format", READERS)
@pytest.mark.parametrize("kind", RUNS)
def test_every_kind_of_run_can_be_told(kind: str, output_format: str) -> None:
    document = render(RUNS[kind], output_format)
    READERS[output_format](document)
    assert document.endswith("\n")
    assert document == render(RUNS[kind], output_format), "equal runs give equal documents"


@pytest.mark.parametrize("output_format", READERS)
def test_a_run_that_failed_never_looks_clean(output_format: str) -> None:
    run = replace(RUNS["failed"], findings=())
    found = READERS[output_format](render(run, output_format))
    if output_format == "junit":
        assert [case.get("message") for case in found.iter("error")] == ["a check crashed:", "interrupted"]
    elif output_format == "markdown":
        assert "ZeroDivisionError" in render(run, output_format)
    else:
        shown = [text for _, _, text in found] if output_format == "github" else json.dumps(found)
        assert "ZeroDivisionError" in str(shown)


@pytest.mark.parametrize("output_format", ["github", "gitlab", "rdjson", "markdown"])
def test_what_is_known_is_not_told(output_format: str) -> None:
    document = render(RUNS["suppressed"], output_format)
    assert "INR003" not in document
    assert "1 known and not shown" in document or output_format != "markdown"


@pytest.mark.parametrize(
    "output_format", ["text", "json", "html", "markdown", "sarif", "github", "gitlab", "rdjson", "junit"]
)
def test_a_headline_is_told_before_the_evidence(output_format: str) -> None:
    told = render(a_run(finding(headline="no body has this", message="moments break the rule")), output_format)
    assert 0 < told.index("no body has this") < told.index("moments break the rule")


def test_titles_are_headlines() -> None:
    run = judged(a_run(finding(headline="no body has this")))
    (annotation,) = [line for line in render(run, "github").splitlines() if line.startswith("::error")]
    assert "title=INR003 no body has this::" in annotation
    (issue,) = json.loads(render(run, "gitlab"))
    assert issue["description"] == "no body has this [triangle-inequality]"
    (case,) = [case for case in as_junit(render(run, "junit")).iter("testcase") if case.find("failure") is not None]
    assert case.get("name") == "INR003 no body has this"


# -- strangers' text ---------------------------------------------------------------------------------------------------

HOSTILE = [
    "50%0A::error::x",
    "a\n::error file=b::taken",
    "a,line=1::b:c",
    "\r\n##[error]x ##vso[task.setvariable variable=a]b",
    "x|y||z\\|",
    "`` ` ``` ` ````",
    "\n```\n\n# out\n\n<b>",
    "</script></details><img src=x onerror=alert(1)>",
    "@team/robots and a@b.example #1 GH-2 deadbeef1",
    "[x](http://a.example) ![y](//b.example) <http://c.example> www.d.example",
    "end] --> x[\"a\"]; click x href 'http://e.example'",
    "%%{init: {}}%% style a:b#c; classDef x:#d;",
    "\"quoted\" 'and' «more»",
    "🤖 é \u202e \x1b[31m \ufffe \udcff",
    "# - * _a_ **b** ~~c~~ $d$ :octocat: {{ e }} <!-- f",
    "/close",
    "",
]


@pytest.mark.parametrize("output_format", READERS)
@pytest.mark.parametrize("name", HOSTILE, ids=ascii)
def test_no_name_acts(name: str, output_format: str) -> None:
    """Every text of a finding, a model, a failure and a link, and the source as well."""
    own = f"m{name}"
    source = SOURCE.replace("rover", name)
    at = replace(span_of("0.09", source), file=f"x{name}.urdf")
    edit = Edit(at, "0.09", name)
    bad = finding(
        headline=f"{name}: bad",
        message=f"link {name}: bad",
        subjects=(f"link[{name}]", "link[b]"),
        location=Location(f"link[{name}]", at, (at,)),
        related=(Location(name, at),),
        cause=Cause("x", name),
        consequences={"mujoco": name, name: "refuses"},
        fix=Fix(name, Applicability.SAFE, (edit,)),
        model=own,
    )
    model = info(path=at.file, robot=name, args={name: name}, id=own)
    unread = replace(model, id=f"{own}2", status="failed", not_checked=NotChecked(name, name))
    drawn = scene(model=own, links=(*scene().links, replace(scene().links[0], name=name)), root=name)
    run = a_run(
        *(replace(bad, blocks_check=True), replace(bad, code="INR004", severity=Severity.INFO, suppressed=None)),
        models=(model, unread),
        unused_macro_files=(f"{name}.xacro",),
        sources={at.file: source},
        failures=(f"it: {name}",),
        scenes=(drawn,),
        skipped=(SkippedCheck("COL001", own, name),),
    )
    document = render(run, output_format)
    READERS[output_format](document)
    assert not re.search("[\x00-\x08\x0b-\x1f\x7f-\x9f\u202e\ud800-\udfff]", document)
    if output_format == "github":
        assert len(as_github(document)) == 3, "one for each finding and failure, and no other"
    if output_format == "markdown":
        kinds = [token.type for token in as_markdown(render_job_summary(run, (name,)))]
        assert kinds.count("fence") == 3, "two repairs and a tree"
        kinds = [token.type for token in as_markdown(document)]
        assert kinds.count("fence") == 1, "one repair; there is no room for more"
        assert kinds.count("heading_open") == 1, "the verdict"
    if output_format in {"gitlab", "rdjson", "junit"}:
        assert not re.search(r"^\s*::|##\w*\[", document, re.MULTILINE)


PIECES = [
    "`",
    "``",
    "|",
    "\\",
    "[",
    "](",
    "!",
    "<b>",
    "&amp;",
    "@a",
    "#1",
    "_",
    "**",
    "~~",
    "http://a.b",
    ":a:",
    " ",
    "\n",
]


@given(st.lists(st.sampled_from(PIECES) | st.text(max_size=3), max_size=10).map("".join))
def test_text_in_a_cell_is_text_or_code(text: str) -> None:
    tokens = walk(
        GFM.parse(
            inert.escape_for_log(
                f"| a | b |\n| - | - |\n| {inert.escape_for_markdown(text)} | {inert.format_code_span(text)} |"
            )
        )
    )
    assert [len(row) for row in rows_of(tokens)] == [2, 2]
    inside = [inner for token in tokens if token.type == "inline" for inner in token.children or []]
    assert {token.type for token in inside} <= {"text", "code_inline"}
    assert not [t.content for t in inside if t.type == "text" and re.search(r"@\w|#\d|://|:\w+:", t.content)]


@pytest.mark.parametrize(
    "text", ["# a", "- a", "+ a", "1. a", "2) a", "> a", "/close a", "=== a", "| a", "* a", " # a"]
)
def test_no_first_word_begins_a_block(text: str) -> None:
    assert [token.type for token in GFM.parse(inert.escape_for_markdown(text))] == [
        "paragraph_open",
        "inline",
        "paragraph_close",
    ]
    assert inert.escape_for_markdown(text).startswith("`")


def test_plain_words_stay_plain() -> None:
    text = "link wheel_1: I1 + I2 >= I3 by 50 % (3.5e-06 kg·m²), see \"a\" and 'b'; 1000 kg/m³, x = 0.0012345678"
    assert inert.escape_for_markdown(text) == text
    assert inert.escape_for_markdown("-0.5 m") == "-0.5 m"


@pytest.mark.parametrize("name", HOSTILE, ids=ascii)
def test_a_label_of_a_tree_is_one_quoted_word(name: str) -> None:
    assert re.fullmatch(r"(?:[\w ./,()…-]|#\d+;|[^\x00-\x7f])+", format_label(name))


# -- each for itself ---------------------------------------------------------------------------------------------------


def with_umlauts() -> tuple[Run, str]:
    """A finding behind an é, a robot of two UTF-16 units and four bytes, and before a ``|``."""
    line = '<link name="é🤖" mass="-1"/>'
    source = f"<robot>\n{line}\n</robot>\n"
    start = source.index("-1")
    at = span(start, start + 2, source)
    fix = Fix("write 1", Applicability.UNSAFE, (Edit(at, "-1", "1"),))
    return a_run(finding(location=Location("link[é🤖]", at), fix=fix, related=()), sources={FILE: source}), line


def test_columns_are_those_of_the_reader() -> None:
    run, line = with_umlauts()
    place = line.index("-1") + 1
    (_, properties, _), *_ = as_github(render(run, "github"))
    assert [properties[key] for key in ("line", "endLine", "col", "endColumn")] == [
        "2",
        "2",
        str(place + 1),
        str(place + 3),
    ]
    (diagnostic,) = as_rdjson(render(run, "rdjson"))["diagnostics"]
    expected = {"start": {"line": 2, "column": place + 4}, "end": {"line": 2, "column": place + 6}}
    assert diagnostic["location"]["range"] == expected
    assert diagnostic["suggestions"] == [{"range": expected, "text": "1"}]
    assert line.encode()[place + 3 : place + 5] == b"-1"


def on_line(line: int, file: str = FILE) -> Location:
    """A place on a line of its own."""
    return Location(f"link[l{line}]", Span(file, line, 1, line, 2, 10 * line, 10 * line + 1))


def many(**changes: Any) -> Run:
    """A run with 15 errors, 25 warnings and 35 infos, the least first."""
    found = [
        finding(severity=severity, subjects=(f"link[{severity}{i}]",), **{"location": on_line(line + i), **changes})
        for severity, count, line in ((Severity.INFO, 35, 1), (Severity.WARNING, 25, 50), (Severity.ERROR, 15, 90))
        for i in range(count)
    ]
    return a_run(*found)


def test_github_shows_ten_of_a_kind_the_worst_first() -> None:
    document = render(many(), "github")
    assert [name for name, _, _ in as_github(document)] == ["error"] * 10 + ["warning"] * 10 + ["notice"] * 10
    assert "\n45 more: see the job summary\n" in document
    assert document.endswith("15 errors to repair: ✖ 15 errors  ▲ 25 warnings  i 35 info  in 1 model\n")


def test_github_counts_a_failure_as_an_error() -> None:
    commands = as_github(render(replace(many(), failures=("a", "b")), "github"))
    assert [message for name, _, message in commands if name == "error"][:2] == ["a", "b"]
    assert sum(name == "error" for name, _, _ in commands) == 10


def test_github_has_no_columns_over_several_lines() -> None:
    element = span_of(SOURCE[SOURCE.index('<link name="wheel">') : SOURCE.index("</link>")])
    ((_, properties, message),) = as_github(render(a_run(finding(location=Location("link[wheel]", element))), "github"))
    assert int(properties["endLine"]) > int(properties["line"])
    assert not {"col", "endColumn"} & set(properties)
    assert message.splitlines()[1] == "Why: a decimal point was lost in izz"


class TestOneEntryPerPlace:
    """One kind of mistake at three places, two of them on one line, of which one is a mistake of another kind too."""

    @pytest.fixture
    def run(self) -> Run:
        first, second = finding(location=on_line(1)), finding(location=on_line(2), subjects=("link[b]",))
        other = finding(location=on_line(2), subjects=("link[c]",), message_id="fused", headline="c: another kind")
        return a_run(join_occurrences([first, second], {}), other)

    def test_what_shows_lines_has_each_line_once(self, run: Run) -> None:
        results = json.loads(render(run, "sarif"))["runs"][0]["results"]
        regions = [result["locations"][0]["physicalLocation"]["region"] for result in results]
        assert [region["startLine"] for region in regions] == [1, 2]
        assert "another kind" in results[1]["message"]["text"]
        assert [i["location"]["lines"]["begin"] for i in as_gitlab(render(run, "gitlab"))] == [1, 2]
        diagnostics = json.loads(render(run, "rdjson"))["diagnostics"]
        assert [d["location"]["range"]["start"]["line"] for d in diagnostics] == [1, 2]
        assert [line.split(":")[1] for line in render(run, "concise").splitlines()] == ["1", "2"]

    def test_github_has_one_annotation_for_all_places(self, run: Run) -> None:
        first, second = as_github(render(run, "github"))
        assert (first[1]["line"], second[1]["line"]) == ("1", "2")
        assert "Also: rover.urdf:2 " in first[2]

    def test_each_element_is_a_case_with_its_own_numbers(self, run: Run) -> None:
        names = [case.get("name") for case in ElementTree.fromstring(render(run, "junit")).iter("testcase")]
        assert sum("INR003" in str(name) for name in names) == 3

    def test_json_has_each_place(self, run: Run) -> None:
        joint, alone = json.loads(render(run, "json"))["findings"]
        assert [own["location"]["line"] for own in joint["occurrences"]] == [1, 2]
        assert alone["occurrences"] == []

    def test_the_page_and_the_full_report_tell_each_place(self, run: Run) -> None:
        assert "<h5>2 places</h5>" in html.render(run)
        assert "  also  rover.urdf:2 " in text.render(run)


def test_gitlab_numbers_equal_fingerprints_and_places_what_has_no_place() -> None:
    places = (on_line(1), on_line(2))
    first, second = as_gitlab(render(a_run(*(finding(location=at) for at in places)), "gitlab"))
    assert second["fingerprint"] == f"{first['fingerprint']}-2"
    (placeless,) = as_gitlab(render(RUNS["no place"], "gitlab"))
    assert placeless["location"] == {"path": FILE, "lines": {"begin": 1}}


@pytest.mark.parametrize(
    ("changes", "severity"),
    [
        ({"consequences": {"urdfdom": "refuses the file"}}, "blocker"),
        ({"consequences": {"mujoco": "refuses the file"}}, "critical"),
        ({"severity": Severity.WARNING}, "major"),
        ({"severity": Severity.INFO}, "info"),
    ],
)
def test_gitlab_weighs(changes: dict[str, Any], severity: str) -> None:
    (issue,) = as_gitlab(render(a_run(finding(**changes)), "gitlab"))
    assert issue["severity"] == severity


def test_rdjson_suggests_one_edit_in_the_lines_of_the_finding() -> None:
    def suggested(*edits: Edit) -> int:
        run = a_run(finding(fix=Fix("x", Applicability.UNSAFE, edits)))
        return len(as_rdjson(render(run, "rdjson"))["diagnostics"][0].get("suggestions", ()))

    here, elsewhere = Edit(span_of("0.09"), "0.09", "0.01"), Edit(span_of("-1"), "-1", "1")
    assert [suggested(here), suggested(elsewhere), suggested(here, elsewhere)] == [1, 0, 0]


# -- JUnit -------------------------------------------------------------------------------------------------------------


def cases(run: Run) -> dict[str, str]:
    """The cases by name: passed, failure, error or skipped."""
    root = as_junit(render(run, "junit"))
    return {
        case.get("name"): next((e.tag for e in case if e.tag != "system-out"), "passed")
        for case in root.iter("testcase")
    }


def test_junit_has_a_case_for_each_element_and_each_rule_that_passed() -> None:
    rules = {"INR001": rule("INR001", "mass-not-positive"), "INR003": rule(), "COL001": rule("COL001", "collides")}
    rules["LCH001"] = rule("LCH001", "launch-unresolved", scopes=("launch",))
    made_both = finding(subjects=("link[a]", "link[b]"))
    assert cases(judged(a_run(made_both, rules=rules))) == {
        f"INR003 {finding().headline}: link[a]": "failure",
        f"INR003 {finding().headline}: link[b]": "failure",
        "INR001 mass-not-positive": "passed",
        "COL001 collides": "skipped",
    }


def test_junit_passes_nothing_that_was_not_looked_at() -> None:
    run = judged(replace(RUNS["needs arguments"], findings=(), skipped=()))
    assert cases(run) == {"the model is checked": "error"}
    accepted = replace(run, models=(replace(run.models[0], not_checked=NotChecked("why", accepted=True)),))
    assert cases(accepted) == {"the model is checked": "skipped"}
    stopped = judged(replace(a_run(), findings=(), skipped=(SkippedCheck("ALL", MODEL, "the check was stopped"),)))
    assert cases(stopped) == {"all rules": "skipped"}
    assert cases(RUNS["nothing to check"]) == {"there is something to check": "skipped"}


@pytest.mark.parametrize(("fail_on", "failures"), [("never", 0), ("error", 1), ("warning", 2), ("info", 3)])
def test_junit_fails_what_fails_the_run(fail_on: str, failures: int) -> None:
    found = cases(a_run(fail_on={MODEL: fail_on}, skipped=()))
    assert sorted(found.values()) == ["failure"] * failures + ["passed"] * (3 - failures)


def test_junit_tells_what_a_person_needs() -> None:
    root = as_junit(render(a_run(), "junit"))
    (failure,) = root.iter("failure")
    at = span_of("0.09")
    assert failure.get("message") == finding().message
    for said in (
        f"{FILE}:{at.line}:{at.col}",
        "> ",
        'izz="0.09"/>',
        "Why: a decimal point",
        "Then MuJoCo: refuses",
        "+",
    ):
        assert said in failure.text
    assert "mass-not-positive" in "".join(e.text for e in root.iter("system-out"))
    assert cases(RUNS["suppressed"])[f"INR003 {finding().headline}"] == "skipped"


# -- comment and summary -----------------------------------------------------------------------------------------------


def test_a_comment_begins_with_its_marker_and_the_verdict() -> None:
    lines = render(a_run(), "markdown").splitlines()
    assert lines[:2] == [MARKER, "### ❌ `rover`: 1 error to repair; MuJoCo refuses this model"]


def test_the_title_names_who_refuses_the_model() -> None:
    refused = dict.fromkeys(("mujoco", "drake"), "refuses the file")
    run = a_run(finding(consequences=refused))

    def title(run: Run) -> str:
        return render(run, "markdown").splitlines()[1].partition(": ")[2]

    assert title(run) == "1 error to repair; MuJoCo and Drake refuse this model"
    assert title(replace(run, targets=("drake", "gazebo"))) == "1 error to repair; Drake refuses this model"
    assert title(replace(run, targets=("gazebo",))) == "1 error to repair"
    # The other programs read it through urdfdom.
    assert title(a_run(finding(consequences={"urdfdom": "refuses"}))) == (
        "1 error to repair; urdfdom, Pinocchio, Gazebo and 3 more refuse this model"
    )
    note = finding(severity=Severity.INFO, consequences=refused)
    unlisted = replace(run, findings=(), unrequested=(note,))
    assert title(unlisted) == "No errors and no warnings · MuJoCo and Drake refuse this model: why is in the notes (-v)"
    assert render(unlisted, "markdown").splitlines()[1].startswith("### ℹ️ ")
    assert title(replace(run, findings=(finding(consequences={}),), unrequested=(note,))) == (
        "1 error to repair · MuJoCo and Drake refuse this model: why is in the notes (-v)"
    )
    two = replace(run, models=(*run.models, replace(run.models[0], id="b")))
    assert render(two, "markdown").splitlines()[1] == "### ❌ urdfcheck: 1 error to repair"


def test_twins_are_a_row_with_all_places() -> None:
    places = [span_of("-1"), span_of("0.09")]
    twins = [finding(location=Location(f"link[{i}]", at), related=()) for i, at in enumerate(places)]
    (row,) = (line for line in render(a_run(*twins), "markdown").splitlines() if "×2" in line)
    assert row.endswith("×2 (INR003) | `rover.urdf:7`, `:9` |")


def test_the_other_places_of_a_finding_are_in_its_details() -> None:
    twins = tuple(
        finding(headline=f"{name} is heavy", location=Location(f"link[{name}]", span_of(text)), related=())
        for name, text in (("left", "-1"), ("right", "0.09"))
    )
    document = render(a_run(replace(twins[0], headline="left and right are heavy", occurrences=twins)), "markdown")
    as_markdown(document)
    assert "right is heavy" in document.partition("<details>")[2]
    assert "<br>also " in document


def test_many_errors_and_warnings_are_folded() -> None:
    found = [finding(severity=Severity.WARNING, headline=f"it is {i} mm too long") for i in range(20)]
    document = render(a_run(*found), "markdown")
    head, _, rest = document.partition("<details>")
    assert head.count("too long") == 12
    assert rest.startswith("\n<summary>8 more errors and warnings</summary>")
    visible = len(re.sub(r"<details>.*?</details>", "", document, flags=re.DOTALL).splitlines())
    assert visible < 60
    assert "8 more errors" not in render_job_summary(a_run(*found)), "a summary has room"


@pytest.mark.parametrize("name", ["text", "github", "markdown"])
def test_a_launch_file_alone_is_counted_as_one(name: str) -> None:
    clean = replace(a_run(), models=(), findings=(), scenes=())
    text = render(clean, name)
    assert re.search(r"(in|·) 1 file\b", text)
    assert "Nothing was checked" not in text
    assert "1 file" not in render(replace(clean, units=0), name), "there was none"


def test_a_comment_tells_the_worst_first_and_folds_the_rest() -> None:
    document = render(a_run(), "markdown")
    assert [row[0] for row in rows_of(as_markdown(document)) if row[0]] == ["❌", "⚠️", "ℹ️"]
    assert document.index("| ⚠️ |") < document.index("<details>") < document.index("| ℹ️ |")
    assert document.index("<details>") < document.index("MuJoCo: refuses to compile")
    fences = {token.info: token.content for token in as_markdown(document) if token.type == "fence"}
    assert '-               iyy="0.01" iyz="0" izz="0.09"/>' in fences["diff"]


def test_a_comment_has_diffs_and_trees_while_it_is_short() -> None:
    """Each error and warning has its row and its explanation, however many there are; 60 lines are one page of a thread."""

    def count_fences(kinds: int) -> tuple[int, Counter[str]]:
        found = [finding(headline=f"it is {i} mm too long") for i in range(kinds)]
        document = render(a_run(*found), "markdown")
        assert document.count("mm too long (INR003)") == kinds, "a row each"
        assert document.count("- **❌ INR003") == kinds, "an explanation each"
        fences = Counter(token.info for token in as_markdown(document) if token.type == "fence")
        assert fences == Counter() or len(document.splitlines()) <= 60 + 1
        return len(document.splitlines()), fences

    assert count_fences(1) == (52, Counter(diff=1, mermaid=1))
    assert count_fences(3)[1] == Counter(diff=2)
    assert count_fences(16)[1] == Counter()


def test_a_comment_keeps_its_size_and_says_what_is_left_out() -> None:
    found = [
        finding(
            headline=f"wheel {i} is {'車輪 ' * 10}",
            message=f"{i}: {'a long word of 車輪 ' * 60}",
            severity=Severity(1 + i % 3),
            subjects=(f"link[{i}]",),
        )
        for i in range(600)
    ]
    document = render(a_run(*found, scenes=(chain(900),)), "markdown")
    assert len(document.encode()) < COMMENT_LIMIT
    tokens = as_markdown(document)
    assert document.count("<details>") == document.count("</details>")
    left = re.search(r"Left out.*: (\d+) explanations, (\d+) notes", document)
    assert left is not None
    signs = Counter(row[0] for row in rows_of(tokens) if row[0])
    assert signs["❌"] + signs["⚠️"] == 400, "each has a row"
    assert signs["ℹ️"] + int(left[2]) == 200


def test_a_summary_has_models_tree_and_the_place_of_the_report() -> None:
    document = render_job_summary(judged(a_run()), ("out/car.html",))
    tokens = as_markdown(document)
    assert "`out/car.html`" in document
    assert ["`rover/rover.urdf`", "`rover`", "2", "1", "0.5283 kg", "1", "1", "1"] in rows_of(tokens)
    assert MARKER not in document
    assert sum(token.info == "mermaid" for token in tokens) == 1


def test_a_tree_is_coloured_by_the_worst_finding() -> None:
    found = [finding(severity=Severity.INFO), finding(), finding(subjects=("joint[axle]",), severity=Severity.WARNING)]
    text = build_mermaid_chart(scene(), found).text
    assert re.search(r'n\d\["✖ wheel"\]:::error\n', text)
    assert re.search(r'n0\["base"\]\n', text)
    assert re.search(r'n0 -->\|"▲ axle \(continuous\)"\| n\d\n  linkStyle \d stroke:#9a6700\n', text)
    assert re.search(r'n0 -\.->\|"launch file"\| n\d\n', text)


@pytest.mark.parametrize("drawn", [chain(900), star(900)], ids=["deep", "wide"])
def test_a_tree_is_cut_where_mermaid_gives_up(drawn: Any) -> None:
    found = build_mermaid_chart(drawn, ())
    assert len(found.text) <= MOST_CHARACTERS
    assert found.text.count("-->") == found.shown - 1 == MOST_EDGES
    assert found.total > found.shown
    run = a_run(finding(), scenes=(drawn,))
    assert f"Drawn are {found.shown} of {found.total} links" in render_job_summary(run)


def test_a_loop_is_drawn_as_one() -> None:
    from output.runs import make_joint, make_link

    ring = scene(
        links=(make_link("a"), make_link("b")),
        joints=(make_joint("x", "a", "b"), make_joint("y", "b", "a")),
        root="a",
        frames=(),
    )
    text = build_mermaid_chart(ring, ()).text
    assert text.count('["') == 2
    assert text.count("-->") == 2


# -- the command -------------------------------------------------------------------------------------------------------


def test_two_reports_do_not_go_into_one_file_nor_over_a_model(tmp_path: Path) -> None:
    model = tmp_path / "robot.xml"
    model.write_text("<robot/>")
    (tmp_path / "link.json").symlink_to(tmp_path / "a.json")
    for words in (
        [f"json={tmp_path}/a.json", f"sarif={tmp_path}/./a.json"],
        [f"json={tmp_path}/a.json", f"sarif={tmp_path}/link.json"],
        [f"junit={model}"],
        [f"html={tmp_path}/other.urdf"],
    ):
        with pytest.raises(UrdfcheckError):
            parse_run_outputs(words, [str(model)])
    fine = [f"text={tmp_path}/a.txt", f"sarif={tmp_path}/a.sarif", "json=/dev/null", "html=/dev/null"]
    assert [name for name, _ in parse_run_outputs(fine, [str(model)])] == ["text", "sarif", "json", "html"]


def test_the_summary_of_a_job_is_appended_while_there_is_room(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "summary.md"
    monkeypatch.setenv("GITHUB_STEP_SUMMARY", str(file))
    assert job_summary.find_summary_file() == file
    file.write_text("another step\n")
    job_summary.append_summary(a_run(), (), file)
    assert file.read_text().startswith("another step\n### ❌ `rover`: 1 error to repair; MuJoCo refuses this model\n")
    file.write_text("x" * 999_000)
    job_summary.append_summary(a_run(), (), file)
    assert file.stat().st_size == 999_000
    monkeypatch.delenv("GITHUB_STEP_SUMMARY")
    assert job_summary.find_summary_file() is None
    with pytest.raises(UrdfcheckError, match="cannot write the summary"):
        job_summary.append_summary(a_run(), (), tmp_path)


def test_the_command_writes_all_formats_at_once(tmp_path: Path) -> None:
    (tmp_path / "rover.urdf").write_text(SOURCE)
    files = {name: f"out/rover.{name}" for name in FORMATS if name != "github"}
    outputs = [word for name, file in files.items() for word in ("-o", f"{name}={file}")]
    done = subprocess.run(
        [sys.executable, "-m", "urdfcheck", "rover.urdf", "--tier", "source", "--format", "github", *outputs],
        cwd=tmp_path,
        env={**os.environ, "GITHUB_STEP_SUMMARY": str(tmp_path / "summary.md")},
        capture_output=True,
        encoding="utf-8",
    )
    assert done.returncode == 1, done.stderr
    assert as_github(done.stdout)[0][1]["file"] == "rover.urdf"
    for name, reader in READERS.items():
        if name != "github":
            reader((tmp_path / files[name]).read_text(encoding="utf-8"))
    summary = (tmp_path / "summary.md").read_text(encoding="utf-8")
    as_markdown(summary)
    assert "flowchart" in summary
    assert "`out/rover.html`" in summary
