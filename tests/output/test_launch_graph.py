"""What the launch files start, drawn and told: boxes that do not touch, lines that lead from writer to reader."""

from __future__ import annotations

import itertools
import random
import re
from dataclasses import replace

import pytest
from output.documents import read
from output.runs import finding, scene, span_of

from urdfcheck.core import Location, Severity, Span, Suppression
from urdfcheck.core.scene import SceneLaunch, SceneNode, SceneParameter, ScenePort
from urdfcheck.output.html.sections.launch_section import MOST_BOXES, MOST_LINES, render_launch_files
from urdfcheck.output.html.svg.layered_layout import COLUMN_GAP, lay_out_graph
from urdfcheck.output.shared.anchors import build_finding_cards

TAG = span_of('<link name="wheel">')


def port(text: str) -> ScenePort:
    return ScenePort(*text.split(" ", 1))


def node(name: str, reads: str = "", writes: str = "", **changes: object) -> SceneNode:
    inputs, outputs = (tuple(port(p) for p in side.split(", ") if p) for side in (reads, writes))
    plain = SceneNode(
        kind="node",
        name=name,
        program=f"pkg{name}",
        purpose="does something",
        reads=inputs,
        writes=outputs,
        condition="",
        off=False,
        facts=(),
        spans=(),
    )
    return replace(plain, **changes)  # type: ignore[arg-type]


def parameter(name: str = "/robot_description", **changes: object) -> SceneParameter:
    plain = SceneParameter(
        port=ScenePort("parameter", name), origin="urdf/rover.urdf", problem="", condition="", off=False, spans=()
    )
    return replace(plain, **changes)  # type: ignore[arg-type]


NODES = (
    node("/sliders", "parameter /robot_description", "topic /joint_states"),
    node("/states", "parameter /robot_description, topic /joint_states", "topic /tf"),
    node("/rviz", "topic /tf"),
)


def drawn(*nodes: SceneNode, parameters: tuple[SceneParameter, ...] = (), findings: tuple = ()) -> str:  # type: ignore[type-arg]
    launch = SceneLaunch(file="launch/rover.launch", dialect="ros1", nodes=nodes, parameters=parameters)
    markup = render_launch_files(scene(launches=(launch,)), build_finding_cards(findings))
    read(markup)  # properly nested
    return markup


def boxes(markup: str) -> list[tuple[str, str]]:
    """Class and text of each box."""
    svg = markup[markup.index("<svg") : markup.index("</svg>")]
    groups = re.findall(r'<g class="(node [^"]*)">(.*?)</g></g>', svg, re.DOTALL)
    return [
        (kind.removeprefix("node "), " ".join(re.findall(r"<text[^>]*>(.*?)</text>", text))) for kind, text in groups
    ]


def test_without_a_launch_file_there_is_nothing() -> None:
    assert render_launch_files(scene(), ()) == ""


def test_nodes_topics_and_parameters_have_boxes_and_every_flow_a_line() -> None:
    markup = drawn(*NODES, parameters=(parameter(),))
    assert boxes(markup) == [
        *(("node", "/sliders"), ("node", "/states"), ("node", "/rviz")),
        ("parameter", "/robot_description rover.urdf"),
        *(("topic", "/joint_states"), ("topic", "/tf")),
    ]
    assert markup.count('class="edge flow"') == markup.count('class="arrow"') == 6
    told = read(markup).text
    assert "reads parameter /robot_description; publishes topic /joint_states" in told
    assert "parameter /robot_description, from urdf/rover.urdf" in told


def test_what_nobody_sets_or_publishes_is_told_and_dashed() -> None:
    markup = drawn(*NODES[1:])
    assert ("parameter", "/robot_description not set here") in boxes(markup)
    assert ("topic", "/joint_states no known publisher") in boxes(markup)
    assert "/robot_description (which is not set here)" in read(markup).text
    assert "/joint_states (which no node that is known here publishes)" in read(markup).text
    assert markup.count('stroke-dasharray="5 3"') == 2


def test_an_unknown_program_gets_no_line_and_says_so() -> None:
    markup = drawn(node("/brain", purpose=""))
    assert "edge flow" not in markup
    assert "what it reads and writes is not known here" in markup


def test_a_service_is_drawn_only_where_somebody_calls_it() -> None:
    gazebo = node("/gazebo", "service /spawn_urdf, service /spawn_sdf")
    markup = drawn(gazebo, node("/spawn", "", "service /spawn_urdf"))
    assert [text for kind, text in boxes(markup) if kind == "service"] == ["/spawn_urdf"]
    assert "/spawn_sdf" not in markup


def test_a_condition_is_dashed_and_told() -> None:
    gui = node("/gui", "", "topic /joint_states", condition="if $(arg gui)", off=True)
    markup = drawn(gui)
    assert ("node off", "/gui") in boxes(markup)
    assert "started if $(arg gui), and not by default" in read(markup).text
    assert "started under a condition" in markup[markup.index("<figcaption") :]
    assert markup.count("stroke-dasharray") == 3, "the box, its line and the legend"


def test_an_origin_that_is_not_known_is_not_drawn_as_one() -> None:
    lost = parameter(origin="$(find gone)/a.urdf", problem="package gone is not found")
    markup = drawn(*NODES, parameters=(lost,))
    assert ("parameter", "/robot_description origin unresolved") in boxes(markup)
    assert "from $(find gone)/a.urdf, package gone is not found" in read(markup).text


def test_the_worst_finding_of_a_node_is_linked() -> None:
    inside = span_of('name="wheel"')
    findings = tuple(
        finding(severity=severity, subjects=(f"node[{severity}]",), location=Location("node", inside))
        for severity in (Severity.INFO, Severity.ERROR)
    )
    markup = drawn(node("/a", spans=(TAG,)), node("/b"), findings=findings)
    assert boxes(markup) == [("node error", "/a"), ("node", "/b")]
    assert markup.count(f'<a href="#{build_finding_cards(findings)[1].anchors[0]}">') == 1
    assert "the worst of 2 findings" in markup


@pytest.mark.parametrize(
    "changes",
    [{"suppressed": Suppression("source", "known")}, {"location": Location("x", replace(TAG, file="other.launch"))}],
)
def test_other_findings_do_not_colour_a_node(changes: dict[str, object]) -> None:
    found = finding(**{"location": Location("node", TAG), **changes})
    assert boxes(drawn(node("/a", spans=(TAG,)), findings=(found,))) == [("node", "/a")]


def test_names_are_inert_and_long_ones_shortened_in_the_drawing_only() -> None:
    name = "/<script>\u202e" + "x" * 60
    bad = parameter(name, origin=name, problem=name, condition=name)
    odd = node(name, f"parameter {name}", f"topic {name}", purpose=name, condition=name, facts=((name, name),))
    markup = drawn(odd, parameters=(bad,))
    assert "<script" not in markup
    assert "\u202e" not in markup
    assert "…" in boxes(markup)[0][1]
    assert "x" * 60 in read(markup).text


@pytest.mark.parametrize(("count", "topics"), [(MOST_BOXES + 1, 0), (11, 20)])
def test_too_many_boxes_or_lines_are_listed_only(count: int, topics: int) -> None:
    assert count * topics > MOST_LINES or count > MOST_BOXES
    markup = drawn(*(node(f"/n{i}", "", ", ".join(f"topic /t{k}" for k in range(topics))) for i in range(count)))
    assert "<figure" not in markup
    assert "<details open>" in markup
    assert markup.count("<li>") == count


def test_a_file_that_says_nothing_says_so() -> None:
    assert "It starts no node." in drawn()
    launch = SceneLaunch(
        file="a.launch", dialect="ros1", nodes=(), parameters=(), notes=("The file could not be read.",)
    )
    assert "could not be read" in render_launch_files(scene(launches=(launch,)), ())


def test_findings_are_found_by_place_in_every_launch_file() -> None:
    other = Span("b.launch", 1, 1, 1, 9, 0, 8)
    nodes = (node("/a", spans=(TAG,)), node("/b", spans=(other,)))
    launches = tuple(SceneLaunch(file=f"{n.name}.launch", dialect="ros1", nodes=(n,), parameters=()) for n in nodes)
    markup = render_launch_files(
        scene(launches=launches), build_finding_cards((finding(location=Location("node", other)),))
    )
    first, second = markup.split('<div class="launch">')[1:]
    assert (boxes(first), boxes(second)) == ([("node", "/a")], [("node error", "/b")])


# -- layout ------------------------------------------------------------------------------------------------------------


def graphs() -> list[tuple[int, list[tuple[int, int]]]]:
    """Graphs by chance, with loops and parts that do not hang together."""
    chance = random.Random(7)
    found = []
    for count in (1, 2, 5, 12, 30):
        for density in (0.5, 1.5):
            edges = {(chance.randrange(count), chance.randrange(count)) for _ in range(round(count * density))}
            found.append((count, sorted(edges)))
    return found


@pytest.mark.parametrize(("count", "edges"), graphs())
def test_boxes_do_not_touch_and_lines_join_their_sides(count: int, edges: list[tuple[int, int]]) -> None:
    sizes = [(80.0 + 13 * (i % 7), 30.0 + 14 * (i % 2)) for i in range(count)]
    layout = lay_out_graph(sizes, edges)
    for (a, (w, h)), (b, (v, k)) in itertools.combinations(zip(layout.positions, sizes, strict=True), 2):
        apart = a.x + w <= b.x or b.x + v <= a.x or a.y + h / 2 <= b.y - k / 2 or b.y + k / 2 <= a.y - h / 2
        assert apart, (a, b)
    for place, (w, h) in zip(layout.positions, sizes, strict=True):
        assert -0.1 <= place.x <= layout.width - w + 0.1
        assert h / 2 - 0.1 <= place.y <= layout.height - h / 2 + 0.1
    for (a, b), curve in zip(edges, layout.curves, strict=True):
        if a == b:
            assert curve.points == ()
            continue
        first, last = (b, a) if curve.is_reversed else (a, b)
        assert curve.points[0][0] == pytest.approx(layout.positions[first].x + sizes[first][0], abs=0.2)
        assert curve.points[-1][0] == pytest.approx(layout.positions[last].x, abs=0.2)
        xs = [x for x, _ in curve.points]
        assert xs == sorted(xs), "a line never turns back"


def test_lines_pass_no_box_and_a_ladder_has_no_crossing() -> None:
    # 0 leads to 2 past 1, and 3 to 5 past 4.
    sizes = [(50.0, 30.0), (400.0, 30.0), (50.0, 30.0)] * 2
    edges = [(0, 1), (1, 2), (0, 2), (3, 4), (4, 5), (3, 5), (2, 5)]
    layout = lay_out_graph(sizes, edges)
    for curve in layout.curves:
        for (x0, y0), (x1, y1) in zip(curve.points[::2], curve.points[1::2], strict=True):
            assert y0 == y1, "straight in a column"
            for place, (w, h) in zip(layout.positions, sizes, strict=True):
                assert not (x0 < place.x + w and place.x < x1 and abs(y0 - place.y) < h / 2)


def test_a_source_stands_just_before_what_it_leads_to() -> None:
    layout = lay_out_graph([(50.0, 30.0)] * 5, [(0, 1), (1, 2), (2, 3), (4, 3)])
    assert layout.positions[4].x == layout.positions[2].x == pytest.approx(2 * (50 + COLUMN_GAP))


def test_a_loop_is_drawn_with_its_arrow_at_the_other_end() -> None:
    layout = lay_out_graph([(50.0, 30.0)] * 3, [(0, 1), (1, 2), (2, 1)])
    assert [curve.is_reversed for curve in layout.curves] == [False, False, True]
