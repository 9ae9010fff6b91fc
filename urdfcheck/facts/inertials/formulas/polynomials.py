"""Arithmetic expressions as polynomials of their names."""

from __future__ import annotations

import ast
import math
from collections import Counter
from collections.abc import Mapping, Sequence

# The powers of the names that are multiplied: `m*r*r` is {("m", 1), ("r", 2)}.
Monomial = frozenset[tuple[str, int]]
# Coefficients by monomial.
Polynomial = Mapping[Monomial, float]

ONE: Monomial = frozenset()
_CONSTANTS = {"pi": math.pi, "PI": math.pi, "M_PI": math.pi}
# A formula of a moment has three terms of at most four factors.
_MOST_TERMS, _MOST_FACTORS = 12, 6
_LONGEST = 500


def parse_polynomial(text: str) -> Polynomial | None:
    """Return an expression as a polynomial of its names; None if it is not one, or far longer than the formula of a moment."""
    if len(text) > _LONGEST:
        return None
    try:
        return _convert(ast.parse(text.strip(), mode="eval").body)
    except (SyntaxError, ValueError, RecursionError, MemoryError, OverflowError, ZeroDivisionError):
        return None


def measure_degree(polynomial: Polynomial) -> int:
    """Return how many names are multiplied in a term, powers counted: the most."""
    return max(sum(power for _, power in term) for term in polynomial)


def divide_by_common_factor(polynomials: Sequence[Polynomial]) -> tuple[list[Polynomial], Monomial]:
    """Divide polynomials by the names that all their terms have in common, which are returned too."""
    terms = [Counter(dict(term)) for polynomial in polynomials for term in polynomial]
    common = terms[0].copy()
    for term in terms[1:]:
        common &= term
    divided: list[Polynomial] = [
        {frozenset((Counter(dict(term)) - common).items()): value for term, value in polynomial.items()}
        for polynomial in polynomials
    ]
    return divided, frozenset(common.items())


def _convert(node: ast.expr) -> Polynomial:
    """Convert a syntax tree.

    :raises ValueError: if it is not a polynomial.
    """
    match node:
        case ast.Constant(value=int() | float() as value):
            return {ONE: float(value)}
        case ast.Name(id=name):
            return {ONE: _CONSTANTS[name]} if name in _CONSTANTS else {frozenset({(name, 1)}): 1.0}
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return _scale(_convert(operand), -1.0)
        case ast.UnaryOp(op=ast.UAdd(), operand=operand):
            return _convert(operand)
        case ast.BinOp(left=left, op=ast.Add(), right=right):
            return _add(_convert(left), _convert(right))
        case ast.BinOp(left=left, op=ast.Sub(), right=right):
            return _add(_convert(left), _scale(_convert(right), -1.0))
        case ast.BinOp(left=left, op=ast.Mult(), right=right):
            return _multiply(_convert(left), _convert(right))
        case ast.BinOp(left=left, op=ast.Div(), right=right):
            return _scale(_convert(left), 1.0 / _get_number(_convert(right)))
        case (
            ast.BinOp(left=left, op=ast.Pow(), right=right)
            | ast.Call(func=ast.Name(id="pow"), args=[left, right], keywords=[])
        ):
            return _raise(_convert(left), _get_number(_convert(right)))
    raise ValueError("no polynomial")


def _get_number(polynomial: Polynomial) -> float:
    if set(polynomial) != {ONE}:
        raise ValueError("no number")
    return polynomial[ONE]


def _add(one: Polynomial, other: Polynomial) -> Polynomial:
    return _limit({term: one.get(term, 0.0) + other.get(term, 0.0) for term in {**one, **other}})


def _scale(polynomial: Polynomial, factor: float) -> Polynomial:
    return {term: value * factor for term, value in polynomial.items()}


def _multiply(one: Polynomial, other: Polynomial) -> Polynomial:
    product: dict[Monomial, float] = {}
    for left, a in one.items():
        for right, b in other.items():
            term = frozenset((Counter(dict(left)) + Counter(dict(right))).items())
            product[term] = product.get(term, 0.0) + a * b
    return _limit(product)


def _raise(polynomial: Polynomial, power: float) -> Polynomial:
    if power not in range(1, _MOST_FACTORS + 1):
        raise ValueError("no power")
    result = polynomial
    for _ in range(int(power) - 1):
        result = _multiply(result, polynomial)
    return result


def _limit(polynomial: dict[Monomial, float]) -> Polynomial:
    if len(polynomial) > _MOST_TERMS or any(sum(dict(term).values()) > _MOST_FACTORS for term in polynomial):
        raise ValueError("too long")
    if not all(map(math.isfinite, polynomial.values())):
        raise ValueError("too large")
    return polynomial
