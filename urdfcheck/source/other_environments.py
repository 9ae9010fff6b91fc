"""The robots that a xacro makes elsewhere: under other distributions of ROS, and with the items of sets in another order.

They are expanded to see whether they differ; what differs is another robot, of which the check of this one says nothing.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping

from urdfcheck.source.load import Source
from urdfcheck.source.text.xml import Element
from urdfcheck.source.xacro.expand import expand_xacro
from urdfcheck.source.xacro.expressions.varying_values import SET_ORDERS
from urdfcheck.source.xacro.outside_access import HASH_SEED
from urdfcheck.source.xacro.ros_variables import FIRST_GENERATION, KNOWN_VARIABLES, VARIABLE
from urdfcheck.system.observing.questions import read_variable


def find_other_environments(source: Source) -> list[dict[str, str]]:
    """Return the arguments, beside those of a xacro, with which it makes other robots under known distributions of ROS.

    Each has the variables by which this expansion decides. Of several distributions with the same robot the first counts.
    """
    names = {f"{VARIABLE}{problem.data['variable']}" for problem in source.find_problems("environment-decides")}
    if not names:
        return []
    given = {
        name: value
        for name, value in source.arguments.items()
        if name.startswith(VARIABLE) and name not in source.assumed_variables
    }
    robots = {_digest_robot(source.root)}
    found: list[dict[str, str]] = []
    for distribution in KNOWN_VARIABLES["ROS_DISTRO"]:
        environment = {
            f"{VARIABLE}ROS_DISTRO": distribution,
            f"{VARIABLE}ROS_VERSION": "1" if distribution in FIRST_GENERATION else "2",
            f"{VARIABLE}ROS_PYTHON_VERSION": "3",
        }
        if any(environment.get(name, value) != value for name, value in given.items()):
            continue
        wanted = {name: value for name, value in environment.items() if name in names}
        if all(get_variable(source, name.removeprefix(VARIABLE)) == value for name, value in wanted.items()):
            continue
        robot = _digest_robot(_expand_again(source, wanted))
        if robot not in robots:
            robots.add(robot)
            found.append(wanted)
    return found


def depends_on_set_order(source: Source) -> bool:
    """Whether a xacro makes another robot when it goes through its sets in another order."""
    if not source.may_vary_with_order:
        return False
    here = _digest_robot(source.root)
    return any(_digest_robot(_expand_again(source, {f"{VARIABLE}{HASH_SEED}": order})) != here for order in SET_ORDERS)


def get_variable(source: Source, name: str) -> str:
    """Return the value of a variable of ROS with which a xacro was expanded; empty if it is not set."""
    return source.arguments.get(f"{VARIABLE}{name}") or read_variable(name) or ""


def _expand_again(source: Source, more: Mapping[str, str]) -> Element | None:
    arguments = {**source.arguments, **more}
    return expand_xacro(source.path, arguments, source.finder, extra_environment=source.environment).root


def _digest_robot(root: Element | None) -> bytes:
    """Return a digest of a robot in which the order of its links, joints and other parts counts for nothing."""
    if root is None:
        return b""
    parts = sorted(map(_digest_element, root.children))
    return hashlib.sha256(b"".join([*_list_texts(root), *parts])).digest()


def _digest_element(top: Element) -> bytes:
    digest = hashlib.sha256()
    stack = [(0, top)]
    while stack:
        depth, element = stack.pop()
        digest.update(b"\0%d\0" % depth)
        digest.update(b"\0".join(_list_texts(element)))
        stack.extend((depth + 1, child) for child in reversed(element.children))
    return digest.digest()


def _list_texts(element: Element) -> list[bytes]:
    attributes = sorted((name, attribute.value) for name, attribute in element.attributes.items())
    texts = [element.tag, *(text for pair in attributes for text in pair), element.text.strip()]
    return [text.encode("utf-8", "surrogatepass") for text in texts]
