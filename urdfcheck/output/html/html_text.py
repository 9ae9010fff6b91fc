"""Text made inert for HTML: escaping, and numbers with units."""

from __future__ import annotations

import html
import math
import re
from collections.abc import Mapping
from types import MappingProxyType

from urdfcheck.output.shared.escaping import escape_invisible

NO_VALUE = "—"
_SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_CODE = re.compile(r"`([^`\n]+)`")


def escape_html(text: str) -> str:
    """Make ``text`` safe between tags and in quoted attributes; control and invisible characters are escaped too."""
    return html.escape(escape_invisible(text))


def render_prose(text: str) -> str:
    """Render the message of a rule: plain text, except that text in backticks is code."""
    return _CODE.sub(r"<code>\1</code>", escape_html(text))


def format_number(value: float | None, digits: int = 4) -> str:
    """Format ``digits`` significant digits with a true minus sign; powers of ten below 1e-4 and from 1e6 on."""
    if value is None:
        return NO_VALUE
    if not math.isfinite(value):
        return str(value).replace("-", "−")
    if value == 0:
        return "0"
    if 1e4 <= abs(value) < 1e6:
        return format_whole_number(value)
    mantissa, _, exponent = f"{value:.{digits}g}".partition("e")
    power = f"×10{str(int(exponent)).translate(_SUPERSCRIPT)}" if exponent else ""
    return mantissa.replace("-", "−") + power


def format_whole_number(value: float) -> str:
    """Format a whole number with thin spaces between thousands."""
    return f"{value:,.0f}".replace(",", "\u202f").replace("-", "−")


def format_millimetres(metres: float) -> str:
    """Format a length in m as millimetres with three decimals; what rounds to zero is a plain 0."""
    if not math.isfinite(metres):
        return str(metres)
    text = _format_fixed(metres * 1000, 3)
    return text if text.strip("0.") else "0"


def _format_fixed(value: float, decimals: int) -> str:
    """Format decimals without a minus sign on what rounds to zero."""
    text = f"{value:.{decimals}f}"
    return text.replace("-", "" if float(text) == 0 else "−")


def format_scaled(values: tuple[float, ...], digits: int = 4) -> tuple[list[str], str]:
    """Format values with one power of ten (a multiple of three) for all, so that their digits can be compared."""
    largest = max((abs(v) for v in values if math.isfinite(v)), default=0.0)
    power = 0 if largest == 0 or 0.1 <= largest < 1e4 else 3 * math.floor(math.log10(largest) / 3)
    decimals = max(0, digits - 1 - math.floor(math.log10(largest * 10.0**-power))) if largest > 0 else 0
    mantissas = [_format_fixed(v * 10.0**-power, decimals) for v in values]
    return mantissas, f"×10{str(power).translate(_SUPERSCRIPT)}" if power else ""


def render_path(path: str, args: Mapping[str, str] = MappingProxyType({})) -> str:
    """Render a file and the arguments that it was expanded with; a long path may break between its folders."""
    arguments = "".join(f" <code>{escape_html(name)}:={escape_html(value)}</code>" for name, value in args.items())
    return f'<p class="path"><code>{escape_html(path).replace("/", "/<wbr>")}</code>{arguments}</p>'


def list_acceptors(kinds: Mapping[str, int]) -> str:
    """Say how many findings the source, the configuration and the baseline suppress, by the kind of suppression."""
    order = ("source", "configuration", "baseline")
    return ", ".join(f"{format_whole_number(kinds[kind])} in the {kind}" for kind in order if kinds.get(kind))
