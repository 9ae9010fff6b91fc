"""The data of the robot in 3D: the numbers of the scenes as JSON values, and the meshes as one string of bytes."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from urdfcheck.core import Finding
from urdfcheck.core.scene import Scene, SceneDrawing, SceneInertia, SceneJoint, SceneLink, ScenePreview, SceneShape
from urdfcheck.output.shared.anchors import (
    ElementKey,
    FindingCard,
    SeverityMark,
    compute_severity_marks,
    parse_element_key,
)
from urdfcheck.output.shared.wording import format_count
from urdfcheck.rules import load_rules

# Edges of the box and semi-axes of the ellipsoid of uniform density with the moments I1, I2, I3 of a mass m:
# edge² = 6 (I2 + I3 - I1) / m, semi-axis² = 5 (I2 + I3 - I1) / (2 m), and cyclically.
_BOX, _ELLIPSOID = 6.0, 2.5
# What shows a part of a link.
_PART_LAYERS: Mapping[tuple[str, str], tuple[str, ...]] = {
    ("link", "inertial"): ("visual", "com", "box"),
    ("link", "collision"): ("visual", "collision"),
    ("link", "visual"): ("visual",),
}
_PART = re.compile(r"/(\w+)")
# The rules that compare parts which should be alike: of the others, which are right, a finding names the places.
_COMPARING = "SYM"
# In metres: a graphics card computes with seven digits, so that no robot is visible beside anything larger.
_LARGEST = 1e9
# Meshes that are named before the rest is counted.
_MOST_NAMED = 3
IDENTITY = (1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0)


def build_scene_data(models: Iterable[tuple[str, str, Scene, Sequence[FindingCard]]]) -> tuple[dict[str, Any], bytes]:
    """Build the JSON values of models and the bytes of their meshes, each content once.

    ``models``: id of their section in the page, name, scene and cards. Lengths in metres, poses 4x4 row-major; numbers with
    seven digits."""
    pool = MeshPool()
    built = [
        build_model(section_id, title=title, scene=scene, cards=cards, meshes=pool)
        for section_id, title, scene, cards in models
    ]
    return {"models": built, "meshes": pool.entries}, b"".join(pool.data)


def get_layers(finding: Finding) -> tuple[str, ...]:
    """Return the layers of the 3D view that show a finding best: those of its rule (see ``rules/families.toml``), and those of
    the part of a link that it is about. Axes and frames belong to joints: they show nothing of an inertial or a shape."""
    rule = load_rules().get(finding.code)
    layers = ("visual",) if rule is None else rule.layers
    parts = {_get_part(subject) for subject in finding.subjects}
    own = _PART_LAYERS.get(parts.pop(), ()) if len(parts) == 1 else ()
    if not own:
        return layers
    return tuple(dict.fromkeys([*(layer for layer in layers if layer not in ("axes", "frames")), *own]))


class MeshPool:
    """The drawings that the models share, each once: a description of each, and the bytes.

    The bytes are corners on a grid: those of a ball are the same wherever it is, and however large. Only with the bounds of the
    grid are they a drawing.
    """

    def __init__(self) -> None:
        self.entries: list[dict[str, Any]] = []
        self.data: list[bytes] = []
        self._places: dict[SceneDrawing, int] = {}
        self._offsets: dict[bytes, int] = {}
        self._end = 0

    def add_drawing(self, drawing: SceneDrawing) -> int:
        """Add a drawing unless one is known that differs in its colour alone, and return its index."""
        content = replace(drawing, color=None)
        if content not in self._places:
            self._places[content] = len(self.entries)
            self.entries.append(
                {
                    "offset": self._add_bytes(drawing.data),
                    "vertices": drawing.vertices,
                    "faces": drawing.faces,
                    "low": round_values(drawing.low),
                    "high": round_values(drawing.high),
                    "wide": drawing.wide,
                    "holes": drawing.holes,
                }
            )
        return self._places[content]

    def _add_bytes(self, data: bytes) -> int:
        """Add bytes unless they are known, and return where they begin."""
        if data not in self._offsets:
            self._offsets[data] = self._end
            self.data.append(data)
            self._end += len(data)
        return self._offsets[data]


def build_model(
    section_id: str, *, title: str, scene: Scene, cards: Sequence[FindingCard], meshes: MeshPool
) -> dict[str, Any]:
    """Build the JSON values of a model, and add its meshes to those of the page; see `build_scene_data`."""
    worst = compute_severity_marks(cards)
    active = [card for card in cards if card.finding.suppressed is None]
    links = frozenset(link.name for link in scene.links)
    by_pair = {pair: card.anchors[0] for card in active for pair in _iter_pairs(card.finding, links)}
    ground = scene.ground
    return {
        "id": section_id,
        "name": title,
        "root": scene.root,
        "links": [_build_link(link, worst, scene=scene, meshes=meshes) for link in scene.links],
        "joints": [_build_joint(joint, worst) for joint in scene.joints],
        "frames": [{"parent": f.parent, "child": f.child, "at": round_values(f.pose)} for f in scene.frames if f.pose],
        "overlaps": [
            {
                "a": overlap.links[0],
                "b": overlap.links[1],
                "points": [round_values(overlap.point)],
                "depth": _round_finite(overlap.depth),
                "finding": by_pair.get(frozenset(overlap.links)),
            }
            for overlap in scene.overlaps
        ],
        "ground": None
        if ground is None
        else {
            "height": _round_finite(ground.height),
            "contacts": [{"link": link, "point": round_values(point)} for link, point in ground.contacts],
            "support": [round_values(corner) for corner in ground.support],
            "com": round_values(ground.com),
            "stands": ground.stands,
        },
        "findings": _build_findings(active, scene),
        "undrawn": _describe_undrawn(scene),
    }


def _describe_undrawn(scene: Scene) -> str:
    """Name the meshes that would be drawn, and are missing or could not be read; empty without any."""
    shapes = [shape for link in scene.links for shape in link.shapes]
    role = "visual" if any(shape.role == "visual" for shape in shapes) else "collision"
    drawn = {
        shape.mesh: shape.file is not None and bool(scene.meshes[shape.file].drawings)
        for shape in shapes
        if shape.role == role and shape.kind == "mesh"
    }
    names = [mesh.rpartition("/")[2] for mesh, is_drawn in drawn.items() if not is_drawn]
    if not names:
        return ""
    verbs, more = "is missing or was" if len(names) == 1 else "are missing or were", len(names) - _MOST_NAMED
    listed = f"{', '.join(names[:_MOST_NAMED])}{f' and {more} more' if more > 0 else ''}"
    return f"{len(names)} of {format_count(len(drawn), 'mesh file')} {verbs} not read, and not drawn: {listed}"


def _build_link(
    link: SceneLink, worst: Mapping[ElementKey, SeverityMark], *, scene: Scene, meshes: MeshPool
) -> dict[str, Any]:
    inertial = link.inertial
    return {
        "name": link.name,
        "severity": _get_severity(worst, ("link", link.name)),
        "at": None if link.world is None else round_values(link.world),
        "visual": _build_shapes(link.shapes, "visual", scene=scene, meshes=meshes),
        "collision": _build_shapes(link.shapes, "collision", scene=scene, meshes=meshes),
        "mass": None if inertial is None or inertial.mass is None else _round_finite(inertial.mass),
        "com": round_values(inertial.com) if inertial is not None and inertial.com else None,
        "inertia": None if inertial is None else _build_inertia(inertial),
    }


def _get_severity(worst: Mapping[ElementKey, SeverityMark], element_key: ElementKey) -> str:
    mark = worst.get(element_key)
    return "" if mark is None else str(mark.severity)


def _build_shapes(shapes: Iterable[SceneShape], role: str, *, scene: Scene, meshes: MeshPool) -> list[dict[str, Any]]:
    """Build the shapes that can be drawn: not malformed, not too large, and not a mesh that could not be read."""
    drawn = []
    for shape in shapes:
        if shape.role != role or not shape.pose or not shape.size or not _is_drawable_size(shape.size):
            continue
        look = {"at": round_values(shape.pose), "color": None if shape.color is None else round_values(shape.color)}
        if shape.kind == "mesh":
            for drawing in () if shape.file is None else scene.meshes[shape.file].drawings:
                if not all(
                    _is_drawable_size([s * v for s, v in zip(shape.size, corner, strict=True)])
                    for corner in (drawing.low, drawing.high)
                ):
                    continue
                color = look["color"] or (None if drawing.color is None else round_values(drawing.color))
                scale = round_values(shape.size)
                drawn.append({"mesh": meshes.add_drawing(drawing), "scale": scale, **look, "color": color})
        elif min(shape.size) > 0:
            drawn.append({shape.kind: round_values(shape.size), **look})
    return drawn


def _is_drawable_size(lengths: Iterable[float]) -> bool:
    return all(abs(length) <= _LARGEST for length in lengths)


def _build_inertia(inertial: SceneInertia) -> dict[str, Any] | None:
    """Build the body that has the moments, or why there is none; None for a point mass and for malformed values."""
    if inertial.impossible:
        return {"impossible": inertial.impossible, "com": round_values(inertial.com) if inertial.com else None}
    if not inertial.mass or not inertial.com or not inertial.moments or inertial.moments[-1] <= 0.0:
        return None
    first, second, third = inertial.moments
    # A square below zero is the rounding error of a flat body.
    squares = [
        max(0.0, s) / inertial.mass for s in (second + third - first, third + first - second, first + second - third)
    ]
    a, x, y = inertial.axes, inertial.com, (0.0, 0.0, 0.0, 1.0)
    return {
        "at": round_values((*a[0:3], x[0], *a[3:6], x[1], *a[6:9], x[2], *y)),
        "principal": round_values(inertial.moments),
        "box": round_values([math.sqrt(_BOX * s) for s in squares]),
        "ellipsoid": round_values([math.sqrt(_ELLIPSOID * s) for s in squares]),
    }


def _build_joint(joint: SceneJoint, worst: Mapping[ElementKey, SeverityMark]) -> dict[str, Any]:
    name, *numbers = joint.mimic or ("",)
    factors = [_restrict_to_reachable(number) for number in numbers]
    return {
        "name": joint.name,
        "type": joint.type,
        "severity": _get_severity(worst, ("joint", joint.name)),
        "parent": joint.parent,
        "child": joint.child,
        "at": round_values(joint.pose or IDENTITY),
        "axis": None if joint.turn is None else round_values(joint.turn),
        "lower": _restrict_to_reachable(joint.lower),
        "upper": _restrict_to_reachable(joint.upper),
        "start": _restrict_to_reachable(joint.start) or 0,
        "mimic": {"joint": name, "multiplier": factors[0], "offset": factors[1]}
        if factors and None not in factors
        else None,
    }


def _restrict_to_reachable(value: float | None) -> float | None:
    """Return a position that a slider can have, None if it is beyond the largest shape that is drawn."""
    return value if value is not None and abs(value) <= _LARGEST else None


def _build_findings(cards: Iterable[FindingCard], scene: Scene) -> list[dict[str, Any]]:
    previews: dict[object, list[dict[str, Any]]] = {}
    for preview in scene.previews:
        previews.setdefault((preview.code, preview.message_id, preview.at), []).append(_build_preview(preview))
    return [_build_finding(card, previews, scene) for card in cards]


def _build_finding(card: FindingCard, previews: Mapping[object, list[dict[str, Any]]], scene: Scene) -> dict[str, Any]:
    finding = card.finding
    places = {(own.code, own.message_id, own.location.span): None for own in finding.list_occurrences()}
    preview = [shown for place in places for shown in previews.get(place, [])]
    own, beside = _sort_elements(finding)
    layers = get_layers(finding)
    if not own:
        own = [("link", name) for name in _list_named_links(finding, scene)]
        # A transform that a launch file publishes.
        layers = (*layers, "frames") if "parent" in finding.data and "frames" not in layers else layers
    values: dict[str, Any] = {
        "id": card.anchors[0],
        "code": finding.code,
        "severity": str(finding.severity),
        "links": [name for kind, name in own if kind == "link"],
        "joints": [name for kind, name in own if kind == "joint"],
        "layers": [*layers, *(["preview"] if preview else [])],
        "preview": preview,
    }
    if beside:
        values["beside"] = {f"{kind}s": [name for k, name in beside if k == kind] for kind in ("link", "joint")}
    if pose := _get_pose(finding, scene):
        values["pose"] = pose
    return values


def _sort_elements(finding: Finding) -> tuple[list[tuple[str, str]], list[tuple[str, str]]]:
    """Return the links and joints that have the defect, and those that it is only compared with or refers to.

    A related place has the same defect if it is the same part of another link or joint: one finding tells of them all."""
    own = dict.fromkeys(_iter_elements(finding.subjects))
    # A mesh that is drawn and one that collides are both shapes.
    shapes = ("visual", "collision")
    parts = {_get_part(subject) for subject in finding.subjects}
    parts |= {(kind, shape) for kind, part in parts if part in shapes for shape in shapes}
    beside: dict[tuple[str, str], None] = {}
    for each in finding.list_occurrences():
        own |= dict.fromkeys(_iter_elements(_list_texts(each.data.get("between"))))
        if own:
            kind = next(iter(own))[0]
            twins = (each.data.get("twin"), each.data.get("one"))
            beside |= dict.fromkeys((kind, name) for name in twins if isinstance(name, str) and name)
    for place in (finding, *finding.occurrences):
        for related in place.related:
            is_same = not finding.code.startswith(_COMPARING) and _get_part(related.subject) in parts
            (own if is_same and own else beside).update(dict.fromkeys(_iter_elements([related.subject])))
    return list(own), [key for key in beside if key not in own]


def _iter_elements(subjects: Iterable[str]) -> Iterator[tuple[str, str]]:
    """Yield the link or joint of each subject that is in one."""
    for subject in subjects:
        if key := parse_element_key(subject):
            yield key[0], key[1]


def _list_texts(value: object) -> list[str]:
    return [text for text in value if isinstance(text, str)] if isinstance(value, (list, tuple)) else []


def _get_part(subject: str) -> tuple[str, str]:
    """Return what a subject is a part of, and which: ``("link", "inertial")`` for ``link[wheel_1]/inertial/mass@value``."""
    key = parse_element_key(subject)
    if key is None:
        return "", ""
    rest = _PART.match(subject, len(f"{key[0]}[{key[1]}]"))
    return key[0], rest[1] if rest else ""


def _iter_pairs(finding: Finding, links: frozenset[str]) -> Iterator[frozenset[str]]:
    """Yield the pairs of links that a finding is about: at each place one link, and each of those that it meets."""
    for own in finding.list_occurrences():
        named = [name for key in ("link", "other") if isinstance(name := own.data.get(key), str) and name in links]
        met = [name for kind, name in _iter_elements(place.subject for place in own.related) if kind == "link"]
        for other in dict.fromkeys([*named[1:], *met]) if named else ():
            if other != named[0]:
                yield frozenset((named[0], other))


def _list_named_links(finding: Finding, scene: Scene) -> list[str]:
    """List the links that the data of a finding name, of a transform those that it places."""
    links = frozenset(link.name for link in scene.links)
    keys = ("parent", "child") if "parent" in finding.data else ("link", "other", "first", "second", "child")
    names = (finding.data.get(key) for key in keys)
    return list(dict.fromkeys(name for name in names if isinstance(name, str) and name in links))


def _get_pose(finding: Finding, scene: Scene) -> dict[str, float]:
    """Return the joint positions at which a finding was measured; empty where that is every one at its start."""
    pose = finding.list_occurrences()[0].data.get("pose")
    if not isinstance(pose, Mapping):
        return {}
    joints = {joint.name for joint in scene.joints}
    positions = {name: value for name, value in pose.items() if name in joints and isinstance(value, (int, float))}
    known = {name: _restrict_to_reachable(_round_finite(value)) for name, value in positions.items()}
    return {name: value for name, value in known.items() if value is not None}


def _build_preview(preview: ScenePreview) -> dict[str, Any]:
    if preview.inertial is None:
        return {"joint": preview.joint, "at": round_values(preview.pose)}
    com = preview.inertial.com
    return {
        "link": preview.link,
        "com": round_values(com) if com else None,
        "inertia": _build_inertia(preview.inertial),
    }


def round_values(values: Iterable[float]) -> list[float | None]:
    """Round to seven digits; what is not finite is None."""
    return [_round_finite(v) for v in values]


def _round_finite(value: float) -> float | None:
    """Round to seven digits; None, which is null in JSON, if not finite."""
    if not math.isfinite(value):
        return None
    short = float(f"{value:.7g}")
    return int(short) if short.is_integer() and abs(short) < 1e7 else short
