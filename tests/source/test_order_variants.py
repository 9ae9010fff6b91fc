"""Whether the random order of a set can change the robot: told without expanding it in other orders, where that is certain."""

from __future__ import annotations

from pathlib import Path

import pytest

from urdfcheck.source.package.finder import PackageFinder
from urdfcheck.source.xacro.expand import Expansion, expand_xacro

# What is defined from a set of texts whose order is random.
FINGERS = """
    <xacro:property name="fingers" value="${list(python.set(['th', 'FF', 'mf']))}" lazy_eval="false"/>
    <xacro:property name="fingers" value="${[f.lower() for f in fingers]}" lazy_eval="false"/>"""


def expand(folder: Path, use: str) -> Expansion:
    """Expand a robot that uses the fingers; not compared with plain xacro, whose robot is random."""
    path = folder / "robot.xacro"
    path.write_text(f'<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">{FINGERS}{use}</robot>')
    expansion = expand_xacro(path, {}, PackageFinder(path))
    assert expansion.root is not None
    assert [problem.kind for problem in expansion.problems].count("order-decides") == 1
    return expansion


@pytest.mark.parametrize(
    "use",
    [
        "<xacro:if value=\"${'ff' in fingers}\"><link name='ff'/></xacro:if>",
        '<link name="base_${len(fingers)}"/>',
        '<link name="base_${python.sorted(fingers)[0]}"/>',
        """<xacro:macro name="hand" params="fingers">
        <xacro:if value="${'th' in fingers}"><link name="th"/></xacro:if></xacro:macro>
        <xacro:hand fingers="${fingers}"/>""",
        """<xacro:macro name="hand" params="fingers:=^">
        <xacro:if value="${'th' in fingers}"><link name="th"/></xacro:if></xacro:macro>
        <xacro:hand/>""",
        """<xacro:property name="unknown" value="${python.set(fingers) - python.set(['th', 'ff', 'mf'])}"/>
        <xacro:if value="${unknown}"><link name="x"/></xacro:if>""",
        '<xacro:property name="fingers" value="none"/><link name="${fingers}"/>',
    ],
)
def test_an_order_that_only_conditions_see_cannot_change_the_robot(tmp_path: Path, use: str) -> None:
    assert not expand(tmp_path, use).may_vary_with_order


@pytest.mark.parametrize(
    "use",
    [
        '<link name="${fingers[0]}"/>',
        '<link name="base"/>${fingers}',
        '<xacro:if value="${fingers[0] == \'ff\'}"><link name="a"/></xacro:if>',
        '<xacro:property name="first" value="the_${fingers[0]}"/><link name="${first}"/>',
        '<xacro:property name="n" value="${fingers.pop()}"/><link name="base"/><a b="${n}"/>',
        '<xacro:property name="n" value="${fingers.index(\'ff\')}"/><link name="link_${n}"/>',
        '<xacro:arg name="a" default="${fingers[1]}"/><link name="$(arg a)"/>',
        """<xacro:macro name="hand" params="name"><link name="${name}"/></xacro:macro>
        <xacro:hand name="${fingers[2]}"/>""",
        """<xacro:macro name="hand" params="fingers:=^"><link name="${fingers[0]}"/></xacro:macro>
        <xacro:hand/>""",
        '<xacro:property name="other" value="a"/><xacro:property name="b" value="${other if fingers[0] == \'ff\' else 1}"/>'
        '<link name="${b}"/>',
    ],
)
def test_an_order_that_may_reach_the_robot_is_not_ruled_out(tmp_path: Path, use: str) -> None:
    assert expand(tmp_path, use).may_vary_with_order


def test_to_compute_a_value_again_has_no_effect(tmp_path: Path) -> None:
    unread = '<xacro:property name="rest" value="${fingers[1:]}"/>'  # another order would be the first to read it
    use = "<link name=\"${'a' if fingers[0] == 'ff' else rest[0]}\"/>"
    expansion = expand(tmp_path, unread + use)
    assert expansion.root is not None
    (link,) = expansion.root.children
    assert link.get("name") == "a"
    (read,) = link.attributes["name"].reads
    assert read.name == "fingers"
