"""The macro files that no checked model has read."""

from __future__ import annotations

from collections.abc import Sequence

from urdfcheck.output.html.html_text import escape_html


def render_unused_macros(files: Sequence[str]) -> str:
    """Render the list of the files; empty where there is none."""
    if not files:
        return ""
    items = "".join(f"<li><code>{escape_html(file)}</code></li>" for file in files)
    title = "Macro files that no model uses: not checked"
    return (
        f'<section class="failures unchecked"><h2>{title}</h2><details><summary>{len(files)} files</summary>'
        f"<ul>{items}</ul></details></section>\n"
    )
