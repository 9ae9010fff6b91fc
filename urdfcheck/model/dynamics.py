"""The model in Pinocchio, built from URDF text without geometry, with what the reference parser said about it.

Pinocchio reads URDF through urdfdom, the parser of ROS. Meshes are left out: it would give up the whole model at the
first mesh that it cannot read, and geometry is our own business.
"""

from __future__ import annotations

import os
import re
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any
from xml.sax.saxutils import quoteattr

from urdfcheck.core import Unavailable
from urdfcheck.source.xml import Element

if TYPE_CHECKING:
    from urdfcheck.model.model import Model

# What urdfdom reads of a model, without visual and collision.
_KEPT = {
    "robot": {"link", "joint"},
    "link": {"inertial"},
    "inertial": {"origin", "mass", "inertia"},
    "joint": {"origin", "parent", "child", "axis", "limit", "dynamics", "mimic", "safety_controller", "calibration"},
}
_SOURCE_LINE = re.compile(r"^\s*at line \d+ in .*$")
_ANSI = re.compile(r"\x1b\[[0-9;]*m")


@dataclass(frozen=True, slots=True, eq=False)
class Dynamics:
    """``model`` is the ``pinocchio.Model``, None when it was refused; ``messages`` is what urdfdom and Pinocchio said."""

    model: Any
    refused: bool
    messages: tuple[str, ...]


def build(model: Model) -> Dynamics:
    """Hand a sound tree to Pinocchio.

    :raises Unavailable: when Pinocchio is not installed, or when the tree, an axis or a number would make it compute
        nonsense: it loads a zero axis and gives NaN accelerations.
    """
    try:
        import pinocchio
    except ImportError:
        raise Unavailable("Pinocchio is not installed (there are no wheels of pin for this platform)") from None
    _ensure_sound(model)
    built: Any = None
    said = ""
    with captured_stderr() as read:
        try:
            built = pinocchio.buildModelFromXML(geometry_free(model.robot))
        except (ValueError, RuntimeError) as error:
            said = str(error)
        said += "\n" + read()
    return Dynamics(built, built is None, tuple(_lines(said)))


def geometry_free(robot: Element) -> str:
    """The expanded model as URDF text with links, inertials and joints only."""

    def write(element: Element) -> Iterator[str]:
        attributes = "".join(
            f" {a.name}={quoteattr(a.value)}" for a in element.attributes.values() if ":" not in a.name
        )
        kept = [c for c in element.children if c.tag in _KEPT.get(element.tag, set())]
        if not kept:
            yield f"<{element.tag}{attributes}/>"
            return
        yield f"<{element.tag}{attributes}>"
        for child in kept:
            yield from write(child)
        yield f"</{element.tag}>"

    return '<?xml version="1.0"?>\n' + "".join(write(robot))


def _ensure_sound(model: Model) -> None:
    _ = model.tree
    for joint in model.joints:
        if joint.has_axis and (joint.axis is None or not any(joint.axis)):
            raise Unavailable(f"the axis of joint {joint.name!r} is zero or malformed (JNT001)")
        if joint.origin.xyz is None or joint.origin.rpy is None:
            raise Unavailable(f"the origin of joint {joint.name!r} is malformed (XML007, XML008)")
    for link in model.links:
        inertial = link.inertial
        if inertial is not None and (inertial.mass is None or inertial.six is None):
            raise Unavailable(f"the inertial of link {link.name!r} is malformed (XML005, XML007)")


@contextmanager
def captured_stderr() -> Iterator[Any]:
    """What C++ writes to file descriptor 2 meanwhile; the yielded function reads it so far."""
    sys.stderr.flush()
    saved = os.dup(2)
    with tempfile.TemporaryFile() as sink:
        os.dup2(sink.fileno(), 2)

        def read() -> str:
            sink.seek(0)
            return sink.read().decode("utf-8", "replace")

        try:
            yield read
        finally:
            os.dup2(saved, 2)
            os.close(saved)


def _lines(text: str) -> Iterator[str]:
    """The messages without colours and without the lines that name urdfdom's own source."""
    seen: set[str] = set()
    for raw in text.splitlines():
        line = re.sub(r"^(?:Error|Warning):\s*", "", _ANSI.sub("", raw)).strip()
        if line and not _SOURCE_LINE.match(line) and line not in seen:
            seen.add(line)
            yield line
