"""What a stranger may put into a pull request, through the real command: each attack is named, and nothing of it acts.

One run on all of them; fixtures/hostile/README.md says what each of them does to other tools.
"""

from __future__ import annotations

import contextlib
import io
import json
import os
import re
import secrets
import shutil
import subprocess
import sys
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any

import hostile_files
import jsonschema
import pytest
from conftest import REPOSITORY, make_once
from output.documents import read

from urdfcheck import cli

sys.path.insert(0, str(REPOSITORY / "tools"))
try:
    import make_hostile_table
finally:
    sys.path.pop(0)

pytestmark = [pytest.mark.slow, pytest.mark.skipif(sys.platform == "win32", reason="named pipes and links")]

# What a runner takes for a command: it takes off the blanks before it looks.
COMMANDS = re.compile(r"^\s*::|##\w*\[", re.MULTILINE)
COLOURS = re.compile(r"\x1b\[[0-9;]*m")
ACTING = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\xad\u061c\u200b-\u200f\u2028-\u202e\u2060-\u206f\ufeff\ud800-\udfff]")


@dataclass(frozen=True)
class Checked:
    """A run on all hostile files: its folder, the secret, what it wrote by format, and which files came to be."""

    hostile: Path
    secret: str
    exit_code: int
    outputs: dict[str, str]
    new: set[str]

    @property
    def report(self) -> dict[str, Any]:
        found: dict[str, Any] = json.loads(self.outputs["json"])
        return found


def tree(folder: Path) -> set[str]:
    return {os.path.join(place, name) for place, names, others in os.walk(folder) for name in (*names, *others)}


@pytest.fixture(scope="module")
def checked(tmp_path_factory: pytest.TempPathFactory) -> Checked:
    """One run for all processes of the tests."""
    return make_once("hostile", _run, tmp_path_factory)


def _run(folder: Path) -> Checked:
    root, written = folder / "pull_request", folder / "reports"
    root.mkdir()
    written.mkdir()
    secret = secrets.token_hex(16)
    hostile = hostile_files.build(root, secret)
    before = tree(root)
    places = {name: written / f"report.{name}" for name in ("json", "html", "text")}
    reports = [word for name, file in places.items() for word in ("-o", f"{name}={file}")]
    done = make_hostile_table.run(hostile, secret, "--color", "always", *reports)
    outputs = {name: file.read_text(encoding="utf-8") for name, file in places.items()}
    narrow, errors = done.stdout.decode("utf-8"), done.stderr.decode("utf-8")
    assert COLOURS.search(narrow)
    outputs |= {"standard output": COLOURS.sub("", narrow), "standard error": errors}
    return Checked(hostile, secret, done.returncode, outputs, tree(root) - before)


def test_each_attack_is_named_at_its_place(checked: Checked) -> None:
    missing = {}
    for attack in make_hostile_table.attacks():
        here = make_hostile_table.found(checked.report, attack)
        lost = [expected for expected in attack["finds"] if make_hostile_table.meant(expected, here) is None]
        if lost:
            missing[attack["id"]] = (lost, [f"{f['code']} {f['place']}" for f in here])
    assert missing == {}
    # What is called a model and is no file could not be read.
    failures = {failure.partition(":")[0].partition("/")[2] for failure in checked.report["failures"]}
    special = (f"special-pipe/{name}" for name in ("model.urdf", "part.xacro", "start.launch", "package/package.xml"))
    assert failures == {*special, "read-links/circle.urdf"}
    assert checked.exit_code == cli.FAILED


def test_every_folder_is_in_the_manifest_and_back() -> None:
    named = [attack["id"] for attack in make_hostile_table.attacks()]
    assert len(named) == len(set(named))
    assert {f.name for f in make_hostile_table.FOLDER.iterdir() if f.is_dir()} <= {*named, *ONE_BY_ONE}


def test_nothing_of_a_file_runs(checked: Checked) -> None:
    assert checked.new == set()


def test_no_secret_of_the_environment_and_no_file_outside_is_in_any_output(checked: Checked) -> None:
    for name, text in checked.outputs.items():
        assert checked.secret not in text, name
        assert "root:x:" not in text, name


def test_no_output_holds_what_a_terminal_obeys_or_hides(checked: Checked) -> None:
    for name, text in checked.outputs.items():
        acting = ACTING.search(text)
        assert acting is None, f"{name}: {text[max(0, acting.start() - 80) : acting.end() + 20]!r}"


def test_no_line_of_an_output_is_a_command_of_a_ci_system(checked: Checked) -> None:
    for name, text in checked.outputs.items():
        command = COMMANDS.search(text)
        assert command is None, f"{name}: {text[max(0, command.start() - 80) : command.end() + 40]!r}"


def test_names_are_still_what_they_are_for_a_program(checked: Checked) -> None:
    named = [f["message"] for f in checked.report["findings"] if "names-workflow" in f["model"]]
    assert any("\n::error file=x::taken\n  ::add-mask::a\r" in message for message in named)
    assert any("##vso[task.setvariable variable=x]y" in message for message in named)


def test_json_keeps_to_the_schema(checked: Checked) -> None:
    schema = json.loads((files("urdfcheck.output") / "report.schema.json").read_text(encoding="utf-8"))
    jsonschema.validate(checked.report, schema)


def test_html_is_inert(checked: Checked) -> None:
    document = read(checked.outputs["html"])
    assert [tag for tag, _ in document.tags if tag in {"iframe", "img", "link", "object", "form", "base"}] == []
    assert [a.get("id", "") for a in document.all("script")] == ["uc-data", "uc-geom", "uc-app", "", ""]
    assert [
        n for _, a in document.tags for n in a if n.startswith("on") or n in {"src", "srcset", "style", "action"}
    ] == []
    assert {a["href"][0] for _, a in document.tags if "href" in a} == {"#"}


def test_the_page_of_the_attacks_is_current(checked: Checked) -> None:
    """Made by tools/make_hostile_table.py."""
    assert (make_hostile_table.FOLDER / "README.md").read_text(encoding="utf-8") == make_hostile_table.table(
        checked.report
    )


def test_a_clone_of_the_attacks_is_small() -> None:
    assert sum(f.stat().st_size for f in make_hostile_table.FOLDER.rglob("*") if f.is_file()) < 300_000


@pytest.mark.long
def test_the_report_does_nothing_in_a_browser(checked: Checked, browser: Any, tmp_path: Path) -> None:
    file = tmp_path / "report.html"
    file.write_text(checked.outputs["html"], encoding="utf-8")
    said: list[str] = []
    page = browser.new_page()
    page.on("console", lambda message: said.append(message.text) if message.type == "error" else None)
    page.on("pageerror", lambda error: said.append(str(error)))
    page.on("dialog", lambda dialog: said.append(dialog.message))
    page.on("request", lambda request: said.append(request.url) if request.url != file.as_uri() else None)
    page.goto(file.as_uri())
    page.evaluate("document.querySelectorAll('details').forEach(d => d.open = true)")
    assert page.title().endswith("· urdfcheck")
    assert "taken" in page.inner_text("body")
    page.close()
    assert said == []


def test_modules_in_the_working_directory_are_not_imported(checked: Checked) -> None:
    """As the command is installed: ``python -m urdfcheck`` would find a planted urdfcheck.py before us."""
    command = Path(sys.executable).with_name("urdfcheck")
    if not command.exists():
        pytest.skip("urdfcheck is not installed as a command here")
    folder = checked.hostile / "exec-planted-files"
    before = tree(folder)
    done = subprocess.run(
        [command, ".", "--no-cache", "-o", f"html={folder / 'report.html'}"], cwd=folder, capture_output=True
    )
    assert (done.returncode, done.stderr) == (cli.OK, b"")
    assert tree(folder) - before == {str(folder / "report.html")}


# -- named one by one, as pre-commit and a pattern of the shell do -------------------------------------------------------

# What a folder's run leaves out, because it is no model there.
ONE_BY_ONE = {"shape-empty": "XML001", "shape-nul": "XML001"}


@pytest.mark.parametrize(("name", "code"), ONE_BY_ONE.items())
def test_a_file_that_is_no_text_is_a_finding_when_it_is_named(checked: Checked, name: str, code: str) -> None:
    done = make_hostile_table.run(checked.hostile / name / "robot.urdf", checked.secret, "--format", "json")
    assert [f["code"] for f in json.loads(done.stdout)["findings"]][:1] == [code]


@pytest.mark.parametrize(
    ("folder", "said"),
    # The devices are links to one, which lies outside.
    [("special-pipe", "neither a file nor a folder"), ("special-device", "outside the folders")],
)
def test_pipes_and_devices_are_named_and_not_opened(checked: Checked, folder: str, said: str) -> None:
    names = ["model.urdf", "part.xacro", "part.stl", "start.launch"]
    done = subprocess.run(
        [sys.executable, "-m", "urdfcheck", *names],
        cwd=checked.hostile / folder,
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert done.returncode == cli.FAILED
    assert done.stdout.count(said) == len(names)


def test_a_folder_called_urdf_brings_no_neighbour_into_reach(checked: Checked, tmp_path: Path) -> None:
    folder = shutil.copytree(checked.hostile / "reach-parent", tmp_path / "downloads")
    done = make_hostile_table.run(folder / "urdf/robot.urdf.xacro", checked.secret, "--format", "json")
    assert [f["code"] for f in json.loads(done.stdout)["findings"]][:1] == ["PKG012"]
    assert b"leak_neighbour" not in done.stdout


def test_a_file_that_is_called_like_an_option_is_none(checked: Checked) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "urdfcheck", *sorted(os.listdir(checked.hostile / "names-of-files"))],
        cwd=checked.hostile / "names-of-files",
        capture_output=True,
    )
    assert done.returncode == cli.FAILED
    assert b"-ohtml=taken.urdf is the name of a file" in done.stderr
    assert not (checked.hostile / "names-of-files" / "taken.urdf").exists()


@pytest.mark.parametrize("encoding", ["ascii", "latin-1"])
@pytest.mark.parametrize("output_format", ["text", "json", "html"])
@pytest.mark.usefixtures("one_process")
def test_a_name_that_is_no_text_can_be_written_in_any_encoding(
    checked: Checked, encoding: str, output_format: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = checked.hostile / "names-of-files"
    monkeypatch.chdir(folder)
    out, said = io.TextIOWrapper(io.BytesIO(), encoding), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(said):
        code = cli.main([".", "--tier", "source", "--format", output_format])
    assert (code, said.getvalue()) == (cli.FINDINGS, "")
    text = out.buffer.getvalue().decode(encoding if output_format == "text" else "utf-8")
    assert not ACTING.search(text)
    assert not COMMANDS.search(text)
    if output_format == "json":
        assert json.loads(text)["summary"]["error"] == len(os.listdir(folder))


@pytest.mark.parametrize("words", [["\n::error::taken\x1b[31m"], ["--\n::error::taken"], ["rule", "\n##[error]taken"]])
def test_what_is_wrong_with_the_command_line_is_told_inertly(words: list[str], tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "urdfcheck", *words], cwd=tmp_path, capture_output=True, text=True, encoding="utf-8"
    )
    assert done.returncode == cli.FAILED
    assert "taken" in done.stdout + done.stderr
    for text in (done.stdout, done.stderr):
        assert not ACTING.search(text)
        assert not COMMANDS.search(text)
