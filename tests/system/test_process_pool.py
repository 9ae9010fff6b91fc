"""Worker processes that are kept between runs."""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys

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
