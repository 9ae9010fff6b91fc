"""What urdfdom and the engines do with elements that they cannot read, and with meshes that they cannot open."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from urdfcheck.source.text.grammar import CHILDREN
from urdfcheck.source.text.xml import Element


def describe_loss(element: Element) -> str:
    """Describe what urdfdom does with an element that it cannot read (checked with urdfdom 6).

    It stops reading a link at the first part that fails: inertial, then visuals, then collisions.
    """
    if element.tag in {"color", "texture"}:
        return "ignores the colour"
    while element.parent is not None and element.parent.tag not in {"robot", "link"}:
        element = element.parent
    return {
        "inertial": "drops the inertial, and with it every visual and collision of the link",
        "visual": "drops every visual and collision of the link",
        "collision": "drops every collision of the link",
        "material": "ignores the material",
    }.get(element.tag, "refuses the whole file")


# Elements that engines with their own parsers load without required attributes, found by leaving them out one by one.
_LENIENT_TAGS: Mapping[str, frozenset[str]] = {
    "mujoco": frozenset({"limit", "material", "safety_controller"}),
    "drake": frozenset({"mass", "inertia", "limit", "material", "axis", "safety_controller"}),
    "bullet": frozenset({"limit", "mimic", "color", "axis", "safety_controller"}),
}


def describe_engine_reactions(element: Element, names: Iterable[str]) -> dict[str, str]:
    """Describe what MuJoCo, Drake and Bullet do with an element that lacks these required attributes."""
    parts = [element]
    while parts[-1].parent is not None:
        parts.append(parts[-1].parent)
    lenient = {engine for engine, tags in _LENIENT_TAGS.items() if element.tag in tags}
    if element.tag in CHILDREN["geometry"] and any(part.tag == "visual" for part in parts):
        lenient.add("mujoco")  # it does not read them
    if element.tag == "inertia" and not {"ixx", "iyy", "izz"} & set(names):
        lenient.add("bullet")
    return {engine: "loads it with a default" if engine in lenient else "refuses the file" for engine in _LENIENT_TAGS}


# Elements whose numbers Drake does not read, and those that MuJoCo does not load without theirs, a shape that collides aside.
_UNREAD_BY_DRAKE = frozenset({"calibration", "safety_controller"})
_UNREAD_ATTRIBUTES_BY_DRAKE = frozenset({"quat_xyzw", "acceleration", "deceleration", "jerk"})
_NEEDED_BY_MUJOCO = frozenset({"mass", "inertia", "color", "axis"})


def describe_empty_number(element: Element, name: str) -> dict[str, str]:
    """Describe what engines do with an empty attribute where a number is expected.

    Checked with MuJoCo 4.0, Drake 1.51 and PyBullet 3.2.7, one attribute after the other.
    """
    is_shape = element.tag in CHILDREN["geometry"] and name != "scale"
    needed = element.tag in _NEEDED_BY_MUJOCO or (is_shape and is_collision_part(element))
    unread = element.tag in _UNREAD_BY_DRAKE or name in _UNREAD_ATTRIBUTES_BY_DRAKE
    return {
        "mujoco": "refuses the file" if needed else "loads it with a default",
        "drake": "loads it: it does not read this attribute" if unread else "refuses the file",
        "bullet": "refuses the file" if element.tag == "axis" else "reads it as zero",
    }


# What yourdfpy 0.0.60 keeps as text or does not read. It separates the numbers of the last two also by commas.
_UNREAD_BY_YOURDFPY = frozenset({"dynamics", "hardwareInterface", "mechanicalReduction"})
_UNREAD_ATTRIBUTES_BY_YOURDFPY = frozenset({"quat_xyzw", "acceleration", "deceleration", "jerk"})
_COMMAS_FOR_YOURDFPY = frozenset({"size", "scale"})


def describe_number_in_python(element: Element, name: str, text: str) -> dict[str, str]:
    """Describe what yourdfpy, which reads numbers by Python's ``float``, does with a text that is not a number of URDF."""
    if element.tag in _UNREAD_BY_YOURDFPY or name in _UNREAD_ATTRIBUTES_BY_YOURDFPY:
        return {"yourdfpy": "loads it: it does not read this number"}
    words = (text.replace(",", " ") if name in _COMMAS_FOR_YOURDFPY else text).split()
    if not words and name == "scale":
        return {"yourdfpy": "loads it without a scale"}
    if not words and (name == "rgba" or (name == "size" and is_collision_part(element))):
        return {"yourdfpy": "loads it: nothing uses this number"}
    try:
        list(map(float, words or ("",)))
    except ValueError:
        return {"yourdfpy": "refuses the file"}
    return {"yourdfpy": "loads it"}


def describe_gap_in_yourdfpy(element: Element, missing: Iterable[str]) -> dict[str, str]:
    """Describe what yourdfpy does without a required attribute or child (checked with 0.0.60)."""
    if element.tag == "inertia":
        return {"yourdfpy": "replaces a missing moment by 1 and a missing product by 0"}
    if element.tag == "mimic":
        return {"yourdfpy": "replaces the leader's position by 0"}
    if element.tag in {
        "mass",
        "limit",
        "axis",
        "material",
        "color",
        "texture",
        "safety_controller",
        "dynamics",
        "inertial",
    }:
        return {"yourdfpy": "loads it with a default"}
    if element.tag == "mesh" and is_collision_part(element):
        return {"yourdfpy": "loads it: it does not load the meshes of collisions unless it is told to"}
    return {"yourdfpy": "refuses the file"} if list(missing) else {}


def is_collision_part(element: Element) -> bool:
    """Whether an element is part of a ``<collision>``."""
    inner: Element | None = element
    while inner is not None and inner.tag != "collision":
        inner = inner.parent
    return inner is not None


def describe_missing_mesh(parts: Iterable[Element]) -> dict[str, str]:
    """Describe what MuJoCo and yourdfpy do with meshes that they cannot open (checked with MuJoCo 4.0 and yourdfpy 0.0.60).

    MuJoCo opens those of visuals only where the file's ``<mujoco><compiler discardvisual="false"/></mujoco>`` asks for them.
    """
    shapes = list(parts)
    opened = any(is_collision_part(part) or _keeps_visuals(part) for part in shapes)
    drawn = not all(map(is_collision_part, shapes))
    return {
        "mujoco": "refuses to compile" if opened else "loads it without shapes that are only drawn",
        "yourdfpy": "drops the visual, with a warning" if drawn else "loads it: it does not open meshes of collisions",
    }


def describe_unread_visuals(parts: Iterable[Element]) -> dict[str, str]:
    """Describe what MoveIt loses with the meshes of shapes: nothing where all of them are only drawn."""
    return {} if any(map(is_collision_part, parts)) else {"moveit": "loads it: it loads no visual mesh"}


def name_lost_shapes(parts: Iterable[Element]) -> str:
    """Say what a simulator lacks without the meshes of shapes that are drawn, that collide, or both."""
    roles = {True: "no contact", False: "no visual"}
    return ", ".join(roles[collides] for collides in sorted(set(map(is_collision_part, parts))))


def _keeps_visuals(element: Element) -> bool:
    """Whether the file of an element tells MuJoCo to keep what is only drawn."""
    root = element
    while root.parent is not None:
        root = root.parent
    return has_mujoco_option(root, "discardvisual", "false")


def has_mujoco_option(robot: Element, name: str, value: str) -> bool:
    """Whether the ``<mujoco><compiler>`` elements of a ``<robot>`` give an option this value."""
    return read_mujoco_options(robot).get(name) == value


def read_mujoco_options(robot: Element) -> dict[str, str]:
    """Return the options in the ``<mujoco><compiler>`` elements of a ``<robot>``."""
    compilers = [c for section in robot.find_children("mujoco") for c in section.find_children("compiler")]
    return {name: option.value for compiler in compilers for name, option in compiler.attributes.items()}


def describe_unreadable_mesh(parts: Iterable[Element]) -> dict[str, str]:
    """Describe what MuJoCo and Drake do with mesh files that exist but cannot be read (checked with MuJoCo 4.0, Drake 1.51)."""
    shapes = list(parts)
    collides = any(map(is_collision_part, shapes))
    drake = "refuses the model when contacts are looked for" if collides else "loads it without drawing the shape"
    return {"mujoco": describe_missing_mesh(shapes)["mujoco"], "drake": drake}
