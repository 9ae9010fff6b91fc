"""Python files of others, which are parsed and never run."""

from __future__ import annotations

import ast
import warnings


def parse_python(text: str) -> ast.Module | None:
    """Return the syntax tree of a Python file; None if it is not Python, or nested too deeply."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # Python's warnings about a stranger's code do not belong on the terminal
            return ast.parse(text)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return None
