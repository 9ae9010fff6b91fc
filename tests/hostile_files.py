"""The hostile files as an attacker would place them: those of fixtures/hostile, and those that cannot lie in a repository."""

from __future__ import annotations

import io
import os
import shutil
import struct
import zipfile
from collections.abc import Callable
from pathlib import Path

HOSTILE = Path(__file__).parent.parent / "fixtures" / "hostile"
# The name of a variable that holds a secret, as those of a CI job do.
VARIABLE = "URDFCHECK_HOSTILE_SECRET"
# What the files would leave behind, if anything of them ran.
MARKER = "marker"

TRIANGLE = struct.pack("<12fH", 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0)
USES_MESH = """\
<?xml version="1.0"?>
<robot name="{0}">
  <link name="base">
    <collision>
      <geometry>
        <mesh filename="{1}"/>
      </geometry>
    </collision>
  </link>
</robot>
"""
XACRO = """\
<?xml version="1.0"?>
<robot name="{0}" xmlns:xacro="http://www.ros.org/wiki/xacro">
  {1}
  <link name="base"/>
</robot>
"""


def build(folder: Path, secret: str) -> Path:
    """Make ``folder/hostile``, and beside it ``folder/outside``, whose files hold the secret; return the first."""
    hostile = folder / "hostile"
    shutil.copytree(HOSTILE, hostile, ignore=shutil.ignore_patterns("*.md", "*.toml", "*.json"))
    outside(folder / "outside", secret)
    for make in MADE.values():
        make(hostile)
    return hostile


def outside(folder: Path, secret: str) -> None:
    """What lies beside a checkout: files that are not the attacker's."""
    folder.mkdir()
    (folder / "secret.txt").write_text(f"{secret}\n")
    (folder / "secret.yaml").write_text(f"token: {secret}\n")
    robot = (
        f'<robot xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:property name="token" value="{secret}"/></robot>'
    )
    (folder / "secret.xacro").write_text(robot)
    (folder / "robot.urdf").write_text(f'<robot name="{secret}"><link name="{secret}"/><link name="{secret}"/></robot>')
    (folder / "part.stl").write_bytes(secret.encode().ljust(80) + struct.pack("<I", 1) + TRIANGLE)


# -- what git does not keep --------------------------------------------------------------------------------------------


def git_configuration(hostile: Path) -> None:
    """A repository whose own settings name programs that git starts."""
    git = hostile / ".git"
    for name in ("hooks", "objects", "refs"):
        (git / name).mkdir(parents=True)
    (git / "HEAD").write_text("ref: refs/heads/main\n")
    run = str(git / "run")
    (git / "config").write_text(
        f"[core]\n\trepositoryformatversion = 0\n\tbare = false\n\tfsmonitor = {run}\n\tpager = {run}\n"
        f"\tsshCommand = {run}\n\teditor = {run}\n\thooksPath = {git / 'hooks'}\n\tattributesFile = {run}\n"
    )
    for place in (git / "run", *(git / "hooks" / n for n in ("post-index-change", "pre-commit", "post-checkout"))):
        place.write_text(f"#!/bin/sh\ntouch '{hostile / MARKER}'\n")
        place.chmod(0o755)


def file_names(hostile: Path) -> None:
    """Files whose names a shell, a CI log or a terminal would obey, and one that is no text."""
    folder = hostile / "names-of-files"
    folder.mkdir()
    names = [b"$(touch marker)\n::error::taken.urdf", b"\x1b[31m##[error]taken.urdf", b"::add-mask::a.urdf"]
    for name in (*names, b"-ohtml=taken.urdf", "\u202efdru.taken.urdf".encode(), b"\xff\xfe.urdf"):
        try:
            with open(os.path.join(os.fsencode(folder), name), "wb") as out:
                out.write(b'<robot name="r">\n  <link name="a"/>\n  <link name="a"/>\n</robot>\n')
        except OSError:  # macOS takes UTF-8 only
            continue


def links(hostile: Path) -> None:
    """Symbolic links that lead out of the folder."""
    folder = hostile / "read-links"
    folder.mkdir()
    out = Path("../../outside")
    for name in ("secret.xacro", "secret.yaml", "part.stl"):
        (folder / name).symlink_to(out / name)
    (folder / "model.urdf").symlink_to(out / "robot.urdf")
    (folder / "passwd.urdf").symlink_to("/etc/passwd")
    (folder / "circle.urdf").symlink_to("circle.urdf")
    (folder / "all").symlink_to(out)
    (folder / "mesh.urdf").write_text(USES_MESH.format("read-links", "part.stl"))
    (folder / "folder.urdf").write_text(USES_MESH.format("read-links", "all/part.stl"))
    (folder / "include.urdf.xacro").write_text(XACRO.format("r", '<xacro:include filename="secret.xacro"/>'))
    values = '<xacro:property name="v" value="${load_yaml(\'secret.yaml\')[\'token\']}"/>\n  <link name="${v}"/>'
    (folder / "yaml.urdf.xacro").write_text(XACRO.format("r", values))


def _special(hostile: Path, name: str, make: Callable[[Path], object]) -> None:
    """A model, an include, a yaml file, a mesh, a manifest and a launch file that are none."""
    folder = hostile / name
    folder.mkdir()
    for special in ("model.urdf", "part.xacro", "values.yaml", "part.stl", "start.launch"):
        make(folder / special)
    (folder / "package").mkdir()
    make(folder / "package" / "package.xml")
    (folder / "package" / "robot.urdf").write_text('<robot name="r">\n  <link name="base"/>\n</robot>\n')
    (folder / "mesh.urdf").write_text(USES_MESH.format("r", "part.stl"))
    (folder / "include.urdf.xacro").write_text(XACRO.format("r", '<xacro:include filename="part.xacro"/>'))
    values = '<xacro:property name="v" value="${load_yaml(\'values.yaml\')}"/>\n  <link name="${v}"/>'
    (folder / "yaml.urdf.xacro").write_text(XACRO.format("r", values))


def pipes(hostile: Path) -> None:
    """Named pipes: whoever opens one waits for a writer that never comes."""
    _special(hostile, "special-pipe", os.mkfifo)


def devices(hostile: Path) -> None:
    """Links to a device that never ends."""
    _special(hostile, "special-device", lambda path: path.symlink_to("/dev/zero"))


def zips(hostile: Path) -> None:
    """An archive of 64 MB of zeros in 64 kB, under the names of meshes."""
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        archive.writestr("part.dae", b"\0" * 64_000_000)
    for suffix in ("dae", "stl", "zae"):
        folder = hostile / f"mesh-zip-{suffix}"
        folder.mkdir()
        (folder / f"part.{suffix}").write_bytes(packed.getvalue())
        (folder / "robot.urdf").write_text(USES_MESH.format("r", f"part.{suffix}"))


def large(hostile: Path) -> None:
    """Ten thousand elements inside each other, a hundred thousand attributes, fifty thousand links, and long lines."""
    texts = {
        "shape-deep": '<robot name="r">\n' + "<link>" * 10_000 + "</link>" * 10_000 + "\n</robot>\n",
        "shape-attributes": '<robot name="r">\n  <link name="base" '
        + " ".join(f'a{i}=""' for i in range(100_000))
        + "/>\n</robot>\n",
        "shape-links": '<robot name="r">\n'
        + "".join(f'  <link name="l{i}"/>\n' for i in range(50_000))
        + "".join(
            f'  <joint name="j{i}" type="fixed"><parent link="l{(i - 1) // 2}"/><child link="l{i}"/></joint>\n'
            for i in range(1, 50_000)
        )
        + "</robot>\n",
        "shape-long-name": f'<robot name="r">\n  <link name="{"a" * 1_000_000}"/>\n  <joint name="j" type="x"/>\n</robot>\n',
        # Text on which a pattern with two ways to match the same takes time without end.
        "shape-long-line": f'<robot name="r">\n  <link name="b"/><link name="b"/> {"a" * 200_000}\n</robot>\n',
        "shape-long-blanks": f'<robot name="r">\n  <link name="b"/><link name="b"/>{" " * 200_000}\n</robot>\n',
        "shape-long-marks": f'<robot name="r">\n  <link name="b"/><link name="b"/>{"a = " * 50_000}\n</robot>\n',
    }
    for name, text in texts.items():
        (hostile / name).mkdir()
        (hostile / name / "robot.urdf").write_text(text)
    (hostile / "shape-comments").mkdir()
    (hostile / "shape-comments" / "robot.urdf").write_text('<robot name="r">\n' + "<!-- " * 200_000 + "\n</robot>\n")
    (hostile / "shape-comments" / "robot.launch").write_text("<launch>" + "<!-- " * 200_000 + "</launch>\n")
    (hostile / "shape-includes").mkdir()
    (hostile / "shape-includes" / "robot.urdf.xacro").write_text(
        '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">' + "<xacro:include " * 50_000 + "</robot>\n"
    )


def includes(hostile: Path) -> None:
    """A hundred files that include each other, and a model that includes one of them."""
    folder = hostile / "planner-includes"
    folder.mkdir()
    names = [f"part{number}.xacro" for number in range(100)]
    for name in names:
        inner = "".join(f'\n  <xacro:include filename="{other}"/>' for other in names if other != name)
        (folder / name).write_text(f'<robot xmlns:xacro="http://www.ros.org/wiki/xacro">{inner}\n</robot>\n')
    (folder / "robot.urdf.xacro").write_text(XACRO.format("r", '<xacro:include filename="part0.xacro"/>'))


# Each maker under the name of what it makes.
MADE: dict[str, Callable[[Path], None]] = {
    "git": git_configuration,
    "files": file_names,
    "links": links,
    "pipes": pipes,
    "devices": devices,
    "zips": zips,
    "large": large,
    "includes": includes,
}
