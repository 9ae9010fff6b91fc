"""Joints that turn propellers, whose thrust holds what carries them."""

from __future__ import annotations

from urdfcheck.core.text import split_name_words
from urdfcheck.model.parts import Joint
from urdfcheck.model.robot import Model

# The words of joints that turn a propeller: plugins drive them, which read no limit.
_WORDS = frozenset({"rotor", "propeller", "prop", "thruster"})
# The rotor of one motor may be a link of an arm, too.
_FEWEST = 2


def is_named_rotor(joint: Joint) -> bool:
    """Whether a joint turns a propeller by its name."""
    return not _WORDS.isdisjoint(word.lower() for word in split_name_words(joint.name))


def carries_rotors(model: Model, joint: Joint) -> bool:
    """Whether what a joint carries has propellers: several joints that turn without end, carry nothing else and are so named."""
    joints = [joint]
    for other in joints:
        joints.extend(model.tree.child_joints[other.child])
    return (
        sum(
            other.type == "continuous" and not model.tree.child_joints[other.child] and is_named_rotor(other)
            for other in joints[1:]
        )
        >= _FEWEST
    )
