"""A finding in a few lines: what is wrong, where, who minds, and the repair. ``--verbose`` tells the rest."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence

from rich.text import Text

from urdfcheck.core import Applicability, Finding, Run
from urdfcheck.output.shared.diffs import LineChange, list_line_changes
from urdfcheck.output.shared.escaping import escape_invisible, escape_one_line
from urdfcheck.output.shared.verdict.effects import ToldEffects, describe_hits
from urdfcheck.output.shared.wording import describe_models, format_count, get_base_name, join_first
from urdfcheck.output.text.change_lines import iter_change_lines
from urdfcheck.output.text.code_frame_lines import iter_code_frame
from urdfcheck.output.text.full_finding import FIX_OPTIONS
from urdfcheck.output.text.lines import STYLES, format_finding_title, wrap_text

_NAMED = re.compile(r"\w+\[([^\]]+)\]")
# Places and subjects that are named.
_MOST_PLACES, _MOST_SUBJECTS = 3, 3
# Lines that the repair in words may take, and the message where there is no code.
_MOST_WORDS = 2
# Lines of a finding, as far as changed lines decide.
_MOST_LINES = 8
# The options that show a fix.
_DIFF_OPTIONS = {Applicability.SAFE: "--diff", Applicability.UNSAFE: "--diff --unsafe-fixes"}
# Columns before the text of a line with a label.
_INDENT = 9


def iter_compact_finding(run: Run, finding: Finding, width: int, told: ToldEffects) -> Iterator[Text]:
    """Yield the lines of a finding. ``told``: what programs do was said of these rules, in these words; more is added."""
    head = [*wrap_text(format_finding_title(finding), width), _format_places(finding, width)]
    facts = list(_iter_facts(run, finding, width, told))
    changes = [] if finding.fix is None else list_line_changes(run.sources, finding.fix.edits)
    changed = list(iter_change_lines(finding, changes, indent=_INDENT, width=width, is_cut=True))
    code = list(_iter_code(run, finding, width))
    span = finding.location.span
    # A line before and after its repair shows the code too, but for the message behind the marks.
    shows_code = any(span is not None and c.file == span.file and c.line == span.line and c.old for c in changes)
    if shows_code and not any(finding.message in line.plain for line in code):
        code = [] if len(head) + len(facts) + 1 + len(changed) <= _MOST_LINES else code
    shows_changes = changes and len(head) + len(code) + len(facts) + 1 + len(changed) <= _MOST_LINES
    yield from (*head, *code, *facts)
    room = _MOST_LINES - len(head) - len(code) - len(facts) - bool(changes)
    yield from _iter_fix_lines(finding, width, most=1 if shows_changes else max(1, min(room, _MOST_WORDS)))
    if shows_changes:
        yield from changed
    elif changes:
        yield _format_change_count(finding, changes)
    yield Text()


def _iter_code(run: Run, finding: Finding, width: int) -> Iterator[Text]:
    """Yield the line of a finding with its marks; the message where no code shows what is meant."""
    span = finding.location.span
    if span is not None:
        label = escape_invisible(finding.message) if span.line == span.end_line else ""
        yield from iter_code_frame(
            run, span, style=STYLES[finding.severity], width=width, context=0, label=label, most_lines=1
        )
    if span is None or not run.sources.get(span.file):
        yield from _cut_lines(wrap_text(Text(escape_invisible(finding.message)), width, Text("  ")), _MOST_WORDS, width)


def _iter_facts(run: Run, finding: Finding, width: int, told: ToldEffects) -> Iterator[Text]:
    """Yield a line each: the models and arguments with the finding, the elements that it is about, and what programs do."""
    if models := describe_models(run, finding):
        yield _format_line("in", Text(escape_one_line(models)), width)
    if arguments := run.find_variant_arguments(finding):
        given = " ".join(f"{name}:={value}" for name, value in sorted(arguments.items()))
        yield _format_line("with", Text(escape_one_line(given)), width)
    others = _name_other_places(finding) if finding.occurrences else []
    if others and "(also " not in _format_places(finding, width).plain:  # a long path left no room
        yield _format_line("also", Text(join_first(others, _MOST_PLACES)), width)
    if len(names := _list_names(finding)) > 1:
        yield _format_line("for", Text(escape_one_line(join_first(names, _MOST_SUBJECTS))), width)
    hits = describe_hits(run, finding, width - _INDENT)
    if hits and (finding.code, hits) not in told:
        told.add((finding.code, hits))
        yield _format_line("hits", Text(escape_invisible(hits)), width)


def iter_brief_rules(findings: Sequence[Finding], width: int) -> Iterator[Text]:
    """Yield a line for each rule of these findings: the headline and place of the first, and how many more there are."""
    counts = Counter(finding.code for finding in findings)
    for code, count in counts.items():
        first = next(finding for finding in findings if finding.code == code)
        more = f" (+{count - 1} more)" if count > 1 else ""
        span = first.location.span
        place = "" if span is None else f"  {escape_one_line(get_base_name(span.file))}:{span.line}"
        line = Text(format_finding_title(first).plain, "cyan")
        line.truncate(max(width - len(more) - len(place), 20), overflow="ellipsis")
        yield Text.assemble(line, (more, "dim"), (place, "dim"))
    if findings:
        yield Text()


def _list_names(finding: Finding) -> list[str]:
    """Return the names of the links, joints and the like that a finding is about; ``link[arm]/inertial`` is about arm."""
    found = (_NAMED.match(subject) for subject in finding.subjects)
    return list(dict.fromkeys(match[1] for match in found if match is not None))


def _format_places(finding: Finding, width: int) -> Text:
    """Format the place of a finding and the first of those that belong to it; a path is never cut, so that terminals link it."""
    span = finding.location.span
    if span is None:
        return Text.assemble(("  --> ", "dim"), (finding.name, "dim"))
    line = Text.assemble(("  --> ", "dim"), (f"{escape_one_line(span.file)}:{span.line}:{span.col}", "bold"))
    if names := _name_other_places(finding):
        also = f"  (also {join_first(names, _MOST_PLACES)})"
        if line.cell_len + len(also) <= width:
            line.append(also, "dim")
    return line


def _name_other_places(finding: Finding) -> list[str]:
    """Return ``:225`` for each related place in the file of a finding, and ``arm.xacro:12`` for the others."""
    here = finding.location.file
    others = [place.span for place in finding.related if place.span is not None]
    names = (f":{o.line}" if o.file == here else f"{escape_one_line(get_base_name(o.file))}:{o.line}" for o in others)
    return list(dict.fromkeys(names))


def _format_line(label: str, text: Text, width: int) -> Text:
    line = Text.assemble("  ", (f"= {label:<5}", "dim"), text)
    line.truncate(width, overflow="ellipsis")
    return line


def _cut_lines(lines: Iterable[Text], most: int, width: int) -> list[Text]:
    """Return the first lines, the last of them with an ellipsis where more follow."""
    all_lines = list(lines)
    kept = all_lines[:most]
    if len(kept) < len(all_lines):
        kept[-1].truncate(width - 2)
        kept[-1].rstrip()
        kept[-1].append(" …", "dim")
    return kept


def _iter_fix_lines(finding: Finding, width: int, *, most: int) -> Iterator[Text]:
    """Yield the repair in words, in at most so many lines, the option that makes it behind them."""
    fix = finding.fix
    if fix is None:
        return
    how = FIX_OPTIONS.get(fix.applicability) if fix.edits and finding.suppressed is None else None
    option = f" [{how}]" if how else ""
    lead = Text.assemble("  ", ("= fix  ", "dim"))
    lines = _cut_lines(wrap_text(Text(escape_invisible(fix.title)), width, lead), most, width)
    if lines[-1].cell_len + len(option) > width:
        lines[-1].truncate(width - len(option) - 1, overflow="ellipsis")
    lines[-1].append(option, "dim")
    yield from lines


def _format_change_count(finding: Finding, changes: Sequence[LineChange]) -> Text:
    option = None if finding.fix is None else _DIFF_OPTIONS.get(finding.fix.applicability)
    shown = f"; {option} shows them" if option and finding.suppressed is None else ""
    return Text.assemble(" " * _INDENT, (f"{format_count(len(changes), 'line')} would change{shown}", "dim"))
