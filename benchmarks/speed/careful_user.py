"""The script that a careful user writes to look over one robot: the yardstick for whole processes.

``python careful_user.py ROBOT.urdf [PACKAGE_DIR…]``: the model in Pinocchio, the tree in yourdfpy, and each mesh file once in
trimesh with its watertightness and mass properties. It is written to be quick: yourdfpy does not load the meshes a second
time, and a file that several links use is read once. It goes on where a part fails, and exits with 1 then.
"""

import sys
from pathlib import Path

import numpy as np
import pinocchio
import trimesh
from yourdfpy import URDF


def locate(filename, base, package_dirs):
    """The file that a mesh's ``filename`` means."""
    if filename.startswith("package://"):
        rest = filename.removeprefix("package://")
        return next((p for folder in package_dirs if (p := Path(folder, rest)).is_file()), Path(rest))
    return base / filename.removeprefix("file://")


def inertias(urdf):
    """Pinocchio's view: the masses and the principal moments of each body."""
    model = pinocchio.buildModelFromUrdf(str(urdf))
    for name, body in zip(model.names, model.inertias, strict=False):
        print(f"{name}: {body.mass:.6g} kg, principal moments {np.linalg.eigvalsh(body.inertia)}")


def mesh_files(urdf, package_dirs):
    """yourdfpy's view: the links, and the mesh files that they use."""
    robot = URDF.load(str(urdf), load_meshes=False)
    shapes = [shape for link in robot.robot.links for shape in (*link.visuals, *link.collisions)]
    names = {shape.geometry.mesh.filename for shape in shapes if shape.geometry.mesh is not None}
    print(f"{len(robot.robot.links)} links, {len(robot.actuated_joint_names)} driven joints, {len(names)} meshes")
    return [locate(name, urdf.parent, package_dirs) for name in sorted(names)]


def measure(path):
    """trimesh's view of one file."""
    mesh = trimesh.load(str(path), force="mesh")
    properties = mesh.mass_properties
    print(
        f"{path.name}: watertight {mesh.is_watertight}, volume {properties.volume:.6g}, centre {properties.center_mass}"
    )


def main():
    urdf, package_dirs = Path(sys.argv[1]), sys.argv[2:]
    failed = []

    def attempt(work, *arguments):
        try:
            return work(*arguments)
        except Exception as error:
            failed.append(f"{arguments[0]}: {type(error).__name__}: {error}")

    attempt(inertias, urdf)
    for path in attempt(mesh_files, urdf, package_dirs) or ():
        attempt(measure, path)
    print(*failed, sep="\n", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
