"""What simcheck plants: ``plant_with_simcheck.py ENTRY FOLDER``, run by a Python that has simcheck, never by that of urdfcheck.

Prints what was written as one line of JSON.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

from simcheck.checks.registry import Context
from simcheck.config import Config
from simcheck.core import load_asset
from simcheck.mutate import MUTATIONS, apply, copy_clean


def plant(entry: Path, folder: Path) -> dict[str, object]:
    """Write the sound robot and one copy for each operator that applies, like ``simcheck bench``."""
    config = Config(engines=())
    context = Context(load_asset(entry, config), config)
    clean = copy_clean(entry, folder)
    written = {}
    for name, mutation in MUTATIONS.items():
        made = apply(entry, name, folder, 0, context)
        if made is not None:
            written[name] = {"file": str(made[0]), "what": made[1], "expect": mutation.expect}
    return {"clean": str(clean), "planted": written}


if __name__ == "__main__":
    print(json.dumps(plant(Path(sys.argv[1]), Path(sys.argv[2]))))
