"""``urdfcheck diff`` of two versions of one robot as a whole process, against the two checks that it contains.

The versions are one plain URDF file and an edited copy: the same text, a comment, a mass, a joint's place. Meshes are shared,
with absolute paths. The robots are those of the part ``robots``.
"""

from __future__ import annotations

import re
import statistics
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

from process import CHECK, took
from robots import list_readable, write_robots

DIFF = (sys.executable, "-m", "urdfcheck", "diff")
# The most that a comparison may take, in times of the two checks.
TARGET = 1.2
_MASS = re.compile(r'(<mass\s+value=")([^"]+)(")')
_PLACE = re.compile(r'(<joint\b.*?<origin\b[^>]*?\bxyz=")(\S+)', re.DOTALL)

EDITS: dict[str, Callable[[str], str]] = {
    "the same text": lambda text: text,
    "a comment": lambda text: text.replace("</robot>", "<!-- checked -->\n</robot>"),
    "a mass": lambda text: _MASS.sub(lambda m: f"{m[1]}{float(m[2]) * 1.1!r}{m[3]}", text, count=1),
    "a joint's place": lambda text: _PLACE.sub(lambda m: f"{m[1]}{float(m[2]) + 0.01!r}", text, count=1),
}


def compare(corpus: Path | None, repeats: int) -> None:
    """Print the table of all edits of all robots."""
    print(f"{'one robot':12} {'edit':16} {'two checks':>11} {'diff':>9}   diff / two checks, warm")
    with tempfile.TemporaryDirectory() as folder:
        for name, robot in write_robots(Path(folder), corpus).items():
            for edit, change in EDITS.items():
                checks, diff = _measure(robot, change, repeats, list_readable(corpus))
                missed = "  MISSED" if diff / checks > TARGET else ""
                times = f"{checks * 1e3:8.0f} ms {diff * 1e3:6.0f} ms"
                print(f"{name:12} {edit:16} {times}   {diff / checks:6.2f}{missed}", flush=True)
    print(f"target: <= {TARGET:.2f}", flush=True)


def _measure(robot: Path, change: Callable[[str], str], repeats: int, options: list[str]) -> tuple[float, float]:
    """Return the medians of the two checks together and of the comparison, which take turns, with filled caches."""
    checks, diffs = [], []
    with tempfile.TemporaryDirectory() as folder:
        text, paths = robot.read_text(encoding="utf-8"), [Path(folder, side, robot.name) for side in ("old", "new")]
        for path, version in zip(paths, (text, change(text)), strict=True):
            path.parent.mkdir()
            path.write_text(version, encoding="utf-8")
        old, new = map(str, paths)
        cache = str(Path(folder, "cache"))
        took((*DIFF, old, new, *options), cache=cache)
        for _ in range(repeats):
            checks.append(sum(took((*CHECK, path, *options), cache=cache).seconds for path in (old, new)))
            diffs.append(took((*DIFF, old, new, *options), cache=cache).seconds)
    return statistics.median(checks), statistics.median(diffs)
