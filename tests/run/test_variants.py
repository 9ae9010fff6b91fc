"""A xacro with arguments is many robots: which ones, and what is told of a defect that only some of them have."""

from __future__ import annotations

import json
from dataclasses import replace
from itertools import combinations, product
from pathlib import Path

import pytest
from conftest import check
from hypothesis import given, settings
from hypothesis import strategies as st

from urdfcheck.core import Run, Severity
from urdfcheck.policy.config_resolver import ConfigResolver
from urdfcheck.source.package.finder import PackageFinder
from urdfcheck.source.xacro.argument_values import (
    MOST_COMBINATIONS,
    ArgumentChoice,
    build_argument_sets,
    find_argument_choices,
)

pytestmark = pytest.mark.slow

XACRO = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">{}</robot>'
INERTIAL = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="{}"/></inertial>'
BROKEN = f'<link name="{{}}">{INERTIAL.format(9)}</link>'


def write_xacro(folder: Path, text: str, name: str = "r.urdf.xacro") -> Path:
    path = folder / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(XACRO.format(text), encoding="utf-8")
    return path


def values(path: Path) -> dict[str, tuple[str, ...]]:
    """The arguments of a xacro with the values that are known, the default first."""
    return {c.name: c.values for c in find_argument_choices(path, PackageFinder(path))}


class TestValues:
    @pytest.mark.parametrize(
        ("default", "use", "expected"),
        [
            ("true", "", ("true", "false")),
            ("False", "", ("False", "True")),
            ("1", '<xacro:if value="$(arg a)"/>', ("1", "0")),
            ("$(optenv ARM 0)", '<xacro:unless value="$(arg a)"/>', ("0", "1")),
            ("1", '<link name="l$(arg a)"/>', None),
            ("left", "<xacro:if value=\"${'$(arg a)' == 'right'}\"/>", ("left", "right")),
            ("left", "<xacro:if value=\"${'right' != '$(arg a)'}\"/>", ("left", "right")),
            ("left", "<xacro:if value=\"${xacro.arg('a') in ['right', 'both']}\"/>", ("left", "right", "both")),
            ("x", '<xacro:property name="p" value="$(arg a)"/><link name="${1 if p == \'y\' else 2}"/>', ("x", "y")),
            ("x", '<xacro:macro name="m" params="q"><xacro:if value="${q == \'y\'}"/></xacro:macro><xacro:m q="$(arg a)"/>',
             ("x", "y")),
            ("x", '<xacro:macro name="m" params="q"><xacro:if value="${q == \'y\'}"/></xacro:macro><xacro:m q="z"/>', None),
            ("x", "<xacro:if value=\"${'$(arg a)' == '$(arg b)'}\"/>", None),
            ("0 0 0", '<origin xyz="$(arg a)"/>', None),
        ],
    )  # fmt: skip
    def test_that_the_text_asks_for(
        self, default: str, use: str, expected: tuple[str, ...] | None, tmp_path: Path
    ) -> None:
        path = write_xacro(tmp_path, f'<xacro:arg name="a" default="{default}"/>{use}')
        assert values(path).get("a") == expected

    def test_keys_of_a_dictionary_and_files(self, tmp_path: Path) -> None:
        for name in ("small", "large"):
            write_xacro(tmp_path, "", f"config/{name}/arm.xacro")
        (tmp_path / "config/notes").mkdir()
        (tmp_path / "colours.yaml").write_text("red: 1\nblue: 2\n")
        path = write_xacro(
            tmp_path,
            '<xacro:arg name="size" default="small"/><xacro:arg name="colour" default="red"/>'
            '<xacro:include filename="config/$(arg size)/arm.xacro"/>'
            '<xacro:property name="all" value="${xacro.load_yaml(\'$(dirname)/colours.yaml\')}"/>'
            '<xacro:property name="mine" value="$(arg colour)"/><link name="${all[mine]}"/>',
        )
        assert values(path) == {"size": ("small", "large"), "colour": ("red", "blue")}

    def test_files_of_packages(self, tmp_path: Path) -> None:
        (tmp_path / "package.xml").write_text("<package><name>arms</name></package>")
        for name in ("small", "large"):
            write_xacro(tmp_path, "", f"config/{name}.xacro")
        text = (
            '<xacro:arg name="size" default="small"/><xacro:include filename="$(find arms)/config/$(arg size).xacro"/>'
        )
        path = write_xacro(
            tmp_path,
            f'{text}<xacro:include filename="$(find arms)$(find arms)"/><xacro:include filename="$(find no)/a"/>',
        )
        assert values(path) == {"size": ("small", "large")}

    @pytest.mark.parametrize(
        ("default", "expected"), [("6", ("6", "5")), ("", ("", "5", "6", "_gripper")), ("_gripper", None)]
    )
    def test_a_further_word_of_a_file_name_is_no_value(
        self, default: str, expected: tuple[str, ...] | None, tmp_path: Path
    ) -> None:
        for name in ("arm5", "arm6", "arm_gripper"):
            write_xacro(tmp_path, "", f"{name}.xacro")
        text = f'<xacro:arg name="a" default="{default}"/><xacro:include filename="arm$(arg a).xacro"/>'
        assert values(write_xacro(tmp_path, text))["a"] == (expected or ("_gripper", "5", "6"))

    @pytest.mark.parametrize(
        ("calls", "expected"),
        [
            ("<xacro:omx_f/>", ("omx_f", "omx_f_mock")),
            ("<xacro:omy/>", ("omx_f", "omy")),
            ('<xacro:include filename="control/omy.xacro"/><xacro:omy/><xacro:omx_f/>', ("omx_f", "omx_f_mock")),
            ("<xacro:never/>", ("omx_f", "omx_f_mock", "omy")),
            ("", ("omx_f", "omx_f_mock", "omy")),
            ('<xacro:if value="$(arg a)"><xacro:omx_f/></xacro:if>', ("omx_f", "omx_f_mock", "omy")),
            ('<xacro:macro name="omx_f"/><xacro:omx_f/>', ("omx_f", "omx_f_mock", "omy")),
        ],
    )
    def test_only_files_with_the_macros_that_are_called(
        self, calls: str, expected: tuple[str, ...], tmp_path: Path
    ) -> None:
        """A folder holds the files of all robots: each robot can be expanded with its own only."""
        for name, macro in (("omx_f", "omx_f"), ("omx_f_mock", "omx_f"), ("omy", "omy")):
            write_xacro(
                tmp_path, f'<xacro:macro name="{macro}"><link name="l"/></xacro:macro>', f"control/{name}.xacro"
            )
        text = '<xacro:arg name="a" default="omx_f"/><xacro:include filename="control/$(arg a).xacro"/>'
        assert values(write_xacro(tmp_path, text + calls))["a"] == expected

    def test_of_included_files_too(self, tmp_path: Path) -> None:
        write_xacro(tmp_path, '<xacro:arg name="a" default="true"/>', "inner.xacro")
        assert values(write_xacro(tmp_path, '<xacro:include filename="inner.xacro"/>')) == {"a": ("true", "false")}

    def test_nothing_outside_is_looked_at(self, tmp_path: Path) -> None:
        (tmp_path / "home" / ".git").mkdir(parents=True)
        for name in ("alice", "bob"):
            write_xacro(tmp_path, "", f"secret/{name}.xacro")
        text = '<xacro:arg name="a" default="x"/><xacro:include filename="../secret/$(arg a).xacro"/>'
        run = check(write_xacro(tmp_path / "home", text), all_arguments=True)
        assert len(run.models) == 1


class TestSets:
    def test_few_are_all_combined(self) -> None:
        given = [ArgumentChoice("a", "1", ("1", "2")), ArgumentChoice("b", None, ("x", "y"))]
        assert build_argument_sets(given) == [{"b": "x"}, {"b": "y"}, {"a": "2", "b": "x"}, {"a": "2", "b": "y"}]

    @settings(max_examples=40)
    @given(st.lists(st.integers(2, 5), min_size=1, max_size=12))
    def test_many_have_each_value_alone_and_each_pair_together(self, sizes: list[int]) -> None:
        known = [ArgumentChoice(f"a{i}", "0", tuple(map(str, range(size)))) for i, size in enumerate(sizes)]
        found = [{c.name: "0" for c in known} | row for row in build_argument_sets(known)]
        count = 1
        for size in sizes:
            count *= size
        if count <= MOST_COMBINATIONS:
            assert len(found) == count
        for first, second in combinations(known, 2):
            pairs = {(row[first.name], row[second.name]) for row in found}
            assert pairs == set(product(first.values, second.values))
        assert sum(len(row) == 1 for row in build_argument_sets(known)) >= sum(size - 1 for size in sizes)
        alone = 1 + sum(size - 1 for size in sizes)
        assert len(found) <= max(MOST_COMBINATIONS, alone + 3 * max(sizes) ** 2)


def three(folder: Path, condition: str, more: str = "") -> Run:
    """A robot of six switches, with a defect where a condition on them holds."""
    text = "".join(
        f'<xacro:arg name="s{i}" default="false"/><xacro:property name="p{i}" value="$(arg s{i})"/>' for i in range(6)
    )
    text += f'<link name="base"/><xacro:if value="${{{condition}}}">{BROKEN.format("bad")}</xacro:if>{more}'
    return check(write_xacro(folder, text), codes={"INR003", "XAC001"}, all_arguments=True)


class TestFindings:
    def test_what_all_show_is_one_finding_of_the_plain_model(self, tmp_path: Path) -> None:
        run = three(tmp_path, "True")
        (found,) = run.findings
        assert found.model == "r.urdf.xacro"
        assert set(found.variants) == {m.id for m in run.models}
        assert run.find_variant_arguments(found) == {}

    @pytest.mark.parametrize(
        ("condition", "expected"),
        [
            ("p3", "s3:=true"),
            ("p1 and p4", "s1:=true s4:=true"),
            ("p0 and p2 and p5", "s0:=true s2:=true s5:=true"),
            ("not p1 and p2", "s2:=true"),
        ],
    )
    def test_the_smallest_set_of_arguments_is_told(self, condition: str, expected: str, tmp_path: Path) -> None:
        run = three(tmp_path, condition)
        if condition.count("and p") == 2 and not run.findings:
            pytest.skip("three at once are in no pair")
        (found,) = run.findings
        assert found.model == f"r.urdf.xacro {expected}"
        assert run.find_variant_arguments(found) == dict(word.split(":=") for word in expected.split())

    def test_a_variant_that_cannot_be_expanded_is_an_error_with_its_arguments(self, tmp_path: Path) -> None:
        run = three(tmp_path, "False", '<xacro:if value="${p2 and p3}"><link name="${nothing}"/></xacro:if>')
        (found,) = run.findings
        assert (found.code, found.model) == ("XAC001", "r.urdf.xacro s2:=true s3:=true")
        assert {m.status for m in run.models} == {"checked", "failed"}

    def test_a_switch_that_breaks_everything_hides_nothing_else(self, tmp_path: Path) -> None:
        """The sets that have each pair of values together all have the broken switch in them."""
        broken = '<xacro:if value="${p0 or p5}"><link name="${nothing}"/></xacro:if>'
        run = three(tmp_path, "p1 and p4", broken)
        assert [(f.code, f.model) for f in run.findings] == [
            ("XAC001", "r.urdf.xacro s0:=true"),
            ("INR003", "r.urdf.xacro s1:=true s4:=true"),
        ]

    def test_what_the_user_gives_is_not_varied(self, tmp_path: Path) -> None:
        path = write_xacro(
            tmp_path, '<xacro:arg name="a" default="true"/><xacro:arg name="b" default="true"/><link name="l"/>'
        )
        run = check(path, all_arguments=True, arguments={"a": "true"})
        assert [dict(m.args) for m in run.models] == [{"a": "true"}, {"a": "true", "b": "false"}]

    def test_what_the_configuration_gives_is_given_to_all(self, tmp_path: Path) -> None:
        """Without it there would be no model: the text has neither a default nor a value for it."""
        write_xacro(tmp_path, '<xacro:arg name="a" default="true"/><link name="$(arg n)"/>')
        (tmp_path / "urdfcheck.toml").write_text(
            '[[models]]\npath = "r.urdf.xacro"\narguments = { n = "l", a = "true" }\n'
        )
        run = check(tmp_path, all_arguments=True, config_resolver=ConfigResolver())
        assert [(dict(m.args), m.status) for m in run.models] == [
            ({"a": "false", "n": "l"}, "checked"),
            ({"a": "true", "n": "l"}, "checked"),
        ]

    def test_named_variants_are_told_together_too(self, tmp_path: Path) -> None:
        path = write_xacro(tmp_path, f'<xacro:arg name="n" default="1"/>{BROKEN.format("a")}')
        launch = tmp_path / "r.launch"
        launch.write_text(
            '<launch><param name="robot_description" command="xacro $(dirname)/r.urdf.xacro n:=2"/></launch>'
        )
        run = check(path, launch, codes={"INR003"})
        assert [(f.model, list(f.variants)) for f in run.findings] == [
            ("r.urdf.xacro", ["r.urdf.xacro", "r.urdf.xacro n:=2"])
        ]

    def test_one_text_is_one_finding_whatever_the_arguments_call_it(self, tmp_path: Path) -> None:
        text = f'<xacro:arg name="p" default="a"/><xacro:if value="${{\'$(arg p)\' == \'b\'}}"/>{BROKEN.format("$(arg p)")}'
        run = check(write_xacro(tmp_path, text), codes={"INR003"}, all_arguments=True)
        (found,) = run.findings
        assert [subject.split("/")[0] for subjects in found.variants.values() for subject in subjects] == [
            "link[a]",
            "link[b]",
        ]

    def test_what_one_model_has_twice_stays_twice(self) -> None:
        """Else a baseline would know it once, and the second would be new."""
        from urdfcheck.core import Location
        from urdfcheck.rules import load_rules
        from urdfcheck.run.jobs import Unit
        from urdfcheck.run.shared_findings import merge_across_models

        rule = load_rules()["URC907"]
        finding = rule.finding("shadowed", at=Location("link[a]", None), library="x", path="y")
        units = [
            Unit(kind="model", path="r.xacro", id="r.xacro"),
            Unit(kind="model", path="r.xacro", id="r.xacro a:=1", arguments={"a": "1"}),
        ]
        merged = merge_across_models([replace(finding, model=unit.id) for unit in units for _ in range(2)], units)
        assert [list(f.variants) for f in merged] == [["r.xacro", "r.xacro a:=1"]] * 2

    def test_definitions_that_differ_are_two_places(self, tmp_path: Path) -> None:
        """The same line reads another property with each argument: one kind of mistake, to be repaired at both."""
        text = (
            '<xacro:arg name="p" default="a"/><xacro:property name="a" value="9"/><xacro:property name="b" value="8"/>'
            '<xacro:if value="${\'$(arg p)\' == \'a\'}"><xacro:property name="i" value="${a}"/></xacro:if>'
            '<xacro:if value="${\'$(arg p)\' == \'b\'}"><xacro:property name="i" value="${b}"/></xacro:if>'
            f'<link name="l">{INERTIAL.format("${i}")}</link>'
        )
        run = check(write_xacro(tmp_path, text), codes={"INR003"}, all_arguments=True)
        (finding,) = run.findings
        assert [(place.model, place.related[1].subject) for place in finding.occurrences] == [
            ("r.urdf.xacro", "property[a]"),
            ("r.urdf.xacro p:=b", "property[b]"),
        ]


class TestOutputs:
    @pytest.fixture
    def run(self, tmp_path: Path) -> Run:
        return three(tmp_path, "p1 and p4")

    def test_text_says_with_what(self, run: Run) -> None:
        from urdfcheck.output import text

        assert "\n  with  s1:=true s4:=true" in text.render(run)

    def test_json_lists_arguments_and_variants(self, run: Run) -> None:
        from urdfcheck.output.json import render as render_json

        (found,) = json.loads(render_json(run))["findings"]
        assert found["arguments"] == {"s1": "true", "s4": "true"}
        assert found["model"] in found["variants"]

    def test_html_says_with_what(self, run: Run) -> None:
        from urdfcheck.output import html

        assert "With <code>s1:=true</code> <code>s4:=true</code>" in html.render(run)


def test_the_command_does_it_in_its_workers(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    from urdfcheck import cli

    text = "<xacro:if value=\"${'$(arg side)' == 'left'}\">" + BROKEN.format("a") + '</xacro:if><link name="b"/>'
    path = write_xacro(tmp_path, f'<xacro:arg name="side" default="right"/>{text}')
    words = ["--select", "INR003", "--tier", "source", "--format", "json"]
    assert cli.main([str(path), *words]) == cli.OK
    capsys.readouterr()
    assert cli.main([str(path), *words, "--all-args"]) == cli.FINDINGS
    report = json.loads(capsys.readouterr().out)
    assert [m["args"] for m in report["models"]] == [{}, {"side": "left"}]
    assert [f["arguments"] for f in report["findings"]] == [{"side": "left"}]


HIDDEN_BEHIND = {
    "a distribution": ("${'$(optenv ROS_DISTRO none)' == 'humble'}", ["ROS_DISTRO:=humble"]),
    "any distribution": ("${'$(optenv ROS_DISTRO none)' != 'none'}", ["ROS_DISTRO:=noetic"]),
    "two variables": (
        "${'$(optenv ROS_DISTRO none)' == 'jazzy' and '$(optenv ROS_VERSION 0)' == '2'}",
        ["ROS_DISTRO:=jazzy env:ROS_VERSION:=2"],
    ),
    "no known value": ("${'$(optenv ROS_DISTRO none)' == 'nowhere'}", []),
}


@pytest.mark.parametrize("how", HIDDEN_BEHIND)
def test_the_robots_of_other_distributions_are_checked_too(
    how: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("ROS_DISTRO", "ROS_VERSION", "ROS_PYTHON_VERSION"):
        monkeypatch.delenv(name, raising=False)
    condition, environments = HIDDEN_BEHIND[how]
    path = write_xacro(
        tmp_path, f'<link name="base"/><xacro:if value="{condition}">{BROKEN.format("hand")}{TO_HAND}</xacro:if>'
    )
    run = check(path, codes={"INR003", "XAC016"})
    assert [info.id.partition(" env:")[2] for info in run.models] == ["", *environments]
    assert [f.code for f in run.findings].count("INR003") == bool(environments)
    assert [f.code for f in run.findings].count("XAC016") == 1


TO_HAND = '<joint name="j" type="fixed"><parent link="base"/><child link="hand"/></joint>'


def test_a_model_that_the_place_or_the_order_of_a_set_decides_is_an_error(tmp_path: Path) -> None:
    """An order that makes the same robot is none."""
    names = "list(python.set('a b c'.split()))"
    body = f'<link name="base"/><xacro:property name="names" value="${{{names}}}"/>'
    same = body + "".join(f'<link name="${{names[{place}]}}"/>' for place in range(3))
    (finding,) = check(write_xacro(tmp_path, same), codes={"XAC016"}).findings
    assert (finding.message_id, str(finding.severity)) == ("order", "info")
    for place in range(3):
        (finding,) = check(
            write_xacro(tmp_path, f'{body}<link name="${{names[{place}]}}"/>'), codes={"XAC016"}
        ).findings
        assert (finding.message_id, str(finding.severity)) == ("random", "error")
    text = """<link name="base"/><xacro:if value="${'/share/' in '$(dirname)'}"><link name="b"/></xacro:if>"""
    (finding,) = check(write_xacro(tmp_path, text), codes={"XAC016"}).findings
    assert (finding.message_id, str(finding.severity)) == ("place", "error")


def test_all_arguments_of_a_folder_with_a_part_that_a_model_is_made_of(tmp_path: Path) -> None:
    """The part is expanded only if no model is made of it: it has no report."""
    head = '<robot{} xmlns:xacro="http://www.ros.org/wiki/xacro">'
    (tmp_path / "part.xacro").write_text(head.format("") + '<link name="part"/></robot>')
    lift = '<xacro:arg name="lift" default="false"/><xacro:if value="$(arg lift)"><link name="lift"/></xacro:if>'
    include = '<xacro:include filename="part.xacro"/>'
    (tmp_path / "robot.urdf.xacro").write_text(head.format(' name="r"') + lift + include + "</robot>")
    run = check(tmp_path, all_arguments=True)
    assert not run.failures
    assert [finding.code for finding in run.findings if finding.severity is Severity.ERROR] == ["KIN005"]
