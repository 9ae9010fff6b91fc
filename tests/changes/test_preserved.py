"""An edit that leaves the robot what it is gives an empty difference, which is proven: no configuration is sampled."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Callable
from pathlib import Path

import pytest
from transforms import Robot, with_defaults
from versions import ARM, PRESERVING, compare_texts, write_robot


def test_a_file_is_identical_to_itself(tmp_path: Path) -> None:
    found = compare_texts(tmp_path, ARM, ARM)
    assert (found.verdict, found.headline) == ("identical", "identical")
    assert found.mechanism is not None
    assert (found.mechanism.changes, found.mechanism.notes, found.mechanism.samples) == ((), (), 0)


@pytest.mark.parametrize("change", PRESERVING.values(), ids=PRESERVING)
@pytest.mark.parametrize("is_reversed", [False, True], ids=["there", "back"])
def test_what_leaves_the_robot_as_it_is_is_cosmetic(
    tmp_path: Path, change: Callable[[Robot], Robot], is_reversed: bool
) -> None:
    texts = [ARM, write_robot(change(ET.fromstring(ARM)))]
    before, after = reversed(texts) if is_reversed else texts
    found = compare_texts(tmp_path, before, after, name="arm.urdf.xacro")
    assert found.texts == ()
    assert found.verdict == "cosmetic"
    assert found.mechanism is not None
    assert found.mechanism.samples == 0
    assert found.mechanism.shifts == ()
    assert (found.mechanism.collisions, found.mechanism.effects) == (None, ())


def test_edits_add_up_to_nothing(tmp_path: Path) -> None:
    """Every edit after the other."""
    robot = ET.fromstring(ARM)
    for name, change in PRESERVING.items():
        if name not in {"with macros", "with properties"}:  # what comes after them would have to read xacro
            robot = change(with_defaults(robot))
    found = compare_texts(tmp_path, ARM, write_robot(robot), name="arm.urdf.xacro")
    assert found.texts == ()
    assert found.verdict == "cosmetic"


def test_equal_values_need_no_comparison(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Neither where the text is the same nor where other text gives the same values."""

    def refuse(*_: object) -> None:
        raise AssertionError("compared")

    monkeypatch.setattr("urdfcheck.changes.compare_versions._compare_models", refuse)
    assert compare_texts(tmp_path / "same", ARM, ARM).verdict == "identical"
    other = ARM.replace("</robot>", "  <!-- checked -->\n</robot>").replace('value="0.6"', 'value="0.60"')
    assert compare_texts(tmp_path / "other", ARM, other).verdict == "cosmetic"
    with pytest.raises(AssertionError, match="compared"):
        compare_texts(tmp_path / "heavier", ARM, ARM.replace('value="0.6"', 'value="0.61"'))
