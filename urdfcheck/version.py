"""The version of urdfcheck."""

__version__ = "0.1.0"
