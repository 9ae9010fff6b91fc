"""What a xacro file makes, by its tags as typed: parts of a robot, or only macros for other files."""

from __future__ import annotations

from urdfcheck.source.text.xml import Element, find_unbound_prefix

# Of all tags with xacro's prefix, those that do not call a macro by their own name.
BUILT_IN_TAGS = frozenset(
    {"macro", "property", "include", "arg", "if", "unless", "insert_block", "attribute", "element", "call"}
)
# Of these, the ones that add nothing to the robot outside of a macro.
_SILENT_TAGS = frozenset(f"xacro:{name}" for name in BUILT_IN_TAGS - {"element", "call"})


def has_only_macros(root: Element | None) -> bool:
    """Whether a xacro file only defines macros and properties. A file that xacro cannot read defines nothing."""
    if root is None or has_parts(root) or find_unbound_prefix(root) is not None:
        return False
    return not any(element.tag == "xacro:include" for element in root.walk())


def has_parts(root: Element | None) -> bool:
    """Whether a xacro file makes links or joints, or calls a macro, outside of its macro definitions."""
    return root is None or any(_makes_parts(child) for child in root.children)


def can_stand_alone(root: Element | None) -> bool:
    """Whether a xacro file that others include can be a model too: it makes parts, and its robot has a name."""
    return root is None or (has_parts(root) and bool(root.get("name")))


def _makes_parts(element: Element) -> bool:
    if element.tag in {"xacro:if", "xacro:unless"}:
        return any(_makes_parts(child) for child in element.children)
    if element.tag in {"link", "joint"}:
        return True
    return element.tag.startswith("xacro:") and element.tag not in _SILENT_TAGS
