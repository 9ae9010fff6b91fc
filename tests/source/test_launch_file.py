"""Launch files: which model they load with which arguments, as far as that is known without launching anything."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest

from urdfcheck.source.launch import python_launch_file
from urdfcheck.source.launch.around.passing_files import find_passing_files
from urdfcheck.source.launch.launch_file import DescriptionSource, Launch, is_included_by_sibling, load_launch
from urdfcheck.source.launch.python_launch_file import read_python_launch
from urdfcheck.source.launch.substitutions import UnresolvedReason, evaluate_condition, may_become
from urdfcheck.source.package.finder import PackageFinder


@pytest.fixture
def package(tmp_path: Path) -> Path:
    """A package with two models."""
    folder = tmp_path / "src" / "car"
    for name in ("urdf/car.urdf.xacro", "urdf/car.urdf", "urdf/wheels/wheel.urdf"):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text('<robot name="car"/>')
    (folder / "package.xml").write_text("<package><name>car</name></package>")
    (folder / "launch").mkdir()
    return folder


def launch(package: Path, text: str | bytes, name: str = "car.launch") -> Launch:
    path = package / "launch" / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return load_launch(path, PackageFinder(path, environment={}))


def description(package: Path, text: str) -> DescriptionSource:
    """The one robot_description of a launch file with these elements."""
    loaded = launch(package, f"<launch>\n{text}\n</launch>")
    (found,) = loaded.descriptions
    return found


def param(command: str) -> str:
    return f'<param name="robot_description" command="{command}"/>'


LOADS_CAR = param("xacro $(find car)/urdf/car.urdf")


# -- ROS 1 -------------------------------------------------------------------------------------------------------------


def test_ros_1_a_command_names_the_model_and_its_arguments(package: Path) -> None:
    loaded = launch(
        package,
        """<launch>
          <arg name="arm" default="ur5"/>
          <group ns="robot">
            <param name="robot_description"
                   command="$(find xacro)/xacro --inorder '$(find car)/urdf/car.urdf.xacro' arm:=$(arg arm) size:='1 2'"/>
          </group>
        </launch>""",
    )
    (found,) = loaded.descriptions
    assert loaded.dialect == "ros1"
    assert found.path == package / "urdf/car.urdf.xacro"
    assert found.file == "$(find car)/urdf/car.urdf.xacro"
    assert found.arguments == {"arm": "ur5", "size": "1 2"}
    assert found.unresolved is None
    assert "--inorder" in found.words
    assert found.at.span is not None
    assert (found.at.span.line, found.at.location.subject) == (5, "group/param[robot_description]@command")


@pytest.mark.parametrize(
    "element",
    [
        '<param name="robot_description" textfile="$(find car)/urdf/car.urdf"/>',
        '<param name="/left/robot_description" textfile="$(dirname)/../urdf/car.urdf"/>',
        param("cat '$(find car)/urdf/car.urdf'"),
        param("rosrun xacro xacro $(find car)/urdf/car.urdf"),
        '<arg name="model" value="$(find car)/urdf/car.urdf"/>' + param("$(find xacro)/xacro.py $(arg model)"),
        '<arg name="dir" default="$(find car)/urdf"/><arg name="model" default="$(arg dir)/car.urdf"/>'
        + param("xacro $(arg model)"),
    ],
)
def test_a_model_is_found_in_every_way_to_name_it(package: Path, element: str) -> None:
    path = description(package, element).path
    assert path is not None
    assert path.resolve() == package / "urdf/car.urdf"


def test_other_parameters_load_no_model(package: Path) -> None:
    loaded = launch(
        package,
        """<launch>
          <param name="use_gui" value="true"/>
          <param name="robot_description_file" textfile="$(find car)/urdf/car.urdf"/>
          <param name="robot_description" value="&lt;robot/>"/>
          <param name="robot_description" command=""/>
        </launch>""",
    )
    assert loaded.descriptions == ()
    assert loaded.problems == ()


@pytest.mark.parametrize(
    "element",
    [
        param("$(find car)/scripts/make_urdf.py"),
        '<param name="robot_description" value="$(var text)"/>',
        '<arg name="text" default="$(env TEXT)"/><param name="robot_description" value="$(var text)"/>',
    ],
)
def test_a_model_that_only_the_launch_makes_is_told(package: Path, element: str) -> None:
    found = description(package, element)
    assert found.path is None
    assert found.unresolved is not None


@pytest.mark.parametrize(
    "condition", ['if="false"', 'if="0"', 'unless="$(arg sim)"', 'unless="true"', 'if="$(eval 1)" unless="1"']
)
def test_what_a_condition_rules_out_is_not_loaded(package: Path, condition: str) -> None:
    node = '<node name="t" pkg="tf" type="static_transform_publisher" args="0 0 0 0 0 0 a b"/>'
    text = f'<arg name="sim" default="true"/><group {condition}>{param("xacro no.urdf")}{node}</group>'
    text += f'<param {condition} name="robot_description" textfile="no.urdf"/>'
    loaded = launch(package, f"<launch>{text}</launch>")
    assert (loaded.descriptions, loaded.transforms) == ((), ())


@pytest.mark.parametrize(
    ("expression", "value"),
    [
        ("arm == 'ur5'", True),
        ("'/' not in arm", True),
        ("arg('arm') in ['ur3', 'panda'] or not sim", False),
        ("sim and rate > 5", True),
        ("sim == 'true'", False),  # roslaunch hands over True
        ("gone == 1", None),
        ("arm > 3", None),
        ("exists(arm)", None),
        ("arm ==", None),
    ],
)
def test_a_comparison_of_known_arguments_is_decided(expression: str, value: bool | None) -> None:
    values = {"arm": "ur5", "sim": "true", "rate": "10.0"}
    assert evaluate_condition(expression, values.get) is value


# -- included launch files ---------------------------------------------------------------------------------------------


def write_upload(package: Path, text: str, name: str = "upload.launch") -> None:
    (package / "launch" / name).write_text(f"<launch>{text}</launch>")


def test_an_included_launch_file_is_followed_with_its_arguments(package: Path) -> None:
    write_upload(
        package, '<arg name="model"/><arg name="arm" default="0"/>' + param("xacro $(arg model) arm:=$(arg arm)")
    )
    found = description(
        package,
        """<arg name="dir" default="$(find car)/urdf"/>
        <include file="$(find car)/launch/upload.launch">
          <arg name="model" value="$(arg dir)/car.urdf"/><arg name="arm" value="1"/>
        </include>""",
    )
    assert found.path == package / "urdf/car.urdf"
    assert found.arguments == {"arm": "1"}
    assert found.is_from_include
    assert found.at.span is not None
    assert found.at.span.file.endswith("upload.launch")
    assert [span.line for span in found.at.location.via] == [3]


@pytest.mark.parametrize(
    ("include", "known"),
    [
        ('<include file="$(dirname)/upload.launch"/>', False),
        ('<include file="$(dirname)/upload.launch" pass_all_args="true"/>', True),
        ('<include file="$(dirname)/upload.launch"><arg name="other" value="$(var model)"/></include>', True),
    ],
)
def test_ros_1_hands_on_what_it_is_told_to_and_ros_2_everything(package: Path, include: str, known: bool) -> None:
    write_upload(package, '<arg name="model"/>' + param("xacro $(arg model)"))
    found = description(package, f'<arg name="model" default="$(find car)/urdf/car.urdf"/>{include}')
    assert (found.path is not None) == known


def test_included_files_that_cannot_be_read_or_known_are_left_out(package: Path) -> None:
    (package / "launch/broken.launch").write_text("<launch>")
    (package / "launch/p.launch.py").write_text("pass")
    names = ("broken.launch", "p.launch.py", "no.launch")
    text = "".join(f'<include file="$(dirname)/{name}"/>' for name in names)
    text += '<include file="$(env A)"/><include file=""/><include/><include if="0" file="$(dirname)/car.launch"/>'
    loaded = launch(package, f"<launch>{text}</launch>")
    assert (loaded.descriptions, loaded.problems) == ((), ())


def test_launch_files_that_include_each_other_end_soon(package: Path) -> None:
    again = '<include file="$(dirname)/{}"><arg name="x" value="$(arg x)+"/></include>'
    write_upload(package, again.format("upload.launch") * 2 + again.format("car.launch"))
    body = again.format("upload.launch") + again.format("car.launch") * 2
    loaded = launch(package, f'<launch><arg name="x" default="1"/>{LOADS_CAR}{body}</launch>')
    assert {d.path for d in loaded.descriptions} == {package / "urdf/car.urdf"}
    assert len(loaded.descriptions) < 100


def test_the_first_definition_of_an_argument_that_applies_counts(package: Path) -> None:
    text = """
      <arg name="big" default="false"/>
      <arg name="size" value="1" if="$(arg big)"/>
      <group unless="true"><arg name="size" value="2"/></group>
      <arg name="size" value="3" unless="$(arg big)"/>
      <arg name="size" value="4"/>
      <include file="other.launch"><arg name="big" value="true"/></include>
    """
    found = description(package, text + param("xacro $(find car)/urdf/car.urdf s:=$(arg size) b:=$(arg big)"))
    assert found.arguments == {"s": "3", "b": "false"}


@pytest.mark.parametrize(
    ("path", "obstacle"),
    [
        ("$(find cars)/urdf/car.urdf", UnresolvedReason("package", "cars")),
        ("$(arg model)", UnresolvedReason("argument", "model")),
        ("$(arg round)", UnresolvedReason("circle")),
        ("$(env HOME)/car.urdf", UnresolvedReason("launch-time", "env HOME")),
        ("$(eval arg('a') + '.urdf')", UnresolvedReason("launch-time", "eval arg('a') + '.urdf')")),
        ("$(arg many)", UnresolvedReason("launch-time", "find car)" + "/$(find car)" * 5 + "/$(find ca")),
    ],
)
def test_what_stands_in_the_way_of_a_path_is_said(package: Path, path: str, obstacle: UnresolvedReason) -> None:
    text = '<arg name="model"/><arg name="round" default="$(arg trip)"/><arg name="trip" default="$(arg round)"/>'
    text += f'<arg name="many" default="{"$(find car)/" * 2000}"/>'
    found = description(package, f'{text}<param name="robot_description" textfile="{path}"/>')
    assert found.path is None
    assert found.unresolved == obstacle or found.unresolved.kind == obstacle.kind == "launch-time"


def test_a_missing_file_is_named_by_its_path(package: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(package)
    for name in ("no.urdf", "x" * 300 + ".urdf"):
        found = description(package, f'<param name="robot_description" textfile="$(find car)/{name}"/>')
        assert (found.path, found.unresolved) == (None, UnresolvedReason("file", name))


def test_an_argument_that_cannot_be_known_is_left_to_the_models_default(package: Path) -> None:
    found = description(package, param("xacro $(find car)/urdf/car.urdf a:=$(env A) b:=1"))
    assert found.arguments == {"b": "1"}
    assert found.path == package / "urdf/car.urdf"


@pytest.mark.parametrize("depth", [60])
def test_arguments_that_multiply_each_other_end_soon(package: Path, depth: int) -> None:
    for seed, kind in (("", "empty"), ("x", "launch-time")):
        rows = (
            "".join(f'<arg name="a{n}" default="{f"$(arg a{n + 1})" * 10}"/>' for n in range(depth))
            + f'<arg name="a{depth}" default="{seed}"/>'
        )
        found = description(package, rows + '<param name="robot_description" textfile="$(arg a0)"/>')
        assert found.unresolved is not None
        assert found.unresolved.kind == kind


def test_a_folder_named_like_a_substitution_is_no_trap(tmp_path: Path) -> None:
    path = tmp_path / "$(dirname)" / "a.launch"
    path.parent.mkdir()
    path.write_text('<launch><param name="robot_description" textfile="$(dirname)/a.urdf"/></launch>')
    (found,) = load_launch(path, PackageFinder(path, environment={})).descriptions
    assert found.unresolved is not None
    assert found.unresolved.kind == "launch-time"


@pytest.mark.parametrize(
    ("default", "word", "value"),
    [
        ("'0 0 3'", "xyz:=$(arg a)", "0 0 3"),
        ("&quot;0 0 3&quot;", "xyz:=$(arg a)", "0 0 3"),
        ("'0 0 3'", "xyz:=$(arg b)", "0 0 3"),
        ("'0 0 3'", "xyz:=&quot;$(arg a)&quot;", "'0 0 3'"),
        ("0 0 3", "xyz:='$(arg a)'", "0 0 3"),
    ],
)
def test_the_quotes_of_an_argument_are_taken_away_where_the_command_is_split(
    package: Path, default: str, word: str, value: str
) -> None:
    arguments = f'<arg name="a" default="{default}"/><arg name="b" default="$(arg a)"/>'
    found = description(package, arguments + param(f"xacro $(find car)/urdf/car.urdf.xacro {word}"))
    assert found.arguments == {"xyz": value}


def test_a_command_whose_quotes_do_not_close_leads_to_no_model(package: Path) -> None:
    found = description(package, param("xacro '$(find car)/urdf/car.urdf a:=1"))
    assert found.path is None
    assert found.unresolved is not None
    assert found.unresolved.kind == "file"


# -- ROS 2 -------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "command",
    [
        "$(command 'xacro $(find-pkg-share car)/urdf/car.urdf.xacro arm:=$(var arm)')",
        "$(command 'xacro $(find-pkg-share $(var pkg))/urdf/car.urdf.xacro arm:=ur5' 'warn')",
        "$(command 'ros2 run xacro xacro $(find-pkg-share car)/urdf/car.urdf.xacro arm:=ur5')",
        "\n  $(command 'xacro\n  $(find-pkg-share car)/urdf/car.urdf.xacro\n  arm:=ur5')\n",
    ],
)
def test_ros_2_a_command_substitution_names_the_model_and_its_arguments(package: Path, command: str) -> None:
    loaded = launch(
        package,
        f"""<launch>
          <arg name="arm" default="ur5"/>
          <let name="pkg" value="car"/>
          <node pkg="robot_state_publisher" exec="robot_state_publisher">
            <param name="robot_description" value="{command}"/>
          </node>
        </launch>""",
        "car.launch.xml",
    )
    (found,) = loaded.descriptions
    assert loaded.dialect == "ros2"
    assert found.path == package / "urdf/car.urdf.xacro"
    assert found.arguments == {"arm": "ur5"}
    assert found.at.location.subject == "node/param[robot_description]@value"


@pytest.mark.parametrize(
    "definition",
    [
        '<let name="rd" value="{}"/>',
        '<arg name="rd" default="{}"/>',
        '<let name="text" value="{}"/><let name="rd" value="$(var text)"/>',
    ],
)
def test_ros_2_a_variable_holds_the_description(package: Path, definition: str) -> None:
    text = definition.format("$(command 'xacro $(find-pkg-share car)/urdf/car.urdf')")
    found = description(package, text + '<param name="robot_description" value="$(var rd)"/>')
    assert found.path == package / "urdf/car.urdf"
    assert found.at.owner.tag in {"let", "arg"}


def test_ros_2_variables_in_a_circle_end(package: Path) -> None:
    text = '<let name="a" value="$(var b)"/><let name="b" value="$(var a)"/>'
    found = description(package, text + '<param name="robot_description" value="$(var a)"/>')
    assert found.unresolved == UnresolvedReason("circle")


# -- what is started beside the model ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("node", "xyz", "rpy", "quaternion"),
    [
        ('type="static_transform_publisher" args="1 2 3 0.1 0.2 0.3 base foot 40"', (1, 2, 3), (0.3, 0.2, 0.1), None),
        ('type="static_transform_publisher" args="1 2 3 0.1 0.2 0.3 /base /foot"', (1, 2, 3), (0.3, 0.2, 0.1), None),
        ('type="static_transform_publisher" args="1 2 3 0 0 0 1 base foot 40"', (1, 2, 3), None, (0, 0, 0, 1)),
        ('type="static_transform_publisher" args="1 2 3 0 0 0 1 base foot"', (1, 2, 3), None, (0, 0, 0, 1)),
        ('type="static_transform_publisher" args="$(arg x) 2 3 0 0 0 base foot"', (1, 2, 3), (0, 0, 0), None),
        ('type="static_transform_publisher" args="$(env X) 2 3 0 0 0 base foot"', None, None, None),
        (
            'exec="static_transform_publisher" args="--x 1 --y -2 --yaw 0.1 --frame-id base --child-frame-id foot"',
            (1, -2, 0), (0, 0, 0.1), None,
        ),
        (
            'exec="static_transform_publisher" args="--qz 1 --qw 0 --frame-id base --child-frame-id foot --ros-args"',
            (0, 0, 0), None, (0, 0, 1, 0),
        ),
        (
            'exec="static_transform_publisher" args="--x $(env X) --frame-id base --child-frame-id foot"',
            None, None, None,
        ),
    ],
)  # fmt: skip
def test_a_static_transform_is_read_in_all_its_spellings(
    package: Path, node: str, xyz: object, rpy: object, quaternion: object
) -> None:
    loaded = launch(package, f'<launch><arg name="x" default="1"/><node name="n" pkg="tf2_ros" {node}/></launch>')
    (transform,) = loaded.transforms
    assert (transform.parent, transform.child) == ("base", "foot")
    assert (transform.xyz, transform.rpy, transform.quaternion) == (xyz, rpy, quaternion)
    assert transform.at.location.subject == "node[n]@args"


@pytest.mark.parametrize("args", ["", "1 2 3", "0 0 0 0 0 0 $(env A) foot", "--x 1", "'0 0 0 0 0 0 a"])
def test_a_static_transform_without_both_frames_is_left_out(package: Path, args: str) -> None:
    node = f'<node name="n" pkg="tf" type="static_transform_publisher" args="{args}"/>'
    assert launch(package, f"<launch>{node}</launch>").transforms == ()


def test_nodes_and_own_arguments_are_listed_wherever_they_stand(package: Path) -> None:
    loaded = launch(
        package,
        """<launch>
          <arg name="a"/>
          <include file="x"><arg name="b" value="1"/></include>
          <group><arg name="c"/><node name="n"/></group>
        </launch>""",
    )
    assert [e.get("name") for e in loaded.arguments] == ["a", "c"]
    assert [e.get("name") for e in loaded.nodes] == ["n"]
    assert loaded.package is not None
    assert loaded.package.name == "car"


@pytest.mark.parametrize(
    ("text", "kind"),
    [("<launch>", "malformed"), (b"<launch>\xff</launch>", "encoding"), ("<!DOCTYPE a []><launch/>", "doctype")],
)
def test_a_broken_launch_file_is_a_problem_with_its_place(package: Path, text: str | bytes, kind: str) -> None:
    loaded = launch(package, text)
    (problem,) = loaded.problems
    assert (problem.kind, loaded.root, loaded.descriptions) == (kind, None, ())
    assert problem.location.span is not None
    assert problem.location.span.file.endswith("car.launch")


def test_a_launch_file_that_cannot_be_opened_is_a_problem(tmp_path: Path) -> None:
    loaded = load_launch(tmp_path / "no.launch", PackageFinder(tmp_path, environment={}))
    assert [p.kind for p in loaded.problems] == ["unreadable"]


# -- Python ------------------------------------------------------------------------------------------------------------


def python(package: Path, text: str) -> list[Path]:
    path = package / "launch" / "car.launch.py"
    path.write_text(text)
    found = list(read_python_launch(path, PackageFinder(path, environment={})).models)
    return [p.relative_to(package) for p in found]


@pytest.mark.parametrize(
    "code",
    [
        "model = 'urdf/car.urdf'",
        "model = share + '/urdf/car.urdf'",
        "model = 'car.urdf'",
        "model = os.path.join(get_package_share_directory('car'), 'urdf', 'car.urdf')",
        "model = PathJoinSubstitution([FindPackageShare('car'), 'urdf', 'car.urdf'])",
        "model = Path(share) / 'urdf' / 'car.urdf'",
        "model = f(a, b=['xacro ', os.path.join(p, 'urdf/car.urdf')])",
    ],
)
def test_python_a_literal_path_names_a_model(package: Path, code: str) -> None:
    assert python(package, code) == [Path("urdf/car.urdf")]


def test_python_a_joined_path_is_one_path(package: Path) -> None:
    (package / "urdf/wheel.urdf").write_text("<robot/>")
    assert python(package, "os.path.join(p, 'urdf', 'wheels', 'wheel.urdf')") == [Path("urdf/wheels/wheel.urdf")]


def test_python_a_model_of_another_package_is_found_by_the_packages_name(package: Path) -> None:
    other = package.parent / "bringup"
    (other / "launch").mkdir(parents=True)
    (other / "package.xml").write_text("<package><name>bringup</name></package>")
    path = other / "launch" / "all.launch.py"
    path.write_text("d = get_package_share_directory('car')\nm = os.path.join(d, 'urdf', 'car.urdf')")
    assert list(read_python_launch(path, PackageFinder(path, environment={})).models) == [package / "urdf/car.urdf"]


def test_python_each_model_is_named_once_and_what_does_not_exist_is_left_out(package: Path) -> None:
    (package / "build").mkdir()
    (package / "build/old.urdf").write_text("<robot/>")
    code = "a = 'car.urdf'; b = 'urdf/car.urdf'; c = 'no.urdf'; d = '*.urdf'; e = 'old.urdf'; f = '\\ud800.urdf'; g = '.urdf'"
    assert python(package, code + f"; h = '{'x' * 290}.urdf'") == [Path("urdf/car.urdf")]


def test_python_nothing_is_executed_and_nothing_is_printed(package: Path, recwarn: pytest.WarningsRecorder) -> None:
    code = r"open('written', 'w'); raise SystemExit; x = '\d' is 'car.urdf'"
    assert python(package, code) == [Path("urdf/car.urdf")]
    assert not Path("written").exists()
    assert [str(w.message) for w in recwarn] == []


@pytest.mark.parametrize("code", ["def f(:", "\0", "(" * 5000, "x = " + "-" * 100000 + "1"])
def test_python_that_cannot_be_parsed_names_no_model(package: Path, code: str) -> None:
    assert python(package, code) == []


def read(package: Path, text: str) -> tuple[list[str], list[str], str | None]:
    """Of a Python launch file: the missing paths with the text pointed at, unknown ones, and why it is broken."""
    loaded = launch(package, text, "car.launch.py")
    python = loaded.python
    assert python is not None
    source = python.file
    assert source is not None
    shown = []
    for named in python.missing_models:
        span = named.location.span
        assert span is not None
        shown.append(f"{Path(named.path).relative_to(package)} {source.text[span.start : span.end]}")
    return (
        shown,
        [n.path for n in python.unknown_models],
        None if python.syntax_problem is None else python.syntax_problem.kind,
    )


ASKED = "m = os.path.join(get_package_share_directory('car'), 'urdf', 'bott.urdf.xacro')"


@pytest.mark.parametrize(
    "code",
    [
        "d = get_package_share_directory('car')\nm = os.path.join(d, 'urdf', 'bott.urdf.xacro')",
        "m = os.path.join(get_package_share_directory('car'), 'urdf/bott.urdf.xacro')",
        "m = PathJoinSubstitution([FindPackageShare('car'), 'urdf', 'bott.urdf.xacro'])",
        "m = Path(get_package_share_path('car')) / 'urdf' / 'bott.urdf.xacro'",
        "m = 'é', f'{get_package_share_directory(\"car\")}/urdf/bott.urdf.xacro'",
        "m = FindPackageShare(package='car').find('car') + '/urdf/bott.urdf.xacro'",
        "s = FindPackageShare('car').find('car')\nn = 'bott.urdf.xacro'\nm = os.path.join(s, 'urdf', n)",
        f"{ASKED}\nif not os.path.exists(m):\n  raise FileNotFoundError(m)",
    ],
)
def test_python_a_path_in_a_known_package_is_missing(package: Path, code: str) -> None:
    (shown,), unknown, broken = read(package, code)
    assert shown.startswith("urdf/bott.urdf.xacro ")
    assert shown.endswith(("bott.urdf.xacro'", " 'urdf'"))  # where the last text of the path is typed
    assert (unknown, broken) == ([], None)


@pytest.mark.parametrize(
    "code",
    [
        "m = os.path.join(get_package_share_directory('elsewhere'), 'urdf', x)",
        "m = os.path.join(get_package_share_directory('car'), 'gen', 'car.urdf.xacro')",  # installed there, maybe
        "m = os.path.join(get_package_share_directory('car'), 'urdf', 'built.urdf')",  # CMakeLists.txt makes it
        "m = os.path.join(get_package_share_directory('car'), 'urdf', name + '.urdf')",
        "n = 'a'\nn = 'b'\nm = os.path.join(get_package_share_directory('car'), n + '.urdf')",
        "def f(n):\n  return get_package_share_directory('car') + '/%s.urdf' % n",
        "m = f'{prefix}_arm.urdf'; k = '{}.urdf'.format(1); g = '/tmp/x.urdf'; h = 'xacro a.urdf'; i = '.urdf'",
        "a = a + '/x.urdf'\nb = c + c\nc = b + 'x.urdf'",
        f"{ASKED}\nt = process_file(m) if os.path.exists(m) else ''",
        f"{ASKED}\nif not Path(m).is_file():\n  print(m)",
    ],
)
def test_python_what_cannot_be_known_is_not_called_missing(package: Path, code: str) -> None:
    (package / "CMakeLists.txt").write_text("xacro_add_files(built.urdf)")
    assert read(package, code) == ([], [], None)


def test_python_a_relative_path_that_nothing_is_found_for_is_unknown(package: Path) -> None:
    assert read(package, "m = os.path.join(d, 'urdf/bott.urdf.xacro')") == ([], ["urdf/bott.urdf.xacro"], None)
    assert read(package, "m = 'urdf/bott.urdf.xacro'; n = 'urdf/car.urdf'") == ([], [], None)


@pytest.mark.parametrize("code", ["def f(:", "\0", "(" * 5000, "x = " + "-" * 100000 + "1", "", "x = (\n"])
def test_python_that_cannot_be_parsed_is_told_with_its_place(package: Path, code: str) -> None:
    loaded = launch(package, code, "car.launch.py")
    assert loaded.python is not None
    broken = loaded.python.syntax_problem
    assert (broken is None) == (code == "")
    assert broken is None or broken.location.span is not None


def test_a_python_launch_file_is_loaded_without_being_run(package: Path) -> None:
    loaded = launch(package, "raise SystemExit", "car.launch.py")
    assert (loaded.dialect, loaded.root, loaded.problems, loaded.nodes, loaded.arguments) == (
        "python",
        None,
        (),
        [],
        [],
    )
    assert loaded.location.span is not None


def test_python_more_paths_than_anybody_names_are_not_looked_up(package: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(python_launch_file, "MAX_PATHS", 2)
    path = package / "launch" / "many.launch.py"
    finder = PackageFinder(path, environment={})
    path.write_text("x = 'a.urdf'\ny = 'b.urdf'\nz = 'a.urdf'\n")
    assert [named.path for named in read_python_launch(path, finder).unknown_models] == ["a.urdf", "b.urdf"]
    path.write_text("x = 'a.urdf'\ny = 'b.urdf'\nz = 'car.urdf'\n")
    assert [named.path for named in read_python_launch(path, finder).unknown_models] == ["a.urdf", "b.urdf"]
    path.write_text("x = 'a.urdf'\ny = 'car.urdf'\nz = 'wheel.urdf'\n")
    assert [model.name for model in read_python_launch(path, finder).models] == ["car.urdf"]


@pytest.mark.skipif(sys.platform == "win32", reason="no such files there")
def test_a_pipe_beside_a_launch_file_is_not_waited_for(package: Path) -> None:
    loaded = launch(package, "<launch/>")
    os.mkfifo(loaded.path.parent / "a.launch")
    assert not is_included_by_sibling(loaded.path)
    (loaded.path.parent / "b.launch").write_text(f'<launch><include file="{loaded.path.name}"/></launch>')
    assert is_included_by_sibling(loaded.path)


def test_a_launch_file_that_is_nested_too_deeply_is_a_problem_with_what_it_is(package: Path) -> None:
    (problem,) = launch(package, "<launch>" + "<group>" * 300).problems
    assert (problem.kind, problem.data["what"]) == ("too-large", "depth")


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"# -*- coding: utf-7 -*-\n# +AAo-p = 'robot.urdf'\n", "it declares the encoding 'utf-7', in which"),
        (
            b"#" + b" " * 1_000 + b"\n# coding: utf-7\n# +AAo-p = 'robot.urdf'\n",
            "it declares the encoding 'utf-7', in which",
        ),
        (b"# coding: klingon\n", "unknown encoding: klingon"),
        ("# coding: latin-1\np = 'ä'\n".encode("latin-1"), None),
        ("# coding: gbk\np = 'a'\n".encode("gbk"), None),
        ("p = 'ä'\n".encode("latin-1"), "can't decode byte"),
    ],
)
def test_a_python_file_is_read_as_python_reads_it(package: Path, data: bytes, message: str | None) -> None:
    loaded = launch(package, data, "car.launch.py")
    assert loaded.python is not None
    problem = loaded.python.syntax_problem
    assert (problem is None) == (message is None)
    assert problem is None or message in problem.message


@pytest.mark.parametrize(
    ("typed", "text", "may"),
    [
        ("$(arg robot)_ip", "ur5_ip", True),
        ("$(arg robot)_ip", "ur5_port", False),
        ("[a]", "a", False),
        # As a regular expression this would not end.
        ("$(arg a)" * 60 + "_b", "gazebo_simulation_bringup.launch", False),
    ],
)
def test_a_text_with_substitutions_may_become_another(typed: str, text: str, may: bool) -> None:
    assert may_become(typed, text) is may


def test_includes_that_are_not_closed_take_no_time(package: Path) -> None:
    passing = '<include file="arm.launch"><arg name="a" value="2"/></include>'
    launch(package, passing + "<include a>" * 40_000, "all.launch")
    loaded = launch(package, '<launch><arg name="a" default="1"/></launch>', "arm.launch")
    assert [path.name for path in find_passing_files(loaded, "a")] == ["all.launch"]
