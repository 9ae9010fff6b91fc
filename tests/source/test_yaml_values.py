"""Values of yaml files: a number in a model leads to the key in the file that it came from."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import yaml

from urdfcheck.source.text.xml import Definition, SourceFile
from urdfcheck.source.text.yaml.reader import MAX_CHARACTERS
from urdfcheck.source.xacro.expressions.yaml_values import read_yaml

pytestmark = pytest.mark.slow

Expand = Callable[..., Any]

ROBOT_YAML = """\
# é🤖: what stands before a value does not move it
wheel:
  radius: 0.1
  mass: 0.5   # kg
  limits:
    upper: !degrees 180
    lower: !degrees -90
    gap: !millimeters 5
axles:
- x: 0.3
- x: -0.3
colour: [0.1, 0.2, "0.3", 1]
"key with spaces": 7
2: two
"""


def keys(x: Any, attribute: str) -> dict[str, str]:
    """The yaml keys behind an attribute of the link ``a``, with the text of their values."""
    found = x.origins(x.named("a").attributes[attribute])
    return {name: text for name, text in found.items() if name.startswith("yaml[")}


@pytest.mark.parametrize(
    ("expression", "value", "origin"),
    [
        ("c.wheel.radius", "0.1", {"yaml[wheel.radius]": "0.1"}),
        ("c['wheel']['mass']", "0.5", {"yaml[wheel.mass]": "0.5"}),
        ("c.wheel['limits'].upper", "3.141592653589793", {"yaml[wheel.limits.upper]": "!degrees 180"}),
        ("c.wheel.limits.gap", "0.005", {"yaml[wheel.limits.gap]": "!millimeters 5"}),
        ("c.wheel.get('mass')", "0.5", {"yaml[wheel.mass]": "0.5"}),
        ("c.axles[1].x", "-0.3", {"yaml[axles[1].x]": "-0.3"}),
        ("c.axles[-1]['x']", "-0.3", {"yaml[axles[-1].x]": "-0.3"}),
        ("c['key with spaces']", "7", {"yaml[key with spaces]": "7"}),
        ("c[2]", "two", {"yaml[2]": "two"}),
        ("c.colour[2]", "0.3", {"yaml[colour[2]]": '"0.3"'}),
        ("c.wheel.mass * c.wheel.radius", "0.05", {"yaml[wheel.mass]": "0.5", "yaml[wheel.radius]": "0.1"}),
        ("len(c.axles)", "2", {}),
        ("'wheel' in c", "True", {}),
        ("c.wheel.get('width', 3)", "3", {}),
    ],
)
def test_a_value_leads_to_its_key(expand_text: Expand, expression: str, value: str, origin: dict[str, str]) -> None:
    x = expand_text(
        f"""
        <xacro:property name="c" value="${{xacro.load_yaml('robot.yaml')}}"/>
        <link name="a" x="${{{expression}}}"/>""",
        {"robot.yaml": ROBOT_YAML},
    )
    assert x.named("a").get("x") == value
    assert keys(x, "x") == origin


def test_every_element_of_a_list_that_is_gone_through_counts(expand_text: Expand) -> None:
    x = expand_text(
        """
        <xacro:property name="c" value="${xacro.load_yaml('robot.yaml')}"/>
        <link name="a" x="${' '.join([str(v) for v in c.colour])}" y="${sum([axle.x for axle in c.axles])}"/>""",
        {"robot.yaml": ROBOT_YAML},
        like_plain=False,  # sum is no function of xacro: see below
    )
    assert x.problem.message.startswith("name 'sum' is not defined")
    x = expand_text(
        """
        <xacro:property name="c" value="${xacro.load_yaml('robot.yaml')}"/>
        <link name="a" x="${' '.join([str(v) for v in c.colour])}" y="${python.sum([axle.x for axle in c.axles])}"/>""",
        {"robot.yaml": ROBOT_YAML},
    )
    assert keys(x, "x") == {f"yaml[colour[{i}]]": t for i, t in enumerate(("0.1", "0.2", '"0.3"', "1"))}
    assert keys(x, "y") == {"yaml[axles[0].x]": "0.3", "yaml[axles[1].x]": "-0.3"}


def test_a_key_is_followed_through_properties_parameters_and_the_file_that_loads_it(expand_text: Expand) -> None:
    x = expand_text(
        """
        <xacro:property name="c" value="${xacro.load_yaml('config/robot.yaml')}"/>
        <xacro:property name="wheel" value="${c['wheel']}"/>
        <xacro:property name="mass" value="${wheel.mass}"/>
        <xacro:macro name="m" params="v"><link name="a" x="${v}"/></xacro:macro>
        <xacro:m v="${2 * mass}"/>""",
        {"config/robot.yaml": ROBOT_YAML},
    )
    assert x.origins(x.named("a").attributes["x"]) == {
        "parameter[v]": "${2 * mass}",
        "property[mass]": "${wheel.mass}",
        "property[wheel]": "${c['wheel']}",
        "property[c]": "${xacro.load_yaml('config/robot.yaml')}",
        "yaml[wheel.mass]": "0.5",
    }
    (key,) = [d for d in x.named("a").attributes["x"].collect_definitions() if d.kind == "yaml"]
    assert (key.span.file, key.span.line, key.span.col) == ("config/robot.yaml", 4, 9)
    assert key.location.subject == "yaml[wheel.mass]"


def test_merged_and_repeated_keys_lead_to_the_one_that_counts(expand_text: Expand) -> None:
    x = expand_text(
        """
        <xacro:property name="c" value="${xacro.load_yaml('m.yaml')}"/>
        <link name="a" merged="${c.rear.radius}" own="${c.rear.mass}" first="${c.both.mass}" alias="${c.same.mass}"/>""",
        {
            "m.yaml": "front: &front {radius: 0.1, mass: 1}\n"
            "heavy: &heavy {mass: 9}\n"
            "rear: {mass: 2, <<: *front}\n"
            "both: {<<: [*heavy, *front]}\n"
            "same: *front\n"
        },
    )
    assert keys(x, "merged") == {"yaml[rear.radius]": "0.1"}
    assert keys(x, "own") == {"yaml[rear.mass]": "2"}
    assert keys(x, "first") == {"yaml[both.mass]": "9"}
    assert keys(x, "alias") == {"yaml[same.mass]": "1"}


@pytest.mark.parametrize(
    ("content", "expression", "says"),
    [
        ("a: 1", "c.b", "no key 'b'"),
        ("a: [1, 2]", "c.a[2]", "out of range"),
        ("a: !degrees ninety", "c.a", "name 'ninety' is not defined"),
    ],
)
def test_what_is_wrong_in_a_yaml_file_fails_the_expansion_where_it_is_read(
    expand_text: Expand, content: str, expression: str, says: str
) -> None:
    x = expand_text(
        f"""<xacro:property name="c" value="${{xacro.load_yaml('f.yaml')}}"/>\n<link name="${{{expression}}}"/>""",
        {"f.yaml": content},
    )
    assert says in x.problem.message
    assert x.place(x.problem.location.span) == f"robot.xacro:2 ${{{expression}}}"
    assert "property[c]" in [r.subject for r in x.problem.related]


@pytest.mark.parametrize(
    ("content", "says", "column"),
    [
        ("a: [1", "expected ',' or ']'", 6),
        ("a: !unknown 1", "could not determine a constructor", 4),
        ("a: &a {<<: *a}", "a recursion without end", 4),
        ("a: &a [*a]", "a recursion without end", 4),
        ("a: " + "[" * 5000, "nested more than 100 deep", 103),
        ("a: \x07", "special characters are not allowed", 4),
    ],
)
def test_a_yaml_file_that_cannot_be_read_fails_the_expansion_at_its_own_line(
    expand_text: Expand, content: str, says: str, column: int
) -> None:
    x = expand_text(
        """<xacro:property name="c" value="${xacro.load_yaml('f.yaml')}"/>\n<link name="${c.a}"/>""",
        {"f.yaml": content},
        like_plain="&a" not in content,
    )
    assert x.problem.kind == "expansion-failed"
    assert says in x.problem.message
    span = x.problem.location.span
    assert span is not None
    assert (span.file, span.line, span.col) == ("f.yaml", 1, column)
    assert x.place(x.problem.data["reader"].span) == "robot.xacro:2 ${c.a}"
    assert "property[c]" in [r.subject for r in x.problem.related]


def test_an_expression_in_a_yaml_file_is_held_to_the_same_language(expand_text: Expand) -> None:
    x = expand_text(
        """<xacro:property name="c" value="${xacro.load_yaml('f.yaml')}"/><link name="${c.a}"/>""",
        {"f.yaml": 'a: !degrees "[().__class__ for x in [1]][0]"'},
        like_plain=False,
    )
    assert x.problem.kind == "unsafe-expression"


@pytest.mark.parametrize(
    "tag", ["!!python/object/apply:os.system", "!!python/name:os.system", "!!python/object/new:subprocess.Popen"]
)
def test_a_tag_that_asks_for_python_is_an_unsafe_expression_at_its_own_line(expand_text: Expand, tag: str) -> None:
    x = expand_text(
        """<link name="${xacro.load_yaml('f.yaml').a}"/>""",
        {"f.yaml": f"x: 1\na:\n- {tag} ['touch written']"},
    )
    assert x.problem.kind == "unsafe-expression"
    assert x.problem.data["expression"] == tag
    span = x.problem.location.span
    assert span is not None
    assert (span.file, span.line, span.col) == ("f.yaml", 3, 3)
    assert x.place(x.problem.data["reader"].span) == "robot.xacro:1 ${xacro.load_yaml('f.yaml').a}"


@pytest.mark.parametrize("alias", ["[{a},{a},{a},{a},{a},{a},{a},{a}]", "{{<<: [{a},{a},{a},{a},{a},{a},{a},{a}]}}"])
def test_what_aliases_multiply_is_counted_before_it_is_built(expand_text: Expand, alias: str) -> None:
    lines = ["a0: &a0 {k: 1}", *(f"a{i}: &a{i} " + alias.format(a=f"*a{i - 1}") for i in range(1, 30))]
    x = expand_text(
        """<link name="${xacro.load_yaml('f.yaml').a29}"/>""", {"f.yaml": "\n".join(lines)}, like_plain=False
    )
    assert "with its aliases it has more than 100,000 values" in x.problem.message


def test_a_yaml_file_that_is_too_long_is_not_parsed(expand_text: Expand) -> None:
    x = expand_text(
        """<link name="${xacro.load_yaml('f.yaml').a}"/>""",
        {"f.yaml": "a: " + "x" * MAX_CHARACTERS},
        like_plain=False,
    )
    assert "more than 1,000,000" in x.problem.message


def test_the_loader_that_everybody_uses_stays_as_it_was(expand_text: Expand, monkeypatch: pytest.MonkeyPatch) -> None:
    constructors = {tag: c for tag, c in yaml.SafeLoader.yaml_constructors.items() if tag != "!degrees"}
    monkeypatch.setattr(yaml.SafeLoader, "yaml_constructors", constructors)
    expand_text("""<link name="${xacro.load_yaml('f.yaml').a}"/>""", {"f.yaml": "a: !degrees 90"}, like_plain=False)
    assert "!degrees" not in yaml.SafeLoader.yaml_constructors


def test_the_wrapped_values_are_equal_to_the_loaded_ones(tmp_path: Path) -> None:
    reads: list[Definition] = []
    path = tmp_path / "f.yaml"
    path.write_text("a: {b: [1, 2.5, x]}\nc: null\n")
    value = yaml.safe_load(path.read_text())
    wrapped = read_yaml(SourceFile.read(path, "f.yaml"), reads.append, float, lambda *_: None)
    assert wrapped == value
    assert repr(wrapped) == repr(value)
    assert list(wrapped.a.b) == [1, 2.5, "x"]
    assert [d.name for d in reads] == ["a.b[0]", "a.b[1]", "a.b[2]"]
    assert wrapped.a.b[0:2] == [1, 2.5]
    assert not hasattr(wrapped, "d")
    with pytest.raises(AttributeError, match="no key 'd'"):
        wrapped.d  # noqa: B018
