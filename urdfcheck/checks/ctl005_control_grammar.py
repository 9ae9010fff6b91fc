"""CTL005 reports what the parser of ros2_control refuses in a `<ros2_control>` block."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.text import format_name_hint, join_names
from urdfcheck.model import Model
from urdfcheck.source.text.xml import Element

# What `parse_resource_from_xml` reads; any other tag makes it throw.
_TAGS = frozenset({"hardware", "properties", "joint", "sensor", "gpio", "transmission"})
_TYPES = ("system", "sensor", "actuator")
# The plugins of Gazebo go over all blocks and load these classes, and never read the type.
_SIMULATED = ("gazebo_ros2_control/", "gz_ros2_control/", "ign_ros2_control/")
_COMPONENTS = frozenset({"joint", "sensor", "gpio"})
_INTERFACES = frozenset({"command_interface", "state_interface"})
# Where the elements belong that are typed directly in a block.
_HOMES = {
    "param": "the <hardware>, or the joint that it is for",
    "plugin": "a <hardware>",
    "command_interface": "its <joint>",
    "state_interface": "its <joint>",
}
_TYPE = "write system, sensor or actuator"
_OWN_NAMES = "give each block its own name, for example with the prefix of its joints"
_CHOSEN = "pass the arguments that choose a <hardware>, or add one for these"
_COMMENT = re.compile(r"<!--.*?-->", re.DOTALL)


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    first: dict[str, Element] = {}
    for block in model.robot.find_children("ros2_control"):
        yield from _check_block(model, rule, block)
        name = block.get("name").strip() if _is_loaded(block) else ""
        if name and name in first:
            is_simulated = all(map(_find_simulator_class, (first[name], block)))
            yield rule.finding(
                "duplicate-simulated" if is_simulated else "duplicate",
                at=block,
                related=[first[name]],
                name=name,
                repair=_describe_duplicate(first[name], block),
            )
        first.setdefault(name, block)
        for element in block.children:
            if element.tag not in _TAGS:
                near = format_name_hint(element.tag, _TAGS)
                home = _HOMES.get(element.tag)
                repair = f"delete the element, or correct its tag{near}" if home is None else f"move it into {home}"
                yield rule.finding("tag", at=element, name=name, tag=element.tag, near=near, repair=repair)
            elif element.tag in _COMPONENTS:
                yield from _check_component(model, rule, block, element)
            elif element.tag == "transmission":
                yield from _check_transmission(model, rule, element)
        yield from _check_repeated_components(rule, block)


def _is_loaded(block: Element) -> bool:
    """Whether a program loads a block: ros2_control by its type, or Gazebo by its class."""
    return block.get("type").strip() in _TYPES or bool(_find_simulator_class(block))


def _describe_duplicate(one: Element, other: Element) -> str:
    """Say how two blocks of a name are repaired: one is deleted only where it has no component that the other lacks."""
    labels, others = ({e.label: None for e in block.children if e.tag in _COMPONENTS} for block in (one, other))
    shared = [label for label in others if label in labels]
    if not shared:
        return _OWN_NAMES
    if len(shared) == len(labels) == len(others):
        return f"delete one of the two: both have {shared[0]}"
    return f"give each block its own name, and leave {join_names(shared, 3)} in one of them only"


def _check_block(model: Model, rule: Rule, block: Element) -> Iterator[Finding]:
    """Check the attributes of a block and its hardware."""
    yield from _require(rule, block, "name")
    yield from _require(rule, block, "type")
    kind = block.attributes.get("type")
    if kind is not None and kind.value.strip() not in _TYPES:
        loader = _find_simulator_class(block)
        yield rule.finding(
            "type-simulated" if loader else "type",
            at=kind,
            severity=Severity.INFO if loader else None,
            name=block.get("name"),
            value=kind.value.strip(),
            plugin=loader,
            repair=_describe_type_repair(model, block, kind.value.strip()),
            consequences=None if loader else _describe_loss(block),
        )
    hardware = block.find_children("hardware")
    is_ignored = kind is not None and kind.value.strip() not in _TYPES  # whatever it has
    if not hardware and not is_ignored:
        # A condition of xacro may leave it out with these arguments and not with those of a launch file.
        depends = model.source.is_xacro and any("<hardware" in file.text for file in model.source.files.values())
        yield rule.finding(
            "hardware",
            at=block,
            severity=Severity.WARNING if depends else None,
            name=block.get("name"),
            when=" with these arguments" if depends else "",
            repair=_CHOSEN if depends else "add `<hardware><plugin>package/Class</plugin></hardware>`",
        )
    for element in hardware:
        yield from _require_plugin(model, rule, element, block.get("name"))
        yield from _check_params(rule, element, block.get("name"))


def _describe_type_repair(model: Model, block: Element, value: str) -> str:
    """Return the repair of a block of another type: one without a class of its own is loaded under no type, and what is in it may
    belong in a block that has one."""
    if _list_classes(block) or _is_typed_inside(model, block, "<hardware"):
        return _TYPE
    if format_name_hint(value.lower(), _TYPES) or value.lower() in _TYPES:
        return f"{_TYPE}, and add `<hardware><plugin>package/Class</plugin></hardware>`; or delete the block"
    held = {e.label: e for e in block.children if e.tag in _COMPONENTS}
    others = [each for each in model.robot.find_children("ros2_control") if _list_classes(each)]
    if not held:
        return "delete the block: nothing is in it"
    if not others:
        loaded = value if "/" in value else "package/Class"
        return f"{_TYPE}, and add `<hardware><plugin>{loaded}</plugin></hardware>`; or delete the block"
    other = max(others, key=lambda each: value in _list_classes(each))
    missing = [label for label in held if label not in {e.label for e in other.children}]
    if not missing:
        return f"delete the block: ros2_control {other.get('name')} has its own {join_names(held, 3)}"
    return (
        f"delete the block, or move {join_names(missing, 3)} into ros2_control {other.get('name')}, whose <hardware> loads "
        f"{_list_classes(other)[0]}"
    )


def _describe_loss(block: Element) -> dict[str, str]:
    """Return what Gazebo does with a block of another type, where that is not about its joints."""
    if not _list_classes(block):
        return {"gazebo": "drops the block: gz_ros2_control has no plugin to load"}
    return {} if block.find_child("joint") is not None else {"gazebo": "offers no interface of the block"}


def _list_classes(block: Element) -> list[str]:
    """List the classes that load a block."""
    plugins = [plugin for hardware in block.find_children("hardware") for plugin in hardware.find_children("plugin")]
    return [name for plugin in plugins if (name := plugin.text.strip())]


def _find_simulator_class(block: Element) -> str:
    """Return the hardware class of a block that a plugin of Gazebo loads itself, by its class alone; empty for another one."""
    plugins = (hardware.find_child("plugin") for hardware in block.find_children("hardware"))
    classes = [plugin.text.strip() for plugin in plugins if plugin is not None]
    return classes[0] if classes and all(name.startswith(_SIMULATED) for name in classes) else ""


def _require(rule: Rule, element: Element, attribute: str, of: str = "") -> Iterator[Finding]:
    """Report an attribute without which the parser throws."""
    if attribute not in element.attributes:
        yield rule.finding("attribute", at=element, tag=element.tag, attribute=attribute, of=f" of {of}" if of else "")


def _require_plugin(model: Model, rule: Rule, element: Element, name: str) -> Iterator[Finding]:
    plugin = element.find_child("plugin")
    if plugin is None and _is_typed_inside(model, element, "<plugin"):
        yield rule.finding("plugin-chosen", at=element, severity=Severity.INFO, tag=element.tag, name=name)
    elif plugin is None or not plugin.text.strip():
        message = "plugin" if plugin is None else "plugin-empty"
        is_other = plugin is not None and bool(plugin.children or plugin.attributes)  # as a plugin of Gazebo has
        repair = "write the class as the text of `<plugin>`: `<plugin>package/Class</plugin>`"
        yield rule.finding(
            message,
            at=plugin or element,
            tag=element.tag,
            name=name,
            lack="has no text" if is_other else "is empty",
            repair=repair if is_other else "write the class: `package/Class`",
        )


def _is_typed_inside(model: Model, element: Element, start: str) -> bool:
    """Whether a tag is typed in an element that has none: a condition of xacro leaves it out with these arguments."""
    file = None if element.span is None else model.source.files.get(element.span.file)
    if element.span is None or file is None or not model.source.is_xacro:
        return False
    inside, end, _ = file.text[element.span.end :].partition(f"</{element.tag}>")
    return bool(end) and start in _COMMENT.sub("", inside)


def _check_component(model: Model, rule: Rule, block: Element, component: Element) -> Iterator[Finding]:
    name = component.get("name")
    yield from _require(rule, component, "name")
    yield from _check_params(rule, component, name)
    for interface in component.children:
        if interface.tag in _INTERFACES:
            yield from _require(rule, interface, "name", name)
            yield from _check_params(rule, interface, name)
    joint = model.joint_by_name.get(name) if component.tag == "joint" else None
    if joint is None:
        return  # CTL001 reports unknown joints
    mimic = component.attributes.get("mimic")
    follows = mimic is None or mimic.value.strip().lower() not in {"false", "0"}
    if mimic is not None and follows and joint.mimic is None:
        yield rule.finding("mimic", at=mimic, related=[joint], joint=name)
    elif joint.mimic is not None and follows:
        leader = joint.mimic.get("joint")
        if not any(other.get("name") == leader for other in block.find_children("joint")):
            yield rule.finding(
                "leader",
                at=component,
                severity=Severity.WARNING,
                related=[joint.mimic],
                joint=name,
                leader=leader,
                name=block.get("name"),
            )


def _check_transmission(model: Model, rule: Rule, transmission: Element) -> Iterator[Finding]:
    yield from _require(rule, transmission, "name")
    yield from _require_plugin(model, rule, transmission, transmission.get("name"))
    for element in transmission.children:
        if element.tag in {"joint", "actuator"}:
            yield from _require(rule, element, "name", transmission.get("name"))
            yield from _require(rule, element, "role", transmission.get("name"))


def _check_params(rule: Rule, element: Element, name: str) -> Iterator[Finding]:
    for param in element.find_children("param"):
        yield from _require(rule, param, "name", name)


def _check_repeated_components(rule: Rule, block: Element) -> Iterator[Finding]:
    """Report components of one name with an interface of the same name: the second cannot be registered."""
    seen: dict[tuple[str, str, str], Element] = {}
    reported: set[str] = set()
    for component in block.children:
        if component.tag not in _COMPONENTS:
            continue
        name = component.get("name").strip()
        keys = [(name, e.tag, e.get("name").strip()) for e in component.children if e.tag in _INTERFACES]
        twice = next((key for key in keys if key in seen and seen[key] is not component), None)
        if twice is not None and name and name not in reported:
            reported.add(name)
            first = seen[twice].tag
            is_one_kind = first == component.tag
            finding = rule.finding(
                "twice" if is_one_kind else "kinds",
                at=component,
                related=[seen[twice]],
                severity=None if is_one_kind else Severity.WARNING,
                name=block.get("name"),
                tag=component.tag,
                first=first,
                part=name,
            )
            # Two places of one macro repeat the name in every robot that calls it, whatever the prefix is.
            yield replace(finding, blames_text=component.location.via == seen[twice].location.via)
        for key in keys:
            seen.setdefault(key, component)
