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
    """Render a row for each mesh file, then for each other shape, with the links that use it; both in the order of the links."""
    head = (
        '<tr><th scope="col">File or shape</th><th scope="col">Used by</th><th scope="col">Format</th>'
        '<th scope="col" class="num">Triangles</th><th scope="col">Watertight</th>'
        '<th scope="col" class="num">Open edges</th><th scope="col" class="num">Metres per unit</th>'
        '<th scope="col" class="num">Size <small>m</small></th><th scope="col" class="num">Bytes</th></tr>'
    )
    uses: dict[tuple[object, ...], list[tuple[str, SceneShape]]] = {}
    for link in scene.links:
        for shape in link.shapes:
            key = (shape.kind, shape.mesh, shape.size) if shape.file is None else (shape.file,)
            uses.setdefault(key, []).append((link.name, shape))
    folder = _find_shared_folder([mesh.name for mesh in scene.meshes])
    first_by_digest: dict[str, SceneMesh] = {}
    for mesh in scene.meshes:
        if mesh.digest:
            first_by_digest.setdefault(mesh.digest, mesh)
    rows = [
        _render_mesh_row(scene.meshes[shape.file], users, folder=folder, first_by_digest=first_by_digest)
        if (shape := users[0][1]).file is not None
        else _render_shape_row(shape, users)
        for users in sorted(uses.values(), key=lambda users: users[0][1].file is None)
    ]
    if not rows:
        return "<p>No link has a shape.</p>"
    foot = ""
    if scene.meshes:
        total = format_whole_number(sum(mesh.bytes for mesh in scene.meshes))
        count = format_count(len(scene.meshes), "file")
        foot = f'<tr><th scope="row">{count}</th><td colspan="7"></td>{render_number_cell(total)}</tr>'
    where = f", with files in {escape_html(folder)}" if folder else ""
    return render_table(f"What is drawn and what collides{where}", head, rows, foot=foot, is_sortable=True)


def _render_mesh_row(
    mesh: SceneMesh,
    users: Sequence[tuple[str, SceneShape]],
    *,
    folder: str,
    first_by_digest: Mapping[str, SceneMesh],
) -> str:
    name = f"<code>{escape_html(mesh.name[len(folder) :])}</code>"
    original = first_by_digest.get(mesh.digest, mesh)
    if original is not mesh:
        name += f"<br><small>same content as <code>{escape_html(original.name[len(folder) :])}</code></small>"
    if mesh.problem:
        name += f"<br><small>{escape_html(mesh.problem)}</small>"
    watertight = NO_VALUE if mesh.watertight is None else "no" if not mesh.watertight else f"{render_glyph('ok')} yes"
    is_counted = mesh.triangles or not mesh.problem
    triangles = format_whole_number(mesh.triangles) if is_counted else NO_VALUE
    open_edges = format_whole_number(mesh.open_edges) if mesh.watertight is not None else NO_VALUE
    scales = list(dict.fromkeys(shape.size for _, shape in users if len(shape.size) == 3))
    sizes = [
        _format_dimensions([abs(s * e) for s, e in zip(scale, mesh.extents, strict=True)])
        for scale in scales
        if mesh.extents
    ]
    cells = (
        f'<th scope="row">{name}</th>',
        f"<td>{_render_users(users)}</td>",
        f"<td>{escape_html(mesh.format) or NO_VALUE}</td>",
        render_number_cell(triangles),
        f'<td class="{"ok" if mesh.watertight else "open"}">{watertight}</td>',
        render_number_cell(open_edges),
        render_number_cell("<br>".join(map(_format_scale, scales)) or NO_VALUE),
        render_number_cell("<br>".join(dict.fromkeys(sizes)) or NO_VALUE),
        render_number_cell(format_whole_number(mesh.bytes)),
    )
    return f"<tr>{''.join(cells)}</tr>"


def _render_shape_row(shape: SceneShape, users: Sequence[tuple[str, SceneShape]]) -> str:
    name = f"<code>{escape_html(shape.mesh)}</code>" if shape.kind == "mesh" else escape_html(shape.kind) or "no shape"
    size = NO_VALUE if shape.kind == "mesh" or not shape.size else _format_dimensions(_compute_extents(shape))
    kind = "not found" if shape.kind == "mesh" else "primitive" if shape.kind else NO_VALUE
    empty = render_number_cell(NO_VALUE)
    return (
        f'<tr><th scope="row">{name}</th><td>{_render_users(users)}</td><td>{kind}</td>{empty}<td>{NO_VALUE}</td>'
        f"{empty}{empty}{render_number_cell(size)}{empty}</tr>"
    )


def _format_scale(scale: Sequence[float]) -> str:
    """Format metres per unit of a mesh: one number if they are equal along x, y and z."""
    return _format_dimensions(scale) if len(set(scale)) > 1 else format_number(scale[0], 6)


def _compute_extents(shape: SceneShape) -> Sequence[float]:
    """Compute the extents of a primitive along x, y and z in m."""
    if shape.kind == "sphere":
        return [2 * shape.size[0]] * 3
    if shape.kind in ("cylinder", "capsule"):
        radius, length = shape.size
        return 2 * radius, 2 * radius, length + (2 * radius if shape.kind == "capsule" else 0.0)
    return shape.size


def _render_users(users: Sequence[tuple[str, SceneShape]]) -> str:
    """Render the links that use a shape, grouped by the roles that they use it in."""
    roles_by_link: dict[str, dict[str, None]] = {}
    for link, shape in users:
        roles_by_link.setdefault(link, {})[shape.role] = None
    links_by_roles: dict[tuple[str, ...], list[str]] = {}
    for link, roles in roles_by_link.items():
        links_by_roles.setdefault(tuple(roles), []).append(link)
    lines = []
    for group_roles, links in links_by_roles.items():
        names = ", ".join(render_element_name(("link", link)) for link in links[:MOST_USERS])
        more = f" and {len(links) - MOST_USERS} more" if len(links) > MOST_USERS else ""
        lines.append(f"{names}{more} <small>{' and '.join(map(escape_html, group_roles))}</small>")
    return "<br>".join(lines)


def _format_dimensions(values: Sequence[float]) -> str:
    return " × ".join(format_number(value, 3) for value in values)


def _find_shared_folder(names: Sequence[str]) -> str:
    """Return the folder that contains all these files, with its slash; empty if there is none."""
    if len(names) < 2:
        return ""
    low, high = min(names), max(names)
    same = next((i for i, (a, b) in enumerate(zip(low, high, strict=False)) if a != b), len(low))
    return low[: low.rfind("/", 0, same) + 1]
