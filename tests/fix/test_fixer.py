"""Fixes: only literal text at its span is changed, what gets worse is not made, and nothing is written before all is checked."""

from __future__ import annotations

import errno
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import threading
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import pytest
from builders import link, robot
from conftest import check, command, make_request
from hypothesis import given
from hypothesis import strategies as st
from real_robots import list_robots
from test_rules import FIXED, cases, offered

from urdfcheck.core import Applicability, Edit, Finding, Location, ModelInfo, Rule, Run, Severity, Span, UrdfcheckError
from urdfcheck.fix import fixer, patch
from urdfcheck.fix.fixer import FixResult, compute_fixes, select_disjoint
from urdfcheck.fix.patch import EditableFiles, EditableText, EditRefusedError
from urdfcheck.fix.regression import find_regression
from urdfcheck.policy import config_resolver
from urdfcheck.rules import load_rules, select_rules
from urdfcheck.run import pipeline
from urdfcheck.run.findings import get_sort_key
from urdfcheck.run.jobs import AuditSettings, Request, Unit, UnitReport
from urdfcheck.run.pipeline import IN_THIS_PROCESS, Execution
from urdfcheck.run.unit_audit import audit_unit
from urdfcheck.source.load import load_source
from urdfcheck.source.package.finder import PackageFinder
from urdfcheck.source.text.tokens import build_rename_edits
from urdfcheck.source.text.xml import SourceFile, parse_xml
from urdfcheck.system.files import overlay_files, read_regular, read_start

pytestmark = pytest.mark.slow

LEGACY, CURRENT = "http://ros.org/wiki/xacro", "http://www.ros.org/wiki/xacro"
JOINT = '<joint name="j{n}" type="{type}"><parent link="base"/><child link="l{n}"/>{inner}</joint><link name="l{n}"/>'
NOISE = JOINT.replace("{type}", "fixed").replace("{inner}", '<origin xyz="{x} 0 0"/>')
AXIS = JOINT.format(n="a", type="continuous", inner='<axis xyz="0 0 2"/>')


def tried(*paths: Path, codes: Iterable[str] = ("ALL",), unsafe: bool = False, **settings: object) -> FixResult:
    """What fixing would do, in this process and from the source alone."""
    request = make_request(*paths, codes=select_rules(codes), **{"tier": "source", **settings})
    return compute_fixes(request, IN_THIS_PROCESS, include_unsafe=unsafe)


def fix(*paths: Path, **options: object) -> FixResult:
    """Do it."""
    found = tried(*paths, **options)  # type: ignore[arg-type]
    patch.write_files(found.changes)
    return found


def make_robot_on_base(*parts: str, head: str = "") -> str:
    return head + robot(link("base"), *parts) + "\n"


def noisy(n: int = 1, x: str = "1e-17") -> str:
    """A link and its joint, whose origin has the noise of a CAD program."""
    return NOISE.format(n=n, x=x)


def written(folder: Path, text: str, name: str = "robot.urdf") -> Path:
    path = folder / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(text.encode())
    return path


def reasons(found: FixResult) -> list[str]:
    return [reason for _, reason in found.refused]


# -- every rule --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("rule", FIXED, ids=lambda rule: rule.code)
def test_the_repair_of_an_example_repairs_it(rule: Rule, tmp_path: Path) -> None:
    """The finding is gone, nothing else came, no byte outside of the edits changed, and a second run changes nothing."""
    repaired = 0
    for case in cases(rule, "Bad"):
        folder = tmp_path / str(case.number)
        for name, text in case.files:
            written(folder, text, name)
        target = folder if len(case.files) > 1 else folder / case.files[0][0]
        settings = {"tier": "full", "targets": config_resolver.find_config(folder).target}
        codes = {rule.code, *rule.hidden_by}
        before = check(target, codes=codes, **settings)
        offered = [f for f in before.findings if f.fix is not None and f.fix.edits]
        if not any(f.code == rule.code for f in offered):
            continue
        repaired += 1
        expected = by_hand(offered)
        found = fix(target, unsafe=True, codes=codes, **settings)
        assert [f for f in found.fixed if f.code == rule.code], reasons(found)
        if sorted(map(get_sort_key, found.fixed)) == sorted(map(get_sort_key, offered)) and expected is not None:
            assert {Path(path): new for path, (_, new) in found.changes.items()} == expected
        after = fix(target, unsafe=True, codes=codes, **settings)
        assert after.changes == {}
        assert serious(after.outcome) <= serious(before)
    assert repaired


def serious(run: Run) -> int:
    return sum(len(f.subjects) for f in run.active_findings if f.severity > Severity.INFO)


def by_hand(findings: Sequence[Finding]) -> dict[Path, bytes] | None:
    """The files after all edits of the findings, by slicing; None where edits overlap."""
    edits = {e for f in findings if f.fix is not None for e in f.fix.edits}
    after: dict[Path, bytes] = {}
    for name in {e.span.file for e in edits}:
        text = Path(name).read_bytes().decode()
        own = sorted((e for e in edits if e.span.file == name), key=lambda e: -e.span.start)
        if any(earlier.span.end > later.span.start for later, earlier in pairwise(own)):
            return None
        for edit in own:
            assert text[edit.span.start : edit.span.end] == edit.expected
            text = text[: edit.span.start] + edit.replacement + text[edit.span.end :]
        after[Path(name).resolve()] = text.encode()
    return after


# -- text --------------------------------------------------------------------------------------------------------------

EVERYWHERE = EditableFiles([Path("/")], [])
PIECES = st.text(st.sampled_from("ab é😀\u2028\x0c<>=\"'"), max_size=6)


@given(
    st.lists(st.tuples(PIECES, PIECES, PIECES), max_size=5),
    st.sampled_from(["utf-8", "utf-8-sig"]),
    st.sampled_from(["\n", "\r\n", "\r"]),
)
def test_bytes_outside_of_the_edits_stay(
    tmp_path_factory: pytest.TempPathFactory, parts: list[tuple[str, str, str]], encoding: str, newline: str
) -> None:
    path = tmp_path_factory.mktemp("text") / "a.urdf"
    text = newline + "".join(before + newline + old for before, old, _ in parts) + "end"
    path.write_bytes(text.encode(encoding))
    source = SourceFile.read(path, str(path))
    edits, at, wanted = [], len(newline), newline
    for before, old, new in parts:
        at += len(before + newline)
        edits.append(Edit(source.make_span(at, at + len(old)), old, f"{new}\n"))
        wanted += before + newline + new + newline
        at += len(old)
    assert EditableText(str(path), str(path), path.read_bytes(), source).apply_edits(edits) == (wanted + "end").encode(
        encoding
    )


@pytest.mark.parametrize(
    ("head", "encoding"),
    [
        ("", "utf-8"),
        ("\ufeff", "utf-8"),
        ("<!-- é 😀 -->", "utf-8"),
        ('<?xml version="1.0" encoding="iso-8859-1"?><!-- é -->', "latin-1"),
        ('<?xml version="1.0" encoding="cp1252"?><!-- €é -->', "cp1252"),
    ],
)
@pytest.mark.parametrize("newline", ["\n", "\r\n"])
def test_line_ends_marks_and_encodings_survive(tmp_path: Path, head: str, encoding: str, newline: str) -> None:
    text = make_robot_on_base(f"{newline}<!-- ü -->{newline}", noisy(), newline, head=head)
    path = tmp_path / "robot.urdf"
    path.write_bytes(text.encode(encoding))
    assert [f.code for f in fix(path).fixed] == ["JNT014"]
    assert path.read_bytes() == text.replace("1e-17", "0").encode(encoding)


def test_what_would_not_be_written_as_it_was_is_left(tmp_path: Path) -> None:
    path = tmp_path / "robot.urdf"
    path.write_bytes(make_robot_on_base(noisy()).encode("utf-16-be").join((b"\xfe\xff", b"")))
    before = path.read_bytes()
    found = fix(path, codes=["JNT014"])
    if sys.byteorder == "little":
        assert "would change more than the edit" in reasons(found)[0]
        assert path.read_bytes() == before


def test_an_escaped_value_is_not_literal(tmp_path: Path) -> None:
    """The value is a known legacy address, the text is not: `&#104;` is an h."""
    text = f'<robot name="r" xmlns:xacro="&#104;{LEGACY[1:]}"><link name="base"/></robot>'
    path = written(tmp_path, text, "robot.urdf.xacro")
    found = fix(path, codes=["XAC006"], unsafe=True)
    assert [f.code for f in found.outcome.findings] == ["XAC006"]
    assert not found.fixed
    assert path.read_text() == text


def text_of(folder: Path, content: str) -> tuple[EditableText, SourceFile]:
    path = written(folder, content)
    text = EditableText.read(str(path), EVERYWHERE, {})
    return text, text.file


def test_an_edit_is_refused_when_the_text_changed(tmp_path: Path) -> None:
    text, file = text_of(tmp_path, "<a b='1'/>")
    text.ensure_applicable(Edit(file.make_span(6, 7), "1", "2"))
    for edit in (
        Edit(file.make_span(6, 7), "3", "2"),
        Edit(file.make_span(9, 90), "", "2"),
        Edit(file.make_span(7, 8), "1", "2"),
    ):
        with pytest.raises(EditRefusedError, match="not the one"):
            text.ensure_applicable(edit)


@pytest.mark.parametrize("name", ['a" onload="b', "a'b", "a<b", "a&b"])
def test_the_name_of_a_stranger_becomes_no_markup(tmp_path: Path, name: str) -> None:
    text, file = text_of(tmp_path, "<mesh filename='A.stl'/>")
    with pytest.raises(EditRefusedError, match="quoted"):
        text.ensure_applicable(Edit(file.make_span(16, 21), "A.stl", name))


def test_what_an_encoding_lacks_is_refused(tmp_path: Path) -> None:
    text, file = text_of(tmp_path, "<?xml version='1.0' encoding='latin-1'?><a b='1'/>")
    with pytest.raises(EditRefusedError, match="cannot be written as latin-1"):
        text.ensure_applicable(Edit(file.make_span(46, 47), "1", "π"))


@pytest.mark.parametrize(
    ("text", "after"),
    [
        ("<a/>", "<b/>"),
        ("<a x='>'>\n</a >", "<b x='>'>\n</b >"),
        ("<a><a y='/'/><a><c/></a></a>", "<b><a y='/'/><a><c/></a></b>"),
        (
            "<a><!-- </a> --><![CDATA[</a>]]><?x </a>?><ab></ab></a>",
            "<b><!-- </a> --><![CDATA[</a>]]><?x </a>?><ab></ab></b>",
        ),
    ],
)
def test_an_element_is_renamed_at_both_ends(tmp_path: Path, text: str, after: str) -> None:
    content, _ = text_of(tmp_path, f"<robot>{text}</robot>")
    element = parse_xml(content.file).children[0]
    edits = build_rename_edits([element], "b", {content.name: content.file})
    assert content.apply_edits(edits) == f"<robot>{after}</robot>".encode()


# -- safe and unsafe ---------------------------------------------------------------------------------------------------

MACRO = '<xacro:macro name="part" params="n">' + NOISE.replace("{n}", "${{n}}") + "</xacro:macro>"
MACROS = f'<robot xmlns:xacro="{CURRENT}">{MACRO.format(x="1e-17")}</robot>'


def using(*calls: int, include: str = "macros.xacro") -> str:
    called = "".join(f'<xacro:part n="{n}"/>' for n in calls)
    return f'<robot name="r" xmlns:xacro="{CURRENT}"><xacro:include filename="{include}"/><link name="base"/>{called}</robot>'


def applicability(found: FixResult, code: str) -> set[Applicability]:
    return {f.fix.applicability for f in found.outcome.findings if f.code == code and f.fix is not None}


def test_a_macro_called_once_is_text_like_any_other(tmp_path: Path) -> None:
    macros = written(tmp_path, MACROS, "macros.xacro")
    assert [f.code for f in fix(written(tmp_path, using(1), "robot.urdf.xacro"), codes=["JNT014"]).fixed] == ["JNT014"]
    assert macros.read_text() == MACROS.replace("1e-17", "0")


def test_a_macro_called_twice_is_unsafe(tmp_path: Path) -> None:
    macros = written(tmp_path, MACROS, "macros.xacro")
    path = written(tmp_path, using(1, 2), "robot.urdf.xacro")
    found = fix(path, codes=["JNT014"])
    assert (found.fixed, found.unsafe_count, found.changes) == ((), 1, {})
    assert applicability(found, "JNT014") == {Applicability.UNSAFE}
    assert fix(path, codes=["JNT014"], unsafe=True).fixed
    assert macros.read_text() == MACROS.replace("1e-17", "0")


def test_a_shared_file_is_safe_where_all_models_have_the_finding(tmp_path: Path) -> None:
    macros = written(tmp_path, MACROS, "macros.xacro")
    for name in ("a", "b"):
        written(tmp_path, using(1), f"{name}.urdf.xacro")
    found = fix(tmp_path, codes=["JNT014"])
    (fixed,) = found.fixed
    assert list(fixed.variants) == ["a.urdf.xacro", "b.urdf.xacro"], "one defect of both models, by one edit"
    assert macros.read_text() == MACROS.replace("1e-17", "0")


def test_a_shared_file_is_unsafe_where_one_model_has_it_not(tmp_path: Path) -> None:
    macros = written(tmp_path, MACROS, "macros.xacro")
    written(tmp_path, using(1), "a.urdf.xacro")
    written(tmp_path, using(), "b.urdf.xacro")
    assert fix(tmp_path, codes=["JNT014"]).unsafe_count == 1
    assert macros.read_text() == MACROS


def test_a_shared_file_is_unsafe_where_one_model_calls_the_macro_twice(tmp_path: Path) -> None:
    macros = written(tmp_path, MACROS, "macros.xacro")
    written(tmp_path, using(1), "a.urdf.xacro")
    written(tmp_path, using(1, 2), "b.urdf.xacro")
    assert fix(tmp_path, codes=["JNT014"]).unsafe_count == 1
    assert macros.read_text() == MACROS


def test_numbers_that_mean_something_are_unsafe(tmp_path: Path) -> None:
    path = written(tmp_path, make_robot_on_base(AXIS))
    assert fix(path, codes=["JNT002"]).unsafe_count == 1
    assert 'xyz="0 0 2"' in path.read_text()
    fix(path, codes=["JNT002"], unsafe=True)
    assert 'xyz="0 0 1"' in path.read_text()


def test_a_suppressed_finding_is_not_fixed(tmp_path: Path) -> None:
    comment = "<!-- urdfcheck: ignore[JNT014] as exported -->"
    path = written(tmp_path, make_robot_on_base(comment, noisy()))
    assert fix(path, codes=["JNT014", "URC902"]).changes == {}


def test_a_comment_that_suppresses_nothing_goes_with_its_line(tmp_path: Path) -> None:
    comment = "\n  <!-- urdfcheck: ignore[JNT014] as exported -->\n  <!-- another -->\n"
    path = written(tmp_path, make_robot_on_base(comment, noisy(x="0")))
    assert [f.code for f in fix(path, codes=["JNT014", "URC902"]).fixed] == ["URC902"]
    assert path.read_text() == make_robot_on_base("\n  <!-- another -->\n", noisy(x="0"))


# -- nothing gets worse ------------------------------------------------------------------------------------------------

# Renaming it makes an <inertial> of it whose numbers are impossible, and both are errors of their own.
WORSE = '<link name="bad"><intertial><mass value="-1"/></intertial></link>'


def test_only_the_fix_that_makes_it_worse_is_left_out(tmp_path: Path) -> None:
    joints = "".join(
        f'<joint name="{n}" type="fixed"><parent link="base"/><child link="{n}"/></joint>' for n in ("bad", "good")
    )
    many = "".join(noisy(n) for n in range(4))
    path = written(
        tmp_path, make_robot_on_base(WORSE, joints, many, '<link name="good"><visual><geometri/></visual></link>')
    )
    found = fix(path, codes=["XML003", "JNT014", "INR002"], unsafe=True)
    text = path.read_text()
    assert "<intertial>" in text
    assert "<geometry/>" in text
    assert "1e-17" not in text
    ((finding, reason),) = found.refused
    assert finding.data["tag"] == "intertial"
    assert "it would bring INR002" in reason
    assert {f.code for f in found.outcome.findings} == {"XML003"}
    assert {f.fix.applicability for f in found.outcome.findings if f.fix} == {Applicability.DISPLAY}, (
        "no offer any more"
    )


def test_fixes_that_overlap_come_one_after_the_other(tmp_path: Path) -> None:
    path = written(tmp_path, make_robot_on_base(AXIS.replace("0 0 2", "1e-12 0 2")))
    found = fix(path, codes=["JNT002", "JNT014"], unsafe=True)
    assert [f.code for f in found.fixed] == ["JNT014", "JNT002"], "the safe one first"
    assert 'xyz="0 0 1"' in path.read_text()


def test_a_robot_that_could_not_be_read_may_get_findings(tmp_path: Path) -> None:
    """They were not known, and are not worse than no robot."""
    path = written(tmp_path, '<Robot name="r"><link name="a"><inertial><mass value="-1"/></inertial></link></Robot>')
    assert [f.code for f in fix(path, codes=["XML002", "INR002"], unsafe=True).fixed] == ["XML002"]
    assert path.read_text().startswith("<robot name")
    assert path.read_text().endswith("</robot>")


def finding(code: str, subject: str = "link[a]", hides: Sequence[str] = ()) -> Finding:
    """A finding of this rule, of model m."""
    rule = load_rules()[code]
    at, data = Location(subject, None), {"hides": list(hides)}
    return Finding(
        code=code,
        name=rule.name,
        severity=rule.severity,
        confidence=rule.confidence,
        message_id="id",
        headline="…",
        message="…",
        location=at,
        subjects=(subject,),
        data=data,
        model="m",
    )


def run_of(*findings: Finding, status: str = "checked", failures: tuple[str, ...] = ()) -> Run:
    info = ModelInfo(path="m", robot="r", args={}, links=1, joints=0, mass=None, status=status, id="m")
    return Run(
        models=(info,),
        findings=findings,
        skipped=(),
        rules={},
        versions={},
        sources={},
        unit_ids=frozenset({"m"}),
        failures=failures,
    )


def test_what_is_worse() -> None:
    one, two = finding("XML003", "link[a]"), finding("XML003", "link[b]")
    assert not find_regression(run_of(one, two), run_of(two), [one])
    assert "still be there" in find_regression(run_of(one), run_of(one), [one])
    assert "still be there" in find_regression(run_of(one, one), run_of(one, one), [one])
    assert not find_regression(run_of(one, one), run_of(one), [one])
    assert "would bring XML003" in find_regression(run_of(one), run_of(two), [one]), "one went and another came"
    assert "could not be read" in find_regression(run_of(one), run_of(status="failed"), [one])
    assert "urdfcheck fails" in find_regression(run_of(one), run_of(failures=("a crash",)), [one])
    assert not find_regression(run_of(one, status="failed"), run_of(two), [one]), "it can be read at last"
    assert not find_regression(run_of(one, status="failed"), run_of(two, status="failed"), [one]), (
        "the next of its kind"
    )
    other = finding("XML001")
    assert "would bring XML001" in find_regression(run_of(one, status="failed"), run_of(other, status="failed"), [one])
    with pytest.raises(KeyboardInterrupt):
        find_regression(run_of(one), replace(run_of(), partial=True), [one])


def test_links_that_a_fixed_error_brings_may_have_warnings_of_their_own() -> None:
    for fixed, code, is_worse in (("XAC007", "XML003", False), ("XAC007", "KIN002", True), ("XML003", "GZB001", True)):
        one, new = finding(fixed), finding(code, "link[b]")
        grown = replace(run_of(new), models=(replace(run_of().models[0], links=4, joints=3),))
        assert bool(find_regression(run_of(one), grown, [one])) == is_worse, (fixed, code)
    one, new = finding("XAC007"), finding("XML003", "link[b]")
    assert find_regression(run_of(one), run_of(new), [one]), "a robot that did not grow"


def test_what_a_finding_hid_is_not_new() -> None:
    hidden = finding("XML003", "link[b]")
    for hides in ([], ["XML003"]):
        one = finding("JNT014", hides=hides)
        assert bool(find_regression(run_of(one), run_of(hidden), [one])) == (not hides)


def test_what_a_mesh_shows_that_is_found_at_last_is_not_new(tmp_path: Path) -> None:
    """Its file is empty, which is an error of its own, and no reason to leave its name wrong."""
    text = make_robot_on_base(
        '<link name="a"><visual><geometry><mesh filename="Part.stl"/></geometry></visual></link>', AXIS
    )
    path = written(tmp_path, text)
    written(tmp_path, "", "part.STL")
    found = fix(path, codes=["PKG003", "MSH001", "JNT002"], unsafe=True, tier="full")
    assert {f.code for f in found.fixed} == {"PKG003", "JNT002"}
    assert {f.code for f in found.outcome.findings} == {"MSH001"}
    assert path.read_text() == text.replace("Part.stl", "part.STL").replace("0 0 2", "0 0 1")


def edit_at(start: int, end: int, new: str = "x", file: str = "a") -> Edit:
    return Edit(Span(file, 1, start + 1, 1, end + 1, start, end), "?" * (end - start), new)


@pytest.mark.parametrize(
    ("second", "both"),
    [
        (edit_at(10, 12), True),
        (edit_at(3, 5), True),
        (edit_at(4, 6), False),
        (edit_at(9, 11), False),
        (edit_at(0, 20), False),
        (edit_at(6, 7), False),
        (edit_at(5, 10), True),  # the same edit
        (edit_at(5, 10, "y"), False),
        (edit_at(5, 5), True),  # insertions beside it
        (edit_at(10, 10), True),
        (edit_at(7, 7), False),
        (edit_at(7, 8, file="b"), True),
    ],
)
def test_edits_of_the_same_text_are_made_one_by_one(second: Edit, both: bool) -> None:
    changes = [fixer._FixGroup((edit,), ()) for edit in (edit_at(5, 10), second)]
    assert len(select_disjoint(changes)) == 1 + both
    assert len(select_disjoint(changes[::-1])) == 1 + both


def test_insertions_in_one_place_are_made_together(tmp_path: Path) -> None:
    changes = [fixer._FixGroup((edit_at(5, 5, text),), ()) for text in "xy"]
    assert len(select_disjoint(changes)) == 2
    text, file = text_of(tmp_path, "<a></a>")
    assert text.apply_edits([Edit(file.make_span(3, 3), "", t) for t in "xy"]) == b"<a>xy</a>"


# -- which files -------------------------------------------------------------------------------------------------------


@pytest.fixture
def package(tmp_path: Path) -> Path:
    """A package beside another one whose macros it includes."""
    written(tmp_path, "<package><name>robot</name></package>", "robot/package.xml")
    written(tmp_path, "<package><name>parts</name></package>", "parts/package.xml")
    written(tmp_path, MACROS, "parts/macros.xacro")
    written(tmp_path, using(1, include="$(find parts)/macros.xacro"), "robot/urdf/robot.urdf.xacro")
    return tmp_path


def test_a_file_of_another_package_is_not_changed(package: Path) -> None:
    found = fix(package / "robot", codes=["JNT014"], unsafe=True)
    assert "outside the given paths" in reasons(found)[0]
    assert (package / "parts/macros.xacro").read_text() == MACROS


def test_a_file_of_a_given_path_or_its_repository_is(package: Path) -> None:
    assert tried(package / "robot", package / "parts", codes=["JNT014"]).fixed
    assert tried(package, codes=["JNT014"]).fixed
    subprocess.run(["git", "init", "-q", str(package)], check=True)
    assert tried(package / "robot", codes=["JNT014"]).fixed


def test_a_tree_of_packages_that_was_named_is_not_changed(package: Path) -> None:
    subprocess.run(["git", "init", "-q", str(package)], check=True)
    named = {"codes": ["JNT014"], "unsafe": True}
    found = tried(package / "robot", package_paths=(package / "parts",), **named)  # type: ignore[arg-type]
    assert "outside the given paths" in reasons(found)[0]
    assert tried(package / "robot", package_paths=(package,), **named).fixed, "the folder around it all says nothing"  # type: ignore[arg-type]


def test_an_installed_file_is_not_changed(package: Path) -> None:
    written(package, "", "local_setup.bash")
    assert "installed" in reasons(fix(package, codes=["JNT014"]))[0]


def test_links_are_followed_to_what_may_be_changed_only(package: Path) -> None:
    macros = package / "parts/macros.xacro"
    link = package / "robot/urdf/macros.xacro"
    link.symlink_to(macros)
    written(package, using(1), "robot/urdf/robot.urdf.xacro")
    allowed = {"codes": ["JNT014"], "allowed": (package,)}
    assert "outside the given paths" in reasons(fix(package / "robot", **allowed))[0]
    assert fix(package / "robot", package / "parts", codes=["JNT014"]).fixed
    assert link.is_symlink()
    assert macros.read_text() == MACROS.replace("1e-17", "0")


def test_a_link_that_was_given_leads_nowhere_else(package: Path) -> None:
    link = package / "robot/urdf/part.urdf"
    link.symlink_to(written(package, make_robot_on_base(noisy()), "parts/part.urdf"))
    with pytest.raises(EditRefusedError, match="outside"):
        EditableFiles([link], []).ensure_editable(link)


def test_a_file_with_two_names_is_not_changed(tmp_path: Path) -> None:
    path = written(tmp_path, make_robot_on_base(noisy()))
    os.link(path, tmp_path / "second")
    assert "hard links" in reasons(fix(path, codes=["JNT014"]))[0]


def test_a_read_only_file_is_not_changed(tmp_path: Path) -> None:
    path = written(tmp_path, make_robot_on_base(noisy()))
    path.chmod(0o444)
    found = fix(path, codes=["JNT014"])
    assert reasons(found) == [f"{found.refused[0][0].location.span.file}: it is read-only"]  # type: ignore[union-attr]
    assert path.read_text() == make_robot_on_base(noisy())


# -- writing -----------------------------------------------------------------------------------------------------------


def test_the_rights_of_a_file_stay(tmp_path: Path) -> None:
    path = written(tmp_path, make_robot_on_base(noisy()))
    path.chmod(0o640)
    fix(path, codes=["JNT014"])
    assert path.stat().st_mode & 0o777 == 0o640
    assert os.listdir(tmp_path) == ["robot.urdf"]


def two(folder: Path) -> dict[str, tuple[bytes, bytes]]:
    return {str(written(folder, "old", name).resolve()): (b"old", b"new") for name in ("a", "b")}


def test_nothing_is_written_over_what_somebody_else_wrote(tmp_path: Path) -> None:
    changes = two(tmp_path)
    (tmp_path / "b").write_text("other")
    with pytest.raises(UrdfcheckError, match="was changed by others while it was checked; no file was changed"):
        patch.write_files(changes)
    assert [(tmp_path / name).read_text() for name in "ab"] == ["old", "other"]
    assert sorted(os.listdir(tmp_path)) == ["a", "b"]


def test_a_full_disk_leaves_every_file_whole(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    changes = two(tmp_path)
    begun: list[int] = []

    def full(handle: int) -> None:
        begun.append(handle)
        if len(begun) == 2:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(UrdfcheckError, match=r"No space.*; no file was changed"):
        patch.write_files(changes)
    assert [(tmp_path / name).read_text() for name in sorted(os.listdir(tmp_path))] == ["old", "old"]


def test_what_fails_in_the_middle_says_what_was_changed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    changes, rename = two(tmp_path), os.replace

    def once(source: str, target: str) -> None:
        if target.endswith("b"):
            raise OSError(errno.EIO, os.strerror(errno.EIO))
        rename(source, target)

    monkeypatch.setattr(os, "replace", once)
    with pytest.raises(UrdfcheckError, match=r"these files were fixed: \S*a$"):
        patch.write_files(changes)
    assert [(tmp_path / name).read_text() for name in sorted(os.listdir(tmp_path))] == ["new", "old"]


def test_what_somebody_writes_while_it_is_checked_is_kept(tmp_path: Path) -> None:
    path = written(tmp_path, make_robot_on_base(noisy()))
    other = make_robot_on_base(noisy(), "<!-- mine -->")

    def slow(unit: Unit, settings: AuditSettings) -> UnitReport:
        if settings.options.texts:
            path.write_text(other)
        return audit_unit(unit, settings)

    found = compute_fixes(make_request(path, codes={"JNT014"}, tier="source"), Execution(audit=slow))
    with pytest.raises(UrdfcheckError, match="changed by others"):
        patch.write_files(found.changes)
    assert path.read_text() == other


def test_an_interrupt_while_writing_says_what_was_changed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It comes when all files are in their places: until then it waits."""
    changes, rename = two(tmp_path), os.replace

    def interrupted(source: str, target: str) -> None:
        signal.pthread_kill(threading.main_thread().ident, signal.SIGINT)
        rename(source, target)

    monkeypatch.setattr(os, "replace", interrupted)
    with pytest.raises(UrdfcheckError, match=r"interrupted; these files were fixed: \S*a, \S*b$"):
        patch.write_files(changes)
    assert [(tmp_path / name).read_text() for name in sorted(os.listdir(tmp_path))] == ["new", "new"]


def test_an_interrupt_while_fixing_changes_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = written(tmp_path, make_robot_on_base(noisy()))
    again = pipeline.run_audit

    def interrupted(request: Request, *words: object, **options: object) -> pipeline.AuditedRun:
        state = again(request, *words, **options)  # type: ignore[arg-type]
        return replace(state, outcome=replace(state.outcome, partial=bool(request.options.texts)))

    monkeypatch.setattr(fixer, "run_audit", interrupted)
    with pytest.raises(KeyboardInterrupt):
        fix(path, codes=["JNT014"])
    assert path.read_text() == make_robot_on_base(noisy())


# -- as if a file held another text --------------------------------------------------------------------------------------


def test_an_overlay_is_read_in_place_of_the_file(tmp_path: Path) -> None:
    path = written(tmp_path, "on the disk")
    link = tmp_path / "link"
    link.symlink_to(path)
    with overlay_files({os.path.realpath(path): b"as if"}):
        assert read_regular(path) == read_regular(link) == b"as if"
        assert read_start(path, 2) == b"as"
    assert read_regular(path) == b"on the disk"


def test_only_models_that_read_a_changed_file_are_checked_again(tmp_path: Path) -> None:
    written(tmp_path, make_robot_on_base(noisy()), "a.urdf")
    written(tmp_path, make_robot_on_base(noisy(x="0")), "b.urdf")
    checked: list[str] = []

    def counted(unit: Unit, settings: AuditSettings) -> UnitReport:
        checked.append(Path(unit.path).name)
        return audit_unit(unit, settings)

    request = make_request(tmp_path, codes={"JNT014"}, tier="source")
    compute_fixes(request, Execution(audit=counted))
    assert checked == ["a.urdf", "b.urdf", "a.urdf"]


# -- the command -------------------------------------------------------------------------------------------------------


def urdfcheck(*words: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    return command(*words, "--tier", "source", "--no-cache", cwd=cwd)


@pytest.mark.usefixtures("one_process")
def test_fix_reports_what_remains_and_stdout_stays_json(tmp_path: Path) -> None:
    path = written(tmp_path, make_robot_on_base(noisy(), AXIS))
    words = ("robot.urdf", "--select", "JNT002,JNT014", "--format", "json", "--fail-on", "warning")
    done = urdfcheck(*words, "--fix", cwd=tmp_path)
    assert [f["code"] for f in json.loads(done.stdout)["findings"]] == ["JNT002"]
    assert done.stderr == "fixed 1 (1 more with --unsafe-fixes)\n"
    assert done.returncode == 1
    done = urdfcheck(*words, "--fix", "--unsafe-fixes", cwd=tmp_path)
    assert (json.loads(done.stdout)["findings"], done.stderr, done.returncode) == ([], "fixed 1\n", 0)
    assert path.read_text() == make_robot_on_base(noisy(x="0"), AXIS.replace("2", "1"))


@pytest.mark.usefixtures("one_process")
def test_diff_changes_nothing_and_can_be_applied(tmp_path: Path) -> None:
    text = make_robot_on_base("\n", noisy(), "\n", AXIS, "\n")
    path = written(tmp_path, text)
    done = urdfcheck("robot.urdf", "--select", "JNT002,JNT014", "--diff", cwd=tmp_path)
    assert done.returncode == 1
    assert done.stderr == "would fix 1 (1 more with --unsafe-fixes)\n"
    assert path.read_text() == text
    if shutil.which("patch"):
        subprocess.run(["patch", "-p0"], input=done.stdout, text=True, cwd=tmp_path, check=True, capture_output=True)
        assert path.read_text() == text.replace("1e-17", "0")
    assert urdfcheck("robot.urdf", "--select", "JNT001", "--diff", cwd=tmp_path).returncode == 0


def test_a_diff_shows_where_the_last_newline_is_missing(tmp_path: Path) -> None:
    path = str(written(tmp_path, "old").resolve())
    lines = list(patch.iter_diff_lines(path, b"a\r\nold", b"a\r\nnew"))
    assert lines[2:] == [
        "@@ -1,2 +1,2 @@",
        " a",
        "-old",
        "\\ No newline at end of file",
        "+new",
        "\\ No newline at end of file",
    ]


@pytest.mark.parametrize(
    ("words", "says"),
    [(("--unsafe-fixes",), "needs --fix or --diff"), (("--diff", "--format", "json"), "leave out --format")],
)
def test_options_that_make_no_sense_together(tmp_path: Path, words: tuple[str, ...], says: str) -> None:
    written(tmp_path, make_robot_on_base())
    done = urdfcheck("robot.urdf", *words, cwd=tmp_path)
    assert done.returncode == 2
    assert says in done.stderr


@pytest.mark.usefixtures("one_process")
def test_what_was_not_fixed_is_said_once_for_each_reason(tmp_path: Path) -> None:
    path = written(tmp_path, make_robot_on_base(noisy(), AXIS))
    path.chmod(0o444)
    done = urdfcheck("robot.urdf", "--select", "JNT002,JNT014", "--fix", "--unsafe-fixes", cwd=tmp_path)
    assert re.findall("not fixed: .*", done.stderr) == [
        f"not fixed: robot.urdf:1:{make_robot_on_base(noisy()).index('1e-17') + 1} JNT014 and 1 more: robot.urdf: it is read-only"
    ]


@pytest.mark.usefixtures("one_process")
def test_the_report_tells_what_each_option_repairs(tmp_path: Path) -> None:
    written(tmp_path, make_robot_on_base(noisy(), AXIS))
    done = urdfcheck("robot.urdf", "--select", "JNT002,JNT014", "--verbose", cwd=tmp_path)
    assert "fix   write 0 [-v --fix]" in done.stdout  # a note on request
    assert "[--fix --unsafe-fixes]" in done.stdout
    assert "1 fixable with --fix --unsafe-fixes, 1 more with -v" in done.stdout


@pytest.mark.usefixtures("one_process")
def test_notes_on_request_are_repaired_where_they_are_listed(tmp_path: Path) -> None:
    text = '<robot name="r" xmlns:xacro="http://ros.org/wiki/xacro"><link name="base"/></robot>'
    path = tmp_path / "robot.urdf.xacro"
    for options, is_fixed in ((("--fix",), False), (("-v", "--fix"), True)):
        path.write_text(text)
        urdfcheck(path.name, *options, cwd=tmp_path)
        assert ("www.ros.org" in path.read_text()) is is_fixed


# -- real robots -------------------------------------------------------------------------------------------------------


def test_real_robots_stay_the_same_but_for_safe_edits(corpus: Path, tmp_path: Path) -> None:
    """Ten small packages: every change is safe, and the expanded robot has the same elements with the same numbers."""
    entries = [e for e in list_robots(corpus) if e["expands"] and e["package_roots"]]
    entries = [e for e in entries if Path(e["entry"]).is_relative_to(e["package_roots"][0])]
    roots = {e["package_roots"][0]: e for e in entries}
    size = {root: sum(f.stat().st_size for f in (corpus / root).rglob("*")) for root in roots}
    changed = 0
    for number, root in enumerate(sorted(roots, key=lambda root: size[root])[:10]):
        entry, copy = roots[root], tmp_path / str(number) / root  # one may lie in another
        shutil.copytree(corpus / root, copy)
        for path in copy.rglob("*"):
            path.chmod(path.stat().st_mode | 0o200)
        model = copy / Path(entry["entry"]).relative_to(root)
        options = {"arguments": entry["xacro_args"], "package_paths": [corpus / p for p in entry["package_roots"][1:]]}
        before = {p: p.read_bytes() for p in copy.rglob("*") if p.is_file()}
        values = list(expanded(model, **options))
        found = fix(model, **options)
        assert all(f.fix is not None and f.fix.applicability is Applicability.SAFE for f in found.fixed)
        assert {str(p.resolve()) for p, data in before.items() if p.read_bytes() != data} == set(found.changes)
        for (name, old), (same, new) in zip(values, expanded(model, **options), strict=True):
            assert name == same
            assert all(map(alike, old.split(), new.split())), (name, old, new)
        assert fix(model, **options).changes == {}
        changed += len(found.changes)
    assert changed, "there was nothing to fix in any of them"


def expanded(model: Path, arguments: dict[str, str], package_paths: Sequence[Path]) -> Iterator[tuple[str, str]]:
    """The attributes of the robot, namespaces aside."""
    root = load_source(model, arguments, PackageFinder(model.absolute(), {}, package_paths)).root
    assert root is not None
    for element in root.walk():
        yield element.tag, element.text
        yield from ((f"{element.subject}@{n}", a.value) for n, a in element.attributes.items() if "xmlns" not in n)


def alike(old: str, new: str) -> bool:
    """Equal but for upper and lower case, or for less than a billionth."""
    try:
        return abs(float(old) - float(new)) < 1e-9
    except ValueError:
        return old.lower() == new.lower()


def test_a_file_that_two_models_share_is_repaired_with_either(tmp_path: Path) -> None:
    """One finding for all files of a model, and one file in both models: the same edit is asked for twice."""
    old = f'xmlns:xacro="{LEGACY}"'
    (tmp_path / "package.xml").write_text("<package><name>p</name></package>")
    (tmp_path / "shared.xacro").write_text(f'<robot {old}><link name="s"/></robot>')
    for name in "ab":
        text = f'<robot name="{name}" {old}><xacro:include filename="shared.xacro"/></robot>'
        (tmp_path / f"{name}.urdf.xacro").write_text(text)
    found = fix(tmp_path, codes=["XAC006"])
    assert not found.outcome.findings
    assert not any(LEGACY in path.read_text() for path in tmp_path.glob("*.xacro"))


def test_of_one_kind_of_mistake_a_single_place_may_be_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each place is repaired for itself: the others do not wait for one that would make something worse."""
    path = tmp_path / "r.urdf"
    joints = "".join(
        f'<link name="{name}"/>\n<joint name="j_{name}" type="revolute"><parent link="base"/><child link="{name}"/>'
        f'<axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/><safety_controller '
        f'soft_lower_limit="-{size}" soft_upper_limit="0.9" k_position="20" k_velocity="10"/></joint>\n'
        for name, size in (("a", 3), ("b", 4), ("c", 5))
    )
    path.write_text(f'<robot name="r"><link name="base"/>{joints}</robot>')
    (joint,) = check(path, codes={"JNT010"}).findings
    assert len(joint.occurrences) == len(joint.fix.edits if joint.fix else ()) == 3

    def object_to_b(_previous: Run, _current: Run, fixed: Sequence[Finding]) -> str:
        return "no" if any("j_b" in finding.subjects[0] for finding in fixed) else ""

    monkeypatch.setattr(fixer, "find_regression", object_to_b)
    result = tried(path, codes={"JNT010"}, unsafe=True)
    assert sorted(finding.subjects[0][:10] for finding in result.fixed) == ["joint[j_a]", "joint[j_c]"]
    assert [finding.subjects[0][:10] for finding, _ in result.refused] == ["joint[j_b]"]
    (left,) = result.outcome.findings
    assert (left.subjects[0][:10], offered(left)) == ("joint[j_b]", Applicability.DISPLAY)
