"""A file of xacro is parsed once for each content; what an expansion does to its document stays there."""

from __future__ import annotations

from pathlib import Path
from xml.dom import minidom

import pytest

from urdfcheck.source.package.finder import PackageFinder
from urdfcheck.source.text.xml import SourceFile
from urdfcheck.source.xacro import parsed_files
from urdfcheck.source.xacro.expand import Expansion, expand_xacro
from urdfcheck.source.xacro.parsed_files import parse_shared

ROBOT = """<?xml version="1.0"?>
<!-- before --><?hint a?>
<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro" xmlns:s="http://example.org/s" s:a="1" b="2 &amp; 3">
  <xacro:macro name="wheel" params="n *block">
    <!-- a wheel --><link name="w${n}"><xacro:insert_block name="block"/><![CDATA[<raw/>]]></link>
    <xacro:macro name="inner" params=""><joint name="j${n}" type="fixed"/></xacro:macro>
    <xacro:inner/>
  </xacro:macro>
  <xacro:wheel n="1"><a x="${1 + 1}"/></xacro:wheel>
  <xacro:wheel n="2"><a x="3"/></xacro:wheel>
  <s:sensor/>text
</robot>
<!-- after -->
"""


def expand(path: Path) -> Expansion:
    expansion = expand_xacro(path, {}, PackageFinder(path))
    assert expansion.document is not None
    return expansion


def make_source(text: str, path: Path = Path("robot.xacro")) -> SourceFile:
    return SourceFile(path, "robot.xacro", text)


def test_a_document_is_written_as_minidom_writes_it() -> None:
    assert parse_shared(make_source(ROBOT)).copy_document().toxml() == minidom.parseString(ROBOT).toxml()


def test_an_expansion_leaves_no_trace_in_the_next_one(tmp_path: Path) -> None:
    path = tmp_path / "robot.xacro"
    path.write_text(ROBOT)
    first, second = expand(path), expand(path)
    assert first.document.toxml() == second.document.toxml()
    assert first.trees == second.trees  # the same objects: it was parsed once
    links = [element for element in second.root.walk() if element.tag == "link"]
    assert [len(link.via) for link in links] == [1, 1]


def test_an_edit_is_another_content(tmp_path: Path) -> None:
    path = tmp_path / "robot.xacro"
    path.write_text(ROBOT)
    before = expand(path)
    path.write_text(ROBOT.replace('n="2"', 'n="3"'))
    after = expand(path)
    assert before.document.toxml().replace('"w2"', '"w3"').replace('"j2"', '"j3"') == after.document.toxml()
    assert not before.trees.items() & after.trees.items()


def test_the_same_text_elsewhere_has_other_places() -> None:
    here, there = make_source("<robot/>"), make_source("<robot/>", Path("there/robot.xacro"))
    assert parse_shared(here) is parse_shared(make_source("<robot/>"))
    assert parse_shared(there) is not parse_shared(here)


def test_what_is_kept_is_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(parsed_files, "_MOST_CHARACTERS", 100)
    texts = [f"<robot name='{n:20}'/>" for n in range(10)]
    for text in texts:
        parse_shared(make_source(text))
    assert [content[-1] for content in parsed_files._kept] == texts[-2:]
    parse_shared(make_source(f"<robot>{'-' * 200}</robot>"))
    assert not parsed_files._kept
