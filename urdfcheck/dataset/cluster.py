"""The work of an audit on the machines of a cluster that is already there: Dask's or Ray's, through joblib.

A process of the cluster lives long, has threads and may not have children of multiprocessing: it neither gives anything up
nor reads a stranger's file. It starts a program that does what the command does on this machine: a process for the models
that is confined, watched and ended.
"""

from __future__ import annotations

import contextlib
import logging
import os
import pickle
import subprocess
import sys
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any

from urdfcheck import __version__
from urdfcheck.core.errors import UrdfcheckError

if TYPE_CHECKING:
    from urdfcheck.run.jobs import AuditSettings, Unit, UnitReport

    Numbered = tuple[int, Unit]

BACKENDS = ("dask", "ray")
# Models of a task: so many that loading the libraries once for all of them counts for little, if there are enough for every
# core of the cluster; and so few that a machine that is lost takes little along, and no core waits long for the last.
LEAST, MOST, TASKS = 8, 32, 4
# Variables that say where packages are, here and not on the machine of the cluster.
_OURS = ("ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH", "ROS_DISTRO", "ROS_VERSION")
# Python looks for modules in the folder where `-c` is started: there is nothing but its own.
_PROGRAM = [sys.executable, "-c", "from urdfcheck.dataset.cluster import serve_task; serve_task()"]


def stream_on_cluster(
    units: Sequence[Unit], settings: AuditSettings, backend: str, address: str | None
) -> Generator[tuple[int, UnitReport], None, None]:
    """Audit each unit on the cluster: the places of the units and their reports as they come.

    :raises UrdfcheckError: when joblib or the cluster's library is not installed, or nothing answers at the address.
    """
    if not units:
        return
    try:
        import joblib
    except ImportError:
        raise _make_install_error(backend) from None
    connected = _connect_dask if backend == "dask" else _connect_ray
    with connected(address) as registered, joblib.parallel_config(registered):
        here = {name: os.environ.get(name) for name in (*_OURS, *settings.options.environment)}
        try:
            cores = joblib.effective_n_jobs(-1)
            tasks = (
                joblib.delayed(run_task)(chunk, settings, os.getcwd(), here, __version__)
                for chunk in _split_chunks(list(enumerate(units)), cores)
            )
            if backend == "dask":
                parallel = joblib.Parallel(n_jobs=-1, batch_size=1, return_as="generator_unordered")
                with contextlib.closing(parallel(tasks)) as results:
                    for reports in results:
                        yield from reports
            else:  # Ray's backend gives results only all together
                with joblib.Parallel(n_jobs=-1, batch_size=1) as parallel:
                    while some := list(islice(tasks, cores)):
                        for reports in parallel(some):
                            yield from reports
        except Exception as error:  # whatever the cluster's library has for machines that are gone
            raise UrdfcheckError(f"the cluster failed: {type(error).__name__}: {_get_first_line(error)}") from None


def _split_chunks(units: Sequence[Numbered], cores: int) -> Iterator[Sequence[Numbered]]:
    size = max(min(LEAST, -(-len(units) // cores)), min(MOST, len(units) // (cores * TASKS)))
    return (units[start : start + size] for start in range(0, len(units), size))


@contextlib.contextmanager
def _connect_ray(address: str | None) -> Iterator[Any]:
    """A connection to a Ray cluster, by its name in joblib."""
    try:
        import ray
        from ray.util.joblib import register_ray
    except ImportError:
        raise _make_install_error("ray") from None
    try:
        ray.init(address or "auto", log_to_driver=False, logging_level=logging.ERROR)
    except (ConnectionError, ValueError) as error:
        raise UrdfcheckError(f"no Ray cluster answers at {address or 'auto'}: {_get_first_line(error)}") from None
    try:
        register_ray()
        yield "ray"
    finally:
        ray.shutdown()


@contextlib.contextmanager
def _connect_dask(address: str | None) -> Iterator[Any]:
    """A connection to a Dask cluster, as a backend of joblib."""
    try:
        from distributed import Client
    except ImportError:
        raise _make_install_error("dask") from None
    # That a machine was lost and its work goes to another is the scheduler's affair.
    logging.disable(logging.ERROR)
    try:
        try:
            client = Client(address, set_as_default=False)
        except (OSError, ValueError, TypeError) as error:
            raise UrdfcheckError(f"no Dask scheduler answers at {address}: {_get_first_line(error)}") from None
        with client:
            yield _make_dask_backend(client)
    finally:
        logging.disable(logging.NOTSET)


def _get_first_line(error: Exception) -> str:
    return str(error).strip().partition("\n")[0]


def _make_dask_backend(client: Any) -> Any:
    """joblib's backend for Dask. Its own waits for ever for a task that Dask has given up."""
    from joblib._dask import DaskDistributedBackend

    class Backend(DaskDistributedBackend):  # type: ignore[misc]
        def submit(self, func: Any, callback: Callable[[Any], object]) -> Any:
            future = super().submit(func, callback)
            future.add_done_callback(lambda done: callback(error) if (error := done.exception()) else None)
            return future

        def retrieve_result_callback(self, out: Any) -> Any:
            if isinstance(out, BaseException):
                raise out
            return super().retrieve_result_callback(out)

    return Backend(client=client)


def _make_install_error(backend: str) -> UrdfcheckError:
    extra = "urdfcheck[cluster]" if backend == "dask" else "urdfcheck[cluster] ray"
    return UrdfcheckError(f"--backend {backend} needs more than is installed: pip install {extra}")


# -- on the machine of the cluster -------------------------------------------------------------------------------------


def run_task(
    units: Sequence[Numbered], settings: AuditSettings, folder: str, environment: Mapping[str, str | None], version: str
) -> list[tuple[int, UnitReport]]:
    """What a process of the cluster does with a task: have it done, and say what of it could not be."""
    from urdfcheck.run.jobs import UnitReport

    variables = {**os.environ, **{name: value for name, value in environment.items() if value is not None}}
    for name, value in environment.items():
        if value is None:
            variables.pop(name, None)
    process = subprocess.Popen(
        _PROGRAM,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        cwd=os.path.dirname(os.__file__),
        env=variables,
    )
    said, complaint = process.communicate(pickle.dumps((units, settings, folder, version)))
    done: dict[int, UnitReport] = dict(_iter_reports(said))
    why = complaint.decode("utf-8", "replace").strip().rpartition("\n")[2] or f"exit code {process.returncode}"
    return [
        (number, done.get(number) or UnitReport(failures=(f"{unit.id}: a machine of the cluster failed: {why}",)))
        for number, unit in units
    ]


def _iter_reports(said: bytes) -> Iterator[tuple[int, UnitReport]]:
    """What the program wrote, as far as it came."""
    import io

    stream = io.BytesIO(said)
    while True:
        try:
            yield pickle.load(stream)
        except (EOFError, pickle.UnpicklingError):
            return


def serve_task() -> None:
    """The program: reads a task from standard input, and writes each report to standard output as soon as it is there."""
    units, settings, folder, version = pickle.load(sys.stdin.buffer)
    if version != __version__:
        sys.exit(f"urdfcheck {__version__} is installed there, and {version} here")
    try:
        os.chdir(folder)  # files are called by where they lie from there
    except OSError as error:
        sys.exit(f"{folder}: {error.strerror}")
    from urdfcheck.run.pipeline import stream_reports as reports_of

    if settings.cache is not None:
        try:
            Path(settings.cache).mkdir(parents=True, exist_ok=True)
        except OSError:
            settings = replace(settings, cache=None)
    out = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())  # nobody else writes there
    for place, report in reports_of([unit for _, unit in units], settings, 1):
        pickle.dump((units[place][0], report), out)
        out.flush()  # who has gone is noticed: a broken pipe ends this program
