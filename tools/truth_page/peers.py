"""The comparison with other programs, from ``benchmarks/rivals/answers.json``."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

from truth_page.tables import REPOSITORY, render_table

ANSWERS = REPOSITORY / "benchmarks" / "rivals" / "answers.json"
OWN = "urdfcheck"
Results = Mapping[str, Any]


def read_results() -> Results:
    """Read what `benchmarks/rivals` has written."""
    results: Results = json.loads(ANSWERS.read_text(encoding="utf-8"))
    return results


def count_outcomes(results: Results, program: str, letter: str, operator: str = "") -> int:
    """Count the planted files of an operator, or all of them, that a program has found (f), located (l) or named (n)."""
    return sum(letter in row[program] for row in results["files"] if operator in ("", row["operator"]))


def count_others(results: Results) -> int:
    """Count the other programs; one that is asked in two ways (``simcheck, static``) is one."""
    return len({program["name"].partition(",")[0] for program in results["programs"]} - {OWN})


def find_next_best(results: Results) -> tuple[str, int]:
    """Return the other program that located most, and how many."""
    others = [program["name"] for program in results["programs"] if program["name"] != OWN]
    best = max(others, key=lambda name: count_outcomes(results, name, "l"))
    return best, count_outcomes(results, best, "l")


def render_programs(results: Results) -> str:
    """Return what each program found, those that locate most first; loaders after checkers."""
    rows = []
    for program in _sort_programs(results):
        counts = [count_outcomes(results, program["name"], letter) for letter in "fln"]
        title = f"{program['name']} {program['version']}"
        rows.append((title, program["kind"], *counts, _render_times(program["times"])))
    head = ("program", "made as a", f"found of {len(results['files'])}", "located", "named", "processor time")
    return render_table(head, rows, text_columns=2)


def render_sound(results: Results) -> str:
    """Return what each program reports of the sound robots, in the same order."""
    keys = ("loud", "with_error", "warnings", "errors")
    rows = [(program["name"], *(program[key] for key in keys)) for program in _sort_programs(results)]
    robots = len({row["robot"] for row in results["files"]})
    head = ("program", f"robots with a warning or an error, of {robots}", "robots with an error", "warnings", "errors")
    return render_table(head, rows)


def render_operators(results: Results) -> str:
    """Return how many files of each operator a program located."""
    names = [program["name"] for program in _sort_programs(results)]
    operators = sorted({row["operator"] for row in results["files"]})
    rows = []
    for operator in operators:
        files = sum(row["operator"] == operator for row in results["files"])
        rows.append((operator, files, *(count_outcomes(results, name, "l", operator) for name in names)))
    rows.append(("all", len(results["files"]), *(count_outcomes(results, name, "l") for name in names)))
    return render_table(("operator", "files", *names), rows)


def render_asked(results: Results) -> str:
    """Return how each program was asked."""
    rows = [(program["name"], program["asked"]) for program in _sort_programs(results)]
    return render_table(("program", "asked"), rows, text_columns=2)


def _sort_programs(results: Results) -> Sequence[Mapping[str, Any]]:
    def rank(program: Mapping[str, Any]) -> tuple[str, int]:
        return program["kind"], -count_outcomes(results, program["name"], "l")

    return sorted(results["programs"], key=rank)


def _render_times(times: float) -> str:
    return f"{times:.1f} ×" if times >= 0.95 else f"{times:.2f} ×"
