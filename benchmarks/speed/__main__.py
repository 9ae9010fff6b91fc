"""How fast urdfcheck is, as ratios in one run: ``python benchmarks/speed [--quick] [--only PARTS]``.

(a) mesh facts against trimesh, (b) one robot as a whole process against the script that a careful user writes, (c) a corpus
in one run against that script, and growth with the number of models. A corpus is used where ``URDFCHECK_CORPUS`` names one.
"""

from __future__ import annotations

import argparse
import compileall
import os
import platform
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

import large_meshes
import many
import mesh_memory
import robots
import versions
from process import HERE

import urdfcheck

PARTS = ("meshes", "memory", "large", "robots", "versions", "corpus", "growth")


def machine() -> str:
    """The processor, the cores that this process may use, the system and the versions."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
        processor = next(line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        processor = platform.processor() or platform.machine()
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    libraries = ", ".join(f"{name} {version(name)}" for name in ("numpy", "trimesh", "pin", "yourdfpy"))
    python = f"Python {platform.python_version()}"
    return f"{processor}, {cores} cores, {platform.system()} {platform.machine()}, {python}, {libraries}"


def main() -> None:
    parser = argparse.ArgumentParser(prog="python benchmarks/speed", description="How fast urdfcheck is, as ratios.")
    parser.add_argument("--quick", action="store_true", help="fewer turns, every eighth robot, no large mesh")
    parser.add_argument("--only", default=",".join(PARTS), help=f"some of {','.join(PARTS)}")
    options = parser.parse_args()
    parts = options.only.split(",")
    if unknown := set(parts) - set(PARTS):
        parser.error(f"--only: no part {', '.join(sorted(unknown))}")
    named = os.environ.get("URDFCHECK_CORPUS")
    corpus = Path(named).absolute() if named else None
    # As pip leaves an installed package; an environment may forbid Python to write bytecode by itself.
    compileall.compile_dir(Path(urdfcheck.__file__).parent, quiet=1)
    print(f"urdfcheck {urdfcheck.__version__} on {machine()}", flush=True)
    if "meshes" in parts:
        _title("(a) mesh facts against trimesh.load + is_watertight + is_winding_consistent + mass_properties")
        subprocess.run([sys.executable, str(HERE / "meshes.py"), *(["--quick"] if options.quick else [])], check=True)
    if "memory" in parts:
        _title("(a) memory that a mesh file takes, over its size")
        mesh_memory.compare(("stl", "ply") if options.quick else mesh_memory.KINDS)
    if "large" in parts:
        _title("(a) one link with a large mesh, whole processes, cold: processor time")
        names = (large_meshes.SMALLEST,) if options.quick else large_meshes.CASES
        large_meshes.compare(names, repeats=3 if options.quick else 7)
    if "robots" in parts:
        _title("(b) one robot, whole processes")
        robots.compare(corpus, repeats=3 if options.quick else 11)
    if "versions" in parts:
        _title("(b) two versions of one robot, whole processes")
        versions.compare(corpus, repeats=5)
    if "corpus" in parts:
        _title("(c) a corpus in one run, expanded URDF for both sides")
        if corpus is None:
            print("left out: URDFCHECK_CORPUS names no folder")
        else:
            many.compare(corpus, every=8 if options.quick else 1, repeats=1 if options.quick else 3)
    if "growth" in parts:
        _title("(c) growth: copies of one robot without meshes in one folder")
        many.grow((10, 30, 100) if options.quick else (100, 300, 1000), repeats=1 if options.quick else 3)


def _title(text: str) -> None:
    print(f"\n{text}", flush=True)


if __name__ == "__main__":
    main()
