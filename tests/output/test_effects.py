"""What formats tell of the programs: news only, those of the targets, once per rule."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace

import pytest
from output.runs import a_run, finding

from urdfcheck.core import Run, Severity
from urdfcheck.output import github, gitlab, junit, markdown, rdjson, sarif, text
from urdfcheck.output import json as json_format
from urdfcheck.output.html import document as html
from urdfcheck.output.shared.verdict.effects import describe_hits, list_effects, list_new_effects
from urdfcheck.output.shared.verdict.losses import describe_losses
from urdfcheck.output.text import DetailLevel

EFFECTS = {
    "gazebo": "loads it",
    "drake": "replaces, with a warning, the inertia",
    "mujoco": "refuses to compile: A + B >= C",
    "bullet": "replaces the inertia by that of its box",
    "moveit": "plans hardly anything",
}


def run_of(**changes: object) -> Run:
    return replace(a_run(finding(consequences=EFFECTS)), **changes)  # type: ignore[arg-type]


def test_that_a_program_loads_it_is_no_news() -> None:
    run = run_of()
    told = list_effects(run, run.findings[0])
    assert [names for names, _ in told] == ["MuJoCo", "Drake", "Bullet", "MoveIt"], "the worst first, and not Gazebo"
    assert next(names for names, _ in list_effects(run, run.findings[0], every=True)) == "Gazebo"


def test_with_targets_only_they_are_told() -> None:
    run = run_of(targets=("bullet", "gazebo"))
    assert list_effects(run, run.findings[0]) == [("Bullet", "replaces the inertia by that of its box")]
    own = run_of(targets=("bullet",), targets_by_unit={run.findings[0].model: ("drake",)})
    assert [names for names, _ in list_effects(own, own.findings[0])] == ["Drake"]


def test_a_target_that_reads_through_urdfdom_hears_what_urdfdom_drops() -> None:
    run = replace(a_run(finding(consequences={"urdfdom": "drops the link"})), targets=("gazebo",))
    assert list_effects(run, run.findings[0]) == [("urdfdom", "drops the link")]
    assert list_effects(replace(run, targets=("mujoco",)), run.findings[0]) == []


def test_a_line_has_the_first_clause_and_agrees_with_the_number_of_programs() -> None:
    run = run_of()
    whole = "MuJoCo refuses to compile · Drake replaces values · Bullet replaces the inertia by that of its box"
    assert describe_hits(run, run.findings[0], 200) == whole
    assert describe_hits(run, run.findings[0], 60) == "MuJoCo refuses the model · Drake and Bullet replace values"
    target = replace(run, targets=("moveit",))
    assert describe_hits(target, run.findings[0], 60) == "MoveIt plans hardly anything"


@pytest.mark.parametrize(
    ("effects", "told"),
    [
        ({"mujoco": "loads it", "gazebo": "the joint sags"}, "Gazebo: the joint sags"),
        ({"rviz": "shows it elsewhere", "gazebo": "the joint sags"}, "Gazebo: the joint sags"),
        ({"rviz": '"Mass Properties" shows a ball, and a box'}, 'RViz: "Mass Properties" shows a ball'),
        ({"mujoco": "motors, friction and gains do not fit"}, "MuJoCo: motors, friction and gains do not fit"),
        ({"gazebo": "in Gazebo Classic, the joint shakes: it is light"}, "Gazebo: in Gazebo Classic, the joint shakes"),
    ],
)
def test_what_all_programs_load_goes_wrong_somewhere(effects: dict[str, str], told: str) -> None:
    run = a_run(finding(consequences=effects))
    assert describe_hits(run, run.findings[0], 60) == told


def test_a_line_keeps_the_object_of_a_verb_if_it_fits() -> None:
    effects = {"drake": "replaces the inertia, with a warning", "bullet": "replaces the inertia of the link by zero"}
    run = a_run(finding(consequences=effects))
    assert describe_hits(run, run.findings[0], 40) == "Drake and Bullet replace the inertia"


@pytest.mark.parametrize(
    ("effect", "plural"),
    [
        ("refuses it", "MuJoCo and Drake refuse it"),
        ("pushes it", "MuJoCo and Drake push it"),
        ("is slow", "MuJoCo and Drake are slow"),
        ("has none", "MuJoCo and Drake have none"),
    ],
)
def test_verbs_agree(effect: str, plural: str) -> None:
    run = replace(a_run(finding(consequences={"mujoco": effect, "drake": effect})), targets=("mujoco", "drake"))
    assert describe_hits(run, run.findings[0], 80) == plural


def test_a_rule_tells_it_once() -> None:
    run, told = run_of(), set()  # type: ignore[var-annotated]
    assert list_new_effects(run, run.findings[0], told)
    assert not list_new_effects(run, run.findings[0], told)
    assert list_new_effects(run, replace(run.findings[0], code="INR999"), told)
    other = replace(run.findings[0], consequences={"mujoco": "refuses to load"})
    assert list_new_effects(run, other, told), "other words are news"


FORMATS: dict[str, Callable[[Run], str]] = {
    "markdown": markdown.render,
    "text": lambda run: text.render(run, detail=DetailLevel.BRIEF),
    "sarif": sarif.render,
    "junit": junit.render,
    "github": github.render,
    "gitlab": gitlab.render,
    "rdjson": rdjson.render,
}


@pytest.mark.parametrize("name", FORMATS)
def test_all_formats_tell_news_once(name: str) -> None:
    effects = {"mujoco": "refuses to compile the robot", "gazebo": "loads it all right"}
    twins = [finding(consequences=effects, severity=Severity.ERROR) for _ in range(3)]
    page = FORMATS[name](a_run(*(replace(f, subjects=(f"link[w{i}]",)) for i, f in enumerate(twins))))
    # Each error of the terminal says how bad it is.
    assert page.count("refuses to compile the robot") == (3 if name == "text" else 1)
    assert "loads it all right" not in page


def test_the_full_text_tells_all_programs() -> None:
    page = text.render(run_of())
    assert "Gazebo: loads it" in page
    assert "MuJoCo: refuses to compile: A + B >= C" in page


def test_json_keeps_all() -> None:
    assert json.loads(json_format.render(run_of()))["findings"][0]["consequences"] == EFFECTS


def test_a_card_tells_news() -> None:
    page = html.render(run_of())
    assert "refuses to compile" in page
    assert "<dt>Gazebo</dt>" not in page


def test_a_sensor_that_loses_its_data_is_no_part_of_the_model() -> None:
    frame = finding(consequences={"rviz": "drops the data of the sensor because it has no frame"})
    assert describe_losses(a_run(frame)).by_problems == "RViz drops the data of a sensor"
    shape = finding(consequences={"rviz": "drops the shape", "gazebo": "drops the shape"})
    assert describe_losses(a_run(frame, shape)).by_problems == "Gazebo and RViz drop a part of this model"
    hidden = finding(consequences={"rviz": "drops the data of the sensor", "gazebo": "drops the shape"})
    losses = describe_losses(a_run(hidden))
    assert losses.by_problems == "Gazebo drops a part of this model, RViz drops the data of a sensor"
