"""The programs that are asked about planted files, and how each is installed: ``python benchmarks/rivals/programs.py FOLDER``.

Each gets an environment of its own in the folder, and none is ever a dependency of urdfcheck.
"""

from __future__ import annotations

import subprocess
import sys
import venv
from dataclasses import dataclass
from pathlib import Path

URDFCHECK = "urdfcheck"


@dataclass(frozen=True, slots=True, kw_only=True)
class Program:
    """A program that says something about a URDF file."""

    name: str
    kind: str
    """``checker``: made to find defects; ``loader``: made to read models, and refuses some."""
    requirement: str
    """The package and its version."""
    installer: str = "pip"
    """``apt`` for a library of the system: any Python loads it."""
    adapter: str
    """Module of the folder ``adapters``."""
    asked: str
    """How it is asked, in words."""

    @property
    def environment(self) -> str:
        """The folder of its environment."""
        return self.requirement.partition("==")[0]

    @property
    def version(self) -> str:
        """The version that is asked."""
        return self.requirement.partition("==")[2]


PROGRAMS = (
    Program(name="simcheck", kind="checker", requirement="simcheck==0.2.0", adapter="ask_simcheck",
            asked="its default: its own checks, and MuJoCo 4.0.0 at work"),
    Program(name="simcheck, static", kind="checker", requirement="simcheck==0.2.0", adapter="ask_simcheck_static",
            asked="`--static-only`"),
    Program(name="urdf-validator", kind="checker", requirement="urdf-validator==1.6.0", adapter="ask_urdf_validator",
            asked="`urdf_validate`: issues, and verdicts on joints, stability and workspace"),
    Program(name="isaaclab-robot-doctor", kind="checker", requirement="isaaclab-robot-doctor==0.1.0", adapter="ask_robot_doctor",
            asked="`check`, which reads no meshes"),
    Program(name="cadgen", kind="checker", requirement="cadgen==0.8.0", adapter="ask_cadgen", asked="`cadgen urdf validate`"),
    Program(name="TrueRig", kind="checker", requirement="truerig==0.1.1", adapter="ask_truerig", asked="`truerig validate`"),
    Program(name="mjcf-doctor", kind="checker", requirement="mjcf-doctor==0.2.1", adapter="ask_mjcf_doctor",
            asked="`check` of the model that MuJoCo makes of the file: it is made for MJCF, not for URDF"),
    Program(name="MuJoCo", kind="loader", requirement="mujoco==4.0.0", adapter="ask_mujoco",
            asked='its compiler with `strippath="false"`, so that it finds the meshes'),
    Program(name="Drake", kind="loader", requirement="drake==1.51.1", adapter="ask_drake",
            asked="its parser and `Finalize`, without shapes: it makes no hulls of STL files"),
    Program(name="sdformat", kind="loader", requirement="libsdformat-dev==12.3.0", installer="apt", adapter="ask_sdformat",
            asked="the library of Debian 12, by the function behind `gz sdf --check`"),
    Program(name="yourdfpy", kind="loader", requirement="yourdfpy==0.0.60", adapter="ask_yourdfpy",
            asked="its loader with collision meshes, and `validate`"),
    Program(name="check_urdf", kind="loader", requirement="cmeel-urdfdom==6.0.0", adapter="ask_check_urdf",
            asked="urdfdom's command, the parser of ROS"),
)  # fmt: skip


def find_python(program: Program, folder: Path) -> Path | None:
    """Return the Python that asks a program; None if its environment is not in the folder."""
    if program.installer == "apt":
        return Path(sys.executable)
    python = folder / program.environment / "bin" / "python"
    return python if python.exists() else None


def main() -> None:
    """Make the environments."""
    folder = Path(sys.argv[1])
    for requirement in dict.fromkeys(program.requirement for program in PROGRAMS if program.installer == "pip"):
        place = folder / requirement.partition("==")[0]
        venv.create(place, with_pip=True)
        done = subprocess.run([place / "bin" / "pip", "install", "--quiet", requirement], check=False)
        print(f"{requirement}: {'installed' if done.returncode == 0 else 'not installed'}")
    print(*(f"apt install {program.environment}" for program in PROGRAMS if program.installer == "apt"), sep="\n")


if __name__ == "__main__":
    main()
