"""PKG014 reports mesh paths that MuJoCo cannot open, and file names that it confuses."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.text import format_count, join_names
from urdfcheck.model import Model
from urdfcheck.model.meshes import MeshUse
from urdfcheck.source.ros.mujoco_paths import takes_only_names
from urdfcheck.source.text.engine_reactions import has_mujoco_option


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    if "mujoco" not in model.targets:
        return
    strips = takes_only_names(model.robot)
    reads_visuals = has_mujoco_option(model.robot, "discardvisual", "false")
    uses = [use for use in model.meshes.uses if reads_visuals or use.shape.role == "collision"]
    foreign = [] if strips else [use for use in uses if "://" in use.filename.value]
    if foreign:
        files = list(dict.fromkeys(use.filename.value for use in foreign))
        yield rule.finding(
            "scheme",
            at=foreign[0].filename,
            related=[use.filename for use in foreign[1:]],
            path=files[0],
            paths=join_names(files, 3),
            count=format_count(len(files), "mesh", "meshes"),
            verb="has" if len(files) == 1 else "have",
            how=_describe_repair(model, uses),
        )
    for name, alike in _group_by_name(uses, with_suffix=strips).items():
        different = list({_get_content(model, use): use for use in reversed(alike)}.values())[::-1]
        if len(different) < 2:
            continue
        is_stripped = strips or any("://" in use.filename.value for use in different)
        yield rule.finding(
            "clash",
            at=different[1].filename,
            related=[different[0].filename, *(use.filename for use in different[2:])],
            severity=None if is_stripped else Severity.INFO,
            consequences={} if is_stripped else {"mujoco": "before 4.0, replaces each by the first"},
            name=name,
            count=format_count(len(different), "different file"),
            files=join_names(use.filename.value for use in different),
            when="MuJoCo takes one for all where it strips the folders, which these paths need"
            if is_stripped
            else "MuJoCo before 4.0 takes the first for all",
        )


def _group_by_name(uses: Sequence[MeshUse], *, with_suffix: bool) -> dict[str, list[MeshUse]]:
    """Group the uses of files that exist by the name that MuJoCo gives them: that of the file, which it opens after stripping."""
    groups: dict[str, list[MeshUse]] = {}
    for use in uses:
        if use.resource.exists and use.resource.path is not None:
            groups.setdefault(use.name if with_suffix else use.name.rpartition(".")[0], []).append(use)
    return groups


def _get_content(model: Model, use: MeshUse) -> str:
    """Return what identifies a file: its content, or its path where it was not read."""
    path = use.resource.path
    assert path is not None
    return model.meshes.digests.get(path) or os.path.realpath(path)


def _describe_repair(model: Model, uses: Sequence[MeshUse]) -> str:
    """Say how MuJoCo finds the meshes: by the one folder in which they all are, or by relative paths."""
    folders = {use.resource.path.parent for use in uses if use.resource.path is not None}
    if len(folders) != 1 or any(use.resource.path is None for use in uses):
        return "write paths relative to the file that MuJoCo reads, without package://"
    folder = os.path.relpath(folders.pop(), model.source.path.parent).replace(os.sep, "/")
    where = "" if not model.source.is_xacro else ", for an expanded file beside the xacro"
    options = f'meshdir="{folder}" strippath="true"'
    # MuJoCo refuses a robot with two of these elements (checked with 4.0).
    sections = model.robot.find_children("mujoco")
    if not sections:
        return f"add <mujoco><compiler {options}/></mujoco> to the robot{where}"
    if not any(section.find_children("compiler") for section in sections):
        return f"add <compiler {options}/> to the <mujoco> of the robot{where}"
    return f"write {options} in the <compiler> of its <mujoco>{where}"
