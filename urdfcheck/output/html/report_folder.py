"""A report as a folder of files: a page for each model, and an index."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import replace

from urdfcheck.core import Run
from urdfcheck.output.html.document import render_document
from urdfcheck.output.html.index_page import render_run_index
from urdfcheck.output.html.report_parts import ReportPart, collect_report_parts
from urdfcheck.output.shared.verdict.losses import list_refusing_notes

INDEX = "index.html"
LONGEST_NAME = 60
_UNSAFE = re.compile(r"[^A-Za-z0-9._-]+")
_DEVICE = re.compile(r"(?:con|prn|aux|nul|com\d|lpt\d)(?:\.|$)", re.IGNORECASE)


def iter_report_pages(run: Run) -> Iterator[tuple[str, str]]:
    """Yield the name and text of each file of a report in one folder.

    There is a complete page for each part of the run, and last :data:`INDEX` with a row for each of them."""
    run = list_refusing_notes(run)
    parts = collect_report_parts(run)
    names = make_unique_file_names(part.title for part in parts)
    for part, name in zip(parts, names, strict=True):
        run_of_part = _restrict_run_to_part(run, part)
        document = render_document(run_of_part, collect_report_parts(run_of_part), title=part.title, index_file=INDEX)
        yield name, document
    yield INDEX, render_run_index(run, parts, names)


def _restrict_run_to_part(run: Run, part: ReportPart) -> Run:
    """Return the run with only the models, findings and drawings of one part."""
    name = part.path if part.info is None else part.info.id
    return replace(
        run,
        models=() if part.info is None else (part.info,),
        # A page has the cards of all its findings: those that other models share are told on each of their pages.
        findings=tuple(replace(card.finding, variants={}) for card in part.all_cards),
        skipped=tuple(skip for skip in run.skipped if skip.model in (name, "")),
        scenes=() if part.scene is None else (part.scene,),
        drops=() if part.drop is None else (part.drop,),
        unused_macro_files=(),
    )


def make_unique_file_names(titles: Iterable[str]) -> list[str]:
    """Make a file name for each title that every file system accepts: unique ignoring case, and not a Windows device."""
    taken = {INDEX}
    used: Counter[str] = Counter()
    names = []
    for title in titles:
        plain = _UNSAFE.sub("-", title).strip("-.")[:LONGEST_NAME] or "model"
        plain = f"robot-{plain}" if _DEVICE.match(plain) else plain
        name = f"{plain}.html"
        while name.casefold() in taken:
            used[plain] += 1
            name = f"{plain}-{used[plain] + 1}.html"
        taken.add(name.casefold())
        names.append(name)
    return names
