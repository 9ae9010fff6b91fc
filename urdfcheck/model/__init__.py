"""The located XML as a robot: links, joints, the tree, and facts that are computed when first asked for."""

from urdfcheck.model.parts import CompleteInertial, DeclaredMass, DeclaredTensor, Inertial, Joint, Link, Shape
from urdfcheck.model.robot import Model

__all__ = ["CompleteInertial", "DeclaredMass", "DeclaredTensor", "Inertial", "Joint", "Link", "Model", "Shape"]
