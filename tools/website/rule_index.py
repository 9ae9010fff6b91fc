"""The index of the rules: a table for each family, which assets/rules.js searches and filters."""

from __future__ import annotations

import re

from urdfcheck.core import Applicability, Rule, Verdict
from urdfcheck.rules import load_families, load_rules
from website.markdown import relate
from website.navigation import RULES_INDEX
from website.rule_pages import AFFECTED, list_outcomes, place_rule, render_outcome, render_severity

INTRODUCTION = """\
---
hide: [toc]
search: {{ exclude: true }} # the pages of the rules are found
---

# Rules

{count} rules, each with what it checks, why it matters, how to repair it, examples that run as tests, and when to ignore it.
`urdfcheck rule CODE` prints a page in the terminal.

*repair*: `--fix` repairs it (**safe**), repairs it with `--unsafe-fixes` (**unsafe**), or a person has to (–).
*programs*: the worst that programs do with the defect, if they do not just load what was typed
(*affected*: in another way, which the page of the rule describes).

<div class="rule-filter" hidden></div>
"""
_REPAIRS = {Applicability.SAFE: "**safe**", Applicability.UNSAFE: "unsafe", Applicability.DISPLAY: "–"}
_OUTCOMES = (*(str(verdict) for verdict in sorted(Verdict, reverse=True) if verdict), AFFECTED)
_FIRST_SENTENCE = re.compile(r".+?[.:](?=\s+[A-Z`*]|\s*$)", re.DOTALL)


def render_index() -> str:
    """Return the page of the index, with its links as they are on the site."""
    rules = load_rules()
    parts = [INTRODUCTION.format(count=len(rules))]
    for family in load_families().values():
        rows = "\n".join(_render_row(rule) for code, rule in rules.items() if code.startswith(family.code))
        parts.append(
            f'\n## {family.code}: {family.title} {{ #{family.code} }}\n\n<div class="rule-table" markdown>\n\n'
            f"| rule | finds | severity | repair | programs |\n|---|---|---|---|---|\n{rows}\n\n</div>\n"
        )
    return "".join(parts)


def _render_row(rule: Rule) -> str:
    link = f"[{rule.code}]({relate(place_rule(rule), RULES_INDEX.address)}) <small>{rule.name}</small>"
    cells = (link, _shorten_summary(rule), render_severity(rule.severity), _REPAIRS[rule.fix], _list_programs(rule))
    return f"| {' | '.join(cells)} |"


def _shorten_summary(rule: Rule) -> str:
    first = _FIRST_SENTENCE.match(rule.summary)
    return (first[0] if first else rule.summary).rstrip(":").replace("|", "\\|")


def _list_programs(rule: Rule) -> str:
    """The programs by what they do at worst, the worst first."""
    outcomes = list_outcomes(rule)
    told = [
        f"{render_outcome(word)} {', '.join(name for name in outcomes if outcomes[name] == word)}"
        for word in _OUTCOMES
        if word in outcomes.values()
    ]
    return "<br>".join(told) or "–"
