"""Packages are found without ROS, in a fixed order, and the paths of models are resolved as their loaders do."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from urdfcheck.source.package import package_folders
from urdfcheck.source.package.finder import PackageFinder, format_path, load_package
from urdfcheck.source.reach import FileReach


def make(folder: Path, name: str | None = None) -> Path:
    """A folder and, with a name, its package.xml."""
    folder.mkdir(parents=True, exist_ok=True)
    if name is not None:
        (folder / "package.xml").write_text(f"<package><name>{name}</name></package>")
    return folder


# -- the order in which packages are looked for ------------------------------------------------------------------------


def test_the_places_come_in_a_fixed_order(tmp_path: Path) -> None:
    start = make(tmp_path / "ws/src/start", "start")
    explicit = make(tmp_path / "explicit")
    path = make(tmp_path / "path/car_dir", "car")
    around = make(tmp_path / "ws/src/car_around", "car")
    ros = make(tmp_path / "ros/car_ros", "car")
    by_folder = make(tmp_path / "ws/src/car")
    (tmp_path / "ws/.git").mkdir()
    environment = {"ROS_PACKAGE_PATH": str(tmp_path / "ros")}

    def find() -> Path | None:
        given = {"car": explicit} if explicit.exists() else {}
        return PackageFinder(start, given, [tmp_path / "path"], environment).find("car")

    for expected in (explicit, path, around, ros, by_folder):
        assert find() == expected
        (expected / "package.xml").unlink(missing_ok=True)
        expected.rmdir()
    assert find() is None


def test_finders_of_one_state_of_the_disk_search_once(tmp_path: Path) -> None:
    start = make(tmp_path / "ws/src/start", "start")
    (tmp_path / "ws/.git").mkdir()
    reach, other = FileReach((str(tmp_path),)), FileReach((str(start),))

    def find(state: str, reach: FileReach = reach) -> Path | None:
        finder = PackageFinder(start, {}, [], {}, reach=reach, disk_state=state)
        assert finder.list_workspace_packages().get("arm") == finder.find("arm")
        return finder.find("arm")

    assert [find("1"), find(""), find("2")] == [None, None, None]
    arm = make(tmp_path / "ws/src/arm_folder", "arm")
    assert find("2") is None  # of the state before
    assert [find(""), find("2", other), find("3"), find("3")] == [arm, arm, arm, arm]
    find("4")
    assert find("2") == arm  # the last two states are kept


def test_of_two_packages_of_one_name_the_one_around_the_start_comes_first(tmp_path: Path) -> None:
    outer = make(tmp_path / "outer", "car")
    inner = make(outer / "car", "car")
    make(inner / "urdf")
    path = make(tmp_path / "path/car", "car")
    assert PackageFinder(inner / "urdf", environment={}).find("car") == inner
    assert PackageFinder(inner / "urdf", {}, [outer, path], environment={}).find("car") == inner
    assert PackageFinder(outer, {}, [path], environment={}).find("car") == outer
    assert PackageFinder(inner / "urdf", {"car": path}, environment={}).find("car") == path


def test_of_the_known_packages_of_a_run_the_nearest_is_taken(tmp_path: Path) -> None:
    far, near = make(tmp_path / "a/b/c/d/car", "car"), make(tmp_path / "x/y/z/1/2/3/4/5/car", "car")
    start = make(tmp_path / "x/y/z/9/8/7/6/5/4/3/2")
    known = {"car": [far, near]}
    assert PackageFinder(start, environment={}, known=known).find("car") == near
    assert PackageFinder(tmp_path / "a/b/c/d/1/2/3/4/5/6/7", environment={}, known=known).find("car") == far


def test_the_name_in_the_manifest_counts_before_the_name_of_a_folder(tmp_path: Path) -> None:
    make(tmp_path / "car", "robot")
    named = make(tmp_path / "zz", "car")
    assert PackageFinder(tmp_path / "car", environment={}).find("car") == named
    assert PackageFinder(Path("/"), paths=[tmp_path], environment={}).find("car") == named
    assert PackageFinder(Path("/"), paths=[tmp_path], environment={}).find("robot") == tmp_path / "car"


def test_a_package_path_may_be_a_package_a_folder_of_them_or_a_workspace(tmp_path: Path) -> None:
    package = make(tmp_path / "ws/src/repository/car", "car")
    for path in (package, *list(package.parents)[:3]):
        assert PackageFinder(Path("/"), paths=[path], environment={}).find("car") == package
    make(tmp_path / "ws/build/a/car", "car")  # what was built is a copy
    assert PackageFinder(Path("/"), paths=[tmp_path / "ws"], environment={}).find("car") == package


def test_a_package_path_without_manifests_serves_folders_by_name(tmp_path: Path) -> None:
    make(tmp_path / "meshes_of_car")
    finder = PackageFinder(Path("/"), paths=[tmp_path], environment={})
    assert finder.find("meshes_of_car") == tmp_path / "meshes_of_car"


def test_relative_paths_are_made_absolute(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    make(tmp_path / "ws/car", "car")
    monkeypatch.chdir(tmp_path)
    assert PackageFinder(Path("/"), paths=[Path("ws")], environment={}).find("car") == tmp_path / "ws/car"
    assert PackageFinder(Path("/"), {"car": Path("ws/car")}, environment={}).find("car") == tmp_path / "ws/car"


def test_around_a_file_its_own_package_its_neighbours_and_other_repositories_are_found(tmp_path: Path) -> None:
    own = make(tmp_path / "src/repository/car_description", "car_description")
    make(own / "urdf")
    neighbour = make(tmp_path / "src/repository/car_meshes", "car_meshes")
    other = make(tmp_path / "src/sensors/lidar", "lidar")
    finder = PackageFinder(own / "urdf/car.urdf", environment={})
    assert [finder.find(n) for n in ("car_description", "car_meshes", "lidar")] == [own, neighbour, other]


def test_the_search_around_a_file_ends_at_its_repository_and_at_home(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    make(tmp_path / "outside", "outside")
    start = make(tmp_path / "repository/urdf")
    assert PackageFinder(start, environment={}).find("outside") is not None
    (tmp_path / "repository/.git").mkdir()
    assert PackageFinder(start, environment={}).find("outside") is None
    (tmp_path / "repository/.git").rmdir()
    monkeypatch.setenv("HOME", str(tmp_path))
    assert PackageFinder(start, environment={}).find("outside") is None


@pytest.mark.parametrize("value", ["{0}/src", "/nowhere:{0}/src", ":{0}/src:"])
def test_ros_package_path_is_searched_below(tmp_path: Path, value: str) -> None:
    package = make(tmp_path / "src/repository/folder", "car")
    finder = PackageFinder(Path("/"), environment={"ROS_PACKAGE_PATH": value.format(tmp_path)})
    assert finder.find("car") == package


def test_ament_prefix_path_has_a_share_folder_per_package(tmp_path: Path) -> None:
    package = make(tmp_path / "install/share/car")
    finder = PackageFinder(Path("/"), environment={"AMENT_PREFIX_PATH": f"/nowhere:{tmp_path}/install"})
    assert finder.find("car") == package


@pytest.mark.parametrize("name", ["", ".", "..", "a/b", "a\\b", "no"])
def test_what_is_no_name_of_a_package_is_not_found(tmp_path: Path, name: str) -> None:
    make(tmp_path / "a/b", "b")
    assert PackageFinder(tmp_path / "a", environment={}).find(name) is None


def test_a_link_in_a_circle_and_an_unreadable_manifest_hide_no_package(tmp_path: Path) -> None:
    package = make(tmp_path / "folder", "car")
    os.symlink("circle", tmp_path / "circle")
    make(tmp_path / "broken/package.xml")
    (make(tmp_path / "binary") / "package.xml").write_bytes(b"\xff\xfe\0<name>")
    assert PackageFinder(tmp_path, environment={}).find("car") == package


# -- what is said about a package that is not found --------------------------------------------------------------------


def test_names_that_are_nearly_the_same_are_offered(tmp_path: Path) -> None:
    for name in ("my_car", "boat_description", "ur_description"):
        make(tmp_path / name, name)
    finder = PackageFinder(tmp_path, environment={})
    assert finder.suggest_names("my-car") == finder.suggest_names("MY_CAR") == ["my_car"]
    assert finder.suggest_names("bot_description") == ["boat_description"]
    assert finder.suggest_names("xyz_description") == []  # the common suffix alone makes no likeness


def test_every_place_is_listed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    make(tmp_path / "ws/src")
    (tmp_path / "ws/.git").mkdir()
    finder = PackageFinder(
        tmp_path / "ws/src", {"a": tmp_path / "a"}, [tmp_path / "p"], {"ROS_PACKAGE_PATH": "/opt/ros"}
    )
    assert finder.describe_search_places() == [
        "--package a=a",
        "p",
        "package.xml from ws/src up to ws",
        "ROS_PACKAGE_PATH=/opt/ros",
        "AMENT_PREFIX_PATH (not set)",
    ]


# -- packages ----------------------------------------------------------------------------------------------------------


def test_a_file_belongs_to_the_nearest_package_above_it(tmp_path: Path) -> None:
    make(tmp_path / "outer", "outer")
    make(tmp_path / "outer/inner/urdf")
    make(tmp_path / "outer/inner", "inner")
    package = PackageFinder(tmp_path, environment={}).find_package_of(tmp_path / "outer/inner/urdf/a.urdf")
    assert package is not None
    assert (package.name, package.path) == ("inner", tmp_path / "outer/inner")
    assert PackageFinder(tmp_path, environment={}).find_package_of(tmp_path / "a.urdf") is None


def test_a_manifest_names_the_package_and_what_it_depends_on(tmp_path: Path) -> None:
    (tmp_path / "package.xml").write_text(
        "<package><name> car </name><depend>xacro</depend><exec_depend> rviz </exec_depend>"
        "<build_depend>x</build_depend><author>me</author></package>"
    )
    package = load_package(tmp_path)
    assert package is not None
    assert package.name == "car"
    assert package.dependencies == {"xacro", "rviz", "x"}


@pytest.mark.parametrize(
    ("content", "kind"),
    [
        (b"<package>", "malformed"),
        (b"\xff", "encoding"),
        (b"", "malformed"),
        (b"<!DOCTYPE a []><package/>", "doctype"),
    ],
)
def test_a_broken_manifest_still_makes_a_package(tmp_path: Path, content: bytes, kind: str) -> None:
    (tmp_path / "package.xml").write_bytes(content)
    package = load_package(tmp_path)
    assert package is not None
    assert (package.name, package.root, package.dependencies) == (tmp_path.name, None, frozenset())
    assert [p.kind for p in package.problems] == [kind]


def test_a_folder_without_manifest_is_no_package(tmp_path: Path) -> None:
    assert load_package(tmp_path) is None


# -- paths in models ---------------------------------------------------------------------------------------------------


@pytest.fixture
def car(tmp_path: Path) -> Path:
    package = make(tmp_path / "car", "car")
    for name in ("meshes/wheel.stl", "meshes/a b.stl", "urdf/car.urdf"):
        (package / name).parent.mkdir(exist_ok=True)
        (package / name).write_text("")
    return package


@pytest.mark.parametrize(
    ("text", "kind", "target"),
    [
        ("package://car/meshes/wheel.stl", "package", "meshes/wheel.stl"),
        ("package://car//meshes/wheel.stl", "package", "meshes/wheel.stl"),
        ("model://car/meshes/wheel.stl", "package", "meshes/wheel.stl"),
        ("package://car/meshes/a%20b.stl", "package", "meshes/a b.stl"),
        ("../meshes/wheel.stl", "relative", "urdf/../meshes/wheel.stl"),
        ("file://{car}/meshes/wheel.stl", "file", "meshes/wheel.stl"),
        ("{car}/meshes/wheel.stl", "absolute", "meshes/wheel.stl"),
    ],
)
def test_a_path_that_exists_is_resolved(car: Path, text: str, kind: str, target: str) -> None:
    resource = PackageFinder(car, environment={}).resolve_resource(text.format(car=car), car / "urdf")
    assert (resource.kind, resource.path, resource.exists) == (kind, car / target, True)
    assert resource.package == ("car" if kind == "package" else None)


def test_a_path_in_the_home_folder_is_told_apart(car: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    resource = PackageFinder(car, environment={}).resolve_resource("~/car/meshes/wheel.stl", car)
    assert (resource.kind, resource.exists) == ("home", True)


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ("package://no/meshes/wheel.stl", "package"),
        ("package://car/meshes/no.stl", "package"),
        ("package://car", "package"),
        ("package://", "package"),
        ("http://example.org/wheel.stl", "other"),
        ("C:\\meshes\\wheel.stl", "absolute"),
        ("~no_such_user/wheel.stl", "home"),
        ("meshes", "relative"),
        ("", "relative"),
        ("a\0b", "relative"),
        ("\ud800", "relative"),
        ("x" * 5000, "relative"),
        ("package://car/%00", "package"),
    ],
)
def test_a_path_that_leads_nowhere_does_not_exist_and_raises_nothing(car: Path, text: str, kind: str) -> None:
    resource = PackageFinder(car, environment={}).resolve_resource(text, car)
    assert (resource.kind, resource.exists, resource.actual_spelling) == (kind, False, None)


def test_the_spelling_on_disk_is_told_where_only_the_case_differs(car: Path) -> None:
    resource = PackageFinder(car, environment={}).resolve_resource("package://car/Meshes/Wheel.STL", car)
    if not resource.exists:  # on a file system that minds the case
        assert resource.actual_spelling == "meshes/wheel.stl"
    assert not resource.exists
    (car / "meshes/WHEEL.stl").write_text("")
    two = PackageFinder(car, environment={}).resolve_resource("package://car/meshes/Wheel.stl", car)
    assert two.actual_spelling in {None, "wheel.stl"}  # with two candidates nothing is claimed


def test_files_are_called_by_their_path_from_the_working_directory(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    make(tmp_path / "a/b")
    monkeypatch.chdir(tmp_path / "a/b")
    assert format_path(tmp_path / "a/b/c.urdf") == "c.urdf"
    assert format_path(tmp_path / "d.urdf") == "../../d.urdf"


def test_a_search_reads_each_folder_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / ".git").mkdir()
    for name in ("arm", "hand"):
        (tmp_path / "src" / name / "urdf").mkdir(parents=True)
        (tmp_path / "src" / name / "package.xml").write_text(f"<package><name>{name}</name></package>")
    listed: list[str] = []
    list_folder = package_folders._list_folder
    monkeypatch.setattr(package_folders, "_list_folder", lambda path: listed.append(str(path)) or list_folder(path))
    assert PackageFinder(tmp_path / "src" / "arm" / "urdf").find("hand") == tmp_path / "src" / "hand"
    below = [path for path in listed if path.startswith(str(tmp_path / "src"))]
    assert len(below) == len(set(below)) > 2


@pytest.mark.parametrize(
    ("text", "rest"),
    [
        ("a <!-- b\n# c --> d", "a  d"),
        ("a\n  # b\nc # d", "a\n\nc # d"),
        ("a <!-- b", "a "),
        ("# <!-- a\nb", "\nb"),
    ],
    ids=["xml", "line", "unclosed", "a line that mentions the other kind"],
)
def test_comments_are_left_out_of_the_texts_of_a_package(text: str, rest: str) -> None:
    assert package_folders.drop_comments(text) == rest
