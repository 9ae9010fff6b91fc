"""What simcheck does: plants its defects, and checks files. Run by a Python that has simcheck, never by that of urdfcheck.

``simcheck_side.py plant ENTRY FOLDER`` prints what was written as one line of JSON. ``simcheck_side.py check SECONDS`` reads
paths from stdin, one a line, and prints a line of JSON for each.
"""

from __future__ import annotations

import json
import resource
import signal
import sys
from pathlib import Path

from simcheck.bench import FLAG
from simcheck.checks.registry import Context
from simcheck.config import Config
from simcheck.core import check_file, load_asset
from simcheck.mutate import MUTATIONS, apply, copy_clean

ENGINES = ("mujoco",)


class TooLong(BaseException):
    """A check did not end in time."""


def main() -> None:
    """Do what the first word says."""
    if sys.argv[1] == "plant":
        print(json.dumps(plant(Path(sys.argv[2]), Path(sys.argv[3]))))
        return
    signal.signal(signal.SIGALRM, _stop)
    for line in sys.stdin:
        print(json.dumps(check(Path(line.strip()), int(sys.argv[2]))), flush=True)


def plant(entry: Path, folder: Path) -> dict[str, object]:
    """Write the sound robot and one copy for each operator that applies, as ``simcheck bench`` does."""
    config = Config(engines=ENGINES)
    context = Context(load_asset(entry, config), config)
    clean = copy_clean(entry, folder)
    written = {}
    for name, mutation in MUTATIONS.items():
        made = apply(entry, name, folder, 0, context)
        if made is not None:
            written[name] = {"file": str(made[0]), "what": made[1], "expect": mutation.expect}
    return {"clean": str(clean), "planted": written}


def check(file: Path, seconds: int) -> dict[str, object]:
    """Check one file; what is reported at warning or above, as check and message, and the seconds of processor time."""
    start = _sum_processor_time()
    signal.alarm(seconds)
    try:
        report = check_file(file, Config(engines=ENGINES))
        said = sorted({(finding.check, finding.message) for finding in report.findings if finding.severity in FLAG})
        problem = ""
    except TooLong:
        said, problem = [], "timeout"
    except Exception as error:
        said, problem = [], type(error).__name__
    finally:
        signal.alarm(0)
    return {"file": str(file), "said": said, "problem": problem, "seconds": _sum_processor_time() - start}


def _sum_processor_time() -> float:
    """Return the seconds of processor time of this process and those that it started: the engines run in one of their own."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(usage.ru_utime + usage.ru_stime for usage in used)


def _stop(_signal: int, _frame: object) -> None:
    raise TooLong


if __name__ == "__main__":
    main()
