"""Worker processes: each gets one job, answers it and ends.

They are forked where the platform can, else spawned. A server process of multiprocessing's own (forkserver, and spawn
without PYTHONSAFEPATH) is started as ``python -c`` and looks for modules in the working directory first: it would run a
``struct.py`` of the repository that is checked.
"""

from __future__ import annotations

import contextlib
import gc
import importlib
import multiprocessing
import os
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from typing import Any

# What takes long to load. Once a worker needed one of them it is loaded in the parent, for the workers to come.
HEAVY = ("numpy", "xacro", "yaml", "pinocchio", "coal", "scipy.spatial", "scipy.sparse.csgraph", "collada", "trimesh")
FORKS = "fork" in multiprocessing.get_all_start_methods()


class Died(Exception):
    """A worker ended without an answer; its exit code."""

    def __init__(self, exit_code: int | None) -> None:
        super().__init__(exit_code)
        self.exit_code = exit_code


@dataclass(frozen=True, slots=True, eq=False)
class Worker:
    """A process that waits for its job."""

    process: Any
    jobs: Connection
    answers: Connection

    @classmethod
    def start(cls, prepare: Callable[[], object] | None = None) -> Worker:
        """A new process; ``prepare`` is what it does before its job comes."""
        context = _context()
        job_receiver, jobs = context.Pipe(duplex=False)
        answers, sender = context.Pipe(duplex=False)
        # A forked process holds copies of our ends: it would never see that we closed them.
        ours = (jobs, answers) if FORKS else ()
        process = context.Process(target=_serve, args=(job_receiver, sender, prepare, ours), daemon=True)
        process.start()
        job_receiver.close()
        sender.close()
        return cls(process, jobs, answers)

    def give(self, function: Callable[..., object], *arguments: object) -> None:
        """Tell the job."""
        with contextlib.suppress(BrokenPipeError):  # it died already: its answer will say so
            self.jobs.send((function, arguments))
        self.jobs.close()

    def answer(self) -> tuple[Any, Sequence[str]]:
        """What the job returned, and what was loaded for it. Ends the process.

        :raises Died: when it ended without an answer.
        """
        try:
            result, loaded = self.answers.recv()
            return result, loaded
        except EOFError:
            self.process.join()
            raise Died(self.process.exitcode) from None
        finally:
            self.answers.close()
            self.process.join()


def in_workers(
    jobs: Sequence[tuple[Any, ...]],
    function: Callable[..., Any],
    at_once: int,
    first: Worker | None = None,
    modules: Iterable[str] = (),
    meanwhile: Callable[[], object] | None = None,
) -> Iterator[tuple[int, Any]]:
    """Call the function with each job's arguments, ``at_once`` at a time; as they come, the index of the job and what it
    returned, or `Died`. ``first``: a worker that waits already; ``modules``: what every job needs; ``meanwhile`` is called
    once while the first workers are busy."""
    shared = FORKS and len(jobs) > 1
    if shared:
        load(modules)
    waiting = list(range(len(jobs)))[::-1]
    running: dict[Connection, tuple[int, Worker]] = {}
    while waiting or running:
        while waiting and len(running) < at_once:
            index = waiting.pop()
            worker, first = first or Worker.start(), None
            worker.give(function, *jobs[index])
            running[worker.answers] = (index, worker)
        if meanwhile is not None:
            meanwhile()
            meanwhile = None
        for ready in wait(list(running)):
            assert isinstance(ready, Connection)
            index, worker = running.pop(ready)
            try:
                result, loaded = worker.answer()
            except Died as died:
                yield index, died
                continue
            if shared and len(waiting) > at_once and sys.platform == "linux":
                load(loaded)  # elsewhere system libraries do not survive a fork
            yield index, result


def load(modules: Iterable[str]) -> None:
    """Import modules for this process and those that are forked from it."""
    new = [name for name in modules if name not in sys.modules]
    for name in new:
        with contextlib.suppress(ImportError):
            importlib.import_module(name)
    if new:
        gc.freeze()  # what is loaded stays: no worker's garbage collection should touch, and so copy, its memory


def _serve(
    jobs: Connection, sender: Connection, prepare: Callable[[], object] | None, inherited: Sequence[Connection]
) -> None:
    for connection in inherited:
        connection.close()
    gc.disable()  # it lives for one model, and what that needs is needed until the end
    if prepare is not None:
        prepare()
    try:
        function, arguments = jobs.recv()
    except EOFError:  # there is none
        return
    result = function(*arguments)
    sender.send((result, [name for name in HEAVY if name in sys.modules]))
    sender.close()


def _context() -> Any:
    # Many small worker processes share the cores: a pool of BLAS threads in each would only get in the way, and a process
    # that has threads must not be forked.
    for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(variable, "1")
    if FORKS:
        return multiprocessing.get_context("fork")
    os.environ["PYTHONSAFEPATH"] = "1"
    return multiprocessing.get_context("spawn")
