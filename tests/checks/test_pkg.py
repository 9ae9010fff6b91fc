"""PKG: what the pages cannot show: severities, edits, one finding for one cause."""

from __future__ import annotations

import os
import timeit
from collections.abc import Mapping
from pathlib import Path

import pytest
from builders import collision, link, mesh, visual
from conftest import check

from urdfcheck.cli import FINDINGS, compute_exit_code
from urdfcheck.core import Applicability, Finding, Run, Severity
from urdfcheck.source.package.package_folders import drop_comments

pytestmark = pytest.mark.slow

CODES = {"PKG001", "PKG002", "PKG003", "PKG004"}


@pytest.fixture(autouse=True)
def _repository(tmp_path: Path) -> None:
    """Packages are looked for up to the repository: those of other tests are none of ours."""
    (tmp_path / ".git").mkdir()


def make_mesh_link(name: str, *filenames: str) -> str:
    """Return a link that draws the first mesh and collides with the second."""
    return link(name, *(shape(mesh(f)) for shape, f in zip((visual, collision), filenames, strict=False))) + "\n"


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
    run = audit(
        package(tmp_path),
        make_mesh_link("a", "package://q/a.stl", "package://q/b.stl"),
        make_mesh_link("b", "package://q/a.stl"),
    )
    finding = only(run)
    assert (finding.code, finding.severity) == ("PKG001", Severity.ERROR)
    assert finding.data["files"] == ["package://q/a.stl", "package://q/b.stl"]
    assert len(finding.related) == 2
    assert finding.location.span is not None
    assert (finding.location.span.line, finding.location.span.end_col - finding.location.span.col) == (2, 1)


def test_declared_dependency_that_is_not_installed_is_an_info(tmp_path: Path) -> None:
    finding = only(audit(package(tmp_path, depends="q"), make_mesh_link("a", "package://q/a.stl")))
    assert (finding.message_id, finding.severity) == ("files-declared", Severity.INFO)


def test_hyphen_for_underscore_names_the_package_that_is_meant(tmp_path: Path) -> None:
    model = package(tmp_path, "meshes/a.stl")
    (tmp_path / "my_arm").mkdir()
    (tmp_path / "my_arm/package.xml").write_text("<package><name>my_arm</name></package>", encoding="utf-8")
    finding = only(audit(model, make_mesh_link("a", "package://my-arm/a.stl")))
    assert finding.data["near"] == ["my_arm"]
    assert finding.fix is not None
    assert [e.replacement for e in finding.fix.edits] == ["package://my_arm/a.stl"]
    assert finding.fix.applicability is Applicability.UNSAFE


@pytest.mark.parametrize(
    ("there", "repair"),
    [
        (("a.stl", "b.stl"), "correct the name; if"),
        (("a.stl",), "correct the name and the paths (my_arm has 1 of 2 files); if"),
        ((), "correct the name and the paths (my_arm lacks the files); if"),
    ],
)
def test_a_package_that_is_meant_may_lack_files(tmp_path: Path, there: tuple[str, ...], repair: str) -> None:
    model = package(tmp_path)
    write(tmp_path / "my_arm", {"package.xml": manifest(name="my_arm"), **dict.fromkeys(there, "")})
    paths = "package://my-arm/a.stl", "package://my-arm/b.stl"
    finding = only(audit(model, make_mesh_link("a", *paths)))
    assert finding.fix is not None
    assert finding.fix.title.startswith(repair)


def test_path_without_a_package_name(tmp_path: Path) -> None:
    assert only(audit(package(tmp_path), make_mesh_link("a", "package:///p/a.stl"))).message_id == "nameless"


@pytest.mark.parametrize(
    ("files", "hint"),
    [
        (("meshes/Sonar.stl", "meshes/base.stl"), " (p has the files as meshes/Sonar.stl, meshes/base.stl)"),
        (("meshes/Sonar.stl",), ""),
        (("meshes/sonar.stl", "meshes/base.stl"), ""),
        (("meshes/Sonar.stl", "spare/Sonar.stl", "meshes/base.stl"), ""),  # which one is open
    ],
)
def test_files_of_an_unknown_package_are_named_where_the_own_package_has_them(
    tmp_path: Path, files: tuple[str, ...], hint: str
) -> None:
    links = make_mesh_link("a", "package://old/parts/Sonar.stl"), make_mesh_link("b", "package://old/base.stl")
    assert only(audit(package(tmp_path, *files), *links)).data["hint"] == hint
    if hint:
        assert only(audit(package(tmp_path, *files, depends="old"), *links)).data["hint"] == ""


@pytest.mark.parametrize(
    ("files", "hint"),
    [
        (("visual/link.dae", "collision/link.STL"), " (p has the files as visual/link.dae, collision/link.STL)"),
        (("drawn/link.dae", "collision/link.STL"), ""),  # one file does not take the place of two
    ],
)
def test_a_mesh_in_its_folder_is_meant_before_one_of_its_name_elsewhere(
    tmp_path: Path, files: tuple[str, ...], hint: str
) -> None:
    link = make_mesh_link("a", "package://old/visual/link.STL", "package://old/collision/link.STL")
    assert only(audit(package(tmp_path, *files), link)).data["hint"] == hint


@pytest.mark.parametrize(("count", "begin"), [(3, "write p instead, which has 3 of 4 files"), (2, "add the package")])
def test_the_own_package_that_has_most_files_at_their_paths_is_named(tmp_path: Path, count: int, begin: str) -> None:
    links = [make_mesh_link(name, f"package://old/meshes/{name}.stl") for name in "abcd"]
    finding = only(audit(package(tmp_path, *(f"meshes/{name}.stl" for name in "abcd"[:count])), *links))
    assert finding.fix is not None
    assert finding.fix.title.startswith(begin)
    assert not finding.fix.edits


@pytest.mark.parametrize(
    ("depends", "explicit", "severity"),
    [
        ("", True, Severity.ERROR),
        ("", False, Severity.ERROR),
        ("q", True, Severity.INFO),  # the model may be right
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
    assert compute_exit_code(run, "error") == FINDINGS  # it could not be checked: never green, however it was found
    assert run.models[0].status == "failed"


@pytest.mark.parametrize("depends", ["", "arms"])
@pytest.mark.parametrize(
    ("path", "held", "hint", "begin", "end"),
    [
        (
            "lib/arms",
            "",
            " (its submodule is not checked out)",
            "check out its submodule: `git submodule update --init lib/arms`.",
            "",
        ),
        ("arms_ros", "", "", "if it is in a submodule (arms_ros), check that out: `git submodule update --init`;", ""),
        ("lib", "", "", "", "; if a submodule that is not checked out has it (lib), `git submodule update --init`"),
        ("lib", "lib/README.md", "", "", ""),
        ("../arms", "", "", "", ""),  # out of reach
    ],
)
def test_a_package_may_be_in_a_submodule_that_is_not_checked_out(
    tmp_path: Path, depends: str, path: str, held: str, hint: str, begin: str, end: str
) -> None:
    write(tmp_path, {".gitmodules": f'[submodule "q"]\n\tpath = {path}\n\turl = u\n', **({held: ""} if held else {})})
    finding = only(audit(package(tmp_path, depends=depends), make_mesh_link("a", "package://arms/a.stl")))
    assert finding.fix is not None
    assert f"package arms is not {'installed here' if depends else 'found'}{hint}, " in finding.message
    assert finding.fix.title.startswith(begin or ("install" if depends else "add the package and declare it"))
    assert end in finding.fix.title
    assert ("submodule" in finding.fix.title) == bool(begin or end)


def test_a_submodule_in_another_package_has_no_package(tmp_path: Path) -> None:
    path = "driver/include/lib"
    write(
        tmp_path, {".gitmodules": f'[submodule "q"]\n\tpath = {path}\n\turl = u\n', "driver/package.xml": "<package/>"}
    )
    finding = only(audit(package(tmp_path), make_mesh_link("a", "package://arms/a.stl")))
    assert finding.fix is not None
    assert "submodule" not in finding.fix.title


@pytest.mark.parametrize(
    ("file", "beside", "user", "message"),
    [
        ("p/test/r.urdf", "", "", "files-kept"),
        ("p/urdf/r_orig.urdf", "p/urdf/r.urdf", "", "files-kept"),
        ("p/urdf/r_orig.urdf", "p/urdf/r.urdf", "load('r_orig.urdf')", "files"),
        ("p/urdf/r_orig.urdf", "p/urdf/s.urdf", "", "files"),
        ("p/urdf/r.urdf", "p/urdf/r_orig.urdf", "", "files"),
    ],
)
def test_a_model_of_a_test_or_an_original_lacks_a_package_on_request(
    tmp_path: Path, file: str, beside: str, user: str, message: str
) -> None:
    manifest = {"p/package.xml": "<package><name>p</name></package>", "p/load.py": user, ".git/HEAD": ""}
    write(tmp_path, {file: "", **({beside: ""} if beside else {}), **manifest})
    finding = only(audit(tmp_path / file, make_mesh_link("a", "package://arms/a.stl")))
    assert (finding.message_id, finding.severity) == (message, Severity.ERROR if message == "files" else Severity.INFO)


@pytest.mark.parametrize(
    ("path", "message"), [("model://wing/a.stl", "files-model"), ("package://wing/a.stl", "files")]
)
def test_a_model_of_gazebo_is_no_package(tmp_path: Path, path: str, message: str) -> None:
    assert only(audit(package(tmp_path), make_mesh_link("a", path))).message_id == message
    own = only(audit(package(tmp_path / "own", "parts/a.stl"), make_mesh_link("a", path)))
    assert own.message_id == "files"
    assert own.fix is not None
    assert own.fix.title.startswith("write `package://p/parts/a.stl`, if these files are meant")


@pytest.mark.parametrize("path", ["package://arms/{}.stl", "{}.stl", "P/{}.STL", "p/{}.stl"])
@pytest.mark.parametrize(
    ("names", "moveit", "gazebo"),
    [("a", "loads it", "(no visual)"), ("aa", "drops", "(no visual, no contact)"), ("-a", "drops", "(no contact)")],
)
def test_each_program_loses_what_it_uses(tmp_path: Path, path: str, names: str, moveit: str, gazebo: str) -> None:
    folder = package(tmp_path, "urdf/P/a.stl")
    pointer = folder.parent / "p" / "a.stl"
    pointer.parent.mkdir(exist_ok=True)
    pointer.write_text("version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1234\n")
    shapes = [
        make(mesh(path.format(name))) for name, make in zip(names, (visual, collision), strict=False) if name != "-"
    ]
    found = audit(folder, link("a", *shapes), codes=CODES | {"PKG009"}).findings
    assert found
    for finding in found:
        assert finding.consequences["moveit"].startswith(moveit)
        assert gazebo in finding.consequences["gazebo"]


SIM = "SetEnvironmentVariable('GZ_SIM_RESOURCE_PATH', os.path.join(get_package_share_directory('p'), 'assets'))"


@pytest.mark.parametrize(
    ("launch", "path", "message", "severity"),
    [
        (SIM, "model://meshes/a.stl", "files-path", Severity.INFO),
        (SIM + "\nNode(package='rviz2')", "model://meshes/a.stl", "files-path", Severity.WARNING),
        (SIM, "package://meshes/a.stl", "files", Severity.ERROR),
        ("# " + SIM, "model://meshes/a.stl", "files", Severity.ERROR),
        (SIM.replace("assets", "worlds"), "model://meshes/a.stl", "files", Severity.ERROR),
        (SIM, "model://mesh/a.stl", "files", Severity.ERROR),
    ],
)
def test_gazebo_finds_a_folder_to_which_a_launch_file_leads_it(
    tmp_path: Path, launch: str, path: str, message: str, severity: Severity
) -> None:
    folder = package(tmp_path, "assets/meshes/a.stl")
    write(tmp_path, {"p/launch/sim.launch.py": launch})
    finding = only(audit(folder, make_mesh_link("a", path)))
    assert (finding.message_id, finding.severity) == (message, severity)


@pytest.mark.parametrize(
    ("launch", "path", "message", "severity"),
    [
        (SIM, "model://p/a.stl", "gazebo-path", Severity.INFO),
        (SIM + "\nNode(package='rviz2')", "model://p/a.stl", "gazebo-path", Severity.WARNING),
        (SIM, "package://p/a.stl", "file", Severity.ERROR),
        ("# " + SIM, "model://p/a.stl", "file", Severity.ERROR),
        (SIM.replace("assets", "worlds"), "model://p/a.stl", "file", Severity.ERROR),
        (SIM, "model://p/b.stl", "file", Severity.ERROR),
    ],
)
def test_a_model_of_gazebo_may_have_the_name_of_its_package(
    tmp_path: Path, launch: str, path: str, message: str, severity: Severity
) -> None:
    folder = package(tmp_path, "assets/p/a.stl")
    write(tmp_path, {"p/launch/sim.launch.py": launch})
    finding = only(audit(folder, make_mesh_link("a", path)))
    assert (finding.message_id, finding.severity) == (message, severity)
    assert finding.fix is not None
    assert ("`package://p/assets/p/a.stl`" in finding.fix.title) == (message == "gazebo-path")


def test_a_file_that_gazebo_lacks_too_is_missing_beside_those_that_it_finds(tmp_path: Path) -> None:
    folder = package(tmp_path, "assets/p/a.stl")
    write(tmp_path, {"p/launch/sim.launch.py": SIM})
    found = audit(folder, make_mesh_link("a", "model://p/a.stl", "model://p/b.stl")).findings
    assert {finding.message_id for finding in found} == {"gazebo-path", "file"}


@pytest.mark.parametrize(
    ("launch", "is_led"),
    [
        ('<env name="GAZEBO_MODEL_PATH" value="$(find p)/assets"/>', True),
        ('<!-- <env name="GAZEBO_MODEL_PATH" value="$(find p)/assets"/>', False),
        ('<env name="SDF_PATH" value="$(find p)/assets"/>', True),
        ('SDF_PATH = join(share, "assets", "world.sdf")', False),
    ],
)
def test_only_a_variable_of_gazebo_leads_it_to_a_folder(tmp_path: Path, launch: str, is_led: bool) -> None:
    folder = package(tmp_path, "assets/meshes/a.stl")
    write(tmp_path, {"p/launch/a.launch": launch})
    finding = only(audit(folder, make_mesh_link("a", "model://meshes/a.stl")))
    assert finding.message_id == ("files-path" if is_led else "files")


def test_comments_that_nothing_closes_take_linear_time() -> None:
    def measure(count: int) -> float:
        text = "<!--" * count
        return min(timeit.repeat(lambda: drop_comments(text), number=1, repeat=9))

    # 8 times the text takes 8 times as long, or 64 times if the end of each comment is searched anew.
    assert measure(16_000) < 24 * measure(2_000)


@pytest.mark.parametrize(
    ("readme", "message"), [("export GAZEBO_MODEL_PATH=$PWD/models", "files-gazebo"), ("a robot", "files")]
)
def test_a_folder_on_the_path_of_gazebo_needs_no_package(tmp_path: Path, readme: str, message: str) -> None:
    write(tmp_path, {"README.md": readme, ".git/HEAD": "", "models/wing/a/a.stl": "", "matlab/m/r.urdf": ""})
    finding = only(audit(tmp_path / "matlab/m/r.urdf", make_mesh_link("a", "package://wing/a/a.stl")))
    assert finding.message_id == message


@pytest.mark.parametrize(
    ("path", "user", "message", "severity"),
    [
        ("model://wing/../../meshes/a.stl", "", "files-gazebo", Severity.INFO),
        ("model://wing/../../meshes/a.stl", "Node(package='rviz2')", "files-gazebo", Severity.WARNING),
        ("package://wing/../../meshes/a.stl", "", "files", Severity.ERROR),
        ("model://wing/a.stl", "", "files", Severity.ERROR),
        ("model://wing/../../meshes/a.stl", "load('other.urdf')", "files-gazebo", Severity.INFO),
        ("package://wing/../../meshes/a.stl", "load('other.urdf')", "files-aside", Severity.INFO),
    ],
)
def test_gazebo_may_find_a_model_of_its_own_where_ros_finds_no_package(
    tmp_path: Path, path: str, user: str, message: str, severity: Severity
) -> None:
    folder = package(tmp_path, "meshes/a.stl", "sdf/wing/model.config")
    write(tmp_path, {".git/HEAD": "", "p/launch/a.launch.py": user})
    finding = only(audit(folder, make_mesh_link("a", path)))
    assert (finding.message_id, finding.severity) == (message, severity)
    finds = ".." in path
    assert finding.consequences["gazebo"].startswith("loads the shapes if" if finds else "drops the shapes (")
    assert ("sdf/wing has" in finding.message) == finds
    assert finding.fix is not None
    assert "`package://p/meshes/a.stl`" in finding.fix.title


def test_a_folder_of_the_name_that_lacks_the_file_is_not_the_one_that_is_meant(tmp_path: Path) -> None:
    write(tmp_path, {".git/HEAD": "", "arm/meshes/a.stl": "", "arm/robots/arm/r.urdf": ""})
    assert not audit(tmp_path / "arm/robots/arm/r.urdf", make_mesh_link("a", "package://arm/meshes/a.stl")).findings


def test_a_name_that_is_too_long_for_a_file_is_a_missing_one(tmp_path: Path) -> None:
    options = '<mujoco><compiler meshdir="m" strippath="true"/></mujoco>'
    text = options + make_mesh_link("a", f"package://arm/{'a' * 5000}.stl")
    assert [finding.code for finding in audit(tmp_path / "r.urdf", text).findings] == ["PKG001"]


@pytest.mark.parametrize(
    ("build", "severity"),
    [
        ("execute_process(COMMAND gunzip -k meshes/a.stl.gz)", Severity.INFO),
        ("execute_process(COMMAND gunzip -k meshes/fora.stl.gz meshes/a.stl-old)", Severity.ERROR),
        ("install(FILES meshes/a.stl DESTINATION share)", Severity.ERROR),
        ("configure_file(a.in b)\ninstall(FILES meshes/a.stl DESTINATION share)", Severity.ERROR),
        ("configure_file(a.in b)  # meshes/a.stl", Severity.ERROR),
    ],
)
def test_a_build_may_make_a_mesh_that_git_ignores(tmp_path: Path, build: str, severity: Severity) -> None:
    model = package(tmp_path, "meshes/b.stl")
    write(tmp_path / "p", {"CMakeLists.txt": build, ".gitignore": "meshes/a.stl"})
    finding = only(audit(model, make_mesh_link("a", "package://p/meshes/a.stl")))
    assert (finding.code, finding.severity) == ("PKG002", severity)


@pytest.mark.parametrize(("named", "severity"), [("a.stl b.stl", Severity.INFO), ("a.stl", Severity.ERROR)])
def test_a_build_that_makes_the_meshes_names_each(tmp_path: Path, named: str, severity: Severity) -> None:
    build = f"add_custom_command(OUTPUT {named} COMMAND unpack)"
    model = package(tmp_path, "c.stl")
    write(tmp_path / "p", {"CMakeLists.txt": build, ".gitignore": "meshes/"})
    shapes = "".join(make_mesh_link(name, f"package://p/meshes/{name}.stl") for name in "ab")
    joint = '<joint name="j" type="fixed"><parent link="a"/><child link="b"/></joint>'
    finding = only(audit(model, shapes + joint))
    assert (finding.code, finding.severity) == ("PKG002", severity)


@pytest.mark.parametrize(
    ("name", "severity"), [("ur_description", Severity.WARNING), ("arm_5_description", Severity.ERROR)]
)
def test_files_of_a_released_package_are_there_where_it_is_installed(
    tmp_path: Path, name: str, severity: Severity
) -> None:
    finding = only(audit(package(tmp_path), make_mesh_link("a", f"package://{name}/meshes/a.stl")))
    assert (finding.message_id, finding.severity) == ("files", severity)


def test_another_version_of_a_released_package_may_have_the_mesh(tmp_path: Path) -> None:
    write(tmp_path, {"q/package.xml": "<package><name>ur_description</name></package>", "q/meshes/b.stl": ""})
    finding = only(audit(package(tmp_path), make_mesh_link("a", "package://ur_description/meshes/a.stl")))
    assert finding.fix is not None
    assert finding.fix.title == "correct the path, add the file, or get the version of ur_description that has it"


def test_the_address_of_a_submodule_may_say_what_it_is(tmp_path: Path) -> None:
    first = '[submodule "a"]\n\tpath = lib/a\n\turl = https://h/u/b.git\n'
    write(tmp_path, {".gitmodules": f'{first}[submodule "x"]\n\tpath = x\n\turl = git@h:u/arms.git\n'})
    finding = only(audit(package(tmp_path), make_mesh_link("a", "package://arms_description/a.stl")))
    assert finding.fix is not None
    assert finding.fix.title.startswith("if it is in a submodule (x), check that out")


@pytest.mark.parametrize(
    ("url", "begin"),
    [
        ("https://h/u/arms.git", "import its repository, which needed.repos lists: `vcs import < "),
        ("https://h/u/my_arms.git", "if it is in x/y of needed.repos, import that: `vcs import < "),
        ("https://h/u/legs.git", "install the package"),
    ],
)
def test_a_package_may_be_in_a_repository_that_is_to_be_imported(tmp_path: Path, url: str, begin: str) -> None:
    entry = f"repositories:\n  x/y:\n    type: git\n    url: {url}\n    version: main\n"
    write(tmp_path, {".git/HEAD": "", "needed.repos": entry})
    finding = only(audit(package(tmp_path, depends="arms"), make_mesh_link("a", "package://arms/a.stl")))
    assert finding.fix is not None
    assert finding.fix.title.startswith(begin)


@pytest.mark.parametrize(
    ("command", "begin"),
    [
        ("git clone https://h/u/arms.git", "clone its repository, as README.md says: `git clone https://h/u/arms.git`"),
        (
            "git clone -b main --depth 1 git@h:u/arms",
            "clone its repository, as README.md says: `git clone git@h:u/arms`",
        ),
        ("git clone https://h/u/my_arms.git", "install the package"),
    ],
)
def test_a_package_may_be_in_a_repository_that_the_readme_clones(tmp_path: Path, command: str, begin: str) -> None:
    write(tmp_path, {".git/HEAD": "", "README.md": f"```bash\n{command}\n```\n"})
    finding = only(audit(package(tmp_path, depends="arms"), make_mesh_link("a", "package://arms/a.stl")))
    assert finding.fix is not None
    assert finding.fix.title.startswith(begin)


def test_a_released_package_is_declared(tmp_path: Path) -> None:
    write(tmp_path, {".gitmodules": '[submodule "q"]\n\tpath = lib\n\turl = u\n'})
    finding = only(audit(package(tmp_path), make_mesh_link("a", "package://ur_description/a.stl")))
    assert finding.fix is not None
    begin = "declare it in package.xml and install it"
    meant = ", if the released ur_description is meant; else add the package, or pass `--package ur_description"
    assert finding.fix.title.startswith(begin + meant)
    assert "submodule" not in finding.fix.title


@pytest.mark.parametrize(
    ("beside", "meant"),
    [
        ("<name>ur_robot_driver</name>", ""),  # released with it
        ("<name>q</name><depend>ur_description</depend>", ""),
        ("<name>ur_of_ann</name>", ", if the released ur_description is meant"),
    ],
)
def test_a_released_package_is_meant_where_the_project_has_its_family(tmp_path: Path, beside: str, meant: str) -> None:
    write(tmp_path, {".git/HEAD": "", "q/package.xml": f"<package>{beside}</package>"})
    finding = only(audit(package(tmp_path), make_mesh_link("a", "package://ur_description/a.stl")))
    assert finding.fix is not None
    end = "; else add the package, or pass" if meant else ", or pass"
    assert finding.fix.title.startswith(f"declare it in package.xml and install it{meant}{end}")


def test_of_two_parameters_with_one_default_the_one_that_the_call_leaves_out_is_reported(tmp_path: Path) -> None:
    macro = (
        '<xacro:macro name="m" params="a:=$(find no_such)\n  b:=$(find no_such)"><link name="l${a}${b}"/></xacro:macro>'
    )
    text = f'<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">{macro}<xacro:m a="1"/></robot>'
    write(tmp_path, {"car.urdf.xacro": text})
    (finding,) = check(tmp_path / "car.urdf.xacro", codes={"PKG001"}).findings
    assert finding.location.span is not None
    assert finding.location.span.line == 2


def test_a_missing_package_is_reported_where_the_default_of_a_macro_names_it(tmp_path: Path) -> None:
    arm = '<xacro:macro name="arm" params="prefix\n  limits:=\'$(find ur_description)/limits.yaml\'\n  size:=1"/>'
    car = '<xacro:include filename="arm.xacro"/><xacro:arm prefix=""/><link name="base"/>'
    head = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">'
    files = {"package.xml": "<package><name>car</name></package>"}
    files |= {"arm.xacro": f"{head}{arm}</robot>", "car.urdf.xacro": f"{head}{car}</robot>"}
    write(tmp_path, files)
    (finding,) = check(tmp_path / "car.urdf.xacro", codes={"PKG001"}).findings
    span = finding.location.span
    assert span is not None
    assert (Path(span.file).name, span.line) == ("arm.xacro", 2)
    calls = [Path(place.span.file).name for place in finding.related if place.span is not None]
    assert calls == ["car.urdf.xacro"]


def test_visual_and_collision_of_one_missing_file_are_one_finding(tmp_path: Path) -> None:
    model = package(tmp_path, "meshes/b.stl")
    finding = only(
        audit(
            model,
            make_mesh_link("a", "package://p/meshes/a.stl", "../meshes/a.stl"),
            make_mesh_link("b", "../meshes/b.stl"),
        )
    )
    assert (finding.code, finding.message_id, len(finding.related)) == ("PKG002", "file", 1)


def test_a_path_that_was_put_together_leads_to_its_parts(tmp_path: Path) -> None:
    model = package(tmp_path, "meshes/b.stl").with_suffix(".xacro")
    model.with_name("m.yaml").write_text("arm:\n  mesh: ../meshes/a.stl\n", encoding="utf-8")
    model.write_text(
        '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">'
        '<xacro:property name="all" value="${xacro.load_yaml(\'m.yaml\')}"/>'
        + make_mesh_link("a", "${all['arm']['mesh']}")
        + "</robot>",
        encoding="utf-8",
    )
    finding = only(check(model, codes=CODES))
    assert [place.subject for place in finding.related] == ["property[all]", "yaml[arm.mesh]"]


def test_missing_folder_is_one_finding(tmp_path: Path) -> None:
    model = package(tmp_path)
    finding = only(
        audit(
            model, make_mesh_link("a", "package://p/meshes/x/a.stl"), make_mesh_link("b", "package://p/meshes/y/b.stl")
        )
    )
    assert finding.message_id == "folder"
    assert finding.data["links"] == ["a", "b"]


def test_folder_in_a_files_place_is_called_one(tmp_path: Path) -> None:
    model = package(tmp_path, "meshes/b.stl")
    finding = only(
        audit(
            model,
            make_mesh_link("a", "package://p/meshes", "../meshes"),
            make_mesh_link("b", "package://p/meshes/b.stl"),
        )
    )
    assert (finding.code, finding.message_id, finding.data["what"]) == ("PKG002", "kind", "a folder")
    assert len(finding.related) == 1


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes on this platform")
def test_pipe_in_a_files_place_is_called_one(tmp_path: Path) -> None:
    model = package(tmp_path, "meshes/b.stl")
    os.mkfifo(tmp_path / "p/meshes/a.stl")
    finding = only(audit(model, make_mesh_link("a", "package://p/meshes/a.stl")))
    assert (finding.code, finding.message_id) == ("PKG002", "kind")


def test_file_of_the_same_name_elsewhere_in_the_package_is_named(tmp_path: Path) -> None:
    model = package(tmp_path, "meshes/visual/a.stl", "meshes/b.stl")
    finding = only(audit(model, make_mesh_link("a", "package://p/meshes/a.stl")))
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
        + make_mesh_link("${n}", "package://p/meshes/${n}.stl")
        + '</xacro:macro><xacro:m n="a"/><xacro:m n="b"/></robot>',
        encoding="utf-8",
    )
    finding = only(check(model, codes=CODES))
    assert finding.message_id == "several"
    assert finding.data["files"] == ["package://p/meshes/a.stl", "package://p/meshes/b.stl"]


def test_wrong_case_is_corrected_in_the_path_only(tmp_path: Path) -> None:
    model = package(tmp_path, "Meshes/Wheel.STL")
    finding = only(audit(model, make_mesh_link("a", "package://p/meshes/wheel.stl")))
    assert finding.code == "PKG003"
    assert finding.fix is not None
    assert finding.fix.applicability is Applicability.SAFE
    assert [(e.expected, e.replacement) for e in finding.fix.edits] == [("meshes/wheel.stl", "Meshes/Wheel.STL")]


@pytest.mark.parametrize(
    ("typed", "there", "repair"),
    [
        ("${n}/Arm.stl", ("a/arm.stl", "b/arm.stl"), "write `arm.stl`"),
        (
            "${n}/Arm.stl",
            ("a/Arm.stl", "b/arm.stl"),
            "rename `arm.stl` to `Arm.stl`, as the other files are spelled that this",
        ),
        ("Arm_${n}.stl", ("Arm_A.stl", "Arm_b.stl"), "rename `Arm_A.stl` to `Arm_a.stl`, as"),
        ("Arm_${n}.stl", ("Arm_A.stl", "Arm_B.stl"), "make the path, which is computed, end in `Arm_A.stl`"),
    ],
)
def test_a_path_of_a_macro_is_not_corrected_for_one_call_alone(
    tmp_path: Path, typed: str, there: tuple[str, ...], repair: str
) -> None:
    model = package(tmp_path, *(f"meshes/{name}" for name in there)).with_suffix(".urdf.xacro")
    model.write_text(
        '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:macro name="m" params="n">\n'
        + make_mesh_link("${n}", f"package://p/meshes/{typed}")
        + '</xacro:macro><xacro:m n="a"/><xacro:m n="b"/></robot>',
        encoding="utf-8",
    )
    finding = check(model, codes=CODES).findings[0]
    assert finding.fix is not None
    assert finding.fix.title.startswith(repair)
    assert bool(finding.fix.edits) == repair.startswith("write")


@pytest.mark.parametrize(
    ("typed", "there", "after"),
    [
        ("meshes/A.stl", "meshes/a.STL", "meshes/a.STL"),
        ("meshes/A.STL", "description/meshes/a.stl", "meshes/a.stl"),
        ("meshes/Parts/a.stl", "description/meshes/parts/A.stl", "meshes/parts/A.stl"),
    ],
)
def test_the_case_of_a_path_is_compared_where_the_file_is_installed_from(
    tmp_path: Path, typed: str, there: str, after: str
) -> None:
    robot = f'<robot name="r">{make_mesh_link("a", f"package://p/{typed}")}</robot>'
    cmake = "install(DIRECTORY description/meshes DESTINATION share/p)"
    write(tmp_path, {"package.xml": manifest(), "urdf/r.urdf": robot, there: "", "CMakeLists.txt": cmake})
    finding = only(check(tmp_path, codes=CODES, tier="source"))
    assert finding.code == "PKG003"
    assert finding.fix is not None
    text = robot
    for edit in reversed(finding.fix.edits):
        text = text[: edit.span.start] + edit.replacement + text[edit.span.end :]
    assert f"package://p/{after}" in text


def test_absolute_path_into_the_package_gets_its_package_path(tmp_path: Path) -> None:
    model = package(tmp_path, "meshes/a.stl")
    mesh = (tmp_path / "p/meshes/a.stl").as_posix()
    finding = only(audit(model, make_mesh_link("a", mesh, mesh)))
    assert (finding.code, finding.message_id) == ("PKG004", "here-only")
    assert finding.fix is not None
    assert [e.replacement for e in finding.fix.edits] == ["package://p/meshes/a.stl"] * 2


def test_machine_path_is_told_once_whether_or_not_it_may_be_looked_at(tmp_path: Path) -> None:
    finding = only(audit(package(tmp_path), make_mesh_link("a", "file:///nowhere/a.stl")))
    assert (finding.code, finding.message_id) == ("PKG004", "unread")
    model = package(tmp_path)
    finding = only(audit(model, make_mesh_link("a", f"file://{model.parent}/nowhere/a.stl")))
    assert (finding.code, finding.message_id) == ("PKG004", "nowhere")


@pytest.mark.parametrize(
    ("typed", "message"),
    [
        ("file://posters/a.stl", "host"),
        ("file://p/meshes/a.stl", "host"),
        ("file://home/ann/a.stl", "unread"),
        ("file://C:/robots/a.stl", "unread"),
        ("file://localhost/home/ann/a.stl", "unread"),
    ],
)
def test_a_folder_in_place_of_the_host_is_of_no_machine(tmp_path: Path, typed: str, message: str) -> None:
    finding = only(audit(package(tmp_path), make_mesh_link("a", typed)))
    assert (finding.code, finding.message_id) == ("PKG004", message)
    assert ("machine" in finding.headline) == (message == "unread")


def test_paths_of_one_machine_are_one_finding(tmp_path: Path) -> None:
    links = (make_mesh_link(f"l{n}", f"file:///usr/Ann/share/{n % 3}/{n}.mesh") for n in range(20))
    finding = only(audit(package(tmp_path), *links))
    assert finding.message.startswith(
        "20 files are referenced by file:// paths of one machine: file:///usr/Ann/share/0/0.mesh"
    )
    assert len(finding.related) == 19
    other = (make_mesh_link("a", "file:///usr/Ann/a.mesh"), make_mesh_link("b", "file:///opt/Bob/b.mesh"))
    assert len(audit(package(tmp_path), *other).findings) == 2


def test_path_that_xacro_computes_is_no_machine_path_but_must_exist(tmp_path: Path) -> None:
    model = package(tmp_path, "meshes/b.stl")
    model.unlink()
    model = model.with_suffix(".urdf.xacro")
    head = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">'
    model.write_text(head + make_mesh_link("a", "file://$(find p)/meshes/a.stl") + "</robot>", encoding="utf-8")
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


@pytest.mark.parametrize(
    ("name", "repair"),
    [
        ("MyArm", "rename the package to `my_arm`, also in its"),
        ("Robot", "rename the package, but not to `robot` (ROS has released a package of that name), also in its"),
        ("Beside", "rename the package, but not to `beside` ("),
    ],
)
def test_a_name_that_another_package_has_is_not_proposed(tmp_path: Path, name: str, repair: str) -> None:
    write(tmp_path, {".git/HEAD": "", "p/package.xml": manifest(name=name), "p/urdf/r.urdf": URDF})
    write(tmp_path, {"b/package.xml": manifest(name="beside"), "b/urdf/r.urdf": URDF})
    (finding,) = findings(tmp_path, "PKG006")
    assert finding.fix is not None
    assert finding.fix.title.startswith(repair)


# -- paths out of the package, and paths that only some systems read -------------------------------------------------------


def write(folder: Path, files: Mapping[str, str]) -> Path:
    for name, text in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    return folder


def neighbour(folder: Path) -> None:
    """A package ``q`` beside ``p``."""
    write(folder, {"q/package.xml": "<package><name>q</name></package>", "q/meshes/b.stl": "", "loose/c.stl": ""})


@pytest.mark.parametrize(
    ("path", "message", "edit"),
    [
        ("package://p/../q/meshes/b.stl", "package", "package://q/meshes/b.stl"),
        ("../../q/meshes/b.stl", "package", "package://q/meshes/b.stl"),
        ("../../loose/c.stl", "nowhere", None),
        ("package://p/meshes/../../p/meshes/a.stl", None, None),  # comes back
        ("../meshes/a.stl", None, None),
        ("package://p/../q/meshes/gone.stl", None, None),  # PKG002's
    ],
)
def test_paths_that_lead_out_of_the_package(tmp_path: Path, path: str, message: str | None, edit: str | None) -> None:
    model = package(tmp_path, "meshes/a.stl")
    neighbour(tmp_path)
    findings = audit(model, make_mesh_link("a", path), codes={"PKG005"}).findings
    assert [f.message_id for f in findings] == ([message] if message else [])
    for finding in findings:
        assert finding.fix is not None
        assert [e.replacement for e in finding.fix.edits] == ([edit] if edit else [])


@pytest.mark.parametrize(
    ("own", "other", "repair"),
    [
        ("", "", "write `package://q/meshes/b.stl`, and declare q in package.xml"),
        ("<depend>q</depend>", "", "write `package://q/meshes/b.stl`"),
        (
            "",
            "<depend>p</depend>",
            "move what the robot needs into p: q depends on it, so package.xml cannot declare that",
        ),
    ],
)
def test_a_neighbour_is_declared_unless_it_is_or_needs_this_package(
    tmp_path: Path, own: str, other: str, repair: str
) -> None:
    model = package(tmp_path)
    neighbour(tmp_path)
    for name, lines in (("p", own), ("q", other)):
        write(tmp_path / name, {"package.xml": manifest(lines, name=name)})
    finding = only(audit(model, make_mesh_link("a", "package://p/../q/meshes/b.stl"), codes={"PKG005"}))
    assert finding.fix is not None
    assert finding.fix.title == repair
    assert bool(finding.fix.edits) == repair.startswith("write")


def test_paths_that_lead_to_one_place_are_one_finding(tmp_path: Path) -> None:
    model = package(tmp_path, "meshes/a.stl")
    neighbour(tmp_path)
    (tmp_path / "q/meshes/d.stl").write_text("")
    links = [
        make_mesh_link("a", "package://p/../q/meshes/b.stl", "../../q/meshes/d.stl"),
        make_mesh_link("b", "../../q/meshes/b.stl"),
    ]
    finding = only(audit(model, *links, codes={"PKG005"}))
    assert len(finding.related) == 2


def test_include_that_leads_out_of_the_package(tmp_path: Path) -> None:
    model = package(tmp_path)
    neighbour(tmp_path)
    head = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">'
    write(tmp_path, {"q/a.xacro": f"{head}<link name='a'/></robot>"})
    model = model.with_suffix(".urdf.xacro")
    model.write_text(f'{head}<xacro:include filename="$(find p)/../q/a.xacro"/></robot>', encoding="utf-8")
    finding = only(check(model, codes={"PKG005"}))
    assert finding.fix is not None
    assert [e.replacement for e in finding.fix.edits] == ["$(find q)/a.xacro"]


@pytest.mark.parametrize(
    ("path", "found", "edit"),
    [
        ("package://p\\meshes\\a.stl", ("PKG011", "backslash", Severity.ERROR), "package://p/meshes/a.stl"),
        ("package:\\\\p\\meshes\\a.stl", ("PKG011", "backslash", Severity.ERROR), "package://p/meshes/a.stl"),
        ("package:\\p\\meshes\\a.stl", ("PKG011", "slashes", Severity.ERROR), "package://p/meshes/a.stl"),
        ("..\\meshes\\a.stl", ("PKG011", "backslash", Severity.ERROR), "../meshes/a.stl"),
        (" package://p/meshes/a.stl ", ("PKG011", "blank", Severity.ERROR), "package://p/meshes/a.stl"),
        ("package://p/meshes/a.stl OR p/a.stl", ("PKG011", "blank", Severity.ERROR), "package://p/meshes/a.stl"),
        ("package:/p/meshes/a.stl", ("PKG011", "slashes", Severity.ERROR), "package://p/meshes/a.stl"),
        ("package:p/meshes/a.stl", ("PKG011", "slashes", Severity.ERROR), "package://p/meshes/a.stl"),
        ("file:../meshes/a.stl", ("PKG011", "slashes", Severity.ERROR), "../meshes/a.stl"),
        ("package://p/my meshes/a.stl", ("PKG011", "blank", Severity.WARNING), None),
        ("package://p/meshes/arm .stl", ("PKG002", "file", Severity.ERROR), None),  # there is nothing to rename
        ("package://p/meshes/größe.stl", ("PKG011", "letters", Severity.INFO), None),
        ("pakage://p/meshes/a.stl", ("PKG011", "scheme", Severity.WARNING), "package://p/meshes/a.stl"),
        ("zip://p/meshes/a.stl", ("PKG011", "scheme", Severity.WARNING), None),
        ("https://example.org/a.stl", ("PKG011", "remote", Severity.WARNING), None),
        ("C:\\robots\\a.stl", ("PKG004", "unread", Severity.ERROR), None),
        ("package://p/meshes/a-b_c.v2.stl", None, None),
        ("model://p/meshes/a.stl", None, None),
    ],
)
def test_spelling_of_paths(
    tmp_path: Path, path: str, found: tuple[str, str, Severity] | None, edit: str | None
) -> None:
    names = ("meshes/a.stl", "meshes/größe.stl", "my meshes/a.stl", "meshes/a-b_c.v2.stl")
    findings = audit(package(tmp_path, *names), make_mesh_link("a", path), codes={*CODES, "PKG011"}).findings
    assert [(f.code, f.message_id, f.severity) for f in findings] == ([found] if found else [])
    for finding in findings:
        assert finding.fix is not None
        assert [e.replacement for e in finding.fix.edits] == ([edit] if edit else [])


@pytest.mark.parametrize(
    ("paths", "repair"),
    [
        (["package:/p/meshes/a.stl"], "write `package://p/meshes/a.stl`"),
        (["package:/p/meshes/gone.stl"], "write `package://p/meshes/gone.stl`; that file is missing too"),
        (["..\\meshes\\a.stl", "..\\meshes\\b.stl"], "write `../meshes/a.stl`, and the others likewise"),
        (
            ["..\\meshes\\a.stl", "..\\meshes\\gone.stl"],
            "write `../meshes/a.stl`, and the others likewise; not all these files are there",
        ),
    ],
)
def test_a_spelling_that_leads_to_no_file_either_says_so(tmp_path: Path, paths: list[str], repair: str) -> None:
    model = package(tmp_path, "meshes/a.stl", "meshes/b.stl")
    finding = only(audit(model, make_mesh_link("a", *paths), codes={"PKG011"}))
    assert finding.fix is not None
    assert finding.fix.title == repair


@pytest.mark.parametrize(
    ("paths", "there", "edits", "rest"),
    [
        (["package://STLs\\a.stl"], ["meshes/a.stl"], ["package://p/meshes/a.stl"], ", where the file is"),
        (
            ["package://STLs\\a.stl", "package://STLs\\gone.stl"],
            ["meshes/a.stl"],
            ["package://p/meshes/a.stl", "package://p/meshes/gone.stl"],
            ", where the file is, and the others likewise; not all these files are there",
        ),
        (
            ["package://STLs\\gone.stl", "package://STLs\\a.stl"],
            ["meshes/a.stl"],
            ["package://p/meshes/gone.stl", "package://p/meshes/a.stl"],
            ", and the others likewise; not all these files are there",
        ),
        (["..\\stl\\a.stl"], ["meshes/a.stl"], ["../meshes/a.stl"], ", where the file is"),
        # Two files of the name, and one of another part: which is meant is not known.
        (["..\\stl\\a.stl"], ["x/a.stl", "y/a.stl"], ["../stl/a.stl"], "; that file is missing too"),
        (["..\\stl\\a.stl"], ["gripper/a.stl"], ["../stl/a.stl"], "; that file is missing too"),
        (
            ["..\\stl\\a.stl", "..\\stl\\b.stl"],
            [],
            ["../stl/a.stl", "../stl/b.stl"],
            ", and the others likewise; none of these files is there",
        ),
    ],
)
def test_a_plain_path_that_does_not_exist_either_is_not_written_where_the_file_is_elsewhere(
    tmp_path: Path, paths: list[str], there: list[str], edits: list[str], rest: str
) -> None:
    finding = only(audit(package(tmp_path, *there), make_mesh_link("a", *paths), codes={"PKG011"}))
    assert finding.fix is not None
    assert [edit.replacement for edit in finding.fix.edits] == edits
    assert finding.fix.title == f"write `{edits[0]}`{rest}"


@pytest.mark.parametrize(
    ("place", "named", "there", "severity"),
    [
        ("urdf/r.urdf", "r.urdf", "", Severity.ERROR),
        ("urdf/r.urdf", "other.urdf", "", Severity.ERROR),
        ("urdf/old/r.urdf", "", "", Severity.INFO),
        ("urdf/old/r.urdf", "urdf/old/r.urdf", "", Severity.ERROR),
        ("test/r.urdf", "r.urdf", "", Severity.INFO),
        ("test/r.urdf", "r.urdf", "visual/gone.stl", Severity.ERROR),
    ],
)
def test_meshes_of_a_model_that_nothing_loads_are_no_error(
    tmp_path: Path, place: str, named: str, there: str, severity: Severity
) -> None:
    robot = f'<robot name="r">{make_mesh_link("a", "package://p/meshes/gone.stl")}</robot>'
    launch = f'<launch><param name="robot_description" textfile="$(find p)/{named or "a"}"/></launch>'
    files = {"package.xml": manifest(), place: robot, "launch/a.launch": launch, there or "a.stl": ""}
    write(tmp_path / "p", files)
    finding = only(check(tmp_path / "p" / place, codes={"PKG002"}))
    assert finding.severity is severity


@pytest.mark.parametrize("path", ["..\\gone.stl", "package://p\\gone.stl", "package://gone\\a.stl"])
def test_backslashes_come_before_what_they_hide(tmp_path: Path, path: str) -> None:
    finding = only(audit(package(tmp_path), make_mesh_link("a", path), codes={*CODES, "PKG011", "PKG012"}))
    assert (finding.code, finding.severity) == ("PKG011", Severity.ERROR)
    assert "the file is there" not in finding.message
    assert finding.fix is not None
    (edit,) = finding.fix.edits
    finding = only(
        audit(tmp_path / "p/urdf/r.urdf", make_mesh_link("a", edit.replacement), codes={*CODES, "PKG011", "PKG012"})
    )
    assert finding.code == ("PKG001" if "gone/" in edit.replacement else "PKG002")


@pytest.mark.parametrize(
    ("options", "path", "written"),
    [
        ("", "/home/me/ws/src/p/meshes/a.stl", "package://p/meshes/a.stl"),
        ('<compiler balanceinertia="true"/>', "/home/me/ws/src/p/meshes/a.stl", "../meshes/a.stl"),
        ('<compiler balanceinertia="true"/>', "file:///home/me/ws/src/p/meshes/a.stl", "package://p/meshes/a.stl"),
        ('<compiler strippath="true"/>', "/home/me/ws/src/p/meshes/a.stl", "package://p/meshes/a.stl"),
    ],
)
def test_a_file_for_mujoco_gets_paths_from_its_place(tmp_path: Path, options: str, path: str, written: str) -> None:
    model = package(tmp_path, "meshes/a.stl")
    (finding,) = audit(model, f"<mujoco>{options}</mujoco>", make_mesh_link("a", path), codes={"PKG004"}).findings
    assert finding.fix is not None
    assert [edit.replacement for edit in finding.fix.edits] == [written]


def test_files_of_one_folder_with_a_blank_are_one_finding(tmp_path: Path) -> None:
    model = package(tmp_path, "my meshes/a.stl", "my meshes/b c.stl", "d e/f.stl")
    links = [make_mesh_link("a", "../my meshes/a.stl", "../my meshes/b c.stl"), make_mesh_link("b", "../d e/f.stl")]
    assert [len(f.data["files"]) for f in audit(model, *links, codes={"PKG011"}).findings] == [2, 1]


@pytest.mark.parametrize(("name", "count"), [("a.stl", 0), ("b c.stl", 1)])
def test_blanks_of_the_folder_that_the_package_is_in_are_not_the_models(tmp_path: Path, name: str, count: int) -> None:
    model = package(tmp_path / "my copy", f"meshes/{name}")
    text = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">'
    text += make_mesh_link("a", f"file://$(find p)/meshes/{name}") + "</robot>"
    model = model.with_suffix(".urdf.xacro")
    model.write_text(text, encoding="utf-8")
    found = check(model, codes={"PKG011"}).findings
    assert len(found) == count
    assert all(f.message.startswith("the path '") and f.message.endswith("b c.stl' has blanks") for f in found)


# -- packages that are meant, and packages that are not here ---------------------------------------------------------------


def test_the_one_package_that_has_the_files_is_meant(tmp_path: Path) -> None:
    model = package(tmp_path, "meshes/a.stl", "meshes/b.stl")
    finding = only(audit(model, make_mesh_link("a", "package://other/meshes/a.stl", "package://other/meshes/b.stl")))
    assert finding.data["near"] == ["p"]
    assert "did you mean p, which has these files?" in finding.message
    assert finding.fix is not None
    assert [e.replacement for e in finding.fix.edits] == ["package://p/meshes/a.stl", "package://p/meshes/b.stl"]


def test_a_slash_too_many_is_taken_away_where_a_package_stands_behind_it(tmp_path: Path) -> None:
    finding = only(audit(package(tmp_path, "meshes/a.stl"), make_mesh_link("a", "package:///p/meshes/a.stl")))
    assert finding.message_id == "nameless"
    assert finding.fix is not None
    assert [e.replacement for e in finding.fix.edits] == ["package://p/meshes/a.stl"]
    assert not finding.message.count("//p")
    # Given the folder that the path starts from, it loads the mesh.
    assert "unless" in finding.consequences["pinocchio"]


def test_what_needs_meshes_that_are_not_installed_is_listed_as_skipped(tmp_path: Path) -> None:
    model = package(tmp_path, depends="q")
    run = audit(
        model, make_mesh_link("a", "package://q/a.stl", "package://q/b.stl"), codes={"PKG001", "MSH001", "KIN001"}
    )
    assert only(run).severity == Severity.INFO
    assert [s.code for s in run.skipped if "2 meshes in package q" in s.reason] == ["MSH001"]
    (tmp_path / "p/package.xml").write_text("<package><name>p</name></package>", encoding="utf-8")
    run = audit(model, make_mesh_link("a", "package://q/a.stl", "package://q/b.stl"), codes={"PKG001", "MSH001"})
    assert only(run).severity == Severity.ERROR
    assert not run.skipped


# -- dependencies ----------------------------------------------------------------------------------------------------------

URDF = '<robot name="r"><link name="a"/></robot>'


def manifest(*lines: str, name: str = "p", form: str = "3") -> str:
    return "\n".join(
        [f'<package format="{form}">', f"  <name>{name}</name>", *(f"  {x}" for x in lines), "</package>\n"]
    )


def findings(folder: Path, code: str) -> list[Finding]:
    run = check(folder, codes={code})
    assert not run.failures
    return list(run.findings)


@pytest.mark.parametrize(
    ("name", "text", "told"),
    [
        ("launch/a.launch", '<launch><include file="$(find gone)/a.launch"/></launch>', True),
        ("launch/a.launch.xml", '<launch><include file="$(find-pkg-share gone)/a.launch.xml"/></launch>', True),
        ("launch/a.launch.py", "share = get_package_share_directory('gone')", True),
        ("launch/a.launch.py", "FindPackageShare(package='gone')", True),
        ("launch/a.launch.py", "# FindPackageShare('gone')", False),
        ("launch/a.launch.py", "path = 'package://gone/a.stl'", True),
        ("launch/a.launch.py", "print('package://gone/a.stl')", False),
        ("launch/a.launch.py", "print(get_package_share_directory('gone'))", True),
        ("launch/a.launch.py", 'def f():\n    """Find.\n\n    package://gone/a.stl\n    """', False),
        ("launch/a.launch.py", "try:\n    get_package_share_directory('gone')\nexcept Exception:\n    pass", False),
        ("launch/a.launch.py", "try:\n    get_package_share_directory('gone')\nexcept Exception:\n    raise", True),
        ("launch/a.launch.py", "try:\n    pass\nexcept Exception:\n    get_package_share_directory('gone')", True),
        ("launch/a.launch.py", "try:\n    get_package_share_directory('gone')\nfinally:\n    pass", True),
        ("launch/a.launch.py", "get_package_share_directory('gone')\nthis is no Python, except", True),
        ("launch/a.launch", '<launch><!-- <include file="$(find gone)/a.launch"/> --></launch>', False),
        ("launch/a.launch", '<launch><include file="$(find p)/a.launch"/></launch>', False),
        ("launch/a.launch", '<launch><include file="$(find $(arg robot))/a.launch"/></launch>', False),
        ("urdf/b.urdf", '<robot name="b"><mesh filename="package://gone/a.stl"/></robot>', False),  # PKG001's
        ("notes.md", "package://gone/a.stl", False),
        ("inner/launch/a.launch", '<launch><include file="$(find gone)/a.launch"/></launch>', False),
    ],
)
def test_where_a_dependency_is_named(tmp_path: Path, name: str, text: str, told: bool) -> None:
    inner = {"inner/package.xml": manifest("<depend>gone</depend>", name="inner")} if name.startswith("inner") else {}
    write(tmp_path, {"package.xml": manifest(), "urdf/r.urdf": URDF, name: text, **inner})
    assert [f.data["names"] for f in findings(tmp_path, "PKG007")] == ([["gone"]] if told else [])


@pytest.mark.parametrize(
    ("name", "text", "told"),
    [
        ("a.launch.py", "import xacro\n", True),
        ("a.launch.py", "import xacro as x\n", True),
        ("a.launch.py", "    from xacro import process_file\n", True),
        ("a.launch.py", "Command([FindExecutable(name='xacro'), ' ', path])", True),
        ("a.launch.py", "Command(['xacro ', path])", True),
        ("a.launch.py", "Command('xacro robot.xacro')", True),
        ("a.launch.xml", """<param name="d" value="$(command 'xacro robot.xacro')"/>""", True),
        ("a.launch", """<param name="d" command="xacro robot.xacro"/>""", True),
        ("a.launch.py", "# import xacro\n", False),
        ("a.launch.py", "try:\n    import xacro\nexcept ImportError:\n    xacro = None\n", False),
        ("a.launch.py", "path = 'urdf/robot.xacro'\nimport xacro_tools\n", False),
    ],
)
def test_xacro_is_used_where_it_is_run(tmp_path: Path, name: str, text: str, told: bool) -> None:
    write(tmp_path, {"package.xml": manifest(), "urdf/r.urdf": URDF, f"launch/{name}": text})
    assert [f.data["names"] for f in findings(tmp_path, "PKG007")] == ([["xacro"]] if told else [])


@pytest.mark.parametrize(("build", "launcher"), [("ament_cmake", "ros2_launch"), ("catkin", "roslaunch")])
@pytest.mark.parametrize("uses", ["gone", "mine"])
def test_the_program_that_stops_is_that_of_the_package_s_ros(
    tmp_path: Path, build: str, launcher: str, uses: str
) -> None:
    own = manifest(f"<export><build_type>{build}</build_type></export>")
    find = "find-pkg-share" if build == "ament_cmake" else "find"
    launch = f'<launch><include file="$({find} {uses})/a.launch"/></launch>'
    write(tmp_path, {"p/package.xml": own, "p/urdf/r.urdf": URDF, "p/launch/a.launch": launch})
    (finding,) = findings(tmp_path, "PKG007")
    assert set(finding.consequences) == {launcher}


@pytest.mark.parametrize(
    ("build", "text", "names"),
    [
        ("ament_cmake", '<node pkg="tf2_tools" type="tf2_tools" name="n"/><include file="$(find tf2)/a.launch"/>', []),
        (
            "ament_cmake",
            '<node pkg="tf2_tools" exec="tf2_tools"/><include file="$(find-pkg-share tf2)/a.launch"/>',
            ["tf2", "tf2_tools"],
        ),
        (
            "catkin",
            '<node pkg="tf2_tools" type="tf2_tools" name="n"/><include file="$(find tf2)/a.launch"/>',
            ["tf2", "tf2_tools"],
        ),
    ],
)
def test_a_launch_file_of_ros_1_needs_nothing_in_a_package_of_ros_2(
    tmp_path: Path, build: str, text: str, names: list[str]
) -> None:
    own = manifest(f"<export><build_type>{build}</build_type></export>")
    write(tmp_path, {"package.xml": own, "urdf/r.urdf": URDF, "launch/a.launch": f"<launch>{text}</launch>"})
    assert [name for finding in findings(tmp_path, "PKG007") for name in finding.data["names"]] == names


def test_a_package_that_is_not_found_may_be_in_a_submodule(tmp_path: Path) -> None:
    launch = '<launch><include file="$(find arm5)/a.launch"/></launch>'
    write(tmp_path, {"package.xml": manifest(), "urdf/r.urdf": URDF, "launch/a.launch": launch, ".git/HEAD": ""})
    write(tmp_path, {".gitmodules": '[submodule "arm"]\n\tpath = arm\n[submodule "b"]\n\tpath = cmake\n'})
    (finding,) = findings(tmp_path, "PKG007")
    assert "neither what is checked out of the repository nor a ROS distribution" in finding.message
    assert finding.fix is not None
    assert finding.fix.title == (
        "declare it if it is in a submodule that is not checked out (arm) or elsewhere: `<exec_depend>arm5</exec_depend>`; "
        "correct an old name"
    )


@pytest.mark.parametrize(
    ("lines", "uses", "told"),
    [
        (("<exec_depend>rviz</exec_depend>",), "rviz", False),
        (("<test_depend>rviz</test_depend>",), "rviz", False),
        (("<exec_depend>ros_gz</exec_depend>",), "ros_gz_sim", False),
        (("<exec_depend>gazebo_ros_pkgs</exec_depend>",), "gazebo_ros", False),
        (("<exec_depend>gazebo</exec_depend>",), "gazebo_ros", True),
        (("<exec_depend>q</exec_depend>",), "rviz", False),  # q depends on it
        (("<exec_depend>ros_gz_sim</exec_depend>",), "ros_gz", True),
    ],
)
def test_what_counts_as_declared(tmp_path: Path, lines: tuple[str, ...], uses: str, told: bool) -> None:
    launch = f'<launch><include file="$(find {uses})/a.launch"/></launch>'
    q = manifest("<depend>further</depend>", name="q")
    further = manifest("<depend>rviz</depend>", name="further")
    files = {"q/package.xml": q, "further/package.xml": further, "p/package.xml": manifest(*lines)}
    write(tmp_path, {**files, "p/urdf/r.urdf": URDF, "p/launch/a.launch": launch})
    assert bool(findings(tmp_path, "PKG007")) == told


@pytest.mark.parametrize(
    ("before", "after"),
    [
        (
            '<package format="3">\n\t<name>p</name>\n\t<exec_depend>a</exec_depend>\n\n\t<export/>\n</package>\n',
            "\t<exec_depend>a</exec_depend>\n\t<exec_depend>rviz</exec_depend>\n\n",
        ),
        (
            '<package format="2">\n  <name>p</name>\n  <depend>a</depend>\n  <test_depend>b</test_depend>\n</package>\n',
            "  <depend>a</depend>\n  <exec_depend>rviz</exec_depend>\n",
        ),
        (
            "<package>\r\n  <name>p</name>\r\n  <run_depend>a</run_depend>\r\n</package>\r\n",
            "  <run_depend>a</run_depend>\r\n  <run_depend>rviz</run_depend>\r\n",
        ),
        ('<package format="3"><name>p</name></package>', "<name>p</name>\n<exec_depend>rviz</exec_depend></package>"),
    ],
)
def test_missing_line_is_written_as_its_neighbours_are(tmp_path: Path, before: str, after: str) -> None:
    launch = '<launch><include file="$(find rviz)/a.launch"/></launch>'
    write(tmp_path, {"urdf/r.urdf": URDF, "launch/a.launch": launch})
    (tmp_path / "package.xml").write_bytes(before.encode())
    (finding,) = findings(tmp_path, "PKG007")
    assert finding.fix is not None
    (edit,) = finding.fix.edits
    text = before[: edit.span.start] + edit.replacement + before[edit.span.end :]
    assert after in text
    assert finding.headline == "p: undeclared dependency rviz"
    (tmp_path / "package.xml").write_bytes(text.encode())
    assert not findings(tmp_path, "PKG007")


@pytest.mark.parametrize(
    ("subpath", "files", "message"),
    [
        ("robots/r.urdf", ["p/urdf/r.urdf"], "misnamed"),
        ('robots/r.urdf"/><node args="-d $(find arm5)/urdf.rviz', ["p/urdf/r.urdf"], "misnamed"),
        ('robots/r.urdf"/><include file="$(find arm5)/launch/arm.launch', ["p/urdf/r.urdf"], "unknown"),
        ("robots/other.urdf", ["p/urdf/r.urdf"], "unknown"),
        ("robots/r.urdf", ["p/urdf/r.urdf", "q/urdf/r.urdf"], "unknown"),  # whose file is meant is open
        ("launch/world.launch", ["p/urdf/r.urdf", "p/launch/world.launch"], "unknown"),  # all have such files
        ("", ["p/urdf/r.urdf"], "unknown"),
    ],
)
def test_package_that_is_named_for_a_file_of_the_repository_is_no_dependency(
    tmp_path: Path, subpath: str, files: list[str], message: str
) -> None:
    launch = f'<launch><param name="robot_description" textfile="$(find arm5)/{subpath}"/></launch>'
    here = {name: URDF if name.endswith(".urdf") else "<launch/>" for name in files}
    other = {"q/package.xml": manifest(name="q")} if any(name.startswith("q/") for name in files) else {}
    write(tmp_path, {"p/package.xml": manifest(), "p/launch/a.launch": launch, ".git/HEAD": "", **here, **other})
    (finding,) = [f for f in findings(tmp_path, "PKG007") if f.data["package"] == "p"]
    assert finding.message_id == message
    assert finding.fix is not None
    assert not finding.fix.edits
    assert ("write `p` and the path `urdf/r.urdf`" in finding.fix.title) == (message == "misnamed")


@pytest.mark.parametrize(
    ("build", "find", "repair"),
    [
        ("ament_cmake", "find", "delete the launch files that were left from ROS 1"),
        ("ament_cmake", "find-pkg-share", "write `p` and the path `urdf/r.urdf`"),
        ("catkin", "find", "write `p` and the path `urdf/r.urdf`"),
    ],
)
def test_a_launch_file_that_was_left_from_ros_1_is_not_mended_by_another_name(
    tmp_path: Path, build: str, find: str, repair: str
) -> None:
    export = f"<export><build_type>{build}</build_type></export>"
    launch = f'<launch><param name="robot_description" textfile="$({find} arm5)/urdf/r.urdf"/></launch>'
    write(tmp_path, {"package.xml": manifest(export), "launch/a.launch": launch, "urdf/r.urdf": URDF})
    (finding,) = findings(tmp_path, "PKG007")
    assert finding.fix is not None
    assert finding.fix.title.startswith(repair)


@pytest.mark.parametrize("build", ["ament_cmake", "catkin"])
def test_a_program_of_ros_1_is_not_declared_in_a_package_of_ros_2(tmp_path: Path, build: str) -> None:
    """What the launch file needs there is rviz2, whose line is another one (LCH003)."""
    export = f"<export><build_type>{build}</build_type></export>"
    model = "$(find-pkg-share xacro)/r.urdf.xacro" if build == "ament_cmake" else "$(find xacro)/r.urdf.xacro"
    verb = "exec" if build == "ament_cmake" else "type"
    launch = f'<launch><node name="v" pkg="rviz" {verb}="rviz" args="-d {model}"/></launch>'
    write(tmp_path, {"package.xml": manifest(export), "launch/a.launch": launch, "urdf/r.urdf": URDF})
    (finding,) = findings(tmp_path, "PKG007")
    assert ("rviz" in finding.message) == (build == "catkin")


@pytest.mark.parametrize(
    ("files", "text", "expected"),
    [
        # The name of another package before a path of this one.
        (["config/scan.yaml"], '<rosparam file="$(find arm5)/config/scan.yaml"/>', "misnamed"),
        (["config/other.yaml"], '<rosparam file="$(find arm5)/config/scan.yaml"/>', "unknown"),
        # A path below the package that lacks its name: `meshes` is a folder.
        (["meshes/a.stl"], '<param name="m" value="package://meshes/a.stl"/>', "misnamed"),
        # A line from another robot: the package that it names lacks the file.
        ([], '<param name="d" textfile="$(find q)/urdf/lost.urdf"/>', "dangling"),
        ([], '<param name="d" textfile="$(find q)/urdf\\lost.urdf"/>', "dangling"),
        ([], '<param name="d" textfile="$(find q)/urdf/r.urdf"/>', "undeclared"),
        ([], '<param name="d" textfile="$(find q)/urdf/$(arg model).urdf"/>', "undeclared"),
    ],
)
def test_line_is_only_proposed_for_a_package_that_has_what_is_used(
    tmp_path: Path, files: list[str], text: str, expected: str
) -> None:
    write(
        tmp_path, {"p/package.xml": manifest(), "p/launch/a.launch": f"<launch>{text}</launch>", "p/urdf/r.urdf": URDF}
    )
    write(tmp_path, {"q/package.xml": manifest(name="q"), "q/urdf/r.urdf": URDF})
    write(tmp_path, {f"p/{name}": "" for name in files})
    found = [f for f in findings(tmp_path, "PKG007") if f.data["package"] == "p"]
    assert [f.message_id for f in found] == [expected]
    assert all(bool(f.fix and f.fix.edits) == (f.message_id == "undeclared") for f in found)


@pytest.mark.parametrize(
    ("own", "used", "expected", "repair"),
    [
        ("arm_sim", "arm5", "misnamed", "write `arm_sim` and the path `urdf.rviz` if arm5 is an old name"),
        (
            "urdf_tutorial_sim",
            "urdf_tutorial",
            "copied",
            "write `urdf_tutorial_sim` for urdf_tutorial if that file is meant",
        ),
        ("arm_sim", "urdf_tutorial", "undeclared", "declare it"),  # it has such a view, too
    ],
)
def test_a_view_at_the_same_place_in_the_package_is_meant_by_its_old_name(
    tmp_path: Path, own: str, used: str, expected: str, repair: str
) -> None:
    launch = f'<launch><node name="v" pkg="rviz" type="rviz" args="-d $(find {used})/urdf.rviz"/></launch>'
    write(tmp_path, {"package.xml": manifest(name=own), "launch/a.launch": launch, "urdf.rviz": ""})
    finding = next(f for f in findings(tmp_path, "PKG007") if used in f.message)
    assert finding.message_id in {expected, "several"}
    assert finding.fix is not None
    assert bool(finding.fix.edits) == (expected == "undeclared")
    assert expected == "undeclared" or finding.fix.title.startswith(repair)


@pytest.mark.parametrize(
    ("uses", "name"),
    [
        (['"config", "a.yaml"'], "misnamed"),
        (['"config", "a.yaml"', '"launch", "b.launch.py"'], "misnamed"),
        (['"config", "lost.yaml"'], "unknown"),
        (['"launch", "b.launch.py"'], "unknown"),  # many packages have a launch file of that name
    ],
)
def test_the_texts_that_python_joins_are_one_path(tmp_path: Path, uses: list[str], name: str) -> None:
    joined = ", ".join(f'PathJoinSubstitution([FindPackageShare("old"), {use}])' for use in uses)
    write(tmp_path, {"package.xml": manifest(), "launch/a.launch.py": f"x = [{joined}]\n", "urdf/r.urdf": URDF})
    write(tmp_path, {"config/a.yaml": "", "launch/b.launch.py": "", ".git/HEAD": ""})
    assert [f.message_id for f in findings(tmp_path, "PKG007")] == [name]


def test_a_package_for_the_other_ros_is_not_the_one_that_lacks_a_file(tmp_path: Path) -> None:
    launch = '<launch><param name="d" textfile="$(find q)/urdf/lost.urdf"/></launch>'
    write(tmp_path, {"p/package.xml": manifest(), "p/launch/a.launch": launch, "p/urdf/r.urdf": URDF})
    for build, expected in (("ament_cmake", "undeclared"), ("catkin", "dangling")):
        export = f"<export><build_type>{build}</build_type></export>"
        write(tmp_path, {"q/package.xml": manifest(export, name="q"), "q/urdf/r.urdf": URDF})
        found = [f for f in findings(tmp_path, "PKG007") if f.data["package"] == "p"]
        assert [f.message_id for f in found] == [expected]


@pytest.mark.parametrize(("uses", "told"), [(False, True), (True, False)])
def test_a_circle_ends_where_the_other_package_depends_on_this_one_without_use(
    tmp_path: Path, uses: bool, told: bool
) -> None:
    model = '<robot xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:include filename="$(find {})/a.xacro"/></robot>'
    write(tmp_path / "p", {"package.xml": manifest(), "urdf/r.urdf.xacro": model.format("q"), ".git/HEAD": ""})
    write(tmp_path / "q", {"package.xml": manifest("<depend>p</depend>", name="q"), "meshes/a.stl": ""})
    if uses:
        write(tmp_path / "q", {"urdf/b.urdf.xacro": model.format("p")})
    (finding,) = [f for f in findings(tmp_path, "PKG007") if f.message_id == "circle"]
    assert finding.fix is not None
    assert finding.fix.title.startswith("delete the dependency on p from the package.xml of q") == told


@pytest.mark.parametrize("kind", ["depend", "exec_depend", "test_depend"])
@pytest.mark.parametrize("between", [False, True])
def test_no_line_is_proposed_that_makes_a_circle(tmp_path: Path, kind: str, between: bool) -> None:
    launch = '<launch><include file="$(find q)/a.launch"/><include file="$(find amcl)/a.launch"/></launch>'
    write(tmp_path / "p", {"package.xml": manifest(), "urdf/r.urdf": URDF, "launch/a.launch": launch})
    write(tmp_path / "q", {"package.xml": manifest(f"<{kind}>{'m' if between else 'p'}</{kind}>", name="q")})
    write(tmp_path / "m", {"package.xml": manifest("<depend>p</depend>", name="m")})
    write(tmp_path, {".git/HEAD": ""})
    circle, other = sorted(findings(tmp_path, "PKG007"), key=lambda finding: finding.data["names"], reverse=True)
    assert ("a cycle" in circle.message, circle.data["names"]) == (True, ["q"])
    assert circle.fix is None or not circle.fix.edits
    assert other.fix is not None
    assert [edit.replacement.strip() for edit in other.fix.edits] == ["<exec_depend>amcl</exec_depend>"]


@pytest.mark.parametrize(("mark", "told"), [("COLCON_IGNORE", False), ("src/COLCON_IGNORE", False), ("README", True)])
def test_a_package_that_is_left_out_of_the_build_is_not_declared(tmp_path: Path, mark: str, told: bool) -> None:
    launch = '<launch><include file="$(find q)/launch/q.launch"/></launch>'
    write(tmp_path / "p", {"package.xml": manifest(), "launch/p.launch": launch, "urdf/r.urdf": URDF})
    files = {"package.xml": manifest(name="q"), "launch/q.launch": "<launch/>"}
    write(tmp_path / "extra/src/q", files)
    write(tmp_path, {".git/HEAD": "", f"extra/{mark}": ""})
    assert [f.data["names"] for f in findings(tmp_path, "PKG007") if f.data["package"] == "p"] == [["q"]] * told


@pytest.mark.parametrize(("last", "messages"), [("p", ["ring"] * 3), ("amcl", ["undeclared"] * 3)])
def test_lines_that_make_a_circle_together_are_not_proposed(tmp_path: Path, last: str, messages: list[str]) -> None:
    include = '<launch><include file="$(find {0})/launch/{0}.launch"/></launch>'
    for name, used in (("p", "q"), ("q", "m"), ("m", last)):
        files = {"package.xml": manifest(name=name), f"launch/{name}.launch": include.format(used)}
        write(tmp_path / name, {**files, "urdf/r.urdf": URDF})
    write(tmp_path, {".git/HEAD": ""})
    found = findings(tmp_path, "PKG007")
    assert [f.message_id for f in found] == messages
    told = {f.message for f in found}
    chain = "and q uses p through m: declaring all these dependencies would make a cycle"
    assert any(message.endswith(chain) for message in told) == (last == "p")


@pytest.mark.parametrize("way", ["pkg", "include"])
def test_a_started_program_is_not_listed_where_its_package_uses_this_one_through_another(
    tmp_path: Path, way: str
) -> None:
    include = '<launch><include file="$(find {0})/launch/{0}.launch"/></launch>'
    start = '<launch><include file="$(find amcl)/a.launch"/><node name="n" pkg="q" type="t"/></launch>'
    for name, text in (("p", start), ("q", include.format("m")), ("m", include.format("p" if way == "pkg" else "tf"))):
        write(tmp_path / name, {"package.xml": manifest(name=name), f"launch/{name}.launch": text, "urdf/r.urdf": URDF})
    write(tmp_path, {".git/HEAD": ""})
    (names,) = [f.data["names"] for f in findings(tmp_path, "PKG007") if f.data["package"] == "p"]
    assert names == (["amcl"] if way == "pkg" else ["amcl", "q"])


@pytest.mark.parametrize(
    ("first", "names"),
    [
        ("$(find xacro)/xacro", ["xacro", "robot_state_publisher", "rviz"]),
        ("cat", []),
    ],
)
def test_programs_that_launch_files_start_are_listed_with_what_is_missing(
    tmp_path: Path, first: str, names: list[str]
) -> None:
    nodes = "".join(f'<node name="{n}" pkg="{n}" type="t"/>' for n in ("robot_state_publisher", "rviz", "p", "my_own"))
    launch = (
        f'<launch><param name="robot_description" command="{first} a.urdf"/><!-- <node pkg="tf"/> -->{nodes}</launch>'
    )
    write(tmp_path, {"package.xml": manifest(), "launch/a.launch": launch, "urdf/a.urdf": '<robot name="r"/>'})
    found = findings(tmp_path, "PKG007")
    assert [f.data["names"] for f in found] == ([names] if names else [])


def test_what_only_tests_name_is_a_dependency_of_tests(tmp_path: Path) -> None:
    for name, packages in (("test/a.launch", ("amcl", "tf2")), ("launch/a.launch", ("tf2",))):
        lines = "".join(f'<include file="$(find {other})/a.launch"/>' for other in packages)
        write(tmp_path, {name: f"<launch>{lines}</launch>"})
    text = '<package format="3">\n  <name>p</name>\n  <depend>a</depend>\n  <test_depend>b</test_depend>\n</package>\n'
    write(tmp_path, {"package.xml": text, "urdf/r.urdf": URDF})
    (finding,) = findings(tmp_path, "PKG007")
    assert finding.headline == "p: undeclared dependencies amcl, tf2"
    assert finding.fix is not None
    for edit in reversed(finding.fix.edits):
        text = text[: edit.span.start] + edit.replacement + text[edit.span.end :]
    assert "  <depend>a</depend>\n  <exec_depend>tf2</exec_depend>\n" in text
    assert "  <test_depend>b</test_depend>\n  <test_depend>amcl</test_depend>\n" in text


@pytest.mark.parametrize(
    ("name", "other", "message"),
    [
        ("rviz", "", "undeclared"),  # ROS has released it
        ("arm5", "<depend>arm5</depend>", "undeclared"),  # a package here depends on it
        ("arm5", "", "unknown"),
    ],
)
def test_a_line_is_proposed_for_a_package_that_exists(tmp_path: Path, name: str, other: str, message: str) -> None:
    launch = f'<launch><include file="$(find {name})/a.launch"/></launch>'
    write(tmp_path / "p", {"package.xml": manifest(), "urdf/r.urdf": URDF, "launch/a.launch": launch})
    write(tmp_path, {".git/HEAD": "", "q/package.xml": manifest(other, name="q")})
    (finding,) = findings(tmp_path, "PKG007")
    assert (finding.message_id, finding.severity) == (message, Severity.WARNING)
    assert finding.fix is not None
    assert bool(finding.fix.edits) == (message == "undeclared")


@pytest.mark.parametrize(
    ("name", "build", "message"),
    [
        ("robot_pose_ekf", "<buildtool_depend>catkin</buildtool_depend>", "undeclared"),
        ("robot_pose_ekf", "<export><build_type>ament_cmake</build_type></export>", "unknown"),
        ("robotiq_description", "<export><build_type>ament_cmake</build_type></export>", "undeclared"),
        ("robotiq_description", "<buildtool_depend>catkin</buildtool_depend>", "unknown"),
        ("robotiq_description", "", "undeclared"),
    ],
)
def test_no_line_is_proposed_for_a_package_of_the_other_ros(
    tmp_path: Path, name: str, build: str, message: str
) -> None:
    launch = f"get_package_share_directory('{name}')"
    write(tmp_path, {"package.xml": manifest(build), "urdf/r.urdf": URDF, "launch/a.launch.py": launch})
    (finding,) = findings(tmp_path, "PKG007")
    assert finding.message_id == message
    assert (f"has {name})" in finding.message) == (message == "unknown")


@pytest.mark.parametrize(
    ("typed", "is_slip"),
    [
        ("girpper_sim", True),
        ("girpper_ism", False),
        ("griper_sim", True),
        ("gripper2_sim", False),
        ("gripper_gui", False),
        ("amcl", False),
    ],
)
def test_a_dependency_with_a_slip_in_its_name_is_corrected(tmp_path: Path, typed: str, is_slip: bool) -> None:
    launch = '<launch><include file="$(find gripper_sim)/a.launch"/></launch>'
    own = manifest(f"<depend>{typed}</depend>")
    write(tmp_path / "p", {"package.xml": own, "urdf/r.urdf": URDF, "launch/a.launch": launch})
    write(tmp_path, {".git/HEAD": "", "q/package.xml": manifest(name="gripper_sim"), "q/a.launch": "<launch/>"})
    (finding,) = findings(tmp_path, "PKG007")
    assert finding.message_id == ("misspelt" if is_slip else "undeclared")
    assert finding.fix is not None
    assert [edit.expected for edit in finding.fix.edits] == ([typed] if is_slip else [""])


REPOSITORIES = "repositories:\n  x/arm5:\n    type: git\n    url: https://h/u/a.git\n"


@pytest.mark.parametrize(
    ("files", "repair"),
    [
        ({}, "correct the name if it is an old one; "),
        ({"all.repos": REPOSITORIES}, "import its repository, which all.repos lists: `vcs import < "),
        ({"all_repos.yaml": REPOSITORIES}, "import its repository, which all_repos.yaml lists: `vcs import < "),
        (
            {"all.rosinstall": "- git: {local-name: x, uri: 'https://h/u/arm5'}\n"},
            "import its repository, which all.rosinstall lists: ",
        ),
        ({"README.md": "git clone https://h/u/arm5.git"}, "clone its repository, as README.md says: "),
        (
            {"q/package.xml": manifest(name="q"), "q/README.md": "git clone https://h/u/arm5"},
            "clone its repository, as",
        ),
        ({"src/arm5/": ""}, "src/arm5 is empty, as git leaves"),
        ({"arm5/package.xml": "<package><name>arm_5</name></package>"}, "write `arm_5` for arm5: package.xml of arm5 "),
    ],
)
def test_the_repair_says_where_a_package_is_that_is_not_found(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, files: dict[str, str], repair: str
) -> None:
    launch = '<launch><include file="$(find arm5)/a.launch"/></launch>'
    write(tmp_path, {".git/HEAD": "", "p/package.xml": manifest(), "p/urdf/r.urdf": URDF, "p/launch/a.launch": launch})
    write(tmp_path, {name: text for name, text in files.items() if not name.endswith("/")})
    for name in files:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        if name.endswith("/"):
            (tmp_path / name).mkdir()
    monkeypatch.chdir(tmp_path)
    (finding,) = findings(Path(), "PKG007")
    assert (finding.message_id, finding.severity) == ("unknown", Severity.WARNING)
    assert finding.fix is not None
    assert finding.fix.title.startswith(repair)
    assert not finding.fix.edits


@pytest.mark.parametrize(
    ("comment", "told"),
    [
        ("the launch files start joy", True),
        ("joy is not declared, because it is built from source", False),
        ("joy_node is not declared, because it is built from source", True),
        ("<exec_depend>joy</exec_depend>", False),
    ],
)
def test_a_comment_of_the_manifest_says_that_a_package_is_left_out(tmp_path: Path, comment: str, told: bool) -> None:
    nodes = '<include file="$(find joy)/a.launch"/><node pkg="joy" type="joy_node" name="n"/>'
    launch = f'<launch>{nodes}<include file="$(find rviz)/a.launch"/></launch>'
    write(tmp_path, {"package.xml": manifest(f"<!-- {comment} -->"), "urdf/r.urdf": URDF, "launch/a.launch": launch})
    assert [f.data["names"] for f in findings(tmp_path, "PKG007")] == [["joy", "rviz"] if told else ["rviz"]]


@pytest.mark.parametrize(("line", "told"), [("ros_gz", False), ("ros_gz_interfaces", True)])
def test_a_collection_in_a_comment_of_the_manifest_is_left_out_with_its_parts(
    tmp_path: Path, line: str, told: bool
) -> None:
    dependencies = f"<!-- <exec_depend>{line}</exec_depend> -->{AMENT}"
    launch = "p = join(get_package_share_directory('ros_gz_sim'), 'launch', 'gz_sim.launch.py')"
    write(tmp_path, {"package.xml": manifest(dependencies), "urdf/r.urdf": URDF, "launch/a.launch.py": launch})
    assert [f.data["names"] for f in findings(tmp_path, "PKG007")] == ([["ros_gz_sim"]] if told else [])


@pytest.mark.parametrize(
    ("name", "place", "file", "severity"),
    [
        ("p", "src/p", "launch/a.launch", Severity.WARNING),
        ("p", "src/third_party/p", "launch/a.launch", Severity.INFO),
        ("p", "src/p", "test/a.launch", Severity.WARNING),
        ("gazebo_plugins", "src/p", "test/a.launch", Severity.INFO),
    ],
)
def test_what_a_package_of_others_does_not_declare_is_a_note(
    tmp_path: Path, name: str, place: str, file: str, severity: Severity
) -> None:
    launch = '<launch><include file="$(find joy)/a.launch"/></launch>'
    own = {"package.xml": manifest(name=name), "urdf/r.urdf": URDF, file: launch}
    write(tmp_path, {".git/HEAD": "", **{f"{place}/{path}": text for path, text in own.items()}})
    (finding,) = findings(tmp_path, "PKG007")
    assert (finding.data["names"], finding.severity) == (["joy"], severity)


def test_a_file_that_is_installed_beside_its_folder_is_used(tmp_path: Path) -> None:
    export = "<export><build_type>ament_python</build_type></export>"
    setup = "from glob import glob\nsetup(data_files=[('share/p', ['package.xml']), ('share/p', glob('launch/*.py'))])"
    code = "Node(package='arm5', executable='a')\nFindPackageShare('arm5')\n"
    write(
        tmp_path, {"package.xml": manifest(export), "setup.py": setup, "urdf/r.urdf": URDF, "launch/a.launch.py": code}
    )
    assert [f.data["names"] for f in findings(tmp_path, "PKG007")] == [["arm5"]]


@pytest.mark.parametrize("name", ["r.urdf (copy).xacro", "r (copy).urdf", "s_old.urdf", "s.urdf"])
def test_uses_in_copies_and_in_what_no_program_reads_do_not_count(tmp_path: Path, name: str) -> None:
    text = URDF.replace("</robot>", '<mesh filename="package://other/a.stl"/>' + "</robot>" * (name != "s.urdf"))
    own = {"package.xml": manifest(), "urdf/r.urdf": URDF, "urdf/r.urdf.xacro": URDF, f"urdf/{name}": text}
    files = {".git/HEAD": "", "other/package.xml": manifest(name="other"), "other/a.stl": ""}
    write(tmp_path, {**files, **{f"p/{place}": text for place, text in own.items()}})
    assert "PKG007" not in {f.code for f in findings(tmp_path, "PKG007")}
    write(tmp_path, {"p/launch/b.launch.py": f"'urdf/{name}'"})
    assert ("PKG007" in {f.code for f in findings(tmp_path, "PKG007")}) == (name != "s.urdf")


def test_a_package_whose_program_is_started_is_no_old_name(tmp_path: Path) -> None:
    text = '<node pkg="lidar" type="driver" name="n"/><rosparam file="$(find lidar)/config/scan.yaml"/>'
    launch = f"<launch>{text}</launch>"
    write(tmp_path, {"package.xml": manifest(), "urdf/r.urdf": URDF, "launch/a.launch": launch, "config/scan.yaml": ""})
    assert [f.message_id for f in findings(tmp_path, "PKG007")] == ["unknown"]


@pytest.mark.parametrize(("depends", "message"), [("q", "files-declared"), ("r", "files")])
def test_a_package_is_declared_through_another(tmp_path: Path, depends: str, message: str) -> None:
    mesh = '<visual><geometry><mesh filename="package://arm5/a.stl"/></geometry></visual>'
    urdf = f'<robot name="r"><link name="a">{mesh}</link></robot>'
    write(tmp_path / "p", {"package.xml": manifest(f"<depend>{depends}</depend>"), "urdf/r.urdf": urdf})
    write(tmp_path, {".git/HEAD": "", "q/package.xml": manifest("<depend>arm5</depend>", name="q")})
    (finding,) = check(tmp_path / "p/urdf/r.urdf", codes={"PKG001"}).findings
    assert finding.message_id == message
    assert ("package.xml of q depends on it" in finding.message) == (message == "files-declared")


def test_a_package_inside_another_is_not_built(tmp_path: Path) -> None:
    launch = '<launch><include file="$(find inner)/launch/a.launch"/><include file="$(find rviz)/a.launch"/></launch>'
    write(tmp_path / "p", {"package.xml": manifest(), "urdf/r.urdf": URDF, "launch/a.launch": launch})
    write(tmp_path / "p" / "inner", {"package.xml": manifest(name="inner"), "launch/a.launch": launch, "r.urdf": URDF})
    write(tmp_path, {".git/HEAD": ""})
    assert [f.data["names"] for f in findings(tmp_path, "PKG007")] == [["rviz"]]


def test_a_package_inside_one_beside_it_is_not_built_either(tmp_path: Path) -> None:
    launch = '<launch><include file="$(find inner)/launch/a.launch"/><include file="$(find rviz)/a.launch"/></launch>'
    write(tmp_path / "p", {"package.xml": manifest(), "urdf/r.urdf": URDF, "launch/a.launch": launch})
    write(tmp_path / "q", {"package.xml": manifest(name="q")})
    write(
        tmp_path / "q" / "inner",
        {"package.xml": manifest(name="inner"), "launch/a.launch": "<launch/>", "r.urdf": URDF},
    )
    write(tmp_path, {".git/HEAD": ""})
    assert [f.data["names"] for f in findings(tmp_path, "PKG007")] == [["rviz"]]


@pytest.mark.parametrize(("name", "place"), [("gazebo_plugins", "launch/a.launch"), ("p", "test/a.launch")])
def test_an_unknown_package_of_tests_or_of_a_released_package_is_a_note(tmp_path: Path, name: str, place: str) -> None:
    launch = '<launch><include file="$(find arm5)/a.launch"/></launch>'
    write(tmp_path, {"package.xml": manifest(name=name), "urdf/r.urdf": URDF, place: launch})
    (finding,) = findings(tmp_path, "PKG007")
    assert (finding.message_id, finding.severity) == ("unknown", Severity.INFO)


@pytest.mark.parametrize(
    ("ament", "place", "told"),
    [
        (False, "launch/a.launch", True),
        (False, "a.launch", True),
        (False, "urdf/a.launch", True),
        (False, "mesh/arm5/a.launch", False),
        (True, "launch/a.launch", True),
        (True, "old/a.launch", False),  # CMakeLists.txt does not install the folder
    ],
)
@pytest.mark.parametrize("name", ["arm5", "rviz"])
def test_a_file_to_which_nothing_leads_needs_no_package(
    tmp_path: Path, ament: bool, place: str, told: bool, name: str
) -> None:
    launch = f'<launch><include file="$({"find-pkg-share" if ament else "find"} {name})/a.launch"/></launch>'
    text = manifest("<export><build_type>ament_cmake</build_type></export>" if ament else "")
    install = "install(DIRECTORY launch urdf DESTINATION share/p)" if ament else ""
    write(tmp_path, {"package.xml": text, "urdf/r.urdf": URDF, place: launch, "CMakeLists.txt": install})
    assert bool(findings(tmp_path, "PKG007")) == told


@pytest.mark.parametrize(
    ("name", "launch", "severity"),
    [
        ("a.launch.xml", '<launch><arg name="c" default="$(find-pkg-share q)/c.yaml"/></launch>', Severity.INFO),
        ("a.launch.xml", '<launch><include file="$(find-pkg-share q)/b.launch.xml"/></launch>', Severity.INFO),
        ("a.xacro", '<robot><include file="$(find q)/b.xacro"/></robot>', Severity.WARNING),
        (
            "a.launch.py",
            'a = DeclareLaunchArgument(\n "c",\n default_value=PathJoinSubstitution(\n  [FindPackageShare("q"), "c"]))',
            Severity.INFO,
        ),
    ],
)
def test_a_circle_matters_where_the_model_needs_it(tmp_path: Path, name: str, launch: str, severity: Severity) -> None:
    write(tmp_path / "p", {"package.xml": manifest(), "urdf/r.urdf": URDF, f"launch/{name}": launch})
    write(tmp_path / "q", {"package.xml": manifest("<depend>p</depend>", name="q")})
    write(tmp_path, {".git/HEAD": ""})
    assert [(f.message_id, f.severity) for f in findings(tmp_path, "PKG007")] == [("circle", severity)]


DRIVER = '<launch><include file="$(find {})/launch/driver.launch"/></launch>'


@pytest.mark.parametrize(
    ("choice", "others", "message"),
    [
        ("$(env LIDAR).launch", ["none"], "alternatives"),
        ("$(arg lidar).launch", ["kinect", "rplidar"], "alternatives"),
        ("lidar_$(arg lidar).launch", ["none"], "undeclared"),  # leads to none of them
        ("$(arg lidar).launch", [], "undeclared"),  # the only choice
        ("a.launch", ["none"], "undeclared"),
    ],
)
def test_one_of_several_drivers_is_a_choice(tmp_path: Path, choice: str, others: list[str], message: str) -> None:
    start = f'<launch><include file="$(find p)/launch/lidar/{choice}"/></launch>'
    write(tmp_path, {"package.xml": manifest(), "urdf/r.urdf": URDF, "launch/start.launch": start})
    write(tmp_path, {"launch/lidar/a.launch": DRIVER.format("amcl")})
    write(tmp_path, {f"launch/lidar/{name}.launch": "<launch/>" for name in others})
    (finding,) = findings(tmp_path, "PKG007")
    assert (finding.message_id, finding.severity == Severity.INFO) == (message, message == "alternatives")
    assert finding.fix is not None
    assert bool(finding.fix.edits) == (message == "undeclared")


@pytest.mark.parametrize(
    ("declared", "classic", "found"),
    [
        ("", "launch/classic.launch", {"alternatives": ["gazebo_ros", "ros_gz_sim"]}),
        ("<depend>gazebo_ros</depend>", "launch/classic.launch", {"alternatives": ["ros_gz_sim"]}),
        ("", "urdf/classic.xacro", {"undeclared": ["ros_gz_sim"]}),  # PKG001 reports what a model needs
        ("", "", {"undeclared": ["ros_gz_sim"]}),
    ],
)
def test_one_of_two_simulators_is_a_choice(
    tmp_path: Path, declared: str, classic: str, found: dict[str, list[str]]
) -> None:
    write(
        tmp_path,
        {"package.xml": manifest(declared), "urdf/r.urdf": URDF, "launch/gz.launch": DRIVER.format("ros_gz_sim")},
    )
    write(tmp_path, {classic: DRIVER.format("gazebo_ros")} if classic else {})
    assert {f.message_id: f.data["names"] for f in findings(tmp_path, "PKG007")} == found


# -- what is installed -----------------------------------------------------------------------------------------------------

XACRO = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
AMENT = "<export><build_type>ament_cmake</build_type></export>"
MESH = make_mesh_link("a", "package://p/meshes/a.stl")


@pytest.mark.parametrize(
    ("cmake", "told"),
    [
        ("install(DIRECTORY urdf DESTINATION share/${PROJECT_NAME})", True),
        ("# install(DIRECTORY meshes DESTINATION share/${PROJECT_NAME})", True),
        ("set(unused meshes)", True),
        ("find_package(meshes)", True),
        ("install(DIRECTORY\n  urdf\n  meshes\n  DESTINATION share/${PROJECT_NAME}/\n)", False),
        ("install(DIRECTORY meshes/visual DESTINATION share/${PROJECT_NAME}/meshes)", False),
        ('install(DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}/meshes" DESTINATION share/p)', False),
        ("install(DIRECTORY parts/ DESTINATION share/${PROJECT_NAME}/meshes)", False),
        ("install(FILES meshes/a.stl DESTINATION share/${PROJECT_NAME}/meshes)", False),
        ("install(DIRECTORY . DESTINATION share/${PROJECT_NAME})", False),
        ("set(D urdf meshes)\ninstall(DIRECTORY ${D} DESTINATION share/p)", False),
        ("set(D urdf)\nlist(APPEND D meshes)\ninstall(DIRECTORY ${D} DESTINATION share/p)", False),
        ("foreach(d IN ITEMS urdf meshes)\ninstall(DIRECTORY ${d}/ DESTINATION share/p/${d})\nendforeach()", False),
        ("set(L meshes)\nforeach(d IN LISTS L)\ninstall(DIRECTORY ${d} DESTINATION share/p)\nendforeach()", False),
        ("install(DIRECTORY ${FROM_ELSEWHERE} DESTINATION share/p)", False),
        ("add_subdirectory(parts)", False),
        ("ament_auto_package(INSTALL_TO_SHARE urdf meshes)", False),
        ("ament_auto_package(INSTALL_TO_SHARE urdf)", True),
        ("install_resources(meshes)", False),
        ('message("install(DIRECTORY meshes', True),  # a text without its end
    ],
)
def test_what_cmake_installs(tmp_path: Path, cmake: str, told: bool) -> None:
    files = {"package.xml": manifest(AMENT), "urdf/r.urdf": f'<robot name="r">{MESH}</robot>', "meshes/a.stl": ""}
    write(tmp_path, {**files, "CMakeLists.txt": f"project(p)\n{cmake}\nament_package()\n"})
    assert [f.data["folders"] for f in findings(tmp_path, "PKG008")] == ([["meshes"]] if told else [])


@pytest.mark.parametrize(
    ("load", "include", "is_used"),
    [
        ("$(find p)/urdf/car.xacro", "", False),
        ("$(find p)/urdf/gone.xacro", "", True),
        ("$(find p)/urdf/car.xacro", '<!-- <xacro:include filename="gone.xacro"/> -->', False),
        ("$(find p)/urdf/car.xacro", '<xacro:include filename="gone.xacro"/>', True),
        ("$(find p)/urdf/car.xacro", '<xacro:include filename="${part}.xacro"/>', True),
    ],
    ids=["others are named", "it is named", "it is named in a comment", "it is included", "the name is computed"],
)
def test_a_file_that_none_names_and_that_lacks_a_package_is_a_note(
    tmp_path: Path, load: str, include: str, is_used: bool
) -> None:
    lacking = f'<robot name="r" {XACRO}><xacro:include filename="$(find gone_parts)/a.xacro"/></robot>'
    files = {
        "package.xml": manifest(),
        "urdf/gone.xacro": lacking,
        "urdf/car.xacro": f'<robot name="c" {XACRO}><link name="b"/>{include}</robot>',
        "launch/car.launch": f"<launch><!-- gone.xacro --><param name='robot_description' command='xacro {load}'/></launch>",
    }
    finding = only(check(write(tmp_path, files) / "urdf/gone.xacro", codes={"PKG001"}))
    wanted = ("expansion", Severity.ERROR) if is_used else ("expansion-aside", Severity.INFO)
    assert (finding.message_id, finding.severity, finding.blocks_check) == (*wanted, True)


@pytest.mark.parametrize(
    ("made_of", "copy", "is_used"),
    [
        ("gone.xacro", "", True),
        ("/home/me/ws/src/p/urdf/gone.xacro", "old/gone.xacro", True),
        ("gone.xacro", "old/gone.xacro", True),
        ("/home/me/ws/src/p/old/gone.xacro", "old/gone.xacro", False),
        ("gone_arm.xacro", "", False),
    ],
)
@pytest.mark.parametrize(
    "body", ['<xacro:include filename="$(find gone_parts)/a.xacro"/>', MESH.replace("/p/", "/gone_parts/")]
)
def test_what_a_generated_file_says_it_was_made_of_is_not_left_aside(
    tmp_path: Path, made_of: str, copy: str, is_used: bool, body: str
) -> None:
    files = {
        "package.xml": manifest(),
        "urdf/gone.xacro": f'<robot name="r" {XACRO}>{body}</robot>',
        "urdf/car.urdf": f'<robot name="c"><!-- | This document was autogenerated by xacro from {made_of} | --></robot>',
        "launch/car.launch": "<launch><param name='robot_description' textfile='$(find p)/urdf/car.urdf'/></launch>",
    }
    if copy:
        files[copy] = "<robot/>"
    finding = only(check(write(tmp_path, files) / "urdf/gone.xacro", codes={"PKG001"}))
    assert finding.message_id in ({"expansion", "files"} if is_used else {"expansion-aside", "files-aside"})
    assert finding.severity == (Severity.ERROR if is_used else Severity.INFO)


@pytest.mark.parametrize(
    ("there", "told", "repair"),
    [
        ("meshes/other.obj", True, "correct the path; or add the file and write `package://p/d/meshes/wheel.stl`"),
        ("parts/other.obj", False, "correct the path, or add the folder with its files"),
    ],
    ids=["beside the file", "nowhere"],
)
def test_a_relative_path_of_an_included_file_starts_at_the_model(
    tmp_path: Path, there: str, told: bool, repair: str
) -> None:
    part = f'<robot name="r">{make_mesh_link("a", "../meshes/wheel.stl")}</robot>'
    main = f'<robot name="r" {XACRO}><xacro:include filename="urdf/part.urdf"/></robot>'
    files = {"package.xml": manifest(), "d/urdf/part.urdf": part, "d/main.xacro": main, f"d/{there}": ""}
    finding = only(check(write(tmp_path, files) / "d/main.xacro", codes={"PKG002"}))
    assert ("; the path starts at the model's folder; from that of " in finding.message) == told
    assert finding.fix is not None
    assert finding.fix.title == repair


@pytest.mark.parametrize(
    ("cmake", "told"),
    [
        ("find_package(lely_core_libraries REQUIRED)\ncogen_dcf(arm)", False),
        ("generate_dcf(arm)", False),
        ("setup_robot(arm)", False),
        ("cogen_dcf(other)", True),
        ("add_custom_target(arm)", True),
        ("target_compile_features(arm PUBLIC c_std_99)", True),
        ("set(arm 1 PARENT_SCOPE)", True),
    ],
)
def test_a_function_of_another_package_may_install_the_folder_of_its_argument(
    tmp_path: Path, cmake: str, told: bool
) -> None:
    files = {"package.xml": manifest(AMENT), "urdf/r.urdf": f'<robot name="r">{MESH}</robot>', "meshes/a.stl": ""}
    write(tmp_path, {**files, "meshes/arm/b.stl": "", "CMakeLists.txt": f"project(p)\n{cmake}\nament_package()\n"})
    assert bool(findings(tmp_path, "PKG008")) == told


def test_nothing_of_a_package_inside_another_is_installed(tmp_path: Path) -> None:
    files = {"package.xml": manifest(AMENT), "urdf/r.urdf": f'<robot name="r">{MESH}</robot>', "meshes/a.stl": ""}
    outer = manifest(AMENT).replace("<name>p<", "<name>outer<")
    inner = {f"outer/p/{name}": text for name, text in files.items()}
    # A manifest at the top of a repository may be that of all its packages.
    write(tmp_path, {".git/HEAD": "", "package.xml": outer, **inner, "outer/p/CMakeLists.txt": "project(p)"})
    assert findings(tmp_path / "outer/p", "PKG008")
    write(tmp_path, {"outer/package.xml": outer})
    assert not findings(tmp_path / "outer/p", "PKG008")


@pytest.mark.parametrize(
    ("cmake", "after"),
    [
        (
            "install(DIRECTORY urdf DESTINATION share/p FILES_MATCHING PATTERN *.xacro)",
            ")\ninstall(DIRECTORY meshes DESTINATION share/${PROJECT_NAME})\n\nament_package()",
        ),
        (
            "if(SIMULATION)\ninstall(DIRECTORY urdf DESTINATION share/p)\nendif()",
            "endif()\ninstall(DIRECTORY meshes DESTINATION share/${PROJECT_NAME})\n\nament_package()",
        ),
        ("install(DIRECTORY urdf DESTINATION share/${PROJECT_NAME})", "(DIRECTORY urdf meshes DESTINATION"),
        ("install(DIRECTORY\n  urdf\n  DESTINATION share/p/\n)", "  urdf meshes\n  DESTINATION"),
        ("ament_auto_package(INSTALL_TO_SHARE urdf)", "(INSTALL_TO_SHARE urdf meshes)"),
        ("", "install(DIRECTORY meshes DESTINATION share/${PROJECT_NAME})\n\nament_package()"),
    ],
)
def test_missing_folder_is_named_where_others_are(tmp_path: Path, cmake: str, after: str) -> None:
    files = {"package.xml": manifest(AMENT), "urdf/r.urdf": f'<robot name="r">{MESH}</robot>', "meshes/a.stl": ""}
    write(tmp_path, {**files, "CMakeLists.txt": (text := f"project(p)\n{cmake}\nament_package()\n")})
    (finding,) = findings(tmp_path, "PKG008")
    assert finding.fix is not None
    (edit,) = finding.fix.edits
    text = text[: edit.span.start] + edit.replacement + text[edit.span.end :]
    assert after in text
    (tmp_path / "CMakeLists.txt").write_text(text)
    assert not findings(tmp_path, "PKG008")


@pytest.mark.parametrize("is_there", [True, False])
def test_a_folder_that_is_not_installed_may_lack_the_file_too(tmp_path: Path, is_there: bool) -> None:
    launch = "p = join(get_package_share_directory('p'), 'maps', 'hall.yaml')"
    files = {
        "package.xml": manifest(AMENT),
        "launch/r.launch.py": launch,
        "maps/hall.yaml" if is_there else "maps/a": "",
    }
    cmake = "project(p)\ninstall(DIRECTORY launch DESTINATION share/p)\nament_package()\n"
    write(tmp_path, {**files, "CMakeLists.txt": cmake})
    (finding,) = findings(tmp_path, "PKG008")
    assert finding.fix is not None
    assert ("the file is missing" in finding.headline) != is_there
    assert (
        finding.fix.title.endswith("; add maps/hall.yaml too or correct the path, unless a program writes it")
        != is_there
    )


def test_a_folder_of_programs_may_be_meant_where_it_is_installed(tmp_path: Path) -> None:
    launch = "p = join(get_package_share_directory('p'), 'scripts', 'run.py')"
    files = {"package.xml": manifest(AMENT), "launch/r.launch.py": launch, "scripts/run.py": ""}
    programs = "install(PROGRAMS scripts/run.py DESTINATION lib/${PROJECT_NAME})"
    cmake = f"project(p)\ninstall(DIRECTORY launch DESTINATION share/p)\n{programs}\nament_package()\n"
    write(tmp_path, {**files, "CMakeLists.txt": cmake})
    (finding,) = findings(tmp_path, "PKG008")
    assert finding.fix is not None
    assert not finding.fix.edits
    assert finding.fix.title.endswith(
        "; scripts is installed in lib/${PROJECT_NAME}: if programs are meant, start them from there"
    )


@pytest.mark.parametrize("cmake", ["", "install(DIRECTORY urdf meshes DESTINATION share/${PROJECT_NAME})"])
def test_a_project_with_another_name_than_the_package_installs_elsewhere(tmp_path: Path, cmake: str) -> None:
    files = {"package.xml": manifest(AMENT), "urdf/r.urdf": f'<robot name="r">{MESH}</robot>', "meshes/a.stl": ""}
    write(tmp_path, {**files, "CMakeLists.txt": (text := f"project(q)\n{cmake}\nament_package()\n")})
    (finding,) = findings(tmp_path, "PKG008")
    assert finding.fix is not None
    assert "its project is q, so share/${PROJECT_NAME} is another folder" in finding.fix.title
    (edit,) = finding.fix.edits
    (tmp_path / "CMakeLists.txt").write_text(text[: edit.span.start] + edit.replacement + text[edit.span.end :])
    assert not findings(tmp_path, "PKG008")


# A function of setup.py that lists the files of a folder.
COLLECT = """
def collect(top):
    places = {}
    for path in [f for f in glob(os.path.join(top, '**', '*'), recursive=True) if os.path.isfile(f)]:
        place = os.path.join('share', 'p', os.path.dirname(path))
        places.setdefault(place, []).append(path)
    return list(places.items())

"""


@pytest.mark.parametrize(
    ("setup", "told"),
    [
        ("setup(data_files=[('share/p', ['package.xml'])])", True),
        ("setup(data_files=[('share/p/meshes', glob('meshes/*'))])", False),
        ("setup(data_files=[(os.path.join('share', name, 'meshes'), ['a.stl'])])", False),
        ("setup(data_files=[(d, f) for d, f in files('.')])", False),
        ("setup(data_files=all_of('**/*'))", False),
        ("setup(data_files=", False),
        (f"{COLLECT}setup(data_files=[] + collect('meshes'))", False),
        (f"{COLLECT}setup(data_files=[] + collect(top='meshes'))", False),
        (f"{COLLECT}setup(data_files=[] + collect('urdf'))", True),
        (f"{COLLECT.replace('os.path.dirname', 'find_folder')}setup(data_files=collect('meshes'))", False),
        ("d = []\nd.insert(0, ('share/p/meshes', ['meshes/a.stl']))\nsetup(data_files=d)", False),
        ("d = {}\nd[place()] = ['meshes/a.stl']\nsetup(data_files=list(d.items()))", False),
    ],
)
def test_what_setup_py_installs(tmp_path: Path, setup: str, told: bool) -> None:
    export = "<export><build_type>ament_python</build_type></export>"
    files = {"package.xml": manifest(export), "urdf/r.urdf": f'<robot name="r">{MESH}</robot>', "meshes/a.stl": ""}
    write(tmp_path, {**files, "setup.py": f"import os\n{setup}\n"})
    assert bool(findings(tmp_path, "PKG008")) == told


@pytest.mark.parametrize(
    ("python", "folders"),
    [
        ("os.path.join(get_package_share_directory('p'), 'urdf', 'r.urdf')", ["urdf"]),
        ("PathJoinSubstitution([FindPackageShare('p'), 'urdf/r.urdf'])", ["urdf"]),
        ("FindPackageShare(package='p').find('p') + '/urdf/r.urdf'", ["urdf"]),
        ("share = get_package_share_path('p')\nmodel = share / 'urdf' / 'r.urdf'", ["urdf"]),
        ("    share = FindPackageShare('p')\n    a = join(share, 'urdf/r.urdf'), join(share, 'config', f)", ["config", "urdf"]),
        ("os.path.join(get_package_share_directory('p'), 'r.urdf')", []),
        ("os.path.join(get_package_share_directory('p'), folder, 'urdf')", []),
        ("os.path.join(get_package_share_directory('p'), 'nothing', 'r.urdf')", []),
    ],
)  # fmt: skip
def test_folders_that_a_python_launch_file_looks_into(tmp_path: Path, python: str, folders: list[str]) -> None:
    files = {
        "package.xml": manifest(AMENT),
        "CMakeLists.txt": "ament_package()",
        "config/a.yaml": "",
        "urdf/r.urdf": URDF,
    }
    write(tmp_path, {**files, "launch/a.launch.py": python})
    assert [f.data["folders"] for f in findings(tmp_path, "PKG008")] == ([folders] if folders else [])


def test_packages_of_ros_1_and_other_builds_are_left_alone(tmp_path: Path) -> None:
    write(tmp_path, {"urdf/r.urdf": f'<robot name="r">{MESH}</robot>', "meshes/a.stl": "", "CMakeLists.txt": "x()"})
    for export in ("<buildtool_depend>catkin</buildtool_depend>", AMENT.replace("ament_cmake", "cmake")):
        write(tmp_path, {"package.xml": manifest(export)})
        assert not findings(tmp_path, "PKG008")


# -- meshes that nothing names ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "text", "left"),
    [
        ("urdf/a.urdf", make_mesh_link("a", "package://p/meshes/b.stl"), ["meshes/c.dae"]),
        ("urdf/a.xacro", make_mesh_link("a", "package://p/meshes/${kind}.stl"), ["meshes/c.dae"]),
        ("urdf/a.xacro", make_mesh_link("a", "package://p/meshes/${kind}.${format}"), []),
        ("urdf/a.xacro", make_mesh_link("a", "$(find p)/meshes/${file}"), []),
        ("urdf/a.xacro", make_mesh_link("a", "${folder}/b.stl"), ["meshes/c.dae"]),
        ("urdf/a.xacro", make_mesh_link("a", "package://p/other/${kind}.stl"), ["meshes/b.stl", "meshes/c.dae"]),
        ("config/a.yaml", "mesh: meshes/b.stl", ["meshes/c.dae"]),
        ("config/a.yaml", "meshes:\n - b.stl\n - c.dae", []),
        ("scripts/a.py", 'load("meshes/" + name + ".stl")', ["meshes/c.dae"]),
        ("scripts/a.py", 'load(f"meshes/{name}.stl")', ["meshes/c.dae"]),
        ("src/a.cpp", 'load("c.dae");', ["meshes/b.stl"]),
        ("notes.md", "b.stl and c.dae", ["meshes/b.stl", "meshes/c.dae"]),
    ],
)
def test_what_names_a_mesh(tmp_path: Path, name: str, text: str, left: list[str]) -> None:
    used = f'<robot name="r">{make_mesh_link("a", "package://p/meshes/a.stl")}</robot>'
    files = {"package.xml": manifest(), "urdf/r.urdf": used, name: text}
    write(tmp_path, {**files, "meshes/a.stl": "", "meshes/b.stl": "", "meshes/c.dae": ""})
    found = [f for f in findings(tmp_path, "PKG010") if f.code == "PKG010"]  # the xacro files cannot be expanded
    assert [f.data["files"] for f in found] == ([left] if left else [])


def test_meshes_are_asked_for_in_runs_on_whole_packages_only(tmp_path: Path) -> None:
    used = f'<robot name="r">{make_mesh_link("a", "package://p/meshes/a.stl")}</robot>'
    root = write(
        tmp_path, {"p/package.xml": manifest(), "p/urdf/r.urdf": used, "p/meshes/a.stl": "", "p/meshes/b.stl": ""}
    )
    for path in (root, root / "p", root / "p/package.xml"):
        assert [f.data["files"] for f in findings(path, "PKG010")] == [["meshes/b.stl"]]
    for path in (root / "p/urdf/r.urdf", root / "p/meshes/a.stl", root / "p/urdf"):
        assert not findings(path, "PKG010")


def test_meshes_for_other_packages_are_left_alone(tmp_path: Path) -> None:
    files = {"p/package.xml": manifest(), "p/urdf/r.urdf": URDF, "p/meshes/a.stl": "", "p/meshes/b.stl": ""}
    write(tmp_path, files)
    assert not findings(tmp_path, "PKG010")  # nothing at hand names any of them
    text = f'<robot name="q">{make_mesh_link("a", "package://p/meshes/a.stl")}</robot>'
    write(tmp_path, {"q/package.xml": manifest(name="q"), "q/urdf/q.urdf": text})
    assert [f.data["files"] for f in findings(tmp_path, "PKG010")] == [["meshes/b.stl"]]


def test_mesh_may_be_for_a_package_out_of_reach_that_depends_on_this_one(tmp_path: Path) -> None:
    used = f'<robot name="r">{make_mesh_link("a", "package://p/meshes/a.stl")}</robot>'
    other = manifest("<depend>p</depend>", name="q")
    secret = f'<robot name="q">{make_mesh_link("a", "package://p/meshes/b.stl")}</robot>'
    files = {"p/package.xml": manifest(), "p/urdf/r.urdf": used, "p/meshes/a.stl": "", "p/meshes/b.stl": ""}
    write(tmp_path, {**files, "q/package.xml": manifest(name="q"), "q/urdf/q.urdf": secret})
    (tmp_path / ".git").rmdir()  # nothing says that the two belong together
    assert findings(tmp_path / "p", "PKG010")
    write(tmp_path, {"q/package.xml": other})
    assert not findings(tmp_path / "p", "PKG010")


# -- paths made of arguments -------------------------------------------------------------------------------------------


def audit_xacro(model: Path, body: str) -> Run:
    path = model.with_name("r.urdf.xacro")
    model.unlink()
    path.write_text(f'<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">{body}</robot>', encoding="utf-8")
    return check(path, codes=CODES)


CHOSEN = (
    '<xacro:include filename="$(find p)/config/$(arg type).xacro"/><xacro:property name="model" value="$(arg type)"/>'
)


@pytest.mark.parametrize(
    ("filename", "expected"),
    [
        ("package://p/meshes/${model}/a.stl", "; argument type (default 'small') leads there; known value: large"),
        ("package://p/meshes/${model}/never.stl", "; argument type (default 'small') leads there; known value: large"),
        ("package://p/meshes/none/a.stl", ""),
    ],
)
def test_a_missing_mesh_names_the_argument_that_leads_there(tmp_path: Path, filename: str, expected: str) -> None:
    model = package(tmp_path, "meshes/large/a.stl", "config/large.xacro", "config/small.xacro")
    for name in ("large", "small"):
        config = tmp_path / f"p/config/{name}.xacro"
        config.write_text('<robot xmlns:xacro="http://www.ros.org/wiki/xacro"/>', encoding="utf-8")
    arguments = '<xacro:arg name="type" default="small"/>'
    finding = only(audit_xacro(model, arguments + CHOSEN + link("l", visual(mesh(filename)))))
    assert finding.data["hint"] == expected or (not expected and "argument" not in finding.message)
    assert ("argument[type]" in [place.subject for place in finding.related]) == bool(expected)


def test_a_missing_package_names_the_argument_that_gives_its_name(tmp_path: Path) -> None:
    arguments = '<xacro:arg name="where" default="nowhere"/>'
    finding = only(
        audit_xacro(package(tmp_path), arguments + link("l", visual(mesh("package://$(arg where)/meshes/a.stl"))))
    )
    assert "package nowhere is not found, named by argument where (default 'nowhere'), so 1 file " in finding.message


# -- packages of one name --------------------------------------------------------------------------------------------------


def write_package(folder: Path) -> None:
    write(folder, {"package.xml": manifest(name="car_description"), "urdf/car.urdf": URDF})


def find_duplicates(*paths: Path) -> list[tuple[str, list[str]]]:
    run = check(*paths, codes={"PKG013"}, tier="source")
    return [(f.message, f.data["folders"]) for f in run.findings]


@pytest.mark.parametrize(
    ("one", "other", "message"),
    [
        ("chapter_2_codes/car", "chapter_10_codes/car", "series"),
        ("Week1/car", "Week2/car", "series"),
        ("chapter_2/car", "chapter_3/old/car", "workspaces"),
        ("chapter_2/car", "car", "workspaces"),
        ("robot1/car", "robot2/car", "workspaces"),
        ("robot/car", "robot/car_copy", "several"),
        ("patch1/car", "patch2/car", "workspaces"),
        ("before/src/car", "today/src/old/car", "workspaces"),
        ("src/old/car", "src/new/car", "several"),
    ],
)
def test_chapters_of_a_book_and_copies_of_a_workspace_are_built_one_at_a_time(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, one: str, other: str, message: str
) -> None:
    write_package(tmp_path / one)
    write_package(tmp_path / other)
    monkeypatch.chdir(tmp_path)
    (finding,) = check(Path(), codes={"PKG013"}, tier="source").findings
    assert (finding.message_id, finding.severity == Severity.INFO) == (message, message != "several")


@pytest.mark.parametrize(
    ("other", "told"),
    [
        ("car_copy", True),
        ("deep/down/in/the/tree/car", True),
        ("a/car_description", True),  # in it
        ("build/car", False),
        ("install/car/share/car_description", False),
        ("out/share/car_description", False),
        ("devel/car", False),
        ("ignored/car", False),
        ("package/car", False),  # a build tool does not look into the other package
        (".hidden/car", False),
    ],
)
def test_which_packages_of_one_name_are_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, other: str, told: bool
) -> None:
    write_package(tmp_path / "a")
    write_package(tmp_path / other)
    write(tmp_path, {"package/package.xml": manifest(name="package")} if "package/" in other else {})
    write(tmp_path, {"ignored/COLCON_IGNORE": "", ".git/HEAD": ""})
    monkeypatch.chdir(tmp_path)
    assert len(find_duplicates(Path())) == told  # one for both, though both are checked
    # Around a given file, packages are not looked for in packages: the inner one knows of the outer one.
    first, second = ("a/car_description", "a") if other == "a/car_description" else ("a", other)
    ((message, folders),) = find_duplicates(Path(first, "urdf/car.urdf")) or [("", [])]
    assert (folders == [first, second]) == told
    assert (f"a/package.xml, {other}/package.xml" in message) == told


def test_work_trees_of_one_repository_hold_the_same_package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "main/.git/worktrees/branch").mkdir(parents=True)
    write(tmp_path, {"branch/.git": f"gitdir: {tmp_path}/main/.git/worktrees/branch\n"})
    for name in ("main", "branch"):
        write_package(tmp_path / name / "car")
    monkeypatch.chdir(tmp_path)
    assert not find_duplicates(Path())
    write_package(tmp_path / "branch/other")
    assert len(find_duplicates(Path())) == 1
    for place in ("x\0y", "/" + "x/" * 4_500, "\n"):  # of a stranger
        (tmp_path / "branch/.git").write_text(f"gitdir: {place}/worktrees/branch\n")
        assert len(find_duplicates(Path())) == 1
    (tmp_path / "branch/.git").unlink()  # a copy of the files, which a build tool refuses
    assert len(find_duplicates(Path())) == 1


def test_each_package_of_one_name_uses_its_own_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("one", "two"):
        write_package(tmp_path / name)
        part = f'<robot {XACRO}><xacro:macro name="part"><link name="{name}"/></xacro:macro></robot>'
        include = f'<xacro:include filename="$(find car_description)/urdf/{name}.xacro"/><xacro:part/>'
        files = {f"urdf/{name}.xacro": part, "urdf/r.urdf.xacro": f'<robot name="r" {XACRO}>{include}</robot>'}
        write(tmp_path / name, files)
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path / "one"))
    run = check(tmp_path, codes={"XAC001"}, tier="source")
    assert [(model.status, model.links) for model in run.models] == [("checked", 1)] * 4


# -- what a path that leads nowhere may mean -------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("missing", "there", "told"),
    [
        ("wheel_left.stl", "wheel_lefft.stl", True),
        ("wheel_left.stl", "wheel_left.dae", True),
        ("wheel_left.stl", "WheelLeft.stl", True),
        ("wheel_left.stl", "wheel_right.stl", False),
        ("bracelet_link.STL", "base_link.STL", False),
        ("body.dae", "pack_body.dae", False),
        ("base_imu.stl", "base_link.stl", False),
        ("link_1.stl", "link_2.stl", False),
        ("link1.stl", "link_1.stl", True),
        ("arm.stl", "art.stl", False),
    ],
)
def test_a_file_of_another_part_is_not_what_is_meant(tmp_path: Path, missing: str, there: str, told: bool) -> None:
    robot = f'<robot name="r">{make_mesh_link("a", f"package://p/meshes/{missing}")}</robot>'
    write(tmp_path, {"package.xml": manifest(), "urdf/r.urdf": robot, f"meshes/{there}": ""})
    (finding,) = findings(tmp_path, "PKG002")
    assert ("did you mean" in finding.message, len(finding.data["near"])) == (told, int(told))


@pytest.mark.parametrize(
    ("folder", "near"),
    [
        ("q/meshes/ur5e", ["q"]),
        ("q/meshes/ur10", []),
        ("p/meshes/ur10", []),
        ("p/meshes/ur5", []),
        ("p/meshes/arm", ["arm"]),
    ],
)
def test_the_folder_of_another_variant_is_not_what_is_meant(tmp_path: Path, folder: str, near: list[str]) -> None:
    """A package that has all files of the missing folder is."""
    names = ("base.dae", "shoulder.dae", "wrist.dae")
    links = "".join(make_mesh_link(name, f"package://p/meshes/ur5e/{name}") for name in names)
    files = {
        "p/package.xml": manifest(),
        "q/package.xml": manifest(name="q"),
        "p/urdf/r.urdf": f'<robot name="r">{links}</robot>',
    }
    write(tmp_path, files | {"p/meshes/readme.txt": ""} | {f"{folder}/{name}": "" for name in names})
    (finding,) = findings(tmp_path, "PKG002")
    assert len(finding.data["near"]) == len(near)
    assert all(
        Path(path).parent.name == name or path == name for path, name in zip(finding.data["near"], near, strict=True)
    )
    assert ("the package q, which has them" in finding.message) == (near == ["q"])
    assert finding.fix is not None
    assert ("and declare q in package.xml" in finding.fix.title) == (near == ["q"])


@pytest.mark.parametrize(("build", "told"), [("ament_cmake", True), ("ament_python", True), ("catkin", False)])
def test_a_file_that_is_not_installed_is_named(tmp_path: Path, build: str, told: bool) -> None:
    mesh = make_mesh_link("a", "package://p/meshes/a.stl")
    include = '<xacro:include filename="$(find p)/parts/b.xacro"/>'
    files = {
        "package.xml": manifest(f"<export><build_type>{build}</build_type></export>"),
        "description/urdf/r.urdf": f'<robot name="r">{mesh}</robot>',
        "description/urdf/s.urdf.xacro": f'<robot name="s" {XACRO}>{include}<link name="l"/></robot>',
        "description/meshes/a.stl": "",
        "description/parts/b.xacro": f"<robot {XACRO}/>",
    }
    write(tmp_path, files)
    run = check(tmp_path, codes={"PKG002", "XAC001"}, tier="source")
    found = {f.code: f.message for f in run.findings}
    assert ("description/meshes; is that installed?" in found["PKG002"]) == told
    assert ("description/parts; is that installed?" in found["XAC001"]) == told
    fixes = {f.code: f.fix.title for f in run.findings if f.fix is not None}
    assert fixes["XAC001"].startswith("install its folder") == told


@pytest.mark.parametrize(
    ("setup", "messages"),
    [
        ('package_dir={"": "src"}, package_data={"p": ["meshes/*.stl"]}', {"python-data", "folder"}),
        ('package_dir={"p": "src/p"}, package_data={"": ["meshes/**/*.stl"]}', {"python-data", "folder"}),
        ('package_dir={"": "src"}, package_data={"p": list_below("src/p")}', {"python-data", "folder"}),
        ('package_dir={"": "src"}, package_data={"p": ["*.stl"]}', {"folder"}),
        ('package_dir={"": "src"}, package_data={"other": ["meshes/*.stl"]}', {"folder"}),
        ('package_dir={"": "lib"}, package_data={"p": ["meshes/*.stl"]}', {"folder"}),
        ('package_data={"p": ["meshes/*.stl"]}', {"folder"}),
        ('package_dir={"": "src"}', {"folder"}),
    ],
)
def test_meshes_in_the_python_package_are_not_in_share(tmp_path: Path, setup: str, messages: set[str]) -> None:
    parts = "".join(make_mesh_link(name, f"package://p/meshes/{name}.stl") for name in ("a", "gone"))
    files = {
        "package.xml": manifest("<export><build_type>ament_python</build_type></export>"),
        "setup.py": f'setup(name="p", {setup}, data_files=[("share/p", ["package.xml"])])',
        "urdf/r.urdf": f'<robot name="r">{parts}</robot>',
        "src/p/meshes/a.stl": "",
    }
    write(tmp_path, files)
    found = {f.message_id: f for f in findings(tmp_path, "PKG002")}
    assert found.keys() == messages
    assert found["folder"].severity == Severity.ERROR
    told = found.get("python-data")
    if told is not None:
        assert (told.severity, told.data["files"]) == (Severity.WARNING, ["package://p/meshes/a.stl"])
        assert found["folder"].data["files"] == ["package://p/meshes/gone.stl"]


@pytest.mark.parametrize(
    ("there", "told"),
    [
        (("meshes/other/link.stl",), False),  # nothing says whose it is
        (("meshes/arm_visual/link.stl",), True),
        (("meshes/other/link.stl", "meshes/other/own.stl"), True),  # the model has another file there
        (("meshes/other/link.stl", "meshes/arm/base.stl"), False),  # the folder is right: that is another robot's
        (("meshes/arm/visual/link.stl", "meshes/arm/base.stl"), True),
        (("meshes/link.stl", "meshes/arm/base.stl"), True),
    ],
)
def test_a_file_of_the_same_name_may_be_another_robots(tmp_path: Path, there: tuple[str, ...], told: bool) -> None:
    names = ("meshes/arm/link.stl", *(name for name in there if name.endswith("own.stl")))
    robot = f'<robot name="r">{make_mesh_link("a", *(f"package://p/{name}" for name in names))}</robot>'
    write(tmp_path, {"package.xml": manifest(), "urdf/r.urdf": robot, **dict.fromkeys(there, "")})
    (finding,) = findings(tmp_path, "PKG002")
    assert bool(finding.data["near"]) == told


@pytest.mark.parametrize(
    ("name", "text", "repair"),
    [
        (".gitmodules", '[submodule "m"]\n\tpath = meshes\n\turl = u\n', "check out its submodule: `git submodule "),
        (
            ".gitmodules",
            '[submodule "m"]\n\tpath = other\n\turl = u\n',
            "correct the path, or add the folder with its files",
        ),
        (
            ".gitignore",
            "*.stl\n",
            "correct the path, or add the folder with its files (.gitignore leaves it out; a build or a script may",
        ),
        (".gitignore", "*.dae\n", "correct the path, or add the folder with its files"),
    ],
)
def test_git_may_say_why_a_mesh_is_not_here(tmp_path: Path, name: str, text: str, repair: str) -> None:
    robot = f'<robot name="r">{make_mesh_link("a", "package://p/meshes/a.stl")}</robot>'
    write(tmp_path, {"package.xml": manifest(), "urdf/r.urdf": robot, name: text, ".git/HEAD": ""})
    (finding,) = findings(tmp_path, "PKG002")
    assert finding.fix is not None
    assert finding.fix.title.startswith(repair)
    assert ("gitignore" in finding.fix.title) == ("gitignore" in repair)


@pytest.mark.parametrize(
    ("elsewhere", "told"),
    [
        (("old/a.stl", "old/b.stl", "old/c.stl"), 3),
        (("old/a.stl", "old/b.stl", "old/c.stl", "new/a.stl"), 3),
        (("old/a.stl", "old/b.stl", "old/c.stl", "new/a.stl", "new/b.stl", "new/c.stl"), 0),
        (("old/a.stl", "old/b.stl"), 0),
    ],
)
def test_files_that_are_together_in_another_folder_are_those_that_are_meant(
    tmp_path: Path, elsewhere: tuple[str, ...], told: int
) -> None:
    links = "".join(make_mesh_link(name, f"package://p/meshes/{name}.stl") for name in "abc")
    joints = "".join(f'<joint name="j{c}" type="fixed"><parent link="a"/><child link="{c}"/></joint>' for c in "bc")
    files = ("meshes/base.stl", *elsewhere)
    write(
        tmp_path,
        {
            "package.xml": manifest(),
            "urdf/r.urdf": f'<robot name="r">{links}{joints}</robot>',
            **dict.fromkeys(files, ""),
        },
    )
    hints = [one.data["hint"] for f in findings(tmp_path, "PKG002") for one in (f.occurrences or (f,))]
    assert sum("did you mean" in hint and "old/" in hint for hint in hints) == told


def test_a_package_around_a_folder_that_is_no_repository_is_no_duplicate(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / ".git").rmdir()
    for name in ("here/car", "there/car"):
        write_package(tmp_path / name)
    monkeypatch.chdir(tmp_path / "here")
    assert not find_duplicates(Path("car"))
    assert not find_duplicates(Path("car/urdf/car.urdf"))
    assert len(find_duplicates(tmp_path)) == 1


@pytest.mark.parametrize(("kept", "expected"), [("false", "refuses"), ("true", "loads")])
def test_mujoco_opens_a_drawn_mesh_only_where_the_file_keeps_it(tmp_path: Path, kept: str, expected: str) -> None:
    section = f'<mujoco><compiler discardvisual="{kept}"/></mujoco>'
    robot = f'<robot name="r">{section}{make_mesh_link("a", "package://p/meshes/never.stl")}</robot>'
    write(tmp_path, {"package.xml": manifest(), "urdf/r.urdf": robot})
    (finding,) = findings(tmp_path, "PKG002")
    assert finding.consequences["mujoco"].startswith(expected)


@pytest.mark.parametrize(
    ("place", "look_up", "told"),
    [
        ("launch/a.launch", "find", False),
        ("urdf/a.launch", "find", False),
        ("urdf/a.launch.xml", "find", False),
        ("launch/a.launch", "find-pkg-share", False),
        ("launch/a.launch.xml", "find-pkg-share", True),
        ("urdf/a.launch", "find-pkg-share", True),
        ("a.launch", "find-pkg-share", True),
    ],
)
def test_a_launch_file_of_ros_1_needs_no_folder(tmp_path: Path, place: str, look_up: str, told: bool) -> None:
    launch = f'<launch><node name="r" pkg="rviz2" exec="rviz2" args="-d $({look_up} p)/config/r.rviz"/></launch>'
    files = {"package.xml": manifest(AMENT), "urdf/r.urdf": URDF, "config/r.rviz": "", place: launch}
    write(tmp_path, {**files, "CMakeLists.txt": "install(DIRECTORY urdf DESTINATION share/p)\nament_package()\n"})
    assert [f.data["folders"] for f in findings(tmp_path, "PKG008")] == ([["config"]] if told else [])


@pytest.mark.parametrize(
    ("lines", "is_told"),
    [
        ("    file = os.path.join(folder, 'config', 'a.yaml')\n    return Node(arguments=[])", False),
        (
            "    file = os.path.join(\n        folder,\n        'config', 'a.yaml')\n    return Node(arguments=[])",
            False,
        ),
        ("    file = os.path.join(folder, 'config', 'a.yaml')\n    return Node(parameters=[file])", True),
        ("    file = os.path.join(folder, 'config', 'a.yaml')\n    return Node()\nfrom file import more", False),
        (
            "    file = os.path.join(folder, 'config', 'a.yaml')\n    # Node(parameters=[file])\n    return Node()",
            False,
        ),
        ("    return Node(parameters=[os.path.join(folder, 'config' 'more', 'a.yaml')])", False),  # configmore/a.yaml
        ("    return Node(parameters=[os.path.join(folder, 'config' '/a.yaml')])", True),
        ("    return Node(parameters=[os.path.join(folder, 'config', 'a.yaml')])", True),
        ("    return Node(\n        parameters=os.path.join(folder, 'config', 'a.yaml'))", True),
    ],
)
def test_a_path_that_is_only_assigned_is_read_by_nothing(tmp_path: Path, lines: str, is_told: bool) -> None:
    begin = "def generate_launch_description():\n    folder = get_package_share_directory('p')\n"
    export = "<export><build_type>ament_cmake</build_type></export>"
    write(tmp_path, {"package.xml": manifest(export), "config/a.yaml": "", "launch/a.launch.py": begin + lines})
    write(tmp_path, {"CMakeLists.txt": "project(p)\ninstall(DIRECTORY launch DESTINATION share/${PROJECT_NAME})"})
    write(tmp_path, {"urdf/r.urdf": URDF})
    assert bool(findings(tmp_path, "PKG008")) == is_told


@pytest.mark.parametrize(
    ("head", "launch", "severity"),
    [
        ("<!-- | This document was autogenerated by xacro from arm.xacro | -->", "", Severity.INFO),
        ("<!-- | This document was autogenerated by xacro from arm.xacro | -->", "arm.urdf", Severity.WARNING),
        ("", "", Severity.WARNING),
    ],
)
def test_a_path_into_a_release_matters_where_the_model_is_started(
    tmp_path: Path, head: str, launch: str, severity: Severity
) -> None:
    mesh = make_mesh_link("a", "/opt/ros/humble/share/ur_description/meshes/base.dae")
    write(tmp_path, {"package.xml": manifest(), "urdf/arm.urdf": f"{head}<robot name='r'>{mesh}</robot>"})
    write(tmp_path, {"launch/a.launch.py": f"FILE = '{launch}'"})
    run = check(tmp_path, codes={"PKG004"})
    assert [f.severity for f in run.findings] == [severity]


@pytest.mark.parametrize(
    ("launch", "severity"),
    [
        ("<param textfile='$(find arm)/urdf/arm.urdf'/>", Severity.INFO),
        ("<param textfile='$(find arm)/urdf/old.urdf'/>", Severity.ERROR),
        (
            "<param textfile='$(find arm)/urdf/arm.urdf'/><param textfile='$(find arm)/urdf/$(arg model).urdf'/>",
            Severity.ERROR,
        ),
        ("", Severity.ERROR),
    ],
)
def test_a_model_beside_the_one_that_is_loaded_lacks_no_package(
    tmp_path: Path, launch: str, severity: Severity
) -> None:
    files = {
        "package.xml": "<package><name>arm</name></package>",
        "launch/show.launch": f"<launch>{launch}</launch>",
        "urdf/old.urdf": f'<robot name="r">{make_mesh_link("a", "package://gone/a.stl")}</robot>',
    }
    for name, text in files.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text, encoding="utf-8")
    (finding,) = check(tmp_path / "urdf" / "old.urdf", codes={"PKG001"}, root=tmp_path).findings
    assert finding.severity == severity


@pytest.mark.parametrize("used", [True, False])
def test_a_folder_of_rosbuild_keeps_the_name_that_its_files_use(tmp_path: Path, used: bool) -> None:
    folder = tmp_path / "cart_new"
    (folder / "urdf").mkdir(parents=True)
    (folder / "manifest.xml").write_text("<package><author>me</author></package>", encoding="utf-8")
    head = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">'
    (folder / "urdf" / "wheel.xacro").write_text(f"{head}</robot>", encoding="utf-8")
    name = "cart_new" if used else "cart"
    other = f'{head}<xacro:include filename="$(find {name})/urdf/wheel.xacro"/></robot>'
    (folder / "urdf" / "other.xacro").write_text(other, encoding="utf-8")
    text = f'{head}<xacro:include filename="$(find cart)/urdf/wheel.xacro"/><link name="a"/></robot>'
    (folder / "urdf" / "r.urdf.xacro").write_text(text, encoding="utf-8")
    (finding,) = check(folder / "urdf" / "r.urdf.xacro", codes={"PKG001"}, root=folder).findings
    assert finding.fix is not None
    assert finding.fix.title.startswith(
        "write cart_new instead of cart" if used else "rename the folder cart_new to cart"
    )


@pytest.mark.parametrize(("place", "is_read"), [("maps/room", False), ("maps/room.yaml", True)])
def test_a_folder_that_only_a_program_writes_to_is_not_one_where_files_are_looked_up(
    tmp_path: Path, place: str, is_read: bool
) -> None:
    files = {"package.xml": manifest(AMENT), "CMakeLists.txt": "ament_package()", "maps/room.yaml": ""}
    saver = f"Node(arguments=['-f', os.path.join(get_package_share_directory('p'), '{place}')])"
    write(tmp_path, {**files, "launch/save.launch.py": saver})
    (finding,) = findings(tmp_path, "PKG008")
    assert ("looked up" in finding.message) == is_read
    assert place in finding.message


@pytest.mark.parametrize(("beside", "near"), [(".dae", "visual/{}.dae"), (None, "collision/{}.stl")])
def test_the_same_name_in_another_format_comes_before_the_coarse_mesh(
    tmp_path: Path, beside: str | None, near: str
) -> None:
    names = ("palm", "thumb", "finger")
    here = [f"meshes/visual/{name}{beside}" for name in names if beside]
    model = package(tmp_path, "meshes/visual/other.dae", *here, *(f"meshes/collision/{name}.stl" for name in names))
    links = [make_mesh_link(name, f"package://p/meshes/visual/{name}.stl") for name in names]
    found = audit(model, *links, codes={"PKG002"}).findings
    assert [f.data["near"][0].endswith(near.format(name)) for f, name in zip(found, names, strict=True)] == [True] * 3


@pytest.mark.parametrize(
    ("content", "severity"),
    [
        ("<buildtool_depend>catkin</buildtool_depend>", Severity.INFO),
        (AMENT, Severity.WARNING),
        (
            "<buildtool_depend>catkin</buildtool_depend><buildtool_depend>ament_cmake</buildtool_depend>",
            Severity.WARNING,
        ),
    ],
)
def test_the_libcurl_of_ros1_takes_a_blank(tmp_path: Path, content: str, severity: Severity) -> None:
    model = package(tmp_path, "meshes/a b.stl")
    (tmp_path / "p/package.xml").write_text(manifest(content), encoding="utf-8")
    (finding,) = audit(model, make_mesh_link("a", "package://p/meshes/a b.stl"), codes={"PKG011"}).findings
    assert finding.severity == severity
    assert finding.consequences["rviz"].startswith("loads" if severity == Severity.INFO else "drops")


HEAD = '<robot{} xmlns:xacro="http://www.ros.org/wiki/xacro">'


@pytest.mark.parametrize(
    ("included", "severity"),
    [("src/urdf/model/leg.xacro", Severity.INFO), ("urdf/model/foot.xacro", Severity.ERROR)],
)
def test_a_project_that_is_a_folder_of_its_package(tmp_path: Path, included: str, severity: Severity) -> None:
    leg = HEAD.format("") + make_mesh_link("a", "package://p/src/urdf/meshes/a.stl") + "</robot>"
    write(
        tmp_path,
        {
            ".git/HEAD": "",
            "model/leg.xacro": leg,
            "meshes/a.stl": "",
            "r.urdf": '<robot name="r">' + make_mesh_link("a", "package://p/src/urdf/meshes/a.stl") + "</robot>",
            "r.urdf.xacro": HEAD.format(' name="r"') + f'<xacro:include filename="$(find p)/{included}"/></robot>',
        },
    )
    for model in ("r.urdf.xacro", "r.urdf"):
        finding = only(check(tmp_path / model, codes={"PKG001"}))
        assert finding.severity == severity
        assert ("the folder src/urdf of that package" in finding.message) == (severity == Severity.INFO)


@pytest.mark.parametrize(("name", "severity"), [("arm", Severity.INFO), ("sub/arm", Severity.ERROR)])
def test_anyone_may_check_out_a_rosbuild_package_under_another_name(
    tmp_path: Path, name: str, severity: Severity
) -> None:
    write(
        tmp_path,
        {
            ".git/HEAD": "",
            f"{name}/.git/HEAD" if name == "arm" else "x": "",
            f"{name}/manifest.xml": "<package><author>me</author></package>",
            f"{name}/urdf/hand.xacro": HEAD.format("") + '<link name="b"/></robot>',
            f"{name}/urdf/r.urdf.xacro": HEAD.format(' name="r"')
            + '<xacro:include filename="$(find old_arm)/urdf/hand.xacro"/></robot>',
        },
    )
    finding = only(check(tmp_path / name / "urdf/r.urdf.xacro", codes={"PKG001"}))
    assert finding.severity == severity
    assert finding.blocks_check


@pytest.mark.parametrize(("script", "severity"), [("links.xacro", Severity.INFO), ("other.xacro", Severity.ERROR)])
def test_a_part_that_a_script_puts_into_another_package(tmp_path: Path, script: str, severity: Severity) -> None:
    write(
        tmp_path,
        {
            ".git/HEAD": "",
            "urdf/links.xacro": HEAD.format("") + make_mesh_link("a", "package://p/meshes/a.stl") + "</robot>",
            "util/deploy.py": f"shutil.copy('urdf/{script}', target)",
        },
    )
    assert only(check(tmp_path / "urdf/links.xacro", codes={"PKG001"})).severity == severity


def test_joints_alone_are_no_robot(tmp_path: Path) -> None:
    joint = '<joint name="j" type="$(arg kind)"><parent link="a"/><child link="b"/></joint></robot>'
    write(tmp_path, {"joints.xacro": HEAD.format("") + joint, "r.xacro": HEAD.format(' name="r"') + joint})
    assert not check(tmp_path / "joints.xacro", codes={"XAC010"}).findings
    assert only(check(tmp_path / "r.xacro", codes={"XAC010"})).code == "XAC010"


@pytest.mark.parametrize(
    ("before", "condition", "base", "told"),
    [
        ("", '<xacro:if value="$(arg base)">', "", "`--arg base:=false`, which skips this include"),
        ("", '<xacro:unless value="$(arg base)">', "", "`--arg base:=true`, which skips this include"),
        ('<xacro:property name="b" value="$(arg base)"/>', '<xacro:if value="${b}">', "", "`--arg base:=false`"),
        ("", '<xacro:if value="$(arg base)">', '<xacro:include filename="base.xacro"/>', "`--arg base:=false`"),
        ("${gone}", '<xacro:if value="$(arg base)">', "", ""),
        ("", '<xacro:if value="${1 == 1}">', "", ""),
    ],
    ids=["if", "unless", "by a property", "around the include of the file", "it stops all the same", "no argument"],
)
@pytest.mark.parametrize("declared", ["", "<exec_depend>gone</exec_depend>"])
def test_an_argument_that_skips_the_include_of_a_missing_package(
    tmp_path: Path, before: str, condition: str, base: str, told: str, declared: str
) -> None:
    lacking = '<xacro:include filename="$(find gone)/a.xacro"/>'
    default = "false" if "unless" in condition else "true"
    end = f"</{condition[1:].split()[0]}>"
    arg = f'<xacro:arg name="base" default="{default}"/>'
    # What comes after the include is not read where the expansion stops.
    body = f'{arg}{before if "property" in before else ""}{condition}{base or lacking}{end}<link name="l"/>'
    body += f'<joint name="{before}"/>' if "gone" in before else ""
    files = {
        "package.xml": f"<package><name>p</name>{declared}</package>",
        "urdf/r.xacro": f'<robot name="r" {XACRO}>{body}</robot>',
        "urdf/base.xacro": f"<robot {XACRO}>{lacking}</robot>",
    }
    finding = only(check(write(tmp_path, files) / "urdf/r.xacro", codes={"PKG001"}))
    assert finding.message_id == ("expansion-declared" if declared else "expansion")
    assert finding.fix is not None
    assert told in finding.fix.title
    assert ("--arg" in finding.fix.title) == bool(told)


@pytest.mark.parametrize(
    ("script", "path", "message", "severity"),
    [
        ("t.replace('MESH_PATH_HERE', folder)", "MESH_PATH_HERE/a.stl", "folder", Severity.INFO),
        ("t.replace('MESH_PATH_HERE', folder)", "MESH_PATH_HERE", "file", Severity.INFO),
        ("print('MESH_PATH_HERE')", "MESH_PATH_HERE/a.stl", "folder", Severity.ERROR),
        ("t.replace('meshes', 'mesh')", "meshes/a.stl", "folder", Severity.ERROR),
        ("t.replace('PATHTOMESHES', 'p')", "package://PATHTOMESHES/a.stl", "files-kept", Severity.INFO),
        ("t.replace('PATH', 'p')", "package://PATHTOMESHES/a.stl", "files", Severity.ERROR),
    ],
)
def test_a_placeholder_that_a_script_fills_in_is_no_missing_file(
    tmp_path: Path, script: str, path: str, message: str, severity: Severity
) -> None:
    folder = package(tmp_path)
    write(tmp_path, {"p/scripts/fill.py": script})
    finding = only(audit(folder, make_mesh_link("a", path)))
    assert (finding.message_id, finding.severity) == (message, severity)
    assert finding.fix is not None
    assert ("the script writes" in finding.fix.title) == (severity is Severity.INFO)


def test_sed_fills_in_a_placeholder_too(tmp_path: Path) -> None:
    folder = package(tmp_path)
    write(tmp_path, {"p/gen.sh": 'sed -i "s@package://PATHTOMESHES@package://p@g" p.urdf'})
    assert only(audit(folder, make_mesh_link("a", "package://PATHTOMESHES/a.stl"))).severity is Severity.INFO


def test_a_placeholder_that_nothing_fills_in_is_to_be_replaced(tmp_path: Path) -> None:
    finding = only(audit(package(tmp_path), make_mesh_link("a", "ABSOLUTE_PATH_TO_MESHES/a.stl")))
    assert finding.severity is Severity.ERROR
    assert finding.fix is not None
    assert finding.fix.title == "write the folder of the meshes in place of ABSOLUTE_PATH_TO_MESHES"


@pytest.mark.parametrize(
    ("path", "severity"),
    [
        ("robot/arm.osg", Severity.INFO),
        ("robot/arm.stl", Severity.ERROR),
        ("package://p/robot/arm.osg", Severity.ERROR),
    ],
)
def test_uwsim_looks_for_its_formats_in_its_own_folders(tmp_path: Path, path: str, severity: Severity) -> None:
    finding = only(audit(package(tmp_path), make_mesh_link("a", path)))
    assert finding.severity is severity
    assert ("UWSim" in finding.message) == (severity is Severity.INFO)


@pytest.mark.parametrize(("count", "is_told"), [(3, True), (1, False)])
def test_most_files_of_relative_paths_that_are_in_a_folder_above_show_where_they_start(
    tmp_path: Path, count: int, *, is_told: bool
) -> None:
    folder = package(tmp_path, *(f"meshes/{number}.stl" for number in range(count)))
    finding = only(audit(folder, *(make_mesh_link(f"l{n}", f"meshes/{n}.stl") for n in range(4))))
    assert finding.fix is not None
    assert not finding.fix.edits
    assert ("write `../meshes/0.stl`, and the others likewise; add 3.stl there too" in finding.fix.title) == is_told
    assert ("3 of them are in ../meshes" in finding.message) == is_told


def test_pinocchio_finds_relative_paths_in_a_folder_of_its_package_dirs(tmp_path: Path) -> None:
    finding = only(audit(package(tmp_path, "meshes/a.stl"), make_mesh_link("a", "meshes/a.stl")))
    assert "unless package_dirs have the folder" in finding.consequences["pinocchio"]


@pytest.mark.parametrize(("names", "is_found"), [("abc", True), ("ab", False), ("abcd", False)])
def test_files_of_an_unknown_package_in_a_folder_beside_a_model_of_no_package_are_named(
    tmp_path: Path, names: str, *, is_found: bool
) -> None:
    write(tmp_path, {f"m/meshes/{name}.stl": "" for name in "abc"})
    links = (make_mesh_link(name, f"package://head/{name}.stl") for name in names)
    finding = only(audit(tmp_path / "m/r.urdf", *links))
    assert finding.fix is not None
    assert ("`meshes/a.stl`" in finding.fix.title) == is_found
    assert ("in meshes" in finding.message) == is_found


def test_one_file_beside_a_model_does_not_stand_for_two_of_its_name(tmp_path: Path) -> None:
    write(tmp_path, {f"m/meshes/{name}.stl": "" for name in "ab"})
    paths = [f"package://head/{kind}/{name}.stl" for kind in ("visual", "collision") for name in "ab"]
    finding = only(audit(tmp_path / "m/r.urdf", *(make_mesh_link(f"l{i}", path) for i, path in enumerate(paths))))
    assert finding.fix is not None
    assert "meshes" not in finding.fix.title
