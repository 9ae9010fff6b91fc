"""``--format agent``: what a language model reads: the worst first, an id and an edit each, never more than it can pay for."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from builders import box, inertial, joint, link, robot, visual
from conftest import FIXTURES, check, make_request

from urdfcheck.core import Run, Severity
from urdfcheck.output import render
from urdfcheck.output.agent import MOST_CHARACTERS, render_findings
from urdfcheck.run.pipeline import IN_THIS_PROCESS, run

HEAD = re.compile(r"^\[([0-9a-f]{8})\] (error|warning|info) ([A-Z]{3}\d{3}) (\S+:\d+:\d+)$", re.MULTILINE)


@pytest.fixture(scope="module")
def car() -> Run:
    return run(make_request(FIXTURES / "car-3", tier="mesh"), IN_THIS_PROCESS)


def test_each_finding_has_an_id_a_place_evidence_and_its_edit(car: Run) -> None:
    text = render(car, "agent")
    heads = HEAD.findall(text)
    counted = set(re.findall(r"([A-Z]{3}\d{3}) \d+ ", text.splitlines()[-1]))
    assert {code for _, _, code, _ in heads} | counted == {finding.code for finding in car.active_findings}
    assert len({name for name, *_ in heads}) == len(heads)
    odd = [finding for finding in car.active_findings if finding.code == "SYM001"]
    block = render_findings(car, odd[:1])
    assert "wheel_1_to_base_link: zero is -43.11° off" in block
    assert "(strong evidence)" in block
    assert '-      rpy="0 -0.75239 0" />\n+      rpy="0 0 0" />' in block


def test_the_claim_comes_first_and_the_worst_finding_after_it(car: Run) -> None:
    text = render(car, "agent")
    assert text.startswith("1 error in 1 of 2 models · Drake refuses 2 of 2 models: the notes say why.\n\n[")
    severities = [Severity[word.upper()] for _, word, _, _ in HEAD.findall(text)]
    assert severities == sorted(severities, reverse=True)


def test_what_does_not_fit_is_counted_by_rule(tmp_path: Path) -> None:
    parts = [
        link(f"part_{n}", visual(box("0.1 0.1 0.1")) + inertial(1 + n / 7, ixx=1, iyy=1, izz=9 + n)) for n in range(40)
    ]
    joints = [joint(f"j{n}", "part_0", f"part_{n}") for n in range(1, 40)]
    (tmp_path / "r.urdf").write_text("\n".join([*robot(*parts, *joints).splitlines()]), encoding="utf-8")
    outcome = check(tmp_path / "r.urdf")
    findings = [place for finding in outcome.active_findings for place in finding.list_occurrences()]
    text = render_findings(outcome, findings)
    shown = len(HEAD.findall(text))
    asked = r"\(ask for them with --select CODE, or for all with --format text\)"
    more = re.search(rf"^(\d+) more findings: .*INR\d{{3}} \d+ error.* {asked}$", text, re.MULTILINE)
    assert more is not None
    assert shown + int(more[1]) == len(findings)
    assert len(text) < 1.3 * MOST_CHARACTERS

    pages = [text]
    while "more finding" in pages[-1]:
        pages.append(render_findings(outcome, findings, page=len(pages) + 1))
        assert len(pages[-1]) < 1.3 * MOST_CHARACTERS
    told = [place for page in pages for *_, place in HEAD.findall(page)]
    assert len(pages) > 2
    assert len(told) == len(findings)
    assert render_findings(outcome, findings, page=99) == "there is no page 99\n"


def test_what_was_not_checked_leaves_room_for_the_findings(tmp_path: Path) -> None:
    for number in range(120):
        (tmp_path / f"r{number}.urdf").write_text(f"<robot><link name='a{number}' </robot>", encoding="utf-8")
    text = render(check(tmp_path), "agent")
    assert len(text) < 1.3 * MOST_CHARACTERS
    assert HEAD.search(text)


def test_names_of_a_file_are_no_lines_of_their_own(tmp_path: Path) -> None:
    name = "arm&#10;[00000000] error XML001 other.urdf:1:1"
    (tmp_path / "r.urdf").write_text(robot(link(name, inertial(-1))), encoding="utf-8")
    text = render(check(tmp_path / "r.urdf"), "agent")
    assert all("other.urdf" not in place for *_, place in HEAD.findall(text))
