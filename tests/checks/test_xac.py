"""XAC: what the pages cannot show: every way in which xacro fails, quiet cases, fixes, severities."""

from __future__ import annotations

from pathlib import Path

import pytest
from builders import find, link, robot
from conftest import check, check_text

from urdfcheck.core import Applicability, Finding, Run, Severity
from urdfcheck.core.text import format_argument_option
from urdfcheck.facts.likeness.typed_numbers import find_near_miss

HEAD = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">\n'
BASE = '<link name="base"/>\n'


def xacro(folder: Path, text: str, codes: set[str], **request: object) -> Run:
    run = check_text(folder, HEAD + BASE + text + "</robot>\n", "robot.urdf.xacro", codes=codes, **request)
    assert not run.failures
    return run


def only(run: Run) -> Finding:
    (finding,) = run.findings
    return finding


@pytest.mark.parametrize(
    ("text", "message", "says"),
    [
        ('<link name="${true}"/>', "undefined-name", "'True'"),
        ('<link name="${PI}"/>', "undefined-name", "'pi'"),
        ('<xacro:macro name="m" params="a"><xacro:property name="p" value="1"/></xacro:macro><link name="${p}"/>',
         "undefined-name", "belongs to another macro"),
        ('<xacro:macro name="wheel" params=""/><xacro:weel/>', "unknown-macro", "'wheel'"),
        ('<xacro:weel/>', "unknown-macro", "in the file, nor any other"),
        ('<xacro:macro name="wheel" params="a bore"/><xacro:wheel a="1" bor="2"/>', "parameter-unknown", "'bore'"),
        ('<xacro:macro name="wheel" params="a b:=2 c"/><xacro:wheel a="1"/>', "parameters-missing", "macro wheel lacks c"),
        ('<xacro:macro name="wheel" params="*origin"/><xacro:wheel/>', "blocks", "Not enough blocks"),
        ('<xacro:macro name="wheel" params=""/><xacro:wheel><origin/></xacro:wheel>', "blocks", "Unused block"),
        ('<xacro:macro name="w" params="*origin"><xacro:insert_block name="orign"/></xacro:macro>'
         "<xacro:w><a/></xacro:w>",
         "undefined-block", "'origin'"),
        ('<xacro:include filename="nothing.xacro"/>', "file-missing", "nothing.xacro does not exist"),
        ('<xacro:include filename="package://arm/urdf/arm.xacro"/>', "file-missing", "xacro does not know package://"),
        ("""<link name="${xacro.load_yaml('nothing.yaml')}"/>""", "file-missing", "nothing.yaml does not exist"),
        ('<xacro:if value="maybe"><link name="a"/></xacro:if>', "condition", "neither true nor false"),
        ('<xacro:include file="a.xacro"/>', "attribute-missing", "requires the attribute filename"),
        ('<xacro:property name="a" value="${b}"/><xacro:property name="b" value="${a}"/><link name="${a}"/>',
         "endless", "a -> b -> a"),
        ('<xacro:macro name="m" params=""><xacro:m/></xacro:macro><xacro:m/>', "endless", "never ends"),
        ('<link name="${1 +}"/>', "syntax", "`1 +` is not a valid expression"),
        ("""<link name="${ {'a': 1}['a'] }"/>""", "syntax", "is not a valid expression"),
        ('<link name="${1/0}"/>', "expression-failed", "division by zero"),
        ("""<link name="${dict(left=1)['right']}"/>""", "expression-failed", "there is no key 'right'"),
        ("""<link name="${xacro.fatal('no such type')}"/>""", "refused", "no such type"),
        ('<link name="$(env HOME)"/>', "environment-unread", "HOME counts as not set"),
    ],
)  # fmt: skip
def test_each_way_to_fail_is_one_located_finding(tmp_path: Path, text: str, message: str, says: str) -> None:
    finding = only(xacro(tmp_path, text, {"XAC001"}))
    assert finding.message_id == message
    assert says in finding.message
    assert finding.location.span is not None
    assert finding.location.span.line == 3


INSERTED = '<xacro:insert_block name="origin"/>'


@pytest.mark.parametrize(
    ("text", "repair"),
    [
        (f"<joint>{INSERTED}</joint>", "delete the line if it is left over; else define the block before it"),
        (f"<joint><origin/>{INSERTED}</joint>", "delete the line: the <joint> has its own <origin>"),
        (
            f'<!-- <xacro:macro name="m" params="a *origin"> --><joint>{INSERTED}</joint>',
            "delete the line; or take the <xacro:macro> of line 3",
        ),
        (
            f'<!-- <xacro:macro name="m" params="*other"> --><joint>{INSERTED}</joint>',
            "delete the line if it is left over; else define the block before it",
        ),
        (
            f'<xacro:macro name="m" params=""><joint><origin/>{INSERTED}</joint></xacro:macro><xacro:m/>',
            "delete the line: the <joint> has its own <origin>",
        ),
        (
            f'<xacro:macro name="m" params=""><joint>{INSERTED}</joint></xacro:macro><xacro:m/>',
            "delete the line if it is left over; else add `*origin` to the params of macro m",
        ),
    ],
)
def test_a_block_that_a_macro_left_behind_is_to_be_deleted(tmp_path: Path, text: str, repair: str) -> None:
    finding = only(xacro(tmp_path, text, {"XAC001"}))
    assert finding.message_id == "undefined-block"
    assert finding.fix is not None
    assert finding.fix.title.startswith(repair)


CALLED = '<xacro:macro name="finger" params=""><link name="finger"/></xacro:macro>'
CALLER = '<xacro:macro name="hand" params=""><xacro:finger/></xacro:macro>'


@pytest.mark.parametrize(
    ("text", "line"),
    [
        (f"<xacro:finger/>\n{CALLED}", 4),
        (f"{CALLER}\n<xacro:hand/>\n{CALLED}", 5),
        (f'<xacro:include filename="hand.xacro"/>\n{CALLED}', 4),
        (f'<xacro:finger/>\n<xacro:if value="false">{CALLED}</xacro:if>', None),
        (f'<xacro:if value="false">{CALLED}</xacro:if><xacro:finger/>\n{CALLED}', None),
        (f'<xacro:if value="false">{CALLED}</xacro:if>{CALLER}<xacro:hand/>', None),
    ],
)
def test_macro_that_is_defined_below_its_call_is_not_unknown(tmp_path: Path, text: str, line: int | None) -> None:
    write(tmp_path, {"hand.xacro": HEAD + "<xacro:finger/></robot>"})
    finding = only(xacro(tmp_path, text, {"XAC001"}))
    assert finding.message_id == ("unknown-macro" if line is None else "macro-later")
    if line is not None:
        assert finding.data["line"] == line
        assert [place.span.line for place in finding.related if place.span is not None] == [line]


def test_other_macros_that_are_called_before_their_definitions_are_to_be_moved_too(tmp_path: Path) -> None:
    macro = '<xacro:macro name="{0}" params=""><link name="{0}"/></xacro:macro>'
    text = f"{macro.format('a')}<xacro:a/><xacro:b/><xacro:c/><xacro:c/>{macro.format('b')}{macro.format('c')}"
    finding = only(xacro(tmp_path, text, {"XAC001"}))
    assert finding.fix is not None
    assert finding.fix.title == "move the definition of b above this call, as those of c, which are called early too"


def test_macro_may_call_one_that_is_defined_below_it(tmp_path: Path) -> None:
    finding = only(xacro(tmp_path, f"{CALLER}{CALLED}<xacro:hand/><xacro:thumb/>", {"XAC001"}))
    assert finding.data["name"] == "thumb"


def test_failure_in_a_macro_names_the_calls_and_the_definition(tmp_path: Path) -> None:
    text = """<xacro:property name="a" value="${radius * 2}"/>
<xacro:macro name="wheel" params="name"><link name="${name}_${a}"/></xacro:macro>
<xacro:wheel name="w"/>
"""
    finding = only(xacro(tmp_path, text, {"XAC001"}))
    assert finding.location.subject == "property[a]"
    assert finding.location.span is not None
    assert finding.location.span.line == 3
    assert [v.line for v in finding.location.via] == [5]
    assert finding.related[0].span is not None
    assert finding.related[0].span.line == 4
    assert finding.data["macros"] == ["wheel"]


@pytest.mark.slow
def test_endless_recursion_points_at_the_call_that_closes_the_circle(tmp_path: Path) -> None:
    text = """<xacro:macro name="a" params=""><xacro:b/></xacro:macro>
<xacro:macro name="b" params=""><xacro:a/></xacro:macro>
<xacro:a/>
"""
    location = only(xacro(tmp_path, text, {"XAC001"})).location
    assert location.span is not None
    assert (location.span.line, [v.line for v in location.via]) == (3, [5, 3, 4])


def test_text_between_tags_is_located_at_its_element(tmp_path: Path) -> None:
    finding = only(xacro(tmp_path, "<gazebo>\n<a>1</a>\n<mu1>${friction}</mu1>\n</gazebo>", {"XAC001"}))
    assert finding.location.subject == "gazebo/mu1"


def test_optional_include_that_is_missing_is_no_failure(tmp_path: Path) -> None:
    text = '<xacro:include filename="nothing.xacro" optional="true"/>\n<link name="${gap}"/>'
    finding = only(xacro(tmp_path, text, {"XAC001"}))
    assert finding.location.span is not None
    assert finding.location.span.line == 4


def test_empty_file_name_names_the_argument_that_is_empty(tmp_path: Path) -> None:
    text = """<xacro:arg name="file" default=""/>
<xacro:property name="data" value="${xacro.load_yaml('$(arg file)')}"/>
<link name="${data['a']}"/>
"""
    finding = only(xacro(tmp_path, text, {"XAC001"}))
    assert finding.message_id == "file-name-empty"
    assert "argument file is empty" in finding.message
    assert finding.location.span is not None
    assert finding.location.span.line == 3
    assert finding.data["remedy"] == "--arg file:=…"


@pytest.mark.parametrize("condition", ['unless value="${read}"', 'if value="${not read}"'])
def test_a_guard_gets_a_default(tmp_path: Path, condition: str) -> None:
    inside = '<xacro:property name="read" value="true"/><link name="a"/>'
    guarded = f"<xacro:{condition}>{inside}</xacro:{condition.partition(' ')[0]}>"
    finding = only(xacro(tmp_path, guarded, {"XAC001"}))
    assert finding.fix is not None
    written = '<xacro:property name="read" default="false"/>'
    assert f"`{written}`" in finding.fix.title
    assert not xacro(tmp_path, f"{written}{guarded}{written}{guarded}", {"XAC001"}).findings


LOAD = """<xacro:arg name="left_arm" default=""/><xacro:arg name="left_dof" default=""/>
<xacro:macro name="load" params="arm dof">
  <xacro:include filename="$(dirname)/arms/${arm}/${dof}dof/urdf/${arm}_macro.xacro"/>
</xacro:macro>
<xacro:property name="arm" value="$(arg left_arm)"/>
<xacro:load arm="${arm}" dof="$(arg left_dof)"/><link name="l"/>"""


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ({}, "arguments left_arm (default '') and left_dof (default '') lead to"),
        ({"left_arm": "gen9", "left_dof": "7"}, "argument left_arm ('gen9' is given) leads to"),
        ({"left_arm": "gen3", "left_dof": "9"}, "argument left_dof ('9' is given) leads to"),
    ],
)
def test_missing_file_is_told_at_the_arguments_that_lead_there(
    tmp_path: Path, arguments: dict[str, str], says: str
) -> None:
    part = tmp_path / "arms/gen3/7dof/urdf/gen3_macro.xacro"
    part.parent.mkdir(parents=True)
    part.write_text('<robot xmlns:xacro="http://www.ros.org/wiki/xacro"/>')
    finding = only(xacro(tmp_path, LOAD, {"XAC001"}, arguments=arguments))
    assert finding.message.startswith(says)
    assert finding.location.subject == f"argument[{says.split()[1]}]"
    assert "xacro:include@filename" in [place.subject.split("/")[-1] for place in finding.related]
    assert finding.data["remedy"].startswith(f"--arg {says.split()[1]}:=")
    complete = xacro(tmp_path, LOAD, {"XAC001"}, arguments={"left_arm": "gen3", "left_dof": "7"})
    assert not complete.findings


def test_an_argument_that_no_file_declares_leads_to_a_missing_file_too(tmp_path: Path) -> None:
    text = """<xacro:property name="all" value="${xacro.load_yaml('$(arg config)')}"/><link name="${all['name']}"/>"""
    given = {"config": str(tmp_path / "gen9/a.yaml")}
    finding = only(xacro(tmp_path, text, {"XAC001"}, arguments=given))
    assert (finding.message_id, finding.data["argument"]) == ("argument-leads-nowhere", "config")


@pytest.mark.parametrize("defined", ["", '<xacro:property name="camera" value="eye"/>'])
def test_nothing_can_be_defined_before_the_attributes_of_the_robot(tmp_path: Path, defined: str) -> None:
    text = HEAD.replace('"r"', '"${camera}"') + defined + BASE + "</robot>"
    finding = only(check_text(tmp_path, text, "robot.urdf.xacro", codes={"XAC001"}))
    assert finding.fix is not None
    assert finding.fix.title.startswith("write a fixed text here: xacro evaluates the attributes of <robot> before")


@pytest.mark.parametrize("suffix", [".urdf.xacro", "_macro.xacro"])
def test_a_name_without_its_beginning_is_an_empty_argument(tmp_path: Path, suffix: str) -> None:
    part = HEAD + '<xacro:include filename="$(dirname)/$(arg arm)' + suffix + '"/></robot>'
    write(tmp_path, {f"arms/{name}{suffix}": HEAD + "</robot>" for name in ("px100", "wx200")})
    write(tmp_path, {f"arms/any{suffix}": part})
    text = f'<xacro:arg name="arm" default=""/><xacro:include filename="$(dirname)/arms/any{suffix}"/>'
    finding = only(xacro(tmp_path, text, {"XAC001", "PKG012"}))
    assert finding.message_id == "argument-empty"
    assert finding.message.endswith("does not exist; known values: px100, wx200")
    assert finding.data["remedy"] == format_argument_option("arm", "px100")
    assert not xacro(tmp_path, text, {"XAC001", "PKG012"}, arguments={"arm": "wx200"}).findings


def test_a_hidden_file_that_exists_is_not_opened(tmp_path: Path) -> None:
    write(tmp_path, {".urdf.xacro": HEAD + '<link name="secret"/></robot>'})
    text = '<xacro:arg name="arm" default=""/><xacro:include filename="$(dirname)/$(arg arm).urdf.xacro"/>'
    assert [f.code for f in xacro(tmp_path, text, {"XAC001", "PKG012"}).findings] == ["PKG012"]


CONDITIONAL = """<xacro:arg name="prefix" default=""/><xacro:property name="side" value="$(arg prefix)"/>
<xacro:if value="${side == 'left'}"><xacro:property name="corner" value="1"/></xacro:if>
<xacro:if value="${side == 'right'}"><xacro:property name="corner" value="2"/></xacro:if>
<link name="l${corner}"/>"""


def test_a_condition_that_is_one_argument_names_the_default_that_is_no_truth(tmp_path: Path) -> None:
    text = '<xacro:arg name="gps" default="30.0"/>\n<xacro:if value="$(arg gps)"><link name="a"/></xacro:if>'
    finding = only(xacro(tmp_path, text, {"XAC001"}))
    assert finding.fix is not None
    assert finding.fix.title == "write true or false as the default of gps (line 3), or compare it here"
    assert [place.span and place.span.line for place in finding.related] == [3]


def test_property_that_is_only_defined_under_conditions_names_them_and_their_arguments(tmp_path: Path) -> None:
    finding = only(xacro(tmp_path, CONDITIONAL, {"XAC001"}))
    assert "only defined if `${side == 'left'}` or if `${side == 'right'}`" in finding.message
    assert finding.fix is not None
    assert finding.fix.title.startswith("give a value for which it is defined: `--arg prefix:=left`")
    assert finding.data["remedy"] == "--arg prefix:=left", "a value that a condition names"
    assert not xacro(tmp_path, CONDITIONAL, {"XAC001"}, arguments={"prefix": "left"}).findings


@pytest.mark.parametrize(
    ("conditional", "remedy"),
    [
        (CONDITIONAL.replace('default=""', 'default="up"').replace("left", "up' and 0 or side == 'right"), "right"),
        (CONDITIONAL.replace("== 'left'", "!= ''").replace("== 'right'", "!= ''"), None),
        (CONDITIONAL.replace("left", "; rm x"), "; rm x"),
    ],
    ids=["another than now", "none is named", "quoted for the shell"],
)
def test_the_proposed_value_is_another_one_that_a_condition_names(
    conditional: str, remedy: str | None, tmp_path: Path
) -> None:
    assert only(xacro(tmp_path, conditional, {"XAC001"})).data["remedy"] == format_argument_option("prefix", remedy)


def test_names_in_a_proposed_command_are_quoted_for_the_shell(tmp_path: Path) -> None:
    finding = only(xacro(tmp_path, '<link name="$(arg a;id)"/>', {"XAC010"}))
    assert finding.data["remedy"] == "--arg 'a;id':=…"
    finding = only(xacro(tmp_path, '<xacro:include filename="$(find p;id)/a.xacro"/>', {"PKG001"}))
    assert finding.data["remedy"] == "--package 'p;id'=FOLDER"


@pytest.mark.parametrize(
    "more",
    [
        '<xacro:property name="corner" value="3"/>',
        '<xacro:if value="${side == \'\'}"><xacro:property name="corner" value="3"/></xacro:if>',
    ],
    ids=["without a condition", "under one that holds"],
)
def test_property_that_comes_later_is_told_as_that(tmp_path: Path, more: str) -> None:
    finding = only(xacro(tmp_path, f"{CONDITIONAL}\n{more}", {"XAC001"}))
    assert "comes later, or belongs to another macro or branch" in finding.message
    assert finding.data["remedy"] == ""


def test_a_file_whose_name_has_other_capitals_is_meant(tmp_path: Path) -> None:
    (tmp_path / "arm.trans").write_text("<robot/>")
    finding = only(xacro(tmp_path, '<xacro:include filename="Arm.trans"/>', {"XAC001"}))
    assert finding.fix is not None
    assert finding.fix.title.startswith("write `arm.trans`, or rename the file")


def test_a_path_from_another_folder_is_written_from_that_of_the_file(tmp_path: Path) -> None:
    files = {
        "package.xml": "<package><name>car</name></package>",
        "xacro/parts/wheel.xacro": HEAD + "</robot>",
        "xacro/car.urdf.xacro": HEAD + '<xacro:include filename="xacro/parts/wheel.xacro"/><link name="b"/></robot>',
    }
    finding = only(check(write(tmp_path, files) / "xacro/car.urdf.xacro", codes={"XAC001"}))
    assert "only from" in finding.message
    assert finding.fix is not None
    assert finding.fix.title == "write `parts/wheel.xacro`"


def test_slip_in_a_path_with_an_empty_argument_is_told_at_the_path(tmp_path: Path) -> None:
    (tmp_path / "meterials.xacro").write_text("<robot/>")
    text = '<xacro:arg name="prefix" default=""/><xacro:include filename="$(arg prefix)materials.xacro"/>'
    finding = only(xacro(tmp_path, text, {"XAC001"}))
    assert (finding.message_id, finding.data["hint"]) == ("file-missing", " (did you mean 'meterials.xacro'?)")


@pytest.mark.parametrize(
    ("others", "hint"),
    [
        (["car.trans"], " (the only other .trans file there is 'car.trans')"),
        (["car.trans", "arm.trans"], ""),
        (["car.gazebo"], ""),
    ],
)
def test_the_only_file_of_a_kind_is_named_for_a_missing_one(tmp_path: Path, others: list[str], hint: str) -> None:
    for name in others:
        (tmp_path / name).write_text("<robot/>")
    finding = only(xacro(tmp_path, '<xacro:include filename="guzergah.trans"/>', {"XAC001"}))
    assert (finding.message_id, finding.data["hint"]) == ("file-missing", hint)


def test_a_file_beside_a_missing_one_that_includes_the_model_is_not_meant(tmp_path: Path) -> None:
    for name in ("robot_colour.xacro", "whole.xacro"):
        (tmp_path / name).write_text(HEAD + '<xacro:include filename="robot.urdf.xacro"/></robot>')
    finding = only(xacro(tmp_path, '<xacro:include filename="robot_colours.xacro"/>', {"XAC001"}))
    assert (finding.message_id, finding.data["hint"]) == ("file-missing", "")


@pytest.mark.parametrize("has_size", [False, True])
def test_a_file_is_proposed_that_brings_the_expansion_further(tmp_path: Path, has_size: bool) -> None:
    (tmp_path / "package.xml").write_text("<package><name>arm</name></package>")
    macro = '<xacro:macro name="cover" params=""><link name="cover"/></xacro:macro>'
    needed = "" if has_size else '<link name="cover_${size}"/>'
    (tmp_path / "cover.xacro").write_text(HEAD.replace(' name="r"', "") + needed + macro + "</robot>")
    finding = only(xacro(tmp_path, "<xacro:cover/>", {"XAC001"}))
    assert finding.message_id == "unknown-macro"
    assert finding.fix is not None
    proposal = "include cover.xacro, which defines the macro, before this line, or "
    assert finding.fix.title == proposal * has_size + "correct the name"


def test_a_missing_file_of_a_submodule_that_is_not_checked_out(tmp_path: Path) -> None:
    (tmp_path / "package.xml").write_text("<package><name>rover</name></package>")
    (tmp_path / ".gitmodules").write_text('[submodule "camera"]\n\tpath = camera\n\turl = https://git.example/camera\n')
    (tmp_path / "camera").mkdir()
    finding = only(xacro(tmp_path, '<xacro:include filename="camera/urdf/camera.xacro"/>', {"XAC001"}))
    assert finding.fix is not None
    assert finding.fix.title == "check out its submodule: `git submodule update --init camera`"


def test_a_submodule_with_the_name_of_a_folder_that_has_files_is_not_meant(tmp_path: Path) -> None:
    folder = tmp_path / "rover"
    folder.mkdir()
    (folder / "package.xml").write_text("<package><name>rover</name></package>")
    (folder / ".gitmodules").write_text('[submodule "rover"]\n\tpath = lib/rover\n\turl = https://git.example/rover\n')
    finding = only(xacro(folder, '<xacro:include filename="gone.xacro"/>', {"XAC001"}))
    assert finding.fix is not None
    assert "submodule" not in finding.fix.title


def test_a_name_that_is_not_defined_there_either_is_not_meant(tmp_path: Path) -> None:
    text = '<xacro:macro name="m" params="length"/><link name="${lenght}"/>'
    finding = only(xacro(tmp_path, text, {"XAC001"}))
    assert (finding.message_id, finding.data["hint"]) == ("undefined-name", "")


@pytest.mark.parametrize("build", ["", "convert_model(${arms}/arm.dae)\nadd_custom_target(all ALL)"])
def test_a_missing_file_that_the_build_may_make_is_built_first(tmp_path: Path, build: str) -> None:
    (tmp_path / "package.xml").write_text("<package><name>arm</name></package>")
    (tmp_path / "CMakeLists.txt").write_text(build)
    write(tmp_path, {"arm.urdf.xacro": HEAD + '<xacro:include filename="arm.urdf"/></robot>'})
    finding = only(check(tmp_path / "arm.urdf.xacro", codes={"XAC001"}))
    assert finding.message_id == "file-missing"
    assert finding.data["repair"].startswith("build arm first" if build else "correct the path")


@pytest.mark.parametrize(
    ("build", "template", "severity"),
    [
        ("", "urdf/plugins.xacro.in", Severity.WARNING),
        ('set(MADE plugins.xacro)\nfile(DOWNLOAD "${URL}" ${MADE})', "", Severity.WARNING),
        ("make_model(arm.wrl plugins.xacro)\nadd_custom_target(all ALL)", "", Severity.WARNING),
        ("install(FILES urdf/plugins.xacro DESTINATION urdf)\nadd_custom_target(all ALL)", "", Severity.ERROR),
        ("set(FILES urdf/plugins.xacro)\ninstall(FILES ${FILES} DESTINATION urdf)", "", Severity.ERROR),
    ],
)
def test_a_file_that_the_build_makes_is_missing_only_before_it(
    tmp_path: Path, build: str, template: str, severity: Severity
) -> None:
    files = {"package.xml": "<package><name>arm</name></package>", "CMakeLists.txt": build}
    files |= {template: HEAD + "</robot>"} if template else {}
    files |= {"urdf/arm.urdf.xacro": HEAD + BASE + '<xacro:include filename="plugins.xacro"/></robot>'}
    finding = only(check(write(tmp_path, files) / "urdf/arm.urdf.xacro", codes={"XAC001"}))
    assert (finding.severity, finding.blocks_check) == (severity, True)
    assert finding.data["repair"].startswith("build arm first, which may make the file")
    assert ("; the build makes it of " in finding.message) == bool(template)
    assert "did you mean" not in finding.message


def test_missing_yaml_key(tmp_path: Path) -> None:
    (tmp_path / "a.yaml").write_text("a: 1\n", encoding="utf-8")
    text = """<xacro:property name="data" value="${xacro.load_yaml('a.yaml')}"/><link name="${data['b']}"/>"""
    finding = only(xacro(tmp_path, text, {"XAC001"}))
    assert (finding.message_id, finding.data["key"]) == ("key-missing", "b")


@pytest.mark.parametrize(
    "use",
    [
        '<link name="l_${size}"/>',
        '<xacro:macro name="m" params="size:=^"><link name="${size}"/></xacro:macro>',
        '<xacro:macro name="m" params="x:=${size}"/>',
        '<xacro:property name="other" value="${2 * size}"/><link name="${other}"/>',
        '<xacro:if value="${False}"><link name="${size}"/></xacro:if>',
        "<gazebo><mu1>${size}</mu1></gazebo>",
        "<link name=\"${python.list(['size'])}\"/>",
        '<xacro:property name="size" remove="true"/><link name="${size if False else 1}"/>',
    ],
)
def test_property_read_in_any_way_is_used(tmp_path: Path, use: str) -> None:
    run = xacro(tmp_path, f'<xacro:property name="size" value="1"/>\n{use}\n', {"XAC002"})
    assert not run.findings


def test_property_for_another_scope_is_meant_for_others(tmp_path: Path) -> None:
    out = '<xacro:property name="out" value="1" scope="parent"/>'
    text = f'<xacro:macro name="m" params="">{out}</xacro:macro><xacro:m/>'
    assert not xacro(tmp_path, text, {"XAC002"}).findings


def test_unread_property_is_removed_with_its_line(tmp_path: Path) -> None:
    finding = only(xacro(tmp_path, '  <xacro:property name="size" value="1"/>\n', {"XAC002"}))
    assert finding.fix is not None
    assert finding.fix.applicability is Applicability.UNSAFE
    assert [e.expected for e in finding.fix.edits] == ['  <xacro:property name="size" value="1"/>\n']


def test_many_unread_properties_are_one_finding_for_the_file(tmp_path: Path) -> None:
    text = "\n".join(f'<xacro:property name="size_{i}" value="1"/>' for i in range(4))
    assert only(xacro(tmp_path, text, {"XAC002"})).data["count"] == 4
    assert len(xacro(tmp_path, text, {"XAC002"}, options={"XAC002": {"each": 4}}).findings) == 4


def test_file_that_cannot_be_expanded_has_no_unused_properties(tmp_path: Path) -> None:
    run = xacro(tmp_path, '<xacro:property name="a" value="1"/><link name="${gap}"/>', {"XAC002"})
    assert only(run).code == "XAC001", "nobody asked for it, but it is why the model was not checked"


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("M_PI", "3.14159", "rounded"),
        ("M_PI", "3.14159265", None),  # nine digits: 1.1e-9
        ("M_PI", "3.1415926", "rounded"),
        ("PI", "3.41", "wrong"),
        ("pi", "3.14", "hides"),
        ("pi", "3.141592653589793", "redefined"),
        ("PI_2", "1.5707963267948966", None),
        ("PI_2", "1.5708", "rounded"),
        ("DEG2RAD", "0.0174533", "rounded"),
        ("deg_to_rad", "0.017453292519943295", None),
        ("pilot", "3.14", None),
        ("M_PI", "${3 + 0.14}", None),
    ],
)
def test_constants(tmp_path: Path, name: str, value: str, message: str | None) -> None:
    run = xacro(tmp_path, f'<xacro:property name="{name}" value="{value}"/><link name="l_${{{name}}}"/>', {"XAC005"})
    assert [f.message_id for f in run.findings] == ([message] if message else [])


def test_tolerance_of_constants_is_wider_than_the_noise_of_literals() -> None:
    """Nine digits pass here; a literal angle of nine digits is a near miss, because siblings show what was meant."""
    assert find_near_miss("3.14159265") is not None


@pytest.mark.parametrize(
    ("value", "severity"), [("3.14", Severity.WARNING), ("3.1415", Severity.INFO), ("3.14159", Severity.INFO)]
)
def test_an_error_that_no_robot_repeats_is_an_info(tmp_path: Path, value: str, severity: Severity) -> None:
    text = f'<xacro:property name="M_PI" value="{value}"/><link name="l_${{M_PI}}"/>'
    assert only(xacro(tmp_path, text, {"XAC005"})).severity == severity


def test_constant_that_nothing_reads_is_an_info_and_hides_the_unused_property(tmp_path: Path) -> None:
    finding = only(xacro(tmp_path, '<xacro:property name="M_PI" value="3.14159"/>', {"XAC002", "XAC005"}))
    assert (finding.code, finding.severity, finding.data["hides"]) == ("XAC005", Severity.INFO, ["XAC002"])


@pytest.mark.parametrize(
    ("main", "other"),
    [
        ('<xacro:include filename="$(find not_installed)/a.xacro"/>', ""),
        ('<xacro:include filename="$(find not_installed)/a.xacro"/>', "wheel.xacro"),
        ('<xacro:if value="${False}"><xacro:include filename="wheel.xacro"/></xacro:if>', "wheel.xacro"),
        ('<xacro:if value="${False}"><xacro:include filename="parts/wheel.xacro"/></xacro:if>', "parts/wheel.xacro"),
    ],
)
def test_constant_that_an_unreached_file_may_read_is_not_deleted(tmp_path: Path, main: str, other: str) -> None:
    if other:
        (tmp_path / other).parent.mkdir(exist_ok=True)
        (tmp_path / other).write_text(f'{HEAD}<link name="${{M_PI}}"/></robot>', encoding="utf-8")
    text = f'<xacro:property name="M_PI" value="3.14"/>\n{main}'
    (finding,) = (f for f in xacro(tmp_path, text, {"XAC005"}).findings if not f.blocks_check)
    assert (finding.message_id, finding.severity) == ("rounded", Severity.INFO)
    assert finding.fix is not None
    assert [e.replacement for e in finding.fix.edits] == ["${pi}"]


def test_optional_part_below_a_folder_without_package_may_read_a_property(tmp_path: Path) -> None:
    text = '<xacro:if value="${False}"><xacro:include filename="parts/wheel.xacro"/></xacro:if>'
    assert not xacro(tmp_path, f'<xacro:property name="size" value="1"/>{text}', {"XAC002"}).findings


@pytest.mark.parametrize(("value", "digits"), [("3.14159", 6), ("03.1415926e0", 8), ("3.14", 3)])
def test_digits_of_a_rounded_constant_are_counted(tmp_path: Path, value: str, digits: int) -> None:
    text = f'<xacro:property name="M_PI" value="{value}"/><link name="l_${{M_PI}}"/>'
    assert f"with only {digits} digits" in only(xacro(tmp_path, text, {"XAC005"})).message


@pytest.mark.parametrize(
    ("namespace", "message"),
    [
        ("http://ros.org/wiki/xacro", "legacy"),
        ("http://www.ros.org/wiki/xacro/#interface", "legacy"),
        ("http://www.ros.org/wiki/xarco", "misspelt"),
        ("http://wiki.ros.org/xacro", None),
        ("https://example.org/my/own/macros", None),
    ],
)
def test_namespaces(tmp_path: Path, namespace: str, message: str | None) -> None:
    text = f'<robot name="r" xmlns:xacro="{namespace}"><link name="a"/></robot>'
    findings = check_text(tmp_path, text, "r.urdf.xacro", codes={"XAC006"}).findings
    assert [f.message_id for f in findings] == ([message] if message else [])
    assert all(f.fix is not None and f.fix.applicability is Applicability.SAFE for f in findings)


def test_one_address_in_all_files_of_a_package_is_one_finding(tmp_path: Path) -> None:
    old = 'xmlns:xacro="http://ros.org/wiki/xacro"'
    (tmp_path / "package.xml").write_text("<package><name>p</name></package>")
    (tmp_path / "b.xacro").write_text(f'<robot {old}><link name="b"/></robot>')
    text = f'<robot name="r" {old}><xacro:include filename="b.xacro"/></robot>'
    (finding,) = check_text(tmp_path, text, "r.urdf.xacro", codes={"XAC006"}).findings
    assert "in 2 files" in finding.message
    assert finding.fix is not None
    assert {Path(e.span.file).name for e in finding.fix.edits} == {"r.urdf.xacro", "b.xacro"}


def wheels(*, count: int = 3, mass: str = "1") -> str:
    return "".join(
        f'<link name="w{i}"><inertial><origin xyz="0 0 0" rpy="0 0 0"/><mass value="{mass}"/>'
        '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
        f'<joint name="j_w{i}" type="fixed"><parent link="base"/><child link="w{i}"/><origin xyz="{i} 0 0"/></joint>\n'
        for i in range(count)
    )


def test_three_blocks_make_a_group_and_two_do_not(tmp_path: Path) -> None:
    assert only(xacro(tmp_path, wheels(), {"XAC009"})).data["differences"] == ["joint origin xyz"]
    assert not xacro(tmp_path, wheels(count=2), {"XAC009"}).findings


def corners(*, pitch: str = "0", masses: tuple[str, ...] = ("1", "1", "1", "1")) -> str:
    """Four wheels as a CAD export types them: those on the right are turned by half a turn."""
    places = [("0.1", "0.2"), ("-0.1", "0.2"), ("0.1", "-0.2"), ("-0.1", "-0.2")]
    return "".join(
        f'<link name="w{i}"><inertial><origin xyz="0 0 0" rpy="0 0 0"/><mass value="{masses[i]}"/>'
        '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
        f'<joint name="j_w{i}" type="continuous"><parent link="base"/><child link="w{i}"/>'
        f'<origin xyz="{x} {y} 0" rpy="0 {"0" if i else pitch} {"0" if y > "0" else "3.1416"}"/>'
        f'<axis xyz="0 {1 if y > "0" else -1} 0"/></joint>\n'
        for i, (x, y) in enumerate(places)
    )


def test_macro_has_no_parameter_for_a_number_in_which_one_block_stands_alone(tmp_path: Path) -> None:
    finding = only(xacro(tmp_path, corners(pitch="-0.75"), {"XAC009"}))
    assert "; only w0 has pitch -0.75, the others 0" in finding.message
    assert finding.data["parameters"] == "name x y"
    assert finding.fix is not None
    assert "this drops pitch -0.75 of w0" in finding.fix.title
    assert '<xacro:w name="w0" x="0.1" y="0.2"/>' in finding.fix.title


def test_macro_derives_what_follows_from_the_side(tmp_path: Path) -> None:
    finding = only(xacro(tmp_path, corners(), {"XAC009"}))
    assert finding.fix is not None
    assert ", with yaw `${0 if y > 0 else pi}` and axis_y `${1 if y > 0 else -1}`" in finding.fix.title
    assert "only" not in finding.message


def test_two_against_two_and_two_against_one_are_parameters(tmp_path: Path) -> None:
    two = only(xacro(tmp_path, corners(masses=("1", "2", "2", "1")), {"XAC009"}))
    assert two.data["parameters"] == "name x y mass"
    three = wheels().replace('value="1"', 'value="2"', 1)
    assert only(xacro(tmp_path, three, {"XAC009"})).data["parameters"] == "name mass x"


def test_digits_of_noise_do_not_tell_blocks_apart(tmp_path: Path) -> None:
    text = wheels().replace('ixy="0"', 'ixy="-4.2e-22"', 1).replace('value="1"', 'value="1.00000001"', 1)
    assert only(xacro(tmp_path, text, {"XAC009"})).data["differences"] == ["joint origin xyz"]


def test_blocks_of_another_structure_or_short_ones_make_no_group(tmp_path: Path) -> None:
    assert not xacro(tmp_path, wheels().replace('type="fixed"', "", 1), {"XAC009"}).findings
    assert not xacro(tmp_path, "".join(f'<link name="l{i}"/>' for i in range(9)), {"XAC009"}).findings


def test_plain_urdf_has_no_macros_to_write(tmp_path: Path) -> None:
    text = f'<robot name="r">{BASE}{wheels()}</robot>'
    assert not check_text(tmp_path, text, codes={"XAC009"}).findings


def test_missing_argument_is_an_error_whether_the_file_was_named_or_found(tmp_path: Path) -> None:
    text = '<xacro:property name="p" value="$(arg side)"/>\n<link name="${p}_$(arg other)"/>'
    named = only(xacro(tmp_path, text, {"XAC010", "XAC001"}))
    assert (named.severity, named.location.subject) == (Severity.ERROR, "property[p]")
    assert named.data["missing"] == ["side", "other"]
    found = only(check(tmp_path, codes={"XAC010"}))
    assert found.severity is Severity.ERROR
    given = xacro(tmp_path, text, {"XAC010"}, arguments={"side": "left", "other": "x"})
    assert not given.findings


def test_argument_read_by_an_expression(tmp_path: Path) -> None:
    run = xacro(tmp_path, "<link name=\"${xacro.arg('side')}\"/>", {"XAC010", "XAC001"})
    assert only(run).code == "XAC010"
    assert run.models[0].status == "needs-arguments"


@pytest.mark.parametrize(
    "expression",
    [
        "().__class__",
        "[x.__class__ for x in [1]]",
        "(lambda: 1)()",
        "'\\x7b0.real\\x7d'.format(1)",
        "'a'.encode()",
        "9**9**9",
        "'a' * 10**9",
        "python.vars(list)",
        "__import__('os')",
    ],
)
def test_unsafe_expressions_are_never_evaluated(tmp_path: Path, expression: str) -> None:
    finding = only(xacro(tmp_path, f'<link name="${{{expression}}}"/>', {"XAC011", "XAC001"}))
    assert finding.code == "XAC011"


@pytest.mark.parametrize(
    ("expression", "message", "says"),
    [
        ("${open('/etc/passwd').read()}", "outside", "open is not a function"),
        ("${globals()}", "outside", "globals is not a function"),
        ("$(eval __import__('os').system('true'))", "outside", "two underscores"),
        ("${list(map(lambda i: i * 2, [1]))}", "construct", "it contains a lambda"),
        ("${'a'.encode()}", "method", "the attribute .encode of a str"),
        ("${2**99999}", "too_large", "more than 3,010 digits"),
        ("$(eval 'a'*99999999)", "too_large", "more than 1,000,000 characters"),
        ("${(lambda: ().__class__)()}", "unsafe", ".__class__"),
    ],
)
def test_refused_expressions_say_what_they_are(tmp_path: Path, expression: str, message: str, says: str) -> None:
    finding = only(xacro(tmp_path, f'<link name="{expression}"/>', {"XAC011", "XAC001"}))
    assert (finding.code, finding.message_id) == ("XAC011", message)
    assert says in finding.message


def test_yaml_that_asks_for_python_is_told_at_its_line_with_its_reader(tmp_path: Path) -> None:
    (tmp_path / "f.yaml").write_text("a: 1\nb: !!python/object/apply:os.system ['true']\n")
    text = """<xacro:property name="c" value="${xacro.load_yaml('f.yaml')}"/>\n<link name="${c.a}"/>"""
    finding = only(xacro(tmp_path, text, {"XAC011", "XAC001"}))
    assert (finding.code, finding.message_id) == ("XAC011", "tag")
    assert "!!python/object/apply:os.system" in finding.message
    assert finding.location.span is not None
    assert (Path(finding.location.span.file).name, finding.location.span.line) == ("f.yaml", 2)
    assert [r.span.line for r in finding.related if r.span] == [4, 3]


def test_ignored_variables_are_one_finding_with_every_place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TOKEN", "secret")
    text = """<xacro:property name="p" value="$(optenv TOKEN 1)"/>
<xacro:macro name="m" params="n"><link name="l${n}_${p}_$(optenv SIDE left)"/></xacro:macro>
<xacro:m n="1"/><xacro:m n="2"/>
"""
    finding = only(xacro(tmp_path, text, {"XAC016"}))
    assert finding.severity is Severity.INFO
    assert finding.data["variables"] == ["SIDE", "TOKEN"]
    assert "secret" not in str(finding)
    assert [s.line for s in (finding.location.span, *(r.span for r in finding.related)) if s] == [3, 4]
    assert "--env SIDE --env TOKEN" in finding.fix.title if finding.fix else False


def test_names_of_builtins_are_ordinary_names_of_properties(tmp_path: Path) -> None:
    forgotten = only(xacro(tmp_path / "a", '<link name="${type}"/>', {"XAC011", "XAC001"}))
    assert forgotten.code == "XAC001"
    text = '<xacro:property name="type" value="arm"/><link name="${type}"/>'
    assert not xacro(tmp_path / "b", text, {"XAC011", "XAC001"}).findings


@pytest.mark.parametrize(
    ("text", "says", "repair"),
    [
        ("", "foo is not defined, so `$(eval foo+1)` has no value", '`<xacro:arg name="foo" default="…"/>`'),
        ('<xacro:arg name="fooo" default="1"/>', "did you mean 'fooo'?", "write `fooo`"),
        ('<xacro:property name="foo" value="1"/>', "reads only arguments", "write the expression as `${…}`"),
    ],
)
def test_eval_reads_arguments_and_no_properties(tmp_path: Path, text: str, says: str, repair: str) -> None:
    finding = only(xacro(tmp_path, f'{text}<link name="$(eval foo+1)"/>', {"XAC001"}))
    assert says in finding.message
    assert finding.fix is not None
    assert repair in finding.fix.title


def test_yaml_that_cannot_be_read_is_located_in_its_file(tmp_path: Path) -> None:
    (tmp_path / "a.yaml").write_text("a: 1\nb: [1, 2\nc: 3\n", encoding="utf-8")
    text = """<xacro:property name="data" value="${xacro.load_yaml('a.yaml')}"/><link name="${data['b']}"/>"""
    run = xacro(tmp_path, text, {"XAC001"})
    finding = only(run)
    assert (finding.message_id, finding.location.subject) == ("yaml", "yaml")
    span = finding.location.span
    assert span is not None
    assert (span.file.rpartition("/")[2], span.line, span.col) == ("a.yaml", 3, 2)
    assert run.sources[span.file].startswith("a: 1")
    assert finding.related[0].span is not None
    assert finding.related[0].span.file.endswith("robot.urdf.xacro")


@pytest.mark.parametrize(
    ("command", "fixed"),
    [
        ("$(find xacro)/xacro --inorder 'a.xacro'", "$(find xacro)/xacro 'a.xacro'"),
        ("xacro -i a.xacro", "xacro a.xacro"),
        ("xacro a.xacro --inorder", "xacro a.xacro "),
        ("cat -i a.urdf", None),
        ("xacro a.xacro name:=x--inorder", None),
    ],
)
def test_in_order_option(tmp_path: Path, command: str, fixed: str | None) -> None:
    text = f'<launch>\n<param name="robot_description" command="{command}"/>\n</launch>'
    findings = check_text(tmp_path, text, "a.launch", codes={"XAC014"}).findings
    assert len(findings) == (fixed is not None)
    for finding in findings:
        assert finding.fix is not None
        (edit,) = finding.fix.edits
        assert finding.location.span is not None
        assert text[finding.location.span.start : finding.location.span.end] in {"--inorder", "-i"}
        assert fixed is not None
        assert fixed in text[: edit.span.start] + edit.replacement + text[edit.span.end :]


def make_robot_of_mass(name: str, mass: str, extra: str = "") -> str:
    """Return a robot of three links with this mass."""
    links = (link(f"l{i}", f'<inertial><mass value="{mass}"/></inertial>') for i in range(3))
    return robot(*links, extra, name=name, xacro=True)


def package(folder: Path, urdf: str, xacro_text: str, **options: float) -> Run:
    (folder / "package.xml").write_text("<package><name>p</name></package>", encoding="utf-8")
    (folder / "r.urdf").write_text(urdf, encoding="utf-8")
    (folder / "r.urdf.xacro").write_text(xacro_text, encoding="utf-8")
    return check(folder, codes={"XAC015"}, options={"XAC015": options})


def test_copies_are_compared_as_numbers(tmp_path: Path) -> None:
    assert not package(tmp_path, make_robot_of_mass("r", "1.0"), make_robot_of_mass("r", "${1}")).findings
    finding = only(package(tmp_path, make_robot_of_mass("r", "1"), make_robot_of_mass("r", "2")))
    assert finding.message_id == "diverged"
    assert finding.data["values"] == [f"link[l{i}]/inertial/mass@value" for i in range(3)]
    assert "3 values (link[l0]/inertial/mass@value: 1.0 and 2.0, " in finding.message
    assert finding.model == "r.urdf"


def test_copies_that_differ_in_name_and_extensions_only(tmp_path: Path) -> None:
    finding = only(package(tmp_path, make_robot_of_mass("a", "1"), make_robot_of_mass("b", "1", "<gazebo/>")))
    assert finding.message_id == "equal-bodies"
    assert "('a' and 'b')" in finding.message
    assert "0 and 1 <gazebo>" in finding.message
    assert finding.fix is not None
    assert finding.fix.title.startswith("nothing if they are meant to differ"), "one may be for a simulator"


def test_a_urdf_that_the_xacro_includes_is_no_copy(tmp_path: Path) -> None:
    around = '<xacro:include filename="r.urdf"/><gazebo/>'
    load = '<launch><param name="robot_description" textfile="$(find p)/r.urdf"/></launch>'
    (tmp_path / "bare.launch").write_text(load, encoding="utf-8")  # so that it is a model, too
    run = package(tmp_path, make_robot_of_mass("r", "1"), robot(around, name="r", xacro=True))
    assert not run.findings
    assert {model.path.rpartition("/")[2] for model in run.models} == {"r.urdf", "r.urdf.xacro"}


def test_copies_for_other_hardware_are_each_right(tmp_path: Path) -> None:
    block = '<ros2_control name="c"><hardware><plugin>{}</plugin></hardware></ros2_control>'
    made, real = (make_robot_of_mass("r", "1", block.format(name)) for name in ("sim/System", "real/System"))
    finding = only(package(tmp_path, made, real))
    assert finding.message.endswith("differ in the hardware (sim/System and real/System)")
    assert finding.fix is not None
    assert finding.fix.title.startswith("nothing if each is for its own hardware; otherwise delete the one that")
    without = only(package(tmp_path, made, make_robot_of_mass("r", "1")))
    assert without.fix is not None
    assert without.fix.title.startswith("nothing if they are meant to differ")


def test_a_xacro_that_xacro_made_is_not_the_source(tmp_path: Path) -> None:
    header = "<!-- | This document was autogenerated by xacro from r.urdf | -->"
    finding = only(package(tmp_path, make_robot_of_mass("r", "1"), make_robot_of_mass("r", "2", header)))
    assert finding.fix is not None
    assert finding.fix.title.startswith("delete ")
    assert "r.urdf.xacro, which says that xacro made it" in finding.fix.title


def test_a_xacro_whose_calls_lack_their_prefix_is_not_compared(tmp_path: Path) -> None:
    macro = '<xacro:macro name="camera" params="name"><link name="${name}"/></xacro:macro>'
    made, called = make_robot_of_mass("r", "1"), make_robot_of_mass("r", "2", macro + '<xacro:camera name="c"/>')
    assert only(package(tmp_path, made, called, overlap=0.7)).data["only_xacro"] == ["link[c]"]
    assert not package(tmp_path, made, called.replace("<xacro:camera", "<camera"), overlap=0.7).findings


def test_part_that_one_copy_lacks_counts_once(tmp_path: Path) -> None:
    extra = '<link name="lamp"><visual><geometry><sphere radius="1"/></geometry></visual></link>'
    finding = only(package(tmp_path, make_robot_of_mass("r", "1"), make_robot_of_mass("r", "1", extra), overlap=0.7))
    assert finding.data["only_xacro"] == ["link[lamp]"]
    assert "1 part only in the xacro (link[lamp])" in finding.message


def test_another_robot_of_the_package_is_no_copy(tmp_path: Path) -> None:
    other = make_robot_of_mass("r", "2").replace('"l1"', '"a1"').replace('"l2"', '"a2"')
    assert not package(tmp_path, make_robot_of_mass("r", "1"), other).findings


@pytest.mark.parametrize(
    ("typed", "files", "hint", "repair"),
    [
        (
            "$(find p)/robots/a.xacro",
            ["a.xacro"],
            " (p has a file of this name: a.xacro)",
            "write `$(find p)/a.xacro` if that is the one, or correct the path",
        ),
        (
            "$(find p)/robots/a.xacro",
            ["x/a.xacro", "y/a.xacro"],
            ", nor does its folder",
            "correct the path, or add the file",
        ),
        ("$(find p)/a.xacro", [], "", "correct the path, or add the file"),
        (
            "a.xacro",
            [],
            "",
            "correct the path, or add the file; a relative path starts at the folder of the file that contains it",
        ),
        ("robots/r.urdf.xacro", [], ", nor does its folder", None),  # not the file itself
    ],
)
def test_a_missing_file_is_named_where_the_package_has_it(
    tmp_path: Path, typed: str, files: list[str], hint: str, repair: str | None
) -> None:
    text = f'{HEAD}<xacro:include filename="{typed}"/></robot>'
    tree = {
        "package.xml": "<package><name>p</name></package>",
        "r.urdf.xacro": text,
        **dict.fromkeys(files, "<robot/>"),
    }
    (finding,) = find(tmp_path / "p", tree, "XAC001", name="r.urdf.xacro")
    assert finding.data["hint"].startswith(hint)
    assert finding.fix is not None
    assert repair is None or finding.fix.title == repair


@pytest.mark.parametrize(
    "files", [("car/__init__.py", "urdf/parts.xacro"), ("car/__init__.py",), ("car/a.txt", "urdf/parts.xacro")]
)
def test_a_folder_of_modules_is_not_the_package_around_it(tmp_path: Path, files: tuple[str, ...]) -> None:
    text = f'{HEAD}<xacro:include filename="$(find car)/urdf/parts.xacro"/></robot>'
    write(tmp_path, {"urdf/r.urdf.xacro": text, **dict.fromkeys(files, "<robot/>")})
    finding = only(check(tmp_path / "urdf/r.urdf.xacro", tmp_path, codes={"XAC001"}))
    assert finding.message_id == "file-missing"
    is_around = len(files) == 2 and files[0].endswith(".py")
    assert str(finding.data["repair"]).startswith(
        "keep the path, and add the package.xml of car" if is_around else "correct"
    )
    assert ("urdf/parts.xacro does: " in finding.message) == is_around


# -- what nothing uses -----------------------------------------------------------------------------------------------------

WHEEL = '<xacro:macro name="wheel" params="name"><link name="${name}"/></xacro:macro>\n'


def write(folder: Path, files: dict[str, str]) -> Path:
    for name, text in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    return folder


def find_in_folder(folder: Path, codes: set[str], **request: object) -> list[Finding]:
    run = check(folder, codes=codes, **request)
    assert not run.failures
    return list(run.findings)


@pytest.mark.parametrize(
    "call",
    [
        '<xacro:wheel name="a"/>',
        '<xacro:call macro="wheel" name="a"/>',
        '<xacro:if value="${False}"><xacro:wheel name="a"/></xacro:if>',
        '<xacro:macro name="axle" params="n"><xacro:wheel name="${n}"/></xacro:macro><xacro:axle n="a"/>',
        '<xacro:property name="kind" value="wheel"/><xacro:call macro="${kind}" name="a"/>',
    ],
)
def test_macro_called_in_any_way_is_used(tmp_path: Path, call: str) -> None:
    assert not xacro(tmp_path, WHEEL + call, {"XAC003"}).findings


def test_macro_that_is_called_by_itself_alone_is_not_used(tmp_path: Path) -> None:
    text = '<xacro:macro name="chain" params="n"><link name="l${n}"/><xacro:chain n="${n - 1}"/></xacro:macro>'
    assert only(xacro(tmp_path, text, {"XAC003"})).data["names"] == ["chain"]


def test_unused_macros_of_a_file_are_one_finding(tmp_path: Path) -> None:
    text = WHEEL + WHEEL.replace("wheel", "caster")
    finding = only(xacro(tmp_path, text, {"XAC003"}))
    assert (finding.message_id, finding.data["names"], len(finding.related)) == ("several", ["wheel", "caster"], 1)


def test_macro_of_an_included_namespace_is_called_by_its_last_name(tmp_path: Path) -> None:
    write(tmp_path, {"parts.xacro": HEAD + WHEEL + "</robot>", "package.xml": "<package><name>p</name></package>"})
    text = '<xacro:include filename="parts.xacro" ns="parts"/><xacro:parts.wheel name="a"/>'
    assert not xacro(tmp_path, text, {"XAC003"}).findings


@pytest.mark.parametrize("where", ["src/other/urdf/cell.xacro", "src/arm/test/tool.xacro"])
@pytest.mark.parametrize(
    ("definition", "use", "code"),
    [
        (WHEEL, '<xacro:wheel name="a"/>', "XAC003"),
        ('<xacro:arg name="side" default="left"/>', '<link name="$(arg side)"/>', "XAC004"),
        ('<xacro:arg name="side" default="left"/>', '<xacro:arg name="side" default="right"/>', "XAC004"),
        ('<xacro:property name="size" value="1"/>', '<link name="l${size}"/>', "XAC002"),
    ],
)
def test_what_another_file_of_the_workspace_uses_is_used(
    tmp_path: Path, where: str, definition: str, use: str, code: str
) -> None:
    files = {
        "src/arm/package.xml": "<package><name>arm</name></package>",
        "src/arm/urdf/arm.urdf.xacro": HEAD + BASE + definition + "</robot>",
        "src/other/package.xml": "<package><name>other</name><depend>arm</depend></package>",
    }
    model = write(tmp_path, files) / "src/arm/urdf/arm.urdf.xacro"
    (tmp_path / ".git").mkdir()
    assert [f.code for f in find_in_folder(model, {code})] == [code]
    include = '<xacro:include filename="$(find arm)/urdf/arm.urdf.xacro"/>'
    write(tmp_path, {where: HEAD + include + use + "</robot>"})
    assert not find_in_folder(model, {code})


def test_package_out_of_reach_that_depends_on_this_one_may_use_everything(tmp_path: Path) -> None:
    definitions = WHEEL + '<xacro:arg name="side" default="left"/><xacro:property name="size" value="1"/>'
    files = {
        "src/arm/package.xml": "<package><name>arm</name></package>",
        "src/arm/urdf/arm.urdf.xacro": HEAD + BASE + definitions + "</robot>",
        "src/other/package.xml": "<package><name>other</name></package>",
    }
    model = write(tmp_path, files) / "src/arm/urdf/arm.urdf.xacro"
    codes = {"XAC002", "XAC003", "XAC004"}
    assert {f.code for f in find_in_folder(model, codes)} == codes
    write(tmp_path, {"src/other/package.xml": "<package><name>other</name><depend>arm</depend></package>"})
    assert not find_in_folder(model, codes)


def test_nothing_is_known_of_macros_where_an_include_was_not_followed(tmp_path: Path) -> None:
    include = '<xacro:include filename="$(find not_installed)/a.xacro" optional="true"/>'
    text = f'{WHEEL}<xacro:arg name="a" default="1"/><xacro:if value="${{False}}">{include}</xacro:if>'
    assert not xacro(tmp_path, text, {"XAC003", "XAC004"}).findings


@pytest.mark.parametrize(
    "use",
    [
        '<link name="$(arg side)"/>',
        "<link name=\"${xacro.arg('side')}\"/>",
        "<link name=\"$(eval 'a' + side)\"/>",
        "<link name=\"$(eval arg('side'))\"/>",
        '<xacro:if value="${False}"><link name="$(arg side)"/></xacro:if>',
        "<gazebo><mu1>$(arg side)</mu1></gazebo>",
    ],
)
def test_argument_read_in_any_way_is_used(tmp_path: Path, use: str) -> None:
    declared = '<xacro:arg name="side" default="left"/>\n'
    assert only(xacro(tmp_path, declared, {"XAC004"})).data["names"] == ["side"]
    assert "XAC004" not in {f.code for f in xacro(tmp_path, declared + use, {"XAC004"}).findings}


def test_argument_that_is_given_counts_as_used(tmp_path: Path) -> None:
    declared = '<xacro:arg name="side" default="left"/>\n'
    assert not xacro(tmp_path, declared, {"XAC004"}, arguments={"side": "right"}).findings


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("launch/a.launch", '<launch><param name="d" command="xacro r.urdf.xacro side:=left"/></launch>'),
        ("launch/a.launch.py", "Command(['xacro ', path, ' side:=', side])"),
        ("launch/b.launch.py", "xacro.process_file(path, mappings={'side': 'left'})"),
        ("CMakeLists.txt", "xacro_add_xacro_file(r.urdf.xacro r.urdf side:=left)"),
    ],
)
def test_argument_that_something_of_the_package_hands_over_is_used(tmp_path: Path, name: str, text: str) -> None:
    files = {"package.xml": "<package><name>p</name></package>", name: text}
    model = write(tmp_path, files) / "robot.urdf.xacro"
    model.write_text(HEAD + BASE + '<xacro:arg name="side" default="left"/></robot>', encoding="utf-8")
    assert not find_in_folder(model, {"XAC004"})
    (tmp_path / name).unlink()
    assert find_in_folder(model, {"XAC004"})


def test_unread_arguments_are_deleted_with_their_lines(tmp_path: Path) -> None:
    text = '  <xacro:arg name="a" default="1"/>\n  <xacro:arg name="b" default="1"/>\n'
    finding = only(xacro(tmp_path, text, {"XAC004"}))
    assert finding.message_id == "several"
    assert finding.fix is not None
    assert "".join(e.expected for e in finding.fix.edits) == text


# -- tags without the prefix -----------------------------------------------------------------------------------------------


def edited(text: str, finding: Finding) -> str:
    assert finding.fix is not None
    for edit in sorted(finding.fix.edits, key=lambda e: e.span.start, reverse=True):
        assert text[edit.span.start : edit.span.end] == edit.expected
        text = text[: edit.span.start] + edit.replacement + text[edit.span.end :]
    return text


@pytest.mark.parametrize(
    ("wrong", "right"),
    [
        ('<property name="a" value="1"/><link name="l${a}"/>',
         '<xacro:property name="a" value="1"/><link name="l${a}"/>'),
        ('<macro name="m" params="n"><link name="${n}"/></macro ><xacro:m n="a"/>',
         '<xacro:macro name="m" params="n"><link name="${n}"/></xacro:macro ><xacro:m n="a"/>'),
        ('<if value="true"><link name="a"/></if>', '<xacro:if value="true"><link name="a"/></xacro:if>'),
        ('<arg name="a" default="1"/><link name="l$(arg a)"/>', '<xacro:arg name="a" default="1"/><link name="l$(arg a)"/>'),
        (WHEEL + '<wheel name="a"/>', WHEEL + '<xacro:wheel name="a"/>'),
    ],
)  # fmt: skip
def test_missing_prefix_is_one_finding_that_mends_the_file(tmp_path: Path, wrong: str, right: str) -> None:
    codes = {"XAC001", "XAC007", "XAC010", "XML003"}
    finding = only(xacro(tmp_path, wrong, codes))
    assert finding.code == "XAC007"
    text = HEAD + BASE + wrong + "</robot>\n"
    assert edited(text, finding) == HEAD + BASE + right + "</robot>\n"
    assert not xacro(tmp_path, right, codes).findings


@pytest.mark.parametrize(
    "text",
    [
        '<gazebo><plugin name="p" filename="x"><property name="a" value="1"/><include filename="b"/></plugin></gazebo>',
        '<ros2_control name="c" type="system"><if value="1"/></ros2_control>',
        "<link name='l'><visual><geometry><box size='1 1 1'/></geometry></visual></link>"
        '<xacro:macro name="box" params="size:=1"><link name="b"/></xacro:macro>',
        '<macro/><include uri="model://a"/>',  # what xacro could not carry out is somebody else's
    ],
)
def test_tags_of_others_are_left_alone(tmp_path: Path, text: str) -> None:
    assert not xacro(tmp_path, text, {"XAC007"}).findings


def test_a_value_without_the_prefix_stops_a_robot_of_another_package(tmp_path: Path) -> None:
    part = HEAD + '<property name="bore" value="1"/><property name="other" value="2"/></robot>'
    manifests = {f"{name}/package.xml": f"<package><name>{name}</name></package>" for name in ("robot", "parts")}
    write(tmp_path, {"parts/urdf/part.xacro": part, **manifests})
    text = '<xacro:include filename="$(find parts)/urdf/part.xacro"/><link name="l${bore}"/>'
    run = xacro(tmp_path / "robot", text, {"XAC001", "XAC007"}, package_paths=(tmp_path,))
    finding = only(run)
    assert (finding.code, finding.data["listed"]) == ("XAC007", "<property>")


def test_a_macro_of_another_package_does_not_stop_what_lacks_another_name(tmp_path: Path) -> None:
    """The words of the error are no names: ``name 'bore' is not defined``."""
    part = HEAD + '<macro name="is" params="name"><link name="a"/></macro></robot>'
    manifests = {f"{name}/package.xml": f"<package><name>{name}</name></package>" for name in ("robot", "parts")}
    write(tmp_path, {"parts/urdf/part.xacro": part, **manifests})
    text = '<xacro:include filename="$(find parts)/urdf/part.xacro"/><link name="l${bore}"/>'
    run = xacro(tmp_path / "robot", text, {"XAC001", "XAC007"}, package_paths=(tmp_path,))
    assert only(run).code == "XAC001"


@pytest.mark.parametrize("owner", ["robot", "parts"])
def test_a_macro_without_the_prefix_leaves_its_parameters_without_values(tmp_path: Path, owner: str) -> None:
    """In the file of another package, too, it stops the robot."""
    macro = '<macro name="wheel" params="side"><link name="wheel_${side}"/></macro>'
    manifests = {f"{name}/package.xml": f"<package><name>{name}</name></package>" for name in ("robot", "parts")}
    write(tmp_path, {"parts/urdf/part.xacro": HEAD + macro + "</robot>", **manifests})
    text = macro if owner == "robot" else '<xacro:include filename="$(find parts)/urdf/part.xacro"/>'
    finding = only(xacro(tmp_path / "robot", text, {"XAC001", "XAC007"}, package_paths=(tmp_path,)))
    assert (finding.code, finding.data["listed"]) == ("XAC007", "<macro>")


def test_a_macro_may_be_defined_by_an_include_below_the_call(tmp_path: Path) -> None:
    write(tmp_path, {"wheel.xacro": f'{HEAD}<xacro:macro name="wheel" params=""/></robot>'})
    finding = only(xacro(tmp_path, '<xacro:wheel/>\n<xacro:include filename="wheel.xacro"/>', {"XAC001"}))
    assert finding.data["hint"] == ""
    assert finding.fix is not None
    assert finding.fix.title.startswith(
        "move the include that defines the macro above this line, if that is wheel.xacro (line 4); otherwise include"
    )


def test_an_end_tag_that_cannot_be_told_leaves_the_file_as_it_is(tmp_path: Path) -> None:
    text = '<if value="true"><if value="true"><link name="a"/></if></if>'
    finding = only(xacro(tmp_path, text, {"XAC007"}))
    assert finding.fix is not None
    assert not finding.fix.edits
    assert finding.subjects == ("if", "if/if")


def test_what_a_robot_lacks_is_not_reported_while_a_call_makes_no_part(tmp_path: Path) -> None:
    transmission = (
        '<transmission name="t"><type>transmission_interface/SimpleTransmission</type><joint name="a_joint"><hardwareInterface>'
        'PositionJointInterface</hardwareInterface></joint><actuator name="m"/></transmission>'
        '<gazebo reference="a"><mu1>1</mu1></gazebo>'
    )
    arm = (
        '<xacro:macro name="arm" params="n"><link name="${n}"/><joint name="${n}_joint" type="fixed"><parent link="base"/>'
        '<child link="${n}"/></joint></xacro:macro>'
    )
    codes = {"CTL001", "GZB001", "XAC007"}
    lost = only(xacro(tmp_path, arm + '<arm n="a"/>' + transmission, codes))
    assert (lost.code, lost.data["hides"]) == ("XAC007", ["CTL001", "GZB001"])
    # Whoever accepts the call still reads that these were not checked.
    accepted = xacro(
        tmp_path, arm + '<!-- urdfcheck: ignore[XAC007] another tool reads it -->\n<arm n="a"/>' + transmission, codes
    )
    assert [(finding.code, finding.suppressed is None) for finding in accepted.findings] == [("XAC007", False)]
    assert [(skip.code, skip.is_partial) for skip in accepted.skipped] == [("CTL001", True), ("GZB001", True)]
    assert accepted.skipped[0].reason == "what it reports waits for the repair of XAC007"
    found = xacro(tmp_path, arm + '<xacro:arm n="b"/>' + transmission, codes).findings
    assert sorted({finding.code for finding in found}) == ["CTL001", "GZB001"]


INERTIA = (
    '<xacro:macro name="inertia_of" params="m">'
    '<inertia ixx="${m}" ixy="0" ixz="0" iyy="${m}" iyz="0" izz="${m}"/></xacro:macro>'
)


def test_what_a_call_without_the_prefix_would_make_through_other_macros_is_not_missing(tmp_path: Path) -> None:
    camera = """<xacro:macro name="camera" params="frame"><link name="${frame}"/></xacro:macro>
<xacro:macro name="zoom" params="frame:=eye"><xacro:camera frame="${frame}"/></xacro:macro>"""
    joint = '<joint name="mount" type="fixed"><parent link="world"/><child link="eye"/></joint>'
    codes = {"KIN002", "XAC007"}
    lost = only(xacro(tmp_path, camera + '<link name="world"/><zoom frame="eye"/>' + joint, codes))
    assert (lost.code, lost.data["hides"]) == ("XAC007", ["KIN002"])


def test_an_inertial_that_a_call_without_the_prefix_would_make_is_not_missing(tmp_path: Path) -> None:
    tensor = '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>'
    body = f'<xacro:macro name="body" params=""><inertial><mass value="1"/>{tensor}</inertial></xacro:macro>'
    shape = '<collision><geometry><box size="1 1 1"/></geometry></collision>'
    links = f'<link name="torso"><xacro:body/></link><link name="arm"><body/>{shape}</link>'
    joint = "".join(
        f'<joint name="{child}_joint" type="continuous"><parent link="base"/><child link="{child}"/></joint>'
        for child in ("torso", "arm")
    )
    codes = {"INR001", "XAC007"}
    lost = only(xacro(tmp_path, body + links + joint, codes))
    assert (lost.code, lost.data["hides"]) == ("XAC007", ["INR001"])


@pytest.mark.parametrize("standing", [True, False])
def test_a_call_without_the_prefix_may_make_what_stands_beside_it(tmp_path: Path, standing: bool) -> None:
    tensor = '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>'
    macro = f'<xacro:macro name="ball" params="m">{tensor}</xacro:macro>'
    inertial = f'<inertial>{tensor * standing}<mass value="1"/><ball m="1"/></inertial>'
    finding = only(xacro(tmp_path, f'{macro}<link name="a">{inertial}</link>', {"XAC007"}))
    assert finding.fix is not None
    assert bool(finding.fix.edits) is not standing
    assert ("and delete the <inertia> beside it (" in finding.fix.title) is standing
    assert ("reads the <inertia> beside it" in finding.consequences["urdfdom"]) is standing


def test_only_the_tags_of_the_robot_are_why_it_has_no_links(tmp_path: Path) -> None:
    parts = f'{WHEEL}<xacro:macro name="sensors"><wheel name="sensor"/></xacro:macro>'
    files = {
        "package.xml": "<package><name>car</name></package>",
        "parts.xacro": HEAD + parts + "</robot>",
        "car.urdf.xacro": HEAD + '<xacro:include filename="parts.xacro"/><wheel name="a"/><sensors/></robot>',
    }
    found = find_in_folder(write(tmp_path, files) / "car.urdf.xacro", {"XAC007", "KIN007"})
    effects = {f.location.span.file.rpartition("/")[2]: f.consequences["urdfdom"] for f in found if f.location.span}
    assert effects == {
        "car.urdf.xacro": "refuses the file: no link elements found",
        "parts.xacro": "ignores it; what is in it, or what it should make, is missing",
    }
    assert {f.code for f in found} == {"XAC007"}


BLOCKS = """<xacro:macro name="arm" params="n *limit *mass **rest">
<link name="${{n}}"><inertial>{mass}</inertial></link>
<joint name="${{n}}_joint" type="revolute"><axis xyz="0 0 1"/>{limit}<parent link="base"/><child link="${{n}}"/></joint>
</xacro:macro><xacro:arm n="a"><limit lower="-1" upper="1" effort="1" velocity="1"/><mass value="1"/>
<rest><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></rest></xacro:arm>"""


@pytest.mark.parametrize(
    ("limit", "mass", "expected"),
    [
        ("limit", "mass rest", ["XAC007"]),
        ("limit", "mass", ["XAC007", "XML005"]),  # the block of the inertia is inserted nowhere
        ("mass", "mass rest", ["JNT004", "XAC007"]),  # so is that of the limit
    ],
)
def test_what_a_block_without_the_prefix_would_insert_is_not_missing(
    tmp_path: Path, limit: str, mass: str, expected: list[str]
) -> None:
    inserted = ["".join(f'<insert_block name="{name}"/>' for name in names.split()) for names in (limit, mass)]
    text = BLOCKS.format(limit=inserted[0], mass=inserted[1])
    found = {f.code: f for f in xacro(tmp_path, text, {"XAC007", "XML005", "JNT004"}).findings}
    assert sorted(found) == expected
    if expected == ["XAC007"]:
        assert found["XAC007"].consequences["urdfdom"] == "refuses the file: a joint lacks its <limit>"
        assert found["XAC007"].consequences["mujoco"].startswith("refuses the file: an <inertial>")


@pytest.mark.parametrize(("macro", "expected"), [(INERTIA, ["XAC007"]), (WHEEL, ["XML005", "XAC007"])])
def test_a_call_in_the_file_of_another_package_is_told_there_and_not_what_it_would_make(
    tmp_path: Path, macro: str, expected: list[str]
) -> None:
    call = '<inertia_of m="1"/>' if macro is INERTIA else '<wheel name="1"/>'
    arm = f'<link name="arm"><inertial><mass value="1"/>{call}</inertial></link>'
    files = {
        "src/arm/package.xml": "<package><name>arm</name></package>",
        "src/arm/urdf/parts.xacro": HEAD + macro + f'<xacro:macro name="arm">{arm}</xacro:macro></robot>',
        "src/cell/package.xml": "<package><name>cell</name><depend>arm</depend></package>",
        "src/cell/cell.urdf.xacro": HEAD
        + '<xacro:include filename="$(find arm)/urdf/parts.xacro"/><xacro:arm/></robot>',
        ".git/HEAD": "",
    }
    model = write(tmp_path, files) / "src/cell/cell.urdf.xacro"
    found = find_in_folder(model, {"XAC007", "XML005", "XML003"})
    assert [f.code for f in found if f.severity == Severity.ERROR] == expected


@pytest.mark.parametrize(("call", "expected"), [('<wheel name="a"/>', ["XAC007"]), ("<tyre/>", None)])
def test_robot_of_calls_without_the_prefix_is_a_model(tmp_path: Path, call: str, expected: list[str] | None) -> None:
    write(tmp_path, {"parts.xacro": HEAD + WHEEL + "</robot>"})
    text = HEAD + '<xacro:include filename="parts.xacro"/>' + call + "</robot>"
    run = check_text(tmp_path, text, "car.urdf.xacro", codes={"XAC007", "KIN007", "XML003"})
    assert [f.code for f in run.findings if f.severity == Severity.ERROR] == (expected or [])
    assert bool(run.skipped) == (expected is None)


@pytest.mark.parametrize(("name", "expected"), [(' name="car"', ["XAC007"]), ("", [])])
def test_robot_of_includes_without_the_prefix_is_a_model_and_they_are_its_parts(
    tmp_path: Path, name: str, expected: list[str]
) -> None:
    head = HEAD.replace(' name="r"', "")
    files = {
        "parts.xacro": HEAD + WHEEL + "</robot>",
        "body.xacro": head + '<link name="b"/><xacro:wheel name="a"/></robot>',
        "car.urdf.xacro": head.replace("<robot", f"<robot{name}")
        + '<include filename="parts.xacro"/><include filename="body.xacro"/></robot>',
    }
    run = check(write(tmp_path, files), codes={"XAC001", "XAC007"})
    assert [f.code for f in run.findings if f.severity == Severity.ERROR] == expected


@pytest.mark.parametrize(
    ("launched", "extra", "severity", "repair"),
    [
        ("robot.urdf.xacro", "", Severity.WARNING, "delete this file if nothing needs it; else include parts.xacro"),
        ("car.urdf.xacro", "", Severity.ERROR, "include parts.xacro"),
        ("$(arg model).urdf.xacro", "", Severity.ERROR, "include parts.xacro"),
        (
            "robot.urdf.xacro",
            '<link name="o"/>',
            Severity.WARNING,
            "delete this file if nothing needs it; else correct",
        ),
    ],
)
def test_a_file_that_lacks_a_macro_and_that_no_file_names_is_a_warning(
    tmp_path: Path, launched: str, extra: str, severity: Severity, repair: str
) -> None:
    """A whole robot that defines the macro is nothing to include."""
    load = f'<param name="robot_description" command="xacro $(find car)/urdf/{launched}"/>'
    files = {
        "package.xml": "<package><name>car</name></package>",
        "launch/car.launch": f"<launch>{load}</launch>",
        "urdf/robot.urdf.xacro": HEAD + '<link name="b"/></robot>',
        "urdf/parts.xacro": HEAD + WHEEL + extra + "</robot>",
        "urdf/car.urdf.xacro": HEAD + '<link name="b"/><xacro:wheel name="a"/></robot>',
    }
    finding = only(check(write(tmp_path, files) / "urdf/car.urdf.xacro", codes={"XAC001"}))
    assert finding.severity is severity
    assert finding.fix is not None
    assert finding.fix.title.startswith(repair)


def test_a_macro_of_another_case_names_the_condition_and_no_other_file(tmp_path: Path) -> None:
    inner = '<xacro:macro name="spoke"><link name="s"/></xacro:macro>'
    arm = HEAD + '<xacro:macro name="{}" params="kind"><xacro:if value="${{kind == \'big\'}}">' + inner + "</xacro:if>"
    arm += "\n<xacro:spoke/></xacro:macro>"
    files = {
        "package.xml": "<package><name>car</name></package>",
        "urdf/other.xacro": arm.format("other") + "</robot>",
        "urdf/car.urdf.xacro": arm.format("car")
        + '<xacro:arg name="kind" default="small"/><xacro:car kind="$(arg kind)"/></robot>',
    }
    folder = write(tmp_path, files)
    finding = only(check(folder / "urdf/car.urdf.xacro", codes={"XAC001"}))
    assert finding.message_id == "macro-conditional"
    assert finding.message == "macro spoke is only defined if `${kind == 'big'}`, which does not hold here"
    assert finding.data["remedy"] == "--arg kind:=big"
    assert not check(folder / "urdf/car.urdf.xacro", codes={"XAC001"}, arguments={"kind": "big"}).findings


@pytest.mark.parametrize(
    "around", ['<xacro:if value="$(arg big)">{}</xacro:if>', '<xacro:macro name="all">{}</xacro:macro>']
)
def test_no_file_is_to_be_included_that_defines_a_macro_in_a_part_only(tmp_path: Path, around: str) -> None:
    files = {
        "package.xml": "<package><name>car</name></package>",
        "urdf/parts.xacro": HEAD + around.format(WHEEL) + "</robot>",
        "urdf/car.urdf.xacro": HEAD + '<link name="b"/><xacro:wheel name="a"/></robot>',
    }
    finding = only(check(write(tmp_path, files) / "urdf/car.urdf.xacro", codes={"XAC001"}))
    assert finding.fix is not None
    assert finding.fix.title.startswith("define the macro before this line (parts.xacro may: ")


def test_the_file_that_defines_a_macro_is_named(tmp_path: Path) -> None:
    files = {
        "package.xml": "<package><name>car</name></package>",
        "urdf/parts.xacro": HEAD + WHEEL + "</robot>",
        "urdf/car.urdf.xacro": HEAD + '<link name="b"/><xacro:wheel name="a"/></robot>',
    }
    finding = only(check(write(tmp_path, files) / "urdf/car.urdf.xacro", codes={"XAC001"}))
    assert finding.fix is not None
    assert finding.fix.title.startswith("include parts.xacro, which defines the macro,")


@pytest.mark.parametrize(
    ("tags", "message", "severity"),
    [
        ('<property name="b" value="1"/>', "left", Severity.INFO),
        ('<macro name="b" params=""/>', "left", Severity.INFO),
        ('<macro name="b" params=""/><b/>', "plain", Severity.WARNING),
        ('<include filename="b.xacro"/>', "plain", Severity.WARNING),
    ],
)
def test_xacro_tags_in_a_plain_urdf_are_a_warning_where_they_should_make_something(
    tmp_path: Path, tags: str, message: str, severity: Severity
) -> None:
    text = f'<robot name="r"><link name="a"/>{tags}</robot>'
    finding = only(check_text(tmp_path, text, codes={"XAC007", "XML003"}))
    assert (finding.code, finding.message_id, finding.severity) == ("XAC007", message, severity)


@pytest.mark.parametrize(
    ("text", "message", "severity"),
    [
        ('<property name="a" value="1"/>', "dead", Severity.INFO),
        (
            '<property name="a" value="1"/><xacro:property name="a" value="1"/><link name="l${a}"/>',
            "dead",
            Severity.INFO,
        ),
        (
            '<property name="a" value="2"/><xacro:property name="a" value="1"/><link name="l${a}"/>',
            "value",
            Severity.WARNING,
        ),
        ('<arg name="a" default="2"/><xacro:arg name="a" default="2"/><link name="l$(arg a)"/>', "dead", Severity.INFO),
        ('<property name="a" value="1"/><link name="l${a}"/>', "halted", Severity.ERROR),
        (f'<property name="a" value="1"/>{WHEEL}<wheel name="a"/>', "unprefixed", Severity.ERROR),
    ],
)
def test_a_value_without_its_prefix_takes_no_link_from_a_robot(
    tmp_path: Path, text: str, message: str, severity: Severity
) -> None:
    finding = only(xacro(tmp_path, text, {"XAC001", "XAC007", "XAC010", "XML003"}))
    assert (finding.message_id, finding.severity) == (message, severity)
    assert ("urdfdom" in finding.consequences) == (message == "unprefixed")


@pytest.mark.parametrize(
    ("text", "message", "severity"),
    [
        ("", "dead", Severity.INFO),
        ("<link name='${a}'/>", "halted", Severity.ERROR),
        # The file that is not read may use it.
        ("<xacro:include filename='other.xacro'/>", "halted", Severity.WARNING),
        ("<xacro:include filename='$(arg which).xacro'/>", "halted", Severity.WARNING),
        ("<wheel name='a'/>", "halted", Severity.ERROR),
    ],
)
def test_a_value_that_nothing_reads_is_an_info_where_xacro_stops_elsewhere(
    tmp_path: Path, text: str, message: str, severity: Severity
) -> None:
    stopping = "<link name='${lost}'/>"
    found = xacro(tmp_path, f'<property name="a" value="1"/>{WHEEL}{stopping}{text}', {"XAC007"})
    assert [(f.message_id, f.severity) for f in found.findings if f.code == "XAC007"] == [(message, severity)]


def test_the_call_that_makes_links_is_named_before_the_rest(tmp_path: Path) -> None:
    calls = '<link name="b"><inertial><mass value="1"/><inertia_of m="1"/></inertial></link><wheel name="a"/>'
    finding = only(xacro(tmp_path, INERTIA + WHEEL + '<property name="c" value="1"/>' + calls, {"XAC007"}))
    assert finding.headline == "<wheel> and 2 other tags lack the prefix xacro:"
    assert finding.data["listed"] == "<wheel>, <inertia_of>, <property>"
    assert finding.consequences["mujoco"].startswith("refuses the file")


@pytest.mark.parametrize(
    ("around", "message"),
    [
        ("", "unprefixed"),
        ("<xacro:camera/>", "unprefixed"),
        ("<camera/>", "unprefixed"),  # with its prefix it calls the macro
        ('<include filename="other.xacro"/>', "unprefixed"),  # what it would bring may call the macro
        ("none", "unreached"),
        ('<xacro:if value="false"><xacro:camera/></xacro:if>', "unreached"),
    ],
)
def test_a_robot_lacks_nothing_of_a_call_in_a_macro_that_it_does_not_use(
    tmp_path: Path, around: str, message: str
) -> None:
    call = '<wheel name="a"/>'
    macro = f'<xacro:macro name="camera" params="">{call}</xacro:macro>'
    text = WHEEL + (macro + around.removeprefix("none") if around else call)
    found = xacro(tmp_path, text, {"XAC007"}).findings
    assert {(f.message_id, f.severity) for f in found} == {
        (message, Severity.ERROR if message == "unprefixed" else Severity.WARNING)
    }
    assert all(("urdfdom" in f.consequences) == (message == "unprefixed") for f in found)


@pytest.mark.parametrize(
    ("root", "launch", "severity"),
    [
        ("<robot {}>", "", Severity.WARNING),
        ("<root {}>", "", Severity.WARNING),
        ("<root {}>", "parts.urdf.xacro", Severity.ERROR),
        ('<robot name="car" {}>', "", Severity.ERROR),
    ],
)
def test_a_file_that_makes_no_robot_and_that_nothing_uses_lacks_its_prefix_without_harm(
    tmp_path: Path, root: str, launch: str, severity: Severity
) -> None:
    parts = '<xacro:include filename="lost.xacro"/>' + WHEEL
    parts += '<xacro:macro name="car" params=""><wheel name="a"/></xacro:macro>'
    parts += '<link name="base"/>' if "name=" in root else ""
    tag = root.format('xmlns:xacro="http://www.ros.org/wiki/xacro"')
    files = {
        "package.xml": "<package><name>car</name></package>",
        "urdf/parts.urdf.xacro": f"{tag}{parts}</{root[1:].split()[0]}>",
        "launch/car.launch": f'<launch><param name="a" value="$(find car)/urdf/{launch}"/></launch>',
    }
    found = find_in_folder(write(tmp_path, files) / "urdf/parts.urdf.xacro", {"XAC007"})
    assert [(f.message_id, f.severity) for f in found if f.code == "XAC007"] == [("halted", severity)]


def test_what_a_file_says_of_its_author_is_no_call(tmp_path: Path) -> None:
    text = (
        '<author>A</author><license>BSD</license><review status="none"/><include filename="w.xacro"/><wheel name="a"/>'
    )
    finding = only(xacro(tmp_path, text, {"XAC007", "XML003"}))
    assert finding.fix is not None
    assert finding.fix.title.endswith("as may the calls of their macros: <wheel>")


def test_a_property_with_an_empty_name_is_used_nowhere(tmp_path: Path) -> None:
    text = '<property name="" value="1"/><xacro:property name="b" value="1"/><link name="l${b}"/>'
    finding = only(xacro(tmp_path, text, {"XAC007"}))
    assert (finding.message_id, finding.severity) == ("refused", Severity.INFO)
    assert finding.message.endswith("with the prefix xacro stops: its name is empty (no name)")
    assert finding.fix is not None
    assert finding.fix.title == "give it a name, then `<xacro:property …>`, or delete what nothing uses"


def test_what_follows_from_a_call_without_its_prefix_is_not_told_again(tmp_path: Path) -> None:
    parts = WHEEL + '<gazebo reference="a"><mu1>1</mu1></gazebo><gazebo reference="b"><mu1>1</mu1></gazebo>'
    light = (
        '<link name="tip"><inertial><mass value="1e-5"/>'
        '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>'
    )
    codes = {"XAC007", "XAC003", "GZB001", "INR015"}
    found = xacro(tmp_path, parts + light + '<wheel name="a"/>', codes)
    assert [f.code for f in found.findings] == ["XAC007"]


# -- properties that are lost ----------------------------------------------------------------------------------------------


def prop(name: str, value: str, more: str = "") -> str:
    return f'<xacro:property name="{name}" value="{value}"{more}/>\n'


@pytest.mark.parametrize(
    ("text", "lines"),
    [
        (prop("a", "1") + prop("a", "2"), [4]),
        (prop("a", "1") + prop("a", "1.0"), []),
        (prop("a", "1") + '<link name="l${a}"/>\n' + prop("a", "2"), []),
        (prop("a", "1") + prop("a", "${a + 1}", ' lazy_eval="false"'), []),
        (prop("a", "1") + prop("b", "${a}") + prop("a", "2"), [5]),  # b is evaluated when it is read, and gets 2
        (prop("a", "1") + f'<xacro:if value="true">{prop("a", "2")}</xacro:if>', []),
        (prop("a", "1") + '<xacro:property name="a" default="2"/>', []),
        ('<xacro:macro name="m" params="">' + prop("a", "1") + '</xacro:macro>\n<xacro:m/><xacro:m/>' + prop("a", "2"), []),
        ('<xacro:macro name="m" params="n">' + prop("a", "${n}", ' scope="global"') + "</xacro:macro>"
         '<xacro:m n="1"/><xacro:m n="2"/>', []),
        ('<xacro:macro name="m" params="">\n' + prop("y", "0") + prop("y", "1") + '<link name="l${y}"/>'
         "</xacro:macro><xacro:m/>", [5]),
        (prop("a", "1") + '<xacro:property name="a" remove="true"/>' + prop("a", "2"), []),
    ],
)  # fmt: skip
def test_value_that_is_replaced_before_anything_reads_it(tmp_path: Path, text: str, lines: list[int]) -> None:
    findings = xacro(tmp_path, text + "<link name=\"l_${python.len('a')}\"/>", {"XAC008"}).findings
    assert [f.location.span.line for f in findings if f.location.span] == lines


def test_a_value_set_twice_names_both_lines(tmp_path: Path) -> None:
    (finding,) = xacro(tmp_path, prop("a", "1") + "\n" + prop("a", "2") + '<link name="l${a}"/>', {"XAC008"}).findings
    assert finding.location.span is not None
    lines = finding.related[0].span, finding.location.span
    first, second = (span.line for span in lines if span is not None)
    assert finding.fix is not None
    assert finding.fix.title.startswith(f"delete line {first} or {second}, whichever is wrong; if both")
    assert first < second


@pytest.mark.parametrize(
    ("main", "message"),
    [
        (prop("a", "1") + '<xacro:include filename="a.xacro"/>', "included"),
        ('<xacro:include filename="a.xacro"/>' + prop("a", "3"), None),  # its defaults, and what is meant
        ('<xacro:include filename="a.xacro"/><xacro:include filename="b.xacro"/>', "clash"),
        ('<xacro:include filename="a.xacro"/><xacro:if value="true"><xacro:include filename="b.xacro"/></xacro:if>', None),
        ('<xacro:arg name="f" default="b"/><xacro:include filename="a.xacro"/><xacro:include filename="$(arg f).xacro"/>', None),
    ],
)  # fmt: skip
def test_value_that_another_file_replaces(tmp_path: Path, main: str, message: str | None) -> None:
    package = "<package><name>p</name></package>"
    files = {f"{n}.xacro": HEAD + prop("a", v) + "</robot>" for n, v in (("a", "2"), ("b", "4"))}
    write(tmp_path, {**files, "package.xml": package})
    findings = xacro(tmp_path, main + '<link name="l${a}"/>', {"XAC008"}).findings
    assert [f.message_id for f in findings] == ([message] if message else [])


@pytest.mark.parametrize(
    ("inside", "repair"),
    [
        ('<xacro:macro name="m" params=""><link name="m${a}"/></xacro:macro>', "set it after the include"),
        ('<link name="m${a}"/>', "delete this line"),
        ('<xacro:property name="b" value="${2 * a}"/><link name="m${b}"/>', "delete this line"),
    ],
)
def test_a_value_that_an_include_replaces_can_only_count_later_in_its_macros(
    tmp_path: Path, inside: str, repair: str
) -> None:
    write(
        tmp_path,
        {"a.xacro": HEAD + prop("a", "2") + inside + "</robot>", "package.xml": "<package><name>p</name></package>"},
    )
    main = prop("a", "1") + '<xacro:include filename="a.xacro"/><link name="l${a}"/>'
    (finding,) = xacro(tmp_path, main, {"XAC008"}).findings
    assert finding.fix is not None
    assert finding.fix.title.startswith(repair)


@pytest.mark.parametrize(
    ("one", "other", "is_same"),
    [
        ("3.14159", "3.1415926535897931", True),
        ("3.1415926535897931", "3.14159", True),
        ("3.14160", "3.1415926535897931", False),
        ("3.14", "3.1415926535897931", False),
        ("0.30000", "0.30000004", True),
        ("4", "4.2", False),
    ],
)
def test_a_rounded_value_is_the_same(tmp_path: Path, one: str, other: str, is_same: bool) -> None:
    text = prop("a", one) + "\n" + prop("a", other) + "<link name=\"l_${python.len('a')}\"/>"
    assert len(xacro(tmp_path, text, {"XAC008"}).findings) == (not is_same)


def test_files_that_replace_each_others_value_in_turn_are_one_clash(tmp_path: Path) -> None:
    inner = HEAD + prop("a", "2") + "</robot>"
    outer = HEAD + '<xacro:include filename="inner.xacro"/>' + prop("a", "1") + "</robot>"
    write(tmp_path, {"inner.xacro": inner, "outer.xacro": outer, "package.xml": "<package><name>p</name></package>"})
    twice = '<xacro:include filename="outer.xacro"/>' * 2 + '<xacro:include filename="inner.xacro"/>'
    findings = xacro(tmp_path, twice + '<link name="l${a}"/>', {"XAC008"}).findings
    assert [(f.message_id, f.data["first"], f.data["second"]) for f in findings] == [("clash", "1", "2")]


# -- what an include loses -------------------------------------------------------------------------------------------------

HAND = """<robot version="{version}" xmlns:xacro="http://www.ros.org/wiki/xacro" xmlns:drake="{drake}">
<link name="hand"/><joint name="j" type="fixed"><parent link="base"/><child link="hand"/>{origin}</joint></robot>"""


@pytest.mark.parametrize(
    ("main", "included", "origin", "told"),
    [
        ("", "1.1", '<origin quat_xyzw="0 0 1 0"/>', True),
        ("", "1.2", '<origin quat_xyzw="0 0 1 0"/>', True),
        ('version="1.0"', "1.1", '<origin quat_xyzw="0 0 1 0"/>', True),
        ('version="1.1"', "1.1", '<origin quat_xyzw="0 0 1 0"/>', False),
        ("", "1.1", '<origin rpy="0 0 1"/>', False),
        ("", "1.0", '<origin quat_xyzw="0 0 1 0"/>', False),  # lost in that file as well
        ("", "new", '<origin quat_xyzw="0 0 1 0"/>', False),
    ],
)
def test_version_of_an_included_file(tmp_path: Path, main: str, included: str, origin: str, told: bool) -> None:
    write(tmp_path, {"hand.xacro": HAND.format(version=included, drake="http://drake.mit.edu/", origin=origin)})
    text = HEAD.replace("<robot", f"<robot {main}") + BASE + '<xacro:include filename="hand.xacro"/></robot>'
    findings = check_text(tmp_path, text, "robot.urdf.xacro", codes={"XAC012"}).findings
    assert [(f.message_id, f.severity) for f in findings] == ([("version", Severity.ERROR)] if told else [])
    assert all(f.location.span is not None and f.location.span.file.endswith("hand.xacro") for f in findings)


def test_feature_of_a_lost_version_is_not_told_again(tmp_path: Path) -> None:
    origin = '<origin quat_xyzw="0 0 1 0"/>'
    write(tmp_path, {"hand.xacro": HAND.format(version="1.1", drake="http://drake.mit.edu/", origin=origin)})
    finding = only(xacro(tmp_path, '<xacro:include filename="hand.xacro"/>', {"XAC012", "XML010"}))
    assert (finding.code, finding.data["hides"]) == ("XAC012", ["XML010"])


def test_prefix_with_two_addresses_is_one_info(tmp_path: Path) -> None:
    write(tmp_path, {"hand.xacro": HAND.format(version="1.0", drake="http://drake.mit.edu/old", origin="")})
    head = HEAD.replace("<robot", '<robot xmlns:drake="http://drake.mit.edu/"')
    text = head + BASE + '<xacro:include filename="hand.xacro"/></robot>'
    finding = only(check_text(tmp_path, text, "robot.urdf.xacro", codes={"XAC012"}))
    assert (finding.message_id, finding.severity) == ("prefix", Severity.INFO)
    assert [r.span.file.endswith("robot.urdf.xacro") for r in finding.related if r.span] == [True]


# -- circles ---------------------------------------------------------------------------------------------------------------


def including(*names: str) -> str:
    return HEAD + "".join(f'<xacro:include filename="{name}"/>\n' for name in names) + "</robot>"


def test_file_that_includes_itself(tmp_path: Path) -> None:
    finding = only(xacro(tmp_path, '<xacro:include filename="robot.urdf.xacro"/>', {"XAC001", "XAC013"}))
    assert (finding.code, finding.message_id) == ("XAC013", "itself")
    assert finding.location.span is not None
    assert finding.location.span.line == 3


@pytest.mark.parametrize(("first", "last"), [("a", "a"), ("lead", "a"), ("a", "robot.urdf")])
def test_circle_is_told_at_the_include_that_closes_it(tmp_path: Path, first: str, last: str) -> None:
    write(tmp_path, {
        "lead.xacro": including("a.xacro"), "a.xacro": including("b.xacro"), "b.xacro": including(f"{last}.xacro")
    })  # fmt: skip
    finding = only(xacro(tmp_path, f'<xacro:include filename="{first}.xacro"/>', {"XAC001", "XAC013"}))
    assert (finding.code, finding.message_id) == ("XAC013", "circle")
    circle = ["a", "b"] if last == "a" else ["robot.urdf", "a", "b"]
    assert [Path(name).name for name in finding.data["files"]] == [f"{name}.xacro" for name in circle]
    assert finding.location.span is not None
    assert finding.location.span.file.endswith("b.xacro")


def test_a_folder_that_is_not_there_is_told_with_those_beside_it(tmp_path: Path) -> None:
    write(tmp_path, {"config/ur10/a.yaml": "", "config/ur20/a.yaml": ""})
    finding = only(xacro(tmp_path, """<link name="${xacro.load_yaml('config/ur5/a.yaml')}"/>""", {"XAC001"}))
    assert finding.message.endswith("ur5/a.yaml does not exist, nor does its folder (beside it: ur10, ur20)")


def test_circle_that_a_condition_ends_is_none(tmp_path: Path) -> None:
    once = '<xacro:property name="n" value="${n + 1}" lazy_eval="false"/>'
    again = '<xacro:if value="${n &lt; 3}"><xacro:include filename="a.xacro"/></xacro:if>'
    write(tmp_path, {"a.xacro": f"{HEAD}{once}{again}</robot>"})
    run = xacro(tmp_path, prop("n", "0") + '<xacro:include filename="a.xacro"/>', {"XAC001", "XAC013"})
    assert not run.findings
    assert run.models[0].status == "checked"


@pytest.mark.parametrize(("value", "message"), [("${2*2.0}", "not-text"), ("${0}", "value-lost"), ("${str(2)}", None)])
def test_a_value_that_is_no_text_is_named_with_its_repair(tmp_path: Path, value: str, message: str | None) -> None:
    body = f'<link name="a"><inertial><mass><xacro:attribute name="value" value="{value}"/></mass></inertial></link>'
    text = f'<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">{body}</robot>'
    found = check_text(tmp_path, text, "robot.urdf.xacro", codes={"XAC001"}).findings
    assert [f.message_id for f in found] == ([] if message is None else [message])
    for finding in found:
        assert finding.severity == (Severity.ERROR if message == "not-text" else Severity.WARNING)
        assert finding.fix is not None
        assert "${str(…)}" in finding.fix.title


def test_a_default_that_leads_nowhere_is_not_proposed(tmp_path: Path) -> None:
    """Only the values for which a file exists are: `models/arm/` does not."""
    write(tmp_path, {"models/long/part.xacro": robot(xacro=True), "models/short/part.xacro": robot(xacro=True)})
    text = robot(
        '<xacro:arg name="model" default="arm"/>',
        '<xacro:include filename="models/$(arg model)/part.xacro"/>',
        name="$(arg model)",
        xacro=True,
    )
    (tmp_path / "robot.urdf.xacro").write_text(text, encoding="utf-8")
    finding = only(check(tmp_path / "robot.urdf.xacro", codes={"XAC001"}))
    assert finding.fix is not None
    assert "--arg model:=long" in finding.fix.title
    assert finding.message.endswith("known values: long, short")


@pytest.mark.parametrize(
    ("files", "call", "hint"),
    [
        # The file that defines what is called, not one of a similar name that defines something else.
        ({"grip_quad.xacro": "quad", "grip_dual_gen2.xacro": "dual"}, "<xacro:dual/>", "'grip_dual_gen2.xacro'"),
        ({"grip_quad.xacro": "quad", "grip_dual_gen2.xacro": "dual"}, "<dual/>", "'grip_dual_gen2.xacro'"),
        ({"grip_quad.xacro": "quad"}, "<xacro:dual/>", None),
        ({"grip_daul.xacro": "dual", "other.xacro": "dual"}, "<xacro:dual/>", "'grip_daul.xacro'"),
        ({"grip_daul.xacro": None}, "<xacro:dual/>", "'grip_daul.xacro'"),  # it may include what defines the macro
        ({"grip_daul.xacro": "quad"}, "", "'grip_daul.xacro'"),
        # Another include has the name of what the file defines.
        ({"wheel_old.xacro": "wheel"}, '<xacro:include filename="wheel.xacro"/><xacro:wheel/><xacro:dual/>', None),
        ({"grip_duel.xacro": "duel"}, '<xacro:include filename="$(dirname)/grip_duel.xacro"/><xacro:duel/>', None),
        (
            {"grip_duel.xacro": "duel", "grip_all.xacro": "dual"},
            '<xacro:include filename="grip_duel.xacro"/><xacro:duel/><xacro:dual/>',
            "'grip_all.xacro'",
        ),
    ],
)
def test_proposed_file_defines_the_macro_that_is_called(
    tmp_path: Path, files: dict[str, str | None], call: str, hint: str | None
) -> None:
    for name, macro in files.items():
        inside = "" if macro is None else f'<xacro:macro name="{macro}"><link name="{macro}"/></xacro:macro>'
        write(tmp_path, {name: HEAD + inside + "</robot>"})
    finding = only(xacro(tmp_path, f'<xacro:include filename="grip_dual.xacro"/>{call}', {"XAC001"}))
    assert finding.message_id == "file-missing"
    assert finding.data["hint"] == (f" (did you mean {hint}?)" if hint else "")


@pytest.mark.parametrize(
    ("path", "found"),
    [
        ("file://$(find arm)/meshes/base.stl", False),
        ("$(find arm)/meshes/base.stl", False),
        ("$(find arm)/a.stl", True),
    ],
)
def test_one_mesh_by_its_package_and_by_its_path_is_no_difference(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, path: str, found: bool
) -> None:
    monkeypatch.chdir(tmp_path)  # files are named as they are reached from here
    body = '<link name="a"><visual><geometry><mesh filename="{}"/></geometry></visual></link><link name="b"/>'
    body += '<joint name="j" type="fixed"><parent link="a"/><child link="b"/></joint></robot>'
    files = {
        "arm/package.xml": "<package><name>arm</name></package>",
        "arm/urdf/arm.urdf": '<robot name="r">' + body.format("package://arm/meshes/base.stl"),
        "arm/urdf/arm.urdf.xacro": HEAD + body.format(path),
        ".git/HEAD": "",
    }
    run = check(write(tmp_path, files), codes={"XAC015"}, options={"XAC015": {"links": 2}})
    assert bool(run.findings) == found
    # Neither the message nor the data names a folder of the machine.
    assert str(tmp_path) not in str([(f.message, f.data) for f in run.findings])


@pytest.mark.parametrize(("there", "said"), [("a/part.xacro", True), ("b/part.xacro", False)])
def test_backslashes_of_a_path_are_the_cause_where_it_exists_with_slashes(
    tmp_path: Path, there: str, said: bool
) -> None:
    write(tmp_path, {there: HEAD + "</robot>"})
    finding = only(xacro(tmp_path, '<xacro:include filename="a\\part.xacro"/>', {"XAC001"}))
    assert ("with `/` in place of each backslash" in finding.message) == said
    assert finding.fix is not None
    assert (finding.fix.title == "write `/` for each backslash") == said
    assert finding.fix.title.startswith("correct the path") != said


@pytest.mark.parametrize(("inside", "is_offered"), [(True, True), (False, False)])
def test_a_name_that_a_macro_reads_may_be_a_parameter_that_it_lacks(
    tmp_path: Path, inside: bool, is_offered: bool
) -> None:
    frame = '<link name="${prefix}frame"/>'
    text = (
        '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">'
        f'<xacro:macro name="camera" params="name"><link name="${{name}}"/>{frame * inside}</xacro:macro>'
        f'<xacro:camera name="c"/>{frame * (not inside)}</robot>'
    )
    (finding,) = check_text(tmp_path, text, "r.urdf.xacro", codes={"XAC001"}).findings
    assert finding.fix is not None
    assert finding.fix.title.endswith("or add it to the params of macro camera") == is_offered


@pytest.mark.parametrize("declared", [True, False])
def test_a_file_that_includes_without_the_prefix_may_lack_it_in_more_places(tmp_path: Path, declared: bool) -> None:
    space = ' xmlns:xacro="http://www.ros.org/wiki/xacro"' if declared else ""
    finding = only(
        check_text(
            tmp_path,
            f'<robot name="r"{space}><include filename="b.xacro"/><body/></robot>',
            "r.urdf.xacro",
            codes={"XAC007"},
        )
    )
    assert finding.fix is not None
    assert ("declare the prefix: `<robot xmlns:xacro=" in finding.fix.title) is not declared
    assert "as may the calls of their macros: <body>" in finding.fix.title


@pytest.mark.parametrize(
    ("home", "repair"),
    [
        ("other", "correct the path, or use a release of q that has the file"),
        ("own", "correct the path, add the file, or use a version of q that has it"),
        ("own/p", "correct the path, or add the file"),
    ],
)
def test_a_file_that_a_package_from_elsewhere_lacks_may_be_in_another_release(
    tmp_path: Path, home: str, repair: str
) -> None:
    text = f'{HEAD}<xacro:include filename="$(find {"p" if home == "own/p" else "q"})/a.xacro"/></robot>'
    write(
        tmp_path,
        {
            "own/.git/HEAD": "",
            "own/p/package.xml": "<package><name>p</name></package>",
            "own/p/r.urdf.xacro": text,
            f"{home}/q/package.xml": "<package><name>q</name></package>",
        },
    )
    run = check(tmp_path / "own/p/r.urdf.xacro", codes={"XAC001"}, package_paths=[tmp_path / home])
    (finding,) = (f for f in run.findings if f.code == "XAC001")
    assert finding.fix is not None
    assert finding.fix.title == repair


@pytest.mark.parametrize(
    ("head", "text", "repair"),
    [
        (
            'name="r"',
            '<link name="$(arg a)"/><xacro:arg name="a" default="1"/>',
            "move its `<xacro:arg>` up, before what reads it",
        ),
        (
            'name="$(arg a)"',
            '<xacro:arg name="a" default="$(arg b)"/>',
            "give a value: `--arg a:=… --arg b:=…`; or write a fixed text",
        ),
        (
            'name="r"',
            '<xacro:arg name="prefix" default="1"/><link name="$(arg prefx)"/>',
            "write `$(arg prefix)` if that is meant",
        ),
        (
            'name="r"',
            '<link name="$(arg a)"/>',
            "give a value: `--arg a:=…`; or declare a default before the first use",
        ),
    ],
    ids=["late", "root", "slip", "missing"],
)
def test_the_repair_of_an_argument_fits_the_place_that_reads_it(
    tmp_path: Path, head: str, text: str, repair: str
) -> None:
    robot_ = f'<robot {head} xmlns:xacro="http://www.ros.org/wiki/xacro">{text}</robot>'
    finding = only(check_text(tmp_path, robot_, "r.urdf.xacro", codes={"XAC010"}))
    assert finding.fix is not None
    assert finding.fix.title.startswith(repair)


def test_a_package_from_elsewhere_may_have_a_release_with_the_prefixes(tmp_path: Path) -> None:
    text = f'{HEAD}<xacro:include filename="$(find q)/a.xacro"/><xacro:arm/></robot>'
    lamp = '<xacro:macro name="lamp"><link name="lamp"/></xacro:macro>'
    macro = f'{HEAD}{lamp}<xacro:macro name="arm"><lamp/></xacro:macro></robot>'
    write(
        tmp_path,
        {
            "own/.git/HEAD": "",
            "own/p/package.xml": "<package><name>p</name></package>",
            "own/p/r.urdf.xacro": text,
            "other/q/package.xml": "<package><name>q</name></package>",
            "other/q/a.xacro": macro,
        },
    )
    run = check(tmp_path / "own/p/r.urdf.xacro", codes={"XAC007"}, package_paths=[tmp_path / "other"])
    (finding,) = (f for f in run.findings if f.code == "XAC007")
    assert finding.fix is not None
    assert finding.fix.title.endswith("; or use a release of q for ROS Noetic or ROS 2")


def test_a_missing_file_that_a_package_of_the_same_name_has(tmp_path: Path) -> None:
    manifest = "<package><name>{}</name></package>"
    write(
        tmp_path,
        {
            ".git/HEAD": "",
            "a/q/package.xml": manifest.format("q"),
            "a/q/m.xacro": "<robot/>",
            "b/q/package.xml": manifest.format("q"),
            "b/p/package.xml": manifest.format("p"),
            "b/p/r.urdf.xacro": f'{HEAD}<xacro:include filename="$(find q)/m.xacro"/></robot>',
        },
    )
    (finding,) = (f for f in check(tmp_path, codes={"XAC001"}).findings if f.code == "XAC001")
    assert "but another package q has it: " in finding.message
    assert finding.fix is not None
    assert finding.fix.title.startswith("keep only the package q with ")


@pytest.mark.parametrize("defined", [True, False])
def test_a_property_of_itself_is_to_be_deleted(tmp_path: Path, defined: bool) -> None:
    """With the prefix xacro would stop at it; where nothing else defines the name it stops at it in any case."""
    known = '<xacro:property name="size" value="1"/>' if defined else ""
    run = xacro(tmp_path, f'{known}<property name="size" value="${{size}}"/>', {"XAC001", "XAC007"})
    own = only(run)
    assert (own.message_id, own.severity) == ("circular", Severity.INFO if defined else Severity.ERROR)
    assert own.fix is not None
    assert own.fix.title.startswith("delete it")
    assert [edit.replacement for edit in own.fix.edits] == [""]


@pytest.mark.parametrize(
    ("launch", "name", "severity", "passing"),
    [
        ("", ' name="r"', Severity.WARNING, False),  # a template: no start that fails is known
        ("xacro $(find car)/urdf/car.urdf.xacro", ' name="r"', Severity.ERROR, False),
        ("", "", Severity.WARNING, False),  # a piece: the robot that includes it gives it a value
        ("xacro $(find car)/urdf/car.urdf.xacro side:=$(env SIDE)", ' name="r"', Severity.WARNING, True),
        # The name of another file ends with this one's.
        ("xacro $(find car)/urdf/real_car.urdf.xacro side:=$(env SIDE)", ' name="r"', Severity.WARNING, False),
        ("xacro $(find car)/urdf/ca$(env KIND).urdf.xacro side:=$(env SIDE)", ' name="r"', Severity.WARNING, True),
        ("xacro $(find car)/urdf/ca$(env KIND).urdf.xacro", ' name="r"', Severity.ERROR, False),
    ],
)
def test_an_argument_is_missing_where_the_model_is_started(
    tmp_path: Path, launch: str, name: str, severity: Severity, passing: bool
) -> None:
    files = {
        "package.xml": "<package><name>car</name></package>",
        "launch/car.launch": f'<launch><param name="robot_description" command="{launch}"/></launch>',
        "urdf/real_car.urdf.xacro": HEAD + BASE + "</robot>",
        "urdf/car.urdf.xacro": HEAD.replace(' name="r"', name) + '<link name="$(arg side)"/></robot>',
    }
    finding = only(check(write(tmp_path, files) / "urdf/car.urdf.xacro", codes={"XAC010"}))
    assert finding.severity is severity
    assert finding.fix is not None
    assert finding.fix.title.endswith("car.launch passes one, known only at launch") == passing


def test_the_launch_file_that_starts_a_model_is_to_pass_the_argument(tmp_path: Path) -> None:
    command = "xacro $(find car)/urdf/car.urdf.xacro"
    files = {
        "package.xml": "<package><name>car</name></package>",
        "launch/car.launch": f'<launch><param name="robot_description" command="{command}"/></launch>',
        "urdf/car.urdf.xacro": HEAD + '<link name="$(arg side)"/></robot>',
    }
    finding = only(check(write(tmp_path, files) / "urdf/car.urdf.xacro", codes={"XAC010"}))
    assert finding.fix is not None
    assert finding.fix.title.startswith(
        "pass side in car.launch, which names the file (here: `--arg side:=…`); or declare"
    )


@pytest.mark.parametrize(("depends", "severity"), [(True, Severity.ERROR), (False, Severity.WARNING)])
def test_a_package_that_depends_on_the_model_starts_it_too(tmp_path: Path, depends: bool, severity: Severity) -> None:
    command = "xacro $(find car)/urdf/car.urdf.xacro"
    files = {
        "car/package.xml": "<package><name>car</name></package>",
        "car/urdf/car.urdf.xacro": HEAD + '<link name="$(arg side)"/></robot>',
        "go/package.xml": f"<package><name>go</name>{'<run_depend>car</run_depend>' * depends}</package>",
        "go/car.launch": f'<launch><param name="robot_description" command="{command}"/></launch>',
    }
    (tmp_path / ".git").mkdir()
    model = write(tmp_path, files) / "car/urdf/car.urdf.xacro"
    assert only(check(model, codes={"XAC010"})).severity is severity


@pytest.mark.parametrize(("passed", "severity"), [("side", Severity.WARNING), ("size", Severity.ERROR)])
def test_a_package_that_depends_on_the_model_passes_the_argument_too(
    tmp_path: Path, passed: str, severity: Severity
) -> None:
    files = {
        ".git/HEAD": "",
        "car/package.xml": "<package><name>car</name></package>",
        "car/urdf/car.urdf.xacro": HEAD + '<link name="$(arg side)"/></robot>',
        "go/package.xml": "<package><name>go</name><run_depend>car</run_depend></package>",
        "go/go.launch.py": f'launch = include(launch_arguments={{"{passed}": find(), "file": "car.urdf.xacro"}})',
    }
    finding = only(check(write(tmp_path, files) / "car/urdf/car.urdf.xacro", codes={"XAC010"}))
    assert finding.severity is severity


@pytest.mark.parametrize(
    ("file", "passed", "is_passed"),
    [
        ('os.path.join(get_package_share_directory("car"), file)', "side", True),
        ('PathJoinSubstitution([FindPackageShare("car"), "urdf", file])', "side", True),
        ('os.path.join(get_package_share_directory("car"), file)', "size", False),
        ('os.path.join(file, "urdf", "bus.urdf.xacro")', "side", False),  # only the folder is of an argument
        ('"bus.urdf.xacro"', "side", False),
    ],
)
@pytest.mark.parametrize(
    "call", ['xacro.process_file({}, mappings={{"{}": side}})', 'Command(["xacro ", {}, " {}:=", side])']
)
def test_a_python_launch_file_that_starts_any_model_passes_the_argument_to_each(
    tmp_path: Path, file: str, passed: str, is_passed: bool, call: str
) -> None:
    launch = f"""side = LaunchConfiguration("side").perform(context)
file = LaunchConfiguration("file").perform(context)
path = {file}
robot = {call.format("path", passed)}
"""
    files = {
        "package.xml": "<package><name>car</name></package>",
        "launch/any.launch.py": launch,
        "launch/start.launch.xml": '<launch><arg name="file" default="car.urdf.xacro"/></launch>',
        "urdf/car.urdf.xacro": HEAD + '<link name="$(arg side)"/></robot>',
    }
    finding = only(check(write(tmp_path, files) / "urdf/car.urdf.xacro", codes={"XAC010"}))
    assert finding.severity is (Severity.WARNING if is_passed else Severity.ERROR)


@pytest.mark.parametrize(
    ("include", "handed", "severity"),
    [
        ("$(arg extra)", "extra", Severity.INFO),
        ("$(arg extra)", "other", Severity.ERROR),
        ("$(find car)/urdf/$(arg extra).xacro", "extra", Severity.ERROR),  # the argument is no file
    ],
)
def test_a_file_that_a_launch_file_hands_to_a_model_is_its_part(
    tmp_path: Path, include: str, handed: str, severity: Severity
) -> None:
    files = {
        ".git/HEAD": "",
        "car/package.xml": "<package><name>car</name></package>",
        "car/urdf/car.urdf.xacro": f'{HEAD}<xacro:arg name="side" default=""/><xacro:arg name="extra" default=""/>{BASE}'
        f'<xacro:if value="$(arg side)"><xacro:include filename="{include}"/></xacro:if></robot>',
        "sim/package.xml": "<package><name>sim</name><run_depend>car</run_depend></package>",
        "sim/sim.launch.py": f'file = path("sim", "extra.xacro")\ninclude("car.launch.py", ["{handed}:=", file])',
        "sim/urdf/extra.xacro": HEAD + '<link name="$(arg side)"/></robot>',
    }
    finding = only(check(write(tmp_path, files) / "sim/urdf/extra.xacro", codes={"XAC010"}))
    assert (finding.severity, finding.blocks_check) == (severity, True)
    assert finding.fix is not None
    assert (
        "sim.launch.py only hands the file to a model that includes it ($(arg extra)); else give a value"
        in (finding.fix.title)
    ) == (severity is Severity.INFO)


@pytest.mark.parametrize(
    ("brought", "severity"),
    [
        ("", Severity.INFO),
        ('<link name="$(arg side)/base"/>', Severity.ERROR),
        ('<xacro:include filename="base.xacro"/>', Severity.ERROR),
        ('<xacro:base name="$(arg side)/base"/>', Severity.ERROR),
    ],
)
def test_a_file_that_hangs_on_the_link_of_another_needs_no_argument(
    tmp_path: Path, brought: str, severity: Severity
) -> None:
    tip = '<link name="tip"/><joint name="j" type="fixed"><parent link="$(arg side)/base"/><child link="tip"/></joint>'
    macro = '<xacro:macro name="base" params="name"><link name="${name}"/></xacro:macro>'
    files = {"tip.urdf.xacro": f"{HEAD}{macro}{tip}{brought}</robot>", "base.xacro": HEAD + "</robot>"}
    finding = only(check(write(tmp_path, files) / "tip.urdf.xacro", codes={"XAC010"}))
    assert (finding.severity, finding.blocks_check) == (severity, True)
    assert finding.fix is not None
    assert finding.fix.title.startswith("nothing if only a robot") == (severity is Severity.INFO)


def test_a_default_that_reads_its_own_argument_gives_it_no_value(tmp_path: Path) -> None:
    text = '<xacro:arg name="side" default="$(arg side)"/><link name="$(arg side)"/>'
    finding = only(xacro(tmp_path, text, {"XAC010"}))
    assert finding.headline == "the default of argument side reads the argument itself"
    assert finding.fix is not None
    assert finding.fix.title.startswith("write a default that does not read it, or give a value: `--arg side:=…`")
    assert not xacro(tmp_path, text, {"XAC010"}, arguments={"side": "left"}).findings


def test_the_one_that_is_used_is_first_among_names_that_xacro_refuses(tmp_path: Path) -> None:
    """The one that is used is named first, and the expressions are read once for all of them."""
    text = "".join(f'<property name="a-{number}" value="1"/>' for number in range(2000))
    found = xacro(tmp_path, text + '<link name="b${a-1999}"/>', {"XAC007"}).findings
    finding = next(f for f in found if f.message_id == "refused")
    assert finding.data["names"].startswith("a-1999, a-0, ")


@pytest.mark.parametrize(
    ("passed", "severity"), [("side:=$(env SIDE)", Severity.WARNING), ("size:=$(env SIDE)", Severity.ERROR)]
)
def test_what_another_value_defines_is_there_where_a_launch_file_passes_one(
    tmp_path: Path, passed: str, severity: Severity
) -> None:
    command = f"xacro $(find car)/urdf/car.urdf.xacro {passed}"
    place = '<xacro:if value="${side == \'left\'}"><xacro:property name="y" value="1"/></xacro:if>'
    head = '<xacro:arg name="side" default=""/><xacro:property name="side" value="$(arg side)"/>'
    files = {
        "package.xml": "<package><name>car</name></package>",
        "launch/car.launch": f'<launch><param name="robot_description" command="{command}"/></launch>',
        "urdf/car.urdf.xacro": HEAD + head + place + '\n<link name="base${y}"/></robot>',
    }
    finding = only(check(write(tmp_path, files) / "urdf/car.urdf.xacro", codes={"XAC001"}))
    assert (finding.message_id, finding.severity, finding.blocks_check) == ("undefined-name", severity, True)
    assert finding.fix is not None
    assert ("car.launch passes one" in finding.fix.title) == (severity is Severity.WARNING)


@pytest.mark.parametrize(("passed", "is_passed"), [("side:=$(env SIDE)", True), ("size:=$(env SIDE)", False)])
def test_a_launch_file_that_starts_any_model_passes_the_argument_to_each(
    tmp_path: Path, passed: str, is_passed: bool
) -> None:
    command = f"xacro '$(arg model)' {passed}"
    files = {
        ".git/HEAD": "",
        "car/package.xml": "<package><name>car</name></package>",
        "car/urdf/car.urdf.xacro": HEAD + '<link name="$(arg side)"/></robot>',
        "start/package.xml": "<package><name>start</name></package>",
        "start/launch/any.launch": '<launch><arg name="model"/>'
        f'<param name="robot_description" command="{command}"/></launch>',
    }
    finding = only(check(write(tmp_path, files) / "car/urdf/car.urdf.xacro", codes={"XAC010"}))
    assert finding.severity is Severity.WARNING
    assert finding.fix is not None
    assert finding.fix.title.endswith("any.launch passes one, known only at launch") == is_passed


@pytest.mark.parametrize(
    ("tag", "repair"),
    [
        ("if", "write `SIM_CORE` if that is meant, delete the condition and what is in it if it is left over, or"),
        ("", "write `SIM_CORE`, or"),
    ],
)
def test_a_condition_on_a_name_like_another_may_be_left_over(tmp_path: Path, tag: str, repair: str) -> None:
    use = '<xacro:if value="${SIM_COR}"><link name="a"/></xacro:if>' if tag else '<link name="${SIM_COR}"/>'
    finding = only(xacro(tmp_path, f'<xacro:property name="SIM_CORE" value="1"/>{use}', {"XAC001"}))
    assert finding.fix is not None
    assert finding.fix.title.startswith(repair)


@pytest.mark.parametrize("defining", [True, False])
def test_the_only_file_beside_is_named_where_it_may_be_meant(tmp_path: Path, defining: bool) -> None:
    """Of two files, one of which defines another macro than the missing one, neither is known to be meant."""
    other = f'{HEAD}<xacro:macro name="other" params="name"/></robot>'
    files = {
        "r.urdf.xacro": f'{HEAD}<xacro:include filename="parts/importable.xacro"/><xacro:arm name="b"/></robot>',
        "parts/zz.xacro": f'{HEAD}<link name="c"/></robot>',
        **({"parts/qq.xacro": other} if defining else {}),
    }
    (finding,) = find(tmp_path, files, "XAC001", name="r.urdf.xacro")
    assert finding.data["hint"] == ("" if defining else " (the only other .xacro file there is 'zz.xacro')")


@pytest.mark.parametrize("copies", [1, 2])
def test_the_file_that_a_default_names_may_be_in_another_folder(tmp_path: Path, copies: int) -> None:
    use = """<xacro:arg name="start" default="start.yaml"/><link name="${xacro.load_yaml('$(arg start)')['a']}"/></robot>"""
    files = {"package.xml": "<package><name>p</name></package>", "urdf/r.urdf.xacro": HEAD + use}
    files |= {f"c{number}/start.yaml": "a: b" for number in range(copies)}
    (finding,) = find(tmp_path, files, "XAC001", name="urdf/r.urdf.xacro")
    assert finding.fix is not None
    assert finding.fix.title.endswith(": `$(find p)/c0/start.yaml`, if that is the one") == (copies == 1)


def test_the_arguments_may_be_those_of_another_start(tmp_path: Path) -> None:
    text = """<xacro:arg name="side" default=""/><link name="${dict(left=1)['$(arg side)']}"/>"""
    finding = only(xacro(tmp_path, text, {"XAC001"}))
    assert finding.fix is not None
    assert finding.fix.title.endswith(
        "; if arguments give them, first pass those with which the robot is started (`--arg`)"
    )


@pytest.mark.parametrize(
    ("before", "repair"),
    [
        ('<xacro:arg name="part" default="b"/>', "write `$(arg part)`"),
        ('<xacro:property name="part" value="b"/>', "write `${part}`"),
        ("", "write the text that is meant, or `${part}` and define part before it"),
    ],
)
def test_a_name_alone_is_no_substitution(tmp_path: Path, before: str, repair: str) -> None:
    finding = only(xacro(tmp_path, f'{before}<link name="$(part)"/>', {"XAC001"}))
    assert finding.fix is not None
    assert finding.fix.title == repair


@pytest.mark.parametrize(
    ("typed", "repair"),
    [
        ("${find arm}/a.xacro", "write `$(find arm)`: it is not an expression"),
        ("${find-pkg-share arm}/a.xacro", "write `$(find arm)`: it is not an expression"),
        ("$(find-pkg-share arm)/a.xacro", "write `$(find arm)`"),
        ("${find + }/a.xacro", "correct the expression; xacro ends"),
    ],
)
def test_a_package_is_found_by_the_word_of_xacro(tmp_path: Path, typed: str, repair: str) -> None:
    finding = only(xacro(tmp_path, f'<xacro:include filename="{typed}"/>', {"XAC001"}))
    assert finding.fix is not None
    assert finding.fix.title.startswith(repair)


@pytest.mark.parametrize(
    ("default", "expression", "written"),
    [
        ("a.yaml", "'config/' + file", "`'$(arg file)'`, in quotes"),
        ("a.yaml", "file", "`$(arg file)`"),
        ("2", "1 + file", "`$(arg file)`"),
        ("false", "1 if file else 2", '`<xacro:property name="file" value="$(arg file)"/>`'),
    ],
)
def test_an_expression_reads_an_argument_in_quotes_unless_it_is_a_number(
    tmp_path: Path, default: str, expression: str, written: str
) -> None:
    """What is proposed is expanded."""
    head = f'<xacro:arg name="file" default="{default}"/>'
    finding = only(xacro(tmp_path, f'{head}<link name="${{{expression}}}"/>', {"XAC001"}))
    assert finding.fix is not None
    assert written in finding.fix.title
    proposed = finding.fix.title.split("`")[1]
    before = proposed if proposed.startswith("<") else ""
    read = "${file}" if expression == "file" else "file"  # alone it needs no expression
    after = f"${{{expression}}}" if before else f"${{{expression}}}".replace(read, proposed)
    repaired = f'{head}{before}<link name="{after}"/>'
    assert not xacro(tmp_path / "repaired", repaired, {"XAC001"}).findings


def test_a_parameter_read_as_an_argument_is_one_finding_in_all_models_of_the_macro(tmp_path: Path) -> None:
    """Whether another file of a model declares an argument of that name does not matter."""
    files = {
        "eye.xacro": HEAD
        + '<xacro:macro name="eye" params="plug:=false"><xacro:if value="$(arg plug)"><link name="p"/></xacro:if>'
        "</xacro:macro></robot>",
        "a.urdf.xacro": HEAD + '<xacro:include filename="eye.xacro"/><xacro:eye/></robot>',
        "b.urdf.xacro": HEAD
        + '<xacro:include filename="eye.xacro"/><xacro:eye/><xacro:arg name="plug" default="1"/></robot>',
    }
    finding = only(check(write(tmp_path, files), codes={"XAC010"}))
    assert finding.fix is not None
    assert finding.fix.title.startswith("write `${plug}`")


def test_a_computed_name_is_not_one_of_an_argument(tmp_path: Path) -> None:
    text = (
        '<xacro:macro name="m" params="side"><link name="$(arg ${side}_name)$(arg size)"/></xacro:macro>'
        '<xacro:arg name="left_name" default="l"/><link name="$(arg kind)"/><xacro:m side="left"/>'
    )
    assert only(xacro(tmp_path, text, {"XAC010"})).data["missing"] == ["kind", "size"]


@pytest.mark.parametrize("package", ["camera", "p"])
def test_a_macro_may_be_in_another_version_of_the_package_with_its_file(tmp_path: Path, package: str) -> None:
    files = {
        "p/package.xml": "<package><name>p</name></package>",
        "camera/package.xml": "<package><name>camera</name></package>",
        f"{package}/eye.urdf.xacro": f"{HEAD}<link name='eye'/></robot>",
        "p/r.urdf.xacro": f'{HEAD}<xacro:include filename="$(find {package})/eye.urdf.xacro"/><xacro:eye/></robot>',
    }
    (finding,) = find(tmp_path, files, "XAC001", name="p/r.urdf.xacro")
    assert finding.fix is not None
    start = "use a release or fork of camera whose eye.urdf.xacro defines the macro, or delete the call"
    assert finding.fix.title.startswith(start) == (package == "camera")


@pytest.mark.parametrize("is_included", [True, False])
def test_a_macro_that_another_defines_is_gone_behind_the_call(tmp_path: Path, is_included: bool) -> None:
    inner = '<xacro:macro name="lens" params=""><link name="lens"/></xacro:macro>'
    write(tmp_path, {"lens.xacro": f"{HEAD}{inner}</robot>"})
    made = '<xacro:include filename="lens.xacro"/>' if is_included else inner
    text = f'<xacro:macro name="eye" params="">{made}<link name="eye"/></xacro:macro><xacro:eye/><xacro:lens/>'
    finding = only(xacro(tmp_path, text, {"XAC001"}))
    assert finding.message_id == "macro-local"
    assert finding.headline == "macro lens is only defined inside macro eye"
    assert finding.fix is not None
    assert finding.fix.title == (
        "include lens.xacro before this line, outside any macro"
        if is_included
        else "move the definition of lens out of it, above this call"
    )


def test_a_file_of_macros_that_includes_one_that_was_read_may_be_included_too(tmp_path: Path) -> None:
    include = '<xacro:include filename="colours.xacro"/>'
    eye = '<xacro:macro name="{0}" params=""><link name="{0}"/></xacro:macro></robot>'
    files = {
        "package.xml": "<package><name>p</name></package>",
        "colours.xacro": HEAD + '<material name="red"/></robot>',
        "left.xacro": HEAD + include + eye.format("left"),
        "right.xacro": HEAD + include + eye.format("right"),
        "eyes.urdf.xacro": HEAD + '<xacro:include filename="left.xacro"/><xacro:left/><xacro:right/></robot>',
    }
    finding = only(check(write(tmp_path, files) / "eyes.urdf.xacro", codes={"XAC001"}))
    assert finding.fix is not None
    assert finding.fix.title == ("include right.xacro, which defines the macro, before this line, or correct the name")


def test_another_robot_that_includes_the_part_is_not_to_be_included_in_it(tmp_path: Path) -> None:
    size, part = '<xacro:property name="size" value="1"/>', '<xacro:include filename="part.xacro"/>'
    files = {
        "package.xml": "<package><name>p</name></package>",
        "big.urdf.xacro": f"{HEAD}{size}{part}</robot>",
        "sizes.xacro": f"{HEAD}{size}</robot>",
        "small.urdf.xacro": f"{HEAD}{part}</robot>",
        "part.xacro": f'{HEAD}<link name="a_${{size}}"/></robot>',
    }
    (finding,) = find(tmp_path, files, "XAC001", name="small.urdf.xacro")
    assert finding.fix is not None
    assert ("sizes.xacro" in finding.fix.title, "big.urdf.xacro" in finding.fix.title) == (True, False)


def test_the_place_of_a_missing_parameter_is_the_call_and_not_a_block_in_it(tmp_path: Path) -> None:
    text = (
        '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">\n'
        '<xacro:macro name="mount" params="a *origin"><link name="${a}"/></xacro:macro>\n'
        '<xacro:mount>\n<origin xyz="${1 + 1} 0 0"/>\n</xacro:mount></robot>'
    )
    (finding,) = check_text(tmp_path, text, "robot.urdf.xacro", codes={"XAC001"}).findings
    assert finding.message_id == "parameters-missing"
    assert finding.location.span is not None
    assert finding.location.span.line == 3
    assert not finding.location.via


def test_a_call_that_hands_a_block_on_is_where_its_parameter_is_missing(tmp_path: Path) -> None:
    """The block is typed in the call of the outer macro, and xacro evaluates it before the inner call fails."""
    macros = (
        '<xacro:macro name="lens" params="frame *at"><link name="${frame}"/></xacro:macro>\n'
        '<xacro:macro name="camera" params="*at">\n<xacro:lens><xacro:insert_block name="at"/></xacro:lens></xacro:macro>\n'
    )
    text = macros + '<xacro:camera>\n<origin xyz="${1} 0 0"/></xacro:camera>'
    finding = only(xacro(tmp_path, text, {"XAC001"}))
    assert finding.message_id == "parameters-missing"
    assert finding.location.span is not None
    line, call = finding.location.span.line, (HEAD + BASE + text).splitlines()
    assert call[line - 1].startswith("<xacro:lens>")


@pytest.mark.parametrize(
    "definition",
    [
        '<property name="lb-in" value="1"/>',
        '<property name="in" value="1"/>',
        '<property name="__a" value="1"/>',
        '<property name="${1}-a" value="1"/>',
        '<property name="a" value="1" default="2"/>',
        '<macro name="a.b" params=""/>',
        '<macro name="call" params=""/>',
    ],
)
def test_a_definition_that_xacro_refuses_gets_no_prefix(tmp_path: Path, definition: str) -> None:
    """The others of the file get it, and xacro then expands the robot; with all of them it would stop."""
    radius = '<property name="radius" value="1"/>'
    use = '<link name="a"><visual><geometry><sphere radius="${radius}"/></geometry></visual></link>'
    found = xacro(tmp_path / "now", definition + radius + use, {"XAC001", "XAC007"}, unrequested=frozenset()).findings
    refused = next(f for f in found if f.message_id == "refused")
    assert (refused.severity, refused.fix is not None and refused.fix.edits) == (Severity.INFO, ())
    assert len([edit for f in found if f.fix is not None for edit in f.fix.edits]) == 1
    prefixed = radius.replace("<", "<xacro:") + use
    assert not xacro(tmp_path / "mended", definition + prefixed, {"XAC001"}).findings
    stopped = xacro(tmp_path / "stopped", definition.replace("<", "<xacro:") + prefixed, {"XAC001"})
    assert only(stopped).code == "XAC001"


@pytest.mark.parametrize("name", ["é", "match", "a_1", "${'lb'}_in"])
def test_a_name_that_xacro_takes_gets_the_prefix(tmp_path: Path, name: str) -> None:
    text = f'<property name="{name}" value="1"/>'
    finding = only(xacro(tmp_path / "now", text, {"XAC007"}, unrequested=frozenset()))
    assert finding.message_id == "dead"
    assert not xacro(tmp_path / "prefixed", text.replace("<", "<xacro:"), {"XAC001"}).findings


def test_a_refused_name_that_an_expression_uses_is_an_error(tmp_path: Path) -> None:
    """The expression means another thing than the author: `lb` minus `in`."""
    text = '<property name="lb-in" value="1"/><link name="a"><inertial><mass value="${2 * lb-in}"/></inertial></link>'
    found = xacro(tmp_path, text, {"XAC007"}).findings
    finding = next(f for f in found if f.code == "XAC007")
    assert finding.severity is Severity.ERROR
    assert finding.fix is not None
    assert finding.fix.title == "write another name, also where it is used, then `<xacro:property …>`"


NAMELESS = HEAD.replace(' name="r"', "")
MATERIALS = '<xacro:include filename="materials.xacro"/>'


@pytest.mark.parametrize(
    ("text", "launched", "severity"),
    [
        (f'{NAMELESS}<link name="j${{sie}}"/></robot>', "other.urdf.xacro", Severity.WARNING),
        (f'{NAMELESS}<link name="j${{sie}}"/></robot>', "part.urdf.xacro", Severity.ERROR),
        (f'{HEAD}<link name="j${{sie}}"/></robot>', "$(arg model)", Severity.ERROR),
        (f'{HEAD}<xacro:include filename="gone.xacro"/>{WHEEL}</robot>', "other.urdf.xacro", Severity.WARNING),
        (f'{HEAD}<xacro:include filename="gone.xacro"/>{WHEEL}</robot>', "part.urdf.xacro", Severity.ERROR),
        (f'{HEAD}<xacro:include filename="gone.xacro"/></robot>', "other.urdf.xacro", Severity.ERROR),
        (
            f'{HEAD}<xacro:include filename="gone.xacro"/>{WHEEL}<xacro:wheel name="a"/></robot>',
            "other.urdf.xacro",
            Severity.ERROR,
        ),
        (HEAD.replace('"r"', '"${eye}"') + MATERIALS + WHEEL + "</robot>", "other.urdf.xacro", Severity.WARNING),
    ],
)
def test_what_stops_a_file_that_makes_no_robot_is_a_warning(
    tmp_path: Path, text: str, launched: str, severity: Severity
) -> None:
    """It has no name, or only macros, and no launch file starts it."""
    load = f'<param name="robot_description" command="xacro $(find car)/urdf/{launched}"/>'
    files = {
        "package.xml": "<package><name>car</name></package>",
        "launch/car.launch": f"<launch>{load}</launch>",
        "urdf/other.urdf.xacro": HEAD + '<link name="b"/></robot>',
        "urdf/materials.xacro": NAMELESS + '<xacro:macro name="red"/></robot>',
        "urdf/part.urdf.xacro": text,
    }
    # Found in its folder, what nothing names would be left over.
    model = write(tmp_path, files) / "urdf/part.urdf.xacro"
    (finding,) = (f for f in check(model, codes={"XAC001"}).findings if f.code == "XAC001")
    assert (finding.severity, finding.blocks_check) == (severity, True)
    assert finding.fix is not None
    if severity is Severity.WARNING:
        assert finding.fix.title.startswith("delete this file if nothing needs it; else ")


@pytest.mark.parametrize(
    ("default", "started", "severity"),
    [
        ("", "", Severity.WARNING),
        ("", "dual.urdf.xacro", Severity.ERROR),
        ("", "dual.urdf.xacro arm:=$(env ARM)", Severity.WARNING),
        ("x", "", Severity.ERROR),
        ("x", "dual.urdf.xacro arm:=$(env ARM)", Severity.WARNING),
    ],
)
@pytest.mark.parametrize("read", ["$(arg arm)", "${kind}"])
def test_an_empty_default_is_a_value_that_is_to_be_given(
    tmp_path: Path, default: str, started: str, severity: Severity, read: str
) -> None:
    """A template that no launch file starts gets it from outside."""
    load = f'<param name="robot_description" command="xacro $(find p)/urdf/{started or "other.urdf.xacro"}"/>'
    files = {
        "package.xml": "<package><name>p</name></package>",
        "launch/a.launch": f"<launch>{load}</launch>",
        "urdf/other.urdf.xacro": HEAD + '<link name="b"/></robot>',
        "arms/one/arm.xacro": HEAD + '<link name="b"/></robot>',
        "arms/two/arm.xacro": HEAD + '<link name="b"/></robot>',
        "urdf/dual.urdf.xacro": f'{HEAD}<xacro:arg name="arm" default="{default}"/>'
        '<xacro:property name="kind" value="$(arg arm)"/>'
        f'<xacro:include filename="$(find p)/arms/{read}/arm.xacro"/></robot>',
    }
    # Found in its folder, what nothing names would be left over.
    given = write(tmp_path, files) / ("" if started else "urdf/dual.urdf.xacro")
    (finding,) = (f for f in check(given, codes={"XAC001"}).findings if f.code == "XAC001")
    assert finding.message_id == ("argument-leads-nowhere" if default else "argument-empty")
    assert finding.severity is severity
    assert finding.fix is not None
    assert ("a.launch passes one, known only at launch" in finding.fix.title) == ("arm:=" in started)
    assert f"--arg arm:={'one' if 'arg' in read else '…'}" in finding.fix.title


@pytest.mark.parametrize(
    ("beside", "values"),
    [(["base2TD.xacro", "base4WD.xacro"], "2TD, 4WD"), (["other.xacro"], None), (["basic_2TD.xacro"], None)],
)
def test_an_empty_argument_within_the_name_of_a_file_is_to_be_given(
    tmp_path: Path, beside: list[str], values: str | None
) -> None:
    include = '<xacro:arg name="type" default=""/><xacro:include filename="parts/base$(arg type).xacro"/>'
    write(tmp_path, {f"parts/{name}": HEAD + "</robot>" for name in beside})
    finding = only(xacro(tmp_path, include, {"XAC001"}))
    assert finding.message_id == ("argument-empty" if values else "file-missing")
    assert finding.fix is not None
    if values:
        assert f"known values: {values}" in finding.message
        assert finding.fix.title.startswith("give a value: `--arg type:=2TD`")


@pytest.mark.parametrize("default", ["$(find p)/arms/$(arg arm)/a.yaml", "$(find p)/arms/one/$(arg arm)/a.yaml"])
def test_an_empty_argument_in_the_default_of_another_is_to_be_given(tmp_path: Path, default: str) -> None:
    files = {
        "package.xml": "<package><name>p</name></package>",
        "arms/one/a.yaml": "a: 1",
        "arm.urdf.xacro": f'{HEAD}<xacro:arg name="arm" default=""/><xacro:arg name="sizes" default="{default}"/>'
        '<xacro:macro name="arm" params="file"><xacro:property name="a" value="${xacro.load_yaml(file)}"/>'
        '<link name="b${a[1]}"/></xacro:macro><xacro:arm file="$(arg sizes)"/></robot>',
    }
    found = check(write(tmp_path, files) / "arm.urdf.xacro", codes={"XAC001"}).findings
    if "one" in default:
        assert not any(f.message_id == "file-missing" for f in found)  # arms/one//a.yaml is there
    else:
        assert [f.message_id for f in found] == ["argument-empty"]


@pytest.mark.parametrize("file", ["${kind}_arm.xacro", "small_arm.xacro"])
def test_a_call_of_the_macros_of_several_files_needs_its_parameters_in_each(tmp_path: Path, file: str) -> None:
    macro = '<xacro:macro name="arm" params="side{}"><link name="${{side}}"/></xacro:macro></robot>'
    files = {
        "package.xml": "<package><name>p</name></package>",
        "small_arm.xacro": HEAD + macro.format(""),
        "large_arm.xacro": HEAD + macro.format(" gripper"),
        "arm.urdf.xacro": f'{HEAD}<xacro:property name="kind" value="small"/><xacro:include filename="{file}"/>'
        '<xacro:arm side="left" gripper="g"/></robot>',
    }
    finding = only(check(write(tmp_path, files) / "arm.urdf.xacro", codes={"XAC001"}))
    assert finding.fix is not None
    assert finding.fix.title == (
        "add gripper to the macro's params; large_arm.xacro of the package defines a macro arm that has it, and the name of the"
        " file is computed: the call serves both"
        if "$" in file
        else "correct or remove the attribute gripper, or add gripper to the macro's params"
    )


@pytest.mark.parametrize(
    ("other", "value", "severity"),
    [
        ("", "lost", Severity.ERROR),
        ('<include file="$(find p)/launch/sub.launch"><arg name="kind" value="one"/></include>', "lost", Severity.WARNING),
        ('<include file="$(find p)/launch/sub.launch"><arg name="x" value="one"/></include>', "lost", Severity.ERROR),
        ('<param name="robot_description" command="xacro $(find p)/arm.urdf.xacro arm:=one"/>', "lost", Severity.ERROR),
        ('<param name="robot_description" command="xacro $(find p)/arm.urdf.xacro arm:=one"/>', "", Severity.WARNING),
    ],
)  # fmt: skip
def test_a_default_of_a_launch_file_may_be_one_that_another_replaces(
    tmp_path: Path, other: str, value: str, severity: Severity
) -> None:
    start = '<param name="robot_description" command="xacro $(find p)/arm.urdf.xacro arm:=$(arg kind)"/>'
    files = {
        "package.xml": "<package><name>p</name></package>",
        "launch/sub.launch": f'<launch><arg name="kind" default="{value}"/>{start}</launch>',
        "launch/go.launch": f"<launch>{other}</launch>",
        "arms/one/arm.xacro": HEAD + '<link name="b"/></robot>',
        "arm.urdf.xacro": f'{HEAD}<xacro:arg name="arm" default="one"/>'
        '<xacro:include filename="$(find p)/arms/$(arg arm)/arm.xacro"/></robot>',
    }
    found = [f for f in check(write(tmp_path, files), codes={"XAC001"}).findings if f.code == "XAC001"]
    assert [(f.severity, f.blocks_check) for f in found] == [(severity, True)]
    assert found[0].fix is not None
    assert ("go.launch passes another" in found[0].fix.title) == (severity is Severity.WARNING)


@pytest.mark.parametrize("name", ["M_PI", "PI"])
def test_pi_under_the_name_of_another_language_is_pi(tmp_path: Path, name: str) -> None:
    """However often it is read."""
    text = f'<link name="a${{{name}}}"/><link name="a${{{name}}}"/>'
    finding = only(xacro(tmp_path, text, {"XAC001"}))
    assert finding.fix is not None
    assert finding.fix.title.startswith("write `pi`, or define it before this line")


@pytest.mark.parametrize(
    ("call", "repair"),
    [
        (
            '<xacro:eye name="a" ns="b"/>',
            "or add ns to the macro's params, or use a version of camera whose macro has it",
        ),
        (
            "<xacro:eye/>",
            "(`name:=value`), or use a version of camera whose macro does not need it",
        ),
    ],
)
@pytest.mark.parametrize("package", ["camera", "p"])
def test_the_parameters_of_a_macro_may_be_those_of_another_version_of_its_package(
    tmp_path: Path, call: str, repair: str, package: str
) -> None:
    macro = '<xacro:macro name="eye" params="name"><link name="${name}"/></xacro:macro>'
    files = {
        "p/package.xml": "<package><name>p</name></package>",
        "camera/package.xml": "<package><name>camera</name></package>",
        f"{package}/eye.urdf.xacro": f"{HEAD}{macro}</robot>",
        "p/r.urdf.xacro": f'{HEAD}<xacro:include filename="$(find {package})/eye.urdf.xacro"/>{call}</robot>',
    }
    (finding,) = find(tmp_path, files, "XAC001", name="p/r.urdf.xacro")
    assert finding.fix is not None
    assert finding.fix.title.endswith(repair) == (package == "camera")


@pytest.mark.parametrize("is_there", [True, False])
def test_an_empty_folder_is_there(tmp_path: Path, is_there: bool) -> None:
    (tmp_path / ("config" if is_there else "other")).mkdir()
    finding = only(xacro(tmp_path, """<link name="${xacro.load_yaml('config/a.yaml')}"/>""", {"XAC001"}))
    assert ("nor does its folder" in finding.message) != is_there


@pytest.mark.parametrize(("folder", "severity"), [("urdf", Severity.ERROR), ("urdf/old", Severity.WARNING)])
def test_a_call_without_the_prefix_in_a_kept_file_is_a_warning(tmp_path: Path, folder: str, severity: Severity) -> None:
    files = {
        "package.xml": "<package><name>car</name></package>",
        f"{folder}/car.urdf.xacro": HEAD + BASE + WHEEL + '<wheel name="a"/></robot>',
    }
    finding = only(check(write(tmp_path, files) / f"{folder}/car.urdf.xacro", codes={"XAC007"}))
    assert (finding.message_id, finding.severity) == ("unprefixed", severity)


@pytest.mark.parametrize(
    ("texts", "severity"),
    [
        ({"README.md": "Tested on ROS Melodic."}, Severity.WARNING),
        ({"README.md": "ROS Melodic, Noetic"}, Severity.ERROR),
        ({}, Severity.ERROR),
        ({"Docker/Dockerfile": "ENV ROS_DISTRO melodic"}, Severity.WARNING),
        ({"Dockerfile": "FROM osrf/ros:kinetic-desktop"}, Severity.WARNING),
        ({"Dockerfile": "FROM osrf/ros:humble-desktop"}, Severity.ERROR),
        ({"install.bash": "apt install ros-kinetic-desktop-full"}, Severity.WARNING),
        ({"install.bash": "# apt install ros-kinetic-desktop-full"}, Severity.ERROR),
        ({"run.sh": "source /opt/ros/melodic/setup.bash", "README.md": "for Noetic"}, Severity.ERROR),
        ({"run.sh": "source /opt/ros/melodic/setup.bash", "src/car/README.md": "for Noetic"}, Severity.WARNING),
        ({"README.md": "Melodic", "src/car/README.md": "for Noetic"}, Severity.ERROR),
        ({"build/CMakeCache.txt": "xacro_DIR:PATH=/opt/ros/kinetic/share/xacro/cmake"}, Severity.WARNING),
    ],
)
@pytest.mark.parametrize("is_expanded", [True, False])
def test_a_call_without_the_prefix_is_a_warning_where_the_project_stays_on_melodic(
    tmp_path: Path, texts: dict[str, str], severity: Severity, is_expanded: bool
) -> None:
    value = "" if is_expanded else '<property name="far" value="1"/><link name="a${far}"/>'
    files = {
        ".git/HEAD": "",
        "src/car/package.xml": "<package><name>car</name></package>",
        "src/car/urdf/car.urdf.xacro": HEAD + BASE + WHEEL + value + '<wheel name="a"/></robot>',
        **texts,
    }
    finding = only(check(write(tmp_path, files) / "src/car/urdf/car.urdf.xacro", codes={"XAC007", "XAC001"}))
    assert (finding.message_id, finding.severity) == ("unprefixed" if is_expanded else "halted", severity)


@pytest.mark.parametrize(("release", "severity"), [("Kinetic", Severity.WARNING), ("Melodic", Severity.ERROR)])
def test_a_macro_that_is_defined_later_is_a_warning_where_xacro_reads_all_macros_first(
    tmp_path: Path, release: str, severity: Severity
) -> None:
    files = {"README.md": release, "car.urdf.xacro": HEAD + BASE + '<xacro:wheel name="a"/>' + WHEEL + "</robot>"}
    finding = only(check(write(tmp_path, files) / "car.urdf.xacro", codes={"XAC001"}))
    assert (finding.message_id, finding.severity) == ("macro-later", severity)


@pytest.mark.parametrize(
    ("inside", "is_call"),
    [('<eye n="${n}"/>', False), ('<xacro:if value="${n > 0}"><eye n="${n - 1}"/></xacro:if>', True)],
)
def test_a_tag_in_the_macro_of_its_own_name_is_no_call_without_an_end(
    tmp_path: Path, inside: str, is_call: bool
) -> None:
    text = f'<xacro:macro name="eye" params="n">{inside}</xacro:macro><xacro:eye n="1"/>'
    assert bool(xacro(tmp_path, text, {"XAC007"}).findings) == is_call


@pytest.mark.parametrize(("value", "severity"), [("HOME", Severity.WARNING), ("nothing", Severity.ERROR)])
def test_a_variable_that_is_not_read_is_a_warning(tmp_path: Path, value: str, severity: Severity) -> None:
    """Where it is set, the model is expanded."""
    text = "$(env HOME)" if value == "HOME" else "${nothing}"
    finding = only(xacro(tmp_path, f'<link name="{text}"/>', {"XAC001"}))
    assert (finding.severity, finding.blocks_check) == (severity, True)


@pytest.mark.parametrize(("ignored", "is_built"), [("made/", True), ("build/", False)])
@pytest.mark.parametrize("is_there", [True, False])
def test_a_file_that_git_ignores_is_to_be_built_with_its_folder(
    tmp_path: Path, ignored: str, is_built: bool, is_there: bool
) -> None:
    files = {
        ".gitignore": f"{ignored}\n",
        "package.xml": "<package><name>car</name></package>",
        "car.urdf.xacro": HEAD + BASE + '<xacro:include filename="$(find car)/made/sizes.xacro"/></robot>',
    }
    if is_there:
        (tmp_path / "made").mkdir()
    finding = only(check(write(tmp_path, files) / "car.urdf.xacro", codes={"XAC001"}))
    assert finding.fix is not None
    assert finding.fix.title.startswith("build car first, which may make the file; if it does not, ") == is_built


@pytest.mark.parametrize(
    ("defined", "is_meant"),
    [
        ({"lidar.xacro": "laser_lidar"}, True),
        ({"lidar.xacro": "laser_lidar", "other.xacro": "lidar_mount"}, False),  # either may be meant
        ({"lidar.xacro": "laser"}, False),
    ],
)
def test_the_only_uncalled_macro_with_all_words_of_a_name_may_be_meant(
    tmp_path: Path, defined: dict[str, str], is_meant: bool
) -> None:
    head = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">'
    for file, name in defined.items():
        (tmp_path / file).write_text(
            f"{head}<xacro:macro name='{name}' params='prefix'><link name='${{prefix}}l'/></xacro:macro></robot>"
        )
    body = "".join(f"<xacro:include filename='{file}'/>\n" for file in defined)
    finding = only(xacro(tmp_path, f"{body}<link name='base'/><xacro:lidar prefix='a'/>", {"XAC001"}))
    assert ("did you mean 'laser_lidar' of lidar.xacro, which line 3 includes?" in finding.message) == is_meant


@pytest.mark.parametrize(
    ("defined", "called", "is_meant"),
    [
        (["simple_gripper_urdf"], "vacuum_gripper_urdf", True),
        # Nothing says which of two it is, and a name without a word of the other is another thing.
        (["simple_gripper_urdf", "double_gripper_urdf"], "vacuum_gripper_urdf", False),
        (["simple_gripper_urdf"], "laser", False),
    ],
)
def test_the_only_macro_of_the_file_that_is_included_just_before_a_call_may_be_meant(
    tmp_path: Path, defined: list[str], called: str, is_meant: bool
) -> None:
    head = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">'
    macros = [
        f"<xacro:macro name='{name}' params='prefix'><link name='${{prefix}}l'/></xacro:macro>" for name in defined
    ]
    (tmp_path / "gripper.xacro").write_text(f"{head}{''.join(macros)}</robot>")
    (tmp_path / "later.xacro").write_text(f"{head}</robot>")
    body = f"<xacro:include filename='gripper.xacro'/>\n<xacro:{called} prefix='a'/>\n<xacro:include filename='later.xacro'/>"
    finding = only(xacro(tmp_path, body, {"XAC001"}))
    assert (
        "did you mean 'simple_gripper_urdf' of gripper.xacro, which line 3 includes?" in finding.message
    ) == is_meant
    assert finding.fix is not None
    assert ("move the include" in finding.fix.title) != is_meant


@pytest.mark.parametrize(
    ("name", "launched", "severity"),
    [
        ("car copy.urdf.xacro", "car.urdf.xacro", Severity.WARNING),
        ("car (1).urdf.xacro", "car.urdf.xacro", Severity.WARNING),
        ("car - Copy (2).urdf.xacro", "car.urdf.xacro", Severity.WARNING),
        ("car_old.urdf.xacro", "car.urdf.xacro", Severity.WARNING),
        ("car copy.urdf.xacro", "car copy.urdf.xacro", Severity.ERROR),
        ("bus copy.urdf.xacro", "car.urdf.xacro", Severity.ERROR),
    ],
)
def test_a_stray_copy_that_nothing_loads_is_to_be_deleted(
    tmp_path: Path, name: str, launched: str, severity: Severity
) -> None:
    """Only where the file of which it is one is beside it, and no file names the copy."""
    files = {
        "package.xml": "<package><name>car</name></package>",
        "launch/car.launch.py": f"os.path.join(get_package_share_directory('car'), 'urdf', '{launched}')",
        "urdf/car.urdf.xacro": HEAD + '<link name="b"/></robot>',
        f"urdf/{name}": f'{HEAD}<xacro:include filename="gone.xacro"/><link name="b"/></robot>',
    }
    write(tmp_path, files)
    finding = only(check(tmp_path / "urdf" / name, codes={"XAC001"}))
    assert (finding.severity, finding.blocks_check) == (severity, True)
    assert finding.fix is not None
    assert finding.fix.title.startswith("delete this file") == (severity is Severity.WARNING)


REAR = 'a="$(arg rear_xyz)" b="$(arg rear_rpy)"'


@pytest.mark.parametrize(
    ("rear", "front", "message", "edit"),
    [
        (REAR, 'a="$(arg front_xyz)" b="$(arg rear_rpy)"', "sibling", "$(arg front_rpy)"),
        (REAR, 'a="$(arg front_xyz)" b="${pi} $(arg rear_rpy) 0"', "sibling", "$(arg front_rpy)"),
        # The sibling may have been meant: the two of its part are not read together, or it is beside none of the other part.
        ('a="$(arg rear_rpy)"', 'a="$(arg front_xyz)" b="$(arg rear_rpy)"', "unused", ""),
        (REAR, 'b="$(arg rear_rpy)"', "unused", ""),
        (REAR, 'a="$(arg front_xyz)" b="$(arg rear_rpy)" c="$(arg rear_xyz)"', "unused", ""),
    ],
)
def test_an_argument_that_is_not_read_where_it_is_meant_is_not_deleted(
    tmp_path: Path, rear: str, front: str, message: str, edit: str
) -> None:
    names = ("front_xyz", "front_rpy", "rear_xyz", "rear_rpy")
    declared = "".join(f'<xacro:arg name="{name}" default="0 0 0"/>' for name in names)
    used = '<link name="$(arg front_xyz)$(arg rear_xyz)"/>'
    parts = f"<link name='a'><visual {rear}/></link><link name='b'><visual {front}/></link>"
    finding = only(xacro(tmp_path, declared + used + parts, {"XAC004"}))
    assert (finding.message_id, finding.data["name"]) == (message, "front_rpy")
    assert finding.fix is not None
    assert [e.replacement for e in finding.fix.edits] == [edit]


@pytest.mark.parametrize(("folders", "severity"), [('"urdf", "raw", ', Severity.ERROR), ('"urdf", ', Severity.WARNING)])
def test_a_model_that_is_kept_aside_is_one_that_is_started_where_a_launch_file_names_its_folder(
    tmp_path: Path, folders: str, severity: Severity
) -> None:
    """A launch file that names the model without that folder starts the copy beside it."""
    files = {
        "package.xml": "<package><name>arm</name></package>",
        "launch/arm.launch.py": f'path = os.path.join(get_package_share_directory("arm"), {folders}"arm.urdf.xacro")\n',
        "urdf/raw/arm.urdf.xacro": f'{HEAD}<link name="${{base}}"/></robot>',
    }
    (finding,) = find(tmp_path, files, "XAC001", name="urdf/raw/arm.urdf.xacro")
    assert finding.severity is severity


@pytest.mark.parametrize(("named", "severity"), [("q", Severity.WARNING), ("p", Severity.ERROR)])
def test_a_file_is_not_started_where_its_namesake_in_another_package_is(
    tmp_path: Path, named: str, severity: Severity
) -> None:
    launch = 'Node(urdf=[FindPackageShare("{}"), "urdf", "{}"])'
    files = {
        ".git/HEAD": "",
        "p/package.xml": "<package><name>p</name></package>",
        "p/launch/car.launch.py": launch.format("p", "car.urdf") + launch.format(named, "arm.urdf.xacro"),
        "p/urdf/car.urdf": '<robot name="car"><link name="a"/></robot>',
        "p/urdf/arm.urdf.xacro": HEAD + '<link name="a"/><xacro:macro name="m" params="a"/><xacro:m/></robot>',
        "q/package.xml": "<package><name>q</name></package>",
        "q/urdf/arm.urdf.xacro": HEAD + '<link name="a"/></robot>',
    }
    root = write(tmp_path, files)
    (finding,) = (f for f in check(root, codes={"XAC001"}).findings if f.code == "XAC001")
    assert finding.severity is severity
