"""A headline has at most 70 characters, whatever the names and paths in it."""

from __future__ import annotations

import re
import string
from pathlib import Path
from typing import Any

import pytest

from urdfcheck.core import Location, Rule, UrdfcheckError
from urdfcheck.core.headlines import (
    LONGEST_HEADLINE,
    cut_line,
    cut_middle,
    cut_text,
    drop_parts,
    fill_headline,
    fill_joint_headline,
    shorten_headline,
)
from urdfcheck.core.merging import join_occurrences
from urdfcheck.rules import find_pages_folder, load_page

# Verbs of headlines.
_VERBS = re.compile(
    r"\b(?:is|are|has|have|does|do|reads?|ignores?|drops?|loses?|merges?|keeps?|declares?|measures?|remains?|overlaps?|collides?"
    r"|collide|contains?|refers?|sets|hides|replaces|exists?|needs?|swaps?|adds|gets|fits|leads?|holds)\b"
)
_HINT = re.compile(r" \([^()]*\)$")


def test_what_fits_is_not_touched() -> None:
    data = {"joint": "wheel_1", "angle": -43.1088, "siblings": "wheel_2, wheel_3"}
    headline = fill_headline("{joint}: zero is {angle:+.2f}° off, unlike {siblings}", data)
    assert headline == "wheel_1: zero is -43.11° off, unlike wheel_2, wheel_3"


def test_lists_lose_names_before_any_name_is_cut() -> None:
    data = {
        "joint": "front_left_wheel_joint",
        "siblings": "rear_left_wheel_joint, rear_right_wheel_joint, x and 2 more",
    }
    headline = fill_headline("{joint}: axis is off, unlike {siblings}", data)
    assert headline == "front_left_wheel_joint: axis is off, unlike rear_left… and 4 more"
    assert len(headline) <= LONGEST_HEADLINE


def test_paths_lose_folders_before_the_file_is_cut() -> None:
    path = "src/robots/car_description/meshes/visual/front_left_wheel_with_tyre.stl"
    assert fill_headline("mesh file does not exist: {path}", {"path": path}) == (
        "mesh file does not exist: …/visual/front_left_wheel_with_tyre.stl"
    )


def test_a_path_in_a_phrase_loses_folders_and_the_phrase_stays() -> None:
    data = {"meshes": "collision mesh package://arm_description/meshes/collision/gripper_bar.stl is", "count": 116}
    assert fill_headline("{meshes} open (open edges: {count})", data) == (
        "collision mesh …/collision/gripper_bar.stl is open (open edges: 116)"
    )


def test_a_name_with_a_slash_gets_no_longer_by_being_shortened() -> None:
    assert drop_parts("/base_link", 5) == "/base_link"
    assert drop_parts("package://car/a.stl", 12) == "…/car/a.stl"
    assert drop_parts("link[a_long_name]/inertial/mass@value", 20) == "link[a_long_name]/inertial/mass@value"


def test_names_that_differ_in_a_few_letters_still_do() -> None:
    fingers = {"one": "r_gripper_r_finger_tip_link", "two": "r_gripper_l_finger_tip_link"}
    headline = fill_headline("{one} and {two} overlap by 1.74 mm at rest", fingers)
    assert headline == "r_gripper_r_finger_tip_link and …l_finger… overlap by 1.74 mm at rest"


def test_a_sentence_loses_its_end_and_keeps_to_one_line() -> None:
    headline = fill_headline(
        "not well-formed XML: {error}", {"error": "`<link>` is\nnot closed, " + "nor is anything else " * 9}
    )
    assert headline == "not well-formed XML: <link> is not closed, nor is anything else nor…"


@pytest.mark.parametrize("name", ["x" * 5_000_000, "a, " * 100_000, "a/" * 100_000, "(" * 10_000, " and " * 10_000])
def test_a_text_of_an_attacker_is_short_and_takes_no_time(name: str) -> None:
    headline = fill_headline("{one} and {two} are called {one!r}", {"one": name, "two": name})
    assert len(headline) <= LONGEST_HEADLINE


def test_the_words_of_the_template_stay() -> None:
    names = {"one": "left_gripper_finger_tip_link", "two": "right_gripper_finger_tip_link"}
    assert fill_headline("{one} and {two} overlap by 5.7 mm at rest", names) == (
        "left_gripper_finger_tip_link and right_grip… overlap by 5.7 mm at rest"
    )


def test_shortened_texts_have_the_length_that_was_asked_for() -> None:
    texts = [
        "left_gripper_finger_tip_link",
        "a_long_name, another_name and 3 more",
        "one sentence, and its end",
        "a/b/c.stl",
    ]
    for text in texts:
        for most in range(10, len(text) + 2):
            assert len(cut_text(text, most)) <= max(most, len("a…e and 3 more"))
            assert len(cut_middle(text, most)) <= most
            assert drop_parts(text, len(text)) == cut_text(text, len(text)) == text


def test_a_list_counts_what_it_leaves_out() -> None:
    listed = "arm and hand (2 mm), a and b (1 mm), c and d (0.5 mm) and 3 more"
    assert drop_parts(listed, 46) == "arm and hand (2 mm), a and b (1 mm) and 4 more"
    assert drop_parts(listed, 30) == "arm and hand (2 mm) and 5 more"
    assert (
        drop_parts("hip at -1.6 rad (limit -2; a and b), knee at 1 rad", 40)
        == "hip at -1.6 rad (limit -2; a and b) and 1 more"
    )


def test_a_sentence_with_commas_is_no_list() -> None:
    text = "mismatched tag, line 3, which is not closed"
    assert drop_parts(text, 20) == text


def test_a_page_without_a_headline_is_not_a_rule_page(tmp_path: Path) -> None:
    page = find_pages_folder() / "JNT005-limit-inverted.md"
    copy = tmp_path / page.name
    text = page.read_text(encoding="utf-8")
    line = next(line for line in text.splitlines(keepends=True) if line.startswith("equal = "))
    copy.write_text(text.replace(line, "", 1), encoding="utf-8")
    with pytest.raises(UrdfcheckError, match=r"\[headlines\] has no 'equal'"):
        load_page(copy)


def test_a_number_in_brackets_is_left_out_before_a_name_is_cut() -> None:
    data = {"mesh": "package://a/meshes/a_long_name_of_a_wheel_link.STL", "count": 20048, "limit": 20000}
    template = "collision mesh {mesh} has {count:,} triangles (limit {limit:,})"
    assert fill_headline(template, data) == "collision mesh …/a_long_name_of_a_wheel_link.STL has 20,048 triangles"
    short = data | {"mesh": "a.STL"}
    assert fill_headline(template, short).endswith("(limit 20,000)")


def test_a_list_whose_first_name_is_too_long_is_left_out_or_counted() -> None:
    names = "joint_gripper_finger_right, joint_gripper_finger_left"
    ending = "2 joints have equal limits ({value}) and cannot move: {joints}"
    assert fill_headline(ending, {"value": 0, "joints": names}) == "2 joints have equal limits (0) and cannot move"
    collision = "collision before the joint limit: {joints}"
    detail = {"joints": "arm_left_2_joint at 0.3 rad (limit 0.5; arm_left_6_link and base_link), b at 1 rad"}
    assert fill_headline(collision, detail) == "collision before the joint limit: arm_left_2_joint and 1 more"
    beginning = "{link}: one mistake in the inertial ({mistake})"
    data = {"link": "link_gripper_finger_right, link_gripper_finger_left and 3 more", "mistake": "parallel-axis term"}
    assert fill_headline(beginning, data) == "5 links: one mistake in the inertial (parallel-axis term)"


def test_a_verb_at_the_end_of_a_value_stays() -> None:
    unit = "{meshes} a unit of {unit:g} m, which some programs ignore"
    values = {"meshes": "meshes rplidar_s2.dae, pro_tire.dae declare", "unit": 0.001}
    assert fill_headline(unit, values) == "meshes …tire.dae declare a unit of 0.001 m, which some programs ignore"
    assert cut_text("mesh front_left_wheel_link.stl is", 20) == "mesh …_link.stl is"


@pytest.mark.parametrize(
    ("template", "data", "headline"),
    [
        (
            "{one} is 1.35 mm off the mirror image of {two}",
            {"one": "front_right_steer_joint", "two": "front_left_steer_joint"},
            "front_right_steer_joint is 1.35 mm off the mirror image of front_left…",
        ),
        (
            "{one} and {two} need each other",
            {"one": "turtlebot3_manipulation_description", "two": "turtlebot3_manipulation_bringup"},
            "turtlebot3_manipulation_description and …bringup need each other",
        ),
        (
            "{who} a placeholder inertia ({worst}15,000× too large)",
            {"who": "2 links have", "worst": "CAMERA_HEAD_L_Link: "},
            "2 links have a placeholder inertia (CAMERA_HEAD_L…: 15,000× too large)",
        ),
        (
            "{links} and {original}: same inertia, but different shapes",
            {"links": "MP_THIGH2_L, MP_THIGH2_R and 4 more", "original": "MP_ANKLE1_THIGH_L"},
            "6 links and MP_ANKLE1_THIGH_L: same inertia, but different shapes",
        ),
        (
            "robot {name} has no <inertial> on any link; unfit for simulation",
            {"name": "hiwin_ra605_710_gb"},
            "robot hiwin_ra605… has no <inertial> on any link; unfit for simulation",
        ),
    ],
)
def test_the_first_name_stays_and_others_are_cut_between_words(
    template: str, data: dict[str, str], headline: str
) -> None:
    assert fill_headline(template, data) == headline


def test_a_hint_is_left_out_rather_than_the_names_that_it_is_about() -> None:
    template = "no parser reads {attribute} of <{tag}> (did you mean {near}?)"
    long = {
        "attribute": "`upper`, `lower`",
        "tag": "safety_controller",
        "near": "soft_upper_limit and soft_lower_limit",
    }
    assert fill_headline(template, long) == "no parser reads upper, lower of <safety_controller>"
    short = {"attribute": "`uper`", "tag": "limit", "near": "upper"}
    assert fill_headline(template, short) == "no parser reads uper of <limit> (did you mean upper?)"


CLAIM = "{link}: {fault} ({why}?)"
VALUES = {"fault": "two moments 6.2× too large", "fault_short": "suspect inertia", "why": "at the origin, CAD signs"}


@pytest.mark.parametrize(
    ("link", "limit", "headline"),
    [
        ("base_link", 70, "base_link: two moments 6.2× too large (at the origin, CAD signs?)"),
        ("base_link", 59, "base_link: suspect inertia (at the origin, CAD signs?)"),
        ("a_long_name_of_a_left, b and 6 more", 70, "8 links: two moments 6.2× too large (at the origin, CAD signs?)"),
        ("a_long_name_of_a_left, b and 6 more", 59, "8 links: suspect inertia (at the origin, CAD signs?)"),
    ],
)
def test_a_shorter_value_takes_the_place_of_one_that_would_be_cut(link: str, limit: int, headline: str) -> None:
    data = VALUES | {"link": link}
    assert fill_headline(CLAIM, data, limit) == headline
    assert shorten_headline(fill_headline(CLAIM, data), CLAIM, data, limit) == headline


def test_a_headline_of_another_template_loses_its_end() -> None:
    data = VALUES | {"link": "base_link"}
    assert shorten_headline("base_link: so much is wrong with it", CLAIM, data, 20) == "base_link: so much…"
    plain = {"link": "base_link", "fault": VALUES["fault"], "why": VALUES["why"]}
    whole = fill_headline(CLAIM, plain)
    assert shorten_headline(whole, CLAIM, plain, 50) == cut_line(whole, 50)


def test_a_headline_of_several_places_keeps_its_cause() -> None:
    rule = load_page(find_pages_folder() / "INR009-inertia-disagrees.md")
    data: dict[str, Any] = dict.fromkeys(_list_values(rule), "") | VALUES | {"link": "base_link"}
    ordered = [
        rule.finding(message, at=Location(f"link[base_link]/inertial/{i}", None), **data)
        for i, message in enumerate(("named", "twin"))
    ]
    assert ordered[0].headline == "base_link: two moments 6.2× too large (at the origin, CAD signs?)"
    joint = join_occurrences(ordered, {rule.code: rule})
    assert joint.headline == "base_link: suspect inertia (at the origin, CAD signs?) (+1 more)"


def test_a_headline_counts_elements_of_which_one_finding_may_have_several() -> None:
    template = "{link}: needs mass spread {wider:g}× wider than drawn by its own geometry"
    data = [{"link": "shoulder", "wider": 22.4}, {"link": "a, b", "wider": 3.0}, {"link": "c", "wider": 5.0}]
    joint = fill_joint_headline(template, data, [["shoulder"], ["a", "b"], ["c"]], "links")
    assert joint.endswith(" (+3 more)")


def test_a_headline_counts_the_elements_of_the_first_place_that_it_does_not_name() -> None:
    template = "{link}: collision is {gap} off the visual"
    data = [{"link": "left_arm", "gap": "90°"}, {"link": "left_leg", "gap": "0.0158 m"}]
    names = [["left_arm", "right_arm"], ["left_leg", "right_leg"]]
    assert fill_joint_headline(template, data, names, "links").endswith(" off the visual (+3 more)")


@pytest.mark.parametrize(
    ("template", "first", "more"),
    [
        ("{joint} cannot hold gravity: needs {torque:g} N·m", "a", 4),
        ("{joint} cannot hold gravity: needs {torque:g} N·m", "a, b, c", 2),
        ("{count} cannot hold gravity: at most {torque:g} N·m", "a", 2),
        ("no controller holds the arm: needs {torque:g} N·m", "a", 1),
    ],
)
def test_a_headline_counts_what_it_tells_of_the_first_place_no_more(template: str, first: str, more: int) -> None:
    data = [{"joint": first, "count": "3 joints", "torque": 35.5}, {"joint": "d", "count": "2 joints", "torque": 4.5}]
    joint = fill_joint_headline(template, data, [["a", "b", "c"], ["d", "e"]], "joints")
    assert joint.endswith(f" (+{more} more)")


def _list_values(rule: Rule) -> list[str]:
    templates = (*rule.headlines.values(), *rule.messages.values(), *rule.fixes.values(), *rule.consumers.values())
    texts = [text for text in templates if isinstance(text, str)]
    return [key for text in texts for _, key, _, _ in string.Formatter().parse(text) if key]


def test_a_count_of_what_is_left_out_stays() -> None:
    data = {"first": "motor_front_left_hip_joint", "where": "-0.301 rad", "more": " (+11 joints)"}
    headline = fill_headline("{first} self-collides at {where}, inside its range{more}", data)
    assert headline.endswith(" self-collides at -0.301 rad, inside its range (+11 joints)")


# Values that are short in any robot: the headlines of all pages are filled with long names otherwise.
SHORT = re.compile(
    r"count|freed|hits|samples|bare|bodies|known|some|factor|value|more|times|total|where|first_value|content"
)


@pytest.mark.parametrize(
    "page", sorted(find_pages_folder().glob("[A-Z][A-Z][A-Z][0-9]*.md")), ids=lambda page: page.stem
)
def test_no_headline_loses_a_verb_to_long_names(page: Path) -> None:
    for name, template in load_page(page).headlines.items():
        fields = [(key, spec or "") for _, key, spec, _ in string.Formatter().parse(template) if key]
        data = {
            key: 12.345
            if spec[-1:] in tuple("efg%")
            else 1234
            if spec[-1:] in ("d", ",")
            else "12"
            if SHORT.search(key)
            else f"front_left_{key}_wheel_link"
            for key, spec in fields
        }
        headline = fill_headline(template, data)
        kept = _HINT.sub("", template)
        words = {word for text, *_ in string.Formatter().parse(kept) for word in _VERBS.findall(text)}
        assert words <= set(_VERBS.findall(headline)), (name, headline)


@pytest.mark.parametrize(
    ("line", "most", "cut"),
    [
        ("a mesh has 26,480 triangles (limit 20,000)", 40, "a mesh has 26,480 triangles…"),
        ("a mesh has 26,480 triangles", 20, "a mesh has 26,480…"),
        ("inertials (left and right) do not match", 33, "inertials (left and right) do…"),
        ("x" * 30, 10, "x" * 9 + "…"),
        ("(open from its beginning on", 15, "(open from its…"),
        ("fits", 4, "fits"),
        ("no room", -20, "…"),
    ],
)
def test_a_line_is_cut_between_words_and_brackets(line: str, most: int, cut: str) -> None:
    assert cut_line(line, most) == cut
    assert len(cut) <= max(most, 1)
