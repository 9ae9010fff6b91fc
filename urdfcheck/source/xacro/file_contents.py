"""What a xacro file makes, by its tags as typed: parts of a robot, or only macros for other files."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.source.text.xml import Element, find_unbound_prefix

# Of all tags with xacro's prefix, those that do not call a macro by their own name.
BUILT_IN_TAGS = frozenset(
    {"macro", "property", "include", "arg", "if", "unless", "insert_block", "attribute", "element", "call"}
)
# Of these, the ones that add no element to the robot outside of a macro. A property may hold the links that
# <xacro:insert_block> inserts.
_SILENT_TAGS = frozenset(f"xacro:{name}" for name in BUILT_IN_TAGS - {"element", "call", "insert_block"})


def has_only_macros(root: Element | None) -> bool:
    """Whether a xacro file only defines macros and properties. A file that xacro cannot read defines nothing."""
    if root is None or has_parts(root) or find_unbound_prefix(root) is not None:
        return False
    return not any(map(is_include, root.walk()))


def is_include(element: Element) -> bool:
    """Whether an element includes a file, also without the prefix, which its author has forgotten (XAC007)."""
    return element.tag == "xacro:include" or (element.tag == "include" and "filename" in element.attributes)


def has_parts(root: Element | None) -> bool:
    """Whether a xacro file makes links or joints, or calls a macro, outside its macro definitions."""
    return root is None or any(_makes_parts(child) for child in _iter_top_level(root))


def defines_macros(root: Element | None) -> bool:
    """Whether a xacro file defines a macro."""
    return root is not None and any(element.tag == "xacro:macro" for element in root.walk())


def can_stand_alone(root: Element | None) -> bool:
    """Whether a xacro file that others include can be a model too: its robot may have a name, and more than macros."""
    return root is None or (can_have_name(root) and not has_only_macros(root))


def can_have_name(root: Element) -> bool:
    """Whether a robot has a name, or xacro may give it one."""
    return "name" in root.attributes or any(element.tag == "xacro:attribute" for element in _iter_top_level(root))


def _makes_parts(element: Element) -> bool:
    return element.tag in {"link", "joint"} or (element.tag.startswith("xacro:") and element.tag not in _SILENT_TAGS)


def may_make_links(element: Element) -> bool:
    """Whether an element is a link, in any spelling, or stands for elements from elsewhere: an include or a call."""
    is_call = element.tag.startswith("xacro:") and element.tag not in _SILENT_TAGS
    return (element.tag.lower() == "link" and _is_top(element)) or is_call or is_include(element)


def hangs_on_another(root: Element | None) -> bool:
    """Whether a joint of a file names a link, as typed, that the file lacks, and no include or macro brings it."""
    elements = [] if root is None else list(root.walk())
    links = {element.get("name") for element in elements if element.tag == "link"}
    ends = {element.get("link") for element in elements if element.tag in {"parent", "child"}}
    is_spelled_out = all(element.tag == "link" for element in elements if may_make_links(element))
    return is_spelled_out and bool(ends - links)


def _is_top(element: Element) -> bool:
    return element.parent is None or element.parent.tag == "robot" or element.parent.tag.startswith("xacro:")


def _iter_top_level(root: Element) -> Iterator[Element]:
    """Yield the elements of the robot itself, also those under a condition."""
    stack = list(reversed(root.children))
    while stack:
        element = stack.pop()
        if element.tag in {"xacro:if", "xacro:unless"}:
            stack.extend(reversed(element.children))
        else:
            yield element


def has_links(root: Element | None) -> bool:
    """Whether links of the robot itself are typed in a file, as they are in no semantic description."""
    return root is not None and any(element.tag == "link" for element in _iter_top_level(root))
