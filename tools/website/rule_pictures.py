"""Pictures of a Bad and a Good example on the page of a rule, by the renderer of ``-o png``.

What the 3D view of the report shows for the rule is drawn as solids beside the robot: frames as crosses of three bars, axes and
boxes of inertia as bars, COMs as balls. Where no box has the principal moments, these are bars: the largest, and the other
two. The links that the finding is about are red.
"""

from __future__ import annotations

import itertools
import tempfile
from collections.abc import Container, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from urdfcheck.core import Finding, Rule
from urdfcheck.core.scene import Scene, SceneInertia, SceneLink, SceneShape
from urdfcheck.dev.rule_examples import Files, list_examples
from urdfcheck.output.shared.robot_picture import render_scene
from urdfcheck.run.pipeline import IN_THIS_PROCESS, run
from urdfcheck.run.request import RunOptions, make_request

Array = NDArray[np.float64]
WIDTH, HEIGHT = 480, 360
# As the report colours them: what a finding is about, x, y and z of a frame, an axis, an inertia, a COM, what collides.
_RED, _FRAME = (0.78, 0.2, 0.16, 1.0), ((0.85, 0.25, 0.2, 1.0), (0.2, 0.6, 0.25, 1.0), (0.2, 0.4, 0.85, 1.0))
_AXIS, _BOX, _COM, _COLLISION = (
    (0.1, 0.6, 0.65, 1.0),
    (0.6, 0.1, 0.6, 1.0),
    (0.1, 0.1, 0.1, 1.0),
    (0.85, 0.65, 0.1, 1.0),
)
_BONE = (0.55, 0.58, 0.62, 1.0)
# Parts of the robot's size: a bar of a frame, how thick it is, and the radius of a COM; what is smaller is a dot.
_LONG, _THIN, _BALL, _SEEN = 0.12, 0.012, 0.025, 0.1
# The bars of principal moments that no box has: how thick they are, and how far apart, as parts of the largest.
_MOMENT_THICK, _MOMENT_APART = 0.08, 0.14
_MOMENTS_SAID = (
    ". No box has these principal moments: the red bar is the largest, and the other two, end to end, are shorter"
)


@dataclass(frozen=True, slots=True)
class RulePictures:
    """A Bad and a Good example of a rule, as PNG."""

    bad: bytes
    good: bytes
    headline: str
    """What is reported about the bad one, and what its bars mean if they need it."""


def draw_rule(rule: Rule) -> RulePictures | None:
    """Draw the first Bad example that has something to mark, and the Good one whose links are most like its own.

    None if there are no such examples, if only the mark tells them apart, or if the rule is about a text.
    """
    if rule.layers == ("visual",) and not rule.code.startswith("MSH"):
        return None
    goods = [*_iter_drawn(rule, "Good")]
    for bad in _iter_drawn(rule, "Bad") if goods else ():
        good = min(goods, key=lambda good: len(_name_links(good.scene) ^ _name_links(bad.scene)))
        marked = _draw(bad.scene, rule, bad.findings)
        if bad.picture not in (marked, good.picture) and _is_mark_seen(bad.scene, rule, bad.findings):
            said = _MOMENTS_SAID if any(_compare_moments(link.inertial) is not None for link in bad.scene.links) else ""
            return RulePictures(marked, good.picture, bad.findings[0].headline + (said if "box" in rule.layers else ""))
    return None


@dataclass(frozen=True, slots=True)
class _Drawn:
    """An example that can be drawn."""

    scene: Scene
    findings: Sequence[Finding]
    """Of the rule."""
    picture: bytes
    """A PNG in which nothing is marked."""


def _iter_drawn(rule: Rule, heading: str) -> Iterator[_Drawn]:
    for files in list_examples(rule.page, heading):
        scenes, findings = _check_example(rule, files)
        for scene in scenes:
            if picture := _draw(scene, rule, ()):
                yield _Drawn(scene, findings, picture)


def _check_example(rule: Rule, files: Files) -> tuple[tuple[Scene, ...], Sequence[Finding]]:
    with tempfile.TemporaryDirectory() as place:
        for name, text in files:
            path = Path(place, name)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8", newline="")
        target = Path(place) if len(files) > 1 else Path(place, files[0][0])
        options = RunOptions(paths=(target,), select=(rule.code, *rule.hidden_by), cache=False)
        outcome = run(make_request(options, scene=True)[0], IN_THIS_PROCESS)
    return outcome.scenes, [finding for finding in outcome.findings if finding.code == rule.code]


def _draw(scene: Scene, rule: Rule, findings: Iterable[Finding]) -> bytes:
    """Draw a robot with what the rule is about; empty if there is nothing but one place."""
    marked = _list_links(scene, findings)
    size = _measure_scene(scene)
    if not size:
        return b""
    links = tuple(replace(link, shapes=(*_iter_shapes(link, rule, size, link.name in marked),)) for link in scene.links)
    return render_scene(replace(scene, links=_add_joints(scene, links, rule, size, marked)), WIDTH, HEIGHT)


def _name_links(scene: Scene) -> set[str]:
    return {link.name for link in scene.links}


def _list_links(scene: Scene, findings: Iterable[Finding]) -> set[str]:
    """Return the links that findings are about; a joint moves its child."""
    named = {subject.partition("]")[0] + "]" for finding in findings for subject in finding.subjects}
    children = {joint.child for joint in scene.joints if f"joint[{joint.name}]" in named}
    return children | {link.name for link in scene.links if f"link[{link.name}]" in named}


def _is_mark_seen(scene: Scene, rule: Rule, findings: Iterable[Finding]) -> bool:
    """Whether what is marked is more than a dot: a way between two frames always is."""
    marked = _list_links(scene, findings)
    largest = max((_measure_link(scene, link) for link in scene.links if link.name in marked), default=0.0)
    return bool(marked) and ("frames" in rule.layers or largest > _SEEN * _measure_scene(scene))


def _measure_scene(scene: Scene) -> float:
    """Return about how large a robot is (m): from its origins, its COMs and its largest link."""
    places = np.array([*_iter_places(scene)] or [(0.0, 0.0, 0.0)])
    return float(np.ptp(places, axis=0).max() + max((_measure_link(scene, link) for link in scene.links), default=0.0))


def _iter_places(scene: Scene) -> Iterator[Array]:
    for link in scene.links:
        if link.world:
            world = np.reshape(link.world, (4, 4))
            yield world[:3, 3]
            if link.inertial is not None and len(link.inertial.com) == 3:
                yield world[:3, :3] @ link.inertial.com + world[:3, 3]


def _measure_link(scene: Scene, link: SceneLink) -> float:
    """Return the longest side (m) of the shapes and the box of inertia of a link."""
    box, bars = _compute_box(link.inertial), _compare_moments(link.inertial)
    lengths = [_measure_shape(scene, shape) for shape in link.shapes]
    lengths += [float(lines.max()) for lines in (box, bars) if lines is not None]
    return max(lengths, default=0.0)


def _measure_shape(scene: Scene, shape: SceneShape) -> float:
    extents = scene.meshes[shape.file].extents if shape.file is not None else ()
    lengths = [abs(a * b) for a, b in zip(extents, shape.size, strict=False)] if extents else shape.size
    return max(lengths, default=0.0)


def _iter_shapes(link: SceneLink, rule: Rule, size: float, is_marked: bool) -> Iterator[SceneShape]:
    """Yield what is drawn of a link in its frame."""
    for shape in link.shapes:
        if shape.role == "visual" or "collision" in rule.layers:
            colour = _RED if is_marked else _COLLISION if shape.role != "visual" else None
            yield replace(shape, role="visual", color=colour)
    inertial, box = link.inertial, _compute_box(link.inertial)
    if inertial is None or len(inertial.com) != 3:
        return
    if "com" in rule.layers and (link.shapes or box is not None):
        colour = _RED if is_marked else _COM
        yield SceneShape(role="visual", kind="sphere", size=(size * _BALL,), pose=_place(inertial.com), color=colour)
    if "box" in rule.layers and box is not None:
        yield from _iter_edges(box, inertial, size * _THIN, _RED if is_marked else _BOX)
    bars = _compare_moments(inertial)
    if "box" in rule.layers and bars is not None:
        yield from _iter_moments(bars, inertial.com, _RED if is_marked else _BOX)


def _compute_box(inertial: SceneInertia | None) -> Array | None:
    """Return the sides (m) of the box with this mass and these principal moments; None where no box has them."""
    if inertial is None or not inertial.mass or inertial.mass < 0 or len(inertial.moments) != 3 or inertial.impossible:
        return None
    moments = np.array(inertial.moments)
    squares: Array = 6 * (moments.sum() - 2 * moments) / inertial.mass
    return np.sqrt(squares) if np.isfinite(squares).all() and (squares >= 0).all() else None


def _compare_moments(inertial: SceneInertia | None) -> Array | None:
    """Return lengths (m) in the ratio of the principal moments, ascending, where the largest exceeds the sum of the others.

    No body has such moments. The longest is about as long as a box of this mass and trace.
    """
    if inertial is None or not inertial.mass or inertial.mass < 0 or len(inertial.moments) != 3:
        return None
    moments = np.array(inertial.moments)
    if not np.isfinite(moments).all() or moments[0] <= 0 or moments[2] <= moments[0] + moments[1]:
        return None
    lengths: Array = moments / moments[2] * np.sqrt(6 * moments.sum() / inertial.mass)
    return lengths


def _iter_moments(lengths: Array, com: Sequence[float], colour: tuple[float, ...]) -> Iterator[SceneShape]:
    """Yield the largest of three ascending lengths (m) as a bar along x, and beside it the other two end to end."""
    one, two, largest = lengths.tolist()
    thick, apart, first = largest * _MOMENT_THICK, largest * _MOMENT_APART, np.array((*com,))
    bars = ((0.0, 0.0, largest, colour), (0.0, -apart, two, _FRAME[2]), (two, -apart, one, _AXIS))
    for along, across, length, own in bars:
        yield _make_bar(
            np.array((length, 0.0, 0.0)), thick, own, from_=first + np.array((along - largest / 2, across, 0.0))
        )


def _iter_edges(sides: Array, inertial: SceneInertia, thick: float, colour: tuple[float, ...]) -> Iterator[SceneShape]:
    """Yield the edges of a box about the COM, along the principal axes."""
    axes = np.reshape(inertial.axes, (3, 3))
    for along in range(3):
        lengths = np.full(3, thick)
        lengths[along] += sides[along]
        for signs in itertools.product((-0.5, 0.5), repeat=2):
            middle = np.insert(np.array(signs), along, 0.0) * sides
            pose = _place(np.array(inertial.com) + axes @ middle, axes)
            yield SceneShape(role="visual", kind="box", size=(*lengths.tolist(),), pose=pose, color=colour)


def _add_joints(
    scene: Scene, links: Sequence[SceneLink], rule: Rule, size: float, marked: Container[str]
) -> tuple[SceneLink, ...]:
    """Add the frames of links with the way to them, and the axes of joints, as shapes of the children."""
    joints = {joint.child: joint for joint in scene.joints}
    added = []
    for link in links:
        bars: list[SceneShape] = []
        joint = joints.get(link.name)
        if "frames" in rule.layers:
            bars += (_make_bar(np.eye(3)[k] * size * _LONG, size * _THIN, _FRAME[k]) for k in range(3))
        if "axes" in rule.layers and joint is not None and joint.turn is not None and joint.type != "fixed":
            turn = np.array(joint.turn) * size * _LONG * 1.5
            bars.append(_make_bar(2 * turn, size * _THIN * 1.4, _RED if link.name in marked else _AXIS, from_=-turn))
        if "frames" in rule.layers and joint is not None and len(joint.pose) == 16:
            parent = np.linalg.inv(np.reshape(joint.pose, (4, 4)))[:3, 3]
            bars.append(_make_bar(parent, size * _THIN / 2, _RED if link.name in marked else _BONE))
        added.append(replace(link, shapes=(*link.shapes, *bars)))
    return (*added,)


def _make_bar(
    way: Array, thick: float, colour: tuple[float, ...], from_: Array | tuple[float, ...] = (0.0, 0.0, 0.0)
) -> SceneShape:
    """Return a bar along a way (m) in the frame of a link."""
    length = float(np.linalg.norm(way))
    along = way / length if length else np.array((0.0, 0.0, 1.0))
    across = np.cross(along, np.eye(3)[np.abs(along).argmin()])
    across /= np.linalg.norm(across)
    axes = np.column_stack((across, np.cross(along, across), along))
    pose = _place(np.array(from_) + way / 2, axes)
    return SceneShape(role="visual", kind="box", size=(thick, thick, length + thick), pose=pose, color=colour)


def _place(position: Array | Sequence[float], axes: Array | None = None) -> tuple[float, ...]:
    """Return a pose, 4x4 row-major."""
    pose = np.eye(4)
    pose[:3, :3] = np.eye(3) if axes is None else axes
    pose[:3, 3] = position
    return (*pose.ravel().tolist(),)
