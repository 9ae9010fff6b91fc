"""Independent oracle: what is measured of the meshes of real robots, against trimesh and assimp.

Every mesh is read. Of those of one repository, format, magnitude and state (`describe_kind`) the smallest is compared; all
with ``URDFCHECK_FULL=1``.

trimesh merges corners by rounding them to decimals. Its best answer for a file is that of the finest rounding that makes
it watertight, without triangles that collapse, and without those that repeat if that is what it takes.
"""

from __future__ import annotations

import hashlib
import io
import logging
import math
from collections.abc import Hashable, Iterator
from dataclasses import dataclass
from pathlib import Path

import coal
import numpy as np
import pytest
import trimesh
from real_robots import select_by_trait

from urdfcheck.facts.mesh.decode_limits import MeshError
from urdfcheck.facts.mesh.measure import MeshFacts, measure_mesh

KINDS = ("stl", "dae", "obj", "ply", "off", "glb", "gltf")
# Decimals of the largest coordinate: double noise, residue of zero, float32 noise, and what transforms make of it.
ROUNDINGS = (13, 9, 7, 6, 5)
# Of a length, area or volume: COLLADA's numbers are float32 to trimesh, and merging moves corners by up to this.
TOLERANCE = 1e-6

CELLS = "corners differ by millionths of the diagonal, and borders of trimesh's decimal cells run between some of them"

_ROBOTIQ = "Daniella1__urdf_files_dataset/urdf_files/ros-industrial/robotiq/robotiq_3f_gripper_visualization"
_ABB = "Daniella1__urdf_files_dataset/urdf_files/ros-industrial/xacro_generated/abb/abb_irb1600_support"
_K1 = "BoosterRobotics__booster_assets/robots/K1"
DIFFERENT = {
    f"{_K1}/meshes/Left_Shank.STL": ({"watertight"}, CELLS),
    f"{_K1}/meshes/Right_Shank.STL": ({"watertight"}, CELLS),
    f"{_ROBOTIQ}/meshes/robotiq-3f-articulated/visual/palm.dae": ({"watertight"}, CELLS),
    f"{_ABB}/meshes/irb1600/collision/link_4.stl": ({"watertight"}, CELLS),
    f"{_ABB}/meshes/irb1600/collision/link_5.stl": ({"watertight"}, CELLS),
    f"{_ABB}/meshes/irb1600/collision/link_6.stl": ({"watertight", "volume"}, CELLS),
    f"{_ABB}/meshes/irb1600/visual/link_3.stl": ({"watertight"}, CELLS),
}


@dataclass(frozen=True, eq=False)
class MeshFile:
    """A content, once, under the first of its names."""

    name: str
    kind: str
    data: bytes


@pytest.fixture(scope="module")
def files(corpus: Path) -> list[MeshFile]:
    found: dict[tuple[str, bytes], MeshFile] = {}
    for path in sorted(corpus.rglob("*")):
        kind = path.suffix.lower().removeprefix(".")
        if kind in KINDS and path.is_file():
            data = path.read_bytes()
            key = (kind, hashlib.sha256(data).digest())
            found.setdefault(key, MeshFile(path.relative_to(corpus).as_posix(), kind, data))
    return list(found.values())


@pytest.fixture(scope="module")
def measured(files: list[MeshFile]) -> dict[str, MeshFacts | MeshError]:
    """Anything but a MeshError is a crash."""
    found: dict[str, MeshFacts | MeshError] = {}
    for file in files:
        try:
            found[file.name] = measure_mesh(file.data, file.kind)
        except MeshError as error:
            found[file.name] = error
    return found


@pytest.fixture(scope="module")
def compared(files: list[MeshFile], measured: dict[str, MeshFacts | MeshError]) -> list[MeshFile]:
    """The files that others are asked about: those in which they differ, and the smallest of each kind."""
    ordered = sorted(files, key=lambda file: (len(file.data), file.name))
    return select_by_trait(ordered, lambda file: [describe_kind(file, measured[file.name])])


def describe_kind(file: MeshFile, facts: MeshFacts | MeshError) -> Hashable:
    """What meshes have in common that are read alike: whose they are, and which steps of the measurement they take."""
    if isinstance(facts, MeshError) or file.name in DIFFERENT:
        return file.name
    # Large meshes take most of the time, and are made by the programs that make the small ones.
    repository = file.name.partition("/")[0] if facts.n_triangles < 10_000 else None
    return (
        *(repository, file.kind, len(str(facts.n_triangles))),
        *(facts.watertight, facts.closed, facts.winding_consistent),
        *(facts.weld_distance > 0, facts.dropped_duplicates > 0, 0 < facts.dropped_duplicates < facts.duplicate_faces),
    )


def test_every_mesh_is_read(measured: dict[str, MeshFacts | MeshError]) -> None:
    assert len(measured) > 500
    assert {name: str(facts) for name, facts in measured.items() if isinstance(facts, MeshError)} == {}


def test_facts_agree_with_trimesh(
    compared: list[MeshFile], measured: dict[str, MeshFacts | MeshError], caplog: pytest.LogCaptureFixture
) -> None:
    """Where they do not, the reason is known; a file that has come to agree leaves the list."""
    caplog.set_level(logging.ERROR, logger="trimesh")  # it tells of every texture that it does not find
    found = {}
    for file in compared:
        facts = measured[file.name]
        if isinstance(facts, MeshFacts):
            differing = set(differences(facts, as_stored(file)))
            if differing:
                found[file.name] = differing
    names = {file.name for file in compared}
    assert found == {name: facts for name, (facts, _) in DIFFERENT.items() if name in names}


def test_assimp_loads_what_we_read(
    compared: list[MeshFile], measured: dict[str, MeshFacts | MeshError], corpus: Path
) -> None:
    """A mesh that Pinocchio refuses is known without asking about all of them, and what it loads is what we measure."""
    different = {}
    loader = coal.MeshLoader(coal.BV_AABB)  # the volumes around the triangles that take the least time
    for file in compared:
        path = corpus / file.name
        try:
            theirs = np.asarray(loader.load(str(path)).vertices())
        except ValueError:
            if measure_mesh(file.data, file.kind, path=path).assimp != "refuses":
                different[file.name] = "refused"
            continue
        facts = measured[file.name]
        if isinstance(facts, MeshError):
            different[file.name] = str(facts)
            continue
        ours = facts.bounds
        bounds = np.array((theirs.min(axis=0), theirs.max(axis=0)))
        if not np.allclose(bounds, ours, rtol=0, atol=1e-5 * np.abs(ours).max()):
            different[file.name] = "other bounds"
    assert different == {}


def as_stored(file: MeshFile) -> trimesh.Trimesh:
    """All triangles of the file's scene, nothing merged or dropped."""
    scene = trimesh.load_scene(io.BytesIO(file.data), file_type=file.kind, process=False)
    mesh = scene.to_geometry()
    return trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)


def differences(ours: MeshFacts, stored: trimesh.Trimesh) -> Iterator[str]:
    """The facts that trimesh measures otherwise."""
    theirs = best(stored, repeated=not ours.dropped_duplicates)
    if ours.weld_distance and not ours.watertight and not theirs.is_watertight:
        # Noise was merged, and holes are left: trimesh looks at what was merged, not at what it would have.
        theirs = trimesh.Trimesh(ours.vertices, ours.faces, process=False)
    elif 0 < ours.dropped_duplicates < ours.duplicate_faces:
        # Some of the triangles that repeat others were dropped, and some are fins: trimesh keeps all of them, or none.
        theirs = trimesh.Trimesh(ours.vertices, ours.faces, process=False)
    size = float(np.linalg.norm(np.ptp(stored.bounds, axis=0)))
    if ours.n_triangles != len(stored.faces):
        yield "triangles"
    if not np.allclose(ours.bounds, stored.bounds, rtol=0, atol=TOLERANCE * max(size, np.abs(stored.bounds).max())):
        yield "bounds"
    if not math.isclose(ours.area, theirs.area, rel_tol=TOLERANCE):
        yield "area"
    if ours.watertight != theirs.is_watertight:
        yield "watertight"
    elif not ours.watertight and ours.open_edges != open_edges(theirs):
        yield "open edges"
    if ours.winding_consistent != theirs.is_winding_consistent:
        yield "winding"
    if ours.closed:
        yield from solid_differences(ours, theirs, size)


def solid_differences(ours: MeshFacts, theirs: trimesh.Trimesh, size: float) -> Iterator[str]:
    """Volume, COM and second moments about it; the latter two where there is a volume to divide by."""
    if not math.isclose(ours.volume, theirs.volume, rel_tol=TOLERANCE, abs_tol=1e-9 * size**3):
        yield "volume"
    elif np.isfinite(ours.com).all():
        properties = theirs.mass_properties
        if not np.allclose(ours.com, properties.center_mass, rtol=0, atol=TOLERANCE * size):
            yield "COM"
        inertia = np.trace(ours.covariance) * np.eye(3) - ours.covariance
        if not np.allclose(inertia, properties.inertia / properties.volume, rtol=0, atol=TOLERANCE * size**2):
            yield "second moments"


def best(stored: trimesh.Trimesh, *, repeated: bool) -> trimesh.Trimesh:
    """The mesh under the finest rounding that makes it watertight; if none does, under the finest of all, with or without
    ``repeated`` triangles, of which trimesh has no opinion."""
    magnitude = math.ceil(math.log10(np.abs(stored.bounds).max()))
    finest = None
    for digits in ROUNDINGS:
        mesh = stored.copy()
        mesh.merge_vertices(merge_tex=True, merge_norm=True, digits_vertex=digits - magnitude)
        a, b, c = mesh.faces.T
        mesh.update_faces((a != b) & (b != c) & (c != a))
        single = mesh
        if not mesh.is_watertight and not (unique := mesh.unique_faces()).all():
            single = mesh.copy()
            single.update_faces(unique)
        if single.is_watertight:
            return single
        finest = finest or (mesh if repeated else single)
    assert finest is not None
    return finest


def open_edges(mesh: trimesh.Trimesh) -> int:
    return len(trimesh.grouping.group_rows(mesh.edges_sorted, require_count=1))
