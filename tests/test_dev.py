"""A rule is two files: what ``python -m urdfcheck.dev new-rule`` writes, and that it fails until it is filled in."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import REPOSITORY

from urdfcheck.core.errors import UrdfcheckError
from urdfcheck.dev.__main__ import main
from urdfcheck.dev.new_rule import TO_DO, write_new_rule
from urdfcheck.rules import load_page

FILLED_IN = {
    f'tags = ["{TO_DO}"]': 'tags = ["names"]',
    f"{TO_DO}: actual against expected, e.g. {{kind}}": "{kind}",
    f'"{TO_DO}" in attribute.value': 'attribute.value.endswith("_")',
}


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    """A copy of what a rule needs: the pages, the package, and the tests of the pages. What is compiled already is copied with
    it, and holds as long as its source has the same time and size."""
    for folder in ("rules", "urdfcheck", "tests"):
        shutil.copytree(REPOSITORY / folder, tmp_path / folder)
    shutil.copy(REPOSITORY / "pyproject.toml", tmp_path)
    return tmp_path


def run_page_tests(checkout: Path, code: str = "NAM998") -> subprocess.CompletedProcess[str]:
    command = [
        sys.executable,
        "-m",
        "pytest",
        "-q",
        "-p",
        "no:cacheprovider",
        "tests/test_rules.py",
        "-k",
        f"{code} or {code.lower()}",
    ]
    environment = {"PYTHONPATH": str(checkout), "PATH": "/usr/bin:/bin", "HOME": str(checkout)}
    return subprocess.run(command, cwd=checkout, env=environment, capture_output=True, text=True)


@pytest.mark.long
@pytest.mark.slow
def test_the_example_of_contributing_is_a_complete_rule(checkout: Path) -> None:
    text = (REPOSITORY / "CONTRIBUTING.md").read_text(encoding="utf-8")
    page = re.search(r"^````markdown\n(.*?)^````$", text, re.MULTILINE | re.DOTALL)
    check = re.search(r"^```python\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)
    assert page is not None
    assert check is not None
    page_path, check_path = "rules/NAM008-dangling-underscore.md", "urdfcheck/checks/nam008_dangling_underscore.py"
    assert page_path in text
    assert check_path in text
    (checkout / page_path).write_text(page[1], encoding="utf-8")
    (checkout / check_path).write_text(check[1], encoding="utf-8")
    done = run_page_tests(checkout, "NAM008")
    assert done.returncode == 0, done.stdout + done.stderr
    (checkout / check_path).write_text(check[1].replace('endswith("_")', 'endswith("--")'), encoding="utf-8")
    assert run_page_tests(checkout, "NAM008").returncode == 1


@pytest.mark.slow
def test_a_new_rule_fails_until_it_is_filled_in(checkout: Path) -> None:
    page, module = write_new_rule("NAM998", "dangling-underscore", checkout)
    assert load_page(page).stem == module.stem
    unfilled = run_page_tests(checkout)
    assert unfilled.returncode == 1, unfilled.stdout + unfilled.stderr
    assert "TODO left on the page" in unfilled.stdout
    assert "test_bad_block_gives_the_finding_on_the_marked_line" in unfilled.stdout
    for path in (page, module):
        text = path.read_text(encoding="utf-8")
        for before, after in FILLED_IN.items():
            text = text.replace(before, after)
        path.write_text(text.replace(TO_DO, "words"), encoding="utf-8")
    filled = run_page_tests(checkout)
    assert filled.returncode == 0, filled.stdout + filled.stderr


@pytest.mark.parametrize(
    ("code", "name", "reason"),
    [
        ("NAM8", "x", "is not a code"),
        ("NAM998", "Dangling", "is not a name"),
        ("ABC001", "x", "rules/families.toml"),
        ("NAM001", "x", "the code NAM001 is taken"),
        ("NAM998", "illegal-name", "the name illegal-name is taken"),
    ],
)
def test_a_wrong_code_or_name_is_refused_with_the_reason(code: str, name: str, reason: str) -> None:
    with pytest.raises(UrdfcheckError, match=reason):
        write_new_rule(code, name)


def test_a_folder_that_is_not_a_checkout_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UrdfcheckError, match="not a checkout"):
        write_new_rule("NAM998", "x", tmp_path)


def test_what_is_written_already_is_not_overwritten(tmp_path: Path) -> None:
    for folder in ("rules", "urdfcheck/checks"):
        (tmp_path / folder).mkdir(parents=True)
    check = tmp_path / "urdfcheck" / "checks" / "nam998_dangling_underscore.py"
    check.write_text("mine")
    with pytest.raises(UrdfcheckError, match="nothing was written"):
        write_new_rule("NAM998", "dangling-underscore", tmp_path)
    assert check.read_text() == "mine"
    assert not list((tmp_path / "rules").iterdir())


def test_a_code_in_small_letters_is_understood(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["rule", "nam001"]) == 2
    assert "did you mean NAM001?" in capsys.readouterr().err


def test_the_tests_of_a_rule_that_does_not_exist(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["rule", "NAM998"]) == 2
    assert "new-rule NAM998 NAME" in capsys.readouterr().err


def test_the_words_of_a_rule_are_among_its_tests(monkeypatch: pytest.MonkeyPatch) -> None:
    started: list[list[str]] = []

    def start(words: list[str], **_: object) -> subprocess.CompletedProcess[str]:
        started.append(words)
        return subprocess.CompletedProcess(words, 3 if "tools/check_prose.py" in words else 0)

    monkeypatch.setattr(subprocess, "run", start)
    assert main(["rule", "NAM001"]) == 3
    files = {word for words in started for word in words if word.endswith((".md", ".py"))}
    assert files >= {"rules/NAM001-illegal-name.md", "urdfcheck/checks/nam001_illegal_name.py"}
    assert all((REPOSITORY / file).is_file() for file in files)
