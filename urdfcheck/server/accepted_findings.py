"""The action that adds a finding to the baseline, as ``urdfcheck baseline write`` would."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterable, Mapping
from pathlib import Path

from lsprotocol import types

from urdfcheck.core.errors import UrdfcheckError
from urdfcheck.policy.baseline import (
    Baseline,
    EntryKey,
    collect_entries,
    collect_excesses,
    is_baseline_candidate,
    raise_excesses,
    read_found_baseline,
    render_baseline,
)
from urdfcheck.policy.suppression import is_worse
from urdfcheck.server.diagnostics import ShownFinding
from urdfcheck.server.documents import DocumentStore, TextPositions, iter_differences
from urdfcheck.system.files import overlay_files


def list_acceptances(
    range_: types.Range, shown: Iterable[ShownFinding], documents: DocumentStore
) -> list[types.CodeAction]:
    """Return for each finding in a range the edit of the baselines that accepts it in all its models."""
    actions = []
    for found in shown:
        if found.range.start <= range_.end and range_.start <= found.range.end and is_baseline_candidate(found.finding):
            action = _make_acceptance(found, documents)
            actions += [] if action is None else [action]
    return list({action.title: action for action in actions}.values())


def _make_acceptance(found: ShownFinding, documents: DocumentStore) -> types.CodeAction | None:
    """Return the action; None where a baseline cannot be read, or the editor could not create it."""
    places = {model: place for project in found.state.answer.projects for model, place in project.baselines.items()}
    added: dict[tuple[str, str], dict[str, Counter[EntryKey]]] = {}
    measured = collect_excesses([found.finding])
    excesses: dict[tuple[str, str], dict[str, Mapping[EntryKey, float]]] = {}
    for model, entries in collect_entries([found.finding]).items():
        place = places.get(model)
        if place is None:
            return None
        added.setdefault((place.file, place.root), {})[place.model] = entries
        excesses.setdefault((place.file, place.root), {})[place.model] = measured.get(model, {})
    changes: list[types.TextDocumentEdit | types.CreateFile | types.RenameFile | types.DeleteFile] = []
    for (file, root), models in added.items():
        edits = _edit_baseline(Path(file), Path(root), models, excesses[file, root], documents)
        if edits is None:
            return None
        changes += edits
    if not changes:
        return None
    names = ", ".join(sorted({os.path.basename(file) for file, _ in added}))
    return types.CodeAction(
        title=f"Accept {found.finding.code} here: add it to {names}",
        kind=types.CodeActionKind.QuickFix,
        diagnostics=[found.diagnostic],
        edit=types.WorkspaceEdit(document_changes=changes),
    )


def _edit_baseline(
    file: Path,
    root: Path,
    added: Mapping[str, Counter[EntryKey]],
    excesses: Mapping[str, Mapping[EntryKey, float]],
    documents: DocumentStore,
) -> list[types.TextDocumentEdit | types.CreateFile] | None:
    """Return the edits of a baseline that add entries to it; None where it cannot be read or made."""
    document = documents.find_open(str(file))
    try:
        with overlay_files({} if document is None else {document.real: document.encode()}):
            old = read_found_baseline(file, root)
    except UrdfcheckError:  # every check reports it
        return None
    if not (documents.has_versioned_edits if old is not None else documents.can_create_files):
        return None
    known = Baseline(path=file, root=root) if old is None else old
    models = {model: Counter(entries) for model, entries in known.models.items()}
    worst = {model: dict(entries) for model, entries in known.excesses.items()}
    for model, entries in added.items():
        before = worst.setdefault(model, {})
        # What has become worse has its entry.
        worse = {key for key, excess in excesses[model].items() if is_worse(excess, before.get(key))}
        more = Counter({key: count for key, count in entries.items() if key not in worse})
        models[model] = models.get(model, Counter()) + more
        raise_excesses(before, excesses[model].items())
    positions = TextPositions(known.text, documents.encoding)
    edits = list(iter_differences(positions, render_baseline(models, worst)))
    uri = documents.find_uri(str(file))
    identifier = types.OptionalVersionedTextDocumentIdentifier(uri, None if document is None else document.version)
    created = [] if old is not None else [types.CreateFile(uri, options=types.CreateFileOptions(ignore_if_exists=True))]
    return [*created, types.TextDocumentEdit(identifier, [*edits])]
