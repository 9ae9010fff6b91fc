"""Options that several commands share, and their conversion to a request."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

from urdfcheck.core.errors import UrdfcheckError

if TYPE_CHECKING:
    from urdfcheck.policy.config import Config
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


class CommandParser(argparse.ArgumentParser):
    """Escapes its error messages, because a word of the command line may be an untrusted file name."""

    def error(self, message: str) -> NoReturn:
        from urdfcheck.output.shared.escaping import escape_for_log

        super().error(escape_for_log(message))


def add_options(p: argparse.ArgumentParser) -> None:
    """Add the options that decide what is checked, and how."""
    p.add_argument("--tier", choices=("source", "mesh", "full"), help="how much to compute (default: full)")
    p.add_argument("--select", action="append", metavar="CODES", help="only these rules: codes, prefixes, names, tags")
    p.add_argument("--ignore", action="append", metavar="CODES", help="not these rules")
    p.add_argument(
        "--fail-on", choices=("error", "warning", "info", "never"), help="exit 1 from here on (default: error)"
    )
    p.add_argument(
        "--unchecked",
        choices=("error", "warning"),
        help="how bad it is that a model cannot be checked (default: error; warning accepts it)",
    )
    add_access_options(p)
    p.add_argument(
        "--all-args", action="store_true", help="each xacro with all values that its text has for its arguments"
    )
    p.add_argument(
        "--target",
        metavar="NAMES",
        help="who will read the model: gazebo, mujoco, drake, …; what one of them refuses is an error",
    )
    p.add_argument("--baseline", type=Path, metavar="FILE", help="findings that are known (see urdfcheck baseline)")
    p.add_argument("--thorough", action="store_true", help="look at 5,000 configurations of the joints instead of 200")
    p.add_argument("--jobs", type=int, metavar="N", help="models checked at the same time (default: the cores)")
    p.add_argument("--allow-empty", action="store_true", help="exit 0 when there is nothing to check")


def add_access_options(p: argparse.ArgumentParser) -> None:
    """Add the options that decide what a model is read with, and its limits."""
    p.add_argument("--arg", action="append", default=[], metavar="NAME:=VALUE", help="xacro argument for all models")
    p.add_argument("--package", action="append", default=[], metavar="NAME=DIR", help="where a ROS package is")
    p.add_argument("--package-path", action="append", default=[], metavar="DIR", help="folder that holds packages")
    p.add_argument(
        "--allow-read", action="append", default=[], metavar="DIR", help="folder whose files may be opened too"
    )
    p.add_argument(
        "--env", action="append", default=[], metavar="NAME", help="environment variable that xacro may read"
    )
    p.add_argument(
        "--isolated",
        action="store_true",
        help="heed no configuration, comment or baseline of the repository (for gates: they may be a stranger's)",
    )
    p.add_argument("--no-cache", action="store_true", help="keep no measurements and use none that were kept")
    p.add_argument("--timeout", type=float, metavar="SECONDS", help="for one model (default: 300; 0: none)")
    p.add_argument("--memory", type=int, metavar="MIB", help="for one model (default: 4096)")


def ensure_paths(options: argparse.Namespace) -> None:
    """Reject a command line without paths.

    :raises UrdfcheckError: if there is none, or an empty one.
    """
    if not options.paths:
        raise UrdfcheckError("name at least one model, launch file, package or folder (urdfcheck . for this folder)")
    if "" in options.paths:
        raise UrdfcheckError("a path is empty (urdfcheck . for this folder)")


def read_options(options: argparse.Namespace, paths: Sequence[str]) -> RunOptions:
    """Convert the options of `add_options` or `add_access_options`; of the latter, all others keep their defaults.

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
        fail_on=given.get("fail_on"),
        tier=given.get("tier"),
        unchecked=given.get("unchecked"),
        target=None if target is None else split_words([target]),
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
        samples=THOROUGH if given.get("thorough") else SAMPLES,
        jobs=given.get("jobs"),
        spelling=_SPELLING,
    )


def build_request(options: argparse.Namespace, *, scene: bool = False) -> tuple[Request, Config]:
    """Resolve the options of `add_options`: see :func:`urdfcheck.run.request.make_request`."""
    from urdfcheck.run.request import make_request

    return make_request(read_options(options, options.paths), scene=scene)


def build_access_request(options: argparse.Namespace, path: str, codes: frozenset[str]) -> tuple[Request, Config]:
    """Resolve the options of `add_access_options` and the configuration for one path."""
    from urdfcheck.policy.config import ConfigResolver
    from urdfcheck.run.request import make_access_request

    config = ConfigResolver(isolated=options.isolated).for_path(Path(path))
    return make_access_request(read_options(options, [path]), config, codes), config


def _split_pair(text: str, separator: str, option: str, *, value: str = "VALUE") -> tuple[str, str]:
    name, assigned, rest = text.partition(separator)
    if not assigned or not name:
        raise UrdfcheckError(f"{option} {text}: write NAME{separator}{value}")
    return name, rest
