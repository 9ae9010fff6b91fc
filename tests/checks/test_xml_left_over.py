"""Findings about what is left over in a file: their repair keeps what may be meant."""

from __future__ import annotations

from pathlib import Path

import pytest
from conftest import check_text

_DOCUMENT = '<?xml version="1.0"?>\n<robot name="r"><link name="a"/></robot>\n'


@pytest.mark.parametrize(
    ("text", "error", "repair"),
    [
        (
            _DOCUMENT * 2,
            "a second document begins",
            "compare both documents in the file: keep the one that is meant, and ",
        ),
        (
            f"{_DOCUMENT}<!-- of -->\n{_DOCUMENT * 2}",
            "a second document begins",
            "compare all 3 documents in the file: ",
        ),
        (f'{_DOCUMENT}<?xml version="1.0"?>\n', "there is text", "delete it"),
        (f"{_DOCUMENT}-->\n", "there is text", "delete it"),
        (
            f"{_DOCUMENT}-->\n<link name='b'/>\n</robot>",
            "there is text",
            "delete it; what follows it belongs in <robot> ",
        ),
    ],
)
def test_which_of_several_documents_is_meant_is_not_guessed(tmp_path: Path, text: str, error: str, repair: str) -> None:
    (finding,) = check_text(tmp_path, text, codes={"XML001"}).findings
    assert error in finding.message
    assert finding.fix is not None
    assert finding.fix.title.startswith(repair)
    assert (finding.fix.title == "delete it") == (repair == "delete it")


@pytest.mark.parametrize(
    ("tag", "line", "repair"),
    [
        ("<xacro:property ", 2, "delete it, or write its attributes and `/>`"),
        ("<origin", 2, "delete it, or write its attributes and `/>`"),
        ("<visual", 3, "close the tag with `>` or `/>`"),
        ('<xacro:property name="a" value="1"', 3, "close the tag with `>` or `/>`"),
        ("<xacro:wheel", 3, "close the tag with `>` or `/>`"),
        ("<limit\n<lower>0</lower></limit>", 3, "close the tag with `>` or `/>`"),  # as in SDF
        ('<limit\n<limit lower="0"></limit>', 2, "delete it, or write its attributes and `/>`"),
    ],
)
def test_a_tag_that_needs_attributes_and_has_none_is_not_closed_but_deleted(
    tmp_path: Path, tag: str, line: int, repair: str
) -> None:
    text = f'<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">\n{tag}\n<link name="a"/></robot>'
    (finding,) = check_text(tmp_path, text, "robot.urdf.xacro", codes={"XML001"}).findings
    assert finding.location.span is not None
    assert finding.location.span.line == line
    assert finding.fix is not None
    assert finding.fix.title == repair


@pytest.mark.parametrize(
    ("axes", "message", "repair"),
    [
        ('<axis xyz="0 1 0"/><axis><limit><lower>-0.1</lower></limit></axis>', "unread", "delete it; if a simulator"),
        ('<axis><limit><lower>-0.1</lower></limit></axis><axis xyz="0 1 0"/>', "repeated", "delete the first <axis>: "),
        ('<axis xyz="0 1 0"/><axis xyz="0 0 1"><limit/></axis>', "repeated", "delete the wrong <axis>"),
        ('<axis xyz="0 1 0"/><axis xzy="0 0 1"/>', "repeated", "merge them"),  # XML004 proposes the right name
        ('<axis xzy="0 1 0"/><axis xyz="0 0 1"/>', "repeated", "merge them"),
    ],
)
def test_an_element_of_which_nothing_is_read_is_not_merged(
    tmp_path: Path, axes: str, message: str, repair: str
) -> None:
    ends = f'<parent link="a"/><child link="b"/>{axes}'
    text = f'<robot name="r"><link name="a"/><link name="b"/><joint name="j" type="continuous">{ends}</joint></robot>'
    (finding,) = check_text(tmp_path, text, codes={"XML006"}).findings
    assert (finding.message_id, str(finding.severity)) == (message, "warning" if message == "unread" else "error")
    assert finding.fix is not None
    assert finding.fix.title.startswith(repair)
