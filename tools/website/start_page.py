"""The start page and the page of the sample report: what the command prints and writes, and sections of the README."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

from rich.console import Console
from rich.terminal_theme import TerminalTheme
from rich.text import Text

from website.navigation import REPOSITORY, START

ASSETS = Path(__file__).parent / "assets"
REPORT = "sample/car-3.html"
ROBOT = "fixtures/car-3"
MODEL = f"{ROBOT}/robot_description/urdf/car_body.urdf.xacro"
COLUMNS = 98
# What would make the output another one on this machine.
_OWN_VARIABLES = {"ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH", "NO_COLOR", "TTY_COMPATIBLE"}
# The colours of the report in the dark, on the background that site.css gives a terminal.
_THEME = TerminalTheme(
    (0x18, 0x1C, 0x21),
    (0xE3, 0xE7, 0xEC),
    [
        (0x18, 0x1C, 0x21),
        (0xFF, 0x93, 0x8A),
        (0x7B, 0xD2, 0x9B),
        (0xF0, 0xB9, 0x5C),
        (0x8D, 0xBD, 0xF5),
        (0xD3, 0xA6, 0xEF),
        (0x86, 0xD0, 0xD8),
        (0xE3, 0xE7, 0xEC),
    ],
)


def render_start() -> str:
    """Return the start page, with its links as they are in the README: it quotes sections of it."""
    text = (ASSETS / "start.md").read_text(encoding="utf-8")
    readme = (REPOSITORY / "README.md").read_text(encoding="utf-8")
    quoted = re.sub(r"^<!-- README: (.+?) -->$", lambda match: _quote(readme, match[1]), text, flags=re.MULTILINE)
    return quoted.replace("<!-- terminal -->", _render_terminal())


def render_sample() -> str:
    """Return the page about the sample report, with its links as they are in a file of the repository's folder."""
    return (ASSETS / "sample.md").read_text(encoding="utf-8")


def write_report(path: Path) -> None:
    """Write the HTML report of car-3 as `make audit` does."""
    _run(ROBOT, "--pedantic", "-o", f"html={path}")


def _quote(readme: str, heading: str) -> str:
    found = re.search(rf"^## {re.escape(heading)}\n(.*?)(?=^## |\Z)", readme, re.MULTILINE | re.DOTALL)
    assert found is not None, f"{START.address}: README.md has no section {heading!r}"
    return found[1].strip()


def _render_terminal() -> str:
    """What the command prints about one model, in colour, as HTML."""
    console = Console(record=True, width=COLUMNS, file=open(os.devnull, "w", encoding="utf-8"))  # noqa: SIM115
    console.print(Text.from_ansi(_run(MODEL)), soft_wrap=True)
    code = console.export_html(theme=_THEME, inline_styles=True, code_format="{code}")
    return f'<pre class="terminal"><code><b>$ urdfcheck {Path(MODEL).name}</b>\n{code.rstrip()}</code></pre>'


def _run(*words: str) -> str:
    environment = {name: value for name, value in os.environ.items() if name not in _OWN_VARIABLES}
    done = subprocess.run(
        [sys.executable, "-m", "urdfcheck", *words, "--fail-on", "never"],
        cwd=REPOSITORY,
        env={**environment, "SOURCE_DATE_EPOCH": "0", "COLUMNS": str(COLUMNS), "FORCE_COLOR": "1"},
        stdout=subprocess.PIPE,
        encoding="utf-8",
        check=True,
    )
    return done.stdout
