"""The semantic descriptions (SRDF) that are for a robot."""

from __future__ import annotations

from urdfcheck.model.fact import fact
from urdfcheck.model.robot import Model
from urdfcheck.source.ros.srdf import Srdf, load_srdfs, load_srdfs_of_parts


@fact
def semantic_descriptions(model: Model) -> tuple[Srdf, ...]:
    """Load the semantic descriptions in reach that are for a robot of this name."""
    return load_srdfs(model.source, model.name)


@fact
def semantic_descriptions_of_parts(model: Model) -> tuple[Srdf, ...]:
    """Load those for a robot of this name that are made for other packages whose files the model includes, as a variant for a
    simulator includes the robot's own file."""
    return load_srdfs_of_parts(model.source, model.name)
