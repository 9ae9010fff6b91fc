"""MSH001 reports mesh files that cannot be read or have no triangles."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.facts.mesh.decode_limits import NOT_VECTORS, MeshError
from urdfcheck.model import Link, Model
from urdfcheck.model.meshes import MeshUse
from urdfcheck.model.use.other_programs import names_unitless_program
from urdfcheck.model.use.test_files import is_of_tests
from urdfcheck.source.text.engine_reactions import describe_unread_visuals, describe_unreadable_mesh, name_lost_shapes

CAUSES = {
    "html": "web_page",
    "truncated": "incomplete",
    "line-ends": "line_ends",
    "random": "encrypted",
    "no-count": "no_count",
}
REPAIRS = {
    "html": "download the raw file, not the page that shows it",
    "text": "name the mesh that is meant, or export the part as STL",
    "entities": "export the mesh again, or replace the entities by their text and delete the <!DOCTYPE",
    "line-ends": "export the mesh again, and write `*.stl binary` and `*.STL binary` in .gitattributes",
    "random": "decrypt or unpack the file, or export the mesh again where nothing encrypts it",
    "no-triangles": "export the part as a surface of triangles",
    "missing-buffer": "put the file there under the name that the glTF file uses, or export the mesh as one .glb file",
}
COUNT_REPAIR = (
    "write the number of vectors as the count of each such <accessor>, or export the mesh with another program"
)
MATERIAL_REPAIR = (
    "write the id of a <material> of the file as the target of each <instance_material> that names another one, "
    "or export the mesh with its materials"
)
DEFAULT_REPAIR = "export, download or generate the file again"
# The exporter wrote what the part has.
_BARE_REPAIR = "delete the shape if the link only marks a frame; otherwise export the part with its surface"
_FRAME_REPAIR = "delete the shape: {} has no mass and a fixed joint, as a frame has"
# Files that no program can load as a mesh.
NO_MESH = frozenset({"empty", "no-facets", "html"})
# PKG009 and URC905 report these.
REPORTED_ELSEWHERE = frozenset({"lfs-pointer", "too-large"})
# Formats for which programs have their own loaders, which may read files that ours and Assimp refuse. MuJoCo's loader for STL is
# not among them: like ours it only reads binary files of exactly the declared size.
OWN_LOADERS = {"mujoco": frozenset({"obj"}), "drake": frozenset({"obj", "gltf"}), "rviz": frozenset({"stl"})}
# pycollada's words about a material that the file does not have, and about a texture whose image the file does not declare.
_MISSING_MATERIAL = re.compile(r"material #\S* not found")
_MISSING_IMAGE = "missing image"
NOT_TRIED = "uses its own loader for this format, which was not tried"
# They load meshes with Assimp.
ASSIMP_USERS = frozenset({"pinocchio", "moveit", "rviz"})
# Older versions of Assimp read beyond the array in this case, without a message.
NEWER_ASSIMP = dict.fromkeys(("rviz", "moveit"), "drops the shape with newer versions of Assimp")
# trimesh and yourdfpy read COLLADA with pycollada, like urdfcheck.
PYCOLLADA = ("trimesh", "yourdfpy")


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    for path, uses in model.meshes.group_by_file().items():
        error, facts = model.meshes.errors.get(path), model.meshes.facts.get(path)
        if error is not None and error.reason_id not in REPORTED_ELSEWHERE:
            message = _choose_message(error, uses[0].name)
            severity = Severity.WARNING if message in {"unread", "lenient"} else None
            is_bare = error.reason_id == "no-facets"
            repair = _describe_bare_repair(model, uses) if is_bare else _describe_repair(error.message, error.reason_id)
            if is_of_tests(model):
                repair = f"keep it if the test needs a broken mesh; otherwise {repair}"
            finding = _build_finding(
                rule, uses, message, error.message, reason_id=error.reason_id, severity=severity, repair=repair
            )
            yield replace(finding, data={**finding.data, "unproven": _list_unproven(rule, finding, error)})
        elif facts is not None and facts.flaw is not None:
            message = {"refuses": "refused", "loads": "tolerated"}.get(facts.assimp, "partial")
            only_image = message == "tolerated" and _MISSING_IMAGE in facts.flaw
            # Who reads COLLADA with pycollada is among the programs that ignore its unit.
            is_note = only_image or (message == "partial" and not names_unitless_program(model))
            severity = None if message == "refused" else Severity.INFO if is_note else Severity.WARNING
            repair = _describe_repair(facts.flaw, "flaw")
            yield _build_finding(rule, uses, message, facts.flaw, reason_id="flaw", severity=severity, repair=repair)


def _list_unproven(rule: Rule, finding: Finding, error: MeshError) -> list[str]:
    """List the programs that read meshes and of which it is not known what they do with this one."""
    known = {program for program, sentence in finding.consequences.items() if sentence != NOT_TRIED}
    if error.assimp == "loads":
        known |= ASSIMP_USERS
    return [program for program in rule.consumers["unreadable"] if program not in known]


def _choose_message(error: MeshError, name: str) -> str:
    if error.reason_id in NO_MESH:
        return "unreadable"
    if error.reason_id == "external-buffer":
        return "outside"
    if error.reason_id == "unsupported" or error.assimp == "loads":
        return "unread"
    # Of an OBJ file that names materials, Assimp was not asked; many loaders leave out a line that they do not understand.
    if not error.assimp and error.reason_id == "malformed" and name.lower().endswith(".obj"):
        return "lenient"
    return "refused" if error.assimp == "refuses" else "broken"


def _build_finding(
    rule: Rule,
    uses: Sequence[MeshUse],
    message: str,
    reason: str,
    *,
    reason_id: str,
    severity: Severity | None,
    repair: str,
) -> Finding:
    return rule.finding(
        message,
        at=uses[0].filename,
        related=[use.filename for use in uses[1:]],
        cause=CAUSES.get(reason_id),
        severity=severity,
        consequences=_describe_consequences(rule, uses, message, reason_id),
        lost=name_lost_shapes(use.shape.element for use in uses),
        mesh=uses[0].filename.value,
        reason=reason,
        repair=repair,
        reason_id=reason_id,
    )


def _describe_repair(reason: str, reason_id: str) -> str:
    if NOT_VECTORS in reason:
        return COUNT_REPAIR
    return MATERIAL_REPAIR if _MISSING_MATERIAL.search(reason) else REPAIRS.get(reason_id, DEFAULT_REPAIR)


def _describe_bare_repair(model: Model, uses: Sequence[MeshUse]) -> str:
    """Say what to do with a mesh of no triangles: the exporter of a bare frame writes one."""
    link = uses[0].link
    is_frame = _is_massless_and_fixed(model, link) and all(use.link is link for use in uses)
    return _FRAME_REPAIR.format(link.name) if is_frame else _BARE_REPAIR


def _is_massless_and_fixed(model: Model, link: Link) -> bool:
    """Whether a link has no mass, or zero, and hangs on a fixed joint."""
    return (link.inertial is None or link.inertial.mass == 0) and any(
        joint.child == link.name and joint.type == "fixed" for joint in model.joints
    )


def _describe_consequences(rule: Rule, uses: Sequence[MeshUse], message: str, reason_id: str) -> dict[str, str]:
    """Describe what the programs of the page do in this case."""
    file_type = uses[0].name.rpartition(".")[2].lower()
    parts = [use.shape.element for use in uses]
    described = describe_unreadable_mesh(parts) | describe_unread_visuals(parts)
    if message != "unreadable":
        described.update({program: NOT_TRIED for program, own in OWN_LOADERS.items() if file_type in own})
        described.update(dict.fromkeys(PYCOLLADA if file_type != "dae" else (), NOT_TRIED))
    if reason_id == "flaw":
        described.update(NEWER_ASSIMP)
    return {program: sentence for program, sentence in described.items() if program in rule.consumers[message]}
