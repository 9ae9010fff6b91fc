"""Paths in findings: a text that xacro computed may hold the folder of a checkout, which is different on each machine."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import Any

from urdfcheck.core import Finding
from urdfcheck.source.package.finder import format_path

# What ends a path in a sentence.
_REST = r"""[^\s"'`,;|()<>{}\[\]]*"""


class PathShortener:
    """Writes absolute paths below some folders as all other paths of a report: relative to the working directory.

    ``is_typed``: whether a source contains a text. Such a path is the author's own, and stays.
    """

    def __init__(self, folders: Iterable[str], is_typed: Callable[[str], bool]) -> None:
        # A root or a folder below it would take too much for a path.
        self.folders = {folder.rstrip(os.sep) for folder in folders if folder.rstrip(os.sep).count(os.sep) > 1}
        self.is_typed = is_typed

    @cached_property  # few texts hold such a path, and this takes as long as a check of a small model's text
    def pattern(self) -> re.Pattern[str]:
        """Matches a path below one of the folders, with the scheme before it."""
        listed = "|".join(map(re.escape, sorted(self.folders, key=len, reverse=True)))
        return re.compile(rf"(?:file:/{{0,3}}|(?<![\w./:-]))({listed})(?=[/\\]|(?![\w.-])){_REST}")

    def shorten_finding(self, finding: Finding) -> Finding:
        """Return a finding without absolute paths below the folders."""
        if not self.folders:
            return finding
        fix, cause = finding.fix, finding.cause
        return replace(
            finding,
            headline=self.shorten_text(finding.headline),
            message=self.shorten_text(finding.message),
            subjects=tuple(map(self.shorten_text, finding.subjects)),
            location=replace(finding.location, subject=self.shorten_text(finding.location.subject)),
            related=tuple(replace(at, subject=self.shorten_text(at.subject)) for at in finding.related),
            cause=None if cause is None else replace(cause, text=self.shorten_text(cause.text)),
            consequences=self.shorten_value(finding.consequences),
            data=self.shorten_value(finding.data),
            fix=None if fix is None else replace(fix, title=self.shorten_text(fix.title)),
        )

    def shorten_text(self, text: str) -> str:
        """Return a text without absolute paths below the folders."""
        if not any(folder in text for folder in self.folders):
            return text
        return self.pattern.sub(self._shorten_match, text)

    def shorten_value(self, value: Any) -> Any:
        """Return a value with each text in it shortened."""
        if isinstance(value, str):
            return self.shorten_text(value)
        if isinstance(value, Mapping):
            return {key: self.shorten_value(inner) for key, inner in value.items()}
        if isinstance(value, list):
            return [self.shorten_value(inner) for inner in value]
        return tuple(map(self.shorten_value, value)) if isinstance(value, tuple) else value

    def _shorten_match(self, match: re.Match[str]) -> str:
        whole = match.group(0)
        path = whole[match.start(1) - match.start() :].rstrip(".:?!")
        if self.is_typed(path):
            return whole
        return format_path(Path(path)) + whole[match.start(1) - match.start() + len(path) :]
