"""XML002: the root element is a robot with a name; that of a launch file or manifest is what ROS reads there."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.model.launch_context import LaunchContext
from urdfcheck.source.load import Source
from urdfcheck.source.package.finder import Package
from urdfcheck.source.text.tokens import build_rename_edits

_FORMATS = {
    "sdf": "an SDF model",
    "gazebo": "an old SDF model",
    "mujoco": "a MuJoCo model",
    "mujocoinclude": "a part of a MuJoCo model",
    "COLLADA": "a COLLADA mesh",
    "launch": "a launch file",
    "package": "a package manifest",
    "html": "a web page",
    "svg": "a drawing",
    "Robot": "URDF with a capital letter: names in XML distinguish upper and lower case",
}


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
        known = _FORMATS.get(root.tag)
        if known is None:
            yield rule.finding("root", at=root, tag=root.tag)
        else:
            edits = build_rename_edits([root], "robot", source.files) if root.tag == "Robot" else ()
            told = _describe_consequences(root.tag)
            yield rule.finding("format", at=root, edits=edits, consequences=told, tag=root.tag, format=known)
        return
    name = root.attributes.get("name")
    if name is None:
        # A xacro file without a name that was only found in a folder is a part that some model includes.
        if source.explicit or not source.is_xacro:
            yield rule.finding("unnamed", at=root)
    elif not name.value.strip():
        yield rule.finding("empty", at=name, severity=Severity.WARNING)


def _describe_consequences(tag: str) -> dict[str, str]:
    """What MuJoCo and Gazebo do with a file of this kind: each has a format of its own."""
    own = {"mujoco": tag == "mujoco", "gazebo": tag == "sdf"}
    return {name: "loads it: this is its own format" if reads else "refuses the file" for name, reads in own.items()}
