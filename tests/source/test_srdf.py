"""Semantic descriptions: which of them belong to a model, and what they disable."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import pytest

from urdfcheck.source.discover import discover_targets
from urdfcheck.source.load import load_source
from urdfcheck.source.package.finder import PackageFinder
from urdfcheck.source.ros.srdf import Srdf, load_srdf, load_srdfs

URDF = '<robot name="arm"><link name="base"/></robot>'
SRDF = '<robot name="arm"><disable_collisions link1="a" link2="b" reason="Never"/></robot>'
XMLNS = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'


def manifest(name: str, *depends: str) -> str:
    return f"<package><name>{name}</name>{''.join(f'<exec_depend>{d}</exec_depend>' for d in depends)}</package>"


def write(folder: Path, files: Mapping[str, str]) -> None:
    for name, text in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")


def list_descriptions(folder: Path, model: str, **arguments: str) -> list[str]:
    """The semantic descriptions of a model, by their paths from the folder."""
    path = folder / model
    source = load_source(path, arguments, PackageFinder(path, environment={}))
    return [srdf.path.relative_to(folder).as_posix() for srdf in load_srdfs(source, "arm")]


def parsed(folder: Path, body: str) -> Srdf:
    write(folder, {"arm.srdf": f'<robot name="arm">{body}</robot>'})
    srdf = load_srdf(folder / "arm.srdf", {}, PackageFinder(folder, environment={}), robot="arm")
    assert srdf is not None
    return srdf


# -- where they are found ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("place", "belongs"),
    [
        ("ws/arm/urdf/arm.srdf", True),
        ("ws/arm/config/arm.srdf", True),
        ("ws/arm/robots/arm_description/srdf/arm.srdf", True),
        ("ws/arm/build/arm.srdf", False),
        ("ws/arm_moveit_config/config/arm.srdf", True),
        ("ws/planning/config/arm.srdf", True),  # depends on the model's package
        ("ws/planning/config/arm/arm.srdf", True),  # of several robots
        ("ws/planning/other/arm.srdf", False),
        ("ws/other/config/arm.srdf", False),
        ("elsewhere/arm_moveit_config/config/arm.srdf", False),
    ],
)
def test_they_are_looked_for_where_moveit_configurations_lie(tmp_path: Path, place: str, belongs: bool) -> None:
    packages = {
        "ws/arm/package.xml": manifest("arm"),
        "ws/arm_moveit_config/package.xml": manifest("arm_moveit_config"),
        "ws/planning/package.xml": manifest("planning", "arm"),
        "ws/other/package.xml": manifest("other"),
        "elsewhere/arm_moveit_config/package.xml": manifest("arm_moveit_config"),
    }
    write(tmp_path, {"ws/arm/urdf/arm.urdf": URDF, place: SRDF, **packages})
    (tmp_path / "ws/.git").mkdir()
    assert list_descriptions(tmp_path, "ws/arm/urdf/arm.urdf") == ([place] if belongs else [])


@pytest.mark.parametrize(("model", "belongs"), [("urdf/arm.urdf", False), ("meshes/arm.stl", True)])
def test_a_configuration_that_depends_on_another_package_with_models_is_not_the_model_s(
    tmp_path: Path, model: str, belongs: bool
) -> None:
    place = "ws/arm_moveit_config/config/arm.srdf"
    packages = {
        "ws/arm/package.xml": manifest("arm"),
        "ws/arm_moveit_config/package.xml": manifest("arm_moveit_config", "arm_description"),
        "ws/arm_description/package.xml": manifest("arm_description"),
        f"ws/arm_description/{model}": URDF,
    }
    write(tmp_path, {"ws/arm/urdf/arm.urdf": URDF, place: SRDF, **packages})
    (tmp_path / "ws/.git").mkdir()
    assert list_descriptions(tmp_path, "ws/arm/urdf/arm.urdf") == ([place] if belongs else [])


def test_a_model_without_a_package_has_those_beside_it(tmp_path: Path) -> None:
    write(tmp_path, {"arm.urdf": URDF, "a.srdf": SRDF, "b.srdf": SRDF.replace('"arm"', '" arm "'), "deep/c.srdf": SRDF})
    assert list_descriptions(tmp_path, "arm.urdf") == ["a.srdf", "b.srdf"]


@pytest.mark.parametrize("text", [SRDF.replace("arm", "leg"), "<robot", "<arm/>", "", '<robot name="">'])
def test_what_is_for_another_robot_or_cannot_be_read_is_none(tmp_path: Path, text: str) -> None:
    write(tmp_path, {"arm.urdf": URDF, "arm.srdf": text})
    assert not list_descriptions(tmp_path, "arm.urdf")


def test_a_xacro_is_expanded_with_the_arguments_of_the_model(tmp_path: Path) -> None:
    macros = f'<robot name="arm" {XMLNS}><xacro:macro name="pairs" params="prefix">'
    macros += '<disable_collisions link1="${prefix}a" link2="b" reason="Never"/></xacro:macro></robot>'
    main = f'<robot name="$(arg name)" {XMLNS}><xacro:arg name="name" default="leg"/>'
    main += '<xacro:include filename="macros.srdf.xacro"/><xacro:pairs prefix="left_"/></robot>'
    write(tmp_path, {"arm.urdf": URDF, "macros.srdf.xacro": macros, "arm.srdf.xacro": main})
    assert list_descriptions(tmp_path, "arm.urdf") == []
    assert list_descriptions(tmp_path, "arm.urdf", name="arm") == ["arm.srdf.xacro"]
    srdf = load_srdf(tmp_path / "arm.srdf.xacro", {"name": "arm"}, PackageFinder(tmp_path, environment={}), robot="arm")
    assert srdf is not None
    (pair,) = srdf.disabled_pairs
    assert pair.links == ("left_a", "b")
    attribute = pair.get_link(0)
    assert attribute is not None
    assert attribute.typed == "${prefix}a"


# -- what they say -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("body", "disabled"),
    [
        ("", False),
        ('<disable_collisions link1="a" link2="b"/>', True),
        ('<disable_collisions link1=" b " link2="a"/>', True),
        ('<disable_collisions link1="a" link2="c"/>', False),
        ('<disable_default_collisions link="b"/>', True),
        ('<disable_default_collisions link="b"/><enable_collisions link1="a" link2="b"/>', False),
        (
            '<disable_default_collisions link="b"/><enable_collisions link1="a" link2="b"/>'
            '<disable_collisions link1="a" link2="b"/>',
            True,
        ),
        ('<enable_collisions link1="a" link2="b"/>', False),
        ('<group name="g"><disable_collisions link1="a" link2="b"/></group>', False),
    ],
)
def test_disabled_pairs_go_before_enabled_ones_before_defaults(tmp_path: Path, body: str, disabled: bool) -> None:
    assert parsed(tmp_path, body).is_pair_disabled("a", "b") == disabled


def test_groups_name_links(tmp_path: Path) -> None:
    body = """<group name="g"><chain base_link="a" tip_link="b"/><link name="c"/><joint name="j"/></group>
    <end_effector name="e" group="g" parent_link="d"/><virtual_joint name="v" child_link="f" parent_frame="world"/>
    <disable_collisions link1="x" link2="y"/>"""
    assert parsed(tmp_path, body).grouped_links == {"a", "b", "c", "d", "f"}


# -- named on the command line, and met in a folder --------------------------------------------------------------------


def test_one_that_is_named_means_the_models_of_its_robot(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    files = {
        "ws/arm/package.xml": manifest("arm"),
        "ws/arm/arm.urdf": URDF,
        "ws/arm/leg.urdf": URDF.replace("arm", "leg"),
        "ws/arm_moveit_config/package.xml": manifest("arm_moveit_config", "arm"),
        "ws/arm_moveit_config/config/arm.srdf": SRDF,
        "ws/arm_moveit_config/config/hand.srdf": SRDF.replace("arm", "hand"),
    }
    write(tmp_path, files)
    (tmp_path / "ws/.git").mkdir()
    planned = discover_targets([Path("ws/arm_moveit_config/config/arm.srdf")], {}, packages={}, package_paths=[])
    assert [target.path.as_posix() for target in planned.models] == ["ws/arm/arm.urdf"]
    unused = discover_targets([Path("ws/arm_moveit_config/config/hand.srdf")], {}, packages={}, package_paths=[])
    assert not unused.models
    assert unused.unused == (
        ("ws/arm_moveit_config/config/hand.srdf", "no model of its package or repository has the name of its robot"),
    )


def test_in_a_folder_they_are_no_models(tmp_path: Path) -> None:
    main = f'<robot name="arm" {XMLNS}><xacro:include filename="m.srdf.xacro"/><xacro:pairs/></robot>'
    macros = f'<robot {XMLNS}><xacro:macro name="pairs"/></robot>'
    write(tmp_path, {"arm.urdf": URDF, "config/arm.srdf.xacro": main, "config/m.srdf.xacro": macros})
    assert [target.path.name for target in discover_targets([tmp_path], {}, packages={}, package_paths=[]).models] == [
        "arm.urdf"
    ]
