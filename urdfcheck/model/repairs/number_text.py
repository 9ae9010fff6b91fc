"""New numbers in the notation in which their author typed the old ones.

An exponent stays an exponent and a decimal fraction stays one, digits are written as needed, and where only the sign or the power
of ten changes the digits stay. The blanks between numbers stay too.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence
from decimal import Decimal

# Numbers are the same when they agree to within this share, which a file's digits can express.
NEGLIGIBLE_DIFFERENCE = 1e-6
_EXPONENT = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE])([+-]?)(\d+)")
_FIXED = re.compile(r"[+-]?(\d*)\.?(\d*)")
_WORD = re.compile(r"\S+")
# A number between these powers of ten is written without an exponent, whatever its neighbour looked like.
_LEAST_FIXED, _MOST_FIXED = -4, 6
# A fraction with so many more zeros behind the point than its neighbour gets an exponent.
_MOST_ZEROS = 3
# A double holds so many decimal digits; a number of fewer that came out of a computation has an error in the last ones.
_MOST_EXACT, _MOST_TYPED = 15, 10
# Zeros at the end of a number (0.50) are a style up to so many decimals, and the padding of a program beyond.
_MOST_STYLED = 4


def keep_notation(typed: str, text: str) -> str:
    """Return ``text``, one or several numbers, in the notation of the numbers in ``typed`` that it replaces.

    Unchanged where the two have different numbers of words, or a word is not a number.
    """
    words = text.split()
    old = typed.split()
    if len(words) != len(old) or not words:
        return text
    numbers = [(_parse_decimal(a), _parse_decimal(b)) for a, b in zip(old, words, strict=True)]
    written = iter(
        word if before is None or after is None else _write_like(was, before, word, after)
        for was, word, (before, after) in zip(old, words, numbers, strict=True)
    )
    return _WORD.sub(lambda _: next(written), typed)


def write_numbers(typed: str, values: Sequence[float], digits: int = 6) -> str:
    """Write numbers in place of those of an attribute, each as :func:`write_number` does; its neighbours are the others."""
    old = typed.split()
    words = old if len(old) == len(values) else [""] * len(values)
    new = [write_number(word, float(value), words, digits) for word, value in zip(words, values, strict=True)]
    return keep_notation(typed, " ".join(new))


def write_number(typed: str, value: float, others: Iterable[str] = (), digits: int = 6) -> str:
    """Return a number as it was typed where only its sign or a power of ten changes, else with so many significant digits.

    :param typed: the number that it replaces; empty if there is none.
    :param others: its neighbours: a number that changed places with one is written as that one was typed.
    """
    for word, powers in ((typed, True), *((other, False) for other in others)):
        old = _parse_decimal(word.strip())
        if old and value and abs(old.adjusted()) < 300:
            shift = round(math.log10(abs(value)) - math.log10(abs(float(old)))) if powers else 0
            scaled = old.scaleb(shift).copy_sign(Decimal(value))
            if math.isclose(float(scaled), value, rel_tol=NEGLIGIBLE_DIFFERENCE):
                is_own = powers and shift == 0  # the sign alone
                if not is_own and (clean := _drop_noise(scaled)) is not None:
                    return clean
                return word.strip() if scaled == old else _rewrite_number(word.strip(), scaled, shift)
    return keep_notation(typed.strip(), f"{value:.{digits}g}") if value else "0"


def _drop_noise(number: Decimal) -> str | None:
    """Return a number without the rounding error of its computation (3.7500000000000003e-05); None if it has none."""
    clean = Decimal(f"{number:.{_MOST_EXACT}g}").normalize()
    is_noise = len(number.as_tuple().digits) > _MOST_EXACT and len(clean.as_tuple().digits) <= _MOST_TYPED
    return f"{float(clean):.{_MOST_TYPED}g}" if is_noise else None


def _parse_decimal(word: str) -> Decimal | None:
    try:
        number = Decimal(word)
    except ArithmeticError:
        return None
    return number if number.is_finite() else None


def _write_like(typed: str, old: Decimal, text: str, new: Decimal) -> str:
    """Return a number in the notation of another."""
    if new == old:
        return typed
    if new == -old:
        return typed.lstrip("+-") if new > 0 else f"-{typed.lstrip('+')}"
    match = _EXPONENT.fullmatch(typed)
    if match is not None and new and not _LEAST_FIXED < new.adjusted() < _MOST_FIXED:
        return _write_exponent(new, match)
    if match is None and old and new and _is_readable(old, new):
        return _pad_zeros(typed, format(new, "f"))
    return text


def _is_readable(old: Decimal, new: Decimal) -> bool:
    """Whether a number can be read without an exponent, beside one of another size that has none."""
    return min(_LEAST_FIXED, old.adjusted() - _MOST_ZEROS) < new.adjusted() < max(_MOST_FIXED, old.adjusted() + 1)


def _write_exponent(number: Decimal, like: re.Match[str]) -> str:
    """Write a number with an exponent whose letter, sign and width are those of another."""
    _, mark, sign, power = like.groups()
    digits = number.normalize().scaleb(-number.adjusted())
    exponent = number.adjusted()
    shown = "-" if exponent < 0 else "+" if sign else ""
    return f"{digits:f}{mark}{shown}{abs(exponent):0{len(power)}d}"


def _pad_zeros(typed: str, text: str) -> str:
    """Give a decimal fraction as many decimals as one that was typed with zeros at its end: 0.50."""
    match = _FIXED.fullmatch(typed)
    decimals = "" if match is None else match[2]
    if not decimals.endswith("0") or len(decimals) > _MOST_STYLED:
        return text
    whole, _, fraction = text.partition(".")
    return f"{whole}.{fraction.ljust(len(decimals), '0')}"


def _rewrite_number(typed: str, value: Decimal, shift: int) -> str:
    """Return a number with another sign or power of ten (``shift``) in the notation in which it was typed."""
    match = _EXPONENT.fullmatch(typed)
    if match is not None:
        digits, mark, sign, power = match.groups()
        shifted = int(f"{sign}{power}") + shift
        minus, before_power = "-" if value.is_signed() else "", "-" if shifted < 0 else "+" if sign else ""
        return f"{minus}{digits}{mark}{before_power}{abs(shifted):0{len(power)}d}"
    text = format(value, "f")
    return text if len(text) <= len(str(value)) + 6 else str(value).replace("E", "e")
