"""The documentation site as it is built: its links lead somewhere, a reader finds a rule, and no other host is asked."""

from __future__ import annotations

import functools
import http.server
import importlib.util
import os
import posixpath
import re
import subprocess
import threading
import zipfile
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlsplit

import pytest
from conftest import REPOSITORY, make_once, unproven
from make_site import build_site
from website.navigation import list_archives

from urdfcheck.rules import load_rules

pytestmark = [pytest.mark.slow, pytest.mark.long]

# What makes a browser load something, by element.
LOADED = {
    "script": "src",
    "link": "href",
    "img": "src",
    "iframe": "src",
    "source": "src",
    "video": "src",
    "audio": "src",
}

_VAGUE = {"click here", "here", "information", "learn more", "more", "read more", "see more", "start", "this"}


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The site, built once for all tests, as strictly as `make site` builds it."""
    if importlib.util.find_spec("material") is None and "CI" not in os.environ:
        unproven("the documentation site: pip install --group docs")

    def build(folder: Path) -> Path:
        build_site(folder / "site", folder / "sources")
        return folder / "site"

    return make_once("site", build, tmp_path_factory)


class Html(HTMLParser):
    """The ids, links and loaded files of a page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.ids: set[str] = set()
        self.links: list[str] = []
        self.loaded: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        found = {name: value or "" for name, value in attributes}
        self.ids |= {found[name] for name in ("id", "name") if name in found}
        if tag == "a" and "href" in found:
            self.links.append(found["href"])
        if tag in LOADED and LOADED[tag] in found:
            self.loaded.append(found[LOADED[tag]])


@functools.cache
def read_html(path: Path) -> Html:
    return Html(path.read_text(encoding="utf-8"))


def is_report(path: Path) -> bool:
    return path.parent.name == "sample" and path.name != "index.html"


def list_pages(site: Path) -> list[Path]:
    return [path for path in site.rglob("*.html") if path.name != "404.html" and not is_report(path)]


def test_every_link_of_the_site_leads_somewhere(site: Path) -> None:
    """Also those in raw HTML, which the generator does not check."""
    pages = list_pages(site)
    assert len(pages) > len(load_rules()) + 30
    for page in pages:
        html = read_html(page)
        for link in (*html.links, *html.loaded):
            parts = urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            target = page if not parts.path else Path(posixpath.normpath(page.parent / unquote(parts.path)))
            target = target / "index.html" if target.is_dir() else target
            assert target.is_file(), f"{page.relative_to(site)}: {link}"
            if parts.fragment and target.suffix == ".html":
                anchors = read_html(target).ids
                assert parts.fragment in anchors or parts.fragment.startswith("__"), f"{page.relative_to(site)}: {link}"


def test_no_page_loads_anything_from_another_host(site: Path) -> None:
    for page in site.rglob("*.html"):
        for address in read_html(page).loaded:
            assert not urlsplit(address).netloc, f"{page.relative_to(site)}: {address}"
    for sheet in site.rglob("*.css"):
        outside = re.findall(r"(?:@import|url\()\s*[\"']?(?:https?:)?//[^\"')]*", sheet.read_text(encoding="utf-8"))
        assert not outside, sheet.relative_to(site)


def test_a_folder_that_readers_copy_is_an_archive_of_what_git_has(site: Path) -> None:
    linked = {link.rpartition("/")[2] for link in read_html(site / "guides/integrations/index.html").links}
    assert {"ament.zip", "ros2.zip", "vscode.zip"} <= linked
    for folder, address in list_archives().items():
        listed = subprocess.run(["git", "ls-files", folder], cwd=REPOSITORY, capture_output=True, text=True, check=True)
        with zipfile.ZipFile(site / address) as packed:
            assert packed.testzip() is None
            names = sorted(f"{Path(folder).parent}/{name}" for name in packed.namelist())
        assert names == sorted(listed.stdout.splitlines())


def test_every_rule_has_its_address_and_nothing_names_this_machine(site: Path) -> None:
    for code, rule in load_rules().items():
        assert f"{code} {rule.name}" in (site / "rules" / code / "index.html").read_text(encoding="utf-8")
    for name in (
        "index.html",
        "sample/car-3.html",
        "sample/demo-arm.html",
        "sample/demo-humanoid.html",
        "files/reports/car-3.json",
        "files/urdfcheck/output/report.schema.json",
    ):
        assert str(REPOSITORY) not in (site / name).read_text(encoding="utf-8")


@pytest.fixture
def address(site: Path) -> Iterator[str]:
    """The address of the site at a plain server."""
    handler = functools.partial(_Silent, directory=str(site))
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}"
        server.shutdown()


class _Silent(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_: object) -> None:
        pass


def test_a_reader_searches_and_filters(address: str, browser: Any) -> None:
    page = browser.new_page()
    asked: list[str] = []
    errors: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    page.on("pageerror", lambda error: errors.append(str(error)))

    page.goto(f"{address}/rules/")
    rows = page.locator(".rule-table tbody tr:visible")
    assert rows.count() == len(load_rules())
    page.get_by_label("program").select_option("gazebo")
    page.get_by_label("severity").select_option("error")
    fewer = rows.count()
    assert 0 < fewer < len(load_rules())
    assert page.locator(".rule-filter output").inner_text() == f"{fewer} of {len(load_rules())} rules"
    page.goto(f"{address}/rules/?words=triangle+inequality")
    assert [text[:6] for text in rows.all_inner_texts()] == ["INR003"]
    assert page.locator(".rule-table:visible").count() == 1

    page.goto(f"{address}/")
    recording = page.locator(".recording img:visible")
    recording.scroll_into_view_if_needed()
    assert recording.get_attribute("src") == "assets/recording-light.svg"
    recording.evaluate("image => image.decode()")
    assert recording.evaluate("image => image.naturalWidth") > 900
    page.locator(".md-search__input").press_sequentially("machine path")
    page.locator(".md-search-result__item a[href*='rules/PKG004/']").first.wait_for()
    page.locator("iframe.report").scroll_into_view_if_needed()
    page.frame_locator("iframe.report").locator("body[data-ready='1']").wait_for()

    assert not errors
    assert {url for url in asked if not url.startswith((address, "blob:", "data:"))} == set()


def test_without_scripts_the_index_is_whole(address: str, browser: Any) -> None:
    page = browser.new_page(java_script_enabled=False)
    page.goto(f"{address}/rules/?words=triangle")
    assert page.locator(".rule-table tbody tr:visible").count() == len(load_rules())
    assert not page.locator(".rule-filter").is_visible()


@pytest.mark.parametrize(("scheme", "width"), [("light", 1280), ("dark", 390)])
def test_anyone_can_use_it(address: str, browser: Any, scheme: str, width: int) -> None:
    axe = pytest.importorskip("axe_playwright_python.sync_playwright")
    page = browser.new_page(color_scheme=scheme, viewport={"width": width, "height": 900})
    page.route("**/sample/*", lambda route: route.abort())  # the report has tests of its own
    for place in (
        "/",
        "/rules/?words=wheel",
        "/rules/INR003/",
        "/guides/demos/",
        "/guides/fix/",
        "/guides/install/",
        "/reference/configuration/",
        "/reference/python-api/",
    ):
        page.goto(f"{address}{place}")
        page.evaluate("new Promise((done) => requestAnimationFrame(() => setTimeout(done)))")  # sizes are known
        found = axe.Axe().run(page, options={"iframes": False}).response["violations"]
        assert not [(place, rule["id"], node["html"]) for rule in found for node in rule["nodes"]]
        # What Lighthouse calls a name that says nothing about the page that a link leads to.
        links = page.locator("a[href]").all_text_contents()
        assert _VAGUE.isdisjoint(" ".join(text.split()).lower() for text in links), place
