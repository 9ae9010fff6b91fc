"""A line for each place of each finding, ``file:line:column: severity CODE headline``: what editors, grep and scripts read."""

from __future__ import annotations

from urdfcheck.core import Finding, Run
from urdfcheck.core.merging import list_line_entries
from urdfcheck.output.shared.escaping import escape_for_log
from urdfcheck.output.shared.verdict.not_checked import describe_unused_macros, group_unchecked, list_launched_models
from urdfcheck.output.shared.wording import find_finding_file, format_concise


def render(run: Run) -> str:
    """Render the findings in the order of their places, then what was not checked, and what failed in urdfcheck itself."""

    def locate(finding: Finding) -> tuple[str, int, int]:
        span = finding.location.span
        return (find_finding_file(run, finding), 0, 0) if span is None else (span.file, span.line, span.col)

    entries = list_line_entries(run.active_findings, run.rules)
    lines = [format_concise(run, finding) for finding in sorted(entries, key=locate)]
    for group in group_unchecked(run.unchecked_models):
        paths = ", ".join(dict.fromkeys(info.path for info in group.models))
        lines.append(f"{paths}: not checked: {group.reason}{f' (try {group.command})' if group.command else ''}")
    lines += [f"{name}: not checked: {reason}" for name, reason in list_launched_models(run).items()]
    if run.unused_macro_files:
        lines.append(f"not checked: {describe_unused_macros(run)}")
    lines += [f"not finished: {failure}" for failure in run.failures]
    return "".join(f"{escape_for_log(line)}\n" for line in lines)
