"""One small robot in every spelling: encodings, entities, comments, instructions, namespaces, blanks; and who reads it how.

urdfdom (through Pinocchio) and plain xacro are asked. Where nothing is reported as an error they must read the same links, tree
and masses as we do: else a part of the file was never checked.
"""

from __future__ import annotations

import contextlib
import io
from pathlib import Path
from random import Random

XACRO = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
_NAMES = (
    "a",
    "b c",
    "ä",
    "名",
    "a\tb",
    "a\nb",
    "a&b",
    "a<b",
    "a>b",
    'a"b',
    "e\u0301",
    "a\u00a0b",
    " a",
    "a ",
    "a  b",
    "A",
    "a'b",
)
_MASSES = ("1", "1.5", " 2", "2 ", "\t3", "+4", "1e0", "5.", ".5", "1e-3")
_ODD_MASSES = ("１", "1\u00a0", "1 2", "0x1", "1,5", "", "inf", "1_0", "1\x0b", "\u22121")
_COMMENTS = (
    "<!-- c -->",
    "<!---->",
    "<!-- - -->",
    "<!-- -- -->",
    "<!--->",
    "<!-- é 名 -->",
    "<!-- &amp; &x; -->",
    "<!-- a --->",
)
_COMMENTS += (
    "<!-- <link name='hidden'/> -->",
    "<!-- ${1 + 1} $(arg x) -->",
    "<!-- xacro:eval-comments --><!-- ${'a'} -->",
)
_INSTRUCTIONS = ("<?x y?>", "<?xml version='1.0'?>", "<?xml-model href='a'?>", "<?x?>", "<? x?>")
_TEXTS = (
    "text",
    "&amp;",
    "&#65;",
    "&lt;link name='hidden'/>",
    "<![CDATA[x]]>",
    "<![CDATA[<link name='hidden'/>]]>",
    "\ufeff",
    "é",
)
_BAD_TEXTS = (
    "&nbsp;",
    "&#0;",
    "&",
    "<",
    "]]>",
    "\x01",
    "\x0b",
    "\x7f",
    "\u2028",
    "\ufffe",
    "\0",
    "&#x110000;",
    "&#xD800;",
)
_ELEMENTS = (
    "<x:y xmlns:x='u'/>",
    "<x:link name='hidden' xmlns:x='u'/>",
    "<x:y/>",
    "<y xmlns='u'/>",
    "<xml:y/>",
    "<_/>",
    "<é/>",
)
_ELEMENTS += (
    "<link xmlns='u' name='second'/>",
    "<Link name='hidden'/>",
    "<y a='1' a='2'/>",
    "<y a=1/>",
    "<y a='<'/>",
    "<y a='1'b='2'/>",
)
_DOCTYPES = ("<!DOCTYPE robot>", "<!DOCTYPE robot [<!ENTITY e 'x'>]>")
_CODECS = ("utf-8",) * 20 + (
    "utf-8-sig",
    "latin-1",
    "cp1252",
    "utf-16",
    "utf-16-le",
    "utf-16-be",
    "utf-7",
    "hz",
    "gbk",
    "big5",
)
_CODECS += (
    "shift_jis",
    "shift_jis_2004",
    "iso2022_jp",
    "iso2022_kr",
    "cp864",
    "cp037",
    "koi8-r",
    "utf-32",
    "ascii",
    "euc_jp",
)
_DECLARED = (
    *_CODECS[5:],
    "UTF8",
    "utf_8",
    "klingon",
    "",
    "unicode-escape",
    "idna",
    "windows-1252",
    "iso-8859-15",
    "UTF-16LE",
)
# What begins and ends a comment for a program that decodes the bytes, and is text for one that does not.
_HIDING = (
    ("+ADwAIQAtAC0-", "+AC0ALQA+-"),
    ("<!--~\n", "-->"),
    ("\x1b$B!!\x1b(B", "\x1b(B"),
    ("+-", "+-"),
    ("~{", "~}"),
    ("\\", "~"),
)


def _spell(text: str, rng: Random) -> str:
    """A text as the value of an attribute; each character as it is, as an entity, or as another blank."""
    escaped = {"&": "&amp;", "<": "&lt;", '"': "&quot;"}
    parts = []
    for character in text:
        chance = rng.random()
        if chance < 0.08:
            parts.append(rng.choice((f"&#{ord(character)};", f"&#x{ord(character):x};")))
        elif character in " \t\n" and chance < 0.15:
            parts.append(rng.choice((" ", "\t", "\n", "\r\n", "\r", "&#9;", "&#10;", "&#32;")))
        else:
            parts.append(escaped.get(character, character))
    return "".join(parts)


def _filler(rng: Random, odd: float) -> str:
    """What stands between two elements and means nothing to a robot."""
    if rng.random() >= odd:
        return "\n"
    kinds = (_COMMENTS, _COMMENTS, _TEXTS, _ELEMENTS, _INSTRUCTIONS, _BAD_TEXTS)
    return rng.choice(rng.choice(kinds))


def write_robot(rng: Random, *, xacro: bool) -> bytes:
    """The bytes of a robot of two to four links in a chain."""
    odd = rng.choice((0.0, 0.0, 0.02, 0.05, 0.1, 0.2))
    names = rng.sample(_NAMES, rng.choice((2, 3, 4))) if rng.random() < 0.6 else ["a", "b", "c"][: rng.choice((2, 3))]
    masses = _MASSES if rng.random() < 0.95 else (*_MASSES, *_ODD_MASSES)
    parts = []
    for index, name in enumerate(names):
        mass, filler = _spell(rng.choice(masses), rng), _filler(rng, odd)
        inertia = '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>'
        parts.append(
            f'<link name="{_spell(name, rng)}">{filler}<inertial><mass value="{mass}"/>{inertia}</inertial></link>'
        )
        if index:
            ends = f'<parent link="{_spell(names[index - 1], rng)}"/>{_filler(rng, odd)}<child link="{_spell(name, rng)}"/>'
            parts.append(f'<joint name="j{index}" type="continuous">{ends}<axis xyz="0 0 1"/></joint>')
    if rng.random() < 0.08:
        begin, end = rng.choice(_HIDING)
        at = rng.randrange(len(parts))
        parts[at] = begin + parts[at] + end
    inside = "".join(part + _filler(rng, odd) for part in parts)
    namespace = XACRO if xacro or rng.random() < 0.2 else ""
    text = f'<robot name="r" {namespace}>{_filler(rng, odd)}{inside}</robot>{_filler(rng, odd / 4)}'
    codec = rng.choice(_CODECS)
    declared = codec if rng.random() < 0.7 else rng.choice(_DECLARED)
    prolog = (
        "" if rng.random() < 0.3 else f'<?xml version="1.0"{" " * rng.choice((1, 1, 1, 500))}encoding="{declared}"?>\n'
    )
    if rng.random() < odd:
        kinds = ("\n", "\ufeff", " ", *_COMMENTS[:3], *_INSTRUCTIONS, *_DOCTYPES)
        prolog = rng.choice((prolog + rng.choice(kinds), rng.choice(kinds) + prolog))
    data = (prolog + text).encode(codec, rng.choice(("xmlcharrefreplace", "ignore", "replace")))
    # The declaration of a codec that changes ASCII stays readable, as an attacker would write it.
    return data if rng.random() < 0.8 or codec.startswith("utf-") else (prolog + text).encode("utf-8", "ignore")


def find_difference(path: Path) -> str | None:
    """Say how urdfdom, behind plain xacro for a xacro, reads a file otherwise than we do; None if it does not."""
    from urdfcheck.source.load import load_source
    from urdfcheck.source.package.finder import PackageFinder

    root = load_source(path, {}, PackageFinder(path, environment={})).root
    if root is None:
        return "nothing was read, and nothing is said of it"
    ours = sorted(link.get("name") for link in root.find_children("link"))
    data: str | None = None
    if path.suffix == ".xacro":
        import xacro

        with contextlib.redirect_stderr(io.StringIO()), contextlib.redirect_stdout(io.StringIO()):
            try:
                data = xacro.process_file(str(path)).toprettyxml(indent="  ")
                data.encode()
            except Exception as error:
                return f"plain xacro refuses it: {type(error).__name__}: {error}"
    return _compare(ours, root, path, data)


def _compare(ours: list[str], root: object, path: Path, data: str | None) -> str | None:
    import pinocchio

    from urdfcheck.model.motion.pinocchio_model import capture_stderr
    from urdfcheck.source.text.values import parse_number
    from urdfcheck.source.text.xml import Element

    assert isinstance(root, Element)
    with capture_stderr():
        try:
            model = pinocchio.buildModelFromUrdf(str(path)) if data is None else pinocchio.buildModelFromXML(data)
        except (ValueError, RuntimeError) as error:
            return f"urdfdom refuses it: {error}"
    try:
        bodies = {frame.name: frame for frame in model.frames if frame.type == pinocchio.FrameType.BODY}
    except UnicodeDecodeError:
        return "urdfdom reads a name that is not UTF-8"
    if sorted(bodies) != sorted(ours):
        return f"urdfdom reads the links {sorted(bodies)!r}, and we read {ours!r}"
    joints = {e.get("link"): j.get("name") for j in root.find_children("joint") for e in j.find_children("child")}
    for link in root.find_children("link"):
        inertial = link.find_child("inertial")
        mass = None if inertial is None else inertial.find_child("mass")
        number = None if mass is None else parse_number(mass.get("value"))
        name = link.get("name")
        if name in joints and number is not None:
            theirs = model.inertias[model.getJointId(joints[name])].mass
            if abs(theirs - number) > 1e-12:
                return f"urdfdom reads the mass {theirs!r} of {name!r}, and we read {number!r}"
    return None
