"""Inputs: what lies in a folder, and what of it is checked. An input is made by its format and a source of chance alone."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from random import Random

from fuzz import meshes, nasty, readings, seeds, texts, trees
from fuzz.expressions import Language
from fuzz.texts import utf8

SECRET = "secret-that-no-report-may-show"


@dataclass(frozen=True, slots=True)
class Case:
    """``files`` by their path below the folder ``robot``; ``entry`` is what is checked of it. ``links``: symbolic links and
    what they lead to; ``pipes``: files that are none. ``plain``: whether plain xacro may be asked about the entry: nothing in
    it is meant to run. ``mesh``: the file that is a mutated mesh. ``reading``: whether urdfdom and plain
    xacro must read the same robot as we do."""

    entry: str
    files: Mapping[str, bytes]
    tier: str = "source"
    plain: bool = False
    mesh: str = ""
    reading: bool = False
    links: Mapping[str, str] = field(default_factory=dict)
    pipes: tuple[str, ...] = ()

    def write(self, folder: Path) -> Path:
        """Put everything below ``folder``; returns the path of the entry. Beside ``robot`` lies what is out of its reach."""
        robot = folder / "robot"
        (robot / "meshes").mkdir(parents=True)
        (folder / "outside.yaml").write_text(f"secret: {SECRET}\nside: {SECRET}\n", encoding="utf-8")
        (folder / "outside.xacro").write_text(f"<robot><link name='{SECRET}'/></robot>", encoding="utf-8")
        for name, data in self.files.items():
            path = robot / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(data)
        for name, target in self.links.items():
            (robot / name).symlink_to(target)
        for name in self.pipes:
            os.mkfifo(robot / name)
        return robot / self.entry if self.entry else robot


_STL = meshes.stl_binary()
_COMMON = {"package.xml": seeds.PACKAGE.encode(), "meshes/part.stl": _STL}
_ALONE = {"meshes/part.stl": _STL}
_MODEL = {**_COMMON, "model.urdf": seeds.ARM.encode()}
_URDF = tuple(trees.read(text) for text in (seeds.ARM, seeds.CAR, seeds.SMALL, seeds.CAR_3))
_URDF_WORDS = trees.words_of(_URDF)
_URDF_TEXTS = tuple(text.encode() for text in (seeds.ARM, seeds.CAR, seeds.SMALL))
_XACRO = tuple(trees.read(text) for text in (seeds.XACRO, seeds.LOOP, seeds.READER))
_XACRO_WORDS = trees.words_of((*_XACRO, trees.read(seeds.PARTS), *_URDF[:3], trees.read(seeds.CAR_3_XACRO)))
_XACRO_TEXTS = tuple(text.encode() for text in (seeds.XACRO, seeds.LOOP, seeds.READER, seeds.PARTS))
_LAUNCH = tuple(trees.read(text) for text in (seeds.LAUNCH_1, seeds.LAUNCH_2, seeds.OTHER_LAUNCH, seeds.CAR_3_LAUNCH))
_LAUNCH_WORDS = trees.words_of(_LAUNCH)
_LAUNCH_TEXTS = tuple(text.encode() for text in (seeds.LAUNCH_1, seeds.LAUNCH_2, seeds.OTHER_LAUNCH))
_SRDF = trees.read(seeds.SRDF)
_SRDF_WORDS = trees.words_of((_SRDF, _URDF[0]))
_PACKAGE = trees.read(seeds.PACKAGE)
_PACKAGE_WORDS = trees.words_of((_PACKAGE,))


def make(name: str, rng: Random) -> Case:
    """An input of this format."""
    return MAKERS[name](rng)


def _around(rng: Random) -> Mapping[str, bytes]:
    """What lies beside a model: a package, which is one unit more to check, or only a mesh."""
    return _COMMON if rng.random() < 0.3 else _ALONE


def _tier(rng: Random) -> str:
    return rng.choice(("source",) * 5 + ("mesh",) * 2 + ("full",) * 3)


def _urdf(rng: Random) -> Case:
    if rng.random() < 0.75:
        # The model of car-3 is large: one in eight is enough.
        tree = _URDF[rng.choice((0, 0, 0, 1, 1, 1, 2, 3))]
        data = trees.mutated(tree, rng, _URDF_WORDS)
    else:
        data = rng.choice(_URDF_TEXTS)
    if rng.random() < 0.3:
        data = texts.mutated(data, rng, _URDF_TEXTS, texts.XML)
    return Case("model.urdf", {**_around(rng), "model.urdf": data}, tier=_tier(rng))


def _reading(rng: Random) -> Case:
    """A robot in one of its many spellings."""
    return Case("model.urdf", {"model.urdf": readings.write_robot(rng, xacro=False)}, reading=True)


def _xacro_reading(rng: Random) -> Case:
    return Case("model.urdf.xacro", {"model.urdf.xacro": readings.write_robot(rng, xacro=True)}, reading=True)


def _xacro(rng: Random) -> Case:
    language = Language()
    plain = True
    if rng.random() < 0.8:
        data = trees.mutated(rng.choice(_XACRO), rng, _XACRO_WORDS, language.element, language.value)
    else:
        data, plain = texts.mutated(rng.choice(_XACRO_TEXTS), rng, _XACRO_TEXTS, texts.XML), False
    files = {
        **_around(rng),
        "model.urdf.xacro": data,
        "parts.xacro": seeds.PARTS.encode(),
        "values.yaml": seeds.YAML.encode(),
    }
    if rng.random() < 0.1:
        files["parts.xacro"] = trees.mutated(_XACRO[1], rng, _XACRO_WORDS, language.element, language.value)
    return Case("model.urdf.xacro", files, tier=_tier(rng), plain=plain and not language.hostile)


def _expression(rng: Random) -> Case:
    """A model that says nothing but expressions."""
    language = Language()
    values = [language.value(rng) for _ in range(rng.choice((1, 1, 2, 4)))]
    tree = trees.Node("robot", [("name", "r"), ("xmlns:xacro", "http://www.ros.org/wiki/xacro")])
    tree.children.append(trees.Node("xacro:property", [("name", "size"), ("value", "3")]))
    tree.children.append(trees.Node("xacro:property", [("name", "names"), ("value", "${['a', 'b']}")]))
    tree.children.append(trees.Node("xacro:property", [("name", "data"), ("value", "${load_yaml('values.yaml')}")]))
    for index, value in enumerate(values):
        tree.children.append(trees.Node("xacro:property", [("name", f"v{index}"), ("value", value)]))
        tree.children.append(trees.Node("link", [("name", f"${{v{index}}}")]))
    files = {**_around(rng), "model.urdf.xacro": utf8(tree.write()), "values.yaml": seeds.YAML.encode()}
    return Case("model.urdf.xacro", files, plain=not language.hostile)


_TAGS = (
    "!degrees",
    "!radians",
    "!!python/object/apply:os.system",
    "!!python/name:os.system",
    "!!binary",
    "!!float",
    "!!int",
)
_TAGS += ("!!timestamp", "!!set", "!!omap", "!x", "!!bool", "!!null", "!!map", "!!seq", "!millimeters", "!meters", "!")
_SCALARS = (
    "&a [*a]",
    "&a {b: *a}",
    "*defaults",
    "*missing",
    "{}",
    "[]",
    "~",
    "0b1",
    "0o7",
    "012",
    "12:30:45",
    "2020-01-01",
    "yes",
)
_SCALARS += (
    ".inf",
    "-.inf",
    ".nan",
    "'",
    '"',
    "|",
    ">-",
    "? a",
    ": b",
    "- - - 1",
    "[1, [2, [3]]]",
    "{a: {b: {c: 1}}}",
    "\t1",
    "@a",
    "%a",
)
_SCALARS += (
    "[" * 200 + "]" * 200,
    "{a: " * 100 + "1" + "}" * 100,
    "[" * 3000,
    "pi/2",
    "${size}",
    "$(arg size)",
    "2*pi**pi",
    "--- 1",
    "...",
)
_SCALARS += (
    '"\\0"',
    '"\\uD800"',
    '"\\x1b[31m"',
    "1e9999999",
    "1" * 5000,
    "0x" + "f" * 3000,
    "<<",
    "=",
    "&b 1",
    "{1: 2, true: 3, ~: 4, [1]: 5}",
)
# Each line says the one before nine times.
_LAUGHS = "a0: &a0 [x,x,x,x,x,x,x,x,x]\n" + "".join(
    f"a{i}: &a{i} [{','.join([f'*a{i - 1}'] * 9)}]\n" for i in range(1, 9)
)
_MERGES = "a0: &a0 {x: 1}\n" + "".join(f"a{i}: &a{i} {{<<: [{','.join([f'*a{i - 1}'] * 9)}]}}\n" for i in range(1, 9))


def _yaml(rng: Random) -> Case:
    def scalar(data: bytes, rng: Random, _others: object) -> bytes:
        lines = data.split(b"\n")
        at = rng.randrange(len(lines))
        key = lines[at].partition(b":")[0]
        tag = f"{rng.choice(_TAGS)} " if rng.random() < 0.4 else ""
        lines[at] = key + b": " + utf8(tag + rng.choice((*_SCALARS, *nasty.NUMBERS, *nasty.NAMES)))
        return b"\n".join(lines)

    def bomb(data: bytes, rng: Random, _others: object) -> bytes:
        return rng.choice((_LAUGHS, _MERGES)).encode() + data

    kinds = (*texts.TEXT, texts.encoding, *((scalar,) * 12), bomb)
    data = texts.mutated(seeds.YAML.encode(), rng, [seeds.YAML.encode(), *_URDF_TEXTS], kinds)
    files = {**_around(rng), "model.urdf.xacro": seeds.READER.encode(), "values.yaml": data}
    return Case("model.urdf.xacro", files)


def _launch(rng: Random) -> Case:
    data = rng.choice(_LAUNCH_TEXTS)
    if rng.random() < 0.75:
        data = trees.mutated(rng.choice(_LAUNCH), rng, _LAUNCH_WORDS, value=_substitution)
    if rng.random() < 0.3:
        data = texts.mutated(data, rng, _LAUNCH_TEXTS, texts.XML)
    files = {**_MODEL, rng.choice(("it.launch", "it.launch.xml")): data, "other.launch": seeds.OTHER_LAUNCH.encode()}
    if rng.random() < 0.2:
        files["other.launch"] = trees.mutated(rng.choice(_LAUNCH), rng, _LAUNCH_WORDS, value=_substitution)
    entry = next(name for name in files if name.startswith("it."))
    return Case(entry, files, tier=rng.choice(("source", "source", "source", "mesh")))


_SUBSTITUTIONS = (
    "arg",
    "var",
    "find",
    "find-pkg-share",
    "dirname",
    "env",
    "optenv",
    "eval",
    "command",
    "anon",
    "exec-in-pkg",
)
_SUBSTITUTIONS += ("find-exec", "path-join", "not", "equals", "if", "x", "")


def _substitution(rng: Random, depth: int = 2) -> str:
    words = [
        rng.choice(("model", "x", "gui", "robot", "'xacro $(var model)'", "cat /etc/passwd", *nasty.NAMES))
        for _ in range(2)
    ]
    if depth and rng.random() < 0.4:
        words.append(_substitution(rng, depth - 1))
    text = f"$({rng.choice(_SUBSTITUTIONS)} {' '.join(words)})"
    return text + rng.choice(("", "", "/model.urdf", "/../../outside.xacro", ")", "$(", "'", *nasty.PATHS[:10]))


def _python(rng: Random) -> Case:
    others = [seeds.LAUNCH_PY.encode(), b"import os\nos.system('touch CANARY')\nopen('CANARY', 'w')\n"]
    data = texts.mutated(others[0], rng, others, texts.CODE)
    if rng.random() < 0.05:
        odd = (
            "(" * 500,
            "x = " + "-" * 20_000 + "1\n",
            "a" * 10**6,
            "if 1:\n" * 200,
            "x = " + "(" * 180 + ")" * 180,
            "é = 1\n" * 5,
            "#" * 10**6,
        )
        odd += (
            "# -*- coding: " + rng.choice(nasty.ENCODINGS) + " -*-\n",
            "class A:\n" * 120,
            "x = " + "1+" * 30_000 + "1\n",
            "x" + ".a" * 20_000,
        )
        data = rng.choice((rng.choice(odd).encode() + data, data + rng.choice(odd).encode()))
    files = {**_MODEL, "it.launch.py": data, "urdf/made.urdf.xacro": seeds.LOOP.encode()}
    return Case("it.launch.py", files)


def _srdf(rng: Random) -> Case:
    data = trees.mutated(_SRDF, rng, _SRDF_WORDS) if rng.random() < 0.8 else seeds.SRDF.encode()
    if rng.random() < 0.3:
        data = texts.mutated(data, rng, [seeds.SRDF.encode()], texts.XML)
    name = rng.choice(("arm.srdf", "config/arm.srdf", "arm.srdf.xacro"))
    return Case("model.urdf", {**_MODEL, name: data}, tier=rng.choice(("source", "source", "source", "source", "full")))


def _package(rng: Random) -> Case:
    data = trees.mutated(_PACKAGE, rng, _PACKAGE_WORDS) if rng.random() < 0.8 else seeds.PACKAGE.encode()
    if rng.random() < 0.3:
        data = texts.mutated(data, rng, [seeds.PACKAGE.encode()], texts.XML)
    return Case("", {**_MODEL, "package.xml": data})


def _mesh(name: str) -> Callable[[Random], Case]:
    def make_mesh(rng: Random) -> Case:
        file = f"part.{name if rng.random() < 0.95 else name.upper()}"
        tier = "full" if rng.random() < 0.1 else "mesh"
        model = seeds.MESHED.format(name=file).encode()
        files = {"model.urdf": model, f"meshes/{file}": meshes.mutated(name, rng)}
        if rng.random() < 0.2:
            files["package.xml"] = _COMMON["package.xml"]
        else:
            files["model.urdf"] = model.replace(b"package://robot/", b"")
        return Case("model.urdf", files, tier=tier, mesh=f"meshes/{file}")

    return make_mesh


def _reference(rng: Random) -> Case:
    """Files that are none, and ways that lead elsewhere: pipes, devices, circles of links, folders."""
    links = {
        "loop.stl": "loop.stl",
        "chain.stl": "chain2.stl",
        "chain2.stl": "chain.stl",
        "zero.stl": "/dev/zero",
        "outside.stl": "../outside.yaml",
        "self": ".",
        "up": "..",
        "gone.stl": "nowhere",
    }
    paths = (
        *nasty.PATHS,
        *links,
        *(f"package://robot/{name}" for name in links),
        "self/" * 30 + "pipe.stl",
        "up/outside.yaml",
    )
    path = rng.choice(paths)
    quoted = trees.Node("mesh", [("filename", path)]).write()
    kind = rng.randrange(4)
    model = f'<robot name="r"><link name="a"><visual><geometry>{quoted}</geometry></visual></link></robot>'
    files = {**_COMMON, "folder.stl/a": b""}
    if kind == 1:
        included = trees.Node("xacro:include", [("filename", path)]).write()
        model = f'<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">{included}<link name="a"/></robot>'
    elif kind == 2:
        read = trees.Node("xacro:property", [("name", "d"), ("value", f"${{load_yaml({path!r})}}")]).write()
        model = f'<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">{read}<link name="${{d}}"/></robot>'
    elif kind == 3:
        included = trees.Node("include", [("file", rng.choice((path, f"$(dirname)/{path}")))]).write()
        param = trees.Node("param", [("name", "robot_description"), ("textfile", f"$(find robot)/{path}")]).write()
        model = f"<launch>{included}{param}</launch>"
    entry = ("model.urdf", "model.urdf.xacro", "model.urdf.xacro", "it.launch")[kind]
    entry = rng.choice((entry, entry, ""))
    name = entry or ("model.urdf", "model.urdf.xacro", "model.urdf.xacro", "it.launch")[kind]
    return Case(entry, {**files, name: utf8(model)}, tier="mesh", links=links, pipes=("pipe.stl",))


MAKERS: Mapping[str, Callable[[Random], Case]] = {
    "urdf": _urdf,
    "xacro": _xacro,
    "reading": _reading,
    "xacro-reading": _xacro_reading,
    "expression": _expression,
    "yaml": _yaml,
    "launch": _launch,
    "python": _python,
    "srdf": _srdf,
    "package": _package,
    "reference": _reference,
    **{name: _mesh(name) for name in meshes.SOUND},
}
