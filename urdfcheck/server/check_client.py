"""The server's end of the check process: starts it, sends it jobs, interrupts them, and starts it again if it dies."""

from __future__ import annotations

import asyncio
import contextlib
import io
import os
import pickle
import signal
import sys

from urdfcheck.run.request import RunOptions
from urdfcheck.server.check_messages import HEADER, CheckAnswer, CheckJob
from urdfcheck.system.plain_pickle import load_plain

# The path of modules is that of this process, and not the working directory: its files are checked.
_PROGRAM = (
    "import pickle, sys; path, options, parent = pickle.load(sys.stdin.buffer); sys.path[:] = path; "
    "from urdfcheck.server.check_process import serve_checks; serve_checks(pickle.loads(options), parent)"
)
# The folder of this package is not in the path where it is the working directory too.
_OWN_FOLDER = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
# Deaths without an answer in between, after which the process is not started again.
_MOST_DEATHS = 3


class CheckProcessError(Exception):
    """The check process died in the middle of a job."""


class CheckClient:
    """One check process; it runs one job at a time."""

    def __init__(self, options: RunOptions) -> None:
        self.options = options
        self.process: asyncio.subprocess.Process | None = None
        self.deaths = 0
        self.is_ended = False
        self.can_be_interrupted = False
        self._lock = asyncio.Lock()

    @property
    def can_start(self) -> bool:
        """Whether the next job starts a process again if this one has died."""
        return self.deaths < _MOST_DEATHS and not self.is_ended

    async def start(self) -> None:
        """Start the process, which loads its libraries while there is nothing to do."""
        self.can_be_interrupted = False  # it would die before it is ready for that
        self.process = await asyncio.create_subprocess_exec(
            *(sys.executable, "-c", _PROGRAM),
            stdin=asyncio.subprocess.PIPE,
            stdout=asyncio.subprocess.PIPE,
            cwd=os.path.dirname(os.__file__),
        )
        path = [*dict.fromkeys((*sys.path, _OWN_FOLDER))]
        self._send(pickle.dumps((path, pickle.dumps(self.options), os.getpid())))

    async def run_job(self, job: CheckJob) -> CheckAnswer:
        """Return the outcome of a job.

        :raises CheckProcessError: if the process died; the next job starts another.
        """
        async with self._lock:
            if not self.can_start:
                raise CheckProcessError("the check process died too often: start the server again")
            try:
                return await self._exchange(job)
            except (asyncio.IncompleteReadError, ConnectionError, EOFError, pickle.UnpicklingError) as error:
                self.deaths += 1
                await self.stop()
                raise CheckProcessError(f"the check process died ({type(error).__name__})") from error

    async def _exchange(self, job: CheckJob) -> CheckAnswer:
        if self.process is None:
            await self.start()
        assert self.process is not None
        assert self.process.stdout is not None  # a pipe
        data = pickle.dumps(job)
        self._send(HEADER.pack(len(data)) + data)
        while True:
            (size,) = HEADER.unpack(await self.process.stdout.readexactly(HEADER.size))
            if not size:
                self.can_be_interrupted = sys.platform != "win32"
                continue
            answer: CheckAnswer = load_plain(io.BytesIO(await self.process.stdout.readexactly(size)))
            self.deaths = 0
            if answer.number == job.number:  # not that of a job whose caller has gone
                return answer

    def _send(self, data: bytes) -> None:
        assert self.process is not None
        assert self.process.stdin is not None  # a pipe
        self.process.stdin.write(data)

    def cancel(self) -> None:
        """Interrupt the job that runs, if any. Where a process cannot be interrupted, the job runs to its end."""
        if self.process is not None and self.process.returncode is None and self.can_be_interrupted:
            with contextlib.suppress(ProcessLookupError):
                self.process.send_signal(signal.SIGINT)

    async def end(self) -> None:
        """End the process, and start no other."""
        self.is_ended = True
        await self.stop()

    async def stop(self) -> None:
        """End the process."""
        process, self.process = self.process, None
        if process is not None and process.returncode is None:
            with contextlib.suppress(ProcessLookupError):
                process.kill()
            await process.wait()
