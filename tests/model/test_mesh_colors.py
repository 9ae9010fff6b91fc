"""The colours that material libraries give to the faces of OBJ."""

from __future__ import annotations

from pathlib import Path

import pytest

from urdfcheck.facts.mesh.measure import measure_mesh
from urdfcheck.model import mesh_colors
from urdfcheck.source.package.finder import PackageFinder


def test_a_library_is_read_once_in_whatever_spellings_it_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    named = "mtllib a.mtl ./a.mtl\nmtllib x/../a.mtl\n"
    mesh, library = tmp_path / "a.obj", tmp_path / "a.mtl"
    (tmp_path / "x").mkdir()
    mesh.write_text(f"{named}v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n")
    library.write_text("newmtl red\nKd 1 0 0\n")
    read: list[Path] = []

    def count_reading(path: Path, limit: int) -> str:
        read.append(path)
        return path.read_text()

    monkeypatch.setattr(mesh_colors, "read_text_or_nothing", count_reading)
    facts = measure_mesh(mesh.read_bytes(), "obj")
    colors = mesh_colors.find_mesh_colors(mesh, facts, PackageFinder(mesh))
    assert colors is not None
    assert colors[1].tolist() == [[1.0, 0.0, 0.0, 1.0]]
    assert len(read) == 1
