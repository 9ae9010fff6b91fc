"""Cases as Markdown tables."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from statistics import median

from real.injection import Case
from real.kinds import Kind

# Least shares of what is found of what can be decided and of what is named of what is found; most that is named wrongly.
FOUND, NAMED, WRONG = 0.97, 0.90, 0.01
_COLUMNS = (
    "| cases | decidable | found | of the rest | named of found | wrong cause | edit right / wrong | also elsewhere |"
)


def build_tables(cases: Sequence[Case], kinds: Iterable[Kind]) -> str:
    """Build a table by kind for cases with meshes and one without, and a summary."""
    kinds = list(kinds)
    nameless = {kind.name for kind in kinds if kind.is_nameless}
    families = {kind.name: kind.family for kind in kinds}
    lines = [_build_summary(cases, families, nameless)]
    for has_meshes, title in ((True, "With the meshes"), (False, "Without readable meshes")):
        some = [case for case in cases if case.has_meshes == has_meshes]
        if not some:
            continue
        lines += [
            f"\n### {title}\n",
            f"| defect {_COLUMNS}",
            "|---|---|---|---|---|---|---|---|---|",
        ]
        for kind in kinds:
            mine = [case for case in some if case.kind == kind.name]
            if mine:
                lines.append(_build_row(f"`{kind.name}`", mine, nameless))
        lines.append(_build_row("all", some, nameless))
    return "\n".join(lines)


def _build_summary(cases: Sequence[Case], families: dict[str, str], nameless: set[str]) -> str:
    lines = [
        f"| defect {_COLUMNS}",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    for family in dict.fromkeys(families.values()):
        for has_meshes in (True, False):
            for habit in (False, True):
                some = [
                    case
                    for case in cases
                    if families[case.kind] == family
                    and case.has_meshes == has_meshes
                    and case.kind.startswith("all: ") == habit
                ]
                if some:
                    name = f"{family}{', all links' if habit else ''}, {'with' if has_meshes else 'without'} meshes"
                    lines.append(_build_row(name, some, nameless))
    lines.append(_build_row("all", cases, nameless))
    decidable = [case for case in cases if case.evidence]
    found = [case for case in decidable if case.verdict.found]
    nameable = _list_nameable(cases, nameless)
    shares = (
        ("found of decidable", len(found), len(decidable), FOUND, True),
        ("named of found", sum(case.verdict.named for case in nameable), len(nameable), NAMED, True),
        ("wrong cause of all", sum(case.verdict.wrong for case in cases), len(cases), WRONG, False),
    )
    lines += ["", "| measure | share | bar |", "|---|---|---|"]
    for name, part, whole, bar, is_least in shares:
        share = part / whole if whole else float("nan")
        missed = "" if (share >= bar if is_least else share <= bar) else " MISSED"
        lines.append(
            f"| {name} | {100 * share:.1f} % of {whole} | {'>=' if is_least else '<='} {100 * bar:.0f} %{missed} |"
        )
    if cases:
        broken = median(1e3 * case.seconds / case.links for case in cases)
        sound = median(1e3 * case.sound_seconds / case.links for case in cases)
        lines += [
            "",
            f"A check takes {broken:.1f} ms per link of a broken robot (median), {sound:.1f} ms of the sound ones.",
        ]
    return "\n".join(lines)


def _build_row(name: str, cases: Sequence[Case], nameless: set[str]) -> str:
    decidable = [case for case in cases if case.evidence]
    rest = [case for case in cases if not case.evidence]
    nameable = _list_nameable(cases, nameless)
    edits = [sum(case.verdict.edit == state for case in cases) for state in ("right", "wrong")]
    cells = (
        str(len(cases)),
        str(len(decidable)),
        _format_share(sum(case.verdict.found for case in decidable), len(decidable)),
        f"{sum(case.verdict.found for case in rest)} of {len(rest)}",
        _format_share(sum(case.verdict.named for case in nameable), len(nameable)),
        str(sum(case.verdict.wrong for case in cases)),
        f"{edits[0]} / {edits[1]}",
        str(sum(case.verdict.other for case in cases)),
    )
    return f"| {name} | {' | '.join(cells)} |"


def _list_nameable(cases: Iterable[Case], nameless: set[str]) -> list[Case]:
    """List the cases that were found and whose cause the file shows."""
    return [case for case in cases if case.verdict.found and case.shows_cause and case.kind not in nameless]


def _format_share(part: int, whole: int) -> str:
    return f"{100 * part / whole:.0f} % ({part})" if whole else "–"


def describe_cases(cases: Iterable[Case]) -> Iterator[str]:
    """Yield lines for each case that is decidable and not found, found and not named, or named wrongly."""
    for case in sorted(cases, key=lambda case: case.kind):
        verdict = case.verdict
        states = []
        if case.evidence and not verdict.found:
            states.append("NOT FOUND")
        if verdict.found and case.shows_cause and not verdict.named:
            states.append("not named")
        if verdict.wrong:
            states.append("WRONG CAUSE")
        if verdict.edit == "wrong":
            states.append("WRONG EDIT")
        if states:
            meshes = "with" if case.has_meshes else "without"
            evidence = ", ".join(case.evidence) or "no evidence"
            yield f"* `{case.kind}` {case.robot} {case.subject} ({meshes} meshes; {evidence}): {', '.join(states)}"
            yield from (f"    {line}" for line in verdict.lines[:6])
