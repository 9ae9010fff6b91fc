"""Each rule page is its rule's first test: every Bad block gives the finding on the marked line, no Good block does.

The files of a tree are checked as a folder.
"""

from __future__ import annotations

import inspect
import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from string import Formatter

import pytest
from conftest import REPOSITORY, check, list_machine_paths

from urdfcheck import rules
from urdfcheck.core import Applicability, Finding, Rule
from urdfcheck.core.findings import iter_occurrences
from urdfcheck.core.headlines import LONGEST_HEADLINE
from urdfcheck.dev.new_rule import TO_DO
from urdfcheck.dev.rule_examples import list_examples
from urdfcheck.policy import config, config_resolver
from urdfcheck.rules import NEEDS, SCOPES, has_check, load_check, load_rules

# `expect: NAM008` marks a line, `expect: NAM008 "base_"` the text on it that the finding points at as well.
EXPECT = re.compile(r'expect: ([A-Z]{3}\d{3})(?: "([^"]*)")?')
HEADINGS = ["What it checks", "Why it matters", "How to fix", "Bad", "Good", "When to ignore", "References"]
# Room that the words of a headline leave for each of its values.
LEAST_VALUE = 6


# What no headline says: the subject comes first, and it is one clause in plain words.
DROPPED = re.compile(r"\bis no\b|\bare no\b|\bas does\b|[«»`]|\.$|\bso for\b")


@dataclass(frozen=True)
class Case:
    """The files of one example."""

    rule: str
    section: str
    number: int
    files: tuple[tuple[str, str], ...]

    def __str__(self) -> str:
        return f"{self.rule}-{self.section.lower()}-{self.number}"


def cases(rule: Rule, heading: str) -> list[Case]:
    return [Case(rule.code, heading, i + 1, files) for i, files in enumerate(list_examples(rule.page, heading))]


RULES = list(load_rules().values())
FIXES = [Applicability.DISPLAY, Applicability.UNSAFE, Applicability.SAFE]
FIXED = [rule for rule in RULES if rule.fix is not Applicability.DISPLAY and has_check(rule)]
CHECKED = [rule for rule in RULES if has_check(rule)]
BAD = [case for rule in CHECKED for case in cases(rule, "Bad")]
GOOD = [case for rule in CHECKED for case in cases(rule, "Good")]


def findings_of(case: Case, folder: Path) -> list[Finding]:
    """What the case's rule finds in it."""
    for name, text in case.files:
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8", newline="")
    # A single file is named by the user; a tree of files is found in its folder.
    target = folder if len(case.files) > 1 else folder / case.files[0][0]
    # A tree may hold its own urdfcheck.toml.
    own = config_resolver.find_config(folder)
    rule = load_rules()[case.rule]
    simulated = "simulator" in rule.needs
    if simulated:
        pytest.importorskip("mujoco")
    run = check(
        target,
        codes={*rule.hidden_by, case.rule},
        targets=own.target,
        options=own.sections[0].options,
        drop=simulated,
    )
    assert not run.failures, run.failures
    assert not list_machine_paths(run, folder)
    return [f for f in iter_occurrences(run.findings) if f.code == case.rule]


def offered(finding: Finding) -> Applicability:
    """What its repair is good for."""
    return Applicability.DISPLAY if finding.fix is None else finding.fix.applicability


Place = tuple[str, int, str | None]


def list_marked_places(case: Case) -> set[Place]:
    """The file, the line and, where the mark says so, the text that the case's rule must point at."""
    return {
        (name, number, text or None)
        for name, content in case.files
        for number, line in enumerate(content.split("\n"), 1)
        for code, text in EXPECT.findall(line)
        if code == case.rule
    }


def assert_headline_fits(finding: Finding) -> None:
    """A headline has its length, and nothing was cut off its end, unless it ends with a text that may be long."""
    headline, template = finding.headline, load_rules()[finding.code].headlines[finding.message_id]
    assert 0 < len(headline) <= LONGEST_HEADLINE, headline
    assert template.endswith(("}", "})")) or not headline.endswith("…"), headline


def list_found_places(case: Case, folder: Path, with_text: set[tuple[str, int]]) -> set[Place]:
    """The places that the case's rule points at; their text only on the lines in ``with_text``."""
    findings = findings_of(case, folder)
    promised = FIXES.index(load_rules()[case.rule].fix)
    assert all(FIXES.index(offered(f)) <= promised for f in findings), "the page's key `fix` promises less"
    for finding in findings:
        assert_headline_fits(finding)
    contents = dict(case.files)
    places: set[Place] = set()
    for span in (f.location.span for f in findings if f.location.span is not None):
        name = Path(span.file).resolve().relative_to(folder.resolve()).as_posix()
        text = contents[name][span.start : span.end] if (name, span.line) in with_text else None
        places.add((name, span.line, text))
    return places


@pytest.mark.parametrize("case", BAD, ids=str)
def test_bad_block_gives_the_finding_on_the_marked_line(case: Case, tmp_path: Path) -> None:
    marked = list_marked_places(case)
    assert marked, "the block marks no line with `expect:`"
    with_text = {(name, line) for name, line, text in marked if text is not None}
    assert list_found_places(case, tmp_path, with_text) == marked


@pytest.mark.parametrize("rule", RULES, ids=lambda rule: rule.code)
def test_headlines_are_one_claim(rule: Rule) -> None:
    for name, template in rule.headlines.items():
        assert not DROPPED.search(template), name
        assert template.splitlines() == [template], name
        texts, fields, *_ = zip(*Formatter().parse(template), strict=True)
        room = LONGEST_HEADLINE - len("".join(texts)) - LEAST_VALUE * sum(field is not None for field in fields)
        assert room >= 0, f"{name}: {-room} characters too many for values of {LEAST_VALUE} characters"


@pytest.mark.parametrize("case", GOOD, ids=str)
def test_good_block_does_not(case: Case, tmp_path: Path) -> None:
    assert not list_marked_places(case)
    assert not list_found_places(case, tmp_path, set())


@pytest.mark.parametrize("rule", FIXED, ids=lambda rule: rule.code)
def test_an_example_gets_the_repair_that_the_page_promises(rule: Rule, tmp_path: Path) -> None:
    found = (f for number, case in enumerate(cases(rule, "Bad")) for f in findings_of(case, tmp_path / str(number)))
    assert any(offered(finding) is rule.fix for finding in found)  # the first that does is enough


@pytest.mark.parametrize("rule", [rule for rule in RULES if rule.excess], ids=lambda rule: rule.code)
def test_the_number_that_orders_findings_is_one(rule: Rule, tmp_path: Path) -> None:
    found = (f for number, case in enumerate(cases(rule, "Bad")) for f in findings_of(case, tmp_path / str(number)))
    assert any(math.isfinite(finding.excess) for finding in found), f"no example has a number {rule.excess!r}"


def sentences(rule: Rule) -> Iterator[str]:
    """What the page says of programs."""
    for value in rule.consumers.values():
        yield from value.values() if isinstance(value, Mapping) else (value,)


@pytest.mark.parametrize("rule", RULES, ids=lambda rule: rule.code)
def test_page_is_complete(rule: Rule) -> None:
    assert TO_DO not in rule.page, "TODO left on the page"
    headings = re.findall(r"^## (.+)$", rule.page, re.MULTILINE)
    wanted = HEADINGS if has_check(rule) else [h for h in HEADINGS if h not in {"Bad", "Good", "References"}]
    assert [h for h in headings if h in HEADINGS] == [h for h in HEADINGS if h in headings]
    assert set(wanted) <= set(headings), "a section is missing"
    assert set(headings) <= set(HEADINGS), "an unknown section"
    assert rule.messages.keys() == rule.fixes.keys(), "every message needs its repair"
    assert rule.messages.keys() == rule.headlines.keys(), "every message needs its headline, and there are no others"
    assert rule.status in {"preview", "stable", "deprecated"}
    assert rule.scopes
    assert set(rule.scopes) <= set(SCOPES)
    assert rule.needs
    assert set(rule.needs) <= set(NEEDS)
    assert set(rule.hidden_by) <= set(load_rules())
    assert set(rule.concerns) <= set(config.TARGETS)
    assert not [s for s in sentences(rule) if s.startswith("{")], "what a case decides is the check's `consequences`"
    if has_check(rule):
        assert cases(rule, "Bad"), "no Bad block"
        assert cases(rule, "Good"), "no Good block"


def test_every_rule_is_there_since_a_release() -> None:
    """What a user can install: 0.1 was never released."""
    changelog = (REPOSITORY / "CHANGELOG.md").read_text(encoding="utf-8")
    releases = {*re.findall(r"^## (\d+\.\d+\.\d+) ", changelog, re.MULTILINE)}
    assert releases
    assert {rule.code: rule.since for rule in RULES if rule.since not in releases} == {}


@pytest.mark.parametrize("rule", CHECKED, ids=lambda rule: rule.code)
def test_options_are_the_keyword_parameters_of_the_check(rule: Rule) -> None:
    """Names, types and defaults: the page is what the check gets."""
    parameters = inspect.signature(load_check(rule), eval_str=False).parameters
    keywords = {n: p for n, p in parameters.items() if p.kind is p.KEYWORD_ONLY}
    assert set(keywords) == set(rule.options)
    for name, parameter in keywords.items():
        assert parameter.default is parameter.empty, "the default stands on the page"
        assert parameter.annotation == type(rule.options[name].default).__name__


def test_every_check_has_a_page() -> None:
    modules = {p.stem for p in (Path(rules.__file__).parent / "checks").glob("[a-z]*.py")} - {"__init__"}
    assert modules == {rule.stem for rule in CHECKED}
