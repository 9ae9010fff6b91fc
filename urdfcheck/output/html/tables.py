"""What was measured, as tables: links, meshes, joints, skipped checks, rules."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

from urdfcheck.core import Rule, Run
from urdfcheck.core.scene import Scene, SceneInertia, SceneJoint, SceneLink, SceneMesh, SceneShape
from urdfcheck.output.html.glyphs import glyph
from urdfcheck.output.html.text import NONE, esc, grouped, inline, millimetres, number, scaled, some
from urdfcheck.output.shared.anchors import Element, Mark, names_it
from urdfcheck.output.shared.wording import plural

MOST_MODELS = 4
MOST_USERS = 12
# By how much a principal moment must differ from the uniform solid's: e^1.6, where INR009 begins to call an inertia wrong.
FAR = 5.0


def table(caption: str, head: str, rows: Iterable[str], foot: str = "") -> str:
    """A table in a box of its own that scrolls where the page is too narrow."""
    foot = f"<tfoot>{foot}</tfoot>" if foot else ""
    return (
        f'<div class="scroll" role="group" tabindex="0" aria-label="{caption}"><table><caption>{caption}</caption>'
        f"<thead>{head}</thead><tbody>{''.join(rows)}</tbody>{foot}</table></div>"
    )


# -- links -------------------------------------------------------------------------------------------------------------


def physics_table(scene: Scene, marks: Mapping[Element, Mark]) -> str:
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
    rows = (_physics_row(link, marks.get(("link", link.name))) for link in scene.links)
    solid = (
        "<p>The solid of a link is its drawn geometry, filled uniformly with its mass. Moments are far off where they differ "
        "from those of the solid by a factor of five or more.</p>"
    )
    return solid + table("What the file says, and how far it is from the solid", head, rows, _whole(scene))


def _physics_row(link: SceneLink, mark: Mark | None) -> str:
    inertial = link.inertial
    if inertial is None:
        return f'<tr>{_name(("link", link.name), mark)}<td class="none" colspan="14">no inertial</td></tr>'
    com = [NONE] * 3 if not inertial.com else [millimetres(v) for v in inertial.com]
    moments, power = ([NONE] * 3, "") if not inertial.moments else scaled(inertial.moments)
    density = NONE if link.density is None else _density(link.density)
    ratios = _ratios(inertial.moments, link.drawn_moments)
    far = any(not 1 / FAR < ratio < FAR for ratio in ratios)
    verdict = f'<td class="warning">{glyph("warning")} far off</td>' if far else "<td></td>"
    told = [number(ratio, 3) for ratio in ratios] or [NONE] * 3
    off = millimetres(math.dist(inertial.com, link.drawn_com)) if inertial.com and link.drawn_com else NONE
    return (
        f"<tr>{_name(('link', link.name), mark)}{''.join(map(_num, (number(inertial.mass), *com, *moments)))}"
        f'<td class="power">{power}</td>{_num(density)}{"".join(map(_num, told))}{verdict}{_num(off)}</tr>'
    )


def _ratios(moments: Sequence[float], drawn: Sequence[float]) -> list[float]:
    """Each principal moment to that of the uniform solid, the smallest to the smallest; none where one of them has no size."""
    if not moments or not drawn or not all(d > 0 for d in drawn):
        return []
    return [m / d for m, d in zip(moments, drawn, strict=True)]


def _whole(scene: Scene) -> str:
    """The mass of all links and, where each of them has its place, their COM."""
    bodies = [link for link in scene.links if link.inertial is not None and link.inertial.mass is not None]
    if not bodies:
        return ""
    placed = [_placed(link) for link in bodies]
    total = math.fsum(mass for mass, _ in placed)
    com = [NONE] * 3
    if total > 0 and all(place for _, place in placed):
        com = [millimetres(math.fsum(mass * place[i] for mass, place in placed) / total) for i in range(3)]
    return (
        f'<tr><th scope="row">All together<br><small>base frame, joints at zero</small></th>'
        f'{"".join(map(_num, (number(total), *com)))}<td colspan="10"></td></tr>'
    )


def _placed(link: SceneLink) -> tuple[float, tuple[float, ...]]:
    """Mass and COM in the base frame; no COM where it has no place."""
    inertial = link.inertial or SceneInertia()
    if not link.world or not inertial.com:
        return inertial.mass or 0.0, ()
    rows = (link.world[0:4], link.world[4:8], link.world[8:12])
    return inertial.mass or 0.0, tuple(
        math.fsum(a * b for a, b in zip(row, (*inertial.com, 1.0), strict=True)) for row in rows
    )


def _density(value: float) -> str:
    return grouped(float(f"{value:.3g}")) if 100 <= value < 1e6 else number(value, 3)


# -- meshes ------------------------------------------------------------------------------------------------------------


def meshes_table(scene: Scene) -> str:
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
    folder = _folder([mesh.name for mesh in scene.meshes])
    first: dict[str, SceneMesh] = {}
    for mesh in scene.meshes:
        if mesh.digest:
            first.setdefault(mesh.digest, mesh)
    rows = [
        _mesh_row(scene.meshes[shape.file], folder, users, first)
        if (shape := users[0][1]).file is not None
        else _shape_row(shape, users)
        for users in sorted(uses.values(), key=lambda users: users[0][1].file is None)
    ]
    if not rows:
        return "<p>No link has a shape.</p>"
    total = sum(mesh.bytes for mesh in scene.meshes)
    foot = (
        f'<tr><th scope="row">{plural(len(scene.meshes), "file")}</th><td colspan="7"></td>{_num(grouped(total))}</tr>'
        if scene.meshes
        else ""
    )
    where = f", with files in {esc(folder)}" if folder else ""
    return table(f"What is drawn and what collides{where}", head, rows, foot)


def _mesh_row(
    mesh: SceneMesh, folder: str, users: Sequence[tuple[str, SceneShape]], first: Mapping[str, SceneMesh]
) -> str:
    told = f"<code>{esc(mesh.name[len(folder) :])}</code>"
    original = first.get(mesh.digest, mesh)
    if original is not mesh:
        told += f"<br><small>same content as <code>{esc(original.name[len(folder) :])}</code></small>"
    if mesh.problem:
        told += f"<br><small>{esc(mesh.problem)}</small>"
    closed = NONE if mesh.watertight is None else "no" if not mesh.watertight else f"{glyph('ok')} yes"
    scales = list(dict.fromkeys(shape.size for _, shape in users if len(shape.size) == 3))
    sizes = [_times([abs(s * e) for s, e in zip(scale, mesh.extents, strict=True)]) for scale in scales if mesh.extents]
    known = mesh.triangles or not mesh.problem
    return (
        f'<tr><th scope="row">{told}</th><td>{_users(users)}</td><td>{esc(mesh.format) or NONE}</td>'
        f'{_num(grouped(mesh.triangles) if known else NONE)}<td class="{"ok" if mesh.watertight else "open"}">{closed}</td>'
        f"{_num(grouped(mesh.open_edges) if mesh.watertight is not None else NONE)}"
        f"{_num('<br>'.join(_times(s) if len(set(s)) > 1 else number(s[0], 6) for s in scales) or NONE)}"
        f"{_num('<br>'.join(dict.fromkeys(sizes)) or NONE)}{_num(grouped(mesh.bytes))}</tr>"
    )


def _shape_row(shape: SceneShape, users: Sequence[tuple[str, SceneShape]]) -> str:
    name = f"<code>{esc(shape.mesh)}</code>" if shape.kind == "mesh" else esc(shape.kind) or "no shape"
    size = NONE if shape.kind == "mesh" or not shape.size else _times(_extents(shape))
    kind = "not found" if shape.kind == "mesh" else "primitive" if shape.kind else NONE
    return (
        f'<tr><th scope="row">{name}</th><td>{_users(users)}</td><td>{kind}</td>{_num(NONE)}<td>{NONE}</td>{_num(NONE)}'
        f"{_num(NONE)}{_num(size)}{_num(NONE)}</tr>"
    )


def _extents(shape: SceneShape) -> Sequence[float]:
    """Along x y z."""
    if shape.kind == "sphere":
        return [2 * shape.size[0]] * 3
    if shape.kind in ("cylinder", "capsule"):
        radius, length = shape.size
        return 2 * radius, 2 * radius, length + (2 * radius if shape.kind == "capsule" else 0.0)
    return shape.size


def _users(users: Sequence[tuple[str, SceneShape]]) -> str:
    """The links, by what they use the shape for."""
    roles: dict[str, dict[str, None]] = {}
    for link, shape in users:
        roles.setdefault(link, {})[shape.role] = None
    alike: dict[tuple[str, ...], list[str]] = {}
    for link, used in roles.items():
        alike.setdefault(tuple(used), []).append(link)
    told = []
    for of, links in alike.items():
        names = ", ".join(named(("link", link)) for link in links[:MOST_USERS])
        more = f" and {len(links) - MOST_USERS} more" if len(links) > MOST_USERS else ""
        told.append(f"{names}{more} <small>{' and '.join(map(esc, of))}</small>")
    return "<br>".join(told)


def _times(values: Sequence[float]) -> str:
    return " × ".join(number(value, 3) for value in values)


def _folder(names: Sequence[str]) -> str:
    """The folder that all these files lie in, with its slash; empty where there is none."""
    if len(names) < 2:
        return ""
    low, high = min(names), max(names)
    same = next((i for i, (a, b) in enumerate(zip(low, high, strict=False)) if a != b), len(low))
    return low[: low.rfind("/", 0, same) + 1]


# -- joints ------------------------------------------------------------------------------------------------------------


def joints_table(scene: Scene, marks: Mapping[Element, Mark]) -> str:
    """The joints, with a column for each further property that one of them has."""
    extra = [column for column in _EXTRA if any(column.value(joint) != NONE for joint in scene.joints)]
    head = (
        '<tr><th scope="col">Joint</th><th scope="col">Type</th><th scope="col">Parent</th><th scope="col">Child</th>'
        '<th scope="col">Axis</th><th scope="col">Limits</th>'
        + "".join(f'<th scope="col" class="{c.style}">{c.head}</th>' for c in extra)
        + "</tr>"
    )
    rows = (_joint_row(joint, marks.get(("joint", joint.name)), extra) for joint in scene.joints)
    linear = ". Of a prismatic joint: N, m/s, N·s/m" if any(column.style == "num" for column in extra) else ""
    return table(f"Axes in the base frame, all joints at zero{linear}", head, rows)


@dataclass(frozen=True, slots=True)
class _Column:
    head: str
    value: Callable[[SceneJoint], str]
    style: str = "num"


def _mimic(joint: SceneJoint) -> str:
    if joint.mimic is None:
        return NONE
    master, multiplier, offset = joint.mimic
    times = "" if multiplier == 1 else f"{number(multiplier)} × "
    plus = "" if offset == 0 else f" {'−' if offset < 0 else '+'} {number(abs(offset))}"
    return f"{times}{named(('joint', master))}{plus}"


_EXTRA = (
    _Column("Mimics", _mimic, "vector"),
    _Column("Effort<br><small>N·m</small>", lambda joint: number(joint.effort)),
    _Column("Velocity<br><small>rad/s</small>", lambda joint: number(joint.velocity)),
    _Column("Damping<br><small>N·m·s/rad</small>", lambda joint: number(joint.damping)),
    _Column("Friction<br><small>N·m</small>", lambda joint: number(joint.friction)),
)


def _joint_row(joint: SceneJoint, mark: Mark | None, extra: Sequence[_Column]) -> str:
    axis = NONE if joint.axis is None else ", ".join(number(round(a, 4) + 0.0) for a in joint.axis)
    more = "".join(f'<td class="{column.style}">{column.value(joint)}</td>' for column in extra)
    return (
        f"<tr>{_name(('joint', joint.name), mark)}<td>{esc(joint.type)}</td><td>{named(('link', joint.parent))}</td>"
        f'<td>{named(("link", joint.child))}</td><td class="vector">{axis}</td><td class="vector">{_limits(joint)}</td>'
        f"{more}</tr>"
    )


def _limits(joint: SceneJoint) -> str:
    if joint.lower is None and joint.upper is None:
        return NONE
    if joint.type == "prismatic":
        ends = [NONE if v is None else millimetres(v) for v in (joint.lower, joint.upper)]
        return f"{ends[0]} … {ends[1]} mm"
    ends = [number(v) for v in (joint.lower, joint.upper)]
    degrees = [NONE if v is None else number(round(math.degrees(v), 1) + 0.0) for v in (joint.lower, joint.upper)]
    return f"{ends[0]} … {ends[1]} rad <small>({degrees[0]}° … {degrees[1]}°)</small>"


def named(of: Element) -> str:
    """The name of a link or a joint, by which the page's script finds it in the 3D view."""
    return f"<code{names_it(of)}>{esc(of[1])}</code>"


def _name(of: Element, mark: Mark | None) -> str:
    sign = ""
    if mark is not None:
        told = f"{plural(mark.count, 'finding')}, worst: {mark.severity}"
        sign = f' <a class="{mark.severity}" href="#{mark.anchor}">{glyph(mark.severity)}<span class="sr">{told}</span></a>'
    return f'<th scope="row">{named(of)}{sign}</th>'


def _num(text: str) -> str:
    return f'<td class="num">{text}</td>'


# -- checks ------------------------------------------------------------------------------------------------------------


def skipped_table(run: Run) -> str:
    """One row per check and reason; ``run.skipped`` must not be empty."""
    models: dict[tuple[str, str], list[str]] = {}
    for skip in run.skipped:
        models.setdefault((skip.code, skip.reason), []).append(skip.model)
    rows = []
    for (code, reason), names in sorted(models.items()):
        rule = run.rules.get(code)
        name = "" if rule is None else f" {esc(rule.name)}"
        rows.append(
            f'<tr><th scope="row"><code>{esc(code)}</code>{name}</th><td>{esc(reason)}</td>'
            f"<td>{esc(some(list(dict.fromkeys(names)), MOST_MODELS))}</td></tr>"
        )
    head = '<tr><th scope="col">Check</th><th scope="col">Why it could not run</th><th scope="col">Models</th></tr>'
    return table("Checks that could not run", head, rows)


def rules_table(run: Run) -> str:
    """Every rule of the run with what it found, the quiet ones too."""
    fired: dict[str, int] = {}
    for finding in run.findings:
        fired[finding.code] = fired.get(finding.code, 0) + 1
    skipped: dict[str, int] = {}
    for skip in run.skipped:
        skipped[skip.code] = skipped.get(skip.code, 0) + 1
    rows = (_rule_row(rule, fired.get(code, 0), skipped.get(code, 0)) for code, rule in sorted(run.rules.items()))
    head = '<tr><th scope="col">Rule</th><th scope="col">What it checks</th><th scope="col">Outcome</th></tr>'
    return table("Rules of this run", head, rows)


def _rule_row(rule: Rule, fired: int, skipped: int) -> str:
    name = f"<code>{esc(rule.code)}</code> {esc(rule.name)}"
    if fired:
        name = f'<a href="#rule-{esc(rule.code)}">{name}</a>'
    outcome = [plural(fired, "finding")] if fired else []
    outcome += [f"skipped {plural(skipped, 'time')}"] if skipped else []
    return f'<tr><th scope="row">{name}</th><td>{inline(rule.summary)}</td><td>{", ".join(outcome) or "no finding"}</td></tr>'
