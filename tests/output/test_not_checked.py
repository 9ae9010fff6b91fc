"""What was not checked: every format says so before it says what is clean, with the command that helps."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest
from output.runs import ACCEPTED, MODEL, NOT_CHECKED, UNUSED_MACROS, a_run, info

from urdfcheck.cli import FINDINGS, OK, compute_exit_code
from urdfcheck.core import ModelInfo, NotChecked, Run, SkippedCheck
from urdfcheck.output import FORMATS, render, text
from urdfcheck.output.html.report_folder import iter_report_pages
from urdfcheck.output.markdown import render_job_summary
from urdfcheck.output.shared.verdict.not_checked import build_command, group_unchecked
from urdfcheck.output.shared.verdict.verdict import summarize_verdict

COMMAND = "urdfcheck arm.urdf.xacro --arg side:=…"


def last_line(run: Run) -> str:
    return text.render(run, width=200).splitlines()[-1]


# -- terminal ----------------------------------------------------------------------------------------------------------


def test_the_last_line_says_first_what_was_not_checked() -> None:
    line = last_line(NOT_CHECKED)
    assert line.startswith("⊘ 1 of 2 models and 1 macro file were not checked · ✖ 1 error")
    assert last_line(ACCEPTED).startswith("⊘ 1 of 2 models (accepted) and 1 macro file were not checked · ▲ 1 warning")


@pytest.mark.parametrize("detail", text.DetailLevel)
def test_the_command_that_helps_can_be_copied_from_a_line_of_its_own(detail: text.DetailLevel) -> None:
    shown = text.render(NOT_CHECKED, width=40, detail=detail)
    assert f"\n  {COMMAND}\n" in shown
    assert "--unchecked warning" in shown
    assert "--unchecked warning" not in text.render(ACCEPTED, detail=detail), "it is accepted already"
    assert f"\n  {COMMAND}\n" in text.render_statistics(NOT_CHECKED, width=40)


def test_no_findings_is_never_said_where_something_was_not_checked() -> None:
    clean = replace(UNUSED_MACROS, unused_macro_files=())
    assert last_line(clean).startswith("✔ no errors, no warnings · 1 model")
    passed_over = replace(clean, skipped=(SkippedCheck("ALL", "wheel.stl", "no model names this mesh"),))
    launched = replace(clean, skipped=(SkippedCheck(SkippedCheck.LAUNCHED_MODEL, "a.launch", "only at launch", True),))
    unread = replace(clean, models=(info(status="failed"),))
    for run, begin in (
        (UNUSED_MACROS, "⊘ 1 macro file is used by no checked model and was not checked"),
        (passed_over, "⊘ 1 other path was not checked"),
        (launched, "⊘ 1 launched model was not checked"),
        (unread, "⊘ 1 of 1 model was not checked"),
    ):
        assert last_line(run).startswith(begin)
        assert "✔" not in text.render(run)


def test_a_model_whose_errors_are_set_aside_has_no_tick() -> None:
    clean = replace(UNUSED_MACROS, unused_macro_files=())
    skipped = (SkippedCheck(SkippedCheck.FINDINGS, "other.urdf", "no file names it", is_partial=True),)
    two = replace(clean, models=(*clean.models, info(id="other.urdf", path="other.urdf")))
    aside = replace(two, skipped=skipped)
    assert last_line(two).startswith("✔ no errors, no warnings · 2 models")
    assert last_line(aside).startswith("✔ no errors, no warnings · 2 models, 1 set aside")
    badge, tick = '<span class="badge unchecked">set aside</span>', '<span class="badge ok">'
    assert tick in render(two, "html")
    page = render(aside, "html")
    assert (page.count(tick), page.count(badge)) == (0, 1), "one part is drawn: its row has links to its sections"
    assert "Errors and warnings are not listed: no file names it." in page
    index = dict(iter_report_pages(aside))["index.html"]
    assert "checked, set aside" in index
    assert "set aside" not in dict(iter_report_pages(two))["index.html"]


@pytest.mark.parametrize("format_name", ["concise", "agent", "text", "markdown", "sarif", "junit", "json"])
def test_a_model_that_only_the_launch_knows_is_named_with_the_reason(format_name: str) -> None:
    skip = SkippedCheck(SkippedCheck.LAUNCHED_MODEL, "a.launch", "known only at launch", is_partial=True)
    run = replace(UNUSED_MACROS, unused_macro_files=(), skipped=(skip,), unit_ids=frozenset({"a.launch"}))
    shown = render(run, format_name)
    assert "known only at launch" in shown
    assert "a.launch" in shown or format_name in {"sarif", "junit"}


def test_models_with_one_reason_are_named_together() -> None:
    first = NOT_CHECKED.models[0]
    others = tuple(replace(first, path=f"{i}.xacro", id=f"{i}.xacro") for i in range(9))
    shown = text.render(replace(NOT_CHECKED, models=(first, *others)), width=200)
    assert shown.count("argument side has no default\n") == 2, "at its place, and for the models"
    assert "⊘ arm.urdf.xacro, 0.xacro, 1.xacro and 7 more\n" in shown


def test_the_command_repeats_the_arguments_and_is_quoted_for_the_shell() -> None:
    model = replace(NOT_CHECKED.models[0], path="my arm.xacro", args={"b": "2 3", "a": "1"})
    assert build_command(model) == "urdfcheck 'my arm.xacro' --arg a:=1 --arg 'b:=2 3' --arg side:=…"
    assert build_command(replace(model, not_checked=NotChecked("broken"))) == "", "no option helps a broken file"
    given = replace(model, args={"side": "up", "tool": ""})
    assert build_command(given) == "urdfcheck 'my arm.xacro' --arg tool:= --arg side:=…", "one value for each argument"


def test_the_command_checks_all_models_with_the_reason() -> None:
    first = NOT_CHECKED.models[0]
    others = [replace(first, path=path, id=path) for path in ("b/c.xacro", "b/my d.xacro", "b/e.xacro")]

    def build(*models: ModelInfo) -> str:
        (group,) = group_unchecked(models)
        return group.command

    assert build(first, others[0]) == "urdfcheck arm.urdf.xacro b/c.xacro --arg side:=…"
    assert build(*others) == "urdfcheck b/c.xacro 'b/my d.xacro' b/e.xacro --arg side:=…"
    assert build(*others, replace(first, path="b/f.xacro")) == "urdfcheck b --arg side:=…", (
        "many are named by their folder"
    )
    assert build(first, *others) == "urdfcheck . --arg side:=…"
    assert build(first, replace(first, args={"side": "left"})) == "urdfcheck arm.urdf.xacro --arg side:=…"


# -- exit code ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("run", "fail_on", "code"),
    [
        (NOT_CHECKED, "error", FINDINGS),
        (NOT_CHECKED, "never", OK),
        (ACCEPTED, "error", OK),
        (ACCEPTED, "warning", FINDINGS),
        (UNUSED_MACROS, "info", OK),
    ],
)
def test_a_model_that_was_not_checked_decides_the_exit_code_whatever_the_findings_are(
    run: Run, fail_on: str, code: int
) -> None:
    assert compute_exit_code(run, fail_on) == code
    assert compute_exit_code(replace(run, findings=()), fail_on) == code
    assert compute_exit_code(replace(run, fail_on={m.id: fail_on for m in run.models}), "error") == code


# -- the other formats -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("output_format", FORMATS)
@pytest.mark.parametrize("run", [NOT_CHECKED, ACCEPTED])
def test_every_format_names_the_model_the_reason_and_the_command(run: Run, output_format: str) -> None:
    document = render(run, output_format).replace("%3A", ":")
    for words in ("arm.urdf.xacro", "argument side has no default", "--arg side:=…"):
        assert words in document, words
    assert "no findings in" not in document


def test_the_verdict_is_never_ok_where_something_was_not_checked() -> None:
    assert summarize_verdict(NOT_CHECKED) == (
        "unchecked",
        "1 of 2 models and 1 macro file were not checked. 1 error to repair",
    )
    assert summarize_verdict(UNUSED_MACROS)[0] == "unchecked"
    assert summarize_verdict(replace(a_run(), unused_macro_files=("a.xacro",)))[0] == "error"
    assert render(NOT_CHECKED, "markdown").splitlines()[1].startswith("### ⊘ urdfcheck: 1 of 2 models")
    accepting = "To accept that: `--unchecked warning`, or `unchecked = [PATTERNS]` in urdfcheck.toml"
    assert accepting in render(NOT_CHECKED, "markdown").splitlines(), "each can be copied as it stands"
    assert "| ⊘ not checked: needs arguments |" in render_job_summary(NOT_CHECKED)


def test_json_says_why_and_what_helps() -> None:
    for run, accepted in ((NOT_CHECKED, False), (ACCEPTED, True)):
        report = json.loads(render(run, "json"))
        unread, read = report["models"]
        assert unread["not_checked"] == {
            "reason": "argument side has no default",
            "command": COMMAND,
            "accepted": accepted,
        }
        assert read["not_checked"] is None
        assert report["summary"]["not_checked"] == 1
        assert report["unused_macro_files"] == ["wheel.xacro"]


@pytest.mark.parametrize(("run", "successful", "level"), [(NOT_CHECKED, False, "error"), (ACCEPTED, True, "warning")])
def test_sarif_notifies_of_the_model_and_of_the_macro_files(run: Run, successful: bool, level: str) -> None:
    (invocation,) = json.loads(render(run, "sarif"))["runs"][0]["invocations"]
    assert invocation["executionSuccessful"] is successful
    first, second = invocation["toolExecutionNotifications"]
    assert first["level"] == level
    assert COMMAND in first["message"]["text"]
    assert second["level"] == "note"
    assert second["locations"][0]["physicalLocation"]["artifactLocation"]["uri"] == "wheel.xacro"


def test_the_pages_have_no_green_tick_beside_such_a_model() -> None:
    """Neither in the index nor in the report, and even without a finding."""
    bare = replace(NOT_CHECKED, findings=())
    pages = dict(iter_report_pages(bare))
    index = pages["index.html"]
    (row,) = (line for line in index.splitlines() if 'data-status="needs-arguments"' in line)
    assert '<tr class="unchecked"' in row
    assert "#g-unchecked" in row
    assert "What was not checked" in index
    assert COMMAND in index
    assert "wheel.xacro" in index
    body = index.partition("</defs>")[2]
    assert '<p class="verdict unchecked">' in body
    whole = render(bare, "html").partition("</defs>")[2]
    assert '<p class="verdict unchecked">' in whole
    navigation = whole.split("<nav")[1].split("</nav>")[0]
    (entry,) = (item for item in navigation.split("<li>") if "arm.urdf.xacro" in item)
    assert "#g-unchecked" in entry
    assert "#g-ok" not in entry
    page = next(page for name, page in pages.items() if name.startswith("arm")).partition("</defs>")[2]
    assert "#g-ok" not in page
    assert MODEL.replace("/", "/<wbr>") in index
