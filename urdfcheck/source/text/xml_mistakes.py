"""What is wrong where expat stops: its own messages name neither the mistake nor the other end of it."""

from __future__ import annotations

import difflib
import itertools
import re
from collections.abc import Sequence
from typing import Any
from xml.parsers import expat
from xml.parsers.expat import ErrorString, errors

from urdfcheck.core.records import dataclass

_GENERAL_REPAIR = (
    "fix the XML here: check for a missing `>`, quote or end tag, or a `&` that should be `&amp;`, just before it"
)
# What is not among the characters of XML (production 2): listed, because the complement of its ranges takes 8 ms to compile.
NO_CHARACTER = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]")
_NAME = re.compile(r"[^\s<>/=\"'&]+")
# A value without its closing quote: the next quote is that which opens the value of the attribute after it.
_SWALLOWED = re.compile(r"""([^\s<>/="'&]{1,100})\s*=\s*(["'])([^"'<>=]{0,200}?)\s+[\w:.-]{1,100}\s*=\s*\2\Z""")
_ENTITY = re.compile(r"&([^\s;<>&\"'#][^\s;<>&\"']*);")
_OPEN_ENTITY = re.compile(r"&[#\w.:-]{0,40}\Z")
ENTITIES = frozenset({"amp", "lt", "gt", "quot", "apos"})
_TYPOGRAPHIC = "“”„‟″‘’‚′«»"
# A larger file than any robot's is not parsed again to try a repair.
_LARGEST_TRIED = 5_000_000
# How much of a name is shown.
_MOST_SHOWN = 60
_COMMENT = re.compile(r"<!--(.*?)(?:-->|\Z)", re.DOTALL)
# ``<your-package>`` in a value, for the reader to replace; and the rest of its line.
_PLACEHOLDER = re.compile(r"<([A-Za-z]\w*(?:[ _.-]\w+)*)>([^\n<]*)")
# A start tag that someone made the beginning of a comment.
_HALF_COMMENTED = re.compile(r"""<!--([A-Za-z_][\w:.-]*)(?:\s+[\w:.-]+\s*=\s*(?:"[^"]*"|'[^']*'))*\s*>""")
# What someone typed for the beginning of a comment.
_HALF_OPENER = re.compile(r"<(?:-{1,2}|!-)(?!-)")
# An end tag whose slash expat does not accept: outside of the root element no tag may begin so.
_END_TAG = re.compile(r"</([^\s<>/=\"'&]+)\s*>")
# The line with which git begins a conflict, and the name of a tag that is followed by what cannot follow it.
_CONFLICT = re.compile(r"^<{7}(?: |$)", re.MULTILINE)
# What an XML declaration says.
_SAID_BY_DECLARATION = ("version", "encoding", "standalone")
_DECLARATION = re.compile(r"<\?xml\s[^<>]*\?>")
_TAG = re.compile(r"<[^\s<>/=\"'&!?]")
_NAMED = re.compile(r"""<([^\s<>/="'&!?]+)\s(?:[^<>]{0,500}?\s)?name\s*=\s*(["'])([^"'<>]*)\2""")
_TAG_NAME = re.compile(r"[A-Za-z_][\w.:-]*\Z")
# The roots of files that hold parts of them.
_WHOLES = {
    **dict.fromkeys(("link", "joint", "material", "gazebo", "transmission", "ros2_control"), "robot"),
    **dict.fromkeys(("xacro:include", "xacro:macro", "xacro:property", "xacro:arg"), "robot"),
    **dict.fromkeys(("node", "param", "rosparam", "include", "group", "arg", "let"), "launch"),
}
# Closed without attributes, these are refused, or say nothing: someone began to type one.
_EMPTY_WITHOUT_ATTRIBUTES = frozenset(
    {
        *("xacro:property", "xacro:arg", "xacro:include", "xacro:insert_block"),
        *("parent", "child", "mass", "inertia", "origin", "axis", "limit", "dynamics", "mimic", "safety_controller"),
        *("box", "cylinder", "sphere", "mesh", "color", "texture"),
        *("arg", "param", "remap", "env"),
    }
)


@dataclass(frozen=True, slots=True)
class XmlMistake:
    """A mistake, the offsets of its text, and how to fix it."""

    message: str
    start: int
    end: int
    repair: str = _GENERAL_REPAIR
    forgiven: bool = False
    """Whether tinyxml2, the parser of urdfdom and MuJoCo, loads the file."""


def describe_mistake(text: str, at: int, code: int, opened: list[tuple[str, int]]) -> XmlMistake:
    """Return the mistake at which expat stopped.

    :param at: the offset at which it stopped.
    :param code: its error.
    :param opened: the tag and line of each element that is open there, outermost first; of the root if it is closed again.
    """
    message = ErrorString(code)
    if not text.strip():
        return XmlMistake("the file is empty", at, at, "write its content, or delete the file and what includes it")
    describe = {
        errors.XML_ERROR_INVALID_TOKEN: _describe_token,
        errors.XML_ERROR_SYNTAX: _describe_text_before_root,
        errors.XML_ERROR_TAG_MISMATCH: _describe_end_tag,
        errors.XML_ERROR_UNDEFINED_ENTITY: _describe_entity,
        errors.XML_ERROR_JUNK_AFTER_DOC_ELEMENT: _describe_junk,
        errors.XML_ERROR_MISPLACED_XML_PI: _describe_declaration,
        errors.XML_ERROR_XML_DECL: _describe_name_in_declaration,
        errors.XML_ERROR_DUPLICATE_ATTRIBUTE: _describe_duplicate,
        errors.XML_ERROR_NO_ELEMENTS: _describe_end_of_file,
        errors.XML_ERROR_UNCLOSED_TOKEN: _describe_unclosed,
        errors.XML_ERROR_UNCLOSED_CDATA_SECTION: _describe_unclosed,
    }.get(message)
    mistake = None if describe is None else describe(text, at, opened)
    return mistake or XmlMistake(message, at, min(at + 1, len(text)))


def _describe_name_in_declaration(text: str, at: int, _opened: list[tuple[str, int]]) -> XmlMistake | None:
    """Return the name that expat does not know in the XML declaration: ``verison``."""
    name = _NAME.match(text, at)
    if name is None or name[0] in _SAID_BY_DECLARATION:
        return None
    near = difflib.get_close_matches(name[0].lower(), _SAID_BY_DECLARATION, 1)
    repair = f"write `{near[0]}`" if near else "delete it"
    return XmlMistake(f"the XML declaration cannot say `{name[0][:_MOST_SHOWN]}`", at, name.end(), repair)


def _describe_token(text: str, at: int, opened: list[tuple[str, int]]) -> XmlMistake | None:
    """Return what is wrong with characters that expat cannot interpret."""
    before, here = text[:at], text[at : at + 1]
    if before.endswith("--") and before.rfind("<!--", 0, at - 2) > before.rfind("-->"):
        opener = before.rfind("<!--", 0, at - 4)
        if before.endswith("<!--") and opener > before.rfind("-->"):
            line = text.count("\n", 0, opener) + 1
            message = f"a comment begins inside the comment of line {line}"
            repair = f"end the comment of line {line} before this `<!--`{_describe_whole_comment(text, at)}"
            # Behind the root element, tinyxml2 takes what is left of the comment for another one.
            is_after_root = bool(opened) and f"</{opened[0][0]}" in before[:opener]
            return XmlMistake(message, at - 4, at, repair, forgiven=not is_after_root and _parses_leniently(text))
        message = "a comment may not contain `--`"
        repair = "write one hyphen, or another character (`==`), and close the comment with `-->`"
        return XmlMistake(message, at - 2, at, repair, forgiven=_parses_leniently(text))
    if here and NO_CHARACTER.match(here):
        return XmlMistake(f"the character U+{ord(here):04X} is not allowed in XML", at, at + 1, "delete it")
    if here == "\ufeff":
        message = "a byte order mark is inside the file"
        return XmlMistake(message, at, at + 1, "delete the invisible character, which was left by a pasted file")
    entity = _OPEN_ENTITY.search(before, max(0, at - 42))
    if entity is not None:
        return _describe_ampersand(entity)
    if before.endswith("]]") and here == ">":
        return XmlMistake("text may not contain `]]>`", at - 2, at + 1, "write `]]&gt;`")
    if not opened and before.rfind("<") < 0:
        return _describe_text_before_root(text, at, opened)
    conflict = _CONFLICT.match(text, max(at - 1, 0))
    if conflict is not None:
        repair = "keep one of the two sides, and delete the lines `<<<<<<<`, `=======` and `>>>>>>>`"
        return XmlMistake("a merge conflict is not resolved", conflict.start(), conflict.start() + 7, repair)
    return _describe_tag(text, at, opened)


def _describe_text_before_root(text: str, at: int, _: list[tuple[str, int]]) -> XmlMistake | None:
    """Return what is wrong with text that precedes the first element, or with a file of text."""
    if "<" in text[:at]:
        return None
    begin, start, end = text.find("<", at), max(at - 1, 0), max(at, 1)
    if begin < 0:
        return XmlMistake("there is no XML element", start, end, "write XML, or give the file another name")
    words = text[:begin].lstrip("\ufeff").split()
    shown = f" (`{_shorten(words[0])}`)" if words and words[0].isprintable() else ""
    message = f"there is text before the root element{shown}"
    repair = "delete everything before the first `<`"
    read, rest = _split_where_it_breaks(text[begin:])
    if "<" in rest and read.rstrip().endswith(">") and not rest.lstrip().startswith("<"):
        message += ", and more text and elements follow its end: the file is a note and not XML"
        repair = "keep one element and delete what is before and after it, or delete the file"
    return XmlMistake(message, start, end, repair)


def _describe_whole_comment(text: str, at: int) -> str:
    """Say how all that follows becomes one comment, where a ``-->`` is left over that closes nothing.

    ``at``: where the inner comment has begun, which the next ``-->`` ends.
    """
    end = begin = text.find("-->", at)
    count = 0
    while end >= 0:
        count += 1
        begin, end = text.find("<!--", end + 3), text.find("-->", end + 3)
        if end >= 0 and (begin < 0 or end < begin):
            line = text.count("\n", 0, end) + 1
            if count == 1:
                return (
                    f", or, if all up to line {line} is to be left out, delete this `<!--` and the first `-->` after it"
                )
            return f", or, if all up to the last `-->` of line {line} is to be left out, delete each `<!--` and `-->` in between"
        end = text.find("-->", begin) if begin >= 0 else -1
    return ""


def _describe_ampersand(entity: re.Match[str]) -> XmlMistake:
    start, end, typed = entity.start(), entity.end(), entity[0]
    if typed[1:] in ENTITIES or typed.startswith("&#"):
        return XmlMistake(f"`{typed}` lacks its semicolon or its number", start, end, f"write `{typed};`")
    return XmlMistake("`&` must begin the name of an entity", start, start + 1, "write `&amp;` for the `&`")


def _describe_tag(text: str, at: int, opened: list[tuple[str, int]]) -> XmlMistake | None:
    """Return what is wrong inside a tag, or with a ``<`` that does not begin a tag."""
    begin = text.rfind("<", 0, at)
    if begin < 0:
        return None
    inside, here = text[begin + 1 : at], text[at : at + 1]
    end = None if inside.strip("/") else _END_TAG.match(text, begin)
    if end is not None:  # after the root element: inside it, expat names the tag that does not fit
        tag = _shorten(end[1])
        if not opened:
            message = f"`</{tag}>` closes nothing: no element begins before it"
            return XmlMistake(
                message, *end.span(), repair=f"write `<{tag}>` and its content before it, or delete the file"
            )
        return XmlMistake(f"a second `</{tag}>` closes nothing", *end.span(), repair="delete it")
    shown = "a blank" if here.isspace() else f"`{here}`"
    if inside == "?":
        if text.startswith("<?", at):
            return XmlMistake("`<?` is typed twice", begin, at, "delete the first `<?`")
        message = f"`<?` must be followed by a name such as `xml`, not by {shown}"
        return XmlMistake(message, begin, at + 1, "delete what is between `<?` and the name")
    comment = _HALF_OPENER.match(text, begin)
    if comment is not None and _choose_working_repairs(text, at, [("", f"{text[:begin]}<!--{text[comment.end() :]}")]):
        message = f"`{comment[0]}` begins no comment: `<!--` does"
        return XmlMistake(message, begin, comment.end(), f"write `<!--` in place of `{comment[0]}`")
    if not inside.strip("/!-"):
        message = f"`<` begins a tag, but {shown} does not begin a name"
        return XmlMistake(
            message,
            begin,
            begin + 1,
            "write `&lt;` for a `<` that is text, or delete what is before the name of the tag",
        )
    quote = _find_open_quote(inside)
    if here == "<" and quote is not None:
        start = begin + 1 + quote
        placeholder = _PLACEHOLDER.match(text, at)
        if placeholder is not None and text[start] in placeholder[2]:
            shown = _shorten(placeholder[1])
            message = f"the placeholder `<{shown}>` in an attribute value is not filled in"
            return XmlMistake(message, at, placeholder.end(1) + 1, f"write what `<{shown}>` stands for")
        line = text.count("\n", 0, start) + 1
        message = f"an attribute value, whose quotes open in line {line}, contains `<`"
        return XmlMistake(message, at, at + 1, "close the quotes of that value, or write `&lt;` if `<` is part of it")
    if quote is not None or ">" in inside:
        return None
    return _describe_attribute(text, at, inside, here)


def _is_ended_behind(text: str, at: int, name: str) -> bool:
    """Whether the next tag of a name is an end tag: what is before it is in the element, as in SDF."""
    following = re.compile(rf"<(/?){re.escape(name)}(?![\w:.-])").search(text, at)
    return following is not None and following[1] == "/"


def _describe_attribute(text: str, at: int, inside: str, here: str) -> XmlMistake | None:
    """Return what is wrong with an attribute outside its quotes."""
    if here == "<":
        name = inside.strip()
        if name in _EMPTY_WITHOUT_ATTRIBUTES and not _is_ended_behind(text, at, name):
            start = at - len(inside) - 1
            message = f"`<{name}` has neither attributes nor a `>`"
            return XmlMistake(message, start, start + 1 + len(name), "delete it, or write its attributes and `/>`")
        repair = (
            f"write `>` behind `<{_shorten(inside.split()[0])}`"
            if inside[:1] == "/"
            else "close the tag with `>` or `/>`"
        )
        return XmlMistake("the tag before this `<` is not closed", at, at + 1, repair)
    if here == "=" and _TAG_NAME.match(inside):
        message = f"the value behind `{_shorten(inside)}` has no attribute: that is the name of the tag"
        return XmlMistake(message, at, at + 1, "write a blank between the name of the tag and that of its attribute")
    if inside.endswith("/") and here.strip():
        if _TAG_NAME.match(inside[:-1]):
            return XmlMistake("the name of a tag contains `/`", at - 1, at, "correct the name, or delete the tag")
        return XmlMistake(
            "a `/` in a tag is not followed by `>`", at - 1, at, "write `/>` if the tag ends here; else delete it"
        )
    if inside.rstrip().endswith("="):
        name = _shorten(_NAME.findall(inside)[-1]) if _NAME.search(inside) else ""
        found = "has typographic quotes" if here in _TYPOGRAPHIC else "has no quotes"
        return XmlMistake(f"the value of the attribute {name} {found}", at, at + 1, f'write `{name}="…"`')
    if inside.endswith(('"', "'")):
        if here in {'"', "'"}:
            return XmlMistake(
                "an attribute value is followed by an extra quote", at, at + 1, "delete one of the quotes"
            )
        swallowed = _SWALLOWED.search(inside)
        if swallowed is not None:  # the quote before belongs to the next attribute
            name, mark, value = _shorten(swallowed[1]), swallowed[2], _shorten(swallowed[3])
            message = f"the value of the attribute {name} lacks its closing quote"
            start = at - len(inside) + swallowed.start(2)
            close = at - len(inside) + swallowed.end(3)
            ways = [(f"write `{name}={mark}{value}{mark}`", f"{text[:close]}{mark}{text[close:]}")]
            return XmlMistake(message, start, at, _join_ways(text, at, ways))
        behind = _NAME.match(text, at)
        if behind is not None and not re.match(r"\s*=", text[behind.end() : behind.end() + _MOST_SHOWN]):
            message = f"an attribute value is followed by `{_shorten(behind[0])}`"
            repair = "delete that, or write `&quot;` for a quote that is part of the value"
            return XmlMistake(message, at, behind.end(), repair)
        ways = [("write a blank after the quotes", f"{text[:at]} {text[at:]}")]
        return XmlMistake("there is no blank between two attributes", at, at + 1, _join_ways(text, at, ways))
    named = re.search(r"\s([^\s<>/=\"'&]+)\s*\Z", inside)
    if named is not None:
        name = _shorten(named[1])
        start = at - len(inside) + named.start(1)
        return XmlMistake(
            f"the attribute {name} has no value", start, start + len(named[1]), f'write `{name}="…"`, or delete it'
        )
    return None


def _join_ways(text: str, at: int, ways: list[tuple[str, str]]) -> str:
    """Join the repairs with which the text, or more of it, parses; if none does, say what to look for."""
    return ", or ".join(_choose_working_repairs(text, at, ways)) or _GENERAL_REPAIR


def _find_tag_end(text: str, at: int) -> int:
    """Return the offset behind the next ``>``."""
    end = text.find(">", at)
    return len(text) if end < 0 else end + 1


def _find_line(text: str, line: int) -> int:
    """Return the offset at which a line begins."""
    at = 0
    for _ in range(line - 1):
        at = text.index("\n", at) + 1
    return at


def _find_open_quote(inside: str) -> int | None:
    """Return the offset of a quote in a tag's text that is not closed; None if all are."""
    at = 0
    while (found := re.compile("[\"']").search(inside, at)) is not None:
        end = inside.find(found[0], found.end())
        if end < 0:
            return found.start()
        at = end + 1
    return None


def _describe_end_tag(text: str, at: int, opened: list[tuple[str, int]]) -> XmlMistake | None:
    name = _NAME.match(text, at)
    if name is None or not opened:
        return None
    (inner, line), typed = opened[-1], _shorten(name[0])
    around = next((line for tag, line in reversed(opened) if tag == name[0]), None)
    start, end = text.rfind("</", 0, at), name.end()
    inner = _shorten(inner)
    empty = _find_empty_element(text, name[0], start) if around is None else None
    if empty is not None:
        line = text.count("\n", 0, text.rfind(f"<{name[0]}", 0, empty)) + 1
        message = f"</{typed}> has no open element to close: <{typed}> in line {line} ends with `/>`"
        ways = [
            (f"delete the `/` at the end of the tag in line {line}", text[: empty - 2] + text[empty - 1 :]),
            (f"delete `</{typed}>` if it has no content", text[:start] + text[_find_tag_end(text, end) :]),
        ]
        return XmlMistake(message, start, end, _join_ways(text, at, ways))
    if around is None:
        rest = text[_find_tag_end(text, end) :]
        in_place = (f"write `</{inner}>` in its place", f"{text[:start]}</{opened[-1][0]}>{rest}")
        return _describe_surplus_tag(text, at, (start, end), in_place, f"<{inner}>, opened in line {line}")
    message = f"</{typed}> closes <{typed}> of line {around}, but <{inner}>, opened in line {line}, is not closed"
    inside = list(itertools.takewhile(lambda element: element[0] != name[0], reversed(opened)))[1:]
    if inside:
        message += f", nor is <{_shorten(inside[0][0])}> of line {inside[0][1]}"
    elif opened[-1][0] in _EMPTY_WITHOUT_ATTRIBUTES and _is_typed_bare(text, *opened[-1]):
        return XmlMistake(message, start, end, f"delete that <{inner}>, or write its attributes and `/>`")
    repair = f"write `</{inner}>` where the element ends, or `/>` at the end of its tag if nothing belongs in it"
    if len(opened) > 1 and opened[-2][0] == opened[-1][0] and _is_typed_bare(text, *opened[-1]):
        repair = f"write `</{inner}>` for the <{inner}> of line {line} if it ends that of line {opened[-2][1]}; else close it"
    return XmlMistake(message, start, end, repair)


def _is_typed_bare(text: str, tag: str, line: int) -> bool:
    """Whether a start tag of a line has no attributes, as an end tag that lacks its slash."""
    start = _find_line(text, line)
    end = text.find("\n", start)
    return re.search(rf"<{re.escape(tag)}\s*>", text[start : len(text) if end < 0 else end]) is not None


def _describe_surplus_tag(
    text: str, at: int, tag: tuple[int, int], in_place: tuple[str, str], around: str
) -> XmlMistake:
    """Describe an end tag whose element is closed already, or never opened.

    A parser stops at the last of several end tags, and the one before may be the surplus one.

    :param in_place: what puts the end tag of the innermost open element here, as a repair.
    :param around: that element.
    """
    start, end = tag
    name, rest = text[start + 2 : end], text[_find_tag_end(text, end) :]
    message = f"</{_shorten(name)}> has no open element to close"
    delete = ("delete it", text[:start] + rest)
    working = _choose_working_repairs(text, at, [in_place, delete])
    if not working or "delete it" not in working:
        return XmlMistake(f"{message}; {around}, is not closed", start, end, working[0] if working else _GENERAL_REPAIR)
    last = _find_last_element(text, name, start)
    if last is not None and _choose_working_repairs(
        text, at, [("", text[: last[1]] + text[_find_tag_end(text, last[1]) :])]
    ):
        opened, closed = (text.count("\n", 0, offset) + 1 for offset in last)
        message += f": <{_shorten(name)}> of line {opened} is closed in line {closed}"
        working[-1] = (
            f"delete the end tag in line {closed} if the element is to end here; else delete this one, or add its start tag"
        )
    else:
        message += f"; the innermost open one is {around}"
        working[-1] = "delete it, or add the start tag that is missing"
    return XmlMistake(message, start, end, ", or ".join(working))


def _find_last_element(text: str, name: str, end: int) -> tuple[int, int] | None:
    """Return where the last element of a name with an end tag before an offset begins, and where that tag is."""
    tags = re.compile(rf"<!--.*?(?:-->|\Z)|<(/?){re.escape(name)}(?=[\s/>])[^<>]*>", re.DOTALL)
    opened, last = list[int](), None
    for tag in tags.finditer(text, 0, end):
        if tag[1] == "/" and opened:
            last = opened.pop(), tag.start()
        elif tag[1] == "" and not tag[0].endswith("/>"):
            opened.append(tag.start())
    return last


def _find_empty_element(text: str, name: str, end: int) -> int | None:
    """Return where the last element of a name before an offset ends if it has no content, else None."""
    at = text.rfind(f"<{name}", 0, end)
    if at < 0 or text.rfind("<!--", 0, at) > text.rfind("-->", 0, at):
        return None
    tag = re.compile(rf"<{re.escape(name)}(?:\s[^<>]*)?/>").match(text, at, end)
    return None if tag is None else tag.end()


def _describe_entity(text: str, at: int, _: list[tuple[str, int]]) -> XmlMistake | None:
    found = next((m for m in _ENTITY.finditer(text, at) if m[1] not in ENTITIES), None)
    if found is None:
        return None
    message = (
        f"`{_shorten(found[0])}` is an undefined entity: XML defines `&amp;`, `&lt;`, `&gt;`, `&quot;` and `&apos;`"
    )
    return XmlMistake(message, *found.span(), repair="write the character itself, or `&amp;` for a `&`")


def _describe_junk(text: str, at: int, opened: list[tuple[str, int]]) -> XmlMistake | None:
    root = f"<{_shorten(opened[0][0])}> of line {opened[0][1]}" if opened else "the root element"
    tag = re.compile(r"<([^\s<>/=\"'&!?]+)").match(text, at)
    if tag is not None:
        message = f"a second root element, <{_shorten(tag[1])}>, begins after the end of {root}"
        repair = f"move it into {root}"
        closing = text.rfind("</", 0, at)
        early = text[:closing] + text[_find_tag_end(text, closing) :]
        if closing >= 0 and _choose_working_repairs(text, at, [("", early)]):
            repair += ", or delete the end tag that closes it too early"
        whole = _WHOLES.get(opened[0][0]) if opened else None
        if whole is not None:
            repair = f"put all elements into one <{whole}>: a file has one root"
        elif opened and tag[1] == opened[0][0]:
            repair = "keep one if they are copies or versions of one another; else make them one element: a file has one root"
        elif _repeats_names(text[at:], text[:at]):
            repair = f"delete all from here on: {root} has elements with these names already"
        return XmlMistake(message, *tag.span(), repair=repair)
    end = text.find("\n", at)
    end = len(text) if end < 0 else max(end, at + 1)
    plain = _COMMENT.sub("", text[at:])
    again = len(_DECLARATION.findall(plain)) if _DECLARATION.match(plain) else 0
    # A last line that is a declaration and nothing else is left over.
    if again and _TAG.search(plain):
        message = f"a second document begins after the end of {root}"
        which = "both" if again == 1 else f"all {again + 1}"
        repair = f"compare {which} documents in the file: keep the one that is meant, and delete the rest"
        return XmlMistake(message, at, at + 5, repair=repair)
    message = f"there is text after the end of {root}"
    repair = "delete it"
    if opened and _TAG.search(plain):
        repair += f"; what follows it belongs in {root}, or is left over"
    return XmlMistake(message, at, end, repair=repair)


def _repeats_names(rest: str, before: str) -> bool:
    """Whether all elements with a name in the rest of a text are also before it."""
    repeated, known = (
        {(tag, name) for tag, _, name in _NAMED.findall(_COMMENT.sub("", part))} for part in (rest, before)
    )
    return bool(repeated) and repeated <= known


def _describe_declaration(text: str, at: int, _: list[tuple[str, int]]) -> XmlMistake:
    before = text[:at].lstrip("\ufeff")
    what = "a blank" if not before.strip(" \t") else "an empty line" if not before.strip() else "something else"
    what = "a comment" if before.lstrip().startswith("<!--") else what
    message = f"the declaration `<?xml …?>` is not at the start of the file: {what} precedes it"
    repair = "move the declaration to the very start of the file, or delete it"
    return XmlMistake(message, at, at + 5, repair, forgiven=not before.strip())


def _describe_duplicate(text: str, at: int, _: list[tuple[str, int]]) -> XmlMistake | None:
    name = _NAME.match(text, at)
    if name is None:
        return None
    shown = _shorten(name[0])
    return XmlMistake(f"the attribute {shown} occurs twice in one tag", *name.span(), repair=f"delete one {shown}")


def _describe_end_of_file(text: str, at: int, opened: list[tuple[str, int]]) -> XmlMistake:
    if not opened:
        comment = text.find("<!--")
        if comment < 0:
            return XmlMistake("the file has no element", at, at, repair="write its content, or delete the file")
        message = "the file has no element: all of it is in a comment"
        return XmlMistake(
            message,
            comment,
            comment + 4,
            repair="take its content out of the comment, or delete the file and what includes it",
        )
    tag, line = _shorten(opened[-1][0]), opened[-1][1]
    message = f"the file ends before <{tag}>, opened in line {line}, is closed"
    repair = f"write `</{tag}>` where the element ends; if the rest of the file is missing, restore it"
    again = _find_second_root(text[:at], opened[0][0]) if len(opened) == 1 else None
    if again is not None:
        first = text.index(f"<{opened[-1][0]}", _find_line(text, line))
        ways = [
            (f"delete this `<{tag}>`", text[: again[0]] + text[again[1] :]),
            (f"that of line {line}", text[:first] + text[_find_tag_end(text, first) :]),
        ]
        if len(_choose_working_repairs(text, at, ways)) == len(ways):
            return XmlMistake(
                f"<{tag}> of line {line} is opened a second time, and closed once",
                *again,
                repair=f"{', or '.join(words for words, _ in ways)}: one element holds everything",
            )
    return XmlMistake(message, at, min(at + 1, len(text)), repair=repair)


def _find_second_root(text: str, name: str) -> tuple[int, int] | None:
    """Return where the next start tag of the root's name that has content begins and ends, else None."""
    plain = _COMMENT.sub(lambda match: " " * len(match[0]), text)
    starts = list(re.finditer(rf"<{re.escape(name)}(?=[\s>])[^<>]*(?<!/)>", plain))
    return starts[1].span() if len(starts) > 1 else None


def _describe_unclosed(text: str, at: int, opened: list[tuple[str, int]]) -> XmlMistake | None:
    """Return what is not closed: the file ends in the middle of it."""
    cdata = text.rfind("<![CDATA[", 0, at)
    if cdata >= 0 and "]]>" not in text[cdata:]:  # expat names its end
        at = cdata
    kinds = (
        ("<!--", "comment", "-->"),
        ("<![CDATA[", "CDATA section", "]]>"),
        ("<?", "instruction", "?>"),
        ("<", "tag", ">"),
    )
    for begin, what, end in kinds:
        if text.startswith(begin, at):
            half = _HALF_COMMENTED.match(text, at) if what == "comment" else None
            close = half and re.compile(rf"</{re.escape(half[1])}\s*>").search(text, half.end())
            if half is not None and close is not None:
                tag = _shorten(half[1])
                message = f"only the start tag of <{tag}> was made a comment, which has no end; </{tag}> follows"
                ways = [(f"write `<{tag}` in place of `<!--{tag}`", f"{text[:at]}<{text[at + 4 :]}")]
                if opened:
                    ways.append((f"write `-->` behind `</{tag}>`", f"{text[: close.end()]}-->{text[close.end() :]}"))
                repair = _join_ways(text, at, ways) + ("" if opened else ", or delete the file")
                return XmlMistake(message, *half.span(), repair=repair)
            message = f"the {what} that begins here has no end: no `{end}` follows"
            repair = f"write `{end}` where it ends; if the rest of the file is missing, restore it"
            return XmlMistake(message, at, at + len(begin), repair=repair)
    return None


def _shorten(name: str) -> str:
    return name if len(name) <= _MOST_SHOWN else f"{name[:_MOST_SHOWN]}…"


class _DocumentTypeError(Exception):
    """A document type begins, which is not read."""


def _choose_working_repairs(text: str, at: int, ways: Sequence[tuple[str, str]]) -> list[str]:
    """Return the words of the repairs with which a text parses; if there are none, of those with which more of it parses.

    :param at: where the text as it is breaks.
    :param ways: the words of each repair, and the text with it.
    """
    if len(text) > _LARGEST_TRIED:
        return [words for words, _ in ways]
    # What is behind the mistake is the same in all texts.
    left = [(words, len(_split_where_it_breaks(edited)[1])) for words, edited in ways]
    whole = [words for words, count in left if count == 0]
    return whole or [words for words, count in left if count < len(text) - at]


def forgive_hyphens(text: str) -> str:
    """Return a text of the same length without hyphens inside its comments: tinyxml2 reads up to ``-->``, whatever is inside."""
    return _COMMENT.sub(lambda match: f"<!--{match[1].replace('-', '=')}{match[0][4 + len(match[1]) :]}", text)


def _parses_leniently(text: str) -> bool:
    """Whether hyphens in comments are all that keeps a text from being parsed."""
    return len(text) <= _LARGEST_TRIED and not _split_where_it_breaks(forgive_hyphens(text))[1]


def _split_where_it_breaks(text: str) -> tuple[str, str]:
    """Return what parses of a text and the rest, which is empty if all does. A rest that begins at the end is a line break."""
    data = text.encode("utf-8", "surrogatepass")
    parser = expat.ParserCreate(encoding="utf-8")
    parser.StartDoctypeDeclHandler = _refuse_doctype
    try:
        parser.Parse(data, True)
    except expat.ExpatError:
        at = max(parser.ErrorByteIndex, 0)
    except _DocumentTypeError:
        at = parser.CurrentByteIndex
    else:
        return text, ""
    return data[:at].decode("utf-8", "replace"), data[at:].decode("utf-8", "replace") or "\n"


def _refuse_doctype(*_: Any) -> None:
    raise _DocumentTypeError
