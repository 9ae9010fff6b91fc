"""LCH002 reports options of a spawner that lack a value, and required options that are missing."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import zip_longest

from urdfcheck.core import Finding, Location, Rule
from urdfcheck.core.records import dataclass
from urdfcheck.model.launch_context import LaunchContext
from urdfcheck.source.launch.static_transforms import get_executable
from urdfcheck.source.text.tokens import Token, tokenize_attribute
from urdfcheck.source.text.values import parse_number

_PLACE = frozenset({"-x", "-y", "-z", "-R", "-P", "-Y"})


@dataclass(frozen=True, slots=True)
class _SpawnerTool:
    """A program that spawns a robot."""

    value_options: frozenset[str]
    """The options that take one value."""
    name_option: str
    """The option that names the robot."""
    is_name_required: bool
    outcome_template: str
    """What the program does if another word follows in place of a value."""
    takes_any_word: bool = False
    """Whether it takes that word as the value and goes on."""


_REFUSES = '{tool} stops with "argument {option}: expected one argument", and the robot never spawns'
_TOOLS = {
    "spawn_model": _SpawnerTool(
        value_options=_PLACE
        | {
            *("-file", "-param", "-database", "-model", "-reference_frame", "-gazebo_namespace", "-robot_namespace"),
            "-wait",
        },
        name_option="-model",
        is_name_required=True,
        outcome_template=_REFUSES + "; versions before 2018 (ROS Kinetic) took the next word as the value",
    ),
    "spawn_entity.py": _SpawnerTool(
        value_options=_PLACE
        | {
            *("-file", "-topic", "-database", "-entity", "-reference_frame", "-gazebo_namespace", "-robot_namespace"),
            *("-timeout", "-wait", "-spawn_service_timeout"),
        },
        name_option="-entity",
        is_name_required=True,
        outcome_template=_REFUSES,
    ),
    "create": _SpawnerTool(
        value_options=_PLACE | {"-world", "-file", "-param", "-string", "-topic", "-name"},
        name_option="-name",
        is_name_required=False,
        outcome_template="{tool} takes the next word as the value",
        takes_any_word=True,
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
        for option, following in _iter_valueless_options(words, tool):
            yield _build_valueless_finding(rule, get_executable(node), option, following=following, robot=robot)
        unknown = any(word.text.startswith("$(") for word in words)
        if tool.is_name_required and not unknown and tool.name_option not in {word.text for word in words}:
            yield rule.finding(
                "missing", at=args, tool=get_executable(node), option=tool.name_option, robot=_quote_robot_name(robot)
            )


def _iter_valueless_options(words: Sequence[Token], tool: _SpawnerTool) -> Iterator[tuple[Token, Token | None]]:
    """Iterate over the options that another option or the end follows, with the word that follows."""
    for word, following in zip_longest(words, words[1:]):
        if word.text in tool.value_options and (following is None or _is_option(following.text)):
            yield word, following


def _is_option(text: str) -> bool:
    """Whether a word is not a value. To argparse a negative number is a value, and `-$(arg x)` most likely becomes one."""
    return text.startswith("-") and "$(" not in text and parse_number(text) is None


def _quote_robot_name(robot: str) -> str:
    return f"`{robot}`" if robot else "the robot's name"


def _build_valueless_finding(
    rule: Rule, executable: str, option: Token, *, following: Token | None, robot: str
) -> Finding:
    tool = _TOOLS[executable]
    names_robot = option.text == tool.name_option
    return rule.finding(
        "valueless" if following is not None else "valueless-end",
        at=_merge_locations(option, following),
        edits=[option.build_edit(f"{option.text} {robot}")] if names_robot and robot else (),
        consequences={"gazebo": f"spawns it with {following.text!r} as the value of {option.text}, if at all"}
        if tool.takes_any_word and following is not None
        else None,
        tool=executable,
        option=option.text,
        following="" if following is None else following.text,
        outcome=tool.outcome_template.format(tool=executable, option=option.text),
        taken=f" and would name the robot {following.text!r}" if names_robot and following is not None else "",
        value=_quote_robot_name(robot) if names_robot else "a value",
    )


def _merge_locations(option: Token, following: Token | None) -> Location:
    """Locate an option together with the word in place of its value."""
    if following is None:
        return option.location
    last = following.span
    return replace(
        option.location, span=replace(option.span, end_line=last.end_line, end_col=last.end_col, end=last.end)
    )
