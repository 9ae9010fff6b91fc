"""The parameters of a macro, taken apart as xacro does.

xacro's own regular expression takes exponential time for a default with a quote that is never closed.
"""

from __future__ import annotations

import re

# xacro's expression for ``name:=default rest`` with one difference: text outside of quotes is matched character by character;
# xacro matches it in runs, and tries every way to cut one run into several.
_DEFAULT = r"""(?:'.*?'|".*?"|[^\s'"])+"""
_SPEC = r"^\s*([^\s:=]+?)\s*:?=\s*(\^\|?)?(\$\{{.*?\}}|\$\(.*?\)|{}|)(?:\s+|$)(.*)"
_EXACT = re.compile(_SPEC.format(_DEFAULT))
# The same without backtracking: a quote ends at the next one.
_STRAIGHT = re.compile(_SPEC.format(rf"(?=(?P<taken>{_DEFAULT}))(?P=taken)"))
# Up to this many quotes are paired in every possible way.
_FEW_QUOTES = 16

Default = tuple[str | None, str | None]


def parse_next_parameter(text: str) -> tuple[str, Default | None, str]:
    """Return the first parameter of a macro's ``params``, as xacro's ``parse_macro_arg`` does.

    The parts are its name, its default after the name that is forwarded (None without a default), and the rest of the text.
    """
    few = text.count("'") + text.count('"') <= _FEW_QUOTES
    match = (_EXACT if few else _STRAIGHT).match(text)
    if match is None:
        words = text.lstrip().split(None, 1)
        return words[0], None, words[1] if len(words) > 1 else ""
    name, forward, default, *_, rest = match.groups()
    return name, (name if forward else None, default or None), rest
