"""Options that several commands share, and their conversion to a request."""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from urdfcheck.cli.terminal import get_columns, say
from urdfcheck.core.errors import UrdfcheckError

# Type checkers take it for typing's, whose import takes a fifth of the time of --help.
TYPE_CHECKING = False

if TYPE_CHECKING:
    from typing import Any, NoReturn

    from urdfcheck.policy.config import Config
    from urdfcheck.policy.policy import Policy
    from urdfcheck.run.jobs import Request
    from urdfcheck.run.request import RunOptions

# How the command line spells the fields of `RunOptions`.
_SPELLING = {
    **{name: f"--{name}" for name in ("tier", "target", "unchecked", "timeout", "memory", "jobs")},
    "packages": "--package",
    "package_paths": "--package-path",
    "allow_read": "--allow-read",
}
EPILOG = """\
exit codes: 0 nothing at or above --fail-on, 1 findings or a model that could not be checked,
            2 urdfcheck or its configuration failed, 3 nothing to check
urdfcheck rule lists the rules, urdfcheck rule CODE explains one"""


# What argparse says of a value that is not possible; later versions of Python leave out the quotes of the possible ones.
_CHOICE = re.compile(r"invalid choice: (['\"])(.*)\1 \(choose from (.*)\)")
_WORD = re.compile(r"[\w-]+")


class CommandParser(argparse.ArgumentParser):
    """Escapes its error messages, because a word of the command line may be an untrusted file name."""

    def __init__(
        self, *, formatter_class: type[argparse.HelpFormatter] = argparse.HelpFormatter, **settings: Any
    ) -> None:
        def make_formatter(prog: str) -> argparse.HelpFormatter:
            # It would ask shutil for the width, which loads all that packs archives.
            return formatter_class(prog, width=get_columns() - 2)

        super().__init__(formatter_class=make_formatter, **settings)

    def error(self, message: str) -> NoReturn:
        from urdfcheck.output.shared.escaping import escape_for_log

        hint = self._suggest(message)
        if hint or _CHOICE.search(message):  # the message says it all: the usage would push it out of sight
            self.exit(2, escape_for_log(f"{self.prog}: error: {message}{hint}") + "\n")
        super().error(escape_for_log(message))

    def _suggest(self, message: str) -> str:
        """Return the options that resemble those that are unknown, or the value that resembles one that is not possible."""
        import difflib

        choice = _CHOICE.search(message)
        if choice is not None:
            near = difflib.get_close_matches(choice[2].lower(), _WORD.findall(choice[3]), n=1)
            return f"; did you mean {near[0]}?" if near else ""
        _, is_unknown, words = message.partition("unrecognized arguments: ")
        found = []
        for word in words.split() if is_unknown else ():
            name = word.partition("=")[0]
            similar = difflib.get_close_matches(name, self._option_string_actions, n=1) if name[:2] == "--" else []
            found += [f"{similar[0]} instead of {name}"] if similar else []
        return f" (did you mean {', '.join(found)}?)" if found else ""


def _make_option(name: str, commands: Iterable[str], **settings: Any) -> tuple[str, frozenset[str], Mapping[str, Any]]:
    """Return an option of several commands, and what `argparse.ArgumentParser.add_argument` takes for it."""
    return name, frozenset(commands), settings


_CHECKING = ("check", "audit", "baseline", "config")
_SERVING = (*_CHECKING, "server")
_DROPPING = (*_CHECKING, "drop")
_REPAIRING = (*_DROPPING, "repair")
_READING = (*_REPAIRING, "engines", "srdf")
_ALL = (*_READING, "diff", "server")
_REPEATED: Mapping[str, Any] = {"action": "append", "default": []}
# What is checked, how, what a model is read with, and its limits, in the order of the help.
_OPTIONS = (
    _make_option(
        "--tier", (*_SERVING, "diff"), choices=("source", "mesh", "full"), help="how much to compute (default: full)"
    ),
    _make_option(
        "--select",
        (*_SERVING, "diff"),
        action="append",
        metavar="CODES",
        help="only these rules: codes, prefixes, names, tags",
    ),
    _make_option("--ignore", (*_SERVING, "diff"), action="append", metavar="CODES", help="all but these rules"),
    _make_option(
        "--pedantic",
        (*_SERVING, "diff"),
        action="store_true",
        help="report every note, and as warnings those that most maintainers would switch off",
    ),
    _make_option(
        "--fail-on",
        _REPAIRING,
        choices=("error", "warning", "info", "never"),
        help="exit 1 for findings at or above this severity (default: error)",
    ),
    _make_option(
        "--unchecked",
        _READING,
        choices=("error", "warning"),
        help="severity of a model that could not be checked (default: error; warning accepts it)",
    ),
    _make_option(
        "--config",
        _CHECKING,
        type=Path,
        metavar="FILE",
        help="the configuration of everything that is checked, instead of the nearest one above each file",
    ),
    _make_option(
        "--exclude",
        _CHECKING,
        **_REPEATED,
        metavar="PATTERN",
        help="skip these files and folders too when a folder is checked; relative to the working directory (repeatable)",
    ),
    _make_option("--arg", _ALL, **_REPEATED, metavar="NAME:=VALUE", help="xacro argument, for all models (repeatable)"),
    _make_option("--package", _ALL, **_REPEATED, metavar="NAME=DIR", help="where a ROS package is (repeatable)"),
    _make_option("--package-path", _ALL, **_REPEATED, metavar="DIR", help="folder that holds packages (repeatable)"),
    _make_option(
        "--allow-read", _ALL, **_REPEATED, metavar="DIR", help="additional folder whose files may be read (repeatable)"
    ),
    _make_option(
        "--env",
        _ALL,
        **_REPEATED,
        metavar="NAME",
        help="additional environment variable that xacro may read (repeatable)",
    ),
    _make_option(
        "--isolated",
        _ALL,
        action="store_true",
        help="ignore the repository's configuration, comments and baseline (for untrusted changes)",
    ),
    _make_option("--no-cache", _ALL, action="store_true", help="neither read nor write the cache"),
    _make_option("--timeout", _ALL, type=float, metavar="SECONDS", help="limit for one model (default: 300; 0: none)"),
    _make_option("--memory", _ALL, type=int, metavar="MIB", help="memory limit for one model (default: 4096)"),
    _make_option(
        "--all-args",
        (*_DROPPING, "diff"),
        action="store_true",
        help="check each xacro with every argument value that its files offer",
    ),
    _make_option(
        "--target",
        (*_REPAIRING, "engines", "diff", "server"),
        metavar="NAMES",
        help="programs that will read the model (gazebo, mujoco, drake, …): what one of them rejects or drops is an error",
    ),
    _make_option(
        "--baseline",
        (*_DROPPING, "server"),
        type=Path,
        metavar="FILE",
        help="file of accepted findings (see urdfcheck baseline)",
    ),
    _make_option(
        "--thorough", _DROPPING, action="store_true", help="sample 5,000 configurations of the joints instead of 200"
    ),
    _make_option(
        "--jobs", _ALL, type=int, metavar="N", help="models checked at the same time (default: number of cores)"
    ),
    _make_option("--allow-empty", _DROPPING, action="store_true", help="exit 0 when there is nothing to check"),
)


def add_options(p: argparse.ArgumentParser, command: str) -> None:
    """Add the options that a command shares with others."""
    for name, commands, settings in _OPTIONS:
        if command in commands:
            p.add_argument(name, **settings)


def ensure_paths(options: argparse.Namespace) -> None:
    """Reject a command line without paths.

    :raises UrdfcheckError: if there is none, or an empty one.
    """
    if not options.paths:
        raise UrdfcheckError("name at least one model, launch file, package or folder (urdfcheck . for this folder)")
    if "" in options.paths:
        raise UrdfcheckError("a path is empty (urdfcheck . for this folder)")


def read_options(options: argparse.Namespace, paths: Sequence[str]) -> RunOptions:
    """Convert the options of `add_options`; those that a command has not keep their defaults.

    :raises UrdfcheckError: for an option whose value has the wrong form.
    """
    from urdfcheck.run.jobs import SAMPLES, THOROUGH
    from urdfcheck.run.request import RunOptions, split_words

    given = vars(options)
    target: str | None = given.get("target")
    return RunOptions(
        paths=paths,
        select=split_words(given.get("select") or ()),
        ignore=split_words(given.get("ignore") or ()),
        pedantic=given.get("pedantic", False),
        fail_on=given.get("fail_on"),
        tier=given.get("tier"),
        unchecked=given.get("unchecked"),
        target=None if target is None else split_words([target]),
        config=given.get("config"),
        exclude=given.get("exclude") or (),
        baseline=given.get("baseline"),
        may_lack_baseline=given.get("action") == "write",  # urdfcheck baseline write --baseline FILE
        arguments=dict(_split_pair(text, ":=", "--arg") for text in options.arg),
        all_arguments=given.get("all_args", False),
        packages=dict(_split_pair(text, "=", "--package", value="DIR") for text in options.package),
        package_paths=options.package_path,
        allow_read=options.allow_read,
        environment=options.env,
        isolated=options.isolated,
        cache=not options.no_cache,
        timeout=options.timeout,
        memory=options.memory,
        show_all=bool(given.get("verbose")),
        samples=THOROUGH if given.get("thorough") else SAMPLES,
        jobs=given.get("jobs"),
        spelling=_SPELLING,
    )


def build_request(options: argparse.Namespace, *, scene: bool = False) -> tuple[Request, Config]:
    """Resolve the options of a command that checks: see :func:`urdfcheck.run.request.make_request`."""
    from urdfcheck.run.request import make_request

    request, config = make_request(read_options(options, options.paths), scene=scene)
    return _drop_unusable_cache(request), config


def build_access_request(options: argparse.Namespace, path: str, codes: frozenset[str]) -> tuple[Request, Policy]:
    """Resolve the options and the configuration for one path, of a command that selects the rules itself.

    Also return the settings that hold for it.
    """
    from urdfcheck.run.request import make_access_request, make_config_resolver

    run_options = read_options(options, [path])
    resolver = make_config_resolver(run_options)
    config = resolver.for_path(Path(path))
    request = _drop_unusable_cache(make_access_request(run_options, config, codes))
    return request, resolver.resolve(config, Path(path)).policy


def _drop_unusable_cache(request: Request) -> Request:
    """Return the request without a cache that cannot be read, and say so."""
    from urdfcheck.system.cache_folder import explain_unusable_folder

    reason = None if request.cache is None else explain_unusable_folder(request.cache)
    if reason is None:
        return request
    say(f"urdfcheck: {request.cache} is not used as a cache: {reason}", sys.stderr)
    from dataclasses import replace

    return replace(request, cache=None)


def _split_pair(text: str, separator: str, option: str, *, value: str = "VALUE") -> tuple[str, str]:
    from urdfcheck.core.text import TO_FILL_IN

    name, assigned, rest = text.partition(separator)
    if not assigned or not name:
        raise UrdfcheckError(f"{option} {text}: write NAME{separator}{value}")
    if rest == TO_FILL_IN:  # a command that a report proposes
        raise UrdfcheckError(f"{option} {text}: replace {TO_FILL_IN} by the value of {name}")
    return name, rest
