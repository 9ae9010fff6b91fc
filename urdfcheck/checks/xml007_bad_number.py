"""XML007 reports numbers that the reference parser cannot read."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterator
from typing import Any

from urdfcheck.core import Applicability, Edit, Finding, Rule, Severity
from urdfcheck.core.text import truncate_text
from urdfcheck.model import Model
from urdfcheck.model.repairs.edits import edit_literal
from urdfcheck.source.text.engine_reactions import describe_empty_number, describe_loss, describe_number_in_python
from urdfcheck.source.text.grammar import CHILDREN, NUMERIC_ATTRIBUTES, is_unexpanded, iter_first_elements
from urdfcheck.source.text.values import DECIMAL, MAX_MAGNITUDE, has_unskipped_blank, is_computable, parse_number
from urdfcheck.source.text.xml import Attribute, Element
from urdfcheck.source.xacro.usage import collect_macros, collect_properties, iter_elements_by_tag

_NOT_A_NUMBER = re.compile(r"[+-]?nan(\(\w*\))?", re.IGNORECASE)
_INFINITE = re.compile(r"[+-]?inf(inity)?", re.IGNORECASE)
_HEXADECIMAL = re.compile(r"[+-]?0x[0-9a-f.]+(p[+-]?\d+)?", re.IGNORECASE)
_UNIT = re.compile(r"([+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?) ?([A-Za-zµμ°%\"'][A-Za-z0-9µμ°%·*^/²³]*)")
_EXPRESSION = re.compile(r"(?=[\w.\s()*/+-]*\Z)[\w.\s()]*(?:[*/()]|\bpi\b|\bM_PI\b).*", re.IGNORECASE | re.DOTALL)
_BRACED = re.compile(r"\$\{([^{}]*)\}")
# One number of an attribute: blanks inside ${…} do not separate.
_TYPED_WORD = re.compile(r"(?:\$\{[^{}]*\}|\S)+")
_THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2},\d{3}")
_UNITS = frozenset({
    "m", "mm", "cm", "dm", "um", "µm", "km", "in", "inch", "inches", "ft", "g", "kg", "t", "lb", "lbs", "oz", "rad",
    "deg", "degree", "degrees", "°", "%", "n", "nm", "mnm", "n*m", "n·m", "nmm", "s", "ms", "rpm", "rad/s", "deg/s",
    "m/s", "mm/s", "kgm2", "kg*m2", "kg·m2", "kgm^2", "kg*m^2", "kg·m²", "kgm²", "gmm2", "g*mm2", "g*mm^2", '"', "'",
})  # fmt: skip
# These numbers go into computations and not only comparisons: a limit of 1e308 means that there is no limit.
_MEASURED = frozenset({"origin", "mass", "inertia", "axis", "box", "cylinder", "capsule", "sphere", "mesh"})
_SI = frozenset({"m", "kg", "rad", "n", "nm", "n*m", "n·m", "s", "rad/s", "m/s"})


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    for element in iter_first_elements(model.robot):
        if _is_spare_shape(element):
            continue
        for name, count in NUMERIC_ATTRIBUTES.get(element.tag, {}).items():
            attribute = element.attributes.get(name)
            if attribute is None or is_unexpanded(attribute.value):
                continue
            verdict = _classify_value(attribute.value, count)
            if verdict is not None:
                message, word, better = verdict
                if message == "expression" and _has_text_outside(attribute.typed, count):
                    yield _build_outside_finding(rule, element, attribute, count)
                    continue
                edits = _propose_edits(attribute, word, better)
                reactions = describe_empty_number(element, name) if message == "empty" else {}
                yield rule.finding(
                    message,
                    at=attribute,
                    edits=edits,
                    related=attribute.collect_definitions(),
                    consequences={
                        "urdfdom": describe_loss(element),
                        **describe_number_in_python(element, name, attribute.value),
                        **reactions,
                    },
                    **_collect_data(attribute, word),
                    repair=_describe_name(model, word)
                    if message == "other"
                    else _describe_repair(attribute.value, word, count, in_xacro=model.source.is_xacro),
                    thousands=f", or no comma if {word} is in the thousands" if _THOUSANDS.fullmatch(word) else "",
                )
            elif (extreme := _find_extreme_number(attribute)) is not None:
                yield rule.finding(
                    "extreme", at=attribute, severity=Severity.WARNING, **_collect_data(attribute, extreme)
                )
            elif _has_blank(attribute, count, plain=not model.source.is_xacro):
                edits = _propose_edits(attribute, attribute.typed, " ".join(attribute.typed.split()))
                yield rule.finding(
                    "blank",
                    at=attribute,
                    edits=edits,
                    applicability=Applicability.SAFE,
                    consequences={"urdfdom": describe_loss(element)},
                    **_collect_data(attribute, attribute.value),
                )


def _has_text_outside(typed: str, count: int) -> bool:
    """Whether one of the numbers of an attribute is typed partly inside ``${…}`` and partly outside."""
    words = _TYPED_WORD.findall(typed)
    return any("${" in word and not _BRACED.fullmatch(word) for word in words) or (
        "${" in typed and len(words) != count
    )


def _describe_repair(value: str, word: str, count: int, *, in_xacro: bool) -> str:
    """Say how an expression is computed: in a xacro file it lacks only the braces, around the whole value of one number."""
    if not in_xacro:
        return "write the result, or make the file a xacro and write `${…}`"
    whole = value.strip() if count == 1 else word if len(value.split()) == count else "…"
    return f"write `${{{whole.strip('{}')}}}`: xacro computes only what is inside"


def _describe_name(model: Model, word: str) -> str:
    """Say what to write for a word: where a xacro has a name of this spelling, its value is meant."""
    trees, name = model.source.trees, word.strip("{}")
    if model.source.is_xacro and name in {e.get("name") for e in iter_elements_by_tag(trees, "xacro:arg")}:
        return f"write `$(arg {name})`"
    parameters = (parameter for macro in collect_macros(trees).values() for parameter in macro.parameters)
    if model.source.is_xacro and name in {*collect_properties(trees), *parameters}:
        return f"write `${{{name}}}`"
    return "write a number such as 0.5 or 1e-3"


def _build_outside_finding(rule: Rule, element: Element, attribute: Attribute, count: int) -> Finding:
    """Report an expression of which xacro computes only parts."""
    return rule.finding(
        "outside",
        at=attribute,
        related=attribute.collect_definitions(),
        consequences={
            "urdfdom": describe_loss(element),
            **describe_number_in_python(element, attribute.name, attribute.value),
        },
        where=f"{attribute.owner.subject}@{attribute.name}",
        attribute=attribute.name,
        value=truncate_text(attribute.value, 60),
        joined=_join_expressions(attribute.typed, count),
    )


def _join_expressions(typed: str, count: int) -> str:
    """Return ``${a + b} * ${c}`` as ``: `${(a + b) * c}```, or nothing if it is open where each number of an attribute ends."""
    words = _TYPED_WORD.findall(typed) if count > 1 else [typed.strip()]
    if len(words) != count:
        return ""
    joined = (word if "${" not in word or _BRACED.fullmatch(word) else _join_expression(word) for word in words)
    return f": `{' '.join(joined)}`"


def _join_expression(word: str) -> str:
    inner = _BRACED.sub(lambda m: m[1] if re.fullmatch(r"[\w.]+", m[1]) else f"({m[1]})", word)
    return f"${{{inner}}}"


def _is_spare_shape(element: Element) -> bool:
    """Whether an element is a further shape of a geometry, which urdfdom and Bullet do not read: XML006 reports that."""
    parent = element.parent
    if parent is None or parent.tag != "geometry":
        return False
    return next(child for child in parent.children if child.tag in CHILDREN["geometry"]) is not element


def _collect_data(attribute: Attribute, word: str) -> dict[str, Any]:
    names = [unicodedata.name(c, f"U+{ord(c):04X}").lower() for c in word if not c.isascii()]
    return {
        "where": f"{attribute.owner.subject}@{attribute.name}",
        "attribute": attribute.name,
        "word": truncate_text(word, 40),
        "character": names[0] if names else "",
    }


def _propose_edits(attribute: Attribute, word: str, better: str | None) -> list[Edit]:
    """Replace a word of a literal attribute; nothing if the repair is not certain."""
    if better is None or attribute.typed.count(word) != 1:
        return []
    return edit_literal(attribute, attribute.typed.replace(word, better))


def _classify_value(value: str, count: int) -> tuple[str, str, str | None] | None:
    """Return the message for a value with a malformed number, the word and its correction, or None if it is well-formed."""
    words = value.split()
    if not words:
        return "empty", value, None
    if all(parse_number(word) is not None for word in words):
        return _classify_foreign_blank(value)
    if count == 1 and len(words) > 1 and _UNIT.fullmatch(value.strip()):
        words = [value.strip()]
    separated = [w for w in re.split(r"[,;\s]+", value) if w]
    if len(separated) == count > 1 and all(parse_number(w) is not None for w in separated):
        return "separator", value.strip(), " ".join(separated)
    word = next(w for w in words if parse_number(w) is None)
    return _classify_word(word)


def _classify_foreign_blank(value: str) -> tuple[str, str, str | None] | None:
    """Report a non-breaking space, which separates words for Python and not for parsers of URDF."""
    return None if value.isascii() else ("character", value, " ".join(value.split()))


def _classify_word(word: str) -> tuple[str, str, str | None]:
    if _NOT_A_NUMBER.fullmatch(word):
        return "nan", word, None
    if _INFINITE.fullmatch(word):
        return "infinite", word, None
    if _HEXADECIMAL.fullmatch(word):
        return "hexadecimal", word, None
    unit = _UNIT.fullmatch(word)
    if unit and unit.group(2).lower() in _UNITS:
        return "unit", word, unit.group(1) if unit.group(2).lower() in _SI else None
    if not word.isascii():
        ascii_word = re.sub("[\u2010-\u2015\u2212\ufe63\uff0d]", "-", word)
        return "character", word, ascii_word if parse_number(ascii_word) is not None else None
    if "_" in word and parse_number(word.replace("_", "")) is not None:
        return "underscore", word, word.replace("_", "")
    if word.count(",") == 1 and parse_number(word.replace(",", ".")) is not None:
        # 1,000 may mean one or a thousand; 0,000 and 0,5 cannot mean thousands.
        return "comma", word, None if _THOUSANDS.fullmatch(word) else word.replace(",", ".")
    if DECIMAL.fullmatch(word):  # a decimal number that is not finite
        return "overflow", word, None
    if _EXPRESSION.fullmatch(re.sub(r"^\{(.*)\}$", r"\1", word)):
        return "expression", word, None
    return "other", word, None


def _find_extreme_number(attribute: Attribute) -> str | None:
    """Return the first number with which no check can compute; small ones count as zero, except a mass, a divisor."""
    tag = attribute.owner.tag
    for word in attribute.value.split() if tag in _MEASURED else ():
        value = parse_number(word) or 0.0
        if abs(value) > MAX_MAGNITUDE or (tag == "mass" and not is_computable(value)):
            return word
    return None


def _has_blank(attribute: Attribute, count: int, *, plain: bool) -> bool:
    """Whether urdfdom does not skip some white space; xacro writes tabs and line breaks as spaces."""
    return has_unskipped_blank(attribute.typed if plain and attribute.literal else attribute.value, count)
