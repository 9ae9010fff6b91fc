"""cadgen, as ``cadgen urdf validate`` does."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from cadgen.urdf_source import validate_urdf_file


def ask(file: str) -> Iterator[tuple[str, str, str, str]]:
    """Yield what it reports. The subject is the last name in the path of the element that it gives."""
    _, report = validate_urdf_file(Path(file))
    for found in report.deduplicated().all_findings():
        names = re.findall(r"@name=['\"]([^'\"]*)", found.path or "")
        yield found.severity, found.code, names[-1] if names else "", f"{found.message} {found.hint or ''}".strip()
