"""Which expressions of a xacro file are evaluated at all: a stranger's file must reach nothing but numbers and text."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from urdfcheck.source.xacro.expressions.compile_expression import ExpressionRefusedError, compile_expression, find_names

Expand = Callable[..., Any]

ORDINARY = [
    "1 + 2 * -3 ** 2 // 4 % 5",
    "width/2 if width > 0 and not flipped else 0.0",
    "a and b or not c",
    "0 < x <= 1",
    "pi/2",
    "math.sqrt(2) + radians(90)",
    "xacro.load_yaml('a.yaml')['wheel'].mass",
    "config.limits.upper[0]",
    "[x * 2 for x in range(3) if x]",
    "{k: v for k, v in d.items()}['a']",
    "' '.join([str(x) for x in xyz])",
    "max(*values, key=len)",
    "name[1:-1:2].split('_')[0].upper()",
    "{'left': 1, 'right': -1}[side]",
    "dict(a=1)['a']",
    "(1, 2)[0] + [3][0] + len({4})",
    "'%s_%d' % (name, 1)",
    "~1 | 2 & 3 ^ 4 << 5 >> 6",
    "prefix + 'link'",
    "any(x for x in xs)",
    "type == 'wheel'",
    "format",
]

ESCAPES = [
    ("().__class__", ".__class__"),
    ("().__class__.__base__.__subclasses__()", ".__"),
    ("(lambda: 1)()", "a lambda"),
    ("[x.__class__ for x in [1]]", ".__class__"),
    ("{x: x.__class__ for x in [1]}", ".__class__"),
    ("(x for x in [1]).gi_frame", ".gi_frame"),
    ("(x for x in [1]).gi_code", ".gi_code"),
    ("f.gi_frame.f_back.f_builtins", ".f_builtins"),
    ("'{a.__class__}'.format_map({'a': 1})", ".format_map"),
    ("str.mro()", ".mro"),
    ("__import__('os')", "__import__"),
    ("__builtins__", "__builtins__"),
    ("f'{().__class__}'", ".__class__"),
    ("(y := 1)", "an assignment"),
    ("[await x for x in y]", "await"),
    ("xs._private", "._private"),
    ("b.ownerDocument.implementation.createDOMBuilder(1, None)", ".createDOMBuilder"),
]


@pytest.mark.parametrize("expression", ORDINARY)
def test_ordinary_expressions_pass(expression: str) -> None:
    assert compile_expression(expression)


@pytest.mark.parametrize(("expression", "named"), ESCAPES)
def test_ways_out_are_refused_and_named(expression: str, named: str) -> None:
    with pytest.raises(ExpressionRefusedError) as refused:
        compile_expression(expression)
    assert named in str(refused.value)


@pytest.mark.parametrize(
    ("expression", "kind"),
    [
        ("list(map(lambda i: i * 2, [1]))", "construct"),
        ("f'{1}'", "construct"),
        ("b'a'", "construct"),
        ("[x async for x in y]", "construct"),
        ("[0 for math.sqrt in [1]]", "construct"),
        ("[0 for a, d['k'] in [(1, 2)]]", "construct"),
        ("(lambda: ().__class__)()", "unsafe"),
        ("f'{().__class__}'", "unsafe"),
    ],
)
def test_what_harms_nobody_is_told_apart_from_what_leads_out(expression: str, kind: str) -> None:
    with pytest.raises(ExpressionRefusedError) as refused:
        compile_expression(expression)
    assert refused.value.kind == kind


@pytest.mark.parametrize(
    "text",
    ["", "1 +", "a b", "import os", "x = 1", "(" * 5000, "[" * 500, "1\0", "é$", "9" * 5000, "x[*]", "f(a=1, a=2)"],
)
def test_text_that_is_no_expression_is_an_error_of_syntax(text: str) -> None:
    with pytest.raises(SyntaxError):
        compile_expression(text)


@pytest.mark.parametrize(
    "text",
    [
        "-" * 5000 + "1",
        "~" * 15000 + "1",
        "not " * 4000 + "1",
        "1+" * 5000 + "1",
        "1**" * 5000 + "1",
        "1 if 1 else " * 1000 + "1",
        "a" + ".b" * 5000,
        "a" + "[0]" * 5000,
        "a" + "()" * 5000,
        "[" * 160 + "]" * 160,
        "'" + "a" * 20_000 + "'",
    ],
)
def test_an_expression_that_is_too_deep_or_too_long_is_refused(text: str) -> None:
    with pytest.raises(ExpressionRefusedError) as refused:
        compile_expression(text)
    assert refused.value.kind == "too_large"


def test_the_names_of_an_expression_are_found_in_strings_and_in_broken_text_too() -> None:
    assert find_names("a.b + c['d'] * f(e)") == {"a", "b", "c", "d", "e", "f"}
    assert find_names("'${mass}' + x1") == {"mass", "x1"}
    assert find_names("width height)") == {"width", "height"}


# -- in files ----------------------------------------------------------------------------------------------------------


def typed(expression: str) -> str:
    """An expression as it must be written inside ``${…}``: xacro ends it at the first brace."""
    return expression.replace("}", "\\x7d").replace("{", "\\x7b") if "'" in expression else expression


@pytest.mark.parametrize(
    "expression",
    [
        "().__class__",
        "(x for x in [1]).gi_frame",
        "'{0.__class__}'.format(1)",
        "(lambda: 1)()",
        "[c.__class__ for c in [1]]",
    ],
)
def test_an_escape_in_a_file_is_a_problem_where_it_was_typed(expand_text: Expand, expression: str) -> None:
    x = expand_text(f'\n<link name="${{{typed(expression)}}}"/>', like_plain=False)
    assert x.problem.kind == "unsafe-expression"
    assert x.place(x.problem.location.span) == f"robot.xacro:2 ${{{typed(expression)}}}"


@pytest.mark.parametrize(
    "expression",
    [
        "python.type(1)",
        "python.vars(str)",
        "python['vars'](str)",
        "python.get('type')(1)",
        "[f for f in python.values() if 'refuse' in str(f)][0](1)",
        "list(map(python.type, [1]))",
    ],
)
def test_the_two_functions_that_hand_out_classes_are_taken_away_however_they_are_reached(
    expand_text: Expand, expression: str
) -> None:
    x = expand_text(f'<link name="${{{expression}}}"/>', like_plain=False)
    assert x.problem.kind == "unsafe-expression"
    assert "is not part of xacro's language" in x.problem.message or x.problem.data["refusal"] == "varies"


def in_eval(expression: str) -> str:
    """An expression as it must be written inside ``$(eval …)``: xacro ends it at the first parenthesis."""
    return f"$(eval {expression.replace('(', '${chr_open}').replace(')', '${chr_close}')})"


PARENTHESES = (
    """<xacro:property name="chr_open" value="${'\\x28'}"/><xacro:property name="chr_close" value="${'\\x29'}"/>"""
)


@pytest.mark.parametrize(
    "expression",
    ["open('written', 'w')", "exec('import os')", "getattr(1, 'real')", "[].append.__self__", "eval('1')", "type(1)"],
)
def test_eval_reaches_no_builtin_of_python_though_plain_xacro_lets_it(
    expand_text: Expand, tmp_path: Path, expression: str
) -> None:
    x = expand_text(PARENTHESES + f'\n<link name="{in_eval(expression)}"/>', like_plain=False)
    assert x.problem.kind == "unsafe-expression"
    assert x.problem.location.span is not None
    assert x.problem.location.span.line == 2
    assert not (tmp_path / "written").exists()


@pytest.mark.parametrize(
    ("expression", "value"),
    [
        ("2*pi", "6.283185307179586"),
        ("n*2", "6"),
        ("arg('n') + 1", "4"),
        ("float(n)", "3.0"),
        ("max(n, len('abcd'))", "4"),
        ("type == 'wheel'", "True"),
        ("true and not false", "True"),
    ],
)
def test_eval_computes_with_arguments_numbers_and_plain_functions(
    expand_text: Expand, expression: str, value: str
) -> None:
    x = expand_text(
        '<xacro:arg name="n" default="3"/><xacro:arg name="type" default="wheel"/>'
        + PARENTHESES
        + f'<link name="a" x="{in_eval(expression)}"/>'
    )
    assert x.named("a").get("x") == value


def test_a_block_in_a_namespace_opens_no_file(expand_text: Expand) -> None:
    x = expand_text(
        '<xacro:include filename="i.xacro" ns="lib"/>'
        "<link name=\"${lib.get('**b').ownerDocument.implementation.createDOMBuilder(1, None).parseURI('file:///etc/passwd')}\"/>",
        {"i.xacro": '<robot xmlns:xacro="u"><xacro:property name="b"><x/></xacro:property></robot>'},
        like_plain=False,
    )
    assert x.problem.kind == "unsafe-expression"


def test_a_property_may_have_the_name_of_a_function_of_python(expand_text: Expand) -> None:
    x = expand_text('<xacro:property name="type" value="wheel"/><link name="${type}"/>')
    assert x.named("wheel")
