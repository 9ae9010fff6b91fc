"""``urdfcheck rule [CODE]``: list the rules, or print a page."""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from urdfcheck.cli.options import CommandParser
from urdfcheck.cli.terminal import OK, say


def build_parser() -> argparse.ArgumentParser:
    """Build the parser of ``urdfcheck rule``."""
    p = CommandParser(prog="urdfcheck rule", description="List the rules, or explain one.")
    p.add_argument("code", nargs="?", metavar="CODE", help="a code or a name")
    return p


def main(words: Sequence[str]) -> int:
    """Run the command."""
    options = build_parser().parse_args(words)

    from urdfcheck import rules as catalogue

    if options.code is None:
        for rule in catalogue.load_rules().values():
            say(f"{rule.code}  {rule.severity!s:7}  {rule.confidence!s:9}  {rule.name}")
        return OK
    say(
        "\n\n".join(
            catalogue.explain_rule(catalogue.load_rules()[code])
            for code in sorted(catalogue.select_rules([options.code]))
        )
    )
    return OK
