"""Where the reports are that an editor shows."""

from __future__ import annotations

import hashlib
import tempfile
from pathlib import Path

from urdfcheck.system.cache_folder import find_default_folder, write_atomically

# Beside the cache: not in it, as these files are not read again.
FOLDER = "urdfcheck-reports"
# Reports that are kept, of different files. One with meshes may have ten megabytes.
MOST_REPORTS = 12


def write_report(path: str, html: bytes) -> Path:
    """Write the report on a file, in place of the last one on it, and return where it is.

    The oldest of too many reports are removed. ``path``: the real path of the file.

    :raises OSError: if it cannot be written.
    """
    cache = find_default_folder()
    folder = Path(tempfile.gettempdir()) if cache is None else cache.parent
    folder = folder / FOLDER
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    digest = hashlib.sha256(path.encode(errors="surrogatepass")).hexdigest()[:16]
    report = folder / f"{digest}.html"
    write_atomically(report, html)
    written = sorted(folder.glob("*.html"), key=_read_time, reverse=True)
    for old in written[MOST_REPORTS:]:
        old.unlink(missing_ok=True)
    return report


def _read_time(path: Path) -> int:
    try:
        return path.stat().st_mtime_ns
    except FileNotFoundError:  # another server has removed it
        return 0
