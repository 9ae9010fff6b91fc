"""Size, mass properties and topology of a mesh file, from its bytes. Lengths are in file units throughout.

Loaders built on trimesh or Assimp, as in Pinocchio and coal, ignore COLLADA's ``<unit>`` and ``<up_axis>``; so do these numbers.
``MeshFacts.unit`` and ``up_axis`` hold what the file declares.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, MutableMapping, Sequence
from dataclasses import fields, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.facts.inertials.inertia_tensor import Solid, transform_solid
from urdfcheck.facts.mesh.convex_hull import MeshHull, compute_convex_hull
from urdfcheck.facts.mesh.decode_limits import MeshError
from urdfcheck.facts.mesh.moments import MeshMoments, compute_mesh_moments
from urdfcheck.facts.mesh.topology import (
    Boundary,
    Edges,
    Surface,
    classify_edges,
    compute_bounds,
    count_component_faces,
    drop_repeated_faces,
    find_boundaries,
    find_face_origins,
    find_points_near_rim,
    find_repeated_faces,
    find_unpaired_edges,
    label_bodies,
    label_components,
    measure_gap_width,
    weld_exact,
    weld_near,
)

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from urdfcheck.facts.arrays import Array, Indices, Mat3, Vec3
    from urdfcheck.facts.mesh.decode import RawMesh
    from urdfcheck.facts.mesh.formats.binary_stl import BinaryStl

    Parts = MutableMapping[str, Mapping[str, NDArray[Any]]]

__all__ = [
    "Boundary",
    "MeshError",
    "MeshFacts",
    "compute_mesh_solid",
    "measure_mesh",
    "restore_mesh_facts",
]

# Exporters write one corner of several triangles with different float noise. The least of these fractions of the diagonal
# that leaves the fewest edges open is the weld distance: residue of zero, one float32 rounding, and up to five micrometres on
# a metre where transforms came between (a part of 0.1 m that was placed 1 m from the origin when single precision rounded
# its corners: 1.2e-6), which is still far below any feature of a part.
_NOISE = (1e-9, 6e-8, 1e-6, 5e-6)
# Points processed at a time: what is computed of them stays in the processor's cache.
_BLOCK = 4096
# Holes are filled where there are at most so many open edges, and the volume between what may fill them is at most this share of
# the solid (both chosen).
_MOST_OPEN_EDGES, _FILLED = 500, 0.01
# Single precision ends at 3.4028e38: programs that load meshes in it read anything beyond as infinite.
_INFINITE = 3.4e38


@dataclass(frozen=True, slots=True, eq=False)
class FaceMaterials:
    """The materials of the faces of a mesh, by name."""

    of_face: Indices
    """Index (F,) in ``names``, -1 for none."""
    names: tuple[str, ...]
    libraries: tuple[str, ...]
    """The files that describe them, as written."""


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class MeshFacts:
    """A mesh with its measurements. Arrays are read-only; lengths are in file units.

    Equal corners are merged regardless of their normals and texture coordinates, and triangles with a repeated corner, or one
    that is not finite (or beyond 3.4e38), are dropped. If edges have more than two triangles, or two with the same direction,
    triangles with the corners of an earlier one are dropped too, unless the surface is closed with them and not open without.
    """

    format: str
    """See `urdfcheck.facts.mesh.decode.RawMesh`."""
    solid_header: bool
    """See `urdfcheck.facts.mesh.decode.RawMesh`."""
    unit: float | None
    """Metres per unit as COLLADA declares it; None where it or another format does not."""
    up_axis: str | None
    """COLLADA's ``X_UP``, ``Y_UP`` (also if it declares none) or ``Z_UP``; None in other formats."""
    bad_unit: str | None
    """COLLADA's unit as written if that is not a plausible length."""
    flaw: str | None
    """See `urdfcheck.facts.mesh.decode.RawMesh`."""
    assimp: str
    """See `urdfcheck.facts.mesh.decode.RawMesh`."""
    n_triangles: int
    """As stored in the file."""
    n_vertices: int
    """After merging."""
    bounds: Array
    """(2, 3), lowest and highest coordinates."""
    volume: float
    """Signed exact integral over the solid; meaningful if ``closed``."""
    com: Vec3
    """Of the solid at uniform density, NaN without volume; meaningful if ``closed``."""
    covariance: Mat3
    """Of the solid at uniform density about the COM, NaN without volume; meaningful if ``closed``."""
    area: float
    """Of the surface."""
    surface_centroid: Vec3
    """Of the surface as a thin shell; always meaningful."""
    surface_covariance: Mat3
    """Of the surface as a thin shell about its centroid; always meaningful."""
    watertight: bool
    """Whether every edge belongs to two faces."""
    winding_consistent: bool
    """Whether each two faces that share an edge have opposite directions along it."""
    closed: bool
    """Whether the faces of every edge have either direction equally often. Unlike ``watertight`` it is true of closed bodies
    that touch along an edge; the volume integrals require it."""
    open_edges: int
    """Edges of one face."""
    non_manifold_edges: int
    """Edges of three or more faces."""
    degenerate_faces: int
    """Stored triangles with a repeated corner or no area."""
    dropped_duplicates: int
    """Stored triangles that were dropped for having the corners of an earlier one."""
    non_finite_vertices: int
    """Stored vertices that are not finite."""
    weld_distance: float
    """The corners of open edges are merged with those within this distance, at most 5e-6 of the diagonal; 0 if that does not
    leave fewer edges open."""
    parts: Parts
    """The arrays, and what is computed on first use: hull, components, duplicate faces."""
    remeasure: Callable[[], object] | None = None
    """Measures the file again, for parts that were lost where they are stored."""

    @property
    def inside_out(self) -> bool:
        """Whether the mesh is closed, with negative volume."""
        return self.closed and self.volume < 0.0

    @cached_property
    def vertices(self) -> Array:
        """(V, 3)"""
        return _freeze_array(self._surface["vertices"].astype(np.float64))

    @cached_property
    def faces(self) -> Indices:
        """(F, 3)"""
        return _freeze_array(self._surface["faces"].astype(np.int64))

    @property
    def _surface(self) -> Mapping[str, NDArray[Any]]:
        if self.parts.get("surface") is None and self.remeasure is not None:
            self.remeasure()
        return self.parts["surface"]

    @property
    def colors(self) -> tuple[Indices, Array] | None:
        """Index (F,) of each face's colour in a list, -1 for none, and that list (n, 4), r g b a from 0 to 1; None if the file
        has no colours, or a format whose colours are not read (all but COLLADA and glTF; of OBJ see `materials`)."""
        if "colors" not in self.parts:
            return None
        part = self.parts["colors"]
        return part["faces"].astype(np.int64), np.asarray(part["rgba"], dtype=np.float64)

    @property
    def materials(self) -> FaceMaterials | None:
        """The materials of OBJ, whose colours are in other files; None if the file names none."""
        if "materials" not in self.parts:
            return None
        part = self.parts["materials"]
        names, libraries = _decode_json(part["text"])
        return FaceMaterials(part["faces"].astype(np.int64), tuple(names), tuple(libraries))

    @cached_property
    def boundaries(self) -> tuple[Boundary, ...]:
        """The boundaries that the open edges form, longest first."""
        return find_boundaries(self.vertices, self._edges.open) if self.open_edges else ()

    @cached_property
    def size(self) -> float:
        """Twice the largest distance of a vertex from the centroid of the surface: the same however the mesh is turned."""
        return 2.0 * float(np.linalg.norm(self.vertices - self.surface_centroid, axis=1).max())

    @cached_property
    def holes(self) -> tuple[Boundary, ...]:
        """The boundaries that are holes, longest first: those that are not a seam.

        A seam is a rim that is no wider than what single precision makes of one line: where one face ends in the middle of
        another's edge, the three corners are on one line apart from rounding."""
        seam = _NOISE[-1] * self.size
        return tuple(b for b in self.boundaries if not (b.closed and measure_gap_width(b.points) <= seam))

    @cached_property
    def hole_share(self) -> float:
        """What part of the surface the holes are, at most: for closed rims their length times half their width, over the area of
        the surface; and if that is more, for other runs of open edges their share of all edges."""
        rims = sum(b.length * measure_gap_width(b.points) / 2.0 for b in self.holes if b.closed)
        runs = sum(len(b.points) - 1 for b in self.holes if not b.closed)
        edges = (3 * len(self.faces) + self.open_edges) / 2.0
        return max(rims / self.area if self.area > 0.0 else float(rims > 0.0), runs / edges)

    @cached_property
    def open_lines(self) -> Array:
        """Ends (n, 2, 3) of the edges of one face."""
        return _freeze_array(self.vertices[self._edges.open])

    @cached_property
    def non_manifold_lines(self) -> Array:
        """Ends (n, 2, 3) of the edges of three or more faces."""
        return _freeze_array(self.vertices[self._edges.non_manifold])

    @cached_property
    def flipped_lines(self) -> Array:
        """Ends (n, 2, 3) of the edges along which both faces have the same direction."""
        return _freeze_array(self.vertices[self._edges.flipped])

    @cached_property
    def _edges(self) -> Edges:
        return classify_edges(self._surface["faces"], self.n_vertices)

    @property
    def duplicate_faces(self) -> int:
        """Number of stored triangles with the corners of an earlier one, in either order."""

        def count_repeated() -> Mapping[str, NDArray[Any]]:
            return {"count": find_repeated_faces(self._surface["faces"]).sum()}

        return self.dropped_duplicates + int(self._get_part("duplicates", count_repeated)["count"])

    @property
    def components(self) -> Indices:
        """Number of faces of each piece that is connected by vertices, largest first."""

        def count_faces() -> Mapping[str, NDArray[Any]]:
            return {"sizes": count_component_faces(self._surface["faces"], self.n_vertices)}

        return self._get_part("components", count_faces)["sizes"]

    def label_bodies(self) -> Indices:
        """Number the closed bodies from 0, and return that of each face: see `urdfcheck.facts.mesh.topology.label_bodies`."""
        return label_bodies(self._surface["faces"], self.n_vertices)

    @property
    def body_volumes(self) -> Array:
        """The signed volume of each piece that is connected by vertices; meaningful if ``closed``."""
        labels = label_components(self.faces, len(self.vertices))
        volumes: Array = np.bincount(labels, np.linalg.det(self.vertices[self.faces])) / 6.0
        return volumes

    @cached_property
    def has_mixed_orientation(self) -> bool:
        """Whether one of several bodies faces inwards while the others face outwards, and is not a hollow in them: its volume is
        subtracted."""

        def compare_bodies() -> Mapping[str, NDArray[Any]]:
            from urdfcheck.facts.mesh.winding import has_body_against

            faces = self.faces
            return {
                "mixed": np.array(
                    has_body_against(self.vertices[faces], label_components(faces, len(self.vertices)), self.volume)
                )
            }

        return len(self.components) > 1 and bool(self._get_part("orientation", compare_bodies)["mixed"])

    @cached_property
    def hull(self) -> MeshHull:
        """Exact for ordinary meshes: see `urdfcheck.facts.mesh.convex_hull.MOST_EXACT`."""

        def compute_hull() -> Mapping[str, NDArray[Any]]:
            hull = compute_convex_hull(self._surface["vertices"])
            sizes = np.array((hull.volume, hull.area, hull.excess))
            return {"vertices": hull.vertices, "faces": hull.faces, "sizes": sizes}

        part = self._get_part("hull", compute_hull)
        volume, area, excess = map(float, part["sizes"])
        return MeshHull(part["vertices"], part["faces"], volume=volume, area=area, excess=excess)

    @cached_property
    def hull_moments(self) -> MeshMoments:
        """Integrals over the hull."""
        return compute_mesh_moments(self.hull.vertices, self.hull.faces)

    @cached_property
    def filled_moments(self) -> MeshMoments | None:
        """Integrals over an open mesh of which each hole is filled by a fan of triangles about its middle; None where another
        filling may change the volume by more than `_FILLED`.

        Between two fillings, each of at most the area of the fan, is at most the volume of the ball with the surface of both (the
        isoperimetric inequality; Osserman, *The isoperimetric inequality*, 1978)."""
        if self.closed or self.open_edges > _MOST_OPEN_EDGES:
            return None

        def compute_filled() -> Mapping[str, NDArray[Any]]:
            filled = self._fill_holes()
            return {"known": np.array(filled is not None)} | {
                f.name: np.array(getattr(filled, f.name)) for f in fields(MeshMoments) if filled is not None
            }

        part = dict(self._get_part("filled", compute_filled))
        if not part.pop("known"):
            return None
        values: dict[str, Any] = {name: value if value.ndim else value.item() for name, value in part.items()}
        return MeshMoments(**values)

    def _fill_holes(self) -> MeshMoments | None:
        """Integrate over the mesh with its holes filled; None where there are none, or another filling may differ."""
        edges = find_unpaired_edges(self.faces, self._edges)
        if not len(edges):
            return None
        holes = label_components(edges, self.n_vertices)  # of each edge
        ends, counts = self.vertices[edges], np.bincount(holes)
        middles = (
            np.column_stack([np.bincount(holes, weights=column) for column in ends.mean(axis=1).T]) / counts[:, None]
        )
        first, second = (ends[:, i] - middles[holes] for i in (0, 1))
        areas = np.bincount(holes, weights=np.linalg.norm(np.cross(first, second), axis=1) / 2.0)
        between = float(((2.0 * areas) ** 1.5).sum()) / (6.0 * np.pi**0.5)
        fans = np.column_stack([edges[:, ::-1], self.n_vertices + holes])
        filled = compute_mesh_moments(np.concatenate([self.vertices, middles]), np.concatenate([self.faces, fans]))
        # The volume of the open surfaces is about the middle of the mesh: that of small sheets far from it would be large.
        return filled if between <= _FILLED * abs(filled.volume) and filled.volume else None

    def compute_reach(self, directions: Array) -> Array:
        """Compute how far the mesh reaches (n,) from the origin in each direction (n, 3); exact, also where the hull is not."""
        points = self.vertices if self.hull.excess else self.hull.vertices
        blocks = (points[start : start + _BLOCK] for start in range(0, len(points), _BLOCK))
        reach: Array = np.max([(block @ directions.T).max(axis=0) for block in blocks], axis=0)
        return reach

    def _get_part(self, name: str, compute: Callable[[], Mapping[str, NDArray[Any]]]) -> Mapping[str, NDArray[Any]]:
        if name not in self.parts:
            self.parts[name] = compute()
        return {key: _freeze_array(np.asarray(array)) for key, array in self.parts[name].items()}


def measure_mesh(
    data: bytes | BinaryStl,
    file_type: str,
    parts: Parts | None = None,
    *,
    path: Path | None = None,
    files: Mapping[str, bytes | MeshError] | None = None,
) -> MeshFacts:
    """Measure the mesh file ``data``; ``file_type`` is its extension in lower case, without the dot.

    The results are stored in ``parts``, from which `restore_mesh_facts` restores them. Where our own readers fail, Assimp is
    asked about the file at ``path``. ``files``: of glTF, see `urdfcheck.facts.mesh.formats.gltf.read_gltf_parts`.

    :raises MeshError: when it is not a complete mesh file, or has no triangle with finite corners.
    :raises ImportError, MemoryError: see `urdfcheck.facts.mesh.decode.decode_mesh`; nothing is stored in ``parts``.
    """
    from urdfcheck.facts.mesh.assimp import decode_with_assimp  # the readers: a cached mesh needs none

    parts = {} if parts is None else parts
    try:
        with np.errstate(all="ignore"):  # meaningless numbers are a finding, not a warning on stderr
            return _measure_raw_mesh(decode_with_assimp(data, file_type, path, files), parts)
    except MeshError as error:
        parts["error"] = {"text": _encode_json([error.reason_id, error.message, error.assimp])}
        raise


def restore_mesh_facts(parts: Parts, remeasure: Callable[[], object] | None = None) -> MeshFacts | None:
    """Restore the facts that an earlier `measure_mesh` stored in ``parts``; None if there are none. ``remeasure`` stores them
    again if some were lost.

    :raises MeshError: the one that `measure_mesh` raised.
    """
    if "error" in parts:
        raise MeshError(*_decode_json(parts["error"]["text"]))
    if "summary" not in parts:
        return None
    fields = _decode_json(parts["summary"]["text"])
    arrays = {name: _freeze_array(np.array(v)) for name, v in fields.items() if isinstance(v, list)}
    return MeshFacts(**{**fields, **arrays}, parts=parts, remeasure=remeasure)


def _measure_raw_mesh(raw: RawMesh, parts: Parts) -> MeshFacts:
    n_triangles = raw.n_triangles
    surface, non_finite = _weld_finite_triangles(raw)
    labels = raw.colors or (raw.materials.runs if raw.materials else ())
    if not _differ(labels):  # what is measured next takes several times the memory of the triangles as they were stored
        raw = replace(raw, vertices=np.empty((0, 3)), faces=None)
    edges = classify_edges(surface.faces, len(surface.vertices))
    weld_distance = 0.0
    if not edges.watertight:
        surface, edges, weld_distance = _weld_open_edges(surface, edges)
    vertices, faces = surface.vertices, surface.faces
    integrals = compute_mesh_moments(vertices, faces)
    narrow = vertices.astype(np.float32, copy=False)
    parts["surface"] = {
        "vertices": _freeze_array(narrow if narrow is vertices or np.array_equal(narrow, vertices) else vertices),
        "faces": _freeze_array(faces.astype(np.int32, copy=False)),
    }
    if edges.distinct_faces:
        parts["duplicates"] = {"count": np.array(0)}
    if labels:
        values, of_face = _label_faces(raw, labels, surface)
        if raw.materials is None:
            parts["colors"] = {"faces": of_face, "rgba": np.array(values)}
        else:
            parts["materials"] = {"faces": of_face, "text": _encode_json([values, raw.materials.libraries])}
    fields: dict[str, Any] = {
        "format": raw.format,
        "solid_header": raw.solid_header,
        "unit": raw.unit,
        "up_axis": raw.up_axis,
        "bad_unit": raw.bad_unit,
        "flaw": raw.flaw,
        "assimp": raw.assimp,
        "n_triangles": n_triangles,
        "n_vertices": len(vertices),
        "bounds": compute_bounds(vertices),
        "volume": integrals.volume,
        "com": integrals.com,
        "covariance": integrals.covariance,
        "area": integrals.area,
        "surface_centroid": integrals.surface_centroid,
        "surface_covariance": integrals.surface_covariance,
        "watertight": edges.watertight,
        "winding_consistent": edges.winding_consistent,
        "closed": edges.closed,
        "open_edges": len(edges.open),
        "non_manifold_edges": len(edges.non_manifold),
        "degenerate_faces": surface.collapsed + integrals.flat_faces,
        "dropped_duplicates": surface.repeated,
        "non_finite_vertices": non_finite,
        "weld_distance": weld_distance,
    }
    parts["summary"] = {
        "text": _encode_json({k: v.tolist() if isinstance(v, np.ndarray) else v for k, v in fields.items()})
    }
    frozen: dict[str, Any] = {k: _freeze_array(v) if isinstance(v, np.ndarray) else v for k, v in fields.items()}
    facts = MeshFacts(**frozen, parts=parts)
    facts.__dict__["_edges"] = edges
    return facts


# The most colours, or materials, of one file that are distinguished.
_MOST_LABELS = 100


def _differ(labels: Sequence[tuple[int, object]]) -> bool:
    """Whether the faces of a mesh do not all have the same colour or material."""
    return len({label for count, label in labels if count}) > 1


def _label_faces(
    raw: RawMesh, labels: Sequence[tuple[int, Any]], surface: Surface
) -> tuple[list[Any], NDArray[np.int8]]:
    """Return the colours, or names of materials, that the runs of ``labels`` have, and the index of each face's, -1 for none."""
    values = list(dict.fromkeys(label for count, label in labels if count and label is not None))[:_MOST_LABELS]
    if not _differ(labels) or raw.faces is None:
        return values, np.full(len(surface.faces), 0 if values else -1, dtype=np.int8)
    place = {value: i for i, value in enumerate(values)}
    number = np.array([-1 if label is None else place.get(label, -1) for _, label in labels])
    of_face = np.append(np.repeat(number, [count for count, _ in labels]), -1)
    return values, of_face[find_face_origins(raw.vertices, raw.faces, surface)].astype(np.int8)


def _weld_finite_triangles(raw: RawMesh) -> tuple[Surface, int]:
    """Return the surface of the triangles with finite corners, equal corners merged, and how many corners are not finite."""
    if raw.vertices.min() > -_INFINITE and raw.vertices.max() < _INFINITE:
        points, faces, non_finite = raw.vertices, raw.faces, 0
    else:
        usable = (np.abs(raw.vertices) < _INFINITE).all(axis=1)
        non_finite = int((~usable).sum())
        corners = np.arange(len(raw.vertices)).reshape(-1, 3) if raw.faces is None else raw.faces
        points, faces = raw.vertices, corners[usable[corners].all(axis=1)]
        if not len(faces):
            raise MeshError(
                "no-triangles", "has a corner that is NaN, infinite or beyond single precision in every triangle"
            )
    surface = weld_exact(points, faces)
    if not len(surface.faces):
        raise MeshError("no-triangles", "has only triangles that repeat a corner")
    return surface, non_finite


def _weld_open_edges(surface: Surface, edges: Edges) -> tuple[Surface, Edges, float]:
    """Drop repeated faces, merge float noise if that leaves fewer edges open, and return the distance of merging."""
    surface, edges = _deduplicate_faces(surface, edges)
    best = surface, edges, 0.0
    diagonal = float(np.linalg.norm(np.ptp(compute_bounds(surface.vertices), axis=0)))
    if not len(edges.open) or not diagonal > 0.0:
        return best
    nearby = find_points_near_rim(surface, edges.open, _NOISE[-1] * diagonal)
    for distance in (noise * diagonal for noise in _NOISE):
        welded = weld_near(surface, nearby, distance) if len(best[1].open) else None
        if welded is not None and len(welded.faces):
            welded, met = _deduplicate_faces(welded, classify_edges(welded.faces, len(welded.vertices)))
            closed = len(best[1].open) - len(met.open)
            # An edge that shrinks to a point does not close a crack: the closed edges must be longer than that.
            if (
                closed > 0
                and _measure_open_length(*best[:2]) - _measure_open_length(welded, met) > 4.0 * distance * closed
            ):
                best = welded, met, distance
    return best


def _measure_open_length(surface: Surface, edges: Edges) -> float:
    """Measure the length of all open edges."""
    starts, ends = (surface.vertices[column].astype(np.float64) for column in edges.open.T)
    return float(np.linalg.norm(ends - starts, axis=1).sum())


def _deduplicate_faces(surface: Surface, edges: Edges) -> tuple[Surface, Edges]:
    """Drop repeated faces. Bodies that share a face keep both copies, which each needs to be closed, and so does a fin on a body;
    a sheet with two sides that stands on nothing keeps one, and is open."""
    if not len(edges.non_manifold) and not len(edges.flipped):
        return surface, edges  # two faces with the same corners would share all three edges with no other face
    single = drop_repeated_faces(surface)
    if single is surface:
        return surface, edges
    met = classify_edges(single.faces, len(single.vertices))
    return (single, met) if not edges.closed or len(met.open) else (surface, edges)


def compute_mesh_solid(facts: MeshFacts, scale: Sequence[float], rotation: ArrayLike, translation: ArrayLike) -> Solid:
    """Compute the solid of a URDF ``<mesh scale>`` under an ``<origin>``: ``x -> rotation (scale * x) + translation``.

    ``scale`` (3,) in metres per file unit, mirrored where negative. The volume is positive, also if the mesh is mirrored or
    inside out. Meaningful for ``closed`` meshes.
    """
    factors = np.asarray(scale, dtype=float)
    volume = abs(facts.volume * float(factors.prod()))
    local = Solid(volume, factors * facts.com, facts.covariance * np.outer(factors, factors))
    return transform_solid(local, rotation, translation)


def _encode_json(value: object) -> NDArray[np.uint8]:
    """Encode plain values as bytes; floats stay exact."""
    return np.frombuffer(json.dumps(value).encode(), dtype=np.uint8)


def _decode_json(packed: NDArray[np.uint8]) -> Any:
    return json.loads(packed.tobytes())


def _freeze_array(array: NDArray[Any]) -> NDArray[Any]:
    array.setflags(write=False)
    return array
