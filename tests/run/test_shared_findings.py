"""One defect is one finding: of all elements that a macro line makes, and of all models that a text is part of."""

from __future__ import annotations

import json
import re
from pathlib import Path
from xml.etree import ElementTree

import pytest
from builders import joint, link, robot
from conftest import check
from output.runs import finding, span_of
from real_robots import find_lost_defects, list_defects, record_reported

from urdfcheck.cli import FINDINGS, OK, main
from urdfcheck.core import Location, Run, Severity
from urdfcheck.output import github, gitlab, html, junit, markdown, rdjson, sarif, text
from urdfcheck.output.json import render as render_json
from urdfcheck.policy.baseline import collect_entries
from urdfcheck.policy.config_resolver import ConfigResolver
from urdfcheck.rules import load_rules
from urdfcheck.run.shared_findings import count_more_notes, is_computed, merge_unrequested

XACRO = '<robot name="{}" xmlns:xacro="http://www.ros.org/wiki/xacro">{}</robot>'
# The formula of izz is wrong for any mass and radius; then the number is handed on from the call.
FORMULA = (
    '<xacro:macro name="disc" params="name m"><link name="${name}"><inertial><mass value="${m}"/>'
    '<inertia ixx="${m * 0.1}" ixy="0" ixz="0" iyy="${m * 0.1}" iyz="0" izz="${m * 0.9}"/></inertial></link></xacro:macro>'
)
PASSED = FORMULA.replace("${m * 0.1}", "0.1").replace("${m * 0.9}", "${m}")
JOINT = '<joint name="j_{0}" type="fixed"><parent link="base"/><child link="{0}"/></joint>'
DISCS = '<link name="base"/><xacro:disc name="wheel" m="1"/><xacro:disc name="lidar" m="2"/>' + (
    JOINT.format("wheel") + JOINT.format("lidar")
)


def write_robots(folder: Path, macros: str, **bodies: str) -> Path:
    """A folder of models that include one file of macros."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "macros.xacro").write_text(XACRO.format("m", macros))
    for name, body in bodies.items():
        body = f'<xacro:include filename="macros.xacro"/>{body}'
        (folder / f"{name}.urdf.xacro").write_text(XACRO.format(name, body))
    return folder


def disc(name: str = "wheel", m: str = "1") -> str:
    return f'<xacro:disc name="{name}" m="{m}"/>'


def find(folder: Path, *codes: str, **settings: object) -> Run:
    return check(folder, codes=set(codes or {"INR003"}), tier="source", **settings)


@pytest.mark.parametrize(
    ("typed", "expected"),
    [
        ("1.5", False),
        ("${mass}", False),
        ("package://arm/${name}-part/$(arg type)", False),
        ("${I.xx}", False),
        ("${sizes['a-b']}", False),
        ("${2 * mass}", True),
        ("${sqrt(mass)}", True),
        ("$(eval mass / 2)", True),
    ],
)
def test_a_text_that_computes(typed: str, expected: bool) -> None:
    assert is_computed(typed) == expected


class TestMacroLines:
    def test_a_line_that_makes_only_wrong_elements_is_one_finding(self, tmp_path: Path) -> None:
        (found,) = find(write_robots(tmp_path, FORMULA, a=DISCS)).findings
        assert [s.split("/")[0] for s in found.subjects] == ["link[wheel]", "link[lidar]"]
        assert [place.span.start for place in found.related if place.subject == "call" and place.span]
        assert found.fix is not None
        assert found.fix.title.startswith(
            "correct what this line computes: it makes 2 elements (for the first of them: "
        )

    def test_each_element_keeps_the_fingerprint_of_its_own_words(self, tmp_path: Path) -> None:
        """A check says more of a link that a fixed joint merges into a sound body."""
        base = (
            '<link name="base"><inertial><mass value="99"/><inertia ixx="9" ixy="0" ixz="0" iyy="9" iyz="0" izz="9"/>'
        )
        loose = DISCS.replace('name="j_wheel" type="fixed"', 'name="j_wheel" type="continuous"')
        body = loose.replace('<link name="base"/>', f"{base}</inertial></link>")
        (found,) = find(write_robots(tmp_path, FORMULA, a=body)).findings
        assert (found.message_id, dict(found.message_ids)) == ("violated", {"link[lidar]/inertial/inertia": "fused"})
        alone = find(write_robots(tmp_path, FORMULA, a=body.replace(disc(), '<link name="wheel"/>'))).findings[0]
        assert (alone.message_id, alone.fingerprints) == ("fused", found.fingerprints[1:])

    def test_numbers_that_calls_hand_over_are_two_places(self, tmp_path: Path) -> None:
        (found,) = find(write_robots(tmp_path, PASSED, a=DISCS)).findings
        assert [own.subjects[0].split("/")[0] for own in found.occurrences] == ["link[lidar]", "link[wheel]"]

    def test_a_line_that_makes_sound_elements_too_is_not_to_blame(self, tmp_path: Path) -> None:
        """Of three discs one is sound: the calls of the others are told."""
        macros = FORMULA.replace("${m * 0.9}", "${m * 0.9 if m > 0.5 else m * 0.1}")
        run = find(write_robots(tmp_path, macros, a=DISCS + disc("small", "0.1") + JOINT.format("small")))
        assert [len(found.occurrences) for found in run.findings] == [2]


# Two fingers on each side, whose inertia no body can have.
HAND = '<link name="palm"/>' + "".join(
    f'''<link name="{side}_{i}"><inertial><origin xyz="0 0 {i}"/><mass value="1"/>
    <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="{izz}"/></inertial></link>
    <joint name="j_{side}_{i}" type="revolute"><parent link="palm"/><child link="{side}_{i}"/>
    <limit lower="3" upper="-{i}" effort="1" velocity="1"/></joint>'''
    for side, i, izz in (("left", 1, "0.5"), ("left", 2, "0.9"), ("right", 1, "0.6"), ("right", 2, "0.8"))
)


LOAD = "${xacro.load_yaml('sizes.yaml')['%s']}"


class TestKinds:
    def test_all_fingers_are_one_finding_with_their_own_numbers(self, tmp_path: Path) -> None:
        (found,) = find(write_robots(tmp_path, "", hand=HAND)).findings
        assert found.headline == "left_2, left_1 and 2 more: inertia breaks the triangle inequality"
        assert [own.headline for own in found.occurrences][:2] == [
            "left_2: inertia breaks the triangle inequality (by 77.8 %)",
            "left_1: inertia breaks the triangle inequality (by 60 %)",
        ]
        assert [own.location.span for own in found.occurrences][1:] == [
            place.span for place in found.related if place.subject.startswith("link")
        ]

    def test_long_names_are_counted_in_the_headline(self, tmp_path: Path) -> None:
        hand = HAND.replace("left_", "the_very_long_name_of_a_link_on_the_left_side_of_the_robot_").replace(
            "right_", "r"
        )
        (found,) = find(write_robots(tmp_path, "", hand=hand)).findings
        assert found.headline == "4 links: inertia breaks the triangle inequality"

    def test_copies_with_long_names_are_counted_and_the_claim_stays(self, tmp_path: Path) -> None:
        long = "the_very_long_name_of_a_link_on_the_{}_side_of_the_robot"
        same = "".join(
            f'<link name="{long.format(side)}"><inertial><mass value="1"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1"'
            f' iyz="0" izz="0.5"/></inertial></link><joint name="j_{side}" type="continuous"><parent link="palm"/>'
            f'<child link="{long.format(side)}"/></joint>'
            for side in ("left", "right")
        )
        (found,) = find(write_robots(tmp_path, "", hand=f'<link name="palm"/>{same}')).findings
        assert found.headline == "2 links: inertia breaks the triangle inequality (by 60 %)"

    def test_a_headline_about_numbers_is_that_of_the_first(self, tmp_path: Path) -> None:
        (found,) = find(write_robots(tmp_path, "", hand=HAND), "JNT005").findings
        assert found.headline == "j_left_1: lower 3 is above upper -1 rad (+3 more)"
        assert found.fix is not None
        titles = [own.fix.title for own in found.occurrences if own.fix is not None]
        assert len(set(titles)) > 1
        assert found.fix.title == f"{titles[0]}; each of the others has its own repair"
        shown = text.render(find(write_robots(tmp_path, "", hand=HAND), "JNT005"), width=200)
        assert all(f"→ {title}" in shown for title in titles[1:] if title != titles[0])

    def test_the_brief_report_names_its_places_however_long_the_path(self, tmp_path: Path) -> None:
        run = find(write_robots(tmp_path, "", hand=HAND))
        for width in (60, 200):
            brief = text.render(run, detail=text.DetailLevel.BRIEF, width=width)
            assert len(re.findall(r"also\s+:\d+, :\d+(, :\d+| and 1 more)", brief)) == 1

    def test_other_causes_and_other_repairs_stay_apart(self, tmp_path: Path) -> None:
        """Of one only the zeros are missing: this can be written, the other must be computed again."""
        bodies = HAND.replace('<limit lower="3" upper="-1"', '<limit lower="0" upper="0"')
        assert {f.message_id for f in find(write_robots(tmp_path, "", hand=bodies), "JNT005").findings} == {
            "inverted",
            "equal",
        }

    def test_one_finger_may_be_known(self, tmp_path: Path) -> None:
        comment = "<!-- urdfcheck: ignore[INR003] measured -->"
        body = HAND.replace('<link name="left_2">', f'{comment}<link name="left_2">')
        known, told = sorted(find(write_robots(tmp_path, "", hand=body)).findings, key=lambda f: len(f.subjects))
        assert (known.subjects, known.suppressed is not None) == (("link[left_2]/inertial/inertia",), True)
        assert (len(told.subjects), told.suppressed) == (3, None)

    def test_each_keeps_its_fingerprint(self, tmp_path: Path) -> None:
        (found,) = find(write_robots(tmp_path, "", hand=HAND)).findings
        alone = {own.subjects: own.fingerprints for own in found.occurrences}
        assert found.fingerprints == tuple(f"{fingerprint[0]}" for fingerprint in alone.values())
        assert set(collect_entries([found])["hand.urdf.xacro"].values()) == {1}


class TestNoDefectIsLost:
    """Everything that a check reports is in a finding, or yields to a stronger rule on the same element."""

    @pytest.mark.parametrize(
        ("macros", "bodies"),
        [
            ("", {"hand": HAND}),
            (FORMULA, {"a": DISCS}),
            (PASSED, {"a": DISCS, "b": disc(), "c": disc("other", "7")}),
            (FORMULA, {"a": disc(), "b": DISCS}),
            (PASSED, {name: disc(name, LOAD % key) for name, key in (("a", "x"), ("b", "x"), ("c", "y"))}),
            ("", {"hand": HAND, "again": HAND}),
        ],
        ids=["hand", "formula", "calls", "shared formula", "yaml", "two files"],
    )
    def test_of_made_robots(self, macros: str, bodies: dict[str, str], tmp_path: Path) -> None:
        folder = write_robots(tmp_path, macros, **bodies)
        (folder / "sizes.yaml").write_text("x: 1\ny: 2\n")
        with record_reported() as reported:
            run = check(folder, tier="source")
        assert len(reported) > len(run.findings)
        assert find_lost_defects(reported, run) == set()
        assert {defect[:3] for defect in list_defects(run.findings) if not defect[0].startswith("URC")} <= {
            defect[:3] for defect in reported
        } | {defect[:3] for defect in list_defects(run.findings) if load_rules()[defect[0]].scopes == ("run",)}


class TestModels:
    def test_a_wrong_macro_line_is_one_finding_of_all_models(self, tmp_path: Path) -> None:
        run = find(write_robots(tmp_path, FORMULA, b=disc(m="1"), a=disc(), c=disc("other", "7")))
        (found,) = run.findings
        assert (found.model, list(found.variants)) == (
            "a.urdf.xacro",
            ["a.urdf.xacro", "b.urdf.xacro", "c.urdf.xacro"],
        )
        assert found.variants["c.urdf.xacro"] == ("link[other]/inertial/inertia",)
        assert run.find_variant_arguments(found) == {}

    def test_a_number_typed_in_the_macro_is_one_finding(self, tmp_path: Path) -> None:
        macros = PASSED.replace('izz="${m}"', 'izz="9"')
        (found,) = find(write_robots(tmp_path, macros, a=disc("l"), b=disc("r", "5"))).findings
        assert [subjects[0] for subjects in found.variants.values()] == [
            "link[l]/inertial/inertia",
            "link[r]/inertial/inertia",
        ]

    def test_calls_that_are_wrong_in_two_models_are_two_findings(self, tmp_path: Path) -> None:
        """The line is right for a small disc in the same model: the numbers of the calls are to blame."""
        macros = FORMULA.replace("${m * 0.9}", "${m * 0.9 if m > 0.5 else m * 0.1}")
        body = disc() + disc("small", "0.1") + JOINT.format("small").replace("base", "wheel")
        found = find(write_robots(tmp_path, macros, a=body, b=body)).findings
        assert [(own.model, Path(own.location.file).name) for own in found] == [
            (f"{name}.urdf.xacro",) * 2 for name in "ab"
        ]

    def test_what_each_model_types_itself_is_an_occurrence_in_each(self, tmp_path: Path) -> None:
        """The macro hands the number on: both calls are to be repaired."""
        (found,) = find(write_robots(tmp_path, PASSED, a=disc(), b=disc("other", "2"))).findings
        assert [own.subjects for own in found.occurrences] == [
            ("link[other]/inertial/inertia",),
            ("link[wheel]/inertial/inertia",),
        ]
        assert (found.subjects, found.variants["b.urdf.xacro"]) == (
            found.occurrences[0].subjects,
            found.occurrences[0].subjects,
        )
        assert "also  a.urdf.xacro:1 wheel: inertia breaks the triangle inequality" in text.render(
            find(tmp_path), width=200
        )

    def test_a_number_of_one_yaml_is_one_finding(self, tmp_path: Path) -> None:
        bodies = {name: disc(name, LOAD % key) for name, key in (("a", "x"), ("b", "x"), ("c", "y"))}
        folder = write_robots(tmp_path, PASSED, **bodies)
        (folder / "sizes.yaml").write_text("x: 1\ny: 2\n")
        (joint,) = find(folder).findings
        assert [list(f.subjects_by_model) for f in joint.occurrences] == [
            ["c.urdf.xacro"],
            ["a.urdf.xacro", "b.urdf.xacro"],
        ]

    def test_a_missing_file_is_one_finding(self, tmp_path: Path) -> None:
        macros = (
            '<xacro:macro name="part" params="file"><link name="l"><visual><geometry><mesh filename="${file}"/>'
            "</geometry></visual></link></xacro:macro>"
        )
        part = '<xacro:part file="file://$(dirname)/{}.stl"/>'
        folder = write_robots(tmp_path, macros, a=part.format("x"), b=part.format("x"), c=part.format("y"))
        (joint,) = find(folder, "PKG002").findings
        assert [list(f.subjects_by_model) for f in joint.occurrences] == [
            ["a.urdf.xacro", "b.urdf.xacro"],
            ["c.urdf.xacro"],
        ]

    def test_launch_files_that_say_the_same_of_one_file_are_one_finding(self, tmp_path: Path) -> None:
        (tmp_path / "package.xml").write_text('<package format="2"><name>car</name><version>1.0.0</version></package>')
        (tmp_path / "launch").mkdir()
        for name in "abc":
            line = '<param name="robot_description" textfile="$(find car)/urdf/never.urdf"/>'
            (tmp_path / f"launch/{name}.launch").write_text(f"<launch>{line}</launch>")
        (found,) = find(tmp_path, "LCH001").findings
        assert len(found.variants) == 3
        assert len({place.span.file for place in found.related if place.span}) == 2

    @pytest.mark.parametrize(("other", "count"), [("b/r.urdf", 1), ("b/s.urdf", 2)])
    def test_copies_of_a_model_share_their_findings_and_are_repaired_together(
        self, tmp_path: Path, other: str, count: int
    ) -> None:
        text = robot(link("base"), link("wheel"), joint("j", "bsae", "wheel"))
        paths = [tmp_path / "a/r.urdf", tmp_path / other]
        for path in paths:
            path.parent.mkdir()
            path.write_text(text)
        found = find(tmp_path, "KIN002").findings
        assert len(found) == count
        assert {model for f in found for model in f.subjects_by_model} == {"a/r.urdf", other}
        main([str(tmp_path), "--select", "KIN002", "--fix", "--unsafe-fixes"])
        assert all("bsae" not in path.read_text() for path in paths)

    def test_copies_that_differ_have_findings_of_their_own(self, tmp_path: Path) -> None:
        for folder, mass in (("a", "-1"), ("b", "-1.0")):
            (tmp_path / folder).mkdir()
            (tmp_path / folder / "r.urdf").write_text(robot(link("l", f'<inertial><mass value="{mass}"/></inertial>')))
        assert len(find(tmp_path, "INR002").findings) == 2

    def test_what_a_configuration_judges_otherwise_stays_apart(self, tmp_path: Path) -> None:
        folder = write_robots(tmp_path, FORMULA, a=disc(), c=disc())
        (folder / "second").mkdir()
        (folder / "second/b.urdf.xacro").write_text(
            (folder / "a.urdf.xacro").read_text().replace("macros", "../macros")
        )
        (folder / "second/urdfcheck.toml").write_text('fail-on = "never"\n')
        run = find(folder, config_resolver=ConfigResolver())
        found = [f for f in run.findings if f.code == "INR003"]
        models = [[Path(model).name for model in f.subjects_by_model] for f in found]
        assert dict(zip([run.fail_on.get(f.model) for f in found], models, strict=True)) == {
            "error": ["a.urdf.xacro", "c.urdf.xacro"],
            "never": ["b.urdf.xacro"],
        }

    def test_a_finding_that_only_one_has_is_its_own(self, tmp_path: Path) -> None:
        folder = write_robots(tmp_path, FORMULA, a=disc(), b='<link name="l"/>')
        (found,) = find(folder).findings
        assert (found.model, found.variants) == ("a.urdf.xacro", {})


class TestOutputs:
    @pytest.fixture
    def run(self, tmp_path: Path) -> Run:
        names = {name: disc() for name in ("fer", "fp3", "fr3", "duo")}
        return find(write_robots(tmp_path, FORMULA, **names))

    def test_every_format_names_the_models(self, run: Run) -> None:
        assert "\n  in    duo, fer, fp3 and 1 more\n" in text.render(run)
        assert "duo, fer, fp3 and 1 more" in markdown.render(run)
        assert "In duo, fer, fp3 and 1 more." in html.render(run)
        for other in (github, gitlab, rdjson, junit):
            assert "duo, fer, fp3 and 1 more" in other.render(run)
        (result,) = json.loads(sarif.render(run))["runs"][0]["results"]
        assert "In duo, fer, fp3 and 1 more." in result["message"]["text"]
        assert len(result["properties"]["models"]) == 4

    def test_json_has_the_fingerprints_of_each_model(self, run: Run, tmp_path: Path) -> None:
        """They are those that a run of this model alone has."""
        (found,) = json.loads(render_json(run))["findings"]
        alone = find(tmp_path / "fr3.urdf.xacro", root=tmp_path).findings[0]
        by_id = {model["id"]: model["fingerprints"] for model in found["models"]}
        assert by_id["fr3.urdf.xacro"] == list(alone.fingerprints)
        assert by_id[found["model"]] == found["fingerprints"]
        assert found["variants"] == list(by_id)

    def test_each_model_fails_in_junit_and_is_refused_in_json(self, run: Run) -> None:
        suites = ElementTree.fromstring(junit.render(run)).iter("testsuite")
        assert {suite.get("name"): suite.get("failures") for suite in suites if "xacro" in str(suite.get("name"))} == {
            f"{name}.urdf.xacro": "1" for name in ("duo", "fer", "fp3", "fr3")
        }
        outcomes = json.loads(render_json(run))["consumers"]
        assert {outcome["gazebo"]["verdict"] for outcome in outcomes.values()} == {"refuses"}

    def test_no_model_of_the_page_looks_clean(self, run: Run) -> None:
        page = html.render(run)
        assert "No findings" not in page
        assert page.count("Shared with other models, listed there") == 3


@pytest.mark.slow
@pytest.mark.usefixtures("one_process")
def test_a_baseline_knows_it_in_every_model(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / ".git").mkdir()
    (tmp_path / "urdfcheck.toml").write_text('tier = "source"\nselect = ["INR003", "URC904"]\n')
    write_robots(tmp_path, FORMULA, a=disc(), b=disc())
    monkeypatch.chdir(tmp_path)
    assert main(["."]) == FINDINGS
    assert main(["baseline", "write"]) == OK
    assert main(["."]) == OK
    assert main(["b.urdf.xacro"]) == OK
    write_robots(tmp_path, FORMULA, c=disc())
    assert main(["."]) == FINDINGS
    assert main(["a.urdf.xacro"]) == OK


def test_what_one_macro_repeats_is_counted_once_however_many_robots_call_it(tmp_path: Path) -> None:
    joints = "".join(
        f'<joint name="${{prefix}}{side}"><command_interface name="velocity"/></joint>\n'
        for side in ("left", "right") * 2
    )
    macro = (
        f'<xacro:macro name="ctl" params="prefix"><ros2_control name="c" type="system"><hardware><plugin>a/B</plugin>'
        f"</hardware>\n{joints}</ros2_control></xacro:macro>"
    )
    (tmp_path / "ctl.xacro").write_text(robot(macro, xacro=True))
    for prefix in ("a_", "b_"):
        parts = [link("base")]
        for side in ("left", "right"):
            name = prefix + side
            parts += [link(name), joint(name, "base", name, kind="continuous", axis="0 1 0")]
        call = f'<xacro:include filename="ctl.xacro"/><xacro:ctl prefix="{prefix}"/>'
        (tmp_path / f"{prefix}.urdf.xacro").write_text(robot(*parts, call, xacro=True))
    (finding,) = check(tmp_path, codes={"CTL005"}).findings
    assert (finding.message_id, len(finding.occurrences)) == ("twice", 2)
    assert [len(subjects) for subjects in finding.variants.values()] == [2, 2]
    assert finding.headline.endswith("(+1 more)")


def test_notes_that_were_not_asked_for_are_merged_like_those_of_the_report() -> None:
    notes = [
        finding(
            severity=Severity.INFO,
            location=Location(f"link[{name}]", span_of(name)),
            subjects=(f"link[{name}]",),
            fix=None,
        )
        for name in ("base", "wheel")
    ]
    (merged,) = merge_unrequested(notes, [])
    assert len(merged.occurrences) == 2
    assert count_more_notes([], [merged], []) == 1
