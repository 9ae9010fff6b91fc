"""The page about an audit of many models: numbers, a table of the rules, and a row for each model.

It is written piece by piece, so that no more than a row is held. Without its script, which sorts and filters, it says the same.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cache
from importlib.resources import files
from types import MappingProxyType

from urdfcheck.core import Rule, Run, Severity
from urdfcheck.output.html import head, style_sheet
from urdfcheck.output.html.glyphs import SYMBOLS, glyph, words
from urdfcheck.output.html.groups import LAUNCH_FILE, file_kind
from urdfcheck.output.html.model import Part
from urdfcheck.output.html.text import NONE, base_name, esc, grouped, inline, number
from urdfcheck.output.shared.inert import for_html
from urdfcheck.output.shared.lines import Row, RuleCount, Summary, line, row
from urdfcheck.output.shared.wording import ORDER

# So many rules are named in a model's row; all of them are found by the filter.
MOST_CODES = 6
# So many models stand in a table of the worst, if there are more than these at all.
MOST_WORST = 10
_SENTENCE = re.compile(r".{40,}?[.:](?=\s+[A-Z])", re.DOTALL)
_KINDS = (("model", "Models"), ("launch", "Launch files"), ("package", "Packages"))


def page(
    summary: Summary,
    rows: Iterable[Row],
    rules: Mapping[str, Rule],
    version: str,
    links: Mapping[str, str] = MappingProxyType({}),
) -> Iterator[str]:
    """The document in pieces of whole lines. It is the same for equal summaries and rows. ``links``: the files with the pages
    about single units, by their ids."""
    return map(for_html, _pieces(summary, rows, rules, version, links))


def of_run(run: Run, parts: Sequence[Part], names: Sequence[str]) -> str:
    """The document for the parts of a run that have pages of these names."""
    rows = [*map(_row, parts), row(line("run", "", "", None, (), (), run.failures))]
    links = {_name(part): name for part, name in zip(parts, names, strict=True)}
    return "".join(page(Summary.of(rows), rows, run.rules, run.versions.get("urdfcheck", ""), links))


def _row(part: Part) -> Row:
    kind = (
        "model"
        if part.info
        else "launch"
        if file_kind(part.path, "") == LAUNCH_FILE
        else "package"
        if part.path
        else "other"
    )
    findings = [card.finding for card in part.cards]
    return row(line(kind, _name(part), part.path, part.info, findings, (), ()))


def _name(part: Part) -> str:
    return part.info.id if part.info else part.path or part.title


def _pieces(
    summary: Summary, rows: Iterable[Row], rules: Mapping[str, Rule], version: str, links: Mapping[str, str]
) -> Iterator[str]:
    title = f"{grouped(summary.kinds['model'])} model{'' if summary.kinds['model'] == 1 else 's'}"
    style, script = style_sheet() + _own("index.css"), _own("index.js")
    yield f"""{head(title, style, [script])}<body class="index">
{SYMBOLS}
<a class="skip" href="#models">Skip to the models</a>
{_header(summary, title, version)}
<div class="page">
<main id="content">
{_failures(summary)}{_unchecked(summary)}{_worst(summary, links)}
"""
    # Who has pages to go to looks for them first; who has thousands of models, for what is common to them.
    if not links:
        yield _rules(summary, rules)
    yield from _models(summary, rows, links)
    if links:
        yield _rules(summary, rules)
    yield f"</main>\n</div>\n<script>{script}</script>\n</body>\n</html>\n"


@cache
def _own(name: str) -> str:
    return files(__package__).joinpath(name).read_text(encoding="utf-8")


# -- head --------------------------------------------------------------------------------------------------------------


def _header(summary: Summary, title: str, version: str) -> str:
    kind, verdict = _verdict(summary)
    tiles = "".join(
        f'<li class="tile {s}{"" if summary.counts[s] else " none"}">{glyph(s)} <b>{grouped(summary.counts[s])}</b> '
        f"{words(summary.counts[s], s)}</li>"
        for s in ORDER
    )
    facts = [(name, grouped(summary.kinds[kind])) for kind, name in _KINDS if summary.kinds[kind]]
    facts += [(esc(status.capitalize()), grouped(n)) for status, n in sorted(summary.statuses.items())]
    return (
        f'<header class="top"><p class="brand">urdfcheck <span>{esc(version)}</span></p>'
        f'<h1>{title}</h1><p class="verdict {kind}">{glyph(kind)} {verdict}</p>'
        f'<ul class="tiles" aria-label="Findings by severity">{tiles}</ul><dl class="facts">'
        + "".join(f"<div><dt>{name}</dt><dd>{value}</dd></div>" for name, value in facts)
        + "</dl></header>"
    )


def _verdict(summary: Summary) -> tuple[str, str]:
    unread = summary.kinds["model"] - summary.statuses["checked"]
    if summary.failed:
        return "error", "Not finished: a part of urdfcheck itself failed, so this verdict is incomplete"
    if summary.erroneous:
        has = "has" if summary.erroneous == 1 else "have"
        return "error", f"{grouped(summary.erroneous)} of the models {has} errors"
    if summary.counts[Severity.ERROR]:
        return "error", "There are errors to repair"
    if unread:
        return "warning", f"{grouped(unread)} of the models could not be checked"
    if summary.counts[Severity.WARNING]:
        return "warning", "No errors, but warnings to look at"
    return "ok", "No errors and no warnings"


def _failures(summary: Summary) -> str:
    if not summary.failed:
        return ""
    items = [esc(failure) for failure in summary.failures]
    items += [f"and {grouped(rest)} more"] if (rest := summary.failed - len(items)) else []
    return _box("What failed in urdfcheck", items)


def _unchecked(summary: Summary) -> str:
    total = summary.kinds["model"] - summary.statuses["checked"]
    if not total:
        return ""
    items = [f"<code>{esc(name)}</code>: {esc(status)}" for name, status in summary.unchecked]
    items += [f"and {grouped(rest)} more"] if (rest := total - len(items)) > 0 else []
    return _box("What could not be checked", items)


def _box(title: str, items: Iterable[str]) -> str:
    return f'<section class="failures"><h2>{title}</h2><ul>{"".join(f"<li>{i}</li>" for i in items)}</ul></section>\n'


# -- tables ------------------------------------------------------------------------------------------------------------


def _worst(summary: Summary, links: Mapping[str, str]) -> str:
    if len(summary.worst) < 2 or summary.units <= MOST_WORST:
        return ""
    rows = (_model(row, links) for row in summary.worst[:MOST_WORST])
    return "".join(_table("worst", "Worst models", _MODEL_HEAD, rows))


def _rules(summary: Summary, rules: Mapping[str, Rule]) -> str:
    if not summary.rules:
        return ""
    head = _head(("Rule", ""), ("Severity", ""), ("Findings", "num"), ("Models", "num"), ("What it checks", ""))
    known = (_rule(rules[code], count) for code, count in summary.ranked() if code in rules)
    return "".join(_table("rules", "Rules", head, known, "sortable"))


def _rule(rule: Rule, count: RuleCount) -> str:
    severity = count.severity
    return (
        f'<tr class="{severity}"><th scope="row"><a href="#models" data-find="{esc(rule.code)}"><code>{esc(rule.code)}</code>'
        f'</a> {esc(rule.name)}</th><td class="mark" data-v="{int(severity)}">{glyph(severity)} {severity}</td>'
        f"{_count(count.findings)}{_count(count.units)}<td>{inline(_sentence(rule.summary))}</td></tr>\n"
    )


def _sentence(text: str) -> str:
    """The first one, where that says enough to be one."""
    return text[: match.end()].rstrip() if (match := _SENTENCE.match(text)) else text


def _models(summary: Summary, rows: Iterable[Row], links: Mapping[str, str]) -> Iterator[str]:
    statuses = "".join(f"<option>{esc(status)}</option>" for status in sorted(summary.statuses))
    tools = (
        '<div class="tools" hidden><label>Find <input type="search" id="find" placeholder="name, path or rule"></label>'
        f'<label>Status <select id="status"><option value="">all</option>{statuses}</select></label>'
        '<p role="status" id="shown"></p></div>'
    )
    shown = (_model(row, links) for row in rows if row.kind != "run")
    yield from _table("models", "Models", _MODEL_HEAD, shown, "sortable", tools)


def _model(row: Row, links: Mapping[str, str]) -> str:
    worst = next((str(s) for s, n in zip(ORDER, row.counts, strict=True) if n), "ok")
    codes = " ".join(
        f'<span class="{severity}">{esc(code)}{f" <small>×{grouped(n)}</small>" if n > 1 else ""}</span>'
        for code, severity, n in row.codes[:MOST_CODES]
    )
    rest = len(row.codes) - MOST_CODES
    hidden = f' data-codes="{esc(" ".join(code for code, _, _ in row.codes[MOST_CODES:]))}"' if rest > 0 else ""
    more = f" <small>and {rest} more</small>" if rest > 0 else ""
    name = f"<code>{esc(row.id).replace('/', '/<wbr>')}</code>"
    robot = f" <small>{esc(row.robot)}</small>" if row.robot else ""
    if row.id in links:
        title = esc(row.robot or base_name(row.path) or row.id)
        name, robot = f'<a class="to-page" href="{esc(links[row.id])}">{title}</a>', f" <small>{name}</small>"
    counts = "".join(_count(n, str(s)) for s, n in zip(ORDER, row.counts, strict=True))
    status = row.status if row.kind == "model" else row.kind if row.status == "checked" else f"{row.kind}, {row.status}"
    size = _count(row.links) if row.kind == "model" else f'<td class="num" data-v="-1">{NONE}</td>'
    return (
        f'<tr class="{worst}" data-status="{esc(row.status)}"{hidden}><th scope="row">{name}{robot}</th>'
        f'{counts}<td class="codes">{codes}{more}</td><td>{esc(status)}</td>{size}'
        f'<td class="num" data-v="{-1 if row.mass is None else row.mass!r}">{number(row.mass)}</td></tr>\n'
    )


def _count(value: int, severity: str = "") -> str:
    tone = f" {severity}" if severity and value else ""
    return f'<td class="num{tone}" data-v="{value}">{grouped(value) if value else "0"}</td>'


def _head(*columns: tuple[str, str]) -> str:
    cells = "".join(f'<th scope="col"{f" class={kind}" if kind else ""}>{name}</th>' for name, kind in columns)
    return f"<tr>{cells}</tr>"


_MODEL_HEAD = _head(
    *(("Model", ""), ("Errors", "num"), ("Warnings", "num"), ("Info", "num"), ("Rules", "")),
    *(("Status", ""), ("Links", "num"), ("Mass <small>kg</small>", "num")),
)


def _table(name: str, title: str, head: str, rows: Iterable[str], kind: str = "", tools: str = "") -> Iterator[str]:
    yield (
        f'<section id="{name}"><h2>{title}</h2>{tools}<div class="scroll" role="group" tabindex="0" aria-label="{title}">'
        f'<table class="{kind}"><thead>{head}</thead><tbody>\n'
    )
    yield from rows
    yield "</tbody></table></div></section>\n"
