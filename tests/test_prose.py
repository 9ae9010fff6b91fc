"""What users read is plain English: the vocabulary of tools/prose.toml, and sentences and messages of a bearable length."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

import pytest
from conftest import REPOSITORY

_spec = importlib.util.spec_from_file_location("check_prose", REPOSITORY / "tools" / "check_prose.py")
assert _spec is not None
assert _spec.loader is not None
check_prose = importlib.util.module_from_spec(_spec)
sys.modules["check_prose"] = check_prose
_spec.loader.exec_module(check_prose)

HABITS = check_prose.load_habits()
FILES = check_prose.list_files()

# Docstrings are for people who work on urdfcheck. The number of habits in them may only fall.
MOST_IN_DOCSTRINGS = 74


def test_what_users_read_is_plain_english() -> None:
    """One test for all files, and for all claims about them: each process would read them anew."""
    read = {path: list(check_prose.read_passages(path)) for path in FILES}
    matches = [match for passages in read.values() for match in check_prose.check_passages(passages, HABITS)]
    shown = [match for match in matches if match.kind != "docstring"]
    assert not shown, "\n" + "\n".join(map(str, shown))
    assert len(matches) <= MOST_IN_DOCSTRINGS, "python tools/check_prose.py --docstrings lists them"
    kinds = {passage.kind for passages in read.values() for passage in passages}
    assert kinds == {"page", "headline", "message", "string", "docstring"}
    names = {path.relative_to(REPOSITORY).as_posix() for path in FILES}
    assert {
        "README.md",
        "SECURITY.md",
        "CHANGELOG.md",
        "docs/guides/fix.md",
        "action.yml",
        "urdfcheck/cli/options.py",
    } <= names
    assert len([name for name in names if name.startswith("rules/")]) > 150


@pytest.mark.parametrize("habit", HABITS, ids=lambda habit: habit.better)
def test_a_pattern_finds_what_it_is_for_and_nothing_right(habit: check_prose.Habit) -> None:
    assert habit.wrong
    for sentence in habit.wrong:
        assert _find(sentence, [habit]), f"not found: {sentence}"
    for sentence in habit.right:
        assert not _find(sentence, HABITS), f"found, and is right: {sentence}"


def test_a_better_word_is_no_habit_itself() -> None:
    for habit in HABITS:
        assert not _find(habit.better, HABITS)


PAGE = """\
# NAM008 dangling-underscore

```toml
severity = "warning"

[options.size]
doc = "How far it is looked at."

[headlines]
found = "{kind}: it stands in {name}"

[messages]
found = "{kind} is no {name}, \\"mend\\" it"

[consumers.found]
gazebo = "tells it"
```

## What it checks

A name is looked at, and `is no link` is not; nor is
``is no joint`` or [a link](is-no-link.md) <!-- nobody sees it -->.
It is no
name.

```urdf
<robot name="mended"/> <!-- is no robot -->
```

## References

* Nobody, *What becomes of it*.

## Afterwards

It is mended.
"""


def test_a_rule_page_is_read_but_for_its_code_and_references(tmp_path: Path) -> None:
    page = tmp_path / "rules" / "NAM008-dangling-underscore.md"
    page.parent.mkdir()
    page.write_text(PAGE, encoding="utf-8")
    found = [(match.line, match.words) for match in check_prose.check_file(page, HABITS)]
    assert found == [
        (7, "looked at"),
        (10, "stands in"),
        (13, "is no □□□□□□,"),
        (13, "mend"),
        (16, "tells"),
        (21, "looked at"),
        (23, "is no name."),
        (36, "mended"),
    ]


CODE = '''\
"""It is mended."""
KEY = "mend"
PATTERN = r"\\bmend\\s it"


def fail(name: str) -> None:
    raise ValueError(
        f"{name} is not there: "
        f"{name} is no folder; it stands in "
        "another one, and is mended"
    )
'''


def test_sentences_of_code_are_read_at_their_lines(tmp_path: Path) -> None:
    module = tmp_path / "module.py"
    module.write_text(CODE, encoding="utf-8")
    found = check_prose.check_file(module, HABITS)
    assert [(match.line, match.kind, match.words) for match in found] == [
        (1, "docstring", "mended"),
        (9, "string", "is no folder;"),
        (9, "string", "stands in"),
        (10, "string", "mended"),
    ]
    script = tmp_path / "script.ts"
    script.write_text('import a from "b";\nconst TITLE = `${name} is no link`;\n', encoding="utf-8")
    assert [match.line for match in check_prose.check_file(script, HABITS)] == [2]


def test_long_sentences_and_messages_are_found(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text("Short.\n\n" + "word " * 30 + "\n" + "word " * 11 + "and. Short.\n", encoding="utf-8")
    (match,) = check_prose.check_file(page, HABITS)
    assert (match.line, match.better[:8]) == (3, "42 words")
    page.write_text(
        "* " + "word " * 30 + "\n* " + "word " * 30 + "\n\n| " + "word " * 30 + "| " + "word " * 30, encoding="utf-8"
    )
    assert check_prose.check_file(page, HABITS) == []


def test_the_command_says_what_is_found(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    page = tmp_path / "page.md"
    page.write_text("# Title\n\nIt is mended.\n", encoding="utf-8")
    assert check_prose.main([str(page)]) == 1
    assert capsys.readouterr().out == f"{page}:3: 'mended': fix, repair, correct\n"
    page.write_text("It is repaired.\n", encoding="utf-8")
    assert check_prose.main([str(page)]) == 0
    assert capsys.readouterr().out == ""


def _find(sentence: str, habits: list[check_prose.Habit]) -> list[check_prose.Match]:
    passage = check_prose.Passage(REPOSITORY, "page", check_prose.blank_holes(sentence), (0,), 1)
    return list(check_prose.find_habits(passage, habits))
