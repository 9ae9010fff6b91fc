"""The same bytes from a cluster as from this machine, also when it loses a machine."""

from __future__ import annotations

import gc
import os
import pickle
import signal
import subprocess
import sys
import threading
import time
import weakref
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

import pytest
from dataset.test_dataset_audit import INERTIA

from urdfcheck.cli import FAILED, OK, main
from urdfcheck.dataset import cluster
from urdfcheck.policy.policy import Policy
from urdfcheck.run.jobs import AuditSettings, Unit, UnitReport

pytestmark = [
    pytest.mark.slow,
    pytest.mark.long,
    # Looked for and not imported: that takes a second, for the quick tests as well.
    *(
        pytest.mark.skipif(find_spec(name) is None, reason=f"{name} is not installed")
        for name in ("distributed", "joblib")
    ),
    pytest.mark.skipif(sys.platform == "win32", reason="the workers are watched by signals"),
]

CLUSTER = """
import sys
from distributed import LocalCluster

if __name__ == "__main__":
    with LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, silence_logs=50) as made:
        print(made.scheduler_address, *(nanny.pid for nanny in made.workers.values()), flush=True)
        sys.stdin.read()
"""


@dataclass
class Cluster:
    """A Dask cluster of two processes on this machine."""

    address: str
    pids: list[int]


@pytest.fixture(autouse=True, scope="module")
def _dask() -> None:
    """Its settings are read when it is imported: not while a test has others."""
    import distributed  # noqa: F401


@pytest.fixture(scope="module")
def two(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Cluster]:
    folder = tmp_path_factory.mktemp("cluster")
    script = folder / "cluster.py"
    script.write_text(CLUSTER)
    process = subprocess.Popen(
        [sys.executable, str(script)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
        cwd=folder,  # not where the command runs
        # Its processes are forked from one that has Dask, instead of each loading it.
        env={**os.environ, "DASK_DISTRIBUTED__WORKER__MULTIPROCESSING_METHOD": "forkserver"},
    )
    assert process.stdout is not None
    address, *pids = process.stdout.readline().split()
    yield Cluster(address, [int(pid) for pid in pids])
    process.communicate(input="")


@pytest.fixture
def models(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "0")
    monkeypatch.chdir(tmp_path)
    folder = tmp_path / "models"
    folder.mkdir()
    for i in range(12):
        inertia = INERTIA.format(9 if i % 3 == 0 else 1)
        (folder / f"{i:03}.urdf").write_text(f'<robot name="r{i}"><link name="base">{inertia}</link></robot>')
    (folder / "broken.urdf").write_text("<robot><link")
    return folder


def audited(*options: str) -> tuple[int, bytes, bytes]:
    """Exit code, lines and page of an audit of the models."""
    folder = Path(f"out{len(list(Path().glob('out*')))}")
    command = ["audit", "models", "-o", str(folder), "--no-cache", "--tier", "source", "--fail-on", "never", *options]
    return main(command), (folder / "audit.jsonl").read_bytes(), (folder / "index.html").read_bytes()


def test_a_cluster_gives_the_same_bytes(models: Path, two: Cluster) -> None:
    here = audited()
    assert here[0] == OK
    assert audited("--backend", f"dask={two.address}") == here


def test_a_lost_machine_loses_nothing(models: Path, two: Cluster, monkeypatch: pytest.MonkeyPatch) -> None:
    here = audited()
    monkeypatch.setattr(cluster, "LEAST", 3)

    def kill() -> None:
        journal = Path("out1", "journal")
        while not (journal.exists() and b'{"key"' in journal.read_bytes()):
            time.sleep(0.01)
        os.kill(two.pids[0], signal.SIGKILL)

    killer = threading.Thread(target=kill)
    killer.start()
    assert audited("--backend", f"dask={two.address}") == here
    killer.join()


def test_the_limits_hold_on_the_cluster(models: Path, two: Cluster) -> None:
    """Each model is stopped there by its own limit, and no process of the cluster with it."""
    for path in models.iterdir():
        path.unlink()
    # Macros that call each other ten times, ten deep.
    levels = "".join(f"<xacro:macro name='m{n}'>{f'<xacro:m{n - 1}/>' * 10}</xacro:macro>" for n in range(1, 10))
    first = "<xacro:macro name='m0'><link name='a'/></xacro:macro>"
    bomb = f"<robot name='r' xmlns:xacro='http://www.ros.org/wiki/xacro'>{first}{levels}<xacro:m9/></robot>"
    (models / "bomb.urdf.xacro").write_text(bomb)
    code, found, _ = audited("--backend", f"dask={two.address}", "--timeout", "0.5")
    assert code == OK
    assert b"URC906" in found.splitlines()[0]


def unknown_there() -> None:
    """The cluster cannot import this module."""


def test_a_task_that_dask_gives_up_is_an_error_and_no_endless_wait(two: Cluster) -> None:
    import joblib

    with cluster._connect_dask(two.address) as backend, joblib.parallel_config(backend):
        results = joblib.Parallel(n_jobs=-1, batch_size=1, return_as="generator_unordered")
        with pytest.raises(RuntimeError, match="deserialization"):
            list(results(joblib.delayed(unknown_there)() for _ in range(2)))


def test_a_result_that_was_taken_is_let_go(two: Cluster) -> None:
    """Not when Python next looks for cycles: reports of many models would wait for that."""
    import joblib

    taken = []
    gc.disable()
    try:
        with cluster._connect_dask(two.address) as backend, joblib.parallel_config(backend):
            results = joblib.Parallel(n_jobs=-1, batch_size=1, return_as="generator_unordered")
            # Lists, which are what a task returns, have no weak references.
            for result in results(joblib.delayed(set)([number]) for number in range(20)):
                taken.append(weakref.ref(result))
            del result
            assert sum(known() is not None for known in taken) <= 2  # what the threads hold that wait for the next
    finally:
        gc.enable()
    assert len(taken) == 20


def test_a_scheduler_that_does_not_answer_is_said(
    models: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    import dask

    with dask.config.set({"distributed.comm.timeouts.connect": "0.3s"}):
        assert main(["audit", "models", "-o", "out", "--backend", "dask=tcp://127.0.0.1:9"]) == FAILED
    assert "no Dask scheduler answers at tcp://127.0.0.1:9" in capsys.readouterr().err


def test_without_the_libraries_it_is_said_what_to_install(
    models: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("distributed", "ray"):
        monkeypatch.setitem(sys.modules, name, None)
    assert main(["audit", "models", "-o", "out", "--backend", "dask=x"]) == FAILED
    assert "pip install urdfcheck[cluster]" in capsys.readouterr().err
    assert main(["audit", "models", "-o", "out", "--backend", "ray"]) == FAILED
    assert "pip install urdfcheck[cluster] ray" in capsys.readouterr().err


def test_another_version_there_is_a_failure_of_each_model_and_no_verdict(models: Path) -> None:
    unit = Unit(kind="model", path=str(models / "000.urdf"), id="000.urdf")
    settings = AuditSettings(policy=Policy(codes=frozenset({"INR003"}), tier="source"))
    ((number, report),) = cluster.run_task([(7, unit)], settings, str(models), {}, "0.0.0")
    assert number == 7
    assert "0.0.0 here" in report.failures[0]


class Forged:
    """What a worker that was taken over would like the process of the cluster to unpickle."""

    def __init__(self, marker: Path) -> None:
        self.marker = marker

    def __reduce__(self) -> tuple[object, tuple[object, ...]]:
        return Path.touch, (self.marker,)


def test_what_a_program_writes_is_read_as_plain_data(tmp_path: Path) -> None:
    sound = UnitReport(failures=("a failure",))
    marker = tmp_path / "marker"
    output = pickle.dumps((3, sound)) + pickle.dumps((4, Forged(marker))) + pickle.dumps((5, sound))
    assert list(cluster._iter_reports(output)) == [(3, sound)]
    assert not marker.exists()
