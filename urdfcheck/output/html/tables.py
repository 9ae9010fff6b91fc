"""What was measured, as tables: links, joints, skipped checks, rules."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence

from urdfcheck.core import Rule, Run, Scene, SceneJoint, SceneLink, SceneShape
from urdfcheck.output.html.anchors import Element, Mark
from urdfcheck.output.html.glyphs import glyph
from urdfcheck.output.html.text import NONE, esc, grouped, inline, millimetres, number, plural, scaled, some

MOST_MODELS = 4


def table(caption: str, head: str, rows: Iterable[str], foot: str = "") -> str:
    """A table in a box of its own that scrolls where the page is too narrow."""
    foot = f"<tfoot>{foot}</tfoot>" if foot else ""
    return (
        f'<div class="scroll" role="group" tabindex="0" aria-label="{caption}"><table><caption>{caption}</caption>'
        f"<thead>{head}</thead><tbody>{''.join(rows)}</tbody>{foot}</table></div>"
    )


# -- links -------------------------------------------------------------------------------------------------------------


def links_table(scene: Scene, marks: Mapping[Element, Mark]) -> str:
    head = (
        '<tr><th scope="col" rowspan="2">Link</th><th scope="col" rowspan="2" class="num">Mass<br><small>kg</small></th>'
        '<th scope="colgroup" colspan="3">Centre of mass <small>mm, link frame</small></th>'
        '<th scope="colgroup" colspan="4">Principal moments <small>kg·m²</small></th>'
        '<th scope="col" rowspan="2" class="num">Density<br><small>kg/m³</small></th>'
        '<th scope="colgroup" colspan="2">Triangles</th><th scope="col" rowspan="2">Watertight</th></tr>'
        "<tr>"
        + "".join(f'<th scope="col" class="num">{name}</th>' for name in ("x", "y", "z", "I₁", "I₂", "I₃"))
        + '<th scope="col"><span class="sr">power of ten</span></th>'
        '<th scope="col" class="num">drawn</th><th scope="col" class="num">colliding</th></tr>'
    )
    masses = [link.mass for link in scene.links if link.mass is not None]
    foot = (
        f'<tr><th scope="row">Total</th>{_num(number(math.fsum(masses)))}<td colspan="11"></td></tr>' if masses else ""
    )
    rows = (_link_row(link, marks.get(("link", link.name))) for link in scene.links)
    return table("What the file says, and what the meshes measure", head, rows, foot)


def _link_row(link: SceneLink, mark: Mark | None) -> str:
    com = [NONE] * 3 if not link.com else [millimetres(v) for v in link.com]
    moments, power = ([NONE] * 3, "") if not link.principal else scaled(link.principal)
    cells = [number(link.mass), *com, *moments]
    density = NONE if link.density is None else _density(link.density)
    return (
        f'<tr>{_name(link.name, mark)}{"".join(map(_num, cells))}<td class="power">{power}</td>{_num(density)}'
        f"{_num(_geometry(link.shapes, 'visual'))}{_num(_geometry(link.shapes, 'collision'))}{_watertight(link.shapes)}</tr>"
    )


def _density(value: float) -> str:
    return grouped(float(f"{value:.3g}")) if 100 <= value < 1e6 else number(value, 3)


def _geometry(shapes: Sequence[SceneShape], role: str) -> str:
    """The triangles of all meshes of a role; where there is no mesh, what there is instead."""
    own = [s for s in shapes if s.role == role]
    triangles = sum(s.triangles for s in own)
    if triangles:
        return grouped(triangles)
    kinds: dict[str, int] = {}
    for shape in own:
        kinds[shape.kind] = kinds.get(shape.kind, 0) + 1
    return ", ".join(esc(kind) if n == 1 else f"{n} × {esc(kind)}" for kind, n in kinds.items()) or NONE


def _watertight(shapes: Sequence[SceneShape]) -> str:
    known = {s.mesh: s.watertight for s in shapes if s.watertight is not None}
    if not known:
        return f"<td>{NONE}</td>"
    if all(known.values()):
        return f'<td class="ok">{glyph("ok")} yes</td>'
    open_meshes = sum(not closed for closed in known.values())
    return "<td>no</td>" if open_meshes == len(known) else f"<td>{open_meshes} of {len(known)} open</td>"


# -- joints ------------------------------------------------------------------------------------------------------------


def joints_table(scene: Scene, marks: Mapping[Element, Mark]) -> str:
    head = (
        '<tr><th scope="col">Joint</th><th scope="col">Type</th><th scope="col">Parent</th><th scope="col">Child</th>'
        '<th scope="col">Axis</th><th scope="col">Limits</th></tr>'
    )
    rows = (_joint_row(joint, marks.get(("joint", joint.name))) for joint in scene.joints)
    return table("Axes in the base frame, all joints at zero", head, rows)


def _joint_row(joint: SceneJoint, mark: Mark | None) -> str:
    axis = NONE if joint.axis is None else ", ".join(number(round(a, 4) + 0.0) for a in joint.axis)
    return (
        f"<tr>{_name(joint.name, mark)}<td>{esc(joint.type)}</td><td><code>{esc(joint.parent)}</code></td>"
        f'<td><code>{esc(joint.child)}</code></td><td class="vector">{axis}</td><td class="vector">{_limits(joint)}</td></tr>'
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


def _name(name: str, mark: Mark | None) -> str:
    sign = ""
    if mark is not None:
        told = f"{plural(mark.count, 'finding')}, worst: {mark.severity}"
        sign = f' <a class="{mark.severity}" href="#{mark.anchor}">{glyph(mark.severity)}<span class="sr">{told}</span></a>'
    return f'<th scope="row"><code>{esc(name)}</code>{sign}</th>'


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
