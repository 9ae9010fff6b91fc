"""Worker processes that are kept between runs."""

from __future__ import annotations

import gc
import json
import multiprocessing
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from urdfcheck.system import process_pool

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(sys.platform == "win32", reason="signals are those of POSIX"),
]


def test_workers_that_wait_are_used_again_and_dead_ones_are_not() -> None:
    spare = process_pool.SpareWorkers()
    waiting = spare.get_list("rights")

    def find_process() -> int:
        ((_, answer),) = process_pool.map_in_processes(os.getpid, [()], 1, spare_workers=waiting)
        return int(answer)

    first = find_process()
    assert find_process() == first
    assert spare.get_list("other rights") == []
    os.kill(first, signal.SIGKILL)
    waiting[0].process.join()
    assert spare.get_list("rights") == []
    assert find_process() != first
    spare.end()
    assert not [child for child in multiprocessing.active_children() if child.pid == first]


def leave_garbage(size: int) -> tuple[int, int]:
    """Leave an object that refers to itself and holds ``size`` bytes; return how often garbage was looked for before, and how
    much memory the process has."""
    loop: list[object] = [bytearray(b"x" * size)]
    loop.append(loop)
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return gc.get_stats()[2]["collections"], pages * os.sysconf("SC_PAGESIZE")


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere garbage is looked for before each job")
def test_small_jobs_do_not_wait_for_a_search_for_garbage() -> None:
    done = dict(process_pool.map_in_processes(leave_garbage, [(1024,)] * 5, 1))
    assert len({collections for collections, _ in done.values()}) == 1


# A process of its own: a worker is forked, and what the test runner has freed would hold the garbage of the first jobs.
LARGE_JOBS = """
import json, sys
sys.path.insert(0, {folder!r})
from test_process_pool import leave_garbage
from urdfcheck.system import process_pool
print(json.dumps(sorted(process_pool.map_in_processes(leave_garbage, [({size},)] * 12, 1))))
"""


@pytest.mark.skipif(sys.platform != "linux", reason="it is not known how much there is")
def test_the_garbage_of_large_jobs_is_bounded() -> None:
    size = 64 * 1024**2
    script = LARGE_JOBS.format(folder=str(Path(__file__).parent), size=size)
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert not done.returncode, done.stderr
    answers = [answer for _, answer in json.loads(done.stdout)]
    memory = [used for _, used in answers]
    assert max(memory) - min(memory) < 5 * size
    assert len({collections for collections, _ in answers}) > 3
