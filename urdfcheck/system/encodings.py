"""The text of a file's bytes: what the programs that read robots take them for, and never a text that only a codec sees.

urdfdom and the engines (tinyxml2) decode nothing, and xacro reads every file as UTF-8: none of them heeds the encoding that an
XML declaration names. Parsers that do must find the same text, or letters of their own beyond ASCII at most. Codecs that read
other characters out of ASCII bytes (UTF-7, HZ, ISO-2022) could otherwise hide a part of a file from one side or the other.
"""

from __future__ import annotations

import codecs
import re
import sys
from dataclasses import replace

from urdfcheck.core.records import dataclass

# Blanks before the declaration, and a declaration without a version, are malformed; what they name is looked at all the same.
_DECLARATION = re.compile(r"""\s*<\?xml\b[^>]*?\bencoding\s*=\s*["']([^"'<>]*)["']""")
_ASCII = bytes(range(128))
_MARKS = (
    (codecs.BOM_UTF8, "utf-8-sig"),
    (codecs.BOM_UTF32_LE, "utf-32"),  # before those of UTF-16, with which it begins
    (codecs.BOM_UTF32_BE, "utf-32"),
    (b"<\0\0\0", "utf-32"),
    (b"\0\0\0<", "utf-32"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
    (b"<\0", "utf-16-le"),
    (b"\0<", "utf-16-be"),
)
# Codecs of Python that are not a character encoding of a file; some take quadratic time.
_NO_CHARSETS = frozenset({"idna", "punycode", "raw-unicode-escape", "undefined", "unicode-escape"})
_UTF_8 = frozenset({"utf-8", "utf-8-sig"})
_MOST_SHOWN = 40


class UnreadableEncodingError(Exception):
    """Bytes that are not text, or that are different texts to different programs.

    ``before``: the text in front of the wrong place; ``wrong``: the text there, empty for a byte that is not text.
    """

    def __init__(self, message: str, *, before: str, wrong: str = "") -> None:
        super().__init__(message)
        self.before = before
        self.wrong = wrong


@dataclass(frozen=True, slots=True)
class DecodedText:
    """A file's text; ``encoding``: the codec that makes the same bytes of it; ``declared``: the encoding that it states."""

    text: str
    encoding: str
    declared: str = ""


def decode_xml(data: bytes) -> DecodedText:
    """Return the text of an XML file: UTF-8 or UTF-16 by its mark, else UTF-8, else the single-byte codec that it declares.

    :raises UnreadableEncodingError: if it is neither, or if it is another text in the encoding that it declares.
    """
    encoding = _detect_mark(data) or "utf-8"
    if encoding not in _UTF_8:
        return _decode_wide(data, encoding)
    body = data.removeprefix(codecs.BOM_UTF8)
    found = _DECLARATION.match(body[: body.find(b"?>") + 1].decode("latin-1"))
    declared = "" if found is None else found[1]
    try:
        text = body.decode("utf-8")
    except UnicodeDecodeError:
        if found is None or _look_up(declared) == "utf-8" or encoding == "utf-8-sig":
            return decode_text(data)  # which says what byte it is
        if is_single_byte(declared):
            return DecodedText(_decode(data, declared), declared, declared)
        raise _refuse_declared(found) from None
    if found is not None and not _is_same_text(body, declared, text):
        raise _refuse_declared(found)
    if encoding == "utf-8" and text.isascii() and is_single_byte(declared):
        encoding = declared  # in which an edit has to be written, for parsers that heed the declaration
    return DecodedText(text, encoding, declared)


def _decode_wide(data: bytes, encoding: str) -> DecodedText:
    """Return a text of two bytes per character, which must not declare another encoding: expat refuses it then."""
    decoded = decode_text(data)
    found = _DECLARATION.match(decoded.text[: decoded.text.find("?>") + 1])
    if found is not None and not found[1].lower().startswith("utf-16"):
        message = f"the text is {encoding[:6].upper()} and declares the encoding {_show(found[1])}"
        raise UnreadableEncodingError(message, before=found.string[: found.start(1)], wrong=found[1])
    return replace(decoded, declared="" if found is None else found[1])


def decode_text(data: bytes) -> DecodedText:
    """Return the text of a file that declares no encoding: UTF-16 if it begins with its mark, else UTF-8.

    :raises UnreadableEncodingError: if it is neither.
    """
    encoding = _detect_mark(data) or "utf-8"
    if encoding == "utf-32":
        raise UnreadableEncodingError("the text is UTF-32, which the parsers of XML do not read", before="")
    return DecodedText(_decode(data, encoding), encoding)


def is_utf_8(encoding: str) -> bool:
    """Whether this is a name of UTF-8, with or without a mark."""
    return _look_up(encoding) in _UTF_8


def is_single_byte(encoding: str) -> bool:
    """Whether a codec reads each byte for itself, and ASCII as ASCII: ISO-8859-1, Windows-1252 and the like."""
    name = _look_up(encoding)
    if name in {"ascii", "iso8859-1"}:
        return True
    # Python's codecs of one byte are tables; those that keep a state or read several bytes have none.
    module = sys.modules.get(f"encodings.{name.replace('-', '_')}")
    table = getattr(module, "decoding_table", "")
    return len(table) == 256 and _ASCII.decode(encoding, "replace") == _ASCII.decode("ascii")


def find_byte_beyond_utf_8(text: str, encoding: str) -> tuple[int, int] | None:
    """Return the first byte at which the bytes of a text in this encoding are not UTF-8: its offset in the text, and the byte."""
    if is_utf_8(encoding):
        return None
    data = text.encode(encoding)
    try:
        data.decode("utf-8")
    except UnicodeDecodeError as error:
        return len(data[: error.start].decode(encoding, "ignore")), data[error.start]
    return None


def _is_same_text(data: bytes, declared: str, text: str) -> bool:
    """Whether bytes that are this text in UTF-8 are it in another encoding too, or in a codec of one byte differ beyond ASCII."""
    name = _look_up(declared)
    if name == "utf-8" or is_single_byte(declared):
        return True
    try:
        return bool(name) and data.decode(declared) == text
    except (LookupError, ValueError):
        return False


def _look_up(encoding: str) -> str:
    """Return the name that Python has for an encoding, empty for one that it does not know."""
    try:
        name = codecs.lookup(encoding).name
    except (LookupError, ValueError):  # ValueError for a name with a zero byte
        return ""
    return "" if name in _NO_CHARSETS else name


def _detect_mark(data: bytes) -> str | None:
    """Return the encoding that the first bytes show: by a byte order mark, or the zero bytes of UTF-16."""
    return next((name for mark, name in _MARKS if data.startswith(mark)), None)


def _decode(data: bytes, encoding: str) -> str:
    try:
        return data.decode(encoding)
    except UnicodeDecodeError as error:
        # error.object is the data without the byte order mark.
        valid, wrong = error.object[: error.start], error.object[error.start]
        message = f"byte 0x{wrong:02x} is not valid {encoding}"
        raise UnreadableEncodingError(message, before=valid.decode(encoding, "replace")) from None


def _refuse_declared(found: re.Match[str]) -> UnreadableEncodingError:
    known = bool(_look_up(found[1]))
    reason = "in which its bytes are a different text than in UTF-8" if known else "which is not known"
    message = f"it declares the encoding {_show(found[1])}, {reason}"
    return UnreadableEncodingError(message, before=found.string[: found.start(1)], wrong=found[1])


def _show(name: str) -> str:
    return repr(name if len(name) <= _MOST_SHOWN else f"{name[:_MOST_SHOWN]}…")
