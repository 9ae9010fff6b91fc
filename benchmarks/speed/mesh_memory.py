"""Memory that a mesh file takes in a process that has read a small one of its format: to decode it, and to measure it (Linux).

``python mesh_memory.py`` prints a table: a sphere of 1,310,720 triangles in each format. Counted is the largest resident size
above that before the file was read, so that the file itself counts and the libraries do not. Of COLLADA the sphere is a smaller
one: its library takes half a minute for the other.
"""

from __future__ import annotations

import base64
import json
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import trimesh

KINDS = ("stl", "stl_ascii", "obj", "off", "ply", "ply_ascii", "glb", "gltf", "dae")
# Subdivisions of the sphere: 20 triangles times four to their power.
USUAL, SMALL, OF_WARMING = 8, 7, 2
STEPS = ("decode", "measure")
# Of what a file takes, in times its size.
TARGET = 6


def write_sphere(kind: str, subdivisions: int) -> bytes:
    """A sphere as a file of this format, as trimesh writes it."""
    import trimesh

    ball = trimesh.creation.icosphere(subdivisions=subdivisions, radius=0.1)
    if kind == "gltf":
        return _embed_buffers(ball)
    encoding = {"encoding": "ascii"} if kind == "ply_ascii" else {}
    written = ball.export(file_type="ply" if kind == "ply_ascii" else kind, **encoding)
    return written.encode() if isinstance(written, str) else written


def _embed_buffers(mesh: trimesh.Trimesh) -> bytes:
    """A glTF document with its buffers inside."""
    files = mesh.scene().export(file_type="gltf")
    document = json.loads(files["model.gltf"])
    for buffer in document["buffers"]:
        content = base64.b64encode(files[buffer["uri"]]).decode()
        buffer["uri"] = f"data:application/octet-stream;base64,{content}"
    return json.dumps(document).encode()


def measure(kind: str, step: str, file: str) -> None:
    """Print how many bytes the process takes more at most while it reads the file."""
    from urdfcheck.facts.mesh.decode import decode_mesh
    from urdfcheck.facts.mesh.measure import measure_mesh

    read = decode_mesh if step == "decode" else measure_mesh
    suffix = kind.partition("_")[0]
    read(write_sphere(kind, OF_WARMING), suffix)
    before = _get_memory("VmRSS")
    Path("/proc/self/clear_refs").write_text("5", encoding="ascii")  # the largest size begins anew
    read(Path(file).read_bytes(), suffix)
    print(_get_memory("VmHWM") - before)


def _get_memory(field: str) -> int:
    lines = Path("/proc/self/status").read_text(encoding="utf-8").splitlines()
    return next(int(line.split()[1]) * 1024 for line in lines if line.startswith(field))


def compare(kinds: tuple[str, ...] = KINDS) -> None:
    """Print the table."""
    print(f"{'file':12} {'MB':>6} {'bytes a triangle':>17} {'decode':>8} {'measure':>8}   memory / file")
    for kind in kinds:
        with tempfile.TemporaryDirectory() as folder:
            file, subdivisions = Path(folder, "mesh"), SMALL if kind == "dae" else USUAL
            # In a process of its own: what this one holds would count for those that it starts.
            subprocess.run([sys.executable, __file__, "write", kind, str(subdivisions), str(file)], check=True)
            size = file.stat().st_size
            taken = [
                int(subprocess.check_output([sys.executable, __file__, step, kind, str(file)])) / size for step in STEPS
            ]
        missed = "  MISSED" if max(taken) > TARGET else ""
        each = size / (20 * 4**subdivisions)
        print(f"{kind:12} {size / 1e6:6.1f} {each:17.1f} {taken[0]:7.1f}× {taken[1]:7.1f}×{missed}", flush=True)
    print(f"target: at most {TARGET} × the file", flush=True)


if __name__ == "__main__":
    match sys.argv[1:]:
        case ["write", kind, subdivisions, file]:
            Path(file).write_bytes(write_sphere(kind, int(subdivisions)))
        case [step, kind, file] if step in STEPS:
            measure(kind, step, file)
        case kinds:
            compare(tuple(kinds) or KINDS)
