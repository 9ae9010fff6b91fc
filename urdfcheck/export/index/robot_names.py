"""Where the names of a robot's links, joints and materials are defined and used, in the files that it is made of."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping

from urdfcheck.export.index.source_index import JOINT, LINK, MATERIAL, NamePlace
from urdfcheck.source.load import Source
from urdfcheck.source.text.handed_values import find_handed_text, find_typed_value
from urdfcheck.source.text.tokens import find_content_span
from urdfcheck.source.text.xml import Attribute, Element

# The names of links and of joints.
PartNames = Mapping[str, set[str]]

# The attributes that name a link or joint elsewhere.
_REFERENCES = {
    ("parent", "link"): LINK,
    ("child", "link"): LINK,
    ("mimic", "joint"): JOINT,
}
# Elements around a joint or link that is only named there.
_NAMING = frozenset({"transmission", "ros2_control"})
# Elements of plugins and sensors whose text names a link or joint: `<bodyName>`, `<left_joint>`, `<frame_id>`, `<child>`.
_NAMING_TEXT = re.compile(r"link|joint|frame|body|wheel|^(?:parent|child)$", re.IGNORECASE)
_JOINT_TEXT = re.compile("joint", re.IGNORECASE)


def collect_part_names(root: Element) -> PartNames:
    """Return the names of the links and joints of a robot."""
    return {kind: {element.get("name") for element in root.find_children(kind)} for kind in (LINK, JOINT)}


def iter_robot_names(source: Source) -> Iterator[NamePlace]:
    """Yield the places of links, joints and materials.

    Those of the expanded robot first, then what is typed literally in files, also where no robot is made of it.
    """
    root = source.root if source.root is not None and source.root.tag == "robot" else source.main_tree
    if root is None:
        return
    names = collect_part_names(root)
    seen = set()
    for place in _iter_expanded_names(root, names, source):
        seen.add((place.span.file, place.span.start))
        yield place
    for tree in source.trees.values() if source.is_xacro else ():
        for element in tree.walk():
            for attribute in element.attributes.values():
                kind, _ = classify_name(element, attribute, names)
                if not kind or not attribute.literal or not attribute.value or attribute.span is None:
                    continue
                if (attribute.span.file, attribute.span.start) not in seen:
                    yield NamePlace(kind, attribute.value, attribute.span, False)


def _iter_expanded_names(root: Element, names: PartNames, source: Source) -> Iterator[NamePlace]:
    for element in root.walk():
        for attribute in element.attributes.values():
            kind, is_definition = classify_name(element, attribute, names)
            if not kind or attribute.span is None or not attribute.value or "$" in attribute.value:
                continue
            typed = (
                None if attribute.literal else find_typed_value(attribute) or find_handed_text(attribute, source.files)
            )
            if typed is None:
                yield NamePlace(kind, attribute.value, attribute.span, is_definition)
            else:
                yield NamePlace(kind, attribute.value, attribute.span, is_definition, is_handed=True)
                yield NamePlace(kind, attribute.value, typed.span, False)
        kind = classify_text(element, names)
        place = find_content_span(element, source.files) if kind else None
        if place is not None:
            yield NamePlace(kind, element.text.strip(), place, False)


def classify_name(element: Element, attribute: Attribute, names: PartNames) -> tuple[str, bool]:
    """Return what an attribute names (link, joint or material), and whether it defines that; an empty text for all others.

    ``names``: those of the robot. In a file as typed, what a macro or a condition holds counts as if it stood around it.
    """
    tag, name = element.tag, attribute.name
    if (tag, name) in _REFERENCES:
        return _REFERENCES[tag, name], False
    if tag == "gazebo" and name == "reference":
        return next((kind for kind, known in names.items() if attribute.value in known), ""), False
    parent = element.parent
    while parent is not None and parent.tag.startswith("xacro:"):
        parent = parent.parent
    if name != "name" or parent is None:
        return "", False
    if tag == MATERIAL:
        return MATERIAL, bool(element.children)
    if tag in names:
        if parent.tag == "robot":
            return tag, True
        if parent.tag in _NAMING:
            return tag, False
    return "", False


def classify_text(element: Element, names: PartNames) -> str:
    """Return what the text of an element names: in a plugin or a sensor, whose elements say so; empty for all others."""
    text = element.text.strip()
    if not text or element.children or not _NAMING_TEXT.search(element.tag):
        return ""
    kinds = [kind for kind, known in names.items() if text in known]
    if len(kinds) > 1:
        return JOINT if _JOINT_TEXT.search(element.tag) else LINK
    return kinds[0] if kinds else ""
