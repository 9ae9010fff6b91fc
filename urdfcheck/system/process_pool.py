"""Worker processes: each takes one job after the other.

They are forked where the platform supports it, and spawned elsewhere. A server process of multiprocessing (forkserver, or
spawn without PYTHONSAFEPATH) is started as ``python -c`` and looks for modules in the working directory first: it would run
a ``struct.py`` of the repository that is checked.
"""

from __future__ import annotations

import contextlib
import gc
import io
import multiprocessing
import os
import signal
import sys
import time
from collections.abc import Callable, Hashable, Iterable, Iterator, Sequence
from functools import partial
from multiprocessing.connection import Connection, wait
from typing import Any

from urdfcheck.core.records import dataclass
from urdfcheck.system.plain_pickle import load_plain

FORKS = "fork" in multiprocessing.get_all_start_methods()
ENDING = (signal.SIGINT, signal.SIGTERM)
# Environment variables that are set for the workers.
_THREAD_VARIABLES = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")
WORKER_VARIABLES = (*_THREAD_VARIABLES, "PYTHONSAFEPATH")
# With at most this many jobs, the warm worker may finish them before another has loaded its libraries, which takes about this
# many seconds.
_FEW, _PATIENCE = 4, 0.3
# From linux/prctl.h: the signal that a process gets when its parent ends.
_PR_SET_PDEATHSIG = 1
# From glibc's malloc.h: how much free memory a process keeps at most, and the least block that it gives back at once.
_M_TRIM_THRESHOLD, _M_MMAP_THRESHOLD = -1, -3
# glibc takes no greater block. To keep all of them (M_MMAP_MAX) saves nothing more, and takes a fifth more memory.
_KEPT_BYTES, _KEPT_BLOCK = 256 * 1024**2, 32 * 1024**2
# Bytes of an answer; the texts of its files have at most an eighth of it.
MAX_ANSWER = 1024**3
# Seconds without a job after which a worker looks for garbage, rather than before its next job.
_BREAK = 0.05
# Objects, and pages of memory (128 MiB), of which it looks for garbage before its next job.
_MANY_OBJECTS, _MANY_PAGES = 100_000, 32_768
# Seconds that a worker has to exit after it closed its pipe.
_GRACE = 10.0


class WorkerDiedError(Exception):
    """A worker exited without an answer."""

    def __init__(self, exit_code: int | None) -> None:
        super().__init__(exit_code)
        self.exit_code = exit_code


class WorkerTimeoutError(WorkerDiedError):
    """A worker was killed because its job took too long."""


@dataclass(frozen=True, slots=True, eq=False)
class Worker:
    """A process that waits for jobs. It exits when the parent closes its end of the pipe."""

    process: Any
    pipe: Connection
    prepare: Callable[[], object] | None = None

    @classmethod
    def start(cls, prepare: Callable[[], object] | None = None) -> Worker:
        """Start a process, which calls ``prepare`` before its first job."""
        context = _make_context()
        ours, its = context.Pipe()
        # A forked process inherits our end of the pipe and would never see that we closed it.
        arguments = (its, prepare, ours if FORKS else None, os.getpid())
        process = context.Process(target=_serve_jobs, args=arguments, daemon=True)
        with block_ending_signals():
            process.start()
        its.close()
        return cls(process, ours, prepare)

    def send_job(self, function: Callable[..., object], arguments: Sequence[object]) -> None:
        """Send a job to the process."""
        with contextlib.suppress(BrokenPipeError):  # it has died: receive_answer reports that
            self.pipe.send((function, arguments))

    def receive_answer(self) -> Any:
        """Return the result of the job.

        :raises WorkerDiedError: when the process exited without an answer, or sent anything but plain data.
        """
        try:
            data = self.pipe.recv_bytes(MAX_ANSWER)
        except (EOFError, OSError):
            self.pipe.close()
            self.process.join(_GRACE)
            self.process.kill()  # in case that it survives its pipe
            self.process.join()
            raise WorkerDiedError(self.process.exitcode) from None
        try:
            return load_plain(io.BytesIO(data))
        except Exception:  # a malformed pickle may raise anything
            self.end()
            raise WorkerDiedError(None) from None

    def end(self) -> None:
        """Kill the process."""
        self.process.kill()
        self.process.join()
        self.pipe.close()


class SpareWorkers:
    """Workers that wait between runs, by what they gave up: a process never sees more folders again than for its first job."""

    def __init__(self) -> None:
        self._waiting: dict[Hashable, list[Worker]] = {}

    def get_list(self, rights: Hashable) -> list[Worker]:
        """Return the list of the workers with these rights, for :func:`map_in_processes`, without those that have died."""
        workers = self._waiting.setdefault(rights, [])
        workers[:] = [worker for worker in workers if worker.process.is_alive()]
        return workers

    def end(self) -> None:
        """End all of them."""
        for workers in self._waiting.values():
            for worker in workers:
                worker.end()
        self._waiting.clear()

    def __len__(self) -> int:
        return len(self._waiting)


def map_in_processes(
    function: Callable[..., Any],
    jobs: Sequence[Sequence[object]],
    at_once: int,
    *,
    warm_worker: Worker | None = None,
    spare_workers: list[Worker] | None = None,
    on_idle: Callable[[], object] | None = None,
    timeout: float | None = None,
    is_spent: Callable[[Any], bool] = lambda _: False,
) -> Iterator[tuple[int, Any]]:
    """Call a function with the arguments of each job in worker processes.

    Yields the index of each job and its result, or a `WorkerDiedError`, as they finish.

    :param at_once: how many workers run at a time.
    :param warm_worker: a worker that is started already; others are started like it.
    :param spare_workers: workers of earlier calls, which are used first; at the end it holds those that are idle.
    :param on_idle: is called once while the first workers are busy.
    :param timeout: seconds after which the worker of a job is killed (`WorkerTimeoutError`).
    :param is_spent: whether the worker that returned this result must not get another job.
    """
    waiting = list(range(len(jobs)))[::-1]
    idle = [] if warm_worker is None else [warm_worker]
    if spare_workers is not None:
        idle += spare_workers
        spare_workers.clear()
    busy: dict[Connection, tuple[int, Worker, float]] = {}
    until = time.monotonic() + (_PATIENCE if idle and len(jobs) <= _FEW else 0.0)
    try:
        while waiting or busy:
            patience = max(0.0, until - time.monotonic())
            while waiting and (idle or not busy or (len(busy) < at_once and not patience)):
                worker = idle.pop() if idle else Worker.start(None if warm_worker is None else warm_worker.prepare)
                index = waiting.pop()
                worker.send_job(function, jobs[index])
                busy[worker.pipe] = index, worker, time.monotonic()
            if on_idle is not None:
                on_idle()
                on_idle = None
            ends = [patience] if waiting and patience else []
            if timeout is not None:
                ends += [max(0.0, began + timeout - time.monotonic()) for _, _, began in busy.values()]
            for ready in wait(list(busy), min(ends, default=None)):
                assert isinstance(ready, Connection)
                index, worker, _ = busy.pop(ready)
                try:
                    result = worker.receive_answer()
                except WorkerDiedError as died:
                    yield index, died
                else:
                    if is_spent(result):
                        worker.end()
                    else:
                        idle.append(worker)
                    yield index, result
            for pipe, (index, worker, began) in list(busy.items()):
                if timeout is not None and time.monotonic() - began > timeout:
                    del busy[pipe]
                    worker.end()
                    yield index, WorkerTimeoutError(worker.process.exitcode)
    finally:  # also when we are interrupted: no worker survives but those that wait for another call
        _release_workers([worker for _, worker, _ in busy.values()], idle if spare_workers is None else ())
        if spare_workers is not None:
            spare_workers += idle


def _release_workers(busy: Iterable[Worker], idle: Iterable[Worker]) -> None:
    """Kill the workers that have a job, and let the others end by themselves."""
    for worker in busy:
        worker.end()
    for worker in idle:
        worker.pipe.close()


@contextlib.contextmanager
def block_ending_signals() -> Iterator[None]:
    """Delay the signals that end this process: one that arrives while a process is started, or while files that belong together
    are written, would leave half of them behind."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, ENDING)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _serve_jobs(
    pipe: Connection, prepare: Callable[[], object] | None, inherited: Connection | None, parent: int
) -> None:
    end_with_parent(parent)
    give_back = _keep_freed_memory()
    # An interrupt from the keyboard reaches every process of the terminal; the parent ends its workers.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, ENDING)
    if inherited is not None:
        inherited.close()
    gc.disable()  # a job needs its objects until its end
    if prepare is not None:
        prepare()
    garbage = _Garbage()
    with contextlib.suppress(EOFError, OSError):  # the parent has exited, or has no more jobs
        is_busy = False
        while True:
            function, arguments = pipe.recv()
            if is_busy and garbage.may_be_much():
                garbage.collect()
            pipe.send(function(*arguments))
            is_busy = pipe.poll(_BREAK)
            if not is_busy:  # there is time for it now
                garbage.collect()
                give_back()


class _Garbage:
    """What the jobs of this process leave behind. To look for it takes as long as the check of a small robot, which leaves a few
    thousand objects."""

    def __init__(self) -> None:
        self._are_libraries_frozen = False
        self._memory: int | None = None
        with contextlib.suppress(OSError):  # of Linux; open from the start, because a confined process cannot open it
            self._memory = os.open("/proc/self/statm", os.O_RDONLY)
        gc.freeze()  # loaded modules stay: later collections need not traverse them
        self._kept = self._read_pages()

    def may_be_much(self) -> bool:
        """Whether jobs since the last collection left many objects, or much memory; true where that is not known."""
        pages = self._read_pages()
        return not pages or pages - self._kept > _MANY_PAGES or gc.get_count()[0] > _MANY_OBJECTS

    def collect(self) -> None:
        """Free it."""
        gc.collect()
        if not self._are_libraries_frozen:  # those that the first jobs loaded
            gc.freeze()
            self._are_libraries_frozen = True
        self._kept = self._read_pages()

    def _read_pages(self) -> int:
        """Return the number of pages of this process in memory; 0 where the platform does not tell."""
        return 0 if self._memory is None else int(os.pread(self._memory, 200, 0).split()[1])


def end_with_parent(parent: int) -> None:
    """Let the kernel kill this process when its parent ends, however that ends. Linux only: elsewhere a worker whose parent was
    killed ends after its job."""
    if sys.platform != "linux":
        return
    import ctypes

    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:  # it has ended already
        os._exit(0)


def _keep_freed_memory() -> Callable[[], object]:
    """Let this process use memory again that it has freed, and return what gives it back to the system.

    glibc would give back most blocks at once, and the kernel fills the next with zeros, page by page: a tenth of the time for a
    large mesh.
    """
    if sys.platform != "linux":
        return lambda: None
    import ctypes

    library = ctypes.CDLL(None)
    if not hasattr(library, "mallopt"):  # not glibc
        return lambda: None
    library.mallopt(_M_MMAP_THRESHOLD, _KEPT_BLOCK)
    library.mallopt(_M_TRIM_THRESHOLD, _KEPT_BYTES)
    return partial(library.malloc_trim, 0)


def limit_threads() -> None:
    """One thread of BLAS for each process, unless the environment says otherwise. Before NumPy is loaded.

    The processes share the cores, so that more threads would only compete; and a process with threads must not be forked.
    """
    for variable in _THREAD_VARIABLES:
        os.environ.setdefault(variable, "1")


def _make_context() -> Any:
    limit_threads()
    if FORKS:
        return multiprocessing.get_context("fork")
    os.environ["PYTHONSAFEPATH"] = "1"
    return multiprocessing.get_context("spawn")
