"""Lines of the text report: wrapping, headings and titles."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, cast

from rich.style import Style
from rich.text import Text

from urdfcheck.core import Finding, ModelInfo, Run, Severity, Span
from urdfcheck.output.shared.code_frames import extract_code_frame
from urdfcheck.output.shared.escaping import escape_invisible, escape_one_line
from urdfcheck.output.shared.rule_page import find_rule_address
from urdfcheck.output.shared.verdict.not_checked import describe_status
from urdfcheck.output.shared.wording import GLYPHS, format_count

if TYPE_CHECKING:
    from rich.console import Console

STYLES = {Severity.ERROR: "bold red", Severity.WARNING: "bold yellow", Severity.INFO: "bold cyan"}
EMPTY_TEXT = Text()


def wrap_text(text: Text, width: int, lead: Text = EMPTY_TEXT) -> Iterator[Text]:
    """Wrap the text into lines of this width; the first begins with ``lead``, the others with as many blanks."""
    # Only justified text needs a console, and loading one is slower than rendering most reports.
    for line in text.wrap(cast("Console", None), max(width - len(lead), 1)):
        yield lead + line
        lead = Text(" " * len(lead))


def wrap_labelled(label: str, text: str | Text, width: int) -> Iterator[Text]:
    """Wrap ``label: text``, with the further lines of the text below its first."""
    shown = Text(text) if isinstance(text, str) else text
    return wrap_text(shown, width, Text.assemble("  ", (label.ljust(6), "dim")))


def format_separator(title: Text, width: int) -> Text:
    """Format a line across the page that begins with this title."""
    title.plain = title.plain.replace("\n", " ")
    title.expand_tabs(8)
    title.truncate(max(width - 2, 0), overflow="ellipsis")
    return Text.assemble(title, " ", ("─" * (width - title.cell_len - 1), "dim"))


def format_model_heading(info: ModelInfo | None, model: str, width: int) -> Text:
    """Format the name of the model, and as many facts about it as fit into the line."""
    title = Text(escape_one_line(model) or "this run", style="bold")
    facts: list[str] = []
    if info is not None and info.status == "checked":
        facts = [
            f"robot {escape_one_line(info.robot)}",
            format_count(info.links, "link"),
            format_count(info.joints, "joint"),
        ]
        if info.mass is not None:
            facts.append(f"{info.mass:.4g} kg")
    elif info is not None:
        facts = [describe_status(info)]
    lead = "  "
    for fact in facts:
        addition = Text(lead + fact, style="dim")
        if title.cell_len + addition.cell_len > width - 2:  # a truncated number would be wrong
            break
        title.append_text(addition)
        lead = " · "
    return title


def format_finding_title(finding: Finding) -> Text:
    """Format the title of a finding: its sign, its rule and its headline, which fit into 80 columns."""
    head = Text(f"{GLYPHS[finding.severity]} ", STYLES[finding.severity])
    head.append(finding.code, Style(bold=True, link=find_rule_address(finding.code) or None))
    return head.append(f" {escape_invisible(finding.headline)}", "bold")


def format_remainder(count: int, noun: str) -> str:
    return f"… and {count} more {noun}{'' if count == 1 else 's'}"


def get_first_line(run: Run, span: Span) -> str:
    lines = extract_code_frame(run.sources.get(span.file, ""), span, context=0)
    return escape_invisible(lines[0].text.strip()) if lines else ""
