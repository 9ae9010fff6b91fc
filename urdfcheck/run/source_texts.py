"""The texts of files that reports quote: each is kept once, and no more than a bound of them.

A hundred models of a few bytes that include one large file would be a hundred copies of it in the process that puts the report
together, which has no limit of memory: a worker has one for each model, and the report has one for all of them here.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import replace

from urdfcheck.core import SkippedCheck
from urdfcheck.run.jobs import UnitReport

# Bytes of memory, of which a character takes one, two or four. The XML files of 104 robots have 2.8 MB together.
MAX_REPORT_TEXTS, MAX_RUN_TEXTS = 128 * 1024**2, 384 * 1024**2
# The rule about files that are too large.
RULE = "URC905"


def limit_texts(texts: Mapping[str, str]) -> tuple[dict[str, str], str]:
    """Leave out the largest texts of one report, by name, where all of them take more than :data:`MAX_REPORT_TEXTS`.

    Also return the sentence that says so, empty where none is left out.
    """
    kept: dict[str, str] = {}
    rest = MAX_REPORT_TEXTS
    for name, text in sorted(texts.items(), key=lambda item: sys.getsizeof(item[1])):
        rest -= sys.getsizeof(text)
        if rest < 0:
            break
        kept[name] = text
    return kept, _explain(len(texts) - len(kept), MAX_REPORT_TEXTS)


class SourceTexts:
    """The texts of a run."""

    def __init__(self) -> None:
        self._texts: dict[str, str] = {}
        self._rest = MAX_RUN_TEXTS

    def share(self, report: UnitReport, unit_id: str) -> UnitReport:
        """Return a report with the texts that other reports hold already, and without those beyond :data:`MAX_RUN_TEXTS`."""
        shared = {name: kept for name, text in report.sources.items() if (kept := self._keep(text)) is not None}
        left_out = _explain(len(report.sources) - len(shared), MAX_RUN_TEXTS)
        note = (SkippedCheck(RULE, unit_id, left_out, is_partial=True),) if left_out else ()
        return replace(report, sources=shared, skipped=(*report.skipped, *note))

    def _keep(self, text: str) -> str | None:
        kept = self._texts.get(text)
        if kept is None and sys.getsizeof(text) <= self._rest:
            self._rest -= sys.getsizeof(text)
            kept = self._texts.setdefault(text, text)
        return kept


def _explain(count: int, limit: int) -> str:
    if not count:
        return ""
    files = "a file is" if count == 1 else f"{count} files are"
    return f"{files} not quoted beside the findings: the texts of all files take more than {limit // 1024**2} MiB"
