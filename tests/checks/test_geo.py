"""GEO004: which meshes are dense, and which primitive is proposed."""

from __future__ import annotations

from math import cos, pi, sin
from pathlib import Path

import pytest
from conftest import check_text

from urdfcheck.core import Finding


def cylinder(sides: int, radius: float = 0.03, length: float = 0.01) -> str:
    """A cylinder about z as OBJ: 4 sides - 4 triangles."""
    rim = [(radius * cos(2 * pi * i / sides), radius * sin(2 * pi * i / sides)) for i in range(sides)]
    corners = [f"v {x} {y} {z}" for z in (-length / 2, length / 2) for x, y in rim]
    around = [f"f {i + 1} {(i + 1) % sides + 1} {(i + 1) % sides + sides + 1} {i + sides + 1}" for i in range(sides)]
    caps = [
        "f " + " ".join(str(i) for i in range(sides, 0, -1)),
        "f " + " ".join(str(i + sides + 1) for i in range(sides)),
    ]
    return "\n".join((*corners, *around, *caps)) + "\n"


def shape(role: str, name: str, scale: str = "1 1 1") -> str:
    return f'<{role}><geometry><mesh filename="{name}" scale="{scale}"/></geometry></{role}>'


def found(folder: Path, content: str, link: str) -> list[Finding]:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "part.obj").write_text(content)
    (folder / "copy.obj").write_text(content)
    return list(check_text(folder, f'<robot name="r"><link name="a">{link}</link></robot>', codes={"GEO004"}).findings)


@pytest.mark.parametrize(("sides", "dense"), [(126, False), (127, True)])
def test_dense_begins_above_500_triangles(tmp_path: Path, sides: int, dense: bool) -> None:
    link = shape("visual", "part.obj") + shape("collision", "part.obj")
    assert bool(found(tmp_path, cylinder(sides), link)) == dense


def test_a_collision_mesh_of_its_own_is_no_copy_of_the_drawing(tmp_path: Path) -> None:
    assert not found(tmp_path, cylinder(200), shape("visual", "part.obj") + shape("collision", "copy.obj"))


def test_a_cylinder_is_recognised_with_its_size_in_metres(tmp_path: Path) -> None:
    scale = "0.001 0.001 0.001"
    link = shape("visual", "part.obj", scale) + shape("collision", "part.obj", scale)
    (finding,) = found(tmp_path, cylinder(200, 30, 10), link)
    assert finding.fix is not None
    assert '<cylinder radius="0.030" length="0.010"/> along z' in finding.fix.title


def test_a_cylinder_that_the_scale_flattens_is_none(tmp_path: Path) -> None:
    link = shape("visual", "part.obj", "1 2 1") + shape("collision", "part.obj", "1 2 1")
    (finding,) = found(tmp_path, cylinder(200), link)
    assert finding.message_id == "dense"
