"""MSH001 reports mesh files that cannot be read or hold no triangles."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.model import Model
from urdfcheck.source.text.engine_reactions import describe_unreadable_mesh

# A file in a format that we cannot read, or with its geometry in a second file, need not be broken.
UNREAD_SEVERITIES = {"unsupported": Severity.WARNING, "external-buffer": Severity.INFO}
CAUSES = {"html": "web_page", "truncated": "incomplete", "wrong-size": "incomplete"}
REPAIRS = {
    "html": "download the raw file: the link to its content, not to the page that shows it",
    "entities": "export the mesh again, or write the text of the entities where they are used and delete their declarations",
    "no-triangles": "export the part as a surface of triangles",
}
# PKG009 and URC905 report these.
REPORTED_ELSEWHERE = {"lfs-pointer", "too-large"}


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    for path, uses in model.meshes.group_by_file().items():
        error = model.meshes.errors.get(path)
        if error is not None and error.reason_id not in REPORTED_ELSEWHERE:
            other = error.reason_id in UNREAD_SEVERITIES
            yield rule.finding(
                "unread" if other else "unreadable",
                at=uses[0].filename,
                related=[use.filename for use in uses[1:]],
                cause=CAUSES.get(error.reason_id),
                severity=UNREAD_SEVERITIES.get(error.reason_id),
                consequences=None if other else describe_unreadable_mesh(use.shape.element for use in uses),
                mesh=uses[0].filename.value,
                reason=str(error),
                repair=REPAIRS.get(error.reason_id, "export or download the file again"),
                reason_id=error.reason_id,
            )
