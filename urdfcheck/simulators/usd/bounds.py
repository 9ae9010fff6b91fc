"""The boxes around what the links of a USD stage draw."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from urdfcheck.simulators.outcome import Vector

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array


def bound_drawn(links: Mapping[str, Any]) -> Iterator[tuple[str, Vector]]:
    """Yield the links that draw something, with the corners of the box around it in the link frame, in m.

    :param links: prims of the links by name. What is below one of another link belongs to that one.
    """
    import numpy as np
    from pxr import Usd, UsdGeom

    cache = UsdGeom.XformCache()
    paths = {prim.GetPath() for prim in links.values()}
    for name, link in links.items():
        inside = np.linalg.inv(np.array(cache.GetLocalToWorldTransform(link)).T)
        lowest, highest = [], []
        prims = iter(Usd.PrimRange(link, Usd.TraverseInstanceProxies()))
        for prim in prims:
            if prim != link and prim.GetPath() in paths:
                prims.PruneChildren()
            elif prim.IsA(UsdGeom.Gprim) and _is_drawn(prim):
                placed = inside @ np.array(cache.GetLocalToWorldTransform(prim)).T
                box = _bound_shape(prim, placed)
                if box is not None:
                    lowest.append(box[0])
                    highest.append(box[1])
        if lowest:
            low, high = np.min(lowest, axis=0), np.max(highest, axis=0)
            yield name, (*low.tolist(), *high.tolist())


def _is_drawn(prim: Any) -> bool:
    from pxr import UsdGeom, UsdPhysics

    purpose = UsdGeom.Imageable(prim).ComputePurpose()
    return not prim.HasAPI(UsdPhysics.CollisionAPI) and purpose in {UsdGeom.Tokens.default_, UsdGeom.Tokens.render}


def _bound_shape(prim: Any, placement: Array) -> tuple[Array, Array] | None:
    """Return the least and the greatest corner of a shape under a placement (4 by 4); None for an unknown or empty one."""
    import numpy as np
    from pxr import UsdGeom

    linear, centre = placement[:3, :3], placement[:3, 3]
    if prim.IsA(UsdGeom.Mesh):
        points = np.array(UsdGeom.Mesh(prim).GetPointsAttr().Get() or (), dtype=float).reshape(-1, 3)
        if not len(points):
            return None
        moved = points @ linear.T + centre
        return moved.min(axis=0), moved.max(axis=0)
    if prim.IsA(UsdGeom.Cube):
        half = np.abs(linear).sum(axis=1) * UsdGeom.Cube(prim).GetSizeAttr().Get() / 2
    elif prim.IsA(UsdGeom.Sphere):
        half = np.linalg.norm(linear, axis=1) * UsdGeom.Sphere(prim).GetRadiusAttr().Get()
    elif prim.IsA(UsdGeom.Cylinder):
        cylinder = UsdGeom.Cylinder(prim)
        along = "XYZ".index(cylinder.GetAxisAttr().Get())
        across = np.linalg.norm(np.delete(linear, along, axis=1), axis=1)
        half = across * cylinder.GetRadiusAttr().Get() + np.abs(linear[:, along]) * cylinder.GetHeightAttr().Get() / 2
    else:
        return None
    return centre - half, centre + half
