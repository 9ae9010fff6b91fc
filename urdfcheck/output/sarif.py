"""SARIF 2.1.0 for GitHub's code scanning and editors: a result for each place of a finding, at the text that must change.

The output also meets GitHub's own demands: no empty text, a place for every result, and no list longer than its limits.
Paths are relative to the working directory, which for GitHub must be the root of the repository.
"""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterator, Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any
from urllib.parse import quote

from urdfcheck.core import NEWLINE, Confidence, Finding, Fix, Rule, Run, Severity, SkippedCheck, Span, Suppression
from urdfcheck.core.merging import list_line_entries
from urdfcheck.core.text import join_names
from urdfcheck.output.shared.escaping import escape_for_json, escape_invisible, escape_one_line
from urdfcheck.output.shared.json_objects import build_subject_object
from urdfcheck.output.shared.positions import to_utf16_region
from urdfcheck.output.shared.rule_page import SHOWN_SECTIONS, find_rule_address, iter_inline_pieces, split_sections
from urdfcheck.output.shared.verdict.effects import ToldEffects, list_new_effects
from urdfcheck.output.shared.verdict.finding_details import BLOCK_LABEL, describe_other_places
from urdfcheck.output.shared.verdict.not_checked import (
    build_command,
    describe_unused_macros,
    explain_block,
    explain_unchecked,
    is_accepted,
)
from urdfcheck.output.shared.wording import (
    describe_models,
    format_count,
    get_base_name,
)

SCHEMA = "https://json.schemastore.org/sarif-2.1.0.json"
BASE = "%SRCROOT%"
# GitHub's limits: beyond them it rejects the file, or drops the excess.
MOST_RESULTS = 25_000
MOST_LOCATIONS = 1_000
MOST_TAGS = 20
MOST_CHARACTERS = 1_024
# Elements that a message names, and places that it links to; the result holds the others.
MOST_NAMED = 100
MOST_LINKED = 4

# What the report lacks, by the name of what should have made it.
_UNMADE = {
    "scene": "The model was not drawn",
    "srdf": "The pairs of links were not classified",
    "drop": "The model was not dropped",
}
LEVELS = {Severity.ERROR: "error", Severity.WARNING: "warning", Severity.INFO: "note"}
PROBLEMS = {Severity.ERROR: "error", Severity.WARNING: "warning", Severity.INFO: "recommendation"}
PRECISIONS = {Confidence.PROOF: "very-high", Confidence.STRONG: "high", Confidence.HEURISTIC: "medium"}
RANKS = {Confidence.PROOF: 100, Confidence.STRONG: 75, Confidence.HEURISTIC: 50}

_FENCE = re.compile(r"^(?:```|~~~).*\n?", re.MULTILINE)
_CODE = re.compile(r"`([^`\n]+)`")
_PLACEHOLDER = re.compile(r"\{\d+\}")
_CALL = re.compile(r"<([^\s<>/]+)")

Json = dict[str, Any]


def render(run: Run) -> str:
    """Render indented JSON with a line for each result, and a newline at the end; equal runs give equal bytes."""
    _resolve_uri.cache_clear()  # symbolic links may have changed since the last run
    index = {code: number for number, code in enumerate(run.rules)}
    entries = list_line_entries(run.findings, run.rules)
    selected = _select_most_important(entries)
    told: ToldEffects = set()
    results = ",".join(f"\n        {_dump_json(_build_result(run, finding, index, told))}" for finding in selected)
    log = {"$schema": SCHEMA, "version": "2.1.0", "runs": [_build_run(run, len(entries) - len(selected), index)]}
    # Indenting thousands of results would take longer than everything else.
    before, after = _dump_json(log, indent=2).rsplit("[]", 1)
    return escape_for_json(f"{before}[{results}]{after}\n")


def _dump_json(value: Json, indent: int | None = None) -> str:
    return json.dumps(value, indent=indent, ensure_ascii=False, allow_nan=False)


def _build_run(run: Run, left_out: int, index: Mapping[str, int]) -> Json:
    """Build the run object, whose results are still empty and come last."""
    return {
        "tool": {
            "driver": {
                "name": "urdfcheck",
                "version": run.versions["urdfcheck"],
                "semanticVersion": run.versions["urdfcheck"],
                "rules": [_build_rule_descriptor(rule) for rule in run.rules.values()],
            }
        },
        "automationDetails": {"id": _make_category(run)},
        "columnKind": "utf16CodeUnits",
        "newlineSequences": ["\r\n", "\n", "\r"],
        "originalUriBaseIds": {BASE: {"description": {"text": "The working directory of the run."}}},
        "invocations": [
            {
                "executionSuccessful": not run.failures
                and not run.partial
                and all(map(is_accepted, run.unchecked_models)),
                "toolExecutionNotifications": list(_iter_notifications(run, left_out, index)),
            }
        ],
        "results": [],
    }


def _select_most_important(findings: Sequence[Finding]) -> Sequence[Finding]:
    """Select as many findings as GitHub accepts, in their order; suppressed ones are dropped first, then the least severe."""
    if len(findings) <= MOST_RESULTS:
        return findings
    ranked = sorted(range(len(findings)), key=lambda i: (findings[i].suppressed is not None, -findings[i].severity))
    return [findings[i] for i in sorted(ranked[:MOST_RESULTS])]


def _make_category(run: Run) -> str:
    """Return the category that distinguishes several runs over one commit: the robot, if there is exactly one."""
    robots = {escape_one_line(info.robot) for info in run.models if info.robot}
    return f"urdfcheck/{robots.pop()}/" if len(robots) == 1 else "urdfcheck/"


# -- rules -------------------------------------------------------------------------------------------------------------


def _build_rule_descriptor(rule: Rule) -> Json:
    title = rule.name.replace("-", " ").capitalize()
    texts = split_sections(rule.page)
    shown = {name: _FENCE.sub("", texts[name]) for name in SHOWN_SECTIONS if texts.get(name, "").strip()}
    address = find_rule_address(rule.code)
    return {
        "id": rule.code,
        "name": rule.name,
        "shortDescription": {"text": title},
        "fullDescription": {"text": _truncate_text(_strip_markdown(rule.summary) or title)},
        **({"helpUri": address} if address else {}),
        "help": {
            "text": "\n\n".join(f"{name}\n{_strip_markdown(text.strip())}" for name, text in shown.items()) or title,
            "markdown": "\n\n".join(f"## {name}\n\n{texts[name].strip()}" for name in shown) or title,
        },
        "defaultConfiguration": {"level": LEVELS[rule.severity]},
        "properties": {
            "tags": list(dict.fromkeys(rule.tags))[:MOST_TAGS],
            "precision": PRECISIONS[rule.confidence],
            "problem.severity": PROBLEMS[rule.severity],
        },
    }


def _strip_markdown(markdown: str) -> str:
    """Return Markdown as plain text, without the marks of inline code, emphasis and links."""
    return "".join(escape_invisible(text) for _, text in iter_inline_pieces(markdown))


def _truncate_text(text: str) -> str:
    return text if len(text) <= MOST_CHARACTERS else f"{text[: MOST_CHARACTERS - 1]}…"


# -- notifications about the run itself --------------------------------------------------------------------------------


def _iter_notifications(run: Run, left_out: int, index: Mapping[str, int]) -> Iterator[Json]:
    for failure in run.failures:
        yield {"level": "error", "message": _build_message(failure)}
    if run.partial:
        yield {"level": "error", "message": _build_message("The run was interrupted: not everything was checked.")}
    if left_out:
        text = f"{format_count(left_out, 'finding')} are left out: code scanning takes no more than {MOST_RESULTS:,}."
        yield {"level": "warning", "message": _build_message(text)}
    for info in run.unchecked_models:
        command = build_command(info)
        text = f"{info.id} was not checked: {explain_unchecked(info)}{f'; {command}' if command else ''}"
        where = {"physicalLocation": {"artifactLocation": _build_artifact_location(info.path)}}
        level = LEVELS[Severity.WARNING if is_accepted(info) else Severity.ERROR]
        yield {"level": level, "message": _build_message(text), "locations": [where]}
    if run.unused_macro_files:
        where_all = [
            {"physicalLocation": {"artifactLocation": _build_artifact_location(file)}}
            for file in run.unused_macro_files[:MOST_LOCATIONS]
        ]
        yield {"level": "note", "message": _build_message(describe_unused_macros(run)), "locations": where_all}
    paths = {info.id: info.path for info in run.models}
    skipped: dict[tuple[str, str], list[str]] = {}
    for skip in run.skipped:
        text = _describe_skip(skip)
        skipped.setdefault((skip.code, text), []).append(paths.get(skip.model, skip.model))
    for (code, text), files in skipped.items():
        notification: Json = {"level": "note", "message": _build_message(text)}
        if code in index:
            notification["associatedRule"] = {"id": code, "index": index[code]}
        if places := [
            {"physicalLocation": {"artifactLocation": _build_artifact_location(f)}} for f in dict.fromkeys(files) if f
        ]:
            notification["locations"] = places[:MOST_LOCATIONS]
        yield notification


def _describe_skip(skip: SkippedCheck) -> str:
    """Return what was left out and why: a whole file, a rule, a part of what a rule finds, or what the report draws."""
    if skip.code == "ALL":
        return f"Not checked: {skip.reason.removeprefix('is not checked: ')}"
    if skip.code == SkippedCheck.LAUNCHED_MODEL:
        return f"The model of a launch file was not checked: {skip.reason}"
    if skip.is_partial:
        return f"{skip.code} is not complete: {skip.reason}"
    return f"{_UNMADE.get(skip.code, f'{skip.code} was not checked')}: {skip.reason}"


# -- results -----------------------------------------------------------------------------------------------------------


def _build_result(run: Run, finding: Finding, index: Mapping[str, int], told: ToldEffects) -> Json:
    related = _list_related_places(finding)
    result: Json = {
        "ruleId": finding.code,
        "kind": "fail",
        "level": LEVELS[finding.severity],
        "message": {"text": _format_message_text(run, finding, related, told)},
        "locations": [
            {
                "physicalLocation": _build_physical_location(run, _locate_finding(run, finding)),
                "logicalLocations": [
                    _build_logical_location(s) for s in list(dict.fromkeys(finding.subjects))[:MOST_LOCATIONS]
                ],
            }
        ],
        "partialFingerprints": {"urdfcheck/v1": finding.fingerprints[0]},
        "rank": RANKS[finding.confidence],
        "suppressions": [] if finding.suppressed is None else [_build_suppression(finding.suppressed)],
        "properties": _build_properties(finding),
    }
    if finding.code in index:
        result["ruleIndex"] = index[finding.code]
    if run.baselines:
        is_known = finding.suppressed is not None and finding.suppressed.kind == "baseline"
        result["baselineState"] = "unchanged" if is_known else "new"
    if related:
        result["relatedLocations"] = [
            {"id": number, "physicalLocation": _build_physical_location(run, span), "message": _build_message(subject)}
            for number, (subject, span) in enumerate(related, 1)
        ]
    place = finding.location
    if place.via and place.span is not None:
        calls = [(span, _describe_call(run, span)) for span in place.via[-(MOST_LOCATIONS - 1) :]]
        steps = [*calls, (place.span, place.subject)]
        result["codeFlows"] = [{"threadFlows": [{"locations": list(_iter_flow_locations(run, steps))}]}]
    if finding.fix is not None and finding.fix.edits:
        result["fixes"] = [_build_fix(run, finding.fix)]
    return result


def _format_message_text(run: Run, finding: Finding, related: Sequence[tuple[str, Span]], told: ToldEffects) -> str:
    """Return the headline and, a paragraph each, the message and everything needed by readers who see only the message."""
    paragraphs = [finding.headline, finding.message]
    if models := describe_models(run, finding):
        paragraphs.append(f"In {models}")
    if arguments := run.find_variant_arguments(finding):
        paragraphs.append("With " + " ".join(f"{name}:={value}" for name, value in sorted(arguments.items())))
    if block := explain_block(run, finding):
        paragraphs.append(f"{BLOCK_LABEL}: {block}")
    paragraphs += describe_other_places(finding)
    if finding.cause_text is not None:
        paragraphs.append(f"Why: {finding.cause_text}")
    paragraphs += [f"{programs}: {effect}" for programs, effect in list_new_effects(run, finding, told)]
    if finding.fix is not None:
        paragraphs.append(f"Fix: {finding.fix.title}")
    if len(finding.subjects) > 1:
        paragraphs.append(f"For {join_names(list(finding.subjects), MOST_NAMED)}")
    lines = [_escape_message_text(_end_sentence(paragraph)) for paragraph in paragraphs]
    links: dict[str, int] = {}
    for number, (_, span) in enumerate(related, 1):
        links.setdefault(_format_link_label(span), number)
    if links:
        lines.append(f"See {join_names([f'[{label}]({number})' for label, number in links.items()], MOST_LINKED)}.")
    return "\n".join(lines)


def _end_sentence(text: str) -> str:
    text = text.rstrip()
    return text if text.endswith((".", "!", "?", "…")) else f"{text}."


def _build_message(text: str) -> Json:
    return {"text": _escape_message_text(text)}


def _escape_message_text(text: str) -> str:
    """Escape what would be a placeholder or a link of SARIF, and control characters.

    The standard wants every brace doubled, but readers show them doubled, so only the braces of would-be placeholders are.
    Backquotes become quotes, because GitHub puts backslashes before underscores between them."""
    plain = _CODE.sub(r'"\1"', escape_invisible(text))
    return _PLACEHOLDER.sub(r"{\g<0>}", plain).replace("](", "] (")


def _format_link_label(span: Span) -> str:
    """Return the text of a link to a span, its brackets and backslashes escaped."""
    text = _escape_message_text(f"{escape_one_line(get_base_name(span.file))}:{span.line}")
    return re.sub(r"([\\\[\]])", r"\\\1", text)


def _list_related_places(finding: Finding) -> list[tuple[str, Span]]:
    """List the related places that have a span, within GitHub's limit."""
    return [(place.subject, place.span) for place in finding.related if place.span is not None][: MOST_LOCATIONS - 1]


def _build_logical_location(subject: str) -> Json:
    parts = build_subject_object(subject)
    location = {"kind": parts["kind"], "name": parts["name"], "fullyQualifiedName": parts["path"]}
    return {key: escape_one_line(value) for key, value in location.items() if value}


def _iter_flow_locations(run: Run, steps: Sequence[tuple[Span, str]]) -> Iterator[Json]:
    """Yield the macro calls and includes that lead to the text, outermost first, and the text itself.

    ``steps``: their places, each with what it is.
    """
    for level, (span, text) in enumerate(steps):
        yield {
            "location": {"physicalLocation": _build_physical_location(run, span), "message": _build_message(text)},
            "nestingLevel": level,
        }


def _describe_call(run: Run, span: Span) -> str:
    tag = _CALL.match(run.sources.get(span.file, ""), span.start)
    return "A call or an include" if tag is None else f"<{tag[1]}>"


def _build_suppression(suppression: Suppression) -> Json:
    kind = "inSource" if suppression.kind == "source" else "external"
    return {
        "kind": kind,
        "status": "accepted",
        "justification": escape_invisible(suppression.reason) or suppression.kind,
    }


def _build_properties(finding: Finding) -> Json:
    properties: Json = {"confidence": str(finding.confidence), "messageId": finding.message_id}
    if finding.model:
        properties["model"] = escape_one_line(finding.model)
    if len(finding.subjects_by_model) > 1:
        properties["models"] = list(map(escape_one_line, finding.subjects_by_model))[:MOST_LOCATIONS]
    if finding.cause is not None:
        properties["cause"] = finding.cause.id
    if finding.fix is not None:
        properties["applicability"] = str(finding.fix.applicability)
    if len(finding.subjects) > 1:
        properties["fingerprints"] = list(finding.fingerprints[:MOST_LOCATIONS])
    return properties


def _build_fix(run: Run, fix: Fix) -> Json:
    changes: dict[str, list[Json]] = {}
    for edit in sorted(fix.edits, key=lambda edit: (edit.span.start, edit.span.end)):
        replacement: Json = {"deletedRegion": _build_region(run, edit.span)}
        if edit.replacement:
            # Use the line breaks of the file.
            newline = NEWLINE.search(run.sources.get(edit.span.file, ""))
            text = edit.replacement if newline is None else NEWLINE.sub(newline[0], edit.replacement)
            replacement["insertedContent"] = {"text": text}
        changes.setdefault(edit.span.file, []).append(replacement)
    return {
        "description": _build_message(_end_sentence(fix.title)),
        "artifactChanges": [
            {"artifactLocation": _build_artifact_location(file), "replacements": replacements}
            for file, replacements in sorted(changes.items())
        ],
    }


# -- places ------------------------------------------------------------------------------------------------------------


def _locate_finding(run: Run, finding: Finding) -> Span:
    """Return the span of a finding, or the start of its model's file, or the start of the first model's file."""
    if finding.location.span is not None:
        return finding.location.span
    paths = {info.id: info.path for info in run.models}
    file = paths.get(finding.model) or finding.model or next(iter(paths.values()), ".")
    return Span(file=file, line=1, col=1, end_line=1, end_col=1, start=0, end=0)


def _build_physical_location(run: Run, span: Span) -> Json:
    return {"artifactLocation": _build_artifact_location(span.file), "region": _build_region(run, span)}


def _build_region(run: Run, span: Span) -> Json:
    region = to_utf16_region(span, run.sources)
    return {
        "startLine": region.line,
        "startColumn": region.column,
        "endLine": region.end_line,
        "endColumn": region.end_column,
    }


def _build_artifact_location(file: str) -> Json:
    uri = _resolve_uri(file, os.getcwd())
    return {"uri": uri} if uri.startswith("file:") else {"uri": uri, "uriBaseId": BASE}


@lru_cache(maxsize=4096)
def _resolve_uri(file: str, folder: str) -> str:
    """Resolve symbolic links, behind which GitHub shows nothing; return the path relative to the working directory as a URI."""
    real = os.path.realpath(file)
    try:
        return quote(os.fsencode(Path(os.path.relpath(real, os.path.realpath(folder))).as_posix()))
    except ValueError:  # another drive
        return Path(real).as_uri()
