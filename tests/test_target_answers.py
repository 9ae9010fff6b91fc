"""``urdfcheck check --target mujoco`` asks MuJoCo itself, where it is installed."""

from __future__ import annotations

import json
from importlib.resources import files
from pathlib import Path

import jsonschema
import pytest
from builders import inertial, joint, limit, link, robot

from urdfcheck.cli import main
from urdfcheck.simulators import target_answers
from urdfcheck.simulators.target_answers import _cut_folders

pytestmark = pytest.mark.slow

SCHEMA = json.loads((files("urdfcheck.output") / "report.schema.json").read_text(encoding="utf-8"))
SOUND = inertial(1, 1e-2)
# No body can have it: MuJoCo refuses it.
IMPOSSIBLE = SOUND.replace('izz="0.01"', 'izz="0.03"')


def arm(*inertials: str) -> str:
    """A base, and links after each other with these inertials."""
    names = [f"link_{k}" for k in range(len(inertials))]
    return robot(
        link("base", SOUND),
        *(link(name, typed) for name, typed in zip(names, inertials, strict=True)),
        *(
            joint(f"j_{child}", parent, child, limit(-1, 1, 1, 1), kind="revolute", xyz="0 0 0.1")
            for parent, child in zip(("base", *names), names, strict=False)
        ),
    )


@pytest.fixture
def ask(tmp_path: Path, capsys: pytest.CaptureFixture[str]):  # type: ignore[no-untyped-def]
    """Check a model with targets; returns the exit code and what is printed."""

    def run(model: str, *words: str) -> tuple[int, str]:
        path = tmp_path / "r.urdf"
        path.write_text(model, encoding="utf-8")
        code = main([str(path), "--no-cache", *words])
        return code, capsys.readouterr().out

    return run


def answers(document: str) -> list[tuple[str, str | None]]:
    report = json.loads(document)
    jsonschema.validate(report, SCHEMA)
    return [(answer["engine"], answer["verdict"]) for answer in report.get("answers", ())]


def test_mujoco_loaded_it(ask) -> None:  # type: ignore[no-untyped-def]
    mujoco = pytest.importorskip("mujoco")
    code, told = ask(arm(SOUND), "--target", "mujoco")
    assert code == 0
    told = " ".join(told.split())
    assert (
        f" MuJoCo {mujoco.__version__} loaded it here; it was not dropped: the robot has no shape that could touch"
        in told
    )
    _, document = ask(arm(SOUND), "--target", "mujoco", "--format", "json")
    assert answers(document) == [("mujoco", "loads")]


def test_mujoco_refused_it(ask) -> None:  # type: ignore[no-untyped-def]
    mujoco = pytest.importorskip("mujoco")
    code, told = ask(arm(SOUND, IMPOSSIBLE), "--target", "mujoco")
    assert code == 1
    assert "= effect MuJoCo refused it here" in told
    assert f"MuJoCo {mujoco.__version__} refused it here: inertia must satisfy" in told
    _, document = ask(arm(SOUND, IMPOSSIBLE), "--target", "mujoco", "--format", "json")
    assert answers(document) == [("mujoco", "refuses")]
    said = [f["consequences"]["mujoco"] for f in json.loads(document)["findings"] if f["code"] == "INR003"]
    assert said == [
        f"refused it here (version {mujoco.__version__}): inertia must satisfy A + B >= C; use 'balanceinertia' to fix "
        "(Element name 'link_1', id 3)"
    ]
    assert not [f for f in json.loads(document)["findings"] if f["code"] == "XML015"]
    _, page = ask(arm(SOUND, IMPOSSIBLE), "--target", "mujoco", "--format", "markdown")
    assert f"MuJoCo {mujoco.__version__} refused this model here" in page


def test_of_two_defects_the_one_that_it_names_was_met(ask) -> None:  # type: ignore[no-untyped-def]
    pytest.importorskip("mujoco")
    singular = SOUND.replace('"0.01"', '"-0.01"')
    _, document = ask(arm(IMPOSSIBLE, singular), "--target", "mujoco", "--format", "json")
    told = {
        f["code"]: f["consequences"]["mujoco"]
        for f in json.loads(document)["findings"]
        if "mujoco" in f["consequences"]
    }
    assert told["INR003"].startswith("refused it here")
    assert told["INR004"].startswith("refuses")


def test_a_refusal_that_nothing_predicts_is_an_error(ask) -> None:  # type: ignore[no-untyped-def]
    mujoco = pytest.importorskip("mujoco")
    code, told = ask(arm(IMPOSSIBLE), "--target", "mujoco", "--ignore", "INR003")
    assert code == 1
    assert f"✖ XML015 MuJoCo {mujoco.__version__} refused the model here" in told
    assert "inertia must satisfy A + B >= C" in told
    assert ask(arm(IMPOSSIBLE), "--target", "mujoco", "--ignore", "INR003,XML015")[0] == 0


@pytest.mark.usefixtures("one_process")
def test_a_model_that_cannot_be_handed_over_is_told(ask, monkeypatch: pytest.MonkeyPatch) -> None:  # type: ignore[no-untyped-def]
    mujoco = pytest.importorskip("mujoco")
    died = [(0, RuntimeError("the process that reads the model died"))]
    monkeypatch.setattr(target_answers, "map_in_processes", lambda *_: died)
    _, told = ask(arm(SOUND), "--target", "mujoco")
    assert f"MuJoCo {mujoco.__version__} was not asked: the model cannot be handed over" in told
    _, document = ask(arm(SOUND), "--target", "mujoco", "--format", "json")
    assert answers(document) == [("mujoco", None)]


@pytest.mark.usefixtures("one_process")
def test_without_a_target_nothing_is_asked(ask) -> None:  # type: ignore[no-untyped-def]
    assert answers(ask(arm(IMPOSSIBLE), "--format", "json")[1]) == []
    assert "here" not in ask(arm(SOUND), "--target", "rviz")[1]


def test_what_is_not_installed_was_not_asked(ask, monkeypatch: pytest.MonkeyPatch) -> None:  # type: ignore[no-untyped-def]
    monkeypatch.setattr("urdfcheck.simulators.mujoco.get_version", lambda: None)
    code, told = ask(arm(IMPOSSIBLE), "--target", "mujoco")
    assert code == 1
    assert "= effect MuJoCo refuses to compile" in told
    assert "MuJoCo was not asked, because it is not installed: pip install 'urdfcheck[engines]'" in " ".join(
        told.split()
    )
    assert answers(ask(arm(SOUND), "--target", "mujoco", "--format", "json")[1]) == [("mujoco", None)]


def test_what_an_engine_says_names_no_folder_of_the_machine(ask, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    pytest.importorskip("mujoco")
    (tmp_path / "part.dae").write_text("<COLLADA/>")
    shape = '<collision><geometry><mesh filename="part.dae"/></geometry></collision>'
    _, document = ask(robot(link("base", SOUND, shape)), "--target", "mujoco", "--format", "json")
    (answer,) = json.loads(document)["answers"]
    assert answer["verdict"] == "refuses"
    assert "'part.dae'" in answer["reasons"][0]
    assert str(tmp_path) not in json.dumps(answer["reasons"])


@pytest.mark.parametrize(
    ("said", "told"),
    [
        ("mesh file '/a b/c/d.stl' (id 1)", "mesh file 'd.stl' (id 1)"),
        ("cannot open /srv/robots/x.stl: 1/2 of it", "cannot open x.stl: 1/2 of it"),
        ('cannot open "C:\\\\robots\\\\x.stl"', 'cannot open "x.stl"'),
        ("A + B >= C; a/b", "A + B >= C; a/b"),
    ],
)
def test_folders_are_cut(said: str, told: str) -> None:
    assert _cut_folders(said) == told
