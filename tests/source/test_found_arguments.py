"""Arguments that launch files pass to a xacro and that nobody gave."""

from __future__ import annotations

from pathlib import Path

import pytest
from conftest import check, check_text

from urdfcheck.core import Run
from urdfcheck.output import text
from urdfcheck.output.json import render as render_json
from urdfcheck.source.arguments.written_commands import find_written_arguments
from urdfcheck.source.launch.passed_arguments import find_passed_arguments
from urdfcheck.source.package.finder import PackageFinder
from urdfcheck.source.reach import FileReach

ARM = """<robot name="$(arg name)" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:arg name="name" default="arm"/>
  <xacro:arg name="type" default="none"/>
  <xacro:include filename="$(find arm)/config/$(arg type)/parts.xacro"/>
  <link name="$(arg prefix)base"/>
</robot>
"""
IMPORTS = """from launch.actions import DeclareLaunchArgument
from launch.substitutions import Command, FindExecutable, LaunchConfiguration, PathJoinSubstitution
"""
# As the launch files of Universal Robots do it.
COMMAND = (
    IMPORTS
    + """
def generate_launch_description():
    arguments = [
        DeclareLaunchArgument("type", choices=["large", "small"]),
        DeclareLaunchArgument("description_package", default_value="arm"),
        DeclareLaunchArgument("description_file", default_value="arm.urdf.xacro"),
        DeclareLaunchArgument("prefix", default_value='""'),
    ]
    kind = LaunchConfiguration("type")
    package = LaunchConfiguration("description_package")
    file = LaunchConfiguration("description_file")
    content = Command([
        PathJoinSubstitution([FindExecutable(name="xacro")]), " ",
        PathJoinSubstitution([FindPackageShare(package), "urdf", file]), " ",
        "name:=", "ur", " ", "type:=", kind, " ", "prefix:=", LaunchConfiguration("prefix"), " ",
        "unknown:=", LaunchConfiguration("never_declared"),
    ])
"""
)


def make_package(folder: Path, launches: dict[str, str], model: str = ARM) -> Path:
    """A package with a model and these launch files; the model's path."""
    files = {
        "package.xml": '<package format="3"><name>arm</name><version>1.0.0</version></package>',
        "urdf/arm.urdf.xacro": model,
        "config/large/parts.xacro": '<robot xmlns:xacro="http://www.ros.org/wiki/xacro"/>',
        "config/small/parts.xacro": '<robot xmlns:xacro="http://www.ros.org/wiki/xacro"/>',
        **{f"launch/{name}": content for name, content in launches.items()},
    }
    for name, content in files.items():
        path = folder / "arm" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(content)
    return folder / "arm/urdf/arm.urdf.xacro"


def list_found(model: Path) -> dict[str, tuple[str, int]]:
    """Value and line of each argument that launch files pass."""
    passed = find_passed_arguments(model, PackageFinder(model))
    return {a.name: (a.value, a.location.span.line if a.location.span else 0) for a in passed.values()}


class TestPassedArguments:
    @pytest.mark.parametrize(
        ("line", "is_known"), [("", True), ("    root = other", False), ("    global root", False)]
    )
    def test_a_name_counts_in_its_function(self, tmp_path: Path, line: str, is_known: bool) -> None:
        launch = f"""
def show(share):
    root = share.perform(None)
    return root

def generate_launch_description():
    root = FindPackageShare("arm")
{line}
    return Command(["xacro ", PathJoinSubstitution([root, "urdf", "arm.urdf.xacro"]), " name:=", root])
"""
        found = list_found(make_package(tmp_path, {"view.launch.py": launch}))
        assert found == ({"name": (str(tmp_path / "arm"), 9)} if is_known else {})

    def test_command(self, tmp_path: Path) -> None:
        model = make_package(tmp_path, {"view.launch.py": COMMAND})
        assert list_found(model) == {"name": ("ur", 17), "type": ("large", 6), "prefix": ("", 9)}

    @pytest.mark.parametrize(
        "call",
        [
            'Command(["xacro ", os.path.join(share, "urdf", "arm.urdf.xacro"), " name:=ur"])',
            'Command("xacro " + share + "/urdf/arm.urdf.xacro name:=ur")',
            'xacro.process_file(os.path.join(share, "urdf", "arm.urdf.xacro"), mappings={"name": "ur", "x": compute()})',
            'Command(["xacro ", PathJoinSubstitution([share, "urdf", "arm.urdf.xacro"]), " ", "name:=ur"])',
            'Command([FindExecutable(name="xacro"), " ", PathJoinSubstitution([compute(), "arm.urdf.xacro"]), " name:=", "ur"])',
        ],
    )
    def test_forms(self, call: str, tmp_path: Path) -> None:
        start = 'share = get_package_share_directory("arm")\n'
        assert list_found(make_package(tmp_path, {"a.launch.py": start + f"x = {call}\n"})) == {"name": ("ur", 2)}

    @pytest.mark.parametrize(
        "call",
        [
            'Command(["xacro ", share, "/urdf/hand.urdf.xacro name:=ur"])',
            'Command(["cat ", share, "/urdf/arm.urdf.xacro name:=ur"])',
            'Command(["xacro ", compute(), " name:=ur"])',
            'Command(["xacro ", share, "/urdf/arm.urdf.xacro name:=", compute()])',
            'process_file(share + "/urdf/arm.urdf.xacro", mappings=compute())',
        ],
    )
    def test_what_says_nothing_of_this_model(self, call: str, tmp_path: Path) -> None:
        start = 'share = get_package_share_directory("arm")\n'
        assert list_found(make_package(tmp_path, {"a.launch.py": start + f"x = {call}\n"})) == {}

    def test_a_typed_value_comes_before_a_default_and_this_before_a_choice(self, tmp_path: Path) -> None:
        def launch(declared: str, value: str) -> str:
            path = 'get_package_share_directory("arm"), "/urdf/arm.urdf.xacro'
            return f'{IMPORTS}{declared}\nx = Command(["xacro ", {path} type:=", {value}])'

        choice = launch('DeclareLaunchArgument("t", choices=["a", "b"])', 'LaunchConfiguration("t")')
        default = launch('DeclareLaunchArgument("t", default_value="c")', 'LaunchConfiguration("t")')
        model = make_package(tmp_path, {"a.launch.py": choice, "b.launch.py": default})
        assert list_found(model)["type"][0] == "c"
        (model.parents[1] / "launch/c.launch.py").write_text(launch("", '"d"'))
        assert list_found(model)["type"][0] == "d"

    def test_xml(self, tmp_path: Path) -> None:
        command = "xacro $(find arm)/urdf/arm.urdf.xacro name:=$(arg n)"
        text_ = f'<launch><arg name="n" default="ur"/><param name="robot_description" command="{command}"/></launch>'
        assert list_found(make_package(tmp_path, {"a.launch": text_})) == {"name": ("ur", 1)}

    @pytest.mark.parametrize(
        ("path", "is_meant"),
        [
            ("$(find $(arg robot))/urdf/arm.urdf.xacro", True),
            ("$(find arm)/$(arg folder)/arm.urdf.xacro", True),
            ("$(find arm)/urdf/$(arg robot).urdf.xacro", True),
            ("$(find $(arg robot)_description)/urdf/arm.urdf.xacro", False),
            ("$(find arm)/$(arg folder)/other.urdf.xacro", False),
        ],
    )
    def test_a_path_of_which_an_argument_is_a_part(self, path: str, is_meant: bool, tmp_path: Path) -> None:
        declared = "".join(f'<arg name="{name}" default="none"/>' for name in ("robot", "folder"))
        param = f'<param name="robot_description" command="xacro \'{path}\' debug:=false"/>'
        model = make_package(tmp_path, {"a.launch": f"<launch>{declared}{param}</launch>"})
        assert ("debug" in list_found(model)) == is_meant

    def test_another_package_of_the_repository(self, tmp_path: Path) -> None:
        model = make_package(tmp_path, {})
        (tmp_path / ".git").mkdir()
        bringup = tmp_path / "bringup/launch/view.launch.py"
        bringup.parent.mkdir(parents=True)
        bringup.write_text(COMMAND)
        assert list_found(model)["name"][0] == "ur"

    def test_another_package_of_the_folder_that_was_named(self, tmp_path: Path) -> None:
        """An archive of a repository, as it is unpacked, has no folder .git: what was named is the whole of it."""
        model = make_package(tmp_path, {})
        bringup = tmp_path / "bringup/launch/view.launch.py"
        bringup.parent.mkdir(parents=True)
        bringup.write_text(COMMAND)
        finders = (PackageFinder(model, reach=FileReach.from_paths([given], [])) for given in (model, tmp_path / "arm"))
        assert not any(find_passed_arguments(model, finder) for finder in finders)
        finder = PackageFinder(model, reach=FileReach((str(tmp_path),)))
        assert find_passed_arguments(model, finder)["name"].value == "ur"

    @pytest.mark.parametrize(
        "file",
        [
            'PathJoinSubstitution([FindPackageShare("arm"), "urdf", LaunchConfiguration("file")])',
            'LaunchConfiguration("path")',
        ],
    )
    def test_a_model_beside_the_default_of_an_argument(self, file: str, tmp_path: Path) -> None:
        """Such a launch file starts each of them with the same arguments."""
        command = f"""{IMPORTS}
DeclareLaunchArgument("file", default_value="arm.urdf.xacro")
DeclareLaunchArgument("path", default_value=PathJoinSubstitution([FindPackageShare("arm"), "urdf", "arm.urdf.xacro"]))
Command(["xacro ", {file}, " ", "name:=", "ur"])
"""
        model = make_package(tmp_path, {"view.launch.py": command})
        beside = [model.with_name(name) for name in ("arm_mocked.urdf.xacro", "arm.srdf.xacro")]
        elsewhere = model.parents[1] / "config/large/arm_mocked.urdf.xacro"
        assert [list_found(path) for path in (model, *beside, elsewhere)] == [{"name": ("ur", 6)}] * 2 + [{}] * 2

    def test_what_is_passed_to_the_model_itself_comes_first(self, tmp_path: Path) -> None:
        own = f'{IMPORTS}x = Command(["xacro ", FindPackageShare("arm"), "/urdf/mocked.urdf.xacro name:=", "mine"])'
        model = make_package(tmp_path, {"a.launch.py": COMMAND, "b.launch.py": own})
        assert list_found(model.with_name("mocked.urdf.xacro"))["name"][0] == "mine"

    def test_what_another_model_is_started_with_and_makes_none_of_this_one_is_not_taken(self, tmp_path: Path) -> None:
        model = make_package(tmp_path, {"view.launch.py": COMMAND})
        wrong = """<robot name="$(arg name)" xmlns:xacro="http://www.ros.org/wiki/xacro">
<link name="${nowhere}"/></robot>"""
        model.with_name("hand.urdf.xacro").write_text(wrong)
        run = check(model.with_name("hand.urdf.xacro"))
        assert [f.code for f in run.findings if f.code in {"XAC001", "XAC010"}] == ["XAC010"]

    def test_nothing_runs(self, tmp_path: Path) -> None:
        mark = tmp_path / "ran"
        make_package(tmp_path, {"a.launch.py": f"open({str(mark)!r}, 'w')\n{COMMAND}"})
        assert check(tmp_path).models[0].status == "checked"
        assert not mark.exists()


class TestModels:
    @pytest.fixture
    def run(self, tmp_path: Path) -> Run:
        make_package(tmp_path, {"view.launch.py": COMMAND})
        return check(tmp_path / "arm")

    def test_is_expanded_with_them(self, run: Run) -> None:
        (model,) = run.models
        assert (model.status, model.robot, model.id) == ("checked", "ur", "urdf/arm.urdf.xacro")
        assert model.args == {"name": "ur", "type": "large", "prefix": ""}
        assert not [f for f in run.findings if f.code in {"XAC001", "XAC010"}]

    def test_the_report_says_where_they_come_from(self, run: Run) -> None:
        shown = " ".join(text.render(run).split())
        assert "expanded with name:=ur (" in shown
        assert "view.launch.py:6), type" not in shown
        assert run.models[0].found_args["type"].endswith("launch/view.launch.py:6")
        assert '"found_args": {\n        "name"' in render_json(run)

    def test_the_launch_file_that_is_checked_counts_first(self, tmp_path: Path) -> None:
        command = 'x = Command(["xacro ", get_package_share_directory("arm"), "/urdf/arm.urdf.xacro", " type:={} {}"])'
        launches = {f"{t}.launch.py": command.format(t, "name:=a prefix:=b") for t in ("large", "small")}
        package = make_package(tmp_path, launches).parents[1]
        for kind in ("large", "small"):
            (model,) = check(package / f"launch/{kind}.launch.py").models
            assert model.args["type"] == kind

    def test_what_is_given_counts(self, tmp_path: Path) -> None:
        make_package(tmp_path, {"view.launch.py": COMMAND})
        (model,) = check(tmp_path / "arm", arguments={"name": "mine", "type": "small"}).models
        assert (model.robot, dict(model.found_args).keys()) == ("mine", {"prefix"})

    def test_a_default_that_works_is_kept(self, tmp_path: Path) -> None:
        make_package(tmp_path, {"view.launch.py": COMMAND}, ARM.replace('default="none"', 'default="small"'))
        assert check(tmp_path / "arm").models[0].args == {"name": "ur", "prefix": ""}

    @pytest.mark.parametrize("kind", ["property", "macro"])
    @pytest.mark.parametrize(("passed", "status"), [("large", "checked"), ("tiny", "failed")])
    def test_a_default_without_which_something_is_defined_gives_way(
        self, tmp_path: Path, kind: str, passed: str, status: str
    ) -> None:
        made = '<xacro:property name="y" value="1"/>' if kind == "property" else '<xacro:macro name="m" params=""/>'
        used = '<link name="a${y}"/>' if kind == "property" else '<link name="a"/><xacro:m/>'
        text = (
            '<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:arg name="type" default="none"/>'
            f"<xacro:if value=\"${{'$(arg type)' == 'large'}}\">{made}</xacro:if>\n{used}</robot>"
        )
        make_package(tmp_path, {"view.launch.py": COMMAND.replace('"large"', f'"{passed}"')}, text)
        run = check(tmp_path / "arm")
        assert run.models[0].status == status
        assert ("type" in run.models[0].args) == (status == "checked")

    def test_a_value_that_does_not_help_is_not_used(self, tmp_path: Path) -> None:
        make_package(tmp_path, {"view.launch.py": COMMAND.replace('"large"', '"none"').replace('"small"', '"none"')})
        run = check(tmp_path / "arm")
        assert (run.models[0].status, "type" in run.models[0].args) == ("failed", False)
        (found,) = [f for f in run.findings if f.code == "XAC001"]
        assert found.message.endswith("which does not exist; known values: large, small")
        assert found.location.subject == "argument[type]"

    def test_the_robot_itself_may_read_an_argument_before_its_default(self, tmp_path: Path) -> None:
        make_package(tmp_path, {}, ARM.replace('default="none"', 'default="small"').replace("$(arg prefix)", ""))
        run = check(tmp_path / "arm")
        (info,) = run.models
        assert (info.status, info.robot, info.args) == ("checked", "arm", {"name": "arm"})
        assert info.found_args["name"].startswith(info.path)
        assert "expanded with name:=arm (" in " ".join(text.render(run).split())

    def test_of_two_such_defaults_the_first_one_counts(self, tmp_path: Path) -> None:
        twice = '<xacro:arg name="name" default="first"/><xacro:arg name="name" default="second"/><link name="base"/>'
        text = f'<robot name="$(arg name)" xmlns:xacro="http://www.ros.org/wiki/xacro">{twice}</robot>'
        assert check_text(tmp_path, text, name="a.urdf.xacro").models[0].args == {"name": "first"}

    def test_a_launch_file_that_passes_no_value_is_stopped(self, tmp_path: Path) -> None:
        model = ARM.replace('default="none"', 'default="small"').replace("$(arg prefix)", "")
        command = 'x = Command(["xacro ", get_package_share_directory("arm"), "/urdf/arm.urdf.xacro"])'
        package = make_package(tmp_path, {"a.launch.py": command}, model).parents[1]
        run = check(package / "launch/a.launch.py")
        assert [(f.code, f.message_id) for f in run.findings if f.code == "XAC010"] == [("XAC010", "too-late")]

    def test_choices_are_told_where_no_launch_file_decides(self, tmp_path: Path) -> None:
        model = ARM.replace('  <xacro:arg name="type" default="none"/>\n', "").replace("$(arg name)", "arm")
        make_package(tmp_path, {}, model)
        (found,) = [f for f in check(tmp_path / "arm").findings if f.code == "XAC010"]
        assert found.message.endswith("was not given, so the model cannot be expanded; known values: large, small")
        assert found.fix is not None
        assert "--arg type:=large --arg prefix:=…" in found.fix.title


BOTH = '<buildtool_depend condition="$ROS_VERSION == 1">catkin</buildtool_depend>' + (
    '<buildtool_depend condition="$ROS_VERSION == 2">ament_cmake</buildtool_depend>'
)


@pytest.mark.parametrize(
    ("built", "shell", "expected"),
    [
        ("<buildtool_depend>catkin</buildtool_depend>", {}, "1 noetic 3"),
        ("<export><build_type>ament_cmake</build_type></export>", {}, "2 jazzy 3"),
        (BOTH, {}, "2 jazzy 3"),
        ("", {}, "2 jazzy 3"),
        ("", {"ROS_DISTRO": "noetic"}, "1 noetic 3"),
        (BOTH, {"ROS_VERSION": "1"}, "1 noetic 3"),
        (BOTH, {"ROS_DISTRO": "humble", "ROS_PYTHON_VERSION": "2"}, "2 humble 2"),
    ],
)
def test_a_variable_that_every_shell_of_ros_sets_has_a_value(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, built: str, shell: dict[str, str], expected: str
) -> None:
    for name in ("ROS_DISTRO", "ROS_VERSION", "ROS_PYTHON_VERSION"):
        monkeypatch.delenv(name, raising=False)
    for name, value in shell.items():
        monkeypatch.setenv(name, value)
    path = tmp_path / "robot.urdf.xacro"
    (tmp_path / "package.xml").write_text(f'<package format="3"><name>arm</name>{built}</package>', encoding="utf-8")
    read = "$(env ROS_VERSION) $(env ROS_DISTRO) $(env ROS_PYTHON_VERSION)"
    path.write_text(f'<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="{read}"><link name="base"/></robot>')
    run = check(path, codes={"XAC001"})
    assert not run.findings
    assert [info.robot for info in run.models] == [expected]


def test_the_other_version_of_ros_is_checked_too(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("ROS_DISTRO", "ROS_VERSION"):
        monkeypatch.delenv(name, raising=False)
    path = tmp_path / "robot.urdf.xacro"
    first = '<xacro:if value="${version == 1}"><link name="a"/><link name="a"/></xacro:if>'
    version = '<xacro:property name="version" value="$(env ROS_VERSION)"/><link name="base"/>'
    path.write_text(f'<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="r">{version}{first}</robot>')
    run = check(path, codes={"KIN001", "XAC001", "XAC016"})
    assert [f.code for f in run.findings] == ["XAC016", "KIN001"]
    assert run.findings[0].data["listed"] == "ROS_VERSION is 2"
    assert [dict(info.args) for info in run.models] == [{"env:ROS_VERSION": "2"}, {"env:ROS_VERSION": "1"}]


def test_a_variable_of_the_robot_is_not_guessed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("ROBOT_SIDE", raising=False)
    path = tmp_path / "robot.urdf.xacro"
    path.write_text('<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="$(env ROBOT_SIDE)"/>')
    (unread,) = check(path, codes={"XAC001"}).findings
    assert unread.message_id == "environment-unread"
    (unset,) = check(path, codes={"XAC001"}, environment=frozenset({"ROBOT_SIDE"})).findings
    assert (unset.message_id, unset.data["name"]) == ("environment", "ROBOT_SIDE")


@pytest.mark.parametrize(
    ("file", "text", "found"),
    [
        ("README.md", "    xacro urdf/arm.urdf.xacro name:=ur > arm.urdf\n", {"name": ("ur", 1)}),
        (
            "README.md",
            "ros2 run xacro xacro arm.urdf.xacro \\\n  name:='' prefix:=\"a_\"\n",
            {"name": ("", 2), "prefix": ("a_", 2)},
        ),
        ("run.sh", "xacro arm.urdf.xacro name:=$1 type:=<type> a:=${b}\n", {}),
        ("run.sh", "xacro arm.urdf.xacro; roslaunch arm a.launch name:=ur\n", {}),
        ("README.md", "roslaunch arm a.launch model:=arm.urdf.xacro name:=ur\n", {}),
        ("README.md", "xacro other_arm.urdf.xacro name:=ur\n", {}),
        (
            "CMakeLists.txt",
            "xacro_add_xacro_file(\n  urdf/arm.urdf.xacro arm.urdf\n  name:=ur)\nset(x type:=y)\n",
            {"name": ("ur", 3)},
        ),
    ],
)
def test_commands_in_other_files_of_the_package(
    file: str, text: str, found: dict[str, tuple[str, int]], tmp_path: Path
) -> None:
    model = make_package(tmp_path, {})
    (model.parents[1] / file).write_text(text)
    written = find_written_arguments(model, PackageFinder(model))
    assert {a.name: (a.value, a.location.span.line if a.location.span else 0) for a in written.values()} == found


def test_a_launch_file_comes_before_other_files(tmp_path: Path) -> None:
    param = '<param name="robot_description" command="xacro $(find arm)/urdf/arm.urdf.xacro name:=b"/>'
    text = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><link name="$(arg name)$(arg type)"/></robot>'
    model = make_package(tmp_path, {"a.launch": f"<launch>{param}</launch>"}, text)
    (model.parents[1] / "README.md").write_text("xacro urdf/arm.urdf.xacro name:=a type:=c\n")
    assert check(model).models[0].args == {"name": "b", "type": "c"}
