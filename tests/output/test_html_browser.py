"""The HTML report in a real browser: its policy holds, it fits the screen, and paper shows everything."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from output.runs import a_run, chain, finding, scene

from urdfcheck.output.html import render

playwright = pytest.importorskip("playwright.sync_api")
BROWSER = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
pytestmark = pytest.mark.skipif(BROWSER is None, reason="no Chromium")


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with playwright.sync_playwright() as p:
        browser = p.chromium.launch(executable_path=BROWSER, args=["--no-sandbox"])
        yield browser
        browser.close()


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> str:
    path = tmp_path_factory.mktemp("html") / "report.html"
    long = finding(message="a_name_without_a_break_" * 30, subjects=("link[" + "x" * 300 + "]",))
    run = a_run(*a_run().findings, long, scenes=(scene(),))
    path.write_text(render(run), encoding="utf-8")
    return path.as_uri()


def opened(browser: Any, url: str, **options: Any) -> Any:
    page = browser.new_page(**options)
    page.said = []
    page.on("console", lambda message: page.said.append(message.text))
    page.on("request", lambda request: page.said.append(request.url) if request.url != url else None)
    page.goto(url)
    return page


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_style_passes_its_own_policy_and_nothing_is_fetched(browser: Any, report: str, scheme: str) -> None:
    page = opened(browser, report, color_scheme=scheme)
    ground = page.evaluate("getComputedStyle(document.body).backgroundColor")
    assert ground == {"light": "rgb(246, 247, 249)", "dark": "rgb(16, 19, 22)"}[scheme]
    assert page.said == []


def test_policy_stops_what_a_bug_might_let_in(browser: Any, tmp_path: Path) -> None:
    hostile = "<script>document.title='taken'</script><img src=x onerror=\"document.title='taken'\"><main id=content>"
    path = tmp_path / "hostile.html"
    path.write_text(render(a_run()).replace('<main id="content">', hostile), encoding="utf-8")
    assert opened(browser, path.as_uri()).title() == "rover · urdfcheck"


@pytest.mark.parametrize("width", [390, 768, 1280, 1600, 2560, 3840])
def test_only_boxes_scroll_sideways(browser: Any, report: str, width: int) -> None:
    page = opened(browser, report, viewport={"width": width, "height": 900})
    page.evaluate("document.querySelectorAll('details').forEach(d => d.open = true)")
    assert page.evaluate("document.documentElement.scrollWidth") <= width


def test_filter_hides_a_severity_without_a_script(browser: Any, report: str) -> None:
    page = opened(browser, report, java_script_enabled=False)
    assert page.locator(".card.warning").is_visible()
    page.locator("#show-warning").uncheck()
    assert page.locator(".card.warning").is_hidden()
    assert page.locator(".card.error").first.is_visible()


def test_a_deep_link_opens_what_it_points_into(browser: Any, report: str) -> None:
    page = opened(browser, report)
    page.locator("details >> text=The tree as a list").click()
    page.locator(".kinematics details a").first.click()
    assert "#f-" in page.url
    assert page.locator(":target").is_visible()


def test_a_link_to_a_rule_opens_its_page(browser: Any, report: str) -> None:
    page = opened(browser, report)
    assert page.locator("#rule-INR003").is_hidden()
    page.locator(".card h5 a").first.click()
    page.locator("#rule-INR003").wait_for(state="visible")


def test_filter_acts_on_the_list_of_problems_too(browser: Any, report: str) -> None:
    page = opened(browser, report)
    assert page.locator(".contents .warning").is_visible()
    page.locator("#show-warning").uncheck()
    assert page.locator(".contents .warning").is_hidden()


@pytest.mark.parametrize("width", [390, 1280, 1440, 2560])
def test_cards_tables_and_drawing_end_at_one_edge(browser: Any, report: str, width: int) -> None:
    page = opened(browser, report, viewport={"width": width, "height": 900})
    edges = {
        round(box["x"] + box["width"])
        for box in (each.bounding_box() for each in page.locator(".scroll, .card").all() if each.is_visible())
    }
    assert len(edges) == (1 if width < 1600 else 2), "wide pages have two columns"


def test_links_table_fits_a_laptop(browser: Any, report: str) -> None:
    page = opened(browser, report, viewport={"width": 1280, "height": 900})
    assert page.locator(".links .scroll").evaluate("box => box.scrollWidth <= box.clientWidth")


def test_paper_shows_what_is_folded_on_the_screen(browser: Any, report: str) -> None:
    page = opened(browser, report, color_scheme="dark")
    folded = page.locator("details.via figure").first
    assert folded.is_hidden()
    page.emulate_media(media="print")
    assert folded.is_visible()
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"
    assert page.locator("nav").is_hidden()


def test_without_style_the_report_still_reads(browser: Any, tmp_path: Path) -> None:
    """Some servers replace the policy by one that blocks every inline style."""
    html = render(a_run(scenes=(chain(3),)))
    page = browser.new_page(java_script_enabled=False)
    policy = {"Content-Security-Policy": "sandbox; default-src 'none'; style-src 'self'"}
    page.route("**/*", lambda r: r.fulfill(body=html, content_type="text/html; charset=utf-8", headers=policy))
    page.goto("http://report.test/")
    assert page.locator("body").evaluate("e => getComputedStyle(e).backgroundColor") == "rgba(0, 0, 0, 0)"
    for part in (".card.error", "mark >> nth=0", "svg.graph >> nth=0", "table >> nth=0"):
        assert page.locator(part).is_visible()
    assert page.locator("fieldset").is_hidden()
