"""yaml files as they are typed: each value with its place."""

from __future__ import annotations

from pathlib import Path

import pytest

from urdfcheck.source.package.finder import PackageFinder
from urdfcheck.source.reach import FileReach
from urdfcheck.source.ros.controllers import read_controller_config
from urdfcheck.source.ros.joint_limits import read_joint_limits
from urdfcheck.source.ros.yaml_files import find_yaml_error
from urdfcheck.source.text.xml import SourceFile
from urdfcheck.source.text.yaml.reader import MAX_CHARACTERS, parse_located_yaml
from urdfcheck.source.text.yaml.values import YamlReadError, YamlValue

TEXT = """\
# é🤖: what stands before a value does not move it
arm: &arm
  joints: [one, 'two', "three"]
  speed: 1
  gain: 2.5
  small: 1e-3
  typed: !degrees 90
  text: "7"
  off: no
other:
  <<: *arm
  speed: 3
"""


def value(text: str, *keys: str) -> YamlValue:
    found = parse_located_yaml(SourceFile(Path("a.yaml"), "a.yaml", text=text))
    for key in keys:
        assert found is not None
        found = found.get(key)
    assert found is not None
    return found


@pytest.mark.parametrize("index", [0, 1, 2])
def test_a_value_is_found_where_it_is_typed(index: int) -> None:
    item = value(TEXT, "arm", "joints").items[index]
    assert TEXT[item.span.start : item.span.end] == item.text == ("one", "two", "three")[index]
    assert item.location.subject == f"yaml[arm.joints[{index}]]"
    (edit,) = item.build_edits("four")
    assert (edit.expected, edit.replacement) == (item.text, "four")


@pytest.mark.parametrize(
    ("key", "number", "integer"),
    [
        ("speed", 1.0, True),
        ("gain", 2.5, False),
        ("small", 0.001, False),
        ("typed", None, False),
        ("text", None, False),
    ],
)
def test_plain_numbers_are_numbers(key: str, number: float | None, integer: bool) -> None:
    found = value(TEXT, "arm", key)
    assert (found.number, found.is_integer) == (number, integer)


def test_words_for_no() -> None:
    assert value(TEXT, "arm", "off").is_false
    assert not value(TEXT, "arm", "speed").is_false


def test_what_is_merged_stands_where_it_was_typed() -> None:
    assert value(TEXT, "other", "speed").text == "3"
    gain = value(TEXT, "other", "gain")
    assert (gain.location.subject, gain.span.line) == ("yaml[other.gain]", 5)


def test_what_is_spelled_with_escapes_is_not_edited() -> None:
    assert value('a: "t\\x77o"', "a").text == "two"
    assert value('a: "t\\x77o"', "a").build_edits("x") == ()


@pytest.mark.slow
@pytest.mark.parametrize(
    "text", ["a: [1", "a: &a [*a]", "a: !!python/name:os.system x", "[" * 5000, "a: " + "x" * MAX_CHARACTERS]
)
def test_the_guards_hold_here_too(text: str) -> None:
    with pytest.raises(YamlReadError):
        value(text)


def test_no_file_out_of_reach_is_read(tmp_path: Path) -> None:
    for name, text in (
        ("c.yaml", "c: {type: a/B, joints: [one]}"),
        ("l.yaml", "joint_limits: {one: {max_velocity: 1.0}}"),
        ("broken.yaml", "[1"),
    ):
        (tmp_path / name).write_text(text)
    (tmp_path / "inside").mkdir()
    for reach, read in ((None, True), (FileReach((str(tmp_path / "inside"),)), False)):
        finder = PackageFinder(tmp_path / "inside", environment={}, reach=reach)
        assert (read_controller_config(tmp_path / "c.yaml", finder) is not None) == read
        assert bool(read_joint_limits(tmp_path / "l.yaml", finder)) == read
        assert (find_yaml_error(tmp_path / "broken.yaml", finder) is not None) == read


@pytest.mark.parametrize(
    ("parameters", "joints"),
    [("ros__parameters: {joints: [NAME]}", {"one", "two"}), ("{type: a/B, joints: [NAME]}", {"two"})],
)
def test_several_blocks_for_one_node_count_where_ros_2_reads_them(
    tmp_path: Path, parameters: str, joints: set[str]
) -> None:
    """PyYAML, which ROS 1 uses, forgets all but the last."""
    inner = [parameters.replace("NAME", name) for name in ("one", "two")]
    blocks = [
        f"{'/**' if 'ros__' in text else 'robot'}:\n  {name}_controller:\n    {text}\n"
        for text, name in zip(inner, "ab", strict=True)
    ]
    (tmp_path / "c.yaml").write_text("".join(blocks))
    found = read_controller_config(tmp_path / "c.yaml", PackageFinder(tmp_path, environment={}))
    assert found is not None
    assert found.joint_names == joints


def test_a_text_that_was_read_before_is_not_parsed_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """The places are those of the file at hand; a merge, which PyYAML resolves in the nodes, makes them that file's own."""
    import yaml

    parsed: list[str] = []
    compose = yaml.compose
    monkeypatch.setattr(yaml, "compose", lambda text, **more: (parsed.append(text), compose(text, **more))[1])
    text = "first: 1\nsecond: {third: 2}  # of this test only\n"
    found = [parse_located_yaml(SourceFile(Path(name), name, text=text)) for name in ("a.yaml", "b.yaml")]
    seconds = [one.get("second") for one in found if one is not None]
    assert [second.span.file for second in seconds if second is not None] == ["a.yaml", "b.yaml"]
    assert parsed == [text]
    for _ in range(2):
        value(TEXT, "other", "joints")
    assert parsed == [text, TEXT, TEXT]
