"""INR015: the masses against what the configuration says that the robot weighs."""

from __future__ import annotations

from pathlib import Path

import pytest
from builders import find, inertial, link, robot

from urdfcheck.run.pipeline import IN_THIS_PROCESS, run
from urdfcheck.run.request import RunOptions, make_request

CONFIG = """\
[options.INR015]
total_mass = 23.5

[[paths]]
match = ["long.urdf"]
options.INR015 = { total_mass = 26.1, rel_tol = 0.01 }
"""


def test_each_model_has_its_mass(tmp_path: Path) -> None:
    (tmp_path / "urdfcheck.toml").write_text(CONFIG, encoding="utf-8")
    for name, mass in (("short", 23.2), ("long", 25.8)):
        (tmp_path / f"{name}.urdf").write_text(robot(link("base", inertial(mass)), name=name), encoding="utf-8")
    request, _ = make_request(RunOptions(paths=(tmp_path,), select=("INR015",), jobs=1))
    outcome = run(request, IN_THIS_PROCESS)
    assert [finding.message for finding in outcome.findings] == [
        "the masses of long add up to 25.8 kg (links: 1), but the configuration says that it weighs 26.1 kg: -1.1%. "
        "The heaviest: base 25.8 kg"
    ]


@pytest.mark.parametrize(("mass", "found"), [(10, []), (10.19, []), (10.21, ["measured"]), (9.79, ["measured"])])
def test_two_per_cent_are_cables_and_screws(tmp_path: Path, mass: float, found: list[str]) -> None:
    options = {"INR015": {"total_mass": 10.0}}
    findings = find(tmp_path, robot(link("base", inertial(mass))), "INR015", options=options)
    assert [finding.message_id for finding in findings] == found


def test_a_robot_without_masses_weighs_nothing(tmp_path: Path) -> None:
    text = robot(link("base"))
    assert find(tmp_path, text, "INR015") == []
    (finding,) = find(tmp_path, text, "INR015", options={"INR015": {"total_mass": 10.0}})
    assert "none has a mass" in finding.message
