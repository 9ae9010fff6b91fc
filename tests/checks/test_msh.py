"""Meshes: what is reported once, how bad it is, and what is measured."""

from __future__ import annotations

import contextlib
import json
import struct
import urllib.parse
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from builders import box, find, inertial, joint, limit, link, mesh, robot, visual
from conftest import check, check_text
from scipy.spatial import ConvexHull

from urdfcheck.checks import msh011_format_unsupported
from urdfcheck.core import Finding, Severity, Verdict
from urdfcheck.model import gltf_buffers
from urdfcheck.model.shapes import mesh_sizes
from urdfcheck.rules import load_rules

pytestmark = pytest.mark.slow

# A tetrahedron with corners 0, x, y, z, as OBJ faces.
CORNERS = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
CLOSED = CORNERS + "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
OPEN = CORNERS + "f 1 2 4\nf 1 4 3\nf 2 3 4\n"
MIXED = CORNERS + "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 3 2 4\n"
INSIDE_OUT = CORNERS + "f 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n"


def shape(role: str, name: str = "part.obj", scale: str = "1 1 1") -> str:
    return f'<{role}><geometry><mesh filename="{name}" scale="{scale}"/></geometry></{role}>'


def find_in_mesh(
    folder: Path,
    code: str,
    content: str | bytes,
    *links: str,
    name: str = "part.obj",
    step: float = 0.0,
    **request: object,
) -> list[Finding]:
    """Return the findings of one rule on a chain of links, ``step`` metres apart, that share one mesh file."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / name).write_bytes(content.encode() if isinstance(content, str) else content)
    chain = [link(f"l{i}", parts) for i, parts in enumerate(links)]
    joints = (joint(f"j{b}", f"l{a}", f"l{b}", xyz=f"{step} 0 0") for a, b in pairwise(range(len(links))))
    return find(folder, robot(*chain, *joints), code, **request)


def scaled(content: str, factor: float) -> str:
    """The same OBJ mesh, ``factor`` times as large."""
    return "".join(
        "v " + " ".join(f"{factor * float(x)!r}" for x in line.split()[1:]) + "\n"
        if line.startswith("v")
        else line + "\n"
        for line in content.splitlines()
    )


def moved(content: str, x: float, first: int) -> str:
    """The same OBJ mesh, moved along x, as the lines that follow ``first`` vertices."""
    lines = [line.split() for line in content.splitlines()]
    return "".join(
        f"v {float(w[1]) + x!r} {w[2]} {w[3]}\n"
        if w[0] == "v"
        else "f " + " ".join(str(int(i) + first) for i in w[1:]) + "\n"
        for w in lines
    )


def collada(unit: float, size: float) -> str:
    """A tetrahedron with edges of ``size`` file units of ``unit`` metres."""
    return (
        '<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">'
        f'<asset><unit meter="{unit!r}"/><up_axis>Z_UP</up_axis></asset><library_geometries><geometry id="g"><mesh>'
        f'<source id="s"><float_array id="a" count="12">0 0 0 {size!r} 0 0 0 {size!r} 0 0 0 {size!r}</float_array>'
        '<technique_common><accessor source="#a" count="4" stride="3"><param name="X" type="float"/>'
        '<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>'
        '<vertices id="v"><input semantic="POSITION" source="#s"/></vertices><triangles count="3">'
        '<input semantic="VERTEX" source="#v" offset="0"/><p>0 1 3 0 3 2 1 2 3</p></triangles></mesh></geometry>'
        '</library_geometries><library_visual_scenes><visual_scene id="scene"><node><instance_geometry url="#g"/></node>'
        '</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#scene"/></scene></COLLADA>'
    )


def stl(header: bytes) -> bytes:
    """A binary STL of one triangle."""
    return header.ljust(80) + struct.pack("<I12fH", 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0)


# -- MSH001 ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (b"", "empty"),
        (b"<!DOCTYPE html><html></html>", "html"),
        (b"\0" * 80 + (1).to_bytes(4, "little") + b"\0" * 100, "wrong-size"),
        (b"\0" * 80 + (7).to_bytes(4, "little") + b"\0" * 50, "truncated"),
        (b"\0" * 20, "truncated"),
        (b"\0" * 84, "no-facets"),
        (b"solid a\nendsolid a\n", "no-facets"),
        (b"# a note\n", "text"),
        (b" " * 600 + b"\xe4", "wrong-size"),
        (b"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0", "truncated"),
        (stl(b"part") + b"\n", "wrong-size"),
    ],
)
def test_why_a_file_is_no_mesh(tmp_path: Path, content: bytes, reason: str) -> None:
    (finding,) = find_in_mesh(tmp_path, "MSH001", content, inertial() + shape("collision", "part.stl"), name="part.stl")
    assert (finding.severity, finding.data["reason_id"]) == (Severity.ERROR, reason)
    assert finding.consequences["mujoco"] == "refuses to compile"
    mujoco = pytest.importorskip("mujoco")
    with pytest.raises(ValueError, match="stl_decoder"):
        mujoco.MjModel.from_xml_string((tmp_path / "robot.urdf").read_text(), {"part.stl": content})


@pytest.mark.parametrize(("content", "repair"), [(b"<html></html>", "raw file"), (b"", "again")])
def test_the_repair_fits_the_reason(tmp_path: Path, content: bytes, repair: str) -> None:
    (finding,) = find_in_mesh(tmp_path, "MSH001", content, shape("visual"))
    assert finding.fix is not None
    assert repair in finding.fix.title


@pytest.mark.parametrize(
    ("parts", "repair"),
    [
        (shape("visual", "part.stl"), "delete the shape: l1 has no mass and a fixed joint"),
        (inertial() + shape("visual", "part.stl"), "delete the shape if the link only marks a frame"),
    ],
)
def test_a_whole_stl_without_triangles_needs_no_new_export(tmp_path: Path, parts: str, repair: str) -> None:
    (finding,) = find_in_mesh(tmp_path, "MSH001", b"\0" * 84, inertial(), parts, name="part.stl")
    assert finding.fix is not None
    assert finding.fix.title.startswith(repair)


def test_a_format_that_is_not_read_is_not_called_broken(tmp_path: Path) -> None:
    (finding,) = find_in_mesh(tmp_path, "MSH001", b"data", shape("visual", "part.wrl"), name="part.wrl")
    assert (finding.severity, finding.message_id) == (Severity.WARNING, "unread")


def test_a_broken_file_that_is_used_twice_is_one_finding(tmp_path: Path) -> None:
    (finding,) = find_in_mesh(tmp_path, "MSH001", b"", shape("visual") + shape("collision"), shape("visual"))
    assert len(finding.related) == 2


def test_a_missing_file_is_another_rules_business(tmp_path: Path) -> None:
    assert not find_in_mesh(tmp_path, "MSH001", CLOSED, shape("visual", "elsewhere.obj"))


def find_broken(folder: Path, name: str, content: str | bytes, role: str = "collision") -> Finding:
    (finding,) = find_in_mesh(folder, "MSH001", content, shape(role, name), name=name)
    return finding


def test_what_only_assimp_loads_is_a_warning_that_names_the_line(tmp_path: Path) -> None:
    finding = find_broken(tmp_path, "part.dae", "\n<?xml version='1.0'?>" + collada(1.0, 1.0))
    assert (finding.severity, finding.message_id) == (Severity.WARNING, "tolerated")
    assert "line 2: the XML declaration" in finding.message
    assert set(finding.consequences) == {"newton", "trimesh", "yourdfpy"}
    # Its numbers are those of the mesh: the tetrahedron lacks a side.
    assert find(tmp_path, robot(link("a", shape("collision", "part.dae"))), "MSH002")


def test_a_missing_image_of_a_texture_is_a_note(tmp_path: Path) -> None:
    effect = (
        '<library_effects><effect id="e"><profile_COMMON><newparam sid="s"><surface type="2D"><init_from>mount</init_from>'
        '</surface></newparam><newparam sid="p"><sampler2D><source>s</source></sampler2D></newparam><technique sid="t">'
        '<lambert><diffuse><texture texture="p" texcoord="u"/></diffuse></lambert></technique></profile_COMMON></effect>'
        '</library_effects><library_images/><library_materials><material id="m"><instance_effect url="#e"/></material>'
        "</library_materials><library_geometries>"
    )
    bound = (
        '<instance_geometry url="#g"><bind_material><technique_common><instance_material symbol="m" target="#m"/>'
        "</technique_common></bind_material></instance_geometry>"
    )
    text = collada(1.0, 1.0).replace("<library_geometries>", effect).replace("<triangles ", '<triangles material="m" ')
    finding = find_broken(tmp_path, "part.dae", text.replace('<instance_geometry url="#g"/>', bound))
    assert (finding.message_id, finding.severity) == ("tolerated", Severity.INFO)
    assert "missing image" in finding.message
    assert set(finding.consequences) == {"newton", "trimesh", "yourdfpy"}


def test_consequences_are_told_of_programs_whose_loader_was_asked(tmp_path: Path) -> None:
    cut = find_broken(tmp_path, "part.dae", collada(1.0, 1.0)[:-20])
    assert (cut.severity, cut.message_id) == (Severity.ERROR, "refused")
    assert cut.message.startswith("mesh part.dae cannot be read as dae: line 1: ")
    verdicts = {program: Verdict.from_sentence(sentence) for program, sentence in cut.consequences.items()}
    assert verdicts == {
        "pinocchio": Verdict.REFUSES,
        "moveit": Verdict.DROPS,
        "rviz": Verdict.DROPS,
        "mujoco": Verdict.REFUSES,
        "drake": Verdict.REFUSES,
    }
    bad = find_broken(tmp_path, "part.obj", CORNERS + "f 1 2 9\n")
    assert bad.message_id == "refused"
    cut = find_broken(tmp_path, "part.obj", "mtllib part.mtl\n" + CORNERS + "f 1 2 3\nf 1\nf 2//2\n# 1.")
    assert (cut.message_id, cut.severity) == ("lenient", Severity.WARNING)
    assert "not tried" in bad.consequences["mujoco"]
    assert "not tried" in bad.consequences["drake"]


def test_a_mesh_that_we_read_and_assimp_refuses_is_an_error(tmp_path: Path) -> None:
    content = collada(1.0, 1.0).replace('source="#a" count="4"', 'source="#a" count="12"')
    finding = find_broken(tmp_path, "part.dae", content)
    assert (finding.severity, finding.message_id) == (Severity.ERROR, "refused")
    assert "counts 12 numbers instead of 4 vectors; Assimp refuses it" in finding.message
    assert finding.fix is not None
    assert finding.fix.title.startswith("write the number of vectors as the count of each such <accessor>")


def test_a_material_that_the_file_lacks_is_named(tmp_path: Path) -> None:
    bound = (
        '<instance_geometry url="#g"><bind_material><technique_common><instance_material symbol="m" target="#other"/>'
        "</technique_common></bind_material></instance_geometry>"
    )
    finding = find_broken(tmp_path, "part.dae", collada(1.0, 1.0).replace('<instance_geometry url="#g"/>', bound))
    assert "material #other not found" in finding.message
    assert finding.fix is not None
    assert finding.fix.title


@pytest.mark.parametrize(
    ("script", "severity"), [("", Severity.WARNING), ("rviz2", Severity.INFO), ("import trimesh", Severity.WARNING)]
)
def test_a_material_that_the_file_lacks_concerns_readers_by_pycollada(
    tmp_path: Path, script: str, severity: Severity
) -> None:
    """Assimp is not asked where a node stands for another; MuJoCo and Drake read no COLLADA, whole or not."""
    bound = (
        '<instance_geometry url="#g"><bind_material><technique_common><instance_material symbol="m" target="#other"/>'
        '</technique_common></bind_material></instance_geometry><instance_node url="#n"/>'
    )
    text = collada(1.0, 1.0).replace('<instance_geometry url="#g"/>', bound)
    nodes = '<library_nodes><node id="n"/></library_nodes><library_visual_scenes>'
    files = {"part.dae": text.replace("<library_visual_scenes>", nodes)}
    if script:
        files |= {"package.xml": "<package><name>p</name></package>", "start.py": script}
    (finding,) = find(
        tmp_path, {"r.urdf": robot(link("a", shape("visual", "part.dae"))), **files}, "MSH001", name="r.urdf"
    )
    assert (finding.message_id, finding.severity) == ("partial", severity)
    assert set(finding.consequences) == {"newton", "trimesh", "yourdfpy"}


def test_an_accessor_that_counts_too_many_vectors_has_no_repair_by_a_number(tmp_path: Path) -> None:
    content = collada(1.0, 1.0).replace('source="#a" count="4"', 'source="#a" count="5"')
    finding = find_broken(tmp_path, "part.dae", content)
    assert "counts 15 numbers, and its array has 12; Assimp refuses it" in finding.message
    assert finding.fix is not None
    assert finding.fix.title == "export, download or generate the file again"


def test_entities_are_an_error_only_where_assimp_refuses_them_too(tmp_path: Path) -> None:
    content = "<?xml version='1.0'?><!DOCTYPE x [<!ENTITY a '7'>]>" + collada(1.0, 1.0)
    finding = find_broken(tmp_path, "part.dae", content)
    assert (finding.severity, finding.message_id) == (Severity.WARNING, "unread")
    assert find_broken(tmp_path, "part.dae", content.replace("0 0 0 1.0", "0 0 0 &a;")).severity is Severity.ERROR


# A triangle, with its corners in another file.
GLTF = {
    "asset": {"version": "2.0"},
    "scenes": [{"nodes": [0]}],
    "nodes": [{"mesh": 0}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}],
}
TRIANGLE = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)


def gltf(uri: str) -> str:
    return json.dumps({**GLTF, "buffers": [{"uri": uri, "byteLength": 36}]})


@pytest.mark.parametrize("uri", ["part.bin", "./data/part.bin", "data/a%20part.bin"])
def test_the_buffer_of_a_gltf_file_is_read(tmp_path: Path, uri: str) -> None:
    (tmp_path / "data").mkdir()
    (tmp_path / urllib.parse.unquote(uri)).write_bytes(TRIANGLE)
    assert not find_in_mesh(tmp_path, "MSH001", gltf(uri), shape("collision", "part.gltf"), name="part.gltf")
    (finding,) = find(tmp_path, robot(link("a", shape("collision", "part.gltf"))), "MSH002")
    assert finding.data["open_edges"] == 3


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (None, "missing-buffer"),
        (b"", "truncated"),
        (TRIANGLE[:-1], "truncated"),
        (b"version https://git-lfs.github.com/spec/v1\n", "missing-buffer"),
    ],
)
def test_a_buffer_that_is_not_there_is_told_at_the_mesh(tmp_path: Path, content: bytes | None, reason: str) -> None:
    if content is not None:
        (tmp_path / "part.bin").write_bytes(content)
    finding = find_broken(tmp_path, "part.gltf", gltf("part.bin"))
    assert (finding.severity, finding.data["reason_id"]) == (Severity.ERROR, reason)


def test_a_missing_buffer_is_told_before_its_compression(tmp_path: Path) -> None:
    packed = json.dumps({**json.loads(gltf("part.bin")), "extensionsRequired": ["KHR_draco_mesh_compression"]})
    assert find_broken(tmp_path, "part.gltf", packed).data["reason_id"] == "missing-buffer"
    (tmp_path / "part.bin").write_bytes(TRIANGLE)
    finding = find_broken(tmp_path, "part.gltf", packed)
    assert (finding.severity, finding.data["reason_id"]) == (Severity.WARNING, "unsupported")
    assert {"rviz", "gazebo", "pinocchio"} <= set(finding.data["unproven"])


@pytest.mark.parametrize(
    "uri",
    [
        "/etc/hostname",
        "../../secret.bin",
        "file:///etc/hostname",
        "~/x.bin",
        "package://p/x.bin",
        "%2e%2e/%2e%2e/secret.bin",
    ],
)
def test_a_buffer_out_of_reach_is_not_opened(tmp_path: Path, uri: str) -> None:
    (tmp_path / "secret.bin").write_bytes(TRIANGLE)
    folder = tmp_path / "a" / "robot"
    finding = find_broken(folder, "part.gltf", gltf(uri))
    assert (finding.severity, finding.message_id) == (Severity.ERROR, "outside")


def test_buffers_count_with_the_size_of_the_mesh(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "part.bin").write_bytes(TRIANGLE)
    monkeypatch.setattr(gltf_buffers, "MAX_MESH", len(TRIANGLE) - 1)
    shapes = shape("collision", "part.gltf")
    assert not find_in_mesh(tmp_path, "MSH001", gltf("part.bin"), shapes, name="part.gltf")
    assert find_in_mesh(tmp_path, "URC905", gltf("part.bin"), shapes, name="part.gltf")


def test_a_changed_buffer_changes_the_findings(tmp_path: Path) -> None:
    cache = tmp_path / "cache"
    (tmp_path / "part.gltf").write_text(gltf("part.bin"))
    urdf = robot(link("a", shape("collision", "part.gltf")))
    lengths = []
    for size in (1.0, 2.0, 2.0):
        (tmp_path / "part.bin").write_bytes(struct.pack("<9f", 0, 0, 0, size, 0, 0, 0, size, 0))
        (finding,) = find(tmp_path, urdf, "MSH002", cache=cache)
        lengths.append(finding.data["length"])
    assert lengths[1] == lengths[2] == pytest.approx(2 * lengths[0], rel=1e-3)


def test_two_documents_of_one_text_have_buffers_of_their_own(tmp_path: Path) -> None:
    for folder, size in (("a", 1.0), ("b", 3.0)):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "part.gltf").write_text(gltf("part.bin"))
        (tmp_path / folder / "part.bin").write_bytes(struct.pack("<9f", 0, 0, 0, size, 0, 0, 0, size, 0))
    both = robot(link("l", *(shape("collision", f"{folder}/part.gltf") for folder in "ab")))
    (finding,) = find(tmp_path, both, "MSH002")
    assert finding.data["length"] == pytest.approx(3 * (2 + 2**0.5), rel=1e-3)


# -- PKG009 ---------------------------------------------------------------------------------------------------------

POINTER = b"version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 1234\n"


@pytest.mark.parametrize("content", [POINTER, POINTER.replace(b"\n", b"\r\n"), b"\xef\xbb\xbf" + POINTER])
def test_a_pointer_is_known_without_reading_meshes(tmp_path: Path, content: bytes) -> None:
    (finding,) = find_in_mesh(tmp_path, "PKG009", content, shape("visual") + shape("collision"), tier="source")
    assert (finding.severity, finding.data["bytes"]) == (Severity.ERROR, 1234)
    assert len(finding.related) == 1


@pytest.mark.parametrize("content", [CLOSED, "", "the file version https://git-lfs.github.com/spec/v1"])
def test_what_is_no_pointer(tmp_path: Path, content: str) -> None:
    assert not find_in_mesh(tmp_path, "PKG009", content, shape("visual"), shape("visual", "missing.obj"))


def test_the_pointers_of_one_repository_are_one_finding(tmp_path: Path) -> None:
    for folder in ("arm/.git", "hand/.git", "hand/meshes"):
        (tmp_path / folder).mkdir(parents=True)
    (tmp_path / "arm/.gitattributes").write_text("*.stl filter=lfs diff=lfs merge=lfs -text\n")
    for name in ("arm/a.stl", "arm/b.stl", "hand/meshes/c.stl"):
        (tmp_path / name).write_bytes(POINTER)
    uses = [shape("visual", name) for name in ("arm/a.stl", "hand/meshes/c.stl", "arm/b.stl")]
    arm, hand = find_in_mesh(tmp_path, "PKG009", "", *uses)
    assert (arm.message_id, arm.data["count"], arm.data["bytes"]) == ("pointers", 2, 2468)
    assert (hand.message_id, hand.data["count"]) == ("pointer", 1)
    assert arm.cause is not None
    assert arm.cause.id == "clone"
    assert hand.cause is not None
    assert hand.cause.id == "copy"
    assert hand.fix is not None
    assert "git lfs" not in hand.fix.title


@pytest.mark.parametrize(
    ("place", "line", "repair"),
    [
        (".gitattributes", "*.stl filter=lfs", "run `git lfs install`, then `git lfs pull`, in {}"),
        (".gitattributes", "arm/** filter=lfs", "run `git lfs install`, then `git lfs pull`, in {}"),
        (
            ".gitattributes",
            "*.dae filter=lfs",
            "run `git lfs install`, then `git lfs pull`, in {}; if they stay pointers",
        ),
        (
            "arm/.gitattributes",
            "*.stl filter=lfs",
            "run `git lfs install`, then `git lfs pull`, in {}; if they stay pointers",
        ),
        ("arm/.gitattributes", "# *.stl filter=lfs", "copy the mesh itself"),
        (".gitattributes", "*.stl binary", "copy the mesh itself"),
    ],
)
def test_files_are_fetched_from_the_repository_that_keeps_them(
    tmp_path: Path, place: str, line: str, repair: str
) -> None:
    for folder in (".git", "arm"):
        (tmp_path / folder).mkdir()
    (tmp_path / place).write_text(f"{line}\n")
    (tmp_path / "arm/a.stl").write_bytes(POINTER)
    (finding,) = find_in_mesh(tmp_path, "PKG009", "", shape("visual", "arm/a.stl"))
    assert finding.fix is not None
    start, _, end = repair.partition("{}")
    assert finding.fix.title.startswith(start)
    assert end in finding.fix.title
    assert ("if they stay pointers" in finding.fix.title) == ("stay" in repair)


@pytest.mark.parametrize(
    ("settings", "command"),
    [
        ("[lfs]\n\tfetchexclude = *\n", '`git lfs pull --include="*" --exclude=""`'),
        ("[lfs]\n\tfetchinclude = *.png\n", '`git lfs pull --include="*" --exclude=""`'),
        ("[lfs]\n\turl = https://a.example/fetchexclude = b\n", "`git lfs pull`"),
        ("[lfs]\n\t# fetchexclude = *\n", "`git lfs pull`"),
    ],
)
def test_files_that_the_settings_leave_out_are_fetched_by_a_command_that_overrides_them(
    tmp_path: Path, settings: str, command: str
) -> None:
    (tmp_path / ".git").mkdir()
    (tmp_path / ".gitattributes").write_text("*.stl filter=lfs\n")
    (tmp_path / ".lfsconfig").write_text(settings)
    (tmp_path / "a.stl").write_bytes(POINTER)
    (finding,) = find_in_mesh(tmp_path, "PKG009", "", shape("visual", "a.stl"))
    assert finding.fix is not None
    assert command in finding.fix.title


def test_a_pointer_is_not_called_unreadable_as_well(tmp_path: Path) -> None:
    assert not find_in_mesh(tmp_path, "MSH001", POINTER, shape("visual"))


# -- MSH002 ---------------------------------------------------------------------------------------------------------


def test_a_closed_mesh_has_no_open_edges(tmp_path: Path) -> None:
    assert not find_in_mesh(tmp_path, "MSH002", CLOSED, shape("visual") + shape("collision"))


def test_an_open_mesh_matters_where_it_collides(tmp_path: Path) -> None:
    (collides,) = find_in_mesh(tmp_path / "a", "MSH002", OPEN, shape("collision"))
    (drawn,) = find_in_mesh(tmp_path / "b", "MSH002", OPEN, shape("visual"), shape("visual"))
    assert (collides.message_id, drawn.message_id) == ("collision", "drawn")
    assert collides.severity == Severity.INFO  # most programs collide with the convex hull
    assert collides.location.subject == "link[l0]/collision/geometry/mesh@filename"
    assert drawn.severity == Severity.INFO


@pytest.mark.parametrize(("code", "content"), [("MSH003", "MIXED"), ("MSH005", "WALLED")])
def test_a_flaw_of_a_surface_is_a_note_except_for_gazebo(tmp_path: Path, code: str, content: str) -> None:
    """Only Gazebo collides with every triangle."""
    (finding,) = find_in_mesh(tmp_path, code, globals()[content], shape("collision"))
    assert finding.severity == Severity.INFO
    (raised,) = check(tmp_path / "robot.urdf", codes={code}, targets=("gazebo",)).findings
    assert raised.severity == Severity.WARNING


@pytest.mark.parametrize(
    ("code", "raising", "body"),
    [
        ("MSH002", {"gazebo"}, shape("visual") + shape("collision")),
        ("MSH002", {"gazebo"}, shape("collision")),
        ("MSH010", {"gazebo", "isaac"}, shape("collision", scale="1 -1 1")),
    ],
)
def test_a_target_that_uses_every_triangle_raises_it(tmp_path: Path, code: str, raising: set[str], body: str) -> None:
    for target in ("gazebo", "isaac", "moveit"):
        (finding,) = find_in_mesh(tmp_path / target, code, OPEN, body, targets=(target,))
        assert finding.severity == (Severity.WARNING if target in raising else Severity.INFO)


def test_all_open_collision_meshes_of_a_robot_are_one_finding(tmp_path: Path) -> None:
    tmp_path.mkdir(exist_ok=True)
    (tmp_path / "other.obj").write_text(OPEN.replace("v 1 ", "v 2 "))
    (finding,) = find_in_mesh(tmp_path, "MSH002", OPEN, shape("collision"), shape("collision", "other.obj"))
    assert finding.subjects == tuple(f"link[l{i}]/collision/geometry/mesh@filename" for i in range(2))
    assert finding.headline == "2 collision meshes are not watertight (6 open edges)"
    assert finding.message.startswith(
        "2 collision meshes are not closed: 6 open edges in 2 places (part.obj (3), other.obj (3));"
    )
    assert "in the frame of other.obj" in finding.message


def test_the_hole_is_measured_in_metres(tmp_path: Path) -> None:
    (finding,) = find_in_mesh(tmp_path, "MSH002", OPEN, shape("collision", scale="0.1 0.1 0.1"))
    (loop,) = finding.data["loops"]
    assert finding.data["open_edges"] == 3
    assert loop["closed"]
    assert loop["length"] == pytest.approx(0.1 * (2 + 2**0.5), rel=1e-5)
    assert sorted(map(tuple, loop["points"])) == [(0, 0, 0), (0, 0.1, 0), (0.1, 0, 0)]


def test_the_points_of_a_hole_are_bounded(tmp_path: Path) -> None:
    ring = "".join(f"v {i} {i * i} 0\n" for i in range(500))
    fan = ring + "v 250 0 9\n" + "".join(f"f {i + 1} {(i + 1) % 500 + 1} 501\n" for i in range(500))
    (finding,) = find_in_mesh(tmp_path, "MSH002", fan, shape("collision"))
    assert finding.data["open_edges"] == 500
    assert len(finding.data["loops"][0]["points"]) <= 64


def test_the_hole_is_as_large_as_the_mesh_is_drawn(tmp_path: Path) -> None:
    (finding,) = find_in_mesh(
        tmp_path, "MSH002", collada(0.001, 400.0), shape("collision", "part.dae"), name="part.dae"
    )
    (loop,) = finding.data["loops"]
    assert np.max(loop["points"]) == 0.4
    assert loop["length"] == pytest.approx(0.4 * (2 + 2**0.5), rel=1e-5)


def test_a_hole_that_hardly_changes_the_volume_is_an_info(tmp_path: Path) -> None:
    def sphere(rings: int) -> str:
        """A sphere of triangles, of which one is missing."""
        points = [(0.0, 0.0, 1.0), (0.0, 0.0, -1.0)]
        for up in np.linspace(0, np.pi, rings + 2)[1:-1]:
            points += [
                (np.sin(up) * np.cos(a), np.sin(up) * np.sin(a), np.cos(up))
                for a in np.linspace(0, 2 * np.pi, 2 * rings + 1)[:-1]
            ]
        hull = ConvexHull(points)
        faces = [
            f if np.cross(*(hull.points[f[1:]] - hull.points[f[0]])) @ e[:3] > 0 else f[::-1]
            for f, e in zip(hull.simplices, hull.equations, strict=True)
        ]
        lines = ["v " + " ".join(map(repr, map(float, p))) for p in points]
        return "\n".join([*lines, *("f " + " ".join(str(i + 1) for i in f) for f in faces[1:])]) + "\n"

    for rings, expected in ((6, (Severity.INFO, "collision")), (40, (Severity.INFO, "small"))):
        (finding,) = find_in_mesh(tmp_path, "MSH002", sphere(rings), shape("collision"))
        assert (finding.severity, finding.message_id) == expected


def test_a_seam_is_no_finding(tmp_path: Path) -> None:
    seam = CORNERS + "v 0.5 0 0\nf 1 3 2\nf 1 5 4\nf 5 2 4\nf 1 4 3\nf 2 3 4\n"
    assert not find_in_mesh(tmp_path, "MSH002", seam, shape("collision"), shape("visual"))
    assert find_in_mesh(tmp_path, "MSH002", seam.replace("v 0.5 0 0", "v 0.5 0 0.01"), shape("collision"))


# -- MSH003, MSH004 -------------------------------------------------------------------------------------------------


def test_the_edges_at_which_the_winding_changes_are_counted(tmp_path: Path) -> None:
    (finding,) = find_in_mesh(tmp_path, "MSH003", MIXED, shape("collision"))
    assert finding.data["wrong"] == 3
    # Those of the triangle that was turned over.
    assert {tuple(point) for line in finding.data["lines"] for point in line} == {(1, 0, 0), (0, 1, 0), (0, 0, 1)}


def test_one_wrong_edge_is_no_part_of_the_surface(tmp_path: Path) -> None:
    strip = CORNERS + "v 1 1 0\nf 1 2 3\nf 2 3 5\n"
    assert not find_in_mesh(tmp_path, "MSH003", strip, shape("collision"))


@pytest.mark.parametrize("content", [CLOSED, OPEN, INSIDE_OUT])
def test_a_winding_that_is_the_same_everywhere_is_consistent(tmp_path: Path, content: str) -> None:
    assert not find_in_mesh(tmp_path, "MSH003", content, shape("collision"))


@pytest.mark.parametrize("content", [CLOSED, OPEN, MIXED])
def test_only_a_closed_mesh_of_negative_volume_is_inside_out(tmp_path: Path, content: str) -> None:
    assert not find_in_mesh(tmp_path, "MSH004", content, shape("visual"))


def test_a_mirroring_scale_turns_it_the_right_way_out(tmp_path: Path) -> None:
    assert find_in_mesh(tmp_path / "a", "MSH004", INSIDE_OUT, shape("visual", scale="1 1 2"))
    assert not find_in_mesh(tmp_path / "b", "MSH004", INSIDE_OUT, shape("visual", scale="1 -1 1"))


@pytest.mark.parametrize(
    ("shapes", "scale", "severity"),
    [
        (("visual",), "0.025 0.025 0.025", Severity.INFO),
        (("visual",), "0.03 0.03 0.03", Severity.WARNING),
        (("visual", "collision"), "0.01 0.01 0.01", Severity.WARNING),
        (("collision",), "1 1 1", Severity.INFO),
    ],
)
def test_a_small_part_that_is_only_drawn_and_one_that_is_not_drawn_are_infos(
    tmp_path: Path, shapes: tuple[str, ...], scale: str, severity: Severity
) -> None:
    drawn = "".join(shape(role, scale=scale) for role in shapes)
    (finding,) = find_in_mesh(tmp_path, "MSH004", INSIDE_OUT, drawn)
    assert finding.severity is severity
    assert ("dark" in finding.consequences["rviz"]) == ("visual" in shapes)


def test_all_files_that_one_line_of_a_macro_names_are_told(tmp_path: Path) -> None:
    files = {f"{side}.obj": INSIDE_OUT for side in ("left", "right")}
    text = robot(
        '<xacro:macro name="wheel" params="side">' + link("${side}", visual(mesh("${side}.obj"))) + "</xacro:macro>",
        *(f'<xacro:wheel side="{side}"/>' for side in ("left", "right")),
        joint("j", "left", "right"),
        xacro=True,
    )
    (finding,) = find(tmp_path, files | {"r.xacro": text}, "MSH004", name="r.xacro")
    assert finding.message.endswith("; so do those of right.obj")
    assert [subject.partition("]")[0] for subject in finding.subjects] == ["link[left", "link[right"]


def test_the_bodies_that_face_inwards_are_told_from_the_others(tmp_path: Path) -> None:
    small = "v 2 2 2\nv 2.5 2 2\nv 2 2.5 2\nv 2 2 2.5\nf 5 7 6\nf 5 6 8\nf 5 8 7\nf 6 7 8\n"
    both = INSIDE_OUT + small
    (finding,) = find_in_mesh(tmp_path, "MSH004", both, shape("visual"))
    assert "the triangles of 1 of the 2 bodies of closed mesh" in finding.message
    assert finding.fix is not None
    assert "Recalculate Outside" in finding.fix.title


# -- MSH005 ---------------------------------------------------------------------------------------------------------

# A wall from an edge of the tetrahedron to a fifth corner inside, and back along two others.
WALLED = CLOSED + "v 0.2 0.2 0.2\nf 1 2 5\nf 2 3 5\nf 3 1 5\n"
# A second tetrahedron on the other side of the edge from the origin to z.
TOUCHING = CLOSED + "v -1 0 0\nv 0 -1 0\nf 1 6 5\nf 1 5 4\nf 1 4 6\nf 5 6 4\n"


def test_the_edges_of_three_triangles_are_drawn(tmp_path: Path) -> None:
    (finding,) = find_in_mesh(tmp_path, "MSH005", WALLED, shape("collision", scale="2 2 2"))
    assert finding.data["count"] == 3
    assert {tuple(point) for line in finding.data["lines"] for point in line} == {(0, 0, 0), (2, 0, 0), (0, 2, 0)}


@pytest.mark.parametrize("content", [CLOSED, OPEN, TOUCHING, CLOSED + moved(CLOSED, 0.0, 4)])
def test_closed_bodies_may_touch_in_an_edge_or_a_face(tmp_path: Path, content: str) -> None:
    assert not find_in_mesh(tmp_path, "MSH005", content, shape("collision"))


def test_an_open_mesh_is_reported_as_open_only(tmp_path: Path) -> None:
    flag = CLOSED + "v 0.5 0.5 1\nf 2 3 5\n"
    assert find_in_mesh(tmp_path, "MSH002", flag, shape("collision"))
    assert not find_in_mesh(tmp_path, "MSH005", flag, shape("collision"))


@pytest.mark.parametrize("code", ["MSH005", "MSH006", "MSH009", "MSH010", "MSH013", "MSH014"])
def test_what_only_matters_in_contact_is_not_reported_of_drawn_meshes(tmp_path: Path, code: str) -> None:
    content = WALLED + "f 1 2 5\n" + moved(CLOSED, 100.0, 5)
    links = (shape("visual", scale="1 1 -1"),)
    assert not find_in_mesh(tmp_path, code, content, *links, options={"MSH009": {"triangles": 3}})


# -- MSH006, MSH007 -------------------------------------------------------------------------------------------------


def test_triangles_that_are_nothing_are_counted_for_all_meshes_together(tmp_path: Path) -> None:
    (tmp_path / "other.obj").write_text(CLOSED + "v 0.5 0 0\nf 1 2 5\nf 1 1 2\n")
    links = (shape("collision"), shape("collision", "other.obj"))
    (finding,) = find_in_mesh(tmp_path, "MSH006", CLOSED + "f 2 1 3\n", *links)
    assert (finding.data["duplicate"], finding.data["degenerate"]) == (1, 2)
    assert finding.severity == Severity.INFO
    assert len(finding.related) == 1
    assert "other.obj (2 without area)" in finding.message


def test_a_triangle_without_area_is_drawn_where_it_is(tmp_path: Path) -> None:
    (finding,) = find_in_mesh(
        tmp_path, "MSH006", CLOSED + "v 0.5 0 0\nf 1 2 5\n", shape("collision", scale="0.1 0.1 0.1")
    )
    assert finding.data["places"][0]["triangles"] == [[[0, 0, 0], [0.1, 0, 0], [0.05, 0, 0]]]


@pytest.mark.parametrize("number", ["nan", "inf", "-inf", "1e999"])
def test_a_corner_that_is_nowhere(tmp_path: Path, number: str) -> None:
    (finding,) = find_in_mesh(tmp_path, "MSH007", CLOSED + f"v 0 {number} 0\nf 1 2 5\n", shape("visual"))
    assert (finding.severity, finding.data["count"]) == (Severity.ERROR, 1)


def test_the_hole_that_it_leaves_is_no_second_finding(tmp_path: Path) -> None:
    assert not find_in_mesh(tmp_path, "MSH002", OPEN + "v nan 0 0\nf 1 2 5\n", shape("collision"))


def test_a_mesh_that_is_nowhere_altogether_is_unreadable(tmp_path: Path) -> None:
    nowhere = CLOSED.replace("v 0 0 0", "v nan 0 0").replace("f 2 3 4\n", "")
    assert not find_in_mesh(tmp_path, "MSH007", nowhere, shape("visual"))
    assert find_in_mesh(tmp_path, "MSH001", nowhere, shape("visual"))


# -- MSH008 ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("unit", "size", "scale"), [(1000, 0.4, "1"), (100, 0.4, "1"), (39.37, 0.4, "1"), (1, 0.4, "1000")]
)
def test_a_mesh_in_another_unit_is_larger_than_its_robot(tmp_path: Path, unit: float, size: float, scale: str) -> None:
    links = ("", shape("visual", scale=" ".join([scale] * 3)))
    (finding,) = find_in_mesh(tmp_path, "MSH008", scaled(CLOSED, unit * size), *links, step=0.3)
    assert (finding.message_id, finding.severity) == ("large", Severity.WARNING)
    assert finding.data["size"] == pytest.approx(unit * size * float(scale))
    assert "0.4 m" in finding.data["readings"] or unit == 39.37


@pytest.mark.parametrize("factor", [1e-3, 1.0, 1e3])
def test_file_and_scale_may_change_together(tmp_path: Path, factor: float) -> None:
    scale = " ".join([repr(0.4 / factor)] * 3)
    assert not find_in_mesh(tmp_path, "MSH008", scaled(CLOSED, factor), "", shape("visual", scale=scale), step=0.3)


@pytest.mark.parametrize(
    ("size", "step", "reported"), [(5.0, 0.3, False), (5.1, 0.3, True), (5.1, 0.52, False), (400.0, 0.0, False)]
)
def test_how_large_a_part_may_be_depends_on_the_robot(tmp_path: Path, size: float, step: float, reported: bool) -> None:
    """Five metres, or ten times the distance of the farthest link; without distances nothing is too large."""
    assert bool(find_in_mesh(tmp_path, "MSH008", scaled(CLOSED, size), "", shape("visual"), step=step)) == reported


@pytest.mark.parametrize(
    ("size", "travel", "carries", "drawn", "found"),
    [
        (40.0, 37.0, True, True, False),
        (100.0, 37.0, True, True, True),
        (40.0, 37.0, False, True, True),  # a finger, with limits in millimetres
        (40.0, 37.0, True, False, True),  # a mobile base, which is carried by nothing
        (40.0, 1000.0, True, True, True),  # no limit
    ],
)
def test_the_rail_of_a_gantry_is_as_long_as_what_it_travels(
    tmp_path: Path, size: float, travel: float, carries: bool, drawn: bool, found: bool
) -> None:
    (tmp_path / "part.obj").write_text(scaled(CLOSED, size))
    text = robot(
        link("hall", shape("visual") if drawn else ""),
        link("bridge", visual(box("0.5 0.5 0.5"))),
        link("arm", shape("visual")),
        joint("x", "hall", "bridge", limit(0, travel), kind="prismatic"),
        joint("turns", "bridge", "arm", kind="continuous" if carries else "fixed", xyz="0.3 0 0"),
    )
    assert bool(find(tmp_path, text, "MSH008")) == found


def test_a_lift_in_millimetres_is_no_gantry(tmp_path: Path) -> None:
    (tmp_path / "part.obj").write_text(scaled(CLOSED, 80.0))
    text = robot(
        *(link(name, shape("visual")) for name in ("column", "carriage", "arm")),
        joint("lifts", "column", "carriage", limit(0, 50), kind="prismatic"),
        joint("turns", "carriage", "arm", kind="continuous", xyz="0.05 0 0"),
    )
    assert [finding.message_id for finding in find(tmp_path, text, "MSH008")] == ["large"]


@pytest.mark.parametrize(
    ("size", "scale", "step", "reported"),
    [
        (0.4, "1000 1000 1000", 300.0, True),
        (0.4, "1000 1000 1000", 0.0, False),  # a model without extent
        (0.4, "1000 1000 0.001", 300.0, False),  # a ground plane
        (0.4, "30 30 30", 300.0, False),
        (0.4, "40 40 40", 300.0, False),  # 16 m
        (30.0, "40 40 40", 300.0, False),  # the file is not one in metres
    ],
)
def test_a_scale_can_enlarge_a_whole_robot(
    tmp_path: Path, size: float, scale: str, step: float, reported: bool
) -> None:
    found = find_in_mesh(tmp_path, "MSH008", scaled(CLOSED, size), "", shape("visual", scale=scale), step=step)
    assert [(f.message_id, f.severity) for f in found] == [("enlarged", Severity.WARNING)] * reported
    assert not any(f.fix is not None and f.fix.edits for f in found)


@pytest.mark.parametrize(
    ("name", "found"), [("ground", False), ("front_floor_2", False), ("background", True), ("ground_robot", True)]
)
def test_a_ground_is_of_any_size(tmp_path: Path, name: str, found: bool) -> None:
    (tmp_path / "part.obj").write_text(scaled(CLOSED, 100.0))
    parts = (link("base", visual(box("0.5 0.5 0.5"))), link(name, shape("visual")))
    text = robot(*parts, joint("stands", "base", name, kind="fixed", xyz="0 0 -0.3"))
    assert bool(find(tmp_path, text, "MSH008")) == found


@pytest.mark.parametrize(("scale", "code"), [("0.1 0.1 0.1", "GEO003"), ("1 1 1", "MSH008")])
def test_a_file_with_two_scales_is_not_taken_for_one_in_metres(tmp_path: Path, scale: str, code: str) -> None:
    links = shape("visual", scale=scale) + shape("collision", scale="0.001 0.001 0.001")
    found = find_in_mesh(tmp_path, {"MSH008", "GEO003"}, scaled(CLOSED, 0.9), "", links, step=0.3)
    assert [finding.code for finding in found] == [code]


def test_only_the_uses_without_scale_are_reported(tmp_path: Path) -> None:
    drawn, collides = shape("visual", scale="0.001 0.001 0.001"), shape("collision")
    (finding,) = find_in_mesh(tmp_path, "MSH008", scaled(CLOSED, 400.0), "", drawn + collides, step=0.3)
    assert finding.location.subject == "link[l1]/collision/geometry/mesh@filename"
    assert not finding.related


def test_every_link_that_uses_the_mesh_is_a_subject(tmp_path: Path) -> None:
    """What else follows from the size of the mesh is told of none of them."""
    (tmp_path / "wheel.obj").write_text(scaled(CLOSED, 60.0))
    mass = '<inertial><mass value="0.4"/><inertia ixx="3e-4" ixy="0" ixz="0" iyy="3e-4" iyz="0" izz="5e-4"/></inertial>'
    part = shape("visual", "wheel.obj") + '<collision><geometry><sphere radius="0.06"/></geometry></collision>'
    text = '<link name="base"/>' + "".join(
        f'<link name="w{i}">{mass}{part}</link><joint name="j{i}" type="continuous"><parent link="base"/>'
        f'<child link="w{i}"/><origin xyz="{x} {y} 0"/><axis xyz="0 1 0"/></joint>'
        for i, (x, y) in enumerate([(0.2, 0.1), (0.2, -0.1), (-0.2, 0.1), (-0.2, -0.1)])
    )
    codes = {"MSH008", "GEO003", "INR009", "INR010"}
    (finding,) = check_text(tmp_path, f'<robot name="r">{text}</robot>', codes=codes).findings
    assert [subject.split("/")[0] for subject in finding.subjects] == [f"link[w{i}]" for i in range(4)]


def test_what_other_rules_measure_goes_by_the_default_thresholds() -> None:
    options = {name: option.default for name, option in load_rules()["MSH008"].options.items()}
    assert options == mesh_sizes.DEFAULT_LIMITS


@pytest.mark.parametrize(("size", "scale"), [(400.0, "1 1 1"), (0.4, "0.001 0.001 0.001")])
def test_nothing_is_measured_on_a_mesh_in_the_wrong_size(tmp_path: Path, size: float, scale: str) -> None:
    (tmp_path / "part.obj").write_text(scaled(CLOSED, size))
    inertial = (
        '<inertial><mass value="2"/><inertia ixx="0.05" ixy="0" ixz="0" iyy="0.05" iyz="0" izz="0.05"/></inertial>'
    )
    part = shape("visual", "part.obj", scale=scale) + shape("collision", "part.obj", scale=scale)
    sensor = (
        '<gazebo reference="l"><sensor name="s" type="gpu_lidar"><lidar><scan><horizontal><samples>90</samples>'
        "<min_angle>-3.1</min_angle><max_angle>3.1</max_angle></horizontal></scan><range><min>0.1</min><max>300</max></range>"
        "</lidar></sensor></gazebo>"
    )
    text = (
        f'<robot name="r"><link name="base"/><link name="l">{inertial}{part}</link><link name="other">{inertial}'
        '<collision><geometry><box size="0.4 0.4 0.4"/></geometry></collision></link>'
        '<joint name="j" type="fixed"><parent link="base"/><child link="l"/><origin xyz="0.5 0 0"/></joint>'
        '<joint name="k" type="revolute"><parent link="base"/><child link="other"/><origin xyz="-0.5 0 0"/>'
        f'<axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="9" velocity="1"/></joint>{sensor}</robot>'
    )
    found = check_text(tmp_path, text).findings
    measured = [f.code for f in found if f.code[:3] in {"INR", "GEO", "COL", "DYN", "MSH"} or f.code == "GZB009"]
    assert measured == ["MSH008"]


@pytest.mark.parametrize(("largest", "reported"), [(5.0, "MSH008"), (50.0, "INR010")])
def test_a_size_that_the_configuration_allows_is_measured(tmp_path: Path, largest: float, reported: str) -> None:
    (tmp_path / "part.obj").write_text(scaled(CLOSED, 8.0))
    text = robot(
        link("base"),
        link("l", inertial(2, 1e-3), shape("visual")),
        joint("j", "base", "l", kind="continuous", xyz="0 0 0.5"),
    )
    options = {"MSH008": {"largest": largest}}
    run = check_text(tmp_path, text, codes={"MSH008", "INR010"}, options=options)
    assert [finding.code for finding in run.findings] == [reported]


def test_metres_that_are_scaled_as_millimetres_vanish(tmp_path: Path) -> None:
    (finding,) = find_in_mesh(
        tmp_path, "MSH008", scaled(CLOSED, 0.4), "", shape("visual", scale="0.001 0.001 0.001"), step=0.3
    )
    assert finding.message_id == "small"


@pytest.mark.parametrize(("mass", "reported"), [("8.4e-8", False), ("0.1", True)])
def test_a_part_that_weighs_as_little_as_its_mesh_is_meant(tmp_path: Path, mass: str, reported: bool) -> None:
    """A letter of a logo, of steel: 0.4 mm, in millimetres like the rest of the robot."""
    inertial = f'<inertial><mass value="{mass}"/></inertial>'
    drawn = shape("visual", scale="0.001 0.001 0.001")
    found = find_in_mesh(tmp_path, "MSH008", scaled(CLOSED, 0.4), "", inertial + drawn, step=0.3)
    assert bool(found) == reported


@pytest.mark.parametrize("role", ["visual", "collision"])
def test_moveit_does_not_load_the_unit_of_a_visual_mesh(tmp_path: Path, role: str) -> None:
    (finding,) = find_in_mesh(tmp_path, "MSH008", collada(0.0254, 15.0), shape(role, "part.dae"), name="part.dae")
    assert (role == "collision") == ("MoveIt" in finding.message) == ("ignores" in finding.consequences["moveit"])


@pytest.mark.parametrize(
    ("others", "size", "unit", "found"), [(3, 400.0, 0.001, True), (1, 400.0, 0.001, False), (3, 3.4, 0.0254, True)]
)
def test_a_mesh_that_is_scaled_twice_gets_the_usual_scale(
    tmp_path: Path, others: int, size: float, unit: float, found: bool
) -> None:
    """What most other meshes of the robot have decides: 400 may be millimetres, centimetres or inches, 3.4 inches or metres."""
    (tmp_path / "part.obj").write_text(scaled(CLOSED, size))
    scales = [f"{unit} {unit} {unit}"] * others + ["{0} -{0} {0}".format(unit * 1e-3)]
    text = '<link name="base"/>' + "".join(
        f'<link name="p{i}">{shape("visual", "part.obj", scale=scale)}</link><joint name="j{i}" type="continuous">'
        f'<parent link="base"/><child link="p{i}"/><origin xyz="{0.2 + i} 0 0"/></joint>'
        for i, scale in enumerate(scales)
    )
    findings = check_text(tmp_path, f'<robot name="r">{text}</robot>', codes={"MSH008"}).findings
    assert [f.message_id for f in findings] == ["twice"] * found
    for finding in findings:
        assert finding.fix is not None
        assert [edit.replacement for edit in finding.fix.edits] == [f"{unit} -{unit} {unit}"]


def test_a_usual_scale_that_converts_no_unit_is_no_repair(tmp_path: Path) -> None:
    """Blades that are made longer by a factor say nothing about the unit of the arm's file, which is in metres."""
    (tmp_path / "part.obj").write_text(scaled(CLOSED, 0.3))
    text = '<link name="base"/>' + "".join(
        f'<link name="p{i}">{shape("visual", "part.obj", scale=scale)}</link><joint name="j{i}" type="continuous">'
        f'<parent link="base"/><child link="p{i}"/><origin xyz="{0.2 + i} 0 0"/></joint>'
        for i, scale in enumerate(["0.12 0.12 0.12"] * 3 + ["0.001 0.001 0.001"])
    )
    (finding,) = check_text(tmp_path, f'<robot name="r">{text}</robot>', codes={"MSH008"}).findings
    assert finding.message_id == "small"
    assert finding.fix is not None
    assert [edit.replacement for edit in finding.fix.edits] == ["1 1 1"]


@pytest.mark.parametrize(
    ("roles", "said"),
    [
        (("visual",), {"rviz": "draws nothing visible"}),
        (("collision",), {"rviz": "loads it: a collision shape, which it draws on request alone"}),
        (("visual", "collision"), {"rviz": "draws nothing visible"}),
    ],
)
def test_a_scale_on_the_collision_alone_leaves_the_drawing_whole(
    tmp_path: Path, roles: tuple[str, ...], said: dict[str, str]
) -> None:
    shapes = "".join(
        shape(role, scale="0.001 0.001 0.001" if role in roles else "1 1 1") for role in ("visual", "collision")
    )
    (finding,) = find_in_mesh(tmp_path, "MSH008", scaled(CLOSED, 0.2), shapes, "", step=0.3)
    assert finding.message_id == "small"
    assert {name: finding.consequences[name] for name in said} == said
    assert ("gazebo" in finding.consequences) == (roles == ("collision",))


def test_a_speck_beside_another_collision_shape_leaves_the_part_touchable(tmp_path: Path) -> None:
    shapes = shape("visual", scale="1 1 1") + shape("collision", scale="0.001 0.001 0.001")
    beside = '<collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision>'
    (finding,) = find_in_mesh(tmp_path, "MSH008", scaled(CLOSED, 0.2), shapes + beside, "", step=0.3)
    assert finding.message_id == "small"
    assert "gazebo" not in finding.consequences


def test_a_tiny_mesh_without_scale_is_meant(tmp_path: Path) -> None:
    assert not find_in_mesh(tmp_path, "MSH008", scaled(CLOSED, 0.0004), "", shape("visual"), step=0.3)


@pytest.mark.parametrize(
    ("unit", "size", "scale", "right"),
    [
        (0.0254, 15.7, "1", "right in RViz"),
        (0.001, 0.4, "1", "wrong in RViz"),
        (0.0254, 0.4, "39.37", "right in RViz"),
        (0.9, 0.4, "1", "one of them"),
    ],
)
def test_the_unit_of_collada_divides_the_programs(
    tmp_path: Path, unit: float, size: float, scale: str, right: str
) -> None:
    links = ("", shape("visual", "part.dae", " ".join([scale] * 3)))
    (finding,) = find_in_mesh(tmp_path, "MSH008", collada(unit, size), *links, name="part.dae", step=0.3)
    assert finding.message_id == "unit"
    assert right in finding.message
    assert finding.data["drawn"] == pytest.approx(finding.data["plain"] * unit)


@pytest.mark.parametrize("unit", [1.0, 1.0005])
def test_a_unit_of_one_metre_does_not(tmp_path: Path, unit: float) -> None:
    assert not find_in_mesh(tmp_path, "MSH008", collada(unit, 0.4), shape("visual", "part.dae"), name="part.dae")


def test_meshes_of_one_unit_are_one_finding(tmp_path: Path) -> None:
    (tmp_path / "other.dae").write_text(collada(0.0254, 7.0))
    links = (shape("visual", "part.dae"), shape("visual", "other.dae") + shape("collision", "other.dae"))
    (finding,) = find_in_mesh(tmp_path, "MSH008", collada(0.0254, 15.0), *links, name="part.dae")
    assert (finding.data["count"], len(finding.related)) == (2, 2)


@pytest.mark.parametrize("unit", [0.0, -1.0, float("inf"), float("nan")])
def test_a_unit_that_is_no_positive_number_is_reported_once_for_all_that_declare_it(
    tmp_path: Path, unit: float
) -> None:
    both = shape("visual", "part.dae") + shape("collision", "part.dae")
    (finding,) = find_in_mesh(tmp_path, "MSH008", collada(unit, 0.4), both, both, name="part.dae", step=0.3)
    assert (finding.message_id, finding.data["declared"], len(finding.related)) == ("unit_invalid", repr(unit), 3)


# -- MSH009, MSH010 -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("limit", "reported"), [(3, True), (4, False)])
def test_how_many_triangles_may_collide(tmp_path: Path, limit: int, reported: bool) -> None:
    links = (shape("visual") + shape("collision"), shape("collision"))
    findings = find_in_mesh(tmp_path, "MSH009", CLOSED, *links, options={"MSH009": {"triangles": limit}})
    assert [(f.data["triangles"], len(f.related)) for f in findings] == ([(4, 1)] if reported else [])
    assert [f.headline for f in findings] == (["l0: collision mesh has 4 triangles (limit 3)"] if reported else [])


@pytest.mark.parametrize(
    ("user", "manifest", "severity"),
    [
        ("", "", Severity.WARNING),
        ("rviz2", "", Severity.INFO),
        ("moveit_ros_move_group", "", Severity.WARNING),
        ("rviz2", "gazebo_ros", Severity.WARNING),
    ],
)
def test_many_triangles_are_an_info_where_the_users_of_a_description_never_collide(
    tmp_path: Path, user: str, manifest: str, severity: Severity
) -> None:
    files = {
        "arm/package.xml": f"<package><name>arm</name><depend>{manifest}</depend></package>",
        "arm/arm.urdf": robot(link("l", shape("collision"))),
        "arm/part.obj": CLOSED,
    }
    if user:
        files["bringup/package.xml"] = f"<package><name>bringup</name><exec_depend>{user}</exec_depend></package>"
        files["bringup/show.launch"] = (
            '<launch><param name="robot_description" textfile="$(find arm)/arm.urdf"/></launch>'
        )
        files[".git/config"] = ""
    (finding,) = find(tmp_path, files, "MSH009", name="arm/arm.urdf", options={"MSH009": {"triangles": 1}})
    assert finding.severity is severity


@pytest.mark.parametrize(("step", "advice"), [(0, "export one part per link: 3 links"), (1, "use a copy decimated")])
def test_a_mesh_of_the_whole_robot_in_each_link_is_not_to_be_decimated(tmp_path: Path, step: int, advice: str) -> None:
    parts = [link("base")]
    for number in range(3):
        name = f"l{number}"
        (tmp_path / f"{name}.obj").write_text(CLOSED)
        both = shape("collision", f"{name}.obj") + shape("visual", "l0.obj")
        parts += [link(name, both), joint(f"j{number}", "base", name, kind="continuous", xyz=f"{step * number} 0 0")]
    found = find(tmp_path, robot(*parts), "MSH009", options={"MSH009": {"triangles": 3}})
    assert {finding.fix.title.startswith(advice) for finding in found if finding.fix is not None} == {True}


@pytest.mark.parametrize(
    ("scale", "mirrors"), [("1 -1 1", True), ("-1 -1 1", False), ("-1 -1 -1", True), ("0 -1 1", False)]
)
def test_an_odd_number_of_negative_factors_is_a_mirror(tmp_path: Path, scale: str, mirrors: bool) -> None:
    assert bool(find_in_mesh(tmp_path, "MSH010", CLOSED, shape("collision", scale=scale))) == mirrors


def test_all_mirrored_shapes_are_one_finding(tmp_path: Path) -> None:
    left, right = shape("collision", scale="1 -1 1"), shape("collision")
    (finding,) = find_in_mesh(tmp_path, "MSH010", CLOSED, left, right, left)
    assert (finding.data["count"], len(finding.related)) == (2, 1)


# -- MSH011, MSH012 -------------------------------------------------------------------------------------------------

PLY = (
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
    "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
)
OFF = "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n"


@pytest.mark.parametrize(
    ("name", "content", "refused"),
    [
        ("part.obj", CLOSED, set()),
        ("part.stl", stl(b"part"), {"drake"}),
        ("part.dae", collada(1.0, 1.0), {"mujoco", "drake"}),
        ("part.ply", PLY, {"mujoco", "drake", "bullet", "gazebo", "isaac"}),
        ("part.off", OFF, {"mujoco", "drake", "bullet", "gazebo", "isaac"}),
    ],
)
def test_which_program_loads_what(tmp_path: Path, name: str, content: str | bytes, refused: set[str]) -> None:
    targets = ("gazebo", "mujoco", "drake", "bullet", "isaac", "rviz", "moveit", "pinocchio")
    findings = find_in_mesh(tmp_path, "MSH011", content, shape("collision", name), name=name, targets=targets)
    assert {f.message_id for f in findings} == refused


def test_without_a_target_it_is_one_info_that_names_who_cannot(tmp_path: Path) -> None:
    (finding,) = find_in_mesh(tmp_path, "MSH011", OFF, shape("collision", "part.off"), name="part.off")
    assert finding.severity is Severity.INFO
    assert finding.message.startswith("MuJoCo, Drake, PyBullet, Gazebo, Isaac Sim cannot load")
    assert set(finding.consequences) == {"mujoco", "drake", "bullet", "gazebo", "isaac", "newton"}


@pytest.mark.parametrize(("name", "content", "reported"), [("part.off", OFF, True), ("part.obj", CLOSED, False)])
def test_the_importers_to_usd_read_what_is_only_drawn_too(
    tmp_path: Path, name: str, content: str, reported: bool
) -> None:
    findings = find_in_mesh(tmp_path, "MSH011", content, shape("visual", name), name=name, targets=("isaac",))
    assert [(f.message_id, f.severity) for f in findings] == ([("isaac", Severity.ERROR)] if reported else [])


@pytest.mark.parametrize(("setting", "reported"), [("", False), ('<compiler discardvisual="false"/>', True)])
def test_mujoco_does_not_open_what_is_only_drawn(tmp_path: Path, setting: str, reported: bool) -> None:
    (tmp_path / "part.off").write_text(OFF)
    text = f'<robot name="r"><mujoco>{setting}</mujoco><link name="l">{shape("visual", "part.off")}</link></robot>'
    assert bool(check_text(tmp_path, text, codes={"MSH011"}, targets=("mujoco",)).findings) == reported


def test_mujoco_counts_the_triangles_of_stl_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(msh011_format_unsupported, "MUJOCO_STL_FACES", 0)
    links = (shape("collision", "part.stl"), shape("collision", "part.obj"))
    (tmp_path / "part.obj").write_text(CLOSED)
    (finding,) = find_in_mesh(tmp_path, "MSH011", stl(b"part"), *links, name="part.stl", targets=("mujoco",))
    assert (finding.message_id, finding.data["triangles"], finding.data["count"]) == ("faces", 1, 1)


TEXT = (
    b"solid p\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n"
)


@pytest.mark.parametrize(("content", "message"), [(stl(b"solid part"), "solid"), (TEXT, "text"), (stl(b"part"), None)])
def test_an_stl_file_should_look_like_what_it_is(tmp_path: Path, content: bytes, message: str | None) -> None:
    findings = find_in_mesh(tmp_path, "MSH012", content, shape("visual", "part.stl"), name="part.stl")
    assert [f.message_id for f in findings] == ([] if message is None else [message])
    assert all(f.headline.endswith(": part.stl") for f in findings)
    assert all(f.severity == (Severity.INFO if message == "solid" else Severity.WARNING) for f in findings)


def test_yourdfpy_loads_text_stl(tmp_path: Path) -> None:
    import yourdfpy

    (finding,) = find_in_mesh(tmp_path, "MSH012", TEXT, shape("visual", "part.stl"), name="part.stl")
    robot = yourdfpy.URDF.load(str(finding.location.span.file))
    assert len(robot.scene.geometry) == 1
    assert finding.consequences["yourdfpy"] == "loads it"


# -- MSH013, MSH014 -------------------------------------------------------------------------------------------------


def test_the_mesh_of_most_pieces_comes_first(tmp_path: Path) -> None:
    (tmp_path / "two.obj").write_text(CLOSED + moved(CLOSED, 2.0, 4))
    three = CLOSED + moved(CLOSED, 2.0, 4) + moved(CLOSED, 4.0, 8)
    (finding,) = find_in_mesh(tmp_path, "MSH013", three, shape("collision", "two.obj"), shape("collision"))
    assert finding.data["meshes"] == "part.obj (3), two.obj (2)"
    assert finding.location.subject.startswith("link[l1]")


def test_pieces_that_touch_in_an_edge_hang_together(tmp_path: Path) -> None:
    assert not find_in_mesh(tmp_path, "MSH013", TOUCHING, shape("collision"))


@pytest.mark.parametrize("scale", ["1 1 1", "0.001 0.001 0.001", "1 1 -7"])
@pytest.mark.parametrize(("content", "reported"), [(CLOSED + moved(CLOSED, 3.0, 4), True), (CLOSED, False)])
def test_a_hull_that_is_much_larger_than_its_mesh(tmp_path: Path, content: str, reported: bool, scale: str) -> None:
    """Two tetrahedra side by side and three apart: their hull adds a prism, and is five times their volume."""
    findings = find_in_mesh(tmp_path, "MSH014", content, shape("collision", scale=scale))
    assert [f.data["most"] for f in findings] == ([pytest.approx(5.0)] if reported else [])
    assert [f.headline for f in findings] == (["convex hull far larger than mesh: part.obj (5×)"] if reported else [])


def test_a_large_ratio_of_hull_and_mesh_is_written_out(tmp_path: Path) -> None:
    (finding,) = find_in_mesh(tmp_path, "MSH014", CLOSED + moved(CLOSED, 300.0, 4), shape("collision"))
    assert "e+" not in finding.message


@pytest.mark.parametrize(("times", "reported"), [(4.9, True), (5.1, False)])
def test_how_much_larger_a_hull_may_be(tmp_path: Path, times: float, reported: bool) -> None:
    content = CLOSED + moved(CLOSED, 3.0, 4)
    assert (
        bool(find_in_mesh(tmp_path, "MSH014", content, shape("collision"), options={"MSH014": {"times": times}}))
        == reported
    )


@pytest.mark.parametrize("content", [OPEN, OPEN + moved(OPEN, 3.0, 4), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 3 2\n"])
def test_a_mesh_without_volume_loses_none(tmp_path: Path, content: str) -> None:
    assert not find_in_mesh(tmp_path, "MSH014", content, shape("collision"))


# -- MSH015 ---------------------------------------------------------------------------------------------------------

QUAD = "v 0 0 0.3\nv 1 0 0.3\nv 1 1 0.3\nv 0 1 0.3\nf 1 2 3\nf 1 3 4\n"
TILTED = "v 0 0 0\nv 1 0 0.3\nv 1 1 0.7\nv 0 1 0.4\nf 1 2 3\nf 1 3 4\n"


@pytest.mark.parametrize(
    ("content", "scale", "message"),
    [
        (QUAD, "1 1 1", "flat"),
        (QUAD, "-0.01 0.01 0.01", "flat"),
        ("v 0 0 0\nv 1 0 0.3\nv 1 1 0.7\nf 1 2 3\n", "1 1 1", "flat"),
        (TILTED, "1 1 1", None),
        (CLOSED, "1 1 1", None),
        (OPEN, "1 1 1", None),
        (CLOSED, "1e-5 1e-5 1e-5", "tiny"),
        (OPEN, "1e-5 1e-5 1e-5", "tiny"),
        (INSIDE_OUT, "1e-5 1e-5 1e-5", "tiny"),
        (CLOSED, "1.8e-5 1.8e-5 1.8e-5", "tiny"),
        (CLOSED, "1.82e-5 1.82e-5 1.82e-5", None),
        (CLOSED, "1 1e-5 1e-5", None),
    ],
)
def test_what_mujoco_cannot_compile_for_want_of_volume(
    tmp_path: Path, content: str, scale: str, message: str | None
) -> None:
    text = robot(link("a", inertial(), shape("collision", scale=scale)))
    (tmp_path / "part.obj").write_text(content)
    found = find(tmp_path, text, "MSH015")
    assert [f.message_id for f in found] == ([] if message is None else [message])
    mujoco = pytest.importorskip("mujoco")
    refused = pytest.raises(ValueError, match=r"coplanar|at least 4 vertices|volume is too small")
    with contextlib.nullcontext() if message is None else refused:
        mujoco.MjModel.from_xml_string(text, {"part.obj": content.encode()})


def test_a_mesh_that_is_too_flat_is_an_error_for_mujoco_only(tmp_path: Path) -> None:
    for targets, severity in (((), Severity.INFO), (("mujoco",), Severity.ERROR), (("gazebo",), Severity.INFO)):
        (finding,) = find_in_mesh(tmp_path, "MSH015", QUAD, shape("collision"), targets=targets)
        assert finding.severity is severity
    for other in (shape("visual"), shape("collision", scale="1 1 0")):
        assert not find_in_mesh(tmp_path, "MSH015", QUAD, other)


@pytest.mark.parametrize("folder", ["urdf", "test"])
def test_a_broken_mesh_may_be_what_a_test_needs(tmp_path: Path, folder: str) -> None:
    (tmp_path / folder).mkdir()
    (tmp_path / folder / "part.stl").write_text("This is not a valid STL file.")
    text = '<robot name="r"><link name="a"><visual><geometry><mesh filename="part.stl"/></geometry></visual></link></robot>'
    (tmp_path / folder / "r.urdf").write_text(text)
    (finding,) = check(tmp_path / folder / "r.urdf", codes={"MSH001"}).findings
    assert finding.fix is not None
    assert finding.fix.title.startswith("keep it if the test needs") == (folder == "test")


@pytest.mark.parametrize(
    ("role", "manifest", "kind", "message"),
    [
        ("visual", "<depend>gazebo_ros</depend>", "fixed", "unit-drawn"),
        ("visual", "<depend>gazebo_ros</depend>", "revolute", "unit-drawn"),
        ("visual", "<depend>pinocchio</depend>", "revolute", "unit"),
        ("collision", "<depend>gazebo_ros</depend>", "fixed", "unit-unread"),
        ("collision", "<depend>moveit</depend>", "fixed", "unit"),
        ("collision", "<depend>gazebo_ros</depend>", "revolute", "unit"),
        ("visual", "<depend>pinocchio</depend>", "fixed", "unit"),
    ],
)
def test_a_unit_matters_where_a_program_ignores_it(
    tmp_path: Path, role: str, manifest: str, kind: str, message: str
) -> None:
    (tmp_path / "package.xml").write_text(f"<package><name>box</name>{manifest}</package>", encoding="utf-8")
    (tmp_path / "part.dae").write_text(collada(0.0254, 15.0), encoding="utf-8")
    parts = link("a", shape(role, "part.dae")), link("b"), joint("j", "a", "b", limit(0, 1), kind=kind, xyz="0.3 0 0")
    (finding,) = find(tmp_path, robot(*parts), "MSH008")
    assert finding.message_id == message


@pytest.mark.parametrize(
    ("role", "unit", "size", "message"),
    [
        ("visual", 0.01, 501, "unit-drawn"),
        ("visual", 100.0, 5.01, "unit"),
        ("visual", 1.1, 4.9, "unit"),
        ("collision", 0.01, 501, "unit-unread"),
    ],
)
def test_a_boat_is_larger_than_a_robot(tmp_path: Path, role: str, unit: float, size: float, message: str) -> None:
    manifest = "<package><name>boat</name><depend>gazebo_ros</depend></package>"
    (tmp_path / "package.xml").write_text(manifest, encoding="utf-8")
    (tmp_path / "hull.dae").write_text(collada(unit, size), encoding="utf-8")
    (finding,) = find(tmp_path, robot(link("a", inertial(180, 100), shape(role, "hull.dae"))), "MSH008")
    assert finding.message_id == message


@pytest.mark.parametrize(("kind", "message"), [("fixed", "unit-drawn"), ("revolute", "unit")])
def test_scenery_is_larger_than_a_robot(tmp_path: Path, kind: str, message: str) -> None:
    """A hall of 16 m, or of 640 m where its unit is ignored: the first is not said to be wrong."""
    manifest = "<package><name>hall</name><depend>rviz</depend></package>"
    (tmp_path / "package.xml").write_text(manifest, encoding="utf-8")
    (tmp_path / "hall.dae").write_text(collada(0.0254, 640.0), encoding="utf-8")
    parts = (
        link("a", shape("visual", "hall.dae")),
        link("b"),
        joint("j", "a", "b", limit(0, 1), kind=kind, xyz="0.3 0 0"),
    )
    (finding,) = [one for one in find(tmp_path, robot(*parts), "MSH008") if one.message_id.startswith("unit")]
    assert finding.message_id == message
