"""A long run: inputs by the thousand in forked processes, which may crash, hang or eat all memory.

An input is known by its format, the seed and its number: the same three give the same input again.
"""

from __future__ import annotations

import argparse
import contextlib
import faulthandler
import gc
import importlib
import json
import multiprocessing
import os
import pkgutil
import re
import shutil
import signal
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from multiprocessing.connection import Connection, wait
from pathlib import Path
from random import Random

from fuzz import cases
from fuzz.oracle import SECONDS, Verdict, judge

# A process takes so many inputs, then a new one goes on: nothing that leaks grows for ever.
_LIFE = 2_000
# Address space of a process, above what the libraries take; and how long nothing may be heard of it.
_SPACE, _SILENCE = 6 * 1024**3, 3 * SECONDS + 20
# One input in so many is rendered in all formats and checked twice.
_EVERYTHING = 20
_KEPT = 3
_TOLD = 2_000


@dataclass(slots=True)
class Tally:
    """What came out: how often each outcome of each format, and the failures by their key."""

    counts: Counter[tuple[str, str]] = field(default_factory=Counter)
    keys: Counter[str] = field(default_factory=Counter)

    def add(self, name: str, verdict: Verdict) -> bool:
        """Count a verdict; whether its input should be kept."""
        self.counts[name, verdict.outcome] += 1
        if not verdict.failed:
            return False
        key = f"{name}: {verdict.outcome}: {verdict.key}"
        self.keys[key] += 1
        return self.keys[key] <= _KEPT


def random_of(name: str, seed: int, index: int) -> Random:
    """The chance that makes one input."""
    return Random(f"{name} {seed} {index}")


def main(words: Sequence[str] | None = None) -> int:
    """``python -m tests.fuzz``"""
    p = argparse.ArgumentParser(prog="python -m tests.fuzz", description="Check many inputs that are wrong on purpose.")
    p.add_argument("--count", type=int, default=1_000, help="how many inputs, over all formats (default: 1000)")
    p.add_argument("--seed", type=int, default=0, help="other numbers make other inputs (default: 0)")
    p.add_argument("--first", type=int, default=0, help="go on with the input of this number")
    p.add_argument("--jobs", type=int, default=1, help="processes at the same time (default: 1)")
    p.add_argument("--format", default=",".join(cases.MAKERS), help="some of the formats, with commas between them")
    p.add_argument(
        "--out", type=Path, default=Path(tempfile.gettempdir()) / "urdfcheck-fuzz", help="where failing inputs go"
    )
    p.add_argument("--one", metavar="FORMAT:SEED:NUMBER", help="one input again, with all that is known of it")
    options = p.parse_args(words)
    if options.one:
        name, seed, index = options.one.split(":")
        return _one(name, int(seed), int(index), options.out)
    names = options.format.split(",")
    began = time.perf_counter()
    tally = Tally()
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # what was done until then is told
    share = [(options.first + i, names[(options.first + i) % len(names)]) for i in range(options.count)]
    with contextlib.suppress(KeyboardInterrupt):
        for index, name, verdict in _verdicts(share, options.seed, options.jobs):
            if tally.add(name, verdict):
                _keep(options.out, name, options.seed, index, verdict)
            done = sum(tally.counts.values())
            if done % _TOLD == 0:
                print(f"{done:,} inputs, {sum(tally.keys.values()):,} failed", file=sys.stderr, flush=True)
    seconds = time.perf_counter() - began
    print(_table(tally, names, options.seed, seconds))
    return 1 if tally.keys else 0


def _one(name: str, seed: int, index: int, out: Path) -> int:
    case = cases.make(name, random_of(name, seed, index))
    folder = out / f"{name}-{seed}-{index}"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    verdict = judge(case, folder, everything=True)
    print(f"{folder}: {case.entry}, tier {case.tier}\n{verdict.outcome}: {verdict.detail}")
    return int(verdict.failed)


def _keep(out: Path, name: str, seed: int, index: int, verdict: Verdict) -> None:
    """Write a failing input and what is known of it."""
    slug = re.sub(r"\W+", "-", verdict.key)[:60].strip("-")
    folder = out / f"{name}-{verdict.outcome}-{slug}" / f"{seed}-{index}"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    case = cases.make(name, random_of(name, seed, index))
    case.write(folder)
    known = {
        "again": f"--one {name}:{seed}:{index}",
        "tier": case.tier,
        "entry": case.entry,
        "outcome": verdict.outcome,
    }
    (folder / "verdict.json").write_text(json.dumps({**known, "key": verdict.key, "detail": verdict.detail}, indent=1))


def _table(tally: Tally, names: Sequence[str], seed: int, seconds: float) -> str:
    total = sum(tally.counts.values())
    outcomes = list(dict.fromkeys(outcome for _, outcome in sorted(tally.counts)))
    rows = [f"{'format':12}{'inputs':>9}" + "".join(f"{outcome:>11}" for outcome in outcomes)]
    for name in (*names, "all"):
        counts = [
            sum(n for (f, o), n in tally.counts.items() if o == outcome and name in (f, "all")) for outcome in outcomes
        ]
        rows.append(f"{name:12}{sum(counts):>9,}" + "".join(f"{n:>11,}" for n in counts))
    rows.append(f"seed {seed}: {total:,} inputs in {seconds:,.0f} s, {total / max(seconds, 1e-9):.1f} each second")
    rows += [f"{n:>7,}  {key}" for key, n in tally.keys.most_common()]
    return "\n".join(rows)


# -- processes -------------------------------------------------------------------------------------------------------


@dataclass(slots=True, eq=False)
class _Worker:
    """A process, the inputs that it still has to check, and when something was heard of it."""

    process: multiprocessing.process.BaseProcess
    pipe: Connection
    share: list[tuple[int, str]]
    heard: float


def _verdicts(share: Sequence[tuple[int, str]], seed: int, jobs: int) -> Iterator[tuple[int, str, Verdict]]:
    """The verdict on each input; of one that ended or blocked its process as well."""
    _load()
    shares = [list(share[job::jobs]) for job in range(jobs)]
    workers = [_start(left, seed) for left in shares if left]
    try:
        while workers:
            wait([w.pipe for w in workers], timeout=1.0)
            for worker in list(workers):
                try:
                    while worker.pipe.poll():
                        verdict = worker.pipe.recv()
                        worker.heard = time.monotonic()
                        yield (*worker.share.pop(0), verdict)
                    if time.monotonic() - worker.heard < _SILENCE:
                        continue
                    stack = _stack(worker)
                    verdict = Verdict("time", f"nothing was heard for {_SILENCE:.0f} s: {stack}", stack[-60:])
                except (EOFError, ConnectionResetError):
                    worker.process.join()
                    code = worker.process.exitcode
                    verdict = None if code == 0 else Verdict("died", f"exit code {code}", f"exit code {code}")
                _end(worker)
                workers.remove(worker)
                if verdict is not None and worker.share:
                    yield (*worker.share.pop(0), verdict)
                if worker.share:
                    workers.append(_start(worker.share, seed))
    finally:
        for worker in workers:
            _end(worker)


def _load() -> None:
    """Load all that a check may need: a forked process has it then, and others may edit it."""
    for package in (
        "urdfcheck",
        "urdfcheck.checks",
        "urdfcheck.facts",
        "urdfcheck.model",
        "urdfcheck.output",
        "urdfcheck.source",
    ):
        paths = importlib.import_module(package).__path__
        for module in pkgutil.iter_modules(paths, f"{package}."):
            if not module.name.endswith("__main__"):
                importlib.import_module(module.name)
    for name in ("trimesh", "collada", "pinocchio", "coal", "xacro", "yaml", "scipy.spatial", "scipy.sparse.csgraph"):
        importlib.import_module(name)
    # What loads more the first time that it is used.
    with tempfile.TemporaryDirectory() as folder:
        for name in cases.MAKERS:
            case = cases.make(name, random_of(name, 0, 0))
            judge(case, Path(folder) / name, everything=True)


def _start(share: list[tuple[int, str]], seed: int) -> _Worker:
    context = multiprocessing.get_context("fork")
    ours, its = context.Pipe(duplex=False)
    process = context.Process(target=_serve, args=(its, ours, share[:_LIFE], seed), daemon=True)
    process.start()
    its.close()
    return _Worker(process, ours, share, time.monotonic())


def _end(worker: _Worker) -> None:
    worker.process.kill()
    worker.process.join()
    worker.pipe.close()
    shutil.rmtree(_scratch(worker.process.pid), ignore_errors=True)


def _stack(worker: _Worker) -> str:
    """Where a process that says nothing is."""
    os.kill(worker.process.pid or 0, signal.SIGUSR1)
    time.sleep(1.0)
    try:
        return (_scratch(worker.process.pid) / "stack").read_text()[:2_000]
    except OSError:
        return ""


def _scratch(process: int | None) -> Path:
    """Where a process writes its inputs: into memory where there is such a folder."""
    shared = Path("/dev/shm")
    return (shared if shared.is_dir() else Path(tempfile.gettempdir())) / f"urdfcheck-fuzz-{process}"


def _serve(pipe: Connection, other: Connection, share: list[tuple[int, str]], seed: int) -> None:
    import resource

    other.close()
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_AS, (_SPACE, resource.RLIM_INFINITY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    os.environ["URDFCHECK_CACHE_DIR"] = os.devnull
    for variable in ("ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH"):
        os.environ.pop(variable, None)
    null = os.open(os.devnull, os.O_RDWR)
    os.dup2(null, 0)
    scratch = _scratch(os.getpid())
    (scratch / "tmp").mkdir(parents=True)
    tempfile.tempdir = str(scratch / "tmp")
    faulthandler.register(signal.SIGUSR1, (scratch / "stack").open("w"), all_threads=False)
    gc.freeze()
    for index, name in share:
        folder = scratch / str(index)
        folder.mkdir(parents=True)
        rng = random_of(name, seed, index)
        case = cases.make(name, rng)
        pipe.send(judge(case, folder, everything=rng.randrange(_EVERYTHING) == 0))
        shutil.rmtree(folder, ignore_errors=True)
    shutil.rmtree(scratch, ignore_errors=True)
