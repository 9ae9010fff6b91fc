"""The robot as a PNG."""

from __future__ import annotations

from urdfcheck.core import Run, UrdfcheckError
from urdfcheck.output.shared.robot_picture import render_scene


def render(run: Run) -> bytes:
    """Render the picture of the one model of a run.

    :raises UrdfcheckError: when there are several models, or none that can be drawn.
    """
    paths = dict.fromkeys(info.path for info in run.models)
    if len(paths) > 1:
        raise UrdfcheckError(f"a png shows one model, and there are {len(paths)}: name the file of one")
    picture = next((made for scene in run.scenes if (made := render_scene(scene))), b"")
    if not picture:
        raise UrdfcheckError(f"no png: {next(iter(paths), 'nothing')} has no shape that can be drawn")
    return picture
