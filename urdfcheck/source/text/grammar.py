"""The grammar of URDF as its reference parser reads it: which elements each element holds, and which attributes are numbers."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterator, Mapping
from functools import lru_cache

from urdfcheck.source.text.remembered import tree_fact
from urdfcheck.source.text.xml import Element

# The elements that urdfdom reads inside each element (URDF 1.0 to 1.2). A tag means the same wherever it is allowed.
CHILDREN: Mapping[str, frozenset[str]] = {
    "robot": frozenset({"link", "joint", "material"}),
    "link": frozenset({"inertial", "visual", "collision"}),
    "inertial": frozenset({"origin", "mass", "inertia"}),
    "visual": frozenset({"origin", "geometry", "material"}),
    "collision": frozenset({"origin", "geometry"}),
    "geometry": frozenset({"box", "cylinder", "sphere", "mesh", "capsule"}),
    "material": frozenset({"color", "texture"}),
    "joint": frozenset(
        {"origin", "parent", "child", "axis", "calibration", "dynamics", "limit", "mimic", "safety_controller"}
    ),
}

# How many numbers each numeric attribute holds.
NUMERIC_ATTRIBUTES: Mapping[str, Mapping[str, int]] = {
    "origin": {"xyz": 3, "rpy": 3, "quat_xyzw": 4},
    "mass": {"value": 1},
    "inertia": {"ixx": 1, "ixy": 1, "ixz": 1, "iyy": 1, "iyz": 1, "izz": 1},
    "box": {"size": 3},
    "cylinder": {"radius": 1, "length": 1},
    "capsule": {"radius": 1, "length": 1},
    "sphere": {"radius": 1},
    "mesh": {"scale": 3},
    "color": {"rgba": 4},
    "axis": {"xyz": 3},
    "limit": {"lower": 1, "upper": 1, "effort": 1, "velocity": 1, "acceleration": 1, "deceleration": 1, "jerk": 1},
    "dynamics": {"damping": 1, "friction": 1},
    "mimic": {"multiplier": 1, "offset": 1},
    "safety_controller": {"soft_lower_limit": 1, "soft_upper_limit": 1, "k_position": 1, "k_velocity": 1},
    "calibration": {"rising": 1, "falling": 1},
}

# Attributes that do not hold numbers. A name is a label that any element may carry, whether or not a program reads it.
TEXT_ATTRIBUTES: Mapping[str, frozenset[str]] = {
    "robot": frozenset({"name", "version"}),
    "link": frozenset({"name"}),
    "joint": frozenset({"name", "type", "dont_collapse"}),  # Isaac Gym keeps a fixed joint that has it
    "parent": frozenset({"link"}),
    "child": frozenset({"link"}),
    "mimic": frozenset({"joint"}),
    "mesh": frozenset({"filename"}),
    "texture": frozenset({"filename"}),
    "visual": frozenset({"name"}),
    "collision": frozenset({"name"}),
    "material": frozenset({"name"}),
}
# ``${side}`` without its dollar sign, or what a script did not fill in; with the dollar sign it is XML that nothing has expanded.
UNFILLED = re.compile(r"(?<!\$)\{[^{}]*\}")
# What xacro replaces: an expression, and the commands of xacro and roslaunch.
SUBSTITUTION = re.compile(r"\$\{[^}]*\}?|\$\(\s*(?:anon|arg|cwd|dirname|env|eval|find|optenv)(?![\w-])[^)]*\)?")
JOINT_TYPES = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar")
# An element may have several of these children.
_REPEATABLE = frozenset({"link", "joint", "visual", "collision"})
# Without these, the reference parser rejects the element.
REQUIRED_ATTRIBUTES: Mapping[str, tuple[str, ...]] = {
    "robot": ("name",),
    "link": ("name",),
    "joint": ("name", "type"),
    "parent": ("link",),
    "child": ("link",),
    "mass": ("value",),
    "inertia": tuple(NUMERIC_ATTRIBUTES["inertia"]),
    "mesh": ("filename",),
    "box": ("size",),
    "cylinder": ("radius", "length"),
    "capsule": ("radius", "length"),
    "sphere": ("radius",),
    "limit": ("effort", "velocity"),
    "safety_controller": ("k_velocity",),
    "mimic": ("joint",),
    "material": ("name",),
    "color": ("rgba",),
    "axis": ("xyz",),
}
# As urdfdom converts the two numbers: it reads 01.00 as 1.0, and rejects "1.0 ".
_VERSION = re.compile(r"\s*\+?(\d{1,9})\.\s*\+?(\d{1,9})", re.ASCII)
# Names of the same attribute in other formats and other elements.
_SYNONYMS: Mapping[str, str] = {
    "file": "filename",
    "uri": "filename",
    "url": "filename",
    "height": "length",
    "min": "lower",
    "max": "upper",
}
_MIN_SIMILARITY = 0.75
_LONGEST_COMPARED = 40
# <joint_properties damping= friction=> was the name of <dynamics> before URDF 1.0.
_RENAMED = {"joint_properties": "dynamics", "colour": "color"}


def parse_urdf_version(robot: Element) -> tuple[int, int] | None:
    """Return the version that a robot declares (default 1.0); None if urdfdom does not read this version."""
    parts = _VERSION.fullmatch(robot.get("version", "1.0"))
    version = None if parts is None else (int(parts[1]), int(parts[2]))
    return version if version in {(1, 0), (1, 1), (1, 2)} else None


def get_known_attributes(tag: str) -> frozenset[str]:
    """Return the attributes of an element that the reference parser reads."""
    return TEXT_ATTRIBUTES.get(tag, frozenset()) | frozenset(NUMERIC_ATTRIBUTES.get(tag, ()))


def guess_attribute(element: Element, name: str) -> str | None:
    """Return the attribute that an unknown one probably means; None if there is none, or the element has it too."""
    near = _find_nearest_attribute(element.tag, name)
    return None if near in element.attributes else near


@lru_cache(maxsize=4096)
def _find_nearest_attribute(tag: str, name: str) -> str | None:
    known = sorted(get_known_attributes(tag))
    if len(name) > _LONGEST_COMPARED or name in known or ":" in name:
        return None
    lower = name.lower()
    # difflib misses xzy for xyz: too few of its letters are in the same order.
    same = [k for k in known if _SYNONYMS.get(lower) == k or sorted(k) == sorted(lower)]
    close = same or difflib.get_close_matches(lower, known, n=1, cutoff=_MIN_SIMILARITY)
    return close[0] if close else None


def is_attribute_missing(element: Element, name: str) -> bool:
    """Whether an attribute is missing and not just misspelt, which is reported as the cause by another rule."""
    return name not in element.attributes and all(
        guess_attribute(element, other) != name for other in element.attributes
    )


def list_attributes_as_children(element: Element) -> list[Element]:
    """Return the children of an element that have the name of a number which it holds as an attribute, as in SDF."""
    return [child for child in element.children if child.tag in NUMERIC_ATTRIBUTES.get(element.tag, {})]


def iter_urdf_elements(robot: Element) -> Iterator[Element]:
    """Yield the elements of a robot that the reference parser reads, in document order; extensions are left out."""
    return iter(_list_urdf_elements(robot))


@tree_fact
def _list_urdf_elements(robot: Element) -> list[Element]:
    found = []
    stack = [robot]
    while stack:
        element = stack.pop()
        found.append(element)
        if element.children:
            allowed = CHILDREN.get(element.tag, frozenset())
            stack += [child for child in reversed(element.children) if child.tag in allowed]
    return found


def list_single_tags(element: Element) -> frozenset[str]:
    """Return the tags of which an element may have one child."""
    return frozenset() if element.tag == "robot" else CHILDREN.get(element.tag, frozenset()) - _REPEATABLE


def list_repeated_children(element: Element) -> list[list[Element]]:
    """Return the groups of children of which only one is allowed: children with one tag, or all shapes of a geometry."""
    if len(element.children) < 2:
        return []
    groups: dict[str, list[Element]] = {}
    allowed = list_single_tags(element)
    for child in element.children:
        if child.tag in allowed:
            groups.setdefault("shape" if element.tag == "geometry" else child.tag, []).append(child)
    return [group for group in groups.values() if len(group) > 1]


def iter_first_elements(robot: Element) -> Iterator[Element]:
    """Yield the elements of :func:`iter_urdf_elements` without repetitions, of which programs read the first or refuse the file.

    Of several shapes in one geometry all are yielded: programs choose differently.
    """
    return iter(_list_first_elements(robot))


@tree_fact
def _list_first_elements(robot: Element) -> list[Element]:
    found = []
    unread: set[int] = set()
    for element in iter_urdf_elements(robot):
        if id(element) in unread:
            unread.update(map(id, element.children))
            continue
        if element.tag != "geometry":
            unread.update(id(other) for group in list_repeated_children(element) for other in group[1:])
        found.append(element)
    return found


def guess_element_tag(parent: str, child: Element) -> str | None:
    """Return the element that an unknown child of this parent probably means."""
    allowed = sorted(CHILDREN.get(parent, frozenset()))
    if _RENAMED.get(child.tag) in allowed:
        return _RENAMED[child.tag]
    if len(child.tag) > _LONGEST_COMPARED:
        return None
    close = difflib.get_close_matches(child.tag.lower(), allowed, n=1, cutoff=_MIN_SIMILARITY)
    if not close:
        return None
    # <inertia ixx=…> in a link is not a misspelt <inertial>: its content belongs to <inertia>.
    expected = CHILDREN.get(child.tag) or frozenset(NUMERIC_ATTRIBUTES.get(child.tag, ()))
    content = {c.tag for c in child.children} | set(child.attributes)
    return None if expected & content or _has_other_content(child, close[0]) else close[0]


def _has_other_content(element: Element, tag: str) -> bool:
    """Whether an element has attributes, and nothing that a ``tag`` holds: it is something else, such as the call of a macro."""
    known, own = get_known_attributes(tag), element.attributes.keys() - {"name"}
    if not known or not own or any(child.tag in CHILDREN.get(tag, ()) for child in element.children):
        return False
    return all(name not in known and _find_nearest_attribute(tag, name) is None for name in own)


def iter_misspelt_contents(robot: Element) -> Iterator[tuple[Element, Element]]:
    """Yield each element whose tag is misspelt with the elements in it that the parser would read if it were not."""
    for parent in iter_urdf_elements(robot):
        allowed = CHILDREN.get(parent.tag, frozenset())
        for child in parent.children:
            near = None if child.tag in allowed or ":" in child.tag else guess_element_tag(parent.tag, child)
            if near is not None:
                known = (inner for inner in child.children if inner.tag in CHILDREN.get(near, frozenset()))
                yield from ((child, element) for inner in known for element in iter_urdf_elements(inner))


def is_unexpanded(text: str) -> bool:
    """Whether a value still contains a substitution of xacro; another ``$(name)`` is the author's own placeholder."""
    return "$" in text and SUBSTITUTION.search(text) is not None
