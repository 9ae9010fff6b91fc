"""Compares a commit of the repository around the working directory with its parent.

``python one_commit.py COMMIT RULES FOLDER...``: the rules to run, none for all, and folders of packages.

Prints what ``urdfcheck diff COMMIT^..COMMIT`` prints, as text and as JSON, in one JSON document.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from urdfcheck.changes.commits.compare_states import compare_states
from urdfcheck.core import UrdfcheckError
from urdfcheck.output.changes import json as json_output
from urdfcheck.output.changes import text as text_output
from urdfcheck.run.jobs import Request
from urdfcheck.run.request import RunOptions, make_request


def main(commit: str, select: Sequence[str], package_paths: Sequence[str]) -> None:
    """Compare, and print both outputs."""

    def build_request(folder: Path, _translate: Callable[[str], str]) -> Request:
        options = RunOptions(paths=(folder,), package_paths=package_paths, select=select or None, jobs=1)
        return make_request(options)[0]

    try:
        diff = compare_states(f"{commit}^..{commit}", (), build_request)
    except UrdfcheckError as error:
        print(json.dumps({"text": f"{error}\n", "failed": True, "document": {"verdict": "none", "models": []}}))
        return
    document = json.loads(json_output.render(diff))
    print(json.dumps({"text": text_output.render(diff), "failed": bool(diff.failures), "document": document}))


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2].split(",") if sys.argv[2] else [], sys.argv[3:])
