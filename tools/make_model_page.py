"""Make docs/what-a-check-can-ask.md from the docstrings of the model: ``python tools/make_model_page.py``."""

from __future__ import annotations

import ast
from pathlib import Path

from docstrings import list_functions, name_module, read_summary, render_class

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
                parts.append(render_class(node, f"`{node.name}` ({name_module(PACKAGE / name)})"))
    parts.append("\n# Words, numbers and edits\n")
    for name in SHARED:
        module = ast.parse((PACKAGE / name).read_text(encoding="utf-8"))
        parts.append(_render_functions(PACKAGE / name, list(list_functions(module, of_model=False))))
    parts.append("\n# Functions of the model\n")
    for path in sorted((PACKAGE / "model").rglob("*.py")):
        rows = list(list_functions(ast.parse(path.read_text(encoding="utf-8")), of_model=True))
        if rows:
            parts.append(_render_functions(path, rows))
    return "".join(parts)


def _render_functions(path: Path, rows: list[str]) -> str:
    doc = read_summary(ast.parse(path.read_text(encoding="utf-8")))
    return f"\n## `{name_module(path)}`\n\n{doc}\n\n| function | returns | meaning |\n|---|---|---|\n{''.join(rows)}"


if __name__ == "__main__":
    PAGE.parent.mkdir(exist_ok=True)
    PAGE.write_text(render_page(), encoding="utf-8", newline="\n")
