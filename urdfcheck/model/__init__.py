"""The located XML as a robot: links, joints, the tree, and facts that are computed when first asked for."""

from urdfcheck.model.model import Model
from urdfcheck.model.parts import Inertial, Joint, Link, Shape

__all__ = ["Inertial", "Joint", "Link", "Model", "Shape"]
