"""From the paths of the command line to the models, launch files and packages that are to be checked."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Mapping
from pathlib import Path

import pytest

from urdfcheck.source.discover import discover_targets
from urdfcheck.source.model_file import ModelFile, names_file
from urdfcheck.source.package.file_kinds import is_launch
from urdfcheck.source.package.finder import PackageFinder
from urdfcheck.source.plan import ModelTarget, Plan
from urdfcheck.source.planning_budget import PlanningBudget
from urdfcheck.source.reach import FileReach
from urdfcheck.source.text.xml import parse_xml

pytestmark = pytest.mark.slow

URDF = '<robot name="r"><link name="base"/></robot>'
XMLNS = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'


def xacro(body: str, name: str = ' name="r"') -> str:
    return f"<robot{name} {XMLNS}>{body}</robot>"


LINK = '<link name="base"/>'
MACRO = '<xacro:macro name="wheel"><link name="w"/></xacro:macro>'


def include(path: str) -> str:
    return f'<xacro:include filename="{path}"/>'


@pytest.fixture
def workspace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def write(workspace: Path, files: Mapping[str, str | bytes]) -> None:
    for name, content in files.items():
        path = workspace / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content if isinstance(content, bytes) else content.encode())


def planned(*paths: str, arguments: Mapping[str, str] | None = None) -> Plan:
    return discover_targets([Path(p) for p in paths], arguments or {}, packages={}, package_paths=[])


def models(*paths: str) -> list[str]:
    return [t.path.as_posix() for t in planned(*paths).models]


def candidates(*paths: str) -> list[tuple[str, bool]]:
    """The files whose expansion decides what they are, and whether they are only expanded if no model is made of them."""
    return [(t.path.as_posix(), t.is_spare) for t in planned(*paths).candidates]


def manifest(name: str) -> str:
    return f"<package><name>{name}</name></package>"


# -- folders -----------------------------------------------------------------------------------------------------------


def test_in_a_folder_every_model_is_found_in_a_stable_order(workspace: Path) -> None:
    write(workspace, {"b/urdf/b.urdf": URDF, "a.urdf.xacro": xacro(LINK), "c.xacro": xacro(LINK), "notes.xml": URDF})
    assert models(".") == ["a.urdf.xacro", "b/urdf/b.urdf", "c.xacro"]


@pytest.mark.parametrize("folder", ["build", "install", "log", "a/build/x", ".hidden", "node_modules/x", "__pycache__"])
def test_what_was_built_is_no_source(workspace: Path, folder: str) -> None:
    write(workspace, {f"{folder}/a.urdf": URDF, "kept.urdf": URDF})
    assert models(".") == ["kept.urdf"]


@pytest.mark.parametrize("mark", ["COLCON_IGNORE", "AMENT_IGNORE", "CATKIN_IGNORE"])
def test_a_folder_marked_to_be_ignored_is_skipped_with_all_below_it(workspace: Path, mark: str) -> None:
    write(workspace, {f"old/{mark}": "", "old/a.urdf": URDF, "old/deep/b.urdf": URDF, "new/c.urdf": URDF})
    assert models(".") == ["new/c.urdf"]
    assert models("old") == ["old/a.urdf", "old/deep/b.urdf"]  # it is named


def test_packages_that_are_left_out_are_listed(workspace: Path) -> None:
    manifest = "<package format='2'><name>{}</name></package>"
    write(workspace, {"old/COLCON_IGNORE": "", "old/p/package.xml": manifest.format("p"), "old/p/urdf/a.urdf": URDF})
    write(workspace, {"old/q/package.xml": manifest.format("q"), "msgs/AMENT_IGNORE": "", "r/COLCON_IGNORE": ""})
    write(workspace, {"r/b.urdf": URDF})
    left_out = planned(".").left_out
    assert [(path, reason.split(";")[0]) for path, reason in left_out] == [
        ("old/p", "left out because of its COLCON_IGNORE"),
        ("r", "left out because of its COLCON_IGNORE"),
    ]


@pytest.mark.parametrize(
    ("name", "typed"),
    [
        ("r.urdf", "{{ cookiecutter.name }}"),
        ("r.urdf.xacro", "$Robot_name$"),
        ("r.xacro", "@PROJECT_NAME@"),
        ("r.urdf", "<%= name %>"),
        ("r.urdf.xacro", "$(find <your-package>)/x"),
        ("r.urdf.xacro", "$(find [GENERATED_PACKAGE_NAME])/x"),
    ],
)
def test_a_template_is_left_out_unless_it_is_named(workspace: Path, name: str, typed: str) -> None:
    write(workspace, {name: f'<robot name="{typed}"><link name="a"/></robot>', "kept.urdf": URDF})
    assert models(".") == ["kept.urdf"]
    assert models(name) == [name]
    ((path, reason),) = planned(".").left_out
    assert path == name
    assert reason.startswith("left out as a template, in which ")


@pytest.mark.parametrize(
    "typed",
    ["${{'a': 1}['a']}", "$(arg name)$", "a@b.c", "${x}", "${sizes[LEFT_ARM]}", "[ROBOT_NAME]", "__left_arm__"],
)
def test_what_xacro_writes_is_no_placeholder(workspace: Path, typed: str) -> None:
    text = f'<!-- {{{{ name }}}} --><robot name="{typed}"><link name="a"/></robot>'
    write(workspace, {"r.urdf.xacro": text})
    assert models(".") == ["r.urdf.xacro"]


def test_a_default_that_says_not_given_is_no_placeholder(workspace: Path) -> None:
    given = '<xacro:arg name="tool" default="__not_set__"/><xacro:property name="a" value="__not_set__"/>'
    write(workspace, {"r.urdf.xacro": f'<robot name="r">{given}<link name="a"/></robot>'})
    assert models(".") == ["r.urdf.xacro"]


def test_settings_of_eclipse_are_no_launch_file_of_ros(workspace: Path) -> None:
    """Eclipse, and tools that are built on it, such as STM32CubeIDE, keep how to start a program in files of this name."""
    inner = '<stringAttribute key="a" value="0"/>'
    text = f'<?xml version="1.0"?>\n<launchConfiguration type="com.st.debug">{inner}</launchConfiguration>'
    write(workspace, {"board/car Debug.launch": text, "board/car.launch": "<launch/>"})
    assert [path.as_posix() for path in planned(".").launches] == ["board/car.launch"]
    assert (planned(".").missing, planned(".").left_out) == ((), ())
    assert [path for path, _ in planned("board/car Debug.launch").missing] == ["board/car Debug.launch"]


@pytest.mark.parametrize(
    "typed", ['value="$(find <your-package>)/b"', 'value="__robot_name__"', "[URDF_LOAD_ATTRIBUTE]"]
)
def test_a_launch_file_that_is_a_template_is_left_out(workspace: Path, typed: str) -> None:
    text = f'<launch><param name="a" {typed}/></launch>'
    write(workspace, {"a_template.launch": text, "kept.urdf": URDF})
    assert [path for path, _ in planned(".").left_out] == ["a_template.launch"]
    assert not planned(".").launches


@pytest.mark.parametrize("text", ["", "\n", f'<?xml version="1.0"?>\n<!-- {LINK} -->\n<!-- old -->'])
@pytest.mark.parametrize("name", ["urdf/wheel.xacro", "launch/a.launch", "urdf/r.urdf"])
def test_a_file_of_a_package_that_holds_nothing_and_is_named_nowhere_is_left_out(
    workspace: Path, name: str, text: str
) -> None:
    write(workspace, {"p/package.xml": manifest("p"), f"p/{name}": text, "p/urdf/kept.urdf": URDF})
    assert models(".") == ["p/urdf/kept.urdf"]
    assert [path for path, _ in planned(".").left_out] == [f"p/{name}"]
    assert not planned(".").launches
    assert not planned(f"p/{name}").left_out  # it is named
    write(workspace, {"p/launch/b.launch.py": f"FILE = '{Path(name).name}'"})
    assert not planned(".").left_out


@pytest.mark.parametrize("text", ["", "<!-- a --> -->", "<!-- a", "<robot>"])
def test_a_file_that_may_have_lost_its_content_is_a_model(workspace: Path, text: str) -> None:
    """Outside of packages models are handed to programs by hand."""
    write(workspace, {"p/package.xml": manifest("p"), "p/urdf/kept.urdf": URDF})
    write(workspace, {f"{'p/urdf/' if text else ''}r.urdf": text})
    assert len(models(".")) == 2


@pytest.mark.parametrize(
    ("files", "is_test_data"),
    [
        ({}, True),
        ({"p/test/a.test.py": "open('r.urdf')"}, True),
        ({"p/test/a.launch": '<launch><param name="d" textfile="$(find p)/test/data/r.urdf"/></launch>'}, True),
        ({"p/test/a.launch.py": "get('p') + '/test/data/r.urdf'"}, True),
        ({"p/launch/a.launch.py": "get('p') + '/test/data/r.urdf'"}, False),
        ({"p/launch/a.launch": '<launch><param name="d" textfile="$(find p)/test/data/r.urdf"/></launch>'}, False),
        ({"p/urdf/big.xacro": xacro(LINK + include("../test/data/r.urdf"))}, False),
        ({"p/test/big.xacro": xacro(LINK + include("data/r.urdf"))}, True),
        ({"p/test/package.xml": manifest("test")}, False),
        ({"p/test/package.xml": manifest("p_test")}, True),
    ],
)
def test_what_only_tests_read_is_test_data(workspace: Path, files: dict[str, str], is_test_data: bool) -> None:
    write(workspace, {"p/package.xml": manifest("p"), "p/test/data/r.urdf": URDF, "p/urdf/q.urdf": URDF, **files})
    plan = planned(".")
    found = {t.path.as_posix(): t.is_test_data for t in (*plan.models, *plan.candidates)}
    assert found["p/test/data/r.urdf"] == is_test_data
    assert not any(target.is_kept_aside for target in plan.models)
    assert not found["p/urdf/q.urdf"]
    for given in ("p/test/data", "p/test/data/r.urdf"):
        assert not any(target.is_test_data for target in planned(given).models)
    both = planned(".", "p/test/data/r.urdf").models
    assert not [target for target in both if target.is_test_data and target.path.name == "r.urdf"]


STARTED = '<launch><param name="robot_description" textfile="$(find p)/third_party/urdf/r.urdf"/></launch>'


@pytest.mark.parametrize(
    ("place", "files", "is_aside"),
    [
        ("urdf/old/r.urdf", {}, True),
        ("urdf/old/r.urdf", {"p/launch/a.launch.py": "'urdf/old/r.urdf'"}, False),
        ("LEGACY_URDF/r.urdf", {}, True),
        ("third_party/urdf/r.urdf", {}, True),
        ("third_party/urdf/r.urdf", {"p/launch/a.launch.py": "'third_party/urdf/r.urdf'"}, False),
        ("third_party/urdf/r.urdf", {"p/third_party/launch/a.launch": STARTED}, True),
        ("third_party/urdf/r.urdf", {"p/launch/a.launch": STARTED}, False),
        ("isaacgym/assets/r.urdf", {}, True),
        ("urdf/raw_data/r.urdf", {"p/urdf/README.md": "python update.py raw_data/<ROBOT>.urdf"}, True),
        ("urdf/raw_data/r.urdf", {"p/launch/a.launch.py": "'urdf/raw_data/r.urdf'"}, False),
        ("raw_description/r.urdf", {}, False),
        ("urdf/q_ori.urdf", {}, True),
        ("urdf/q_ori.urdf", {"p/launch/a.launch.py": "'urdf/q_ori.urdf'"}, False),
        ("urdf/q_ori.urdf", {"p/launch/a.launch": "<launch><!-- urdf/q_ori.urdf --></launch>"}, True),
        ("urdf/other_ori.urdf", {}, False),
        ("urdf/other-old.urdf", {}, True),
        ("other-old.urdf", {}, False),
    ],
)
def test_a_model_that_is_kept_and_not_used_is_like_test_data(
    workspace: Path, place: str, files: dict[str, str], is_aside: bool
) -> None:
    write(workspace, {"p/package.xml": manifest("p"), f"p/{place}": URDF, "p/urdf/q.urdf": URDF, **files})
    targets = planned(".").models
    assert {target.path.as_posix() for target in targets} == {f"p/{place}", "p/urdf/q.urdf"}
    assert [t.path.as_posix() for t in targets if t.is_test_data and t.is_kept_aside] == [f"p/{place}"] * is_aside
    assert not [target for target in targets if target.is_test_data != target.is_kept_aside]


@pytest.mark.parametrize(
    ("given", "files", "is_aside"),
    [
        (["."], {}, True),
        (["."], {"p/launch/a.launch.py": "# get('former')"}, True),
        (["."], {"p/launch/a.launch.py": "get('former')"}, False),
        (["."], {"old/other/package.xml": manifest("other"), "old/other/setup.py": "get('former')"}, True),
        (["old/former"], {}, False),
        ([".", "old/former"], {}, False),
    ],
)
def test_a_package_in_a_folder_of_what_is_not_used_is_kept_aside_with_its_launch_files_and_their_models(
    workspace: Path, given: list[str], files: dict[str, str], is_aside: bool
) -> None:
    launch = '<launch><param name="robot_description" textfile="$(find former)/urdf/r.urdf"/></launch>'
    own = {
        "package.xml": manifest("former"),
        "urdf/r.urdf": URDF,
        "launch/a.launch": launch,
        "launch/b.launch": "<launch/>",
    }
    own = {f"old/former/{name}": text for name, text in own.items()}
    write(workspace, {"p/package.xml": manifest("p"), "p/urdf/r.urdf": URDF, **own, **files})
    plan = planned(*given)
    aside = {path.absolute().relative_to(workspace.resolve()).as_posix() for path in plan.kept_aside}
    aside |= {t.path.as_posix() for t in plan.models if t.is_test_data and t.is_kept_aside}
    aside.discard("old/other")
    expected = {"old/former", "old/former/launch/b.launch", "old/former/urdf/r.urdf"}
    assert aside == (expected if is_aside else set())


@pytest.mark.parametrize(
    "text",
    [
        f'<sdf version="1.6" {XMLNS}><xacro:ocean/><world name="w"><model name="m">{LINK}</model></world></sdf>',
        f'<!DOCTYPE Scene SYSTEM "Scene.dtd"><Scene {XMLNS}>{LINK}</Scene>',
    ],
)
def test_what_xacro_makes_for_other_programs_is_no_robot(workspace: Path, text: str) -> None:
    write(workspace, {"a.world.xacro": text, "r.urdf": URDF})
    assert models(".") == ["r.urdf"]
    assert models("a.world.xacro") == ["a.world.xacro"]


def test_a_skipped_folder_that_is_named_is_checked_all_the_same(workspace: Path) -> None:
    write(workspace, {"build/a.urdf": URDF})
    assert models("build") == ["build/a.urdf"]


def git(workspace: Path, *words: str) -> None:
    subprocess.run(["git", *words], cwd=workspace, check=True, capture_output=True)


def test_what_git_ignores_is_skipped(workspace: Path) -> None:
    write(
        workspace,
        {
            ".gitignore": "out/\n*.tmp.urdf\nlatest\n/ignored.urdf\n",
            "out/a.urdf": URDF,
            "src/b.tmp.urdf": URDF,
            "src/ignored.urdf": URDF,
            "ignored.urdf": URDF,
            "src/c.urdf": URDF,
        },
    )
    os.symlink("src", workspace / "latest")  # an ignored link to a folder that is not
    git(workspace, "init", "-q")
    assert models(".") == ["src/c.urdf", "src/ignored.urdf"]
    assert models("src") == ["src/c.urdf", "src/ignored.urdf"]
    assert models("out") == ["out/a.urdf"]  # named, so meant


def test_a_file_that_git_ignores_but_tracks_is_checked(workspace: Path) -> None:
    write(workspace, {".gitignore": "*.urdf\n", "a.urdf": URDF, "b.urdf": URDF})
    git(workspace, "init", "-q")
    git(workspace, "add", "-f", "a.urdf")
    assert models(".") == ["a.urdf"]


@pytest.mark.parametrize(
    ("repository", "elsewhere", "is_asked"),
    [("", "", False), ("a/.git", "", True), (".git", "", True), ("", "x", True)],
)
def test_git_is_asked_only_where_it_can_know_of_a_repository(
    workspace: Path, repository: str, elsewhere: str, is_asked: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A process costs as much as the search of a small folder."""
    write(workspace, {"a/a.urdf": URDF})
    if repository:
        (workspace / repository).write_text("gitdir: elsewhere\n")  # as a work tree beside the repository has it
    if elsewhere:
        monkeypatch.setenv("GIT_DIR", elsewhere)
    started: list[object] = []

    def start(words: object, **_: object) -> None:
        started.append(words)
        raise OSError

    monkeypatch.setattr(subprocess, "run", start)
    os.symlink("a", workspace / "link")
    assert models("a") == ["a/a.urdf"]
    assert models("link") == ["link/a.urdf"]
    assert len(started) == 2 * is_asked


def test_git_starts_nothing_that_the_repository_asks_for(workspace: Path) -> None:
    write(workspace, {"a.urdf": URDF})
    git(workspace, "init", "-q")
    git(workspace, "config", "core.fsmonitor", f"touch {workspace}/started; false")
    assert models(".") == ["a.urdf"]
    assert not (workspace / "started").exists()


def test_git_fetches_nothing_that_the_repository_lacks(workspace: Path) -> None:
    """What is to be ignored git reads from its objects where the file is gone, and one that is gone too from elsewhere."""
    write(workspace, {"a.urdf": URDF, "sub/.gitignore": "*.tmp\n"})
    git(workspace, "init", "-q")
    git(workspace, "add", "-A")
    listed = subprocess.run(
        ["git", "rev-parse", ":sub/.gitignore"], cwd=workspace, check=True, capture_output=True, text=True
    )
    git(workspace, "update-index", "--skip-worktree", "sub/.gitignore")
    (workspace / "sub/.gitignore").unlink()
    (workspace / ".git/objects" / listed.stdout[:2] / listed.stdout[2:].strip()).unlink()
    for name, value in (
        ("core.repositoryformatversion", "1"),
        ("extensions.partialClone", "origin"),
        ("remote.origin.promisor", "true"),
        ("remote.origin.url", f"{workspace}/.git"),
        ("remote.origin.uploadpack", f"touch {workspace}/started; git-upload-pack"),
        ("protocol.allow", "always"),
    ):
        git(workspace, "config", name, value)
    assert models(".") == ["a.urdf"]
    assert not (workspace / "started").exists()


def test_a_model_reached_by_links_is_checked_once(workspace: Path) -> None:
    write(workspace, {"src/a.urdf": URDF})
    os.symlink("a.urdf", workspace / "src/z.urdf")
    os.symlink("src", workspace / "same")
    os.symlink("..", workspace / "src/up")
    os.symlink("circle", workspace / "circle")
    os.symlink("nowhere.urdf", workspace / "broken.urdf")
    assert len(models(".")) == 1
    assert len(models("src/a.urdf", "src/z.urdf", "same/a.urdf", ".", str(workspace))) == 1


def test_a_linked_folder_outside_is_followed(workspace: Path) -> None:
    write(workspace, {"elsewhere/a.urdf": URDF, "ws/readme": ""})
    os.symlink("../elsewhere", workspace / "ws/robots")
    assert models("ws") == ["ws/robots/a.urdf"]


# -- which files are models --------------------------------------------------------------------------------------------


def test_a_xacro_that_only_defines_macros_is_no_model(workspace: Path) -> None:
    write(
        workspace,
        {
            "macros.xacro": xacro(MACRO + '<xacro:property name="p" value="1"/><xacro:arg name="a" default=""/>'),
            "uses.xacro": xacro(MACRO + "<xacro:wheel/>"),
            "conditional.xacro": xacro(f'<xacro:if value="1">{LINK}</xacro:if>'),
        },
    )
    assert models(".") == ["conditional.xacro", "uses.xacro"]


def test_a_xacro_that_is_included_is_no_model_of_its_own(workspace: Path) -> None:
    write(
        workspace,
        {
            "pkg/package.xml": manifest("pkg"),
            "pkg/top.urdf.xacro": xacro(include("$(find pkg)/parts/arm.xacro") + include("parts/by_arg_$(arg kind).xacro")),
            "pkg/parts/arm.xacro": xacro(include("hand.xacro") + LINK),
            "pkg/parts/hand.xacro": xacro(LINK),
            "pkg/parts/by_arg_.xacro": xacro(LINK),
            "pkg/other.xacro": xacro(LINK + include("parts/glob/*.xacro")),
            "pkg/parts/glob/a.xacro": xacro(LINK),
            "pkg/parts/glob/b.xacro": xacro(LINK),
        },
    )  # fmt: skip
    assert models(".") == ["pkg/other.xacro", "pkg/top.urdf.xacro"]


def test_a_file_means_its_own_package_where_another_one_has_the_name(workspace: Path) -> None:
    robot = xacro(LINK + include("$(find p)/urdf/sensors.xacro"))
    parts = {f"{place}/package.xml": manifest("p") for place in ("p", "p/p")}
    parts |= {f"{place}/urdf/robot.xacro": robot for place in ("p", "p/p")}
    parts |= {f"{place}/urdf/sensors.xacro": xacro(LINK, name="") for place in ("p", "p/p")}
    write(workspace, parts)
    assert models(".") == ["p/p/urdf/robot.xacro", "p/urdf/robot.xacro"]


def test_a_file_of_a_third_package_may_mean_each_package_of_a_name(workspace: Path) -> None:
    write(
        workspace,
        {
            "robot/package.xml": manifest("robot"),
            "robot/robot.xacro": xacro(LINK + include("$(find p)/sensors.xacro")),
            **{f"{place}/package.xml": manifest("p") for place in ("ros1/p", "ros2/p")},
            **{f"{place}/sensors.xacro": xacro(LINK, name="") for place in ("ros1/p", "ros2/p")},
        },
    )
    assert models(".") == ["robot/robot.xacro"]


def test_what_a_package_means_by_its_own_name_is_not_what_another_one_means(workspace: Path) -> None:
    robot, places = xacro(LINK + include("$(find p)/sensors.xacro")), ("ros1/p", "ros2/p")
    parts = {f"{place}/sensors.xacro": xacro(LINK, name="") for place in places}
    manifests = {f"{place}/package.xml": manifest("p") for place in places}
    write(
        workspace,
        {**parts, **manifests, "ros1/p/robot.xacro": robot, "z/package.xml": manifest("z"), "z/robot.xacro": robot},
    )
    assert models(".") == ["ros1/p/robot.xacro", "z/robot.xacro"]


def test_a_plain_part_with_a_name_is_checked_in_the_robot_that_includes_it(workspace: Path) -> None:
    joint = '<joint name="j" type="fixed"><parent link="base_link"/><child link="imu"/></joint>'
    part = f'<robot name="r"><link name="imu"/>{joint}</robot>'
    whole = f'<robot name="r"><link name="imu"/><link name="base_link"/>{joint}</robot>'
    write(
        workspace,
        {
            "package.xml": manifest("pkg"),
            "top.xacro": xacro('<link name="base_link"/>' + include("sensors.urdf") + include("whole.urdf")),
            "sensors.urdf": part,
            "alone.urdf": part,
            "whole.urdf": whole,
        },
    )
    assert models("sensors.urdf") == ["top.xacro"]
    assert models("alone.urdf") == ["alone.urdf"]
    assert models("whole.urdf") == ["whole.urdf"]


def test_an_include_with_an_argument_in_its_path_may_mean_every_file_of_that_name(workspace: Path) -> None:
    write(
        workspace,
        {
            "top.xacro": xacro(LINK + include("$(arg vendor)/gripper.xacro")),
            "a/gripper.xacro": xacro(LINK),
            "b/gripper.xacro": xacro(LINK),
        },
    )
    assert models(".") == ["top.xacro"]


def test_an_include_with_an_argument_in_the_name_of_the_file_may_mean_every_part_that_is_called_so(
    workspace: Path,
) -> None:
    part = xacro(MACRO, name="")
    write(
        workspace,
        {
            "package.xml": manifest("pkg"),
            "one.xacro": xacro(LINK + include("control/$(arg type).control.xacro")),
            "two.xacro": xacro(LINK + include("control/$(arg type).control.xacro")),
            "control/a.control.xacro": part,
            "control/b.control.xacro": part,
            "control/c.sensors.xacro": part,
            "control/robot.control.xacro": xacro(LINK),
        },
    )
    for name in ("a", "b"):
        assert models(f"control/{name}.control.xacro") == ["one.xacro", "two.xacro"]
    assert models("control/c.sensors.xacro") == []
    # What is a robot by itself is no part, whatever an argument may name.
    assert models(".") == ["control/robot.control.xacro", "one.xacro", "two.xacro"]


def test_the_file_that_a_misspelt_include_means_is_no_model(workspace: Path) -> None:
    """The slip is told where it is typed; the part, which cannot be expanded by itself, must not be a second error."""
    part = xacro(LINK + "<xacro:wheel/>", name="")
    write(
        workspace,
        {
            "urdf/car.urdf.xacro": xacro(include("lydar.xacro") + LINK),
            "urdf/lidar.xacro": part,
            "urdf/camera.xacro": part,
            "other/lidar.xacro": part,
        },
    )
    assert models("urdf", "other") == ["other/lidar.xacro", "urdf/camera.xacro", "urdf/car.urdf.xacro"]
    # Neither is it one for a pre-commit hook that names it.
    assert models("urdf/lidar.xacro") == ["urdf/car.urdf.xacro"]
    # A file that can stand alone is a model, whatever another misspells.
    write(workspace, {"urdf/lidar.xacro": xacro(LINK)})
    assert "urdf/lidar.xacro" in models("urdf")


def test_an_include_in_a_comment_makes_a_part_of_a_file_that_has_no_name(workspace: Path) -> None:
    write(
        workspace,
        {
            "top.xacro": xacro(f"{LINK}<!-- {include('part.xacro')} {include('robot.xacro')} -->"),
            "part.xacro": xacro(LINK, name=""),
            "robot.xacro": xacro(LINK),
        },
    )
    assert models(".") == ["top.xacro"]
    # Only its expansion shows whether `robot.xacro` is a robot of its own; the other is looked at if no model is made of it.
    assert candidates(".") == [("part.xacro", True), ("robot.xacro", False)]


def test_a_xacro_of_includes_alone_is_a_model_only_if_its_expansion_says_so(workspace: Path) -> None:
    write(workspace, {"a.xacro": xacro(include("m.xacro")), "m.xacro": xacro(MACRO), "b.xacro": xacro(LINK)})
    assert [(t.path.name, t.tentative) for t in planned(".").models] == [("a.xacro", True), ("b.xacro", False)]


@pytest.mark.parametrize(
    "content",
    [
        b"\xff\xfe" + URDF.encode("utf-16-le"),
        b"\xef\xbb\xbf" + URDF.encode(),
        f"<?xml version='1.0'?>\n{URDF}".encode(),
    ],
)
def test_a_model_is_recognised_in_any_encoding(workspace: Path, content: bytes) -> None:
    write(workspace, {"a.urdf": content})
    assert models(".") == ["a.urdf"]


def test_what_is_called_a_model_is_one_however_broken(workspace: Path) -> None:
    write(
        workspace,
        {
            "broken.urdf": '<robot name="r"><link',
            "broken.xacro": "<robot ",
            "latin.urdf": b'<robot name="\xe4"/>',
            "page.urdf": "<html/>",
            "empty.urdf": "",
            "noise.urdf": b"\0\xff\0",
        },
    )
    assert models(".") == ["broken.urdf", "broken.xacro", "empty.urdf", "latin.urdf", "noise.urdf", "page.urdf"]


def test_a_pattern_of_an_include_is_looked_for_in_reach_only(workspace: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A tree of wildcards would walk all of the disk."""
    asked: set[str] = set()
    listed = os.listdir
    monkeypatch.setattr(os, "listdir", lambda folder: asked.add(os.path.relpath(folder, workspace)) or listed(folder))
    include = '<xacro:include filename="{}"/>'
    names = ["../../../../*/*/*/*", "/*/*/*", "parts/*.xacro", "parts/*/../../../../*"]
    write(workspace, {"a.xacro": xacro(LINK + "".join(map(include.format, names))), "parts/b.xacro": xacro("")})
    os.symlink(workspace.parent, workspace / "outside")
    discover_targets([Path(".")], {}, packages={}, package_paths=[], reach=FileReach.from_paths([workspace], []))
    assert {folder for folder in asked if os.path.isdir(folder)} == {"parts", "."}


def test_links_in_a_circle_make_no_pattern_endless(workspace: Path) -> None:
    write(workspace, {"a.xacro": xacro(f'{LINK}<xacro:include filename="{"*/" * 40}b.xacro"/>')})
    for name in ("one", "two"):
        os.symlink(".", workspace / name)
    assert models(".") == ["a.xacro"]


def test_a_file_that_includes_others_endlessly_is_looked_through_once(workspace: Path) -> None:
    write(workspace, {f"d{i}/b.xacro": xacro(LINK) for i in range(200)})
    write(
        workspace,
        {"a.xacro": xacro(LINK + "".join(f'<xacro:include filename="$(arg x{i})/b.xacro"/>' for i in range(5_000)))},
    )
    began = time.monotonic()
    assert "a.xacro" in models(".")
    assert time.monotonic() - began < 10


@pytest.mark.long
def test_folders_may_be_as_deep_as_paths_go(workspace: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write(workspace, {"a.urdf": URDF})
    for _ in range(1_200):
        os.mkdir("d")
        os.chdir("d")
    monkeypatch.chdir(workspace)
    try:
        assert models(".") == ["a.urdf"]
    finally:  # shutil calls itself for each level
        subprocess.run(["rm", "-rf", str(workspace / "d")], check=True)


# -- launch files ------------------------------------------------------------------------------------------------------

ROS_1 = '<launch><param name="robot_description" command="xacro $(find car)/urdf/car.xacro {}"/></launch>'


def test_a_model_reached_by_a_launch_file_and_by_the_folder_is_checked_once_with_its_arguments(workspace: Path) -> None:
    write(
        workspace,
        {
            "car/package.xml": manifest("car"),
            "car/urdf/car.xacro": xacro(LINK),
            "car/launch/view.launch": ROS_1.format("arm:=true"),
        },
    )
    found = planned("car")
    (target,) = found.models
    assert (target.path, target.arguments) == (Path("car/urdf/car.xacro"), {"arm": "true"})
    assert target.launches == (Path("car/launch/view.launch"),)
    assert found.launches == ()  # checked with its model
    assert [p.name for p in found.packages] == ["car"]


def test_each_set_of_arguments_is_a_model_and_those_of_the_command_line_win(workspace: Path) -> None:
    write(
        workspace,
        {
            "car/package.xml": manifest("car"),
            "car/urdf/car.xacro": xacro(LINK),
            "car/launch/a.launch": ROS_1.format("arm:=1"),
            "car/launch/b.launch": ROS_1.format("arm:=2"),
            "car/launch/c.launch": ROS_1.format("arm:=2"),
        },
    )
    assert [dict(t.arguments) for t in planned("car").models] == [{"arm": "1"}, {"arm": "2"}]
    (one,) = planned("car", arguments={"arm": "3"}).models
    assert one.arguments == {"arm": "3"}
    assert [p.name for p in one.launches] == ["a.launch", "b.launch", "c.launch"]


def test_a_named_model_is_checked_as_it_is_beside_what_a_launch_file_makes_of_it(workspace: Path) -> None:
    write(
        workspace,
        {
            "car/package.xml": manifest("car"),
            "car/urdf/car.xacro": xacro(LINK),
            "car/launch/a.launch": ROS_1.format("arm:=1"),
        },
    )
    found = planned("car/launch/a.launch", "car/urdf/car.xacro").models
    assert [(dict(t.arguments), t.explicit) for t in found] == [({}, True), ({"arm": "1"}, False)]


def test_a_launch_file_without_model_is_checked_alone(workspace: Path) -> None:
    write(workspace, {"a.launch": "<launch/>", "broken.launch.xml": "<launch", "c.launch.py": "1"})
    found = planned(".")
    assert (found.models, found.launches) == ((), (Path("a.launch"), Path("broken.launch.xml"), Path("c.launch.py")))


def test_a_python_launch_file_leads_to_the_models_that_it_names(workspace: Path) -> None:
    write(
        workspace,
        {
            "car/package.xml": manifest("car"),
            "car/urdf/car.urdf": URDF,
            "car/launch/car.launch.py": "m = os.path.join(share, 'urdf', 'car.urdf')",
        },
    )
    assert [Path(m).resolve() for m in models("car/launch/car.launch.py")] == [workspace / "car/urdf/car.urdf"]


def test_a_semantic_description_that_a_python_launch_file_expands_is_no_model(workspace: Path) -> None:
    write(
        workspace,
        {
            "arm/package.xml": manifest("arm"),
            "arm/config/arm.srdf.xacro": xacro('<virtual_joint name="fixed"/>'),
            "arm/config/robot.srdf.xacro": xacro(LINK),
            "arm/launch/arm.launch.py": "m = 'config/arm.srdf.xacro'",
            "arm/launch/robot.launch.py": "m = 'config/robot.srdf.xacro'",
        },
    )
    assert models("arm/launch/arm.launch.py") == []
    assert [Path(m).name for m in models("arm/launch/robot.launch.py")] == ["robot.srdf.xacro"]


@pytest.mark.parametrize("path", [".", "car/launch/car.launch.py"])
@pytest.mark.parametrize(
    ("included", "name", "is_part"),
    [("$(arg extras)", "", True), ("$(arg extras)", ' name="r"', False), ("", "", False)],
)
def test_what_a_python_launch_file_names_for_an_include_is_a_part(
    workspace: Path, path: str, included: str, name: str, is_part: bool
) -> None:
    write(
        workspace,
        {
            ".git/HEAD": "",
            "car/package.xml": manifest("car"),
            "car/urdf/car.xacro": xacro(LINK + (include(included) if included else "")),
            "car/urdf/empty.urdf": f"<robot{name}/>",
            "car/launch/car.launch.py": "m = 'urdf/car.xacro'; n = 'urdf/empty.urdf'",
        },
    )
    assert any(name.endswith("empty.urdf") for name in models(path)) is not is_part


def test_a_python_launch_file_is_checked_with_the_one_model_that_it_names(workspace: Path) -> None:
    write(
        workspace,
        {
            "car/package.xml": manifest("car"),
            "car/urdf/car.xacro": xacro(LINK),
            "car/urdf/arm.xacro": xacro(LINK),
            "car/launch/car.launch.py": "m = 'urdf/car.xacro'",
            "car/launch/both.launch.py": "m = 'urdf/car.xacro'; n = 'urdf/arm.xacro'",
        },
    )
    found = planned("car")
    assert [(t.path.name, [x.name for x in t.launches]) for t in found.models] == [
        ("arm.xacro", []),
        ("car.xacro", ["car.launch.py"]),
    ]
    assert [x.name for x in found.launches] == ["both.launch.py"]
    # It does not say with which arguments: that is for an XML one, which is all that the model is checked with.
    write(workspace, {"car/launch/view.launch": ROS_1.format("arm:=true")})
    found = planned("car")
    assert [dict(t.arguments) for t in found.models if t.path.name == "car.xacro"] == [{"arm": "true"}]
    assert [x.name for x in found.launches] == ["both.launch.py", "car.launch.py"]


@pytest.mark.parametrize(
    ("name", "yes"),
    [
        ("a.launch", True), ("a.launch.xml", True), ("a.launch.py", True), ("a_launch.py", True), ("a_launch.xml", True),
        ("launch.txt", False), ("a.xml", False), ("setup.py", False),
    ],
)  # fmt: skip
def test_a_launch_file_is_known_by_its_name(name: str, yes: bool) -> None:
    assert is_launch(Path("launch") / name) is yes


# -- changed files, as pre-commit hands them over ----------------------------------------------------------------------


@pytest.fixture
def car(workspace: Path) -> Path:
    """A package with two models, macros, a part without a name, and meshes."""
    write(
        workspace,
        {
            ".git/HEAD": "",
            "car/package.xml": manifest("car"),
            "car/urdf/car.urdf.xacro": xacro(
                include("macros.xacro") + include("$(find car)/urdf/part.xacro") + LINK + '<xacro:wheel side="left"/>'
            ),
            "car/urdf/macros.xacro": xacro(include("inner.xacro")),
            "car/urdf/inner.xacro": xacro(
                '<xacro:macro name="wheel" params="side"><link name="w"><visual><geometry>'
                '<mesh filename="package://car/meshes/wheel_${side}.stl"/></geometry></visual></link></xacro:macro>'
            ),
            "car/urdf/part.xacro": xacro('<link name="part"/>', name=""),
            "car/urdf/box.urdf": '<robot name="b"><link name="l"><mesh filename="package://car/meshes/box.stl"/></link></robot>',
            "car/meshes/box.stl": "",
            "car/meshes/wheel_left.stl": "",
            "car/meshes/unused.stl": "",
            "bringup/package.xml": manifest("bringup"),
            "bringup/two.xacro": xacro(include("$(find car)/urdf/other.xacro") + LINK),
            "car/urdf/other.xacro": xacro(MACRO),
        },
    )  # fmt: skip
    return workspace


@pytest.mark.parametrize(
    ("changed", "checked"),
    [
        ("car/urdf/car.urdf.xacro", ["car/urdf/car.urdf.xacro"]),
        ("car/urdf/macros.xacro", ["car/urdf/car.urdf.xacro"]),
        ("car/urdf/inner.xacro", ["car/urdf/car.urdf.xacro"]),
        ("car/urdf/part.xacro", ["car/urdf/car.urdf.xacro"]),
        ("car/urdf/other.xacro", ["bringup/two.xacro"]),
        ("car/meshes/box.stl", ["car/urdf/box.urdf"]),
        ("car/meshes/wheel_left.stl", ["car/urdf/car.urdf.xacro"]),
        ("car/package.xml", ["car/urdf/box.urdf", "car/urdf/car.urdf.xacro"]),
    ],
)
def test_a_changed_file_leads_to_the_models_that_use_it(car: Path, changed: str, checked: list[str]) -> None:
    found = planned(changed)
    assert [t.path.as_posix() for t in found.models] == checked
    assert (found.missing, found.unused) == ((), ())
    assert [t.path for t in planned(str(car / changed)).models] == [car / c for c in checked]


def test_many_changed_files_of_one_model_check_it_once(car: Path) -> None:
    changed = ["car/urdf/inner.xacro", "car/urdf/macros.xacro", "car/urdf/car.urdf.xacro", "car/meshes/wheel_left.stl"]
    assert models(*changed) == ["car/urdf/car.urdf.xacro"]


def test_a_mesh_or_macro_file_that_no_model_uses_is_said(car: Path) -> None:
    write(car, {"car/urdf/lonely.xacro": xacro(MACRO)})
    found = planned("car/meshes/unused.stl", "car/urdf/lonely.xacro")
    assert found.models == ()
    assert [path for path, _ in found.unused] == ["car/meshes/unused.stl"]
    # A file that was named is expanded, whatever its text looks like.
    assert [(t.path.as_posix(), t.tentative, t.is_part) for t in found.candidates] == [
        ("car/urdf/lonely.xacro", True, False)
    ]


ARM = {
    "arm/package.xml": manifest("arm"),
    "arm/urdf/arm.urdf.xacro": xacro("${xacro.load_yaml('../sizes/sizes.yaml')}" + LINK, ' name="arm"'),
    "arm/urdf/stand.urdf": '<robot name="stand"><link name="base"/></robot>',
    "arm/sizes/sizes.yaml": "",
    "arm/config/controllers.yaml": "",
    "arm/docs/notes.yaml": "",
    "moveit/package.xml": manifest("moveit"),
    "moveit/config/arm.srdf": '<robot name="arm"/>',
    "moveit/config/joint_limits.yaml": "",
    "bringup/package.xml": manifest("bringup"),
    "bringup/config/control.yaml": "",
    "bringup/launch/stand.launch": """<launch>
        <param name="robot_description" textfile="$(find arm)/urdf/stand.urdf"/>
        <rosparam command="load" file="$(find bringup)/config/control.yaml"/></launch>""",
}


@pytest.mark.parametrize(
    ("changed", "checked"),
    [
        ("arm/sizes/sizes.yaml", ["arm/urdf/arm.urdf.xacro"]),  # loaded by the xacro
        ("arm/config/controllers.yaml", ["arm/urdf/arm.urdf.xacro", "arm/urdf/stand.urdf"]),  # nobody names it
        ("moveit/config/joint_limits.yaml", ["arm/urdf/arm.urdf.xacro"]),  # beside an SRDF
        ("moveit/config/arm.srdf", ["arm/urdf/arm.urdf.xacro"]),
        ("bringup/config/control.yaml", ["arm/urdf/stand.urdf"]),  # a launch file loads it
        ("arm/docs/notes.yaml", []),
    ],
)
def test_changed_settings_lead_to_the_models_that_they_are_for(
    workspace: Path, changed: str, checked: list[str]
) -> None:
    (workspace / ".git").mkdir()
    write(workspace, ARM)
    found = planned(changed)
    assert [t.path.as_posix() for t in found.models] == checked
    assert [path for path, _ in found.unused] == ([] if checked else [changed])
    assert found.missing == ()


def test_a_mesh_of_another_package_with_the_same_name_is_another_mesh(car: Path) -> None:
    write(car, {"boat/package.xml": manifest("boat"), "boat/meshes/box.stl": ""})
    assert models("boat/meshes/box.stl") == []
    write(car, {"bringup/boat.urdf": '<robot name="b"><link/><mesh filename="package://boat/meshes/box.stl"/></robot>'})
    assert models("boat/meshes/box.stl") == ["bringup/boat.urdf"]


def test_a_named_file_of_includes_that_nobody_includes_is_checked(workspace: Path) -> None:
    write(workspace, {"top.xacro": xacro(include("m.xacro")), "m.xacro": xacro(MACRO)})
    assert planned("top.xacro").models == (ModelTarget(path=Path("top.xacro"), arguments={}, explicit=True),)


def test_a_named_part_is_checked_itself_when_it_may_stand_alone(workspace: Path) -> None:
    write(workspace, {"arm.xacro": xacro(LINK), "table.xacro": xacro(include("arm.xacro") + '<link name="t"/>')})
    assert models("arm.xacro") == ["arm.xacro"]
    assert models(".") == ["table.xacro"]


def test_paths_that_lead_to_nothing_are_listed_and_hide_no_other(workspace: Path) -> None:
    write(workspace, {"a.urdf": URDF, "readme.md": ""})
    os.mkfifo(workspace / "pipe")
    found = planned("no.urdf", "readme.md", "pipe", "a.urdf", "x" * 300 + ".urdf")
    assert [t.path.name for t in found.models] == ["a.urdf"]
    assert [path[:10] for path, _ in found.missing] == ["no.urdf", "readme.md", "pipe", "x" * 10]


def test_a_file_that_xacro_cannot_read_is_no_mere_macro_file(workspace: Path) -> None:
    write(workspace, {"r.urdf.xacro": "<robot><foo:bar/></robot>", "m.xacro": xacro(MACRO)})
    assert models("r.urdf.xacro") == ["r.urdf.xacro"]
    assert models(".") == ["r.urdf.xacro"]


# -- the work that it takes --------------------------------------------------------------------------------------------


def count_calls(*paths: str) -> int:
    """The number of function calls of a search: a measure of its work that no other load on the machine changes."""
    calls = 0

    def count(_frame: object, event: str, _argument: object) -> None:
        nonlocal calls
        calls += event in {"call", "c_call"}

    sys.setprofile(count)
    try:
        planned(*paths)
    finally:
        sys.setprofile(None)
    return calls


@pytest.mark.long
def test_files_that_include_each_other_are_looked_at_in_linear_time(workspace: Path) -> None:
    calls = []
    for count in (20, 80):  # each file includes ten others, and all files belong to one circle
        for i in range(count):
            parts = "".join(include(f"f{(i + step) % count}.xacro") for step in range(1, 11))
            write(workspace, {f"{count}/f{i}.xacro": xacro(LINK + parts)})
        calls.append(count_calls(str(count)))
    assert calls[1] < 1.3 * 4 * calls[0]


@pytest.mark.long
def test_a_chain_of_includes_is_looked_at_in_linear_time(workspace: Path) -> None:
    calls = []
    for count in (20, 80):
        for i in range(count):
            write(workspace, {f"{count}/f{i}.xacro": xacro(LINK + include(f"f{i + 1}.xacro"))})
        calls.append(count_calls(str(count)))
    assert calls[1] < 1.3 * 4 * calls[0]


@pytest.mark.long
@pytest.mark.parametrize("kind", ["urdf", "meshes", "config", "launch"])
def test_paths_are_looked_at_in_linear_time(workspace: Path, kind: str) -> None:
    calls = []
    for count in (10, 40):
        root = f"ws{count}"
        write(workspace, {f"{root}/.git/HEAD": "", f"{root}/car/package.xml": manifest("car")})
        for i in range(count):
            mesh = f'<link name="a"><visual><geometry><mesh filename="package://car/meshes/a{i}.stl"/></geometry></visual></link>'
            write(
                workspace,
                {
                    f"{root}/car/urdf/r{i}.urdf.xacro": xacro(include(f"m{i}.xacro") + mesh, f' name="r{i}"'),
                    f"{root}/car/urdf/m{i}.xacro": xacro(MACRO, ""),
                    f"{root}/car/meshes/a{i}.stl": "",
                    f"{root}/car/config/c{i}.yaml": "",
                    f"{root}/car/config/r{i}.srdf": f'<robot name="r{i}"/>',
                    f"{root}/car/launch/l{i}.launch": ROS_1.format("arm:=true"),
                },
            )
        calls.append(count_calls(*(str(path) for path in Path(root, "car", kind).iterdir())))
    assert calls[1] < 1.3 * 4 * calls[0]


def test_what_is_not_looked_at_in_time_is_told_and_hides_no_other(
    workspace: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write(workspace, {"a.urdf": URDF, "b.urdf": URDF, "c.urdf": URDF})
    budget = PlanningBudget(60, 30)
    left = iter([False, False, False, True, True])  # the folder, a, b, c, and whatever comes after
    monkeypatch.setattr(budget, "is_used_up", lambda: next(left, True))
    found = discover_targets([Path("."), Path("d")], {}, packages={}, package_paths=[], budget=budget)
    assert [t.path.name for t in found.models] == ["a.urdf", "b.urdf"]
    reason = "is not checked: looking for models took more than 60 s (--timeout)"
    assert dict(found.missing) == {"c.urdf": reason, "d": reason}


@pytest.mark.skipif(sys.platform == "win32", reason="alarms")
def test_a_file_that_takes_too_long_hides_no_other(workspace: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write(workspace, {"huge.urdf": URDF, "slow.urdf": URDF, "z.urdf": URDF})

    def read(path: Path) -> ModelFile:
        if path.name == "slow.urdf":
            time.sleep(20)
        if path.name == "huge.urdf":
            raise MemoryError
        return ModelFile(path)

    monkeypatch.setattr("urdfcheck.source.planning_budget.ModelFile", read)
    found = discover_targets([Path(".")], {}, packages={}, package_paths=[], budget=PlanningBudget(600, 0.2))
    assert [t.path.name for t in found.models] == ["z.urdf"]
    assert dict(found.missing) == {
        "huge.urdf": "is not checked: reading it takes too much memory (--memory)",
        "slow.urdf": "is not checked: reading it takes more than 0.2 s (--timeout)",
    }


@pytest.mark.skipif(sys.platform == "win32", reason="alarms")
def test_a_launch_file_that_takes_too_long_or_crashes_hides_no_other(
    workspace: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whatever a launch file does to who looks at it: the process that looks for models must not end."""
    launch = ROS_1.format("")
    write(workspace, {"crash.launch": launch, "slow.launch": launch, "huge.launch": launch, "z.urdf": URDF})

    def read(path: Path, finder: PackageFinder) -> object:
        if path.name == "slow.launch":
            time.sleep(20)
        raise MemoryError if path.name == "huge.launch" else RecursionError

    monkeypatch.setattr("urdfcheck.source.launch.launch_file.load_launch", read)
    found = discover_targets([Path(".")], {}, packages={}, package_paths=[], budget=PlanningBudget(600, 0.2))
    assert [t.path.name for t in found.models] == ["z.urdf"]
    assert dict(found.missing) == {
        "crash.launch": "is not checked: reading it crashed (RecursionError)",
        "huge.launch": "is not checked: reading it takes too much memory (--memory)",
        "slow.launch": "is not checked: reading it takes more than 0.2 s (--timeout)",
    }


@pytest.mark.parametrize("form", ["$(arg a{})", "$(arg $(arg b{}))"], ids=["plain", "computed"])
def test_a_long_chain_of_arguments_is_no_crash(workspace: Path, form: str) -> None:
    """Longer than Python lets functions call themselves; the time grows with the square of the length."""
    assert sys.getrecursionlimit() <= 1000
    chain = "".join(
        f'<arg name="a{i}" default="{form.format(i - 1)}"/><arg name="b{i}" default="a{i}"/>' for i in range(1, 1500)
    )
    description = '<param name="robot_description" command="xacro $(arg a1499)"/>'
    write(workspace, {"x.launch": f"<launch>{chain}{description}</launch>", "z.urdf": URDF})
    found = discover_targets([Path(".")], {}, packages={}, package_paths=[])
    assert [t.path.name for t in found.models] == ["z.urdf"]
    assert not found.missing


# -- names and suffixes ------------------------------------------------------------------------------------------------


def test_suffixes_count_in_any_case(workspace: Path) -> None:
    mesh = '<link name="l"><visual><geometry><mesh filename="package://car/meshes/BOX.STL"/></geometry></visual></link>'
    write(
        workspace,
        {
            "car/package.xml": manifest("car"),
            "car/urdf/CAR.URDF": f'<robot name="car">{mesh}</robot>',
            "car/urdf/Wheel.URDF.XACRO": xacro(LINK),
            "car/meshes/BOX.STL": "",
            "car/config/CAR.SRDF": '<robot name="car"/>',
            "car/launch/CAR.LAUNCH": ROS_1.format("").replace("car.xacro", "Wheel.URDF.XACRO"),
            "car/launch/car.launch.py": "m = os.path.join(share, 'urdf', 'CAR.URDF')",
        },
    )
    both = ["car/urdf/CAR.URDF", "car/urdf/Wheel.URDF.XACRO"]
    assert models("car") == models(*both) == both
    assert models("car/meshes/BOX.STL") == models("car/config/CAR.SRDF") == models("car/urdf/CAR.URDF") == both[:1]
    assert [Path(m).resolve() for m in models("car/launch/CAR.LAUNCH")] == [workspace / both[1]]
    assert [Path(m).resolve() for m in models("car/launch/car.launch.py")] == [workspace / both[0]]


@pytest.mark.parametrize(
    ("start", "xacro_runs"),
    [
        ("Command([FindExecutable(name='xacro'), ' ', 'urdf/car.urdf'])", True),
        ("Command(['xacro ', 'urdf/car.urdf'])", True),
        ("xacro.process_file('urdf/car.urdf')", True),
        ("open('urdf/car.urdf').read()", None),
    ],
)
def test_a_python_launch_file_that_runs_xacro_on_its_model_is_heeded(
    workspace: Path, start: str, xacro_runs: bool | None
) -> None:
    write(
        workspace,
        {"car/package.xml": manifest("car"), "car/urdf/car.urdf": URDF, "car/launch/a.launch.py": f"d = {start}"},
    )
    assert [target.xacro for target in planned("car").models] == [xacro_runs]


def test_hidden_files_of_a_folder_are_left_alone(workspace: Path) -> None:
    write(workspace, {".old.urdf": URDF, "new.urdf": URDF, ".spawn.launch": "<launch/>"})
    assert models(".") == ["new.urdf"]
    assert not planned(".").launches
    assert models(".old.urdf") == [".old.urdf"]


def test_the_file_of_a_gltf_mesh_checks_the_models_of_the_mesh(workspace: Path) -> None:
    mesh = '<visual><geometry><mesh filename="package://car/meshes/{}"/></geometry></visual>'
    named = '{{"asset": {{"version": "2.0"}}, "buffers": [{{"uri": "{}", "byteLength": 3}}]}}'
    urdf = '<robot name="{0}"><link name="base">{1}</link></robot>'
    write(
        workspace,
        {
            "car/package.xml": manifest("car"),
            "car/urdf/car.urdf": urdf.format("car", mesh.format("body.gltf")),
            "car/urdf/other.urdf": urdf.format("other", mesh.format("other.gltf")),
            "car/meshes/body.gltf": named.format("data/the%20body.bin"),
            "car/meshes/other.gltf": named.format("other.bin"),
            "car/meshes/data/the body.bin": "abc",
            "car/meshes/data/firmware.bin": "abc",
        },
    )
    assert models("car/meshes/data/the body.bin") == ["car/urdf/car.urdf"]
    found = planned("car/meshes/data/firmware.bin")
    assert (found.models, [path for path, _ in found.unused]) == ((), ["car/meshes/data/firmware.bin"])


@pytest.mark.parametrize("name", ["arm.srdf.xacro", "arm_macro.srdf.xacro", "groups.srdf.xacro", "macros.xacro"])
def test_a_part_of_a_semantic_description_checks_the_models_of_the_description(workspace: Path, name: str) -> None:
    """Whatever file of it changed: its own name, or that of the file which includes it, says whose it is."""
    macro = '<xacro:macro name="m{}"><group name="g"/></xacro:macro>'
    write(
        workspace,
        {
            "arm/package.xml": manifest("arm"),
            "arm/urdf/arm.urdf": '<robot name="arm"><link name="base"/></robot>',
            "arm/urdf/stand.urdf": '<robot name="stand"><link name="base"/></robot>',
            "arm/srdf/arm.srdf.xacro": xacro(
                include("arm_macro.srdf.xacro") + include("$(find arm)/srdf/$(arg kind).srdf.xacro"), ' name="arm"'
            ),
            "arm/srdf/arm_macro.srdf.xacro": xacro(include("macros.xacro") + macro.format(1), ""),
            "arm/srdf/groups.srdf.xacro": xacro(macro.format(2), ""),
            "arm/srdf/macros.xacro": xacro(macro.format(3), ""),
        },
    )
    assert models(f"arm/srdf/{name}") == ["arm/urdf/arm.urdf"]


def test_a_file_that_was_seen_before_is_not_parsed_again(workspace: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An editor plans after each key; what is typed in the one file that differs counts at once."""
    write(
        workspace,
        {"package.xml": "<package/>", "a.xacro": xacro(LINK + include("b.xacro")), "b.xacro": xacro(MACRO, "")},
    )
    assert models("a.xacro") == ["a.xacro"]
    parsed = []
    monkeypatch.setattr(
        "urdfcheck.source.model_file._parse", lambda source: (parsed.append(source), parse_xml(source))[1]
    )
    assert models("a.xacro") == ["a.xacro"]
    assert parsed == []
    write(workspace, {"a.xacro": xacro(include("b.xacro"), "")})
    assert len(models("b.xacro")) == 1
    assert len(parsed) == 1


@pytest.mark.parametrize(
    ("text", "named"),
    [
        ("$(find arm)/urdf/hand.xacro", True),
        ("$(find-pkg-share arm)/urdf/hand.xacro", True),
        ("package://arm/urdf/hand.xacro", True),
        ("$(find other)/urdf/hand.xacro", False),
        ("$(find arm)/urdf/old/hand.xacro", False),
        ("$(find arm)/$(arg kind)/hand.xacro", True),
        ("$(find $(arg p))/urdf/hand.xacro", True),
        ("../urdf/hand.xacro", True),
        ("left_hand.xacro", False),
        ("<!-- $(find arm)/urdf/hand.xacro -->", False),
        ("$(find other)/urdf/hand.xacro hand.xacro", True),
        ('[FindPackageShare("other"), "urdf", "hand.xacro"]', False),
        ('[FindPackageShare("arm"), "urdf/old/", "hand.xacro"]', False),
        ('join(get_package_share_directory("arm"), "urdf", f"hand.xacro")', True),
        ('[FindPackageShare("other")], "hand.xacro"', True),
    ],
)
def test_a_text_names_a_file_of_its_package_outside_comments(text: str, named: bool) -> None:
    assert names_file(text, "urdf/hand.xacro", "arm") is named


def test_settings_in_json_are_no_model(workspace: Path) -> None:
    write(workspace, {"arm/config.json.urdf": "{}", "arm/robot.urdf": URDF})
    assert models(".") == ["arm/robot.urdf"]


@pytest.mark.parametrize(
    ("top", "is_checked"), [("", False), ("<!-- {} -->", False), ("{}", True)], ids=["unnamed", "comment", "included"]
)
def test_an_empty_file_that_is_named_only_in_comments_is_passed_over(
    workspace: Path, top: str, is_checked: bool
) -> None:
    arm = xacro(LINK + top.format(include("materials.xacro")))
    write(workspace, {"p/package.xml": manifest("p"), "p/urdf/arm.xacro": arm, "p/urdf/materials.xacro": ""})
    plan = planned(".")
    passed_over = [path for path, reason in plan.left_out if "it is empty" in reason]
    assert passed_over == ([] if is_checked else ["p/urdf/materials.xacro"])
