"""The command line, a module per command. Only the standard library is imported until there is something to check."""

from __future__ import annotations

import importlib
import os
import sys
from collections.abc import Sequence
from types import ModuleType

from urdfcheck.cli.terminal import FAILED, FINDINGS, NOTHING, OK, compute_exit_code, erase_progress, say, silence_stdout
from urdfcheck.core.errors import UrdfcheckError

__all__ = ["FAILED", "FINDINGS", "NOTHING", "OK", "compute_exit_code", "main"]

# Each command with its module in `urdfcheck.cli.commands`, in the order of the documentation.
COMMANDS = {
    "check": "check",
    "audit": "audit",
    "diff": "diff",
    "rule": "rule",
    "srdf": "srdf",
    "cache": "setup.cache",
    "baseline": "setup.baseline",
    "engines": "engines",
    "drop": "drop",
    "repair": "repair",
    "config": "setup.config",
    "init": "setup.init",
    "demo": "setup.demo",
    "server": "servers.server",
    "mcp": "servers.mcp",
    "completion": "setup.completion",
}
# What other programs call a command.
_OTHER_NAMES = {
    "explain": "rule CODE",
    "show": "rule CODE",
    "list": "rule",
    "lint": "check",
    "validate": "check",
    "fix": "check --fix",
    "watch": "check --watch",
    "version": "--version",
    "help": "--help",
    "lsp": "server",
}
# What the shell says of a command that SIGPIPE ended, as grep and git end.
CLOSED_PIPE = 141


def main(argv: Sequence[str] | None = None, *, working_folders: Sequence[str] = ()) -> int:
    """Run the command and return its exit code.

    ``working_folders``: from which Python may have taken modules although they may be a stranger's.
    """
    words = list(sys.argv[1:] if argv is None else argv)
    if hasattr(sys.stdout, "reconfigure"):
        sys.stdout.reconfigure(errors="backslashreplace")
    code = CLOSED_PIPE  # until the outcome is known
    try:
        if working_folders:
            _report_planted_modules(working_folders, words)
        code = _run_command(words)
        sys.stdout.flush()
        return code
    except UrdfcheckError as error:
        erase_progress()
        say(f"urdfcheck: {error}", sys.stderr)
    except BrokenPipeError:  # the reader of the output has exited: head, less
        silence_stdout()
        return code
    except OSError as error:
        say(f"urdfcheck: cannot write the output: {error.strerror or error}", sys.stderr)
        silence_stdout()
    except MemoryError:
        erase_progress()
        print(
            "urdfcheck: the reports of all models need more memory than is available: check fewer at once",
            file=sys.stderr,
        )
    except KeyboardInterrupt:
        erase_progress()
        print("urdfcheck: interrupted", file=sys.stderr)
    return FAILED


def load_command(name: str) -> ModuleType:
    """Return the module of a command, with its ``build_parser()`` and ``main(words)``."""
    return importlib.import_module(f"urdfcheck.cli.commands.{COMMANDS[name]}")


def _run_command(words: list[str]) -> int:
    for word in words[: words.index("--") if "--" in words else None]:
        # An untrusted file name may come from a shell pattern or from pre-commit: -ohtml=… would write where it says.
        if word.startswith("-") and os.path.lexists(word):
            raise UrdfcheckError(f"{word} is the name of a file, but reads like an option: write ./{word}")
    name = words[0] if words else ""
    _suggest_command(name)
    command, rest = (name, words[1:]) if name in COMMANDS else ("check", words)
    code: int = load_command(command).main(rest)
    if command != "check":  # its verdict holds without a reader; what the others print is all that they do
        sys.stdout.flush()
    return code


def _suggest_command(name: str) -> None:
    """Reject a word that resembles a command, where there is no such path.

    :raises UrdfcheckError: with what was probably meant.
    """
    if name in COMMANDS or not name.isalpha() or os.path.lexists(name):
        return
    import difflib

    similar = difflib.get_close_matches(name, COMMANDS, n=1, cutoff=0.7)
    meant = _OTHER_NAMES.get(name) or (similar[0] if similar else None)
    if meant is not None:
        raise UrdfcheckError(f"there is neither a command nor a file {name!r}; did you mean urdfcheck {meant}?")


def _report_planted_modules(folders: Sequence[str], words: Sequence[str]) -> None:
    """Say which files of what is checked Python may have run before urdfcheck began.

    :raises UrdfcheckError: for a gate (``--isolated``), whose answer could not be trusted.
    """
    from pathlib import Path

    from urdfcheck.source.project_folders import find_project_folder
    from urdfcheck.system.python_path import find_planted_modules

    paths = [word for word in words if not word.startswith("-") and os.path.lexists(word)]
    found = find_planted_modules(folders, [find_project_folder(Path(path)) for path in paths or [os.curdir]])
    if not found:
        return
    names = ", ".join(found[:3]) + (f" and {len(found) - 3} more" if len(found) > 3 else "")
    text = (
        f"Python may have run {names} of the working directory before urdfcheck began, because of python -m or of an empty or "
        "relative entry in PYTHONPATH; start it as python -I -m urdfcheck"
    )
    if "--isolated" in words:
        raise UrdfcheckError(text)
    say(f"urdfcheck: warning: {text}", sys.stderr)
