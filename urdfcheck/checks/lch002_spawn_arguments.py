"""LCH002: every option of a spawner has its value, and the ones it demands are there."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import zip_longest

from urdfcheck.core import Edit, Finding, Location, Rule
from urdfcheck.source.launch.launch_file import Launch, executable
from urdfcheck.source.text.tokens import Word, words_of
from urdfcheck.source.text.values import number
from urdfcheck.source.text.xml import Element

_PLACE = frozenset({"-x", "-y", "-z", "-R", "-P", "-Y"})


@dataclass(frozen=True, slots=True)
class _Tool:
    """A spawner: its options that take one value, the one that names the robot, whether that one is demanded, and what
    happens when a value is missing and another word follows."""

    values: frozenset[str]
    name: str
    demanded: bool
    outcome: str


_REFUSES = "{tool} stops with «argument {option}: expected one argument» and the robot never spawns"
_TOOLS = {
    "spawn_model": _Tool(
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
    "spawn_entity.py": _Tool(
        _PLACE
        | {
            *("-file", "-topic", "-database", "-entity", "-reference_frame", "-gazebo_namespace", "-robot_namespace"),
            *("-timeout", "-wait", "-spawn_service_timeout"),
        },
        "-entity",
        True,
        _REFUSES,
    ),
    "create": _Tool(
        _PLACE | {"-world", "-file", "-param", "-string", "-topic", "-name"},
        "-name",
        False,
        "{tool} takes the next word as the value",
    ),
}
_PACKAGES = frozenset({"gazebo_ros", "ros_gz_sim", "ros_ign_gazebo"})


def check(launch: Launch, rule: Rule) -> Iterator[Finding]:
    robot = launch.model.name if launch.model is not None else ""
    for node in launch.nodes:
        tool = _TOOLS.get(executable(node))
        args = node.attributes.get("args")
        if tool is None or args is None or node.get("pkg") not in _PACKAGES:
            continue
        words = words_of(args, launch.files)
        empty = list(_without_value(words, tool))
        for option, following in empty:
            yield _valueless(rule, node, tool, option, following, robot)
        unknown = any(word.text.startswith("$(") for word in words)
        if tool.demanded and not unknown and tool.name not in {word.text for word in words}:
            yield rule.finding("missing", at=args, tool=executable(node), option=tool.name, robot=_quoted(robot))


def _without_value(words: Sequence[Word], tool: _Tool) -> Iterator[tuple[Word, Word | None]]:
    """Each option that another option or the end follows, with the word that follows."""
    for word, following in zip_longest(words, words[1:]):
        if word.text in tool.values and (following is None or _is_option(following.text)):
            yield word, following


def _is_option(text: str) -> bool:
    """Whether a word is no value. A negative number is one to argparse, and `-$(arg x)` is most likely to become one."""
    return text.startswith("-") and "$(" not in text and number(text) is None


def _quoted(robot: str) -> str:
    return f"`{robot}`" if robot else "the robot's name"


def _valueless(rule: Rule, node: Element, tool: _Tool, option: Word, following: Word | None, robot: str) -> Finding:
    names_robot = option.text == tool.name
    edits: list[Edit] = [option.replaced(f"{option.text} {robot}")] if names_robot and robot else []
    return rule.finding(
        "valueless" if following is not None else "valueless-end",
        at=_both(option, following),
        edits=edits,
        tool=executable(node),
        option=option.text,
        following="" if following is None else following.text,
        outcome=tool.outcome.format(tool=executable(node), option=option.text),
        taken=f" and would call the robot {following.text!r}" if names_robot and following is not None else "",
        value=_quoted(robot) if names_robot else "a value",
    )


def _both(option: Word, following: Word | None) -> Location:
    """From the option to the word that stands where its value should be."""
    if following is None:
        return option.location
    first, last = option.span, following.span
    span = type(first)(first.file, first.line, first.col, last.end_line, last.end_col, first.start, last.end)
    return Location(option.location.subject, span, option.location.via)
