"""PKG: what the pages cannot show: severities, edits, one finding for one cause."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from conftest import check

from urdfcheck.core import Applicability, Finding, Run, Severity

CODES = {"PKG001", "PKG002", "PKG003", "PKG004"}


def link(name: str, *filenames: str) -> str:
    roles = ("visual", "collision")
    shapes = (f'<{r}><geometry><mesh filename="{f}"/></geometry></{r}>' for r, f in zip(roles, filenames, strict=False))
    return f'<link name="{name}">' + "".join(shapes) + "</link>\n"


def package(folder: Path, *files: str, depends: str = "") -> Path:
    """A package ``p`` with empty files, and the path of its model."""
    root = folder / "p"
    for name in ("urdf/r.urdf", *files):
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text("", encoding="utf-8")
    depend = f"<depend>{depends}</depend>" if depends else ""
    (root / "package.xml").write_text(f"<package><name>p</name>{depend}</package>", encoding="utf-8")
    return root / "urdf/r.urdf"


def audit(model: Path, *links: str, codes: set[str] = CODES) -> Run:
    model.write_text(f'<robot name="r">\n{"".join(links)}</robot>', encoding="utf-8")
    run = check(model, codes=codes)
    assert not run.failures
    return run


def only(run: Run) -> Finding:
    (finding,) = run.findings
    return finding


def test_one_finding_for_each_unknown_package_with_all_its_files(tmp_path: Path) -> None:
    run = audit(package(tmp_path), link("a", "package://q/a.stl", "package://q/b.stl"), link("b", "package://q/a.stl"))
    finding = only(run)
    assert (finding.code, finding.severity) == ("PKG001", Severity.ERROR)
    assert finding.data["files"] == ["package://q/a.stl", "package://q/b.stl"]
    assert len(finding.related) == 2
    assert finding.location.span is not None
    assert (finding.location.span.line, finding.location.span.end_col - finding.location.span.col) == (2, 1)


def test_declared_dependency_that_is_not_installed_is_an_info(tmp_path: Path) -> None:
    finding = only(audit(package(tmp_path, depends="q"), link("a", "package://q/a.stl")))
    assert (finding.message_id, finding.severity) == ("files-declared", Severity.INFO)


def test_hyphen_for_underscore_names_the_package_that_is_meant(tmp_path: Path) -> None:
    model = package(tmp_path, "meshes/a.stl")
    (tmp_path / "my_arm").mkdir()
    (tmp_path / "my_arm/package.xml").write_text("<package><name>my_arm</name></package>", encoding="utf-8")
    finding = only(audit(model, link("a", "package://my-arm/a.stl")))
    assert finding.data["near"] == ["my_arm"]
    assert finding.fix is not None
    assert [e.replacement for e in finding.fix.edits] == ["package://my_arm/a.stl"]
    assert finding.fix.applicability is Applicability.UNSAFE


def test_path_without_a_package_name(tmp_path: Path) -> None:
    assert only(audit(package(tmp_path), link("a", "package:///p/a.stl"))).message_id == "nameless"


@pytest.mark.parametrize(
    ("depends", "explicit", "severity"),
    [
        ("", True, Severity.ERROR),
        ("", False, Severity.ERROR),
        ("q", True, Severity.ERROR),  # named, and could not be checked: never quiet
        ("q", False, Severity.INFO),
    ],
)
def test_package_that_the_expansion_needs(tmp_path: Path, depends: str, explicit: bool, severity: Severity) -> None:
    model = package(tmp_path, depends=depends)
    model.unlink()
    model = model.with_suffix(".urdf.xacro")
    model.write_text(
        '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><link name="a"/>'
        '<xacro:include filename="$(find q)/a.xacro"/></robot>',
        encoding="utf-8",
    )
    run = check(model if explicit else tmp_path, codes=CODES)
    assert only(run).severity == severity
    assert run.models[0].status == "failed"


def test_visual_and_collision_of_one_missing_file_are_one_finding(tmp_path: Path) -> None:
    model = package(tmp_path, "meshes/b.stl")
    finding = only(audit(model, link("a", "package://p/meshes/a.stl", "../meshes/a.stl"), link("b", "../meshes/b.stl")))
    assert (finding.code, finding.message_id, len(finding.related)) == ("PKG002", "file", 1)


def test_missing_folder_is_one_finding(tmp_path: Path) -> None:
    model = package(tmp_path)
    finding = only(audit(model, link("a", "package://p/meshes/x/a.stl"), link("b", "package://p/meshes/y/b.stl")))
    assert finding.message_id == "folder"
    assert finding.data["links"] == ["a", "b"]


def test_folder_in_a_files_place_is_called_one(tmp_path: Path) -> None:
    model = package(tmp_path, "meshes/b.stl")
    finding = only(audit(model, link("a", "package://p/meshes", "../meshes"), link("b", "package://p/meshes/b.stl")))
    assert (finding.code, finding.message_id, finding.data["what"]) == ("PKG002", "kind", "a folder")
    assert len(finding.related) == 1


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes on this platform")
def test_pipe_in_a_files_place_is_called_one(tmp_path: Path) -> None:
    model = package(tmp_path, "meshes/b.stl")
    os.mkfifo(tmp_path / "p/meshes/a.stl")
    finding = only(audit(model, link("a", "package://p/meshes/a.stl")))
    assert (finding.code, finding.message_id) == ("PKG002", "kind")


def test_file_of_the_same_name_elsewhere_in_the_package_is_named(tmp_path: Path) -> None:
    model = package(tmp_path, "meshes/visual/a.stl", "meshes/b.stl")
    finding = only(audit(model, link("a", "package://p/meshes/a.stl")))
    assert [Path(n).parts[-2:] for n in finding.data["near"]] == [("visual", "a.stl")]


def test_texture_is_not_told_twice(tmp_path: Path) -> None:
    """A texture that does not exist belongs to the rule on materials."""
    texture = '<material name="m"><texture filename="package://p/a.png"/></material>'
    assert not audit(package(tmp_path), texture).findings


def test_files_that_a_macro_names_in_one_text_are_one_finding(tmp_path: Path) -> None:
    model = package(tmp_path, "meshes/x.stl")
    model.unlink()
    model = model.with_suffix(".urdf.xacro")
    model.write_text(
        '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:macro name="m" params="n">\n'
        + link("${n}", "package://p/meshes/${n}.stl")
        + '</xacro:macro><xacro:m n="a"/><xacro:m n="b"/></robot>',
        encoding="utf-8",
    )
    finding = only(check(model, codes=CODES))
    assert finding.message_id == "several"
    assert finding.data["files"] == ["package://p/meshes/a.stl", "package://p/meshes/b.stl"]


def test_wrong_case_is_corrected_in_the_path_only(tmp_path: Path) -> None:
    model = package(tmp_path, "Meshes/Wheel.STL")
    finding = only(audit(model, link("a", "package://p/meshes/wheel.stl")))
    assert finding.code == "PKG003"
    assert finding.fix is not None
    assert finding.fix.applicability is Applicability.SAFE
    assert [(e.expected, e.replacement) for e in finding.fix.edits] == [("meshes/wheel.stl", "Meshes/Wheel.STL")]


def test_absolute_path_into_the_package_gets_its_package_path(tmp_path: Path) -> None:
    model = package(tmp_path, "meshes/a.stl")
    mesh = (tmp_path / "p/meshes/a.stl").as_posix()
    finding = only(audit(model, link("a", mesh, mesh)))
    assert (finding.code, finding.message_id) == ("PKG004", "here-only")
    assert finding.fix is not None
    assert [e.replacement for e in finding.fix.edits] == ["package://p/meshes/a.stl"] * 2


def test_machine_path_is_told_once_whether_or_not_it_may_be_looked_at(tmp_path: Path) -> None:
    finding = only(audit(package(tmp_path), link("a", "file:///nowhere/a.stl")))
    assert (finding.code, finding.message_id) == ("PKG004", "unread")
    model = package(tmp_path)
    finding = only(audit(model, link("a", f"file://{model.parent}/nowhere/a.stl")))
    assert (finding.code, finding.message_id) == ("PKG004", "nowhere")


def test_path_that_xacro_computes_is_no_machine_path_but_must_exist(tmp_path: Path) -> None:
    model = package(tmp_path, "meshes/b.stl")
    model.unlink()
    model = model.with_suffix(".urdf.xacro")
    head = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">'
    model.write_text(head + link("a", "file://$(find p)/meshes/a.stl") + "</robot>", encoding="utf-8")
    assert only(check(model, codes=CODES)).code == "PKG002"


@pytest.mark.parametrize(
    ("name", "message", "good"),
    [
        ("car-3", "hyphen", "car_3"),
        ("MyArm", "illegal", "my_arm"),
        ("3wheels", "illegal", "robot_3wheels"),
        ("arm.x", "illegal", "arm_x"),
        ("a", "short", "a"),
        ("my__arm", "double", "my_arm"),
        ("arm2", None, None),
    ],
)
def test_package_names(tmp_path: Path, name: str, message: str | None, good: str | None) -> None:
    model = package(tmp_path)
    (tmp_path / "p/package.xml").write_text(f"<package>\n<name>{name}</name></package>", encoding="utf-8")
    found = audit(model, '<link name="a"/>', codes={"PKG006"}).findings
    assert [(f.message_id, f.data["good"]) for f in found] == ([(message, good)] if message else [])
    assert all(f.location.span is not None and f.location.span.line == 2 for f in found)
