"""The pages of the rules, with the TOML of a page in rules/ as tables."""

from __future__ import annotations

import html
import re
from collections.abc import Iterator, Mapping
from typing import Any

from urdfcheck.core import Applicability, Confidence, Rule, Severity, Verdict
from urdfcheck.policy.consumers import CONSUMERS, is_news
from urdfcheck.rules import describe_dynamics, describe_on_request, describe_pedantic, split_page
from website.rule_pictures import HEIGHT, WIDTH

SEVERITIES = {
    Severity.ERROR: "the reference parser rejects the file or drops a part of it, or it is physically impossible",
    Severity.WARNING: "the model loads, and behaves in a way that cannot be intended",
    Severity.INFO: "worth knowing; fails no gate by default",
}
CONFIDENCES = {
    Confidence.PROOF: "follows from the files, whatever the author meant",
    Confidence.STRONG: "a named pattern without a false alarm on a hundred real robots",
    Confidence.HEURISTIC: "likely, and for a person to judge",
}
FIXES = {
    Applicability.SAFE: "`--fix` repairs it",
    Applicability.UNSAFE: "`--fix --unsafe-fixes` repairs it where the edit is known: review it",
    Applicability.DISPLAY: "by hand; the finding says what to do",
}
NEEDS = {
    "source": "the text",
    "mesh": "the mesh files",
    "dynamics": "masses and joints in motion",
    "collision": "collisions in sampled poses",
    "simulator": "an installed simulator",
    "package": "the files of the package",
}
# Of a program whose sentence begins with no verdict: a joint sags, a plugin drives nothing.
AFFECTED = "affected"
# Where the generated sections belong: before the examples.
_EXAMPLES = re.compile(r"^## Bad$", re.MULTILINE)


def place_rule(rule: Rule) -> str:
    """Return the file of a rule's page in the folder of the site: the address of INR003 is ``/rules/INR003/``."""
    return f"rules/{rule.code}.md"


def place_pictures(rule: Rule) -> tuple[str, str]:
    """Return the files of the pictures of a Bad and a Good example in the folder of the site."""
    return f"assets/rules/{rule.code}-bad.png", f"assets/rules/{rule.code}-good.png"


def render_rule(rule: Rule, pictured: str = "") -> str:
    """Return the page of a rule as Markdown, with its links as they are in the repository.

    :param pictured: what is reported about the Bad example of which there is a picture; empty if there is none.
    """
    body = split_page(rule.page)[1].partition("\n")[2]
    before, after = _split_examples(body)
    parts = [
        f"---\ntitle: {rule.code} {rule.name}\n---\n\n# {rule.code} {rule.name}\n",
        _render_facts(rule),
        before,
        _render_headlines(rule),
        _render_programs(rule),
        _render_options(rule),
        _render_pictures(rule, pictured) if pictured else "",
        after,
    ]
    return "\n\n".join(part.strip("\n") for part in parts if part.strip()) + "\n"


def render_severity(severity: Severity) -> str:
    """Return a severity as it is shown everywhere on the site."""
    return f'<span class="tone {severity}">{severity}</span>'


def list_outcomes(rule: Rule) -> dict[str, str]:
    """Return the worst that each program does with the defect, in one word, in the order of the programs.

    Programs that load what was typed are left out.
    """
    outcomes: dict[str, tuple[Verdict, str]] = {}
    for _, sentences in _iter_tables(rule):
        for name, sentence in sentences.items():
            if is_news(sentence):
                verdict = Verdict.from_sentence(sentence)
                outcomes[name] = max(outcomes.get(name, (Verdict.LOADS, "")), (verdict, _name_outcome(sentence)))
    return {name: outcomes[name][1] for name in (*CONSUMERS, *sorted(outcomes)) if name in outcomes}


def render_outcome(word: str) -> str:
    """Return what a program does, in one word, as it is shown everywhere on the site."""
    return f'<span class="outcome {word.split()[0]}">{word}</span>'


def _name_outcome(sentence: str) -> str:
    verdict = Verdict.from_sentence(sentence)
    return AFFECTED if verdict is Verdict.LOADS and is_news(sentence) else str(verdict)


def _split_examples(body: str) -> tuple[str, str]:
    """Return what comes before the examples of a page, and the examples with the rest."""
    found = _EXAMPLES.search(body)
    return (body[: found.start()], body[found.start() :]) if found else (body, "")


def _render_facts(rule: Rule) -> str:
    rows = {
        "severity": f"{render_severity(rule.severity)} {SEVERITIES[rule.severity]}",
        "confidence": f"**{rule.confidence}**: {CONFIDENCES[rule.confidence]}",
        "repair": FIXES[rule.fix],
        "reads": " and ".join(NEEDS[need] for need in rule.needs),
        "concerns": f"{', '.join(rule.concerns)} only" if rule.concerns else "",
        "gives way to": f"{', '.join(rule.hidden_by)} on the same element" if rule.hidden_by else "",
        "on request": describe_on_request(rule),
        "pedantic": describe_pedantic(rule),
        "dynamics": describe_dynamics(rule),
        "targets": "what is reported depends on `--target`" if rule.depends_on_targets else "",
        "tags": " ".join(f"`{tag}`" for tag in rule.tags),
        "status": f"{rule.status}, since {rule.since}",
    }
    table = _render_table(("about", "value"), [(f"**{name}**", text) for name, text in rows.items() if text])
    return f'<div class="facts" data-search-exclude markdown>\n\n{table}\n\n</div>'


def _render_pictures(rule: Rule, pictured: str) -> str:
    bad, good = (f"../../{address}" for address in place_pictures(rule))
    said = html.escape(pictured)
    return (
        "## What it looks like\n\n"
        '<div class="pair">'
        f'<figure><img src="{bad}" alt="Bad: {said}" loading="lazy" width="{WIDTH}" height="{HEIGHT}">'
        f"<figcaption><b>Bad</b>: {said}</figcaption></figure>"
        f'<figure><img src="{good}" alt="Good: nothing is reported" loading="lazy" width="{WIDTH}" height="{HEIGHT}">'
        "<figcaption><b>Good</b>: nothing is reported</figcaption></figure>"
        "</div>"
    )


def _render_headlines(rule: Rule) -> str:
    """The titles of the findings with their placeholders, which a reader of a report searches for."""
    if not rule.headlines:
        return ""
    items = "\n".join(f"* {_format_title(rule, message)}" for message in rule.headlines)
    return f"## What it reports\n\n{items}"


def _format_title(rule: Rule, message: str) -> str:
    """Return the headline of a message, or the message itself where all words of its headline depend on the robot."""
    templates = (rule.headlines[message], rule.messages[message], message.replace("_", " "))
    return _format_template(
        next(text for text in templates if re.search(r"[A-Za-z]{2}", re.sub(r"\{[^{}]*\}", "", text)))
    )


def _format_template(template: str) -> str:
    pieces = re.split(r"\{(\w+)[^{}]*\}", template.replace("{{", "\0").replace("}}", "\1"))
    written = "".join(
        f"<var>{piece.replace('_', ' ')}</var>" if index % 2 else escape_markdown(piece)
        for index, piece in enumerate(pieces)
    )
    return written.replace("\0", "{").replace("\1", "}")


def escape_markdown(text: str) -> str:
    """Return a text of a rule so that Markdown, also in a cell of a table, formats only its inline code."""
    pieces = re.split(r"(`[^`]*`)", text)
    return "".join(
        piece.replace("|", "\\|") if index % 2 else re.sub(r"([\\*_\[\]|])", r"\\\1", html.escape(piece, quote=False))
        for index, piece in enumerate(pieces)
    )


def _render_programs(rule: Rule) -> str:
    tables = []
    for message, sentences in _iter_tables(rule):
        rows = [(f"**{name}**", _render_sentence(sentence)) for name, sentence in sentences.items()]
        heading = f"For “{_format_title(rule, message)}”:\n\n" if message else ""
        tables.append(heading + _render_table(("program", "what happens"), rows))
    return "## What each program does\n\n" + "\n\n".join(tables) if tables else ""


def _render_sentence(sentence: str) -> str:
    """Return a sentence about a program with its first word, the verdict, as the index shows it."""
    word = _name_outcome(sentence)
    if not sentence.startswith(word):  # no verdict, or in another tense
        return _format_template(sentence)
    return render_outcome(word) + _format_template(sentence[len(word) :])


def _iter_tables(rule: Rule) -> Iterator[tuple[str, Mapping[str, str]]]:
    """Yield the sentences about the programs: those of all messages under an empty name, then those of single ones."""
    common = {name: sentence for name, sentence in rule.consumers.items() if isinstance(sentence, str)}
    if common:
        yield "", common
    for message, sentences in rule.consumers.items():
        if not isinstance(sentences, str):
            yield message, sentences


def _render_options(rule: Rule) -> str:
    if not rule.options:
        return ""
    rows = [
        (f"`{option.name}`", _format_default(option.default, option.unit), escape_markdown(option.doc))
        for option in rule.options.values()
    ]
    example = next(iter(rule.options.values()))
    return (
        "## Options\n\n"
        + _render_table(("option", "default", "meaning"), rows)
        + f'\n\n```toml title="urdfcheck.toml"\n[options.{rule.code}]\n{example.name} = {_format_value(example.default)}\n```'
    )


def _format_default(default: Any, unit: str) -> str:
    return f"`{_format_value(default)}`" + ("" if unit in ("", "1") else f" {unit}")


def _format_value(value: Any) -> str:
    """Return a number as pages of rules have it: 1e-9, and not Python's 1e-09."""
    return str(value).replace("e-0", "e-")


def _render_table(head: tuple[str, ...], rows: list[tuple[str, ...]]) -> str:
    lines = [head, ("---",) * len(head), *rows]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines)
