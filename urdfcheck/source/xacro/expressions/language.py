"""Which functions and methods belong to xacro's language, and what each of them does with texts and paths."""

from __future__ import annotations

import re
from collections.abc import Mapping


def _split_words(text: str) -> frozenset[str]:
    return frozenset(text.split())


_NUMBER_METHODS = frozenset({"real", "imag", "numerator", "denominator", "conjugate", "is_integer", "bit_length"})
_SET_METHODS = _split_words(
    "copy difference intersection isdisjoint issubset issuperset symmetric_difference union add clear"
    " difference_update discard intersection_update pop remove symmetric_difference_update update"
)
# The methods that stay within the language, by type.
METHODS: Mapping[type, frozenset[str]] = {
    str: _split_words(
        "capitalize casefold center count endswith expandtabs find format index isalnum isalpha isascii isdecimal isdigit"
        " isidentifier islower isnumeric isprintable isspace istitle isupper join ljust lower lstrip partition"
        " removeprefix removesuffix replace rfind rindex rjust rpartition rsplit rstrip split splitlines startswith"
        " strip swapcase title upper zfill"
    ),
    list: _split_words("append clear copy count extend index insert pop remove reverse sort"),
    tuple: frozenset({"count", "index"}),
    dict: _split_words("clear copy get items keys pop popitem setdefault update values"),
    set: _SET_METHODS,
    frozenset: _SET_METHODS,
    range: frozenset({"count", "index"}),
    int: _NUMBER_METHODS,
    float: _NUMBER_METHODS,
    complex: _NUMBER_METHODS,
}
# The methods that visit everything that their object contains, at any depth.
DEEP_METHODS = frozenset({"count", "index", "remove", "sort", "copy", *_SET_METHODS})
# `vars` returns a class's own dictionary, in which dunder names are plain keys; `type` returns the classes.
FORBIDDEN_FUNCTIONS = frozenset({"type", "vars"})
# Functions that make a text of their arguments.
TEXT_FUNCTIONS = frozenset({"str", "repr", "format"})
# Functions and methods that hand the place of a file on, or open it, without a decision.
PATH_FUNCTIONS = _split_words(
    "str repr message warning error fatal print_location format join load_yaml abs_filename dict"
)
PATH_METHODS = frozenset({"format", "join"})
# Those that may cut the place of a file, or take it apart.
TEXT_MAKERS = TEXT_FUNCTIONS | PATH_METHODS
NAMESPACE_METHODS = frozenset({"get", "items", "keys", "values"})
FORMAT_FIELD = re.compile(r"%(?:\([^()]*\))?[-#0 +]*(\*|\d*)(?:\.(\*|\d*))?[hlL]?[^(]", re.DOTALL)
