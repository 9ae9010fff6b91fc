"""The project's own hygiene: formatted, linted, typed, and its documents say what the code does."""

from __future__ import annotations

import importlib
import re
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import REPOSITORY

from urdfcheck import __version__, cli
from urdfcheck.cli.commands.check import build_parser


@pytest.mark.slow
@pytest.mark.parametrize(
    "command",
    [
        ["ruff", "check", "."],
        ["ruff", "format", "--check", "."],
        ["mypy"],
    ],
    ids=" ".join,
)
def test_tools_have_nothing_to_say(command: list[str]) -> None:
    done = subprocess.run([sys.executable, "-m", *command], cwd=REPOSITORY, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_last_release_in_the_changelog_is_this_version() -> None:
    changelog = (REPOSITORY / "CHANGELOG.md").read_text(encoding="utf-8")
    first = re.search(r"^## (?!Unreleased$)(\S+)", changelog, re.MULTILINE)
    assert first is not None
    assert first.group(1) == __version__


@pytest.mark.parametrize(
    ("file", "pattern"),
    [
        ("CITATION.cff", r"^version: (.*)$"),
        ("editors/vscode/package-lock.json", r'"name": "urdfcheck",\s+"version": "(.*)"'),
        ("editors/vscode/README.md", r"urdfcheck-(.*)\.vsix"),
        ("docs/editors.md", r"urdfcheck-(.*)\.vsix"),
    ],
)
def test_files_repeat_this_version(file: str, pattern: str) -> None:
    found = re.findall(pattern, (REPOSITORY / file).read_text(encoding="utf-8"), re.MULTILINE)
    assert set(found) == {__version__}


@pytest.mark.parametrize(
    ("generator", "render", "page"),
    [
        ("make_rules_index", "render_index", "rules/README.md"),
        ("make_model_page", "render_page", "docs/what-a-check-can-ask.md"),
        ("make_command_page", "render_page", "docs/command-line.md"),
        ("make_configuration_page", "render_page", "docs/configuration-keys.md"),
        ("make_truth_page", "render_page", "docs/how-true-is-it.md"),
    ],
)
def test_generated_pages_are_current(generator: str, render: str, page: str) -> None:
    made = getattr(importlib.import_module(generator), render)()
    current = (REPOSITORY / page).read_text(encoding="utf-8") == made
    assert current, f"{page} is stale: make reports"


def test_the_rules_index_lists_every_page_once() -> None:
    """Does not ask the generator of the index: what it forgets is missing here."""
    index = (REPOSITORY / "rules" / "README.md").read_text(encoding="utf-8")
    pages = sorted(path.name for path in (REPOSITORY / "rules").glob("[A-Z]*-*.md"))
    assert re.findall(r"^\| \[[A-Z]{3}\d{3}\]\(([^)]+)\)", index, re.MULTILINE) == sorted(pages, key=_family_order)
    assert len(pages) > 100


def _family_order(page: str) -> tuple[int, str]:
    families = re.findall(r"^\[([A-Z]{3})\]$", (REPOSITORY / "rules" / "families.toml").read_text(), re.MULTILINE)
    return families.index(page[:3]), page


def test_the_documentation_names_every_option_and_exit_code() -> None:
    """Does not ask the generator of the page about the command line."""
    page = (REPOSITORY / "docs" / "command-line.md").read_text(encoding="utf-8")
    options = {s for action in build_parser()._actions for s in action.option_strings if s.startswith("--")}
    assert not {o for o in options - {"--help"} if o not in page}
    gate = (REPOSITORY / "docs" / "continuous-integration.md").read_text(encoding="utf-8")
    for code in (cli.OK, cli.FINDINGS, cli.FAILED, cli.NOTHING):
        assert re.search(rf"^\| {code} \|", gate, re.MULTILINE), f"exit code {code}"


def test_the_index_of_the_documentation_lists_every_page() -> None:
    index = (REPOSITORY / "docs" / "README.md").read_text(encoding="utf-8")
    docs = REPOSITORY / "docs"
    pages = {path.relative_to(docs).as_posix() for path in docs.rglob("*.md")} - {"README.md"}
    assert {page for page in pages if f"]({page})" not in index} == set()


def test_the_readme_shows_an_example_of_every_family_of_rules() -> None:
    """Of all but the rules about urdfcheck itself; short enough to be read."""
    readme = (REPOSITORY / "README.md").read_text(encoding="utf-8")
    families = {path.name[:3] for path in (REPOSITORY / "rules").glob("[A-Z]*-*.md")} - {"URC"}
    assert {family for family in families if not re.search(rf"^\| {family} \|", readme, re.MULTILINE)} == set()
    assert len(readme.splitlines()) <= 125


def test_documents_name_only_rules_that_exist() -> None:
    known = {path.name[:6] for path in (REPOSITORY / "rules").glob("[A-Z]*-*.md")}
    code = re.compile(rf"\b(?:{'|'.join(sorted({c[:3] for c in known}))})\d{{3}}\b")
    pages = (REPOSITORY / "docs").rglob("*.md")
    for path in [*(REPOSITORY / f"{name}.md" for name in ("README", "CHANGELOG", "SECURITY")), *pages]:
        named = set(code.findall(path.read_text(encoding="utf-8")))
        assert named <= known, f"{path.name} names {sorted(named - known)}"


@pytest.mark.parametrize("family", sorted({path.name[:3] for path in (REPOSITORY / "rules").glob("[A-Z]*-*.md")}))
def test_no_family_of_rules_is_overlooked_in_the_documents(family: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """A code that does not exist is noticed, whatever its family."""
    read = Path.read_text

    def add_unknown(path: Path, *args: str, **options: str) -> str:
        text = read(path, *args, **options)  # type: ignore[arg-type]
        return f"{text}\n{family}998\n" if path.name == "CHANGELOG.md" else text

    monkeypatch.setattr(Path, "read_text", add_unknown)
    with pytest.raises(AssertionError, match=f"{family}998"):
        test_documents_name_only_rules_that_exist()


def test_links_between_documents_lead_somewhere() -> None:
    folders = ("", "docs", "docs/guides", "rules", "fixtures/demos")
    for path in [path for folder in folders for path in (REPOSITORY / folder).glob("*.md")]:
        for target in re.findall(r"\]\((?!https?:|#|mailto:)([^)#\s]+)", path.read_text(encoding="utf-8")):
            assert (path.parent / target).exists(), f"{path.name}: {target}"


def test_the_seed_files_are_as_their_author_wrote_them() -> None:
    import hashlib

    known = {
        "robot_description/urdf/car_body.urdf.xacro": "56217a34146570dc99b7ffed2f61af53968924647cb1e3e586fdc541be9040fb",
        "robot_description/urdf/gazebo.urdf.xacro": "dc71199537c50db4aee0aceb1fce1eb22c4b82e155ade3872f9069f5ffd7c7df",
        "urdf/car-3.urdf": "f032aa1c89d8b28ff8570e18a061013243d5b61d7e3f6d90a75f9fb005c08c09",
        "launch/car.launch": "c06cde4e79858438b31f1aca302b002efc0efdf3fd73790c35e28f0f4d0fd7bb",
    }
    folder: Path = REPOSITORY / "fixtures" / "car-3"
    for name, digest in known.items():
        assert hashlib.sha256((folder / name).read_bytes()).hexdigest() == digest, name
