"""``python -m urdfcheck.dev new-rule CODE NAME`` and ``python -m urdfcheck.dev rule CODE``."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence

from urdfcheck.core.errors import UrdfcheckError
from urdfcheck.dev.new_rule import write_new_rule
from urdfcheck.dev.rule_test import run_rule_tests


def main(words: Sequence[str] | None = None) -> int:
    """Run the command and return its exit code."""
    parser = argparse.ArgumentParser(prog="python -m urdfcheck.dev", description=__doc__)
    commands = parser.add_subparsers(dest="command", required=True)
    new_rule = commands.add_parser(
        "new-rule", help="write the page and the check of a rule, which fail until they are filled in"
    )
    new_rule.add_argument("code", help="three letters of a family and three digits, e.g. NAM008")
    new_rule.add_argument("name", help="words in lower case with hyphens, e.g. dangling-underscore")
    rule = commands.add_parser("rule", help="test one rule alone: its page, its style and its types")
    rule.add_argument("code", help="e.g. NAM008")
    options = parser.parse_args(words)
    try:
        if options.command == "rule":
            return run_rule_tests(options.code)
        for path in write_new_rule(options.code, options.name):
            print(f"wrote {path}")
        print(f"now: make rule CODE={options.code}")
    except UrdfcheckError as error:
        print(f"urdfcheck.dev: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
