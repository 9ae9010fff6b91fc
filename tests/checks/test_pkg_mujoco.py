"""What MuJoCo makes of mesh paths is what the page of PKG014 says."""

from __future__ import annotations

from pathlib import Path

import pytest

mujoco = pytest.importorskip("mujoco")

TETRAHEDRON = "v 0 0 0\nv {0} 0 0\nv 0 {0} 0\nv 0 0 {0}\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"
STRIP = '<mujoco><compiler strippath="true" meshdir="left"/></mujoco>'


def load_mesh_sizes(folder: Path, *files: str, before: str = "") -> list[float]:
    """Load a robot with these collision meshes, and return half the size of each along x."""
    for place, size in (("left", 0.1), ("right", 0.3)):
        (folder / place).mkdir(exist_ok=True)
        (folder / place / "finger.obj").write_text(TETRAHEDRON.format(size), encoding="utf-8")
    shapes = [f'<collision><geometry><mesh filename="{file}"/></geometry></collision>' for file in files]
    path = folder / "hand.urdf"
    path.write_text(f'<robot name="hand">{before}<link name="palm">{"".join(shapes)}</link></robot>', encoding="utf-8")
    model = mujoco.MjModel.from_xml_path(str(path))
    return [float(model.geom(i).rbound[0]) for i in range(model.ngeom)]


@pytest.mark.skipif(int(mujoco.__version__.partition(".")[0]) < 4, reason="an older MuJoCo strips folders")
def test_mujoco_resolves_no_uri_and_keeps_folders_unless_it_is_told_to_strip_them(tmp_path: Path) -> None:
    small, large = load_mesh_sizes(tmp_path, "left/finger.obj", "right/finger.obj")
    assert large == pytest.approx(3 * small, rel=0.01)
    with pytest.raises(ValueError, match="Error opening file"):
        load_mesh_sizes(tmp_path, "package://hand/left/finger.obj")
    with pytest.raises(ValueError, match="Error opening file"):
        load_mesh_sizes(
            tmp_path, "package://hand/left/finger.obj", before=STRIP.replace('strippath="true"', 'strippath="false"')
        )


def test_mujoco_takes_one_file_for_two_of_one_name_if_it_strips_folders(tmp_path: Path) -> None:
    files = "package://hand/left/finger.obj", "package://hand/right/finger.obj"
    first, second = load_mesh_sizes(tmp_path, *files, before=STRIP)
    assert first == second
