"""MSH008 reports meshes of the wrong size for their robot, and COLLADA units that programs read differently."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from urdfcheck.core import Edit, FactUnavailableError, Finding, Rule
from urdfcheck.core.records import dataclass
from urdfcheck.core.text import join_names, join_numbers
from urdfcheck.facts.inertials.materials import is_part_density
from urdfcheck.model import Model
from urdfcheck.model.meshes import MeshUse
from urdfcheck.model.repairs.edits import edit_numbers
from urdfcheck.model.shapes.solids import compute_drawn_scale, measure_shape_solid

# The units of CAD systems, in metres.
UNITS = {"millimetres": 0.001, "inches": 0.0254, "centimetres": 0.01}
# A declared unit this close to the metre is the metre.
UNIT_TOLERANCE = 1e-3
# A scale below this was meant to convert millimetres, centimetres or inches to metres.
MAX_CONVERSION_SCALE = 0.03
# Four times the largest part (m) that published robots have.
ENLARGED = 20.0
# A part that measures more than this in all three directions (m) is not a ground plane or a wall.
MIN_ENLARGED = 1.0
# What MoveIt does with a mesh that is only drawn.
_DRAWN_ONLY = {"moveit": "loads no visual mesh"}


def check(model: Model, rule: Rule, *, largest: float, ratio: float, smallest: float) -> Iterator[Finding]:
    reach = _measure_reach(model)
    sizes = _SizeLimits(reach, smallest, max(largest, ratio * reach))
    meshes = [mesh for use in model.meshes.uses if (mesh := _measure_mesh(model, use)) is not None]
    yield from _check_invalid_units(model, rule)
    yield from _check_units(rule, sizes, meshes)
    yield from _check_sizes(model, rule, sizes=sizes, meshes=[mesh for mesh in meshes if mesh.unit is None])


@dataclass(frozen=True, slots=True)
class _SizeLimits:
    """The sizes that a part of a robot can have."""

    reach: float
    """The greatest distance of a link from the root (m)."""
    smallest: float
    """m"""
    largest: float
    """m"""

    def is_too_large(self, size: float) -> bool:
        """Whether a part is too large; never in a model without extent, which may be a table, a terrain or a building."""
        return self.reach > 0 and size > self.largest

    def is_plausible(self, size: float) -> bool:
        return self.smallest <= size <= self.largest

    def list_plausible_units(self, size: float) -> dict[str, float]:
        """Return the units that give a part of this many file units a plausible size."""
        return {name: unit for name, unit in UNITS.items() if self.is_plausible(size * unit)}


@dataclass(frozen=True, slots=True, eq=False)
class _MeasuredMesh:
    """A use of a mesh whose size is known."""

    use: MeshUse
    size: float
    """Of the longest edge of its box as RViz and Gazebo draw it (m)."""
    unit: float | None
    """The unit (m) that a COLLADA file declares, None for the metre."""


def _measure_mesh(model: Model, use: MeshUse) -> _MeasuredMesh | None:
    """Measure a mesh; None if its size is unknown or not finite."""
    facts, scale = model.meshes.get_facts(use.shape), compute_drawn_scale(model, use.shape)
    if facts is None or scale is None or use.shape.size is None:
        return None
    with np.errstate(over="ignore", invalid="ignore"):
        size = float((np.ptp(facts.bounds, axis=0) * np.abs(scale)).max())
    if not np.isfinite(size):
        return None
    foreign = facts.unit is not None and abs(facts.unit - 1.0) > UNIT_TOLERANCE and size > 0
    return _MeasuredMesh(use, size, facts.unit if foreign else None)


def _check_invalid_units(model: Model, rule: Rule) -> Iterator[Finding]:
    """Report each invalid unit once for all files that declare it: one exporter wrote them."""
    by_unit: dict[str, list[MeshUse]] = {}
    for uses, facts in model.meshes.list_measured():
        if facts.bad_unit is not None:
            by_unit.setdefault(facts.bad_unit, []).extend(uses)
    for declared, users in by_unit.items():
        finding = rule.finding(
            "unit_invalid",
            at=users[0].filename,
            related=[use.filename for use in users[1:]],
            consequences=None if _has_collision(users) else _DRAWN_ONLY,
            meshes=_describe_declaring_meshes(users),
            declared=declared[:80],
        )
        yield _set_all_subjects(finding, users)


def _check_units(rule: Rule, sizes: _SizeLimits, meshes: Iterable[_MeasuredMesh]) -> Iterator[Finding]:
    """Report each unit other than the metre once for all files that declare it."""
    by_unit: dict[float, list[_MeasuredMesh]] = {}
    for mesh in meshes:
        if mesh.unit is not None:
            by_unit.setdefault(mesh.unit, []).append(mesh)
    for unit, like in by_unit.items():
        yield _build_unit_finding(rule, sizes, unit=unit, meshes=like)


def _check_sizes(model: Model, rule: Rule, *, sizes: _SizeLimits, meshes: Iterable[_MeasuredMesh]) -> Iterator[Finding]:
    """Report each file of an implausible size that a unit or a scale explains."""
    by_file: dict[tuple[str, str], list[_MeasuredMesh]] = {}
    usual = _find_usual_scale(model)
    for mesh in meshes:
        message = _classify_size(model, mesh, sizes, usual=usual)
        if message is not None:
            by_file.setdefault((message, mesh.use.filename.value), []).append(mesh)
    for (message, name), like in by_file.items():
        use, size = like[0].use, like[0].size
        uses = [mesh.use for mesh in like]
        units = sizes.list_plausible_units(size)
        finding = rule.finding(
            message,
            at=use.filename,
            related=[other.filename for other in uses[1:]],
            # Where the whole robot has the mistake, the mesh alone would be the odd part.
            edits=[]
            if message == "enlarged"
            else _propose_edits(model, uses, [*units.values()], target={"small": 1.0, "twice": usual}.get(message)),
            mesh=name,
            size=size,
            in_file=_measure_size_in_file(model, use),
            scale=join_numbers(use.shape.size or (), separator=" "),
            usual=" ".join([f"{usual:g}"] * 3),
            reach=sizes.reach,
            readings=" or ".join(f"{size * unit:.2g} m in {unit_name}" for unit_name, unit in units.items()),
        )
        yield _set_all_subjects(finding, uses)


def _find_usual_scale(model: Model) -> float:
    """Return the scale that most uses of meshes have along all axes, whatever its signs, if it converts a unit: any other is that
    of parts that were made longer, and says nothing about a unit; else 1."""
    scales = [tuple(abs(part) for part in use.shape.size) for use in model.meshes.uses if use.shape.size is not None]
    counts = Counter(scale[0] for scale in scales if len(set(scale)) == 1)
    usual, count = max(counts.items(), key=lambda item: (item[1], item[0]), default=(1.0, 0))
    return usual if 2 * count > len(scales) and usual < MAX_CONVERSION_SCALE else 1.0


def _classify_size(model: Model, mesh: _MeasuredMesh, sizes: _SizeLimits, *, usual: float) -> str | None:
    """Return what is wrong with the size of a mesh, or None.

    ``large``: it was not converted to metres. ``small``: it was, and is in metres. ``enlarged``: it is in metres, and the inverse
    of a conversion makes it a building. ``twice``: its scale is not the ``usual`` one, with which it has a plausible size: the
    robot's other meshes say more about its unit than a file that would be as large as a part in metres, too.
    """
    if sizes.is_too_large(mesh.size) and sizes.list_plausible_units(mesh.size):
        return "large"
    if _is_enlarged(model, mesh, sizes):
        return "enlarged"
    if mesh.size >= sizes.smallest or max(map(abs, mesh.use.shape.size or (1.0,))) >= MAX_CONVERSION_SCALE:
        return None
    if _weighs_as_drawn(model, mesh.use):
        return None
    in_file = _measure_size_in_file(model, mesh.use)
    if usual != 1.0 and sizes.is_plausible(in_file * usual):
        return "twice"
    return "small" if sizes.is_plausible(in_file) else None


def _weighs_as_drawn(model: Model, use: MeshUse) -> bool:
    """Whether the mass of the link is that of a part as small as the mesh, such as a letter of a logo."""
    solid, inertial = measure_shape_solid(model, use.shape), use.link.inertial
    if solid is None or not solid.volume > 0 or inertial is None or inertial.mass is None:
        return False
    return is_part_density(inertial.mass / solid.volume)


def _is_enlarged(model: Model, mesh: _MeasuredMesh, sizes: _SizeLimits) -> bool:
    """Whether the scale of a mesh in metres makes it far larger than any part, in a robot whose joints are as far apart: the rest
    of it has the same mistake, so its reach shows nothing."""
    facts, scale = model.meshes.get_facts(mesh.use.shape), np.abs(mesh.use.shape.size or (1.0,))
    if facts is None or sizes.reach == 0 or scale.min() * MAX_CONVERSION_SCALE < 1.0:
        return False
    least = float((np.ptp(facts.bounds, axis=0) * scale).min())
    in_file = _measure_size_in_file(model, mesh.use)
    return mesh.size > ENLARGED and least > MIN_ENLARGED and sizes.smallest <= in_file <= ENLARGED


def _propose_edits(
    model: Model, uses: list[MeshUse], units: Sequence[float], *, target: float | None = None
) -> list[Edit]:
    """Return edits that give meshes the scale ``target``, or convert them from the only plausible unit (None).

    Nothing if one of the meshes cannot be edited. Signs stay: a scale may mirror a mesh.
    """
    edits: dict[Edit, None] = {}
    for use in uses:
        filename, scale, files = use.filename, use.shape.size, model.source.files
        place, typed = filename.span, filename.owner.attributes.get("scale")
        if scale is None or place is None or place.file not in files or (target is None and len(units) != 1):
            return []
        new = " ".join(f"{s * units[0] if target is None else math.copysign(target, s):g}" for s in scale)
        if typed is None:
            end = place.end + 1  # behind the quotation mark
            edits[Edit(files[place.file].make_span(end, end), "", f' scale="{new}"')] = None
        else:
            rewritten = edit_numbers(typed, new)
            if not rewritten:
                return []
            edits |= dict.fromkeys(rewritten)
    return list(edits)


def _set_all_subjects(finding: Finding, uses: Iterable[MeshUse]) -> Finding:
    """Make every element that uses the meshes a subject: other rules then do not report consequences of their size."""
    return replace(finding, subjects=tuple(dict.fromkeys(use.filename.location.subject for use in uses)))


def _has_collision(uses: Iterable[MeshUse]) -> bool:
    """Whether one of the meshes is a collision shape, which MoveIt loads, rather than a visual one."""
    return any(use.shape in use.link.collisions for use in uses)


def _describe_declaring_meshes(uses: list[MeshUse]) -> str:
    names = list(dict.fromkeys(use.name for use in uses))
    return f"mesh {names[0]} declares" if len(names) == 1 else f"meshes {join_names(names)} declare"


def _build_unit_finding(rule: Rule, sizes: _SizeLimits, *, unit: float, meshes: Sequence[_MeasuredMesh]) -> Finding:
    """Compare the size in programs that read COLLADA's unit with that in programs that ignore it."""
    uses = [mesh.use for mesh in meshes]
    drawn = meshes[0].size
    plain = drawn / unit
    right = {
        (True, False): "it looks right in RViz and is wrong where the unit is ignored",
        (False, True): "it is wrong in RViz and right where the unit is ignored",
    }.get((sizes.is_plausible(drawn), sizes.is_plausible(plain)), "one of them is wrong")
    names = list(dict.fromkeys(use.name for use in uses))
    finding = rule.finding(
        "unit",
        at=uses[0].filename,
        related=[use.filename for use in uses[1:]],
        consequences=None if _has_collision(uses) else _DRAWN_ONLY,
        meshes=_describe_declaring_meshes(uses),
        unaware="Pinocchio, MoveIt and trimesh" if _has_collision(uses) else "Pinocchio and trimesh",
        name=names[0],
        count=len(names),
        unit=unit,
        factor=max(unit, 1.0 / unit),
        drawn=drawn,
        plain=plain,
        ignored=f"{float(f'{plain:.3g}'):,.6g}",
        right=right,
    )
    return _set_all_subjects(finding, uses)


def _measure_reach(model: Model) -> float:
    """Return the greatest distance of a link frame from the root (m), all joints at zero; 0 if unknown."""
    try:
        return max((float(np.linalg.norm(frame[:3, 3])) for frame in model.frames.values()), default=0.0)
    except FactUnavailableError:
        return 0.0


def _measure_size_in_file(model: Model, use: MeshUse) -> float:
    """Return the longest edge of the box around a mesh, in file units."""
    facts = model.meshes.get_facts(use.shape)
    return 0.0 if facts is None else float(np.ptp(facts.bounds, axis=0).max())
