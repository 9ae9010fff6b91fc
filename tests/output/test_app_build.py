"""The 3D view of the report is what its source gives, and reads what the Python side packs."""

from __future__ import annotations

import base64
import json
import shutil
import subprocess
import zlib
from pathlib import Path

import numpy as np
import pytest
from conftest import unproven

from urdfcheck.facts.mesh.codec import needs_wide_indices, pack_mesh, unpack_mesh

pytestmark = [pytest.mark.slow, pytest.mark.long]

ROOT = Path(__file__).resolve().parents[2]
SOURCE = ROOT / "report-ui"
BUILT = ROOT / "urdfcheck/output/html/app.js"


@pytest.fixture(scope="module")
def source(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where the source stands with the packages that it is built with."""
    if shutil.which("node") is None or shutil.which("npm") is None:
        return unproven("app.js is built from report-ui/: there is no Node.js")
    if (SOURCE / "node_modules").is_dir():
        return SOURCE
    copy = tmp_path_factory.mktemp("ui") / "report-ui"
    shutil.copytree(SOURCE, copy)
    fetched = subprocess.run(["npm", "ci"], cwd=copy, capture_output=True, text=True, timeout=180)
    return (
        copy
        if fetched.returncode == 0
        else unproven("app.js is built from report-ui/: npm could not fetch its packages")
    )


def test_the_built_script_is_what_its_source_gives(source: Path, tmp_path: Path) -> None:
    subprocess.run(["node", "build.mjs", str(tmp_path / "app.js")], cwd=source, check=True, timeout=60)
    same = (tmp_path / "app.js").read_bytes() == BUILT.read_bytes()
    assert same, "app.js is stale: npm ci && npm run build in report-ui/"


def test_its_own_tests_pass(source: Path) -> None:
    ran = subprocess.run(["npm", "test"], cwd=source, capture_output=True, text=True, timeout=60)
    assert ran.returncode == 0, ran.stdout


# 200 x 200 corners need three bytes per index.
@pytest.mark.parametrize("side", [3, 200])
def test_what_python_packs_is_what_the_page_decodes(source: Path, side: int) -> None:
    grid = np.stack(np.meshgrid(np.arange(side), np.arange(side), indexing="ij"), axis=-1).reshape(-1, 2)
    vertices = np.column_stack((grid, np.sin(grid.sum(axis=1)))) * 0.01 - 1.0
    first = (np.arange(side - 1)[:, None] * side + np.arange(side - 1)).ravel()
    faces = np.concatenate((first[:, None] + [0, side, 1], first[:, None] + [1, side, side + 1]))
    packed = pack_mesh(vertices, faces, vertices[[[0, 1], [1, 2]]], max_faces=10**6)
    mesh = {"vertices": packed.n_vertices, "faces": packed.n_faces, "holes": packed.n_hole_edges}
    bounds = {"low": packed.low.tolist(), "high": packed.high.tolist()}
    packer = zlib.compressobj(wbits=-zlib.MAX_WBITS)
    deflated = packer.compress(b"before" + packed.data) + packer.flush()
    given = {
        "mesh": {**mesh, **bounds, "offset": len(b"before"), "wide": needs_wide_indices(packed.n_vertices)},
        "text": base64.b64encode(deflated).decode(),
    }
    ran = subprocess.run(
        ["node", "test/decode.mjs"], cwd=source, input=json.dumps(given), capture_output=True, text=True, check=True
    )
    decoded = json.loads(ran.stdout)
    points, triangles, holes = unpack_mesh(packed)
    assert needs_wide_indices(packed.n_vertices) == (side == 200)
    np.testing.assert_allclose(np.reshape(decoded["points"], (-1, 3)), points, atol=1e-6)
    np.testing.assert_array_equal(np.reshape(decoded["faces"], (-1, 3)), triangles)
    np.testing.assert_allclose(np.reshape(decoded["holes"], (-1, 2, 3)), holes, atol=1e-6)


def test_every_licence_stays_in_the_script() -> None:
    script = BUILT.read_text(encoding="ascii")
    assert "three.js authors" in script
    assert 'THE SOFTWARE IS PROVIDED "AS IS"' in script
