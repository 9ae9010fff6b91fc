"""The page about many models: what it says without its script, and what the script does."""

from __future__ import annotations

import base64
import struct
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from output.documents import read
from output.runs import IDENTITY, a_run, finding, info, make_link, scene

from urdfcheck.cli import output_files
from urdfcheck.cli.output_files import CheckedFolders, is_folder_output, write_report
from urdfcheck.core import NotChecked, Severity
from urdfcheck.core.scene import SceneShape
from urdfcheck.output.html import iter_report_pages, make_unique_file_names
from urdfcheck.output.html.index_page import iter_audit_page
from urdfcheck.output.shared.audit.unit_lines import AuditSummary, UnitRow
from urdfcheck.rules import load_rules

pytestmark = pytest.mark.slow


def row(name: str, errors: int, status: str = "checked", *more: str, mass: float | None = 2.0) -> UnitRow:
    codes = [("INR003", Severity.ERROR, errors)] if errors else []
    codes += [(code, Severity.INFO, 1) for code in more]
    return UnitRow(
        kind="model",
        id=name,
        path=name,
        robot="robot",
        status=status,
        links=12,
        joints=11,
        mass=mass,
        counts=(errors, 0, len(more)),
        codes=tuple(codes),
    )


ROWS = (
    row("plain/two.urdf", 2),
    row("plain/ten.urdf", 10, "checked", "KIN008", "CTL002", "COL002", "COL005", "PKG001", "PKG002", "XML014"),
    row("other/none.urdf", 0, mass=0.5),
    row("other/stopped.urdf", 0, "stopped", mass=None),
    UnitRow(kind="package", id="package.xml", path="package.xml", status="checked"),
    UnitRow(kind="run", id="", path="", status="failed", failures=("it <broke>",)),
)


@pytest.fixture(scope="module")
def text() -> str:
    return "".join(iter_audit_page(AuditSummary.from_rows(ROWS), ROWS, rules=load_rules(), version="1.2.3"))


def test_it_says_all_without_a_script(text: str) -> None:
    body = text.partition("<body")[2].partition("<script>")[0]
    for said in (
        "4 models",
        "Not finished: 1 failure",
        "urdfcheck PATH -o html=report.html",
        "it &lt;broke&gt;",
        "triangle-inequality",
        "INR003",
        "×10",
        "and 2 more",
    ):
        assert said in body
    assert body.count("stopped.urdf") == 3  # where it is named, in its row, and for its command
    assert "<button" not in body


def test_it_counts_what_is_known_and_accepted(text: str) -> None:
    rows = (*ROWS, replace(ROWS[0], id="c", suppressed=("baseline", "source", "baseline")))
    page = "".join(iter_audit_page(AuditSummary.from_rows(rows), rows, rules=load_rules(), version="1.2.3"))
    assert "<dt>Known findings</dt><dd>3: 1 in the source, 2 in the baseline</dd>" in page
    assert "Known findings" not in text


def test_its_policy_allows_the_one_style_and_the_one_script(text: str) -> None:
    import re

    policy = re.search('Content-Security-Policy" content="(.*?)"', text)
    assert policy is not None
    assert re.fullmatch(
        r"default-src 'none'; style-src 'sha256-\S+'; script-src 'sha256-\S+'; img-src data:; "
        r"base-uri 'none'; form-action 'none'",
        policy[1],
    )


@pytest.fixture(scope="module")
def opened(text: str, browser: Any, tmp_path_factory: pytest.TempPathFactory) -> Any:
    path = Path(tmp_path_factory.mktemp("index") / "index.html")
    path.write_text(text, encoding="utf-8")
    shown = browser.new_page(viewport={"width": 390, "height": 800})
    shown.said = []
    shown.on("console", lambda message: shown.said.append(message.text))
    shown.goto(path.as_uri())
    return shown


def test_a_model_without_a_page_has_the_command_that_makes_one(opened: Any) -> None:
    button = opened.locator("#models tbody tr", has_text="ten.urdf").locator(".copy-command")
    assert button.get_attribute("data-command") == "urdfcheck plain/ten.urdf -o html=report.html"
    assert opened.locator("#models tbody .copy-command").count() == 4, "a package has no such report"
    button.click()
    opened.get_by_text("The command copied").wait_for(state="attached")


def names(opened: Any) -> list[str]:
    return [name.split("/")[-1] for name in opened.locator("#models tbody tr:visible th code").all_inner_texts()]


def test_in_a_browser_it_is_sorted_filtered_and_fits(opened: Any) -> None:
    assert opened.evaluate("document.documentElement.scrollWidth") == 390
    opened.click("#models th:nth-child(2) button")
    assert names(opened)[:2] == ["ten.urdf", "two.urdf"]
    opened.click("#models th:nth-child(2) button")
    assert names(opened)[-1] == "ten.urdf"
    opened.click("#models th:nth-child(8) button")
    assert names(opened)[2:3] == ["none.urdf"]
    opened.fill("#find", "xml014")  # a rule that the row does not show
    assert names(opened) == ["ten.urdf"]
    assert opened.inner_text("#shown") == "1 of 5 shown"
    opened.click("#rules a[data-find=INR003]")
    assert sorted(names(opened)) == ["ten.urdf", "two.urdf"]
    opened.fill("#find", "other")
    opened.select_option("#status", "stopped")
    assert names(opened) == ["stopped.urdf"]
    assert opened.said == []


# -- a report as a folder ----------------------------------------------------------------------------------------------


def folder() -> dict[str, str]:
    models = tuple(info(id=f"{robot}/{i}.urdf", path=f"{i}.urdf", robot=robot) for i, robot in enumerate(ROBOTS))
    findings = [finding(model=models[0].id), finding(model=models[2].id, severity=Severity.INFO)]
    package = finding(code="PKG006", name="licence", model="rover/package.xml", severity=Severity.WARNING)
    return dict(iter_report_pages(a_run(*findings, package, models=models, scenes=(scene(model=models[0].id),))))


ROBOTS = ("rover", "Rover", "../a<b>", "index", "con")


def test_a_folder_has_a_page_for_each_model_and_one_with_a_row_for_each() -> None:
    files = folder()
    assert list(files) == [
        *("rover.html", "Rover-2.html", "a-b.html", "index-2.html", "robot-con.html", "package.xml.html"),
        "index.html",
    ]
    index = read(files["index.html"])
    rows = [a["href"] for _, a in index.tags if a.get("href", "").endswith(".html")]
    assert rows == list(files)[:-1]
    for name in rows:
        assert any(a.get("href") == "index.html" for _, a in read(files[name]).tags)
    assert "1 error: MuJoCo refuses this model" in files["rover.html"]
    assert "No errors and no warnings" in files["Rover-2.html"]
    assert "uc-app" in files["rover.html"]
    assert "uc-app" not in files["Rover-2.html"], "there is no robot to draw"
    assert "<h1>package.xml</h1>" in files["package.xml.html"]
    assert "5 models" in index.text


def test_the_index_has_a_picture_of_each_robot_that_is_drawn() -> None:
    shapes = (SceneShape(role="visual", kind="box", size=(1.0, 1.0, 1.0), pose=IDENTITY),)
    boxy = scene(links=(make_link("base", shapes=shapes),), joints=(), frames=(), meshes=())
    index = dict(iter_report_pages(a_run(finding(), models=(info(), info(id="2", path="b")), scenes=(boxy,))))[
        "index.html"
    ]
    (picture,) = read(index).all("img")
    head = base64.b64decode(picture["src"].removeprefix("data:image/png;base64,"))[:24]
    assert struct.unpack(">II", head[16:]) == (160, 120)
    assert (picture["width"], picture["height"], picture["alt"]) == ("80", "60", "")


def test_the_index_says_why_a_model_was_not_checked_and_links_to_its_page() -> None:
    why = NotChecked("package sick is not installed", "--package sick=FOLDER")
    unread = info(id="arm.urdf", path="arm.urdf", robot="", status="needs-arguments", not_checked=why)
    index = dict(iter_report_pages(a_run(finding(), models=(info(), unread), scenes=())))["index.html"]
    notice = index.split("<h2>What was not checked</h2>")[1].split("</section>")[0]
    assert '<a href="arm.urdf.html"><code>arm.urdf</code></a>: package sick is not installed' in notice
    assert "<code>urdfcheck arm.urdf --package sick=FOLDER</code>" in notice
    assert "copy-command" in notice
    assert '<option value="needs-arguments">needs arguments</option>' in index
    assert "1 of 2 models was not checked. 1 error in 1 of 2 models" in read(index).text


def test_the_index_names_files_like_the_pages() -> None:
    """From where the command ran, whatever the root that the ids count from; with the arguments of a variant."""
    models = tuple(info(id=f"sub/urdf/a.xacro{args}", path="urdf/a.xacro") for args in ("", " side:=left"))
    index = dict(iter_report_pages(a_run(finding(), models=models, scenes=())))["index.html"]
    assert "<code>urdf/<wbr>a.xacro</code>" in index
    assert "<code>urdf/<wbr>a.xacro side:=left</code>" in index
    assert "sub/" not in index


def test_what_failed_is_told_on_every_page() -> None:
    run = a_run(finding(), models=(info(),), failures=("INR003 crashed",))
    assert all("INR003 crashed" in text for _, text in iter_report_pages(run))


def test_names_of_files_are_safe_and_differ() -> None:
    many = make_unique_file_names(["x"] * 3 + ["x-2", "", "..", "Nul.a", "ü" * 9, "y" * 200])
    assert many[:6] == ["x.html", "x-2.html", "x-3.html", "x-2-2.html", "model.html", "model-2.html"]
    assert many[6:8] == ["robot-Nul.a.html", "model-3.html"]
    assert len(many[8]) < 80


def test_a_folder_is_meant_by_its_end_or_by_being_there(tmp_path: Path) -> None:
    (tmp_path / "there.d").mkdir()
    (tmp_path / "file").touch()
    asked = ("new", "new.d/", "there.d", "report.html", "file")
    assert [is_folder_output(f"html={tmp_path}/{name}") for name in asked] == [True, True, True, False, False]
    assert not is_folder_output("html=/dev/null")
    assert not is_folder_output(f"json={tmp_path}/new")


def test_a_report_that_browsers_are_slow_with_says_what_to_do(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    models = (info(id="1"), info(id="2"))
    run = a_run(finding(model="1"), finding(model="2"), models=models, scenes=())
    write_report(run, "html", tmp_path / "small.html", checked=CheckedFolders())
    assert capsys.readouterr().err == ""
    monkeypatch.setattr(output_files, "LARGEST", 1000)
    write_report(run, "html", tmp_path / "all.html", checked=CheckedFolders())
    assert "-o html=FOLDER/ gives each model a page" in capsys.readouterr().err
    write_report(run, "html", tmp_path / "pages", as_pages=True, checked=CheckedFolders())
    assert sorted(p.name for p in (tmp_path / "pages").iterdir()) == ["index.html", "rover-2.html", "rover.html"]
