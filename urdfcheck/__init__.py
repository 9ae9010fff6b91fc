"""urdfcheck: a linter and physics audit for robot models."""

__version__ = "0.1.0"
