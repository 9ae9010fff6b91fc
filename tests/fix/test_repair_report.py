"""What `urdfcheck repair --report` shows: the model before and after, and each step."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from changes.test_html import read_data, read_page
from conftest import check, make_request
from versions import ARM

from urdfcheck.changes.compare_repaired import compare_repaired
from urdfcheck.core import Edit, Fix, Span
from urdfcheck.core.model_diff import DONE, LEFT, WITHDRAWN, Diff
from urdfcheck.fix.repair.steps import RepairStep, iter_reported_steps
from urdfcheck.run.pipeline import IN_THIS_PROCESS

CODES = {"INR003"}
IMPOSSIBLE = ARM.replace('ixx="0.0006"', 'ixx="0.006"')
STEPS = (
    RepairStep(stage="meshes", subject="meshes/arm.dae", text="it has no scene to write a scale to", is_done=False),
    RepairStep(stage="collision", subject="fore", text="kept: it is a box", is_done=False),
    RepairStep(stage="collision", subject="base", text="box; withdrawn: INR010", is_done=False, is_withdrawn=True),
    RepairStep(stage="collision", subject="upper", text="cylinder instead of 5140 triangles"),
    RepairStep(stage="inertia", subject="hand", text="0.6 kg at 2500 kg/m³"),
)


def compare(folder: Path, before: str, after: str, unrepaired: str) -> Diff:
    """Compare a model with its repaired copy, which was ``unrepaired`` at first."""
    for side, text in (("model", before), ("copy", unrepaired)):
        (folder / side).mkdir()
        (folder / side / "arm.urdf").write_text(text)
    file = folder / "copy" / "arm.urdf"
    first = check(file, codes=CODES)
    file.write_text(after)
    original, copy = (make_request(folder / side / "arm.urdf", codes=CODES) for side in ("model", "copy"))
    return compare_repaired(original, copy, first, iter_reported_steps(first.findings, STEPS), IN_THIS_PROCESS)


def test_the_page_shows_each_step_and_leads_to_its_part(tmp_path: Path) -> None:
    found = read_page(compare(tmp_path, IMPOSSIBLE, ARM, IMPOSSIBLE))
    (model,) = read_data(found)["models"]
    entries = {entry["id"]: entry for entry in model["findings"]}
    rows = [row["id"] for row in found.classes("entry")]
    assert set(rows) | {card["id"] for card in found.classes("card")} == set(entries)
    assert [entries[f"m1-r{number}"]["links"] for number in range(6)] == [
        ["hand"], [], ["upper"], ["base"], ["fore"], ["hand"],
    ]  # fmt: skip
    assert "before" in model, "both versions are drawn"
    assert "3 done, 1 withdrawn, 2 left as it was" in found.text
    assert [sign["class"].split()[1] for sign in found.classes("sign")] == [
        "ok", "unchecked", "ok", "warning", "unchecked", "ok",
    ]  # fmt: skip
    assert "cylinder instead of 5140 triangles" in found.text
    assert "Findings that are gone" in found.text


def test_a_model_that_was_left_as_it_is_has_its_reasons(tmp_path: Path) -> None:
    found = read_page(compare(tmp_path, ARM, ARM, ARM))
    assert "Both versions are equal." in found.text
    assert "kept: it is a box" in found.text


def test_what_the_copy_leaves_behind_is_no_merit_of_the_repair(tmp_path: Path) -> None:
    """Of two findings of the model the untouched copy has one; the other was about what lies around the model."""
    both = IMPOSSIBLE.replace('ixx="0.02"', 'ixx="0.2"')
    diff = compare(tmp_path, both, ARM, IMPOSSIBLE)
    assert [subject for finding in diff.findings.gone for subject in finding.subjects] == [
        "link[hand]/inertial/inertia"
    ]
    assert diff.notes == ("1 finding about what lies around the model: the copy has only what the model reads",)


def test_what_the_untouched_copy_had_already_is_not_new(tmp_path: Path) -> None:
    diff = compare(tmp_path, ARM, IMPOSSIBLE, IMPOSSIBLE)
    assert diff.findings.new == ()
    assert len(diff.notes) == 1


def test_steps_are_told_stage_by_stage_those_that_were_made_first() -> None:
    assert [(step.stage, step.outcome) for step in iter_reported_steps((), STEPS)] == [
        ("meshes", LEFT), ("collision", DONE), ("collision", WITHDRAWN), ("collision", LEFT), ("inertia", DONE),
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("texts", "says"),
    [
        ((("0 -0.75239 0", "0 0 0"),), "0 -0.75239 0 → 0 0 0"),
        ((("", '<limit effort="1"/>'),), "the title"),
        ((("a\nb", "c"),), "the title"),
        ((("a", "b"), ("c", "d")), "the title"),
    ],
)
def test_an_edit_is_told_by_its_texts_where_these_are_short(
    texts: tuple[tuple[str, str], ...], says: str, tmp_path: Path
) -> None:
    (tmp_path / "arm.urdf").write_text(IMPOSSIBLE)
    (finding,) = check(tmp_path / "arm.urdf", codes=CODES).findings
    span = Span("arm.urdf", 1, 1, 1, 2, 0, 1)
    fix = Fix(title="the title", edits=tuple(Edit(span, old, new) for old, new in texts))
    (step,) = iter_reported_steps((replace(finding, fix=fix),), ())
    assert (step.stage, step.subject, step.outcome) == ("edits", "INR003", DONE)
    assert step.text == f"{finding.headline}: {says}"
