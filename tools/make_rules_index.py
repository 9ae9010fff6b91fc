"""Make rules/README.md from the pages: ``python tools/make_rules_index.py``."""

from __future__ import annotations

from pathlib import Path

from urdfcheck.core import Applicability, Rule, Verdict
from urdfcheck.policy.consumers import CONSUMERS
from urdfcheck.rules import describe_on_request, describe_pedantic, load_families, load_rules

FIX = {Applicability.SAFE: "safe", Applicability.UNSAFE: "unsafe", Applicability.DISPLAY: "–"}

INTRODUCTION = """\
# The rules

One page per rule: its metadata, its documentation and its first test. `urdfcheck rule CODE` prints a page.
[CONTRIBUTING](../CONTRIBUTING.md) says how to add one. This index is made by `make reports`.

*fix*: `--fix` repairs it (**safe**), repairs it with `--unsafe-fixes` (**unsafe**), or a person has to (–). *programs*: the worst
that programs do with the defect, if they do not just load what was typed; the page says it in words. *Notes only on request*:
they are reported with `-v`, if `--select`, `select`, `severity` or `options` name the rule (`ALL` names every rule), or if they
matter to a target.
"""


def render_index() -> str:
    """Return the text of rules/README.md."""
    parts = [INTRODUCTION]
    for family in load_families().values():
        members = [rule for code, rule in load_rules().items() if code.startswith(family.code)]
        parts.append(
            f"\n## {family.code}: {family.title}\n\n| code | name | severity | confidence | fix | finds | programs |\n"
            "|---|---|---|---|---|---|---|\n"
        )
        for rule in members:
            page = f"{rule.code}-{rule.name}.md"
            parts.append(
                f"| [{rule.code}]({page}) | {rule.name} | {rule.severity} | {rule.confidence} | {FIX[rule.fix]} "
                f"| {_escape_cell(rule.summary)}{_format_exceptions(rule)} | {_list_programs(rule)} |\n"
            )
    return "".join(parts)


def _list_programs(rule: Rule) -> str:
    """What the consumers do at worst, by verdict, the worst first."""
    worst: dict[str, Verdict] = {}
    for sentences in (rule.consumers, *(v for v in rule.consumers.values() if isinstance(v, dict))):
        for name, sentence in sentences.items():
            if isinstance(sentence, str) and name in CONSUMERS:
                worst[name] = max(worst.get(name, Verdict.LOADS), Verdict.from_sentence(sentence))
    told = []
    for verdict in sorted({*worst.values()} - {Verdict.LOADS}, reverse=True):
        names = [name for name in CONSUMERS if worst.get(name) is verdict]
        told.append(f"**{verdict}** {', '.join(names)}")
    return "; ".join(told) or "–"


def _format_exceptions(rule: Rule) -> str:
    told = [text.partition(" (")[0] for text in (describe_on_request(rule), describe_pedantic(rule)) if text]
    return f" *({'; '.join(told)})*" if told else ""


def _escape_cell(text: str) -> str:
    return text.replace("|", "\\|")


if __name__ == "__main__":
    (Path(__file__).parent.parent / "rules" / "README.md").write_text(render_index(), encoding="utf-8", newline="\n")
