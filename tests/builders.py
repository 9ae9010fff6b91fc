"""Robot models as URDF text, and what urdfcheck finds in them.

A model is composed of its parts::

    robot(
        link("base"),
        link("arm", inertial(mass=2), visual(box("0.1 0.1 0.5"))),
        joint("shoulder", "base", "arm", limit(-1, 1), kind="revolute", axis="0 1 0"),
    )

Lengths are in metres, angles in radians, masses in kg, moments of inertia in kg·m², efforts in N or N·m. Several numbers are
one text, as URDF writes them: ``xyz="0 0 1"``. An argument that is empty or None leaves its attribute or element out.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from conftest import check

from urdfcheck.core import Finding

XACRO_NAMESPACE = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'

Number = float | str
"""A number, or the text that stands for it in the file where its notation matters."""


def robot(*parts: str, name: str = "r", xacro: bool = False) -> str:
    """Return a ``<robot>`` of links, joints and whatever else; ``xacro`` declares the namespace of xacro."""
    return f'<robot name="{name}"{" " + XACRO_NAMESPACE if xacro else ""}>{"".join(parts)}</robot>'


def link(name: str, *parts: str) -> str:
    """Return a ``<link>`` with an inertial, visuals and collisions."""
    inside = "".join(parts)
    return f'<link name="{name}">{inside}</link>' if inside else f'<link name="{name}"/>'


def joint(
    name: str, parent: str, child: str, *parts: str, kind: str = "fixed", xyz: str = "", rpy: str = "", axis: str = ""
) -> str:
    """Return a ``<joint>`` of type ``kind``; ``parts`` are its further elements, such as `limit`."""
    turns = f'<axis xyz="{axis}"/>' if axis else ""
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f"{origin(xyz, rpy)}{turns}{''.join(parts)}</joint>"
    )


def limit(
    lower: Number | None = None, upper: Number | None = None, effort: Number | None = 1, velocity: Number | None = 1
) -> str:
    """Return the ``<limit>`` of a joint: rad, rad, N·m and rad/s, or m, m, N and m/s."""
    return f"<limit{_attributes(lower=lower, upper=upper, effort=effort, velocity=velocity)}/>"


def origin(xyz: str = "", rpy: str = "") -> str:
    """Return an ``<origin>``, or nothing where neither is given."""
    return f"<origin{_attributes(xyz=xyz, rpy=rpy)}/>" if xyz or rpy else ""


def inertial(mass: Number = 1, moment: Number = 1, *, com: str = "", rpy: str = "", **terms: Number) -> str:
    """Return an ``<inertial>`` with three equal moments and no products, but for the ``terms`` given (``ixx`` … ``izz``)."""
    tensor = {"ixx": moment, "ixy": 0, "ixz": 0, "iyy": moment, "iyz": 0, "izz": moment} | terms
    return f'<inertial>{origin(com, rpy)}<mass value="{mass}"/><inertia{_attributes(**tensor)}/></inertial>'


def visual(geometry: str, *, xyz: str = "", rpy: str = "", name: str = "") -> str:
    """Return a ``<visual>`` that draws a shape."""
    return f"<visual{_attributes(name=name)}>{origin(xyz, rpy)}<geometry>{geometry}</geometry></visual>"


def collision(geometry: str, *, xyz: str = "", rpy: str = "", name: str = "") -> str:
    """Return a ``<collision>`` of a shape."""
    return f"<collision{_attributes(name=name)}>{origin(xyz, rpy)}<geometry>{geometry}</geometry></collision>"


def box(size: str) -> str:
    """Return a ``<box>`` with three edges."""
    return f'<box size="{size}"/>'


def sphere(radius: Number) -> str:
    """Return a ``<sphere>``."""
    return f'<sphere radius="{radius}"/>'


def cylinder(radius: Number, length: Number) -> str:
    """Return a ``<cylinder>`` about z."""
    return f'<cylinder radius="{radius}" length="{length}"/>'


def mesh(filename: str, scale: str = "") -> str:
    """Return a ``<mesh>``; ``scale`` holds three factors."""
    return f"<mesh{_attributes(filename=filename, scale=scale)}/>"


def arm_on_base(*arm: str, base: str = "", kind: str = "continuous", axis: str = "", more: str = "") -> str:
    """Return a robot of two links, ``arm`` on ``base`` by the joint ``j``, and of what ``more`` adds."""
    return robot(link("base", base), link("arm", *arm), joint("j", "base", "arm", kind=kind, axis=axis), more)


def find(
    folder: Path, model: str | Mapping[str, str], codes: str | set[str], *, name: str = "robot.urdf", **request: object
) -> list[Finding]:
    """Write a model into the folder, check it and return the findings of these codes.

    :param model: the text of the file ``name``, or the texts of several files by their paths from the folder, ``name``
        among them.
    :param request: what else the user asked for, see ``conftest.make_request``.
    """
    for path, text in ({name: model} if isinstance(model, str) else model).items():
        file = folder / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")
    run = check(folder / name, codes={codes} if isinstance(codes, str) else codes, **request)
    assert not run.failures
    return list(run.findings)


def _attributes(**values: Number | None) -> str:
    return "".join(f' {name}="{value}"' for name, value in values.items() if value not in (None, ""))
