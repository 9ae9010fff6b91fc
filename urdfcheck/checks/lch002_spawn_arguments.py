"""LCH002: every option of a spawner has its value, and the ones it demands are there."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import zip_longest

from urdfcheck.core import Edit, Finding, Location, Rule
from urdfcheck.model.launch_context import LaunchContext
from urdfcheck.source.launch.launch_file import get_executable
from urdfcheck.source.text.tokens import Token, tokenize_attribute
from urdfcheck.source.text.values import parse_number
from urdfcheck.source.text.xml import Element

_PLACE = frozenset({"-x", "-y", "-z", "-R", "-P", "-Y"})


@dataclass(frozen=True, slots=True)
class _SpawnerTool:
    """A spawner: its options that take one value, the one that names the robot, whether that one is demanded, and what
    happens when a value is missing and another word follows."""

    value_options: frozenset[str]
    name_option: str
    is_name_required: bool
    outcome_template: str


_REFUSES = "{tool} stops with «argument {option}: expected one argument» and the robot never spawns"
_TOOLS = {
    "spawn_model": _SpawnerTool(
        _PLACE
        | {
            "-file",
            "-param",
            "-database",
            "-model",
            "-reference_frame",
            "-gazebo_namespace",
            "-robot_namespace",
            "-wait",
        },
        "-model",
        True,
        _REFUSES + "; versions before 2018 (ROS Kinetic) took the next word as the value",
    ),
    "spawn_entity.py": _SpawnerTool(
        _PLACE
        | {
            *("-file", "-topic", "-database", "-entity", "-reference_frame", "-gazebo_namespace", "-robot_namespace"),
            *("-timeout", "-wait", "-spawn_service_timeout"),
        },
        "-entity",
        True,
        _REFUSES,
    ),
    "create": _SpawnerTool(
        _PLACE | {"-world", "-file", "-param", "-string", "-topic", "-name"},
        "-name",
        False,
        "{tool} takes the next word as the value",
    ),
}
_PACKAGES = frozenset({"gazebo_ros", "ros_gz_sim", "ros_ign_gazebo"})


def check(context: LaunchContext, rule: Rule) -> Iterator[Finding]:
    launch = context.launch
    robot = context.model.name if context.model is not None else ""
    for node in launch.nodes:
        tool = _TOOLS.get(get_executable(node))
        args = node.attributes.get("args")
        if tool is None or args is None or node.get("pkg") not in _PACKAGES:
            continue
        words = tokenize_attribute(args, launch.files)
        empty = list(_iter_valueless_options(words, tool))
        for option, following in empty:
            yield _build_valueless_finding(rule, node, tool, option, following, robot)
        unknown = any(word.text.startswith("$(") for word in words)
        if tool.is_name_required and not unknown and tool.name_option not in {word.text for word in words}:
            yield rule.finding(
                "missing", at=args, tool=get_executable(node), option=tool.name_option, robot=_quote_robot_name(robot)
            )


def _iter_valueless_options(words: Sequence[Token], tool: _SpawnerTool) -> Iterator[tuple[Token, Token | None]]:
    """Each option that another option or the end follows, with the word that follows."""
    for word, following in zip_longest(words, words[1:]):
        if word.text in tool.value_options and (following is None or _is_option(following.text)):
            yield word, following


def _is_option(text: str) -> bool:
    """Whether a word is no value. A negative number is one to argparse, and `-$(arg x)` is most likely to become one."""
    return text.startswith("-") and "$(" not in text and parse_number(text) is None


def _quote_robot_name(robot: str) -> str:
    return f"`{robot}`" if robot else "the robot's name"


def _build_valueless_finding(
    rule: Rule, node: Element, tool: _SpawnerTool, option: Token, following: Token | None, robot: str
) -> Finding:
    names_robot = option.text == tool.name_option
    edits: list[Edit] = [option.build_edit(f"{option.text} {robot}")] if names_robot and robot else []
    return rule.finding(
        "valueless" if following is not None else "valueless-end",
        at=_merge_locations(option, following),
        edits=edits,
        tool=get_executable(node),
        option=option.text,
        following="" if following is None else following.text,
        outcome=tool.outcome_template.format(tool=get_executable(node), option=option.text),
        taken=f" and would call the robot {following.text!r}" if names_robot and following is not None else "",
        value=_quote_robot_name(robot) if names_robot else "a value",
    )


def _merge_locations(option: Token, following: Token | None) -> Location:
    """From the option to the word that stands where its value should be."""
    if following is None:
        return option.location
    first, last = option.span, following.span
    span = type(first)(first.file, first.line, first.col, last.end_line, last.end_col, first.start, last.end)
    return Location(option.location.subject, span, option.location.via)
