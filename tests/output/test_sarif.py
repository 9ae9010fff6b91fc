"""SARIF keeps to its schema and to what GitHub's code scanning asks for, and says all that the report says."""

from __future__ import annotations

import copy
import gzip
import json
import re
from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import jsonschema
import pytest
from conftest import FIXTURES, check
from output.runs import FILE, SOURCE, a_run, finding, info, rule, span_of

from urdfcheck.core import Applicability, Edit, Fix, Location, Run, SkippedCheck, Span, Suppression
from urdfcheck.core.merging import list_line_entries
from urdfcheck.fix.patch import EditableText
from urdfcheck.output import sarif
from urdfcheck.output.sarif import render
from urdfcheck.policy.baseline import Baseline
from urdfcheck.source.text.xml import SourceFile

SCHEMA = json.loads((Path(__file__).parent / "sarif-2.1.0.json").read_text(encoding="utf-8"))
VALIDATOR = jsonschema.Draft202012Validator(SCHEMA)


def sarif_of(run: Run) -> Any:
    """The one run of a log that the schema and GitHub take."""
    text = render(run)
    log = json.loads(text)
    VALIDATOR.validate(log)
    assert list(refused(log)) == []
    assert len(gzip.compress(text.encode())) < 10 * 10**6
    return log["runs"][0]


def results(run: Run) -> Any:
    return sarif_of(run)["results"]


# -- what GitHub's documentation of code scanning asks for -------------------------------------------------------------


def refused(log: Any) -> Iterator[str]:
    """What GitHub would refuse, or not show, of a log that the schema takes."""
    for run in log["runs"]:
        for described in run["tool"]["driver"]["rules"]:
            texts = [described.get(key, {}).get("text", "") for key in ("shortDescription", "fullDescription", "help")]
            if not described["id"] or not all(texts):
                yield "a required text of a rule is missing"
            if max(map(len, texts[:2])) > 1024 or len(described.get("name", "")) > 255:
                yield "a description is too long"
            properties = described.get("properties", {})
            if len(properties.get("tags", ())) > 20:
                yield "too many tags"
            if properties.get("precision") not in {"very-high", "high", "medium", "low"}:
                yield "no precision"
            if properties.get("problem.severity") not in {"error", "warning", "recommendation"}:
                yield "no severity of a rule"
        rules = [described["id"] for described in run["tool"]["driver"]["rules"]]
        if len(run["results"]) > 25_000:
            yield "too many results"
        for number, result in enumerate(run["results"]):
            yield from (f"result {number}: {reason}" for reason in _refused(result, rules))


def _refused(result: Any, rules: list[str]) -> Iterator[str]:
    if not result.get("ruleId") or not result["message"].get("text"):
        yield "no rule or no message"
    if "ruleIndex" in result and rules[result["ruleIndex"]] != result["ruleId"]:
        yield "its rule is another one"
    related, flows = result.get("relatedLocations", []), result.get("codeFlows", [])
    if not result.get("locations"):
        yield "expected at least one location"
    if len(result.get("locations", [])) + len(related) > 1000:
        yield "too many locations"
    steps = [step["location"] for flow in flows for thread in flow["threadFlows"] for step in thread["locations"]]
    if len(steps) > 10_000:
        yield "too many steps"
    for location in (*result.get("locations", []), *related, *steps):
        place = location.get("physicalLocation", {})
        uri = place.get("artifactLocation", {}).get("uri", "")
        if not re.fullmatch(r"(?!/)(?:[A-Za-z0-9._~/-]|%[0-9A-F]{2})+", uri):
            yield f"{uri!r} is no relative path"
        region = place.get("region", {})
        if {"startLine", "startColumn", "endLine", "endColumn"} - set(region):
            yield "no region"
        elif (region["startLine"], region["startColumn"]) > (region["endLine"], region["endColumn"]):
            yield "the region ends before it starts"
    ids = [location["id"] for location in related]
    if [
        link
        for link in re.findall(r"\[(?:[^\[\]\\]|\\.)*\]\((.*?)\)", result["message"]["text"])
        if int(link) not in ids
    ]:
        yield "a link leads nowhere"


BREAKS: dict[str, Callable[[Any], object]] = {
    "expected at least one location": lambda run: run["results"][0].pop("locations"),
    "no rule": lambda run: run["results"][0].update(ruleId=""),
    "its rule is another one": lambda run: run["results"][0].update(ruleIndex=0),
    "no message": lambda run: run["results"][0].update(message={"text": ""}),
    "is no relative path": lambda run: _place(run).update(artifactLocation={"uri": "my robot.urdf"}),
    "no region": lambda run: _place(run).pop("region"),
    "ends before": lambda run: _place(run)["region"].update(endLine=1),
    "a link leads nowhere": lambda run: run["results"][0].pop("relatedLocations"),
    "too many locations": lambda run: run["results"][0].update(locations=run["results"][0]["locations"] * 1001),
    "too many results": lambda run: run.update(results=run["results"] * 9000),
    "a required text": lambda run: run["tool"]["driver"]["rules"][0].pop("help"),
    "too long": lambda run: run["tool"]["driver"]["rules"][0].update(fullDescription={"text": "x" * 1025}),
    "too many tags": lambda run: run["tool"]["driver"]["rules"][0]["properties"].update(tags=list(map(str, range(21)))),
}


def _place(run: Any) -> Any:
    return run["results"][0]["locations"][0]["physicalLocation"]


@pytest.mark.parametrize("reason", BREAKS)
def test_a_log_that_github_would_refuse_is_told(reason: str) -> None:
    log = json.loads(render(a_run()))
    assert list(refused(log)) == []
    BREAKS[reason](log["runs"][0])
    assert any(reason in told for told in refused(log))


def test_a_log_that_the_schema_refuses_is_told() -> None:
    log = json.loads(render(a_run()))
    VALIDATOR.validate(log)
    log["runs"][0]["results"][0]["level"] = "fatal"
    with pytest.raises(jsonschema.ValidationError, match="fatal"):
        VALIDATOR.validate(log)


@pytest.fixture(scope="module")
def car_3() -> Run:
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(FIXTURES)
        return check(FIXTURES / "car-3", tier="source")


@pytest.mark.slow
def test_a_real_run_keeps_to_both(car_3: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(FIXTURES)
    run = sarif_of(car_3)
    assert len(run["results"]) == len(list_line_entries(car_3.findings, car_3.rules)) > len(car_3.findings) > 20
    assert {rule["id"] for rule in run["tool"]["driver"]["rules"]} == set(car_3.rules)
    assert str(FIXTURES) not in json.dumps(run), "no path of this machine"
    assert render(car_3) == render(copy.deepcopy(car_3))


def test_a_rule_has_its_page_as_help() -> None:
    (descriptor,) = sarif_of(a_run(rules={"INR003": rule(tags=("inertia", "mujoco"))}))["tool"]["driver"]["rules"]
    assert descriptor["shortDescription"]["text"] == "Triangle inequality"
    assert descriptor["fullDescription"]["text"] == "The principal moments satisfy I1 + I2 >= I3."
    assert "## How to fix\n\nExport the tensor again." in descriptor["help"]["markdown"]
    assert "Drake too, see the manual (https://example.org/manual)" in descriptor["help"]["text"]
    assert descriptor["defaultConfiguration"] == {"level": "error"}
    assert descriptor["properties"] == {
        "tags": ["inertia", "mujoco"],
        "precision": "very-high",
        "problem.severity": "error",
    }


def test_a_rule_has_the_address_of_its_page_once_there_is_a_site(monkeypatch: pytest.MonkeyPatch) -> None:
    assert not any("helpUri" in entry for entry in sarif_of(a_run(finding()))["tool"]["driver"]["rules"])
    monkeypatch.setattr("urdfcheck.version.SITE", "https://example.org/")
    for entry in sarif_of(a_run(finding()))["tool"]["driver"]["rules"]:
        assert entry["helpUri"] == f"https://example.org/rules/{entry['id']}/"


def test_a_page_without_text_and_one_with_too_much_are_no_reason_to_refuse_the_rest() -> None:
    long = "## What it checks\n\n" + "long " * 500
    sarif_of(a_run(rules={"A": rule("A", page=""), "B": rule("B", page=long, tags=tuple(map(str, range(50))))}))


# -- results -----------------------------------------------------------------------------------------------------------


def test_a_result_says_all_that_a_reader_needs() -> None:
    of_two = finding(subjects=("link[wheel]/inertial/inertia", "link[caster]/inertial/inertia"))
    (result,) = results(a_run(of_two))
    assert result["message"]["text"].split("\n") == [
        "wheel: no body can have this inertia (12 % short).",
        "link wheel: principal moments break the triangle inequality.",
        "Why: a decimal point was lost in izz.",
        "MuJoCo: refuses to compile.",
        "Drake: replaces the inertia.",
        "Fix: put the point back.",
        "For link[wheel]/inertial/inertia, link[caster]/inertial/inertia.",
        "See [rover.urdf:7](1).",
    ]
    (place,) = result["locations"]
    assert [named["name"] for named in place["logicalLocations"]] == ["wheel", "caster"]
    (related,) = result["relatedLocations"]
    assert related["id"] == 1
    assert (result["level"], result["kind"], result["rank"]) == ("error", "fail", 100)
    assert result["partialFingerprints"] == {"urdfcheck/v1": of_two.fingerprints[0]}
    assert result["properties"]["fingerprints"] == list(of_two.fingerprints)


def test_levels_and_ranks_follow_severity_and_confidence() -> None:
    assert [(r["level"], r["rank"]) for r in results(a_run())] == [("error", 100), ("warning", 100), ("note", 50)]


def test_a_finding_about_the_whole_model_is_at_the_start_of_its_file() -> None:
    whole = finding(location=Location("robot", None), related=())
    for run in (a_run(whole), a_run(replace(whole, model=""))):
        (result,) = results(run)
        place = result["locations"][0]["physicalLocation"]
        assert place["artifactLocation"]["uri"] == info().path
        assert place["region"] == {"startLine": 1, "startColumn": 1, "endLine": 1, "endColumn": 1}


def test_text_of_strangers_is_neither_link_nor_placeholder_and_acts_on_nothing() -> None:
    evil = "link \x1b[31m[home](https://evil.example) `${x_1}` {0}\n::error::boo"
    run = a_run(finding(headline=evil, message=evil, subjects=(evil, f"link[{evil}]"), related=()))
    (result,) = results(run)
    text = result["message"]["text"]
    assert text.startswith('link \\x1b[31m[home] (https://evil.example) "${x_1}" {{0}}\n')
    assert not re.search(r"^\s*::", render(run), re.MULTILINE)


def test_of_too_many_findings_the_worst_are_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sarif, "MOST_RESULTS", 2)
    known = finding(suppressed=Suppression("source", "on purpose"))
    log = sarif_of(a_run(known, *a_run().findings))
    assert [r["level"] for r in log["results"]] == ["error", "warning"]
    told = [note["message"]["text"] for note in log["invocations"][0]["toolExecutionNotifications"]]
    assert any(text.startswith("2 findings are left out") for text in told)


def test_many_places_are_cut_to_what_github_takes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sarif, "MOST_LOCATIONS", 30)
    monkeypatch.setattr(sarif, "MOST_NAMED", 10)
    lines = [span_of(line) for line in SOURCE.splitlines()[:7]]
    many = tuple(Location(f"link[{n}]", lines[n % 7]) for n in range(1200))
    (result,) = results(a_run(finding(related=many, subjects=tuple(place.subject for place in many))))
    assert len(result["locations"] + result["relatedLocations"]) == 30
    text = result["message"]["text"]
    assert "For link[0], link[1], " in text
    assert "and 1190 more." in text
    assert text.endswith("See [rover.urdf:1](1), [rover.urdf:2](2), [rover.urdf:3](3), [rover.urdf:4](4) and 3 more.")


# -- suppression and baseline ------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("kind", "told"), [("source", "inSource"), ("configuration", "external"), ("baseline", "external")]
)
def test_what_is_known_says_so_and_why(kind: str, told: str) -> None:
    known = finding(suppressed=Suppression(kind, "vendor's own numbers"))
    first, second = results(a_run(known, finding()))
    assert first["suppressions"] == [{"kind": told, "status": "accepted", "justification": "vendor's own numbers"}]
    assert second["suppressions"] == [], "SARIF wants this told of all results or of none"


def test_only_a_run_with_a_baseline_says_what_is_new() -> None:
    run = a_run(finding(suppressed=Suppression("baseline", "in the baseline")), finding())
    assert [r.get("baselineState") for r in results(run)] == [None, None]
    run = replace(run, baselines=frozenset({"urdfcheck-baseline.json"}))
    assert [r["baselineState"] for r in results(run)] == ["unchanged", "new"]


def test_a_baseline_that_knows_nothing_is_a_baseline_too(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "r.urdf"
    path.write_text('<robot name="r"><link name="a"/><link name="b"/></robot>')
    empty = Baseline(path=tmp_path / "known.json", root=tmp_path)
    assert {r["baselineState"] for r in results(check(path, tier="source", baseline=empty))} == {"new"}


# -- code flows --------------------------------------------------------------------------------------------------------

MACROS = """<robot xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:macro name="body" params="mass"><inertial>
    <mass value="-${mass}"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>
  </inertial></xacro:macro>
  <xacro:macro name="arm" params="name">
    <link name="${name}"><xacro:body mass="1"/></link>
  </xacro:macro>
</robot>
"""
ROBOT = """<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:include filename="macros.xacro"/>
  <xacro:arm name="left"/>
</robot>
"""


def test_the_calls_that_brought_the_text_there_are_a_code_flow(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "macros.xacro").write_text(MACROS)
    (tmp_path / "r.urdf.xacro").write_text(ROBOT)
    (result,) = results(check(tmp_path / "r.urdf.xacro", codes={"INR002"}, tier="source"))
    (flow,) = result["codeFlows"]
    steps = flow["threadFlows"][0]["locations"]
    places = [step["location"]["physicalLocation"] for step in steps]
    told = [step["location"]["message"]["text"] for step in steps]
    files = [place["artifactLocation"]["uri"] for place in places]
    assert list(zip(files, [place["region"]["startLine"] for place in places], told, strict=True)) == [
        ("r.urdf.xacro", 3, "<xacro:arm>"),
        ("macros.xacro", 6, "<xacro:body>"),
        ("macros.xacro", 3, "link[left]/inertial/mass@value"),
    ]
    assert [step["nestingLevel"] for step in steps] == [0, 1, 2]
    assert places[-1] == result["locations"][0]["physicalLocation"]


# -- places and fixes --------------------------------------------------------------------------------------------------

TYPED = '<robot name="é e\u0301 🤖">\n  <a xyz="🤖🤖 0"/> <b/>\n  <!-- gone -->\n</robot>\n'


def offsets_of(text: str, region: Any) -> tuple[int, int]:
    """The code points between which a region of SARIF lies, from UTF-16 columns alone."""
    starts = [0, *(m.end() for m in re.finditer("\r\n|\n|\r", text))]

    def offset(line: int, column: int) -> int:
        units = text[starts[line - 1] :].encode("utf-16-le")[: 2 * (column - 1)]
        return starts[line - 1] + len(units.decode("utf-16-le"))

    return offset(region["startLine"], region["startColumn"]), offset(region["endLine"], region["endColumn"])


def applied(text: str, change: Any) -> str:
    """A file after the replacements of SARIF, whose regions are those of the file as it was."""
    for replacement in reversed(change["replacements"]):
        start, end = offsets_of(text, replacement["deletedRegion"])
        text = text[:start] + replacement.get("insertedContent", {}).get("text", "") + text[end:]
    return text


@pytest.mark.parametrize("newline", ["\n", "\r\n", "\r"])
def test_another_program_that_applies_a_fix_gets_what_urdfcheck_writes(newline: str) -> None:
    text = TYPED.replace("\n", newline)
    file = SourceFile(Path(FILE), FILE, text=text)

    def edit(old: str, new: str) -> Edit:
        start = text.index(old)
        return Edit(file.make_span(start, start + len(old)), old, new)

    end = file.make_span(text.index("</robot>"), text.index("</robot>"))
    edits = (
        edit(f"  <!-- gone -->{newline}", ""),
        edit("🤖🤖 0", "0 0 1"),
        edit("<b/>", "<b>\n  </b>"),
        Edit(end, "", "  <é🤖/>\n"),
        edit("e\u0301 🤖", "robot"),
    )
    fixed = finding(
        fix=Fix("change everything", Applicability.SAFE, edits), location=Location("robot", end), related=()
    )
    (result,) = results(a_run(fixed, sources={FILE: text}))
    ((change,),) = [fix["artifactChanges"] for fix in result["fixes"]]
    assert unquote(change["artifactLocation"]["uri"]) == FILE
    assert applied(text, change).encode() == EditableText(FILE, FILE, text.encode(), file).apply_edits(edits)
    places = [offsets_of(text, replacement["deletedRegion"]) for replacement in change["replacements"]]
    assert all(a[1] <= b[0] for a, b in pairwise(places))


def test_advice_is_no_fix() -> None:
    assert "fixes" not in results(a_run(finding(fix=Fix("think about it"))))[0]


def test_a_path_is_relative_and_encoded_and_links_are_followed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "src/my rob[o]t é").mkdir(parents=True)
    (tmp_path / "ws").symlink_to(tmp_path / "src")
    monkeypatch.chdir(tmp_path)
    name = "ws/my rob[o]t é/a:b%20.urdf"
    at = Span(name, 1, 1, 1, 2, 0, 1)
    (result,) = results(a_run(finding(location=Location("robot", at), related=())))
    place = result["locations"][0]["physicalLocation"]["artifactLocation"]
    assert place == {"uri": "src/my%20rob%5Bo%5Dt%20%C3%A9/a%3Ab%2520.urdf", "uriBaseId": "%SRCROOT%"}


# -- the run -----------------------------------------------------------------------------------------------------------


def test_the_run_tells_what_went_wrong_and_what_was_not_checked() -> None:
    (clean,) = sarif_of(a_run(skipped=()))["invocations"]
    assert clean == {"executionSuccessful": True, "toolExecutionNotifications": []}
    skipped = (
        SkippedCheck("INR003", info().id, "the mesh is missing"),
        SkippedCheck("ALL", "notes.txt", "is not checked: no model"),
        SkippedCheck("INR003", info().id, "7 more findings not listed", is_partial=True),
        SkippedCheck("scene", info().id, "no geometry"),
    )
    (bad,) = sarif_of(a_run(skipped=skipped, failures=("INR001 crashed",), partial=True))["invocations"]
    assert not bad["executionSuccessful"]
    told = [(note["level"], note["message"]["text"]) for note in bad["toolExecutionNotifications"]]
    assert told == [
        ("error", "INR001 crashed"),
        ("error", "The run was interrupted: not everything was checked."),
        ("note", "INR003 was not checked: the mesh is missing"),
        ("note", "Not checked: no model"),
        ("note", "INR003 is not complete: 7 more findings not listed"),
        ("note", "The model was not drawn: no geometry"),
    ]
    assert bad["toolExecutionNotifications"][2]["associatedRule"] == {"id": "INR003", "index": 1}


def test_runs_over_several_robots_are_told_apart() -> None:
    assert sarif_of(a_run())["automationDetails"] == {"id": "urdfcheck/rover/"}
    two = a_run(models=(info(), info(robot="arm", id="arm.urdf")))
    assert sarif_of(two)["automationDetails"] == {"id": "urdfcheck/"}


def test_columns_count_utf_16_units() -> None:
    text = SOURCE.replace('name="wheel"', 'name="🤖" id="wheel"', 1)
    at = span_of('id="wheel"', text)
    run = a_run(finding(location=Location("link[🤖]", at), related=(), fix=None), sources={FILE: text})
    log = sarif_of(run)
    assert log["columnKind"] == "utf16CodeUnits"
    region = log["results"][0]["locations"][0]["physicalLocation"]["region"]
    assert (region["startColumn"], region["endColumn"]) == (at.col + 1, at.end_col + 1)
    assert offsets_of(text, region) == (at.start, at.end)
