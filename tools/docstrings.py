"""Classes and functions of the package as rows of Markdown tables, from their docstrings."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parent.parent


def name_module(path: Path) -> str:
    """Return the name by which a file of the package is imported."""
    return ".".join(path.relative_to(REPOSITORY).with_suffix("").parts)


def render_class(node: ast.ClassDef, heading: str) -> str:
    """Return a section about a class: its summary, and its public fields, properties and methods."""
    rows = []
    for index, item in enumerate(node.body):
        if isinstance(item, ast.AnnAssign) and isinstance(item.target, ast.Name) and not item.target.id.startswith("_"):
            rows.append(
                _format_row(item.target.id, ast.unparse(item.annotation), _read_attribute_docstring(node, index))
            )
        elif isinstance(item, ast.FunctionDef) and not item.name.startswith("_"):
            rows.append(_format_row(_format_signature(item, method=True), _format_return(item), read_summary(item)))
    doc = read_summary(node)
    return f"\n## {heading}\n\n{doc}\n\n| name | type | meaning |\n|---|---|---|\n{''.join(rows)}"


def list_functions(module: ast.Module, *, of_model: bool) -> Iterator[str]:
    """Yield rows about the public functions; with ``of_model`` those whose first parameter is the model."""
    for node in module.body:
        if not isinstance(node, ast.FunctionDef) or node.name.startswith("_"):
            continue
        arguments = [*node.args.posonlyargs, *node.args.args]
        if of_model and (not arguments or arguments[0].arg != "model"):
            continue
        is_fact = any(isinstance(d, ast.Name) and d.id == "fact" for d in node.decorator_list)
        doc = ("**fact** " if is_fact else "") + read_summary(node)
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


def read_summary(node: ast.Module | ast.ClassDef | ast.FunctionDef) -> str:
    """The first paragraph of a docstring, in one line."""
    doc = ast.get_docstring(node) or ""
    return " ".join(doc.split("\n\n")[0].replace("``", "`").split())


def _format_row(name: str, returns: str, doc: str) -> str:
    cells = (f"`{name}`", f"`{returns}`" if returns else "", doc)
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |\n"
