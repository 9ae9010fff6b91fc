"""Which controllers the files of a workspace start."""

from __future__ import annotations

import re
from collections.abc import Collection

from urdfcheck.core.text import compile_names
from urdfcheck.model.fact import fact
from urdfcheck.model.robot import Model
from urdfcheck.source.package.package_folders import drop_comments, iter_package_texts

# How launch files and scripts start a controller: a program of controller_manager, a verb of `ros2 control`, or a service.
_STARTER = re.compile(r"\b(?:spawner|load_controller|switch_controllers?)\b")
_YAML = frozenset({".yaml", ".yml"})


def is_left_unstarted(model: Model, controller: str, others: Collection[str]) -> bool:
    """Whether launch files or scripts of the workspace start some of the ``others`` by their names, and none names this one."""
    texts = _list_workspace_texts(model)
    own, known = compile_names((controller,)), compile_names(tuple(others))
    starts_others = bool(others) and any(_STARTER.search(text) and known.search(text) for text in texts)
    return starts_others and not any(map(own.search, texts))


@fact
def _list_workspace_texts(model: Model) -> tuple[str, ...]:
    """List the texts of the packages around the model; parameter files of ROS 2 declare controllers, and start none."""
    finder = model.source.finder
    folders = sorted(set(finder.list_workspace_packages().values()))
    found = (one for folder in folders for one in iter_package_texts(folder, finder.can_open))
    return tuple(
        drop_comments(text) for path, text in found if path.suffix not in _YAML or "ros__parameters" not in text
    )
