"""The robot as a PNG: what is nearest is seen, where it stands, in its colour."""

from __future__ import annotations

import base64
import struct
import zlib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from output.documents import read
from output.runs import IDENTITY, a_run, info, make_link, scene

from urdfcheck.cli.output_files import CheckedFolders, parse_run_outputs, write_report
from urdfcheck.core import UrdfcheckError
from urdfcheck.core.scene import Scene, SceneDrawing, SceneMesh, SceneShape
from urdfcheck.facts.mesh.codec import pack_mesh
from urdfcheck.output import html
from urdfcheck.output.png import render
from urdfcheck.output.shared import robot_picture

pytestmark = pytest.mark.slow

RED, BLUE = (1.0, 0.0, 0.0, 1.0), (0.0, 0.0, 1.0, 1.0)
WIDTH, HEIGHT = 160, 120


def decoded(data: bytes) -> NDArray[np.uint8]:
    """The pixels (rows, columns, 4) of a PNG, read as strictly as the standard asks.

    :raises ValueError: when it is none."""
    if data[:8] != b"\x89PNG\r\n\x1a\n":
        raise ValueError("no PNG")
    at, packed, size = 8, b"", (0, 0)
    while at < len(data):
        (length,), kind = struct.unpack(">I", data[at : at + 4]), data[at + 4 : at + 8]
        body = data[at + 8 : at + 8 + length]
        if zlib.crc32(kind + body) != struct.unpack(">I", data[at + 8 + length : at + 12 + length])[0]:
            raise ValueError(f"checksum of {kind!r}")
        if kind == b"IHDR":
            *size, depth, colour, compression, filtering, interlace = struct.unpack(">IIBBBBB", body)
            assert (depth, colour, compression, filtering, interlace) == (8, 6, 0, 0, 0)
        packed += body if kind == b"IDAT" else b""
        at += 12 + length
    assert kind == b"IEND"
    lines = np.frombuffer(zlib.decompress(packed), dtype=np.uint8).reshape(size[1], 1 + size[0] * 4)
    assert (lines[:, 0] == 2).all()
    return np.cumsum(lines[:, 1:], axis=0, dtype=np.uint8).reshape(size[1], size[0], 4)


def moved(x: float = 0.0, y: float = 0.0, z: float = 0.0) -> tuple[float, ...]:
    return (1.0, 0.0, 0.0, x, 0.0, 1.0, 0.0, y, 0.0, 0.0, 1.0, z, 0.0, 0.0, 0.0, 1.0)


def sphere(colour: tuple[float, ...] | None, pose: tuple[float, ...] = IDENTITY, role: str = "visual") -> SceneShape:
    return SceneShape(role=role, kind="sphere", size=(0.5,), pose=pose, color=colour)


def make_scene(*links: tuple[SceneShape, ...], meshes: tuple[SceneMesh, ...] = ()) -> Scene:
    return scene(links=tuple(make_link(f"l{i}", shapes=shapes) for i, shapes in enumerate(links)), meshes=meshes)


def pixels(of: Scene) -> NDArray[np.uint8]:
    found = decoded(robot_picture.render_scene(of, WIDTH, HEIGHT))
    assert found.shape == (HEIGHT, WIDTH, 4)
    return found


def middle(of: Scene) -> list[int]:
    return [int(v) for v in pixels(of)[HEIGHT // 2, WIDTH // 2]]


def cube(flip: bool = False) -> SceneMesh:
    """A mesh of 200 x 200 x 200 units."""
    corners = np.array([(x, y, z) for x in (-100, 100) for y in (-100, 100) for z in (-100, 100)], dtype=float)
    quads = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
    faces = np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])
    packed = pack_mesh(corners, faces[:, ::-1] if flip else faces, np.zeros((0, 2, 3)), max_faces=1000)
    low, high = tuple(map(float, packed.low)), tuple(map(float, packed.high))
    drawing = SceneDrawing(
        vertices=packed.n_vertices,
        faces=packed.n_faces,
        holes=0,
        wide=False,
        low=low,
        high=high,
        data=packed.data,
        color=RED,
    )
    return SceneMesh(
        name="cube.stl",
        digest="cube",
        format="stl",
        bytes=684,
        triangles=12,
        extents=(200.0,) * 3,
        unit=None,
        watertight=True,
        drawings=(drawing,),
    )


def test_a_robot_fills_the_picture_on_a_transparent_ground() -> None:
    found = pixels(make_scene((sphere(RED),)))
    red, green, blue, opacity = middle(make_scene((sphere(RED),)))
    assert red > 100
    assert (green, blue, opacity) == (0, 0, 255)
    assert found[0, 0].tolist() == [0, 0, 0, 0]
    rows = np.flatnonzero(found[..., 3].any(axis=1))
    assert len(rows) == pytest.approx(0.94 * HEIGHT, abs=2)
    # An edge is as opaque as it covers its pixel.
    assert 0 < np.count_nonzero((found[..., 3] > 0) & (found[..., 3] < 255)) < 400


@pytest.mark.parametrize("order", [1, -1])
def test_what_is_nearer_hides_what_is_behind(order: int) -> None:
    towards = np.array(robot_picture._EYE)
    near, far = sphere(RED, moved(*towards)), sphere(BLUE, moved(*-towards))
    assert middle(make_scene(*[(s,) for s in (near, far)][::order]))[2] == 0


def test_links_stand_where_their_frames_are() -> None:
    left = make_link("left", shapes=(sphere(RED),), world=moved(y=-1.5))
    right = make_link("right", shapes=(sphere(BLUE),), world=moved(y=1.5))
    found = pixels(scene(links=(left, right, make_link("nowhere", shapes=(sphere(RED),), world=None))))
    # Along +y is to the right of the picture, seen from the front and the right.
    red, blue = (np.flatnonzero((found[..., i] > 60).any(axis=0)) for i in (0, 2))
    assert red.max() < WIDTH / 2 < blue.min()


def test_a_mesh_is_drawn_alike_when_it_is_inside_out() -> None:
    shape = SceneShape(role="visual", kind="mesh", size=(0.001,) * 3, pose=IDENTITY, mesh="cube.stl", file=0)
    sides = [pixels(make_scene((shape,), meshes=(cube(flip),))) for flip in (False, True)]
    assert np.array_equal(*sides)
    assert len({tuple(p) for p in sides[0][sides[0][..., 3] == 255][:, :3].tolist()}) >= 3, (
        "three sides, each in its light"
    )


def test_what_collides_is_shown_only_where_nothing_is_drawn() -> None:
    bump = sphere(BLUE, role="collision")
    assert middle(make_scene((bump,)))[2] > 60
    assert middle(make_scene((bump,), (sphere(RED, moved(z=0.001)),)))[2] == 0


def test_other_shapes_are_drawn_too() -> None:
    for kind, size in (("box", (1.0, 1.0, 1.0)), ("cylinder", (0.5, 1.0)), ("capsule", (0.5, 1.0))):
        assert middle(make_scene((SceneShape(role="visual", kind=kind, size=size, pose=IDENTITY),)))[3] == 255


def test_a_box_is_as_large_as_it_says() -> None:
    corners = np.concatenate(
        [
            c
            for c, _, _ in robot_picture._iter_triangles(
                make_scene((SceneShape(role="visual", kind="box", size=(1.0, 2.0, 3.0), pose=IDENTITY),))
            )
        ]
    )
    assert np.abs(corners).reshape(-1, 3).max(axis=0) == pytest.approx((0.5, 1.0, 1.5))


@pytest.mark.parametrize(
    "shapes",
    [
        (),
        (SceneShape(role="visual", kind="", size=(), pose=()),),
        (sphere(RED, pose=()),),
        (sphere(RED, moved(float("nan"))),),
        (sphere(RED, moved(1e80)),),
        (SceneShape(role="visual", kind="mesh", size=(1.0, 1.0, 1.0), pose=IDENTITY, mesh="package://gone/a.stl"),),
        (SceneShape(role="visual", kind="mesh", size=(), pose=IDENTITY, mesh="cube.stl", file=0),),
    ],
)
def test_what_has_no_place_or_size_gives_no_picture(shapes: tuple[SceneShape, ...]) -> None:
    assert robot_picture.render_scene(make_scene(shapes, meshes=(cube(),))) == b""


def test_a_point_is_a_picture_of_nothing_much() -> None:
    assert (
        decoded(
            robot_picture.render_scene(
                make_scene((SceneShape(role="visual", kind="box", size=(0.0, 0.0, 0.0), pose=IDENTITY),)), 8, 8
            )
        ).max()
        == 0
    )


def test_too_much_to_fill_is_left_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(robot_picture, "_MOST", 100)
    assert robot_picture.render_scene(make_scene((sphere(RED),))) == b""


@pytest.mark.parametrize(("many", "shape"), [(300, "box"), (1_200, "sphere")])
def test_a_stack_of_shapes_takes_no_long_time(many: int, shape: str) -> None:
    """Each box fills half of the picture; each sphere has some thousand triangles."""
    size = (1.0, 1.0, 1.0) if shape == "box" else (1.0,)
    assert (
        robot_picture.render_scene(
            make_scene((SceneShape(role="visual", kind=shape, size=size, pose=IDENTITY),) * many)
        )
        == b""
    )


def test_a_run_of_one_model_has_a_picture_and_any_other_says_why_not() -> None:
    drawn = make_scene((sphere(RED),))
    assert decoded(render(a_run(scenes=(drawn,)))).shape == (900, 1200, 4)
    with pytest.raises(UrdfcheckError, match="there are 2"):
        render(a_run(models=(info(), info(path="b.urdf")), scenes=(drawn,)))
    with pytest.raises(UrdfcheckError, match=r"rover\.urdf has no shape"):
        render(a_run(scenes=(make_scene(()),)))


def test_the_command_writes_it_as_it_is(tmp_path: Path) -> None:
    ((name, file),) = parse_run_outputs([f"png={tmp_path / 'robot.png'}"], [])
    write_report(a_run(scenes=(make_scene((sphere(RED),)),)), name, file, checked=CheckedFolders())
    assert decoded(file.read_bytes()).shape == (900, 1200, 4)


def test_two_versions_differ_in_lines_and_a_pale_shade() -> None:
    """What both have is drawn as ever; the first alone has orange, the second alone green."""
    here, there = (make_scene((sphere(RED), sphere(RED, moved(x)))) for x in (3.0, 3.5))
    picture = decoded(robot_picture.render_versions(here, there, IDENTITY, 320, 240)).reshape(-1, 4).astype(int)
    lines = picture[picture[:, 3] == 255][:, :3]
    orange, green = (int((np.abs(lines - colour).max(axis=1) < 30).sum()) for colour in ((217, 119, 6), (18, 140, 80)))
    assert min(orange, green) > 20
    assert (picture[:, 3] == 70).sum() > 20
    same = decoded(robot_picture.render_versions(here, here, IDENTITY, 320, 240))
    assert (same == decoded(robot_picture.render_scene(here, 320, 240))).all()
    assert robot_picture.render_versions(here, make_scene(()), IDENTITY) == b""
    # Another root is no difference.
    lifted = make_scene((sphere(RED, moved(0.0, 0.0, 2.0)), sphere(RED, moved(3.0, 0.0, 2.0))))
    down = decoded(robot_picture.render_versions(lifted, here, moved(0.0, 0.0, -2.0), 320, 240))
    assert (down == same).all()


def test_a_part_that_others_hide_in_one_version_is_dashed() -> None:
    """A ball within a ball; outside, or elsewhere in it, in the other version."""
    around = SceneShape(role="visual", kind="sphere", size=(1.2,), pose=IDENTITY, color=BLUE)

    def count_lines(before: float, after: float) -> tuple[int, int]:
        versions = (make_scene((around,), (sphere(RED, moved(x)),)) for x in (before, after))
        picture = decoded(robot_picture.render_versions(*versions, IDENTITY, 320, 240)).astype(int)
        # Only what is nearer to the middle of the large ball than its own outline.
        blue = np.argwhere(picture[..., 2] > 100)
        row, column = blue.mean(axis=0).astype(int)
        seen = picture[row - 40 : row + 40, column - 40 : column + 40, :3]
        colours = ((217, 119, 6), (18, 140, 80))
        orange, green = (int((np.abs(seen - colour).max(axis=-1) < 40).sum()) for colour in colours)
        return orange, green

    assert count_lines(0.0, 0.0) == (0, 0)
    orange, green = count_lines(0.0, 0.3)
    assert min(orange, green) > 10
    orange, green = count_lines(0.0, 4.0)
    assert orange > 10
    assert green == 0


@pytest.mark.parametrize(("robots", "expected"), [(1, 1), (2, 0)])
def test_a_report_of_one_model_has_it_for_browsers_without_3d(robots: int, expected: int) -> None:
    infos = tuple(info(id=f"{i}", path=f"{i}.urdf", robot="<b>") for i in range(robots))
    scenes = tuple(replace(make_scene((sphere(RED),)), model=f"{i}") for i in range(robots))
    pictures = read(html.render(a_run(models=infos, scenes=scenes))).all("img")
    assert len(pictures) == expected
    for picture in pictures:
        assert decoded(base64.b64decode(picture["src"].removeprefix("data:image/png;base64,"))).shape == (640, 960, 4)
        assert picture["alt"] == "<b> with all joints at zero, seen from the front, right and above"


@pytest.mark.parametrize("broken", [b"", b"GIF89a", b"last byte"])
def test_the_reader_of_these_tests_refuses_what_is_no_png(broken: bytes) -> None:
    good = robot_picture.render_scene(make_scene((sphere(RED),)), 8, 8)
    with pytest.raises((ValueError, struct.error)):
        decoded(good[:-30] + b"x" + good[-29:] if broken == b"last byte" else broken)
