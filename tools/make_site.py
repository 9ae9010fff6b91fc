"""Make the documentation site: ``python tools/make_site.py [FOLDER]`` writes ``site/`` (needs the dependency group ``docs``).

tools/website makes a folder of Markdown, and Material for MkDocs makes HTML of it. A link that leads nowhere, to a page or inside
one, fails the build.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from website.navigation import REPOSITORY
from website.source_tree import write_source_tree

# Without it Material announces its end of life in each build.
_QUIET = {"NO_MKDOCS_2_WARNING": "true"}


def build_site(site: Path, sources: Path) -> None:
    """Write the site into one folder, and what it is made of into another.

    :raises subprocess.CalledProcessError: for a page that is not valid; the generator has said on standard error what is wrong.
    """
    configuration = write_source_tree(sources)
    command = [sys.executable, "-m", "mkdocs", "build", "--strict"]
    subprocess.run(
        [*command, "--config-file", configuration, "--site-dir", site.resolve()],
        env={**os.environ, **_QUIET},
        check=True,
    )


def main(arguments: list[str] | None = None) -> int:
    """Build the site; the exit code is 1 if a page is not valid."""
    parser = argparse.ArgumentParser(description="Make the documentation site.")
    parser.add_argument(
        "site", nargs="?", type=Path, default=REPOSITORY / "site", metavar="FOLDER", help="default: site/"
    )
    parser.add_argument("--sources", type=Path, metavar="FOLDER", help="keep the Markdown that the site is made of")
    options = parser.parse_args(arguments)
    with tempfile.TemporaryDirectory() as folder:
        try:
            build_site(options.site, options.sources or Path(folder))
        except subprocess.CalledProcessError as error:
            return error.returncode
    print(f"site: {options.site}/index.html, to be read through a server: python -m http.server -d {options.site}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
