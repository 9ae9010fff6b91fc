"""``urdfcheck completion bash|zsh|fish``: a script that lets a shell complete commands, options and their values.

The scripts are generated from the parsers of the commands. They contain all words, so that a key press starts no Python.

shtab 1.13 was tried instead, with every command as a sub-parser. At the first word its bash script offers either the commands
(``check`` as a sub-parser: no path, and no option after a path) or, with the paths of ``check`` on the parent, paths and no
command. The values of CODES, NAMES and FORMAT=FILE would still be functions of our own for each shell.
"""

from __future__ import annotations

import argparse
import shlex
from collections.abc import Iterable, Iterator, Sequence

from urdfcheck.cli import COMMANDS, load_command
from urdfcheck.cli.options import CommandParser
from urdfcheck.cli.terminal import OK
from urdfcheck.core.records import dataclass

FILES, FOLDERS = "files", "folders"
_KINDS = {
    **dict.fromkeys(("PATH", "MODEL", "DATASET", "FILE"), FILES),
    **dict.fromkeys(("DIR", "FOLDER"), FOLDERS),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class CompletedArgument:
    """An option or an operand of a command."""

    flags: tuple[str, ...]
    """Empty for an operand."""
    help: str
    choices: tuple[str, ...]
    """The values to choose from, where they are known."""
    kind: str
    """``FILES``, ``FOLDERS``, or empty for values that a shell does not know."""
    takes_value: bool
    """Whether an option has a value."""
    metavar: str


@dataclass(frozen=True, slots=True)
class CompletedCommand:
    """A command with its options and, in order, its operands."""

    name: str
    help: str
    options: tuple[CompletedArgument, ...]
    operands: tuple[CompletedArgument, ...]

    @property
    def first_words(self) -> tuple[str, ...]:
        """The choices for the first operand."""
        return self.operands[0].choices if self.operands else ()

    @property
    def kind(self) -> str:
        """The kind of the last operand."""
        return self.operands[-1].kind if self.operands else ""


def build_parser() -> argparse.ArgumentParser:
    """Build the parser of ``urdfcheck completion``."""
    p = CommandParser(
        prog="urdfcheck completion",
        description="Print a completion script for a shell.",
        epilog="bash:  urdfcheck completion bash > ~/.local/share/bash-completion/completions/urdfcheck\n"
        "zsh:   urdfcheck completion zsh > a/folder/of/your/fpath/_urdfcheck\n"
        "fish:  urdfcheck completion fish > ~/.config/fish/completions/urdfcheck.fish",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    p.add_argument("shell", choices=tuple(SHELLS), help="the shell")
    return p


def main(words: Sequence[str]) -> int:
    """Run the command."""
    options = build_parser().parse_args(words)
    for line in SHELLS[options.shell](_list_commands()):
        print(line)
    return OK


def _list_commands() -> list[CompletedCommand]:
    from urdfcheck.output import FORMATS, PICTURE_FORMAT
    from urdfcheck.policy.config import TARGETS
    from urdfcheck.rules import load_rules

    codes = tuple(load_rules())
    values = {
        "CODES": ("ALL", *dict.fromkeys(code[:3] for code in codes), *codes),
        "CODE": (*codes, *(rule.name for rule in load_rules().values())),
        "NAMES": tuple(TARGETS),
        "FORMAT=FILE": tuple(f"{name}=" for name in (*FORMATS, PICTURE_FORMAT)),
    }
    return [_describe_command(name, values) for name in COMMANDS]


def _describe_command(name: str, values: dict[str, tuple[str, ...]]) -> CompletedCommand:
    parser: argparse.ArgumentParser = load_command(name).build_parser()
    arguments = []
    for action in parser._actions:
        meta = str(action.metavar or action.dest)
        words = tuple(map(str, action.choices)) if action.choices else values.get(meta, ())
        kind = FILES if meta == "FORMAT=FILE" else _KINDS.get(meta, "")
        text = (action.help or "") % {"default": action.default}
        arguments.append(
            CompletedArgument(
                flags=tuple(action.option_strings),
                help=text,
                choices=words,
                kind=kind,
                takes_value=action.nargs != 0,
                metavar=meta,
            )
        )
    summary = (parser.description or "").partition(". ")[0].rstrip(".")
    return CompletedCommand(
        name,
        summary,
        options=tuple(a for a in arguments if a.flags),
        operands=tuple(a for a in arguments if not a.flags),
    )


def _iter_bash(commands: Iterable[CompletedCommand]) -> Iterator[str]:
    commands = list(commands)
    names = " ".join(c.name for c in commands)
    yield f"""\
# bash completion for urdfcheck
_urdfcheck() {{
    local cur=${{COMP_WORDS[COMP_CWORD]}} prev=${{COMP_WORDS[COMP_CWORD-1]}} command=check
    local words= options= kind=files reply
    COMPREPLY=()
    # --format=json is three words here.
    if [[ $cur == = ]]; then cur=; elif [[ $prev == = ]]; then prev=${{COMP_WORDS[COMP_CWORD-2]}}; fi
    if (( COMP_CWORD > 1 )) && [[ " {names} " == *" ${{COMP_WORDS[1]}} "* ]]; then
        command=${{COMP_WORDS[1]}}
    fi
    case $command in"""
    for command in commands:
        flags = " ".join(flag for option in command.options for flag in option.flags)
        yield f"        {command.name}) options={shlex.quote(flags)} kind={command.kind or 'none'}"
        if command.first_words:
            yield f"            (( COMP_CWORD == 2 )) && words={shlex.quote(' '.join(command.first_words))} kind=none"
        yield "            case $prev in"
        for option in command.options:
            if option.takes_value:
                values = f"words={shlex.quote(' '.join(option.choices))} kind={option.kind or 'none'}"
                yield f"                {'|'.join(option.flags)}) {values} options= ;;"
        yield "            esac ;;"
    yield f"""\
    esac
    (( COMP_CWORD == 1 )) && words="{names}"
    [[ " ${{COMP_WORDS[*]:0:COMP_CWORD}} " == *" -- "* ]] && options=
    [[ $cur == -* && -n $options ]] && words=$options kind=none
    while IFS= read -r reply; do COMPREPLY+=("$reply"); done < <(compgen -W "$words" -- "$cur")
    # A file follows; as the name of one itself its = would be quoted, and Tab would not go on behind it.
    [[ ${{#COMPREPLY[@]}} == 1 && $COMPREPLY == *= ]] && {{ compopt -o nospace 2>/dev/null; return; }}
    case $kind in files) set -- -f ;; folders) set -- -d ;; *) return ;; esac
    compopt -o filenames 2>/dev/null
    while IFS= read -r reply; do COMPREPLY+=("$reply"); done < <(compgen "$1" -- "$cur")
}}
complete -F _urdfcheck urdfcheck"""


def _iter_zsh(commands: Iterable[CompletedCommand]) -> Iterator[str]:
    commands = list(commands)
    listed = " ".join(shlex.quote(f"{c.name}:{c.help}") for c in commands)
    yield f"""\
#compdef urdfcheck
_urdfcheck_reports() {{
    if compset -P '*='; then _files; else compadd -S '' -- "$@"; fi
}}
_urdfcheck() {{
    local command=check
    local -a commands
    commands=({listed})
    if (( CURRENT == 2 )) && [[ $words[2] != -* ]]; then
        _describe -t commands command commands
        _files
        return
    fi
    if (( ${{commands[(I)$words[2]:*]}} )); then
        command=$words[2]
        shift words
        (( CURRENT-- ))
    fi
    case $command in"""
    for command in commands:
        yield f"        {command.name}) _arguments -s \\"
        for option in command.options:
            for flag in option.flags:
                after = f":{_escape_zsh(option.metavar)}:{_format_zsh_action(option)}" if option.takes_value else ""
                sign = "=" if option.takes_value and flag.startswith("--") else ""
                yield f"            {shlex.quote(f'*{flag}{sign}[{_escape_zsh(option.help)}]{after}')} \\"
        for number, operand in enumerate(command.operands, 1):
            place = "*" if number == len(command.operands) else str(number)
            yield f"            {shlex.quote(f'{place}:{_escape_zsh(operand.metavar)}:{_format_zsh_action(operand)}')} \\"
        yield "            && return ;;"
    yield """\
    esac
}
if [[ $funcstack[1] == _urdfcheck ]]; then _urdfcheck "$@"; else compdef _urdfcheck urdfcheck; fi"""


def _format_zsh_action(argument: CompletedArgument) -> str:
    """Return the action by which zsh completes a value."""
    if argument.choices and argument.kind:
        return f"_urdfcheck_reports {' '.join(argument.choices)}"
    if argument.choices:
        return f"({' '.join(argument.choices)})"
    return {FILES: "_files", FOLDERS: "_files -/"}.get(argument.kind, " ")


def _escape_zsh(text: str) -> str:
    return "".join(f"\\{c}" if c in "\\[]:" else c for c in text)


def _iter_fish(commands: Iterable[CompletedCommand]) -> Iterator[str]:
    commands = list(commands)
    yield f"""\
# fish completion for urdfcheck
function __urdfcheck_is
    set -l words (commandline -opc)
    if set -q words[2]; and contains -- $words[2] {" ".join(c.name for c in commands)}
        test $words[2] = $argv[1]
    else
        test $argv[1] = check
    end
end
function __urdfcheck_at
    test (count (commandline -opc)) -eq $argv[1]
end"""
    for command in commands:
        yield f"complete -c urdfcheck -n '__urdfcheck_at 1' -a {command.name} -d {_quote_fish(command.help)}"
    for command in commands:
        here = f"complete -c urdfcheck -n '__urdfcheck_is {command.name}'"
        for option in command.options:
            flags = " ".join(f"-l {f[2:]}" if f.startswith("--") else f"-s {f[1:]}" for f in option.flags)
            yield f"{here} {flags} -d {_quote_fish(option.help)}{_format_fish_values(option)}"
        if command.first_words:
            place = f"'__urdfcheck_is {command.name}; and __urdfcheck_at 2'"
            yield f"complete -c urdfcheck -n {place} -f -a {_quote_fish(' '.join(command.first_words))}"
        if not command.kind:
            yield f"{here} -f"


def _format_fish_values(option: CompletedArgument) -> str:
    """Return the arguments by which fish completes the value of an option."""
    if not option.takes_value:
        return ""
    words = f" -a {_quote_fish(' '.join(option.choices))}" if option.choices else ""
    if option.kind == FOLDERS:
        return " -x -a '(__fish_complete_directories)'"
    return f" -r -F{words}" if option.kind else f" -x{words}"


def _quote_fish(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace("'", "\\'")
    return f"'{escaped}'"


SHELLS = {"bash": _iter_bash, "zsh": _iter_zsh, "fish": _iter_fish}
