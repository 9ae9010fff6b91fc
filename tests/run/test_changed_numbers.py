"""After any change of numbers, a run with everything that earlier runs kept finds what a run without finds.

``URDFCHECK_REPLAY_EDITS``: how many changes are tried.
"""

from __future__ import annotations

import os
import random
import re
import shutil
from dataclasses import replace
from pathlib import Path

import pytest
from builders import box, collision, cylinder, inertial, joint, limit, link, robot, visual
from conftest import FIXTURES, check

from urdfcheck.core import Run

EDITS = int(os.environ.get("URDFCHECK_REPLAY_EDITS", "25"))
NUMBER = re.compile(r'(?<=[" ])-?\d+\.?\d*(?:[eE]-?\d+)?(?=[" ])')
# What is typed for a number: usual ones, and those that are refused, or are at the border of what is computed.
TYPED = ("0", "-0", "1", "-1", "0.5", "2e3", "1e-9", "1e49", "1e60", "1e-320", "1e999", "nan", "one", "", "0x1", "1.0 ")
DAMPED = '<dynamics damping="0.4" friction="0.1"/>'


def make_arm() -> str:
    """An arm that cannot hold itself, with a slide, a follower, a lamp on a joint that floats, and parts that collide."""
    bodies = [
        link(name, inertial(mass, 0.01, com="0.1 0 0"), visual(shape), collision(shape))
        for name, mass, shape in (
            ("base", 5, box("0.2 0.2 0.1")),
            ("upper", 3, cylinder(0.05, 0.3)),
            ("fore", 2, cylinder(0.04, 0.3)),
            ("slide", 1, box("0.1 0.1 0.2")),
            ("finger", 0.001, box("0.02 0.02 0.1")),
            ("lamp", 0.5, box("0.1 0.1 0.1")),
        )
    ]
    mimic = '<mimic joint="elbow" multiplier="-1" offset="0.1"/>'
    joints = [
        joint("shoulder", "base", "upper", limit(-1, 2, 3), DAMPED, kind="revolute", xyz="0 0 0.1", axis="0 1 0"),
        joint("elbow", "upper", "fore", limit(-1, 1, 9), kind="revolute", xyz="0.3 0 0", rpy="0.2 0 0", axis="0 1 0"),
        joint("lift", "fore", "slide", limit(0, 0.3, 50), kind="prismatic", xyz="0.3 0 0", axis="0 0 1"),
        joint("grip", "slide", "finger", limit(-1, 1, 1), mimic, DAMPED, kind="revolute", xyz="0 0 0.1", axis="1 0 0"),
        joint("lamp", "base", "lamp", kind="floating", xyz="0 0.5 0"),
    ]
    return robot(*bodies, *joints)


def change_number(text: str, choose: random.Random) -> str:
    """Type another number in place of one, or change one by a little."""
    place = choose.choice(list(NUMBER.finditer(text)))
    new = choose.choice(TYPED) if choose.random() < 0.4 else repr(float(place[0]) * choose.uniform(0.5, 2.0))
    return text[: place.start()] + new + text[place.end() :]


def find(path: Path, cache: Path | None) -> Run:
    found = check(path, cache=cache)
    return replace(found, seconds=0.0, models=tuple(replace(model, seconds=0.0) for model in found.models))


@pytest.mark.parametrize("kind", ["arm", pytest.param("car-3", marks=[pytest.mark.slow, pytest.mark.long])])
def test_a_changed_number_is_noticed(tmp_path: Path, kind: str) -> None:
    """Of up to four changes at a time, made on top of each other and undone."""
    shutil.copytree(FIXTURES / "car-3", tmp_path / "car-3")
    path = tmp_path / "car-3" / "urdf" / "car-3.urdf"
    first = path.read_text(encoding="utf-8") if kind == "car-3" else make_arm()
    choose = random.Random(20_261_128)
    text = first
    for number in range(EDITS):
        text = change_number(first if number % 4 == 0 else text, choose)
        path.write_text(text, encoding="utf-8")
        known, anew = find(path, tmp_path / "cache"), find(path, None)
        assert known == anew, f"after change {number}"
        assert not anew.failures


def test_a_drawing_that_is_no_longer_known_is_noticed(tmp_path: Path) -> None:
    """A wheel is apart from what the base draws, and from what collides in the same place; it may touch what is not known."""
    shutil.copytree(FIXTURES / "car-3", tmp_path / "car-3")
    path = tmp_path / "car-3" / "urdf" / "car-3.urdf"
    text = path.read_text(encoding="utf-8").replace('xyz="-0.07 0.052 0"', 'xyz="-0.137 0.052 0"')
    path.write_text(text, encoding="utf-8")
    assert "JNT021" in {finding.code for finding in find(path, tmp_path / "cache").findings}
    base, drawing, rest = text.partition("<visual>")
    path.write_text(base + drawing + rest.replace('rpy="0 0 0"', 'rpy="0 0 0x1"', 1), encoding="utf-8")
    anew = find(path, None)
    assert "JNT021" not in {finding.code for finding in anew.findings}
    assert find(path, tmp_path / "cache") == anew
