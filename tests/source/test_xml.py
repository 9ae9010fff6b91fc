"""Located XML: every element and every attribute knows the exact text at which it was typed."""

from __future__ import annotations

import re
from pathlib import Path
from xml.sax.saxutils import escape

import pytest
from hypothesis import given
from hypothesis import strategies as st

from urdfcheck.core import Span
from urdfcheck.source.text import xml
from urdfcheck.source.text.xml import (
    MAX_DEPTH,
    Attribute,
    Element,
    SourceFile,
    XmlError,
    find_unbound_prefix,
    parse_xml,
)
from urdfcheck.system.files import read_regular

FILE = Path("robot.urdf")


def tree(text: str) -> tuple[SourceFile, Element]:
    """Parse a text that never was a file."""
    source = SourceFile(FILE, FILE.name, text=text)
    return source, parse_xml(source)


def read(folder: Path, data: bytes) -> tuple[SourceFile, Element]:
    """Parse a file of these bytes."""
    path = folder / FILE
    path.write_bytes(data)
    source = SourceFile.read(path, path.name)
    return source, parse_xml(source)


def text_at(source: SourceFile, span: Span | None) -> str:
    assert span is not None
    return source.text[span.start : span.end]


def first(root: Element, name: str) -> Attribute:
    """The first attribute of this name."""
    return next(e.attributes[name] for e in root.walk() if name in e.attributes)


def refusal(text: str) -> XmlError:
    with pytest.raises(XmlError) as caught:
        tree(text)
    return caught.value


# -- spans -----------------------------------------------------------------------------------------------------------


def test_the_span_of_an_attribute_covers_its_value_without_the_quotes() -> None:
    source, root = tree('<robot name="r">\n  <link name="base"/>\n</robot>')
    attribute = root.children[0].attributes["name"]
    assert attribute.span == Span("robot.urdf", 2, 15, 2, 19, 31, 35)
    assert text_at(source, attribute.span) == attribute.typed == attribute.value == "base"
    assert attribute.literal


def test_the_span_of_an_element_covers_its_start_tag() -> None:
    source, root = tree('<robot name="r">\n  <link\n    name="a>b"\n  />\n</robot>')
    link = root.children[0]
    assert text_at(source, link.span) == '<link\n    name="a>b"\n  />'
    assert link.span is not None
    assert (link.span.line, link.span.col, link.span.end_line, link.span.end_col) == (2, 3, 4, 5)


@pytest.mark.parametrize("newline", ["\n", "\r\n", "\r"], ids=["LF", "CRLF", "CR"])
def test_lines_are_counted_the_same_with_any_line_ending(tmp_path: Path, newline: str) -> None:
    text = newline.join(["<robot>", "<link", '  name="wheel"/>', "</robot>"])
    source, root = read(tmp_path, text.encode())
    name = first(root, "name")
    assert name.span is not None
    assert (name.span.line, name.span.col) == (3, 9)
    assert text_at(source, name.span) == "wheel"
    assert source.text == text  # an edit must not change the line endings around it


@pytest.mark.parametrize(
    ("before", "encoding"),
    [
        (b"\xef\xbb\xbf", "utf-8"),
        (b"\xff\xfe", "utf-16-le"),
        (b"\xfe\xff", "utf-16-be"),
        (b"", "utf-16-le"),
        (b"", "utf-16-be"),
    ],
    ids=["UTF-8 BOM", "UTF-16 LE BOM", "UTF-16 BE BOM", "UTF-16 LE", "UTF-16 BE"],
)
def test_a_byte_order_mark_or_two_bytes_per_letter_move_no_column(tmp_path: Path, before: bytes, encoding: str) -> None:
    source, root = read(tmp_path, before + '<robot name="é"><link name="wheel"/></robot>'.encode(encoding))
    span = root.children[0].attributes["name"].span
    assert span is not None
    assert (span.line, span.col, text_at(source, span)) == (1, 29, "wheel")


def test_the_declared_encoding_is_used(tmp_path: Path) -> None:
    text = '<?xml version="1.0" encoding="ISO-8859-1"?>\n<robot name="ä"><link name="wheel"/></robot>'
    source, root = read(tmp_path, text.encode("latin-1"))
    assert root.get("name") == "ä"
    assert text_at(source, root.children[0].attributes["name"].span) == "wheel"


def test_columns_count_characters_not_bytes() -> None:
    source, root = tree('<robot><!-- é 🤖 --><link name="né🤖" type="wheel"/><link name="b"/></robot>')
    link, last = root.children
    assert [text_at(source, a.span) for a in link.attributes.values()] == ["né🤖", "wheel"]
    assert last.span is not None
    assert (last.span.col, text_at(source, last.span)) == (51, '<link name="b"/>')


def test_quotes_may_be_single_and_hold_the_other_kind_and_angle_brackets() -> None:
    source, root = tree("""<robot a = 'say "x > y"' b="it's"/>""")
    assert [text_at(source, a.span) for a in root.attributes.values()] == ['say "x > y"', "it's"]


def test_comments_are_kept_with_their_spans() -> None:
    source, _ = tree("<robot>\n  <!-- urdfcheck: é > -->\n  <link/>\n</robot>")
    (comment,) = source.comments
    assert comment.text == " urdfcheck: é > "
    assert text_at(source, comment.span) == "<!-- urdfcheck: é > -->"


@pytest.mark.slow
@given(
    value=st.text(st.characters(codec="utf-8", exclude_categories=["Cc", "Cs"], exclude_characters="\ufffe\uffff")),
    before=st.sampled_from(["", "<!-- é🤖 -->", "\r\n\t", "\n\n"]),
    spaces=st.tuples(*[st.text(" \t\r\n", max_size=3)] * 4),
    quote=st.sampled_from("\"'"),
    newlines=st.text("\r\n\t ", max_size=4),
)
def test_any_value_is_found_where_it_was_typed(
    value: str, before: str, spaces: tuple[str, ...], quote: str, newlines: str
) -> None:
    written = escape(value, {quote: "&quot;" if quote == '"' else "&apos;"}) + newlines
    a, b, c, d = spaces
    text = f"<robot>{before}<link z={quote}1{quote} {a}name{b}={c}{quote}{written}{quote}{d}/></robot>"
    source, root = tree(text)
    name = root.children[0].attributes["name"]
    assert name.typed == text_at(source, name.span) == written
    assert name.value == value + newlines.replace("\r\n", " ").translate(dict.fromkeys(map(ord, "\r\n\t"), " "))
    assert name.span is not None
    assert name.span.line == 1 + len(re.findall("\r\n|\r|\n", text[: name.span.start]))
    assert name.literal == (escape(value) == value and quote not in value and "${" not in value and "$(" not in value)


# -- literal values ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("typed", ["a&amp;b", "&#49;", "1 &lt; 2", "${x}", "${x} 0 0", "$(find p)/x"])
def test_a_value_that_is_computed_from_what_was_typed_is_not_literal(typed: str) -> None:
    _, root = tree(f'<robot name="{typed}"/>')
    name = root.attributes["name"]
    assert name.typed == typed
    assert not name.literal  # replacing the text at the span would not be replacing the value


@pytest.mark.parametrize("typed", ["0 0 1", "", "costs $5", "{x}", "1\r\n 2\n\t3"])
def test_a_value_that_stands_there_itself_is_literal(typed: str) -> None:
    source, root = tree(f'<robot name="{typed}"/>')
    name = root.attributes["name"]
    assert name.literal
    assert text_at(source, name.span) == typed
    assert name.value.split() == typed.split()


# -- names in findings ------------------------------------------------------------------------------------------------


def test_a_subject_names_the_path_from_the_robot_to_the_attribute() -> None:
    _, root = tree(
        '<robot name="r"><link name="arm"><visual/><visual><origin xyz="0"/></visual></link>'
        '<gazebo reference="arm"><kp v="1"/></gazebo></robot>'
    )
    assert first(root, "xyz").location.subject == "link[arm]/visual[2]/origin@xyz"
    assert first(root, "v").location.subject == "gazebo[arm]/kp@v"
    assert root.location.subject == "robot[r]"


def test_of_two_children_of_a_kind_the_first_is_taken_as_the_reference_parser_does() -> None:
    _, root = tree('<link><inertial v="1"/>text<inertial v="2"/></link>')
    inertial = root.find_child("inertial")
    assert inertial is not None
    assert inertial.get("v") == "1"
    assert [e.get("v") for e in root.find_children("inertial")] == ["1", "2"]
    assert root.find_child("visual") is None
    assert root.text == "text"


# -- what must not be read --------------------------------------------------------------------------------------------


def test_a_duplicate_attribute_is_refused_at_the_second_one() -> None:
    error = refusal('<robot>\n  <link name="a"\n        name="b"/>\n</robot>')
    assert (error.reason, error.span.line, error.span.col) == ("malformed", 3, 9)
    assert "the attribute name occurs twice" in str(error)


@pytest.mark.parametrize(
    "text",
    [
        '<!DOCTYPE robot SYSTEM "file:///etc/passwd"><robot name="&a;"/>',
        '<!DOCTYPE robot [<!ENTITY a "1"><!ENTITY b "&a;&a;&a;&a;">]><robot name="&b;"/>',
        "<?xml version='1.0'?>\n<!-- <!DOCTYPE x> -->\n<!DOCTYPE robot []><robot/>",
    ],
    ids=["external", "entities", "after a comment"],
)
def test_a_document_type_is_refused_before_anything_in_it_is_read(text: str) -> None:
    error = refusal(text)
    assert error.reason == "doctype"
    assert error.span.start == text.rindex("<!DOCTYPE robot")
    assert text[error.span.start : error.span.end] == "<!DOCTYPE"


@pytest.mark.parametrize("declared", ["", ' SYSTEM "file:///etc/passwd"', ' PUBLIC "a" "http://localhost:9/robot.dtd"'])
def test_a_document_type_that_declares_nothing_is_ignored_and_its_file_not_opened(declared: str) -> None:
    text = f'<!DOCTYPE robot{declared}>\n<robot name="a &amp; b"/>'
    _, root = tree(text)
    assert (root.tag, root.get("name")) == ("robot", "a & b")
    assert root.span is not None
    assert (root.span.line, root.span.col) == (2, 1)


def test_nesting_ends_at_a_limit() -> None:
    _, root = tree("<a>" * MAX_DEPTH + "</a>" * MAX_DEPTH)
    assert sum(1 for _ in root.walk()) == MAX_DEPTH
    error = refusal("<a>" * (MAX_DEPTH + 1) + "</a>" * (MAX_DEPTH + 1))
    assert (error.reason, error.data["what"], error.span.col) == ("too-large", "depth", 3 * MAX_DEPTH + 1)


@pytest.mark.parametrize(
    ("text", "says", "line", "column"),
    [
        ("", "the file is empty", 1, 1),
        ("<!-- -->", "the file has no element: all of it is in a comment", 1, 1),
        ("<robot>\n<!-- <robot> -->\n<robot>\n</robot>\n", "<robot> of line 1 is opened a second time", 3, 1),
        ("<robot>\n<robot/><!-- <robot> -->", "the file ends before <robot>, opened in line 1, is closed", 2, 25),
        ("<robot>\n<link>", "the file ends before <link>, opened in line 2, is closed", 2, 7),
        ('<robot>\n  <link name="é', "the tag that begins here has no end", 2, 3),
        ("<robot>\n é <!-- a --", "the comment that begins here has no end", 2, 4),
        ("<robot>\n <!--link name='a'>\n</link>\n</robot>", "only the start tag of <link> was made a comment", 2, 2),
        ("<!--launch>\n<node/>\n</launch>", "only the start tag of <launch> was made a comment", 1, 1),
        ("<robot>\n <!--link name='a'>\n</robot>", "the comment that begins here has no end", 2, 2),
        ("<robot>\n <![CDATA[ ]]", "the CDATA section that begins here has no end", 2, 2),
        (
            "<robot>\n  <link></robot>",
            "</robot> closes <robot> of line 1, but <link>, opened in line 2, is not",
            2,
            9,
        ),
        (
            "<robot>\n<link>\n<b></robot>",
            "but <b>, opened in line 3, is not closed, nor is <link> of line 2",
            3,
            4,
        ),
        (
            "<robot>\n</link></robot>",
            "</link> has no open element to close; the innermost open one is <robot>, opened in line 1",
            2,
            1,
        ),
        ("<robot>\n</link>\n", "</link> has no open element to close; <robot>, opened in line 1, is not closed", 2, 1),
        (
            "<robot>\n<link\n/><link/>\n</link></robot>",
            "</link> has no open element to close: <link> in line 3 ends with `/>`",
            4,
            1,
        ),
        (
            "<robot>\n<link a='>'/></link></robot>",
            "has no open element to close; the innermost open one is <robot>, opened in line 1",
            2,
            14,
        ),
        (
            "<robot>\n<!-- <link/> --></link></robot>",
            "has no open element to close; the innermost open one is <r",
            2,
            17,
        ),
        (
            "<robot>\n<link/><link></link></link></robot>",
            "</link> has no open element to close: <link> of line 2 is closed in line 2",
            2,
            21,
        ),
        ("<robot>\n  é &nbsp;</robot>", "`&nbsp;` is an undefined entity", 2, 5),
        ('<robot>\n  <a b="é &nbsp;"/></robot>', "`&nbsp;` is an undefined entity", 2, 11),
        ("<robot>\n<!-- é -- é -->\n</robot>", "a comment may not contain `--`", 2, 8),
        ("<robot>\n<!-- é --->\n</robot>", "a comment may not contain `--`", 2, 8),
        ("<robot>\n<!-- a\n <!-- b --> c --></robot>", "a comment begins inside the comment of line 2", 3, 2),
        ('<robot a="é & b"/>', "`&` must begin the name of an entity", 1, 13),
        ("<robot>é & b</robot>", "`&` must begin the name of an entity", 1, 10),
        ("<robot>é &lt b</robot>", "`&lt` lacks its semicolon", 1, 10),
        ('<a><b c="<a-b>/d"/></a>', "the placeholder `<a-b>` in an attribute value is not filled in", 1, 10),
        ('<a><b c="<a-b>\n</a>', "an attribute value, whose quotes open in line 1, contains `<`", 1, 10),
        ('<robot a="1 < 2"/>', "an attribute value, whose quotes open in line 1, contains `<`", 1, 13),
        (
            "<robot a=\"é/>\n<b c='d'/></robot>",
            "an attribute value, whose quotes open in line 1, contains `<`",
            2,
            1,
        ),
        ('<?<?xml version="1.0"?>\n<robot/>', "`<?` is typed twice", 1, 1),
        ('<? xml version="1.0"?>\n<robot/>', "`<?` must be followed by a name such as `xml`, not by a blank", 1, 1),
        ("<robot>é < 2</robot>", "`<` begins a tag, but a blank does not begin a name", 1, 10),
        ("<robot><-- é --></robot>", "`<--` begins no comment: `<!--` does", 1, 8),
        ("<robot><!- é --></robot>", "`<!-` begins no comment: `<!--` does", 1, 8),
        ("</launch>", "`</launch>` closes nothing: no element begins before it", 1, 1),
        ("<robot a=1/>", "the value of the attribute a has no quotes", 1, 10),
        ("<robot a=“1”/>", "the value of the attribute a has typographic quotes", 1, 10),
        ("<robot a/>", "the attribute a has no value", 1, 8),
        ('<robot a="1"b="2"/>', "no blank between two attributes", 1, 13),
        ('<robot a="é"s b="2"/>', "an attribute value is followed by `s`", 1, 13),
        ('<robot a="é c b="2"/>', "the value of the attribute a lacks its closing quote", 1, 10),
        ('<robot a="1""/>', "followed by an extra quote", 1, 13),
        ('<?xml verison="1.0"?><robot/>', "the XML declaration cannot say `verison`", 1, 7),
        ('<robot a="1" a="2"/>', "the attribute a occurs twice in one tag", 1, 14),
        ("<robot>é\x01</robot>", "the character U+0001 is not allowed in XML", 1, 9),
        ("<robot>]]></robot>", "text may not contain `]]>`", 1, 8),
        (" \ufeff<robot/>", "a byte order mark is inside the file", 1, 2),
        ("#!a\n", "there is no XML element", 1, 1),
        ("é<robot/>", "there is text before the root element (`é`)", 1, 1),
        ("a.launch\n<launch/>\nb\n<launch/>", "(`a.launch`), and more text and elements follow its end", 1, 1),
        ("\n<?xml version='1.0'?><robot/>", "is not at the start of the file: an empty line precedes it", 2, 1),
        ("<!-- --><?xml version='1.0'?><robot/>", "is not at the start of the file: a comment precedes it", 1, 9),
        (
            "<robot><link/></robot>\n\n</robot>\n",
            "a second `</robot>` closes nothing",
            3,
            1,
        ),
        (
            "<robot>é</robot>\n<robot/>",
            "a second root element, <robot>, begins after the end of <robot> of line 1",
            2,
            1,
        ),
        ("<robot/>\né", "there is text after the end of <robot> of line 1", 2, 1),
        ("<robot>\n é\0</robot>", "zero byte", 2, 3),
        ("<\0r\0/\0>\0", "zero byte", 1, 2),
    ],
)
def test_broken_text_is_refused_where_it_breaks(text: str, says: str, line: int, column: int) -> None:
    error = refusal(text)
    assert says in str(error)
    assert (error.reason, error.span.line, error.span.col) == ("malformed", line, column)


@pytest.mark.parametrize(
    ("text", "repair"),
    [
        ("<a><b></c></a>", "write `</b>` in its place"),
        ("<a><b></c></b></a>", "delete it, or add the start tag that is missing"),
        (
            "<a>\n<g>\n<b/>\n</g>\n<b/>\n</g>\n</a>",
            "delete the end tag in line 4 if the element is to end here; else delete this one, or add its start tag",
        ),
        (
            "<a>\n<g><g>\n</g><!-- <g> -->\n</g>\n<b/></g></a>",
            "delete the end tag in line 4 if the element is to end here; else delete this one, or add its start tag",
        ),
        ("<a>\n</root>", "write `</a>` in its place"),
        ("<a><b/></b></a>", "delete the `/` at the end of the tag in line 1, or delete `</b>` if it has no content"),
        ("<a/>\n<b/>", "move it into <a> of line 1"),
        ("<a></a>\n<b/></a>", "move it into <a> of line 1, or delete the end tag that closes it too early"),
        ("<!--a>\n<b/>\n</a>", "write `<a` in place of `<!--a`, or delete the file"),
        ('<a b="1"c="2"/>', "write a blank after the quotes"),
        ("note\n<a/>", "delete everything before the first `<`"),
        ("note\n<a/>\n", "delete everything before the first `<`"),
        (
            "a.launch\n<launch/>\n---\nb.launch\n<launch/>",
            "keep one element and delete what is before and after it, or delete the file",
        ),
        ("<a>\n<b>\n<b>\n</a>", "write `</b>` for the <b> of line 3 if it ends that of line 2; else close it"),
        (
            '<a>\n<b c="1">\n<b c="2">\n</a>',
            "write `</b>` where the element ends, or `/>` at the end of its tag if nothing belongs in it",
        ),
        (
            "<a>\n<<<<<<< HEAD\n<b/>\n=======\n>>>>>>> 1\n</a>",
            "keep one of the two sides, and delete the lines `<<<<<<<`, `=======` and `>>>>>>>`",
        ),
        ("<a><b></b\n<c/></a>", "write `>` behind `</b`"),
        ('<a><b_c="1"/></a>', "write a blank between the name of the tag and that of its attribute"),
        ("<a><b/c></a>", "correct the name, or delete the tag"),
        ('<a><b c="1"/d></a>', "write `/>` if the tag ends here; else delete it"),
        (
            '<robot name="r"><link name="a"/>\n<joint name="j"/></robot>\n<link name="a" />\n</robot>',
            "delete all from here on: <robot> of line 1 has elements with these names already",
        ),
        (
            '<robot name="r"><link name="a"/></robot>\n<link name="b"/>\n</robot>',
            "move it into <robot> of line 1, or delete the end tag that closes it too early",
        ),
        ("<joint/>\n<link/>", "put all elements into one <robot>: a file has one root"),
        ("<node/><node/>", "put all elements into one <launch>: a file has one root"),
        (
            "<a/><a/>",
            "keep one if they are copies or versions of one another; else make them one element: a file has one root",
        ),
        ("<a><!-- b </a>", "write `-->` where it ends; if the rest of the file is missing, restore it"),
        ('<a b="$(find <pkg>)/c"/>', "write what `<pkg>` stands for"),
    ],
)
def test_a_repair_fits_what_is_wrong(text: str, repair: str) -> None:
    assert refusal(text).data["repair"] == repair


@pytest.mark.parametrize(
    ("text", "forgiven"),
    [
        ("<a><!-- <!-- --> --></a>", True),
        ("<a></a><!-- <!-- --> -->", False),
        ("<a><!-- <!-- </a>", False),
        ("<a><!-- -- --></a>", True),
        ("<a><!-- -- </a>", False),
        ("<a><!-- -- --><b></a>", False),
    ],
)
def test_tinyxml2_forgives_hyphens_in_a_comment_that_ends_before_the_root_does(text: str, forgiven: bool) -> None:
    assert refusal(text).data["forgiven"] is forgiven


@pytest.mark.parametrize("mark", [b"", b"\xef\xbb\xbf"], ids=["plain", "BOM"])
def test_a_byte_that_is_not_of_the_encoding_is_named_and_located(tmp_path: Path, mark: bytes) -> None:
    with pytest.raises(XmlError, match="byte 0xe4 is not valid utf-8") as caught:
        read(tmp_path, mark + '<robot>\n<link name="é'.encode() + b'r\xe4der"/></robot>')
    assert (caught.value.reason, caught.value.span.line, caught.value.span.col) == ("encoding", 2, 15)


@pytest.mark.parametrize("declared", ["klingon", "hex", "undefined", "punycode", "UTF-16", "utf-32", "cp037"])
def test_a_declared_encoding_that_the_file_does_not_have_is_refused_at_its_name(tmp_path: Path, declared: str) -> None:
    text = f'<?xml version="1.0" encoding="{declared}"?><robot name="r"/>'
    with pytest.raises(XmlError) as caught:
        read(tmp_path, text.encode())
    span = caught.value.span
    assert caught.value.reason == "declared-encoding"
    assert text[span.start : span.end] == declared


def test_a_prefix_without_declaration_is_found_on_elements_and_attributes() -> None:
    _, root = tree('<robot xmlns:xacro="x"><xacro:a/><link xml:space="preserve"/></robot>')
    assert find_unbound_prefix(root) is None
    _, root = tree('<robot><a xmlns:xacro="x"/><b xacro:name="n"/></robot>')
    assert find_unbound_prefix(root) == (root.children[1], "xacro")


# -- limits ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("limit", "what", "allowed", "refused", "column"),
    [
        ("MAX_PARTS", "parts", '<a b=""/>', "<a><b/><!----></a>", 8),
        ("MAX_PARTS", "parts", "<a>xyz</a>", '<a><b c=""/></a>', 4),
        ("MAX_ATTRIBUTES", "attributes", '<a b="" c=""/>', '<a b="" c="" d=""/>', 1),
        ("MAX_VALUE", "value", '<a b="12"/>', '<a b="123"/>', 1),
        ("MAX_VALUE", "value", '<ab cd=""/>', '<a bcd=""/>', 1),
        ("MAX_VALUE", "value", "<ab/>", "<abc/>", 1),
    ],
)
def test_just_the_limit_is_read_and_one_more_is_not(
    monkeypatch: pytest.MonkeyPatch, limit: str, what: str, allowed: str, refused: str, column: int
) -> None:
    monkeypatch.setattr(xml, limit, 2)
    tree(allowed)
    error = refusal(refused)
    assert (error.reason, error.data, error.span.col) == (
        "too-large",
        {"what": what, "limit": 2, "found": 3},
        column,
    )


def test_a_file_with_too_many_bytes_is_not_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(read_regular, "__defaults__", (8,))
    read(tmp_path, b"<robot/>")
    with pytest.raises(XmlError) as caught:
        read(tmp_path, b"<robot/>\n")
    assert caught.value.data == {"what": "bytes", "limit": 8, "found": 9}
    assert (caught.value.span.line, caught.value.span.col) == (1, 1)


def test_text_between_elements_is_kept_with_the_element_that_it_stands_in() -> None:
    _, root = tree("<a>1<b>2<c/>3</b>4<!-- -->5</a>")
    assert [e.text for e in root.walk()] == ["145", "23", ""]


def test_nameless_elements_are_numbered_among_those_of_their_tag_and_anew_when_one_is_added() -> None:
    _, root = tree("<robot><link/><joint/><link/></robot>")
    assert [c.label for c in root.children] == ["link[1]", "joint", "link[2]"]
    root.children.append(Element(tag="joint", span=None, parent=root))
    assert [c.label for c in root.children] == ["link[1]", "joint[1]", "link[2]", "joint[2]"]


def test_a_prefix_holds_within_the_element_that_declares_it() -> None:
    _, sound = tree('<a xmlns:p="u"><p:b/><c xmlns:q="u" q:d=""><p:e/></c></a>')
    assert find_unbound_prefix(sound) is None
    _, broken = tree('<a><b xmlns:p="u"><p:c/></b><p:d/></a>')
    found = find_unbound_prefix(broken)
    assert found is not None
    assert (found[0].tag, found[1]) == ("p:d", "p")
