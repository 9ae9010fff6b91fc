"""MSH008 reports meshes of the wrong size for their robot, and COLLADA units that programs read differently."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

from urdfcheck.core import Edit, Finding, Rule, Severity
from urdfcheck.core.text import join_names, join_numbers
from urdfcheck.model import Model
from urdfcheck.model.meshes import MeshUse
from urdfcheck.model.motion.fixed_base import list_bolted_links
from urdfcheck.model.repairs.edits import edit_numbers
from urdfcheck.model.shapes.mesh_sizes import MeasuredMesh, MeshSizes, SizeLimits, measure_mesh_sizes
from urdfcheck.model.use.display import is_checked_for_collisions
from urdfcheck.model.use.other_programs import names_unitless_program

# Programs that draw a COLLADA file as if it were in metres.
_UNITLESS = frozenset({"drake", "isaac", "mujoco", "newton", "pinocchio", "trimesh", "yourdfpy"})
# What MoveIt does with a mesh that is only drawn.
_DRAWN_ONLY = {"moveit": "loads no visual mesh"}
# What programs do with a mesh of the wrong size that is a collision shape only, and with one that is too small to be met.
_NOT_DRAWN = {"rviz": "loads it: a collision shape, which it draws on request alone"}
_UNTOUCHED = {"gazebo": "nothing touches the part: what collides is a speck", "moveit": "plans through the part"}


def check(model: Model, rule: Rule, *, largest: float, ratio: float, smallest: float) -> Iterator[Finding]:
    sizes = measure_mesh_sizes(model, largest=largest, ratio=ratio, smallest=smallest)
    yield from _check_invalid_units(model, rule)
    yield from _check_units(model, rule, sizes)
    yield from _check_sizes(model, rule, sizes)


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


def _check_units(model: Model, rule: Rule, sizes: MeshSizes) -> Iterator[Finding]:
    """Report each unit other than the metre once for all files that declare it."""
    by_unit: dict[float, list[MeasuredMesh]] = {}
    for mesh in sizes.meshes:
        if mesh.unit is not None:
            by_unit.setdefault(mesh.unit, []).append(mesh)
    for unit, like in by_unit.items():
        yield _build_unit_finding(model, rule, sizes.limits, unit=unit, meshes=like)


def _check_sizes(model: Model, rule: Rule, sizes: MeshSizes) -> Iterator[Finding]:
    """Report each file of an implausible size that a unit or a scale explains."""
    by_file: dict[tuple[str, str], list[MeasuredMesh]] = {}
    for mesh in sizes.meshes:
        if mesh.mistake is not None:
            by_file.setdefault((mesh.mistake, mesh.use.filename.value), []).append(mesh)
    for (message, name), like in by_file.items():
        use, size = like[0].use, like[0].size
        uses = [mesh.use for mesh in like]
        units = sizes.limits.list_plausible_units(size)
        finding = rule.finding(
            message,
            at=use.filename,
            related=[other.filename for other in uses[1:]],
            # Where the whole robot has the mistake, the mesh alone would be the odd part.
            consequences=_describe_effects_of_role(message, uses),
            edits=[]
            if message == "enlarged"
            else _propose_edits(
                model, uses, [*units.values()], target={"small": 1.0, "twice": sizes.usual}.get(message)
            ),
            mesh=name,
            size=size,
            in_file=like[0].in_file,
            scale=join_numbers(use.shape.size or (), separator=" "),
            usual=" ".join([f"{sizes.usual:g}"] * 3),
            reach=sizes.limits.reach,
            readings=" or ".join(f"{size * unit:.2g} m in {unit_name}" for unit_name, unit in units.items()),
        )
        yield _set_all_subjects(finding, uses)


def _describe_effects_of_role(message: str, uses: Sequence[MeshUse]) -> dict[str, str]:
    """Return what programs do with meshes of the wrong size that are only drawn, or only collide."""
    if not _has_collision(uses):
        return _DRAWN_ONLY if message == "large" else {}
    if any(use.shape in use.link.visuals for use in uses):
        return {}
    is_alone = all(len(use.link.collisions) == 1 for use in uses)  # what else the part has is touched
    return {**_NOT_DRAWN, **(_UNTOUCHED if is_alone and message in {"small", "twice"} else {})}


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


def _is_scenery(model: Model) -> bool:
    """Whether a model is only drawn: no joint of it moves, nothing collides or weighs. Then it is of any size, such as a hall."""
    has_body = any(link.collisions or link.inertial is not None for link in model.links)
    return not has_body and not any(joint.is_movable for joint in model.joints)


def _is_arm(model: Model) -> bool:
    """Whether a robot is an arm: planners read its collision shapes, and their settings may be in another repository."""
    return any(joint.is_movable for joint in model.joints) and bool(list_bolted_links(model))


def _has_collision(uses: Iterable[MeshUse]) -> bool:
    """Whether one of the meshes is a collision shape, which MoveIt loads, rather than a visual one."""
    return any(use.shape in use.link.collisions for use in uses)


def _describe_declaring_meshes(uses: list[MeshUse]) -> str:
    names = list(dict.fromkeys(use.name for use in uses))
    return f"mesh {names[0]} declares" if len(names) == 1 else f"meshes {join_names(names)} declare"


def _build_unit_finding(
    model: Model, rule: Rule, limits: SizeLimits, *, unit: float, meshes: Sequence[MeasuredMesh]
) -> Finding:
    """Compare the size in programs that read COLLADA's unit with that in programs that ignore it."""
    uses = [mesh.use for mesh in meshes]
    drawn = meshes[0].size
    plain = drawn / unit
    right = {
        (True, False): "it looks right in RViz and is wrong where the unit is ignored",
        (False, True): "it is wrong in RViz and right where the unit is ignored",
    }.get((limits.is_plausible(drawn), limits.is_plausible(plain)), "one of them is wrong")
    names = list(dict.fromkeys(use.name for use in uses))
    # What is only drawn, and right where it is drawn, is wrong for programs that the project does not use.
    # Nor is it known how large a robot without extent is: a boat of 5 m, which is 500 m where the unit is ignored.
    is_of_any_size = _is_scenery(model) or (limits.largest < drawn < plain and not limits.is_too_large(drawn))
    is_plausible = limits.is_plausible(drawn) or (is_of_any_size and not limits.is_plausible(plain))
    is_drawn = not _has_collision(uses) and is_plausible
    is_unread = not (_UNITLESS.intersection(model.targets) or names_unitless_program(model))
    is_drawn_right = is_drawn and is_unread
    is_planned = is_checked_for_collisions(model) or _is_arm(model)
    is_collided_right = is_plausible and is_unread and not is_drawn and not is_planned
    finding = rule.finding(
        "unit-drawn" if is_drawn_right else "unit-unread" if is_collided_right else "unit",
        at=uses[0].filename,
        related=[use.filename for use in uses[1:]],
        severity=Severity.INFO if is_drawn_right or is_collided_right else None,
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
