"""Meshes: what is reported once, how bad it is, and what is measured."""

from __future__ import annotations

from pathlib import Path

import pytest
from conftest import check_text

from urdfcheck.core import Finding, Severity

# A tetrahedron with corners 0, x, y, z, as OBJ faces.
CORNERS = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
CLOSED = CORNERS + "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
OPEN = CORNERS + "f 1 2 4\nf 1 4 3\nf 2 3 4\n"
MIXED = CORNERS + "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 3 2 4\n"
INSIDE_OUT = CORNERS + "f 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n"


def shape(role: str, name: str = "part.obj", scale: str = "1 1 1") -> str:
    return f'<{role}><geometry><mesh filename="{name}" scale="{scale}"/></geometry></{role}>'


def found(folder: Path, code: str, content: str | bytes, *links: str, name: str = "part.obj") -> list[Finding]:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / name).write_bytes(content.encode() if isinstance(content, str) else content)
    text = "".join(f'<link name="l{i}">{link}</link>' for i, link in enumerate(links))
    return list(check_text(folder, f'<robot name="r">{text}</robot>', codes={code}).findings)


# -- MSH001 ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (b"", "empty"),
        (b"version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 9\n", "lfs-pointer"),
        (b"<!DOCTYPE html><html></html>", "html"),
        (b"\0" * 80 + (1).to_bytes(4, "little") + b"\0" * 100, "wrong-size"),
        (b"\0" * 80 + (7).to_bytes(4, "little") + b"\0" * 50, "truncated"),
        (b"\0" * 20, "truncated"),
    ],
)
def test_why_a_file_is_no_mesh(tmp_path: Path, content: bytes, reason: str) -> None:
    (finding,) = found(tmp_path, "MSH001", content, shape("visual", "part.stl"), name="part.stl")
    assert (finding.severity, finding.data["reason_id"]) == (Severity.ERROR, reason)


@pytest.mark.parametrize(
    ("content", "repair"),
    [(b"version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 9\n", "git lfs pull"), (b"", "again")],
)
def test_the_repair_fits_the_reason(tmp_path: Path, content: bytes, repair: str) -> None:
    (finding,) = found(tmp_path, "MSH001", content, shape("visual"))
    assert finding.fix is not None
    assert repair in finding.fix.title


def test_a_format_that_is_not_read_is_not_called_broken(tmp_path: Path) -> None:
    (finding,) = found(tmp_path, "MSH001", b"data", shape("visual", "part.wrl"), name="part.wrl")
    assert (finding.severity, finding.message_id) == (Severity.WARNING, "unread")


def test_a_broken_file_that_is_used_twice_is_one_finding(tmp_path: Path) -> None:
    (finding,) = found(tmp_path, "MSH001", b"", shape("visual") + shape("collision"), shape("visual"))
    assert len(finding.related) == 2


def test_a_missing_file_is_another_rules_business(tmp_path: Path) -> None:
    assert not found(tmp_path, "MSH001", CLOSED, shape("visual", "elsewhere.obj"))


# -- MSH002 ---------------------------------------------------------------------------------------------------------


def test_a_closed_mesh_has_no_open_edges(tmp_path: Path) -> None:
    assert not found(tmp_path, "MSH002", CLOSED, shape("visual") + shape("collision"))


def test_an_open_mesh_matters_where_it_collides(tmp_path: Path) -> None:
    (collides,) = found(tmp_path / "a", "MSH002", OPEN, shape("visual") + shape("collision"))
    (drawn,) = found(tmp_path / "b", "MSH002", OPEN, shape("visual"), shape("visual"))
    assert collides.severity == Severity.WARNING
    assert collides.location.subject == "link[l0]/collision/geometry/mesh@filename"
    assert drawn.severity == Severity.INFO


def test_the_hole_is_measured_in_metres(tmp_path: Path) -> None:
    (finding,) = found(tmp_path, "MSH002", OPEN, shape("collision", scale="0.1 0.1 0.1"))
    (loop,) = finding.data["loops"]
    assert finding.data["open_edges"] == 3
    assert loop["closed"]
    assert loop["length"] == pytest.approx(0.1 * (2 + 2**0.5), rel=1e-5)
    assert sorted(map(tuple, loop["points"])) == [(0, 0, 0), (0, 0.1, 0), (0.1, 0, 0)]


def test_the_points_of_a_hole_are_bounded(tmp_path: Path) -> None:
    ring = "".join(f"v {i} {i * i} 0\n" for i in range(500))
    fan = ring + "v 250 0 9\n" + "".join(f"f {i + 1} {(i + 1) % 500 + 1} 501\n" for i in range(500))
    (finding,) = found(tmp_path, "MSH002", fan, shape("collision"))
    assert finding.data["open_edges"] == 500
    assert len(finding.data["loops"][0]["points"]) <= 64


# -- MSH003, MSH004 -------------------------------------------------------------------------------------------------


def test_the_edges_at_which_the_winding_changes_are_counted(tmp_path: Path) -> None:
    (finding,) = found(tmp_path, "MSH003", MIXED, shape("collision"))
    assert (finding.data["wrong"], finding.data["shared"]) == (3, 6)


@pytest.mark.parametrize("content", [CLOSED, OPEN, INSIDE_OUT])
def test_a_winding_that_is_the_same_everywhere_is_consistent(tmp_path: Path, content: str) -> None:
    assert not found(tmp_path, "MSH003", content, shape("collision"))


@pytest.mark.parametrize("content", [CLOSED, OPEN, MIXED])
def test_only_a_closed_mesh_of_negative_volume_is_inside_out(tmp_path: Path, content: str) -> None:
    assert not found(tmp_path, "MSH004", content, shape("visual"))


def test_a_mirroring_scale_turns_it_the_right_way_out(tmp_path: Path) -> None:
    assert found(tmp_path / "a", "MSH004", INSIDE_OUT, shape("visual", scale="1 1 2"))
    assert not found(tmp_path / "b", "MSH004", INSIDE_OUT, shape("visual", scale="1 -1 1"))
