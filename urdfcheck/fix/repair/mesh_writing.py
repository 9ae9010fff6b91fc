"""Mesh files: fewer triangles, convex parts, and COLLADA with its unit and up-axis in the coordinates."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from urdfcheck.core import UrdfcheckError

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array, Indices

CONVEX_INSTALL = "pip install 'urdfcheck[repair]'"
# CoACD's own default for how concave a part may be, the most parts, and a seed so that they are always the same.
_CONCAVITY, _MOST_PARTS, _SEED = 0.05, 24, 0
# The rotation, as axis and angle in degrees, that puts a mesh upright. Programs do not agree about X_UP.
_UPRIGHT = {"Y_UP": (1, 0, 0, 90)}


def write_stl(vertices: Array, faces: Indices) -> bytes:
    """Write a binary STL file."""
    import trimesh

    data: bytes = trimesh.Trimesh(vertices, faces, process=False).export(file_type="stl")
    return data


def decimate(vertices: Array, faces: Indices, triangles: int) -> tuple[Array, Indices]:
    """Reduce a mesh to at most about so many triangles, by quadric errors (Garland and Heckbert, 1997).

    :raises UrdfcheckError: if fast-simplification is not installed.
    """
    try:
        import fast_simplification
    except ImportError:
        raise UrdfcheckError(f"fewer triangles need fast-simplification: {CONVEX_INSTALL}") from None
    import numpy as np

    if len(faces) <= triangles:
        return vertices, faces
    # The library works in single precision: a part far from its origin would lose its shape.
    middle = (vertices.min(axis=0) + vertices.max(axis=0)) / 2
    points, kept = fast_simplification.simplify(
        np.ascontiguousarray(vertices - middle, dtype=np.float32),
        np.ascontiguousarray(faces, dtype=np.int32),
        target_count=triangles,
    )
    return points.astype(float) + middle, kept.astype(np.int64)


def split_convex(vertices: Array, faces: Indices) -> list[tuple[Array, Indices]]:
    """Split a mesh into convex parts with CoACD (Wei, Liu, Ling and Su, 2022).

    :raises UrdfcheckError: if coacd is not installed.
    """
    try:
        import coacd
    except ImportError:
        raise UrdfcheckError(f"--collision convex needs CoACD: {CONVEX_INSTALL}") from None
    import numpy as np

    coacd.set_log_level("error")
    mesh = coacd.Mesh(np.ascontiguousarray(vertices, dtype=float), np.ascontiguousarray(faces, dtype=np.int32))
    parts = coacd.run_coacd(mesh, threshold=_CONCAVITY, max_convex_hull=_MOST_PARTS, seed=_SEED)
    return [(np.asarray(points, dtype=float), np.asarray(sides, dtype=np.int64)) for points, sides in parts]


def bake_collada(data: bytes, *, unit: float, up_axis: str, upright: bool) -> bytes | None:
    """Return a COLLADA document in metres and z up that draws what ``data`` draws; None if it has no scene to write to.

    Each node of its scenes gets a scale by ``unit``, and with ``upright`` the rotation that its ``<up_axis>`` asks for.
    """
    from lxml import etree

    parser = etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False, huge_tree=True)
    try:
        root = etree.fromstring(data, parser)
    except (etree.XMLSyntaxError, ValueError):
        return None
    space = root.nsmap.get(None)
    prefix = "" if space is None else f"{{{space}}}"
    nodes = [node for scene in root.iter(f"{prefix}visual_scene") for node in scene.findall(f"{prefix}node")]
    asset = root.find(f"{prefix}asset")
    if not nodes or asset is None:
        return None
    for node in nodes:
        place = 1 if len(node) and node[0].tag == f"{prefix}asset" else 0
        turn = _UPRIGHT.get(up_axis) if upright else None
        if not math.isclose(unit, 1.0, rel_tol=1e-12):
            _insert(node, place, f"{prefix}scale", f"{unit:.17g} {unit:.17g} {unit:.17g}")
        if turn is not None:
            _insert(node, place, f"{prefix}rotate", " ".join(map(str, turn)))
    _declare(asset, prefix, "unit", None, {"name": "meter", "meter": "1"})
    _declare(asset, prefix, "up_axis", "Z_UP", {})
    written: bytes = etree.tostring(root.getroottree(), xml_declaration=True, encoding="utf-8")
    return written


def _insert(node: Any, place: int, tag: str, text: str) -> None:
    from lxml import etree

    element = etree.Element(tag)
    element.text = text
    node.insert(place, element)


def _declare(asset: Any, prefix: str, name: str, text: str | None, attributes: dict[str, str]) -> None:
    """Write ``<unit>`` or ``<up_axis>``, which end an ``<asset>`` in this order."""
    from lxml import etree

    element = asset.find(f"{prefix}{name}")
    if element is None:
        element = etree.Element(f"{prefix}{name}")
        later = asset.find(f"{prefix}up_axis") if name == "unit" else None
        asset.append(element) if later is None else later.addprevious(element)
    element.text = text
    for key, value in attributes.items():
        element.set(key, value)
