"""What MuJoCo makes of mesh paths is what the page of PKG014 says."""

from __future__ import annotations

from pathlib import Path

import pytest
from builders import find

from urdfcheck.core import Severity

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


@pytest.mark.parametrize(
    ("before", "repair"),
    [
        ("", '{0}<mujoco><compiler meshdir="left" strippath="true"/></mujoco>'),
        ("<mujoco>{}</mujoco>", '<mujoco><compiler meshdir="left" strippath="true"/></mujoco>'),
        (
            '<mujoco><compiler balanceinertia="true"/></mujoco>',
            '<mujoco><compiler balanceinertia="true" meshdir="left" strippath="true"/></mujoco>',
        ),
    ],
)
def test_the_repair_adds_no_second_element_which_mujoco_refuses(tmp_path: Path, before: str, repair: str) -> None:
    file = "package://hand/left/finger.obj"
    with pytest.raises(ValueError, match="Error opening file"):
        load_mesh_sizes(tmp_path, file, before=before.format(""))
    (tmp_path / "package.xml").write_text("<package format='3'><name>hand</name></package>", encoding="utf-8")
    (finding,) = find(
        tmp_path, (tmp_path / "hand.urdf").read_text(encoding="utf-8"), "PKG014", name="hand.urdf", targets=("mujoco",)
    )
    assert finding.fix is not None
    added = '<compiler meshdir="left" strippath="true"/>'
    told = {
        "": f"add <mujoco>{added}</mujoco> to the robot",
        "<mujoco>{}</mujoco>": f"add {added} to the <mujoco> of the robot",
    }
    assert finding.fix.title == told.get(
        before, 'write meshdir="left" strippath="true" in the <compiler> of its <mujoco>'
    )
    assert len(load_mesh_sizes(tmp_path, file, before=repair.format(""))) == 1
    with pytest.raises(ValueError, match="repeated element"):
        load_mesh_sizes(tmp_path, file, before=f"<mujoco/>{repair.format('')}")


@pytest.mark.skipif(int(mujoco.__version__.partition(".")[0]) < 4, reason="an older MuJoCo strips folders")
@pytest.mark.parametrize(
    ("options", "told", "repaired"),
    [
        ('meshdir="left/"', 'write strippath="true" beside it', 'meshdir="left/" strippath="true"'),
        ('meshdir="right"', 'which puts meshdir="right" before each path, delete that', ""),
        ('strippath="true"', "opens it beside the model: delete that", ""),
        ('meshdir="right" strippath="true"', 'puts meshdir="right" before it: delete both', ""),
        ('meshdir="."', "", 'meshdir="."'),
        ("", "", ""),
    ],
)
def test_the_path_from_the_model_is_named_with_what_mujoco_needs_for_it(
    tmp_path: Path, options: str, told: str, repaired: str
) -> None:
    (tmp_path / ".git").mkdir()
    old, new = "package://gone/left/finger.obj", "left/finger.obj"
    before = "<mujoco><compiler {}/></mujoco>"
    if options != 'meshdir="right" strippath="true"':  # it loads a file of the same name
        with pytest.raises(ValueError, match="Error opening file"):
            load_mesh_sizes(tmp_path, old, before=before.format(options))
    else:
        load_mesh_sizes(tmp_path, old, before=before.format(options))
    (finding,) = find(tmp_path, (tmp_path / "hand.urdf").read_text(encoding="utf-8"), "PKG001", name="hand.urdf")
    assert finding.fix is not None
    assert f"`{new}`" in finding.fix.title
    assert told in finding.fix.title
    assert bool(told) == ("MuJoCo" in finding.fix.title)
    (small,) = load_mesh_sizes(tmp_path, new, before=before.format(repaired))
    assert small < 0.2


@pytest.mark.parametrize("file", ["finger.obj", "gone/finger.obj"])
def test_what_mujoco_finds_by_its_options_is_missing_for_the_others_only(tmp_path: Path, file: str) -> None:
    strip = "true" if "/" in file else "false"
    before = f'<mujoco><compiler meshdir="left" strippath="{strip}"/></mujoco>'
    assert len(load_mesh_sizes(tmp_path, file, before=before)) == 1
    (finding,) = find(tmp_path, (tmp_path / "hand.urdf").read_text(encoding="utf-8"), "PKG002", name="hand.urdf")
    assert finding.consequences["mujoco"] == "loads it: its <compiler> says where the files are"
    assert finding.consequences["pinocchio"].startswith("refuses")
    assert finding.message_id == ("folder" if "/" in file else "mujoco-path")
    assert finding.severity is (Severity.ERROR if "/" in file else Severity.WARNING)


@pytest.mark.parametrize("options", ['meshdir="left"', ""])
def test_a_path_of_one_machine_is_repaired_for_mujoco_too(tmp_path: Path, options: str) -> None:
    (tmp_path / ".git").mkdir()
    own = str(tmp_path / "left" / "finger.obj")
    load_mesh_sizes(tmp_path, own, before=f"<mujoco><compiler {options}/></mujoco>")
    (finding,) = find(tmp_path, (tmp_path / "hand.urdf").read_text(encoding="utf-8"), "PKG004", name="hand.urdf")
    assert finding.fix is not None
    assert finding.fix.title.startswith("write `left/finger.obj`: the file is there")
    assert ('write strippath="true" beside it' in finding.fix.title) == bool(options)
    assert bool(finding.fix.edits) != bool(options)
