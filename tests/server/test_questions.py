"""What an editor asks about a place: values, definitions, uses, outline."""

from __future__ import annotations

from pathlib import Path

import pytest
from lsprotocol import types

from .editor import Editor

pytestmark = pytest.mark.slow

MACROS = """<robot xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:property name="density" value="1000"/>
  <xacro:macro name="arm" params="prefix parent length:=0.4">
    <xacro:property name="mass" value="${density * length * 0.01}"/>
    <link name="${prefix}_arm">
      <inertial>
        <origin xyz="0 0 ${length / 2}"/>
        <mass value="${mass}"/>
        <inertia ixx="0.02" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.01"/>
      </inertial>
    </link>
    <joint name="${prefix}_joint" type="revolute">
      <parent link="${parent}"/>
      <child link="${prefix}_arm"/>
      <axis xyz="0 1 0"/>
      <limit lower="-1.5707963" upper="${pi/4}" effort="10" velocity="1"/>
    </joint>
  </xacro:macro>
</robot>
"""
ROBOT = """<?xml version="1.0"?>
<robot name="two_arms" xmlns:xacro="http://www.ros.org/wiki/xacro"> <!-- 🤖 é -->
  <xacro:arg name="reach" default="0.5"/>
  <xacro:property name="sizes" value="${xacro.load_yaml('sizes.yaml')}"/>
  <xacro:include filename="arm.xacro"/>
  <material name="blue"><color rgba="0 0 1 1"/></material>
  <link name="base"><visual><geometry><box size="${sizes.base.width} 1 1"/></geometry><material name="blue"/></visual></link>
  <xacro:arm prefix="left" parent="base" length="$(arg reach)"/>
  <xacro:arm prefix="right" parent="left_arm"/>
</robot>
"""
YAML = "base:\n  width: 0.75\n"


@pytest.fixture
def robot(editor: Editor, project: Path) -> tuple[Path, Path]:
    """The robot and its macros, both open."""
    user, macros = project / "urdf/two_arms.urdf.xacro", project / "urdf/arm.xacro"
    user.write_text(ROBOT, encoding="utf-8")
    macros.write_text(MACROS)
    (project / "urdf/sizes.yaml").write_text(YAML)
    editor.open(user)
    editor.open(macros)
    editor.rest()
    return user, macros


def hover(editor: Editor, path: Path, at: types.Position) -> str:
    params = types.HoverParams(editor.identify(path), at)
    found = editor.wait(editor.client.text_document_hover_async(params))
    if found is None:
        return ""
    assert isinstance(found.contents, types.MarkupContent)
    return found.contents.value


def define(editor: Editor, path: Path, at: types.Position) -> set[tuple[str, str]]:
    """The definitions of the name at a position: file and text."""
    params = types.DefinitionParams(editor.identify(path), at)
    return read_places(editor, editor.wait(editor.client.text_document_definition_async(params)))


def refer(editor: Editor, path: Path, at: types.Position, *, declared: bool = False) -> list[tuple[str, int]]:
    """The uses of the name at a position: file and line."""
    context = types.ReferenceContext(include_declaration=declared)
    params = types.ReferenceParams(context, editor.identify(path), at)
    found = editor.wait(editor.client.text_document_references_async(params)) or []
    return sorted((Path(place.uri).name, place.range.start.line + 1) for place in found)


def read_places(editor: Editor, found: object) -> set[tuple[str, str]]:
    assert isinstance(found, list)
    files = {path.as_uri(): path for path in editor.texts}
    folder = next(iter(editor.texts)).parent
    files |= {path.as_uri(): path for path in folder.iterdir()}
    return {(files[place.uri].name, editor.read(files[place.uri], place.range)) for place in found}


def test_an_expression_shows_its_value_and_what_it_was_computed_from(editor: Editor, robot: tuple[Path, Path]) -> None:
    user, macros = robot
    text = hover(editor, macros, editor.find(macros, "${length / 2}", part="length"))
    assert "`${length / 2}` = `0.25` m in `link[left_arm]/inertial/origin@xyz`" in text
    assert "`${length / 2}` = `0.2` m in `link[right_arm]/inertial/origin@xyz`" in text
    text = hover(editor, macros, editor.find(macros, "${pi/4}"))
    assert text.startswith("`${pi/4}` = `0.7853981634` rad (45°)")
    text = hover(editor, user, editor.find(user, "$(arg reach)", part="reach"))
    assert text.count("argument `reach`") == 1
    assert "argument `reach` = `0.5`" in text
    text = hover(editor, user, editor.find(user, "sizes.base.width", part="width"))
    assert "`${sizes.base.width}` = `0.75` m" in text
    assert "yaml `base.width` = `0.75`, sizes.yaml:2" in text
    text = hover(editor, macros, editor.find(macros, "${density * length"))
    assert "`5.0`" in text
    assert "`4.0`" in text
    assert text.count("property `density` = `1000`, arm.xacro:2") == 1, "also where the cursor is on its name"


def test_links_and_joints_show_their_physics(editor: Editor, robot: tuple[Path, Path]) -> None:
    user, macros = robot
    text = hover(editor, user, editor.find(user, 'parent="base"', part="base"))
    assert "**link base**" in text, "the text that a macro is given becomes a name"
    text = hover(editor, user, editor.find(user, 'link name="base"', part="base"))
    assert "**link base**" in text
    text = hover(editor, macros, editor.find(macros, "<mass value", part="mass"))
    assert "**link left\\_arm**" in text
    assert "mass 5 kg, COM 0 0 0.25 m" in text
    assert "principal moments 0.01, 0.02, 0.02 kg m²" in text
    text = hover(editor, macros, editor.find(macros, "<axis xyz", part="axis"))
    assert "**joint right\\_joint**" in text
    assert "revolute, from left\\_arm to right\\_arm, about 0 1 0" in text
    assert "\\-90° to 45°, effort 10 N m, velocity 57.3°/s" in text


PLUGIN = """<gazebo><plugin name="p" filename="libp.so"><speed> ${2 * density} </speed><t><!-- ${x} --></t></plugin></gazebo>
  <link name="left_hand"/><link name="right_hand"/>
  <xacro:macro name="wrist" params="side">
    <joint name="${side}_wrist" type="fixed"><parent link="${side}_arm"/><child link="${side}_hand"/></joint>
  </xacro:macro>
  <xacro:wrist side="left"/><xacro:wrist side="right"/>
</robot>"""


def test_the_text_of_an_element_and_links_that_are_alike(editor: Editor, robot: tuple[Path, Path]) -> None:
    user, _ = robot
    editor.type(user, ROBOT.replace("</robot>", PLUGIN))
    editor.rest()
    assert hover(editor, user, editor.find(user, "${2 * density}", part="2")) == "`${2 * density}` = `2000`"
    params = types.InlayHintParams(editor.identify(user), types.Range(types.Position(9, 0), types.Position(9, 200)))
    (hint,) = editor.wait(editor.client.text_document_inlay_hint_async(params)) or []
    assert (hint.label, hint.position) == ("= 2000", editor.find(user, " </speed>"))
    text = hover(editor, user, editor.find(user, 'child link="${side}_hand', part="_hand"))
    assert "**links right\\_hand, left\\_hand**  \nno inertial" in text


def test_a_yaml_key_shows_what_is_computed_from_it(editor: Editor, robot: tuple[Path, Path]) -> None:
    user, _ = robot
    path = user.parent / "sizes.yaml"
    path.write_text("base: {height: 2, width: 0.75}\n")
    editor.open(path)
    editor.rest()
    at = editor.find(path, "width")
    subject = "`link[base]/visual/geometry/box@size`"
    assert hover(editor, path, at) == f"yaml `base.width` = `0.75`  \n- {subject}"
    assert refer(editor, path, at) == [(user.name, 7)]
    assert refer(editor, path, at, declared=True) == [("sizes.yaml", 1), (user.name, 7)]
    assert hover(editor, path, editor.find(path, "height")) == "", "nothing reads it"
    editor.type(path, "base: {height: 2, é: 🤖, width: 0.75}\n")
    assert refer(editor, path, editor.find(path, "width")) == [(user.name, 7)]
    editor.type(path, "base:\n  height: 2\n  width: 0.75\n")
    editor.rest()
    assert hover(editor, path, editor.find(path, "height")) == ""
    assert subject in hover(editor, path, editor.find(path, "0.75"))


def test_a_finding_shows_its_evidence(editor: Editor, robot: tuple[Path, Path]) -> None:
    _, macros = robot
    editor.type(macros, MACROS.replace('ixx="0.02"', 'ixx="0.2"'))
    found = next(d for d in editor.diagnostics(macros) if d.code == "INR003")
    text = hover(editor, macros, found.range.start)
    assert text.startswith("**INR003** ")
    assert "Fix" in text


def test_definitions_are_found_across_includes(editor: Editor, robot: tuple[Path, Path]) -> None:
    user, macros = robot
    assert define(editor, user, editor.find(user, "<xacro:arm", part="arm")) == {("arm.xacro", "arm")}
    assert define(editor, user, editor.find(user, "$(arg reach)", part="reach")) == {(user.name, "reach")}
    assert define(editor, user, editor.find(user, 'material name="blue"/', part="blue")) == {(user.name, "blue")}
    assert define(editor, macros, editor.find(macros, "${density", part="density")) == {("arm.xacro", "density")}
    assert define(editor, macros, editor.find(macros, "${length / 2}", part="length")) == {("arm.xacro", "length")}
    assert define(editor, macros, editor.find(macros, "${mass}", part="mass")) == {("arm.xacro", "mass")}
    where = editor.find(macros, 'child link="${prefix}_arm"', part="_arm")
    assert define(editor, macros, where) == {("arm.xacro", "${prefix}_arm")}
    assert define(editor, user, editor.find(user, 'filename="arm.xacro"', part="arm.")) == {("arm.xacro", "")}
    assert define(editor, user, editor.find(user, "sizes.base.width", part="width")) == {("sizes.yaml", "width")}


def test_uses_are_found_across_includes(editor: Editor, robot: tuple[Path, Path]) -> None:
    user, macros = robot
    density = editor.find(macros, 'name="density"', part="density")
    assert refer(editor, macros, density) == [("arm.xacro", 4)]
    assert refer(editor, macros, density, declared=True) == [("arm.xacro", 2), ("arm.xacro", 4)]
    assert refer(editor, macros, editor.find(macros, 'name="arm"', part="arm")) == [(user.name, 8), (user.name, 9)]
    assert refer(editor, user, editor.find(user, 'link name="base"', part="base")) == [
        ("arm.xacro", 13),
        (user.name, 8),
    ]
    length = editor.find(macros, "length:=0.4")
    assert refer(editor, macros, length) == [("arm.xacro", 4), ("arm.xacro", 7), (user.name, 8)]


def test_the_outline_is_the_kinematic_tree(editor: Editor, robot: tuple[Path, Path]) -> None:
    user, _ = robot
    params = types.DocumentSymbolParams(editor.identify(user))
    found = editor.wait(editor.client.text_document_document_symbol_async(params))

    def draw(symbols: object) -> dict[str, object]:
        assert isinstance(symbols, (list, tuple))
        return {symbol.name: draw(symbol.children or []) for symbol in symbols}

    arm = {"right_joint": {"right_arm": {}}}
    assert draw(found) == {"reach": {}, "sizes": {}, "base": {"left_joint": {"left_arm": arm}}}
    base = next(symbol for symbol in found or () if symbol.name == "base")
    assert isinstance(base, types.DocumentSymbol)
    assert editor.read(user, base.range).startswith('<link name="base"><visual>')
    assert editor.read(user, base.selection_range) == '<link name="base">'
    assert editor.read(user, base.children[0].range).startswith('<xacro:arm prefix="left"')


def test_values_are_beside_their_expressions(editor: Editor, robot: tuple[Path, Path]) -> None:
    _, macros = robot
    range_ = types.Range(types.Position(0, 0), types.Position(99, 0))
    params = types.InlayHintParams(editor.identify(macros), range_)
    found = editor.wait(editor.client.text_document_inlay_hint_async(params)) or []
    shown = {hint.position.line + 1: hint.label for hint in found}
    assert shown[4] == "= 5.0 | 4.0"
    assert shown[7] == "= 0 0 0.25 | 0 0 0.2"


def list_lenses(editor: Editor, path: Path) -> dict[str, str]:
    """The code lenses of a file by the text that they are above."""
    params = types.CodeLensParams(editor.identify(path))
    found = editor.wait(editor.client.text_document_code_lens_async(params)) or []
    lines = editor.texts[path].split("\n")
    return {lines[lens.range.start.line].strip()[:22]: lens.command.title for lens in found if lens.command is not None}


def test_a_macro_shows_who_uses_it_and_what_is_wrong_with_it(editor: Editor, robot: tuple[Path, Path]) -> None:
    user, macros = robot
    unused = '  <xacro:macro name="unused" params=""/>\n</robot>'
    editor.type(macros, MACROS.replace('ixx="0.02"', 'ixx="0.2"').replace("</robot>", unused))
    (macros.parent / "other.urdf.xacro").write_text(ROBOT.replace("two_arms", "other"), encoding="utf-8")
    other = types.FileEvent((macros.parent / "other.urdf.xacro").as_uri(), types.FileChangeType.Created)
    editor.client.workspace_did_change_watched_files(types.DidChangeWatchedFilesParams([other]))
    editor.rest()
    assert list_lenses(editor, macros) == {
        '<robot xmlns:xacro="ht': "used by 2 robots · 1 error",
        '<xacro:macro name="arm': "used by 2 robots · 1 error",
        '<xacro:macro name="unu': "used by no robot",
    }
    assert list_lenses(editor, user) == {'<robot name="two_arms"': "3 links · 2 joints · 1 error"}


def test_elements_and_comments_of_several_lines_can_be_folded(editor: Editor, robot: tuple[Path, Path]) -> None:
    user, _ = robot
    editor.type(
        user,
        "<robot>\n  <!-- a\n 🤖 -->\n  <link name='a>b'\n    id='1'>\n    <x/>\n    <y>\n  </link>\n  <z></z>\n</robot>\n",
    )
    params = types.FoldingRangeParams(editor.identify(user))
    found = editor.wait(editor.client.text_document_folding_range_async(params)) or []
    assert {(fold.start_line, fold.end_line, fold.kind) for fold in found} == {
        (0, 8, None),
        (1, 2, types.FoldingRangeKind.Comment),
        (3, 6, None),
    }


def test_answers_survive_a_text_that_does_not_parse(editor: Editor, robot: tuple[Path, Path]) -> None:
    """What was known of the last robot that could be made, where the text is still the same."""
    user, macros = robot
    editor.type(user, "<!-- 🤖 -->\n" + ROBOT.replace("<link", "<<link"))
    assert "XML001" in editor.codes(user)
    assert "argument `reach`" in hover(editor, user, editor.find(user, "$(arg reach)"))
    assert define(editor, user, editor.find(user, "<xacro:arm", part="arm")) == {("arm.xacro", "arm")}
    assert "`0.25`" in hover(editor, macros, editor.find(macros, "${length / 2}"))


def complete(editor: Editor, path: Path, text: str, *, at: str) -> dict[str, str]:
    """What can be typed at a mark in a text, and what that writes."""
    editor.type(path, text.replace(at, "", 1))
    before = text[: text.index(at)]
    line = before.rpartition("\n")[2]
    position = types.Position(before.count("\n"), len(line.encode("utf-16-le")) // 2)
    params = types.CompletionParams(editor.identify(path), position)
    found = editor.wait(editor.client.text_document_completion_async(params)) or []
    assert isinstance(found, list)
    return {item.label: item.text_edit.new_text for item in found if item.text_edit is not None}


def test_what_the_model_knows_can_be_completed(editor: Editor, robot: tuple[Path, Path]) -> None:
    user, _ = robot

    def ask(typed: str) -> dict[str, str]:
        return complete(editor, user, ROBOT.replace("</robot>", f"{typed}\n</robot>"), at="|")

    assert set(ask('<joint name="j" type="fixed"><parent link="|')) == {"base", "left_arm", "right_arm"}
    assert set(ask('<joint name="j" type="|"/>')) >= {"revolute", "prismatic"}
    assert ask('<joint name="|"/>') == {}
    assert set(ask('<gazebo reference="le|"/>')) >= {"left_arm", "left_joint"}
    assert set(ask('<link name="${|')) == {"density", "sizes"}
    assert set(ask('<link name="$(arg |')) == {"reach"}
    assert set(ask('<visual><material name="|"/>')) == {"blue"}
    assert {"link", "joint", "xacro:if", "xacro:arm"} <= set(ask("<|"))
    assert "inertial" in ask('<link name="x"><iner|')
    assert ask('<link name="x"></|') == {"link": "link>"}
    assert ask('<xacro:arm prefix="x" |') == {"parent": 'parent=""', "length": 'length=""'}
    assert set(ask("<limit lower='1' |/>")) >= {"upper", "effort"}
    assert ask("<!-- <|") == {}
    assert {"gazebo", "ros2_control"} <= set(ask("<|"))
    control = '<ros2_control name="c" type="system">'
    assert set(ask('<ros2_control type="|')) == {"actuator", "sensor", "system"}
    assert {name for name in ask(f"{control}<|") if ":" not in name} == {"gpio", "hardware", "joint", "sensor"}
    assert "command_interface" in ask(f'{control}<joint name="left_joint"><|')
    assert "axis" not in ask(f'{control}<joint name="left_joint"><|')
    assert "velocity" in ask(f'{control}<joint name="left_joint"><command_interface name="|')
    assert set(ask('<xacro:property name="p" scope="|')) == {"global", "parent"}


def test_names_are_completed_where_they_are_known(editor: Editor, robot: tuple[Path, Path]) -> None:
    """Also those that were typed a moment ago; the parameters and properties of a macro in it only."""
    user, macros = robot

    def ask(path: Path, text: str, typed: str) -> set[str]:
        return set(complete(editor, path, text.replace("</robot>", f"{typed}\n</robot>"), at="|"))

    new = '<!-- <link name="old"/> --> <link name="new"/> <joint name="turn" type="fixed"> <child link="new"/>'
    found = ask(user, ROBOT, f'{new} <parent link="|')
    assert "new" in found
    assert "old" not in found
    assert "turn" in ask(user, ROBOT, f'{new} </joint> <gazebo reference="|')
    macro = '<xacro:macro name="hand" params="side *block span:=0.1"> <xacro:property name="half" value="1"/> <link name="${|'
    assert ask(user, ROBOT, macro) == {"density", "sizes", "side", "block", "span", "half"}
    assert ask(user, ROBOT, f'{macro.replace("|", "")}x}}"/></xacro:macro> <link name="${{|') == {"density", "sizes"}
    inside = MACROS.replace("<axis", '<xacro:if value="${|"/><axis')
    assert set(complete(editor, macros, inside, at="|")) >= {"mass", "prefix", "parent", "length", "density"}


def test_packages_and_files_can_be_completed(editor: Editor, robot: tuple[Path, Path]) -> None:
    user, _ = robot
    (user.parent.parent / "meshes/visual").mkdir(parents=True)
    for name in ("meshes/base.stl", "meshes/notes.txt", "meshes/.hidden.stl", "meshes/visual/arm.DAE"):
        (user.parent.parent / name).write_text("")

    def ask(typed: str) -> dict[str, str]:
        return complete(editor, user, ROBOT.replace("</robot>", f"{typed}\n</robot>"), at="|")

    assert ask('<mesh filename="package://|')["robot"] == "robot/"
    assert ask('<mesh filename="package://robot/|') == {"meshes": "meshes/", "urdf": "urdf/"}
    assert ask('<mesh filename="package://robot/meshes/ba|') == {"base.stl": "base.stl", "visual": "visual/"}
    assert ask('<mesh filename="file://$(find robot)/meshes/visual/|') == {"arm.DAE": "arm.DAE"}
    assert ask('<xacro:include filename="$(find rob|')["robot"] == "robot)"
    assert set(ask('<xacro:include filename="|')) == {"arm.xacro", user.name}
    assert ask('<mesh filename="pack|')["package://"] == "package://"
    assert "notes.txt" in ask('<xacro:property name="p" value="$(find robot)/meshes/|')
    assert ask('<mesh filename="package://robot/../../|') == {}, "what may not be read is not listed"
    assert ask('<mesh filename="${prefix}/|') == {}
    assert ask('<link name="|') == {}
