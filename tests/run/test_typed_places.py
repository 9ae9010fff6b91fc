"""A number that a macro only hands on is reported where it was typed: in a yaml file, a call or a property."""

from __future__ import annotations

from pathlib import Path

import pytest
from conftest import check

from urdfcheck.core import Finding, Run

XACRO = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">{}</robot>'
MACRO = (
    '<xacro:macro name="disc" params="name m:=1 i:=^|0">\n<link name="${name}"><inertial><mass value="1"/>\n'
    '<inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="${m}"/></inertial></link></xacro:macro>\n'
)
HANDED = MACRO.replace('ixx="0.1"', 'ixx="${i.xx}"').replace('iyy="0.1"', 'iyy="${i.yy}"').replace("${m}", "${i.zz}")
LOADED = (
    '<xacro:property name="all" value="${xacro.load_yaml(\'sizes.yaml\')}"/>\n'
    '<xacro:disc name="wheel" i="${all[\'wheel\']}"/>'
)
SIZES = "other: 1\nwheel:\n  xx: 0.1\n  yy: 0.1\n  zz: 0.9\n"


def find(folder: Path, body: str, sizes: str = "") -> Run:
    (folder / "r.urdf.xacro").write_text(XACRO.format(body))
    (folder / "sizes.yaml").write_text(sizes)
    return check(folder / "r.urdf.xacro", codes={"INR003", "INR010", "URC902"}, tier="source", root=folder)


def get_place(finding: Finding, folder: Path) -> tuple[str, str]:
    """Name of the file, and the text at the place of a finding."""
    span = finding.location.span
    assert span is not None
    return Path(span.file).name, (folder / Path(span.file).name).read_text()[span.start : span.end]


def test_an_argument_of_the_call(tmp_path: Path) -> None:
    # As an attribute the number is the place; the others of the inertia are typed in the macro, which stays to blame.
    (found,) = find(tmp_path, MACRO + '<xacro:disc name="wheel" m="9"/>').findings
    assert get_place(found, tmp_path)[1].startswith("<inertia")
    zeros = MACRO.replace('"0.1"', '"${m}"').replace('izz="${m}"', 'izz="${n}"').replace("m:=1", "m n")
    (found,) = find(tmp_path, zeros + '<xacro:disc name="wheel" m="0.1" n="9"/>').findings
    assert get_place(found, tmp_path) == ("r.urdf.xacro", '0.1" n="9')
    assert found.location.subject == "link[wheel]/inertial/inertia"
    assert found.location.via[-1].line == 3


def test_a_block_of_yaml(tmp_path: Path) -> None:
    run = find(tmp_path, HANDED + LOADED, SIZES)
    (found,) = run.findings
    assert get_place(found, tmp_path) == ("sizes.yaml", "0.1\n  yy: 0.1\n  zz: 0.9")
    assert Path(found.location.via[-1].file).name == "r.urdf.xacro"
    assert found.location.span not in [place.span for place in found.related]
    assert any(Path(file).name == "sizes.yaml" for file in run.sources)


def test_values_that_are_not_beside_each_other_are_told_at_the_first(tmp_path: Path) -> None:
    sizes = SIZES.replace("  yy", "  # the wheel is round\n\n  yy")
    (found,) = find(tmp_path, HANDED + LOADED, sizes).findings
    assert get_place(found, tmp_path) == ("sizes.yaml", "0.1")


@pytest.mark.parametrize(
    "line", ['<inertia ixx="${i.xx}"', "  xx: 0.1", '<xacro:disc name="wheel" i'], ids=["macro", "yaml", "call"]
)
def test_a_comment_suppresses_at_the_macro_and_where_the_number_is(tmp_path: Path, line: str) -> None:
    text, hint = "urdfcheck: ignore[INR003] measured", line.strip()[0] == "<"
    comment = f"<!-- {text} -->\n" if hint else f"  # {text}\n"
    body, sizes = ((HANDED + LOADED).replace(line, comment + line), SIZES.replace(line, comment + line))
    (found,) = find(tmp_path, body, sizes).findings
    assert (found.code, found.suppressed is not None) == ("INR003", True)


def test_links_of_one_number_are_one_finding_and_of_other_numbers_other_places(tmp_path: Path) -> None:
    call, last = '<xacro:disc name="{}" i="${{all[\'{}\']}}"/>', LOADED.splitlines()[0]
    calls = "".join(call.format(name, key) for name, key in (("a", "wheel"), ("b", "wheel"), ("c", "lidar")))
    joints = "".join(
        f'<joint name="{n}" type="fixed"><parent link="o"/><child link="{n}"/></joint>' for n in ("a", "b", "c")
    )
    sizes = SIZES + "lidar:\n  xx: 0.1\n  yy: 0.1\n  zz: 0.8\n"
    (found,) = find(tmp_path, f'{HANDED}{last}<link name="o"/>{calls}{joints}', sizes).findings
    assert [len(own.subjects) for own in found.occurrences] == [2, 1]
    assert [own.location.span.line for own in found.occurrences if own.location.span] == [3, 7]


@pytest.mark.parametrize(
    ("macro", "call"),
    [
        (MACRO, '<xacro:disc name="wheel" m="${3 * 3}"/>'),
        (MACRO.replace("m:=1", "m:=9"), '<xacro:disc name="wheel"/>'),
        (MACRO.replace("${m}", "${9 * m}"), '<xacro:disc name="wheel" m="1"/>'),
        (MACRO.replace("${m}", "9"), '<xacro:disc name="wheel"/>'),
    ],
    ids=["computed in the call", "default of the macro", "computed in the macro", "typed in the macro"],
)
def test_what_is_not_typed_elsewhere_stays_in_the_macro(tmp_path: Path, macro: str, call: str) -> None:
    (found,) = find(tmp_path, macro + call).findings
    assert get_place(found, tmp_path)[1].startswith("<inertia")


def test_a_name_of_a_call_but_not_the_element_that_has_it(tmp_path: Path) -> None:
    body = (
        '<xacro:macro name="arm" params="name parent"><link name="${name}"/><joint name="${name}_hinge" type="fixed">'
        '<parent link="${parent}"/><child link="${name}"/></joint></xacro:macro>\n<link name="base"/>\n'
        '<xacro:arm name="lever" parent="bse"/>'
    )
    (tmp_path / "r.urdf.xacro").write_text(XACRO.format(body))
    found = check(tmp_path / "r.urdf.xacro", codes={"KIN002", "INR001"}, tier="source", root=tmp_path).findings
    places = {finding.code: get_place(finding, tmp_path)[1] for finding in found}
    assert places["KIN002"] == "bse"
    assert "INR001" not in places or places["INR001"].startswith("<link")


WIDE = (
    '<xacro:macro name="disc" params="name m:=1">\n<link name="${name}"><inertial><mass value="1"/>\n'
    '<inertia ixx="${0.1 * m}" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link></xacro:macro>\n'
)
PAIR = (
    '<xacro:macro name="pair" params="side m:=1">\n<xacro:disc name="${side}_a" m="${m}"/>\n'
    '<xacro:disc name="${side}_b"/>\n</xacro:macro>\n'
)


@pytest.mark.parametrize(
    ("calls", "place"),
    [
        ('<xacro:disc name="good"/>\n<xacro:disc name="bad" m="9"/>', '<xacro:disc name="bad" m="9"/>'),
        ('<xacro:pair side="l"/>\n<xacro:pair side="r" m="9"/>', '<xacro:pair side="r" m="9"/>'),
        ('<xacro:pair side="l" m="9"/>\n<xacro:pair side="r" m="9"/>', '<xacro:disc name="${side}_a" m="${m}"/>'),
        ('<xacro:disc name="bad" m="9"/>', '<inertia ixx="${0.1 * m}" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/>'),
    ],
    ids=["of two calls", "of the calls around them", "in a macro that is called twice", "the only call"],
)
def test_the_call_of_a_macro_that_is_right_for_others(tmp_path: Path, calls: str, place: str) -> None:
    found = find(tmp_path, WIDE + PAIR + calls).findings
    assert {get_place(own, tmp_path)[1] for own in found} == {place}
    assert all(own.location.via for own in found)
    assert place.startswith("<inertia") or all(own.location.via[-1].line == 3 for own in found)


@pytest.mark.parametrize(
    ("typed", "place"), [("${w}", '<origin xyz="${w} 0 0"/>'), ("${x}", '<xacro:part name="bad" drawn="1"/>')]
)
def test_a_line_without_a_parameter_stays_to_blame(tmp_path: Path, typed: str, place: str) -> None:
    """What a property gives is the same in each call."""
    shape = '<geometry><box size="0.1 0.1 0.1"/></geometry>'
    body = (
        '<xacro:property name="w" value="0.3"/><xacro:macro name="part" params="name drawn:=0 x:=0.3"><link name="${name}">'
        f'<collision><origin xyz="{typed} 0 0"/>{shape}</collision>'
        f'<xacro:if value="${{drawn}}"><visual>{shape}</visual></xacro:if></link></xacro:macro>'
        '<xacro:part name="good"/><xacro:part name="bad" drawn="1"/>'
    )
    (tmp_path / "r.urdf.xacro").write_text(XACRO.format(body))
    (found,) = check(tmp_path / "r.urdf.xacro", codes={"GEO005"}, tier="source", root=tmp_path).findings
    assert get_place(found, tmp_path)[1] == place


def test_elements_of_a_call_stay_findings_of_their_own(tmp_path: Path) -> None:
    second = WIDE.partition("\n")[2].replace('"${name}"', '"${name}_2"').replace("0.1 * m", "0.2 * m")
    two = WIDE.replace("</xacro:macro>", second)
    calls = '<xacro:disc name="good"/>\n<xacro:disc name="bad" m="${3 * 3}"/>'
    (found,) = find(tmp_path, two + calls).findings
    assert [own.subjects for own in found.list_occurrences()] == [
        (f"link[{name}]/inertial/inertia",) for name in ("bad_2", "bad")
    ]


@pytest.mark.parametrize("line", ["<inertia ixx", '<xacro:disc name="bad"'], ids=["macro", "call"])
def test_a_comment_suppresses_at_the_line_and_at_its_call(tmp_path: Path, line: str) -> None:
    body = WIDE + '<xacro:disc name="good"/>\n<xacro:disc name="bad" m="9"/>'
    comment = "<!-- urdfcheck: ignore[INR003] measured -->\n"
    (found,) = find(tmp_path, body.replace(line, comment + line)).findings
    assert (found.code, found.suppressed is not None) == ("INR003", True)
    (plain,) = find(tmp_path, body).findings
    assert plain.fingerprints == found.fingerprints
