"""XML006 reports elements that occur twice where only one counts."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from urdfcheck.core import Finding, Location, Rule, Severity
from urdfcheck.core.text import join_names, truncate_text
from urdfcheck.model import Model
from urdfcheck.source.text.grammar import (
    CHILDREN,
    NUMERIC_ATTRIBUTES,
    get_known_attributes,
    guess_attribute,
    iter_urdf_elements,
    list_repeated_children,
)
from urdfcheck.source.text.tokens import build_removal_edits
from urdfcheck.source.text.values import parse_numbers
from urdfcheck.source.text.xml import Element
from urdfcheck.source.xacro.usage import find_typed, is_inserted

# MuJoCo ignores these, and does not reject two of them.
_UNSEEN_BY_MUJOCO = frozenset({"safety_controller", "calibration", "texture"})
_OF_SHAPES = (
    "delete what is left over; if all are meant, give each its own visual (or collision), with an origin that suits it"
)
_OF_PARTS = (
    "delete what is left over; if each is the mass of another part of the link, write one <inertial> for all of them, "
    "or give each part its own link at a fixed joint"
)
_CONDITIONS = frozenset({"xacro:if", "xacro:unless"})
# Longer values are not shown whole.
_LONGEST = 60
# What every program takes for an attribute that is left out.
_DEFAULTS: Mapping[str, Mapping[str, object]] = {"origin": {"xyz": (0.0, 0.0, 0.0), "rpy": (0.0, 0.0, 0.0)}}


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    repeated = [
        (element, same) for element in iter_urdf_elements(model.robot) for same in list_repeated_children(element)
    ]
    # What a macro types twice may be equal in one of its calls only.
    unequal = {_list_places(same) for _, same in repeated if not _are_equal(same)}
    for element, same in repeated:
        equal = _are_equal(same)
        if not equal or _list_places(same) not in unequal:
            yield _build_finding(model, rule, element, same=same, identical=equal)


def _are_equal(same: list[Element]) -> bool:
    content = _build_content_key(same[0])
    return all(_build_content_key(other) == content for other in same[1:])


def _list_places(same: list[Element]) -> tuple[object, ...]:
    """Return where the elements are typed, the same in all calls of a macro."""
    return tuple(one.span for one in same)


def _build_finding(model: Model, rule: Rule, element: Element, *, same: list[Element], identical: bool) -> Finding:
    first, second = same[0], same[1]
    is_rest_empty = not _is_empty(first) and all(map(_is_empty, same[1:]))
    message = "identical" if identical else "empty" if is_rest_empty else "repeated"
    message = "shapes" if element.tag == "geometry" and not identical else message
    is_rest_unread = message == "repeated" and not any(map(_is_read, same[1:]))
    message = "unread" if is_rest_unread else message
    # A shape that is lost is seen; of another place or colour the robot moves as it is meant.
    is_only_drawn = message == "repeated" and _is_in_visual(element)
    # urdfdom reads only the first: deleting the others changes nothing there. Of equal ones the innermost macro's is kept, for
    # other calls may have no other.
    kept = max(same, key=lambda one: len(one.via)) if identical else first
    removed = [one for one in same if one is not kept] if message == "empty" or identical else []
    inserted = [model.source.is_xacro and is_inserted(model.source.trees, element, one) for one in same]
    edits = [edit for other in removed for edit in build_removal_edits(other, model.source.files)]
    # A call must have its block, and what is typed once cannot lose one of two.
    is_certain = len(edits) == len(same) - 1 and not any(inserted) and len({one.span for one in same}) == len(same)
    places = [
        (_locate_insertion(model, element, one) if is_block else None) or one.location
        for one, is_block in zip(same, inserted, strict=True)
    ]
    return rule.finding(
        message,
        at=places[1],
        related=[*dict.fromkeys((places[0], first.location)), *places[2:10]],
        edits=edits if is_certain else (),
        severity=Severity.WARNING if removed or message == "unread" or is_only_drawn else None,
        consequences=None if message == "shapes" else {"mujoco": _describe_mujoco_behaviour(element, second)},
        parent=_describe_owner(element),
        tag=second.tag,
        first=_describe_first(first, is_inserted=inserted[0]),
        count="two" if len(same) == 2 else str(len(same)),
        listed=join_names(f"<{shape.tag}>" for shape in same),
        repair=_describe_repair(model, element, same),
    )


def _describe_repair(model: Model, element: Element, same: list[Element]) -> str:
    """Say which of the elements to keep; where only a condition is wrong, none is left over."""
    first, second = same[0], same[1]
    of_conditions = _describe_equal_conditions(model, same)
    if of_conditions:
        return of_conditions
    if element.tag == "geometry":
        return _OF_SHAPES
    if second.tag == "geometry":
        return f"delete what is left over; if both are meant, give each its own {element.tag}"
    if not _is_read(first):
        return f"delete the first <{second.tag}>: programs read nothing of what it holds"
    if _can_merge(same):
        return "merge them, for each has what the others lack, or delete what is left over"
    if second.tag == "inertial":
        return _OF_PARTS
    condition = ", or put it under the condition that it is meant for" if model.source.is_xacro else ""
    return f"delete the wrong <{second.tag}>{condition}"


def _describe_equal_conditions(model: Model, same: list[Element]) -> str:
    """Say to correct a condition where each of the elements is under its own and all say the same: one was to exclude another."""
    if not model.source.is_xacro:
        return ""
    typed = [find_typed(model.source.trees, one) for one in same]
    around = [None if one is None else one.parent for one in typed]
    conditions = [one for one in around if one is not None and one.tag in _CONDITIONS]
    said = {(one.tag, one.get("value")) for one in conditions}
    if len({one.span for one in conditions}) < len(same) or len(said) > 1:
        return ""
    shown = truncate_text(conditions[0].get("value"), _LONGEST)
    return f"correct the conditions: {'both' if len(same) == 2 else 'all'} are `{shown}`, so that none excludes another"


def _can_merge(same: list[Element]) -> bool:
    """Whether no two of the elements have the same attribute or a child of the same tag."""
    names = [name for one in same for name in (*one.attributes, *{child.tag for child in one.children})]
    return len(names) == len(set(names))


def _describe_first(first: Element, *, is_inserted: bool) -> str:
    """Describe the first of several elements: its values, and whether a call hands it over."""
    values = "" if first.children else " ".join(f'{a.name}="{a.value}"' for a in first.attributes.values())
    told = [truncate_text(values, _LONGEST)] if values else []
    told += ["a block that a call hands over"] if is_inserted else []
    return f" ({', '.join(told)})" if told else ""


def _locate_insertion(model: Model, parent: Element, inserted: Element) -> Location | None:
    """Return the place of the one ``<xacro:insert_block>`` in the parent of an inserted element: the block that a call hands
    over may be needed elsewhere."""
    typed = find_typed(model.source.trees, parent)
    insertions = [] if typed is None else [each for each in typed.walk() if each.tag == "xacro:insert_block"]
    return Location(inserted.subject, insertions[0].span, parent.via) if len(insertions) == 1 else None


def _is_read(element: Element) -> bool:
    """Whether an element has an attribute or a child that URDF parsers read in it, or a misspelt attribute (XML004)."""
    known = CHILDREN.get(element.tag, frozenset())
    held = any(child.tag in known for child in element.children)
    attributes = get_known_attributes(element.tag)
    return held or any(name in attributes or guess_attribute(element, name) for name in element.attributes)


def _is_in_visual(element: Element) -> bool:
    return element.tag == "visual" or (element.parent is not None and _is_in_visual(element.parent))


def _is_empty(element: Element) -> bool:
    return not (element.attributes or element.children or element.text.strip())


def _describe_mujoco_behaviour(element: Element, second: Element) -> str:
    if second.tag in _UNSEEN_BY_MUJOCO:
        return "ignores all of them"
    is_drawn = element.tag == "geometry" and element.parent is not None and element.parent.tag == "visual"
    if is_drawn or (element.tag == "visual" and second.tag != "material"):
        return 'ignores visuals; with discardvisual="false" it refuses the file'
    return "refuses the file (repeated element)"


def _build_content_key(element: Element) -> tuple[object, ...]:
    """Return the contents of an element in comparable form: `.1` is 0.1, and an origin without `rpy` turns nothing."""
    sizes = NUMERIC_ATTRIBUTES.get(element.tag, {})
    values = dict(_DEFAULTS.get(element.tag, {}))
    for name, attribute in element.attributes.items():
        words = " ".join(attribute.value.split())
        values[name] = (parse_numbers(words, sizes[name]) or words) if name in sizes else words
    return element.tag, frozenset(values.items()), tuple(_build_content_key(child) for child in element.children)


def _describe_owner(element: Element) -> str:
    """Return ``joint hinge``, or ``visual of link arm``."""
    parts: list[Element] = [element]
    while parts[-1].parent is not None and parts[-1].parent.tag != "robot":
        parts.append(parts[-1].parent)
    return _join_part_names([parts[0], *parts[-1:]] if len(parts) > 1 else parts)


def _join_part_names(parts: Iterable[Element]) -> str:
    return " of ".join(f"{part.tag} {part.get('name')}".strip() for part in parts)
