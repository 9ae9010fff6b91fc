"""Makes the picture of the README from the sample report: ``python tools/make_picture.py`` (needs playwright and Chromium).

URDFCHECK_BROWSER names the browser; without it Chromium is looked for in PATH.
"""

from __future__ import annotations

import os
import shutil
from pathlib import Path
from typing import Any

REPORTS = Path(__file__).resolve().parent.parent / "reports"
# What the tool is about: the wheel that is off by 43°, its card and how the repair turns it.
CARD = "article[data-code='SYM001']"


def main() -> None:
    from playwright.sync_api import sync_playwright

    browser = os.environ.get("URDFCHECK_BROWSER") or shutil.which("chromium")
    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(
            executable_path=browser, args=["--no-sandbox", "--enable-unsafe-swiftshader"]
        )
        window: Any = {"viewport": {"width": 1440, "height": 900}, "color_scheme": "light", "reduced_motion": "reduce"}
        report = (REPORTS / "car-3.html").as_uri()
        page = chromium.new_page(**window)
        page.goto(report)
        anchor = page.locator(CARD).first.get_attribute("id")
        page = chromium.new_page(**window)
        page.goto(f"{report}#{anchor}")
        page.wait_for_selector("body[data-ready='1'][data-fly='0']")
        page.screenshot(path=REPORTS / "car-3.png")
        chromium.close()


if __name__ == "__main__":
    main()
