"""Find the words of tools/prose.toml in what users read: ``python tools/check_prose.py [FILE...]``.

Reads Markdown (code and references left out), the TOML texts of rule pages, and the string literals of Python and TypeScript.
tests/test_prose.py runs it over the whole project.

Neither proselint nor vale does this. proselint 0.16 takes no vocabulary from a file and reads code blocks as prose (its
issue 1355). vale is a Go program that its PyPI package downloads at the first run, and it reads neither TOML inside Markdown
nor string literals. Both would take over the loop over the patterns, and leave to this module what it is about: finding the
sentences.
"""

from __future__ import annotations

import argparse
import ast
import bisect
import re
import sys
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import tomli
from markdown_it import MarkdownIt

REPOSITORY = Path(__file__).parent.parent
VOCABULARY = Path(__file__).with_name("prose.toml")

# Stands for what is left out of a sentence and was one of its words: code, a placeholder, the value in an f-string.
HOLE = "□"
# Tables of a rule page whose strings are sentences, and keys that are sentences in any table.
SENTENCES = ("headlines", "messages", "fixes", "causes", "consumers")
# Made from sources that are read themselves.
GENERATED = ("rules/README.md", "docs/command-line.md", "docs/configuration-keys.md", "docs/what-a-check-can-ask.md")
# Words in a sentence of a page, and in a message as its rule page has it.
LONGEST_SENTENCE = 40
LONGEST_MESSAGE = 40
# String literals that are not sentences: regular expressions, CSS, and those without a small letter.
_NO_SENTENCE = re.compile(r"\\[dswbSWDB]|\(\?[:P=!<]|^\s*[.#]?[\w-]+\s*\{[^}]*:|^[^a-z]*$")


@dataclass(frozen=True)
class Habit:
    """A pattern of words that urdfcheck does not use."""

    pattern: re.Pattern[str]
    """What is found, in the text of a paragraph; ignores case."""
    better: str
    """What to write instead."""
    wrong: tuple[str, ...]
    """Sentences that the pattern must find."""
    right: tuple[str, ...]
    """Sentences that it must not find."""


@dataclass(frozen=True)
class Passage:
    """A text with the line of each of its characters."""

    path: Path
    kind: str
    """page, message, headline, string or docstring."""
    text: str
    """What is not prose is blank; what was a word of the sentence is HOLE."""
    starts: tuple[int, ...]
    """Offset of each line in text."""
    first: int
    """Number of the first line in the file."""

    def number_line(self, offset: int) -> int:
        """Return the line in the file of a character of the text."""
        return self.first + bisect.bisect_right(self.starts, offset) - 1


@dataclass(frozen=True)
class Match:
    """Words that should be others."""

    path: Path
    line: int
    kind: str
    words: str
    better: str

    def __str__(self) -> str:
        path = self.path.relative_to(REPOSITORY) if self.path.is_relative_to(REPOSITORY) else self.path
        return f"{path}:{self.line}: {self.words!r}: {self.better}"


def load_habits(path: Path = VOCABULARY) -> list[Habit]:
    """Return the vocabulary; a space in a pattern stands for any white space."""
    habits = tomli.loads(path.read_text(encoding="utf-8"))["habit"]
    return [
        Habit(
            re.compile(habit["pattern"].replace(" ", r"\s+"), re.IGNORECASE),
            habit["better"],
            tuple(habit["wrong"]),
            tuple(habit.get("right", ())),
        )
        for habit in habits
    ]


def find_habits(passage: Passage, habits: list[Habit]) -> Iterator[Match]:
    """Yield the words of a passage that the vocabulary replaces."""
    for habit in habits:
        for found in habit.pattern.finditer(passage.text):
            words = " ".join(found.group().split())
            yield Match(passage.path, passage.number_line(found.start()), passage.kind, words, habit.better)


def find_long_sentences(passage: Passage) -> Iterator[Match]:
    """Yield the sentences of a page and the messages that are too long; a code, a placeholder or a number is a word."""
    texts: list[tuple[int, str, int]] = []
    if passage.kind == "page":
        texts = [(start, sentence, LONGEST_SENTENCE) for start, sentence in split_sentences(passage.text)]
    elif passage.kind == "message":
        texts = [(0, passage.text, LONGEST_MESSAGE)]
    for start, text, limit in texts:
        if (count := len(text.split())) > limit:
            opening = " ".join(text.split()[:8])
            better = f"{count} words, at most {limit}: make two sentences of it, or leave something out"
            yield Match(passage.path, passage.number_line(start), passage.kind, f"{opening} …", better)


def check_file(path: Path, habits: list[Habit]) -> list[Match]:
    """Return what should be written otherwise in a file, in the order of its lines."""
    return check_passages(read_passages(path), habits)


def check_passages(passages: Iterable[Passage], habits: list[Habit]) -> list[Match]:
    """Return what should be written otherwise in passages of a file, in the order of its lines."""
    matches = [
        match for passage in passages for match in (*find_habits(passage, habits), *find_long_sentences(passage))
    ]
    return sorted(matches, key=lambda match: match.line)


def split_sentences(text: str) -> Iterator[tuple[int, str]]:
    """Yield offset and text of each sentence.

    It ends at a period, a colon, a semicolon, an empty line, or where an item of a list or a cell of a table begins.
    """
    start = 0
    for end in re.finditer(r"[.?!:;](?=[\s)\"]|$)|\n\s*\n|\n\s*(?:[*-]|\d+\.)\s|[|]|\Z", text):
        sentence = text[start : end.start()]
        lead = len(sentence) - len(sentence.lstrip())
        if sentence.strip():
            yield start + lead, sentence.strip()
        start = end.end()


def read_passages(path: Path) -> Iterator[Passage]:
    """Yield what users read of a file."""
    text = path.read_text(encoding="utf-8")
    if path.suffix == ".md":
        yield _make_passage(path, "page", _blank_markdown(text), 1)
        yield from _read_page_texts(path, text)
    elif path.suffix == ".py":
        yield from _read_python(path, text)
    elif path.suffix == ".ts":
        yield from _read_typescript(path, text)
    else:
        yield _make_passage(path, "string", re.sub(r"`[^`\n]*`", _fill, text), 1)


def list_files() -> list[Path]:
    """Return the files of the project that hold words for users."""
    pages = [
        "*.md",
        "docs/**/*.md",
        "rules/*.md",
        "integrations/**/*.md",
        "benchmarks/**/*.md",
        "tools/website/**/*.md",
        "editors/vscode/*.md",
    ]
    pages.append("fixtures/demos/*.md")
    code = [
        "urdfcheck/**/*.py",
        "report-ui/src/*.ts",
        "editors/vscode/src/**/*.ts",
        "tools/make_*.py",
        "tools/website/*.py",
        "rules/families.toml",
        "action.yml",
    ]
    code += [
        "urdfcheck/output/*.json",
        "integrations/**/*.yml",
        "integrations/jenkins/Jenkinsfile",
        ".pre-commit-hooks.yaml",
    ]
    code += ["fixtures/hostile/manifest.toml", "Makefile", "pyproject.toml"]
    found = {path for pattern in (*pages, *code) for path in REPOSITORY.glob(pattern)}
    return sorted(found - {REPOSITORY / path for path in GENERATED})


def _make_passage(path: Path, kind: str, text: str, first: int) -> Passage:
    starts = (0, *(end.end() for end in re.finditer("\n", text)))
    return Passage(path, kind, text, starts, first)


def _fill(match: re.Match[str]) -> str:
    """Keep the length, so that lines stay where they are."""
    return re.sub(r"\S", HOLE, match.group())


def _clear(text: str) -> str:
    return re.sub(r"\S", " ", text)


def _blank_markdown(text: str) -> str:
    lines = text.split("\n")
    for token in MarkdownIt().parse(text):
        if token.type in ("fence", "code_block", "html_block") and token.map:
            for number in range(*token.map):
                lines[number] = _clear(lines[number])
    text = "\n".join(lines)
    text = re.sub(
        r"^## References$.*?(?=^## |\Z)", lambda part: _clear(part.group()), text, flags=re.MULTILINE | re.DOTALL
    )
    text = re.sub(r"(`+)(?!`).+?(?<!`)\1(?!`)", _fill, text, flags=re.DOTALL)
    return re.sub(r"\]\([^)\s]*\)|<https?:[^>]*>|<!--.*?-->", lambda link: _clear(link.group()), text, flags=re.DOTALL)


def _read_page_texts(path: Path, text: str) -> Iterator[Passage]:
    """The texts in the first TOML block of a rule page."""
    block = re.search(r"^```toml\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)
    if path.parent.name != "rules" or block is None:
        return
    table = ""
    first = text.count("\n", 0, block.start(1)) + 1
    for number, line in enumerate(block.group(1).split("\n"), first):
        if header := re.fullmatch(r"\[([^]]+)\]", line):
            table = header.group(1).split(".")[0]
        elif (entry := re.fullmatch(r'"?([\w.-]+)"?\s*=\s*"(.*)"', line)) and (table in SENTENCES or entry[1] == "doc"):
            kind = table.removesuffix("s") if table in ("headlines", "messages") else "string"
            yield _make_passage(path, kind, blank_holes(entry[2].replace(r"\"", '"')), number)


def blank_holes(text: str) -> str:
    """Replace code and placeholders of a text by HOLE."""
    return re.sub(r"\{[^{}]*\}|`[^`]*`", _fill, text)


def _read_python(path: Path, text: str) -> Iterator[Passage]:
    docstrings, pieces = set(), set()
    lines = text.split("\n")
    for node in ast.walk(ast.parse(text)):  # parents before children
        if isinstance(node, ast.Expr):
            docstrings.add(id(node.value))
        elif isinstance(node, ast.JoinedStr):
            pieces |= {id(value) for value in node.values}
            words = "".join(value.value if isinstance(value, ast.Constant) else HOLE * 3 for value in node.values)
            yield from _read_literal(path, words, node, lines)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) in docstrings:
            yield _make_passage(path, "docstring", re.sub(r"`+[^`]*`+", _fill, node.value), node.lineno)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in pieces:
            yield from _read_literal(path, node.value, node, lines)


def _read_literal(path: Path, words: str, node: ast.expr, lines: list[str]) -> Iterator[Passage]:
    if " " in words.strip() and not _NO_SENTENCE.search(words):
        yield _locate(path, blank_holes(words), node, lines)


def _locate(path: Path, words: str, node: ast.expr, lines: list[str]) -> Passage:
    """Give the lines to a string that may be written in pieces, one below the other."""
    starts = [0]
    for number in range(node.lineno, node.end_lineno or node.lineno):
        piece = re.search(r"""['"](.{4,}?)(?:\{|['"]|$)""", lines[number])
        offset = words.find(piece[1], starts[-1]) if piece else -1
        starts.append(offset if offset >= 0 else starts[-1])
    return Passage(path, "string", words, tuple(starts), node.lineno)


def _read_typescript(path: Path, text: str) -> Iterator[Passage]:
    for literal in re.finditer(r'"((?:[^"\\\n]|\\.)*)"|`((?:[^`\\]|\\.)*)`', text):
        words = re.sub(r"\$\{[^{}]*\}", _fill, literal[1] or literal[2] or "")
        if " " in words.strip() and not _NO_SENTENCE.search(words):
            yield _make_passage(path, "string", words, text.count("\n", 0, literal.start()) + 1)


def main(arguments: list[str] | None = None) -> int:
    """Print what the vocabulary finds; the exit code is 1 where it finds anything."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("files", nargs="*", type=Path, metavar="FILE", help="all of the project without")
    parser.add_argument("--docstrings", action="store_true", help="read docstrings too")
    options = parser.parse_args(arguments)
    habits = load_habits()
    files = [path.resolve() for path in options.files] or list_files()
    matches = [match for path in files for match in check_file(path, habits)]
    if not options.docstrings:
        matches = [match for match in matches if match.kind != "docstring"]
    for match in matches:
        print(match)
    return 1 if matches else 0


if __name__ == "__main__":
    sys.exit(main())
