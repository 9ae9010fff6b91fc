"""Distribute an audit to the machines of an existing cluster (Dask or Ray) through joblib.

A process of the cluster is long-lived, has threads and must not have children of multiprocessing, so it is not confined and
reads no untrusted file. It starts a program that does what the command does locally: run confined and supervised processes.
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

from urdfcheck.core.errors import UrdfcheckError
from urdfcheck.system.installation import name_distribution
from urdfcheck.version import __version__

if TYPE_CHECKING:
    from urdfcheck.run.jobs import AuditSettings, Unit, UnitReport

    Numbered = tuple[int, Unit]

BACKENDS = ("dask", "ray")
# Least and most models of a task, and tasks per core: enough models that loading the libraries costs little, and few enough
# that a lost machine loses little work and no core waits long for the last task.
LEAST, MOST, TASKS = 8, 128, 4
# Environment variables that say where packages are; those of this machine count, not those of the cluster.
_OURS = ("ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH", "ROS_DISTRO", "ROS_VERSION")
# With `-c`, Python imports from its working directory: it is started in a folder with nothing but its own modules.
_PROGRAM = [sys.executable, "-c", "from urdfcheck.dataset.cluster import serve_task; serve_task()"]


def stream_on_cluster(
    units: Sequence[Unit], settings: AuditSettings, *, backend: str, address: str | None
) -> Generator[tuple[int, UnitReport], None, None]:
    """Audit each unit on the cluster; yields the index of each unit and its report as they finish.

    :raises UrdfcheckError: if joblib or the cluster's library is not installed, or nothing answers at the address.
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
            else:  # Ray's backend returns all results of a call together
                with joblib.Parallel(n_jobs=-1, batch_size=1) as parallel:
                    while some := list(islice(tasks, cores)):
                        for reports in parallel(some):
                            yield from reports
        except Exception as error:  # the cluster's library has exceptions of its own for lost machines
            raise UrdfcheckError(f"the cluster failed: {type(error).__name__}: {_get_first_line(error)}") from None


def _split_chunks(units: Sequence[Numbered], cores: int) -> Iterator[Sequence[Numbered]]:
    size = max(min(LEAST, -(-len(units) // cores)), min(MOST, len(units) // (cores * TASKS)))
    return (units[start : start + size] for start in range(0, len(units), size))


@contextlib.contextmanager
def _connect_ray(address: str | None) -> Iterator[Any]:
    """Connect to a Ray cluster; yields its name in joblib."""
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
    """Connect to a Dask cluster; yields a backend of joblib."""
    try:
        from distributed import Client
    except ImportError:
        raise _make_install_error("dask") from None
    # The scheduler logs lost machines and moves their work: that needs no message.
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
    """Make a joblib backend for Dask. joblib's own waits forever for a task that Dask has given up."""
    from joblib._dask import DaskDistributedBackend

    class Backend(DaskDistributedBackend):  # type: ignore[misc]
        def submit(self, func: Any, callback: Callable[[Any], object]) -> Any:
            future = super().submit(func, callback)
            # joblib gives the future its own method `get`, which it calls for other backends: with this cycle every report would
            # stay until Python collects garbage of that age, which may be never.
            vars(future).pop("get", None)
            future.add_done_callback(lambda done: callback(error) if (error := done.exception()) else None)
            return future

        def retrieve_result_callback(self, out: Any) -> Any:
            if isinstance(out, BaseException):
                raise out
            return super().retrieve_result_callback(out)

    return Backend(client=client)


def _make_install_error(backend: str) -> UrdfcheckError:
    extra = f"{name_distribution()}[cluster]" + ("" if backend == "dask" else " ray")
    return UrdfcheckError(f"--backend {backend} needs more than is installed: pip install {extra}")


# -- on the machine of the cluster -------------------------------------------------------------------------------------


def run_task(
    units: Sequence[Numbered], settings: AuditSettings, folder: str, environment: Mapping[str, str | None], version: str
) -> list[tuple[int, UnitReport]]:
    """Run a task in a process of the cluster, through a program; report the units that it did not finish."""
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
    output, errors = process.communicate(pickle.dumps((units, settings, folder, version)))
    done: dict[int, UnitReport] = dict(_iter_reports(output))
    reason = errors.decode("utf-8", "replace").strip().rpartition("\n")[2] or f"exit code {process.returncode}"
    return [
        (number, done.get(number) or UnitReport(failures=(f"{unit.id}: a machine of the cluster failed: {reason}",)))
        for number, unit in units
    ]


def _iter_reports(output: bytes) -> Iterator[tuple[int, UnitReport]]:
    """Yield the reports that the program wrote before it ended, or before anything else: this process is not confined."""
    import io

    from urdfcheck.system.plain_pickle import load_plain

    stream = io.BytesIO(output)
    while True:
        try:
            number, report = load_plain(stream)
        except Exception:  # the end; a malformed pickle may raise anything
            return
        yield number, report


def serve_task() -> None:
    """Read a task from standard input and write each report to standard output as soon as it is finished."""
    units, settings, folder, version = pickle.load(sys.stdin.buffer)
    if version != __version__:
        sys.exit(f"urdfcheck {__version__} is installed there, and {version} here")
    try:
        os.chdir(folder)  # paths in reports are relative to it
    except OSError as error:
        sys.exit(f"{folder}: {error.strerror}")
    from urdfcheck.run.pipeline import stream_reports as reports_of

    if settings.cache is not None:
        try:
            Path(settings.cache).mkdir(parents=True, exist_ok=True)
        except OSError:
            settings = replace(settings, cache=None)
    out = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())  # nothing else may write there, and no worker
    if hasattr(os, "register_at_fork"):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.register_at_fork(after_in_child=lambda: os.dup2(nowhere, out.fileno()))
    for place, report in reports_of([unit for _, unit in units], settings, jobs=1):
        pickle.dump((units[place][0], report), out)
        out.flush()  # a broken pipe ends this program
