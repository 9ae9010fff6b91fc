"""Build the container image and try it as a user does: ``check_image.py TAG [--engine podman]``.

The command in the image audits a copy of car-3 in a mounted folder, as the user who calls it; what it must say is what the
installed wheel must (``check_distribution.py``).
"""

from __future__ import annotations

import argparse
import os
import runpy
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from check_distribution import REPOSITORY, list_faults_of_command

DOCKERFILE = REPOSITORY / "packaging/container/Dockerfile"


def read_version() -> str:
    """Return the version of the sources, which need not be installed."""
    return str(runpy.run_path(str(REPOSITORY / "urdfcheck/version.py"))["__version__"])


def build_image(engine: str, tag: str) -> None:
    """Build the image from the sources of this checkout."""
    subprocess.run([engine, "build", "--file", str(DOCKERFILE), "--tag", tag, str(REPOSITORY)], check=True)


def list_faults_of_image(engine: str, tag: str, version: str, folder: Path) -> list[str]:
    """Return what an image does wrong, run on an empty folder of this machine, which it sees under the same name."""
    asked = subprocess.run([engine, "run", "--rm", "--entrypoint", "id", tag, "-u"], capture_output=True, text=True)
    faults = [] if asked.stdout.strip() not in {"", "0"} else [f"the image runs as user {asked.stdout.strip()!r}"]
    user = [f"--user={os.getuid()}:{os.getgid()}"]
    places = ["--volume", f"{folder}:{folder}", "--workdir", str(folder)]
    return faults + list_faults_of_command([engine, "run", "--rm", *user, *places, tag], version, folder)


def main(words: Sequence[str] | None = None) -> int:
    """Exit code 1 where something is wrong with the image."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("tag", help="what the image is called, such as urdfcheck:0.2.0")
    parser.add_argument("--engine", default="docker", help="docker or podman (default: docker)")
    options = parser.parse_args(words)
    build_image(options.engine, options.tag)
    with tempfile.TemporaryDirectory() as folder:
        faults = list_faults_of_image(options.engine, options.tag, read_version(), Path(folder))
    for fault in faults:
        print(fault, file=sys.stderr)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
