"""The start page and the page of the sample report: what the command prints and writes, and sections of the README."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from rich.console import Console
from rich.terminal_theme import TerminalTheme
from rich.text import Text

from urdfcheck.cli import FINDINGS, OK
from urdfcheck.cli.demo_robots import DemoRobot, load_demo_robots
from urdfcheck.core.text import format_count
from website.navigation import DEMOS, REPOSITORY, START
from website.terminal_recording import DARK, LIGHT, Recorded, render_recording

ASSETS = Path(__file__).parent / "assets"
REPORT = "sample/car-3.html"
ROBOT = "fixtures/car-3"
MODEL = f"{ROBOT}/robot_description/urdf/car_body.urdf.xacro"
COLUMNS = 98
# The commands that the start page shows at work on a copy of the demo robot, and the columns of their terminal.
RECORDED = (
    ("robot", "-q"),
    ("robot", "--select", "INR003"),
    ("robot", "--fix", "--unsafe-fixes", "-q"),
)
RECORDED_COLUMNS = 113
RECORDING_TITLE = "urdfcheck finds seven defects in a quadruped, explains one of them, and repairs four"
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
    return quoted.replace("<!-- recording -->", _embed_recordings()).replace("<!-- terminal -->", _render_terminal())


def write_recordings(folder: Path) -> None:
    """Write the recording of the start page and its last picture, in the light and in the dark: the real output."""
    with tempfile.TemporaryDirectory() as place:
        _run("demo", "quadruped", "-o", "robot", place=Path(place))
        steps = [
            Recorded(f"urdfcheck {' '.join(words)}", _run(*words, place=Path(place), columns=RECORDED_COLUMNS))
            for words in RECORDED
        ]
    for name, palette in (("light", LIGHT), ("dark", DARK)):
        for is_still, suffix in ((False, ""), (True, "-still")):
            svg = render_recording(steps, palette, RECORDED_COLUMNS, RECORDING_TITLE, is_still=is_still)
            (folder / f"recording-{name}{suffix}.svg").write_text(svg, encoding="utf-8", newline="\n")


def render_demos() -> str:
    """Return the page about the demo robots with their pictures, with its links as they are in fixtures/demos."""
    introduction, table = (REPOSITORY / DEMOS.source).read_text(encoding="utf-8").split("\n| ", 1)
    pictures = (
        f'<a href="../../{_name_report(name)}"><img src="../../{_name_picture(name)}" alt="{name}: {robot.title}; its report" '
        'loading="lazy"></a>'
        for name, robot in load_demo_robots().items()
    )
    return f'{introduction}\n<div class="gallery">{"".join(pictures)}</div>\n\n| {table}'


def write_pictures(pages: Path) -> None:
    """Write a picture of each demo robot as it is without defects."""
    for name, robot in load_demo_robots().items():
        _run(str(robot.folder / "urdf" / f"{name}.urdf.xacro"), "-o", f"png={pages / _name_picture(name)}")


def write_demo_reports(pages: Path) -> None:
    """Write the report of each demo robot with its planted defects, as the command that copies it out does."""
    for name in load_demo_robots():
        with tempfile.TemporaryDirectory() as place:
            _run("demo", name, "-o", name, place=Path(place))
            shutil.copyfile(Path(place) / name / "report.html", pages / _name_report(name))


def _name_report(name: str) -> str:
    return f"sample/demo-{name}.html"


def _name_picture(name: str) -> str:
    return f"assets/demo-{name}.png"


def render_sample() -> str:
    """Return the page about the sample report, with its links as they are in a file of the repository's folder."""
    text = (ASSETS / "sample.md").read_text(encoding="utf-8")
    return "\n".join([text, *(_embed_demo(name, robot) for name, robot in load_demo_robots().items())])


def _embed_demo(name: str, robot: DemoRobot) -> str:
    planted = format_count(len(robot.defects), "defect")
    return (
        f"## {robot.title[0].upper()}{robot.title[1:]}\n\n"
        f"This demo robot has {planted} on purpose (`urdfcheck demo {name}`). "
        f'<a href="demo-{name}.html">Open its report alone</a>.\n\n'
        f'<iframe class="report" src="demo-{name}.html" title="HTML report of the demo robot {name}" loading="lazy"></iframe>\n'
    )


def write_report(path: Path) -> None:
    """Write the HTML report of car-3 as `make audit` does."""
    _run(ROBOT, "--pedantic", "-o", f"html={path}")


def _embed_recordings() -> str:
    """Both recordings, of which the style shows one; a click opens it alone, and it begins anew."""
    shown = (
        f'<a class="only-{name}" href="assets/recording-{name}.svg">'
        f'<picture><source media="(prefers-reduced-motion: reduce)" srcset="assets/recording-{name}-still.svg">'
        f'<img src="assets/recording-{name}.svg" alt="Recording of a terminal: {RECORDING_TITLE}" loading="lazy">'
        "</picture></a>"
        for name in ("light", "dark")
    )
    return f'<div class="recording">{"".join(shown)}</div>'


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


def _run(*words: str, place: Path = REPOSITORY, columns: int = COLUMNS) -> str:
    """Return what the command prints in a folder, in colour.

    :raises subprocess.CalledProcessError: unless it checks everything, with or without findings.
    """
    environment = {name: value for name, value in os.environ.items() if name not in _OWN_VARIABLES}
    done = subprocess.run(
        [sys.executable, "-m", "urdfcheck", *words],
        cwd=place,
        # Unbuffered, because a terminal shows lines of both streams in the order of their times.
        env={
            **environment,
            "SOURCE_DATE_EPOCH": "0",
            "COLUMNS": str(columns),
            "FORCE_COLOR": "1",
            "PYTHONUNBUFFERED": "1",
        },
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        encoding="utf-8",
    )
    if done.returncode not in (OK, FINDINGS):
        done.check_returncode()
    return done.stdout
