"""urdf-validator, as ``urdf_validate`` does: what its report holds beside measured values."""

from __future__ import annotations

import contextlib
import io
import json
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from urdf_validator_main.cli import main

SEVERITIES = {"FAIL": "error", "WARN": "warning", "UNKNOWN": "info"}
LISTS = {"critical_issues": "error", "warnings": "warning", "infos": "info"}


def ask(file: str) -> Iterator[tuple[str, str, str, str]]:
    """Yield its issues, and the joints and the whole robot whose verdict is not that they pass."""
    printed = io.StringIO()
    with tempfile.TemporaryDirectory() as folder:
        sys.argv = ["urdf_validate", file, "--output-dir", folder]
        with contextlib.redirect_stdout(printed), contextlib.suppress(SystemExit):
            main()
        written = list(Path(folder).glob("*.json"))
        if not written:
            yield "error", "refused", "", " ".join(printed.getvalue().split())
            return
        report = json.loads(written[0].read_text(encoding="utf-8"))
    for key, severity in LISTS.items():
        for text in (*report["schema"].get(key, ()), *report.get(key, ())):
            yield severity, key, "", text
    for joint in report["statics"]["joints"]:
        if joint["status"] in SEVERITIES:
            yield SEVERITIES[joint["status"]], "statics", joint["name"], joint["summary"] or joint["status"]
    for key in ("stability", "workspace"):
        if report[key]["status"] in SEVERITIES:
            yield SEVERITIES[report[key]["status"]], key, "", report[key]["reason"] or report[key]["status"]
