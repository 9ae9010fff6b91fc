"""Makes the picture of the README from the sample report: ``python tools/make_picture.py`` (needs playwright and Chromium).

URDFCHECK_BROWSER names the browser; without it Chromium is looked for in PATH.
"""

from __future__ import annotations

import os
import shutil
from pathlib import Path

REPORTS = Path(__file__).resolve().parent.parent / "reports"
# The part of the report that shows what the tool is about: the card of the wheel that is off by 43°.
CARD = "article:has-text('SYM001')"


def main() -> None:
    from playwright.sync_api import sync_playwright

    browser = os.environ.get("URDFCHECK_BROWSER") or shutil.which("chromium")
    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=browser, args=["--no-sandbox"])
        page = chromium.new_page(viewport={"width": 1100, "height": 900}, device_scale_factor=1.5, color_scheme="light")
        page.goto((REPORTS / "car-3.html").as_uri())
        page.locator(CARD).first.screenshot(path=REPORTS / "car-3.png")
        chromium.close()


if __name__ == "__main__":
    main()
