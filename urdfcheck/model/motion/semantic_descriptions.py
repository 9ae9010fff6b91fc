"""The semantic descriptions (SRDF) that are for a robot."""

from __future__ import annotations

from urdfcheck.model.fact import fact
from urdfcheck.model.robot import Model
from urdfcheck.source.ros.srdf import Srdf, load_srdfs


@fact
def semantic_descriptions(model: Model) -> tuple[Srdf, ...]:
    """Load the semantic descriptions in reach that are for a robot of this name."""
    return load_srdfs(model.source, model.name)
