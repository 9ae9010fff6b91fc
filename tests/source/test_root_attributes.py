"""The attributes of a root element are those that the whole parser reads, and what it refuses is refused."""

from __future__ import annotations

from pathlib import Path

import pytest
from conftest import FIXTURES
from hypothesis import given
from hypothesis import strategies as st

from urdfcheck.source.text import root_attributes, xml
from urdfcheck.source.text.root_attributes import read_root_attributes
from urdfcheck.source.text.xml import SourceFile, XmlError, parse_xml

TEXTS = {
    "plain": '<robot name="r" version="1.0"><link name="l"/></robot>',
    "expression": '<robot name="${a}"/>',
    "entities": '<robot name="&lt;a&#10;b &amp; c"/>',
    "breaks": '<robot name="a\tb\nc"/>',
    "not ASCII": '<!-- \u00e4 --><robot name="r\u00f6b\U0001f916"/>',
    "lone surrogate": '<robot name="\ud800"/>',
    "prefix": '<foo:robot foo:name="r"/>',
    "instruction": '<?xml version="1.0"?><!-- c --><?a b?><robot name="r"/>',
    "late instruction": '<robot name="r"/><?a b?>',
    "root without name": "<robot><link name='l'/></robot>",
    "other root": '<sdf name="w"/>',
    "empty": "",
    "no element": "<!-- c -->",
    "cut": '<robot name="r"><link>',
    "two roots": '<robot name="r"/><robot name="s"/>',
    "repeated attribute": '<robot name="r" name="s"/>',
    "text behind": '<robot name="r"/>text',
    "zero": '<robot name="r"/>\0',
    "doctype": '<!DOCTYPE robot [<!ENTITY a "b">]><robot name="&a;"/>',
    "unknown entity": '<robot name="&a;"/>',
    "deep": '<robot name="r">' + "<a>" * 255 + "</a>" * 255 + "</robot>",
    "too deep": '<robot name="r">' + "<a>" * 256 + "</a>" * 256 + "</robot>",
    "attributes": '<robot name="r"><a ' + " ".join(f'a{i}=""' for i in range(1000)) + "/></robot>",
    "too many attributes": '<robot name="r"><a ' + " ".join(f'a{i}=""' for i in range(1001)) + "/></robot>",
    "long": f'<robot name="r"><!-- {"a" * 1024**2} --></robot>',
    "too long a value": f'<robot name="r"><a b="{"a" * (1024**2 + 1)}"/></robot>',
}


def read_both(text: str) -> tuple[dict[str, str] | str, dict[str, str] | str]:
    """What the quick and the whole parser read, or why they refuse it."""
    found: list[dict[str, str] | str] = []
    for read in (read_root_attributes, lambda file: {n: a.value for n, a in parse_xml(file).attributes.items()}):
        try:
            found.append(read(SourceFile(Path("r.urdf"), "r.urdf", text=text)))
        except XmlError as error:
            found.append(f"{error.reason} {error}")
    return found[0], found[1]


@pytest.mark.parametrize("name", TEXTS)
def test_it_reads_what_the_whole_parser_reads(name: str) -> None:
    quick, whole = read_both(TEXTS[name])
    assert quick == whole


@pytest.mark.parametrize("most", [3, 4, 5, 6])
def test_it_counts_as_the_whole_parser_does(most: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(xml, "MAX_PARTS", most)
    monkeypatch.setattr(root_attributes, "MAX_PARTS", most)
    quick, whole = read_both('<!-- c --><?a b?><robot name="r"><link/></robot>')
    assert quick == whole
    assert isinstance(whole, str) == (most < 5)


@given(st.text(alphabet="<>/!-?=\"' abx&;\0\u00e4[]", max_size=40))
def test_any_text_is_read_or_refused_alike(text: str) -> None:
    quick, whole = read_both(text)
    assert quick == whole
    quick, whole = read_both(f"<a{text}></a>")
    assert quick == whole


def test_no_elements_are_built(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(root_attributes, "parse_xml", lambda _: pytest.fail("it parses all"))
    path = FIXTURES / "car-3" / "urdf" / "car-3.urdf"
    assert read_root_attributes(SourceFile.read(path, "car-3.urdf"))["name"] == "car-3"
