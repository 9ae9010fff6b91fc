"""Make docs/what-a-check-can-ask.md from the docstrings of the model: ``python tools/make_model_page.py``."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parent.parent
PACKAGE = REPOSITORY / "urdfcheck"
PAGE = REPOSITORY / "docs" / "what-a-check-can-ask.md"

INTRODUCTION = """\
# What a check can ask of the model

A check gets a `Model` (scope `model`), and asks it and the functions below; what is heavy is computed when it is first asked for,
once per model. This page is made from the docstrings by `make reports`.

* A **fact** is a function of the model that is remembered: asking twice costs nothing. Where it cannot be had (a broken tree, an
  unread mesh, a library that is not installed) it raises `FactUnavailableError`, and the run lists the check as skipped.
* Numbers are SI: metres, radians, kilograms, kg m². Arrays are numpy's; `(3,)` and `(N, 4, 4)` are their shapes.
* What a finding points at is anything with a `location`: an attribute, an element, a link, a joint, a shape.
"""

# The classes that a check handles all the time, in the order in which it meets them.
CLASSES = (
    ("model/robot.py", {"Model"}),
    ("model/parts.py", None),
    ("model/tree.py", {"Tree"}),
    ("model/meshes.py", None),
    ("source/text/xml.py", {"Element", "Attribute"}),
    ("source/load.py", {"Source"}),
    ("model/launch_context.py", None),
)
# Functions that checks share: how words and numbers are written and read, and edits made.
SHARED = ("core/text.py", "source/text/values.py", "model/repairs/edits.py")


def render_page() -> str:
    """Return the text of the page."""
    parts = [INTRODUCTION]
    for name, wanted in CLASSES:
        module = ast.parse((PACKAGE / name).read_text(encoding="utf-8"))
        for node in module.body:
            if (
                isinstance(node, ast.ClassDef)
                and not node.name.startswith("_")
                and (wanted is None or node.name in wanted)
            ):
                parts.append(_render_class(node, _name_module(PACKAGE / name)))
    parts.append("\n# Words, numbers and edits\n")
    for name in SHARED:
        module = ast.parse((PACKAGE / name).read_text(encoding="utf-8"))
        parts.append(_render_functions(PACKAGE / name, list(_list_functions(module, of_model=False))))
    parts.append("\n# Functions of the model\n")
    for path in sorted((PACKAGE / "model").rglob("*.py")):
        rows = list(_list_functions(ast.parse(path.read_text(encoding="utf-8")), of_model=True))
        if rows:
            parts.append(_render_functions(path, rows))
    return "".join(parts)


def _render_functions(path: Path, rows: list[str]) -> str:
    doc = _read_summary(ast.parse(path.read_text(encoding="utf-8")))
    return f"\n## `{_name_module(path)}`\n\n{doc}\n\n| function | returns | |\n|---|---|---|\n{''.join(rows)}"


def _name_module(path: Path) -> str:
    return ".".join(path.relative_to(REPOSITORY).with_suffix("").parts)


def _render_class(node: ast.ClassDef, module: str) -> str:
    rows = []
    for index, item in enumerate(node.body):
        if isinstance(item, ast.AnnAssign) and isinstance(item.target, ast.Name) and not item.target.id.startswith("_"):
            rows.append(
                _format_row(item.target.id, ast.unparse(item.annotation), _read_attribute_docstring(node, index))
            )
        elif isinstance(item, ast.FunctionDef) and not item.name.startswith("_"):
            rows.append(_format_row(_format_signature(item, method=True), _format_return(item), _read_summary(item)))
    doc = _read_summary(node)
    return f"\n## `{node.name}` ({module})\n\n{doc}\n\n| name | type | |\n|---|---|---|\n{''.join(rows)}"


def _list_functions(module: ast.Module, *, of_model: bool) -> Iterator[str]:
    """Yield rows about the public functions; with ``of_model`` those whose first parameter is the model."""
    for node in module.body:
        if not isinstance(node, ast.FunctionDef) or node.name.startswith("_"):
            continue
        arguments = [*node.args.posonlyargs, *node.args.args]
        if of_model and (not arguments or arguments[0].arg != "model"):
            continue
        is_fact = any(isinstance(d, ast.Name) and d.id == "fact" for d in node.decorator_list)
        doc = ("**fact** " if is_fact else "") + _read_summary(node)
        yield _format_row(_format_signature(node, method=False), _format_return(node), doc)


def _format_signature(node: ast.FunctionDef, *, method: bool) -> str:
    """The name alone for a property, else the call with the names of its parameters."""
    decorators = {ast.unparse(d) for d in node.decorator_list}
    if decorators & {"property", "cached_property"}:
        return node.name
    arguments = [a.arg for a in (*node.args.posonlyargs, *node.args.args)][1 if method else 0 :]
    arguments += [f"{a.arg}=" for a in node.args.kwonlyargs]
    return f"{node.name}({', '.join(arguments)})"


def _format_return(node: ast.FunctionDef) -> str:
    return "" if node.returns is None else ast.unparse(node.returns)


def _read_attribute_docstring(node: ast.ClassDef, index: int) -> str:
    """The string literal under a field, in one line."""
    following = node.body[index + 1] if index + 1 < len(node.body) else None
    if (
        isinstance(following, ast.Expr)
        and isinstance(following.value, ast.Constant)
        and isinstance(following.value.value, str)
    ):
        return " ".join(following.value.value.split())
    return ""


def _read_summary(node: ast.Module | ast.ClassDef | ast.FunctionDef) -> str:
    """The first paragraph of a docstring, in one line."""
    doc = ast.get_docstring(node) or ""
    return " ".join(doc.split("\n\n")[0].replace("``", "`").split())


def _format_row(name: str, returns: str, doc: str) -> str:
    cells = (f"`{name}`", f"`{returns}`" if returns else "", doc)
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |\n"


if __name__ == "__main__":
    PAGE.parent.mkdir(exist_ok=True)
    PAGE.write_text(render_page(), encoding="utf-8", newline="\n")
