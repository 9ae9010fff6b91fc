"""PKG001, PKG002, PKG004, PKG011, PKG012: which files a path means, and what the text says where the path is right elsewhere."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from builders import box, collision, link, mesh, robot, visual
from conftest import check, command

from urdfcheck.core import Finding, Severity


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


def include(package: str, file: str) -> str:
    return robot(f'<xacro:include filename="$(find {package})/{file}"/>', xacro=True)


@pytest.mark.parametrize(
    ("manifest", "package", "repair"),
    [
        (
            "",
            "arm_description",
            "if the project is the package, add a package.xml with its name there (`--package arm_de",
        ),
        (
            "package.xml",
            "arm_support",
            "if that file is meant, write `$(find arm)/parts/urdf/hand.xacro` (`--package arm",
        ),
        ("package.xml", "tesseract_support", "if that file is meant, write `$(find arm)/parts/urdf/hand.xacro`"),
    ],
)
def test_an_include_of_a_package_that_is_a_folder_around_the_model(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, manifest: str, package: str, repair: str
) -> None:
    monkeypatch.chdir(tmp_path)
    write(tmp_path, ".git/HEAD")
    parts = tmp_path / "parts" if manifest else tmp_path
    if manifest:
        write(tmp_path, manifest, text="<package><name>arm</name></package>")
    write(parts, "urdf/hand.xacro", text=robot(link("hand"), xacro=True))
    write(parts, "urdf/arm.xacro", text=include(package, "urdf/hand.xacro"))
    (finding,) = check(parts / "urdf/arm.xacro", codes={"PKG001"}).findings
    assert finding.message_id == "expansion"
    assert finding.severity is Severity.ERROR
    assert "has the file as" in finding.message
    assert get_repair(finding).startswith(repair)


def test_a_file_that_includes_one_of_its_own_name_from_elsewhere_is_not_it(tmp_path: Path) -> None:
    write(tmp_path, ".git/HEAD")
    write(tmp_path, "urdf/arm.xacro", text=include("arm_description", "urdf/arm.xacro"))
    (finding,) = check(tmp_path / "urdf/arm.xacro", codes={"PKG001"}).findings
    assert "has the file" not in finding.message
    assert "package.xml with its name" not in get_repair(finding)


@pytest.mark.parametrize(
    ("folders", "place"),
    [(["meshes"], "../meshes"), (["meshes", "old"], ""), (["other_robot/meshes"], "")],
)
def test_the_only_folder_with_all_files_of_a_missing_package_is_named(
    tmp_path: Path, folders: list[str], place: str
) -> None:
    names = ("a.stl", "b.stl", "c.stl")
    write(tmp_path, ".git/HEAD", *(f"{folder}/{name}" for folder in folders for name in names))
    typed = [f"package://biped/meshes/legs/{name}" for name in names]
    finding = find(tmp_path / "urdf/r.urdf", *typed, code="PKG001")
    assert ("the files are in" in finding.message) == bool(place)
    assert (f"`{place}/a.stl`" in get_repair(finding)) == bool(place)


def test_a_released_package_is_not_a_folder_with_its_files(tmp_path: Path) -> None:
    names = ("base.dae", "shoulder.dae", "forearm.dae")
    write(tmp_path, ".git/HEAD", *(f"meshes/{name}" for name in names))
    typed = [f"package://ur_description/meshes/ur5/visual/{name}" for name in names]
    assert find(tmp_path / "urdf/r.urdf", *typed, code="PKG001").message_id == "files-released"


@pytest.mark.parametrize(("package", "is_source"), [("arm", True), ("my_arm", False)])
def test_xacro_made_a_file_of_the_package_that_its_header_names(tmp_path: Path, package: str, is_source: bool) -> None:
    write(tmp_path, ".git/HEAD")
    write(tmp_path, "arm/package.xml", text="<package><name>arm</name></package>")
    write(tmp_path, "arm/urdf/arm.urdf.xacro", text=robot(link("base"), xacro=True))
    made_of = f"/home/ann/ws/install/{package}/share/{package}/urdf/arm.urdf.xacro"
    header = f"<!-- |  This document was autogenerated by xacro from {made_of} | -->"
    text = f"<?xml version='1.0'?>\n{header}\n{robot(link('l', visual(mesh(f'package://{package}_gone/a.stl'))))}"
    write(tmp_path, "scripts/arm.urdf", text=text)
    (finding,) = check(tmp_path / "scripts/arm.urdf", codes={"PKG001"}).findings
    assert ("xacro generated this file from ../arm/urdf/arm.urdf.xacro" in get_repair(finding)) == is_source


@pytest.mark.parametrize(
    ("build", "archive", "ignored", "is_made"),
    [
        ("execute_process(COMMAND ${CMAKE_COMMAND} -E tar xzf ${file})", "meshes/meshes.tar.xz", "*.dae", True),
        ("file(ARCHIVE_EXTRACT INPUT meshes/all.zip)", "meshes/all.zip", "*.dae", True),
        ("execute_process(COMMAND tar xzf ${file})", "meshes/readme.txt", "*.dae", False),
        ("execute_process(COMMAND tar xzf ${file})", "docs/docs.tar.gz", "*.dae", False),
        ("execute_process(COMMAND tar xzf ${file})", "meshes/meshes.tar.xz", "*.stl", False),
        ("find_package(catkin REQUIRED)", "meshes/meshes.tar.xz", "*.dae", False),
    ],
)
def test_a_build_may_unpack_meshes_that_git_leaves_out(
    tmp_path: Path, build: str, archive: str, ignored: str, is_made: bool
) -> None:
    write(tmp_path, ".git/HEAD", f"car/{archive}", "car/meshes/notes.txt")
    write(tmp_path, ".gitignore", text=ignored)
    write(tmp_path, "car/package.xml", text="<package><name>car</name></package>")
    write(tmp_path, "car/CMakeLists.txt", text=build)
    finding = find(tmp_path / "car/urdf/car.urdf", "package://car/meshes/wheel.dae", code="PKG002")
    assert finding.severity is (Severity.INFO if is_made else Severity.ERROR)
    assert ("build car first: its CMakeLists.txt unpacks archives, and " in get_repair(finding)) == is_made


@pytest.mark.parametrize(
    ("folder", "script", "ignored", "is_made"),
    [
        ("g1_description", "wget https://a.org/all.zip\nmv all/g1_description .\n", "*_description/", True),
        ("g1_description", "wget https://a.org/all.zip\nmv all/g1_description .\n", "*.txt", False),
        ("g1_description", "# mv all/g1_description .\nwget https://a.org/all.zip\n", "*_description/", False),
        ("g1_description", "convert g1_description/a.stl\n", "*_description/", False),
        ("meshes", "wget https://a.org/all.zip\nmv all/meshes .\n", "meshes/", False),
    ],
)
def test_a_script_may_fetch_the_folder_that_git_leaves_out(
    tmp_path: Path, folder: str, script: str, ignored: str, is_made: bool
) -> None:
    write(tmp_path, ".git/HEAD")
    write(tmp_path, ".gitignore", text=ignored)
    write(tmp_path, "g1/HOWTO.sh", text=script)
    finding = find(tmp_path / "g1/g1.urdf", f"{folder}/a.stl", code="PKG002")
    assert finding.severity is (Severity.INFO if is_made else Severity.ERROR)
    assert ("HOWTO.sh, which names g1_description and may fetch or make it" in get_repair(finding)) == is_made


@pytest.mark.parametrize(("mark", "severity"), [("# ", Severity.INFO), ("", Severity.ERROR)])
def test_a_model_in_a_comment_is_not_named(tmp_path: Path, mark: str, severity: Severity) -> None:
    write(tmp_path, "p/package.xml", text="<package><name>p</name></package>")
    write(tmp_path, "p/config/leg.yaml", text=f"odometry:\n  {mark}urdf: urdfs/old.urdf\n  urdf: urdfs/new.urdf\n")
    assert find(tmp_path / "p/urdfs/old.urdf", "package://gone/a.stl", code="PKG001").severity is severity


@pytest.mark.parametrize(
    ("file", "text", "severity"),
    [
        ("run.py", "ROOT = '/workspace/sim'", Severity.WARNING),
        ("Dockerfile", "COPY . /workspace", Severity.WARNING),
        ("run.py", "ROOT = f'{here}/workspace/sim'", Severity.ERROR),
        ("run.py", "ROOT = '/home/ann'", Severity.ERROR),
    ],
)
def test_a_path_into_the_folder_where_the_project_is_meant_to_lie_is_a_warning(
    tmp_path: Path, file: str, text: str, severity: Severity
) -> None:
    folder = "/home/ann" if "ann" in text else "/workspace"
    write(tmp_path, ".git/HEAD")
    write(tmp_path, file, text=text)
    assert find(tmp_path / "urdf/r.urdf", f"{folder}/a.stl", code="PKG004").severity is severity


@pytest.mark.parametrize(("model", "is_named"), [("robot.urdf", True), ("arm.urdf", False)])
def test_a_script_that_replaces_backslashes_is_to_be_changed_too(tmp_path: Path, model: str, is_named: bool) -> None:
    write(tmp_path, ".git/HEAD", "assets/a.stl")
    write(tmp_path, "fix_paths.py", text="text = open('robot.urdf').read().replace('package://assets\\\\', '')")
    repair = get_repair(find(tmp_path / model, "package://assets\\a.stl", code="PKG011"))
    assert repair.startswith("write `package://assets/a.stl`")
    assert ("fix_paths.py replaces `package://assets\\`: change it too" in repair) == is_named


def test_a_package_that_a_property_names_is_reported_where_it_is_typed(tmp_path: Path) -> None:
    """xacro evaluates a property where it is first read, which is far from the name of the package."""
    write(tmp_path, "arm/package.xml", text="<package><name>arm</name></package>")
    write(tmp_path, "arm/config/arm.yaml", text="length: 1")
    text = (
        '<xacro:property name="file" value="$(find old_arm)/config/arm.yaml"/>\n'
        '<xacro:property name="sizes" value="${xacro.load_yaml(file)}"/>\n'
    )
    base = link("base", visual(box("${sizes['length']} 1 1")))
    write(tmp_path, "arm/urdf/arm.xacro", text=robot(text, base, xacro=True))
    (finding,) = check(tmp_path / "arm/urdf/arm.xacro", codes={"PKG001"}).findings
    assert finding.location.span is not None
    assert finding.location.span.line == 1
    assert "did you mean arm, which has this file?" in finding.message


@pytest.mark.parametrize(
    ("path", "file", "begin"),
    [
        ("package://${folder}/a.stl", "a.stl", "write `file://` in place of `package://`"),
        ("package://${folder}/b.stl", "a.stl", "write `package://NAME/…`"),
        ("package:///arm/a.stl", "a.stl", "write `package://NAME/…`"),
    ],
)
def test_a_folder_from_the_root_is_no_package(tmp_path: Path, path: str, file: str, begin: str) -> None:
    write(tmp_path, "arm/package.xml", text="<package><name>arm_description</name></package>")
    write(tmp_path, f"arm/meshes/{file}")
    folder = '<xacro:property name="folder" value="$(find arm_description)/meshes"/>'
    text = robot(folder, link("base", visual(mesh(path))), xacro=True)
    write(tmp_path, "arm/urdf/arm.xacro", text=text)
    (finding,) = check(tmp_path / "arm/urdf/arm.xacro", codes={"PKG001"}).findings
    assert finding.message_id == "nameless"
    assert get_repair(finding).startswith(begin)


@pytest.mark.parametrize(("folder", "severity"), [("old_files", Severity.INFO), ("gold_files", Severity.ERROR)])
def test_a_model_in_a_folder_of_old_files_is_kept_aside(tmp_path: Path, folder: str, severity: Severity) -> None:
    write(tmp_path, "arm/package.xml", text="<package><name>arm</name></package>")
    assert find(tmp_path / f"arm/{folder}/arm.urdf", "package://arm/meshes/a.stl", code="PKG002").severity is severity


def test_a_path_in_an_included_file_is_written_from_the_model(tmp_path: Path) -> None:
    write(tmp_path, ".git/HEAD", "meshes/a.stl")
    macro = '<xacro:macro name="hand"><link name="hand">{}</link></xacro:macro>'
    shape = visual(mesh("package://hand_description/meshes/a.stl"))
    write(tmp_path, "xacro/hand.xacro", text=robot(macro.format(shape), xacro=True))
    parts = '<xacro:include filename="../../xacro/hand.xacro"/><xacro:hand/>'
    write(tmp_path, "sim/xacro/arm.xacro", text=robot(parts, xacro=True))
    (finding,) = check(tmp_path / "sim/xacro/arm.xacro", codes={"PKG001"}).findings
    repair = get_repair(finding)
    assert repair.startswith("ROS needs a package.xml with the name hand_description")
    assert (
        "write the path from the model, `../../meshes/a.stl`: a model in another folder that includes hand.xacro"
        in repair
    )


@pytest.mark.parametrize("with_mesh", [True, False])
def test_no_program_loses_a_shape_without_its_texture(tmp_path: Path, with_mesh: bool) -> None:
    paint = '<material name="paint"><texture filename="package://gone/a.png"/></material>'
    shape = mesh("package://gone/a.stl") if with_mesh else box("1 1 1")
    drawn = visual(shape).replace("</visual>", f"{paint}</visual>")
    write(tmp_path, "r.urdf", text=robot(link("l", drawn)))
    (finding,) = check(tmp_path / "r.urdf", codes={"PKG001"}).findings
    assert finding.severity is (Severity.ERROR if with_mesh else Severity.WARNING)
    assert ("drops" in finding.consequences["rviz"]) == with_mesh
    assert ("drake" in finding.consequences) == with_mesh


@pytest.mark.parametrize(("mark", "message"), [("#", "expansion-aside"), ("", "expansion-undeclared")])
def test_a_xacro_that_only_a_remark_of_a_script_names_is_left_aside(tmp_path: Path, mark: str, message: str) -> None:
    """The other model may be in a remark too: it shows that the package has files that are used elsewhere."""
    write(tmp_path, "p/package.xml", text="<package><name>p</name></package>")
    write(tmp_path, "p/patches/copy.sh", text=f"{mark}cp library.urdf.xacro /opt\n#cp gazebo.urdf.xacro /opt\n")
    write(tmp_path, "p/patches/library.urdf.xacro", text=include("ur_description", "urdf/common.xacro"))
    (finding,) = check(tmp_path / "p/patches/library.urdf.xacro", codes={"PKG001"}).findings
    assert finding.message_id == message


@pytest.mark.parametrize(("file", "is_reported"), [("größe.stl", False), ("my base.stl", True)])
def test_letters_of_a_file_that_is_found_are_told_on_request(tmp_path: Path, file: str, is_reported: bool) -> None:
    write(tmp_path, f"meshes/{file}")
    write_model(tmp_path / "r.urdf", f"meshes/{file}")
    for options, expected in (((), is_reported), (("-v",), True)):
        report = json.loads(command("r.urdf", "--format", "json", *options, cwd=tmp_path).stdout)
        assert ("PKG011" in {finding["code"] for finding in report["findings"]}) is expected


@pytest.mark.parametrize(
    ("package", "file", "clone", "message", "severity"),
    [
        ("ur_description", "README.md", "", "expansion-undeclared", Severity.WARNING),
        ("arms", "README.md", "git clone https://h/u/arms", "expansion-undeclared", Severity.WARNING),
        ("arms", "Dockerfile", "RUN git clone https://h/u/arms.git", "expansion-undeclared", Severity.WARNING),
        ("arms", "README.md", "git clone https://h/u/legs", "expansion", Severity.ERROR),
        ("p_parts", "README.md", "git clone https://h/u/p_parts", "expansion", Severity.ERROR),  # p has the file
    ],
)
def test_a_model_whose_package_can_be_had_elsewhere_lacks_a_declaration(
    tmp_path: Path, package: str, file: str, clone: str, message: str, severity: Severity
) -> None:
    write(tmp_path, ".git/HEAD")
    write(tmp_path, file, text=clone)
    write(tmp_path, "p/package.xml", text="<package><name>p</name></package>")
    write(tmp_path, "p/urdf/parts.xacro", text="<robot/>")
    part = "parts" if package == "p_parts" else "arm"
    write(tmp_path, "p/urdf/r.urdf.xacro", text=include(package, f"urdf/{part}.xacro"))
    (finding,) = check(tmp_path / "p/urdf/r.urdf.xacro", codes={"PKG001"}).findings
    assert (finding.message_id, finding.severity, finding.blocks_check) == (message, severity, True)


ROS_1, ROS_2 = "<buildtool_depend>catkin</buildtool_depend>", "<export><build_type>ament_cmake</build_type></export>"


@pytest.mark.parametrize(
    ("package", "build", "is_right"),
    [
        ("robot_pose_ekf", ROS_1, True),
        ("robot_pose_ekf", ROS_2, False),
        ("robotiq_description", ROS_2, True),
        ("robotiq_description", ROS_1, False),
        ("robotiq_description", "", True),
        ("robotiq_description", ROS_1 + ROS_2, True),
        ("robotiq_description", ROS_2.replace("</export>", "<build_type>catkin</build_type></export>"), True),
        ("ur_description", ROS_1, True),
    ],
)
def test_a_package_released_for_the_other_ros_is_not_to_be_installed(
    tmp_path: Path, package: str, build: str, is_right: bool
) -> None:
    write(tmp_path, "p/package.xml", text=f"<package><name>p</name>{build}</package>")
    write(tmp_path, "p/urdf/r.urdf.xacro", text=include(package, "urdf/a.xacro"))
    (finding,) = check(tmp_path / "p/urdf/r.urdf.xacro", codes={"PKG001"}).findings
    assert (finding.message_id, finding.severity) == ("expansion-undeclared", Severity.WARNING)
    assert ("but not for ROS" in finding.message) != is_right
    assert ("install it" in get_repair(finding)) == is_right


@pytest.mark.parametrize(
    ("file", "text", "is_known"),
    [
        ("README.md", "It uses the robot of the package **big_arm_description**.", True),
        ("README.md", "cd ~/ws/src/big_arm_description", True),
        ("README.md", "It uses big_arm_description_2.", False),
        ("README.md", "# big_arm_description", False),  # the project itself
        ("README.md", "roslaunch big_arm_description show.launch", False),  # an old name, perhaps
        ("p/.setup_assistant", "moveit_setup_assistant_config:\n  URDF:\n    package: big_arm_description\n", True),
        ("p/.setup_assistant", "moveit_setup_assistant_config:\n  urdf:\n    package: small_arm\n", False),
        ("p/package.xml", "<package><name>p</name><exec_depend>big_arm_control</exec_depend></package>", True),
        ("p/package.xml", "<package><name>p</name><exec_depend>bigger_control</exec_depend></package>", False),
    ],
)
def test_a_package_that_the_project_names_lacks_a_declaration(
    tmp_path: Path, file: str, text: str, is_known: bool
) -> None:
    write(tmp_path, ".git/HEAD")
    write(tmp_path, "p/package.xml", text="<package><name>p</name></package>")
    write(tmp_path, file, text=text)
    write(tmp_path, "p/urdf/r.urdf.xacro", text=include("big_arm_description", "urdf/arm.xacro"))
    (finding,) = check(tmp_path / "p/urdf/r.urdf.xacro", codes={"PKG001"}).findings
    wanted = ("expansion-undeclared", Severity.WARNING) if is_known else ("expansion", Severity.ERROR)
    assert (finding.message_id, finding.severity, finding.blocks_check) == (*wanted, True)


@pytest.mark.parametrize("others", [(), ("p/xacro/old/hand.xacro",)])
def test_the_only_file_of_the_name_in_the_own_package_may_be_meant(tmp_path: Path, others: tuple[str, ...]) -> None:
    write(tmp_path, "p/package.xml", text="<package><name>p</name></package>")
    write(tmp_path, "p/xacro/gripper/hand.xacro", *others, text="<robot/>")
    write(tmp_path, "p/xacro/r.urdf.xacro", text=include("big_arm_description", "xacro/hand.xacro"))
    (finding,) = check(tmp_path / "p/xacro/r.urdf.xacro", codes={"PKG001"}).findings
    named = "if xacro/gripper/hand.xacro of p is meant, write `$(find p)/xacro/gripper/hand.xacro`; else "
    assert get_repair(finding).startswith(named) == (not others)


def test_a_file_that_the_build_installs_at_the_path_is_meant(tmp_path: Path) -> None:
    text = "<package><name>p</name><export><build_type>ament_cmake</build_type></export></package>"
    write(tmp_path, "p/package.xml", text=text)
    write(tmp_path, "p/CMakeLists.txt", text="install(DIRECTORY description/urdf DESTINATION share/p)")
    write(tmp_path, "p/description/urdf/arm.xacro", text="<robot/>")
    write(tmp_path, "p/description/urdf/r.urdf.xacro", text=include("big_arm", "urdf/arm.xacro"))
    (finding,) = check(tmp_path / "p/description/urdf/r.urdf.xacro", codes={"PKG001"}).findings
    assert (finding.message_id, finding.data["near"]) == ("expansion", ["p"])


@pytest.mark.parametrize(
    ("file", "text", "severity", "begin"),
    [
        ("README.md", "Download the folder `meshes` and put it there.", Severity.WARNING, "download meshes, as README"),
        (
            "README.md",
            "Download the robot. A folder `meshes` is needed",
            Severity.WARNING,
            "download meshes, as README",
        ),
        ("README.md", "Download the robot.\nIts folder is `meshes`.", Severity.ERROR, "correct the path"),
        ("README.md", "Download the folder `textures`.", Severity.ERROR, "correct the path"),
        ("load.py", "re.sub(r'filename=\"meshes/', f'filename=\"{share}/', text)", Severity.INFO, "nothing if only"),
        ("load.py", "text.replace('filename=\"meshes/', '')", Severity.INFO, "nothing if only"),
        ("load.py", "text.replace('filename=\"textures/', '')", Severity.ERROR, "correct the path"),
        ("load.py", "text.replace('meshes/', '')", Severity.ERROR, "correct the path"),  # of another file, perhaps
    ],
)
def test_a_folder_that_is_downloaded_or_replaced_is_no_error(
    tmp_path: Path, file: str, text: str, severity: Severity, begin: str
) -> None:
    write(tmp_path, ".git/HEAD")
    write(tmp_path, file, text=text)
    write_model(tmp_path / "robot/arm.urdf", "meshes/a.stl", "meshes/b.stl")
    (finding,) = check(tmp_path / "robot/arm.urdf", codes={"PKG002"}).findings
    assert (finding.message_id, finding.severity) == ("folder", severity)
    assert get_repair(finding).startswith(begin)


@pytest.mark.parametrize(
    ("file", "line", "is_copied"),
    [
        ("docker/Dockerfile.cart", "COPY docker/files/cart.urdf.xacro /ws/src/cart/urdf/cart.urdf.xacro", True),
        (
            "docker-compose.yaml",
            "  command: bash -c 'cp src/x/files/cart.urdf.xacro src/cart/urdf/ && roslaunch a b'",
            True,
        ),
        ("docker/Dockerfile", "# COPY docker/files/cart.urdf.xacro /ws", False),
        ("docker/Dockerfile", "COPY docker/other/cart.urdf.xacro /ws", False),
        ("docker/Dockerfile", "RUN cat docker/files/cart.urdf.xacro", False),
    ],
)
@pytest.mark.parametrize("in_package", [True, False])
def test_a_model_that_is_copied_into_an_image_needs_its_packages_there(
    tmp_path: Path, file: str, line: str, is_copied: bool, in_package: bool
) -> None:
    write(tmp_path, ".git/HEAD")
    write(tmp_path, file, text=f"{line}\n")
    if in_package:
        write(tmp_path, "docker/files/package.xml", text="<package><name>files</name></package>")
    write(tmp_path, "docker/files/cart.urdf.xacro", text=include("cart_wheels", "urdf/wheel.xacro"))
    (finding,) = check(tmp_path / "docker/files/cart.urdf.xacro", codes={"PKG001"}).findings
    wanted = ("expansion-copied", Severity.INFO) if is_copied else ("expansion", Severity.ERROR)
    assert (finding.message_id, finding.severity, finding.blocks_check) == (*wanted, True)
    assert get_repair(finding).startswith("nothing if the image has") == is_copied


@pytest.mark.parametrize("has_all", [True, False])
def test_a_folder_is_meant_by_a_package_if_it_has_all_included_files(tmp_path: Path, has_all: bool) -> None:
    write(tmp_path, "p/package.xml", text="<package><name>p</name></package>")
    write(tmp_path, "p/urdf/materials.xacro", *(["p/urdf/arm.xacro"] if has_all else []), text="<robot/>")
    files = ("urdf/materials.xacro", "urdf/arm.xacro")
    text = "".join(f'<xacro:include filename="$(find ur_description)/{file}"/>' for file in files)
    write(tmp_path, "p/urdf/r.urdf.xacro", text=robot(text, xacro=True))
    (finding,) = check(tmp_path / "p/urdf/r.urdf.xacro", codes={"PKG001"}).findings
    assert get_repair(finding).startswith("if that file is meant, write `$(find p)/urdf/materials.xacro`") == has_all
