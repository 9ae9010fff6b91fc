"""Make docs/command-line.md from the parsers of the commands: ``python tools/make_command_page.py``."""

from __future__ import annotations

import argparse
from pathlib import Path

from urdfcheck.cli import COMMANDS, load_command

PAGE = Path(__file__).parent.parent / "docs" / "command-line.md"

INTRODUCTION = """\
# Command line

Made from the commands by `make reports`; `urdfcheck COMMAND --help` prints the same.

A `PATH` is a `.urdf`, `.xacro`, `.launch`, `.launch.xml`, `.launch.py` or `.srdf`, a mesh, a package or any folder.
In a folder the models are discovered: `build`, `install`, `log`, folders with COLCON_IGNORE and what git ignores are skipped.
So are templates, in which a generator fills in `{{ name }}` or `$NAME$`: the report lists them.
A xacro that only defines macros or is included by another is checked through the models that use it; so are a mesh and an SRDF.
[Exit codes](continuous-integration.md#exit-codes) are the same for all commands that check.
"""


def render_page() -> str:
    """Return the text of docs/command-line.md."""
    parsers = {name: _build_parser(name) for name in COMMANDS}
    users: dict[tuple[str, str], list[str]] = {}
    for name, parser in parsers.items():
        for action in _list_actions(parser):
            if action.option_strings:
                users.setdefault(_make_row(action, parser), []).append(name)
    shared = {row: names for row, names in users.items() if len(names) > 1}
    parts = [INTRODUCTION]
    for name, parser in parsers.items():
        parts.append(f"\n## urdfcheck {name}\n\n{parser.description}\n\n```\n{_format_usage(name, parser)}```\n")
        rows = [row for row in (_make_row(action, parser) for action in _list_actions(parser)) if row not in shared]
        parts += ["\n| option | meaning |\n|---|---|\n", *(f"| {option} | {text} |\n" for option, text in rows)]
        if any(name in names for names in shared.values()):
            parts.append("\nand [options of several commands](#options-of-several-commands).\n")
    parts.append("\n## Options of several commands\n\n| option | meaning | commands |\n|---|---|---|\n")
    parts += (f"| {option} | {text} | {', '.join(names)} |\n" for (option, text), names in shared.items())
    return "".join(parts)


def _build_parser(command: str) -> argparse.ArgumentParser:
    parser: argparse.ArgumentParser = load_command(command).build_parser()
    return parser


def _list_actions(parser: argparse.ArgumentParser) -> list[argparse.Action]:
    return [action for action in parser._actions if action.help is not argparse.SUPPRESS and action.dest != "help"]


def _make_row(action: argparse.Action, parser: argparse.ArgumentParser) -> tuple[str, str]:
    """Return the cells of an option: how it is written, and what it means."""
    return _name_option(action), _format_help(action, parser)


def _format_usage(name: str, parser: argparse.ArgumentParser) -> str:
    if parser.usage is not None:
        return "".join(f"{line.strip()}\n" for line in parser.usage.splitlines())
    actions = _list_actions(parser)
    operands = [_name_operand(action) for action in actions if not action.option_strings]
    options = ["[options]"] if any(action.option_strings for action in actions) else []
    return " ".join(["urdfcheck", name, *operands, *options]) + "\n"


def _name_operand(action: argparse.Action) -> str:
    name = action.metavar or "|".join(map(str, action.choices or ())) or action.dest
    assert isinstance(name, str)  # no action of ours has a tuple of names
    return {"*": f"[{name}...]", "?": f"[{name}]"}.get(str(action.nargs), name)


def _name_option(action: argparse.Action) -> str:
    if not action.option_strings:
        return f"`{_name_operand(action)}`".replace("|", "\\|")
    value = ""
    if action.nargs != 0:
        value = " " + str(action.metavar or "|".join(map(str, action.choices or ())) or action.dest.upper())
    names = [f"`{name}`" for name in action.option_strings[:-1]]
    return ", ".join([*names, f"`{action.option_strings[-1]}{value}`"]).replace("|", "\\|")


def _format_help(action: argparse.Action, parser: argparse.ArgumentParser) -> str:
    text = (action.help or "") % {"default": action.default, "prog": parser.prog}
    return text.replace("|", "\\|").replace("<", "\\<")


if __name__ == "__main__":
    PAGE.write_text(render_page(), encoding="utf-8", newline="\n")
