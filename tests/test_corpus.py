"""Real robots: nothing crashes, what upstream broke is named, and a change brings no new error on a vendor's model.

Runs where URDFCHECK_CORPUS names a folder with a corpus.json, or one of whole repositories. The error-level findings were read
one by one; a new one is either true, then it is added to ``corpus_errors.json`` (``--accept``), or a false alarm, which is a bug.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

import pytest
from conftest import CORPORA, REPOSITORY, check_text
from real_robots import (
    CheckedRobot,
    check_robots,
    find_lost_defects,
    list_robots,
    read_checked,
    select_by_trait,
    write_checked,
)

from urdfcheck.core import Run, Severity
from urdfcheck.core.findings import iter_occurrences
from urdfcheck.core.headlines import LONGEST_HEADLINE
from urdfcheck.rules import load_rules

ACCEPTED = REPOSITORY / "tests" / "corpus_errors.json"

# Rules whose verdict needs no judgement may not fire but where the odd one was looked at and is one.
SIBLINGS_ARE_CONSISTENT = ("SYM001", "SYM002", "SYM003")
ODD = {
    ("FanFeast/Quadruped_Robot:quadf", "SYM001"),  # a leg's frame is turned, and all that hangs on it
    ("FanFeast/Quadruped_Robot:quadf_-_Copy", "SYM001"),
    ("Daniella1/urdf_files_dataset:clearpathTurtleBot2", "SYM003"),  # a plate with ten times the mass of the others
    ("Daniella1/urdf_files_dataset:r2_left_forearm", "SYM001"),  # infos about two fingers
}


@pytest.fixture(scope="module")
def robots(corpus: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, CheckedRobot]:
    return check_robots(corpus, tmp_path_factory)


@pytest.fixture(scope="module")
def runs(robots: dict[str, CheckedRobot]) -> dict[str, Run]:
    return {name: robot.run for name, robot in robots.items()}


def test_nothing_crashes(runs: dict[str, Run]) -> None:
    assert {name: r.failures for name, r in runs.items() if r.failures} == {}


def test_merging_loses_no_defect(robots: dict[str, CheckedRobot]) -> None:
    lost = {name: find_lost_defects(robot.reported, robot.run) for name, robot in robots.items()}
    assert {name: some for name, some in lost.items() if some} == {}


def test_frames_are_those_of_pinocchio(robots: dict[str, CheckedRobot]) -> None:
    compared = {f"{name}: {model}": said for name, robot in robots.items() for model, said in robot.frames.items()}
    assert {name: said for name, said in compared.items() if said} == {}
    assert sum(bool(robot.frames) for robot in robots.values()) > 0.75 * len(robots)


def test_one_kind_of_mistake_is_one_finding(runs: dict[str, Run]) -> None:
    """Few findings share rule, message, file and models with another: those differ in cause, or in what repairs them."""
    urgent = [f for run in runs.values() for f in run.active_findings if f.severity > Severity.INFO]
    places = list(iter_occurrences(urgent))
    kinds = {
        (name, f.code, f.message_id, f.location.file, *f.subjects_by_model)
        for name, run in runs.items()
        for f in run.active_findings
        if f.severity > Severity.INFO
    }
    assert len(urgent) < 1.1 * len(kinds)
    assert len(urgent) < 0.8 * len(places)


def test_headlines_fit_into_a_line(runs: dict[str, Run]) -> None:
    headlines = {f.headline for outcome in runs.values() for f in outcome.findings}
    assert not [text for text in headlines if not 0 < len(text) <= LONGEST_HEADLINE or text != " ".join(text.split())]


def test_what_does_not_expand_is_a_located_finding(runs: dict[str, Run], corpus: Path) -> None:
    """An undeclared prefix is a warning: the reference parser does not mind it. What only this machine lacks is an info that
    keeps the model from being checked. The rest are errors."""
    broken = [e for e in list_robots(corpus) if not e["expands"]]
    if not broken:
        pytest.skip("all robots of this folder expand")
    for entry in broken:
        outcome = runs[entry["id"]]
        naming = [f for f in outcome.findings if f.code in {"XML001", "XML009", "XAC001", "XAC010", "XAC011", "PKG001"}]
        assert any(f.severity >= Severity.WARNING or f.blocks_check for f in naming), entry["id"]
        assert all(f.location.span is not None for f in naming), entry["id"]


def test_what_expands_is_checked(runs: dict[str, Run], corpus: Path) -> None:
    for entry in list_robots(corpus):
        if entry["expands"] and entry.get("urdf_links"):
            # The models that include a named file are checked as well.
            name = Path(entry["entry"]).name
            (info,) = (model for model in runs[entry["id"]].models if Path(model.path).name == name)
            assert (info.status, info.links, info.joints) == ("checked", entry["urdf_links"], entry["urdf_joints"])


def test_consistent_siblings_give_no_finding(runs: dict[str, Run]) -> None:
    found = [
        (name, f.code, f.message)
        for name, r in runs.items()
        for f in r.findings
        if f.code in SIBLINGS_ARE_CONSISTENT and (name, f.code) not in ODD
    ]
    assert found == []


def test_every_error_was_read_and_is_true(runs: dict[str, Run], corpus: Path, request: pytest.FixtureRequest) -> None:
    """By folder and id: two folders may hold different robots under one id. Some errors on the robots of ``judged`` were judged
    false; they are accepted until they are mended."""
    compare_with_accepted(corpus.name, runs, accept=request.config.getoption("--accept"))


@pytest.mark.parametrize(
    "folder", [f for f in CORPORA if not (f / "corpus.json").is_file()], ids=lambda folder: folder.name
)
def test_repositories_are_checked_as_they_come(
    folder: Path, request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> None:
    """As ``urdfcheck .`` does it in each; a model that is not checked is an error at its cause."""
    runs = {name: robot.run for name, robot in check_robots(folder, tmp_path_factory).items()}
    assert {name: r.failures for name, r in runs.items() if r.failures} == {}
    for name, outcome in runs.items():
        causes = {model for f in outcome.findings if f.blocks_check for model in f.subjects_by_model}
        assert {info.id for info in outcome.unchecked_models} == causes, name
    compare_with_accepted(folder.name, runs, accept=request.config.getoption("--accept"))


def compare_with_accepted(folder: str, runs: Mapping[str, Run], *, accept: bool) -> None:
    """Compare the errors of a folder's runs with the accepted ones, or accept them."""
    errors = {
        f"{folder}/{name}": sorted(
            f"{f.code} {f.message_id} {s}"
            for f in iter_occurrences(r.findings)
            if f.severity is Severity.ERROR
            for s in f.subjects
        )
        for name, r in sorted(runs.items())
    }
    errors = {name: texts for name, texts in errors.items() if texts}
    accepted = json.loads(ACCEPTED.read_text(encoding="utf-8"))
    if accept:
        others = {name: texts for name, texts in accepted.items() if not name.startswith(f"{folder}/")}
        accepted = dict(sorted({**others, **errors}.items()))
        ACCEPTED.write_text(json.dumps(accepted, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    here = {name: texts for name, texts in accepted.items() if name.startswith(f"{folder}/")}
    new = {name: sorted(set(texts) - set(here.get(name, []))) for name, texts in errors.items()}
    gone = {name: sorted(set(texts) - set(errors.get(name, []))) for name, texts in here.items()}
    assert {name: texts for name, texts in new.items() if texts} == {}
    assert {name: texts for name, texts in gone.items() if texts} == {}


@pytest.mark.parametrize(
    ("times", "is_full", "selected"),
    [(1, False, "abd"), (2, False, "abcde"), (9, False, "abcdef"), (1, True, "abcdefg")],
)
def test_a_selection_has_each_trait_as_often_as_asked(times: int, is_full: bool, selected: str) -> None:
    traits = {"a": {1}, "b": {1, 2}, "c": {2}, "d": {3, 2}, "e": {3}, "f": {2}, "g": set()}
    assert select_by_trait(traits, traits.__getitem__, times=times, is_full=is_full) == list(selected)


def test_a_checked_robot_is_read_as_it_was_written(tmp_path: Path) -> None:
    """Its rules, which each of many robots has, are those of this process."""
    run = check_text(tmp_path, '<robot name="r"><link name="Base"/></robot>', codes={"NAM002"})
    robot = CheckedRobot(run, frozenset(), run.findings, {}, {})
    write_checked(robot, tmp_path / "robot")
    read = read_checked(tmp_path / "robot")
    assert read == robot
    assert read.run.rules["NAM002"] is load_rules()["NAM002"]
    assert b"## What it checks" not in (tmp_path / "robot").read_bytes()


# What is known to be wrong upstream: which rule says it where, at how many elements.
KNOWN = [
    (
        "husky/husky:husky[blackfly_enabled=1,blackfly_mount_enabled=0,sensor_arch=1]",
        "XML003",
        "misspelt",
        "<intertial>",
        1,
    ),
    ("husky/husky:husky[blackfly_enabled=1,blackfly_mount_enabled=0,sensor_arch=1]", "XML004", "inside", "`values`", 1),
    ("Gepetto/example-robot-data:talos_full_v2", "PKG001", "nameless", "47 files", 47),
    ("Gepetto/example-robot-data:tiago_dual", "GZB001", "template", "10 <gazebo> blocks", 10),
    ("Ausaurus/ranger_1s_urdf:ranger1s_urdf_3", "PKG001", "files", "ranger1s_urdf_3", 10),
]


@pytest.mark.parametrize(("name", "code", "message", "said", "places"), KNOWN, ids=[f"{k[1]}-{k[3]}" for k in KNOWN])
def test_what_upstream_broke_is_one_finding(
    runs: dict[str, Run], name: str, code: str, message: str, said: str, places: int
) -> None:
    if name not in runs:
        pytest.skip("the robot is in another folder")
    (finding,) = (f for f in runs[name].findings if (f.code, f.message_id) == (code, message))
    assert said in finding.message
    assert 1 + len(finding.related) >= places
