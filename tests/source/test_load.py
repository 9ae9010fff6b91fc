"""One model's source: what was read, what became of it, and what went wrong; never an exception, whatever the bytes."""

from __future__ import annotations

import random
from pathlib import Path

import pytest
from conftest import FIXTURES

from urdfcheck.model.motion.pinocchio_model import capture_stderr
from urdfcheck.source.discover import discover_targets
from urdfcheck.source.launch.launch_file import load_launch
from urdfcheck.source.launch.python_launch_file import read_python_launch
from urdfcheck.source.load import Source, load_source
from urdfcheck.source.package.finder import PackageFinder
from urdfcheck.system.files import record_reads

XMLNS = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'


def loaded(folder: Path, name: str, content: str | bytes, **arguments: str) -> Source:
    path = folder / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return load_source(path, arguments, PackageFinder(path, environment={}))


def test_a_urdf_is_its_own_expansion(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    source = loaded(tmp_path, "a.urdf", '<robot name="r">\n  <link name="l"/>\n</robot>')
    assert source.root is not None
    assert source.root is source.main_tree
    assert (source.name, source.is_xacro, source.problems) == ("a.urdf", False, ())
    assert source.file_location.subject == "robot[r]"


def test_a_xacro_keeps_the_files_as_typed_beside_the_expansion(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "i.xacro").write_text(f"<robot {XMLNS}><link name='part'/></robot>")
    text = (
        f'<robot name="r" {XMLNS}><xacro:arg name="n" default="1"/><xacro:include filename="i.xacro"/>$(arg n)</robot>'
    )
    source = loaded(tmp_path, "a.urdf.xacro", text, n="7")
    assert source.root is not None
    assert [e.tag for e in source.root.children] == ["link"]
    assert source.root.text == "7"
    assert source.main_tree is not None
    assert [e.tag for e in source.main_tree.children] == ["xacro:arg", "xacro:include"]
    assert set(source.files) == set(source.trees) == {"a.urdf.xacro", "i.xacro"}
    assert source.arguments_read == {"n"}


@pytest.mark.parametrize(
    ("name", "body", "expanded"),
    [
        ("a.xacro", "", True),
        ("robot", "<xacro:if value='1'/>", True),
        ("robot", "<link name='${1}'/>", True),
        ("robot", "<link name='x'/>", False),
        ("a.urdf", "<link name='${1}'/>", False),  # left to be reported: who loads it does not expand it either
    ],
)
def test_what_is_expanded_depends_on_the_name_and_without_one_on_the_text(
    tmp_path: Path, name: str, body: str, expanded: bool
) -> None:
    source = loaded(tmp_path, name, f'<robot name="r" {XMLNS}>{body}</robot>')
    assert source.is_xacro is expanded
    assert source.problems == ()


@pytest.mark.parametrize(
    ("name", "content", "kind", "readable"),
    [
        ("a.urdf", "<robot>", "malformed", False),
        ("a.urdf", b"<robot name='\xff'/>", "encoding", False),
        ("a.urdf", "<!DOCTYPE robot><robot/>", "doctype", False),
        ("a.urdf", "<robot><xacro:if/></robot>", "prefix", True),
        ("a.xacro", "<robot><xacro:if/></robot>", "prefix", True),
        ("a.xacro", f"<robot {XMLNS}><xacro:no/></robot>", "expansion-failed", True),
        ("a.xacro", f"<robot {XMLNS}>$(arg no)</robot>", "argument-missing", True),
    ],
)
def test_what_is_wrong_is_one_problem_with_its_place(
    tmp_path: Path, name: str, content: str | bytes, kind: str, readable: bool
) -> None:
    source = loaded(tmp_path, name, content)
    assert [p.kind for p in source.problems] == [kind]
    assert source.find_problems(kind) == list(source.problems)
    assert source.find_problems("another kind") == []
    assert source.problems[0].location.span is not None
    assert (source.main_tree is not None) is readable
    assert source.file_location.span is not None


@pytest.mark.parametrize("name", ["missing.urdf", "missing.xacro", "folder.urdf"])
def test_a_file_that_cannot_be_opened_is_a_problem(tmp_path: Path, name: str) -> None:
    (tmp_path / "folder.urdf").mkdir()
    source = load_source(tmp_path / name, {}, PackageFinder(tmp_path, environment={}))
    assert [p.kind for p in source.problems] == ["unreadable"]
    assert (source.root, source.main_tree) == (None, None)


# -- any bytes ---------------------------------------------------------------------------------------------------------

PIECES = [
    b"${", b"}", b"$(", b")", b'"', b"'", b"<", b"/>", b"&", b"<!--", b"<![CDATA[", b"<!DOCTYPE r [", b"\0", b"\xff",
    b"\xc3\xa9", b"\xef\xbb\xbf", b"\xff\xfe", b"\r\n", b'<?xml version="1.0" encoding="utf-16"?>', b'xmlns:a="u"', b'a:b="1"',
    b"<xacro:macro/>", b'<xacro:include filename=""/>', b'<xacro:property name="${1}"/>', b'<xacro:insert_block name="b"/>',
    b'<xacro:attribute name="a" value="b"/>', b'<xacro:element xacro:name="xacro:if"/>', b'<xacro:call macro=""/>', b"xacro:",
    b"$(arg a)", b"$(eval 1)", b"$(find x)", b"${xacro.load_yaml('c')}", b"${[1].__class__}", b"params=' '", b"^|", b"**b",
    b'<arg name="a" default="$(arg a)"/>', b"command=\"xacro '\"", b"'x.urdf'", b"\\ud800.urdf'",
]  # fmt: skip


def mutated(data: bytes, chance: random.Random) -> bytes:
    """The bytes with a few of them cut, doubled, overwritten or interrupted by a piece that matters to some parser."""
    for _ in range(chance.choice([1, 1, 2, 4])):
        at, other = chance.randrange(len(data) + 1), chance.randrange(len(data) + 1)
        after_quote = data.find(b'"', at) + 1
        data = chance.choice(
            [
                data[:at] + data[at + chance.choice([1, 5, 300]) :],
                data[:at] + data[other : other + 60] + data[at:],
                data[:at] + bytes([chance.randrange(256)]) + data[at + 1 :],
                data[:at] + chance.choice(PIECES) + data[at:],
                data[:after_quote] + chance.choice(PIECES) + data[after_quote:],
            ]
        )
    return data


def assert_sound(source: Source) -> None:
    """Whatever is left of a model is located, and so is everything that is wrong with it."""
    assert source.root is not None or source.problems
    for problem in source.problems:
        assert problem.location.span is not None, problem
    for element in source.root.walk() if source.root is not None else ():
        assert element.span is not None
        for attribute in element.attributes.values():
            span = attribute.span
            assert span is not None
            assert source.files[span.file].text[span.start : span.end] == attribute.typed


@pytest.mark.slow
def test_no_bytes_make_reading_fail(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    sources = {
        "package.xml": FIXTURES / "car-3-fixed/package.xml",
        "car.urdf": FIXTURES / "car-3/urdf/car-3.urdf",
        "car.launch": FIXTURES / "car-3/launch/car.launch",
        "car.launch.xml": FIXTURES / "car-3-fixed/launch/car_3.launch.xml",
    }
    sources |= {f"urdf/{p.name}": p for p in (FIXTURES / "car-3-fixed/urdf").iterdir()}
    original = {name: path.read_bytes() for name, path in sources.items()}
    original["car.launch.py"] = (
        b"x = os.path.join(get_package_share_directory('car_3_description'), 'urdf', 'car.urdf')\n"
    )
    for folder in ("urdf", ".git"):  # packages are looked for up to here
        (tmp_path / folder).mkdir()
    for name, data in original.items():
        (tmp_path / name).write_bytes(data)
    chance = random.Random(20)
    for _ in range(200):
        name = chance.choice(sorted(original))
        path = Path(name)
        path.write_bytes(mutated(original[name], chance))
        finder = PackageFinder(path, environment={})
        if path.suffix == ".py":
            read_python_launch(path, finder)
        elif ".launch" in path.name:
            assert all(p.location.span is not None for p in load_launch(path, finder).problems)
        else:
            main = Path("urdf/car_3.urdf.xacro") if path.suffix == ".xacro" else path
            assert_sound(load_source(main, {}, finder))
        discover_targets([path], {}, packages={}, package_paths=[])
        path.write_bytes(original[name])
    discover_targets([Path()], {}, packages={}, package_paths=[])
    assert capfd.readouterr() == ("", "")


def test_a_missing_include_is_among_what_the_outcome_rests_on(tmp_path: Path) -> None:
    """Else a journal, or --watch, would keep the old verdict once the file is there."""
    with record_reads() as reads:
        loaded(tmp_path, "a.xacro", f'<robot name="r" {XMLNS}><xacro:include filename="arm.xacro"/></robot>')
    assert reads[str(tmp_path / "arm.xacro")] is None


@pytest.mark.parametrize(
    ("link", "parent"),
    [
        ("a\tx", "a x"),
        ("a\tx", "a\tx"),
        ("a\nx", "a\nx"),
        ("a\r\nx", "a\nx"),
        ("a\rx", "a\nx"),
        ("a\n&amp;&#65;x", "a&#10;&#x26;Ax"),
        ("a&#9;x", "a\tx"),
        ("a&#9;x", "a x"),
        ("a x", "a\tx"),
        ("a&#32;x", "a x"),
    ],
)
def test_a_name_has_the_tabs_and_line_breaks_that_urdfdom_reads(tmp_path: Path, link: str, parent: str) -> None:
    """urdfdom refuses a joint whose parent it does not find."""
    pinocchio = pytest.importorskip("pinocchio")
    text = (
        f'<robot name="r"><link name="{link}"/><link name="b"/><joint name="j" type="fixed">'
        f'<parent link="{parent}"/><child link="b"/></joint></robot>'
    )
    path = tmp_path / "robot.urdf"
    path.write_bytes(text.encode())
    root = load_source(path, {}, PackageFinder(path, environment={})).root
    assert root is not None
    names = [element.get("name") for element in root.find_children("link")]
    known = root.children[2].children[0].get("link") in names
    with capture_stderr():
        try:
            frames = [frame.name for frame in pinocchio.buildModelFromXML(text).frames]
        except ValueError:
            frames = []
    assert known == bool(frames)
    assert not frames or names[0] in frames


def test_for_xacro_tabs_and_line_breaks_are_blanks(tmp_path: Path) -> None:
    path = tmp_path / "robot.urdf.xacro"
    path.write_text('<robot name="r"><link name="a\tx"/></robot>')
    root = load_source(path, {}, PackageFinder(path, environment={})).root
    assert root is not None
    assert root.children[0].get("name") == "a x"
