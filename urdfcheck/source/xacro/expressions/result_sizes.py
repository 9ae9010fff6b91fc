"""How large the result of an operation or a function may be; each check is made before the result is computed."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

from urdfcheck.source.xacro.expressions.compile_expression import ExpressionRefusedError

# Far above the need of robots, far below what harms.
MAX_ITEMS = 100_000
MAX_CHARACTERS = 1_000_000
MAX_BITS = 10_000
MAX_DEPTH = 100
MAX_WIDTH = 1_000
MAX_SEPARATORS = 100


def make_too_long_error(limit: int, what: str) -> ExpressionRefusedError:
    return ExpressionRefusedError("too_large", f"its value would have more than {limit:,} {what}")


def ensure_bits(bits: float) -> None:
    if bits > MAX_BITS:
        raise ExpressionRefusedError("too_large", f"its value would have more than {MAX_BITS * 0.30103:,.0f} digits")


def parse_width(text: str | None) -> int:
    if text and (len(text) > 9 or int(text) > MAX_WIDTH):
        raise ExpressionRefusedError("too_large", f"it pads a value to more than {MAX_WIDTH:,} characters")
    return int(text or 0)


# Of the functions below: too few or too many arguments are left to the function itself.
def _ensure_range_size(*args: Any, **_: Any) -> None:
    if args and all(isinstance(a, int) for a in args) and len(args) <= 3 and (len(args) < 3 or args[2]):
        start, stop, step = (0, args[0], 1) if len(args) == 1 else (*args, 1)[:3]
        if (stop - start) // step > MAX_ITEMS:
            raise make_too_long_error(MAX_ITEMS, "items")


def _ensure_int_size(value: Any = 0, *_: Any, **__: Any) -> None:
    if isinstance(value, str):
        ensure_bits(len(value))


def _ensure_round_size(number: Any = 0, ndigits: Any = None, **_: Any) -> None:
    if isinstance(number, int) and isinstance(ndigits, int) and ndigits < 0:
        ensure_bits(-ndigits / 0.3)


def _ensure_factorial_size(n: Any = 0, *_: Any) -> None:
    if isinstance(n, (int, float)) and n > 1:
        ensure_bits(n * math.log2(n))


def _ensure_comb_size(n: Any = 0, k: Any = 0, *_: Any) -> None:
    if isinstance(n, int) and isinstance(k, int) and 0 < k < n:
        ensure_bits(min(k, n - k) * math.log2(n))


def _ensure_perm_size(n: Any = 0, k: Any = None, *_: Any) -> None:
    k = n if k is None else k
    if isinstance(n, int) and isinstance(k, int) and 0 < k <= n:
        ensure_bits(k * math.log2(n))


def _ensure_product_size(items: Any = (), *_: Any, start: Any = 1) -> None:
    ensure_bits(sum(i.bit_length() for i in (*items, start) if isinstance(i, int)))


def _ensure_lcm_size(*numbers: Any) -> None:
    ensure_bits(sum(i.bit_length() for i in numbers if isinstance(i, int)))


def _ensure_plain_separators(_text: Any = "", sep: Any = "", *_: Any, **__: Any) -> None:
    # tokenize puts the separators between [ and ] of a regular expression.
    if isinstance(sep, str) and len(sep) > MAX_SEPARATORS:
        raise ExpressionRefusedError("too_large", f"it gives xacro.tokenize more than {MAX_SEPARATORS} separators")
    if isinstance(sep, str) and "]" in sep[1:]:
        raise ExpressionRefusedError("unsafe", "the separators of xacro.tokenize contain a regular expression")


ARGUMENT_CHECKS: Mapping[str, Callable[..., None]] = {
    "int": _ensure_int_size,
    "range": _ensure_range_size,
    "round": _ensure_round_size,
    "factorial": _ensure_factorial_size,
    "comb": _ensure_comb_size,
    "perm": _ensure_perm_size,
    "prod": _ensure_product_size,
    "lcm": _ensure_lcm_size,
    "tokenize": _ensure_plain_separators,
}
