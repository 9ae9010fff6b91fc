"""The model in Pinocchio, built from URDF text without geometry, with what the reference parser reported about it.

Pinocchio reads URDF through urdfdom, the parser of ROS. Meshes are left out: Pinocchio would give up the whole model at the
first mesh that it cannot read, and urdfcheck measures geometry itself.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from typing import IO, TYPE_CHECKING, Any

from urdfcheck.core import FactUnavailableError
from urdfcheck.core.records import dataclass
from urdfcheck.model.fact import fact
from urdfcheck.model.parts import Joint
from urdfcheck.source.text.grammar import (
    JOINT_TYPES,
    NUMERIC_ATTRIBUTES,
    is_attribute_missing,
    iter_urdf_elements,
    parse_urdf_version,
)
from urdfcheck.source.text.values import has_unskipped_blank, parse_numbers, read_attribute_number
from urdfcheck.source.text.xml import Element, quote_attribute
from urdfcheck.system.installation import compute_code_version, describe_left_out, find_library_origin

if TYPE_CHECKING:
    from urdfcheck.model.robot import Model

# The elements that urdfdom reads, without visual and collision.
_KEPT_CHILDREN = {
    "robot": {"link", "joint"},
    "link": {"inertial"},
    "inertial": {"origin", "mass", "inertia"},
    "joint": {"origin", "parent", "child", "axis", "limit", "dynamics", "mimic", "safety_controller", "calibration"},
}
# What Pinocchio raises when urdfdom returned no model; any other error is its own.
_NO_MODEL = "does not contain a valid URDF model"
_SOURCE_LINE = re.compile(r"^\s*at line \d+ in .*$")
# A value in brackets, whose line breaks and tabs are written as in C.
_QUOTED = re.compile(r"(?<= )\[[^\[\]]*\]")
_BREAKS = str.maketrans({"\n": "\\n", "\r": "\\r", "\t": "\\t"})
_ANSI = re.compile(r"\x1b\[[0-9;]*m")


@dataclass(frozen=True, slots=True, eq=False)
class PinocchioModel:
    """A model as Pinocchio loaded it, or why it did not."""

    model: Any
    """The ``pinocchio.Model``; None when it was refused."""
    refused_by: str | None
    """``urdfdom``, or ``pinocchio`` for a model that urdfdom accepted; None when it was loaded."""
    messages: tuple[str, ...]
    """What both printed."""


@dataclass(frozen=True, slots=True)
class ParserVerdict:
    """What loading reported; see `PinocchioModel`."""

    refused_by: str | None
    messages: tuple[str, ...]


@fact
def parser_verdict(model: Model) -> ParserVerdict:
    """Report what urdfdom and Pinocchio say about the model; cached, so that a known model is not loaded again.

    :raises FactUnavailableError: as :func:`pinocchio_model`.
    """
    import numpy as np

    library = find_library_origin("pinocchio")
    if library is None:
        return _make_verdict(pinocchio_model(model))
    _ensure_loadable(model)
    parts = (compute_code_version(__name__, library=library), write_without_geometry(model))
    entry = model.cache.entry("verdicts", hashlib.sha256("\0".join(parts).encode()).hexdigest())
    if "verdict" not in entry:
        verdict = _make_verdict(pinocchio_model(model))
        text = json.dumps([verdict.refused_by, verdict.messages])
        entry["verdict"] = {"text": np.frombuffer(text.encode(), dtype=np.uint8)}
    refused_by, messages = json.loads(entry["verdict"]["text"].tobytes())
    return ParserVerdict(refused_by, tuple(messages))


def _make_verdict(loaded: PinocchioModel) -> ParserVerdict:
    return ParserVerdict(loaded.refused_by, loaded.messages)


@fact
def pinocchio_model(model: Model) -> PinocchioModel:
    """Load a sound tree into Pinocchio.

    :raises FactUnavailableError: when Pinocchio is not installed; when the tree, an axis or a number would make it
        compute nonsense (it loads a zero axis and gives NaN accelerations); or when it is known to refuse the model.
    """
    try:
        import pinocchio
    except ImportError as error:
        raise FactUnavailableError(describe_left_out(error) or str(error)) from None
    _ensure_loadable(model)
    built: Any = None
    output, refused_by = "", None
    with capture_stderr() as read:
        try:
            built = pinocchio.buildModelFromXML(write_without_geometry(model))
        except (ValueError, RuntimeError) as error:
            output = str(error)
            refused_by = "urdfdom" if _NO_MODEL in output else "pinocchio"
        output += "\n" + read()
    return PinocchioModel(built, refused_by, tuple(_clean_messages(output)))


@fact
def write_without_geometry(model: Model) -> str:
    """Write the expanded model as URDF text with links, inertials and joints only."""

    def write_element(element: Element) -> Iterator[str]:
        attributes = "".join(
            f" {a.name}={quote_attribute(a.value)}" for a in element.attributes.values() if ":" not in a.name
        )
        children = [c for c in element.children if c.tag in _KEPT_CHILDREN.get(element.tag, set())]
        if not children:
            yield f"<{element.tag}{attributes}/>"
            return
        yield f"<{element.tag}{attributes}>"
        for child in children:
            yield from write_element(child)
        yield f"</{element.tag}>"

    return '<?xml version="1.0"?>\n' + "".join(write_element(model.robot))


def _ensure_loadable(model: Model) -> None:
    """Refuse every defect that is rejected or miscomputed, and that a rule of its own reports.

    :raises FactUnavailableError: naming that rule.
    """
    if "name" not in model.robot.attributes:
        raise FactUnavailableError("the robot has no name (XML002)")
    _ = model.tree
    inertials = [link.inertial.element for link in model.links if link.inertial is not None]
    for part in (*(joint.element for joint in model.joints), *inertials):
        for element in iter_urdf_elements(part):
            _ensure_numbers(element)
    _ensure_version(model.robot)
    for joint in model.joints:
        _ensure_type_and_axis(joint)
        _ensure_limit(joint)
        _ensure_complete(joint)
    for link in model.links:
        if link.inertial is not None and (link.inertial.mass is None or link.inertial.inertia_components is None):
            raise FactUnavailableError(
                f"the inertial of link {link.name!r} is incomplete or out of range (XML005, XML007)"
            )


def _ensure_type_and_axis(joint: Joint) -> None:
    if joint.type not in JOINT_TYPES:
        raise FactUnavailableError(f"the type of joint {joint.name!r} is unknown (KIN009)")
    if joint.origin.xyz is None or joint.origin.rpy is None or joint.axis is None:
        raise FactUnavailableError(f"the origin or the axis of joint {joint.name!r} is out of range (XML007)")
    if joint.has_axis and not any(joint.axis):
        raise FactUnavailableError(f"the axis of joint {joint.name!r} is zero (JNT001)")
    if joint.has_axis and joint.axis_element is not None and "xyz" not in joint.axis_element.attributes:
        raise FactUnavailableError(f"the <axis> of joint {joint.name!r} has no xyz, which makes it zero (XML005)")


def _ensure_numbers(element: Element) -> None:
    for name, count in NUMERIC_ATTRIBUTES.get(element.tag, {}).items():
        attribute = element.attributes.get(name)
        if attribute is None:
            continue
        if has_unskipped_blank(attribute.value, count) or parse_numbers(attribute.value, count) is None:
            raise FactUnavailableError(f"the number in {element.subject}@{name} is malformed (XML007, XML008)")


def _ensure_limit(joint: Joint) -> None:
    limit = joint.limit
    if limit is None and joint.type in {"revolute", "prismatic"}:
        raise FactUnavailableError(f"joint {joint.name!r} has no <limit> (JNT004)")
    for name in ("effort", "velocity") if limit is not None else ():
        value = joint.get_limit_value(name)
        if limit is not None and value is None:
            code = "JNT007" if is_attribute_missing(limit, name) else "XML004"
            raise FactUnavailableError(f"the <limit> of joint {joint.name!r} has no {name} ({code})")
        if value is not None and value < 0 and joint.is_driven:
            raise FactUnavailableError(f"the {name} limit of joint {joint.name!r} is negative (JNT007)")


def _ensure_complete(joint: Joint) -> None:
    for tag, wanted, code in (
        ("dynamics", {"damping", "friction"}, "XML005"),
        ("mimic", {"joint"}, "XML005"),
        ("safety_controller", {"k_velocity"}, "JNT010"),
    ):
        element = joint.element.find_child(tag)
        if element is not None and not wanted & set(element.attributes):
            reported_by = code if all(is_attribute_missing(element, name) for name in wanted) else "XML004"
            raise FactUnavailableError(f"the <{tag}> of joint {joint.name!r} is incomplete ({reported_by})")
    if joint.is_movable and (read_attribute_number(joint.element.find_child("dynamics"), "friction") or 0) < 0:
        raise FactUnavailableError(f"the friction of joint {joint.name!r} is negative (JNT011)")


def _ensure_version(robot: Element) -> None:
    """Refuse a version of URDF that urdfdom does not read, and an orientation that this version forbids to give twice.

    :raises FactUnavailableError: for either.
    """
    version = parse_urdf_version(robot)
    if version is None:
        raise FactUnavailableError(f"{robot.get('version')!r} is not a URDF version (XML010)")
    for element in iter_urdf_elements(robot) if version > (1, 0) else ():
        if element.tag == "origin" and {"rpy", "quat_xyzw"} <= set(element.attributes):
            raise FactUnavailableError(f"{element.subject} has two orientations (XML010)")


@contextmanager
def capture_stderr() -> Iterator[Any]:
    """Capture what C++ writes to file descriptor 2 in the meantime; the yielded function returns it so far."""
    sys.stderr.flush()
    saved = os.dup(2)
    with _open_sink() as sink:
        os.dup2(sink.fileno(), 2)

        def read_captured() -> str:
            sink.seek(0)
            return sink.read().decode("utf-8", "replace")

        try:
            yield read_captured
        finally:
            os.dup2(saved, 2)
            os.close(saved)


def _open_sink() -> IO[bytes]:
    """Open a file: in memory where the platform can, because a confined process may write nowhere else."""
    if sys.platform == "linux":
        return os.fdopen(os.memfd_create("stderr"), "w+b")
    return tempfile.TemporaryFile()


def _clean_messages(text: str) -> Iterator[str]:
    """Yield the messages without colours, and without the lines that name urdfdom's own source."""
    messages: set[str] = set()
    # A line break in a value that is quoted is not the end of the message.
    text = _QUOTED.sub(lambda match: match[0].translate(_BREAKS), text)
    for raw in text.splitlines():
        line = re.sub(r"^(?:Error|Warning):\s*", "", _ANSI.sub("", raw)).strip()
        if line and not _SOURCE_LINE.match(line) and line not in messages:
            messages.add(line)
            yield line
