"""Which files may be opened: those that belong to the given paths, wherever links and dots lead."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

import pytest
from conftest import check, check_text

from urdfcheck.source.package.finder import PackageFinder
from urdfcheck.source.project_folders import find_project_folder, list_project_folders
from urdfcheck.source.reach import FileReach

BOX = '<robot name="r"><link name="l"><visual><geometry><mesh filename="{}"/></geometry></visual></link></robot>'


def codes(path: Path, **request: object) -> list[str]:
    return [f.code for f in check(path, codes={"PKG002", "PKG004", "PKG012", "MSH001", "XML001"}, **request).findings]


def package(folder: Path, name: str) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "package.xml").write_text(f"<package format='2'><name>{name}</name></package>")
    return folder


def test_a_shared_folder_is_no_workspace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Neither is a package of somebody else in a folder for temporary files found, nor may a worker read that folder."""
    shared = tmp_path / "shared"
    package(shared / "other", "other")
    (shared / "robot").mkdir()
    start = shared / "robot" / "r.urdf"
    assert PackageFinder(start).find("other") == shared / "other"
    monkeypatch.setenv("TMPDIR", str(shared))
    # A worker cannot try where it may write.
    monkeypatch.setattr(tempfile, "tempdir", None)
    monkeypatch.setattr(tempfile, "_get_default_tempdir", lambda: pytest.fail("it writes"))
    finder = PackageFinder(start)
    assert finder.list_parent_folders()[-1] == shared / "robot"
    assert finder.find("other") is None
    assert PackageFinder(shared / "r.urdf").list_parent_folders() == []


def test_each_file_of_a_folder_counts_by_where_it_leads(tmp_path: Path) -> None:
    robot = package(tmp_path / "robot", "robot")
    secret = tmp_path / "secret"
    secret.write_text("")
    (robot / "plain").write_text("")
    (robot / "inner").symlink_to("plain")
    (robot / "outer").symlink_to("../secret")
    (robot / "away").symlink_to(tmp_path)
    finder = PackageFinder(robot / "r.urdf", reach=FileReach((os.path.realpath(robot),)))
    names = ("plain", "inner", "missing", "outer", "away/secret", "../secret", "..", "a\0b", ".hidden", "plain/..")
    assert [name for name in names if finder.can_open(robot / name)] == ["plain", "inner", "missing", "plain/.."]


class TestHome:
    def test_is_the_repository_around_a_path(self, tmp_path: Path) -> None:
        (tmp_path / ".git").mkdir()
        robot = package(tmp_path / "src" / "car", "car") / "urdf" / "car.urdf"
        assert find_project_folder(robot) == tmp_path

    def test_is_the_package_where_there_is_no_repository(self, tmp_path: Path) -> None:
        assert find_project_folder(package(tmp_path / "car", "car") / "urdf" / "car.urdf") == tmp_path / "car"

    @pytest.mark.parametrize("name", ["robot", "urdf", "config", "launch"])
    def test_is_the_folder_itself_otherwise_whatever_its_name(self, tmp_path: Path, name: str) -> None:
        folder = tmp_path / "downloads" / name
        folder.mkdir(parents=True)
        (tmp_path / "downloads" / "creds").mkdir()
        for path in (folder, folder / "car.urdf"):
            assert find_project_folder(path) == folder
            assert list_project_folders(path) == [folder]

    def test_brings_the_other_parts_of_a_robot_one_by_one(self, tmp_path: Path) -> None:
        for name in ("urdf", "meshes", "basic_urdf", "mjcf", "config", ".hidden"):
            (tmp_path / "robot" / name).mkdir(parents=True)
        (tmp_path / "robot" / "readme.md").write_text("")
        (tmp_path / "textures").mkdir()
        (tmp_path / "robot" / "textures").symlink_to(tmp_path / "textures")
        beside = [tmp_path / "robot" / name for name in ("urdf", "basic_urdf", "config", "meshes", "mjcf")]
        assert list_project_folders(tmp_path / "robot" / "urdf" / "car.urdf") == beside
        reach = FileReach.from_paths([tmp_path / "robot" / "urdf" / "car.urdf"], [])
        assert reach.can_open(tmp_path / "robot" / "meshes" / "base.stl")
        assert not reach.can_open(tmp_path / "robot" / "readme.md")
        assert not reach.can_open(tmp_path / "robot" / "textures" / "a.png")  # a link may lead anywhere

    @pytest.mark.parametrize("other", ["keys", "ssh_config", "hurdfish"])
    def test_brings_nothing_where_another_folder_is_beside_it(self, tmp_path: Path, other: str) -> None:
        for name in ("urdf", "meshes", other):
            (tmp_path / "robot" / name).mkdir(parents=True)
        assert list_project_folders(tmp_path / "robot" / "urdf") == [tmp_path / "robot" / "urdf"]

    @pytest.mark.skipif(os.name != "posix", reason="rights of a folder")
    def test_brings_nothing_from_a_folder_that_others_may_write_to(self, tmp_path: Path) -> None:
        for name in ("urdf", "meshes"):
            (tmp_path / "shared" / name).mkdir(parents=True)
        (tmp_path / "shared").chmod(0o777)
        assert list_project_folders(tmp_path / "shared" / "urdf") == [tmp_path / "shared" / "urdf"]

    def test_of_a_file_in_the_root_or_the_home_folder_is_the_file(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setenv("HOME", str(tmp_path))
        (tmp_path / "urdf").mkdir()
        root = Path(tmp_path.anchor)
        assert FileReach.from_paths([root / "car.urdf", tmp_path / "car.urdf", root, tmp_path], []).roots == (
            str(root / "car.urdf"),
            str(tmp_path / "car.urdf"),
        )
        # A folder of that name in the home folder (or in the root, as `docker run -v $PWD:/urdf` has it) brings nothing else.
        assert FileReach.from_paths([tmp_path / "urdf"], []).roots == (str(tmp_path / "urdf"),)
        assert FileReach.from_paths([root / "urdf" / "car.urdf"], []).roots == (str(root / "urdf"),)
        assert FileReach.from_paths([], [tmp_path]).can_open(tmp_path / "car.urdf")  # --allow-read

    def test_the_home_folder_is_not_checked_as_a_whole(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setenv("HOME", str(tmp_path))
        (tmp_path / "car.urdf").write_text('<robot name="car"><link name="l"/></robot>')
        run = check(tmp_path)
        assert (run.models, len(run.failures)) == ((), 1)
        assert "--allow-read" in run.failures[0]
        assert [m.robot for m in check(tmp_path / "car.urdf").models] == ["car"]
        assert [m.robot for m in check(tmp_path, allowed=(tmp_path,)).models] == ["car"]

    def test_of_a_link_is_where_it_lies(self, tmp_path: Path) -> None:
        for name in ("in", "out"):
            (tmp_path / name).mkdir()
        (tmp_path / "out" / "secret.urdf").write_text('<robot name="password"><link name="l"/></robot>')
        (tmp_path / "in" / "model.urdf").symlink_to(tmp_path / "out" / "secret.urdf")
        (tmp_path / "in" / "folder").symlink_to(tmp_path / "out")
        for link in ("model.urdf", "folder"):
            assert find_project_folder(tmp_path / "in" / link) == tmp_path / "in"
            run = check(tmp_path / "in" / link)
            assert (run.models, len(run.failures)) == ((), 1)
            assert "may be read" in run.failures[0]
        assert [m.robot for m in check(tmp_path / "in" / "folder", allowed=(tmp_path / "out",)).models] == ["password"]

    def test_is_never_all_of_the_users_home(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setenv("HOME", str(tmp_path))
        (tmp_path / ".git").mkdir()  # some keep their settings in a repository
        (tmp_path / "robots").mkdir()
        (tmp_path / "downloads").mkdir()
        assert find_project_folder(tmp_path / "downloads" / "car.urdf") == tmp_path / "downloads"


class TestReach:
    def test_a_link_counts_by_where_it_leads(self, tmp_path: Path) -> None:
        inside, outside = tmp_path / "in", tmp_path / "out"
        inside.mkdir()
        outside.mkdir()
        (outside / "secret").write_text("s")
        (inside / "plain").write_text("p")
        (inside / "link").symlink_to(outside / "secret")
        (inside / "own").symlink_to(inside / "plain")
        (inside / "folder").symlink_to(outside)
        (inside / "circle").symlink_to(inside / "circle")
        reach = FileReach.from_paths([inside], [])
        allowed = {name: reach.can_open(inside / name) for name in ("plain", "own", "link", "folder/secret", "new")}
        assert allowed == {"plain": True, "own": True, "link": False, "folder/secret": False, "new": True}
        assert not reach.can_open(inside / ".." / "out" / "secret")
        assert not reach.can_open(inside / "a\0b")

    def test_nothing_hidden_is_opened(self, tmp_path: Path) -> None:
        reach = FileReach.from_paths([tmp_path], [])
        assert not reach.can_open(tmp_path / ".git" / "config")
        assert not reach.can_open(tmp_path / "a" / ".env")

    def test_but_what_the_user_names_may_itself_be_hidden(self, tmp_path: Path) -> None:
        hidden = tmp_path / ".gazebo" / "models"
        hidden.mkdir(parents=True)
        assert FileReach.from_paths([hidden / "car.urdf"], []).can_open(hidden / "mesh.stl")

    def test_a_folder_is_no_prefix(self, tmp_path: Path) -> None:
        (tmp_path / "car").mkdir()
        assert not FileReach.from_paths([], [tmp_path / "car"]).can_open(tmp_path / "car-secret" / "x")

    def test_found_packages_are_in_reach_unless_a_link_places_them_elsewhere(self, tmp_path: Path) -> None:
        workspace = tmp_path / "ws"
        car = package(workspace / "car", "car")
        package(workspace / "wheels", "wheels")
        (workspace / "planted").symlink_to("/etc")
        finder = PackageFinder(car, reach=FileReach.from_paths([car], []))
        assert not finder.can_open(workspace / "wheels" / "a.stl")  # nobody has asked for it
        assert finder.find("wheels") == workspace / "wheels"
        assert finder.can_open(workspace / "wheels" / "a.stl")
        assert finder.find("planted") is None  # whether or not something is there
        assert not finder.can_open(workspace / "planted" / "passwd")


class TestModels:
    @pytest.mark.parametrize("path", ["../../out/a.stl", "package://car/../../out/a.stl", "link.stl", ".hidden/a.stl"])
    def test_a_mesh_out_of_reach_is_not_opened_and_said_once(self, tmp_path: Path, path: str) -> None:
        (tmp_path / "out").mkdir()
        (tmp_path / "out" / "a.stl").write_text("this would be unreadable")
        car = package(tmp_path / "ws" / "car", "car")
        (car / ".hidden").mkdir()
        (car / ".hidden" / "a.stl").write_text("unreadable as well")
        (car / "link.stl").symlink_to(tmp_path / "out" / "a.stl")
        (car / "car.urdf").write_text(BOX.format(path))
        assert codes(car / "car.urdf") == ["PKG012"]

    def test_a_neighbour_of_a_folder_called_urdf_is_not_read(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        for name in ("urdf", "other"):
            (tmp_path / name).mkdir()
        (tmp_path / "other" / "creds.yaml").write_text("token: hidden")
        text = """<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">
            <xacro:property name="y" value="${xacro.load_yaml('../other/creds.yaml')}"/><link name="${y['token']}"/></robot>"""
        monkeypatch.chdir(tmp_path / "urdf")
        (tmp_path / "urdf" / "r.urdf.xacro").write_text(text)
        (found,) = [f for f in check(Path("r.urdf.xacro")).findings if f.code == "PKG012"]
        assert found.fix is not None
        assert found.fix.title.endswith("--allow-read ../other")

    @pytest.mark.parametrize(
        ("place", "repair"),
        [
            ("/srv/nowhere/", "where the file is named, write its place in a package"),
            ("/home/nobody-here/", "write the place of the model in a package, `$(find PACKAGE)/…`; "),
        ],
    )
    def test_model_that_a_launch_file_names_by_the_place_of_one_machine(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, place: str, repair: str
    ) -> None:
        car = package(tmp_path / "car", "car")
        monkeypatch.chdir(car)
        (car / "old").mkdir()
        (car / "old" / "car.urdf.xacro").touch()
        command = f"xacro {place}car/car.urdf.xacro"
        (car / "car.launch").write_text(f'<launch><param name="robot_description" command="{command}"/></launch>')
        (found,) = check(Path("car.launch"), codes={"XML001"}).findings
        assert found.fix is not None
        assert found.fix.title.startswith(repair)
        assert ("old/car.urdf.xacro may be meant" in found.fix.title) == place.startswith("/home")
        assert found.location.span is not None
        assert found.location.span.file == "car.launch"

    def test_the_folder_can_be_allowed(self, tmp_path: Path) -> None:
        (tmp_path / "out").mkdir()
        (tmp_path / "out" / "a.stl").write_text("unreadable")
        car = package(tmp_path / "car", "car")
        (car / "car.urdf").write_text(BOX.format("../out/a.stl"))
        assert codes(car / "car.urdf") == ["PKG012"]
        assert codes(car / "car.urdf", allowed=(tmp_path / "out",)) == ["MSH001"]

    def test_whether_a_file_out_of_reach_exists_is_not_told(self, tmp_path: Path) -> None:
        there, missing = (check_text(tmp_path / "r", BOX.format(p)) for p in (Path(__file__), "/nowhere/test_reach.py"))
        told = [[(f.code, f.message_id) for f in run.findings if f.code.startswith("PKG")] for run in (there, missing)]
        assert told[0] == told[1] == [("PKG004", "unread")]

    def test_a_folder_is_not_followed_out_of_reach(self, tmp_path: Path) -> None:
        given, other = tmp_path / "given", tmp_path / "other"
        given.mkdir()
        other.mkdir()
        (other / "secret.urdf").write_text('<robot name="secret"/>')
        (given / "folder").symlink_to(other)
        (given / "file.urdf").symlink_to(other / "secret.urdf")
        (given / "own.urdf").write_text('<robot name="own"><link name="l"/></robot>')
        run = check(given)
        assert [m.robot for m in run.models] == ["own"]
        assert {os.path.basename(s.model) for s in run.skipped if "may be read" in s.reason} == {"folder", "file.urdf"}

    def test_a_launch_file_leads_to_the_model_of_another_package(self, tmp_path: Path) -> None:
        start = package(tmp_path / "ws" / "start", "start")
        arm = package(tmp_path / "ws" / "arm", "arm")
        (arm / "arm.urdf").write_text(BOX.format("package://arm/part.stl"))
        (arm / "part.stl").write_text("unreadable")
        (start / "a.launch").write_text(
            '<launch><param name="robot_description" textfile="$(find arm)/arm.urdf"/></launch>'
        )
        run = check(start / "a.launch", codes={"XML001", "PKG012", "MSH001"})
        assert [(f.code, m.robot) for m in run.models for f in run.findings] == [("MSH001", "r")]

    def test_a_launch_file_leads_to_no_model_out_of_reach(self, tmp_path: Path) -> None:
        car = package(tmp_path / "car", "car")
        (tmp_path / "secret.urdf").write_text('<robot name="secret"><link name="password"/></robot>')
        (car / "a.launch").write_text(
            f'<launch><param name="robot_description" textfile="{tmp_path / "secret.urdf"}"/></launch>'
        )
        run = check(car / "a.launch")
        assert not any("password" in text or m.robot for m in run.models for text in run.sources.values())

    def test_a_launch_file_includes_nothing_out_of_reach(self, tmp_path: Path) -> None:
        car = package(tmp_path / "car", "car")
        (tmp_path / "secret.launch").write_text('<launch><param name="robot_description" textfile="x.urdf"/></launch>')
        (car / "a.launch").write_text(f'<launch>\n<include file="{tmp_path / "secret.launch"}"/></launch>')
        run = check(car / "a.launch")
        found = [f for f in run.findings if f.code == "PKG012"]
        assert [(f.message_id, f.location.span.line) for f in found if f.location.span] == [("launch", 2)]
        assert not any("x.urdf" in text for text in run.sources.values())


class TestConfiguration:
    def test_of_a_stranger_cannot_widen_the_reach(self, tmp_path: Path) -> None:
        from urdfcheck.core import UrdfcheckError
        from urdfcheck.policy import config_resolver

        (tmp_path / "repository" / ".git").mkdir(parents=True)
        (tmp_path / "elsewhere").mkdir()
        toml = tmp_path / "repository" / "urdfcheck.toml"
        toml.write_text('package-path = ["../elsewhere"]')
        with pytest.raises(UrdfcheckError, match="name it on the command line"):
            config_resolver.find_config(tmp_path / "repository")
