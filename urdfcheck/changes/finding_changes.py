"""Which findings of two checks are new, gone and unchanged."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import replace

from urdfcheck.core import Finding, Run
from urdfcheck.core.findings import iter_occurrences
from urdfcheck.core.model_diff import FindingsDiff
from urdfcheck.core.records import dataclass

_SUBJECT = re.compile(r"\b(link|joint)\[([^\]]*)\]")

# Model, code, message id and subject.
_Key = tuple[str, str, str, str]


def compare_findings(
    before: Run, after: Run, models: Mapping[str, str], names: Mapping[str, Mapping[tuple[str, str], str]]
) -> FindingsDiff:
    """Compare the findings that count in two runs, subject by subject.

    :param models: id of each unit of the first run → its id in the second.
    :param names: by id of the first run's model: kind and name of each part that has another name in the second → that name.
    """
    olds = list(_iter_keys(before, models, names))
    news = list(_iter_keys(after, {}, {}))
    old_counts, new_counts = Counter(key for key, _ in olds), Counter(key for key, _ in news)
    common = old_counts & new_counts
    unchecked = {info.id for info in after.models if info.not_checked is not None}
    left = old_counts - common
    gone = Counter({key: count for key, count in left.items() if key[0] not in unchecked})
    return FindingsDiff(
        new=_select_surplus(news, new_counts - common),
        gone=_select_surplus(olds, gone),
        unchanged=common.total(),
        unchecked=left.total() - gone.total(),
    )


@dataclass(frozen=True, slots=True)
class _Reported:
    """A subject of a finding."""

    finding: Finding
    model: str
    subject: str


def _iter_keys(
    run: Run, models: Mapping[str, str], names: Mapping[str, Mapping[tuple[str, str], str]]
) -> Iterator[tuple[_Key, _Reported]]:
    """Yield each subject of each finding as the second run would name it."""
    for finding in iter_occurrences(run.active_findings):
        for model, subjects in finding.subjects_by_model.items():
            for subject in subjects:
                shown = _rename_parts(subject, names.get(model, {}))
                message = finding.message_ids.get(subject, finding.message_id)
                yield (models.get(model, model), finding.code, message, shown), _Reported(finding, model, subject)


def _rename_parts(subject: str, names: Mapping[tuple[str, str], str]) -> str:
    return _SUBJECT.sub(lambda m: f"{m[1]}[{names.get((m[1], m[2]), m[2])}]", subject) if names else subject


def _select_surplus(keyed: list[tuple[_Key, _Reported]], surplus: Counter[_Key]) -> tuple[Finding, ...]:
    """Return the findings of the keys that one run has more often, with these subjects alone, in the order of the report."""
    left = Counter(surplus)
    found: dict[tuple[int, str], list[_Reported]] = {}
    for key, reported in keyed:
        if left[key] > 0:
            left[key] -= 1
            found.setdefault((id(reported.finding), reported.model), []).append(reported)
    return tuple(
        replace(group[0].finding, model=model, variants={}, subjects=tuple(reported.subject for reported in group))
        for (_, model), group in found.items()
    )
