"""Does an offered edit repair what it is offered for, and make nothing worse? ``python benchmarks/accuracy/repairs.py``.

Needs ``URDFCHECK_CORPUS``, folders of robots with a ``corpus.json``, separated as in PATH. Each robot is checked, all edits that
are offered are made in a copy of its files (in memory), and the copy is checked again. Edits that make files readable are made
first: what these files show is not blamed on other edits. Edits that overlap, and those of a copy that is worse, are tried one by
one.
"""

from __future__ import annotations

import os

# Matrices of three rows: a pool of threads for each of them only takes the other processes' time.
os.environ.update(dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1"))

import argparse
import json
import statistics
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import urdfcheck
from urdfcheck.core import Applicability, Edit, Finding, Run, Severity
from urdfcheck.fix.fixer import iter_fixable, select_disjoint
from urdfcheck.fix.patch import EditableFiles, EditableText
from urdfcheck.model import Model
from urdfcheck.model.parts import TENSOR_NAMES, Inertial, Link
from urdfcheck.policy.policy import Policy
from urdfcheck.rules import load_rules
from urdfcheck.run.jobs import PackageFolders, Request
from urdfcheck.run.pipeline import IN_THIS_PROCESS, run_audit
from urdfcheck.source.load import load_source
from urdfcheck.source.package.finder import PackageFinder
from urdfcheck.system.files import overlay_files

EVERYWHERE = EditableFiles([Path("/")], [], are_written=False)
OFFERED = (Applicability.SAFE, Applicability.UNSAFE)
# Rules about files; what these show when they are found at last is new, and true.
FILES = ("PKG", "XML")
# Rules whose edits change an inertial.
INERTIAL = ("INR", "SYM003", "SYM004")
IMPOSSIBLE = ("INR003", "INR004")
COLUMNS = ("offered", "gone", "worse", "lost", "refused by MuJoCo", "numbers", "at most", "needless")

# Model, rule and subject of a finding.
Place = tuple[str, str, str]


@dataclass(frozen=True, slots=True, eq=False)
class Offer:
    """The edits of a finding, and the findings that ask for the same ones, one of each model that has the text."""

    edits: tuple[Edit, ...]
    findings: tuple[Finding, ...]

    @property
    def kind(self) -> str:
        first = self.findings[0]
        return f"{first.code} {first.message_id}" + (f": {first.cause.id}" if first.cause else "")


@dataclass(frozen=True, slots=True, kw_only=True)
class Outcome:
    """What became of an offer."""

    kind: str
    subjects: tuple[str, ...]
    is_gone: bool
    """Whether the finding is gone."""
    new: tuple[str, ...]
    """Errors and warnings that came, of the copy with all edits or, if that is worse, of one with these edits."""
    lost: tuple[str, ...]
    """Models that could be checked before."""
    refused: tuple[str, ...]
    """Links whose inertial MuJoCo does not take afterwards."""
    numbers: int
    """Words of the text that change."""
    needless: int
    """Words that change and mean the same, and edits that change nothing."""


@dataclass(frozen=True, eq=False)
class CheckedCopy:
    """A robot whose files may be changed, in memory, and the run on it."""

    request: Request
    run: Run

    @cached_property
    def links(self) -> tuple[Link, ...]:
        """The links of the model that the request names; none if it cannot be read."""
        (path,) = self.request.paths
        packages = self.request.packages
        finder = PackageFinder(path.absolute(), packages.by_name, packages.search_path)
        with overlay_files(self.request.options.texts):
            source = load_source(path, self.request.arguments, finder)
        return () if source.root is None else Model(source=source, robot=source.root, tier="source").links

    def apply_offers(self, offers: Iterable[Offer]) -> CheckedCopy:
        """Check a copy with the edits of some offers."""
        options = self.request.options
        changed = replace(self.request, options=replace(options, texts=apply_edits(offers, options.texts)))
        return CheckedCopy(changed, run_audit(changed, IN_THIS_PROCESS).outcome)


def main() -> None:
    parser = argparse.ArgumentParser(
        prog="python benchmarks/accuracy/repairs.py", description=__doc__.partition("?")[0]
    )
    parser.add_argument("--only", default="", help="robots whose id contains this text")
    parser.add_argument("--cache", type=Path, help="folder of cached results")
    options = parser.parse_args()
    folders = [Path(name) for name in os.environ.get("URDFCHECK_CORPUS", "").split(os.pathsep) if name]
    folders = [folder for folder in folders if (folder / "corpus.json").is_file()]
    if not folders:
        parser.error("URDFCHECK_CORPUS names no folder with a corpus.json")
    found: list[Outcome] = []
    robots = 0
    for folder in folders:
        for name, request in list_requests(folder).items():
            if options.only not in name:
                continue
            robots += 1
            cached = replace(request, cache=options.cache)
            outcomes = try_offers(cached, run_audit(cached, IN_THIS_PROCESS).outcome)
            found += outcomes
            for outcome in outcomes:
                if describe_fault(outcome):
                    print(
                        f"* {name}: {outcome.kind} {', '.join(outcome.subjects)}: {describe_fault(outcome)}", flush=True
                    )
    print(f"\nurdfcheck {urdfcheck.__version__}: {len(found)} offers on {robots} robots.\n\n{format_table(found)}")


def list_requests(folder: Path) -> dict[str, Request]:
    """The robots of a folder with all rules, by id."""
    return {
        entry["id"]: Request(
            paths=(folder / entry["entry"],),
            root=folder,
            policy=Policy(codes=frozenset(load_rules())),
            arguments=entry["xacro_args"],
            packages=PackageFolders({}, tuple(folder / root for root in entry["package_roots"])),
        )
        for entry in json.loads((folder / "corpus.json").read_text(encoding="utf-8"))
        if all((folder / root).is_dir() for root in entry["package_roots"])
    }


def try_offers(request: Request, run: Run, apart: Collection[str] = ()) -> list[Outcome]:
    """Make all edits that the findings of a run offer, and check again.

    ``apart``: codes of rules whose edits are tried one by one, because they are known to make something worse.
    """
    outcomes: list[Outcome] = []
    before = CheckedCopy(request, run)
    offers = collect_offers(run)
    about_files = [offer for offer in offers if offer.findings[0].code.startswith(FILES)]
    if about_files:
        after = before.apply_offers(about_files)
        outcomes += [judge(offer, before, after, new=()) for offer in about_files]
        before = after
        offers = [offer for offer in collect_offers(after.run) if not offer.findings[0].code.startswith(FILES)]
    together = select_disjoint([offer for offer in offers if offer.findings[0].code not in apart])
    waiting = [together] if together else []
    accepted: list[Offer] = []
    while waiting:  # what makes it worse is found by halves
        some = waiting.pop()
        after = before.apply_offers([*accepted, *some])
        is_worse = bool(find_new(before.run, after.run) or find_lost(before.run, after.run))
        if is_worse and len(some) > 1:
            half = len(some) // 2
            waiting += [some[half:], some[:half]]
            continue
        outcomes += [judge(offer, before, after) for offer in some]
        accepted += [] if is_worse else some
    for offer in (offer for offer in offers if offer not in together):
        outcomes.append(judge(offer, before, before.apply_offers([offer])))
    return outcomes


def collect_offers(run: Run) -> list[Offer]:
    """The edits that a run offers, each once."""
    found: dict[tuple[str, tuple[Edit, ...]], list[Finding]] = {}
    for finding, fix in iter_fixable(run, OFFERED):
        found.setdefault((finding.code, fix.edits), []).append(finding)
    return [Offer(edits, tuple(findings)) for (_, edits), findings in found.items()]


def apply_edits(offers: Iterable[Offer], texts: Mapping[str, bytes]) -> dict[str, bytes]:
    """The files after the edits, by real path."""
    files: dict[str, EditableText] = {}
    edits: dict[str, dict[Edit, None]] = {}
    for edit in (edit for offer in offers for edit in offer.edits):
        name = edit.span.file
        if name not in files:
            files[name] = EditableText.read(name, EVERYWHERE, texts)
        files[name].ensure_applicable(edit)
        edits.setdefault(name, {})[edit] = None
    return {**texts, **{files[name].path: files[name].apply_edits(some) for name, some in edits.items()}}


def judge(offer: Offer, before: CheckedCopy, after: CheckedCopy, new: Sequence[str] | None = None) -> Outcome:
    """Compare the copies before and after the edits of an offer. ``new``: what came, if that is not to be looked at."""
    left = {place for place, _ in iter_places(after.run, Severity.INFO)}
    wanted = {place for finding in offer.findings for place in list_places(finding)}
    old, changed = zip(*((edit.expected, edit.replacement) for edit in offer.edits), strict=True)
    numbers = sum(count_changed(a, b) for a, b in zip(old, changed, strict=True))
    needless = sum(count_needless(a, b) for a, b in zip(old, changed, strict=True))
    refused: list[str] = []
    if offer.findings[0].code.startswith(INERTIAL):
        names = {subject.partition("/")[0] for _, _, subject in wanted}
        # What else is wrong with a link is not the matter of a repair, but an impossible tensor is that of its rules.
        is_tensor = offer.findings[0].code.startswith(IMPOSSIBLE)
        known = [] if is_tensor else list_refused(before.links, names)
        refused = [text for text in list_refused(after.links, names) if text not in known]
    return Outcome(
        kind=offer.kind,
        subjects=offer.findings[0].subjects,
        is_gone=not wanted & left,
        new=tuple(find_new(before.run, after.run) if new is None else new),
        lost=tuple(find_lost(before.run, after.run)),
        refused=tuple(refused),
        numbers=numbers,
        needless=needless,
    )


def find_new(before: Run, after: Run) -> list[str]:
    """Errors and warnings of a rule at a place that there were fewer of before."""
    old = Counter(place for place, _ in iter_places(before, Severity.WARNING))
    now = Counter(place for place, _ in iter_places(after, Severity.WARNING))
    texts = dict(iter_places(after, Severity.WARNING))
    return [f"{code} {subject}: {texts[model, code, subject]}" for model, code, subject in now - old]


def find_lost(before: Run, after: Run) -> list[str]:
    """Models that were checked before and are not any more."""
    now = {model.id for model in after.models if model.status == "checked"}
    return [model.id for model in before.models if model.status == "checked" and model.id not in now]


def iter_places(run: Run, least: Severity) -> Iterator[tuple[Place, str]]:
    """The places of active findings of a severity or above, with the message."""
    for finding in run.active_findings:
        for own in finding.list_occurrences():
            if own.severity >= least and not own.is_about_urdfcheck:
                yield from ((place, own.message) for place in list_places(own))


def list_places(finding: Finding) -> list[Place]:
    """Model, rule and subject of everything that a finding is about."""
    return [(m, finding.code, subject) for m, subjects in finding.subjects_by_model.items() for subject in subjects]


def count_changed(old: str, new: str) -> int:
    """How many words change."""
    words, others = old.split(), new.split()
    if len(words) != len(others):
        return max(len(words), len(others), 1)
    return sum(a != b for a, b in zip(words, others, strict=True))


def count_needless(old: str, new: str) -> int:
    """How many words change that mean the same number, or 1 for an edit that changes nothing."""
    words, others = old.split(), new.split()
    if old == new:
        return 1
    if len(words) != len(others):
        return 0
    return sum(a != b and is_same_number(a, b) for a, b in zip(words, others, strict=True))


def is_same_number(one: str, other: str) -> bool:
    """Whether two words are one number."""
    try:
        return float(one) == float(other)
    except ValueError:
        return False


def list_refused(links: Iterable[Link], names: Collection[str]) -> list[str]:
    """The links among these (``link[arm]``) whose inertial MuJoCo refuses at the end of a hinge, with its message."""
    import mujoco

    refused: list[str] = []
    for link in links:
        if f"link[{link.name}]" in names and link.inertial is not None:
            try:
                mujoco.MjModel.from_xml_string(format_hinged(link.inertial))
            except ValueError as error:
                refused.append(f"{link.name}: {str(error).splitlines()[0]}")
    return refused


def format_hinged(inertial: Inertial) -> str:
    """A robot whose one moving link has an inertial."""
    xyz, rpy = inertial.origin.xyz or (0, 0, 0), inertial.origin.rpy or (0, 0, 0)
    six = zip(TENSOR_NAMES, inertial.inertia_components or (), strict=False)
    tensor = " ".join(f'{name}="{value!r}"' for name, value in six)
    return (
        '<robot name="r"><link name="base"/><joint name="j" type="continuous"><parent link="base"/><child link="part"/>'
        '<axis xyz="0 0 1"/></joint><link name="part"><inertial>'
        f'<origin xyz="{" ".join(map(repr, xyz))}" rpy="{" ".join(map(repr, rpy))}"/>'
        f'<mass value="{inertial.mass!r}"/><inertia {tensor}/></inertial></link></robot>'
    )


def describe_fault(outcome: Outcome) -> str:
    """What is wrong with an offer; empty if it is right."""
    faults = [] if outcome.is_gone else ["the finding is still there"]
    faults += [f"new: {text}" for text in outcome.new]
    faults += [f"not checked any more: {model}" for model in outcome.lost]
    faults += [f"MuJoCo refuses {text}" for text in outcome.refused]
    faults += [f"{outcome.needless} needless changes"] if outcome.needless else []
    return "; ".join(faults)


def format_table(found: Iterable[Outcome]) -> str:
    """A line for each kind of offer."""
    kinds: dict[str, list[Outcome]] = {}
    for outcome in found:
        kinds.setdefault(outcome.kind, []).append(outcome)
        kinds.setdefault("~all", []).append(outcome)
    lines = [f"| repair | {' | '.join(COLUMNS)} |", "|---|" + "---|" * len(COLUMNS)]
    for kind in sorted(kinds):
        some = kinds[kind]
        numbers = [outcome.numbers for outcome in some]
        cells = [
            len(some),
            sum(outcome.is_gone for outcome in some),
            sum(bool(outcome.new) for outcome in some),
            sum(bool(outcome.lost) for outcome in some),
            sum(bool(outcome.refused) for outcome in some),
            f"{statistics.median(numbers):g}",
            max(numbers),
            sum(outcome.needless for outcome in some),
        ]
        lines.append(f"| {kind.removeprefix('~')} | {' | '.join(map(str, cells))} |")
    return "\n".join(lines)


if __name__ == "__main__":
    main()
