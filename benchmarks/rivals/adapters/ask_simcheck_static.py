"""simcheck without an engine, as ``simcheck check --static-only`` does."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from simcheck.config import Config
from simcheck.core import check_file


def ask(file: str, engines: tuple[str, ...] = ()) -> Iterator[tuple[str, str, str, str]]:
    """Yield what it reports."""
    report = check_file(Path(file), Config(engines=engines))
    for found in report.findings:
        yield found.severity, " ".join(filter(None, (found.check, found.engine))), found.target, found.message
