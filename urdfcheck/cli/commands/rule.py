"""``urdfcheck rule [CODE]``: list the rules, or print a page."""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from urdfcheck.cli.options import CommandParser
from urdfcheck.cli.terminal import OK, say


def build_parser() -> argparse.ArgumentParser:
    """Build the parser of ``urdfcheck rule``."""
    p = CommandParser(prog="urdfcheck rule", description="List the rules, or explain one.")
    p.add_argument("code", nargs="?", metavar="CODE", help="code or name of a rule; without it, all rules are listed")
    return p


def main(words: Sequence[str]) -> int:
    """Run the command."""
    options = build_parser().parse_args(words)

    from urdfcheck.rules import explain_rule, load_rules, select_rules

    if options.code is None:
        for rule in load_rules().values():
            say(f"{rule.code}  {rule.severity!s:7}  {rule.confidence!s:9}  {rule.name}")
        return OK
    say("\n\n".join(explain_rule(load_rules()[code]) for code in sorted(select_rules([options.code]))))
    return OK
