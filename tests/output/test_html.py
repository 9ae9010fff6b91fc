"""The HTML report: one inert, self-contained file that says everything that the run knows."""

from __future__ import annotations

import base64
import hashlib
import json
import re
import zlib
from dataclasses import replace
from itertools import combinations
from typing import Any

import pytest
from output.documents import Document, read
from output.runs import (
    FILE,
    NOT_CHECKED,
    SOURCE,
    a_run,
    chain,
    finding,
    info,
    make_joint,
    make_link,
    rule,
    scene,
    span,
    span_of,
    star,
)

from urdfcheck.core import (
    Applicability,
    Edit,
    Finding,
    Fix,
    Location,
    NotChecked,
    Run,
    Severity,
    SkippedCheck,
    Span,
    Suppression,
)
from urdfcheck.core.scene import Scene, SceneFrame
from urdfcheck.output.html import iter_report_pages, render
from urdfcheck.output.html.html_text import (
    escape_html,
    format_millimetres,
    format_number,
    format_scaled,
)
from urdfcheck.output.html.rule_markdown import render_markdown
from urdfcheck.output.html.sections.code_listing import render_code_frame, render_diff
from urdfcheck.output.html.svg.tree_layout import BOX, WIDEST, lay_out_tree
from urdfcheck.output.shared.kinematic_forest import build_forest
from urdfcheck.output.shared.verdict.losses import describe_losses

HOSTILE = "<script>alert(1)</script>\"' onload=x & \u202egnp.\x1b[31m"


def document(run: Run) -> Document:
    """The report, checked for what must hold of every report."""
    found = read(render(run))
    assert len(found.ids) == len(set(found.ids)), "ids repeat"
    links = [a["href"] for _, a in found.tags if "href" in a]
    assert [h for h in links if not h.startswith("#") or h[1:] not in found.ids] == []
    assert [t for t, _ in found.tags if t in {"iframe", "img", "link", "object", "form", "base"}] == []
    forbidden = {"style", "src", "srcset", "action", "xlink:href"}
    assert [(t, n) for t, a in found.tags for n in a if n in forbidden or n.startswith("on")] == []
    return found


def plain(markup: str) -> str:
    return read(markup).text


def paragraph(html: str, css_class: str) -> str:
    """The text of the first paragraph of a class."""
    text = plain(f"<p>{html.split(f'<p class={chr(34)}{css_class}{chr(34)}>')[1].split('</p>')[0]}</p>")
    return " ".join(text.split())


# -- one safe file -----------------------------------------------------------------------------------------------------


def digest(text: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


@pytest.mark.parametrize("scenes", [(scene(),), ()], ids=["with the robot in 3D", "without"])
def test_policy_allows_the_style_and_the_scripts_that_are_there_and_nothing_else(scenes: tuple[Scene, ...]) -> None:
    found = document(a_run(scenes=scenes))
    policy = next(a["content"] for a in found.all("meta") if a.get("http-equiv") == "Content-Security-Policy")
    scripts = [t for t, a in zip(found.scripts, found.all("script"), strict=True) if not a.get("type")]
    if packed := [t for t, a in zip(found.scripts, found.all("script"), strict=True) if a.get("id") == "uc-app"]:
        scripts.insert(1, zlib.decompress(base64.b64decode(packed[0]), -zlib.MAX_WBITS).decode())
    assert len(scripts) == (3 if scenes else 1)
    assert policy.split("; ") == [
        "default-src 'none'",
        f"style-src {digest(found.style)}",
        f"script-src {' '.join(map(digest, scripts))}",
        "img-src data:",
        "base-uri 'none'",
        "form-action 'none'",
    ]
    assert len(found.all("style")) == 1


def test_data_of_a_robot_ends_no_script_and_reads_back() -> None:
    name = "</script><!--<script>\u202e##[error]\x1b"
    found = document(a_run(scenes=(scene(root=name, links=(make_link(name),), joints=(), frames=()),)))
    data = next(t for t, a in zip(found.scripts, found.all("script"), strict=True) if a.get("id") == "uc-data")
    assert data.isascii()
    assert "<" not in data
    assert "##[" not in data
    assert json.loads(data)["models"][0]["links"][0]["name"] == name


def test_style_loads_nothing_and_cannot_end_early() -> None:
    style = document(a_run()).style
    assert "url(" not in style
    assert "@import" not in style
    assert "</" not in style


def test_addresses_appear_as_text_only() -> None:
    found = document(a_run())
    assert "https://example.org/manual" in found.text
    assert not any("://" in value for _, attributes in found.tags for value in attributes.values())


def test_names_from_files_are_inert_wherever_they_appear() -> None:
    hostile = finding(
        code="INR003",
        message=HOSTILE,
        subjects=(f"link[{HOSTILE}]", HOSTILE),
        location=Location(HOSTILE, replace(span_of("0.09"), file=HOSTILE), (replace(span_of("-1"), file=HOSTILE),)),
        related=(Location(HOSTILE, None),),
        consequences={HOSTILE: HOSTILE},
        data={"hides": [HOSTILE]},
        fix=Fix(HOSTILE, Applicability.SAFE, (Edit(replace(span_of("0.09"), file=HOSTILE), HOSTILE, HOSTILE),)),
        model=HOSTILE,
    )
    joints = (make_joint(HOSTILE, HOSTILE, "b", type=HOSTILE),)
    run = a_run(
        hostile,
        models=(
            info(path=HOSTILE, robot=HOSTILE, args={HOSTILE: HOSTILE}, id=HOSTILE),
            info(path=HOSTILE, id=f"{HOSTILE}2", status="failed", not_checked=NotChecked(HOSTILE, HOSTILE)),
        ),
        unused_macro_files=(HOSTILE,),
        skipped=(SkippedCheck(HOSTILE, HOSTILE, HOSTILE),),
        rules={
            "INR003": rule(
                page=f"## What it checks\n\n{HOSTILE}\n\n`{HOSTILE}`\n\n- {HOSTILE}\n\n```\n{HOSTILE}\n```\n"
            )
        },
        versions={"urdfcheck": HOSTILE},
        sources={HOSTILE: SOURCE.replace("rover", HOSTILE)},
        scenes=(
            scene(
                model=HOSTILE,
                root=HOSTILE,
                links=(make_link(HOSTILE, shapes=()), make_link("b")),
                joints=joints,
                frames=(SceneFrame(HOSTILE, HOSTILE + "2", (), None),),
            ),
        ),
        failures=(HOSTILE,),
    )
    found = document(run)  # no script, no handler, properly nested
    assert "alert(1)</script>" in found.text
    assert "\u202e" not in found.text
    assert "\x1b" not in found.text
    assert "\\u202egnp.\\x1b[31m" in found.text


def test_equal_runs_differ_in_seconds_only() -> None:
    slow, fast = render(a_run(seconds=9.0)), render(a_run(seconds=0.1))
    seconds = re.compile(r'(<span class="seconds">).*?(</span>)')
    assert slow != fast
    assert seconds.sub(r"\1\2", slow) == seconds.sub(r"\1\2", fast)


def test_lone_surrogates_of_undecodable_file_names_can_be_written() -> None:
    render(a_run(models=(info(path="m\udce9sh.urdf"),))).encode()


# -- the head ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("run", "verdict"),
    [
        (a_run(), "1 error: MuJoCo refuses this model"),
        (
            a_run(finding(consequences={"mujoco": "refuses", "drake": "refuses"})),
            "1 error: MuJoCo and Drake refuse this model",
        ),
        (a_run(finding(consequences={})), "1 error"),
        (
            a_run(finding(consequences={}), unrequested=(finding(severity=Severity.INFO),)),
            "1 error · MuJoCo refuses this model: the notes say why",
        ),
        (
            a_run(finding(), finding(severity=Severity.WARNING, consequences={"drake": "refuses"})),
            "1 error, 1 warning: MuJoCo and Drake refuse this model",
        ),
        (
            a_run(
                finding(),
                finding(severity=Severity.WARNING, consequences={}),
                unrequested=(finding(severity=Severity.INFO, consequences={"mujoco": "refuses", "drake": "drops it"}),),
            ),
            "1 error: MuJoCo refuses this model · Drake drops a part of this model: the notes say why",
        ),
        (a_run(finding(severity=Severity.WARNING, consequences={})), "No errors, 1 warning"),
        (a_run(finding(severity=Severity.WARNING)), "No errors, 1 warning: MuJoCo refuses this model"),
        (a_run(finding(), models=(info(), info(id="2", path="arm.urdf"))), "1 error in 1 of 2 models"),
        (
            a_run(finding(severity=Severity.INFO)),
            "No errors and no warnings · MuJoCo refuses this model: the notes say why",
        ),
        (
            a_run(finding(suppressed=Suppression("source", "known"))),
            "No errors and no warnings · MuJoCo refuses this model: what says why is suppressed",
        ),
        (
            a_run(
                unrequested=(finding(severity=Severity.INFO, model="2"),),
                findings=(),
                models=(info(), info(id="2", path="arm.urdf")),
            ),
            "No errors and no warnings · MuJoCo refuses 1 of 2 models: the notes say why",
        ),
        (
            a_run(finding(severity=Severity.INFO), models=(info(status="failed"),)),
            "Not checked: the model could not be read",
        ),
        (replace(a_run(), models=(), findings=(), scenes=(), units=0), "Nothing was checked"),
        (replace(a_run(), models=(), findings=(), scenes=()), "No errors and no warnings"),
        (a_run(failures=("INR003 crashed",)), "Not finished"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_verdict_is_one_claim(run: Run, verdict: str) -> None:
    claim = render(run).split('<p class="verdict')[1].split("</p>")[0]
    assert plain(f'<p class="{claim}</p>').strip().startswith(verdict)


@pytest.mark.parametrize(
    ("changes", "sign"),
    [({"consequences": {}}, "ok"), ({}, "warning"), ({"severity": Severity.ERROR}, "error")],
    ids=["it loads", "a program refuses it", "an error"],
)
def test_the_sign_of_the_verdict_is_a_tick_unless_something_is_refused(changes: dict[str, Any], sign: str) -> None:
    html = render(a_run(finding(**{"severity": Severity.WARNING, **changes})))
    assert f'<p class="verdict {sign}">' in html


def test_no_tick_stands_beside_a_program_that_refuses_the_model() -> None:
    note = finding(severity=Severity.INFO)
    html = render(a_run(findings=(), unrequested=(note,)))
    assert '<p class="verdict info">' in html
    assert '<p class="clean info">' in html
    # It is what the reader wants to know: the note is on the page, also on that of a folder.
    assert 'class="card info"' in html
    assert 'class="card info"' in dict(iter_report_pages(a_run(findings=(), unrequested=(note,))))["rover.html"]
    assert 'class="card' not in render(a_run(findings=(), unrequested=(note,), targets=("gazebo",)))


@pytest.mark.parametrize(("severity", "sign"), [(Severity.INFO, "info"), (Severity.WARNING, "warning")], ids=str)
def test_no_tick_stands_over_several_models_of_which_one_is_refused(severity: Severity, sign: str) -> None:
    two = (info(), info(id="2", path="arm.urdf"))
    run = a_run(finding(severity=severity), models=two)
    assert f'<p class="verdict {sign}">' in render(run)
    assert f'<p class="verdict {sign}">' in dict(iter_report_pages(run))["index.html"]
    assert '<p class="verdict ok">' in dict(iter_report_pages(a_run(findings=(), models=two)))["index.html"]
    # One model is dropped for a note, and refused for another one that is not listed.
    drops = finding(severity=Severity.INFO, consequences={"drake": "drops it"})
    refuses = finding(severity=Severity.INFO, consequences={"mujoco": "refuses"})
    assert (
        describe_losses(a_run(drops, models=two)).by_others == "Drake drops a part of 1 of 2 models: the notes say why"
    )
    assert describe_losses(a_run(drops, models=two, unrequested=(refuses,))).by_others == (
        "MuJoCo refuses 1 of 2 models: why is in the notes (-v)"
    )
    elsewhere = finding(severity=Severity.INFO, model="2", consequences={"drake": "refuses"})
    assert describe_losses(a_run(drops, elsewhere, models=two)).by_others == (
        "Drake refuses, or drops a part of, 2 of 2 models: the notes say why"
    )
    # Each of two programs refuses one model.
    here = finding(severity=Severity.INFO, consequences={"mujoco": "refuses"})
    assert describe_losses(a_run(here, elsewhere, models=two)).by_others == (
        "MuJoCo or Drake refuses 2 of 2 models: the notes say why"
    )
    unread = (info(), info(id="2", path="arm.urdf", status="failed"))
    assert " of 2 models: the notes" not in render(a_run(finding(severity=Severity.INFO, model="2"), models=unread))


def test_a_chip_says_that_its_reason_is_not_listed() -> None:
    hidden = finding(severity=Severity.INFO, consequences={"kdl": "ignores the inertia"})
    html = render(a_run(unrequested=(hidden,)))
    (chip,) = re.findall(r'<a class="chip [^>]*data-program="kdl"[^>]*>', html)
    assert "data-unlisted" in chip
    assert "KDL loads it changed: ignores a part (why is in the notes: -v)" in chip
    assert html.count("data-unlisted") - html.count("data-unlisted]") == 1


def test_what_was_not_checked_comes_with_the_command_and_its_cause_first() -> None:
    (unread, _) = NOT_CHECKED.models
    cause = replace(NOT_CHECKED.findings[0], severity=Severity.WARNING)
    other = finding(model=unread.id, message_id="other")
    html = render(replace(NOT_CHECKED, models=(unread,), findings=(other, cause), unused_macro_files=(), scenes=()))
    head = html.split("<header")[1].split("</header>")[0]
    assert "Not checked: argument side has no default</span>" in head
    assert "<code>urdfcheck arm.urdf.xacro --arg side:=…</code>" in head
    assert 'class="act copy-command"' in head
    assert "#g-ok" not in html.partition("</defs>")[2]
    start = html.split("<h3>Start here</h3>")[1].split("<h3>")[0]
    assert "XAC010" in start


def test_a_claim_about_several_models_names_those_that_were_not_checked() -> None:
    assert "1 of 2 models and 1 macro file were not checked (arm.urdf.xacro). 1 error" in document(NOT_CHECKED).text


# -- what each program does --------------------------------------------------------------------------------------------


def strip_of(run: Run) -> dict[str, str]:
    """What each chip under the verdict says."""
    chips = re.findall(r'<a class="chip (\w+)" href="#m1-consumers" data-program="(\w+)" title="(.*?)">', render(run))
    return {program: f"{kind} {words}" for kind, program, words in chips}


def test_a_chip_for_each_program_links_to_the_table() -> None:
    chips = strip_of(a_run(finding()))
    assert list(chips)[:4] == ["urdfdom", "pinocchio", "mujoco", "drake"]
    assert chips["mujoco"] == "error MuJoCo refuses it"
    assert chips["drake"] == "warning Drake loads it changed: replaces values"
    assert chips["rviz"] == "ok RViz loads it as typed"


def test_of_a_mesh_that_was_not_read_no_program_is_said_to_load_it() -> None:
    unread = finding(
        code="MSH001", consequences={"mujoco": "refuses to compile"}, data={"unproven": ["rviz", "newton"]}
    )
    chips = strip_of(a_run(unread))
    assert chips["rviz"] == "unchecked RViz may lack a mesh that was not checked"
    assert chips["isaac"].startswith("unchecked")
    assert chips["mujoco"] == "error MuJoCo refuses it"
    assert chips["kdl"] == "ok KDL loads it as typed"


def test_a_chip_counts_what_follows_from_a_launch_file_too() -> None:
    launched = rule("LCH002", "spawn", scopes=("launch",))
    effects = {"gazebo": "starts the world without the robot", "rviz": "loads it"}
    spawn = finding(code="LCH002", consequences=effects)
    run = a_run(spawn, rules={"LCH002": launched})
    assert strip_of(run)["gazebo"] == "error Gazebo when launched: starts the world without the robot"
    assert strip_of(run)["rviz"].startswith("ok")
    warned = a_run(replace(spawn, severity=Severity.WARNING), rules={"LCH002": launched})
    assert strip_of(warned)["gazebo"].startswith("warning")
    known = a_run(replace(spawn, suppressed=Suppression("source", "x")), rules={"LCH002": launched})
    assert strip_of(known)["gazebo"].startswith("ok")


def test_a_card_names_the_programs_that_mind_and_its_chip_finds_it() -> None:
    effects = {
        "mujoco": "refuses to compile",
        "drake": "refuses to parse",
        "bullet": "replaces it",
        "rviz": "loads it as typed",
    }
    html = render(a_run(finding(consequences=effects)))
    assert 'data-programs="mujoco drake bullet"' in html
    minds = paragraph(html, "minds")
    assert minds == "MuJoCo and Drake refuse the model Bullet replaces values"
    assert html.count('data-programs="') == 1


def test_each_model_of_several_has_its_own_strip() -> None:
    two = a_run(finding(), models=(info(), info(id="2")), scenes=(scene(), scene(model="2")))
    assert re.findall(r'<ul class="programs" aria-label="In each program" data-model="(\w+)">', render(two)) == [
        "m1",
        "m2",
    ]


def test_head_names_robot_file_counts_depth_and_version() -> None:
    head = plain(render(a_run()).split("<header")[1].split(">", 1)[1].split("</header>")[0].join(("<div>", "</div>")))
    expected = ("rover", FILE, "2 links", "1 joint", "urdfcheck 0.1.0", "0.5283 kg", "checked: source, meshes")
    assert [part for part in expected if part not in head] == []
    assert "checked: source, meshes, dynamics" in document(a_run(tier="full")).text


@pytest.mark.parametrize(
    ("robots", "title"),
    [
        (["rover"], "rover"),
        (["rover", "arm"], "rover, arm"),
        (["rover", "rover"], "rover"),
        (["a", "b", "c", "d"], "4 models"),
        ([], "No models"),
    ],
)
def test_title_names_the_robots_while_they_are_few(robots: list[str], title: str) -> None:
    models = tuple(info(robot=robot, id=str(i)) for i, robot in enumerate(robots))
    run = a_run(finding(model="0" if robots else FILE), models=models, scenes=())
    assert f"<h1>{title}</h1>" in render(run)
    assert f"<title>{title} · urdfcheck</title>" in render(run)


def test_head_adds_up_nothing_over_several_models() -> None:
    models = (info(id="1"), info(id="2", robot="arm"))
    head = render(a_run(finding(model="1"), models=models, scenes=())).split("<header")[1].split("</header>")[0]
    assert not any(word in head for word in (" links", " joint", " kg"))


def test_head_lists_every_file_with_findings_below_their_folder() -> None:
    head = render(a_run(finding(), in_file("rover/launch/car.launch"))).split("<header")[1].split("</header>")[0]
    assert "<summary>2 files</summary>in <code>rover/</code>" in head
    assert re.findall(r"<li><code>(.*?)</code>", head) == ["rover.urdf", "launch/car.launch"]


def test_files_without_a_common_folder_are_named_in_full() -> None:
    head = render(a_run(finding(), in_file("/opt/wheel.xacro"))).split("<header")[1].split("</header>")[0]
    assert re.findall(r"<li><code>(.*?)</code>", head) == [FILE, "/opt/wheel.xacro"]


def test_several_files_are_folded() -> None:
    head = render(a_run(*(in_file(f"rover/{i}.xacro") for i in range(9)))).split("<header")[1].split("</header>")[0]
    assert "<summary>10 files</summary>" in head
    assert head.count("<li><code>") == 10


def test_severity_is_told_by_shape_and_word_too() -> None:
    html = render(a_run())
    for severity in ("error", "warning", "info"):
        card = html.split(f'<article class="card {severity}')[1].split("</article>")[0]
        assert f'<use href="#g-{severity}"/>' in card
        assert f'<span class="sr severity">{severity}</span>' in card


def test_what_needs_style_or_script_is_hidden_until_there_is_one() -> None:
    found = document(a_run())
    assert all("hidden" in a for a in (*found.classes("act"), *found.classes("in-3d"), *found.classes("state")))
    boxes = [a for a in found.all("input") if a["id"].startswith("show-")]
    assert len(boxes) == 3
    assert all("hidden" in a for a in boxes)
    one = document(a_run(finding())).all("input")
    assert [a["id"] for a in one] == ["find"], "one severity needs no filter"


def test_the_bar_has_the_sections_of_the_one_robot_or_the_names_of_several() -> None:
    def bar(run: Run) -> list[str]:
        nav = render(run).split('<nav aria-label="Contents">')[1].split("</nav>")[0]
        return re.findall(r'<a href="#([\w-]+)"', nav)

    tables = ["m1-consumers", "m1-tree", "m1-physics", "m1-meshes", "m1-joints"]
    assert bar(a_run()) == ["m1-findings", "m1-info", *tables, "rules", "about"]
    package = finding(code="PKG006", model="rover/package.xml")
    assert bar(a_run(finding(), package)) == ["m1-findings", *tables, "m2", "rules", "about"]
    two = a_run(finding(), models=(info(), info(id="2")), scenes=(scene(), scene(model="2")))
    assert bar(two) == ["m1", "m2", "rules", "about"]
    many = tuple(info(id=str(i), path=str(i)) for i in range(9))
    several = render(a_run(finding(model="0"), package, models=many, scenes=()))
    assert "<h1>9 models</h1>" in several
    assert "9 models and 1 other file</summary>" in several


# -- findings ----------------------------------------------------------------------------------------------------------


def test_card_tells_all_that_the_finding_knows() -> None:
    text = document(a_run(finding())).text
    for expected in (
        "INR003 triangle-inequality",
        "link wheel: principal moments break the triangle inequality",
        "link[wheel]/inertial/inertia",
        f"{FILE}:9:40",
        "Expanded from a macro call or include",
        f"{FILE}:5:3brings in rover.urdf:9",
        f"{FILE}:9:40called at rover.urdf:5",
        "link[wheel]/inertial/mass",
        "a decimal point was lost in izz",
        "MuJoCo",
        "refuses to compile",
        "put the point back",
        "review first",
        "proof: follows from the file",
        f"fingerprint {finding().fingerprints[0][:8]}",
    ):
        assert expected in text


def test_whole_fingerprint_is_at_hand_but_not_in_the_way() -> None:
    (shown,) = document(a_run(finding())).all("data")
    assert shown["value"] == shown["title"] == finding().fingerprints[0]
    assert finding().fingerprints[0] not in document(a_run(finding())).text


@pytest.mark.parametrize("applicability", list(Applicability))
def test_repairs_promise_no_command(applicability: Applicability) -> None:
    fix = Fix("put the point back", applicability, (Edit(span_of("0.09"), "0.09", "0.019"),))
    assert "--fix" not in document(a_run(finding(fix=fix))).text


def test_the_worst_is_where_to_start_and_the_others_follow_in_their_order() -> None:
    mild = finding(severity=Severity.WARNING, consequences={}, subjects=("link[a]",))
    refused = finding(severity=Severity.WARNING, subjects=("link[b]",))
    worst = in_file("rover/car.launch")
    html = render(a_run(mild, refused, worst))
    start, then = html.split("<h3>Start here</h3>")[1].split('<h3>Then <span class="count">2</span></h3>')
    cards = r'<article class="card [a-z ]+" id="(f-\w+)"'
    assert re.findall(cards, start) == [f"f-{worst.fingerprints[0]}"]
    assert re.findall(cards, then) == [f"f-{refused.fingerprints[0]}", f"f-{mild.fingerprints[0]}"]


def in_file(file: str, **changes: Any) -> Finding:
    subject = f"link[{file}]"
    return finding(location=Location(subject, replace(span_of("-1"), file=file)), subjects=(subject,), **changes)


@pytest.mark.parametrize(
    ("file", "kind"),
    [
        ("rover/car.launch", "launch file"),
        ("rover/car.launch.py", "launch file"),
        ("rover/car_launch.xml", "launch file"),
        ("rover/package.xml", "package manifest"),
        ("rover/launch.xacro", "included file"),
        ("rover/control.yaml", "file"),
    ],
)
def test_a_file_that_is_not_the_model_says_what_it_is(file: str, kind: str) -> None:
    assert f'<span class="kind">{kind}</span> <code class="place" title="{file}:7:20">' in render(a_run(in_file(file)))
    assert '<span class="kind">' not in render(a_run(finding()))


def test_a_card_begins_with_the_claim_the_place_the_elements_and_the_fix() -> None:
    html = render(
        a_run(
            finding(
                headline="axle turns <i>twice</i>", subjects=("link[a]", "link[b]/x", "link[b]/y", "link[c]", "link[d]")
            )
        )
    )
    card = html.split("<article")[1].split('<details class="more">')[0]
    assert '<span class="headline">axle turns &lt;i&gt;twice&lt;/i&gt;</span>' in card
    line = paragraph(html, "at")
    assert line == "rover.urdf:9fix3Da, b, c and 1 more"
    named = render(a_run(finding(headline="wheel: no body can have this inertia")))
    assert paragraph(named, "at") == "rover.urdf:9fix3D", "the headline has the name"
    by_hand = render(a_run(finding(fix=Fix("think"), subjects=("robot",))))
    assert paragraph(by_hand, "at") == "rover.urdf:9"


def test_a_kind_of_mistake_at_several_places_is_one_card_with_each_place() -> None:
    left = finding(headline="left: no body can have this inertia", subjects=("link[left]",))
    right = finding(
        headline="right: no body can have this inertia",
        subjects=("link[right]",),
        location=Location("link[right]", span_of("-1")),
    )
    both = replace(left, headline="left and right: no body can have this inertia", occurrences=(right, left))
    html = render(a_run(replace(both, subjects=("link[left]", "link[right]"))))
    assert html.count("<article") == 1
    assert paragraph(html, "at").startswith("rover.urdf:9 :7 ×2")
    assert f'<code class="place" title="{FILE}:7:20">:7</code>' in html
    assert "<h5>2 places</h5>" in html
    assert "right: no body can have this inertia" in html


def test_many_problems_are_folded_but_not_a_few_more() -> None:
    many = tuple(finding(subjects=(f"link[w{i}]",)) for i in range(40))
    html = render(a_run(*many))
    assert "<summary>20 more</summary>" in html
    assert html.count("<article") == 40
    assert "more</summary>" not in render(a_run(*many[:22]))


def test_notes_follow_the_problems_folded_and_tables_come_last() -> None:
    html = render(a_run())
    order = [
        "<h3>Start here</h3>",
        "<h3>Then",
        '<details class="fold notes info">',
        'id="m1-consumers"',
        'id="m1-joints"',
    ]
    assert [html.index(part) for part in order] == sorted(html.index(part) for part in order)
    assert html.count('<details class="section ') == 5
    assert '<details class="section consumers" open' not in html


def test_every_fingerprint_is_an_anchor_even_when_two_findings_share_one() -> None:
    many = finding(subjects=tuple(f"link[w{i}]" for i in range(9)))
    found = document(a_run(many, many))
    assert {f"f-{p}" for p in many.fingerprints} <= set(found.ids)
    assert {f"f-{p}-2" for p in many.fingerprints} <= set(found.ids)


def test_suppressed_findings_are_set_apart_with_their_reason() -> None:
    html = render(a_run(finding(suppressed=Suppression("source", "the wheel is a dummy"))))
    set_apart = html.split('<details class="fold suppressed">')[1]
    assert "the wheel is a dummy" in set_apart
    assert "1 known: 1 in the source" in set_apart


def test_many_related_places_are_named_but_not_all_quoted() -> None:
    related = tuple(Location(f"link[w{i}]", span_of("-1")) for i in range(100))
    html = render(a_run(finding(related=related)))
    assert all(f"<code>link[w{i}]</code>" in html for i in range(100))
    assert html.count('<figure class="frame">') == 10, "eight of them, the call and the place itself"


def test_consumers_that_do_the_same_share_a_line() -> None:
    effects = {"mujoco": "refuses", "drake": "refuses", "my_sim": "loads", "other_sim": "ignores"}
    found = document(a_run(finding(consequences=effects)))
    assert "MuJoCo, Drake" in found.text
    assert "other_sim" in found.text
    assert "my_sim" not in found.text  # it loads what was typed, like every program that is not named


def test_a_finding_of_an_unknown_rule_links_nowhere() -> None:
    assert "ABC001 mystery" in document(a_run(finding(code="ABC001", name="mystery"))).text


def test_findings_of_no_model_have_a_part_of_their_own() -> None:
    found = document(a_run(finding(), finding(code="PKG006", model="rover/package.xml")))
    assert "rover/package.xml" in found.text
    assert "m2" in found.ids


def test_many_models_have_a_row_each() -> None:
    models = tuple(info(id=f"m{i}.urdf", path=f"m{i}.urdf", robot=f"robot_{i}") for i in range(30))
    findings = tuple(finding(model=f"m{i}.urdf") for i in range(30))
    found = document(a_run(*findings, models=models, scenes=()))
    assert {f"m{i}" for i in range(1, 31)} <= set(found.ids)
    assert "30 models" in found.text
    assert len(found.classes("card")) == 30


def test_models_of_one_name_are_told_apart_by_their_files() -> None:
    models = (info(path="a/one.urdf", id="1"), info(path="a/two.xacro", id="2"))
    nav = render(a_run(finding(model="1"), models=models, scenes=())).split("<nav")[1].split("</nav>")[0]
    assert "rover <small>one.urdf</small>" in nav
    assert "rover <small>two.xacro</small>" in nav


def test_a_model_that_could_not_be_checked_says_so() -> None:
    text = document(a_run(finding(), models=(info(robot="", status="needs-arguments"),), scenes=())).text
    assert "Not checked: the model could not be read" in text
    assert "rover.urdf" in text
    text = document(NOT_CHECKED).text
    assert "Not checked: argument side has no default" in text
    assert "urdfcheck arm.urdf.xacro --arg side:=…" in text


def test_a_run_without_scene_has_findings_only() -> None:
    found = document(a_run(scenes=()))
    assert "Kinematic tree" not in found.text
    assert len(found.classes("card")) == 3


# -- source text -------------------------------------------------------------------------------------------------------


def marked(markup: str) -> list[str]:
    return [plain(f"<p>{m}</p>") for m in re.findall(r"<mark[^>]*>(.*?)</mark>", markup)]


def test_frame_marks_the_span_between_its_neighbours() -> None:
    markup = render_code_frame({FILE: SOURCE}, span_of("-1"), context=1)
    assert marked(markup) == ["-1"]
    assert plain(markup).splitlines() == [
        "6 <inertial>",
        '7   <mass value="-1"/>',
        '8   <inertia ixx="0.01" ixy="0" ixz="0"',
    ]


def test_frame_marks_a_span_over_several_lines() -> None:
    markup = render_code_frame({FILE: SOURCE}, span_of('izz="0.09"/>\n    </inertial>'))
    assert marked(markup) == ['izz="0.09"/>', "</inertial>"]


def test_frame_of_a_long_element_is_cut() -> None:
    markup = render_code_frame({FILE: SOURCE}, span(0, len(SOURCE) - 1))
    assert "to line 13" in plain(markup)
    assert "</robot>" not in plain(markup)


@pytest.mark.parametrize("at", [SOURCE.index("\n"), len(SOURCE.rstrip("\n"))], ids=["line end", "end of file"])
def test_frame_points_at_an_empty_span(at: int) -> None:
    assert '<mark class="point"></mark>' in render_code_frame({FILE: SOURCE}, span(at, at))


@pytest.mark.parametrize("sources", [{}, {FILE: ""}, {FILE: "short"}], ids=["absent", "empty", "other text"])
def test_without_the_source_there_is_no_frame_but_the_place(sources: dict[str, str]) -> None:
    assert render_code_frame(sources, span_of("0.09")) == ""
    assert f"{FILE}:9:40" in document(a_run(finding(), sources=sources)).text


def test_a_file_in_one_line_neither_floods_the_report_nor_hides_the_span() -> None:
    source = "<robot>" + '<link name="a"/>' * 20000 + '<mass value="-1"/></robot>'
    markup = render_code_frame({FILE: source}, span_of("-1", source))
    assert marked(markup) == ["-1"]
    assert len(markup) < 20_000


def test_comments_are_told_from_elements() -> None:
    markup = render_code_frame({FILE: SOURCE}, span_of("turns"), context=0)
    assert '<mark><span class="c">turns</span></mark><span class="c"> --&gt;</span>' in markup


def test_diff_is_a_patch() -> None:
    edits = [Edit(span_of("0.09"), "0.09", "0.019"), Edit(span_of("-1"), "-1", "1")]
    assert plain(render_diff({FILE: SOURCE}, edits)) == (
        f"--- {FILE}\n+++ {FILE}\n"
        "@@ -6,5 +6,5 @@\n"
        "     <inertial>\n"
        '-      <mass value="-1"/>\n'
        '+      <mass value="1"/>\n'
        '       <inertia ixx="0.01" ixy="0" ixz="0"\n'
        '-               iyy="0.01" iyz="0" izz="0.09"/>\n'
        '+               iyy="0.01" iyz="0" izz="0.019"/>\n'
        "     </inertial>\n"
    )


def test_later_hunks_count_the_lines_that_earlier_ones_add() -> None:
    base = '<link name="base"/>'
    edits = [Edit(span_of(base), base, base + "\n" + base), Edit(span_of("continuous"), "continuous", "fixed")]
    heads = [line for line in plain(render_diff({FILE: SOURCE}, edits)).splitlines() if line.startswith("@@")]
    assert heads == ["@@ -1,3 +1,4 @@", "@@ -11,3 +12,3 @@"]


def test_diff_of_a_text_that_changed_shows_old_and_new_only() -> None:
    edit = Edit(span_of("0.09"), "0.08", "0.019")
    assert plain(render_diff({FILE: SOURCE}, [edit])) == f"{FILE}:9\n-0.08\n+0.019\n"


def test_many_edits_are_folded() -> None:
    edits = tuple(Edit(span(i, i), "", " ") for i in range(0, 60, 10))
    assert "6 edits" in document(a_run(finding(fix=Fix("indent", Applicability.SAFE, edits)))).text


# -- the tree ----------------------------------------------------------------------------------------------------------


def test_tree_shows_links_joints_and_launch_frames() -> None:
    found = document(a_run())
    for name in ("base", "wheel", "axle", "continuous", "footprint", "launch file"):
        assert name in found.text
    assert len(found.classes("node", "link")) == 2
    assert len(found.classes("node", "launch")) == 1
    assert len(found.classes("edge", "launch")) == 2, "the transform and its legend"


def test_tree_takes_the_worst_finding_of_each_link_and_joint() -> None:
    found = document(a_run())
    assert len(found.classes("node", "error")) == 1
    assert len(found.classes("edge", "info")) == 1
    drawn = render(a_run()).split('<svg class="graph"')[1].split("</svg>")[0]
    assert "link wheel: error, the worst of 2 findings" in drawn
    assert f'<a href="#f-{finding().fingerprints[0]}">' in drawn


def test_tree_marks_a_transform_whose_text_a_finding_touches() -> None:
    typed = span_of('type="continuous"', file="car.launch")
    frames = (SceneFrame("base", "footprint", (), typed), SceneFrame("base", "map", (), None))
    inside = span_of("continuous", file="car.launch")
    conflict = finding(location=Location("node[tf]@args", inside), subjects=("node[tf]@args",))
    found = document(a_run(conflict, scenes=(scene(frames=frames),)))
    assert len(found.classes("node", "launch", "error")) == 1
    assert len(found.classes("edge", "launch", "error")) == 1
    assert "placed on base by a launch file error" in found.text.replace("  ", " ")


@pytest.mark.parametrize(
    "elsewhere", [span_of("continuous"), span_of("axle", file="car.launch"), None], ids=["file", "text", "no place"]
)
def test_tree_marks_no_transform_for_a_finding_elsewhere(elsewhere: Span | None) -> None:
    frames = (SceneFrame("base", "footprint", (), span_of("continuous", file="car.launch")),)
    other = finding(location=Location("node[tf]@args", elsewhere), subjects=("node[tf]@args",))
    assert document(a_run(other, scenes=(scene(frames=frames),))).classes("launch", "error") == []


def test_suppressed_findings_do_not_colour_the_tree() -> None:
    assert document(a_run(finding(suppressed=Suppression("source", "known")))).classes("node", "error") == []


@pytest.mark.slow
@pytest.mark.parametrize("drawn", [chain(300), star(200), scene()], ids=["chain of 300", "star of 200", "small"])
def test_boxes_neither_overlap_nor_leave_the_page(drawn: object) -> None:
    nodes = build_forest(drawn)  # type: ignore[arg-type]
    boxes, _ = lay_out_tree(nodes)
    assert max(box.x + box.width for box in boxes) <= WIDEST
    apart = (abs(b.y - a.y) >= BOX or b.x >= a.x + a.width or a.x >= b.x + b.width for a, b in combinations(boxes, 2))
    assert all(apart)
    document(a_run(scenes=(drawn,)))


def test_a_long_chain_goes_straight_down() -> None:
    boxes, is_layered = lay_out_tree(build_forest(chain(300)))
    assert not is_layered
    assert {box.x for box in boxes} == {1.0}


def test_a_loop_is_cut_where_it_closes() -> None:
    looped = scene(
        root="",
        links=(make_link("a"), make_link("b")),
        joints=(make_joint("j", "a", "b"), make_joint("k", "b", "a")),
        frames=(),
    )
    assert [(n.name, n.kind) for n in build_forest(looped)] == [("a", "link"), ("b", "link"), ("a", "repeated")]
    assert "drawn elsewhere too" in document(a_run(scenes=(looped,))).text


def test_a_joint_to_nowhere_is_drawn_to_a_missing_link() -> None:
    broken = scene(root="", links=(make_link("a"),), joints=(make_joint("j", "a", "ghost"),), frames=())
    assert [(n.name, n.kind) for n in build_forest(broken)] == [("a", "link"), ("ghost", "missing")]


def test_a_launch_file_can_stand_above_the_root_but_takes_no_link_from_its_joint() -> None:
    frames = (SceneFrame("map", "base", (), None), SceneFrame("map", "wheel", (), None))
    nodes = build_forest(scene(frames=frames))
    assert [(n.name, n.kind, n.depth) for n in nodes] == [
        ("map", "launch", 0),
        ("base", "link", 1),
        ("wheel", "link", 2),
        ("wheel", "repeated", 1),
    ]


def test_every_link_is_drawn_once() -> None:
    pieces = scene(links=tuple(make_link(n) for n in "abcd"), joints=(make_joint("j", "c", "d"),), root="", frames=())
    assert sorted(n.name for n in build_forest(pieces)) == ["a", "b", "c", "d"]


def test_long_names_are_shortened_in_the_drawing_only() -> None:
    name = "a_" + "very_" * 30 + "long_link"
    html = render(a_run(scenes=(scene(root=name, links=(make_link(name),), joints=(), frames=()),)))
    drawn = html.split('<svg class="graph"')[1].split("</svg>")[0]
    assert f"<title>link {name}</title>" in drawn
    assert f">{name}</text>" not in drawn


# -- tables ------------------------------------------------------------------------------------------------------------


def test_skipped_checks_say_why() -> None:
    text = document(a_run()).text
    assert "COL001" in text
    assert "needs --tier full" in text


def test_rules_that_fired_are_explained_and_all_are_listed() -> None:
    quiet = rule("JNT001", "zero-axis")
    found = document(a_run(finding(), rules={"INR003": rule(), "JNT001": quiet}))
    assert "rule-INR003" in found.ids
    assert "rule-JNT001" not in found.ids
    assert "JNT001 zero-axis" in found.text
    assert "no finding" in found.text
    assert "Export the tensor again." in found.text


# -- text --------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (None, "—"),
        (0.0, "0"),
        (0.497309733, "0.4973"),
        (-1.27e-18, "−1.27×10⁻¹⁸"),
        (12345.6, "12\u202f346"),
        (2.5e9, "2.5×10⁹"),
        (float("nan"), "nan"),
        (float("-inf"), "−inf"),
    ],
)
def test_numbers(value: float | None, text: str) -> None:
    assert format_number(value) == text


def test_lengths_below_a_micrometre_are_nothing() -> None:
    assert format_millimetres(-1.3e-18) == "0"
    assert format_millimetres(-0.0125) == "−12.500"


@pytest.mark.parametrize(
    ("values", "mantissas", "power"),
    [
        ((3.794e-4, 1.3886e-3, 1.6917e-3), ["0.379", "1.389", "1.692"], "×10⁻³"),
        ((0.0, 0.0, 0.0), ["0", "0", "0"], ""),
        ((1.0, 2.0, 30.0), ["1.00", "2.00", "30.00"], ""),
        ((-1e-9, 0.0, 5e7), ["0.00", "0.00", "50.00"], "×10⁶"),
    ],
)
def test_moments_share_a_power_of_ten(values: tuple[float, ...], mantissas: list[str], power: str) -> None:
    assert format_scaled(values) == (mantissas, power)


def test_markdown_of_rule_pages() -> None:
    page = "One `a < b` and *two*\nlines.\n- first\n  goes on\n- **second**\n\n```urdf\n<robot/>\n```\nsee [here](http://x.y)\n"
    assert render_markdown(page).splitlines() == [
        "<p>One <code>a &lt; b</code> and <em>two</em> lines.</p>",
        "<ul><li>first goes on</li><li><strong>second</strong></li></ul>",
        "<pre>&lt;robot/&gt;</pre>",
        "<p>see here (http://x.y)</p>",
    ]


def test_markdown_leaves_lone_signs_alone() -> None:
    assert (
        render_markdown("2 * 3 * 4, snake_case_name and a ` tick") == "<p>2 * 3 * 4, snake_case_name and a ` tick</p>"
    )


@pytest.mark.parametrize("sign", ["\u202e", "\u2066", "\u200f", "\x00", "\x1b", "\x85", "\u2028"])
def test_escaping_spells_out_what_acts_on_text(sign: str) -> None:
    assert sign not in escape_html(f"a{sign}b")


def test_names_in_other_scripts_stay_as_they_are() -> None:
    assert escape_html("колесо 轮 ü") == "колесо 轮 ü"


def test_finding_type_is_the_contract() -> None:
    """Every field of a finding reaches the page: a new field must be shown or left out on purpose."""
    shown = {
        "code",
        "name",
        "severity",
        "confidence",
        "headline",
        "message",
        "location",
        "subjects",
        "related",
        "cause",
    }
    shown |= {"consequences", "data", "fix", "model", "suppressed", "variants", "blocks_check", "occurrences"}
    assert set(Finding.__dataclass_fields__) - shown == {"message_id", "message_ids", "blames_text", "excess"}
