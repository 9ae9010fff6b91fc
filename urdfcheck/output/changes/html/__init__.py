"""The comparison for people: one HTML file with both versions of each robot in 3D; it opens from a disk and loads nothing."""

from urdfcheck.output.changes.html.document import render

__all__ = ["render"]
