"""``urdfcheck check --watch``: check again whenever a file is saved that the findings depend on.

The files are polled. Notifications of the system would be faster, but they do not arrive for network folders, for the
folders of a container's host, or across the border of WSL. A robot has some hundred files; polling them takes a millisecond.
"""

from __future__ import annotations

import functools
import os
import sys
import time
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from urdfcheck.cli.terminal import FAILED, erase_progress, make_progress_printer, say
from urdfcheck.core.errors import UrdfcheckError
from urdfcheck.output.shared.escaping import escape_one_line
from urdfcheck.policy.config import OWN_FILE, PROJECT_FILE
from urdfcheck.run.jobs import Request
from urdfcheck.run.pipeline import AuditedRun, Execution, keep_valid_reports, run_audit
from urdfcheck.run.preload import start_warm_worker
from urdfcheck.source.package.file_kinds import is_launch, is_model, is_srdf
from urdfcheck.source.package.finder import format_path
from urdfcheck.source.package.package_folders import BUILD_FOLDERS
from urdfcheck.system.files import Stamp, read_stamp, walk

if TYPE_CHECKING:
    from urdfcheck.core import Run
    from urdfcheck.policy.config import Config
    from urdfcheck.system.process_pool import Worker

Stamps = Mapping[str, Stamp]
# Seconds between two polls at least, and the largest share of the time that is spent polling.
EVERY, PART = 0.25, 0.1
# After a change, wait until nothing has changed for this many seconds, so that several files or a large one are saved
# completely; but no longer than the second number.
QUIET, PATIENCE = 0.1, 3.0
# This many of the changed files are named.
FEW = 3


def watch(
    asked: tuple[Request, Config],
    ask: Callable[[], tuple[Request, Config]],
    report: Callable[[Run, Config], int],
    *,
    written: Collection[Path] = (),
    warm_worker: Worker | None = None,
    on_idle: Callable[[], object] | None = None,
) -> int:
    """Check until the user interrupts; return the exit code of the last check that finished.

    :param asked: what to check first.
    :param ask: computes it again after a change.
    :param report: prints the outcome and returns the exit code.
    :param written: the files that ``report`` writes.
    :param warm_worker: see :class:`urdfcheck.run.pipeline.Execution`, also for ``on_idle``.
    """
    code = FAILED
    request, settings = asked
    last: AuditedRun | None = None
    known: Stamps = {}
    changed: list[str] = []
    try:
        while True:
            stamps = _read_stamps((*known, *_iter_watched_files(request)))
            _print_heading(changed)
            try:
                if changed:
                    request, settings = ask()
                execution = Execution(warm_worker=warm_worker, on_idle=on_idle, on_progress=make_progress_printer())
                last = run_audit(request, execution, previous=keep_valid_reports(last, request))
                if last.outcome.partial:
                    break
                code = report(last.outcome, settings)
                # The stamps of the moment when each file was read: what was saved since is checked next.
                stamps.update((path, stamp) for r in last.reports.values() for path, stamp in r.reads.items())
            except UrdfcheckError as error:
                erase_progress()
                say(f"urdfcheck: {error}", sys.stderr)
                code, last = FAILED, None
            known = _exclude_written(stamps, written)
            count = sum(map(bool, known.values()))
            say(f"watching {count:,} {'file' if count == 1 else 'files'}; Ctrl-C ends it")
            sys.stdout.flush()
            # It loads what the next check needs while nothing changes.
            warm_worker = start_warm_worker()
            changed = _wait_for_changes(known, functools.partial(_iter_watched_files, request))
            if any(known.get(path) is None or read_stamp(path) is None for path in changed):
                last = None  # a file that appeared or disappeared may matter to any unit that looked for it
    except KeyboardInterrupt:
        erase_progress()
    return code


def _print_heading(changed: list[str]) -> None:
    """Print when and why the check runs, on an empty screen."""
    if sys.stdout.isatty():
        sys.stdout.write("\x1b[2J\x1b[H")
    names = [escape_one_line(format_path(Path(path))) for path in changed[:FEW]]
    more = f" and {len(changed) - FEW:,} more" if len(changed) > FEW else ""
    why = f"changed: {', '.join(names)}{more}" if names else "checking"
    say(f"{time.strftime('%H:%M:%S')} {why}")
    sys.stdout.flush()


def _wait_for_changes(known: Stamps, list_files: Callable[[], Iterable[str]]) -> list[str]:
    """Wait until files differ from their known stamps and all writing has ended; return their paths."""
    while True:
        began = time.monotonic()
        now = _read_stamps((*known, *list_files()))
        if _list_differing(known, now):
            until = time.monotonic() + PATIENCE
            while time.monotonic() < until:
                time.sleep(QUIET)
                before, now = now, _read_stamps((*known, *list_files()))
                if before == now:
                    break
            if differing := _list_differing(known, now):
                return differing
        time.sleep(max(EVERY, (time.monotonic() - began) / PART))


def _list_differing(before: Stamps, after: Stamps) -> list[str]:
    return sorted(path for path in after if before.get(path) != after[path])


def _read_stamps(paths: Iterable[str]) -> dict[str, Stamp]:
    return {path: read_stamp(path) for path in paths}


def _exclude_written(stamps: dict[str, Stamp], written: Collection[Path]) -> Stamps:
    """Return the stamps without those of our own reports; the folders of these with their stamps of now."""
    reports = {os.path.abspath(file) for file in written}
    folders = {os.path.dirname(file) for file in reports} & stamps.keys()
    return {path: stamp for path, stamp in {**stamps, **_read_stamps(folders)}.items() if path not in reports}


def _iter_watched_files(request: Request) -> Iterator[str]:
    """Yield the files that decide what is checked: the given ones, the possible models in a given folder, and the
    configurations above them, whether or not they exist."""
    for path in request.paths:
        start = Path(os.path.abspath(path))
        if not start.is_dir():
            yield str(start)
        for above in (start, *start.parents):
            yield from (str(above / name) for name in (OWN_FILE, PROJECT_FILE))
        for folder, below, names in walk(start):
            below[:] = [n for n in below if not n.startswith(".") and n not in BUILD_FOLDERS and n != "node_modules"]
            yield from (os.path.join(folder, name) for name in names if _is_relevant(Path(name)))
    if request.baseline is not None:
        yield str(request.baseline.path)


def _is_relevant(path: Path) -> bool:
    return is_model(path) or is_srdf(path) or is_launch(path) or path.name in {"package.xml", OWN_FILE, PROJECT_FILE}
