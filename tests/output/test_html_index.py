"""The page about many models: what it says without its script, and what the script does."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from urdfcheck import catalogue
from urdfcheck.core import Severity
from urdfcheck.output.html.index import page
from urdfcheck.output.lines import Row, Summary

BROWSER = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")


def row(name: str, errors: int, status: str = "checked", *more: str, mass: float | None = 2.0) -> Row:
    codes = [("INR003", Severity.ERROR, errors)] if errors else []
    codes += [(code, Severity.INFO, 1) for code in more]
    return Row("model", name, name, "robot", status, 12, 11, mass, (errors, 0, len(more)), tuple(codes), ())


ROWS = (
    row("plain/two.urdf", 2),
    row("plain/ten.urdf", 10, "checked", "KIN008", "CTL002", "COL002", "COL005", "PKG001", "PKG002", "XML014"),
    row("other/none.urdf", 0, mass=0.5),
    row("other/stopped.urdf", 0, "stopped", mass=None),
    Row("package", "package.xml", "package.xml", "", "checked", 0, 0, None, (0, 0, 0), (), ()),
    Row("run", "", "", "", "failed", 0, 0, None, (0, 0, 0), (), ("it <broke>",)),
)


@pytest.fixture(scope="module")
def text() -> str:
    return "".join(page(Summary.of(ROWS), ROWS, catalogue.rules(), "1.2.3"))


def test_it_says_all_without_a_script(text: str) -> None:
    body = text.partition("<body")[2].partition("<script>")[0]
    for said in ("4 models", "Not finished", "it &lt;broke&gt;", "triangle-inequality", "INR003", "×10", "and 2 more"):
        assert said in body
    assert body.count("stopped.urdf") == 2  # where it is named, and in its row
    assert "<button" not in body


def test_its_policy_allows_the_one_style_and_the_one_script(text: str) -> None:
    import re

    policy = re.search('Content-Security-Policy" content="(.*?)"', text)
    assert policy is not None
    assert re.fullmatch(
        r"default-src 'none'; style-src 'sha256-\S+'; script-src 'sha256-\S+'; base-uri 'none'; form-action 'none'",
        policy[1],
    )


@pytest.fixture(scope="module")
def opened(text: str, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    playwright = pytest.importorskip("playwright.sync_api")
    if BROWSER is None:
        pytest.skip("no Chromium")
    path = Path(tmp_path_factory.mktemp("index") / "index.html")
    path.write_text(text, encoding="utf-8")
    with playwright.sync_playwright() as p:
        browser = p.chromium.launch(executable_path=BROWSER, args=["--no-sandbox"])
        shown = browser.new_page(viewport={"width": 390, "height": 800})
        shown.said = []
        shown.on("console", lambda message: shown.said.append(message.text))
        shown.goto(path.as_uri())
        yield shown
        browser.close()


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
