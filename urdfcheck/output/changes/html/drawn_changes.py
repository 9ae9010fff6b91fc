"""What the 3D view shows of a comparison: both versions of each model, and the parts that each row of the page is about."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from urdfcheck.core.model_diff import LinkShift, MechanismChange, MechanismEffect, ReportedStep
from urdfcheck.core.scene import Scene
from urdfcheck.output.changes.html.compared_models import ComparedModel
from urdfcheck.output.changes.summary import get_label
from urdfcheck.output.html.viewer.scene_data import IDENTITY, MeshPool, build_model, round_values
from urdfcheck.output.shared.anchors import FindingCard

# The layers that show a category of changes best; other ones are seen in the shapes.
_LAYERS: Mapping[str, tuple[str, ...]] = {
    "structure": ("frames",),
    "kinematic": ("axes", "frames"),
    "limits": ("axes",),
    "dynamic": ("com", "box"),
    "collision": ("collision",),
    "inertia": ("com", "box"),
}
_EFFECT_LAYERS: Mapping[str, tuple[str, ...]] = {
    "collision": ("collision",),
    "inertia": ("axes", "com"),
    "stability": ("ground", "com"),
}
# Effects that the first version has and the second has not.
_GONE = frozenset({"pair-clears", "rest-clears"})
_PART = re.compile(r"(link|joint)\[([^\]]*)\]", re.DOTALL)


def build_versions_data(
    models: Iterable[ComparedModel], steps: Sequence[ReportedStep] = ()
) -> tuple[dict[str, Any], bytes]:
    """Build the JSON values of the drawn models and the bytes of the meshes of all versions, each content once."""
    pool = MeshPool()
    drawn = [model for model in models if model.is_drawn]
    titles = Counter(model.title for model in drawn)
    built = [
        _build_versions(
            model, model.title if titles[model.title] == 1 else f"{model.title} ({model.name})", pool, steps
        )
        for model in drawn
    ]
    return {"models": built, "meshes": pool.entries}, b"".join(pool.data)


def _build_versions(model: ComparedModel, title: str, pool: MeshPool, steps: Sequence[ReportedStep]) -> dict[str, Any]:
    def build(scene: Scene, cards: Sequence[FindingCard]) -> dict[str, Any]:
        # What a repair would make of it is no version.
        return build_model(model.id, title=title, scene=replace(scene, previews=()), cards=cards, meshes=pool)

    if model.before is None or model.after is None:
        only, cards = (model.after, model.new) if model.before is None else (model.before, model.gone)
        assert only is not None
        return build(only, cards)
    names = _PartNames(model.before, model.after, {} if model.found is None else model.found.new_names)
    values = build(model.after, model.new)
    before = build(model.before, model.gone)
    gone = [_translate_finding(finding, names) for finding in before.pop("findings")]
    values["findings"] += [*gone, *_iter_entries(model, names), *_iter_step_entries(model, names, steps)]
    return {
        **values,
        "before": {**before, "findings": []},
        "beforeAt": round_values(IDENTITY if model.found is None else model.found.root_pose),
        "renamed": names.list_old_names(),
    }


class _PartNames:
    """What the parts of the first version are called in the second, as far as both are drawn."""

    def __init__(self, before: Scene, after: Scene, renamed: Mapping[tuple[str, str], str]) -> None:
        self._renamed = renamed
        self._old_links = {link.name for link in before.links}
        self._new_links = {link.name for link in after.links}
        self._old_children = {joint.name: joint.child for joint in before.joints}
        self._new_children = {joint.name: joint.child for joint in after.joints}

    def find_links(self, kind: str, name: str, new_name: str = "") -> tuple[str, str]:
        """Return the link of a part, of a joint its child, in the first and in the second version; empty where there is none."""
        new_name = new_name or self.get_new_name(kind, name)
        if kind == "joint":
            return self._old_children.get(name, ""), self._new_children.get(new_name, "")
        return name if name in self._old_links else "", new_name if new_name in self._new_links else ""

    def get_new_name(self, kind: str, name: str) -> str:
        """Return what the second version calls a part."""
        return self._renamed.get((kind, name), name)

    def has_joint(self, name: str) -> bool:
        """Whether the second version has a joint of this name."""
        return name in self._new_children

    def list_old_names(self) -> dict[str, dict[str, str]]:
        """Return what has another name in the second version: the name in the first, by the new one."""
        return {
            f"{kind}s": {new: old for (own, old), new in self._renamed.items() if own == kind}
            for kind in ("link", "joint")
        }


def _translate_finding(finding: dict[str, Any], names: _PartNames) -> dict[str, Any]:
    """Name the parts of a finding of the first version as the second calls them."""
    pairs = [names.find_links("link", name) for name in finding["links"]]
    pairs += [names.find_links("joint", name) for name in finding["joints"]]
    translated = {**finding, **_name_parts(pairs), "joints": []}
    # What it is compared with is the first version's too.
    translated.pop("beside", None)
    if "pose" in finding:
        translated["pose"] = _name_positions(finding["pose"], names)
    return translated


def _name_parts(pairs: Iterable[tuple[str, str]]) -> dict[str, list[str]]:
    known = list(dict.fromkeys(pair for pair in pairs if any(pair)))
    return {"links": [new for _, new in known], "before": [old for old, _ in known]}


def _iter_entries(model: ComparedModel, names: _PartNames) -> Iterator[dict[str, Any]]:
    """Yield what each row of the page shows; their ids are those of the rows."""
    found = model.found
    if found is None:
        return
    for number, change in enumerate(found.changes):
        yield _build_entry(
            f"{model.id}-c{number}",
            get_label(change.category),
            pairs=_list_pairs(change, names),
            joints=[names.get_new_name(*part) for part in _PART.findall(change.subject) if part[0] == "joint"],
            layers=_LAYERS.get(change.category, ()),
            names=names,
        )
    for number, shift in enumerate(found.shifts):
        yield _build_shift(f"{model.id}-s{number}", shift, names)
    for number, torque in enumerate(found.torques):
        pair = names.find_links("joint", torque.joint)
        joints = [names.get_new_name("joint", torque.joint)]
        yield _build_entry(
            f"{model.id}-t{number}", "gravity", pairs=[pair], joints=joints, layers=("axes", "com"), names=names
        )
    for number, effect in enumerate(found.effects):
        yield _build_effect(f"{model.id}-e{number}", effect, names)


def _build_shift(entry_id: str, shift: LinkShift, names: _PartNames) -> dict[str, Any]:
    """Build what shows how far a link moves: the whole robot in both versions, where it moves most."""
    pairs = [names.find_links("link", shift.link)]
    entry = _build_entry(entry_id, "motion", pairs=pairs, joints=[], layers=(), names=names)
    pose = _name_positions(shift.configuration, names)
    return {**entry, "pose": pose, "whole": True} if pose else entry


def _build_effect(entry_id: str, effect: MechanismEffect, names: _PartNames) -> dict[str, Any]:
    """Build what shows an effect: its parts, where it is largest, in the version that has it."""
    parts = [part for subject in (effect.subject, effect.other) for part in _PART.findall(subject)]
    # A stance is that of the whole robot.
    shown = [] if effect.kind == "stability" else parts
    entry = _build_entry(
        entry_id,
        effect.kind,
        pairs=[names.find_links(*part) for part in shown],
        joints=[names.get_new_name(*part) for part in shown if part[0] == "joint"],
        layers=_EFFECT_LAYERS[effect.kind],
        names=names,
    )
    if effect.kind == "collision":
        entry["inside"] = True
    if pose := _name_positions(effect.configuration, names):
        entry["pose"] = pose
    return {**entry, "gone": True} if effect.id in _GONE else entry


def _name_positions(configuration: Mapping[str, float], names: _PartNames) -> dict[str, float]:
    """Name the joints of a configuration as the second version calls them."""
    return {names.get_new_name("joint", joint): value for joint, value in configuration.items()}


def _iter_step_entries(
    model: ComparedModel, names: _PartNames, steps: Sequence[ReportedStep]
) -> Iterator[dict[str, Any]]:
    """Yield what the row of each step of a repair shows."""
    for number, step in enumerate(steps):
        parts = [part for subject in step.parts for part in _PART.findall(subject)]
        yield _build_entry(
            f"{model.id}-r{number}",
            step.stage,
            pairs=[names.find_links(kind, name) for kind, name in parts],
            joints=[name for kind, name in parts if kind == "joint"],
            layers=_LAYERS.get(step.stage, ()),
            names=names,
        )


def _list_pairs(change: MechanismChange, names: _PartNames) -> list[tuple[str, str]]:
    """Return the links that a change is about, in both versions; a part that came or went brings others with it."""
    parts = _PART.findall(change.subject)
    new_name = change.new_name if len(parts) == 1 else ""
    pairs = [names.find_links(kind, name, new_name) for kind, name in parts]
    brought = change.words.get("links", "") if change.category == "structure" else ""
    return pairs + [names.find_links("link", name) for name in brought.split(", ") if name]


def _build_entry(
    entry_id: str,
    label: str,
    *,
    pairs: Iterable[tuple[str, str]],
    joints: Sequence[str],
    layers: Sequence[str],
    names: _PartNames,
) -> dict[str, Any]:
    return {
        "id": entry_id,
        "code": label,
        "severity": "",
        **_name_parts(pairs),
        "joints": [joint for joint in joints if names.has_joint(joint)],
        "layers": list(layers),
        "preview": [],
    }
