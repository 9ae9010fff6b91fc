"""``urdfcheck cache info|clear``: the measurements that are kept between runs."""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from urdfcheck.cli.options import CommandParser
from urdfcheck.cli.terminal import OK, say
from urdfcheck.core.errors import UrdfcheckError


def build_parser() -> argparse.ArgumentParser:
    """Build the parser of ``urdfcheck cache``."""
    p = CommandParser(prog="urdfcheck cache", description="Show or delete the measurements kept between runs.")
    p.add_argument("action", choices=("info", "clear"), help="print the location and size, or delete everything")
    return p


def main(words: Sequence[str]) -> int:
    """Run the command."""
    options = build_parser().parse_args(words)

    from urdfcheck.system.array_cache import LARGEST, ArrayCache
    from urdfcheck.system.cache_folder import find_default_folder

    cache = ArrayCache(find_default_folder())
    if cache.folder is None:
        raise UrdfcheckError("this user has no cache folder; URDFCHECK_CACHE_DIR names one")
    files = [status.st_size for _, status in cache.iter_files()]
    size = f"{len(files):,} file{'s' * (len(files) != 1)}, {sum(files) / 1e6:,.2f} MB"
    if options.action == "clear":
        cache.clear()
        say(f"deleted {size} in {cache.folder}")
    else:
        say(f"{cache.folder}\n{size}; above {LARGEST / 1e6:,.0f} MB what was not used for longest is dropped")
    return OK
