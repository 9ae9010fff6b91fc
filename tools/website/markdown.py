"""Markdown of the repository as Markdown of the site.

Links lead to the pages of the site, codes of rules to their pages, and examples have the names of their files.
"""

from __future__ import annotations

import posixpath
import re
from collections.abc import Mapping
from pathlib import PurePosixPath

# What is prose: no fence, inline code, comment or heading. A link is taken whole, with code in its text.
_PIECES = re.compile(
    r"""
      (?P<fence>^(?P<bars>`{3,}|~{3,})(?P<language>\w*)(?:[ ]file=(?P<file>\S+))?(?:[ ]exit=\d)?\n(?P<lines>.*?)^(?P=bars)[ ]*$)
    | (?P<html><!--.*?-->|<pre\b.*?</pre>)
    | (?P<heading>^\#[^\n]*$)
    | (?P<link>(?P<image>!?)\[(?P<text>(?:[^\[\]`]|`[^`]*`)*)\]\((?P<target>[^)\s]+)\))
    | (?P<code>(?P<ticks>`+)(?!`).+?(?<!`)(?P=ticks)(?!`))
    | (?P<word>\b[A-Z]{3}\d{3}\b)
    """,
    re.MULTILINE | re.DOTALL | re.VERBOSE,
)

# What the highlighter calls the languages of the fences.
_LANGUAGES = {"urdf": "xml", "xacro": "xml", "launch": "xml", "dae": "xml", "obj": "text", "off": "text", "stl": "text"}
_LANGUAGES_OF_FILES = {".yaml": "yaml", ".yml": "yaml", ".py": "python", ".toml": "toml", ".txt": "cmake"}
_EXPECTED = re.compile(r"\s*(?:<!-- expect: (.*?) -->|# expect: (.*)$)")


def convert_markdown(
    text: str, *, source: str, address: str, addresses: Mapping[str, str], rules: Mapping[str, str]
) -> str:
    """Return a page of the repository as the site needs it.

    What the site does not hold is named by its path in the repository: the project has no address that could be linked.

    :param source: the file of the page, relative to the repository.
    :param address: the page's file in the folder of the site.
    :param addresses: files in the folder of the site, by the files of the repository that they are made from.
    :param rules: the addresses of the rules' pages by code. A code in prose becomes a link, except on its own page.
    """

    def convert(match: re.Match[str]) -> str:
        if match["link"] is not None:
            return _convert_link(match, source, address, addresses)
        if match["fence"] is not None:
            return _convert_fence(match)
        page = rules.get(match["word"] or "")
        return match[0] if page in (None, address) else f"[{match['word']}]({relate(page, address)})"

    return _PIECES.sub(convert, text)


def relate(target: str, address: str) -> str:
    """Return the link from one page to another or to a file; both are paths in the folder of the site."""
    return posixpath.relpath(target, posixpath.dirname(address) or ".")


def _convert_link(match: re.Match[str], source: str, address: str, addresses: Mapping[str, str]) -> str:
    path, mark, fragment = match["target"].partition("#")
    if not path or re.match(r"[a-z]+:", path):
        return match[0]
    place = posixpath.normpath(posixpath.join(posixpath.dirname(source), path))
    if place in addresses:
        return f"{match['image']}[{match['text']}]({relate(addresses[place], address)}{mark}{fragment})"
    return match["text"] if place in match["text"] else f"{match['text']} (`{place}` in the repository)"


def _convert_fence(match: re.Match[str]) -> str:
    """Give an example the name of its file, and mark the lines that must be reported instead of the comments that say so."""
    lines, marked = [], []
    for number, line in enumerate(match["lines"].splitlines(), 1):
        stripped = _EXPECTED.sub("", line)
        lines.append(stripped)
        if stripped != line:
            marked.append(str(number))
    language, file = match["language"], match["file"]
    language = _LANGUAGES.get(language, language)
    if file and match["language"] == "text":
        language = _LANGUAGES_OF_FILES.get(PurePosixPath(file).suffix, language)
    title = f' title="{file}"' if file else ""
    marks = f' hl_lines="{" ".join(marked)}"' if marked else ""
    return "\n".join((f"{match['bars']}{language}{title}{marks}", *lines, match["bars"]))
