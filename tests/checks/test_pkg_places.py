"""PKG001, PKG002, PKG004: a path that leads nowhere while the project has the file in another place."""

from __future__ import annotations

from pathlib import Path

import pytest
from builders import link, mesh, visual
from conftest import check

from urdfcheck.core import Finding, Severity


def write(root: Path, *names: str, text: str = "") -> None:
    for name in names:
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(text, encoding="utf-8")


def find(model: Path, *filenames: str, code: str) -> Finding:
    """Return the only finding about a model that draws these meshes."""
    links = "\n".join(link(f"l{n}", visual(mesh(name))) for n, name in enumerate(filenames))
    write(model.parent, model.name, text=f'<robot name="r">\n{links}</robot>')
    run = check(model, codes={code})
    assert not run.failures
    (finding,) = run.findings
    return finding


@pytest.mark.parametrize(
    ("files", "old", "severity", "message", "repair", "bullet"),
    [
        # Bullet joins the path to the model's folder; no ROS package is around it.
        ("robot/a.stl", "package:///a.stl", Severity.WARNING, "beside the model", "`a.stl`", "loads it"),
        (
            "meshes/a.stl",
            "package://robot_description/meshes/a.stl",
            Severity.ERROR,
            "in ../meshes",
            "`../me",
            "refuses",
        ),
        ("other/a.stl", "package://meshes/a.stl", Severity.ERROR, "", "package://NAME/meshes/", "refuses"),
        ("robot/a.txt", "package://gone/a.stl", Severity.ERROR, "", "correct the name", "refuses"),
    ],
)
def test_the_place_of_files_is_named_where_there_is_no_package(
    tmp_path: Path, files: str, old: str, severity: Severity, message: str, repair: str, bullet: str
) -> None:
    (tmp_path / ".git").mkdir()
    write(tmp_path, files)
    finding = find(tmp_path / "robot/r.urdf", old, code="PKG001")
    assert finding.severity == severity
    assert message in finding.message
    assert finding.fix is not None
    assert repair in finding.fix.title
    assert "package.xml or" not in finding.fix.title
    assert finding.consequences["bullet"].startswith(bullet)


def test_nothing_is_said_of_folders_above_a_lone_model_that_were_not_read(tmp_path: Path) -> None:
    write(tmp_path, "urdf/r.urdf", "notes/a.txt")
    finding = find(tmp_path / "urdf/r.urdf", "package://gone/a.stl", code="PKG001")
    assert finding.consequences["bullet"].startswith("loads it if a folder above has the files")


@pytest.mark.parametrize(("folder", "findings"), [("arm", []), ("clone", [("rosbuild", Severity.INFO)])])
def test_a_package_of_rosbuild_has_the_name_of_its_folder(
    tmp_path: Path, folder: str, findings: list[tuple[str, Severity]]
) -> None:
    root = tmp_path / folder
    write(root, "manifest.xml", text="<package><author>me</author></package>")
    write(root, "meshes/a.stl")
    links = link("l", visual(mesh("package://arm/meshes/a.stl")))
    write(root, "robots/r.urdf", text=f'<robot name="r">{links}</robot>')
    run = check(root / "robots/r.urdf", codes={"PKG001", "PKG002"})
    assert [(f.message_id, f.severity) for f in run.findings] == findings


@pytest.mark.parametrize("named", [True, False])
def test_a_similar_package_without_the_file_is_not_suggested(tmp_path: Path, named: bool) -> None:
    (tmp_path / ".git").mkdir()
    write(tmp_path / "p", "package.xml", text="<package><name>p</name></package>")
    write(tmp_path / "robot_description", "package.xml", text="<package><name>robot_description</name></package>")
    write(tmp_path / "robot_description", *(["meshes/a.stl"] if named else []))
    # Two files: no package has all of them.
    urls = ("package://rrbot_description/meshes/a.stl", "package://rrbot_description/meshes/b.stl")
    finding = find(tmp_path / "p/urdf/r.urdf", *urls, code="PKG001")
    assert finding.data["near"] == (["robot_description"] if named else [])
    assert ("did you mean" in finding.message) == named


@pytest.mark.parametrize(
    ("name", "near"),
    [("ercole_desription", ["ercole_description"]), ("ercole_navigation", []), ("arm2_desription", [])],
)
def test_a_misspelt_suffix_is_recognised(tmp_path: Path, name: str, near: list[str]) -> None:
    (tmp_path / ".git").mkdir()
    write(tmp_path / "e", "package.xml", text="<package><name>ercole_description</name></package>")
    write(tmp_path / "e", "urdf/b.xacro", text='<robot xmlns:xacro="http://www.ros.org/wiki/xacro"/>')
    include = f'<xacro:include filename="$(find {name})/urdf/b.xacro"/>'
    text = f'<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">{include}<link name="l"/></robot>'
    write(tmp_path / "e", "urdf/r.urdf.xacro", text=text)
    (finding,) = check(tmp_path / "e/urdf/r.urdf.xacro", codes={"PKG001"}).findings
    assert finding.data["near"] == near


def test_relative_paths_to_a_folder_one_level_up_are_written_from_the_model(tmp_path: Path) -> None:
    (tmp_path / ".git").mkdir()
    write(tmp_path, "meshes/a.stl", "meshes/b.stl")
    finding = find(tmp_path / "urdf/r.urdf", "meshes/a.stl", "meshes/b.stl", code="PKG002")
    assert finding.fix is not None
    assert [edit.replacement for edit in finding.fix.edits] == ["../meshes/a.stl", "../meshes/b.stl"]
    assert "in ../meshes)" in finding.message
    assert finding.consequences["bullet"].startswith("loads it")
    assert finding.consequences["drake"] == "refuses the file"


SETUP = """from glob import glob
from setuptools import setup
setup(data_files=[("share/p", ["package.xml"]), ("share/p", glob("urdf/*")){}])
"""


@pytest.mark.parametrize(
    ("installs", "place", "programs"),
    [
        # An old copy, and the files that it names are installed in the share folder itself.
        (', ("share/p", glob("meshes/*"))', "old/b.urdf", None),
        (', ("share/p", glob("meshes/*"))', "urdf/b.urdf", {"colcon", "rviz"}),
        ("", "old/b.urdf", {"colcon", "rviz"}),
    ],
)
def test_an_old_copy_of_a_model_needs_no_folder(
    tmp_path: Path, installs: str, place: str, programs: set[str] | None
) -> None:
    build = "<export><build_type>ament_python</build_type></export>"
    write(tmp_path, "package.xml", text=f'<package format="3"><name>p</name>{build}</package>')
    write(tmp_path, "setup.py", text=SETUP.format(installs))
    write(tmp_path, "meshes/a.stl")
    shape = link("l", visual(mesh("package://p/meshes/a.stl")))
    write(tmp_path, place, text=f'<robot name="r">{shape}</robot>')
    findings = check(tmp_path, codes={"PKG008"}).findings
    assert [set(f.consequences) for f in findings] == ([] if programs is None else [programs])


@pytest.mark.parametrize("has_file", [True, False])
def test_a_package_of_another_project_does_not_hide_the_model_s_own_files(tmp_path: Path, has_file: bool) -> None:
    """Two clones in one workspace: one is the package that the other's paths name."""
    (tmp_path / ".git").mkdir()
    write(tmp_path, "clone/package.xml", text='<package format="3"><name>arm</name></package>')
    write(
        tmp_path,
        "mine/urdf/arm.urdf",
        text=f'<robot name="r">{link("l", visual(mesh("package://arm/meshes/a.stl")))}</robot>',
    )
    if has_file:
        write(tmp_path, "mine/meshes/a.stl")
    (finding,) = check(tmp_path / "mine/urdf/arm.urdf", codes={"PKG002"}).findings
    assert finding.fix is not None
    assert ("write the path from this file, `../meshes/a.stl`" in finding.fix.title) == has_file
    assert ("the package arm that is found is another project" in finding.message) == has_file


@pytest.mark.parametrize(
    ("beside", "repair"),
    [
        ("rviz/b.rviz", "glob('rviz/*'))`"),
        ("rviz/deep/b.rviz", "glob('rviz/*.*'))`, and a line for each of its subfolders that is read"),
        ("rviz/show.py", "glob('rviz/*.*'))`"),
        ("rviz/__init__.py", "start what is in rviz by its name in console_scripts"),
    ],
)
def test_the_line_for_setup_py_names_no_folder(tmp_path: Path, beside: str, repair: str) -> None:
    build = "<export><build_type>ament_python</build_type></export>"
    write(tmp_path, "package.xml", text=f'<package format="3"><name>p</name>{build}</package>')
    write(tmp_path, "setup.py", text=SETUP.format(', ("share/p/launch", glob("launch/*"))'))
    for name in ("rviz/a.rviz", beside):
        write(tmp_path, name)
    launch = '<launch><arg name="r" default="$(find-pkg-share p)/rviz/a.rviz"/></launch>'
    write(tmp_path, "launch/a.launch.xml", text=launch)
    write(tmp_path, "urdf/r.urdf", text='<robot name="r"><link name="l"/></robot>')
    (finding,) = check(tmp_path, codes={"PKG008"}).findings
    assert finding.fix is not None
    assert repair in finding.fix.title
    assert finding.fix.title.endswith(repair) or "start" in repair


@pytest.mark.parametrize(
    ("head", "line"),
    [
        ("", "('share/p/rviz', glob('rviz/*'))` (it needs `from glob import glob`)"),
        (
            "package_name = 'p'\n",
            "('share/' + package_name + '/rviz', glob('rviz/*'))` (it needs `from glob import glob`)",
        ),
        ("import os, glob\n", "(os.path.join('share', 'p', 'rviz'), glob.glob('rviz/*'))`"),
        (
            "import os\nfrom glob import glob\npackage_name = 'p'\n",
            "(os.path.join('share', package_name, 'rviz'), glob('rviz/*'))`",
        ),
    ],
)
def test_the_line_for_setup_py_uses_what_it_imports(tmp_path: Path, head: str, line: str) -> None:
    build = "<export><build_type>ament_python</build_type></export>"
    write(tmp_path, "package.xml", text=f'<package format="3"><name>p</name>{build}</package>')
    setup = "from setuptools import setup\nsetup(name='p', data_files=[('share/p/launch', ['launch/a.launch.xml'])])\n"
    write(tmp_path, "setup.py", text=head + setup)
    write(tmp_path, "rviz/a.rviz")
    launch = '<launch><arg name="r" default="$(find-pkg-share p)/rviz/a.rviz"/></launch>'
    write(tmp_path, "launch/a.launch.xml", text=launch)
    write(tmp_path, "urdf/r.urdf", text='<robot name="r"><link name="l"/></robot>')
    (finding,) = check(tmp_path, codes={"PKG008"}).findings
    assert finding.fix is not None
    assert finding.fix.title == f"add to data_files: `{line}"


def test_a_folder_without_meshes_loses_none(tmp_path: Path) -> None:
    build = "<export><build_type>ament_python</build_type></export>"
    write(tmp_path, "package.xml", text=f'<package format="3"><name>p</name>{build}</package>')
    write(tmp_path, "setup.py", text=SETUP.format(', ("share/p/launch", glob("launch/*"))'))
    write(tmp_path, "rviz/a.rviz")
    write(tmp_path, "urdf/r.urdf", text='<robot name="r"><link name="l"/></robot>')
    write(
        tmp_path,
        "launch/a.launch.xml",
        text='<launch><arg name="r" default="$(find-pkg-share p)/rviz/a.rviz"/></launch>',
    )
    (finding,) = check(tmp_path, codes={"PKG008"}).findings
    assert set(finding.consequences) == {"colcon", "ros2_launch"}


@pytest.mark.parametrize(
    ("typed", "edit"),
    [
        ("/home/ann/ws/src/p/meshes/a.stl", "package://p/meshes/a.stl"),
        ("C:/Users/ann/p/meshes/a.stl", "package://p/meshes/a.stl"),
        ("/home/ann/ws/src/q/meshes/a.stl", None),
        ("/home/ann/ws/src/p/meshes/b.stl", None),
    ],
)
def test_the_end_of_a_machine_path_may_be_a_file_of_the_package(tmp_path: Path, typed: str, edit: str | None) -> None:
    write(tmp_path / "p", "package.xml", text="<package><name>p</name></package>")
    write(tmp_path / "p", "meshes/a.stl")
    finding = find(tmp_path / "p/urdf/r.urdf", typed, code="PKG004")
    assert finding.fix is not None
    assert [e.replacement for e in finding.fix.edits] == ([] if edit is None else [edit])
    assert ("move the file into" in finding.fix.title) == (edit is None)


@pytest.mark.parametrize(
    ("typed", "path"),
    [
        ("/home/ann/ws/src/p/mesh/a.stl", "package://p/mesh/a.stl"),
        ("/home/ann/cad/a.stl", "package://p/meshes/a.stl"),
    ],
)
def test_a_file_that_is_on_one_machine_only_has_its_place_in_the_package(tmp_path: Path, typed: str, path: str) -> None:
    (tmp_path / ".git").mkdir()
    write(tmp_path, "p/package.xml", text='<package format="3"><name>p</name></package>')
    write(tmp_path, "p/urdf/r.urdf", text=f'<robot name="r">{link("l", visual(mesh(typed)))}</robot>')
    finding = find(tmp_path / "p/urdf/r.urdf", typed, code="PKG004")
    assert finding.fix is not None
    assert f"write `{path}`" in finding.fix.title


@pytest.mark.parametrize(
    ("there", "repair"),
    [
        (
            ("meshes/b.stl",),
            "write `package://p/meshes/b.stl`, and the others likewise: the package has them, except a.stl, which must be added",
        ),
        ((), "move the file into the model's package and write `package://p/meshes/a.stl`, and the others likewise"),
    ],
)
def test_an_installed_path_says_the_name_of_the_package(tmp_path: Path, there: tuple[str, ...], repair: str) -> None:
    (tmp_path / ".git").mkdir()
    write(tmp_path, "p/package.xml", text='<package format="3"><name>p</name></package>')
    write(tmp_path, *(f"p/{name}" for name in there))
    base = "/home/ann/ws/install/p/share/p/meshes"
    shapes = visual(mesh(f"{base}/a.stl")) + visual(mesh(f"{base}/b.stl"))
    write(tmp_path, "p/urdf/r.urdf", text=f'<robot name="r">{link("l", shapes)}</robot>')
    (finding,) = check(tmp_path / "p/urdf/r.urdf", codes={"PKG004"}).findings
    assert finding.fix is not None
    assert finding.fix.title.startswith(repair)
    assert not finding.fix.edits


@pytest.mark.parametrize(("place", "told"), [("meshes/robot.urdf", False), ("urdf/robot.urdf", True)])
def test_a_model_that_an_exporter_left_beside_the_meshes_names_no_package(
    tmp_path: Path, place: str, told: bool
) -> None:
    write(tmp_path, "package.xml", text='<package format="3"><name>p</name></package>')
    write(tmp_path, "meshes/a.stl")
    shape = link("l", visual(mesh("package://meshes/a.stl")))
    write(tmp_path, place, text=f'<robot name="r">{shape}</robot>')
    assert bool(check(tmp_path, codes={"PKG007"}).findings) == told


@pytest.mark.parametrize(("manifest", "message"), [("manifest.xml", "unknown"), ("notes.xml", "package")])
def test_a_launch_file_of_rosbuild_names_the_folder_that_the_clone_should_have(
    tmp_path: Path, manifest: str, message: str
) -> None:
    write(tmp_path, manifest, text="<package><author>me</author></package>")
    write(tmp_path, ".git/HEAD")
    write(tmp_path, "urdf/r.urdf", text='<robot name="r"><link name="l"/></robot>')
    command = '<param name="robot_description" textfile="$(find hand)/urdf/r.urdf"/>'
    write(tmp_path, "launch/a.launch", text=f"<launch>{command}</launch>")
    (finding,) = check(tmp_path / "launch/a.launch", codes={"LCH001"}).findings
    assert finding.message_id == message


@pytest.mark.parametrize(
    ("files", "begin", "edit"),
    [
        (("r/mesh/a.stl",), "write `mesh/a.stl`: the file is there", ["mesh/a.stl"]),
        (("mesh/a.stl",), "write `../mesh/a.stl`: the file is there", ["../mesh/a.stl"]),
        (
            ("q/package.xml", "q/mesh/a.stl"),
            "write `package://p/mesh/a.stl`: the package has the file",
            ["package://p/mesh/a.stl"],
        ),
        (("r/a.stl",), "move the file into", []),  # any folder may have a file of this name
        (
            ("package.xml", "stl/a.stl"),
            "if stl/a.stl of the package is the file that is meant, write `package://p/stl/a",
            [],
        ),
        (("package.xml", "stl/a.stl", "old/a.stl"), "move the file into", []),
    ],
)
def test_a_machine_path_may_mean_a_file_that_is_here(
    tmp_path: Path, files: tuple[str, ...], begin: str, edit: list[str]
) -> None:
    (tmp_path / ".git").mkdir()
    write(tmp_path, *files, text="<package><name>p</name></package>")
    finding = find(tmp_path / "r/r.urdf", "/home/ann/q/mesh/a.stl", code="PKG004")
    assert finding.fix is not None
    assert finding.fix.title.startswith(begin)
    assert [e.replacement for e in finding.fix.edits] == edit


@pytest.mark.parametrize(
    ("there", "beside", "edit"),
    [
        (("b.stl", "c.stl"), "a.stl", []),
        (("b.stl",), "a.stl", ["BASE.stl"]),
        (("b.stl", "c.stl"), "d.stl", ["BASE.stl"]),
    ],
)
def test_another_spelling_may_be_another_robots_file(
    tmp_path: Path, there: tuple[str, ...], beside: str, edit: list[str]
) -> None:
    """The other files of the model are in a folder that has this name as typed."""
    write(tmp_path / "p", "package.xml", text="<package><name>p</name></package>")
    write(tmp_path / "p/meshes", "BASE.stl", beside, "arm/Base.stl", *(f"arm/{name}" for name in there))
    typed = (f"package://p/meshes/{name}" for name in ("Base.stl", "b.stl", "c.stl", "d.stl"))
    finding = find(tmp_path / "p/urdf/r.urdf", *typed, code="PKG003")
    assert finding.fix is not None
    assert [e.replacement for e in finding.fix.edits] == edit
    assert ("meshes/arm" in finding.fix.title) == (not edit)


MANIFEST = '<package format="3"><name>{}</name><exec_depend>xacro</exec_depend></package>'
ROBOT = '<robot name="r"><link name="base"/></robot>'


@pytest.mark.parametrize(
    ("files", "told"),
    [
        # A folder of that name beside a model that a program exported is no package, whatever else is in the repository.
        (
            {
                "cad/arm.urdf": ROBOT.replace("/>", f">{visual(mesh('package://assets/a.stl'))}</link>"),
                "cad/assets/a.stl": "",
                "assets/x": "",
            },
            {},
        ),
        # The released package `robot` only depends on others.
        (
            {"launch/a.launch": '<launch><param textfile="$(find robot)/urdf/a.urdf"/></launch>'},
            {"dangling": ["robot"]},
        ),
        ({"launch/a.launch": '<launch><arg default="$(find robot)"/></launch>'}, {"undeclared": ["robot"]}),
        ({"old/a.launch": '<launch><arg default="$(find joy)"/></launch>'}, {}),
        ({"launch/a.launch": '<launch><arg default="$(find joy)"/></launch>'}, {"undeclared": ["joy"]}),
        (
            {"launch/a.launch": '<launch><include file="$(find husky_gazebo)/a"/></launch>'},
            {"presumed-circle": ["husky_gazebo"]},
        ),
        (
            {
                "launch/a.launch": '<launch><arg default="$(find husky_gazebo)"/></launch>',
                "../husky_gazebo/package.xml": MANIFEST,
            },
            {"undeclared": ["husky_gazebo"]},
        ),
        ({"launch/a.py": "name = 'joy'\nfolder = FindPackageShare(name)\n"}, {"undeclared": ["joy"]}),
        ({"launch/a.py": "name = 'joy'\nname = 'nav'\nfolder = FindPackageShare(name)\n"}, {}),
        ({"launch/a.py": "def find(name):\n    return FindPackageShare(name)\n"}, {}),
    ],
)
def test_what_a_package_must_declare(tmp_path: Path, files: dict[str, str], told: dict[str, list[str]]) -> None:
    (tmp_path / ".git").mkdir()
    folder = tmp_path / "husky_description"
    write(folder, "package.xml", text=MANIFEST.format(folder.name))
    write(folder, "urdf/r.urdf", text=ROBOT)
    for name, text in files.items():
        write(folder, name, text=text.replace("{}", Path(name).parent.name))
    found = check(folder, codes={"PKG007"}).findings
    assert {f.message_id: f.data["names"] for f in found} == told


def test_a_mesh_that_no_parser_reads_is_not_missing(tmp_path: Path) -> None:
    """A geometry directly in a link is XML003's."""
    stray = link("l", f"<geometry>{mesh('package://gone/a.stl')}</geometry>")
    write(tmp_path, "r.urdf", text=f'<robot name="r">{stray}</robot>')
    assert [f.code for f in check(tmp_path / "r.urdf", codes={"PKG001", "XML003"}).findings] == ["XML003"]


@pytest.mark.parametrize(("mark", "begin"), [("notes.txt", "if the folder is the robot's own"), (".git", "move what")])
def test_a_folder_that_nothing_marks_may_be_of_the_robot(tmp_path: Path, mark: str, begin: str) -> None:
    write(tmp_path, f"robot/{mark}", "cad/a.stl")
    finding = find(tmp_path / "robot/model/r.urdf", "../../cad/a.stl", code="PKG012")
    assert finding.fix is not None
    assert finding.fix.title.startswith(begin)


@pytest.mark.parametrize(
    ("path", "repair"),
    [
        ("/home/ann/ws/src/car/urdf/wheel.xacro", "write `$(find car)/urdf/wheel.xacro`: the package has the file"),
        ("/home/ann/ws/src/car/urdf/axle.xacro", "move what the robot needs into its package"),
        (
            "/home/ann/ws/src/cart/urdf/wheel.xacro",
            "if urdf/wheel.xacro of the package is the file that is meant, write `$(find car)/urdf/wheel.xacro`; else move",
        ),
        ("/home/ann/wheel.xacro", "if urdf/wheel.xacro of the package is the file that is meant"),
        (
            "/home/ann/ws/src/cart/urdf/axle.xacro",
            "if cart is a package, write `$(find cart)/urdf/axle.xacro` and declare it; else move",
        ),
    ],
)
def test_an_include_by_a_path_of_another_machine_is_looked_for_in_the_package(
    tmp_path: Path, path: str, repair: str
) -> None:
    root = tmp_path / "car"
    xmlns = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
    write(root, "package.xml", text='<package format="2"><name>car</name></package>')
    write(root, "urdf/wheel.xacro", text=f'<robot {xmlns}><link name="wheel"/></robot>')
    write(root, "urdf/car.xacro", text=f'<robot name="car" {xmlns}>\n<xacro:include filename="{path}"/>\n</robot>')
    run = check(root / "urdf/car.xacro", codes={"PKG012"})
    (finding,) = run.findings
    assert finding.fix is not None
    assert finding.fix.title.startswith(repair)
    assert finding.message.startswith(f"{path} is outside")
    # The folder is that of another machine: to allow it helps nobody.
    assert "--allow-read" not in finding.fix.title
    assert not finding.data["remedy"]


@pytest.mark.parametrize(("name", "find"), [("all.launch", "find"), ("all.launch.xml", "find-pkg-share")])
def test_a_launch_file_of_the_package_is_named_by_it_whatever_the_authors_machine(
    tmp_path: Path, name: str, find: str
) -> None:
    root = tmp_path / "car"
    (root / "launch").mkdir(parents=True)
    build_type = "ament_cmake" if find == "find-pkg-share" else "catkin"
    (root / "package.xml").write_text(
        f"<package><name>car</name><buildtool_depend>{build_type}</buildtool_depend></package>"
    )
    node = '<node pkg="car" name="n" {}="drive"/>'.format("exec" if find == "find-pkg-share" else "type")
    (root / "launch/world.launch").write_text(f"<launch>{node}</launch>")
    include = '<include file="/home/ann/ws/src/car/launch/world.launch"/>'
    (root / "launch" / name).write_text(f"<launch>{include}{node}</launch>")
    (finding,) = check(root / "launch" / name, codes={"PKG012"}).findings
    assert finding.fix is not None
    assert finding.fix.title == f"write `$({find} car)/launch/world.launch`: the package has the file"


def test_a_xacro_of_rosbuild_in_a_folder_of_another_name_names_the_folder(tmp_path: Path) -> None:
    root = tmp_path / "clone"
    write(root, "manifest.xml", text="<package><author>me</author></package>")
    write(root, "urdf/base.xacro", text='<robot xmlns:xacro="http://www.ros.org/wiki/xacro"/>')
    include = '<xacro:include filename="$(find arm)/urdf/base.xacro"/>'
    write(
        root, "urdf/r.urdf.xacro", text=f'<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">{include}</robot>'
    )
    (finding,) = check(root / "urdf/r.urdf.xacro", codes={"PKG001"}).findings
    assert finding.fix is not None
    assert finding.fix.title.startswith("rename the folder clone to arm: a package of rosbuild")


def test_the_package_of_the_file_that_names_another_declares_it(tmp_path: Path) -> None:
    (tmp_path / ".git").mkdir()
    depends = "<build_depend>gone</build_depend>"
    write(tmp_path / "arm", "package.xml", text=f"<package format='3'><name>arm</name>{depends}</package>")
    write(tmp_path / "cell", "package.xml", text="<package format='3'><name>cell</name></package>")
    space = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
    include = '<xacro:include filename="$(find arm)/urdf/arm.xacro"/>'
    links = link("l", visual(mesh("package://gone/a.stl")))
    write(tmp_path / "arm", "urdf/arm.xacro", text=f"<robot {space}>{links}</robot>")
    write(tmp_path / "cell", "urdf/cell.urdf.xacro", text=f'<robot name="r" {space}>{include}</robot>')
    (finding,) = check(tmp_path / "cell/urdf/cell.urdf.xacro", codes={"PKG001"}).findings
    assert finding.message_id == "files-declared"
    assert finding.fix is not None
    assert "declares it only for the build: add `<exec_depend>gone</exec_depend>`" in finding.fix.title
