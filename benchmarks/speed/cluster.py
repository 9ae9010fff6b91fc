"""An audit of many variants on a local Dask cluster of two processes, one of which is killed: ``cluster.py 1000 [--folder DIR]``.

Each file is a car with an argument of ten values. The command runs twice, on this machine and on the cluster; both must write the
same bytes. Printed are seconds, bytes and memory per model (a variant of a file). 40 files take three minutes on two busy cores.
"""

from __future__ import annotations

import argparse
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from process import HERE

if TYPE_CHECKING:
    from collections.abc import Iterator

ROBOT = HERE.parents[1] / "fixtures" / "car-3-fixed"
VARIANTS = 10
_MASS = '<xacro:property name="base_mass" value="${0.117 + 0.094 + 0.040 + 0.050}"/>'
_LAST_INCLUDE = '<xacro:include filename="$(find car_3_description)/urdf/wheel.xacro"/>'
_CLUSTER = """
import sys
from distributed import LocalCluster

if __name__ == "__main__":
    with LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, silence_logs=50) as made:
        print(made.scheduler_address, *(nanny.pid for nanny in made.workers.values()), flush=True)
        sys.stdin.read()
"""


def write_dataset(folder: Path, files: int) -> None:
    """Write one package with so many xacro files, each of which has ten variants: loads of 0 to 9 times 10 g."""
    shutil.copytree(ROBOT, folder, ignore=shutil.ignore_patterns("launch"))
    plain = folder / "urdf" / "car_3.urdf.xacro"
    text = plain.read_text(encoding="utf-8")
    plain.unlink()
    choices = ", ".join(f"'{value}'" for value in range(VARIANTS))
    load = (
        '<xacro:arg name="load" default="0"/><xacro:property name="load" value="$(arg load)"/>'
        f'<xacro:unless value="${{\'$(arg load)\' in [{choices}]}}"><link name="no_such_load"/></xacro:unless>'
    )
    text = text.replace(_LAST_INCLUDE, f"{_LAST_INCLUDE}\n  {load}")
    text = text.replace(_MASS, _MASS.replace("0.050}", "0.050 + 0.01 * load}"))
    for number in range(files):
        copy = text.replace('name="car_3"', f'name="car_{number}"', 1)
        plain.with_name(f"car_{number:05}.urdf.xacro").write_text(copy, encoding="utf-8")


@contextmanager
def start_cluster(folder: Path) -> Iterator[tuple[str, list[int], int]]:
    """Yield the address of a cluster, the processes that do its work, and the one that started them."""
    process = subprocess.Popen(
        [sys.executable, "-c", _CLUSTER],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
        cwd=folder,
        env={**os.environ, "DASK_DISTRIBUTED__WORKER__MULTIPROCESSING_METHOD": "forkserver"},
    )
    assert process.stdout is not None
    address, *pids = process.stdout.readline().split()
    yield address, [int(pid) for pid in pids], process.pid
    process.communicate(input="")


class Watch(threading.Thread):
    """Looks twice a second at the memory and the processor time of processes and all below them (Linux)."""

    def __init__(self, *roots: int) -> None:
        super().__init__(daemon=True)
        self.roots, self.ended = roots, threading.Event()
        self.peaks: dict[int, float] = dict.fromkeys(roots, 0.0)
        """MiB of each process and all below it together, shared pages divided among those that share them."""
        self.seconds: dict[int, float] = dict.fromkeys(roots, 0.0)
        """Of the processor, those of processes that were waited for included; what a killed one took may be missing."""
        self.before: dict[int, float] = {}
        self.alone: float = 0.0
        """MiB of the first process now, without those below it."""

    def run(self) -> None:
        while not self.ended.wait(0.5):
            children: dict[int, list[int]] = {}
            for entry in Path("/proc").glob("[0-9]*/stat"):
                try:
                    parent = int(entry.read_text().rpartition(")")[2].split()[1])
                except OSError:  # it has ended
                    continue
                children.setdefault(parent, []).append(int(entry.parent.name))
            self.alone = _sum_memory(self.roots[0], {})
            for root in self.roots:
                self.peaks[root] = max(self.peaks[root], _sum_memory(root, children))
                seconds = _sum_seconds(root, children)
                self.seconds[root] = max(self.seconds[root], seconds - self.before.setdefault(root, seconds))


def _sum_seconds(process: int, children: dict[int, list[int]]) -> float:
    total = sum(_sum_seconds(child, children) for child in children.get(process, ()))
    try:
        fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
        return total + sum(map(int, fields[11:15])) / os.sysconf("SC_CLK_TCK")
    except OSError:
        return total


def _sum_memory(process: int, children: dict[int, list[int]]) -> float:
    total = sum(_sum_memory(child, children) for child in children.get(process, ()))
    try:
        lines = Path(f"/proc/{process}/smaps_rollup").read_text().splitlines()
        return total + next(int(line.split()[1]) for line in lines if line.startswith("Pss:")) / 1024
    except (OSError, StopIteration):
        return total


class Finished:
    """Counts the models that a journal holds, each byte of it read once."""

    def __init__(self, journal: Path) -> None:
        self.journal, self.count, self._read = journal, 0, 0

    def update(self) -> int:
        if self.journal.exists():
            with self.journal.open("rb") as file:
                file.seek(self._read)
                whole = file.read().rpartition(b"\n")[0]
            self._read += len(whole)
            self.count += whole.count(b'{"key"')
        return self.count


def audit(
    dataset: Path,
    out: Path,
    *options: str,
    models: int,
    cluster: int | None = None,
    victim: int | None = None,
) -> float:
    """Audit all variants and print what it took, and the memory of the command after each sixth of the ``models``; ``victim``: a
    process to kill after a third of them."""
    words = [
        sys.executable,
        "-m",
        "urdfcheck",
        "audit",
        str(dataset),
        "-o",
        str(out),
        "--all-args",
        "--fail-on",
        "never",
    ]
    environment = {**os.environ, "SOURCE_DATE_EPOCH": "0", "URDFCHECK_CACHE_DIR": str(out.with_suffix(".cache"))}
    began = time.perf_counter()
    process = subprocess.Popen(
        [*words, *options], env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    watch = Watch(process.pid, *([] if cluster is None else [cluster]))
    watch.start()
    finished, told = Finished(out / "journal"), 0
    known = finished.update()
    while process.poll() is None:
        time.sleep(0.5)
        done = finished.update() - known
        if done * 6 // models > told:
            told = done * 6 // models
            print(f"  {done:,} models: {watch.alone:.1f} MiB (the command without workers)", flush=True)
        if victim is not None and done >= models // 3:
            os.kill(victim, signal.SIGKILL)
            print(f"  killed a process of the cluster after {time.perf_counter() - began:.1f} s", flush=True)
            victim = None
    seconds = time.perf_counter() - began
    watch.ended.set()
    if process.returncode:
        raise SystemExit(f"{' '.join([*words, *options])} ended with {process.returncode}")
    peaks = ", ".join(f"{peak:.0f} MiB" for peak in watch.peaks.values())
    processor = " + ".join(f"{spent:.1f}" for spent in watch.seconds.values())
    who = "the command and the cluster" if cluster else "the command"
    print(f"  {seconds:.1f} s, {processor} of the processor; at most {peaks} ({who}, workers included)", flush=True)
    return seconds


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("files", type=int, help=f"number of files, of {VARIANTS} variants each")
    parser.add_argument("--folder", type=Path, help="where the files and results go (default: a temporary folder)")
    parser.add_argument("--no-local", action="store_true", help="leave out the run on this machine, and the comparison")
    parser.add_argument("--tier", default="full", help="how much the audits compute")
    parser.add_argument("--no-cluster", action="store_true", help="only the run on this machine")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(dir=options.folder) as named:
        measure(
            Path(named),
            options.files,
            "--tier",
            options.tier,
            local=not options.no_local,
            cluster=not options.no_cluster,
        )


def measure(folder: Path, files: int, *words: str, local: bool, cluster: bool) -> None:
    """Print the runs, and the bytes and seconds of each model.

    ``words``: options of the audits.
    """
    dataset, models = folder / "dataset", files * VARIANTS
    write_dataset(dataset, files)
    outs = []
    if local:
        print(f"{files:,} files, {models:,} models on this machine, two jobs", flush=True)
        outs.append(folder / "here")
        _print_share(audit(dataset, outs[-1], "--jobs", "2", *words, models=models), models, outs[-1])
    if not cluster:
        return
    print(f"{files:,} files, {models:,} models on a cluster of two processes, one of them killed", flush=True)
    with start_cluster(folder) as (address, pids, process):
        outs.append(folder / "cluster")
        backend = ("--backend", f"dask={address}", *words)
        seconds = audit(dataset, outs[-1], *backend, models=models, cluster=process, victim=pids[0])
        _print_share(seconds, models, outs[-1])
        print("the same again, nothing changed", flush=True)
        _print_share(audit(dataset, outs[-1], *backend, models=models, cluster=process), models, outs[-1])
    texts = {(out / name).read_bytes() for out in outs for name in ("audit.jsonl",)}
    if len(texts) != 1:
        raise SystemExit("the cluster and this machine wrote different results")


def _print_share(seconds: float, models: int, out: Path) -> None:
    sizes = {path.name: path.stat().st_size for path in sorted(out.iterdir())}
    cache = out.with_suffix(".cache")
    kept = [path.stat().st_size for path in cache.rglob("*") if path.is_file()] if cache.is_dir() else []
    sizes |= {f"cache ({len(kept):,} files)": sum(kept)}
    shares = ", ".join(f"{name} {size / models:,.0f}" for name, size in sizes.items())
    print(f"  {seconds / models * 1e3:.2f} ms a model; bytes a model: {shares}", flush=True)


if __name__ == "__main__":
    main()
