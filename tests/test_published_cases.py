"""The page of published cases: each example gives the findings that the table promises, and the numbers are the table's."""

from __future__ import annotations

import re
from collections import defaultdict
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from urdfcheck.core.findings import iter_occurrences
from urdfcheck.rules import load_rules
from urdfcheck.run.pipeline import IN_THIS_PROCESS, run
from urdfcheck.run.request import RunOptions, make_request

PAGE = (Path(__file__).parents[1] / "benchmarks/published_cases.md").read_text(encoding="utf-8")
ROW = re.compile(r"^\| (\d+) \| (.+?) \| (.+?) \| (.+?) \|$", re.MULTILINE)
ANSWER = re.compile(r"`([A-Z]{3}\d{3}) ([\w-]+)` \(\[([\w-]+)\]\(#([\w-]+)\)\)")
FENCE = re.compile(r"^```\w+ file=(\S+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)

Promise = tuple[str, str]


@dataclass
class Example:
    """Files, and what is promised of them, by default and on request."""

    files: list[tuple[str, str]]
    by_default: set[Promise] = field(default_factory=set)
    on_request: set[Promise] = field(default_factory=set)


def read_examples() -> dict[str, Example]:
    """Read the examples, and what the table says of each."""
    text = PAGE.partition("\n## Examples\n")[2]
    examples = {
        part.partition("\n")[0]: Example(FENCE.findall(part))
        for part in re.split(r"^### ", text, flags=re.MULTILINE)[1:]
    }
    for _, _, _, answer in ROW.findall(PAGE):
        for code, message, name, _ in ANSWER.findall(answer):
            promised = examples[name].on_request if answer.endswith(", on request") else examples[name].by_default
            promised.add((code, message))
    return examples


EXAMPLES = read_examples()


def test_the_numbers_are_those_of_the_table() -> None:
    rows = ROW.findall(PAGE)
    assert [int(number) for number, *_ in rows] == list(range(1, len(rows) + 1))
    kinds: dict[str, int] = defaultdict(int)
    for number, _, _, answer in rows:
        promised = ANSWER.findall(answer)
        assert bool(promised) != answer.startswith("not found: "), number
        assert all(name == link for *_, name, link in promised), number
        kinds["none" if not promised else "request" if answer.endswith(", on request") else "default"] += 1
    claim = (
        f"**{kinds['default'] + kinds['request']} of {len(rows)} are found: {kinds['default']} by default, {kinds['request']} on "
        f"request (`--pedantic`). {kinds['none']} are not found.**"
    )
    assert claim in PAGE


def test_each_message_is_one_of_its_rule_and_each_example_is_used() -> None:
    for name, example in EXAMPLES.items():
        promised = example.by_default | example.on_request
        assert promised, f"{name}: no case refers to it"
        assert all(message in load_rules()[code].messages for code, message in promised), name


@pytest.mark.parametrize("name", EXAMPLES)
def test_an_example_gives_what_the_table_promises(name: str, tmp_path: Path) -> None:
    example = EXAMPLES[name]
    assert example.files
    for file, text in example.files:
        path = tmp_path / file
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8", newline="")
    target = tmp_path if len(example.files) > 1 else tmp_path / example.files[0][0]
    assert example.by_default <= list_reported(target, pedantic=False)
    if example.on_request:
        assert example.on_request <= list_reported(target, pedantic=True)
        assert not example.on_request & list_reported(target, pedantic=False)


def list_reported(target: Path, *, pedantic: bool) -> set[Promise]:
    """List rule and message of what the command reports."""
    request, _ = make_request(RunOptions(paths=(target,), pedantic=pedantic, jobs=1))
    outcome = run(request, IN_THIS_PROCESS)
    assert not outcome.failures
    return {(finding.code, finding.message_id) for finding in iter_occurrences(outcome.active_findings)}
