"""``urdfcheck check --watch``: check once more whenever a file is saved that the findings rest on.

The files are looked at in turn. Notices of the system would come sooner, and not at all for folders of a network, of a
container's host or of the other side of WSL; a robot has some hundred files, and to look at them takes a millisecond.
"""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from urdfcheck.cli.preload import start_warm_worker
from urdfcheck.cli.terminal import FAILED, erase_progress, make_progress_printer, say
from urdfcheck.core.errors import UrdfcheckError
from urdfcheck.output.shared.inert import escape_one_line
from urdfcheck.policy.config import OWN, PROJECT
from urdfcheck.run.pipeline import Audited, Request, audited
from urdfcheck.source.discover import is_launch
from urdfcheck.source.package.finder import BUILD_FOLDERS, format_path
from urdfcheck.system.files import Stamp, read_stamp, walk

if TYPE_CHECKING:
    from urdfcheck.core import Run
    from urdfcheck.policy.config import Config
    from urdfcheck.system.process_pool import Worker

Stamps = Mapping[str, Stamp]
# Seconds between two looks at least, and of the time no more than this part is spent on looking.
EVERY, PART = 0.25, 0.1
# Who saves several files, or a large one, is waited for until nothing has changed for so many seconds, but not for ever.
QUIET, PATIENCE = 0.1, 3.0
# So many of the files that changed are named.
FEW = 3


def watch(
    asked: tuple[Request, Config],
    ask: Callable[[], tuple[Request, Config]],
    report: Callable[[Run, Config], int],
    written: Collection[Path] = (),
    first: Worker | None = None,
    meanwhile: Callable[[], object] | None = None,
) -> int:
    """Check until the user interrupts; the exit code of the last check that came to its end.

    ``asked`` is what to check, ``ask`` says it again after a change, ``report`` tells of the outcome and returns the exit code;
    ``written``: the files that it writes; ``first`` and ``meanwhile`` as for :func:`urdfcheck.run.pipeline.run`.
    """
    code = FAILED
    request, settings = asked
    last: Audited | None = None
    known: Stamps = {}
    changed: list[str] = []
    try:
        while True:
            seen = _read_stamps((*known, *_iter_watched_files(request)))
            _print_heading(changed)
            try:
                if changed:
                    request, settings = ask()
                last = audited(
                    request, None, first, meanwhile, make_progress_printer(), _keep_valid_reports(last, request)
                )
                if last.outcome.partial:
                    break
                code = report(last.outcome, settings)
                # As they were when they were read: what was saved since is checked next.
                seen.update((path, stamp) for r in last.reports.values() for path, stamp in r.reads.items())
            except UrdfcheckError as error:
                erase_progress()
                say(f"urdfcheck: {error}", sys.stderr)
                code, last = FAILED, None
            known = _exclude_written(seen, written)
            say(f"watching {sum(map(bool, known.values())):,} files; Ctrl-C ends it")
            sys.stdout.flush()
            # Until something changes it has loaded what the next check needs.
            first = start_warm_worker()
            changed = _wait_for_changes(known, lambda request=request: _iter_watched_files(request))  # type: ignore[misc]
            if any(known.get(path) is None or read_stamp(path) is None for path in changed):
                last = None  # what is there or not there any more may matter to whoever looked for it
    except KeyboardInterrupt:
        erase_progress()
    return code


def _keep_valid_reports(last: Audited | None, request: Request) -> Audited | None:
    """What is known of the last run: the reports that rest on files that are as they were."""
    if last is None or last.request != request:
        return None
    now: dict[str, Stamp] = {}
    reports = {
        place: report
        for place, report in last.reports.items()
        if not report.failures
        and all(now.setdefault(path, read_stamp(path)) == stamp for path, stamp in report.reads.items())
    }
    return replace(last, reports=reports)


def _print_heading(changed: list[str]) -> None:
    """When and why it is checked, on an empty screen."""
    if sys.stdout.isatty():
        sys.stdout.write("\x1b[2J\x1b[H")
    names = [escape_one_line(format_path(Path(path))) for path in changed[:FEW]]
    more = f" and {len(changed) - FEW:,} more" if len(changed) > FEW else ""
    why = f"changed: {', '.join(names)}{more}" if names else "checking"
    say(f"{time.strftime('%H:%M:%S')} {why}")
    sys.stdout.flush()


def _wait_for_changes(known: Stamps, listed: Callable[[], Iterable[str]]) -> list[str]:
    """Wait until files differ from what is known of them, and nobody is writing any more; their paths."""
    while True:
        began = time.monotonic()
        now = _read_stamps((*known, *listed()))
        if _list_differing(known, now):
            until = time.monotonic() + PATIENCE
            while time.monotonic() < until:
                time.sleep(QUIET)
                before, now = now, _read_stamps((*known, *listed()))
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
    """The stamps without what we write ourselves; the folders of that as they are now."""
    own = {os.path.abspath(file) for file in written}
    around = {os.path.dirname(file) for file in own} & stamps.keys()
    return {path: stamp for path, stamp in {**stamps, **_read_stamps(around)}.items() if path not in own}


def _iter_watched_files(request: Request) -> Iterator[str]:
    """The files that decide about what is checked: the given ones, those of a folder that may be models, and the configurations
    above them, which may not exist yet."""
    for path in request.paths:
        start = Path(os.path.abspath(path))
        if not start.is_dir():
            yield str(start)
        for above in (start, *start.parents):
            yield from (str(above / name) for name in (OWN, PROJECT))
        for folder, below, names in walk(start):
            below[:] = [n for n in below if not n.startswith(".") and n not in BUILD_FOLDERS and n != "node_modules"]
            yield from (os.path.join(folder, name) for name in names if _is_relevant(Path(name)))
    if request.baseline is not None:
        yield str(request.baseline.path)


def _is_relevant(path: Path) -> bool:
    return path.suffix in {".urdf", ".xacro", ".srdf"} or is_launch(path) or path.name in {"package.xml", OWN, PROJECT}
