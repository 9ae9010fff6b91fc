"""Both versions of a robot over each other, as a PNG."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from urdfcheck.core.model_diff import VERDICTS, Diff, ModelDiff
from urdfcheck.core.scene import Scene
from urdfcheck.output.shared.robot_picture import render_scene, render_versions


def render(diff: Diff) -> bytes:
    """Render a model, all joints at zero: of those that both versions have, the one with the most important verdict.

    Empty if no model can be drawn.
    """
    olds, news = index_scenes(diff)
    pairs = [(model, olds.get(model.before), news.get(model.after)) for model in diff.models]
    pairs.sort(key=lambda pair: (None in pair, VERDICTS.index(pair[0].verdict)))
    return next((picture for model, before, after in pairs if (picture := draw_versions(model, before, after))), b"")


def index_scenes(diff: Diff) -> tuple[Mapping[str, Scene], Mapping[str, Scene]]:
    """Return what draws the models of either version, by the id of the model."""

    def index(scenes: Iterable[Scene]) -> dict[str, Scene]:
        return {scene.model: scene for scene in scenes}

    return ({}, {}) if diff.runs is None else (index(diff.runs[0].scenes), index(diff.runs[1].scenes))


def draw_versions(
    model: ModelDiff, before: Scene | None, after: Scene | None, width: int = 1200, height: int = 900
) -> bytes:
    """Draw both versions of a model, or the one that there is; empty if there is nothing to draw."""
    if before is not None and after is not None and model.mechanism is not None:
        picture = render_versions(before, after, model.mechanism.root_pose, width, height)
        if picture:
            return picture
    scene = after or before
    return b"" if scene is None else render_scene(scene, width, height)
