"""``urdfcheck rule [CODE]``: list the rules, or explain one by its page."""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from urdfcheck.cli.options import CommandParser
from urdfcheck.cli.terminal import OK, say


def build_parser() -> argparse.ArgumentParser:
    """Build the parser of ``urdfcheck rule``."""
    p = CommandParser(prog="urdfcheck rule", description="List the rules, or explain one.")
    p.add_argument("code", nargs="?", metavar="CODE", help="code or name of a rule; without it, all rules are listed")
    p.add_argument("--full", action="store_true", help="print the whole page: all cases, examples and references")
    return p


def main(words: Sequence[str]) -> int:
    """Run the command."""
    options = build_parser().parse_args(words)

    from urdfcheck.rule_pages import abridge_page, explain_page, find_page, list_pages, summarize_page

    explain = explain_page if options.full else abridge_page

    if options.code is None:
        for path in list_pages():
            say(summarize_page(path.read_text(encoding="utf-8")))
        return OK
    page = find_page(options.code)
    if page is not None:
        say(explain(page.read_text(encoding="utf-8")))
        return OK

    from urdfcheck.rules import load_rules, select_rules

    say("\n\n".join(explain(load_rules()[code].page) for code in sorted(select_rules([options.code]))))
    return OK
