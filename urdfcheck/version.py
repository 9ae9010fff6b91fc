"""The version of urdfcheck."""

__version__ = "0.2.0"
