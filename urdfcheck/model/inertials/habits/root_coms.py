"""COMs in the frame of the root, at the zero pose: what a program reports for a whole assembly."""

from __future__ import annotations

from urdfcheck.core import FactUnavailableError
from urdfcheck.facts.inertials.hull_bounds import measure_extent, measure_hull_distance
from urdfcheck.model.fact import fact
from urdfcheck.model.likeness.declared_inertials import read_declared_inertial
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.visual_solid import measure_link_geometry

# A COM is outside a part beyond this share of its size, and inside up to that share of it. Chosen so that a motor that is not
# drawn makes no such COM, and that three links hardly fit the frame of the root, and not their own, by chance.
_OUTSIDE, _INSIDE, _FEWEST = 0.5, 0.02, 3


@fact
def find_root_coms(model: Model) -> frozenset[str]:
    """Find the links whose COM is far outside what they draw, and inside if it is in the frame of the root; none unless
    several links prove it."""
    try:
        frames = model.frames
    except FactUnavailableError:
        return frozenset()
    found = set()
    for name, link in model.link_by_name.items():
        drawn, declared = measure_link_geometry(model, link), read_declared_inertial(link)
        if drawn is None or declared is None:
            continue
        size, frame = measure_extent(drawn.points), frames[name]
        in_link = frame[:3, :3].T @ (declared.com - frame[:3, 3])
        off = [measure_hull_distance(drawn.points, com) for com in (declared.com, in_link)]
        if off[0] > _OUTSIDE * size and off[1] <= _INSIDE * size:
            found.add(name)
    return frozenset(found) if len(found) >= _FEWEST else frozenset()
