"""Worker processes: each takes one job after the other.

They are forked where the platform can, else spawned. A server process of multiprocessing's own (forkserver, and spawn
without PYTHONSAFEPATH) is started as ``python -c`` and looks for modules in the working directory first: it would run a
``struct.py`` of the repository that is checked.
"""

from __future__ import annotations

import contextlib
import gc
import io
import multiprocessing
import os
import pickle
import signal
import struct
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, is_dataclass
from enum import Enum
from multiprocessing.connection import Connection, wait
from typing import Any

FORKS = "fork" in multiprocessing.get_all_start_methods()
ENDING = (signal.SIGINT, signal.SIGTERM)
# So few jobs may be done by the first worker before another has loaded what it needs, which takes about so many seconds.
_FEW, _PATIENCE = 4, 0.3
# So many seconds a worker has to end after it closed its pipe.
_GRACE = 10.0


class WorkerDiedError(Exception):
    """A worker ended without an answer; its exit code."""

    def __init__(self, exit_code: int | None) -> None:
        super().__init__(exit_code)
        self.exit_code = exit_code


class WorkerTimeoutError(WorkerDiedError):
    """A worker was ended because its job took too long."""


class _DtypeStandIn:
    """Stands for a dtype of numpy, which takes any state that it is told, and then reads memory that is not its own."""

    def __init__(self, code: str, *_: object) -> None:
        self.form = _FORMS[code]

    def __setstate__(self, _: object) -> None:
        """Numbers that are sent have the order of bytes of this machine."""


# How struct calls the numbers that numpy has.
_FORMS = {"b1": "?", "f4": "f", "f8": "d"}
_FORMS |= {f"i{1 << n}": "bhiq"[n] for n in range(4)} | {f"u{1 << n}": "BHIQ"[n] for n in range(4)}


def _unpack_number(kind: _DtypeStandIn, data: bytes) -> float:
    """A number of numpy's as one of Python's own."""
    (number,) = struct.unpack("=" + kind.form, data)
    value: float = number
    return value


def _get_enum_member(kind: object, name: object) -> Enum:
    """A member of an enumeration, which Python 3.11 up to its third release sends as ``getattr`` of its class.

    :raises pickle.UnpicklingError: for anything else that getattr could be asked for.
    """
    if isinstance(kind, type) and issubclass(kind, Enum) and name in kind.__members__:
        return kind.__members__[str(name)]
    raise pickle.UnpicklingError("a worker sent builtins.getattr, which is no data")


class _PlainUnpickler(pickle.Unpickler):
    """Reads what a worker sends. It is plain data: a worker that a hostile file has taken over can send no more than that.

    Of our own classes only data classes and enumerations of the modules that reports and plans are made of are found, and
    under their own name: others open files when they are made.
    """

    _OTHERS = frozenset(
        {("builtins", name) for name in ("set", "frozenset", "complex", "slice", "MemoryError")}
        | {("collections", "OrderedDict")}
        | {(module, f"{kind}Path") for module in ("pathlib", "pathlib._local") for kind in ("Posix", "Windows")}
    )
    _NUMBERS: Mapping[tuple[str, str], Any] = {
        ("numpy", "dtype"): _DtypeStandIn,
        **{(f"numpy.{core}.multiarray", "scalar"): _unpack_number for core in ("core", "_core")},
    }
    _OURS = frozenset(
        f"urdfcheck.{module}"
        for module in (
            "core.drop_test",
            "core.findings",
            "core.rule",
            "core.run",
            "core.scene",
            "export.link_pairs",
            "export.outline",
            "policy.config",
            "policy.limits",
            "policy.suppression",
            "run.audit",
            "simulators.outcome",
            "source.discover",
            "source.reach",
            "source.text.suppression_comments",
        )
    )

    def find_class(self, module: str, name: str) -> Any:
        if (module, name) in self._NUMBERS:
            return self._NUMBERS[module, name]
        if (module, name) in self._OTHERS:
            return super().find_class(module, name)
        if (module, name) == ("builtins", "getattr"):
            return _get_enum_member
        found = super().find_class(module, name) if module in self._OURS and "." not in name else None
        if (
            not isinstance(found, type)
            or found.__module__ != module
            or not (is_dataclass(found) or issubclass(found, Enum))
        ):
            raise pickle.UnpicklingError(f"a worker sent {module}.{name}, which is no data")
        return found


@dataclass(frozen=True, slots=True, eq=False)
class Worker:
    """A process that waits for jobs. It ends when nobody holds the other end of its pipe any more."""

    process: Any
    pipe: Connection
    prepare: Callable[[], object] | None = None

    @classmethod
    def start(cls, prepare: Callable[[], object] | None = None) -> Worker:
        """A new process; ``prepare`` is what it does before its first job comes."""
        context = _make_context()
        ours, its = context.Pipe()
        # A forked process holds a copy of our end: it would never see that we closed it.
        process = context.Process(target=_serve_jobs, args=(its, prepare, ours if FORKS else None), daemon=True)
        with block_ending_signals():
            process.start()
        its.close()
        return cls(process, ours, prepare)

    def send_job(self, function: Callable[..., object], arguments: Sequence[object]) -> None:
        """Tell it a job."""
        with contextlib.suppress(BrokenPipeError):  # it died already: its answer will say so
            self.pipe.send((function, arguments))

    def receive_answer(self) -> Any:
        """What the job returned.

        :raises Died: when the process ended without an answer.
        """
        try:
            data = self.pipe.recv_bytes()
        except (EOFError, ConnectionResetError):
            self.pipe.close()
            self.process.join(_GRACE)
            self.process.kill()  # one that lives on without its pipe
            self.process.join()
            raise WorkerDiedError(self.process.exitcode) from None
        try:
            return _PlainUnpickler(io.BytesIO(data)).load()
        except Exception:  # whatever a pickle that is none may raise
            self.end()
            raise WorkerDiedError(None) from None

    def end(self) -> None:
        """Kill it, whatever it is doing."""
        self.process.kill()
        self.process.join()
        self.pipe.close()


def map_in_processes(
    function: Callable[..., Any],
    jobs: Sequence[Sequence[object]],
    at_once: int,
    warm_worker: Worker | None = None,
    on_idle: Callable[[], object] | None = None,
    timeout: float | None = None,
    is_spent: Callable[[Any], bool] = lambda _: False,
) -> Iterator[tuple[int, Any]]:
    """Call the function with each job's arguments, ``at_once`` at a time; as they come, the index of the job and what it
    returned, or `WorkerDiedError`. ``first``: a worker that waits already, and that others are like; ``meanwhile`` is called once while
    the first are busy; ``longest``: after so many seconds a job's worker is killed (`WorkerTimeoutError`);
    ``spent`` says of a result that its worker is fit for no other job."""
    waiting = list(range(len(jobs)))[::-1]
    idle = [] if warm_worker is None else [warm_worker]
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
    finally:  # also when we are interrupted: nobody works on
        for _, worker, _ in busy.values():
            worker.end()
        for worker in idle:
            worker.pipe.close()


@contextlib.contextmanager
def block_ending_signals() -> Iterator[None]:
    """Let signals that end us wait: in the middle of starting a process they would leave half of one behind, and of several
    files that belong together some."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, ENDING)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _serve_jobs(pipe: Connection, prepare: Callable[[], object] | None, inherited: Connection | None) -> None:
    # An interrupt from the keyboard reaches every process of the terminal: it is the parent's to end us.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, ENDING)
    if inherited is not None:
        inherited.close()
    gc.disable()  # what a job needs it needs until its end
    if prepare is not None:
        prepare()
    gc.freeze()  # what is loaded stays: no later collection need look through it
    with contextlib.suppress(EOFError, OSError):  # the parent has gone, or has no more jobs
        while True:
            function, arguments = pipe.recv()
            gc.collect()  # the remains of the job before
            pipe.send(function(*arguments))


def _make_context() -> Any:
    # The processes share the cores: a pool of BLAS threads in each would only get in the way, and a process that has
    # threads must not be forked.
    for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(variable, "1")
    if FORKS:
        return multiprocessing.get_context("fork")
    os.environ["PYTHONSAFEPATH"] = "1"
    return multiprocessing.get_context("spawn")
