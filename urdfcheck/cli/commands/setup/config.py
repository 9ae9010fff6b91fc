"""``urdfcheck config [PATH]``: the configuration of a file or folder, and where each value comes from."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from urdfcheck.cli.options import EPILOG, CommandParser, add_options, read_options
from urdfcheck.cli.terminal import OK, print_document, say
from urdfcheck.core.errors import UrdfcheckError
from urdfcheck.core.records import dataclass

if TYPE_CHECKING:
    from rich.text import Text

    from urdfcheck.policy.config import Config
    from urdfcheck.policy.config_resolver import ConfigResolver
    from urdfcheck.policy.policy import Policy

DEFAULT, COMMAND_LINE = "default", "command line"
# Columns of the indent, of the names, and before the source of a value.
INDENT, NAMES, PLACES = 2, 17, 67


@dataclass(frozen=True, slots=True)
class Setting:
    """A value and its source: a ``file:line``, the command line, or the default."""

    name: str
    value: Any
    source: str


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleSetting:
    """A severity or an option that differs from the rule's page."""

    code: str
    name: str
    option: str | None
    """None for the severity."""
    value: Any
    default: Any
    source: str


@dataclass(frozen=True, slots=True, kw_only=True)
class ConfigReport:
    """Everything that is printed."""

    path: str
    file: str | None
    root: str
    settings: tuple[Setting, ...]
    selected: tuple[str, ...]
    """Codes of the selected rules."""
    postponed: tuple[str, ...]
    """Codes of those that are selected too where their notes are asked for."""
    rules: tuple[RuleSetting, ...]
    known: tuple[Setting, ...]
    """Entries of ``[[suppress]]``."""
    models: tuple[Setting, ...]
    """Arguments of ``[[models]]`` entries for the path."""


def build_parser() -> argparse.ArgumentParser:
    """Build the parser of ``urdfcheck config``."""
    p = CommandParser(
        prog="urdfcheck config",
        description="Print the configuration that holds for a file or folder, and where each value comes from. It takes the "
        "options of check, which win over every file.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    p.add_argument("path", nargs="?", default=".", metavar="PATH", help="a model or a folder (default: this one)")
    p.add_argument("--format", choices=("text", "json"), default="text", help="output format (default: text)")
    p.add_argument(
        "--schema", action="store_true", help="print the JSON Schema of urdfcheck.toml, for editors, and exit"
    )
    add_options(p, "config")
    return p


def main(words: Sequence[str]) -> int:
    """Run the command."""
    options = build_parser().parse_args(words)
    if options.schema:
        from urdfcheck.cli.config_schema import render_config_schema

        print_document(json.dumps(render_config_schema(), indent=1) + "\n")
        return OK
    path = Path(options.path)
    if not path.exists():
        raise UrdfcheckError(f"{path} does not exist")

    from urdfcheck.run.request import find_baseline_file, make_config_resolver

    run_options = read_options(options, [options.path])
    resolver = make_config_resolver(run_options)
    config = resolver.for_path(path)
    baseline = find_baseline_file(run_options, config)
    is_found = baseline.is_file() and not options.isolated
    shown_baseline = baseline if is_found or options.baseline or config.baseline else None
    report = _build_report(resolver, config, path, baseline=shown_baseline)
    if options.format == "json":
        from urdfcheck.output.shared.escaping import escape_for_json

        print_document(escape_for_json(json.dumps(asdict(report), indent=2, ensure_ascii=False) + "\n"))
    else:
        _print_report(report)
    return OK


def _build_report(resolver: ConfigResolver, config: Config, path: Path, *, baseline: Path | None) -> ConfigReport:
    from urdfcheck.policy.config_file import read_typed_table
    from urdfcheck.source.package.finder import format_path

    given, effective = resolver.overrides, resolver.resolve(config, path)
    table, at = read_typed_table(config)
    sections = [(s.key, _get_section(table, s.key)) for s in config.get_sections(path)]

    def get_source(*key: str | int) -> str:
        return at[key]

    def find_last_source(key: str) -> str:
        """Return where the last section that sets a key is, which wins."""
        return next((get_source(*where, key) for where, section in reversed(sections) if key in section), DEFAULT)

    def iter_code_settings(key: str, default: str, on_command_line: frozenset[str] | None) -> Iterator[Setting]:
        if on_command_line is not None:
            yield Setting(key, _shorten_list(sorted(on_command_line)), COMMAND_LINE)
            return
        typed_settings = [Setting(key, ", ".join(s[key]), get_source(*where, key)) for where, s in sections if key in s]
        yield from typed_settings or [Setting(key, default, DEFAULT)]

    def make_setting(key: str, value: Any, *, on_command_line: bool = False) -> Setting:
        return Setting(key, value, COMMAND_LINE if on_command_line else find_last_source(key))

    beside = "found beside the configuration" if config.baseline is None else find_last_source("baseline")
    settings = [
        *iter_code_settings("select", "ALL", given.select),
        *iter_code_settings("ignore", "", given.ignore),
        make_setting("pedantic", str(effective.policy.pedantic).lower(), on_command_line=given.pedantic),
        make_setting("kinematics-only", str(effective.policy.kinematics_only).lower()),
        make_setting("fail-on", effective.fail_on, on_command_line=given.fail_on is not None),
        make_setting("tier", effective.policy.tier, on_command_line=given.tier is not None),
        make_setting(
            "unchecked", _format_unchecked(given.unchecked, config), on_command_line=given.unchecked is not None
        ),
        make_setting("target", ", ".join(effective.policy.targets), on_command_line=given.target is not None),
        make_setting("exclude", ", ".join(config.exclude)),
        *(Setting("exclude", pattern, COMMAND_LINE) for pattern in given.exclude),
        *(Setting("packages", f"{n} = {format_path(p)}", at["packages", n]) for n, p in config.packages.items()),
        make_setting("package-path", ", ".join(map(format_path, config.package_path))),
        Setting("baseline", "", DEFAULT)
        if baseline is None
        else Setting("baseline", format_path(baseline), COMMAND_LINE if given.baseline is not None else beside),
        make_setting("strict-baseline", str(config.strict_baseline).lower()),
    ]
    known = [
        Setting(_shorten_list(_get_suppressed_codes(table, i)), f"{entry.subject}: {entry.reason}", at["suppress", i])
        for i, (_, entry) in enumerate(config.suppress)
        if entry in effective.policy.suppress
    ]
    models = [
        Setting(m.name or "no name", " ".join(f"{n}:={v}" for n, v in m.arguments.items()), at["models", i])
        for i, m in enumerate(config.models)
        if m.path.resolve() == path.resolve()
    ]
    return ConfigReport(
        path=format_path(path),
        file=None if config.file is None else format_path(config.file),
        root=format_path(config.root),
        settings=tuple(settings),
        selected=tuple(sorted(effective.policy.codes)),
        postponed=tuple(sorted(effective.policy.postponed)),
        rules=tuple(_iter_rule_settings(effective.policy, sections, at)),
        known=tuple(known),
        models=tuple(models),
    )


def _format_unchecked(given: str | None, config: Config) -> str:
    """Return how bad it is that a model cannot be checked: for all, or the patterns of the models that may stay unchecked."""
    value = given or config.unchecked
    return value if isinstance(value, str) else f"warning for {', '.join(value) or 'none'}"


def _get_section(table: Mapping[str, Any], key: Sequence[str | int]) -> Mapping[str, Any]:
    value: Any = table
    for part in key:
        value = value[part]
    section: Mapping[str, Any] = value
    return section


def _get_suppressed_codes(table: Mapping[str, Any], index: int) -> list[str]:
    words: list[str] = table["suppress"][index]["codes"]
    return words


def _iter_rule_settings(
    policy: Policy,
    sections: Sequence[tuple[tuple[str | int, ...], Mapping[str, Any]]],
    at: Mapping[tuple[str | int, ...], str],
) -> Iterator[RuleSetting]:
    from urdfcheck.rules import load_rules, select_rules

    severities: dict[str, str] = {}
    options: dict[tuple[str, str], str] = {}
    for where, section in sections:
        # In the order of the configuration: a word that means fewer rules comes later, and wins.
        for word in sorted(section.get("severity", {}), key=lambda w: -len(select_rules([w]))):
            place = (*where, "severity", word)
            severities.update(dict.fromkeys(select_rules([word]), at[place]))
        for word in sorted(section.get("options", {}), key=lambda w: -len(select_rules([w]))):
            for name in section["options"][word]:
                place = (*where, "options", word, name)
                options.update(dict.fromkeys(((code, name) for code in select_rules([word])), at[place]))
    for code, rule in load_rules().items():
        # What `strict-baseline` sets is told there.
        if code in severities and code in policy.codes and policy.severities[code] != str(rule.severity):
            value = policy.severities[code]
            yield RuleSetting(
                code=code,
                name=rule.name,
                option=None,
                value=value,
                default=str(rule.severity),
                source=severities[code],
            )
        for name, value in policy.options.get(code, {}).items() if code in policy.codes else ():
            yield RuleSetting(
                code=code,
                name=rule.name,
                option=name,
                value=value,
                default=rule.options[name].default,
                source=options[code, name],
            )


def _shorten_list(words: Sequence[str]) -> str:
    return ", ".join(words) if len(words) <= 8 else f"{', '.join(words[:8])} and {len(words) - 8} more"


# -- for a person ------------------------------------------------------------------------------------------------------


def _print_report(report: ConfigReport) -> None:
    from rich.console import Console
    from rich.text import Text

    from urdfcheck.output.shared.escaping import escape_one_line
    from urdfcheck.rules import load_rules

    def make_row(name: str, value: str, source: str) -> Text:
        line = Text(" " * INDENT).append(escape_one_line(name).ljust(NAMES), "" if value else "dim")
        line.append(escape_one_line(value) or "none", "" if value else "dim")
        line.pad_right(max(PLACES - line.cell_len, 2))
        return line.append(escape_one_line(source), "dim" if source == DEFAULT else "cyan")

    def make_block(title: str, rows: Sequence[Text]) -> list[Text]:
        return [Text(), Text(f"  {title}", "bold"), *rows] if rows else []

    lines = [Text.assemble((escape_one_line(report.path), "bold"))]
    lines.append(
        Text.assemble(
            "  configured by ", (escape_one_line(report.file or "no configuration file: the defaults apply"), "cyan")
        )
    )
    lines.append(Text.assemble("  models are named from ", (escape_one_line(report.root), "")))
    lines.append(Text())
    lines += [make_row(s.name, str(s.value), s.source) for s in report.settings]
    more = f"; {', '.join(report.postponed)} with -v" if report.postponed else ""
    lines.append(make_row("rules", f"{len(report.selected)} of {len(load_rules())}{more}", ""))
    severities = [
        make_row(r.code, f"{r.name}: {r.default} → {r.value}", r.source) for r in report.rules if r.option is None
    ]
    options = [
        make_row(r.code, f"{r.name}: {r.option} = {r.value}, on the page {r.default}", r.source)
        for r in report.rules
        if r.option is not None
    ]
    lines += make_block("severities that differ from the rule's page", severities)
    lines += make_block("options that differ", options)
    lines += make_block(
        "checked with these arguments", [make_row(m.name, str(m.value), m.source) for m in report.models]
    )
    lines += make_block("known findings", [make_row(k.name, str(k.value), k.source) for k in report.known])
    console = Console()
    for line in lines:
        if console.is_terminal:
            console.print(line, soft_wrap=True)
        else:
            say(line.plain.rstrip(), sys.stdout)
