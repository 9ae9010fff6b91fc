"""MSH011 reports meshes that the target programs cannot load."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.text import join_names
from urdfcheck.facts.mesh.measure import MeshFacts
from urdfcheck.model import Model
from urdfcheck.model.meshes import MeshUse
from urdfcheck.source.text.engine_reactions import has_mujoco_option

# The formats of programs that do not load meshes by Assimp. Those that do (RViz, MoveIt, Pinocchio) read every format that
# we read.
FORMATS = {
    "mujoco": frozenset({"stl", "obj"}),
    "drake": frozenset({"obj", "gltf"}),
    "bullet": frozenset({"stl", "obj", "dae"}),
    "gazebo": frozenset({"stl", "obj", "dae", "gltf", "glb"}),
    "isaac": frozenset({"stl", "obj", "dae"}),
}
NAMES = {"mujoco": "MuJoCo", "drake": "Drake", "bullet": "PyBullet", "gazebo": "Gazebo", "isaac": "Isaac Sim"}
# These load collision meshes only; the others also load meshes that are only drawn.
COLLISION_ONLY = frozenset({"mujoco", "drake"})
MUJOCO_STL_FACES = 200_000


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    unable: dict[str, list[tuple[MeshUse, MeshFacts]]] = {}
    for program, formats in FORMATS.items():
        if model.targets and program not in model.targets:
            continue
        loaded = _collect_loaded_meshes(model, program)
        refused = [(use, facts) for use, facts in loaded if _get_file_format(facts) not in formats]
        heavy = [(u, f) for u, f in loaded if _get_file_format(f) == "stl" and f.n_triangles > MUJOCO_STL_FACES]
        if model.targets and refused:
            yield _build_finding(rule, program, refused, loads=" or ".join(sorted(formats)))
        if model.targets and program == "mujoco" and heavy:
            most = max(facts.n_triangles for _, facts in heavy)
            yield _build_finding(rule, "faces", heavy, triangles=most, limit=MUJOCO_STL_FACES)
        unloadable = [*refused, *(heavy if program == "mujoco" else ())]
        if unloadable:
            unable[program] = unloadable
    if not model.targets and unable:
        yield _build_untargeted_finding(rule, unable)


def _build_untargeted_finding(rule: Rule, unable: Mapping[str, list[tuple[MeshUse, MeshFacts]]]) -> Finding:
    """Return one note for a model without declared targets."""
    meshes = list({use.name: (use, facts) for rejected in unable.values() for use, facts in rejected}.values())
    reactions = {name: str(text) for program in unable for name, text in rule.consumers[program].items()}
    heavy = [f for _, f in unable.get("mujoco", ()) if _get_file_format(f) in FORMATS["mujoco"]]
    if heavy:
        reactions["mujoco"] = str(rule.consumers["faces"]["mujoco"])
    names = join_names([NAMES[program] for program in unable])
    used = " or ".join(NAMES[program] for program in unable)
    return _build_finding(
        rule, "any", meshes, consequences=reactions, severity=Severity.INFO, programs=names, used=used
    )


def _collect_loaded_meshes(model: Model, target: str) -> list[tuple[MeshUse, MeshFacts]]:
    """Return the first use of each file that a program loads."""
    collision_only = target in COLLISION_ONLY and not (
        target == "mujoco" and has_mujoco_option(model.robot, "discardvisual", "false")
    )
    first_uses = [(uses[0], facts) for uses, facts in model.meshes.list_measured()]
    return [(use, facts) for use, facts in first_uses if use.shape.role == "collision" or not collision_only]


def _get_file_format(facts: MeshFacts) -> str:
    """Return the format of a file; MSH012 distinguishes text and binary STL."""
    return facts.format.partition("-")[0]


def _build_finding(rule: Rule, message: str, meshes: list[tuple[MeshUse, MeshFacts]], **data: Any) -> Finding:
    return rule.finding(
        message,
        at=meshes[0][0].filename,
        related=[use.filename for use, _ in meshes[1:]],
        count=len(meshes),
        meshes=join_names(use.name for use, _ in meshes),
        **data,
    )
