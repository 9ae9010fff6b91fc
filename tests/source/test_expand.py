"""The map from an expanded model back to its xacro files: where each element and value was typed, and through which calls."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from conftest import FIXTURES
from real_robots import list_robots, select_by_trait

from urdfcheck.source.package.finder import PackageFinder
from urdfcheck.source.xacro.argument_values import build_argument_sets, find_argument_choices
from urdfcheck.source.xacro.expand import Expansion, expand_xacro

Expand = Callable[..., Any]
LikePlain = Callable[..., None]

MACRO_FILE = '<robot xmlns:xacro="http://www.ros.org/wiki/xacro">{}</robot>'


# -- where it was typed ------------------------------------------------------------------------------------------------


def test_an_attribute_made_by_a_macro_points_to_the_text_in_the_macro(expand_text: Expand) -> None:
    x = expand_text(
        """
        <xacro:macro name="wheel" params="side">
          <link name="${side}_wheel" kind="round"/>
        </xacro:macro>
        <xacro:wheel side="left"/>"""
    )
    link = x.named("left_wheel")
    name, kind = link.attributes["name"], link.attributes["kind"]
    assert x.place(name.span) == "robot.xacro:3 ${side}_wheel"
    assert name.typed == "${side}_wheel"
    assert not name.literal  # an edit here would edit every wheel, and is no edit of the value
    assert kind.literal
    assert name.location.subject == "link[left_wheel]@name"


def test_the_calls_are_told_outermost_first_and_arguments_count(expand_text: Expand) -> None:
    x = expand_text(
        """
        <xacro:macro name="wheel" params="mass"><link name="wheel" m="${mass}"/></xacro:macro>
        <xacro:macro name="cart" params="mass:=2">
          <xacro:wheel mass="${mass / 4}"/>
        </xacro:macro>
        <xacro:cart/>"""
    )
    wheel = x.named("wheel")
    assert x.calls(wheel) == ["<xacro:cart/>", '<xacro:wheel mass="${mass / 4}"/>']
    assert wheel.location.via == wheel.via == wheel.attributes["m"].location.via
    assert [d.kind for d in wheel.attributes["m"].collect_definitions()] == ["parameter", "parameter"]
    assert [x.text(d.span) for d in wheel.attributes["m"].collect_definitions()] == ["${mass / 4}", "mass:=2"]


def test_two_calls_of_one_macro_share_the_text_and_differ_in_the_call(expand_text: Expand) -> None:
    x = expand_text(
        """
        <xacro:macro name="wheel" params="n"><link name="w${n}"><mass value="1"/></link></xacro:macro>
        <xacro:wheel n="1"/>
        <xacro:wheel n="2"/>"""
    )
    one, two = x.named("w1").children[0], x.named("w2").children[0]
    assert one.span == two.span
    assert (x.calls(one), x.calls(two)) == (['<xacro:wheel n="1"/>'], ['<xacro:wheel n="2"/>'])


def test_a_block_handed_to_a_macro_keeps_the_place_and_the_calls_of_the_caller(expand_text: Expand) -> None:
    x = expand_text(
        """
        <xacro:property name="m" value="3"/>
        <xacro:macro name="inner" params="*block">
          <link name="inner"><xacro:insert_block name="block"/></link>
        </xacro:macro>
        <xacro:macro name="outer" params="**blocks">
          <xacro:inner><inertial mass="${m}"/></xacro:inner>
          <link name="outer"><xacro:insert_block name="blocks"/></link>
        </xacro:macro>
        <xacro:outer><anything><visual mass="${m}"/></anything></xacro:outer>"""
    )
    inertial, visual = x.named("inner").children[0], x.named("outer").children[0]
    assert x.place(inertial.span) == 'robot.xacro:7 <inertial mass="${m}"/>'
    assert x.calls(inertial) == ["<xacro:outer>"]  # typed in outer, not in inner
    assert x.calls(x.named("inner")) == ["<xacro:outer>", "<xacro:inner>"]
    assert x.calls(visual) == []  # typed by the caller of outer
    for element in (inertial, visual):
        assert x.origins(element.attributes["mass"]) == {"property[m]": "3"}


def test_a_block_handed_through_two_macros_stays_where_it_was_typed(expand_text: Expand) -> None:
    x = expand_text(
        """
        <xacro:macro name="inner" params="*b"><link name="a"><xacro:insert_block name="b"/></link></xacro:macro>
        <xacro:macro name="outer" params="*b"><xacro:inner><xacro:insert_block name="b"/></xacro:inner></xacro:macro>
        <xacro:outer><origin xyz="${1 + 1} 0 0"/></xacro:outer>"""
    )
    origin = x.named("a").children[0]
    assert origin.get("xyz") == "2 0 0"
    assert x.place(origin.attributes["xyz"].span) == "robot.xacro:4 ${1 + 1} 0 0"
    assert x.calls(origin) == []


def test_what_is_in_a_condition_is_copied_for_each_call_and_each_block(expand_text: Expand) -> None:
    x = expand_text(
        """
        <xacro:macro name="inner" params="n *b">
          <xacro:if value="${n > 1}"><xacro:unless value="${n > 2}"><link name="in${n}"/></xacro:unless><!-- if --></xacro:if>
          <xacro:insert_block name="b"/><xacro:insert_block name="b"/>
        </xacro:macro>
        <xacro:macro name="outer" params="n">
          <xacro:if value="${n}"><xacro:macro name="local" params="m"><xacro:if value="${m}"><link name="l${n}${m}"/></xacro:if>
          </xacro:macro></xacro:if>
          <xacro:local m="1"/><xacro:local m="0"/>
          <xacro:inner n="${n}"><group><xacro:if value="${n > 1}"><link name="b${n}"/></xacro:if></group></xacro:inner>
        </xacro:macro>
        <xacro:outer n="1"/><xacro:outer n="2"/><xacro:outer n="3"/>"""
    )
    assert x.root is not None
    links = [element.get("name") for element in x.root.walk() if element.tag == "link"]
    assert links == ["l11", "l21", "in2", "b2", "b2", "l31", "b3", "b3"]


def test_a_property_block_points_to_the_property_and_comes_through_the_macro_that_inserts_it(
    expand_text: Expand,
) -> None:
    x = expand_text(
        """
        <xacro:property name="zero"><origin xyz="0 0 0"/></xacro:property>
        <xacro:macro name="m"><link name="a"><xacro:insert_block name="zero"/></link></xacro:macro>
        <xacro:m/>"""
    )
    origin = x.named("a").children[0]
    assert x.place(origin.attributes["xyz"].span) == "robot.xacro:2 0 0 0"
    assert origin.attributes["xyz"].literal
    assert x.calls(origin) == ["<xacro:m/>"]


def test_conditions_leave_no_trace_in_the_chain(expand_text: Expand) -> None:
    x = expand_text(
        """
        <xacro:if value="${1 &lt; 2}"><link name="a"/></xacro:if>
        <xacro:if value="false"><link name="b"/></xacro:if>
        <xacro:unless value="0"><link name="c"/></xacro:unless>"""
    )
    assert [e.get("name") for e in x.root.children] == ["a", "c"]
    assert x.place(x.named("c").span) == 'robot.xacro:4 <link name="c"/>'
    assert x.calls(x.named("c")) == []


def test_a_computed_element_name_points_to_the_xacro_element(expand_text: Expand) -> None:
    x = expand_text("""<xacro:property name="t" value="link"/><xacro:element xacro:name="${t}" name="a" x="1"/>""")
    link = x.named("a")
    assert link.tag == "link"
    assert x.text(link.span) == '<xacro:element xacro:name="${t}" name="a" x="1"/>'
    assert link.attributes["x"].literal


def test_an_attribute_set_from_inside_points_to_its_value(expand_text: Expand) -> None:
    x = expand_text(
        """
        <xacro:property name="n" value="arm"/>
        <link>
          <xacro:attribute name="name" value="${n}_1"/>
          <xacro:attribute name="mass" value="2"/>
        </link>"""
    )
    name, mass = x.named("arm_1").attributes["name"], x.named("arm_1").attributes["mass"]
    assert x.place(name.span) == "robot.xacro:4 ${n}_1"
    assert x.origins(name) == {"property[n]": "arm"}
    assert not name.literal
    assert x.place(mass.span) == "robot.xacro:5 2"
    assert mass.literal
    assert mass.location.subject == "link[arm_1]@mass"


def test_entities_and_non_ascii_text_do_not_shift_anything(expand_text: Expand) -> None:
    x = expand_text(
        """<!-- é🤖 --><xacro:macro name="m" params="n"><link name="é🤖 &amp; ${n}"/></xacro:macro><xacro:m n="ü"/>"""
    )
    assert x.text(x.named("é🤖 & ü").attributes["name"].span) == "é🤖 &amp; ${n}"


def test_an_escaped_dollar_is_no_literal_text(expand_text: Expand) -> None:
    x = expand_text('<link name="a" x="$${y}"/>')
    assert x.named("a").get("x") == "${y}"
    assert not x.named("a").attributes["x"].literal


# -- includes ----------------------------------------------------------------------------------------------------------


def test_an_included_element_names_its_file_and_the_include(expand_text: Expand) -> None:
    x = expand_text(
        '<xacro:include filename="parts/wheel.xacro"/>',
        {
            "parts/wheel.xacro": MACRO_FILE.format('<xacro:include filename="tyre.xacro"/>'),
            "parts/tyre.xacro": MACRO_FILE.format('\n<link name="tyre"/>'),
        },
    )
    tyre = x.named("tyre")
    assert x.place(tyre.span) == 'parts/tyre.xacro:2 <link name="tyre"/>'
    assert [span.file for span in tyre.via] == ["robot.xacro", "parts/wheel.xacro"]
    assert set(x.expansion.files) == {"robot.xacro", "parts/wheel.xacro", "parts/tyre.xacro"}


def test_a_macro_of_an_included_file_comes_through_its_call_not_through_the_include(expand_text: Expand) -> None:
    x = expand_text(
        '<xacro:include filename="m.xacro"/><xacro:m/>',
        {"m.xacro": MACRO_FILE.format('<xacro:macro name="m"><link name="a"/></xacro:macro>')},
    )
    assert x.named("a").span.file == "m.xacro"
    assert x.calls(x.named("a")) == ["<xacro:m/>"]


def test_a_pattern_includes_every_file_that_it_matches(expand_text: Expand) -> None:
    files = {f"part_{n}.xacro": MACRO_FILE.format(f'<link name="{n}"/>') for n in "ab"}
    x = expand_text('<xacro:include filename="part_*.xacro"/>', files)
    assert [e.span.file for e in x.root.children] == ["part_a.xacro", "part_b.xacro"]


def test_an_optional_include_may_be_missing_and_what_fails_later_is_located_there(expand_text: Expand) -> None:
    include = '<xacro:include filename="nope.xacro" optional="true"/>'
    assert expand_text(include + '<link name="a"/>').named("a")
    x = expand_text(include + '\n<link name="${wrong}"/>')
    assert x.place(x.problem.location.span) == "robot.xacro:2 ${wrong}"


def test_a_namespace_keeps_macros_and_properties_apart(expand_text: Expand) -> None:
    x = expand_text(
        """
        <xacro:property name="size" value="1"/>
        <xacro:include filename="m.xacro" ns="lib"/>
        <xacro:lib.m own="${size}"/>""",
        {
            "m.xacro": MACRO_FILE.format(
                '<xacro:property name="size" value="7"/>'
                '<xacro:macro name="m" params="own"><link name="a" own="${own}" theirs="${size}"/></xacro:macro>'
            )
        },
    )
    link = x.named("a")
    assert x.calls(link) == ['<xacro:lib.m own="${size}"/>']
    assert x.origins(link.attributes["own"]) == {"parameter[own]": "${size}", "property[size]": "1"}
    assert x.origins(link.attributes["theirs"]) == {"property[size]": "7"}


def test_a_namespace_declared_by_an_included_file_or_a_macro_is_located_there(expand_text: Expand) -> None:
    x = expand_text(
        '<xacro:include filename="i.xacro"/><xacro:m/>',
        {
            "i.xacro": '<robot xmlns:xacro="u" xmlns:sensor="urn:sensor">'
            '<xacro:macro name="m" xmlns:other="urn:other"><link name="a"/></xacro:macro></robot>'
        },
    )
    assert x.place(x.root.attributes["xmlns:sensor"].span) == "i.xacro:1 urn:sensor"
    assert x.place(x.root.attributes["xmlns:other"].span) == "i.xacro:1 urn:other"


def test_dirname_is_the_folder_of_the_file_that_says_so(expand_text: Expand, tmp_path: Path) -> None:
    x = expand_text(
        '<xacro:include filename="sub/i.xacro"/>',
        {"sub/i.xacro": MACRO_FILE.format('<link name="a" here="$(dirname)"/>')},
        like_plain=False,  # plain xacro knows no folder outside of ROS
    )
    assert x.named("a").get("here") == str(tmp_path / "sub")


def test_find_looks_for_packages_without_ros(expand_text: Expand) -> None:
    x = expand_text(
        '<xacro:include filename="$(find parts)/urdf/i.xacro"/>',
        {"src/parts/package.xml": "<package><name>parts</name></package>",
         "src/parts/urdf/i.xacro": MACRO_FILE.format('<link name="a"/>')},
    )  # fmt: skip
    assert x.named("a").span.file == "src/parts/urdf/i.xacro"


# -- what went into a value --------------------------------------------------------------------------------------------


def test_a_property_is_followed_through_the_properties_that_it_is_computed_from(expand_text: Expand) -> None:
    x = expand_text(
        """
        <xacro:property name="area" value="${width * height}"/>
        <xacro:property name="width" value="2"/>
        <xacro:property name="height" value="${width + 1}"/>
        <link name="a" area="${area}" again="${area}" width="${width}"/>"""
    )
    link = x.named("a")
    assert link.get("area") == "6"
    expected = {"property[area]": "${width * height}", "property[width]": "2", "property[height]": "${width + 1}"}
    assert x.origins(link.attributes["area"]) == x.origins(link.attributes["again"]) == expected
    assert link.attributes["area"].collect_definitions()[0].name == "area"  # nearest first
    assert x.origins(link.attributes["width"]) == {"property[width]": "2"}
    assert x.origins(link.attributes["name"]) == {}


def test_a_property_defined_twice_counts_as_it_was_when_it_was_read(expand_text: Expand) -> None:
    x = expand_text(
        """
        <xacro:property name="p" value="1"/><link name="a" x="${p}"/>
        <xacro:property name="p" value="2"/><link name="b" x="${p}"/>"""
    )
    assert x.origins(x.named("a").attributes["x"]) == {"property[p]": "1"}
    assert x.origins(x.named("b").attributes["x"]) == {"property[p]": "2"}


def test_a_default_property_is_kept_when_there_is_one_already(expand_text: Expand) -> None:
    x = expand_text(
        """
        <xacro:property name="p" value="1"/><xacro:property name="p" default="2"/>
        <xacro:property name="q" default="3"/><link name="a" x="${p}${q}"/>"""
    )
    assert x.origins(x.named("a").attributes["x"]) == {"property[p]": "1", "property[q]": "3"}


@pytest.mark.parametrize("scope", ["parent", "global"])
def test_a_property_that_a_macro_sets_outside_leads_to_the_macro_and_to_its_call(
    expand_text: Expand, scope: str
) -> None:
    x = expand_text(
        f"""
        <xacro:macro name="set" params="v"><xacro:property name="p" value="${{v * 2}}" scope="{scope}"/></xacro:macro>
        <xacro:set v="4"/>
        <link name="a" x="${{p}}"/>"""
    )
    x_attribute = x.named("a").attributes["x"]
    assert x_attribute.value == "8"
    assert x.origins(x_attribute) == {"property[p]": "${v * 2}", "parameter[v]": "4"}


def test_a_default_of_a_macro_is_located_in_its_parameters(expand_text: Expand) -> None:
    x = expand_text(
        """
        <xacro:property name="mass" value="3"/>
        <xacro:macro name="m" params="name:=a
                                      mass:=^|5
                                      size:=^|'6 7'
                                      height=${8}">
          <link name="${name}" mass="${mass}" size="${size}" height="${height}"/>
        </xacro:macro>
        <xacro:m/>"""
    )
    link = x.named("a")
    places = {
        n: [x.place(d.span) for d in link.attributes[n].collect_definitions()]
        for n in ("name", "mass", "size", "height")
    }
    assert places == {
        "name": ["robot.xacro:3 name:=a"],
        "mass": ["robot.xacro:4 mass:=^|5", "robot.xacro:2 3"],  # forwarded: the property goes before the default
        "size": ["robot.xacro:5 size:=^|'6 7'"],
        "height": ["robot.xacro:6 height=${8}"],
    }


def test_an_argument_leads_to_its_declaration_however_it_is_read(expand_text: Expand) -> None:
    x = expand_text(
        """
        <xacro:property name="two" value="2"/>
        <xacro:arg name="size" default="${two}"/>
        <xacro:arg name="twice" default="$(eval 2*size)"/>
        <xacro:arg name="unused" default="0"/>
        <link name="a" arg="$(arg size)" eval="$(eval size)" call="${xacro.arg('size')}" twice="$(arg twice)"/>"""
    )
    link = x.named("a")
    one = {"argument[size]": "${two}", "property[two]": "2"}
    assert {n: x.origins(link.attributes[n]) for n in ("arg", "eval", "call")} == {"arg": one, "eval": one, "call": one}
    assert x.origins(link.attributes["twice"]) == {"argument[twice]": "$(eval 2*size)", **one}
    assert x.expansion.arguments_read == {"size", "twice"}


def test_an_argument_given_by_the_user_still_leads_to_its_declaration(expand_text: Expand) -> None:
    x = expand_text(
        '<xacro:arg name="size" default="${1}"/>${2}<link name="a" x="$(arg size)"/>', arguments={"size": "7"}
    )
    assert x.named("a").get("x") == "7"
    assert x.origins(x.named("a").attributes["x"]) == {"argument[size]": "${1}"}


def test_a_macro_called_by_a_computed_name_is_called_from_that_place(expand_text: Expand) -> None:
    x = expand_text(
        """
        <xacro:macro name="wheel" params="n"><link name="${n}"/></xacro:macro>
        <xacro:property name="kind" value="wheel"/>
        <xacro:call macro="${kind}" n="a"/>"""
    )
    assert x.calls(x.named("a")) == ['<xacro:call macro="${kind}" n="a"/>']
    assert x.origins(x.named("a").attributes["name"]) == {"parameter[n]": "a"}


@pytest.mark.slow
def test_a_macro_that_calls_itself_a_number_of_times_is_no_problem(expand_text: Expand) -> None:
    x = expand_text(
        """
        <xacro:macro name="chain" params="n">
          <xacro:if value="${n}"><link name="l${n}"/><xacro:chain n="${n - 1}"/></xacro:if>
        </xacro:macro>
        <xacro:chain n="150"/>"""
    )
    assert len(x.root.children) == 150
    assert len(x.named("l1").via) == 150
    assert x.origins(x.named("l1").attributes["name"])["parameter[n]"] == "150"  # where it began


# -- what goes wrong ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("body", "place"),
    [
        ('\n<link name="${no}"/>', "robot.xacro:2 ${no}"),
        ('<link name="a"/>\n<xacro:if value="${no}"/>', "robot.xacro:2 ${no}"),
        ('<link name="a"/>\n<xacro:unless value="maybe"/>', "robot.xacro:2 maybe"),
        ('<a>\n<b x="1"/>${no}</a>', "robot.xacro:1 <a>"),
        ('<xacro:property name="p" value="${no}"/>\n<link name="${p}"/>', "robot.xacro:2 ${p}"),
        ('\n<xacro:property name="p" value="${no}" lazy_eval="false"/>', "robot.xacro:2 ${no}"),
        ('\n<xacro:arg name="a" default="${no}"/>', "robot.xacro:2 ${no}"),
        ('<link>\n<xacro:attribute name="x" value="${no}"/></link>', "robot.xacro:2 ${no}"),
        ('\n<xacro:element xacro:name="${no}"/>', "robot.xacro:2 ${no}"),
        ('\n<xacro:insert_block name="no"/>', 'robot.xacro:2 <xacro:insert_block name="no"/>'),
        ('\n<xacro:no/>', "robot.xacro:2 <xacro:no/>"),
        ('\n<xacro:call macro="no"/>', 'robot.xacro:2 <xacro:call macro="no"/>'),
        ('\n<xacro:include filename="no.xacro"/>', 'robot.xacro:2 <xacro:include filename="no.xacro"/>'),
        ('\n<xacro:include filename="${no}.xacro"/>', "robot.xacro:2 ${no}.xacro"),
        ('<xacro:macro name="m" params="x"/>\n<xacro:m x="${no}"/>', "robot.xacro:2 ${no}"),
        ('<xacro:macro name="m" params="x"/>\n<xacro:m/>', "robot.xacro:2 <xacro:m/>"),
        ('<xacro:macro name="m" params="x:=${no}"/>\n<xacro:m/>', "robot.xacro:2 <xacro:m/>"),
        ('\n<xacro:macro params="x"/>', 'robot.xacro:2 <xacro:macro params="x"/>'),
        ('\n<xacro:property name="not a name" value="1"/>', 'robot.xacro:2 <xacro:property name="not a name" value="1"/>'),
    ],
)  # fmt: skip
def test_a_failure_is_located_where_it_was_typed(expand_text: Expand, body: str, place: str) -> None:
    x = expand_text(body)
    assert x.problem.kind == "expansion-failed"
    assert x.place(x.problem.location.span) == place
    assert x.problem.location.via == ()


def test_a_failure_in_a_macro_tells_the_calls_that_led_there(expand_text: Expand) -> None:
    x = expand_text(
        """
        <xacro:macro name="inner" params="v"><link name="${v + no}"/></xacro:macro>
        <xacro:macro name="outer"><xacro:inner v="1"/></xacro:macro>
        <xacro:outer/>"""
    )
    location = x.problem.location
    assert location.subject == "xacro:macro[inner]/link[${v + no}]@name"
    assert [x.text(span) for span in location.via] == ["<xacro:outer/>", '<xacro:inner v="1"/>']
    assert x.problem.data["macros"] == ("outer", "inner")
    assert [r.subject for r in x.problem.related] == ["parameter[v]"]


def test_an_argument_without_a_value_is_told_apart_from_other_failures(expand_text: Expand) -> None:
    for expression in ("$(arg model)", "${xacro.arg('model')}"):
        x = expand_text(f'<xacro:arg name="other" default="1"/>\n<link name="{expression}"/>')
        assert (x.problem.kind, x.problem.data["argument"]) == ("argument-missing", "model")
        assert x.place(x.problem.location.span) == f"robot.xacro:2 {expression}"


def test_an_unknown_package_is_told_apart_from_other_failures(expand_text: Expand) -> None:
    x = expand_text('\n<xacro:include filename="$(find nowhere)/a.xacro"/>')
    assert (x.problem.kind, x.problem.data["package"]) == ("package-not-found", "nowhere")
    assert x.place(x.problem.location.span) == "robot.xacro:2 $(find nowhere)/a.xacro"


def test_a_broken_included_file_is_reported_in_that_file(expand_text: Expand) -> None:
    x = expand_text(
        '<xacro:macro name="m"><xacro:include filename="i.xacro"/></xacro:macro><xacro:m/>',
        {"i.xacro": "<robot>\n<link></robot>"},
    )
    location = x.problem.location
    assert x.problem.kind == "malformed"
    assert location.span is not None
    assert (location.span.file, location.span.line) == ("i.xacro", 2)
    assert [x.text(span) for span in location.via] == ["<xacro:m/>", '<xacro:include filename="i.xacro"/>']


@pytest.mark.parametrize(
    ("content", "kind"),
    [
        ('<!DOCTYPE r [<!ENTITY e "x">]><robot name="&e;"/>', "doctype"),
        ("<robot><xacro:m/></robot>", "prefix"),
        ('<robot xmlns:a="u" xmlns:b="u"><link a:x="1" b:x="2"/></robot>', "malformed"),
        ("<a>" * 300 + "</a>" * 300, "too-large"),
    ],
)
def test_what_must_not_be_read_is_refused_in_included_files_too(expand_text: Expand, content: str, kind: str) -> None:
    x = expand_text('<xacro:include filename="i.xacro"/>', {"i.xacro": content}, like_plain=False)
    assert x.problem.kind == kind
    assert x.problem.location.span is not None
    assert x.problem.location.span.file == "i.xacro"


@pytest.mark.slow
def test_a_macro_without_end_is_located_where_the_circle_closes(expand_text: Expand) -> None:
    x = expand_text(
        """
        <xacro:macro name="a" params="n"><xacro:b n="${n + 1}"/></xacro:macro>
        <xacro:macro name="b" params="n"><xacro:a n="${n + 1}"/></xacro:macro>
        <xacro:a n="0"/>"""
    )
    location = x.problem.location
    assert "never ends" in x.problem.message
    assert x.place(location.span) == 'robot.xacro:2 <xacro:b n="${n + 1}"/>'
    assert [x.text(span)[:9] for span in location.via] == ["<xacro:a ", "<xacro:b ", "<xacro:a "]


def test_an_include_that_leads_back_to_itself_is_located_where_the_circle_closes(expand_text: Expand) -> None:
    x = expand_text(
        '\n<xacro:include filename="i.xacro"/>',
        {"i.xacro": MACRO_FILE.format('\n<xacro:include filename="robot.xacro"/>')},
    )
    assert "include cycle" in x.problem.message
    assert x.place(x.problem.location.span) == 'robot.xacro:2 <xacro:include filename="i.xacro"/>'
    assert len(x.problem.location.via) == 2


def test_files_that_include_each_other_under_a_condition_are_no_circle(expand_text: Expand) -> None:
    x = expand_text(
        """
        <xacro:property name="seen" default="0"/>
        <xacro:unless value="${seen}">
          <xacro:property name="seen" value="1"/>
          <xacro:include filename="i.xacro"/>
        </xacro:unless>
        <xacro:include filename="part.xacro"/>""",
        {
            "i.xacro": MACRO_FILE.format('<xacro:include filename="robot.xacro"/>'),
            "part.xacro": MACRO_FILE.format("<link/>"),
        },
    )
    assert len(x.root.children) == 2


def test_properties_in_a_circle_end_as_a_problem_that_names_them(expand_text: Expand) -> None:
    x = expand_text(
        '<xacro:property name="a" value="${b}"/><xacro:property name="b" value="${a}"/>\n<link name="${a}"/>'
    )
    assert "circular" in x.problem.message
    assert {r.subject for r in x.problem.related} == {"property[a]", "property[b]"}


def test_many_properties_computed_from_each_other_take_no_exponential_time(expand_text: Expand) -> None:
    rows = "".join(
        f'<xacro:property name="a{n}" value="${{a{n - 1} + b{n - 1}}}"/>'
        f'<xacro:property name="b{n}" value="${{a{n - 1} - b{n - 1}}}"/>'
        for n in range(1, 60)
    )
    x = expand_text(
        f'<xacro:property name="a0" value="1"/><xacro:property name="b0" value="1"/>{rows}<link name="x" v="${{a59}}"/>'
    )
    assert len(x.named("x").attributes["v"].collect_definitions()) == 119


def test_what_xacro_warns_of_is_noted_with_its_place(expand_text: Expand) -> None:
    x = expand_text('\n<xacro:property name="pi" value="3"/>')
    (warning,) = x.expansion.problems
    assert warning.kind == "xacro-warning"
    assert "redefining global symbol: pi" in warning.message
    assert warning.location.span is not None
    assert warning.location.span.line == 2


def test_nothing_is_printed_and_no_state_of_xacro_is_left_behind(
    expand_text: Expand, capfd: pytest.CaptureFixture[str], recwarn: pytest.WarningsRecorder
) -> None:
    import xacro

    before = (xacro.eval_all, xacro.Table._setitem, dict(xacro._global_symbols), sys.getrecursionlimit())
    capfd.readouterr()
    expand_text(
        r"""<xacro:property name="pi" value="3"/><link name="${1 is 1}" x="${'\d'}"/><xacro:no/>""", like_plain=False
    )  # plain xacro shows Python's warnings
    expand_text(r"""<link name="${1 is 1}" x="${'\d'}"/>""", like_plain=False)
    assert capfd.readouterr() == ("", "")
    assert [str(w.message) for w in recwarn] == []
    assert before == (xacro.eval_all, xacro.Table._setitem, dict(xacro._global_symbols), sys.getrecursionlimit())


# -- the same expansion as plain xacro ---------------------------------------------------------------------------------


def assert_located(expansion: Expansion) -> None:
    """Every element and attribute has a span, and the text there is what the attribute says was typed."""
    assert expansion.root is not None
    for element in expansion.root.walk():
        assert element.span is not None, element.subject
        assert expansion.files[element.span.file].text[element.span.start] == "<"
        for attribute in element.attributes.values():
            span = attribute.span
            assert span is not None, attribute.location.subject
            assert expansion.files[span.file].text[span.start : span.end] == attribute.typed
            if attribute.literal:
                assert attribute.value.split() == attribute.typed.split()
        for span in element.via:
            assert expansion.files[span.file].text[span.start] == "<"


@pytest.mark.parametrize(
    "path", sorted(FIXTURES.glob("car-3*/**/*.urdf.xacro")), ids=lambda p: p.relative_to(FIXTURES).as_posix()
)
def test_the_fixtures_expand_to_the_byte_as_with_plain_xacro(path: Path, assert_like_plain: LikePlain) -> None:
    finder = PackageFinder(path)
    expansion = expand_xacro(path, {}, finder)
    assert_located(expansion)
    assert_like_plain(expansion, path, {}, finder)


def test_real_robots_expand_to_the_byte_as_with_plain_xacro(corpus: Path, assert_like_plain: LikePlain) -> None:
    """A file of each repository that expands, and one that does not. All of them with ``URDFCHECK_FULL=1``."""
    entries = [entry for entry in list_robots(corpus) if entry["entry"].endswith(".xacro")]
    assert entries
    for entry in select_by_trait(entries, lambda entry: [(entry["id"].partition(":")[0], entry["expands"])]):
        path = corpus / entry["entry"]
        finder = PackageFinder(path, paths=[corpus / root for root in entry["package_roots"]])
        expansion = expand_xacro(path, entry["xacro_args"], finder)
        assert (expansion.root is not None) == entry["expands"], entry["id"]
        if expansion.root is not None:
            assert_located(expansion)
        assert_like_plain(expansion, path, entry["xacro_args"], finder)


def _problems(tmp_path: Path, body: str) -> list[tuple[str, int]]:
    path = tmp_path / "robot.urdf.xacro"
    path.write_text(f'<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">\n{body}\n</robot>')
    problems = expand_xacro(path, {}, PackageFinder(path, environment={})).problems
    return [(p.kind, 0 if p.location.span is None else p.location.span.line) for p in problems]


@pytest.mark.parametrize(
    "body",
    [
        """<xacro:if value="${'$(optenv ROS_DISTRO none)' != 'none'}"><a/></xacro:if>""",
        """<xacro:arg name="v" default="$(optenv ROS_VERSION 0)"/>\n<xacro:if value="$(eval v == 2)"><a/></xacro:if>""",
        """<xacro:include filename="$(optenv ROS_DISTRO none).xacro"/>""",
        """<a b="${1 if '$(optenv ROS_DISTRO none)' == 'humble' else 2}"/>""",
        """<xacro:property name="d" value="$(optenv ROS_DISTRO none)"/>\n<xacro:if value="${d == 'x'}"><a/></xacro:if>""",
        """<xacro:arg name="d" default="$(optenv ROS_DISTRO no)"/>\n<xacro:unless value="${'$(arg d)' == ''}"/>""",
        """<xacro:property name="d" value="$(optenv ROS_PYTHON_VERSION 3)"/>\n<a b="${dict([(2, 1)]).get(d, 2)}"/>""",
    ],
)  # fmt: skip
def test_what_decides_by_a_variable_of_ros_is_told(tmp_path: Path, body: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("ROS_DISTRO", raising=False)
    (tmp_path / "none.xacro").write_text("<robot/>")
    assert _problems(tmp_path, body) == [("environment-decides", 2 + body.count("\n"))]


@pytest.mark.parametrize(
    "body",
    [
        """<a b="x_$(optenv ROS_DISTRO none)"/>""",
        """<xacro:property name="d" value="$(optenv ROS_DISTRO none)"/><a b="x_${d}"/>""",
        """<xacro:if value="${1 == 1}"><a b="$(optenv ROS_DISTRO none)"/></xacro:if>""",
        """<xacro:property name="d" value="$(dirname)"/><a b="file://${d}/a.stl" c="${d + '/b.stl'}" e="${'%s/c' % d}"/>""",
        """<a b="${'/'.join(['$(dirname)', 'a'])}" d="${len('a') == 1}"/>""",
    ],
)
def test_what_is_only_written_decides_nothing(tmp_path: Path, body: str) -> None:
    assert _problems(tmp_path, body) == []


@pytest.mark.parametrize(
    "expression",
    [
        "'/share/' in '$(dirname)'",
        "'$(dirname)' == '/opt/robot'",
        "'$(dirname)/x'.startswith('/opt')",
        "'$(dirname)'.split('/')[1] == 'opt'",
        "'$(dirname)'[1] == 'o'",
        "len('$(dirname)') == 4",
        "[c for c in '$(dirname)'][1] == 'o'",
        "xacro.abs_filename('a.yaml').find('opt') == 1",
        "here &lt; '/m'",
        "dict([('/opt', 1)]).get(here, 0)",
        "python.sum(ord_ == 'o' for ord_ in here)",
        "here in ['/opt']",
        "'x'.join([here]).count('/') == 3",
        "'%.4s' % here == '/opt'",
        "'%(here).4s' % dict(here=here) == '/opt'",
        "('%c:.4%c' % (123, 125)).format(here) == '/opt'",
        "'/-o-p-t' in '-'.join(here)",
        "str.join('-', here) == '/-o-p-t'",
        "[[here]] == [['/opt']]",
        "'/opt' in dict(a=here).values()",
        "not python.set([here]) - python.set(['/opt'])",
        "[dict(a=[here])].count(dict(a=['/opt'])) == 1",
    ],
)
def test_what_decides_by_the_place_of_a_file_is_told(tmp_path: Path, expression: str) -> None:
    body = f"""<xacro:property name="here" value="$(dirname)"/>\n<xacro:if value="${{{expression}}}"><a/></xacro:if>"""
    assert ("place-decides", 3) in _problems(tmp_path, body)


def test_a_variable_of_ros_can_be_given_like_an_argument(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_DISTRO", "jazzy")
    path = tmp_path / "robot.urdf.xacro"
    path.write_text('<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="$(env ROS_DISTRO)"/>')
    for arguments, name in (({}, "jazzy"), ({"env:ROS_DISTRO": "noetic"}, "noetic")):
        root = expand_xacro(path, arguments, PackageFinder(path, environment={})).root
        assert root is not None
        assert root.get("name") == name


def test_the_distributions_are_values_of_what_a_model_may_decide_by(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROS_DISTRO", "mine")
    path = tmp_path / "robot.urdf.xacro"
    text = '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="$(env {})">{}</robot>'
    finder = PackageFinder(path, environment={})
    path.write_text(text.format("ROS_DISTRO", "<!-- $(env ROS_VERSION) --><a b='$(env ROS_VERSION)'/>"))
    assert find_argument_choices(path, finder) == []
    decides = """<xacro:if value="${'$(optenv ROS_DISTRO none)' == 'none'}"><a/></xacro:if>"""
    path.write_text(text.format("ROS_VERSION", decides))
    (choice,) = find_argument_choices(path, finder)
    assert (choice.name, choice.default, choice.values[0]) == ("env:ROS_DISTRO", "mine", "mine")
    assert {"noetic", "humble", "jazzy"} < set(choice.values)
    assert {"env:ROS_DISTRO": "humble"} in build_argument_sets([choice])
    assert {} in build_argument_sets([choice])
