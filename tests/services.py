"""Whether files for CI services are what these take, by the services' own schemas."""

from __future__ import annotations

import tempfile
from pathlib import Path

from check_jsonschema import main
from click.testing import CliRunner


def accepts(service: str, text: str) -> bool:
    """Whether a text is valid. ``service``: github-actions, github-workflows or gitlab-ci."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "file.yml")
        path.write_text(text, encoding="utf-8")
        transform = ["--data-transform", "gitlab-ci"] if service == "gitlab-ci" else []
        done = CliRunner().invoke(main, ["--builtin-schema", f"vendor.{service}", *transform, str(path)])
    # 1 is what it says of a file that is not valid; everything else is a failure of its own.
    assert done.exit_code in {0, 1}, done.output
    return done.exit_code == 0
