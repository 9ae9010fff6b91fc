"""Pages of the reference that are made from the package itself: exit codes, the Python interface, the JSON formats."""

from __future__ import annotations

import ast
import inspect
import json
import re
from collections.abc import Iterator
from enum import Enum
from pathlib import Path
from types import FunctionType
from typing import Any

from docstrings import render_class

import urdfcheck
from website.markdown import relate
from website.navigation import CONFIGURATION, REPOSITORY, SCHEMAS, list_copied_files

GATE = "docs/continuous-integration.md"
_SCHEMA_FILES = (
    ("report.schema.json", "`urdfcheck --format json`"),
    ("diff.schema.json", "`urdfcheck diff --format json`"),
    ("audit.schema.json", "a line of what `urdfcheck audit` writes"),
)
CONFIG_SCHEMA = "files/urdfcheck.schema.json"
_FIELD = re.compile(r"^:(?P<kind>\w+)(?: (?P<name>[^:]+))?: (?P<text>.*?)(?=^:\w|\Z)", re.MULTILINE | re.DOTALL)
_DOCTEST = re.compile(r"^>>> .*?(?=\n\s*\n|\Z)", re.MULTILINE | re.DOTALL)


def render_exit_codes() -> str:
    """Return the section of the guide about exit codes as a page, with its links as they are in the guide."""
    text = (REPOSITORY / GATE).read_text(encoding="utf-8")
    found = re.search(r"^## Exit codes\n(.*?)(?=^## )", text, re.MULTILINE | re.DOTALL)
    assert found is not None, f"{GATE} has no section about exit codes"
    return f"# Exit codes\n{found[1]}"


def render_python_api() -> str:
    """Return the page about what `urdfcheck.__all__` names, with links as a page in docs/ has them."""
    parts = [
        "# Python API\n",
        "What `import urdfcheck` offers, from its docstrings. [The guide](python.md) shows how to use it, and "
        "[CONTRIBUTING](../CONTRIBUTING.md#what-is-stable) says what stays stable. `AnyPath` is a string or a `Path`. "
        "`Paths` are one or several of them, `Words` one or several strings.\n",
    ]
    public = [inspect.unwrap(getattr(urdfcheck, name)) for name in urdfcheck.__all__ if not name.startswith("_")]
    parts += (_render_function(thing) for thing in public if isinstance(thing, FunctionType))
    parts += (_render_class(thing) for thing in public if inspect.isclass(thing))
    return "\n".join(parts)


def _render_function(function: FunctionType) -> str:
    lines = [f"def {function.__name__}("]
    named = False
    for parameter in inspect.signature(function).parameters.values():
        if parameter.kind is parameter.KEYWORD_ONLY and not named:
            lines.append("    *,")
            named = True
        stars = "**" if parameter.kind is parameter.VAR_KEYWORD else ""
        default = "" if parameter.default is parameter.empty else f" = {parameter.default!r}"
        lines.append(f"    {stars}{parameter.name}: {parameter.annotation}{default},")
    lines.append(f") -> {inspect.signature(function).return_annotation}")
    document = _convert_docstring(inspect.getdoc(function) or "")
    return "\n".join((f"## `{function.__name__}`\n\n```python", *lines, f"```\n\n{document}\n"))


def _render_class(kind: type) -> str:
    text = render_class(_find_definition(kind), f"`{kind.__name__}`").strip("\n")
    if text.endswith("|---|"):  # an exception has no fields
        text = text.rpartition("\n\n")[0]
    if issubclass(kind, Enum):
        text += f"\n\nMembers: {', '.join(f'`{member.name}`' for member in kind)}"
    return _convert_inline(text) + "\n"


def _find_definition(kind: type) -> ast.ClassDef:
    module = ast.parse(Path(inspect.getsourcefile(kind) or "").read_text(encoding="utf-8"))
    return next(node for node in module.body if isinstance(node, ast.ClassDef) and node.name == kind.__name__)


def _convert_docstring(text: str) -> str:
    """Return a docstring as Markdown: its fields as lists, its examples as code."""
    fields = ""
    if found := re.search(r"^:\w+.*", text, re.MULTILINE | re.DOTALL):
        text, fields = text[: found.start()], "\n".join(_list_fields(found[0]))
    text = _DOCTEST.sub(lambda example: f"```pycon\n{example[0]}\n```", text)
    return _convert_inline(f"{text.strip()}\n\n{fields}".strip())


def _list_fields(text: str) -> Iterator[str]:
    for field in _FIELD.finditer(text):
        meaning = " ".join(field["text"].split())
        match field["kind"]:
            case "param":
                yield f"* `{field['name']}`: {meaning}"
            case "raises":
                yield f"* raises `{field['name']}` {meaning}"
            case kind:
                yield f"* {kind} {meaning}"


def _convert_inline(text: str) -> str:
    return re.sub(r"(?<!`)``(?!`)", "`", re.sub(r":\w+:`([^`]+)`", r"`\1`", text))


def render_schemas() -> str:
    """Return the page about the JSON formats, with its links as they are on the site."""
    files = list_copied_files()
    parts = [
        "# JSON formats\n\nEach format has a JSON Schema, from which this page is made. Keys are added and never renamed "
        "while the name in `schema` stays.\n"
    ]
    for name, command in _SCHEMA_FILES:
        path = f"urdfcheck/output/{name}"
        schema = json.loads((REPOSITORY / path).read_text(encoding="utf-8"))
        link = f"[{name}]({relate(files[path], SCHEMAS.address)})"
        parts.append(f"## {schema['title']}\n\n{command} · {link}\n\n{_render_object(schema, name)}")
        for part, described in schema.get("$defs", {}).items():
            parts.append(f"### {part} {{ #{_name_anchor(name, part)} }}\n\n{_render_object(described, name)}")
    link, page = relate(CONFIG_SCHEMA, SCHEMAS.address), relate(CONFIGURATION.address, SCHEMAS.address)
    parts.append(
        f"## urdfcheck.toml\n\n`urdfcheck config --schema` · [{Path(CONFIG_SCHEMA).name}]({link})\n\n"
        f"For editors. [Configuration keys]({page}) describes it."
    )
    return "\n".join(parts)


def _name_anchor(file: str, part: str) -> str:
    return f"{file.partition('.')[0]}-{part}"


def _render_object(schema: dict[str, Any], file: str) -> str:
    """Return the description of a schema, and a table of its keys if it is an object with known ones."""
    text = _escape_cell(schema.get("description", ""))
    if "properties" not in schema:
        return f"{_describe_type(schema, file)}. {text}\n"
    rows = []
    for name, part in schema["properties"].items():
        note = "" if name in schema.get("required", ()) else " (optional)"
        meaning = _escape_cell(part.get("description", ""))
        rows.append(f"| `{name}`{note} | {_describe_type(part, file)} | {meaning} |")
    return "\n".join((text, "", "| key | value | meaning |", "|---|---|---|", *rows)).strip("\n") + "\n"


def _describe_type(schema: dict[str, Any], file: str) -> str:
    """Say in a few words what a value may be; a part of a schema that has a name is a link to it."""
    if "$ref" in schema:
        other, _, part = schema["$ref"].partition("#/$defs/")
        return f"[{part}](#{_name_anchor(other or file, part)})"
    if "const" in schema or "enum" in schema:
        return ", ".join(f"`{json.dumps(value)}`" for value in schema.get("enum", [schema.get("const")]))
    for key in ("anyOf", "oneOf"):
        if key in schema:
            return " or ".join(_describe_type(choice, file) for choice in schema[key])
    kind = schema.get("type", "any value")
    if kind == "array" and isinstance(schema.get("items"), dict):
        return f"list of {_describe_type(schema['items'], file)}"
    if kind == "object" and isinstance(schema.get("additionalProperties"), dict):
        return f"object of {_describe_type(schema['additionalProperties'], file)}"
    return " or ".join(kind) if isinstance(kind, list) else str(kind)


def _escape_cell(text: str) -> str:
    return text.replace("|", "\\|").replace("<", "&lt;")
