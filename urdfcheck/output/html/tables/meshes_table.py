"""The meshes and shapes of a model, as a table."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from urdfcheck.core.scene import Scene, SceneMesh, SceneShape
from urdfcheck.output.html.element_names import render_element_name
from urdfcheck.output.html.glyphs import render_glyph
from urdfcheck.output.html.html_text import NO_VALUE, escape_html, format_number, format_whole_number
from urdfcheck.output.html.tables.html_table import render_number_cell, render_table
from urdfcheck.output.shared.wording import format_count

MOST_USERS = 12


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
        f'<tr><th scope="row">{format_count(len(scene.meshes), "file")}</th><td colspan="7"></td>{render_number_cell(format_whole_number(total))}</tr>'
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
        f'{render_number_cell(format_whole_number(mesh.triangles) if known else NO_VALUE)}<td class="{"ok" if mesh.watertight else "open"}">{closed}</td>'
        f"{render_number_cell(format_whole_number(mesh.open_edges) if mesh.watertight is not None else NO_VALUE)}"
        f"{render_number_cell('<br>'.join(_format_dimensions(s) if len(set(s)) > 1 else format_number(s[0], 6) for s in scales) or NO_VALUE)}"
        f"{render_number_cell('<br>'.join(dict.fromkeys(sizes)) or NO_VALUE)}{render_number_cell(format_whole_number(mesh.bytes))}</tr>"
    )


def _render_shape_row(shape: SceneShape, users: Sequence[tuple[str, SceneShape]]) -> str:
    name = f"<code>{escape_html(shape.mesh)}</code>" if shape.kind == "mesh" else escape_html(shape.kind) or "no shape"
    size = NO_VALUE if shape.kind == "mesh" or not shape.size else _format_dimensions(_compute_extents(shape))
    kind = "not found" if shape.kind == "mesh" else "primitive" if shape.kind else NO_VALUE
    return (
        f'<tr><th scope="row">{name}</th><td>{_render_users(users)}</td><td>{kind}</td>{render_number_cell(NO_VALUE)}<td>{NO_VALUE}</td>{render_number_cell(NO_VALUE)}'
        f"{render_number_cell(NO_VALUE)}{render_number_cell(size)}{render_number_cell(NO_VALUE)}</tr>"
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
