"""XML003 reports elements where no parser reads them."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from urdfcheck.core import Edit, Finding, Rule, Severity
from urdfcheck.core.text import format_repetition, join_names
from urdfcheck.model import Model
from urdfcheck.model.ground.drive_plugins import list_drive_plugins
from urdfcheck.source.text.engine_reactions import is_collision_part
from urdfcheck.source.text.grammar import CHILDREN, NUMERIC_ATTRIBUTES, guess_element_tag, iter_urdf_elements
from urdfcheck.source.text.tokens import build_rename_edits
from urdfcheck.source.text.values import parse_number
from urdfcheck.source.text.xml import Element
from urdfcheck.source.uses_elsewhere import is_kept_unused
from urdfcheck.source.xacro.usage import find_typed, find_unprefixed_tags

# Elements that a program other than urdfdom reads here, and extensions with their own names.
_EXTENSIONS: dict[str, frozenset[str]] = {
    "robot": frozenset(
        {
            "transmission",
            "gazebo",
            "ros2_control",
            "sensor",
            "mujoco",
            "loop_joint",
            "self_collision",
            "self_collision_checking",
            "group",
            "virtual_joint",
            "disable_collisions",
            "end_effector",
            "cad",
            "version",
            "author",
        }
    ),
    # contact, audio_source: Bullet; collision_checking: Pinocchio; sensor: URDF 1.0 on the wiki
    "link": frozenset(
        ["contact", "audio_source", "collision_checking", "self_collision_checking", "sensor", "verbose"]
    ),
    "visual": frozenset({"verbose"}),
    "collision": frozenset({"verbose", "material", "contact_coefficients"}),
    "material": frozenset({"specular"}),  # Bullet
    "geometry": frozenset({"plane", "cdf"}),  # Bullet
}
# Elements of a link, a collision or a joint in SDF; in a URDF they have an effect only inside <gazebo>.
_SDF = frozenset({
    "gravity", "kinematic", "self_collide", "surface", "enable_wind", "velocity_decay", "must_be_base_link",
    "laser_retro", "max_contacts", "selfCollide", "turnGravityOff", "dampingFactor", "maxContacts", "mu1", "mu2",
    "kp", "kd", "minDepth", "maxVel", "fdir1", "implicitSpringDamper", "provideFeedback", "stopCfm", "stopErp",
    "fudgeFactor", "plugin", "pose", "static",
})  # fmt: skip
# Those of a shape: sdformat hands them to it only inside <collision> or <visual>.
_SDF_OF_SHAPES = frozenset({"surface", "max_contacts", "laser_retro"})
# What sdformat reads directly in <gazebo>: parts of a surface that have other names there than in SDF, and all of them.
_URDF_OF_CONTACTS = frozenset({"mu1", "minDepth", "maxVel"})
_OF_CONTACTS = frozenset({*_URDF_OF_CONTACTS, "mu2", "fdir1", "kp", "kd"})
# Their names in SDF where those differ.
_NAMES_IN_BLOCK = {"mu": "mu1", "min_depth": "minDepth", "max_vel": "maxVel"}
# The elements of a surface that hold others, those around what an engine reads, and where some are read.
_SURFACE = frozenset({"surface", "friction", "contact", "bounce", "ode", "bullet", "torsional"})
_ENGINES = frozenset({"ode", "bullet"})
_HOMES_IN_SURFACE = {
    **dict.fromkeys(("soft_cfm", "soft_erp"), "<contact><ode>"),
    **dict.fromkeys(("slip1", "slip2"), "<friction><ode>"),
    **dict.fromkeys(("restitution_coefficient", "threshold"), "<bounce>"),
}
# What holds the friction of a shape in SDF.
_FRICTION = frozenset({"surface", "friction", "ode"})
# Those of a whole model: sdformat hands them to it only from a <gazebo> without a reference.
_SDF_OF_MODELS = {
    "plugin": "move it into a `<gazebo>` without reference, or delete it; the plugin of a sensor belongs inside its <sensor>",
    "static": "move it into a `<gazebo>` without reference: it is about the whole model; delete it if that is to move",
}
# Those that are true or false: one that holds its default says nothing.
_SWITCHES = frozenset({"gravity", "kinematic", "self_collide", "selfCollide", "turnGravityOff", "enable_wind"})
# The texts of SDF that are nearly all defaults, besides that of gravity.
_DEFAULT_TEXTS = frozenset({"", "0", "false"})
_GRAVITY_TEXTS = frozenset({"", "1", "true"})
# XAC007 reports xacro without its prefix.
_XACRO = frozenset(["macro", "property", "include", "arg", "if", "unless", "insert_block"])

# The elements that a parent holds any number of.
_REPEATED = {"robot": CHILDREN["robot"], "link": frozenset({"visual", "collision"})}
# The parts of a joint that a fixed one does not use.
_OF_MOVING_JOINTS = frozenset({"axis", "calibration", "dynamics", "limit", "mimic", "safety_controller"})
# Those that name other elements: a link needs none.
_NAMING = frozenset({"parent", "child"})
# The limits that a continuous joint does not have.
_POSITIONS = frozenset({"lower", "upper"})
_WITHOUT_USE = {"fixed": "the joint is fixed", "continuous": "a continuous joint has no limits of its position"}
# What urdfdom refuses a limit without.
_LIMITED = ("effort", "velocity")
# What is typed twice, rounded, is one number: a share, chosen.
_SAME = 0.03
_AGREE = {False: "has its", True: "have their"}
RENAMING = "write `<{near}>`, also in the end tag"
MERGING = "write a single `<{near}>` where a <{parent}> has the element twice"
_CALL = "; if it calls a macro of xacro, define the macro and write `xacro:` before the name"
DELETION = "delete it: <{parent}> already has a <{near}>"
# No program has read the element: where it is read, the robot is another one.
_UNLESS_RIGHT = ", or delete it"


# So many different values of one attribute are listed.
_MOST_VALUES = 3


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    unknown: dict[tuple[str, str], list[Element]] = {}
    for parent in iter_urdf_elements(model.robot):
        for child in parent.children:
            if _is_unknown_element(parent.tag, child):
                unknown.setdefault((parent.tag, child.tag), []).append(child)
    is_aside = is_kept_unused(model.source)  # no program loads it
    for (parent_tag, tag), places in _leave_out_calls(model, unknown).items():
        verdict = _classify_element(parent_tag, places, model)
        if verdict is None:
            continue
        message, severity, data = verdict
        if message in {"misspelt", "misplaced", "pose"} and all(map(_holds_zeros, places)):
            severity = Severity.INFO
        if message == "sdf" and all(map(_holds_sdf_defaults, places)):
            severity = Severity.INFO
        if parent_tag == "geometry" and any(map(_is_in_place_of_shape, places)):
            severity = Severity.ERROR  # the shape is lost with it, even if it is empty
        elif severity is Severity.ERROR:
            severity = Severity.WARNING
        meant = data["near"] if message == "misspelt" else tag if message == "misplaced" else ""
        if meant in _OF_MOVING_JOINTS:
            places.sort(key=lambda place: _is_unused(place, meant))  # what another joint loses comes first
            if all(_is_unused(place, meant) or _holds_zeros(place) for place in places):
                severity = Severity.INFO
            if message == "misplaced" and all(_is_unused(place, meant) for place in places):
                data["repair"] = f"delete it: {_WITHOUT_USE[_get_joint_type(places[0])]}"
        if severity is Severity.WARNING and is_aside:
            severity = Severity.INFO
        edits: tuple[Edit, ...] = ()
        if message == "misspelt":
            data["repair"], edits = _describe_renaming(parent_tag, data["near"], places, model)
        data = {"tag": tag, "parent": parent_tag, "times": format_repetition(len(places)), **data}
        finding = rule.finding(
            message,
            at=places[0],
            severity=severity,
            related=places[1:10],
            edits=edits,
            consequences=_describe_consequences(message, places),
            **data,
        )
        yield replace(finding, subjects=tuple(place.subject for place in places))


def _describe_renaming(parent: str, near: str, places: list[Element], model: Model) -> tuple[str, tuple[Edit, ...]]:
    """Return the repair of a misspelt element, and its edits where they only make it count."""
    is_of_moving = near in _OF_MOVING_JOINTS
    wanted = [p for p in places if not (is_of_moving and _is_in_fixed_joint(p))] or places
    taken = _is_taken(parent, near, places)
    repeated = not taken and _is_repeated(parent, near, places)
    template = DELETION if taken else MERGING if repeated else RENAMING
    repair = template.format(parent=parent, near=near)
    if taken:
        return repair, ()
    wrong = _find_wrong_numbers(wanted, near)
    wrong += _find_stuck_joints(wanted, model) if near == "dynamics" else []
    if wrong:
        repair += ", and " + join_names(wrong)
    if len(wanted) < len(places) and not repeated:
        repair += ", and delete it in the fixed joints"
    if near == "dynamics" and not wrong:
        repair += f"; programs then use {_list_values(wanted, near)}. Delete it if the robot moves as it should"
    # The robot may be right with the default; without a limit, these types are refused.
    if (
        is_of_moving
        and near != "dynamics"
        and not repeated
        and not (near == "limit" and any(map(_needs_limit, wanted)))
    ):
        repair += "; delete it if the robot moves as it should"
    edits = () if repeated or wrong else build_rename_edits(wanted, near, model.source.files)
    return repair, tuple(edits)


def _leave_out_calls(
    model: Model, unknown: dict[tuple[str, str], list[Element]]
) -> dict[tuple[str, str], list[Element]]:
    """Leave out the calls of macros that lack their prefix: XAC007 reports them."""
    if not unknown:
        return {}
    calls = {call.tag for call in find_unprefixed_tags(model.source.trees, model.robot, only_calls=True)}
    return {key: places for key, places in unknown.items() if key[1] not in calls}


def _describe_consequences(message: str, places: list[Element]) -> dict[str, str]:
    """Return the reactions of urdfdom, MuJoCo, Drake and Bullet, which miss a shape in a geometry, and of Gazebo to SDF."""
    taken = list(filter(_is_in_place_of_shape, places))
    if not taken:
        gazebo = {"sdf": "ignores it outside <gazebo>", "pose": "replaces the pose of the whole model by it"}
        return ({"gazebo": gazebo[message]} if message in gazebo else {}) | dict.fromkeys(
            ("urdfdom", "mujoco", "drake", "bullet", "yourdfpy"), "ignores it, without a message"
        )
    lacking = [place for place in taken if is_collision_part(place) and not _has_shape_beside(place)]
    mujoco = "refuses the file" if lacking else "loads it without shapes that are only drawn"
    if not lacking and any(map(is_collision_part, taken)):
        mujoco = "ignores it, without a message"
    return {
        "urdfdom": "drops the shape, and every visual and collision of the link after it",
        "mujoco": mujoco,
        "drake": "refuses the file",
        "bullet": "refuses the file",
        "yourdfpy": "refuses the file",
    }


def _is_in_place_of_shape(element: Element) -> bool:
    """Whether an element is the first one in a geometry, where urdfdom and Bullet look for the shape."""
    return element.parent is not None and element.parent.tag == "geometry" and element.parent.children[0] is element


def _has_shape_beside(element: Element) -> bool:
    return element.parent is not None and any(child.tag in CHILDREN["geometry"] for child in element.parent.children)


def _holds_sdf_defaults(element: Element) -> bool:
    """Whether an element of SDF holds only what counts without it."""
    if element.tag == "gravity":
        # A number such as 9.81 means that there is gravity.
        text = element.text.strip()
        return text in _GRAVITY_TEXTS or bool(parse_number(text))
    values = [
        v for inner in element.walk() for v in (inner.text.strip(), *(a.value for a in inner.attributes.values()))
    ]
    return all(word in _DEFAULT_TEXTS or parse_number(word) == 0 for value in values for word in value.split())


def _holds_zeros(element: Element) -> bool:
    """Whether an element holds only zeros, as nearly all defaults are, or is empty: then nothing is lost with it."""
    if _is_empty(element):
        return True
    words = [word for inner in element.walk() for a in inner.attributes.values() for word in a.value.split()]
    return bool(words) and all(parse_number(word) == 0 for word in words)


def _holds_texts(element: Element) -> bool:
    """Whether an element has its numbers in separate elements, ``<friction>0.1</friction>``, as SDF has."""
    return not element.attributes and any(
        not child.attributes and parse_number(child.text.strip()) is not None for child in element.children
    )


def _is_in_fixed_joint(element: Element) -> bool:
    return element.parent is not None and element.parent.tag == "joint" and element.parent.get("type") == "fixed"


def _is_unused(element: Element, meant: str) -> bool:
    """Whether the joint around a part does not use it, wherever it is: a fixed joint uses none, and a continuous one no limits of
    its position."""
    kind = _get_joint_type(element)
    named = {*element.attributes, *(child.tag for child in element.children)}
    return kind == "fixed" or (kind == "continuous" and meant == "limit" and bool(named) and named <= _POSITIONS)


def _get_joint_type(element: Element) -> str:
    joint = _find_around(element, "joint")
    return "" if joint is None else joint.get("type")


def _needs_limit(element: Element) -> bool:
    """Whether an element is in a joint of a type that urdfdom refuses without a limit."""
    return element.parent is not None and element.parent.get("type") in {"revolute", "prismatic"}


def _find_wrong_numbers(places: list[Element], tag: str) -> list[str]:
    """Return what must be written instead of the attributes that are not numbers: under its new name the element is read.

    Of a limit also what urdfdom refuses it without, and a negative one: SDF has -1 where there is no limit, a URDF has none.
    """
    wrong: dict[str, None] = {}
    for place in places:
        numbers = {name: parse_number(place.get(name)) for name in _LIMITED if tag == "limit"}
        lacking = [n for n, v in numbers.items() if n not in place.attributes or (v is not None and v < 0)]
        if lacking:
            wrong[f"a positive {' and '.join(lacking)}"] = None
        for name, count in NUMERIC_ATTRIBUTES.get(tag, {}).items():
            value = place.get(name).strip()
            words = value.split() if count > 1 else [value]
            if name not in place.attributes or (len(words) == count and None not in map(parse_number, words)):
                continue
            forgotten = re.fullmatch(r"\{[A-Za-z_]\w*\}", value)
            wrong[f"`${value}` for the {name} `{value}`" if forgotten else f"a number for the {name}"] = None
    return list(wrong)


def _find_stuck_joints(places: list[Element], model: Model) -> list[str]:
    """Return what must be written instead of a friction and a damping that take the torque of a joint before it has its speed:
    that of its limits, or of a drive plugin, whose speed is not known."""
    torques = {
        wheel.text.strip(): plugin.torque
        for plugin in list_drive_plugins(model)
        for wheel in (*plugin.left, *plugin.right)
    }
    stuck: dict[str, None] = {}
    for place in places:
        damping, friction = (parse_number(place.get(name)) or 0.0 for name in ("damping", "friction"))
        torque = None if place.parent is None else torques.get(place.parent.get("name"))
        if torque is not None and torque > 0:
            values = {"friction": friction, "damping": damping}
            high = [name for name, value in values.items() if value >= torque]
            if high:
                stuck[
                    f"less {' and '.join(high)} than the {torque:g} N·m with which the drive plugin turns the wheel"
                ] = None
        limit = None if place.parent is None else place.parent.find_child("limit")
        effort, velocity = (None if limit is None else parse_number(limit.get(name)) for name in ("effort", "velocity"))
        if effort is None or effort <= 0:
            continue
        if friction >= effort:
            stuck[f"less friction than `{place.get('friction')}`: the effort limit of the joint is {effort:g}"] = None
        elif damping > 0 and friction + damping * (velocity or 0.0) >= effort:
            stuck[
                f"less damping than {damping:g}: at the velocity limit {velocity:g} it takes {damping * (velocity or 0):.3g}, "
                f"and the effort limit is {effort:g}"
            ] = None
    return list(stuck)


def _list_values(places: list[Element], near: str) -> str:
    """Join the values that programs read of the element that is meant, and have not read so far, for the end of a repair."""
    moving = [place for place in places if not _is_in_fixed_joint(place)]
    values: dict[str, dict[str, None]] = {}
    read = NUMERIC_ATTRIBUTES[near]
    for attribute in (a for place in moving for a in place.attributes.values() if a.name in read):
        number = parse_number(attribute.value)
        shown = attribute.value.strip() if number is None else f"{number:g}"
        values.setdefault(attribute.name, {})[shown] = None
    # Joints that move otherwise have other values.
    return join_names(f"{name} {_list_alternatives(list(each))}" for name, each in values.items()) or "it"


def _list_alternatives(values: list[str]) -> str:
    """Return ``a or b``, and only how many more there are of a long list."""
    more = len(values) - _MOST_VALUES
    return " or ".join(values if more <= 0 else [*values[:_MOST_VALUES], f"{more} other values"])


def _is_repeated(parent: str, tag: str, places: list[Element]) -> bool:
    """Whether one parent has two of the places, of which parsers would read only one."""
    parents = [id(place.parent) for place in places]
    return tag not in _REPEATED.get(parent, frozenset()) and len(set(parents)) < len(parents)


def _is_taken(parent: str, tag: str, places: list[Element]) -> bool:
    """Whether one of the places already has the element beside it, of which parsers read only one."""
    return tag not in _REPEATED.get(parent, frozenset()) and any(
        place.parent is not None and place.parent.find_child(tag) is not None for place in places
    )


def _is_empty(element: Element) -> bool:
    return not element.attributes and not element.children and not element.text.strip()


def _is_unknown_element(parent: str, child: Element) -> bool:
    known = CHILDREN.get(parent, frozenset()) | _EXTENSIONS.get(parent, frozenset())
    return child.tag not in known and ":" not in child.tag and child.tag not in _XACRO


def _classify_element(parent: str, places: list[Element], model: Model) -> tuple[str, Severity, dict[str, Any]] | None:
    """Return the message, its severity and its data for an unknown element, or None for an extension."""
    child = places[0]
    near = guess_element_tag(parent, child)
    if near is not None:
        return "misspelt", Severity.ERROR if parent == "geometry" else Severity.WARNING, {"near": near}
    homes = [home for home, children in CHILDREN.items() if child.tag in children and home != "robot"]
    if homes:
        repair = _describe_move(parent, places, homes, model)
        if repair is None:
            return None
        message = "pose" if parent == "robot" and child.tag == "origin" else "misplaced"
        # What is in its right place too is not lost.
        is_repeated = parent == "link" and all(_repeats_joint(place, model) for place in places)
        is_note = parent == "inertial" and child.tag == "geometry" and all(map(_has_shapes_around, places))
        severity = Severity.INFO if is_repeated or is_note else Severity.WARNING
        return message, severity, {"homes": _list_choices(homes), "repair": repair}
    if parent == "geometry" and not (child.tag in _SDF and not _is_in_place_of_shape(child)):
        return "shape", Severity.ERROR, {"repair": _describe_shape_repair(places, model)}
    if parent == "robot":
        return None
    if child.tag in _SDF:
        return "sdf", Severity.WARNING, {"repair": _describe_sdf_repair(parent, places, model)}
    is_call = model.source.is_xacro and child.attributes and not child.children
    return "ignored", Severity.INFO, {"call": _CALL if is_call else ""}


def _describe_move(parent: str, places: list[Element], homes: list[str], model: Model) -> str | None:
    """Say where a known element in the wrong place belongs, or why it is to be deleted; None for one that is not wrong there."""
    tag, listed = places[0].tag, _list_choices(homes)
    held = [home for home in homes if home in CHILDREN.get(parent, ())]
    around = _find_home_around(places, homes)
    if all(_lost_its_root(place, homes, model) for place in places):
        return f"put <robot> … </robot> around {listed} in its file: <xacro:include> drops the root element of a file"
    if all(map(_is_empty, places)):
        return "delete it: it is empty"
    if any(map(_holds_texts, places)):
        return f"delete it, or write its numbers as attributes in {listed}: they are typed as in SDF"
    if parent == "robot":
        return _describe_home_in_robot(places, homes, listed)
    if held and all(_has_in_all(place.parent, held, tag) for place in places):
        own = f"{_list_tags(held)} beside it {_AGREE[len(held) > 1]} own"
        return f"delete it: {own}{_describe_difference(places, held[0])}"
    if parent == "link" and all(_repeats_joint(place, model) for place in places):
        return "delete it: the joint that places the link has the same"
    if parent == "link" and tag in _NAMING and all(_list_joint_elements(place, model) for place in places):
        return f"delete it: the joint that places the link has its own <{tag}>"
    if parent == "inertial" and tag == "geometry" and all(map(_has_shapes_around, places)):
        return "delete it: the link has other shapes, and no inertia is computed from this one"
    if len(homes) == 1 and all(_is_around(place, homes[0]) for place in places):
        return f"delete it: the {listed} has its own <{tag}>"
    holding = [_find_around(place, *homes) for place in places]
    if all(home is not None and home.find_child(tag) is not None for home in holding):
        return f"delete it: the element around it has its own <{tag}>"
    outer = list(dict.fromkeys(home.tag for home in holding if home is not None))
    where = (
        f"the <{around}> around it"
        if around
        else _list_choices(held)
        if held and parent != "geometry"
        else f"the {_list_choices(outer)} around it"
        if outer and None not in holding
        else listed
    )
    return f"move it into {where}{_UNLESS_RIGHT}"


def _list_choices(tags: list[str]) -> str:
    """Return ``<a> or <b>``."""
    return " or ".join(f"<{tag}>" for tag in tags)


def _describe_home_in_robot(places: list[Element], homes: list[str], listed: str) -> str | None:
    """Say where an element directly in the robot belongs: in the element before it, whose end tag is often typed too early.

    None for an origin that no joint beside it lacks or has too: for Gazebo it is the pose of the model.
    """
    place = places[0]
    before, after = _find_neighbours(place)
    others = ", and the others likewise" if len(places) > 1 else ""
    same = (
        after is not None
        and after.tag in homes
        and any(_read_values(other) == _read_values(place) for other in after.find_children(place.tag))
    )
    if same and after is not None:
        return f"delete it: {after.tag} {after.get('name')} after it has the same{others}"
    if before is None or before.tag not in homes or not _are_typed_together(before, place):
        return None if place.tag == "origin" else f"move it into {listed}, or delete it where that has one already"
    owner = f"{before.tag} {before.get('name')}"
    if place.tag == "origin" and before.find_child("origin") is not None:
        return None
    if place.tag not in _REPEATED.get(before.tag, frozenset()) and before.find_child(place.tag) is not None:
        return f"{_describe_twin(place, before.find_children(place.tag)[0], owner)}{others}"
    drawn = before if before.children else _find_drawn_link(before)
    if drawn is not None and drawn is not before and drawn.find_child(place.tag) is None:
        return f"move it into {drawn.tag} {drawn.get('name')}: {owner} between them is an empty frame{others}"
    return f"move it into {owner}, which ends just before it{others}"


def _are_typed_together(one: Element, other: Element) -> bool:
    """Whether two elements come from one file, and there from the same call."""
    files = [None if element.span is None else element.span.file for element in (one, other)]
    return files[0] == files[1] and one.via == other.via


def _describe_twin(place: Element, twin: Element, owner: str) -> str:
    """Say what to do with an element where its home has one too: which of the two is right is not known if they differ."""
    own = {e.tag: e for e in (twin, *twin.children)}
    different: list[str] = []
    for element in (place, *place.children):
        there = own.get(element.tag)
        values = {} if there is None else _read_values(there)
        for name in (n for n, words in _read_values(element).items() if values.get(n) != words):
            old = f"{there.get(name)} there" if there is not None and name in values else "none there"
            different.append(f"<{element.tag}> {name} {old} and {element.get(name)} here")
    if not different:
        return f"delete it: {owner} before it has the same <{place.tag}>"
    return (
        f"keep one: {owner} before it has its own <{place.tag}>, with other values ({join_names(different, 2)}); write the "
        "right ones there, and delete this one"
    )


def _find_drawn_link(element: Element) -> Element | None:
    """Return the nearest link before an element that has a shape."""
    siblings = [] if element.parent is None else element.parent.children
    index = next((i for i, sibling in enumerate(siblings) if sibling is element), 0)
    shaped = (e for e in reversed(siblings[:index]) if e.find_child("visual") or e.find_child("collision"))
    return next(shaped, None)


def _find_neighbours(element: Element) -> tuple[Element | None, Element | None]:
    """Return the elements before and after one."""
    siblings = [] if element.parent is None else element.parent.children
    index = next((i for i, sibling in enumerate(siblings) if sibling is element), 0)
    before = siblings[index - 1] if index else None
    return before, siblings[index + 1] if index + 1 < len(siblings) else None


def _describe_difference(places: list[Element], home: str) -> str:
    """Say where a number that is typed twice is two numbers; empty where each is the same, to a few per cent."""
    different: list[str] = []
    for place in places:
        owner = place.parent
        inner = None if owner is None else owner.find_child(home)
        own = None if inner is None else inner.find_child(place.tag)
        one, other = _read_number(place), None if own is None else _read_number(own)
        if one is not None and other is not None and not math.isclose(one, other, rel_tol=_SAME):
            different.append(f"{'' if owner is None else owner.get('name')}: {one:.3g} and {other:.3g}")
    return f"; where the two differ ({join_names(different, 2)}), write the right one there" if different else ""


def _read_number(element: Element) -> float | None:
    """Return the only number of an element, in an attribute or as its text."""
    typed = [attribute.value for attribute in element.attributes.values()] or [element.text]
    return parse_number(typed[0].strip()) if len(typed) == 1 else None


def _lost_its_root(place: Element, homes: list[str], model: Model) -> bool:
    """Whether the element is typed in its home, which is the root of an included file and is dropped with it."""
    root = None if place.span is None else model.source.trees.get(place.span.file)
    return root is not None and root.tag in homes and any(child.span == place.span for child in root.children)


def _list_tags(tags: list[str]) -> str:
    """Return ``<a>, <b> and <c>``."""
    *before, last = (f"<{tag}>" for tag in tags)
    return " and ".join(filter(None, (", ".join(before), last)))


def _has_shapes_around(place: Element) -> bool:
    """Whether the link around a part of an inertial has shapes where they are read."""
    link = None if place.parent is None else place.parent.parent
    return any(_has_in_all(link, [home], "geometry") for home in ("visual", "collision"))


def _has_in_all(around: Element | None, homes: list[str], tag: str) -> bool:
    """Whether an element holds each of these homes, and each has a child of this tag."""
    found = [[] if around is None else around.find_children(home) for home in homes]
    return all(inner and all(one.find_child(tag) is not None for one in inner) for inner in found)


def _is_around(place: Element, home: str) -> bool:
    """Whether what is around the parent of an element is or holds the home of its tag, and that has its one child of the tag."""
    if place.tag in _REPEATED.get(home, frozenset()):
        return False
    around = None if place.parent is None else place.parent.parent
    while around is not None:
        homes = [around] if around.tag == home else around.find_children(home)
        if homes:
            return all(one.find_child(place.tag) is not None for one in homes)
        around = around.parent
    return False


def _find_home_around(places: list[Element], homes: list[str]) -> str | None:
    """Return the tag of the elements around all places in which they belong and which have none of their tag yet."""
    around = [_find_around(place, *homes) for place in places]
    tags = {None if home is None or home.find_child(places[0].tag) is not None else home.tag for home in around}
    return tags.pop() if len(tags) == 1 else None


def _repeats_joint(place: Element, model: Model) -> bool:
    """Whether an element in a link says the same as that of its tag in the joint above the link: it was typed twice."""
    return any(_read_values(other) == _read_values(place) for other in _list_joint_elements(place, model))


def _list_joint_elements(place: Element, model: Model) -> list[Element]:
    """List the elements of the same tag in the joint above the link that holds an element."""
    above = [j for j in model.joints if place.parent is not None and j.child == place.parent.get("name")]
    return [other for joint in above for other in joint.element.find_children(place.tag)]


def _read_values(element: Element) -> dict[str, list[float | str]]:
    """Return the numbers and words of each attribute; those of an origin that it lacks are zeros."""
    missing = {"xyz": "0 0 0", "rpy": "0 0 0"} if element.tag == "origin" else {}
    typed = {name: attribute.value for name, attribute in element.attributes.items()}
    return {
        name: [word if (number := parse_number(word)) is None else number for word in value.split()]
        for name, value in (missing | typed).items()
    }


def _describe_sdf_repair(parent: str, places: list[Element], model: Model) -> str:
    """Say where an element of SDF is read: in a <gazebo> block of its link or joint."""
    child = places[0]
    if child.tag == "pose":
        return _describe_pose_repair(parent, places)
    if child.tag in _SDF_OF_MODELS:
        return _SDF_OF_MODELS[child.tag]
    if child.tag in _SWITCHES and all(map(_holds_sdf_defaults, places)):
        return "delete it: that is so without it"
    around = parent if parent == "visual" else "collision"
    name, where, others = _describe_block_place(places, model)
    # In the block, sdformat writes a <gravity> of its own before this one, which then does not count.
    is_off = child.tag == "gravity" and not all(map(_holds_sdf_defaults, places))
    inside = "<turnGravityOff>true</turnGravityOff>" if is_off else "…"
    if child.tag in _SDF_OF_SHAPES:
        inside = f"<{around}>…</{around}>"
    leaves = list(dict.fromkeys(e.tag for place in places for e in place.walk() if not e.children))
    if child.tag == "surface" and (own := _find_own_contacts(child, leaves, model)):
        # What the block has of its own, sdformat writes over what is moved into it.
        return (
            f'delete it{others}: `<gazebo reference="{name}">` has its own {own}, which Gazebo uses; '
            "correct the numbers there if these are right"
        )
    block = f'`<gazebo reference="{name}">{inside}</gazebo>` {where}'
    repair = f"write {block} instead{others}" if is_off else f"move it into {block}{others}"
    if child.tag == "surface" and (moved := _describe_moved_contacts(places, around)):
        direct, kept = moved
        repair = f'move {direct} directly into `<gazebo reference="{name}">…</gazebo>` {where}{kept}{others}'
    if child.tag in _SDF_OF_SHAPES and any(map(_is_in_named_shape, places)):
        repair += f", and delete the name of the <{around}>, with which Gazebo ignores this block (GZB003)"
    return repair if is_off else f"{repair}{_UNLESS_RIGHT}"


def _describe_moved_contacts(places: list[Element], around: str) -> tuple[str, str] | None:
    """Say what of a surface is to be typed directly in a <gazebo> block, and where the rest is read in it.

    None if all of the surface is SDF and in its place: then it is moved as it is.
    """
    leaves = [e for place in places for e in place.walk() if not e.children and e.tag not in _SURFACE]
    direct = {e.tag: _NAMES_IN_BLOCK.get(e.tag, e.tag) for e in leaves}
    direct = {tag: name for tag, name in direct.items() if name in _OF_CONTACTS}
    misplaced = (e for e in leaves if e.tag in direct and (e.parent is None or e.parent.tag not in _ENGINES))
    if _URDF_OF_CONTACTS.isdisjoint(direct) and not any(misplaced):
        return None
    *before, last = (f"<{tag}>" if tag == name else f"<{tag}> as <{name}>" for tag, name in direct.items())
    listed = " and ".join(filter(None, (", ".join(before), last)))
    rest: dict[str, dict[str, None]] = {}
    for e in (e for e in leaves if e.tag not in direct):
        rest.setdefault(_HOMES_IN_SURFACE.get(e.tag) or _list_tags_around(e, "surface"), {})[e.tag] = None
    kept = "".join(
        f", and {_list_tags(list(tags))} into <{around}><surface>{home} in it" for home, tags in rest.items()
    )
    return listed, kept


def _list_tags_around(element: Element, outermost: str) -> str:
    """Return ``<contact><ode>`` for the elements around one, up to one that is not listed."""
    tags: list[str] = []
    above = element.parent
    while above is not None and above.tag != outermost:
        tags.insert(0, f"<{above.tag}>")
        above = above.parent
    return "".join(tags)


def _describe_pose_repair(parent: str, places: list[Element]) -> str:
    """Say what to do with a pose: where nothing else gives the place, its numbers may be what is meant."""
    if parent == "link":
        return "delete it: in URDF the joint above a link gives its place"
    lacks = all(place.parent is not None and place.parent.find_child("origin") is None for place in places)
    if not lacks or all(map(_holds_sdf_defaults, places)):
        return "delete it: in URDF `<origin>` gives the place"
    words = places[0].text.split()
    is_known = len({place.text for place in places}) == 1 and len(words) == 6 and not places[0].attributes
    if not is_known or None in map(parse_number, words):
        return "write its numbers as `<origin>` if they are meant, else delete it"
    origin = f'<origin xyz="{" ".join(words[:3])}" rpy="{" ".join(words[3:])}"/>'
    return f"write `{origin}` if this place is meant; else delete it"


def _find_own_contacts(surface: Element, leaves: list[str], model: Model) -> str:
    """Return what the <gazebo> block of the link has of all that a surface has; nothing if it lacks some of it.

    A second <surface> beside one that the block has for its shape would be one too many.
    """
    link = _find_around(surface, "link")
    wanted = [_NAMES_IN_BLOCK.get(tag, tag) for tag in leaves]
    blocks = [
        b for b in model.robot.find_children("gazebo") if link is not None and b.get("reference") == link.get("name")
    ]
    shapes = [shape for block in blocks for shape in block.find_children("collision")]
    if any(shape.find_child("surface") is not None for shape in shapes):
        return _list_tags(["surface"])
    own = {child.tag for block in blocks for child in block.children}
    is_all = wanted and set(wanted) <= _OF_CONTACTS and own.issuperset(wanted)
    return _list_tags(wanted) if is_all else ""


def _describe_block_place(places: list[Element], model: Model) -> tuple[str, str, str]:
    """Return the name of the link or joint that a <gazebo> block for the first place refers to, where to write the block, and a
    word about the other places."""
    owners = [_find_around(place, "link", "joint") for place in places]
    owner = owners[0]
    # In a macro the name is another one at each call.
    name = owner.attributes["name"].typed if owner is not None and "name" in owner.attributes else "LINK"
    likewise = ", and the others likewise" if len({place.span for place in places}) > 1 else ""
    if owner is None or "$" not in name or _is_typed_inside(places[0], owner, model):
        return name, "after the link" if "$" in name else "at the end of the robot", likewise
    # The macro of the link makes others too, and its names are not defined where the block of its call is typed.
    others = [each.get("name") for each in owners[1:] if each is not None and each.get("name") != owner.get("name")]
    more = f", and the same for {join_names(others)}" if others else ""
    return owner.get("name"), "at the end of the robot", more


def _is_typed_inside(place: Element, owner: Element, model: Model) -> bool:
    """Whether an element, or the call of the macro that makes it, is typed in the element around it, and not in a block that is
    handed over to the macro of that."""
    spans = {place.span, *place.via[len(owner.via) :]} - {None}
    typed = find_typed(model.source.trees, owner)
    return typed is not None and any(inner.span in spans for inner in typed.walk())


def _describe_shape_repair(places: list[Element], model: Model) -> str:
    """Say what to do with an element of a geometry that is no shape."""
    child = places[0]
    is_first = _is_in_place_of_shape(child)
    if child.tag in _FRICTION and (not is_first or (child.parent is not None and len(child.parent.children) > 1)):
        return _describe_friction_repair(places, model)
    return "replace it by a box, cylinder, sphere or mesh" if is_first else "delete it: the shape is before it"


def _describe_friction_repair(places: list[Element], model: Model) -> str:
    """Say where the friction of a link is read that is typed beside its shape."""
    name, where, others = _describe_block_place(places, model)
    typed = {e.tag: e.text.strip() for e in places[0].walk() if e.tag in {"mu", "mu1", "mu2"}}
    if any(place.span == places[0].span for place in places[1:]):  # a macro, whose calls may give other numbers
        typed = {}
    inside = f"<mu1>{typed.get('mu') or typed.get('mu1') or '…'}</mu1><mu2>{typed.get('mu2') or '…'}</mu2>"
    # None has had an effect so far: with it, the robot is another one.
    block = f'`<gazebo reference="{name}">{inside}</gazebo>` {where}'
    return f"write {block} instead{others}: friction is of the link; or delete it if the robot is right"


def _is_in_named_shape(element: Element) -> bool:
    """Whether the shape around an element has a name that does not begin with that of its link: Gazebo looks for this."""
    shape, link = _find_around(element, "collision", "visual"), _find_around(element, "link")
    return (
        shape is not None
        and link is not None
        and not (shape.get("name") or link.get("name")).startswith(link.get("name"))
    )


def _find_around(element: Element, *tags: str) -> Element | None:
    """Return the innermost element of one of these tags around an element."""
    around = element.parent
    while around is not None and around.tag not in tags:
        around = around.parent
    return around
