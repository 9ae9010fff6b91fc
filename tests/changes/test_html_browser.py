"""The page of a comparison in a real browser: both versions are drawn where the models say, and rows and picture are one."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from conftest import open_watched
from versions import ARM, compare

from urdfcheck.output.changes import html

pytestmark = [pytest.mark.slow, pytest.mark.long]

# The camera is gone, the hand is 41 mm farther away and the elbow is tilted; its inertia is one that no body has.
CHANGED = (
    (
        ARM[: ARM.index('\n  <link name="camera">')]
        + ARM[ARM.index('\n  <link name="hand">') : ARM.index('\n  <joint name="camera_mount"')]
        + ARM[ARM.index('\n  <joint name="wrist"') :]
    )
    .replace('<origin xyz="0.3 0 0" rpy="0 0 0"/>', '<origin xyz="0.341 0 0" rpy="0 0 0"/>')
    .replace('xyz="0 0 0.4" rpy="0 0 0.2"', 'xyz="0 0 0.45" rpy="0 0.1 0.2"')
    .replace('ixx="0.0006"', 'ixx="0.006"')
)


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("versions")
    for side, text in (("old", ARM), ("new", CHANGED)):
        (folder / side).mkdir()
        (folder / side / "arm.urdf").write_text(text, encoding="utf-8")
    path = folder / "diff.html"
    diff = compare(folder / "old/arm.urdf", folder / "new/arm.urdf", scene=True)
    path.write_text(html.render(diff), encoding="utf-8")
    return path


@pytest.fixture
def page(browser: Any, report: Path) -> Iterator[Any]:
    """A page for each test: what one opens or moves must not decide another."""
    with open_watched(browser, report) as page:
        yield page


def place(page: Any, name: str, version: str = "frame") -> list[float]:
    """Where the frame of a link is in the world."""
    values = page.evaluate(f"urdfcheck.{version}('{name}')")
    return [values[3], values[7], values[11]]


def test_both_versions_are_drawn_and_only_what_differs_is_drawn_twice(page: Any) -> None:
    # The base and the upper arm are equal; fore, hand and two fingers are elsewhere; the camera is gone.
    assert page.evaluate("urdfcheck.differing()") == [5, 4]
    assert page.locator(".uc-legend").inner_text().splitlines()[1:] == [
        "Before: no longer there",
        "After: not there before",
    ]


def test_the_slider_and_the_buttons_lead_from_before_to_after(page: Any) -> None:
    pictures = [page.evaluate("urdfcheck.picture()")]
    page.locator(".uc-compare input").evaluate(
        "slider => { slider.value = 0.4; slider.dispatchEvent(new Event('input')); }"
    )
    assert page.evaluate("urdfcheck.part()") == 0.4
    pictures.append(page.evaluate("urdfcheck.picture()"))
    page.locator(".uc-compare button").first.click()
    assert page.evaluate("urdfcheck.part()") == 0
    pictures.append(page.evaluate("urdfcheck.picture()"))
    page.keyboard.down("b")
    assert page.evaluate("urdfcheck.part()") == 1
    page.keyboard.up("b")
    page.locator(".uc-compare button").last.click()
    assert page.evaluate("urdfcheck.part()") == 1
    assert len(set(pictures)) == 3


def test_a_row_shows_its_part_and_the_worst_configuration_is_one_click_away(page: Any) -> None:
    page.locator(".entry", has_text="moves by up to").filter(has_text="tool0").locator(".in-3d").click()
    label = page.locator(".uc-label.turn").inner_text()
    shift = [a - b for a, b in zip(place(page, "tool0"), place(page, "tool0", "frameBefore"), strict=True)]
    distance = sum(value**2 for value in shift) ** 0.5
    # The picture says what the row says, of both robots at these joint positions.
    claimed = page.locator(".entry[aria-current] .what").inner_text().split("by up to ")[1].split(" mm")[0]
    assert label == f"tool0 moves {claimed} mm"
    assert distance * 1000 == pytest.approx(float(claimed), abs=0.6)
    assert page.locator("#m1-s0").get_attribute("aria-current") == "true"
    page.keyboard.press("Escape")
    assert page.locator("[aria-current='true'].entry").count() == 0
    # The joints are back.
    neutral = place(page, "tool0")
    page.locator(".entry", has_text="camera").locator(".in-3d").click()
    assert page.locator(".uc-label.frame").inner_text() == "camera, before"
    assert place(page, "tool0") == neutral


def test_a_pair_that_collides_no_longer_is_shown_in_the_version_where_it_did(page: Any) -> None:
    page.keyboard.press("Escape")
    neutral = place(page, "left")
    page.locator(".entry", has_text="no longer collide").locator(".in-3d").first.click()
    assert page.evaluate("urdfcheck.part()") == 0
    assert page.locator(".uc-legend").inner_text().splitlines()[-1] == "Collision shapes"
    page.keyboard.press("Escape")
    # The version, the joints and the layers are back.
    assert page.evaluate("urdfcheck.part()") == 1
    assert place(page, "left") == neutral
    assert "Collision shapes" not in page.locator(".uc-legend").inner_text()


def test_a_click_on_a_part_finds_its_rows(page: Any) -> None:
    page.keyboard.press("Escape")
    page.locator(".uc-view button[data-view='iso']").click()
    x, y = page.evaluate("urdfcheck.pixel('hand')")
    page.mouse.click(x, y)
    about = page.locator(".entry.about, .card.about")
    assert page.evaluate("document.body.dataset.selected") == "hand"
    assert any("hand" in text for text in about.all_inner_texts())
    assert about.count() < page.locator(".entry, .card").count()


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_anyone_can_use_it(page: Any, scheme: str) -> None:
    from axe_playwright_python.sync_playwright import Axe

    page.emulate_media(color_scheme=scheme)
    page.evaluate("document.querySelectorAll('.card').forEach((c) => { c.style.contentVisibility = 'visible'; })")
    found = Axe().run(page, options={"rules": {"target-size": {"enabled": True}}})
    assert [(each["id"], [node["html"] for node in each["nodes"]]) for each in found.response["violations"]] == []
    page.emulate_media(color_scheme="light")


@pytest.mark.parametrize("width", [390, 768, 1440])
def test_it_fits_the_screen(page: Any, width: int) -> None:
    page.set_viewport_size({"width": width, "height": 800})
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    page.set_viewport_size({"width": 1280, "height": 800})


def test_without_scripts_everything_is_said(browser: Any, report: Path) -> None:
    context = browser.new_context(java_script_enabled=False, viewport={"width": 1280, "height": 800})
    page = context.new_page()
    page.goto(report.as_uri())
    assert page.locator("img.still").is_visible()
    assert page.locator(".cause figure").first.is_visible()
    assert not page.locator(".in-3d").first.is_visible()
    context.close()
