"""Errors that a language server shows in published robots, and a draw of them that was read one by one."""

from __future__ import annotations

import csv
import random
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path

JUDGED = Path(__file__).with_name("judged.tsv")
# How many errors of a server are read at most, and the seed of the draw.
READ, SEED = 40, 1
LABELS = {"T": "true", "F": "false", "O": "open"}


@dataclass(frozen=True, slots=True, kw_only=True)
class ShownError:
    """An error that a server shows."""

    server: str
    robot: str
    file: str
    """Its path in the repository."""
    line: int
    code: str
    message: str
    label: str = ""
    """A key of `LABELS`; empty if nobody has read it."""
    reason: str = ""

    @property
    def key(self) -> tuple[str, str, str, int, str, str]:
        """What tells it from others."""
        return self.server, self.robot, self.file, self.line, self.code, self.message


def draw_errors(errors: Sequence[ShownError], count: int = READ, seed: int = SEED) -> list[ShownError]:
    """Draw errors of one server: one of each robot in turn, so that a robot with hundreds does not fill the draw."""
    chance = random.Random(seed)
    by_robot: dict[str, list[ShownError]] = defaultdict(list)
    for error in sorted(errors, key=lambda error: error.key):
        by_robot[error.robot].append(error)
    for some in by_robot.values():
        chance.shuffle(some)
    drawn: list[ShownError] = []
    while by_robot and len(drawn) < count:
        turn = sorted(by_robot)
        chance.shuffle(turn)
        for robot in turn[: count - len(drawn)]:
            drawn.append(by_robot[robot].pop())
            if not by_robot[robot]:
                del by_robot[robot]
    return drawn


def read_judged(path: Path = JUDGED) -> list[ShownError]:
    """Return the errors that were read, with their labels."""
    if not path.exists():
        return []
    with path.open(encoding="utf-8", newline="") as file:
        rows: Iterable[Mapping[str, str]] = csv.DictReader(file, delimiter="\t", quoting=csv.QUOTE_NONE)
        return [ShownError(**{**row, "line": int(row["line"])}) for row in rows]  # type: ignore[arg-type]


def write_judged(drawn: Iterable[ShownError], path: Path = JUDGED) -> int:
    """Write the drawn errors with the labels that they have; return how many have none yet."""
    known = {error.key: error for error in read_judged(path)}
    kept = [known.get(error.key, error) for error in drawn]
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(
            file, [one.name for one in fields(ShownError)], delimiter="\t", quoting=csv.QUOTE_NONE, quotechar=None,
            lineterminator="\n",
        )  # fmt: skip
        writer.writeheader()
        writer.writerows(map(asdict, kept))
    return sum(not error.label for error in kept)
