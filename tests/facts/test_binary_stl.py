"""Binary STL that is read in pieces."""

import hashlib
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest

from urdfcheck.facts.mesh.decode import decode_mesh
from urdfcheck.facts.mesh.formats import binary_stl
from urdfcheck.facts.mesh.formats.binary_stl import FACET, BinaryStl, read_binary_stl
from urdfcheck.system.array_cache import ArrayCache


def make_stl(count: int) -> bytes:
    facets = np.zeros(count, dtype=FACET)
    facets["corners"] = np.random.default_rng(0).random((count, 3, 3))
    return b"solid by CAD".ljust(80) + count.to_bytes(4, "little") + facets.tobytes()


@pytest.mark.parametrize("count", [0, 1, 4, 5, 11, 300])
def test_pieces_are_the_whole_file(monkeypatch: pytest.MonkeyPatch, count: int) -> None:
    monkeypatch.setattr(binary_stl, "_PIECE", 5)
    data = make_stl(count)
    seen: list[bytes] = []
    stl = read_binary_stl(BytesIO(data), len(data), lambda piece: seen.append(bytes(piece)))
    assert stl is not None
    assert b"".join(seen) == data
    assert data.startswith(stl.start)
    corners = np.frombuffer(data[84:], dtype=FACET)["corners"].reshape(-1, 3)
    assert np.array_equal(stl.take_corners(), corners)


@pytest.mark.parametrize(("size", "change"), [(684, -1), (684, 1), (34, 0), (0, 0), (84, 0)])
def test_any_other_file_and_one_that_changes_is_read_as_a_whole(size: int, change: int) -> None:
    data = (make_stl(12) + b"\0")[: size + change]
    assert read_binary_stl(BytesIO(data), size) is None


def test_a_file_is_read_once_and_its_digest_is_that_of_all_bytes(tmp_path: Path) -> None:
    file, data = tmp_path / "a.stl", make_stl(20)
    file.write_bytes(data)
    digest, content = ArrayCache().compute_digest(file, read=read_binary_stl)
    assert digest == hashlib.sha256(data).hexdigest()
    assert isinstance(content, BinaryStl)
    raw, whole = decode_mesh(content, "stl"), decode_mesh(data, "stl")
    assert np.array_equal(raw.vertices, whole.vertices)
    assert (raw.format, raw.solid_header) == (whole.format, whole.solid_header) == ("stl-binary", True)


def test_a_text_file_is_read_as_a_whole(tmp_path: Path) -> None:
    file = tmp_path / "a.stl"
    file.write_bytes(b"solid a\nendsolid a\n")
    digest, content = ArrayCache().compute_digest(file, read=read_binary_stl)
    assert (digest, content) == (hashlib.sha256(file.read_bytes()).hexdigest(), file.read_bytes())
