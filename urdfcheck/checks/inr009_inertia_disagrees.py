"""INR009 reports inertials that disagree with the drawn part or with its mirror image."""

from __future__ import annotations

import re
from collections.abc import Container, Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from urdfcheck.core import Confidence, FactUnavailableError, Finding, Located, Rule, Severity
from urdfcheck.core.merging import build_group_finding, merge_identical
from urdfcheck.core.text import format_count, join_names
from urdfcheck.facts.inertials.certainty import EXACT, FAR, UNIFORM
from urdfcheck.facts.inertials.hull_bounds import measure_extent, measure_hull_distance
from urdfcheck.facts.inertials.inertia_tensor import compute_solid_inertia
from urdfcheck.facts.inertials.inertial_fit import measure_inertial_mismatch
from urdfcheck.facts.inertials.materials import DENSEST, LIGHTEST
from urdfcheck.facts.inertials.published_parts import name_published_part
from urdfcheck.facts.median import compute_median
from urdfcheck.model import DeclaredTensor, Link, Model
from urdfcheck.model.inertials.diagnosis.commented_masses import COMMENTED
from urdfcheck.model.inertials.diagnosis.slipped_masses import find_slipped_mass
from urdfcheck.model.inertials.diagnosis_words import (
    FROM_DRAWING,
    MILD_CAUSES,
    NOTABLE,
    SHORT_CAUSES,
    collect_cause_data,
    collect_message_data,
    describe_median_agreement,
    describe_other_shape,
    format_ruled_out,
    leaves_tensor,
    name_faulty_numbers,
)
from urdfcheck.model.inertials.habits.minor_findings import set_chosen_aside, set_lost_aside
from urdfcheck.model.inertials.inertia_diagnosis import DiagnosedInertial, inertial_diagnoses
from urdfcheck.model.inertials.inertial_effects import (
    changes_body_little,
    has_unknown_mass,
    is_approximation,
    is_box_of_one_shape,
    is_chance_decimal,
    is_hull_enough,
    is_light,
    is_mark,
    is_next_to_nothing,
    is_placeholder,
    is_possible,
    is_rounded_uniform,
    is_scaled_down,
    is_slight,
    is_tiny,
    is_too_dense,
    is_vast,
    measure_difference,
    measure_mismatch,
)
from urdfcheck.model.inertials.inertial_hull import enclosed_inertials
from urdfcheck.model.inertials.mirrored_inertials import find_contradicted_links
from urdfcheck.model.inertials.proposals.com_places import has_com_of_shell
from urdfcheck.model.inertials.proposals.drawn_inertials import describe_drawn_inertial, draws_part, format_comparison
from urdfcheck.model.inertials.proposals.mistake_names import name_mistake
from urdfcheck.model.inertials.proposals.rival_formulas import has_rival_formula, has_round_solid
from urdfcheck.model.inertials.proposals.undone_mistakes import LARGEST_SOUND_MISMATCH, propose_undo
from urdfcheck.model.inertials.reach import is_beyond_reach
from urdfcheck.model.inertials.shared_mistakes import (
    LUMPED,
    find_disputed_units,
    find_rotated_tensors,
    find_tensor_density,
    is_proven,
    list_habitual_links,
    list_pointlike_links,
    list_unmoved_links,
    shows_habit_alone,
)
from urdfcheck.model.inertials.typed_tensors import MOMENTS, is_computed_from_lengths
from urdfcheck.model.motion.fixed_base import list_bolted_links
from urdfcheck.model.parts import TENSOR_NAMES
from urdfcheck.model.repairs.inertial_edits import InertialRepair
from urdfcheck.model.rigid_bodies import compute_body_mass
from urdfcheck.model.shapes.displaced_collisions import list_displaced_collisions
from urdfcheck.model.shapes.repeated_drawings import list_links_drawn_there
from urdfcheck.model.shapes.visual_solid import (
    describe_geometry_source,
    explain_collision_stand_in,
    has_loose_hull,
    measure_link_geometry,
    measure_role_geometry,
    split_visual_bodies,
)
from urdfcheck.model.wheel_names import is_revolute_wheel
from urdfcheck.source.text.xml import Attribute

# Either the mass or the tensor may be the wrong number: two different edits make such an inertial agree.
AMBIGUOUS_CAUSES = frozenset({"other_mass", "one_piece"})
# Causes with messages of their own, which do not rest on how well the rest agrees.
_TOLD_BY_ITSELF = frozenset({"shell", "com_missing", "mesh_scale"})
# Mistakes about the tensor that are made where mass properties are read from a CAD program.
_CAD_MISTAKES = frozenset({"about_origin", "positive_notation", "products_sign", "steiner_missing", "steiner_twice"})
# A part of an accessory that is lighter (kg, chosen) hardly moves the COM of the robot that carries it.
_LIGHT = 0.2
# A COM that moves that of its body by less (m) is within what `PLACE` allows for a measurement by hand.
_MOVED = 1e-3
# Links with one mistake may differ in these data: the repair, and numbers that the message does not measure.
PER_LINK_DATA = ("edit", "repair", "condition", "mismatch", "twins", "moments", "expected", "ruled_out")
# Meshes of the robot whose numbers others copy.
_TURTLEBOT = re.compile(r"turtlebot|tb3|burger|waffle", re.IGNORECASE)
# The density (kg/m³) that CAD programs assume for a part without a material, and how far the facets of a mesh are off.
_ASSUMED, _FACETS = 1000.0, 0.01
# `urdfcheck.model.likeness.mirror_pairs` is the better judge of these: it compares the drawings of the two sides.
MIRROR_CAUSES = frozenset({"unmirrored"})
# Visual and collision shapes of one link differ by so much where a mesh is in another unit.
_OTHER_UNIT = 100.0
# Equal shapes farther apart (m) are a warning of GEO005.
_APART = 0.01
# A collision shape is not like what is drawn where a side of its box is off by more than this share of the drawing's size
# (chosen).
_UNLIKE = 0.25
# One coordinate of a COM alone is off where it has this share of the distance.
_ALONE = 0.999
# Variances across the axis of a round part differ by no more than this share, as the spokes of a wheel may (chosen).
_ROUND = 0.02
# A COM is outside its body beyond this share of the body's size, as for INR006.
_OUTSIDE = 0.1
# A tensor below this share of the drawn part's is too small for an arrangement of lumps in it.
_FAR_SMALLER = 0.2
# Moments of bodies whose densities differ are those of uniform ones within this factor (chosen).
_OWN_SUM = 2.0
# Mistakes of place and direction: the numbers may be right, and what is drawn be out of place.
_OF_PLACE = frozenset({"axes_permuted", "quarter_turn", "unmirrored", "mesh_frame"})
# Mistakes about the COM: a reason for masses and moments is none for them.
_OF_COM = frozenset({"com_missing", "com_unit", "mesh_frame"})
# A tensor that stays farther off than this share of the drawn part's (chosen) is not that of the part.
_NEAR = 0.25
# Of a tensor that only has other axes, digits and facets leave less than this share (chosen).
_OF_AXES, _RIGHT = frozenset({"axes_permuted", "slots_swapped", "slots_shifted"}), 0.1
# Where the frame of an inertial is rotated and its tensor is not.
_NO_RPY = 'rpy="0 0 0" in the <origin> of the inertial'
# Messages that a note on the small effect of a mistake takes the place of.
_WITH_EFFECT = frozenset({"cause", "exact", "named", "size", "unnamed"})
# Messages that leave open which number is wrong, or say that none matters.
_WITHOUT_CAUSE = frozenset({"centres", "elsewhere", "rotated", "slight", "unnamed"})
_HOLLOW_BODIES = frozenset({"a thin-walled tube", "a hollow sphere"})
_ABSORBED = "The link is fixed to others: with the right numbers, mass, COM and moments of all together hardly change"
_SLIGHT = "The right numbers change each moment by less than 10 %, and the COM by next to nothing"
_UNSEEN = ("other link has an open visual mesh, which does", "other links have open visual meshes, which do")
_MISFITS = ("other link does not fit its drawing", "other links do not fit their drawings")

_POSSIBLE_TERM = (
    ". It may be the sum of the tensors of several bodies without the parallel-axis term: the COM is right, and the mesh has"
    " several bodies"
)


def check(model: Model, rule: Rule, *, far: float, concentrated: float) -> Iterator[Finding]:
    found = _check(model, rule, far=far, concentrated=concentrated)
    findings = set_chosen_aside(model, rule, found, _OF_COM, by_scaled=True)
    yield from set_lost_aside(model, rule, findings)


def _check(model: Model, rule: Rule, *, far: float, concentrated: float) -> Iterator[Finding]:
    # Legs with the same mistake are one finding.
    findings = _check_each_link(model, rule, far=far, concentrated=concentrated)
    yield from merge_identical(rule, findings, "link", varying=PER_LINK_DATA)


def _check_each_link(model: Model, rule: Rule, *, far: float, concentrated: float) -> Iterator[Finding]:
    doubtful: list[DeclaredTensor] = []
    groups = (list_habitual_links(model), list_pointlike_links(model), list_unmoved_links(model))
    for group in groups:
        if group:
            yield _build_habit_finding(model, rule, group)
    grouped = {link.name for group in groups for link in group}
    density, of_density = find_tensor_density(model)
    if of_density and not grouped & of_density.keys():
        yield _build_density_finding(model, rule, density, list(of_density))
        grouped |= of_density.keys()
    rotated = find_rotated_tensors(model)
    for name in rotated:
        yield _build_axes_finding(model, rule, name, rotated)
    contradicted_links = find_contradicted_links(model)
    disputed = find_disputed_units(model)
    for tensor, judged in _list_lone_inertials(model, but=grouped | rotated.keys()):
        name, diagnosis = tensor.link.name, judged.diagnosis
        # One unit that fits some links, where others fit none, is no cause: the COM is wrong in another way.
        is_refuted = disputed.get(diagnosis.cause or "") == "" or _is_unproven(model, tensor.link, judged)
        is_refuted |= _is_coincidence(model, tensor, judged)
        has_cause, is_far = diagnosis.cause is not None and not is_refuted, False
        if not has_cause:
            is_far = _is_far_from_drawing(model, tensor, judged, far=far)
        if (has_cause or is_far) and (owner := _name_owner(tensor, judged)):
            yield _build_published_finding(model, rule, judged, tensor=tensor, owner=owner)
        elif has_cause:
            by_twin, unmirrored = diagnosis.judged_by == "twin", diagnosis.cause in MIRROR_CAUSES
            is_of_pair = by_twin + unmirrored + (name in contradicted_links) >= 2
            if not is_of_pair:
                yield _build_cause_finding(
                    model, rule, judged, tensor=tensor, others=disputed.get(diagnosis.cause or "", "")
                )
        elif is_far:
            is_possible_part = diagnosis.min_moment_ratio > concentrated and not (
                _has_own_tensor(model, tensor.link, judged) or is_scaled_down(model, tensor.link, judged)
            )
            if is_possible_part or is_light(model, tensor.link):
                doubtful += [] if is_too_dense(model, tensor.link, judged) else [tensor]
            else:
                yield _build_mismatch_finding(model, rule, judged, tensor=tensor)
    if doubtful:
        first = doubtful[0].link.name
        yield rule.finding(
            "doubtful",
            at=doubtful[0].element,
            related=[tensor.element for tensor in doubtful[1:]],
            severity=Severity.INFO,
            confidence=Confidence.HEURISTIC,
            links=join_names(tensor.link.name for tensor in doubtful),
            first=first,
            ruled_out=format_ruled_out(inertial_diagnoses(model)[first]),
        )


def _name_owner(tensor: DeclaredTensor, judged: DiagnosedInertial) -> str:
    """Name the part of another robot whose numbers a link has, and does not draw; empty where none has them."""
    if judged.diagnosis.judged_by != "mesh":
        return ""
    meshes = [shape.mesh_filename.value for shape in tensor.link.visuals if shape.mesh_filename is not None]
    is_own = any(map(_TURTLEBOT.search, meshes))
    return "" if is_own else name_published_part(judged.declared.mass, tensor.tensor)


def _build_published_finding(
    model: Model, rule: Rule, judged: DiagnosedInertial, *, tensor: DeclaredTensor, owner: str
) -> Finding:
    """Report numbers of a part of another robot: no mistake explains them, whatever fits by chance."""
    link = tensor.link
    is_mild = is_light(model, link) or is_slight(model, link, judged) or link.name in list_bolted_links(model)
    return rule.finding(
        "published",
        at=tensor.inertial.element,
        severity=Severity.ERROR if is_vast(model, link, judged) else Severity.INFO if is_mild else None,
        owner=owner,
        **collect_message_data(model, link, judged),
    )


def _list_lone_inertials(model: Model, *, but: Container[str]) -> Iterator[tuple[DeclaredTensor, DiagnosedInertial]]:
    """Iterate over the inertials that are wrong by themselves; ``but``: links that are reported together."""
    for name, judged in inertial_diagnoses(model).items():
        tensor, diagnosis = model.tensor_by_name[name], judged.diagnosis
        if diagnosis.sound or not diagnosis.at_fault or not is_possible(judged) or name in but:
            continue
        if judged.is_habit and not shows_habit_alone(model, tensor.link, diagnosis):
            continue
        if not _is_told_elsewhere(model, tensor, judged):
            yield tensor, judged


def _is_told_elsewhere(model: Model, tensor: DeclaredTensor, judged: DiagnosedInertial) -> bool:
    """Whether the numbers show another defect, which other rules report, or one that changes nothing."""
    cause = judged.diagnosis.cause
    if has_unknown_mass(model, tensor.link, judged.declared.mass, judged.declared.tensor):
        return True
    moments = {tensor.texts[place] for place in (0, 3, 5)}
    if cause == "rounded" and len(moments) == 1:
        return True  # one small number for all three was typed: no decimals were lost
    if cause == "com_missing" and not _moves_body(model, tensor.link, judged):
        return True
    if cause == "com_missing" and _is_collision_apart(model, tensor.link, judged):
        return True  # GEO005 reports the two shapes
    if _draws_other_link(model, tensor.link, judged):
        return True  # SYM003 and SYM004 report both
    return is_chance_decimal(model, tensor, judged)


def _draws_other_link(model: Model, link: Link, judged: DiagnosedInertial) -> bool:
    """Whether the COM of a link is not that of what it draws, but another link that draws the same there has it there:
    then the drawing may be that of the other link, and the numbers may be right."""
    if not judged.diagnosis.com_mismatch > NOTABLE:
        return False
    try:
        others = list_links_drawn_there(model, link)
    except FactUnavailableError:
        return False
    known = (inertial_diagnoses(model).get(other.name) for other in others)
    return any(other is not None and other.diagnosis.com_mismatch <= NOTABLE for other in known)


def _moves_body(model: Model, link: Link, judged: DiagnosedInertial) -> bool:
    """Whether the COM of a link makes a difference: the link is not a mark, is not fixed to the world, and moves the COM of its
    rigid body."""
    if is_mark(model, judged.declared.mass) or link.name in list_bolted_links(model):
        return False
    drawn = measure_link_geometry(model, link)
    share = judged.declared.mass / max(_compute_mass_of_body(model, link), judged.declared.mass)
    off = 0.0 if drawn is None else float(np.linalg.norm(judged.declared.com - drawn.solid.com))
    return drawn is None or share * off > _MOVED


def _compute_mass_of_body(model: Model, link: Link) -> float:
    """Compute the mass (kg) of the rigid body that a link is part of, and of all that it carries if it is the base; zero where it
    is not known."""
    try:
        pieces = model.pieces
        links = pieces.list_body_links(link.name)
        own = compute_body_mass(model, links) or 0.0
        above = pieces.parent_joint.get(links[0])
        if len(links) == 1 or (above is not None and above.type != "floating"):
            return own
        paths = {name: pieces.find_path_to(name) for name in pieces.order if name not in links}
        carried = [name for name, path in paths.items() if any(joint.parent in links for joint in path)]
        return compute_body_mass(model, (*links, *carried)) or own
    except FactUnavailableError:
        return 0.0


def _is_unproven(model: Model, link: Link, judged: DiagnosedInertial) -> bool:
    """Whether the mistake that fits best cannot be undone, and leaves numbers that are far from the drawn part's: then it is only
    the best of those that are known."""
    diagnosis = judged.diagnosis
    if diagnosis.judged_by != "mesh" or diagnosis.cause in _TOLD_BY_ITSELF or propose_undo(model, link) is not None:
        return False
    return measure_mismatch(diagnosis, is_mended=True) > LARGEST_SOUND_MISMATCH


def _is_coincidence(model: Model, tensor: DeclaredTensor, judged: DiagnosedInertial) -> bool:
    """Whether a mistake of CAD programs leaves a tensor that is far from the drawn part's, or fits one that is computed in the
    file from the lengths of a box or a cylinder, or has the moments of one of round size: then these lengths are others than the
    drawn ones."""
    diagnosis, drawn = judged.diagnosis, measure_link_geometry(model, tensor.link)
    if diagnosis.cause == "inertia_unit" and _is_typed_for_all(model, tensor, judged):
        return True
    if (
        diagnosis.cause == "decimal_point"
        and diagnosis.detail.startswith("com ")
        and _are_coms_elsewhere(model, tensor)
    ):
        return True
    if (
        diagnosis.cause not in _CAD_MISTAKES
        or diagnosis.judged_by != "mesh"
        or diagnosis.mended is None
        or drawn is None
    ):
        return False
    if measure_difference(diagnosis.mended, drawn) > LUMPED:
        return True
    moments = [tensor.element.attributes[name] for name in MOMENTS]
    is_formula = all(map(is_computed_from_lengths, moments)) or has_round_solid(tensor, judged.declared.mass)
    return diagnosis.mended_tensor_mismatch > EXACT and is_formula


def _are_coms_elsewhere(model: Model, tensor: DeclaredTensor) -> bool:
    """Whether most other links, or one with the same mass and principal moments, have their COM far from what they draw, for
    another reason or none: the COMs are in another frame, and a power of ten brings one of them near by chance."""
    diagnoses = inertial_diagnoses(model)
    own = diagnoses[tensor.link.name].declared
    others = [judged for name, judged in diagnoses.items() if name != tensor.link.name]
    far = [o.declared for o in others if o.diagnosis.com_mismatch > FAR and o.diagnosis.cause != "decimal_point"]
    moments = np.linalg.eigvalsh(own.tensor)
    return 2 * len(far) > len(others) or any(
        one.mass == own.mass and np.allclose(np.linalg.eigvalsh(one.tensor), moments, rtol=_ROUND, atol=0.0)
        for one in far
    )


def _is_typed_for_all(model: Model, tensor: DeclaredTensor, judged: DiagnosedInertial) -> bool:
    """Whether a tensor is a placeholder that more links have with this mass which no unit explains than links that one does:
    their parts have other sizes, and one of all sizes fits by chance."""
    if not is_placeholder(tensor, judged):
        return False
    own, known = (tensor.inertial.mass, tensor.components), inertial_diagnoses(model)
    links = [one.link.name for one in model.tensors if (one.inertial.mass, one.components) == own]
    unsound = [known[name].diagnosis for name in links if name in known and not known[name].diagnosis.sound]
    mistake = (judged.diagnosis.cause, judged.diagnosis.detail)
    return 2 * sum((one.cause, one.detail) == mistake for one in unsound) < len(unsound)


def _is_far_from_drawing(model: Model, tensor: DeclaredTensor, judged: DiagnosedInertial, *, far: float) -> bool:
    """Whether numbers without a cause disagree with what is drawn, and this is the shape of the part."""
    diagnosis = judged.diagnosis
    if diagnosis.judged_by != "mesh" or not (diagnosis.fits_geometry or _has_own_tensor(model, tensor.link, judged)):
        return False
    if not max(diagnosis.tensor_mismatch, diagnosis.com_mismatch) > far:
        return False
    if diagnosis.com_mismatch <= far and (is_rounded_uniform(model, tensor, judged) or is_placeholder(tensor, judged)):
        return False
    if explain_collision_stand_in(model, tensor.link) in {"unread", "wrong size"} or has_loose_hull(model, tensor.link):
        return False  # the shape of the part is not known
    if tensor.link.name in list_bolted_links(model) or _is_drawn_in_other_unit(model, tensor.link):
        return False
    drawn = measure_link_geometry(model, tensor.link)
    if drawn is not None and judged.declared.mass < LIGHTEST * drawn.solid.volume:
        return False  # nor its size: no material is so light
    if find_slipped_mass(model, tensor.link) is not None:
        return False  # the mass is wrong, and the tensor is not: INR010 reports it
    return is_hull_enough(model, tensor.link, judged, far=far)


def _has_own_tensor(model: Model, link: Link, judged: DiagnosedInertial) -> bool:
    """Whether the tensor is that of the drawn part at this mass: it was computed from the drawing, and so was its COM. Not where
    the COM is outside the body, which INR006 reports."""
    drawn = measure_link_geometry(model, link)
    if drawn is None or not drawn.closed or not judged.diagnosis.tensor_mismatch < UNIFORM:
        return False
    parts = [part for part in enclosed_inertials(model) if part.link is link]
    return any(
        measure_hull_distance(points, part.com) <= _OUTSIDE * measure_extent(points)
        for part in parts
        for points in part.readings
    )


def _is_drawn_in_other_unit(model: Model, link: Link) -> bool:
    """Whether what a link draws is so much larger, or smaller, than its collision shapes that the scale of a mesh is wrong, which
    GEO003 reports."""
    roles = [measure_role_geometry(model, link, role) for role in ("visual", "collision")]
    sizes = [measure_extent(drawn.points) for drawn in roles if drawn is not None]
    return len(sizes) == 2 and not min(sizes) * _OTHER_UNIT > max(sizes)


def _build_axes_finding(model: Model, rule: Rule, name: str, rotated: Mapping[str, float]) -> Finding:
    """Report a tensor with the drawn part's principal moments about other axes."""
    tensor, diagnoses = model.tensor_by_name[name], inertial_diagnoses(model)
    others = [other for other in rotated if other != name]
    others += [other for other, judged in diagnoses.items() if judged.diagnosis.cause == "axes_permuted"]
    drawn = describe_drawn_inertial(model, tensor.link)
    return rule.finding(
        "axes",
        at=tensor.element,
        edit=f"write {drawn}, or compute the tensor again in the axes of the link"
        if drawn
        else "compute the tensor again, in the axes of the link",
        percent=float(f"{100.0 * rotated[name]:.2g}"),
        others=f". The tensors of {join_names(others)} are about other axes, too" if others else "",
        **collect_message_data(model, tensor.link, diagnoses[name]),
    )


def _build_density_finding(model: Model, rule: Rule, density: float, names: Sequence[str]) -> Finding:
    """Report tensors that one density made, whatever the parts weigh."""
    tensors = [model.tensor_by_name[name] for name in names]
    drawn = describe_drawn_inertial(model, tensors[0].link)
    return build_group_finding(
        rule,
        "density",
        [tensor.element for tensor in tensors],
        links=join_names(names),
        count=len(names),
        density=_format_density(density),
        times=_describe_slip(density),
        edit=f"; {names[0]}: write {drawn}" if drawn else "",
    )


def _format_density(density: float) -> str:
    """Format a density (kg/m³): that of water, which programs assume, where the mesh is off by its facets only."""
    return f"{float(f'{density:.3g}') if abs(density / _ASSUMED - 1.0) > _FACETS else _ASSUMED:,.0f}"


def _describe_slip(density: float) -> str:
    """Say that tensors are a power of ten times those of parts of the density that programs assume, if no material has that of
    the tensors; else nothing."""
    factor = density / _ASSUMED
    slip = 10.0 ** round(float(np.log10(factor)))
    if density <= DENSEST or abs(factor / slip - 1.0) > _FACETS:
        return ""
    return f", {slip:,.0f} times those at {_ASSUMED:,.0f} kg/m³"


def _build_habit_finding(model: Model, rule: Rule, links: Sequence[Link]) -> Finding:
    """Report a mistake of the program that exported the file, once."""
    diagnoses = inertial_diagnoses(model)
    judged = [diagnoses[link.name] for link in links]
    repairs = [propose_undo(model, link) for link in links]
    complete = [repair for repair in repairs if repair is not None and repair.edits]
    cause, detail = judged[0].diagnosis.cause or "", judged[0].diagnosis.detail
    has_vast = any(is_vast(model, link, one) for link, one in zip(links, judged, strict=True))
    has_proof = all(is_proven(model, link) for link in links)
    is_mild = all(is_light(model, one) for one in links)
    is_certain = len(complete) == len(links) and has_proof
    edits = {edit.span: edit for repair in complete for edit in repair.edits} if is_certain else {}
    unseen = _count_unseen_links(model, links)
    others = 0 if unseen or cause not in _CAD_MISTAKES else _count_other_misfits(model, links)
    if others > len(links):
        edits = {}  # most links would keep the mistake
    return build_group_finding(
        rule,
        "habit",
        [model.tensor_by_name[link.name].element for link in links],
        cause=cause,
        edits=tuple(edits.values()),
        severity=Severity.ERROR if has_vast else Severity.INFO if is_mild else None,
        links=join_names(link.name for link in links),
        count=len(links),
        known=len(diagnoses),
        faulty=f"{'wrong' if has_proof else 'suspect'} {name_faulty_numbers(cause, detail)}",
        doubt="" if has_proof else "?",
        why=SHORT_CAUSES.get(cause, name_mistake(cause)).format(detail=detail),
        **collect_cause_data(cause, detail),
        before=float(f"{_compute_median_mismatch(judged, is_mended=False):.2g}"),
        after=float(f"{_compute_median_mismatch(judged, is_mended=True):.2g}"),
        better=describe_median_agreement(model, links),
        example=_describe_example(model, links, repairs, cause, has_edits=bool(edits)),
        unseen=f". {format_count(unseen, *_UNSEEN)} not show it"
        if unseen
        else f". {format_count(others, *_MISFITS)} either"
        if others
        else "",
        each="" if unseen or others else f", or correct each of the {len(links)} links",
    )


def _describe_example(
    model: Model, links: Sequence[Link], repairs: Sequence[InertialRepair | None], cause: str, *, has_edits: bool
) -> str:
    """Say what to write for one of several links, by the part itself where the numbers are those of what it draws: those of the
    hull of an open mesh are only near them."""
    known = [(link, repair) for link, repair in zip(links, repairs, strict=True) if repair is not None]
    exact = [pair for pair in known if cause not in FROM_DRAWING or draws_part(model, pair[0])]
    for link, repair in exact[:1]:
        return f"; {link.name}: write {_spell_repair(repair, has_edits=has_edits)}"
    for link, repair in known[:1]:
        return f"; for comparison: {link.name} {repair.words} ({describe_geometry_source(model, link)})"
    return ""


def _count_unseen_links(model: Model, links: Sequence[Link]) -> int:
    """Count the links beside some with a mistake of which a collision shape stands for an open mesh: they may have it, too."""
    names = inertial_diagnoses(model).keys() - {link.name for link in links}
    return sum(explain_collision_stand_in(model, model.link_by_name[name]) == "open" for name in names)


def _count_other_misfits(model: Model, links: Sequence[Link]) -> int:
    """Count the links beside some with a mistake whose inertials do not fit what they draw either."""
    names = {link.name for link in links}
    return sum(name not in names and not judged.diagnosis.sound for name, judged in inertial_diagnoses(model).items())


def _compute_median_mismatch(judged: Sequence[DiagnosedInertial], *, is_mended: bool) -> float:
    """Return the median of how far the inertials are from the drawn parts; a tensor that no body has is infinitely far."""
    return compute_median([measure_mismatch(one.diagnosis, is_mended=is_mended) for one in judged])


def _build_cause_finding(
    model: Model, rule: Rule, judged: DiagnosedInertial, *, tensor: DeclaredTensor, others: str
) -> Finding:
    """Report an inertial with a cause. ``others``: the units that links of the model fit where these differ."""
    diagnosis, link = judged.diagnosis, tensor.link
    cause = diagnosis.cause or ""
    # The mass of one piece is not that of the part either, so that no number of the part is known.
    mended = propose_undo(model, link) if not others and cause != "one_piece" else None
    exact = diagnosis.unique and mended is not None and cause not in AMBIGUOUS_CAUSES
    message = "cause" if mended is None else "exact" if exact else "named"
    other_mass = _find_other_mass(judged) if mended is not None else None
    if mended is not None and diagnosis.judged_by == "twin":
        message = "twin"
    elif (cause == "shell" and has_com_of_shell(model, link)) or _is_meant_hollow(link, judged):
        message = "hollow"
    elif cause == "com_missing" and _is_com_of_collision(model, link, judged):
        message = "centres"
    elif cause == "com_missing" and (_is_drawn_elsewhere(model, link) or _is_drawn_off_axle(model, link, judged)):
        message = "elsewhere"
    elif cause == "com_missing" and _is_unlike_stand_in(model, link):
        message = "unlike"
    elif cause in {"com_missing", "mesh_scale"}:
        message = cause
    elif others:
        message = "disputed"
    elif other_mass is not None:
        message = "size"
    elif is_approximation(model, link, judged):
        message = "approximation"
    drawn_twin = _find_drawn_twin(model, link, judged)
    if drawn_twin is not None:
        message = "rotated"
    fallback = "the inertia of the drawn part" if message == "approximation" else ""
    data = {**collect_message_data(model, link, judged, is_certain=message == "exact"), "others": others}
    if message == "size":
        data["other_mass"] = f"{other_mass:.4g}"
    if message in {"exact", "named"} and has_rival_formula(model, tensor, judged):
        message = "unnamed"
        data |= {"why": "", "detail": "", "mistake": ""}
    mild = cause in MILD_CAUSES or is_light(model, link, diagnosis.mended) or is_slight(model, link, judged)
    is_bolted = link.name in list_bolted_links(model)
    mild |= message != "exact" and is_bolted and not is_beyond_reach(model, float(np.linalg.norm(judged.declared.com)))
    # An accessory, such as a camera, is a small part of the robot that carries it.
    mild |= cause == "com_missing" and judged.declared.mass < _LIGHT and not any(j.is_movable for j in model.joints)
    mild |= cause == "com_missing" and is_box_of_one_shape(model, link, judged.declared)
    mild |= message == "hollow" or (message == "centres" and _is_along_wheel(model, link, judged))
    is_absorbed = changes_body_little(model, link, judged)
    mild |= is_absorbed
    if mild and is_bolted and message in {"exact", "named"}:
        message = "bolted"
    data |= {"scale": _describe_scale(link, diagnosis.detail)} if message == "mesh_scale" else {}
    vast = is_vast(model, link, judged)
    has_little_effect = is_absorbed or is_next_to_nothing(model, link, judged)
    has_another = message == "named" and _leaves_another_mistake(model, link, judged)
    has_other_axes = has_another and cause in _OF_AXES  # and is not that of the drawn part in any
    # The mass, or the drawing, is as likely to be wrong, or another number is wrong as well.
    without_edits = message in {"size", "rotated"} or _is_meant_hollow(link, judged) or has_another
    without_edits |= message == "named" and _is_in_doubtful_file(model, cause)
    if has_little_effect and not vast and message in _WITH_EFFECT:
        message = "slight"
    is_straight = message == "exact" and cause in _OF_AXES and _fits_without_rpy(model, link, judged)
    return rule.finding(
        message,
        at=tensor.element if mended is None else _locate_repair(tensor, mended),
        cause=None if message in _WITHOUT_CAUSE or _is_meant_hollow(link, judged) or has_other_axes else cause,
        edits=() if mended is None or without_edits else mended.edits,
        related=[
            *_list_twins(model, judged),
            *([] if drawn_twin is None else [drawn_twin]),
            *_iter_definitions(mended),
        ],
        severity=Severity.ERROR if vast else Severity.INFO if mild else None,
        effect=_ABSORBED if is_absorbed else _SLIGHT,
        edit=fallback if mended is None else _spell_repair(mended, has_edits=not without_edits),
        like="" if drawn_twin is None else drawn_twin.name,
        repair=_describe_repair(model, link, judged, mended, message=message),
        condition="" if mended is None or mended.edits else f", if the numbers of {join_names(judged.twins)} are right",
        alone=_describe_drawn_com(model, link, mended) if message == "com_missing" else "",
        beside=f"so they do with {_NO_RPY}" if is_straight else "no other single edit brings them so near",
        straight=f", or {_NO_RPY}, whichever is meant" if is_straight else "",
        **data,
    )


def _describe_scale(link: Link, times: str) -> str:
    """Say which scale makes what a link draws so many ``times`` as large: that of its unit, where no single one is written."""
    scales = {shape.size for shape in link.visuals or link.collisions if shape.kind == "mesh"}
    written = scales.pop() if len(scales) == 1 else None
    if written is None or len(set(written)) != 1:
        return 'the scale of its unit (scale="0.001 0.001 0.001" for millimetres)'
    wanted = f"{float(times) * written[0]:.4g}"
    return f'scale="{wanted} {wanted} {wanted}"'


def _spell_repair(repair: InertialRepair, *, has_edits: bool) -> str:
    """Return what to write: all numbers, where the finding has no edits that show them."""
    return (repair if has_edits else replace(repair, edits=())).words


def _is_meant_hollow(link: Link, judged: DiagnosedInertial) -> bool:
    """Whether a formula is that of the hollow body of a drawn cylinder or sphere: URDF has no shape for a tube, so that a rim is
    drawn as a solid. The box around a sphere has the moments of its shell."""
    shapes = link.visuals or link.collisions
    if judged.diagnosis.cause == "bounding_box" and len(shapes) == 1 and shapes[0].kind == "sphere":
        return True
    return judged.diagnosis.cause == "wrong_formula" and judged.diagnosis.detail in _HOLLOW_BODIES


def _is_com_of_collision(model: Model, link: Link, judged: DiagnosedInertial) -> bool:
    """Whether the COM is that of the link's collision shapes, and not of what it draws: either of the two may be out of place."""
    colliding = measure_role_geometry(model, link, "collision")
    if colliding is None or explain_collision_stand_in(model, link) is not None:
        return False
    off = float(np.linalg.norm(judged.declared.com - colliding.solid.com))
    return off <= _FACETS * measure_extent(colliding.points)


def _is_collision_apart(model: Model, link: Link, judged: DiagnosedInertial) -> bool:
    """Whether the COM is that of a collision shape which is apart from a visual of the same shape: one is out of place."""
    return _is_com_of_collision(model, link, judged) and any(
        displaced.link is link and displaced.moved > _APART for displaced in list_displaced_collisions(model)
    )


def _is_along_wheel(model: Model, link: Link, judged: DiagnosedInertial) -> bool:
    """Whether what a wheel draws is beside its COM along the axle: turning, it is balanced there and here."""
    drawn = measure_link_geometry(model, link)
    joint = next((one for one in model.joints if one.child == link.name), None)
    axis = None if joint is None or joint.type != "continuous" else joint.axis
    if drawn is None or axis is None:
        return False
    off = judged.declared.com - drawn.solid.com
    along = abs(float(np.dot(off, axis))) / max(float(np.linalg.norm(axis)), 1e-9)
    return along >= _ALONE * float(np.linalg.norm(off))


def _describe_repair(
    model: Model, link: Link, judged: DiagnosedInertial, mended: InertialRepair | None, *, message: str
) -> str:
    """Say how to undo a mistake that is not certain, and what to do if it is another one."""
    diagnosis, drawn = judged.diagnosis, measure_link_geometry(model, link)
    if mended is None:
        return "compute the inertial again"
    if message == "slight":
        return f"write {mended.words}"
    if diagnosis.detail.endswith(COMMENTED):
        return f"write {mended.words}, or the mass of the comment if the part weighs that much"
    if _leaves_another_mistake(model, link, judged):
        return f"compute the inertial again{format_comparison(describe_drawn_inertial(model, link, with_com=True))}"
    if diagnosis.cause in _OF_PLACE:
        return f"write {mended.words}, or correct the <origin> of the shapes if RViz shows them out of place"
    is_near = drawn is None or diagnosis.mended is None or measure_difference(diagnosis.mended, drawn) < _NEAR
    if (mended.edits or is_near) and not _is_in_doubtful_file(model, diagnosis.cause):
        return f"write {mended.words}, or compute the inertial again if that is not the mistake"
    return f"compute the inertial again, or write {mended.words} if that is the mistake"


def _fits_without_rpy(model: Model, link: Link, judged: DiagnosedInertial) -> bool:
    """Whether the typed tensor is that of the drawn part in the axes of the link: then only the rpy of the inertial is wrong."""
    drawn, declared = measure_link_geometry(model, link), judged.declared
    if drawn is None or np.allclose(declared.rotation, np.eye(3)):
        return False
    straight = replace(declared, rotation=np.eye(3))
    return measure_inertial_mismatch(straight, drawn.solid.com, drawn.solid.covariance)[0] < EXACT


def _leaves_another_mistake(model: Model, link: Link, judged: DiagnosedInertial) -> bool:
    """Whether the numbers are wrong in another way, too, so that undoing one mistake gives none to write: the tensor about other
    axes is that of another length, the pieces whose tensors were added have other densities, as the COM shows, or only the COM is
    that of the mirror image."""
    diagnosis, drawn = judged.diagnosis, measure_link_geometry(model, link)
    if drawn is None or diagnosis.mended is None or diagnosis.judged_by != "mesh":
        return False
    if diagnosis.cause in _OF_AXES:
        return measure_difference(diagnosis.mended, drawn) > _RIGHT
    if diagnosis.cause == "unmirrored":
        return leaves_tensor(judged, drawn)
    is_com_off = drawn.closed and diagnosis.mended_com_mismatch > NOTABLE
    return diagnosis.cause in {"steiner_missing", "steiner_twice"} and is_com_off


def _is_in_doubtful_file(model: Model, cause: str | None) -> bool:
    """Whether most links of the file do not fit their drawings, and not by this ``cause``: what is wrong with them all may be
    wrong with a link that one mistake happens to fit."""
    judged = inertial_diagnoses(model).values()
    unlike = [one for one in judged if not one.diagnosis.sound and one.diagnosis.cause != cause]
    return 2 * len(unlike) > len(judged)


def _describe_drawn_com(model: Model, link: Link, mended: InertialRepair | None) -> str:
    """Return the end of the advice about a COM that was not filled in: the drawn part's, with its tensor if that differs too."""
    if explain_collision_stand_in(model, link) in {"unread", "wrong size"}:
        return ""  # the collision shape may be left from another part
    if mended is not None and not any(f"{name}=" in mended.text for name in TENSOR_NAMES):
        return f"; {describe_geometry_source(model, link)} alone has {mended.words}"
    return format_comparison(describe_drawn_inertial(model, link, with_com=True))


def _is_drawn_elsewhere(model: Model, link: Link) -> bool:
    """Whether the origin of a link is farther from what it draws than that is long: the drawing may be in the wrong place."""
    drawn = measure_link_geometry(model, link)
    return drawn is not None and measure_hull_distance(drawn.points, np.zeros(3)) > measure_extent(drawn.points)


def _is_drawn_off_axle(model: Model, link: Link, judged: DiagnosedInertial) -> bool:
    """Whether a wheel has its COM on its axle, and what it draws, which is round about that direction, is beside the axle: the
    drawing may be in the wrong place."""
    drawn = measure_link_geometry(model, link)
    joint = next((one for one in model.joints if one.child == link.name), None)
    if drawn is None or joint is None or not (joint.type == "continuous" or is_revolute_wheel(joint)):
        return False
    variances, axes = np.linalg.eigh(drawn.solid.covariance)
    axis = np.array(joint.axis or (1.0, 0.0, 0.0))
    axis = axis / max(float(np.linalg.norm(axis)), 1e-9)
    along = int(np.abs(axes.T @ axis).argmax())
    first, other = (variances[i] for i in range(3) if i != along)
    # A rod is round, too: one beside its joint is a link of an arm, whose COM was not filled in.
    is_disc = float(variances[along]) < float(min(first, other))
    is_round = is_disc and abs(first - other) <= _ROUND * other and abs(float(axes[:, along] @ axis)) >= _ALONE
    offs = [float(np.linalg.norm(com - (com @ axis) * axis)) for com in (judged.declared.com, drawn.solid.com)]
    return is_round and offs[0] <= _FACETS * measure_extent(drawn.points) < offs[1]


def _is_unlike_stand_in(model: Model, link: Link) -> bool:
    """Whether the collision shape that stands for an open visual mesh is much larger, or smaller, or elsewhere: it says nothing
    about the part."""
    roles = [measure_role_geometry(model, link, role) for role in ("visual", "collision")]
    if explain_collision_stand_in(model, link) != "open" or roles[0] is None or roles[1] is None:
        return False
    corners = [np.array([drawn.points.min(axis=0), drawn.points.max(axis=0)]) for drawn in roles if drawn is not None]
    return float(np.abs(corners[0] - corners[1]).max()) > _UNLIKE * measure_extent(roles[0].points)


def _find_drawn_twin(model: Model, link: Link, judged: DiagnosedInertial) -> Link | None:
    """Find a link with the same mass and tensor whose drawing has these axes, where a tensor is that of what a link draws about
    other axes: the drawing may be what is rotated."""
    if judged.diagnosis.cause != "axes_permuted":
        return None
    own = model.tensor_by_name[link.name]
    for other in model.tensors:
        verdict = inertial_diagnoses(model).get(other.link.name)
        is_same = (other.inertial.mass, other.components) == (own.inertial.mass, own.components)
        if is_same and verdict is not None and verdict.diagnosis.sound:
            return other.link
    return None


def _find_other_mass(judged: DiagnosedInertial) -> float | None:
    """Return the mass (kg) with which a tensor is the drawn part's, where it is found to be that of twice or half the size: it is
    four times the right one, or a quarter of it, which another mass makes too."""
    declared, mended = judged.declared, judged.diagnosis.mended
    if judged.diagnosis.cause != "wrong_formula" or mended is None:
        return None
    factor = float(np.trace(declared.tensor) / np.trace(mended.tensor))
    size = 4.0 if factor > 1.0 else 0.25
    off = float(np.abs(declared.tensor - size * mended.tensor).max())
    return declared.mass * size if off <= _FACETS * float(np.abs(declared.tensor).max()) else None


def _build_mismatch_finding(model: Model, rule: Rule, judged: DiagnosedInertial, *, tensor: DeclaredTensor) -> Finding:
    is_com_off = judged.diagnosis.com_mismatch > NOTABLE and not _is_drawn_off_axle(model, tensor.link, judged)
    drawn = describe_drawn_inertial(model, tensor.link, with_com=is_com_off)
    is_sure = is_tiny(model, tensor.link, judged) or _has_own_tensor(model, tensor.link, judged)
    is_sure |= is_scaled_down(model, tensor.link, judged)
    is_sure &= tensor.link.name not in list_bolted_links(model) and not changes_body_little(model, tensor.link, judged)
    rank = (None, None) if is_sure else (Severity.INFO, Confidence.HEURISTIC)
    origin = tensor.inertial.origin
    is_com_alone = judged.diagnosis.tensor_mismatch <= NOTABLE
    wrong = [tensor.inertial.element if origin.element is None else origin.element] if is_com_alone else []
    numbers = [attribute for element in wrong or [tensor.element] for attribute in element.attributes.values()]
    name = "COM" if is_com_alone else "inertial"
    is_computed = any(attribute.reads for attribute in numbers)
    hint = _describe_lone_coordinate(model, tensor.link, judged) if is_com_alone else ""
    return rule.finding(
        "disagrees",
        at=wrong[0] if wrong else tensor.element,
        repair=f"correct the {name} where the file computes it" if is_computed else f"compute the {name} again",
        severity=rank[0],
        confidence=rank[1],
        comparison=format_comparison(drawn),
        unlike=describe_other_shape(model, tensor.link, judged),
        hint=hint or (_POSSIBLE_TERM if _may_lack_term(model, tensor.link, judged) else ""),
        **collect_message_data(model, tensor.link, judged),
    )


def _describe_lone_coordinate(model: Model, link: Link, judged: DiagnosedInertial) -> str:
    """Say which coordinate of a COM is off, if one alone is, and whether by half of what is drawn along an axis; else nothing."""
    drawn = measure_link_geometry(model, link)
    if drawn is None:
        return ""
    off = np.abs(judged.declared.com - drawn.solid.com)
    index = int(off.argmax())
    if off[index] < _ALONE * float(np.linalg.norm(off)):
        return ""
    halves = np.ptp(drawn.points, axis=0) / 2
    like = [axis for axis, half in zip("xyz", halves, strict=True) if abs(off[index] - half) <= _FACETS * half]
    half = f", by half of what is drawn along {' and '.join(like)}" if like else ""
    return f". Only the COM's {'xyz'[index]} is off{half}"


def _may_lack_term(model: Model, link: Link, judged: DiagnosedInertial) -> bool:
    """Whether the COM is that of a part of several bodies, and the tensor about the sum of the bodies' own ones, which is far
    smaller than the part's."""
    drawn, bodies = measure_link_geometry(model, link), split_visual_bodies(model, link)
    if drawn is None or not bodies or not judged.diagnosis.com_mismatch < EXACT:
        return False
    mass, volume = judged.declared.mass, sum(body.volume for body in bodies)
    if not np.trace(judged.declared.inertia) < _FAR_SMALLER * np.trace(compute_solid_inertia(drawn.solid, mass)):
        return False
    own = sum((compute_solid_inertia(body, mass * body.volume / volume) for body in bodies), np.zeros((3, 3)))
    ratios = np.linalg.eigvalsh(judged.declared.inertia) / np.linalg.eigvalsh(own)
    return bool(1.0 / _OWN_SUM < ratios.min() <= ratios.max() < _OWN_SUM)


def _list_twins(model: Model, judged: DiagnosedInertial) -> list[Link]:
    return [model.link_by_name[twin] for twin in judged.twins] if judged.diagnosis.judged_by == "twin" else []


def _iter_definitions(mended: InertialRepair | None) -> Iterator[Located]:
    """Iterate over the definitions that the numbers of a repair are computed from."""
    for place in () if mended is None else mended.places:
        if isinstance(place, Attribute):
            yield from place.collect_definitions()


def _locate_repair(tensor: DeclaredTensor, mended: InertialRepair) -> Located:
    """Return the narrowest text that holds all numbers to change."""
    places = [place for place in mended.places if place is not None]
    if len(places) == 1:
        return places[0]
    if all(isinstance(place, Attribute) and place.owner is tensor.element for place in places):
        return tensor.element
    return tensor.inertial.element
