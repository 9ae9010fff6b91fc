"""Collision geometry that simulators can use: fitted primitives, convex parts, or meshes with fewer triangles."""

from __future__ import annotations

import math
import re
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np

from urdfcheck.core import FactUnavailableError, Span
from urdfcheck.core.records import dataclass
from urdfcheck.facts.arrays import Array, Indices
from urdfcheck.facts.mesh.convex_hull import compute_convex_hull
from urdfcheck.facts.mesh.measure import MeshFacts
from urdfcheck.facts.mesh.primitive_fit import FittedPrimitive, fit_primitives
from urdfcheck.fix.repair.mesh_writing import decimate, split_convex, write_stl
from urdfcheck.fix.repair.steps import RepairOptions, RepairStep
from urdfcheck.fix.repair.texts import ElementText, write_numbers, write_origin
from urdfcheck.model import Model
from urdfcheck.model.fact import fact
from urdfcheck.model.meshes import MeshUse
from urdfcheck.model.shapes.solids import compute_drawn_scale

# A closed mesh whose convex hull is this many times as large has hollows that a primitive would fill.
_CONCAVE = 1.5
# Digits of a size: a tessellated circle of 0.03 m measures 0.0300015 m.
_SIZE_DIGITS = 4
# A mesh whose hull is at most this share larger is convex already.
_CONVEX = 1.02
# Of the time of the stage.
_SHARE = 0.5
_NAME = re.compile(r"""\sname\s*=\s*("[^"]*"|'[^']*')""")
_ENDING = re.compile(r"\.\w+$")


@dataclass(frozen=True, slots=True, eq=False)
class _Collision:
    """A collision that is a mesh, with what was measured on it."""

    use: MeshUse
    facts: MeshFacts
    scale: tuple[float, float, float]
    """Metres per unit of the file."""
    path: Path

    @property
    def hull_volume(self) -> float:
        """In m³."""
        return self.facts.hull.volume * abs(math.prod(self.scale))

    @property
    def concavity(self) -> float | None:
        """How many times as large as the mesh its hull is; None where the mesh is open."""
        if not self.facts.closed or not abs(self.facts.volume) > 0.0:
            return None
        return self.facts.hull.volume / abs(self.facts.volume)


@dataclass(frozen=True, slots=True, eq=False)
class _Proposal:
    """What replaces the text of a collision, or why nothing does (``text`` is None)."""

    text: str | None
    words: str
    files: Mapping[str, bytes]
    after: Mapping[str, float]


_LATE = _Proposal(None, "kept: the others took half of the time (--timeout)", {}, {})


def plan_collisions(model: Model, options: RepairOptions, *, seconds: float | None = None) -> Iterator[RepairStep]:
    """Yield a step for each collision mesh. The text that makes several collisions is rewritten only if it fits all of them.

    ``seconds``: how long the stage may take. After half of it the meshes that are left stay as they are: to split one into convex
    parts may take minutes, and is not interrupted.
    """
    late = time.monotonic() + _SHARE * (seconds or math.inf)
    makers: Mapping[str, Callable[[Model, _Collision, RepairOptions], _Proposal]] = {
        "primitives": _propose_primitive,
        "convex": _propose_convex_parts,
        "decimate": _propose_decimated,
    }
    make = makers.get(options.collision)
    if make is None:
        return
    groups: dict[Span | int, list[_Collision]] = {}
    for collision in _iter_collisions(model):
        span = collision.use.shape.element.span
        groups.setdefault(id(collision) if span is None else span, []).append(collision)
    for same in groups.values():
        is_late = time.monotonic() > late
        proposals = [_LATE if is_late else make(model, collision, options) for collision in same]
        yield from _build_steps(model, same, proposals)


def _build_steps(model: Model, same: Sequence[_Collision], proposals: Sequence[_Proposal]) -> Iterator[RepairStep]:
    texts = {proposal.text for proposal in proposals}
    edit = (
        ElementText(model, same[0].use.shape.element).build_edit(next(iter(texts)) or "") if len(texts) == 1 else None
    )
    for place, (collision, proposal) in enumerate(zip(same, proposals, strict=True)):
        before = {"triangles": float(collision.facts.n_triangles), "volume": collision.hull_volume}
        words, done = proposal.words, proposal.text is not None and edit is not None
        if proposal.text is not None and edit is None:
            words = f"not written: the same text makes {len(same)} collisions, which need different ones"
            if len(texts) == 1:
                words = "not written: the collision is typed elsewhere"
        yield RepairStep(
            stage="collision",
            subject=collision.use.link.name,
            text=f"{collision.use.name}: {words}",
            is_done=done,
            edits=(edit,) if done and edit is not None and place == 0 else (),
            files=proposal.files if done else {},
            before=before,
            after=proposal.after if done else {},
        )


def _iter_collisions(model: Model) -> Iterator[_Collision]:
    for use in model.meshes.uses:
        facts, scale = model.meshes.get_facts(use.shape), compute_drawn_scale(model, use.shape)
        path = use.resource.path
        if use.shape.role != "collision" or facts is None or scale is None or path is None or not all(scale):
            continue
        if np.isfinite(facts.bounds).all() and np.isfinite(np.array(scale)).all():
            yield _Collision(use, facts, scale, path)


def _keep(words: str) -> _Proposal:
    return _Proposal(None, words, {}, {})


def _propose_primitive(model: Model, collision: _Collision, options: RepairOptions) -> _Proposal:
    origin = collision.use.shape.origin.matrix
    hull = collision.hull_volume
    if origin is None or not hull > 0.0:
        return _keep("kept: it is flat, or its origin cannot be read")
    concavity = collision.concavity
    if concavity is not None and concavity > _CONCAVE:
        return _keep(f"kept: its convex hull is {concavity:.2g} times as large (--collision convex)")
    try:
        fits = fit_primitives(collision.facts.hull.vertices * np.array(collision.scale))
    except (ValueError, FactUnavailableError):
        return _keep("kept: it is flat")
    best = fits[0]
    if best.kind == "capsule":  # three shapes of URDF 1.0: only where that is much nearer
        simpler = next(fit for fit in fits if fit.kind != "capsule")
        best = simpler if simpler.volume < best.volume + 0.1 * hull else best
    excess = best.volume / hull - 1.0
    if excess > options.max_excess:
        return _keep(f"kept: the nearest primitive, a {best.kind}, has {excess:.0%} more volume than its hull")
    text = _write_primitive(model, collision, best, origin)
    if text is None:
        return _keep("kept: its geometry is typed elsewhere")
    sizes = write_numbers(best.size, _SIZE_DIGITS).replace(" ", " × ")
    count = collision.facts.n_triangles
    words = f"{best.kind} of {sizes} m instead of {count} triangles, {max(0.0, excess):.1%} more volume than their hull"
    return _Proposal(text, words, {}, {"shapes": 3.0 if best.kind == "capsule" else 1.0, "volume": best.volume})


def _write_primitive(model: Model, collision: _Collision, fit: FittedPrimitive, origin: Array) -> str | None:
    sizes = [write_numbers((value,), _SIZE_DIGITS) for value in fit.size]
    if fit.kind == "capsule":
        pieces = _list_capsule_parts(sizes, fit)
    elif fit.kind == "cylinder":
        pieces = [(f'<cylinder radius="{sizes[0]}" length="{sizes[1]}"/>', fit.pose)]
    elif fit.kind == "sphere":
        pieces = [(f'<sphere radius="{sizes[0]}"/>', fit.pose)]
    else:
        pieces = [(f'<box size="{" ".join(sizes)}"/>', fit.pose)]
    shape = collision.use.shape
    texts = []
    for index, (geometry, pose) in enumerate(pieces):
        source = ElementText(model, shape.element)
        if shape.geometry_element is None or not source.replace_element(shape.geometry_element, geometry):
            return None
        if not np.allclose(pose, np.eye(4)) and not _replace_origin(source, collision, write_origin(origin @ pose)):
            return None
        texts.append(source.text if index == 0 else _drop_name(source.text))
    return _join_elements(model, collision, texts)


def _list_capsule_parts(sizes: Sequence[str], fit: FittedPrimitive) -> list[tuple[str, Array]]:
    """Build a capsule, which most parsers do not know, from a cylinder and two spheres."""
    up, down = np.eye(4), np.eye(4)
    up[2, 3], down[2, 3] = fit.size[1] / 2, -fit.size[1] / 2
    ball = f'<sphere radius="{sizes[0]}"/>'
    tube = f'<cylinder radius="{sizes[0]}" length="{sizes[1]}"/>'
    return [(tube, fit.pose), (ball, fit.pose @ up), (ball, fit.pose @ down)]


def _replace_origin(source: ElementText, collision: _Collision, text: str) -> bool:
    shape = collision.use.shape
    typed, geometry = shape.origin.element, shape.element.find_child("geometry")
    if typed is not None:
        return source.replace_element(typed, text)
    return geometry is not None and source.insert_before(geometry, text)


def _propose_convex_parts(model: Model, collision: _Collision, options: RepairOptions) -> _Proposal:
    if not collision.facts.hull.volume > 0.0:
        return _keep("kept: it is flat")
    facts, concavity = collision.facts, collision.concavity
    if concavity is not None and concavity <= _CONVEX:
        if facts.n_triangles <= options.triangles:
            return _keep("kept: it is convex")
        parts = [(facts.hull.vertices, facts.hull.faces)]
    else:
        parts = list(_split_mesh(model, collision.path, 10 * options.triangles))
    unit = facts.unit or 1.0
    files, texts, volume = {}, [], 0.0
    for index, (points, sides) in enumerate(parts):
        ending = f"_convex_{index}.stl"
        text = _write_mesh_element(model, collision, ending)
        if text is None:
            return _keep("kept: the name of its mesh is typed elsewhere")
        files[str(collision.path.with_suffix("")) + ending] = write_stl(points * unit, sides)
        texts.append(text if index == 0 else _drop_name(text))
        volume += compute_convex_hull(points).volume * abs(math.prod(collision.scale))
    words = f"{len(parts)} convex part{'s' if len(parts) != 1 else ''} instead of {facts.n_triangles} triangles"
    count = sum(len(sides) for _, sides in parts)
    after = {"shapes": float(len(parts)), "triangles": float(count), "volume": volume}
    return _Proposal(_join_elements(model, collision, texts), words, files, after)


@fact
def _split_mesh(model: Model, path: Path, triangles: int) -> tuple[tuple[Array, Indices], ...]:
    """Split a mesh file into convex parts, once for all its uses; larger ones are decimated before."""
    facts = model.meshes.facts[path]
    vertices, faces = decimate(facts.vertices, facts.faces, triangles)
    return tuple(split_convex(vertices, faces))


def _propose_decimated(model: Model, collision: _Collision, options: RepairOptions) -> _Proposal:
    facts = collision.facts
    if facts.n_triangles <= options.triangles:
        return _keep(f"kept: it has {facts.n_triangles} triangles")
    points, faces = decimate(facts.vertices, facts.faces, options.triangles)
    if not len(faces) or len(faces) >= facts.n_triangles:
        return _keep("kept: fewer triangles would not have its shape")
    ending = "_collision.stl"
    text = _write_mesh_element(model, collision, ending)
    if text is None:
        return _keep("kept: the name of its mesh is typed elsewhere")
    old, new = facts.hull.volume, compute_convex_hull(points).volume
    change = 0.0 if not old > 0.0 else new / old - 1.0
    words = f"{len(faces)} instead of {facts.n_triangles} triangles; the hull has {change:+.1%} volume"
    name = str(collision.path.with_suffix("")) + ending
    after = {"triangles": float(len(faces)), "volume": new * abs(math.prod(collision.scale))}
    return _Proposal(text, words, {name: write_stl(points * (facts.unit or 1.0), faces)}, after)


def _write_mesh_element(model: Model, collision: _Collision, ending: str) -> str | None:
    """Write the collision with another mesh beside its own: only the end of the file's name changes, so macros stay."""
    typed = collision.use.filename.typed
    if not _ENDING.search(typed) or collision.path.suffix.lower() != Path(typed).suffix.lower():
        return None
    source = ElementText(model, collision.use.shape.element)
    return source.text if source.replace_value(collision.use.filename, _ENDING.sub(ending, typed)) else None


def _drop_name(text: str) -> str:
    """Drop the name of a collision, which is that of the first."""
    head, closed, rest = text.partition(">")
    return f"{_NAME.sub('', head, count=1)}{closed}{rest}"


def _join_elements(model: Model, collision: _Collision, texts: Sequence[str]) -> str:
    """Join elements with the indentation of the first."""
    span = collision.use.shape.element.span
    if span is None or span.file not in model.source.files:
        return "\n".join(texts)
    whole = model.source.files[span.file].text
    line = whole[whole.rfind("\n", 0, span.start) + 1 : span.start]
    return ("\n" + line if not line.strip() else "").join(texts)
