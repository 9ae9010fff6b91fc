"""Renderers of ``urdfcheck diff``: each module has ``render(diff, …) -> str`` and sees a `Diff`, never a model."""
