"""Run engines, each in a separate process: a crash is a result and affects nothing else."""

from __future__ import annotations

import contextlib
import faulthandler
import importlib
import os
import re
import signal
import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path

from urdfcheck.core.errors import ModelTimeout
from urdfcheck.policy.limits import ResourceLimits
from urdfcheck.simulators.outcome import EngineInput, LoadOutcome
from urdfcheck.system import libraries, sandbox
from urdfcheck.system.files import read_start
from urdfcheck.system.process_pool import Worker, WorkerDiedError, WorkerTimeoutError, map_in_processes

# The engines in the order of the report; urdfdom is seen through pinocchio.
ENGINES = ("pinocchio", "urdfdom", "mujoco", "drake", "bullet", "gazebo", "yourdfpy", "newton", "isaac")
# Lines, and characters per line, that are kept of an engine's output.
MOST_LINES, LONGEST = 40, 400
# Of a file that an engine writes, its output among them, in MiB.
LARGEST_FILE = 1024
# Colours, and the source positions that engines print before their messages.
_MARKS = re.compile(
    r"\x1b\[[0-9;]*m|b3(?:Warning|Error|Printf)\[[^\]\n]*\]:\s*|b3Printf: "
    r"|^\[(?:Error|Warning)\] \[[\w.]+\] "
    r"|^(?:Error|Warning) \[\w+\.\w+:\d+\] *$|^ *at line \d+ in /?[\w./-]+ *$|/\S*/urdfcheck-\w+/\d+/",
    re.MULTILINE,
)
# Lines that engines print for any model.
_NOISE = (
    "pybullet build time",
    "Library error: libignition-tools-backward",
    "Valid.",
    "``addDiffuseTextureToPreviewMaterial`` was deprecated",
)


def list_versions() -> dict[str, str | None]:
    """Return the version of each engine; None for one that is not installed."""
    return {name: importlib.import_module(f"urdfcheck.simulators.{name}").get_version() for name in ENGINES}


def get_install_hint(engine: str) -> str:
    """Return how to install an engine, in most cases a command."""
    text: str = importlib.import_module(f"urdfcheck.simulators.{engine}").INSTALL
    return text


def iter_outcomes(
    jobs: Sequence[tuple[str, EngineInput]],
    *,
    around: Sequence[str],
    limits: ResourceLimits,
    at_once: int = 1,
    apart: bool = True,
) -> Iterator[tuple[int, LoadOutcome]]:
    """Load robots in engines; yields the index of each job and its outcome as they finish.

    :param jobs: names of engines with the robots to load.
    :param around: folders that the processes may read.
    :param apart: whether each job has its own process; otherwise all jobs must be for the same engine.
    """
    with tempfile.TemporaryDirectory(prefix="urdfcheck-", ignore_cleanup_errors=True) as folder:
        work = []
        for place, (engine, robot) in enumerate(jobs):
            own = os.path.join(folder, str(place))
            os.mkdir(own)
            # Not the folders of the other engines: whose library was taken over shall not answer for them.
            writable = own if apart else folder
            work.append((engine, robot, own, writable, tuple(around), limits))
        timeout = limits.seconds + sandbox.PATIENCE if limits.seconds else None
        worker = None if apart else Worker.start(_prepare_nothing)
        for place, result in map_in_processes(
            _load_in_engine, work, at_once, warm_worker=worker, timeout=timeout, is_spent=lambda _: apart
        ):
            if isinstance(result, WorkerDiedError):
                said = _read_output(Path(folder, str(place)))
                ending = _describe_ending(result, limits)
                yield place, LoadOutcome(jobs[place][0], loaded=None, refused=ending, messages=said, stopped=True)
            else:
                yield place, result


def _prepare_nothing() -> None:
    """Do nothing: only a worker with a preparation excludes inherited objects from the garbage collection of each job."""


def _describe_ending(died: WorkerDiedError, limits: ResourceLimits) -> str:
    if isinstance(died, WorkerTimeoutError):
        return f"does not end within {limits.seconds:g} s"
    if died.exit_code is not None and died.exit_code < 0:
        with contextlib.suppress(ValueError):
            return f"crashes ({signal.Signals(-died.exit_code).name})"
    return "ends its process" if died.exit_code is not None else "sends an invalid answer"


def _load_in_engine(
    engine: str, robot: EngineInput, own: str, writable: str, around: Sequence[str], limits: ResourceLimits
) -> LoadOutcome:
    """Load a robot in the process of an engine; files that it needs go to the folder ``own``, in ``writable``."""
    libraries.prefer_own_folders()
    module = importlib.import_module(f"urdfcheck.simulators.{engine}")
    loaded, refused, stopped = None, "", False
    faulthandler.disable()  # a crash is a result and must not be printed
    os.chdir(own)  # MuJoCo writes its warnings into a file of the working directory
    with _capture_output(own):
        for library in module.LIBRARIES:  # before confinement: some run programs when they are imported
            importlib.import_module(library)
        sandbox.confine((*around, writable), (writable,), limits.memory)
        sandbox.limit_file_size(LARGEST_FILE)
        path = Path(own, "robot.urdf")
        path.write_bytes(robot.document)
        try:
            with sandbox.enforce_deadline(limits.seconds):
                loaded = module.load(robot, str(path))
        except ModelTimeout:
            refused, stopped = f"does not end within {limits.seconds:g} s", True
        except (
            Exception,
            SystemExit,
        ) as error:  # each of them has its own kinds; Drake would leave at a failed assertion
            refused = next(iter(_split_lines(str(error))), type(error).__name__)
    said = _read_output(Path(own))
    return LoadOutcome(engine, loaded=loaded, refused=refused, messages=said, stopped=stopped)


@contextlib.contextmanager
def _capture_output(own: str) -> Iterator[None]:
    """Redirect all output, of native code too, to a file, which survives a crash of the process."""
    import ctypes

    flush = getattr(ctypes.CDLL(None), "fflush", lambda _: None) if sys.platform != "win32" else (lambda _: None)
    saved = [(stream, os.dup(stream)) for stream in (1, 2)]
    with open(os.path.join(own, "said"), "wb", buffering=0) as file:
        for stream, _ in saved:
            os.dup2(file.fileno(), stream)
    try:
        yield
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        flush(None)
        for stream, copy in saved:
            os.dup2(copy, stream)
            os.close(copy)


def _read_output(own: Path) -> tuple[str, ...]:
    """Return what an engine has printed. It could have put a link or a pipe in the place of the file, which this process, where
    it is not confined, must neither follow nor wait for."""
    try:
        data = read_start(own / "said", MOST_LINES * LONGEST, follows_link=False)
    except OSError:
        return ()
    return tuple(_split_lines(data.decode("utf-8", "replace")))


def _split_lines(text: str) -> list[str]:
    lines = (line.strip()[:LONGEST] for line in _MARKS.sub(_remove_mark, text).split("\n"))
    return list(dict.fromkeys(line for line in lines if line and not line.startswith(_NOISE)))[:MOST_LINES]


def _remove_mark(mark: re.Match[str]) -> str:
    """Replace a mark: most precede a message and become a line end; the folder of our own file is removed from paths."""
    return "" if mark[0].startswith(("/", "\x1b")) else "\n"
