"""The extension in VS Code itself, in a browser: ``URDFCHECK_CODE_SERVER`` names code-server, which is VS Code as a server."""

from __future__ import annotations

import contextlib
import json
import os
import shutil
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any
from urllib.parse import quote

import pytest
from conftest import REPOSITORY

pytestmark = [pytest.mark.slow, pytest.mark.long]

SOURCE = REPOSITORY / "editors" / "vscode"
VERDICT = ".statusbar-item:has-text('urdfcheck')"
# Seconds for what takes one on an idle machine.
PATIENCE = 120.0


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """The address of a VS Code with the extension and car-3 in its folder."""
    program = os.environ.get("URDFCHECK_CODE_SERVER")
    if program is None:
        pytest.skip("URDFCHECK_CODE_SERVER does not name code-server")
    if not (SOURCE / "node_modules").is_dir():
        pytest.skip("npm ci was not run in editors/vscode")
    folder = tmp_path_factory.mktemp("vscode")
    shutil.copytree(REPOSITORY / "fixtures" / "car-3", folder / "work" / "car-3")
    package = folder / "urdfcheck.vsix"
    subprocess.run(["npm", "run", "package", "--", "--out", str(package)], cwd=SOURCE, check=True, capture_output=True)
    settings = {"security.workspace.trust.enabled": False, "workbench.startupEditor": "none"}
    write_settings(folder / "data" / "User", settings)
    write_settings(folder / "data" / "Machine", {"urdfcheck.path": str(Path(sys.executable).with_name("urdfcheck"))})
    own = ["--user-data-dir", str(folder / "data"), "--extensions-dir", str(folder / "extensions")]
    runner = ["node", program] if program.endswith(".js") else [program]
    subprocess.run(
        [*runner, *own, "--install-extension", str(package)], check=True, capture_output=True, timeout=PATIENCE
    )
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    served = ["--auth", "none", "--bind-addr", f"127.0.0.1:{port}", "--disable-telemetry", "--disable-update-check"]
    environment = {**os.environ, "XDG_CONFIG_HOME": str(folder / "config")}
    server = subprocess.Popen(
        [*runner, *own, *served], env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    try:
        wait_until(lambda: is_listening(port), "code-server listens")
        opened = f"vscode-remote://127.0.0.1:{port}{folder / 'work' / 'car-3' / 'urdf' / 'car-3.urdf'}"
        payload = quote(json.dumps([["openFile", opened]]))
        yield f"http://127.0.0.1:{port}/?folder={folder / 'work'}&payload={payload}"
    finally:
        server.terminate()
        server.wait(timeout=30)


def write_settings(folder: Path, settings: dict[str, Any]) -> None:
    folder.mkdir(parents=True)
    (folder / "settings.json").write_text(json.dumps(settings))


def is_listening(port: int) -> bool:
    with socket.socket() as tried:
        return tried.connect_ex(("127.0.0.1", port)) == 0


def wait_until(is_so: Callable[[], object], what: str) -> None:
    end = time.monotonic() + PATIENCE
    while not is_so():
        assert time.monotonic() < end, f"{what}: not in {PATIENCE:.0f} s"
        time.sleep(0.2)


@pytest.fixture(scope="module")
def window(address: str, browser: Any) -> Iterator[Any]:
    """The window of VS Code with car-3 open."""
    page = browser.new_page(viewport={"width": 1500, "height": 900})
    page.goto(address)
    page.wait_for_selector(".monaco-editor .view-line", timeout=1000 * PATIENCE)
    yield page
    page.close()


def choose(window: Any, key: str, text: str) -> None:
    """Choose in the list that a key opens, once the list has what is typed; the text has the focus before."""
    shown = window.locator(".quick-input-widget input").first

    def has_opened() -> bool:
        window.keyboard.press("Control+1")
        window.keyboard.press(key)
        window.wait_for_timeout(1000)
        return bool(shown.is_visible())

    wait_until(has_opened, f"the list of {key}")
    window.keyboard.insert_text(text)
    window.wait_for_timeout(1500)
    window.keyboard.press("Enter")


def ask_panel(window: Any, expression: str) -> Any:
    """What the report in the panel says; None where there is none yet, or another one comes."""
    for frame in window.frames:
        with contextlib.suppress(Exception):  # a frame that goes
            if frame.evaluate("document.body?.dataset.ready"):
                return frame.evaluate(expression)
    return None


def read_selected(window: Any) -> str | None:
    """What the robot in the panel has selected."""
    selected: str | None = ask_panel(window, "document.body.dataset.selected ?? ''")
    return selected


def count_cards(window: Any, code: str) -> int | None:
    """The findings of a rule in the panel."""
    count: int | None = ask_panel(window, f"document.querySelectorAll('.card[data-code={code}]').length")
    return count


def test_findings_hovers_the_verdict_and_the_robot_are_shown(window: Any) -> None:
    window.wait_for_selector(".squiggly-warning", timeout=1000 * PATIENCE)
    wait_until(lambda: "2 urdfcheck" in " ".join(window.locator(VERDICT).inner_text().split()), "the verdict")
    choose(window, "Control+g", ":10:20")
    choose(window, "F1", "Show or Focus Hover")
    window.wait_for_selector(".monaco-hover:has-text('INR016')", timeout=1000 * PATIENCE)
    window.keyboard.press("Escape")
    choose(window, "Control+g", ":88:15")
    choose(window, "F1", "urdfcheck: Show the robot in 3D")
    wait_until(lambda: read_selected(window) == "wheel_1", "the finding in 3D")
    choose(window, "Control+g", ":97:12")
    wait_until(lambda: read_selected(window) == "wheel_2", "the link at the cursor")


def test_what_is_typed_is_drawn_without_being_saved(window: Any) -> None:
    choose(window, "Control+g", ":88:12")
    for _ in "0 -0.75239 0":
        window.keyboard.press("Shift+ArrowRight")
    window.keyboard.insert_text("0 0 0")
    wait_until(lambda: "1 urdfcheck" in " ".join(window.locator(VERDICT).inner_text().split()), "the verdict")
    wait_until(lambda: count_cards(window, "SYM001") == 0, "the report on the new text")
