"""The terminal report: readable at 80 columns and in a CI log, and nothing in a name can act on it."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest
from output.runs import FILE, MODEL, SOURCE, a_run, finding, span_of
from rich.cells import cell_len
from rich.text import Text

from urdfcheck.core import Applicability, Cause, Edit, Finding, Fix, Location, Severity, SkippedCheck
from urdfcheck.output.text import DetailLevel, render, render_statistics
from urdfcheck.output.text.fix_words import wrap_words


def test_a_finding_begins_with_its_headline_and_then_its_place() -> None:
    lines = render(a_run(finding())).splitlines()
    title = lines.index("✖ INR003 wheel: no body can have this inertia (12 % short)")
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


def test_no_colour_unless_asked_for() -> None:
    assert "\x1b[" not in render(a_run())
    assert "\x1b[" in render(a_run(), color=True)


def test_in_a_terminal_the_code_of_a_rule_is_a_link_to_its_page(monkeypatch: pytest.MonkeyPatch) -> None:
    assert "\x1b]8;" not in render(a_run(), color=True)  # there is no page yet
    monkeypatch.setattr("urdfcheck.version.SITE", "https://example.org/")
    linked = re.findall(
        r"\x1b\]8;[^;]*;(.+?)\x1b\\\x1b\[[\d;]*m(.+?)\x1b\[0m\x1b\]8;;\x1b", render(a_run(), color=True)
    )
    assert ("https://example.org/rules/INR003/", "INR003") in linked
    assert all(address.split("/")[-2] == code for address, code in linked)
    assert "example.org" not in render(a_run())


@pytest.mark.parametrize("width", [40, 100])
def test_colour_changes_nothing_but_the_colour(width: int) -> None:
    colored = render(a_run(), width=width, color=True)
    assert "\x1b[1;31m✖ " in colored
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
    counts = "✖ 1 error · ▲ 1 warning · 1 note"
    assert render(a_run(), detail=DetailLevel.BRIEF).splitlines()[-1] == f"{counts} (-v) · 1 model · 0.2 s"
    assert render(a_run()).splitlines()[-1] == f"{counts} · 1 model · 0.2 s"  # they are printed


def test_the_last_line_counts_notes_that_nobody_asked_for() -> None:
    line = render(replace(a_run(), findings=(), more_notes=2), detail=DetailLevel.BRIEF).splitlines()[-1]
    assert line == "✔ no errors, no warnings (2 notes: -v) · 1 model · 0.2 s"


@pytest.mark.parametrize(("findings", "notes"), [((finding(severity=Severity.INFO),), "1+ notes"), ((), "notes")])
def test_the_last_line_says_that_notes_were_not_looked_for(findings: tuple[Finding, ...], notes: str) -> None:
    run = replace(a_run(), findings=findings, postponed=frozenset({"COL002"}))
    line = render(run, detail=DetailLevel.BRIEF).splitlines()[-1]
    assert line == f"✔ no errors, no warnings ({notes}: -v) · 1 model · 0.2 s"


def test_a_pass_looks_like_a_pass() -> None:
    notes = a_run(finding(severity=Severity.INFO), finding(severity=Severity.INFO, code="INR001"))
    brief = render(notes, detail=DetailLevel.BRIEF)
    assert brief.splitlines()[-1] == "✔ no errors, no warnings (2 notes: -v) · 1 model · 0.2 s"
    assert render(a_run()).splitlines()[-1].startswith("✖")
    assert render(replace(a_run(), findings=())).splitlines()[-1] == "✔ no errors, no warnings · 1 model · 0.2 s"


def test_no_line_ends_in_blanks() -> None:
    assert not [line for line in render(a_run()).splitlines() if line != line.rstrip()]


def test_a_run_without_rules_is_not_called_clean() -> None:
    text = render(replace(a_run(), findings=(), rules={}))
    assert "✔" not in text
    assert "no rule is selected" in text


def test_in_brief_the_infos_of_a_rule_are_a_line() -> None:
    infos = [finding(severity=Severity.INFO, message="a word " * 60) for _ in range(3)]
    other = finding(severity=Severity.INFO, code="INR001", headline="the mass is round")
    lines = render(a_run(*infos, other), width=60, detail=DetailLevel.BRIEF).splitlines()
    first, second = (line for line in lines if line.startswith("i "))
    assert re.fullmatch(r"i INR003 wheel: no body can have… \(\+2 more\)  rover.urdf:\d+", first), "the file is named"
    assert re.fullmatch(r"i INR001 the mass is round  rover.urdf:\d+", second)
    assert len(first) <= 60
    assert "put the point back" in render(a_run(*infos))


def test_in_brief_a_finding_is_what_is_wrong_where_who_minds_and_the_repair() -> None:
    lines = render(a_run(finding()), detail=DetailLevel.BRIEF).splitlines()
    at = lines.index("✖ INR003 wheel: no body can have this inertia (12 % short)")
    assert re.match(rf"  --> {re.escape(FILE)}:\d+:\d+  \(also :\d+\)$", lines[at + 1])
    assert lines[at + 2] == "  = effect MuJoCo refuses to compile · Drake replaces the inertia"
    assert lines[at + 3] == "  = fix    put the point back [--fix --unsafe-fixes]"
    # The repair shows the code: whole attributes, and the number of the line.
    assert re.fullmatch(r' +\d+ - iyy="0.01" iyz="0" izz="0.09"/>', lines[at + 4])
    assert re.fullmatch(r' +\d+ \+ iyy="0.01" iyz="0" izz="0.019"/>', lines[at + 5])
    assert lines[at + 6] == ""


def test_in_brief_what_programs_do_is_told_once_for_a_rule() -> None:
    weak = [finding(severity=Severity.WARNING, message=message) for message in ("one", "another")]
    assert render(a_run(*weak), detail=DetailLevel.BRIEF).count("= effect") == 1


def test_in_brief_each_error_says_what_programs_do() -> None:
    text = render(a_run(finding(), finding(message="another")), detail=DetailLevel.BRIEF)
    assert text.count("= effect MuJoCo refuses to compile") == 2


def test_in_brief_loading_a_model_as_typed_is_no_news() -> None:
    run = a_run(finding(consequences={"rviz": "loads it as typed", "mujoco": "loads it"}))
    assert "= effect" not in render(run, detail=DetailLevel.BRIEF)


def test_in_brief_the_message_stands_where_there_is_no_code() -> None:
    nowhere = finding(location=Location("this run", None), message="a word " * 60)
    lines = render(a_run(nowhere), detail=DetailLevel.BRIEF).splitlines()
    at = next(i for i, line in enumerate(lines) if line.startswith("  --> "))
    assert lines[at + 1].startswith("  a word")
    assert lines[at + 2].endswith(" …")
    assert lines[at + 3].startswith("  = ")


def test_in_brief_a_short_message_is_the_label_of_the_code() -> None:
    text = render(a_run(finding(message="too large")), detail=DetailLevel.BRIEF)
    assert re.search(r"\^+ too large$", text, re.MULTILINE)


def test_the_worst_stands_last() -> None:
    weak = finding(severity=Severity.WARNING, code="AAA001")
    refused = finding(code="BBB001", consequences={"mujoco": "refuses it", "drake": "refuses it"})
    error = finding(code="CCC001", consequences={})
    text = render(a_run(refused, weak, error), detail=DetailLevel.BRIEF)
    assert text.index("AAA001") < text.index("CCC001") < text.index("BBB001")


def test_what_was_skipped_for_some_models_names_them() -> None:
    skips = (SkippedCheck("MSH002", MODEL, "no meshes here"), SkippedCheck("COL001", MODEL, "no meshes here"))
    one = a_run(skipped=skips)
    assert "skipped COL001, MSH002: no meshes here\n" in render(one)
    two = replace(one, models=(*one.models, replace(one.models[0], id="other.urdf")))
    assert f"skipped COL001, MSH002: no meshes here ({MODEL})\n" in render(two)


def test_a_long_report_repeats_its_errors_with_their_lines() -> None:
    headline = "a claim of seventy characters about the one file that was checked, cut"
    text = render(a_run(*(finding(headline=headline, code=f"AAA00{n}") for n in range(9))), width=80)
    repeated = text.partition("errors and warnings")[2].splitlines()[1:10]
    assert all(re.fullmatch(r"✖ AAA00\d a claim .*…  line \d+", line) for line in repeated), repeated


def test_a_file_that_was_not_checked_at_all_is_told_by_its_name() -> None:
    part = SkippedCheck("ALL", "part.xacro", "is not checked: no model is made of it")
    quiet = SkippedCheck(SkippedCheck.WARNINGS, "old.urdf", "it is kept aside", is_partial=True)
    silent = SkippedCheck(SkippedCheck.FINDINGS, "older.urdf", "it is an old copy", is_partial=True)
    lines = render(replace(a_run(), skipped=(part, quiet, silent))).splitlines()
    assert "not checked (part.xacro): no model is made of it" in lines
    assert "warnings not listed (old.urdf): it is kept aside" in lines
    assert "errors and warnings not listed (older.urdf): it is an old copy" in lines


def test_in_brief_what_matters_stands_below_the_infos_of_its_model() -> None:
    first = finding(severity=Severity.INFO, code="AAA001")
    text = render(a_run(first, finding(code="ZZZ001")), detail=DetailLevel.BRIEF)
    assert text.index("AAA001") < text.index("ZZZ001"), "the reader is at the end"


def test_quiet_is_errors_warnings_what_failed_and_one_line() -> None:
    text = render(replace(a_run(), failures=("it broke",)), detail=DetailLevel.QUIET)
    assert [line.split(": ")[1] for line in text.splitlines()[:2]] == ["warning INR001 wheel", "error INR003 wheel"]
    assert " info " not in text
    assert "skipped" not in text
    assert "fixable" not in text
    assert text.splitlines()[-2:] == [
        "not checked: it broke",
        "⊘ not finished: 1 failure · ✖ 1 error · ▲ 1 warning · 1 note (-v) · 1 model · 0.2 s",
    ]


@pytest.mark.parametrize(("detail", "told"), [(DetailLevel.BRIEF, "put the point back"), (DetailLevel.QUIET, "INR003")])
def test_an_info_that_fails_the_run_is_told_like_a_warning(detail: DetailLevel, told: str) -> None:
    run = a_run(finding(severity=Severity.INFO))
    assert told not in render(run, detail=detail)
    assert told in render(run, detail=detail, fail_on="info")
    assert told in render(replace(run, fail_on={MODEL: "info"}), detail=detail)


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
    assert "2 notes" in lines[-1]


def test_in_brief_a_finding_takes_at_most_eight_lines() -> None:
    """One of several elements, that several programs mind, with a long repair of many lines."""
    edits = tuple(Edit(span_of(word), word, "x") for word in ('"base"', '"-1"', '"0.09"', '"axle"'))
    long = finding(
        fix=Fix("write the computed numbers anew " * 30, Applicability.UNSAFE, edits),
        subjects=("link[a]", "link[b]"),
        message="long " * 50,
    )
    lines = render(a_run(long), width=80, detail=DetailLevel.BRIEF).splitlines()
    at = next(i for i, line in enumerate(lines) if line.startswith("✖ INR003"))
    end = lines.index("", at)
    assert 7 <= end - at <= 8
    assert lines[end - 1].endswith(" [4 lines: --diff --unsafe-fixes]"), "the option is at the end of the words"


def test_in_brief_words_that_the_change_shows_are_left_out() -> None:
    edit = Edit(span_of('"0.09"'), '"0.09"', '"0.019"')
    fix = Fix('if that is the mistake, write izz="0.019"; otherwise export it again', Applicability.UNSAFE, (edit,))
    text = render(a_run(finding(fix=fix)), detail=DetailLevel.BRIEF)
    assert "= fix    if that is the mistake, apply the diff below; otherwise export it again" in text
    other = replace(fix, title='write izz="0.018" or the like')
    assert 'write izz="0.018" or the like' in render(a_run(finding(fix=other)), detail=DetailLevel.BRIEF)


def test_in_brief_the_option_never_cuts_the_words() -> None:
    edit = Edit(span_of('"0.09"'), '"0.09"', '"0.019"')
    words = "this is a line of a repair that takes all of the columns that there are, or so"
    lines = render(a_run(finding(fix=Fix(words, Applicability.UNSAFE, (edit,)))), width=95, detail=DetailLevel.BRIEF)
    at = next(i for i, line in enumerate(lines.splitlines()) if "= fix" in line)
    assert lines.splitlines()[at].endswith(words)
    assert lines.splitlines()[at + 1].strip() == "[--fix --unsafe-fixes]", "above the changed lines, never behind one"
    assert max(map(len, lines.splitlines())) <= 95


@pytest.mark.parametrize(
    ("words", "end"),
    [
        ("for one use another plugin; for two use yet another; " + "for three use none " * 9, "use yet another; …"),
        (
            "take one of the shapes that are meant, or " + 'write xyz="1 2 3 4 5 6 7 8 9 10 11 12 13 14 15" and ' * 3,
            '" …',
        ),
        ("one of the words is in (brackets that have no end at all and are not cut, whatever " * 3, "the words is …"),
    ],
)
def test_a_long_repair_ends_with_a_clause(words: str, end: str) -> None:
    lines = wrap_words(words, 60, Text("  = fix    "), 2)
    assert " ".join(" ".join(line.plain for line in lines).split()).endswith(end)
    assert len(lines) <= 2


def test_a_tag_is_not_broken_between_lines() -> None:
    words = (
        'delete the lines and give the <visual>s a <material name="…"><color rgba="…"/></material>, which RViz reads'
    )
    for width in range(64, 100):
        lines = [line.plain.strip() for line in wrap_words(words, width, Text("  = fix    "), 4)]
        assert not [line for line in lines if line.endswith(("<color", "<material"))]
        assert " ".join(lines).removeprefix("= fix    ") == words


def test_in_brief_a_repair_has_the_lines_that_remain() -> None:
    words = (
        "if the left one is correct, write a in the right one; if the right one is correct, write b in the left one; "
        "otherwise measure both of them again, and write what is measured"
    )
    text = render(a_run(finding(fix=Fix(words, Applicability.DISPLAY, ()))), width=80, detail=DetailLevel.BRIEF)
    fix = text.partition("= fix")[2].partition("\n\n")[0]
    assert " ".join(fix.split()) == words


def test_in_brief_an_element_of_several_lines_is_shown_in_one() -> None:
    typed = SOURCE.index("<inertia ")
    end = SOURCE.index("/>", typed) + 2
    span = replace(span_of("<inertia "), end=end, end_line=span_of("<inertia ").line + 1)
    lines = render(a_run(finding(location=Location("x", span), fix=None)), detail=DetailLevel.BRIEF).splitlines()
    assert any(re.search(r"\d+ │ <inertia ixx=.* iyz=\S+ izz=\S+/>$", line) for line in lines)


def test_in_brief_nothing_is_named_twice() -> None:
    here = finding().location
    text = render(
        a_run(finding(headline="a, b: too heavy", subjects=("link[a]", "link[b]"), related=(here,))),
        detail=DetailLevel.BRIEF,
    )
    assert "= for" not in text
    assert "also" not in text
    plugins = ("gazebo[6]/plugin[x]", "gazebo[7]/plugin[y]")
    assert "= for" not in render(a_run(finding(subjects=plugins)), detail=DetailLevel.BRIEF), "6 and 7 are no names"


def test_in_brief_a_line_adds_what_the_headline_only_counts() -> None:
    subjects = tuple(f"joint[{name}]" for name in ("hip", "knee", "ankle", "toe"))
    for headline, line in (
        ("hip, knee and 2 more: effort 0", "  = and    ankle, toe"),
        ("4 joints have effort 0", "  = for    hip, knee, ankle and 1 more"),
    ):
        text = render(a_run(finding(headline=headline, subjects=subjects)), detail=DetailLevel.BRIEF)
        assert line in text.splitlines()


def test_in_brief_a_message_that_repeats_the_headline_is_left_out() -> None:
    one = finding(
        headline="2 joints have effort limit 0: a, b", message="2 joints have effort=0 (a, b): no torque", fix=None
    )
    assert "no torque" not in render(a_run(one), detail=DetailLevel.BRIEF)
    other = replace(one, message="a typing mistake?")
    assert "^ a typing mistake?" in render(a_run(other), detail=DetailLevel.BRIEF)


def test_a_long_line_keeps_the_file_name_and_no_number_in_part() -> None:
    path = f"package://robot/{'folder/' * 12}torso.dae"
    numbers = " ".join(f'i{i}="0.12345678"' for i in range(19))
    source = f'<robot>\n  <mesh filename="{path}"/>\n  <inertia {numbers}/>\n</robot>'
    for typed, end in ((path, "torso.dae…"), (source.splitlines()[2].strip(), '0.12345678" …')):
        start = source.index(typed)
        line = source[:start].count("\n") + 1
        col = start - source.rfind("\n", 0, start)
        span = replace(span_of("<robot"), file=FILE, start=start, end=start + len(typed), line=line, end_line=line)
        span = replace(span, col=col, end_col=col + len(typed))
        run = replace(a_run(finding(location=Location("x", span), fix=None)), sources={FILE: source})
        for width in (60, 80):
            lines = render(run, width=width, detail=DetailLevel.BRIEF).splitlines()
            code = next(text for text in lines if text.startswith(f"  {line} │"))
            assert code.endswith(end)
            assert len(code) <= width
            marks = lines[lines.index(code) + 1]
            assert "^" in marks
            assert len(marks) <= width


def test_in_brief_a_long_element_is_in_two_lines_instead_of_marks_below_all_of_it() -> None:
    typed = '<inertia ixx="0.0053694" ixy="0.0014185" ixz="-0.00092094" iyy="0.0032423" iyz="-0.0016917" izz="0.005"/>'
    source = f"<robot>\n      {typed}\n</robot>\n"
    start = source.index(typed)
    span = replace(span_of("<robot"), file=FILE, start=start, end=start + len(typed), line=2, end_line=2)
    span = replace(span, col=7, end_col=7 + len(typed))
    run = replace(a_run(finding(location=Location("x", span), fix=None)), sources={FILE: source})
    lines = render(run, width=80, detail=DetailLevel.BRIEF).splitlines()
    at = next(i for i, line in enumerate(lines) if line.startswith("  2 │ <inertia"))
    assert lines[at + 1].startswith("    │   ")
    assert " ".join(line.partition("│ ")[2].strip() for line in lines[at : at + 2]) == typed


def test_in_brief_the_option_shares_the_last_line_of_words_that_are_cut() -> None:
    lines = [
        line.plain for line in wrap_words("write this; " * 40, 60, Text("  = fix    "), 2, "[--fix --unsafe-fixes]")
    ]
    assert len(lines) == 2
    assert lines[-1].endswith("; … [--fix --unsafe-fixes]")


def test_in_brief_places_are_counted_as_places() -> None:
    related = tuple(
        Location(f"link[{i}]", span_of(word))
        for i, word in enumerate(("<robot", "<link", '"base"', "<joint", "</robot>"))
    )
    assert re.search(
        r"also :\d+, :\d+, :\d+ and \d more places?\)",
        render(a_run(finding(related=related)), detail=DetailLevel.BRIEF),
    )


def test_in_brief_names_and_places_share_a_line_if_they_fit() -> None:
    where = Location("link[a]", replace(span_of('"base"'), file="a_long_folder/" * 6 + "a.urdf"))
    others = tuple(replace(where, span=replace(span_of(word), file=where.file)) for word in ('"-1"', '"axle"'))
    one = finding(location=where, subjects=("link[first]", "link[second]"), related=others)
    merged = replace(one, occurrences=(one, replace(one, location=others[0])))
    text = render(a_run(merged), width=80, detail=DetailLevel.BRIEF)
    assert re.search(r"= for    first, second  \(also :\d+, :\d+\)$", text, re.MULTILINE)
    narrow = replace(merged, subjects=tuple(f"link[{'first' * 9}{i}]" for i in range(5)))
    text = render(a_run(narrow), width=80, detail=DetailLevel.BRIEF)
    assert re.search(r"= for    \w+0 and 4 more\n  = also   :\d+, :\d+$", text, re.MULTILINE)


@pytest.mark.parametrize("width", [1, 10, 12, 20, 31])
def test_in_brief_a_terminal_may_be_narrow(width: int) -> None:
    many = finding(
        subjects=("link[a]", "link[b]"), fix=Fix('write izz="0.019" ' * 9, Applicability.UNSAFE, finding().fix.edits)
    )  # type: ignore[union-attr]
    text = render(a_run(finding(), many, finding(severity=Severity.INFO)), width=width, detail=DetailLevel.BRIEF)
    assert text.count("--fix --unsafe-fixes]") + text.count("[1 line: --diff --unsafe-fixes]") == 2
