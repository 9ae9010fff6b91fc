"""Print what CHANGELOG.md says of a version: ``print_release_notes.py v0.2.0``."""

from __future__ import annotations

import re
import sys
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parent.parent


def find_notes(changelog: str, version: str) -> str:
    """Return the section of a version without its heading. Raises ValueError where there is none, or it is not dated yet."""
    sections = re.split(r"^## ", changelog, flags=re.MULTILINE)
    for section in sections[1:]:
        heading, _, text = section.partition("\n")
        name, _, date = heading.partition(" - ")
        if name.strip() == version:
            if not re.fullmatch(r"\d{4}-\d\d-\d\d", date.strip()):
                raise ValueError(f"CHANGELOG.md gives {version} no date: ## {version} - YYYY-MM-DD")
            return text.strip() + "\n"
    raise ValueError(f"CHANGELOG.md has no section of {version}: ## {version} - YYYY-MM-DD")


def main() -> int:
    """Exit code 1 where the changelog does not say what the release brings."""
    (tag,) = sys.argv[1:]
    try:
        print(find_notes((REPOSITORY / "CHANGELOG.md").read_text(encoding="utf-8"), tag.removeprefix("v")), end="")
    except ValueError as error:
        print(error, file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
