"""The robots of the folders that URDFCHECK_CORPUS names, each checked once for all tests that ask about it.

The errors of every robot are compared with the accepted ones in every run. Tests that repeat one claim for each robot or mesh
take some of each kind (`select_by_trait`); with ``URDFCHECK_FULL=1`` they take all, which takes minutes more.
"""

from __future__ import annotations

import contextlib
import gc
import hashlib
import inspect
import io
import json
import pickle
from collections import Counter
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import pytest
from conftest import IS_FULL, get_shared_folder, make_request
from filelock import FileLock, Timeout

import urdfcheck
from urdfcheck.core import FactUnavailableError, Finding, Rule, Run
from urdfcheck.core.findings import iter_occurrences
from urdfcheck.model import Model
from urdfcheck.model.motion.pinocchio_model import pinocchio_model
from urdfcheck.policy.config import TARGETS
from urdfcheck.rules import has_check, load_check, load_rules
from urdfcheck.run import pipeline, unit_audit
from urdfcheck.run.findings import FinalFindings
from urdfcheck.run.jobs import PackageFolders, Request, Unit
from urdfcheck.run.pipeline import IN_THIS_PROCESS, run_audit
from urdfcheck.simulators.engine_input import build_input
from urdfcheck.simulators.outcome import EngineInput
from urdfcheck.simulators.processes import ENGINES
from urdfcheck.source.load import Source, load_source
from urdfcheck.source.package.finder import PackageFinder

# One expands only in its own folder, because its includes are relative to the working directory; the other is part of a robot,
# through which it is checked.
STARTED_ELSEWHERE = {"kosakanishkdev/ROS:robot", "ArpitSrivastavaIN/rovermk2_description:B2_mark_sensors"}
# The engines that a configuration can name.
TARGETED = tuple(engine for engine in ENGINES if engine in TARGETS)

T = TypeVar("T")
# Rule, model, subject and message id: what the fingerprint of a finding is made of.
Defect = tuple[str, str, str, str]


def list_robots(folder: Path) -> list[dict[str, Any]]:
    """The entries of ``corpus.json`` that can be checked as they lie there.

    Left out: `STARTED_ELSEWHERE`, and robots of which a package was not collected.
    """
    entries: list[dict[str, Any]] = json.loads((folder / "corpus.json").read_text(encoding="utf-8"))
    return [
        entry
        for entry in entries
        if entry["id"] not in STARTED_ELSEWHERE and all((folder / root).is_dir() for root in entry["package_roots"])
    ]


def list_repositories(folder: Path) -> list[Path]:
    """The repositories in a folder without a ``corpus.json``."""
    return sorted(path for path in folder.iterdir() if path.is_dir())


def list_requests(folder: Path) -> dict[str, Request]:
    """What a folder holds, by name: robots with all rules, or repositories as ``urdfcheck .`` checks them."""
    if not (folder / "corpus.json").is_file():
        return {path.name: make_request(path, root=path) for path in list_repositories(folder)}
    return {
        entry["id"]: make_request(
            folder / entry["entry"],
            root=folder,
            arguments=entry["xacro_args"],
            package_paths=tuple(folder / root for root in entry["package_roots"]),
        )
        for entry in list_robots(folder)
    }


def select_by_trait(
    items: Iterable[T], list_traits: Callable[[T], Iterable[Hashable]], *, times: int = 1, is_full: bool = IS_FULL
) -> list[T]:
    """Select items, in their order, until each trait is that of ``times`` selected ones, or of all that have it."""
    seen: Counter[Hashable] = Counter()
    selected = []
    for item in items:
        traits = set(list_traits(item))
        if is_full or any(seen[trait] < times for trait in traits):
            selected.append(item)
            seen.update(traits)
    return selected


@dataclass(frozen=True)
class CheckedRobot:
    """A run of a request of `list_requests`, the defects that its checks report one by one, what it finds for all engines as
    targets, and its models as engines get them, by id; None for what is no robot. Last, by id of each model that has dynamics:
    what Pinocchio says of its frames, empty if it has the same."""

    run: Run
    reported: frozenset[Defect]
    for_engines: tuple[Finding, ...]
    inputs: Mapping[str, EngineInput | None]
    frames: Mapping[str, str]


def check_robots(folder: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, CheckedRobot]:
    """Check what a folder holds, by name; what another test or process has checked is read, and what another is about to
    check comes last."""
    cache = get_robot_cache(tmp_path_factory)
    kept = cache.parent
    kept.mkdir(exist_ok=True)
    files = {name: kept / hashlib.sha256(f"{folder} {name}".encode()).hexdigest() for name in list_requests(folder)}
    done: set[str] = set()
    for seconds in (0, -1):
        for name, request in list_requests(folder).items():
            if name in done:
                continue
            with contextlib.suppress(Timeout), FileLock(f"{files[name]}.lock", timeout=seconds):
                if not files[name].exists():
                    write_checked(check_robot(replace(request, cache=cache)), files[name])
                    gc.collect()  # models refer to themselves: without it a process keeps 12 MB of each
                done.add(name)
    return {name: read_checked(file) for name, file in files.items()}


class CheckedRobotPickler(pickle.Pickler):
    """Writes rules by their codes: each run has all of them, which would be nine tenths of what is written."""

    def persistent_id(self, thing: object) -> str | None:
        """Return the code of a rule of this process."""
        return thing.code if isinstance(thing, Rule) and load_rules().get(thing.code) is thing else None


class CheckedRobotUnpickler(pickle.Unpickler):
    """Reads what `CheckedRobotPickler` writes."""

    def persistent_load(self, code: str) -> Rule:
        """Return the rule of a code."""
        return load_rules()[code]


def write_checked(robot: CheckedRobot, file: Path) -> None:
    """Write a robot whole or not at all."""
    data = io.BytesIO()
    CheckedRobotPickler(data).dump(robot)
    file.with_suffix(".new").write_bytes(data.getvalue())
    file.with_suffix(".new").replace(file)


def read_checked(file: Path) -> CheckedRobot:
    """Read what `write_checked` wrote."""
    robot: CheckedRobot = CheckedRobotUnpickler(io.BytesIO(file.read_bytes())).load()
    return robot


def get_robot_cache(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the cache of all checks of real robots."""
    return get_shared_folder(tmp_path_factory) / "robots" / "cache"


def check_robot(request: Request) -> CheckedRobot:
    """Check what a request leads to. Between the two runs nothing changes: models are looked for and expanded once, and their
    facts, which do not depend on the targets (`list_rules_for_targets`), are computed once."""
    reading, deciding = list_rules_for_targets()
    policy = replace(request.policy, targets=TARGETED, codes=deciding)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(pipeline, "discover_targets", once(pipeline.discover_targets))
        patch.setattr(unit_audit, "load_source", once(unit_audit.load_source))
        patch.setattr(unit_audit, "Model", models := KnownModels())
        with record_reported() as reported:
            audited = run_audit(request, IN_THIS_PROCESS)
        again = run_audit(replace(request, policy=policy), IN_THIS_PROCESS).outcome
    found = [f for f in audited.outcome.findings if f.code not in reading]
    found += [f for f in again.findings if f.code in reading]
    ids = {model.id for model in audited.outcome.models}
    inputs = {
        unit.id: build_known_input(unit, models) or read_unit(unit, request)
        for unit in audited.units
        if unit.kind == "model" and unit.id in ids
    }
    frames = {
        unit.id: difference
        for unit in audited.units
        if unit.kind == "model" and unit.id in ids and (model := models.find(unit)) is not None
        if (difference := compare_frames(model)) is not None
    }
    return CheckedRobot(audited.outcome, frozenset(reported), tuple(found), inputs, frames)


class KnownModels:
    """Makes models as `Model` does. The second of one source, for other targets, knows what was computed of the first."""

    def __init__(self) -> None:
        self.by_source: dict[int, Model] = {}

    def __call__(self, *, source: Source, targets: tuple[str, ...], **more: Any) -> Model:
        known = self.by_source.get(id(source))
        if known is None:
            known = self.by_source[id(source)] = Model(source=source, targets=targets, **more)
            return known
        assert known.robot is more["robot"]
        model = Model(source=source, targets=targets, **more)
        vars(model).update({name: value for name, value in vars(known).items() if name not in {"targets", "cache"}})
        return model

    def find(self, unit: Unit) -> Model | None:
        """Return the model that was made of a unit; None where a launch file decides about it, which engines do not read."""
        found = (m for m in self.by_source.values() if m.source.path == Path(unit.path))
        same = (m for m in found if not m.source.found_arguments and m.source.arguments == unit.arguments)
        return None if unit.launches else next(same, None)


def compare_frames(model: Model) -> str | None:
    """What differs between the frames of a model and those of Pinocchio, empty if nothing does; None for a model without
    dynamics."""
    try:
        built = pinocchio_model(model)
        if built.model is None:
            return f"Pinocchio refuses it: {built.messages}"
        assert_frames_of_pinocchio(model)
    except FactUnavailableError:
        return None
    except AssertionError as error:
        return str(error)
    return ""


def assert_frames_of_pinocchio(model: Model) -> int:
    """Compare the frames of a model with those of Pinocchio, which must load it; return their number."""
    import pinocchio

    built = pinocchio_model(model).model
    data = built.createData()
    pinocchio.framesForwardKinematics(built, data, pinocchio.neutral(built))
    for name, placed in model.frames.items():
        theirs = data.oMf[built.getFrameId(name, pinocchio.FrameType.BODY)]
        np.testing.assert_allclose(placed[:3, :3], theirs.rotation, atol=1e-9, err_msg=name)
        np.testing.assert_allclose(placed[:3, 3], theirs.translation, atol=1e-9, err_msg=name)
    return len(model.frames)


def build_known_input(unit: Unit, models: KnownModels) -> EngineInput | None:
    """A model as engines get it, of what a run has expanded already."""
    model = models.find(unit)
    return None if model is None else build_input(model.source, model)


def read_unit(unit: Unit, request: Request) -> EngineInput | None:
    """A model as engines get it; its files are read again."""
    return read_input(Path(unit.path), unit.arguments, unit.packages or request.packages, xacro=unit.is_xacro)


@contextlib.contextmanager
def record_reported() -> Iterator[set[Defect]]:
    """Record what the checks of units report before anything is merged; for runs in this process."""
    reported: set[Defect] = set()
    finalize = unit_audit.finalize_unit_findings

    def record(findings: Iterable[Finding], **settings: Any) -> FinalFindings:
        findings = list(findings)
        reported.update(list_defects(findings))
        return finalize(findings, **settings)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(unit_audit, "finalize_unit_findings", record)
        yield reported


def list_defects(findings: Iterable[Finding]) -> set[Defect]:
    """List the defects that findings are about."""
    return {
        (finding.code, model, subject, finding.message_ids.get(subject, finding.message_id))
        for finding in findings
        for model, subjects in finding.subjects_by_model.items()
        for subject in subjects
    }


def find_lost_defects(reported: Iterable[Defect], run: Run) -> set[Defect]:
    """Find the defects that the findings of a run do not have.

    Left out are those that a stronger rule hides on the element or explains, and those of files that turned out to be parts of
    a model.
    """
    told = list_defects(run.findings)
    explained = {
        (claim, model)
        for finding in iter_occurrences(run.findings)
        for model in finding.subjects_by_model
        for claim in finding.data.get("explains", ())
    }
    elements = {(code, model, subject.partition("]")[0]) for code, model, subject, _ in told}
    rules = load_rules()
    return {
        defect
        for defect in set(reported) - told
        if defect[1] in run.unit_ids
        and not any((code, defect[1], defect[2].partition("]")[0]) in elements for code in rules[defect[0]].hidden_by)
        and (f"{defect[0]} {defect[2].partition(']')[0]}]", defect[1]) not in explained
    }


def once(function: Callable[..., T]) -> Callable[..., T]:
    """The function, called once for the same words; finders of packages are the same for the same path."""
    known: dict[str, T] = {}

    def call(*words: object, **more: object) -> T:
        key = repr([[word for word in words if not isinstance(word, PackageFinder)], sorted(more.items())])
        if key not in known:
            known[key] = function(*words, **more)
        return known[key]

    return call


@cache
def list_rules_for_targets() -> tuple[frozenset[str], frozenset[str]]:
    """Codes of the rules that find other things for other targets, and of all that decide about them: whose checks read the
    targets, with those that give way to them, and those that all of these give way to."""
    rules = {rule.code: rule for rule in load_rules().values() if has_check(rule)}
    modules = {code: Path(inspect.getfile(load_check(rule))) for code, rule in rules.items()}
    rooms = (room for room in Path(urdfcheck.__file__).parent.iterdir() if room.name != "run")  # which hands them on
    files = (file for room in rooms for file in room.rglob("*.py"))
    readers = {file for file in files if "model.targets" in file.read_text(encoding="utf-8")}
    assert readers <= set(modules.values()), "a module that is no check reads the targets of the model"
    reading = {code for code, path in modules.items() if path in readers}
    reading |= {code for code, rule in rules.items() if reading & set(rule.hidden_by)}
    deciding = set(reading)
    while more := {other for code in deciding for other in rules[code].hidden_by} - deciding:
        deciding |= more
    return frozenset(reading), frozenset(deciding)


def read_input(
    path: Path, arguments: Mapping[str, str], packages: PackageFolders, **reading: bool
) -> EngineInput | None:
    """A model as engines get it."""
    finder = PackageFinder(path.absolute(), packages.by_name, packages.search_path)
    source = load_source(path, arguments, finder, **reading)
    is_robot = source.root is not None and source.root.tag == "robot"
    return build_input(source, Model(source=source, robot=source.root, tier="mesh") if is_robot else None)
