"""The macro files that no checked model has read."""

from __future__ import annotations

from collections.abc import Sequence

from urdfcheck.output.html.html_text import escape_html
from urdfcheck.output.shared.wording import format_count

# Up to this many are listed at once.
MOST_OPEN = 5


def render_unused_macros(files: Sequence[str]) -> str:
    """Render the list of the files; empty where there is none."""
    if not files:
        return ""
    items = "".join(f"<li><code>{escape_html(file)}</code></li>" for file in files)
    title = "Macro files that no checked model uses: not checked"
    is_open = " open" if len(files) <= MOST_OPEN else ""
    folded = f"<details{is_open}><summary>{format_count(len(files), 'file')}</summary><ul>{items}</ul></details>"
    return f'<section class="failures unchecked"><h2>{title}</h2>{folded}</section>\n'
