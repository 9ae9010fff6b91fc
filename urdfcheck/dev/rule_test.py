"""The tests of one rule alone: its page and examples, its style and its types."""

from __future__ import annotations

import subprocess
import sys

from urdfcheck.core.errors import UrdfcheckError
from urdfcheck.rules import find_pages_folder, has_check, load_rules


def run_rule_tests(code: str) -> int:
    """Run what ``make test`` would say about one rule, in seconds, and return the exit code of the first that fails.

    :raises UrdfcheckError: when no page has this code.
    """
    rules = load_rules()
    rule = rules.get(code)
    if rule is None and code.upper() in rules:
        raise UrdfcheckError(f"{code!r} is not a code: did you mean {code.upper()}?")
    if rule is None:
        raise UrdfcheckError(
            f"no page in rules/ has the code {code!r}: python -m urdfcheck.dev new-rule {code} NAME writes one"
        )
    repository = find_pages_folder().parent
    tests = ["tests/test_rules.py", "tests/test_simulators.py", "-k", f"{code} or {rule.stem}"]
    prose = ["tools/check_prose.py", f"rules/{code}-{rule.name}.md"]
    commands = [["-m", "pytest", "-q", "-p", "no:cacheprovider", *tests], prose]
    if has_check(rule):
        module = f"urdfcheck/checks/{rule.stem}.py"
        prose.append(module)
        commands += [["-m", *tool, module] for tool in (["ruff", "check"], ["ruff", "format", "--check"], ["mypy"])]
    codes = [subprocess.run([sys.executable, *command], cwd=repository, check=False).returncode for command in commands]
    return next(filter(None, codes), 0)
