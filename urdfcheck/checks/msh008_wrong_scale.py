"""MSH008 reports meshes that are too large or too small for their robot, and COLLADA units that programs read differently."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from urdfcheck.core import Edit, FactUnavailableError, Finding, Rule
from urdfcheck.core.text import join_names
from urdfcheck.model import Model
from urdfcheck.model.meshes import MeshUse
from urdfcheck.model.shapes.solids import compute_drawn_scale

# What CAD systems write files in, in metres per unit.
UNITS = {"millimetres": 0.001, "inches": 0.0254, "centimetres": 0.01}
# A declared unit this close to the metre is the metre.
UNIT_TOLERANCE = 1e-3
# A scale below this was meant to turn millimetres, centimetres or inches into metres.
MAX_CONVERSION_SCALE = 0.03


def check(model: Model, rule: Rule, *, largest: float, ratio: float, smallest: float) -> Iterator[Finding]:
    reach = _measure_reach(model)
    sizes = _SizeLimits(reach, smallest, max(largest, ratio * reach))
    by_unit: dict[float, list[MeshUse]] = {}
    by_file: dict[tuple[str, str], list[tuple[MeshUse, float]]] = {}
    for use in model.meshes.uses:
        facts, drawn, scale = model.meshes.get_facts(use.shape), _measure_drawn_size(model, use), use.shape.size
        if facts is None or drawn is None or scale is None:
            continue
        if facts.unit is not None and abs(facts.unit - 1.0) > UNIT_TOLERANCE and drawn > 0:
            by_unit.setdefault(facts.unit, []).append(use)
        elif sizes.is_too_large(drawn) and any(sizes.is_plausible(drawn * unit) for unit in UNITS.values()):
            by_file.setdefault(("large", use.filename.value), []).append((use, drawn))
        elif (
            drawn < smallest
            and max(map(abs, scale)) < MAX_CONVERSION_SCALE
            and sizes.is_plausible(_measure_size_in_file(model, use))
        ):
            by_file.setdefault(("small", use.filename.value), []).append((use, drawn))
    yield from _check_invalid_units(model, rule)
    for unit, uses in by_unit.items():
        yield _build_unit_finding(model, rule, sizes, unit, uses)
    for (message, mesh), found in by_file.items():
        use, size = found[0]
        units = [unit for unit in UNITS.values() if sizes.is_plausible(size * unit)]
        finding = rule.finding(
            message,
            at=use.filename,
            related=[other.filename for other, _ in found[1:]],
            edits=_propose_edits(model, [u for u, _ in found], None if message == "small" else units),
            mesh=mesh,
            size=size,
            in_file=_measure_size_in_file(model, use),
            scale=" ".join(f"{s:g}" for s in use.shape.size or ()),
            reach=sizes.reach,
            readings=", ".join(
                f"as {name} {size * unit:.2g} m" for name, unit in UNITS.items() if sizes.is_plausible(size * unit)
            ),
        )
        yield _set_all_subjects(finding, (other for other, _ in found))


def _propose_edits(model: Model, uses: list[MeshUse], units: list[float] | None) -> list[Edit]:
    """Edits that give meshes the scale of the one unit that is plausible, or of the metre (None); none where one of them
    cannot be edited. A scale may mirror a mesh, and goes on to."""
    edits: dict[Edit, None] = {}
    for use in uses:
        filename, scale, files = use.filename, use.shape.size, model.source.files
        place, typed = filename.span, filename.owner.attributes.get("scale")
        if scale is None or place is None or place.file not in files or (units is not None and len(units) != 1):
            return []
        new = " ".join(f"{math.copysign(1, s) if units is None else s * units[0]:g}" for s in scale)
        if typed is None:
            end = place.end + 1  # behind the quotation mark
            edits[Edit(files[place.file].make_span(end, end), "", f' scale="{new}"')] = None
        elif typed.literal and typed.span is not None:
            edits[Edit(typed.span, typed.typed, new)] = None
        else:
            return []
    return list(edits)


def _set_all_subjects(finding: Finding, uses: Iterable[MeshUse]) -> Finding:
    """A finding of every element that uses the meshes: what follows from their size is not told of any of them."""
    return replace(finding, subjects=tuple(dict.fromkeys(use.filename.location.subject for use in uses)))


@dataclass(frozen=True, slots=True)
class _SizeLimits:
    """From ``smallest`` to ``largest`` (m) is what a part can measure of a robot whose links lie within ``reach`` (m)."""

    reach: float
    smallest: float
    largest: float

    def is_too_large(self, size: float) -> bool:
        """Never in a model without extent, which may be a table, a terrain or a building."""
        return self.reach > 0 and size > self.largest

    def is_plausible(self, size: float) -> bool:
        return self.smallest <= size <= self.largest


def _check_invalid_units(model: Model, rule: Rule) -> Iterator[Finding]:
    """Each unit that is none, once for all files that declare it: their exporter is the same."""
    found: dict[str, list[MeshUse]] = {}
    for uses, facts in model.meshes.list_measured():
        if facts.bad_unit is not None:
            found.setdefault(facts.bad_unit, []).extend(uses)
    for declared, users in found.items():
        finding = rule.finding(
            "unit_invalid",
            at=users[0].filename,
            related=[use.filename for use in users[1:]],
            meshes=_describe_declaring_meshes(users),
            declared=declared[:80],
        )
        yield _set_all_subjects(finding, users)


def _describe_declaring_meshes(uses: list[MeshUse]) -> str:
    names = list(dict.fromkeys(use.name for use in uses))
    return f"mesh {names[0]} declares" if len(names) == 1 else f"meshes {join_names(names)} declare"


def _build_unit_finding(model: Model, rule: Rule, sizes: _SizeLimits, unit: float, uses: list[MeshUse]) -> Finding:
    """What programs that read COLLADA's unit, and those that pass over it, make of the same files."""
    drawn = _measure_drawn_size(model, uses[0]) or 0.0
    plain = drawn / unit
    right = {
        (True, False): "it looks right in RViz and is wrong where the unit is passed over",
        (False, True): "it is wrong in RViz and right where the unit is passed over",
    }.get((sizes.is_plausible(drawn), sizes.is_plausible(plain)), "one of them is wrong")
    names = list(dict.fromkeys(use.name for use in uses))
    finding = rule.finding(
        "unit",
        at=uses[0].filename,
        related=[use.filename for use in uses[1:]],
        meshes=_describe_declaring_meshes(uses),
        name=names[0],
        count=len(names),
        unit=unit,
        factor=max(unit, 1.0 / unit),
        drawn=drawn,
        plain=plain,
        right=right,
    )
    return _set_all_subjects(finding, uses)


def _measure_reach(model: Model) -> float:
    """How far from the root the frame of a link is (m), all joints at zero; 0 where that is not known."""
    try:
        return max((float(np.linalg.norm(frame[:3, 3])) for frame in model.frames.values()), default=0.0)
    except FactUnavailableError:
        return 0.0


def _measure_drawn_size(model: Model, use: MeshUse) -> float | None:
    """The longest edge (m) of the box around a mesh as RViz and Gazebo draw it; None when it is not known or not finite."""
    facts, scale = model.meshes.get_facts(use.shape), compute_drawn_scale(model, use.shape)
    if facts is None or scale is None:
        return None
    with np.errstate(over="ignore", invalid="ignore"):
        edge = float((np.ptp(facts.bounds, axis=0) * np.abs(scale)).max())
    return edge if np.isfinite(edge) else None


def _measure_size_in_file(model: Model, use: MeshUse) -> float:
    """The longest edge of the box around a mesh, in file units."""
    facts = model.meshes.get_facts(use.shape)
    return 0.0 if facts is None else float(np.ptp(facts.bounds, axis=0).max())
