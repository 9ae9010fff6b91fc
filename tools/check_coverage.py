"""Compare the branch coverage of each room with its floor: ``make coverage``, which writes coverage.json first."""

from __future__ import annotations

import json
import sys
from collections import defaultdict
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parent.parent
# Percent of lines and branches that the tests run, rounded down from what was measured. Raise a floor, never lower it.
FLOORS = {
    "core": 99,
    "policy": 98,
    "run": 95,
    "source": 97,
    "fix": 95,
    "rules": 84,
    "facts": 98,
    "model": 97,
    "checks": 97,
    "output": 98,
}


def measure_rooms(report: Path) -> dict[str, float]:
    """Return the percentage of lines and branches covered, by room of the package."""
    covered: dict[str, int] = defaultdict(int)
    total: dict[str, int] = defaultdict(int)
    for name, file in json.loads(report.read_text(encoding="utf-8"))["files"].items():
        room = Path(name).parts[1].removesuffix(".py")
        summary = file["summary"]
        covered[room] += summary["covered_lines"] + summary["covered_branches"]
        total[room] += summary["num_statements"] + summary["num_branches"]
    return {room: 100 * covered[room] / total[room] for room in sorted(total) if total[room]}


def main() -> int:
    """Print the table; exit code 1 when a room is below its floor."""
    rooms = measure_rooms(REPOSITORY / "coverage.json")
    for room, percent in rooms.items():
        floor = FLOORS.get(room)
        print(f"{room:12} {percent:5.1f} %" + ("" if floor is None else f"  floor {floor} %"))
    low = [room for room, floor in FLOORS.items() if rooms.get(room, 0.0) < floor]
    if low:
        print(f"below the floor: {', '.join(low)}", file=sys.stderr)
    return 1 if low else 0


if __name__ == "__main__":
    sys.exit(main())
