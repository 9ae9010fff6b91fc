"""The baseline: a file of accepted findings, so that a team sees only new ones.

An entry is what the fingerprint of a finding is made of: the model's id, the code, the subject and the message id. Neither a
moved line nor another working directory changes it. Where the rule measures how bad a finding is, the entry has the number: what
has become much worse is reported again. A line for each entry, in a fixed order: the file is reviewed, and merged.
"""

from __future__ import annotations

import contextlib
import json
import math
import os
import re
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import field, replace
from pathlib import Path
from typing import Any

from urdfcheck.core import Finding, Location, ModelInfo, SkippedCheck, Span, UrdfcheckError
from urdfcheck.core.findings import iter_occurrences
from urdfcheck.core.records import dataclass
from urdfcheck.rules import load_rules
from urdfcheck.source.package.finder import format_path
from urdfcheck.source.reach import OUT_OF_REACH, FileReach, is_below, resolve_real_path
from urdfcheck.system.files import read_regular

# Its default name, beside the configuration.
DEFAULT_NAME = "urdfcheck-baseline.json"
SCHEMA = "urdfcheck-baseline/1"
# The rule about entries whose finding is gone.
STALE_BASELINE = "URC904"
MAX_FILE_SIZE = 64 * 1024**2
# Bound of an entry's count: more than the largest model has elements.
MAX_COUNT = 10**6
# Digits of an excess in the file.
_DIGITS = 4

EntryKey = tuple[str, str, str]
_ARGUMENTS = re.compile(r" [^\s=:]+:=.*", re.DOTALL)


@dataclass(frozen=True, slots=True)
class Baseline:
    """A baseline file that was read."""

    path: Path
    root: Path
    """Folder that the ids of models are relative to."""
    text: str = ""
    """Content of the file."""
    models: Mapping[str, Mapping[EntryKey, int]] = field(default_factory=dict)
    """Model id → (code, subject, message id) → how often it is accepted."""
    excesses: Mapping[str, Mapping[EntryKey, float]] = field(default_factory=dict)
    """Model id → how bad what is accepted of it is at most, where a rule measures it: see `Finding.excess`."""
    launched: Mapping[str, tuple[str, ...]] = field(init=False, compare=False)
    """File → the models that it makes with arguments."""

    def __post_init__(self) -> None:
        launched: dict[str, tuple[str, ...]] = {}
        for model in self.models:
            if (file := _ARGUMENTS.sub("", model)) != model:
                launched[file] = (*launched.get(file, ()), model)
        object.__setattr__(self, "launched", launched)

    def get_entries(self, model: str) -> Mapping[EntryKey, int]:
        """Return the entries of a model: how often each is accepted.

        A file is checked with the arguments of its launch file where that is seen, and without any where a hook names it
        alone: the entries of the one hold for the other, unless it has its own.
        """
        entries: Counter[EntryKey] = Counter()
        for name in self._list_names(model):
            entries |= Counter(self.models[name])
        return entries

    def get_excesses(self, model: str) -> Mapping[EntryKey, float]:
        """Return how bad the accepted findings of a model are at most, where that is known."""
        excesses: dict[EntryKey, float] = {}
        for name in self._list_names(model):
            raise_excesses(excesses, self.excesses.get(name, {}).items())
        return excesses

    def _list_names(self, model: str) -> tuple[str, ...]:
        """Return the models whose entries hold for a model."""
        if model in self.models:
            return (model,)
        file = _ARGUMENTS.sub("", model)
        if file == model:
            return self.launched.get(file, ())
        return (file,) if file in self.models else ()

    @property
    def size(self) -> int:
        """Number of findings that it accepts."""
        return sum(sum(entries.values()) for entries in self.models.values())


def read_baseline(path: Path, root: Path) -> Baseline:
    """Read a baseline file.

    :raises UrdfcheckError: if it cannot be read or is not a baseline.
    """
    name = format_path(path)
    try:
        text = read_regular(path, MAX_FILE_SIZE).decode("utf-8")
        found = json.loads(text)
    except OSError as error:
        hint = "; urdfcheck baseline write creates one" if isinstance(error, FileNotFoundError) else ""
        raise UrdfcheckError(f"{name}: cannot read the baseline: {error.strerror or error}{hint}") from None
    except json.JSONDecodeError as error:
        raise UrdfcheckError(f"{name}:{error.lineno}: not a baseline: {error.msg}") from None
    except (ValueError, RecursionError) as error:
        raise UrdfcheckError(f"{name}: not a baseline: {error}") from None
    if not isinstance(found, dict) or found.get("schema") != SCHEMA:
        raise UrdfcheckError(f"{name}: not a baseline: its schema is not {SCHEMA}")
    try:
        return Baseline(
            path=path,
            root=root,
            text=text,
            models={model: _parse_entries(rows) for model, rows in found["models"].items()},
            excesses={model: _parse_excesses(rows) for model, rows in found["models"].items()},
        )
    except (AttributeError, KeyError, OverflowError, TypeError, ValueError):
        raise UrdfcheckError(f"{name}: not a baseline: write it again with urdfcheck baseline write") from None


def read_found_baseline(path: Path, root: Path) -> Baseline | None:
    """Read a baseline that the command line does not name and a stranger may have written; None where there is none.

    :raises UrdfcheckError: as `read_baseline`, and for one that a link leads to from the folder ``root`` or its repository.
    """
    if not path.is_file():
        return None
    if not FileReach.from_paths([root], []).can_open(path):
        raise UrdfcheckError(f"{format_path(path)}: {OUT_OF_REACH}, or is named with --baseline")
    return read_baseline(path, root)


def _parse_entries(rows: Any) -> Counter[EntryKey]:
    entries: Counter[EntryKey] = Counter()
    for row in rows:
        key, count = (row["code"], row["subject"], row["message"]), row.get("count", 1)
        if not all(isinstance(part, str) for part in key) or type(count) is not int or not 1 <= count <= MAX_COUNT:
            raise ValueError(row)
        entries[key] += count
    return entries


def _parse_excesses(rows: Any) -> dict[EntryKey, float]:
    excesses: dict[EntryKey, float] = {}
    for row in rows:
        excess = row.get("excess")
        if excess is None:
            continue
        if isinstance(excess, bool) or not isinstance(excess, (int, float)) or not math.isfinite(excess):
            raise ValueError(row)
        raise_excesses(excesses, [((row["code"], row["subject"], row["message"]), excess)])
    return excesses


def raise_excesses(excesses: dict[EntryKey, float], more: Iterable[tuple[EntryKey, float]]) -> None:
    """Add how bad entries are to what is known of them: of one entry the worst counts."""
    for key, excess in more:
        excesses[key] = max(excess, excesses.get(key, -math.inf))


def render_baseline(
    models: Mapping[str, Mapping[EntryKey, int]], excesses: Mapping[str, Mapping[EntryKey, float]]
) -> str:
    """Render a baseline file. ``excesses``: of the entries, and possibly of others."""
    blocks = []
    for model, entries in sorted(models.items()):
        rows = []
        for key, count in sorted(entries.items()):
            row: dict[str, Any] = dict(zip(("code", "subject", "message"), key, strict=True))
            excess = excesses.get(model, {}).get(key)
            row |= {} if excess is None else {"excess": float(f"{excess:.{_DIGITS}g}")}
            rows.append("      " + json.dumps(row | ({"count": count} if count > 1 else {}), ensure_ascii=False))
        if rows:
            blocks.append(f"    {json.dumps(model, ensure_ascii=False)}: [\n" + ",\n".join(rows) + "\n    ]")
    body = "{\n" + ",\n".join(blocks) + "\n  }" if blocks else "{}"
    return f'{{\n  "schema": "{SCHEMA}",\n  "models": {body}\n}}\n'


def collect_entries(findings: Iterable[Finding]) -> dict[str, Counter[EntryKey]]:
    """Return the entries that accept these findings, without those that are suppressed otherwise."""
    models: dict[str, Counter[EntryKey]] = {}
    for finding in iter_occurrences(findings):
        if not is_baseline_candidate(finding):
            continue
        for model, subjects in finding.subjects_by_model.items():
            for subject in subjects:
                message = finding.message_ids.get(subject, finding.message_id)
                models.setdefault(model, Counter())[finding.code, subject, message] += 1
    return models


def collect_excesses(findings: Iterable[Finding]) -> dict[str, dict[EntryKey, float]]:
    """Return how bad what these findings are about is at most, by model and entry, where their rules measure it."""
    models: dict[str, dict[EntryKey, float]] = {}
    for finding in iter_occurrences(findings):
        if not math.isfinite(finding.excess):
            continue
        for model, entries in collect_entries([finding]).items():
            raise_excesses(models.setdefault(model, {}), ((key, finding.excess) for key in entries))
    return models


def is_baseline_candidate(finding: Finding) -> bool:
    """Whether a baseline accepts a finding, or could.

    It does not if the finding is about urdfcheck itself, is why nothing is known of its model, or is suppressed otherwise.
    """
    is_candidate = finding.suppressed is None or finding.suppressed.kind == "baseline"
    return is_candidate and not finding.is_about_urdfcheck and not finding.blocks_check


@dataclass(frozen=True, slots=True, kw_only=True)
class BaselineView:
    """What a run reports on the models of one baseline, under the names that the baseline has for them."""

    findings: Sequence[Finding]
    models: Sequence[ModelInfo]
    complete_rules: Mapping[str, Collection[str]]
    """See :class:`~urdfcheck.core.Run`."""
    skipped: Sequence[SkippedCheck]
    tier: str = "full"
    """How much was computed."""

    def select_models(self, names: Mapping[str, str]) -> BaselineView:
        """Return the part about these models, under these names."""
        return BaselineView(
            findings=[
                replace(f, model=names[f.model], variants={names[m]: s for m, s in f.variants.items() if m in names})
                for f in iter_occurrences(self.findings)
                if f.model in names
            ],
            models=[replace(info, id=names[info.id]) for info in self.models if info.id in names],
            complete_rules={names[model]: codes for model, codes in self.complete_rules.items() if model in names},
            skipped=[replace(skip, model=names[skip.model]) for skip in self.skipped if skip.model in names],
            tier=self.tier,
        )


def find_stale_entries(baseline: Baseline, view: BaselineView) -> dict[str, Counter[EntryKey]]:
    """Return the entries whose finding is gone, by model.

    Without a check a finding is not known to be gone; at a lower tier a rule may report the same with another message. Entries
    of a model whose file no longer exists are always stale.
    """
    there = collect_entries(view.findings)
    checked = set(view.complete_rules).difference(info.id for info in view.models if info.status != "checked")
    met = set(view.complete_rules).union(info.id for info in view.models)
    blind = {(skip.model, skip.code) for skip in view.skipped}
    gone: dict[str, Counter[EntryKey]] = {}
    for model, entries in baseline.models.items():
        if model in checked and (model, "ALL") not in blind:
            left = Counter(entries) - there.get(model, Counter())
            rest = Counter(
                {k: n for k, n in left.items() if k[0] in view.complete_rules[model] and (model, k[0]) not in blind}
            )
            if view.tier != "full":
                same = {key[:2] for key in there.get(model, ())}
                rest = Counter({k: n for k, n in rest.items() if k[:2] not in same})
        elif model not in met and _is_gone(baseline.root, _ARGUMENTS.sub("", model)):
            rest = Counter(entries)
        else:
            continue
        if rest:
            gone[model] = rest
    return gone


def _is_gone(root: Path, name: str) -> bool:
    """Whether a file of the folder does not exist. Paths outside are not probed: the baseline may be a stranger's."""
    real = resolve_real_path(root / name)
    return real is not None and is_below(real, os.path.realpath(root)) and not os.path.lexists(real)


def report_stale_entries(baseline: Baseline, stale: Mapping[str, Mapping[EntryKey, int]]) -> Iterator[Finding]:
    """Yield a finding URC904 for each model with stale entries, at the first of them."""
    rule = load_rules()[STALE_BASELINE]
    spans = _locate_entries(baseline)
    for model, entries in stale.items():
        first, *others = sorted(entries)
        more = f" and {len(others)} more" if others else ""
        span = spans.get((model, first), Span(format_path(baseline.path), 1, 1, 1, 1, 0, 0))
        found = rule.finding(
            "stale",
            at=Location(f"baseline[{model}]", span),
            known=model,
            entry=f"{first[0]} of {first[1]}{more}",
            number=sum(entries.values()),
            findings="finding" if sum(entries.values()) == 1 else "findings",
            are="is" if sum(entries.values()) == 1 else "are",
        )
        yield replace(found, model=model)


def _locate_entries(baseline: Baseline) -> dict[tuple[str, EntryKey], Span]:
    """Return the places of entries that are written as `render_baseline` does, one per line."""
    name, model, offset = format_path(baseline.path), "", 0
    found: dict[tuple[str, EntryKey], Span] = {}
    for number, line in enumerate(baseline.text.split("\n"), 1):
        text = line.strip().rstrip(",")
        with contextlib.suppress(ValueError, KeyError, TypeError):
            if text.endswith(": ["):
                model = json.loads(text.removesuffix(": ["))
            elif text.startswith("{") and model:
                row, column = json.loads(text), line.index("{")
                span = Span(
                    name,
                    number,
                    column + 1,
                    number,
                    column + len(text) + 1,
                    offset + column,
                    offset + column + len(text),
                )
                found.setdefault((model, (row["code"], row["subject"], row["message"])), span)
        offset += len(line) + 1
    return found


def remove_stale_entries(
    baseline: Baseline, stale: Mapping[str, Mapping[EntryKey, int]]
) -> dict[str, Counter[EntryKey]]:
    """Return the entries without the stale ones."""
    return {model: Counter(entries) - Counter(stale.get(model, {})) for model, entries in baseline.models.items()}


def renew_entries(baseline: Baseline, view: BaselineView) -> dict[str, Counter[EntryKey]]:
    """Return the entries after a run: those of its findings, and the old ones of what it did not check, if the file exists."""
    left, there = remove_stale_entries(baseline, find_stale_entries(baseline, view)), collect_entries(view.findings)
    return {model: left.get(model, Counter()) | there.get(model, Counter()) for model in {**left, **there}}


def renew_excesses(baseline: Baseline, view: BaselineView) -> dict[str, dict[EntryKey, float]]:
    """Return how bad the entries after a run are: as it found them, and as they were where it did not check them."""
    there = collect_excesses(view.findings)
    return {m: {**baseline.excesses.get(m, {}), **there.get(m, {})} for m in {**baseline.excesses, **there}}
