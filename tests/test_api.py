"""The public interface for Python: `urdfcheck.check` and the types of its outcome."""

from __future__ import annotations

import doctest
import json
import os
import subprocess
import sys
import threading
from dataclasses import replace
from pathlib import Path

import pytest
from conftest import FIXTURES, REPOSITORY, command

import urdfcheck
from urdfcheck import api
from urdfcheck.core.errors import UrdfcheckError
from urdfcheck.output.json import render as render_json
from urdfcheck.system import process_pool

pytestmark = pytest.mark.slow

CAR = FIXTURES / "car-3"
ROBOT = '<robot name="r"><link name="a"/></robot>'
XACRO = """<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">
<xacro:arg name="mass" default="1"/><link name="$(arg mass)_kg"/></robot>"""


def as_json(text: str) -> object:
    """A JSON report without the times that differ from run to run."""
    value = json.loads(text)
    for part in (value, *value["models"]):
        del part["seconds"]
    return value


@pytest.mark.usefixtures("one_process")
def test_it_finds_what_the_command_finds() -> None:
    for path, words, arguments in (
        (CAR / "urdf" / "car-3.urdf", (), {}),
        (CAR, ("--target", "gazebo,drake", "--tier=source"), {"target": ["gazebo", "drake"], "tier": "source"}),
        (
            CAR / "urdf" / "car-3.urdf",
            ("--select", "SYM,INR", "--ignore=INR003"),
            {"select": "SYM,INR", "ignore": "INR003"},
        ),
    ):
        printed = command("check", str(path), "--format", "json", *words).stdout
        outcome = urdfcheck.check(path, **arguments)
        assert as_json(render_json(outcome)) == as_json(printed)


@pytest.mark.usefixtures("one_process")
def test_it_heeds_the_configuration_unless_isolated(tmp_path: Path) -> None:
    model = tmp_path / "a.urdf"
    model.write_text('<robot name="r"><link name="a"/><joint/></robot>')
    known = {f.code for f in urdfcheck.check(model).findings}
    assert known
    (tmp_path / "urdfcheck.toml").write_text(f'ignore = ["{min(known)}"]\n')
    assert {f.code for f in urdfcheck.check(model).findings} == known - {min(known)}
    assert {f.code for f in urdfcheck.check(model, isolated=True).findings} == known
    assert {f.code for f in urdfcheck.check(model, select=known).findings} == known - {min(known)}


@pytest.mark.usefixtures("one_process")
def test_it_takes_one_path_or_many_of_any_kind(tmp_path: Path) -> None:
    one, other = tmp_path / "one.urdf", tmp_path / "other.urdf"
    one.write_text(ROBOT)
    other.write_text(ROBOT)
    for paths in (tmp_path, str(tmp_path), [one, str(other)], (path for path in (one, other))):
        assert len(urdfcheck.check(paths, tier="source").models) == 2


@pytest.mark.usefixtures("one_process")
def test_arguments_reach_the_xacro(tmp_path: Path) -> None:
    model = tmp_path / "a.xacro"
    model.write_text(XACRO)
    run = urdfcheck.check(model, arguments={"mass": 3}, tier="source", scene=True)  # type: ignore[dict-item]
    assert run.models[0].args == {"mass": "3"}
    assert run.scenes[0].root == "3_kg"


@pytest.mark.usefixtures("one_process")
def test_what_is_wrong_with_a_model_is_a_finding_and_what_is_missing_a_failure(tmp_path: Path) -> None:
    broken = tmp_path / "broken.urdf"
    broken.write_text("<robot")
    run = urdfcheck.check([broken, tmp_path / "missing.urdf"])
    assert [f.code for f in run.active_findings] == ["XML001"]
    assert any("missing.urdf" in failure for failure in run.failures)


@pytest.mark.parametrize(
    ("words", "complaint"),
    [
        ({"paths": []}, "at least one"),
        ({"paths": ""}, "a path is empty"),
        ({"select": "NOPE"}, "NOPE"),
        ({"ignore": ["NOPE"]}, "NOPE"),
        ({"target": "gazebo,nope"}, "^target: .*nope"),
        ({"tier": "deep"}, "^tier deep: one of source, mesh, full"),
        ({"jobs": 0}, "^jobs 0: at least 1"),
        ({"samples": 0}, "^samples 0: at least 1"),
        ({"timeout": -1.0}, "^timeout -1: a number of seconds"),
        ({"memory": 10}, "^memory 10: at least 512 MiB"),
        ({"packages": {"p": "nowhere"}}, "^packages p=nowhere: nowhere is not a folder"),
        ({"package_paths": "nowhere"}, "^package_paths nowhere: is not a folder"),
        ({"allow_read": ["nowhere"]}, "^allow_read nowhere: is not a folder"),
        ({"baseline": "nowhere.json"}, "nowhere.json"),
        ({"config": "nowhere.toml"}, "nowhere.toml"),
    ],
)
def test_a_wrong_argument_is_an_error(tmp_path: Path, words: dict[str, object], complaint: str) -> None:
    with pytest.raises(UrdfcheckError, match=complaint):
        urdfcheck.check(**{"paths": tmp_path, **words})  # type: ignore[arg-type]


def test_it_leaves_the_process_of_its_caller_as_it_was(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "a.urdf").write_text(ROBOT)
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend("")
    for name in process_pool.WORKER_VARIABLES:
        monkeypatch.delenv(name, raising=False)
    path, environment = [*sys.path], dict(os.environ)
    urdfcheck.check(".")
    with pytest.raises(UrdfcheckError):
        urdfcheck.check(".", memory=1)
    assert sys.path == path
    assert dict(os.environ) == environment
    assert not process_pool.multiprocessing.active_children()


def test_an_interrupt_is_the_callers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run = api.run_and_ask
    monkeypatch.setattr(api, "run_and_ask", lambda *words: replace(run(*words), partial=True))
    with pytest.raises(KeyboardInterrupt):
        urdfcheck.check(tmp_path)


def test_it_works_in_a_thread_as_a_notebook_has_them(tmp_path: Path) -> None:
    (tmp_path / "a.urdf").write_text(ROBOT)
    outcomes: list[urdfcheck.Run] = []
    thread = threading.Thread(target=lambda: outcomes.append(urdfcheck.check(tmp_path)))
    thread.start()
    thread.join(60)
    assert [len(run.models) for run in outcomes] == [1]


@pytest.mark.skipif(not process_pool.FORKS, reason="a spawned process imports the script")
def test_a_script_needs_no_main_guard(tmp_path: Path) -> None:
    (tmp_path / "a.urdf").write_text(ROBOT)
    (tmp_path / "struct.py").write_text("raise SystemExit('a module of the checked folder was imported')")
    script = tmp_path / "script" / "script.py"
    script.parent.mkdir()
    script.write_text("import urdfcheck\nprint(len(urdfcheck.check('.').models))\n")
    done = subprocess.run([sys.executable, script], cwd=tmp_path, capture_output=True, text=True)
    assert (done.stdout, done.stderr) == ("1\n", "")


def test_the_import_loads_nothing_else() -> None:
    code = (
        "import sys; before = {*sys.modules}; import urdfcheck; print(*({*sys.modules} - before));"
        "urdfcheck.Severity; print(*({*sys.modules} - before))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    package, types = map(str.split, done.stdout.splitlines())
    assert sorted(package) == ["urdfcheck", "urdfcheck.version"]
    assert "urdfcheck.core" in types
    assert not {"numpy", "argparse", "urdfcheck.api", "urdfcheck.run"} & {*types}


def test_every_public_name_is_there() -> None:
    assert set(urdfcheck.__all__) <= set(dir(urdfcheck))
    for name in urdfcheck.__all__:
        assert getattr(urdfcheck, name) is not None
    assert urdfcheck.load_rules()["INR003"].code == "INR003"
    with pytest.raises(AttributeError, match="no attribute 'chekc'"):
        urdfcheck.chekc  # noqa: B018 (it raises)


def test_the_example_in_its_description_is_true(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(REPOSITORY)
    assert doctest.testmod(api).failed == 0
    assert doctest.testmod(api).attempted >= 3
