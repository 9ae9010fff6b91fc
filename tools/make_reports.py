"""Makes the committed sample reports: ``python tools/make_reports.py``; ``--check`` only says which are stale.

SOURCE_DATE_EPOCH leaves times and versions of libraries out, so that the reports change only when urdfcheck or a fixture does.
"""

from __future__ import annotations

import base64
import os
import re
import subprocess
import sys
import tempfile
import zlib
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parent.parent
SUFFIXES = {"text": ".txt", "json": ".json", "markdown": ".md"}
ROBOTS = ("car-3",)
# What would make the output another one on this machine.
_OWN_VARIABLES = {"ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH", "COLUMNS", "FORCE_COLOR", "TTY_COMPATIBLE"}
_PACKED = re.compile(r'(<script type="text/plain" [^>]*>)([A-Za-z0-9+/=]+)')


def made(robot: str) -> dict[Path, str]:
    """The text of a robot's reports by their paths, and what the terminal shows."""
    with tempfile.TemporaryDirectory() as folder:
        files = {name: Path(folder, robot + suffix) for name, suffix in SUFFIXES.items()}
        outputs = [word for name, file in files.items() for word in ("-o", f"{name}={file}")]
        environment = {k: v for k, v in os.environ.items() if k not in _OWN_VARIABLES}
        done = subprocess.run(
            [sys.executable, "-m", "urdfcheck", f"fixtures/{robot}", "--pedantic", "--fail-on", "never", *outputs],
            cwd=REPOSITORY,
            env={**environment, "SOURCE_DATE_EPOCH": "0"},
            stdout=subprocess.PIPE,
            encoding="utf-8",
            check=True,
        )
        reports = {REPOSITORY / "reports" / file.name: file.read_text(encoding="utf-8") for file in files.values()}
        return {**reports, REPOSITORY / "reports" / f"{robot}-terminal.txt": done.stdout}


def unpacked(text: str) -> str:
    """A report with its packed parts as they were before: not every machine's zlib packs them alike."""
    return _PACKED.sub(
        lambda match: match[1] + zlib.decompress(base64.b64decode(match[2]), -zlib.MAX_WBITS).hex(), text
    )


def main() -> int:
    reports = {path: text for robot in ROBOTS for path, text in made(robot).items()}
    stale = [p for p, t in reports.items() if not p.is_file() or unpacked(p.read_text(encoding="utf-8")) != unpacked(t)]
    if "--check" in sys.argv:
        for path in stale:
            print(f"stale: {path.relative_to(REPOSITORY)} (make reports)")
        return 1 if stale else 0
    for path in stale:
        path.write_text(reports[path], encoding="utf-8", newline="\n")
        print(f"made {path.relative_to(REPOSITORY)}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
