"""The HTML report in a real browser: its policy holds, it fits the screen, it can be searched, and paper shows everything."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from output.runs import a_run, chain, finding

from urdfcheck.core import Location, Suppression
from urdfcheck.output.html import render

pytestmark = [pytest.mark.slow, pytest.mark.long]

WIDTHS = (390, 768, 1280, 1600, 2560, 3840)


def about(of: str, **changes: Any) -> Any:
    """A finding about a link."""
    subject = f"link[{of}]/inertial"
    return finding(location=Location(subject, finding().location.span), subjects=(subject,), **changes)


LONG = finding(message="a_name_without_a_break_" * 30, subjects=("link[" + "x" * 300 + "]",), related=())
RUN = a_run(
    *a_run().findings,
    LONG,
    about("base", code="INR001", name="mass-not-positive", message="the base weighs nothing", message_id="m"),
    about("base", message="a decimal point was lost", message_id="known", suppressed=Suppression("source", "a dummy")),
    rules=a_run().rules,
)


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> str:
    path = tmp_path_factory.mktemp("html") / "report.html"
    path.write_text(render(RUN), encoding="utf-8")
    return path.as_uri()


@pytest.fixture(scope="module")
def plain(tmp_path_factory: pytest.TempPathFactory) -> str:
    """A report without the robot in 3D, which opens faster."""
    path = tmp_path_factory.mktemp("html") / "plain.html"
    path.write_text(render(a_run(scenes=())), encoding="utf-8")
    return path.as_uri()


def opened(browser: Any, url: str, **options: Any) -> Any:
    """A page; ``said`` has what went wrong there and what it tried to fetch."""
    page = browser.new_page(**options)
    page.said = []
    page.on("console", lambda message: page.said.append(message.text) if message.type == "error" else None)
    page.on("pageerror", lambda error: page.said.append(str(error)))
    page.on("request", lambda request: page.said.append(request.url) if request.url != url else None)
    page.goto(url)
    return page


def ready(page: Any) -> Any:
    page.wait_for_selector("body[data-ready], body[data-error]")
    return page


@pytest.fixture(scope="module")
def shared(browser: Any, report: str) -> Any:
    """One page for all tests that leave it as they found it."""
    return ready(opened(browser, report, viewport={"width": 1440, "height": 900}))


@pytest.fixture
def page(shared: Any) -> Iterator[Any]:
    yield shared
    shared.keyboard.press("Escape")
    assert shared.locator(".card[hidden]").count() == 0
    assert shared.said == []


@contextmanager
def unfolded(page: Any) -> Iterator[None]:
    """All that is folded is open meanwhile."""
    folds = page.evaluate_handle("Array.from(document.querySelectorAll('details:not([open])'))")
    folds.evaluate("all => all.forEach((fold) => { fold.open = true; })")
    yield
    folds.evaluate("all => all.forEach((fold) => { fold.open = false; })")


def shown(page: Any) -> list[str]:
    """The codes of the cards that are to be seen."""
    return page.eval_on_selector_all(
        ".card", "all => all.filter((c) => !c.closest('[hidden]')).map((c) => c.dataset.code)"
    )


def wait_for_count(page: Any, count: str) -> None:
    """Waits for the search: each letter starts one, and the page shows the result of the first before the last is typed."""
    page.wait_for_function("count => document.getElementById('shown').innerText === count", arg=count)


def heads(page: Any) -> list[str]:
    """What stands above the groups that are to be seen."""
    return [" ".join(text.split()) for text in page.locator(".group > h3:visible").all_inner_texts()]


# -- one safe file that fits -------------------------------------------------------------------------------------------


def test_policy_stops_what_a_bug_might_let_in(browser: Any, tmp_path: Path) -> None:
    hostile = "<script>document.title='taken'</script><img src=x onerror=\"document.title='taken'\"><main id=content>"
    path = tmp_path / "hostile.html"
    path.write_text(render(a_run(scenes=())).replace('<main id="content">', hostile), encoding="utf-8")
    assert opened(browser, path.as_uri()).title() == "rover · urdfcheck"


def test_only_boxes_scroll_sideways(shared: Any) -> None:
    before = shared.viewport_size
    widths = {}
    with unfolded(shared):
        for width in WIDTHS:
            shared.set_viewport_size({"width": width, "height": 900})
            widths[width] = shared.evaluate("document.documentElement.scrollWidth")
    shared.set_viewport_size(before)
    assert {width: wide for width, wide in widths.items() if wide > width} == {}


@pytest.mark.parametrize(
    ("scheme", "ground"),
    [("light", "rgb(246, 247, 249)"), ("dark", "rgb(16, 19, 22)")],
)
def test_anyone_can_use_it(page: Any, scheme: str, ground: str) -> None:
    from axe_playwright_python.sync_playwright import Axe

    page.emulate_media(color_scheme=scheme)
    page.click("#more")
    # What is not near the screen is not drawn, and could not be judged.
    page.evaluate("document.querySelectorAll('.card').forEach((c) => { c.style.contentVisibility = 'visible'; })")
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") == ground
    with unfolded(page):
        found = Axe().run(page, options={"rules": {"target-size": {"enabled": True}}})
    assert [(v["id"], [n["html"] for n in v["nodes"]]) for v in found.response["violations"]] == []
    page.click("#more")


def test_the_judge_of_that_is_awake(page: Any) -> None:
    from axe_playwright_python.sync_playwright import Axe

    page.evaluate("document.documentElement.lang = ''")
    found = Axe().run(page, options={"runOnly": ["html-has-lang"]})
    page.evaluate("document.documentElement.lang = 'en'")
    assert found.violations_count == 1


def test_without_script_all_is_said_and_severities_are_filtered(browser: Any, report: str) -> None:
    page = opened(browser, report, java_script_enabled=False, viewport={"width": 1440, "height": 900})
    assert page.locator("#viewer").is_hidden()
    assert page.locator("main").bounding_box()["width"] > 1300
    assert page.locator(".act:visible, .in-3d:visible, .filters:visible").count() == 0
    assert page.locator(".card.warning").is_visible()
    page.locator("#show-warning").uncheck()
    assert page.locator(".card.warning").is_hidden()
    assert page.locator(".card.error").first.is_visible()
    assert page.locator("#m1-consumers").is_hidden()
    page.click(".programs a[data-program=mujoco]")
    assert page.locator("#m1-consumers").is_visible(), "the browser opens the fold that the link leads into"
    card = page.locator(".card.error:not(.first)").first
    card.locator(".more > summary").click()
    assert card.locator(".message").is_visible()


def test_without_style_the_report_still_reads(browser: Any, tmp_path: Path) -> None:
    """Some servers replace the policy by one that blocks every inline style and script."""
    html = render(a_run(scenes=(chain(3),)))
    page = browser.new_page(java_script_enabled=False)
    policy = {"Content-Security-Policy": "sandbox; default-src 'none'; style-src 'self'"}
    page.route("**/*", lambda r: r.fulfill(body=html, content_type="text/html; charset=utf-8", headers=policy))
    page.goto("http://report.test/")
    assert page.locator("body").evaluate("e => getComputedStyle(e).backgroundColor") == "rgba(0, 0, 0, 0)"
    for part in (".card.error", "mark >> nth=0", ".programs a >> nth=0", ".section > summary >> nth=0"):
        assert page.locator(part).is_visible()
    assert page.locator("button:visible, input:visible, select:visible").count() == 0


def test_paper_shows_what_is_folded_and_the_robot(browser: Any, report: str) -> None:
    page = ready(opened(browser, report, color_scheme="dark"))
    page.wait_for_selector("#uc-print[src^='data:image/png']", state="attached")
    shown = [".card.warning .message", ".card.warning .typed", "#m1-physics table", "#m1-tree svg >> nth=0"]
    assert [part for part in shown if page.locator(part).is_visible()] == []
    page.emulate_media(media="print")
    assert [part for part in shown if page.locator(part).is_hidden()] == []
    assert page.locator(".evidence").first.is_hidden()
    assert page.locator("#rule-INR003").is_hidden(), "paper names the rules and does not quote them"
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"
    assert page.locator("#uc-print").bounding_box()["y"] < 700
    for part in (
        "nav >> nth=0",
        "button >> nth=0",
        "canvas >> nth=0",
        "#find",
        ".more > summary >> nth=0",
        ".copy-place >> nth=0",
    ):
        assert page.locator(part).is_hidden()
    names = page.locator(".card:not(.known) .at > .names button").all()
    assert names
    assert all(name.is_visible() for name in names), "a link's name is no button on paper"
    assert page.locator(".card .minds").first.evaluate("line => getComputedStyle(line).display") == "flex"


# -- search, filters, groups -------------------------------------------------------------------------------------------


def test_search_takes_all_words_from_message_code_name_and_file(page: Any) -> None:
    page.keyboard.press("/")
    page.keyboard.type("ROVER.urdf inr001 nothing")
    wait_for_count(page, "1 of 5 shown")
    assert shown(page) == ["INR001"]
    assert heads(page) == []
    assert page.locator(".section:visible, #rules:visible, #about:visible, .fold > summary:visible").count() == 0
    page.click("#reset")
    assert len(shown(page)) == 6
    assert page.input_value("#find") == ""


def test_search_finds_the_place_that_a_card_shows(page: Any) -> None:
    place = page.locator(".card .at .place").first.inner_text()
    assert place.startswith("rover.urdf:")
    page.fill("#find", place)
    page.wait_for_selector("#shown:not(:empty)")
    assert shown(page)
    page.click("#reset")


def test_what_is_not_found_is_said(page: Any) -> None:
    page.fill("#find", "zzz")
    page.wait_for_selector("#nothing:visible")
    assert page.inner_text("#nothing") == 'No finding matches "zzz".'
    assert page.locator("main > :visible").count() == 1, "nothing else is in the way"
    page.keyboard.press("Escape")
    assert page.locator("#nothing").is_hidden()


def test_a_chip_filters_to_what_its_program_minds(page: Any) -> None:
    mujoco, rviz = (page.locator(".programs button", has_text=name) for name in ("MuJoCo", "RViz"))
    assert mujoco.get_attribute("aria-pressed") == "false"
    mujoco.focus()
    page.keyboard.press("Enter")
    assert mujoco.get_attribute("aria-pressed") == "true"
    assert page.inner_text("#chip") == "MuJoCo ×"
    found = page.eval_on_selector_all(".card:not([hidden])", "all => all.map((c) => c.dataset.programs)")
    assert len(found) == 5, "the suppressed finding is a reason too"
    assert all("mujoco" in programs for programs in found)
    top = page.locator(".card:visible").first.bounding_box()["y"]
    bar = page.locator(".bar").bounding_box()
    assert top >= bar["y"] + bar["height"], "the list is not under the bar"
    rviz.click()
    assert mujoco.get_attribute("aria-pressed") == "false"
    assert page.inner_text("#nothing") == "No finding matches these filters."
    rviz.click()
    assert page.locator("#nothing").is_hidden()


def test_a_chip_whose_reasons_are_not_reported_says_so(browser: Any, tmp_path: Path) -> None:
    path = tmp_path / "unasked.html"
    hidden = finding(consequences={"mujoco": "replaces the inertia"})
    path.write_text(render(a_run(about("base", consequences={}), unrequested=(hidden,))), encoding="utf-8")
    page = opened(browser, path.as_uri())
    page.locator(".programs button.warning", has_text="MuJoCo").click()
    assert page.inner_text("#nothing").startswith("Why MuJoCo minds is in notes that only -v reports")
    page.locator(".programs button.ok").first.click()
    assert page.inner_text("#nothing") == "No finding matches these filters."
    assert page.said == []


def test_notes_are_found_like_problems(page: Any) -> None:
    page.fill("#find", "axle")
    page.wait_for_selector("#shown:not(:empty)")
    assert page.locator(".notes .card").is_visible()


def test_tables_are_sorted_by_their_heads(page: Any) -> None:
    page.evaluate("for (const s of document.querySelectorAll('.section')) s.open = true")
    names = "all => all.map((row) => row.cells[0].querySelector('code').innerText)"
    rows = "#m1-physics tbody tr"
    assert page.eval_on_selector_all(rows, names) == ["base", "wheel"]
    mass = page.locator("#m1-physics thead button").nth(1)
    head = page.locator("#m1-physics thead th").nth(1)
    mass.focus()
    page.keyboard.press("Enter")
    assert (head.get_attribute("aria-sort"), page.eval_on_selector_all(rows, names)) == (
        "descending",
        ["base", "wheel"],
    )
    page.keyboard.press("Enter")
    assert (head.get_attribute("aria-sort"), page.eval_on_selector_all(rows, names)) == ("ascending", ["wheel", "base"])
    page.locator("#m1-physics thead button", has_text="Link").click()
    assert head.get_attribute("aria-sort") is None
    assert page.eval_on_selector_all(rows, names) == ["base", "wheel"]
    assert page.locator("#m1-joints thead button").count() >= 6
    assert page.locator("#m1-meshes thead button").count() == 9
    in_view = page.eval_on_selector_all(
        "#m1-physics thead th",
        "all => all.filter((h) => h.getBoundingClientRect().right <= h.closest('.scroll').getBoundingClientRect().right).length",
    )
    assert in_view >= 9, "mass, density and how far the link is from its solid"
    page.evaluate("for (const s of document.querySelectorAll('.section')) s.open = false")


def test_a_closed_card_is_its_claim_and_its_place(page: Any) -> None:
    first, second = page.locator(".card.first"), page.locator(".card.error:not(.first)").first
    assert [
        first.locator(part).is_visible()
        for part in (".headline", ".place >> nth=0", ".hit >> nth=0", ".minds", ".message")
    ] == [*(True, True, True, True, False)]
    assert [
        second.locator(part).is_visible() for part in (".headline", ".place >> nth=0", ".typed", ".minds", ".message")
    ] == [*(True, True, False, False, False)]
    second.locator(".headline").click()
    assert [
        second.locator(part).is_visible()
        for part in (".typed", ".minds", ".message", ".fix .diff", ".evidence > summary")
    ] == [True] * 5
    second.locator(".headline").click()
    assert second.locator(".message").is_hidden()


def test_filters_by_severity_rule_element_confidence_and_known(page: Any) -> None:
    page.click("#more")
    page.select_option("#by-rule", "INR003")
    page.select_option("#by-element", "link wheel")
    assert shown(page) == ["INR003"]
    page.select_option("#by-rule", "")
    # The last one is about the base, and has a place in the wheel.
    assert shown(page) == ["INR003", "INR001", "INR001"]
    page.uncheck("#show-warning")
    assert shown(page) == ["INR003", "INR001"]
    page.click("#reset")
    page.select_option("#by-confidence", "heuristic")
    assert shown(page) == ["INR003"]
    page.click("#reset")
    page.check("#with-known")
    page.fill("#find", "decimal point was lost")
    wait_for_count(page, "1 of 6 shown")
    assert page.locator(".card.known").is_visible(), "its fold is open"
    page.uncheck("#with-known")
    page.click("#more")


def test_cards_move_into_groups_and_back(page: Any) -> None:
    before = page.eval_on_selector_all(".card", "all => all.map((c) => c.id)")
    page.click("#more")
    for by, names in {
        "rule": ["INR003 triangle-inequality 3", "INR001 mass-not-positive 2"],
        "element": ["link wheel 2", f"link {'x' * 300} 1", "link base 1", "joint axle 1"],
        "file": ["rover/rover.urdf 4", "the model as a whole 1"],
    }.items():
        page.select_option("#group", by)
        assert heads(page) == names
    page.select_option("#group", "severity")
    page.click("#more")
    assert page.eval_on_selector_all(".card", "all => all.map((c) => c.id)") == before
    assert heads(page) == ["START HERE", "THEN 3"]
    assert page.locator(".notes").is_visible()


def test_a_finding_of_several_links_is_found_under_each(browser: Any, tmp_path: Path) -> None:
    both = about("base", code="INR008", message_id="shared")
    several = replace(both, subjects=("link[base]/inertial", "link[wheel]/inertial"))
    path = tmp_path / "several.html"
    path.write_text(render(a_run(several, about("wheel", code="INR001", message_id="m"))), encoding="utf-8")
    page = ready(opened(browser, path.as_uri(), viewport={"width": 1440, "height": 900}))
    page.click("#more")
    page.select_option("#group", "element")
    assert heads(page) == ["link base 1", "link wheel 2"]
    stub = page.locator(".stub:visible")
    assert stub.count() == 1
    assert "INR008" in stub.inner_text()
    page.fill("#find", "INR001")
    page.wait_for_selector("#shown:not(:empty)")
    assert page.locator(".stub:visible").count() == 0
    page.fill("#find", "")
    page.wait_for_selector("#shown:empty", state="attached")
    page.locator(".stub a").click()
    assert page.locator(".card[aria-current=true]").get_attribute("data-code") == "INR008"
    page.select_option("#group", "severity")
    assert page.locator(".stub").count() == 0
    page.close()


# -- one finding and the robot -----------------------------------------------------------------------------------------


def test_keys_go_from_finding_to_finding(page: Any) -> None:
    page.evaluate("window.told = []; document.addEventListener('uc:select', ({ detail }) => window.told.push(detail))")
    page.keyboard.press("j")
    page.keyboard.press("j")
    page.keyboard.press("k")
    first = f"f-{finding().fingerprints[0]}"
    assert page.evaluate("document.activeElement.id") == first
    assert page.url.endswith(f"#{first}")
    assert page.evaluate("window.told.at(-1)") == {"model": "m1", "finding": first, "origin": "page"}
    more = page.locator(f"#{first} .more")
    assert more.get_attribute("open") is None
    page.keyboard.press("Enter")
    assert more.get_attribute("open") is not None
    page.keyboard.press("Enter")
    assert more.get_attribute("open") is None
    page.keyboard.press("Escape")
    assert page.locator("[aria-current=true].card").count() == 0
    assert "#" not in page.url
    page.keyboard.press("?")
    assert page.locator("#keys").is_visible()
    page.click("#close-keys")


@pytest.mark.smoke
def test_a_deep_link_opens_its_card_and_shows_it_in_3d(browser: Any, report: str) -> None:
    card = f"f-{RUN.findings[2].fingerprints[0]}"
    page = opened(browser, f"{report}#{card}", viewport={"width": 1440, "height": 900})
    assert page.locator(f"#{card} .message").is_visible(), "notes are folded otherwise"
    assert page.locator(f"#{card}").get_attribute("aria-current") == "true"
    # What the joint of the finding carries.
    page.wait_for_selector("body[data-ready][data-selected=wheel]")


def test_a_click_on_the_robot_lists_the_findings_of_that_link(page: Any) -> None:
    page.evaluate(
        "document.dispatchEvent(new CustomEvent('uc:select', { detail: { model: 'm1', link: 'base', origin: 'viewer' } }))"
    )
    assert shown(page) == ["INR001"]
    assert page.inner_text("#chip") == "link base ×"
    page.evaluate(
        "document.addEventListener('uc:clear', ({ detail }) => { document.body.dataset.cleared = detail.origin; })"
    )
    page.click("#chip")
    assert page.evaluate("document.body.dataset.cleared") == "page"
    assert len(shown(page)) == 6


def test_names_in_tables_show_their_link_in_3d(page: Any) -> None:
    page.evaluate("document.addEventListener('uc:select', ({ detail }) => { window.last = detail; })")
    page.evaluate("document.querySelector('.section.physics').open = true")
    page.locator("#m1-physics button.name").first.click()
    assert page.evaluate("window.last") == {"model": "m1", "link": "base", "origin": "page"}
    page.click("#fold")
    assert page.locator("#viewer").is_hidden()
    assert page.locator("main").bounding_box()["width"] > 1300, "tables have the whole width"
    page.locator(".card .in-3d").first.click()
    assert page.locator("#viewer").is_visible()


def test_where_the_robot_is_above_the_findings_there_is_a_way_back(page: Any) -> None:
    before = page.viewport_size
    page.set_viewport_size({"width": 390, "height": 844})
    card = page.locator(".card:has(.in-3d)").first
    card.locator(".in-3d:not(.name)").click()
    page.wait_for_selector("#back")
    assert page.inner_text("#back") == "Back to INR003"
    page.click("#back")
    assert page.evaluate("document.activeElement.id") == card.get_attribute("id")
    assert page.locator("#back").is_hidden()
    page.set_viewport_size(before)


def test_a_link_to_a_rule_opens_its_page(page: Any) -> None:
    assert page.locator("#rule-INR003").is_hidden()
    page.locator(".card .rule-name a").first.click()
    page.locator("#rule-INR003").wait_for(state="visible")


def test_copies_say_that_they_are_made(browser: Any, plain: str) -> None:
    page = opened(browser, plain, permissions=["clipboard-read", "clipboard-write"])
    page.locator(".card .copy-place").first.click()
    page.get_by_text("rover/rover.urdf:9 copied").wait_for(state="attached")
    assert page.evaluate("navigator.clipboard.readText()") == "rover/rover.urdf:9"
    page.locator(".card.first .headline").click()
    page.locator(".card.first .evidence > summary").click()
    page.locator(".copy-diff").first.click()
    page.get_by_text("The diff copied").wait_for(state="attached")
    assert page.evaluate("navigator.clipboard.readText()").startswith("--- rover/rover.urdf\n+++ rover/rover.urdf\n@@ ")
    page.locator(".copy-link").first.click()
    page.get_by_text("The link copied").wait_for(state="attached")
    assert page.evaluate("navigator.clipboard.readText()") == f"{plain}#f-{finding().fingerprints[0]}"


def test_the_theme_is_chosen_and_kept(browser: Any, plain: str) -> None:
    page = opened(browser, plain, color_scheme="light")
    page.click("#theme")
    page.click("#theme")
    assert page.inner_text("#theme") == "Theme: dark"
    page.reload()
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(16, 19, 22)"


def test_links_to_sections_lead_there(browser: Any, tmp_path: Path) -> None:
    """On a long page whose cards get their height as they are drawn, for readers who like motion too."""
    path = tmp_path / "long.html"
    long = "it does not fit, " * 60
    many = [about(f"l{i}", message=f"number {i} " + long * (i % 4), message_id=str(i)) for i in range(120)]
    path.write_text(render(a_run(*many, scenes=())), encoding="utf-8")
    page = opened(browser, path.as_uri(), viewport={"width": 1440, "height": 900}, reduced_motion="no-preference")
    sections = page.eval_on_selector_all(".bar nav a", "all => all.map((a) => a.hash).filter((hash) => hash)")
    assert len(sections) >= 3

    def measure_distance(section: str) -> float:
        """Pixels from the place below the bar to the section, or to where the end of the page lets it be, once the page has not
        moved for ten frames."""
        distance: float = page.evaluate(
            """async (section) => {
              for (let [frames, before] = [0, ""]; frames < 10; ) {
                await new Promise(requestAnimationFrame);
                const now = `${scrollY} ${document.documentElement.scrollHeight}`;
                [frames, before] = now === before ? [frames + 1, now] : [0, now];
              }
              const wanted = parseFloat(getComputedStyle(document.documentElement).scrollPaddingTop);
              const end = document.documentElement.scrollHeight - innerHeight - scrollY;
              const target = document.querySelector(section);
              return Math.min((target.closest("details") ?? target).getBoundingClientRect().top - wanted, Math.max(end, 0) || 0);
            }""",
            section,
        )
        return distance

    for section in [*sections, *reversed(sections)]:
        page.click(f".bar nav a[href='{section}']")
        assert abs(measure_distance(section)) <= 20, section
    for section in sections:
        page.goto(f"{path.as_uri()}{section}")
        page.reload()
        assert abs(measure_distance(section)) <= 20, section
    assert page.said[:1] == []


def test_thousands_of_findings_stay_usable(browser: Any, tmp_path: Path) -> None:
    """What takes the square of their number would take minutes here."""
    path = tmp_path / "many.html"
    many = [about(f"l{i % 50}", message=f"number {i}", message_id=str(i), fix=None, related=()) for i in range(2000)]
    path.write_text(render(a_run(*many, scenes=())), encoding="utf-8")
    page = opened(browser, path.as_uri(), viewport={"width": 1440, "height": 900})
    page.fill("#find", "number 77")
    page.wait_for_selector("#shown:not(:empty)")
    assert page.inner_text("#shown") == f"{sum('77' in str(i) for i in range(2000))} of 2000 shown"
    page.evaluate(
        "const g = document.getElementById('group'); g.value = 'element'; g.dispatchEvent(new Event('change'))"
    )
    page.click("#reset")
    assert page.locator(".group:not([hidden])").count() == 50
    page.keyboard.press("j")
    assert page.locator(".card[aria-current]").count() == 1
    assert page.said == []
