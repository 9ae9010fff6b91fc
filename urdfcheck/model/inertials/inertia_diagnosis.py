"""What is wrong with the inertial of each link, judged by what it draws and by the links that are its mirror image or like it."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Iterator, Mapping, MutableMapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.core import FactUnavailableError
from urdfcheck.facts.inertials.diagnosis import EXACT, DeclaredInertial, Diagnosis, VisualGeometry, diagnose_inertial
from urdfcheck.model.fact import fact
from urdfcheck.model.likeness import identical_parts as copies
from urdfcheck.model.likeness.mirror_pairs import estimate_from_twin, mirror_pairs, read_declared_inertial
from urdfcheck.model.meshes import MEASURING_MODULES
from urdfcheck.model.parts import Joint, Link, Pose
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.visual_solid import (
    has_drawn_shape,
    has_unit_ambiguity,
    has_up_axis_ambiguity,
    measure_link_geometry,
    merge_geometry,
    split_visual_bodies,
)
from urdfcheck.system.array_cache import compute_code_version

if TYPE_CHECKING:
    from urdfcheck.system.array_cache import Arrays

# What a verdict depends on beside the numbers and the drawing.
_CODE_MODULES = (
    "urdfcheck.facts.inertials",
    "urdfcheck.facts.likeness.mirror",
    "urdfcheck.facts.motion.kinematics",
    "urdfcheck.model.inertials.inertia_diagnosis",
    "urdfcheck.model.likeness.identical_parts",
    "urdfcheck.model.likeness.mirror_pairs",
    "urdfcheck.model.parts",
    "urdfcheck.model.shapes",
    *MEASURING_MODULES,
)

# A COM that is so near the mesh's, in radii of gyration, is that of a part of uniform density.
_NEAR_COM = 0.05


@dataclass(frozen=True, slots=True, eq=False)
class InertialReference:
    """What other links say that the numbers of one should be, in its frame; ``trusted`` where several agree."""

    numbers: DeclaredInertial
    links: tuple[str, ...]
    trusted: bool


@dataclass(frozen=True, slots=True, eq=False)
class DiagnosedInertial:
    """A link's inertial as declared, what is wrong with it, and the links (by name) whose inertials say so, if any."""

    declared: DeclaredInertial
    diagnosis: Diagnosis
    twins: tuple[str, ...]


@fact
def inertial_diagnoses(model: Model) -> Mapping[str, DiagnosedInertial]:
    """The verdict on every link that has a mass and a tensor, and draws something or has a twin, by name.

    A link whose numbers and drawing are those of an earlier run is not judged again.
    """
    numbers = {name: d for name, link in model.link_by_name.items() if (d := read_declared_inertial(link)) is not None}
    named = f"{model.source.path}\0{model.name}\0{compute_code_version(*_CODE_MODULES)}"
    here = hashlib.sha256(named.encode(errors="surrogatepass")).hexdigest()  # a file name may be no text
    entry = model.cache.entry("diagnosis", here)
    known = _read_entry(entry)
    others = [*(f"{name} {_format_numbers(own)}" for name, own in numbers.items()), *map(_format_joint, model.joints)]
    whole = _hash_drawing(model, model.links, others)
    if known["whole"] != whole:
        known = {"whole": whole, **_diagnose_all(model, numbers, known["verdicts"])}
        _write_entry(entry, known)
    return {
        name: DiagnosedInertial(numbers[name], _decode_diagnosis(known["verdicts"][key]), tuple(twins))
        for name, (key, twins) in known["links"].items()
    }


def _diagnose_all(model: Model, numbers: Mapping[str, DeclaredInertial], known: Mapping[str, Any]) -> dict[str, Any]:
    """``links``: name to the key of its verdict and its twins; ``verdicts`` by key, from ``known`` where it is there."""
    links: dict[str, Any] = {}
    verdicts: dict[str, Any] = {}
    witnesses = _collect_references(model)
    for name, own in numbers.items():
        link, witness = model.link_by_name[name], witnesses.get(name)
        if witness is None and not has_drawn_shape(link):
            continue
        key = _compute_cache_key(model, link, own, witness)
        if key in known:
            verdicts[key] = known[key]
        else:
            verdict = _diagnose_link(model, link, own, witness)
            if verdict is None:
                continue
            verdicts[key] = _encode_diagnosis(verdict)
        links[name] = key, () if witness is None else witness.links
    return {"links": links, "verdicts": verdicts}


def _diagnose_link(
    model: Model, link: Link, own: DeclaredInertial, witness: InertialReference | None
) -> Diagnosis | None:
    """None where nothing can be said: what is drawn is not known, or it is known in two ways that lead to different causes."""
    twin, trusted = (None, False) if witness is None else (witness.numbers, witness.trusted)
    found: list[Diagnosis] = []
    for reading in _list_geometry_readings(model, link):
        told = diagnose_inertial(own, reading, twin, trusted=trusted)
        found += [] if told is None else [told]
        if told is not None and told.sound:
            break
    drawn = measure_link_geometry(model, link)
    if drawn is None:
        return diagnose_inertial(own, None, twin, trusted=trusted)
    if not found or (not found[-1].sound and len({d.cause for d in found}) > 1):
        return None
    first = found[-1] if found[-1].sound else found[0]
    # Whether the tensors of an assembly's parts were added shows only when its mesh is taken apart.
    explained = first.sound if first.com_mismatch > _NEAR_COM else first.tensor_mismatch < EXACT
    parts = () if explained or (first.cause is not None and first.unique) else split_visual_bodies(model, link)
    apart = diagnose_inertial(own, replace(drawn, pieces=parts), twin, trusted=trusted) if len(parts) > 1 else None
    return apart if apart is not None and apart.cause is not None else first


def _list_geometry_readings(model: Model, link: Link) -> Iterator[VisualGeometry]:
    """What a link may be meant to draw: its own shapes, without COLLADA's ``<unit>`` and with its ``<up_axis>`` where that
    matters, and together with those of links that are fixed to it and have no mass of their own, such as covers."""
    own = measure_link_geometry(model, link)
    if own is None:
        return
    yield own
    if (
        has_unit_ambiguity(model, [link.name])
        and (other := measure_link_geometry(model, link, apply_unit=False)) is not None
    ):
        yield other
    if (
        has_up_axis_ambiguity(model, [link.name])
        and (stood := measure_link_geometry(model, link, apply_up_axis=True)) is not None
    ):
        yield stood
    covers = _list_massless_covers(model, link)
    if covers and (whole := merge_geometry(model, link, covers)) is not None:
        yield whole


def _list_massless_covers(model: Model, link: Link) -> list[Link]:
    """The links that are fixed to one, have no inertial of their own, and draw something. None where it is not known where they
    are."""
    try:
        tree, _ = model.tree, model.frames
    except FactUnavailableError:
        return []
    found = []
    queue = [link.name]
    while queue:
        for joint in tree.child_joints[queue.pop()]:
            child = model.link_by_name[joint.child]
            if joint.type == "fixed" and child.inertial is None:
                queue.append(child.name)
                if has_drawn_shape(child):
                    found.append(child)
    return found


def _collect_references(model: Model) -> dict[str, InertialReference]:
    """What other links say that one's numbers should be, by name: those that draw the same part, else that on the other side."""
    try:
        known = mirror_pairs(model)
        copied = copies.estimate_from_copies(model, excluded={frozenset((pair.one, pair.other)) for pair in known})
    except FactUnavailableError:
        return {}
    found = {
        name: InertialReference(told.expected, tuple(link.name for link in told.by), len(told.by) > 1)
        for name, told in copied.items()
    }
    for pair in known:
        for name, other in ((pair.one, pair.other), (pair.other, pair.one)):
            if name not in found and (twin := estimate_from_twin(model, model.link_by_name[name], [pair])) is not None:
                found[name] = InertialReference(twin, (other,), trusted=False)
    return found


def _compute_cache_key(model: Model, link: Link, own: DeclaredInertial, witness: InertialReference | None) -> str:
    """What the verdict on a link depends on."""
    covers = _list_massless_covers(model, link)
    places = [repr((np.linalg.inv(model.frames[link.name]) @ model.frames[one.name]).tolist()) for one in covers]
    told = () if witness is None else (_format_numbers(witness.numbers), str(witness.trusted))
    return _hash_drawing(model, [link, *covers], [*places, _format_numbers(own), *told])


def _hash_drawing(model: Model, links: Iterable[Link], others: Iterable[str]) -> str:
    """Of what some links draw, and of ``others``."""
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


def _read_entry(entry: MutableMapping[str, Arrays]) -> dict[str, Any]:
    """What is known; nothing where that is damaged."""
    try:
        known = json.loads(entry["links"]["text"].tobytes())
        return {"whole": known["whole"], "links": dict(known["links"]), "verdicts": dict(known["verdicts"])}
    except (KeyError, TypeError, ValueError):
        return {"whole": None, "links": {}, "verdicts": {}}


def _write_entry(entry: MutableMapping[str, Arrays], known: Mapping[str, Any]) -> None:
    entry["links"] = {"text": np.frombuffer(json.dumps(known).encode(), dtype=np.uint8)}


def _encode_diagnosis(diagnosis: Diagnosis) -> dict[str, Any]:
    """A diagnosis as plain values."""
    found = {name: getattr(diagnosis, name) for name in Diagnosis.__slots__}
    mended = diagnosis.mended
    if mended is not None:
        found["mended"] = [mended.mass, mended.com.tolist(), mended.tensor.tolist(), mended.rotation.tolist()]
    return found


def _decode_diagnosis(plain: Mapping[str, Any]) -> Diagnosis:
    mended = plain["mended"]
    if mended is not None:
        mended = DeclaredInertial(mended[0], *(np.array(part) for part in mended[1:]))
    return Diagnosis(**{**plain, "mended": mended, "ruled_out": tuple(plain["ruled_out"])})
