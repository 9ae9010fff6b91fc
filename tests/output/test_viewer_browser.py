"""The robot in 3D in a real browser: it is drawn, it moves as the model says, and findings and picture are one."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import open_watched
from numpy.typing import NDArray
from output.runs import IDENTITY, a_run, finding, info, make_inertia, make_joint, make_link, rule, scene, span_of

from urdfcheck.core import Location, Severity
from urdfcheck.core.scene import (
    Scene,
    SceneDrawing,
    SceneGround,
    SceneInertia,
    SceneMesh,
    SceneOverlap,
    ScenePreview,
    SceneShape,
)
from urdfcheck.facts.mesh.codec import needs_wide_indices, pack_mesh
from urdfcheck.output.html import render

pytestmark = [pytest.mark.slow, pytest.mark.long]

Matrix = NDArray[np.float64]
BUDGET = 210_000


def turn(axis: tuple[float, ...], angle: float) -> Matrix:
    """The rotation (4, 4) by Rodrigues' formula."""
    x, y, z = np.array(axis) / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    matrix = np.eye(4)
    matrix[:3, :3] += np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    return matrix


def move(*xyz: float) -> Matrix:
    matrix = np.eye(4)
    matrix[:3, 3] = xyz
    return matrix


def flat(matrix: Matrix) -> tuple[float, ...]:
    return tuple(map(float, matrix.ravel()))


SHOULDER = move(0.1, 0, 0.1) @ turn((1, 0, 0), 0.7)
SHOULDER_AXIS = (0.6, 0.0, 0.8)
SLIDE = move(0, 0, 0.3)
FINGER = move(0.05, 0.02, 0.1)
PRINCIPAL = turn((1, 2, 3), 0.9)[:3, :3]
COM = np.array([0.01, -0.02, 0.15])
BOX = np.array([0.12, 0.2, 0.3])  # edge lengths of the body of this inertia
MASS = 2.0


def rotated() -> SceneInertia:
    """A box of uniform density whose edges lie along no axis of its link: I1 = m (y² + z²) / 12 and so on."""
    x, y, z = BOX**2
    moments = MASS / 12 * np.array([y + z, z + x, x + y])
    order = np.argsort(moments)
    axes = PRINCIPAL[:, order]
    return make_inertia(
        mass=MASS, com=tuple(COM), moments=tuple(moments[order]), axes=tuple(axes.ravel()), tensor=(1.0,) * 6
    )


def an_open_box() -> SceneMesh:
    """A cube of 0.1 m without one of its twelve triangles."""
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float) * 0.1
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])[1:]
    packed = pack_mesh(corners, faces, corners[[[0, 1], [1, 3], [3, 0]]], max_faces=10**6)
    drawing = SceneDrawing(
        vertices=packed.n_vertices,
        faces=packed.n_faces,
        holes=packed.n_hole_edges,
        wide=needs_wide_indices(packed.n_vertices),
        low=tuple(packed.low),
        high=tuple(packed.high),
        data=packed.data,
    )
    return SceneMesh(name="meshes/tool.stl", triangles=11, extents=(0.1, 0.1, 0.1), drawings=(drawing,))


def a_robot() -> Scene:
    def drawn(kind: str, *size: float, at: Matrix | None = None, **look: Any) -> tuple[SceneShape, ...]:
        pose = IDENTITY if at is None else flat(at)
        return tuple(SceneShape(role=role, kind=kind, size=size, pose=pose, **look) for role in ("visual", "collision"))

    return scene(
        root="base",
        links=(
            make_link("base", shapes=drawn("box", 0.4, 0.3, 0.1, color=(0.1, 0.3, 0.7, 1.0))),
            make_link("arm", inertial=rotated(), shapes=drawn("cylinder", 0.04, 0.3, at=move(0, 0, 0.15))),
            make_link("tool", shapes=drawn("mesh", 1.0, 1.0, 1.0, file=0)),
            make_link("finger_a", shapes=drawn("sphere", 0.03)),
            make_link("finger_b", shapes=drawn("capsule", 0.02, 0.05)),
            make_link("camera_frame", inertial=None, shapes=()),
        ),
        joints=(
            make_joint("shoulder", "base", "arm", turn=SHOULDER_AXIS, pose=flat(SHOULDER)),
            make_joint(
                "slide", "arm", "tool", type="prismatic", turn=(0.0, 0.0, 1.0), lower=0.0, upper=0.2, pose=flat(SLIDE)
            ),
            make_joint("grip", "tool", "finger_a", turn=(0.0, 1.0, 0.0), pose=flat(FINGER)),
            make_joint(
                "follow", "tool", "finger_b", turn=(0.0, 1.0, 0.0), pose=flat(FINGER), mimic=("grip", -2.0, 0.1)
            ),
            make_joint("mount", "base", "camera_frame", type="fixed", axis=None, pose=flat(move(-0.4, 0, 0.3))),
        ),
        frames=(),
        meshes=(an_open_box(),),
    )


def about(name: str, **changes: Any) -> Any:
    subject = f"link[{name}]/inertial/inertia"
    return finding(location=Location(subject, None), subjects=(subject,), fix=None, related=(), **changes)


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("viewer") / "report.html"
    findings = (about("arm"), about("camera_frame", message="this link is a frame"))
    path.write_text(render(a_run(*findings, scenes=(a_robot(),), models=(info(),))), encoding="utf-8")
    return path


@pytest.fixture
def page(browser: Any, report: Path) -> Iterator[Any]:
    """A page for each test: what one opens or moves must not decide another."""
    with open_watched(browser, report) as page:
        yield page


def frame(page: Any, name: str) -> Matrix:
    return np.reshape(page.evaluate("name => urdfcheck.frame(name)", name), (4, 4))


def pixels(page: Any) -> list[str]:
    """The colours of a picture of 64 x 64, that of the upper left corner first."""
    colours: list[str] = page.evaluate(
        """async () => {
          const image = new Image();
          image.src = urdfcheck.picture();
          await image.decode();
          const canvas = new OffscreenCanvas(64, 64).getContext("2d");
          canvas.drawImage(image, 0, 0, 64, 64);
          const { data } = canvas.getImageData(0, 0, 64, 64);
          return Array.from({ length: 4096 }, (_, i) => data.slice(4 * i, 4 * i + 3).join());
        }"""
    )
    return colours


@pytest.mark.smoke
def test_the_robot_is_drawn(page: Any) -> None:
    assert len(set(pixels(page))) > 50
    assert page.locator("#viewer canvas").is_visible()
    assert page.evaluate("document.body.dataset.error") is None


def test_links_stand_where_numpy_puts_them(page: Any) -> None:
    np.testing.assert_allclose(frame(page, "arm"), SHOULDER, atol=1e-6)
    np.testing.assert_allclose(frame(page, "tool"), SHOULDER @ SLIDE, atol=1e-6)


def test_a_slider_moves_the_child_and_what_hangs_on_it(page: Any) -> None:
    page.locator(".uc-joints").evaluate("drawer => drawer.open = true")
    page.get_by_label("shoulder", exact=True).fill("0.8")
    page.get_by_label("Value of slide").fill("0.15")
    page.get_by_label("Value of slide").press("Enter")
    arm = SHOULDER @ turn(SHOULDER_AXIS, 0.8)
    np.testing.assert_allclose(frame(page, "arm"), arm, atol=1e-6)
    np.testing.assert_allclose(frame(page, "tool"), arm @ SLIDE @ move(0, 0, 0.15), atol=1e-6)


def test_a_number_beyond_the_limits_ends_at_them(page: Any) -> None:
    page.locator(".uc-joints").evaluate("drawer => drawer.open = true")
    page.get_by_label("Value of slide").fill("7")
    page.get_by_label("Value of slide").press("Enter")
    assert page.get_by_label("Value of slide").input_value() == "0.200"


def test_a_follower_moves_with_its_leader_and_not_by_hand(page: Any) -> None:
    page.locator(".uc-joints").evaluate("drawer => drawer.open = true")
    page.evaluate("urdfcheck.set('grip', 0.4)")
    tool = SHOULDER @ SLIDE
    np.testing.assert_allclose(frame(page, "finger_b"), tool @ FINGER @ turn((0, 1, 0), 0.1 - 2 * 0.4), atol=1e-6)
    assert page.get_by_label("follow", exact=True).is_disabled()
    assert "follows grip" in page.locator(".uc-joints").inner_text()


def test_an_inertia_box_honours_the_turned_frame_of_the_inertia(page: Any) -> None:
    page.locator("[data-layer=box]").click()
    page.evaluate("urdfcheck.set('shoulder', 0.3)")
    found = np.array(page.evaluate("urdfcheck.corners('arm')"))
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    in_link = COM + (signs * BOX / 2) @ PRINCIPAL.T
    world = SHOULDER @ turn(SHOULDER_AXIS, 0.3)
    expected = in_link @ world[:3, :3].T + world[:3, 3]
    distances = np.linalg.norm(found[:, None] - expected[None], axis=-1)
    assert distances.min(axis=0).max() < 1e-5
    page.locator("[data-layer=box]").click()


def test_a_finding_is_shown_where_it_is(page: Any) -> None:
    page.locator(".card .in-3d").first.click()
    assert page.evaluate("document.body.dataset.selected") == "arm"
    assert page.evaluate("document.body.dataset.fly") == "0"
    assert page.locator("[data-layer=box]").get_attribute("aria-pressed") == "true"
    x, y = page.evaluate("urdfcheck.pixel('arm')")
    box = page.locator("#viewer canvas").bounding_box()
    assert abs(x - box["x"] - box["width"] / 2) < box["width"] / 4
    assert abs(y - box["y"] - box["height"] / 2) < box["height"] / 4
    page.keyboard.press("Escape")
    assert page.locator("[data-layer=box]").get_attribute("aria-pressed") == "false"


def test_a_link_without_shapes_shows_its_frame(page: Any) -> None:
    before = page.evaluate("urdfcheck.pixel('base')")
    page.locator(".card .in-3d:not(.name)").nth(1).click()
    assert page.evaluate("document.body.dataset.selected") == "camera_frame"
    assert page.locator(".uc-label", has_text="camera_frame").is_visible()
    assert page.locator("[data-layer=frames]").get_attribute("aria-pressed") == "true"
    assert page.evaluate("urdfcheck.pixel('base')") != before


def test_a_click_on_the_robot_lists_what_was_found_there(page: Any) -> None:
    page.keyboard.press("h")
    page.mouse.click(*page.evaluate("urdfcheck.pixel('base')"))
    assert page.evaluate("document.body.dataset.selected") == "base"
    assert page.locator("#chip").is_visible()
    assert "base" in page.locator("#chip").inner_text()


def test_the_mouse_says_what_it_is_over(page: Any) -> None:
    page.keyboard.press("h")
    page.mouse.move(*page.evaluate("urdfcheck.pixel('arm')"))
    page.locator(".uc-tip", has_text="error INR003").wait_for()


def test_keys_switch_layers(page: Any) -> None:
    for key, layer in (("2", "collision"), ("7", "frames"), ("8", "holes")):
        button = page.locator(f"[data-layer={layer}]")
        page.keyboard.press(key)
        assert button.get_attribute("aria-pressed") == "true"
        page.keyboard.press(key)
        assert button.get_attribute("aria-pressed") == "false"


def test_a_flight_takes_its_time_where_motion_is_welcome(page: Any) -> None:
    page.emulate_media(reduced_motion="no-preference")
    # In one step: a slow machine may arrive before the next question.
    click = "document.querySelector('.card .in-3d').click(), document.body.dataset.fly"
    assert page.evaluate(click) == "1"
    page.wait_for_selector("body[data-fly='0']")
    page.emulate_media(reduced_motion="reduce")


def test_the_picture_follows_the_theme(page: Any) -> None:
    def corner(scheme: str) -> int:
        page.emulate_media(color_scheme=scheme)
        # The browser tells of the change with one of its next pictures.
        page.evaluate("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
        return sum(map(int, pixels(page)[0].split(",")))

    light, dark, again = corner("light"), corner("dark"), corner("light")
    assert dark < 200 < 600 < light
    assert again == light


def test_paper_gets_a_picture(page: Any) -> None:
    page.evaluate("dispatchEvent(new Event('beforeprint'))")
    page.emulate_media(media="print")
    picture = page.locator("#uc-print")
    assert picture.is_visible()
    assert picture.evaluate("image => image.naturalWidth") > 400
    assert picture.get_attribute("src").startswith("data:image/png;base64,")
    assert page.locator("#viewer canvas").is_hidden()
    page.emulate_media(media="screen")


@pytest.mark.parametrize("width", [390, 1280])
def test_everything_fits(page: Any, width: int) -> None:
    page.set_viewport_size({"width": width, "height": 800})
    viewer = page.locator("#viewer").bounding_box()
    for part in (".uc-view", ".uc-bar", ".uc-joints", ".uc-joint-tools"):
        box = page.locator(part).bounding_box()
        assert viewer["x"] <= box["x"]
        assert box["x"] + box["width"] <= viewer["x"] + viewer["width"]
    page.locator(".uc-joints").evaluate("drawer => drawer.open = true")
    targets = page.locator("#viewer :is(button, select, input, summary):visible")
    sizes = targets.evaluate_all(
        "all => all.map(e => [e.textContent || e.ariaLabel, e.getBoundingClientRect()]).map(([n, r]) => [n, r.width, r.height])"
    )
    assert len(sizes) > 20
    assert [name for name, across, high in sizes if min(across, high) < 24] == []
    page.set_viewport_size({"width": 1280, "height": 800})


def test_scripts_keep_their_budget(report: Path) -> None:
    blocks = re.findall(
        r'<script(?! type="application/json"| type="text/plain" id="uc-geom")[^>]*>(.*?)</script>',
        report.read_text(),
        re.S,
    )
    assert len(blocks) == 3
    assert sum(map(len, blocks)) <= BUDGET


def count_pixels(page: Any, like: tuple[int, int, int]) -> int:
    """The number of pixels of the picture in about this colour."""
    count: int = page.evaluate(
        """async (like) => {
          const image = new Image();
          image.src = urdfcheck.picture();
          await image.decode();
          const canvas = new OffscreenCanvas(image.width, image.height).getContext("2d");
          canvas.drawImage(image, 0, 0);
          const { data } = canvas.getImageData(0, 0, image.width, image.height);
          let count = 0;
          for (let i = 0; i < data.length; i += 4) if (like.every((part, k) => Math.abs(data[i + k] - part) < 6)) count++;
          return count;
        }""",
        like,
    )
    return count


def color_at(page: Any, name: str) -> list[int]:
    """The colour in the middle of a link, in the picture."""
    color: list[int] = page.evaluate(
        """async (name) => {
          const image = new Image();
          image.src = urdfcheck.picture();
          await image.decode();
          const canvas = new OffscreenCanvas(image.width, image.height).getContext("2d");
          canvas.drawImage(image, 0, 0);
          const rect = document.querySelector("#viewer canvas").getBoundingClientRect();
          const [x, y] = urdfcheck.pixel(name);
          const scale = image.width / rect.width;
          return [...canvas.getImageData((x - rect.left) * scale, (y - rect.top) * scale, 1, 1).data];
        }""",
        name,
    )
    return color


ERROR_LINE, WARNING_LINE, REPAIR_LINE = (0xD4, 0x28, 0x1E), (0xC7, 0x77, 0x00), (0x0D, 0x8F, 0x4F)


def test_a_link_with_an_error_is_outlined_and_keeps_its_material(page: Any) -> None:
    page.keyboard.press("h")
    page.mouse.move(5, 5)
    button = page.locator("[data-layer=findings]")
    outlined, own = count_pixels(page, ERROR_LINE), color_at(page, "arm")
    assert page.locator(".uc-legend li", has_text="with an error").is_visible()
    button.click()
    page.mouse.move(5, 5)
    assert count_pixels(page, ERROR_LINE) == 0
    assert color_at(page, "arm") == own
    assert page.locator(".uc-legend").is_hidden()
    button.click()
    assert outlined > 300
    page.mouse.move(*page.evaluate("urdfcheck.pixel('arm')"))
    page.locator(".uc-tip", has_text="error INR003").wait_for()
    red, green, *_ = color_at(page, "arm")
    assert red > green + 40, "a link is tinted while it is pointed at"


def test_the_focused_view_is_turned_by_keys(page: Any) -> None:
    page.keyboard.press("h")
    canvas = page.locator("#viewer canvas")
    canvas.focus()
    assert "Arrow keys orbit" in canvas.get_attribute("aria-label")
    page.keyboard.press("Tab")
    page.keyboard.press("Shift+Tab")
    outline = canvas.evaluate(
        "canvas => { const s = getComputedStyle(canvas); return [s.outlineStyle, s.outlineOffset]; }"
    )
    assert outline == ["solid", "-3px"], "outside of the canvas nothing is drawn"

    def where() -> Matrix:
        return np.array([page.evaluate("name => urdfcheck.pixel(name)", name) for name in ("base", "tool")])

    start = where()
    page.keyboard.press("ArrowRight")
    page.keyboard.press("ArrowUp")
    assert np.abs(where() - start).max() > 5
    page.keyboard.press("ArrowDown")
    page.keyboard.press("ArrowLeft")
    np.testing.assert_allclose(where(), start, atol=0.5)
    page.keyboard.press("+")
    size = np.linalg.norm(np.diff(where(), axis=0))
    assert size > 1.1 * np.linalg.norm(np.diff(start, axis=0))
    page.keyboard.press("-")
    page.keyboard.press("Shift+ArrowRight")
    shifted = where() - start
    assert shifted[:, 0].max() < -10, "the view moves to the right, and the robot to the left"
    assert np.abs(shifted[:, 1]).max() < 3
    page.keyboard.press("h")
    np.testing.assert_allclose(where(), start, atol=0.5)


def test_the_letters_of_the_axes_can_be_read(page: Any) -> None:
    def luminance(color: str) -> float:
        parts = [float(part) / 255 for part in re.findall(r"[\d.]+", color)[:3]]
        linear = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts]
        return float(np.dot(linear, [0.2126, 0.7152, 0.0722]))

    for scheme in ("dark", "light"):
        page.emulate_media(color_scheme=scheme)
        ground = luminance(page.locator("#viewer").evaluate("viewer => getComputedStyle(viewer).backgroundColor"))
        letters = page.locator(".uc-gizmo text").evaluate_all("letters => letters.map(l => getComputedStyle(l).fill)")
        assert len(letters) == 3
        for letter in map(luminance, letters):
            assert (max(letter, ground) + 0.05) / (min(letter, ground) + 0.05) >= 4.5


def test_on_a_phone_the_view_is_low_and_a_finger_turns_it(page: Any) -> None:
    page.set_viewport_size({"width": 390, "height": 844})
    assert page.locator("#viewer").bounding_box()["height"] <= 0.41 * 844
    page.locator(".uc-joints").evaluate("drawer => drawer.open = false")
    page.locator("#viewer").evaluate("viewer => viewer.scrollIntoView({ block: 'center' })")
    page.keyboard.press("h")
    before = page.evaluate("urdfcheck.pixel('tool')")
    box = page.locator("#viewer canvas").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + 0.7 * box["height"]
    touch = page.context.new_cdp_session(page)
    touch.send("Emulation.setTouchEmulationEnabled", {"enabled": True})
    touch.send("Input.dispatchTouchEvent", {"type": "touchStart", "touchPoints": [{"x": x, "y": y}]})
    for step in range(1, 9):
        touch.send("Input.dispatchTouchEvent", {"type": "touchMove", "touchPoints": [{"x": x + 10 * step, "y": y}]})
    touch.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})
    turns = page.evaluate(
        """async ([x, y]) => {
          for (let i = 0; i < 120; i++) {
            const [nowX, nowY] = urdfcheck.pixel("tool");
            if (Math.hypot(nowX - x, nowY - y) > 5) return true;
            await new Promise(requestAnimationFrame);
          }
          return false;
        }""",
        before,
    )
    touch.send("Emulation.setTouchEmulationEnabled", {"enabled": False})
    touch.detach()
    page.set_viewport_size({"width": 1280, "height": 800})
    assert turns


def repaired(code: str, message_id: str, subject: str, at: str, **changes: Any) -> tuple[Any, ScenePreview]:
    """A finding and what its repair changes; ``at``: the text that the finding is at."""
    place = span_of(at)
    found = finding(
        code=code,
        message_id=message_id,
        headline=f"{subject} is to be repaired",
        location=Location(subject, place),
        subjects=(subject,),
        severity=Severity.WARNING,
        fix=None,
        related=(),
    )
    return found, ScenePreview(code=code, message_id=message_id, at=place, **changes)


@pytest.fixture(scope="module")
def repairs(browser: Any, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    """A page of two models: repairs of a joint and of an inertia, and one with nothing but a note."""
    turned, joint = repaired(
        "SYM001", "turned", "joint[shoulder]", "axle", joint="shoulder", pose=flat(SHOULDER @ turn(SHOULDER_AXIS, 0.5))
    )
    heavy, link = repaired("INR001", "heavy", "link[arm]", "wheel", link="arm", inertial=rotated())
    impossible = make_inertia(impossible="no body has it", com=tuple(COM))
    robot = a_robot()
    links = tuple(replace(each, inertial=impossible) if each.name == "arm" else each for each in robot.links)
    ground = SceneGround(
        height=-0.05, contacts=(), support=((-0.2, -0.1), (0.2, -0.1), (0.0, 0.2)), com=(0.0, 0.0, 0.1)
    )
    models = (
        replace(robot, links=links, previews=(joint, link), ground=ground),
        replace(robot, model="clean.urdf", previews=()),
    )
    run = a_run(
        turned,
        heavy,
        scenes=models,
        models=(info(), info(path="clean.urdf", id="clean.urdf", robot="clean")),
        rules={code: rule(code, code.lower()) for code in ("SYM001", "INR001")},
    )
    path = tmp_path_factory.mktemp("repairs") / "report.html"
    path.write_text(render(run), encoding="utf-8")
    page = browser.new_page(viewport={"width": 1280, "height": 800}, reduced_motion="reduce", color_scheme="light")
    page.goto(path.as_uri())
    page.wait_for_selector("body[data-ready='1']")
    yield page
    page.close()


def choose(page: Any, code: str) -> None:
    page.locator(f".card[data-code={code}] .in-3d").first.click()


def test_what_is_not_drawn_or_not_at_zero_is_said(browser: Any, tmp_path: Path) -> None:
    gone = SceneShape(role="visual", kind="mesh", size=(1.0, 1.0, 1.0), pose=IDENTITY, mesh="package://gone/hull.stl")
    hull = make_link("hull", shapes=(gone,))
    arm, knee = (
        make_link("arm", shapes=(gone,)),
        make_joint("knee", "hull", "arm", lower=0.2, start=0.2, turn=(0.0, 1.0, 0.0)),
    )
    scenes = (
        scene(root="hull", links=(hull,), joints=(), meshes=(), frames=()),
        scene(root="hull", links=(hull, arm), joints=(knee,), meshes=(), frames=(), model="2"),
    )
    path = tmp_path / "report.html"
    path.write_text(render(a_run(scenes=scenes, models=(info(), info(id="2")))), encoding="utf-8")
    page = browser.new_page(viewport={"width": 1280, "height": 800}, reduced_motion="reduce")
    page.goto(path.as_uri())
    page.wait_for_selector("body[data-ready='1']")
    note = "1 of 1 mesh file is missing or was not read, and not drawn: hull.stl"
    assert page.locator(".uc-note").inner_text() == note
    assert page.locator(".uc-label", has_text="hull").is_visible(), "its frame is all that there is"
    page.locator("#viewer select").select_option(index=1)
    page.locator(".uc-joints > summary").click()
    said = "Zero is outside the limits of knee: drawn at the limit next to it."
    assert page.locator(".uc-joint-note").inner_text() == said
    page.close()


def test_a_joint_is_shown_before_and_after_its_repair(repairs: Any) -> None:
    choose(repairs, "SYM001")
    before, after = (repairs.get_by_role("button", name=name, exact=True) for name in ("Before", "After"))
    assert before.get_attribute("aria-pressed") == "true"
    np.testing.assert_allclose(frame(repairs, "arm"), SHOULDER, atol=1e-6)
    assert repairs.locator(".uc-label", has_text="rotated \u221228.6°").is_visible()
    assert count_pixels(repairs, REPAIR_LINE) > 100
    assert repairs.locator(".uc-legend li", has_text="The part after the repair").is_visible()
    after.click()
    repaired_arm = SHOULDER @ turn(SHOULDER_AXIS, 0.5)
    np.testing.assert_allclose(frame(repairs, "arm"), repaired_arm, atol=1e-6)
    np.testing.assert_allclose(frame(repairs, "tool"), repaired_arm @ SLIDE, atol=1e-6)
    assert count_pixels(repairs, REPAIR_LINE) == 0
    assert count_pixels(repairs, WARNING_LINE) > 100
    assert repairs.locator(".uc-legend li", has_text="The part before the repair").is_visible()
    repairs.keyboard.press("Escape")
    np.testing.assert_allclose(frame(repairs, "arm"), SHOULDER, atol=1e-6)
    assert before.is_hidden()


def test_a_held_key_shows_the_other_state(repairs: Any) -> None:
    choose(repairs, "SYM001")
    repairs.keyboard.down("b")
    np.testing.assert_allclose(frame(repairs, "arm"), SHOULDER @ turn(SHOULDER_AXIS, 0.5), atol=1e-6)
    repairs.keyboard.up("b")
    np.testing.assert_allclose(frame(repairs, "arm"), SHOULDER, atol=1e-6)
    repairs.evaluate("urdfcheck.set('shoulder', 0.3)")
    moved = SHOULDER @ turn(SHOULDER_AXIS, 0.3)
    np.testing.assert_allclose(frame(repairs, "arm"), moved, atol=1e-6)
    repairs.evaluate("urdfcheck.set('shoulder', 0)")


def test_an_inertia_is_shown_before_and_after_its_repair(repairs: Any) -> None:
    choose(repairs, "INR001")
    assert repairs.locator(".uc-label", has_text="arm: no real body").is_visible()
    assert repairs.locator(".uc-legend li", has_text="Split box").is_visible()
    repairs.get_by_role("button", name="After", exact=True).click()
    assert repairs.locator(".uc-label", has_text="arm, after").is_visible()
    assert repairs.locator(".uc-label", has_text="no real body").count() == 0
    assert repairs.locator(".uc-legend li", has_text="Split box").count() == 0
    assert repairs.locator(".uc-legend li", has_text="Inertia box after the repair").is_visible()


def test_the_ground_has_a_key(repairs: Any) -> None:
    repairs.keyboard.press("Escape")
    repairs.keyboard.press("0")
    assert repairs.locator("[data-layer=ground]").get_attribute("aria-pressed") == "true"
    assert repairs.locator(".uc-legend li", has_text="support polygon").is_visible()
    repairs.keyboard.press("0")
    assert repairs.locator("[data-layer=ground]").get_attribute("aria-pressed") == "false"


def test_no_empty_group_of_buttons_stays(repairs: Any) -> None:
    repairs.keyboard.press("Escape")
    assert repairs.locator(".uc-bar > .uc-group:visible").count() == 3
    repairs.get_by_label("Model", exact=True).select_option(index=1)
    assert repairs.locator("[data-layer=findings]").is_hidden()
    groups = repairs.locator(".uc-bar > .uc-group:visible").all()
    assert len(groups) == 2
    assert all(group.locator("button:visible").count() for group in groups)
    assert repairs.locator(".uc-legend").is_hidden()


def told(code: str, *subjects: str, related: tuple[str, ...] = (), **data: Any) -> Any:
    """A warning about parts of the robot, with what the view needs of it."""
    return finding(
        code=code,
        message_id=code.lower(),
        headline=f"{code} is here",
        location=Location(subjects[0], span_of("wheel")),
        subjects=subjects,
        severity=Severity.WARNING,
        related=tuple(Location(place, None) for place in related),
        data=data,
        fix=None,
    )


@pytest.fixture(scope="module")
def several(browser: Any, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    """A page of findings about more than their subjects, and of a robot that tips over."""
    findings = (
        told("SYM004", "link[finger_b]/inertial", between=["link[finger_a]", "link[finger_b]"]),
        told("SYM003", "link[tool]/inertial", related=("link[base]/inertial",)),
        told("COL001", "link[arm]/collision", related=("link[tool]/collision", "link[base]/collision"), link="arm"),
        told("INR006", "link[arm]/inertial/origin@xyz"),
        told("DYN002", "joint[shoulder]/limit@effort", pose={"shoulder": 0.4, "slide": 0.1}),
        told("LCH005", "node[tf]@args", link="arm", parent="base", child="base_footprint"),
    )
    overlaps = (
        SceneOverlap(("base", "tool"), (0.0, 0.0, 0.0), 0.093),
        SceneOverlap(("base", "arm"), (0.0, 0.0, 0.1), 0.02),
        SceneOverlap(("arm", "tool"), (0.1, 0.0, 0.3), 0.071),
        SceneOverlap(("arm", "finger_a"), (0.1, 0.0, 0.3), 0.092),
    )
    ground = SceneGround(
        height=-0.05,
        contacts=(),
        support=((-0.2, -0.1), (0.2, -0.1), (0.0, 0.2)),
        com=(0.9, 0.0, 0.1),
        stands=False,
    )
    moved = ScenePreview(
        code="INR006",
        message_id="inr006",
        at=span_of("wheel"),
        link="arm",
        inertial=replace(rotated(), com=(0.01, -0.02, -0.1)),
    )
    robot = replace(a_robot(), overlaps=overlaps, ground=ground, previews=(moved,))
    run = a_run(*findings, scenes=(robot,), models=(info(),), rules={f.code: rule(f.code, f.code) for f in findings})
    path = tmp_path_factory.mktemp("several") / "report.html"
    path.write_text(render(run), encoding="utf-8")
    with open_watched(browser, path) as page:
        yield page


def test_a_link_that_a_finding_names_beside_its_subject_knows_it(several: Any) -> None:
    choose(several, "SYM004")
    assert [several.locator(f"[data-layer={layer}]").get_attribute("aria-pressed") for layer in ("com", "box")] == [
        "true"
    ] * 2
    assert several.locator("[data-layer=axes]").get_attribute("aria-pressed") == "false"
    assert set(several.locator(".uc-label").all_text_contents()) == {"finger_a", "finger_b"}
    several.keyboard.press("Escape")
    several.evaluate(
        "detail => document.dispatchEvent(new CustomEvent('uc:select', { detail }))",
        {"model": "m1", "link": "finger_a", "origin": "viewer"},
    )
    assert several.locator(".card:visible").evaluate_all("all => all.map((c) => c.dataset.code)") == ["SYM004"]
    several.keyboard.press("Escape")
    several.keyboard.press("h")
    several.mouse.move(*several.evaluate("urdfcheck.pixel('finger_a')"))
    several.locator(".uc-tip", has_text="warning SYM004").wait_for()


def test_the_overlaps_of_a_finding_are_its_own_the_deepest_first(several: Any) -> None:
    several.keyboard.press("Escape")
    choose(several, "COL001")
    own = several.locator(".uc-label.error").all_inner_texts()
    assert own == ["7.1 cm deep: arm × tool", "2 cm deep: base × arm"]
    several.keyboard.press("Escape")


def test_a_com_is_shown_where_its_repair_puts_it(several: Any) -> None:
    choose(several, "INR006")
    several.get_by_role("button", name="After", exact=True).click()
    assert several.locator(".uc-label", has_text="COM moved 25 cm").count() == 1
    legend = several.locator(".uc-legend").inner_text()
    assert "Link after the repair" in legend
    assert "COM: a ball of lead" in legend
    assert count_pixels(several, REPAIR_LINE) > 100
    several.keyboard.press("Escape")


def test_a_finding_is_shown_in_its_pose_and_the_next_one_is_not(several: Any) -> None:
    choose(several, "DYN002")
    arm = SHOULDER @ turn(SHOULDER_AXIS, 0.4)
    np.testing.assert_allclose(frame(several, "arm"), arm, atol=1e-6)
    np.testing.assert_allclose(frame(several, "tool"), arm @ SLIDE @ move(0, 0, 0.1), atol=1e-6)
    choose(several, "SYM004")
    np.testing.assert_allclose(frame(several, "arm"), SHOULDER, atol=1e-6)
    several.keyboard.press("Escape")


def test_a_transform_of_a_launch_file_is_shown_at_its_link(several: Any) -> None:
    choose(several, "LCH005")
    assert several.evaluate("document.body.dataset.selected") == "base"
    several.keyboard.press("Escape")


def test_what_is_selected_is_not_under_the_buttons(several: Any) -> None:
    several.set_viewport_size({"width": 1180, "height": 800})
    for code in ("SYM004", "SYM003", "INR006", "DYN002"):
        choose(several, code)
        low = several.evaluate("document.querySelector('.uc-bar').getBoundingClientRect().bottom")
        assert several.evaluate("urdfcheck.pixel(document.body.dataset.selected)")[1] > low
        tops = [label.bounding_box()["y"] for label in several.locator(".uc-label:not([style*=hidden])").all()]
        assert min(tops) > low
    several.keyboard.press("Escape")
    several.set_viewport_size({"width": 1280, "height": 800})


def test_the_key_of_the_ground_has_the_colour_of_what_is_drawn(several: Any) -> None:
    several.keyboard.press("0")
    swatches = (several.locator(".uc-swatch.ground.tips").nth(i) for i in range(2))
    assert [dot.evaluate("dot => getComputedStyle(dot).backgroundColor") for dot in swatches] == [
        "rgb(224, 38, 60)"
    ] * 2
    assert several.locator(".uc-label", has_text="outside its support").count() == 1
    several.keyboard.press("0")


def test_names_of_strangers_stay_text(browser: Any, tmp_path: Path) -> None:
    name = "</script><img src=x onerror=\"document.title='taken'\">"
    robot = a_robot()
    hostile = replace(robot, root=name, links=(make_link(name, shapes=robot.links[0].shapes),), joints=())
    path = tmp_path / "hostile.html"
    path.write_text(render(a_run(about(name), scenes=(hostile,))), encoding="utf-8")
    page = browser.new_page(reduced_motion="reduce")
    page.goto(path.as_uri())
    page.wait_for_selector("body[data-ready='1']")
    page.locator(".card .in-3d").first.click()
    assert page.locator(".uc-label", has_text="onerror").count() == 1
    assert page.locator("img[src=x]").count() == 0
    assert page.title() != "taken"
    page.close()


def test_a_view_that_the_browser_takes_away_is_hidden(browser: Any, report: Path) -> None:
    page = browser.new_page(reduced_motion="reduce")
    page.goto(report.as_uri())
    page.wait_for_selector("body[data-ready='1']")
    page.evaluate(
        """document.querySelector("#viewer canvas").getContext("webgl2").getExtension("WEBGL_lose_context").loseContext()"""
    )
    page.wait_for_selector("body[data-error]")
    assert page.locator("#viewer").is_hidden()
    assert "Reload" in page.locator("#no-viewer").inner_text()
    page.close()


def test_without_webgl_the_page_says_so_and_the_rest_is_there(launch: Callable[..., Any], report: Path) -> None:
    without = launch("--disable-webgl", "--disable-webgl2")
    page = without.new_page()
    page.goto(report.as_uri())
    page.wait_for_selector("body[data-error]")
    assert page.locator("#viewer").is_hidden()
    assert "no WebGL" in page.locator("#no-viewer").inner_text()
    assert page.locator(".card.error").first.is_visible()
    without.close()
