"""XAC: what the pages cannot show: every way in which xacro fails, quiet cases, fixes, severities."""

from __future__ import annotations

from pathlib import Path

import pytest
from conftest import check, check_text

from urdfcheck.core import Applicability, Finding, Run, Severity
from urdfcheck.facts.literals import near_miss

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
        ('<xacro:weel/>', "unknown-macro", "no file defines any macro"),
        ('<xacro:macro name="wheel" params="a bore"/><xacro:wheel a="1" bor="2"/>', "parameter-unknown", "'bore'"),
        ('<xacro:macro name="wheel" params="a b:=2 c"/><xacro:wheel a="1"/>', "parameters-missing", "without c"),
        ('<xacro:macro name="wheel" params="*origin"/><xacro:wheel/>', "blocks", "Not enough blocks"),
        ('<xacro:macro name="wheel" params=""/><xacro:wheel><origin/></xacro:wheel>', "blocks", "Unused block"),
        ('<xacro:macro name="w" params="*origin"><xacro:insert_block name="orign"/></xacro:macro>'
         "<xacro:w><a/></xacro:w>",
         "undefined-block", "'origin'"),
        ('<xacro:include filename="nothing.xacro"/>', "file-missing", "nothing.xacro does not exist"),
        ("""<link name="${xacro.load_yaml('nothing.yaml')}"/>""", "file-missing", "nothing.yaml does not exist"),
        ('<xacro:if value="maybe"><link name="a"/></xacro:if>', "condition", "neither true nor false"),
        ('<xacro:include file="a.xacro"/>', "attribute-missing", "lacks its attribute filename"),
        ('<xacro:include filename="robot.urdf.xacro"/>', "endless", "include cycle"),
        ('<xacro:property name="a" value="${b}"/><xacro:property name="b" value="${a}"/><link name="${a}"/>',
         "endless", "a -> b -> a"),
        ('<xacro:macro name="m" params=""><xacro:m/></xacro:macro><xacro:m/>', "endless", "never ends"),
        ('<link name="${1 +}"/>', "syntax", "`1 +` is no expression"),
        ("""<link name="${ {'a': 1}['a'] }"/>""", "syntax", "is no expression"),
        ('<link name="${1/0}"/>', "expression-failed", "division by zero"),
        ("""<link name="${xacro.fatal('no such type')}"/>""", "refused", "no such type"),
        ('<link name="$(env ROS_DISTRO)"/>', "environment", "ROS_DISTRO is not set"),
        ('<link name="$(env HOME)"/>', "environment-unread", "HOME counts as not set"),
    ],
)  # fmt: skip
def test_each_way_to_fail_is_one_located_finding(tmp_path: Path, text: str, message: str, says: str) -> None:
    finding = only(xacro(tmp_path, text, {"XAC001"}))
    assert finding.message_id == message
    assert says in finding.message
    assert finding.location.span is not None
    assert finding.location.span.line == 3


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
    assert not xacro(tmp_path, '<xacro:property name="a" value="1"/><link name="${gap}"/>', {"XAC002"}).findings


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
    assert near_miss("3.14159265") is not None


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
    text = f'<xacro:property name="M_PI" value="3.14159"/>\n{main}'
    finding = only(xacro(tmp_path, text, {"XAC005"}))
    assert (finding.message_id, finding.severity) == ("rounded", Severity.WARNING)
    assert finding.fix is not None
    assert [e.replacement for e in finding.fix.edits] == ["${pi}"]


def test_optional_part_below_a_folder_without_package_may_read_a_property(tmp_path: Path) -> None:
    text = '<xacro:if value="${False}"><xacro:include filename="parts/wheel.xacro"/></xacro:if>'
    assert not xacro(tmp_path, f'<xacro:property name="size" value="1"/>{text}', {"XAC002"}).findings


@pytest.mark.parametrize(("value", "digits"), [("3.14159", 6), ("03.1415926e0", 8), ("3.14", 3)])
def test_digits_of_a_rounded_constant_are_counted(tmp_path: Path, value: str, digits: int) -> None:
    text = f'<xacro:property name="M_PI" value="{value}"/><link name="l_${{M_PI}}"/>'
    assert f"typed with {digits} digits" in only(xacro(tmp_path, text, {"XAC005"})).message


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
    assert "pitch -0.75 of w0 has no place there" in finding.fix.title
    assert '<xacro:w name="w0" x="0.1" y="0.2"/>' in finding.fix.title


def test_macro_derives_what_follows_from_the_side(tmp_path: Path) -> None:
    finding = only(xacro(tmp_path, corners(), {"XAC009"}))
    assert finding.fix is not None
    assert ", with yaw `${0 if y > 0 else pi}` and axis_y `${1 if y > 0 else -1}`:" in finding.fix.title
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


def test_missing_argument_is_an_error_only_where_the_file_was_named(tmp_path: Path) -> None:
    text = '<xacro:property name="p" value="$(arg side)"/>\n<link name="${p}_$(arg other)"/>'
    named = only(xacro(tmp_path, text, {"XAC010", "XAC001"}))
    assert (named.severity, named.location.subject) == (Severity.ERROR, "property[p]")
    assert named.data["missing"] == ["side", "other"]
    found = only(check(tmp_path, codes={"XAC010"}))
    assert found.severity is Severity.INFO
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
        ("${open('/etc/passwd').read()}", "outside", "open is no function"),
        ("${globals()}", "outside", "globals is no function"),
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
        ('<xacro:property name="foo" value="1"/>', "reads arguments only", "write the expression as `${…}`"),
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


def robot(name: str, mass: str, extra: str = "") -> str:
    links = "".join(f'<link name="l{i}"><inertial><mass value="{mass}"/></inertial></link>' for i in range(3))
    return f'<robot name="{name}" xmlns:xacro="http://www.ros.org/wiki/xacro">{links}{extra}</robot>'


def package(folder: Path, urdf: str, xacro_text: str, **options: float) -> Run:
    (folder / "package.xml").write_text("<package><name>p</name></package>", encoding="utf-8")
    (folder / "r.urdf").write_text(urdf, encoding="utf-8")
    (folder / "r.urdf.xacro").write_text(xacro_text, encoding="utf-8")
    return check(folder, codes={"XAC015"}, options={"XAC015": options})


def test_copies_are_compared_as_numbers(tmp_path: Path) -> None:
    assert not package(tmp_path, robot("r", "1.0"), robot("r", "${1}")).findings
    finding = only(package(tmp_path, robot("r", "1"), robot("r", "2")))
    assert finding.message_id == "diverged"
    assert finding.data["values"] == [f"link[l{i}]/inertial/mass@value" for i in range(3)]
    assert "3 values (link[l0]/inertial/mass@value: 1.0 and 2.0, " in finding.message
    assert finding.model == "r.urdf"


def test_copies_that_differ_in_name_and_extensions_only(tmp_path: Path) -> None:
    finding = only(package(tmp_path, robot("a", "1"), robot("b", "1", "<gazebo/>")))
    assert finding.message_id == "equal-bodies"
    assert "('a' and 'b')" in finding.message
    assert "0 and 1 <gazebo>" in finding.message


def test_part_that_one_copy_lacks_counts_once(tmp_path: Path) -> None:
    extra = '<link name="lamp"><visual><geometry><sphere radius="1"/></geometry></visual></link>'
    finding = only(package(tmp_path, robot("r", "1"), robot("r", "1", extra), overlap=0.7))
    assert finding.data["only_xacro"] == ["link[lamp]"]
    assert "1 part only in the xacro (link[lamp])" in finding.message


def test_another_robot_of_the_package_is_no_copy(tmp_path: Path) -> None:
    other = robot("r", "2").replace('"l1"', '"a1"').replace('"l2"', '"a2"')
    assert not package(tmp_path, robot("r", "1"), other).findings
