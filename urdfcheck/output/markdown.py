"""The report as Markdown: a comment on a pull request, and the summary of a job.

Text of strangers is code or plain words: it brings no markup, link, picture or mention, and closes no cell and no fence.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence

from urdfcheck.core import Applicability, Finding, Run, Severity
from urdfcheck.core.scene import Scene
from urdfcheck.output.mermaid import chart
from urdfcheck.output.shared.diffs import rows
from urdfcheck.output.shared.inert import as_code, for_log, for_markdown, one_line, visible
from urdfcheck.output.shared.wording import NAMES, ORDER, by_effect, looked_at, place, plural, verdict, worst_first

# At the top of a comment, so that a bot finds its own and writes it anew.
MARKER = "<!-- urdfcheck report -->"
# Bytes: GitHub takes comments of 65,536 characters and summaries of 1 MiB from a step.
COMMENT, SUMMARY = 65_000, 1_000_000
SIGNS = {Severity.ERROR: "❌", Severity.WARNING: "⚠️", Severity.INFO: "ℹ️"}
VERDICTS = {"error": "❌", "warning": "⚠️", "ok": "✅"}
HOW = {Applicability.SAFE: "safe to apply as shown", Applicability.UNSAFE: "review it before it is applied"}
# A cell of a table: who wants to read on has the other reports.
LONGEST_TEXT, MOST_EFFECTS, MOST_LINES = 600, 3, 30
MOST_TREES = 5
# What the last line may take, and the end of a fold.
RESERVE = 500
_TICKS = re.compile("`+")


def render(run: Run) -> str:
    """A comment: the verdict, a table of errors and warnings, and folded what is less urgent."""
    page = _Page(COMMENT, [MARKER])
    _head(page, run)
    _findings(page, run)
    _repairs(page, run)
    _trees(page, run, folded=True)
    return page.text()


def job_summary(run: Run, reports: Sequence[str] = (), room: int = SUMMARY) -> str:
    """The summary of a job in at most so many bytes; ``reports``: the files that the run's HTML reports were written to."""
    page = _Page(min(room, SUMMARY), [])
    _head(page, run)
    for report in reports:
        page.add(f"The whole report, with the robot in 3D: {as_code(report)}", "")
    _findings(page, run)
    _models(page, run)
    _trees(page, run, folded=False)
    _repairs(page, run)
    _skipped(page, run)
    return page.text()


class _Page:
    """Lines of a document that may not be larger than ``room`` bytes; what finds no room is counted, and told at the end."""

    def __init__(self, room: int, lines: Iterable[str]) -> None:
        self.lines = list(lines)
        self.left = room - RESERVE - sum(map(_size, self.lines))
        self.missing: list[str] = []

    def add(self, *lines: str) -> bool:
        """Whether these lines, all of them, had room."""
        lines = tuple(map(for_log, lines))
        size = sum(map(_size, lines))
        if size > self.left:
            return False
        self.left -= size
        self.lines += lines
        return True

    def group(self, what: str, head: Sequence[str], blocks: Sequence[Sequence[str]], foot: Sequence[str]) -> None:
        """As many of the blocks as have room, between a head and a foot; ``what``: the word for one of them."""
        self.left -= sum(map(_size, foot))
        shown = 0
        if blocks and self.add(*head):
            while shown < len(blocks) and self.add(*blocks[shown]):
                shown += 1
            self.lines += foot
        else:
            self.left += sum(map(_size, foot))
        if shown < len(blocks):
            self.missing.append(plural(len(blocks) - shown, what))

    def text(self) -> str:
        if self.missing:
            told = ", ".join(self.missing)
            self.lines.append(
                f"*Left out, because a page like this has its limits: {told}. The other reports have all.*"
            )
        return "\n".join(self.lines).rstrip("\n") + "\n"


def _size(line: str) -> int:
    return len(line.encode(errors="replace")) + 1


def _fold(summary: str) -> tuple[list[str], list[str]]:
    return ["<details>", f"<summary>{summary}</summary>", ""], ["", "</details>", ""]


def _head(page: _Page, run: Run) -> None:
    kind, sentence = verdict(run)
    page.add(f"### {VERDICTS[kind]} urdfcheck: {sentence}", "")
    counts = " · ".join(f"{SIGNS[s]} {plural(run.count(s), str(s))}" for s in ORDER)
    known = sum(run.suppressed.values())
    page.add(f"{counts} · in {looked_at(run)}{f' · {known} known and not shown' if known else ''}", "")
    failures = [[f"- urdfcheck failed: {for_markdown(_cut(failure))}"] for failure in run.failures]
    page.group("failure", [], failures, [""])


def _findings(page: _Page, run: Run) -> None:
    found = worst_first(run.active)
    table = ["| | rule | where, what, and → what follows |", "| --- | --- | --- |"]
    urgent = [[_row(run, finding)] for finding in found if finding.severity > Severity.INFO]
    page.group("error or warning", table, urgent, [""])
    notes = [[_row(run, finding)] for finding in found if finding.severity == Severity.INFO]
    head, foot = _fold(f"{SIGNS[Severity.INFO]} {plural(len(notes), 'info')}: worth knowing")
    page.group("info", [*head, *table], notes, foot)


def _row(run: Run, finding: Finding) -> str:
    at = finding.location.span
    where = as_code(finding.location.subject if at is None else place(at))
    given = " ".join(as_code(f"{name}:={value}") for name, value in sorted(run.arguments_of(finding).items()))
    told = for_markdown(_cut(finding.message))
    effects = [
        f"→ {', '.join(for_markdown(NAMES.get(p, p)) for p in programs)}: {for_markdown(_cut(effect))}"
        for effect, programs in by_effect(finding.consequences).items()
    ]
    lines = [f"{where}{f' with {given}' if given else ''}", told, *effects[:MOST_EFFECTS]]
    lines += ["→ …"] if len(effects) > MOST_EFFECTS else []
    severity = f"{SIGNS[finding.severity]}&nbsp;{finding.severity}"
    return f"| {severity} | **{finding.code}**<br>{finding.name} | {'<br>'.join(lines)} |"


def _repairs(page: _Page, run: Run) -> None:
    blocks = [_repair(run, finding) for finding in worst_first(run.active)]
    found = [block for block in blocks if block]
    head, foot = _fold(f"🔧 {plural(len(found), 'repair')} to copy, or to apply with <code>urdfcheck --fix</code>")
    page.group("repair", head, found, foot)


def _repair(run: Run, finding: Finding) -> list[str]:
    fix = finding.fix
    if fix is None or not fix.edits or fix.applicability not in HOW:
        return []
    lines = [line for _, line in rows(run.sources, fix.edits)]
    if len(lines) > MOST_LINES:
        lines = [*lines[:MOST_LINES], f"… {len(lines) - MOST_LINES} more lines"]
    title = f"**{finding.code}** {for_markdown(_cut(fix.title))} ({HOW[fix.applicability]})"
    return [title, "", *_fenced("diff", [_cut(visible(line)) for line in lines]), ""]


def _fenced(language: str, lines: Sequence[str]) -> list[str]:
    """A fence that is longer than what looks like one inside."""
    longest = max((len(ticks) for line in lines for ticks in _TICKS.findall(line)), default=0)
    fence = "`" * max(3, longest + 1)
    return [f"{fence}{language}", *lines, fence]


def _models(page: _Page, run: Run) -> None:
    head = [
        "| model | robot | links | joints | mass | errors | warnings | info |",
        "| --- | --- | --: | --: | --: | --: | --: | --: |",
    ]
    page.group("model", head, [[row] for row in _model_rows(run)], [""])


def _model_rows(run: Run) -> Iterator[str]:
    for info in run.models:
        counts = [sum(f.model == info.id and f.severity == s for f in run.active) for s in ORDER]
        cells = [as_code(info.id), as_code(info.robot) if info.robot else ""]
        if info.status == "checked":
            cells += [str(info.links), str(info.joints), "" if info.mass is None else f"{info.mass:.4g} kg"]
        else:
            cells += [info.status, "", ""]
        yield f"| {' | '.join([*cells, *map(str, counts)])} |"


def _trees(page: _Page, run: Run, *, folded: bool) -> None:
    scenes = [scene for scene in run.scenes if len(scene.links) > 1]
    for scene in scenes[:MOST_TREES]:
        findings = [finding for finding in run.findings if finding.model == scene.model]
        head, foot = _fold(f"🌳 the kinematic tree of {_html(scene.model)}")
        if not folded:
            head, foot = [f"#### The kinematic tree of {as_code(scene.model)}", ""], [""]
        if not page.add(*head, *_tree(scene, findings), *foot):
            page.missing.append("a kinematic tree")
    if len(scenes) > MOST_TREES:
        page.missing.append(plural(len(scenes) - MOST_TREES, "kinematic tree"))


def _tree(scene: Scene, findings: Sequence[Finding]) -> list[str]:
    found = chart(scene, findings)
    more = f"Drawn are {found.shown} of {found.of} links and frames, those next to the root."
    return [*_fenced("mermaid", found.text.splitlines()), *(["", more] if found.shown < found.of else [])]


def _skipped(page: _Page, run: Run) -> None:
    reasons: dict[str, set[str]] = {}
    for skip in run.skipped:
        reasons.setdefault(skip.reason, set()).add(skip.code)
    blocks = [
        [f"- {', '.join(sorted(codes))}: {for_markdown(_cut(reason))}"] for reason, codes in sorted(reasons.items())
    ]
    head, foot = _fold("checks that could not run")
    page.group("reason why a check could not run", head, blocks, foot)


def _html(text: str) -> str:
    """A name in the head of a fold, which is HTML and no Markdown."""
    import html

    return f"<code>{html.escape(one_line(text))}</code>"


def _cut(text: str) -> str:
    return text if len(text) <= LONGEST_TEXT else f"{text[:LONGEST_TEXT]}…"
