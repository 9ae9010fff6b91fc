"""``urdfcheck srdf``: what Setup Assistant would disable, and why."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import pytest
from builders import box, collision, joint, limit, link
from conftest import check

from urdfcheck.cli import FAILED, NOTHING, OK, main

pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("one_process")]


def make_link(name: str, size: str = "", at: str = "0 0 0") -> str:
    """Return a link that collides with a box where a size is given."""
    return link(name, collision(box(size), xyz=at) if size else "")


def hinge(parent: str, child: str, at: str, reach: float) -> str:
    return joint(f"to_{child}", parent, child, limit(-reach, reach), kind="revolute", xyz=at, axis="0 1 0")


def fixed(parent: str, child: str, at: str) -> str:
    return joint(f"to_{child}", parent, child, xyz=at)


# The forearm can be folded into the base; the lamp is far above all, the shelf and the stop are in the way at rest.
ARM = "".join(
    (
        '<robot name="arm">',
        make_link("base", "0.2 0.2 0.2"),
        make_link("upper", "0.3 0.05 0.05", "0.2 0 0"),
        make_link("flange"),
        make_link("fore", "0.3 0.05 0.05", "0.2 0 0"),
        make_link("lamp", "0.1 0.1 0.1"),
        make_link("shelf", "0.1 0.5 0.02"),
        make_link("sleeve", "0.06 0.06 0.06"),
        hinge("base", "upper", "0 0 0.2", 0.6),
        fixed("upper", "flange", "0.4 0 0"),
        hinge("flange", "fore", "0 0 0", 2.9),
        fixed("base", "lamp", "0 0 5"),
        fixed("base", "shelf", "0.7 0 0.2"),
        fixed("flange", "sleeve", "-0.2 0 0"),
        "</robot>",
    )
)
REASONS = {
    ("base", "lamp"): "Adjacent",
    ("base", "shelf"): "Adjacent",
    ("base", "upper"): "Adjacent",
    ("fore", "sleeve"): "Adjacent",  # by the flange, which has no geometry
    ("fore", "upper"): "Adjacent",
    ("sleeve", "upper"): "Adjacent",
    ("fore", "shelf"): "Default",
    ("fore", "lamp"): "Never",
    ("lamp", "shelf"): "Never",
    ("lamp", "sleeve"): "Never",
    ("lamp", "upper"): "Never",
    ("base", "sleeve"): "Never",
    ("shelf", "sleeve"): "Never",
    ("shelf", "upper"): "Never",
}


@pytest.fixture(name="arm")
def write_arm(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("URDFCHECK_CACHE_DIR", str(tmp_path / "cache"))
    (tmp_path / "arm.urdf").write_text(ARM)
    return tmp_path / "arm.urdf"


def test_each_pair_is_written_once_with_the_first_reason_that_holds(
    arm: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["srdf", str(arm)]) == OK
    text = capsys.readouterr().out
    root = ElementTree.fromstring(text)
    assert root.get("name") == "arm"
    pairs = [(e.attrib["link1"], e.attrib["link2"]) for e in root]
    assert {pair: e.attrib["reason"] for pair, e in zip(pairs, root, strict=True)} == REASONS
    assert all(one < other for one, other in pairs)
    assert '    <disable_collisions link1="base" link2="lamp" reason="Adjacent"/>\n' in text
    assert "Still checked: 1 of 15 pairs." in text


def test_the_evidence_stands_above_each_group(arm: Path, capsys: pytest.CaptureFixture[str]) -> None:
    main(["srdf", str(arm)])
    parts = capsys.readouterr().out.split("<!-- ")
    (proven,) = [part for part in parts if part.startswith("Never: proven.")]
    (seen,) = [part for part in parts if part.startswith("Never: not seen to collide in 5,000 sampled configurations")]
    assert '"fore" link2="lamp"' in proven
    assert '"base" link2="sleeve"' in seen
    assert "less than\n         0.06 %" in seen


def test_what_it_writes_satisfies_the_rules_about_it(arm: Path) -> None:
    """Written beside the model; the pair that collides by default is disabled, too."""
    target = arm.parent / "arm.srdf"
    assert main(["srdf", str(arm), "-o", str(target)]) == OK
    run = check(arm, codes={"COL003", "COL004"})
    assert not run.findings
    assert not run.skipped
    target.write_text(target.read_text().replace('"sleeve" link2="upper"', '"sleeve" link2="lamp"'))
    assert {f.code for f in check(arm, codes={"COL003", "COL004"}).findings} == {"COL003", "COL004"}


def test_a_file_of_another_hand_is_not_written_over(arm: Path, capsys: pytest.CaptureFixture[str]) -> None:
    target = arm.parent / "arm.srdf"
    target.write_text('<robot name="arm"><group name="all"/></robot>')
    assert main(["srdf", str(arm), "-o", str(target)]) == FAILED
    assert "was not written by urdfcheck srdf" in capsys.readouterr().err
    assert "group" in target.read_text()
    target.unlink()
    first, second = (main(["srdf", str(arm), "-o", str(target)]) for _ in range(2))
    assert (first, second) == (OK, OK)
    added = target.read_text().replace("</robot>", '<group name="all"/></robot>')
    target.write_text(added)
    assert main(["srdf", str(arm), "-o", str(target)]) == FAILED
    assert target.read_text() == added


def test_arguments_reach_the_model(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = ARM.replace('<robot name="arm">', '<robot name="$(arg n)" xmlns:xacro="http://www.ros.org/wiki/xacro">')
    (tmp_path / "arm.urdf.xacro").write_text(text)
    assert main(["srdf", str(tmp_path / "arm.urdf.xacro")]) == FAILED
    assert "argument n has no default and was not given" in capsys.readouterr().err
    assert main(["srdf", str(tmp_path / "arm.urdf.xacro"), "--arg", "n:=left_arm", "--no-cache"]) == OK
    assert '<robot name="left_arm">' in capsys.readouterr().out


@pytest.mark.parametrize(
    ("text", "code", "says"),
    [
        ("<robot", FAILED, "not well-formed XML"),
        ("<sdf/>", FAILED, "the root element is <sdf>"),
        ('<robot name="r"><link name="a"/><link name="b"/></robot>', FAILED, "the model has 2 roots (KIN005)"),
        ('<robot name="r"><link name="a"/></robot>', NOTHING, "no two links have collision geometry"),
    ],
)
def test_why_there_is_nothing_to_write(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], text: str, code: int, says: str
) -> None:
    (tmp_path / "r.urdf").write_text(text)
    assert main(["srdf", str(tmp_path / "r.urdf")]) == code
    shown = capsys.readouterr()
    assert says in shown.err
    assert not shown.out


def test_one_model_must_be_meant(arm: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (arm.parent / "leg.urdf").write_text(ARM.replace("arm", "leg"))
    assert main(["srdf", str(arm.parent)]) == FAILED
    assert "2 models; name one of them" in capsys.readouterr().err
    assert main(["srdf", str(arm.parent / "none.urdf")]) == FAILED
    assert "does not exist" in capsys.readouterr().err


def test_pairs_with_a_mesh_that_cannot_be_read_stay_checked(arm: Path, capsys: pytest.CaptureFixture[str]) -> None:
    lost = '<collision><geometry><mesh filename="lost.stl"/></geometry></collision></link>'
    arm.write_text(ARM.replace("</link>", lost, 1))
    assert main(["srdf", str(arm)]) == OK
    text = capsys.readouterr().out
    assert '"base" link2="sleeve"' not in text
    assert "1 of these because a collision shape of one of the links could not be measured." in text
