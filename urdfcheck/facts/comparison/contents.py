"""What differs in mass and shapes, body by body: how fixed joints split a body into links does not count."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from urdfcheck.core.mechanism import NO_TRACE, MechanismLink, MechanismShape, Trace
from urdfcheck.core.model_diff import MechanismChange
from urdfcheck.core.records import dataclass
from urdfcheck.facts.arrays import Array, Mat3, Mat4, Vec3
from urdfcheck.facts.comparison.alignment import (
    PlacedPair,
    build_tensor,
    is_same_geometry,
    is_same_placement,
    is_same_tensor,
)
from urdfcheck.facts.comparison.bodies import BodyPair
from urdfcheck.facts.comparison.home_pose import LENGTH_TOLERANCE, is_same_number, measure_shift
from urdfcheck.facts.comparison.surfaces import SurfaceComparison
from urdfcheck.facts.inertials.inertia_tensor import compute_parallel_axis_term, compute_principal_moments

# Share of what links of a body gain and lose together that may remain: they only share the mass of the body otherwise.
_SHARED, _ROUNDING = 1e-3, 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class BodyInertia:
    """Mass, COM and tensor of several links together, about the COM in the axes of the anchor frame."""

    mass: float
    com: Vec3
    tensor: Mat3


def sum_inertias(parts: Sequence[tuple[MechanismLink, Mat4]]) -> BodyInertia | None:
    """Sum the inertials of links whose frames are given; None where one of them is incomplete."""
    known = [(link, frame) for link, frame in parts if link.has_inertial]
    if any(link.mass is None or not link.com or not link.tensor for link, _ in known):
        return None
    total = sum(link.mass or 0.0 for link, _ in known)
    places = [frame[:3, :3] @ np.array(link.com) + frame[:3, 3] for link, frame in known]
    weighted = sum(((link.mass or 0.0) * place for (link, _), place in zip(known, places, strict=True)), np.zeros(3))
    com = weighted / total if total else np.zeros(3)
    tensor = np.zeros((3, 3))
    for (link, frame), place in zip(known, places, strict=True):
        tensor += build_tensor(link, frame) + compute_parallel_axis_term(link.mass or 0.0, place - com)
    return BodyInertia(total, com, tensor)


def is_same_body(first: BodyInertia | None, second: BodyInertia | None) -> bool:
    """Whether two bodies are one mass distribution in different digits; unknown ones are not."""
    if first is None or second is None or not is_same_number(first.mass, second.mass):
        return False
    if first.mass and float(np.linalg.norm(second.com - first.com)) > LENGTH_TOLERANCE:
        return False
    return is_same_tensor(first.tensor, second.tensor)


# -- masses ------------------------------------------------------------------------------------------------------------


def compare_masses(pair: PlacedPair, body: BodyPair) -> Iterator[MechanismChange]:
    """Yield what differs in the mass of a body, link by link unless only the share of the links differs."""
    before, after = pair.before, pair.after
    olds = [(before.links[name], pair.maps[name] @ before.frames[name]) for name in body.before]
    news = [(after.links[name], after.frames[name]) for name in body.after]
    if is_same_body(sum_inertias(olds), sum_inertias(news)) and _is_only_shared_otherwise(pair, olds, news):
        return
    for link, frame in olds:
        new = pair.match.links.get(link.name)
        if new is not None:
            yield from _compare_link_inertials(link, frame, after.links[new], after.frames[new])


def _is_only_shared_otherwise(
    pair: PlacedPair, olds: Sequence[tuple[MechanismLink, Mat4]], news: Sequence[tuple[MechanismLink, Mat4]]
) -> bool:
    """Whether what some links of a body lost others have: a light link may change by much, and the body by almost nothing."""
    before = {pair.match.links.get(link.name, ""): _compute_moments(link, frame) for link, frame in olds}
    gone = [_compute_moments(link, frame) for link, frame in olds if link.name not in pair.match.links]
    after = {link.name: _compute_moments(link, frame) for link, frame in news}
    nothing = np.zeros(10)
    names = (before.keys() | after.keys()) - {""}
    shifts = np.array([*(after.get(name, nothing) - before.get(name, nothing) for name in names), *(-m for m in gone)])
    sizes = np.abs(shifts).sum(axis=0)
    # A moment that is zero but for rounding has no share; those of one order have one unit.
    noise = np.repeat([_ROUNDING * part.max() for part in (sizes[:1], sizes[1:4], sizes[4:])], (1, 3, 6))
    return bool(np.all(np.abs(shifts.sum(axis=0)) <= _SHARED * sizes + noise))


def _compute_moments(link: MechanismLink, frame: Mat4) -> Array:
    """Return mass, first moments and the six second moments (10,) about the anchor of a link whose frame is given."""
    if not link.mass or not link.com or not link.tensor:
        return np.zeros(10)
    place = frame[:3, :3] @ np.array(link.com) + frame[:3, 3]
    tensor = build_tensor(link, frame) + compute_parallel_axis_term(link.mass, place)
    return np.array((link.mass, *(link.mass * place), *tensor[np.triu_indices(3)]))


def _compare_link_inertials(
    first: MechanismLink, here: Mat4, second: MechanismLink, there: Mat4
) -> Iterator[MechanismChange]:
    def make(name: str, numbers: dict[str, float]) -> MechanismChange:
        fallback = "mass" if first.has_inertial else "link"
        return MechanismChange(
            category="dynamic",
            id=name,
            subject=f"link[{first.name}]",
            new_name="" if first.name == second.name else second.name,
            numbers=numbers,
            before=first.traces.get(name, first.traces.get(fallback, NO_TRACE)),
            after=second.traces.get(name, second.traces.get("link", NO_TRACE)),
        )

    if not is_same_number(first.mass or 0.0, second.mass or 0.0):
        yield make("mass", {"before": first.mass or 0.0, "after": second.mass or 0.0})
    if bool(first.mass) != bool(second.mass):
        return  # COM and tensor came or went with the mass
    if first.com and second.com:
        places = [frame[:3, :3] @ np.array(link.com) + frame[:3, 3] for link, frame in ((first, here), (second, there))]
        distance = float(np.linalg.norm(places[1] - places[0]))
        if distance > LENGTH_TOLERANCE:
            local = there[:3, :3].T @ (places[1] - places[0])
            shift = {f"shift_{name}": float(value) for name, value in zip("xyz", local, strict=True)}
            yield make("com", {"distance": distance, **shift})
    if bool(first.tensor) != bool(second.tensor):
        yield make("tensor", {})
    elif first.tensor and second.tensor:
        one, two = build_tensor(first, here), build_tensor(second, there)
        if not is_same_tensor(one, two):
            old, new = compute_principal_moments(one)[0], compute_principal_moments(two)[0]
            moments = {f"before_{n}": float(v) for n, v in zip("123", old, strict=True)}
            moments |= {f"after_{n}": float(v) for n, v in zip("123", new, strict=True)}
            yield make("tensor", moments)


# -- shapes ------------------------------------------------------------------------------------------------------------


# A shape, the name of its link, and where the frame of that link is in the second version.
_Placed = tuple[str, MechanismShape, Mat4]


def compare_shapes(
    pair: PlacedPair, bodies: Sequence[BodyPair], surfaces: SurfaceComparison
) -> Iterator[MechanismChange]:
    """Yield what differs in the shapes of links that both versions have, and their materials.

    Shapes that a body has in both versions are set aside first, whatever links of it they are given in. ``surfaces`` measures
    meshes that were replaced.
    """
    olds: list[_Placed] = []
    news: list[_Placed] = []
    for body in bodies:
        here = [(n, s, pair.maps[n] @ pair.before.frames[n]) for n in body.before for s in pair.before.links[n].shapes]
        there = [(n, s, pair.after.frames[n]) for n in body.after for s in pair.after.links[n].shapes]
        yield from _set_aside(pair, here, there)
        olds += here
        news += there
    yield from _set_aside(pair, olds, news)  # of links that are part of another body now
    for name, shape, frame in olds:
        if name not in pair.match.links:
            continue  # it went with its link
        new = pair.match.links[name]
        place = next((i for i, (owner, other, _) in enumerate(news) if owner == new and other.role == shape.role), None)
        if place is None:
            yield _change_shape(shape.role, "shape-removed", name, before=shape)
            continue
        _, other, there_frame = news.pop(place)
        yield from _compare_pair(name, shape, other, frame, there_frame, surfaces)
    known = set(pair.match.links.values())
    for owner, shape, _ in news:
        if owner in known:
            yield _change_shape(shape.role, "shape-added", owner, after=shape)


def list_lost_shapes(pair: PlacedPair, bodies: Sequence[BodyPair]) -> tuple[set[str], set[str]]:
    """Return the links of either version of which a shape is nowhere in the same body of the other version."""
    olds, news = set(), set()
    for body in bodies:
        here = [(n, s, pair.maps[n] @ pair.before.frames[n]) for n in body.before for s in pair.before.links[n].shapes]
        there = [(n, s, pair.after.frames[n]) for n in body.after for s in pair.after.links[n].shapes]
        list(_set_aside(pair, here, there))
        olds |= {name for name, _, _ in here}
        news |= {name for name, _, _ in there}
    return olds, news


def has_moved_shapes(pair: PlacedPair, before: Sequence[str], after: Sequence[str]) -> bool:
    """Whether the collision shapes of links of one body are others, or elsewhere on the first of the links."""
    taken = pair.maps[before[0]]
    here = [(n, s, taken @ pair.before.frames[n]) for n in before for s in pair.before.links[n].shapes]
    there = [(n, s, pair.after.frames[n]) for n in after for s in pair.after.links[n].shapes]
    olds, news = ([placed for placed in side if placed[1].role == "collision"] for side in (here, there))
    list(_set_aside(pair, olds, news))
    return bool(olds or news)


def _set_aside(pair: PlacedPair, olds: list[_Placed], news: list[_Placed]) -> Iterator[MechanismChange]:
    """Remove from both lists what is the same in them; yield the changes of its materials."""
    places = np.array([_locate_shape(shape, frame) for _, shape, frame in news]).reshape(-1, 3)
    taken: set[int] = set()
    matched: set[int] = set()
    for number, (name, shape, frame) in enumerate(olds):
        apart = np.linalg.norm(places - _locate_shape(shape, frame), axis=1)
        near = [int(index) for index in np.flatnonzero(apart <= LENGTH_TOLERANCE) if int(index) not in taken]
        # Of equal shapes the one of the same link, for its colour.
        for index in sorted(near, key=lambda index: news[index][0] != pair.match.links.get(name)):
            _, other, there = news[index]
            if (
                other.role == shape.role
                and is_same_geometry(shape, other)
                and is_same_placement(shape, frame, other, there)
            ):
                taken.add(index)
                matched.add(number)
                yield from _compare_materials(name, shape, other)
                break
    olds[:] = [placed for number, placed in enumerate(olds) if number not in matched]
    news[:] = [placed for index, placed in enumerate(news) if index not in taken]


def _locate_shape(shape: MechanismShape, frame: Mat4) -> Vec3:
    """Return where the origin of a shape is; that of its link where its own is malformed."""
    if not shape.pose:
        return frame[:3, 3]
    place: Vec3 = frame[:3, :3] @ np.array((shape.pose[3], shape.pose[7], shape.pose[11])) + frame[:3, 3]
    return place


def _compare_pair(
    link: str,
    first: MechanismShape,
    second: MechanismShape,
    here: Mat4,
    there: Mat4,
    surfaces: SurfaceComparison,
) -> Iterator[MechanismChange]:
    if not is_same_geometry(first, second):
        yield _compare_geometries(link, first, second, surfaces.measure(first, here, second, there))
    if first.pose and second.pose and not is_same_placement(first, here, second, there):
        one, two = here @ np.array(first.pose).reshape(4, 4), there @ np.array(second.pose).reshape(4, 4)
        distance, angle = measure_shift(one, two)
        numbers = {"distance": distance, "angle": angle}
        yield _change_shape(first.role, "shape-moved", link, before=first, after=second, numbers=numbers, trace="pose")
    elif bool(first.pose) != bool(second.pose):
        yield _change_shape(first.role, "shape-pose", link, before=first, after=second, trace="pose")
    yield from _compare_materials(link, first, second)


def _compare_geometries(
    link: str, first: MechanismShape, second: MechanismShape, distances: Mapping[str, float]
) -> MechanismChange:
    """Return the change of a shape that has another form, another size or another file.

    ``distances``: how far the surfaces are from each other, where that was measured.
    """
    numbers: dict[str, float] = {}
    if first.volume is not None and second.volume is not None:
        numbers |= {"volume_before": abs(first.volume), "volume_after": abs(second.volume)}
    words = {"before": _describe_shape(first), "after": _describe_shape(second)}
    if first.kind == second.kind == "mesh" and first.mesh != second.mesh:
        if words["before"] == words["after"]:
            words |= {"before": first.mesh, "after": second.mesh}
        if not (first.digest and second.digest):
            read = {(False, True): "only now", (True, False): "no longer", (False, False): "neither"}
            words["read"] = read[bool(first.digest), bool(second.digest)]
    what = "shape-replaced"
    if first.kind == second.kind == "mesh" and first.mesh == second.mesh and first.digest != second.digest:
        what = "mesh-changed"
        words = {"shape": _describe_shape(second)}
    elif first.kind == second.kind != "mesh" or (
        first.kind == second.kind == "mesh" and _has_one_content(first, second)
    ):
        what = "shape-resized"
    if what != "shape-resized" and first.low and second.low and first.kind == second.kind:
        bounds = np.array((first.low, first.high)), np.array((second.low, second.high))
        numbers["bounds"] = float(np.abs(bounds[1] - bounds[0]).max())
        if first.closed != second.closed:
            words["closed"] = "closed" if second.closed else "open"
        numbers |= distances
    return _change_shape(
        first.role, what, link, before=first, after=second, numbers=numbers, words=words, trace="geometry"
    )


def _has_one_content(first: MechanismShape, second: MechanismShape) -> bool:
    return first.digest == second.digest if first.digest and second.digest else first.mesh == second.mesh


def _describe_shape(shape: MechanismShape) -> str:
    sizes = " × ".join(f"{value:.4g}" for value in shape.size)
    if shape.kind != "mesh":
        return f"{shape.kind or 'unknown shape'} {sizes}".strip()
    scale = "" if all(value == 1.0 for value in shape.size) else f" × {sizes}"
    return f"{shape.mesh.rpartition('/')[2]}{scale}"


def _compare_materials(link: str, first: MechanismShape, second: MechanismShape) -> Iterator[MechanismChange]:
    is_same = len(first.color) == len(second.color) and all(
        abs(a - b) < 1e-6 for a, b in zip(first.color, second.color, strict=True)
    )
    if first.role == "visual" and not (is_same and first.texture == second.texture):
        yield _change_shape("visual", "material", link, before=first, after=second, trace="material")


def _change_shape(
    role: str,
    name: str,
    link: str,
    *,
    before: MechanismShape | None = None,
    after: MechanismShape | None = None,
    numbers: dict[str, float] | None = None,
    words: dict[str, str] | None = None,
    trace: str = "shape",
) -> MechanismChange:
    def find_trace(shape: MechanismShape | None) -> Trace:
        return NO_TRACE if shape is None else shape.traces.get(trace, NO_TRACE)

    only = after or before
    shown = {} if words or only is None else {"shape": _describe_shape(only)}
    return MechanismChange(
        category=role,
        id=name,
        subject=f"link[{link}]",
        numbers=numbers or {},
        words={"role": role, **shown, **(words or {})},
        before=find_trace(before),
        after=find_trace(after),
    )
