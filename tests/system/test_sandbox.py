"""What a worker gives up, and how a check that will not end is ended. Each thing is tried in a process of its own."""

from __future__ import annotations

import os
import pickle
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from urdfcheck.core import Severity, Span
from urdfcheck.core.errors import ModelTimeout
from urdfcheck.system import sandbox
from urdfcheck.system.process_pool import WorkerDiedError, WorkerTimeoutError, map_in_processes

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(sys.platform == "win32", reason="forks, signals and limits are those of POSIX"),
]


def landlock() -> bool:
    try:
        from py_landlock import get_abi_version
    except ImportError:
        return False
    try:
        return bool(get_abi_version() >= 1)
    except Exception:
        return False


def in_worker(function: Callable[..., object], *arguments: object) -> object:
    ((_, result),) = map_in_processes(function, [arguments], 1)
    return result


def attempt(what: str, confined: bool, kernel: bool, inside: str, outside: str, writable: str) -> str:
    """What comes of one deed in a confined process."""
    if not kernel:
        sandbox._restrict_by_landlock = lambda readable, writable: False  # as on a platform that has no Landlock
    if confined:
        sandbox.confine([inside], [writable], 4096)
    deeds: dict[str, Callable[[], object]] = {
        "read inside": lambda: Path(inside, "robot.urdf").read_text(),
        "read outside": lambda: Path(outside, "secret").read_text(),
        "read /etc": lambda: Path("/etc/passwd").read_text(),
        "write inside": lambda: Path(inside, "new").write_text("x"),
        "write outside": lambda: Path(outside, "new").write_text("x"),
        "write cache": lambda: Path(writable, "new").write_text("x"),
        "remove outside": lambda: os.remove(f"{outside}/secret"),
        "rename outside": lambda: os.rename(f"{outside}/secret", f"{writable}/secret"),
        "link outside": lambda: os.symlink("secret", f"{outside}/new"),
        "truncate outside": lambda: os.truncate(f"{outside}/secret", 0),
        "rights outside": lambda: os.chmod(f"{outside}/secret", 0),
        "times outside": lambda: os.utime(f"{outside}/secret", (0, 0)),
        "rights inside": lambda: os.chmod(f"{inside}/robot.urdf", 0),
        "rights of what is open": lambda: os.chmod(os.open(f"{inside}/robot.urdf", os.O_RDONLY), 0),
        "list outside": lambda: os.listdir(outside),
        "list inside": lambda: os.listdir(inside),
        "tidy cache": lambda: (os.mkdir(f"{writable}/a"), os.utime(f"{writable}/a"), os.rmdir(f"{writable}/a")),
        "signal": lambda: os.kill(os.getppid(), 0),
        "connect": lambda: socket.create_connection(("127.0.0.1", 9), timeout=1),
        "program": lambda: subprocess.run(["true"], check=True),
        "system": lambda: os.system("true"),
        "import": lambda: __import__("scipy.spatial").__name__,
    }
    try:
        deeds[what]()
    except PermissionError:
        return "refused"
    except OSError as error:
        return type(error).__name__
    return "done"


@pytest.fixture
def places(tmp_path: Path) -> tuple[str, str, str]:
    for name in ("inside", "outside", "cache"):
        (tmp_path / name).mkdir()
    (tmp_path / "inside" / "robot.urdf").write_text("<robot/>")
    (tmp_path / "outside" / "secret").write_text("s")
    return str(tmp_path / "inside"), str(tmp_path / "outside"), str(tmp_path / "cache")


@pytest.mark.parametrize("kernel", [True, False], ids=["kernel", "python alone"])
@pytest.mark.parametrize(
    ("deed", "outcome"),
    [
        ("read inside", "done"),
        ("read outside", "refused"),
        ("read /etc", "refused"),
        ("write inside", "refused"),
        ("write outside", "refused"),
        ("write cache", "done"),
        ("remove outside", "refused"),
        ("rename outside", "refused"),
        ("link outside", "refused"),
        ("truncate outside", "refused"),
        ("rights outside", "refused"),
        ("times outside", "refused"),
        ("rights inside", "refused"),
        ("rights of what is open", "refused"),
        ("list outside", "refused"),
        ("list inside", "done"),
        ("tidy cache", "done"),
        ("signal", "refused"),
        ("connect", "refused"),
        ("program", "refused"),
        ("system", "refused"),
        ("import", "done"),
    ],
)
def test_a_confined_process_reads_what_it_checks_and_does_nothing_else(
    places: tuple[str, str, str], deed: str, outcome: str, kernel: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    if kernel and not landlock():
        pytest.skip("this kernel has no Landlock")
    # What Python alone may write beside the cache: temporary files. These places lie among them otherwise.
    monkeypatch.setenv("TMPDIR", places[2])
    monkeypatch.setattr("tempfile.tempdir", None)
    assert in_worker(attempt, deed, True, kernel, *places) == outcome


@pytest.mark.parametrize("deed", ["read outside", "write outside", "program"])
def test_and_could_otherwise(places: tuple[str, str, str], deed: str) -> None:
    assert in_worker(attempt, deed, False, True, *places) == "done"


def memory_of(amount: int, limit: int) -> str:
    sandbox.confine([], [], limit)
    try:
        return str(len(bytearray(amount * 1024**2)))
    except MemoryError:
        return "refused"


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux bounds what a process allocates")
def test_memory_is_bounded() -> None:
    assert in_worker(memory_of, 100, 2048) != "refused"
    assert in_worker(memory_of, 4096, 2048) == "refused"


def endless(seconds: float, catches: int) -> str:
    caught = 0
    while True:
        try:
            with sandbox.enforce_deadline(seconds):
                while True:
                    try:
                        time.sleep(0.01)
                    except Exception:  # a check that handles what it should not
                        caught += 1
        except ModelTimeout:
            if caught >= catches:
                return "told"


def test_python_that_does_not_end_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    assert in_worker(endless, 0.1, 0) == "told"


def deaf(seconds: float) -> str:
    signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGALRM])  # as compiled code, which hears no signal
    time.sleep(seconds)
    return "ended"


@pytest.mark.long
def test_what_hears_nothing_is_killed_and_the_rest_goes_on() -> None:
    jobs = [(300.0,), (0.0,), (0.01,)]
    results = dict(map_in_processes(deaf, jobs, 2, timeout=4.0))
    assert isinstance(results[0], WorkerTimeoutError)
    assert (results[1], results[2]) == ("ended", "ended")


def aborts(fate: str) -> str:
    if fate == "signal":
        os.kill(os.getpid(), signal.SIGUSR1)
    if fate == "exit":
        os._exit(3)
    return fate


def test_a_worker_that_dies_is_told_from_its_job_and_the_rest_goes_on() -> None:
    results = dict(map_in_processes(aborts, [("signal",), ("one",), ("exit",), ("two",)], 1))
    assert (results[1], results[3]) == ("one", "two")
    assert [results[i].exit_code for i in (0, 2)] == [-signal.SIGUSR1, 3]
    assert not any(isinstance(results[i], WorkerTimeoutError) for i in (0, 2))


class Planted:
    """What a worker that a file has taken over could answer with."""

    def __init__(self, function: object) -> None:
        self.function = function

    def __reduce__(self) -> tuple[object, tuple[str, ...]]:
        return self.function, ("touch /tmp/urdfcheck-was-here",)


def answer(function: object) -> object:
    return Planted(function)


@pytest.mark.parametrize("function", [os.system, eval, subprocess.check_output], ids=lambda f: f.__name__)
def test_an_answer_is_data_and_nothing_that_runs(function: object) -> None:
    result = in_worker(answer, function)
    assert isinstance(result, WorkerDiedError)
    assert not Path("/tmp/urdfcheck-was-here").exists()


class Opened:
    """A class of ours that makes files when it is made."""

    def __init__(self, folder: str) -> None:
        self.folder = folder

    def __reduce__(self) -> tuple[object, tuple[object, ...]]:
        from urdfcheck.dataset.journal import Journal

        return Journal, (Path(self.folder), {}, frozenset())


class Astray:
    """A dtype of numpy with a field far behind the end of its values: to look at one ends the process, or shows its memory."""

    def __reduce__(self) -> tuple[object, tuple[object, ...], tuple[object, ...]]:
        import numpy as np

        return np.dtype, ("V8", False, True), (3, "|", None, ("x",), {"x": (np.dtype("<i8"), 1 << 40)}, 8, 1, 16)


class Named:
    """What is pickled as getattr of a class, as Python 3.11.2 does it with members of enumerations."""

    def __init__(self, kind: type, name: str) -> None:
        self.words = kind, name

    def __reduce__(self) -> tuple[object, tuple[type, str]]:
        return getattr, self.words


def named(kind: type, name: str) -> object:
    return Named(kind, name)


def planted(kind: str, folder: str) -> object:
    import numpy as np

    others: dict[str, object] = {
        "numpy": Astray(),
        "array": np.zeros(3),
        "code": planted.__code__.replace,
        "method": Named(Severity, "parse"),
        "class": Named(Span, "__init__"),
    }
    return Opened(folder) if kind == "ours" else others[kind]


@pytest.mark.parametrize("kind", ["ours", "numpy", "array", "code", "method", "class"])
def test_an_answer_is_of_no_class_that_does_something(kind: str, tmp_path: Path) -> None:
    assert isinstance(in_worker(planted, kind, str(tmp_path / "made")), WorkerDiedError)
    assert not (tmp_path / "made").exists()


def test_members_of_enumerations_arrive_however_they_are_sent() -> None:
    assert in_worker(named, Severity, "ERROR") is Severity.ERROR


def numbers() -> object:
    import numpy as np

    return [np.float64(0.1), np.float32(0.5), np.int64(-3), np.uint8(200), np.bool_(True)]


def test_a_number_of_numpy_is_a_number() -> None:
    assert in_worker(numbers) == [0.1, 0.5, -3, 200, True]


def test_every_report_is_data(tmp_path: Path) -> None:
    """What the real command sends comes through the same gate: a report with findings, meshes and a scene."""
    import io

    from conftest import FIXTURES, check

    from urdfcheck.system.plain_pickle import PlainUnpickler

    run = check(FIXTURES / "car-3", scene=True)
    back = PlainUnpickler(io.BytesIO(pickle.dumps((run.findings, run.models, run.scenes, run.skipped)))).load()
    assert back == (run.findings, run.models, run.scenes, run.skipped)
