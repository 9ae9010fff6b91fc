"""What was measured, as tables: links, meshes, joints, skipped checks, rules."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

from urdfcheck.core import Rule, Run
from urdfcheck.core.scene import Scene, SceneInertia, SceneJoint, SceneLink, SceneMesh, SceneShape
from urdfcheck.output.html.glyphs import render_glyph
from urdfcheck.output.html.text import (
    NO_VALUE,
    escape_html,
    format_millimetres,
    format_number,
    format_scaled,
    format_whole_number,
    join_first,
    render_inline,
)
from urdfcheck.output.shared.anchors import ElementKey, SeverityMark, render_data_attribute
from urdfcheck.output.shared.wording import format_count

MOST_MODELS = 4
MOST_USERS = 12
# By how much a principal moment must differ from the uniform solid's: e^1.6, where INR009 begins to call an inertia wrong.
FAR_RATIO = 5.0


def render_table(caption: str, head: str, rows: Iterable[str], foot: str = "") -> str:
    """A table in a box of its own that scrolls where the page is too narrow."""
    foot = f"<tfoot>{foot}</tfoot>" if foot else ""
    return (
        f'<div class="scroll" role="group" tabindex="0" aria-label="{caption}"><table><caption>{caption}</caption>'
        f"<thead>{head}</thead><tbody>{''.join(rows)}</tbody>{foot}</table></div>"
    )


# -- links -------------------------------------------------------------------------------------------------------------


def render_physics_table(scene: Scene, marks: Mapping[ElementKey, SeverityMark]) -> str:
    """What each link weighs, beside what its drawn geometry would be with that mass, filled uniformly."""
    head = (
        '<tr><th scope="col" rowspan="2">Link</th><th scope="col" rowspan="2" class="num">Mass<br><small>kg</small></th>'
        '<th scope="colgroup" colspan="3">Centre of mass <small>mm, link frame</small></th>'
        '<th scope="colgroup" colspan="4">Principal moments <small>kg·m²</small></th>'
        '<th scope="col" rowspan="2" class="num">Density<br><small>kg/m³</small></th>'
        '<th scope="colgroup" colspan="4">Moments ÷ solid’s</th>'
        '<th scope="col" rowspan="2" class="num">COMs apart<br><small>mm</small></th></tr>'
        "<tr>"
        + "".join(f'<th scope="col" class="num">{name}</th>' for name in ("x", "y", "z", "I₁", "I₂", "I₃"))
        + '<th scope="col"><span class="sr">power of ten</span></th>'
        + "".join(f'<th scope="col" class="num">{name}</th>' for name in ("I₁", "I₂", "I₃"))
        + '<th scope="col"><span class="sr">verdict</span></th></tr>'
    )
    rows = (_render_physics_row(link, marks.get(("link", link.name))) for link in scene.links)
    solid = (
        "<p>The solid of a link is its drawn geometry, filled uniformly with its mass. Moments are far off where they differ "
        "from those of the solid by a factor of five or more.</p>"
    )
    return solid + render_table(
        "What the file says, and how far it is from the solid", head, rows, _render_total_row(scene)
    )


def _render_physics_row(link: SceneLink, mark: SeverityMark | None) -> str:
    inertial = link.inertial
    if inertial is None:
        return f'<tr>{_render_name_cell(("link", link.name), mark)}<td class="none" colspan="14">no inertial</td></tr>'
    com = [NO_VALUE] * 3 if not inertial.com else [format_millimetres(v) for v in inertial.com]
    moments, power = ([NO_VALUE] * 3, "") if not inertial.moments else format_scaled(inertial.moments)
    density = NO_VALUE if link.density is None else _format_density(link.density)
    ratios = _compute_moment_ratios(inertial.moments, link.drawn_moments)
    far = any(not 1 / FAR_RATIO < ratio < FAR_RATIO for ratio in ratios)
    verdict = f'<td class="warning">{render_glyph("warning")} far off</td>' if far else "<td></td>"
    told = [format_number(ratio, 3) for ratio in ratios] or [NO_VALUE] * 3
    off = format_millimetres(math.dist(inertial.com, link.drawn_com)) if inertial.com and link.drawn_com else NO_VALUE
    return (
        f"<tr>{_render_name_cell(('link', link.name), mark)}{''.join(map(_render_number_cell, (format_number(inertial.mass), *com, *moments)))}"
        f'<td class="power">{power}</td>{_render_number_cell(density)}{"".join(map(_render_number_cell, told))}{verdict}{_render_number_cell(off)}</tr>'
    )


def _compute_moment_ratios(moments: Sequence[float], drawn_moments: Sequence[float]) -> list[float]:
    """Each principal moment to that of the uniform solid, the smallest to the smallest; none where one of them has no size."""
    if not moments or not drawn_moments or not all(d > 0 for d in drawn_moments):
        return []
    return [m / d for m, d in zip(moments, drawn_moments, strict=True)]


def _render_total_row(scene: Scene) -> str:
    """The mass of all links and, where each of them has its place, their COM."""
    bodies = [link for link in scene.links if link.inertial is not None and link.inertial.mass is not None]
    if not bodies:
        return ""
    placed = [_locate_base_com(link) for link in bodies]
    total = math.fsum(mass for mass, _ in placed)
    com = [NO_VALUE] * 3
    if total > 0 and all(place for _, place in placed):
        com = [format_millimetres(math.fsum(mass * place[i] for mass, place in placed) / total) for i in range(3)]
    return (
        f'<tr><th scope="row">All together<br><small>base frame, joints at zero</small></th>'
        f'{"".join(map(_render_number_cell, (format_number(total), *com)))}<td colspan="10"></td></tr>'
    )


def _locate_base_com(link: SceneLink) -> tuple[float, tuple[float, ...]]:
    """Mass and COM in the base frame; no COM where it has no place."""
    inertial = link.inertial or SceneInertia()
    if not link.world or not inertial.com:
        return inertial.mass or 0.0, ()
    rows = (link.world[0:4], link.world[4:8], link.world[8:12])
    return inertial.mass or 0.0, tuple(
        math.fsum(a * b for a, b in zip(row, (*inertial.com, 1.0), strict=True)) for row in rows
    )


def _format_density(value: float) -> str:
    return format_whole_number(float(f"{value:.3g}")) if 100 <= value < 1e6 else format_number(value, 3)


# -- meshes ------------------------------------------------------------------------------------------------------------


def render_meshes_table(scene: Scene) -> str:
    """Each mesh file, then each other shape, with the links that use it; both in the order of the links."""
    head = (
        '<tr><th scope="col">File or shape</th><th scope="col">Used by</th><th scope="col">Format</th>'
        '<th scope="col" class="num">Triangles</th><th scope="col">Watertight</th>'
        '<th scope="col" class="num">Open edges</th><th scope="col" class="num">Metres per unit</th>'
        '<th scope="col" class="num">Size <small>m</small></th><th scope="col" class="num">Bytes</th></tr>'
    )
    uses: dict[tuple[object, ...], list[tuple[str, SceneShape]]] = {}
    for link in scene.links:
        for shape in link.shapes:
            which = (shape.kind, shape.mesh, shape.size) if shape.file is None else (shape.file,)
            uses.setdefault(which, []).append((link.name, shape))
    folder = _find_shared_folder([mesh.name for mesh in scene.meshes])
    first: dict[str, SceneMesh] = {}
    for mesh in scene.meshes:
        if mesh.digest:
            first.setdefault(mesh.digest, mesh)
    rows = [
        _render_mesh_row(scene.meshes[shape.file], folder, users, first)
        if (shape := users[0][1]).file is not None
        else _render_shape_row(shape, users)
        for users in sorted(uses.values(), key=lambda users: users[0][1].file is None)
    ]
    if not rows:
        return "<p>No link has a shape.</p>"
    total = sum(mesh.bytes for mesh in scene.meshes)
    foot = (
        f'<tr><th scope="row">{format_count(len(scene.meshes), "file")}</th><td colspan="7"></td>{_render_number_cell(format_whole_number(total))}</tr>'
        if scene.meshes
        else ""
    )
    where = f", with files in {escape_html(folder)}" if folder else ""
    return render_table(f"What is drawn and what collides{where}", head, rows, foot)


def _render_mesh_row(
    mesh: SceneMesh, folder: str, users: Sequence[tuple[str, SceneShape]], first_by_digest: Mapping[str, SceneMesh]
) -> str:
    told = f"<code>{escape_html(mesh.name[len(folder) :])}</code>"
    original = first_by_digest.get(mesh.digest, mesh)
    if original is not mesh:
        told += f"<br><small>same content as <code>{escape_html(original.name[len(folder) :])}</code></small>"
    if mesh.problem:
        told += f"<br><small>{escape_html(mesh.problem)}</small>"
    closed = NO_VALUE if mesh.watertight is None else "no" if not mesh.watertight else f"{render_glyph('ok')} yes"
    scales = list(dict.fromkeys(shape.size for _, shape in users if len(shape.size) == 3))
    sizes = [
        _format_dimensions([abs(s * e) for s, e in zip(scale, mesh.extents, strict=True)])
        for scale in scales
        if mesh.extents
    ]
    known = mesh.triangles or not mesh.problem
    return (
        f'<tr><th scope="row">{told}</th><td>{_render_users(users)}</td><td>{escape_html(mesh.format) or NO_VALUE}</td>'
        f'{_render_number_cell(format_whole_number(mesh.triangles) if known else NO_VALUE)}<td class="{"ok" if mesh.watertight else "open"}">{closed}</td>'
        f"{_render_number_cell(format_whole_number(mesh.open_edges) if mesh.watertight is not None else NO_VALUE)}"
        f"{_render_number_cell('<br>'.join(_format_dimensions(s) if len(set(s)) > 1 else format_number(s[0], 6) for s in scales) or NO_VALUE)}"
        f"{_render_number_cell('<br>'.join(dict.fromkeys(sizes)) or NO_VALUE)}{_render_number_cell(format_whole_number(mesh.bytes))}</tr>"
    )


def _render_shape_row(shape: SceneShape, users: Sequence[tuple[str, SceneShape]]) -> str:
    name = f"<code>{escape_html(shape.mesh)}</code>" if shape.kind == "mesh" else escape_html(shape.kind) or "no shape"
    size = NO_VALUE if shape.kind == "mesh" or not shape.size else _format_dimensions(_compute_extents(shape))
    kind = "not found" if shape.kind == "mesh" else "primitive" if shape.kind else NO_VALUE
    return (
        f'<tr><th scope="row">{name}</th><td>{_render_users(users)}</td><td>{kind}</td>{_render_number_cell(NO_VALUE)}<td>{NO_VALUE}</td>{_render_number_cell(NO_VALUE)}'
        f"{_render_number_cell(NO_VALUE)}{_render_number_cell(size)}{_render_number_cell(NO_VALUE)}</tr>"
    )


def _compute_extents(shape: SceneShape) -> Sequence[float]:
    """Along x y z."""
    if shape.kind == "sphere":
        return [2 * shape.size[0]] * 3
    if shape.kind in ("cylinder", "capsule"):
        radius, length = shape.size
        return 2 * radius, 2 * radius, length + (2 * radius if shape.kind == "capsule" else 0.0)
    return shape.size


def _render_users(users: Sequence[tuple[str, SceneShape]]) -> str:
    """The links, by what they use the shape for."""
    roles: dict[str, dict[str, None]] = {}
    for link, shape in users:
        roles.setdefault(link, {})[shape.role] = None
    alike: dict[tuple[str, ...], list[str]] = {}
    for link, used in roles.items():
        alike.setdefault(tuple(used), []).append(link)
    told = []
    for of, links in alike.items():
        names = ", ".join(render_element_name(("link", link)) for link in links[:MOST_USERS])
        more = f" and {len(links) - MOST_USERS} more" if len(links) > MOST_USERS else ""
        told.append(f"{names}{more} <small>{' and '.join(map(escape_html, of))}</small>")
    return "<br>".join(told)


def _format_dimensions(values: Sequence[float]) -> str:
    return " × ".join(format_number(value, 3) for value in values)


def _find_shared_folder(names: Sequence[str]) -> str:
    """The folder that all these files lie in, with its slash; empty where there is none."""
    if len(names) < 2:
        return ""
    low, high = min(names), max(names)
    same = next((i for i, (a, b) in enumerate(zip(low, high, strict=False)) if a != b), len(low))
    return low[: low.rfind("/", 0, same) + 1]


# -- joints ------------------------------------------------------------------------------------------------------------


def render_joints_table(scene: Scene, marks: Mapping[ElementKey, SeverityMark]) -> str:
    """The joints, with a column for each further property that one of them has."""
    extra = [
        column for column in _OPTIONAL_COLUMNS if any(column.format_cell(joint) != NO_VALUE for joint in scene.joints)
    ]
    head = (
        '<tr><th scope="col">Joint</th><th scope="col">Type</th><th scope="col">Parent</th><th scope="col">Child</th>'
        '<th scope="col">Axis</th><th scope="col">Limits</th>'
        + "".join(f'<th scope="col" class="{c.css_class}">{c.head}</th>' for c in extra)
        + "</tr>"
    )
    rows = (_render_joint_row(joint, marks.get(("joint", joint.name)), extra) for joint in scene.joints)
    linear = ". Of a prismatic joint: N, m/s, N·s/m" if any(column.css_class == "num" for column in extra) else ""
    return render_table(f"Axes in the base frame, all joints at zero{linear}", head, rows)


@dataclass(frozen=True, slots=True)
class _JointColumn:
    head: str
    format_cell: Callable[[SceneJoint], str]
    css_class: str = "num"


def _format_mimic(joint: SceneJoint) -> str:
    if joint.mimic is None:
        return NO_VALUE
    master, multiplier, offset = joint.mimic
    times = "" if multiplier == 1 else f"{format_number(multiplier)} × "
    plus = "" if offset == 0 else f" {'−' if offset < 0 else '+'} {format_number(abs(offset))}"
    return f"{times}{render_element_name(('joint', master))}{plus}"


_OPTIONAL_COLUMNS = (
    _JointColumn("Mimics", _format_mimic, "vector"),
    _JointColumn("Effort<br><small>N·m</small>", lambda joint: format_number(joint.effort)),
    _JointColumn("Velocity<br><small>rad/s</small>", lambda joint: format_number(joint.velocity)),
    _JointColumn("Damping<br><small>N·m·s/rad</small>", lambda joint: format_number(joint.damping)),
    _JointColumn("Friction<br><small>N·m</small>", lambda joint: format_number(joint.friction)),
)


def _render_joint_row(joint: SceneJoint, mark: SeverityMark | None, extra: Sequence[_JointColumn]) -> str:
    axis = NO_VALUE if joint.axis is None else ", ".join(format_number(round(a, 4) + 0.0) for a in joint.axis)
    more = "".join(f'<td class="{column.css_class}">{column.format_cell(joint)}</td>' for column in extra)
    return (
        f"<tr>{_render_name_cell(('joint', joint.name), mark)}<td>{escape_html(joint.type)}</td><td>{render_element_name(('link', joint.parent))}</td>"
        f'<td>{render_element_name(("link", joint.child))}</td><td class="vector">{axis}</td><td class="vector">{_format_limits(joint)}</td>'
        f"{more}</tr>"
    )


def _format_limits(joint: SceneJoint) -> str:
    if joint.lower is None and joint.upper is None:
        return NO_VALUE
    if joint.type == "prismatic":
        ends = [NO_VALUE if v is None else format_millimetres(v) for v in (joint.lower, joint.upper)]
        return f"{ends[0]} … {ends[1]} mm"
    ends = [format_number(v) for v in (joint.lower, joint.upper)]
    degrees = [
        NO_VALUE if v is None else format_number(round(math.degrees(v), 1) + 0.0) for v in (joint.lower, joint.upper)
    ]
    return f"{ends[0]} … {ends[1]} rad <small>({degrees[0]}° … {degrees[1]}°)</small>"


def render_element_name(element_key: ElementKey) -> str:
    """The name of a link or a joint, by which the page's script finds it in the 3D view."""
    return f"<code{render_data_attribute(element_key)}>{escape_html(element_key[1])}</code>"


def _render_name_cell(element_key: ElementKey, mark: SeverityMark | None) -> str:
    sign = ""
    if mark is not None:
        told = f"{format_count(mark.count, 'finding')}, worst: {mark.severity}"
        sign = f' <a class="{mark.severity}" href="#{mark.anchor}">{render_glyph(mark.severity)}<span class="sr">{told}</span></a>'
    return f'<th scope="row">{render_element_name(element_key)}{sign}</th>'


def _render_number_cell(text: str) -> str:
    return f'<td class="num">{text}</td>'


# -- checks ------------------------------------------------------------------------------------------------------------


def render_skipped_table(run: Run) -> str:
    """One row per check and reason; ``run.skipped`` must not be empty."""
    models: dict[tuple[str, str], list[str]] = {}
    for skip in run.skipped:
        models.setdefault((skip.code, skip.reason), []).append(skip.model)
    rows = []
    for (code, reason), names in sorted(models.items()):
        rule = run.rules.get(code)
        name = "" if rule is None else f" {escape_html(rule.name)}"
        rows.append(
            f'<tr><th scope="row"><code>{escape_html(code)}</code>{name}</th><td>{escape_html(reason)}</td>'
            f"<td>{escape_html(join_first(list(dict.fromkeys(names)), MOST_MODELS))}</td></tr>"
        )
    head = '<tr><th scope="col">Check</th><th scope="col">Why it could not run</th><th scope="col">Models</th></tr>'
    return render_table("Checks that could not run", head, rows)


def render_rules_table(run: Run) -> str:
    """Every rule of the run with what it found, the quiet ones too."""
    fired: dict[str, int] = {}
    for finding in run.findings:
        fired[finding.code] = fired.get(finding.code, 0) + 1
    skipped: dict[str, int] = {}
    for skip in run.skipped:
        skipped[skip.code] = skipped.get(skip.code, 0) + 1
    rows = (
        _render_rule_row(rule, fired.get(code, 0), skipped.get(code, 0)) for code, rule in sorted(run.rules.items())
    )
    head = '<tr><th scope="col">Rule</th><th scope="col">What it checks</th><th scope="col">Outcome</th></tr>'
    return render_table("Rules of this run", head, rows)


def _render_rule_row(rule: Rule, fired: int, skipped: int) -> str:
    name = f"<code>{escape_html(rule.code)}</code> {escape_html(rule.name)}"
    if fired:
        name = f'<a href="#rule-{escape_html(rule.code)}">{name}</a>'
    outcome = [format_count(fired, "finding")] if fired else []
    outcome += [f"skipped {format_count(skipped, 'time')}"] if skipped else []
    return f'<tr><th scope="row">{name}</th><td>{render_inline(rule.summary)}</td><td>{", ".join(outcome) or "no finding"}</td></tr>'
