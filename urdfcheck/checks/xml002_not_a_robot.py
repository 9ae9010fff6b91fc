"""XML002 reports a root element of the wrong kind, and a robot without a name."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.model.launch_context import LaunchContext
from urdfcheck.source.load import Source
from urdfcheck.source.model_file import names_file
from urdfcheck.source.model_role import explain_joint_to_elsewhere, makes_another_format, only_defines
from urdfcheck.source.package.file_kinds import FORMATS_BY_ROOT, is_launch
from urdfcheck.source.package.finder import Package
from urdfcheck.source.package.package_folders import drop_comments, iter_package_texts
from urdfcheck.source.project_folders import find_project_folder
from urdfcheck.source.ros.gazebo_paths import read_model_config
from urdfcheck.source.text.tokens import build_rename_edits
from urdfcheck.source.text.xml import Element
from urdfcheck.source.uses_elsewhere import find_deploying_script, is_certainly_left_aside, is_named_nowhere

# The parts that the root element of a robot holds.
_PARTS = frozenset({"link", "joint", "material", "gazebo", "transmission", "ros2_control"})
_OF_EXTENSION = "move the <gazebo> into the <robot> that it is for, or delete the file if that has it"
_SPAWNS_SDF = re.compile(r"(?<![\w-])-sdf(?![\w-])")


def check(subject: Source | LaunchContext | Package, rule: Rule) -> Iterator[Finding]:
    if isinstance(subject, Source):
        yield from _check_model(subject, rule)
        return
    wanted, root = ("launch", subject.launch.root) if isinstance(subject, LaunchContext) else ("package", subject.root)
    if root is not None and root.tag != wanted:
        yield rule.finding(wanted, at=root, tag=root.tag)


def _check_model(source: Source, rule: Rule) -> Iterator[Finding]:
    root = source.root if source.root is not None else source.main_tree
    if root is None:
        return
    if root.tag != "robot":
        # In a xacro, <gazebo> is a block of a robot; the root of old SDF files has the same name.
        is_extension = not source.is_xacro and _is_extension(root)
        is_block = is_extension or (root.tag == "gazebo" and source.is_xacro)
        is_named_wrong = root.tag == "sdf" and _holds_parts_of_robots(root)
        known = None if is_block or is_named_wrong else FORMATS_BY_ROOT.get(root.tag)
        if known is None and source.root is None and source.is_xacro and only_defines(root):
            return  # whatever its root is: a library, which xacro could not expand (XAC001)
        if known is None and source.root is not None and makes_another_format(source, root):
            return
        if known is None and _is_world_of_sai(root):
            repair = "nothing if SAI 2 loads it; urdfcheck checks the robots that it names"
            known = "a world of SAI 2"
            finding = rule.finding(
                "format", at=root, severity=Severity.INFO, tag=root.tag, format=known, reader="", repair=repair
            )
            yield replace(finding, blocks_check=True)
        elif known is None:
            severity = Severity.WARNING if is_extension else None
            repair = _OF_EXTENSION if is_extension else _describe_root_repair(root)
            finding = rule.finding("root", at=root, severity=severity, tag=root.tag, repair=repair)
            yield replace(finding, blocks_check=True) if is_extension else finding
        else:
            edits = build_rename_edits([root], "robot", source.files) if root.tag == "Robot" else ()
            reader = _find_reader_of_sdf(source) if root.tag == "sdf" else _find_reader_of_collada(root)
            finding = rule.finding(
                "format",
                at=root,
                edits=edits,
                severity=Severity.INFO if reader else None,
                consequences=_describe_consequences(root.tag),
                tag=root.tag,
                format=known,
                reader=reader,
                repair=_describe_format_repair(source, root, has_reader=bool(reader)),
            )
            # Nothing is wrong with the file, and what it holds is unknown all the same.
            yield replace(finding, blocks_check=True) if reader else finding
        return
    name = root.attributes.get("name")
    if name is None:
        # A file without a name that others include is a part, and so is a xacro with a joint to a link that it has not (KIN002);
        # one that no file here includes may be a part for other packages. Whether a file that cannot be expanded is a model is
        # unknown.
        hangs = source.is_xacro and source.root is not None and bool(explain_joint_to_elsewhere(source.root))
        if not source.is_part and source.root is not None and not hangs and not _has_joints_elsewhere(source):
            yield rule.finding("unnamed", at=root, severity=_grade_unnamed(source))
    elif not name.value.strip():
        yield rule.finding("empty", at=name, severity=Severity.WARNING)


def _is_extension(root: Element) -> bool:
    """Whether a root is what a URDF has for Gazebo, without the robot."""
    tags = {child.tag for child in root.children}
    return root.tag == "gazebo" and "version" not in root.attributes and tags <= {"plugin", "sensor"}


def _is_world_of_sai(root: Element) -> bool:
    """Whether a world names the files of its robots, as those of SAI 2 do."""
    models = [robot.find_child("model") for robot in root.find_children("robot")]
    return root.tag == "world" and bool(models) and all(one is not None and one.get("path") for one in models)


def _holds_parts_of_robots(root: Element) -> bool:
    """Whether a root holds nothing but parts of a robot, which it would hold as ``<robot>``."""
    return bool(root.children) and all(child.tag in _PARTS for child in root.children)


def _describe_root_repair(root: Element) -> str:
    """Say what to do with the root element: the robot may be in it, or it may be the robot's."""
    if [child.tag for child in root.children] == ["robot"]:
        return f"delete the <{root.tag}> around <robot>, which then is the root"
    if _holds_parts_of_robots(root):
        return f'write `<robot name="…">` in place of `<{root.tag}>`, also in the end tag'
    return 'wrap what is in the file in `<robot name="…">`, or give the file another name if it is not of a robot'


def _describe_format_repair(source: Source, root: Element, *, has_reader: bool) -> str:
    if has_reader:
        return f"nothing if it is {root.tag.upper()} on purpose; urdfcheck checks URDF and xacro files only"
    repair = "run urdfcheck on the URDF or xacro file of the robot"
    if root.tag == "sdf" and source.path.suffix.lower() == ".urdf":
        return f"if it is SDF on purpose, let its name end in `.sdf`; else {repair}"
    return repair


def _find_reader_of_collada(root: Element) -> str:
    """Say what reads a COLLADA file with a mechanism as a robot; empty for a mesh."""
    has_mechanism = root.tag == "COLLADA" and root.find_child("library_kinematics_models") is not None
    return " with a mechanism; the parser of ROS 1 hands such a file to collada_parser" if has_mechanism else ""


def _find_reader_of_sdf(source: Source) -> str:
    """Say what reads an SDF model as such: Gazebo, for which ``model.config`` beside it names it, a launch file that names it and
    spawns it with ``-sdf``, or the parser of SDF for robot_description, on which its package depends; empty if nothing is known
    to."""
    if source.path.name in read_model_config(source.path.parent, source.finder.can_open):
        return "; model.config names it as that for Gazebo"
    if source.package is not None and "sdformat_urdf" in source.package.dependencies:
        return "; sdformat_urdf, on which the package depends, reads it"
    project = find_project_folder(source.path.absolute())
    for path, text in iter_package_texts(project, source.finder.can_open):
        typed = drop_comments(text) if is_launch(path) else ""
        if _SPAWNS_SDF.search(typed) and _may_name(typed, path, source):
            return f"; {path.name} spawns it with -sdf"
    return ""


def _may_name(typed: str, launch: Path, source: Source) -> bool:
    """Whether a launch file may name this model: many are called ``model.sdf``, so its folder or package must be named too, or
    the launch file must be beside it."""
    file, package = source.path.absolute(), source.package
    inside = file.name if package is None else Path(os.path.relpath(file, package.path.absolute())).as_posix()
    is_address = f"model://{file.parent.name}/{file.name}" in typed  # of Gazebo, which names the folder
    if not is_address and not names_file(typed, inside, "" if package is None else package.name):
        return False
    words = [file.parent.name, *([] if package is None else [package.name])]
    named = re.compile(rf"(?<![\w.-])(?:{'|'.join(map(re.escape, words))})(?![\w-])")
    return launch.absolute().parent == file.parent or named.search(typed) is not None


def _grade_unnamed(source: Source) -> Severity | None:
    """Return the severity of a robot without a name; a xacro that no file of its package names is a part, kept or for robots of
    other packages, such as the `vehicle.xacro` that Autoware includes by the name of a package."""
    if not source.is_xacro:
        return None
    is_part = is_named_nowhere(source) or is_certainly_left_aside(source) or find_deploying_script(source) is not None
    return Severity.INFO if is_part else Severity.WARNING


def _has_joints_elsewhere(source: Source) -> bool:
    """Whether a file has links only, and another one the joints between them (KIN005): both are parts of a robot."""
    if source.root is None or source.root.find_children("joint"):
        return False
    from urdfcheck.model.likeness.whole_models import find_joints_elsewhere  # loaded only for such a file

    return find_joints_elsewhere(source) is not None


def _describe_consequences(tag: str) -> dict[str, str]:
    """Return the reactions of MuJoCo and Gazebo, each of which has its own format."""
    is_own_format = {"mujoco": tag == "mujoco", "gazebo": tag == "sdf"}
    return {
        name: "loads it; this is its own format" if reads else "refuses the file"
        for name, reads in is_own_format.items()
    }
