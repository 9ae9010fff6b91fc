"""Runs built by hand, so that an output is tested without any check."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from urdfcheck.core import (
    Applicability,
    Cause,
    Confidence,
    Edit,
    Finding,
    Fix,
    Location,
    ModelInfo,
    NotChecked,
    Rule,
    Run,
    Severity,
    SkippedCheck,
    Span,
)
from urdfcheck.core.scene import Scene, SceneFrame, SceneInertia, SceneJoint, SceneLink, SceneMesh, SceneShape

SOURCE = """\
<robot name="rover">
  <link name="base"/>
  <!-- the wheel
       turns -->
  <link name="wheel">
    <inertial>
      <mass value="-1"/>
      <inertia ixx="0.01" ixy="0" ixz="0"
               iyy="0.01" iyz="0" izz="0.09"/>
    </inertial>
  </link>
  <joint name="axle" type="continuous"/>
</robot>
"""
FILE = "rover/rover.urdf"
MODEL = "rover/rover.urdf"

PAGE = """# INR003 triangle-inequality

```toml
severity = "error"
```

## What it checks

The *principal moments* satisfy `I1 + I2 >= I3`.

## Why it matters

- MuJoCo refuses the model,
  and says so
- **Drake** too, see [the manual](https://example.org/manual)

## How to fix

Export the tensor again.
"""


def span_of(text: str, source: str = SOURCE, file: str = FILE) -> Span:
    """The span of the first occurrence of ``text``."""
    start = source.index(text)
    return span(start, start + len(text), source, file)


def span(start: int, end: int, source: str = SOURCE, file: str = FILE) -> Span:
    def position(offset: int) -> tuple[int, int]:
        return source.count("\n", 0, offset) + 1, offset - (source.rfind("\n", 0, offset) + 1) + 1

    return Span(file, *position(start), *position(end), start, end)


def rule(code: str = "INR003", name: str = "triangle-inequality", page: str = PAGE, **changes: Any) -> Rule:
    plain = Rule(
        code=code,
        name=name,
        severity=Severity.ERROR,
        confidence=Confidence.PROOF,
        status="stable",
        since="0.1.0",
        scopes=("model",),
        needs=("source",),
        tags=(),
        hidden_by=(),
        concerns=(),
        depends_on_targets=False,
        fix=Applicability.DISPLAY,
        options={},
        messages={},
        headlines={},
        fixes={},
        causes={},
        consumers={},
        stem="",
        page=page,
    )
    return replace(plain, **changes)


def finding(**changes: Any) -> Finding:
    """An error with everything that a finding can have; ``changes`` replace fields."""
    plain = Finding(
        code="INR003",
        name="triangle-inequality",
        severity=Severity.ERROR,
        confidence=Confidence.PROOF,
        message_id="violated",
        headline="wheel: no body can have this inertia (12 % short)",
        message="link wheel: principal moments break the triangle inequality",
        location=Location("link[wheel]/inertial/inertia", span_of("0.09"), (span_of('<link name="wheel">'),)),
        subjects=("link[wheel]/inertial/inertia",),
        related=(Location("link[wheel]/inertial/mass", span_of('<mass value="-1"/>')),),
        cause=Cause("lost-point", "a decimal point was lost in izz"),
        consequences={"mujoco": "refuses to compile", "drake": "replaces the inertia"},
        data={},
        fix=Fix("put the point back", Applicability.UNSAFE, (Edit(span_of("0.09"), "0.09", "0.019"),)),
        model=MODEL,
    )
    return replace(plain, **changes)


IDENTITY = (1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0)


def make_inertia(**changes: Any) -> SceneInertia:
    plain = SceneInertia(
        mass=0.0283,
        com=(0.0001, 0.0, -0.0125),
        tensor=(6.6e-6, 0.0, 0.0, 6.7e-6, 0.0, 1.27e-5),
        moments=(6.6e-6, 6.7e-6, 1.27e-5),
        axes=(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0),
    )
    return replace(plain, **changes)


def make_link(name: str, **changes: Any) -> SceneLink:
    plain = SceneLink(
        name=name,
        inertial=make_inertia(),
        density=1000.0,
        drawn_com=(0.0, 0.0, -0.0125),
        drawn_moments=(6.6e-6, 6.6e-6, 1.3e-5),
        world=IDENTITY,
        shapes=(SceneShape(role="visual", kind="mesh", size=(1.0, 1.0, 1.0), pose=IDENTITY, mesh="wheel.stl", file=0),),
        span=None,
    )
    return replace(plain, **changes)


def make_joint(name: str, parent: str, child: str, **changes: Any) -> SceneJoint:
    plain = SceneJoint(
        name=name,
        type="revolute",
        parent=parent,
        child=child,
        axis=(0.0, 1.0, 0.0),
        lower=-1.5708,
        upper=1.5708,
        span=None,
    )
    return replace(plain, **changes)


def scene(**changes: Any) -> Scene:
    plain = Scene(
        model=MODEL,
        root="base",
        links=(make_link("base", inertial=make_inertia(mass=0.5)), make_link("wheel")),
        joints=(make_joint("axle", "base", "wheel", type="continuous", lower=None, upper=None),),
        frames=(SceneFrame("base", "footprint", IDENTITY, None),),
        meshes=(
            SceneMesh(
                name="meshes/wheel.stl",
                digest="c0ffee",
                format="stl",
                bytes=642084,
                triangles=12840,
                extents=(0.06, 0.06, 0.025),
                unit=None,
                watertight=True,
            ),
        ),
    )
    return replace(plain, **changes)


def chain(length: int) -> Scene:
    """``length`` links, one on the other."""
    return scene(
        root="l0",
        links=tuple(make_link(f"l{i}") for i in range(length)),
        joints=tuple(make_joint(f"j{i}", f"l{i - 1}", f"l{i}") for i in range(1, length)),
        frames=(),
    )


def star(arms: int) -> Scene:
    """A base with ``arms`` links on it."""
    return scene(
        links=(make_link("base"), *(make_link(f"arm_{i}") for i in range(arms))),
        joints=tuple(make_joint(f"j{i}", "base", f"arm_{i}") for i in range(arms)),
        frames=(),
    )


def info(**changes: Any) -> ModelInfo:
    return replace(
        ModelInfo(
            path=FILE, robot="rover", args={}, links=2, joints=1, mass=0.5283, status="checked", id=MODEL, seconds=0.1
        ),
        **changes,
    )


def a_run(*findings: Finding, **changes: Any) -> Run:
    """A run over one model with the given findings; without any, one error, one warning and one info."""
    if not findings:
        findings = (
            finding(),
            finding(
                code="INR001",
                name="mass-not-positive",
                severity=Severity.WARNING,
                location=Location("link[wheel]/inertial/mass@value", span_of("-1")),
                subjects=("link[wheel]/inertial/mass@value",),
                fix=None,
            ),
            finding(
                severity=Severity.INFO,
                confidence=Confidence.HEURISTIC,
                message_id="other",
                location=Location("joint[axle]", None),
                subjects=("joint[axle]",),
                cause=None,
                consequences={},
                related=(),
                fix=Fix("think about it"),
            ),
        )
    plain = Run(
        models=(info(),),
        findings=findings,
        skipped=(SkippedCheck("COL001", MODEL, "needs --tier full"),),
        rules={"INR001": rule("INR001", "mass-not-positive"), "INR003": rule()},
        versions={"urdfcheck": "0.1.0", "python": "3.12.0"},
        sources={FILE: SOURCE},
        scenes=(scene(),),
        seconds=0.25,
        tier="mesh",
        units=1,
    )
    return replace(plain, **changes)


# One model of two was not checked, for want of an argument; a macro file is used by no checked model.
NOT_CHECKED = a_run(
    finding(
        code="XAC010",
        name="argument-without-default",
        message_id="missing",
        message="argument side has no default",
        subjects=("robot",),
        location=Location("robot", span_of('<robot name="rover">')),
        related=(),
        cause=None,
        consequences={},
        model="arm.urdf.xacro",
        fix=None,
        blocks_check=True,
    ),
    models=(
        info(
            path="arm.urdf.xacro",
            id="arm.urdf.xacro",
            robot="",
            status="needs-arguments",
            links=0,
            joints=0,
            mass=None,
            not_checked=NotChecked("argument side has no default", "--arg side:=…"),
        ),
        info(),
    ),
    unused_macro_files=("wheel.xacro",),
    skipped=(),
    units=2,
    unit_ids=frozenset({"arm.urdf.xacro", MODEL}),
)
ACCEPTED = replace(
    NOT_CHECKED,
    findings=(replace(NOT_CHECKED.findings[0], severity=Severity.WARNING),),
    models=(
        replace(
            NOT_CHECKED.models[0],
            not_checked=NotChecked("argument side has no default", "--arg side:=…", accepted=True),
        ),
        info(),
    ),
)
UNUSED_MACROS = replace(
    a_run(), findings=(), skipped=(), units=1, unit_ids=frozenset({MODEL}), unused_macro_files=("wheel.xacro",)
)
