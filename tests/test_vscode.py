"""The extension of VS Code: it compiles, is packaged, and its panel shows what is at the cursor."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from conftest import REPOSITORY, unproven

import urdfcheck
from urdfcheck.output import concise, html

SOURCE = REPOSITORY / "editors" / "vscode"
CAR = REPOSITORY / "fixtures" / "car-3" / "urdf" / "car-3.urdf"
MANIFEST: dict[str, Any] = json.loads((SOURCE / "package.json").read_text(encoding="utf-8"))


def read_sources() -> str:
    return "\n".join(path.read_text(encoding="utf-8") for path in sorted((SOURCE / "src").rglob("*.ts")))


@pytest.fixture(scope="module")
def run() -> urdfcheck.core.Run:
    return urdfcheck.check(CAR, scene=True)


def test_the_problem_matcher_reads_the_concise_format(run: urdfcheck.core.Run) -> None:
    (matcher,) = MANIFEST["contributes"]["problemMatchers"]
    pattern = matcher["pattern"]
    found = [re.match(pattern["regexp"], line) for line in concise.render(run).splitlines()]
    assert len(found) == len(list(run.active_findings)) > 0
    for match in found:
        assert match is not None
        assert match[pattern["file"]].endswith("car-3.urdf")
        assert match[pattern["code"]] in run.rules


def test_what_it_asks_for_is_what_the_server_offers() -> None:
    commands = pytest.importorskip("urdfcheck.server.report.commands", reason="pygls is not installed")
    asked = set(re.findall(r'"(urdfcheck\.\w+)"', read_sources()))
    own = {command["command"] for command in MANIFEST["contributes"]["commands"]}
    settings = set(MANIFEST["contributes"]["configuration"]["properties"])
    offered = {getattr(commands, name) for name in ("SHOW_REPORT", "WRITE_REPORT", "FIND_SELECTION", "AWAIT_VERDICT")}
    others = {"urdfcheck.verdict", "urdfcheck.report", "urdfcheck.exe"}
    assert offered <= asked
    assert own <= asked
    assert asked <= own | settings | offered | others
    assert not own & offered, "VS Code has one command of a name"


def test_it_has_the_version_of_urdfcheck_and_sends_nothing() -> None:
    assert MANIFEST["version"] == urdfcheck.__version__
    assert not re.search(r"\bfetch\(|https?://|XMLHttpRequest|telemetry", read_sources())


@pytest.fixture(scope="module")
def extension(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the extension with the packages that it is built with, and built."""
    if shutil.which("node") is None or shutil.which("npm") is None:
        return unproven("the extension of VS Code: there is no Node.js")
    folder = tmp_path_factory.mktemp("repository") / "editors" / "vscode"
    has_packages = (SOURCE / "node_modules").is_dir()
    ignored = shutil.ignore_patterns("dist", "*.vsix", "node_modules")
    shutil.copytree(SOURCE, folder, ignore=ignored)
    shutil.copy(REPOSITORY / "LICENSE", folder.parents[1])
    if has_packages:
        (folder / "node_modules").symlink_to(SOURCE / "node_modules")
    elif subprocess.run(["npm", "ci"], cwd=folder, capture_output=True, timeout=300).returncode:
        return unproven("the extension of VS Code: npm could not fetch its packages")
    run_script(folder, "build")
    return folder


def run_script(folder: Path, *words: str) -> None:
    done = subprocess.run(["npm", "run", *words], cwd=folder, capture_output=True, text=True, timeout=180)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.slow
@pytest.mark.long
@pytest.mark.parametrize("script", ["check", "lint"])
def test_its_types_and_style_hold(extension: Path, script: str) -> None:
    run_script(extension, script)


@pytest.mark.slow
@pytest.mark.long
def test_the_package_holds_what_it_runs_and_nothing_else(extension: Path, tmp_path: Path) -> None:
    package = tmp_path / "urdfcheck.vsix"
    run_script(extension, "package", "--", "--out", str(package))
    with zipfile.ZipFile(package) as archive:
        names = set(archive.namelist())
        assert f"extension/{MANIFEST['main'].removeprefix('./')}" in names
        shipped = {name for name in names if name.startswith("extension/")}
        assert {Path(name).name.lower() for name in shipped} == {
            *("package.json", "readme.md", "license.txt"),
            *("extension.js", "follow.js", "panel.css"),
        }
        assert "source" not in json.loads(archive.read("extension/package.json")).get("main", "")
    assert package.stat().st_size < 300_000


# -- the panel ---------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def panel(
    extension: Path, browser: Any, run: urdfcheck.core.Run, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Any]:
    """The page of the panel, as wide as beside a text. ``editor`` in it stands for VS Code: it keeps what the page tells it."""
    folder = tmp_path_factory.mktemp("panel")
    (folder / "report.html").write_text(html.render(run), encoding="utf-8")
    made = ["node", "test/make_page.mjs", str(folder / "report.html"), str(folder / "page.html")]
    subprocess.run(made, cwd=extension, check=True, timeout=60)
    page = browser.new_page(viewport={"width": 700, "height": 900}, reduced_motion="reduce")
    page.wrong = []
    page.on("pageerror", lambda error: page.wrong.append(str(error)))
    page.on("console", lambda message: page.wrong.append(message.text) if message.type == "error" else None)
    page.add_init_script(
        "window.heard = []; window.acquireVsCodeApi = () => ({ postMessage: (message) => heard.push(message) });"
        "addEventListener('DOMContentLoaded', () => { document.body.dataset.vscodeThemeKind = 'vscode-dark'; });"
    )
    page.goto((folder / "page.html").as_uri())
    page.wait_for_selector("body[data-ready]")
    yield page
    page.close()


def measure(panel: Any, element: str) -> tuple[float, float]:
    """The top and the bottom of an element in the window."""
    box = panel.evaluate(f"document.getElementById('{element}').getBoundingClientRect().toJSON()")
    return box["top"], box["bottom"]


def wait_until_at_rest(panel: Any, number: str) -> None:
    """Wait until a number of the page stays for three frames."""
    frame = (
        "new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => requestAnimationFrame(done))))"
    )
    for _ in range(100):
        before = panel.evaluate(number)
        panel.evaluate(frame)
        if panel.evaluate(number) == before:
            return


def select(panel: Any, **selection: str) -> None:
    panel.evaluate("selection => window.postMessage({ type: 'select', ...selection }, '*')", selection)


@pytest.mark.slow
@pytest.mark.long
def test_the_panel_shows_what_is_at_the_cursor(panel: Any) -> None:
    assert panel.evaluate("heard[0].type") == "ready"
    select(panel, link="wheel_2")
    panel.wait_for_selector("body[data-selected=wheel_2]")
    select(panel, joint="wheel_3_to_base_link")
    panel.wait_for_selector("body[data-selected=wheel_3]")
    card = panel.evaluate("document.querySelector('.card[data-code=SYM001]').id")
    select(panel, finding=card, link="base_link")
    panel.wait_for_selector("body[data-selected=wheel_1]")
    panel.wait_for_selector(f"#{card}[aria-current=true] .more[open]")
    # The robot stays in sight, and the card is below it; the focus stays in the text.
    wait_until_at_rest(panel, f"document.getElementById('{card}').getBoundingClientRect().top")
    assert measure(panel, card)[0] >= measure(panel, "viewer")[1]
    assert measure(panel, "viewer")[0] == 0
    assert panel.evaluate("document.activeElement === document.body")
    select(panel)
    panel.wait_for_selector("body[data-selected='']")


@pytest.mark.slow
@pytest.mark.long
def test_a_finding_that_the_report_has_not_yet_is_no_obstacle(panel: Any) -> None:
    select(panel, finding="f-0123", link="wheel_4")
    panel.wait_for_selector("body[data-selected=wheel_4]")


@pytest.mark.slow
@pytest.mark.long
def test_a_click_on_a_place_opens_it(panel: Any) -> None:
    panel.evaluate("document.querySelector('.card[data-code=SYM001] code.place').click()")
    assert re.fullmatch(r".*car-3\.urdf:88(:12)?", panel.evaluate("heard.at(-1).place"))


@pytest.mark.slow
@pytest.mark.long
def test_the_panel_takes_the_theme_and_runs_no_other_script(panel: Any) -> None:
    panel.evaluate("document.body.dataset.vscodeThemeKind = 'vscode-high-contrast-light'")
    panel.wait_for_selector("html[data-theme=light]")
    panel.evaluate("document.body.dataset.vscodeThemeKind = 'vscode-dark'")
    panel.wait_for_selector("html[data-theme=dark]")
    assert panel.wrong == []
    script = "const s = document.createElement('script'); s.textContent = 'window.ran = 1'; document.body.append(s);"
    assert panel.evaluate(f"() => {{ {script} return window.ran }}") is None
    assert "Content Security Policy" in panel.wrong.pop()
