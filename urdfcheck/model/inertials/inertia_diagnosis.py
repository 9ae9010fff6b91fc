"""What is wrong with the inertial of each link, judged by what it draws and by the links that mirror or copy it."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Iterator, Mapping, MutableMapping
from dataclasses import asdict, dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.core import FactUnavailableError
from urdfcheck.facts.inertials.certainty import EXACT
from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial, VisualGeometry
from urdfcheck.facts.inertials.diagnosis import Diagnosis, diagnose_inertial, find_close_match, measure_evidence
from urdfcheck.facts.inertials.mistakes.file_habits import Evidence, Habit, Key, decide_habit, list_candidates
from urdfcheck.model.fact import fact
from urdfcheck.model.inertials.unmoved_pieces import join_unmoved_pieces
from urdfcheck.model.likeness.declared_inertials import estimate_from_twin, read_declared_inertial
from urdfcheck.model.likeness.identical_parts import estimate_from_copies
from urdfcheck.model.likeness.mirror_pairs import mirror_pairs
from urdfcheck.model.meshes import MEASURING_MODULES
from urdfcheck.model.parts import Joint, Link, Pose
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.visual_solid import (
    explain_collision_stand_in,
    has_drawn_shape,
    has_unit_ambiguity,
    has_up_axis_ambiguity,
    integrate_open_meshes,
    measure_link_geometry,
    measure_role_geometry,
    merge_geometry,
    split_visual_bodies,
)
from urdfcheck.system.array_cache import compute_code_version

if TYPE_CHECKING:
    from urdfcheck.system.array_cache import Arrays

# The modules and packages that decide a verdict, besides the numbers and the drawing.
_CODE_MODULES = (
    "urdfcheck.facts.inertials",
    "urdfcheck.facts.likeness",
    "urdfcheck.facts.motion.kinematics",
    "urdfcheck.model.ground.wheels",
    "urdfcheck.model.inertials.inertia_diagnosis",
    "urdfcheck.model.likeness",
    "urdfcheck.model.parts",
    "urdfcheck.model.shapes",
    *MEASURING_MODULES,
)

# A COM this near the mesh's, in radii of gyration, is that of a part of uniform density.
_NEAR_COM = 0.05
# A COM that is so much nearer to one shape than to another, as a share of its distance, belongs to the former.
_MUCH_NEARER = 1.0 / 3.0
# Moments that are within 2 % of those of a shape were computed from it; second moments differ by twice that.
_COMPUTED = 0.04
# A collision shape that is rotated or moved like the inertial has the same mistake.
_OF_PLACE = frozenset({"axes_permuted", "quarter_turn", "unmirrored", "rpy_missing", "rpy_twice", "com_missing"})


@dataclass(frozen=True, slots=True, eq=False)
class InertialReference:
    """What other links say that the numbers of one should be."""

    numbers: DeclaredInertial
    """In the link's frame."""
    links: tuple[str, ...]
    """The names of the links that say so."""
    trusted: bool
    """Whether several agree."""


@dataclass(frozen=True, slots=True, eq=False)
class DiagnosedInertial:
    """A link's inertial as declared, and what is wrong with it."""

    declared: DeclaredInertial
    diagnosis: Diagnosis
    twins: tuple[str, ...]
    """The links (by name) whose inertials say so, if any."""
    is_habit: bool
    """Whether most links of the file have this mistake."""


@dataclass(slots=True)
class _Known:
    """What is kept between runs, as plain values."""

    whole: str | None = None
    """A digest of all that the verdicts depend on."""
    links: dict[str, tuple[str, list[str]]] = field(default_factory=dict)
    """The key of its verdict, and its twins, by link."""
    verdicts: dict[str, Any] = field(default_factory=dict)
    evidence: dict[str, Any] = field(default_factory=dict)
    """Of links alone, by the key of their verdict."""
    habit: dict[str, Any] | None = None


@fact
def inertial_diagnoses(model: Model) -> Mapping[str, DiagnosedInertial]:
    """Diagnose every link that has a mass and a tensor, and draws something or has a twin; by name.

    A link whose numbers and drawing are those of an earlier run is not diagnosed again.
    """
    numbers = {name: d for name, link in model.link_by_name.items() if (d := read_declared_inertial(link)) is not None}
    text = f"{model.source.path}\0{model.name}\0{compute_code_version(*_CODE_MODULES)}"
    key = hashlib.sha256(text.encode(errors="surrogatepass")).hexdigest()  # a file name may not be valid text
    entry = model.cache.entry("diagnosis", key)
    known = _read_entry(entry)
    others = [f"{name} {_format_numbers(declared)}" for name, declared in numbers.items()]
    whole = _hash_drawing(model, model.links, [*others, *map(_format_joint, model.joints)])
    if known.whole != whole:
        known = _diagnose_all(model, numbers, known)
        known.whole = whole
        _write_entry(entry, known)
    habit = None if known.habit is None else (known.habit["id"], known.habit["detail"])
    decoded = {name: _decode_diagnosis(known.verdicts[verdict]) for name, (verdict, _) in known.links.items()}
    diagnosed = {}
    for name, diagnosis in join_unmoved_pieces(model, numbers, decoded).items():
        is_habit = diagnosis.cause is not None and (diagnosis.cause, diagnosis.detail) == habit
        diagnosed[name] = DiagnosedInertial(numbers[name], diagnosis, tuple(known.links[name][1]), is_habit)
    return diagnosed


def _diagnose_all(model: Model, numbers: Mapping[str, DeclaredInertial], known: _Known) -> _Known:
    """Diagnose each link alone, then all together where links fit a mistake that a whole file has; from ``known`` where
    possible."""
    found = _Known()
    references = _collect_references(model)
    for name, declared in numbers.items():
        link, reference = model.link_by_name[name], references.get(name)
        if reference is None and not has_drawn_shape(link):
            continue
        key = _compute_cache_key(model, link, declared=declared, reference=reference)
        if key in known.verdicts:
            found.verdicts[key] = known.verdicts[key]
            if key in known.evidence:
                found.evidence[key] = known.evidence[key]
        else:
            diagnosis = _diagnose_link(model, link, declared=declared, reference=reference)
            if diagnosis is None:
                continue
            found.verdicts[key] = _encode_diagnosis(diagnosis)
            if diagnosis.evidence is not None:
                found.evidence[key] = _encode_evidence(diagnosis.evidence)
        found.links[name] = key, [] if reference is None else list(reference.links)
    habit = _find_habit(model, numbers, found, known)
    if habit is None:
        return found
    found.habit = asdict(habit)
    for name, (key, twins) in found.links.items():
        if found.verdicts[key]["sound"] and key not in found.evidence and habit.id != "products_sign":
            continue
        key_with_habit = f"{key} {habit}"
        verdict = known.verdicts.get(key_with_habit)
        if verdict is None:
            diagnosis = _diagnose_link(
                model,
                model.link_by_name[name],
                declared=numbers[name],
                reference=references.get(name),
                habit=habit,
            )
            verdict = found.verdicts[key] if diagnosis is None else _encode_diagnosis(diagnosis)
        found.verdicts[key_with_habit] = verdict
        found.links[name] = key_with_habit, twins
    return found


def _find_habit(model: Model, numbers: Mapping[str, DeclaredInertial], found: _Known, known: _Known) -> Habit | None:
    """Find the mistake that most links have. Without a link that fits one, nothing is computed."""
    candidates: dict[Key, None] = {}
    for key, verdict in found.verdicts.items():
        if not verdict["sound"] and key in found.evidence:
            candidates |= dict.fromkeys(list_candidates(_decode_evidence(found.evidence[key])))
    if not candidates:
        return None
    different: dict[tuple[str, ...], Evidence] = {}  # copies and mirror images are one piece of evidence
    for name, (key, _) in found.links.items():
        if key not in found.evidence:
            evidence = known.evidence.get(key) or _measure_link_evidence(model, name, numbers[name])
            if evidence is None:
                continue
            found.evidence[key] = evidence
        declared = numbers[name]
        moments = (declared.mass, *np.linalg.eigvalsh(declared.tensor))
        different.setdefault(tuple(f"{value:.3g}" for value in moments), _decode_evidence(found.evidence[key]))
    return decide_habit(list(different.values()), list(candidates))


def _measure_link_evidence(model: Model, name: str, declared: DeclaredInertial) -> dict[str, Any] | None:
    readings = _list_geometry_readings(model, model.link_by_name[name])
    measured = [one for reading in readings if (one := measure_evidence(declared, reading)) is not None]
    return _encode_evidence(max(measured, key=lambda one: one.sound)) if measured else None


def _diagnose_link(
    model: Model,
    link: Link,
    *,
    declared: DeclaredInertial,
    reference: InertialReference | None,
    habit: Habit | None = None,
) -> Diagnosis | None:
    """Diagnose one link, in a file with a ``habit`` if that is known.

    None where what is drawn is not known, or where two ways to read it lead to different causes.
    """
    twin, trusted = (None, False) if reference is None else (reference.numbers, reference.trusted)
    diagnoses: list[Diagnosis] = []
    for reading in _list_geometry_readings(model, link):
        diagnosis = diagnose_inertial(declared, reading, twin, trusted=trusted, habit=habit)
        diagnoses += [] if diagnosis is None else [diagnosis]
        if diagnosis is not None and diagnosis.sound:
            break
    drawn = measure_link_geometry(model, link)
    if drawn is None:
        return diagnose_inertial(declared, None, twin, trusted=trusted)
    if not diagnoses or (not diagnoses[-1].sound and len({d.cause for d in diagnoses}) > 1):
        return None
    best = diagnoses[-1] if diagnoses[-1].sound else diagnoses[0]
    if not best.sound and best.judged_by == "mesh" and not drawn.closed:
        for solid in integrate_open_meshes(model, link):  # the hull is not the part; the inside of the mesh may be
            inside = VisualGeometry(solid=solid, closed=True, points=drawn.points)
            if own := find_close_match(declared, inside, EXACT):
                return own
    if not best.sound and best.cause not in _OF_PLACE and (own := _match_collision_shape(model, link, declared)):
        return own
    if best.cause == "com_missing" and _has_visual_about_com(model, link, declared):
        return None  # the collision shape is elsewhere, not the COM
    # Whether the tensors of an assembly's parts were added shows only when its mesh is taken apart.
    explained = best.sound if best.com_mismatch > _NEAR_COM else best.tensor_mismatch < EXACT
    is_habit = habit is not None and habit.is_like(best.cause or "", best.detail)
    if explained or (best.cause is not None and (best.unique or is_habit)):
        return best
    parts = split_visual_bodies(model, link)
    if len(parts) < 2:
        return best
    taken_apart = diagnose_inertial(declared, replace(drawn, pieces=parts), twin, trusted=trusted, habit=habit)
    return taken_apart if taken_apart is not None and taken_apart.cause is not None else best


def _has_visual_about_com(model: Model, link: Link, declared: DeclaredInertial) -> bool:
    """Whether the COM is much nearer to an open visual mesh than to the collision shape that is compared in its place."""
    if explain_collision_stand_in(model, link) != "open":
        return False
    visible, collision = (measure_role_geometry(model, link, role) for role in ("visual", "collision"))
    if visible is None or collision is None:
        return False
    near, far = (float(np.linalg.norm(declared.com - drawn.solid.com)) for drawn in (visible, collision))
    return near < _MUCH_NEARER * far


def _match_collision_shape(model: Model, link: Link, declared: DeclaredInertial) -> Diagnosis | None:
    """Return the verdict on numbers that were computed from the collision shapes of a link, which may well have another form
    than what it draws; None where tensor or COM are not theirs, or their density is that of no part."""
    collision = measure_role_geometry(model, link, "collision")
    if collision is None or not collision.closed:
        return None
    return find_close_match(declared, collision, _COMPUTED)


def _list_geometry_readings(model: Model, link: Link) -> Iterator[VisualGeometry]:
    """Yield what a link may be meant to draw.

    Its own shapes, without COLLADA's ``<unit>`` and with its ``<up_axis>`` where that matters, and together with those of links
    that are fixed to it and have no mass, such as covers.
    """
    as_drawn = measure_link_geometry(model, link)
    if as_drawn is None:
        return
    yield as_drawn
    if has_unit_ambiguity(model, [link.name]):
        unscaled = measure_link_geometry(model, link, apply_unit=False)
        if unscaled is not None:
            yield unscaled
    if has_up_axis_ambiguity(model, [link.name]):
        upright = measure_link_geometry(model, link, apply_up_axis=True)
        if upright is not None:
            yield upright
    covers = _list_massless_covers(model, link)
    if covers and (with_covers := merge_geometry(model, link, covers)) is not None:
        yield with_covers


def _list_massless_covers(model: Model, link: Link) -> list[Link]:
    """Return the links that are fixed to one, have no inertial, and draw something; none where their placement is not known."""
    try:
        tree, _ = model.pieces, model.piece_frames
    except FactUnavailableError:
        return []
    covers = []
    queue = [link.name]
    while queue:
        for joint in tree.child_joints[queue.pop()]:
            child = model.link_by_name[joint.child]
            if joint.type == "fixed" and child.inertial is None:
                queue.append(child.name)
                if has_drawn_shape(child):
                    covers.append(child)
    return covers


def _collect_references(model: Model) -> dict[str, InertialReference]:
    """Return what other links say that one's numbers should be, by name.

    The others are those that draw the same part, else that on the other side.
    """
    try:
        pairs = mirror_pairs(model)
        copied = estimate_from_copies(model, excluded={frozenset((pair.one, pair.other)) for pair in pairs})
    except FactUnavailableError:
        return {}
    references = {
        name: InertialReference(copy.expected, tuple(link.name for link in copy.by), trusted=len(copy.by) > 1)
        for name, copy in copied.items()
    }
    for pair in pairs:
        for name, other in ((pair.one, pair.other), (pair.other, pair.one)):
            if name in references:
                continue
            twin = estimate_from_twin(model, model.link_by_name[name], [pair])
            if twin is not None:
                references[name] = InertialReference(twin, (other,), trusted=False)
    return references


def _compute_cache_key(
    model: Model, link: Link, *, declared: DeclaredInertial, reference: InertialReference | None
) -> str:
    """Return a digest of what the verdict on a link depends on."""
    covers = _list_massless_covers(model, link)
    places = [
        repr((np.linalg.inv(model.piece_frames[link.name]) @ model.piece_frames[one.name]).tolist()) for one in covers
    ]
    expected = () if reference is None else (_format_numbers(reference.numbers), str(reference.trusted))
    return _hash_drawing(model, [link, *covers], [*places, _format_numbers(declared), *expected])


def _hash_drawing(model: Model, links: Iterable[Link], others: Iterable[str]) -> str:
    """Return a digest of what some links draw, and of ``others``."""
    parts = list(others)
    for link in links:
        parts.append("link")
        for shape in (*link.visuals, *link.collisions):
            use = model.meshes.by_shape.get(id(shape))
            key = (
                None
                if use is None or use.resource.path is None
                else model.meshes.compute_content_key(use.resource.path)
            )
            read = model.meshes.get_facts(shape) is not None
            parts.append(f"{shape.role} {shape.kind} {shape.size} {_format_pose(shape.origin)} {key} {read}")
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()[:32]


def _format_joint(joint: Joint) -> str:
    return f"{joint.name} {joint.type} {joint.parent} {joint.child} {_format_pose(joint.origin)}"


def _format_pose(origin: Pose) -> str:
    quaternion = origin.get_attribute("quat_xyzw")
    return f"{origin.xyz} {origin.rpy} {quaternion and quaternion.value}"


def _format_numbers(numbers: DeclaredInertial) -> str:
    return " ".join(map(repr, (numbers.mass, *numbers.com, *numbers.tensor.ravel(), *numbers.rotation.ravel())))


def _read_entry(entry: MutableMapping[str, Arrays]) -> _Known:
    """Return what is known; nothing where that is damaged."""
    try:
        plain = json.loads(entry["links"]["text"].tobytes())
        tables = {name: dict(plain[name]) for name in ("links", "verdicts", "evidence")}
        return _Known(whole=plain["whole"], habit=plain["habit"], **tables)
    except (KeyError, TypeError, ValueError):
        return _Known()


def _write_entry(entry: MutableMapping[str, Arrays], known: _Known) -> None:
    entry["links"] = {"text": np.frombuffer(json.dumps(asdict(known)).encode(), dtype=np.uint8)}


def _encode_diagnosis(diagnosis: Diagnosis) -> dict[str, Any]:
    """Return a diagnosis as plain values, without its evidence."""
    plain = {name: getattr(diagnosis, name) for name in Diagnosis.__slots__ if name != "evidence"}
    mended = diagnosis.mended
    if mended is not None:
        plain["mended"] = [mended.mass, mended.com.tolist(), mended.tensor.tolist(), mended.rotation.tolist()]
    return plain


def _encode_evidence(evidence: Evidence) -> dict[str, Any]:
    habits = [[*key, evidence.likelihoods[key], evidence.priors[key]] for key in evidence.likelihoods]
    return {"habits": habits, "sound": evidence.sound, "alternative": evidence.alternative}


def _decode_evidence(plain: Mapping[str, Any]) -> Evidence:
    return Evidence(
        likelihoods={(name, detail): likelihood for name, detail, likelihood, _ in plain["habits"]},
        priors={(name, detail): prior for name, detail, _, prior in plain["habits"]},
        sound=plain["sound"],
        alternative=plain["alternative"],
    )


def _decode_diagnosis(plain: Mapping[str, Any]) -> Diagnosis:
    mended = plain["mended"]
    if mended is not None:
        mass, com, tensor, rotation = mended
        mended = DeclaredInertial(mass=mass, com=np.array(com), tensor=np.array(tensor), rotation=np.array(rotation))
    return Diagnosis(**{**plain, "mended": mended, "ruled_out": tuple(plain["ruled_out"])})
