"""NAM rules: names that are fine, and names that are not."""

from __future__ import annotations

from pathlib import Path

import pytest
from conftest import check, check_text

from urdfcheck.core import Severity

XACRO = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'


def model(link: str, joint: str = "j") -> str:
    return (
        f'<robot name="r"><link name="base"/><link name="{link}"/>'
        f'<joint name="{joint}" type="fixed"><parent link="base"/><child link="{link}"/></joint></robot>'
    )


class TestNAM001:
    @pytest.mark.parametrize(
        "name", ["arm", "arm_2", "arm-2", "arm.2", "a__b", "_arm", "__arm", "Arm", "worlds", "größe"]
    )
    def test_harmless(self, tmp_path: Path, name: str) -> None:
        assert not check_text(tmp_path, model(name, name + "_joint"), codes={"NAM001"}).findings

    @pytest.mark.parametrize(
        ("name", "message", "severity"),
        [
            ("", "empty", Severity.WARNING),
            ("my arm", "space", Severity.WARNING),
            ("/arm", "leading_slash", Severity.WARNING),
            ("left::arm", "scope", Severity.WARNING),
            ("__arm__", "reserved", Severity.WARNING),
            ("world", "world", Severity.WARNING),
            ("left/arm", "slash", Severity.INFO),
            ("2nd", "digit", Severity.INFO),
        ],
    )
    def test_kinds(self, tmp_path: Path, name: str, message: str, severity: Severity) -> None:
        (finding,) = check_text(tmp_path, model(name), codes={"NAM001"}).findings
        assert (finding.message_id, finding.severity) == (message, severity)

    def test_world_as_the_root_is_a_convention(self, tmp_path: Path) -> None:
        text = model("arm").replace("base", "world")
        assert not check_text(tmp_path, text, codes={"NAM001"}).findings

    def test_all_names_of_a_kind_are_one_finding(self, tmp_path: Path) -> None:
        (finding,) = check_text(tmp_path, model("2nd", "1st"), codes={"NAM001"}).findings
        assert len(finding.subjects) == 2


class TestNAM003:
    @pytest.mark.parametrize(
        ("robot", "package", "included"),
        [
            ("panda", "franka_description", "hand"),
            ("husky", "husky_description", "husky_wheel"),
            ("fanuc_m16ib20", "fanuc_m16ib_support", "fanuc_common"),
            ("ur", "ur_description", "ur_macro"),
            ("left_arm", "right_arm_description", "arm_macro"),
        ],
    )
    def test_names_that_differ_for_good_reasons(self, tmp_path: Path, robot: str, package: str, included: str) -> None:
        folder = tmp_path / package
        folder.mkdir()
        (folder / "package.xml").write_text(f"<package><name>{package}</name></package>")
        (folder / "part.xacro").write_text(f'<robot name="{included}" {XACRO}/>')
        path = folder / f"{robot}.urdf.xacro"
        path.write_text(
            f'<robot name="{robot}" {XACRO}><xacro:include filename="part.xacro"/><link name="base"/></robot>'
        )
        assert not check(path, codes={"NAM003"}).findings

    @pytest.mark.parametrize(
        ("name", "file", "found"),
        [
            ("quadroped", "quadruped", True),
            ("allegro_hand_left", "allegro_left_hand", False),
            ("left_gripper", "gripper_left", False),
            ("solo", "solo12", False),
            ("kr10r900", "kr10r1100", False),
            ("panda", "pando", False),
        ],
    )
    def test_misspelt(self, tmp_path: Path, name: str, file: str, found: bool) -> None:
        run = check_text(tmp_path, f'<robot name="{name}"><link name="a"/></robot>', f"{file}.urdf", codes={"NAM003"})
        assert bool(run.findings) == found
