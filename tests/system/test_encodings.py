"""The text of bytes: the same for every program that reads the file, or refused."""

from __future__ import annotations

import codecs
import encodings
import pkgutil

import pytest

from urdfcheck.system.encodings import (
    UnreadableEncodingError,
    decode_text,
    decode_xml,
    find_byte_beyond_utf_8,
    is_single_byte,
)

CODECS = sorted(m.name for m in pkgutil.iter_modules(encodings.__path__) if m.name not in {"aliases", "mbcs", "oem"})


def declare(encoding: str, text: str = "<robot/>") -> str:
    return f'<?xml version="1.0" encoding="{encoding}"?>{text}'


def refuse(data: bytes) -> UnreadableEncodingError:
    with pytest.raises(UnreadableEncodingError) as caught:
        decode_xml(data)
    return caught.value


@pytest.mark.parametrize("encoding", CODECS)
def test_no_codec_reads_other_characters_out_of_ascii(encoding: str) -> None:
    """Whatever a file declares, its ASCII bytes are the characters that urdfdom and xacro read, or it is refused."""
    body = "".join(map(chr, range(32, 127))) + "+ADw- ~{<!~} ~~ \x1b$B!!\x1b(B \x0e!!\x0f \\ \\n \\x3c ="
    data = declare(encoding, body).encode()
    refused = ""
    try:
        text = decode_xml(data).text
    except UnreadableEncodingError as error:
        refused, text = error.wrong, ""
    assert refused == encoding or text.encode() == data


@pytest.mark.parametrize("encoding", CODECS)
def test_a_codec_of_one_byte_reads_each_byte_for_itself(encoding: str) -> None:
    if not is_single_byte(encoding):
        return
    for byte in range(256):
        data = bytes((byte, 65, byte))
        assert data.decode(encoding, "replace")[1:2] == "A"
    assert bytes(range(128)).decode(encoding) == "".join(map(chr, range(128)))


@pytest.mark.parametrize(
    "encoding", ["ascii", "us-ascii", "ISO-8859-1", "latin1", "iso-8859-15", "windows-1252", "koi8-r"]
)
def test_the_usual_codecs_of_one_byte_are_known(encoding: str) -> None:
    assert is_single_byte(encoding)


@pytest.mark.parametrize(
    "encoding",
    [
        "utf-7",
        "hz",
        "iso2022_jp",
        "iso2022_jp_2004",
        "iso2022_kr",
        "cp864",
        "shift_jis_2004",
        "charmap",
        "unicode-escape",
        "utf-16",
        "cp037",
        "idna",
        "punycode",
        "undefined",
        "hex",
        "klingon",
    ],
)
def test_others_are_none(encoding: str) -> None:
    assert not is_single_byte(encoding)


@pytest.mark.parametrize(
    ("encoding", "hidden"),
    [
        ("utf-7", b"+ADwAIQAtAC0-<link/>+AC0ALQA+-"),
        ("hz", b"1~\n0"),
        ("iso-2022-jp", b"\x1b$B!!\x1b(B"),
        ("cp864", b"100%"),
        ("shift_jis_2004", b"a\\b~"),
    ],
)
def test_what_a_declaration_hides_is_refused_at_its_name(encoding: str, hidden: bytes) -> None:
    error = refuse(declare(encoding, "").encode() + hidden)
    assert (error.wrong, error.before) == (encoding, '<?xml version="1.0" encoding="')
    assert "a different text than in UTF-8" in str(error)


def test_blanks_cannot_hide_the_declaration() -> None:
    padded = b'<?xml version="1.0"' + b" " * 5_000 + b'encoding="utf-7"?>+ADw-'
    assert refuse(padded).wrong == "utf-7"


@pytest.mark.parametrize(
    ("data", "text", "encoding"),
    [
        ("<r ä/>".encode(), "<r ä/>", "utf-8"),
        ("<r ä/>".encode("utf-8-sig"), "<r ä/>", "utf-8-sig"),
        ("<r ä/>".encode("utf-16"), "<r ä/>", "utf-16"),
        ("<r ä/>".encode("utf-16-be"), "<r ä/>", "utf-16-be"),
        (declare("UTF-16", "ä").encode("utf-16"), declare("UTF-16", "ä"), "utf-16"),
        (declare("ISO-8859-1", "ä").encode("latin-1"), declare("ISO-8859-1", "ä"), "ISO-8859-1"),
        # What urdfdom and xacro read, whatever the declaration says.
        (declare("ISO-8859-1", "ä").encode(), declare("ISO-8859-1", "ä"), "utf-8"),
        (declare("ISO-8859-1", "a").encode(), declare("ISO-8859-1", "a"), "ISO-8859-1"),
        (declare("gb2312", "a").encode(), declare("gb2312", "a"), "utf-8"),
    ],
)
def test_bytes_become_the_text_that_they_are(data: bytes, text: str, encoding: str) -> None:
    decoded = decode_xml(data)
    assert (decoded.text, decoded.encoding) == (text, encoding)
    assert decoded.text.encode(decoded.encoding) == data


@pytest.mark.parametrize(
    ("data", "says"),
    [
        (declare("gbk", "中").encode("gbk"), "declares the encoding 'gbk'"),
        (declare("klingon").encode(), "'klingon', which is not known"),
        (declare("ISO-8859-1", "ä").encode("utf-16"), "the text is UTF-16 and declares the encoding 'ISO-8859-1'"),
        (codecs.BOM_UTF8 + declare("ISO-8859-1", "ä").encode("latin-1"), "byte 0xe4 is not valid utf-8"),
        (declare("UTF-8", "ä").encode("latin-1"), "byte 0xe4 is not valid utf-8"),
        ("<r/>".encode("utf-32"), "UTF-32"),
        ("<r/>".encode("utf-32-le"), "UTF-32"),
        ("<r/>".encode("utf-32-be"), "UTF-32"),
        (declare("x" * 1_000).encode(), "x…"),
    ],
)
def test_other_bytes_are_refused(data: bytes, says: str) -> None:
    assert says in str(refuse(data))


def test_a_text_without_declarations_is_not_searched_for_one() -> None:
    data = declare("utf-7", ": +ADw-").encode()
    assert decode_text(data).text == data.decode()


@pytest.mark.parametrize(
    ("text", "encoding", "found"),
    [("aä", "utf-8", None), ("a", "latin-1", None), ("aäb", "latin-1", (1, 0xE4)), ("aÃ¤", "latin-1", None)],
)
def test_the_first_byte_beyond_utf_8(text: str, encoding: str, found: tuple[int, int] | None) -> None:
    assert find_byte_beyond_utf_8(text, encoding) == found
