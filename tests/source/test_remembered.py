"""What is remembered of files is that of their texts, and bounded."""

from __future__ import annotations

from pathlib import Path

import pytest

from urdfcheck.source.text import remembered
from urdfcheck.source.text.remembered import text_fact, tree_fact
from urdfcheck.source.text.xml import Element, SourceFile, parse_xml


def parse(text: str) -> Element:
    return parse_xml(SourceFile(Path("r.urdf"), "r.urdf", text))


def test_a_fact_of_a_text_is_computed_once_for_it_and_for_the_other_arguments() -> None:
    computed = []

    @text_fact
    def find(text: str, name: str) -> int:
        computed.append((text, name))
        return text.count(name)

    assert [find("a a b", "a"), find("a a b", "b"), find("a a b", "a"), find("a b", "a")] == [2, 1, 2, 1]
    assert computed == [("a a b", "a"), ("a a b", "b"), ("a b", "a")]


def test_two_facts_of_one_text_are_apart() -> None:
    count, measure = text_fact(lambda text: text.count("a")), text_fact(len)
    assert (count("banana"), measure("banana")) == (3, 6)


def test_the_texts_that_were_asked_for_last_are_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(remembered, "_kept", type(remembered._kept)())
    monkeypatch.setattr(remembered, "_characters", 0)
    monkeypatch.setattr(remembered, "_MOST_CHARACTERS", 30)
    measure = text_fact(len)
    for letter in "abcab":
        measure(letter * 10)
    measure("d" * 10)
    assert [text[0] for _, text, _ in remembered._kept] == ["a", "b", "d"]
    assert remembered._characters == 30
    measure("e" * 100)
    assert [text[0] for _, text, _ in remembered._kept] == ["e"]


def test_a_fact_of_a_tree_is_remembered_on_it() -> None:
    computed = []

    @tree_fact
    def count(tree: Element) -> int:
        computed.append(tree)
        return len(tree.children)

    one, other = parse("<robot><link/></robot>"), parse("<robot/>")
    assert [count(one), count(other), count(one)] == [1, 0, 1]
    assert computed == [one, other]
