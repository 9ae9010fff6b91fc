"""The index page of many models: numbers, a table of the rules, and a row for each model.

It is written piece by piece, so that memory holds one row at a time. Its script sorts and filters; without it the page has the
same content.
"""

from __future__ import annotations

import base64
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from types import MappingProxyType

from urdfcheck.core import Rule, Run, Severity
from urdfcheck.output.html.file_groups import LAUNCH_FILE, classify_file
from urdfcheck.output.html.glyphs import SYMBOLS, pluralize_severity, render_glyph
from urdfcheck.output.html.html_text import (
    NO_VALUE,
    escape_html,
    format_number,
    format_whole_number,
    list_acceptors,
    render_prose,
)
from urdfcheck.output.html.page_frame import read_asset, read_index_script, read_style_sheet, render_document_head
from urdfcheck.output.html.report_parts import ReportPart
from urdfcheck.output.html.rule_markdown import render_inline
from urdfcheck.output.html.sections.page_header import render_command
from urdfcheck.output.html.sections.unused_macros import render_unused_macros
from urdfcheck.output.shared.audit.unit_lines import AuditSummary, RuleCount, UnitRow, build_unit_line, parse_unit_line
from urdfcheck.output.shared.escaping import escape_for_html
from urdfcheck.output.shared.robot_picture import render_scene
from urdfcheck.output.shared.verdict.losses import Losses, describe_losses
from urdfcheck.output.shared.verdict.not_checked import STATUS_WORDS
from urdfcheck.output.shared.wording import SEVERITY_ORDER, get_base_name

# Rules named in a model's row; the filter finds all of them.
MOST_CODES = 6
# Rows of the table of the worst models, which only an audit of more models has.
MOST_WORST = 10
# Width and height in px of a picture; the style shows it at half the size, for screens with fine pixels.
THUMBNAIL_SIZE = (160, 120)
# More pictures would make the page slow to open.
MOST_THUMBNAILS = 300
_SENTENCE = re.compile(r".{40,}?[.:](?=\s+[A-Z])", re.DOTALL)
_NO_LOSSES = Losses()
_KINDS = (("model", "Models"), ("launch", "Launch files"), ("package", "Packages"))


def iter_audit_page(
    summary: AuditSummary,
    rows: Iterable[UnitRow],
    *,
    rules: Mapping[str, Rule],
    version: str,
    links: Mapping[str, str] = MappingProxyType({}),
    thumbnails: Mapping[str, bytes] = MappingProxyType({}),
    unused_macro_files: Sequence[str] = (),
    losses: Losses = _NO_LOSSES,
) -> Iterator[str]:
    """Yield the document in pieces of whole lines, which are the same for equal summaries and rows.

    ``links``: the files with the pages about single units, by the id of the unit; ``thumbnails``: their pictures, as PNG;
    ``losses``: what programs lose of the models, where that is known."""
    pieces = _iter_page_pieces(
        summary,
        rows,
        rules=rules,
        version=version,
        links=links,
        thumbnails=thumbnails,
        unused_macro_files=unused_macro_files,
        losses=losses,
    )
    return map(escape_for_html, pieces)


def render_run_index(run: Run, parts: Sequence[ReportPart], file_names: Sequence[str]) -> str:
    """Render the index of the parts of a run, which have pages of these names."""
    run_row = parse_unit_line(build_unit_line("run", "", "", failures=run.failures))
    rows = [*(_build_unit_row(run, part) for part in parts), run_row]
    links = {_identify_part(part): name for part, name in zip(parts, file_names, strict=True)}
    drawn = [part for part in parts if part.scene is not None][:MOST_THUMBNAILS]
    pictures = {_identify_part(part): render_scene(part.scene, *THUMBNAIL_SIZE) for part in drawn if part.scene}
    version = run.versions.get("urdfcheck", "")
    page = iter_audit_page(
        AuditSummary.from_rows(rows),
        rows,
        rules=run.rules,
        version=version,
        links=links,
        thumbnails=pictures,
        unused_macro_files=run.unused_macro_files,
        losses=describe_losses(run),
    )
    return "".join(page)


def _build_unit_row(run: Run, part: ReportPart) -> UnitRow:
    name = _identify_part(part)
    findings = [card.finding for card in part.all_cards]
    skipped = [skip for skip in run.skipped if skip.model == name]
    line = build_unit_line(_classify_part(part), name, part.path, info=part.info, findings=findings, skipped=skipped)
    return parse_unit_line(line)


def _classify_part(part: ReportPart) -> str:
    if part.info:
        return "model"
    if classify_file(part.path, "") == LAUNCH_FILE:
        return "launch"
    return "package" if part.path else "other"


def _identify_part(part: ReportPart) -> str:
    return part.info.id if part.info else part.path or part.title


def _iter_page_pieces(
    summary: AuditSummary,
    rows: Iterable[UnitRow],
    *,
    rules: Mapping[str, Rule],
    version: str,
    links: Mapping[str, str],
    thumbnails: Mapping[str, bytes],
    unused_macro_files: Sequence[str],
    losses: Losses,
) -> Iterator[str]:
    title = f"{format_whole_number(summary.kinds['model'])} model{'' if summary.kinds['model'] == 1 else 's'}"
    style, script = read_style_sheet() + read_asset("index.css"), read_index_script()
    notices = _render_failures(summary) + _render_unchecked(summary, links)
    yield f"""{render_document_head(title, style, [script])}<body class="index">
{SYMBOLS}
<a class="skip" href="#models">Skip to the models</a>
{_render_header(summary, title, version, losses)}
<div class="page">
<main id="content">
{notices}{_render_worst_models(summary, links, thumbnails)}
"""
    # With pages to open, the models come first; an audit of thousands of models begins with what they have in common.
    if not links:
        yield _render_rules_table(summary, rules)
    yield from _iter_models_table(summary, rows, links, thumbnails)
    if links:
        yield _render_rules_table(summary, rules)
    yield render_unused_macros(unused_macro_files)
    yield f'</main>\n</div>\n<p id="said" class="sr" role="status"></p><script>{script}</script>\n</body>\n</html>\n'


# -- head --------------------------------------------------------------------------------------------------------------


def _render_header(summary: AuditSummary, title: str, version: str, losses: Losses) -> str:
    kind, verdict = _summarize_verdict(summary)
    if kind == "ok" and losses.is_any:
        kind = "warning" if summary.counts[Severity.WARNING] else "info"
    verdict += f" · {losses.by_others}" if losses.by_others else ""
    tiles = "".join(_render_severity_tile(severity, summary.counts[severity]) for severity in SEVERITY_ORDER)
    facts = [(name, format_whole_number(summary.kinds[kind])) for kind, name in _KINDS if summary.kinds[kind]]
    checked = summary.statuses["checked"]
    counts = (("Checked", checked), ("Not checked", summary.kinds["model"] - checked))
    facts += [(name, format_whole_number(count)) for name, count in counts if count]
    if known := summary.suppressed.total():
        facts.append(("Known findings", f"{format_whole_number(known)}: {list_acceptors(summary.suppressed)}"))
    return (
        f'<header class="top"><p class="brand">urdfcheck <span>{escape_html(version)}</span></p>'
        f'<h1>{title}</h1><p class="verdict {kind}">{render_glyph(kind)} {verdict}</p>'
        f'<ul class="tiles" aria-label="Findings by severity">{tiles}</ul><dl class="facts">'
        + "".join(f"<div><dt>{name}</dt><dd>{value}</dd></div>" for name, value in facts)
        + "</dl></header>"
    )


def _render_severity_tile(severity: Severity, count: int) -> str:
    return (
        f'<li class="tile {severity}{"" if count else " none"}">{render_glyph(severity)} '
        f"<b>{format_whole_number(count)}</b> {pluralize_severity(count, severity)}</li>"
    )


def _summarize_verdict(summary: AuditSummary) -> tuple[str, str]:
    """Return the verdict on an audit: error | unchecked | warning | ok, and a sentence without its full stop."""
    unread, models = summary.kinds["model"] - summary.statuses["checked"], summary.kinds["model"]
    of_models = f"of {format_whole_number(models)} model{'' if models == 1 else 's'}"
    if summary.failure_count:
        failures = f"{format_whole_number(summary.failure_count)} failure{'' if summary.failure_count == 1 else 's'}"
        return "error", f"Not finished: {failures}, so this verdict is incomplete"
    errors, warnings = summary.counts[Severity.ERROR], summary.counts[Severity.WARNING]
    if errors:
        kind, sentence = "error", f"{format_whole_number(errors)} {pluralize_severity(errors, Severity.ERROR)}"
        if summary.models_with_errors:
            sentence += f" in {format_whole_number(summary.models_with_errors)} {of_models}"
    elif warnings:
        kind = "ok"
        sentence = f"No errors, {format_whole_number(warnings)} {pluralize_severity(warnings, Severity.WARNING)}"
    else:
        kind, sentence = "ok", "No errors and no warnings"
    if not unread:
        return kind, sentence
    were = "was" if unread == 1 else "were"
    return "unchecked", f"{format_whole_number(unread)} {of_models} {were} not checked. {sentence}"


def _render_failures(summary: AuditSummary) -> str:
    if not summary.failure_count:
        return ""
    items = [escape_html(failure) for failure in summary.failures]
    items += [f"and {format_whole_number(rest)} more"] if (rest := summary.failure_count - len(items)) else []
    return _render_notice_box("What failed", items)


def _render_unchecked(summary: AuditSummary, links: Mapping[str, str]) -> str:
    total = summary.kinds["model"] - summary.statuses["checked"]
    if not total:
        return ""
    items = [_render_unchecked_row(row, links) for row in summary.unchecked]
    items += [f"and {format_whole_number(rest)} more"] if (rest := total - len(items)) > 0 else []
    return _render_notice_box("What was not checked", items)


def _render_unchecked_row(row: UnitRow, links: Mapping[str, str]) -> str:
    reason = f": {render_prose(row.reason)}" if row.reason else f": {_describe_row_status(row)}"
    accepted = " (accepted)" if row.accepted else ""
    name = f"<code>{escape_html(_name_from_here(row))}</code>"
    if row.id in links:
        name = f'<a href="{escape_html(links[row.id])}">{name}</a>'
    return f"{name}{accepted}{reason}{render_command(row.command)}"


def _render_notice_box(title: str, items: Iterable[str]) -> str:
    return f'<section class="failures"><h2>{title}</h2><ul>{"".join(f"<li>{i}</li>" for i in items)}</ul></section>\n'


# -- tables ------------------------------------------------------------------------------------------------------------


def _render_worst_models(summary: AuditSummary, links: Mapping[str, str], thumbnails: Mapping[str, bytes]) -> str:
    if len(summary.worst) < 2 or summary.unit_count <= MOST_WORST:
        return ""
    rows = (_render_model_row(row, links, thumbnails) for row in summary.worst[:MOST_WORST])
    return "".join(_iter_table("worst", "Worst models", head=_MODEL_HEAD, rows=rows))


def _render_rules_table(summary: AuditSummary, rules: Mapping[str, Rule]) -> str:
    if not summary.rules:
        return ""
    rows = (_render_rule_row(rules[code], count) for code, count in summary.rank_rules() if code in rules)
    return "".join(_iter_table("rules", "Rules", head=_RULE_HEAD, rows=rows, css_class="sortable"))


def _render_rule_row(rule: Rule, count: RuleCount) -> str:
    severity = count.severity
    code = escape_html(rule.code)
    summary = render_inline(_extract_first_sentence(rule.summary))
    return (
        f'<tr class="{severity}"><th scope="row"><a href="#models" data-find="{code}"><code>{code}</code></a> '
        f"{escape_html(rule.name)}</th>"
        f'<td class="mark" data-v="{int(severity)}">{render_glyph(severity)} {severity}</td>'
        f"{_render_count_cell(count.findings)}{_render_count_cell(count.units)}<td>{summary}</td></tr>\n"
    )


def _extract_first_sentence(text: str) -> str:
    """Return the first sentence if it is long enough to stand alone, else the whole text."""
    return text[: match.end()].rstrip() if (match := _SENTENCE.match(text)) else text


def _iter_models_table(
    summary: AuditSummary, rows: Iterable[UnitRow], links: Mapping[str, str], thumbnails: Mapping[str, bytes]
) -> Iterator[str]:
    statuses = "".join(
        f'<option value="{escape_html(status)}">{escape_html(STATUS_WORDS.get(status, status))}</option>'
        for status in sorted(summary.statuses)
    )
    tools = (
        '<div class="tools" hidden><label>Find <input type="search" id="find" placeholder="name, path or rule"></label>'
        f'<label>Status <select id="status"><option value="">all</option>{statuses}</select></label>'
        '<p role="status" id="shown"></p></div>'
    )
    if not links:
        tools += "<p>The report of one model: <code>urdfcheck PATH -o html=report.html</code></p>"
    shown = (_render_model_row(row, links, thumbnails) for row in rows if row.kind != "run")
    yield from _iter_table("models", "Models", head=_MODEL_HEAD, rows=shown, css_class="sortable", tools=tools)


def _render_model_row(row: UnitRow, links: Mapping[str, str], thumbnails: Mapping[str, bytes]) -> str:
    worst = "unchecked" if row.is_unchecked else str(row.worst or ("info" if row.is_set_aside else "ok"))
    codes = " ".join(
        f'<span class="{severity}">{escape_html(code)}{f" <small>×{format_whole_number(n)}</small>" if n > 1 else ""}</span>'
        for code, severity, n in row.codes[:MOST_CODES]
    )
    rest = len(row.codes) - MOST_CODES
    hidden = f' data-codes="{escape_html(" ".join(code for code, _, _ in row.codes[MOST_CODES:]))}"' if rest > 0 else ""
    more = f" <small>and {rest} more</small>" if rest > 0 else ""
    name = f"<code>{escape_html(row.id).replace('/', '/<wbr>')}</code>"
    robot = f" <small>{escape_html(row.robot)}</small>" if row.robot else ""
    if row.id in links:
        title = escape_html(row.robot or get_base_name(row.path) or row.id)
        name = f'<a class="to-page" href="{escape_html(links[row.id])}">{title}</a>'
        robot = f" <small><code>{escape_html(_name_from_here(row)).replace('/', '/<wbr>')}</code></small>"
    if picture := _render_thumbnail(thumbnails.get(row.id, b"")):
        name, robot = f'<div class="pictured">{picture}<div>{name}{robot}</div></div>', ""
    counts = "".join(_render_count_cell(n, str(s)) for s, n in zip(SEVERITY_ORDER, row.counts, strict=True))
    sign = f"{render_glyph('unchecked')} not checked: " if row.is_unchecked else ""
    # The page's script makes the command of it.
    path = f' data-path="{escape_html(row.path)}"' if not links and row.kind == "model" else ""
    is_known = row.kind == "model" and not row.is_unchecked
    size = _render_count_cell(row.links) if is_known else f'<td class="num" data-v="-1">{NO_VALUE}</td>'
    return (
        f'<tr class="{worst}" data-status="{escape_html(row.status)}"{hidden}{path}><th scope="row">{name}{robot}</th>'
        f'{counts}<td class="codes">{codes}{more}</td><td>{sign}{_describe_row_status(row)}</td>{size}'
        f'<td class="num" data-v="{-1 if row.mass is None else row.mass!r}">{format_number(row.mass)}</td></tr>\n'
    )


def _name_from_here(row: UnitRow) -> str:
    """Return the path of a unit as its page has it, and the arguments that its id has after the path from the root."""
    return f"{row.path}{row.id.partition(row.path)[2]}" if row.path else row.id


def _describe_row_status(row: UnitRow) -> str:
    """Render the status of a unit; what it is, if it is no model."""
    words = escape_html(STATUS_WORDS.get(row.status, row.status))
    if row.kind != "model":
        words = row.kind if row.status == "checked" else f"{row.kind}, {words}"
    return f"{words}{' (accepted)' if row.accepted else ''}{', set aside' if row.is_set_aside else ''}"


def _render_thumbnail(picture: bytes) -> str:
    """Render the picture of a robot, whose name is beside it; empty without one."""
    if not picture:
        return ""
    width, height = THUMBNAIL_SIZE
    source = f"data:image/png;base64,{base64.b64encode(picture).decode()}"
    return f'<img class="thumbnail" width="{width // 2}" height="{height // 2}" alt="" loading="lazy" src="{source}">'


def _render_count_cell(value: int, severity: str = "") -> str:
    tone = f" {severity}" if severity and value else ""
    return f'<td class="num{tone}" data-v="{value}">{format_whole_number(value) if value else "0"}</td>'


def _render_table_head(columns: Mapping[str, str]) -> str:
    """Render the head of a table; ``columns``: the class of each column by its title."""
    cells = "".join(
        f'<th scope="col"{f" class={css_class}" if css_class else ""}>{title}</th>'
        for title, css_class in columns.items()
    )
    return f"<tr>{cells}</tr>"


_RULE_HEAD = _render_table_head({"Rule": "", "Severity": "", "Findings": "num", "Models": "num", "What it checks": ""})
_MODEL_HEAD = _render_table_head(
    {
        "Model": "",
        "Errors": "num",
        "Warnings": "num",
        "Notes": "num",
        "Rules": "",
        "Status": "",
        "Links": "num",
        "Mass <small>kg</small>": "num",
    }
)


def _iter_table(
    name: str, title: str, *, head: str, rows: Iterable[str], css_class: str = "", tools: str = ""
) -> Iterator[str]:
    yield (
        f'<section id="{name}"><h2>{title}</h2>{tools}<div class="scroll" role="group" tabindex="0" aria-label="{title}">'
        f'<table class="{css_class}"><thead>{head}</thead><tbody>\n'
    )
    yield from rows
    yield "</tbody></table></div></section>\n"
