"""Launch files."""

from __future__ import annotations

from pathlib import Path

import pytest
from builders import find
from conftest import FIXTURES, check

from urdfcheck.core import Finding, Run, Severity, SkippedCheck
from urdfcheck.rules import load_rules

pytestmark = pytest.mark.slow

LOAD = '<param name="robot_description" textfile="$(find car)/urdf/car.urdf"/>'
CAR = """<robot name="car"><link name="base_link"><collision>{shape}</collision></link>
<link name="laser"/>
<joint name="mount" type="fixed"><parent link="base_link"/><child link="laser"/></joint></robot>"""
BOX = '<origin xyz="0 0 0.1" rpy="0.5235987755982988 0 0"/><geometry><box size="1 0.2 0.2"/></geometry>'


def find_in_launch(folder: Path, body: str, code: str) -> list[Finding]:
    """Return the findings of a launch file on its own."""
    return find(folder, f"<launch>{body}</launch>", code, name="robot.launch")


def find_in_package(folder: Path, body: str, code: str, shape: str = BOX, depend: str = "") -> list[Finding]:
    """Return the findings of a launch file in the package ``car`` that has a robot."""
    files = {
        "package.xml": f'<package format="2"><name>car</name>{depend}</package>',
        "urdf/car.urdf": CAR.format(shape=shape),
        "launch/car.launch": f"<launch>{body}</launch>",
    }
    return find(folder / "car", files, code, name="launch/car.launch")


def only(run: Run) -> list[Finding]:
    assert not run.failures
    return list(run.findings)


# -- LCH001 ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("path", "repair"),
    [
        ("q", "check out its submodule: `git submodule update --init q`, and declare it in package.xml"),
        (
            "l",
            "correct the package name, or install it, and declare it in package.xml; if a submodule that is not checked out",
        ),
    ],
)
def test_a_package_in_a_submodule_that_is_not_checked_out(tmp_path: Path, path: str, repair: str) -> None:
    (tmp_path / ".git").mkdir()
    (tmp_path / ".gitmodules").write_text(f'[submodule "a"]\n  path = {path}\n')
    (finding,) = find_in_package(tmp_path, load("$(find q)/r.urdf"), "LCH001")
    assert finding.fix is not None
    assert finding.fix.title.startswith(repair)
    depend = "<depend>q</depend>"
    (declared,) = find_in_package(tmp_path / "declared", load("$(find q)/r.urdf"), "LCH001", depend=depend)
    assert ("(the submodule of package 'q' is not checked out)" in declared.message) == (path == "q")


XACRO = '<param name="robot_description" command="$(find xacro)/xacro {}"/>'


def load(path: str) -> str:
    return f'<param name="robot_description" textfile="{path}"/>'


# The package is that of the robot which is named.
NAMED_BY_ROBOT = '<arg name="robot" default="{}"/><arg name="dollar" value="$"/>'
NAMED_BY_ROBOT += '<arg name="place" value="(find $(arg robot)_models)"/>'


@pytest.mark.parametrize(
    ("body", "message"),
    [
        (load("$(find car)/urdf/cra.urdf"), "file"),
        (load("$(find no_such_cart)/urdf/car.urdf"), "package"),
        (load("$(arg model)"), "argument"),
        (load("../urdf/car.urdf"), "relative"),
        (load("../urdf/cra.urdf"), "file"),
        ('<arg name="a" default="$(arg b)"/><arg name="b" default="$(arg a)"/>' + load("$(arg a)"), "circle"),
        ('<arg name="model"/>' + load("$(arg model)"), "unknown"),
        (load("$(env HOME)/car.urdf"), "unknown"),
        (load("$(eval find('car') + '/urdf/car.urdf')"), "unknown"),
        (f'<group if="false">{load("$(find car)/urdf/none.xacro")}</group>', None),
        (f'<arg name="sim" default="true"/><group unless="$(arg sim)">{load("none.xacro")}</group>', None),
        (f'<arg name="sim" default="true"/><group if="$(arg sim)">{load("none.xacro")}</group>', "file"),
        (LOAD, None),
        # The shell splits what an argument holds, unless it is quoted.
        (f'<arg name="m" default="$(find car)/urdf/car.urdf x:=1"/>{XACRO.format("$(arg m)")}', None),
        (f'<arg name="m" default="$(find car)/urdf/car.urdf x:=1"/>{XACRO.format("&apos;$(arg m)&apos;")}', "file"),
        (f'<arg name="m" default="&apos;$(find car)/urdf/car.urdf&apos; x:=1"/>{XACRO.format("$(arg m)")}', None),
        # An empty default is a value still to be given, where it is to be the name of the file.
        ('<arg name="m" default=""/><param name="robot_description" command="cat $(arg m)"/>', "unknown"),
        ('<arg name="m" default=""/>' + load("$(find car)/urdf/$(arg m)"), "unknown"),
        ('<arg name="m" default=""/>' + XACRO.format("$(find car)/urdf/$(arg m).urdf.xacro"), "unknown"),
        ('<arg name="m" default=""/>' + load("$(find car)/urdf/$(arg m)cra.urdf"), "file"),
        (load("$(find car)/urdf/"), "file"),
        (NAMED_BY_ROBOT.format("") + load("$(arg dollar)$(arg place)/car.urdf"), "unknown"),
        (NAMED_BY_ROBOT.format("bus") + load("$(arg dollar)$(arg place)/car.urdf"), "package"),
    ],
)
def test_why_a_description_cannot_be_loaded(tmp_path: Path, body: str, message: str | None) -> None:
    assert [f.message_id for f in find_in_package(tmp_path, body, "LCH001")] == ([] if message is None else [message])


@pytest.mark.parametrize(
    ("body", "message"),
    [
        (load("$(find car)/urdf\\car.urdf"), "backslash"),
        (load("$(find car)/urdf\\cra.urdf"), "file"),
        ('<include file="$(find car)/launch\\car.launch"/>', "include-backslash"),
    ],
)
def test_only_windows_finds_a_file_behind_a_backslash(tmp_path: Path, body: str, message: str) -> None:
    (finding,) = find_in_package(tmp_path, body, "LCH001")
    assert finding.message_id == message
    if message != "file":
        assert "only Windows reads backslashes as folder separators" in finding.message
        assert get_repair(finding) == "write `/` for each backslash"
        assert "except on Windows" in finding.consequences["roslaunch"]


def test_a_python_launch_file_may_name_a_model_behind_a_backslash(tmp_path: Path) -> None:
    name = 'os.path.join(get_package_share_directory("car"), "urdf\\\\car.urdf")'
    files = {
        "package.xml": "<package><name>car</name></package>",
        "urdf/car.urdf": CAR.format(shape=BOX),
        "launch/car.launch.py": f"robot_description = open({name}).read()\n",
    }
    (finding,) = find(tmp_path / "car", files, "LCH001", name="launch/car.launch.py")
    assert (finding.message_id, finding.severity) == ("backslash", Severity.WARNING)


def test_a_path_from_the_folder_of_the_launch_file_depends_on_where_that_is_started(tmp_path: Path) -> None:
    (finding,) = find_in_package(tmp_path, load("../urdf/car.urdf"), "LCH001")
    assert finding.severity == Severity.WARNING
    assert get_repair(finding) == "write `$(find car)/urdf/car.urdf`"
    assert finding.consequences["roslaunch"].endswith("car/launch")


@pytest.mark.parametrize(
    ("path", "command", "severity"),
    [
        ("$(arg model)", "", Severity.WARNING),
        ("$(find car)/urdf/$(arg model)", "", Severity.ERROR),
        ("$(find car)/urdf/$(arg model)", "roslaunch car car.launch gui:=1 model:=car.urdf", Severity.INFO),
        ("$(find car)/urdf/$(arg model)", "roslaunch car other.launch model:=car.urdf", Severity.ERROR),
        ("$(find car)/urdf/$(arg model)", "roslaunch car car.launch; car model:=car.urdf", Severity.ERROR),
    ],
)
def test_the_command_that_starts_a_launch_file_may_give_what_it_does_not_declare(
    tmp_path: Path, path: str, command: str, severity: Severity
) -> None:
    (tmp_path / "car" / "scripts").mkdir(parents=True)
    (tmp_path / "car" / "scripts" / "start.sh").write_text(command)
    (finding,) = find_in_package(tmp_path, load(path), "LCH001")
    assert finding.severity == severity
    ends = finding.consequences["roslaunch"].endswith(", unless its command line has model:=…")
    assert ends == (severity != Severity.INFO)


def test_a_folder_with_the_name_of_a_package_lacks_only_its_manifest(tmp_path: Path) -> None:
    (tmp_path / "CMakeLists.txt").write_text("cmake_minimum_required(VERSION 3.5)\nproject(sensors_of_car)\n")
    (finding,) = find_in_launch(tmp_path, load("$(find sensors_of_car)/urdf/lidar.urdf"), "LCH001")
    assert finding.message_id == "package"
    assert get_repair(finding).startswith("add a package.xml of this name beside ")
    (other,) = find_in_launch(tmp_path, load("$(find sensors_of_cart)/urdf/lidar.urdf"), "LCH001")
    assert get_repair(other).startswith("correct the package name")


def test_without_a_manifest_a_released_package_is_merely_not_installed(tmp_path: Path) -> None:
    (finding,) = find_in_launch(tmp_path, load("$(find pr2_description)/robots/pr2.urdf"), "LCH001")
    assert (finding.message_id, finding.severity) == ("unknown", Severity.INFO)


@pytest.mark.parametrize(
    ("name", "model", "readme", "message", "severity"),
    [
        ("pr2_description", False, "", "unknown", Severity.INFO),
        ("pr2_description", True, "", "package", Severity.WARNING),  # the line may be left from another robot's file
        ("arms", False, "", "package", Severity.ERROR),
        ("arms", False, "git clone https://h/u/arms", "unknown", Severity.INFO),
        ("arms", True, "git clone https://h/u/arms", "package", Severity.WARNING),
    ],
)
def test_a_package_that_can_be_had_elsewhere_is_not_declared_only(
    tmp_path: Path, name: str, model: bool, readme: str, message: str, severity: Severity
) -> None:
    files = {
        "package.xml": '<package format="2"><name>car</name></package>',
        "launch/car.launch": f"<launch>{load(f'$(find {name})/urdf/r.urdf')}</launch>",
        "README.md": readme,
    }
    files |= {"urdf/car.urdf": CAR.format(shape=BOX)} if model else {}
    (finding,) = find(tmp_path / "car", files, "LCH001", name="launch/car.launch")
    assert (finding.message_id, finding.severity) == (message, severity)
    begin = "clone its repository, as README.md says" if readme else "install it" if name != "arms" else "correct"
    assert get_repair(finding).startswith(begin)


INNER = '<launch><arg name="frame" default="a"/></launch>'


@pytest.mark.parametrize(
    ("around", "inner", "repair"),
    [
        ("", INNER, 'declare the argument: `<arg name="f" default="…"/>`; or delete '),
        ('<arg name="g" default="$(arg f)_b"/>', INNER, 'declare the argument: `<arg name="f" default="…"/>`'),
        (
            '<node name="a" pkg="a" type="a" ns="$(arg f)"/>',
            "<launch/>",
            'declare the argument: `<arg name="f" default="…"/>`; and',
        ),
        ("", "<launch/>", "delete "),
    ],
)
def test_a_passed_argument_is_deleted_where_nothing_else_reads_it(
    tmp_path: Path, around: str, inner: str, repair: str
) -> None:
    (tmp_path / "inner.launch.xml").write_text(inner)
    body = f'{around}<include file="$(dirname)/inner.launch.xml"><arg name="frame" value="$(arg f)"/></include>'
    (finding,) = find_in_launch(tmp_path, body, "LCH001")
    is_whole = around.startswith("<arg")
    assert get_repair(finding) == repair if is_whole else get_repair(finding).startswith(repair)


def test_the_word_of_a_path_that_an_argument_says_is_named_where_it_is_typed(tmp_path: Path) -> None:
    """Correcting the path would take it from the other launch files that include this one."""
    inner = '<launch><arg name="model" default="arm"/>' + load("$(find car)/urdf/$(arg model).urdf") + "</launch>"
    files = {
        "package.xml": "<package><name>car</name></package>",
        "launch/inner.launch": inner,
        "launch/outer.launch": '<launch>\n<arg name="kind" default="large"/><include file="$(dirname)/inner.launch">'
        '<arg name="model" value="$(arg kind)"/></include></launch>',
    }
    (finding,) = find(tmp_path / "car", files, "LCH001", name="launch/outer.launch")
    assert get_repair(finding).startswith("correct the value 'large' of argument kind (")
    assert get_repair(finding).endswith("launch/outer.launch:2), or the path, or add the file")
    whole = '<arg name="m" default="$(find car)/urdf/none.urdf"/>' + load("$(arg m)")
    (finding,) = find_in_package(tmp_path, whole, "LCH001")
    assert get_repair(finding) == "correct the path, or add the file"


@pytest.mark.parametrize(("condition", "severity"), [("true", Severity.ERROR), ("$(env SIM)", Severity.WARNING)])
def test_a_description_that_the_launch_may_leave_out_is_a_warning(
    tmp_path: Path, condition: str, severity: Severity
) -> None:
    body = f'<group if="{condition}">{load("$(find car)/urdf/gone.urdf")}</group>'
    (finding,) = find_in_package(tmp_path, body, "LCH001")
    assert (finding.message_id, finding.severity) == ("file", severity)


@pytest.mark.parametrize(
    ("model", "reported"), [("car", False), ("$(dirname)/gone.urdf.xacro", True), ("$(env MODEL)", False)]
)
def test_one_of_two_descriptions_is_chosen_by_a_comparison(tmp_path: Path, model: str, reported: bool) -> None:
    """A path is loaded as it is, and a name is looked up: only the one that the argument chooses is loaded."""
    condition = "$(eval '/' not in model)"
    command = '<param name="robot_description" command="$(find xacro)/xacro {}" {}="{}"/>'
    body = f'<arg name="model" default="{model}"/>'
    body += command.format("$(find car)/urdf/$(arg model).urdf", "if", condition)
    body += command.format("$(arg model)", "unless", condition)
    messages = [f.message_id for f in find_in_package(tmp_path, body, "LCH001") if f.severity > Severity.INFO]
    assert messages == ["file"] * reported


def test_a_path_with_an_argument_under_an_unknown_condition_is_not_judged(tmp_path: Path) -> None:
    body = '<arg name="m" default="gone"/><param name="robot_description" textfile="$(find car)/urdf/$(arg m).urdf" if="{}"/>'
    assert [f.message_id for f in find_in_package(tmp_path, body.format("true"), "LCH001")] == ["file"]
    assert not find_in_package(tmp_path, body.format("$(eval exists(m))"), "LCH001")


def test_the_own_package_is_meant_where_it_has_the_file(tmp_path: Path) -> None:
    (finding,) = find_in_package(tmp_path, load("$(find spot_description)/urdf/car.urdf"), "LCH001")
    assert finding.message_id == "package"
    assert "(did you mean 'car'?)" in finding.message


def get_repair(finding: Finding) -> str:
    assert finding.fix is not None
    return finding.fix.title


@pytest.mark.parametrize(
    ("file", "start"),
    [("car.urdf", "correct the package name (did"), ("cart.urdf", "correct the package name and the path (did")],
)
def test_the_own_package_may_lack_the_file_that_is_typed_behind_a_similar_name(
    tmp_path: Path, file: str, start: str
) -> None:
    (finding,) = find_in_package(tmp_path, load(f"$(find cars)/urdf/{file}"), "LCH001")
    assert get_repair(finding).startswith(start)


PART = '<robot><link name="l"/></robot>'
EMPTY = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:include filename="m.xacro"/></robot>'
WHOLE = '<robot name="r"><link name="l"/></robot>'


@pytest.mark.parametrize(
    ("name", "content", "is_named"),
    [
        ("arm.urdf.xacro", WHOLE, True),
        ("arm.urdf.xacro", EMPTY, True),
        ("arm.urdf.xacro", PART, False),
        ("arm.urdf.xacro", '<robot name="r"/>', False),
        ("arm.urdf.xacro", "<robot", False),
        ("arm.srdf", WHOLE, False),
        ("arm.rviz", "Panels: []", False),
        ("arm.sdf", "<sdf/>", False),
        ("parts/arm.urdf", WHOLE, True),
        ("parts/arm.urdf", PART, False),
        ("parts/arm.urdf", "<sdf/>", False),
    ],
)
def test_only_a_robot_is_proposed_in_place_of_a_missing_one(
    tmp_path: Path, name: str, content: str, is_named: bool
) -> None:
    find_in_package(tmp_path, LOAD, "LCH001")
    place = tmp_path / "car/urdf" / name
    place.parent.mkdir(exist_ok=True)
    place.write_text(content)
    (finding,) = find_in_package(tmp_path, XACRO.format("$(find car)/urdf/arm.urdf"), "LCH001")
    assert (place.name in get_repair(finding)) == is_named


@pytest.mark.parametrize(("other", "is_named"), [("car_2", False), ("car2b", False), ("bus", True)])
def test_the_robot_of_another_version_is_not_meant(tmp_path: Path, other: str, is_named: bool) -> None:
    (tmp_path / ".git").mkdir()
    (tmp_path / f"{other}/urdf").mkdir(parents=True)
    (tmp_path / f"{other}/package.xml").write_text(f'<package format="2"><name>{other}</name></package>')
    (tmp_path / f"{other}/urdf/base.urdf").write_text(WHOLE)
    (finding,) = find_in_package(tmp_path, load("$(find car)/urdf/base.urdf"), "LCH001")
    assert ("base.urdf)" in get_repair(finding)) == is_named


@pytest.mark.parametrize(
    ("passed", "content", "is_named"),
    [
        ("", "<launch/>", True),
        ("", "<launch", False),
        ("", "<robot/>", False),
        ("", '<launch><include file="$(find car)/launch/car.launch"/></launch>', False),
        ("gui", "<launch/>", False),
        ("gui", '<launch><arg name="gui"/></launch>', True),
        ("", '<launch><arg name="gui"/></launch>', False),
        ("", '<launch><arg name="gui" default="1"/></launch>', True),
    ],
)
def test_only_a_launch_file_that_can_be_included_is_proposed(
    tmp_path: Path, passed: str, content: str, is_named: bool
) -> None:
    find_in_package(tmp_path, LOAD, "LCH001")
    (tmp_path / "car/launch/viewer.launch").write_text(content)
    argument = f'<arg name="{passed}" value="1"/>' if passed else ""
    for typed in ("launch/viewr.launch", "launch/parts/viewer.launch", "viewer.launch"):
        body = f'<include file="$(find car)/{typed}">{argument}</include>'
        (finding,) = find_in_package(tmp_path, body, "LCH001")
        assert ("viewer.launch" in get_repair(finding)) == is_named


@pytest.mark.parametrize(
    ("argument", "repair"),
    [
        ("", 'delete `<arg name="frame" …/>` from the include: view.launch declares no frame, so roslaunch refuses it'),
        ('<arg name="frame"/>', 'declare the argument: `<arg name="base" default="…"/>`'),
        (
            '<arg name="frame" value="map"/>',
            'delete `<arg name="frame" …/>` from the include: view.launch gives frame a fixed value, which roslaunch does not '
            "replace",
        ),
        (
            '<arg name="frame" default="map"/>',
            'declare the argument: `<arg name="base" default="…"/>`; or delete `<arg name="frame" …/>` from the include: '
            "view.launch has a default for it",
        ),
    ],
)
def test_an_unknown_argument_is_declared_where_the_included_file_takes_it(
    tmp_path: Path, argument: str, repair: str
) -> None:
    find_in_package(tmp_path, LOAD, "LCH001")
    (tmp_path / "car/launch/view.launch").write_text(f"<launch>{argument}</launch>")
    handed = '<arg name="frame" value="$(arg base)"/>'
    body = f'<include file="$(find car)/launch/view.launch">{handed}</include>'
    (finding,) = find_in_package(tmp_path, body, "LCH001")
    assert get_repair(finding) == repair


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("FindPackageShare('arm').find('arm')", "arm.xacro was found in no package here"),
        ("LaunchConfiguration('where').perform(context)", "the folder of arm.xacro depends on `share`"),
    ],
)
def test_a_python_launch_file_of_a_folder_that_was_given_says_on_request_what_it_loads(
    tmp_path: Path, text: str, told: str
) -> None:
    find_in_package(tmp_path, LOAD, "LCH001")
    code = (
        f"share = {text}\nmodel = os.path.join(share, 'arm.xacro')\nsemantic = os.path.join(share, 'arm.srdf.xacro')\n"
    )
    (tmp_path / "car/launch/arm.launch.py").write_text(code)
    (finding,) = only(check(tmp_path / "car", codes={"LCH001"}))
    assert (finding.message_id, finding.data["reason"]) == ("computed", told)


def test_a_declared_dependency_is_merely_not_installed(tmp_path: Path) -> None:
    depend = "<exec_depend>other_car</exec_depend>"
    (finding,) = find_in_package(tmp_path, load("$(find other_car)/car.urdf"), "LCH001", depend=depend)
    assert (finding.message_id, finding.severity) == ("unknown", Severity.INFO)


def test_an_argument_that_another_launch_file_hands_over_is_its_business(tmp_path: Path) -> None:
    text = '<launch><include file="$(dirname)/car.launch"><arg name="model" value="{}"/></include></launch>'
    outer = tmp_path / "car" / "launch" / "all.launch"
    outer.parent.mkdir(parents=True)
    outer.write_text(text.format("$(find car)/urdf/car.urdf"), encoding="utf-8")
    assert not find_in_package(tmp_path, '<arg name="model"/>' + load("$(arg model)"), "LCH001")
    assert [Path(m.path).name for m in check(outer, codes={"LCH001"}).models] == ["car.urdf"]
    outer.write_text(text.format("$(find car)/urdf/cart.urdf"), encoding="utf-8")
    (finding,) = only(check(outer, codes={"LCH001"}))
    assert (finding.message_id, len(finding.location.via)) == ("file", 1)


@pytest.mark.parametrize(
    ("code", "message", "severity"),
    [
        ("join(get_package_share_directory('car'), 'urdf/bott.urdf.xacro')", "named", Severity.WARNING),
        ("join(d, 'urdf/bott.urdf.xacro')", "depends", Severity.INFO),
        ("model = 'urdf/bott.urdf.xacro'", "unfound", Severity.INFO),
        ("d = join(get_package_share_directory('bot'))\njoin(d, 'bott.urdf.xacro')", "unfound", Severity.INFO),
        (
            "text = Command(['ros2 param get --hide-type /robot_state_publisher robot_description'])\n"
            "Node(parameters=[{'robot_description': ParameterValue(text)}])",
            None,
            None,
        ),
        ("def f(:", "syntax", Severity.WARNING),
        ("Node(parameters=[{'robot_description': text}])", "unknown", Severity.INFO),
        ("Node(parameters=[{'robot_description': join(d, 'urdf/car.urdf')}])", None, None),
        ("Node(arguments=['-topic', 'robot_description'])", None, None),
    ],
)
def test_a_python_launch_file(tmp_path: Path, code: str, message: str | None, severity: Severity | None) -> None:
    find_in_package(tmp_path, "", "LCH001")
    path = tmp_path / "car" / "launch" / "car.launch.py"
    path.write_text(code, encoding="utf-8")
    findings = only(check(path))
    lch = [(f.message_id, f.severity) for f in findings if f.code == "LCH001"]
    assert lch == ([] if message is None else [(message, severity)])
    others = [f.location.span for f in findings if f.code != "LCH001"]
    assert not [span for span in others if span is not None and span.file.endswith(".launch.py")]


@pytest.mark.parametrize(("end", "message"), [("", "syntax-newer"), ("(", "syntax")])
def test_an_f_string_with_its_own_quotes_needs_a_newer_python(tmp_path: Path, end: str, message: str) -> None:
    find_in_package(tmp_path, "", "LCH001")
    path = tmp_path / "car" / "launch" / "car.launch.py"
    path.write_text("""f'{d["a"]}'\njoin(d, f"{d["a"]}{d["b"]}", 'urdf/car.urdf')""" + end, encoding="utf-8")
    run = check(path, codes={"LCH001"})
    (finding,) = (f for f in run.findings if f.message_id.startswith("syntax"))
    assert (finding.message_id, finding.severity == Severity.INFO) == (message, message == "syntax-newer")
    if message == "syntax-newer":
        assert finding.location.span is not None
        assert (finding.location.span.line, finding.location.span.col) == (2, 14)


@pytest.mark.parametrize(
    ("declared", "is_known"),
    [
        ("default_value=EnvironmentVariable('ROBOT', default_value='car'), choices=['car']", True),
        ("default_value='car'", True),
        ("default_value=EnvironmentVariable('ROBOT', default_value='car'), choices=['car', 'cart']", False),
        ("default_value='cart'", False),
    ],
)
def test_a_name_that_is_put_together_from_an_argument_is_known_at_a_plain_launch(
    tmp_path: Path, declared: str, is_known: bool
) -> None:
    find_in_package(tmp_path, "", "LCH001")
    path = tmp_path / "car" / "launch" / "car.launch.py"
    path.write_text(
        f"""DeclareLaunchArgument('robot', {declared})
name = PythonExpression(["'", LaunchConfiguration('robot'), ".urdf'"])
file = PathJoinSubstitution([FindPackageShare('car'), 'urdf', name])
Node(parameters=[{{'robot_description': Command(['xacro ', file])}}])""",
        encoding="utf-8",
    )
    run = check(path, codes={"LCH001"})
    assert [Path(m.path).name for m in run.models if m.robot] == (["car.urdf"] if is_known else [])
    assert [f.message_id for f in run.findings] == ([] if is_known else ["unknown"])


VARIABLE = """model = LaunchConfiguration('model')
path = PathJoinSubstitution([FindPackageShare('car'), 'urdf', model, '{}'])
"""


@pytest.mark.parametrize(
    ("declared", "file", "models", "told"),
    [
        ("DeclareLaunchArgument('model', default_value='small')", "twice.urdf", ["urdf/small/twice.urdf"], None),
        ("DeclareLaunchArgument('model', default_value='none')", "once.urdf", ["urdf/large/once.urdf"], None),
        ("", "once.urdf", ["urdf/large/once.urdf"], None),
        ("", "twice.urdf", [], "the folder of the model twice.urdf depends on `model`, so it was not checked"),
        ("", "never.urdf", [], "the folder of the model never.urdf depends on `model`, so it was not checked"),
    ],
)
def test_a_model_in_a_variable_folder(
    tmp_path: Path, declared: str, file: str, models: list[str], told: str | None
) -> None:
    find_in_package(tmp_path, "", "LCH001")
    package = tmp_path / "car"
    for name in ("small/twice.urdf", "large/twice.urdf", "large/once.urdf"):
        path = package / "urdf" / name
        path.parent.mkdir(exist_ok=True)
        path.write_text('<robot name="r"><link name="l"/></robot>')
    launch = package / "launch" / "car.launch.py"
    launch.write_text(declared + "\n" + VARIABLE.format(file))
    run = check(launch, codes={"LCH001"})
    assert [Path(m.path).resolve().relative_to(package.resolve()).as_posix() for m in run.models] == models
    assert [f.message for f in run.findings] == ([] if told is None else [told])


def test_a_bare_name_means_the_only_file_of_its_name_in_the_package(tmp_path: Path) -> None:
    """As in the demos of ros2_control, whose build installs description/urdf as urdf."""
    find_in_package(tmp_path, "", "LCH001")
    package = tmp_path / "car"
    path = package / "description/urdf/demo.urdf"
    path.parent.mkdir(parents=True)
    path.write_text('<robot name="r"><link name="l"/></robot>')
    launch = package / "launch" / "car.launch.py"
    launch.write_text("file = LaunchConfiguration('f')\nDeclareLaunchArgument('f', default_value='demo.urdf')\n")
    run = check(launch, codes={"LCH001"})
    assert [Path(m.path).name for m in run.models] == ["demo.urdf"]
    assert not run.findings


@pytest.mark.parametrize(
    ("ignore", "missing"), [("*.gen.urdf", False), ("/urdf/*.urdf\n!made.gen.urdf", True), ("# made.gen.urdf", True)]
)
def test_a_generated_file_that_git_ignores_is_not_missing(tmp_path: Path, ignore: str, missing: bool) -> None:
    (found,) = find_in_package(tmp_path, load("$(find car)/urdf/made.gen.urdf"), "LCH001")
    assert found.message_id == "file"
    package = tmp_path / "car"
    (package / ".gitignore").write_text(ignore)
    python = package / "launch" / "car.launch.py"
    python.write_text("join(get_package_share_directory('car'), 'urdf', 'made.gen.urdf')")
    found_in = {Path(f.location.file).suffix: f.message_id for f in only(check(package, codes={"LCH001"}))}
    assert found_in == ({".launch": "file", ".py": "named"} if missing else {".launch": "computed"})


@pytest.mark.parametrize(
    ("build", "told"),
    [
        ("install(DIRECTORY urdf DESTINATION share/car)", ["named"]),
        ("xacro_add_files(urdf/bot.urdf.xacro)", []),
        ("make_model(urdf/bot.urdf.xacro)", []),
    ],
)
def test_a_xacro_of_that_name_stands_for_a_missing_model_where_the_build_expands_it(
    tmp_path: Path, build: str, told: list[str]
) -> None:
    find_in_package(tmp_path, "", "LCH001")
    package = tmp_path / "car"
    (package / "urdf/bot.urdf.xacro").write_text('<robot name="r"><link name="l"/></robot>')
    (package / "CMakeLists.txt").write_text(build)
    (package / "launch/car.launch.py").write_text("join(get_package_share_directory('car'), 'urdf', 'bot.urdf')")
    findings = only(check(package, codes={"LCH001"}))
    assert [f.message_id for f in findings] == told
    assert all("'bot.urdf.xacro'" in f.message for f in findings)


def test_what_a_launch_file_loads_is_asked_for_only_where_no_model_of_the_folder_is_checked(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    find_in_package(tmp_path, load("$(env HOME)/car.urdf"), "LCH001")
    monkeypatch.chdir(tmp_path)
    named = Path("car/launch/car.launch")
    assert [[f.message_id for f in check(path, codes={"LCH001"}).findings] for path in (Path("car"), named)] == [
        ["computed"],
        ["unknown"],
    ]
    Path("car/urdf/car.urdf").unlink()
    assert [f.message_id for f in check(Path("car"), codes={"LCH001"}).findings] == ["unknown"]


def test_a_model_that_only_the_launch_knows_is_listed_as_not_checked(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    find_in_package(tmp_path, load("$(env HOME)/car.urdf"), "LCH001")
    monkeypatch.chdir(tmp_path)
    named = check(Path("car/launch/car.launch"))
    (note,) = (f for f in named.findings if f.code == "LCH001")
    assert note.message_id in load_rules()["LCH001"].on_request, "nothing is wrong with the launch file"
    assert [(s.code, s.model) for s in named.skipped if "known only at launch" in s.reason] == [
        (SkippedCheck.LAUNCHED_MODEL, "car.launch")
    ]
    assert not [s for s in check(Path("car")).skipped if s.code == SkippedCheck.LAUNCHED_MODEL], (
        "its models are checked"
    )


@pytest.mark.parametrize(("folder", "count"), [("launch", 1), ("launch/not_used", 0)])
def test_launch_files_that_are_kept_and_not_used_are_left_out(tmp_path: Path, folder: str, count: int) -> None:
    find_in_package(tmp_path, LOAD, "LCH001")
    path = tmp_path / "car" / folder / "old.launch"
    path.parent.mkdir(exist_ok=True)
    node = '<node pkg="robot_state_publisher" type="state_publisher" name="n"/>'
    path.write_text(f"<launch>{load('$(find car)/urdf/gone.urdf')}{node}</launch>")
    assert len(check(tmp_path / "car", codes={"LCH001", "LCH003"}).findings) == 2 * count


@pytest.mark.parametrize(
    ("name", "named", "count"),
    [
        ("car_old.launch", "", 0),
        ("car_old.launch", '<include file="$(find car)/launch/car_old.launch"/>', 1),
        ("arm_old.launch", "", 0),
        ("arm_old.launch", '<include file="$(find car)/launch/arm_old.launch"/>', 1),
        ("car (copy).launch", "", 0),
        ("arm (copy).launch", "", 1),
        ("car_odd.launch", "", 1),
    ],
)
def test_an_old_state_or_copy_of_a_launch_file_that_nothing_names_is_left_out(
    tmp_path: Path, name: str, named: str, count: int
) -> None:
    find_in_package(tmp_path, LOAD + named, "LCH001")
    node = '<node pkg="robot_state_publisher" type="state_publisher" name="n"/>'
    (tmp_path / "car/launch" / name).write_text(f"<launch>{load('$(find car)/urdf/gone.urdf')}{node}</launch>")
    assert len(check(tmp_path / "car", codes={"LCH001", "LCH003"}).findings) == 2 * count


ROS2 = "<export><build_type>ament_cmake</build_type></export>"
BOTH = ROS2.replace("</export>", "<build_type>catkin</build_type></export>")


@pytest.mark.parametrize(("build", "severity"), [(ROS2, Severity.WARNING), (BOTH, Severity.ERROR)])
def test_a_launch_file_of_ros_1_in_a_package_of_ros_2_is_left_over(
    tmp_path: Path, build: str, severity: Severity
) -> None:
    node = '<node pkg="robot_state_publisher" type="state_publisher" name="n"/><param name="use_gui" value="true"/>'
    body = load("$(find car)/urdf/gone.urdf") + node + '<node pkg="joint_state_publisher" type="j" name="j"/>'
    codes = {"LCH001", "LCH003", "LCH007"}
    find_in_package(tmp_path, body, "LCH001", depend=build)
    found = {f.code: f for f in only(check(tmp_path / "car/launch/car.launch", codes=codes))}
    is_left = severity is Severity.WARNING
    assert found.keys() == ({"LCH001"} if is_left else codes)
    assert found["LCH001"].severity == severity
    assert found["LCH001"].fix is not None
    assert found["LCH001"].fix.title.startswith("delete the launch file" if is_left else "correct the path")


@pytest.mark.parametrize(
    ("own", "severity"),
    [("<buildtool_depend>catkin</buildtool_depend>", None), ("", Severity.ERROR), (None, Severity.WARNING)],
)
def test_a_package_of_ros_2_is_not_what_a_launch_file_of_ros_1_means(
    tmp_path: Path, own: str | None, severity: Severity | None
) -> None:
    include = '<include file="$(find arm)/launch/gone.launch"/>'
    files = {
        ".git/HEAD": "",
        "ros2/arm/package.xml": f"<package format='2'><name>arm</name>{ROS2}</package>",
        "ros1/car/launch/a.launch": f"<launch>{include}{load('$(find arm)/urdf/gone.urdf')}</launch>",
    }
    if own is not None:
        files["ros1/car/package.xml"] = f"<package format='2'><name>car</name>{own}</package>"
    found = find(tmp_path, files, "LCH001", name="ros1/car/launch/a.launch")
    (included,) = [f for f in found if f.message_id == "include-file"] or [None]
    assert (None if included is None else included.severity) == severity
    if own:
        assert {f.message_id for f in found} == {"unknown"}


@pytest.mark.parametrize(
    ("name", "named", "severity"),
    [
        ("run_benchmark_ompl.launch", "", Severity.INFO),
        ("run_benchmark_ompl.launch", '<include file="$(find car)/launch/run_benchmark_ompl.launch"/>', Severity.ERROR),
        ("demo.launch", "", Severity.ERROR),
    ],
)
def test_a_template_of_the_setup_assistant_that_nothing_names_is_a_note(
    tmp_path: Path, name: str, named: str, severity: Severity
) -> None:
    files = {
        "package.xml": '<package format="2"><name>car</name></package>',
        ".setup_assistant": "",
        f"launch/{name}": '<launch><include file="$(find car)/launch/warehouse.launch"/></launch>',
        "launch/all.launch": f"<launch>{named}</launch>",
    }
    (finding,) = find(tmp_path / "car", files, "LCH001", name=f"launch/{name}")
    assert finding.severity == severity
    assert get_repair(finding).startswith("delete the launch file") == (severity is Severity.INFO)


def test_a_launch_file_that_includes_one_of_ros_1_is_left_over_too(tmp_path: Path) -> None:
    files = {
        "package.xml": f"<package><name>car</name>{ROS2}</package>",
        "launch/all.launch": '<launch><include file="$(dirname)/robot.launch"/></launch>',
        "launch/robot.launch": f"<launch>{load('$(find car)/urdf/gone.urdf')}</launch>",
    }
    (finding,) = find(tmp_path, files, "LCH001", name="launch/all.launch")
    assert finding.severity == Severity.WARNING


def test_a_released_package_is_declared_and_a_dependency_of_a_dependency_is(tmp_path: Path) -> None:
    text = load("$(find ur_description)/urdf/ur.urdf")
    (finding,) = find_in_package(tmp_path, text, "LCH001")
    assert finding.fix is not None
    # The file may be another robot's, copied as a beginning.
    assert finding.fix.title == (
        "install it, and declare it in package.xml, if that robot is meant; else name the model of this package"
    )
    arm = tmp_path / "arm/package.xml"
    arm.parent.mkdir()
    arm.write_text("<package format='2'><name>arm</name><depend>ur_description</depend></package>")
    (tmp_path / ".git").mkdir()
    (finding,) = find_in_package(tmp_path, text, "LCH001", depend="<depend>arm</depend>")
    assert finding.message_id == "unknown"


def test_a_xacro_in_place_of_a_model_that_is_read_as_it_is(tmp_path: Path) -> None:
    for body, told in ((load("{}"), "which xacro must expand"), (XACRO.format("{}"), "did you mean")):
        root = tmp_path / told.split()[0]
        find_in_package(root, LOAD, "LCH001")
        (root / "car/urdf/arm.urdf.xacro").write_text('<robot name="r"><link name="l"/></robot>')
        (finding,) = find_in_package(root, body.format("$(find car)/urdf/arm.urdf"), "LCH001")
        assert told in finding.message


INCLUDE = '<include file="{}"/>'


@pytest.mark.parametrize(
    ("body", "message"),
    [
        (INCLUDE.format("$(find car)/launch/arm.launch"), "include-file"),
        (INCLUDE.format("$(dirname)/arm.launch"), "include-file"),
        (INCLUDE.format("$(find car)/launch/$(arg name).launch"), "include-argument"),
        ('<arg name="name"/>' + INCLUDE.format("$(find car)/launch/$(arg name).launch"), None),
        ('<arg name="name" default="arm"/>' + INCLUDE.format("$(dirname)/$(arg name).launch"), "include-file"),
        (INCLUDE.format("$(find gazebo_ros)/launch/empty_world.launch"), None),  # whether it is declared is PKG007's
        (INCLUDE.format("launch/arm.launch"), None),  # from wherever it is launched
        (f'<group if="false">{INCLUDE.format("$(dirname)/arm.launch")}</group>', None),
        (f'<group if="$(env SIM)">{INCLUDE.format("$(dirname)/arm.launch")}</group>', None),
        (INCLUDE.format("$(find car)/launch/car.launch"), "include-circle"),
        ('<include if="$(env SIM)" file="$(find car)/launch/car.launch"/>', None),
        ('<include file="$(dirname)/car.launch"><arg name="n" value="1"/></include>', "include-circle"),
    ],
)
def test_why_an_include_leads_nowhere(tmp_path: Path, body: str, message: str | None) -> None:
    assert [f.message_id for f in find_in_package(tmp_path, body, "LCH001")] == ([] if message is None else [message])


def test_what_an_included_template_loads_is_not_missing(tmp_path: Path) -> None:
    inner = '<launch><rosparam file="$(find {})/a.yaml"/><include file="$(dirname)/[ROBOT]_b.launch"/></launch>'
    for package, count in (("[PACKAGE]", 0), ("car", 1)):
        files = {
            "package.xml": "<package><name>car</name></package>",
            "launch/a.launch.xml": inner.format(package),
            "launch/b.launch": '<launch><include file="$(dirname)/a.launch.xml"/></launch>',
        }
        assert len(find(tmp_path / package / "car", files, "LCH001", name="launch/b.launch")) == count


def test_a_file_is_not_proposed_to_itself(tmp_path: Path) -> None:
    files = {
        "package.xml": "<package><name>car</name></package>",
        "launch/sensor_manager.launch": '<launch><include file="$(find car)/launch/car_sensor_manager.launch"/></launch>',
    }
    (finding,) = find(tmp_path, files, "LCH001", name="launch/sensor_manager.launch")
    assert "did you mean" not in finding.message


@pytest.mark.parametrize(("items", "missing"), [("small large", 0), ("small", 1)])
def test_a_build_may_write_a_model_for_each_of_a_list(tmp_path: Path, items: str, missing: int) -> None:
    build = (
        f'foreach(KIND IN ITEMS {items})\n  set(OUT "${{CMAKE_CURRENT_BINARY_DIR}}/urdf/${{KIND}}.urdf")\n'
        '  add_custom_command(OUTPUT ${OUT} COMMAND xacro car.xacro "kind:=${KIND}" > ${OUT})\nendforeach()\n'
    )
    (tmp_path / "car").mkdir()
    (tmp_path / "car" / "CMakeLists.txt").write_text(build)
    found = find_in_package(tmp_path, load("$(find car)/urdf/large.urdf"), "LCH001")
    assert sum(finding.message_id == "file" for finding in found) == missing


@pytest.mark.parametrize(
    ("file", "text", "known"),
    [
        ("make.sh", "xacro urdf/cart.urdf.xacro > urdf/cart.urdf", False),
        ("make.sh", "rosrun xacro xacro ${robot}.urdf.xacro > ${robot}.urdf", False),
        ("make.sh", "xacro urdf/cart.urdf.xacro -o ${robot}_cart.urdf", True),
        ("make.sh", "xacro urdf/cart.urdf.xacro > urdf/bus.urdf", True),
        ("CMakeLists.txt", "add_custom_command(OUTPUT ${CMAKE_BINARY_DIR}/cart.urdf COMMAND xacro)", False),
        ("CMakeLists.txt", "xacro_add_files(urdf/cart.urdf.xacro INSTALL)", False),
        ("CMakeLists.txt", "set(x urdf/cart.urdf.xacro)\nbuild_and_install(${x})", False),
        ("CMakeLists.txt", "file(GLOB x urdf/*.xacro)\nforeach(f ${x})\n  make_model(${f})\nendforeach()", False),
        ("CMakeLists.txt", "file(GLOB_RECURSE x *.xacro)\nxacro_add_files(${x})", False),
        ("CMakeLists.txt", "my_xacro(cart)", False),
        ("CMakeLists.txt", "find_package(xacro)\nmy_xacro(bus)\nmy_function(cart)", True),
        ("CMakeLists.txt", "# xacro_add_files(urdf/cart.xacro)\nxacro_add_files(urdf/bus.urdf.xacro)", True),
        ("cmake/make.cmake", "foreach(r ${all})\n xacro_add_files(${r} OUTPUT ${r}.urdf)\nendforeach()", False),
        ("notes.txt", "xacro urdf/cart.urdf.xacro > urdf/cart.urdf", True),
    ],
)
@pytest.mark.parametrize("language", ["xml", "python"])
def test_a_model_that_a_script_writes_is_known_after_it(
    tmp_path: Path, file: str, text: str, known: bool, language: str
) -> None:
    if language == "python" and file.lower().endswith((".txt", ".cmake")) and file != "notes.txt":
        return  # what the build of a Python launch file's package may make is not missing at all
    python = "d = get_package_share_directory('car')\np = join(d, 'urdf', 'cart.urdf')"
    files = {
        "package.xml": "<package><name>car</name></package>",
        "urdf/cart.urdf.xacro": CAR.format(shape=BOX),
        file: text,
        "launch/car.launch": f"<launch>{load('$(find car)/urdf/cart.urdf')}</launch>",
        "launch/car.launch.py": python,
    }
    name = "launch/car.launch" + ".py" * (language == "python")
    (finding,) = find(tmp_path, files, "LCH001", name=name)
    missing = "named" if language == "python" else "file"
    assert finding.message_id == (missing if known else "unknown")


@pytest.mark.parametrize(
    ("file", "text", "found"),
    [
        ("launch/view.launch.in", "<launch/>", ["unknown"]),
        ("launch/view.launch.em", "<launch/>", ["unknown"]),
        (".gitignore", "view.launch", ["unknown"]),
        ("launch/view.launch.txt", "", ["unknown", "include-file"]),
        ("urdf/arm.urdf", WHOLE, ["include-file"]),
    ],
)
def test_what_the_build_makes_of_a_template_is_not_missing(
    tmp_path: Path, file: str, text: str, found: list[str]
) -> None:
    find_in_package(tmp_path, LOAD, "LCH001")
    (tmp_path / "car/urdf/arm.urdf.in").write_text(WHOLE)
    (tmp_path / "car" / file).write_text(text)
    body = load("$(find car)/urdf/arm.urdf") + INCLUDE.format("$(find car)/launch/view.launch")
    assert [f.message_id for f in find_in_package(tmp_path, body, "LCH001")] == found


def test_an_include_of_ros_2_may_be_put_there_by_the_build(tmp_path: Path) -> None:
    body = INCLUDE.format("$(find-pkg-share car)/launch/arm.launch.xml")
    (finding,) = find_in_package(tmp_path, body, "LCH001")
    assert (finding.message_id, finding.severity) == ("include-file", Severity.ERROR)
    (tmp_path / "car" / "CMakeLists.txt").write_text("install(FILES arm.launch.xml DESTINATION launch)")
    assert not find_in_package(tmp_path, body, "LCH001")


@pytest.mark.parametrize(
    ("declared", "owner"),
    [
        ('<arg name="which"/>', None),
        ('<arg name="which" default="arm"/>', None),
        ('<arg name="kind" default="wh"/><arg name="$(arg kind)ich"/>', None),
        ("", "car.launch"),
    ],
)
def test_what_a_passed_value_lacks_is_of_the_file_that_passes_it(
    tmp_path: Path, declared: str, owner: str | None
) -> None:
    (tmp_path / "car" / "launch").mkdir(parents=True)
    chosen = f"{load('$(find car)/urdf/$(arg name).urdf')}{INCLUDE.format('$(dirname)/$(arg name)_control.launch')}"
    for name, body in (("chosen", chosen), ("arm_control", "")):
        (tmp_path / f"car/launch/{name}.launch").write_text(f'<launch><arg name="name" default="car"/>{body}</launch>')
    passes = '<include file="$(dirname)/chosen.launch"><arg name="name" value="$(arg which)"/></include>'
    findings = find_in_package(tmp_path, declared + passes, "LCH001")
    undeclared = [f for f in findings if f.message_id in {"argument", "include-argument"}]
    owners = [Path(f.location.span.file).name for f in undeclared if f.location.span]
    assert owners == ([] if owner is None else [owner])


@pytest.mark.parametrize(("given", "found"), [("arm", False), ("leg", True), ("", True)])
def test_an_include_may_be_written_by_a_program_that_gets_the_launch_file(
    tmp_path: Path, given: str, found: bool
) -> None:
    """Started with another argument, the same launch file makes what it includes."""
    node = f'<node pkg="p" type="make.py" name="m" args="$(find car)/launch/{given}.launch -v"/>' if given else ""
    body = f'<group if="false">{node}</group>' + INCLUDE.format("$(find car)/launch/arm_spawner.launch")
    assert [f.message_id for f in find_in_package(tmp_path, body, "LCH001")] == ["include-file"] * found


def test_a_circle_through_another_file_closes_in_that_one(tmp_path: Path) -> None:
    (tmp_path / "car" / "launch").mkdir(parents=True)
    other = tmp_path / "car" / "launch" / "other.launch"
    other.write_text(f"<launch>{INCLUDE.format('$(dirname)/car.launch')}</launch>", encoding="utf-8")
    (finding,) = find_in_package(tmp_path, INCLUDE.format("$(dirname)/other.launch"), "LCH001")
    assert finding.location.span is not None
    assert Path(finding.location.span.file).name == "other.launch"


@pytest.mark.parametrize(
    ("name", "found"), [("arm.launch.py", True), ("car.launch", False), ("made.launch.py", False), ("arm.rviz", False)]
)
def test_a_python_launch_file_includes_another(tmp_path: Path, name: str, found: bool) -> None:
    find_in_package(tmp_path, "", "LCH001")
    (tmp_path / "car" / "launch" / "made.launch.py.in").write_text("", encoding="utf-8")
    path = tmp_path / "car" / "launch" / "all.launch.py"
    path.write_text(f"d = get_package_share_directory('car')\nI(join(d, 'launch', '{name}'))", encoding="utf-8")
    findings = only(check(path, codes={"LCH001"}))
    assert [(f.message_id, f.severity) for f in findings] == ([("include-file", Severity.WARNING)] if found else [])


def test_the_path_itself_is_pointed_at_and_a_similar_file_named(tmp_path: Path) -> None:
    command = '<param name="robot_description" command="$(find xacro)/xacro \'$(find car)/urdf/cars.urdf\' a:=1"/>'
    (finding,) = find_in_package(tmp_path, command, "LCH001")
    span = finding.location.span
    assert span is not None
    text = (tmp_path / "car" / "launch" / "car.launch").read_text()
    assert text[span.start : span.end] == "$(find car)/urdf/cars.urdf"
    assert "'car.urdf'" in finding.message


@pytest.mark.parametrize(
    ("callers", "hint"),
    [
        (["arm"], "urdf/arm.macros.xacro only defines macros; "),
        (["arm", "leg"], "robots/leg_robot.urdf.xacro include it)"),
        ([], "only defines macros; name a file that calls them)"),
    ],
)
def test_macros_are_no_robot(tmp_path: Path, callers: list[str], hint: str) -> None:
    head = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">'
    call = head + '<xacro:include filename="$(find car)/urdf/arm.macros.xacro"/><link name="a"/></robot>'
    files = {
        "package.xml": "<package><name>car</name></package>",
        "urdf/arm.macros.xacro": head + '<xacro:macro name="m" params=""><link name="a"/></xacro:macro></robot>',
        **{f"robots/{name}_robot.urdf.xacro": call for name in callers},
        "robots/README.md": "",
        "launch/car.launch": f"<launch>{XACRO.format('$(find car)/robots/arm.macros.xacro')}</launch>",
    }
    (finding,) = find(tmp_path, files, "LCH001", name="launch/car.launch")
    assert hint in finding.message
    assert ("robots/arm_robot.urdf.xacro includes it" in finding.message) == (len(callers) == 1)


@pytest.mark.parametrize(
    ("copies", "hint"),
    [
        (["models/arm/model.urdf"], " (the only file of this name here is "),
        (["a/model.urdf", "b/model.urdf"], "; the folder "),
    ],
)
def test_the_only_file_of_that_name_is_proposed(tmp_path: Path, copies: list[str], hint: str) -> None:
    (tmp_path / ".git").mkdir()
    for copy in copies:
        place = tmp_path / "car" / copy
        place.parent.mkdir(parents=True)
        place.write_text('<robot name="r"><link name="a"/></robot>')
    (finding,) = find_in_package(tmp_path, load("$(find car)/model/model.urdf"), "LCH001")
    assert f"model.urdf, which does not exist{hint}" in finding.message
    assert finding.fix is not None
    assert ("models/arm/model.urdf" in finding.fix.title) == (len(copies) == 1)


def test_a_launch_file_is_not_told_to_include_itself(tmp_path: Path) -> None:
    (tmp_path / ".git").mkdir()
    (finding,) = find_in_package(tmp_path, INCLUDE.format("$(find car)/old/car.launch"), "LCH001")
    assert "which does not exist; the folder" in finding.message


# -- LCH002 ------------------------------------------------------------------------------------------------------------


def spawn(args: str, attributes: str = 'pkg="gazebo_ros" type="spawn_model"') -> str:
    return f'<node name="s" {attributes} args="{args}"/>'


CREATE = 'pkg="ros_gz_sim" exec="create"'


@pytest.mark.parametrize(
    ("node", "messages"),
    [
        (spawn("-urdf -param d -model"), ["valueless-end"]),
        (spawn("-urdf -param d -model -unpause"), ["valueless"]),
        (spawn("-urdf -param d"), ["missing"]),
        (spawn("-urdf -param -model car"), ["valueless"]),
        (spawn("-urdf -param d -model car -z -0.1 -Y -1e-3"), []),
        (spawn("-urdf -param d -model car -z -$(arg h)"), []),
        (spawn("-urdf -param d $(arg name)"), []),
        (spawn("-urdf -file $(find car)/urdf/car.urdf -model $(arg name) -J joint -0.5"), []),
        (spawn("-topic d", CREATE), []),
        (spawn("-topic d -name -z 1", CREATE), ["valueless"]),
        (spawn("-model", 'pkg="other" type="spawn_model"'), []),
    ],
)
def test_options_of_spawners(tmp_path: Path, node: str, messages: list[str]) -> None:
    assert [f.message_id for f in find_in_launch(tmp_path, node, "LCH002")] == messages


def test_the_robots_own_name_is_the_missing_value(tmp_path: Path) -> None:
    (finding,) = find_in_package(tmp_path, LOAD + spawn("-urdf -param d\n  -model -unpause"), "LCH002")
    assert finding.fix is not None
    assert [(e.expected, e.replacement) for e in finding.fix.edits] == [("-model", "-model car")]


def test_what_create_takes_for_the_value_may_still_spawn_a_robot(tmp_path: Path) -> None:
    node = '<node pkg="ros_gz_sim" exec="create" args="-topic robot_description -name -z 1"/>'
    (finding,) = find_in_launch(tmp_path, node, "LCH002")
    assert finding.consequences == {"gazebo": "spawns it with '-z' as the value of -name, if at all"}


@pytest.mark.parametrize(
    ("args", "title"),
    [
        ("-param d -model car -z", "write a value after `-z`"),
        ("-param d -model", "write the robot's name after `-model`"),
        ("-param d", "add `-model` and the robot's name"),
    ],
)
def test_the_repair_says_what_to_write(tmp_path: Path, args: str, title: str) -> None:
    (finding,) = find_in_launch(tmp_path, spawn(args), "LCH002")
    assert finding.fix is not None
    assert finding.fix.title == title


# -- LCH003, LCH004, LCH007 --------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("body", "new"),
    [
        ('<node name="n" pkg="robot_state_publisher" type="state_publisher"/>', ["robot_state_publisher"]),
        ('<node pkg="tf" exec="static_transform_publisher"/>', ["tf2_ros"]),
        ('<node pkg="tf" exec="static_transform_publisher" args="0 0 0 0 0 0 a b"/>', ["tf2_ros"]),
        ('<node pkg="tf" exec="static_transform_publisher" args="0 0 0 0 0 0 a b 40"/>', []),
        ('<node pkg="gazebo_ros" exec="spawn_model"/>', []),
        ('<node name="n" pkg="tf" type="static_transform_publisher"/>', []),
        ('<node pkg="rviz" exec="rviz"/>', ["rviz2", "rviz2"]),
    ],
)
def test_each_generation_of_ros_has_removed_its_own(tmp_path: Path, body: str, new: list[str]) -> None:
    findings = find_in_launch(tmp_path, body, "LCH003")
    assert [e.replacement for f in findings if f.fix is not None for e in f.fix.edits] == new


@pytest.mark.parametrize(
    ("body", "end"),
    [
        (
            '<node pkg="tf" exec="static_transform_publisher" args="0 0 0 0 0 0 a b 40"/>',
            "tf2_ros/static_transform_publisher; delete the period, the last number of args",
        ),
        (
            '<node pkg="gazebo_ros" exec="spawn_model"/>',
            "with those of Gazebo Classic (`-topic robot_description -entity …`)",
        ),
        ('<node pkg="rviz" exec="rviz"/>', "write rviz2/rviz2"),
    ],
)
def test_arguments_that_the_replacement_does_not_read_are_named(tmp_path: Path, body: str, end: str) -> None:
    (finding,) = find_in_launch(tmp_path, body, "LCH003")
    assert finding.fix is not None
    assert finding.fix.title.endswith(end)


@pytest.mark.parametrize(
    ("body", "program", "effect"),
    [
        ('<node name="n" pkg="robot_state_publisher" type="state_publisher"/>', "rviz", "shows no robot"),
        ('<node pkg="rviz" exec="rviz"/>', "rviz", "fails to start"),
        ('<node name="n" pkg="gazebo" type="spawn_model"/>', "gazebo", "without the robot"),
        ('<node pkg="controller_manager" exec="spawner.py"/>', "ros2_control", "without the controllers"),
    ],
)
def test_a_removed_executable_affects_the_program_that_needs_it(
    tmp_path: Path, body: str, program: str, effect: str
) -> None:
    (finding,) = find_in_launch(tmp_path, body, "LCH003")
    assert list(finding.consequences) == [program]
    assert effect in finding.consequences[program]


def test_the_old_xacro_script(tmp_path: Path) -> None:
    body = '<param name="robot_description" command="$(find xacro)/xacro.py $(find car)/urdf/car.urdf"/>'
    (finding,) = find_in_package(tmp_path, body, "LCH003")
    assert finding.fix is not None
    assert [(e.expected, e.replacement) for e in finding.fix.edits] == [("xacro.py", "xacro")]


@pytest.mark.parametrize(
    ("script", "is_removed"), [("/opt/ros/kinetic/share/xacro/xacro.py", True), ("/home/me/ws/xacro/xacro.py", False)]
)
def test_a_copy_of_xacro_keeps_its_script(tmp_path: Path, script: str, is_removed: bool) -> None:
    body = f'<param name="robot_description" command="{script} $(find car)/urdf/car.urdf"/>'
    assert bool(find_in_package(tmp_path, body, "LCH003")) == is_removed


@pytest.mark.parametrize(
    ("body", "messages"),
    [
        ('<arg name="x" default="1"/>', ["unused"]),
        ('<arg name="x" default="1"/><param name="p" value="$(arg x)"/>', []),
        ('<arg name="x" default="1"/><param name="p" value="$(eval 2 * x)"/>', []),
        ('<arg name="x" default="1"/><param name="p" value="$(eval arg(\'x\'))"/>', []),
        ('<arg name="x" default="1"/><rosparam subst_value="true">p: $(arg x)</rosparam>', []),
        ('<arg name="x" default="1"/><include file="a.launch" pass_all_args="true"/>', []),
        ('<arg name="x" default="1"/><include file="$(find-pkg-share p)/a.launch.xml"/>', []),
        ('<include file="a.launch"><arg name="x" value="1"/></include>', []),
        ('<arg name="x"/><param name="p" value="$(arg x)"/>', ["required"]),
        ('<arg name="x" doc="why"/><param name="p" value="$(arg x)"/>', []),
        ('<!-- the file -->\n  <arg name="x"/><param name="p" value="$(arg x)"/>', []),
        ('<!-- all files -->\n\n<arg name="x"/><param name="p" value="$(arg x)"/>', ["required"]),
        ('<arg name="x"/>\n<!-- load --><param name="p" value="$(arg x)"/>', ["required"]),
    ],
)
def test_arguments(tmp_path: Path, body: str, messages: list[str]) -> None:
    assert [f.message_id for f in find_in_launch(tmp_path, body, "LCH004")] == messages


@pytest.mark.parametrize(
    ("include", "is_passed"),
    [
        ('<include file="$(find car)/launch/robot.launch"><arg name="x" value="1"/></include>', True),
        ('<include file="$(find car)/launch/$(arg which).launch"><arg name="x" value="1"/></include>', True),
        ('<include file="$(find car)/launch/other.launch"><arg name="x" value="1"/></include>', False),
        ('<include file="$(find bus)/launch/robot.launch"><arg name="x" value="1"/></include>', False),
        ('<include file="$(find old_car)/launch/robot.launch"><arg name="x" value="1"/></include>', True),
        ('<include file="$(dirname)/robot.launch"><arg name="x" value="1"/></include>', True),
        ('<include file="$(find car)/launch/robot.launch"><arg name="y" value="1"/></include>', False),
        ('<!--<include file="robot.launch"><arg name="x" value="1"/></include>-->', False),
        ('<include file="robot.launch"/><include file="b.launch"><arg name="x" value="1"/></include>', False),
    ],
)
def test_an_argument_that_another_launch_file_passes_is_not_deleted_alone(
    tmp_path: Path, include: str, is_passed: bool
) -> None:
    files = {"robot.launch": '<launch>\n<arg name="x"/>\n</launch>', "all.launch": f"<launch>{include}</launch>"}
    files["package.xml"] = '<package format="2"><name>car</name></package>'
    files["bus/package.xml"] = '<package format="2"><name>bus</name></package>'
    (finding,) = find(tmp_path, files, "LCH004", name="robot.launch")
    assert finding.fix is not None
    assert bool(finding.fix.edits) != is_passed
    assert ("all.launch): roslaunch refuses one that is not declared" in get_repair(finding)) == is_passed


@pytest.mark.parametrize(
    ("body", "message"),
    [
        ('<arg name="x" default="1"/><arg name="x" default="2"/>', "ros1"),
        ('<arg name="x" default="1"/><group><arg name="x" default="2"/></group>', "ros1"),
        ('<group><arg name="x" default="1"/></group><group><arg name="x" default="2"/></group>', None),
        ('<arg name="x" default="1"/><include file="f"><arg name="x" value="2"/></include>', None),
        ('<include file="f"><arg name="x" value="2"/><arg name="x" value="3"/></include>', "ros1"),
        ('<arg name="x" if="$(arg y)" default="1"/><arg name="x" unless="$(arg y)" default="2"/>', None),
        ('<node pkg="p" exec="n"/><arg name="x" default="1"/><arg name="x" default="2"/>', "ros2"),
        ('<node pkg="p" exec="n"/><arg name="x" default="1"/><group><arg name="x" default="2"/></group>', None),
        (
            '<node pkg="p" exec="n"/><include file="f"><arg name="x" value="2"/><arg name="x" value="3"/></include>',
            "handed",
        ),
        ("<arg/><arg/>", None),
    ],
)
def test_an_argument_is_declared_once_in_its_scope(tmp_path: Path, body: str, message: str | None) -> None:
    findings = find_in_launch(tmp_path, body, "LCH006")
    assert [f.message_id for f in findings] == ([] if message is None else [message])
    assert all((f.severity == Severity.ERROR) == (f.message_id == "ros1") for f in findings)


def test_only_a_declaration_that_says_the_same_is_deleted(tmp_path: Path) -> None:
    for value, expected in (("1", ['<arg name="x" default="1"/>']), ("2", [])):
        (finding,) = find_in_launch(tmp_path, f'<arg name="x" default="1"/><arg name="x" default="{value}"/>', "LCH006")
        assert finding.fix is not None
        assert [e.expected for e in finding.fix.edits] == expected


@pytest.mark.parametrize(("node", "read"), [('type="n"', "$(arg x)"), ('exec="n"', "$(var x)")])
def test_the_repair_reads_an_argument_as_the_generation_of_ros_does(tmp_path: Path, node: str, read: str) -> None:
    (finding,) = find_in_launch(tmp_path, f'<arg name="x" default="1"/><node name="n" pkg="p" {node}/>', "LCH004")
    assert finding.fix is not None
    assert f"`{read}`" in finding.fix.title


def test_a_required_argument_is_the_including_files_business(tmp_path: Path) -> None:
    (tmp_path / "all.launch").write_text('<launch><include file="robot.launch"/></launch>', encoding="utf-8")
    assert not find_in_launch(tmp_path, '<arg name="x"/><param name="p" value="$(arg x)"/>', "LCH004")


def test_a_line_is_deleted_with_its_line_break_and_nothing_else(tmp_path: Path) -> None:
    body = '\n  <arg name="x" default="1"/>\n  <param name="use_gui" value="1"/><param name="p" value="1"/>\n'
    body += '<node name="j" pkg="joint_state_publisher" type="joint_state_publisher"/>'
    (unused,) = find_in_launch(tmp_path, body, "LCH004")
    (leftover,) = find_in_launch(tmp_path, body, "LCH007")
    assert unused.fix is not None
    assert leftover.fix is not None
    assert [e.expected for e in unused.fix.edits] == ['  <arg name="x" default="1"/>\n']
    assert [e.expected for e in leftover.fix.edits] == ['<param name="use_gui" value="1"/>']


@pytest.mark.parametrize(
    ("nodes", "repairs"),
    [
        ("", []),
        ("joint_state_publisher", ["delete the line; start joint_state_publisher_gui if you want sliders"]),
        (
            "joint_state_publisher joint_state_publisher_gui",
            ["delete the line; the launch file starts joint_state_publisher_gui, which has the sliders"],
        ),
    ],
)
def test_a_parameter_of_joint_state_publisher_matters_where_that_is_started(
    tmp_path: Path, nodes: str, repairs: list[str]
) -> None:
    body = "".join(f'<node name="n" pkg="{name}" type="{name}"/>' for name in nodes.split())
    found = find_in_launch(tmp_path, f'<param name="use_gui" value="1"/>{body}', "LCH007")
    assert [finding.fix.title for finding in found if finding.fix is not None] == repairs


@pytest.mark.parametrize(("inner", "is_reported"), [("joint_state_publisher", True), ("rviz", False)])
def test_the_file_that_starts_it_may_be_included(tmp_path: Path, inner: str, is_reported: bool) -> None:
    other = f'<launch><node name="n" pkg="{inner}" type="{inner}"/></launch>'
    (tmp_path / "b.launch").write_text(other, encoding="utf-8")
    body = '<param name="use_gui" value="1"/><include file="$(dirname)/b.launch"/>'
    body += '<include file="$(find gazebo_ros)/launch/empty_world.launch"/>'
    assert bool(find_in_launch(tmp_path, body, "LCH007")) == is_reported


@pytest.mark.parametrize(("other", "exported"), [("tf_footprint_base", True), ("controllers", False)])
def test_an_exporter_is_named_beside_another_of_its_nodes(tmp_path: Path, other: str, exported: bool) -> None:
    body = '<node name="n" pkg="rostopic" type="rostopic" args="pub /calibrated std_msgs/Bool true"/>'
    beside = f'<node name="{other}" pkg="tf" type="static_transform_publisher" args="0 0 0 0 0 0 a b 40"/>'
    (finding,) = find_in_launch(tmp_path, body + beside, "LCH007")
    assert (finding.cause is not None) == exported


def test_an_element_with_content_is_not_deleted(tmp_path: Path) -> None:
    body = '<node name="n" pkg="rostopic" type="rostopic" args="pub /calibrated std_msgs/Bool true"><env/></node>'
    (finding,) = find_in_launch(tmp_path, body, "LCH007")
    assert finding.fix is not None
    assert not finding.fix.edits


# -- LCH005 ------------------------------------------------------------------------------------------------------------


def transform(words: str) -> str:
    return LOAD + f'<node name="t" pkg="tf2_ros" type="static_transform_publisher" args="{words}"/>'


@pytest.mark.parametrize(
    ("words", "messages"),
    [
        ("0 0 0 0 0 0 odom laser", ["second-parent"]),
        ("0 0 0 0 0 0 base_link laser", ["repeated"]),
        ("0 0 0 0 0 0 laser base_link", ["loop"]),
        ("0 0 0 0 0 0 bace_link camera", ["unknown-frame"]),
        ("0 0 0 0 0 0 camera_link camera_optical", []),
        ("0 0 0 0 0 0 map base_link 100", []),
        ("0 0 0 0 0 0 base_link camera", []),
        ("0 0 0 0 0 0 base_footprint base_link 40", []),
        ("0 0 0 0 0 0 1 base_link base_footprint", ["footprint-height"]),
        ("--frame-id base_link --child-frame-id base_footprint --z 1", ["footprint-height"]),
    ],
)
def test_static_transforms_against_the_model(tmp_path: Path, words: str, messages: list[str]) -> None:
    assert [f.message_id for f in find_in_package(tmp_path, transform(words), "LCH005")] == messages


@pytest.mark.parametrize(
    ("numbers", "apart"),
    [("1 0 0", ""), ("1 0 0.00005", ""), ("1 0 0.3", " (300 mm apart)"), ("0 0 0", " (1 m apart)")],
)
def test_a_transform_that_is_not_the_one_of_the_joint_says_how_far_it_is_off(
    tmp_path: Path, numbers: str, apart: str
) -> None:
    model = (
        '<robot name="r"><link name="base_link"/><link name="laser"/><joint name="j" type="fixed"><parent link="base_link"/>'
        '<child link="laser"/><origin xyz="1 0 0"/></joint></robot>'
    )
    files = {"package.xml": "<package format='3'><name>r</name></package>", "urdf/r.urdf": model}
    load = '<param name="robot_description" textfile="$(find r)/urdf/r.urdf"/>'
    for turn, said in (("0 0 0", apart), ("1.5707963 0 0", apart.replace("(", "(90° and ") or " (90° apart)")):
        node = (
            f'<node name="t" pkg="tf2_ros" type="static_transform_publisher" args="{numbers} {turn} base_link laser"/>'
        )
        launch = {"launch/a.launch": f"<launch>{load}{node}</launch>"}
        for name, text in (files | launch).items():
            path = tmp_path / turn[0] / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
        (finding,) = check(tmp_path / turn[0], codes={"LCH005"}).findings
        assert finding.headline == f"a joint publishes base_link → laser too{said}"


def test_a_transform_from_the_world_may_be_meant_for_the_root(tmp_path: Path) -> None:
    (finding,) = find_in_package(tmp_path, transform("0 0 0 0 0 0 map laser"), "LCH005")
    assert finding.fix is not None
    assert "write the root base_link for laser if the node is to place the robot in map" in finding.fix.title
    # Where another node places that frame below the robot, the root would be below itself.
    below = transform("0 0 0 0 0 0 map laser") + transform("0 0 0 0 0 0 base_link map")
    (finding,) = find_in_package(tmp_path / "x", below, "LCH005")
    assert finding.fix is not None
    assert "write the root" not in finding.fix.title


@pytest.mark.parametrize(
    ("words", "effect"),
    [
        ("0 0 0 0 0 0 base_link laser", "may jump if the two do not agree"),
        ("0 0 0 0 0 0 odom laser", "draws laser where the last message put it"),
        ("0 0 0 0 0 0 laser base_link", "reports lookup errors"),
        ("0 0 0 0 0 0 bace_link camera", "leaves camera unconnected"),
        ("0 0 0 0 0 0 1 base_link base_footprint", "once odometry publishes it"),
    ],
)
def test_each_conflict_of_frames_has_its_own_effect_in_rviz(tmp_path: Path, words: str, effect: str) -> None:
    (finding,) = find_in_package(tmp_path, transform(words), "LCH005")
    assert effect in finding.consequences["rviz"]


@pytest.mark.parametrize(
    ("shape", "ground"),
    [
        # A box of half sides 0.1 turned by 30° about x reaches 0.1 (cos 30° + sin 30°) below its centre.
        (BOX, 0.1 - 0.1366025),
        ('<geometry><sphere radius="0.3"/></geometry>', -0.3),
        ('<geometry><cylinder radius="0.3" length="1"/></geometry>', -0.5),
        ('<origin rpy="1.5707963267948966 0 0"/><geometry><cylinder radius="0.3" length="1"/></geometry>', -0.3),
    ],
)
def test_the_footprint_lies_at_the_lowest_point(tmp_path: Path, shape: str, ground: float) -> None:
    wrong, right = (f"0 0 {z} 0 0 0 base_link base_footprint 40" for z in (ground + 0.003, ground + 0.001))
    (finding,) = find_in_package(tmp_path / "wrong", transform(wrong), "LCH005", shape)
    assert finding.data["ground"] == pytest.approx(ground, abs=1e-6)
    (finding,) = find_in_package(tmp_path / "right", transform(right), "LCH005", shape)
    assert finding.message_id == "footprint"


# A program of the project that uses the footprint: without one, the exporter's line is on request.
NAMED = '<param name="base_frame" value="base_footprint"/>'


def test_a_footprint_is_no_root_where_odometry_publishes_the_base(tmp_path: Path) -> None:
    """Which frame that is, is in another package: a new root above the base would be its second parent."""
    for height, otherwise in (("0", "write z = -0.300 in the transform"), ("-0.3", "the transform is right")):
        words = f"0 0 {height} 0 0 0 base_link base_footprint 40"
        shape = '<geometry><sphere radius="0.3"/></geometry>'
        (finding,) = find_in_package(tmp_path / height, transform(words) + NAMED, "LCH005", shape)
        assert finding.fix is not None
        assert finding.fix.title.startswith(
            "if odometry publishes odom → base_footprint, make base_footprint the root link"
        )
        assert finding.fix.title.endswith(f"; if it publishes odom → base_link, {otherwise}")


def test_a_footprint_below_a_link_with_a_parent_is_only_deleted(tmp_path: Path) -> None:
    """A new root with a joint to the link would be its second parent; no height of the ground is known there either."""
    words = "0 0 0 0 0 0 laser base_footprint 40"
    (finding,) = find_in_package(tmp_path, transform(words), "LCH005")
    assert finding.message_id == "footprint"
    assert finding.fix is not None
    assert finding.fix.title == "delete the node: joint mount already makes base_link the parent of laser"
    assert finding.severity is Severity.WARNING


def test_on_a_bolted_arm_a_footprint_is_only_a_leftover(tmp_path: Path) -> None:
    arm = """<robot name="arm"><link name="world"/><link name="base_link"/>
    <joint name="base" type="fixed"><parent link="world"/><child link="base_link"/></joint></robot>"""
    files = {
        "package.xml": '<package format="2"><name>car</name></package>',
        "urdf/car.urdf": arm,
        "launch/car.launch": f"<launch>{transform('0 0 0 0 0 0 base_link base_footprint 40')}</launch>",
    }
    (finding,) = find(tmp_path / "car", files, "LCH005", name="launch/car.launch")
    assert finding.severity is Severity.INFO


@pytest.mark.parametrize("given", [".", "car"])
def test_another_package_of_the_given_folder_may_use_the_footprint(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, given: str
) -> None:
    files = {
        "car/package.xml": '<package format="2"><name>car</name></package>',
        "car/launch/car.launch": f"<launch>{transform('0 0 0 0 0 0 base_link base_footprint 40').removeprefix(LOAD)}</launch>",
        "navigation/package.xml": '<package format="2"><name>navigation</name></package>',
        "navigation/config/costmap.yaml": "robot_base_frame: base_footprint\n",
    }
    for name, text in files.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    monkeypatch.chdir(tmp_path)
    found = [f.message_id for f in check(Path(given), codes={"LCH005"}).findings]
    assert (found == ["footprint-unused"]) == (given == "car")


@pytest.mark.parametrize(("name", "is_exported"), [("tf_footprint_base", True), ("base_to_footprint", False)])
@pytest.mark.parametrize("beside", ["", NAMED])
def test_the_exporter_is_named_only_beside_its_own_node(
    tmp_path: Path, name: str, is_exported: bool, beside: str
) -> None:
    words = f'"static_transform_publisher" name="{name}" args="0 0 0 0 0 0 base_link base_footprint 40"'
    (finding,) = find_in_launch(tmp_path, f'<node pkg="tf" type={words}/>{beside}', "LCH005")
    assert (finding.cause is not None) == is_exported


def test_without_the_model_the_footprint_may_be_its_root_already(tmp_path: Path) -> None:
    words = "0 0 0 0 0 0 base_link base_footprint 40"
    (finding,) = find_in_launch(tmp_path, transform(words).removeprefix(LOAD), "LCH005")
    assert finding.message_id == "footprint-unused"
    (finding,) = find_in_launch(tmp_path, transform(words).removeprefix(LOAD) + NAMED, "LCH005")
    assert finding.fix is not None
    assert finding.fix.title.startswith("delete the node; a robot that needs base_footprint has it as the root link")
    assert finding.severity is Severity.INFO


def test_a_description_in_a_variable_leads_to_the_model(tmp_path: Path) -> None:
    body = """<let name="rd" value="$(command 'xacro $(find-pkg-share car)/urdf/car.urdf')"/>
    <node pkg="robot_state_publisher" exec="robot_state_publisher">
      <param name="robot_description" value="$(var rd)"/>
    </node>
    <node pkg="tf2_ros" exec="static_transform_publisher" args="0 0 0 0 0 0 odom laser"/>"""
    (finding,) = find_in_package(tmp_path, body, "LCH005")
    assert finding.message_id == "second-parent"
    (finding,) = find_in_package(tmp_path, body.replace("car.urdf", "cars.urdf"), "LCH001")
    assert finding.message_id == "file"
    quoted = body.replace(
        "'xacro $(find-pkg-share car)/urdf/car.urdf'", r"'xacro \'$(find-pkg-share car)/urdf/car.urdf\''"
    )
    assert quoted != body
    assert not find_in_package(tmp_path, quoted, "LCH001")


def test_without_the_meshes_only_the_direction_is_known(tmp_path: Path) -> None:
    shape = '<geometry><mesh filename="missing.stl"/></geometry>'
    (finding,) = find_in_package(
        tmp_path, transform("0 0 0 0 0 0 base_link base_footprint 40") + NAMED, "LCH005", shape
    )
    assert finding.message_id == "footprint"


def test_the_launch_file_of_the_first_car() -> None:
    """Everything that is wrong with it, at its line."""
    codes = {"LCH001", "LCH002", "LCH003", "LCH004", "LCH005", "LCH006", "LCH007"}
    run = check(FIXTURES / "car-3" / "launch" / "car.launch", codes=codes)
    lines = {(f.location.span.line, f.code, f.severity) for f in only(run) if f.location.span is not None}
    assert lines == {
        (8, "LCH007", Severity.INFO),
        (11, "LCH004", Severity.INFO),
        (14, "LCH007", Severity.INFO),
        (16, "LCH003", Severity.WARNING),
        (18, "LCH005", Severity.WARNING),
        (19, "LCH002", Severity.ERROR),
        (21, "LCH007", Severity.INFO),
    }
    (frame,) = (f for f in run.findings if f.code == "LCH005")
    assert frame.cause is not None
    assert frame.data["ground"] == pytest.approx(-0.030, abs=1e-5)


@pytest.mark.parametrize("folder", ["launch", "Documentation/files"])
def test_a_copy_in_a_folder_of_documents_is_not_started(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, folder: str
) -> None:
    node = '<node name="n" pkg="joint_state_publisher" type="joint_state_publisher"/>'
    (tmp_path / folder).mkdir(parents=True)
    monkeypatch.chdir(tmp_path)
    found = find_in_launch(tmp_path / folder, f'<param name="use_gui" value="1"/>{node}', "LCH007")
    assert bool(found) == (folder == "launch")


@pytest.mark.parametrize(
    ("folder", "severity"), [("launch", Severity.ERROR), ("Documentation/files", Severity.WARNING)]
)
def test_a_listing_in_a_folder_of_documents_loads_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, folder: str, severity: Severity
) -> None:
    (tmp_path / folder).mkdir(parents=True)
    monkeypatch.chdir(tmp_path)
    (finding,) = find_in_launch(tmp_path / folder, load("$(dirname)/gone.urdf"), "LCH001")
    assert finding.severity == severity


@pytest.mark.parametrize(("inside", "near"), [('<link name="a"/>', "arm.xacro"), ("", "")])
def test_a_file_of_macros_is_not_proposed_as_a_model(tmp_path: Path, inside: str, near: str) -> None:
    macro = '<xacro:macro name="arm" params=""><link name="b"/></xacro:macro>'
    text = f'<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">{macro}{inside}</robot>'
    (tmp_path / "arm.xacro").write_text(text, encoding="utf-8")
    body = '<param name="robot_description" command="xacro $(dirname)/arm.urdf"/>'
    (finding,) = find_in_launch(tmp_path, body, "LCH001")
    assert ("did you mean" in finding.message) == bool(near)
    assert near in finding.message


@pytest.mark.parametrize(
    ("passed", "package", "found"),
    [
        ("", "car", {"launch/sensors.launch": "include-default"}),
        ("my_", "car", {"launch/sensors.launch": "include-default", "launch/all.launch": "include-file"}),
        ("", "bus", {"launch/sensors.launch": "include-file"}),
        (None, "car", {"launch/sensors.launch": "include-file", "launch/all.launch": "include-file"}),
    ],
    ids=["it exists", "it does not", "of another package", "nothing is passed"],
)
def test_a_default_that_the_including_launch_file_replaces_is_judged_there(
    tmp_path: Path, passed: str | None, package: str, found: dict[str, str]
) -> None:
    line = "" if passed is None else f'<arg name="who" value="{passed}"/>'
    files = {
        "package.xml": "<package><name>car</name></package>",
        "bus/package.xml": "<package><name>bus</name></package>",
        "launch/sensors.launch": '<launch><arg name="who" default="arm_"/>'
        '<include file="$(find car)/launch/$(arg who)manager.launch"/></launch>',
        "launch/all.launch": f'<launch><include file="$(find {package})/launch/sensors.launch">{line}</include></launch>',
        "launch/manager.launch": "<launch/>",
    }
    if package == "bus":
        files["bus/launch/all.launch"] = files.pop("launch/all.launch")
        files["bus/launch/sensors.launch"] = "<launch/>"
    names = [name for name in files if name.endswith(("sensors.launch", "all.launch"))]
    told = {name: [f.message_id for f in find(tmp_path, files, "LCH001", name=name)] for name in names}
    assert {name: messages[0] for name, messages in told.items() if messages} == found


@pytest.mark.parametrize(
    ("inner", "files", "found"),
    [
        (
            '<arg name="robot" default="arm"/><arg name="file" default="$(find car)/$(arg robot).launch"/>'
            '<include file="$(arg file)"/>',
            {
                "all.launch": '<include file="$(find car)/launch/inner.launch"><arg name="robot" value="car"/></include>',
            },
            "include-default",
        ),
        (
            '<arg name="robot" default="arm"/><param name="robot_description" textfile="$(find car)/urdf/$(arg robot).urdf"/>',
            {"inner.test": '<include file="$(find car)/launch/inner.launch"><arg name="robot" value="car"/></include>'},
            "file-default",
        ),
        (
            '<arg name="robot" default="arm"/><include file="$(find car)/launch/show.launch">'
            '<arg name="file" value="$(find car)/urdf/$(arg robot).urdf"/></include>',
            {
                "show.launch": '<arg name="file"/><param name="robot_description" textfile="$(arg file)"/>',
                "all.launch": '<include file="$(find car)/launch/inner.launch"><arg name="robot" value="car"/></include>',
            },
            "file-default",
        ),
        (  # what is passed decides a value of the model, not the file
            '<arg name="robot" default="arm"/>'
            '<param name="robot_description" command="xacro $(find car)/urdf/arm.xacro name:=$(arg robot)"/>',
            {
                "all.launch": '<include file="$(find car)/launch/inner.launch"><arg name="robot" value="car"/></include>',
            },
            "file",
        ),
    ],
    ids=["in another argument", "by a test", "in what it passes on", "beside the path"],
)
def test_a_default_that_decides_a_path_indirectly_may_be_replaced_too(
    tmp_path: Path, inner: str, files: dict[str, str], found: str
) -> None:
    texts = {f"launch/{name}": f"<launch>{body}</launch>" for name, body in {"inner.launch": inner, **files}.items()}
    texts |= {
        "package.xml": "<package><name>car</name></package>",
        "urdf/car.urdf": "<robot name='car'><link name='a'/></robot>",
    }
    (finding,) = find(tmp_path, texts, "LCH001", name="launch/inner.launch")
    assert finding.message_id == found


@pytest.mark.parametrize(
    ("including", "is_given"),
    [
        (
            '<arg name="robot" default="car"/><include file="$(find car)/launch/inner.launch" pass_all_args="true"/>',
            True,
        ),
        ('<arg name="robot" default="car"/><include file="$(find car)/launch/inner.launch"/>', False),
        ('<include file="$(find car)/launch/inner.launch"><arg name="robot" value="car"/></include>', False),
        ('<include file="$(find car)/launch/inner.launch" pass_all_args="true"/>', False),
    ],
    ids=["all are passed", "none is passed", "roslaunch refuses it", "none of this name"],
)
def test_roslaunch_finds_an_argument_that_is_not_declared_where_all_are_passed(
    tmp_path: Path, including: str, is_given: bool
) -> None:
    files = {
        "package.xml": "<package><name>car</name></package>",
        "launch/inner.launch": '<launch><include file="$(find car)/launch/$(arg robot).launch"/>'
        '<param name="robot_description" textfile="$(find car)/urdf/$(arg robot).urdf"/></launch>',
        "launch/all.launch": f"<launch>{including}</launch>",
    }
    found = find(tmp_path, files, "LCH001", name="launch/inner.launch")
    assert [f.message_id for f in found] == (["unknown"] if is_given else ["include-argument", "argument"])


_PYTHON_INCLUDE = """
def generate_launch_description():
    file = PathJoinSubstitution([FindPackageShare({package!r}), "launch", "inner.launch.xml"])
    return LaunchDescription([IncludeLaunchDescription(file, launch_arguments={{"robot": "car"}}.items())])
"""


@pytest.mark.parametrize(
    ("name", "text", "is_given"),
    [
        ("all.launch.py", _PYTHON_INCLUDE.format(package="car"), True),
        ("all.py", _PYTHON_INCLUDE.format(package="car"), True),
        ("all.launch.py", _PYTHON_INCLUDE.format(package="car").replace('"robot"', '"model"'), False),
        (
            "all.launch.xml",
            '<launch><let name="robot" value="car"/><include file="$(find-pkg-share car)/launch/inner.launch.xml"/></launch>',
            True,
        ),
    ],
    ids=["Python", "Python of any name", "another argument", "XML"],
)
@pytest.mark.parametrize(
    ("declared", "without", "given"),
    [("", "include-argument", []), ('<arg name="robot" default="arm"/>', "include-file", ["include-default"])],
)
def test_a_launch_file_of_ros2_has_the_arguments_of_those_that_include_it(
    tmp_path: Path, name: str, text: str, is_given: bool, declared: str, without: str, given: list[str]
) -> None:
    files = {
        "package.xml": "<package><name>car</name></package>",
        "launch/inner.launch.xml": f"<launch>{declared}"
        '<include file="$(find-pkg-share car)/launch/$(var robot).launch.xml"/></launch>',
        f"launch/{name}": text,
    }
    found = find(tmp_path, files, "LCH001", name="launch/inner.launch.xml")
    assert [f.message_id for f in found] == (given if is_given else [without])


def test_a_model_that_a_program_writes_into_a_folder_of_the_system_is_known_only_at_launch(tmp_path: Path) -> None:
    files = {
        "package.xml": "<package><name>car</name></package>",
        "launch/a.launch": '<launch><arg name="world" default="/etc/car/world.xacro"/>'
        '<param name="robot_description" command="xacro $(arg world)"/></launch>',
    }
    found = {
        f.code: (f.message_id, f.severity) for f in find(tmp_path, files, {"LCH001", "XML001"}, name="launch/a.launch")
    }
    assert found["LCH001"] == ("unknown", Severity.INFO)
    assert "XML001" not in found


@pytest.mark.parametrize("has_other", [False, True])
def test_a_package_without_any_launch_file_may_be_a_placeholder_of_the_whole(tmp_path: Path, has_other: bool) -> None:
    files = {
        "car/package.xml": "<package><name>car</name></package>",
        "car/launch/a.launch": '<launch><include file="$(find camera)/launch/b.launch"/></launch>',
        "camera/package.xml": "<package><name>camera</name></package>",
    }
    if has_other:
        files["camera/launch/c.launch"] = "<launch/>"
    (tmp_path / ".git").mkdir()
    (finding,) = find(tmp_path, files, "LCH001", name="car/launch/a.launch")
    assert finding.fix is not None
    assert ("get all of camera" in finding.fix.title) is not has_other


def test_the_xacro_file_of_a_missing_model_is_named_before_its_parts(tmp_path: Path) -> None:
    inside = '<xacro:include filename="b.xacro"/><link name="a"/>'
    text = f'<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">{inside}</robot>'
    files = {
        "r.launch": '<launch><param name="robot_description" textfile="$(dirname)/r.urdf"/></launch>',
        "r.urdf.xacro": text,
        "r.urdf.xacro.xml": text,
    }
    (finding,) = find(tmp_path, files, "LCH001", name="r.launch")
    assert "there is 'r.urdf.xacro', which xacro must expand" in finding.message


@pytest.mark.parametrize(("other", "is_named"), [("arm2_model", False), ("parts", True)])
def test_the_file_of_another_robot_of_a_series_is_not_proposed(tmp_path: Path, other: str, is_named: bool) -> None:
    files = {
        "arm_model/package.xml": "<package><name>arm_model</name></package>",
        "arm_model/launch/a.launch": f"<launch>{load('$(find arm_model)/urdf/a.urdf')}</launch>",
        f"{other}/package.xml": f"<package><name>{other}</name></package>",
        f"{other}/urdf/a.urdf": '<robot name="r"><link name="a"/></robot>',
    }
    (tmp_path / ".git").mkdir()
    (finding,) = find(tmp_path, files, "LCH001", name="arm_model/launch/a.launch")
    assert ("the only file of this name" in finding.message) is is_named


@pytest.mark.parametrize(
    ("written", "is_missing"),
    [
        ("run('xacro %s > %s' % (model, made))", False),
        ("run(f'xacro {model} -o {made}')", False),
        ("run('xacro ' + model + ' > ' + made)", False),
        ("run('xacro {} > {}'.format(model, made))", False),
        ("run(['xacro', model, '-o', made])", False),
        ("open(made, 'w').write(text)", False),
        ("Path(made).write_text(text)", False),
        ("run(f'xacro {made} > {model}')", True),
        ("open(made)", True),
    ],
)
def test_a_model_that_the_launch_file_in_python_writes_is_not_missing(
    tmp_path: Path, written: str, is_missing: bool
) -> None:
    find_in_package(tmp_path, "", "LCH001")
    launch = tmp_path / "car/launch/car.launch.py"
    launch.write_text(f"made = join(get_package_share_directory('car'), 'urdf', 'made.urdf')\n{written}\n")
    assert [f.message_id for f in check(launch, codes={"LCH001"}).findings] == (["named"] if is_missing else [])


@pytest.mark.parametrize(("argument", "is_missing"), [("made", False), ("other", True)])
def test_a_model_whose_path_an_argument_says_may_be_written_by_the_launch_file(
    tmp_path: Path, argument: str, is_missing: bool
) -> None:
    find_in_package(tmp_path, "", "LCH001")
    launch = tmp_path / "car/launch/car.launch.py"
    launch.write_text(
        f"path = LaunchConfiguration({argument!r}).perform(context)\n"
        "run('xacro %s > %s' % (model, path))\n"
        "made = [join(get_package_share_directory('car'), 'urdf', 'made.urdf')]\n"
        "DeclareLaunchArgument('made', default_value=made)\n"
    )
    assert [f.message_id for f in check(launch, codes={"LCH001"}).findings] == (["named"] if is_missing else [])


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ("$(find car)/urdf/a.xacro -o $(find car)/urdf/made.urdf", "unknown"),
        ("-o $(find car)/urdf/made.urdf.bak $(find car)/urdf/made.urdf", "file"),
    ],
)
def test_a_model_that_the_launch_file_writes_with_xacro_is_not_missing(
    tmp_path: Path, arguments: str, message: str
) -> None:
    node = f'<node pkg="xacro" type="xacro" name="x" args="{arguments}"/>'
    (finding,) = find_in_package(tmp_path, node + load("$(find car)/urdf/made.urdf"), "LCH001")
    assert finding.message_id == message


def test_a_command_of_many_substitutions_is_searched_in_no_time(tmp_path: Path) -> None:
    """Each of them may be read in one way only: in two, this takes hours."""
    command = f"cp made.urdf > {'$(dirname)' * 60}"
    node = f'<node pkg="a" type="b" name="x" args="{command}"/>'
    (finding,) = find_in_package(tmp_path, node + load("$(find car)/urdf/made.urdf"), "LCH001")
    assert finding.message_id == "file"


@pytest.mark.parametrize("reader", ["README.md", "launch/all.launch", ""])
def test_what_the_exporter_writes_matters_where_a_file_names_its_launch_file(tmp_path: Path, reader: str) -> None:
    nodes = (
        '<node name="tf_footprint_base" pkg="tf" type="static_transform_publisher" '
        'args="0 0 0 0 0 0 base_link base_footprint 40"/>'
        '<node name="fake" pkg="rostopic" type="rostopic" args="pub /calibrated std_msgs/Bool true"/>'
    )
    files = {
        "package.xml": '<package format="2"><name>car</name></package>',
        "launch/gazebo.launch": f"<launch>{nodes}</launch>",
        "launch/other_gazebo.launch": "<launch/>",
    }
    started = '<launch><include file="$(find car)/launch/gazebo.launch"/></launch>'
    for name, text in (files | ({reader: started} if reader else {})).items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    found = check(tmp_path / "launch/gazebo.launch", codes={"LCH005", "LCH007"}).findings
    kinds = {"footprint-unused", "calibration"} if reader else {"footprint-idle", "calibration-idle"}
    assert {f.message_id for f in found} == kinds
    assert all(f.severity is Severity.INFO for f in found)


@pytest.mark.parametrize(
    ("readme", "severity"),
    [("For ROS Kinetic.", Severity.INFO), ("For ROS Kinetic and Noetic.", Severity.WARNING), ("", Severity.WARNING)],
)
def test_a_package_beside_says_which_ros_a_project_is_for(tmp_path: Path, readme: str, severity: Severity) -> None:
    (tmp_path / ".git").mkdir()
    command = "$(find xacro)/xacro.py $(find car)/urdf/car.urdf"
    find_in_package(tmp_path, f'<param name="robot_description" command="{command}"/>', "LCH003")
    beside = tmp_path / "arm"
    beside.mkdir()
    (beside / "package.xml").write_text("<package><name>arm</name></package>")
    (beside / "README.md").write_text(readme)
    (finding,) = check(tmp_path, codes={"LCH003"}).findings
    assert finding.severity == severity
    assert "starts nothing" in finding.consequences["roslaunch"]
