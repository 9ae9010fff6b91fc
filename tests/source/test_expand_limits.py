"""Expansions that are ended: by a limit, by the time, by what they may not read."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any
from xml.parsers import expat

import pytest

from urdfcheck.core.errors import ModelTimeout
from urdfcheck.model.motion.pinocchio_model import capture_stderr
from urdfcheck.source.package.finder import PackageFinder
from urdfcheck.source.reach import FileReach
from urdfcheck.source.text.problems import Problem
from urdfcheck.source.xacro import expansion_state as trace
from urdfcheck.source.xacro import tracer
from urdfcheck.source.xacro.expand import expand_xacro
from urdfcheck.source.xacro.expressions import guards
from urdfcheck.source.xacro.macro_parameters import parse_next_parameter

Expand = Callable[..., Any]

HEAD = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">'
TREE = (
    "".join(f'<xacro:macro name="m{i}">\n<xacro:m{i + 1}/><xacro:m{i + 1}/></xacro:macro>' for i in range(1, 40))
    + '<xacro:macro name="m40"><link name="a"/></xacro:macro>\n<xacro:m1/>'
)
BLOCKS = (
    '<xacro:property name="b0"><a/></xacro:property>'
    + "".join(
        f'<xacro:property name="b{i}"><xacro:insert_block name="b{i - 1}"/><xacro:insert_block name="b{i - 1}"/>'
        "</xacro:property>"
        for i in range(1, 40)
    )
    + '<xacro:insert_block name="b39"/>'
)


@pytest.mark.parametrize("body", [TREE, BLOCKS])
def test_a_tree_of_macros_or_blocks_that_doubles_is_too_large(
    expand_text: Expand, monkeypatch: pytest.MonkeyPatch, body: str
) -> None:
    monkeypatch.setattr(trace, "MAX_NODES", 2_000)
    problem = expand_text(body, like_plain=False).problem
    assert problem.kind == "too-large"
    assert problem.message.startswith("the model expands to more than 2,000 elements")
    assert (problem.data["what"], problem.data["limit"]) == ("expansion", 2_000)
    if body is TREE:
        assert problem.data["macros"][:3] == ("m1", "m2", "m3")
        assert "macro m40 alone was called" in problem.message


@pytest.mark.slow
@pytest.mark.parametrize(
    ("body", "typed"),
    [
        ("".join(f'<xacro:property name="p{i}" value="${{p{i - 1}}}${{p{i - 1}}}"/>\n' for i in range(1, 60)), "${p16}${p16}"),
        ("".join(f'<xacro:property name="p{i}" value="${{[p{i - 1}, p{i - 1}]}}"/>\n' for i in range(1, 60)), "[p15, p15]"),
    ],
)  # fmt: skip
def test_properties_that_double_end_at_the_one_that_is_too_large(expand_text: Expand, body: str, typed: str) -> None:
    x = expand_text(f'<xacro:property name="p0" value="abcdefghij"/>{body}<link name="${{p59}}"/>', like_plain=False)
    assert (x.problem.kind, x.problem.data["refusal"]) == ("unsafe-expression", "too_large")
    assert x.problem.data["expression"] == typed


@pytest.mark.slow
def test_arguments_that_double_end_there_too(expand_text: Expand) -> None:
    body = "".join(f'<xacro:arg name="p{i}" default="$(arg p{i - 1})$(arg p{i - 1})"/>\n' for i in range(1, 60))
    x = expand_text(f'<xacro:arg name="p0" default="1234567890"/>\n{body}', like_plain=False)
    assert x.problem.data["refusal"] == "too_large"
    assert x.place(x.problem.location.span) == "robot.xacro:18 $(arg p16)$(arg p16)"


@pytest.mark.parametrize(
    "text",
    ["$a" * 100_000, "${'x' * 999999}${'x' * 999999}", "$(arg ${long})"],
)
def test_a_text_that_takes_too_long_to_take_apart_is_refused(expand_text: Expand, text: str) -> None:
    commands = "${('a) $' + '\\x28arg ') * 99 + 'a'}"
    body = f"""<xacro:arg name="a" default="{"x" * 100_000}"/><xacro:property name="long" value="{commands}"/>"""
    x = expand_text(f'{body}<link name="{text}"/>', like_plain=False)
    assert (x.problem.kind, x.problem.data["refusal"]) == ("unsafe-expression", "too_large")


@pytest.mark.parametrize("name", ["-" * 100_000 + "1", "1+" * 50_000 + "1", "(" * 100_000, "a b", "1", "True"])
def test_a_name_that_is_none_is_told_however_it_is_nested(expand_text: Expand, name: str) -> None:
    x = expand_text(f'<xacro:property name="{name}" value="1"/>', like_plain=False)
    assert x.problem.kind == "expansion-failed"
    assert x.problem.message.startswith("Property names must be valid python identifiers")
    assert len(x.problem.message) <= 20_000


def test_steps_that_many_expressions_take_together_are_counted(
    expand_text: Expand, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(guards, "MAX_STEPS", 5_000)
    body = """<xacro:macro name="m"><a b="${len([0 for i in python.range(1000)])}"/></xacro:macro>"""
    assert expand_text(body + "<xacro:m/>" * 3).expansion.root is not None
    assert expand_text(body + "<xacro:m/>" * 9, like_plain=False).problem.data["refusal"] == "too_large"


@pytest.mark.parametrize("quotes", [1, 43])
def test_a_quote_that_is_never_closed_takes_no_time(expand_text: Expand, quotes: int) -> None:
    parameter = "x:=" + "a" * 60 + "'" * quotes
    assert parse_next_parameter(f"{parameter} y") == (parameter, None, "y")
    expand_text(f'<xacro:macro name="m" params="{parameter}"/>', like_plain=False)


@pytest.mark.parametrize(
    "params",
    ["a", "a b:=1 c", "*b **c", "x:=^ y:=^|2 z=${1 + 1} w:='a b' v:=\"q r\" t", "a:= b", "p:=$(arg x) q", "  a   b ",
     "x:='it' 's y", "x:=a'b c'd e", "y:=${a} }", "x:=$(find p)/q r", "a:=b:=c", "x:='a'b' c", "=1", "x:==2", "x:=^|'a b' c"],
)  # fmt: skip
def test_parameters_are_taken_apart_as_xacro_does(params: str) -> None:
    from xacro import parse_macro_arg

    rest = params
    while rest.strip():
        assert parse_next_parameter(rest) == parse_macro_arg(rest)
        rest = parse_next_parameter(rest)[2]


def problem_of(folder: Path, body: str, *, reach: Path) -> Problem:
    (folder / "robot.xacro").write_text(f"{HEAD}{body}</robot>")
    finder = PackageFinder(folder, environment={}, reach=FileReach((str(reach.resolve()),)))
    expansion = expand_xacro(folder / "robot.xacro", {}, finder)
    assert expansion.root is None
    return expansion.problems[-1]


@pytest.mark.parametrize(
    ("body", "line"),
    [
        ('\n<xacro:include filename="../secret.xacro"/>', 2),
        ('\n<xacro:include filename="../*.xacro"/>', 2),
        ('\n<xacro:include filename="*/../../*"/>', 2),
        ('\n<xacro:include filename="[f]older/../../secret.xacro"/>', 2),
        ('\n<xacro:include filename="[f]older/../../none.xacro"/>', 2),  # nor does it tell that it is not there
        ('\n<xacro:include filename="link/*.xacro"/>', 2),
        ('\n<xacro:include filename="link/secret.xacro" optional="true"/>', 2),
        ('\n<xacro:include filename="/etc/host*"/>', 2),
        ("""\n<link name="${xacro.load_yaml('../secret.yaml')}"/>""", 2),
        ("""\n<link name="${xacro.load_yaml('/etc/hostname')}"/>""", 2),
        ("""<xacro:property name="p" value="${xacro.load_yaml('/nowhere/secret')}"/>\n<link name="${p}"/>""", 2),
    ],
)
def test_what_lies_out_of_reach_is_not_opened(tmp_path: Path, body: str, line: int) -> None:
    inside = tmp_path / "inside"
    (inside / "folder").mkdir(parents=True)
    (inside / "link").symlink_to(tmp_path)
    (tmp_path / "secret.xacro").write_text(f'{HEAD}<link name="secret"/></robot>')
    (tmp_path / "secret.yaml").write_text("secret")
    problem = problem_of(inside, body, reach=inside)
    assert problem.kind == "out-of-reach"
    assert problem.data["path"]
    assert problem.location.span is not None
    assert problem.location.span.line == line


@pytest.mark.parametrize(
    "body",
    [
        """<link name="a"><xacro:attribute name="x y='1'&gt;" value="1"/></link>""",
        """<xacro:element xacro:name="a b='1'" c="1"/>""",
        """<xacro:element xacro:name="a/&gt;&lt;link" c="1"/>""",
    ],
)
def test_what_would_be_no_xml_is_no_model(tmp_path: Path, body: str) -> None:
    problem = problem_of(tmp_path, f"\n{body}", reach=tmp_path)
    assert problem.kind == "expansion-failed"
    assert "is not a valid name of an element or attribute" in problem.message


@pytest.mark.parametrize("expression", ["y.b % 1", "y.b * 300000000", "str(y.b * 900000)"])
def test_bytes_are_bounded_as_texts_are(tmp_path: Path, expression: str) -> None:
    (tmp_path / "y.yaml").write_text("b: !!binary JTk5OTk5OTk5OWQ=\n")
    problem = problem_of(
        tmp_path, f"""<link name="a${{[{expression} for y in [xacro.load_yaml('y.yaml')]]}}"/>""", reach=tmp_path
    )
    assert problem.kind == "unsafe-expression"


def test_a_pattern_within_reach_finds_what_glob_finds(expand_text: Expand, tmp_path: Path) -> None:
    part = '<robot xmlns:xacro="u"><link name="{}"/></robot>'
    names = ["a/x.xacro", "a/.hidden.xacro", "b/y.xacro", "b/z.txt", "x.xacro"]
    x = expand_text(
        '<xacro:include filename="[ab]/?.xacro"/><xacro:include filename="./*/none*.xacro"/>',
        {name: part.format(name) for name in names},
    )
    assert [e.get("name") for e in x.root.children] == ["a/x.xacro", "b/y.xacro"]
    from_here = expand_xacro(Path("robot.xacro"), {}, PackageFinder(tmp_path, environment={}))
    assert from_here.root is not None
    assert len(from_here.root.children) == 2


@pytest.mark.parametrize(("error", "kind"), [(ModelTimeout, "time-limit"), (MemoryError, "memory-limit")])
def test_when_time_or_memory_is_over_the_place_is_told_and_what_went_on(
    expand_text: Expand, monkeypatch: pytest.MonkeyPatch, error: type[BaseException], kind: str
) -> None:
    class Ends(guards.Guards):
        def evaluate(self, code: Any, symbols: Any) -> Any:
            if len(finished) == 3:
                raise error
            finished.append(super().evaluate(code, symbols))
            return finished[-1]

    finished: list[Any] = []
    monkeypatch.setattr(tracer, "Guards", Ends)
    x = expand_text(
        '<xacro:macro name="m" params="n">\n<a b="${n}"/></xacro:macro>' + '\n<xacro:m n="1"/>' * 9, like_plain=False
    )
    assert x.problem.kind == kind
    assert x.problem.message == "macro m was called repeatedly"
    assert x.place(x.problem.location.span) == "robot.xacro:2 ${n}"
    assert [span.line for span in x.problem.location.via] == [6]
    monkeypatch.setattr(tracer, "Guards", guards.Guards)
    assert expand_text('<link name="${1 + 1}"/>').root.children  # and xacro is as it was


# -- the environment ---------------------------------------------------------------------------------------------------


def test_variables_count_as_not_set_whether_they_are_or_not(
    expand_text: Expand, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("URDFCHECK_TOKEN", "secret")
    x = expand_text(
        """<xacro:property name="o" value="${'\\x28'}"/><xacro:property name="c" value="${'\\x29'}"/>
        <xacro:property name="token" value="$(optenv URDFCHECK_TOKEN none)"/>
        <link name="a" x="${token}" y="$(optenv URDFCHECK_OTHER)" z="$(eval optenv${o}'URDFCHECK_TOKEN', 'no'${c})"/>""",
        like_plain=False,
    )
    link = x.named("a")
    assert [link.get(n) for n in "xyz"] == ["none", "", "no"]
    ignored = [p for p in x.expansion.problems if p.kind == "environment-ignored"]
    assert [(p.data["variable"], p.location.span.line) for p in ignored if p.location.span] == [
        ("URDFCHECK_TOKEN", 2), ("URDFCHECK_OTHER", 3), ("URDFCHECK_TOKEN", 3)
    ]  # fmt: skip


@pytest.mark.parametrize("text", ["$(env URDFCHECK_TOKEN)", "$(eval env${o}'URDFCHECK_TOKEN'${c})"])
def test_a_variable_without_a_default_ends_the_expansion_by_its_name(
    expand_text: Expand, monkeypatch: pytest.MonkeyPatch, text: str
) -> None:
    monkeypatch.setenv("URDFCHECK_TOKEN", "secret")
    names = """<xacro:property name="o" value="${'\\x28'}"/><xacro:property name="c" value="${'\\x29'}"/>"""
    x = expand_text(f'{names}\n<link name="{text}"/>', like_plain=False)
    assert x.problem.message.startswith("environment variable 'URDFCHECK_TOKEN' is not read")
    assert x.place(x.problem.location.span) == f"robot.xacro:2 {text}"


def test_ros_and_what_is_named_is_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_DISTRO", "jazzy")
    monkeypatch.setenv("NAMED", "1")
    monkeypatch.delenv("ROS_VERSION", raising=False)
    path = tmp_path / "robot.xacro"
    path.write_text(f'{HEAD}<a b="$(env ROS_DISTRO)$(optenv NAMED 0)$(optenv ROS_VERSION 2)$(env NAMED)"/></robot>')
    expansion = expand_xacro(path, {}, PackageFinder(tmp_path, environment={}), extra_environment=frozenset({"NAMED"}))
    assert expansion.root is not None
    assert expansion.root.children[0].get("b") == "jazzy121"
    assert not expansion.problems


@pytest.mark.parametrize(
    ("body", "message"),
    [
        ("""<link name="a"><xacro:attribute name="value" value="${2*2.0}"/></link>""", "value of the type float"),
        ("""<link name="a"><xacro:attribute name="value" value="${2}"/></link>""", "value of the type int"),
        ("""<link name="a"><xacro:attribute name="value" value="${True}"/></link>""", "value of the type bool"),
        ("""<link name="a"><xacro:attribute name="value" value="${[1]}"/></link>""", "value of the type list"),
        ("""<link name="a"><xacro:attribute name="value" value="${dict(a=1)}"/></link>""", "value of the type dict"),
        ("""<xacro:element xacro:name="1a"/>""", "not a valid name of an element"),
        ("""<xacro:element xacro:name="-"/>""", "not a valid name of an element"),
        ("""<link name="${'\\x01'}"/>""", "U+0001, which is not allowed"),
        ("""<link name="${'\\0'}"/>""", "U+0000, which is not allowed"),
        ("""<link name="a">${'\\ud800'}</link>""", "U+D800, which is not allowed"),
        ("""<!-- xacro:eval-comments --><!-- ${'-' * 2} --><link name="a"/>""", "evaluates contains `--`"),
    ],
)
def test_what_plain_xacro_cannot_write_is_told_at_its_place(tmp_path: Path, body: str, message: str) -> None:
    import xacro

    problem = problem_of(tmp_path, f"\n{body}", reach=tmp_path)
    assert problem.kind == "expansion-failed"
    assert message in problem.message
    assert problem.location.span is not None
    assert problem.location.span.line >= 1
    with pytest.raises((AttributeError, ValueError, UnicodeError, TypeError, expat.ExpatError)):
        expat.ParserCreate().Parse(xacro.process_file(str(tmp_path / "robot.xacro")).toxml("utf-8"), True)


@pytest.mark.parametrize("value", ["0", "0.0", "False", "None", "[]", "dict()"])
def test_an_attribute_that_plain_xacro_leaves_empty_is_told(tmp_path: Path, value: str) -> None:
    import xacro

    path = tmp_path / "robot.urdf.xacro"
    path.write_text(f"""{HEAD}<link name="a"><xacro:attribute name="b" value="${{{value}}}"/></link></robot>""")
    plain = xacro.process_file(str(path)).toxml()
    found = expand_xacro(path, {}, PackageFinder(path, environment={}))
    assert found.root is not None
    assert 'b=""' in plain
    assert found.root.children[0].get("b", "none") == ""
    assert [p.kind for p in found.problems] == ["value-lost"]


@pytest.mark.parametrize("place", ["<?a b?>{}", "{}", "<!-- --><?a b?>{}"])
def test_an_instruction_ends_up_where_the_reference_parser_refuses_it(tmp_path: Path, place: str) -> None:
    import xacro

    pinocchio = pytest.importorskip("pinocchio")
    path = tmp_path / "robot.urdf.xacro"
    inner = "" if "?" in place else "<?a b?>"
    path.write_text(place.format(f"""{HEAD}{inner}<link name="a"/></robot>"""))
    with capture_stderr(), pytest.raises(ValueError, match="valid URDF"):
        pinocchio.buildModelFromXML(xacro.process_file(str(path)).toprettyxml())
    found = expand_xacro(path, {}, PackageFinder(path, environment={}))
    (problem,) = found.problems
    span = problem.location.span
    assert span is not None
    assert (problem.kind, path.read_text()[span.start : span.end]) == ("instruction-copied", "<?a b?>")
