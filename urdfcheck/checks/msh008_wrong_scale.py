"""MSH008: meshes are as large as the robot that they belong to, in every program alike."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from urdfcheck.core import Edit, Finding, Rule, Unavailable
from urdfcheck.core.text import listed
from urdfcheck.model import Model
from urdfcheck.model.meshes import MeshUse

# What CAD systems write files in, in metres per unit.
UNITS = {"millimetres": 0.001, "inches": 0.0254, "centimetres": 0.01}
# A declared unit this close to the metre is the metre.
SAME = 1e-3
# A scale below this was meant to turn millimetres, centimetres or inches into metres.
CONVERTING = 0.03


def check(model: Model, rule: Rule, *, largest: float, ratio: float, smallest: float) -> Iterator[Finding]:
    reach = _reach(model)
    sizes = _Sizes(reach, smallest, max(largest, ratio * reach))
    by_unit: dict[float, list[MeshUse]] = {}
    by_file: dict[tuple[str, str], list[tuple[MeshUse, float]]] = {}
    for use in model.meshes.uses:
        facts, drawn, scale = model.meshes.facts_of(use.shape), _drawn(model, use), use.shape.size
        if facts is None or drawn is None or scale is None:
            continue
        if facts.unit is not None and abs(facts.unit - 1.0) > SAME and drawn > 0:
            by_unit.setdefault(facts.unit, []).append(use)
        elif sizes.too_large(drawn) and any(sizes.plausible(drawn * unit) for unit in UNITS.values()):
            by_file.setdefault(("large", use.filename.value), []).append((use, drawn))
        elif drawn < smallest and max(map(abs, scale)) < CONVERTING and sizes.plausible(_in_file(model, use)):
            by_file.setdefault(("small", use.filename.value), []).append((use, drawn))
    yield from _invalid(model, rule)
    for unit, uses in by_unit.items():
        yield _declared(model, rule, sizes, unit, uses)
    for (message, mesh), found in by_file.items():
        use, size = found[0]
        units = [unit for unit in UNITS.values() if sizes.plausible(size * unit)]
        finding = rule.finding(
            message,
            at=use.filename,
            related=[other.filename for other, _ in found[1:]],
            edits=_rescaled(model, [u for u, _ in found], None if message == "small" else units),
            mesh=mesh,
            size=size,
            in_file=_in_file(model, use),
            scale=" ".join(f"{s:g}" for s in use.shape.size or ()),
            reach=sizes.reach,
            readings=", ".join(
                f"as {name} {size * unit:.2g} m" for name, unit in UNITS.items() if sizes.plausible(size * unit)
            ),
        )
        yield _of_all(finding, (other for other, _ in found))


def _rescaled(model: Model, uses: list[MeshUse], units: list[float] | None) -> list[Edit]:
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
            edits[Edit(files[place.file].span(end, end), "", f' scale="{new}"')] = None
        elif typed.literal and typed.span is not None:
            edits[Edit(typed.span, typed.typed, new)] = None
        else:
            return []
    return list(edits)


def _of_all(finding: Finding, uses: Iterable[MeshUse]) -> Finding:
    """A finding of every element that uses the meshes: what follows from their size is not told of any of them."""
    return replace(finding, subjects=tuple(dict.fromkeys(use.filename.location.subject for use in uses)))


@dataclass(frozen=True, slots=True)
class _Sizes:
    """From ``smallest`` to ``largest`` (m) is what a part can measure of a robot whose links lie within ``reach`` (m)."""

    reach: float
    smallest: float
    largest: float

    def too_large(self, size: float) -> bool:
        """Never in a model without extent, which may be a table, a terrain or a building."""
        return self.reach > 0 and size > self.largest

    def plausible(self, size: float) -> bool:
        return self.smallest <= size <= self.largest


def _invalid(model: Model, rule: Rule) -> Iterator[Finding]:
    """Each unit that is none, once for all files that declare it: their exporter is the same."""
    found: dict[str, list[MeshUse]] = {}
    for uses, facts in model.meshes.measured():
        if facts.bad_unit is not None:
            found.setdefault(facts.bad_unit, []).extend(uses)
    for declared, users in found.items():
        finding = rule.finding(
            "unit_invalid",
            at=users[0].filename,
            related=[use.filename for use in users[1:]],
            meshes=_declaring(users),
            declared=declared[:80],
        )
        yield _of_all(finding, users)


def _declaring(uses: list[MeshUse]) -> str:
    names = list(dict.fromkeys(use.name for use in uses))
    return f"mesh {names[0]} declares" if len(names) == 1 else f"meshes {listed(names)} declare"


def _declared(model: Model, rule: Rule, sizes: _Sizes, unit: float, uses: list[MeshUse]) -> Finding:
    """What programs that read COLLADA's unit, and those that pass over it, make of the same files."""
    drawn = _drawn(model, uses[0]) or 0.0
    plain = drawn / unit
    right = {
        (True, False): "it looks right in RViz and is wrong where the unit is passed over",
        (False, True): "it is wrong in RViz and right where the unit is passed over",
    }.get((sizes.plausible(drawn), sizes.plausible(plain)), "one of them is wrong")
    names = list(dict.fromkeys(use.name for use in uses))
    finding = rule.finding(
        "unit",
        at=uses[0].filename,
        related=[use.filename for use in uses[1:]],
        meshes=_declaring(uses),
        name=names[0],
        count=len(names),
        unit=unit,
        factor=max(unit, 1.0 / unit),
        drawn=drawn,
        plain=plain,
        right=right,
    )
    return _of_all(finding, uses)


def _reach(model: Model) -> float:
    """How far from the root the frame of a link is (m), all joints at zero; 0 where that is not known."""
    try:
        return max((float(np.linalg.norm(frame[:3, 3])) for frame in model.frames.values()), default=0.0)
    except Unavailable:
        return 0.0


def _drawn(model: Model, use: MeshUse) -> float | None:
    """The longest edge (m) of the box around a mesh as RViz and Gazebo draw it; None when it is not known or not finite."""
    facts, scale = model.meshes.facts_of(use.shape), model.drawn_scale(use.shape)
    if facts is None or scale is None:
        return None
    with np.errstate(over="ignore", invalid="ignore"):
        edge = float((np.ptp(facts.bounds, axis=0) * np.abs(scale)).max())
    return edge if np.isfinite(edge) else None


def _in_file(model: Model, use: MeshUse) -> float:
    """The longest edge of the box around a mesh, in file units."""
    facts = model.meshes.facts_of(use.shape)
    return 0.0 if facts is None else float(np.ptp(facts.bounds, axis=0).max())
