"""PKG001, PKG002, PKG004, PKG011, PKG012: which files a path means, and what the text says where the path is right elsewhere."""

from __future__ import annotations

from pathlib import Path

import pytest
from builders import box, collision, link, mesh, robot, visual
from conftest import check

from urdfcheck.core import Finding


def write(root: Path, *names: str, text: str = "") -> None:
    for name in names:
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(text, encoding="utf-8")


def write_model(path: Path, *filenames: str) -> None:
    links = "\n".join(link(f"l{n}", visual(mesh(name))) for n, name in enumerate(filenames))
    write(path.parent, path.name, text=f'<robot name="r">\n{links}</robot>')


def find(model: Path, *filenames: str, code: str) -> Finding:
    """Return the only finding about a model that draws these meshes."""
    write_model(model, *filenames)
    run = check(model, codes={code})
    assert not run.failures
    (finding,) = run.findings
    return finding


def get_repair(finding: Finding) -> str:
    assert finding.fix is not None
    return finding.fix.title


@pytest.mark.parametrize("is_first", [True, False])
def test_a_mesh_behind_another_shape_of_its_geometry_is_not_missing(tmp_path: Path, is_first: bool) -> None:
    """urdfdom reads the first shape alone: XML006 reports the second."""
    shapes = [mesh("package://gone/a.stl"), box("1 1 1")]
    write(tmp_path, "r.urdf", text=robot(link("l", collision("".join(shapes if is_first else shapes[::-1])))))
    codes = {finding.code for finding in check(tmp_path / "r.urdf", codes={"PKG001", "XML006"}).findings}
    assert codes == ({"PKG001", "XML006"} if is_first else {"XML006"})


@pytest.mark.parametrize(
    ("folder", "is_found"),
    [("car", True), ("car-master", True), ("car-main", True), ("car-2", False), ("cart", False)],
)
def test_a_download_of_a_branch_has_the_name_of_the_package(tmp_path: Path, folder: str, is_found: bool) -> None:
    write(tmp_path, "car/package.xml", text="<package><name>car</name></package>")
    write(tmp_path, "car/parts/a.stl", "car/parts/b.stl")
    typed = [f"file:///home/ann/ws/src/{folder}/parts/{name}" for name in ("a.stl", "b.stl", "c.stl")]
    repair = get_repair(find(tmp_path / "car/car.urdf", *typed, code="PKG004"))
    assert ("write `package://car/parts/a.stl`, and the others likewise" in repair) == is_found
    assert ("except c.stl, which must be added" in repair) == is_found


def test_a_machine_path_into_several_packages_names_what_each_has(tmp_path: Path) -> None:
    """Files of the model's package, one that it lacks, and those of a package that is installed elsewhere."""
    write(tmp_path, "arm/package.xml", text="<package><name>arm</name></package>")
    write(tmp_path, "arm/meshes/a.stl")
    place = "file:///root/ws/install/{0}/share/{0}/meshes/{1}.stl"
    named = [("arm", "a"), ("arm", "bracket"), ("gripper", "finger")]
    repair = get_repair(find(tmp_path / "arm/arm.urdf", *(place.format(*one) for one in named), code="PKG004"))
    assert repair.startswith("write `package://arm/meshes/a.stl`, and the others likewise")
    assert "declare gripper in package.xml" in repair
    assert repair.endswith(": bracket.stl must be added")


@pytest.mark.parametrize(
    ("typed", "message"),
    [
        ("file:///absolute/path/to/the/cad/a.stl", "placeholder"),
        ("/path/to/a.stl", "placeholder"),
        ("/home/ann/path/tools/a.stl", "unread"),
    ],
)
def test_a_path_that_is_to_be_filled_in_is_of_no_machine(tmp_path: Path, typed: str, message: str) -> None:
    write(tmp_path, ".git/HEAD", "cad/a.stl")
    finding = find(tmp_path / "urdf/r.urdf", typed, code="PKG004")
    assert finding.message_id == message
    assert ("machine" in finding.message) == (message == "unread")
    assert ("write `../cad/a.stl`" in get_repair(finding)) == ("cad/" in typed)


@pytest.mark.parametrize(
    ("manifest", "files", "meant"),
    [
        ("package.xml", ("parts/meshes/a.stl", "parts/meshes/b.stl"), "../parts/meshes/a.stl"),
        (".git/HEAD", ("meshes/a.stl", "meshes/b.stl"), "../meshes/a.stl"),
        (".git/HEAD", ("meshes/a.stl",), ""),
        (".git/HEAD", ("meshes/a.stl", "meshes/b.stl", "old/b.stl"), ""),
    ],
)
def test_a_path_out_of_the_project_names_the_only_files_of_these_names_in_it(
    tmp_path: Path, manifest: str, files: tuple[str, ...], meant: str
) -> None:
    write(tmp_path / "p", manifest, text="<package><name>p</name></package>")
    write(tmp_path / "p", *files)
    repair = get_repair(find(tmp_path / "p/urdf/r.urdf", "../../meshes/a.stl", "../../meshes/b.stl", code="PKG012"))
    assert (f"write `{meant}`, and the others likewise; else move" in repair) == bool(meant)
    assert "--allow-read" in repair
