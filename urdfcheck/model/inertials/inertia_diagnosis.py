"""What is wrong with the inertial of each link, judged by what it draws and by the links that mirror or copy it."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import asdict

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
from urdfcheck.facts.inertials.diagnosis import Diagnosis
from urdfcheck.facts.inertials.mistakes.file_habits import Evidence, Habit, Key, decide_habit, list_candidates
from urdfcheck.model.fact import fact
from urdfcheck.model.inertials.diagnosis.added_pieces import join_added_pieces
from urdfcheck.model.inertials.diagnosis.commented_masses import name_commented_masses
from urdfcheck.model.inertials.diagnosis.computed_tensors import name_computed_mass
from urdfcheck.model.inertials.diagnosis.edited_masses import name_edited_masses
from urdfcheck.model.inertials.diagnosis.inertial_references import collect_references
from urdfcheck.model.inertials.diagnosis.kept_verdicts import (
    KeptVerdicts,
    decode_diagnosis,
    decode_evidence,
    encode_diagnosis,
    encode_evidence,
    read_verdicts,
    write_verdicts,
)
from urdfcheck.model.inertials.diagnosis.link_diagnosis import diagnose_link, measure_link_evidence
from urdfcheck.model.inertials.diagnosis.mesh_frames import name_mesh_frames
from urdfcheck.model.inertials.diagnosis.rounded_masses import name_units_of_rounded_masses
from urdfcheck.model.inertials.diagnosis.units_of_bounds import doubt_units_of_bounds
from urdfcheck.model.inertials.diagnosis.verdict_keys import compute_model_key, compute_verdict_key
from urdfcheck.model.inertials.diagnosis.weak_causes import drop_causes_of_bounds, drop_weak_causes
from urdfcheck.model.inertials.unmoved_pieces import join_unmoved_pieces
from urdfcheck.model.likeness.declared_inertials import read_declared_inertial
from urdfcheck.model.meshes import MEASURING_MODULES
from urdfcheck.model.parts import has_drawn_shape
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.repeated_drawings import find_repeated_drawings, find_stand_in_drawings
from urdfcheck.system.installation import compute_code_version

# The modules and packages that decide a verdict, besides the numbers and the drawing.
_CODE_MODULES = (
    "urdfcheck.facts.inertials",
    "urdfcheck.facts.likeness",
    "urdfcheck.facts.motion.kinematics",
    "urdfcheck.model.ground.wheels",
    "urdfcheck.model.inertials.diagnosis",
    "urdfcheck.model.inertials.inertia_diagnosis",
    "urdfcheck.model.likeness",
    "urdfcheck.model.parts",
    "urdfcheck.model.shapes",
    *MEASURING_MODULES,
)


@dataclass(frozen=True, slots=True, eq=False)
class DiagnosedInertial:
    """A link's inertial as declared, and what is wrong with it."""

    declared: DeclaredInertial
    diagnosis: Diagnosis
    twins: tuple[str, ...]
    """The links (by name) whose inertials say so, if any."""
    is_habit: bool
    """Whether most links of the file have this mistake."""


@fact
def inertial_diagnoses(model: Model) -> Mapping[str, DiagnosedInertial]:
    """Diagnose every link that has a mass and a tensor, and draws something or has a twin; by name. Not those that draw one thing
    in one place, or one primitive in place of many parts, which is not the part.

    A link whose numbers and drawing are those of an earlier run is not diagnosed again.
    """
    unknown = find_repeated_drawings(model) | find_stand_in_drawings(model)
    numbers = {
        name: declared
        for name, link in model.link_by_name.items()
        if name not in unknown and (declared := read_declared_inertial(link)) is not None
    }
    # An editor asks for a part of the tiers and for all in turns, and with meshes other verdicts are needed than without.
    text = f"{model.source.path}\0{model.name}\0{model.tier}\0{compute_code_version(*_CODE_MODULES)}"
    key = hashlib.sha256(text.encode(errors="surrogatepass")).hexdigest()  # a file name may not be valid text
    entry = model.cache.entry("diagnosis", key)
    known = read_verdicts(entry)
    whole = compute_model_key(model, numbers)
    if known.whole != whole:
        known = _diagnose_all(model, numbers, known)
        known.whole = whole
        write_verdicts(entry, known)
    habit = None if known.habit is None else (known.habit["id"], known.habit["detail"])
    kept = {name: decode_diagnosis(known.verdicts[verdict]) for name, (verdict, _) in known.links.items()}
    decoded = drop_causes_of_bounds(model, numbers, kept)
    diagnosed = {}
    others = {name: one for name, one in decoded.items() if (one.cause, one.detail) != habit}
    joined = join_unmoved_pieces(model, numbers, decoded | drop_weak_causes(model, numbers, others))
    added = join_added_pieces(model, numbers, joined)
    in_units = name_units_of_rounded_masses(model, numbers, added)
    doubted = doubt_units_of_bounds(model, numbers, in_units, habit)
    commented = name_commented_masses(model, numbers, doubted)
    named = name_mesh_frames(model, numbers, name_edited_masses(model, numbers, commented))
    for name, diagnosis in named.items():
        is_habit = diagnosis.cause is not None and (diagnosis.cause, diagnosis.detail) == habit
        own = diagnosis if is_habit else name_computed_mass(model, model.link_by_name[name], numbers[name], diagnosis)
        diagnosed[name] = DiagnosedInertial(numbers[name], own, tuple(known.links[name][1]), is_habit)
    return diagnosed


def _diagnose_all(model: Model, numbers: Mapping[str, DeclaredInertial], known: KeptVerdicts) -> KeptVerdicts:
    """Diagnose each link alone, then all together where links fit a mistake that a whole file has; from ``known`` where
    possible."""
    found = KeptVerdicts()
    references = collect_references(model)
    for name, declared in numbers.items():
        link, reference = model.link_by_name[name], references.get(name)
        if reference is None and not has_drawn_shape(link):
            continue
        key = compute_verdict_key(model, link, declared=declared, reference=reference)
        if key in known.verdicts:
            found.verdicts[key] = known.verdicts[key]
            if key in known.evidence:
                found.evidence[key] = known.evidence[key]
        else:
            diagnosis = diagnose_link(model, link, declared=declared, reference=reference)
            if diagnosis is None:
                continue
            found.verdicts[key] = encode_diagnosis(diagnosis)
            if diagnosis.evidence is not None:
                found.evidence[key] = encode_evidence(diagnosis.evidence)
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
            diagnosis = diagnose_link(
                model,
                model.link_by_name[name],
                declared=numbers[name],
                reference=references.get(name),
                habit=habit,
            )
            verdict = found.verdicts[key] if diagnosis is None else encode_diagnosis(diagnosis)
        found.verdicts[key_with_habit] = verdict
        found.links[name] = key_with_habit, twins
    return found


def _find_habit(
    model: Model, numbers: Mapping[str, DeclaredInertial], found: KeptVerdicts, known: KeptVerdicts
) -> Habit | None:
    """Find the mistake that most links have. Without a link that fits one, nothing is computed."""
    candidates: dict[Key, None] = {}
    for key, verdict in found.verdicts.items():
        if not verdict["sound"] and key in found.evidence:
            candidates |= dict.fromkeys(list_candidates(decode_evidence(found.evidence[key])))
    if not candidates:
        return None
    different: dict[tuple[str, ...], Evidence] = {}  # copies and mirror images are one piece of evidence
    principal = dict(zip(found.links, np.linalg.eigvalsh([numbers[name].tensor for name in found.links]), strict=True))
    tensors = {name: numbers[name].tensor.tobytes() for name in found.links}
    alike: dict[bytes, list[str]] = {}
    for name, tensor in tensors.items():
        alike.setdefault(tensor, []).append(name)
    for name, (key, _) in found.links.items():
        if key not in found.evidence:
            evidence = known.evidence.get(key)
            if evidence is None:
                measured = measure_link_evidence(model, model.link_by_name[name], numbers[name])
                if measured is None:
                    continue
                evidence = encode_evidence(measured)
            found.evidence[key] = evidence
        # A tensor that links of several masses have is that of one of them at most.
        is_shared = len({numbers[other].mass for other in alike[tensors[name]]}) > 1
        moments = (0.0 if is_shared else numbers[name].mass, *principal[name])
        different.setdefault(tuple(f"{value:.3g}" for value in moments), decode_evidence(found.evidence[key]))
    return decide_habit(list(different.values()), list(candidates))
