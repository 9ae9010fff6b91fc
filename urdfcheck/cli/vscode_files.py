"""The files with which VS Code lists findings as problems and knows the keys of the configuration."""

from __future__ import annotations

import json
from pathlib import Path

TASKS, SETTINGS, SCHEMA = ".vscode/tasks.json", ".vscode/settings.json", "urdfcheck.schema.json"


def render_vscode_files(folder: str) -> dict[str, str]:
    """Return the texts of the files by their paths. These, and the ``folder`` to check, start where the editor does."""
    from urdfcheck.cli.config_schema import render_config_schema

    samples = _find_samples_folder()
    tasks = json.loads((samples / "tasks.json").read_text(encoding="utf-8"))
    words = tasks["tasks"][0]["args"]
    words[words.index(".")] = f"./{folder}" if folder.startswith("-") else folder
    return {
        TASKS: json.dumps(tasks, indent=2, ensure_ascii=False) + "\n",
        SETTINGS: (samples / "settings.json").read_text(encoding="utf-8"),
        SCHEMA: json.dumps(render_config_schema(), indent=1) + "\n",
    }


def _find_samples_folder() -> Path:
    """Return the folder of the samples: in the installed package, or in the source tree beside it."""
    package = Path(__file__).parent.parent
    installed = package / "_vscode"
    return installed if installed.is_dir() else package.parent / "integrations" / "vscode"
