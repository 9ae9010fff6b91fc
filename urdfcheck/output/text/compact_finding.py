"""A finding in a few lines: what is wrong, where, who minds, and the repair. ``--verbose`` tells the rest."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence

from rich.cells import cell_len
from rich.text import Text

from urdfcheck.core import Applicability, Finding, Run, Severity, Span
from urdfcheck.core.headlines import cut_line, cut_middle
from urdfcheck.core.text import join_names
from urdfcheck.output.shared.diffs import LineChange, list_line_changes
from urdfcheck.output.shared.escaping import escape_invisible, escape_one_line
from urdfcheck.output.shared.verdict.effects import ToldEffects, describe_hits
from urdfcheck.output.shared.wording import describe_models, format_count, get_base_name
from urdfcheck.output.text.change_lines import iter_change_lines
from urdfcheck.output.text.code_frame_lines import crop_to_window, iter_code_frame
from urdfcheck.output.text.fix_words import refer_to_change, wrap_words
from urdfcheck.output.text.full_finding import FIX_OPTIONS
from urdfcheck.output.text.lines import STYLES, format_finding_title, get_first_line, wrap_text

_NAMED = re.compile(r"(?!gazebo\[\d+\])\w+\[([^\]]+)\]")  # the number of a <gazebo> element would be taken for a line
# Places and subjects that are named.
_MOST_PLACES, _MOST_SUBJECTS = 3, 3
# Lines that the repair in words may take, and the message where there is no code.
_MOST_WORDS, _MOST_MESSAGE = 4, 2
# Lines of a finding, as far as changed lines decide.
_MOST_LINES = 8
# Characters of an element that are searched for the end of its tag.
_LONGEST_TAG = 2000
# The options that show a fix.
_DIFF_OPTIONS = {Applicability.SAFE: "--diff", Applicability.UNSAFE: "--diff --unsafe-fixes"}
# A message behind the marks says nothing new if it has a larger part of the words of the headline.
_SAME_WORDS = 0.6
_WORD = re.compile(r"[\w.-]+")
# Lines of what programs do.
_MOST_EFFECT = 2
# Columns before the text of a line with a label.
_INDENT = 11


def iter_compact_finding(run: Run, finding: Finding, width: int, told: ToldEffects) -> Iterator[Text]:
    """Yield the lines of a finding. ``told``: what programs do was said of these rules, in these words; more is added."""
    head = [*wrap_text(format_finding_title(finding), width), _format_places(finding, width)]
    facts = list(_iter_facts(run, finding, width, told))
    changes = [] if finding.fix is None else list_line_changes(run.sources, finding.fix.edits)
    changed = list(iter_change_lines(finding, changes, indent=_INDENT, width=width))
    code = list(_iter_code(run, finding, width))
    span = finding.location.span
    # A line before and after its repair shows the code too, but for the message behind the marks.
    shows_code = any(span is not None and c.file == span.file and c.line == span.line and c.old for c in changes)
    if shows_code and not any(finding.message in line.plain for line in code):
        code = [] if len(head) + len(facts) + 1 + len(changed) <= _MOST_LINES else code
    room = _MOST_LINES - len(head) - len(code) - len(facts)
    shown = changes if len(changed) < room and _fits(changed, width) else []
    repair = changed if shown else []
    if room - len(repair) < len(_wrap_fix(finding, changes, shown, width, most=_MOST_WORDS)) and _marks_all(code):
        code, room = code[:1], room + 1  # marks below all of a line say nothing
    words = _wrap_fix(finding, changes, shown, width, most=max(1, min(room - len(repair), _MOST_WORDS)))
    yield from (*head, *_unfold(run, finding, code, width), *facts, *words, *repair)
    yield Text()


def _fits(lines: Iterable[Text], width: int) -> bool:
    return all(line.cell_len <= width for line in lines)


def _marks_all(code: Sequence[Text]) -> bool:
    """Whether code is a line with marks below all of it."""
    if len(code) != 2:
        return False
    line, marks = (text.plain.partition("│ ")[2] for text in code)
    return len(line.strip()) == len(marks.strip()) == marks.count("^")


def _unfold(run: Run, finding: Finding, code: list[Text], width: int) -> list[Text]:
    """Return a line that is cut in two, in place of marks below all of it; else the code as it is."""
    span = finding.location.span
    if span is None or not _marks_all(code) or not code[0].plain.endswith("…"):
        return code
    text = escape_invisible(_join_tag(run, span)) or get_first_line(run, span)
    margins = ["".join(line.plain.partition("│ ")[:2]) for line in code]
    halves = list(wrap_text(Text(text), width - len(margins[0]) - 2)) if len(text) < 2 * width else []
    if len(halves) != 2:
        return code
    return [
        Text.assemble((margin, "dim"), indent, half)
        for margin, indent, half in zip(margins, ("", "  "), halves, strict=True)
    ]


def _iter_code(run: Run, finding: Finding, width: int) -> Iterator[Text]:
    """Yield the line of a finding with its marks; the message where no code shows what is meant."""
    span = finding.location.span
    if span is not None and (tag := _join_tag(run, span)):
        yield from _iter_tag_lines(finding, span.line, tag, width)
    elif span is not None:
        is_label = span.line == span.end_line and not _repeats(finding.message, finding.headline)
        label = escape_invisible(finding.message) if is_label else ""
        yield from iter_code_frame(
            run, span, style=STYLES[finding.severity], width=width, context=0, label=label, most_lines=1
        )
    if span is None or not run.sources.get(span.file):
        yield from _cut_lines(
            wrap_text(Text(escape_invisible(finding.message)), width, Text("  ")), _MOST_MESSAGE, width
        )


def _repeats(message: str, headline: str) -> bool:
    """Whether a message has most words of a headline, which stands above it."""
    said, words = (set(_WORD.findall(text.lower())) for text in (message, headline))
    return len(words & said) > _SAME_WORDS * len(words)


def _join_tag(run: Run, span: Span) -> str:
    """Return the opening tag of an element whose attributes are in several lines, in one; else nothing."""
    typed = run.sources.get(span.file, "")[span.start : span.end][:_LONGEST_TAG]
    tag = typed[: typed.find(">") + 1] if typed.startswith("<") else ""
    return re.sub(r"\s+(?=/?>$)", "", " ".join(tag.split())) if "\n" in tag else ""


def _iter_tag_lines(finding: Finding, number: int, tag: str, width: int) -> Iterator[Text]:
    margin = f"  {number} │ "
    text = escape_invisible(tag)
    shown, _ = crop_to_window(text, 0, len(text), room=max(width - len(margin) - 1, 2))
    yield Text.assemble((margin, "dim"), shown)
    marks = "^" * max(cell_len(shown), 1)
    yield Text.assemble((f"  {' ' * len(str(number))} │ ", "dim"), (marks, STYLES[finding.severity]))


def _iter_facts(run: Run, finding: Finding, width: int, told: ToldEffects) -> Iterator[Text]:
    """Yield a line each: the models and arguments with the finding, the elements that it is about, and what programs do."""
    if models := describe_models(run, finding):
        yield _format_line("in", Text(escape_one_line(models)), width)
    if arguments := run.find_variant_arguments(finding):
        given = " ".join(f"{name}:={value}" for name, value in sorted(arguments.items()))
        yield _format_line("with", Text(escape_one_line(given)), width)
    others = _name_other_places(finding) if finding.occurrences else []
    is_long = bool(others) and "(also " not in _format_places(finding, width).plain  # a long path left no room
    also = _join_fitting(others, "place", width - _INDENT) if is_long else ""
    names = _list_names(finding)
    rest = [name for name in names if not _is_named(name, finding.headline)]
    if len(names) > 1 and rest:
        label, names = ("and", rest) if len(rest) < len(names) else ("for", names)
        named = _join_fitting(names, "", width - _INDENT)
        both = _join_names_and_places(names, others, width - _INDENT) if also else ""
        named, also = (both, "") if both else (named, also)
        yield _format_line(label, Text(named), width)
    if also:
        yield _format_line("also", Text(also), width)
    effect = describe_hits(run, finding, width - _INDENT)
    if effect and (finding.severity is Severity.ERROR or (finding.code, effect) not in told):
        told.add((finding.code, effect))
        lead = Text.assemble("  ", (f"= {'effect':<{_INDENT - 4}}", "dim"))
        yield from wrap_words(escape_one_line(effect), width, lead, _MOST_EFFECT, "")


def iter_brief_rules(findings: Sequence[Finding], width: int) -> Iterator[Text]:
    """Yield a line for each rule of these findings: the headline and place of the first, and how many more there are."""
    counts = Counter(finding.code for finding in findings)
    for code, count in counts.items():
        first = next(finding for finding in findings if finding.code == code)
        more = f" (+{count - 1} more)" if count > 1 else ""
        span = first.location.span
        # Each line names its file, the end of which matters most; the headline makes room.
        file = "" if span is None else cut_middle(escape_one_line(get_base_name(span.file)), max(width // 2, 10))
        place = "" if span is None else f"  {file}:{span.line}"
        title = format_finding_title(first).plain
        line = Text(cut_line(title, max(width - len(more) - len(place), 20)), "cyan")
        yield Text.assemble(line, (more, "dim"), (place, "dim"))
    if findings:
        yield Text()


def _list_names(finding: Finding) -> list[str]:
    """Return the names of the links, joints and the like that a finding is about; ``link[arm]/inertial`` is about arm."""
    found = (_NAMED.match(subject) for subject in finding.subjects)
    return list(dict.fromkeys(match[1] for match in found if match is not None))


def _is_named(name: str, headline: str) -> bool:
    return re.search(rf"(?<![\w/-]){re.escape(name)}(?![\w/-])", headline) is not None


def _join_fitting(names: Sequence[str], noun: str, width: int) -> str:
    """Join as many names as fit, at most three, and count the others."""
    joined = (escape_one_line(_join_some(names, most, noun)) for most in range(_MOST_SUBJECTS, 1, -1))
    return next((line for line in joined if len(line) <= width), escape_one_line(_join_some(names, 1, noun)))


def _join_names_and_places(names: Sequence[str], places: Sequence[str], width: int) -> str:
    """Join names, and behind them places, as many as fit: ``a, b  (also :12, :14)``; nothing if one of each does not fit."""
    for most in range(_MOST_SUBJECTS, 0, -1):
        line = f"{_join_some(names, most, '')}  (also {_join_some(places, most, 'place')})"
        if len(escape_one_line(line)) <= width:
            return escape_one_line(line)
    return ""


def _join_some(names: Sequence[str], most: int, noun: str) -> str:
    """Join the first names and say how many more there are, and of what: ``:12, :14 and 3 more places``."""
    rest = len(names) - most
    ending = f" {noun}{'' if rest == 1 else 's'}" if noun and rest > 0 else ""
    return f"{join_names(names, most)}{ending}"


def _format_places(finding: Finding, width: int) -> Text:
    """Format the place of a finding and the first of those that belong to it; a path is never cut, so that terminals link it."""
    span = finding.location.span
    if span is None:
        return Text.assemble(("  --> ", "dim"), (finding.name, "dim"))
    line = Text.assemble(("  --> ", "dim"), (f"{escape_one_line(span.file)}:{span.line}:{span.col}", "bold"))
    if names := _name_other_places(finding):
        also = f"  (also {_join_some(names, _MOST_PLACES, 'place')})"
        if line.cell_len + len(also) <= width:
            line.append(also, "dim")
    return line


def _name_other_places(finding: Finding) -> list[str]:
    """Return ``:225`` for each related place in the file of a finding, and ``arm.xacro:12`` for the others."""
    span = finding.location.span
    here, line = finding.location.file, span.line if span is not None else 0
    others = [o for place in finding.related if (o := place.span) is not None and (o.file, o.line) != (here, line)]
    names = (f":{o.line}" if o.file == here else f"{escape_one_line(get_base_name(o.file))}:{o.line}" for o in others)
    return list(dict.fromkeys(names))


def _format_line(label: str, text: Text, width: int) -> Text:
    line = Text.assemble("  ", (f"= {label:<{_INDENT - 4}}", "dim"), text)
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


def _wrap_fix(
    finding: Finding, changes: Sequence[LineChange], shown: Sequence[LineChange], width: int, *, most: int
) -> list[Text]:
    """Wrap the repair in words into at most so many lines, and end it with the option that does or shows it.

    What the changed lines ``shown`` below it say is left out.
    """
    if finding.fix is None:
        return []
    words = escape_invisible(finding.fix.title)
    if shown:
        words = refer_to_change(words, shown)
    lead = Text.assemble("  ", (f"= {'fix':<{_INDENT - 4}}", "dim"))
    return wrap_words(words, width, lead, most, _name_option(finding, changes, shown))


def _name_option(finding: Finding, changes: Sequence[LineChange], shown: Sequence[LineChange]) -> str:
    """Name the option that applies a repair, or the one that shows it where neither its words nor lines below them do."""
    fix = finding.fix
    if fix is None or not fix.edits or finding.suppressed is not None or fix.applicability not in FIX_OPTIONS:
        return ""
    if shown or all(_spells(fix.title, change) for change in changes):
        return f"[{FIX_OPTIONS[fix.applicability]}]"
    return f"[{format_count(len(changes), 'line')}: {_DIFF_OPTIONS[fix.applicability]}]"


def _spells(words: str, change: LineChange) -> bool:
    """Whether words of a repair give all that a change writes."""
    return all(text in words for text, is_changed in change.new if is_changed)
