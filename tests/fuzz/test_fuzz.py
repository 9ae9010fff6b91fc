"""A few inputs of every format in each test run; `python -m tests.fuzz` runs them by the thousand."""

from __future__ import annotations

import os
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from conftest import IS_FULL
from fuzz import campaign, cases, meshes, seeds
from fuzz.campaign import Tally, random_of
from fuzz.cases import Case, make
from fuzz.oracle import Verdict, judge
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from urdfcheck.core import Finding
from urdfcheck.rules import load_check
from urdfcheck.run.unit_audit import _UnitAudit

pytestmark = [pytest.mark.slow, pytest.mark.long]

pytest.importorskip("pinocchio")

# What fails is known by its number: there is nothing to shrink.
FEW = settings(max_examples=10 if IS_FULL else 5, derandomize=True, database=None, phases=[Phase.generate])


def verdict_on(case: Case, *, everything: bool = False) -> Verdict:
    with tempfile.TemporaryDirectory() as folder:
        return judge(case, Path(folder), everything=everything)


@pytest.mark.parametrize("name", cases.MAKERS)
def test_no_input_of_a_format_does_harm(name: str) -> None:
    @FEW
    @given(number=st.integers(0, 2**32))
    def holds(number: int) -> None:
        verdict = verdict_on(make(name, random_of(name, 0, number)), everything=number % 4 == 0)
        assert not verdict.failed, f"python -m tests.fuzz --one {name}:0:{number}: {verdict.outcome}: {verdict.detail}"

    holds()


# -- the fuzzer itself -----------------------------------------------------------------------------------------------

PACKAGE = {"package.xml": seeds.PACKAGE.encode(), "meshes/part.stl": meshes.stl_binary()}
XACRO = {"parts.xacro": seeds.PARTS.encode(), "values.yaml": seeds.YAML.encode()}


def sound() -> Iterator[Case]:
    for text in (seeds.ARM, seeds.CAR, seeds.SMALL):
        yield Case("model.urdf", {**PACKAGE, "model.urdf": text.encode(), "a.srdf": seeds.SRDF.encode()}, tier="full")
    for text in (seeds.XACRO, seeds.LOOP, seeds.READER):
        yield Case("model.urdf.xacro", {**PACKAGE, **XACRO, "model.urdf.xacro": text.encode()}, tier="full")
    for name, text in (
        ("it.launch", seeds.LAUNCH_1),
        ("it.launch.xml", seeds.LAUNCH_2),
        ("it.launch.py", seeds.LAUNCH_PY),
    ):
        files = {
            "model.urdf": seeds.ARM,
            "other.launch": seeds.OTHER_LAUNCH,
            "urdf/made.urdf.xacro": seeds.LOOP,
            name: text,
        }
        yield Case(name, {**PACKAGE, **{file: text.encode() for file, text in files.items()}})
    for kind, known in meshes.SOUND.items():
        for data in known:
            model = seeds.MESHED.format(name=f"part.{kind}").encode()
            mesh = f"meshes/part.{kind}"
            yield Case("model.urdf", {**PACKAGE, "model.urdf": model, mesh: data}, tier="full", mesh=mesh)


@pytest.mark.parametrize("case", list(sound()), ids=lambda case: f"{case.entry} {case.mesh}")
def test_what_the_mutations_start_from_is_sound(case: Case) -> None:
    """Else most inputs would end at the same first defect."""
    verdict = verdict_on(case)
    assert verdict.outcome == "clean", verdict.detail


def test_an_input_is_known_by_its_format_its_seed_and_its_number() -> None:
    for name in cases.MAKERS:
        assert make(name, random_of(name, 1, 2)) == make(name, random_of(name, 1, 2))
        assert make(name, random_of(name, 1, 2)) != make(name, random_of(name, 1, 3))


SMALL = Case("model.urdf", {"model.urdf": seeds.SMALL.encode()})


def test_a_check_that_crashes_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    def crash(*_: object, **__: object) -> Iterator[Finding]:
        raise LookupError("a defect of ours")

    real = load_check
    monkeypatch.setattr(
        "urdfcheck.run.unit_audit.load_check", lambda rule: crash if rule.code == "XML003" else real(rule)
    )
    verdict = verdict_on(SMALL)
    assert verdict.outcome == "failure"
    assert "a defect of ours" in verdict.detail


def test_silence_about_what_no_parser_accepts_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_UnitAudit, "run_checks", lambda *_: None)
    assert verdict_on(SMALL).outcome == "clean"
    broken = Case("model.urdf", {"model.urdf": seeds.SMALL.replace("</robot>", "").encode()})
    assert verdict_on(broken).outcome == "findings"  # the cause is told whatever the checks do
    monkeypatch.setattr(_UnitAudit, "report_causes", lambda *_: None)
    assert verdict_on(broken).outcome in {"silent", "failure"}


def test_a_file_that_is_opened_out_of_reach_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    def peek(*_: object) -> None:
        Path("/etc/passwd").read_bytes()

    monkeypatch.setattr(_UnitAudit, "run_checks", peek)
    assert verdict_on(SMALL).outcome == "ran"


def test_failures_are_kept_by_their_cause_and_only_a_few_of_each() -> None:
    tally = Tally()
    kept = [tally.add("urdf", Verdict("failure", "…", "KeyError (a.py:1)")) for _ in range(10)]
    assert kept == [True, True, True] + [False] * 7
    assert not tally.add("urdf", Verdict("clean"))
    assert tally.counts == {("urdf", "failure"): 10, ("urdf", "clean"): 1}


def die() -> None:
    os._exit(11)


def hang() -> None:
    time.sleep(60.0)


@pytest.mark.skipif(sys.platform == "win32", reason="processes are forked")
@pytest.mark.parametrize(("act", "outcome"), [(die, "died"), (hang, "time")])
def test_a_process_that_ends_or_says_nothing_is_recorded_and_the_next_input_is_checked(
    monkeypatch: pytest.MonkeyPatch, act: Callable[[], None], outcome: str
) -> None:
    def judged(_case: Case, folder: Path, *, everything: bool) -> Verdict:
        if folder.name == "1":
            act()
        return Verdict("clean")

    monkeypatch.setattr(campaign, "judge", judged)
    monkeypatch.setattr(campaign, "_load", lambda: None)
    monkeypatch.setattr(campaign, "_SILENCE", 0.5)
    found = [(index, verdict.outcome) for index, _, verdict in campaign._verdicts([(i, "stl") for i in range(3)], 0, 1)]
    assert found == [(0, "clean"), (1, outcome), (2, "clean")]
