"""The parameters of a macro, taken apart as xacro does.

xacro's own regular expression takes exponential time for a default with a quote that is never closed.
"""

from __future__ import annotations

import re

# xacro's expression for ``name:=default rest`` but for one thing: what stands outside of quotes is taken character by
# character, where xacro takes it in runs and tries every way to cut one run into several.
_DEFAULT = r"""(?:'.*?'|".*?"|[^\s'"])+"""
_SPEC = r"^\s*([^\s:=]+?)\s*:?=\s*(\^\|?)?(\$\{{.*?\}}|\$\(.*?\)|{}|)(?:\s+|$)(.*)"
_EXACT = re.compile(_SPEC.format(_DEFAULT))
# The same, but never taking back what it took: a quote ends at the next one.
_STRAIGHT = re.compile(_SPEC.format(rf"(?=(?P<taken>{_DEFAULT}))(?P=taken)"))
# How many quotes may be paired in every possible way.
_FEW_QUOTES = 16

Default = tuple[str | None, str | None]


def parse_next_parameter(text: str) -> tuple[str, Default | None, str]:
    """The first parameter of a macro's ``params``: its name, its default with the name of what is forwarded before it
    (None without any), and the rest of the text. The same as xacro's ``parse_macro_arg``."""
    few = text.count("'") + text.count('"') <= _FEW_QUOTES
    match = (_EXACT if few else _STRAIGHT).match(text)
    if match is None:
        words = text.lstrip().split(None, 1)
        return words[0], None, words[1] if len(words) > 1 else ""
    name, forward, default, *_, rest = match.groups()
    return name, (name if forward else None, default or None), rest
