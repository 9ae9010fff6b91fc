"""INR015: the masses against what the configuration says that the robot weighs."""

from __future__ import annotations

from pathlib import Path

import pytest
from builders import find, inertial, joint, link, mesh, robot, visual
from conftest import check_text

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


@pytest.mark.parametrize(
    ("masses", "meshes", "found"),
    [
        (["156.563494224155"] * 4, "abcd", True),
        (["156.563494224155"] * 4, "aaaa", False),  # one part, four times
        (["156.563494224155"] * 3 + ["156.563494224156"], "abcd", False),
        (["1.5"] * 4, "abcd", False),
        (["156.563494224155"] * 3, "abc", False),
    ],
)
def test_one_mass_of_many_digits_is_not_that_of_every_part(
    tmp_path: Path, masses: list[str], meshes: str, found: bool
) -> None:
    links = [
        link(f"l{i}", inertial(mass, 3.0), visual(mesh(f"{name}.stl")))
        for i, (mass, name) in enumerate(zip(masses, meshes, strict=True))
    ]
    joints = [joint(f"j{i}", f"l{i}", f"l{i + 1}", kind="continuous", xyz="0 0 0.5") for i in range(len(links) - 1)]
    findings = check_text(tmp_path, robot(*links, *joints), codes={"INR015"}).findings
    assert [finding.message_id for finding in findings] == ["same"] * found
