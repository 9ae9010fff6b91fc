"""The command line, a module per command. Only the standard library is imported until there is something to check."""

from __future__ import annotations

import importlib
import os
import sys
from collections.abc import Sequence

from urdfcheck.cli.terminal import FAILED, FINDINGS, NOTHING, OK, compute_exit_code, erase_progress, say, silence_stdout
from urdfcheck.core.errors import UrdfcheckError

__all__ = ["FAILED", "FINDINGS", "NOTHING", "OK", "compute_exit_code", "main"]

COMMANDS = ("check", "audit", "rule", "srdf", "cache", "baseline", "engines", "drop", "config", "init", "completion")
# Words that later versions will use as commands; a file of such a name is written ./diff.
RESERVED = ("diff", "lsp")


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command and return its exit code."""
    words = list(sys.argv[1:] if argv is None else argv)
    if hasattr(sys.stdout, "reconfigure"):
        sys.stdout.reconfigure(errors="backslashreplace")
    try:
        code = _run_command(words)
        sys.stdout.flush()
        return code
    except UrdfcheckError as error:
        erase_progress()
        say(f"urdfcheck: {error}", sys.stderr)
    except BrokenPipeError:  # the reader of the output has exited: head, less
        silence_stdout()
        return OK
    except OSError as error:
        say(f"urdfcheck: cannot write the output: {error.strerror or error}", sys.stderr)
        silence_stdout()
    except KeyboardInterrupt:
        erase_progress()
        print("urdfcheck: interrupted", file=sys.stderr)
    return FAILED


def _run_command(words: list[str]) -> int:
    for word in words[: words.index("--") if "--" in words else None]:
        # An untrusted file name may come from a shell pattern or from pre-commit: -ohtml=… would write where it says.
        if word.startswith("-") and os.path.lexists(word):
            raise UrdfcheckError(f"{word} is a file of this name, and would be taken for an option: write ./{word}")
    name = words[0] if words else ""
    if name in RESERVED:
        raise UrdfcheckError(f"the command {name!r} does not exist yet; to check a file of this name write ./{name}")
    command, rest = (name, words[1:]) if name in COMMANDS else ("check", words)
    code: int = importlib.import_module(f"urdfcheck.cli.commands.{command}").main(rest)
    return code
