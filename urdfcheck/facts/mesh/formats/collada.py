"""COLLADA: the triangles that its scene places.

pycollada reads them from memory, so that no other file is ever read. It is given UTF-8 without a declaration and without
``<!DOCTYPE``: no other parser takes the file for another text, and nothing is expanded. What is wrong with materials, lights or
cameras does not matter here, and other loaders ignore it.
"""

from __future__ import annotations

import io
import logging
import re
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree
from xml.parsers import expat

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.facts.mesh.decode_limits import NOT_VECTORS, MeshError, ensure_size_limits
from urdfcheck.system.encodings import UnreadableEncodingError, decode_xml

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array, Indices, Mat4

Color = tuple[float, float, float, float]

_ZIP_END = b"PK\5\6"
# No unit of a drawing is below a picometre or above a thousand million kilometres. Squares within this range are finite.
_SMALLEST_UNIT = 1e-12
# pycollada reads NaN as 0; a number too large for it stays infinite.
_NAN = re.compile(rb"(?<=[\s>])[-+]?nan(?=[\s<])", re.IGNORECASE)
# The XML declaration, which only blanks may precede here; XML itself allows none.
_DECLARATION = re.compile(r"(\s*)<\?xml\s[^>]{0,300}\?>")
# What has no effect on the geometry: libraries, and what refers to them.
_APPEARANCE = frozenset(
    {
        *("library_images", "library_effects", "library_materials", "library_lights", "library_cameras"),
        *("library_animations", "library_animation_clips"),
        *("bind_material", "instance_light", "instance_camera", "extra"),
    }
)
# The attributes of an accessor that say how many numbers it reads, with their defaults.
_ACCESSOR = (("count", ""), ("stride", "1"), ("offset", "0"))
# What pycollada puts into its messages by mistake.
_SLIP = re.compile(r"( in effect)? `?<built-in function id>`?")


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class ColladaScene:
    """What a COLLADA file places."""

    parts: list[tuple[Array, Indices, Mat4]]
    """Vertices (V, 3), faces (F, 3), and the matrix (4, 4) that places them, for each primitive."""
    colors: tuple[tuple[int, Color | None], ...]
    """Runs of faces with the colour of their material, None without one; empty if the file has no colours."""
    unit: float | None
    """Metres per unit; None if the file declares none, or none that is plausible."""
    bad_unit: str | None
    """The declared unit if it is not a plausible length."""
    up_axis: str
    flaw: str | None
    """What is wrong with the file for stricter readers: pycollada by itself reads less of it, or nothing."""
    doubt: str | None
    """What is wrong with the file for readers that may be stricter."""


def read_collada(data: bytes) -> ColladaScene:
    """Read the scene of a COLLADA file.

    :raises MeshError: when it is not one, declares entities, places nothing, less than it declares, or more than the limits.
    :raises ImportError: when pycollada is not installed.
    """
    if _ZIP_END in data:  # pycollada would unpack it, regardless of its size
        raise MeshError("archive", "is a zip archive, not a COLLADA document")
    text = _decode_document(data)
    declaration = _DECLARATION.match(text)
    misplaced = None
    if declaration is not None:
        text = declaration[1] + text[declaration.end() :]
        if declaration[1]:
            line = declaration[1].count("\n") + 1
            misplaced = (
                f"is not XML to a strict parser: line {line}: the XML declaration is not at the beginning of the file"
            )
    content = text.encode("utf-8", "surrogatepass")
    _ensure_plain_xml(content)
    if b"nan" in content.lower():
        content = _NAN.sub(b"1e999", content)
    return _read_scene(content, misplaced)


def _decode_document(data: bytes) -> str:
    """Return the text of the document: Assimp, and engines, decode nothing, and must find the same.

    :raises MeshError: when it is no text, or may be another to readers that heed what it declares.
    """
    try:
        return decode_xml(data).text
    except UnreadableEncodingError as error:
        line = error.before.count("\n") + 1
        raise MeshError("encoding", f"cannot be read as dae: line {line}: {error}") from None


def _ensure_plain_xml(content: bytes) -> None:
    """Parse the text once with expat, which says what line is wrong.

    :raises MeshError: when it is not XML, or has a ``<!DOCTYPE``.
    """

    def refuse_doctype(*_: object) -> None:
        raise MeshError(
            "entities", "has a <!DOCTYPE, which may declare entities: no exporter writes one, and none is read"
        )

    parser = expat.ParserCreate("utf-8")
    parser.StartDoctypeDeclHandler = refuse_doctype
    try:
        parser.Parse(content, True)
    except expat.ExpatError as error:
        message = f"line {error.lineno}: {expat.ErrorString(error.code)}"
        raise MeshError("malformed", f"cannot be read as dae: {message}") from None


def _read_scene(content: bytes, flaw: str | None) -> ColladaScene:
    """Read the scene; where pycollada fails, once more without what does not matter for the geometry."""
    whole, errors = _try_reading(content)
    if not errors and whole is not None:
        return _build_scene(whole, flaw)
    bare, left = _try_reading(_strip_appearance(content))
    if bare is None or not (bare.n_triangles or whole):
        raise _make_error(errors, left)
    if left and bare.n_triangles and any(_is_geometry_error(error) for error in left):
        raise MeshError("incomplete", f"is only partly readable: {_describe_error(_pick_error(errors, left))}")
    if whole is not None and whole.n_triangles == bare.n_triangles:
        if not whole.n_triangles and left:
            raise _make_error(errors, left)
        return _build_scene(whole, flaw)
    return _build_scene(bare, flaw or f"cannot be read whole by pycollada: {_describe_error(errors[0])}")


@dataclass(frozen=True, slots=True, eq=False)
class _Reading:
    """What pycollada read."""

    document: Any
    parts: list[tuple[Array, Indices, Mat4]]
    colors: list[tuple[int, Color | None]]

    @property
    def n_triangles(self) -> int:
        return sum(len(faces) for _, faces, _ in self.parts)


def _try_reading(content: bytes) -> tuple[_Reading | None, list[Exception]]:
    """Return what pycollada reads, None if it breaks off, and its errors in the order in which they occurred.

    :raises MeshError: for more than the limits, or less than the file declares.
    """
    from collada import Collada
    from collada.common import DaeError

    try:
        with silence_logger("collada"), refuse_half_read_numbers():
            document = Collada(io.BytesIO(content), ignore=[DaeError])
        return _Reading(document, *_collect_parts(document)), list(document.errors)
    except (MeshError, ImportError, MemoryError):
        raise
    except Exception as error:  # pycollada raises whatever its internals do: AttributeError, IndexError, DaeError …
        return None, [error]


def _collect_parts(document: Any) -> tuple[list[tuple[Array, Indices, Mat4]], list[tuple[int, Color | None]]]:
    parts: list[tuple[Array, Indices, Mat4]] = []
    colors: list[tuple[int, Color | None]] = []
    if document.scene is not None:
        _refuse_bomb(document.scene.nodes)
        for geometry in document.scene.objects("geometry"):
            for primitive in geometry.primitives():
                triangles = primitive.triangleset() if hasattr(primitive, "triangleset") else primitive
                if hasattr(triangles, "ntriangles") and triangles.vertex is not None and triangles.ntriangles:
                    faces = np.asarray(triangles.vertex_index, dtype=np.int64).reshape(-1, 3)
                    parts.append((np.asarray(triangles.vertex, dtype=np.float64), faces, geometry.matrix))
                    colors.append((len(faces), _get_diffuse_color(primitive.material)))
    return parts, colors


def _build_scene(reading: _Reading, flaw: str | None) -> ColladaScene:
    document = reading.document
    if not reading.parts and document.scene is None:
        raise MeshError("no-triangles", "has no <scene> that places its geometry")
    declared = document.xmlnode.find("{*}asset/{*}unit")
    text = None if declared is None else declared.get("meter")
    unit = None if text is None else _parse_unit_length(text)
    known = any(color is not None for _, color in reading.colors)
    return ColladaScene(
        parts=reading.parts,
        colors=tuple(reading.colors) if known else (),
        unit=unit,
        bad_unit=text if unit is None else None,
        up_axis=document.assetInfo.upaxis,
        flaw=flaw,
        doubt=_find_short_array(document.xmlnode),
    )


def _find_short_array(document: Any) -> str | None:
    """Describe the first accessor that declares more numbers than its array has: pycollada ignores what it declares."""
    sizes = {array.get("id"): array.get("count", "") for array in document.iterfind(".//{*}float_array")}
    short: list[tuple[str, int, int, int, int]] = []
    for accessor in document.iterfind(".//{*}accessor"):
        texts = (
            *(accessor.get(name, default) for name, default in _ACCESSOR),
            sizes.get(accessor.get("source", "").removeprefix("#"), ""),
        )
        if all(text.isdecimal() and len(text) < 20 for text in texts):
            rows, width, first, size = (int(text) for text in texts)
            if first + rows * width > size:
                line = getattr(accessor, "sourceline", None)
                where = "an <accessor>" if line is None else f"the <accessor> in line {line}"
                short.append((where, rows, width, first, size))
    if not short:
        return None
    where, rows, width, first, size = short[0]
    # Some converters write the count of the array, everywhere.
    if all(rows == size and first == 0 and size % width == 0 for _, rows, width, first, size in short):
        return f"is inconsistent: {where} counts {size:,} {NOT_VECTORS} {size // width:,} vectors"
    return f"is inconsistent: {where} counts {first + rows * width:,} numbers, and its array has {size:,}"


def _strip_appearance(content: bytes) -> bytes:
    """Return the document without what has no effect on its geometry."""
    root = ElementTree.fromstring(content)
    stack = [root]
    while stack:
        element = stack.pop()
        for child in list(element):
            if child.tag.rpartition("}")[2] in _APPEARANCE:
                element.remove(child)
            else:
                stack.append(child)
    stripped: bytes = ElementTree.tostring(root, encoding="utf-8", xml_declaration=False)
    return stripped


def _is_geometry_error(error: Exception) -> bool:
    """Whether pycollada left out triangles for an error, rather than something that it does not know (curves), or a place that
    refers to that or to nothing."""
    from collada.common import DaeUnsupportedError

    return not isinstance(error, DaeUnsupportedError) and "not found in library" not in str(error)


def _make_error(errors: Sequence[Exception], left: Sequence[Exception]) -> MeshError:
    return MeshError("malformed", f"cannot be read as dae: {_describe_error(_pick_error(errors, left))}")


def _pick_error(errors: Sequence[Exception], left: Sequence[Exception]) -> Exception:
    """Return the first of ``errors`` that is also ``left`` without materials and lights: only those know their lines."""
    texts = {str(error) for error in left}
    return next((error for error in errors if str(error) in texts), (*errors, *left)[0])


def _describe_error(error: Exception) -> str:
    """Return what pycollada says, with the line of the element at which it failed."""
    text = " ".join(str(error).split())
    while (kind := f"{type(error).__name__}: ") and text.startswith(kind):
        text = text.removeprefix(kind)
    text = _SLIP.sub("", text)[:200]
    if not type(error).__module__.startswith("collada"):
        text = f"{type(error).__name__}: {text}"
    element = _find_element(error)
    if element is None:
        return text
    inside = " ".join((element.text or "").split())
    said = f" ({inside[:40]!r})" if inside else ""
    return f"line {element.sourceline}: {text[:1].lower()}{text[1:]}{said}"


def _find_element(error: BaseException) -> Any | None:
    """Return the XML element that the innermost function of pycollada was reading; None if there is none."""
    found, trace = None, error.__traceback__
    while trace is not None:
        known = [v for v in trace.tb_frame.f_locals.values() if isinstance(getattr(v, "sourceline", None), int)]
        found = known[-1] if known else found
        trace = trace.tb_next
    return found


def _get_diffuse_color(material: Any) -> Color | None:
    """Return the diffuse colour of pycollada's material; None without one, and for a texture, which is another file."""
    color = getattr(getattr(material, "effect", None), "diffuse", None)
    if not isinstance(color, tuple) or len(color) < 3 or not all(0.0 <= part <= 1.0 for part in color[:3]):
        return None
    red, green, blue = map(float, color[:3])
    return red, green, blue, 1.0


def _refuse_bomb(nodes: list[Any]) -> None:
    """Reject nodes of pycollada that place too much, or truncated geometry, before anything is expanded."""
    known: dict[int, Array] = {}  # geometries and triangles that a node places

    def count_placed(node: Any) -> Array:
        if id(node) not in known:
            total = np.zeros(2)
            if hasattr(node, "geometry"):
                total += 1, sum(_count_triangles(primitive) for primitive in node.geometry.primitives)
            for child in (node.node,) if hasattr(node, "node") else getattr(node, "children", ()):
                total += count_placed(child)
            known[id(node)] = total
        return known[id(node)]

    geometries, triangles = sum((count_placed(node) for node in nodes), np.zeros(2))
    ensure_size_limits(float(triangles), float(geometries))


def _count_triangles(primitive: Any) -> int:
    """Estimate how many triangles a primitive has.

    :raises MeshError: when it declares more polygons than it has.
    """
    present = getattr(primitive, "ntriangles", getattr(primitive, "npolygons", None))
    if present is None:
        return 0
    kind, declared = primitive.xmlnode.tag.rpartition("}")[2], primitive.xmlnode.get("count", "")
    if kind in {"triangles", "polylist", "polygons"} and declared.isdecimal() and present < int(declared):
        at = getattr(primitive.xmlnode, "sourceline", None)
        where = "" if at is None else f"line {at}: "
        raise MeshError("truncated", f"is truncated: {where}it declares {int(declared):,} {kind} but has {present:,}")
    return len(primitive.index)


def _parse_unit_length(text: str) -> float | None:
    """Parse the length of a unit in metres; None if the text is not a plausible one."""
    try:
        value = float(text)
    except ValueError:
        return None
    return value if _SMALLEST_UNIT <= value <= 1 / _SMALLEST_UNIT else None


@contextmanager
def silence_logger(library: str) -> Iterator[None]:
    """Keep what a library logs about an untrusted file, such as tracebacks, from stderr."""
    logger, handler = logging.getLogger(library), logging.NullHandler()
    before = logger.propagate
    logger.addHandler(handler)
    logger.propagate = False
    try:
        yield
    finally:
        logger.propagate = before
        logger.removeHandler(handler)


@contextmanager
def refuse_half_read_numbers() -> Iterator[None]:
    """Let numpy raise a ValueError for numbers after which other text follows.

    Older versions, among them all for Python 3.10, only warn and return the numbers before that text.
    """

    def refuse(message: Warning | str, *_: object, **__: object) -> None:
        raise ValueError(str(message))

    with warnings.catch_warnings():
        warnings.filterwarnings("always", "string or file could not be read", DeprecationWarning)
        warnings.showwarning = refuse
        yield
