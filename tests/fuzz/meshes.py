"""Mesh files in every format: sound ones, and such that are wrong in their own structure."""

from __future__ import annotations

import base64
import copy
import json
import struct
from collections.abc import Callable, Sequence
from random import Random
from typing import Any

from fuzz import nasty, texts, trees

Triangle = tuple[tuple[float, float, float], ...]
Json = Any

_CORNERS = [(x, y, z) for x in (0.0, 0.1) for y in (0.0, 0.1) for z in (0.0, 0.1)]
_QUADS = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
_FACES = [face for a, b, c, d in _QUADS for face in ((a, b, c), (a, c, d))]
_TRIANGLES: list[Triangle] = [tuple(_CORNERS[i] for i in face) for face in _FACES]


def stl_binary(triangles: Sequence[Triangle] = tuple(_TRIANGLES), header: bytes = b"made for tests") -> bytes:
    body = b"".join(struct.pack("<12fH", 0, 0, 0, *(x for corner in t for x in corner), 0) for t in triangles)
    return header.ljust(80, b"\0")[:80] + struct.pack("<I", len(triangles)) + body


def stl_ascii() -> bytes:
    def facet(triangle: Triangle) -> str:
        corners = "".join(f"      vertex {x} {y} {z}\n" for x, y, z in triangle)
        return f"  facet normal 0 0 0\n    outer loop\n{corners}    endloop\n  endfacet\n"

    return f"solid box\n{''.join(map(facet, _TRIANGLES))}endsolid box\n".encode()


def obj() -> bytes:
    vertices = "".join(f"v {x} {y} {z}\n" for x, y, z in _CORNERS)
    faces = "".join(f"f {a + 1} {b + 1}/1 {c + 1}//1 {d - 8}\n" for a, b, c, d in _QUADS)
    return f"# a box\nmtllib box.mtl\no box\n{vertices}vt 0 0\nvn 0 0 1\nusemtl grey\ns off\n{faces}".encode()


def off() -> bytes:
    vertices = "".join(f"{x} {y} {z}\n" for x, y, z in _CORNERS)
    faces = "".join(f"4 {' '.join(map(str, quad))} 255 0 0\n" for quad in _QUADS)
    return f"OFF\n# a box\n8 6 12\n{vertices}{faces}".encode()


def ply(form: str = "ascii") -> bytes:
    header = (
        f"ply\nformat {form} 1.0\ncomment a box\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n"
        f"element face 12\nproperty list uchar int vertex_indices\nend_header\n"
    ).encode()
    if form == "ascii":
        lines = [*(f"{x} {y} {z}" for x, y, z in _CORNERS), *(f"3 {a} {b} {c}" for a, b, c in _FACES)]
        return header + "\n".join(lines).encode() + b"\n"
    end = "<" if form == "binary_little_endian" else ">"
    body = b"".join(struct.pack(f"{end}3f", *corner) for corner in _CORNERS)
    return header + body + b"".join(struct.pack(f"{end}B3i", 3, *face) for face in _FACES)


_POSITIONS = b"".join(struct.pack("<3f", *corner) for corner in _CORNERS)
_INDICES = b"".join(struct.pack("<3H", *face) for face in _FACES)
_BUFFER = _POSITIONS + _INDICES


def scene(uri: str | None = None) -> dict[str, Json]:
    """The JSON part of a glTF file."""
    buffer: dict[str, Json] = {"byteLength": len(_BUFFER)}
    if uri is not None:
        buffer["uri"] = uri
    return {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [
            {"name": "root", "children": [1, 2], "rotation": [0, 0, 0, 1]},
            {"name": "box", "mesh": 0, "translation": [0, 0, 0.1], "scale": [1, 1, 1]},
            {"name": "far", "mesh": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 1]},
        ],
        "meshes": [
            {"name": "box", "primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "mode": 4, "material": 0}]}
        ],
        "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 1]}}],
        "accessors": [
            {
                "bufferView": 0,
                "componentType": 5126,
                "count": 8,
                "type": "VEC3",
                "min": [0, 0, 0],
                "max": [0.1, 0.1, 0.1],
            },
            {"bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": len(_POSITIONS)},
            {"buffer": 0, "byteOffset": len(_POSITIONS), "byteLength": len(_INDICES)},
        ],
        "buffers": [buffer],
    }


def gltf(content: Json | None = None) -> bytes:
    uri = "data:application/octet-stream;base64," + base64.b64encode(_BUFFER).decode()
    return json.dumps(scene(uri) if content is None else content).encode()


def glb(content: Json | None = None, binary: bytes = _BUFFER) -> bytes:
    text = json.dumps(scene() if content is None else content).encode()
    text += b" " * (-len(text) % 4)
    binary += b"\0" * (-len(binary) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def dae() -> bytes:
    positions = " ".join(str(x) for corner in _CORNERS for x in corner)
    quads = " ".join(str(i) for quad in _QUADS[:3] for i in quad)
    triangles = " ".join(str(i) for face in _FACES[6:] for i in face)
    return f"""<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
  <asset><created>2020-01-01T00:00:00</created><modified>2020-01-01T00:00:00</modified>
    <unit name="meter" meter="1"/><up_axis>Z_UP</up_axis></asset>
  <library_effects><effect id="fx"><profile_COMMON><technique sid="t"><lambert><diffuse><color>1 0 0 1</color></diffuse>
    </lambert></technique></profile_COMMON></effect></library_effects>
  <library_materials><material id="mat"><instance_effect url="#fx"/></material></library_materials>
  <library_geometries><geometry id="box" name="box"><mesh>
    <source id="pos"><float_array id="pos-array" count="24">{positions}</float_array>
      <technique_common><accessor source="#pos-array" count="8" stride="3"><param name="X" type="float"/>
        <param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
    <vertices id="vert"><input semantic="POSITION" source="#pos"/></vertices>
    <polylist material="m" count="3"><input semantic="VERTEX" source="#vert" offset="0"/><vcount>4 4 4</vcount>
      <p>{quads}</p></polylist>
    <triangles material="m" count="6"><input semantic="VERTEX" source="#vert" offset="0"/><p>{triangles}</p></triangles>
  </mesh></geometry></library_geometries>
  <library_nodes><node id="shared"><instance_geometry url="#box"/></node></library_nodes>
  <library_visual_scenes><visual_scene id="scene">
    <node id="n1"><matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</matrix><instance_geometry url="#box"><bind_material>
      <technique_common><instance_material symbol="m" target="#mat"/></technique_common></bind_material></instance_geometry>
    </node>
    <node id="n2"><translate>1 0 0</translate><rotate>0 0 1 90</rotate><scale>1 1 1</scale>
      <instance_node url="#shared"/></node>
  </visual_scene></library_visual_scenes>
  <scene><instance_visual_scene url="#scene"/></scene>
</COLLADA>
""".encode()


SOUND: dict[str, tuple[bytes, ...]] = {
    "stl": (stl_binary(), stl_ascii(), stl_binary(header=b"solid from a CAD system")),
    "obj": (obj(),),
    "off": (off(),),
    "ply": (ply(), ply("binary_little_endian"), ply("binary_big_endian")),
    "dae": (dae(),),
    "glb": (glb(),),
    "gltf": (gltf(),),
}
_DAE = trees.read(dae())
_DAE_WORDS = trees.words_of([_DAE])
_DAE_PLANTS = (
    '<instance_node url="#n1"/>',
    '<instance_node url="#shared"/>',
    '<node id="shared"><instance_node url="#shared"/></node>',
    '<instance_geometry url="#box"/>',
    '<instance_visual_scene url="#scene"/>',
    "<scale>-1 1 1</scale>",
    "<matrix>nan 0 0 0 0 inf 0 0 0 0 1 0 0 0 0 1</matrix>",
    "<lookat>0 0 0 0 0 0 0 0 0</lookat>",
    "<skew>1 2 3</skew>",
    '<unit meter="0.0254"/>',
    '<unit meter="-1"/>',
    "<up_axis>Q_UP</up_axis>",
    '<extra><technique profile="x"/></extra>',
    '<lines count="2"><input semantic="VERTEX" source="#vert" offset="0"/><p>0 1 1 2</p></lines>',
    '<polygons count="1"><input semantic="VERTEX" source="#vert" offset="0"/><p>0 1 2 3</p></polygons>',
    '<tristrips count="1"><input semantic="VERTEX" source="#vert" offset="0"/><p>0 1 2 3</p></tristrips>',
    '<input semantic="NORMAL" source="#pos" offset="1"/>',
    '<input semantic="VERTEX" source="#vert" offset="1000000"/>',
    "<instance_controller url='#box'/>",
    "<library_controllers><controller id='c'><skin source='#box'/></controller></library_controllers>",
)


def mutated(name: str, rng: Random) -> bytes:
    """A wrong mesh file of this format."""
    data = rng.choice(SOUND[name])
    if rng.random() < 0.02:
        return data
    if rng.random() < 0.03:  # another format under this name
        return rng.choice(SOUND[rng.choice(list(SOUND))])
    if name == "dae" and rng.random() < 0.8:
        return trees.mutated(_DAE, rng, _DAE_WORDS, lambda rng: rng.choice(_DAE_PLANTS), _dae_numbers)
    if name in {"glb", "gltf"} and rng.random() < 0.7:
        return _gltf(name, rng)
    kinds: Sequence[Callable[..., bytes]] = texts.TEXT
    if name == "dae":
        kinds = texts.XML
    elif data in (SOUND["stl"][0], SOUND["stl"][2], *SOUND["ply"][1:], *SOUND["glb"]):
        kinds = (*texts.BYTES, _count, _count, _float, _float, texts.number)
    elif name in {"obj", "off", "ply"}:
        kinds = (*texts.TEXT, _index, _index, _corner)
    return texts.mutated(data, rng, [d for known in SOUND.values() for d in known], kinds)


def _dae_numbers(rng: Random) -> str:
    return " ".join(
        rng.choice(("0", "1", "7", "8", "-1", *nasty.NUMBERS)) for _ in range(rng.choice((0, 1, 3, 16, 24)))
    )


def _count(data: bytes, rng: Random, _others: Sequence[bytes]) -> bytes:
    """Another 32-bit number where one may stand: the count of an STL file, lengths of GLB chunks, indices."""
    at = rng.choice((80, 80, 80, 8, 12, 16, 4 * rng.randint(0, len(data) // 4), rng.randint(0, len(data))))
    value = rng.choice((*nasty.COUNTS, max(0, len(data) - 84) // 50, len(data), len(data) - 12, rng.getrandbits(32)))
    return data[:at] + struct.pack("<I", value % 2**32) + data[at + 4 :]


def _float(data: bytes, rng: Random, _others: Sequence[bytes]) -> bytes:
    """Nasty bytes of single precision where a coordinate of a binary STL stands, or anywhere."""
    stl = 84 + 50 * rng.randint(0, max(0, (len(data) - 84) // 50)) + 4 * rng.randrange(12)
    at = rng.choice((stl, stl, 4 * rng.randint(0, len(data) // 4)))
    return data[:at] + rng.choice(nasty.FLOATS) + data[at + 4 :]


def _index(data: bytes, rng: Random, others: Sequence[bytes]) -> bytes:
    """A corner that is not there, or is written in an odd way."""
    lines = data.split(b"\n")
    faces = [i for i, line in enumerate(lines) if line.startswith((b"f ", b"3 ", b"4 "))]
    if not faces:
        return texts.number(data, rng, others)
    at = rng.choice(faces)
    words = lines[at].split(b" ")
    odd = (
        "0",
        "-1",
        "-9",
        "9",
        "8",
        "99999",
        "1/",
        "1//",
        "/1",
        "1/2/3/4",
        "1.5",
        "1e3",
        "2147483648",
        "-0",
        "+1",
        "",
        "\\",
    )
    words[rng.randrange(len(words))] = rng.choice(odd).encode()
    lines[at] = b" ".join(words)
    return b"\n".join(lines)


def _corner(data: bytes, rng: Random, _others: Sequence[bytes]) -> bytes:
    """A line of a face or of a vertex with more or fewer words."""
    lines = data.split(b"\n")
    at = rng.randrange(len(lines))
    words = lines[at].split(b" ")
    if rng.random() < 0.5:
        words.insert(rng.randint(0, len(words)), rng.choice(words))
    else:
        del words[rng.randrange(len(words))]
    if rng.random() < 0.02:
        words += [b"1"] * 10_000
    lines[at] = b" ".join(words)
    return b"\n".join(lines)


_JSON = (None, True, False, 0, 1, -1, 2, 3, 4, 5, 1.5, -1e308, 1e400, float("nan"), 2**31, 2**32, 2**53, 10**30, 10**5)
_JSON += (
    "",
    "a",
    "SCALAR",
    "VEC2",
    "VEC3",
    "VEC4",
    "MAT4",
    "POSITION",
    5120,
    5121,
    5122,
    5123,
    5125,
    5126,
    5130,
    [],
    {},
)
_JSON += (
    [0],
    [0, 0, 0],
    {"a": 1},
    [[]],
    "data:,",
    "data:application/octet-stream;base64,AAAA",
    "other.bin",
    "/etc/passwd",
)
_JSON += (
    "\x1b[31m",
    "<fuzzmarkup>",
    "file:///dev/zero",
    "data:application/gltf-buffer;base64,!!!!",
    [1e30] * 16,
    [0] * 16,
)
_KEYS = (
    "sparse",
    "normalized",
    "byteStride",
    "extensions",
    "extensionsRequired",
    "KHR_draco_mesh_compression",
    "skin",
    "camera",
)
_KEYS += (
    "weights",
    "targets",
    "animations",
    "skins",
    "images",
    "textures",
    "cameras",
    "children",
    "mode",
    "byteOffset",
    "uri",
)


def _gltf(name: str, rng: Random) -> bytes:
    binary = _BUFFER
    content = json.loads(gltf()) if name == "gltf" else scene()
    for _ in range(texts.some(rng)):
        _change_json(content, rng)
    if name == "gltf":
        return gltf(content)
    for _ in range(rng.choice((0, 0, 1, 3))):
        binary = rng.choice((*texts.BYTES, _count, _float))(binary, rng, [_BUFFER])
    return glb(content, binary)


def _change_json(content: Json, rng: Random) -> None:
    """Change, drop or add one thing somewhere in a JSON value."""
    holders = [content]
    for holder in holders:
        inner = holder.values() if isinstance(holder, dict) else holder
        holders += [v for v in inner if isinstance(v, (dict, list)) and v]
    holder = rng.choice(holders)
    keys = list(holder) if isinstance(holder, dict) else list(range(len(holder)))
    kind = rng.randrange(8)
    new = copy.deepcopy(rng.choice(_JSON))
    if not keys or kind == 0:
        if isinstance(holder, dict):
            holder[rng.choice(_KEYS)] = new
        else:
            holder += [copy.deepcopy(new) for _ in range(rng.choice((1, 1, 100)))]
    elif kind == 1:
        del holder[rng.choice(keys)]
    elif kind == 2:
        copied = json.dumps(rng.choice(holders))
        holder[rng.choice(keys)] = json.loads(copied if len(copied) < 2_000 else "{}")
    else:
        holder[rng.choice(keys)] = new
