"""Static transforms that a launch file publishes."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence

from urdfcheck.core.records import dataclass
from urdfcheck.source.launch.substitutions import SubstitutionResolver, split_command
from urdfcheck.source.text.values import parse_number
from urdfcheck.source.text.xml import Attribute, Element

# The options that name the frames, since ROS 2 Humble.
_PARENT, _CHILD = "--frame-id", "--child-frame-id"


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class StaticTransform:
    """A static_transform_publisher node. Its numbers are None if one of them is not literal."""

    node: Element
    at: Attribute
    """The attribute with its arguments."""
    parent: str
    child: str
    xyz: tuple[float, ...] | None
    """Translation from parent to child in metres."""
    rpy: tuple[float, ...] | None
    """Rotation in radians; None if it is given as a quaternion."""
    quaternion: tuple[float, ...] | None
    """Rotation as x y z w; None if it is given as roll, pitch, yaw."""


def get_executable(node: Element) -> str:
    """Return the executable of a node: ``type`` in ROS 1, ``exec`` in ROS 2."""
    return node.get("type") or node.get("exec")


def read_static_transforms(root: Element, resolver: SubstitutionResolver) -> Iterator[StaticTransform]:
    """Yield the static transforms of an XML launch file whose frames are known."""
    for node in root.walk():
        if node.tag != "node" or get_executable(node) != "static_transform_publisher" or not resolver.is_active(node):
            continue
        args = node.attributes.get("args")
        if args is None:
            continue
        words = [resolver.resolve_text(word) or "" for word in split_command(args.value)]
        placed = parse_transform_arguments(words)
        if placed is None or not all(placed[:2]):
            continue  # the frames are only known at launch
        parent, child, numbers = placed
        xyz = numbers[:3] if numbers else None
        rpy = (numbers[5], numbers[4], numbers[3]) if len(numbers) == 6 else None
        quaternion_values = numbers[3:] if len(numbers) == 7 else None
        yield StaticTransform(
            node=node,
            at=args,
            parent=parent.lstrip("/"),
            child=child.lstrip("/"),
            xyz=xyz,
            rpy=rpy,
            quaternion=quaternion_values,
        )


def parse_transform_arguments(words: Sequence[str]) -> tuple[str, str, tuple[float, ...]] | None:
    """Parse the arguments of a static_transform_publisher: parent, child, six or seven numbers (none if one is not literal)."""
    frames = find_frame_words(words)
    if frames is None:
        return None
    parent, child = (words[place] for place in frames)
    if words[frames[0] - 1] == _PARENT:
        return parent, child, _parse_named_numbers(words)
    count = frames[0]
    numbers = tuple(v for v in map(parse_number, words[:count]) if v is not None)
    return parent, child, numbers if len(numbers) == count else ()


def find_frame_words(words: Sequence[str]) -> tuple[int, int] | None:
    """Return which arguments of a static_transform_publisher are its frames, parent and child; None where it has none."""
    places = {word: place + 1 for place, word in enumerate(words[:-1]) if word.startswith("--")}
    if _PARENT in places and _CHILD in places:
        return places[_PARENT], places[_CHILD]
    if len(words) < 8:
        return None
    # x y z then yaw pitch roll, or a quaternion, then the frames and, for tf, a period.
    count = 7 if parse_number(words[6]) is not None and len(words) >= 9 else 6
    return count, count + 1


def _parse_named_numbers(words: Sequence[str]) -> tuple[float, ...]:
    options = {word: value for word, value in itertools.pairwise(words) if word.startswith("--")}
    turn = {"qx": "0", "qy": "0", "qz": "0", "qw": "1"}
    if not any(f"--{name}" in options for name in turn):
        turn = {"yaw": "0", "pitch": "0", "roll": "0"}
    defaults = {"x": "0", "y": "0", "z": "0", **turn}
    values = [parse_number(options.get(f"--{name}", default)) for name, default in defaults.items()]
    known = tuple(v for v in values if v is not None)
    return known if len(known) == len(values) else ()
