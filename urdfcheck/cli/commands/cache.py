"""``urdfcheck cache info|clear``: what is kept between runs."""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from urdfcheck.cli.options import CommandParser
from urdfcheck.cli.terminal import OK, say
from urdfcheck.core.errors import UrdfcheckError


def build_parser() -> argparse.ArgumentParser:
    """The options of ``urdfcheck cache``."""
    p = CommandParser(prog="urdfcheck cache", description="The measurements that are kept between runs.")
    p.add_argument("action", choices=("info", "clear"), help="say where they are and how large, or delete them")
    return p


def main(words: Sequence[str]) -> int:
    """Run the command."""
    options = build_parser().parse_args(words)

    from urdfcheck.system.array_cache import LARGEST, ArrayCache, find_default_folder

    kept = ArrayCache(find_default_folder())
    if kept.folder is None:
        raise UrdfcheckError("this user has no cache folder; URDFCHECK_CACHE_DIR names one")
    files = [status.st_size for _, status in kept.iter_files()]
    size = f"{len(files):,} file{'s' * (len(files) != 1)}, {sum(files) / 1e6:,.2f} MB"
    if options.action == "clear":
        kept.clear()
        say(f"deleted {size} in {kept.folder}")
    else:
        say(f"{kept.folder}\n{size}; above {LARGEST / 1e6:,.0f} MB what was not used for longest is dropped")
    return OK
