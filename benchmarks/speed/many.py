"""Many robots in one invocation: a corpus against the script on each robot, and growth with the number of models."""

from __future__ import annotations

import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

from process import CHECK, HERE, SCRIPT, took

CAR_3_FIXED = HERE.parents[1] / "fixtures" / "car-3-fixed" / "urdf" / "car_3.urdf.xacro"


def compare(corpus: Path, every: int, repeats: int) -> None:
    """Print how long the robots of a corpus take, all in one run of urdfcheck and one by one in the script."""
    with tempfile.TemporaryDirectory() as folder:
        writer = [sys.executable, str(HERE / "urdfs.py"), folder, "--corpus", str(corpus), "--every", str(every)]
        subprocess.run(writer, check=True)
        robots = sorted(Path(folder).glob("*.urdf"))
        turns = [took((*SCRIPT, str(robot))) for robot in robots]
        script, failed = sum(t.seconds for t in turns), sum(t.code != 0 for t in turns)
        print(
            f"{len(robots)} robots, script on each: {script:.1f} s, {script / len(robots):.2f} s a robot; on {failed} of them "
            "a part of it fails (a mesh that is missing or broken)"
        )
        for jobs in (1, 2):
            cold, warm = [], []
            for _ in range(repeats):
                with tempfile.TemporaryDirectory() as cache:
                    cold.append(
                        took((*CHECK, folder, "--jobs", str(jobs), "--allow-read", str(corpus)), cache=cache).seconds
                    )
                    warm.append(
                        took((*CHECK, folder, "--jobs", str(jobs), "--allow-read", str(corpus)), cache=cache).seconds
                    )
            for name, times, target in (("cold", cold, 10), ("warm", warm, 30)):
                seconds = statistics.median(times)
                ratio = script / seconds
                missed = "" if ratio >= target else "  MISSED"
                print(
                    f"  {name}, jobs {jobs}: {seconds:6.2f} s  {ratio:6.1f}× faster  target >= {target}{missed}",
                    flush=True,
                )


def grow(counts: tuple[int, ...], repeats: int) -> None:
    """Print time and memory for folders of so many models: copies of one robot under names of their own."""
    print(
        f"{'models':>8} {'seconds':>9} {'ms for each more':>17} {'unchanged, ms for each':>23} {'largest process':>16}"
    )
    last, before = 0, 0.0
    for count in counts:
        with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryDirectory() as cache:
            subprocess.run([sys.executable, str(HERE / "urdfs.py"), folder, f"0={CAR_3_FIXED}"], check=True)
            text = Path(folder, "0.urdf").read_text(encoding="utf-8")
            for index in range(count):
                copy = text.replace('name="car_3"', f'name="car_{index}"', 1)
                Path(folder, f"{index}.urdf").write_text(copy, encoding="utf-8")
            cold = took((*CHECK, folder), cache=cache)
            same = [took((*CHECK, folder), cache=cache) for _ in range(repeats)]
        seconds, peak = cold.seconds, max(t.peak for t in (cold, *same))
        each = (seconds - before) / (count - last) * 1e3
        unchanged = statistics.median(t.seconds for t in same) / count * 1e3
        shown = f"{each if last else float('nan'):14.1f} ms {unchanged:20.1f} ms"
        print(f"{count:8} {seconds:9.2f} {shown} {peak:12.0f} MiB", flush=True)
        last, before = count, seconds
    print(
        "targets: each more model takes as long on every line (linear), 1 ms unchanged, and the memory stays (flat)",
        flush=True,
    )
