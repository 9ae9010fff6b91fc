"""What a check of scope ``launch`` gets: a launch file together with the robot that it loads."""

from __future__ import annotations

from typing import TYPE_CHECKING

from urdfcheck.core.records import dataclass
from urdfcheck.model.robot import Model

if TYPE_CHECKING:
    from urdfcheck.source.launch.launch_file import Launch


@dataclass(frozen=True, slots=True, eq=False)
class LaunchContext:
    """A launch file and the model that is checked with it."""

    launch: Launch
    model: Model | None
    """None where the launch file is checked on its own, or the model could not be expanded."""
    is_explicit: bool = True
    """Whether the file was named; with a folder that was named, its model files are checked too, whatever a launch file loads."""
