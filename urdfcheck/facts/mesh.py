"""What a mesh file is, from its bytes: size, mass properties, topology. Lengths are in file units throughout.

Loaders built on trimesh or Assimp as Pinocchio and coal use them ignore COLLADA's ``<unit>`` and ``<up_axis>``; so do
these numbers, and ``MeshFacts.unit`` and ``up_axis`` say what the file declares.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from urdfcheck.facts.inertia import Solid, placed
from urdfcheck.facts.mesh_decode import MeshError, RawMesh, decode
from urdfcheck.facts.mesh_topology import Boundary, Edges, Surface, boundaries_of, edges_of, weld_exact, weld_near

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]

__all__ = ["Boundary", "MeshError", "MeshFacts", "hull_vertices", "mesh_facts", "transformed_moments"]

_Scalar = TypeVar("_Scalar", bound=np.generic)

# Exporters write one corner of several triangles with different float noise. The least of these, as fractions of the
# diagonal, that closes a mesh is taken: residue of zero, one float32 rounding, and up to a micrometre on a metre where
# transforms came between, which is still far below any feature of a part.
_NOISE = (1e-9, 6e-8, 1e-6)


@dataclass(frozen=True, slots=True, eq=False)
class MeshFacts:
    """A mesh, measured. Arrays are read-only; lengths are in file units.

    ``vertices`` (V, 3) and ``faces`` (F, 3): equal corners merged whatever their normals and texture coordinates,
    triangles with a non-finite corner, with a repeated corner and repeated triangles dropped. If the mesh is open
    then, corners within ``weld_distance``, at most 1e-6 of the diagonal, of each other are merged too, when that
    closes it; else ``weld_distance`` is 0.

    ``n_triangles``: as stored in the file; the counts ``degenerate_faces`` (a repeated corner or no area),
    ``duplicate_faces`` (the same corners as an earlier face, either way round) and ``non_finite_vertices`` (as stored)
    refer to that too.

    ``open_edges`` belong to one face and make the ``boundaries``, longest first; ``non_manifold_edges`` to three or
    more. ``watertight``: every edge belongs to two faces. ``winding_consistent``: each two faces that share an edge run
    along it in opposite directions. ``closed``: every edge is run along equally often either way; unlike ``watertight``
    it holds for closed bodies that touch along an edge, and it is what the volume integrals need.
    ``inside_out``: closed, with negative volume.

    ``volume`` (signed), ``com`` (3,) and ``covariance`` (3, 3) about the COM: exact integrals over signed tetrahedra
    at uniform density (Tonon, *Explicit exact formulas for the 3-D tetrahedron inertia tensor*, 2004); NaN for the
    latter two without volume. They mean something when ``closed``. ``area``, ``surface_centroid`` (3,) and
    ``surface_covariance`` (3, 3): the same of the surface as a thin shell; they always mean something.

    ``unit``: metres per unit as COLLADA declares it, None where it or another format does not. ``up_axis``: COLLADA's
    ``X_UP``, ``Y_UP`` (where it declares none) or ``Z_UP``; None in other formats. ``format`` and ``solid_header``:
    see `urdfcheck.facts.mesh_decode.RawMesh`.
    """

    format: str
    solid_header: bool
    unit: float | None
    up_axis: str | None
    n_triangles: int
    n_vertices: int
    vertices: Array
    faces: NDArray[np.int64]
    bounds: Array
    volume: float
    com: Array
    covariance: Array
    area: float
    surface_centroid: Array
    surface_covariance: Array
    watertight: bool
    winding_consistent: bool
    closed: bool
    inside_out: bool
    open_edges: int
    boundaries: tuple[Boundary, ...]
    non_manifold_edges: int
    degenerate_faces: int
    duplicate_faces: int
    non_finite_vertices: int
    weld_distance: float


def mesh_facts(data: bytes, file_type: str) -> MeshFacts:
    """Measure the mesh file ``data``; ``file_type`` is its extension in lower case, without the dot.

    :raises MeshError: when it is no complete mesh file, or holds no triangle with finite corners.
    """
    raw = decode(data, file_type)
    with np.errstate(over="ignore", invalid="ignore"):  # corners of 1e200 are a finding, not a warning on stderr
        return _measure(raw)


def _measure(raw: RawMesh) -> MeshFacts:
    finite = np.asarray(np.isfinite(raw.vertices).all(axis=1))
    usable = raw.faces[finite[raw.faces].all(axis=1)]
    if not len(usable):
        raise MeshError("no-triangles", "has a NaN or infinite corner in every triangle")
    exact = weld_exact(raw.vertices, usable)
    if not len(exact.faces):
        raise MeshError("no-triangles", "has nothing but triangles that repeat a corner")
    surface, edges, weld_distance = _close(exact, edges_of(exact.faces))
    vertices, faces = surface.vertices, surface.faces
    corners = vertices[faces]
    volume, com, covariance = _volume_moments(corners)
    area, surface_centroid, surface_covariance = _surface_moments(corners)
    return MeshFacts(
        format=raw.format,
        solid_header=raw.solid_header,
        unit=raw.unit,
        up_axis=raw.up_axis,
        n_triangles=len(raw.faces),
        n_vertices=len(vertices),
        vertices=_frozen(vertices),
        faces=_frozen(faces),
        bounds=_frozen(np.array((vertices.min(axis=0), vertices.max(axis=0)))),
        volume=volume,
        com=_frozen(com),
        covariance=_frozen(covariance),
        area=area,
        surface_centroid=_frozen(surface_centroid),
        surface_covariance=_frozen(surface_covariance),
        watertight=edges.watertight,
        winding_consistent=edges.winding_consistent,
        closed=edges.closed,
        inside_out=edges.closed and volume < 0.0,
        open_edges=len(edges.open),
        boundaries=boundaries_of(vertices, edges.open),
        non_manifold_edges=edges.non_manifold,
        degenerate_faces=surface.degenerate + _without_area(corners),
        duplicate_faces=surface.duplicate,
        non_finite_vertices=int((~finite).sum()),
        weld_distance=weld_distance,
    )


def hull_vertices(facts: MeshFacts) -> Array:
    """Corners (K, 3) of the convex hull; of the bounding box, which contains it, when the mesh is flat."""
    from scipy.spatial import ConvexHull, QhullError

    try:
        hull: Array = facts.vertices[ConvexHull(facts.vertices).vertices]
        return hull
    except (QhullError, ValueError):
        return np.array(list(product(*facts.bounds.T)))


def transformed_moments(facts: MeshFacts, scale: Sequence[float], rotation: ArrayLike, translation: ArrayLike) -> Solid:
    """The solid that a URDF ``<mesh scale>`` under an ``<origin>`` fills: ``x -> rotation (scale * x) + translation``.

    ``scale`` (3,) in metres per file unit, mirrored where negative; the volume is positive all the same, and for a mesh
    that is inside out. Meaningful for ``closed`` meshes.
    """
    factors = np.asarray(scale, dtype=float)
    volume = abs(facts.volume * float(factors.prod()))
    local = Solid(volume, factors * facts.com, facts.covariance * np.outer(factors, factors))
    return placed(local, rotation, translation)


def _close(surface: Surface, edges: Edges) -> tuple[Surface, Edges, float]:
    """The surface with float noise merged and by how much, if that closes it; else as it is."""
    if len(edges.open):
        diagonal = float(np.linalg.norm(np.ptp(surface.vertices, axis=0)))
        for distance in (noise * diagonal for noise in _NOISE):
            welded = weld_near(surface, distance)
            if len(welded.faces) and not len((closed := edges_of(welded.faces)).open):
                return welded, closed, distance
    return surface, edges, 0.0


def _volume_moments(corners: Array) -> tuple[float, Array, Array]:
    """Volume, COM and covariance from the tetrahedra that each triangle forms with a reference point.

    The reference is the middle of the corners, not the origin, to keep the digits of a mesh that lies far away.
    """
    reference = corners.reshape(-1, 3).mean(axis=0)
    size = float(np.ptp(corners.reshape(-1, 3), axis=0).max())
    a, b, c = np.moveaxis(corners - reference, 1, 0)
    six_volumes = np.einsum("ij,ij->i", a, np.cross(b, c))
    volume = float(six_volumes.sum()) / 6.0
    if abs(volume) <= 1e-15 * size**3:
        return volume, np.full(3, np.nan), np.full((3, 3), np.nan)
    total = a + b + c
    com = six_volumes @ total / 24.0 / volume
    second = sum((p * six_volumes[:, None]).T @ p for p in (a, b, c, total)) / 120.0 / volume
    return volume, com + reference, second - np.outer(com, com)


def _surface_moments(corners: Array) -> tuple[float, Array, Array]:
    reference = corners.reshape(-1, 3).mean(axis=0)
    a, b, c = np.moveaxis(corners - reference, 1, 0)
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2.0
    area = float(areas.sum())
    if area == 0.0:
        return 0.0, reference, np.zeros((3, 3))
    total = a + b + c
    centroid = areas @ total / 3.0 / area
    second = sum((p * areas[:, None]).T @ p for p in (a, b, c, total)) / 12.0 / area
    return area, centroid + reference, second - np.outer(centroid, centroid)


def _without_area(corners: Array) -> int:
    """Triangles whose distinct corners lie on one line, to within double rounding."""
    ab, ac, bc = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0], corners[:, 2] - corners[:, 1]
    longest = np.maximum(np.maximum((ab**2).sum(axis=1), (ac**2).sum(axis=1)), (bc**2).sum(axis=1))
    return int((np.linalg.norm(np.cross(ab, ac), axis=1) <= 1e-14 * longest).sum())


def _frozen(array: NDArray[_Scalar]) -> NDArray[_Scalar]:
    array.setflags(write=False)
    return array
