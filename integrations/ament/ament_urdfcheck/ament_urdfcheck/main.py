"""``ament_urdfcheck``: the command urdfcheck with the options that the linters of ament have.

It uses only what urdfcheck promises to keep: its command line, its exit codes and its JUnit report. urdfcheck may therefore be
installed in another Python than ROS.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
from collections.abc import Sequence

FAILED = 2
"""What urdfcheck ends with when it could not run."""


def build_parser() -> argparse.ArgumentParser:
    """Build the parser of the command."""
    parser = argparse.ArgumentParser(
        prog="ament_urdfcheck",
        description="Check robot models (URDF, xacro, launch files) with urdfcheck.",
        epilog="Every other option is one of urdfcheck check (see urdfcheck --help), such as --fail-on warning or --arg "
        "side:=left; write paths before it, or behind --.",
    )
    parser.add_argument(
        "paths", nargs="*", default=[os.curdir], help="models, packages and folders (default: this folder)"
    )
    parser.add_argument(
        "--config",
        metavar="FILE",
        help="the configuration (default: the nearest urdfcheck.toml or pyproject.toml above each file)",
    )
    parser.add_argument(
        "--exclude", metavar="PATTERN", nargs="*", default=[], help="files and folders of the given folders to skip"
    )
    parser.add_argument("--xunit-file", metavar="FILE", help="write the findings as tests into an XML file")
    return parser


def parse_words(words: Sequence[str]) -> tuple[argparse.Namespace, list[str]]:
    """Return the options of ament's linters, and the words that are urdfcheck's. What follows ``--`` is a path.

    How many values an option of urdfcheck has is not known here: all words up to the next option are urdfcheck's.
    """
    ahead, behind = list(words), []
    if "--" in ahead:
        place = ahead.index("--")
        ahead, behind = ahead[:place], ahead[place + 1 :]
    own, others = _split_own_words(ahead)
    options = build_parser().parse_args(own + (["--", *behind] if behind else []))
    return options, others


def _split_own_words(words: Sequence[str]) -> tuple[list[str], list[str]]:
    """Split words into those of the parser above, and urdfcheck's: its options, each with the words up to the next option."""
    own: list[str] = []
    others: list[str] = []
    kept = own
    for word in words:
        name = word.partition("=")[0]
        if name in {"--config", "--exclude", "--xunit-file", "-h", "--help"}:
            kept = own
        elif word.startswith("-") and word != "-":
            kept = others
        kept.append(word)
    return own, others


def build_command(program: str, options: argparse.Namespace, others: Sequence[str]) -> list[str]:
    """Return the command line of urdfcheck."""
    command = [program, "check", *others]
    if options.config is not None:
        command += ["--config", options.config]
    for pattern in options.exclude:
        command.append(f"--exclude={_make_relative(pattern)}")
    if options.xunit_file is not None:
        command += ["-o", f"junit={options.xunit_file}"]
    return [*command, "--", *options.paths]


def _make_relative(pattern: str) -> str:
    """Return a pattern as urdfcheck reads it: an absolute path, as CMake has them, becomes one from the working directory."""
    relative = os.path.relpath(pattern)
    is_below = os.path.isabs(pattern) and relative != os.curdir and not relative.startswith(os.pardir)
    return f"/{relative.replace(os.sep, '/')}" if is_below else pattern


def main(argv: Sequence[str] | None = None) -> int:
    """Run urdfcheck and return its exit code, or 2 where it is not installed."""
    options, others = parse_words(sys.argv[1:] if argv is None else argv)
    program = shutil.which("urdfcheck")
    if program is None:
        print(
            "ament_urdfcheck: the command urdfcheck was not found; install it with: pipx install urdfcheck",
            file=sys.stderr,
        )
        return FAILED
    return subprocess.run(build_command(program, options, others), check=False).returncode


if __name__ == "__main__":
    sys.exit(main())
