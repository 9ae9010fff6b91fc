"""A grammar of xacro: expressions with pieces that should never be evaluated, and elements that hold them.

What a piece would do if it ran is harmless: it would make a file ``CANARY``, or put a secret of the oracle into the model.
Others would take all time or memory of a naive evaluation.
"""

from __future__ import annotations

from random import Random
from xml.sax.saxutils import quoteattr

from fuzz import nasty

_NAMES = ("size", "mass", "data", "names", "n", "rest", "pi", "name", "side", "parent", "missing", "True", "None", "e")
_FUNCTIONS = (
    "sin",
    "cos",
    "radians",
    "sqrt",
    "abs",
    "len",
    "list",
    "dict",
    "str",
    "int",
    "float",
    "max",
    "min",
    "range",
)
_FUNCTIONS += ("round", "sum", "sorted", "zip", "map", "filter", "enumerate", "reversed", "any", "all", "set", "tuple")
_FUNCTIONS += (
    "bool",
    "ord",
    "chr",
    "hex",
    "bin",
    "complex",
    "bytes",
    "bytearray",
    "atan2",
    "pow",
    "divmod",
    "iter",
    "next",
)
_FUNCTIONS += ("load_yaml", "dotify", "abs_filename", "xacro.load_yaml", "xacro.arg", "xacro.warning", "xacro.error")
_FUNCTIONS += ("xacro.fatal", "xacro.print_location", "xacro.dotify", "xacro.abs_filename", "python.len", "math.pow")
_FUNCTIONS += (
    "math.factorial",
    "math.comb",
    "python.range",
    "python.map",
    "isinstance",
    "repr",
    "format",
    "hash",
    "id",
)
_METHODS = (
    "get",
    "items",
    "keys",
    "values",
    "upper",
    "split",
    "strip",
    "replace",
    "join",
    "format",
    "format_map",
    "encode",
)
_METHODS += ("count", "index", "append", "pop", "update", "startswith", "zfill", "center", "ljust", "translate", "sort")
_METHODS += (
    "real",
    "bit_length",
    "to_bytes",
    "as_integer_ratio",
    "hex",
    "is_integer",
    "__class__",
    "_x",
    "mro",
    "gi_frame",
)
_OPERATORS = (
    "+",
    "-",
    "*",
    "/",
    "//",
    "%",
    "**",
    "@",
    "<<",
    ">>",
    "&",
    "|",
    "^",
    "and",
    "or",
    "<",
    "==",
    "in",
    "is",
    "is not",
)

HOSTILE = (
    "().__class__.__base__.__subclasses__()",
    "[c for c in ().__class__.__base__.__subclasses__()][0]",
    "(lambda: ().__class__.__base__.__subclasses__())()",
    "[().__class__ for _ in [1]]",
    "'{0.__class__.__base__}'.format(1)",
    "'{0.__class__}'.format_map({'0': 1})",
    "str.format('{0.__class__}', 1)",
    "f'{().__class__}'",
    "'%s' % ().__class__",
    "__import__('os').system('touch CANARY')",
    "open('CANARY', 'w')",
    "python.open('CANARY', 'w')",
    'exec(\'open("CANARY", "w")\')',
    "eval('1')",
    'eval(\'open("CANARY", "w")\')',
    "compile('1', '', 'eval')",
    "getattr((), '__class__')",
    "vars()",
    "python.vars(str)['format']('{0.__class__}', 1)",
    "globals()",
    "type('X', (), {})",
    "(x := 1)",
    "[x for x in (1).__class__.mro()]",
    "(x for x in [1]).gi_frame.f_builtins",
    "dict(a=().__class__)",
    "load_yaml('/etc/passwd')",
    "load_yaml('../outside.yaml')",
    "load_yaml('/proc/self/environ')",
    "load_yaml('/dev/zero')",
    "load_yaml('pipe.stl')",
    "xacro.load_yaml('folder.stl')",
    "load_yaml('\\x00')",
    "load_yaml(['values.yaml'])",
    "load_yaml(0)",
    "xacro.arg('__class__')",
    "xacro.__dict__",
    "xacro['load_yaml']",
    "data.__class__",
    "data._x",
    "data['__class__']",
    "data[data]",
    "{}[[]]",
    "(" * 90 + "1" + ")" * 90,
    "(" * 300 + "1" + ")" * 300,
    "-" * 5000 + "1",
    "[" * 95 + "]" * 95,
    "1" + "+1" * 3000,
    "not " * 1000 + "1",
    "'\\ud800'",
    "'\\x00'",
    "'\\x1b[31m'",
    "'<fuzzmarkup>'",
    "b'a'",
    "...",
    "lambda: 1",
    "await x",
    "yield",
    "yield from []",
    "*[1]",
    "**{}",
    "a=1",
    "import os",
    "1; 2",
    "1\n2",
    "#",
    "1 # a",
    "\\",
    "'",
    "'''",
    "int('9' * 5000)",
    "iter([1])",
    "map(str, [1])",
    "sorted([1, 'a'])",
    "max([])",
    "next(iter([]))",
    "1 / 0",
    "0 ** -1",
    "float('nan')",
    "float('inf')",
    "1e999 - 1e999",
    "(-1) ** 0.5",
    "int(float('nan'))",
    "math.factorial(-1)",
    "range(10)",
    "[].append([])",
    "names.append(names)",
    "names.sort(key=len)",
    "sum([[1]], [])",
    "print(1)",
    "exit()",
    "quit()",
    "input()",
    "help()",
    "breakpoint()",
    "SystemExit",
    "xacro.fatal('a')",
    "xacro.fatal()",
    "xacro.error({})",
    "xacro.message('\\x1b[31m')",
)
BOMBS = (
    "10 ** 10 ** 10",
    "9 ** 9 ** 9",
    "2 ** 10000000000",
    "pow(9, 9 ** 9)",
    "1 << 10 ** 12",
    "'a' * 10 ** 12",
    "[0] * 10 ** 12",
    "10 ** 9 * [[]]",
    "list(range(10 ** 10))",
    "sum(range(10 ** 12))",
    "len([x for x in range(10 ** 10)])",
    "[[y for y in range(10 ** 6)] for x in range(10 ** 6)]",
    "max(range(10 ** 12))",
    "10 ** 12 in iter(range(10 ** 13))",
    "'%' + '1' * 3 + 'd' % 1",
    "'%999999999999d' % 1",
    "'%*d' % (10 ** 9, 1)",
    "'a'.zfill(10 ** 11)",
    "'a'.center(10 ** 11)",
    "'a'.replace('', 'b' * 10 ** 6).replace('', 'c' * 10 ** 6)",
    "math.factorial(10 ** 8)",
    "math.comb(10 ** 9, 10 ** 8)",
    "factorial(10 ** 8)",
    "bytes(10 ** 12)",
    "bytearray(10 ** 11)",
    "(10 ** 9).to_bytes(10 ** 12, 'big')",
    "str(10 ** 4000) * 10 ** 6",
    "list(zip(*[range(10 ** 8)] * 100))",
    "sorted(range(10 ** 10))",
    "dict.fromkeys(range(10 ** 10))",
    "set(range(10 ** 10))",
    "(1,) * 10 ** 5 * 10 ** 5",
    "[x for x in iter(int, 1)]",
    "sum(iter(int, 1))",
    "'1' * 10 ** 7 + '+1'",
    "hash((0,) * 10 ** 10)",
    "round(10 ** 1000, -10 ** 10)",
)


class Language:
    """Draws expressions and elements. ``hostile``: whether anything was drawn that plain xacro must not run."""

    def __init__(self) -> None:
        self.hostile = False

    def expression(self, rng: Random, depth: int = 3) -> str:
        """The text between ``${`` and ``}``."""
        kind = rng.randrange(16 if depth else 3)

        def inner() -> str:
            return self.expression(rng, depth - 1)

        if kind == 0:
            return rng.choice((*nasty.NUMBERS[:40], "1", "2", "0.5", "-1", "'a'", '"b"', "[]", "{}", "()", "''"))
        if kind in (1, 2):
            return rng.choice(_NAMES)
        if kind in (3, 4, 5):
            return f"{inner()} {rng.choice(_OPERATORS)} {inner()}"
        if kind in (6, 7):
            self.hostile = True  # what a function that is called with anything does nobody knows
            return f"{rng.choice(_FUNCTIONS)}({', '.join(inner() for _ in range(rng.choice((0, 1, 1, 2, 3))))})"
        if kind == 8:
            self.hostile = True
            return f"{inner()}.{rng.choice(_METHODS)}{rng.choice(('', '()', '(1)'))}"
        if kind == 9:
            return f"{inner()}[{inner()}]"
        if kind == 10:
            return f"{inner()} if {inner()} else {inner()}"
        if kind == 11:
            opened, closed = rng.choice(("[]", "()", "{}"))
            return f"{opened}{inner()} for {rng.choice(_NAMES[:6])} in {inner()}{closed}"
        if kind == 12:
            return rng.choice(
                (f"[{inner()}, {inner()}]", f"({inner()},)", f"{{{inner()!r}: {inner()}}}", f"({inner()})")
            )
        if kind == 13:
            return rng.choice(
                (f"not {inner()}", f"-{inner()}", f"~{inner()}", f"{inner()}[1:]", f"{inner()}[::{inner()}]")
            )
        self.hostile = True
        if kind == 14 and rng.random() < 0.1:
            return rng.choice(BOMBS)
        return rng.choice(HOSTILE)

    def value(self, rng: Random) -> str:
        """The value of an attribute or a text: expressions, substitutions, and what looks like them."""
        kind = rng.randrange(12)
        if kind < 7:
            return f"${{{self.expression(rng)}}}"
        if kind == 7:
            return f"{rng.choice(nasty.NAMES)}${{{self.expression(rng, 1)}}}${{{self.expression(rng, 1)}}}"
        if kind == 8:
            self.hostile = True
            return f"$(eval {self.expression(rng)})"
        if kind == 9:
            self.hostile = True
            wanted = (
                "arg size",
                "arg missing",
                "arg",
                "find robot",
                "find nowhere",
                "find",
                "env HOME",
                "env FUZZ_SECRET",
            )
            wanted += (
                "optenv FUZZ_SECRET no",
                "optenv FUZZ_MISSING a b",
                "dirname",
                "anon x",
                "eval",
                "x",
                "",
                "arg a b",
            )
            wanted += ("env ROS_DISTRO", "optenv ROS_DISTRO jazzy", "find-pkg-share robot", "command ls", "arg ${size}")
            return f"$({rng.choice(wanted)}){rng.choice(('', '', '/a', '$(x'))}"
        if kind == 10:
            return rng.choice(
                ("${", "}", "$(", "$${size}", "$$(arg size)", "${}", "$()", "${${size}}", "${'}'}", "${'${1}'}")
            )
        return rng.choice((*nasty.NUMBERS, *nasty.NAMES))

    def element(self, rng: Random, depth: int = 2) -> str:
        """An element of xacro's, or one that uses it."""

        def attribute() -> str:
            return quoteattr(self.value(rng))

        def inside() -> str:
            return "".join(self.element(rng, depth - 1) for _ in range(rng.choice((0, 1, 1, 2)))) if depth else "<a/>"

        def name() -> str:
            return quoteattr(rng.choice((*_NAMES[:10], "cube", "tool", "each", "pose", "m", *nasty.NAMES)))

        def macro() -> str:
            return rng.choice(("cube", "tool", "chain", "each", "m", "m2", "missing", "macro"))

        kind = rng.randrange(20)
        if kind == 0:
            more = rng.choice(
                ("", "", ' scope="global"', ' scope="parent"', ' scope="x"', ' lazy_eval="false"', ' remove="true"')
            )
            return f"<xacro:property name={name()} value={attribute()}{more}/>"
        if kind == 1:
            return f"<xacro:property name={name()} default={attribute()}/>"
        if kind == 2:
            return f"<xacro:property name={name()}>{inside()}</xacro:property>"
        if kind in (3, 4):
            return f"<xacro:macro name={quoteattr(macro())} params={quoteattr(self.parameters(rng))}>{inside()}</xacro:macro>"
        if kind in (5, 6):
            called = macro()
            given = f" {rng.choice(_NAMES)}={attribute()} n={attribute()}"
            return f"<xacro:{called}{given}>{inside()}</xacro:{called}>"
        if kind == 7:
            return f"<xacro:if value={attribute()}>{inside()}</xacro:if>"
        if kind == 8:
            return f"<xacro:unless value={attribute()}>{inside()}</xacro:unless>"
        if kind in (9, 10):
            files = (
                "model.urdf.xacro",
                "parts.xacro",
                "*.xacro",
                "**/*.xacro",
                "missing.xacro",
                "values.yaml",
                "$(find robot)/a",
            )
            file = rng.choice((*files, "../outside.xacro", self.value(rng), *nasty.PATHS))
            more = rng.choice(("", "", ' ns="m"', ' ns="${size}"', ' optional="true"', f" optional={attribute()}"))
            self.hostile = True
            return f"<xacro:include filename={quoteattr(file)}{more}/>"
        if kind == 11:
            return f"<xacro:arg name={name()} default={attribute()}/>"
        if kind == 12:
            return f"<xacro:insert_block name={rng.choice((name(), attribute()))}/>"
        if kind == 13:
            return f"<xacro:call macro={rng.choice((attribute(), quoteattr(macro())))}>{inside()}</xacro:call>"
        if kind == 14:
            return f"<xacro:element xacro:name={attribute()} b={attribute()}>{inside()}</xacro:element>"
        if kind == 15:
            return f"<xacro:attribute name={attribute()} value={attribute()}/>"
        if kind == 16:
            return f"<link name={attribute()}>{inside()}</link>"
        if kind == 17:
            return (
                f"<joint name={attribute()} type={attribute()}><parent link={attribute()}/><child link={attribute()}/>"
                f"<origin xyz={attribute()} rpy={attribute()}/></joint>"
            )
        if kind == 18:
            # A macro that ends only where its condition does.
            condition = quoteattr(f"${{{self.expression(rng, 2)}}}")
            return (
                f'<xacro:macro name="m" params="n:=0"><xacro:if value={condition}><xacro:m n="${{n + 1}}"/></xacro:if>'
                f"{inside()}</xacro:macro><xacro:m/>"
            )
        return f"<!-- ${{{self.expression(rng, 1).replace('--', '')}}} --><a>{attribute()[1:-1]}</a>"

    def parameters(self, rng: Random) -> str:
        """What a macro says of its parameters."""
        known = (
            "n",
            "name",
            "size:=1",
            "a:='b c'",
            "b:=^",
            "c:=^|2",
            "*block",
            "**blocks",
            "d:=${size}",
            "e:=",
            ":=1",
            "*",
            "**",
        )
        known += (
            "a:=^|",
            "n n",
            "'",
            '"',
            "a:=${",
            "*a:=1",
            "***a",
            "a=1",
            "*x *y",
            "x:=^||^",
            "${size}",
            "",
            "a:=^ b:=^",
        )
        return " ".join(rng.choice((*known, *nasty.NAMES[:60])) for _ in range(rng.choice((0, 1, 2, 3, 4))))
